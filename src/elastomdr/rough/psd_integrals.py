"""Friction of a randomly rough surface under a pressure, in closed integrals over its
spectrum.

With E* the half-space's modulus E/(1 - nu^2), C(q) the two-dimensional spectrum and w =
q v:

    full contact (exact)
    mu = (1/2p) int q^3 C drag(q v) dq,
    drag(w) = int_0^2pi cos(phi) Im E*(w cos phi) dphi
    Persson
    mu = (1/2p) int q^3 C S P drag dq,
    P = erf(1/(2 sqrt G)),  S = gamma + (1 - gamma) P^2
                            G(q) = (1/8p^2) int_q_low^q k^3 C [S] stiffness(k v) dk,
                            stiffness(w) = int_0^2pi |E*(w cos phi)|^2 dphi

P(q) is the share of the nominal area that is in contact when waves up to q are seen; at
the upper cutoff it is the real area of contact. Where S stands inside G as well
("stored"), dG/S(G) can be integrated once for all, so that G is a function of the same
integral without S. Source: B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840; Scaraggi
and Persson, J. Phys.: Condens. Matter 27 (2015) 105102.

The integrals over the angle depend on q v alone: they are tabulated once for a
material, over the logarithm of the frequency, and read off by cubic interpolation. Each
integral over q is taken by Gauss' rule of two points on cells of log q, which end at
the points of the spectrum, where it may bend, and get shorter towards q_low, where P
falls from 1.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from ..arrays import Array, is_traced, special, xp
from ..numerics.interpolation import even_cubics, hermite, interval_of
from ..numerics.quadrature import gauss, gauss_unit
from ..surface.height_map import tops_of

if TYPE_CHECKING:
    from .._types import ComplexArray
    from ..surface.spectrum import AbstractSpectrum

# E*(omega) [Pa] at omega [rad/s], any shape
Modulus: TypeAlias = "Callable[[Array], ComplexArray]"

PER_DECADE = 32  # cells of log q that a solution begins with
_COARSEST = PER_DECADE // 4  # and those of the coarser of two that it is compared with
# how many factors of 2 the smallest cell, next to q_low, is below those that are even
_SMALLEST = 60
_STEP = np.log(10.0) / 32  # of log frequency in the tables of a material
_REACH = 21.0  # how far below a frequency in log the average over the angles looks
_ANGLES = 400  # nodes over the angle, midpoints in log tan(phi/2), of the tables
_DIRECT = 128  # the same, where each frequency has an average of its own


class Nodes(NamedTuple):
    """Nodes of Gauss' rule over log q: two in each cell."""

    q: Array  # wave numbers (cells, 2) [rad/m]
    log: Array  # log(q/q_low), which near q_low has digits that q has not
    weight: Array  # of int dlog q (cells, 2)
    power: Array  # q^4 C (cells, 2) [rad^4]
    end: Array  # q_high [rad/m]
    log_end: Array  # log(q_high/q_low)
    end_power: Array  # q^4 C there
    tops: Array | None = None  # of measured heights, as `top_slopes` gives them


class Averages(NamedTuple):
    """Integrals over the angle at frequencies w = q v."""

    drag: Array  # int cos Im E* dphi [Pa]
    stiffness: Array  # int |E*|^2 dphi [Pa^2]
    stiffer: Array  # log of stiffness(w e^finer) over stiffness(w)
    lost: Array | None = (
        None  # int (Im E*)^2 dphi over `stiffness`, where moduli soften
    )


class Tables(NamedTuple):
    """`Averages` on an even grid of log w."""

    step: float
    first: int  # the number of the first interval's lower end: its log in steps
    # by column (log drag, log stiffness, stiffer, and log lost where moduli soften) and
    # power of the place within an interval, highest first: (3 or 4, 4, intervals)
    cubics: np.ndarray


# what averages are taken from: E* itself, where JAX traces it, or tables of them
Moduli: TypeAlias = "Modulus | Tables"


