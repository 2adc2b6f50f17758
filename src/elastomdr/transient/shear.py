"""Tangential loading of a contact with friction: partial slip, fretting loops,
frictional damping.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import tree_map
from ..call.problem import doubt_depth
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    as_float64,
    ascending,
    finite,
    nan_unless,
    not_negative,
    numbers_only,
    numpy_unless_traced,
    only_one,
    require,
    scalar,
    warn_unless,
    whole_number,
)
from ..element.law import Foundation
from ..errors import InputError
from ..material.relaxation import Relaxation, to_kelvin
from ..material.validity import material_in_words, shared
from ..results.doubts import Doubt
from ..results.words import brief, describe
from ..surface.disc import disc_under
from ..surface.shapes import AbstractShape, FlatPunch, Paraboloid, Sphere
from .age import history_beyond
from .history_result import Shear
from .problem import (
    MOST_ELEMENTS,
    Bound,
    both_laws,
    bound_on,
    standing,
    unknown,
)
from .refinement import beside
from .shear_motion import Prescribed, Sheared, ShearScene, line, panels, shear_history

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials

HALF_SPACE = "MDR with Coulomb friction, element by element (Cattaneo-Mindlin)"
LAYER = "independent springs with Coulomb friction"
_INCOMPRESSIBLE = 2 / 3  # G* over E* on a rigid body
_SAME = 1e-3  # of a radius that does not change, to the width of an element
# of the largest mu F and of the largest force so far: more than a ball in three
# dimensions was off by
_OFF = 0.01, 0.04
OTHER_SHAPE = unknown("no body but a ball was compared with three dimensions", "a ball")
COUPLED = unknown(
    "normal and tangential loading influence each other unless the rubber is "
    "incompressible",
    "poisson=0.5",
)
OF_CHANGING_SIZE = unknown(
    "a viscoelastic contact whose size changes was not compared with three dimensions",
    "a depth put on at once and kept",
)
# instants put between the first two: down to 1e-12 of the time between them
_EARLY = 18
# of the largest force: the edges between which elements are summed are not known to
# rounding
_EDGES = 1e-11
_ROUNDING = 1e-14
# parts between two instants under a load that changes, at most, and instants with them
_BETWEEN, _INSTANTS = 64, 512
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
            sudden depth, and under a transformation of JAX.

    Exact for elastic bodies on straight paths in (depth, displacement); otherwise of
    second order in the steps. Where load and displacement of an elastic contact change
    at once, `work` and `slip_loss` are of second order in the time between two
    instants; the force is exact. Normal and tangential loading do not influence each
    other otherwise, which is exact for equal bodies, or for an incompressible one on a
    rigid one. Without derivatives: under `jit`, `grad` and `vmap` it is refused.

    Source: Cattaneo 1938; Mindlin 1949; Popov & Hess 2015, ch. 5.
    """
    numbers_only(
        {
            "material": material,
            "shape": shape,
            "time": time,
            "displacement": displacement,
            "friction": friction,
            "load": load,
            "depth": depth,
            "tangential": tangential,
        },
    )
    laws = both_laws(material, tangential)
    per_area = standing([laws[0]], material, shape)
    name = only_one({"load": load, "depth": depth})
    given = _check(laws, time, name, depth if load is None else load, displacement)
    mu = scalar("friction", friction)
    require("friction", mu, "zero or positive, infinity included", lambda x: x >= 0)
    exact = elements is None and steps is None and _is_elastic(laws)
    usual = _ELASTIC if _is_elastic(laws) else _VISCOELASTIC
    cut = _Cut(
        _count("elements", elements, usual[0], least=2),
        _count("steps", steps, usual[1], least=1),
        per_area,
        by_load=name == "load",
        elastic=_is_elastic(laws),
    )
    reach = _reach(shape, laws[0].law(), per_area, name, given, cut.elements)
    scene = _scene(shape, laws, mu, reach)
    sheared, error = _solve(scene, given, cut, exact)
    inside: Any = True
    if not isinstance(shape, FlatPunch):
        inside = sheared.contact_radius <= reach * (1 - 0.25 / cut.elements)
    good = np.isfinite(sheared.force) & np.isfinite(sheared.normal_force) & inside
    reason = "The contact is wider there than the body or the grid."
    warn_unless(good, "instants", reason=reason)
    beyond = _judge(laws, given)
    bound = bound_on(laws[0], shape, _of_slip(laws, shape, mu, sheared))
    fields = {key: nan_unless(good, x) for key, x in sheared._asdict().items()}
    del fields["missed"]
    deep = doubt_depth(laws[0], shape, fields["depth"])
    return Shear(
        time=given.time,
        displacement=given.displacement,
        **fields,
        error=nan_unless(good, error),
        model_error=bound.at(good),
        converged=good,
        model=LAYER if per_area else HALF_SPACE,
        plan="marched element by element",
        inputs=tuple(_inputs(laws, shape, name, given, mu, cut)),
        marks=(*beyond, *bound.marks(good), *deep),
    )


