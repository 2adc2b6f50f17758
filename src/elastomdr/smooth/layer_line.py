"""Steady sliding of the MDR line on a layer: many points at once, each solved for its
two edges.

In the frame of the body, which moves along +x, with the memory lengths l_k = v lambda_k
of the creep function of E*,

    J o q (x) - (1/(pi h)) int_0^inf Re[conj(D) e^(izx/h) int q e^(-izs/h) ds] dz = d - g(x),
    -b < x < a,

D = (1 - W)/E* at z = kh and w = kv, and J o q = J_0 q(x) + sum_k J_k int_0^inf q(x + s)
exp(-s/l_k) ds/l_k. q is zero at both edges. It is a polynomial ahead of the apex and
another behind it, by its values at Chebyshev's points, which crowd where the profile
bends and where fast branches leave layers, at the edges. What a branch remembers of a
polynomial depends on l over the length of the panel alone and is tabulated once. For
given edges all is linear; a and b follow from the load (or the depth) and q(-b) = 0, by
Newton's method on logarithms.

The integral over z is the trapezoidal rule in y, z = ln(1 + e^y), which converges
exponentially: it sees memories of any length below z = 1 and the waves e^(izx/h) above.
Derived here; checked against cells in three dimensions.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_numpy, xp
from ..checks import Array
from ..material.relaxation import KelvinChain
from ..numerics.interpolation import lagrange
from ..numerics.quadrature import gauss, gauss_unit
from ..surface.shapes import AbstractShape

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

# of the table, in log l
_LOW, _HIGH, _STEP, _STENCIL = math.log(1e-7), math.log(1e10), 0.25, 12
_TAIL, _LEAST = 14.0, -18.0  # ends of the rule in y
_LONG = 9  # waves that stand for all those longer than the contact
_SLOPES = 1e-5  # of the logarithm of an edge, over which slopes are taken
_MOST, _CLOSE = 40, 1e-10  # steps of the search, and the residual at which it ends
_FURTHEST = 6.0  # that the logarithm of an edge may go from its guess
_LONGEST = 0.7  # step of the logarithm of an edge


class Sliding(NamedTuple):
    """What a line on a layer is given: compliances of all covers added."""

    shape: AbstractShape
    chain: KelvinChain  # J(t) of the half-space
    # (1 - W)/E* at z = kh and omega = kv [1/Pa]
    deficit: Callable[[Array, Array], Array]
    thickness: Any  # h [m]
    reach: float  # largest (a + b)/h that the rule resolves
    order: int  # of the polynomials


class Slid(NamedTuple):
    """Solved points."""

    mu: Float[Array, " points"]
    load: Float[Array, " points"]  # [N]
    depth: Float[Array, " points"]  # of the line [m]
    leading: Float[Array, " points"]  # [m]
    trailing: Float[Array, " points"]  # [m]
    converged: Bool[Array, " points"]
    lowest: Float[Array, " points"]  # least force density over the largest


def slide_on_layer(
    on: Sliding,
    velocity: Array,
    control: str,
    value: Array,
    guess: tuple[Array, Array],
    close: float = _CLOSE,
    slopes: Array | None = None,
) -> tuple[Slid, Array]:
    """Points (velocity [m/s], load [N] or depth [m]), from guesses at the edges a and b
    [m], to a residual `close`; both edges at once, by Broyden's method. With the slopes
    that it ended with: another order of polynomials may begin with them.
    """

    def equation(logs: Array) -> Array:
        return equations(on, logs, velocity, value, control)[0]

    start = np.log(np.stack(list(guess)))
    miss = equation(start)
    slopes = _slopes(equation, start, miss) if slopes is None else slopes
    logs = start
    for _ in range(_MOST):
        if not np.max(np.abs(np.where(np.isfinite(miss), miss, 1.0))) > close:
            break
        step = np.clip(_solve2(slopes, miss), -_LONGEST, _LONGEST)
        step = np.where(np.isfinite(step), step, 0.1)
        new = np.clip(logs - step, start - _FURTHEST, start + _FURTHEST / 2)
        new_miss = equation(new)
        slopes = _broyden(slopes, new_miss - miss, logs - new)
        logs, miss = new, new_miss
    good = np.max(np.abs(miss), axis=0) < 1e-6
    logs = logs - _solve2(slopes, miss)
    _, line = equations(on, logs, velocity, value, control)
    leading, trailing = np.exp(logs)
    solved = Slid(
        line.force / line.load,
        line.load,
        line.depth,
        leading,
        trailing,
        good & np.isfinite(line.load),
        line.lowest,
    )
    return solved, slopes


def equations(
    on: Sliding, logs: Array, velocity: Array, value: Array, control: str = "load"
) -> tuple[Array, _Line]:
    """What is left of both equations at the logarithms of the edges: load or depth, and
    no pressure at the trailing edge, (2, points); and the line.
    """
    line = line_between(on, velocity, xp.exp(logs[0]), xp.exp(logs[1]))
    reached = line.load if control == "load" else line.depth
    miss = xp.log(xp.maximum(reached, 1e-6 * value) / value)
    return xp.stack([miss, line.last / line.mean]), line


def _slopes(
    equation: Callable[[Array], Array], logs: Array, here: Array
) -> Float[Array, "equations edges points"]:
    """By differences to one side of the values that are known."""
    columns = [
        (equation(logs + _SLOPES * edge[:, None]) - here) / _SLOPES
        for edge in np.eye(2)
    ]
    return np.stack(columns, axis=1)


def _broyden(jacobian: Array, change: Array, step: Array) -> Array:
    """Broyden's update of the slopes, after a step back by `step`."""
    size = np.sum(step**2, axis=0)
    more = change + np.sum(jacobian * step[None], axis=1)
    return jacobian - more[:, None] * step[None] / np.where(size > 1e-30, size, np.inf)