def nodes(
    spectrum: AbstractSpectrum,
    per_decade: int = PER_DECADE,
    bends: Sequence[Array] = (),
    counts: tuple[int, ...] | None = None,
) -> Nodes:
    """Nodes over a spectrum, in `per_decade` cells of even width in log q.

    Cells end at the points of the spectrum, and at the wave numbers `bends`, where an
    integrand may bend. `counts`: as `cell_counts` gives them.
    """
    log_c, log_q = xp.log(spectrum.c), xp.log(spectrum.q)
    log_low, log_q = log_q[0], log_q - log_q[0]
    counts = cell_counts(spectrum, per_decade) if counts is None else counts
    first = _graded(counts[0], per_decade)
    number = np.array([first.size - 1, *counts[1:]])
    piece = np.repeat(np.arange(number.size), number)
    within = np.arange(piece.size) - np.repeat(np.cumsum(number) - number, number)
    start, end = within / number[piece], (within + 1) / number[piece]
    start[: number[0]], end[: number[0]] = first[:-1], first[1:]
    width = xp.diff(log_q)
    low, high = (log_q[piece] + width[piece] * share for share in (start, end))
    if len(bends):
        places = xp.log(xp.stack(bends)) - log_low
        traced = is_traced(places)
        if not traced:
            places = _with_between(np.sort(places), per_decade)
        # one that lies elsewhere is no end; where JAX counts them, it is one like others,
        # since a cell of no width has no derivative
        share = (np.arange(len(bends)) + 0.618) / len(bends) if traced else 1.0
        elsewhere = low[0] + share * (high[-1] - low[0])
        places = xp.where((places > low[0]) & (places < high[-1]), places, elsewhere)
        ends = xp.concatenate([low, high[-1:], places])
        ends = xp.sort(ends) if traced else np.unique(ends)
        low, high = ends[:-1], ends[1:]
        piece = xp.searchsorted(log_q[1:-1], 0.5 * (low + high))
    steep = xp.diff(log_c) / width
    intercept = (log_c[:-1] - steep * log_q[:-1])[piece][:, None]
    slope = steep[piece][:, None]
    x = low[:, None] + (high - low)[:, None] * np.array(
        [0.5 - np.sqrt(3) / 6, 0.5 + np.sqrt(3) / 6]
    )
    return Nodes(
        xp.exp(log_low + x),
        x,
        xp.broadcast_to((0.5 * (high - low))[:, None], x.shape),
        xp.exp(4 * log_low + (4 + slope) * x + intercept),
        xp.exp(log_low + log_q[-1]),
        log_q[-1],
        xp.exp(4 * (log_low + log_q[-1]) + log_c[-1]),
        tops_of(spectrum),
    )


def cell_counts(spectrum: AbstractSpectrum, per_decade: int) -> tuple[int, ...]:
    """How many cells there are between the points of a spectrum; where q is traced
    three decades are assumed.
    """
    if is_traced(spectrum.q):
        return (3 * per_decade,) * (spectrum.q.shape[0] - 1)
    decades = np.diff(np.log(spectrum.q)) / np.log(10.0)
    return tuple(np.maximum(1, np.ceil(decades * per_decade)).astype(int).tolist())


def _with_between(log_bends: np.ndarray, per_decade: int) -> np.ndarray:
    """Bends at log q, and between those nearer than a quarter of a decade so many
    places that cells do get finer there.

    Between two within a cell nothing would change with finer cells, as if all had
    settled.
    """
    count = 2 * per_decade // _COARSEST
    near = [
        pair
        for pair in itertools.pairwise(log_bends)
        if pair[1] - pair[0] < 0.25 * np.log(10.0)
    ]
    return np.unique(
        np.concatenate([log_bends, *(np.linspace(*pair, count + 1) for pair in near)])
    )


def _graded(count: int, per_decade: int) -> np.ndarray:
    """Ends of cells from 0 to 1: each longer than those before together by a factor,
    until one has a `count`th.
    """
    growth = 2.0 ** (24 / per_decade)
    even = min(1.0, 1 / (count * (growth - 1)))  # from where on cells are even
    first = even * growth ** np.arange(-int(_SMALLEST * per_decade / 24), 1.0)
    rest = max(0, int(np.ceil((1 - even) * count)))
    return np.concatenate(
        [[0.0], first[:-1], np.linspace(even, 1.0, rest + 1) if rest else [1.0]]
    )


def integral_to(rate: Array, weight: Array) -> Any:
    """int dlog q of `rate` from q_low to each node, (..., cells, 2): within a cell as
    Gauss' method of order four.
    """
    first, second = rate[..., 0], rate[..., 1]
    width = 2 * weight[..., 0]
    whole = 0.5 * width * (first + second)
    before = xp.cumsum(whole, axis=-1) - whole
    off = np.sqrt(3) / 6
    inside = xp.stack(
        [
            before + width * (0.25 * first + (0.25 - off) * second),
            before + width * ((0.25 + off) * first + 0.25 * second),
        ],
        axis=-1,
    )
    # A rate that grows many times within a cell would take the first node below zero.
    return xp.clip(inside, before[..., None], (before + whole)[..., None])


