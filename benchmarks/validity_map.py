"""How far are the direction average and the bare line from the half-space, over speed, spectrum and shape?

    python benchmarks/validity_map.py [--fresh]

The truth is `em.reference.half_space_sliding`: three dimensions, the same spectrum, 64 by 64 cells, its own error (the
change from half as many cells) beside each number. It is kept in results/validity_map_SHAPE.json, since it takes
minutes. Spectra: one branch, and branches of equal modulus a decade apart over 5 and 9 decades; the glassy modulus is 2
to 1000 times the relaxed one. Speeds: seven, evenly spaced in their logarithm over the range in which the line's
friction is above 5% of its peak. Writes the table of the documentation, results/validity_map.md.
"""

import sys
import warnings
from typing import Any

import numpy as np
from common import RESULTS, cached, heading, plt, save, table

import elastomdr as em

EQUILIBRIUM, TIME, LOAD = 4e6, 1e-3, 10.0  # E_inf [Pa] (as E*), the longest relaxation time [s], F_N [N]
SHAPES = {"paraboloid": em.Paraboloid(0.01), "cone": em.Cone(0.15), "r^4": em.PowerLaw(4, 5e5)}
DECADES = (0, 5, 9)
CONTRASTS = (2.0, 10.0, 100.0, 1000.0)
SPEEDS, WHERE = 7, 0.05  # over the range in which the line's friction is above this part of its peak
CELLS = 64
ABSENT = 1e-12  # of E_inf: the modulus of branches outside the span, so that one compiled program serves all spectra


def law(decades: int, contrast: float) -> em.Foundation:
    moduli = np.where(np.arange(10) >= 9 - decades, (contrast - 1) / (decades + 1), ABSENT)
    return em.Foundation(EQUILIBRIUM, EQUILIBRIUM * moduli, TIME * 10.0 ** np.arange(-9, 1.0))


def speeds(shape: Any, material: em.Foundation) -> np.ndarray:
    sweep = np.geomspace(1e-4, 1e13, 120)
    line = em.friction(material, shape, velocity=sweep, load=LOAD, average=None, rtol=1e-3).mu
    there = sweep[line > WHERE * np.nanmax(line)]
    return np.geomspace(there[0], there[-1], SPEEDS)


def truth(shape: Any, decades: int, contrast: float) -> dict[str, Any]:
    material = law(decades, contrast)
    velocity = speeds(shape, material)
    found = em.reference.half_space_sliding(material, shape, velocity=velocity, load=LOAD, points=CELLS)
    fields = {"velocity": velocity, "mu": found.mu, "error": found.error, "depth": found.depth}
    return fields | {"leading": found.contact.leading, "trailing": found.contact.trailing}


def truths(name: str, fresh: bool) -> list[dict[str, Any]]:
    """Every spectrum for one shape."""
    inputs = {
        "E_inf": EQUILIBRIUM, "tau": TIME, "load": LOAD, "shape": repr(SHAPES[name]), "decades": DECADES,
        "contrasts": CONTRASTS, "speeds": SPEEDS, "where": WHERE, "cells": CELLS,
    }  # fmt: skip

    def compute() -> list[dict[str, Any]]:
        found = []
        for decades in DECADES:
            for contrast in CONTRASTS:
                print(f"  {name}, {decades} decades, contrast {contrast:g}", file=sys.stderr, flush=True)
                found.append({"decades": decades, "contrast": contrast, **truth(SHAPES[name], decades, contrast)})
        return found

    kept = cached(f"validity_map_{name.replace('^', '')}", inputs, compute, fresh)
    return [{k: np.array(v, dtype=float) for k, v in one.items()} for one in kept]


if __name__ == "__main__":
    warnings.simplefilter("ignore", em.ConvergenceWarning)
    for name in sys.argv[1:] or SHAPES:
        truths(name, False)
