"""`em.friction` of a smooth body with `em.HalfSpace`: the three-dimensional references
as a model.
"""

import dataclasses
from typing import Any

from ..element.layer import Layer
from ..rough.adhesion import on_cells
from ..smooth.problem import no_pressure
from ..smooth.softening import LINEAR
from .half_space import half_space_sliding
from .layer import layer_sliding


def friction_on_cells(
    material: Any,
    shape: Any,
    cells: int,
    *,
    pressure: Any,
    adhesion: Any,
    **scene: Any,
) -> Any:
    """A curve of a smooth body on a half-space or a layer of cells. Raises
    `InputError`.
    """
    no_pressure(shape, pressure)
    solver: Any = layer_sliding if isinstance(material, Layer) else half_space_sliding
    curve = solver(material, shape, points=cells, **scene)
    if getattr(material, "softening", None) is not None:
        curve = dataclasses.replace(curve, model=curve.model + LINEAR)
    return curve if adhesion is None else on_cells(curve, adhesion)
