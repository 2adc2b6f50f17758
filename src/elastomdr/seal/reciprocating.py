"""The film that a rod carries out of a seal and back, and what leaks in a stroke.

Inverse theory: where the pressure of the film is that of the dry contact, Reynolds'
equation gives the film,

    h^3 p' = 6 eta U (h - h_0),      h_0 = sqrt(8 eta U/(9 p'_max)),

p' along the motion of the rod, p'_max its largest value, where h = 1.5 h_0. The rod
leaves the seal with a film of h_0/2. The steeper the pressure rises on the side that the
rod comes from, the thinner that film: a seal with the steeper flank on the side of the
fluid brings back more than it lets out. With y = h/h_0 and s = (4/27) p'/p'_max the film
is the root of s y^3 - y + 1 = 0: the largest one ahead of the steepest place, then the
one below 1.5.

The pressure of an O-ring is Hertz' p, and that of its fluid, f = nu/(1 - nu) Delta p, on
top (`o_ring.py`). On the side of the fluid the film begins under Delta p, above which the
pressure rises as Hertz' does: the film out is that of the ring without its fluid. On the
side of the air it falls to zero, over the same width: the film in is that of Hertz'
pressure of the mean p + f. That is a rule, not a solution. The rod feels the fall of the
pressure in the film too, h_0 Delta p/2, with the stroke out and against that in.

All of this is for a film between smooth surfaces. One thinner than three rms heights of
the smoothest rods there are is none: the rod then rubs on the seal, and film, leak and
friction are not known (NaN). So is a friction that would drive the rod: there the rule
for the pressure in the film fails.

Source: H. Blok, Proc. Int. Symp. on Lubrication and Wear, Houston (1963);
H. K. Mueller & B. S. Nau, Fluid Sealing Technology (1998).
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ..call.extrapolation import pressed_as_none_is
from ..call.several_materials import over_materials
from ..checks import (
    broadcast,
    in_si,
    numbers_only,
    only_one,
    positive_arrays,
    scalar,
)
from ..errors import InputError, ModelWarning, quiet, warn, warned_once
from ..material.prony import Prony
from ..material.shift import thermal_factors
from ..results.base import Array, Result, quantity, record
from ..results.doubts import Doubt, carried
from ..results.words import brief, in_unit, span
from ..surface.shapes import Cylinder
from .lubricated import lubricated
from .o_ring import ORing, ring_of
from .pressure_profile import Profile, pressure_profile
from .response import bodies_of, compliance

if TYPE_CHECKING:
    from .._types import ArrayLike

_FEWEST = 8  # rows of a pressure profile
_APART = 4  # positions over which a steepness is compared with that between neighbours
_THINNEST = 3 * 0.05e-6  # film [m]: three rms heights of the smoothest rods
_DOUBTED = 0.1  # relative error of the film from which a profile is doubted


@record
class Reciprocating(Result):
    """A seal on a rod that moves out and in.

    `net_leak` is what one stroke out leaves outside when the next stroke in has taken
    back what it can: zero where the stroke in could take more. Films thinner than 0.15
    µm, three rms heights of the smoothest rods, are NaN with their leak and friction,
    and so is a friction that would drive the rod.
    """

    velocity_out: Array = quantity(
        "velocity out", "m/s", "of the rod, out of the fluid"
    )
    velocity_in: Array = quantity("velocity in", "m/s", "of the rod, into the fluid")
    viscosity: Array = quantity("viscosity", "Pa s", "of the fluid")
    film_out: Array = quantity(
        "film carried out", "m", "h_0/2, on the rod outside", shown="µm"
    )
    film_in: Array = quantity(
        "film that can be carried in", "m", "h_0/2, of the stroke in", shown="µm"
    )
    net_leak: Array = quantity(
        "net leak per stroke", "m^3", "on the width of the seal", shown="mm³"
    )
    friction_out: Array = quantity("friction of the stroke out", "N", "of the film")
    friction_in: Array = quantity("friction of the stroke in", "N", "of the film")
    work: Array = quantity("work of friction", "J", "of one stroke out and in")
    error: Array = quantity("error of the film carried out", "m", "numerical")
    film_in_error: Array = quantity("error of the film carried in", "m", "numerical")
    net_leak_error: Array = quantity("error of the net leak", "m^3", "numerical")
    model_error: Array = quantity("model error", "-", "NaN: not known")

    title: ClassVar[str] = "Reciprocating seal"
    across: ClassVar[str] = "velocity_out"
    scale: ClassVar[str] = "auto"
    shows: ClassVar[str] = "net_leak"
    error_of: ClassVar[str] = "the film carried out"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity_out",
        "velocity_in",
        "viscosity",
    )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The films, the leak and the friction."""
        yield "film carried out", span(in_unit(self.film_out, "µm"), "µm")
        yield "film that can be carried in", span(in_unit(self.film_in, "µm"), "µm")
        yield "net leak per stroke", span(in_unit(self.net_leak, "mm³"), "mm³")
        yield "friction of the stroke out", span(self.friction_out, "N")


