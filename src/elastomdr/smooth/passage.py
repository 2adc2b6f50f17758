"""Steady sliding of one indenter: contact size and trailing edge from load or depth,
then the forces.

In steady motion every element has the same history, so one passage is the whole field.
Two kinds of unknown: the contact size A, from the load (or the depth), and for each
line its trailing edge b, where the force density falls to zero. For a convex profile b
is unique: after contact is lost the free surface falls ever more slowly (its recovery
is completely monotone) while the profile retreats ever faster, so it cannot touch
again, and holding on would need tension.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from ..arrays import on_numpy, stop_gradient, xp
from ..checks import Array
from ..element.episode import recovery_modes
from ..material.relaxation import Relaxation
from ..numerics.implicit import as_doubles, implicit, on_host, stationary
from ..numerics.quadrature import gauss_unit
from ..numerics.root import search
from ..surface.lines import AbstractLines, SingleLine
from ..surface.sampling import Rule
from .memory import Passage, first_variant, selected, tabulated
from .passage_integrals import (
    balance,
    balance_and_slopes,
    branch_losses,
    exit_density,
    forces,
    friction_force,
    normal_force,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, PyTree

Control = Literal["load", "depth"]

_ITERATIONS = 60  # after which a point is given up
_MET = 1e-3  # relative miss of the load up to which a small step is believed
_FAR = 1e-6  # relative distance of two values from which their difference gives a slope
# relative to the slope of an elastic contact, below which a slope is rounding
_ROUNDING = 1e-12
_NEAR = 1e-3  # b/a below which the search halves its logarithm
# of Newton's method on load and edge together, before a point is left to the search by
# brackets
_STEPS = 15
_TABLES = 3  # how often panels are laid out anew,
_MOVED = 0.05  # where the contact has grown or shrunk by as much
_CLOSE = 1e-7  # the length of its last step, squared by it
_STEEP = 0.1  # distance of a first guess at log A from the end of the body
_GUESSED = 0.1  # by how much a guess at log A is improved at the last
_TIGHT = 1e-9  # step at which the searches stop


class Passages(NamedTuple):
    """Steady sliding of many points at once."""

    mu: Float[Array, " points"]
    normal_force: Float[Array, " points"]  # [N]
    friction_force: Float[Array, " points"]  # [N]
    depth: Float[Array, " points"]  # [m]
    leading: Float[Array, " points"]  # leading edge of the central line [m]
    # its trailing edge, counted backwards from the apex [m]
    trailing: Float[Array, " points"]
    # a g'(a)/g(a), the power with which the profile rises, the mean of both edges
    exponent: Float[Array, " points"]
    error: Float[Array, " points"]  # estimated error of mu from sampling
    converged: Bool[Array, " points"]


def solve_passages(
    law: Relaxation,
    lines: AbstractLines,
    rule: Rule,
    control: Control,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
) -> Passages:
    """Steady passages; under a transformation of JAX differentiable in the law, the
    shape, the load or depth, and the velocity.

    The edges are sought to rounding. Under a transformation they are sought in NumPy
    all the same; `error` is then zero.
    """
    lines = lines.refined(rule.strips)
    if on_numpy():
        p = Passage(law, lines, rule, velocity)
        return _forces(*_edges(p, control, value))
    law, lines, value, velocity = as_doubles((law, lines, value, velocity))
    shared = law, lines
    size = _size(rule, control)(shared, (value, velocity))
    drag = _drag(rule)(shared, (size, velocity))
    normal = value
    if control == "depth":
        normal = _normal(rule)(shared, (size, velocity))
    entry = lines.entry(size)
    leading = entry[0]
    trailing = (_ratio(rule)(shared, (size, velocity)) * entry)[0]
    return Passages(
        mu=drag / normal,
        normal_force=normal,
        friction_force=drag,
        depth=lines.depth(size),
        leading=leading,
        trailing=trailing,
        exponent=lines.rise(leading, trailing),
        error=xp.zeros_like(normal),
        converged=xp.isfinite(drag),
    )


# Under a transformation of JAX: functions of what all points share, (law, lines), and
# of what each has of its own. A value is found in NumPy, its derivative follows from
# the equation that it solves.


@functools.cache
def _size(rule: Rule, control: Control) -> Any:
    """Contact size from (load or depth, velocity)."""

    def search(shared: PyTree, points: PyTree) -> tuple[Array, None]:
        law, lines = shared
        value, velocity = points
        p = Passage(law, lines, rule, velocity)
        _, size, _, converged = _edges(p, control, value)
        return np.where(converged, size, np.nan), None

    def equation(size: Array, _: None, shared: PyTree, points: PyTree) -> Array:
        value, velocity = points
        if control == "depth":
            return shared[1].depth(size) - value
        return _normal(rule)(shared, (size, velocity)) - value

    return implicit(search, equation, lambda _, points: (points[0], None))


@functools.cache
def _ratio(rule: Rule) -> Any:
    """Trailing edges over leading ones from (contact size, velocity)."""

    def search(shared: PyTree, points: PyTree) -> tuple[Array, Array]:
        law, lines = shared
        size, velocity = points
        p = Passage(law, lines, rule, velocity)
        p, size, ratio, converged = _edges(p, "depth", lines.depth(size))
        # Where both edges agree to rounding, a kink (a cone) has no slope there: the
        # edge stays where it was found.
        slope = size * balance_and_slopes(first_variant(p), size, ratio).density_exit
        nothing = _ROUNDING * _elastic_slope(p, size)
        free = (ratio > 2 * NEAREST_EXIT) & (slope < nothing)
        return np.where(converged, ratio, np.nan), free.astype(float)

    def equation(ratio: Array, free: Array, shared: PyTree, points: PyTree) -> Array:
        law, lines = shared
        size, velocity = points
        density = exit_density(Passage(law, lines, rule, velocity), size, ratio)
        return xp.where(free > 0, density, ratio - stop_gradient(ratio))

    def like(shared: PyTree, points: PyTree) -> tuple[Array, Array]:
        edges = xp.zeros((shared[1].count, *points[0].shape))
        return edges, edges

    return implicit(search, equation, like)


@functools.cache
def _normal(rule: Rule) -> Any:
    """Normal force from (contact size, velocity).

    It does not change with the trailing edge: dF_N/db = q(-b), which is zero there.
    """

    def force(shared: PyTree, points: PyTree, ratio: Array) -> Array:
        law, lines = shared
        size, velocity = points
        return normal_force(Passage(law, lines, rule, velocity), size, ratio)

    return stationary(force, _ratio(rule))


@functools.cache
def _drag(rule: Rule) -> Any:
    """Friction force from (contact size, velocity); dF_x/db = -g'(b) q(-b) = 0."""

    def force(shared: PyTree, points: PyTree, ratio: Array) -> Array:
        law, lines = shared
        size, velocity = points
        p = Passage(law, lines, rule, velocity, judged=False)
        return friction_force(p, size, ratio)

    return stationary(force, _ratio(rule))


