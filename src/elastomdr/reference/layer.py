"""Steady sliding on rubber of finite thickness in three dimensions: the half-space's
cells with the layer's kernel.

A layer is stiffer than a half-space by a smooth part of the influence function of a
point,

    u(r) = P/(pi E*) [1/r - (1/h) n(r/h)],    n(y) = int_0^inf (1 - W(z)) J_0(z y) dz,

which is kept as Chebyshev series on short panels. W is odd in z, so that the whole of u
falls exponentially beyond a few thicknesses, and is taken as zero from y = 14 on.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING, Any

import numpy as np

from ..checks import numpy_unless_traced
from ..element.layer import Layer, layer_deficit
from ..errors import InputError
from ..numerics.quadrature import gauss_on_panels
from ..rough.adhesion import on_cells
from ..smooth.problem import no_pressure
from ..smooth.softening import LINEAR
from ..trees import Tree, static
from .half_space import half_space_sliding, slide

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter
    from ..results.curve import FrictionCurve

MODEL = "layer in three dimensions, cells of constant pressure (no reduction)"
_FAR, _PANEL, _DEGREE = 14.0, 0.5, 9


class Cover(Tree):
    """What a layer changes in the half-space's cells."""

    near: np.ndarray  # Chebyshev coefficients of n on panels of y
    bend: np.ndarray  # of its Laplacian
    squeeze: Any  # 1 - 2 nu
    thickness: Any
    bonded: bool = static()

    def less(self, r: np.ndarray, cell: tuple[float, float]) -> np.ndarray:
        """By how much a loaded cell moves the surface at r less than that of a
        half-space, per unit of pressure.
        """
        y = r / self.thickness
        # mean over the cell
        table = (
            self.near
            + self.bend * (cell[0] ** 2 + cell[1] ** 2) / 48 / self.thickness**2
        )
        i = np.clip((y / _PANEL).astype(int), 0, table.shape[0] - 1)
        t = 2 * (y / _PANEL - i) - 1
        rows = table[i]
        b1 = b2 = np.zeros_like(y)
        for n in range(_DEGREE, 0, -1):
            b1, b2 = rows[..., n] + 2 * t * b1 - b2, b1
        return (
            cell[0] * cell[1] / (np.pi * self.thickness) * (rows[..., 0] + t * b1 - b2)
        )


@numpy_unless_traced
def layer_sliding(
    material: Layer,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    points: int = 64,
) -> FrictionCurve:
    """Friction of a rigid body in steady, frictionless sliding on a layer, in three
    dimensions.

    Arguments, result and errors as of `half_space_sliding`, whose cells it uses with
    the influence function of the layer; `material` is an `em.layer` of a material with
    a constant Poisson's ratio. The body is alone on an infinite layer. Raises
    `InputError` as well for a constant bulk modulus, and for two covers.
    """
    return slide(
        foundation_of(material),
        shape,
        velocity,
        load,
        depth,
        temperature,
        points,
        cover_of(material),
        MODEL,
    )


def friction_on_cells(
    material: Any,
    shape: Any,
    cells: int,
    *,
    pressure: Any,
    adhesion: Any,
    **scene: Any,
) -> Any:
    """`em.friction` of a smooth body on a half-space or a layer with `em.HalfSpace`.
    Raises `InputError`.
    """
    no_pressure(shape, pressure)
    solver: Any = layer_sliding if isinstance(material, Layer) else half_space_sliding
    curve = solver(material, shape, points=cells, **scene)
    if getattr(material, "softening", None) is not None:
        curve = dataclasses.replace(curve, model=curve.model + LINEAR)
    return curve if adhesion is None else on_cells(curve, adhesion)


def cover_of(material: Layer) -> Cover:
    """The kernel of a layer. Raises `InputError` for one that depends on time."""
    if not isinstance(material, Layer):
        raise InputError(f"material must be an em.layer(...), got {material!r}.")
    if material.other is not None or not material.constant:
        raise InputError(
            (
                "material must be one em.layer of a material with a constant "
                "Poisson's ratio in three dimensions, got "
            )
            + (
                "two covers."
                if material.other is not None
                else "one with a constant bulk modulus."
            )
        )
    squeeze = float(np.asarray(material.squeeze()))
    return Cover(
        *_tables(squeeze, material.bonded),
        squeeze,
        float(material.thickness),
        material.bonded,
    )


def foundation_of(material: Layer) -> Any:
    """The half-space of the same material."""
    from ..element.law import half_space

    return half_space(material.material)


@functools.lru_cache(16)
def _tables(squeeze: float, bonded: bool) -> tuple[np.ndarray, np.ndarray]:
    from scipy.special import j0

    z, dz = gauss_on_panels(np.linspace(0.0, 20.0, 61), 24)
    lack = dz * numpy_unless_traced(layer_deficit)(z, squeeze, bonded)
    nodes = np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))
    order = np.polynomial.chebyshev.chebvander(nodes, _DEGREE).T * 2 / (_DEGREE + 1)
    order[0] *= 0.5
    y = _PANEL * (np.arange(round(_FAR / _PANEL))[:, None] + 0.5 * (1 + nodes))
    wave = j0(y[..., None] * z)
    return (wave @ lack) @ order.T, -(wave @ (lack * z**2)) @ order.T
