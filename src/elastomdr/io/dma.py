"""`em.read_dma`: dynamic moduli and relaxation from files into SI arrays."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import in_kelvin, in_si, plain, positive
from ..errors import InputError
from ..units.registry import to_si, usual
from .columns import (
    Column,
    Quantity,
    choose,
    left_out,
    measured,
    missing,
    named,
    refuse_contradiction,
    refuse_wide,
    taken,
    understand,
    with_sign,
)
from .data import (
    COLDEST,
    KINDS,
    Dma,
    FitWarning,
    describe_list,
    in_strain_sweep,
    join,
    untold,
)
from .formats import Format, format_of
from .sheets import is_frame, read_sheet, sheet_of_frame
from .tables import Head, Table

if TYPE_CHECKING:
    from .._types import ArrayLike, Frame, Kind

    Source = str | os.PathLike[str] | Frame

_POLYMERS = (1e3, 3e10)  # [Pa], between which the largest modulus of a file lies
QUANTITIES = (
    Quantity(
        "frequency",
        "frequency",
        (r"f|freq\.?|frequency|frequenz|주파수",),
        option="frequency_unit",
    ),
    Quantity(
        "frequency",
        "angular frequency",
        (
            r"w|ω|omega|angular frequency|ang\.? freq(uency|\.)?|angular freq\.?|kreisfrequenz|각주파수",
        ),
        option="frequency_unit",
    ),
    Quantity(
        "temperature",
        "temperature",
        (
            r"(sample|specimen|probe) temp(\.|erature)?|t[ _]sample|proben?temperatur",
            r"(?-i:T)|temp\.?|temperature|temperatur|온도",
            r"t[ _]set|(set|set ?point|program(med)?|target|nominal|furnace|oven|chamber) temp(\.|erature)?|"
            "solltemperatur",
        ),
        option="temperature_unit",
        limits=(COLDEST, 800.0),
    ),
    Quantity("time", "time", (r"(?-i:t)|(step )?time|zeit|시간",), option="time_unit"),
    Quantity(
        "storage",
        "modulus",
        (
            r"storage modulus|storage|stor|s torage|speichermodul|저장 ?탄성(률|계수)|(modulus )?[ge]'|"
            r"[ge]_?(1|p|prime|stor|storage)|re\([ge]\*?\)|storage (shear|tensile|young'?s) modulus|"
            r"([ge]|shear|tensile|young'?s)[ _-](stor|storage|storage modulus)",
        ),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    Quantity(
        "loss",
        "modulus",
        (
            r"loss modulus|loss|verlustmodul|손실 ?탄성(률|계수)|(modulus )?[ge]''|"
            r"[ge]_?(2|pp|dprime|double[_ -]?prime|loss)|im\([ge]\*?\)|loss (shear|tensile|young'?s) modulus|"
            r"([ge]|shear|tensile|young'?s)[ _-](loss|loss modulus)",
        ),
        option="modulus_unit",
        signed=True,
    ),
    Quantity(
        "absolute",
        "modulus",
        (r"\|[ge]\*\|?|[ge]\*|[ge]_?abs|(complex|dynamic) modulus|komplexer modul",),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    Quantity(
        "phase",
        "angle",
        (r"phase ?angle|phase|delta|δ|phasenwinkel",),
        valid="between 0 and 90 deg",
        signed=True,
    ),
    Quantity(
        "tangent",
        "ratio",
        (
            r"tan_?\(?(d|delta|δ)\)?|tan ?(d|delta|δ)|tand|loss (tangent|factor)|verlustfaktor",
        ),
        limits=(0.0, 3.0),
        signed=True,
    ),
    Quantity(
        "relaxation",
        "modulus",
        (
            r"[ge]_?(relax|t)|[ge]\(t\)|relaxationsmodul|relax|relaxation|완화탄성률|relaxation modulus [ge]|"
            r"(stress |shear |tensile )?relaxation modulus( [ge]\(t\))?",
        ),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    Quantity(
        "strain",
        "strain",
        (
            r"(oscillation|oscillatory|dynamic) strain( amplitude)?|strain (amplitude|ampl\.?|dyn|dynamic)",
            r"((shear|tensile) )?strain( \u03b3| gamma)?|(strain )?amplitude|\u03b3|\u03b3_?0|gamma|(?-i:g)|"
            r"epsilon|ε|dehnung|scherdehnung|deformation|scherdeformation|(dehnungs|deformations)amplitude",
        ),
        valid="",
        limits=(1e-8, 5.0),
    ),
    Quantity(
        "viscosity",
        "viscosity",
        (r"\|?(eta|η|h)\*\|?|complex viscosity|komplexe viskosität|eta_?(abs|star)",),
    ),
    Quantity(
        "viscosity_real",
        "viscosity",
        (r"(eta|η|h)(_?1|'|_?prime)|(dynamic|real|storage) viscosity",),
    ),
    Quantity(
        "viscosity_imaginary",
        "viscosity",
        (
            r"(eta|η|h)(_?2|''|_?(double_?prime|dprime|pp))|(imaginary|loss|out[- ]of[- ]phase) viscosity",
        ),
        signed=True,
    ),
    Quantity(
        "compliance",
        "compliance",
        (r"\|[jd]\*\|?|[jd]\*|[jd]_?abs|(complex|dynamic) compliance",),
    ),
    Quantity(
        "compliance_storage",
        "compliance",
        (
            r"[jd](_?1|'|_?(prime|stor|storage))|storage compliance|speichernachgiebigkeit",
        ),
    ),
    Quantity(
        "compliance_loss",
        "compliance",
        (
            r"[jd](_?2|''|_?(pp|dprime|double_?prime|loss))|loss compliance|verlustnachgiebigkeit",
        ),
        signed=True,
    ),
    Quantity(
        "creep",
        "compliance",
        (
            r"[jd]\(t\)|((creep|shear|tensile|shear creep|tensile creep) )?compliance( [jd](\(t\))?)?|"
            r"kriechnachgiebigkeit|creep|[jd]_?(creep|t)|(?-i:[JD])",
        ),
    ),
    Quantity(
        "stiffness",
        "stiffness",
        (
            r"\|?k\*\|?|k_?(abs|dyn)|((dynamic|complex) )?stiffness|(dynamische )?steifigkeit",
        ),
    ),
    Quantity(
        "stiffness_storage",
        "stiffness",
        (r"k(_?1|'|_?(prime|stor|storage))|(storage|elastic) stiffness",),
    ),
    Quantity(
        "stiffness_loss",
        "stiffness",
        (r"k(_?2|''|_?(pp|dprime|double_?prime|loss))|(loss|viscous) stiffness",),
        signed=True,
    ),
    Quantity(
        "stress",
        "modulus",
        (r"((shear|tensile) )?stress( \u03c3| sigma)?|(schub)?spannung|\u03c3|sigma",),
    ),
)
_PAIRS = (
    ("storage", "loss"),
    ("storage", "tangent"),
    ("absolute", "phase"),
    ("absolute", "tangent"),
    ("storage", "phase"),
    ("loss", "tangent"),
    ("compliance_storage", "compliance_loss"),
    ("compliance_storage", "tangent"),
    ("compliance", "phase"),
    ("compliance", "tangent"),
    ("viscosity_real", "viscosity_imaginary"),
    ("viscosity", "phase"),
    ("viscosity", "tangent"),
    ("stiffness_storage", "stiffness_loss"),
    ("stiffness_storage", "tangent"),
    ("stiffness", "phase"),
    ("stiffness", "tangent"),
)
_TIMED = (("relaxation",), ("creep",), ("stress", "strain"))
# ratio of the largest to the smallest stress (or strain) that counts as held
_CONSTANT = 1.05
_ALONE = "if it was not measured, give storage_only=True (--storage-only)"
_STEP = r"(step|schritt|segment|interval|intervall|block|set|sweep|(mess)?abschnitt)( (no\.?|nr\.?|number|index))?"
_HOLD = 4  # points at one frequency and temperature that make a sweep of something else
_HELD = 3.0  # range of temperatures within it [K]
_SWEPT = 1.5  # ratio of the highest to the lowest frequency of a sweep
_SAME = 0.5  # [K], within which two temperatures are one, rounded
_LAST = 10**9  # behind all columns
# that may stand once, before the columns of several isotherms
_SHARED = {"time", "frequency"}
_UNIT = r"deg ?[CFcf]|°\s?[CF]|º\s?[CF]|℃|℉|K|C|kelvin|celsius"
_PARTS = (
    "step|block|set|sweep|run|curve|interval|segment|abschnitt|messung|experiment|stage"
)
# a remark with nothing but the temperature, and what may number the block
_TEMPERATURE = re.compile(
    rf"[^\w+-]*(?:(?:{_PARTS}|frequency sweep)(?:\s*\d+(?!\d))?[^\w+-]*)?"
    r"(?:(?:t|temp\.?|temperatur|(?:(?:sample|test) )?temp(?:erature)?|isotherme?|온도)\s*(?:at|of|bei)?|at|bei)?"
    rf"\s*[=:,;]?\s*(?<!\d)([+-]?\d+(?:[.,]\d+)?)\s*\[?\(?({_UNIT})\W*",
    re.IGNORECASE,
)
# "Run 3 C" is its number
_NUMBERED = re.compile(rf"\W*(?:{_PARTS})\s*\d+\s*[CK]\b", re.IGNORECASE)
_VALUE = rf"(?:T\s*=\s*)?([+-]?\d+(?:[.,]\d+)?)\s*_?({_UNIT}|k?Hz|rad/s)(?![\w/])"
# in titles: E' (-40 °C) [MPa], E' [MPa] @ -40 °C, E'_-40C, E', 10 Hz, MPa
_CONDITIONS = (
    re.compile(rf"\s*[(\[]\s*{_VALUE}\s*[)\]]"),
    re.compile(rf"[\s,;_@]+(?:(?:at|bei|@)\s*)?{_VALUE}"),
)
_RATE = re.compile(
    r"[^\w]*(?:(?:step|block|sweep|set)\s*\d*[^\w]*)?(?:f|freq\.?|frequency|frequenz)\s*[=:,;]?\s*(\d+(?:[.,]\d+)?)\s*[\[(]?"
    r"(k?Hz|rad/s)\W*",
    re.IGNORECASE,
)
# of a file
_NAME = re.compile(
    rf"(?<![A-Za-z0-9.,])([+-]?\d+(?:[.,]\d+)?)[ _]?({_UNIT})(?![A-Za-z0-9])"
)


class Specimen(NamedTuple):
    """What files seldom say of a test: section [m^2] and length [m] of the specimen,
    duration of a ramp [s].
    """

    area: float | None
    length: float | None
    ramp: float | None
    storage_only: bool


@in_si
def read_dma(
    path_or_paths: Source | Sequence[Source],
    *,
    temperature: ArrayLike | None = None,
    kind: Kind | None = None,
    columns: Mapping[str, str | int] | None = None,
    frequency_unit: str | None = None,
    modulus_unit: str | None = None,
    temperature_unit: str | None = None,
    time_unit: str | None = None,
    area: float | None = None,
    length: float | None = None,
    ramp: float | None = None,
    storage_only: bool = False,
) -> Dma:
    """Dynamic moduli or relaxation from a file or a table in memory, or from several of
    one material.

    The formats are those of `elastomdr.io.formats`: tables in text and spreadsheets,
    exports of TA Q800, TRIOS, Netzsch, RheoCompass and Eplexor, RepTate's files.
    Isotherms may stand in one table, one below the other, side by side, or in columns
    such as "E' (-40 degC) [MPa]".

    Args:
        path_or_paths: a file, or a table of pandas or polars, whose titles are
            understood as those of files are; or a list of these.
        temperature: temperature of all points that have none in the files [K], or one
            for each isotherm without, in their order.
        kind: "shear" or "tensile": what the moduli are, where the file does not say.
        columns: columns by quantity (frequency, temperature, storage, loss, absolute,
            phase, tangent, time, relaxation, creep, stress, strain, and viscosity,
            compliance, stiffness with _real, _imaginary or _storage, _loss), for titles
            that are not recognised or are wrong: a title, or a number from 1, with the
            unit where the file's is missing or wrong: {"storage": "Modulus 1", "loss":
            4, "frequency": "2 [Hz]"}; "log10(3)" for logarithms; "10 Hz" for a number
            that holds for all rows.
        frequency_unit: unit of frequencies without one, such as "Hz" or "rad/s"; it
            overrules none in a file.
        modulus_unit: likewise of moduli, such as "MPa".
        temperature_unit: likewise of temperatures, "degC" or "K".
        time_unit: likewise of times, such as "s".
        area: section of the specimen, of which files hold the dynamic stiffness [m^2].
        length: its length in tension, its height in shear [m]: modulus = stiffness
            length/area.
        ramp: duration of the ramp of strain before relaxation, from whose start times
            count [s].
        storage_only: whether a storage modulus without a loss modulus is all there is.

    Returns:
        The measurement in SI units; `columns` says what was read as what, `bad_rows`
        which rows are no measurement.

    Raises:
        InputError: for what cannot be read, what is ambiguous, and units that nobody
            gives; it says what to give.
    """
    if kind is not None and kind not in KINDS:
        raise InputError(f"kind must be 'shear' or 'tensile', got {kind!r}.")
    if columns is not None and not isinstance(columns, Mapping):
        raise InputError(
            f"columns must be a dict such as {{'storage': 'Modulus 1'}}, got "
            f"{columns!r}."
        )
    units = checked_units(
        frequency=frequency_unit,
        modulus=modulus_unit,
        temperature=temperature_unit,
        time=time_unit,
    )
    specimen = _specimen(area, length, ramp, storage_only)
    paths: Any = [path_or_paths] if _is_source(path_or_paths) else path_or_paths
    if not isinstance(paths, Sequence) or not paths or not all(map(_is_source, paths)):
        raise InputError(
            "path_or_paths must be a file or a list of files, or tables of pandas or "
            "polars in their place, got "
            f"{path_or_paths!r}."
        )
    files = [str(one) for one in paths if not is_frame(one)]
    twice = {name for name in files if files.count(name) > 1}
    if twice:
        raise InputError(
            "path_or_paths must name every file once, got "
            f"{', '.join(sorted(twice))} "
            "twice or more."
        )
    unmet = dict(columns or {})
    parts = [
        part
        for path in paths
        for part in _read(path, kind, columns, units, unmet, specimen)
    ]
    if unmet:
        raise InputError(
            f"columns must name titles or numbers of columns, got {unmet}, which "
            "no "
            "file has."
        )
    if temperature is None:
        parts = _from_names(parts)
    dma = join(*_with_temperatures(_without_holds(parts), temperature))
    for text in dma.warnings:
        warnings.warn(text, FitWarning, stacklevel=3)
    return dma


def _is_source(value: Any) -> bool:
    return isinstance(value, (str, os.PathLike)) or is_frame(value)


def _specimen(area: Any, length: Any, ramp: Any, storage_only: Any) -> Specimen:
    given = {"area": area, "length": length, "ramp": ramp}
    numbers = {
        name: None if value is None else float(plain(name, value))
        for name, value in given.items()
    }
    for name, number in numbers.items():
        if number is not None:
            positive(name, number)
    return Specimen(
        numbers["area"], numbers["length"], numbers["ramp"], bool(storage_only)
    )


def checked_units(**given: Any) -> dict[str, str]:
    """The units that a user gives, by kind. Raises `InputError` for what is none of its
    kind.
    """
    for kind, unit in given.items():
        if unit is not None and not (isinstance(unit, str) and to_si(unit, kind)):
            raise InputError(
                f"{kind}_unit must be a unit of {kind} such as {usual(kind)}, got "
                f"{unit!r}."
            )
    return {kind: unit for kind, unit in given.items() if unit is not None}


def _read(
    source: Any,
    kind: str | None,
    columns: Mapping[str, Any] | None,
    units: dict[str, str],
    unmet: dict[str, Any],
    specimen: Specimen,
) -> list[Dma]:
    """Each table of a file, or one in memory, as a measurement; the temperature is NaN
    where the file has none.

    Roles of `columns` that are found are taken out of `unmet`.
    """
    sheet = sheet_of_frame(source) if is_frame(source) else read_sheet(source)
    layout = format_of(sheet)
    whole = layout.tables(sheet)
    refuse_wide(sheet.name, whole)
    found = [part for table in whole for part in _parts(sheet.name, table, columns)]
    parts: list[Dma] = []
    absent, known, lines, width = "", [], [], 0
    for table in found:
        user, constants = named(sheet.name, columns, table, QUANTITIES)
        for role in {*user, *constants} & unmet.keys():
            del unmet[role]
        places = {column.place for column in user.values()}
        read = [
            column for head in table.heads if (column := understand(head, QUANTITIES))
        ]
        read = [
            one
            for one in read
            if one.role not in (*user, *constants) and one.place not in places
        ]
        roles = (
            {one.role for one in (*read, *user.values())}
            | constants.keys()
            | table.fixed.keys()
        )
        lack = _lacking(roles)
        if (
            lack
            and {"frequency", "storage"} <= roles
            and not {"absolute", "loss"} & roles
        ):
            every = {head.place for head in table.heads if head.title} <= {
                one.place for one in (*read, *user.values())
            }
            lack = "" if specimen.storage_only or every else f"{lack}; {_ALONE}"
        if lack:
            if not absent:
                absent = lack
                known = [
                    f"{one.place + 1} {one.title!r} as {one.role}"
                    for one in (*read, *user.values())
                ]
            if lines and len(table.heads) == width and table.rows[0].line > lines[-1]:
                raise InputError(
                    f"{sheet.name}: the rows from line {table.rows[0].line} on stand "
                    "below titles that are not understood, "
                    f"{', '.join(head.title for head in table.heads)[:80]!r}: leave "
                    "them out, or name the "
                    "columns."
                )
            continue
        read = [*_of_kind(sheet.name, read, kind), *user.values()]
        table = table._replace(fixed=table.fixed | constants)
        users = {*user, *constants}
        needed = _needed({*(one.role for one in read), *table.fixed}, users)
        chosen = choose(
            sheet.name, [one for one in read if one.role in needed], table, units
        )
        if not {"loss", "tangent"} & users:
            refuse_contradiction(sheet.name, table, chosen, read, units)
        parts.append(
            _measurement(sheet.name, layout, table, chosen, kind, units, specimen)
        )
        lines.append(table.rows[0].line)
        width = len(table.heads)
    if not parts:
        raise InputError(
            missing(
                sheet.name, known, absent or "there are no columns of moduli", found
            )
        )
    without = [
        i
        for i, one in enumerate(parts)
        if not np.isfinite([*one.temperature, *one.time_temperature]).all()
    ]
    if 0 < len(without) < len(parts):
        raise InputError(
            f"{sheet.name}: the rows from line {lines[without[0]]} on have no "
            "temperature, and others have: write it "
            "above them, as 'T = -20 degC', or into a column."
        )
    return parts


def _lacking(roles: set[str]) -> str:
    """What is missing to make a measurement of columns, in words; an empty text where
    nothing is.
    """
    moduli = any(set(pair) <= roles for pair in _PAIRS)
    timed = any(set(group) <= roles for group in _TIMED)
    if (moduli and "frequency" in roles) or (timed and "time" in roles):
        return ""
    if {"relaxation", "creep"} & roles:
        return "there is no column of time"
    if "time" in roles and {"stress", "strain"} & roles:
        other, example = (
            ("stress", "0.1 MPa") if "strain" in roles else ("strain", "1 %")
        )
        return (
            f"there is no column of {other}; where it was held, give it, as '{example}'"
        )
    lack = [] if "frequency" in roles else ["frequency"]
    if not moduli:
        lack += (
            ["loss modulus (or tangent, phase)"]
            if {"storage", "absolute"} & roles
            else ["storage and loss modulus"]
        )
    return f"there is no column of {' and '.join(lack)}"


def _needed(roles: set[str], users: set[str]) -> tuple[str, ...]:
    """The roles that make the measurement: rate and both moduli, or time and what was
    measured over it; temperature.

    Of several pairs of moduli the one with most of what the user names.
    """
    pairs = [pair for pair in _PAIRS if set(pair) <= roles and "frequency" in roles]
    pair = max(pairs, key=lambda pair: len(users.intersection(pair)), default=None)
    if pair:
        return ("frequency", *pair, "temperature", "strain")
    timed = next(
        (group for group in _TIMED if set(group) <= roles and "time" in roles), None
    )
    return (
        ("time", *timed, "temperature")
        if timed
        else ("frequency", "storage", "temperature", "strain")
    )


def _of_kind(name: str, columns: Sequence[Column], kind: str | None) -> list[Column]:
    """The columns without moduli of the other kind. Raises `InputError` where nobody
    says which kind is meant.
    """
    letters = {
        column.letter for column in columns if column.quantity.kind == "modulus"
    } - {""}
    if len(letters) < 2:
        return list(columns)
    if kind is None:
        raise InputError(
            f"{name}: the file has moduli of shear and of tension: give "
            "kind='shear' or 'tensile' (--kind)."
        )
    found = [
        column
        for column in columns
        if column.letter in ("", "G" if kind == "shear" else "E")
    ]
    if _lacking({column.role for column in found}):
        raise InputError(
            f"{name}: the file has no storage and loss modulus of kind {kind!r}, "
            "only "
            "one of both."
        )
    return found


def _measurement(
    name: str,
    layout: Format,
    table: Table,
    chosen: dict[str, Column],
    kind: str | None,
    units: dict[str, str],
    specimen: Specimen,
) -> Dma:
    needed = _needed({*chosen, *table.fixed}, set())
    chosen = {role: chosen[role] for role in needed if role in chosen}
    if (
        needed[0] == "frequency"
        and "strain" in chosen
        and not _is_strain(table, chosen["strain"])
    ):
        del chosen["strain"]
    kind = _kind(name, table, chosen, kind, layout)
    chosen, turned = with_sign(name, table, chosen)
    values, good, bad = measured(name, table, chosen, units)
    if not good.any():
        raise InputError(
            f"{name}: no row below {next(iter(chosen.values())).title!r} is a "
            f"measurement ({bad[0]})."
        )
    n = int(good.sum())
    for role in needed:
        if role not in values:
            values[role] = np.full(n, table.fixed.get(role, np.nan))
    said = {role: _said(column, units) for role, column in chosen.items()}
    none = np.zeros(0)
    common: dict[str, Any] = {
        "kind": kind,
        "units": said,
        "warnings": (
            *turned,
            *left_out(name, bad, "bad_rows and in the master curve's table"),
        ),
        "bad_rows": tuple(bad),
        "source": name,
        "shifted": layout.shifted,
        "columns": (
            taken(table, chosen, said)
            + "; temperature from the text" * ("temperature" in table.fixed),
        ),
    }
    if needed[0] == "time":
        return _timed(name, values, needed, specimen, common)
    rate, kelvin = values["frequency"], values["temperature"]
    pair = needed[1:-2]
    if len(pair) == 1:
        text = (
            f"{name}: there is no loss modulus: the fit takes it from the spectrum, "
            "with a wide band."
        )
        common["warnings"] = (*common["warnings"], text)
        return Dma(
            none,
            none,
            none,
            none,
            time=1 / rate,
            relaxation=values["storage"],
            time_temperature=kelvin,
            response="storage",
            **common,
        )
    first, second = values[pair[0]], values[pair[1]]
    if pair[0].startswith("stiffness"):
        scale = _scale(name, specimen)
        first, second = (
            first * scale,
            second * scale if pair[1].startswith("stiffness") else second,
        )
    moduli = _moduli(first, second, pair, rate)
    return Dma(kelvin, rate, *moduli, strain=values["strain"], **common)


def _timed(
    name: str,
    values: dict[str, np.ndarray],
    needed: tuple[str, ...],
    specimen: Specimen,
    common: dict[str, Any],
) -> Dma:
    """Relaxation or creep; of stress and strain over time the one that was held
    decides.
    """
    none, response = np.zeros(0), "relaxation"
    ramp = specimen.ramp or 0.0
    if needed[1] == "relaxation":
        modulus = values["relaxation"]
    elif needed[1] == "creep":
        modulus, response = 1 / values["creep"], "creep"
    else:
        modulus = values["stress"] / values["strain"]
        held = [
            np.nanmax(values[role]) < _CONSTANT * np.nanmin(values[role])
            for role in ("stress", "strain")
        ]
        if held[0] == held[1]:
            raise InputError(
                f"{name}: stress and strain "
                f"{'both vary' if not held[0] else 'are both constant'} over time, "
                "which is "
                "neither creep nor relaxation: give the one that was held, as "
                "columns={'stress': '0.1 MPa'} (--column 'stress=0.1 MPa') or "
                "columns={'strain': '1 %'} (--column 'strain=1 %')."
            )
        response = "creep" if held[0] else "relaxation"
    time, kelvin = values["time"], values["temperature"]
    good = np.isfinite(modulus) & (time > ramp)
    if ramp and response == "creep":
        raise InputError(f"ramp must be left out for creep, got {ramp:g} s ({name}).")
    if not good.any():
        raise InputError(
            f"{name}: no point is behind the ramp of {ramp:g} s; times count from "
            "its "
            "start."
        )
    if not good.all():
        text = (
            f"{name}: {int((~good).sum())} points within the ramp of {ramp:g} s left "
            "out."
        )
        common["warnings"] = (*common["warnings"], text)
    return Dma(
        none,
        none,
        none,
        none,
        time=time[good],
        relaxation=modulus[good],
        time_temperature=kelvin[good],
        response=response,
        ramp=ramp,
        **common,
    )


def _scale(name: str, specimen: Specimen) -> float:
    """What turns a stiffness into a modulus: length over section."""
    if specimen.area is None or specimen.length is None:
        raise InputError(
            f"{name}: the columns hold a stiffness; give the specimen's section and "
            "length (in shear: height), as "
            "area=1e-4, length=0.02 (--area '100 mm2' --length '20 mm')."
        )
    return specimen.length / specimen.area


def _is_strain(table: Table, column: Column) -> bool:
    """Whether a column of strain is wanted: in a unit of strain, or, without one,
    different from row to row.
    """
    if column.unit:
        return column.known
    numbers = table.column(column.place)
    numbers = numbers[numbers > 0]
    return bool(numbers.size and numbers.max() > 1.5 * numbers.min())


def _moduli(
    first: np.ndarray, second: np.ndarray, pair: tuple[str, ...], omega: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Storage and loss modulus from two columns in SI units: G* = |G*| e^(i delta) =
    1/J* = i omega eta*.
    """
    if pair[0] == "viscosity_real":
        return omega * second, omega * first
    if pair[1] in ("phase", "tangent"):
        if pair[0] == "loss":
            return first / second, first
        tangent = np.tan(second) if pair[1] == "phase" else second
        size = first if pair[0].endswith("storage") else first / np.hypot(1.0, tangent)
        first, second = size, size * tangent
    if pair[0].startswith("compliance"):
        square = first**2 + second**2
        return first / square, second / square
    return (
        (first * omega, second * omega) if pair[0] == "viscosity" else (first, second)
    )


