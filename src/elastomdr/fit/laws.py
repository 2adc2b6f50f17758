"""Shift laws: WLF, Arrhenius and VFT through shift factors, the place of a reference
temperature, the error of the measured temperatures, and laws that the user gives.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.optimize import least_squares

from ..checks import significant
from ..errors import InputError, advise
from ..io.data import Dma
from ..material.shift import (
    GAS_CONSTANT,
    VFT,
    WLF,
    AbstractShift,
    Arrhenius,
    ShiftTable,
)
from .spectrum import closest_passive

if TYPE_CHECKING:
    from jaxtyping import Float

# --------------------------------------------------------------------------------------
# WLF, Arrhenius and VFT laws through measured shift factors.
# --------------------------------------------------------------------------------------

_LN10 = float(np.log(10.0))
_LEAST = 0.003  # standard deviation by which any such law may be off [decades]
POLE = 1.0  # least distance of a law's pole below the data [K]
_AT_BOUND = 0.01  # distance of a logarithm from its limit at which it is held by it
# error of its own above which a law is not that of the shift factors [decades]
MISSES = 0.1


class LawFit(NamedTuple):
    """A shift law, how far each measured shift factor is from it, and how well its
    constants are known.
    """

    law: Any  # em.WLF, em.Arrhenius or em.VFT
    residuals: Float[np.ndarray, " n"]  # log10 a_T measured minus law [decades]
    std: dict[str, float]  # standard deviation of each constant, in its unit
    # whether a constant is at the end of what the search allows, so that its
    # uncertainty means nothing
    bound: bool
    # how far the law is off beyond what the shift factors are known to, a standard
    # deviation [decades]
    law_error: float

    @property
    def rms(self) -> float:
        """Root mean square of the residuals [decades]."""
        return float(np.sqrt(np.mean(self.residuals**2)))

    @property
    def holds(self) -> bool:
        """Whether the shift factors follow the law, within what they are known to."""
        return self.law_error <= MISSES

    @property
    def determined(self) -> bool:
        """Whether the data know every constant better than by its own size."""
        return (
            all(
                1.96 * std < float(getattr(self.law, key))
                for key, std in self.std.items()
            )
            and not self.bound
        )

    def constants(self) -> str:
        """The constants with their units and 95 % intervals, in one line, or that the
        data do not determine them.
        """
        units = {"c1": "", "c2": " K", "energy": " J/mol", "b": " K", "t0": " K"}
        if not self.determined:
            return f"{' and '.join(self.std)} not determined by these data"
        return ", ".join(
            f"{key} {float(getattr(self.law, key)):.4g} +- {1.96 * std:.2g}{units[key]}"
            for key, std in self.std.items()
        )


def fit_laws(
    temperature: np.ndarray,
    log10_a: np.ndarray,
    covariance: np.ndarray,
    reference: float,
) -> dict[str, LawFit]:
    """The laws that pass through 0 at `reference` [K] and come closest to shift factors
    with this covariance.

    A law may be off by more than the measurement: a part of its own is added to the
    covariance until the misfit is what it should be. "Arrhenius" needs two
    temperatures, "WLF" and "VFT" three; laws that cannot be fitted are left out.
    """
    fits: dict[str, LawFit] = {}
    known = forms(reference, min(temperature.min(), reference))
    if temperature.size < 2 or (np.abs(temperature - reference) > 1e-6).sum() < 1:
        return fits
    for name in (
        ("Arrhenius", "WLF", "VFT") if temperature.size >= 3 else ("Arrhenius",)
    ):
        p, spread, misfit = fit_form(known[name], temperature, log10_a, covariance)
        law, by_p = known[name].constants(p)
        std = {
            key: float(abs(slope) * np.sqrt(spread[k, k]))
            for k, (key, slope) in enumerate(by_p.items())
        }
        residuals = log10_a - known[name].value(p, temperature)
        fits[name] = LawFit(law, residuals, std, _at_bound(known[name], p), misfit)
    return fits


class LawForm(NamedTuple):
    """A law in parameters that may take any value."""

    value: Callable[[np.ndarray, Any], Any]  # parameters, temperature [K] -> log10 a_T
    start: list[float]
    limits: list[tuple[float, float]]
    # the law, d(constant)/d(its parameter) by name
    constants: Callable[[np.ndarray], tuple[Any, dict[str, float]]]


def forms(reference: float, lowest: float) -> dict[str, LawForm]:
    """The laws about `reference` [K]; their poles are below `lowest` [K]."""
    room = reference - lowest + POLE

    def wlf(p: np.ndarray, temperature: float | np.ndarray) -> Any:
        above = temperature - reference
        return -np.exp(p[0]) * above / (room + np.exp(p[1]) + above)

    def vft(p: np.ndarray, temperature: float | np.ndarray) -> Any:
        t0 = (lowest - POLE) / (1 + np.exp(-p[1]))
        return np.exp(p[0]) * (1 / (temperature - t0) - 1 / (reference - t0)) / _LN10

    def arrhenius(p: np.ndarray, temperature: float | np.ndarray) -> Any:
        return np.exp(p[0]) / GAS_CONSTANT * (1 / temperature - 1 / reference) / _LN10

    def wlf_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        c1, gap = float(np.exp(p[0])), float(np.exp(p[1]))
        return WLF(c1, room + gap, reference), {"c1": c1, "c2": gap}

    def vft_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        b, share = float(np.exp(p[0])), float(1 / (1 + np.exp(-p[1])))
        return VFT(b, (lowest - POLE) * share, reference), {
            "b": b,
            "t0": (lowest - POLE) * share * (1 - share),
        }

    def arrhenius_constants(p: np.ndarray) -> tuple[Any, dict[str, float]]:
        energy = float(np.exp(p[0]))
        return Arrhenius(energy, reference), {"energy": energy}

    return {
        "Arrhenius": LawForm(
            arrhenius, [float(np.log(1e5))], [(5.0, 16.0)], arrhenius_constants
        ),
        "WLF": LawForm(wlf, [2.0, 4.0], [(-4.0, 8.0), (-3.0, 9.0)], wlf_constants),
        "VFT": LawForm(vft, [7.0, 0.5], [(2.0, 14.0), (-8.0, 8.0)], vft_constants),
    }


def _at_bound(form: LawForm, p: np.ndarray) -> bool:
    low, high = np.array(form.limits).T
    return bool(((p - low < _AT_BOUND) | (high - p < _AT_BOUND)).any())


def fit_form(
    form: LawForm, temperature: np.ndarray, value: np.ndarray, covariance: np.ndarray
) -> tuple[np.ndarray, np.ndarray, float]:
    """Generalised least squares, with the law's own error grown until chi squared
    matches the freedom left.

    Returns the parameters, their covariance, and that error [decades].
    """
    misfit, p = _LEAST, np.array(form.start)
    bounds = np.array(form.limits).T
    spread = np.eye(p.size)
    for _ in range(8):
        white = np.linalg.inv(
            np.linalg.cholesky(covariance + misfit**2 * np.eye(value.size))
        )
        answer = least_squares(
            lambda p, white=white: white @ (value - form.value(p, temperature)),
            p,
            lambda p, white=white: -white @ derivatives(form, p, temperature),  # pyright: ignore[reportArgumentType]
            bounds=bounds,
            x_scale=1.0,
        )
        p = answer.x
        spread = np.linalg.pinv(answer.jac.T @ answer.jac)
        excess = 2 * answer.cost / max(value.size - p.size, 1)
        if excess <= 1.2:
            break
        misfit *= min(np.sqrt(excess), 4.0)
    return p, spread, float(misfit)


def derivatives(form: LawForm, p: np.ndarray, temperature: np.ndarray) -> np.ndarray:
    """The derivatives of a law with respect to its parameters, from a step along the
    imaginary axis: exact.
    """
    step = 1e-30
    return (
        np.stack(
            [
                form.value(p + 1j * step * row, temperature).imag
                for row in np.eye(p.size)
            ],
            axis=1,
        )
        / step
    )


# --------------------------------------------------------------------------------------
# Where a reference temperature lies among the isotherms: log10 a_T of it, and what is
# known of that.
#
# Between isotherms a law bends the straight line between neighbours; beyond them it
# carries on from the last isotherm,
#
#     x(T_ref) = sum_i w_i x_i + f(T_ref; p) - sum_i w_i f(T_i; p),     x = log10 a_T,
#
# f the WLF law (Arrhenius' through two isotherms), p its parameters by generalised least
# squares, w the weights of linear interpolation. p is made of the same x_i: their
# covariance passes through it. What the law is off by at the isotherms, and what
# Arrhenius' law would say instead with the weight that the data leave to it, come on top
# beyond the data.
# --------------------------------------------------------------------------------------

# half a 95 % interval of an extrapolated log10 a_T above which it is refused [decades]
_FARTHEST = 2.0
_STRANGE = 100.0  # distance of a reference that makes one think of a unit mixed up [K]
# of rubbers, below the coldest of two isotherms, which leave it open [K]
_USUAL_POLE = 150.0


class ReferencePlace(NamedTuple):
    """The state at a reference temperature, seen from the isotherms."""

    # of the reference temperature, in the frame of the isotherms' shifts [decades]
    log10_a: float
    weights: np.ndarray  # its derivatives by the isotherms' log10 a_T
    # weights of linear interpolation, all on the last isotherm beyond the ends
    near: np.ndarray
    # of log10_a beyond what follows from the weights: the law's own [decades^2]
    variance: float
    # half a 95 % interval of the step from the last isotherm, where it is extrapolated
    # [decades], or 0
    half: float


def locate(
    temperature: np.ndarray,
    log10_a: np.ndarray,
    covariance: np.ndarray,
    reference: float,
) -> ReferencePlace:
    """log10 a_T at `reference` [K] from that of isotherms at ascending temperatures
    [K], with its uncertainty.

    Raises `InputError` for a reference temperature so far outside that the law cannot
    carry the isotherms there: at or below its pole, or where the step from the last
    isotherm is not known to a factor of 100.
    """
    n, near = temperature.size, _interpolation(temperature, reference)
    centre = int(np.argmin(np.abs(temperature - reference)))
    distance = float(abs(temperature[centre] - reference))
    if n == 1 or distance < 1e-9:  # there is nothing to bend
        return ReferencePlace(float(near @ log10_a), near, near, 0.0, 0.0)
    change = np.eye(n)
    change[:, centre] -= 1
    value, spread = change @ log10_a, change @ covariance @ change.T
    known = forms(float(temperature[centre]), float(temperature[0]))
    form = known["WLF" if n > 2 else "Arrhenius"]
    p, of_p, misfit = fit_form(form, temperature, value, spread)
    precision = np.linalg.inv(spread + misfit**2 * np.eye(n))

    def bend(form: LawForm, p: np.ndarray) -> float:
        return float(form.value(p, reference) - near @ form.value(p, temperature))

    located = float(near @ log10_a) + bend(form, p)
    by_p = derivatives(form, p, np.array([reference]))[0] - near @ derivatives(
        form, p, temperature
    )
    by_value = by_p @ of_p @ derivatives(form, p, temperature).T @ precision
    weights = near + by_value @ change
    if temperature[0] <= reference <= temperature[-1]:
        return ReferencePlace(located, weights, near, 0.0, 0.0)
    if n > 2:
        arrhenius = known["Arrhenius"]
        q = fit_form(arrhenius, temperature, value, spread)[0]
        chance = _chance(
            value - arrhenius.value(q, temperature),
            value - form.value(p, temperature),
            precision,
        )
        difference = bend(arrhenius, q) - bend(form, p)
    else:
        pole = temperature[0] - _USUAL_POLE
        rise = 1 / (np.append(temperature, reference) - pole)
        difference = (value[1] - value[0]) * (rise[2] - near @ rise[:2]) / (
            rise[1] - rise[0]
        ) - bend(form, p)
        chance = 1.0
    # the law's own error grows as isotherms are away
    steps = distance / float(np.diff(temperature).mean())
    variance = (misfit * steps) ** 2 * (
        1 + float(by_value @ by_value)
    ) + chance * difference**2
    step = weights - np.eye(n)[centre]
    half = 1.96 * float(np.sqrt(max(step @ covariance @ step, 0.0) + variance))
    pole = float(temperature[0]) - float(np.exp(p[1])) - POLE if n > 2 else 0.0
    _check_reach(temperature, reference, distance, pole, half)
    return ReferencePlace(located, weights, near, variance, half)


def _chance(arrhenius: np.ndarray, other: np.ndarray, precision: np.ndarray) -> float:
    """Of Arrhenius' law against one with a parameter more, from what both leave."""
    # Akaike: a parameter costs 2
    worse = arrhenius @ precision @ arrhenius - other @ precision @ other - 2.0
    return float(1 / (1 + np.exp(np.clip(worse / 2, -50, 50))))


