"""Friction of a rough surface under a pressure by Persson's theory and by `Multiscale`,
at many points at once.

Both ask how much of the pressure's variance each wave has. With w = q v, and `drag` and
`stiffness` the averages of Im E* and |E*|^2 over the angle (`rough.psd_integrals`),

    mu = 2 p int D drag/stiffness dlog q,    int D dlog q = <p^2>/p^2 - 1.

In full contact D is F = q^4 C stiffness/(4 p^2). Multiscale has two parts of it: what
is left of each wave's own pressure, and what the edges of its contacts make at higher
wave numbers x q, beyond q_high too, where F_s is F with the stiffness at q e^s v,

    D = F P(q e^a)^(4/3) + N int_(q' < q) F_s P^(3/5) K(q/q') dlog q',
    K(x) = (1 - u) 4 x^-4 + 6 u x^-2 (1 - x^-2)^2,   int K dlog x = 1,
    u = U/(1 + U^8)^(1/8),   U = t (1 - P^(1/4))/l.

The less of a wave is in contact, the finer are its contacts, and the further up is what
they make: u grows from 0 to 1, soonest where little stands below that breaks contacts
up; l(q') is the mean of ln(q'/q'') over q''^4 C below q'. All of it falls as x^-2, as
the pressure of a contact with a sharp edge does. N follows from a sum rule,

    int D dlog q = (P (1 + 2 G) + 2 sqrt(G/pi) exp(-1/(4 G)) - 1)
                   exp((1 - P)^(3/2) [e - f r sqrt(P) - b (1 - P^(1/4)) exp(-w)])

with P and G at q_high: the variance of Persson's distribution of pressures, and what
maps in three dimensions have more or less. r is the log of how much stiffer contacts
are there, w the standard deviation of log q over q^4 C. Where a wave's own part alone
is more than that, it is held to it and N is zero.
P(q) = erf(1/(2 sqrt G)) is the share of contact where waves up to q are
seen: Persson's with S inside (gamma, G_0) where moduli do not depend on the frequency.
Where they do, contacts are finer than their wave and feel a higher one,

    G = G_0 (stiffness(q e^s v)/stiffness(q v))^(1 - P_0).

The real contact area is A = P + P^3 (1 - P)/4 at q_high. Near full contact, where a pit
is a parabola under tension, it opens up to a crack of 3/2 times the area under tension,
and 1 - P, by the symmetry of Persson's distribution, is twice the latter: so
1 - A = (3/4) (1 - P).

Exact in full contact; for small loss mu is linear in the loss, and for p -> 0 it does
not depend on p, for D goes with 1/p at all waves.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array, stop_gradient, xp
from ..checks import is_traced, known
from ..element.law import TabulatedFoundation
from ..material.tabulated import LEFT_OUT
from ..numerics.implicit import as_doubles, numbers_with_slopes
from ..numerics.interpolation import hermite
from ..numerics.quadrature import gauss
from ..numerics.root import root
from ..surface.height_map import top_slope
from ..surface.lay import lay_of
from . import against_lay
from .local_modulus import Local, SoftenedByScale, Warmed
from .many_points import friction_and_area, worth_compiling
from .psd_integrals import (
    PER_DECADE,
    Averages,
    Moduli,
    Modulus,
    Nodes,
    Tables,
    cell_counts,
    direct,
    factor,
    faded_to,
    integral_to,
    nodes,
    read,
    read_stiffer,
    share,
    spread_of,
    tables,
)
from .road_model import RoadProblem, SurfaceFriction, WaveByWave, WaveProblem, Waves

if TYPE_CHECKING:
    from .._types import Scalar
    from ..call.types import SteadyBody
    from ..surface.spectrum import AbstractSpectrum

_BATCH = 64  # points that are held in memory at once
_FINEST = 32 * PER_DECADE
_TRACED = 96  # cells per decade where JAX traces a value
_BEYOND = 3e3  # how far beyond q_high the waves of contact edges are followed
_LINEAR = Local()


class Form(NamedTuple):
    """The constants of Multiscale, by their letters above."""

    gamma: float
    finer: float  # s
    ahead: float  # a
    further: float  # t
    excess: float  # e
    stiffer: float  # f
    narrow: float  # b


# Fitted to three-dimensional maps by benchmarks/rough_fit.py, which says how far the
# form is from them, and how far a new fit is from these.
FORM = Form(0.52, 0.42, 1.29, 0.67, 0.22, 0.71, 0.67)


class ContactAndFriction(NamedTuple):
    """Answers at each point."""

    mu: Array
    area: Array  # real contact area over nominal area
    error: Array  # numerical error of mu
    area_error: Array


def solve(model: WaveByWave, problem: RoadProblem) -> ContactAndFriction:
    """Cells of log q are halved until the change by the last halving is below `rtol`,
    or no more memory should be spent.
    """

    def evaluated(points: np.ndarray, per_decade: int) -> Any:
        return _in_batches(model, problem.of(points), per_decade)

    rtol, size = problem.rtol, problem.velocity.size
    mu, area, error, area_error = (np.full(size, np.nan) for _ in range(4))
    left, per_decade = np.arange(size), PER_DECADE
    coarsest, coarse = (evaluated(left, per_decade // fraction) for fraction in (4, 2))
    while left.size and per_decade <= _FINEST:
        fine = evaluated(left, per_decade)
        mu[left], area[left] = fine
        error[left], area_error[left] = map(_error, fine, coarse, coarsest)
        # one may be by chance
        met = (error[left] <= rtol * np.abs(mu[left])) & (
            area_error[left] <= rtol * area[left]
        )
        again = ~met & np.isfinite(fine[0])
        left = left[again]
        coarsest, coarse = ([x[again] for x in level] for level in (coarse, fine))
        per_decade *= 2
    return ContactAndFriction(mu, area, error, area_error)


def _error(fine: Array, coarse: Array, coarsest: Array) -> Any:
    """Half the last change, or an eighth of that before if more: of second order, as
    where a table's cubics meet.
    """
    return np.maximum(abs(fine - coarse) / 2, abs(coarse - coarsest) / 8)


def _in_batches(model: WaveByWave, problem: RoadProblem, per_decade: int) -> Any:
    spectrum, local = problem.surface, problem.local
    velocity, pressure = problem.velocity, problem.pressure
    modulus = problem.foundation.complex_modulus
    wave_nodes = nodes(spectrum, per_decade, bends(spectrum, local))
    table = table_of(modulus, wave_nodes, velocity, per_decade, local)
    if wave_nodes.tops is None and worth_compiling(velocity.size, local):
        return friction_and_area(model, wave_nodes, table, velocity, pressure)
    # those of one velocity side by side: much of their work is the same
    order = np.argsort(velocity, kind="stable")
    batches = [order[i : i + _BATCH] for i in range(0, velocity.size, _BATCH)]
    out = [
        _evaluate(
            table,
            wave_nodes,
            velocity[batch],
            pressure[batch],
            model,
            local.of(batch),
        )
        for batch in batches
    ]
    back = np.argsort(order, kind="stable")
    return tuple(np.concatenate(columns)[back] for columns in zip(*out, strict=True))


def bends(spectrum: AbstractSpectrum, local: Local) -> list[Any]:
    """Wave numbers at which an integrand may bend: where P(q e^a) becomes that at
    q_high, and where factors of the moduli do, if nothing is traced.
    """
    held = [spectrum.q[-1] * np.exp(-FORM.ahead)]
    return held if is_traced(spectrum, local) else [*held, *local.bends()]


def table_of(
    modulus: Modulus, wave_nodes: Nodes, velocity: Array, per_decade: int, local: Local
) -> Tables:
    """Averages for all that points at these velocities ask for."""
    low = float(velocity.min() * wave_nodes.q.min() * local.slowest())
    high = float(velocity.max() * wave_nodes.end * _BEYOND)
    step = np.log(10.0) / per_decade
    if local.directed is not None:
        return against_lay.directed_table(modulus, low, high * np.exp(FORM.finer), step)
    return tables(modulus, low, high, step, FORM.finer, local.parted)


def _evaluate(
    moduli: Moduli,
    wave_nodes: Nodes,
    velocity: Array,
    pressure: Array,
    model: WaveByWave,
    local: Local,
) -> tuple[Any, Any]:
    """mu and area of real contact at each point."""
    by_wave = model.waves(WaveProblem(moduli, wave_nodes, velocity, pressure, local))
    return by_wave.each.sum((-2, -1)) + by_wave.edges, by_wave.area


def contact(
    rate: Array, gamma: float, stored: bool, stiffer: Array | float = 0.0
) -> Any:
    """The share of contact from R, and from the log of how much stiffer contacts are
    than their wave.
    """
    return share(_spread(spread_of(rate, gamma, stored), stiffer))


def _spread(plain: Array, stiffer: Array | float) -> Array:
    """G from G_0."""
    return plain * xp.exp((1 - share(plain)) * stiffer)


def averages_of(
    moduli: Moduli,
    velocity: Array,
    q: Array,
    local: Local = _LINEAR,
    finer: float = 0.0,
) -> Averages:
    """The averages over the angle at q v."""
    speed, storage, loss = local.at(q)
    w = _frequency(velocity, q, speed)
    if local.directed is not None:
        averages = against_lay.averages(
            moduli, w, q, local.directed, finer, local.parted
        )
    elif isinstance(moduli, Tables):
        averages = read(moduli, xp.log(w))
    else:
        averages = direct(moduli, w, finer, local.parted)
    if averages.lost is None:
        return averages
    factor = storage**2 + (loss**2 - storage**2) * averages.lost
    return averages._replace(
        drag=loss * averages.drag, stiffness=averages.stiffness * factor
    )


def _stiffer(
    moduli: Moduli,
    velocity: Array,
    q: Array,
    local: Local,
    finer: float,
) -> Any:
    """`Averages.stiffer` alone."""
    speed, _, _ = local.at(q)
    w = _frequency(velocity, q, speed)
    if local.directed is not None:
        return against_lay.averages(moduli, w, q, local.directed, finer, False).stiffer
    if isinstance(moduli, Tables):
        return read_stiffer(moduli, xp.log(w))
    return direct(moduli, w, finer, local.parted).stiffer


def _frequency(velocity: Array, q: Array, speed: Array) -> Any:
    """q v at nodes (points, cells, 2), with the factor of `Local.at` on v."""
    w = velocity[:, None, None] * q
    return w if speed is None else w * speed


def rate_of(wave_nodes: Nodes, stiffness: Array | float, pressure: Array) -> Array:
    """dR/dlog q = q^4 C stiffness/(8 p^2), R the integral of G without S."""
    return wave_nodes.power * stiffness / (8 * pressure**2)


def waves_of_persson(problem: WaveProblem, energy_factor: tuple[float, bool]) -> Waves:
    """Friction wave by wave, by Persson's theory; none of contact edges."""
    moduli, wave_nodes, velocity, pressure, local = problem
    p = pressure[:, None, None]
    drag, stiffness, *_ = averages_of(moduli, velocity, wave_nodes.q, local)
    rate = rate_of(wave_nodes, stiffness, p)
    shares = contact(integral_to(rate, wave_nodes.weight), *energy_factor)
    full = wave_nodes.weight * wave_nodes.power * drag / (2 * p)
    area = contact((rate * wave_nodes.weight).sum((-2, -1)), *energy_factor)
    gamma, _ = energy_factor
    each = full * factor(shares, gamma) * shares
    return Waves(each, 0.0 * area, rate, 0.0 * rate, area)


