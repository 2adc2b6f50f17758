"""A history marched at finer and finer resolution until the friction coefficient is known to the tolerance.

Elements and steps are halved together. The scheme is of second order, so the limit is extrapolated from the last two
levels; what is stated as the error is the whole of their difference, three times what a regular sequence would leave,
since the edges of contact fall between elements differently at each level. For the same reason a difference may vanish
by chance: so it is not taken smaller than those at the neighbouring instants, nor than a quarter of the one before.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from .._runtime import Array, is_traced
from .slide import Forces

_SYMMETRIC = 0.03  # of the slope of the body: mu below it counts as that, since at rest mu is zero but for the grid
_ROUNDING = 1e-9  # mu of a flat body
_FINEST = 6  # levels beyond the coarsest
_WORK = 3e10  # elements times steps times branches of a march that is still made
_EMPTY = 1e-12  # of the largest normal force: no contact


class Levels(NamedTuple):
    """The limit at the instants of the history, and how it was reached."""

    forces: Forces
    mu: Array
    error: Array  # of mu, absolute
    good: Array
    levels: int  # marches


def refine(solve: Callable[[int], tuple[Any, Array]], rtol: float, most: int, slope: Any) -> Levels:
    """Halves elements and steps, `solve(level)`, up to level `most`.

    Good is a point whose error of mu is below rtol times the largest mu of the history (or 0.03 `slope`, that of the
    body, if that is more), with depth and normal force known to rtol of their largest values. Under `jit` or `vmap`,
    where errors cannot be looked at, two levels are made.
    """
    coarse, fits = solve(0)
    level, last = 0, 0.0
    while True:
        level += 1
        fine, fits = solve(level)
        numpy = jnp if is_traced(fine) else np
        mu = [_ratio(numpy, forces) for forces in (coarse, fine)]
        change = numpy.abs(mu[1] - mu[0])
        error = _spread(numpy, numpy.fmax(change, last))
        scale = numpy.maximum(
            numpy.nanmax(numpy.where(numpy.isfinite(mu[1]), numpy.abs(mu[1]), 0.0)), _SYMMETRIC * slope + _ROUNDING
        )
        sure = numpy.isfinite(fine.normal) & numpy.isfinite(fine.drag) & numpy.isfinite(fine.depth) & fits
        for old, new in ((coarse.depth, fine.depth), (coarse.normal, fine.normal)):
            sure = sure & (numpy.abs(new - old) <= rtol * numpy.max(numpy.abs(new)))
        good = sure & ~(error > rtol * scale)  # without contact there is no mu, and no error of it
        if is_traced(fine) or level >= most or bool(np.all(good)) or not bool(np.any(fits)):
            break
        coarse, last = fine, change / 4
    limit = type(fine)(*(new + (new - old) / 3 for old, new in zip(coarse, fine, strict=True)))
    return Levels(limit, _ratio(numpy, limit, fine.normal), error, good, level + 1)


def finest(work: int, traced: bool) -> int:
    """The finest level that is still marched, for elements times steps times branches of the coarsest."""
    most = 1 if traced else _FINEST
    while most > 1 and 4.0**most * work > _WORK:
        most -= 1
    return most


def _ratio(numpy: Any, forces: Forces, contact: Any = None) -> Any:
    """F_x/F_N, NaN without contact."""
    normal = forces.normal if contact is None else contact
    touching = normal > _EMPTY * numpy.max(normal)
    safe = numpy.where(touching, forces.normal, 1.0)
    return numpy.where(touching, forces.drag / safe, numpy.nan)


def _spread(numpy: Any, error: Any) -> Any:
    """The largest of each error and those of two neighbours on either side."""
    padded = numpy.concatenate([error[:1], error[:1], error, error[-1:], error[-1:]])
    largest = error
    for shift in range(5):
        largest = numpy.fmax(largest, padded[shift : shift + error.shape[0]])
    return largest