def _check_reach(
    temperature: np.ndarray, reference: float, distance: float, pole: float, half: float
) -> None:
    """Raises `InputError` for a reference temperature that the law cannot reach from
    the isotherms.
    """
    if reference > pole and half < _FARTHEST:
        return
    why = (
        f"with +- {half:.2g} decades only"
        if reference > pole
        else f"past its pole, {pole - 273.15:.4g} degC"
    )
    hint = "; check the units of temperature" if distance > _STRANGE else ""
    low, high = temperature[0] - 273.15, temperature[-1] - 273.15
    raise InputError(
        argument="reference",
        got=reference,
        accepted=f"within reach of the data, {low:.4g} to {high:.4g} degC, in kelvin",
        hint=f"the law of the shift factors would have to carry {distance:.3g} K "
        f"beyond them {why}{hint}",
    )


def of_law(log10_a: float, temperature: np.ndarray, reference: float) -> ReferencePlace:
    """The place of a reference temperature that a given law has at `log10_a`: nothing
    about it is uncertain.
    """
    near = _interpolation(temperature, reference)
    return ReferencePlace(log10_a, near, near, 0.0, 0.0)


def _interpolation(temperature: np.ndarray, reference: float) -> np.ndarray:
    """Weights of linear interpolation between neighbours, all on the last isotherm
    beyond the ends.
    """
    n = temperature.size
    weights = np.zeros(n)
    place = np.interp(reference, temperature, np.arange(n))
    low = min(int(place), max(n - 2, 0))
    weights[low] = 1 - (place - low)
    if n > 1:
        weights[low + 1] = place - low
    return weights