class _Line(NamedTuple):
    load: Array
    force: Array
    depth: Array
    last: Array  # q(-b)
    mean: Array
    lowest: Array


def line_between(on: Sliding, velocity: Array, a: Array, b: Array) -> _Line:
    """The line between given edges, for each point."""
    n = on.order
    rule = _rule(n)
    node = rule.node  # from the trailing to the leading end of a panel
    ahead, behind = 0.5 * a[:, None] * (1 + node), 0.5 * b[:, None] * (node - 1)
    count = a.shape[0]
    chain, h = on.chain, on.thickness
    local = _memories(chain, velocity, a, b, behind, rule)
    x = xp.concatenate([behind, ahead], axis=1)
    share = xp.concatenate(
        [0.5 * b[:, None] * rule.weight, 0.5 * a[:, None] * rule.weight], axis=1
    )
    z, few, to_few = _waves(on.reach)
    # what materials take; beyond, all is at rest
    omega = xp.clip(z[None] * (velocity[:, None] / h), 1e-99, 1e99)
    loss = on.deficit(xp.asarray(z)[None], omega) @ to_few  # (points, waves)
    phase = (x / h)[..., None] * few
    cosine, sine = xp.cos(phase), xp.sin(phase)
    real, lost = xp.real(loss)[:, None], xp.imag(loss)[:, None]
    # Re (conj(D) e^{i(a - b)}) with D = real + i lost
    left = [real * cosine + lost * sine, real * sine - lost * cosine]
    smooth = xp.concatenate(left, axis=2) @ xp.swapaxes(
        xp.concatenate([cosine, sine], axis=2), 1, 2
    )
    full = local - smooth * (share / (math.pi * h))[:, None]
    # The apex is a node of both panels: one value, one equation.
    columns = xp.concatenate(
        [
            full[:, :, :n],
            (full[:, :, n] + full[:, :, n + 1])[:, :, None],
            full[:, :, n + 2 : -1],
        ],
        axis=2,
    )
    keep = np.delete(np.arange(2 * n + 2), n + 1)
    scale = xp.sum(chain.compliances) + chain.instantaneous
    matrix = xp.concatenate(
        [columns[:, keep] / scale, -xp.ones((count, 2 * n + 1, 1))], axis=2
    )
    g = on.shape._profile(x)[:, keep]
    size = g[:, :1] + g[:, -1:]
    unknowns = xp.linalg.solve(matrix, -(g / size)[..., None])[..., 0]
    q = xp.concatenate([unknowns[:, :-1], xp.zeros((count, 1))], axis=1) * size / scale
    depth = unknowns[:, -1] * size[:, 0]
    return _forces(on.shape, rule, a, b, q, depth)


