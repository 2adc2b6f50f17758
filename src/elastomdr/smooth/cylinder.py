"""A cylinder that rolls or slides steadily on a layer or a half-space, in plane strain:
arguments, plan, result.
"""

from __future__ import annotations

import dataclasses
import functools
import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import one_thread, stop_gradient, xp
from ..call.model_choice import of_layer
from ..call.problem import SteadyScene, check_rtol, steady_scene
from ..checks import (
    Array,
    certain,
    known,
    numbers_only,
    require,
    warn_unless,
)
from ..element.law import (
    TabulatedFoundation,
    normal_operator,
    surface_foundation,
)
from ..element.layer import Body, Layer, layer_kernel
from ..errors import InputError, ModelWarning, warn
from ..material.prony import Prony
from ..material.relaxation import to_kelvin
from ..material.tabulated import TabulatedModulus, to_chain
from ..numerics.implicit import as_doubles, implicit, numbers_with_slopes
from ..results.words import covers_in_words, describe, significant
from ..surface.shapes import Cylinder
from ..trees import replaced
from .cylinder_galerkin import (
    Cover,
    Cylinders,
    LayerWaves,
    Solution,
    depth,
    depth_and_gap,
    half_of,
    layer_waves,
    losses,
    pull,
    solve_at,
)
from .problem import (
    LayerPlan,
    OnLayer,
    SmoothCall,
    Solved,
    nearly,
    report_on_layer,
    too_deep,
)
from .softening import LINEAR

ON_LAYER = (
    "cylinder on a layer, plane strain (exact but for the ends of the cylinder, beyond "
    "which the rubber goes on)"
)
ON_HALF_SPACE = (
    "cylinder on a half-space, plane strain (exact but for the ends of the cylinder)"
)
_FIRST = 16  # terms of the pressure where the search begins
# compared each with the one before; the first one only where `rtol` is coarse
_ORDERS, _COARSE = (24, 48, 72, 108, 162, 243), 1e-4
# relative error below which a point counts whatever `rtol` asks: `error` says what was
# reached
_FLOOR = 1e-5
_AT_ONCE = 64  # points whose matrices are made together, in the cache of a core
_TRACED_ORDER = 48  # terms of the pressure whose derivatives are taken
_LOSS_RTOL = 1e-6  # of friction, with which the half-length is right to 1e-4
_LOSS_ORDER = 64  # terms of the pressure whose losses are told by branch
# half-length over thickness up to which derivatives are known
_TRACED_RATIO = 12.0
# Errors of friction fall as this power of the order, or faster: as the fourth or fifth
# where a memory is as long as the edges that polynomials resolve.
_POWER = 1.75
_NOTHING = 1e-12  # of the width of the contact over the radius
_ROUNDING = 3e-9  # of mu: tables and sums
# of the load, or of the gap: beyond it the contact is not the one assumed
_NEGATIVE = 1e-3
# half-length over thickness, as guessed, that is tried: time and memory grow with it
_WIDEST = 60.0
_ENDS = 4.0  # length over half-width below which a cylinder is no longer plane
# The bound on what the ends change, as a share of mu: thicknesses that count beside the
# half-width, the largest share, and half-widths over thickness, for which it was found.
_AROUND, _MOST, _CELLS = 0.25, 0.25, (0.03, 6.0)
_TYPICAL = 1.5  # kL of the wave that stands for a contact where its size is estimated
# how many times longer than its passage over a thickness a liquid is remembered
_FLOWING = 1e8


# what carries the pressure; while JAX traces the body itself, whose retardation times
# are then derived in the same program
Carriers = tuple[Cover, ...] | Body


class _Contacts(NamedTuple):
    """Friction, load, depth and edges at each point."""

    mu: Array
    load: Array  # [N/m]
    leading: Array
    trailing: Array
    depth: Array  # NaN on a half-space
    error: Array
    good: Array


