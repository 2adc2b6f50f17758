"""`elastomdr materials [NAME]`: the library, or the numbers and sources of one
material.
"""

import argparse
import shutil
import textwrap
from collections.abc import Iterator
from typing import Any

from ..errors import InputError
from ..material.format import is_tabulated, read_document
from ..material.library import locate, material_info, materials
from . import DONE
from .schema import path_from

_SHIFT_UNITS = {
    "c1": "",
    "c2": " K",
    "energy": " J/mol",
    "b": " K",
    "t0": " K",
    "reference": " K",
}
_RANGE_UNITS = {"omega": "rad/s", "time": "s", "temperature": "K"}


def run(options: argparse.Namespace) -> int:
    """Prints the library's names, or one material; returns the exit status."""
    print("\n".join(_library() if options.name is None else _one(options.name)))
    return DONE


def _library() -> Iterator[str]:
    names = materials()
    width = max(map(len, names), default=0) + 1
    columns = max(60, shutil.get_terminal_size((120, 24)).columns)
    for name in names:
        try:
            info = material_info(name)
            grade = info.get("source", {}).get("moduli", {}).get("grade")
            about = info.get("description", "") + (f" [{grade}]" if grade else "")
        except InputError as error:  # somebody's broken file must not hide the others
            about = f"({error})"
        yield (
            f"{name:<{width}} "
            f"{textwrap.shorten(about, columns - width - 1, placeholder=' ...')}"
        )
    yield (
        "\nelastomdr materials NAME shows the numbers, ranges and sources of one of "
        "them."
    )


def _one(name: str) -> Iterator[str]:
    with path_from("NAME"):
        path = locate(name)
        info, document = material_info(path), read_document(path)
    yield info["name"]
    yield from textwrap.wrap(info.get("description", ""), 100)
    yield ""
    for row, words in _rows(info, document):
        yield textwrap.fill(
            words,
            100,
            initial_indent=f"{row:<19}",
            subsequent_indent=" " * 19,
            break_on_hyphens=False,
        )
    symbol = "G" if info["kind"] == "shear" else "E"
    titles: dict[str, str] = {
        "times": "relaxation time [s]",
        "moduli": f"{symbol} [Pa]",
    }
    if is_tabulated(document):
        titles = {
            "omega": "omega [rad/s]",
            "storage": f"{symbol} storage [Pa]",
            "loss": f"{symbol} loss [Pa]",
        }
    if document[next(iter(titles))]:
        yield "\n" + "".join(f"{title:>21}" for title in titles.values())
        for row in zip(*(document[key] for key in titles), strict=True):
            yield "".join(f"{value:>21.6g}" for value in row)


def _rows(info: dict[str, Any], document: dict[str, Any]) -> Iterator[tuple[str, str]]:
    """What is known of a material, as pairs of a name and a text."""
    yield from _moduli(info, document)
    if "reference_temperature" in info:
        yield "reference", _kelvin(info["reference_temperature"])
    without = "none: no temperature can be given"
    yield "shift law", _shift(info["shift"]) if "shift" in info else without
    if "vertical" in info:
        yield "vertical shift", _vertical(info["vertical"])
    for key, pair in info.get("range", {}).items():
        words = "nowhere known well enough"
        if pair:
            words = f"{pair[0]:.4g} to {pair[1]:.4g} {_RANGE_UNITS[key]}"
        yield f"valid {key}", words
    if misfit := document.get("misfit"):
        worst = ", ".join(
            f"{key} {100 * max(misfit[f'{key}_residual']):.2g} %"
            for key in ("storage", "loss")
        )
        yield "misfit to data", f"at most, in bands of a quarter decade: {worst}, rms"
    for group, source in info.get("source", {}).items():
        yield f"source, {group}", _source(source)
    yield "file", info["path"]


def _moduli(
    info: dict[str, Any], document: dict[str, Any]
) -> Iterator[tuple[str, str]]:
    tabulated = is_tabulated(document)
    kind = info["kind"]
    yield "moduli", f"{kind}{', a table for surfaces in steady sliding' * tabulated}"
    if tabulated:
        ends = f"{info['lowest_omega']:.4g} to {info['highest_omega']:.4g} rad/s"
        low, high = (_pascal(document["storage"][i]) for i in (0, -1))
        yield "table", f"{info['points']} points, {ends}, storage {low} to {high}"
    else:
        equilibrium = info["equilibrium"]
        yield "relaxed", _pascal(equilibrium) + " (a liquid)" * (equilibrium == 0)
        yield "glassy", _pascal(info["glassy"])
    if info.get("viscosity"):
        yield "dashpot", f"{info['viscosity']:.6g} Pa s, in parallel"
    if "bulk" in info:
        yield "bulk modulus", _pascal(info["bulk"])
    else:
        poisson = info["poisson"]
        yield "Poisson", f"{poisson:g}{' (incompressible)' * (poisson == 0.5)}"


def _shift(shift: dict[str, Any]) -> str:
    if shift["law"] == "table":
        return _table(shift["temperature"], "log10 a_T", shift["log10_a"])
    numbers = (
        f"{key} = {value:.6g}{_SHIFT_UNITS[key]}"
        for key, value in shift.items()
        if key != "law"
    )
    return f"{shift['law']}: " + ", ".join(numbers)


def _vertical(vertical: dict[str, Any]) -> str:
    if vertical["law"] == "entropic":
        return f"b_T = T/{vertical['reference']:.6g} K, elasticity of entropy"
    return _table(vertical["temperature"], "b_T", vertical["factor"])


def _table(temperature: list[float], name: str, factor: list[float]) -> str:
    ends = f"{_kelvin(temperature[0])} to {_kelvin(temperature[-1])}"
    return (
        f"table, {len(temperature)} temperatures from {ends}, {name} {factor[0]:.4g} "
        "to "
        f"{factor[-1]:.4g}"
    )


def _source(source: dict[str, Any]) -> str:
    parts = [f"[{source['grade']}]"] if "grade" in source else []
    parts += [
        " ".join(source[key].split()).rstrip(".") + "."
        for key in ("citation", "note")
        if source.get(key)
    ]
    sizes = [key for key in ("storage_residual", "loss_residual") if key in source]
    return " ".join(
        [
            *parts,
            *(f"{key.replace('_', ' ')} {100 * source[key]:.2g} %." for key in sizes),
        ]
    )


def _pascal(value: float) -> str:
    unit, size = next(
        ((u, s) for u, s in (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3)) if value >= s),
        ("Pa", 1.0),
    )
    return f"{value / size:.5g} {unit}"


def _kelvin(value: float) -> str:
    return f"{value:.6g} K ({round(value - 273.15, 3):g} degC)"
