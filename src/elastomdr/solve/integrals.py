"""Normal and friction force in steady sliding, with the contact edges where they were put.

Every element sees the same history, so with E(t) the foundation's relaxation function, v the velocity, contact from x
= -b to x = a, and r the distance between two elements of the contact (r = v times the time between their entries),

    q(-b) = int E(r/v) g'(r - b) dr                      line force density at the trailing edge
    F_N   = int E(r/v) [g(a) - g(r - b)] dr              normal force
    F_x   = int E(r/v) C(r) dr                           friction force,    r from 0 to a + b

with C(r) = int_{-b}^{a-r} g'(x) g'(x + r) dx, the autocorrelation of the slope, which knows nothing of the material. A
dashpot eta adds eta v g'(-b), eta v [g(a) - g(b)] and eta v C(0). `foundation.moments` makes the integrals exact in the
branches. Axes of all arrays: lines, panels, samples or branches, points.
"""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jaxtyping import Float

from .._runtime import Array
from ..foundation.modes import Modes
from ..foundation.moments import contract
from ..foundation.step import phi1
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .rule import Rule, gauss

_UNSEEN = 3.0  # the autocorrelation is sampled as the integrals are, and misses as much once more on either factor


class Passage(NamedTuple):
    """What is the same for all integrals of one call."""

    law: Relaxation
    lines: AbstractLines
    rule: Rule
    velocity: Float[Array, " points"]


def exit_density(p: Passage, size: Array, ratio: Array) -> Float[Array, "lines points"]:
    """Line force density q(-b) at the trailing edges b = ratio times entry."""
    span = _Span(p, size, ratio)
    return _integrate(p, span, span.slope_samples())[0] + span.dashpot_density()


def normal_force(p: Passage, size: Array, ratio: Array) -> tuple[Float[Array, " points"], Float[Array, " points"]]:
    """Normal force [N] of all lines, and its estimated sampling error."""
    span = _Span(p, size, ratio)
    force, tail = _integrate(p, span, span.indentation_samples())
    return _total(p, size, force + span.dashpot_force(), tail)


def balance(p: Passage, size: Array, ratio: Array) -> tuple[Float[Array, "lines points"], Float[Array, " points"]]:
    """`exit_density` and `normal_force` together: the two equations of a passage, at the cost of one."""
    span = _Span(p, size, ratio)
    both = jnp.stack([span.slope_samples(), span.indentation_samples()])
    density, force = _integrate(p, span, both)[0]
    force = jnp.sum(p.lines.weight(size) * (force + span.dashpot_force()), axis=0)
    return density + span.dashpot_density(), force


def friction_force(p: Passage, size: Array, ratio: Array) -> tuple[Float[Array, " points"], Float[Array, " points"]]:
    """Friction force [N] of all lines, and its estimated sampling error.

    Branches slower than the passage are nearly springs. Their integral is taken of 1 - exp(-r/s), beside the exact
    int C dr = [g(a) - g(b)]^2/2, so that a loss of 1e-20 of the stored energy keeps its digits.
    """
    span = _Span(p, size, ratio)
    correlation = _autocorrelation(p, size, span.entry, span.exit)
    samples = correlation(span.positions(jnp.zeros_like(span.exit)))
    moduli = p.law.moduli[:, None]
    kept, gone, slow = _memories(p, span, samples)
    total = jnp.sum(moduli * jnp.where(slow, -gone, kept), axis=1)
    tail = jnp.zeros_like(total)
    if not p.rule.exact:
        decay = p.velocity * p.law.times[:, None]
        before, z = moduli * jnp.exp(-span.start / decay), span.width / decay
        slowed = -moduli * jnp.expm1(-(span.start + span.width) / decay)
        felt = jnp.where(slow[:, None], slowed, before * phi1(z))
        tail = _tail(p, before, span.width * _legendre(p.rule, samples), z, jnp.sum(felt, axis=-2, keepdims=True))
    springs = p.law.equilibrium + jnp.sum(jnp.where(slow, moduli, 0.0), axis=1)
    dashpot = p.velocity * p.law.viscosity * correlation(jnp.zeros_like(_spread(span.exit)))[:, 0, 0]
    rise = span.rise()
    # Of a loss below 1e-30 of the stored energy nothing is left but how the trailing edge was rounded.
    blur = 4 * jnp.finfo(rise.dtype).eps * jnp.abs(span.slope_at_exit()) * span.entry
    tail = tail + jax.lax.stop_gradient(springs * blur * (jnp.abs(rise) + blur))
    return _total(p, size, 0.5 * springs * rise**2 + dashpot + total, tail)