def _memories(
    chain: KelvinChain, velocity: Array, a: Array, b: Array, behind: Array, rule: _Rule
) -> Array:
    """What branches remember of the pressure, on both panels and across the apex:
    matrices on its values at the nodes, trailing panel first.
    """
    n, count = rule.node.size - 1, a.shape[0]
    length = velocity[:, None] * chain.times
    eye = np.eye(n + 1)
    rows = []
    table = rule.table
    for half in (0.5 * a, 0.5 * b):
        weight, plain = _weights(
            length / half[:, None], chain.compliances, table.shape[0]
        )
        within_panel = (
            xp.sum(weight, axis=1) @ table.reshape(table.shape[0], -1)
        ).reshape(count, n + 1, n + 1)
        rows.append(
            (
                within_panel
                + (chain.instantaneous + xp.sum(plain, axis=1))[:, None, None] * eye,
                weight,
                plain,
            )
        )
    (first, weight, plain), (second, _, _) = rows
    # J_k times what branch k brings to the apex
    leaving = weight @ table[:, 0, :] + plain[..., None] * eye[0]
    fading = xp.exp(behind[:, :, None] / length[:, None, :])
    nothing = xp.zeros((count, n + 1, n + 1))
    return xp.concatenate(
        [
            xp.concatenate([second, fading @ leaving], axis=2),
            xp.concatenate([nothing, first], axis=2),
        ],
        axis=1,
    )


def _forces(
    shape: AbstractShape, rule: _Rule, a: Array, b: Array, q: Array, depth: Array
) -> _Line:
    """Load and drag of the pressures q at the nodes of both panels."""
    n = rule.node.size - 1
    q_behind, q_ahead = q[:, : n + 1], q[:, n:]
    # on (0, 1) from the apex outwards
    tau, weight_tau, to_tau = rule.place, rule.share, rule.to_place
    slope_ahead = shape._slope(a[:, None] * tau)
    slope_behind = shape._slope(b[:, None] * tau)
    drag = a * xp.sum(weight_tau * slope_ahead * (q_ahead @ to_tau.T), axis=1)
    drag = drag - b * xp.sum(
        weight_tau * slope_behind * (q_behind @ to_tau[:, ::-1].T), axis=1
    )
    load = 0.5 * a * (q_ahead @ rule.weight) + 0.5 * b * (q_behind @ rule.weight)
    lowest = xp.min(q, axis=1) / xp.max(q, axis=1)
    return _Line(load, drag, depth, q[:, 0], load / (a + b), lowest)


def _weights(l: Array, compliance: Array, size: int) -> tuple[Array, Array]:
    """Per branch, weights on the table times J_k, and what is added of q itself where a
    memory is very short.
    """
    log = xp.log(xp.maximum(l, 1e-280))
    inside = xp.clip(log, _LOW, _HIGH)
    place = (inside - _LOW) / _STEP + _STENCIL // 2
    near: Any
    near, weight = lagrange(place, _STENCIL, size)
    # below the table what is missing to q is linear in l
    short = xp.minimum(l / math.exp(_LOW), 1.0)
    amount = compliance * short / (1 + xp.maximum(l, math.exp(_LOW)))
    weight = weight * amount[..., None]
    spread: Any
    if on_numpy():
        spread = np.zeros((*l.shape, size))
        np.put_along_axis(spread, near, weight, axis=-1)
    else:
        spread = sum(
            xp.where(near[..., j, None] == np.arange(size), weight[..., j, None], 0.0)
            for j in range(_STENCIL)
        )
    return spread, compliance * (1 - short)


class _Rule(NamedTuple):
    node: np.ndarray  # Chebyshev's points, ascending
    weight: np.ndarray  # of Clenshaw and Curtis
    table: np.ndarray  # (l, place, node): (1 + l) int c_j(t + s) exp(-s/l) ds/l
    place: np.ndarray  # (0, 1), crowded at the apex, for the drag
    share: np.ndarray
    to_place: np.ndarray  # q there, from the values ahead of the apex


