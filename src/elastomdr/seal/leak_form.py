"""The leak of `em.Multiscale`: a form in mean gap and real contact that was fitted to
three-dimensional maps.

    u = c u_P (u_P/h)^-d,                            u_P by Persson's theory
    w = u^3 [1 - 0.9 exp(-0.56 u/h)] (1 - A/a)^(k D^-e (A/a)^m)

w/12 viscosity is the flow per width and pressure gradient, A the share of contact by
`rough.psd_integrals` with gamma = 1/2, h the rms height, and D = dlog R/dlog q at
q_high how much the shortest waves count, held within its range on the maps. The real
contact that a result has is that of `rough.multiscale`, as in friction and break-out: 2
% less where contact is light, 3 % more where it is nearly full. The square bracket is
the flow factor of isotropic surfaces that hardly touch (Patir and Cheng, J. Lubr.
Technol. 100 (1978) 12): maps meet it where contact is light. Channels close at A = a =
0.415 (Wang and Mueser, Tribol. Lett. 69 (2021)).
"""

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from ..arrays import Array, stop_gradient, xp
from ..checks import is_traced, known
from ..numerics.implicit import as_doubles, numbers_with_slopes
from ..rough.psd_integrals import PER_DECADE, Nodes, cell_counts, nodes
from ..rough.surface import within_strain
from ..surface.lay import lay_of
from ..surface.spectrum import AbstractSpectrum
from ..surface.topography import skewness_of
from .channels import Channels, GapFlow, RoughSeal
from .persson_gap import GapPoints, contact_of, critical_gap, mean_gap

if TYPE_CHECKING:
    from ..material.softening import Softening

_BATCH = 256  # pressures that are held in memory at once
_TRACED = 24  # cells per decade where JAX traces a value
SAID = "Multiscale (form in mean gap and real contact, fitted to maps of gaps)"


class LeakForm(NamedTuple):
    """The constants, by their letters above."""

    share: float  # c
    bend: float  # d
    power: float  # k
    grows: float  # m
    leans: float  # e
    closes: float = 0.415  # a


# Fitted to maps by benchmarks/leak_fit.py, which says how far the form is from them.
FORM = LeakForm(share=0.956, bend=0.0701, power=2.41, grows=0.499, leans=0.0962)
UNSURE = 0.38  # real contact from which on a map may as well be closed
# Of the bound: at light contact, its growth; and of the maps: cutoff ratios, least contact.
_LIGHT, _GROWTH = 0.25, 0.35
_RATIOS, _LEAST = (16.0, 128.0), 0.01
_STEEP = 0.3, 1.4  # D of the maps
# What a lay and a skewness of the heights change, and up to which Peklenik number and
# skewness that was tried: benchmarks/leak_surfaces.py.
_LAY, _MOST_LAY = (1.1, 0.55, 3.0), 5.0
_ACROSS = 1e-6  # cos^2 of a direction to the lay that is across it
_ALONG = 1.05, 6.5  # of the flow along a lay alone
_EARLIER = 1.15  # power of the Peklenik number with which channels close earlier
_SKEWED, _MOST_SKEWED = (1.7, 3.2), 1.0
_MOST_LOG = np.log(1e4)  # of a finite bound that still tells something
_WORN = 0.4  # by how much less contact closes channels, over the skewness


def gap_of(ideal: Array, form: LeakForm = FORM) -> Any:
    """The mean gap from that of Persson's theory, both over the rms height."""
    open_ = ideal > 0
    gap = form.share * xp.where(open_, ideal, 1.0) ** (1 - form.bend)
    return xp.where(open_, gap, 0.0)


def factor(gap: Array, area: Array, steep: Array, form: LeakForm = FORM) -> Any:
    """w over the cube of the mean gap, from that gap over the rms height, the real
    contact and D; zero where channels are closed.
    """
    return barely_touching(gap) * through(area, steep, form)


def barely_touching(gap: Array) -> Any:
    """The flow factor of surfaces that hardly touch, by their gap over the rms height
    (Patir and Cheng).
    """
    return 1 - 0.9 * xp.exp(-0.56 * gap)


def through(area: Array, steep: Array, form: LeakForm = FORM) -> Any:
    """By what contact lowers the flow through the channels that it leaves open."""
    power = form.power * xp.clip(steep, *_STEEP) ** -form.leans
    closed_share = xp.minimum(area / form.closes, 1 - 1e-12)
    return xp.where(
        area < form.closes,
        (1 - closed_share) ** (power * closed_share**form.grows),
        0.0,
    )


