"""A ball, a cone or the like that slides or rolls steadily on a layer: arguments, plan,
directions, result.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import one_thread, xp
from ..call.model_choice import of_layer
from ..call.problem import SteadyScene, check_rtol, steady_scene
from ..checks import Array, certain, require, warn_unless
from ..element.law import surface_foundation
from ..element.layer import Layer
from ..errors import InputError
from ..material.relaxation import KelvinChain, to_kelvin
from ..material.tabulated import TabulatedModulus, to_chain
from ..numerics.implicit import as_doubles, implicit, numbers_with_slopes
from ..numerics.interpolation import lagrange
from ..numerics.root import search
from ..results.words import covers_in_words, describe
from ..surface.direction import (
    Directions,
    SharedGrid,
    directions,
    layer_asymmetry,
    shared_grid,
)
from ..surface.shapes import AbstractShape
from .layer_line import (
    Slid,
    Sliding,
    elastic_curve,
    equations,
    line_between,
    slide_on_layer,
)
from .problem import (
    LayerPlan,
    OnLayer,
    SmoothCall,
    Solved,
    check_edge,
    report_on_layer,
    too_deep,
)
from .softening import LINEAR

AVERAGED = (
    "MDR line with the kernel of the layer, averaged over directions (estimate for "
    "the layer)"
)
CORRECTED = (
    "MDR line with the kernel of the layer, averaged over directions, corrected for "
    "an asymmetric contact (estimate for the layer)"
)
BARE = (
    "MDR line with the kernel of the layer (overstates the losses by up to a factor "
    "of 2)"
)
# of mu: how far below the bare line three dimensions lay at most on the map
BARE_LINE = 0.5
_ORDERS = (14, 20, 28, 40, 56)  # of the polynomials, tried in turn
_TRACED = 28
_SHARE = 0.5  # of what the lower order changes, that is left of it in the higher one
_FLOOR = 1e-3  # relative error beyond which a point has failed whatever `rtol` asks
_NONE = 1e-13  # friction that rounding of the pressures leaves
_AT_ONCE = 256
_WIDEST = 16.0  # a/h of the elastic curve
# contact width over thickness that is served under a transformation of JAX
_TRACED_REACH = 16.0
_CLOSE = 1e-10  # residual at which its search ends
_NEAREST = 8  # nodes around a velocity
_AGAIN = 4  # times that lines whose edges are not found are tried
_RISE = 0.6  # of log depth with log load, about


class _Lines(NamedTuple):
    """What every line of a scene shares."""

    on: Sliding
    rest: Array  # relaxed E* [Pa]
    modulus: Callable[[Array], Array]  # |E*| at a frequency
    curve: tuple[Array, Array, Array]  # radius, load and depth of the relaxed layer
    rtol: float
    misfit: float  # of a table of moduli to the series that stands for it, relatively


# Under a transformation of JAX: what all points share, the material, where its values
# are traced, and the shape; what each has, velocity and load.
_Shared = tuple[Layer | None, AbstractShape]
_Points = tuple[Array, Array]


class _DirectionMean(NamedTuple):
    mu: Array
    depth: Array
    line: Slid  # at the velocity itself
    error: Array
    good: Array


class _BallScene(NamedTuple):
    """A call, checked and planned."""

    points: SteadyScene
    material: Layer
    shape: AbstractShape
    averaged: bool
    corrected: bool  # for an asymmetric contact
    plan: LayerPlan

    @property
    def reduced(self) -> Array:
        """Velocities times a_T, flat [m/s]."""
        return self.points.reduced.reshape(-1)


def ball_plan(call: SmoothCall) -> LayerPlan:
    """What is computed. Raises `InputError` for what has no meaning."""
    return _check(call).plan


@one_thread()
def ball_on_layer(call: SmoothCall) -> OnLayer:
    """Checks, solves and packs. Raises `InputError` for what has no meaning."""
    scene = _check(call)
    points, material, shape = scene.points, scene.material, scene.shape
    rtol, averaged, reduced = scene.plan.rtol, scene.averaged, scene.reduced
    force = value = points.at_reference()
    losing = True
    if points.traced:
        mean, misfit = _mean_of_traced(material, shape, reduced, value, averaged, rtol)
    else:
        lines = _lines(material, shape, value, points.name, rtol)
        if points.name == "depth":
            force = _load_of_depth(lines, reduced, value, averaged)
        mean, misfit = _mean(lines, reduced, force, averaged), lines.misfit
        losing = np.any(lines.on.chain.compliances)
    mu, error = mean.mu, mean.error + misfit * xp.abs(mean.mu)
    bound, thick = BARE_LINE * mu, material.whole
    if averaged:
        mu, error, bound = _asymmetric(mean, error, shape, thick, scene.corrected)
    sunk = mean.depth >= thick
    good = mean.good & ~sunk
    if not points.traced:
        good = good & (mu > _NONE) if losing else good
        warn_unless(good, "points", f" to rtol={rtol:g}", too_deep(sunk, thick))
    line = mean.line
    solution = Solved(
        mu, error, bound, force, mean.depth, line.leading, line.trailing, good
    )
    return report_on_layer(points, solution, material, shape, scene.plan)


def _check(call: SmoothCall) -> _BallScene:
    material, shape, rtol = call.material, call.shape, call.rtol
    assert isinstance(material, Layer)  # or the call would not come here
    check_edge(shape)
    chosen = of_layer(call.model, call.quantity, shape.label)
    check_rtol(rtol)
    points = steady_scene(material, shape, call.asked)
    if points.name == "depth":
        _check_depth(points, material.whole)
    averaged = chosen.over_directions
    corrected = averaged and chosen.corrected
    label = CORRECTED if corrected else AVERAGED if averaged else BARE
    label += "" if material.softening is None else LINEAR
    _check_covers(material)
    value = points.at_reference()
    reduced = points.reduced.reshape(-1)
    count = _count(reduced, value, averaged, rtol, points.traced)
    orders = f"by polynomials of degree {_ORDERS[0]} and {_ORDERS[1]}"
    plan = LayerPlan(
        call.quantity,
        f"{describe(shape)} on {material.name or 'a layer'}",
        label,
        points.name,
        reduced.size,
        float(rtol),
        tuple(("cover", cover) for cover in covers_in_words(material)),
        (
            ("lines", f"{count}, {orders}, up to {_ORDERS[-1]}"),
            ("not needed", "history, since the motion is steady; a grid of cells"),
        ),
    )
    return _BallScene(points, material, shape, averaged, corrected, plan)


def _check_depth(points: SteadyScene, thick: Array) -> None:
    if points.traced:
        raise InputError(
            argument="depth",
            accepted="left out on a layer under jit, grad and vmap",
            hint="give load",
        )
    require(
        "depth",
        points.value,
        f"below {float(thick):.4g} m, the thickness of the layer",
        lambda d: d < thick,
    )


def _asymmetric(
    mean: _DirectionMean,
    error: Array,
    shape: AbstractShape,
    thick: Array,
    corrected: bool,
) -> tuple[Array, Array, Array]:
    """mu of an average over directions, its error and bound, corrected or only bounded
    for a contact that is longer ahead than behind.
    """
    line = mean.line
    exponent = line.leading * shape._slope(line.leading) / shape._profile(line.leading)
    width = (line.leading + line.trailing) / thick
    off = layer_asymmetry(
        mean.mu, line.mu, line.leading, line.trailing, exponent, width
    )
    if not corrected:
        return mean.mu, error * (1 + off.sensitivity), mean.mu * off.bound
    factor = xp.exp(-off.excess)
    bound = mean.mu * off.corrected * factor
    return mean.mu * factor, error * factor * (1 + off.sensitivity), bound


def _check_covers(material: Layer) -> None:
    """Raises `InputError` for liquids and parallel dashpots."""
    for cover in material.covers:
        if _is_table(cover):
            continue
        law: Any = cover.normal()
        if certain(lambda x: x > 0, law.viscosity):
            raise InputError(
                argument="material",
                accepted="without a parallel dashpot on a layer under a ball or a cone",
                hint=f"it has a viscosity of {float(law.viscosity):.4g} Pa s, whose "
                "pressure at the edge is of another kind; give a branch with a short "
                "time",
            )
        if certain(lambda x: x <= 0, law.equilibrium):
            raise InputError(
                argument="material",
                accepted="a solid with an equilibrium modulus on a layer in sliding",
            )


def _compliances(material: Layer) -> tuple[KelvinChain, float]:
    """All covers' added, and how far a series is from a table of moduli, relatively."""
    chains, misfit = [], 0.0
    for cover in material.covers:
        solid: Any = cover.material
        if isinstance(solid, TabulatedModulus):
            table: Any = surface_foundation(solid)
            chain, off = to_chain(table)
            misfit = max(misfit, off)
        else:
            chain = to_kelvin(cover.normal())
        chains.append(chain)
    chain = chains[0]
    if len(chains) > 1:
        compliances, times = (
            xp.concatenate([getattr(c, name) for c in chains])
            for name in ("compliances", "times")
        )
        chain = KelvinChain(
            chains[0].instantaneous + chains[1].instantaneous,
            compliances,
            times,
            xp.zeros(()),
        )
    return chain, misfit


