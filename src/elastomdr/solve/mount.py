"""What a body that slides or presses hangs on."""

from typing import Any

import equinox as eqx

from .._runtime import positive, scalar


class Mount(eqx.Module):
    """A mass m [kg] on a spring k [N/m] and a damper c [N s/m] beside it; per metre of line under a rough line."""

    mass: Any
    stiffness: Any = 0.0
    damping: Any = 0.0

    def for_line(self, load: Any, normal_force: Any) -> "Mount":
        """The share that a metre of rough line has of this mount of a whole body, load/normal_force of it.

        `load` [N/m] of the line, `normal_force` [N] of the whole body on the rubber, for which the line stands. Raises
        `InputError`.
        """
        given = scalar("load", load), scalar("normal_force", normal_force)
        positive("load", given[0])
        positive("normal_force", given[1])
        part = given[0] / given[1]
        return Mount(part * self.mass, part * self.stiffness, part * self.damping)
