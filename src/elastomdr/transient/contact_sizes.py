"""How far a contact reaches in a history, before it is marched, and how large the
program is that marches it.
"""

from typing import Any

from ..arrays import compiled, fixed, xp
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..smooth.passage import Control, estimate_sizes
from ..surface.lines import AbstractLines


def shared_level(work: float, most: int, room: float, factor: float = 4.0) -> int:
    """The finest level of refinement, up to `most`, whose compiled program serves the
    coarser ones as well.

    `work` is elements times steps times branches of level 0; each further level has
    `factor` times as much, and `room` is what is marched sooner than another program is
    compiled. Compiling takes seconds, most marches milliseconds: so the coarse levels
    are marched with as many elements as that level has, the further ones lying where
    the body does not come (of a rough line: in further periods).
    """
    return max(
        level for level in range(most + 1) if level <= 1 or factor**level * work <= room
    )


_ELEMENTS = 1e6  # along a path: more steps of so many elements than anybody waits for


def check_path(length: float, spacing: float) -> None:
    """Raises `InputError` for a path that is too long for elements of the size that the
    contact asks for [m].
    """
    if not length <= _ELEMENTS * spacing:
        raise InputError(
            f"position must stay within {_ELEMENTS:g} elements, each {spacing:.3g} m "
            f"wide as the contact asks for, got a path over {length:.3g} m: shorten "
            "it, or take em.friction for steady sliding."
        )


@compiled("control")
def contact_sizes(
    law: Relaxation, lines: AbstractLines, control: Control, value: Any, duration: float
) -> tuple[Any, Any]:
    """The smallest and the largest contact radius to expect [m], each within a factor
    of 2.

    The largest is that of the relaxed rubber under the largest load, or for a liquid of
    what creeps in the time given.
    """
    law, lines, value = fixed((law, lines, value))
    glass = law.equilibrium + xp.sum(law.moduli) + law.viscosity / duration
    # A lower bound of E(t): each branch, and the dashpot, as a spring that has relaxed
    # for the whole time.
    soft = (
        law.equilibrium
        + xp.sum(law.moduli / (1 + duration / law.times))
        + law.viscosity / duration
    )
    top = xp.max(value)
    positive_values = xp.where(value > 0, value, top)
    ends = xp.stack([xp.min(positive_values), top])
    ends = xp.where(ends > 0, ends, 1e-9)
    sizes = []
    for modulus, end in zip((glass, soft), ends, strict=True):
        spring = Relaxation(modulus, xp.zeros(1), xp.ones(1), xp.zeros(()))
        sizes.append(estimate_sizes(spring, lines, control, end[None], xp.ones(1))[0])
    return sizes[0], xp.maximum(*sizes)
