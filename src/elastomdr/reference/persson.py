"""Persson's theory of rubber friction on a self-affine or measured surface, to lay
beside the line's answer.

    mu = (1/2) int q^3 C(q) S(q) P(q) dq int_0^2pi cos(phi) Im E*(q v cos phi)/p dphi,
    P = erf(1/(2 sqrt G)),     S = gamma + (1 - gamma) P^2,
    G(q) = (1/8) int_q_low^q k^3 C(k) [S(k)] dk int_0^2pi |E*(k v cos phi)/p|^2 dphi,

E* the half-space's E/(1 - nu^2), C the two-dimensional spectrum. P(q) is the apparent
share of contact seen at wave number q. In Persson 2001 G has no S. Later work reduces
the stored energy by S there too: `stored=True`; P(q) then follows from the part of the
spectrum below q. Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; Scaraggi and
Persson, J. Phys.: Condens. Matter 27 (2015) 105102.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.special import erf

from ..checks import as_float64, broadcast_shape, in_float64, plain, positive, require
from ..element.law import surface_foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..material.tabulated import LEFT_OUT, AbstractTable
from ..results.curve import PerssonCurve
from ..results.words import brief
from ..surface.spectrum import as_spectrum
from .points import NOT_COMPARED

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Material
    from ..surface.spectrum import AbstractSpectrum

# nodes of the midpoint rule in log tan(phi/2), which converges exponentially
_ANGLES = 48
_PER_DECADE = 200  # wave numbers per decade, Simpson's rule
# of log q: the longest of the pieces that begin at q_low, and how often it is halved
_FIRST, _HALVINGS = 0.5, 30
# relative change by half the nodes, from which a point counts as not converged
_WORST = 1e-3


@in_float64
def persson(
    material: Material,
    spectrum: AbstractSpectrum,
    *,
    pressure: ArrayLike,
    velocity: ArrayLike,
    temperature: ArrayLike | None = None,
    gamma: Number = 0.5,
    stored: bool = False,
) -> PerssonCurve:
    """Friction and real contact of a rough surface by Persson's theory, for comparison
    with `em.Multiscale`.

    Args:
        material: a material, which may be a `TabulatedModulus`, or a half-space.
        spectrum: the surface, such as `em.SelfAffine` or `em.Spectrum`.
        pressure: nominal pressure [Pa]; arguments broadcast.
        velocity: sliding velocity [m/s].
        temperature: temperature [K], for a material with a shift law.
        gamma: of the factor S = gamma + (1 - gamma) P^2, 0 to 1; 1 for S = 1.
        stored: S also inside the integral for the contact area.

    Returns:
        A curve with mu and the share of real contact.
        `em.reference.persson(...).plot(curve.plot())` draws it on the axes of another
        curve. `error` is what half the wave numbers and half the angles would change,
        and for a table of moduli half of what leaving out every second of its points
        changes. A point where it is more than a thousandth of mu is NaN.

    Raises:
        InputError: for values that are not positive, or gamma outside 0 to 1.

    Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840.
    """
    foundation, surface = (
        surface_foundation(material),
        as_spectrum("spectrum", spectrum),
    )
    if foundation.per_area:
        raise InputError("material must be a half-space, got a layer.")
    gamma = plain("gamma", gamma)
    require("gamma", gamma, "from 0 to 1", lambda x: (x >= 0) & (x <= 1))
    velocity, pressure = (
        as_float64("velocity", velocity),
        as_float64("pressure", pressure),
    )
    positive("velocity", velocity)
    positive("pressure", pressure)
    broadcast_shape(velocity=velocity, pressure=pressure, temperature=temperature)
    factor, vertical = np.ones(()), np.ones(())
    if temperature is not None:
        factor, vertical = thermal_factors(
            foundation, as_float64("temperature", temperature)
        )
    v, p, a, b = np.broadcast_arrays(velocity, pressure, factor, vertical)

    def solved(rubber: Any, part: int) -> np.ndarray:
        """mu, area and G of every point, with one `part`-th of the wave numbers and
        angles.
        """
        return np.array(
            [
                _one(
                    rubber,
                    *_wave_numbers(surface, _PER_DECADE // part),
                    _ANGLES // part,
                    x * y,
                    z,
                    gamma,
                    stored,
                )
                for x, y, z in zip(v.flat, a.flat, (p / b).flat, strict=True)
            ]
        )

    fine, coarse = solved(foundation, 1), solved(foundation, 2)
    mu, area, spread = (fine[:, i].reshape(v.shape) for i in range(3))
    error = np.abs(fine[:, 0] - coarse[:, 0]).reshape(v.shape)
    good = np.isfinite(mu) & (error <= _WORST * mu)
    if isinstance(foundation, AbstractTable):
        changes = [
            np.abs(solved(thin, 2)[:, 0] - coarse[:, 0])
            for thin in foundation.thinned()
        ]
        error = error + LEFT_OUT * np.max(changes, axis=0).reshape(v.shape)
    mu, area, spread, error = (
        np.where(good, x, np.nan) for x in (mu, area, spread, error)
    )
    inputs = [
        ("material", foundation.name or "given directly"),
        ("surface", f"{surface.label}, {surface.words()}"),
        ("pressure", brief(pressure, "Pa")),
        ("velocity", brief(velocity, "m/s")),
    ]
    if temperature is not None:
        inputs.append(("temperature", brief(temperature, "K")))
        temperature = np.broadcast_to(
            np.asarray(temperature, dtype=float), v.shape
        ).copy()
    where = "in mu and in G" if stored else "in mu"
    return PerssonCurve(
        velocity=v.copy(),
        mu=mu,
        area_ratio=area,
        spread=spread,
        pressure=p.copy(),
        error=error,
        converged=good,
        temperature=temperature,
        model=f"Persson's theory, S with gamma = {gamma:g} {where}",
        plan=(
            f"{_PER_DECADE} wave numbers per decade, {_ANGLES} angles, and half as "
            "many of each for the error"
        ),
        inputs=(*inputs, NOT_COMPARED),
    )


def _wave_numbers(surface: Any, per_decade: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes in pieces of even steps of log q, with C; an even number of steps in each
    piece of the table.

    G starts from zero at q_low, and P falls from 1 as soon as G is about 0.1, in light
    contact at once: towards q_low the pieces become ever shorter.
    """
    first = surface.q[0] * np.exp(_FIRST * 0.5 ** np.arange(_HALVINGS, -1.0, -1.0))
    ends = np.concatenate([surface.q[:1], first[first < surface.q[1]], surface.q[1:]])
    pieces = []
    for low, high in itertools.pairwise(ends):
        steps = 2 * max(
            per_decade // 20, int(np.ceil(0.5 * per_decade * np.log10(high / low)))
        )
        pieces.append(low * (high / low) ** np.linspace(0, 1, steps + 1))
    q = np.concatenate([pieces[0], *(piece[1:] for piece in pieces[1:])])
    return q, surface.at(np.clip(q, surface.q[0], surface.q[-1]))


