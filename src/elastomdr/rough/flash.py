"""Friction with flash temperature: the temperature at which the friction that heats is
the friction that is found.

At a given pressure mu depends on velocity and temperature by v a_T alone, and so do the
scales on which the heat arises. So one curve of mu against v a_T, coarse and
interpolated, shows where

    dT = mu(v a_T(T_0 + dT)) p v r(v, v a_T),
    r the flash temperature per heat flux (`rough.heat`),

has its roots. The smallest is taken, which is stable and the state that cold rubber
reaches: where mu rises with dT (on the glassy side of the peak) there may be others.
The line is then solved at that temperature itself, and the root moved by what the curve
was wrong, until both agree.
"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from ..element.law import Foundation
from ..errors import InputError
from ..material.shift import thermal_factors
from ..surface.spectrum import AbstractSpectrum
from .heat import Heat, Scales, rise, scales
from .mean import Mean

_PER_DECADE = 8  # of v a_T, of the curve that is interpolated
_HIGHEST = 1000.0  # rise beyond which nothing is looked for [K]
SETTLED = 1e-5  # relative agreement of the temperature with the friction found at it
# temperatures tried at once; how often between the two on either side of a root
_SCAN, _ZOOMS = 512, 3
_ROUNDS = 8
_NOTHING = 1e-12  # rise that is none, as in full contact [K]


class Warm(NamedTuple):
    """Flash temperature and the friction at it; NaN where none was found."""

    rise: np.ndarray  # [K]
    reduced: np.ndarray  # v a_T at the raised temperature [m/s]
    mean: Mean
    heat: np.ndarray  # mu p v, by the friction at the raised temperature [W/m^2]
    vertical: np.ndarray  # b_T at the raised temperature


def warmed(
    heat: Heat,
    foundation: Foundation,
    surface: AbstractSpectrum,
    velocity: np.ndarray,
    kelvin: np.ndarray,
    pressure: np.ndarray,
    cold: Mean,
    friction: Callable[[np.ndarray, np.ndarray, bool], Mean],
) -> Warm:
    """Raises the temperature of each point until it is that which its friction makes.

    `friction(reduced, pressure, coarse)` solves points at v a_T and p/b_T, less exactly
    where `coarse` is true. Points without a root below a rise of 1000 K, or below the
    end of the shift law, are NaN.
    """
    mean = _each(lambda field: np.array(field, dtype=np.float64), cold)
    found = np.full(velocity.size, np.nan)
    mean.good[:] = 0
    for p in np.unique(pressure):
        at = np.flatnonzero((pressure == p) & cold.good)
        if at.size:
            group = _Group(
                heat, foundation, surface, velocity[at], kelvin[at], float(p), friction
            )
            for points, kelvins, state in group.settle(np.asarray(cold.mu)[at]):
                found[at[points]] = kelvins
                for field, values in zip(mean, state, strict=True):
                    if field is not None:
                        field[at[points]] = values
    a, b = thermal_factors(foundation, kelvin + np.nan_to_num(found))
    made = np.asarray(mean.mu) * pressure * velocity
    return Warm(
        found,
        velocity * a,
        mean._replace(good=mean.good > 0),
        made,
        b * np.ones_like(kelvin),
    )


def _each(function: Callable[[Any], Any], mean: Mean) -> Mean:
    fields: list[Any] = [None if field is None else function(field) for field in mean]
    return Mean(*fields)


class _Group(NamedTuple):
    """Points of one pressure."""

    heat: Heat
    foundation: Foundation
    surface: AbstractSpectrum
    velocity: np.ndarray
    kelvin: np.ndarray
    pressure: float
    friction: Callable[[np.ndarray, np.ndarray, bool], Mean]

    def settle(self, cold: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray, Mean]]:
        """Points that have settled, their rise and their friction."""
        every, still = np.arange(cold.size), np.zeros_like(cold)
        made = self.made(self.reduced(still), self.carried(still), cold, every)
        highest = self.highest()
        top = min(2 * float(np.max(made)) + 1, highest)
        curve = self.curve(top)
        correction, first = np.ones(cold.size), np.maximum(1e-6 * made, _NOTHING)
        root = self.roots(curve, first, top, correction)
        while top < highest and np.isnan(root).any():
            top = min(4 * top, highest)
            curve = self.curve(top)
            root = self.roots(curve, first, top, correction)
        left = np.flatnonzero(np.isfinite(root))
        for _ in range(_ROUNDS):
            if not left.size:
                return
            reduced, carried = (
                of(np.nan_to_num(root))[left] for of in (self.reduced, self.carried)
            )
            mean = self.friction(reduced, carried, False)
            made = self.made(reduced, carried, np.asarray(mean.mu), left)
            off = np.abs(made - root[left]) / np.maximum(root[left], 1e6 * _NOTHING)
            settled = mean.good & (off <= SETTLED)
            yield (
                left[settled],
                root[left[settled]],
                _each(lambda field, at=settled: field[at], mean),
            )
            ratio = np.maximum(made, 1e-300) / np.array(
                [
                    np.exp(curve[i](x))
                    for i, x in zip(left, np.log(reduced), strict=True)
                ]
            )
            correction[left] = np.where(np.isfinite(ratio), ratio, np.nan)
            left = left[mean.good & ~settled]
            root = self.roots(curve, first, top, correction)
            left = left[np.isfinite(root[left])]

    def reduced(self, warmer: np.ndarray) -> np.ndarray:
        """v a_T at each point's temperature and `warmer` [K], (points,) or (points,
        any).
        """
        more = warmer.ndim - 1
        kelvin, velocity = (
            a.reshape(-1, *[1] * more) for a in (self.kelvin, self.velocity)
        )
        return velocity * np.asarray(
            thermal_factors(self.foundation, kelvin + warmer)[0]
        )

    def carried(self, warmer: np.ndarray) -> np.ndarray:
        """p/b_T at each point's temperature and `warmer` [K], (points,)."""
        return self.pressure / (
            thermal_factors(self.foundation, self.kelvin + warmer)[1]
            * np.ones_like(warmer)
        )

    def made(
        self,
        reduced: np.ndarray,
        carried: np.ndarray,
        mu: np.ndarray,
        points: np.ndarray,
    ) -> np.ndarray:
        """The rise [K] that friction `mu` makes at v a_T and p/b_T."""
        at = scales(self.foundation, self.surface, reduced, carried)
        own = [
            rise(
                self.heat,
                Scales(at.q, at.area[j : j + 1], at.share[j : j + 1]),
                self.velocity[i : i + 1],
            )[0, 0]
            for j, i in enumerate(points)
        ]
        return mu * self.pressure * self.velocity[points] * np.array(own)

    def highest(self) -> float:
        """The largest rise to look at: that of the shift law's end, or 1000 K."""
        low, high = 0.0, 2 * _HIGHEST
        while high - low > 1e-3 * low + 1e-3:
            middle = 0.5 * (low + high)
            try:
                thermal_factors(self.foundation, self.kelvin.max() + middle)
                low = middle
            except InputError:
                high = middle
            if low >= _HIGHEST:
                break
        return min(low, _HIGHEST)

    def curve(self, top: float) -> list[Callable[[Any], Any]]:
        """The logarithm of the rise that friction makes against log(v a_T), for each
        point's velocity.

        It has the mean of p/b_T at the points' temperatures without a rise: what that
        misses is corrected at the roots.
        """
        from scipy.interpolate import PchipInterpolator

        ends = self.reduced(np.array([0.0, top])[None, :].repeat(self.velocity.size, 0))
        low, high = ends.min() * 0.999, ends.max() * 1.001
        nodes = np.geomspace(
            low, high, max(5, int(np.ceil(_PER_DECADE * np.log10(high / low))) + 1)
        )
        pressure = float(self.carried(np.zeros_like(self.kelvin)).mean())
        mu = self.friction(nodes, np.full(nodes.size, pressure), True).mu
        known = np.isfinite(mu) & (mu > 0)
        if known.sum() < 2:
            known, mu = np.ones_like(known), np.full_like(mu, np.nan)
        at = scales(self.foundation, self.surface, nodes[known], pressure)
        made = (
            mu[known]
            * self.pressure
            * self.velocity[:, None]
            * rise(self.heat, at, self.velocity)
        )
        level = np.log(np.maximum(made, 1e-300))
        return [
            PchipInterpolator(np.log(nodes[known]), np.nan_to_num(row, nan=800.0))
            for row in level
        ]

    def roots(
        self, curve: list, first: np.ndarray, top: float, correction: np.ndarray
    ) -> np.ndarray:
        """Smallest rise that the friction at it makes; NaN where there is none from
        `first` to `top`.
        """
        tried = np.geomspace(first, max(top, 1e-300), _SCAN).T
        none = np.isnan(correction)
        for _ in range(_ZOOMS):
            place = np.log(self.reduced(tried))
            made = (
                np.array([np.exp(f(x)) for f, x in zip(curve, place, strict=True)])
                * correction[:, None]
            )
            below = made <= tried
            none = none | ~below.any(axis=1)
            index = np.maximum(below.argmax(axis=1), 1)[:, None]
            low, high = (
                np.take_along_axis(tried, i, 1)[:, 0] for i in (index - 1, index)
            )
            tried = np.linspace(low, high, _SCAN).T
        return np.where(none, np.nan, tried.mean(axis=1))
