"""Rubber that its friction heats on a rough surface: a temperature for each length
scale, from both bodies.

The heat of the waves q arises in the rubber to the depth 1/2q, by 2q exp(-2qz), that of
adhesive shear on its surface. At the wave number q the rubber is in contact over the
share P(q) of the surface, and its temperature is the mean over those regions and over
the depth by the same 2q exp(-2qz). As in `rough.heat`, with w = v/2D and

    D_q(k) = 4 q^2/(k^2 + 4 q^2),
    S(k) = sum of s_q D_q over the waves, and 1 for what arises on the surface,
    c_q(r) = 1/P(min(q, pi/r)) - 1,
    <f>_q = (2/(pi lambda)) int dk int r dr f c_q(r) I0(w r) K0(r sqrt(w^2 + k^2)),

the mean flux j = mu p v makes the rise <D_q S>_q j. The flux at the distance r from a
point of the regions of q is that of the regions of pi/r, but not of finer ones than q:
a region is heated by all that is within. The road is a half-space at rest whose spots
in contact take the flux j_s from the surface of the rubber. Surface temperatures of
both agree in the mean over the real contact (Blok 1937):

    j_s (<1>_Q + (1/lambda_s) int c_Q(r) dr) = j <S>_Q,
    T_q = j <D_q S>_q - j_s <D_q>_q,
    Q = q_high.

Friction, contact shares and heat are found at the temperatures that they make: a fixed
point in T_q.

Source: by length scale as B. N. J. Persson, J. Phys.: Condens. Matter 18 (2006) 7789;
sources at rest and moving: Jaeger 1942, Carslaw & Jaeger 1959, ch. 10.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array, is_traced, special, stop_gradient, xp
from ..checks import known
from ..numerics.implicit import as_doubles, implicit, numbers_with_slopes
from ..numerics.quadrature import gauss_unit
from ..surface.lay import lay_of
from .adhesion import AdhesiveShear
from .against_lay import Which, of_points, to_points
from .heat import Heat, highest_rise
from .local_modulus import Local, SoftenedByScale, Warmed, basis, log_stations, place_of
from .multiscale import bends, distinct, table_of
from .psd_integrals import Moduli, Nodes, cell_counts, integral_to, nodes
from .road_model import WaveByWave, WaveProblem, Waves

if TYPE_CHECKING:
    from ..call.types import SteadyBody
    from ..surface.spectrum import AbstractSpectrum

_TRACED_DECADES = 3  # of a surface whose cutoffs JAX traces
_BATCH = 32  # points whose first temperatures are looked for at once
_NEAR_NODES = 24  # over the distances below half the shortest wave
# relative change of temperatures at which they have settled; most rounds
_SETTLED, _ROUNDS = 1e-8, 80
_NOTHING = 1e-9  # rise that is none [K]


_CELLS, _STATIONS = 6, 2  # of q per decade on the coarsest level
_LEVELS = (1, 2, 4, 8, 16)  # how many times finer each is
# the number of the level that all points reach; further ones only where they ask for it
_USUAL = 2
# cells per decade of the equation whose derivatives are taken, as on that level
_TRACED_CELLS = _CELLS * _LEVELS[_USUAL]
_ASKED = 1e-3  # relative error of friction up to which no finer level is asked for
_MOST = 1e-2  # and that above which a point has not converged
# what the change before the last one is divided by: splines are of fourth order
_ORDER_4 = 16
# cells per decade and level of the stations where a first temperature is looked for
_SCAN, _SCAN_STATIONS = 8, 2
# heights of a profile that are tried from the lowest [K] on, and into how many parts the
# steps are divided where there may be several states
_HEIGHTS, _LOWEST, _PARTS = 18, 0.01, 4
# rounds after which a profile is that of its height; more where steps are divided
_FEW, _MORE = 2, 4
# growth d log f/d log h from which on there may be several states, with a margin: 1 is
# that of a fold
_STEEP = 0.5
_ZOOMS, _ZOOMED = 3, 6  # how often a step is divided, and by how many heights
# how far a state may move, relatively, from one level to the next
_MOVED = 0.25
_NUDGE = 0.01  # relative step of a height, to see whether a state is stable
_K = 6  # nodes per decade over the depth


class Problem(NamedTuple):
    """Points of a surface under a pressure, flat."""

    body: SteadyBody
    spectrum: AbstractSpectrum
    local: Local  # softening and direction
    heat: Heat
    adhesion: AdhesiveShear | None
    velocity: Array  # [m/s]
    reduced: Array  # v a_T at the body's temperature
    temperature: Array  # of the body
    pressure: Array  # [Pa]
    reduced_pressure: Array  # p/b_T at the body's temperature

    def of(self, points: Which) -> Problem:
        """The same for some of the points."""
        names = ("velocity", "reduced", "temperature", "pressure", "reduced_pressure")
        return self._replace(
            local=self.local.of(points),
            **{name: getattr(self, name)[points] for name in names},
        )


class Warm(NamedTuple):
    """Temperatures by scale, as `Local` takes them, and what they come from."""

    warmed: Warmed
    error: Array  # of mu, for the stations and cells
    mean: Array  # rise, by where the heat arises [K]
    contact: Array  # rise of real contact, at q_high [K]
    flux: Array  # heat per time and nominal area [W/m^2]
    to_road: Array  # share of it that the road takes
    good: Array  # where temperatures have settled
    several: Array  # where there are other steady states
    # where friction makes more heat than is led away up to the highest rise, and there
    # is no state
    runaway: Array

    def known(self) -> Any:
        """The mean rise, 0 where there is none."""
        return np.where(self.good, self.mean, 0.0)


class Conduction(NamedTuple):
    """Kernels of conduction at the nodes of a surface."""

    wave_nodes: Nodes
    per_decade: int  # cells
    ends: Array  # log q_low and log q_high (2,)
    log_q: Array  # of the stations
    cell: Array  # in which each station lies
    place: Array  # where in it, 0 to 1
    depth: Array  # D_q(k) of the stations (stations, k), times dk
    of_nodes: Array  # D_q(k) of the nodes (cells, 2, k)
    of_end: Array  # D_Q(k) (k,)
    weight: Array  # dk (k,)
    kernel: Array  # r^2 I0 K0 at r = pi/q of the nodes (points, k, cells, 2)
    near: Array  # integrals over r below that of each station (points, k, stations)
    line: Array  # r I0(w r) exp(-w r) at the nodes (points, cells, 2)
    line_near: Array  # its integral below pi/q_high (points,)


def warmed(problem: Problem, model: WaveByWave, hot: bool) -> Warm:
    """The temperatures that friction makes: of several states that of rubber that was
    cold, or the one of rubber that was `hot`; see the head of this file.
    """
    if is_traced(problem):
        return _of_traced(problem, model, hot)
    rise, seen, several, steep = _first(problem, model, hot)
    good = seen.copy()
    size, left = good.size, np.arange(good.size)
    error, mean, flux, to_road = (np.full(size, np.nan) for _ in range(4))
    # of all points, level by level; of those that are left out that of the level before
    mus: list[np.ndarray] = []
    for number, level in enumerate(_LEVELS):
        rise = _at_stations(rise, _count(problem.spectrum, level))
        state, now = _on_level(
            problem.of(left),
            model,
            _CELLS * level,
            Found(rise[left], good[left], several[left], steep[left]),
            hot,
            anew=number == _USUAL,
        )
        rise[left], good[left], several[left], steep[left] = now
        mean[left], flux[left], to_road[left] = state.mean, state.flux, state.to_road
        mus.append(flux / (problem.pressure * problem.velocity))
        if number >= _USUAL:
            error[left] = _error(*(mu[left] for mu in mus[-3:]))
            left = left[good[left] & ~(error[left] <= _ASKED * abs(mus[-1][left]))]
            if not left.size:
                break
    good = good & (error <= _MOST * abs(mus[-1]))
    profile = Warmed(_ends(problem.spectrum), rise, problem.temperature, problem.body)
    contact, runaway = rise[:, -1], ~seen
    return Warm(profile, error, mean, contact, flux, to_road, good, several, runaway)


def _on_level(
    problem: Problem,
    model: WaveByWave,
    per_decade: int,
    near: Found,
    hot: bool,
    anew: bool = False,
) -> tuple[HeatState, Found]:
    """The states on cells of one level from those of the level before; looked for
    again where they are not close to these, as next to a fold, and with `anew` wherever
    there may be several: coarse cells fold some per cent of the velocity early.
    """
    stations = near.rise.shape[1]
    highest = highest_rise(problem.body, problem.temperature)
    of = _state(problem, model, _conduction(problem, model, per_decade, stations))
    rise, good = _settle(of, near.rise, highest)
    good &= ~near.steep | _is_near(of, near.rise, rise)
    several, steep = near.several.copy(), near.steep.copy()
    lost = np.flatnonzero(near.seen & (~good | (anew & near.steep)))
    if lost.size:
        rest = problem.of(lost)
        again = _first(rest, model, hot, per_decade, stations)
        of_rest = _state(rest, model, _conduction(rest, model, per_decade, stations))
        rise[lost], settled = _settle(of_rest, again.rise, highest[lost])
        close = ~again.steep | _is_near(of_rest, again.rise, rise[lost])
        good[lost] = settled & again.seen & close
        several[lost], steep[lost] = again.several, again.steep
    return of(rise), Found(rise, good & near.seen, several, steep)


def _is_near(of: Callable[[Any], HeatState], start: Array, rise: Array) -> Any:
    """Whether a state is the one at the start: about as hot, and as stable."""
    height = rise.max(-1)
    off = abs(height - start.max(-1)) <= _MOVED * height + _LOWEST
    more = of(rise * (1 + _NUDGE)).rise.max(-1) - height
    return off & (more < _NUDGE * height + _NOTHING)


def _error(coarsest: Array, coarse: Array, fine: Array) -> Any:
    """The last change, or what is left of the one before by the order of the splines,
    if that is more.

    The whole change: where the rise begins it has a kink too narrow for any station, of
    order 1.4.
    """
    return np.maximum(abs(fine - coarse), abs(coarse - coarsest) / _ORDER_4)


def _at_stations(rise: Array, count: int) -> Any:
    """Rises at `count` stations; exactly the same splines where those are twice as
    many.
    """
    return rise @ basis(rise.shape[1], np.arange(1, count + 1) / count).T


def _of_traced(problem: Problem, model: WaveByWave, hot: bool) -> Warm:
    """`warmed` under a transformation of JAX: numbers from NumPy, the derivatives of
    temperatures from the equation that they solve on one level of cells.
    """
    spectrum = known(stop_gradient(problem.spectrum))
    counts = cell_counts(spectrum, _TRACED_CELLS)
    stations = _count(spectrum, _LEVELS[_USUAL]), _count(spectrum, _LEVELS[-1])
    softened = problem.local.softened
    share = None if softened is None else softened.share
    shared = _HeatShared(
        problem.body, problem.spectrum, share, problem.heat, problem.adhesion
    )
    points = _HeatPoints(
        problem.velocity,
        problem.reduced,
        problem.temperature,
        problem.pressure,
        problem.reduced_pressure,
        to_points(problem.local.directed),
    )
    solve = _with_slopes(model, *stations, counts, hot)
    solved = solve(*as_doubles((shared, points)))
    ends, rise = _ends(problem.spectrum), xp.transpose(solved.rise)
    return Warm(
        Warmed(ends, rise, problem.temperature, problem.body),
        solved.error,
        solved.mean,
        solved.rise[-1],
        solved.flux,
        solved.to_road,
        solved.good > 0,
        solved.several > 0,
        solved.runaway > 0,
    )


class _TracedWarm(NamedTuple):
    """Fields of `Warm`; the first four have derivatives."""

    rise: Array  # at the finest stations (finest, points) [K]
    mean: Array
    flux: Array
    to_road: Array
    error: Array
    good: Array
    several: Array
    runaway: Array


class _HeatShared(NamedTuple):
    """What all points of a problem share, for `_with_slopes`."""

    body: SteadyBody
    spectrum: AbstractSpectrum
    share: Array | None  # strain over rms slope, of a softening
    heat: Heat
    adhesion: AdhesiveShear | None


class _HeatPoints(NamedTuple):
    """What each point has of its own, as in `Problem`."""

    velocity: Array
    reduced: Array
    temperature: Array
    pressure: Array
    reduced_pressure: Array
    direction: Array | None  # of sliding (1, points)


def _problem(shared: _HeatShared, points: _HeatPoints) -> Problem:
    body, spectrum, share, heat, adhesion = shared
    *scene, direction = points
    softened = None
    if share is not None:
        assert body.softening is not None
        softened = SoftenedByScale(body.softening, spectrum, share)
    local = Local(softened, None, of_points(lay_of(spectrum), direction))
    return Problem(body, spectrum, local, heat, adhesion, *scene)


@functools.lru_cache(64)
def _with_slopes(
    model: WaveByWave, stations: int, finest: int, counts: tuple[int, ...], hot: bool
) -> Callable[..., _TracedWarm]:
    """Numbers of `warmed`, whatever its level was, with derivatives as of `stations`."""

    def numbers(shared: _HeatShared, points: _HeatPoints) -> _TracedWarm:
        problem = _problem(shared, points)
        warm = warmed(problem, model, hot)
        rise = _at_stations(warm.warmed.rise, finest).T
        made = warm.mean, warm.flux, warm.to_road, warm.error
        return _TracedWarm(rise, *made, warm.good, warm.several, warm.runaway)

    of_usual = _rises(model, stations, counts, hot)

    def rises(shared: _HeatShared, points: _HeatPoints) -> tuple[Any, ...]:
        return (_at_stations(of_usual(shared, points).T, finest).T,)

    def others(shared: _HeatShared, points: _HeatPoints) -> tuple[Any, ...]:
        problem = _problem(shared, points)
        conduct = _conduction(problem, model, _TRACED_CELLS, stations, counts)
        rise = of_usual(shared, points)
        state = _state(problem, model, conduct)(rise.T)
        return state.mean, state.flux, state.to_road

    def like(shared: _HeatShared, points: _HeatPoints) -> tuple[Any, ...]:
        return (_shape(finest, points), *(points.velocity,) * 7)

    solve = numbers_with_slopes(numbers, ((rises, 1), (others, 3)), like)
    return lambda shared, points: _TracedWarm(*solve(shared, points))


@functools.lru_cache(64)
def _rises(
    model: WaveByWave, stations: int, counts: tuple[int, ...], hot: bool
) -> Callable[..., Any]:
    """Rises (stations, points) that friction makes at these rises."""

    def search(shared: _HeatShared, points: _HeatPoints) -> tuple[Any, None]:
        problem = _problem(shared, points)
        near = _first(problem, model, hot)
        near = near._replace(rise=_at_stations(near.rise, stations))
        _, near = _on_level(problem, model, _TRACED_CELLS, near, hot)
        return np.where(near.seen[:, None], near.rise, np.nan).T, None

    def equation(rise: Array, _: None, shared: _HeatShared, points: _HeatPoints) -> Any:
        problem = _problem(shared, points)
        conduct = _conduction(problem, model, _TRACED_CELLS, stations, counts)
        return _state(problem, model, conduct)(rise.T).rise.T - rise

    def like(shared: _HeatShared, points: _HeatPoints) -> tuple[Any, None]:
        return _shape(stations, points), None

    return implicit(search, equation, like, coupled=True)


def _shape(stations: int, points: _HeatPoints) -> Array:
    return xp.zeros((stations, *points.velocity.shape))


class HeatState(NamedTuple):
    """What temperatures make."""

    rise: Array  # of the stations (points, stations)
    mean: Array
    flux: Array
    to_road: Array


def _state(
    problem: Problem, model: WaveByWave, conduct: Conduction
) -> Callable[[Any], HeatState]:
    """The temperatures that friction makes at temperatures (points, stations)."""
    moduli = _moduli(problem, conduct.wave_nodes, conduct.per_decade)

    def of(rise: Array) -> HeatState:
        local = problem.local._replace(
            warmed=Warmed(conduct.ends, rise, problem.temperature, problem.body)
        )
        by_wave = model.waves(
            WaveProblem(
                moduli,
                conduct.wave_nodes,
                problem.reduced,
                problem.reduced_pressure,
                local,
            )
        )
        return _heated(problem, model, conduct, by_wave, rise)

    return of


def _moduli(problem: Problem, wave_nodes: Nodes, per_decade: int) -> Moduli:
    """Tables for temperatures up to the highest rise; where JAX traces E* itself."""
    if is_traced(problem):
        return problem.body.complex_modulus
    hottest = highest_rise(problem.body, problem.temperature)[:, None]
    local = problem.local._replace(
        warmed=Warmed(
            _ends(problem.spectrum), hottest, problem.temperature, problem.body
        )
    )
    return table_of(
        problem.body.complex_modulus, wave_nodes, problem.reduced, per_decade, local
    )


def _adhesive(problem: Problem, area: Array, temperature: Array) -> Any:
    """Part of mu from the shear of the real contact."""
    if problem.adhesion is None:
        return 0.0 * area
    stress = problem.adhesion.shear_stress(problem.velocity, temperature)
    return stress * area / problem.pressure


def _heated(
    problem: Problem, model: WaveByWave, c: Conduction, by_wave: Waves, rise: Array
) -> HeatState:
    shear = _adhesive(problem, by_wave.area, problem.temperature + rise[:, -1])
    whole = by_wave.each.sum((-2, -1)) + by_wave.edges + shear
    flux = whole * problem.pressure * problem.velocity
    whole = xp.where(whole > 0, whole, 1.0)  # elastic rubber makes no heat
    depth = (
        xp.tensordot(by_wave.each, c.of_nodes, 2)
        + by_wave.edges[:, None] * c.of_end
        + shear[:, None]
    )
    depth = depth / whole[:, None]  # S(k)
    on_surface = shear / whole  # of it
    excess = (
        1
        / model.contact(integral_to(by_wave.rate, c.wave_nodes.weight), by_wave.stiffer)
        - 1
    )
    variance = _integral_to_stations(by_wave.rate, c.wave_nodes, c.cell, c.place)
    ends = (
        1 / model.contact(variance, _of_stations(by_wave.stiffer, c.cell, c.place)) - 1
    )
    # int r dr c_q(r) I0 K0 of each station: beyond its half wave by the nodes, below it
    # by the share of its own
    inner = (
        _integral_to_stations(c.kernel * excess[:, None], c.wave_nodes, c.cell, c.place)
        + ends[:, None, :] * c.near
    )
    factor = 2 / (np.pi * problem.heat.conductivity)
    of_volume = factor * xp.einsum("nks,sk,nk->ns", inner, c.depth, depth)  # <D_q S>_q
    of_surface = factor * xp.einsum("nks,sk->ns", inner, c.depth)  # <D_q>_q
    road = 0.0 * flux
    if problem.heat.road is not None:
        line = (c.line * excess * c.wave_nodes.weight).sum((-2, -1)) + ends[
            :, -1
        ] * c.line_near
        # <1>_Q, since int K0 dk = (pi/2) exp(-w r)/r
        line = line / problem.heat.conductivity
        below = factor * (
            inner[..., -1] * (depth - on_surface[:, None]) * c.weight
        ).sum(-1)
        top = below + on_surface * line  # <S>_Q
        still = (np.pi / c.wave_nodes.q * excess * c.wave_nodes.weight).sum(
            (-2, -1)
        ) + ends[:, -1] * np.pi / c.wave_nodes.end
        resistance = line + still / problem.heat.road[0]
        road = xp.where(top > 0, top / xp.where(top > 0, resistance, 1.0), 0.0)
    made = flux[:, None] * (of_volume - road[:, None] * of_surface)
    # the mean by where heat arises, at nodes from the stations
    share = by_wave.each / whole[:, None, None]
    log_q = xp.log(c.wave_nodes.q).reshape(-1)
    spline = basis(rise.shape[1], place_of(log_q, c.ends))
    weight = share.reshape(share.shape[0], -1) @ spline
    mean = (rise * weight).sum(-1) + (by_wave.edges + shear) / whole * rise[:, -1]
    return HeatState(made, mean, flux, road)


def _conduction(
    problem: Problem,
    model: WaveByWave,
    per_decade: int,
    count: int,
    cells: tuple[int, ...] | None = None,
) -> Conduction:
    """Kernels on cells of q, for `count` stations; `cells` as `cell_counts` gives
    them, where the spectrum is traced.
    """
    decades = sum(cells or ()) / per_decade
    if cells is None:
        decades = _decades(problem.spectrum)
    bent = bends(problem.spectrum, problem.local)
    wave_nodes = nodes(problem.spectrum, per_decade, bent, cells)
    ends = _ends(problem.spectrum)
    log_q = log_stations(count, ends)
    cell, place = _cells_of(log_q, wave_nodes)
    k, dk = _depth_waves(wave_nodes, int(_K * (6 + decades)) + 1)
    # The kernel of points that share a velocity is made once.
    velocity, of_each = distinct(problem.velocity)
    w = velocity * problem.heat.heat_capacity / (2 * problem.heat.conductivity)
    made = _kernels(wave_nodes, w, k, cell, place)
    q = xp.exp(log_q)
    return Conduction(
        wave_nodes,
        per_decade,
        ends,
        log_q,
        cell,
        place,
        depth=_profile(q[:, None], k) * dk,
        of_nodes=_profile(wave_nodes.q[..., None], k),
        of_end=_profile(wave_nodes.end, k),
        weight=dk,
        **dict(zip(made._fields, map(of_each, made), strict=True)),
    )


def _cells_of(log_q: Array, wave_nodes: Nodes) -> tuple[Any, Any]:
    """The cell in which each station lies, and where in it, 0 to 1."""
    width = 2 * wave_nodes.weight[:, 0]
    start = xp.log(wave_nodes.q[:, 0]) - (0.5 - np.sqrt(3) / 6) * width
    cell = xp.searchsorted(start, log_q, side="right") - 1
    cell = xp.clip(cell, 0, width.shape[0] - 1)
    return cell, xp.clip((log_q - start[cell]) / width[cell], 0.0, 1.0)


def _depth_waves(wave_nodes: Nodes, count: int) -> tuple[Any, Any]:
    """Wave numbers k over the depth, and dk by the trapezoidal rule of log k."""
    low, high = 1e-3 * wave_nodes.q[0, 0], 1e3 * wave_nodes.end
    k = xp.exp(xp.log(low) + xp.log(high / low) * np.linspace(0.0, 1.0, count))
    trapezoid = np.concatenate([[0.5], np.ones(count - 2), [0.5]])
    # what lies below the lowest counts as even
    below = np.concatenate([[1.0], np.zeros(count - 1)])
    return k, k * (xp.log(k[1] / k[0]) * trapezoid + below)


class _HeatKernels(NamedTuple):
    """As `Conduction` has them."""

    kernel: Any
    near: Any
    line: Any
    line_near: Any


def _kernels(
    wave_nodes: Nodes, w: Array, k: Array, cell: Array, place: Array
) -> _HeatKernels:
    """Those for each w = v/2D."""
    # Below half the shortest wave r goes with the fourth power of Gauss' nodes: over
    # dlog r = 4 dy/y.
    y, weights, _ = gauss_unit(_NEAR_NODES)
    weights = 4 * weights / y

    def kernel(r: Array) -> Any:
        """r^2 I0(w r) K0(r sqrt(w^2 + k^2)), (velocities, k, ...)."""
        more = r.ndim
        speed, wave = w.reshape(-1, 1, *[1] * more), k.reshape(-1, *[1] * more)
        root = xp.hypot(speed, wave)
        return (
            special.i0e(speed * r)
            * _k0e(root * r)
            * xp.exp(-(wave**2) / (root + speed) * r)
            * r**2
        )

    far, close = np.pi / wave_nodes.q, np.pi / wave_nodes.end * y**4
    at_nodes, below = kernel(far), kernel(close) @ weights
    beyond = (at_nodes * wave_nodes.weight).sum((-2, -1))[..., None]
    beyond = beyond - _integral_to_stations(at_nodes, wave_nodes, cell, place)
    speed = w.reshape(-1, 1, 1)
    line = far * special.i0e(speed * far)
    line_near = (close * special.i0e(speed[..., 0] * close)) @ weights
    return _HeatKernels(at_nodes, below[..., None] + beyond, line, line_near)


def _profile(q: Array, k: Array) -> Any:
    """D_q(k)."""
    return 4 * q**2 / (k**2 + 4 * q**2)


def _integral_to_stations(rate: Array, wave_nodes: Nodes, cell: Array, s: Array) -> Any:
    """int dlog q of `rate` (..., cells, 2) from q_low to each station: (...,
    stations).
    """
    first, second = rate[..., 0], rate[..., 1]
    width = 2 * wave_nodes.weight[:, 0]
    whole = 0.5 * width * (first + second)
    before = xp.cumsum(whole, axis=-1) - whole
    near = 0.5 - np.sqrt(3) / 6
    one, other = first[..., cell], second[..., cell]
    within_cell = width[cell] * (
        one * s + (other - one) * np.sqrt(3) * (0.5 * s**2 - near * s)
    )
    return before[..., cell] + xp.clip(within_cell, 0.0, whole[..., cell])


def _of_stations(values: Array, cell: Array, s: Array) -> Any:
    """Values at the nodes (..., cells, 2), at each station: (..., stations)."""
    near = 0.5 - np.sqrt(3) / 6
    first, second = values[..., cell, 0], values[..., cell, 1]
    return first + (second - first) * np.sqrt(3) * (s - near)


def _decades(spectrum: AbstractSpectrum) -> float:
    q = spectrum.q
    return _TRACED_DECADES if is_traced(q) else float(np.log10(q[-1] / q[0]))


def _count(spectrum: AbstractSpectrum, level: int) -> int:
    """How many stations a surface has."""
    return level * max(2, round(_STATIONS * _decades(spectrum)))


def _ends(spectrum: AbstractSpectrum) -> Any:
    """log q_low and log q_high."""
    return xp.log(xp.stack([spectrum.q[0], spectrum.q[-1]]))


class Found(NamedTuple):
    """Where a steady state is, near enough for `_settle`."""

    rise: Array  # (points, stations)
    seen: Array  # whether there is one
    several: Array  # whether there are others
    steep: Array  # whether others could be near, so that it must not move far


class Heights(NamedTuple):
    """What friction makes of profiles of several heights h, their largest rises."""

    tried: Array  # h, ascending (steps, points)
    made: Array  # f, the height that friction makes (steps, points)
    shape: Array  # profiles over their height (steps, points, stations)

    def growth(self) -> Any:
        """log f/h, zero at a steady state."""
        return np.log(np.maximum(self.made, 1e-300) / self.tried)

    def steep(self) -> Any:
        """Points at which f may grow as fast as h somewhere, as it does at a fold."""
        slope = np.diff(self.growth(), axis=0) / np.diff(np.log(self.tried), axis=0)
        return (slope > _STEEP - 1).any(0)

    def several(self) -> Any:
        """Points with a height from which rubber heats up by itself to another."""
        below = self.made <= self.tried
        return (below[:-1] & ~below[1:]).any(0)

    def seen(self, hot: bool) -> Any:
        """Points that have the state."""
        below = self.made <= self.tried
        return below[-1] if hot else below.any(0)

    def place(self, hot: bool) -> Any:
        """The step that ends above the coldest or the hottest state."""
        above = self.made > self.tried
        if not hot:
            return np.argmin(above, 0)
        last = above.shape[0] - np.argmax(above[::-1], 0)
        return np.where(above.any(0), np.minimum(last, above.shape[0] - 1), 0)

    def at(self, place: Array) -> Heights:
        """One height for each point."""
        every = np.arange(place.size)
        return Heights(*(x[place, every] for x in self))

    def start(self, hot: bool) -> Any:
        """Rises near the state, by a straight line over the step."""
        place = self.place(hot)
        low, high = self.at(np.maximum(place - 1, 0)), self.at(place)
        off_low, off_high = low.made - low.tried, high.tried - high.made
        share = off_low / np.where(off_low + off_high > 0, off_low + off_high, 1.0)
        height = low.tried + share * (high.tried - low.tried)
        height = np.where(place == 0, np.minimum(high.made, high.tried), height)
        share = np.where(place == 0, 1.0, share)[:, None]
        return height[:, None] * (low.shape + share * (high.shape - low.shape))

    def between(self, first: Array, last: Array, count: int) -> tuple[Any, Any]:
        """`count` heights from the place `first` to `last` of each point, and shapes."""
        low, high = self.at(first), self.at(last)
        share = np.linspace(0.0, 1.0, count)[:, None]
        tried = low.tried ** (1 - share) * high.tried**share
        return tried, low.shape + share[..., None] * (high.shape - low.shape)


def _first(
    problem: Problem,
    model: WaveByWave,
    hot: bool,
    per_decade: int = _SCAN,
    stations: int | None = None,
) -> Found:
    """Rises near the coldest steady state, or near the hottest one.

    Of profiles of the height h, their largest rise, there is one that friction makes in
    the same shape, and at it the height f(h). Steady states are where f = h, stable
    ones where f falls below h: along h all are found in their order, those that rubber
    reaches from the cold first.
    """
    if stations is None:
        stations = _count(problem.spectrum, _SCAN_STATIONS)
    scan = functools.partial(_scan, model=model, per_decade=per_decade)
    near = [
        _first_of_few(problem.of(slice(i, i + _BATCH)), scan, stations, hot)
        for i in range(0, problem.reduced.size, _BATCH)
    ]
    return Found(*map(np.concatenate, zip(*near, strict=True)))


def _first_of_few(
    problem: Problem, scan: Callable[..., Heights], stations: int, hot: bool
) -> Found:
    highest = np.maximum(highest_rise(problem.body, problem.temperature), _NOTHING)
    tried = np.geomspace(np.minimum(_LOWEST, 0.5 * highest), highest, _HEIGHTS)
    even = np.linspace(1 / stations, 1, stations) * np.ones((*tried.shape, 1))
    heights = scan(problem, tried, even, _FEW)
    rise, seen, several, is_steep = (
        heights.start(hot),
        heights.seen(hot),
        heights.several(),
        heights.steep(),
    )
    steep = np.flatnonzero(is_steep)
    if steep.size:
        rest = problem.of(steep)
        heights = Heights(*(x[:, steep] for x in heights))
        steps = np.arange(_PARTS * (_HEIGHTS - 1) + 1) / _PARTS
        left = np.minimum(steps.astype(int), _HEIGHTS - 2)
        share = (steps - left)[:, None]
        tried = heights.tried[left] ** (1 - share) * heights.tried[left + 1] ** share
        heights = scan(rest, tried, heights.shape[left], _MORE)
        heights = _with_fold(heights, rest, scan)
        seen[steep], several[steep] = heights.seen(hot), heights.several()
        for _ in range(_ZOOMS):
            place = heights.place(hot)
            near = heights.between(np.maximum(place - 1, 0), place, _ZOOMED)
            heights = scan(rest, *near, _MORE)
        rise[steep] = heights.start(hot)
    return Found(rise, seen, several, is_steep)


def _with_fold(
    heights: Heights, problem: Problem, scan: Callable[..., Heights]
) -> Heights:
    """More heights about the extremum of log f/h that is next to zero: two states that
    are closer than a step.
    """
    growth = heights.growth()
    size, inner = abs(growth), growth[1:-1]
    least = (size[1:-1] <= size[:-2]) & (size[1:-1] <= size[2:])
    alike = (inner * growth[:-2] > 0) & (inner * growth[2:] > 0)
    place = 1 + np.argmin(np.where(least & alike, abs(inner), np.inf), 0)
    more = scan(problem, *heights.between(place - 1, place + 1, 2 * _ZOOMED), _MORE)
    both = Heights(*(np.concatenate(x) for x in zip(heights, more, strict=True)))
    order = np.argsort(both.tried, axis=0, kind="stable")
    return Heights(*(x[order, np.arange(order.shape[1])] for x in both))


def _scan(
    problem: Problem,
    tried: Array,
    shape: Array,
    rounds: int,
    *,
    model: WaveByWave,
    per_decade: int,
) -> Heights:
    """Friction at heights (steps, points), at the profiles that it makes at them after
    some rounds from `shape` on.
    """
    stations = shape.shape[-1]
    many = problem.of(np.tile(np.arange(tried.shape[1]), len(tried)))
    of = _state(many, model, _conduction(many, model, per_decade, stations))
    height, rows = tried.reshape(-1, 1), shape.reshape(-1, stations)
    made = np.zeros(height.size)
    for _ in range(rounds):
        rise = np.nan_to_num(np.maximum(of(height * rows).rise, 0.0), nan=np.inf)
        made = rise.max(-1)
        rows = rise / np.where((made > 0) & (made < np.inf), made, 1.0)[:, None]
    return Heights(tried, made.reshape(tried.shape), rows.reshape(shape.shape))


def _settle(
    of: Callable[[Any], HeatState], rise: Array, highest: Array
) -> tuple[Any, Any]:
    """Fixed point of temperatures, and where it was found: Anderson's method with one
    step of memory.
    """
    before, off_before = np.zeros_like(rise), np.zeros_like(rise)
    good = np.zeros(rise.shape[0], dtype=bool)
    for count in range(_ROUNDS):
        off = of(rise).rise - rise
        size = np.maximum(np.abs(rise).max(-1), 1e4 * _NOTHING)
        good = np.abs(off).max(-1) <= _SETTLED * size
        turn, move = off - off_before, rise - before
        share = (turn * off).sum(-1) / np.maximum((turn**2).sum(-1), 1e-300)
        share = np.clip(share, -20.0, 20.0)[:, None]
        new = rise + off - share * (move + turn) if count else rise + 0.5 * off
        new = np.where(np.isfinite(new), new, 0.0)
        new = np.clip(new, 0.0, highest[:, None])
        steady = good[:, None]
        before, off_before = (
            np.where(steady, before, rise),
            np.where(steady, off_before, off),
        )
        rise = np.where(steady, rise, new)
        if good.all():
            break
    return rise, good & (rise.max(-1) <= highest)


def _k0e(x: Array) -> Any:
    """exp(x) K0(x)."""
    if not is_traced(x):
        return special.k0e(x)
    # by polynomials, to 2e-7: Abramowitz & Stegun 9.8.5 and 9.8.6
    import jax.numpy as jnp

    small, large = jnp.minimum(x, 2.0), jnp.maximum(x, 2.0)
    near, far = (small / 2) ** 2, 2 / large
    low = (
        -0.57721566,
        0.42278420,
        0.23069756,
        0.03488590,
        0.00262698,
        0.00010750,
        0.00000740,
    )
    high = (
        1.25331414,
        -0.07832358,
        0.02189568,
        -0.01062446,
        0.00587872,
        -0.00251540,
        0.00053208,
    )
    first = jnp.exp(small) * (
        -jnp.log(small / 2) * special.i0e(small) * jnp.exp(small)
        + jnp.polyval(jnp.array(low[::-1]), near)
    )
    return jnp.where(
        x < 2, first, jnp.polyval(jnp.array(high[::-1]), far) / jnp.sqrt(large)
    )
