"""The relaxation function shared by materials and foundations: a spring, Maxwell
branches and a dashpot in parallel, and the Kelvin chain with the same law.

Poles of a relaxation function and of its creep function interlace. With pole times p_1
< ... < p_n and weights w_k >= 0, the times of the other function are the roots t of the
secular equation

    sum_k w_k / (t - p_k) = c,        c >= 0,

one in each interval (p_k, p_{k+1}) and, where c > 0, one above p_n. A general
eigenvalue routine loses the small eigenvalues to rounding once the times span more than
15 decades; here every root is found as a distance to the nearer end of its interval, so
that it keeps its relative accuracy over any span.
"""

from __future__ import annotations

import abc
import math
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import compiled, on_numpy, stop_gradient, xp
from ..checks import (
    Array,
    alike,
    as_float64,
    certain,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    possible,
    require,
    scalar,
)
from ..errors import InputError
from ..numerics.root import bisect
from ..trees import Tree

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, ComplexArray, Number


_APART = 1e-12  # relative distance of equal times that cannot be made one

# frequencies times branches whose moduli are summed at once: an array of 2^14 is one that
# the system keeps at hand, larger ones are new memory in each step, six times slower
_BLOCK = 2**14
# halvings of the logarithm of a distance: from 280 decades down to rounding
_BISECTIONS = 64
_SMALLEST = 1e-140  # its square is still a float64