def _of_slip(
    laws: tuple[Foundation, Foundation],
    shape: AbstractShape,
    mu: Array,
    sheared: Sheared,
) -> Bound:
    """How far the force is off at most, since elements slip against the motion of the
    body only (Cattaneo, Mindlin), which a surface does not quite do.
    """
    if mu == 0:
        return Bound()
    normal, tangential = (float(law.equilibrium + law.moduli.sum()) for law in laws)
    if abs(tangential / normal - _INCOMPRESSIBLE) > 1e-3:
        return COUPLED
    if np.isinf(mu):  # all sticks
        return Bound()
    if not isinstance(shape, Paraboloid | Sphere):
        return OTHER_SHAPE
    radius = sheared.contact_radius
    if not _is_elastic(laws) and np.ptp(radius) > _SAME * radius.max():
        return OF_CHANGING_SIZE
    limit, force = mu * sheared.normal_force, abs(sheared.force)
    parts = zip((limit, force), _OFF, strict=True)
    return Bound(np.min([part * np.fmax.accumulate(x) for x, part in parts], axis=0))


def _judge(laws: tuple[Foundation, Foundation], given: Prescribed) -> tuple[Doubt, ...]:
    """Instants beyond the range of both laws."""
    moved = given.displacement
    return history_beyond(
        shared(laws[0].range, laws[1].range),
        given.time,
        given.value,
        None,
        1.0,
        slid=moved,
        # else nothing happens at the first instant
        at_once=bool(moved[0] != 0),
    )


def _inputs(
    laws: tuple[Foundation, Foundation],
    shape: AbstractShape,
    name: str,
    given: Prescribed,
    mu: Array,
    cut: _Cut,
) -> list[tuple[str, str]]:
    """What was given, in words."""
    size = f"{cut.elements} on a half line, {cut.steps} between two instants"
    return [
        *material_in_words(laws[0]),
        ("shape", describe(shape)),
        (name, brief(given.value, "N" if name == "load" else "m")),
        ("displacement", brief(given.displacement, "m")),
        ("time", brief(given.time, "s")),
        ("friction coefficient", f"{float(mu):g}"),
        ("elements and steps", size),
    ]


class _Cut(NamedTuple):
    """How a contact is cut into elements and steps."""

    elements: int  # over the radius
    steps: int  # between two instants
    per_area: bool
    by_load: bool
    elastic: bool


def _check(
    laws: tuple[Foundation, Foundation],
    time: ArrayLike,
    name: str,
    value: ArrayLike | None,
    displacement: ArrayLike,
) -> Prescribed:
    """Raises `InputError` for what is no history, or none that a dashpot can follow."""
    time = as_float64("time", time)
    value = as_float64(name, value)
    displacement = as_float64("displacement", displacement)
    if name == "load":
        not_negative(name, value)
    else:
        finite(name, value)
    finite("displacement", displacement)
    if time.ndim != 1 or time.shape[0] < 2:
        raise InputError(
            argument="time", got=time, accepted="a list of two instants or more"
        )
    ascending("time", time)
    for given, x in ((name, value), ("displacement", displacement)):
        if x.shape not in ((), (1,), time.shape):
            raise InputError(
                argument=given,
                got=x,
                accepted=f"a single number or as long as time ({time.shape[0]})",
            )
    value, displacement = (
        np.broadcast_to(x, time.shape) for x in (value, displacement)
    )
    if any(float(law.viscosity) > 0 for law in laws):
        moved = displacement[0] != 0
        if moved or (name == "depth" and value[0] > 0):
            raise InputError(
                argument="displacement" if moved else name,
                got=float(displacement[0] if moved else value[0]),
                accepted="0 at the first instant",
                hint="a dashpot cannot follow a sudden motion",
            )
    return Prescribed(time, value, displacement)


def _is_elastic(laws: tuple[Foundation, Foundation]) -> bool:
    """Whether all elements are springs, for all that is known."""
    return not any(law.moduli.size or float(law.viscosity) > 0 for law in laws)


def _turns(given: Prescribed) -> bool:
    """Whether load and displacement are known to change together between instants."""
    return bool(np.any(np.diff(given.value) * np.diff(given.displacement) != 0))


