"""`elastomdr fit DMA ...`: measured isotherms to a material file, cards, tables and
figures.
"""

import argparse
import re
import sys
from pathlib import Path
from typing import Any

from ..errors import InputError, quiet
from . import DONE, NOT_CONVERGED

_READ = ("kind", "frequency_unit", "modulus_unit", "temperature_unit", "time_unit")
SIZES = {"area": "area", "length": "length", "ramp": "time"}
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)(e[-+]?\d+)?", re.IGNORECASE)
_LAW = re.compile(r"\s*(WLF|Arrhenius|VFT)\s*\((.*)\)\s*", re.IGNORECASE)
_LAWS = {
    "wlf": "WLF(8.9, 101.6, 20degC)",
    "vft": "VFT(1000, -100degC, 20degC)",
    "arrhenius": "Arrhenius(80 kJ/mol, 20degC)",
}
_FITTED = (
    "vertical",
    "terms",
    "balance",
    "temperature_error",
    "law",
    "poisson",
    "citation",
)


# metavar and help of the options that take a text
_OF_DATA = {
    "reference": (
        "T",
        'reference temperature, such as "20degC" (default: the isotherm nearest it)',
    ),
    "name": (None, "name of the material and of its files (default: that of the data)"),
    "frequency-unit": ("UNIT", "Hz or rad/s, where the file does not say"),
    "modulus-unit": ("UNIT", "Pa, kPa, MPa or GPa, where the file does not say"),
    "temperature-unit": ("UNIT", "degC or K, where the file does not say"),
    "time-unit": ("UNIT", "s, ms, min or h, where the file does not say"),
    "temperature": (
        "T",
        'temperature of all points, such as "20degC", or one for each isotherm '
        'without, such as "-20degC,0degC,20degC"',
    ),
    "strain": (
        "PERCENT",
        'the strain amplitude to use, such as "0.1%%", where several were measured '
        "(default: the smallest)",
    ),
    "area": (
        "A",
        'section of the specimen, for a file of dynamic stiffness, such as "100 mm2"',
    ),
    "length": ("L", 'its length, in shear its height, such as "20 mm"'),
    "ramp": (
        "R",
        "duration of the ramp before relaxation; times count from its start, such as "
        '"1 s"',
    ),
    "shift": (
        "LAW",
        f"a known shift law: {', '.join(map(repr, _LAWS.values()))}, a file of shift "
        "factors, or universal (default: the data decide)",
    ),
}
# type, metavar and help of those that take a number
_NUMBERS: dict[str, tuple[type, str | None, str]] = {
    "terms": (int, None, "number of relaxation times (default: the data decide)"),
    "balance": (
        float,
        "FACTOR",
        "how many times more exactly the storage modulus is met than the loss modulus "
        "(default: by their scatter, alike where they contradict each other)",
    ),
    "temperature-error": (
        float,
        "K",
        "standard error of the temperature of an isotherm (default: by the scatter of "
        "the shift factors, about 0.3)",
    ),
    "poisson": (
        float,
        None,
        "Poisson's ratio (default: 0.5, with a warning for tensile moduli)",
    ),
}


