"""The fluid along a seal: it carries a part of the pressure, and flows.

Where the fluid has the pressure p_f, contact bears p - p_f: a uniform p_f over rubber,
gaps and contact changes no gap. So along the seal, x from the side of the fluid,

    [w(p - p_f) (1 + p_f/p_2) + l_2 S(p - p_f)] dp_f/dx = -q,    p_f = dp to 0,

with w/12 viscosity the flow conductance, q = 12 viscosity Q/width, and Q the volume at
the outlet. Of a liquid the round bracket is one and l_2 zero; of a gas p_2 is the
pressure at the outlet, l_2 the mean free path there, and S = dw/dl (`gas.py`).

A pressure p that is even along the seal separates,

    q length = int_0^dp [w (1 + p_f/p_2) + l_2 S] dp_f,

by Clenshaw's and Curtis' rule over log(p - p_f), up to where channels close. Else the
seal is cut into cells of an even p, in which the same holds: from the outlet on,

    G(s) = int_0^s [w (1 + p_m/p_2) + l_2 S] ds',    G(p - p_f) falls by q dx a cell,

p_m being the mean of p_f in the cell by w.

Where G would fall below zero the fluid carries all of p and lifts the rubber; upstream
its pressure stays, as long as it is above p. A place that is closed until the fluid opens
it adds no resistance but holds p_f back by as much. q is found by what p_f is at the
inlet.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from ..arrays import compiled, is_traced, stop_gradient, xp
from ..checks import Array
from ..numerics.interpolation import hermite, integrals, monotone_slopes
from ..numerics.root import bisect, search
from ..results.base import part, quantity
from .channels import Channels, GapFlow, RoughSeal
from .persson_gap import closing_pressure

_PLACES = 65  # at which the fluid along an even seal is kept
_CELLS, _MOST_CELLS = 64, 256  # of a seal whose pressure is not even
_SOUGHT, _SHARPER = 2049, 4  # places among which cells are sought, and how often
_NEAREST = 3e-4  # part of the range of pressures within which cells get no denser
_HALVED = 8  # cells of which the flow is followed to fewer and fewer, by halves
_SURE = 1.0, 0.5, 0.25  # parts of its changes
_CHANGED = 0.02  # change of its flow from half of them, from which they are doubled
_UNKNOWN = 0.5  # the same of the most, from which the flow is not known
_RANGE = np.log(1e5), 9.0  # of log z/(1 - z), below the largest pressure, and at most
_SPACING = 4.0  # of that, times the number of intervals of a model
_FINE = 256  # places in _SPACING where it is interpolated
_WIDE = 0.05  # change of what contact bears in a cell, above which w counts its places
_OPEN = 0.9  # of the pressure at which channels close, where a search may begin
_ROUNDS = 3  # for the mean pressure of a gas in a cell
_SETTLED = 1e-9  # change of log q
_WITHIN, _HALVINGS = 30.0, 50  # of the first guess of log q, where the search fails
_MET = 1e-3  # of the logarithm that then must be met


@part
class AlongSeal:
    """Pressures at places along the flow; the last axis of each field."""

    x: Array = quantity(
        "place", "m", "from the side of the fluid", dims="... place", shown="mm"
    )
    pressure: Array = quantity(
        "pressure of rubber and surface", "Pa", "p", dims="... place", shown="MPa"
    )
    fluid_pressure: Array = quantity(
        "pressure of the fluid",
        "Pa",
        "p_f, over that behind the seal",
        dims="... place",
        shown="MPa",
    )


class Fluid(NamedTuple):
    """What its pressure makes of the volume, which is that at the outlet."""

    expands: Any = 0.0  # 1/p_2 [1/Pa], of a gas
    path: Any = 0.0  # l_2, mean free path at the outlet [m]


class PressedSeal(NamedTuple):
    """What is asked of a model, and how it is pressed."""

    model: Channels
    rough: RoughSeal
    soft: Any  # 1/E* [1/Pa]
    drop: Any  # dp [Pa]
    fluid: Fluid

    def closing(self) -> Any:
        """p/E* at which channels close."""
        surface, softened = self.rough.surface, self.rough.softened()
        level = closing_pressure(self.model.closes) * surface.rms_slope
        return level if softened is None else level * softened.level()


class SealFlow(NamedTuple):
    """A seal as a whole, arrays of the shape of its points."""

    through: Any  # q length/dp [m^3]
    gap: Any  # where contact bears most [m]
    area: Any
    critical_gap: Any
    lifted: Any  # length over which the fluid lifts the rubber [m]
    slip: Any  # l_2 int w^(2/3) dp_f over int w (1 + p_f/p_2) dp_f
    error: Any  # relative
    model_error: Any
    good: Any
    said: str  # the model
    work: str
    slips_by_itself: bool
    profile: AlongSeal | None


def _bounds(flow: Array, model_error: Array | None) -> tuple[Any, Any]:
    """Least and largest w in three dimensions by the rows, in which pressure falls: no
    contact lets more through than under less pressure.
    """
    known = xp.isfinite(model_error)
    factor = 1 + xp.where(known, model_error, 0.0)
    most = xp.where(known, flow * factor, xp.inf)
    lighter = np.tri(len(most)).T.astype(bool)  # of row i: those from i on
    most = xp.where(
        lighter.reshape(*lighter.shape, *(1,) * (most.ndim - 1)), most, xp.inf
    )
    return xp.where(known, flow / factor, 0.0), most.min(axis=1)


def _within(through: Array, least: Array, most: Array) -> Any:
    """The factor less one within which a flow is, of its bounds."""
    flows = through > 0
    through, known = xp.where(flows, through, 1.0), flows & (least > 0)
    off = xp.maximum(most / through, through / xp.where(known, least, 1.0))
    return xp.where(known, off - 1, xp.inf)


class _ClenshawCurtis(NamedTuple):
    """Clenshaw's and Curtis' on [0, 1], nodes from 1 to 0."""

    nodes: np.ndarray
    weights: np.ndarray
    coarse: np.ndarray  # of every second node
    places: np.ndarray  # ascending
    until: np.ndarray  # integrals from 0 to each place, of values at the nodes


@functools.cache
def _rule(count: int) -> _ClenshawCurtis:
    def until(places: np.ndarray, count: int) -> np.ndarray:
        degree = count - 1
        nodes = np.cos(np.pi * np.arange(count) / degree)
        whole = chebyshev.chebint(np.eye(count), lbnd=-1, axis=0)
        series = np.linalg.inv(chebyshev.chebvander(nodes, degree))
        return 0.5 * chebyshev.chebvander(2 * places - 1, count) @ whole @ series

    end, places = np.ones(1), np.linspace(0.0, 1.0, _PLACES)
    coarse = np.zeros(count)
    coarse[::2] = until(end, count // 2 + 1)[0]
    nodes = 0.5 * (1 + np.cos(np.pi * np.arange(count) / (count - 1)))
    return _ClenshawCurtis(
        nodes, until(end, count)[0], coarse, places, until(places, count)
    )


def _asked(pressed: PressedSeal, relative_pressure: Array) -> GapFlow:
    """The model's answers at pressures over E* (rows, ...), in their shape."""
    rows, *dims = relative_pressure.shape
    flat = relative_pressure.reshape(rows, -1)
    gaps = pressed.model.flow(pressed.rough, flat)
    shaped = {
        name: x.reshape((*x.shape[:-1], *dims))
        for name, x in gaps._asdict().items()
        if name not in ("said", "work") and x is not None
    }
    return gaps._replace(**shaped)


