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
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fixed, is_traced, namespace, xp
from ..checks import known
from ..numerics.implicit import as_doubles, implicit, numbers_with_slopes
from ..numerics.quadrature import gauss_unit
from ..surface.lay import lay_of
from .against_lay import of_points, to_points
from .heat import HIGHEST, Heat, highest_rise
from .local_modulus import Local, Softened, Warmed, basis, log_stations, place_of
from .multiscale import Waves, bends, table_of
from .psd_integrals import Nodes, cell_counts, integral_to, nodes

_TRACED_DECADES = 3  # of a surface whose cutoffs JAX traces
_BATCH = 512  # points whose first temperatures are looked for at once
_NEAR_NODES = 24  # over the distances below half the shortest wave
# relative change of temperatures at which they have settled; most rounds
_SETTLED, _ROUNDS = 1e-8, 80
# the same where only the profile of a first temperature is wanted
_PROFILE = 1e-4
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
_K = 6  # nodes per decade over the depth


class Problem(NamedTuple):
    """Points of a surface under a pressure, flat."""

    body: Any  # foundation
    spectrum: Any
    local: Local  # softening and direction
    heat: Heat
    adhesion: Any  # em.AdhesiveShear, or None
    velocity: Any  # [m/s]
    reduced: Any  # v a_T at the body's temperature
    temperature: Any  # of the body
    pressure: Any  # [Pa]
    reduced_pressure: Any  # p/b_T at the body's temperature

    def of(self, points: Any) -> Problem:
        """The same for some of the points."""
        names = ("velocity", "reduced", "temperature", "pressure", "reduced_pressure")
        return self._replace(
            local=self.local.of(points),
            **{name: getattr(self, name)[points] for name in names},
        )


class Warm(NamedTuple):
    """Temperatures by scale, as `Local` takes them, and what they come from."""

    warmed: Warmed
    error: Any  # of mu, for the stations and cells
    mean: Any  # rise, by where the heat arises [K]
    contact: Any  # rise of real contact, at q_high [K]
    flux: Any  # heat per time and nominal area [W/m^2]
    to_road: Any  # share of it that the road takes
    good: Any  # where temperatures have settled
    several: Any  # where another steady state, hotter, was seen


class Conduction(NamedTuple):
    """Kernels of conduction at the nodes of a surface."""

    wave_nodes: Nodes
    per_decade: int  # cells
    ends: Any  # log q_low and log q_high (2,)
    log_q: Any  # of the stations
    cell: Any  # in which each station lies
    place: Any  # where in it, 0 to 1
    depth: Any  # D_q(k) of the stations (stations, k), times dk
    of_nodes: Any  # D_q(k) of the nodes (cells, 2, k)
    of_end: Any  # D_Q(k) (k,)
    weight: Any  # dk (k,)
    kernel: Any  # r^2 I0 K0 at r = pi/q of the nodes (points, k, cells, 2)
    near: Any  # integrals over r below that of each station (points, k, stations)
    line: Any  # r I0(w r) exp(-w r) at the nodes (points, cells, 2)
    line_near: Any  # its integral below pi/q_high (points,)


def warmed(problem: Problem, model: Any, highest: float) -> Warm:
    """The temperatures that friction makes, the lowest ones where there are several;
    see the head of this file.
    """
    if is_traced(problem):
        return _of_traced(problem, model, highest)
    rise, seen, several = _first(
        problem, model, _count(problem.spectrum, _SCAN_STATIONS), highest
    )
    size, left = seen.size, np.arange(seen.size)
    good = seen
    error, mean, flux, to_road = (np.full(size, np.nan) for _ in range(4))
    # of all points, level by level; of those that are left out that of the level before
    mus: list[np.ndarray] = []
    for number, level in enumerate(_LEVELS):
        rise = _at_stations(rise, _count(problem.spectrum, level))
        problem_left = problem.of(left)
        of = _state(
            problem_left,
            model,
            _conduction(problem_left, model, _CELLS * level, rise.shape[1]),
            highest,
        )
        rise[left], good[left] = _settled(of, rise[left], good[left], highest)
        state = of(rise[left])
        mean[left], flux[left], to_road[left] = state.mean, state.flux, state.to_road
        mus.append(flux / (problem.pressure * problem.velocity))
        if number >= _USUAL:
            error[left] = _error(*(mu[left] for mu in mus[-3:]))
            left = left[good[left] & ~(error[left] <= _ASKED * abs(mus[-1][left]))]
            if not left.size:
                break
    good = good & (error <= _MOST * abs(mus[-1]))
    profile = Warmed(
        _ends(problem.spectrum), rise, highest, problem.temperature, problem.body
    )
    return Warm(profile, error, mean, rise[:, -1], flux, to_road, good, several)