def log_bound(area: Array) -> Any:
    """Bound on |ln w/w_3D| for 95 % of the points of the maps; infinite near closing,
    where a map may be closed or not.
    """
    near = np.log(1 - np.minimum(area, UNSURE) / FORM.closes)
    return np.where(area < UNSURE, _LIGHT + _GROWTH * near**2, np.inf)


def _near(area: Array, closes: Array | float) -> Any:
    """-ln(1 - A/a); infinite where a map may as well be closed."""
    part_closed = area / closes
    sure = part_closed < UNSURE / FORM.closes
    return np.where(sure, -np.log1p(-np.where(sure, part_closed, 0.0)), np.inf)


def of_lay(
    log_peklenik: Array | float | np.floating,
    area: Array,
    direction: float | None = None,
) -> Any:
    """Bound on |ln w/w_0| by a lay, w_0 being the flow without: along it more flows,
    across it less, and channels across close earlier. NaN beyond what was tried.

    In a `direction` to the lay, w = w_along cos^2 + w_across sin^2 lies between ln(cos^2
    e^along + sin^2) and the less far of ln cos^2 and -across.
    """
    stretch = np.abs(log_peklenik)
    constant, grows, near = _LAY
    slope = constant + grows * stretch**2
    log = stretch * (
        slope + near * _near(area, FORM.closes * np.exp(-_EARLIER * stretch))
    )
    if direction is not None:
        constant, near = _ALONG
        along = stretch * (constant + near * _near(area, FORM.closes))
        square = max(float(np.cos(direction)) ** 2, 1e-300)
        more = np.logaddexp(np.log(square) + along, np.log(max(1 - square, 1e-300)))
        # a channel across is as good as none
        less = -np.log(square) if square > _ACROSS else np.inf
        log = np.maximum(more, np.minimum(log, less))
    return np.where(stretch <= np.log(_MOST_LAY), log, np.nan)


def of_skewness(skewness: Array | float, area: Array) -> Any:
    """The same by a skewness of the heights: past worn summits less flows, past peaks
    more.
    """
    size = np.minimum(np.abs(skewness), _MOST_SKEWED)
    constant, near = _SKEWED
    log = size * (constant + near * _near(area, FORM.closes * (1 - _WORN * size)))
    return np.where(np.abs(skewness) <= _MOST_SKEWED, log, np.nan)


def of_heights(
    surface: AbstractSpectrum, area: Array, direction: float | None = None
) -> Any:
    """Both of a surface; zero of one that is isotropic and Gaussian."""
    log, lay = 0.0 * area, lay_of(surface)
    if lay is not None:
        log = log + of_lay(np.mean(np.abs(lay.log_peklenik)), area, direction)
    skewness = skewness_of(surface)
    return log + of_skewness(skewness, area) if skewness else log


def off_by(log: Array) -> Any:
    """By what a logarithm bounds a rate, over that; NaN from a factor of ten thousand on,
    which tells nothing, and infinite where channels may as well be closed.
    """
    tells = (log < _MOST_LOG) | np.isinf(log)
    return np.expm1(np.where(tells, log, np.nan))


def bound(rough: RoughSeal, area: Array, of_strain: Array | float = 0.0) -> Any:
    """w is within a factor of 1 + this of three dimensions, for 95 % of the points of
    the maps.

    Outside the maps the logarithm of that factor grows, times 1 + log10 of how many
    times the cutoff ratio and the real contact lie beyond their range; a lay and a
    skewness of the heights add to it, and `of_strain`, by which the logarithm of w is off
    where the strain of each scale is.
    """
    surface = rough.surface
    ratio = surface.q_high / surface.q_low
    beyond = sum(
        np.log10(np.maximum(x, 1.0))
        for x in (ratio / _RATIOS[1], _RATIOS[0] / ratio, _LEAST / area)
    )
    return off_by(
        log_bound(area) * (1 + beyond)
        + of_heights(surface, area, rough.direction)
        + of_strain
    )


