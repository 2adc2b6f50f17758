"""The maximum of a smooth function that is known at equal steps."""

import functools
from typing import Any

import numpy as np

from ..arrays import fixed, xp
from ..checks import Array, argmax


def peak(force: Array, last: Any) -> tuple[Array, Array]:
    """The largest value of a smooth function given at equal steps, and where (0 to 1),
    by a polynomial.
    """
    half = _NEAR // 2
    first = xp.clip(argmax(fixed(force)) - half, 0, last + 1 - _NEAR)
    rows = xp.take_along_axis(force, first[None] + xp.arange(_NEAR)[:, None], axis=0)
    # of powers of x, the nodes at -1 ... 1
    coefficients = xp.einsum("ij,j...->i...", xp.asarray(_THROUGH), rows)

    def value(x: Array) -> Array:
        return functools.reduce(lambda sum, c: sum * x + c, coefficients[::-1])

    held, powers = fixed(coefficients), np.arange(_NEAR)[:, None]
    x = argmax(fixed(rows)) / half - 1.0
    for _ in range(5):
        slope = xp.sum((powers * held)[1:] * x ** (powers[1:] - 1), axis=0)
        bend = xp.sum(
            (powers * (powers - 1) * held)[2:] * x ** (powers[2:] - 2), axis=0
        )
        x = xp.clip(
            x - xp.where(bend < 0, slope / xp.where(bend < 0, bend, -1.0), 0.0),
            -1.0,
            1.0,
        )
    return value(x), (first + half * (1 + x)) / last


_NEAR = 9  # nodes around the largest force
_THROUGH = np.linalg.inv(np.vander(np.linspace(-1.0, 1.0, _NEAR), increasing=True))