def estimate_sizes(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Array,
    velocity: Array,
) -> Float[Array, " points"]:
    """Contact sizes [m] for planning, within a factor of 2."""
    if not on_numpy():
        return on_host(_estimated(control), value, (law, lines), (value, velocity))
    return _estimated(control)((law, lines), (value, velocity))


@functools.cache
def _estimated(control: Control) -> Any:
    def sizes(shared: PyTree, points: PyTree) -> Array:
        law, lines = shared
        value, velocity = points
        top = largest_size(lines, value)
        if control == "depth":
            return _size_of_depth(lines, value, top)
        return np.exp(_first_guess(Passage(law, lines, Rule(2), velocity), value, top))

    return sizes


def largest_size(lines: AbstractLines, value: Array) -> Array:
    """Logarithm of the largest contact size that the shape allows."""
    largest = np.broadcast_to(
        np.asarray(lines.shape.largest_contact, dtype=value.dtype), value.shape
    )
    return np.log(np.minimum(largest * (1 - 1e-13), 1e60))


class _Edges(NamedTuple):
    passage: Passage  # with its table
    size: Array
    ratio: Array  # of trailing over leading edges
    converged: Array


def _edges(p: Passage, control: Control, value: Array) -> _Edges:
    """The passage with its table, contact sizes and trailing edges to rounding, and
    which points have them; on NumPy.
    """
    top = largest_size(p.lines, value)
    by_depth, single = control == "depth", isinstance(p.lines, SingleLine)
    ratio, log_size = np.full((p.lines.count, *value.shape), 0.8), value
    if by_depth:
        log_size = np.log(_size_of_depth(p.lines, value, top))
    elif not single:
        log_size = _first_guess(p, value, top)
    if single and (p.rule.parabola or not by_depth):
        log_size, ratio, converged = under_parabola(
            p, log_size if by_depth else value, top, by_depth
        )
        if p.rule.parabola and converged.all():
            return _Edges(p, np.exp(log_size), ratio, converged)
        # the end of a ball is infinitely steep, and a search does not get away from it
        log_size = log_size if by_depth else np.minimum(log_size, top - _STEEP)
    converged = np.zeros(value.shape, bool)
    for _ in range(_TABLES):
        p, before = tabulated(p, np.exp(log_size)), log_size
        log_size, ratio, converged = _sought(
            first_variant(p), value, log_size, ratio, top, by_depth
        )
        if p.table is None or np.all(np.abs(log_size - before) < _MOVED):
            break
    return _Edges(p, np.exp(log_size), ratio, converged)


