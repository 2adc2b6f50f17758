"""`elastomdr fit DMA.csv ...`: measured isotherms to a material file, cards, tables and figures."""

import argparse
import re
import sys
import warnings
from typing import Any

from ..errors import InputError
from .curve import _folder, _write
from .main import DONE, NOT_CONVERGED
from .units import TEMPERATURE, quantity


def add_arguments(command: argparse.ArgumentParser) -> None:
    """The options of this verb."""
    command._negative_number_matcher = re.compile(r"-\.?\d")  # "-20degC" is a temperature, not an option
    add = command.add_argument
    add("data", metavar="DMA", nargs="+", help="measured isotherms; several files of one material are joined")
    add(
        "--reference", metavar="T", help='reference temperature, such as "20degC" (default: the isotherm nearest to it)'
    )
    add("--out", metavar="DIR", default=".", help="folder for the files (default: this one)")
    add("--name", help="name of the material and of its files (default: that of the data)")
    add("--kind", choices=("shear", "tensile"), help="what the moduli are, where the file does not say")
    add("--frequency-unit", metavar="UNIT", help="Hz or rad/s, where the file does not say")
    add("--modulus-unit", metavar="UNIT", help="Pa, kPa, MPa or GPa, where the file does not say")
    add("--temperature-unit", metavar="UNIT", help="degC or K, where the file does not say")
    add("--time-unit", metavar="UNIT", help="s, ms, min or h, where the file does not say")
    add("--temperature", metavar="T", help="temperature of all points, where the file has no such column")
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
        help="with or without vertical shifts (default: without where they are large, the data leave open whether "
        "there are any, and the material is then closer to the data as measured)",
    )
    add("--terms", type=int, help="number of relaxation times (default: the data decide)")
    add(
        "--balance",
        type=float,
        metavar="FACTOR",
        help="how many times more exactly the storage modulus is met than the loss modulus (default: their scatter)",
    )
    add("--law", default="auto", help="auto, WLF, Arrhenius, VFT, table or none (default: auto)")
    add("--poisson", type=float, help="Poisson's ratio (default: 0.5, with a warning for tensile moduli)")
    add("--citation", default="", help="where the data come from, for the material file")


def run(arguments: argparse.Namespace) -> int:
    """Writes everything that a fit gives; returns the exit status. Nothing is written before all is computed."""
    folder = _folder(arguments.out)
    reference = _kelvin("--reference", arguments.reference)
    name = arguments.name
    if name is not None and not re.fullmatch(r"[\w.-]+", name):
        raise InputError(f"--name must be letters, digits, dots and dashes, got {name!r}.")
    from .. import fit

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", fit.FitWarning)  # all of them are in the summary
        dma = fit.read_dma(
            arguments.data,
            kind=arguments.kind,
            frequency_unit=arguments.frequency_unit,
            modulus_unit=arguments.modulus_unit,
            temperature_unit=arguments.temperature_unit,
            time_unit=arguments.time_unit,
            temperature=_kelvin("--temperature", arguments.temperature),
            columns=dict(_column(text) for text in arguments.column),
        )
        found = fit.material(
            dma,
            reference,
            vertical=arguments.vertical,
            terms=arguments.terms,
            balance=arguments.balance,
            poisson=arguments.poisson,
            law=arguments.law,
            name=name or "",
            citation=arguments.citation,
        )
        files = {folder / stem: content for stem, content in found.files().items()}
    _write(folder, files)
    print(found.summary())
    print(f"wrote {len(files)} files: {', '.join(path.name for path in files)} in {folder}")
    print(f'in a scene file here: material = "{folder.as_posix()}/{found.material.name}.toml"')
    if found.master.converged and found.prony.converged:
        return DONE
    print("elastomdr: warning: the fit did not converge; look at its figures before using it.", file=sys.stderr)
    return NOT_CONVERGED


def _kelvin(name: str, text: str | None) -> float | None:
    return None if text is None else quantity(name, text, TEMPERATURE)


def _column(text: str) -> tuple[str, Any]:
    role, equals, title = text.partition("=")
    if not equals or not role or not title:
        raise InputError(f"--column must be a role and a title or number, such as storage=4, got {text!r}.")
    return role.strip(), int(title) if title.strip().isdigit() else title