class _EvenSeal(NamedTuple):
    """An even seal, from the outlet to the inlet: (rows, ...) but for the last two."""

    x: Any  # what contact bears, over E*
    fluid: Any  # p_f [Pa]
    falls: Any  # dp_f over the whole drop and dt, t of the rule
    span: Any  # of log x
    share: Any  # the drop over the pressure


@compiled("count")
def _line(
    count: int,
    pressure: Array,
    dry: Array,
    drop: Array,
    fluid: Fluid,
    closed: Array | float,
) -> _EvenSeal:
    """Where contact is asked for, of `count` nodes; `dry` is p/E*."""
    shape = np.broadcast_shapes(*map(np.shape, (dry, drop, *fluid)))
    share = xp.broadcast_to(drop / pressure, shape)
    dry = xp.broadcast_to(dry, shape)
    inlet = dry * (1 - share)
    opens = inlet < closed
    span = xp.where(dry < closed, -xp.log1p(-share), xp.log(closed / inlet))
    span = xp.where(opens, span, 0.0)
    nodes = _rule(count).nodes.reshape(-1, *(1,) * len(shape))
    x = xp.where(opens, inlet, dry) * xp.exp(span * nodes)
    # dp_f is p/E* times d log x, and by a share of the drop
    return _EvenSeal(x, pressure * (1 - x / dry), span * (x / dry) / share, span, share)