def add_arguments(command: argparse.ArgumentParser) -> None:
    """The options of this command."""
    # "-20degC" is a temperature, not an option
    command._negative_number_matcher = re.compile(r"-\.?\d")
    add = command.add_argument
    files = "measured isotherms; several files of one material are joined"
    add("data", metavar="DMA", nargs="*", help=files)
    add(
        "--shore-a",
        metavar="H",
        type=float,
        help=(
            "no file, but the hardness: a spectrum of the library scaled to it, an "
            "estimate within a factor of two"
        ),
    )
    add(
        "--like",
        metavar="MATERIAL",
        default="sbr-gum-like",
        help="whose spectrum --shore-a scales (default: sbr-gum-like)",
    )
    out = "folder for the files (default: this one)"
    add("--out", metavar="DIR", default=".", help=out)
    kind = "what the moduli are, where the file does not say"
    add("--kind", choices=("shear", "tensile"), help=kind)
    for option, (metavar, words) in _OF_DATA.items():
        add(f"--{option}", metavar=metavar, help=words)
    without_loss = "there is no loss modulus: it is taken from the spectrum"
    add("--storage-only", action="store_true", help=without_loss)
    add(
        "--column",
        metavar="ROLE=TITLE",
        action="append",
        default=[],
        help="a column's title or number, such as storage=4",
    )
    add(
        "--vertical",
        action=argparse.BooleanOptionalAction,
        help="with or without vertical shifts (default: the data decide)",
    )
    for option, (number, metavar, words) in _NUMBERS.items():
        add(f"--{option}", type=number, metavar=metavar, help=words)
    laws = "auto, WLF, Arrhenius, VFT, table or none (default: auto)"
    add("--law", default="auto", help=laws)
    source = "where the data come from, for the material file"
    add("--citation", default="", help=source)


def run(options: argparse.Namespace) -> int:
    """Writes everything that a fit gives; returns the exit status. Nothing is written
    before all is computed.
    """
    from .compute import output_folder

    folder = output_folder(options.out)
    reference = _kelvin("--reference", options.reference)
    if options.name is not None and not re.fullmatch(r"[\w.-]+", options.name):
        raise InputError(
            f"--name must be letters, digits, dots and dashes, got {options.name!r}."
        )
    if isinstance(reference, list):
        raise InputError(
            f"--reference must be a single temperature, got {options.reference!r}."
        )
    if (options.shore_a is None) == (not options.data):
        raise InputError(
            "DMA must be given, one file or more, or --shore-a instead of them."
        )
    if options.shore_a is not None:
        return _from_hardness(options, folder)
    fit = _fitted(options, reference)
    folder.mkdir(parents=True, exist_ok=True)
    paths = fit.save(folder)
    print(fit.summary())
    names = ", ".join(path.name for path in paths)
    print(f"wrote {len(paths)} files: {names} in {folder}")
    path = (folder / f"{fit.material.name}.toml").as_posix()
    print(f'in a scene file here: material = "{path}"')
    print(
        f"friction on a measured profile: elastomdr init road.toml --material {path} "
        "--profile PROFILE.csv"
    )
    if fit.master.converged and fit.prony.converged:
        return DONE
    print(
        "elastomdr: warning: the fit did not converge; look at its figures before "
        "using it.",
        file=sys.stderr,
    )
    return NOT_CONVERGED


def _fitted(options: argparse.Namespace, reference: float | None) -> Any:
    """Reads the files and fits the material; all warnings are in its summary."""
    import elastomdr as em

    temperature = _kelvin("--temperature", options.temperature)
    columns = dict(map(_column, options.column))
    sizes: dict[str, Any] = {
        key: size_of(key, getattr(options, key), unit) for key, unit in SIZES.items()
    }
    with em.progress("reading and fitting"), quiet(em.fit.FitWarning):
        dma = em.read_dma(
            options.data,
            temperature=temperature,
            columns=columns,
            storage_only=options.storage_only,
            **{key: getattr(options, key) for key in _READ},
            **sizes,
        )
        if options.strain is not None:
            dma = dma.at_strain(strain_of(options.strain))
        fitted = {key: getattr(options, key) for key in _FITTED}
        if options.vertical is None:
            fitted["vertical"] = vertical_of(options.shift)
        return em.fit.material(
            dma,
            reference,
            name=options.name or "",
            shift=law_of(options.shift),
            **fitted,
        )


