"""Press and pull: an adhesive contact on viscoelastic elements that keep their whole
memory, with an edge whose work of adhesion depends on its speed.

An edge that opens at a speed v takes Gamma(v) times the work of adhesion w, one that
closes gives w/Gamma(v), and the elements there answer with the modulus E_0 Gamma(v)
(`adhesive_contact`). With the force density q of the element at the edge a, and the
clearance c of the free surface before it, below a body at depth d,

    it recedes at v where    q^2 = T(a) E_0 Gamma(v), q < 0,
    advances at v where      E_0 (c - d)^2 = T(a)/Gamma(v),
    and stays in between,

T = 2 pi a w on a half-space, 2 w on springs. So Gamma enters at the edge only, and
memory by the relation of depth and force only: an argument, not a theorem
(`docs/accuracy.md` compares with boundary elements). A threshold of displacement for
an edge that recedes fails.

All elements are exact in time for a depth that is linear over a step. An edge that is
at y after it stands for one depth and one force, in closed form, inside the edge before
as outside: one root gives the step, under a depth as under a load, and where there is
none the body comes off. Between nodes everything is linear: second order.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..arrays import stop_gradient, tree_map, xp
from ..checks import (
    Array,
    argmax,
    is_traced,
    nan_unless,
    numbers_only,
    numpy_unless_traced,
)
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1
from ..surface.disc import Disc
from .adhesive_contact import (
    Adhesion,
    Adhesive,
    AdhesiveEdge,
    Bond,
    Event,
    Limit,
    Sticky,
    tension,
)
from .indentation_route import DepthOrLoad, Indented

_HALVINGS = 10  # of a step in which the body meets the rubber, comes off, or nearly
_LOST = 0.05  # of the radius in a step, at most; twice as much for the error
_EXACT = 1e-14  # of the largest radius: where an edge is
_AT_ONCE = 1e-280  # duration of a jump [s]
_TINY = 1e-300  # force [N]: a load that is zero is known
_UNKNOWN = (np.nan, np.nan)  # depth and force of a body that a load has pulled off
_ROUNDING = 1e-14
_CELLS = 400  # under the widest contact; half as many for the error
_STEPS = 200  # at least, of a history
_FAR = 1.1  # over the widest relaxed contact: rubber that was pulled up is met early
_RESTING = 24  # steps of a rest, in geometric progression
_ROUNDS = 5  # in which steps are halved
_RTOL = 0.03  # what a history with memory is held to
_WORST = 0.1  # error of the force from which it is not known when or how contact breaks
_SOON = 1e-6  # of a rest: its first step
_LARGEST = 100.0  # contact [m]
MEMORY = "elements with all their memory, an edge that moves by its own speed"
JKR = "JKR in closed form, root by root"


class StickyContact(NamedTuple):
    """An adhesive contact at one instant, or at many."""

    time: np.ndarray
    depth: np.ndarray
    force: np.ndarray
    radius: np.ndarray
    speed: np.ndarray  # of the edge, outwards [m/s]
    work: np.ndarray  # done by the body so far [J]


class Cycle:
    """A body and the elements under it, marched in time; before, they have not met."""

    def __init__(
        self, law: Relaxation, disc: Disc, bond: Bond, widest: float, cells: int
    ):
        self.law, self.disc, self.bond = law, disc, bond
        # the element at the edge stands last
        self.x = np.append(np.linspace(0, widest, cells + 1), 0.0)
        self.height = np.asarray(disc.profile(self.x))
        self.least = 1 - _LOST * _CELLS / cells  # of the radius, after a step
        self.u = np.zeros_like(self.x)
        self.f = np.zeros((self.x.size, law.times.size))
        self.touches, self.radius, self.speed = False, 0.0, 0.0
        self.outwards = True  # whether the edge has last moved so
        self.time, self.depth, self.force, self.work = 0.0, 0.0, 0.0, 0.0
        # the first contact, and where the body pulled most before it came off
        self.jump_in = self.pull_off = self._most = StickyContact(
            *(np.array(np.nan),) * 6
        )

    def march(
        self,
        time: np.ndarray,
        value: np.ndarray,
        by_depth: np.ndarray,
        shares: Sequence[np.ndarray],
    ) -> StickyContact:
        """The contact at m instants, of which the first is a jump from rest. The steps
        to an instant end at `shares` of the way, the last of them 1.
        """
        self.time, found = float(time[0]), []
        for end, goal, depth_rules, parts in zip(
            time, value, by_depth, shares, strict=True
        ):
            begin, start = self.time, self.depth if depth_rules else self.force
            for part in parts:
                now = begin + part * (end - begin)
                self._advance(now, start + part * (goal - start), bool(depth_rules))
            found.append(self._now())
        return StickyContact(*np.array(found).T)

    def _now(self) -> StickyContact:
        state = (self.time, self.depth, self.force, self.radius, self.speed, self.work)
        return StickyContact(*map(np.array, state))

    def _advance(self, time: float, goal: float, by_depth: bool) -> None:
        """One step; halved towards the instant at which the body meets the rubber in it
        or comes off, and while the edge runs.
        """
        begin, start = self.time, self.depth if by_depth else self.force
        done, part = 0.0, 1.0
        while done < 1:
            end = min(1.0, done + part)
            duration = part * (time - begin)
            step = _StickyStep(self, duration, start + end * (goal - start), by_depth)
            off = step.edge is None and self.touches
            met = step.edge is not None and not self.touches
            lost = self.touches and (step.edge or 0.0) < self.least * self.radius
            if (lost or met) and duration > 0 and part > 2.0**-_HALVINGS:
                part /= 2
                continue
            if off and np.isnan(self.pull_off.time):
                self.pull_off = self._most
            step.take()
            self.time, done = begin + end * (time - begin), end
            if met and np.isnan(self.jump_in.time):
                self.jump_in = self._now()
            part = min(2 * part, 1 - done)
            if self.touches and not self.force >= self._most.force:
                self._most = self._now()


class _StickyStep:
    """All elements after a step of time in which the depth has not moved, and where the
    edge is then for the depth, or the load, that is given.
    """

    def __init__(self, cycle: Cycle, duration: float, goal: float, by_depth: bool):
        self.cycle, self.by_depth, self.goal = cycle, by_depth, goal
        self.duration = max(duration, _AT_ONCE)
        law, x, a = cycle.law, cycle.x, cycle.radius
        y = duration / law.times
        self.gain = law.moduli * phi1(y)
        self.stiffness = float(law.equilibrium + self.gain.sum())
        self.f = cycle.f * np.exp(-y)
        self.held = law.equilibrium * cycle.u + self.f.sum(axis=1)
        self.free = cycle.u - self.held / self.stiffness
        # contact from the axis to the edge, and what is free from there outwards
        nodes = np.arange(x.size - 1)
        within = x[:-1] <= a if cycle.touches else np.zeros(nodes.size, bool)
        self.inside = (
            np.append(nodes[within], nodes.size) if cycle.touches else nodes[:0]
        )
        self.outside = nodes[~within]
        ahead = self.outside if self.outside.size else nodes[-1:]
        self.place = np.append(a, x[ahead])
        self.clear = np.append(cycle.disc.profile(np.array(a)), cycle.height[ahead])
        self.clear += self.free[ahead[[0, *range(ahead.size)]]]
        self.edge = self._find()

    def _find(self) -> float | None:
        """The edge after the step; None where the body is off."""
        cycle, goal = self.cycle, self.goal
        if not cycle.touches:
            meets = goal >= (self.clear[0] if self.by_depth else 0.0)
            return self._ahead() if meets else None
        # Elements that have just been crossed have not relaxed, so that a moment later
        # an edge at rest could cross them back: what is pressed goes on outwards while
        # it can, what is pulled inwards.
        edge, change = (
            cycle.radius,
            goal - (cycle.depth if self.by_depth else cycle.force),
        )
        first = change > 0 or (change == 0 and cycle.outwards)
        for outwards in (first, not first):
            here = self._value(np.array([edge]), outwards)[0]
            if outwards and goal > here:
                return self._ahead()
            if not outwards and goal < here:
                places = cycle.x[self.inside][::-1]
                return self._first(places, self._value(places) <= goal)
        return edge

    def _ahead(self) -> float:
        """The edge where it advances, at most to the end of the body."""
        values = self._value(self.place, outwards=True)
        edge = self._first(self.place, values > self.goal)
        return float(self.place[-1]) if edge is None else edge

    def _first(self, places: np.ndarray, passed: np.ndarray) -> float | None:
        """The first place at which what is given is passed, in a row of places."""
        from scipy.optimize import brentq  # not loaded where nothing sticks

        after = np.flatnonzero(passed[1:])
        if not after.size:
            return None
        ends = places[after[0] : after[0] + 2].tolist()
        outwards = ends[1] > ends[0]

        def beyond(y: float) -> float:
            return float(self._value(np.array([y]), outwards)[0]) - self.goal

        if beyond(ends[0]) * beyond(ends[1]) >= 0:
            return ends[1]
        exact = _EXACT * self.cycle.x[-2]
        return float(brentq(beyond, *ends, xtol=exact))  # pyright: ignore

    def _value(self, y: np.ndarray, outwards: bool = False) -> np.ndarray:
        """The depth, or the force, that an edge stands for which has moved to y."""
        cycle = self.cycle
        taken = tension(cycle.disc, cycle.bond.work, y)
        modulus = cycle.law.equilibrium * self._factor(y, outwards)
        if outwards:
            depth = np.interp(y, self.place, self.clear) - np.sqrt(taken / modulus)
        else:
            q = np.interp(y, cycle.x[self.inside], self.held[self.inside])
            depth = cycle.depth - (np.sqrt(taken * modulus) + q) / self.stiffness
        return depth if self.by_depth else self._force(y, depth, outwards)

    def _force(
        self, y: np.ndarray, depth: np.ndarray | float, outwards: bool
    ) -> np.ndarray:
        """The force at a depth while the edge is at y."""
        cycle, disc = self.cycle, self.cycle.disc
        force, inner = np.zeros(y.shape), np.minimum(y, cycle.radius)
        if self.inside.size:
            where, held = cycle.x[self.inside], self.held[self.inside]
            rise = self.stiffness * (depth - cycle.depth)
            force = _integral(disc, where, held, inner) + rise * disc.width(inner)
        if outwards:
            joined = depth * (disc.width(y) - disc.width(inner))
            joined = joined - _integral(disc, self.place, self.clear, y)
            force = force + cycle.law.equilibrium * self._factor(y, outwards) * joined
        return force

    def _factor(self, y: np.ndarray, outwards: bool) -> np.ndarray:
        """Gamma of an edge that has moved to y."""
        return self.cycle.bond.at(abs(y - self.cycle.radius) / self.duration, outwards)

    def take(self) -> None:
        """Moves the elements."""
        cycle, edge, rise = self.cycle, self.edge, self.free - self.cycle.u
        before, force, radius, touched = (
            cycle.depth,
            cycle.force,
            cycle.radius,
            cycle.touches,
        )
        cycle.touches = edge is not None
        if edge is None:
            cycle.depth, cycle.force = (self.goal, 0.0) if self.by_depth else _UNKNOWN
            cycle.radius = cycle.speed = 0.0
        else:
            cycle.depth, cycle.force = self._settled(edge, edge >= radius)
            if edge != radius:
                cycle.outwards = edge > radius
            moved = (edge - radius) / self.duration
            cycle.radius = edge
            cycle.speed = moved if self.duration > _AT_ONCE else np.nan  # a jump
            rise[self.inside] = cycle.depth - before
        cycle.u = cycle.u + rise
        cycle.f = self.f + self.gain * rise[:, None]
        self._cross(radius)
        if touched and np.isfinite(cycle.depth):
            cycle.work += 0.5 * (force + cycle.force) * (cycle.depth - before)

    def _settled(self, edge: float, outwards: bool) -> tuple[float, float]:
        """Depth and force for an edge: one is given, the other is linear in it."""
        y, here = np.array([edge]), self.cycle.depth if self.inside.size else 0.0
        if self.by_depth:
            return self.goal, float(self._force(y, self.goal, outwards)[0])
        scale = self.cycle.height[-2] + self.cycle.x[-2]
        low, high = (
            float(self._force(y, here + move, outwards)[0]) for move in (0.0, scale)
        )
        return here + scale * (self.goal - low) / (high - low), self.goal

    def _cross(self, radius: float) -> None:
        """Lets go of the elements that the edge has left, and takes on those that it
        has reached; the element at the edge is one between two others.
        """
        cycle, edge = self.cycle, self.edge
        if edge is None:
            self._jump(self.inside, np.inf, free=True)
        elif self.inside.size and edge < radius:
            at_edge = self._between(self.inside, edge)
            rows = self.inside[cycle.x[self.inside] > edge]
            self._jump(rows, (radius - edge) / self.duration, free=True)
            cycle.x[-1], cycle.u[-1], cycle.f[-1] = edge, *at_edge
        elif not self.inside.size or edge > radius:
            cycle.u[-1], cycle.f[-1] = self._between(self.outside, edge)
            cycle.x[-1], cycle.height[-1] = edge, cycle.disc.profile(np.array(edge))
            rows = self.outside[cycle.x[self.outside] <= edge]
            rows = np.append(rows, cycle.x.size - 1)
            self._jump(rows, (edge - radius) / self.duration, free=False)

    def _between(self, rows: np.ndarray, x: float) -> tuple[float, np.ndarray]:
        """Displacement and branches at a place among rows ascending in x."""
        cycle, places = self.cycle, self.cycle.x[rows]
        right = int(np.clip(np.searchsorted(places, x), 1, max(1, rows.size - 1)))
        pair = rows[[right - 1, min(right, rows.size - 1)]]
        a, b = cycle.x[pair]
        share = 0.0 if a == b else float(np.clip((x - a) / (b - a), 0, 1))
        weights = np.array([1 - share, share])
        return float(weights @ cycle.u[pair]), weights @ cycle.f[pair]

    def _jump(self, rows: np.ndarray, speed: float, free: bool) -> None:
        """Elements that the edge crosses at a speed jump to the body, or to rest from
        it, with the modulus E_0 Gamma: that of a time after which its branches are what
        is left.
        """
        cycle, law = self.cycle, self.cycle.law
        moduli = law.moduli * cycle.bond.left(speed, closing=not free)
        if free:
            q = law.equilibrium * cycle.u[rows] + cycle.f[rows].sum(axis=1)
            jump = -q / (law.equilibrium + moduli.sum())
        else:
            jump = cycle.depth - cycle.height[rows] - cycle.u[rows]
        cycle.u[rows] += jump
        cycle.f[rows] += moduli * jump[:, None]


def _integral(
    disc: Disc, where: np.ndarray, values: np.ndarray, y: np.ndarray
) -> np.ndarray:
    """int weight values dx from the first place to y."""
    weighted = disc.weight(where) * values
    parts = 0.5 * (weighted[1:] + weighted[:-1]) * np.diff(where)
    left = np.clip(np.searchsorted(where, y, side="right") - 1, 0, where.size - 1)
    here = disc.weight(y) * np.interp(y, where, values)
    return np.append(0.0, np.cumsum(parts))[left] + 0.5 * (weighted[left] + here) * (
        y - where[left]
    )


def indent_with_adhesion(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    course: DepthOrLoad,
    adhesion: Adhesion,
    rtol: float,
) -> Indented:
    """JKR for an elastic foundation; elements with memory for a viscoelastic one."""
    shape = course.time.shape
    by_depth = course.by_depth
    if by_depth is None:
        by_depth = xp.full(shape, course.load is None)
    depth, load = (
        xp.zeros(shape) if values is None else xp.nan_to_num(values)
        for values in (course.depth, course.load)
    )
    rows = [a.reshape(-1, shape[-1]) for a in (course.time, depth, load, by_depth)]
    if law.moduli.shape[0] == 0 or (not is_traced(law) and not law.moduli.any()):
        return _shaped(_elastic(law, disc, adhesion, *rows), shape, rtol)
    numbers_only(
        {
            "material": (law, modes),
            "shape": disc,
            "time": course.time,
            "depth": course.depth,
            "load": course.load,
            "adhesion": adhesion,
        },
    )
    found = _with_memory(law, modes, disc, adhesion, *rows)
    return _shaped(found, shape, max(rtol, _RTOL))


class _Found(NamedTuple):
    """Histories (n, m), their events (n,)."""

    contact: Adhesive
    error: Array
    edge: AdhesiveEdge
    plan: str


class _History(NamedTuple):
    """One history, (m,)."""

    contact: StickyContact
    jump_in: Event
    pull_off: Event
    zone_off: float
    error: np.ndarray
    loop: float  # work in all, NaN without a pull-off, or where it depends on steps


def _shaped(found: _Found, shape: tuple[int, ...], rtol: float) -> Indented:
    """Histories as they were given."""

    def shaped(rows: Array) -> Array:
        return rows.reshape((*shape[:-1], *rows.shape[1:]))

    contact = tree_map(shaped, found.contact)
    edge, error = tree_map(shaped, found.edge), shaped(found.error)
    known = xp.isfinite(contact.force)
    reason = ""
    if not is_traced(known, error):
        if not known.all():
            reason = "A load pulled the body off."
        elif not (error <= rtol).all():
            reason = "The body meets it or comes off too near to these instants."
    return Indented(
        depth=contact.depth,
        force=contact.force,
        radius=contact.radius,
        work=contact.work,
        stored=contact.stored,
        locked=0 * abs(contact.stored),
        heat=contact.work - contact.stored,
        error=xp.where(known, error, xp.nan),
        converged=known & (error <= rtol),
        plan=found.plan,
        reason=reason,
        edge=edge,
        held_to=rtol,
    )


def _elastic(
    law: Relaxation,
    disc: Disc,
    adhesion: Adhesion,
    time: Array,
    depth: Array,
    load: Array,
    by_depth: Array,
) -> _Found:
    sticky = Sticky(disc, law.equilibrium, adhesion.work)
    contact, begins, breaks = sticky.cycle(depth, load, by_depth)
    value, touches = xp.where(by_depth, depth, load), contact.radius > 0

    def crossed(
        change: Array, edges: tuple[Limit, Limit], limits: tuple[Array, Array]
    ) -> Event:
        """The first change: between two instants, where what is given is the limit."""
        i = argmax(change.T)[:, None]
        before, after, start, end, rules = (
            xp.take_along_axis(row, i + k, axis=1)[:, 0]
            for row, k in ((value, 0), (value, 1), (time, 0), (time, 1), (by_depth, 1))
        )
        found = change.any(axis=1)
        way = xp.where(found, after - before, 1.0)
        share = (xp.where(rules, *limits) - before) / way
        radius, depth, force = map(xp.where, (rules,) * 3, *edges)
        error = xp.full(found.shape, _ROUNDING)
        row = (start + share * (end - start), depth, force, radius, error)
        return Event(*(nan_unless(found, one) for one in row))

    zero = np.zeros(())
    exact = xp.full(touches.shape, _ROUNDING)
    at_once = (time, contact.depth, contact.force, contact.radius, exact)
    with np.errstate(all="ignore"):
        jump_in = crossed(touches[:, 1:] & ~touches[:, :-1], begins, (zero, zero))
        pull_off = crossed(
            touches[:, :-1] & ~touches[:, 1:],
            breaks,
            (breaks[0].depth, breaks[1].force),
        )
        jump_in = Event(
            *(
                xp.where(touches[:, 0], one[:, 0], other)
                for one, other in zip(at_once, jump_in, strict=True)
            )
        )
        cutoff = stop_gradient(adhesion.length(law.equilibrium))
        radius, off = stop_gradient((contact.radius, pull_off.radius))
        zone = xp.where(touches, cutoff / radius, xp.nan)
        moved = xp.diff(contact.radius) / xp.diff(time)
        nothing = xp.full(touches[:, :1].shape, xp.nan)
        edge = AdhesiveEdge(
            speed=xp.concatenate([nothing, moved], axis=1),
            factor=xp.ones(touches.shape),
            zone=zone,
            pull_off=pull_off,
            jump_in=jump_in,
            loop=nan_unless(xp.isfinite(pull_off.time), _last(contact.work)),
            zone_off=xp.fmax(cutoff / off, xp.nanmax(zone, axis=1, initial=0.0)),
            scale=xp.full(len(touches), -4 / 3 * breaks[0].depth),
        )
    return _Found(contact, exact, edge, JKR)


@numpy_unless_traced
def _with_memory(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    adhesion: Adhesion,
    time: np.ndarray,
    depth: np.ndarray,
    load: np.ndarray,
    by_depth: np.ndarray,
) -> _Found:
    bond = adhesion.bond(law, modes)
    widest = max(
        _widest(law, disc, bond, float(values[which].max()), rules)
        for values, which, rules in ((depth, by_depth, True), (load, ~by_depth, False))
        if which.any()
    )
    rows = [
        _marched(law, disc, bond, widest, *row)
        for row in zip(time, depth, load, by_depth, strict=True)
    ]
    contact, jump_in, pull_off, zone_off, error, loop = tree_map(
        lambda *each: np.array(each), *rows
    )
    factor, given = (bond.at(abs(contact.speed), closing=k) for k in (False, True))
    with np.errstate(divide="ignore"):
        zone = bond.cutoff * factor / contact.radius
    zone = np.where(contact.radius > 0, zone, np.nan)
    largest = np.nanmax(zone, axis=-1, initial=0.0)  # that of a jump is not known
    nothing = np.full(time.shape, np.nan)
    return _Found(
        Adhesive(contact.depth, contact.force, contact.radius, contact.work, nothing),
        error,
        AdhesiveEdge(
            speed=contact.speed,
            factor=np.where(contact.speed > 0, 1 / given, factor),
            zone=zone,
            pull_off=pull_off,
            jump_in=jump_in,
            loop=loop,
            zone_off=np.where(np.isnan(zone_off), largest, zone_off),
            scale=np.full(len(time), -4 / 3 * _relaxed(law, disc, bond)[1].min()),
        ),
        f"{MEMORY}, {_CELLS} elements",
    )


def _event(fine: StickyContact, coarse: StickyContact) -> Event:
    """What two marches know of an event."""
    off = abs(fine.force - np.nan_to_num(coarse.force))
    error = off / np.maximum(abs(fine.force), _TINY)
    return Event(*(nan_unless(error <= _WORST, x) for x in fine[:4]), error=error)


def _marched(
    law: Relaxation,
    disc: Disc,
    bond: Bond,
    widest: float,
    time: np.ndarray,
    depth: np.ndarray,
    load: np.ndarray,
    by_depth: np.ndarray,
) -> _History:
    """A history, its first contact and its pull-off, and the error of what was asked
    for: against half as many elements and steps, which are halved where it is too large.
    """
    value = np.where(by_depth, depth, load)

    def marched(shares: list[np.ndarray]) -> _History:
        fine, coarse = (Cycle(law, disc, bond, widest, _CELLS // n) for n in (1, 2))
        found = fine.march(time, value, by_depth, shares)
        half = coarse.march(
            time, value, by_depth, [part[::-2][::-1] for part in shares]
        )
        asked, again = (np.where(by_depth, c.force, c.depth) for c in (found, half))
        force, depth = (
            np.nanmax(abs(row), initial=0.0) or 1.0
            for row in (found.force, found.depth)
        )
        error = abs(asked - again) / np.where(by_depth, force, depth)
        sure = abs(fine.work - coarse.work) <= _RTOL * abs(fine.work)
        sure = sure and bool(np.isfinite(fine.pull_off.time))
        loop = fine.work if sure else np.nan
        jump_in = _event(fine.jump_in, coarse.jump_in)
        pull_off = _event(fine.pull_off, coarse.pull_off)
        zone = bond.cutoff * bond.at(abs(fine.pull_off.speed)) / pull_off.radius
        return _History(found, jump_in, pull_off, float(zone), error, loop)

    history = marched(shares := _shares(value, by_depth))
    for done in range(_ROUNDS):
        came_off = not np.isnan(history.pull_off.error)
        again = done == 0 and came_off and np.isnan(history.loop)
        if not (again or (history.error > _RTOL).any()):
            break
        missed = again | (history.error > 0.25 * _RTOL)
        shares = [
            _halved(part) if miss else part
            for part, miss in zip(shares, missed, strict=True)
        ]
        history = marched(shares)
    return history


def _shares(value: np.ndarray, by_depth: np.ndarray) -> list[np.ndarray]:
    """Where the steps to each instant end, from 0 to 1: even in a motion, in geometric
    progression at rest; an even number, for a coarser march.
    """
    way, control = abs(np.diff(value)), np.diff(by_depth)
    whole = np.where(
        by_depth[1:],
        *(
            np.ptp(value[by_depth == k]) if (by_depth == k).any() else 1.0
            for k in (True, False)
        ),
    )
    part = np.where(control, 0.1, way / np.where(whole > 0, whole, 1.0))
    even = [
        np.linspace(0, 1, 2 * max(1, int(np.ceil(0.25 * _STEPS * p))) + 1)[1:]
        for p in part
    ]
    rest = np.geomspace(_SOON, 1, _RESTING)
    few = part.size < _STEPS
    return [
        np.ones(1),
        *(
            rest if few and p < 1 / _STEPS else e
            for p, e in zip(part, even, strict=True)
        ),
    ]


def _halved(part: np.ndarray) -> np.ndarray:
    """Steps with one more end in the middle of each."""
    begin = np.append(0.0, part[:-1])
    return np.column_stack([0.5 * (begin + part), part]).ravel()


def _relaxed(
    law: Relaxation, disc: Disc, bond: Bond
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radii, depths and forces of relaxed rubber (JKR)."""
    jkr = Sticky(disc, law.equilibrium, np.asarray(bond.work))
    largest = min(float(disc.largest), _LARGEST)
    a = np.geomspace(1e-12 * largest, largest, 800)
    depth = np.asarray(jkr.depth(a))
    return a, depth, np.asarray(jkr.force(a, depth))


def _widest(
    law: Relaxation, disc: Disc, bond: Bond, most: float, by_depth: bool
) -> float:
    """A radius that the contact does not exceed [m]: a tenth above that of relaxed
    rubber at the largest depth, or load.
    """
    a, depth, force = _relaxed(law, disc, bond)
    value = depth if by_depth else force
    below = np.flatnonzero(value <= most)
    last = below[-1] if below.size else int(np.argmin(value))
    return min(float(a[-1]), _FAR * float(a[min(last + 1, a.size - 1)]))


def _last(work: Array) -> Array:
    """The last value that is known of each row."""
    known = xp.isfinite(work)
    last = work.shape[-1] - 1 - argmax(known[:, ::-1].T)
    return xp.take_along_axis(work, last[:, None], axis=1)[:, 0]