def waves_of_multiscale(problem: WaveProblem, form: Form = FORM) -> Waves:
    """Friction wave by wave; of measured heights that of Gaussian ones r times as high.

    Heights times r under p are heights under p/r, whose friction is times r. r is the
    rms slope of the highest part of the map, as large as the real contact, over that of
    all of it: an equation for r, since the contact is smaller on higher heights.
    """
    tops = problem.nodes.tops
    if tops is None:
        return _of_gaussian(problem, form)
    residual = _off_tops(problem, tops, form)
    log_ratio, found = root(residual, 0 * problem.pressure, slope=1.0)
    ratio = xp.where(found, xp.exp(log_ratio), np.nan)
    local = problem.local.raised(ratio)
    under = problem._replace(pressure=problem.pressure / ratio, local=local)
    waves = _of_gaussian(under, form)
    each = waves.each * ratio[:, None, None]
    return waves._replace(each=each, edges=waves.edges * ratio)


def _off_tops(problem: WaveProblem, tops: Array, form: Form) -> Callable[[Array], Any]:
    """By how much ln r exceeds that of the contact on heights times r."""

    def end(local: Local) -> tuple[Any, Any]:
        """R at q_high, and how much stiffer contacts are there."""
        moduli, wave_nodes, velocity, pressure, _ = problem
        at = averages_of(moduli, velocity, wave_nodes.q, local, form.finer)
        rate = rate_of(wave_nodes, at.stiffness, pressure[:, None, None])
        last = xp.reshape(wave_nodes.end, (1, 1))
        stiffer = _stiffer(moduli, velocity, last, local, form.finer)
        return (rate * wave_nodes.weight).sum((-2, -1)), stiffer[:, 0, 0]

    local = problem.local
    always = end(local) if local.softened is None else None

    def residual(log_ratio: Array) -> Any:
        total, stiffer = always or end(local.raised(xp.exp(log_ratio)))
        total = total * xp.exp(2 * log_ratio)
        area = real_area(contact(total, form.gamma, True, stiffer))
        return log_ratio - top_slope(tops, area)

    return residual