def _settled(
    of: Callable[[Any], State], rise: Any, seen: Any, highest: float
) -> tuple[Any, Any]:
    """`_settle`, where a steady state has been seen before."""
    rise, good = _settle(of, rise, highest)
    return rise, good & seen


def _error(coarsest: Any, coarse: Any, fine: Any) -> Any:
    """The last change, or what is left of the one before by the order of the splines,
    if that is more.

    The whole change: where the rise begins it has a kink too narrow for any station, of
    order 1.4.
    """
    return np.maximum(abs(fine - coarse), abs(coarse - coarsest) / _ORDER_4)


def _at_stations(rise: Any, count: int) -> Any:
    """Rises at `count` stations; exactly the same splines where those are twice as
    many.
    """
    return rise @ basis(rise.shape[1], np.arange(1, count + 1) / count).T


def _of_traced(problem: Problem, model: Any, highest: float) -> Warm:
    """`warmed` under a transformation of JAX: numbers from NumPy, the derivatives of
    temperatures from the equation that they solve on one level of cells.
    """
    spectrum = known(fixed(problem.spectrum))
    counts = cell_counts(spectrum, _TRACED_CELLS)
    stations = _count(spectrum, _LEVELS[_USUAL]), _count(spectrum, _LEVELS[-1])
    softened = problem.local.softened
    share = None if softened is None else softened.share
    shared = problem.body, problem.spectrum, share, problem.heat, problem.adhesion
    points = (problem.velocity, problem.reduced, problem.temperature)
    points += (problem.pressure, problem.reduced_pressure)
    points += (to_points(problem.local.directed),)
    solve = _with_slopes(model, *stations, counts)
    rise, mean, flux, to_road, error, good, several = solve(
        *as_doubles((shared, points))
    )
    ends = _ends(problem.spectrum)
    profile = Warmed(
        ends, xp.transpose(rise), highest, problem.temperature, problem.body
    )
    return Warm(profile, error, mean, rise[-1], flux, to_road, good > 0, several > 0)


def _problem(shared: Any, points: Any) -> Problem:
    body, spectrum, share, heat, adhesion = shared
    *points, direction = points
    softened = None if share is None else Softened(body.softening, spectrum, share)
    local = Local(softened, None, of_points(lay_of(spectrum), direction))
    return Problem(body, spectrum, local, heat, adhesion, *points)


@functools.lru_cache(64)
def _with_slopes(
    model: Any, stations: int, finest: int, counts: tuple[int, ...]
) -> Callable[..., tuple[Any, ...]]:
    """Rises at the finest stations (finest, points), which are those of `warmed`
    whatever its level was, their mean, the heat flux and what the road takes, with
    derivatives as of `stations`; their error, where they are good and where several.
    """

    def numbers(shared: Any, points: Any) -> tuple[Any, ...]:
        problem = _problem(shared, points)
        highest = highest_rise(problem.body, problem.temperature)
        warm = warmed(problem, model, highest)
        rise = _at_stations(warm.warmed.rise, finest).T
        made = warm.mean, warm.flux, warm.to_road
        return (rise, *made, warm.error, warm.good, warm.several)

    of_usual = _rises(model, stations, counts)

    def rises(shared: Any, points: Any) -> tuple[Any, ...]:
        return (_at_stations(of_usual(shared, points).T, finest).T,)

    def others(shared: Any, points: Any) -> tuple[Any, ...]:
        problem = _problem(shared, points)
        conduct = _conduction(problem, model, _TRACED_CELLS, stations, counts)
        rise = of_usual(shared, points)
        state = _state(problem, model, conduct, HIGHEST)(rise.T)
        return state.mean, state.flux, state.to_road

    def like(shared: Any, points: Any) -> tuple[Any, ...]:
        return (_shape(finest, points), *(points[0],) * 6)

    return numbers_with_slopes(numbers, ((rises, 1), (others, 3)), like)