class _CylinderScene(NamedTuple):
    """A call, checked and planned."""

    points: SteadyScene
    body: Body
    shape: Cylinder
    carriers: Carriers
    misfit: float  # of a table of moduli to the series that stands for it, relatively
    plan: LayerPlan

    @property
    def reduced(self) -> Array:
        """Velocities times a_T, flat [m/s]."""
        return self.points.reduced.reshape(-1)


def cylinder_plan(call: SmoothCall) -> LayerPlan:
    """What is computed. Raises `InputError` for what has no meaning."""
    return _check(call).plan


def cylinder_on_layer(call: SmoothCall) -> OnLayer:
    """Checks, solves and packs. Raises `InputError` for what has no meaning."""
    scene = _check(call)
    contacts, sunk = _solve(scene)
    points, shape = scene.points, scene.shape
    if not points.traced:
        _say(contacts, sunk, scene.body, shape, call.rtol)
    solution = Solved(
        contacts.mu,
        contacts.error,
        _left_out(contacts, scene),
        contacts.load * shape.length,
        contacts.depth,
        contacts.leading,
        -contacts.trailing,
        contacts.good,
    )
    return report_on_layer(points, solution, scene.body, shape, scene.plan)


def _check(call: SmoothCall) -> _CylinderScene:
    shape, body = _cylinder(call), _checked_body(call)
    check_rtol(call.rtol)
    layers = isinstance(body, Layer)
    points = steady_scene(body, shape, call.asked)
    if layers:
        _not_too_deep(body, points)
    name = describe(shape).replace(" on a layer", "")
    carriers, misfit = body, 0.0
    if not points.traced or _has_table(body):
        carriers, misfit = _covers(body, points.reduced.reshape(-1))
    label = ON_LAYER if layers else ON_HALF_SPACE
    label += "" if getattr(body, "softening", None) is None else LINEAR
    terms = f"{_FIRST} and {_ORDERS[1]}, up to {_ORDERS[-1]} where they disagree"
    times = _branches(carriers)
    branches = f"{times} retardation times, each exact" if times else "none: elastic"
    plan = LayerPlan(
        call.quantity,
        f"{name} on {body.name or ('a layer' if layers else 'a half-space')}",
        label,
        points.name,
        int(np.prod(points.shape)),
        float(call.rtol),
        tuple(("cover", cover) for cover in covers_in_words(body)),
        (
            ("pressure", f"Chebyshev polynomials, {terms}; both edges follow"),
            ("branches", branches),
            ("directions", "one: plane strain"),
            ("not needed", "history, since the motion is steady; elements of a line"),
        ),
    )
    return _CylinderScene(points, body, shape, carriers, misfit, plan)


def _solve(scene: _CylinderScene) -> tuple[_Contacts, Array]:
    """The contacts, and which would sink into the ground under the layer."""
    points, carriers, plan = scene.points, scene.carriers, scene.plan
    layers, by_depth = isinstance(scene.body, Layer), plan.control == "depth"
    wanted = points.at_reference()
    wanted = wanted if by_depth else wanted / scene.shape.length
    radius = scene.shape.radius
    if points.traced:
        dashpot = _begins_with_dashpot(known(stop_gradient(carriers)))
        solve = _with_slopes(layers, by_depth, dashpot, plan.rtol, scene.misfit)
        contacts = solve(*as_doubles(((carriers, radius), (wanted, scene.reduced))))
        contacts = contacts._replace(good=contacts.good > 0)
    else:
        assert isinstance(carriers, tuple)  # a body only while JAX traces
        flat = Cylinders(radius, carriers, scene.reduced)
        contacts = _refined(flat, wanted, by_depth, plan.rtol, scene.misfit)
    sunk = xp.zeros(wanted.shape, bool)
    if isinstance(scene.body, Layer) and not by_depth:
        sunk = ~(contacts.depth < scene.body.whole) & xp.isfinite(contacts.depth)
        contacts = contacts._replace(good=contacts.good & ~sunk)
    return contacts, sunk