def faded_to(source: Array, wave_nodes: Nodes, power: int) -> tuple[Any, Any]:
    """int (q'/q)^power dlog q' of a `source` over the waves q' < q, at each node
    (..., cells, 2) and at q_high (...): the source is linear within a cell, the power
    exact.
    """
    points, weights, _ = gauss_unit(4)
    half = wave_nodes.weight[:, :1]
    middle = wave_nodes.log.mean(-1) - wave_nodes.log_end
    grown = xp.exp(power * middle)
    off = np.sqrt(1 / 3)

    def within_cell(end: float) -> Any:  # up to there, from -1 to 1
        at = (end + 1) * points - 1
        each = xp.exp(power * half * at) * weights * (end + 1) * half
        first, second = ((each * (0.5 + s * at / off / 2)).sum(-1) for s in (-1, 1))
        return (source[..., 0] * first + source[..., 1] * second) * grown

    whole, *nodes = (within_cell(end) for end in (1.0, -off, off))
    before = xp.cumsum(whole, -1) - whole
    inside = xp.stack([before + x for x in nodes], -1)
    fall = xp.exp(power * (wave_nodes.log_end - wave_nodes.log))
    return inside * fall, whole.sum(-1)


@functools.lru_cache(maxsize=8)
def _kernels(step: float) -> tuple[np.ndarray, np.ndarray]:
    """Weights on f(w), f(w e^-h), ... of int cos f(w cos) dphi and int f(w cos) dphi, f
    cubic between the points.

    From the point above w on, which cubic interpolation needs.
    """
    t = 22.0 * (np.arange(_ANGLES) + 0.5) / _ANGLES  # cos = sech t, dphi = sech t dt
    cosine = 1 / np.cosh(t)
    place = np.minimum(-np.log(cosine), _REACH) / step
    left = np.floor(place).astype(int)
    s = place - left
    cubic = [
        -s * (s - 1) * (s - 2) / 6,
        (s + 1) * (s - 1) * (s - 2) / 2,
        -(s + 1) * s * (s - 2) / 2,
        (s + 1) * s * (s - 1) / 6,
    ]
    count = int(np.ceil(_REACH / step)) + 4
    plain, weighted = np.zeros(count), np.zeros(count)
    for k, factor in enumerate(cubic):
        np.add.at(plain, left + k, factor * cosine)
        np.add.at(weighted, left + k, factor * cosine**2)
    scale = 4 * 22.0 / _ANGLES
    return scale * weighted, scale * plain


def tables(
    modulus: Modulus,
    low: float,
    high: float,
    step: float = _STEP,
    finer: float = 0.0,
    parted: bool = False,
) -> Tables:
    """Tables for frequencies q v from `low` to `high` [rad/s]; `modulus(omega)` is E*
    [Pa], complex.

    Their logs are whole multiples of the step, so that a point reads the same
    frequencies whatever stands beside it. With `parted` also how much of the stiffness
    is loss.
    """
    weighted, plain = _kernels(step)
    first = int(np.floor(np.log(low) / step)) - 2
    count = int(np.ceil(np.log(high) / step)) - first + 3
    lags = weighted.size
    frequency = np.exp(step * np.arange(first - lags + 2, first + count + 1))

    def average(values: np.ndarray, kernel: np.ndarray = plain) -> np.ndarray:
        return _log(np.convolve(values, kernel, "valid"))

    value, higher = (
        np.asarray(modulus(omega), np.complex128)
        for omega in (frequency, frequency * np.exp(finer))
    )
    stiffness = average(abs(value) ** 2)
    stiffer = average(abs(higher) ** 2) - stiffness
    columns = [average(value.imag, weighted), stiffness, stiffer]
    if parted:
        columns.append(average(value.imag**2) - stiffness)
    return Tables(step, first + 1, np.stack([_cubics(y) for y in columns]))


def moduli_table(modulus: Modulus, low: float, high: float, step: float) -> Tables:
    """The logarithms of Im E* and |E*|^2 themselves, on the grid of `tables`."""
    first = int(np.floor(np.log(low) / step)) - 2
    last = int(np.ceil(np.log(high) / step)) + 3
    value = np.asarray(
        modulus(np.exp(step * np.arange(first, last + 1))), np.complex128
    )
    columns = (value.imag, abs(value) ** 2)
    cubics = [_cubics(_log(y)) for y in columns]
    return Tables(step, first + 1, np.stack(cubics))


def _log(values: np.ndarray) -> np.ndarray:
    """Logarithms; of zero, which an elastic solid loses, one whose exponential is zero."""
    return np.where(values > 0, np.log(np.maximum(values, 1e-300)), -800.0)