# --------------------------------------------------------------------------------------
# How far the temperatures of isotherms are off, by how their shift factors scatter
# about a smooth law.
#
# An isotherm that was measured at T + dT has a shift factor that is off by dT d(log10
# a_T)/dT, whatever its moduli say. Shift factors x about a WLF law f(T; p) therefore
# scatter by
#
#     V(s) = C + s^2 diag(f'(T)^2),
#     C what the moduli leave open, s the standard error of a temperature,
#
# and the restricted likelihood of V (Patterson & Thompson 1971: p is found from the same
# shift factors) says which s is likely. Before any data s is expected to be that of usual
# instruments, half normal with 0.3 K, or, with one chance in three, none that matters: a
# thermometer may be off by the same at all temperatures. Its mean square over the
# posterior is what enters the uncertainty. Few isotherms leave the expectation as it is,
# many a clear answer. Shift factors that follow no WLF law say nothing of thermometers.
# --------------------------------------------------------------------------------------

# standard error of the temperature of an isotherm, of furnaces with a forced flow of
# gas [K]
USUAL = 0.3
_GRID = np.linspace(0.0, 5.0, 101)  # of s, in usual ones
_OWN = 1e-3  # by how much the best law is off at any rate [decades]


def temperature_error(
    temperature: np.ndarray,
    log10_a: np.ndarray,
    covariance: np.ndarray,
    usual: float = USUAL,
) -> float:
    """The standard error of an isotherm's temperature [K]: the root of its mean square
    over the posterior.

    `log10_a` at ascending temperatures [K], with the `covariance` that it has without
    such an error.
    """
    if temperature.size < 4:
        return usual
    law = _law(temperature, log10_a, covariance, usual)
    if law.misfit > MISSES:
        return usual
    scale = usual * _GRID
    chance = np.array(
        [_restricted(covariance, law.slope * s, law.bends, law.off) for s in scale]
    )
    before = np.exp(-0.5 * _GRID**2)
    before[0] = 0.5 * before[1:].sum()
    weight = before * np.exp(chance - chance.max())
    return float(np.sqrt((weight * scale**2).sum() / weight.sum()))