def _cylinder(call: SmoothCall) -> Cylinder:
    """The body, which is known to be one where a call comes here."""
    assert isinstance(call.shape, Cylinder)
    return call.shape


def _checked_body(call: SmoothCall) -> Body:
    """The layer, or the half-space by its law. Raises `InputError`."""
    material, depth = call.material, call.asked.depth
    of_layer(call.model, call.quantity, call.shape.label)  # all lines are exact
    body = material if isinstance(material, Layer) else surface_foundation(material)
    if depth is not None and not isinstance(body, Layer):
        raise InputError(
            argument="depth",
            got=depth,
            accepted="left out for a cylinder on a half-space, where it has no meaning "
            "in plane strain (it grows with the logarithm of the distance from which "
            "it is counted)",
            hint="give load, or an em.layer",
        )
    return body


def _covers(body: Body, reduced: Array) -> tuple[tuple[Cover, ...], float]:
    """What carries the pressure, and how far a Prony series is from a table of moduli,
    relatively.
    """
    if isinstance(body, Layer):
        covers = [_cover(layer, reduced) for layer in body.covers]
        return tuple(cover for cover, _ in covers), max(off for _, off in covers)
    if isinstance(body, TabulatedFoundation):
        chain, off = to_chain(body)
        return (Cover(chain),), off
    law = body.law()
    if certain(lambda x: x == 0, law.equilibrium):
        raise InputError(
            argument="material",
            accepted="a solid with an equilibrium modulus under a cylinder on a "
            "half-space",
            hint="in plane strain it sinks into a liquid without end; give an em.layer",
        )
    return (Cover(to_kelvin(law)),), 0.0


def _cover(layer: Layer, reduced: Array) -> tuple[Cover, float]:
    material = layer.material
    if isinstance(material, TabulatedModulus):
        table: Any = surface_foundation(material)
        chain, off = to_chain(table)
        squeeze = 1 - 2 * material.poisson
        return Cover(chain, layer.thickness, squeeze, bonded=layer.bonded), off
    solid = _solid(material.shear(), layer, reduced)
    chain = to_kelvin(normal_operator(solid))
    if material.bulk is None:
        return Cover(chain, layer.thickness, layer.squeeze(), bonded=layer.bonded), 0.0
    bulk = material.bulk
    return Cover(chain, layer.thickness, None, solid.law(), bulk, layer.bonded), 0.0


def _solid(shear: Prony, layer: Layer, reduced: Array) -> Prony:
    """A liquid with so small an equilibrium modulus that it flows like one as long as
    it matters.
    """
    if certain(lambda x: x > 0, shear.equilibrium):
        return shear
    flow = shear.viscosity + xp.sum(shear.moduli * shear.times)
    little = flow * xp.min(reduced) / (_FLOWING * layer.thickness)
    relaxed = xp.where(shear.equilibrium > 0, shear.equilibrium, little)
    return replaced(shear, equilibrium=relaxed)


def _materials(body: Body) -> list[Any]:
    return [x.material for x in body.covers] if isinstance(body, Layer) else [body]


def _has_table(body: Body) -> bool:
    tables = TabulatedModulus, TabulatedFoundation
    return any(isinstance(material, tables) for material in _materials(body))


def _branches(carriers: Carriers) -> int:
    """How many retardation times there are; of a body whose values are traced, how
    many relaxation times.
    """
    if isinstance(carriers, tuple):
        return sum(int(np.shape(cover.chain.times)[0]) for cover in carriers)
    return sum(int(np.shape(x.times)[0]) for x in _materials(carriers))


def _begins_with_dashpot(carriers: Carriers) -> bool:
    """Whether none of them gives way at once; False where that cannot be seen."""
    if isinstance(carriers, tuple):
        return all(certain(lambda x: x == 0, x.chain.instantaneous) for x in carriers)
    return all(certain(lambda x: x > 0, x.viscosity) for x in _materials(carriers))


