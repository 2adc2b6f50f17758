"""Indentation under a history of depth or load."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import xp
from ..call.extrapolation import warn_of
from ..call.problem import check_rtol, doubt_depth, hint_at_metres
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast,
    certain,
    finite,
    is_traced,
    nan_unless,
    not_negative,
    numbers_only,
    numpy_unless_traced,
    representable,
    require,
    scalar,
    significant,
    warn_unless,
)
from ..element.episode import recovery_modes
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..material.validity import material_in_words
from ..results.base import Array, part, quantity, record
from ..results.doubts import Doubt
from ..results.words import brief, describe, in_words, span
from ..surface.disc import Disc
from ..surface.shapes import AbstractShape, Cylinder, Paraboloid, PowerLaw, Sphere
from .adhesive_contact import Adhesion, AdhesiveEdge
from .age import edge_beyond, history_beyond
from .history_result import AbstractHistory
from .indentation_route import DepthOrLoad, Indented, indent_under
from .layer_disc import LayerDisc, incompressible_enough, of_layer
from .press_and_pull import indent_with_adhesion
from .problem import (
    Bound,
    at_temperature,
    bound_on,
    check_shape,
    no_cylinder,
    unknown,
)
from .surface_fields import IndentedElements

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from ..call.types import Indenter, Materials

_SHOWN = 4  # histories that a summary lists one by one
# relative error from which a number is not handed out under a transformation either
_WORST = 0.1
_EVENT = 0.03  # of the force at an event, from which on that is a doubt
HALF_SPACE = (
    "MDR line (exact for the half-space: normal contact, small slopes, no friction)"
)
LARGEST = "MDR line with adhesion at the edge, as large as the rubber allows"
PULLED = "MDR line with an adhesive edge that depends on its speed"
LAYER = "independent springs (exact for them; rubber of that thickness: em.layer)"
UPPER = (
    "adhesion takes as much as the rubber can give, an upper limit",
    "em.Adhesion(work, cutoff=...)",
)
GIVEN_EDGE = ("the edge was given", 'edge="persson-brener"')
_CONTRAST = 100  # glassy over relaxed modulus from which no pull-off was compared
_PRELOAD = 3  # least depth over that of JKR that was
ADHESION = unknown(
    "adhesion acts at the very edge (JKR), where real bonds reach further",
    "em.Adhesion(work, cutoff=...), from which that is judged",
)
FINITE = (
    "rubber of finite thickness on a rigid base (exact: normal contact, small slopes, "
    "no friction)"
)


@part
class AdhesiveEvent:
    """Where an adhesive contact begins, or where it breaks; NaN where it does not, or
    where its `error` is above a tenth.
    """

    time: Array = quantity("time", "s", dims="")
    depth: Array = quantity("depth", "m", dims="")
    force: Array = quantity("force", "N", dims="")
    radius: Array = quantity("contact radius", "m", dims="")
    error: Array = quantity("estimated relative error of the force", "-", dims="")


@record
class Indentation(AbstractHistory):
    """A body pressed into a viscoelastic foundation; every field has one value per
    instant, time along the last axis.

    `work` is what the body has done on the surface, int F dd. `stored` is the elastic
    energy of the surface in contact, which a withdrawing body can in part get back.
    `dissipated` is what the material has turned into heat, computed apart from the work
    so that `work - stored - dissipated` is an audit, and `locked`, the elastic energy
    in surface that is out of contact, which turns into heat as that recovers (a renewed
    contact before that brings it back). `error` is the estimated numerical error of
    what was asked for, the force under a given depth and the depth under a given load,
    over its largest value in the history. An instant that did not converge is NaN with
    `converged=False`; heat for which the audit does not close to `rtol` of the largest
    work, under a load that falls, is NaN alone.

    With adhesion `jump_in` is the first contact, and `pull_off` where an elastic
    contact breaks, of viscoelastic rubber where the body pulled most before it came
    off. `model_error` is that of the pull. `stored`, `locked` and `dissipated` are NaN
    of viscoelastic rubber, `loop_energy` where the body stays on, both events where the
    adhesion is too weak for their `error`, in the force.

    `plot` draws depth, force and contact radius against time and the force against
    depth, on axes that are given the last alone; with `ax=None` it returns the first
    of four Axes.
    """

    depth: Array = quantity("depth", "m", "indentation depth d", shown="mm")
    force: Array = quantity("force", "N", "F, positive where it presses")
    contact_radius: Array = quantity(
        "contact radius", "m", "a; under a cylinder the half-width", shown="mm"
    )
    work: Array = quantity("work", "J", "done by the body on the surface")
    stored: Array = quantity("stored energy", "J", "elastic, of the surface in contact")
    locked: Array = quantity(
        "energy left in free surface", "J", "elastic, out of contact"
    )
    dissipated: Array = quantity("dissipated energy", "J", "with what is locked")
    error: Array = quantity(
        "estimated relative error", "-", "over the largest value in the history"
    )
    temperature: Array | None = quantity(
        "temperature", "K", "of the whole history", default=None, dims=""
    )
    # with adhesion
    edge_speed: Array | None = quantity(
        "speed of the edge", "m/s", "outwards", default=None
    )
    work_factor: Array | None = quantity(
        "work of adhesion over that at rest", "-", default=None
    )
    zone_ratio: Array | None = quantity(
        "zone of adhesion over the radius", "-", "cutoff times factor", default=None
    )
    jump_in: AdhesiveEvent | None = None  # the first contact
    pull_off: AdhesiveEvent | None = None  # where the body first comes off
    loop_energy: Array | None = quantity(
        "work in all", "J", "done by the body until it comes off", default=None, dims=""
    )
    # elements and their history, from which `pressure` follows; None with adhesion
    surface: IndentedElements | None = None

    title: ClassVar[str] = "Indentation"
    figure: ClassVar[str] = "plot_contacts.draw_indentation"
    across: ClassVar[str] = "depth"
    shows: ClassVar[str] = "force"
    error_of: ClassVar[str] = "force or depth, relative"
    relative_bound: ClassVar[bool] = True

    @numpy_unless_traced
    def pressure(self, r: ArrayLike, time: Number) -> np.ndarray:
        """Contact pressure p(r) [Pa] at radii [m] and one time [s]: of the shape of r,
        after the histories' axes.

        p(r) = -(1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx, from the force density q of
        the line (Popov & Hess 2015, ch. 3); on a layer q itself. Zero out of contact.
        """
        return self._surface(r, time, "pressure")

    @numpy_unless_traced
    def displacement(self, r: ArrayLike, time: Number) -> np.ndarray:
        """Displacement u(r) [m] of the surface, positive into the material, at radii
        [m] and one time [s].

        u(r) = (2/pi) int_0^r u(x)/sqrt(r^2 - x^2) dx, in contact and out of it: a
        contact that has ended leaves an imprint until it has recovered. On a layer u
        itself. Shapes as `pressure`.
        """
        return self._surface(r, time, "displacement")

    def _surface(self, r: Any, time: ArrayLike, field_name: str) -> np.ndarray:
        numbers_only({"r": r, "time": time, "indentation": self})
        r, time = as_float64("r", r), scalar("time", time)
        not_negative("r", r)
        if self.origins:
            return np.stack(
                [one._surface(r, time, field_name) for one in self.each_material()]
            )
        if self.surface is None:
            raise InputError(
                argument="adhesion", accepted=f"left out for {field_name}(r, time)"
            )
        return self.surface.field(
            np.asarray(self.depth), np.asarray(self.force), r, float(time), field_name
        )

    def told(self) -> str:
        """The depth under a load, the force under a depth."""
        return "depth" if "load" in dict(self.inputs) else self.shows

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Largest depth and force, and what is left at the end."""
        yield "plan", str(self.plan)
        fields = {q.key: np.atleast_1d(value) for q, value in self.fields().items()}
        last = fields["depth"].shape[-1]
        rows = {key: value.reshape(-1, last) for key, value in fields.items()}
        for i in range(min(len(rows["depth"]), _SHOWN)):
            name = f"history {i}" if len(rows["depth"]) > 1 else "result"
            yield name, _in_short({key: value[i] for key, value in rows.items()})
        if len(rows["depth"]) > _SHOWN:
            yield "...", f"and {len(rows['depth']) - _SHOWN} more histories"
        if said := self._events():
            yield "adhesion", said

    def headline(self) -> Iterator[tuple[str, str]]:
        """With what adhesion does."""
        lines = super().headline()
        kind, said = next(lines)
        yield kind, "; ".join(filter(None, (said, self._events())))
        yield from lines

    def _events(self) -> str:
        """Jump-in, pull-off and the energy of the loop, in words; "" without any."""
        if self.jump_in is None or self.pull_off is None or self.loop_energy is None:
            return ""
        said = [
            f"{name} {span(event.force, 'N')} at {span(event.time, 's')}"
            for name, event in (("jump-in", self.jump_in), ("pull-off", self.pull_off))
            if np.isfinite(event.time).any()
        ]
        if np.isfinite(self.loop_energy).any():
            said.append(f"loop energy {span(self.loop_energy, 'J')}")
        return ", ".join(said)


@over_materials
@numpy_unless_traced
def indent(
    material: Materials,
    shape: Indenter,
    *,
    time: ArrayLike,
    depth: ArrayLike | None = None,
    load: ArrayLike | None = None,
    adhesion: Adhesion | Number | None = None,
    temperature: Number | None = None,
    rtol: float = 1e-6,
) -> Indentation:
    """Indentation of a surface that remembers, under any history of depth or load:
    contact gained, lost and regained.

    Histories are linear between the given instants. At the first instant depth or load
    may be a step from zero, to which the material answers with its glassy modulus.
    Where both `depth` and `load` are given, one is NaN at each instant and the other
    rules, from the instant before up to that one.

    Args:
        material: a material (then a half-space of it), or a `Foundation` (two bodies, a
            layer).
        shape: the indenter, such as `em.Sphere`.
        time: instants [s], ascending along the last axis; leading axes are histories of
            their own.
        depth: indentation depth [m] at these instants; arguments broadcast.
        load: normal force [N] at these instants.
        adhesion: an `em.Adhesion`; loads may then be negative. A plain number is its
            work [J/m^2], with the largest pull-off that the rubber allows.
        temperature: one temperature for all [K], for a material with a shift law.
        rtol: error to be met, relative to the largest force (or depth) of the history,
            1e-2 to 1e-10.

    Returns:
        An `em.Indentation`. Instants that did not converge, and loads that adhesion
        cannot carry, are NaN with `converged=False`; one `ConvergenceWarning` counts
        them. Under `jax.jit`, `vmap` and `grad` the elements and steps under a load
            that falls are fixed: what they give is handed out, with its `error`, and
            `converged` says if that is met.

    Raises:
        InputError: for instants that do not ascend, for neither depth nor load, and for
            a step of depth on a material with a parallel dashpot.

    Exact for the half-space and for layers. A given depth, and a load under which the
    contact grows, are solved without a time step; other loads by steps of second order,
    refined until `rtol` is met. Adhesion is exact for elastic foundations (JKR). On
    viscoelastic half-spaces it is pressed and pulled in steps, held to 3 % (some .1 % as
    a rule) where `rtol` is less, and without energies (`docs/theory.md`).
    Differentiable with respect to moduli, times, geometry, time, depth and load, but
    for adhesion of viscoelastic rubber.

    Source: Lee & Radok 1960; Ting 1966; Popov & Hess 2015, ch. 7; `docs/theory.md`.
    """
    disc, foundation = contact(material, shape)
    law, law_temperature, factor = at_temperature(foundation, temperature)
    bonds = _adhesion(adhesion)
    course = _check(law, time, depth, load, pull=bonds is not None)
    rtol = check_rtol(rtol, "1e-10", "1e-2")
    _check_depth(disc, course)
    if bonds is not None:
        _check_adhesion(law, disc, bonds, adhesion)
    solution = _solve(law, disc, course, bonds, rtol)
    edge = solution.edge
    if isinstance(disc, LayerDisc):
        layer: Any = material
        incompressible_enough(layer, disc, solution.radius, solution.force)
    shown = _judge(solution, bonds is None, max(rtol, solution.held_to))
    every_time = xp.broadcast_to(course.time, solution.depth.shape)
    given_load = course.load is not None and course.depth is None
    fast = None
    if (rate := _rate_of_edge(law, bonds, solution)) is not None:
        assert edge is not None
        fast = _while_it_matters(
            edge_beyond(foundation.range, rate, factor), edge.speed, solution.radius
        )
    beyond = history_beyond(
        foundation.range,
        every_time,
        course.load if given_load else solution.depth,
        law_temperature,
        factor,
        edge=fast,
    )

    bound = bound_on(foundation, shape, Bound())
    if bonds is not None and not bound.warns:
        if not certain(lambda moduli: not moduli.any(), law.moduli):
            beyond += _beyond_table(bonds, solution)
        bound = _bound_on_edge(law, disc, bonds, solution)
        if fast is not None:
            bound = bound._replace(size=np.where(fast, np.nan, bound.size))
    if edge is not None:
        never = xp.isnan(edge.jump_in.error)[..., None]
        bound = bound._replace(size=xp.where(never, 0.0, bound.size))
        beyond += tuple(_without_end(edge, solution.stored))

    def known(field: Array) -> Any:
        return nan_unless(shown, field)

    return Indentation(
        time=every_time,
        depth=known(solution.depth),
        force=known(solution.force),
        contact_radius=known(solution.radius),
        work=known(solution.work),
        stored=known(solution.stored),
        locked=known(solution.locked),
        dissipated=known(solution.heat + solution.locked),
        error=solution.error,
        model_error=bound.at(shown),
        converged=solution.converged,
        temperature=law_temperature,
        edge_speed=None if edge is None else known(edge.speed),
        work_factor=None if edge is None else known(edge.factor),
        zone_ratio=None if edge is None else known(edge.zone),
        jump_in=None if edge is None else AdhesiveEvent(*edge.jump_in),
        pull_off=None if edge is None else AdhesiveEvent(*edge.pull_off),
        loop_energy=None if edge is None else edge.loop,
        surface=IndentedElements(law, disc, course) if bonds is None else None,
        model=_model(law, disc, bonds),
        plan=solution.plan,
        inputs=tuple(_inputs(foundation, shape, course, bonds, law_temperature, rtol)),
        marks=(
            *beyond,
            *bound.marks(shown),
            *doubt_depth(foundation, shape, known(solution.depth)),
        ),
    )


def _judge(solution: Indented, has_heat: bool, rtol: float) -> Any:
    """Warns of instants that miss `rtol`; which of them are handed out."""
    asked = f" to rtol={rtol:g}"
    warn_unless(solution.converged, "instants", asked, solution.reason)
    if has_heat:
        known_heat = ~(solution.converged & xp.isnan(xp.asarray(solution.heat)))
        warn_unless(known_heat, "values of the heat", asked)
    if not is_traced(solution.depth, solution.force):
        return solution.converged
    # Under a transformation the steps are fixed: what they give is handed out, with its
    # error.
    return solution.converged | (solution.error <= _WORST)


def _solve(
    law: Relaxation,
    disc: Disc,
    course: DepthOrLoad,
    bonds: Adhesion | None,
    rtol: float,
) -> Indented:
    modes = recovery_modes(law)
    if bonds is not None:
        return indent_with_adhesion(law, modes, disc, course, bonds, rtol)
    solution = indent_under(law, modes, disc, course, rtol)
    return _within(solution, disc) if isinstance(disc, LayerDisc) else solution


def _inputs(
    foundation: Foundation,
    shape: AbstractShape,
    course: DepthOrLoad,
    bonds: Adhesion | None,
    temperature: Array | None,
    rtol: float,
) -> list[tuple[str, str]]:
    """What was given, in words."""
    given = [
        ("time", course.time, "s"),
        ("depth", course.depth, "m"),
        ("load", course.load, "N"),
        ("work of adhesion", None if bonds is None else bonds.work, "J/m^2"),
        ("temperature", temperature, "K"),
    ]
    return [
        *material_in_words(foundation),
        ("shape", describe(shape)),
        *(
            (name, brief(value, unit))
            for name, value, unit in given
            if value is not None
        ),
        ("relative tolerance", f"{rtol:g}"),
    ]


def _check_depth(disc: Disc, course: DepthOrLoad) -> None:
    """Raises `InputError` for depths beyond what body or layer have."""
    if course.depth is None or is_traced(disc, course.depth):
        return
    depth = np.nan_to_num(course.depth)
    if not disc.flat:
        deepest = _deepest(disc)
        accepted = (
            f"below {deepest:.4g} m, where the contact reaches the end of the profile"
        )
        require("depth", depth, accepted, lambda d: d < deepest)
    if isinstance(disc, LayerDisc):
        h = float(disc.thickness)
        accepted = f"below the thickness of the layer, {h:.4g} m"
        require("depth", depth, accepted, lambda d: d < h)


@numpy_unless_traced
def _deepest(disc: Disc) -> float:
    """Depth [m] at which the contact reaches the end of the profile, on NumPy where JAX
    traces the material only.
    """
    return float(disc.profile(disc.largest)) if np.isfinite(disc.largest) else np.inf


def _model(law: Relaxation, disc: Disc, bonds: Adhesion | None) -> str:
    if isinstance(disc, LayerDisc):
        return FINITE
    base = HALF_SPACE if disc.kind == "half-space" else LAYER
    if bonds is None:
        return base
    if law.moduli.shape[0] == 0 or (not is_traced(law) and not law.moduli.any()):
        return base.replace("exact", "JKR adhesion, exact", 1)
    return PULLED if bonds.edge != "glassy" else LARGEST


def _within(solution: Indented, disc: LayerDisc) -> Indented:
    """Instants at which the body is less deep than the layer is thick; no small strain
    gives an answer beyond.
    """
    deep = xp.asarray(solution.depth) >= disc.thickness
    reason = solution.reason
    if not is_traced(deep) and deep.any():
        h = float(disc.thickness)
        reason = (
            f"No depth below the thickness of the layer, {h:.4g} m, carries the load."
        )
    return solution._replace(converged=solution.converged & ~deep, reason=reason)


def contact(material: Materials, shape: AbstractShape) -> tuple[Disc, Foundation]:
    """The elements of a contact, and what they are made of. Raises `InputError` for a
    pair that does not fit.
    """
    check_shape(shape)
    hint_at_metres(shape)
    if isinstance(material, Layer):
        return of_layer(material, shape)
    foundation = as_foundation(material)
    if isinstance(shape, Cylinder):
        if foundation.per_area is False:
            raise no_cylinder(material)
        return Disc(shape, "cylinder"), foundation
    return Disc(shape, "layer" if foundation.per_area else "half-space"), foundation


def _adhesion(adhesion: Adhesion | Number | None) -> Adhesion | None:
    """What a number stands for; None without adhesion, or with no work of it."""
    if adhesion is None:
        return None
    if not isinstance(adhesion, Adhesion):
        work = scalar("adhesion", adhesion)
        not_negative("adhesion", work)
        adhesion = Adhesion(work, edge="glassy")
    return None if certain(lambda work: work == 0, adhesion.work) else adhesion


def _check_adhesion(
    law: Relaxation, disc: Disc, bonds: Adhesion, given: Adhesion | Number | None
) -> None:
    """Raises `InputError` for what has no adhesive contact."""
    if isinstance(disc, LayerDisc):
        raise InputError(
            argument="adhesion",
            got=given,
            accepted="left out on an em.layer",
            hint="it is known for half-spaces and springs only",
        )
    shape = disc.shape
    if isinstance(shape, PowerLaw) and shape.exponent < 1:
        raise InputError(
            argument="exponent",
            got=float(shape.exponent),
            accepted="1 or more with adhesion",
        )
    if is_traced(law):
        return
    if law.viscosity > 0:
        raise InputError(
            argument="material",
            accepted="without a parallel dashpot under adhesion",
            hint="its edge could never let go at once",
        )
    if law.equilibrium == 0:
        raise InputError(
            argument="material",
            accepted="a solid (equilibrium above 0) under adhesion",
            hint="a liquid has no relaxed contact to start from",
        )
    computed = bonds.edge == "persson-brener" and law.moduli.any()
    if computed and disc.kind != "half-space":
        raise InputError(
            argument="edge",
            got=bonds.edge,
            accepted='"elastic", "glassy" or a table on springs of viscoelastic rubber',
            hint="how their edge depends on its speed is not known",
        )


def _bound_on_edge(
    law: Relaxation, disc: Disc, bonds: Adhesion, solution: Indented
) -> Bound:
    """How far an adhesive edge is off at most: known against boundary elements under
    balls, by the size of its zone where the body comes off.
    """
    edge = solution.edge
    if edge is None or is_traced(law, bonds, solution.force):
        return ADHESION
    remembers = bool(law.moduli.any())
    if bonds.edge != "persson-brener" and remembers:
        return unknown(*(UPPER if bonds.edge == "glassy" else GIVEN_EDGE))
    if np.isnan(bonds.length(float(law.equilibrium))):
        return ADHESION
    if disc.kind != "half-space" or not isinstance(disc.shape, Paraboloid | Sphere):
        return unknown("the pull-off of this shape was not compared", "a ball")
    if law.moduli.sum() >= (_CONTRAST - 1) * law.equilibrium:
        why = f"glassy over relaxed modulus is {_CONTRAST} or more"
        return unknown(why, "a table of speeds as edge")
    with np.errstate(all="ignore"):
        size = np.where(
            edge.zone_off < 0.5, np.where(edge.zone_off < 0.25, 0.1, 0.15), np.nan
        )
        size = np.where(
            np.nanmax(solution.depth, axis=-1) < _PRELOAD * edge.scale, np.nan, size
        )
    if not np.isnan(size).any():
        return Bound(size[..., None])
    why = (
        "the zone of adhesion is above half of the radius, or the body was pressed less "
        f"than {_PRELOAD} times the depth of JKR, {significant(float(np.max(edge.scale)))} m"
    )
    return Bound(size[..., None], why, "a smaller cutoff, or a deeper contact")


def _rate_of_edge(
    law: Relaxation, bonds: Adhesion | None, solution: Indented
) -> Array | None:
    """Angular frequency 2 pi v/(a_0 Gamma) at which the edge strains the rubber [rad/s];
    None where what it takes is not computed from the rubber.
    """
    edge = solution.edge
    if bonds is None or edge is None or bonds.edge != "persson-brener":
        return None
    if is_traced(law, edge.speed, bonds) or not law.moduli.any():
        return None
    # what a closing edge gives is 1/Gamma
    gamma = np.where(edge.speed > 0, 1 / edge.factor, edge.factor)
    return 2 * np.pi * abs(edge.speed) / (bonds.length(law.equilibrium) * gamma)


def _while_it_matters(fast: Array, speed: Array, radius: Array) -> Any:
    """Where an edge is too `fast`, and where it opened too fast before and the contact
    has not been lost since; a closing edge is left behind as the contact grows.
    """
    places = np.arange(np.shape(fast)[-1])
    opened, lost = (
        np.maximum.accumulate(np.where(x, places, -1), axis=-1)
        for x in (fast & (speed < 0), ~(radius > 0))
    )
    return fast | (opened > lost)


def _beyond_table(bonds: Adhesion, solution: Indented) -> tuple[Doubt, ...]:
    """Where an edge is faster than the table that was given of it; with a warning."""
    edge = solution.edge
    if edge is None or isinstance(bonds.edge, str) or is_traced(edge.speed):
        return ()
    says = "have, or had, an edge faster than the table of `edge`, whose last factor is taken"
    fast = np.nan_to_num(abs(edge.speed)) > bonds.edge[0][-1]
    fast = _while_it_matters(fast, edge.speed, solution.radius)
    doubt = Doubt("extrapolated", fast, says, "factors at those speeds")
    warn_of(doubt)
    return (doubt,)


def _without_end(edge: AdhesiveEdge, stored: Array) -> Iterator[Doubt]:
    """The last instants of histories of which not all is known."""
    last = np.arange(stored.shape[-1]) == stored.shape[-1] - 1
    errors = edge.jump_in.error, edge.pull_off.error
    met, off = (~xp.isnan(error) for error in errors)
    for histories, says, remedy in (
        (
            met & ~off,
            "end a history in contact, without `pull_off` and `loop_energy`",
            "a history that pulls the body off",
        ),
        (
            off & xp.isnan(edge.loop),
            "end a history in steps too long for `loop_energy`",
            "more instants",
        ),
        (
            (errors[0] > _EVENT) | (errors[1] > _EVENT),
            "end a history with a `jump_in` or `pull_off` of an error above "
            f"{_EVENT:g} (NaN above {_WORST:g})",
            "more instants, or a body that is pressed less",
        ),
        (
            met & xp.isnan(stored).all(axis=-1),
            "end a history without `stored`, `locked` and `dissipated`, which are not "
            "known of rubber that remembers",
            "",
        ),
    ):
        yield Doubt("estimate", last & histories[..., None], says, remedy)


def _check(
    law: Relaxation, time: Any, depth: Any, load: Any, pull: bool
) -> DepthOrLoad:
    """Checks a history and brings its parts to one shape. Raises `InputError`."""
    if depth is None and load is None:
        raise InputError(argument="load", accepted="given, or depth in its place")
    time, both = _ascending(time), depth is not None and load is not None
    given: dict[str, Any] = {}
    for name, value in (("depth", depth), ("load", load)):
        if value is not None:
            given[name] = as_float64(name, value)
            signed = pull or name == "depth"
            _check_course(name, given[name], signed, both)
    known_time, given = time, broadcast({"time": time, **given})
    if not is_traced(known_time):
        given["time"] = np.broadcast_to(known_time, given["time"].shape)
    by_depth = _where_depth_rules(given["depth"], given["load"]) if both else None
    course = DepthOrLoad(given["time"], given.get("depth"), given.get("load"), by_depth)
    depth = course.depth
    if depth is not None and not is_traced(law, depth) and law.viscosity > 0:
        accepted = (
            "zero or negative at the first instant, since a parallel dashpot "
            "cannot be pressed down at once"
        )
        require("depth", np.nan_to_num(depth[..., 0]), accepted, lambda d: d <= 0)
    return course


def _ascending(time: ArrayLike) -> Any:
    """Instants along the last axis. Raises `InputError`."""
    time = as_float64("time", time)
    finite("time", time)
    if time.ndim == 0 or time.shape[-1] < 2:
        raise InputError(
            argument="time", got=time, accepted="a list of two instants or more"
        )
    if not is_traced(time) and not (np.diff(time) > 0).all():
        i = np.unravel_index(int(np.argmin(np.diff(time))), np.diff(time).shape)
        raise InputError(
            argument="time",
            got=[float(time[i]), float(time[(*i[:-1], i[-1] + 1)])],
            accepted="ascending, without repeats",
        )
    return time


def _check_course(name: str, given: Array, signed: bool, both: bool) -> None:
    """Raises `InputError`. Of a course of `both`, NaN stands where the other rules."""
    if both and not is_traced(given):
        given = given[~np.isnan(given)]
    if not signed:
        accepted = "zero or positive and finite (a pull needs adhesion)"
        require(name, given, accepted, lambda x: np.isfinite(x) & (x >= 0))
        representable(name, given)
    finite(name, given)


def _where_depth_rules(depth: Any, load: Any) -> np.ndarray:
    """Raises `InputError` unless at each instant one of both is given."""
    why = "which of both holds at an instant is read from the NaN entries"
    numbers_only({"depth": depth, "load": load}, why)
    by_depth = ~np.isnan(depth)
    if not (by_depth ^ ~np.isnan(load)).all():
        raise InputError(
            argument="depth",
            got=depth,
            accepted="NaN where load is a number, and a number where load is NaN",
        )
    return by_depth


def _in_short(row: dict[str, np.ndarray]) -> str:
    """Largest depth, force and radius of a history, where it ends, and what was
    dissipated.
    """
    if not np.isfinite(row["depth"]).any():
        return "no instant converged"

    def most(key: str, name: str) -> str:
        i = int(np.nanargmax(row[key]))
        return (
            f"{in_words(name, float(row[key][i]))} at "
            f"{significant(float(row['time'][i]))} s"
        )

    known = np.flatnonzero(np.isfinite(row["depth"]))[-1]
    end = (
        f"{in_words('depth', float(row['depth'][known]))}, "
        f"{in_words('load', float(row['force'][known]))}"
    )
    sentence = (
        f"deepest {most('depth', 'depth')}; largest force {most('force', 'load')}; "
    )
    sentence += f"largest radius {most('contact_radius', 'radius')}; at the end {end}"
    lost, work = (float(row[key][known]) for key in ("dissipated", "work"))
    if np.isfinite(lost):
        sentence += f"; dissipated {significant(lost)} J"
        # Adhesion pulls the body in, so that less than nothing may have been put in, or
        # less than was dissipated.
        sentence += (
            f" of {significant(work)} J"
            if work >= lost
            else f"; work of the body {significant(work)} J"
        )
    return sentence
