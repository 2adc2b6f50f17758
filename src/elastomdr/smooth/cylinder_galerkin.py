"""A cylinder that slides or rolls steadily on a half-space or a layer, in plane strain,
without friction: Galerkin's method.

The contact is x = xc + L t, |t| < 1, counted from the apex, in which the pressure is

    p = sqrt(1 - t^2) sum_n c_n U_{n-1}(t),      n = 1 ... N.

Its n-th term has the transform pi n (-i)^(n-1) J_n(y)/y at y = kL, so that the surface,
whose compliance to a wave is C(k), has the slope

    u' = -2 sum_mn (2 - [m = 0]) n c_n B_mn T_m(t),
    B_mn = Re[i^(m-n) int_0^inf C J_m J_n/y dy].

It is -x/R: B n c = e_1/4 for m > 0, of which the even m - n are symmetric and the odd ones
antisymmetric, and m = 0 gives xc. So both edges come out once L is given, and errors of
load and friction are of second order in those of the pressure. The retardation times of
C give products of modified Bessel functions (`bessel_products`), for n = 0 and n = 1,
from which follow all others. From that a layer takes the same integrals of

    D = sum over the covers of (1 - W)/E*(-kv),

which falls as exp(-2kh), so that few waves serve (`layer_waves`). A material without
instantaneous compliance, one that begins with a dashpot, has an infinite pressure at its
leading edge: one more term, sqrt((1 + t)/(1 - t)), and one more polynomial.

Load and friction force per length are P = (pi/2) L c_1 and F = (L/R) ((pi/2) xc c_1 +
(pi/4) L c_2). Source: Hunter 1961 for the standard solid on a half-plane, of which this
is the general case.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import arrays, fori_loop, scan, xp
from ..checks import Array
from ..element.layer import layer_deficit, layer_kernel
from ..material.relaxation import KelvinChain, Relaxation
from ..numerics.quadrature import gauss, gauss_on_panels
from ..numerics.root import search
from ..trees import Tree, replaced, static

# of the logarithm of the half-length, after which one is close enough, unless load or depth
# are missed by more than the third, relatively
_SMALL_STEPS, _MISSED = (1e-4, 1e-7), 3e-9

_BLOCK = 2**21  # numbers of one array of the waves of layers
_DEEP = 18.0  # kh at which 1 - W has fallen to rounding
_LAST = 81.0  # kL up to which waves count in the depth
# where the gap is looked at
_BESIDE = np.array([-3.0, -2.2, -1.7, -1.4, -1.2, 1.2, 1.4, 1.7, 2.2, 3.0])


class Cover(Tree):
    """One of the bodies that carry the pressure: a half-space, or a layer."""

    chain: KelvinChain  # 1/E* of its material
    thickness: Any = None  # [m]; None: a half-space
    squeeze: Array | None = None  # 1 - 2 nu; None: a constant bulk modulus
    shear: Relaxation | None = None  # G(t), beside a bulk modulus
    bulk: Any = None
    bonded: bool = static(default=True)

    def creep(self, omega: Array) -> tuple[Array, Array]:
        """Real and imaginary part of 1/E*(-omega)."""
        x = omega[..., None] * self.chain.times
        branches = self.chain.compliances / (1 + x**2)
        return self.chain.instantaneous + branches.sum(axis=-1), (branches * x).sum(
            axis=-1
        )

    def of_kernel(
        self, kernel: Callable[..., Array], k: Array, omega: Array
    ) -> tuple[Array, Array]:
        """Real and imaginary part of 1/E*(-omega) times W or 1 - W."""
        stored, lost = self.creep(omega)
        if self.squeeze is not None:
            factor = kernel(k * self.thickness, self.squeeze, self.bonded)
            return stored * factor, lost * factor
        assert self.shear is not None
        shear = xp.conj(self.shear.complex_modulus(omega))
        factor = kernel(
            k * self.thickness, 3 * shear / (3 * self.bulk + shear), self.bonded
        )
        both = (stored + 1j * lost) * factor
        return xp.real(both), xp.imag(both)


class Cylinders(Tree):
    """Points to be solved, one velocity each."""

    radius: Array  # R [m]
    covers: tuple[Cover, ...]
    velocity: Array  # times a_T [m/s]

    @property
    def on_layers(self) -> bool:
        return self.covers[0].thickness is not None


class LayerWaves(Tree):
    """What layers lack of half-spaces, as a sum over few waves: D(k) dk at k = z/h."""

    z: Array  # k times the thickness h
    real: Array  # of each point at each wave [1/Pa]
    imaginary: Array
    thickness: Array  # h, of the thinner cover [m]
    ratio: float = static()  # half-length over thickness that they serve


class Solution(NamedTuple):
    """A contact at given half-lengths L; forces are per length of the cylinder."""

    half: Array  # L [m]
    shift: Array  # xc [m]
    load: Array  # P [N/m]
    mu: Array  # F/P
    # c_n [Pa], and that of the infinite pressure last where there is a dashpot
    terms: Array


def solve_at(
    problem: Cylinders, half: Array, order: int, waves: LayerWaves | None, dashpot: bool
) -> Solution:
    """The contact of half-length `half` [m] at each point, by `order` terms; `dashpot`:
    with an infinite pressure.
    """
    size = order + 1 if dashpot else order
    shares = _half_plane(problem, half, 2 * size + 2)
    if waves is not None:
        shares = _Shares(
            *(
                a - b
                for a, b in zip(
                    shares, _of_layer(half, 2 * size + 2, waves), strict=True
                )
            )
        )
    matrix = slopes_of_all(shares.first, shares.second, size)
    if dashpot:
        last = xp.transpose(shares.infinite[1 : size + 1])[..., None]
        matrix = xp.concatenate([matrix[..., :order], last], axis=2)
    # Odd and even terms apart: what they share may be as little as rounding.
    apart = np.concatenate([np.arange(0, size, 2), np.arange(1, size, 2)])
    columns = np.append(apart[apart < order], order) if dashpot else apart
    right = np.zeros((size, 1))
    right[0] = 0.25
    coefficients = xp.linalg.solve(
        matrix[:, apart][:, :, columns],
        xp.broadcast_to(right, (matrix.shape[0], size, 1)),
    )
    coefficients = coefficients[:, np.argsort(columns), 0]
    n = np.arange(1.0, order + 1)
    mean = shares.first[1 : order + 1] * ((-1.0) ** n)[:, None]
    xc = 2 * xp.sum(mean.T * coefficients[:, :order], axis=1)
    terms = coefficients[:, :order] / n
    first, second = 0.5 * terms[:, 0], 0.25 * terms[:, 1]
    if dashpot:
        infinite = coefficients[:, -1]
        xc = xc + 2 * shares.infinite[0] * infinite
        first, second = first + infinite, second + 0.5 * infinite
        terms = xp.concatenate([terms, infinite[:, None]], axis=1)
    load = math.pi * half**2 / problem.radius * first
    mu = half / problem.radius * (xc + second / first)
    return Solution(half, xc * half, load, mu, terms * (half / problem.radius)[:, None])


def depth(problem: Cylinders, solution: Solution, order: int) -> Array:
    """Depth of the apex below the surface at rest [m]: from the mean over the contact,
    weighted by (1 - t^2)^(3/2).
    """
    return _depth(problem, solution, _displacement(problem, solution, order)[0])


def depth_and_gap(
    problem: Cylinders, solution: Solution, order: int
) -> tuple[Array, Array]:
    """`depth`, and the smallest gap beside the contact over the undeformed one, where it
    is looked at; negative: it touches.
    """
    y, weight, _ = _depth_waves()
    real, imaginary = _displacement(problem, solution, order)
    deep = _depth(problem, solution, real)
    t = _BESIDE
    wave = y[:, None] * t
    u = (real * weight / y) @ xp.cos(wave) - (imaginary * weight / y) @ xp.sin(wave)
    half = solution.half[:, None]
    rise = (solution.shift[:, None] + half * t) ** 2 / (2 * problem.radius)
    return deep, xp.min((rise - deep[:, None] + half * u) / rise, axis=1)


def _depth(problem: Cylinders, solution: Solution, real: Array) -> Array:
    y, weight, mean = _depth_waves()
    bend = (solution.shift**2 + solution.half**2 / 6) / (2 * problem.radius)
    return bend + solution.half * (real @ (weight * mean / y))


def pull(solution: Solution, order: int, dashpot: bool) -> Array:
    """The part of the load that would have to pull, over the load, from the pressure at
    many points of the contact.
    """
    count = 2 * order
    angle = math.pi * (np.arange(count) + 0.5) / count
    terms = np.sin(angle[:, None] * np.arange(1, order + 1)) * np.sin(angle)[:, None]
    pressure = solution.terms[:, :order] @ terms.T
    if dashpot:
        pressure = pressure + solution.terms[:, -1:] * (1 + np.cos(angle))
    return xp.sum(xp.maximum(-pressure, 0.0), axis=1) / xp.sum(pressure, axis=1)


def _displacement(
    problem: Cylinders, solution: Solution, order: int
) -> tuple[Any, Any]:
    """Real and imaginary part of (2/pi) C p of each wave kL, over L."""
    y, _, _ = _depth_waves()
    k = y / solution.half[:, None]
    real, imaginary = (x[: solution.terms.shape[1]] for x in _depth_terms(order))
    stored, lost = solution.terms @ real, solution.terms @ imaginary
    creep = [
        cover.of_kernel(layer_kernel, k, k * problem.velocity[:, None])
        for cover in problem.covers
    ]
    a, b = sum(c[0] for c in creep), sum(c[1] for c in creep)
    return a * stored - b * lost, a * lost + b * stored


def half_of(
    problem: Cylinders,
    wanted: Array,
    by_depth: bool,
    dashpot: bool,
    waves: LayerWaves | None,
    guess: Array,
    order: int,
) -> tuple[Array, Solution]:
    """Half-length [m] at which load per length [N/m] or depth [m] is the one `wanted`,
    NaN where none was found, and the contacts; on NumPy.
    """
    contact: Any = None
    miss: Any = None

    def residual(log: Array) -> Array:
        nonlocal contact, miss
        contact = solve_at(problem, np.exp(log), order, waves, dashpot)
        value = depth(problem, contact, order) if by_depth else contact.load
        miss = np.log(np.maximum(value, 1e-300)) - np.log(wanted)
        return miss

    log, met = np.log(guess), False
    for close in _SMALL_STEPS:
        log, met = search(residual, log, close, longest=0.5)
        if not (np.abs(miss) > _MISSED).any():
            break
    return np.where(met, np.exp(log), np.nan), contact


def layer_waves(problem: Cylinders, ratio: float) -> LayerWaves | None:
    """The waves of a layer for contacts up to a half-length of `ratio` thicknesses;
    None for half-spaces.

    exp(ikx) is smooth over a panel where D is not, as near k = 0 where a memory may
    span many decades of k: there D is integrated against the cardinal polynomials of
    exp(ikx)'s few nodes, on panels that shrink towards zero.
    """
    if not problem.on_layers:
        return None
    thickness = functools.reduce(
        xp.minimum, [cover.thickness for cover in problem.covers]
    )
    rule = _wave_rule(ratio)

    def lacking(z: Array) -> tuple[Any, Any]:
        k = z / thickness
        parts = [
            cover.of_kernel(layer_deficit, k, k * problem.velocity[:, None])
            for cover in problem.covers
        ]
        return sum(deficit[0] for deficit in parts), sum(
            deficit[1] for deficit in parts
        )

    near, far = lacking(rule.fine), lacking(rule.others)
    real, imaginary = (
        xp.concatenate([a @ rule.spread, b * rule.weight], axis=1)
        for a, b in zip(near, far, strict=True)
    )
    return LayerWaves(rule.waves, real, imaginary, thickness, ratio)


class _Shares(NamedTuple):
    """B_mn of the terms n = 0 and n = 1, and the share of the infinite pressure; degrees
    m x points.
    """

    first: Array
    second: Array
    infinite: Array


def _half_plane(problem: Cylinders, half: Array, top: int) -> _Shares:
    """Shares of half-planes, up to the degree `top`."""
    first: Any = 0.0
    second: Any = 0.0
    infinite: Any = 0.0
    instantaneous: Any = 0.0
    diagonal: Any = 0.0
    for cover in problem.covers:
        compliances = cover.chain.compliances
        z = half[:, None] / (problem.velocity[:, None] * cover.chain.times)
        product = bessel_products(z, top)
        first = first - product.with_first @ compliances
        second = second - product.with_second @ compliances
        diagonal = diagonal + product.diagonal @ compliances
        both = (product.with_first + product.with_second)[1:]
        apex = (product.with_first[0] - product.with_first[1])[None]
        infinite = infinite + (xp.concatenate([apex, both]) * z) @ compliances
        instantaneous = instantaneous + cover.chain.instantaneous
    diagonal = (diagonal + 0.5 * instantaneous)[None]
    second = xp.concatenate([second[:1], diagonal, second[2:]])
    return _Shares(first, second, infinite)


def _of_layer(half: Array, top: int, waves: LayerWaves) -> _Shares:
    """What the layer takes from the shares, as sums over its waves; in blocks of points
    whose waves fill some 30 MB.
    """
    highest = _DEEP * waves.ratio
    last = min(top, math.ceil(highest) + 30)
    count = math.ceil(0.5 * (last + highest)) + 12
    block = max(1, _BLOCK // (count * waves.z.size))
    parts = [
        _of_block(
            half[i : i + block], top, _block(waves, slice(i, i + block)), last, count
        )
        for i in range(0, half.shape[0], block)
    ]
    return _Shares(*(xp.concatenate(x, axis=1) for x in zip(*parts, strict=True)))


def _block(waves: LayerWaves, points: slice) -> LayerWaves:
    return replaced(waves, real=waves.real[points], imaginary=waves.imaginary[points])


def _of_block(
    half: Array, top: int, waves: LayerWaves, last: int, count: int
) -> _Shares:
    s, to_even, to_odd = _transform(count, top, last)
    ratio = half / waves.thickness
    phase = 0.5 * (ratio[:, None] * waves.z)[..., None] * s  # points x waves x nodes
    sine, cosine = xp.sin(phase), xp.cos(phase)
    # cos(y s) - 1, which keeps what long waves do, and sin(y s)
    bend, wave = -2 * sine**2, 2 * sine * cosine
    j_0, j_1 = 1 + xp.mean(bend, axis=2), wave @ s / s.shape[0]
    real, imaginary = waves.real / waves.z, waves.imaginary / waves.z
    y = ratio[:, None] * waves.z
    of_even = [
        real * j_0,
        imaginary * j_1,
        y * (imaginary * j_0 - real * j_1),
    ]
    of_odd = [
        -imaginary * j_0,
        real * j_1,
        y * (real * j_0 + imaginary * j_1),
    ]
    even = (xp.stack(of_even, axis=1) @ bend) @ to_even  # points x 3 x degrees
    odd = (xp.stack(of_odd, axis=1) @ wave) @ to_odd
    both = xp.stack([even, odd], axis=3)
    both = xp.reshape(both, (half.shape[0], 3, -1))[..., : top + 1]
    first, second, infinite = xp.transpose(both, (1, 2, 0))
    apex = infinite[:1] + xp.sum(of_even[2], axis=1)
    return _Shares(first, second, xp.concatenate([apex, infinite[1:]]))


@functools.lru_cache(maxsize=32)
def _transform(
    count: int, top: int, last: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes s in (0, 1), half of `count`, and what values there add up to in even and
    odd degrees up to `top`: nothing above `last`.
    """
    nodes = (count + 1) // 2
    angle = math.pi * (np.arange(nodes) + 0.5) / (2 * nodes)
    degree = np.arange(top + 2 - top % 2)
    to = np.cos(angle[:, None] * degree) / nodes * (degree <= last)
    return np.cos(angle), to[:, ::2], to[:, 1::2]


