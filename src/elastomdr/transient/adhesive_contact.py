"""Adhesive contact (Johnson, Kendall & Roberts 1971) on the elements of the line: exact
for an elastic half-space.

An element at the edge lets go when the energy it gives back, E delta^2/2 per element
and side, is the work of adhesion of the area that opens: the edge is stretched by
delta(a) = sqrt(2 pi a gamma/E) on the half-space, sqrt(2 gamma/E) on a layer (Hess
2011; Popov & Hess 2015, ch. 4). So d = g(a) - delta(a) and F = E [A(a) - W(a)
delta(a)]. Of two radii at one depth, or load, the larger is stable; it ends where d, or
F, is least.

Viscoelastic: contact that has rested until relaxed, then moved, its edge receding only.
An element at the edge gives back at once what its glassy modulus allows, q^2/(2 E_0).
Each element carries q = E_inf (D - g), with one D for all: E_inf (D - d_0) = int E(t-s)
dd. So the edge is that of an elastic contact of modulus E_inf at the depth D whose work
of adhesion is gamma E_0/E_inf, as long as it is inside the radius of rest. This is a
rule, not a theorem: no process zone at the edge, no renewed adhesion.
"""

from typing import Any, NamedTuple

import jax
import jax.numpy as jnp

from ..checks import Array
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1, phi2
from ..numerics.root import bisect
from ..surface.disc import Disc
from ..surface.shapes import FlatPunch

_HALVINGS = 80
_WIDEST = 1e100  # contact [m]
_ROUNDING = 1e-12
_DOUBLE = 1e-14


class Adhesive(NamedTuple):
    """An adhesive contact at m instants; NaN where a load is not carried any more."""

    depth: Array
    force: Array
    radius: Array
    work: Array
    stored: Array  # elastic energy less the work of adhesion of the area in contact [J]


class Edge(NamedTuple):
    """Radius, depth and force at which an adhesive contact breaks."""

    radius: Array
    depth: Array
    force: Array


class Sticky(NamedTuple):
    """An elastic contact with a work of adhesion."""

    disc: Disc
    modulus: Array  # E [Pa; layer Pa/m]
    gamma: Array  # [J/m^2]

    def stretch(self, a: Array) -> Array:
        """delta(a)."""
        if self.disc.kind == "half-space":
            return jnp.sqrt(2 * jnp.pi * a * self.gamma / self.modulus)
        return jnp.sqrt(2 * self.gamma / self.modulus) + 0 * a

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
        area = self.disc.width(a) if self.disc.kind == "cylinder" else jnp.pi * a**2
        return self.modulus * elastic - self.gamma * area

    def breaks(self, control: str) -> Edge:
        """Where the contact breaks when the depth, or the load, is lowered."""
        if isinstance(self.disc.shape, FlatPunch):
            a = jnp.asarray(self.disc.shape.radius)
        else:
            a = _rising(
                lambda s, a: s._steepness(a, control),
                self,
                jnp.zeros(()),
                jnp.zeros(()),
            )
        return Edge(a, self.depth(a), self.force(a, self.depth(a)))

    def radius(self, control: str, value: Array) -> Array:
        """Stable radius at a depth or load; that of the break where there is none."""
        end = self.breaks(control)
        least, lowest = end.radius, end.depth if control == "depth" else end.force
        if isinstance(self.disc.shape, FlatPunch):
            return least + 0 * value

        def controlled(s: "Sticky", a: Array) -> Array:
            return s.depth(a) if control == "depth" else s.force(a, s.depth(a))

        # At the break itself the root is double, and rounding would move it by the
        # square root of what it is.
        above = value > lowest + _DOUBLE * jnp.abs(lowest)
        return jnp.where(
            above, jnp.maximum(_rising(controlled, self, value, least), least), least
        )

    def _steepness(self, a: Array, control: str) -> Array:
        """Of the sign of dd/da, or of dF/da along d = g(a) - delta(a)."""
        slope, on_half_space = self.disc.slope(a), self.disc.kind == "half-space"
        if control == "depth":
            return 2 * a * slope - self.stretch(a) if on_half_space else slope
        ratio = self.disc.width(a) / self.disc.weight(a)
        return (
            (2 * a * slope - 3 * self.stretch(a))
            if on_half_space
            else ratio * slope - self.stretch(a)
        )

    def _area(self, a: Array) -> Array:
        return 0 * a if self.disc.flat else self.disc.area(a)

    def _energy(self, a: Array) -> Array:
        return 0 * a if self.disc.flat else self.disc.energy(a)


