"""What the foundation remembers of a sliding profile, by one recursion over panels, of
cost samples times branches.

The force density E v_k of a branch with the decay length s = v tau obeys dv_k/dx =
v_k/s - g' from the leading edge backwards. The profile is even, so that both sides of
the apex are one function of the distance X from it,

    L(X) = int_0^X e^{-x/s} g'(x) dx,
    B(X) = int_0^X e^{-(X-x)/s} g'(x) dx,
    P(X) = int_0^X g' B dx,

and with a and b the distances of leading and trailing edge (derived here)

    v_k(-b) = e^{-b/s} L(a) - B(b),        int v_k g' dx = P(a) + P(b) - L(a) L(b).

On a panel of width l behind x_0, with g' = sum_j c_j P_j(1 - 2c) at x_0 + l c and z =
l/s, the moments mu_j(z) of `element.moments` give all of them at the panel's end from
those at its start:

    B <- e^{-z} B + l m_b      L <- L + e^{-x_0/s} l m_f      P <- P + B l m_f + l^2 m_d
    m_f = sum_j c_j mu_j       m_b = sum_j (-1)^j c_j mu_j    m_d = sum_j kappa_j mu_j

kappa_j the coefficients of the panel's autocorrelation. Panels stay where they are
while the edges are sought: what they add up to is tabulated once, and an edge costs the
one panel that it cuts. Beside each of these stands what has faded, with 1 - e^{-...} in
place of e^{-...}, so that branches much slower than the passage keep their digits.

Axes: panels or edges, variants, lines, branches, points. Variants of the samples are
the error estimate: without the last two polynomials, and with the second off by what
Gauss' rule cannot see (the first, the mean, is exact).
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import on_numpy, scan, stop_gradient, tree_map, xp
from ..checks import Array
from ..element.moments import panel_sums
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss_unit
from ..surface.lines import AbstractLines, SingleLine
from ..surface.profile import Profile
from ..surface.sampling import Rule

if TYPE_CHECKING:
    from jaxtyping import Float


# part of a panel's place that its width has at least for its rise to have digits
_WIDE = 1e-3
_ROOM = 1.5  # for contacts larger than expected


class Memory(NamedTuple):
    """The functions above at some distance X from the apex."""

    near: Array  # L(X), how the apex feels what lies before it
    near_lost: Array  # int (1 - e^{-x/s}) g' dx
    far: Array  # B(X)
    far_lost: Array  # int (1 - e^{-(X-x)/s}) g' dx
    moment: Array  # int x g' dx
    work: Any  # P(X), an array; this and the next only in full, else None
    work_lost: Any  # int g' far_lost dx
    square: Any  # int g'^2 dx

    def each(self, function: Callable[[Any], Any]) -> Memory:
        """A function of all that there is."""
        fields: list[Any] = [None if x is None else function(x) for x in self]
        return Memory(*fields)


class Passage(NamedTuple):
    """What is the same for all integrals of one call."""

    law: Relaxation
    lines: AbstractLines
    rule: Rule
    velocity: Float[Array, " points"]
    # of the panels, where they are fixed: (panels, 1, 1, 1, points or 1)
    ends: Array | None = None
    table: Memory | None = None  # at these ends
    judged: bool = (
        True  # whether what is summed in full has the variants of the samples
    )

    @property
    def decay(self) -> Float[Array, "branches points"]:
        """Decay lengths s = v tau [m]."""
        return self.velocity * self.law.times[:, None]


def tabulated(p: Passage, size: Float[Array, " points"]) -> Passage:
    """The passage with the memory at the panels' ends; `size` says about how large the
    contact is.

    With the work, too, and the variants that an error estimate takes. A contact
    in strips has no such table: its lines change with its size.
    """
    if not isinstance(p.lines, SingleLine) or p.rule.exact:
        return p
    ends = _ends(p.rule, p.lines, size)
    if ends is None:
        return p
    return p._replace(ends=ends, table=_table(p, ends, size, True))


def selected(p: Passage, points: Array) -> Passage:
    """The same for some of its points."""

    def chosen(x: Array) -> Array:
        return x[..., points] if x.shape[-1] > 1 or p.velocity.size == 1 else x

    ends = None if p.ends is None else chosen(p.ends)
    table = None if p.table is None else p.table.each(chosen)
    return p._replace(velocity=p.velocity[points], ends=ends, table=table)


def memory(
    p: Passage,
    size: Array,
    place: Float[Array, "edges lines points"],
    full: bool = False,
) -> Memory:
    """The memory at distances `place` from the apex: arrays (edges, variants, lines,
    branches, points).
    """
    place = place[:, None, :, None]
    if p.rule.exact:
        return _from_apex(p, size, place, full)
    ends, table = p.ends, p.table
    if table is None:
        ends = _ends(p.rule, p.lines, size)
        if ends is None:
            return _from_apex(p, size, place, full)
        table = _table(p, ends, size, full)
    assert ends is not None
    count = xp.sum(stop_gradient(ends)[:, None] < stop_gradient(place), axis=0)
    shape = (ends.shape[0], *xp.broadcast_shapes(ends.shape[1:], place.shape[1:]))
    from_here = xp.concatenate([xp.zeros_like(place[:1]), xp.broadcast_to(ends, shape)])

    def picked(values: Array) -> Array:
        if on_numpy():
            values = xp.broadcast_to(values, (*values.shape[:-1], place.shape[-1]))
            return xp.take_along_axis(
                values,
                xp.broadcast_to(count, (count.shape[0], *values.shape[1:])),
                axis=0,
            )
        # What JAX makes of picking on the way back needs 64-bit types wherever that is
        # run.
        which = xp.arange(values.shape[0]).reshape(-1, *[1] * count.ndim)
        return xp.sum(xp.where(which == count, values[:, None], 0.0), axis=0)

    start = picked(from_here)
    return _advanced(
        table.each(picked), _panel(p, size, start, place - start, full), p.decay
    )


def direct(p: Passage, size: Array, trailing: Array) -> tuple[Array, Array, Array]:
    """int e^{-r/s} g' dx, int (1 - e^{-r/s}) g' dx and int r g' dx from -`trailing` to
    the leading edge, r the distance from -`trailing`, in all variants, by summing over
    the panels: for a place ahead of the apex too.
    """
    entry, b = p.lines.entry(size)[:, None], trailing[None, None, None]
    ends = None if p.rule.exact else _ends(p.rule, p.lines, size)
    bounds = (
        [xp.zeros((1,) * 5)]
        + ([] if ends is None else [ends])
        + [xp.full((1,) * 5, xp.inf)]
    )
    bounds = xp.concatenate(
        [xp.broadcast_to(x, (*x.shape[:-1], trailing.size)) for x in bounds]
    )

    def side(low: Array, high: Array) -> tuple[Array, _Local, Array]:
        start, end = xp.clip(bounds[:-1], low, high), xp.clip(bounds[1:], low, high)
        panel = _panel(p, size, start, end - start, not p.rule.exact)
        return end, _local(panel._replace(full=False), p.decay), start

    _, front, start = side(xp.maximum(-b, 0.0), entry)
    end, rear, _ = side(xp.zeros_like(b), xp.maximum(b, 0.0))
    # nothing behind a place ahead
    first, last = (start + b) / p.decay, (xp.maximum(b, 0.0) - end) / p.decay
    kept = xp.sum(xp.exp(-first) * front.ahead - xp.exp(-last) * rear.far, axis=0)
    lost = front.ahead_lost * xp.exp(-first) - front.mean * xp.expm1(-first)
    lost = xp.sum(
        lost - rear.far_lost * xp.exp(-last) + rear.mean * xp.expm1(-last), axis=0
    )
    way = xp.sum(front.moment + b * front.mean - b * rear.mean + rear.moment, axis=0)
    return kept, lost, way[..., 0, :]


def first_variant(p: Passage) -> Passage:
    """The same without what only an error estimate takes."""
    if p.table is None:
        return p
    table = p.table._replace(work=None, work_lost=None, square=None)
    return p._replace(table=table.each(lambda x: x[:, :1]))


def _ends(rule: Rule, lines: AbstractLines, size: Array) -> Array | None:
    """Ends of the panels (panels, 1, lines, 1, points), ascending; None where one
    reaches from the apex to the edge.
    """
    if isinstance(lines.shape, Profile) and isinstance(lines, SingleLine):
        # The points of a profile leave kinks of odd powers of one half behind them.
        knots, fractions = (
            stop_gradient(lines.shape.r),
            np.asarray(rule.fractions)[1:],
        )
        ends = (knots[:-1, None] + xp.diff(knots)[:, None] * fractions).ravel()
        if on_numpy():  # as far as the contact may reach
            ends = ends[: max(1, np.searchsorted(ends, _ROOM * np.max(size)))]
        return ends[:, None, None, None, None]
    fractions = np.asarray(rule.fractions)[1:-1]
    if not fractions.size:
        return None
    return stop_gradient(
        xp.asarray(fractions)[:, None, None, None, None] * lines.entry(size)[:, None]
    )


class _Panel(NamedTuple):
    """Where a panel begins and how wide it is, and the profile's slope on it in
    Legendre polynomials.
    """

    start: Array
    width: Array
    slope: Array  # (polynomials, ...)
    full: bool


def _panel(p: Passage, size: Array, start: Array, width: Array, full: bool) -> _Panel:
    nodes, _, to_legendre = gauss_unit(p.rule.nodes)
    line = xp.arange(p.lines.count)[:, None, None]
    x = start + width * nodes.reshape(-1, *[1] * width.ndim)
    c = _applied(to_legendre.T, p.lines.slope(x, size, line))
    if not p.rule.exact:
        # The mean of the slope is known from the profile, unless the panel is so narrow
        # that it shows no rise.
        wide = width > _WIDE * (start + width)
        end, begin = p.lines.profile(
            xp.stack(xp.broadcast_arrays(start + width, start)), size, line
        )
        rise = end - begin
        mean = xp.where(wide, rise / xp.where(wide, width, 1.0), c[0])
        c = xp.concatenate([mean[None], c[1:]])
    if full and p.judged and not p.rule.exact:
        c = xp.concatenate([c, stop_gradient(_variants(p.rule, c))], axis=2)
    return _Panel(start, width, c, full)


def _variants(rule: Rule, c: Array) -> Array:
    """The coefficients without the last two; and with the first beyond the mean off by
    what Gauss' rule misses, about the 2n-th, which is reached from the n/2-th and the
    n-th as in `Strips.summation_error`.
    """
    shorter = xp.concatenate([c[:-2], xp.zeros_like(c[-2:])])
    half = c.shape[0] // 2
    end, middle = (
        xp.max(xp.abs(c[-2:]), axis=0),
        xp.max(xp.abs(c[half - 2 : half]), axis=0),
    )
    unseen = end * xp.minimum(end / xp.where(middle > 0, middle, 1.0), 1.0)
    return xp.concatenate(
        [shorter, xp.concatenate([c[:1], c[1:2] + unseen, c[2:]])], axis=2
    )


def _table(p: Passage, ends: Array, size: Array, full: bool) -> Memory:
    """The memory at the apex and at the end of each panel, (1 + panels, ...)."""
    starts = xp.concatenate([xp.zeros_like(ends[:1]), ends[:-1]])
    panel = _panel(p, size, starts, ends - starts, full)
    local = _local(panel, p.decay)
    shape = local.far.shape[1:]
    zero, plain = xp.zeros(shape), xp.zeros(local.moment.shape[1:])
    first = Memory(
        zero, zero, zero, zero, plain, *((zero, zero, plain) if full else (None,) * 3)
    )

    def step(state: Memory, panel: _Local) -> tuple[Memory, Memory]:
        after = _stepped(state, panel)
        return after, after

    count = max(x.shape[0] for x in local if x is not None)
    # what is the same in every panel stands there once
    every = tree_map(lambda x: xp.broadcast_to(x, (count, *x.shape[1:])), local)
    _, later = scan(step, first, every)
    fields: list[Any] = [
        None if x is None else xp.concatenate([x[None], y])
        for x, y in zip(first, later, strict=True)
    ]
    return Memory(*fields)


class Within(NamedTuple):
    """What one panel adds up to by itself."""

    mean: Array  # l c_0
    ahead: Array  # l m_f
    ahead_lost: Array
    far: Array  # l m_b
    far_lost: Array
    moment: Array
    work: Any  # l^2 m_d, an array; this and the next two only in full, else None
    work_lost: Any
    square: Any


class _Local(NamedTuple):
    """What one panel adds to the memory, see `_stepped`: first what depends on where it
    is, then as `Within`.
    """

    keep: Array  # e^{-z}
    near: Array
    near_lost: Array
    fade: Array  # 1 - e^{-z}
    mean: Array
    ahead: Array
    ahead_lost: Array
    far: Array
    far_lost: Array
    moment: Array
    work: Any
    work_lost: Any
    square: Any


def _stepped(m: Memory, panel: _Local) -> Memory:
    """The memory at the end of a panel from that at its start."""
    end = Memory(
        near=m.near + panel.near,
        near_lost=m.near_lost + panel.near_lost,
        far=panel.keep * m.far + panel.far,
        far_lost=m.far_lost + panel.fade * m.far + panel.far_lost,
        moment=m.moment + panel.moment,
        work=None,
        work_lost=None,
        square=None,
    )
    if panel.work is None:
        return end
    return end._replace(
        work=m.work + m.far * panel.ahead + panel.work,
        work_lost=m.work_lost
        + m.far_lost * panel.mean
        + m.far * panel.ahead_lost
        + panel.work_lost,
        square=m.square + panel.square,
    )


def _advanced(m: Memory, panel: _Panel, decay: Array) -> Memory:
    return _stepped(m, _local(panel, decay))


def _from_apex(p: Passage, size: Array, place: Array, full: bool) -> Memory:
    """The memory where one panel reaches from the apex to `place`."""
    within = _within(_panel(p, size, xp.zeros_like(place), place, full), p.decay)
    return Memory(
        within.ahead,
        within.ahead_lost,
        within.far,
        within.far_lost,
        within.moment,
        within.work,
        within.work_lost,
        within.square,
    )


def _local(panel: _Panel, decay: Array) -> _Local:
    within, before, z = (
        _within(panel, decay),
        xp.exp(-panel.start / decay),
        panel.width / decay,
    )
    near_lost = (
        -xp.expm1(-panel.start / decay) * within.mean + before * within.ahead_lost
    )
    return _Local(xp.exp(-z), before * within.ahead, near_lost, -xp.expm1(-z), *within)


def _within(panel: _Panel, decay: Array) -> Within:
    start, width, c = panel.start, panel.width, panel.slope
    z = width / decay
    mean = c[0]
    kappa = _autocorrelation(c) if panel.full else None
    # 1 - mu_0 = (z/2)(mu_0 + mu_1), and the polynomials but the first by themselves:
    # nothing cancels for small z.
    zeroth, both, forth, back, rest = panel_sums(c, kappa, z)
    lost = 0.5 * z * both
    within = Within(
        mean=width * mean,
        ahead=width * (mean * zeroth + forth),
        ahead_lost=width * (mean * lost - forth),
        far=width * (mean * zeroth + back),
        far_lost=width * (mean * lost - back),
        moment=width * (start * mean + width * (mean / 2 - c[1] / 6)),
        work=None,
        work_lost=None,
        square=None,
    )
    if kappa is None or rest is None:
        return within
    powers = 1 / (2 * np.arange(c.shape[0]) + 1.0)[None]
    return within._replace(
        work=width**2 * (kappa[0] * zeroth + rest),
        work_lost=width**2 * (kappa[0] * lost - rest),
        square=width * _applied(powers, c**2)[0],
    )


@functools.cache
def _correlating(count: int) -> np.ndarray:
    """T with kappa_m = sum over i and j of T[m, ij] c_i c_j.

    K(rho) = int_0^{1-rho} h(c) h(c + rho) dc of a polynomial h is one of twice the
    degree and one more.
    """
    from numpy.polynomial.legendre import legvander

    distance, _, to_legendre = gauss_unit(2 * count)
    c, w, _ = gauss_unit(count)
    x = (1 - distance[:, None]) * c
    first, second = (
        legvander(1 - 2 * x, count - 1),
        legvander(1 - 2 * (x + distance[:, None]), count - 1),
    )
    products = np.einsum("m,i,mia,mib->mab", 1 - distance, w, first, second)
    return np.tensordot(to_legendre.T, products, 1).reshape(2 * count, -1)


def _autocorrelation(c: Array) -> Array:
    """Legendre coefficients in 1 - 2 rho of K(rho), from those of the slope."""
    count = c.shape[0]
    return _applied(
        _correlating(count), (c[:, None] * c).reshape(count**2, *c.shape[1:])
    )


def _applied(matrix: np.ndarray, values: Array) -> Array:
    """A matrix times the first axis of an array."""
    return (matrix @ values.reshape(values.shape[0], -1)).reshape(-1, *values.shape[1:])