def _said(column: Column, units: dict[str, str]) -> str:
    kind = (
        "frequency"
        if column.quantity.kind == "angular frequency"
        else column.quantity.kind
    )
    unit = column.unit or units.get(kind, "")
    return f"{column.log} of {unit}" if column.log else unit


def _kind(
    name: str,
    table: Table,
    chosen: Mapping[str, Column],
    kind: str | None,
    layout: Format,
) -> str:
    letters = {column.letter for column in chosen.values()} - {""}
    if any(
        re.search("torque|drehmoment", head.title, re.IGNORECASE)
        for head in table.heads
    ):
        letters.add("G")  # torsion is shear
    found = {"G": "shear", "E": "tensile"}.get(
        "".join(letters), layout.kind if not letters else ""
    )
    if found and kind and found != kind:
        raise InputError(
            f"kind must be {found!r}, as the columns of {name!r} say, got {kind!r}."
        )
    if len(letters) > 1 or not (found or kind):
        raise InputError(
            f"{name}: whether the moduli are of shear or tension is not in the file; "
            "give it, as kind='shear' or "
            "'tensile' (--kind shear or --kind tensile)."
        )
    return found or str(kind)


def _parts(name: str, table: Table, columns: Mapping[str, Any] | None) -> list[Table]:
    """The isotherms in a table; of those side by side only the ones with all the
    columns that the user names.
    """
    parts = [part for one in _steps(table) for part in _isotherms(name, one)]
    users = named(name, columns, table, QUANTITIES)[0].keys()
    if len(parts) < 2 or not users:
        return parts
    return [
        part
        for part in parts
        if named(name, columns, part, QUANTITIES)[0].keys() == users
    ] or [table]


