"""A ball, a cone or the like that slides or rolls steadily on a layer: arguments, plan,
directions, result.
"""

from __future__ import annotations

import dataclasses
import math
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fixed, one_thread, xp
from ..call.model_choice import of_smooth
from ..call.problem import Scene, check_rtol, steady_scene
from ..checks import Array, is_traced, require, warn_unless
from ..element.law import surface_foundation
from ..element.layer import Layer
from ..errors import InputError
from ..material.relaxation import KelvinChain, to_kelvin
from ..material.tabulated import TabulatedModulus, to_chain
from ..numerics.interpolation import lagrange
from ..numerics.root import search
from ..results.words import covers_in_words, describe
from ..surface.direction import directions, layer_asymmetry, shared_grid
from ..surface.shapes import AbstractShape, FlatPunch, PowerLaw
from .layer_line import Slid, Sliding, elastic_curve, slide_on_layer
from .problem import OnLayer, Solved, packed, too_deep
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
_FIRST, _NEARLY = 8, 1e-3  # with which edges are found about
_ORDERS = (14, 20, 28, 40, 56)  # of the polynomials, tried in turn
_TRACED = 28
_SHARE = 0.5  # of what the lower order changes, that is left of it in the higher one
_FLOOR = 1e-3  # relative error beyond which a point has failed whatever `rtol` asks
_NONE = 1e-13  # friction that rounding of the pressures leaves
_AT_ONCE = 256
_WIDEST = 16.0  # a/h of the elastic curve
# contact width over thickness that is served under a transformation of JAX
_TRACED_REACH = 16.0
_NEAREST = 8  # nodes around a velocity
_AGAIN = 4  # times that lines whose edges are not found are tried
_RISE = 0.6  # of log depth with log load, about


@dataclasses.dataclass(frozen=True)
class LayerPlan:
    """What is computed; `print(plan)` says it in words."""

    quantity: str
    scene: str
    model: str
    control: str
    points: int
    rtol: float
    covers: tuple[str, ...]
    lines: int  # solutions of the line

    def __str__(self) -> str:
        rows = [
            ("model", self.model),
            (
                "asked",
                (
                    f"{self.points} point{'s' * (self.points != 1)} by {self.control}, "
                    f"relative error {self.rtol:g}"
                ),
            ),
            *(("cover", cover) for cover in self.covers),
            (
                "lines",
                (
                    f"{self.lines}, by polynomials of degree {_ORDERS[0]} and "
                    f"{_ORDERS[1]}, up to {_ORDERS[-1]}"
                ),
            ),
            ("not needed", "history, since the motion is steady; a grid of cells"),
        ]
        return "\n".join(
            [
                f"Plan: {self.quantity}, {self.scene}",
                *(f"  {a:<12} {b}" for a, b in rows),
            ]
        )


class _Lines(NamedTuple):
    """What every line of a scene shares."""

    on: Sliding
    rest: Any  # relaxed E* [Pa]
    modulus: Any  # |E*| at a frequency
    curve: tuple[Array, Array, Array]  # radius, load and depth of the relaxed layer
    rtol: float
    misfit: float  # of a table of moduli to the series that stands for it, relatively


class _Mean(NamedTuple):
    mu: Array
    depth: Array
    line: Slid  # at the velocity itself
    error: Array
    good: Array


