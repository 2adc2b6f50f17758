"""The TOML format of a material file: its keys, their types and units, reading and
writing; see materials/README.md.
"""

import sys
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeAlias

from ..errors import InputError, closest
from ..files import read_toml, write_files

Document: TypeAlias = dict[str, Any]  # the content of a TOML file

GRADES = ("measured", "published fit", "fitted here", "estimated", "illustrative")

_TEXT = "a text in quotes"
_NUMBER = "a finite number"
_NUMBERS = "a list of finite numbers"
_PAIR = "a list of two numbers, the lower first"
_PAIR_OR_NONE = "a list of two numbers, the lower first, or an empty one"
_TABLE = "a table"
_KEYS = {
    "name": _TEXT,
    "description": _TEXT,
    "kind": _TEXT,
    "reference_temperature": _NUMBER,
    "poisson": _NUMBER,
    "bulk": _NUMBER,
    "equilibrium": _NUMBER,
    "viscosity": _NUMBER,
    "moduli": _NUMBERS,
    "times": _NUMBERS,
    "omega": _NUMBERS,
    "storage": _NUMBERS,
    "loss": _NUMBERS,
    "shift": _TABLE,
    "vertical": _TABLE,
    "softening": _TABLE,
    "range": _TABLE,
    "misfit": _TABLE,
    "source": _TABLE,
}
_SERIES, _TABULATED = ("equilibrium", "moduli", "times"), ("omega", "storage", "loss")
# what has no place beside a table of moduli
_NOT_TABULATED = ("bulk", "viscosity", *_SERIES)
SHIFT_KEYS = {
    "WLF": {"c1": _NUMBER, "c2": _NUMBER, "reference": _NUMBER},
    "Arrhenius": {"energy": _NUMBER, "reference": _NUMBER},
    "VFT": {"b": _NUMBER, "t0": _NUMBER, "reference": _NUMBER},
    "table": {"temperature": _NUMBERS, "log10_a": _NUMBERS},
}
VERTICAL_KEYS = {
    "entropic": {"reference": _NUMBER},
    "table": {"temperature": _NUMBERS, "factor": _NUMBERS},
}
_SOFTENING_KEYS: dict[str, str] = dict.fromkeys(("strain", "storage", "loss"), _NUMBERS)
_RANGE_KEYS = {"omega": _PAIR_OR_NONE, "time": _PAIR, "temperature": _PAIR}
_MISFIT_KEYS: dict[str, str] = dict.fromkeys(
    ("omega", "storage_residual", "loss_residual"), _NUMBERS
)
_GROUPS = ("moduli", "shift", "vertical", "softening", "poisson", "bulk", "range")
_SOURCE_GROUPS: dict[str, str] = dict.fromkeys(_GROUPS, _TABLE)
_SOURCE_KEYS = {
    "citation": _TEXT,
    "grade": _TEXT,
    "note": _TEXT,
    "storage_residual": _NUMBER,
    "loss_residual": _NUMBER,
}
_COMMENTS = {
    "kind": '"shear" (G) or "tensile" (E), for all moduli below',
    "reference_temperature": "[K]",
    "poisson": "Poisson's ratio, constant [1]",
    "bulk": "bulk modulus, constant [Pa]",
    "equilibrium": "relaxed modulus [Pa]",
    "viscosity": "parallel dashpot [Pa s]",
    "moduli": "one per relaxation time [Pa]",
    "times": "relaxation times at the reference temperature, ascending [s]",
    "c1": "[1]",
    "c2": "[K]",
    "energy": "[J/mol]",
    "storage": "storage moduli [Pa]",
    "loss": "loss moduli [Pa]",
    "b": "[K]",
    "t0": "[K]",
    "reference": "[K]",
    "log10_a": "[1]",
    "factor": "b_T, of all moduli [1]",
    "omega": "at the reference temperature [rad/s]",
    "time": "at the reference temperature [s]",
    "temperature": "[K]",
    "storage_residual": "relative, root mean square [1]",
    "loss_residual": "relative, root mean square [1]",
}
_IN_SOFTENING = {
    "strain": "amplitudes of strain, ascending [1]",
    "storage": "factors on the storage modulus, 1 at small strain [1]",
    "loss": "factors on the loss modulus, 1 at small strain [1]",
}
_HEADER = (
    "# Material of elastomdr, SI units throughout; the format is described in "
    "materials/README.md.\n"
)


def read_document(path: Path) -> Document:
    """A material file's content, with known keys and right types only; raises
    `InputError`, one line with the path.
    """
    document = read_toml(path, "name_or_path")
    try:
        validate(document)
    except InputError as error:
        error.inside(str(path), "name_or_path")
        raise
    return document