def _cubics(y: np.ndarray) -> np.ndarray:
    """The cubic through each four points at -1, 0, 1 and 2, its coefficients from s^3
    down: (4, points - 3).
    """
    before, left, right, after = y[:-3], y[1:-2], y[2:-1], y[3:]
    return np.stack(
        [
            (after - before) / 6 + (left - right) / 2,
            (before + right) / 2 - left,
            right - before / 3 - left / 2 - after / 6,
            left,
        ]
    )


def direct(
    modulus: Modulus, w: Array, finer: float = 0.0, parted: bool = False
) -> Averages:
    """The averages at frequencies w of any shape, each with integrals over the angle of
    its own.
    """
    t = 14.0 * (np.arange(_DIRECT) + 0.5) / _DIRECT
    cosine = 1 / np.cosh(t)
    weight = 4 * 14.0 / _DIRECT * cosine

    def square(w: Array) -> tuple[Any, Any]:
        value = modulus(w[..., None] * cosine)
        return value, (value.real**2 + value.imag**2) @ weight

    value, stiffness = square(w)
    _, in_contact = square(w * np.exp(finer))
    return Averages(
        value.imag @ (weight * cosine),
        stiffness,
        xp.log(in_contact / stiffness),
        value.imag**2 @ weight / stiffness if parted else None,
    )


def read(table: Tables, log_w: Array) -> Averages:
    """The averages at log w, by cubics through four points of their logarithm."""
    drag, stiffness, stiffer, *lost = read_columns(table, log_w, slice(None))
    return Averages(
        xp.exp(drag), xp.exp(stiffness), stiffer, xp.exp(lost[0]) if lost else None
    )


def read_stiffer(table: Tables, log_w: Array) -> Any:
    """`Averages.stiffer` alone at log w."""
    (stiffer,) = read_columns(table, log_w, slice(2, 3))
    return stiffer


def read_columns(table: Tables, log_w: Array, columns: slice) -> list[Any]:
    """Some columns of a table at log w."""
    place = log_w / table.step - table.first
    left = interval_of(place, table.cubics.shape[-1])
    return [even_cubics(column, place, left) for column in table.cubics[columns]]


def share(spread: Array) -> Any:
    """P = erf(1/(2 sqrt G))."""
    return special.erf(0.5 / xp.sqrt(xp.maximum(spread, 1e-300)))


def factor(shares: Array, gamma: float) -> Any:
    """S = gamma + (1 - gamma) P^2."""
    return gamma + (1 - gamma) * shares**2


@functools.lru_cache(maxsize=8)
def _stored(gamma: float) -> tuple[np.ndarray, np.ndarray]:
    """log R, evenly, and the cubics of log G between, of G = F^-1(R), F(G) = int_0^G
    dg/S(g).
    """
    from scipy.special import erf

    log_g = np.linspace(np.log(1e-4), np.log(1e9), 2400)
    nodes, weights = gauss(4)
    middle = (
        0.5 * (log_g[1:] + log_g[:-1])[:, None] + 0.5 * np.diff(log_g)[:, None] * nodes
    )
    g = np.exp(middle)
    parts = (g / factor(erf(0.5 / np.sqrt(g)), gamma)) @ weights * 0.5 * np.diff(log_g)
    whole = np.exp(log_g[0]) + np.concatenate([[0.0], np.cumsum(parts)])

    def slope_of(log_g: Array, r: Array) -> Any:  # dlog G/dlog R
        return r * factor(erf(0.5 * np.exp(-0.5 * log_g)), gamma) / np.exp(log_g)

    log_r = np.linspace(np.log(whole[0]), np.log(whole[-1]), log_g.size)
    even = hermite(np.log(whole), log_g, slope_of(log_g, whole), log_r)
    rise, change = (
        (log_r[1] - log_r[0]) * slope_of(even, np.exp(log_r)),
        np.diff(even),
    )
    start, end = rise[:-1], rise[1:]
    cubics = [start + end - 2 * change, 3 * change - 2 * start - end, start, even[:-1]]
    return log_r, np.stack(cubics)


def spread_of(rate: Array, gamma: float, stored: bool) -> Any:
    """G from R = int q^3 C stiffness/(8 p^2) dq: itself, or with S inside the
    integral.
    """
    if not stored:
        return rate
    log_r, cubics = _stored(float(gamma))
    x = xp.log(xp.maximum(rate, 1e-300))
    # Below the table S is 1, above it gamma: G is R, or goes with it.
    inside = xp.clip(x, log_r[0], log_r[-1])
    place = (inside - log_r[0]) / (log_r[1] - log_r[0])
    left = interval_of(place, cubics.shape[1])
    return xp.exp(even_cubics(cubics, place, left) + (x - inside))
