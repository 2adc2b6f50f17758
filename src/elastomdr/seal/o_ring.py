"""A rubber cord squeezed between flat walls, such as an O-ring in its groove: its load
and the width it touches on.

Per length of cord of diameter d, squeezed by the part C of d, free to bulge, E = 2 G(t)
(1 + nu), E* = E/(1 - nu^2):

    "lindley"
    W = E d (1.25 C^1.5 + 50 C^6)
    fitted to measurements, C up to 0.25
    "hertz"     C = s [ln(4/s) - 1],  W = (pi/2) E* d s              small strain, plane strain
    "held"      Hertz' W times (1 + .2343 C + 1.823 C^2 + 1.865 C^3)
    "free"      Hertz' W times (.9029 - .7203 C + 3.467 C^2 - 3.916 C^3)
    all         2a = sqrt(8 W d/pi E*) (Hertz),  p = W/2a            width and mean pressure

"held" and "free" are finite elements at large strain (benchmarks/o_ring_fe.py): a cord
that keeps its length, as a ring that its groove holds, and one that no force holds
along its length. A ring is between both, which `model_error` says. Lindley's load is
.86, .96 and 1.03 of "free" and .72, .76 and .75 of "held" at C = 0.08, 0.15 and 0.25.

Rubber is nearly incompressible: E = 3 G(t), E* = 4 E/3. Lindley measured rubber; for nu
far below 0.5 nothing is known.

In "hertz" s = (a/d)^2. With u = ln(4/s) - 1 it is u - ln u = ln(4/C) - 1, solved by
Newton's method. Sources:
P. B. Lindley, J. Inst. Rubber Ind. 1 (1967) 209 (recalled, not compared with the paper;
Kim et al., Eng. Failure Anal. 14 (2007) 1680: near to finite elements, below what they
measured); K. L. Johnson, Contact Mechanics (1985), section 5.6.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np

from ..arrays import numpy_unless_traced, stop_gradient, xp
from ..call.extrapolation import held_beyond, pressed_as_none_is
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast,
    broadcast_shape,
    in_kelvin,
    not_negative,
    one_of,
    positive,
    possible,
    require,
)
from ..element.law import normal_operator
from ..errors import InputError
from ..material.prony import Prony
from ..material.relaxation import Relaxation
from ..material.shift import thermal_factors
from ..material.tabulated import needs_series
from ..material.validity import material_in_words
from ..results.base import Array, Result, quantity, record
from ..results.words import given_in_words, in_unit, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Solid

# up to which the formulas hold
_LARGEST_SQUEEZE = {"lindley": 0.25, "hertz": 0.25, "held": 0.3, "free": 0.3}
# Finite elements over Hertz' load of small strain: powers of C, from 0.02 to 0.3
_LARGE_STRAIN = {
    "held": (1.0, 0.2343, 1.8234, 1.8646),
    "free": (0.9029, -0.7203, 3.4667, -3.916),
}
# how much wider than its diameter a held cord is, the same (a free one: half of it)
_BULGE = (0.333, 1.601)
_FARTHER = " (0.3 by formula='held' or 'free')"
_NEWTON_STEPS = 8  # u - ln u is nearly straight, and convex
FORMULAS = {
    "lindley": (
        "Lindley's formula for the load (measured cords), Hertz' width; straight "
        "cord, free to bulge"
    ),
    "hertz": (
        "plane contact at small strain, load and width of Hertz; straight cord, free "
        "to bulge"
    ),
    "held": (
        "finite elements at large strain; straight cord that keeps its length, free to "
        "bulge"
    ),
    "free": (
        "finite elements at large strain; straight cord that may lengthen, free to "
        "bulge"
    ),
}
_UNITS = {
    "diameter": "m",
    "squeeze": "of the diameter",
    "time": "s",
    "temperature": "K",
    "fluid_pressure": "Pa",
    "groove_width": "m",
}
Formula = Literal["lindley", "hertz", "held", "free"]


@record
class ORing(Result):
    """Contact of a squeezed cord with either wall.

    `error` is that of the arithmetic alone, zero. `model_error` is how far the load of
    a ring that keeps its length, or of one that may lengthen, is from `line_load`.
    """

    diameter: Array = quantity("diameter of the cord", "m", "d", shown="mm")
    squeeze: Array = quantity(
        "squeeze", "-", "C, part of d", axis="squeeze of the diameter", shown="%"
    )
    time: Array | None = quantity(
        "time since it was squeezed", "s", "None: relaxed", default=None
    )
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    line_load: Array = quantity(
        "line load",
        "N/m",
        "W, force per length of cord",
        axis="force per length of cord",
    )
    width: Array = quantity("width of the contact", "m", "2a", shown="mm")
    pressure: Array = quantity(
        "mean pressure",
        "Pa",
        "W/2a, of the contact; the largest is 4/pi of it",
        axis="mean pressure of the contact",
        shown="MPa",
    )
    error: Array = quantity("error of the arithmetic", "N/m")
    model_error: Array | None = quantity(
        "bound on the load by whether the ring can lengthen", "N/m", default=None
    )
    fluid_pressure: Array | None = quantity(
        "pressure of the fluid", "Pa", default=None, shown="MPa"
    )
    sealing_pressure: Array | None = quantity(
        "sealing pressure",
        "Pa",
        "mean pressure of the contact with that of the fluid, nu/(1 - nu) of which the "
        "rubber passes on",
        default=None,
        shown="MPa",
    )
    fill: Array | None = quantity(
        "fill of the groove", "-", "share of its cross-section", default=None, shown="%"
    )

    title: ClassVar[str] = "Squeezed cord"
    across: ClassVar[str] = "squeeze"
    scale: ClassVar[str] = "auto"
    shows: ClassVar[str] = "pressure"
    error_of: ClassVar[str] = "the arithmetic"
    bound_of: ClassVar[str] = "line_load"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "squeeze",
        "temperature",
        "diameter",
    )

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: Literal[
            "pressure", "width", "line_load", "sealing_pressure"
        ] = "pressure",
    ) -> "Axes":
        """Draws pressure, width, line_load or sealing_pressure against time where there
        are several times, else against the squeeze; dotted where the material was not
        measured.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        shown = ("pressure", "width", "line_load")
        if self.sealing_pressure is not None:
            shown += ("sealing_pressure",)
        self._check_shown(show, *shown)
        from ..results.plotting import DrawAsk, draw

        x = "time" if any(axis.name == "time" for axis in self.axes()) else "squeeze"
        return self._draw(partial(draw, x=x, y=show), DrawAsk(ax, style, title, label))

    def pressure_at(self, x: ArrayLike) -> Array:
        """Pressure [Pa] at distances x [m] from the middle of the contact, the last
        axis: Hertz' ellipse, 4/pi of the mean at most; zero beside it.

        Finite elements have a largest pressure of 1.26 to 1.31 times the mean in a free
        cord, and of 1.29 to 1.47 in a held one squeezed by 2 to 30 %.
        """
        relative_place = 2 * as_float64("x", x) / self.width[..., None]
        height = 4 / np.pi * self.pressure[..., None]
        return height * xp.sqrt(xp.maximum(1 - relative_place**2, 0.0))

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of line load, width and pressure."""
        yield "line load", span(self.line_load, "N/m")
        if self.model_error is not None:
            most = np.nanmax(self.model_error / self.line_load)
            yield (
                "model error",
                f"the load is off by {100 * most:.0f} % at most: a ring that keeps its "
                "length takes more, one that may lengthen less",
            )
        yield "contact width", span(in_unit(self.width, "mm"), "mm")
        yield "mean pressure", span(in_unit(self.pressure, "MPa"), "MPa")
        if self.sealing_pressure is not None:
            pressed = span(in_unit(self.sealing_pressure, "MPa"), "MPa")
            yield "with the fluid's pressure", pressed
        if self.fill is not None:
            yield "fill of the groove", span(100 * self.fill, "%")


@over_materials
@numpy_unless_traced
def o_ring(
    material: Solid | Sequence[Solid],
    diameter: ArrayLike,
    squeeze: ArrayLike,
    *,
    time: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    formula: Formula = "lindley",
    fluid_pressure: ArrayLike | None = None,
    groove_width: ArrayLike | None = None,
) -> ORing:
    """Line load, contact width and mean pressure of a cord (an O-ring) squeezed between
    flat walls, free to bulge.

        W = E d (1.25 C^1.5 + 50 C^6),   2a = sqrt(8 W d/(pi E*)),   p = W/2a,   E = 2 G(t) (1 + nu)

    with E* = E/(1 - nu^2): 3 G and 4 G for an incompressible rubber.

    Args:
        material: the cord's own material, between rigid walls; no foundation, which has
            E* but not E.
        diameter: diameter of the cord d [m]; arguments broadcast.
        squeeze: part C of the diameter by which the cord is squeezed, up to 0.25, or
            0.3 with "held" and "free".
        time: time t since it was squeezed, at once and held [s]; without it the rubber
            is relaxed.
        temperature: temperature [K], for a material with a shift law.
        formula: "lindley"; "hertz" for W of small strain (Johnson 1985, 5.6); "held" or
            "free", finite elements at large strain of a ring that its groove keeps at
            its length, or that may lengthen.
        fluid_pressure: pressure of the sealed fluid above that behind the ring [Pa],
            which pushes it against the far wall of its groove.
        groove_width: width of the groove [m]; its height is the squeezed diameter.

    Returns:
        An `em.ORing` of the broadcast shape.

    Raises:
        InputError: for a foundation, a squeeze above that of the formula, an unknown
            formula, and a groove whose sides the squeezed cord would touch.

    The cord is taken as straight, which is right for rings much larger than their cord,
    without friction at the walls, in a groove that it does not fill. Relaxation scales
    the load (linear viscoelasticity at a constant shape). A fluid adds nu/(1 - nu) of
    its pressure to that of the contact: what a body between rigid walls passes on
    sideways, all of it for an incompressible rubber. Differentiable.

    Source: P. B. Lindley, J. Inst. Rubber Ind. 1 (1967) 209, quoted from memory and
    compared with finite elements (`docs/seal.md`).
    """
    solid = _checked_material(material)
    one_of("formula", formula, *FORMULAS)
    arguments = {"diameter": diameter, "squeeze": squeeze}
    arguments |= {"time": time, "temperature": temperature}
    arguments |= {"fluid_pressure": fluid_pressure, "groove_width": groove_width}
    given = _check(arguments, _LARGEST_SQUEEZE[formula])
    shape = broadcast_shape(given._asdict())
    _check_groove(given)
    young, plane = (
        _modulus(law, solid, given.time, given.temperature)
        for law in (solid.tensile().law(), normal_operator(solid))
    )
    if not possible(lambda young: np.all(young > 0), young):
        raise InputError(
            argument="time",
            accepted="given for a material without an equilibrium modulus",
            hint="it relaxes completely",
        )
    load, width = _solve(given, young, plane, formula)
    ends = [_solve(given, young, plane, name)[0] for name in ("held", "free")]
    pressure = load / width
    factor, _ = thermal_factors(solid, given.temperature)
    sealing = _sealing_pressure(given, pressure, young / plane)
    too_hard = ()
    if given.fluid_pressure is not None:
        # it presses the ring from all sides, which no modulus limits
        too_hard = pressed_as_none_is(xp.broadcast_to(given.fluid_pressure, shape))
    fields = broadcast(
        {
            "diameter": given.diameter,
            "squeeze": given.squeeze,
            "time": given.time,
            "temperature": given.temperature,
            "line_load": load,
            "width": width,
            "pressure": pressure,
            "error": 0.0,
            "model_error": xp.maximum(*(xp.abs(end - load) for end in ends)),
            "fluid_pressure": given.fluid_pressure,
            "sealing_pressure": sealing,
            "fill": _fill(given),
            "converged": True,
        }
    )
    return ORing(
        **fields,
        marks=(
            *held_beyond(solid.range, given.time, given.temperature, factor, shape),
            *too_hard,
        ),
        model=FORMULAS[formula],
        plan="closed form",
        inputs=(*material_in_words(solid), *given_in_words(given, _UNITS)),
    )


class _Cord(NamedTuple):
    """What is given to `em.o_ring`, under its names, as arrays."""

    diameter: Array
    squeeze: Array
    time: Array | None = None
    temperature: Array | None = None
    fluid_pressure: Array | None = None
    groove_width: Array | None = None


def _checked_material(material: object) -> Prony:
    """The material. Raises `InputError` for anything but a Prony series."""
    needs_series("material", material, "a squeezed cord")
    if not isinstance(material, Prony):
        raise InputError(
            argument="material",
            got=material,
            accepted="that of the cord (em.Prony, em.load_material(...)), not a "
            "foundation",
            hint="the load depends on Young's modulus",
        )
    return material


def _check(arguments: dict[str, ArrayLike | None], largest: float) -> _Cord:
    """The arguments as arrays. Raises `InputError`."""
    given = _Cord(
        **{
            name: as_float64(name, value)
            for name, value in arguments.items()
            if value is not None
        }
    )
    positive("diameter", given.diameter)
    require(
        "squeeze",
        given.squeeze,
        f"positive and at most {largest:g}, a part of the diameter (0.15 for 15 %), up "
        f"to which the formula was checked{_FARTHER if largest < 0.3 else ''}",
        lambda c: (c > 0) & (c <= largest),
    )
    return given


def _check_groove(given: _Cord) -> None:
    """Raises `InputError` for a pressure of the fluid below zero, and a groove that
    confines the cord, for which no formula holds.
    """
    if given.fluid_pressure is not None:
        not_negative("fluid_pressure", given.fluid_pressure)
    if given.groove_width is not None:
        positive("groove_width", given.groove_width)
        squeeze = given.squeeze
        cord = given.diameter * (1 + _BULGE[0] * squeeze + _BULGE[1] * squeeze**2)
        require(
            "groove_width",
            given.groove_width,
            "wider than the squeezed cord (bulged, at most "
            f"{1e3 * float(np.max(stop_gradient(cord))):.4g} mm): beside a cord that touches "
            "the sides of its groove no formula holds",
            lambda w: w > stop_gradient(cord),
        )


def _sealing_pressure(
    given: _Cord, pressure: Array, young_over_plane: Array
) -> Array | None:
    """With what the fluid adds, where it is given; E/E* = 1 - nu^2."""
    if given.fluid_pressure is None:
        return None
    poisson = xp.sqrt(1 - young_over_plane)
    passed_on = poisson / (1 - poisson)
    return pressure + passed_on * given.fluid_pressure


def _fill(given: _Cord) -> Array | None:
    """Of the groove, where its width is given."""
    if given.groove_width is None:
        return None
    height = given.diameter * (1 - given.squeeze)
    return np.pi / 4 * given.diameter**2 / (given.groove_width * height)


def _modulus(
    law: Relaxation, material: Prony, time: Array | None, temperature: Array | None
) -> Any:
    """A modulus at a time and a temperature; relaxed without a time."""
    if temperature is not None:
        in_kelvin("temperature", temperature)
    time_factor, vertical_factor = thermal_factors(material, temperature)
    if time is None:
        return law.equilibrium * vertical_factor
    not_negative("time", time)
    broadcast_shape({"time": time, "temperature": temperature})
    return law.relaxation(time / time_factor) * vertical_factor


def ring_of(material: object, ring: object) -> ORing:
    """The ring, of several that of this material. Raises `InputError` unless it has the
    modulus that load and width of the ring tell, E* = 8 W d/(pi (2a)^2).
    """
    if not isinstance(ring, ORing):
        raise InputError(
            argument="o_ring", got=ring, accepted="a result of em.o_ring(...)"
        )
    if not isinstance(material, Prony):
        raise InputError(
            argument="material",
            got=material,
            accepted="the rubber of the O-ring (em.Prony, em.load_material(...))",
        )
    if material.name in ring.materials:
        ring = ring.select(material.name)
    law = normal_operator(material)
    try:
        modulus = np.asarray(_modulus(law, material, ring.time, ring.temperature))
    except InputError as error:
        had = "no temperature" if ring.temperature is None else "a temperature"
        raise InputError(
            argument="material",
            got=material,
            accepted="the rubber of the O-ring",
            hint=f"that was made with {had}, which this one wants {error.accepted}",
        ) from error
    size: Any = 8 * ring.line_load * ring.diameter / (np.pi * ring.width**2)
    known = np.asarray(size)
    fits = np.isclose(modulus, known, rtol=1e-6)
    if not fits.all():
        i = int(np.argmin(fits))
        modulus = np.broadcast_to(modulus, fits.shape)
        raise InputError(
            argument="material",
            got=material,
            accepted="the rubber of the O-ring, whose modulus E* is "
            f"{known.flat[i]:.4g} Pa at its time and temperature",
            hint=f"this one has {modulus.flat[i]:.4g} Pa",
        )
    return ring


def _solve(given: _Cord, young: Array, plane: Array, formula: str) -> tuple[Any, Any]:
    """W [N/m], and the width 2a = sqrt(8 W d/(pi E*)) [m]."""
    diameter, squeeze = given.diameter, given.squeeze
    if formula == "lindley":
        load_per_modulus = 1.25 * squeeze**1.5 + 50 * squeeze**6
        modulus = young
    else:
        load_per_modulus = _small_strain(squeeze)
        modulus = plane
        powers = _LARGE_STRAIN.get(formula, (1.0,))
        load_per_modulus = load_per_modulus * sum(
            factor * squeeze**i for i, factor in enumerate(powers)
        )
    load = modulus * diameter * load_per_modulus
    width = diameter * xp.sqrt(8 / np.pi * load_per_modulus * modulus / plane)
    return load, width


def _small_strain(squeeze: Array) -> Any:
    """W/(E* d) of two Hertzian contacts: both halves of the cord approach its middle by
    C d/2.
    """
    # u - ln u = ln(4/C) - 1 by Newton's method; s = 4 exp(-1 - u)
    target = xp.log(4 / squeeze) - 1
    u = target + xp.log(target + 1)
    for _ in range(_NEWTON_STEPS):
        u = u - (u - xp.log(u) - target) / (1 - 1 / u)
    return np.pi / 2 * 4 * xp.exp(-1 - u)