def write_document(document: Mapping[str, Any], path: Path) -> None:
    """Writes a material file, with the unit of every key in a comment; it appears
    complete or not at all.

    Raises `InputError` where the content does not fit the format or the file cannot be
    written.
    """
    import tomli_w

    try:
        validate(document)
    except InputError as error:
        error.inside("", "info")
        raise
    # Texts hold no line breaks once written, so that every line starts with a key, a
    # bracket or a list's entry.
    lines, table = [], ""
    for line in tomli_w.dumps(document).splitlines():
        table = line if line.startswith("[") else table
        lines.append(
            f"{line}{_comment(line, _IN_SOFTENING if table == '[softening]' else _COMMENTS)}\n"
        )
    toml = _HEADER + "".join(lines)
    write_files({path: toml.encode()})


def is_tabulated(document: Mapping[str, Any]) -> bool:
    """Whether a material file holds a table of storage and loss moduli, and no Prony
    series.
    """
    return any(key in document for key in _TABULATED) and not any(
        key in document for key in _SERIES
    )


def validate(document: Mapping[str, Any]) -> None:
    """Raises `InputError` for unknown or missing keys and wrong types; the numbers'
    meaning is not looked at.
    """
    lists = _TABULATED if is_tabulated(document) else _SERIES
    _validate_table("", document, _KEYS, ("kind", *lists))
    foreign = _NOT_TABULATED if lists is _TABULATED else _TABULATED
    for key in foreign:
        if key in document:
            raise InputError(
                argument=key,
                got=document[key],
                accepted=f"left out beside {lists[-1]}",
                hint="a material is a series (equilibrium, moduli, times) or a table "
                "(omega, storage, loss)",
            )
    if "poisson" not in document and "bulk" not in document:
        raise InputError(argument="poisson", accepted="given, or bulk")
    _same_length("", document, lists[1:] if lists is _SERIES else lists)
    for where, laws in (("shift", SHIFT_KEYS), ("vertical", VERTICAL_KEYS)):
        if where not in document:
            continue
        law = document[where].get("law")
        _one_of("law", where, law, laws)
        _validate_table(where, document[where], {"law": _TEXT, **laws[law]}, laws[law])
    for where, keys in (("softening", _SOFTENING_KEYS), ("misfit", _MISFIT_KEYS)):
        if where in document:
            _validate_table(where, document[where], keys, keys)
            _same_length(where, document[where], tuple(keys))
    _validate_table("range", document.get("range", {}), _RANGE_KEYS)
    _validate_table("source", document.get("source", {}), _SOURCE_GROUPS)
    for group, source in document.get("source", {}).items():
        _validate_table(f"source.{group}", source, _SOURCE_KEYS)
        _one_of("grade", f"source.{group}", source.get("grade", GRADES[0]), GRADES)


def _named(key: str, where: str) -> str:
    return f"[{where}] {key}" if where else key


def _one_of(key: str, where: str, value: object, accepted: Iterable[str]) -> None:
    if not isinstance(value, str) or value not in accepted:
        raise InputError(
            argument=_named(key, where),
            got=value,
            accepted=f"one of {', '.join(accepted)}",
            hint=closest(str(value), accepted),
        )


def _same_length(where: str, table: Mapping[str, Any], keys: tuple[str, ...]) -> None:
    first = len(table[keys[0]])
    for key in keys[1:]:
        if len(table[key]) != first:
            raise InputError(
                argument=_named(key, where),
                got=len(table[key]),
                accepted=f"as long as {keys[0]}, {first} entries",
            )


def _validate_table(
    where: str,
    table: Mapping[str, Any],
    keys: Mapping[str, str],
    required: Iterable[str] = (),
) -> None:
    for key, value in table.items():
        if key not in keys:
            raise InputError(
                argument=_named(key, where),
                accepted=f"one of the keys {', '.join(keys)}",
                hint=closest(key, keys),
            )
        if not _is_of_type(value, keys[key]):
            raise InputError(argument=_named(key, where), got=value, accepted=keys[key])
    for key in required:
        if key not in table:
            raise InputError(
                argument=_named(key, where), accepted=f"given, {keys[key]}"
            )


def _is_of_type(value: object, accepted: str) -> bool:
    if accepted == _NUMBER:
        return (
            isinstance(value, (int, float))
            and not isinstance(value, bool)
            and abs(value) <= sys.float_info.max
        )
    if accepted == _NUMBERS:
        return isinstance(value, list) and all(
            _is_of_type(entry, _NUMBER) for entry in value
        )
    if accepted == _PAIR_OR_NONE and value == []:
        return True
    if accepted in (_PAIR, _PAIR_OR_NONE):
        return (
            isinstance(value, list)
            and _is_of_type(value, _NUMBERS)
            and len(value) == 2
            and value[0] < value[1]
        )
    return isinstance(value, str if accepted == _TEXT else dict)


def _comment(line: str, comments: Mapping[str, str]) -> str:
    key, equals, _ = line.partition(" = ")
    return f"  # {comments[key]}" if equals and key in comments else ""