def _of_gaussian(problem: WaveProblem, form: Form) -> Waves:
    """Friction of Gaussian heights, wave by wave."""
    moduli, wave_nodes, velocity, pressure, local = problem
    p = pressure[:, None, None]
    speeds, each_point = velocity, lambda values: values
    if not local.by_point:
        speeds, each_point = distinct(velocity)

    def summed(values: Array) -> Any:
        return (values * wave_nodes.weight).sum((-2, -1))

    # log(q/q_high), at q_high and beyond
    past = np.concatenate([[0.0], _PAST])
    after_q = wave_nodes.end * np.exp(past)[:, None]
    log_later = xp.minimum(wave_nodes.log + form.ahead, wave_nodes.log_end)
    later_q = wave_nodes.end * xp.exp(log_later - wave_nodes.log_end)
    on, after, stiffer_later = _averages_at(
        (wave_nodes.q, after_q, later_q), moduli, speeds, local, form.finer
    )

    # at each velocity, R times 8 p^2
    rate_p = wave_nodes.power * on.stiffness
    total_p = summed(rate_p)
    variance_p = integral_to(rate_p, wave_nodes.weight)
    end = total_p, wave_nodes.end_power * after.stiffness[:, 0, 0]
    later_p = _later(wave_nodes, rate_p, variance_p, end, log_later)
    stiffer_end = after.stiffer[:, 0, 0]

    # at each point
    scale = 8 * p**2
    rate = each_point(rate_p) / scale
    total = each_point(total_p) / (8 * pressure**2)
    spread = _spread(spread_of(total, form.gamma, True), each_point(stiffer_end))
    share_end = share(spread)
    stiffer = each_point(on.stiffer)
    shares = contact(each_point(variance_p) / scale, form.gamma, True, stiffer)
    later_shares = contact(
        each_point(later_p) / scale, form.gamma, True, each_point(stiffer_later)
    )

    full = 2 * rate  # F
    of_wave = full * later_shares ** (4 / 3)
    source = full * xp.exp(stiffer) * shares**0.6
    below = integral_to(wave_nodes.power, wave_nodes.weight)
    distance = integral_to(below, wave_nodes.weight) / below  # l
    steep = form.further * (1 - shares**0.25) / distance
    fine = source * steep / (1 + steep**8) ** 0.125
    of_edges = fading = 0.0
    for part, fall in ((6 * fine, 2), (4 * source - 16 * fine, 4), (6 * fine, 6)):  # K
        at_nodes, at_end = faded_to(part, wave_nodes, fall)
        of_edges += at_nodes
        fading += at_end[:, None] * np.exp(-fall * _PAST)

    height = wave_nodes.power / summed(wave_nodes.power)
    spread_of_waves = summed(height * wave_nodes.log**2) - (
        summed(height * wave_nodes.log) ** 2
    )  # w^2
    more = form.excess - form.stiffer * each_point(stiffer_end) * share_end**0.5
    more -= form.narrow * (1 - share_end**0.25) * xp.exp(-(spread_of_waves**0.5))
    whole = _variance(spread, share_end) * xp.exp((1 - share_end) ** 1.5 * more)
    of_own = summed(of_wave)
    of_wave = of_wave * xp.minimum(whole / of_own, 1.0)[:, None, None]
    edge_strength = xp.maximum(whole - of_own, 0.0) / summed(source)  # N
    spectrum = of_wave + edge_strength[:, None, None] * of_edges  # D
    lossy = each_point(wave_nodes.weight * on.drag / on.stiffness)
    faded = each_point((after.drag / after.stiffness)[:, 1:, 0]) * fading
    edges = 2 * pressure * edge_strength * (faded * _PAST_WEIGHT).sum(-1)
    return Waves(2 * p * spectrum * lossy, edges, rate, stiffer, real_area(share_end))


