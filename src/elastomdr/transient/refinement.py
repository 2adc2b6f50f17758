"""A history marched at finer and finer resolution until the friction coefficient is
known to the tolerance.

Elements and steps are halved together. The scheme is of second order, so the limit is
extrapolated from the last two levels, and what is left falls by about 8 per level where
the edges of contact are resolved (`transient.depth_from_load`). What is stated as the
error of a limit is its change against the limit of one level less, and of the first
that of the marches themselves. A difference may vanish by chance: so it is not taken
smaller than those at the neighbouring instants, nor than an eighth of the one before.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import on_jax, on_numpy, xp
from ..checks import Array, is_traced
from ..numerics.interpolation import halving_limit
from .slide_march import Forces

# error over mu beyond which a number is not handed out under a transformation either
_SHOWN = 0.1
# of the slope of the body: mu below it counts as that, since at rest mu is zero but for
# the grid
_SYMMETRIC = 0.03
_ROUNDING = 1e-9  # mu of a flat body
_FINEST = 6  # levels beyond the coarsest
_WORK = 3e10  # elements times steps times branches of a march that is still made
# and of one that NumPy takes seconds for, as JAX does to compile it: by size, so that
# bits do not change
_MUCH = 2e7
_EMPTY = 1e-12  # of the largest normal force: no contact


class Levels(NamedTuple):
    """The limit at the instants of the history, and how it was reached."""

    forces: Forces
    mu: Array
    error: Array  # of mu, absolute
    good: Array
    levels: int  # marches
    # what is handed out: good points, and under a transformation all whose error is
    # known
    shown: Array


def refine(
    solve: Callable[[int], tuple[Any, Array]],
    rtol: float,
    most: int,
    slope: Any,
    missing: Callable[[Any], tuple[Array, Array]] | None = None,
) -> Levels:
    """Halves elements and steps, `solve(level)`, up to level `most`.

    Good is a point whose error of mu is below rtol times the largest mu of the history
    (or 0.03 `slope`, that of the body, if that is more), with depth and normal force
    known to rtol of their largest values; and with an energy balance that closes to it,
    where `missing` gives what is missing in it at each instant and what that is
    relative to. Under `jit`, `grad` or `vmap`, where errors cannot be looked at, two
    levels are made, and what they give is handed out with its error, unless that is a
    large part of mu: the elements are given there, and rtol cannot be met by more of
    them.
    """
    old, fits = solve(0)
    level, last, before = 0, 0.0, None
    while True:
        level += 1
        new, fits = solve(level)
        numpy = xp if is_traced(new) else np
        limit = type(new)(*map(halving_limit, old, new))
        mu = _ratio(numpy, limit, new.normal)
        pairs = [
            (_ratio(numpy, old), _ratio(numpy, new)),
            (old.depth, new.depth),
            (old.normal, new.normal),
        ]
        changes = [numpy.abs(b - a) for a, b in pairs]
        seen = (mu, limit.depth, limit.normal)
        if before is not None:
            changes = [numpy.abs(b - a) for a, b in zip(before, seen, strict=True)]
        error = beside(numpy.fmax(changes[0], last))
        scale = numpy.maximum(
            numpy.nanmax(numpy.where(numpy.isfinite(mu), numpy.abs(mu), 0.0)),
            _SYMMETRIC * slope + _ROUNDING,
        )
        sure = (
            numpy.isfinite(new.normal)
            & numpy.isfinite(new.drag)
            & numpy.isfinite(new.depth)
            & fits
        )
        known = sure
        # the depth is then that of the elements' grid
        apart = numpy.max(numpy.abs(new.normal)) == 0
        for change, value in zip(changes[1:], seen[1:], strict=True):
            sure = sure & (apart | (change <= rtol * numpy.max(numpy.abs(value))))
        if missing is not None:
            part, largest = missing(limit)
            sure = sure & (numpy.abs(part) <= rtol * largest)
        # without contact there is no mu, and no error of it
        good = sure & ~(error > rtol * scale)
        if (
            is_traced(new)
            or level >= most
            or bool(np.all(good))
            or not bool(np.any(fits))
        ):
            shown = known & ~(error > _SHOWN * scale) if is_traced(new) else good
            return Levels(limit, mu, error, good, level + 1, shown)
        old, last, before = new, changes[0] / 8, seen


def at_level(
    solve: Callable[[int], tuple[Any, Array]], level: int, work: float
) -> tuple[Any, Array]:
    """`solve(level)`, of which `work` is elements times steps times branches."""
    return on_jax(solve, level) if on_numpy() and work > _MUCH else solve(level)


def finest(work: int, traced: bool) -> int:
    """The finest level that is still marched, for elements times steps times branches
    of the coarsest.
    """
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


def beside(error: Any, reach: int = 2) -> Any:
    """The largest of each error and those of `reach` neighbouring instants (the last
    axis) on either side.
    """
    numpy = xp if is_traced(error) else np
    instants, largest = error.shape[-1], error
    at = np.arange(instants)
    for shift in range(-reach, reach + 1):
        largest = numpy.fmax(largest, error[..., np.clip(at + shift, 0, instants - 1)])
    return largest
