"""Where a reference temperature lies among the isotherms: log10 a_T of it, and what is
known of that.

Between isotherms a law bends the straight line between neighbours; beyond them it
carries on from the last isotherm,

    x(T_ref) = sum_i w_i x_i + f(T_ref; p) - sum_i w_i f(T_i; p),     x = log10 a_T,

f the WLF law (Arrhenius' through two isotherms), p its parameters by generalised least
squares, w the weights of linear interpolation. p is made of the same x_i: their
covariance passes through it. What the law is off by at the isotherms, and what
Arrhenius' law would say instead with the weight that the data leave to it, come on top
beyond the data.
"""

from typing import NamedTuple

import numpy as np

from ..errors import InputError
from .laws import POLE, Form, derivatives, fit_form, forms

# half a 95 % interval of an extrapolated log10 a_T above which it is refused [decades]
_FARTHEST = 2.0
_STRANGE = 100.0  # distance of a reference that makes one think of a unit mixed up [K]
# of rubbers, below the coldest of two isotherms, which leave it open [K]
_USUAL_POLE = 150.0


class Place(NamedTuple):
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
) -> Place:
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
        return Place(float(near @ log10_a), near, near, 0.0, 0.0)
    change = np.eye(n)
    change[:, centre] -= 1
    value, spread = change @ log10_a, change @ covariance @ change.T
    known = forms(float(temperature[centre]), float(temperature[0]))
    form = known["WLF" if n > 2 else "Arrhenius"]
    p, of_p, own = fit_form(form, temperature, value, spread)
    precision = np.linalg.inv(spread + own**2 * np.eye(n))

    def bend(form: Form, p: np.ndarray) -> float:
        return float(form.value(p, reference) - near @ form.value(p, temperature))

    at = float(near @ log10_a) + bend(form, p)
    by_p = derivatives(form, p, np.array([reference]))[0] - near @ derivatives(
        form, p, temperature
    )
    by_value = by_p @ of_p @ derivatives(form, p, temperature).T @ precision
    weights = near + by_value @ change
    if temperature[0] <= reference <= temperature[-1]:
        return Place(at, weights, near, 0.0, 0.0)
    arrhenius = known["Arrhenius"]
    if n > 2:
        q = fit_form(arrhenius, temperature, value, spread)[0]
        off = [
            value - one.value(parameters, temperature)
            for one, parameters in ((arrhenius, q), (form, p))
        ]
        # Akaike: a parameter costs 2
        worse = off[0] @ precision @ off[0] - off[1] @ precision @ off[1] - 2.0
        chance = 1 / (1 + np.exp(np.clip(worse / 2, -50, 50)))
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
    variance = (own * steps) ** 2 * (
        1 + float(by_value @ by_value)
    ) + chance * difference**2
    step = weights - np.eye(n)[centre]
    half = 1.96 * float(np.sqrt(max(step @ covariance @ step, 0.0) + variance))
    pole = float(temperature[0]) - float(np.exp(p[1])) - POLE if n > 2 else 0.0
    if reference <= pole or not half < _FARTHEST:
        why = (
            f"with +- {half:.2g} decades only"
            if reference > pole
            else f"past its pole, {pole - 273.15:.4g} degC"
        )
        raise InputError(
            "reference must be within reach of the data, "
            f"{temperature[0] - 273.15:.4g} to {temperature[-1] - 273.15:.4g} degC, "
            f"got {reference - 273.15:.4g} degC: the law of the shift factors would "
            f"have to carry {distance:.3g} K beyond them "
            f"{why}.{' Are the units of temperature right?' if distance > _STRANGE else ''}"
        )
    return Place(at, weights, near, variance, half)


def of_law(log10_a: float, temperature: np.ndarray, reference: float) -> Place:
    """The place of a reference temperature that a given law has at `log10_a`: nothing
    about it is uncertain.
    """
    near = _interpolation(temperature, reference)
    return Place(log10_a, near, near, 0.0, 0.0)


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
