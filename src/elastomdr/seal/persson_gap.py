"""Gaps between a randomly rough surface and elastic rubber, by Persson's theory.

With the two-dimensional spectrum C(q), the pressure over the half-space's modulus
p/E* and the share of contact A(z) that is seen at the wave number z (`share` of
`rough.psd_integrals`), the mean gap of all that waves beyond z leave open is

    u(z) = sqrt(pi) int_z^q_high q^2 C w J(x) dq,      x = w p/(A(z) E*),
    w(q, z) = (pi int_z^q k^3 C dk)^(-1/2),
    J(x) = int_x^inf [g + 3 (1-g) erf(t)^2] exp(-t^2) dt/t,      g = 0.45,

and u(q_low) that of the whole surface. Where moduli soften by the strain of each scale,
E* is that of q, here and in A(z). Where contact is lost as waves from z to z + dz
come into sight, the gap is u_1 = u + u' A/A'. With the integral I of erf^2 exp(-t^2)/t
over all t, and c Euler's constant,

    J(x) = -g (c/2 + ln x) + 3 (1-g) I + int_0^1 [g (1 - e) - 3 (1-g) erf(x r)^2 e] dr/r,
    e = exp(-(x r)^2).

Sources: B. N. J. Persson, Phys. Rev. Lett. 99 (2007) 125502; C. Yang and B. N. J.
Persson, J. Phys.: Condens. Matter 20 (2008) 215214. Where channels through the gaps
close: A. Wang and M. H. Mueser, Tribol. Lett. 69 (2021), arXiv 2010.13470.
"""

import functools
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ..arrays import Array, xp
from ..numerics.quadrature import gauss
from ..rough.local_modulus import SoftenedByScale
from ..rough.multiscale import FORM, contact, rate_of, real_area
from ..rough.psd_integrals import Nodes, integral_to, share

CLOSES = 0.42  # share of contact at which channels close
_ENERGY = 0.45  # g
_CONTACT = 0.5, True  # gamma of the share of contact, stored: as `em.Multiscale`
_EULER = 0.5772156649015329
_ALL = 0.40712493463438926  # I
_FAR = 5.0  # x from which on J is nothing
_DEGREE = 44  # of the series for its integral
_ALL_ROUND = 2 * np.pi  # int |E*|^2 dphi over E*^2, of an elastic solid


class GapPoints(NamedTuple):
    """Points of a surface under pressures over E*."""

    wave_nodes: Nodes
    relative_pressure: Any  # p/E* (points, 1, 1)
    variance: Any  # R up to each node (points, cells, 2)
    stored: Any  # E* of each node over that of small strain (cells, 2)
    area: Any  # A at q_high (points,)
    real: Any  # the real contact that `em.Multiscale` has there
    steep: Any  # dlog R/dlog q at q_high


def contact_of(
    wave_nodes: Nodes,
    relative_pressure: Array,
    softened: SoftenedByScale | None = None,
) -> GapPoints:
    """The contact at many pressures p/E*, shape (points,)."""
    relative_pressure = relative_pressure[:, None, None]
    stored, last = (
        stored_at(softened, wave_nodes.q),
        stored_at(softened, wave_nodes.end),
    )
    rate = rate_of(wave_nodes, _ALL_ROUND * stored**2, relative_pressure)
    total = (rate * wave_nodes.weight).sum((-2, -1))
    power = (wave_nodes.power * stored**2 * wave_nodes.weight).sum()
    end = wave_nodes.end_power * last**2 / power
    return GapPoints(
        wave_nodes,
        relative_pressure,
        integral_to(rate, wave_nodes.weight),
        stored,
        contact(total, *_CONTACT),
        real_area(contact(total, FORM.gamma, True)),
        end + 0 * total,
    )


def stored_at(softened: SoftenedByScale | None, q: Array) -> Any:
    """E* at wave numbers over that of small strain."""
    if softened is None:
        return 1.0
    storage, _ = softened.softening.factors(softened.strain(q))
    return storage


def mean_gap(contacts: GapPoints) -> Any:
    """u(q_low) [m], shape (points,)."""
    x = 0.5 / xp.sqrt(contacts.variance)
    each = (
        contacts.wave_nodes.power
        / contacts.wave_nodes.q
        * contacts.stored
        * x
        * gap_integral(x)
        * contacts.wave_nodes.weight
    )
    return np.sqrt(np.pi) / contacts.relative_pressure[:, 0, 0] * each.sum((-2, -1))