@functools.lru_cache(64)
def _rises(model: Any, stations: int, counts: tuple[int, ...]) -> Callable[..., Any]:
    """Rises (stations, points) that friction makes at these rises."""

    def search(shared: Any, points: Any) -> tuple[Any, None]:
        problem = _problem(shared, points)
        highest = highest_rise(problem.body, problem.temperature)
        conduct = _conduction(problem, model, _TRACED_CELLS, stations)
        start, seen, _ = _first(problem, model, stations, highest)
        state = _state(problem, model, conduct, highest)
        rise, good = _settle(state, start, highest)
        return np.where((good & seen)[:, None], rise, np.nan).T, None

    def equation(rise: Any, _: None, shared: Any, points: Any) -> Any:
        problem = _problem(shared, points)
        conduct = _conduction(problem, model, _TRACED_CELLS, stations, counts)
        return _state(problem, model, conduct, HIGHEST)(rise.T).rise.T - rise

    def like(shared: Any, points: Any) -> tuple[Any, None]:
        return _shape(stations, points), None

    return implicit(search, equation, like, coupled=True)


def _shape(stations: int, points: Any) -> Any:
    return xp.zeros((stations, *points[0].shape))


class State(NamedTuple):
    """What temperatures make."""

    rise: Any  # of the stations (points, stations)
    mean: Any
    flux: Any
    to_road: Any


def _state(
    problem: Problem, model: Any, conduct: Conduction, highest: float
) -> Callable[[Any], State]:
    """The temperatures that friction makes at temperatures (points, stations)."""
    table = _tables(problem, conduct.wave_nodes, conduct.per_decade, highest)

    def of(rise: Any) -> State:
        local = problem.local._replace(
            warmed=Warmed(
                conduct.ends, rise, highest, problem.temperature, problem.body
            )
        )
        by_wave = model.waves(
            problem.body.complex_modulus,
            conduct.wave_nodes,
            problem.reduced,
            problem.reduced_pressure,
            table,
            local,
        )
        return _heated(problem, model, conduct, by_wave, rise)

    return of


def _tables(
    problem: Problem, wave_nodes: Nodes, per_decade: int, highest: float
) -> Any:
    """Tables for temperatures up to a rise, None where JAX traces."""
    if is_traced(problem):
        return None
    hottest = np.full(
        (problem.temperature.size, 1),
        min(highest, highest_rise(problem.body, problem.temperature)),
    )
    local = problem.local._replace(
        warmed=Warmed(None, hottest, highest, problem.temperature, problem.body)
    )
    return table_of(
        problem.body.complex_modulus, wave_nodes, problem.reduced, per_decade, local
    )


def _adhesive(problem: Problem, area: Any, temperature: Any) -> Any:
    """Part of mu from the shear of the real contact."""
    if problem.adhesion is None:
        return 0.0 * area
    stress = problem.adhesion.shear_stress(problem.velocity, temperature)
    return stress * area / problem.pressure


def _heated(
    problem: Problem, model: Any, c: Conduction, by_wave: Waves, rise: Any
) -> State:
    xp = namespace(by_wave.each, rise, problem.velocity)
    shear = _adhesive(problem, by_wave.area, problem.temperature + rise[:, -1])
    whole = by_wave.each.sum((-2, -1)) + by_wave.edges + shear
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
    flux = whole * problem.pressure * problem.velocity
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
    log_q = namespace(c.wave_nodes.q).log(c.wave_nodes.q).reshape(-1)
    spline = basis(rise.shape[1], place_of(log_q, c.ends))
    weight = share.reshape(share.shape[0], -1) @ spline
    mean = (rise * weight).sum(-1) + (by_wave.edges + shear) / whole * rise[:, -1]
    return State(made, mean, flux, road)


