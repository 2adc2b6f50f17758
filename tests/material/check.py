"""Whether a material file is consistent: its numbers with polymers, its ranges with its
laws, its sources complete.
"""

import os
from collections.abc import Iterable, Iterator

import numpy as np

from elastomdr.errors import InputError
from elastomdr.material.format import Document, is_tabulated, read_document
from elastomdr.material.library import load_material, locate
from elastomdr.material.prony import Prony
from elastomdr.material.tabulated import TabulatedModulus

Limits = tuple[float, float]

# what a polymer in SI units has, by the key of the file
_USUAL: dict[str, tuple[Limits, str]] = {
    "moduli": ((1.0, 1e11), "Pa"),
    "times": ((1e-15, 1e12), "s"),
    "bulk": ((1.0, 1e11), "Pa"),
    "omega": ((1e-15, 1e20), "rad/s"),
    "storage": ((1.0, 1e11), "Pa"),
    "loss": ((0.0, 1e11), "Pa"),
}
_GLASSY = (1e4, 1e11)  # [Pa]
# relative, by which a measured storage modulus may fall with the frequency
_FALLS = 0.1
_ROUNDED = 0.01  # relative, by which a range may be wider than the table
_STRAINS = (1e-6, 5.0)  # amplitudes
# factors at the smallest strain of a sweep, where a material has hardly softened
_UNSOFTENED = (0.5, 2.0)
_TEMPERATURES = (100.0, 600.0)  # [K]


def check_material(name_or_path: str | os.PathLike[str]) -> list[str]:
    """What is wrong with a material file, one line per finding; an empty list where
    nothing is.

    Looks at moduli, times and temperatures outside what a polymer in SI units has, a
    reference temperature or a law of shifts that does not cover the range of validity,
    a softening whose sweep does not begin at small strain, and missing ranges, sources
    and grades. Of a table of moduli it looks at a storage modulus that falls with the
    frequency by more than a tenth, and a range that is wider than the table. A file
    that does not load is a finding, not an error; one that does is passive, since its
    moduli are not negative.
    """
    try:
        path = locate(name_or_path)
        document = read_document(path)
        material = load_material(path)
    except InputError as error:
        return [str(error)]
    findings = [
        *_numbers(document),
        *(_table(material, document) if is_tabulated(document) else ()),
        *_ranges(document),
        *_softening(document),
        *_laws(material, document),
        *_sources(document),
    ]
    if document.get("name") != path.stem:
        findings.append(
            f"name is {document.get('name')!r}, but the file is called {path.name}"
        )
    if not document.get("description"):
        findings.append("description is missing")
    return findings


def _numbers(document: Document) -> Iterator[str]:
    for key, (accepted, unit) in _USUAL.items():
        values = document.get(key, [])
        if isinstance(values, list):
            named = [(f"{key}[{k}]", value) for k, value in enumerate(values)]
        else:
            named = [(key, values)]
        yield from _outside(named, accepted, unit)
    if not is_tabulated(document):
        relaxed = document["equilibrium"]
        if relaxed != 0:
            yield from _outside([("equilibrium", relaxed)], *_USUAL["moduli"])
        glassy = relaxed + sum(document["moduli"])
        yield from _outside([("equilibrium plus all moduli", glassy)], _GLASSY, "Pa")


def _table(material: Prony | TabulatedModulus, document: Document) -> Iterator[str]:
    """Findings on a table of moduli, whose loss is positive since it has loaded."""
    storage, omega = np.array(document["storage"]), document["omega"]
    fall = 1 - storage / np.maximum.accumulate(storage)
    if fall.max() > _FALLS:
        yield (
            f"the storage modulus falls by {fall.max():.0%} up to "
            f"{omega[int(fall.argmax())]:g} rad/s, but must rise with omega"
        )
    known = None if material.range is None else material.range.omega
    low, high = known or (np.inf, 0.0)
    if low < omega[0] * (1 - _ROUNDED) or high > omega[-1] * (1 + _ROUNDED):
        yield (
            f"the range is wider than the table, {omega[0]:g} to {omega[-1]:g} rad/s"
        )


def _ranges(document: Document) -> Iterator[str]:
    limits = document.get("range", {})
    if not {"omega", "time"} & set(limits):
        yield "omega (or time) is missing in [range]"
    for key in ("omega", "time"):
        if limits.get(key) and not limits[key][0] > 0:
            yield (
                f"{key} in [range] starts at {limits[key][0]:g}, which is not above 0"
            )
    degrees = limits.get("temperature")
    if degrees is None:
        yield "temperature is missing in [range]"
        return
    named = [("temperature in [range]", value) for value in degrees]
    yield from _outside(named, _TEMPERATURES, "K")
    reference = document.get("reference_temperature")
    if reference is None:
        yield "reference_temperature is missing"
    else:
        named = [("reference_temperature", reference)]
        yield from _outside(named, (degrees[0], degrees[1]), "K")


def _softening(document: Document) -> Iterator[str]:
    """Findings on a softening, whose factors are positive and whose strains ascend
    since it has loaded.
    """
    softening = document.get("softening")
    if softening is None:
        return
    strains = enumerate(softening["strain"])
    named = [(f"strain[{k}] in [softening]", x) for k, x in strains]
    yield from _outside(named, _STRAINS, "")
    for key in ("storage", "loss"):
        name = f"{key}[0] in [softening], at the smallest strain,"
        yield from _outside([(name, softening[key][0])], _UNSOFTENED, "")


def _laws(material: Prony | TabulatedModulus, document: Document) -> Iterator[str]:
    """Whether the laws of shifts cover the range, and b_T is 1 at the reference."""
    limits = document.get("range", {}).get("temperature")
    if limits is None:
        return
    reference = document.get("reference_temperature")
    try:
        if material.shift is not None:
            material.shift.a(limits)
    except InputError as error:
        yield f"the shift law does not cover the range: {error}"
    try:
        if material.vertical is not None:
            material.vertical.b(limits)
            off = 0.0
            if reference is not None:
                off = abs(float(material.vertical.b(reference)) - 1)
            if off > _ROUNDED:
                yield f"b_T is off 1 by {off:.3g} at the reference temperature"
    except InputError as error:
        yield f"the law of vertical shifts does not cover the range: {error}"


def _sources(document: Document) -> Iterator[str]:
    given = ("shift", "vertical", "softening")
    groups = ["moduli", *(group for group in given if group in document)]
    groups += ["poisson" if "poisson" in document else "bulk", "range"]
    sources = document.get("source", {})
    for group in sources:
        if group not in groups:
            yield f"[source.{group}] describes numbers that are not there"
    for group in groups:
        for key in ("citation", "grade"):
            if not sources.get(group, {}).get(key):
                yield f"{key} is missing in [source.{group}]"
    moduli = sources.get("moduli", {})
    if moduli.get("grade") == "fitted here":
        for key in ("storage_residual", "loss_residual"):
            if key not in moduli:
                yield f"{key} is missing in [source.moduli], which says 'fitted here'"


def _outside(
    named: Iterable[tuple[str, float]], limits: Limits, unit: str
) -> Iterator[str]:
    low, high = limits
    unit = unit and f" {unit}"
    for name, value in named:
        if not low <= value <= high:
            yield f"{name} is {value:g}{unit}, outside {low:g} to {high:g}{unit}"
