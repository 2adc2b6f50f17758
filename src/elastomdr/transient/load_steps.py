"""Indentation under a load that lets the contact shrink, or under depth and load in
turn: marched by the exact contact step.

The elements stand at equal distances from the axis on. In a step an element carries q =
S (w - u_free) wherever that is positive (`element.contact_step`), so that the force is
a convex, piecewise linear function of the depth at the end of the step: Newton's method
finds the depth that carries the load in finitely many steps. The steps of an interval
narrow towards its ends, where the material answers fastest and where a contact begins
or ends; where a load is put on at once, or its rate changes, they begin at the shortest
relaxation time. Elements and steps are halved together (`transient.refinement`), as for
a body that slides.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ..arrays import compiled, stop_gradient, xp
from ..checks import Array, is_traced, nan_unless, numbers_only
from ..element.body_over_line import NOTHING, AbstractOverLine
from ..element.episode import Modes
from ..element.moving_body import InTurn, Steps
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1
from ..surface.disc import Disc
from .march import MotionHistory
from .problem import GivenHistory, Timeline, cut, timeline
from .refinement import Cut, Levels, solve_levels

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_ELEMENTS = 32  # over the contact, on the coarsest level
# times as many with a dashpot, of whose force elements that are touched within a step
# see a part only
_VISCOUS = 4
_TRACED = 512  # where the size of the contact cannot be looked at
_STEPS = 8  # between two instants, on the coarsest level
_GRADING = 2  # power by which the steps of an interval narrow
_FINEST = 8  # levels beyond the coarsest
_WIDER = 1.05  # elements reach so much further than the contact


class Ruled(NamedTuple):
    """One history of depth or load."""

    time: np.ndarray  # (m,) [s]
    value: Float[Array, " m"]  # depth [m] or load [N]
    by_depth: Bool[np.ndarray, " m"]  # which of them, from the instant before on


class AtInstants(NamedTuple):
    """A history at its instants, the first one included."""

    depth: Float[Array, " m"]
    force: Float[Array, " m"]
    radius: Float[Array, " m"]
    work: Float[Array, " m"]
    stored: Float[Array, " m"]
    locked: Float[Array, " m"]
    heat: Float[Array, " m"]  # what the elements received, less what they hold
    error: Float[Array, " m"]  # of depth and force, relative to the largest


class Half(AbstractOverLine):
    """A body over elements at equal distances from the axis on, pressed straight
    down.
    """

    profile: Float[Array, " n"]  # [m]
    first: ClassVar[float] = 0.5

    @property
    def count(self) -> int:
        return self.profile.shape[0]

    @property
    def between(self) -> bool:
        return True

    def rise(self, position: Array) -> Array:
        return -self.profile

    def rise_and_slope(self, position: Array) -> tuple[Array, Array]:
        return -self.profile, xp.zeros_like(self.profile)


def march_load(
    law: Relaxation, modes: Modes, disc: Disc, ruled: Ruled, rtol: float
) -> AtInstants:
    """One history, to `rtol` where values are known; else on two fixed levels.
    Differentiable in both modes.
    """
    numbers_only(
        {"time": ruled.time}, "where a load falls; prescribe the depth instead"
    )
    traced = is_traced(law, disc, ruled.value)
    widest = _WIDER * stop_gradient(_reach(modes, disc, ruled))
    n = _ELEMENTS * (1 if traced or law.viscosity == 0 else _VISCOUS)
    history = GivenHistory(
        law=law,
        control="load",
        time=ruled.time,
        position=np.zeros(ruled.time.shape),
        value=ruled.value,
        rtol=0.5 * rtol,  # of the sum of both
        elements=_TRACED if traced else n,
        traced=traced,
        inputs=(),
        range=None,
        temperature=None,
        factor=1.0,
    )
    if traced or disc.flat:
        return _marched(_within(history, disc, ruled.by_depth, widest), disc, widest)
    # A liquid might sink in far, did the load stay.
    rough = _within(history._replace(rtol=1.0), disc, ruled.by_depth, widest)
    found = float(np.nanmax(rough.seen.contact))
    reach = min(_WIDER * found, float(widest)) if found > 0 else float(widest)
    while True:
        levels = _within(history, disc, ruled.by_depth, reach)
        spacing = reach / (n * 2 ** (levels.levels - 1))
        outside = not np.nanmax(levels.seen.contact) < reach - spacing
        if not outside or reach >= widest:
            return _marched(levels, disc, disc.largest - spacing)
        reach = min(2 * reach, float(widest))


def _marched(levels: Levels, disc: Disc, most: Array) -> AtInstants:
    """What is known of a history whose contact has a radius below `most`."""
    seen = levels.seen
    radius = xp.maximum(seen.contact, 0.0)
    if disc.flat:
        radius = xp.where(radius > 0, disc.largest, 0.0)
    fits = (radius < most) | disc.flat
    fields = (
        seen.depth,
        seen.normal,
        radius,
        seen.pressed,
        seen.stored - seen.locked,
        seen.locked,
        seen.work - seen.stored,
        levels.error,
    )
    return AtInstants(
        *(nan_unless(fits & xp.isfinite(levels.error), x) for x in fields)
    )


def _within(
    history: GivenHistory, disc: Disc, by_depth: np.ndarray, reach: Array | float
) -> Levels:
    """Marches the elements up to `reach` [m]."""
    given = (history.time, history.position, history.value)
    early = not history.traced
    line = timeline(*given, None, history.shortest, _STEPS, _GRADING, early)
    n = history.elements

    def steps(finer: int) -> tuple[Steps, np.ndarray]:
        even, instants = cut(line, *given, history.shortest, finer)
        return _ruled(even, line, finer, history.value, by_depth), instants

    resolution = Cut(
        surface=lambda finer, room: _half(
            disc, reach / (n * finer), n * finer, n * room
        ),
        steps=steps,
        elements=n,
        strips=1,
        most_steps=line.share.size,
        traced=history.traced,
        endless=True,
        skipped="",
        finest=_FINEST,
    )
    return solve_levels(history, resolution, missing=_missing)[0]


def _missing(seen: MotionHistory) -> tuple[Array, Array]:
    """Work of the body that the elements did not receive, and the largest of it [J]."""
    return seen.pressed - seen.work, xp.max(xp.abs(seen.pressed))


def _ruled(
    even: Steps, line: Timeline, finer: int, value: Array, by_depth: np.ndarray
) -> Steps:
    """Steps that go towards the ends of their intervals, wherever these begin."""
    interval = np.repeat(line.interval, finer)
    share = np.repeat(line.share / finer, finer)
    begin = np.repeat(line.fraction - line.share, finer)
    begin = begin + np.tile(np.arange(finer), line.share.size) * share
    part = share / (1 - begin)
    part[finer * (line.instant + 1) - 1] = 1.0
    return even._replace(
        value=xp.concatenate([value[:1], value[1:][interval]]),
        in_turn=InTurn(
            np.append(1.0, part), np.append(by_depth[0], by_depth[1:][interval])
        ),
    )


@compiled("n", "room")
def _half(disc: Disc, spacing: Array, n: int, room: int) -> Half:
    """n elements from the axis on, and `room` for more, which are never touched."""
    i = xp.arange(room)
    if disc.flat:
        weight = xp.where(i < n, disc.width(xp.asarray(disc.largest)) / n, 0.0)
        profile = xp.where(i < n, 0.0, -NOTHING)
        return Half(weight, xp.asarray(spacing), profile)
    x = spacing * i
    inside = (i < n) & (x < disc.largest)
    x = xp.where(inside, x, 0.5 * xp.minimum(spacing, disc.largest))
    weight = disc.weight(x) * spacing
    # of straight lines through the elements
    tip = weight[:1] / 3 + weight[1:2] / 6
    weight = xp.concatenate([tip, weight[1:]])
    profile = xp.where(inside, disc.profile(x), -NOTHING)
    return Half(weight, xp.asarray(spacing), profile)


@compiled()
def _reach(modes: Modes, disc: Disc, ruled: Ruled) -> Array:
    """A radius that no contact of a history exceeds: that of the largest load, kept, or
    of the largest depth.
    """
    time, value, by_depth = ruled
    span = time[-1] - time[0]
    creep = modes.instantaneous + xp.sum(
        modes.gain * span * phi1(modes.rate * span), axis=-1
    )
    load, depth = (
        xp.max(xp.where(rules, value, 0.0)) for rules in (~by_depth, by_depth)
    )
    radii = disc.radius_of_area(creep * load), disc.radius_of_depth(depth)
    limit = xp.asarray(disc.largest)
    return xp.maximum(*(xp.where(r < limit, r, limit) for r in radii))
