"""A Kelvin chain that has the compliance of a table of moduli, for what sums over
retardation times.
"""

from __future__ import annotations

import math

import numpy as np

from ..checks import is_traced
from ..errors import InputError
from .relaxation import KelvinChain
from .tabulated import AbstractTable

_PER_DECADE = 6  # retardation times
_BESIDE = 10.0  # how far they reach beyond the table


def to_chain(table: AbstractTable) -> tuple[KelvinChain, float]:
    """The chain of positive compliances that is nearest to the table, and how far it is
    from it.

    The distance is the root mean square, over the logarithm of frequency, of the
    difference of the complex compliances over the loss compliance: about what a loss
    computed with the chain is off. Raises `InputError` under a transformation of JAX
    with respect to the table.
    """
    if is_traced(table):
        raise InputError(
            "material must be an em.Prony to be differentiated here, got a traced "
            "table."
        )
    from scipy.optimize import nnls

    ends = float(table.omega[0]), float(table.omega[-1])
    omega = np.geomspace(*ends, 2 + math.ceil(12 * math.log10(ends[1] / ends[0])))
    compliance = 1 / np.asarray(table.complex_modulus(omega))
    count = 2 + math.ceil(_PER_DECADE * math.log10(ends[1] / ends[0] * _BESIDE**2))
    times = np.geomspace(1 / (_BESIDE * ends[1]), _BESIDE / ends[0], count)
    terms = np.concatenate(
        [np.ones((omega.size, 1)), 1 / (1 + 1j * omega[:, None] * times)], axis=1
    )
    size = -compliance.imag
    rows = terms / size[:, None]
    wanted = compliance / size
    found, _ = nnls(
        np.concatenate([rows.real, rows.imag]),
        np.concatenate([wanted.real, wanted.imag]),
        maxiter=50 * count,
    )
    off = float(np.sqrt(np.mean(np.abs(rows @ found - wanted) ** 2)))
    kept = found[1:] > 0
    return KelvinChain(
        np.asarray(found[0]), found[1:][kept], times[kept], np.zeros(())
    ), off
