"""The direction average, which turns the friction of the MDR line into an estimate for the half-space.

    mu_3D(v) = (2/pi) int_0^{pi/2} cos(phi) mu_line(v cos(phi)) dphi,      at the same normal force.

The line sees the whole slope of the surface, the half-space only its part along the motion; the average replaces the
loss modulus E''(w) by <cos(phi) E''(w cos(phi))>, and so is exact to first order in the loss for axisymmetric shapes.
With cos(phi) = sech(t) it becomes (2/pi) int_0^inf sech(t)^2 mu_line(v sech(t)) dt, for which the trapezoidal rule
converges exponentially: as a function of log v a relaxation spectrum is analytic in a strip of half-width pi/2.
"""

import math
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from .._runtime import Array, is_traced
from ..material.relaxation import Relaxation

_STENCIL = 14  # points of local Lagrange interpolation in log v
_STEEPEST = 4.05  # power of a profile up to which the validity map says how far the average is off
BARE_LINE = 0.52  # of mu: how far below the line of the textbook the half-space lay at most on the validity map


class Directions(NamedTuple):
    """Quadrature over directions: mu_3D(v) = sum_i weights_i mu_line(v cosines_i)."""

    cosines: Float[np.ndarray, " directions"]
    weights: Float[np.ndarray, " directions"]
    check: Float[np.ndarray, " directions"]  # weights of the rule with every second direction, for the error
    tail: float  # bound on the part of mu left out


def directions(rtol: float) -> Directions:
    """Trapezoidal rule in t; an even number of steps, so that every second node is a rule too.

    The error of step h falls as exp(-pi^2/h); the part left out above t_max is at most (4/pi) exp(-t_max) of the
    whole, since v mu(v) does not fall with v.
    """
    step = math.pi**2 / math.log(1e4 / rtol)
    count = 2 * math.ceil(math.log(20 / rtol) / step / 2)
    t = step * np.arange(count + 1)
    cosines = 1 / np.cosh(t)
    weights = 2 / math.pi * step * cosines**2
    weights[0] *= 0.5
    check = np.where(np.arange(count + 1) % 2 == 0, 2 * weights, 0.0)
    return Directions(cosines, weights, check, 4 / math.pi * math.exp(-t[-1]))


def isotropic_loss(law: Relaxation, omega: Float[np.ndarray, "..."]) -> Float[np.ndarray, "..."]:
    """Loss modulus of an isotropic surface, (1/2 pi) int_0^2pi cos(phi) E''(w cos phi) dphi [Pa], exact.

    sum_k E_k/x_k (1 - 1/sqrt(1 + x_k^2)) + eta w/2 with x_k = w tau_k: the direction average in full contact, in closed
    form, and what waves of every direction lose on a half-space. Derived here.
    """
    x = np.asarray(omega)[..., None] * np.asarray(law.times)
    root = np.sqrt(1 + x**2)
    return (x / (root * (1 + root))) @ np.asarray(law.moduli) + 0.5 * np.asarray(law.viscosity) * omega


class SharedGrid(NamedTuple):
    """Velocities, evenly spaced in their logarithm, whose line solutions serve every velocity of a curve."""

    velocity: Float[np.ndarray, " nodes"]
    weights: Float[np.ndarray, "points nodes"]  # mu_3D = weights @ mu_line
    check: Float[np.ndarray, "points nodes"]  # the same with every second direction
    lower: Float[np.ndarray, "points nodes"]  # the same with interpolation of lower order


def shared_grid(velocity: Float[np.ndarray, " points"], rtol: float) -> SharedGrid:
    """One line curve for a whole friction curve: the average and the interpolation in log v as one matrix."""
    rule = directions(rtol)
    spacing = _spacing(rtol)
    place = (np.log(velocity)[:, None] + np.log(rule.cosines)) / spacing
    margin = _STENCIL // 2
    first = math.floor(place.min()) - margin + 1
    nodes = np.arange(first, math.floor(place.max()) + margin + 1)
    fine, coarse = _lagrange(place - first, _STENCIL), _lagrange(place - first, _STENCIL - 2)

    def matrix(stencil: tuple[np.ndarray, np.ndarray], weights: np.ndarray) -> np.ndarray:
        index, local = stencil
        rows = np.arange(velocity.size)[:, None, None] * nodes.size
        entries = (local * weights[:, None]).reshape(-1)
        flat = np.bincount((rows + index).reshape(-1), entries, velocity.size * nodes.size)
        return flat.reshape(velocity.size, nodes.size)

    return SharedGrid(
        np.exp(spacing * nodes), matrix(fine, rule.weights), matrix(fine, rule.check), matrix(coarse, rule.weights)
    )


