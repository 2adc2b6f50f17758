"""What to check the fast answers against: contacts in two and three dimensions, without
reduction; closed forms.
"""

from typing import Any

from ..errors import closest
from ..surface.spectrum import rough_map
from .closed_forms import full_contact_sliding
from .half_plane import half_plane_sliding
from .half_space import half_space_sliding, layer_sliding

__all__ = [
    "full_contact_sliding",
    "half_plane_sliding",
    "half_space_sliding",
    "layer_sliding",
    "rough_map",
]


def __getattr__(name: str) -> Any:
    raise AttributeError(
        f"module 'elastomdr.reference' has no attribute {name!r}. "
        f"{closest(name, __all__)}".strip(),
        name=name,
    )