def _relaxed_curve(on: Sliding, rest: Array, places: Array) -> tuple[Array, Array]:
    """Load and depth of the relaxed layer at contact radii; beyond what the polynomials
    resolve, a steep power: a guess only.
    """
    loads, depths = elastic_curve(on, rest, places)
    rising = (np.diff(loads) > 0) & (np.diff(depths) > 0)
    resolved = np.cumprod(np.concatenate([[True], rising])) > 0
    top = np.sum(resolved) - 1
    beyond = np.where(resolved, 1.0, (places / places[top]) ** 6)
    loads, depths = (
        np.where(resolved, field, field[top] * beyond) for field in (loads, depths)
    )
    return loads, depths


def _sliding(
    material: Layer, shape: AbstractShape, reach: float, order: int
) -> tuple[Sliding, float]:
    """What a line is given, and how far a series is from a table of moduli."""
    chain, misfit = _compliances(material)
    h = material.covers[0].thickness

    def deficit(z: Array, omega: Array) -> Array:
        parts = [
            cover.deficit(z * (cover.thickness / h), omega) for cover in material.covers
        ]
        return sum(parts[1:], parts[0])

    return Sliding(shape, chain, deficit, h, reach, order), misfit


def _lines(
    material: Layer, shape: AbstractShape, value: Array, control: str, rtol: float
) -> _Lines:
    """What every line shares: the covers' compliances, the relaxed layer, its reach."""
    on, misfit = _sliding(material, shape, 2 * _WIDEST, 40)
    chain, h = on.chain, on.thickness

    def modulus(omega: Array) -> Array:
        x = omega[..., None] * chain.times
        relaxing = np.sum(chain.compliances / (1 + 1j * x), axis=-1)
        return 1 / np.abs(chain.instantaneous + relaxing)

    rest = 1 / (chain.instantaneous + np.sum(chain.compliances))
    top = np.minimum(np.asarray(shape.largest_contact) * (1 - 1e-9), _WIDEST * h)
    places = top * np.geomspace(1e-5, 1.0, 48)
    curve = _relaxed_curve(on, rest, places)
    widest = np.interp(np.max(value), curve[0 if control == "load" else 1], places)
    on = on._replace(reach=_stepped(2.6 * float(widest / h)), order=_ORDERS[0])
    return _Lines(on, rest, modulus, (places, *curve), float(rtol), misfit)