class _Whole(NamedTuple):
    """Integrals along an even seal."""

    flux: Any  # (rows, ...)
    through: Any
    slip: Any
    error: Any
    model_error: Any


@compiled()
def _whole(
    line: _EvenSeal,
    fluid: Fluid,
    flow: Array,
    slip: Array | None,
    error: Array,
    model_error: Array | None,
) -> _Whole:
    """Of the answers of a model at the nodes of a line."""
    rule, rows = _rule(len(flow)), (-1, *(1,) * (flow.ndim - 1))
    weights, coarser = rule.weights.reshape(rows), rule.coarse.reshape(rows)
    expanded = line.falls * (1 + fluid.expands * line.fluid)
    viscous, open_ = expanded * flow, flow > 0
    faint = line.falls * xp.where(open_, xp.where(open_, flow, 1.0) ** (2 / 3), 0.0)
    flux = viscous + fluid.path * (6 * faint if slip is None else line.falls * slip)

    def over(values: Array) -> Any:
        return (weights * values).sum(0)

    through = over(flux)
    flows = through > 0
    whole = xp.where(flows, through, 1.0)
    off = over(xp.where(flux > 0, flux * error, 0.0))
    off = off + abs(through - (coarser * flux).sum(0))
    if model_error is not None:
        unknown = xp.isnan(model_error).any(0)
        least, most = (over(expanded * w) for w in _bounds(flow, model_error))
        model_error = xp.where(unknown, xp.nan, _within(over(viscous), least, most))
    return _Whole(
        flux,
        through,
        fluid.path * over(faint) / xp.where(flows, over(viscous), 1.0),
        xp.where(flows, off / whole, error[0]),
        model_error,
    )


def even(pressed: PressedSeal, pressure: Array, length: Array) -> SealFlow:
    """A seal that is pressed evenly."""
    model, fluid = pressed.model, pressed.fluid
    closed = stop_gradient(pressed.closing())
    dry = pressure * pressed.soft
    line = _line(model.nodes, pressure, dry, pressed.drop, fluid, closed)
    dry = xp.broadcast_to(dry, line.x.shape[1:])
    every = _asked(pressed, xp.concatenate([dry[None], line.x]))
    slip, bounds = every.slip, every.model_error
    whole = _whole(
        line,
        fluid,
        every.flow[1:],
        None if slip is None else slip[1:],
        every.error[1:],
        None if bounds is None else bounds[1:],
    )
    profile = None
    if not is_traced(line.x, length):
        rule, through = _rule(model.nodes), whole.through
        passed = np.moveaxis(whole.flux, 0, -1) @ rule.until.T
        passed = passed / np.where(through > 0, through, 1.0)[..., None]
        left = (1 - line.share)[..., None] * np.exp(line.span[..., None] * rule.places)
        profile = _even_profile(pressure, pressed.drop, length, passed, 1 - left)
    return SealFlow(
        whole.through,
        every.gap[0],
        every.area[0],
        every.critical_gap,
        xp.zeros(line.x.shape[1:]),
        whole.slip,
        whole.error,
        whole.model_error,
        every.good.all(0),
        every.said,
        every.work,
        slip is not None,
        profile,
    )


def _even_profile(
    pressure: Array, drop: Array, length: Array, passed: Array, fluid_share: Array
) -> AlongSeal:
    """From how much of the length is `passed` (..., places) where the fluid has
    `fluid_share` which part of the pressure; of a closed seal it stays at the inlet.
    """
    pressure, drop, length, _ = np.broadcast_arrays(
        pressure[..., None], drop[..., None], length[..., None], passed[..., :1]
    )
    passed, fluid_share = (
        np.broadcast_to(each, (*pressure.shape[:-1], each.shape[-1]))
        for each in (passed, fluid_share)
    )
    flows = passed[..., -1:] > 0
    # of nodes that are few the integral may fall back a little
    passed = np.clip(np.maximum.accumulate(passed, axis=-1), 0.0, 1.0)
    x = np.where(flows, passed, np.linspace(0.0, 1.0, passed.shape[-1]))
    fluid = np.where(flows, pressure * fluid_share, 0.0)
    fluid[..., :1] = drop
    # where dry contact is closed, the pressure ends in a step
    x, fluid = (
        np.concatenate([each, np.full_like(pressure, end)], axis=-1)
        for each, end in ((x, 1.0), (fluid, 0.0))
    )
    return AlongSeal(length * x, np.broadcast_to(pressure, x.shape), fluid)