class _Carried(NamedTuple):
    """A stroke."""

    film: Array  # h_0/2 [m]
    friction: Array  # per width [N/m]
    error: Array  # of the film [m]
    doubts: tuple[Doubt, ...] = ()  # of the film
    said: tuple[tuple[str, str], ...] = ()


@over_materials
@in_si
def reciprocating(
    material: Prony | Sequence[Prony] | None = None,
    *,
    profile: tuple[ArrayLike, ArrayLike] | str | os.PathLike[str] | None = None,
    o_ring: ORing | None = None,
    velocity_out: ArrayLike,
    velocity_in: ArrayLike,
    stroke: float,
    viscosity: ArrayLike,
    width: float = 1.0,
) -> Reciprocating:
    """Films, net leak and friction of a seal on a rod that moves out and in.

    Args:
        material: rubber of the O-ring; not needed with a profile.
        profile: pressure of the dry contact, from the side of the fluid to that of the
            air: positions [m] and pressures [Pa], or a file with these two columns and
            their units in its title line, such as position [mm], pressure [MPa].
        o_ring: a single point of `em.o_ring`, in place of a profile, at its time and
            temperature, and under the pressure of its fluid.
        velocity_out: velocity of the rod out of the fluid [m/s]; arguments broadcast.
        velocity_in: velocity of the rod into the fluid [m/s].
        stroke: length of the stroke [m].
        viscosity: viscosity of the fluid [Pa s].
        width: length of the seal along its edge [m], pi times the diameter of a rod; 1:
            all is per metre.

    Returns:
        An `em.Reciprocating` of the broadcast shape.

    Raises:
        InputError: for a profile that is too short, not ascending, or of one flank
            only; for both or neither of profile and o_ring; for a material that is not
            that of the O-ring; under `jax.jit`, `grad` and `vmap`.

    Exact for a profile that the film does not change, which is so where films are thin
    and its flanks of finite steepness. An O-ring has Hertz' pressure, with none: its
    film is that of `em.lubricated` under its load and width. Its `fluid_pressure` is
    added to the pressure of the contact, which makes the side of the air steeper and
    the film in thinner, by a rule (`docs/seal.md`). Between strokes no fluid is lost
    from the rod. Source: Blok 1963; Mueller & Nau 1998.
    """
    numbers_only(
        {
            "material": material,
            "profile": profile,
            "o_ring": o_ring,
            "velocity_out": velocity_out,
            "velocity_in": velocity_in,
            "stroke": stroke,
            "viscosity": viscosity,
            "width": width,
        }
    )
    if not (material is None or isinstance(material, Prony)):
        raise InputError(
            argument="material",
            got=material,
            accepted="the rubber of the O-ring (em.Prony, em.load_material(...))",
        )
    only_one({"profile": profile, "o_ring": o_ring})
    motion = _check(velocity_out, velocity_in, stroke, viscosity, width)
    if profile is not None:
        strokes = _of_profile(profile, motion)
        model, plan = "inverse theory", "closed form"
    else:
        strokes = _of_ring(material, o_ring, motion)
        model, plan = "inlet of Hertz' pressure", "em.lubricated"
    return _report(motion, strokes, model, plan)


class _Motion(NamedTuple):
    """What the rod does, broadcast."""

    out: Array  # velocity [m/s]
    back: Array  # [m/s]
    viscosity: Array  # [Pa s]
    stroke: Array  # [m]
    width: Array  # of the seal [m]


class _Strokes(NamedTuple):
    """Both strokes, and from which pressure."""

    source: str
    leaving: _Carried
    entering: _Carried


def _check(
    velocity_out: ArrayLike,
    velocity_in: ArrayLike,
    stroke: float,
    viscosity: ArrayLike,
    width: float,
) -> _Motion:
    """The motion, checked. Raises `InputError`."""
    arrays = positive_arrays(
        {
            "velocity_out": velocity_out,
            "velocity_in": velocity_in,
            "viscosity": viscosity,
        }
    )
    numbers = positive_arrays(
        {"stroke": scalar("stroke", stroke), "width": scalar("width", width)}
    )
    return _Motion(*broadcast(arrays).values(), *numbers.values())