def _sought(
    p: Passage, value: Array, log_size: Array, ratio: Array, top: Array, by_depth: bool
) -> tuple[Array, Array, Array]:
    """Contact sizes and trailing edges from some that are near, and which points have
    them.
    """
    start = log_size, ratio
    log_size, ratio, converged = _by_newton(p, value, log_size, ratio, top, by_depth)
    left = ~converged
    if left.any():
        remaining, log_size, ratio = selected(p, left), log_size.copy(), ratio.copy()
        log_size[left], ratio[:, left] = start[0][left], start[1][:, left]
        if by_depth:
            size = np.exp(log_size[left])
            ratio[:, left], _, converged[left] = _exits(
                remaining, size, ratio[:, left], 1.0
            )
        else:
            size, ratio[:, left], converged[left] = _size_of_load(
                remaining, value[left], log_size[left], ratio[:, left], top[left]
            )
            log_size[left] = np.log(size)
        converged[left] &= _settled(remaining, size, ratio[:, left])
    return log_size, ratio, converged


def _by_newton(
    p: Passage, value: Array, log_size: Array, ratio: Array, top: Array, by_depth: bool
) -> tuple[Array, Array, Array]:
    """Newton's method on load and trailing edges together, for the points on which it
    settles within few steps; the others are left to one search within another.
    """
    single = isinstance(p.lines, SingleLine)
    steps, kinked = _steps_of_line if single else _steps_of_strips, p.rule.split
    log_size, ratio, converged = (
        log_size.copy(),
        ratio.copy(),
        np.zeros(value.shape, bool),
    )
    left = np.arange(value.size)
    for _ in range(_STEPS):
        size, edge = np.exp(log_size[left]), ratio[:, left]
        remaining = selected(p, left) if left.size < value.size else p
        excess, step, turn = steps(remaining, value[left], size, edge, by_depth)
        # At the widest contact a step is small wherever the load is.
        small = (np.abs(excess) <= _MET) & (np.abs(step) <= _CLOSE)
        turned = np.abs(turn) <= _CLOSE * np.minimum(edge, 1 - edge) + 4e-15
        small = small & np.all(turned, axis=0)
        after = edge + turn
        beyond = 1 - 0.2 * (1 - edge)
        after = np.where(after >= 1, beyond, np.where(after <= 0, 0.2 * edge, after))
        log_size[left] = np.minimum(
            log_size[left] + np.clip(step, -2.0, 2.0), top[left]
        )
        ratio[:, left], converged[left] = after, small
        # A step that is no number leads nowhere, and near a kink at the apex the edge
        # of a line may lie anywhere.
        goes_on = ~small & np.isfinite(np.sum(turn, axis=0) + step)
        if single and kinked:
            goes_on &= after[0] > _NEAR
        left = left[goes_on]
        if not left.size:
            break
    return log_size, ratio, converged


