"""Master curves of measured friction: mu(v, T) over v a_T (K. A. Grosch, Proc. R. Soc.
Lond. A 274 (1963) 21-39).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from scipy.interpolate import BSpline

from ..arrays import one_thread
from ..checks import (
    as_float64,
    broadcast_shape,
    finite,
    in_kelvin,
    in_si,
    positive,
    scalar,
)
from ..errors import InputError
from ..results.axes import Label
from .isotherms import TOLERANCE, alike, group
from .laws import LawFit, fit_laws, locate
from .report import TWO_SIGMA, AbstractFindings, shifts_in_words, tell
from .shifting import LN10, first_slopes, from_slopes, guess_shifts, slope_priors
from .spectrum import STORAGE, MeasuredPoints, Posterior, Prior, infer

if TYPE_CHECKING:
    from jaxtyping import Float, Int
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..material.shift import WLF, Arrhenius

_KNOTS = 2.5  # per decade of velocity
_MARGIN = 2.0  # decades of the curve beyond the data, on either side
_BEND = (1e-4, 1.0)  # limits of the standard deviation of the curve's second difference
# change of friction over all velocities, in standard deviations of the scatter, below
# which none is seen
_FLAT = 6.0
_UNCERTAIN = 0.3  # relative standard deviation of a shift between neighbours


class _Spline(NamedTuple):
    knots: np.ndarray

    @property
    def size(self) -> int:
        return self.knots.size - 4

    def basis(self, log_velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Values and slopes of the cubic basis functions, (points, count)."""
        low, high = self.knots[3], self.knots[-4]
        x = np.clip(log_velocity, low, high)
        spline = BSpline(self.knots, np.eye(self.size), 3)
        return spline(x), spline.derivative()(x)