def slopes(temperature: np.ndarray, log10_a: np.ndarray) -> np.ndarray:
    """d(log10 a_T)/dT at each isotherm [1/K]."""
    return np.gradient(log10_a, temperature) if temperature.size > 1 else np.zeros(1)


class _FittedWlf(NamedTuple):
    slope: np.ndarray  # d(log10 a_T)/dT at each isotherm [1/K]
    bends: np.ndarray  # derivatives by its constants and its level
    off: np.ndarray  # what it misses [decades]
    misfit: float  # by how much that is more than usual thermometers are off


def _law(
    temperature: np.ndarray, log10_a: np.ndarray, covariance: np.ndarray, usual: float
) -> _FittedWlf:
    centre = temperature.size // 2
    form = forms(float(temperature[centre]), float(temperature[0]))["WLF"]
    change = np.eye(temperature.size)
    change[:, centre] -= 1
    expected = covariance + np.diag((usual * slopes(temperature, log10_a)) ** 2)
    p, _, misfit = fit_form(
        form, temperature, change @ log10_a, change @ expected @ change.T
    )
    bends = np.column_stack(
        [derivatives(form, p, temperature), np.ones(temperature.size)]
    )
    step = 1e-4
    slope = (form.value(p, temperature + step) - form.value(p, temperature - step)) / (
        2 * step
    )
    off = log10_a - form.value(p, temperature)
    return _FittedWlf(slope, bends, off, misfit)


