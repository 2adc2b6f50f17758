"""Materials drawn from a fit: spectrum and laws of shifts together, as the intervals of
the fit report them.

The unknowns of the joint fit, the errors of the thermometers and the doubts
(`fit/joint.py`) are drawn together. They move the common curve, to which the moduli of
the series follow in least squares, and the shift factors, to which the constants of the
law follow as they did in their fit. The distance between series and curve is one more
direction.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..material.draws import Draws, by_moduli, changed, check_draws, root_of
from ..material.shift import ShiftTable
from ..material.vertical import VerticalTable
from ..trees import replaced
from .joint import moved, sensitivity
from .laws import derivatives, fit_form, forms
from .shifting import LN10
from .spectrum import LOSS, STORAGE

if TYPE_CHECKING:
    from ..material.prony import Prony
    from .pipeline import MaterialFit

_PER_DECADE = 6
# from the reference temperature up to which an isotherm is not in a table beside it [K]
_NEAR = 0.5


def draws(fit: MaterialFit, n: int, seed: int) -> Draws[Prony]:
    """`n` materials, in which everything that the data leave open differs."""
    check_draws(n, seed)
    joint, state = fit.master.joint, fit.master.state
    low, high = np.log(fit.prony.window)
    at = np.linspace(low, high, max(int(_PER_DECADE * (high - low) / LN10), 8))
    curve = sensitivity(
        joint, state, np.tile(at, 2), np.repeat([STORAGE, LOSS], at.size)
    )
    of_a, of_others, of_b = moved(joint, state)
    rng = np.random.default_rng(seed)
    unknowns = (
        rng.standard_normal((n, of_a.shape[1]))
        @ root_of(joint.shifts.posterior.covariance).T
    )
    others = rng.standard_normal((n, of_others.shape[1]))
    off = np.log(np.concatenate(fit.prony.moduli_at(np.exp(at)))) - curve.log_value
    spectrum = (
        unknowns @ curve.by_unknowns.T
        + others @ curve.by_others.T
        + np.outer(rng.standard_normal(n), off)
    )
    log10_a, ln_b = unknowns @ of_a.T + others @ of_others.T, unknowns @ of_b.T
    changes = spectrum @ by_moduli(fit.material, np.exp(at)).T
    shift = _shifts(fit, log10_a, rng)
    each = [
        changed(
            fit.material,
            change,
            i + 1,
            shift=shift(i),
            vertical=_vertical(fit, ln_b[i]),
        )
        for i, change in enumerate(changes)
    ]
    words = "spectrum" + (
        "" if fit.material.shift is None or fit.master.given else " and shift factors"
    )
    return Draws(each, fit.material.name, f"{words}, as the fit leaves them open")


def _shifts(fit: MaterialFit, log10_a: np.ndarray, rng: np.random.Generator) -> Any:
    """A function from the number of a draw to its shift law."""
    own, master = fit.material.shift, fit.master
    if own is None or fit.law == "given":
        return lambda _: own
    if isinstance(own, ShiftTable):
        return lambda i: ShiftTable(own.temperature, _along(fit, own, log10_a[i]))
    reference, temperature = master.reference, master.temperature
    form = forms(reference, float(min(temperature.min(), reference)))[fit.law]
    start, spread, law_own = fit_form(
        form, temperature, master.log10_a, master.covariance
    )
    precision = np.linalg.inv(master.covariance + law_own**2 * np.eye(temperature.size))
    gain = spread @ derivatives(form, start, temperature).T @ precision
    off = log10_a + law_own * rng.standard_normal(log10_a.shape)
    low, high = np.array(form.limits).T
    return lambda i: form.constants(np.clip(start + gain @ off[i], low, high))[0]


def _along(fit: MaterialFit, own: Any, change: np.ndarray) -> np.ndarray:
    """The shift factors of a table with their changes, zero at the reference
    temperature, falling.
    """
    at = np.asarray(own.temperature)
    away = np.abs(fit.master.temperature - fit.master.reference) > _NEAR
    x = np.append(fit.master.temperature[away], fit.master.reference)
    order = np.argsort(x)
    moved = np.asarray(own.log10_a_table) + np.interp(
        at, x[order], np.append(change[away], 0.0)[order]
    )
    return np.minimum.accumulate(moved)


def _vertical(fit: MaterialFit, change: np.ndarray) -> Any:
    """The vertical shifts with their changes; those of entropy elasticity have no
    constant that could differ.
    """
    own = fit.material.vertical
    if not isinstance(own, VerticalTable):
        return own
    # A modulus at T is that of the common curve over exp(ln b).
    return replaced(
        own,
        factor=np.asarray(own.factor)
        * np.exp(-np.interp(own.temperature, fit.master.temperature, change)),
    )