def _steps(table: Table) -> list[Table]:
    """A table for each number in a column of steps; or the table."""
    for head in table.heads:
        if not re.fullmatch(_STEP, head.title.strip(), re.IGNORECASE):
            continue
        numbers = table.column(head.place)
        steps = np.unique(numbers[np.isfinite(numbers)])
        if (
            1 < steps.size <= len(table.rows) / 3
            and (steps == np.round(steps)).all()
            and np.isfinite(numbers).all()
        ):
            rows = {
                step: [
                    row for row, n in zip(table.rows, numbers, strict=True) if n == step
                ]
                for step in steps
            }
            return [table._replace(rows=rows[step]) for step in steps]
    return [table]


def _isotherms(name: str, table: Table) -> list[Table]:
    """The isotherms side by side in a table, each with the temperature that stands in
    its titles or above.
    """
    return [part for one in _by_condition(table) for part in _beside(name, one)]


def _by_condition(table: Table) -> list[Table]:
    """A table for each temperature or frequency that stands in titles, as in "E' (-40
    degC) [MPa]"; or the table.
    """
    groups: dict[tuple[str, float], list[Head]] = {}
    shared: list[Head] = []
    for head in table.heads:
        match = next(
            (found for one in _CONDITIONS if (found := one.search(head.title))), None
        )
        kind = next(
            (
                kind
                for kind in ("temperature", "frequency")
                if match and to_si(match[2], kind)
            ),
            "",
        )
        title = (
            f"{head.title[: match.start()]} {head.title[match.end() :]}"
            if match
            else ""
        )
        title = re.sub(r"\(\s*\)|\[\s*\]|[(\[]\s*(?=[(\[])", " ", title).replace(
            " /", "/"
        )
        own = head._replace(
            title=re.sub(r"\s*,\s*(?=[,\[(]|$)|[\s_@]+$", "", title).strip()
        )
        column = understand(own, QUANTITIES)
        if (
            match is None
            or not kind
            or column is None
            or column.role in ("frequency", "temperature", "time")
        ):
            shared.append(head)
            continue
        factor, offset = to_si(match[2], kind) or (1.0, 0.0)
        groups.setdefault(
            (kind, float(match[1].replace(",", ".")) * factor + offset), []
        ).append(own)
    if not groups:
        return [table]
    return [
        table._replace(heads=[*shared, *heads], fixed=table.fixed | dict([key]))
        for key, heads in groups.items()
    ]