def _from_hardness(options: argparse.Namespace, folder: Path) -> int:
    """Writes a material that is known by its hardness only."""
    from ..fit.pipeline import from_hardness, save_hardness

    material = from_hardness(
        options.shore_a, like=options.like, name=options.name or ""
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{material.name}.toml"
    save_hardness(material, options.shore_a, options.like, path)
    print(f"{'material':<16}{material.name}: {material.citation}")
    print(
        f"{'estimated':<16}moduli within a factor of two, loss tangent of "
        f"{options.like}"
    )
    print(f'wrote {path.name}; in a scene file here: material = "{path.as_posix()}"')
    return DONE


def _kelvin(name: str, option: str | None) -> Any:
    """A temperature, or a list of them, in kelvin; numbers without a unit are in degC,
    as instruments write them.
    """
    if option is None:
        return None
    from .schema import of_key
    from .units import Temperature

    with of_key(name):
        parts = [
            f"{piece} degC" if _NUMBER.fullmatch(piece.strip()) else piece
            for piece in option.split(",")
        ]
        temperatures = [float(Temperature.read(piece)) for piece in parts]
    return temperatures if len(temperatures) > 1 else temperatures[0]


def vertical_of(option: str | None) -> Any:
    """The vertical factors in the file of a shift law, where it has any."""
    from ..io.point_tables import vertical_factors

    if option is None or option.strip() == "universal" or _LAW.fullmatch(option):
        return None
    return vertical_factors(option)


def law_of(option: str | None) -> Any:
    """A shift law from its name and constants, or from a file; "universal" as it is."""
    import elastomdr as em

    if option is None or option.strip() == "universal":
        return option and option.strip()
    match = _LAW.fullmatch(option)
    if match is None:
        return em.read_shifts(option)
    name, parts = match[1].lower(), [piece.strip() for piece in match[2].split(",")]
    units = {"wlf": ("", "K"), "vft": ("K", "degC"), "arrhenius": ("J/mol",)}[name]
    if len(parts) != len(units) + 1:
        raise InputError(
            f'--shift must be a law such as "{_LAWS[name]}", got {option!r}.'
        )
    constants = [
        _constant(piece, unit, _LAWS[name])
        for piece, unit in zip(parts, units, strict=False)
    ]
    return {"wlf": em.WLF, "vft": em.VFT, "arrhenius": em.Arrhenius}[name](
        *constants, _kelvin("--shift", parts[-1])
    )


def _constant(constant: str, unit: str, example: str) -> float:
    if unit == "degC":
        return float(_kelvin("--shift", constant))
    match = re.fullmatch(
        rf"({_NUMBER.pattern})\s*(k?J/mol|K)?", constant, re.IGNORECASE
    )
    known = {"": ("",), "K": ("", "k"), "J/mol": ("j/mol", "kj/mol")}[unit]
    if match is None or (symbol := (match[4] or "").lower()) not in known:
        raise InputError(
            f'--shift must be a law such as "{example}", got {constant!r} for '
            f"{unit or 'a number'}."
        )
    return float(match[1]) * (1000 if symbol == "kj/mol" else 1)


def size_of(key: str, option: str | None, kind: str) -> float | None:
    """A number with its unit in SI."""
    from ..units.registry import to_si, usual

    if option is None:
        return None
    match = re.fullmatch(rf"\s*({_NUMBER.pattern})\s*(\S.*)", option, re.IGNORECASE)
    si = to_si(match[4], kind) if match else None
    if match is None or si is None:
        raise InputError(
            f"--{key} must be a number with a unit of {kind} ({usual(kind)}), got "
            f"{option!r}."
        )
    return float(match[1]) * si[0]


def strain_of(option: str) -> float:
    """A strain amplitude [-], given as it is or in per cent."""
    match = re.fullmatch(r"\s*([\d.]+(?:[eE][-+]?\d+)?)\s*(%?)\s*", option)
    if match is None or match[1].count(".") > 1:
        raise InputError(
            f'--strain must be an amplitude such as "0.1%" or 0.001, got {option!r}.'
        )
    return float(match[1]) / (100 if match[2] else 1)


def _column(option: str) -> tuple[str, Any]:
    role, equals, title = option.partition("=")
    if not equals or not role or not title:
        raise InputError(
            "--column must be a role and a title or number, such as storage=4, got "
            f"{option!r}."
        )
    return role.strip(), int(title) if title.strip().isdigit() else title