def _conduction(
    problem: Problem,
    model: Any,
    per_decade: int,
    count: int,
    cells: tuple[int, ...] | None = None,
) -> Conduction:
    """Kernels on cells of q, for `count` stations; `cells` as `cell_counts` gives
    them, where the spectrum is traced.
    """
    bent, decades = (), sum(cells or ()) / per_decade
    if cells is None:
        bent = bends(problem.spectrum, problem.local)
        decades = _decades(problem.spectrum)
    wave_nodes = nodes(problem.spectrum, per_decade, bent, cells)
    ends = _ends(problem.spectrum)
    log_q = log_stations(count, ends)
    xp = namespace(
        wave_nodes.q,
        log_q,
        problem.velocity,
        problem.heat.conductivity,
        problem.heat.heat_capacity,
    )
    cell, place = _cells_of(log_q, wave_nodes)
    k, dk = _depth_waves(wave_nodes, int(_K * (6 + decades)) + 1, xp)
    # The kernel of points that share a velocity is made once.
    velocity, again = problem.velocity, None
    if xp is np:
        velocity, again = np.unique(problem.velocity, return_inverse=True)
    w = velocity * problem.heat.heat_capacity / (2 * problem.heat.conductivity)
    made = _kernels(wave_nodes, w, k, cell, place, xp)
    kernel, near, line, line_near = (
        made if again is None else (array[again] for array in made)
    )
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
        kernel=kernel,
        near=near,
        line=line,
        line_near=line_near,
    )


def _cells_of(log_q: Any, wave_nodes: Nodes) -> tuple[Any, Any]:
    """The cell in which each station lies, and where in it, 0 to 1."""
    xp = namespace(wave_nodes.q, log_q)  # NumPy where only others are traced
    width = 2 * wave_nodes.weight[:, 0]
    start = xp.log(wave_nodes.q[:, 0]) - (0.5 - np.sqrt(3) / 6) * width
    cell = xp.searchsorted(start, log_q, side="right") - 1
    cell = xp.clip(cell, 0, width.shape[0] - 1)
    return cell, xp.clip((log_q - start[cell]) / width[cell], 0.0, 1.0)


def _depth_waves(wave_nodes: Nodes, count: int, xp: Any) -> tuple[Any, Any]:
    """Wave numbers k over the depth, and dk by the trapezoidal rule of log k."""
    low, high = 1e-3 * wave_nodes.q[0, 0], 1e3 * wave_nodes.end
    k = xp.exp(xp.log(low) + xp.log(high / low) * np.linspace(0.0, 1.0, count))
    trapezoid = np.concatenate([[0.5], np.ones(count - 2), [0.5]])
    # what lies below the lowest counts as even
    below = np.concatenate([[1.0], np.zeros(count - 1)])
    return k, k * (xp.log(k[1] / k[0]) * trapezoid + below)


def _kernels(
    wave_nodes: Nodes, w: Any, k: Any, cell: Any, place: Any, xp: Any
) -> tuple[Any, Any, Any, Any]:
    """`kernel`, `near`, `line` and `line_near` of `Conduction`, for each w = v/2D."""
    # Below half the shortest wave r goes with the fourth power of Gauss' nodes: over
    # dlog r = 4 dy/y.
    y, weights, _ = gauss_unit(_NEAR_NODES)
    weights = 4 * weights / y

    def kernel(r: Any) -> Any:
        """r^2 I0(w r) K0(r sqrt(w^2 + k^2)), (velocities, k, ...)."""
        more = r.ndim
        speed, wave = w.reshape(-1, 1, *[1] * more), k.reshape(-1, *[1] * more)
        root = xp.hypot(speed, wave)
        return (
            _i0e(speed * r)
            * _k0e(root * r)
            * xp.exp(-(wave**2) / (root + speed) * r)
            * r**2
        )

    far, close = np.pi / wave_nodes.q, np.pi / wave_nodes.end * y**4
    at_nodes, below = kernel(far), kernel(close) @ weights
    beyond = (at_nodes * wave_nodes.weight).sum((-2, -1))[..., None]
    beyond = beyond - _integral_to_stations(at_nodes, wave_nodes, cell, place)
    speed = w.reshape(-1, 1, 1)
    line = far * _i0e(speed * far)
    line_near = (close * _i0e(speed[..., 0] * close)) @ weights
    return at_nodes, below[..., None] + beyond, line, line_near