def _averages_at(
    q: tuple[Any, Any, Any],
    moduli: Moduli,
    speeds: Array,
    local: Local,
    finer: float,
) -> tuple[Averages, Averages, Any]:
    """The averages at the first two q, and how much stiffer contacts are at the third.

    Without tables, while JAX traces, those of all three are taken at once, since moduli
    are most of a program that takes seconds to compile.
    """
    if isinstance(moduli, Tables):
        on, after = (averages_of(moduli, speeds, x, local, finer) for x in q[:2])
        return on, after, _stiffer(moduli, speeds, q[2], local, finer)
    whole = xp.concatenate([x.reshape(-1) for x in q])[:, None]
    averages = averages_of(moduli, speeds, whole, local, finer)
    ends = np.cumsum([x.size for x in q])

    def part(i: int, values: Array) -> Any:
        values = values[:, ends[i] - q[i].size : ends[i]]
        return values.reshape(-1, *q[i].shape)

    drag, stiffness, stiffer, lost = averages

    def averages_at(i: int) -> Averages:
        return Averages(
            part(i, drag),
            part(i, stiffness),
            part(i, stiffer),
            None if lost is None else part(i, lost),
        )

    return averages_at(0), averages_at(1), part(2, averages.stiffer)


def distinct(velocity: Array) -> tuple[Any, Callable[[Any], Any]]:
    """The velocities that differ, and what turns values at these into values at each
    point.
    """
    if is_traced(velocity):
        return velocity, lambda values: values
    speeds, which = np.unique(velocity, return_inverse=True)
    if speeds.size == velocity.size:
        return velocity, lambda values: values
    return speeds, lambda values: values[which]


