"""`elastomdr fit DMA ...`: measured isotherms to a material file, cards, tables and
figures. The options are the keys of one table, which is the form of the page as well.

`elastomdr calibrate SCENE.toml`: measured friction to the scene, material and surface
that give it.
"""

import argparse
import contextlib
import copy
import dataclasses
import os
import re
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple

import elastomdr as em

from ..errors import InputError, as_options, quiet, told
from ..files import csv_text
from ..trees import replaced
from . import DONE, NOT_CONVERGED
from .kinds import decoded, read_content, toml
from .schema import (
    Content,
    Plain,
    Several,
    Table,
    Text,
    decode,
    given,
    keys_of,
    of_file,
    path_from,
)
from .typed import from_text, is_number
from .units import Area, Duration, Length, MolarEnergy, Temperature

if TYPE_CHECKING:
    from ..surface.spectrum import AbstractSpectrum

_READ = (
    "frequency_unit",
    "modulus_unit",
    "temperature_unit",
    "time_unit",
    "area",
    "length",
    "ramp",
)
_FITTED = ("terms", "balance", "temperature_error", "law", "poisson", "citation")
# what is printed without --verbose, of which findings
_FIRST = {
    "fitted": ("terms", "shift law"),
    "how well": ("misfit", "loss tangent"),
    "read": ("data", "columns"),
}
# of arguments whose options have other names
_OPTIONS = {"data": "DMA", "columns": "--column"}
_LAW = re.compile(r"\s*(WLF|Arrhenius|VFT)\s*\((.*)\)\s*", re.IGNORECASE)
# by name, an example with the units of the constants
_LAWS = {
    "wlf": ("WLF", "WLF(8.9, 101.6, 20degC)", ("", "K")),
    "vft": ("VFT", "VFT(1000, -100degC, 20degC)", ("K", "degC")),
    "arrhenius": ("Arrhenius", "Arrhenius(80 kJ/mol, 20degC)", ("J/mol",)),
}
FileName = Annotated[
    str,
    Plain(
        "letters, digits, dots and dashes",
        (str,),
        lambda name: re.fullmatch(r"[\w.-]+", name),
    ),
]
Column = Annotated[
    str,
    Plain(
        "a role and a title or number, such as storage=4",
        (str,),
        lambda entry: all(map(str.strip, (*entry.partition("="),))),
    ),
]