def gap_integral(x: Array) -> Any:
    """J(x)."""
    held = xp.minimum(x, _FAR)
    inner = chebyshev.chebval(2 * (held / _FAR) ** 2 - 1, _inner())
    value = inner - _ENERGY * (_EULER / 2 + xp.log(held)) + 3 * (1 - _ENERGY) * _ALL
    return xp.where(x < _FAR, xp.maximum(value, 0.0), 0.0)


@functools.cache
def _inner() -> np.ndarray:
    """The integral over r as a series in (x/_FAR)^2, to 1e-12 of 1."""
    nodes, weights = gauss(64)
    r = 0.5 * (nodes + 1)

    def integral(place: Array) -> Any:
        square = 0.5 * (place[:, None] + 1) * (_FAR * r) ** 2
        gone, touching = np.exp(-square), share(0.25 / np.maximum(square, 1e-300)) ** 2
        each = _ENERGY * (1 - gone) - 3 * (1 - _ENERGY) * touching * gone
        return (each / r) @ (0.5 * weights)

    return chebyshev.chebinterpolate(integral, _DEGREE)


@functools.cache
def closing_pressure(area: float) -> float:
    """p/E* over the rms slope at which the share of contact is `area`: for an elastic
    solid R = (slope/p)^2 E*^2/8.
    """

    low, high = np.log(1e-6), np.log(1e3)
    for _ in range(60):
        middle = 0.5 * (low + high)
        heavy = contact(0.125 * np.exp(-2 * middle), *_CONTACT) > area
        low, high = (low, middle) if heavy else (middle, high)
    return float(np.exp(low))


class GapScales(NamedTuple):
    """What is seen at each node but the ends, (points, nodes), with log z ascending."""

    share: Any  # A(z)
    gap: Any  # u_1(z) [m]


def scales(contacts: GapPoints) -> GapScales:
    """Contact and the gap where it is lost, at all scales; on NumPy."""
    points = contacts.area.size
    variance = contacts.variance.reshape(points, -1)
    q, weight = contacts.wave_nodes.q.ravel(), contacts.wave_nodes.weight.ravel()
    power = (contacts.stored * contacts.wave_nodes.power).ravel()
    weighted_power = (power / q * weight)[None]
    shares = contact(variance, *_CONTACT)
    gaps = np.zeros_like(shares)
    for k in range(q.size - 1):
        beyond = variance[:, k + 1 :] - variance[:, k : k + 1]
        x = 0.5 / np.sqrt(np.maximum(beyond, 1e-300))
        each = weighted_power[:, k + 1 :] * x * _tabulated(x / shares[:, k : k + 1])
        gaps[:, k] = each.sum(-1)
    gaps *= np.sqrt(np.pi) / contacts.relative_pressure[:, :, 0]
    log_q = np.log(q)
    falls = np.gradient(shares, log_q, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        lost = gaps + np.gradient(gaps, log_q, axis=1) * shares / falls
    inside = np.isfinite(lost) & (falls < 0)
    return GapScales(shares, np.where(inside, np.maximum(lost, gaps), np.nan))


def critical_gap(contacts: GapPoints) -> np.ndarray:
    """u_1 [m] where the share of contact falls to that at which channels close; NaN
    where it does not, or within the first waves.
    """
    gap = np.full(contacts.area.size, np.nan)
    for i, (shares, lost) in enumerate(zip(*scales(contacts), strict=True)):
        known = np.isfinite(lost) & (lost > 0)
        if known.any() and shares[known][-1] < CLOSES < shares[known][0]:
            place = np.interp(-CLOSES, -shares[known], np.log(lost[known]))
            gap[i] = np.exp(place)
    return gap


@functools.lru_cache(1)
def _table() -> tuple[np.ndarray, np.ndarray]:
    x = np.geomspace(1e-10, _FAR, 4000)
    return np.log(x), gap_integral(x)


def _tabulated(x: np.ndarray) -> np.ndarray:
    """J(x), to 1e-5."""
    return np.interp(np.log(x), *_table())
