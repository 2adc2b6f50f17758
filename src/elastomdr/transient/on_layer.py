"""Bodies pressed straight down on rubber of finite thickness: from a layer to the
elements that stand for it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import is_traced
from ..element.law import Foundation, half_space
from ..element.layer import Layer
from ..errors import InputError
from ..material.prony import Prony
from ..surface.shapes import AbstractShape, Cylinder
from .layer_disc import LayerDisc, layer_disc

if TYPE_CHECKING:
    from ..checks import Array

# (a/h)^2 G/K below which rubber of a bulk modulus K is incompressible on a layer
_STIFFER = 0.01


def of_layer(material: Layer, shape: AbstractShape) -> tuple[LayerDisc, Foundation]:
    """The elements of an axisymmetric contact on a layer and what they are made of.
    Raises `InputError`.
    """
    if isinstance(shape, Cylinder):
        raise InputError(
            "shape must be axisymmetric in a normal contact on an em.layer, got a "
            "Cylinder: em.rolling and em.friction take it, or em.springs(material, "
            "thickness) here."
        )
    if material.other is not None:
        raise InputError(
            "material must be one em.layer under an axisymmetric body, got two covers."
        )
    solid: Any = material.material
    if not isinstance(solid, Prony):
        raise InputError(
            "material must be a series (em.Prony) for a history in time, got a "
            "table of moduli."
        )
    # incompressible, as far as `incompressible_enough` allows
    if not material.constant:
        shear = solid.shear()
        solid = Prony(
            shear.equilibrium,
            shear.moduli,
            shear.times,
            viscosity=shear.viscosity,
            shift=shear.shift,
            vertical=shear.vertical,
            name=shear.name,
        )
    squeeze = 0.0 if not material.constant else material.squeeze()
    squeeze = squeeze if is_traced(squeeze) else float(np.asarray(squeeze))
    foundation = half_space(solid)
    return layer_disc(shape, material.thickness, squeeze, material.bonded), foundation


def incompressible_enough(
    material: Layer, disc: LayerDisc, radius: Array, force: Array
) -> None:
    """Refuses a constant bulk modulus where it would show, since W then depends on
    time. Raises `InputError`.
    """
    bulk: Any = getattr(material.material, "bulk", None)
    if bulk is None or is_traced(bulk, disc, radius, force):
        return
    there = np.isfinite(radius) & (radius > 0)
    a = np.asarray(radius)[there]
    if not a.size:
        return
    shear = np.asarray(force)[there] / (4 * np.asarray(disc.area(a)))
    share = float(np.max((a / float(disc.thickness)) ** 2 * shear / float(bulk)))
    if share > _STIFFER:
        raise InputError(
            "bulk must be left out, or so large that (a/h)^2 G/K stays below "
            f"{_STIFFER:g} in a history on a layer; it reaches {share:.2g} here with "
            f"K = {float(bulk):.4g} Pa. Give a constant Poisson's ratio in its place, "
            "or "
            "use em.springs(material, thickness) where the contact is much wider than "
            "the layer is thick."
        )
