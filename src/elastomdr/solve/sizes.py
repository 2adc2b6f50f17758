"""How far a contact reaches in a history, before it is marched."""

from typing import Any

import jax
import jax.numpy as jnp

from ..mapping.lines import AbstractLines
from ..material.relaxation import Relaxation
from .passage import Control, estimate_sizes


def contact_sizes(
    law: Relaxation, lines: AbstractLines, control: Control, value: Any, duration: float
) -> tuple[Any, Any]:
    """The smallest and the largest contact radius to expect [m], each within a factor of 2.

    The largest is that of the relaxed rubber under the largest load, or for a liquid of what creeps in the time given.
    """
    law, lines, value = jax.lax.stop_gradient((law, lines, value))
    glass = law.equilibrium + jnp.sum(law.moduli) + law.viscosity / duration
    # A lower bound of E(t): each branch, and the dashpot, as a spring that has relaxed for the whole time.
    soft = law.equilibrium + jnp.sum(law.moduli / (1 + duration / law.times)) + law.viscosity / duration
    top = jnp.max(value)
    positive_values = jnp.where(value > 0, value, top)
    ends = jnp.stack([jnp.min(positive_values), top])
    ends = jnp.where(ends > 0, ends, 1e-9)
    sizes = []
    for modulus, end in zip((glass, soft), ends, strict=True):
        spring = Relaxation(modulus, jnp.zeros(1), jnp.ones(1), jnp.zeros(()))
        sizes.append(estimate_sizes(spring, lines, control, end[None], jnp.ones(1))[0])
    return sizes[0], jnp.maximum(*sizes)