@one_thread()
def ball_on_layer(
    quantity: str,
    material: Layer,
    shape: AbstractShape,
    *,
    velocity: Any,
    load: Any,
    depth: Any,
    temperature: Any,
    model: Any,
    rtol: float,
    solved: bool = True,
) -> OnLayer:
    """Checks, solves and packs. Raises `InputError` for what has no meaning."""
    _check_shape(shape)
    chosen = of_smooth(model, quantity, shape.label)
    check_rtol(rtol)
    control = "load" if depth is None else "depth"
    given: dict[str, Any] = {control: load if depth is None else depth}
    points = steady_scene(
        material, shape, velocity=velocity, temperature=temperature, **given
    )
    thick = sum(cover.thickness for cover in material.covers)
    if control == "depth":
        _check_depth(points, thick)
    averaged = chosen.over_directions
    corrected = averaged and chosen.corrected
    label = CORRECTED if corrected else AVERAGED if averaged else BARE
    label += "" if material.softening is None else LINEAR
    lines = _lines(material, shape, points, control, rtol)
    value = xp.asarray(points.at_reference())
    reduced = xp.asarray(points.reduced).reshape(-1)
    plan = LayerPlan(
        quantity,
        f"{describe(shape)} on {material.name or 'a layer'}",
        label,
        control,
        reduced.size,
        float(rtol),
        covers_in_words(material),
        _count(reduced, value, averaged, rtol, points.traced),
    )
    temperatures = points.full(points.kelvin)
    if not solved:
        return OnLayer(None, temperatures, label, plan)
    force = value
    if control == "depth":
        force = _load_of_depth(lines, reduced, value, averaged)
    mean = _mean(lines, reduced, force, averaged, points.traced)
    mu, error = mean.mu, mean.error + lines.misfit * xp.abs(mean.mu)
    bound = BARE_LINE * mu
    if averaged:
        mu, error, bound = _asymmetric(mean, error, shape, thick, corrected)
    sunk = mean.depth >= thick
    good = mean.good & ~sunk
    if not points.traced:
        if np.any(lines.on.chain.compliances):
            good = good & (mu > _NONE)
        warn_unless(good, "points", f" to rtol={rtol:g}", too_deep(sunk, thick))
    line = mean.line
    solution = Solved(
        mu, error, bound, force, mean.depth, line.leading, line.trailing, good
    )
    steady = packed(points, solution, material, describe(shape), plan.covers, rtol)
    return OnLayer(steady, temperatures, label, plan)


def _check_depth(points: Scene, thick: Any) -> None:
    if points.traced:
        raise InputError(
            "load must be given on a layer under jit, grad and vmap, not depth."
        )
    require(
        "depth",
        points.value,
        f"below {float(thick):.4g} m, the thickness of the layer",
        lambda d: d < thick,
    )


def _asymmetric(
    mean: _Mean, error: Any, shape: AbstractShape, thick: Any, corrected: bool
) -> tuple[Any, Any, Any]:
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


def _check_shape(shape: AbstractShape) -> None:
    if isinstance(shape, FlatPunch):
        raise InputError(
            "shape must not be a FlatPunch in sliding or rolling: its sharp edge "
            "strains the surface at an infinite rate."
        )
    if isinstance(shape, PowerLaw) and shape.exponent < 1:
        raise InputError(
            f"exponent must be 1 or more in sliding, got {shape.exponent:g}."
        )


def _compliances(material: Layer) -> tuple[KelvinChain, float]:
    """All covers' added, and how far a series is from a table of moduli, relatively.
    Raises `InputError` for liquids and parallel dashpots.
    """
    chains, misfit = [], 0.0
    for cover in material.covers:
        solid: Any = cover.material
        if isinstance(solid, TabulatedModulus):
            table: Any = surface_foundation(solid)
            chain, off = to_chain(table)
            misfit = max(misfit, off)
        else:
            law = cover.normal()
            if not is_traced(law) and float(law.viscosity) > 0:
                raise InputError(
                    "material must have no parallel dashpot on a layer under a ball "
                    "or a cone, got viscosity "
                    f"{float(law.viscosity):.4g} Pa s: its pressure at the edge "
                    "is of another kind. "
                    "Give a branch with a short time."
                )
            if not is_traced(law) and not float(law.equilibrium) > 0:
                raise InputError(
                    "material must be a solid on a layer in sliding, got "
                    "equilibrium modulus 0."
                )
            chain = to_kelvin(law)
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


def _relaxed_curve(on: Sliding, rest: Any, places: Array) -> tuple[Array, Array]:
    """Load and depth of the relaxed layer at contact radii; beyond what the polynomials
    resolve, a steep power: a guess only.
    """
    loads, depths = fixed(elastic_curve(on, rest, places))
    rising = xp.concatenate(
        [xp.ones(1, bool), (xp.diff(loads) > 0) & (xp.diff(depths) > 0)]
    )
    resolved = xp.cumprod(rising) > 0
    top = xp.sum(resolved) - 1
    beyond = xp.where(resolved, 1.0, (places / places[top]) ** 6)
    loads, depths = (
        xp.where(resolved, field, field[top] * beyond) for field in (loads, depths)
    )
    return loads, depths