# Under a transformation of JAX: functions of what all points share, (carriers, radius),
# and of what each has of its own: (load per length or depth, velocity).
_Shared = tuple[Carriers, Array]
_Points = tuple[Array, Array]


def _cylinders(shared: tuple[Carriers, Array], velocity: Array) -> Cylinders:
    carriers, radius = shared
    if not isinstance(carriers, tuple):
        carriers, _ = _covers(carriers, velocity)
    return Cylinders(radius, carriers, velocity)


@functools.lru_cache(64)
def _with_slopes(
    layers: bool, by_depth: bool, dashpot: bool, rtol: float, misfit: float
) -> Callable[..., _Contacts]:
    """Contacts from (load per length or depth, velocity): numbers from NumPy,
    derivatives from the equations of `_TRACED_ORDER` terms.
    """

    def numbers(shared: _Shared, points: _Points) -> _Contacts:
        wanted, velocity = points
        flat = _cylinders(shared, velocity)
        return _refined(flat, wanted, by_depth, rtol, misfit)

    def solution(shared: _Shared, points: _Points) -> tuple[Cylinders, Solution]:
        flat = _cylinders(shared, points[1])
        half = _half(by_depth, dashpot)(shared, points)
        waves = layer_waves(flat, _TRACED_RATIO)
        return flat, solve_at(flat, half, _TRACED_ORDER, waves, dashpot)

    def forces(shared: _Shared, points: _Points) -> tuple[Any, ...]:
        _, contact = solution(shared, points)
        edges = contact.shift + contact.half, contact.shift - contact.half
        return contact.mu, contact.load, *edges

    def sunk(shared: _Shared, points: _Points) -> tuple[Any, ...]:
        flat, contact = solution(shared, points)
        return (depth(flat, contact, _TRACED_ORDER),)

    def like(shared: _Shared, points: _Points) -> tuple[Any, ...]:
        return (points[0],) * len(_Contacts._fields)

    formulas = ((forces, 4), (sunk, 1)) if layers else ((forces, 4),)
    solve = numbers_with_slopes(numbers, formulas, like)
    return lambda shared, points: _Contacts(*solve(shared, points))


@functools.lru_cache(64)
def _half(by_depth: bool, dashpot: bool) -> Callable[..., Any]:
    """Half-length of the contact from (load per length or depth, velocity)."""

    @one_thread()
    def search(shared: _Shared, points: _Points) -> tuple[Any, None]:
        wanted, velocity = points
        flat = _cylinders(shared, velocity)
        waves = layer_waves(flat, _TRACED_RATIO)
        guess = _guess(flat, wanted, by_depth)
        half, _ = half_of(flat, wanted, by_depth, dashpot, waves, guess, _TRACED_ORDER)
        if waves is not None:
            served = 1.02 * _TRACED_RATIO * waves.thickness
            half = np.where(half < served, half, np.nan)
        return half, None

    def equation(half: Array, _: None, shared: _Shared, points: _Points) -> Any:
        wanted, velocity = points
        flat = _cylinders(shared, velocity)
        waves = layer_waves(flat, _TRACED_RATIO)
        contact = solve_at(flat, half, _TRACED_ORDER, waves, dashpot)
        value = depth(flat, contact, _TRACED_ORDER) if by_depth else contact.load
        return value - wanted

    return implicit(search, equation, lambda _, points: (points[0], None))


def _guess(flat: Cylinders, wanted: Array, by_depth: bool) -> Array:
    """Half-lengths of about the right size: of an elastic half-plane as stiff as the
    passage is fast and short.
    """
    if by_depth:
        return np.sqrt(2 * flat.radius * wanted)
    half = np.full_like(wanted, 1e-3)
    for _ in range(12):
        k = _TYPICAL / half
        omega = flat.velocity / half
        parts = [
            c.of_kernel(layer_kernel, k, omega) if flat.on_layers else c.creep(omega)
            for c in flat.covers
        ]
        softness = sum(compliance[0] for compliance in parts)
        half = np.sqrt(half * np.sqrt(4 * wanted * flat.radius / math.pi * softness))
    return half