def shared_grid_size(velocity: Float[np.ndarray, " points"], rtol: float) -> int:
    """Number of line solutions that `shared_grid` asks for, to within one."""
    span = math.log(velocity.max() / velocity.min()) - math.log(directions(rtol).cosines[-1])
    return math.ceil(span / _spacing(rtol)) + _STENCIL


def quadrature_error(mu: Array, check: Array, tail: float) -> Array:
    """Error of the average, from the rule with twice the step: halving the step of an exponentially convergent rule
    squares it.

    The factor 0.1 keeps the estimate 3 to 10 times above the error found on spectra from one branch to broad ones.
    """
    numpy: Any = jnp if is_traced(mu, check) else np
    relative = numpy.minimum(numpy.abs(check - mu) / numpy.where(mu > 0, mu, 1.0), 1.0)
    return mu * (0.1 * relative**2 + tail)


def interpolation_error(mu: Array, lower: Array) -> Array:
    """Error of the interpolation in log v, the same relative bound for a whole curve: a single point's difference
    between two orders may pass through zero, and the largest is within a factor of 3 of the largest error."""
    positive = np.where(mu > 0, mu, 1.0)
    return mu * 3 * np.nanmax(np.abs(lower - mu) / positive, initial=0.0)


class Asymmetry(NamedTuple):
    """What the average overstates since the contact in motion is no disc, and how well that is known."""

    excess: Float[Array, " points"]  # ln(average/half-space), estimated
    bound: Float[Array, " points"]  # relative error of the average that is left to the model
    corrected: Float[Array, " points"]  # the same for the average divided by exp(excess)
    sensitivity: Float[Array, " points"]  # relative change of exp(excess) by that of a friction coefficient, at most


def asymmetry(average: Array, line: Array, leading: Array, trailing: Array, exponent: Array) -> Asymmetry:
    """Excess of the direction average over the half-space, from the asymmetry of the line's contact.

        ln(mu_average/mu_3D) = c_n s^(1+|n-2|/4) (2 mu_average/mu_line - 1)^min(n-1, 1),    s = (a - b)/(a + b)
        c_n = 0.28 - 0.225 n + 0.096 n^2

    with the edges a and b of the line in the direction of motion and the power n = a g'(a)/g(a) of its profile there. s
    is of first order in the loss, so that the average stays exact to first order; both factors tend to limits, and s to
    0, at low and at high velocity. An empirical rule, fitted to three-dimensional solutions with n = 1, 2 and 4 and
    contrasts up to 1000 (docs/accuracy.md), as are the two bounds, which are NaN for steeper profiles.
    """
    numpy = jnp if is_traced(average, line, leading, trailing, exponent) else np
    s = numpy.maximum((leading - trailing) / (leading + trailing), 1e-12)
    ratio = average / numpy.where(line > 0, line, 1.0)
    n = numpy.clip(exponent, 1.0, 4.0)
    share = numpy.maximum(2 * ratio - 1, 1e-9) ** numpy.minimum(n - 1, 1.0)
    factor = (0.28 - 0.225 * n + 0.096 * n**2) * s ** (1 + numpy.abs(n - 2) / 4)
    excess = numpy.where(line > 0, factor * share, 0.0)
    known = numpy.where(exponent <= _STEEPEST, 1.0, numpy.nan)
    return Asymmetry(excess, known * (1.5 * excess + 0.1 * s), known * (0.5 * excess + 0.1 * s), 4 * factor)


def _spacing(rtol: float) -> float:
    return 0.4 * (rtol / 1e-2) ** (1 / _STENCIL)


def _lagrange(place: np.ndarray, stencil: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices and weights of the `stencil` nodes around each place on a grid of unit spacing: (..., stencil)."""
    left = np.floor(place).astype(int) - (stencil // 2 - 1)
    offsets = np.arange(stencil)
    gaps = (place - left)[..., None] - offsets
    gaps = np.where(gaps == 0, 1e-300, gaps)
    factorial = [math.factorial(j) * math.factorial(stencil - 1 - j) for j in offsets]
    barycentric = (-1.0) ** offsets / np.array(factorial) / gaps
    return left[..., None] + offsets, barycentric / barycentric.sum(axis=-1, keepdims=True)
