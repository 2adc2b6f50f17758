"""Whether a drive that pulls a body over rubber damps its swings, where friction follows the speed at once.

About steady sliding at V a mass m on a spring k and a damper c, under a friction F(v) that follows the speed, obeys

    m x'' + [c + F'(V)] x' + k x = 0,      zeta = [c + F'(V)]/(2 sqrt(k m)),

so that its swings grow where zeta < 0, whatever k is. Friction follows at once only where a wave of the surface passes
within a small part of a swing, V >> lambda sqrt(k/m). Slower, the rubber's memory of the waves decides: `em.drive`.
"""

from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, as_float64, ascending, in_float64, is_traced, not_negative, positive, scalar
from ..errors import InputError
from ..solve.dynamics import Mount


class Stability(NamedTuple):
    """Damping of a drive about steady sliding, for each velocity; the last axis is that of the velocities."""

    velocity: Float[Array, "..."]  # V [m/s]
    slope: Float[Array, "..."]  # F'(V) [N s/m]
    ratio: Float[Array, "..."]  # zeta; below zero swings grow
    follows: Bool[Array, "..."]  # whether friction follows the speed at once, V > lambda sqrt(k/m): else ask em.drive
    slowest: Float[Array, ""]  # lambda sqrt(k/m), from which on it does [m/s]


@in_float64
def stability(mount: Any, *, velocity: Any, force: Any, wavelength: Any) -> Stability:
    """Damping ratio of a drive with a friction force over velocity, and from which velocity on that decides.

        zeta = [c + F'(V)]/(2 sqrt(k m)),      where V > lambda sqrt(k/m)

    - `mount`: `em.Mount(mass, stiffness, damping)` of the drive, stiffness above zero.
    - `velocity` [m/s], ascending, three or more; `force` [N] of the whole body there, its last axis that of the
      velocities: computed (mu times the normal force), or measured.
    - `wavelength` lambda [m]: the longest of the surface, 2 pi/q_low.

    At V = lambda sqrt(k/m) a wave passes within a sixth of a swing. Slower than that the ratio decides nothing: the
    rubber holds a wave as long as it takes to pass, which acts as a spring and a damper of its own; `em.drive` has it.
    F' is by central differences in ln V, of second order. Differentiable. Raises `InputError`. Source: `docs/seal.md`.
    """
    if not isinstance(mount, Mount):
        raise InputError(f"mount must be an em.Mount(mass, stiffness, damping), got {mount!r}.")
    mass, stiffness, damping = (scalar(f"mount {k}", getattr(mount, k)) for k in ("mass", "stiffness", "damping"))
    positive("mount mass", mass)
    positive("mount stiffness", stiffness)
    not_negative("mount damping", damping)
    longest = scalar("wavelength", wavelength)
    positive("wavelength", longest)
    v, drag = as_float64("velocity", velocity), as_float64("force", force)
    if v.ndim != 1 or v.size < 3:
        raise InputError(f"velocity must be a list of three values or more, got an array of shape {v.shape}.")
    positive("velocity", v)
    ascending("velocity", v)
    if drag.ndim < 1 or drag.shape[-1] != v.size:
        raise InputError(f"force must have one value for each of the {v.size} velocities, got shape {drag.shape}.")
    if not is_traced(drag) and np.isinf(drag).any():
        raise InputError(f"force must be finite, or NaN where it is not known, got {drag[np.isinf(drag)][0]:g}.")
    xp: Any = jnp if is_traced(mass, stiffness, damping, longest, v, drag) else np
    at = xp.log(v)
    before, after = at[1:-1] - at[:-2], at[2:] - at[1:-1]
    rise = (drag[..., 1:] - drag[..., :-1]) / (at[1:] - at[:-1])
    inner = (rise[..., :-1] * after + rise[..., 1:] * before) / (before + after)
    first = 2 * rise[..., :1] - inner[..., :1]  # a parabola through three points ends like that
    last = 2 * rise[..., -1:] - inner[..., -1:]
    slope = xp.concatenate([first, inner, last], axis=-1) / v
    slowest = longest * xp.sqrt(stiffness / mass)
    ratio = (damping + slope) / (2 * xp.sqrt(stiffness * mass))
    everywhere = xp.broadcast_to(v, slope.shape)
    return Stability(everywhere, slope, ratio, everywhere > slowest, slowest)
