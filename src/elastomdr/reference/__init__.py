"""Slow truths, to check the fast ones against: contacts in two and three dimensions, solved without reduction."""

from ..mapping.synthesis import rough_map
from .half_plane import half_plane_sliding
from .half_space import half_space_sliding
from .persson import persson

__all__ = ["half_plane_sliding", "half_space_sliding", "persson", "rough_map"]