def _stepped(reach: float) -> float:
    """One of few reaches, for each of which waves are chosen once."""
    return 1.3 ** math.ceil(math.log(max(reach, 1.0)) / math.log(1.3))


def _solve(
    lines: _Lines, velocity: Array, load: Array, weights: Array | None = None
) -> tuple[Slid, Array]:
    """Lines at velocities and loads, and the estimated relative error of mu; `weights`
    sum them up to averages.
    """
    radius = _radius(lines, velocity, load)
    result: Any = None
    error = np.full(velocity.shape, np.inf)
    close = 1e-2 * min(max(lines.rtol, 1e-9), 1e-4)
    for start in range(0, velocity.size, _AT_ONCE):
        here = np.arange(start, min(start + _AT_ONCE, velocity.size))
        edges, slopes = (radius[here], radius[here]), None
        before, left = None, here
        for n in _ORDERS:
            on = lines.on._replace(order=n)
            solved, slopes = _with_neighbours(
                on, velocity[left], load[left], edges, close, slopes
            )
            if result is None:
                result = Slid(
                    *(
                        np.full(velocity.shape, np.nan).astype(field.dtype)
                        for field in solved
                    )
                )
            if before is not None:
                error[left] = _SHARE * np.abs(solved.mu / before - 1) + 1e-10
            for field, values in zip(result, solved, strict=True):
                field[left] = values
            counts = 1.0
            if weights is not None and before is not None and velocity.size <= _AT_ONCE:
                # how much of an average is due to each line
                sums = np.abs(weights) * np.abs(result.mu)
                counts = np.nanmax(
                    sums / np.nansum(sums, axis=1, keepdims=True), axis=0
                )[left]
            lost = np.abs(solved.mu) < _NONE
            error[left[lost]] = 1.0  # no order finds more
            again = np.flatnonzero((error[left] * counts > 0.2 * lines.rtol) & ~lost)
            left, before, slopes = left[again], solved.mu[again], slopes[..., again]
            leading, trailing = (
                np.where(solved.converged[again], e[again], radius[left])
                for e in (solved.leading, solved.trailing)
            )
            edges = leading, trailing
            if not left.size:
                break
    return result, error


