"""How far the temperatures of isotherms are off, by how their shift factors scatter
about a smooth law.

An isotherm that was measured at T + dT has a shift factor that is off by dT d(log10
a_T)/dT, whatever its moduli say. Shift factors x about a WLF law f(T; p) therefore
scatter by

    V(s) = C + s^2 diag(f'(T)^2),
    C what the moduli leave open, s the standard error of a temperature,

and the restricted likelihood of V (Patterson & Thompson 1971: p is found from the same
shift factors) says which s is likely. Before any data s is expected to be that of usual
instruments, half normal with 0.3 K, or, with one chance in three, none that matters: a
thermometer may be off by the same at all temperatures. Its mean square over the
posterior is what enters the uncertainty. Few isotherms leave the expectation as it is,
many a clear answer. Shift factors that follow no WLF law say nothing of thermometers.
"""

import numpy as np

from .laws import MISSES, derivatives, fit_form, forms

# standard error of the temperature of an isotherm, of furnaces with a forced flow of
# gas [K]
USUAL = 0.3
_GRID = np.linspace(0.0, 5.0, 101)  # of s, in usual ones
_OWN = 1e-3  # by how much the best law is off at any rate [decades]


def thermometer(
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
    slope, bends, off, own = _law(temperature, log10_a, covariance, usual)
    if own > MISSES:
        return usual
    scale = usual * _GRID
    chance = np.array([_restricted(covariance, slope * s, bends, off) for s in scale])
    before = np.exp(-0.5 * _GRID**2)
    before[0] = 0.5 * before[1:].sum()
    weight = before * np.exp(chance - chance.max())
    return float(np.sqrt((weight * scale**2).sum() / weight.sum()))


def slopes(temperature: np.ndarray, log10_a: np.ndarray) -> np.ndarray:
    """d(log10 a_T)/dT at each isotherm [1/K]."""
    return np.gradient(log10_a, temperature) if temperature.size > 1 else np.zeros(1)


def _law(
    temperature: np.ndarray, log10_a: np.ndarray, covariance: np.ndarray, usual: float
) -> tuple:
    """Of a WLF law its slopes, its derivatives by its constants and its level, what it
    misses, and by how much that is more than usual thermometers are off.
    """
    centre = temperature.size // 2
    form = forms(float(temperature[centre]), float(temperature[0]))["WLF"]
    change = np.eye(temperature.size)
    change[:, centre] -= 1
    expected = covariance + np.diag((usual * slopes(temperature, log10_a)) ** 2)
    p, _, own = fit_form(
        form, temperature, change @ log10_a, change @ expected @ change.T
    )
    bends = np.column_stack(
        [derivatives(form, p, temperature), np.ones(temperature.size)]
    )
    step = 1e-4
    slope = (form.value(p, temperature + step) - form.value(p, temperature - step)) / (
        2 * step
    )
    return slope, bends, log10_a - form.value(p, temperature), own


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