def _profile(q: Any, k: Any) -> Any:
    """D_q(k)."""
    return 4 * q**2 / (k**2 + 4 * q**2)


def _integral_to_stations(rate: Any, wave_nodes: Nodes, cell: Any, s: Any) -> Any:
    """int dlog q of `rate` (..., cells, 2) from q_low to each station: (...,
    stations).
    """
    xp = namespace(rate, s)
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


def _of_stations(values: Any, cell: Any, s: Any) -> Any:
    """Values at the nodes (..., cells, 2), at each station: (..., stations)."""
    near = 0.5 - np.sqrt(3) / 6
    first, second = values[..., cell, 0], values[..., cell, 1]
    return first + (second - first) * np.sqrt(3) * (s - near)


def _decades(spectrum: Any) -> float:
    q = spectrum.q
    return _TRACED_DECADES if namespace(q) is not np else float(np.log10(q[-1] / q[0]))


def _count(spectrum: Any, level: int) -> int:
    """How many stations a surface has."""
    return level * max(2, round(_STATIONS * _decades(spectrum)))


def _ends(spectrum: Any) -> Any:
    """log q_low and log q_high."""
    xp = namespace(spectrum.q)
    return xp.log(xp.stack([spectrum.q[0], spectrum.q[-1]]))


def _first(
    problem: Problem, model: Any, stations: int, highest: float
) -> tuple[Any, Any, Any]:
    """Rises of `stations` near the lowest steady state, where there is one, and where
    there is another.

    Of a profile over the stations, the height is looked for at which friction makes it.
    The profile is that of a steady state on coarse cells: the one that cold rubber
    would make is far steeper where the finest waves are glassy. Where no steady state
    is reached in a few rounds, it is the profile of cold rubber after all.
    """
    conduct = _conduction(problem, model, _SCAN, stations)
    count = problem.reduced.shape[0]
    of = _state(problem, model, conduct, highest)
    cold = np.zeros((count, stations))
    rise, steady = _settle(of, cold, highest, _PROFILE)
    state = of(np.where(steady[:, None], rise, cold))
    top = np.maximum(state.rise.max(-1), _NOTHING)
    shape = state.rise / top[:, None]
    table = _tables(problem, conduct.wave_nodes, _SCAN, highest)
    tried = _heights(top, highest)  # (steps, points)
    many = problem.of(np.tile(np.arange(count), len(tried)))
    rise = (tried[..., None] * shape).reshape(-1, stations)
    power = _powers(many, model, conduct, rise, highest, table)
    made = top * power.reshape(tried.shape) / state.flux
    below = made <= tried
    crossed = below[1:] & ~below[:-1]
    several = (crossed.sum(0) + below[0]) > 1
    start = _crossing(tried, made, np.argmax(below, axis=0))[:, None] * shape
    # another height is a steady state only where its temperatures settle
    if several.any():
        last = crossed.shape[0] - np.argmax(crossed[::-1], axis=0)
        lowest, settled = _settle(of, start, highest, _PROFILE)
        height = tried[last, np.arange(count), None]
        # of hot rubber, which is not that of the lowest state
        profile = of(height * shape).rise
        profile = profile / np.maximum(profile.max(-1, keepdims=True), _NOTHING)
        hotter, hot = _settle(of, height * profile, highest, _PROFILE)
        several &= settled & hot & (hotter.max(-1) > 1.01 * lowest.max(-1))
    return start, below.any(0) | steady, several


def _heights(top: Any, highest: float) -> Any:
    """Heights of a profile to try, from nothing to the highest: (steps, points)."""
    low, middle = 0.02 * top, np.minimum(5 * top + 5.0, highest)
    steps = [np.minimum(low, 0.5 * highest)]
    high = highest * np.ones_like(middle)
    for start, end, n in ((low, middle, 24), (middle, high, 12)):
        start = np.minimum(start, 0.5 * highest)
        ratio = np.maximum(end, 1.01 * start) / start
        steps += [start * ratio ** (i / n) for i in range(1, n + 1)]
    return np.stack(steps)