class _Level(NamedTuple):
    """What one order of the pressure gives."""

    half: Array  # NaN where none was found
    contact: Solution


class _Search(NamedTuple):
    """Points to be solved, and where their contacts are sought."""

    flat: Cylinders
    wanted: Array
    by_depth: bool
    dashpot: bool
    waves: LayerWaves | None
    guess: Array  # half-length [m]

    def at(self, points: Array) -> _Search:
        """Those of the points that are listed or marked."""
        waves = self.waves
        if waves is not None:
            real, imaginary = waves.real[points], waves.imaginary[points]
            waves = replaced(waves, real=real, imaginary=imaginary)
        return self._replace(
            flat=replaced(self.flat, velocity=self.flat.velocity[points]),
            wanted=self.wanted[points],
            waves=waves,
            guess=self.guess[points],
        )


def _level(search: _Search, order: int) -> _Level:
    half, contact = half_of(*search, order)
    waves = search.waves
    if waves is not None:
        half = np.where(half < 1.02 * waves.ratio * waves.thickness, half, np.nan)
    return _Level(half, contact)


def _judge(search: _Search, order: int, level: _Level, change: Array) -> _Contacts:
    """A level as a result; `change` is how much of the change of mu from the order
    before may be left in this one.
    """
    flat, (half, contact) = search.flat, level
    reached = np.isfinite(half)
    pulled, deep = pull(contact, order, search.dashpot), half * np.nan
    good = reached & np.isfinite(contact.mu) & (pulled < _NEGATIVE)
    # a small part of the load that pulls, at an edge
    error = change + _ROUNDING * np.abs(contact.mu)
    error = error + (pulled + 1e-15) * half / flat.radius
    if flat.on_layers:
        deep, gap = depth_and_gap(flat, contact, order)
        overlap = np.maximum(-gap, 0.0)
        good = good & (overlap < _NEGATIVE)
        error = error + overlap * np.abs(contact.mu)
    return _Contacts(
        mu=contact.mu,
        load=contact.load,
        leading=contact.shift + half,
        trailing=contact.shift - half,
        depth=deep,
        error=error,
        good=good,
    )


@one_thread()
def _refined(
    flat: Cylinders, wanted: Array, by_depth: bool, rtol: float, misfit: float
) -> _Contacts:
    """Points by more and more terms until their error is below `rtol`; numbers only.

    `misfit` is how far a Prony series is from a table of moduli, relatively.
    """
    blocks = [slice(i, i + _AT_ONCE) for i in range(0, wanted.size, _AT_ONCE)]
    parts = [
        _block(replaced(flat, velocity=flat.velocity[i]), wanted[i], by_depth, rtol)
        for i in blocks
    ]
    contacts = _Contacts(*(np.concatenate(x) for x in zip(*parts, strict=True)))
    good = (contacts.good == 1) & _met(contacts, max(rtol, _FLOOR), flat.radius)
    return contacts._replace(
        error=contacts.error + misfit * np.abs(contacts.mu), good=good
    )


def _block(flat: Cylinders, wanted: Array, by_depth: bool, rtol: float) -> _Contacts:
    guess = _guess(flat, wanted, by_depth)
    result = _Contacts(*(np.full(wanted.shape, np.nan) for _ in _Contacts._fields))
    left, ratio, thick = np.arange(wanted.size), 0.0, 1.0
    if flat.on_layers:
        thick = min(float(cover.thickness) for cover in flat.covers)
        left = left[guess / thick < _WIDEST]
        ratio = _ladder(float(np.max(guess[left], initial=0.0)) / thick)
    for wider in (1.0, 2.0):  # than guessed, perhaps
        if left.size == 0:
            break
        unsolved = replaced(flat, velocity=flat.velocity[left])
        waves = layer_waves(unsolved, wider * ratio)
        dashpot = _begins_with_dashpot(flat.covers)
        search = _Search(unsolved, wanted[left], by_depth, dashpot, waves, guess[left])
        contacts = _by_orders(search, rtol)
        for field, values in zip(result, contacts, strict=True):
            field[left] = values
        if not flat.on_layers:
            break
        left = left[contacts.good == 0]
    return result