def _restricted(
    covariance: np.ndarray, thermal: np.ndarray, bends: np.ndarray, off: np.ndarray
) -> float:
    """ln of the restricted likelihood of residuals `off`, after a fit with the
    derivatives `bends`.
    """
    whole = covariance + np.diag(thermal**2 + _OWN**2)
    inverse = np.linalg.inv(whole)
    by_law = inverse @ bends
    normal = bends.T @ by_law
    left = off @ inverse @ off - off @ by_law @ np.linalg.solve(normal, by_law.T @ off)
    return -0.5 * float(
        np.linalg.slogdet(whole)[1] + np.linalg.slogdet(normal)[1] + left
    )


# --------------------------------------------------------------------------------------
# Shift laws that the user brings: a law, factors shifted by hand, or the universal law
# of Williams, Landel and Ferry.
#
# The universal law is log10 a_T = -17.44 (T - T_g)/(51.6 K + T - T_g). A material that is
# passive has a storage modulus that rises with frequency as its loss modulus demands: a
# sweep of temperature at one frequency therefore tells how fast a_T falls, and T_g is
# where the closest passive material (`closest_passive`) is closest.
# --------------------------------------------------------------------------------------

UNIVERSAL = 17.44, 51.6  # of C1 and C2 [K] about T_g (Williams, Landel & Ferry 1955)
_STEP = 1.0  # between the T_g that are tried [K],
_COLDEST = 80.0  # from so far below the data on [K]
_POLE = 1.0  # least distance of the data from the law's pole [K]
# rms relative misfit of the closest passive material above which the law is not that of
# the data
_MISFIT = 0.3
_MOST = 80  # points that are looked at
# by how much data may lie beyond a table [K]: its temperatures are rounded ones
_BEYOND = 3.0


def given_law(shift: object, dma: Dma) -> tuple[AbstractShift | None, str]:
    """The law that a user gives, and where it comes from in words; (None, "") for None.

    Raises `InputError` for what is no law, and for "universal" where the data show no
    peak of the loss modulus.
    """
    if shift is None:
        return None, ""
    if isinstance(shift, AbstractShift):
        return shift, "as given"
    if isinstance(shift, str) and shift == "universal":
        glass = _glass_temperature(dma)
        reference = (
            f"T_g = {glass - 273.15:.3g} degC, where storage and loss modulus suit "
            "each other best"
        )
        return WLF(
            *UNIVERSAL, round(glass, 1)
        ), f"estimated: universal constants about {reference}"
    raise InputError(
        argument="shift",
        got=shift,
        accepted="a shift law (em.WLF, Arrhenius, VFT, ShiftTable, or em.read_shifts "
        "of a file) or 'universal'",
    )


