"""Load-controlled indentation while the contact grows: exact, in closed form (Lee &
Radok 1960).

Every element that is in contact has been so since it was first touched, so that F(t) =
int E(t-s) dA(d(s)) and, turned round, A(d(t)) = int J(t-s) dF(s), with A(d) the force
of an elastic contact of unit modulus. For a load that is linear between instants this
is a sum of exponentials of the Kelvin chain. It holds until the contact shrinks for the
first time, that is, while A has not fallen. Elements of a flat punch all share one
history, and an elastic contact has none; for them it holds always.

Energies: the work is int F dd. A branch stores E_k P_k/2 with P_k = int weight
(f_k/E_k)^2 dx, which obeys P_k' = -2 P_k/tau_k + 2 B_k d', B_k = int weight f_k/E_k dx
being the branch's share of A (derived here, by differentiating under the integral).
d(t) is no sum of exponentials; both are integrated by Gauss' rule on panels that narrow
towards both ends of each interval, as far as the shortest time of the spectrum needs
it.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import arrays, compiled, scan, xp
from ..checks import Array
from ..element.episode import Modes
from ..material.relaxation import Relaxation
from ..numerics.decay import phi1, phi2
from ..numerics.quadrature import gauss_on_panels
from ..surface.disc import Disc

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_NODES = 6  # Gauss points per panel
_RATIO = 4.0  # of neighbouring panels
_ROUNDING = 1e-12  # of A, below which a fall of it is rounding


class Creep(NamedTuple):
    """A history of growing contact at m instants."""

    depth: Float[Array, " m"]
    radius: Float[Array, " m"]
    work: Float[Array, " m"]  # int F dd [J]
    stored: Float[Array, " m"]  # elastic energy of the elements [J]
    heat: Float[Array, " m"]  # of branches and dashpot [J]
    growing: Bool[Array, " m"]  # whether it holds up to this instant


class _Inside(NamedTuple):
    """The history at nodes inside the intervals, (interval, node)."""

    s: Float[Array, " n"]  # place, of 1
    ds: Float[Array, " n"]
    load: Array  # [N]
    area: Array  # A
    rate: Array  # of A, per interval
    share: Array  # B_k, (interval, node, branch)


@compiled("levels")
def creep(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: Float[Array, " m"],  # ascending [s]
    load: Float[Array, " m"],  # linear in between; load[0] is a step at time[0] [N]
    *,
    levels: int,
) -> Creep:
    """Depth, contact radius and energies under a load, exact while the contact grows;
    NaN where no contact can carry it. `levels` as from `levels_for`.
    """
    law, modes, disc = arrays((law, modes, disc))
    h, rise = xp.diff(time), xp.diff(load)
    y = h[:, None] * modes.rate
    gain = (
        modes.gain * h[:, None] * (load[:-1, None] * phi1(y) + rise[:, None] * phi2(y))
    )
    _, z = scan(_relaxed, xp.zeros_like(modes.rate), (xp.exp(-y), gain))
    # retarded part of A, per mode
    z = xp.concatenate([xp.zeros((1, modes.rate.size)), z])
    area = modes.instantaneous * load + xp.sum(z, axis=1)
    depth, radius = disc.depth_of_area(area), disc.radius_of_area(area)
    inside = _inside(modes, h, load, z, levels)
    growing = xp.all(inside.rate >= -_ROUNDING * xp.abs(inside.area), axis=1) & (
        area[1:] >= area[:-1] * (1 - _ROUNDING)
    )
    elastic = (xp.sum(law.moduli) == 0) & (law.viscosity == 0)
    holds = (xp.cumprod(growing) > 0) | disc.flat | elastic
    growing = xp.concatenate([xp.ones(1, bool), holds])
    work, stored, heat = _energies(law, modes, disc, h, radius, depth, inside)
    return Creep(depth, radius, work, stored, heat, growing)


def _relaxed(z: Array, step: tuple[Array, Array]) -> tuple[Array, Array]:
    """What is left of z after a step, and what is gained."""
    z = step[0] * z + step[1]
    return z, z


def _inside(modes: Modes, h: Array, load: Array, z: Array, levels: int) -> _Inside:
    s, ds = _panels(levels)
    rise = xp.diff(load)
    inner = h[:, None, None] * modes.rate * s[:, None]  # (interval, node, mode)
    ramp = h[:, None] * s
    force = load[:-1, None] + rise[:, None] * s
    z = xp.exp(-inner) * z[:-1, None] + ramp[..., None] * modes.gain * (
        load[:-1, None, None] * phi1(inner)
        + (force - load[:-1, None])[..., None] * phi2(inner)
    )
    area = modes.instantaneous * force + xp.sum(z, axis=-1)
    rate = modes.instantaneous * rise[:, None] + h[:, None] * xp.sum(
        modes.gain * force[..., None] - modes.rate * z, axis=-1
    )
    return _Inside(s, ds, force, area, rate, area[..., None] - z @ modes.shape)


def _energies(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    h: Array,
    radius: Array,
    depth: Array,
    inside: _Inside,
) -> tuple[Array, Array, Array]:
    """Work, elastic energy and heat at every instant."""
    s, ds = inside.s, inside.ds
    flat = disc.width(xp.asarray(disc.shape.largest_contact)) if disc.flat else None
    width = disc.width(disc.radius_of_area(inside.area)) if flat is None else flat
    if flat is None:
        safe = xp.where(width > 0, width, 1.0)
        depth_rate = xp.where(width > 0, inside.rate / safe, 0.0)
    else:
        depth_rate = inside.rate / flat
    # At the first instant the contact is elastic and glassy; a parallel dashpot lets
    # nothing happen there.
    start = _elastic(disc, radius[0], depth[0])
    glassy = xp.where(
        modes.instantaneous > 0, law.equilibrium + xp.sum(law.moduli), 0.0
    )
    work = xp.append(glassy * start, xp.sum(ds * inside.load * depth_rate, axis=1))
    fading = xp.exp(-2 * h[:, None, None] * (1 - s)[:, None] / law.times)
    into = inside.share * depth_rate[..., None]
    gained = xp.sum(2 * ds[:, None] * fading * into, axis=1)
    first = xp.broadcast_to(2 * start, law.times.shape)
    left = xp.exp(-2 * h[:, None] / law.times)
    _, squares = scan(_relaxed, first, (left, gained))
    squares = xp.concatenate([first[None], squares])
    stored = (
        law.equilibrium * _elastic(disc, radius, depth) + 0.5 * squares @ law.moduli
    )
    # What goes into each branch, less what it holds; what goes into the dashpot, whose
    # force is eta d' over the width.
    given = xp.concatenate([0.5 * first[None], xp.sum(ds[:, None] * into, axis=1)])
    spread = xp.cumsum(given, axis=0) - 0.5 * squares
    damped = xp.sum(ds * width * depth_rate**2, axis=1) / h
    heat = spread @ law.moduli + law.viscosity * xp.append(0.0, xp.cumsum(damped))
    return xp.cumsum(work), stored, heat


def levels_for(law: Relaxation, modes: Modes, time: Array) -> int:
    """How many times the panels narrow, so that they see the shortest time of the
    spectrum in every interval.
    """
    times = [
        np.asarray(law.times),
        1 / np.asarray(modes.rate)[np.asarray(modes.rate) > 0],
    ]
    shortest = min((float(t.min()) for t in times if t.size), default=math.inf)
    longest = float(np.diff(time).max(initial=0.0))
    # A dashpot lets a load sink in from nothing, d ~ t^(2/3), and its heat begins with
    # t^(-1/3).
    least = 22 if np.asarray(law.viscosity) > 0 else 3
    if not 0 < longest / shortest < math.inf:
        return least
    return min(max(least, 1 + math.ceil(math.log(longest / shortest, _RATIO))), 30)


def _elastic(disc: Disc, radius: Array, depth: Array) -> Array:
    """V: what an elastic contact of unit modulus stores."""
    if disc.flat:
        return 0.5 * disc.width(xp.asarray(disc.shape.largest_contact)) * depth**2
    return disc.energy(radius)


@functools.cache
def _panels(levels: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on [0, 1], panels narrowing towards both ends."""
    left = np.concatenate([[0.0], 0.5 * _RATIO ** -np.arange(levels, -1.0, -1)])
    edges = np.concatenate([left, 1 - left[-2::-1]])
    return gauss_on_panels(edges, _NODES)