def _steps_of_line(
    p: Passage, value: Array, size: Array, edge: Array, by_depth: bool
) -> tuple[Array | float, Array | float, Array]:
    """By how much the log of the load is missed, and the steps of log size and edge that
    would meet it and the density at the edge.
    """
    density, force, density_entry, density_exit, force_entry = (
        x[0] for x in balance_and_slopes(p, size, edge)
    )
    if by_depth:
        return 0.0, 0.0, (-density / (size * density_exit))[None]
    excess = np.log(p.lines.weight(size)[0] * force / value)
    per_size, per_edge = (
        size * (force_entry + edge[0] * density) / force,
        size * density / force,
    )
    moved, turned = (
        size * (density_entry + edge[0] * density_exit),
        size * density_exit,
    )
    scale = per_size * turned - per_edge * moved
    step = (per_edge * density - turned * excess) / scale
    return excess, step, ((moved * excess - per_size * density) / scale)[None]


def _steps_of_strips(
    p: Passage, value: Array, size: Array, edge: Array, by_depth: bool
) -> tuple[Array | float, Array | float, Array]:
    """The same on strips: each edge by its own density, and the size by the load.

    How an edge moves with the size is left out; the force does not change to first
    order with an edge, so that two steps together are still quadratic.
    """
    passing = balance_and_slopes(p, size, edge)
    entry, weight = p.lines.entry(size), p.lines.weight(size)
    turn = -passing.density / (entry * passing.density_exit)
    if by_depth:
        return 0.0, 0.0, turn
    force = np.sum(weight * passing.force, axis=0)
    # With the depth d each line's force grows by dF/da da/dd = dF/da / g'(a).
    steep = p.lines.slope(entry, size, np.arange(p.lines.count)[:, None])
    per_depth = np.sum(weight * passing.force_entry / steep, axis=0)
    depth = p.lines.depth(size)
    per_size = p.lines.exponent(size) * depth * per_depth / force
    excess = np.log(force / value)
    return excess, -excess / per_size, turn


def _settled(p: Passage, size: Array, ratio: Array) -> Array:
    """Whether the density changes sign about each trailing edge: a search that was led
    astray stops where it does not.

    An edge at a kink, and one where a slope would be rounding, stay as they were found.
    """
    room = 1e-3 * np.minimum(ratio, 1 - ratio) + 1e-13
    nothing = _ROUNDING * np.abs(_elastic_slope(p, size))
    ahead, behind = (
        exit_density(p, size, np.maximum(ratio - room, 0.0)),
        exit_density(p, size, ratio + room),
    )
    return np.all(
        (ratio <= 2 * NEAREST_EXIT) | ((ahead >= -nothing) & (behind <= nothing)),
        axis=0,
    )


def _size_of_depth(lines: AbstractLines, depth: Array, top: Array) -> Array:
    """Contact size of a depth, sought in logarithms."""
    guess = np.minimum(USUAL, top - 0.5) + np.zeros_like(depth)

    def residual(log_size: Array) -> Array:
        # at least what rounding leaves of a flat bottom
        return np.log(np.maximum(lines.depth(np.exp(log_size)) / depth, 1e-14))

    slope = lines.exponent(np.exp(guess))
    slope = np.where((slope > 0) & (slope < np.inf), slope, 2.0)
    return np.exp(search(residual, guess, _TIGHT, slope, top)[0])


