"""Whether a material file is consistent: its numbers with physics, its units with
polymers, its sources complete.
"""

import os
from typing import Any

import numpy as np

from ..errors import InputError
from .format import is_tabulated, read_document
from .library import load_material, locate

_MODULI = (1.0, 1e11)  # [Pa]
_GLASSY = (1e4, 1e11)  # [Pa]
_TIMES = (1e-15, 1e12)  # [s]
_OMEGA = (1e-15, 1e20)  # [rad/s]
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

    Looks at moduli, times and temperatures outside what a polymer in SI units has,
    storage and loss moduli below zero or a relaxation function that rises within the
    range of validity, a reference temperature or a law of shifts that does not cover
    that range, a softening whose sweep does not begin at small strain, and missing
    ranges, sources and grades. Of a table of moduli it looks at a storage modulus that
    falls with the frequency by more than a tenth, and a range that is wider than the
    table. A file that does not load is a finding, not an error.
    """
    try:
        path = locate(name_or_path)
        document = read_document(path)
        material = load_material(path)
    except InputError as error:
        return [str(error)]
    limits = document.get("range", {})
    if is_tabulated(document):
        findings = _table(material, document, limits)
    else:
        findings = (
            _numbers(document) + _not_positive(limits) + _passivity(material, limits)
        )
    findings += (
        _softening(document) + _temperatures(material, document) + _sources(document)
    )
    if document.get("name") != path.stem:
        findings.append(
            f"name is {document.get('name')!r}, but the file is called {path.name}"
        )
    if not document.get("description"):
        findings.append("description is missing")
    return findings


def _numbers(document: dict[str, Any]) -> list[str]:
    findings = [
        _outside(f"moduli[{k}]", value, _MODULI, "Pa")
        for k, value in enumerate(document["moduli"])
    ]
    if document["equilibrium"] != 0:
        findings.append(_outside("equilibrium", document["equilibrium"], _MODULI, "Pa"))
    glassy = document["equilibrium"] + sum(document["moduli"])
    findings.append(_outside("equilibrium plus all moduli", glassy, _GLASSY, "Pa"))
    findings += [
        _outside(f"times[{k}]", value, _TIMES, "s")
        for k, value in enumerate(document["times"])
    ]
    if "bulk" in document:
        findings.append(_outside("bulk", document["bulk"], _MODULI, "Pa"))
    return [finding for finding in findings if finding]


def _table(
    material: Any, document: dict[str, Any], limits: dict[str, Any]
) -> list[str]:
    """Findings on a table of moduli, whose loss is positive since it has loaded."""
    findings = [
        _outside(f"{key}[{k}]", value, accepted, unit)
        for key, accepted, unit in (
            ("omega", _OMEGA, "rad/s"),
            ("storage", _MODULI, "Pa"),
            ("loss", (0.0, 1e11), "Pa"),
        )
        for k, value in enumerate(document[key])
    ]
    storage = np.array(document["storage"])
    fall = 1 - storage / np.maximum.accumulate(storage)
    if fall.max() > _FALLS:
        omega = document["omega"][int(fall.argmax())]
        findings.append(
            f"the storage modulus falls by {fall.max():.0%} up to {omega:g} rad/s, "
            "but "
            "must rise with omega"
        )
    if not {"omega", "time"} & set(limits):
        findings.append("omega (or time) is missing in [range]")
    (low, high), ends = (
        material.range.omega or (np.inf, 0.0),
        (document["omega"][0], document["omega"][-1]),
    )
    if low < ends[0] * (1 - _ROUNDED) or high > ends[1] * (1 + _ROUNDED):
        findings.append(
            f"the range is wider than the table, {ends[0]:g} to {ends[1]:g} rad/s"
        )
    findings += _not_positive(limits)
    return [finding for finding in findings if finding]


def _not_positive(limits: dict[str, Any]) -> list[str]:
    return [
        f"{key} in [range] starts at {limits[key][0]:g}, which is not above 0"
        for key in ("omega", "time")
        if limits.get(key) and not limits[key][0] > 0
    ]


def _passivity(material: Any, limits: dict[str, Any]) -> list[str]:
    findings: list[str] = []
    if _not_positive(limits):
        return findings
    if limits.get("omega") == []:  # known nowhere, and passive everywhere
        omega = np.geomspace(1e-12, 1e12, 200)
    elif "omega" in limits:
        omega = np.geomspace(limits["omega"][0], limits["omega"][1], 200)
    elif "time" in limits:
        omega = 1 / np.geomspace(limits["time"][1], limits["time"][0], 200)
    else:
        return ["omega (or time) is missing in [range]"]
    if (np.asarray(material.storage(omega)) < 0).any():
        findings.append("the storage modulus is negative within the range")
    if (np.asarray(material.loss(omega)) < 0).any():
        findings.append("the loss modulus is negative within the range")
    relaxation = np.asarray(material.relaxation(1 / omega[::-1]))
    if (np.diff(relaxation) > 1e-12 * relaxation[0]).any() or (relaxation < 0).any():
        findings.append("the relaxation function rises or is negative within the range")
    return findings


def _softening(document: dict[str, Any]) -> list[str]:
    """Findings on a softening, whose factors are positive and whose strains ascend
    since it has loaded.
    """
    softening = document.get("softening")
    if softening is None:
        return []
    findings = [
        _outside(f"strain[{k}] in [softening]", x, _STRAINS, "")
        for k, x in enumerate(softening["strain"])
    ]
    findings += [
        _outside(
            f"{key}[0] in [softening], at the smallest strain,",
            softening[key][0],
            _UNSOFTENED,
            "",
        )
        for key in ("storage", "loss")
    ]
    return [finding for finding in findings if finding]


def _temperatures(material: Any, document: dict[str, Any]) -> list[str]:
    limits = document.get("range", {}).get("temperature")
    reference = document.get("reference_temperature")
    if limits is None:
        return ["temperature is missing in [range]"]
    findings = [
        _outside("temperature in [range]", value, _TEMPERATURES, "K")
        for value in limits
    ]
    if reference is None:
        findings.append("reference_temperature is missing")
    else:
        findings.append(
            _outside("reference_temperature", reference, (limits[0], limits[1]), "K")
        )
    if material.shift is not None:
        try:
            material.shift.a(np.asarray(limits, dtype=float))
        except InputError as error:
            findings.append(f"the shift law does not cover the range: {error}")
    if material.vertical is not None:
        try:
            material.vertical.b(np.asarray(limits, dtype=float))
            deviation = (
                0.0
                if reference is None
                else abs(float(material.vertical.b(reference)) - 1)
            )
            if deviation > _ROUNDED:
                findings.append(
                    f"b_T is off 1 by {deviation:.3g} at the reference temperature"
                )
        except InputError as error:
            findings.append(
                f"the law of vertical shifts does not cover the range: {error}"
            )
    return [finding for finding in findings if finding]


def _sources(document: dict[str, Any]) -> list[str]:
    groups = ["moduli", "poisson" if "poisson" in document else "bulk", "range"]
    groups[1:1] = [
        group for group in ("shift", "vertical", "softening") if group in document
    ]
    sources = document.get("source", {})
    findings = [
        f"[source.{group}] describes numbers that are not there"
        for group in sources
        if group not in groups
    ]
    for group in groups:
        source = sources.get(group, {})
        findings += [
            f"{key} is missing in [source.{group}]"
            for key in ("citation", "grade")
            if not source.get(key)
        ]
    moduli = sources.get("moduli", {})
    if moduli.get("grade") == "fitted here":
        findings += [
            f"{key} is missing in [source.moduli], which says 'fitted here'"
            for key in ("storage_residual", "loss_residual")
            if key not in moduli
        ]
    return findings


def _outside(name: str, value: float, limits: tuple[float, float], unit: str) -> str:
    low, high = limits
    unit = unit and f" {unit}"
    return (
        ""
        if low <= value <= high
        else f"{name} is {value:g}{unit}, outside {low:g} to {high:g}{unit}"
    )
