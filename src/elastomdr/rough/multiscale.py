"""Friction of a rough surface under a pressure by Persson's theory and by `Multiscale`,
at many points at once.

Multiscale weighs the friction that each wave has in full contact, and adds that of
contact edges:

    mu = (1/2p) int q^3 C W drag dq + e A (1 - A) r^l mu_edge,
    W = K A + (1 - K A) u P_s^m,    u = (P_s - A)/(1 - A),    K = 1 - (1 - k)(1 - A) D^n.

A = P(q_high) is the real area of contact by Persson's theory, P_s = P(q e^s) the share
of contact seen somewhat further on (A beyond q_high), D = dlog R/dlog q at q_high with
R the integral of G without S, r the mean square modulus at q_high over that of all
waves, each by its slope, and mu_edge the friction of waves beyond q_high whose
pressures go on from those of full contact at q_high as q^-2 in each octave. In three
dimensions W = |p_k|^2 over its value in full contact does follow P_s where contact is
nearly full, and levels out below A towards q_high; waves beyond it have up to 40 % of
the friction in light contact. Exact in full contact; for small loss mu is linear in the
loss, and for p -> 0 it does not depend on p.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fixed, namespace, xp
from ..checks import is_traced, known
from ..material.tabulated import LEFT_OUT
from ..models import SurfaceFriction
from ..numerics.implicit import as_doubles, numbers_with_slopes
from ..numerics.interpolation import hermite
from ..numerics.quadrature import gauss
from .local_modulus import Local, Softened, Warmed
from .psd_integrals import (
    PER_DECADE,
    Nodes,
    cell_counts,
    direct,
    factor,
    nodes,
    read,
    share,
    spread_of,
    tables,
    until,
)

_BATCH = 64  # points that are held in memory at once
_FINEST = 32 * PER_DECADE
_TRACED = 24  # cells per decade where JAX traces a value
_BEYOND = 30.0  # how far beyond q_high the waves of contact edges are followed
_LINEAR = Local()
_GAMMA = 0.5  # of the contact shares of Multiscale, stored


class Form(NamedTuple):
    """The constants of Multiscale, by their letters above."""

    shift: float  # s
    level: float  # k
    slope: float  # n
    power: float  # m
    edge: float  # e
    rise: float  # l


# Fitted to three-dimensional maps by benchmarks/rough_fit.py, which says how far the
# form is from them.
FORM = Form(
    shift=0.5591, level=0.5342, slope=0.6075, power=0.3736, edge=0.5577, rise=0.7962
)


class Found(NamedTuple):
    """Answers at each point."""

    mu: Any
    area: Any  # real contact area over nominal area
    error: Any  # numerical error of mu
    area_error: Any


class Parts(NamedTuple):
    """What Multiscale weighs, at each point; with no constants in it. Shapes (points,
    cells, 2) or (points,).
    """

    at: Nodes
    full: Any  # friction of each node in full contact
    rate: Any  # dR/dlog q
    until: Any  # R
    total: Any  # R at q_high
    end: Any  # dR/dlog q at q_high
    rise: Any  # r
    edges: Any  # mu_edge
    area: Any  # A


def solve(
    modulus: Any,
    spectrum: Any,
    velocity: Any,
    pressure: Any,
    model: Any,
    rtol: float,
    local: Local = _LINEAR,
) -> Found:
    """Points (velocity [m/s], pressure [Pa]), flat; `modulus(omega)` is E* [Pa] at
    omega [rad/s].

    `local` says how moduli differ from scale to scale, by strain and temperature.

    Cells of log q are halved until the change by the last halving is below `rtol`, or
    no more memory should be spent.
    """

    def evaluated(points: Any, per_decade: int) -> Any:
        return _in_batches(
            modulus,
            spectrum,
            velocity[points],
            pressure[points],
            model,
            per_decade,
            local.of(points),
        )

    mu, area, error, area_error = (np.full(velocity.shape, np.nan) for _ in range(4))
    left, per_decade = np.arange(velocity.size), PER_DECADE
    coarsest, coarse = (evaluated(left, per_decade // part) for part in (4, 2))
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
    return Found(mu, area, error, area_error)


def _error(fine: Any, coarse: Any, coarsest: Any) -> Any:
    """Half the last change, or an eighth of that before if more: of second order, as
    where a table's cubics meet.
    """
    return np.maximum(abs(fine - coarse) / 2, abs(coarse - coarsest) / 8)


def _in_batches(
    modulus: Any,
    spectrum: Any,
    velocity: Any,
    pressure: Any,
    model: Any,
    per_decade: int,
    local: Local,
) -> Any:
    at = nodes(spectrum, per_decade, bends(spectrum, model, local))
    step = np.log(10.0) / per_decade
    table = _table(modulus, at, velocity, step, local)
    batches = [slice(i, i + _BATCH) for i in range(0, velocity.size, _BATCH)]
    out = [
        _evaluate(
            modulus,
            at,
            velocity[some],
            pressure[some],
            model,
            table,
            local.of(some),
        )
        for some in batches
    ]
    return tuple(np.concatenate(part) for part in zip(*out, strict=True))


def bends(spectrum: Any, model: Any, local: Local) -> tuple[float, ...]:
    """Wave numbers at which an integrand may bend: where P_s becomes A, and where
    factors of the moduli do.
    """
    return (*model.bends(spectrum), *local.bends())


def _table(
    modulus: Any, at: Nodes, velocity: Any, step: float, local: Local
) -> tuple[Any, float]:
    low = velocity.min() * at.q.min() * local.slowest()
    return tables(
        modulus, low, velocity.max() * at.end * _BEYOND, step, local.parted
    ), step


def _evaluate(
    modulus: Any,
    at: Nodes,
    velocity: Any,
    pressure: Any,
    model: Any,
    table: Any,
    local: Local,
) -> tuple[Any, Any]:
    """mu and area of real contact at each point."""
    found = model.waves(modulus, at, velocity, pressure, table, local)
    return found.each.sum((-2, -1)) + found.edges, found.area


class Waves(NamedTuple):
    """Where on the scale of lengths a surface is in contact and loses energy."""

    each: Any  # friction of each node (points, cells, 2)
    edges: Any  # friction of the waves beyond q_high (points,)
    rate: Any  # dR/dlog q, of which the shares of contact are made
    area: Any  # of real contact


def waves_of_multiscale(
    modulus: Any, at: Nodes, velocity: Any, pressure: Any, table: Any, local: Local
) -> Waves:
    """Friction wave by wave, at points (velocity [m/s], pressure [Pa]), flat."""
    found = parts(modulus, at, velocity, pressure, table, local)
    return Waves(*_weighed(found, FORM), found.rate, found.area)


def bend(spectrum: Any) -> float:
    """The wave number q_high e^-s [rad/m], from which on P_s is held."""
    return float(spectrum.q_high) * np.exp(-FORM.shift)


def contact(rate: Any, gamma: float, stored: bool) -> Any:
    """The share of contact from R."""
    return share(spread_of(rate, gamma, stored))


def _averages(
    modulus: Any, velocity: Any, q: Any, table: Any, local: Local = _LINEAR
) -> tuple[Any, Any]:
    """`drag` and `stiffness` at q v, read from the tables of the material or, without
    them, by the angle.
    """
    w = velocity[:, None, None] * q
    speed, storage, loss = local.at(q)
    if speed is not None:
        w = w * speed
    if table is None:
        drag, stiffness, lost = direct(modulus, w, local.parted)
    else:
        own, step = table
        log_w = namespace(w).log(w)
        drag, stiffness = (
            read(own, own.drag, log_w, step),
            read(own, own.stiffness, log_w, step),
        )
        lost = read(own, own.lost, log_w, step) if local.parted else None
    if lost is None:
        return drag, stiffness
    return loss * drag, stiffness * (storage**2 + (loss**2 - storage**2) * lost)


def rate_of(at: Nodes, stiffness: Any, pressure: Any) -> Any:
    """dR/dlog q = q^4 C stiffness/(8 p^2), R the integral of G without S."""
    return at.power * stiffness / (8 * pressure**2)


def stress_variance(
    modulus: Any, spectrum: Any, velocity: Any, pressure: Any, per_decade: int
) -> Any:
    """R of all waves, at points (velocity [m/s], pressure [Pa]), flat."""
    at = nodes(spectrum, per_decade)
    table = _table(modulus, at, velocity, np.log(10.0) / per_decade, _LINEAR)
    _, stiffness = _averages(modulus, velocity, at.q, table)
    rate = rate_of(at, stiffness, pressure[:, None, None])
    return (rate * at.weight).sum((-2, -1))


def waves_of_persson(
    modulus: Any,
    at: Nodes,
    velocity: Any,
    pressure: Any,
    energy_factor: tuple[float, bool],
    table: Any,
    local: Local,
) -> Waves:
    """Friction wave by wave, by Persson's theory; none of contact edges."""
    p = pressure[:, None, None]
    drag, stiffness = _averages(modulus, velocity, at.q, table, local)
    rate = rate_of(at, stiffness, p)
    shares = contact(until(rate, at.weight), *energy_factor)
    full = at.weight * at.power * drag / (2 * p)
    area = contact((rate * at.weight).sum((-2, -1)), *energy_factor)
    gamma, _ = energy_factor
    return Waves(full * factor(shares, gamma) * shares, 0.0 * area, rate, area)