def _beside(name: str, table: Table) -> list[Table]:
    """A table for each isotherm where the same columns repeat; or the table."""
    columns = [
        column for head in table.heads if (column := understand(head, QUANTITIES))
    ]
    roles = [column.role for column in columns]
    found = _repeated(roles)
    if (
        "frequency" not in roles
        and "time" not in roles
        and "frequency" not in table.fixed
    ):
        table = table._replace(fixed=table.fixed | _rate_above(table))
    if found is None:
        above = {} if "temperature" in roles else _between(name, table, 0, _LAST)
        return [table._replace(fixed=above | table.fixed)]
    once, period = found
    starts = [columns[i].place for i in range(once, len(columns), period)]
    heads = {head.place: head for head in table.heads}
    shared = [heads[column.place] for column in columns[:once]]
    parts = []
    for start, end in zip(starts, [*starts[1:], _LAST], strict=True):
        own = [heads[column.place] for column in columns if start <= column.place < end]
        above = (
            {}
            if "temperature" in roles
            else _between(name, table, 0 if start == starts[0] else start, end)
        )
        rows = [
            row
            for row in table.rows
            if any(row.cells[h.place : h.place + 1] not in ([], [""]) for h in own)
        ]
        parts.append(
            table._replace(heads=[*shared, *own], rows=rows, fixed=above | table.fixed)
        )
    if once and not all("temperature" in one.fixed for one in parts):
        return [table]  # two samples, or raw and smoothed values
    return [part for part in parts if part.rows]