@jax.jit
def elastic(sticky: Sticky, depth: Array, load: Array, by_depth: Array) -> Adhesive:
    """JKR for an elastic foundation, m instants; the load rules where `by_depth` is
    False. Exact.
    """
    sticky = jax.tree.map(jnp.asarray, sticky)
    control = by_depth
    ends = {name: sticky.breaks(name) for name in ("depth", "load")}
    a = jnp.where(control, sticky.radius("depth", depth), sticky.radius("load", load))
    d = jnp.where(control, depth, sticky.depth(a))
    if sticky.disc.flat:
        d = jnp.where(control, depth, load / (sticky.modulus * sticky.disc.width(a)))
    force = jnp.where(control, sticky.force(a, d), load)
    holds = jnp.where(
        control,
        _reaches(depth, ends["depth"].depth),
        _reaches(load, ends["load"].force),
    )
    touches = jnp.where(control, depth >= 0, load >= 0)
    # First touch: at zero depth, or at zero load.
    zero = jnp.zeros(())
    first = {}
    for name in ("depth", "load"):
        r = sticky.radius(name, zero)
        first[name] = sticky.potential(
            r, zero if name == "depth" or sticky.disc.flat else sticky.depth(r)
        )
    begin = jnp.where(control, first["depth"], first["load"])
    leave = jnp.where(
        control,
        sticky.potential(ends["depth"].radius, ends["depth"].depth),
        sticky.potential(ends["load"].radius, ends["load"].depth),
    )
    phi = sticky.potential(a, d)

    def step(carry: tuple, now: tuple) -> tuple:
        contact, before, work = carry
        phi, holds, touches, begin, leave = now
        after = touches | (contact & holds)
        gained = jnp.where(
            after,
            phi - jnp.where(contact, before, begin),
            jnp.where(contact, leave - before, 0.0),
        )
        return (after, phi, work + gained), (after, work + gained)

    start = (jnp.asarray(False), zero, zero)
    _, (contact, work) = jax.lax.scan(step, start, (phi, holds, touches, begin, leave))
    lost = ~contact & ~control
    nothing = jnp.where(lost, jnp.nan, 0.0)
    return Adhesive(
        depth=jnp.where(lost, jnp.nan, d),
        force=jnp.where(contact, force, nothing),
        radius=jnp.where(contact, a, nothing),
        work=jnp.where(lost, jnp.nan, work),
        stored=jnp.where(contact, phi, nothing),
    )


@jax.jit
def receding(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    gamma: Array,
    time: Array,
    depth: Array,
    load: Array,
    by_depth: Array,
) -> Adhesive:
    """The viscoelastic rule: relaxed at the first instant, receding from there. Work
    and energy are not computed.

    NaN where the contact would grow beyond what it was at rest, since new adhesion is
    not part of the rule, and from where a load is not carried any more.
    """
    law, modes, disc = jax.tree.map(jnp.asarray, (law, modes, disc))
    rest = Sticky(disc, law.equilibrium, jnp.asarray(gamma))
    bond = rest._replace(
        gamma=gamma * (law.equilibrium + jnp.sum(law.moduli)) / law.equilibrium
    )
    a0 = jnp.where(
        by_depth[0], rest.radius("depth", depth[0]), rest.radius("load", load[0])
    )
    ends = bond.breaks("depth"), bond.breaks("load")
    holds = jnp.where(
        by_depth[0],
        _reaches(depth[0], rest.breaks("depth").depth),
        _reaches(load[0], rest.breaks("load").force),
    )
    d0 = jnp.where(by_depth[0], depth[0], _depth_under(rest, a0, load[0]))
    # a depth is larger beyond rounding
    size = 1e-9 * (jnp.abs(d0) + rest.stretch(a0))
    begin = _Begin(a0, d0, size)

    def step(state: _Receding, now: tuple) -> tuple[_Receding, tuple]:
        return _recede(law, modes, bond, ends, begin, state, now)

    none = jnp.zeros_like(law.times), jnp.zeros_like(modes.rate)
    start = _Receding(a0, d0, d0, holds, *none)
    _, (d, force, a, known, grows) = jax.lax.scan(
        step, start, (jnp.diff(time), depth[1:], load[1:], by_depth[1:])
    )
    first = (d0, jnp.where(by_depth[0], rest.force(a0, d0), load[0]), a0)
    known = jnp.append(holds, holds & known & ~(jnp.cumsum(grows) > 0))
    nan = jnp.full(time.shape, jnp.nan)
    d, force, a = (
        jnp.where(known, jnp.append(one, many), jnp.nan)
        for one, many in zip(first, (d, force, a), strict=True)
    )
    return Adhesive(d, force, a, nan, nan)


