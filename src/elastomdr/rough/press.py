"""A rough surface pressed into rubber: approach, stiffness and conductance, at rest and
in sliding.

At rest a rigid rough line is pressed into independent elements. Let g be how far each
place of a line of heights h lies below its highest one. At the depth d a share s(d) has
g < d, and the elements carry the mean N(d) = <max(d - g, 0)> times the modulus, so
that N' = s. Between its points the line is taken as straight: s is then a straight line
and N a parabola between one sorted end of a piece and the next, and the depth for a
load follows in closed form, with its derivatives.

The mean displacement of the surface belongs to the bulk, not to the interface. Less of
it, the mean gap and the stiffness against it are

    gap = <g> - d + N,    d(load)/d(-gap) = s/(1 - s),

which goes to infinity in full contact, as that of a half-space does.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..arrays import Array, on_jax, xp
from ..call.extrapolation import (
    excited_outside,
    modulus_at,
    pressed_too_hard,
    rough_beyond,
)
from ..call.model_choice import is_rough, of_line
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast_shape,
    is_traced,
    nan_unless,
    numpy_unless_traced,
    positive,
    positive_arrays,
    require,
    scalar,
    warn_unless,
    whole_number,
)
from ..element.law import Foundation, as_foundation
from ..errors import InputError
from ..material.validity import material_in_words
from ..models import Line, seeds_of
from ..results.doubts import Doubt
from ..results.words import brief, surface_in_words
from ..surface.lay import lay_of
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum
from ..surface.topography import skewness_of
from .problem import Resting, not_rough, resting_body
from .results import RoughContact

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Material, ModelLike, SteadyBody, Surface

# least rise of a piece over that of the line: a horizontal one would be a jump of s
_FLAT = 1e-6
_USUAL = Line(seeds=8, periods=16)
_FINE = 16  # samples of the shortest wave, where none are given
# bound against 3D, where p J/rms slope and q_high/q_low lie in the range
_OFF, _LEVELS, _RATIO = 0.35, (0.01, 0.2), 64
_NOT_GAUSSIAN = (
    "have no bound on the model: heights are not Gaussian, as those of its lines are"
)
_FEWEST = 3  # samples that touch in sliding, below which there is no stiffness
_STEP = 0.02  # relative change of load, up and down, for the stiffness in sliding


@over_materials
@numpy_unless_traced
def press(
    material: Material,
    surface: Surface,
    *,
    pressure: ArrayLike,
    time: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    conductivity: ArrayLike | None = None,
    resistivity: ArrayLike | None = None,
    model: Line | Literal["line"] | None = None,
) -> RoughContact:
    """Approach, incremental stiffness and conductance of a rough surface pressed into
    rubber.

    Args:
        material: as for `em.friction`; a table of moduli at rest, long after.
        surface: a rigid surface by its spectrum, or an `em.RoughLine` with
            `model=em.Line(equivalent_length=...)`.
        pressure: nominal pressure [Pa].
        time: how long it has acted since it was put on at once [s]; None for long
            after.
        velocity: velocity of steady sliding [m/s], in place of a time.
        temperature: temperature [K], for a material with a shift law. All of these
            broadcast.
        conductivity: thermal conductivities of rubber and counterface [W/(m K)], or one
            where the other's is without limit: gives `thermal`.
        resistivity: electrical resistivities of both [Ohm m], or one where the other's
            is zero: gives `electrical`.
        model: `em.Line(...)`; by default eight lines of 16 longest waves. Its
            `equivalent_length` is by default that with which the line in full contact
            stores the energy of the surface, 2 m_1/m_2 of the spectrum's moments.

    Returns:
        An `em.RoughContact`. `error` is twice the standard error over the lines, NaN
        for a single one. In full contact the gap is closed, and stiffness and
        conductance are infinite. `model_error` is NaN outside the range of loads and
        cutoffs in which lines were compared with three dimensions, on measured surfaces, and of a
        material with a softening. Of this the contact on a surface by its spectrum has
        the level of E* with which its area is that of `em.leak` and `em.break_out`,
        where each length scale has its own; on a line it is left out.

    Raises:
        InputError: for arguments out of range, and in sliding where JAX traces them.

    Exact for the line: at rest, since under a constant pressure the contact grows, and
    depth and pressure are related as in an elastic contact with 1/J(t). Differentiable
    at rest with respect to material, surface, pressure, time and temperature. Source:
    Popov & Hess 2015, ch. 10; Barber, Proc. R. Soc. A 459 (2003) 53; `docs/theory.md`.
    """
    foundation, model = _check(material, surface, model, time, velocity)
    points = _points(foundation, surface, pressure, time, velocity, temperature)
    traced = is_traced(foundation, surface, pressure, time, velocity, temperature)
    if traced and velocity is not None:
        raise InputError(
            argument="velocity",
            accepted="left out of em.press under jax.jit, grad and vmap",
            hint="only rest is computed there",
        )
    length, rule = _length(surface, model)
    lines = _lines(surface, model)
    solved = (
        _at_rest(points, lines, length)
        if velocity is None
        else _sliding(points, lines, length, as_foundation(foundation))
    )
    contact = _report(points, surface, model, lines, solved, traced)
    warn_unless(solved.good, "points")
    inputs = [
        *material_in_words(foundation),
        ("surface", surface_in_words(surface)),
        ("pressure", brief(pressure, "Pa")),
        *([] if time is None else [("time", brief(time, "s"))]),
        *([] if velocity is None else [("velocity", brief(velocity, "m/s"))]),
        *([] if temperature is None else [("temperature", brief(temperature, "K"))]),
        ("ensemble", _ensemble(surface, lines, model)),
    ]
    good, conductance = solved.good, solved.conductance
    return dataclasses.replace(
        contact,
        thermal=_times(good, conductance, conductivity, "conductivity", False),
        electrical=_times(good, conductance, resistivity, "resistivity", True),
        marks=_judge(points),
        model="MDR line of the interface" + rule,
        inputs=tuple(inputs),
    )


def _check(
    material: Material,
    surface: Surface,
    model: ModelLike | None,
    time: ArrayLike | None,
    velocity: ArrayLike | None,
) -> tuple[SteadyBody, Line]:
    """The half-space and the model. Raises `InputError`."""
    if not is_rough(surface):
        raise not_rough(surface)
    foundation = resting_body(material, time, velocity)
    chosen = of_line(_USUAL if model is None else model, "press")
    if chosen.average:
        raise InputError(
            argument="model",
            got=model,
            accepted="em.Line() without average in em.press",
            hint="directions have no approach of their own",
        )
    if time is not None and velocity is not None:
        raise InputError(
            argument="time",
            got=time,
            accepted="left out with velocity",
            hint="in sliding the contact is that of the steady state",
        )
    return foundation, chosen


def _report(
    points: _Points,
    surface: Surface,
    model: Line,
    lines: list[RoughLine],
    solved: _PressedContact,
    traced: bool,
) -> RoughContact:
    """The numbers of the result."""

    def field(values: Array) -> Any:
        return nan_unless(solved.good, values)

    at_rest = points.velocity is None
    unknown = xp.full(points.shape, np.nan)
    compared = (
        not traced
        and isinstance(surface, AbstractSpectrum)
        and model.equivalent_length is None
    )
    return RoughContact(
        pressure=points.pressure,
        time=points.rest.time,
        velocity=points.velocity,
        temperature=points.rest.temperature,
        approach=field(solved.approach),
        separation=field(solved.gap),
        stiffness=field(solved.stiffness),
        conductance=field(solved.conductance),
        conductance_low=_least(points, surface, lines[0]) if at_rest else unknown,
        error=field(solved.error),
        approach_error=field(solved.approach_error),
        model_error=_model_error(surface, points) if compared else unknown,
        converged=solved.good,
        model="",
        plan="closed form of the sorted heights of each line"
        if at_rest
        else "periodic states of each line",
        inputs=(),
    )


def _ensemble(surface: Surface, lines: list[RoughLine], model: Line) -> str:
    sentence = f"{len(lines)} line{'s' * (len(lines) > 1)} of {lines[0].count} samples"
    return (
        sentence
        if isinstance(surface, RoughLine)
        else f"{sentence}, {model.periods} longest waves each"
    )


class _Points(NamedTuple):
    """The points of a call, of one shape."""

    shape: tuple[int, ...]
    pressure: Array
    velocity: Array | None
    rest: Resting  # long after, in sliding


class _PressedContact(NamedTuple):
    """Means over the lines."""

    approach: Array
    gap: Array
    stiffness: Array
    conductance: Array
    error: Array
    approach_error: Array
    good: Array


def _points(
    foundation: SteadyBody,
    surface: Surface,
    pressure: ArrayLike,
    time: ArrayLike | None,
    velocity: ArrayLike | None,
    temperature: ArrayLike | None,
) -> _Points:
    arrays = positive_arrays(
        {
            "pressure": pressure,
            "time": time,
            "velocity": velocity,
            "temperature": temperature,
        }
    )
    shape = broadcast_shape(arrays)
    full = {name: xp.broadcast_to(value, shape) + 0.0 for name, value in arrays.items()}
    times, temperatures = full.get("time"), full.get("temperature")
    rest = Resting.of(foundation, surface, times, temperatures)
    return _Points(shape, full["pressure"], full.get("velocity"), rest)


def _length(surface: Surface, model: Line) -> tuple[Any, str]:
    """The length that turns the pressure into a line load, and the rule in words."""
    length = model.equivalent_length
    if length is None and isinstance(surface, AbstractSpectrum):
        length = 2 * surface.moment(1) / surface.moment(2)
        number = "" if is_traced(length) else f" = {float(length):.4g} m"
        return length, (
            f"; pressure p as line load p L with L = 2 m_1/m_2{number}, of equal energy "
            "in full contact"
        )
    if length is None or isinstance(length, str):
        raise InputError(
            argument="equivalent_length",
            got=length,
            accepted="given to em.Line with a RoughLine in em.press, a length [m]",
        )
    length = scalar("equivalent_length", length)
    positive("equivalent_length", length)
    return (
        length,
        f"; pressure p as line load p L with L = {float(length):.4g} m as given",
    )


def _lines(surface: Surface, model: Line) -> list[RoughLine]:
    from ..surface.spectrum import MOST, synthesise
    from .ensemble import ensemble

    whole_number("periods", model.periods, 1, MOST)
    seeds, samples = seeds_of(model.seeds), model.samples
    if isinstance(surface, RoughLine):
        return ensemble(surface, samples, 4, (0,))
    return [synthesise(surface, seed, model.periods, samples, _FINE) for seed in seeds]


def _at_rest(points: _Points, lines: list[RoughLine], length: Array) -> _PressedContact:
    soft = points.rest.soft / points.rest.level()
    load, rows = points.pressure * soft * length, []
    for line in lines:
        differ = "rough, with heights that differ"
        require("surface", line.height, differ, lambda heights: np.ptp(heights) > 0)
        on = bearing(line.height)
        _, gap, share = pressed(on, load)
        conductance = _conductance(share, length)
        stiffness = 0.5 * conductance / soft
        touches = share * line.height.size >= 1
        rows.append((on.mean - gap, gap, conductance, stiffness, touches))
    return _mean(rows, points)


def _conductance(share: Array, length: Array | float) -> Any:
    """Over the conductivity [1/m], from the share of the line in contact: of each
    element twice its width.
    """
    not_full = share < 1
    return xp.where(
        not_full, 2 / length * share / xp.where(not_full, 1 - share, 1.0), xp.inf
    )


def _sliding(
    points: _Points,
    lines: list[RoughLine],
    length: float,
    foundation: Foundation,
) -> _PressedContact:
    from .periodic import Job, solve_lines

    assert points.velocity is not None
    factor, vertical = points.rest.factor, points.rest.vertical * points.rest.level()
    reduced = (points.velocity * factor).ravel()
    load = (points.pressure / vertical * length).ravel()
    loads = np.concatenate([load, load * (1 - _STEP), load * (1 + _STEP)])
    jobs = [
        Job(
            np.asarray(line.height),
            float(line.spacing),
            np.tile(reduced, 3),
            loads,
            "load",
        )
        for line in lines
    ]
    relaxed = float(foundation.equilibrium)
    solutions, rows = on_jax(solve_lines, jobs, foundation.law()), []
    for line, solution in zip(lines, solutions, strict=True):
        height = np.asarray(line.height)
        # In full contact the difference of depth and load, both large, is rounding.
        closed = height.max() - height.mean()
        middle, less, more = np.where(
            solution.share == 1, closed, solution.depth - solution.load / relaxed
        ).reshape(3, -1)
        share = solution.share[: load.size]
        _, before, after = solution.load.reshape(3, -1) / length
        stiffness = (after - before) / (more - less) * np.ravel(vertical)
        touches = share * height.size >= _FEWEST
        conductance = _conductance(share, length)
        rows.append((middle, closed - middle, conductance, stiffness, touches))
    return _mean(rows, points)


def _mean(rows: list[tuple[Array, ...]], points: _Points) -> _PressedContact:
    """Of each line approach, gap, conductance, stiffness, and whether it touches in
    enough samples.
    """
    approach, gap, conductance, stiffness, touching = (
        xp.reshape(xp.stack(each), (-1, *points.shape))
        for each in zip(*rows, strict=True)
    )
    mean, count = xp.mean(conductance, axis=0), len(rows)
    if count > 1:
        with np.errstate(invalid="ignore"):
            error, far = (
                2 * xp.std(each, axis=0, ddof=1) / count**0.5
                for each in (conductance, approach)
            )
            error = error / mean
    else:
        error, far = xp.full(points.shape, np.nan), xp.full(points.shape, np.nan)
    good = xp.isfinite(xp.mean(approach, axis=0)) & xp.all(touching, axis=0)
    return _PressedContact(
        xp.mean(approach, axis=0),
        xp.mean(gap, axis=0),
        xp.mean(stiffness, axis=0),
        mean,
        error,
        far,
        good,
    )


def _least(points: _Points, surface: Surface, line: RoughLine) -> Any:
    """Bound of the conductance over the conductivity; of a surface, a square as wide as
    a line is long.
    """
    load = points.pressure * points.rest.soft
    if points.rest.softened() is not None:  # it is one of linear rubber
        return xp.full(points.shape, np.nan)
    if isinstance(surface, RoughLine):
        return least_conductance(load, xp.max(line.height) - xp.mean(line.height))
    spread, slope = (
        (2 * np.pi * surface.moment(1)) ** 0.5,
        (np.pi * surface.moment(3)) ** 0.5,
    )
    return least_conductance(load, spread * highest(spread, slope, line.period**2))


def _times(
    good: Array,
    conductance: Array,
    values: ArrayLike | None,
    name: str,
    inverse: bool,
) -> Any:
    """The conductance with conductivities, or resistivities (`inverse`), of one body or
    two; None without them.
    """
    if values is None:
        return None
    each = as_float64(name, values)
    if each.shape not in ((), (1,), (2,)):
        raise InputError(
            argument=name,
            got=values,
            accepted="a number or a pair, of rubber and counterface",
        )
    positive(name, each)
    return nan_unless(good, conductance / xp.sum(each if inverse else 1 / each))


def _judge(points: _Points) -> tuple[Doubt, ...]:
    """Points beyond the data of the material, and pressures above its modulus: at rest
    those of the time, in sliding by frequency of excitation, and at the longest waves;
    and what is doubtful of a softening.
    """
    rest, shape = points.rest, points.shape
    foundation, surface = rest.foundation, rest.surface
    if points.velocity is None:
        unknown = np.full(shape, skewness_of(surface) > 0)
        bound = Doubt("no prediction", unknown, _NOT_GAUSSIAN)
        return (*rest.doubts(points.pressure, shape, softens=True), bound)
    reduced = points.velocity * rest.factor
    outside = excited_outside(foundation.range, surface, reduced)
    beyond = rough_beyond(foundation.range, outside, rest.temperature, shape)
    line = isinstance(surface, RoughLine)
    longest = 2 * np.pi / surface.period if line else surface.q_low
    modulus = modulus_at(foundation, longest, reduced, rest.vertical)
    hard = pressed_too_hard(points.pressure, modulus)
    return (*beyond, *hard, *rest.of_softening(shape, softens=True))


def _model_error(surface: Surface, points: _Points) -> Any:
    """Relative, of the conductance at rest: in the range of `benchmarks/rough_press.py`
    0.28 at most, NaN elsewhere, and on surfaces that are not Gaussian or have a lay.
    """
    assert isinstance(surface, AbstractSpectrum)  # lines are not compared
    relative_pressure = np.asarray(
        points.pressure * points.rest.soft / surface.rms_slope
    )
    inside = (relative_pressure >= _LEVELS[0] * (1 - 1e-9)) & (
        relative_pressure <= _LEVELS[1] * (1 + 1e-9)
    )
    inside &= points.velocity is None and surface.q_high <= _RATIO * surface.q_low * (
        1 + 1e-9
    )
    inside &= points.rest.foundation.softening is None
    inside &= not skewness_of(surface) and lay_of(surface) is None
    return np.where(inside, _OFF, np.nan)


class Bearing(NamedTuple):
    """The share and the mean load of a line over its depth, at the sorted ends of its
    pieces.
    """

    depth: Array  # [m]
    share: Array
    load: Array  # N [m]
    rate: Array  # ds/dd from here to the next [1/m]
    mean: Array  # <g> [m], the height of the highest peak over the mean


class PressedLine(NamedTuple):
    """A line under a load."""

    depth: Array  # from the first touch, with the mean displacement of the surface [m]
    gap: Array  # mean distance of the surfaces [m]
    share: Array  # of the line in contact


def bearing(height: Array) -> Bearing:
    """The table of a periodic line of evenly spaced heights [m]."""
    g = xp.max(height) - height
    least = _FLAT * xp.max(g)
    following = xp.roll(g, -1)
    middle, half = 0.5 * (g + following), 0.5 * xp.maximum(abs(following - g), least)
    middle = xp.maximum(middle, half)  # a flat summit begins at the first touch
    ends = xp.concatenate([middle - half, middle + half])
    steps = xp.concatenate([0.5 / half, -0.5 / half]) / g.size
    order = xp.argsort(ends)
    depth, rate = ends[order], xp.cumsum(steps[order])
    width = xp.diff(depth)
    share = xp.concatenate([xp.zeros(1), xp.cumsum(rate[:-1] * width)])
    load = xp.concatenate(
        [xp.zeros(1), xp.cumsum((share[:-1] + 0.5 * rate[:-1] * width) * width)]
    )
    return Bearing(depth, share, load, rate, xp.mean(middle))


def pressed(on: Bearing, load: Array) -> PressedLine:
    """The line under mean loads over the modulus [m], p L/E*, any shape."""
    last = on.depth.shape[0] - 1
    interval = xp.clip(xp.searchsorted(on.load, load, side="right") - 1, 0, last - 1)
    # by `take`, of which either may be an array of JAX's
    depth, share, begin, rate = (
        xp.take(column, interval) for column in (on.depth, on.share, on.load, on.rate)
    )
    more = load - begin
    root = xp.sqrt(xp.maximum(share**2 + 2 * rate * more, 1e-300))
    further = 2 * more / (share + root)
    full = load >= on.load[last]
    depth = xp.where(full, on.mean + load, depth + further)
    share = xp.where(full, 1.0, xp.clip(share + rate * further, 0.0, 1.0))
    return PressedLine(
        depth, xp.where(full, 0.0, xp.maximum(on.mean - depth + load, 0.0)), share
    )


def highest(spread: Array, steepness: Array, area: Array, chance: float = 0.05) -> Any:
    """Height that the highest peak of a Gaussian surface exceeds with a small chance,
    in units of `spread`.

    `spread` is the rms height, `steepness` the rms slope along one direction. The
    expected Euler characteristic of what stands above u rms heights, area
    (steepness/spread)^2 u exp(-u^2/2)/(2 pi)^(3/2), is the chance that anything does
    (Adler, The Geometry of Random Fields, 1981).
    """
    number = xp.maximum(
        area * (steepness / spread) ** 2 / (2 * np.pi) ** 1.5 / chance, 2.0
    )
    u = xp.sqrt(2 * xp.log(number))
    for _ in range(20):
        u = xp.sqrt(2 * xp.log(number * xp.maximum(u, 1.0)))
    return u


def least_conductance(load: Array, peak: Array) -> Any:
    """Least conductance over conductivity [1/m] of elastic rough surfaces under p/E* =
    `load`.

    `peak` is the height of the highest point over the mean [m]. The pressure is a
    convex function of the approach that begins at zero, so that its slope is at least
    that of the chord from there, p/approach >= p/peak (Barber 2003).
    """
    return 2 * load / peak
