"""A rubber cord squeezed between flat walls, such as an O-ring in its groove: its load
and the width it touches on.

Per length of cord of diameter d, squeezed by the part C of d, free to bulge, E = 2 G(t)
(1 + nu), E* = E/(1 - nu^2):

    "lindley"
    W = E d (1.25 C^1.5 + 50 C^6)
    fitted to measurements, C up to 0.25
    "hertz"     C = s [ln(4/s) - 1],  W = (pi/2) E* d s              small strain, plane strain
    both        2a = sqrt(8 W d/pi E*) (Hertz),  p = W/2a            width and mean pressure

Rubber is nearly incompressible: E = 3 G(t), E* = 4 E/3. Lindley measured rubber; for nu
far below 0.5 nothing is known.

In "hertz" s = (a/d)^2. With u = ln(4/s) - 1 it is u - ln u = ln(4/C) - 1, solved by
Newton's method. Lindley's load is 0.74 of it at C = 0.08 and 0.86 at C = 0.2. Sources:
P. B. Lindley, J. Inst. Rubber Ind. 1 (1967) 209 (recalled, not compared with the paper;
Kim et al., Eng. Failure Anal. 14 (2007) 1680: near to finite elements, below what they
measured); K. L. Johnson, Contact Mechanics (1985), section 5.6.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from ..arrays import is_traced, numpy_unless_traced, xp
from ..call.extrapolation import NOT_KNOWN, Beyond, held_beyond
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast,
    broadcast_shape,
    in_kelvin,
    not_negative,
    positive,
    require,
)
from ..element.law import normal_operator
from ..errors import InputError
from ..material.prony import Prony
from ..material.relaxation import Relaxation
from ..material.shift import thermal_factors
from ..material.tabulated import needs_series
from ..results.base import Array, Result, quantity, record
from ..results.words import brief, in_unit, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Solid

_LARGEST_SQUEEZE = 0.25  # up to which the formula holds
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
}
_UNITS = {
    "diameter": "m",
    "squeeze": "of the diameter",
    "time": "s",
    "temperature": "K",
}


@record
class ORing(Result):
    """Contact of a squeezed cord with either wall.

    `error` is that of the arithmetic alone, zero: what the formula itself leaves open
    `model` says.
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

    title: ClassVar[str] = "Squeezed cord"
    across: ClassVar[str] = "squeeze"
    scale: ClassVar[str] = "auto"
    shows: ClassVar[str] = "pressure"
    error_of: ClassVar[str] = "the arithmetic"
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
        show: Literal["pressure", "width", "line_load"] = "pressure",
    ) -> "Axes":
        """Draws pressure, width or line_load against time where there are several
        times, else against the squeeze.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        shown = ("pressure", "width", "line_load")
        if show not in shown:
            raise InputError(f"show must be one of {', '.join(shown)}, got {show!r}.")
        from ..results.plotting import Ask, draw

        x = "time" if any(axis.name == "time" for axis in self.axes()) else "squeeze"
        return self._draw(draw, Ask(ax, style, title, label), x=x, y=show)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of line load, width and pressure."""
        yield "line load", span(self.line_load, "N/m")
        yield "contact width", span(in_unit(self.width, "mm"), "mm")
        yield "mean pressure", span(in_unit(self.pressure, "MPa"), "MPa")


@over_materials
@numpy_unless_traced
def o_ring(
    material: Solid | Sequence[Solid],
    diameter: ArrayLike,
    squeeze: ArrayLike,
    *,
    time: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    formula: Literal["lindley", "hertz"] = "lindley",
) -> ORing:
    """Line load, contact width and mean pressure of a cord (an O-ring) squeezed between
    flat walls, free to bulge.

        W = E d (1.25 C^1.5 + 50 C^6),   2a = sqrt(8 W d/(pi E*)),   p = W/2a,   E = 2 G(t) (1 + nu)

    with E* = E/(1 - nu^2): 3 G and 4 G for an incompressible rubber.

    Args:
        material: the cord's own material, between rigid walls; no foundation, which has
            E* but not E.
        diameter: diameter of the cord d [m]; arguments broadcast.
        squeeze: part C of the diameter by which the cord is squeezed, up to 0.25.
        time: time t since it was squeezed, at once and held [s]; without it the rubber
            is relaxed.
        temperature: temperature [K], for a material with a shift law.
        formula: "lindley", or "hertz" for W of small strain (Johnson 1985, 5.6), which
            is 35 % higher at C = 0.08 and 16 % higher at C = 0.2.

    Returns:
        An `em.ORing` of the broadcast shape.

    Raises:
        InputError: for a foundation, a squeeze above 0.25, and an unknown formula.

    The cord is taken as straight, which is right for rings much larger than their cord,
    without friction at the walls, in a groove that it does not fill. Relaxation scales
    the load (linear viscoelasticity at a constant shape). Differentiable.

    Source: P. B. Lindley, J. Inst. Rubber Ind. 1 (1967) 209, quoted from memory.
    """
    solid = _checked_material(material)
    if formula not in FORMULAS:
        raise InputError(f"formula must be 'lindley' or 'hertz', got {formula!r}.")
    given = _checked(diameter, squeeze, time, temperature)
    young, plane = (
        _modulus(law, solid, given["time"], given["temperature"])
        for law in (solid.tensile().law(), normal_operator(solid))
    )
    if not is_traced(young) and not np.all(young > 0):
        raise InputError(
            "time must be given for a material without an equilibrium modulus: it "
            "relaxes completely."
        )
    shape = broadcast_shape(**given)
    load, width = _load_and_width(
        given["diameter"], given["squeeze"], young, plane, formula
    )
    beyond = NOT_KNOWN
    if not is_traced(young, given["diameter"], given["squeeze"]):
        beyond = _extrapolated(solid, given["time"], given["temperature"], shape)
    fields: dict[str, Any] = {
        **given,
        "line_load": load,
        "width": width,
        "pressure": load / width,
        "error": 0.0,
        "converged": True,
    }
    return ORing(
        **broadcast(**fields),
        extrapolated=beyond.points,
        model=FORMULAS[formula],
        plan="closed form",
        inputs=(*_inputs_in_words(solid, given), *beyond.said),
    )