def _report(motion: _Motion, strokes: _Strokes, model: str, plan: str) -> Reciprocating:
    """The result of both strokes."""
    no_film = _no_film(strokes)
    source, leaving, entering = strokes.source, *map(_of_smooth, strokes[1:])
    more, off = leaving.film - entering.film, leaving.error + entering.error
    net = np.maximum(more, 0.0)
    net_error = np.where(more > 0, off, np.maximum(more + off, 0.0))
    length, edge = motion.stroke, motion.width
    return Reciprocating(
        velocity_out=motion.out,
        velocity_in=motion.back,
        viscosity=motion.viscosity,
        film_out=leaving.film,
        film_in=entering.film,
        net_leak=net * length * edge,
        friction_out=leaving.friction * edge,
        friction_in=entering.friction * edge,
        work=(leaving.friction + entering.friction) * edge * length,
        error=leaving.error,
        film_in_error=entering.error,
        net_leak_error=net_error * length * edge,
        model_error=np.full(motion.out.shape, np.nan),
        converged=np.isfinite(more + leaving.friction + entering.friction),
        marks=carried((*leaving.doubts, *entering.doubts, *no_film)),
        model=model,
        plan=plan,
        inputs=(
            ("pressure", source),
            ("velocity out", brief(motion.out, "m/s")),
            ("velocity in", brief(motion.back, "m/s")),
            ("viscosity", brief(motion.viscosity, "Pa s")),
            ("stroke", brief(length, "m")),
            ("width", brief(edge, "m")),
            *(leaving.said or entering.said),
        ),
    )


def _of_smooth(stroke: _Carried) -> _Carried:
    """The stroke, NaN where it is not one of a film between smooth surfaces."""
    film = stroke.film >= _THINNEST
    return stroke._replace(
        film=np.where(film, stroke.film, np.nan),
        error=np.where(film, stroke.error, np.nan),
        friction=np.where(film & (stroke.friction >= 0), stroke.friction, np.nan),
    )


def _no_film(strokes: _Strokes) -> list[Doubt]:
    """Where a stroke is not that of a film, and why, each with a warning."""
    doubts = []
    for stroke, name in ((strokes.leaving, "out"), (strokes.entering, "in")):
        thin = stroke.film < _THINNEST
        if thin.any():
            says = (
                f"have a film of the stroke {name} of {np.nanmin(stroke.film):.2g} m or "
                "more, less than three rms heights of the smoothest rods "
                f"({_THINNEST:.2g} m): the rod rubs on the seal, and they are NaN"
            )
            remedy = (
                "the shear stress of the real contact, em.friction(..., "
                "adhesion=em.AdhesiveShear(...))"
            )
            doubts.append(Doubt("no prediction", thin, says, remedy))
        driven = ~thin & (stroke.friction < 0)
        if driven.any():
            says = (
                f"have a pressure in the film that would drive the stroke {name}: the "
                "rule for it fails, and friction is NaN"
            )
            doubts.append(Doubt("no prediction", driven, says, "a profile of the seal"))
    for doubt in doubts:
        warn(f"{doubt.words()}.", ModelWarning)
    return doubts


def _of_profile(profile: Profile, motion: _Motion) -> _Strokes:
    """Both strokes under a given pressure: out along x, in against it."""
    x, p = pressure_profile(profile, _FEWEST)
    too_hard = pressed_as_none_is(np.full(motion.out.shape, p.max()))
    slope = np.diff(p)
    if not (slope.max() > 0 > slope.min()):
        raise InputError(
            argument="profile",
            got=profile,
            accepted="one that rises on the side of the fluid and falls on that of the "
            "air",
        )
    strokes = _Strokes(
        f"{x.size} points of a pressure profile",
        _inverse(x, p, motion.viscosity * motion.out)._replace(doubts=too_hard),
        _inverse(-x[::-1], p[::-1], motion.viscosity * motion.back),
    )
    _judge(strokes.leaving, strokes.entering)
    return strokes


def _inverse(x: Array, pressure: Array, drag: Array) -> _Carried:
    """A stroke along x; `drag` is eta U [N/m].

    Steepness is that between two positions. The error is how much the film would change
    with every fourth of them: what noise makes steeper, and what a coarse profile hides.
    """
    spacing = np.diff(x)
    slope = np.diff(pressure) / spacing
    steepest = int(slope.argmax())
    film = np.sqrt(8 * drag / (9 * slope[steepest]))
    wide = (pressure[_APART:] - pressure[:-_APART]) / (x[_APART:] - x[:-_APART])
    error = 0.5 * film * abs(np.sqrt(slope[steepest] / wide.max()) - 1)
    y = _thickness(slope / slope[steepest], steepest)
    # shear at the rod, eta U/h + h p'/2, over eta U and h_0
    sheared = np.sum(spacing / y) * drag / film
    pumped = 0.5 * film * np.sum(y * slope * spacing)
    return _Carried(0.5 * film, sheared + pumped, error)