def _by_orders(search: _Search, rtol: float) -> _Contacts:
    """The points at once, by orders of which each begins where the one before ended."""
    result = _Contacts(
        *(np.full(search.wanted.shape, np.nan) for _ in _Contacts._fields)
    )
    left = np.arange(search.wanted.size)
    level = _level(search, _FIRST)
    orders = (_FIRST, *_ORDERS[0 if rtol >= _COARSE else 1 :])
    for lower, order in itertools.pairwise(orders):
        reached = np.isfinite(level.half)
        before = np.where(reached, level.contact.mu, np.nan)
        guess = np.where(reached, level.half, search.guess)
        search = search._replace(guess=guess)
        level = _level(search, order)
        change = np.abs(level.contact.mu - before) / ((order / lower) ** _POWER - 1)
        contacts = _judge(search, order, level, change)
        for field, values in zip(result, contacts, strict=True):
            field[left] = values
        more = ~((contacts.good == 1) & _met(contacts, rtol, search.flat.radius))
        if not more.any():
            break
        left, search = left[more], search.at(more)
        level = _Level(level.half[more], Solution(*(x[more] for x in level.contact)))
    return result


def _met(contacts: _Contacts, rtol: float, radius: Array) -> Array:
    """Whether the error is below what was asked for, or mu is nothing but rounding, as
    of elastic bodies.
    """
    return (
        contacts.error
        <= rtol * np.abs(contacts.mu)
        + _NOTHING * (contacts.leading - contacts.trailing) / radius
    )


def _ladder(ratio: float) -> float:
    """The next of few values, for which rules of integration are kept."""
    return 1.25 ** math.ceil(math.log(max(1.1 * ratio, 0.4)) / math.log(1.25))


def _not_too_deep(layer: Layer, points: SteadyScene) -> None:
    """Refuses a dent as deep as the layer is thick. Raises `InputError`."""
    if points.name == "depth" and not points.traced:
        thick = float(layer.whole)
        require(
            "depth",
            points.value,
            f"below {thick:.4g} m, the thickness of the layer",
            lambda d: d < thick,
        )


def _left_out(contacts: _Contacts, scene: _CylinderScene) -> Array:
    """How much the ends of the cylinder change mu at most under a given load, on a
    layer that goes on beyond them: (3a/2 + 3h/8)/L of it, above what cells in three
    dimensions give (`docs/accuracy.md`); NaN where none were computed.
    """
    body, share = scene.body, contacts.mu * np.nan
    linear = body.softening is None and scene.plan.control == "load"
    if isinstance(body, Layer) and body.other is None and body.constant and linear:
        half, h = 0.5 * (contacts.leading - contacts.trailing), body.thickness
        share = 1.5 * (half + _AROUND * h) / scene.shape.length
        told = (half > _CELLS[0] * h) & (half < _CELLS[1] * h) & (share < _MOST)
        share = xp.where(told, share, np.nan)
    return share * xp.abs(contacts.mu)


def _say(
    contacts: _Contacts, sunk: Array, body: Body, shape: Cylinder, rtol: float
) -> None:
    """Warns of points that failed, and of a cylinder that is too short to be plane."""
    if not contacts.good.all():
        thick = body.whole if isinstance(body, Layer) else np.inf
        small = nearly(contacts.good, contacts.error, contacts.mu, rtol)
        reasons = too_deep(sunk, thick), small
        why = " ".join(filter(None, reasons))
        warn_unless(contacts.good, "points", f" to rtol={rtol:g}", why)
    half = 0.5 * (contacts.leading - contacts.trailing)
    if not contacts.good.any():
        return
    widest, length = float(half[contacts.good].max()), float(shape.length)
    if length < _ENDS * widest:
        warn(
            f"The cylinder, {1e3 * length:.4g} mm long, is only "
            f"{significant(length / widest, 2)} times as long as half the contact is "
            f"wide ({1e3 * widest:.4g} mm). Plane strain leaves its ends out: over "
            "about that "
            "distance from each end the rubber moves aside, so that the same load "
            "needs more depth, and the pressure there is not that of the middle.",
            ModelWarning,
        )