def branch_losses(
    p: Passage, modes: Modes, size: Array, ratio: Array
) -> tuple[Float[Array, " points"], Float[Array, "branches points"]]:
    """What the parallel dashpot and each branch turn into heat, per length of way [N], all lines together.

    With y_k the displacement of a branch's dashpot, at the trailing edge Y_k = int (1 - e^{-r/s_k}) g'(r-b) dr, and u_b
    = g(a) - g(b), the work on a branch less what it holds at the edge is

        E_k int e^{-r/s_k} C dr - E_k (u_b - Y_k)^2/2 = E_k [u_b Y_k - int (1 - e^{-r/s_k}) C dr - Y_k^2/2],

    the first for fast branches, the second for slow ones, each without cancellation. What all springs hold at the edge
    is lost in free recovery, where y_k = sum_j Y_jk m_j e^{-t/lambda_j}: E_k tau_k int y_k'^2 dt in closed form. Exact
    where the sampling is; their sum is the friction force. Derived here.
    """
    span = _Span(p, size, ratio)
    correlation = _autocorrelation(p, size, span.entry, span.exit)
    kept, gone, slow = _memories(p, span, correlation(span.positions(jnp.zeros_like(span.exit))))
    force, lag, _ = _memories(p, span, span.slope_samples())
    rise = span.rise()
    left = rise[:, None]
    inside = p.law.moduli[:, None] * jnp.where(slow, left * lag - gone - 0.5 * lag**2, kept - 0.5 * force**2)
    friction = p.law.moduli * p.law.times
    present = modes.gain > 0
    share = jnp.where(present, 1 / jnp.where(present, modes.norm, 1.0), 0.0)
    m = jnp.einsum("jk,k,lkp->ljp", modes.shape, friction, jnp.where(slow, lag, left - force))
    m = share[:, None] * (m + p.law.viscosity * left)
    rates = modes.rate[:, None] + modes.rate
    decay = modes.rate[:, None] * modes.rate / jnp.where(rates > 0, rates, 1.0)
    after = jnp.einsum("k,ik,jk,ij,lip,ljp->lkp", friction, modes.shape, modes.shape, decay, m, m, optimize="greedy")
    dashpot = p.velocity * correlation(jnp.zeros_like(_spread(span.exit)))[:, 0, 0]
    dashpot = p.law.viscosity * (dashpot + jnp.einsum("ij,lip,ljp->lp", decay, m, m, optimize="greedy"))
    weight = p.lines.weight(size)
    return jnp.sum(weight * dashpot, axis=0), jnp.sum(weight[:, None] * (inside + after), axis=0)


def _memories(p: Passage, span: "_Span", samples: Array) -> tuple[Array, Array, Array]:
    """int e^{-r/s_k} h dr and int (1 - e^{-r/s_k}) h dr from samples of h, and which branches take the second, since
    they are slower than the passage: arrays (lines, branches, points)."""
    c = jnp.asarray(span.width * _legendre(p.rule, samples))
    decay = p.velocity * p.law.times[:, None]
    slow = decay > (span.entry + span.exit)[:, None]
    before, z = jnp.exp(-span.start / decay), span.width / decay
    # 1 - mu_0 = (z/2)(mu_0 + mu_1), hence the third row; one call serves all three.
    zero = jnp.zeros_like(c)
    later = jnp.concatenate([zero[:1], c[1:]])
    first = jnp.concatenate([c[:1], c[:1], zero[2:]])
    fast, later, first = contract(jnp.stack([c, later, first], axis=1), z)
    relaxed = -jnp.expm1(-span.start / decay) * c[0] + before * (0.5 * z * first - later)
    return jnp.sum(before * fast, axis=1), jnp.sum(relaxed, axis=1), slow


def _total(p: Passage, size: Array, force: Array, tail: Array) -> tuple[Array, Array]:
    """Sum of all lines, and the error of that sum: of sampling along the lines, and of their finite number."""
    weight = p.lines.weight(size)
    parts = weight * force
    error = jnp.sum(weight * tail, axis=0) + jax.lax.stop_gradient(p.lines.summation_error(parts))
    return jnp.sum(parts, axis=0), error


class _Span:
    """The stretch of contact of every line: its edges, its panels, and the profile sampled on them."""

    def __init__(self, p: Passage, size: Array, ratio: Array):
        self.p, self.size = p, size
        self.line = jnp.arange(p.lines.count)[:, None, None, None]
        self.entry = p.lines.entry(size)
        self.exit = ratio * self.entry
        self.start, self.width = _panels(p.rule, self.entry, self.exit)

    def positions(self, exit: Array) -> Float[Array, "lines panels nodes points"]:
        nodes = jnp.asarray(gauss(self.p.rule.nodes)[0])[:, None]
        return self.start + self.width * nodes - _spread(exit)

    def slope_samples(self) -> Float[Array, "lines panels nodes points"]:
        return self.p.lines.slope(self.positions(self.exit), self.size, self.line)

    def indentation_samples(self) -> Float[Array, "lines panels nodes points"]:
        return self._profile(_spread(self.entry)) - self._profile(self.positions(self.exit))

    def rise(self) -> Float[Array, "lines points"]:
        """Indentation left at the trailing edge, g(a) - g(b)."""
        return (self._profile(_spread(self.entry)) - self._profile(_spread(self.exit)))[:, 0, 0]

    def slope_at_exit(self) -> Float[Array, "lines points"]:
        return self.p.lines.slope(_spread(self.exit), self.size, self.line)[:, 0, 0]

    def dashpot_density(self) -> Float[Array, "lines points"]:
        return -self.p.velocity * self.p.law.viscosity * self.slope_at_exit()

    def dashpot_force(self) -> Float[Array, "lines points"]:
        return self.p.velocity * self.p.law.viscosity * self.rise()

    def _profile(self, x: Array) -> Array:
        return self.p.lines.profile(x, self.size, self.line)


