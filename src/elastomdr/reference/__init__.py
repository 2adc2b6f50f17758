"""What to check the fast answers against: contacts in two and three dimensions, without
reduction; closed forms.
"""

from ..surface.spectrum import rough_map
from .full_contact import full_contact_sliding
from .half_plane import half_plane_sliding
from .half_space import half_space_sliding
from .layer import layer_sliding
from .persson import persson
from .small_damping import small_damping

__all__ = [
    "full_contact_sliding",
    "half_plane_sliding",
    "half_space_sliding",
    "layer_sliding",
    "persson",
    "rough_map",
    "small_damping",
]