def _separable(body: Body) -> Any:
    """The law of a body whose branches can be told from each other. Raises
    `InputError`.
    """
    if isinstance(body, TabulatedFoundation) or isinstance(
        getattr(body, "material", None), TabulatedModulus
    ):
        raise InputError(
            argument="material",
            got=body,
            accepted="a series, em.Prony, to tell its branches from each other",
        )
    if isinstance(body, Layer) and (body.other is not None or not body.constant):
        raise InputError(
            argument="material",
            got=body,
            accepted="one layer with a constant Poisson's ratio, whose branches lose "
            "in proportion to their loss moduli",
        )
    law = body.normal() if isinstance(body, Layer) else body.law()
    if float(law.viscosity) > 0 or not float(law.equilibrium) > 0:
        raise InputError(
            argument="material",
            got=body,
            accepted="a solid without a parallel dashpot to separate its branches on a "
            "layer",
        )
    if not law.moduli.size:
        raise InputError(
            argument="material",
            got=body,
            accepted="one with a relaxation time",
            hint="an elastic one dissipates nothing",
        )
    return law


def cylinder_losses(call: SmoothCall) -> tuple[OnLayer, Any, Any]:
    """The rolling cylinder, the resistance [N/m] of each branch at each point, and the
    times of the branches [s].

    Raises `InputError` for what `losses` does not separate.
    """
    body = _checked_body(call)
    numbers_only({"material": body, "shape": call.shape, **vars(call.asked)})
    law = _separable(body)
    rolled, points, solution = cylinder_pressure(call)
    (cover,), _ = _covers(body, np.asarray(points.reduced))
    speed, converged = (
        np.asarray(points.reduced).reshape(-1),
        np.ravel(rolled.steady.converged),
    )
    each = np.where(
        converged,
        losses(speed, law, cover, solution) * np.asarray(points.vertical).reshape(-1),
        np.nan,
    )
    factor = np.asarray(points.reduced) / np.asarray(
        points.full(points.velocity)
    ).reshape(np.shape(points.reduced))
    return (
        rolled,
        each.reshape(-1, *points.shape),
        law.times * factor.reshape(*points.shape, 1),
    )


def cylinder_pressure(call: SmoothCall) -> tuple[OnLayer, SteadyScene, Solution]:
    """The rolling cylinder, its points, and the contact of each with the terms of its
    pressure; numbers.
    """
    # of the half-length, at which more terms are taken below, is known less than of mu
    rtol = min(float(call.rtol), _LOSS_RTOL)
    rolled = cylinder_on_layer(dataclasses.replace(call, rtol=rtol))
    body, shape = _checked_body(call), _cylinder(call)
    points = steady_scene(body, shape, call.asked)
    covers, _ = _covers(body, np.asarray(points.reduced))
    contact = rolled.steady.contact
    half = np.nan_to_num(0.5 * np.ravel(contact.leading + contact.trailing), nan=1e-3)
    flat = Cylinders(
        np.asarray(shape.radius), covers, np.asarray(points.reduced).reshape(-1)
    )
    ratio = 0.0
    if flat.on_layers:
        ratio = _ladder(
            float(
                half.max() / min(float(np.asarray(cover.thickness)) for cover in covers)
            )
        )
    with one_thread():
        return (
            rolled,
            points,
            solve_at(flat, half, _LOSS_ORDER, layer_waves(flat, ratio), False),
        )