def _first_guess(p: Passage, load: Array, top: Array) -> Array:
    """log A of an elastic contact whose modulus is about the mean of E(t) over one
    passage.
    """
    c, w, _ = gauss_unit(6)
    line = np.arange(p.lines.count)[:, None, None]

    def force(log_size: Array) -> Array:
        size = np.exp(log_size)
        mean = _mean_modulus(p, size)
        entry = p.lines.entry(size)
        x = entry[:, None] * c[:, None]
        volume = (
            2 * entry * np.sum(w[:, None] * x * p.lines.slope(x, size, line), axis=1)
        )
        return mean * np.sum(p.lines.weight(size) * volume, axis=0)

    def residual(log_size: Array) -> Array:
        return np.log(force(log_size) / load)

    guess = np.minimum(np.full_like(load, USUAL), top - 0.5)
    # Of a profile that is a power, log force against log size rises by between n and
    # n + 1.
    usual = p.lines.exponent(np.exp(guess)) + 0.5
    return search(residual, guess, _GUESSED, usual, top)[0]


def _mean_modulus(p: Passage, size: Array) -> Array:
    """About the mean of E(t) over one passage."""
    passage = 2 * size / p.velocity
    branches = p.law.moduli @ (1 / (1 + passage / p.law.times[:, None]))
    return p.law.equilibrium + branches + p.law.viscosity / passage


def _elastic_slope(p: Passage, size: Array) -> Array:
    """Derivative of the exit density by b/a, about, in a contact that loses nothing."""
    entry = p.lines.entry(size)
    line = np.arange(p.lines.count)[:, None]
    return -_mean_modulus(p, size) * entry * p.lines.slope(0.8 * entry, size, line)


def _exits(
    p: Passage, size: Array, ratio: Array, factor: Array | float
) -> tuple[Array, Array, Array]:
    """Trailing edges b/a at given contact sizes, all lines at once: the secant method
    inside a shrinking bracket.

    It starts with `factor` times the slope of an elastic contact, and returns the
    factor that it ended with. The search of `numerics/root.py` takes steps of one
    length everywhere, but edges lie anywhere between rounding and one.
    """
    elastic = _elastic_slope(p, size)
    slope = factor * elastic
    low, high = np.full_like(ratio, NEAREST_EXIT), np.full_like(ratio, 1 + 1e-14)
    settled = np.zeros(ratio.shape, bool)
    if p.rule.split:
        settled = exit_density(p, size, low) <= 0  # contact is lost at the apex
        ratio = np.where(settled, low, ratio)
    before, density_before = ratio, np.zeros_like(ratio)
    for _ in range(_ITERATIONS):
        if settled.all():
            break
        density = exit_density(p, size, ratio)
        low = np.where(density > 0, ratio, low)
        high = np.where(density > 0, high, ratio)
        slope = _secant(ratio - before, density - density_before, slope, _FAR * ratio)
        following = ratio - density / slope
        inside = (following >= low) & (following <= high)
        # Near a kink at the apex the edge may lie anywhere between rounding and a
        # thousandth.
        middle = np.where(high < _NEAR, np.sqrt(low * high), 0.5 * (low + high))
        following = np.where(inside, following, middle)
        close = _TIGHT * np.minimum(ratio, 1 - ratio) + 4e-15
        small = np.abs(following - ratio) <= close
        before, density_before = ratio, density
        ratio = np.where(settled, ratio, following)
        settled = settled | small | (density == 0)
    return ratio, slope / elastic, np.all(settled, axis=0)


def _secant(step: Array, change: Array, slope: Array, far: Array | float) -> Array:
    """Slope of a falling or rising function from its last two values, where they lie
    far enough apart to tell.
    """
    known = (np.abs(step) > far) & (change * step * slope > 0)
    return np.where(known, change / np.where(known, step, 1.0), slope)