def _lines(
    material: Layer, shape: AbstractShape, points: Scene, control: str, rtol: float
) -> _Lines:
    """What every line shares: the covers' compliances, the relaxed layer, its reach."""
    chain, misfit = _compliances(material)
    h = material.covers[0].thickness

    def deficit(z: Array, omega: Array) -> Array:
        parts = [
            cover.deficit(z * (cover.thickness / h), omega) for cover in material.covers
        ]
        return sum(parts[1:], parts[0])

    def modulus(omega: Array) -> Array:
        x = omega[..., None] * chain.times
        return 1 / xp.abs(
            chain.instantaneous + xp.sum(chain.compliances / (1 + 1j * x), axis=-1)
        )

    rest = 1 / (chain.instantaneous + xp.sum(chain.compliances))
    top = xp.minimum(xp.asarray(shape.largest_contact) * (1 - 1e-9), _WIDEST * h)
    places = fixed(top * np.geomspace(1e-5, 1.0, 48))
    on = Sliding(shape, chain, deficit, h, 2 * _WIDEST, 40)
    curve = _relaxed_curve(on, rest, places)
    if points.traced:
        reach = _TRACED_REACH
    else:
        largest = np.max(points.value)
        widest = np.interp(
            largest, curve[0 if control == "load" else 1], np.asarray(places)
        )
        reach = 2.6 * float(widest) / float(h)
    order = _TRACED if points.traced else _ORDERS[0]
    on = on._replace(
        reach=1.3 ** math.ceil(math.log(max(reach, 1.0)) / math.log(1.3)), order=order
    )
    return _Lines(on, fixed(rest), modulus, (places, *curve), float(rtol), misfit)


def _solve(
    lines: _Lines, velocity: Array, load: Array, weights: Array | None = None
) -> tuple[Slid, Array]:
    """Lines at velocities and loads, and the estimated relative error of mu; `weights`
    sum them up to averages.
    """
    radius = _radius(lines, velocity, load)
    if is_traced(velocity, load, lines.on.shape, lines.on.chain, lines.on.thickness):
        solved, _ = slide_on_layer(lines.on, velocity, "load", load, (radius, radius))
        wide = solved.leading + solved.trailing < _TRACED_REACH * lines.on.thickness
        return solved._replace(converged=solved.converged & wide), xp.zeros_like(
            velocity
        )
    result: Any = None
    error = np.full(velocity.shape, np.inf)
    close = 1e-2 * min(max(lines.rtol, 1e-9), 1e-4)
    for start in range(0, velocity.size, _AT_ONCE):
        here = np.arange(start, min(start + _AT_ONCE, velocity.size))
        edges, slopes = _begun(lines.on, velocity[here], load[here], radius[here])
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
            edges = tuple(
                np.where(solved.converged[again], e[again], radius[left])
                for e in (solved.leading, solved.trailing)
            )
            if not left.size:
                break
    return result, error


def _radius(lines: _Lines, velocity: Array, load: Array) -> Array:
    """Contact radii to begin with, of an elastic layer as stiff as at the frequency of
    the passage.
    """
    places, loads, _ = lines.curve
    radius = xp.interp(load, loads, places)
    for _ in range(8):
        stiffer = fixed(lines.modulus(velocity / radius)) / lines.rest
        radius = fixed(
            xp.exp(
                0.5 * xp.log(radius)
                + 0.5 * xp.log(xp.interp(load / stiffer, loads, places))
            )
        )
    return radius


def _begun(
    on: Sliding, velocity: Array, load: Array, radius: Array
) -> tuple[tuple[Array, Array], Array]:
    """Both edges about, by few polynomials, and how the equations change with them."""
    on = on._replace(order=_FIRST)
    begun, slopes = slide_on_layer(
        on, velocity, "load", load, (radius, radius), _NEARLY
    )
    reached = np.isfinite(begun.load)
    leading = np.where(reached, begun.leading, radius)
    return (leading, np.where(reached, begun.trailing, radius)), slopes