def parts(
    modulus: Any,
    at: Nodes,
    velocity: Any,
    pressure: Any,
    table: Any = None,
    local: Local = _LINEAR,
) -> Parts:
    """What Multiscale weighs, at points (velocity [m/s], pressure [Pa]), flat."""
    p = pressure[:, None, None]
    drag, stiffness = _averages(modulus, velocity, at.q, table, local)
    rate = rate_of(at, stiffness, p)
    total = (rate * at.weight).sum((-2, -1))
    end = (
        at.end_power
        * _averages(modulus, velocity, at.end, table, local)[1]
        / (8 * p**2)
    )[..., 0, 0]
    points, weights = gauss(12)
    x = 0.5 * np.log(_BEYOND) * (points + 1)
    drag_beyond, stiffness_beyond = (
        a[..., 0]
        for a in _averages(modulus, velocity, at.end * np.exp(x)[:, None], table, local)
    )
    beyond = (
        4 * p[..., 0] * end[:, None] * drag_beyond / stiffness_beyond * np.exp(-2 * x)
    )
    return Parts(
        at=at,
        full=at.weight * at.power * drag / (2 * p),
        rate=rate,
        until=until(rate, at.weight),
        total=total,
        end=end,
        rise=end / total * ((at.power * at.weight).sum() / at.end_power),
        edges=(beyond * (0.5 * np.log(_BEYOND) * weights)).sum(-1),
        area=share(spread_of(total, _GAMMA, True)),
    )


