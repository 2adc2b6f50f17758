"""Closed forms: friction of a rough line in full contact, the rolling resistance of a
cylinder on a thin cover that loses little, and Persson's theory of rubber friction.

**Full contact.** A rough line that touches the rubber everywhere, a sum over its waves:

    F_x = sum (1/2) A_k^2 k E*''(k v),      mu = F_x/F_N,

A_k the amplitude of the wave k, E* = E/(1 - nu^2) the modulus of the half-space, forces
per length of line. The rubber follows the line, so that the force under it is known:
where it would have to pull, contact is not full and there is no answer.

**Small damping.** A cover of springs side by side, K* = K' + i K'' per area, is indented
elastically over a half-width a,

    W/L = (4/3) K' a^3/D,
    F/L = (1/pi) int_0^inf k K''(k v) |u_k|^2 dk,
    u_k = 4 (sin ka - ka cos ka)/(D k^3),

D the diameter of the roll, L its length, W its load, F the resistance to first order in
the loss. For a K'' that does not depend on frequency the integral is (4/pi) K''
a^4/D^2, so that F/W = (3/pi) (K''/K') a/D. With a spectrum both moduli are taken at the
frequency 2 v/a, near which a passage dissipates most (k a = 2.08 is the peak over ln
k).

**Persson's theory** on a self-affine or measured surface: mu, the share of real contact
and G,

    mu = (1/2) int q^3 C(q) S(q) P(q) dq int_0^2pi cos(phi) Im E*(q v cos phi)/p dphi,
    P = erf(1/(2 sqrt G)),     S = gamma + (1 - gamma) P^2,
    G(q) = (1/8) int_q_low^q k^3 C(k) [S(k)] dk int_0^2pi |E*(k v cos phi)/p|^2 dphi,

C the two-dimensional spectrum. P(q) is the apparent share of contact seen at wave
number q. In Persson 2001 G has no S. Later work reduces the stored energy by S there
too: `stored=True`; P(q) then follows from the part of the spectrum below q. Integrated
by `rough.multiscale`, as `em.friction` with `em.Persson`. Source: B. N. J. Persson, J.
Chem. Phys. 115 (2001) 3840; Scaraggi and Persson, J. Phys.: Condens. Matter 27 (2015)
105102.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    is_traced,
    numpy_unless_traced,
    plain,
)
from ..element.law import Foundation, surface_foundation
from ..errors import InputError
from ..material.validity import material_in_words
from ..models import Persson
from ..results.curve import PerssonCurve
from ..results.words import brief
from ..rough.local_modulus import Local
from ..rough.multiscale import solve, stress_variance, table_error
from ..rough.psd_integrals import spread_of
from ..surface.rough_line import RoughLine
from ..surface.shapes import Cylinder
from ..surface.spectrum import as_spectrum
from .points import NOT_COMPARED, at_reference

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import Material
    from ..surface.spectrum import AbstractSpectrum

# Steps for the half-width, a = [(3/4) D W/(L K'(2 v/a))]^(1/3). Each leaves n/3 of the
# error, n = d ln K'/d ln omega: some per cent of it where little is lost, for which n =
# (2/pi) delta; two thirds at most, as n < 2 for any spectrum.
_STEPS = 40


@numpy_unless_traced
def full_contact_sliding(
    material: Material,
    line: RoughLine,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    temperature: ArrayLike | None = None,
) -> Float[Array, "..."]:
    """Friction coefficient of a rough line in full contact, mu = sum (1/2) A_k^2 k
    E*''(k v)/F_N.

    The line moves towards +x, as in `em.friction`. Velocity, load and temperature
    broadcast.

    Args:
        material: a material, which may be a `TabulatedModulus`, or a `Foundation`.
        line: the rough line.
        velocity: sliding velocity [m/s].
        load: normal force per length of line F_N [N/m].
        temperature: temperature [K], for a material with a shift law.

    Returns:
        mu, of the broadcast shape; NaN where the load does not keep the whole line in
        contact.

    Raises:
        InputError: for a line that is no `em.RoughLine`, or values that are not
            positive.

    Exact for the bare line (`em.friction(..., model=em.Line())`), taken as waves
    through its samples. Differentiable.

    Source: Popov & Hess 2015, ch. 10.
    """
    foundation = surface_foundation(material)
    if foundation.per_area or not isinstance(line, RoughLine):
        raise InputError(
            "full contact is that of an em.RoughLine on a material or a "
            "half-space of it."
        )
    v, force = at_reference(foundation, temperature, velocity=velocity, load=load)
    waves = xp.fft.rfft(xp.asarray(line.height))[1:]
    k = 2 * xp.pi * xp.arange(1, waves.shape[0] + 1) / line.period
    modulus = foundation.complex_modulus(xp.asarray(v)[..., None] * k)
    # the shortest wave counts once
    twice = xp.where(2 * xp.arange(1, waves.shape[0] + 1) == line.count, 0.5, 1.0)
    drag = (
        2
        / line.count**2
        * xp.sum(twice * xp.abs(waves) ** 2 * k * modulus.imag, axis=-1)
    )
    # The line moves towards +x under the rubber, which meets the wave k as exp(-i k v
    # t): conjugate of E*(k v).
    lifted = xp.concatenate(
        [xp.zeros_like(modulus[..., :1]), xp.conj(modulus) * waves], axis=-1
    )
    least = xp.min(xp.fft.irfft(lifted, n=line.count), axis=-1)
    return xp.where(xp.asarray(force) + least >= 0, drag / force, xp.nan)


@numpy_unless_traced
def small_damping(
    cover: Foundation,
    roll: Cylinder,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    temperature: ArrayLike | None = None,
) -> Float[Array, "..."]:
    """Rolling resistance over load of a roll on a cover of small damping, in closed
    form.

        f = (3/pi) tan(delta) a/D,
        a = [(3/4) D W/(L K')]^(1/3),
        K' and tan(delta) = K''/K' at omega = 2 v/a

    Args:
        cover: an `em.springs`, or a `Foundation` per area, K* [Pa/m].
        roll: an `em.Cylinder` of diameter D = 2 radius and length L.
        velocity: rolling velocity v [m/s]; velocity, load and temperature broadcast.
        load: normal force W [N].
        temperature: temperature [K], for a cover with a shift law.

    Returns:
        f, of the broadcast shape.

    Raises:
        InputError: for a roll that is no cylinder, or values that are not positive.

    Exact to first order in tan(delta) where K'' does not depend on frequency. With a
    spectrum it is an estimate: within 5 % of `em.rolling` at loss tangents of 0.1 to
    0.3 on that of example 23. Differentiable.

    Source: derived in `docs/belt.md`; the powers of load, thickness, modulus and
    diameter are those of Jonkers 1980 and Spaans 1991.
    """
    if not isinstance(cover, Foundation) or cover.per_area is False:
        raise InputError(
            "cover must be a layer, em.springs(rubber, thickness, bonded=False), "
            "got "
            f"{cover!r}."
        )
    if not isinstance(roll, Cylinder):
        raise InputError(f"roll must be an em.Cylinder(radius, length), got {roll!r}.")
    v, force = at_reference(cover, temperature, velocity=velocity, load=load)
    if not is_traced(cover) and not float(cover.equilibrium) > 0:
        raise InputError(
            "cover must have an equilibrium modulus: one that relaxes altogether "
            "does not lose little."
        )
    diameter = 2 * xp.asarray(roll.radius)
    scale = 0.75 * diameter * force / xp.asarray(roll.length)
    half = (scale / cover.equilibrium) ** (1 / 3) + 0 * v
    for _ in range(_STEPS):
        half = (scale / cover.storage(2 * v / half)) ** (1 / 3)
    return 3 / np.pi * cover.loss_tangent(2 * v / half) * half / diameter


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