def _judge(*strokes: _Carried) -> None:
    """Warns of a profile whose steepest place is not resolved."""
    error = max(float(np.max(each.error / each.film)) for each in strokes)
    if error > _DOUBTED:
        warn(
            f"profile: films are known to {error:.0%} only, and the net leak no better: "
            f"between neighbours it is steeper than over {_APART} of its intervals, by "
            "noise, or by too few positions. Give a smoother profile, or more positions "
            "where it is steep.",
            ModelWarning,
        )


def _thickness(slope: Array, steepest: int) -> Array:
    """y = h/h_0 at slopes p'/p'_max; far ahead, where the pressure is flat, the film is
    wide open.
    """
    s = 4 / 27 * slope
    size = np.maximum(np.abs(s), 1e-12)
    angle = np.arccos(np.clip(-1.5 * np.sqrt(3 * size), -1, 1)) / 3
    ahead = np.arange(s.size) < steepest
    scale = 2 / np.sqrt(3 * size)
    rising = scale * np.cos(angle - np.where(ahead, 0.0, 2 * np.pi / 3))
    falling = scale * np.sinh(np.arcsinh(1.5 * np.sqrt(3 * size)) / 3)
    return np.where(s > 0, rising, falling)


def _of_ring(material: Prony | None, ring: ORing | None, motion: _Motion) -> _Strokes:
    """Both strokes under an O-ring, and what it is."""
    if material is None:
        raise InputError(argument="material", accepted="given with o_ring")
    ring = ring_of(material, ring)
    if np.size(ring.width) != 1:
        raise InputError(
            argument="o_ring", got=ring, accepted="a single point of em.o_ring(...)"
        )
    pressure = float(np.ravel(ring.pressure)[0])
    fluid, air_side = 0.0, pressure
    source = "O-ring"
    if ring.fluid_pressure is not None and ring.sealing_pressure is not None:
        fluid = float(np.ravel(ring.fluid_pressure)[0])
        air_side = float(np.ravel(ring.sealing_pressure)[0])
        source += f" under {brief(fluid, 'Pa')} of its fluid"
    with warned_once():
        leaving = _under_ring(material, ring, pressure, motion.out, motion.viscosity)
        entering = _under_ring(material, ring, air_side, motion.back, motion.viscosity)
    # h_0 Delta p/2, h_0 twice the film
    return _Strokes(
        source,
        leaving._replace(friction=leaving.friction - leaving.film * fluid),
        entering._replace(friction=entering.friction + entering.film * fluid),
    )


def _under_ring(
    material: Prony, ring: ORing, pressure: float, velocity: Array, viscosity: Array
) -> _Carried:
    """A stroke under Hertz' pressure of that mean [Pa] and the width of the ring: that
    of a cylinder.
    """
    temperature, time = _when(ring)
    factor, vertical = map(float, thermal_factors(material, temperature))
    held = None if time is None else time / factor
    soft = compliance(bodies_of(material)[0], held) / vertical
    half = 0.5 * float(np.ravel(ring.width)[0])
    load = 2 * half * pressure
    with quiet(ModelWarning):  # of the cylinder: what is known of the ring is its own
        film_of_ring = lubricated(
            material,
            Cylinder(np.pi * half**2 / (4 * load * soft), 1.0),
            velocity=velocity,
            viscosity=viscosity,
            load=load,
            temperature=temperature,
            time=time,
        )
    marks = [mark for mark in film_of_ring.marks if mark.kind != "estimate"]
    marks += carried(ring.examined(), lambda points: np.resize(points, velocity.shape))
    film = np.asarray(film_of_ring.flow / velocity)
    remarks = tuple(line for line in film_of_ring.inputs if line[0] == "material")
    return _Carried(
        film,
        np.asarray(film_of_ring.mu * load),
        np.asarray(film_of_ring.error / film_of_ring.mu * film),
        tuple(marks),
        remarks,
    )


def _when(ring: ORing) -> tuple[float | None, float | None]:
    """Temperature [K] and time [s] of the ring."""
    temperature, time = (
        None if value is None else float(np.ravel(value)[0])
        for value in (ring.temperature, ring.time)
    )
    return temperature, time