_SHRINKING = np.concatenate([[0.0], 4.0 ** np.arange(-26, 1)])  # panels towards zero


class _WaveRule(NamedTuple):
    waves: np.ndarray  # z
    fine: np.ndarray  # nodes of the first panel
    spread: np.ndarray  # what each of them adds to its waves: fine nodes x waves
    others: np.ndarray  # nodes of the other panels, which are waves
    weight: np.ndarray  # theirs


@functools.lru_cache(maxsize=16)
def _wave_rule(ratio: float) -> _WaveRule:
    width = 1.0  # of the first panel
    few = 10 + math.ceil(1.5 * ratio * width)
    nodes, _ = gauss(few)
    fine, weights = gauss_on_panels(_SHRINKING, 10)
    # cardinal polynomials of the few nodes, at the fine ones, by Legendre's expansion
    # of each
    legendre = np.polynomial.legendre.legvander(nodes, few - 1)
    cardinal = np.polynomial.legendre.legvander(2 * fine - 1, few - 1) @ np.linalg.inv(
        legendre
    )
    spread = width * weights[:, None] * cardinal
    ends = [(width, 3.0, 16), (3.0, 8.0, 16), (8.0, _DEEP, 16)]
    rest = [
        gauss_on_panels(np.array([a, b]), n + math.ceil(0.75 * ratio * (b - a)))
        for a, b, n in ends
    ]
    others, weight = (np.concatenate(x) for x in zip(*rest, strict=True))
    waves = np.concatenate([0.5 * width * (nodes + 1), others])
    return _WaveRule(waves, width * fine, spread, others, weight)


