"""Friction with flash temperature: the temperature at which the friction that heats is
the friction that is found.

At a given pressure mu depends on velocity and temperature by v a_T alone, and so do the
scales on which the heat arises. So one curve of mu against v a_T, coarse and
interpolated, shows where

    dT = mu(v a_T(T_0 + dT)) p v r(v, v a_T),
    r the flash temperature per heat flux,

has its roots. The smallest is stable, and the state that cold rubber reaches; where mu
rises with dT (on the glassy side of the peak) there may be others, of which hot rubber
keeps the largest. The curve goes on while mu rises. The line is then solved at that
temperature itself, and the root moved by what the curve was wrong, until both agree.

**The flash temperature per heat flux** (sources as in `rough.heat`). Rubber is heated
in its volume where it is deformed: a wave q of the surface to the depth 1/2q, by exp(-2
q z). Split in depth into cosines of wave number k, the source at the distance r warms
as I0(w r) K0(r sqrt(w^2 + k^2)), so that a pattern of heated spots has the mean
temperature

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

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..material.shift import thermal_factors
from ..surface.spectrum import AbstractSpectrum
from .heat import Heat, highest_rise
from .psd_integrals import read, tables
from .psd_integrals import share as contact_share

if TYPE_CHECKING:
    from jaxtyping import Float

    from ..call.types import SteadyBody

_PER_DECADE = 8  # of v a_T, of the curve that is interpolated
_WAVES = (
    40  # wave numbers and distances per decade, trapezoidal rule in their logarithm
)
_FAR = 1e-3  # smallest distance, in half waves of the upper cutoff
SETTLED = 1e-5  # relative agreement of the temperature with the friction found at it
# temperatures tried at once; how often between the two on either side of a root
_SCAN, _ZOOMS = 512, 3
_ROUNDS = 8
_NOTHING = 1e-12  # rise that is none, as in full contact [K]


class Flash(NamedTuple):
    """Flash temperature and the friction at it; NaN where none was found."""

    rise: np.ndarray  # [K]
    reduced: np.ndarray  # v a_T at the raised temperature [m/s]
    mean: Any  # as of `friction` at the raised temperature
    heat: np.ndarray  # mu p v, by the friction at the raised temperature [W/m^2]
    vertical: np.ndarray  # b_T at the raised temperature
    several: np.ndarray  # where there are other steady states
    runaway: np.ndarray  # where friction makes too much heat up to the highest rise


def warmed(
    heat: Heat,
    foundation: SteadyBody,
    surface: AbstractSpectrum,
    velocity: np.ndarray,
    temperature: np.ndarray,
    pressure: np.ndarray,
    cold: Any,
    friction: Callable[[np.ndarray, np.ndarray, bool], Any],
    hot: bool,
) -> Flash:
    """Raises the temperature of each point until it is that which its friction makes:
    of several the one of rubber that was cold, or of rubber that was `hot`.

    `friction(reduced, pressure, coarse)` solves points at v a_T and p/b_T, less exactly
    where `coarse` is true; of its answer, as of `cold`, a named tuple of arrays, mu and
    good are looked at. Points without a root below a rise of 1000 K, or below the
    end of the shift law, are NaN.
    """
    mean = _each(lambda field: np.array(field, dtype=np.float64), cold)
    temperatures = np.full(velocity.size, np.nan)
    several, runaway = np.zeros((2, velocity.size), dtype=bool)
    mean.good[:] = 0
    for p in np.unique(pressure):
        same_pressure = np.flatnonzero((pressure == p) & cold.good)
        if same_pressure.size:
            group = _Group(
                heat,
                foundation,
                surface,
                velocity[same_pressure],
                temperature[same_pressure],
                float(p),
                friction,
                hot,
            )
            curve, roots = group.first(np.asarray(cold.mu)[same_pressure])
            several[same_pressure] = roots.several
            runaway[same_pressure] = np.isnan(roots.rise)
            for points, kelvins, state in group.settle(curve, roots.rise):
                temperatures[same_pressure[points]] = kelvins
                for field, values in zip(mean, state, strict=True):
                    if isinstance(field, np.ndarray):
                        field[same_pressure[points]] = values
    a, b = thermal_factors(foundation, temperature + np.nan_to_num(temperatures))
    made = np.asarray(mean.mu) * pressure * velocity
    return Flash(
        temperatures,
        velocity * a,
        mean._replace(good=mean.good > 0),
        made,
        b * np.ones_like(temperature),
        several,
        runaway,
    )


class _FlashCurve(NamedTuple):
    """Heights that friction makes, coarse and interpolated, up to the rise `top`."""

    made: list[Any]  # their log against log(v a_T), for each point
    least: np.ndarray  # the smallest rise that is looked at [K]
    top: np.ndarray  # [K]


class _Roots(NamedTuple):
    """Rises that friction makes itself."""

    rise: np.ndarray  # NaN where there is none
    several: Any  # where there are others
    growing: np.ndarray  # where at the top friction makes more heat the warmer it is


def _each(function: Callable[[Any], Any], answer: Any) -> Any:
    """`function` of the arrays of an answer."""
    return type(answer)(
        *(
            field if field is None or isinstance(field, str) else function(field)
            for field in answer
        )
    )


class _Group(NamedTuple):
    """Points of one pressure."""

    heat: Heat
    foundation: SteadyBody
    surface: AbstractSpectrum
    velocity: np.ndarray
    temperature: np.ndarray
    pressure: float
    friction: Callable[[np.ndarray, np.ndarray, bool], Any]
    hot: bool

    def first(self, cold: np.ndarray) -> tuple[_FlashCurve, _Roots]:
        """The curve on which roots are looked for, and the first of them, from friction
        without heat. It goes on while friction grows with temperature.
        """
        every, still = np.arange(cold.size), np.zeros_like(cold)
        made = self.made(self.reduced(still), self.reduced_pressure(still), cold, every)
        highest = highest_rise(self.foundation, self.temperature)
        least = np.maximum(1e-6 * made, _NOTHING)
        top = 2 * float(np.max(made)) + 1
        while True:
            curve = self.curve(least, np.minimum(top, highest))
            roots = self.roots(curve, np.ones(cold.size))
            more = np.isnan(roots.rise) | roots.growing
            if not (more & (curve.top < highest)).any():
                return curve, roots
            top = 4 * top

    def settle(
        self, curve: _FlashCurve, root: np.ndarray
    ) -> Iterator[tuple[np.ndarray, np.ndarray, Any]]:
        """Points that have settled, their rise and their friction."""
        correction = np.ones(root.size)
        left = np.flatnonzero(np.isfinite(root))
        for _ in range(_ROUNDS):
            if not left.size:
                return
            reduced, reduced_pressure = (
                of(np.nan_to_num(root))[left]
                for of in (self.reduced, self.reduced_pressure)
            )
            mean = self.friction(reduced, reduced_pressure, False)
            made = self.made(reduced, reduced_pressure, np.asarray(mean.mu), left)
            off = np.abs(made - root[left]) / np.maximum(root[left], 1e6 * _NOTHING)
            settled = mean.good & (off <= SETTLED)
            yield (
                left[settled],
                root[left[settled]],
                _each(lambda field, chosen=settled: field[chosen], mean),
            )
            ratio = np.maximum(made, 1e-300) / np.array(
                [
                    np.exp(curve.made[i](x))
                    for i, x in zip(left, np.log(reduced), strict=True)
                ]
            )
            correction[left] = np.where(np.isfinite(ratio), ratio, np.nan)
            left = left[mean.good & ~settled]
            root = self.roots(curve, correction).rise
            left = left[np.isfinite(root[left])]

    def reduced(self, warmer: np.ndarray) -> np.ndarray:
        """v a_T at each point's temperature and `warmer` [K], (points,) or (points,
        any).
        """
        more = warmer.ndim - 1
        temperature, velocity = (
            a.reshape(-1, *[1] * more) for a in (self.temperature, self.velocity)
        )
        return velocity * np.asarray(
            thermal_factors(self.foundation, temperature + warmer)[0]
        )

    def reduced_pressure(self, warmer: np.ndarray) -> np.ndarray:
        """p/b_T at each point's temperature and `warmer` [K], (points,)."""
        return self.pressure / (
            thermal_factors(self.foundation, self.temperature + warmer)[1]
            * np.ones_like(warmer)
        )

    def made(
        self,
        reduced: np.ndarray,
        reduced_pressure: np.ndarray,
        mu: np.ndarray,
        points: np.ndarray,
    ) -> np.ndarray:
        """The rise [K] that friction `mu` makes at v a_T and p/b_T."""
        contact_scales = scales(
            self.foundation, self.surface, reduced, reduced_pressure
        )
        per_flux = [
            rise(
                self.heat,
                FlashScales(
                    contact_scales.q,
                    contact_scales.area[j : j + 1],
                    contact_scales.share[j : j + 1],
                ),
                self.velocity[i : i + 1],
            )[0, 0]
            for j, i in enumerate(points)
        ]
        return mu * self.pressure * self.velocity[points] * np.array(per_flux)

    def curve(self, least: np.ndarray, top: np.ndarray) -> _FlashCurve:
        """The rise that friction makes, for each point's velocity.

        It has the mean of p/b_T at the points' temperatures without a rise: what that
        misses is corrected at the roots.
        """
        from scipy.interpolate import PchipInterpolator

        ends = self.reduced(np.stack([np.zeros_like(top), top], 1))
        low, high = ends.min() * 0.999, ends.max() * 1.001
        nodes = np.geomspace(
            low, high, max(5, int(np.ceil(_PER_DECADE * np.log10(high / low))) + 1)
        )
        pressure = float(self.reduced_pressure(np.zeros_like(self.temperature)).mean())
        mu = self.friction(nodes, np.full(nodes.size, pressure), True).mu
        known = np.isfinite(mu) & (mu > 0)
        if known.sum() < 2:
            known, mu = np.ones_like(known), np.full_like(mu, np.nan)
        contact_scales = scales(self.foundation, self.surface, nodes[known], pressure)
        made = (
            mu[known]
            * self.pressure
            * self.velocity[:, None]
            * rise(self.heat, contact_scales, self.velocity)
        )
        log_rise = np.log(np.maximum(made, 1e-300))
        made = [
            PchipInterpolator(np.log(nodes[known]), np.nan_to_num(row, nan=800.0))
            for row in log_rise
        ]
        return _FlashCurve(made, least, top)

    def roots(self, curve: _FlashCurve, correction: np.ndarray) -> _Roots:
        """The smallest rise that the friction at it makes, or with `hot` the largest;
        NaN where there is none up to the top.
        """
        least = np.minimum(curve.least, 0.5 * curve.top)
        tried = np.geomspace(least, np.maximum(curve.top, 1e-300), _SCAN).T
        made = self.on(curve, tried, correction)
        above = made > tried
        several = np.any(~above[:, :-1] & above[:, 1:], axis=1)
        none = np.isnan(correction) | (above[:, -1] if self.hot else above.all(axis=1))
        growing = made[:, -1] > made[:, -2]
        for _ in range(_ZOOMS):
            last = _SCAN - np.argmax(above[:, ::-1], axis=1)  # behind all above
            index = last * above.any(axis=1) if self.hot else np.argmin(above, axis=1)
            index = np.clip(index, 1, _SCAN - 1)[:, None]
            low, high = (
                np.take_along_axis(tried, i, 1)[:, 0] for i in (index - 1, index)
            )
            tried = np.linspace(low, high, _SCAN).T
            above = self.on(curve, tried, correction) > tried
        rise = np.where(none, np.nan, tried.mean(axis=1))
        return _Roots(rise, several, growing)

    def on(
        self, curve: _FlashCurve, tried: np.ndarray, correction: np.ndarray
    ) -> np.ndarray:
        """The rises that friction makes at rises (points, tried)."""
        places = np.log(self.reduced(tried))
        made = [np.exp(f(x)) for f, x in zip(curve.made, places, strict=True)]
        return np.array(made) * correction[:, None]