def _with_neighbours(
    on: Sliding, velocity: Array, load: Array, edges: Any, close: float, slopes: Any
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
    lines: _Lines, velocity: Array, load: Array, averaged: bool, traced: bool
) -> _Mean:
    """mu and depth averaged over directions at equal load, and the line at the velocity
    itself.
    """
    if not averaged:
        solved, off = _solve(lines, velocity, load)
        good = solved.converged & (off <= max(lines.rtol, _FLOOR))
        return _Mean(solved.mu, solved.depth, solved, off * xp.abs(solved.mu), good)
    rule = directions(lines.rtol)
    # of the depth, which every direction counts alike
    flat = rule.weights / rule.cosines
    flat = flat / flat.sum()
    if traced:
        return _mean_of_traced(lines, velocity, load, rule, flat)
    velocity, load = np.asarray(velocity), np.asarray(load)
    out = [np.full(velocity.shape, np.nan) for _ in range(3)]
    lines_own = Slid(*(np.full(velocity.shape, np.nan) for _ in Slid._fields))
    good = np.zeros(velocity.shape, bool)
    for each in np.unique(load):
        points = np.flatnonzero(load == each)
        grid = shared_grid(velocity[points], lines.rtol)
        if grid.velocity.size < points.size * rule.cosines.size:
            averages = _on_shared_grid(lines, velocity[points], each, grid, rule, flat)
        else:
            averages = _one_by_one(lines, velocity[points], each, rule, flat)
        mu, depth, missed, fine, along_motion = averages
        for field, values in zip(out, (mu, depth, missed), strict=True):
            field[points] = values
        for field, values in zip(lines_own, along_motion, strict=True):
            field[points] = values
        good[points] = fine & (missed <= max(lines.rtol, _FLOOR) * np.abs(mu))
    mu, depth, missed = out
    return _Mean(mu, depth, lines_own, missed, good)


def _mean_of_traced(
    lines: _Lines, velocity: Array, load: Array, rule: Any, flat: Array
) -> _Mean:
    """Every direction of every point a line of its own."""
    count = velocity.shape[0]
    slowed = (velocity[:, None] * rule.cosines).reshape(-1)
    solved, _ = _solve(lines, slowed, xp.repeat(load, rule.cosines.size))
    table = Slid(*(field.reshape(count, -1) for field in solved))
    return _Mean(
        table.mu @ rule.weights,
        table.depth @ flat,
        Slid(*(field[:, 0] for field in table)),
        xp.zeros(count),
        xp.all(table.converged, axis=1),
    )


def _on_shared_grid(
    lines: _Lines, velocity: Array, load: float, grid: Any, rule: Any, flat: Array
) -> tuple[Any, ...]:
    """Averages at one load from one curve over velocity: mu, depth, error, whether all
    lines were found, and the lines at the velocities themselves.
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
    along_motion = [_between(grid.velocity, field, velocity) for field in solved[:5]]
    return mu, depth, missed, fine, [*along_motion, fine, fine]


def _one_by_one(
    lines: _Lines, velocity: Array, load: float, rule: Any, flat: Array
) -> tuple[Any, ...]:
    """The same, every direction of every velocity a line of its own."""
    count = velocity.size
    slowed = (velocity[:, None] * rule.cosines).reshape(-1)
    solved, off = _solve(lines, slowed, np.full(slowed.size, load))
    table = Slid(*(field.reshape(count, -1) for field in solved))
    mu, depth = table.mu @ rule.weights, table.depth @ flat
    gap = np.abs(table.mu @ rule.half - mu)
    rest = np.minimum(gap**2 / np.maximum(mu, 1e-300), gap)
    missed = rest + (off.reshape(count, -1) * table.mu) @ rule.weights + rule.tail * mu
    fine = table.converged.all(axis=1)
    return mu, depth, missed, fine, [field[:, 0] for field in table]


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
        return np.log(
            _mean(rough, velocity, np.exp(log), averaged, False).depth / depth
        )

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