def _integrate(p: Passage, span: _Span, samples: Array) -> tuple[Array, Array]:
    """int E(r/v) h(r) dr from samples of h (..., lines, panels, nodes, points), and what its last two polynomials
    add.
    """
    c = span.width * _legendre(p.rule, samples)
    decay = p.velocity * p.law.times[:, None]
    before = p.law.moduli[:, None] * jnp.exp(-span.start / decay)
    z = span.width / decay
    value = jnp.sum(before * contract(c, z), axis=(-3, -2))
    value = value + p.law.equilibrium * jnp.sum(c[0], axis=(-3, -2))
    if p.rule.exact:
        return value, jnp.zeros_like(value)
    felt = p.law.equilibrium + jnp.sum(before * phi1(z), axis=-2, keepdims=True)
    return value, _tail(p, before, c, z, felt)


def _tail(p: Passage, before: Array, c: Array, z: Array, felt: Array) -> Array:
    """Error of sampling: what the last two polynomials add, and what Gauss' rule misses of those that it cannot see.

    The rule misses about the 2n-th coefficient, reached from the n/2-th and the n-th as in `Strips.summation_error`;
    `felt` is the mean over each panel of the modulus that it is multiplied by.
    """
    before, c, z, felt = jax.lax.stop_gradient((before, c, z, felt))
    last = jnp.zeros_like(c).at[-2:].set(c[-2:])
    seen = p.rule.safety * jnp.abs(jnp.sum(before * contract(last, z), axis=(-3, -2)))
    if not p.rule.split or p.lines.count > 1:
        return seen  # smooth bodies: their coefficients fall too fast for it to matter
    half = c.shape[0] // 2
    end, middle = jnp.max(jnp.abs(c[-2:]), axis=0), jnp.max(jnp.abs(c[half - 2 : half]), axis=0)
    unseen = end * jnp.minimum(end / jnp.where(middle > 0, middle, 1.0), 1.0)
    return seen + _UNSEEN * jnp.sum(felt * unseen, axis=(-3, -2))


def _legendre(rule: Rule, samples: Float[Array, "... nodes points"]) -> Float[Array, "nodes ... 1 points"]:
    """Legendre coefficients in 1 - 2c of the samples on each panel, the polynomials' axis first."""
    return jnp.einsum("...ib,ij->j...b", samples, jnp.asarray(gauss(rule.nodes)[2]))[..., None, :]


def _panels(rule: Rule, entry: Array, exit: Array) -> tuple[Array, Array]:
    """Start and width in r of each panel: arrays (lines, panels, 1, points). An exit ahead of the apex is negative."""
    zero, length = jnp.zeros_like(entry), entry + exit
    split = [zero, jnp.maximum(exit, 0.0), jnp.minimum(entry, length), length]
    ends = jnp.stack(split if rule.split else [zero, length], axis=1)
    widths = ends[:, 1:] - ends[:, :-1]
    fractions = jnp.asarray(rule.fractions)[:, None]
    start = ends[:, :-1, None] + widths[:, :, None] * fractions[:-1]
    width = widths[:, :, None] * (fractions[1:] - fractions[:-1])
    shape = (entry.shape[0], -1, 1, entry.shape[1])
    return start.reshape(shape), width.reshape(shape)


def _autocorrelation(p: Passage, size: Array, entry: Array, exit: Array):
    """C(r) at distances (lines, panels, nodes, points), by Gauss' rule between the kinks of both factors."""
    c, w, _ = gauss(p.rule.nodes)
    fractions = p.rule.fractions
    line = jnp.arange(p.lines.count)[:, None, None, None]

    def correlation(r: Array) -> Array:
        low, high = -_spread(exit) + 0 * r, _spread(entry) - r
        bounds = [low, jnp.clip(-r, low, high), jnp.clip(0 * r, low, high), high] if p.rule.split else [low, high]
        ends, shares = jnp.stack(bounds), jnp.asarray(fractions).reshape(-1, 1, 1, 1, 1, 1)
        spans = ends[1:] - ends[:-1]
        start, width = ends[:-1] + shares[:-1] * spans, (shares[1:] - shares[:-1]) * spans

        def add(i, total):
            x = start + width * jnp.asarray(c)[i]
            product = p.lines.slope(x, size, line) * p.lines.slope(x + r, size, line)
            return total + jnp.asarray(w)[i] * jnp.sum(width * product, axis=(0, 1))

        return jax.lax.fori_loop(0, p.rule.nodes, add, jnp.zeros_like(r))

    return correlation


def _spread(edge: Float[Array, "lines points"]) -> Float[Array, "lines 1 1 points"]:
    return edge[:, None, None, :]