class Uneven(NamedTuple):
    """A pressure that changes along the seal; arrays of its points, (points,)."""

    start: Array  # where the seal begins on the side of the fluid [m]
    length: Array  # [m]
    peak: Array  # the largest pressure [Pa]
    # at parts of the length (places,): [Pa], (points, places)
    pressure_at: Callable[[Array], Array]
    kinks: Array  # parts of the length at which its slope jumps


def uneven(pressed: PressedSeal, seal: Uneven) -> SealFlow:
    """A seal whose pressure changes along it; all arrays of `pressed` (points,)."""
    fine, coarse = _tables(pressed, seal.peak * pressed.soft)
    count, log_flux = _CELLS, None
    while True:
        places = _places(seal, count)
        cells, *fewer = (_cells(pressed, seal, places[::by]) for by in (1, 2, 4, 8))
        log_flux, good = _fluxes(fine, cells, log_flux)
        solved = [_fluxes(coarse, each, log_flux[:1]) for each in fewer]
        flux, also = np.exp(log_flux), solved[0][1]
        open_ = flux[0] > 0
        by_cells = np.stack([flux[0], *(np.exp(each[0]) for each, _ in solved)])
        # a change that is small by accident is not so three times
        change = np.max(abs(np.diff(by_cells, axis=0)).T * _SURE, axis=-1)
        change = change / np.where(open_, flux[0], 1.0)
        if count == _MOST_CELLS or not (change > _CHANGED).any():
            break
        count *= 2
    model_error = None
    if not fine.exact:
        bounded = len(flux) > 1
        model_error = _within(*flux[1:]) if bounded else np.full(open_.shape, np.nan)
    fluid = _march(fine, cells, log_flux)[:, 0]  # (boundaries, points)
    fluid = np.where(open_, fluid, _closed(fine, cells))
    upstream, downstream = cells.pressure - fluid[:-1], cells.pressure - fluid[1:]

    def passed(integral: Array) -> Any:
        return np.interp(downstream, fine.x, integral) - np.interp(
            upstream, fine.x, integral
        )

    faint = passed(fine.faint).sum(0)
    middles = 0.5 * (fluid[1:] + fluid[:-1])
    viscous = ((1 + cells.expands * middles) * passed(fine.flow[0])).sum(0)
    hardest = _asked(pressed, downstream.max(0)[None])
    x = seal.start[:, None] + seal.length[:, None] * places
    profile = AlongSeal(x, seal.pressure_at(places), (fluid / pressed.soft).T)
    return SealFlow(
        flux[0] * seal.length / pressed.soft / pressed.drop,
        hardest.gap[0],
        hardest.area[0],
        hardest.critical_gap,
        (cells.width * (downstream <= 0)).sum(0),
        pressed.fluid.path * faint / np.where(viscous > 0, viscous, 1.0),
        np.where(open_, change + fine.error, fine.error),
        model_error,
        good[0] & also[0] & (change < _UNKNOWN),
        fine.said,
        fine.work,
        fine.slips_by_itself,
        profile,
    )


class _Table(NamedTuple):
    """A model's answers over s = (p - p_f)/E*, ascending from 0 to where nothing flows or
    nothing presses harder. The first axis of `flow`: with slip, without, and least and
    largest without, or the first alone.
    """

    x: Array
    flow: Array  # int w ds, from the last s down and so negative
    moment: Array  # int s w ds
    slip: Array  # int S ds, of the first alone
    faint: Array  # int w^(2/3) ds
    error: float  # relative, of w
    said: str
    work: str
    slips_by_itself: bool
    exact: bool  # whether there is nothing to bound