class FlashScales(NamedTuple):
    """Where on the scale of lengths a surface is in contact and loses energy, for n
    reduced velocities.
    """

    q: Float[np.ndarray, " waves"]  # [rad/m]
    area: Float[np.ndarray, "n waves"]  # P(q)
    share: Float[np.ndarray, "n waves"]  # s_q, sums to one


def scales(
    foundation: SteadyBody,
    surface: AbstractSpectrum,
    reduced: Float[np.ndarray, " n"],
    pressure: float | np.ndarray,
) -> FlashScales:
    """Apparent contact share P and share s of the friction, by wave number, at v a_T
    and the nominal pressures.
    """
    count = max(24, int(np.ceil(_WAVES * np.log10(surface.q_high / surface.q_low))))
    q = np.geomspace(surface.q_low, surface.q_high, count + 1)
    width = np.log(q[1] / q[0])
    log_omega = np.log(reduced[:, None] * q)
    of = tables(
        foundation.complex_modulus, np.exp(log_omega.min()), np.exp(log_omega.max())
    )
    on = read(of, log_omega)
    slope = q**4 * surface.at(q)  # q^3 C dq, per dlog q
    rate = slope * on.stiffness / (8 * np.reshape(pressure, (-1, 1)) ** 2)
    spread = np.concatenate(
        [
            np.zeros((reduced.size, 1)),
            np.cumsum(0.5 * width * (rate[:, 1:] + rate[:, :-1]), 1),
        ],
        1,
    )
    area = contact_share(spread)
    share = slope * area * on.drag
    share[:, [0, -1]] *= 0.5
    return FlashScales(q, area, share / share.sum(axis=1, keepdims=True))


