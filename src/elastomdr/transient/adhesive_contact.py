"""Adhesion of two surfaces: of an elastic foundation in closed form (Johnson, Kendall &
Roberts 1971), and what an edge on rubber takes and gives at a speed.

An element at the edge lets go when the energy it gives back, E delta^2/2 per element
and side, is the work of adhesion of the area that opens: the edge is stretched by
delta(a) = sqrt(2 pi a w/E) on the half-space, sqrt(2 w/E) on a layer (Hess 2011; Popov
& Hess 2015, ch. 4). So d = g(a) - delta(a) and F = E [A(a) - W(a) delta(a)]. Of two
radii at one depth, or load, the larger is stable; it ends where d, or F, is least.

In rubber the work of adhesion w depends on the speed v of the edge: the material around
it relaxes within a cutoff length a_0 for a time a_0/v (Persson & Brener, Phys. Rev. E
71, 2005, 036123). Gamma = G(v)/w follows from the Kelvin modes (J_j, lambda_j) of the
half-space and its relaxed modulus E_0:

    1/Gamma = 1 - E_0 sum_j J_j h(2 pi v lambda_j/(a_0 Gamma)),
    h(b) = (sqrt(1 + b^2) - 1)/b,

between 1 at rest and E_inf/E_0 of an edge that is fast.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ..arrays import scan, stop_gradient, xp
from ..checks import (
    Array,
    as_float64,
    ascending,
    finite,
    is_traced,
    not_negative,
    plain,
    positive,
    scalar,
)
from ..element.episode import Modes
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..numerics.root import bisect
from ..surface.disc import Disc
from ..trees import Tree, fill, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import Number

    Edge = Literal["persson-brener", "glassy", "elastic"]

# a_0 = 6 E_0 w/(pi strength^2): 4 to 8 by Tabor number, of 9,005 pull-offs
# (docs/accuracy.md)
_CUTOFF = 6.0
_TIMES = 2000  # at which a modulus is looked up
_PER_DECADE = 24  # speeds of a table
_BEYOND = 6.0  # decades of speed beyond the slowest and the fastest mode
_HALVINGS = 80
_WIDEST = 1e100  # contact [m]
_ROUNDING = 1e-12
_DOUBLE = 1e-14  # of depth or load: where a root is double
_CLOSE = 1e-3  # of a radius: a Newton step that carries derivatives


class Adhesive(NamedTuple):
    """An adhesive contact at m instants; NaN where a load is not carried any more."""

    depth: Array
    force: Array
    radius: Array
    work: Array
    stored: Array  # elastic energy less the work of adhesion of the area in contact [J]


class Event(NamedTuple):
    """Where and when a contact begins or breaks; NaN where it does not, and but for
    the error where that is too large.
    """

    time: Array
    depth: Array
    force: Array
    radius: Array
    error: Array  # of the force, relative


class AdhesiveEdge(NamedTuple):
    """The edge of adhesive contacts, (n, m), and what happened at it, (n,)."""

    speed: Array  # outwards [m/s]
    factor: Array  # of the work of adhesion [1]
    zone: Array  # cutoff times Gamma over the radius [1]
    pull_off: Event
    jump_in: Event
    loop: Array  # work of the body in all [J]
    zone_off: Array  # `zone` at the pull-off; without one, the largest
    scale: Array  # depth that belongs to the work of adhesion, as D of JKR [m]


class Bond:
    """What an edge takes and gives, over its speed: Gamma as a table, straight in
    logarithms; beyond its ends as there.
    """

    def __init__(
        self,
        law: Relaxation,
        work: float,
        cutoff: float,
        speed: np.ndarray,
        factor: np.ndarray,
        closes: bool = True,
    ):
        self.work, self.cutoff = work, cutoff  # w [J/m^2], a_0 [m] or NaN
        self._closes = closes  # whether what an edge gives depends on its speed
        self._law, self._speed, self._factor = law, np.log(speed), np.log(factor)
        ends = law.times[0] * 1e-17, law.times[-1] * 1e3
        self._age = np.log(np.geomspace(*ends, _TIMES))
        self._modulus = law.equilibrium + self._left(self._age) @ law.moduli

    def at(self, speed: np.ndarray, closing: bool = False) -> np.ndarray:
        """Gamma at speeds >= 0 [m/s] of an edge that opens, or closes."""
        if closing and not self._closes:
            return np.ones(speed.shape)
        logarithm = np.log(np.maximum(speed, np.exp(self._speed[0])))
        return np.exp(np.interp(logarithm, self._speed, self._factor))

    def left(self, speed: float, closing: bool) -> np.ndarray:
        """What is left of each branch at the age at which rubber has relaxed to the
        modulus Gamma E_0.
        """
        modulus = float(self.at(np.array(speed), closing) * self._law.equilibrium)
        age = np.interp(-modulus, -self._modulus, self._age)
        return self._left(np.array([age]))[0]

    def _left(self, age: np.ndarray) -> np.ndarray:
        return np.exp(-np.exp(age)[:, None] / self._law.times)


class Adhesion(Tree):
    """Adhesion of a body and rubber, for `em.indent(adhesion=...)`.

    Args:
        work: work of adhesion at rest [J/m^2].
        cutoff: length at the edge within which bonds open [m], 1 nm to some um in
            rubber. Viscoelastic rubber needs it, or `strength`.
        strength: largest stress between the surfaces [Pa], from which the cutoff is
            6 E_0 work/(pi strength^2) on a half-space of relaxed modulus E_0.
        edge: what the edge takes at a speed. "persson-brener": computed from the
            rubber; "elastic": `work` at any speed, a lower limit; "glassy": as much as
            the rubber can take where it opens, `work` where it closes, an upper limit,
            and what a plain number stands for; or a table of speeds [m/s], ascending,
            and factors on `work`, 1 or more.

    Source: Persson & Brener, Phys. Rev. E 71 (2005) 036123; `docs/theory.md`.

    Raises:
        InputError: for negative values, for both cutoff and strength, and
            for a table that does not ascend or has factors below 1.
    """

    work: Float[Array, ""]  # [J/m^2]
    cutoff: float | None = static()
    strength: float | None = static()
    edge: "Edge | tuple[tuple[float, ...], tuple[float, ...]]" = static()

    def __init__(
        self,
        work: Number,
        *,
        cutoff: Number | None = None,
        strength: Number | None = None,
        edge: "Edge | tuple[Sequence[float], Sequence[float]]" = "persson-brener",
    ):
        lengths = {"cutoff": cutoff, "strength": strength}
        for name, value in lengths.items():
            if value is not None:
                lengths[name] = number = plain(name, value)
                positive(name, number)
        if cutoff is not None and strength is not None:
            raise InputError(
                argument="cutoff",
                got=cutoff,
                accepted="left out where strength is given",
                hint="both say the same",
            )
        fill(self, work=scalar("work", work), **lengths, edge=_edge(edge))
        not_negative("work", self.work)

    def bond(self, law: Relaxation, modes: Modes) -> Bond:
        """What the edge takes on a half-space of this law, or on springs of it."""
        work, equilibrium = float(self.work), float(law.equilibrium)
        glassy = 1 + float(law.moduli.sum()) / equilibrium
        a0 = float(self.length(equilibrium))
        if not isinstance(self.edge, str):
            speed, factor = map(np.array, self.edge)
            return Bond(law, work, a0, speed, factor)
        if self.edge != "persson-brener" or glassy == 1:
            factor = np.full(2, glassy if self.edge == "glassy" else 1.0)
            return Bond(law, work, a0, np.array([1.0, 2.0]), factor, closes=False)
        if np.isnan(a0):
            raise InputError(
                argument="cutoff",
                got=None,
                accepted="given on viscoelastic rubber, or strength",
                hint="em.Adhesion(work, cutoff=1e-7), of 1e-9 to 1e-6 m as a rule; "
                'edge="glassy" is an upper limit without it',
            )
        return Bond(law, work, a0, *_table(equilibrium, modes, a0))

    def length(self, equilibrium: Array | float) -> Array | float:
        """Cutoff a_0 [m] on rubber of this relaxed modulus; NaN if it is not given."""
        if self.cutoff is not None:
            return self.cutoff
        if self.strength is None:
            return float("nan")
        return _CUTOFF * equilibrium * self.work / (np.pi * self.strength**2)


def _edge(edge: object) -> object:
    if isinstance(edge, str):
        if edge in ("persson-brener", "glassy", "elastic"):
            return edge
    elif isinstance(edge, Sequence | np.ndarray) and len(edge) == 2:
        speed, factor = (np.atleast_1d(as_float64("edge", row)) for row in edge)
        finite("edge", speed)
        finite("edge", factor)
        ascending("edge", speed)
        alike = speed.size > 1 and speed.shape == factor.shape
        if alike and speed[0] > 0 and (factor >= 1).all():
            return tuple(speed.tolist()), tuple(factor.tolist())
    raise InputError(
        argument="edge",
        got=edge,
        accepted='"persson-brener", "glassy", "elastic", or (speeds, factors): two or '
        "more positive speeds [m/s] and as many factors of 1 or more",
    )


def _table(
    equilibrium: float, modes: Modes, cutoff: float
) -> tuple[np.ndarray, np.ndarray]:
    """Speeds and Gamma: for v/Gamma as the parameter it is a sum."""
    rate, gain = (
        np.asarray(m)[np.asarray(modes.gain) > 0] for m in (modes.rate, modes.gain)
    )
    low, high = np.log10(rate.min()) - _BEYOND, np.log10(rate.max()) + _BEYOND
    turns = np.logspace(low, high, int(_PER_DECADE * (high - low)))
    b = turns[:, None] / rate
    lost = b / (1 + np.sqrt(1 + b**2))
    factor = 1 / (1 - equilibrium * np.sum(gain / rate * lost, axis=1))
    return turns * factor * cutoff / (2 * np.pi), factor


class Limit(NamedTuple):
    """Radius, depth and force at which an adhesive contact begins or breaks."""

    radius: Array
    depth: Array
    force: Array


class Elastic(NamedTuple):
    """Elastic adhesive contacts (n, m), and where they begin and break by depth and by
    load.
    """

    contact: Adhesive
    begins: tuple[Limit, Limit]
    breaks: tuple[Limit, Limit]


class Sticky(NamedTuple):
    """An elastic contact with a work of adhesion."""

    disc: Disc
    modulus: Array  # E [Pa; layer Pa/m]
    work: Array  # [J/m^2]

    def stretch(self, a: Array) -> Array:
        """delta(a)."""
        return xp.sqrt(tension(self.disc, self.work, a) / self.modulus)

    def depth(self, a: Array) -> Array:
        """d at which a is the edge."""
        return self.disc.profile(a) - self.stretch(a)

    def force(self, a: Array, depth: Array) -> Array:
        """F at a radius and a depth, whether that is the edge or the contact holds
        there.
        """
        return self.modulus * (
            self._area(a) + self.disc.width(a) * (depth - self.disc.profile(a))
        )

    def potential(self, a: Array, depth: Array) -> Array:
        """Elastic energy less the work of adhesion of the area in contact: its rate
        along d is the force.
        """
        over = depth - self.disc.profile(a)
        elastic = (
            self._energy(a) + self._area(a) * over + 0.5 * self.disc.width(a) * over**2
        )
        area = self.disc.width(a) if self.disc.kind == "cylinder" else np.pi * a**2
        return self.modulus * elastic - self.work * area

    def breaks(self, by_depth: bool) -> Limit:
        """Where the contact breaks when the depth, or the load, is lowered."""
        if self.disc.flat:
            a = xp.asarray(self.disc.shape.largest_contact)
        else:
            nowhere = np.zeros(())
            a = self._rising(lambda s, a: s._steepness(a, by_depth), nowhere, nowhere)
        return Limit(a, self.depth(a), self.force(a, self.depth(a)))

    def begins(self, by_depth: bool) -> Limit:
        """Where contact begins: at zero depth, or at zero load."""
        zero = np.zeros(())
        a = self.radius(by_depth, zero)
        depth = zero if by_depth or self.disc.flat else self.depth(a)
        return Limit(a, depth, self.force(a, depth))

    def radius(self, by_depth: bool, value: Array) -> Array:
        """Stable radius at a depth or load; that of the break where there is none."""
        end = self.breaks(by_depth)
        least, lowest = end.radius, end.depth if by_depth else end.force
        if self.disc.flat:
            return least + 0 * value
        # At the break itself the root is double, and rounding would move it by the
        # square root of what it is.
        above = value > lowest + _DOUBLE * abs(lowest)
        found = self._rising(
            lambda s, a: s.depth(a) if by_depth else s.force(a, s.depth(a)),
            value,
            least,
        )
        return xp.where(above, xp.maximum(found, least), least)

    def _rising(
        self, curve: Callable[[Sticky, Array], Array], value: Array, least: Array
    ) -> Array:
        """The largest a with curve(a) = value on a branch that rises with a: halvings
        of log a, and under JAX's transformations a Newton step.
        """
        fixed, goal, least = stop_gradient((self, xp.asarray(value), least))
        top = xp.log(xp.minimum(fixed.disc.largest, _WIDEST))
        low, high = bisect(
            lambda log_a: curve(fixed, xp.exp(log_a)) < goal,
            xp.broadcast_to(xp.log(xp.maximum(least, 1 / _WIDEST)), goal.shape),
            xp.broadcast_to(top, goal.shape),
            _HALVINGS,
        )
        a = xp.exp(0.5 * (low + high))
        if not is_traced(self, value):
            return a
        import jax

        now, slope = jax.jvp(lambda a: curve(self, a), (a,), (xp.ones_like(a),))
        step = (value - now) / stop_gradient(xp.where(slope > 0, slope, xp.inf))
        small = abs(stop_gradient(step)) < _CLOSE * a
        return a + xp.where(small, step, step - stop_gradient(step))

    def _steepness(self, a: Array, by_depth: bool) -> Array:
        """Of the sign of dd/da, or of dF/da along d = g(a) - delta(a)."""
        slope = self.disc.slope(a)
        if self.disc.kind == "half-space":
            return 2 * a * slope - (1 if by_depth else 3) * self.stretch(a)
        if by_depth:
            return slope
        return self.disc.width(a) / self.disc.weight(a) * slope - self.stretch(a)

    def _area(self, a: Array) -> Array:
        return 0 * a if self.disc.flat else self.disc.area(a)

    def _energy(self, a: Array) -> Array:
        return 0 * a if self.disc.flat else self.disc.energy(a)

    def cycle(self, depth: Array, load: Array, by_depth: Array) -> Elastic:
        """JKR over histories (n, m); the load rules where `by_depth` is False. Exact."""
        begins = self.begins(True), self.begins(False)
        breaks = self.breaks(True), self.breaks(False)
        a = xp.where(by_depth, self.radius(True, depth), self.radius(False, load))
        d = xp.where(by_depth, depth, self.depth(a))
        if self.disc.flat:
            d = xp.where(by_depth, depth, load / (self.modulus * self.disc.width(a)))
        force = xp.where(by_depth, self.force(a, d), load)
        value = xp.where(by_depth, depth, load)
        end = xp.where(by_depth, breaks[0].depth, breaks[1].force)
        # below that of the break by rounding only
        holds = value >= end - _ROUNDING * abs(end)
        phi = self.potential(a, d)
        begin, leave = (
            xp.where(by_depth, *(self.potential(e.radius, e.depth) for e in edges))
            for edges in (begins, breaks)
        )

        def step(carry: tuple, now: tuple) -> tuple:
            contact, before, work = carry
            phi, holds, touches, begin, leave = now
            after = touches | (contact & holds)
            lost = xp.where(contact, leave - before, 0.0)
            gained = xp.where(after, phi - xp.where(contact, before, begin), lost)
            return (after, phi, work + gained), (after, work + gained)

        rows = tuple(row.T for row in (phi, holds, value >= 0, begin, leave))
        start = xp.zeros(len(phi), bool), 0 * rows[0][0], 0 * rows[0][0]
        _, (contact, work) = scan(step, start, rows)
        contact, work = contact.T, work.T
        lost = ~contact & ~by_depth
        nothing = xp.where(lost, xp.nan, 0.0)
        found = Adhesive(
            depth=xp.where(lost, xp.nan, d),
            force=xp.where(contact, force, nothing),
            radius=xp.where(contact, a, nothing),
            work=xp.where(lost, xp.nan, work),
            stored=xp.where(contact, phi, nothing),
        )
        return Elastic(found, begins, breaks)


def tension(disc: Disc, work: Array | float, y: Array) -> Array:
    """T at an edge y: twice the work of adhesion of the area that opens, per length
    [J/m]; on springs per area.
    """
    return 2 * work * (np.pi * y if disc.kind == "half-space" else 1 + 0 * y)
