"""A gas in the channels of a seal: it expands on its way, and slips at the walls.

    m = (width/length) int rho s dp,      rho = p M/(R T),      from p_2 to p_1, absolute,
    s = w (1 + 6 Kn)/(12 viscosity),      Kn = l/w^(1/3),       l = l_2 p_2/p

`along.py` takes the integral; if w were even along the seal, the volume at the outlet
would be m/rho_2 = (width/length) s(l_2 p_2/p_m) (p_1^2 - p_2^2)/(2 p_2), p_m = (p_1 +
p_2)/2. Kn of a seal is that of its slip, l_2 int w^(2/3) dp over int w p/p_2 dp.

The gap of the slip is that of even planes which conduct as much, w^(1/3): against maps
on which each gap slips by itself, 1 + 6 l/g, the share of slip is right in light contact
and up to 1.6 times too high at a real contact of 0.3. Maps know their own, dw/dl to
first order. By kinetic theory

    l = (viscosity/p) sqrt(pi R T/(2 M)).

Sources: J. C. Maxwell, Phil. Trans. R. Soc. 170 (1879) 231 (slip at diffuse walls);
E. H. Kennard, Kinetic Theory of Gases (1938).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..arrays import Array, xp
from ..checks import require
from ..errors import InputError
from ..material.shift import GAS_CONSTANT
from .along import Fluid

SLIPS = 0.1  # Kn up to which a gas slips, and does not fly freely
SAID = "; ideal gas that expands, with slip (estimate)"
SAID_OF_MAPS = "; ideal gas that expands, with slip of each gap"


class LeakGiven(NamedTuple):
    """What is given to `em.leak`, under its names, as arrays."""

    pressure: Array  # the mean along the flow
    pressure_drop: Array
    viscosity: Array
    length: Array
    width: Array
    density: Array | None = None
    outlet_pressure: Array | None = None
    mean_free_path: Array | None = None
    molar_mass: Array | None = None
    time: Array | None = None
    temperature: Array | None = None


def check_gas(given: LeakGiven) -> None:
    """Raises `InputError` unless there is all that a gas needs, or a liquid is
    meant.
    """
    outlet, path, mass = given.outlet_pressure, given.mean_free_path, given.molar_mass
    if outlet is None:
        for name, value in (("mean_free_path", path), ("molar_mass", mass)):
            if value is not None:
                raise InputError(
                    argument=name,
                    got=value,
                    accepted="left out without outlet_pressure, which a gas has",
                    hint="it is the absolute pressure behind the seal [Pa], 101325 for "
                    "the atmosphere",
                )
        return
    if path is None and mass is None:
        raise InputError(
            argument="molar_mass",
            accepted="given for a gas [kg/mol], with temperature",
            hint="or mean_free_path [m] at the outlet (0: without slip); the fluid is "
            "a gas with outlet_pressure",
        )
    if path is not None and mass is not None:
        accepted = "left out with molar_mass, which gives it"
        raise InputError(argument="mean_free_path", got=path, accepted=accepted)
    if mass is not None and given.temperature is None:
        raise InputError(
            argument="temperature",
            accepted="given [K] with molar_mass",
            hint="the mean free path of a gas depends on it; a rubber without a shift "
            "law is then the same at every temperature",
        )
    if mass is not None:
        accepted = "in kg/mol, at most 1 (0.028 of nitrogen)"
        require("molar_mass", mass, accepted, lambda x: (x > 0) & (x <= 1))
    if mass is not None and given.density is not None:
        raise InputError(
            argument="density",
            got=given.density,
            accepted="left out with molar_mass, which gives that of the gas at the "
            "outlet",
        )


def check_absolute(name: str, value: Array) -> None:
    """Raises `InputError` for a pressure that can only be meant over the
    atmosphere's.
    """
    accepted = "an absolute pressure [Pa], positive (101325 is the atmosphere, not 0)"
    require(name, value, accepted, lambda x: (x > 0) & np.isfinite(x))


def fluid_of(given: LeakGiven) -> tuple[Fluid, LeakGiven]:
    """The gas or liquid, and what is given with the density of a gas at the outlet."""
    outlet, path, mass = given.outlet_pressure, given.mean_free_path, given.molar_mass
    if outlet is None:
        return Fluid(), given
    if mass is not None and given.temperature is not None:
        specific = GAS_CONSTANT * given.temperature / mass
        path = given.viscosity / outlet * xp.sqrt(0.5 * np.pi * specific)
        given = given._replace(density=outlet / specific)
    return Fluid(1 / outlet, path), given


def bound(model_error: Array | None, knudsen: Array) -> Any:
    """`model_error` of a liquid with all of the slip as uncertain, or 0 for maps
    (None), of which each gap slips; NaN where the gas no more slips than flies.
    """
    slip = xp.where(xp.isnan(knudsen), 0.0, 6 * knudsen)
    maps = model_error is None
    both = 0 * slip if maps else (1 + model_error) * (1 + slip) - 1
    return xp.where(slip > 6 * SLIPS, xp.nan, both)