class Fit(Table):
    """How measured isotherms are read and made into a material.

    Keys:
        data: measured isotherms; several files of one material are joined
        reference: reference temperature, such as 20degC, by default the isotherm
            nearest 20 degC
        name: name of the material and of its files, by default that of the data
        poisson: Poisson's ratio, by default 0.5, with a warning for tensile moduli
        kind: what the moduli are, where the file does not say
        temperature: of all points, such as 20degC, or one for each isotherm, such as
            -20degC,0degC,20degC, where the file does not say
        frequency_unit: Hz or rad/s, where the file does not say
        modulus_unit: Pa, kPa, MPa or GPa, where the file does not say
        temperature_unit: degC or K, where the file does not say
        time_unit: s, ms, min or h, where the file does not say
        column: a column by quantity, its title or number, such as storage=4
        area: section of the specimen, such as 100 mm2, where the file has stiffness
        length: length of the specimen, in shear its height, such as 20 mm, where the
            file has stiffness
        ramp: duration of the ramp before relaxation, such as 1 s, where times count
            from its start
        strain: amplitude to use, such as 0.1 %, where several were measured; by
            default the smallest
        softening: strain sweeps of the same rubber, a file: the material softens as they
            say
        storage_only: there is no loss modulus: it is taken from the spectrum
        shift: a known shift law, such as WLF(8.9, 101.6, 20degC),
            VFT(1000, -100degC, 20degC) or Arrhenius(80 kJ/mol, 20degC), a file of
            shift factors, or universal; by default the data decide
        law: shift law, by default the data decide
        vertical: with or without vertical shifts; by default the data decide
        terms: number of relaxation times, by default the data decide
        balance: how many times more exactly the storage modulus is met than the loss
            modulus; by default by their scatter, alike where they contradict each other
        temperature_error: standard error of the temperature of an isotherm [K], by
            default by the scatter of the shift factors, about 0.3
        citation: where the data come from, for the material file
    """

    data: list[str]
    reference: Temperature | None = None
    name: FileName | None = None
    poisson: float | None = None
    kind: Literal["shear", "tensile"] | None = None
    temperature: Several[Temperature] | None = None
    frequency_unit: Text | None = None
    modulus_unit: Text | None = None
    temperature_unit: Text | None = None
    time_unit: Text | None = None
    column: Several[Column] | None = None
    area: Area | None = None
    length: Length | None = None
    ramp: Duration | None = None
    strain: Text | None = None
    softening: Text | None = None
    storage_only: bool = False
    shift: Text | None = None
    law: Literal["auto", "WLF", "Arrhenius", "VFT", "table", "none"] | None = None
    vertical: bool | None = None
    terms: int | None = None
    balance: float | None = None
    temperature_error: float | None = None
    citation: Text | None = None

    def read(self, folder: Path) -> "em.fit.Dma":
        """The measurement in the files. Raises `InputError`."""
        options = given(self, "kind", "temperature", *_READ)
        if self.temperature is not None and len(self.temperature) == 1:
            (options["temperature"],) = self.temperature
        with path_from("data", folder, {*keys_of(Fit), "columns"}):
            dma = em.read_dma(
                [folder / name for name in self.data],
                columns=dict(map(_column, self.column or ())),
                storage_only=self.storage_only,
                **options,
            )
        return dma if self.strain is None else dma.at_strain(strain_of(self.strain))

    def fitted(
        self, folder: Path, progress: Callable[[int, int], None] | None = None
    ) -> "em.fit.MaterialFit":
        """The material; all warnings are in its summary. Raises `InputError`."""
        options = given(self, "name", "vertical", *_FITTED)
        with quiet():
            dma = self.read(folder)
            shift, vertical = law_of(self.shift, folder)
            if self.vertical is None:
                options["vertical"] = vertical
            softening = self._softening(folder)
            fit = em.fit.material(
                dma, self.reference, shift=shift, progress=progress, **options
            )
        if softening is None:
            return fit
        return dataclasses.replace(
            fit,
            material=replaced(fit.material, softening=softening),
            warnings=(*fit.warnings, *softening.warnings),
        )

    def _softening(self, folder: Path) -> "em.fit.SofteningFit | None":
        """What the strain sweeps say. Raises `InputError`."""
        if self.softening is None:
            return None
        file = folder / self.softening
        with path_from("softening", folder):
            try:
                sweeps = em.read_dma(file)
            except InputError as error:
                if error.argument != "kind":
                    raise
                # what the file does not say is as of the isotherms
                sweeps = em.read_dma(file, kind=self.kind or "shear")
            if sweeps.kind == "tensile":  # shear strain of the same distortion
                sweeps = dataclasses.replace(sweeps, strain=3**0.5 * sweeps.strain)
            return em.fit.softening(sweeps)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The options of this command."""
    # "-20degC" is a temperature, not an option
    parser._negative_number_matcher = re.compile(r"-\.?\d")
    add = parser.add_argument
    for name, key in keys_of(Fit).items():
        option, words = f"--{name.replace('_', '-')}", key.meaning.replace("%", "%%")
        if name == "data":
            add(name, metavar="DMA", nargs="*", help=words)
        elif key.flag:
            flag = argparse.BooleanOptionalAction if key.optional else "store_true"
            add(option, action=flag, help=words)
        else:
            action = "append" if name == "column" else "store"
            metavar = "|".join(key.words) or None
            add(option, action=action, metavar=metavar, help=words)
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


def run(options: argparse.Namespace) -> int:
    """Writes everything that a fit gives; returns the exit status. Nothing is written
    before all is computed.
    """
    from .compute import aligned, output_folder

    folder = output_folder(options.out)
    if (options.shore_a is None) == (not options.data):
        raise InputError(
            argument="DMA",
            got=options.data or None,
            accepted="given, one file or more, or --shore-a in place of them",
        )
    try:
        # a hardness has no files
        asked = decode(Fit, {"data": [""], **content_of(options)})
        if options.shore_a is not None:
            return _from_hardness(options, folder)
        with em.progress("reading and fitting"):
            fit = asked.fitted(Path())
    except InputError as error:
        _as_option(error, *keys_of(Fit), "columns")
        raise
    folder.mkdir(parents=True, exist_ok=True)
    paths = fit.save(folder)
    path = (folder / f"{fit.material.name}.toml").as_posix()
    said = dict(fit.findings())
    lines = {
        name: "; ".join(f"{part} {said[part]}" for part in parts if part in said)
        for name, parts in _FIRST.items()
    }
    doubts = " ".join(told(each, advice=as_options) for each in fit.warnings)
    lines["doubts"] = doubts or "none"
    print(fit.summary() if options.verbose else aligned(lines.items()))
    print(
        f"wrote     {path} and {len(paths) - 1} more files; on a measured profile: "
        f"elastomdr init road.toml --material {path} --profile PROFILE.csv"
    )
    converged = fit.master.converged and fit.prony.converged
    return DONE if converged else NOT_CONVERGED


def _as_option(error: InputError, *arguments: str) -> bool:
    """Gives an error of one of these arguments the name that this has as an option;
    whether it is of one.
    """
    name, *place = error.argument.partition("[")
    if name in arguments:
        option = _OPTIONS.get(name, f"--{name.replace('_', '-')}")
        error.called("".join((option, *place)))
    return name in arguments


def content_of(options: argparse.Namespace) -> Content:
    """What is asked for, as a scene file would hold it; temperatures without a unit are
    in degC, as instruments write them.
    """
    content: Content = {}
    for name, key in keys_of(Fit).items():
        value = getattr(options, name)
        if isinstance(value, str):
            unit = "degC" if key.quantity is Temperature else ""
            value = value.replace(",", ", ") if key.several else value
            value = from_text(key, value, unit)
        if value not in (None, []):
            content[name] = value
    return content


def _from_hardness(options: argparse.Namespace, folder: Path) -> int:
    """Writes a material that is known by its hardness only."""
    from ..fit.pipeline import from_hardness, save_hardness

    material = from_hardness(
        options.shore_a, like=options.like, name=options.name or ""
    )
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{material.name}.toml"
    save_hardness(material, options.shore_a, options.like, path)
    about = f"moduli within a factor of two, loss tangent of {options.like}"
    print(f"estimated {material.name}, {material.citation}: {about}")
    print(f'wrote     {path.name}; in a scene here: material = "{path.as_posix()}"')
    return DONE


def law_of(option: str | None, folder: Path = Path()) -> tuple[Any, Any]:
    """A shift law from its name and constants, or from a file, with the vertical
    factors that this may have; "universal" as it is.
    """
    from ..io.point_tables import vertical_factors

    if option is None or option.strip() == "universal":
        return option and option.strip(), None
    match = _LAW.fullmatch(option)
    if match is None:
        return em.read_shifts(folder / option), vertical_factors(folder / option)
    law, example, units = _LAWS[match[1].lower()]
    try:
        pairs = zip(match[2].split(","), (*units, "degC"), strict=True)
        constants = [_constant(piece.strip(), unit) for piece, unit in pairs]
    except ValueError as error:  # an `InputError` among them
        raise InputError(
            argument="shift", got=option, accepted=f'a law such as "{example}"'
        ) from error
    return getattr(em, law)(*constants), None


def _constant(piece: str, unit: str) -> float:
    """A constant of a law. Raises `ValueError`."""
    if unit == "degC":
        return Temperature.read(f"{piece} degC" if is_number(piece) else piece)
    if unit == "J/mol":
        return MolarEnergy.read(piece)
    return float(piece.removesuffix(unit))


def strain_of(option: str) -> float:
    """A strain amplitude [-], given as it is or in per cent."""
    number = option.strip().removesuffix("%").strip()
    if not is_number(number):
        raise InputError(
            argument="strain",
            got=option,
            accepted='an amplitude such as "0.1 %" or 0.001',
        )
    return float(number) / (100 if "%" in option else 1)


def _column(option: str) -> tuple[str, str]:
    role, _, title = option.partition("=")
    return role.strip(), title.strip()


_OF_LOAD = ("pressure", "load", "depth")
# of a [surface], the parameter of each, and its size for one decade of that: C goes as
# the heights squared
_ERRORS = {"cutoff_error": ("q_high", 2.3026), "level_error": ("heights", 4.6052)}


class Calibrated(NamedTuple):
    """What was found, and the scene that has it."""

    found: "em.fit.Calibration"
    content: Content
    files: dict[str, Callable[[Path], object]]  # material, surface, table and figure
    data: "em.MeasuredFriction"
    measured: Path

    @property
    def doubts(self) -> list[str]:
        """What is to be doubted in what was found, and in the curve at its points."""
        plain = (replaced(each, remedy="").words() for each in self.found.doubts)
        return [*self.found.warnings, *(f"Measured: {said}." for said in plain)]

    def lines(self) -> dict[str, str]:
        """What is printed."""
        found = self.found
        known = ", ".join(f"{name} {found.in_units(name)}" for name in found.decided)
        known = known or "nothing: the data decide none of the parameters"
        said = dict(found.findings())
        if "weakest" in said:
            known += f"; least known {said['weakest']}"
        doubts = " ".join((*self.data.report, *self.doubts))
        return {
            "read": self.data.columns,
            "found": known,
            "residuals": said["residuals"],
            "doubts": doubts or "none",
        }


def calibrated(
    content: Content,
    folder: Path,
    parameters: Sequence[str],
    *,
    measured: Path | None = None,
    columns: Sequence[str] = (),
    draws: int = 0,
    stem: str = "friction",
) -> Calibrated:
    """A scene of friction with what measured points say of it; its files, whose names
    begin with `stem`, go beside it. The points are those of the scene unless others are
    given, with `columns` by quantity, such as "mu=4". The errors of its surface are
    what is known beforehand, and stay: the points stand for what they tell. What moved
    farther may have been as far off. Raises `InputError`.
    """
    import numpy as np

    from ..material.library import material_info
    from ..results.base import NORMAL
    from ..results.uncertainty import FACTOR, HEIGHTS
    from ..surface.spectrum import AbstractSpectrum
    from .compute import write_figure

    if "gain" in parameters:
        raise InputError(
            argument="parameters",
            got="gain",
            accepted="parameters that a scene can hold",
        )
    content = copy.deepcopy(content)
    named = content.pop("measured", None)
    if measured is None and not isinstance(named, str):
        raise InputError(
            argument="measured", got=named, accepted="a file of measured friction"
        )
    file = measured or folder / str(named)
    plain = copy.deepcopy(content)
    plain.pop("uncertainty", None)
    known: Any = plain.get("surface", {})
    widths = {
        name: known.pop(key) / decades
        for key, (name, decades) in _ERRORS.items()
        if isinstance(known, dict) and isinstance(known.get(key), int | float)
    }
    scene: Any = decoded("friction", plain)
    with (
        quiet(em.fit.FitWarning),
        path_from("measured", Path() if measured else folder, {"columns"}),
    ):
        data = em.read_friction(file, columns=dict(map(_column, columns)))
    given: Any = scene.arguments(folder) | data.points
    if data.pressure is not None:
        given = {k: v for k, v in given.items() if k not in _OF_LOAD}
        given["pressure"] = data.pressure
    for name in ("temperature", "direction", *_OF_LOAD):
        if np.size(given.get(name, 0.0)) not in (1, data.mu.size):
            raise InputError(
                argument=name,
                got=np.ravel(given[name]).tolist(),
                accepted=f"a single value, since {data.source} has no column of it",
            )
    with quiet(), scene.in_keys():
        found = em.fit.calibrate(
            given.pop("material"),
            given.pop("shape"),
            measured=given.pop("mu"),
            **given,
            error=data.error,
            parameters=parameters,
            widths=widths,
            draws=draws,
        )
    files: dict[str, Callable[[Path], object]] = {
        f"{stem}-calibrate.csv": found.to_csv,
        f"{stem}-calibrate.png": partial(write_figure, found, {}),
    }
    done = Calibrated(found, content, files, data, file)
    name, doubts = scene.material[0], [said.rstrip(".") for said in done.doubts]
    about = material_info(folder / name if name.endswith(".toml") else name)
    if not found.decided:  # moved within what was assumed: nothing to compute with
        return done
    described, file_name = about.get("description", name), f"{stem}-material.toml"
    about["description"] = "; ".join([described, "calibrated", *doubts])
    files[file_name] = partial(em.save_material, found.material, info=about)
    content |= {"material": file_name}
    content |= {"doubts": doubts} if doubts else {}
    if data.temperature is not None and "temperature" not in content:
        kelvin = np.unique(np.round(data.temperature - 273.15))
        content["temperature"] = [f"{t:g} degC" for t in kelvin]
    if not getattr(found.material.range, "misfit", ()):
        content.pop("uncertainty", None)
    if isinstance(surface := found.shape, AbstractSpectrum):
        files[f"{stem}-surface.csv"] = partial(_write_surface, surface, doubts)
        road = content["surface"]
        road["cutoff"] = f"{float(surface.q_high)!r} rad/m"
        if "heights" in found.parameters:
            factor = 10 ** found.parameters["heights"]
            road["heights"] = road.get("heights", 1.0) * factor
        assumed = {
            "cutoff_error": FACTOR.low.shorter,
            "level_error": HEIGHTS.low.higher**2,
        }
        for key, (name, decades) in _ERRORS.items():
            moved = abs(found.parameters.get(name, 0.0)) * decades
            if moved > NORMAL * road.get(key, np.log(assumed[key]) / NORMAL):
                road[key] = moved / NORMAL
    if (law := found.adhesion) is not None and not law.typical:
        content["adhesion"] = {
            "stress": f"{float(law.stress)!r} Pa",
            "velocity": f"{float(law.velocity)!r} m/s",
            "width": float(law.width),
        }
        if isinstance(law.shift, em.Arrhenius):
            content["adhesion"] |= {
                "energy": f"{float(law.shift.energy)!r} J/mol",
                "reference": f"{float(law.shift.reference) - 273.15:.10g} degC",
            }
    return done


def _write_surface(
    surface: "AbstractSpectrum", doubts: Sequence[str], path: Path
) -> None:
    header = ["power spectrum C of the surface, convention 2d: <h^2> = int C d^2q"]
    header += [f"calibrated: {each}" for each in doubts]
    columns = {"q [rad/m]": surface.q, "C [m^4]": surface.c}
    path.write_text(csv_text(header, columns), encoding="utf-8")


def run_calibration(options: argparse.Namespace) -> int:
    """Writes the scene with its material and surface, table and figure; returns the
    exit status.
    """
    from .compute import aligned, output_folder, warned_of_at_the_end, write_all

    path, folder = Path(options.scene), output_folder(options.out)
    with of_file(path):
        content = read_content(path)
    try:
        with warned_of_at_the_end(), em.progress("calibrating"):
            done = calibrated(
                content,
                path.parent,
                [name.strip() for name in options.parameters.split(",")],
                measured=options.measured and Path(options.measured),
                columns=options.column,
                draws=options.draws,
                stem=path.stem,
            )
    except InputError as error:
        named = _as_option(error, "measured", "parameters", "draws", "columns")
        if not (named or error.places):
            error.inside(path.name)
        raise
    scene: Any = dict(done.content)
    if not options.column:  # which a scene cannot name: it could not read the file
        scene["measured"] = os.path.relpath(done.measured, folder)
    for table in scene.values():
        if isinstance(table, dict) and isinstance(file := table.get("file"), str):
            table["file"] = os.path.relpath(path.parent / file, folder)
    name, files, said = f"{path.stem}-calibrated", done.files, done.lines()
    if done.found.decided:
        notes = (
            f"calibrated with {done.measured.name}",
            *(f"{word}: {text}" for word, text in said.items()),
        )
        text = toml("friction", scene, name, notes)
        files |= {f"{name}.toml": lambda to: to.write_text(text, "utf-8")}
    write_all(folder, files)
    print(aligned(said.items()))
    if options.verbose:
        print(done.found.summary())
        points: Any = done.data.points
        with contextlib.suppress(InputError), quiet():  # too few to be shifted
            print(em.fit.friction_master(**points, error=done.data.error).summary())
    print(f"wrote     {', '.join(str(folder / name) for name in files)}")
    return DONE if done.found.converged else NOT_CONVERGED
