"""Tangential loading of a contact with friction: partial slip, fretting loops,
frictional damping.
"""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import arrays, fixed, on_jax, on_numpy, xp
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    as_float64,
    finite,
    is_traced,
    known,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    only_one,
    require,
    scalar,
)
from ..element.law import Foundation
from ..errors import ConvergenceWarning, InputError
from ..material.relaxation import Relaxation, to_kelvin
from ..material.validity import shared
from ..numerics.quadrature import gauss_unit
from ..numerics.root import bisect
from ..results.words import brief, describe
from ..surface.disc import contact_measure, disc_under
from ..surface.shapes import AbstractShape, FlatPunch
from .age import history_beyond
from .history_result import Shear
from .impact import _standing
from .refinement import beside
from .shear_motion import History, Scene, Sheared, line, panels, shear_history
from .tangential_law import both_laws

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials

HALF_SPACE = "MDR with Coulomb friction, element by element (Cattaneo-Mindlin)"
LAYER = "independent springs with Coulomb friction"
# instants put between the first two: down to 1e-12 of the time between them
_EARLY = 18
# of the largest force: the edges between which elements are summed are not known to
# rounding
_EDGES = 1e-11
_ROUNDING = 1e-14
# parts between two instants under a load that changes, at most, and instants with them
_BETWEEN, _INSTANTS = 64, 512
# elements times steps times branches that NumPy takes seconds for, as JAX does to
# compile them
_MUCH = 3e7
# elements, and contact steps between two instants
_ELASTIC, _VISCOELASTIC = (200_000, 1), (2_000, 16)