def _one(
    foundation, q, c, angles, velocity, pressure, gamma, stored
) -> tuple[float, float, float]:
    """One point; in log q by Simpson's rule, and P(q) by steps of it."""
    # cos(phi) = sech t, dphi = sech t dt, a quarter circle
    t = 12.0 * (np.arange(angles) + 0.5) / angles
    cosine = 1 / np.cosh(t)
    weight = 4 * 12.0 / angles * cosine
    modulus = foundation.complex_modulus(q[:, None] * velocity * cosine) / pressure
    stiff, loss = (np.abs(modulus) ** 2) @ weight, (modulus.imag * cosine) @ weight
    log = np.log(q)
    rate = q**4 * c / 8 * stiff  # dG/dlog q where S = 1
    spread = np.zeros(q.size)
    for i in range(0, q.size - 2, 2):
        h = log[i + 1] - log[i]

        def slope(k: int, value: float) -> float:
            return rate[k] * (_factor(value, gamma) if stored else 1.0)

        # Classical Runge-Kutta over two steps, the middle one between; Simpson's rule
        # where S is not inside G.
        one = slope(i, spread[i])
        two = slope(i + 1, spread[i] + h * one)
        three = slope(i + 1, spread[i] + h * two)
        four = slope(i + 2, spread[i] + 2 * h * three)
        spread[i + 2] = spread[i] + h / 3 * (one + 2 * two + 2 * three + four)
        # Cubic Hermite in between.
        after = slope(i + 2, spread[i + 2])
        spread[i + 1] = 0.5 * (spread[i] + spread[i + 2]) + h / 4 * (one - after)
    share = _share(spread)
    under = 0.5 * q**4 * c * (gamma + (1 - gamma) * share**2) * share * loss
    width = np.diff(log)
    mu = float(np.sum((under[:-2:2] + 4 * under[1::2] + under[2::2]) * width[::2] / 3))
    return mu, float(share[-1]), float(spread[-1])


def _share(spread: Any) -> Any:
    with np.errstate(divide="ignore"):
        return erf(0.5 / np.sqrt(spread))


def _factor(spread: float, gamma: float) -> float:
    return gamma + (1 - gamma) * float(_share(np.float64(spread))) ** 2
