"""Radok's functional equations: elastic constants of the half-space and the layer
become relaxation functions.

Radok (1957): replace the elastic constants of the elastic solution by operators. With a
constant bulk modulus the result is again a Prony series, exactly, since a multiple of G
in series with a spring is one (`material.relaxation`).
"""

from __future__ import annotations

from typing import Any

from ..checks import is_traced, numpy_unless_traced
from ..errors import InputError
from ..material.prony import Prony
from ..material.relaxation import Relaxation, parallel, scaled, series, spring


@numpy_unless_traced
def normal_operator(material: Prony) -> Relaxation:
    """E*(t) of a half-space pressed normally [Pa].

    Constant Poisson's ratio: E* = 2G/(1-nu). Constant bulk modulus: E* =
    4G(3K+G)/(3K+4G) = G + [1/(3G) + 4/(9K)]^-1. Exact; 2n branches in the second case.
    Source: Radok 1957; Popov & Hess 2015, ch. 7.
    """
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is not None:
        return scaled(shear, 2 / (1 - material.poisson))
    return parallel(shear, series(scaled(shear, 3.0), spring(9 * bulk / 4)))


@numpy_unless_traced
def tangential_operator(material: Prony) -> Relaxation:
    """G*(t) of a half-space sheared at its surface [Pa].

    Constant Poisson's ratio: G* = 4G/(2-nu). Constant bulk modulus: G* =
    8G(3K+G)/(3(3K+2G)) = (4/3) G + [3/(4G) + 1/(2K)]^-1. Exact. Source: as
    `normal_operator`.
    """
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is not None:
        return scaled(shear, 4 / (2 - material.poisson))
    return parallel(
        scaled(shear, 4 / 3), series(scaled(shear, 4 / 3), spring(2 * bulk))
    )


@numpy_unless_traced
def layer_operator(material: Prony, bonded: bool) -> Relaxation:
    """Modulus of a thin layer on a rigid base [Pa]; divided by the thickness it is the
    layer's stiffness per area.

    Bonded: K + 4G/3 (no lateral strain). Frictionless base: 2G/(1-nu), which is
    E/(1-nu^2) (plane strain without lateral stress), the same operator as E*. Thin
    means: contact width much larger than the thickness. A bonded incompressible layer
    does not act as a row of springs (its pressure obeys Reynolds' equation) and raises
    `InputError`. Source: Johnson, Contact Mechanics (1985), section 5.8.
    """
    if not bonded:
        return normal_operator(material)
    shear = material.shear().law()
    bulk: Any = material.bulk  # None with a constant Poisson's ratio
    if material.poisson is None:
        law = scaled(shear, 4 / 3)
        return Relaxation(law.equilibrium + bulk, law.moduli, law.times, law.viscosity)
    if not is_traced(material.poisson) and material.poisson >= 0.5:
        raise InputError(
            "poisson must be below 0.5 for bonded springs, got "
            f"{float(material.poisson):g}: a bonded incompressible "
            "layer does not act as a row of springs. Use em.layer(material, "
            "thickness), which holds for any thickness and any Poisson's ratio; a "
            "bulk modulus in its place would make the springs hundreds of times too "
            "stiff."
        )
    return scaled(shear, 2 * (1 - material.poisson) / (1 - 2 * material.poisson))