def _size_of_load(
    p: Passage, load: Array, log_size: Array, ratio: Array, top: Array
) -> tuple[Array, Array, Array]:
    """Contact size for a load: the secant method on log F_N against log A, nearly a
    straight line. An edge that is off by a little leaves the force as it is, since
    dF/db = q(-b) = 0.
    """
    factor, converged = np.ones_like(ratio), np.zeros(load.shape, bool)

    def excess(log_size: Array) -> Array:
        # edges begin where the last size had them
        nonlocal ratio, factor, converged
        size = np.exp(log_size)
        ratio, factor, converged = _exits(p, size, ratio, factor)
        return np.log(balance(p, size, ratio)[1]) - np.log(load)

    log_size, met = search(excess, log_size, _TIGHT, 2.5, top)
    return np.exp(log_size), ratio, met & converged


def _forces(p: Passage, size: Array, ratio: Array, converged: Array) -> Passages:
    """Everything that follows from the edges: the forces, and their sampling error."""
    lines = p.lines
    normal, normal_error, drag, drag_error = forces(p, size, ratio)
    mu = drag / normal
    entry = lines.entry(size)
    return Passages(
        mu=mu,
        normal_force=normal,
        friction_force=drag,
        depth=lines.depth(size),
        leading=entry[0],
        trailing=(ratio * entry)[0],
        exponent=lines.rise(entry[0], (ratio * entry)[0]),
        error=stop_gradient((drag_error + xp.abs(mu) * normal_error) / normal),
        converged=converged,
    )


class Losses(NamedTuple):
    """Where the energy of a passage goes."""

    dashpot: Float[Array, " points"]  # of the parallel dashpot, per length of way [N]
    branches: Float[Array, "branches points"]  # of each branch [N]
    friction_force: Float[Array, " points"]  # the work, by its own integral [N]
    # of the work, from sampling [N]; zero under a transformation of JAX
    error: Float[Array, " points"]
    converged: Bool[Array, " points"]


def solve_losses(
    law: Relaxation,
    lines: AbstractLines,
    rule: Rule,
    control: Control,
    value: Array,
    velocity: Array,
) -> Losses:
    """Steady passages, and what each branch turns into heat; differentiable as
    `solve_passages` is.
    """
    modes, lines = recovery_modes(law), lines.refined(rule.strips)
    p = Passage(law, lines, rule, velocity)
    if on_numpy():
        p, size, ratio, good = _edges(p, control, value)
        work = forces(p, size, ratio)
        return Losses(
            *branch_losses(p, modes, size, ratio),
            work.friction,
            work.friction_error + work.friction * work.normal_error / work.normal,
            good,
        )
    law, lines, value, velocity = as_doubles((law, lines, value, velocity))
    size = _size(rule, control)((law, lines), (value, velocity))
    ratio = _ratio(rule)((law, lines), (size, velocity))
    p = Passage(law, lines, rule, velocity, judged=False)
    dashpot, branches = branch_losses(p, modes, size, ratio)
    return Losses(
        dashpot,
        branches,
        _drag(rule)((law, lines), (size, velocity)),
        xp.zeros_like(size),
        xp.isfinite(size),
    )


# Contact edges under a parabola on a single line, in closed form: all integrals of such
# a passage are means of exponentials over the contact, so that Newton's method on the
# edges needs no panels. On NumPy.

# b/a below which contact is lost at the apex itself (a kink under a dashpot)
NEAREST_EXIT = 1e-15
USUAL = math.log(1e-3)  # log of a contact size [m] to begin with
_GUESSES = 8  # how often the length of a contact under a parabola is improved
# last step of log(a + b) under a parabola, whose error is the square of it
_GUESSED_WELL = 1e-4
_TO_ROUNDING = 2e-14  # the same after the last step where the body is a parabola
# passage time over relaxation time from which closed forms keep their digits,
_NEARLY_SPRING = 0.05
# and of what is done below it
_SERIES = [1 / (math.factorial(k) * (k + 3)) for k in range(8)]


