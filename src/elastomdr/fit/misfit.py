"""How far a material with its laws of shifts is from moduli as they were measured."""

from typing import Any

import numpy as np

from ..errors import InputError
from ..io.data import Dma
from ..material.prony import Prony
from ..material.validity import misfit_bands
from ..trees import replaced


def deviations(material: Prony, dma: Dma) -> dict[str, np.ndarray]:
    """Relative deviations at each measured point, prediction over data minus one, by
    the name of the modulus.

    `material` is of the kind of the data, and has a shift law.
    """
    times, moduli, level = (
        np.asarray(material.times),
        np.asarray(material.moduli),
        float(material.equilibrium),
    )
    parts = {}
    if dma.omega.size:
        b = _lift(material.vertical, dma.temperature)
        x = (dma.omega * _factor(material.shift, dma.temperature))[:, None] * times
        parts["storage modulus"] = (
            b * (level + (moduli * x / (x + 1 / x)).sum(axis=1)) / dma.storage - 1
        )
        parts["loss modulus"] = b * (moduli / (x + 1 / x)).sum(axis=1) / dma.loss - 1
    if dma.time.size:
        x = (dma.time / _factor(material.shift, dma.time_temperature))[:, None] / times
        b = _lift(material.vertical, dma.time_temperature)
        parts["relaxation modulus"] = (
            b * (level + (moduli * np.exp(-x)).sum(axis=1)) / dma.relaxation - 1
        )
    return parts


def misfit(material: Prony, dma: Dma) -> dict[str, float]:
    """Root mean squares of `deviations`; none without a shift law."""
    if material.shift is None:
        return {}
    return {
        name: float(np.sqrt(np.mean(part**2)))
        for name, part in deviations(material, dma).items()
    }


def with_misfit(material: Prony, dma: Dma) -> Prony:
    """The material with its deviations from the data as measured, at reduced
    frequencies, as its record of misfit.
    """
    if material.shift is None or material.range is None or not dma.omega.size:
        return material
    parts = deviations(material, dma)
    rows = misfit_bands(
        dma.omega * _factor(material.shift, dma.temperature),
        parts["storage modulus"],
        parts["loss modulus"],
    )
    return replaced(material, range=material.range._replace(misfit=rows))


def _lift(law: Any, temperature: np.ndarray) -> Any:
    """b_T; 1 without a law."""
    return 1.0 if law is None else np.asarray(law.b(temperature))


def _factor(law: Any, temperature: np.ndarray) -> np.ndarray:
    """a_T; a table ends at the mean of its last isotherm, and holds a little beyond."""
    try:
        return 10 ** np.asarray(law.log10_a(temperature))
    except InputError:
        low, high = (float(law.temperature[i]) for i in (0, -1))
        return 10 ** np.asarray(law.log10_a(np.clip(temperature, low, high)))