def _powers(
    problem: Problem,
    model: Any,
    conduct: Conduction,
    rise: Any,
    highest: float,
    table: Any,
) -> Any:
    """Power of friction per nominal area at rises (points, stations)."""
    local = problem.local._replace(
        warmed=Warmed(conduct.ends, rise, highest, problem.temperature, problem.body)
    )
    power = []
    for i in range(0, rise.shape[0], _BATCH):
        batch = slice(i, i + _BATCH)
        points = problem.of(batch)
        waves = model.waves(
            problem.body.complex_modulus,
            conduct.wave_nodes,
            points.reduced,
            points.reduced_pressure,
            table,
            local.of(batch),
        )
        mu = waves.each.sum((-2, -1)) + waves.edges
        if problem.adhesion is not None:
            stress = problem.adhesion.shear_stress(
                points.velocity, points.temperature + rise[batch, -1]
            )
            mu = mu + stress * waves.area / points.pressure
        power.append(mu * points.pressure * points.velocity)
    return np.concatenate(power)


def _crossing(tried: Any, made: Any, first: Any) -> Any:
    """The height that friction makes itself, by a straight line over the step before
    the `first` at which it makes less than was tried.
    """
    every = np.arange(first.size)
    before = np.maximum(first - 1, 0)
    x_0, x_1 = tried[before, every], tried[first, every]
    y_0, y_1 = made[before, every], made[first, every]
    slope = (y_1 - y_0) / np.where(x_1 > x_0, x_1 - x_0, 1.0)
    root = np.clip((y_0 - slope * x_0) / np.where(slope < 1, 1 - slope, 1.0), x_0, x_1)
    return np.where(first == 0, np.minimum(made[0], tried[0]), root)


def _settle(
    of: Callable[[Any], State], rise: Any, highest: float, within: float = _SETTLED
) -> tuple[Any, Any]:
    """Fixed point of temperatures, and where it was found: Anderson's method with one
    step of memory.
    """
    before, off_before = np.zeros_like(rise), np.zeros_like(rise)
    good = np.zeros(rise.shape[0], dtype=bool)
    for count in range(_ROUNDS):
        off = of(rise).rise - rise
        size = np.maximum(np.abs(rise).max(-1), 1e4 * _NOTHING)
        good = np.abs(off).max(-1) <= within * size
        turn, move = off - off_before, rise - before
        share = (turn * off).sum(-1) / np.maximum((turn**2).sum(-1), 1e-300)
        share = np.clip(share, -20.0, 20.0)[:, None]
        new = rise + off - share * (move + turn) if count else rise + 0.5 * off
        new = np.clip(np.where(np.isfinite(new), new, 0.0), 0.0, highest)
        steady = good[:, None]
        before, off_before = (
            np.where(steady, before, rise),
            np.where(steady, off_before, off),
        )
        rise = np.where(steady, rise, new)
        if good.all():
            break
    return rise, good & (rise.max(-1) < highest)


def _i0e(x: Any) -> Any:
    if namespace(x) is np:
        from scipy.special import i0e
    else:
        from jax.scipy.special import i0e
    return i0e(x)


def _k0e(x: Any) -> Any:
    """exp(x) K0(x)."""
    if namespace(x) is np:
        from scipy.special import k0e

        return k0e(x)
    return _k0e_of_jax(x)


def _k0e_of_jax(x: Any) -> Any:
    """By polynomials, to 2e-7: Abramowitz & Stegun 9.8.5 and 9.8.6."""
    import jax.numpy as jnp
    from jax.scipy.special import i0e

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
        -jnp.log(small / 2) * i0e(small) * jnp.exp(small)
        + jnp.polyval(jnp.array(low[::-1]), near)
    )
    return jnp.where(
        x < 2, first, jnp.polyval(jnp.array(high[::-1]), far) / jnp.sqrt(large)
    )