def under_parabola(
    p: Passage, given: Array, top: Array, by_size: bool
) -> tuple[Array, Array, Array]:
    """log A and b/a on a single line, by Newton's method, if its profile were a
    parabola, and where; on NumPy.

    Of a given load, or `by_size` of log A itself.

    The parabola is the one with the same volume between profile and contact. For a
    parabola with the length L = a + b of contact and M_j = int E(r/v) r^j dr from 0 to
    L, q(-b) = 0 gives b = M_1/(M_0 + eta v), and the force follows.
    """
    law, lines, line, exact = p.law, p.lines, np.zeros((1, 1), int), p.rule.parabola
    c, w, _ = gauss_unit(6)
    rate, drag, widest = 1 / p.decay, p.velocity * law.viscosity, np.exp(top)
    lossy = bool(np.any(drag))
    log_length = (
        (given if by_size else np.minimum(USUAL, top - 0.5))
        + math.log(2)
        + np.zeros_like(given)
    )
    a, b, length, before = 4 * (np.ones_like(given),)
    # of a parabola that is the curvature
    curvature, weight = lines.profile(a, a, line), lines.weight(a)[0]
    converged = np.zeros(given.shape, bool)
    for _ in range(_GUESSES):
        length = np.exp(log_length)
        kept, first, second, third = (
            law.moduli @ x for x in _exponential_means(length * rate)
        )
        last, mean = law.equilibrium + kept, law.equilibrium + first
        mean = mean + drag / length if lossy else mean
        arm = law.equilibrium / 2 + second
        b = arm / mean
        a = 1 - b
        size, left_over = length * a, mean - last * a
        if by_size:
            step = (given - np.log(size)) * a * mean / left_over
        else:
            force = mean - 2 * arm * a - (law.equilibrium / 3 + third)
            rise = 2 * a * left_over / force
            if not exact:
                size = np.minimum(size, widest)
                x = size * c[:, None]
                curvature = 1.5 / size**2 * (w @ (x * lines.slope(x, size, line)))
                rise = rise + (lines.exponent(size) - 2) * left_over / (a * mean)
            step = np.log(given / (weight * curvature * length**3 * force)) / rise
        log_length = np.minimum(log_length + step, top + math.log(2))
        miss = np.abs(step)
        # Each miss is the square of the one before times a number, taken as 1/4 at
        # least.
        left = miss**2 * np.maximum(miss / before**2, 0.25)
        if miss.max() < _GUESSED_WELL and (not exact or left.max() <= _TO_ROUNDING):
            moved = left_over / mean * step  # da/dL = left_over/mean
            a, b = a + moved, b + step - moved
            converged = size <= widest
            break
        before = miss
    ratio = np.minimum(np.maximum(b / a, NEAREST_EXIT), 1 - 4e-16)
    return (
        given if by_size else np.minimum(np.log(length * a), top),
        ratio[None],
        converged,
    )


class _Means(NamedTuple):
    kept: Array  # e^{-z}
    zeroth: Array
    first: Array
    second: Array


def _exponential_means(z: Array) -> _Means:
    """e^{-z} and int e^{-z c} c^j dc from 0 to 1 for j = 0, 1, 2.

    The last by a series where z is small, and from it the others, whose sums cancel
    nothing.
    """
    left, small = np.exp(-z), -np.minimum(z, _NEARLY_SPRING)
    series = np.full_like(z, _SERIES[-1])
    for coefficient in _SERIES[-2::-1]:
        series *= small
        series += coefficient
    third = np.where(
        z < _NEARLY_SPRING, series, (2 * (-np.expm1(-z) / z - left) / z - left) / z
    )
    second = 0.5 * (left + z * third)
    return _Means(left, left + z * second, second, third)