def _radius(lines: _Lines, velocity: Array, load: Array) -> Array:
    """Contact radii to begin with, of an elastic layer as stiff as at the frequency of
    the passage.
    """
    places, loads, _ = lines.curve
    radius: Any = np.interp(load, loads, places)
    for _ in range(8):
        stiffer = lines.modulus(velocity / radius) / lines.rest
        elastic = np.interp(load / stiffer, loads, places)
        radius = np.exp(0.5 * np.log(radius) + 0.5 * np.log(elastic))
    return radius


def _with_neighbours(
    on: Sliding,
    velocity: Array,
    load: Array,
    edges: tuple[Array, Array],
    close: float,
    slopes: Array | None,
) -> tuple[Slid, Array]:
    """Lines of numbers, and the slopes that the search ended with; those whose edges
    are not found begin again where a neighbour in velocity has its own.
    """
    solved, slopes = slide_on_layer(on, velocity, "load", load, edges, close, slopes)
    for _ in range(_AGAIN):
        bad = np.flatnonzero(~solved.converged)
        good = np.flatnonzero(solved.converged)
        if not bad.size or not good.size:
            break
        far = np.abs(np.log(velocity[bad, None] / velocity[good])) + 3 * np.abs(
            np.log(load[bad, None] / load[good])
        )
        near = good[far.argmin(axis=1)]
        scale = (load[bad] / load[near]) ** 0.33
        again, turned = slide_on_layer(
            on,
            velocity[bad],
            "load",
            load[bad],
            (solved.leading[near] * scale, solved.trailing[near] * scale),
            close,
        )
        slopes[..., bad] = turned
        for field, values in zip(solved, again, strict=True):
            field[bad] = values
    return solved, slopes


def _mean(
    lines: _Lines, velocity: Array, load: Array, averaged: bool
) -> _DirectionMean:
    """mu and depth averaged over directions at equal load, and the line at the velocity
    itself.
    """
    if not averaged:
        solved, off = _solve(lines, velocity, load)
        good = solved.converged & (off <= max(lines.rtol, _FLOOR))
        return _DirectionMean(
            solved.mu, solved.depth, solved, off * xp.abs(solved.mu), good
        )
    rule, flat = _rule(lines.rtol)
    velocity, load = np.asarray(velocity), np.asarray(load)
    out = [np.full(velocity.shape, np.nan) for _ in range(3)]
    lines_own = Slid(*(np.full(velocity.shape, np.nan) for _ in Slid._fields))
    good = np.zeros(velocity.shape, bool)
    for each in np.unique(load):
        points = np.flatnonzero(load == each)
        grid = shared_grid(velocity[points], lines.rtol)
        if grid.velocity.size < points.size * rule.cosines.size:
            mean = _on_shared_grid(lines, velocity[points], each, grid, rule, flat)
        else:
            mean = _one_by_one(lines, velocity[points], each, rule, flat)
        found = mean.mu, mean.depth, mean.error
        for field, values in zip(out, found, strict=True):
            field[points] = values
        for field, values in zip(lines_own, mean.line, strict=True):
            field[points] = values
        fine = mean.error <= max(lines.rtol, _FLOOR) * np.abs(mean.mu)
        good[points] = mean.good & fine
    mu, depth, missed = out
    return _DirectionMean(mu, depth, lines_own, missed, good)


