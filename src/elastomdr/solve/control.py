"""Which way an indentation is solved: by depth, by load in closed form, or by load in steps."""

import functools
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, is_traced
from ..foundation.modes import Modes
from ..mapping.disc import Disc
from ..material.relaxation import Relaxation
from .creep import Creep, creep, levels_for
from .history import indent_by_depth, padded

_BATCH = 64  # histories computed at once
_LEVELS = (1, 3, 6)  # of the panels, coarse to fine
_TRACED_LEVELS = 12  # of the panels in time, where the times cannot be looked at
_ROUNDING = 1e-14
BY_DEPTH = "elements exact in time under the given depth, Gauss' rule between the edges of all instants"
GROWING = "closed form of Lee and Radok: the contact only grows"


class Course(NamedTuple):
    """Histories of one shape (..., m): depth or load, or both with `by_depth` saying which rules at each instant."""

    time: Float[Array, "*histories m"]
    depth: Float[Array, "*histories m"] | None
    load: Float[Array, "*histories m"] | None
    by_depth: Bool[Array, "*histories m"] | None

    def words(self) -> list[tuple[str, Any, str]]:
        """Name, values and unit of what was given."""
        return [("time", self.time, "s"), ("depth", self.depth, "m"), ("load", self.load, "N")]


class Found(NamedTuple):
    """Solved histories, every field of their shape."""

    depth: Array
    force: Array
    radius: Array
    work: Array
    stored: Array
    locked: Array
    error: Array  # relative to the largest force or depth
    converged: Array
    knots: tuple[Array, Array]  # time and depth between which the depth is linear
    plan: str
    reason: str  # why some did not converge


def indent_under(law: Relaxation, modes: Modes, disc: Disc, course: Course, rtol: float) -> Found:
    """Solves all histories of a course."""
    if course.load is None:
        return _by_depth(law, modes, disc, course, rtol)
    return _by_load(law, modes, disc, course, rtol)


def _by_depth(law: Relaxation, modes: Modes, disc: Disc, course: Course, rtol: float) -> Found:
    shape = course.time.shape
    time, depth = (a.reshape(-1, a.shape[-1]) for a in padded(course.time, course.depth))
    traced = is_traced(law, modes, disc, time, depth)
    numpy = jnp if traced else np
    for levels in _LEVELS[1:2] if traced else _LEVELS:
        found, _ = _over_histories(indent_by_depth, law, modes, disc, time, depth, levels=levels)
        largest = numpy.max(numpy.abs(found.force), axis=-1, keepdims=True)
        error = found.error / numpy.where(largest > 0, largest, 1.0) + _ROUNDING
        if traced or not (error > 0.1 * rtol).any():
            break
    good = numpy.isfinite(found.force) & (error <= rtol)
    fields = (found.force, found.radius, found.work, found.stored, found.locked, error, good)
    force, radius, work, stored, locked, error, good = (_unpadded(a, shape) for a in fields)
    knots = (course.time, course.depth)
    return Found(course.depth, force, radius, work, stored, locked, error, good, knots, BY_DEPTH, "")


def _by_load(law: Relaxation, modes: Modes, disc: Disc, course: Course, rtol: float) -> Found:
    shape = course.time.shape
    time, load = (a.reshape(-1, a.shape[-1]) for a in padded(course.time, course.load))
    traced = is_traced(law, modes, disc, time, load)
    numpy = jnp if traced else np
    levels = _TRACED_LEVELS if is_traced(law, time) else levels_for(law, modes, time)
    found: Creep = _over_histories(creep, law, modes, disc, time, load, levels=levels)
    good = numpy.isfinite(found.depth) & found.growing
    error = numpy.where(good, _ROUNDING, numpy.nan)
    fields = (found.depth, found.radius, found.work, found.stored, error, good)
    depth, radius, work, stored, error, good = (_unpadded(a, shape) for a in fields)
    knots = (course.time, depth)
    locked = numpy.zeros(shape)
    return Found(depth, course.load, radius, work, stored, locked, error, good, knots, GROWING, "")


def _over_histories(function: Any, law: Any, modes: Any, disc: Any, *histories: Any, levels: int) -> Any:
    """`function` for every history, in one compiled call; NumPy arrays unless traced."""
    count = histories[0].shape[0]
    size = min(_BATCH, 1 << (count - 1).bit_length())
    more = -count % size
    traced = is_traced(law, modes, disc, *histories)
    numpy = jnp if traced else np
    full = tuple(numpy.concatenate([h, numpy.repeat(h[:1], more, axis=0)]) if more else h for h in histories)
    out = _mapped(law, modes, disc, *full, function=function, levels=levels, size=size)
    return jax.tree.map(lambda a: a[:count] if traced else np.asarray(a)[:count], out)


@functools.partial(jax.jit, static_argnames=("function", "levels", "size"))
def _mapped(law: Any, modes: Any, disc: Any, *histories: Any, function: Any, levels: int, size: int) -> Any:
    def one(history: tuple[Array, ...]) -> Any:
        return function(law, modes, disc, *history, levels=levels)

    if histories[0].shape[0] == size:
        return jax.vmap(one)(histories)
    return jax.lax.map(one, histories, batch_size=size)


def _unpadded(a: Array, shape: tuple[int, ...]) -> Array:
    """Back to the instants asked for: the last one, and those before the interval that was divided."""
    kept = [*range(shape[-1] - 1), a.shape[-1] - 1]
    return a[..., np.array(kept)].reshape(shape)