class AbstractRelaxation(Tree):
    """E(t) = E_inf + sum_k E_k exp(-t/tau_k) + eta delta(t), with its creep function
    and its complex modulus.

    Subclasses hold the four fields. "Modulus" stands for whatever quantity they carry:
    G, E*, a layer's stiffness.
    """

    equilibrium: Float[Array, ""]  # E_inf, zero for a liquid [Pa]
    moduli: Float[Array, " n"]  # E_k [Pa]
    times: Float[Array, " n"]  # tau_k, ascending [s]
    viscosity: Float[Array, ""]  # eta of the parallel dashpot [Pa s]

    @abc.abstractmethod
    def law(self) -> "Relaxation":
        """The bare relaxation function that the methods below evaluate."""

    @property
    def instantaneous(self) -> Array:
        """Glassy modulus E_inf + sum E_k [Pa]; a parallel dashpot is not part of it."""
        law = self.law()
        return law.equilibrium + law.moduli.sum()

    @numpy_unless_traced
    def relaxation(self, t: ArrayLike) -> Array:
        """Stress after a unit strain step, E(t) [Pa], at times t > 0 [s], any shape. A
        dashpot adds nothing at t > 0.
        """
        law, t = self.law(), as_float64("t", t)
        not_negative("t", t)
        return law.equilibrium + _sum_branches(
            law.moduli, xp.exp(-t[..., None] / law.times)
        )

    @numpy_unless_traced
    def creep_compliance(self, t: ArrayLike) -> Array:
        """Strain after a unit stress step, J(t) [1/Pa], at times t >= 0 [s], any shape.

        A parallel dashpot lets nothing happen at once: J(0) = 0, though
        `instantaneous`, without it, is finite. Exact: the Kelvin chain with the same
        law, from the zeros of the relaxation function (`to_kelvin`).
        """
        chain, t = to_kelvin(self.law()), as_float64("t", t)
        not_negative("t", t)
        retarded = _sum_branches(
            chain.compliances, -xp.expm1(-t[..., None] / chain.times)
        )
        return chain.instantaneous + retarded + t * chain.fluidity

    @numpy_unless_traced
    def complex_modulus(self, omega: ArrayLike) -> ComplexArray:
        """E*(omega) = E_inf + sum E_k i w tau_k/(1 + i w tau_k) + i w eta [Pa], at
        omega >= 0 [rad/s], any shape.
        """
        law, omega = self.law(), as_float64("omega", omega)
        not_negative("omega", omega)
        block = max(1, _BLOCK // max(1, law.times.shape[0]))
        if on_numpy() and omega.size > block:
            blocks = np.array_split(omega.ravel(), -(-omega.size // block))
            parts = [law.complex_modulus(block) for block in blocks]
            return np.concatenate(parts).reshape(omega.shape)
        x = omega[..., None] * law.times
        with np.errstate(divide="ignore"):  # at rest nothing is stored or lost: x = 0
            both = x + 1 / x
        storage = _sum_branches(law.moduli, x / both)
        loss = _sum_branches(law.moduli, 1 / both)
        return law.equilibrium + storage + 1j * (loss + omega * law.viscosity)

    def storage(self, omega: ArrayLike) -> Array:
        """Storage modulus [Pa] at omega [rad/s]."""
        return self.complex_modulus(omega).real

    def loss(self, omega: ArrayLike) -> Array:
        """Loss modulus [Pa] at omega [rad/s]."""
        return self.complex_modulus(omega).imag

    @numpy_unless_traced
    def loss_tangent(self, omega: ArrayLike) -> Array:
        """Loss modulus over storage modulus at omega [rad/s]; infinite where nothing is
        stored.
        """
        value = self.complex_modulus(omega)
        elastic = value.real > 0
        return xp.where(
            elastic, value.imag / xp.where(elastic, value.real, 1.0), xp.inf
        )


class Relaxation(AbstractRelaxation):
    """A bare relaxation function; `Prony` and `Foundation` say what it is the
    relaxation function of.
    """

    equilibrium: Float[Array, ""]
    moduli: Float[Array, " n"]
    times: Float[Array, " n"]
    viscosity: Float[Array, ""]

    def law(self) -> "Relaxation":
        return self


class KelvinChain(Tree):
    """J(t) = J_0 + sum_k J_k (1 - exp(-t/lambda_k)) + phi t: the creep form of the same
    law.
    """

    instantaneous: Float[Array, ""]  # J_0 [1/Pa]
    compliances: Float[Array, " n"]  # J_k [1/Pa]
    times: Float[Array, " n"]  # retardation times lambda_k, ascending [s]
    fluidity: Float[Array, ""]  # phi [1/(Pa s)]


def checked(
    equilibrium: Number, moduli: ArrayLike, times: ArrayLike, viscosity: Number
) -> Relaxation:
    """A `Relaxation` from a user's numbers, or an `InputError` that names what is wrong
    with them.
    """
    equilibrium = scalar("equilibrium", equilibrium)
    viscosity = scalar("viscosity", viscosity)
    moduli, times = as_float64("moduli", moduli), as_float64("times", times)
    for name, value in (("equilibrium", equilibrium), ("viscosity", viscosity)):
        not_negative(name, value)
    alike(0, {"moduli": moduli, "times": times})
    not_negative("moduli", moduli)
    positive("times", times)
    moduli, times = in_order(moduli, times)
    total = (equilibrium, viscosity, moduli)
    if certain(lambda e, eta, m: e + eta + m.sum() <= 0, *total):
        raise InputError(
            argument="equilibrium",
            got=0.0,
            accepted="above 0 where moduli and viscosity are zero",
            hint="such a material carries no load",
        )
    return Relaxation(equilibrium, moduli, times, viscosity)


def poisson_ratio(poisson: Number) -> Array:
    """A constant Poisson's ratio as a scalar. Raises `InputError`."""
    poisson = scalar("poisson", poisson)
    accepted = "above -1 and at most 0.5"
    require("poisson", poisson, accepted, lambda nu: (nu > -1) & (nu <= 0.5))
    return poisson


@numpy_unless_traced
def in_order(moduli: Array, times: Array) -> tuple[Array, Array]:
    """Branches by ascending time, those of one time as one. Under a transformation of
    the times, where their number is fixed, those of one time are moved apart by
    rounding.
    """
    if is_traced(times):
        order = xp.argsort(times)
        times = times[order]
        # how many of the same time
        before = np.arange(times.shape[0]) - xp.searchsorted(times, times)
        return xp.take(moduli, order), times * (1 + _APART * before)
    if (np.diff(times) > 0).all():
        return moduli, times
    times, branch = np.unique(times, return_inverse=True)
    same = np.arange(times.size)[:, None] == branch  # which branches make up which
    return (same * moduli).sum(axis=1), times


def scaled(law: Relaxation, factor: Array | float) -> Relaxation:
    """`factor` times the relaxation function."""
    return Relaxation(
        law.equilibrium * factor, law.moduli * factor, law.times, law.viscosity * factor
    )


@numpy_unless_traced
def parallel(first: Relaxation, second: Relaxation) -> Relaxation:
    """The sum of two relaxation functions, with times in ascending order."""
    moduli = xp.concatenate([first.moduli, second.moduli])
    times = xp.concatenate([first.times, second.times])
    order = xp.argsort(times)
    return Relaxation(
        first.equilibrium + second.equilibrium,
        xp.take(moduli, order),
        times[order],
        first.viscosity + second.viscosity,
    )


@numpy_unless_traced
def to_kelvin(law: Relaxation) -> KelvinChain:
    """The Kelvin chain of a relaxation function, exact: its retardation times are the
    zeros of E(s).

    With s = -1/lambda, E(s) = E_inf - sum_k E_k tau_k/(lambda - tau_k) - eta/lambda:
    the dashpot is a branch whose time is zero. Each retardation time lies just above a
    relaxation time. Source: Gross, "Mathematical Structure of the Theories of
    Viscoelasticity" (1953), for the interlacing.
    """
    return kelvin_and_gaps(law)[0]


@numpy_unless_traced
def kelvin_and_gaps(law: Relaxation) -> tuple[KelvinChain, Float[Array, "j k"]]:
    """The Kelvin chain, and lambda_j - tau_k to full relative accuracy, however close
    the times lie together.
    """
    with_dashpot = possible(lambda eta: eta > 0, law.viscosity)
    equilibrium, moduli, times, viscosity = (
        law.equilibrium,
        law.moduli,
        law.times,
        law.viscosity,
    )
    weights = moduli * times
    total_viscosity = viscosity + xp.sum(weights)
    if with_dashpot:
        times = xp.append(0.0, times)
        weights = xp.append(viscosity, weights)
    glassy = equilibrium + xp.sum(moduli)
    instantaneous = xp.where(viscosity > 0, 0.0, 1 / xp.where(glassy > 0, glassy, 1.0))
    liquid = equilibrium == 0
    fluidity = xp.where(
        liquid, 1 / xp.where(liquid & (total_viscosity > 0), total_viscosity, 1.0), 0.0
    )
    kept = _visible(weights > 0)  # between empty branches there would be no root
    poles, strengths = times[kept], weights[kept]
    if poles.shape[0] == 0:
        return KelvinChain(instantaneous, strengths, poles, fluidity), xp.zeros(
            (0, moduli.shape[0])
        )
    roots, slope, near = secular_roots(poles, strengths, equilibrium)
    has_root = xp.isfinite(roots) & (strengths > 0)
    compliances = xp.where(has_root, 1 / (xp.where(has_root, roots, 1.0) * slope), 0.0)
    roots = xp.where(has_root, roots, xp.maximum(2 * poles[-1], 1.0))
    near = near[:, 1:] if with_dashpot else near
    kept = _visible(moduli > 0)
    gaps = roots[:, None] - law.times
    closer = xp.where(has_root[:, None], near, gaps[:, kept])
    if isinstance(gaps, np.ndarray):
        gaps[:, kept] = closer
    else:
        gaps = gaps.at[:, kept].set(closer)
    # drop what is not there: the flow of a liquid, an empty branch
    kept = _visible(has_root)
    order = xp.argsort(xp.where(has_root, roots, xp.inf)[kept])
    compliances, roots, gaps = (x[kept][order] for x in (compliances, roots, gaps))
    return KelvinChain(instantaneous, compliances, roots, fluidity), gaps


@numpy_unless_traced
def to_relaxation(chain: KelvinChain) -> Relaxation:
    """The relaxation function of a Kelvin chain: the inverse of `to_kelvin`, with the
    roles of poles and zeros changed.

    With s = -1/t, J(s) = t [J_0/t + sum_k J_k/(t - lambda_k) - phi].
    """
    instantaneous, compliances, times, fluidity = (
        chain.instantaneous,
        chain.compliances,
        chain.times,
        chain.fluidity,
    )
    poles, weights = xp.append(0.0, times), xp.append(instantaneous, compliances)
    kept = _visible(weights > 0)
    poles, weights = poles[kept], weights[kept]
    glassy_free = instantaneous == 0  # no instantaneous compliance: a dashpot remains
    rate = xp.sum(compliances / times) + fluidity
    viscosity = xp.where(glassy_free, 1 / xp.where(glassy_free, rate, 1.0), 0.0)
    total = instantaneous + xp.sum(compliances)
    solid = (fluidity == 0) & (total > 0)
    equilibrium = xp.where(solid, 1 / xp.where(solid, total, 1.0), 0.0)
    if weights.shape[0] == 0:
        return Relaxation(equilibrium, weights, poles, viscosity)
    roots, slope, _ = secular_roots(poles, weights, fluidity)
    has_root = xp.isfinite(roots)
    roots = xp.where(has_root, roots, xp.maximum(2 * poles[-1], 1.0))
    moduli = xp.where(has_root, 1 / (roots**2 * slope), 0.0)
    kept = _visible(has_root)
    return Relaxation(equilibrium, moduli[kept], roots[kept], viscosity)


@numpy_unless_traced
def series(first: Relaxation, second: Relaxation) -> Relaxation:
    """Two bodies that carry the same stress: their creep functions add. Exact, n_1 +
    n_2 branches at most.
    """
    one, two = to_kelvin(first), to_kelvin(second)
    times = xp.concatenate([one.times, two.times])
    order = xp.argsort(times)
    return to_relaxation(
        KelvinChain(
            one.instantaneous + two.instantaneous,
            xp.take(xp.concatenate([one.compliances, two.compliances]), order),
            times[order],
            one.fluidity + two.fluidity,
        )
    )


def spring(modulus: Array) -> Relaxation:
    """A purely elastic body."""
    return Relaxation(modulus, np.zeros(0), np.zeros(0), np.zeros(()))


def _sum_branches(weights: Array, terms: Array) -> Array:
    return (weights * terms).sum(axis=-1)


def _visible(there: Array) -> slice | np.ndarray:
    """Where something is there, as far as that can be seen; everywhere while JAX
    traces.
    """
    return slice(None) if is_traced(there) else np.flatnonzero(there)


@numpy_unless_traced
@compiled()
def secular_roots(
    poles: Float[Array, " n"],  # ascending pole times [s]
    weights: Float[Array, " n"],  # positive weights
    constant: Float[Array, ""],  # c >= 0, same unit as weight over time
) -> tuple[Float[Array, " n"], Float[Array, " n"], Float[Array, "n n"]]:
    """Roots t of sum_k w_k/(t - p_k) = c, the slope sum_k w_k/(t - p_k)^2 at each, and
    t_j - p_k to full accuracy.

    The last root is infinite where c = 0. Differentiable: the bisection is not, one
    Newton step after it is.
    """
    n = poles.shape[0]
    index = xp.arange(n)
    finite = (index < n - 1) | (constant > 0)
    # Where the last root is infinite it is sought with a constant that puts it at a
    # finite place, and masked below: an infinity on the way would turn the derivatives
    # of all roots into NaN.
    stand_in = stop_gradient(xp.sum(weights) / xp.maximum(poles[-1], _SMALLEST))
    constants = xp.where(finite, constant, stand_in)
    fixed_poles, fixed_weights, fixed_constants = stop_gradient(
        (poles, weights, constants)
    )
    top = fixed_poles[-1] + xp.sum(fixed_weights) / fixed_constants[-1]
    upper = xp.append(fixed_poles[1:], top)
    width = upper - fixed_poles

    def excess(
        origin: Array, distance: Array, poles: Array, weights: Array, constants: Array
    ) -> Array:
        gap = (origin[:, None] - poles[None, :]) + distance[:, None]
        return xp.sum(weights / _away_from_zero(gap), axis=1) - constants

    # Which end is nearer: the left-hand side falls through its interval from +infinity
    # to -infinity.
    right_half = (
        excess(fixed_poles, 0.5 * width, fixed_poles, fixed_weights, fixed_constants)
        > 0
    )
    right_half = right_half & (index < n - 1)
    origin = xp.where(right_half, upper, fixed_poles)
    side = xp.where(right_half, -1.0, 1.0)
    reach = xp.where(right_half, 0.5, 1.0) * width

    def farther(log_distance: Array) -> Array:
        """Whether the root lies farther from the origin."""
        distance = side * xp.exp(log_distance)
        value = excess(origin, distance, fixed_poles, fixed_weights, fixed_constants)
        return side * value > 0

    least, most = xp.full(n, math.log(_SMALLEST)), xp.log(xp.maximum(reach, _SMALLEST))
    low, high = bisect(farther, least, most, _BISECTIONS)
    distance = side * xp.exp(0.5 * (low + high))

    origin = poles[xp.minimum(index + right_half, n - 1)]
    roots, slope, gap = _polished(poles, weights, constants, origin, distance)
    return xp.where(finite, roots, xp.inf), slope, gap


def _polished(
    poles: Array, weights: Array, constants: Array, origin: Array, distance: Array
) -> tuple[Array, Array, Array]:
    """Roots after a Newton step on their distances from the origins, which carries the
    derivatives; the slope at them; their distances from all poles.
    """
    gap = (origin[:, None] - poles[None, :]) + distance[:, None]
    residual = xp.sum(weights / _away_from_zero(gap), axis=1) - constants
    step = residual / xp.sum(weights / _away_from_zero(gap) ** 2, axis=1)
    step = step - stop_gradient(
        xp.where(xp.abs(step) < 0.1 * xp.abs(distance), 0.0, step)
    )
    gap = gap + step[:, None]
    slope = xp.sum(weights / _away_from_zero(gap) ** 2, axis=1)
    return origin + distance + step, slope, gap


def _away_from_zero(gap: Array) -> Array:
    return xp.where(xp.abs(gap) < _SMALLEST, _SMALLEST, gap)