def real_area(shares: Array) -> Any:
    """A of the share of contact P at q_high."""
    return shares + 0.25 * shares**3 * (1 - shares)


def _later(
    wave_nodes: Nodes, rate: Array, variance: Array, end: tuple[Any, Any], log: Array
) -> Any:
    """R at log(q/q_low) (cells, 2) up to q_high: its logarithm by cubics with its
    slopes; `end` is R and dR/dlog q at q_high.
    """
    flat = (rate.shape[0], -1)
    nodes = xp.append(wave_nodes.log, wave_nodes.log_end)
    r = xp.concatenate([variance.reshape(flat), end[0][:, None]], -1)
    slope = xp.concatenate([rate.reshape(flat), end[1][:, None]], -1) / r
    inside = hermite(nodes, xp.log(r), slope, log.reshape(-1))
    return xp.exp(inside).reshape(rate.shape)


def _variance(spread: Array, shares: Array) -> Any:
    """<p^2>/p^2 - 1 of Persson's distribution of pressures."""
    tail = 2 * xp.sqrt(spread / np.pi) * xp.exp(-0.25 / spread)
    return 2 * spread * shares + tail - (1 - shares)


def _past() -> tuple[np.ndarray, np.ndarray]:
    """log(q/q_high) of the waves beyond q_high that are seen, and their weights."""
    points, weights = gauss(24)
    half = 0.5 * np.log(_BEYOND)
    return half * (points + 1), half * weights


