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

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..arrays import is_traced, numpy_unless_traced, xp
from ..call.extrapolation import NOT_KNOWN, held_beyond
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
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
from ..results.words import brief
from .o_ring_result import ORing

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Solid

_MOST = 0.25  # squeeze up to which the formula holds
_STEPS = 8  # of Newton's method: u - ln u is nearly straight, and convex


MODELS = {
    "lindley": (
        "Lindley's formula for the load (measured cords), Hertz' width; straight "
        "cord, free to bulge"
    ),
    "hertz": (
        "plane contact at small strain, load and width of Hertz; straight cord, free "
        "to bulge"
    ),
}


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
    needs_series("material", material, "a squeezed cord")
    if not isinstance(material, Prony):
        raise InputError(
            "material must be that of the cord (em.Prony, em.load_material(...)), not "
            "a foundation: its load needs "
            f"Young's modulus, got {material!r}."
        )
    if formula not in ("lindley", "hertz"):
        raise InputError(f"formula must be 'lindley' or 'hertz', got {formula!r}.")
    d, part = as_float64("diameter", diameter), as_float64("squeeze", squeeze)
    positive("diameter", d)
    accepted = f"positive and at most {_MOST:g}, a part of the diameter"
    require("squeeze", part, accepted, lambda c: (c > 0) & (c <= _MOST))
    if time is not None:
        time = as_float64("time", time)
    if temperature is not None:
        temperature = as_float64("temperature", temperature)
    laws = material.tensile().law(), normal_operator(material)
    young, plane = (_modulus(law, material, time, temperature) for law in laws)
    if not is_traced(young) and not np.all(young > 0):
        raise InputError(
            "time must be given for a material without an equilibrium modulus: it "
            "relaxes altogether."
        )
    # W/(modulus d)
    relative = (
        1.25 * part**1.5 + 50 * part**6 if formula == "lindley" else _small_strain(part)
    )
    modulus = young if formula == "lindley" else plane
    shape = broadcast_shape(
        diameter=d, squeeze=part, time=time, temperature=temperature
    )
    load, width = (
        modulus * d * relative,
        d * xp.sqrt(8 / np.pi * relative * modulus / plane),
    )
    given = [
        ("diameter", d, "m"),
        ("squeeze", part, "of the diameter"),
        ("time", time, "s"),
        ("temperature", temperature, "K"),
    ]
    inputs = [("material", material.name or "given directly")]
    inputs += [
        (name, brief(value, unit)) for name, value, unit in given if value is not None
    ]
    inputs += [("relaxed", "altogether")] if time is None else []
    fields = {
        "line_load": load,
        "width": width,
        "pressure": load / width,
        "error": 0.0,
        "converged": True,
    }
    fields |= {name: value for name, value, _ in given}
    beyond = NOT_KNOWN
    if not is_traced(young, d, part):
        factor = (
            1.0 if temperature is None else thermal_factors(material, temperature)[0]
        )
        beyond = held_beyond(
            material.range,
            time,
            temperature,
            np.broadcast_to(factor, shape),
            stacklevel=4,
        )
    whole: dict[str, Any] = {
        name: None if x is None else xp.broadcast_to(x, shape)
        for name, x in fields.items()
    }
    return ORing(
        **whole,
        extrapolated=beyond.points,
        model=MODELS[formula],
        plan="closed form",
        inputs=(*inputs, *beyond.said),
    )


def _modulus(law: Relaxation, material: Prony, time: Any, temperature: Any) -> Any:
    """A modulus at a time and a temperature; relaxed without a time."""
    factor, vertical = 1.0, 1.0
    if temperature is not None:
        in_kelvin("temperature", temperature)
        factor, vertical = thermal_factors(material, temperature)
    if time is None:
        return law.equilibrium * vertical
    not_negative("time", time)
    broadcast_shape(time=time, temperature=temperature)
    return law.relaxation(time / factor) * vertical


def _small_strain(part: Any) -> Any:
    """W/(E* d) of two Hertzian contacts: both halves of the cord approach its middle by
    C d/2.
    """
    target = xp.log(4 / part) - 1
    u = target + xp.log(target + 1)
    for _ in range(_STEPS):
        u = u - (u - xp.log(u) - target) / (1 - 1 / u)
    return np.pi / 2 * 4 * xp.exp(-1 - u)