def _rule(rtol: float) -> tuple[Directions, np.ndarray]:
    """Directions of an average, and the weights of the depth, which every direction
    counts alike.
    """
    rule = directions(rtol)
    flat = rule.weights / rule.cosines
    return rule, flat / flat.sum()


def _mean_of_traced(
    material: Layer,
    shape: AbstractShape,
    velocity: Array,
    load: Array,
    averaged: bool,
    rtol: float,
) -> tuple[_DirectionMean, float]:
    """`_mean` under a transformation of JAX, and how far a series is from a table of
    moduli.
    """
    tables: list[Any] = [c.material for c in material.covers if _is_table(c)]
    foundations: list[Any] = [surface_foundation(x) for x in tables]
    misfit = max((to_chain(x)[1] for x in foundations), default=0.0)
    # series for tables are fitted outside of JAX
    kept = material if tables else None
    shared = as_doubles((None if tables else material, shape))
    mean_of = _with_slopes(kept, averaged, float(rtol))
    mean = mean_of(shared, as_doubles((velocity, load)))
    reach = mean.leading + mean.trailing
    wide = reach < _TRACED_REACH * material.covers[0].thickness
    good = mean.good > 0
    line = Slid(
        mean.along, load, mean.depth, mean.leading, mean.trailing, good, mean.good
    )
    return _DirectionMean(mean.mu, mean.depth, line, mean.error, good & wide), misfit


class _TracedMean(NamedTuple):
    """Of a `_DirectionMean`, what `_with_slopes` gives: derivatives but for the last
    two.
    """

    mu: Array
    depth: Array
    along: Array  # mu of the line along the motion
    leading: Array
    trailing: Array
    error: Array
    good: Array


def _is_table(cover: Layer) -> bool:
    return isinstance(cover.material, TabulatedModulus)


@functools.lru_cache(8)
def _with_slopes(
    kept: Layer | None, averaged: bool, rtol: float
) -> Callable[..., _TracedMean]:
    """A function of (material, shape) and of (velocity, load): numbers of `_mean`,
    derivatives from the two equations of the line in every direction. The material is
    `kept` where that is given.
    """
    rule, flat = _rule(rtol)
    cosines, weights = rule.cosines, rule.weights
    if not averaged:
        cosines = weights = flat = np.ones(1)

    def layer_of(shared: _Shared) -> Layer:
        layer = kept or shared[0]
        assert layer is not None
        return layer

    def numbers(shared: _Shared, points: _Points) -> _TracedMean:
        lines = _lines(layer_of(shared), shared[1], points[1], "load", rtol)
        mean = _mean(lines, points[0], points[1], averaged)
        line = mean.line
        edges = line.mu, line.leading, line.trailing
        return _TracedMean(mean.mu, mean.depth, *edges, mean.error, mean.good)

    def edges(shared: _Shared, points: _Points) -> tuple[Array, None]:
        velocity, load = points
        on, _ = _traced_line(layer_of(shared), shared[1])
        lines = _lines(layer_of(shared), shared[1], load, "load", _FLOOR)
        radius = _radius(lines, velocity, load)
        line = _with_neighbours(on, velocity, load, (radius, radius), _CLOSE, None)[0]
        logs = np.log(np.stack([line.leading, line.trailing]))
        return np.where(line.converged, logs, np.nan), None

    def equation(logs: Array, _: None, shared: _Shared, points: _Points) -> Array:
        on = _traced_line(layer_of(shared), shared[1])[0]
        return equations(on, logs, *points)[0]

    def two(_: _Shared, points: _Points) -> tuple[Array, None]:
        return xp.zeros((2, *points[0].shape)), None

    logs_of = implicit(edges, equation, two, coupled=True)

    def mean(shared: _Shared, points: _Points) -> tuple[Array, ...]:
        velocity, load = points
        slowed = (velocity[:, None] * cosines).reshape(-1)
        each = slowed, xp.repeat(load, cosines.size)
        leading, trailing = xp.exp(logs_of(shared, each))
        on, _ = _traced_line(layer_of(shared), shared[1])
        line = line_between(on, slowed, leading, trailing)
        fields = line.force / line.load, line.depth, leading, trailing
        mu, depth, leading, trailing = (
            field.reshape(-1, cosines.size) for field in fields
        )
        along = mu[:, 0], leading[:, 0], trailing[:, 0]
        return mu @ weights, depth @ flat, *along

    solve = numbers_with_slopes(numbers, ((mean, 5),), lambda _, x: (x[0],) * 7)
    return lambda shared, points: _TracedMean(*solve(shared, points))


