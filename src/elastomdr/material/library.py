"""The material library: TOML files, one per material, with the source and the grade of
every group of numbers.

Listing the names reads no file and loads neither NumPy nor JAX.
"""

import contextlib
import math
import os
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError, closest
from ..files import as_path
from .format import (
    SHIFT_KEYS,
    VERTICAL_KEYS,
    Document,
    is_tabulated,
    read_document,
    write_document,
)

if TYPE_CHECKING:
    from .prony import Prony
    from .shift import AbstractShift, AbstractVertical
    from .softening import Softening
    from .tabulated import TabulatedModulus
    from .validity import Range

SEARCH_VARIABLE = "ELASTOMDR_MATERIALS"
_MISFIT = ("omega", "storage_residual", "loss_residual")
# the laws of a file, and their classes in `material/shift.py`
SHIFT_LAWS = {
    "WLF": "WLF",
    "Arrhenius": "Arrhenius",
    "VFT": "VFT",
    "table": "ShiftTable",
}
# where a law keeps numbers under another name than its file does
_FIELDS = {"log10_a": "log10_a_table"}
VERTICAL_LAWS = {"entropic": "EntropicVertical", "table": "VerticalTable"}


def materials() -> list[str]:
    """Names in the library, sorted: the package's own, and those in the folders of
    `ELASTOMDR_MATERIALS`.
    """
    return sorted(_files())


def load_material(name_or_path: str | os.PathLike[str]) -> "Prony | TabulatedModulus":
    """The material of a name in the library, or of a TOML file: a `Prony`, or a
    `TabulatedModulus`.

    A text that ends in .toml or holds a slash is a path. Raises `InputError`, one line
    that names the file, for an unknown name, an unreadable file, unknown or missing
    keys, and numbers without meaning.
    """
    path = locate(name_or_path)
    document = read_document(path)
    from .prony import Prony
    from .tabulated import TabulatedModulus

    kind, keys = Prony, ("equilibrium", "moduli", "times")
    if is_tabulated(document):
        kind, keys = TabulatedModulus, ("omega", "storage", "loss")
    constants = {
        key: document[key]
        for key in ("poisson", "bulk", "viscosity")
        if key in document
    }
    try:
        material = kind(
            *(document[key] for key in keys),
            kind=document["kind"],
            shift=_law(document, "shift", SHIFT_LAWS),
            vertical=_law(document, "vertical", VERTICAL_LAWS),
            softening=_softening(document),
            name=document.get("name", path.stem),
            citation=_citation(document.get("source", {})),
            range=_range(document),
            **constants,
        )
        given = document.get("reference_temperature")
        if material.shift is not None and given is not None:
            reference = float(material.shift.reference)
            if not abs(reference - given) < 1e-4:
                raise InputError(
                    argument="reference_temperature",
                    got=given,
                    accepted=f"that of the shift law, {reference:.9g} K, where its "
                    "factor is 1",
                )
    except InputError as error:
        error.inside(str(path), "name_or_path")
        raise
    return material


def material_info(name_or_path: str | os.PathLike[str]) -> Document:
    """What the file says about a material, with its path: numbers, description, sources
    and grades, ranges.

    Loads no JAX. Raises `InputError` like `load_material`, but does not judge the
    numbers.
    """
    path = locate(name_or_path)
    return {"name": path.stem, "path": str(path), **read_document(path)}