def log10_a(law: AbstractShift, temperature: np.ndarray) -> np.ndarray:
    """log10 a_T at temperatures [K]; a table goes on straight by some kelvin, since its
    temperatures are rounded.
    """
    temperature = np.asarray(temperature, dtype=float)
    if not isinstance(law, ShiftTable):
        return np.asarray(law.log10_a(temperature))
    known, slopes = np.asarray(law.temperature), np.asarray(law.slopes)
    inside = np.clip(temperature, known[0], known[-1])
    beyond = temperature - inside
    if (np.abs(beyond) > _BEYOND).any():
        far = temperature[np.abs(beyond).argmax()]
        raise InputError(
            argument="shift",
            got=law,
            accepted=f"known at the temperatures of the data, {far:.5g} K",
            hint=f"its table has {known[0]:.5g} to {known[-1]:.5g} K",
        )
    return np.asarray(law.log10_a(inside)) + beyond * np.where(
        beyond < 0, slopes[0], slopes[-1]
    )


def law_about(
    law: AbstractShift, reference: float, ends: tuple[float, float]
) -> AbstractShift:
    """The same law about another reference temperature; a table has entries there and
    at the `ends` of the data [K].
    """
    if isinstance(law, WLF):
        return law.at_reference(reference)
    if isinstance(law, VFT):
        return VFT(law.b, law.t0, reference)
    if isinstance(law, Arrhenius):
        return Arrhenius(law.energy, reference)
    known = np.asarray(law.temperature)  # pyright: ignore[reportAttributeAccessIssue]
    more = [
        degrees
        for degrees in (reference, *ends)
        if np.abs(known - degrees).min() > 1e-6
    ]
    inside = [
        degrees
        for degrees in more
        if degrees == reference or not known[0] < degrees < known[-1]
    ]
    every = np.unique(np.append(known, inside))
    value = log10_a(law, every) - log10_a(law, np.array([reference]))
    return ShiftTable(every, np.minimum.accumulate(value))


def words(law: AbstractShift) -> str:
    """A law in a few words."""
    if isinstance(law, ShiftTable):
        known = np.asarray(law.temperature) - 273.15
        return f"table of {known.size} factors, {known[0]:.4g} to {known[-1]:.4g} degC"
    constants = [
        f"{name} = {significant(float(getattr(law, name)), 4)}"
        for name in law.__dataclass_fields__
    ]
    return f"{type(law).__name__}({', '.join(constants)})"


def _glass_temperature(dma: Dma) -> float:
    """T_g [K] of the universal law with which storage and loss modulus are closest to
    those of a passive material.
    """
    if not dma.omega.size:
        raise InputError(
            argument="shift",
            got="universal",
            accepted="a law for data in time, such as em.WLF(17.44, 51.6, T_g)",
            hint="T_g cannot be found from them",
        )
    order = np.argsort(dma.temperature, kind="stable")
    sample = order[np.linspace(0, order.size - 1, min(order.size, _MOST)).astype(int)]
    coldest = float(dma.temperature.min())
    value = np.log(np.concatenate([dma.storage[sample], dma.loss[sample]]))
    tried = np.arange(coldest - _COLDEST, coldest + UNIVERSAL[1] - _POLE, _STEP)
    misfits = np.full(tried.size, np.inf)
    for i, degrees in enumerate(tried):
        rate = np.log(dma.omega[sample]) + np.log(10) * log10_a(
            WLF(*UNIVERSAL, degrees), dma.temperature[sample]
        )
        closest = closest_passive(
            np.tile(rate, 2), value, np.arange(2 * sample.size) < sample.size
        )
        misfits[i] = np.inf if closest is None else closest.misfit
    best = int(misfits.argmin())
    if not misfits[best] < _MISFIT or best in (0, tried.size - 1):
        raise InputError(
            argument="shift",
            got="universal",
            accepted="a law with its reference temperature for these data",
            hint="storage and loss modulus suit the universal law with no T_g: give "
            + advise("em.WLF(17.44, 51.6, T_g)", {"shift": "WLF(17.44, 51.6, -50degC)"})
            + " with T_g of the material",
        )
    near = slice(best - 1, best + 2)
    curve = np.polyfit(tried[near] - tried[best], misfits[near], 2)
    return float(
        tried[best] - np.clip(curve[1] / (2 * curve[0]), -_STEP, _STEP)
        if curve[0] > 0
        else tried[best]
    )