def _traced_line(material: Layer, shape: AbstractShape) -> tuple[Sliding, float]:
    return _sliding(material, shape, _stepped(_TRACED_REACH), _TRACED)


def _on_shared_grid(
    lines: _Lines,
    velocity: Array,
    load: float,
    grid: SharedGrid,
    rule: Directions,
    flat: Array,
) -> _DirectionMean:
    """Averages at one load from one curve over velocity; good where all lines were
    found.
    """
    loads = np.full(grid.velocity.size, load)
    solved, off = _solve(lines, grid.velocity, loads, grid.weights)
    mu = grid.weights @ solved.mu
    gap = np.abs(grid.half @ solved.mu - mu), np.abs(grid.lower @ solved.mu - mu)
    rest = np.minimum(gap[0] ** 2 / np.maximum(mu, 1e-300), gap[0]) + 3 * gap[1]
    missed = rest + np.abs(grid.weights) @ (off * np.abs(solved.mu)) + rule.tail * mu
    slowed = velocity[:, None] * rule.cosines
    depth = _between(grid.velocity, solved.depth, slowed) @ flat
    fine = (grid.weights != 0) @ ~solved.converged == 0
    numbers = (_between(grid.velocity, field, velocity) for field in solved[:5])
    line = Slid(*numbers, converged=fine, lowest=fine)
    return _DirectionMean(mu, depth, line, missed, fine)


def _one_by_one(
    lines: _Lines, velocity: Array, load: float, rule: Directions, flat: Array
) -> _DirectionMean:
    """The same, every direction of every velocity a line of its own."""
    count = velocity.size
    slowed = (velocity[:, None] * rule.cosines).reshape(-1)
    solved, off = _solve(lines, slowed, np.full(slowed.size, load))
    table = Slid(*(field.reshape(count, -1) for field in solved))
    mu, depth = table.mu @ rule.weights, table.depth @ flat
    gap = np.abs(table.mu @ rule.half - mu)
    rest = np.minimum(gap**2 / np.maximum(mu, 1e-300), gap)
    missed = rest + (off.reshape(count, -1) * table.mu) @ rule.weights + rule.tail * mu
    fine = xp.all(table.converged, axis=1)
    line = Slid(*(field[:, 0] for field in table))
    return _DirectionMean(mu, depth, line, missed, fine)


def _between(nodes: Array, values: Array, velocity: Array) -> Array:
    """Positive values at velocities between nodes that are even in log v: Lagrange's
    polynomials on logarithms.
    """
    step = math.log(nodes[1] / nodes[0])
    index, local = lagrange(
        np.clip(np.log(velocity / nodes[0]) / step, 0, nodes.size - 1), _NEAREST
    )
    index = np.clip(index, 0, nodes.size - 1)
    return np.exp(np.sum(local * np.log(values[index]), axis=-1))


def _load_of_depth(
    lines: _Lines, velocity: Array, depth: Array, averaged: bool
) -> Array:
    """Loads at which the depth is that, sought in logarithms."""
    places, loads, depths = lines.curve
    rough = lines._replace(rtol=max(lines.rtol, 1e-4))

    def miss(log: Array) -> Array:
        return np.log(_mean(rough, velocity, np.exp(log), averaged).depth / depth)

    stiffer = lines.modulus(velocity / np.interp(depth, depths, places)) / lines.rest
    guess = np.log(np.interp(depth, depths, loads) * np.maximum(stiffer, 1.01))
    return np.exp(search(miss, guess, lines.rtol, _RISE, longest=2.0)[0])


def _count(
    velocity: Array, load: Array, averaged: bool, rtol: float, traced: bool
) -> int:
    """How many lines are solved, about."""
    if not averaged:
        return velocity.size
    each = directions(rtol).cosines.size
    if traced or np.unique(load).size > 1:
        return velocity.size * each
    return min(
        velocity.size * each,
        velocity.size + shared_grid(np.asarray(velocity), rtol).velocity.size,
    )