def weighed(found: Parts, form: Form = FORM) -> Any:
    """mu of Multiscale."""
    each, edges = _weighed(found, form)
    return each.sum((-2, -1)) + edges


def _weighed(found: Parts, form: Form) -> tuple[Any, Any]:
    """Friction of each node, and that of contact edges."""
    xp = namespace(found.full, found.area)
    area = found.area[:, None, None]
    steep = found.end / found.total
    shares = xp.maximum(_later(found, form.shift), area)
    level = 1 - (1 - form.level) * (1 - area) * steep[:, None, None] ** form.slope
    rest = (shares - area) / xp.maximum(1 - area, 1e-12)
    weight = level * area + (1 - level * area) * rest * shares**form.power
    edges = (
        form.edge * found.area * (1 - found.area) * found.rise**form.rise * found.edges
    )
    return found.full * weight, edges


def _later(found: Parts, shift: float) -> Any:
    """P at the wave numbers q e^shift, held beyond q_high: log R by cubics with its
    slopes.
    """
    xp, at = namespace(found.rate, found.at.q), found.at
    flat = (found.rate.shape[0], -1)
    log_q = xp.concatenate([xp.log(at.q).reshape(-1), xp.log(at.end).reshape(1)])
    r = xp.concatenate([found.until.reshape(flat), found.total[:, None]], -1)
    slope = xp.concatenate([found.rate.reshape(flat), found.end[:, None]], -1) / r
    log_r = xp.log(r)
    x = xp.minimum(log_q[:-1] + shift, log_q[-1])
    later = hermite(log_q, log_r, slope, x)
    return share(spread_of(xp.exp(later), _GAMMA, True)).reshape(found.rate.shape)


WORK = (
    f"integrals over {PER_DECADE} cells per decade of q, or more until rtol is met",
    "no lines, no maps, no random numbers; integrals over the angle are tabulated once "
    "for all points",
)


def friction(
    model: Any,
    foundation: Any,
    surface: Any,
    velocity: Any,
    pressure: Any,
    local: Local,
    rtol: float,
    progress: Callable[[int, int], None] | None,
) -> SurfaceFriction:
    """`solve` with the error of a table of moduli, and which points met `rtol`."""
    if is_traced(foundation, surface, velocity, pressure, local):
        shared, points = _taken_apart(foundation, surface, velocity, pressure, local)
        counts = cell_counts(known(fixed(surface)), _TRACED)
        found = _with_slopes(model, float(rtol), counts)(shared, points)
        return found._replace(good=found.good > 0)
    modulus = foundation.complex_modulus
    found = solve(modulus, surface, velocity, pressure, model, rtol, local=local)
    if progress is not None:
        progress(velocity.size, velocity.size)
    good = (found.error <= rtol * abs(found.mu)) | (found.mu == 0)
    change = table_error(
        model,
        foundation,
        surface,
        velocity,
        pressure,
        local,
        max(rtol, 1e-3),
        found.mu,
    )
    return SurfaceFriction(
        found.mu, found.area, found.error + change, good, found.area_error
    )


