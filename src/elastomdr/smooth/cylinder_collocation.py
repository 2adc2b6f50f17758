"""A cylinder that slides or rolls steadily on a half-space or a layer, in plane strain,
without friction: collocation.

The contact is x = xc + L t, |t| < 1, counted from the apex, in which the pressure is

    p = sqrt(1 - t^2) sum_n c_n U_n(t),      n < N.

The slope u' = -x/R of the surface is met at the roots of T_{N+1}: linear in (c_n, xc/R)
once L is given, so that both edges come out. An elastic half-plane has the slope -2
T_{n+1}(t)/E* under the n-th term, and ahead of it -2 (t - sqrt(t^2 - 1))^{n+1}/E*. A
Kelvin element of the creep function remembers what came from ahead, exp(-s/l) ds/l with
l = v lambda/L. What becomes of the slopes depends on l alone, and is tabulated once
(`memory_table`). From that a layer takes

    (2/pi) Im int_0^inf D(k) p(k) exp(ikx) dk,      D = sum over the covers of (1 - W)/E*(-kv),

whose integrand falls as exp(-2kh), so that few waves serve (`layer_waves`). A material
without instantaneous compliance, one that begins with a dashpot, has an infinite
pressure at its leading edge: one more term, sqrt((1 + t)/(1 - t)), and t = 1 as one
more point.

Load and friction force per length are P = (pi/2) L c_0 and F = (L/R) ((pi/2) xc c_0 +
(pi/4) L c_1). Source: Hunter 1961 for the standard solid on a half-plane, of which this
is the general case.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fixed, xp
from ..checks import Array
from ..element.layer import layer_deficit, layer_kernel
from ..material.relaxation import KelvinChain, Relaxation
from ..numerics.quadrature import gauss, gauss_on_panels
from ..numerics.root import search
from ..trees import Tree, static

_FIRST = 16  # terms in the search for the half-length
# of the logarithm of the half-length, after which one is close enough
_SMALL_STEP = 1e-6

_STEP = math.log(10) / 12  # between the nodes of the memory table
_REACH = 24  # nodes over which it is interpolated, each way
# memories l in the table; shorter ones are none, longer ones follow their limit
_SHORT, _LONG = 1e-10, 1e16
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
        part = self.chain.compliances / (1 + x**2)
        return self.chain.instantaneous + part.sum(axis=-1), (part * x).sum(axis=-1)

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


class Waves(Tree):
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
    # c_n [Pa], with that of the infinite pressure last where there is a dashpot
    terms: Array


def solve_at(
    problem: Cylinders, half: Array, order: int, waves: Waves | None, dashpot: bool
) -> Solution:
    """The contact of half-length `half` [m] at each point, by `order` terms; `dashpot`:
    with an infinite pressure.
    """
    rows = order + 2 if dashpot else order + 1
    matrix = _half_plane(problem, half, order)[:, :rows, : rows - 1]
    if waves is not None:
        matrix = matrix + _of_layer(half, order, waves)[:, :rows, : rows - 1]
    scale = xp.max(xp.abs(fixed(matrix)), axis=(1, 2))
    whole = xp.concatenate(
        [matrix / scale[:, None, None], xp.ones((matrix.shape[0], rows, 1))], axis=-1
    )
    right = xp.broadcast_to(
        -xp.asarray(_points(order)[:rows, None]), (matrix.shape[0], rows, 1)
    )
    found = xp.linalg.solve(whole, right)[..., 0]
    terms, xc = found[:, :-1] / scale[:, None], found[:, -1]
    first, second = 0.5 * terms[:, 0], 0.25 * terms[:, 1]
    if dashpot:
        first, second = first + terms[:, -1], second + 0.5 * terms[:, -1]
    load = math.pi * half**2 / problem.radius * first
    mu = half / problem.radius * (xc + second / first)
    return Solution(half, xc * half, load, mu, terms * (half / problem.radius)[:, None])


def depth(problem: Cylinders, solution: Solution, order: int) -> Array:
    """Depth of the apex below the surface at rest [m]: from the mean over the contact,
    weighted by (1 - t^2)^(3/2).
    """
    real, imaginary = _displacement(problem, solution, order)
    del imaginary
    y, weight, mean = (xp.asarray(x) for x in _depth_waves())
    bend = (solution.shift**2 + solution.half**2 / 6) / (2 * problem.radius)
    return bend + solution.half * (real @ (weight * mean / y))


def least_gap(problem: Cylinders, solution: Solution, order: int, deep: Array) -> Array:
    """The smallest gap beside the contact over the undeformed one, where it is looked
    at; negative: it touches.
    """
    y, weight, _ = (xp.asarray(x) for x in _depth_waves())
    real, imaginary = _displacement(problem, solution, order)
    t = xp.asarray(_BESIDE)
    wave = y[:, None] * t
    u = (real * weight / y) @ xp.cos(wave) - (imaginary * weight / y) @ xp.sin(wave)
    half = solution.half[:, None]
    rise = (solution.shift[:, None] + half * t) ** 2 / (2 * problem.radius)
    return xp.min((rise - deep[:, None] + half * u) / rise, axis=1)


def least_pressure(solution: Solution, order: int, dashpot: bool) -> Array:
    """The smallest pressure over the largest one, at many points of the contact;
    negative: it pulls.
    """
    angle = math.pi * (np.arange(200) + 0.5) / 200
    terms = np.sin(angle[:, None] * np.arange(1, order + 1))
    pressure = solution.terms[:, :order] @ xp.asarray(terms.T)
    if dashpot:
        pressure = pressure + solution.terms[:, -1:] * xp.asarray(
            (1 + np.cos(angle)) / np.sin(angle)
        )
    return xp.min(pressure, axis=1) / xp.max(pressure, axis=1)


def _displacement(
    problem: Cylinders, solution: Solution, order: int
) -> tuple[Any, Any]:
    """Real and imaginary part of (2/pi) C p of each wave kL, over L."""
    y, _, _ = (xp.asarray(x) for x in _depth_waves())
    k = y / solution.half[:, None]
    real, imaginary = (
        xp.asarray(x)[: solution.terms.shape[1]] for x in _depth_terms(order)
    )
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
    guess: Array,
    order: int,
    waves: Waves | None,
    dashpot: bool,
) -> Array:
    """Half-length [m] at which load per length [N/m] or depth [m] is the one `wanted`,
    NaN where none was found; on NumPy.
    """

    def residual(log: Array, terms: int) -> Array:
        found = solve_at(problem, np.exp(log), terms, waves, dashpot)
        value = depth(problem, found, terms) if by_depth else found.load
        return np.log(np.maximum(value, 1e-300)) - np.log(wanted)

    log, found = search(lambda x: residual(x, _FIRST), np.log(guess))
    slope = (residual(log + 1e-4, _FIRST) - residual(log, _FIRST)) / 1e-4
    # few terms may know little of the slope: it is where the search begins
    log, reached = search(
        lambda x: residual(x, order), log, _SMALL_STEP, slope, longest=0.5
    )
    return np.where(found & reached, np.exp(log), np.nan)


def layer_waves(problem: Cylinders, ratio: float) -> Waves | None:
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
    z, fine, spread, rest, weight = (xp.asarray(x) for x in _wave_rule(ratio))

    def lacking(z: Array) -> tuple[Any, Any]:
        k = z / thickness
        parts = [
            cover.of_kernel(layer_deficit, k, k * problem.velocity[:, None])
            for cover in problem.covers
        ]
        return sum(part[0] for part in parts), sum(part[1] for part in parts)

    near, far = lacking(fine), lacking(rest)
    real, imaginary = (
        xp.concatenate([a @ spread, b * weight], axis=1)
        for a, b in zip(near, far, strict=True)
    )
    return Waves(z, real, imaginary, thickness, ratio)


def _of_layer(half: Array, order: int, waves: Waves) -> Array:
    """What the layer takes from the slopes: points x nodes x terms."""
    s, to_terms = (xp.asarray(x) for x in _pressure_rule(order, _DEEP * waves.ratio))
    t = xp.asarray(_points(order))
    ratio = half / waves.thickness
    phase = (ratio[:, None] * waves.z)[:, None, :]  # points x 1 x waves
    at, of = t[:, None] * phase, s[:, None] * phase
    real, imaginary = waves.real[:, None], waves.imaginary[:, None]
    cosine, sine = xp.cos(at), xp.sin(at)
    # Im (D e^{i(a - b)}) = (Re D sin a + Im D cos a) cos b - (Re D cos a - Im D sin a)
    # sin b
    left = xp.concatenate(
        [real * sine + imaginary * cosine, imaginary * sine - real * cosine], axis=2
    )
    cosine, sine = to_terms.T @ xp.cos(of), to_terms.T @ xp.sin(of)
    right = xp.concatenate([cosine, sine], axis=2)
    return (2 / math.pi) * ratio[:, None, None] * (left @ xp.swapaxes(right, 1, 2))


def _half_plane(problem: Cylinders, half: Array, order: int) -> Array:
    """Slopes of half-planes under each term: points x nodes x terms."""
    table, at_once = memory_table(order)
    weights, instantaneous = xp.zeros((half.shape[0], _grid().size)), 0.0
    for cover in problem.covers:
        memory = problem.velocity[:, None] * cover.chain.times / half[:, None]
        weights = weights + (cover.chain.compliances @ _interpolation(memory))
        instantaneous = instantaneous + cover.chain.instantaneous
    slopes = weights @ xp.asarray(table)
    return slopes.reshape(-1, order + 2, order + 1) + instantaneous * xp.asarray(
        at_once
    )


def remembered(problem: Cylinders, half: Array) -> Array:
    """Whether some memory of a contact lies within the table; true of elastic bodies,
    which have none. Beyond the table at either end friction is less than the rounding
    of the pressures.
    """
    memories = [
        problem.velocity[:, None] * cover.chain.times / half[:, None]
        for cover in problem.covers
    ]
    every = xp.concatenate(memories, axis=1)
    if every.shape[1] == 0:
        return xp.ones(half.shape, dtype=bool)
    return xp.any((every >= _SHORT) & (every <= _LONG), axis=1)


def _interpolation(memory: Array) -> Array:
    """Weights of the nodes of the table for memories l of any shape, one more axis: a
    Gaussian times sinc.
    """
    place = (xp.log(xp.clip(memory, _SHORT, _LONG)) - _grid()[0]) / _STEP
    apart = place[..., None] - np.arange(_grid().size)
    near = place - fixed(xp.round(place))
    apart = xp.where(xp.abs(apart) < 1e-7, 1e-7, apart)
    alternating = xp.sin(math.pi * xp.where(xp.abs(near) < 1e-7, 1e-7, near))[..., None]
    weight = (
        alternating
        * (-1.0) ** np.arange(_grid().size)
        / apart
        * xp.exp(-math.pi / (2 * _REACH) * apart**2)
    )
    return weight / ((1 + memory) * xp.sum(weight, axis=-1))[..., None]


@functools.cache
def _grid() -> np.ndarray:
    """Nodes of the table: logarithms of the memory."""
    first = math.log(_SHORT) - _REACH * _STEP
    return first + _STEP * np.arange(
        round(math.log(_LONG / _SHORT) / _STEP) + 2 * _REACH + 1
    )


@functools.lru_cache(maxsize=8)
def memory_table(order: int) -> tuple[np.ndarray, np.ndarray]:
    """Slopes of a half-plane under each term that are remembered with l, times 1 + l,
    and those at once.

    Shapes (nodes of l, points * terms) and (points, terms). The last point is t = 1,
    the last term the infinite pressure. With S_n = T_n inside and exp(-n theta) at t =
    cosh(theta) ahead, everywhere S_n = (S'_{n+1}/(n + 1) - S'_{n-1}/(n - 1))/2; and
    what is remembered, Y - l Y' = S, commutes with the derivative. So d_n = (Y_n -
    S_n)/n obeys d_{n+1} = d_{n-1} + 2 l (n d_n + S_n): forwards where l is short, else
    as a tridiagonal system with both ends known.
    """
    memory = np.exp(_grid())[:, None]
    t = _points(order)
    top = order + 1
    ahead, endless = _ahead(top, memory[:, 0])
    # T_n at the points
    source = np.cos(np.arange(top + 1)[:, None] * np.arccos(np.clip(t, -1, 1)))

    def remembered(n: int, where: slice, less: np.ndarray | float) -> np.ndarray:
        """Y_n - `less` by quadrature, for some memories; `less` does not depend on
        them.
        """
        l = memory[where]
        nodes, weights = gauss(24 + n)
        reach = np.minimum((1 - t) / l, 42.0)  # in units of the memory
        s = 0.5 * reach[..., None] * (nodes + 1)
        there = np.clip(t[:, None] + l[..., None] * s, -1, 1)
        change = np.cos(n * np.arccos(there)) - np.reshape(less, (-1, 1))
        inside = (change * np.exp(-s)) @ weights * 0.5 * reach
        return inside + np.exp(-(1 - t) / l) * (ahead[where, n][:, None] - less)

    d = np.zeros((top + 1, memory.size, t.size))
    short = int(np.searchsorted(memory[:, 0], 8 / top**2))
    low, high = slice(0, short), slice(short, None)
    d[1] = remembered(1, slice(None), source[1])
    d[2, low] = remembered(2, low, source[2]) / 2
    d[top, high] = remembered(top, high, source[top]) / top
    for n in range(2, top):
        d[n + 1, low] = d[n - 1, low] + 2 * memory[low] * (n * d[n, low] + source[n])
    # rows n = 2 ... top - 1 of -d_{n-1} - 2 l n d_n + d_{n+1} = 2 l S_n, eliminated
    # downwards, solved upwards
    l = memory[high]
    pivot, right = np.zeros((top, *l.shape)), np.zeros((top, l.size, t.size))
    for n in range(2, top):
        pivot[n], right[n] = -2 * l * n, 2 * l * source[n]
        if n == 2:
            right[n] += d[1, high]
        else:
            pivot[n] += 1 / pivot[n - 1]
            right[n] += right[n - 1] / pivot[n - 1]
    for n in range(top - 1, 1, -1):
        d[n, high] = (right[n] - d[n + 1, high]) / pivot[n]
    slopes = np.empty((memory.size, t.size, top))
    n = np.arange(1, top)
    slopes[..., :-1] = -2 * np.moveaxis(
        n[:, None, None] * d[1:top] + source[1:top, None], 0, -1
    )
    # what a long memory keeps is little: 2 l Y_n = d_{n+1} - d_{n-1} has it to full
    # relative accuracy
    long = slice(int(np.searchsorted(memory[:, 0], 1.0)), None)
    kept = (d[3:, long] - d[1 : top - 1, long]) / (2 * memory[long])
    slopes[long, :, 1:-1] = -2 * np.moveaxis(kept, 0, -1)
    slopes[long, :, 0] = -2 * remembered(1, long, 0.0)
    fall = np.exp(-(1 - t) / memory)
    slopes[..., -1] = -2 * np.expm1(-(1 - t) / memory) + fall * endless[:, None]
    at_once = np.concatenate(
        [-2 * source[1:top].T, np.full((t.size, 1), np.nan)], axis=1
    )
    at_once[:, -1] = 0.0  # not used: a dashpot has no compliance at once
    return (slopes * (1 + memory[..., None])).reshape(memory.size, -1), at_once


def _ahead(top: int, memory: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """At t = 1: S_n, n = 0 ... top, and the slope of the infinite pressure, as
    remembered from ahead of the contact.
    """
    nodes, weights = gauss_on_panels(
        np.concatenate([[0.0], 2.0 ** np.arange(-16, -5), np.arange(1, 33) / 32]), 12
    )
    far = np.arccosh(1 + 42 * memory)[:, None]
    theta = far * nodes
    bulge = 2 * np.sinh(theta / 2) ** 2 / memory[:, None]
    share = np.exp(-bulge) * np.sinh(theta) / memory[:, None] * far * weights
    falls = np.exp(-theta[:, None, :] * np.arange(top + 1)[:, None])
    return np.einsum("lnq,lq->ln", falls, share), -4 * (share / np.expm1(theta)).sum(
        axis=1
    )


def _points(order: int) -> np.ndarray:
    """Where the slope is met: the roots of T_{order+1}, and t = 1."""
    return np.append(np.cos(math.pi * (np.arange(order + 1) + 0.5) / (order + 1)), 1.0)


_SHRINKING = np.concatenate([[0.0], 4.0 ** np.arange(-26, 1)])  # panels towards zero


@functools.lru_cache(maxsize=16)
def _wave_rule(ratio: float) -> tuple[np.ndarray, ...]:
    """Waves z; fine nodes of the first panel and what each adds to its waves; the other
    nodes and their weights.
    """
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
    return (
        np.concatenate([0.5 * width * (nodes + 1), others]),
        width * fine,
        spread,
        others,
        weight,
    )


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
    y, weight, even, odd = _loss_waves(order)
    sign = np.array([1.0, -1.0])[(np.arange(order) // 2) % 2]
    power = (
        (solution.terms * sign)[:, ::2] @ even,
        (solution.terms * sign)[:, 1::2] @ odd,
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
    omega = k * velocity[:, None]
    size = np.abs(law.complex_modulus(omega)) ** -2
    if cover.thickness is not None:
        size = size * layer_kernel(k * cover.thickness, cover.squeeze, cover.bonded)
    each = 2 / math.pi * solution.half[:, None] * spread * size * weight
    found = []
    for modulus, time in zip(law.moduli, law.times, strict=True):
        x = omega * time
        found.append(np.sum(each * modulus * x / (1 + x**2), axis=1))
    return np.array(found)


# kL of the last wave that is summed: where every term falls as it does for good
_LOSS_END = 4097.0


@functools.lru_cache(maxsize=4)
def _loss_waves(order: int) -> tuple[np.ndarray, ...]:
    """kL, its weights, and the transforms of the even and the odd terms there, but for
    signs.
    """
    from scipy.special import jv

    ends = np.concatenate([_SHRINKING, np.arange(5.0, _LOSS_END + 1, 4.0)])
    y, weight = gauss_on_panels(ends, 8)
    terms = (
        math.pi
        * np.arange(1, order + 1)[:, None]
        * jv(np.arange(1, order + 1)[:, None], y)
        / y
    )
    return y, weight, terms[::2], terms[1::2]