def _between(name: str, table: Table, first: int, end: int) -> dict[str, float]:
    """The temperature in the text above some columns. Raises `InputError` where there
    are two.
    """
    found = {
        kelvin: text
        for row in table.above
        for at, kelvin, text in _above(row.cells)
        if first <= at < end
    }
    if found and max(found) - min(found) > _SAME:
        raise InputError(
            f"{name}: {' and '.join(map(repr, found.values()))} stand above the same "
            "columns: leave the one that is "
            "theirs."
        )
    return {"temperature": min(found)} if found else {}


def _rate_above(table: Table) -> dict[str, float]:
    """The frequency [rad/s] in the last line above a table that says one and nothing
    else.
    """
    for row in reversed(table.above):
        for text in (" ".join(cell for cell in row.cells if cell), *row.cells):
            match = _RATE.fullmatch(text.strip())
            if match and (si := to_si(match[2], "frequency")):
                return {"frequency": float(match[1].replace(",", ".")) * si[0]}
    return {}


def _repeated(roles: Sequence[str]) -> tuple[int, int] | None:
    """How many columns stand once, and how many repeat behind them; None where none
    do.
    """
    for once in range(len(roles)):
        if not set(roles[:once]) <= _SHARED:
            return None
        rest = roles[once:]
        for period in range(1, len(rest) // 2 + 1):
            whole = not _lacking({*roles[:once], *rest[:period]}) and {
                *rest[:period]
            }.isdisjoint(roles[:once])
            if whole and list(rest) == list(rest[:period]) * (len(rest) // period):
                return once, period
    return None


def _above(cells: Sequence[str]) -> list[tuple[int, float, str]]:
    """The temperatures that a row of remarks gives, with their columns: one in each
    cell, or that of the whole row.
    """
    whole = [cell for cell in cells if cell]
    # a decimal comma may have been cut
    ways = ([",".join(whole)], cells, [" ".join(whole)])
    return next((found for way in ways if (found := list(_temperatures(way)))), [])


def _temperatures(cells: Sequence[str]) -> Iterator[tuple[int, float, str]]:
    for place, cell in enumerate(cells):
        text = re.sub("[\u2212\u2013]", "-", cell.strip())
        match = (
            _TEMPERATURE.fullmatch(text)
            if text and len(text) < 80 and not _NUMBERED.match(text)
            else None
        )
        si = to_si(match[2].replace(" ", ""), "temperature") if match else None
        if (
            match
            and si
            and (kelvin := float(match[1].replace(",", ".")) * si[0] + si[1]) > 0
        ):
            yield place, kelvin, text


def _without_holds(parts: list[Dma]) -> list[Dma]:
    """The measurements without steps at one frequency and temperature beside sweeps of
    frequency.

    Nobody says what was changed in them: strain, time or preload. Where the strain is
    known, the fit sorts them out.
    """
    held = [_is_hold(part) for part in parts]
    swept = [
        part.omega.size > 1 and part.omega.max() > _SWEPT * part.omega.min()
        for part in parts
    ]
    if not any(held) or not any(swept):
        return parts
    kept = [part for part, hold in zip(parts, held, strict=True) if not hold]
    count = sum(part.size for part, hold in zip(parts, held, strict=True) if hold)
    text = (
        f"{parts[held.index(True)].source}: {count} points in steps at one frequency "
        "and temperature are left out: a "
        "sweep of something that no column holds, such as strain or time."
    )
    return [replace(kept[0], warnings=(*kept[0].warnings, text)), *kept[1:]]


def _is_hold(part: Dma) -> bool:
    if part.omega.size < _HOLD or np.isfinite(part.strain).any() or part.time.size:
        return False
    one_rate = part.omega.max() < 1.01 * part.omega.min()
    # NaN where no temperature is known: not held
    return bool(one_rate and np.ptp(part.temperature) < _HELD)


def _from_names(parts: list[Dma]) -> list[Dma]:
    """The measurements with the temperatures that the names of their files give to
    those without, one to each file.

    A dash right behind a word ("rubber-20C") may be a minus or not: such names say
    nothing.
    """
    every = [part.source for part in parts]
    for i, part in enumerate(parts):
        stem = re.sub("[\u2212\u2013]", "-", Path(part.source).stem)
        found = _NAME.findall(stem)
        dash = re.search(
            r"[A-Za-z0-9)]-\d+(?:[.,]\d+)?[ _]?(?:deg ?C|°C|C|K)(?![A-Za-z0-9])", stem
        )
        without = not np.isfinite([*part.temperature, *part.time_temperature]).any()
        if without and len(found) == 1 and not dash and every.count(part.source) == 1:
            factor, offset = to_si(found[0][1].replace(" ", ""), "temperature") or (
                1.0,
                0.0,
            )
            kelvin = float(found[0][0].replace(",", ".")) * factor + offset
            words = f"temperature {kelvin - 273.15:g} degC from the name of the file"
            parts[i] = replace(
                part.at(kelvin),
                columns=tuple(f"{text}; {words}" for text in part.columns),
            )
    return parts


def _with_temperatures(parts: list[Dma], temperature: Any) -> list[Dma]:
    """The measurements with the temperatures that the user gives to those without."""
    without = [
        i
        for i, one in enumerate(parts)
        if not np.isfinite([*one.temperature, *one.time_temperature]).all()
    ]
    if temperature is None:
        for i in without:
            known = np.isfinite(
                np.concatenate([parts[i].temperature, parts[i].time_temperature])
            )
            rates = np.concatenate([parts[i].omega, 1 / parts[i].time])[~known]
            if parts[i].omega.size and in_strain_sweep(parts[i]).all():
                continue  # nobody shifts it
            text = (
                f"{parts[i].source}: there is no temperature, which shifting needs: "
                f"{untold(rates)}"
            )
            parts[i] = replace(parts[i], warnings=(*parts[i].warnings, text))
        return parts
    given = [
        float(plain("temperature", one))
        for one in (temperature if np.ndim(temperature) else [temperature])
    ]
    in_kelvin("temperature", given, COLDEST)
    if not without:
        celsius = np.unique(
            np.concatenate([[*one.temperature, *one.time_temperature] for one in parts])
            - 273.15
        )
        raise InputError(
            f"temperature must be left out, got {describe_list(given, 'K')}: the "
            f"files say {describe_list(np.unique(celsius.round(1)), 'degC')}."
        )
    if len(given) not in (1, len(without)):
        raise InputError(
            f"temperature must be one number, or one for each of the {len(without)} "
            f"isotherms without, got {len(given)}."
        )
    for i, kelvin in zip(
        without, given * len(without) if len(given) == 1 else given, strict=True
    ):
        words = f"temperature {kelvin - 273.15:g} degC, as given"
        parts[i] = replace(
            parts[i].at(kelvin),
            columns=tuple(f"{text}; {words}" for text in parts[i].columns),
        )
    return parts
