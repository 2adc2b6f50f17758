"""A motion marched at finer and finer resolution until the friction coefficient is
known to the tolerance.

Elements and steps are halved together. The scheme is of second order, so the limit is
extrapolated from the last two levels, and what is left falls by about 8 per level where
the edges of contact are resolved (`transient.march`). What is stated as the error of a
limit is its change against the limit of one level less, and of the first that of the
marches themselves. A difference may vanish by chance: so it is not taken smaller than
those at the neighbouring instants, nor than an eighth of the one before.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arrays import (
    arrays,
    compiled,
    on_jax,
    on_numpy,
    stop_gradient,
    tree_map,
    xp,
)
from ..checks import Array, is_traced, known, significant
from ..element.body_over_line import AbstractOverLine
from ..element.moving_body import MotionScene, Mount, Steps
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..numerics.interpolation import halving_limit
from ..smooth.passage import Control, estimate_sizes
from ..surface.lines import AbstractLines
from .march import OF_AN_ELEMENT, MotionHistory, run
from .problem import GivenHistory, SlidePlan

# error over mu beyond which a number is not handed out under a transformation either
_SHOWN = 0.1
# of the slope of the body: mu below it counts as that, since at rest mu is zero but for
# the grid
_SYMMETRIC = 0.03
_ROUNDING = 1e-9  # mu of a flat body
# part of the last change of a limit that is its error, of a body that does not slide:
# each is three to ten times smaller than the one before
_LEFT = 0.5
_FINEST = 6  # levels beyond the coarsest
# elements times steps times branches of a march that is still made, five minutes of a
# processor of 2024; a step is worth `_STEP` elements
_WORK, _STEP, _MINUTES = 1e10, 200, 5
# A march that takes NumPy longer, in seconds of a processor of 2024, is compiled, which
# takes JAX three to four; by size, never by time, so that bits do not change. Measured
# with 128 to 8192 elements and 1 to 10 branches: one of them takes `_ONE`, a step as
# many more, an element so many branches more, and a body on mounts `_ON_MOUNTS` times.
_PATIENCE, _ONE = 3.0, 2e-8
_OF_A_STEP, _ON_MOUNTS = 3e4, 2.4
_EMPTY = 1e-12  # of the largest normal force: no contact


def limit(marches: Sequence[Any], powers: Sequence[int]) -> Any:
    """Marches, each of half the step of the one before, without the given powers of the
    step in their error: Richardson's extrapolation of the last ones.
    """
    rows = list(marches[-1 - len(powers) :])
    for power in powers[: len(rows) - 1]:

        def without(coarse: Array, fine: Array, power: int = power) -> Array:
            if fine.dtype == bool:
                return coarse & fine
            return halving_limit(coarse, fine, power)

        rows = [tree_map(without, *pair) for pair in itertools.pairwise(rows)]
    return rows[-1]


class Levels(NamedTuple):
    """The limit at the instants of the history, and how it was reached."""

    seen: MotionHistory
    mu: Array
    error: Array  # of mu, absolute
    good: Array
    levels: int  # marches
    # what is handed out: good points, and under a transformation all whose error is
    # known
    shown: Array


class Cut(NamedTuple):
    """How a motion is cut into elements and steps; finer levels have `finer` times as
    many of both.
    """

    # of `finer`, with `room` times as many elements as the coarsest level
    surface: Callable[[int, int], AbstractOverLine]
    # of `finer`, and where the instants are
    steps: Callable[[int], tuple[Steps, Any]]
    elements: int  # along the path, on the coarsest level
    strips: int  # beside each other there
    most_steps: int  # on the coarsest level
    traced: bool
    endless: bool  # of a rough line: no element is the outermost
    skipped: str  # elements left out, in words
    mounts: Sequence[Mount | None] = (None, None)
    # elements times steps times branches marched sooner than another program is
    # compiled
    room: float = 5e6
    long: tuple[float, int] = (np.inf, 0)  # work of a long march, and its finest level
    moving: float = 0.0  # share of the elements that lie along the path
    finest: int = _FINEST

    def work(self, history: GivenHistory) -> int:
        """Elements times steps times branches of the coarsest level."""
        branches = max(history.law.times.size, 1)
        return self.elements * self.strips * self.most_steps * branches

    @property
    def growth(self) -> float:
        """Of the work from level to level."""
        return 4.0 if self.strips == 1 else 8.0

    def seconds_on_numpy(self, history: GivenHistory, level: int) -> float:
        """What a march takes NumPy, by the number of steps, elements and branches."""
        branches = history.law.times.size + OF_AN_ELEMENT
        step = (
            _OF_A_STEP
            + self.elements * self.strips * branches * (self.growth / 2) ** level
        )
        slower = _ON_MOUNTS if any(self.mounts) else 1.0
        return slower * _ONE * step * self.most_steps * 2.0**level


def solve_levels(
    history: GivenHistory,
    cut: Cut,
    slope: Array | float | None = None,
    *,
    missing: Callable[[Any], tuple[Array, Array]] | None = None,
    deepest: Array | float = np.inf,
) -> tuple[Levels, SlidePlan, bool]:
    """A motion to its tolerance, and whether the outermost elements were touched: then
    the body reaches further than was thought.

    `slope` and `missing` as in `refine`; `deepest` [m] is where the contact reaches the
    end of the body.
    """
    law, work = arrays(history.law), cut.work(history)
    if not cut.traced and slope is not None:
        _refuse_what_takes_too_long(history, cut)
    most = finest(work, 1 if cut.traced else cut.finest)
    if cut.growth**most * work > cut.long[0]:
        most = min(cut.long[1], most)
    shared = shared_level(work, most, cut.room, cut.growth)
    size, outside = (0, 0), False

    def marched(
        scene: MotionScene, steps: Steps, instants: np.ndarray | None, doing: str
    ) -> Any:
        return run(
            scene,
            steps,
            instants,
            control=history.control,
            viscous=history.viscous,
            balance=missing is not None,
            doing=doing,
        )

    def solve(level: int) -> tuple[MotionHistory, Any]:
        nonlocal size, outside
        finer = 2**level
        # NumPy has nothing to compile for a new size
        small = on_numpy() and cut.seconds_on_numpy(history, level) <= _PATIENCE
        room = finer if small else max(finer, 2**shared)
        # made by NumPy too: of single operations JAX compiles each
        steps, instants = cut.steps(finer)
        scene = MotionScene(law, cut.surface(finer, room), *cut.mounts)
        doing = f"motion on grid {level + 1} of at most {most + 1}"
        given = scene, steps, instants, doing
        seen, line = marched(*given) if small else on_jax(marched, *given)
        seen, u = known((seen, line.u))
        if steps.in_turn is not None:
            # of a dashpot the elements tell a mean over the step
            given_load = steps.value[instants]
            normal = xp.where(steps.in_turn.by_depth[instants], seen.normal, given_load)
            seen = seen._replace(normal=normal)
        strips = 1 if cut.strips == 1 else -(-cut.elements * finer // 2)
        size = cut.elements * finer * strips, steps.h.shape[0] - 1
        u = u.reshape(-1, cut.elements * room)
        ends = (u[:, 0] == 0).all() & (u[:, cut.elements * finer - 1] == 0).all()
        inside = (ends | cut.endless) & (seen.depth < deepest)
        if is_traced(seen):
            return seen, inside
        outside = not (ends or cut.endless)
        if history.control == "load" and not np.any(history.value > 0):
            # what is left is rounding
            seen = seen._replace(normal=0 * seen.normal, drag=0 * seen.drag)
        return seen, inside

    levels = refine(solve, history.rtol, most, slope, missing)
    branches = int(history.law.times.size)
    return levels, SlidePlan(*size, branches, levels.levels, cut.skipped), outside


def _refuse_what_takes_too_long(history: GivenHistory, cut: Cut) -> None:
    """Raises `InputError` for a motion of which not even the two coarsest levels are
    made, with how much of it would be.
    """
    steps, across = cut.most_steps * 2, cut.growth / 2
    size = cut.elements * cut.strips * max(history.law.times.size, 1) * across
    if steps * (size + _STEP) <= _WORK:
        return
    fraction = np.geomspace(1e-9, 1.0, 1000)
    elements = (1 - cut.moving + cut.moving * fraction) ** (1 if cut.strips == 1 else 2)
    fits = fraction * steps * (size * elements + _STEP) < 0.5 * _WORK
    fraction = fraction[fits].max(initial=1e-9)
    lasts, goes = (
        fraction * float(np.ptp(x)) for x in (history.time, history.position)
    )
    raise InputError(
        argument="position",
        got=history.position,
        accepted="that of a shorter motion (a scene's stages)",
        hint=f"it has {steps:.2g} steps of "
        f"{cut.elements * cut.strips * across:.2g} elements, which would take "
        f"{steps * (size + _STEP) / _WORK * _MINUTES:.2g} minutes or more; the first "
        f"{significant(lasts, 2)} s of it (if all of it is like that, over "
        f"{significant(goes, 2)} m) can be computed; for steady sliding take "
        "em.friction(..., model=em.Line())",
    )


def widened(
    within: Callable[[Any], tuple[Levels, SlidePlan, bool]],
    reach: Array | float,
    widest: Array | float,
) -> tuple[Levels, SlidePlan]:
    """What is found `within` a reach [m] of the path, twice as far as long as elements
    outside of it are touched; `widest` is the largest contact expected.
    """
    while True:
        solution, plan, outside = within(reach)
        if not outside or float(reach) > 30 * float(widest):
            return solution, plan
        reach = 2 * reach


def refine(
    solve: Callable[[int], tuple[MotionHistory, Array]],
    rtol: float,
    most: int,
    slope: Array | float | None,
    missing: Callable[[MotionHistory], tuple[Array, Array]] | None = None,
) -> Levels:
    """Halves elements and steps, `solve(level)`, up to level `most`.

    Good is a point whose error of mu is below rtol times the largest mu of the history
    (or 0.03 `slope`, that of the body, if that is more), with depth and normal force
    known to rtol of their largest values; and with an energy balance that closes to it,
    where `missing` gives what is missing in it at each instant and what that is
    relative to. Of a body that does not slide, `slope` None, the error is that of depth
    and force, relative to their largest values. Under `jit`, `grad` or `vmap`, where
    errors cannot be looked at, two levels are made, and what they give is handed out
    with its error, unless that is a large part of mu: the elements are given there, and
    rtol cannot be met by more of them.
    """
    old, _ = solve(0)
    level, last, before = 0, 0.0, None
    while True:
        level += 1
        new, fits = solve(level)
        best = limit((old, new), (2,))
        sought = _sought(best, new)
        if before is None:
            before, after = _sought(old, old), _sought(new, new)
        else:
            after = sought
        pairs = zip(before, after, strict=True)
        changes = [xp.abs(fine - coarse) for coarse, fine in pairs]
        largest = [_largest(x) for x in sought]
        if slope is None:
            parts = zip(changes[1:], largest[1:], strict=True)
            change = _LEFT * sum(part / (size + (size == 0)) for part, size in parts)
            scale = 1.0
        else:
            change = changes[0]
            scale = xp.maximum(largest[0], _SYMMETRIC * slope + _ROUNDING)
        error = beside(xp.fmax(change, last))
        finite = [xp.isfinite(x) for x in (new.normal, new.drag, new.depth)]
        computed = finite[0] & finite[1] & finite[2] & fits
        # without contact there is no mu, and no error of it
        good = computed & ~(error > rtol * scale)
        if slope is not None:
            # else the depth is that of the elements' grid
            apart = largest[2] == 0
            for change_of, size in zip(changes[1:], largest[1:], strict=True):
                good = good & (apart | (change_of <= rtol * size))
        if missing is not None:
            unaccounted, work = missing(best)
            good = good & (xp.abs(unaccounted) <= rtol * work)
        traced = is_traced(new)
        if traced or level >= most or not np.any(fits) or np.all(good):
            shown = computed & ~(error > _SHOWN * scale) if traced else good
            return Levels(best, sought[0], error, good, level + 1, shown)
        old, last, before = new, change / 8, sought


def _sought(seen: MotionHistory, contact: MotionHistory) -> tuple[Array, Array, Array]:
    """Friction coefficient, depth and normal force."""
    return _ratio(seen, contact.normal), seen.depth, seen.normal


def _largest(values: Array) -> Array:
    return xp.max(xp.where(xp.isfinite(values), xp.abs(values), 0.0))


def shared_level(work: float, most: int, room: float, factor: float = 4.0) -> int:
    """The finest level of refinement, up to `most`, whose compiled program serves the
    coarser ones as well.

    `work` is elements times steps times branches of level 0; each further level has
    `factor` times as much, and `room` is what is marched sooner than another program is
    compiled. Compiling takes seconds, most marches milliseconds: so the coarse levels
    are marched with as many elements as that level has, the further ones lying where
    the body does not come (of a rough line: in further periods).
    """
    return max(
        level for level in range(most + 1) if level <= 1 or factor**level * work <= room
    )


def finest(work: int, most: int) -> int:
    """The finest level up to `most` that is still marched, for elements times steps
    times branches of the coarsest.
    """
    while most > 1 and 4.0**most * work > _WORK:
        most -= 1
    return most


def _ratio(seen: MotionHistory, contact: Array) -> Array:
    """F_x/F_N, NaN without contact."""
    touching = contact > _EMPTY * xp.max(contact)
    safe = xp.where(touching, seen.normal, 1.0)
    return xp.where(touching, seen.drag / safe, xp.nan)


def beside(error: Array, reach: int = 2) -> Array:
    """The largest of each error and those of `reach` neighbouring instants (the last
    axis) on either side.
    """
    instants, largest = error.shape[-1], error
    index = np.arange(instants)
    for shift in range(-reach, reach + 1):
        near = error[..., np.clip(index + shift, 0, instants - 1)]
        largest = xp.fmax(largest, near)
    return largest


@compiled("control")
def contact_sizes(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Array,
    duration: float,
) -> tuple[Any, Any]:
    """The smallest and the largest contact radius to expect [m], each within a factor
    of 2.

    The largest is that of the relaxed rubber under the largest load, or for a liquid of
    what creeps in the time given. Both grow with load and moduli as under a power of the
    radius: so elements follow the contact, and no edge passes one as a load changes.
    """
    lines = stop_gradient(lines)
    glass = law.equilibrium + xp.sum(law.moduli) + law.viscosity / duration
    # A lower bound of E(t): each branch, and the dashpot, as a spring that has relaxed
    # for the whole time.
    soft = (
        law.equilibrium
        + xp.sum(law.moduli / (1 + duration / law.times))
        + law.viscosity / duration
    )
    top = xp.max(value)
    positive_values = xp.where(value > 0, value, top)
    ends = xp.stack([xp.min(positive_values), top])
    ends = xp.where(ends > 0, ends, 1e-9)
    sizes = []
    for modulus, end in zip((glass, soft), ends, strict=True):
        held, held_end = stop_gradient((modulus, end))
        spring = Relaxation(held, xp.zeros(1), xp.ones(1), xp.zeros(()))
        size = estimate_sizes(spring, lines, control, held_end[None], xp.ones(1))
        grown, power = end / held_end, lines.exponent(size)
        if control == "load":
            grown, power = grown * held / modulus, power + 1
        sizes.append((size * grown ** (1 / power))[0])
    return sizes[0], xp.maximum(*sizes)