_PAST, _PAST_WEIGHT = _past()


WORK = (
    f"integrals over {PER_DECADE} cells per decade of q, or more until rtol is met",
    "no lines, no maps, no random numbers; integrals over the angle are tabulated once "
    "for all points",
)


def friction(model: WaveByWave, problem: RoadProblem) -> SurfaceFriction:
    """`solve` with the error of a table of moduli, and which points met `rtol`."""
    if is_traced(problem):
        shared, points = taken_apart(problem)
        counts = cell_counts(known(stop_gradient(problem.surface)), _TRACED)
        solved = _with_slopes(model, problem.rtol, counts)(shared, points)
        return solved._replace(good=solved.good > 0)
    solved = solve(model, problem)
    if problem.progress is not None:
        problem.progress(problem.velocity.size, problem.velocity.size)
    good = (solved.error <= problem.rtol * abs(solved.mu)) | (solved.mu == 0)
    change = table_error(model, problem, solved.mu)
    return SurfaceFriction(
        solved.mu, solved.area, solved.error + change, good, solved.area_error
    )


class RoadShared(NamedTuple):
    """What all points of a call on a road share."""

    foundation: SteadyBody
    surface: AbstractSpectrum
    share: Array | None  # strain over rms slope, of a softening
    ends: Array | None  # of `Warmed`


class RoadPoints(NamedTuple):
    """What each point has of its own; the last axis is that of the points."""

    velocity: Array
    pressure: Array
    direction: Array | None
    temperature: Array | None
    rise: Array | None


def taken_apart(problem: RoadProblem) -> tuple[RoadShared, RoadPoints]:
    softened, warmed, directed = problem.local
    share = None if softened is None else softened.share
    ends = temperature = rise = None
    if warmed is not None:
        ends, temperature = warmed.ends, warmed.temperature
        rise = xp.transpose(warmed.rise)
    direction = against_lay.to_points(directed)
    shared = RoadShared(problem.foundation, problem.surface, share, ends)
    points = RoadPoints(
        problem.velocity, problem.pressure, direction, temperature, rise
    )
    return as_doubles((shared, points))


def put_together(shared: RoadShared, points: RoadPoints, rtol: float) -> RoadProblem:
    foundation, surface, share, ends = shared
    softened = warmed = None
    directed = against_lay.of_points(lay_of(surface), points.direction)
    if share is not None:
        assert foundation.softening is not None
        softened = SoftenedByScale(foundation.softening, surface, share)
    if ends is not None:
        assert points.rise is not None
        assert points.temperature is not None
        warmed = Warmed(ends, points.rise.T, points.temperature, foundation)
    local = Local(softened, warmed, directed)
    return RoadProblem(foundation, surface, *points[:2], local, rtol)