@functools.lru_cache(maxsize=32)
def _pressure_rule(order: int, wave: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodes s, and what values of a function there add up to under each term, for waves
    exp(iys) up to y = `wave`.
    """
    count = math.ceil((order + wave) / 2) + 12
    angle = math.pi * (np.arange(count) + 0.5) / count
    regular = np.sin(angle)[:, None] * np.sin(angle[:, None] * np.arange(1, order + 1))
    return np.cos(angle), math.pi / count * np.column_stack(
        [regular, 1 + np.cos(angle)]
    )


@functools.cache
def _depth_waves() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """kL, its weights, and the waves of the weight of the mean; up to where 1e-8 of the
    depth is left out.
    """
    y, weight = (
        np.concatenate(x)
        for x in zip(
            gauss_on_panels(_SHRINKING, 8),
            gauss_on_panels(np.linspace(1.0, _LAST, 41), 8),
            strict=True,
        )
    )
    s, _ = _pressure_rule(2, _LAST)
    return y, weight, 8 / (3 * len(s)) * (1 - s**2) ** 2 @ np.cos(s[:, None] * y)


@functools.lru_cache(maxsize=8)
def _depth_terms(order: int) -> tuple[np.ndarray, np.ndarray]:
    """(2/pi) times the transform of each term at the waves kL: real and imaginary
    part.
    """
    y, _, _ = _depth_waves()
    s, terms = _pressure_rule(order, _LAST)
    wave = s[:, None] * y
    return 2 / math.pi * terms.T @ np.cos(wave), -2 / math.pi * terms.T @ np.sin(wave)


def losses(
    velocity: np.ndarray, law: Relaxation, cover: Cover, solution: Solution
) -> np.ndarray:
    """Resistance [N/m] of each relaxation time at each point: branches x points;
    numbers only, one cover, no dashpot.

    Every wave strains the cover as it does an elastic one, so that of its loss the
    branch k has the part E_k''(kv)/E''(kv):  F_k = (2/pi) int W |p(k)|^2 E_k''/|E*|^2
    dk, p(k) a sum of Bessel functions.
    """
    order = solution.terms.shape[1]
    waves = _loss_waves(order)
    y, weight = waves.nodes, waves.weight
    sign = np.array([1.0, -1.0])[(np.arange(order) // 2) % 2]
    power = (
        (solution.terms * sign)[:, ::2] @ waves.even,
        (solution.terms * sign)[:, 1::2] @ waves.odd,
    )
    spread = power[0] ** 2 + power[1] ** 2  # |p|^2 over L^2
    late = y > 0.75 * _LOSS_END  # |p|^2 falls as y^-3 behind its last wave
    edge = np.sum(spread[:, late] * y[late] ** 3 * weight[late], axis=1) / np.sum(
        weight[late]
    )
    far, far_weight = gauss_on_panels(_LOSS_END * 2.0 ** np.arange(0, 31), 8)
    y, weight = np.concatenate([y, far]), np.concatenate([weight, far_weight])
    spread = np.concatenate([spread, edge[:, None] / far**3], axis=1)
    k = y / solution.half[:, None]
    each = 2 / math.pi * solution.half[:, None] * spread * weight
    if cover.thickness is not None and cover.squeeze is not None:
        each = each * layer_kernel(k * cover.thickness, cover.squeeze, cover.bonded)
    moduli, times = np.asarray(law.moduli), np.asarray(law.times)
    by_branch = np.empty((moduli.size, velocity.size))
    for point, waves in enumerate(k):  # one at a time, which the cache holds
        x = times[:, None] * (waves * velocity[point])
        loss = x / (1 + x * x)
        lost = moduli @ loss
        stored = law.equilibrium + moduli @ (x * loss)
        by_branch[:, point] = loss @ (each[point] / (stored**2 + lost**2))
    return moduli[:, None] * by_branch


# kL of the last wave that is summed: where every term falls as it does for good
_LOSS_END = 4097.0


class _LossWaves(NamedTuple):
    nodes: np.ndarray  # kL
    weight: np.ndarray
    even: np.ndarray  # transforms of the even terms there, but for signs: terms x nodes
    odd: np.ndarray  # of the odd ones


@functools.lru_cache(maxsize=4)
def _loss_waves(order: int) -> _LossWaves:
    from scipy.special import jv

    ends = np.concatenate([_SHRINKING, np.arange(5.0, _LOSS_END + 1, 4.0)])
    y, weight = gauss_on_panels(ends, 8)
    terms = (
        math.pi
        * np.arange(1, order + 1)[:, None]
        * jv(np.arange(1, order + 1)[:, None], y)
        / y
    )
    return _LossWaves(y, weight, terms[::2], terms[1::2])


# What a Kelvin element remembers of a contact, in closed form.
#
# A pressure over |t| < 1 whose n-th term has the transform J_n(y)/y leaves in the slope,
# of a surface that gives way by 1/(1 - iy/z) to the wave exp(iyt), z = 1/l with the memory
# l in half-lengths, the m-th Chebyshev polynomial with the share
#
#     Re[i^(m-n) int_0^inf J_m J_n/(y (1 - iy/z)) dy] = [m = n]/2n - I_m(z) K_n(z),    m >= n,
#
# and (-1)^(m-n) times that of (n, m) where m < n. Where m - n is even this is Watson's
# integral (Theory of Bessel Functions, 13.53); where it is odd it follows from its
# neighbours, as J_(m-1) + J_(m+1) = 2m J_m/y. The products are needed for n = 0 and n = 1
# (`bessel_products`). I_m comes from its ratios, downwards, which begin with Debye's
# expansion for large orders (DLMF 10.41).

_HIGHER = 16  # orders above the last one, where the ratios begin
_LARGE, _POWERS = 2.0, 18  # from where on, and terms of the series below


class Products(NamedTuple):
    """Of orders m = 0 ... top along the first axis."""

    with_first: Array  # I_m K_0
    with_second: Array  # I_m K_1
    diagonal: Array  # 1/2 - I_1 K_1, to full relative accuracy


def bessel_products(z: Array, top: int) -> Products:
    """I_m(z) K_0(z) and I_m(z) K_1(z), m = 0 ... `top`, z > 0 of any shape."""
    ratios = _ratios(z, top)
    product = _first_product(z, ratios[0])

    def next_order(before: Array, ratio: Array) -> tuple[Array, Array]:
        after = before * ratio
        return after, after

    _, over_first = scan(next_order, xp.ones_like(z), ratios)
    over_first = xp.concatenate([xp.ones_like(z)[None], over_first])  # I_m/I_0
    # Wronski: I_0 K_1 = 1/z - I_1 K_0
    second = 1 / z - over_first[1] * product
    # I_1/z = (I_0 - I_2)/2
    diagonal = 0.5 * over_first[2] + over_first[1] ** 2 * product
    return Products(over_first * product, over_first * second, diagonal)


def _ratios(z: Array, top: int) -> Array:
    """I_m/I_(m-1), m = 1 ... `top`."""
    last = top + _HIGHER

    def lower(above: Array, order: Array) -> tuple[Array, Array]:
        ratio = z / (2 * order + z * above)
        return ratio, ratio

    orders = np.arange(last - 1, 0, -1.0)
    _, ratios = scan(lower, _first_ratio(z, last), orders)
    return ratios[::-1][:top]


def _first_ratio(z: Array, order: int) -> Array:
    """I_n/I_(n-1) of one large order n, by three terms of Debye's expansion."""
    p = 1 / xp.sqrt(1 + (z / order) ** 2)
    q = p**2
    value = 1 + p / order * (
        (3 - 5 * q) / 24
        + p / order * (81 + q * (-462 + 385 * q)) / 1152
        + (p / order) ** 2
        * (30375 + q * (-369603 + q * (765765 - 425425 * q)))
        / 414720
    )
    slope = 1 + p / order * (
        (-9 + 7 * q) / 24
        + p / order * (-135 + q * (594 - 455 * q)) / 1152
        + (p / order) ** 2
        * (-42525 + q * (451737 + q * (-883575 + 475475 * q)))
        / 414720
    )
    # I_(n-1) = I_n' + (n/z) I_n,  I_n'/I_n = (n/z) slope/(p value)
    return z / order / (1 + slope / (p * value))


def _first_product(z: Array, ratio: Array) -> Array:
    """I_0 K_0, from I_1/I_0: by the power series of K_0 (DLMF 10.31.2) for z < 2, above
    by Wronski's 1/z = I_0 K_0 (K_1/K_0 + I_1/I_0).
    """
    small = z < _LARGE
    square = xp.where(small, 0.5 * z, 1.0) ** 2
    harmonic = arrays(np.cumsum(1 / np.arange(1.0, _POWERS)))

    def next_power(k: Array | int, state: tuple) -> tuple:
        term, i_0, rest = state
        term = term * square / (k * k)
        return term, i_0 + term, rest + harmonic[k - 1] * term

    first = xp.ones_like(z), xp.ones_like(z), xp.zeros_like(z)
    _, i_0, rest = fori_loop(1, _POWERS, next_power, first)
    k_0 = rest - (0.5 * xp.log(square) + np.euler_gamma) * i_0
    x = 2 * _LARGE / xp.where(small, _LARGE, z) - 1
    coefficients = arrays(_ratio_of_k()[::-1])

    def clenshaw(k: Array | int, state: tuple) -> tuple:
        last, before = state
        return coefficients[k] + 2 * x * last - before, last

    first = xp.zeros_like(z), xp.zeros_like(z)
    last, before = fori_loop(0, len(coefficients) - 1, clenshaw, first)
    k_ratio = coefficients[-1] + x * last - before
    return xp.where(small, i_0 * k_0, 1 / (z * (k_ratio + ratio)))


@functools.cache
def _ratio_of_k() -> np.ndarray:
    """Chebyshev coefficients of K_1/K_0 over 4/z - 1, z > 2; from the integrals of
    exp(-z cosh(a)) cosh(na), for which the trapezoidal rule converges exponentially.
    """
    count = 32
    x = np.cos(math.pi * (np.arange(count) + 0.5) / count)
    z = 2 * _LARGE / (1 + x[:, None])
    a = np.arccosh(1 + 40 / z) * (np.arange(64) / 64)
    fall = np.exp(-2 * z * np.sinh(a / 2) ** 2)
    fall[:, 0] *= 0.5
    ratio = np.sum(fall * np.cosh(a), axis=1) / np.sum(fall, axis=1)
    degree = np.arange(count)[:, None]
    to = np.cos(degree * np.arccos(x)) * np.where(degree == 0, 1, 2) / count
    return to @ ratio


def slopes_of_all(first: Array, second: Array, order: int) -> Array:
    """The shares of all terms n = 1 ... `order` in all polynomials m = 1 ... `order`,
    (points, m, n), of whatever gives way to waves: from those of the terms 0 and 1 in
    the polynomials up to 2 `order` + 1, (m, points).

    The recurrence of J_m and that of J_n make m (B_{m,n+1} - B_{m,n-1}) =
    n (B_{m-1,n} - B_{m+1,n}), in which errors do not grow for m > n; the others follow
    by symmetry.
    """
    count = first.shape[0]
    degree = np.arange(count, dtype=float)[:, None]
    below = xp.zeros_like(first[:1])

    def next_term(state: tuple, n: Array) -> tuple[tuple, Array]:
        before, now = state
        change = xp.concatenate([now[2:] - now[:-2], below])
        change = xp.concatenate([below, change]) * (n / np.maximum(degree, 1.0))
        after = xp.where(degree > n, before - change, 0.0)
        return (now, after), now[1 : order + 1]

    terms = np.arange(1.0, order + 1)
    _, lower = scan(next_term, (first, second), terms)
    lower = xp.transpose(lower, (2, 1, 0))  # points, m, n
    m, n = terms[:, None], terms
    sign = (-1.0) ** (m - n)
    return xp.where(m >= n, lower, sign * xp.swapaxes(lower, 1, 2))
