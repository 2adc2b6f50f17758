"""A gas in the channels of a seal: it expands on its way, and slips at the walls.

    m = (width/length) int rho s dp,      rho = p M/(R T),      from p_2 to p_1, absolute,
    s = w (1 + 6 Kn)/(12 viscosity),      Kn = l/w^(1/3),       l = l_2 p_2/p

The mean free path l falls as the pressure grows, so that with p_m = (p_1 + p_2)/2 the
volume at the outlet is exactly

    Q_2 = m/rho_2 = (width/length) s(l_2 p_2/p_m) (p_1^2 - p_2^2)/(2 p_2).

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

from ..arrays import xp
from ..checks import require
from ..errors import InputError
from ..material.shift import GAS_CONSTANT

SLIPS = 0.1  # Kn up to which a gas slips, and does not fly freely
SAID = "; ideal gas that expands, with slip (estimate)"
SAID_OF_MAPS = "; ideal gas that expands, with slip of each gap"


class GasFlow(NamedTuple):
    """What a gas changes."""

    flow: Any  # w with slip, at the mean pressure [m^3]
    knudsen: Any  # Kn there; NaN where nothing flows
    expansion: Any  # p_m/p_2, outlet volume over that of a liquid
    density: Any  # at the outlet [kg/m^3], or None


def check_gas(given: dict[str, Any]) -> None:
    """Raises `InputError` unless there is all that a gas needs, or a liquid is
    meant.
    """
    outlet, path, mass = (
        given[name] for name in ("outlet_pressure", "mean_free_path", "molar_mass")
    )
    if outlet is None:
        for name in ("mean_free_path", "molar_mass"):
            if given[name] is not None:
                raise InputError(
                    f"{name} belongs to a gas: give outlet_pressure [Pa] as well, the "
                    "absolute pressure behind the seal, 101325 for the atmosphere."
                )
        return
    if (path is None) == (mass is None):
        raise InputError(
            "outlet_pressure makes the fluid a gas: give either molar_mass [kg/mol], "
            "with temperature, or mean_free_path [m] at the outlet (0: without slip), "
            f"got {'neither' if path is None else 'both'}."
        )
    if mass is not None and given["temperature"] is None:
        raise InputError(
            "temperature [K] must be given with molar_mass: the mean free path of a gas "
            "depends on it. A rubber without a shift law is then the same at every "
            "temperature."
        )
    if mass is not None:
        accepted = "in kg/mol, at most 1 (0.028 of nitrogen)"
        require("molar_mass", mass, accepted, lambda x: (x > 0) & (x <= 1))
    if mass is not None and given["density"] is not None:
        raise InputError(
            "density must be left out with molar_mass, which gives that of the gas at "
            "the outlet."
        )


def check_absolute(name: str, value: Any) -> None:
    """Raises `InputError` for a pressure that can only be meant over the
    atmosphere's.
    """
    accepted = "an absolute pressure [Pa], positive (101325 is the atmosphere, not 0)"
    require(name, value, accepted, lambda x: (x > 0) & np.isfinite(x))


def gas_flow(given: dict[str, Any], flow: Any, slip: Any = None) -> GasFlow:
    """The gas from w of a liquid [m^3]; `slip` is dw/dl [m^2], if known."""
    outlet, temperature, mass = (
        given[name] for name in ("outlet_pressure", "temperature", "molar_mass")
    )
    mean = outlet + 0.5 * given["pressure_drop"]
    path, density = given["mean_free_path"], None
    if mass is not None:
        specific = GAS_CONSTANT * temperature / mass
        path = given["viscosity"] / outlet * xp.sqrt(0.5 * np.pi * specific)
        density = outlet / specific
    is_open = flow > 0
    gap = xp.where(is_open, flow, 1.0) ** (1 / 3)
    knudsen = path * outlet / mean / gap
    slip = 6 * gap**2 if slip is None else slip
    slipping = xp.where(is_open, flow + slip * knudsen * gap, 0.0)
    knudsen = xp.where(is_open, knudsen, xp.nan)
    return GasFlow(slipping, knudsen, mean / outlet, density)


def bound(model_error: Any, knudsen: Any) -> Any:
    """`model_error` of a liquid with all of the slip as uncertain, or 0 for maps
    (None), of which each gap slips; NaN where the gas no more slips than flies.
    """
    slip = xp.where(xp.isnan(knudsen), 0.0, 6 * knudsen)
    maps = model_error is None
    both = 0 * slip if maps else (1 + model_error) * (1 + slip) - 1
    return xp.where(slip > 6 * SLIPS, xp.nan, both)