@functools.lru_cache(64)
def _with_slopes(
    model: WaveByWave, rtol: float, counts: tuple[int, ...]
) -> Callable[..., SurfaceFriction]:
    """`friction` under a transformation of JAX, of what `taken_apart` gives: numbers
    from NumPy, derivatives of the same integrals on `counts` cells.
    """

    def numbers(shared: RoadShared, points: RoadPoints) -> tuple[Any, ...]:
        solved = friction(model, put_together(shared, points, rtol))
        return solved[:5]  # its arrays, without what is said

    def integrals(shared: RoadShared, points: RoadPoints) -> tuple[Any, Any]:
        local = put_together(shared, points, rtol).local
        wave_nodes = nodes(
            shared.surface, _TRACED, bends(shared.surface, local), counts
        )
        modulus = shared.foundation.complex_modulus
        return _evaluate(modulus, wave_nodes, *points[:2], model, local)

    def like(shared: RoadShared, points: RoadPoints) -> tuple[Any, ...]:
        return (points.velocity,) * 5

    solve = numbers_with_slopes(numbers, ((integrals, 2),), like)
    return lambda shared, points: SurfaceFriction(*solve(shared, points))


def table_error(model: WaveByWave, problem: RoadProblem, mu: Array) -> Any:
    """Error of mu by the interpolation of a table of moduli, from the friction of its
    halves, which one level of cells gives well enough; 0 for a series.
    """
    foundation = problem.foundation
    if not isinstance(foundation, TabulatedFoundation):
        return 0.0
    change = np.zeros_like(mu)
    for half in foundation.thinned():
        other, _ = _in_batches(model, problem._replace(foundation=half), PER_DECADE)
        change = np.maximum(change, LEFT_OUT * np.abs(other - mu))
    return change


# |ln(mu/mu_3D)| <= shape (a - b ln A) (1 + c m^2) for 95 % of the points in three
# dimensions of each slope of the loss and each contact, each predicted without its
# surface or its material: benchmarks/rough_fit.py
_BOUND = {"multiscale": (0.04, 0.0147, 1.75), "persson": (0.221, 0.0335, 2.0)}
_AREA_BOUND = (0.034, 0.0338, 0.0)  # of the real contact area, alike
_LEAST = 0.003  # contact of these points; mu does not depend on less
# of these points: cutoff ratios, largest contrast; and of those that may be bounded
_RATIOS, _CONTRAST = (2.0, 256.0), 1000.0
_MOST_CONTRAST, _MOST_SLOPE = 1e5, 1.05
_WIDE = 64.0  # cutoff ratio up to which the form comes nearer to three dimensions
# of ln(mu/mu_3D), by which it may grow with each decade of the cutoff ratio beyond:
# what was found at the same contact, and one and a half of its standard errors
_DRIFT = 0.017
_SMOOTH = 0.6  # m, up to which losses are those of rubber, not of one relaxation
_NEAR_END = np.geomspace(0.1, 2.0, 7)  # wave numbers over q_high whose losses count


class Felt(NamedTuple):
    """What the distance from three dimensions depends on beside the contact."""

    ratio: Array | Scalar  # q_high/q_low
    contrast: Array  # |E*| at q_high v over that at q_low v
    # m, the rms of dlog(Im E*/|E*|^2)/dlog q over the waves about q_high: small for
    # rubber with a broad spectrum, 1 beyond the peak of a single relaxation
    steep: Array
    slope: Array  # dlog(Im E*)/dlog q, the mean over the same waves


def felt(foundation: SteadyBody, surface: AbstractSpectrum, velocity: Array) -> Felt:
    """`Felt` at velocities [m/s]."""
    modulus = foundation.complex_modulus(
        velocity[..., None] * (surface.q_high * _NEAR_END)
    )
    low, high = (
        abs(foundation.complex_modulus(velocity * q))
        for q in (surface.q_low, surface.q_high)
    )
    step = np.log(_NEAR_END[1] / _NEAR_END[0])
    loss = xp.diff(xp.log(xp.maximum(modulus.imag, 1e-300)), axis=-1) / step
    of_size = xp.diff(xp.log(xp.abs(modulus)), axis=-1) / step
    return Felt(
        surface.q_high / surface.q_low,
        high / low,
        xp.sqrt(xp.mean((loss - 2 * of_size) ** 2, axis=-1)),
        xp.mean(loss, axis=-1),
    )