def save_material(
    material: "Prony | TabulatedModulus",
    path: str | os.PathLike[str],
    *,
    info: Mapping[str, Any] | None = None,
) -> None:
    """Writes a material as a TOML file that `load_material` reads back bit for bit.

    `info` carries what the material does not: `description`, `reference_temperature`,
    `range` and `source`, as `material_info` returns them (its other entries are passed
    over); without it, the material's citation becomes the source of the moduli. The
    file appears complete or not at all. Raises `InputError` for anything but a `Prony`
    or a `TabulatedModulus` with concrete numbers, and where the file cannot be written.
    """
    from ..checks import untraced
    from .prony import Prony
    from .tabulated import TabulatedModulus

    if not isinstance(material, (Prony, TabulatedModulus)):
        raise InputError(
            argument="material", got=material, accepted="a Prony or a TabulatedModulus"
        )
    untraced(
        InputError(
            argument="material",
            accepted="saved outside jit, grad and vmap, with plain numbers",
        ),
        material,
    )
    if info is not None and not isinstance(info, Mapping):
        raise InputError(argument="info", got=info, accepted="a dict")
    info = info or {}
    known = material.range
    cited: dict[str, dict[str, str]] = {}
    if material.citation:
        cited["moduli"] = {"citation": material.citation}
    if known is not None and known.illustrative:
        cited["range"] = {"grade": "illustrative"}
    if known is not None and known.illustrative_moduli:
        cited.setdefault("moduli", {})["grade"] = "illustrative"
    document = {
        "name": material.name,
        "description": info.get("description"),
        "kind": material.kind,
        "reference_temperature": info.get("reference_temperature")
        or _reference_temperature(material),
        "poisson": None if material.poisson is None else float(material.poisson),
        **(_series(material) if isinstance(material, Prony) else _tabulated(material)),
        "shift": _law_table("shift", material.shift, SHIFT_LAWS, SHIFT_KEYS),
        "vertical": _law_table(
            "vertical", material.vertical, VERTICAL_LAWS, VERTICAL_KEYS
        ),
        "softening": _softening_table(material.softening),
        "range": info.get("range", (known and known.table()) or None),
        "misfit": _misfit_table(known),
        "source": info.get("source", cited or None),
    }
    write_document(
        {key: value for key, value in document.items() if value is not None},
        as_path(path),
    )


def _reference_temperature(material: "Prony | TabulatedModulus") -> float | None:
    """That of the shift law, where it has one."""
    if material.shift is None:
        return None
    reference = float(material.shift.reference)
    return reference if math.isfinite(reference) else None


def locate(name_or_path: str | os.PathLike[str]) -> Path:
    """The file of a name in the library, or the path itself; raises `InputError` where
    there is none.
    """
    if not isinstance(name_or_path, (str, os.PathLike)):
        raise InputError(
            argument="name_or_path",
            got=name_or_path,
            accepted="a name in the library or a path",
        )
    name = os.fspath(as_path(name_or_path, "name_or_path"))
    path = Path(name)
    if (
        isinstance(name_or_path, os.PathLike)
        or name.endswith(".toml")
        or "/" in name
        or os.sep in name
    ):
        if not _exists(path):
            beside = path.parent.glob("*.toml") if _exists(path.parent) else ()
            near = closest(path.name, (x.name for x in beside if _is_material(x)))
            near = near or closest(path.stem, _files())
            raise InputError(
                argument="name_or_path",
                got=name_or_path,
                accepted="a file that there is",
                hint=f"{near} Looked for in {path.absolute().parent}.".strip(),
            )
        return path
    files = _files()
    if name not in files:
        raise InputError(
            argument="name_or_path",
            got=name_or_path,
            accepted="in the library (em.materials(), `elastomdr materials`), or a "
            "path that ends in .toml",
            hint=f"{closest(name, files)} Looked for in {', '.join(map(str, _folders()))}.".strip(),
        )
    if len(files[name]) > 1:
        raise InputError(
            argument="name_or_path",
            got=name_or_path,
            accepted="in the library once",
            hint=f"give the path, one of {', '.join(map(str, files[name]))}",
        )
    return files[name][0]


def _exists(path: Path) -> bool:
    """Whether there is such a file; a name that is too long for one has none."""
    try:
        return path.exists()
    except OSError:
        return False


def _is_material(path: Path) -> bool:
    """Whether a TOML file may hold a material: it has a list of moduli."""
    try:
        content = path.read_bytes()
    except OSError:
        return False
    return b"moduli" in content or b"storage" in content


def _folders() -> list[Path]:
    """Where the files of the library are: the package, and the folders of the
    variable.
    """
    # where the wheel has them; a checkout has them at its root
    packaged = Path(__file__).parent / "data"
    folders = [
        packaged if packaged.is_dir() else Path(__file__).parents[3] / "materials"
    ]
    for entry in filter(None, os.environ.get(SEARCH_VARIABLE, "").split(os.pathsep)):
        if not Path(entry).is_dir():
            raise InputError(
                argument=SEARCH_VARIABLE,
                got=entry,
                accepted="a list of directories that there are",
            )
        folders.append(Path(entry))
    return list(dict.fromkeys(folder.resolve() for folder in folders))


