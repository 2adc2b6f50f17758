"""`elastomdr materials [NAME]`: the library, or the numbers and sources of one material."""

import argparse
import shutil
import textwrap
from collections.abc import Iterator
from typing import Any

from ..errors import InputError
from ..material.format import read_document
from ..material.library import locate, material_info, materials
from .main import DONE

_SHIFT_UNITS = {"c1": "", "c2": " K", "energy": " J/mol", "b": " K", "t0": " K", "reference": " K"}
_RANGE_UNITS = {"frequency": "rad/s", "time": "s", "temperature": "K"}


def run(arguments: argparse.Namespace) -> int:
    """Prints the library's names, or one material; returns the exit status."""
    lines = _library() if arguments.name is None else _one(arguments.name)
    print("\n".join(lines))
    return DONE


def _library() -> Iterator[str]:
    names = materials()
    width = max(map(len, names), default=0) + 2
    columns = shutil.get_terminal_size((120, 24)).columns
    for name in names:
        yield textwrap.shorten(f"{name} {_first_line(name)}", max(60, columns), placeholder=" ...").replace(
            name, f"{name:<{width - 1}}", 1
        )
    yield ""
    yield "elastomdr materials NAME shows the numbers, ranges and sources of one of them."


def _first_line(name: str) -> str:
    try:
        info = material_info(name)
    except InputError as error:  # somebody's broken file must not hide the others
        return f"({error})"
    grade = info.get("source", {}).get("moduli", {}).get("grade")
    return info.get("description", "").strip() + (f" [{grade}]" if grade else "")


def _one(name: str) -> Iterator[str]:
    path = locate(name)
    info, document = material_info(path), read_document(path)
    yield info["name"]
    if info.get("description"):
        yield from textwrap.wrap(info["description"], 100)
    yield ""
    symbol = "G" if info["kind"] == "shear" else "E"
    yield from _row("moduli", f"{info['kind']} ({symbol})")
    yield from _row("relaxed", f"{_pascal(info['equilibrium'])}" + (" (a liquid)" if info["equilibrium"] == 0 else ""))
    yield from _row("glassy", _pascal(info["glassy"]))
    if info.get("viscosity"):
        yield from _row("dashpot", f"{info['viscosity']:.6g} Pa s, in parallel")
    if "bulk" in info:
        yield from _row("bulk modulus", _pascal(info["bulk"]))
    else:
        yield from _row("Poisson", f"{info['poisson']:g}" + (" (incompressible)" if info["poisson"] == 0.5 else ""))
    if "reference_temperature" in info:
        yield from _row("reference", _kelvin(info["reference_temperature"]))
    if "shift" in info:
        yield from _row("shift law", _shift(info["shift"]))
    else:
        yield from _row("shift law", "none: temperature cannot be given")
    for key, pair in info.get("range", {}).items():
        words = f"{pair[0]:.4g} to {pair[1]:.4g} {_RANGE_UNITS[key]}" if pair else "nowhere known well enough"
        yield from _row(f"valid {key}", words)
    for group, source in info.get("source", {}).items():
        yield from _row(f"source, {group}", _source(source))
    yield from _row("file", info["path"])
    if document["times"]:
        yield ""
        yield f"{'relaxation time [s]':>21}  {f'{symbol} [Pa]':>14}"
        for time, modulus in zip(document["times"], document["moduli"], strict=True):
            yield f"{time:>21.6g}  {modulus:>14.6g}"


def _row(name: str, text: str) -> list[str]:
    return textwrap.wrap(text, 100, initial_indent=f"{name:<19}", subsequent_indent=" " * 19, break_on_hyphens=False)


def _shift(shift: dict[str, Any]) -> str:
    if shift["law"] == "table":
        temperature, factor = shift["temperature"], shift["log10_a"]
        return (
            f"table, {len(temperature)} temperatures from {_kelvin(temperature[0])} to {_kelvin(temperature[-1])}, "
            f"log10 a_T {factor[0]:.4g} to {factor[-1]:.4g}"
        )
    numbers = (f"{key} = {value:.6g}{_SHIFT_UNITS[key]}" for key, value in shift.items() if key != "law")
    return f"{shift['law']}: " + ", ".join(numbers)


def _source(source: dict[str, Any]) -> str:
    parts = [f"[{source['grade']}]"] if "grade" in source else []
    parts += [" ".join(source[key].split()).rstrip(".") + "." for key in ("citation", "note") if source.get(key)]
    for key in ("storage_residual", "loss_residual"):
        if key in source:
            parts.append(f"{key.replace('_', ' ')} {100 * source[key]:.2g} %.")
    return " ".join(parts)


def _pascal(value: float) -> str:
    for unit, size in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)):
        if value >= size:
            return f"{value / size:.5g} {unit}"
    return f"{value:.5g} Pa"


def _kelvin(value: float) -> str:
    return f"{value:.6g} K ({round(value - 273.15, 3):g} degC)"
