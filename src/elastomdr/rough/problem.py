"""What a road is asked for."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

from ..call.problem import Asked
from .adhesion import AdhesiveShear
from .heat import Branch, Heat

if TYPE_CHECKING:
    from collections.abc import Callable

    from .._types import Number
    from ..call.types import Material, Surface


@dataclasses.dataclass(frozen=True)
class RoughCall:
    """A rough line or surface in steady sliding, as `em.friction` was asked for it."""

    material: Material
    surface: Surface
    asked: Asked
    rtol: float = 1e-6
    heat: Heat | None = None
    adhesion: AdhesiveShear | None = None
    strain_share: Number = 0.5
    progress: Callable[[int, int], None] | None = None
    branch: Branch = "cold"  # of several steady states with heat