def _tables(pressed: PressedSeal, peak: Array) -> tuple[_Table, _Table]:
    """Up to the largest `peak`/E*, and the same from half of the answers: over log z/(1 -
    z), z = s over that at closing, in which roots of w are smooth up to closing.
    """
    model, closed = pressed.model, pressed.closing()
    step = _SPACING / (model.nodes - 1)
    top = float(peak.max() / closed)
    end = min(_RANGE[1], np.log(top / (1 - top))) if top < 1 else _RANGE[1]
    low = min(np.log(float(peak.min() / closed)), 0.0) - _RANGE[0]
    first, count = np.floor(low / step), int(np.ceil((end - low) / step)) // 2 * 2 + 3
    place = step * (first + np.arange(count))
    x = closed / (1 + np.exp(-place))
    gaps = _asked(pressed, x[::-1, None])
    flows = [gaps.flow]
    if gaps.model_error is not None and not np.isnan(gaps.model_error).any():
        flows += [gaps.flow, *_bounds(gaps.flow, gaps.model_error)]
    slip = 6 * gaps.flow ** (2 / 3) if gaps.slip is None else gaps.slip
    roots = np.stack([*np.cbrt(flows), np.sqrt(slip)])[:, ::-1, 0]
    within = np.linspace(place[0], place[-1], (count - 1) * int(_FINE * step) + 1)

    def table(every: int) -> _Table:
        nodes, values = place[::every], roots[:, ::every]
        *between, root_of_slip = hermite(
            nodes, values, monotone_slopes(nodes, values), within
        )
        s, flow = closed / (1 + np.exp(-within)), np.array(between) ** 3
        flowing = gaps.flow[::-1, 0]
        # relative, and of no meaning where nothing flows
        error = np.where(flowing > 0, gaps.error[::-1, 0], 0.0)
        weight = np.gradient(x) * flowing
        return _Table(
            np.append(0.0, s),
            integrals(s, flow),
            integrals(s, s * flow),
            integrals(s, root_of_slip**2),
            integrals(s, between[0] ** 2),
            float(weight @ error / weight.sum()),
            gaps.said,
            gaps.work,
            gaps.slip is not None,
            gaps.model_error is None,
        )

    return table(1), table(2)


class _Cells(NamedTuple):
    """Cells of an even pressure, all pressures over E*."""

    pressure: Array  # (cells, points)
    width: Array  # [m], (cells, points)
    drop: Array
    expands: Array  # E*/p_2
    path: Array  # [m]