class FittedChannels(Channels):
    """Of `em.Multiscale`."""

    closes = FORM.closes

    def flow(self, rough: RoughSeal, relative_pressure: Array) -> GapFlow:
        if is_traced(rough, relative_pressure):
            shared, points = as_doubles((rough[:2], relative_pressure))
            counts = cell_counts(known(stop_gradient(rough.surface)), _TRACED)
            numbers = _with_slopes(counts, rough.direction)(shared, points)
        else:
            numbers = _numbers(rough, relative_pressure)
        return GapFlow(
            flow=numbers.flow,
            gap=numbers.gap,
            critical_gap=numbers.critical_gap,
            area=numbers.area,
            error=numbers.error,
            model_error=numbers.model_error,
            good=xp.isfinite(numbers.flow),
            said=SAID,
        )


class _LeakNumbers(NamedTuple):
    """Fields of `GapFlow`; the first three have derivatives."""

    flow: Array
    gap: Array
    area: Array
    critical_gap: Array
    error: Array
    model_error: Array


def _numbers(rough: RoughSeal, relative_pressure: Array) -> _LeakNumbers:
    surface, softened = rough.surface, rough.softened()
    flat, first = np.ravel(relative_pressure), relative_pressure[0]
    fine, coarse = (nodes(surface, count) for count in (PER_DECADE, PER_DECADE // 2))
    parts = []
    for batch in np.split(flat, range(_BATCH, flat.size, _BATCH)):
        contacts = contact_of(fine, batch, softened)
        flow, gap = _flow_and_gap(contacts, surface.rms_height)
        less, _ = _flow_and_gap(contact_of(coarse, batch, softened), surface.rms_height)
        error = np.abs(flow - less) / np.where(flow > 0, flow, 1.0)
        off = _of_strain(rough, coarse, batch, contacts.real)
        model_error = bound(rough, contacts.area, off)
        parts.append((flow, gap, contacts.real, error, model_error))
    flow, gap, area, error, model_error = (
        np.concatenate(columns).reshape(relative_pressure.shape)
        for columns in zip(*parts, strict=True)
    )
    batches = np.split(first, range(_BATCH, first.size, _BATCH))
    critical = np.concatenate(
        [critical_gap(contact_of(fine, batch, softened)) for batch in batches]
    )
    return _LeakNumbers(flow, gap, area, critical, error, model_error)


def _of_strain(
    rough: RoughSeal, wave_nodes: Nodes, relative_pressure: Array, area: Array
) -> Any:
    """How far the logarithm of w is off, where the strain of each scale is."""
    if rough.softening is None:
        return 0.0

    def log_flow(times: float) -> Any:
        contacts = contact_of(wave_nodes, relative_pressure, rough.softened(times))
        flow, _ = _flow_and_gap(contacts, rough.surface.rms_height)
        return np.log(np.maximum(flow, 1e-300))

    def changes(times: float) -> Any:
        here = log_flow(1.0)
        return np.max([abs(log_flow(x) - here) for x in (times, 1 / times)], axis=0)

    return within_strain(changes, area)


def _flow_and_gap(contacts: GapPoints, rms_height: Array | float) -> tuple[Any, Any]:
    """w [m^3] and the mean gap [m]."""
    gap = gap_of(mean_gap(contacts) / rms_height)
    flow = gap**3 * factor(gap, contacts.area, contacts.steep)
    return rms_height**3 * flow, rms_height * gap


# surface and softening, which JAX may trace
_LeakShared: TypeAlias = "tuple[AbstractSpectrum, Softening | None]"


@functools.lru_cache(64)
def _with_slopes(
    counts: tuple[int, ...], direction: float | None
) -> Callable[..., _LeakNumbers]:
    """`_numbers` under a transformation of JAX, with derivatives of flow, gap and
    area.
    """

    def formula(shared: _LeakShared, relative_pressure: Array) -> tuple[Any, ...]:
        surface, _ = shared
        flat, softened = relative_pressure.ravel(), RoughSeal(*shared).softened()
        contacts = contact_of(nodes(surface, _TRACED, counts=counts), flat, softened)
        flow, gap = _flow_and_gap(contacts, (2 * np.pi * surface.moment(1)) ** 0.5)
        shape = relative_pressure.shape
        return tuple(x.reshape(shape) for x in (flow, gap, contacts.real))

    def like(shared: _LeakShared, relative_pressure: Array) -> tuple[Any, ...]:
        each = (relative_pressure,) * 3
        return (*each, relative_pressure[0], *each[:2])

    def numbers(shared: _LeakShared, relative_pressure: Array) -> _LeakNumbers:
        return _numbers(RoughSeal(*shared, direction), relative_pressure)

    solve = numbers_with_slopes(numbers, ((formula, 3),), like)
    return lambda shared, points: _LeakNumbers(*solve(shared, points))
