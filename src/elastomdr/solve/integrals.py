"""Normal and friction force in steady sliding, with the contact edges where they were put.

Every element sees the same history, so with E(t) the foundation's relaxation function, v the velocity, contact from x = -b
to x = a, and r the distance between two elements of the contact (r = v times the time between their entries),

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
from jaxtyping import Array, Float

from ..foundation.moments import contract, relaxed
from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .rule import Rule, gauss


class Passage(NamedTuple):
    """What is the same for all integrals of one call."""

    law: Relaxation
    lines: AbstractLines
    rule: Rule
    velocity: Float[Array, " points"]


def exit_density(p: Passage, size: Array, ratio: Array) -> Float[Array, "lines points"]:
    """Line force density q(-b) at the trailing edges b = ratio times entry."""
    entry = p.lines.entry(size)
    exit = ratio * entry
    start, width = _panels(p.rule, entry, exit)
    samples = p.lines.slope(_positions(p.rule, start, width, exit), size, _line_index(p))
    density, _ = _integrate(p, start, width, samples)
    return density - p.velocity * p.law.viscosity * p.lines.slope(_spread(exit), size, _line_index(p))[:, 0, 0]


def normal_force(p: Passage, size: Array, ratio: Array) -> tuple[Float[Array, " points"], Float[Array, " points"]]:
    """Normal force [N] of all lines, and its estimated sampling error."""
    entry = p.lines.entry(size)
    exit = ratio * entry
    line = _line_index(p)
    start, width = _panels(p.rule, entry, exit)
    top = p.lines.profile(_spread(entry), size, line)
    samples = top - p.lines.profile(_positions(p.rule, start, width, exit), size, line)
    force, tail = _integrate(p, start, width, samples)
    rise = (top - p.lines.profile(_spread(exit), size, line))[:, 0, 0]
    weight = p.lines.weight(size)
    return jnp.sum(weight * (force + p.velocity * p.law.viscosity * rise), axis=0), jnp.sum(weight * tail, axis=0)


def friction_force(p: Passage, size: Array, ratio: Array) -> tuple[Float[Array, " points"], Float[Array, " points"]]:
    """Friction force [N] of all lines, and its estimated sampling error.

    Branches slower than the passage are nearly springs. Their integral is taken of 1 - exp(-r/s), beside the exact
    int C dr = [g(a) - g(b)]^2/2, so that a loss of 1e-20 of the stored energy keeps its digits.
    """
    entry = p.lines.entry(size)
    exit = ratio * entry
    line = _line_index(p)
    start, width = _panels(p.rule, entry, exit)
    correlation = _autocorrelation(p, size, entry, exit)
    samples = correlation(_positions(p.rule, start, width, jnp.zeros_like(exit)))
    coefficients = _legendre(p.rule, samples)

    decay = p.velocity * p.law.times[:, None]
    slow = decay > (entry + exit)[:, None]  # lines, branches, points
    moduli = p.law.moduli[:, None]
    z0, z = start / decay, width / decay
    scaled = [width * c for c in coefficients]
    fast_part = jnp.exp(-z0) * contract(tuple(scaled), z)
    slow_part = -jnp.expm1(-z0) * scaled[0] + jnp.exp(-z0) * relaxed(tuple(scaled), z)
    total = jnp.sum(moduli * jnp.where(slow[:, None], -slow_part, fast_part), axis=(1, 2))
    if p.rule.exact:
        tail = jnp.zeros_like(total)
    else:
        last = tuple(jnp.where(j < p.rule.nodes - 2, 0.0, 1.0) * c for j, c in enumerate(scaled))
        lost = jnp.exp(-z0) * contract(last, z)
        tail = jnp.abs(jnp.sum(moduli * lost, axis=(1, 2)))

    rise = (p.lines.profile(_spread(entry), size, line) - p.lines.profile(_spread(exit), size, line))[:, 0, 0]
    springs = p.law.equilibrium + jnp.sum(jnp.where(slow, moduli, 0.0), axis=1)
    dashpot = p.velocity * p.law.viscosity * correlation(jnp.zeros_like(_spread(exit)))[:, 0, 0]
    weight = p.lines.weight(size)
    force = 0.5 * springs * rise**2 + dashpot + total
    return jnp.sum(weight * force, axis=0), jnp.sum(weight * tail, axis=0)


def _integrate(p: Passage, start: Array, width: Array, samples: Array) -> tuple[Array, Array]:
    """int E(r/v) h(r) dr from samples of h, and the size of what its last two polynomials add."""
    coefficients = [width * c for c in _legendre(p.rule, samples)]
    decay = p.velocity * p.law.times[:, None]
    moduli = p.law.moduli[:, None]
    before = moduli * jnp.exp(-start / decay)
    value = jnp.sum(before * contract(tuple(coefficients), width / decay), axis=(1, 2))
    value = value + p.law.equilibrium * jnp.sum(coefficients[0], axis=(1, 2))
    if p.rule.exact:
        return value, jnp.zeros_like(value)
    last = tuple(jnp.where(j < p.rule.nodes - 2, 0.0, 1.0) * c for j, c in enumerate(coefficients))
    return value, jnp.abs(jnp.sum(before * contract(last, width / decay), axis=(1, 2)))


def _legendre(rule: Rule, samples: Float[Array, "lines panels nodes points"]) -> list[Array]:
    """Legendre coefficients in 1 - 2c of the samples on each panel, as arrays (lines, panels, 1, points)."""
    coefficients = jnp.einsum("lpib,ij->lpjb", samples, jnp.asarray(gauss(rule.nodes)[2]))
    return [coefficients[:, :, j : j + 1] for j in range(rule.nodes)]


def _panels(rule: Rule, entry: Array, exit: Array) -> tuple[Array, Array]:
    """Start and width in r of each panel: arrays (lines, panels, 1, points)."""
    zero = jnp.zeros_like(entry)
    ends = jnp.stack([zero, exit, entry, entry + exit] if rule.split else [zero, entry + exit], axis=1)
    widths = ends[:, 1:] - ends[:, :-1]
    fractions = jnp.asarray(rule.fractions)[:, None]
    start = ends[:, :-1, None] + widths[:, :, None] * fractions[:-1]
    width = widths[:, :, None] * (fractions[1:] - fractions[:-1])
    shape = (entry.shape[0], -1, 1, entry.shape[1])
    return start.reshape(shape), width.reshape(shape)


def _positions(rule: Rule, start: Array, width: Array, exit: Array) -> Float[Array, "lines panels nodes points"]:
    return start + width * jnp.asarray(gauss(rule.nodes)[0])[:, None] - _spread(exit)


def _autocorrelation(p: Passage, size: Array, entry: Array, exit: Array):
    """C(r) at distances (lines, panels, nodes, points), by Gauss' rule between the kinks of both factors."""
    c, w, _ = gauss(p.rule.nodes)
    fractions = p.rule.fractions
    line = _line_index(p)

    def correlation(r: Array) -> Array:
        low, high = -_spread(exit) + 0 * r, _spread(entry) - r
        bounds = [low, jnp.clip(-r, low, high), jnp.clip(0 * r, low, high), high] if p.rule.split else [low, high]
        pieces = [
            (left + f0 * (right - left), (f1 - f0) * (right - left))
            for left, right in zip(bounds[:-1], bounds[1:], strict=True)
            for f0, f1 in zip(fractions[:-1], fractions[1:], strict=True)
        ]
        start, width = (jnp.stack(part) for part in zip(*pieces, strict=True))

        def add(i, total):
            x = start + width * jnp.asarray(c)[i]
            product = p.lines.slope(x, size, line) * p.lines.slope(x + r, size, line)
            return total + jnp.asarray(w)[i] * jnp.sum(width * product, axis=0)

        return jax.lax.fori_loop(0, p.rule.nodes, add, jnp.zeros_like(r))

    return correlation


def _line_index(p: Passage) -> Array:
    return jnp.arange(p.lines.count)[:, None, None, None]


def _spread(edge: Float[Array, "lines points"]) -> Float[Array, "lines 1 1 points"]:
    return edge[:, None, None, :]