@dataclass(frozen=True, eq=False, repr=False)
class FrictionMaster(AbstractFindings):
    """Measured friction shifted to one temperature: mu(v; T) = mu(v a_T; T_ref), with
    no vertical shift.
    """

    reference: float  # T_ref [K]
    # mean temperature of each curve, ascending [K]
    temperature: Float[np.ndarray, " n"]
    log10_a: Float[np.ndarray, " n"]  # 0 at the reference temperature [decades]
    log10_a_std: Float[np.ndarray, " n"]
    covariance: Float[np.ndarray, "n n"]  # of log10_a
    laws: dict[str, LawFit]  # "WLF", "Arrhenius", "VFT": those that could be fitted
    velocity: Float[np.ndarray, " m"]  # reduced velocity v a_T [m/s]
    mu: Float[np.ndarray, " m"]  # measured friction coefficient
    number: Int[np.ndarray, " m"]  # number of the temperature of each point
    error: Float[np.ndarray, " m"]  # standard deviation of each measured mu
    warnings: tuple[str, ...]
    converged: bool
    _posterior: Posterior
    _spline: _Spline
    _anchor: float  # log10 a of the reference in the frame of the fit

    @property
    def wlf(self) -> WLF | None:
        """The WLF law (`em.WLF`) about the reference temperature; None where it could
        not be fitted.
        """
        return self.laws["WLF"].law if "WLF" in self.laws else None

    @property
    def arrhenius(self) -> Arrhenius | None:
        """The Arrhenius law (`em.Arrhenius`) about the reference temperature; None
        where it could not be fitted.
        """
        return self.laws["Arrhenius"].law if "Arrhenius" in self.laws else None

    def curve(self, velocity: ArrayLike) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Friction coefficient with its 95 % interval (value, low, high) at reduced
        velocities [m/s] of any shape.

        NaN beyond the measured reduced velocities.
        """
        velocity = as_float64("velocity", velocity)
        positive("velocity", velocity)
        flat = np.atleast_1d(velocity).ravel()
        basis, _ = self._spline.basis(np.log(flat) + LN10 * self._anchor)
        count = self._spline.size
        value = basis @ self._posterior.mean[:count]
        std = np.sqrt(
            np.einsum(
                "ij,jk,ik->i", basis, self._posterior.covariance[:count, :count], basis
            )
        )
        inside = (flat >= self.velocity.min() * (1 - 1e-9)) & (
            flat <= self.velocity.max() * (1 + 1e-9)
        )
        value = np.where(inside, value, np.nan)
        parts = (value, value - TWO_SIGMA * std, value + TWO_SIGMA * std)
        return tuple(bound.reshape(velocity.shape) for bound in parts)  # type: ignore[return-value]

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws the shifted friction with its curve on `ax`, or on a new figure, in a
        style of `Result.plot`; returns matplotlib Axes.
        """
        from ..results.plotting import Shaded, Trace
        from .drawing import DrawnIsotherms, celsius, draw_isotherms, sketch

        made = sketch(
            (
                Label(r"Reduced velocity $v\,a_T$", "m/s"),
                Label("Friction coefficient", "-"),
            ),
            f"Measured friction shifted to {celsius(self.reference)}",
            ax=ax,
            style=style,
        )
        made.ax.set(xscale="log")
        every = [DrawnIsotherms(self.velocity, self.mu, self.number)]
        draw_isotherms(made, self.temperature, None, every)
        v = np.geomspace(self.velocity.min(), self.velocity.max(), 300)
        value, low, high = self.curve(v)
        line = made.add(Trace(v, value, "smooth curve, 95 % band", width=0.67))
        made.add(Shaded(v, low, high, opacity=0.25, of=line))
        return made.finish()

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the shifts, as pairs of a name and a text."""
        yield "reference", f"{self.reference - 273.15:.5g} degC"
        v = np.geomspace(self.velocity.min(), self.velocity.max(), 400)
        value, _, high = self.curve(v)
        top = int(value.argmax())
        yield (
            "largest",
            (
                f"mu = {value[top]:.3g} +- {high[top] - value[top]:.1g} at v a_T = "
                f"{v[top]:.3g} m/s"
            ),
        )
        low, high = self.error.min(), self.error.max()
        yield (
            "scatter",
            f"{low:.2g} in mu"
            if high < 1.01 * low
            else f"{low:.2g} to {high:.2g} in mu",
        )
        yield from shifts_in_words(
            self.temperature, self.log10_a, self.log10_a_std, self.laws
        )
        for warning in self.warnings:
            yield "warning", warning


@in_si
@one_thread()
def friction_master(
    velocity: ArrayLike,
    temperature: ArrayLike,
    mu: ArrayLike,
    reference: float | None = None,
    *,
    error: ArrayLike | None = None,
) -> FrictionMaster:
    """Shifts measured friction mu(v, T) along log v to one smooth curve at one
    reference temperature.

    Args:
        velocity: sliding velocities [m/s], one entry per measured point; arguments
            broadcast.
        temperature: temperatures [K].
        mu: measured friction coefficients.
        reference: reference temperature [K]; by default the measured temperature
            nearest to 20 degC.
        error: standard deviation of a measured mu, one number or one per point. By
            default it is estimated, of one size for all points.

    Returns:
        A `FrictionMaster` with shifts, their uncertainties and the curve.

    Raises:
        InputError: for fewer than two temperatures or eight points, and for a reference
            outside the measured temperatures.

    Source: Grosch 1963.
    """
    given: dict[str, ArrayLike] = {
        "velocity": velocity,
        "temperature": temperature,
        "mu": mu,
    }
    known = error is not None
    if error is not None:
        given["error"] = error
    v, t, friction, *sizes = _checked_data(given)
    number, temperatures = group(t)
    for name, count, least in (
        ("temperature", temperatures.size, 2),
        ("mu", friction.size, 8),
    ):
        if count < least:
            raise InputError(
                argument=name, got=count, accepted=f"{least} values or more"
            )
    reference = _checked_reference(reference, temperatures)
    zero = np.zeros(friction.size)
    points = MeasuredPoints(
        np.full(friction.size, STORAGE), np.log(v), friction, number, zero
    )
    size = sizes[0] if known else np.ones(friction.size)
    fit = _infer(points, temperatures, size, known)
    return _report(points, temperatures, fit, reference, size)


def _checked_data(given: Mapping[str, ArrayLike]) -> list[np.ndarray]:
    """What was measured, one number per point each. Raises `InputError`."""
    arrays = {name: as_float64(name, value) for name, value in given.items()}
    shape = broadcast_shape(arrays)
    for name, array in arrays.items():
        if name in ("velocity", "error"):
            positive(name, array)
    in_kelvin("temperature", arrays["temperature"])
    finite("mu", arrays["mu"])
    return [np.broadcast_to(array, shape).ravel() for array in arrays.values()]


def _checked_reference(reference: float | None, temperatures: np.ndarray) -> float:
    """The reference temperature, by default the one nearest to 20 degC. Raises
    `InputError`.
    """
    if reference is None:
        reference = float(temperatures[np.argmin(np.abs(temperatures - 293.15))])
    reference = float(scalar("reference", reference))
    in_kelvin("reference", reference)
    if not temperatures[0] - TOLERANCE <= reference <= temperatures[-1] + TOLERANCE:
        raise InputError(
            argument="reference",
            got=reference,
            accepted=f"within the measured temperatures, {temperatures[0]:g} to "
            f"{temperatures[-1]:g} K",
        )
    return reference


class _FrictionFit(NamedTuple):
    """Spline and shifts of the curve."""

    posterior: Posterior  # of the coefficients of the spline, then slopes of log10 a_T
    spline: _Spline
    anchor: int  # the isotherm whose log10 a_T is 0


def _infer(
    points: MeasuredPoints, temperatures: np.ndarray, size: np.ndarray, known: bool
) -> _FrictionFit:
    """Spline and slopes; the noise of each point is `size`, times a factor to be found
    where that is not `known`.
    """
    scale = max(float(np.ptp(points.log_value)), 1e-9)
    guess = guess_shifts(
        points._replace(log_value=points.log_value / scale), temperatures
    )
    anchor = temperatures.size // 2
    guess = guess - guess[anchor]
    reduced = points.log_rate + LN10 * guess[points.isotherm]
    spline = _spline_over(reduced)
    count = spline.size

    def model(p: np.ndarray) -> tuple[np.ndarray, Callable[[], np.ndarray]]:
        log10_a, by_slope = from_slopes(p[count:], temperatures, anchor)
        basis, slope = spline.basis(points.log_rate + LN10 * log10_a[points.isotherm])
        sideways = LN10 * (slope @ p[:count])[:, None]

        def jacobian() -> np.ndarray:
            by_shifts = sideways * by_slope[points.isotherm]
            return np.concatenate([basis, by_shifts], axis=1) / size[:, None]

        return basis @ p[:count] / size, jacobian

    every = np.eye(count + temperatures.size - 1)
    second = np.diff(every[:count], 2, axis=0)
    start = np.concatenate(
        [
            _first_coefficients(spline, reduced, points.log_value, second[:, :count]),
            first_slopes(guess, temperatures),
        ]
    )
    priors = [
        Prior(second, 0.1 * scale, (_BEND[0] * scale, _BEND[1] * scale), 0.0, 1.5),
        Prior(every[:count], 10 * scale, None, points.log_value.mean()),
        *slope_priors(every[count:], temperatures),
    ]
    typical = scale / float(np.median(size))
    infer_with = partial(
        infer,
        model,
        points.log_value / size,
        points.channel,
        start,
        priors,
        np.array([1.0 if known else 0.03 * typical]),
        noise_limits=None if known else (1e-5 * typical, typical),
    )
    posterior = infer_with(temper=1.0)
    count_alike = alike(points, posterior.residuals)
    if count_alike > 1:
        posterior = infer_with(temper=count_alike)
    posterior = posterior._replace(residuals=posterior.residuals * size)
    return _FrictionFit(posterior, spline, anchor)


def _spline_over(reduced: np.ndarray) -> _Spline:
    """A spline over the reduced velocities, with a margin."""
    low, high = reduced.min() - _MARGIN * LN10, reduced.max() + _MARGIN * LN10
    inner = np.linspace(low, high, int((high - low) / LN10 * _KNOTS) + 2)
    step = inner[1] - inner[0]
    before, behind = low - step * np.arange(3, 0, -1), high + step * np.arange(1, 4)
    return _Spline(np.concatenate([before, inner, behind]))


def _first_coefficients(
    spline: _Spline, reduced: np.ndarray, mu: np.ndarray, second: np.ndarray
) -> np.ndarray:
    """Coefficients of the spline by least squares, slightly smoothed."""
    basis, _ = spline.basis(reduced)
    ridge = basis.T @ basis + 1e-2 * second.T @ second + 1e-8 * np.eye(spline.size)
    return np.linalg.solve(ridge, basis.T @ mu)


def _report(
    points: MeasuredPoints,
    temperatures: np.ndarray,
    fit: _FrictionFit,
    reference: float,
    size: np.ndarray,
) -> FrictionMaster:
    posterior, spline, anchor = fit
    count = spline.size
    x, by_slope = from_slopes(posterior.mean[count:], temperatures, anchor)
    spread = by_slope @ posterior.covariance[count:, count:] @ by_slope.T
    basis, _ = spline.basis(points.log_rate + LN10 * x[points.isotherm])
    error = posterior.noise[0] * size
    flat = bool(np.ptp(basis @ posterior.mean[:count]) < _FLAT * np.median(error))
    # noise alone makes curves fit each other; the shifts are then those expected
    # beforehand
    if flat:
        spread = spread + np.outer(x, x)
    place = locate(temperatures, x, spread, reference)
    change = np.eye(temperatures.size) - place.weights
    log10_a, covariance = x - place.log10_a, change @ spread @ change.T + place.variance
    master = FrictionMaster(
        reference=reference,
        temperature=temperatures,
        log10_a=log10_a,
        log10_a_std=np.sqrt(np.maximum(np.diag(covariance), 0.0)),
        covariance=covariance,
        laws=fit_laws(temperatures, log10_a, covariance, reference),
        velocity=np.exp(points.log_rate) * 10 ** log10_a[points.isotherm],
        mu=points.log_value,
        number=points.isotherm,
        error=error,
        warnings=tuple(_judge(fit, temperatures - 273.15, x, spread, flat)),
        converged=posterior.converged,
        _posterior=posterior,
        _spline=spline,
        _anchor=place.log10_a,
    )
    tell(master.warnings)
    return master


def _judge(
    fit: _FrictionFit,
    celsius: np.ndarray,
    log10_a: np.ndarray,
    covariance: np.ndarray,
    flat: bool,
) -> Iterator[str]:
    """What cannot be relied on; `flat` where friction changes less over all velocities
    than its scatter can show.
    """
    if not fit.posterior.converged:
        yield "The fit did not converge: look at the figure before using it."
    if flat:
        yield (
            "The friction is too flat against its scatter to see any shift: log10 "
            "a_T is "
            "what is usual of rubber."
        )
        return
    between = np.diff(np.eye(celsius.size), axis=0)
    variance = np.diag(between @ covariance @ between.T)
    std = np.sqrt(np.maximum(variance, 0.0))
    for i in np.flatnonzero(std > _UNCERTAIN * np.abs(np.diff(log10_a))):
        yield (
            f"The shift between {celsius[i]:.4g} and {celsius[i + 1]:.4g} degC is "
            "known "
            f"to +- {TWO_SIGMA * std[i]:.2g} decades only: the friction hardly changes "
            "there, or the curves do not overlap."
        )
