"""Conduction of friction heat: closed forms of moving sources, and the flash
temperature by length scale.

A heat source on the insulated surface of a half-space moves along x at v. With thermal
conductivity lambda [W/(m K)], heat capacity per volume rho c [J/(m^3 K)], diffusivity D
= lambda/(rho c) and w = v/2D, a unit of power at the distance r and the angle phi from
a point warms it, in the steady state, by exp(-w (r + r cos phi))/(2 pi lambda r)
(Jaeger 1942); on average over angles by I0(w r) exp(-w r)/(2 pi lambda r).

**The flash temperature.** Rubber is heated in its volume where it is deformed: a wave q
of the surface to the depth 1/2q, by exp(-2 q z). Split in depth into cosines of wave
number k, the source at the distance r warms as I0(w r) K0(r sqrt(w^2 + k^2)), so that a
pattern of heated spots has the mean temperature

    dT = (2/(pi lambda)) int_0^inf dk S(k)^2
         int_0^inf r dr [j(r) - j] I0(w r) K0(r sqrt(w^2 + k^2)),
    S(k) = sum_q s_q 4 q^2/(k^2 + 4 q^2),        j(r) = j/P(pi/r),

with j = mu p v the mean heat flux, s_q the share of the friction that the waves q have,
and j(r) the mean flux at the distance r from a heated point. Two points closer than
half a wave, pi/q, lie in one contact region as it is seen at the wave number q, and
P(q) is the share of the surface in such regions, from Persson's theory, since the line
of the MDR has no contact area:

    P = erf(1/(2 sqrt G)),
    G(q) = (1/8) int_q_low^q k^3 C(k) dk int_0^2pi |E*(k v cos phi)/p|^2 dphi.

Exact for an isotropic pattern with that j(r), at every Peclet number; what is assumed
is j(r), exp(-2 q z), and one temperature for all waves, the mean over where the heat
arises. What the mean flux j adds is left out: it warms the whole body, by its size,
time and cooling, and belongs to the `temperature` that is given. All heat goes into the
rubber, where the losses are: the road takes none.

By length scale, with q exp(-2 q z) and P, as in Persson, J. Phys.: Condens. Matter 18
(2006) 7789; there the heat spreads in depth for the time of one contact, here also
sideways, and slowly moving spots have their steady limit. The thermal foundation of the
MDR (2 lambda dx per element) is for spots at rest: at a Peclet number w a it is too hot
by the root of it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..checks import (
    as_float64,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    scalar,
)
from ..errors import InputError
from ..surface.spectrum import AbstractSpectrum
from ..trees import Tree, fill
from .psd_integrals import read, tables

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number, Scalar

_PER_DECADE = 40  # wave numbers and distances, trapezoidal rule in their logarithm
_FAR = 1e-3  # smallest distance, in half waves of the upper cutoff


class Heat(Tree):
    """What conducts the heat of friction, for `em.friction(heat=...)`; its methods are
    closed forms of moving sources.

    Args:
        conductivity: thermal conductivity of the rubber [W/(m K)].
        heat_capacity: heat capacity per volume, density times specific heat [J/(m^3
            K)].
        road: conductivity and heat capacity of the counterface, a pair in the same
            units; None for one that takes no heat. Its spots in contact are taken as
            steady, which they are after the time that `words()` tells.

    Raises:
        InputError: for values that are not positive, and a road that is no pair.
    """

    conductivity: Scalar  # lambda [W/(m K)]
    heat_capacity: Scalar  # rho c [J/(m^3 K)]
    road: tuple[Scalar, Scalar] | None  # the same of the counterface

    def __init__(
        self,
        conductivity: Number,
        heat_capacity: Number,
        *,
        road: tuple[Number, Number] | None = None,
    ):
        if road is not None and (not isinstance(road, (tuple, list)) or len(road) != 2):
            raise InputError(
                "road must be a pair, conductivity and heat capacity, or None, got "
                f"{road!r}."
            )
        pairs = [("conductivity", conductivity), ("heat_capacity", heat_capacity)]
        pairs += [
            (f"road: {name}", value)
            for (name, _), value in zip(pairs, road or (), strict=False)
        ]
        values = []
        for name, value in pairs:
            value = scalar(name, value)
            positive(name, value)
            values.append(value if is_traced(value) else float(value))
        fill(
            self,
            conductivity=values[0],
            heat_capacity=values[1],
            road=tuple(values[2:]) or None,
        )

    @property
    def diffusivity(self) -> Scalar:
        """D = lambda/(rho c) [m^2/s]."""
        return self.conductivity / self.heat_capacity

    def words(self, longest: float | None = None) -> str:
        """In one line; with the longest wave of a surface [m] also when the spots of
        the road are steady.
        """
        if is_traced(self):
            return "conduction"

        def of(one: Any, other: Any) -> str:
            return (
                f"conductivity {one:.4g} W/(m K), heat capacity {other:.4g} J/(m^3 K)"
            )

        text = of(self.conductivity, self.heat_capacity)
        if self.road is None:
            return text
        text += f"; road: {of(*self.road)}"
        if longest is None:
            return text
        return (
            f"{text}, steady after "
            f"{(longest / 2) ** 2 * self.road[1] / self.road[0]:.2g} s of contact"
        )

    @numpy_unless_traced
    def uniform_flux(
        self, flux: ArrayLike, time: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Surface temperature rise [K] of a half-space under an even `flux` [W/m^2]
        after `time` [s]; exact.

        dT = 2 q sqrt(t/(pi lambda rho c)). Carslaw & Jaeger 1959, 2.9. Raises
        `InputError`.
        """
        flux, time = _arrays(flux=flux, time=time)
        not_negative("time", time)
        return (
            2 * flux * np.sqrt(time / (np.pi * self.conductivity * self.heat_capacity))
        )

    @numpy_unless_traced
    def moving_band(
        self, flux: ArrayLike, half_width: ArrayLike, velocity: ArrayLike, x: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Steady surface temperature rise [K] at `x` [m] from the middle of an endless
        band that moves towards +x.

        `flux` q [W/m^2] on |x| < b = `half_width` [m], at `velocity` v [m/s]; x moves
        with it, the trailing edge is x = -b. Exact (Jaeger 1942):

            dT = (q/(pi lambda w)) int_{w(x-b)}^{w(x+b)} exp(-u) K0(|u|) du,   w = v/2D,

        in closed form, since (u e^u (K0 + K1))' = e^u K0 and (u e^-u (K0 - K1))' = e^-u
        K0. Raises `InputError`.
        """
        flux, half, velocity, x = _arrays(
            flux=flux, half_width=half_width, velocity=velocity, x=x
        )
        positive("half_width", half)
        positive("velocity", velocity)
        w = velocity / (2 * self.diffusivity)
        return (
            flux
            / (np.pi * self.conductivity * w)
            * (_jaeger(w * (x + half)) - _jaeger(w * (x - half)))
        )

    @numpy_unless_traced
    def moving_disc(
        self, flux: ArrayLike, radius: ArrayLike, velocity: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Steady temperature rise [K], mean over a disc of `radius` a [m] and even
        `flux` q [W/m^2], moving at v.

            dT = (2 q a/lambda) int_0^1 (2/pi) [acos s - s sqrt(1 - s^2)]
                 I0(2 w a s) exp(-2 w a s) ds,
            w = v/2D,

        exact at every Peclet number w a: the bracket is the overlap of two discs at the
        distance 2 a s. At rest 8 q a/(3 pi lambda) (Carslaw & Jaeger 1959, 10.5). To
        1e-9. Raises `InputError`.
        """
        from scipy.special import i0e

        flux, radius, velocity = _arrays(flux=flux, radius=radius, velocity=velocity)
        positive("radius", radius)
        not_negative("velocity", velocity)
        t = np.arange(-4.2, 3.2, 0.02)
        with np.errstate(over="ignore"):
            # s, 1 - s
            s, rest = (
                1 / (1 + np.exp(-np.pi * np.sinh(t))),
                1 / (1 + np.exp(np.pi * np.sinh(t))),
            )
        step = 0.02 * np.pi * np.cosh(t) * s * rest
        overlap = (
            2
            / np.pi
            * (np.arcsin(np.sqrt(rest * (1 + s))) - s * np.sqrt(rest * (1 + s)))
        )
        passed = (velocity * radius / self.diffusivity)[..., None]
        return (
            2 * flux * radius / self.conductivity * (i0e(passed * s) @ (overlap * step))
        )


def _jaeger(u: np.ndarray) -> np.ndarray:
    """int_0^u exp(-s) K0(|s|) ds."""
    from scipy.special import k0e, k1e

    size = np.maximum(np.abs(u), 1e-300)
    ahead = 1 + size * np.exp(-2 * size) * (k0e(size) - k1e(size))
    behind = size * (k0e(size) + k1e(size)) - 1
    return np.where(u == 0, 0.0, np.where(u > 0, ahead, -behind))


def _arrays(**values: Any) -> list[np.ndarray]:
    return list(
        np.broadcast_arrays(
            *(as_float64(name, value) for name, value in values.items())
        )
    )


def check_heat(
    heat: Any, temperature: Any, traced: bool, by_scale: bool = False
) -> None:
    """Raises `InputError` unless flash temperature can be found, by scale or one for
    all, or is not asked for.
    """
    if heat is None:
        return
    if traced and not by_scale:
        raise InputError(
            "heat must be left out under jax.grad, jit and vmap with em.Line() and "
            "em.HalfSpace(), whose flash temperature is not differentiable; with "
            "em.Multiscale() and em.Persson() it is."
        )
    if not isinstance(heat, Heat):
        raise InputError(
            f"heat must be an em.Heat(conductivity, heat_capacity), got {heat!r}."
        )
    if heat.road is not None and not by_scale:
        raise InputError(
            "heat: road needs em.Multiscale() or em.Persson(); other models heat "
            "the rubber alone."
        )
    if temperature is None:
        raise InputError(
            "heat needs a temperature [K], that of the rubber without the flash, "
            "and so a shift law."
        )


class Scales(NamedTuple):
    """Where on the scale of lengths a surface is in contact and loses energy, for n
    reduced velocities.
    """

    q: Float[np.ndarray, " waves"]  # [rad/m]
    area: Float[np.ndarray, "n waves"]  # P(q)
    share: Float[np.ndarray, "n waves"]  # s_q, sums to one


def scales(
    foundation: Any,
    surface: AbstractSpectrum,
    reduced: Float[np.ndarray, " n"],
    pressure: Any,
) -> Scales:
    """Apparent contact share P and share s of the friction, by wave number, at v a_T
    and the nominal pressures.
    """
    from scipy.special import erf

    count = max(
        24, int(np.ceil(_PER_DECADE * np.log10(surface.q_high / surface.q_low)))
    )
    q = np.geomspace(surface.q_low, surface.q_high, count + 1)
    width = np.log(q[1] / q[0])
    log_omega = np.log(reduced[:, None] * q)
    of = tables(
        foundation.complex_modulus, np.exp(log_omega.min()), np.exp(log_omega.max())
    )
    slope = q**4 * surface.at(q)  # q^3 C dq, per dlog q
    rate = (
        slope
        * read(of, of.stiffness, log_omega)
        / (8 * np.reshape(pressure, (-1, 1)) ** 2)
    )
    spread = np.concatenate(
        [
            np.zeros((reduced.size, 1)),
            np.cumsum(0.5 * width * (rate[:, 1:] + rate[:, :-1]), 1),
        ],
        1,
    )
    with np.errstate(divide="ignore"):
        area = erf(0.5 / np.sqrt(spread))
    share = slope * area * read(of, of.drag, log_omega)
    share[:, [0, -1]] *= 0.5
    return Scales(q, area, share / share.sum(axis=1, keepdims=True))


def rise(
    heat: Heat, at: Scales, velocity: Float[np.ndarray, " m"]
) -> Float[np.ndarray, "m n"]:
    """Flash temperature per mean heat flux [K m^2/W] of m velocities, at each of the n
    states of `at`.

    The double integral of this file's head, by the trapezoidal rule in log r and log k,
    to about 1e-3.
    """
    from scipy.special import i0e, k0e

    step = np.log(at.q[1] / at.q[0])
    near = np.arange(1, int(np.ceil(-np.log(_FAR) / step)) + 1)
    # descending
    r = np.concatenate([np.pi / at.q, np.pi / at.q[-1] * np.exp(-step * near)])
    excess = 1 / at.area - 1
    excess = np.concatenate(
        [excess, np.repeat(excess[:, -1:], near.size, axis=1)], axis=1
    )
    low, high = 1e-3 / r[0], 1e3 * at.q[-1]
    k = np.geomspace(low, high, int(np.ceil(12 * np.log10(high / low))))
    dk = k * np.log(k[1] / k[0])
    dk[0] = 0.5 * dk[0] + k[0]  # what lies below counts as even
    sampled = (at.share @ (4 * at.q**2 / (k[:, None] ** 2 + 4 * at.q**2)).T) ** 2 * dk
    found = np.empty((velocity.size, excess.shape[0]))
    for i, v in enumerate(velocity):
        w = v / (2 * heat.diffusivity)
        whole = np.hypot(w, k)[:, None]
        kernel = (
            i0e(w * r) * k0e(whole * r) * np.exp(-(k[:, None] ** 2) / (whole + w) * r)
        )
        found[i] = np.einsum(
            "nk,kr,nr->n", sampled, kernel * r**2 * step, excess, optimize=True
        )
    return np.asarray(2 / (np.pi * heat.conductivity) * found)
