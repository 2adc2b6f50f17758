"""The types of arguments that are objects of this package, for editors and type
checkers only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal, TypeAlias

if TYPE_CHECKING:
    from ..element.law import Foundation, TabulatedFoundation
    from ..element.layer import Layer
    from ..material.prony import Prony
    from ..material.tabulated import TabulatedModulus
    from ..models import Model
    from ..surface.rough_line import RoughLine
    from ..surface.shapes import AbstractShape
    from ..surface.spectrum import AbstractSpectrum

# A file or the library may hold either.
Solid: TypeAlias = "Prony | TabulatedModulus"
Material: TypeAlias = (
    "Prony | TabulatedModulus | Foundation | TabulatedFoundation | Layer"
)
# One, or several along the first axis of the result.
Materials: TypeAlias = "Material | Sequence[Material]"

# A smooth body, and a rough surface.
SteadyBody: TypeAlias = "Foundation | TabulatedFoundation"  # under a rough surface
Indenter: TypeAlias = "AbstractShape"
Surface: TypeAlias = "RoughLine | AbstractSpectrum"

ModelName: TypeAlias = Literal[
    "averaged",
    "line",
    "marched",
    "multiscale",
    "persson",
    "half-space",
]
ModelLike: TypeAlias = "Model | ModelName"
