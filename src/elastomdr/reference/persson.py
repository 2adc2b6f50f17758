"""Persson's theory of rubber friction on a self-affine or measured surface, to lay
beside other answers: mu, the share of real contact and G.

    mu = (1/2) int q^3 C(q) S(q) P(q) dq int_0^2pi cos(phi) Im E*(q v cos phi)/p dphi,
    P = erf(1/(2 sqrt G)),     S = gamma + (1 - gamma) P^2,
    G(q) = (1/8) int_q_low^q k^3 C(k) [S(k)] dk int_0^2pi |E*(k v cos phi)/p|^2 dphi,

E* the half-space's E/(1 - nu^2), C the two-dimensional spectrum. P(q) is the apparent
share of contact seen at wave number q. In Persson 2001 G has no S. Later work reduces
the stored energy by S there too: `stored=True`; P(q) then follows from the part of the
spectrum below q. Integrated by `rough.multiscale`, as `em.friction` with `em.Persson`.
Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; Scaraggi and Persson, J.
Phys.: Condens. Matter 27 (2015) 105102.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import numpy_unless_traced, plain
from ..element.law import surface_foundation
from ..errors import InputError
from ..material.validity import material_in_words
from ..models import Persson
from ..results.curve import PerssonCurve
from ..results.words import brief
from ..rough.local_modulus import Local
from ..rough.multiscale import solve, stress_variance, table_error
from ..rough.psd_integrals import spread_of
from ..surface.spectrum import as_spectrum
from .points import NOT_COMPARED, at_reference

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Material
    from ..surface.spectrum import AbstractSpectrum

_RTOL = 1e-7  # of mu, to which cells of log q are halved
_TABLES = 1e-7  # relative error of mu by the interpolated integrals over the angle
_PER_DECADE = 128  # cells of log q for G
# estimated relative error from which a point counts as not converged
_WORST = 1e-3


@numpy_unless_traced
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
        curve. `error` is estimated from the last two halvings of the cells of wave
        number, and for a table of moduli half of what leaving out every second of its
        points changes. A point where it is more than a thousandth of mu is NaN.

    Raises:
        InputError: for values that are not positive, or gamma outside 0 to 1.

    Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840.
    """
    foundation = surface_foundation(material)
    surface = as_spectrum("spectrum", spectrum)
    if foundation.per_area:
        raise InputError("material must be a half-space, got a layer.")
    model = Persson(plain("gamma", gamma), stored)
    reduced, pressure_at_reference = at_reference(
        foundation, temperature, velocity=velocity, pressure=pressure
    )
    shape = np.broadcast_shapes(reduced.shape, pressure_at_reference.shape)
    reduced, pressure_at_reference = (
        np.broadcast_to(a, shape) for a in (reduced, pressure_at_reference)
    )
    points = (surface, reduced.ravel(), pressure_at_reference.ravel())
    modulus = foundation.complex_modulus
    friction = solve(modulus, *points, model, _RTOL)
    variance = stress_variance(modulus, *points, _PER_DECADE)
    good = np.isfinite(friction.mu) & (friction.error <= _WORST * friction.mu)
    of_table = table_error(model, foundation, *points, Local(), friction.mu)
    error = friction.error + _TABLES * friction.mu + of_table
    mu, area, spread, error = (
        np.where(good, values, np.nan).reshape(shape)
        for values in (
            friction.mu,
            friction.area,
            spread_of(variance, *model.energy_factor()),
            error,
        )
    )

    def full(values: Any) -> Any:
        return np.array(np.broadcast_to(values, shape), dtype=float)

    return PerssonCurve(
        velocity=full(velocity),
        mu=mu,
        area_ratio=area,
        spread=spread,
        pressure=full(pressure),
        error=error,
        converged=good.reshape(shape),
        temperature=None if temperature is None else full(temperature),
        model=model.words(),
        plan=model.work(surface)[0],
        inputs=(
            *material_in_words(foundation),
            ("surface", f"{surface.label}, {surface.words()}"),
            *_conditions(pressure, velocity, temperature),
            NOT_COMPARED,
        ),
    )


def _conditions(
    pressure: Any, velocity: Any, temperature: Any
) -> list[tuple[str, str]]:
    """The rows of a result that say at which points it was computed."""
    rows = [
        ("pressure", brief(pressure, "Pa")),
        ("velocity", brief(velocity, "m/s")),
    ]
    if temperature is not None:
        rows.append(("temperature", brief(temperature, "K")))
    return rows