def _checked_material(material: Any) -> Prony:
    """The material. Raises `InputError` for anything but a Prony series."""
    needs_series("material", material, "a squeezed cord")
    if not isinstance(material, Prony):
        raise InputError(
            "material must be that of the cord (em.Prony, em.load_material(...)), "
            "not a foundation: the load depends on Young's modulus, got "
            f"{material!r}."
        )
    return material


def _checked(
    diameter: Any, squeeze: Any, time: Any, temperature: Any
) -> dict[str, Any]:
    """The arguments as arrays. Raises `InputError`."""
    arguments = {
        "diameter": diameter,
        "squeeze": squeeze,
        "time": time,
        "temperature": temperature,
    }
    given = {
        name: None if value is None else as_float64(name, value)
        for name, value in arguments.items()
    }
    positive("diameter", given["diameter"])
    require(
        "squeeze",
        given["squeeze"],
        f"positive and at most {_LARGEST_SQUEEZE:g}, a part of the diameter",
        lambda c: (c > 0) & (c <= _LARGEST_SQUEEZE),
    )
    return given


def _modulus(law: Relaxation, material: Prony, time: Any, temperature: Any) -> Any:
    """A modulus at a time and a temperature; relaxed without a time."""
    time_factor, vertical_factor = 1.0, 1.0
    if temperature is not None:
        in_kelvin("temperature", temperature)
        time_factor, vertical_factor = thermal_factors(material, temperature)
    if time is None:
        return law.equilibrium * vertical_factor
    not_negative("time", time)
    broadcast_shape(time=time, temperature=temperature)
    return law.relaxation(time / time_factor) * vertical_factor


def _load_and_width(
    diameter: Any, squeeze: Any, young: Any, plane: Any, formula: str
) -> tuple[Any, Any]:
    """W [N/m], and the width 2a = sqrt(8 W d/(pi E*)) [m]."""
    if formula == "lindley":
        load_per_modulus = 1.25 * squeeze**1.5 + 50 * squeeze**6
        modulus = young
    else:
        load_per_modulus = _small_strain(squeeze)
        modulus = plane
    load = modulus * diameter * load_per_modulus
    width = diameter * xp.sqrt(8 / np.pi * load_per_modulus * modulus / plane)
    return load, width


def _small_strain(squeeze: Any) -> Any:
    """W/(E* d) of two Hertzian contacts: both halves of the cord approach its middle by
    C d/2.
    """
    # u - ln u = ln(4/C) - 1 by Newton's method; s = 4 exp(-1 - u)
    target = xp.log(4 / squeeze) - 1
    u = target + xp.log(target + 1)
    for _ in range(_NEWTON_STEPS):
        u = u - (u - xp.log(u) - target) / (1 - 1 / u)
    return np.pi / 2 * 4 * xp.exp(-1 - u)


def _extrapolated(
    material: Prony, time: Any, temperature: Any, shape: tuple[int, ...]
) -> Beyond:
    """Which points lie outside the range of the material, with a warning."""
    time_factor = (
        1.0 if temperature is None else thermal_factors(material, temperature)[0]
    )
    return held_beyond(
        material.range,
        time,
        temperature,
        np.broadcast_to(time_factor, shape),
    )


def _inputs_in_words(material: Prony, given: dict[str, Any]) -> list[tuple[str, str]]:
    inputs = [("material", material.name or "given directly")]
    inputs += [
        (name, brief(given[name], unit))
        for name, unit in _UNITS.items()
        if given[name] is not None
    ]
    return inputs if given["time"] is not None else [*inputs, ("relaxed", "completely")]