def rise(
    heat: Heat, contact_scales: FlashScales, velocity: Float[np.ndarray, " m"]
) -> Float[np.ndarray, "m n"]:
    """Flash temperature per mean heat flux [K m^2/W] of m velocities, at each of the n
    states of `contact_scales`.

    The double integral at the head of this file, by the trapezoidal rule in log r and log k,
    to about 1e-3.
    """
    from scipy.special import i0e, k0e

    step = np.log(contact_scales.q[1] / contact_scales.q[0])
    near = np.arange(1, int(np.ceil(-np.log(_FAR) / step)) + 1)
    # descending
    r = np.concatenate(
        [np.pi / contact_scales.q, np.pi / contact_scales.q[-1] * np.exp(-step * near)]
    )
    excess = 1 / contact_scales.area - 1
    excess = np.concatenate(
        [excess, np.repeat(excess[:, -1:], near.size, axis=1)], axis=1
    )
    low, high = 1e-3 / r[0], 1e3 * contact_scales.q[-1]
    k = np.geomspace(low, high, int(np.ceil(12 * np.log10(high / low))))
    dk = k * np.log(k[1] / k[0])
    dk[0] = 0.5 * dk[0] + k[0]  # what lies below counts as even
    sampled = (
        contact_scales.share
        @ (4 * contact_scales.q**2 / (k[:, None] ** 2 + 4 * contact_scales.q**2)).T
    ) ** 2 * dk
    flash = np.empty((velocity.size, excess.shape[0]))
    for i, v in enumerate(velocity):
        w = v / (2 * heat.diffusivity)
        whole = np.hypot(w, k)[:, None]
        kernel = (
            i0e(w * r) * k0e(whole * r) * np.exp(-(k[:, None] ** 2) / (whole + w) * r)
        )
        flash[i] = np.einsum(
            "nk,kr,nr->n", sampled, kernel * r**2 * step, excess, optimize=True
        )
    return np.asarray(2 / (np.pi * heat.conductivity) * flash)
