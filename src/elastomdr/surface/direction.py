"""The direction average, which turns the friction of the MDR line into an estimate for
the half-space.

    mu_3D(v) = (2/pi) int_0^{pi/2} cos(phi) mu_line(v cos(phi)) dphi,      at the same normal force.

The line sees the whole slope of the surface, the half-space only its part along the
motion; the average replaces the loss modulus E''(w) by <cos(phi) E''(w cos(phi))>, and
so is exact to first order in the loss for axisymmetric shapes. With cos(phi) = sech(t)
it becomes (2/pi) int_0^inf sech(t)^2 mu_line(v sech(t)) dt, for which the trapezoidal
rule converges exponentially: as a function of log v a relaxation spectrum is analytic
in a strip of half-width pi/2. Where the contact changes much with the velocity, as
under a cone at high contrast, the strip is narrower and steps must be.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import Array, numpy_unless_traced
from ..material.relaxation import Relaxation
from ..numerics.interpolation import lagrange

if TYPE_CHECKING:
    from jaxtyping import Float, Int


STENCIL = 14  # points of local Lagrange interpolation in log v
# of a profile, and for each, of the excess of the average:
_POWERS = np.array([1.0, 1.5, 2.0, 3.0, 4.0, 6.0])
_EXCESS = np.array(
    [
        [0.151, 0.159, 0.214, 0.63, 1.07, 2.75],  # c
        [1.25, 1.125, 1.0, 2.0, 2.0, 2.0],  # p
        [0.0, 0.5, 1.0, 0.5, 0.5, 0.5],  # q
        [-0.09, -0.045, 0.0, 0.48, 0.70, 1.32],  # d
        [0.09, 0.08, 0.04, 0.11, 0.17, 0.25],  # of the asymmetry, in the bound
    ]
)
# how they rise between the powers
_RISE = np.diff(_EXCESS) / np.diff(_POWERS)
# power of a profile up to which the validity maps say how far the average is off
_STEEPEST = 6.05
# power above which, and glassy over relaxed modulus beyond which, there is no bound
_MAPPED = 2.05, 1001.0
# of mu: how far below the line of the textbook the half-space lay at most on the
# validity map
BARE_LINE = 0.52

_MARGIN = STENCIL // 2


@numpy_unless_traced
def within_maps(law: Relaxation, exponent: Array) -> Array:
    """1 where a contact with that power of the profile is one of the validity maps, NaN
    where it is not: flatter than a ball, and a glassy modulus of more than 1000 times
    the relaxed one, a dashpot or no relaxed modulus at all.
    """
    glassy = law.equilibrium + xp.sum(law.moduli)
    moderate = (glassy <= _MAPPED[1] * law.equilibrium) & (law.viscosity == 0)
    return xp.where((exponent <= _MAPPED[0]) | moderate, 1.0, xp.nan)


class Directions(NamedTuple):
    """Quadrature over directions: mu_3D(v) = sum_i weights_i mu_line(v cosines_i)."""

    cosines: Float[np.ndarray, " directions"]
    weights: Float[np.ndarray, " directions"]
    # weights of the rule with every second direction, for the error
    half: Float[np.ndarray, " directions"]
    quarter: Float[np.ndarray, " directions"]  # the same with every fourth
    tail: float  # bound on the part of mu left out


@functools.lru_cache(64)
def directions(rtol: float, level: int = 0) -> Directions:
    """Trapezoidal rule in t; the number of steps is a multiple of four, so that every
    second node is a rule too.

    The error of step h falls as exp(-pi^2/h), or slower: `level` halves the step as
    often. The part left out above t_max is at most (4/pi) exp(-t_max) of the whole,
    since v mu(v) does not fall with v.
    """
    step = math.pi**2 / math.log(1e4 / rtol) / 2**level
    count = 4 * math.ceil(math.log(20 / rtol) / step / 4)
    node = np.arange(count + 1)
    t = step * node
    cosines = 1 / np.cosh(t)
    weights = 2 / math.pi * step * cosines**2
    weights[0] *= 0.5
    half, quarter = (np.where(node % n == 0, n * weights, 0.0) for n in (2, 4))
    return Directions(cosines, weights, half, quarter, 4 / math.pi * math.exp(-t[-1]))


class SharedGrid(NamedTuple):
    """Velocities, evenly spaced in their logarithm, whose line solutions serve every
    velocity of a curve.
    """

    velocity: Float[np.ndarray, " nodes"]
    weights: Float[np.ndarray, "points nodes"]  # mu_3D = weights @ mu_line
    half: Float[np.ndarray, "points nodes"]  # the same with every second direction
    quarter: Float[np.ndarray, "points nodes"]  # and with every fourth
    # the same with interpolation of lower order
    lower: Float[np.ndarray, "points nodes"]


def shared_grid(velocity: Float[np.ndarray, " points"], rtol: float) -> SharedGrid:
    """One line curve for a whole friction curve: the average and the interpolation in
    log v as one matrix.

    It asks for the fewest line solutions; `shared_curve` is cheaper per point and asks
    for some more.
    """
    rule = directions(rtol)
    step = spacing(rtol)
    place = (np.log(velocity)[:, None] + np.log(rule.cosines)) / step
    margin = STENCIL // 2
    first = math.floor(place.min()) - margin + 1
    nodes = np.arange(first, math.floor(place.max()) + margin + 1)
    fine, coarse = (
        lagrange(place - first, STENCIL),
        lagrange(place - first, STENCIL - 2),
    )

    def matrix(stencil: tuple[Array, Array], weights: np.ndarray) -> np.ndarray:
        index, local = stencil
        rows = np.arange(velocity.size)[:, None, None] * nodes.size
        entries = (local * weights[:, None]).reshape(-1)
        flat = np.bincount(
            (rows + index).reshape(-1), entries, velocity.size * nodes.size
        )
        return flat.reshape(velocity.size, nodes.size)

    return SharedGrid(
        np.exp(step * nodes),
        matrix(fine, rule.weights),
        matrix(fine, rule.half),
        matrix(fine, rule.quarter),
        matrix(coarse, rule.weights),
    )


@numpy_unless_traced
def quadrature_error(
    mu: Array, half: Array, quarter: Array, tail: float, power: int = 2
) -> Array:
    """Error of the average, from the rules with twice and four times the step.

    The rule converges exponentially: the error of step h is C q^4, with 2 h it is C
    q^2, with 4 h C q. The last change is C q^2, its ratio to the one before q. A
    `power` of 1 allows for a strip that is narrower than it seemed so far.
    """
    scale = xp.where(mu > 0, mu, 1.0)
    last, before = (
        xp.minimum(xp.abs(x - y) / scale, 1.0) for x, y in ((half, mu), (quarter, half))
    )
    return mu * (
        last * xp.minimum(last / xp.maximum(before, 1e-300), 1.0) ** power + tail
    )


def interpolation_error(mu: Array, lower: Array) -> Array:
    """Error of the interpolation in log v, the same relative bound for a whole curve: a
    single point's difference between two orders may pass through zero, and the largest
    is within a factor of 3 of the largest error.
    """
    positive = np.where(mu > 0, mu, 1.0)
    return mu * 3 * np.nanmax(np.abs(lower - mu) / positive, initial=0.0)


class Asymmetry(NamedTuple):
    """What the average overstates since the contact in motion is no disc, and how well
    that is known.
    """

    excess: Float[Array, " points"]  # ln(average/half-space), estimated
    # relative error of the average that is left to the model
    bound: Float[Array, " points"]
    # the same for the average divided by exp(excess)
    corrected: Float[Array, " points"]
    # relative change of exp(excess) by that of a friction coefficient, at most
    sensitivity: Float[Array, " points"]


@numpy_unless_traced
def asymmetry(
    average: Array,
    line: Array,
    leading: Array,
    trailing: Array,
    exponent: Array,
    mean: Array | None = None,
) -> Asymmetry:
    """Excess of the direction average over the half-space, from the asymmetry of the
    line's contact.

        ln(mu_average/mu_3D) = c_n s^p_n (2 mu_average/mu_line - 1)^q_n + d_n (m - s),
        s = (a - b)/(a + b)

    with the edges a and b of the line in the direction of motion, the power n = a
    g'(a)/g(a) of its profile there (the mean of both edges, or of all directions where
    that is larger), and the `mean` m of s over all directions, weighted by their share
    of the average (without it the last term is left out). s and m are of first order in
    the loss, so that the average stays exact to first order; both terms tend to 0 at
    low and at high velocity. An empirical rule, fitted to three-dimensional solutions
    with n from 1 to 6 and contrasts up to 1000 (docs/accuracy.md), as are the two
    bounds, which are NaN for steeper profiles.
    """
    s = xp.maximum((leading - trailing) / (leading + trailing), 1e-12)
    apart = 0.0 if mean is None else mean - s
    ratio = average / xp.where(line > 0, line, 1.0)
    c, p, q, d, per_s = _between_powers(exponent)
    factor = c * s**p
    excess = factor * xp.maximum(2 * ratio - 1, 1e-9) ** q + d * apart
    excess = xp.where(line > 0, excess, 0.0)
    within_map = xp.where(exponent <= _STEEPEST, 1.0, xp.nan)
    corrected_bound = within_map * (
        0.25 * xp.abs(excess) + per_s * (s + xp.maximum(apart, 0.0))
    )
    return Asymmetry(
        excess,
        corrected_bound + xp.abs(excess),
        corrected_bound,
        4 * factor + 2 * xp.abs(d) * (s + apart),
    )


def _between_powers(exponent: Array) -> Array:
    """The rows of `_EXCESS` at a power of a profile, linear between those of the table
    and held beyond.
    """
    held = xp.clip(exponent, _POWERS[0], _POWERS[-1])
    left = xp.sum(held >= _POWERS[1:-1].reshape(-1, *[1] * held.ndim), axis=0)
    start, below, rise = (xp.take(x, left, axis=-1) for x in (_POWERS, _EXCESS, _RISE))
    return rise * (held - start) + below


@numpy_unless_traced
def layer_asymmetry(
    average: Array,
    line: Array,
    leading: Array,
    trailing: Array,
    exponent: Array,
    width: Array,
) -> Asymmetry:
    """`asymmetry` for the line with the kernel of a layer; `width` w is that of the
    contact over the thickness.

    The excess is that of the half-space times 1 + (0.8 + 0.6 n) w^2/(w^2 + 0.64), n the
    power of the profile: an empirical rule, fitted to balls and cones at contrasts up
    to 100 and 2a/h up to 6 (`benchmarks/layer_map.py`), as are the bounds, which are
    NaN for wider contacts and steeper profiles.
    """
    half_space = asymmetry(average, line, leading, trailing, exponent)
    n = xp.clip(exponent, 1.0, 2.0)
    more = 1 + (0.8 + 0.6 * n) * width**2 / (width**2 + 0.64)
    excess = more * half_space.excess
    s = xp.maximum((leading - trailing) / (leading + trailing), 1e-12)
    within_map = xp.where((width <= 6.5) & (exponent <= 2.05), 1.0, xp.nan)
    bound = within_map * (0.5 * excess + 0.08 * s + 0.003 + 0.02 * (2 - n))
    return Asymmetry(excess, bound + excess, bound, more * half_space.sensitivity)


def spacing(rtol: float) -> float:
    """Of the grid in log v, for a relative error of interpolation of about `rtol`; it
    is judged afterwards.
    """
    return 0.4 * (rtol / 1e-2) ** (1 / STENCIL)


class SharedCurve(NamedTuple):
    """A line curve and what it takes to average and to interpolate it."""

    velocity: Float[np.ndarray, " nodes"]  # of the line solutions [m/s]
    # `average` of the line's friction at the means, a part of the nodes
    kernel: Float[np.ndarray, " width"]
    half: Float[np.ndarray, " width"]  # the same with every second direction
    quarter: Float[np.ndarray, " width"]  # and with every fourth
    lower: Float[np.ndarray, " width"]  # the same with interpolation of lower order
    means: slice  # which nodes the averages belong to
    near: Int[np.ndarray, "points stencil"]  # the means about each velocity
    local: Float[np.ndarray, "points stencil"]  # and their weights
    coarse: Float[np.ndarray, "points stencil"]  # the same of lower order


def shared_curve(
    velocity: Float[np.ndarray, " points"], rtol: float, level: int = 0
) -> SharedCurve:
    """The grid for velocities [m/s] at one load, to a relative error of about `rtol`;
    `level` halves it as often.
    """
    step, kernels = spacing(rtol) / 2**level, _kernels(rtol, level)
    place = np.log(velocity) / step
    first, last = (
        math.floor(place.min()) - _MARGIN + 1,
        math.floor(place.max()) + _MARGIN,
    )
    index, local = map(np.asarray, lagrange(place - first, STENCIL))
    coarse = np.pad(lagrange(place - first, STENCIL - 2)[1], ((0, 0), (1, 1)))
    below = kernels.below
    return SharedCurve(
        np.exp(step * np.arange(first - below, last + _MARGIN + 1)),
        kernels.whole,
        kernels.half,
        kernels.quarter,
        kernels.lower,
        slice(below, below + last - first + 1),
        index,
        local,
        coarse,
    )


class _Kernels(NamedTuple):
    """The part of a `SharedCurve` that is the same for all velocities."""

    below: int  # nodes of a kernel below its own
    whole: np.ndarray
    half: np.ndarray
    quarter: np.ndarray
    lower: np.ndarray


@functools.lru_cache(64)
def _kernels(rtol: float, level: int) -> _Kernels:
    rule, step = directions(rtol, level), spacing(rtol) / 2**level
    shift = np.log(rule.cosines) / step  # of the directions, down the grid
    below = _MARGIN - 1 - math.floor(shift.min())
    width = below + _MARGIN + 1

    def kernel(stencil: int, weights: np.ndarray) -> np.ndarray:
        index, local = lagrange(shift + below, stencil)
        return np.bincount(index.ravel(), (local * weights[:, None]).ravel(), width)

    return _Kernels(
        below,
        kernel(STENCIL, rule.weights),
        kernel(STENCIL, rule.half),
        kernel(STENCIL, rule.quarter),
        kernel(STENCIL - 2, rule.weights),
    )


def shared_curve_size(velocity: Float[np.ndarray, " points"], rtol: float) -> int:
    """Number of line solutions that `shared_curve` asks for, to within two."""
    span = math.log(velocity.max() / velocity.min()) - math.log(
        directions(rtol).cosines[-1]
    )
    return math.ceil(span / spacing(rtol)) + 2 * STENCIL - 1


def average(
    line: Float[Array, " nodes"], kernel: Float[np.ndarray, " width"]
) -> Float[np.ndarray, " means"]:
    """The direction average of a line curve at the means."""
    return np.correlate(np.asarray(line), kernel, "valid")


def at_points(
    values: Float[np.ndarray, " means *n"],
    near: Int[np.ndarray, "points stencil"],
    weights: Float[np.ndarray, "points stencil"],
) -> Float[np.ndarray, " points *n"]:
    """Values at the means, interpolated to the velocities asked for."""
    return np.einsum("ps,ps...->p...", weights, values[near])


def between_orders(
    values: Float[np.ndarray, "means fields"], near: Int[np.ndarray, "points stencil"]
) -> Float[np.ndarray, " points"]:
    """How far interpolation is from that of lower order about each point, the largest
    of all fields.

    Taken in the middle of the interval of each point and of both beside it, since it
    may vanish by chance at a point.
    """
    windows = np.lib.stride_tricks.sliding_window_view(values, STENCIL, axis=0)
    difference = np.abs(windows @ _orders_apart()).max(axis=1)
    padded = np.pad(difference, 1, "edge")
    return np.max([padded[:-2], difference, padded[2:]], axis=0)[near[:, 0]]


@functools.cache
def _orders_apart() -> np.ndarray:
    """Weights of interpolation in the middle of an interval, less those of lower
    order.
    """
    (fine,), (coarse,) = (
        lagrange(np.array([_MARGIN - 0.5]), stencil)[1]
        for stencil in (STENCIL, STENCIL - 2)
    )
    return fine - np.pad(coarse, 1)