def _files() -> dict[str, list[Path]]:
    """Every material file, by name. A name that is there twice is an error only for who
    asks for it.
    """
    files: dict[str, list[Path]] = {}
    for folder in _folders():
        for path in folder.glob("*.toml"):
            files.setdefault(path.stem, []).append(path)
    return files


def _series(material: "Prony") -> Document:
    return {
        "bulk": None if material.bulk is None else float(material.bulk),
        "equilibrium": float(material.equilibrium),
        "viscosity": float(material.viscosity) or None,
        "moduli": material.moduli.tolist(),
        "times": material.times.tolist(),
    }


def _tabulated(material: "TabulatedModulus") -> Document:
    return {
        "omega": material.omega.tolist(),
        "storage": material.storage_table.tolist(),
        "loss": material.loss_table.tolist(),
    }


def _softening_table(softening: "Softening | None") -> Document | None:
    keys = ("strain", "storage", "loss")
    return (
        None
        if softening is None
        else {key: getattr(softening, key).tolist() for key in keys}
    )


def _misfit_table(known: "Range | None") -> dict[str, list[float]] | None:
    if known is None or not known.misfit:
        return None
    return dict(zip(_MISFIT, map(list, zip(*known.misfit, strict=True)), strict=True))


def _law(document: Document, where: str, classes: Mapping[str, str]) -> Any:
    """A shift law from its table in a file."""
    from . import shift

    if where not in document:
        return None
    numbers = dict(document[where])
    with _in_table(where):
        return getattr(shift, classes[numbers.pop("law")])(**numbers)


def _softening(document: Document) -> "Softening | None":
    from .softening import Softening

    if "softening" not in document:
        return None
    with _in_table("softening"):
        return Softening(**document["softening"])


@contextlib.contextmanager
def _in_table(where: str) -> Iterator[None]:
    """Puts a table before the argument of an `InputError`."""
    try:
        yield
    except InputError as error:
        error.inside(f"[{where}]")
        raise


def _range(document: Document) -> "Range | None":
    """Where the numbers hold, as the file says."""
    from .validity import Range, as_range

    pairs = document.get("range")
    source = document.get("source", {})
    ranges, moduli = (
        source.get(group, {}).get("grade") == "illustrative"
        for group in ("range", "moduli")
    )
    known = as_range(pairs, ranges) if pairs else None
    if known is not None:
        known = known._replace(illustrative_moduli=moduli)
    rows = document.get("misfit")
    misfit = tuple(zip(*(rows[key] for key in _MISFIT), strict=True)) if rows else ()
    if any(not omega > 0 or storage < 0 or loss < 0 for omega, storage, loss in misfit):
        raise InputError(
            argument="[misfit] omega",
            accepted="positive, and both residuals zero or positive",
        )
    return (known or Range(None, None))._replace(misfit=misfit) if misfit else known


def _citation(source: Mapping[str, Mapping[str, Any]]) -> str:
    """The papers behind the moduli, the shift law and the softening, each once."""
    texts = (
        source.get(group, {}).get("citation", "")
        for group in ("moduli", "shift", "softening")
    )
    return "; ".join(dict.fromkeys(filter(None, texts)))


def _law_table(
    name: str,
    law: "AbstractShift | AbstractVertical | None",
    classes: Mapping[str, str],
    keys: Mapping[str, Any],
) -> Document | None:
    """A shift law as the table of a file; `keys` has the names of its numbers."""
    if law is None:
        return None
    label = next((key for key in classes if classes[key] == type(law).__name__), None)
    if label is None:
        raise InputError(
            argument=f"material.{name}",
            got=law,
            accepted=f"one of {', '.join(classes.values())} to be saved",
        )
    fields = {key: key for key in keys[label]} | _FIELDS
    return {
        "law": label,
        **{key: getattr(law, fields[key]).tolist() for key in keys[label]},
    }
