"""What a body that slides or presses hangs on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..checks import positive, scalar
from ..trees import Tree, fill

if TYPE_CHECKING:
    from .._types import Number, Plain


class Mount(Tree):
    """A mass on a spring and a damper beside it; per metre of line under a rough line.

    Args:
        mass: mass [kg].
        stiffness: stiffness of the spring [N/m].
        damping: constant of the damper [N s/m].
    """

    mass: Plain
    stiffness: Plain
    damping: Plain

    def __init__(self, mass: Number, stiffness: Number = 0.0, damping: Number = 0.0):
        fill(self, mass=mass, stiffness=stiffness, damping=damping)

    def for_line(self, load: Number, normal_force: Number) -> "Mount":
        """The share that a metre of rough line has of this mount of a whole body,
        load/normal_force of it.

        `load` [N/m] of the line, `normal_force` [N] of the whole body on the rubber,
        for which the line stands. Raises `InputError`.
        """
        given = scalar("load", load), scalar("normal_force", normal_force)
        positive("load", given[0])
        positive("normal_force", given[1])
        part = given[0] / given[1]
        return Mount(part * self.mass, part * self.stiffness, part * self.damping)
