"""Normal and friction force in steady sliding, with the contact edges where they were
put.

Every element sees the same history, so with E(t) the foundation's relaxation function,
v the velocity, contact from x = -b to x = a, and r the distance between two elements of
the contact (r = v times the time between their entries),

    q(-b) = int E(r/v) g'(r - b) dr                      line force density at the trailing edge
    F_N   = int E(r/v) [g(a) - g(r - b)] dr              normal force
    F_x   = int E(r/v) C(r) dr                           friction force,    r from 0 to a + b

with C(r) = int_{-b}^{a-r} g'(x) g'(x + r) dx. A dashpot eta adds eta v g'(-b), eta v
[g(a) - g(b)] and eta v C(0). What a branch adds to them follows from its `memory` at
both edges; see there. Axes: (variants,) lines, branches, points.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import stop_gradient, xp
from ..checks import Array
from ..element.episode import Modes
from .memory import Passage, direct, memory

if TYPE_CHECKING:
    from jaxtyping import Float

_NOTHING = 1e-13  # of a difference, over what it is the difference of
_ROUNDING = float(np.finfo(np.float64).eps)
# relative, over which the slope at the trailing edge changes by a known amount
_TILT = 1e-5
# slope and force density are sampled alike, and either misses as much once more
_UNSEEN = 3.0


def exit_density(p: Passage, size: Array, ratio: Array) -> Float[Array, "lines points"]:
    """Line force density q(-b) at the trailing edges b = ratio times entry."""
    return _Contact(p, size, ratio).density()[0]


def balance(
    p: Passage, size: Array, ratio: Array
) -> tuple[Float[Array, "lines points"], Float[Array, " points"]]:
    """`exit_density` and the normal force [N]: the two equations of a passage, at the
    cost of one.
    """
    contact = _Contact(p, size, ratio)
    return contact.density()[0], xp.sum(
        p.lines.weight(size) * contact.force()[0], axis=0
    )


class Slopes(NamedTuple):
    """Both equations of a passage on a single line, and their derivatives by its edges
    a and b, (1, points).
    """

    density: Array  # q(-b)
    force: Array  # F_N, without the weight of the line
    density_entry: Array  # dq/da
    density_exit: Array  # dq/db
    force_entry: Array  # dF_N/da; dF_N/db = q(-b)


def balance_and_slopes(p: Passage, size: Array, ratio: Array) -> Slopes:
    """`balance` of a line whose profile does not depend on the size of the contact,
    with derivatives in closed form.

    dq/da = E(L/v) g'(a),  dF_N/da = g'(a) int E dr,  dq/db = -E(0) g'(b) + int dE/dr
    g'(r - b) dr, by parts, L = a + b. A dashpot adds -eta v g''(b) to the last one,
    here by a difference: enough for a search.
    """
    contact = _Contact(p, size, ratio)
    law, length, gone = p.law, contact.entry + contact.exit, contact.gone()
    left = law.equilibrium + law.moduli.sum() - law.moduli @ gone  # E(L/v)
    # int E dr
    passed = law.equilibrium * length + p.velocity * ((law.moduli * law.times) @ gone)
    steep, at_exit = contact.steep, contact.at_exit
    glassy = (law.equilibrium + law.moduli.sum()) * at_exit
    falling = -glassy - (law.moduli / law.times) @ contact.kept()[0] / p.velocity
    # Of a liquid that forgets at once nothing is left but rounding, on which a search
    # would believe to have arrived.
    falling = xp.where(xp.abs(falling) > _NOTHING * xp.abs(glassy), falling, 0.0)
    drag = p.velocity * law.viscosity
    bent = 0.0
    if np.ndim(drag) and xp.any(drag > 0):
        bent = (contact.slope(contact.exit * (1 - _TILT)) - at_exit) / (
            _TILT * contact.exit
        )
    return Slopes(
        density=contact.density()[0],
        force=contact.force()[0],
        density_entry=left * steep,
        density_exit=falling + drag * bent,
        force_entry=steep * (passed + drag),
    )


def part_of_contact(
    p: Passage, size: Array, trailing: Float[Array, " points"]
) -> tuple[Array, Array, Array]:
    """q(-b) of a single line at any place -b of the contact, the force Q = int q dx [N]
    from there to the leading edge, and its sampling error.
    """
    law = p.law
    kept, lost, way = direct(p, size, trailing)
    drag = p.velocity * law.viscosity
    line = xp.zeros((1, 1), int)
    slope = xp.sign(trailing) * p.lines.slope(xp.abs(trailing)[None], size, line)
    rise = p.lines.profile(p.lines.entry(size), size, line) - p.lines.profile(
        xp.abs(trailing)[None], size, line
    )
    density = (
        law.equilibrium * rise
        + xp.sum(law.moduli[:, None] * kept[0], axis=-2)
        - drag * slope
    )
    force = (
        law.equilibrium * way
        + xp.sum(law.moduli[:, None] * p.decay * lost, axis=-2)
        + drag * rise
    )
    return density[0], *_total(p, size, force, 0.0)


def normal_force(p: Passage, size: Array, ratio: Array) -> Float[Array, " points"]:
    """Normal force [N], of all lines."""
    return xp.sum(p.lines.weight(size) * _Contact(p, size, ratio).force()[0], axis=0)


def friction_force(p: Passage, size: Array, ratio: Array) -> Float[Array, " points"]:
    """Friction force [N], of all lines; its error is not estimated."""
    return xp.sum(
        p.lines.weight(size) * _Contact(p, size, ratio, full=True).drag()[0], axis=0
    )


class Forces(NamedTuple):
    """Both forces of all lines [N], and their estimated sampling errors."""

    normal: Float[Array, " points"]
    normal_error: Float[Array, " points"]
    friction: Float[Array, " points"]
    friction_error: Float[Array, " points"]


def forces(p: Passage, size: Array, ratio: Array) -> Forces:
    """Normal and friction force; `p` is tabulated in full."""
    contact = _Contact(p, size, ratio, full=True)
    return Forces(
        *_total(p, size, contact.force(), 0.0),
        *_total(p, size, contact.drag(), contact.blur()),
    )


def branch_losses(
    p: Passage, modes: Modes, size: Array, ratio: Array
) -> tuple[Float[Array, " points"], Float[Array, "branches points"]]:
    """What the parallel dashpot and each branch turn into heat, per length of way [N],
    all lines together.

    With y_k the displacement of a branch's dashpot, at the trailing edge Y_k = int (1 -
    e^{-r/s_k}) g'(r-b) dr, and u_b = g(a) - g(b), the work on a branch less what it
    holds at the edge is

        E_k int e^{-r/s_k} C dr - E_k (u_b - Y_k)^2/2
        = E_k [u_b Y_k - int (1 - e^{-r/s_k}) C dr - Y_k^2/2],

    the first for fast branches, the second for slow ones, each without cancellation.
    What all springs hold at the edge is lost in free recovery, where y_k = sum_j Y_jk
    m_j e^{-t/lambda_j}: E_k tau_k int y_k'^2 dt in closed form. Exact where the
    sampling is; their sum is the friction force. Derived here.
    """
    contact = _Contact(p, size, ratio, full=True)
    slow, left = contact.slow, contact.rise[:, None]
    kept, gone = (x[0] for x in contact.worked())
    force, lag = contact.kept()[0], contact.lost()[0]
    inside = p.law.moduli[:, None] * xp.where(
        slow, left * lag - gone - 0.5 * lag**2, kept - 0.5 * force**2
    )
    friction = p.law.moduli * p.law.times
    present = modes.gain > 0
    share = xp.where(present, 1 / xp.where(present, modes.norm, 1.0), 0.0)
    m = xp.einsum(
        "jk,k,lkp->ljp", modes.shape, friction, xp.where(slow, lag, left - force)
    )
    m = share[:, None] * (m + p.law.viscosity * left)
    rates = modes.rate[:, None] + modes.rate
    decay = modes.rate[:, None] * modes.rate / xp.where(rates > 0, rates, 1.0)
    after = xp.einsum(
        "k,ik,jk,ij,lip,ljp->lkp",
        friction,
        modes.shape,
        modes.shape,
        decay,
        m,
        m,
        optimize="greedy",
    )
    dashpot = p.velocity * contact.square()[0]
    dashpot = p.law.viscosity * (
        dashpot + xp.einsum("ij,lip,ljp->lp", decay, m, m, optimize="greedy")
    )
    weight = p.lines.weight(size)
    return xp.sum(weight * dashpot, axis=0), xp.sum(
        weight[:, None] * (inside + after), axis=0
    )


def _total(
    p: Passage,
    size: Array,
    force: Float[Array, "variants lines points"],
    blur: Array | float,
):
    """Sum of all lines, and the error of that sum: of sampling along the lines, and of
    their finite number.
    """
    weight = p.lines.weight(size)
    parts = weight * force[0]
    missed = xp.zeros_like(force[0]) + blur
    if force.shape[0] > 1:
        change = xp.abs(force[1:] - force[0])
        missed = missed + p.rule.safety * change[0] + _UNSEEN * change[1]
    error = xp.sum(weight * missed, axis=0) + p.lines.summation_error(parts)
    return xp.sum(parts, axis=0), stop_gradient(error)


class _Contact:
    """What a stretch of contact adds up to, from the memory at its two edges."""

    def __init__(self, p: Passage, size: Array, ratio: Array, full: bool = False):
        self.p, self.size, self.line = p, size, xp.arange(p.lines.count)[:, None]
        self.entry, self.decay = p.lines.entry(size), p.decay
        self.exit = ratio * self.entry
        self.places = xp.stack([self.entry, self.exit])
        self.high, self.low = p.lines.profile(self.places, size, self.line)
        self.steep, self.at_exit = self.slope(self.places)
        both = memory(p, size, self.places, full)
        self.ahead, self.behind = (both.each(lambda x, i=i: x[i]) for i in (0, 1))
        self.fading = -self.exit[:, None] / self.decay
        self.force_of_branch = xp.exp(self.fading) * self.ahead.near - self.behind.far

    def slope(self, x: Array) -> Array:
        return self.p.lines.slope(x, self.size, self.line)

    @functools.cached_property
    def rise(self) -> Float[Array, "lines points"]:
        """Indentation left at the trailing edge, g(a) - g(b)."""
        return self.high - self.low

    @functools.cached_property
    def slow(self) -> Array:
        """Which branches are slower than the passage."""
        return self.decay > (self.entry + self.exit)[:, None]

    def gone(self) -> Float[Array, "lines branches points"]:
        """1 - e^{-(a + b)/s}."""
        return -xp.expm1(-(self.entry + self.exit)[:, None] / self.decay)

    def kept(self) -> Float[Array, "variants lines branches points"]:
        """int e^{-r/s} g'(r - b) dr: at the trailing edge, the force in a branch over
        its modulus.
        """
        return self.force_of_branch

    def lost(self) -> Float[Array, "variants lines branches points"]:
        """int (1 - e^{-r/s}) g'(r - b) dr: the displacement of its dashpot."""
        return (
            self.ahead.near_lost
            - xp.expm1(self.fading) * self.ahead.near
            - self.behind.far_lost
        )

    def moment(self) -> Float[Array, "variants lines points"]:
        """int x g'(x) dx."""
        return (self.ahead.moment + self.behind.moment)[..., 0, :]

    def worked(self) -> tuple[Array, Array]:
        """int e^{-r/s} C dr and int (1 - e^{-r/s}) C dr."""
        a, b = self.ahead, self.behind
        high, low = self.high[:, None], self.low[:, None]
        gone = (
            a.work_lost
            + b.work_lost
            - high * b.near_lost
            - low * a.near_lost
            + a.near_lost * b.near_lost
        )
        return a.work + b.work - a.near * b.near, gone

    def square(self) -> Float[Array, "variants lines points"]:
        """C(0) = int g'^2 dx."""
        return (self.ahead.square + self.behind.square)[..., 0, :]

    def density(self) -> Float[Array, "variants lines points"]:
        law = self.p.law
        density = _over_branches(law.moduli, self.kept()) + law.equilibrium * self.rise
        return density - self.p.velocity * law.viscosity * self.at_exit

    def force(self) -> Float[Array, "variants lines points"]:
        """F_N without the weight of the lines: int v_k dx = s_k y_k, since s v_k' = v_k
        - s g'.
        """
        law, rise = self.p.law, self.rise
        elastic = self.exit * rise + self.moment()
        force = (
            self.p.velocity * _over_branches(law.moduli * law.times, self.lost())
            + law.equilibrium * elastic
        )
        return force + self.p.velocity * law.viscosity * rise

    def drag(self) -> Float[Array, "variants lines points"]:
        """F_x without the weight of the lines.

        Branches slower than the passage are nearly springs. Their integral is taken of
        1 - exp(-r/s), beside the exact int C dr = [g(a) - g(b)]^2/2, so that a loss of
        1e-20 of the stored energy keeps its digits.
        """
        law, slow = self.p.law, self.slow
        kept, gone = self.worked()
        total = _over_branches(law.moduli, xp.where(slow, -gone, kept))
        return (
            0.5 * self._springs * self.rise**2
            + self.p.velocity * law.viscosity * self.square()
            + total
        )

    def blur(self) -> Float[Array, "lines points"]:
        """Of a loss below 1e-30 of the stored energy nothing is left but how the
        trailing edge was rounded.
        """
        blur = 4 * _ROUNDING * xp.abs(self.at_exit) * self.entry
        return self._springs * blur * (xp.abs(self.rise) + blur)

    @functools.cached_property
    def _springs(self) -> Array:
        """Modulus of the equilibrium spring and of the branches that are nearly
        springs.
        """
        slow = xp.where(self.slow, self.p.law.moduli[:, None], 0.0)
        return self.p.law.equilibrium + xp.sum(slow, axis=-2)


def _over_branches(
    weights: Array, terms: Float[Array, "*n branches points"]
) -> Float[Array, "*n points"]:
    """Sum over the branches, weighted."""
    return weights @ terms