@over_materials
@numpy_unless_traced
def shear(
    material: Materials,
    shape: Indenter,
    *,
    time: ArrayLike,
    displacement: ArrayLike,
    friction: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    tangential: Foundation | None = None,
    elements: int | None = None,
    steps: int | None = None,
) -> Shear:
    """Tangential force of a body in frictional contact, for any history of normal and
    tangential motion.

    All histories are linear between the instants. Load and displacement of the first
    instant are put on at once, the load first. Stick or slip is decided element by
    element.

    Args:
        material: a material (then a half-space of it), or a `Foundation` of E* (then
            give `tangential`).
        shape: the body, such as `em.Sphere`.
        time: instants [s], ascending, shape (n,).
        displacement: tangential displacement of the body [m], shape (n,).
        friction: Coulomb's coefficient, zero and infinity included.
        load: normal force [N], a number or one for each instant.
        depth: depth [m] in place of a load, likewise; below zero above the surface.
        tangential: the `Foundation` of G*; it follows from a material.
        elements: elements over the radius of the contact; by default 200,000 for an
            elastic contact, 2,000 else.
        steps: steps between two instants; by default 1 for an elastic contact, 16 else.

    Returns:
        An `em.Shear` with one value for each instant. `error` is that of the force: the
        difference to half the steps, or between two rules of summation where all is
        elastic, and a bound on what a sum over even elements misses. An instant at
        which the contact is wider than the body or the grid is NaN with
        `converged=False`.

    Raises:
        InputError: for what has no meaning, such as a dashpot that is to follow a
            sudden depth.

    Exact for elastic bodies on straight paths in (depth, displacement); otherwise of
    second order in the steps. Where load and displacement of an elastic contact change
    at once, `work` and `slip_loss` are of second order in the time between two
    instants; the force is exact. Normal and tangential loading do not influence each
    other otherwise, which is exact for equal bodies, or for an incompressible one on a
    rigid one. Differentiable in moduli, times, shape, friction, load, depth and
    displacement.

    Source: Cattaneo 1938; Mindlin 1949; Popov & Hess 2015, ch. 5.
    """
    normal, tangential = both_laws(material, tangential)
    if not isinstance(shape, AbstractShape):
        raise InputError(
            "shape must be an em.Sphere, em.Cone, em.Profile, em.Cylinder or the "
            f"like, got {shape!r}."
        )
    per_area = _standing([normal], shape)
    name = only_one(load=load, depth=depth)
    time, displacement = (
        as_float64("time", time),
        as_float64("displacement", displacement),
    )
    value, mu = (
        as_float64(name, depth if load is None else load),
        scalar("friction", friction),
    )
    if depth is None:
        not_negative(name, value)
    else:
        finite(name, value)
    finite("displacement", displacement)
    require("friction", mu, "zero or positive, infinity included", lambda x: x >= 0)
    if time.ndim != 1 or time.shape[0] < 2:
        raise InputError(
            "time must be a list of two instants or more, got an array of shape "
            f"{time.shape}."
        )
    if not is_traced(time) and not (np.diff(time) > 0).all():
        raise InputError("time must be ascending, without repeats.")
    traced = is_traced(normal, tangential, shape, time, displacement, value, mu)
    numpy: Any = xp if traced else np
    try:
        full: list[Array] = [
            numpy.broadcast_to(x, time.shape) for x in (value, displacement)
        ]
        value, displacement = full
    except ValueError as error:
        raise InputError(
            f"displacement and {name} must be single numbers or as long as time "
            f"({time.shape[0]}), got shapes {np.shape(displacement)} and "
            f"{np.shape(value)}."
        ) from error
    laws = normal.law(), tangential.law()
    seen = not is_traced(laws)
    dashpots = seen and any(float(law.viscosity) > 0 for law in laws)
    if (
        dashpots
        and not is_traced(value, displacement)
        and (displacement[0] != 0 or (load is None and value[0] > 0))
    ):
        what = "displacement" if displacement[0] != 0 else name
        raise InputError(
            f"{what} must be 0 at the first instant, since a dashpot cannot follow a "
            f"sudden motion, got {float(displacement[0] or value[0]):g}."
        )
    elastic = seen and not dashpots and all(law.moduli.size == 0 for law in laws)
    usual, exact = (
        _ELASTIC if elastic else _VISCOELASTIC,
        elastic and elements is None and steps is None,
    )
    elements, steps = (
        _count("elements", elements, usual[0]),
        _count("steps", steps, usual[1]),
    )
    reach = _reach(shape, laws[0], per_area, name, value, time, elements)
    scene = Scene(shape, laws[0], laws[1], mu, reach)
    scene, history = _with_arrays(scene), History(time, value, displacement)
    between = 1
    if not elastic:
        history = _with_early_instants(history)
    elif (
        load is not None
        and not is_traced(history)
        and (np.diff(value) * np.diff(displacement) != 0).any()
    ):
        between = max(1, min(_BETWEEN, _INSTANTS // time.shape[0]))
        history = _divided(history, between)
    options = {"by_load": load is not None}
    found = _marched(
        scene, history, elements, per_area, steps=steps, used=steps, **options
    )
    numpy = xp if is_traced(found) else np
    if exact:
        found, error = _summed(scene, history, found, per_area, **options)
    else:
        fewer, half = (
            (elements // 2, steps) if elastic or steps == 1 else (elements, steps // 2)
        )
        coarse = _marched(
            scene, history, fewer, per_area, steps=steps, used=half, **options
        )
        # What is left of a force that has faded is the difference of what was carried
        # before.
        force = fixed(abs(found.force)) if is_traced(found) else abs(found.force)
        largest = _so_far(force)
        change = (
            abs(found.force - coarse.force)
            if elastic
            else 2 * beside(abs(found.force - coarse.force))
        )
        error = change + found.missed + _ROUNDING * largest
    instants = found.force.shape[0]
    chosen = np.append(0, np.arange(between, instants, between)[1 - time.shape[0] :])
    found, error = type(found)(*(x[chosen] for x in found)), error[chosen]
    inside = (
        found.contact_radius <= reach * (1 - 0.25 / elements)
        if not isinstance(shape, FlatPunch)
        else True
    )
    good = numpy.isfinite(found.force) & numpy.isfinite(found.normal_force) & inside
    if not is_traced(good) and not np.all(good):
        text = "the contact is wider than the body or the grid, and they are NaN"
        warnings.warn(
            f"{int((~good).sum())} of {good.size} instants: {text}.",
            ConvergenceWarning,
            stacklevel=3,
        )
    found = type(found)(*(nan_unless(good, x) for x in found))
    inputs = [("material", normal.name or "given directly"), ("shape", describe(shape))]
    inputs += [
        (name, brief(value, "N" if name == "load" else "m")),
        ("displacement", brief(displacement, "m")),
    ]
    inputs += [
        ("time", brief(time, "s")),
        ("friction coefficient", f"{float(mu):g}" if not is_traced(mu) else "traced"),
    ]
    inputs.append(
        (
            "elements and steps",
            f"{elements} on a half line, {steps} between two instants",
        )
    )
    measured = shared(normal.range, tangential.range)
    # else nothing happens at the first instant
    moved = is_traced(displacement) or bool(displacement[0] != 0)
    beyond = history_beyond(
        measured, time, value, None, 1.0, slid=displacement, at_once=moved, stacklevel=3
    )
    return Shear(
        time=time,
        displacement=displacement,
        **{name: value for name, value in found._asdict().items() if name != "missed"},
        error=nan_unless(good, error),
        converged=good,
        model=LAYER if per_area else HALF_SPACE,
        plan="marched element by element",
        inputs=(*inputs, *beyond.said),
        extrapolated=beyond.points,
    )


def _marched(
    scene: Scene,
    history: History,
    elements: int,
    per_area: bool,
    *,
    steps: int,
    **options: Any,
) -> Sheared:
    """The history of `elements` equal elements."""
    branches = max(law.moduli.shape[0] for law in (scene.normal, scene.tangential))
    work = elements * steps * history.time.shape[0] * (1 + branches)
    if on_numpy() and work > _MUCH:
        return on_jax(
            _by_elements, scene, history, elements, per_area, steps=steps, **options
        )
    return _by_elements(scene, history, elements, per_area, steps=steps, **options)


def _by_elements(
    scene: Scene, history: History, elements: int, per_area: bool, **options: Any
) -> Sheared:
    scene, history = arrays((scene, history))
    return known(
        shear_history(scene, history, line(scene, elements, per_area), **options)
    )


def _so_far(x: Any) -> Any:
    """The largest entry up to each."""
    if not is_traced(x):
        return np.maximum.accumulate(x)
    import jax

    return jax.lax.cummax(x)


def _summed(
    scene: Scene, history: History, found: Sheared, per_area: bool, *, by_load: bool
) -> tuple[Sheared, Any]:
    """An elastic contact summed by Gauss' rule between the edges of stick and contact
    in `found`, and the error of F_x.

    The error is the difference of two rules. Where that is not less than their distance
    from `found`, something other than those edges is not smooth (the points of a
    profile, say); `found` stays, with that distance as its error.
    """
    numpy = xp if is_traced(found) else np
    radii = numpy.concatenate([found.contact_radius, found.stick_radius])
    rules = [
        panels(scene, radii, parts, nodes, per_area)
        for parts, nodes in ((4, 6), (6, 4))
    ]
    best, other = (
        known(shear_history(scene, history, rule, steps=1, by_load=by_load))
        for rule in rules
    )
    best = best._replace(
        contact_radius=found.contact_radius, stick_radius=found.stick_radius
    )
    error, distance = abs(best.force - other.force), abs(found.force - best.force)
    better = numpy.max(error) <= numpy.max(distance)
    error = error + _EDGES * numpy.max(abs(best.force))
    both = zip(best, found, strict=True)
    return Sheared(*(numpy.where(better, a, b) for a, b in both)), numpy.where(
        better, error, distance + found.missed
    )


def _with_early_instants(history: History) -> History:
    """More instants after the first, ever closer to it: what is put on at once relaxes
    on all time scales.
    """
    (t0, t1), (v0, v1), (s0, s1) = (x[:2] for x in history)
    numpy, part = xp if is_traced(history) else np, 0.2 ** np.arange(_EARLY, 0, -1)
    more = t0 + part * (t1 - t0), v0 + part * (v1 - v0), s0 + part * (s1 - s0)
    return History(
        *(
            numpy.concatenate([x[:1], m, x[1:]])
            for x, m in zip(history, more, strict=True)
        )
    )


def _divided(history: History, parts: int) -> History:
    """More instants, evenly between those given."""
    numpy, part = xp if is_traced(history) else np, np.arange(1, parts + 1) / parts

    def fill(x: Any) -> Any:
        return numpy.concatenate(
            [x[:1], (x[:-1, None] + numpy.diff(x)[:, None] * part).reshape(-1)]
        )

    return History(*map(fill, history))


def _count(name: str, given: Any, usual: int) -> int:
    if given is None:
        return usual
    if (
        isinstance(given, bool)
        or not isinstance(given, (int, np.integer))
        or given < (2 if name == "elements" else 1)
    ):
        raise InputError(f"{name} must be a positive whole number, got {given!r}.")
    return int(given)


def _with_arrays(scene: Scene) -> Scene:
    law, other = (
        [xp.asarray(x) for x in (a.equilibrium, a.moduli, a.times, a.viscosity)]
        for a in scene[1:3]
    )
    return Scene(
        scene.shape,
        Relaxation(*law),
        Relaxation(*other),
        xp.asarray(scene.friction),
        xp.asarray(scene.reach),
    )


def _reach(
    shape: AbstractShape,
    law: Relaxation,
    per_area: bool,
    name: str,
    value: Any,
    time: Any,
    elements: int,
) -> Any:
    """A radius [m] that the contact does not exceed: at the greatest depth, or under
    the load after the whole time.
    """
    largest = xp.max(xp.asarray(value))
    if isinstance(shape, FlatPunch):
        return xp.asarray(shape.radius)
    if name == "load":
        largest = _elastic_depth(
            shape, per_area, largest * _creep(law, time[-1] - time[0])
        )
    largest = xp.where(largest > 0, largest, 1e-9)
    reach = disc_under(shape, per_area).radius_of_depth(largest)
    limit = xp.asarray(shape.largest_contact)
    return xp.minimum(
        xp.where(xp.isnan(reach), limit, reach * elements / max(elements - 2, 1)),
        limit * (1 - 1e-12),
    )


def _creep(law: Relaxation, span: Any) -> Any:
    chain = to_kelvin(law)
    numpy = xp if is_traced(chain, span) else np
    retarded = numpy.sum(chain.compliances * -numpy.expm1(-span / chain.times))
    return chain.instantaneous + retarded + span * chain.fluidity


def _elastic_depth(shape: AbstractShape, per_area: bool, measure: Any) -> Any:
    """Depth d with A(d) = `measure`, by bisection of its logarithm, rounded up: it is
    used as a bound.
    """
    c, w, _ = gauss_unit(24)

    def displaced(depth: Any) -> Any:
        return depth * xp.sum(
            2 * c * w * contact_measure(shape, depth * c**2, per_area)
        )

    _, high = bisect(
        lambda log_depth: displaced(xp.exp(log_depth)) < measure,
        xp.asarray(-140.0),
        xp.asarray(140.0),
        42,
    )
    return xp.exp(fixed(high))