def _taken_apart(
    foundation: Any, surface: Any, velocity: Any, pressure: Any, local: Local
) -> tuple[Any, Any]:
    """What all points share, and what each has of its own, for `_with_slopes`."""
    share = None if local.softened is None else local.softened.share
    if local.warmed is None:
        return as_doubles(((foundation, surface, share, None), (velocity, pressure)))
    warmed = local.warmed
    shared = foundation, surface, share, (warmed.ends, warmed.highest)
    return as_doubles(
        (shared, (velocity, pressure, warmed.kelvin, xp.transpose(warmed.rise)))
    )


def _put_together(shared: Any, points: Any) -> tuple[Any, Any, Local]:
    foundation, surface, share, range_of_scales = shared
    softened = warmed = None
    if share is not None:
        softened = Softened(foundation.softening, surface, share)
    if range_of_scales is not None:
        (ends, highest), (_, _, kelvin, rise) = range_of_scales, points
        warmed = Warmed(ends, rise.T, highest, kelvin, foundation)
    return foundation, surface, Local(softened, warmed)


@functools.lru_cache(64)
def _with_slopes(
    model: Any, rtol: float, counts: tuple[int, ...]
) -> Callable[..., SurfaceFriction]:
    """`friction` under a transformation of JAX, of what `_taken_apart` gives: numbers
    from NumPy, derivatives of the same integrals on `counts` cells.
    """

    def numbers(shared: Any, points: Any) -> tuple[Any, ...]:
        foundation, surface, local = _put_together(shared, points)
        velocity, pressure = points[:2]
        found = friction(
            model, foundation, surface, velocity, pressure, local, rtol, None
        )
        return found.mu, found.area, found.error, found.good, found.area_error

    def integrals(shared: Any, points: Any) -> tuple[Any, Any]:
        foundation, surface, local = _put_together(shared, points)
        velocity, pressure = points[:2]
        at = nodes(surface, _TRACED, counts=counts)
        modulus = foundation.complex_modulus
        return _evaluate(modulus, at, velocity, pressure, model, None, local)

    def like(shared: Any, points: Any) -> tuple[Any, ...]:
        return (points[0],) * 5

    solve = numbers_with_slopes(numbers, ((integrals, 2),), like)
    return lambda shared, points: SurfaceFriction(*solve(shared, points))


def table_error(
    model: Any,
    foundation: Any,
    surface: Any,
    velocity: Any,
    pressure: Any,
    local: Local,
    rtol: float,
    mu: Any,
) -> Any:
    """Error of mu by the interpolation of a table of moduli, from the friction of its
    halves; 0 for a series.
    """
    if not hasattr(foundation, "thinned") or is_traced(foundation):
        return 0.0
    change = np.zeros_like(mu)
    for half in foundation.thinned():
        other = solve(
            half.complex_modulus, surface, velocity, pressure, model, rtol, local=local
        )
        change = np.maximum(change, LEFT_OUT * np.abs(other.mu - mu))
    return change


# |ln(mu/mu_3D)| <= a + b (-ln A) for 95 % of the map's points, each predicted without
# its surface or its material.
_BOUND = {"multiscale": (0.02, 0.04), "persson": (0.098, 0.149)}
_AREA_BOUND = (0.03, 0.07)  # of the real contact area, alike: benchmarks/rough_fit.py
# of the map: cutoff ratios, largest contrast, least contact
_RATIOS, _CONTRAST, _AREA = (8.0, 256.0), 1000.0, 0.004


def bound_terms(label: str, of_area: bool) -> tuple[float, float]:
    """a and b of `bound`, of mu by a model's label or of the area."""
    return _AREA_BOUND if of_area else _BOUND[label]


def contrast(foundation: Any, surface: Any, velocity: Any) -> Any:
    """|E*| at q_high v over that at q_low v."""
    high, low = (
        abs(foundation.complex_modulus(q * velocity))
        for q in (surface.q_high, surface.q_low)
    )
    return high / low


def bound(
    model: Any, area: Any, ratio: Any, contrast: Any, of_area: bool = False
) -> Any:
    """Bound on mu's relative distance from three dimensions, for 95 % of the points of
    the map, or `of_area` on A's.

    Outside the map it is wider by a factor: 1 + log10 of how many times the cutoff
    ratio, the contrast of the moduli and the real contact area lie beyond its range,
    all three added. NaN where it is not known for the options of the model.
    """
    xp = namespace(area, ratio, contrast)
    terms = model.bound_terms(of_area)
    if terms is None:
        return area + np.nan
    a, b = terms
    beyond = sum(
        xp.log10(xp.maximum(x, 1.0))
        for x in (
            ratio / _RATIOS[1],
            _RATIOS[0] / ratio,
            contrast / _CONTRAST,
            _AREA / xp.maximum(area, 1e-300),
        )
    )
    return xp.expm1((a - b * xp.log(xp.maximum(area, 1e-300))) * (1 + beyond))