def _places(seal: Uneven, count: int) -> Array:
    """Ends of cells as parts of the length, `count` of them and _HALVED more for each
    kink, of which every second, fourth and eighth are ends of cells too: half of them
    the denser in pressure, the nearer it is to its largest, where a fluid that all but
    lifts the rubber is held. Kinks end cells, so that a plateau is exact.

    Of the shape of the pressure alone, which is that of all points.
    """
    fine = passed = np.linspace(0.0, 1.0, _SOUGHT)
    for _ in range(_SHARPER):
        sought = np.interp(np.linspace(0.0, passed[-1], _SOUGHT), passed, fine)
        fine = np.union1d(sought, seal.kinks)
        pressure = seal.pressure_at(fine)[0]
        below = (pressure.max() - pressure) / max(np.ptp(pressure), 1e-300) / _NEAREST
        dense = abs(np.diff(np.minimum(below, 1) + np.log(np.maximum(below, 1))))
        shares = dense / max(dense.sum(), 1e-300) + np.diff(fine)
        passed = np.append(0.0, np.cumsum(shares))
    even = np.linspace(0.0, passed[-1], count // _HALVED + 1)
    ends = np.union1d(even, np.interp(seal.kinks, fine, passed))
    parts = np.arange(_HALVED * (ends.size - 1) + 1) / _HALVED
    return np.interp(np.interp(parts, np.arange(ends.size), ends), passed, fine)


def _cells(pressed: PressedSeal, seal: Uneven, places: Array) -> _Cells:
    middles = 0.5 * (places[1:] + places[:-1])
    soft, pressure = pressed.soft, np.array(seal.pressure_at(middles))
    # what holds the fluid back longest is not lost between two middles
    pressure[np.arange(len(pressure)), pressure.argmax(1)] = seal.peak
    return _Cells(
        (pressure * soft[:, None]).T,
        np.diff(places)[:, None] * seal.length,
        pressed.drop * soft,
        pressed.fluid.expands / soft,
        pressed.fluid.path,
    )


def _fluxes(table: _Table, cells: _Cells, guess: Array | None) -> tuple[Array, Array]:
    """log q/E* of each flow of the table and each point, -inf where it is closed; and
    which were found.
    """
    flows = len(table.flow) if guess is None else len(guess)
    highest = cells.pressure.max(0)
    # where the fluid has not opened the hardest place
    last = np.array([table.x[np.argmax(each >= each[-1])] for each in table.flow])
    open_ = highest - cells.drop < last[:flows, None]
    begin = np.zeros(open_.shape)
    if guess is None:
        place = np.maximum(cells.pressure.mean(0) - 0.5 * cells.drop, table.x[1])
        place = np.minimum(place, _OPEN * last[0])
        slope = np.gradient(table.flow[0], table.x)
        mean = np.interp(place, table.x, slope) * cells.drop / cells.width.sum(0)
        begin = begin + np.log(mean)
    else:
        begin = begin + guess
    # the pressure at the inlet rises from what opens the seal up to that which lifts it
    least = _march(table, cells, np.full(open_.shape, -np.inf))[0]

    def height(inlet: Array) -> Array:
        over, below = inlet - least, highest - inlet
        return np.log(np.maximum(over, 1e-300)) - np.log(np.maximum(below, 1e-300))

    wanted = height(np.broadcast_to(cells.drop, open_.shape))

    def residual(log_flux: Array) -> Array:
        inlet = _march(table, cells, log_flux)[0]
        return np.where(open_, height(inlet) - wanted, 0.0)

    log_flux, settled = search(residual, begin, _SETTLED, 1.0)
    if not (settled | ~open_).all():
        # where the fluid all but lifts a plateau its pressure ends at once in that
        ends = begin - _WITHIN, begin + _WITHIN
        halved, _ = bisect(lambda x: residual(x) < 0, *ends, _HALVINGS)
        log_flux = np.where(settled, log_flux, halved)
        settled = settled | (abs(residual(halved)) < _MET)
    return np.where(open_, log_flux, -np.inf), settled | ~open_


def _march(table: _Table, cells: _Cells, log_flux: Array) -> Array:
    """The pressure of the fluid at the ends of all cells, from the outlet on: (cells +
    1, flows, points).
    """
    count = len(cells.pressure)
    row = np.arange(len(log_flux))[:, None]
    flux = np.exp(log_flux)
    path = cells.path * (row == 0)
    fluid = np.zeros((count + 1, *log_flux.shape))
    last = table.x.size - 1
    liquid = not np.any(cells.expands)

    def passed(bears: Array, more: Array, falls: Array) -> Array:
        """What contact bears at the inlet of a cell at whose outlet it bears this."""
        left = np.clip(np.searchsorted(table.x, bears) - 1, 0, last - 1)
        fraction = (bears - table.x[left]) / (table.x[left + 1] - table.x[left])

        def integral(number: Array) -> Array:
            return more * table.flow[row, number] + path * table.slip[number]

        low, high = integral(left), integral(left + 1)
        wanted = low + np.clip(fraction, 0.0, 1.0) * (high - low) - falls
        # the interval that holds what is wanted
        first, end = np.zeros_like(left), left + 1
        for _ in range(int(last).bit_length()):
            middle = (first + end) // 2
            above = integral(middle) <= wanted
            first, end = np.where(above, middle, first), np.where(above, end, middle)
        low, high = integral(first), integral(first + 1)
        fraction = (wanted - low) / np.where(high > low, high - low, 1.0)
        width = table.x[first + 1] - table.x[first]
        return table.x[first] + np.clip(fraction, 0.0, 1.0) * width

    def mean(pressure: Array, bears: Array, remains: Array) -> Array:
        """The fluid's pressure within a cell, as w counts it."""
        flow, moment = (
            np.stack(
                [
                    np.interp(bears[k], table.x, y) - np.interp(remains[k], table.x, y)
                    for k, y in enumerate(each)
                ]
            )
            for each in (table.flow[: len(row)], table.moment[: len(row)])
        )
        wide = (bears - remains > _WIDE * bears) & (flow > 0)
        weighed = moment / np.where(wide, flow, 1.0)
        return pressure - np.where(wide, weighed, 0.5 * (bears + remains))

    for i in reversed(range(count)):
        pressure, bears = cells.pressure[i], cells.pressure[i] - fluid[i + 1]
        falls = flux * cells.width[i]
        remains = passed(bears, 1 + cells.expands * fluid[i + 1], falls)
        for _ in range(0 if liquid else _ROUNDS):
            more = 1 + cells.expands * mean(pressure, bears, remains)
            remains = passed(bears, more, falls)
        fluid[i] = np.where(bears > 0, pressure - remains, fluid[i + 1])
    return fluid


def _closed(table: _Table, cells: _Cells) -> Array:
    """The pressure of the fluid where it opens no way: all of it, up to the first place
    that stays closed, and behind it none.
    """
    closed = cells.pressure - cells.drop >= table.x[-1]
    behind = np.maximum.accumulate(closed, axis=0)
    ahead = np.concatenate([np.zeros_like(behind[:1]), behind])
    return np.where(ahead, 0.0, cells.drop)