class _Begin(NamedTuple):
    """The contact at rest."""

    radius: Array
    depth: Array
    size: Array  # change of a depth that is more than rounding


class _Receding(NamedTuple):
    """A contact that recedes, at the end of a step."""

    radius: Array
    depth: Array
    sunk: Array  # D
    held: Array  # whether it has not broken
    f: Array  # branches of the half-space
    z: Array  # Kelvin modes under E_inf (D - d_0)


def _recede(
    law: Relaxation,
    modes: Modes,
    bond: Sticky,
    ends: tuple[Edge, Edge],
    begin: _Begin,
    state: _Receding,
    now: tuple[Array, Array, Array, Array],
) -> tuple[_Receding, tuple]:
    """One step of depth or load, and (depth, force, radius, whether they are known,
    whether the contact would grow).
    """
    h, depth, load, control = now
    a, d, held = state.radius, state.depth, state.held
    x, y = h * modes.rate, h / law.times
    ramp = law.moduli * phi1(y)
    # D by the motion where the depth rules, by the load at the radius found where that
    # does.
    moved = depth + (
        jnp.sum(jnp.exp(-y) * state.f + ramp * (depth - d)) / law.equilibrium
    )
    depth_if_held = jnp.where(control, moved, _depth_under(bond, a, load))
    stays = depth_if_held >= bond.depth(a)
    stable = jnp.where(
        control, _reaches(moved, ends[0].depth), _reaches(load, ends[1].force)
    )
    wide = a >= jnp.where(control, ends[0].radius, ends[1].radius)
    held = held & (stays | (stable & wide))
    edge = jnp.where(control, bond.radius("depth", moved), bond.radius("load", load))
    a_new = jnp.where(stays, a, jnp.minimum(a, edge))
    new = jnp.where(control, moved, _depth_under(bond, a_new, load))
    before = law.equilibrium * (state.sunk - begin.depth)
    after = law.equilibrium * (new - begin.depth)
    z = jnp.exp(-x) * state.z + modes.gain * h * (
        before * phi1(x) + (after - before) * phi2(x)
    )
    crept = begin.depth + modes.instantaneous * after + jnp.sum(z)
    d_new = jnp.where(control, depth, crept)
    f = jnp.exp(-y) * state.f + ramp * (d_new - d)
    grows = (d_new > begin.depth + begin.size) | (
        (a_new < begin.radius) & (d_new > d + begin.size)
    )
    force = jnp.where(control, bond.force(a_new, moved), load)
    seen = (
        d_new,
        jnp.where(held, force, 0.0),
        jnp.where(held, a_new, 0.0),
        control | held,
        grows & held,
    )
    return _Receding(a_new, d_new, new, held, f, z), seen


def _reaches(value: Array, end: Array) -> Array:
    """Whether a depth or load is not below that of the break, or below it by rounding
    only.
    """
    return value >= end - _ROUNDING * jnp.abs(end)


def _depth_under(sticky: Sticky, a: Array, load: Array) -> Array:
    """The depth at which a contact held at radius a carries a load."""
    return sticky.disc.profile(a) + (
        load / sticky.modulus - sticky._area(a)
    ) / sticky.disc.width(a)


def _rising(curve: Any, sticky: Sticky, value: Array, least: Array) -> Array:
    """The largest a with curve(a) = value on a branch that rises with a: halvings of
    log a, then a Newton step.
    """
    fixed, goal, least = jax.lax.stop_gradient((sticky, jnp.asarray(value), least))
    top = jnp.log(jnp.minimum(fixed.disc.largest, _WIDEST))
    low = jnp.broadcast_to(jnp.log(jnp.maximum(least, 1 / _WIDEST)), goal.shape)

    low, high = bisect(
        lambda log_a: curve(fixed, jnp.exp(log_a)) < goal,
        low,
        jnp.broadcast_to(top, goal.shape),
        _HALVINGS,
    )
    a = jnp.exp(0.5 * (low + high))
    now, slope = jax.jvp(lambda a: curve(sticky, a), (a,), (jnp.ones_like(a),))
    step = (value - now) / jax.lax.stop_gradient(jnp.where(slope > 0, slope, jnp.inf))
    return a + jnp.where(
        jnp.abs(jax.lax.stop_gradient(step)) < 1e-3 * a,
        step,
        step - jax.lax.stop_gradient(step),
    )