def _solve(
    scene: ShearScene, given: Prescribed, cut: _Cut, exact: bool
) -> tuple[Sheared, Array]:
    """The history at the instants given, and the error of its force."""
    history, parts = given, 1
    if not cut.elastic:
        history = _with_early_instants(given)
    elif cut.by_load and _turns(given):
        parts = max(1, min(_BETWEEN, _INSTANTS // given.time.shape[0]))
        history = _divided(given, parts)
    sheared = _marched(scene, history, cut, cut.elements, cut.steps)
    if exact:
        sheared, error = _summed(scene, history, sheared, cut)
    else:
        elements, steps = cut.elements, cut.steps // 2
        if cut.elastic or cut.steps == 1:
            elements, steps = cut.elements // 2, cut.steps
        coarse = _marched(scene, history, cut, elements, steps)
        change = abs(sheared.force - coarse.force)
        if not cut.elastic:
            change = 2 * beside(change)
        # What is left of a force that has faded is the difference of what was carried
        # before.
        force = abs(sheared.force)
        largest = np.maximum.accumulate(force)
        error = change + sheared.missed + _ROUNDING * largest
    count, instants = given.time.shape[0], sheared.force.shape[0]
    chosen = np.append(0, np.arange(parts, instants, parts)[1 - count :])
    return tree_map(lambda x: x[chosen], (sheared, error))


def _marched(
    scene: ShearScene, history: Prescribed, cut: _Cut, elements: int, steps: int
) -> Sheared:
    """The history of `elements` equal elements, in `steps` between two instants."""
    grid = line(scene, elements, cut.per_area)
    return shear_history(scene, history, grid, steps=steps, by_load=cut.by_load)


def _summed(
    scene: ShearScene, history: Prescribed, sheared: Sheared, cut: _Cut
) -> tuple[Sheared, Array]:
    """An elastic contact summed by Gauss' rule between the edges of stick and contact
    in `sheared`, and the error of F_x.

    The error is the difference of two rules. Where that is not less than their distance
    from `sheared`, something other than those edges is not smooth (the points of a
    profile, say); `sheared` stays, with that distance as its error.
    """
    radii = np.concatenate([sheared.contact_radius, sheared.stick_radius])
    rules = [
        panels(scene, radii, parts, nodes, cut.per_area)
        for parts, nodes in ((4, 6), (6, 4))
    ]
    best, other = (
        shear_history(scene, history, rule, steps=1, by_load=cut.by_load)
        for rule in rules
    )
    best = best._replace(
        contact_radius=sheared.contact_radius, stick_radius=sheared.stick_radius
    )
    error, distance = abs(best.force - other.force), abs(sheared.force - best.force)
    better = np.max(error) <= np.max(distance)
    error = error + _EDGES * np.max(abs(best.force))
    both = zip(best, sheared, strict=True)
    return Sheared(*(np.where(better, a, b) for a, b in both)), np.where(
        better, error, distance + sheared.missed
    )


def _with_early_instants(history: Prescribed) -> Prescribed:
    """More instants after the first, ever closer to it: what is put on at once relaxes
    on all time scales.
    """
    (t0, t1), (v0, v1), (s0, s1) = (x[:2] for x in history)
    fractions = 0.2 ** np.arange(_EARLY, 0, -1)
    more = (
        t0 + fractions * (t1 - t0),
        v0 + fractions * (v1 - v0),
        s0 + fractions * (s1 - s0),
    )
    return Prescribed(
        *(np.concatenate([x[:1], m, x[1:]]) for x, m in zip(history, more, strict=True))
    )


def _divided(history: Prescribed, parts: int) -> Prescribed:
    """More instants, evenly between those given."""
    fractions = np.arange(1, parts + 1) / parts

    def fill(x: Array) -> Array:
        return np.concatenate(
            [x[:1], (x[:-1, None] + np.diff(x)[:, None] * fractions).reshape(-1)]
        )

    return Prescribed(*map(fill, history))


def _count(name: str, given: int | None, usual: int, least: int) -> int:
    if given is None:
        return usual
    whole_number(name, given, least, MOST_ELEMENTS)
    return int(given)


def _scene(
    shape: AbstractShape, laws: tuple[Foundation, Foundation], mu: Array, reach: Array
) -> ShearScene:
    normal, tangential = (
        Relaxation(
            *map(np.asarray, (law.equilibrium, law.moduli, law.times, law.viscosity))
        )
        for law in laws
    )
    return ShearScene(shape, normal, tangential, np.asarray(mu), np.asarray(reach))


def _reach(
    shape: AbstractShape,
    law: Relaxation,
    per_area: bool,
    name: str,
    history: Prescribed,
    elements: int,
) -> Array:
    """A radius [m] that the contact does not exceed: at the greatest depth, or under
    the load after the whole time.
    """
    if isinstance(shape, FlatPunch):
        return np.asarray(shape.radius)
    largest, disc = np.max(history.value), disc_under(shape, per_area)
    if name == "load":
        creep = _creep(law, float(history.time[-1] - history.time[0]))
        reach = disc.radius_of_area(np.asarray(largest * creep))
    else:
        reach = disc.radius_of_depth(np.asarray(largest))
    reach = np.where(reach == 0, disc.radius_of_depth(np.asarray(1e-9)), reach)
    limit = np.asarray(shape.largest_contact)
    return np.minimum(
        np.where(np.isnan(reach), limit, reach * elements / max(elements - 2, 1)),
        limit * (1 - 1e-12),
    )


def _creep(law: Relaxation, span: float) -> float:
    """Compliance after a time [s]."""
    chain = to_kelvin(law)
    retarded = np.sum(chain.compliances * -np.expm1(-span / chain.times))
    return float(chain.instantaneous + retarded + span * chain.fluidity)