@functools.cache
def _rule(n: int) -> _Rule:
    node = -np.cos(np.pi * np.arange(n + 1) / n)
    # values to Chebyshev coefficients
    inverse = np.linalg.inv(np.polynomial.chebyshev.chebvander(node, n))
    moments = np.array([2 / (1 - k**2) if k % 2 == 0 else 0.0 for k in range(n + 1)])
    logs = _LOW + _STEP * np.arange(
        -(_STENCIL // 2), math.ceil((_HIGH - _LOW) / _STEP) + _STENCIL // 2 + 1
    )
    l = np.exp(logs)[:, None]
    table = (1 + l[..., None]) * _remembered(node, l, n) @ inverse
    tau, dtau, _ = gauss_unit(2 * n)
    place = tau**2
    to_place = np.polynomial.chebyshev.chebvander(2 * place - 1, n) @ inverse
    return _Rule(node, moments @ inverse, table, place, 2 * tau * dtau, to_place)


def _remembered(t: np.ndarray, l: np.ndarray, top: int) -> np.ndarray:
    """Y_k = int T_k(t + s) exp(-s/l) ds/l up to t + s = 1: memories, places,
    k = 0 ... `top`; by Gauss' rule as far as a memory reaches, and 2 x T_k = T_{k+1} +
    T_{k-1}.
    """
    nodes, weights = gauss(36 + top)
    reach = np.minimum((1 - t) / l, 42.0)[..., None]  # in units of the memory
    s = 0.5 * reach * (nodes + 1)
    twice = 2 * np.clip(t[:, None] + l[..., None] * s, -1.0, 1.0)
    before = 0.5 * reach * weights * np.exp(-s)
    now = 0.5 * twice * before
    kept = [before.sum(axis=-1), now.sum(axis=-1)]
    for _ in range(1, top):
        before, now = now, twice * now - before
        kept.append(now.sum(axis=-1))
    return np.stack(kept, axis=-1)


@functools.cache
def _waves(reach: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes in z = kh, waves that stand for them, and the matrix from one to the other
    with the weights of the nodes in it.

    Long waves, of which a contact sees less than a radian, differ from each other for
    the materials alone: for lengths up to `reach`, e^{izr} is a polynomial in z between
    a few of them.
    """
    step = min(0.4, 2 * math.pi / (reach + 15))
    y = np.arange(_LEAST, _TAIL, step)
    z = np.log1p(np.exp(y))
    weight = step / (1 + np.exp(-y))
    longest = min(1 / reach, 1.0)
    count = int(np.searchsorted(z, longest))
    nodes = longest * np.cos(math.pi / (4 * _LONG) * np.arange(1, 2 * _LONG, 2)) ** 2
    to_few = np.eye(z.size)[:, count - _LONG :] if count > _LONG else np.eye(z.size)
    if count <= _LONG:
        return z, z, to_few * weight[:, None]
    chebyshev = np.polynomial.chebyshev.chebvander
    back = np.linalg.inv(chebyshev(2 * nodes / longest - 1, _LONG - 1))
    to_few[:count, :_LONG] = chebyshev(2 * z[:count] / longest - 1, _LONG - 1) @ back
    return z, np.concatenate([nodes, z[count:]]), to_few * weight[:, None]


def _solve2(matrix: Array, right: Array) -> Array:
    """Solves (2, 2, points) for (2, points)."""
    det = matrix[0, 0] * matrix[1, 1] - matrix[0, 1] * matrix[1, 0]
    det = np.where(det == 0, np.inf, det)
    return np.stack(
        [
            (right[0] * matrix[1, 1] - right[1] * matrix[0, 1]) / det,
            (right[1] * matrix[0, 0] - right[0] * matrix[1, 0]) / det,
        ]
    )


def elastic_curve(on: Sliding, modulus: Array, places: Array) -> tuple[Array, Array]:
    """Load [N] and depth [m] of the relaxed layer at contact radii [m]; `modulus` is E*
    at rest [Pa].
    """
    none = np.zeros(0)
    rest = KelvinChain(1 / modulus, none, none, np.zeros(()))
    line = line_between(on._replace(chain=rest), xp.zeros_like(places), places, places)
    return line.load, line.depth