def bound_terms(label: str, of_area: bool) -> tuple[float, float, float]:
    """a, b and c of `bound`, of mu by a model's label or of the area."""
    return _AREA_BOUND if of_area else _BOUND[label]


def shape_of_bound(area: Array, ratio: Array | Scalar) -> Array:
    """1 in light contact of a surface whose cutoffs are a factor of 8 apart; full
    contact is exact, and with few waves the form is further off.
    """
    left = 1 - xp.minimum(area, 1.0)
    return left**0.25 * (xp.minimum(ratio, _WIDE) / 8) ** -0.1


def bound(terms: tuple[float, float, float] | None, area: Array, felt: Felt) -> Array:
    """Bound on the relative distance of mu, or of A, from three dimensions, for 95 % of
    points alike, by its `bound_terms`.

    Beyond the largest cutoff ratio in three dimensions what friction may drift is
    added, decade by decade. Where the contrast of the moduli is larger than there, the
    rest is wider by a factor of 1 + log10 of how many times. NaN where nothing like it
    was solved, or it is not known for the options of the model.
    """
    if terms is None:
        return area + np.nan
    a, b, c = terms

    def decades(x: Array | Scalar) -> Array:
        return xp.log10(xp.maximum(x, 1.0))

    inside = shape_of_bound(area, felt.ratio) * (1 + c * felt.steep**2)
    inside = inside * (a - b * xp.log(xp.maximum(area, _LEAST)))
    inside = inside * (1 + decades(felt.contrast / _CONTRAST))
    whole = xp.expm1(inside + _DRIFT * decades(felt.ratio / _RATIOS[1]))
    solved = (
        (felt.ratio >= _RATIOS[0])
        & (felt.contrast <= _MOST_CONTRAST)
        & (xp.abs(felt.slope) <= _MOST_SLOPE)
    )
    return xp.where(solved, whole, np.nan)


def why_wide(
    foundation: SteadyBody, surface: AbstractSpectrum, velocity: Array
) -> list[str]:
    """What makes the bound wide at points, or leaves them without one, and what would
    make it smaller, in words.
    """
    found = felt(foundation, surface, velocity)
    reasons = []
    if (steep := float(np.max(found.steep))) > _SMOOTH:
        reasons.append(
            f"the losses change as q^{steep:.1f} at the shortest waves, as beyond the "
            "peak of a single relaxation: a spectrum of relaxation times that is fitted "
            "to measured moduli has less"
        )
    if (slope := float(np.max(np.abs(found.slope)))) > _MOST_SLOPE:
        reasons.append(
            f"the loss modulus changes as q^{slope:.1f} at the shortest waves, by a "
            f"power of {_MOST_SLOPE:g} at most in three dimensions: no bound is known"
        )
    if (rise := float(np.max(found.contrast))) > _CONTRAST:
        reasons.append(
            f"|E*| rises {rise:.2g} times from q_low to q_high, {_CONTRAST:g} times in "
            f"three dimensions, beyond {_MOST_CONTRAST:g} no bound is known: cutoffs "
            "that are nearer have less"
        )
    if (ratio := float(found.ratio)) > _RATIOS[1]:
        reasons.append(
            f"the cutoffs are a factor of {ratio:.2g} apart, up to {_RATIOS[1]:g} in "
            f"three dimensions: {100 * _DRIFT:.0f} % more for each decade beyond"
        )
    if ratio < _RATIOS[0]:
        reasons.append(
            f"the cutoffs are a factor of {ratio:.2g} apart, {_RATIOS[0]:g} or more in "
            "three dimensions: no bound is known"
        )
    return reasons
