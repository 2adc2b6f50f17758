"""Whether a drive that pulls a body over rubber damps its swings, where friction
follows the speed at once.

About steady sliding at V a mass m on a spring k and a damper c, under a friction F(v)
that follows the speed, obeys

    m x'' + [c + F'(V)] x' + k x = 0,      zeta = [c + F'(V)]/(2 sqrt(k m)),

so that its swings grow where zeta < 0, whatever k is. Friction follows at once only
where a wave of the surface passes within a small part of a swing, V >> lambda
sqrt(k/m). Slower, the rubber's memory of the waves decides: `em.drive`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import fixed, is_traced, numpy_unless_traced, xp
from ..checks import as_float64, ascending, not_negative, positive, scalar
from ..errors import InputError
from ..results.words import brief
from ..transient.mount import Mount
from .stability_result import Stability

if TYPE_CHECKING:
    from .._types import ArrayLike, Number

MODEL = (
    "steady sliding, friction that follows the speed at once (exact to first order in "
    "the swing)"
)
PLAN = "closed form; slopes by central differences in ln V"


@numpy_unless_traced
def stability(
    mount: Mount, *, velocity: ArrayLike, force: ArrayLike, wavelength: Number
) -> Stability:
    """Damping ratio of a drive whose friction depends on velocity, and the velocity
    from which on it decides.

        zeta = [c + F'(V)]/(2 sqrt(k m)),      where V > lambda sqrt(k/m)

    Args:
        mount: `em.Mount(mass, stiffness, damping)` of the drive, stiffness above zero.
        velocity: velocities [m/s], ascending, shape (n,), three or more.
        force: friction force of the whole body at these velocities [N], shape (..., n):
            mu times the normal force, or measured. NaN where it is not known.
        wavelength: longest wave of the surface lambda [m], 2 pi/q_low.

    Returns:
        An `em.Stability`. `error` is from third differences, two to four times what
        they give; it does not see a peak between two velocities.

    Raises:
        InputError: for fewer than three velocities, a mount without stiffness, and
            forces that do not match.

    At V = lambda sqrt(k/m) a wave passes within a sixth of a swing. Below that velocity
    the ratio decides nothing: the rubber remembers a wave as long as it takes to pass,
    and acts as a spring and a damper of its own; use `em.drive`. F' is by central
    differences in ln V, of second order. Differentiable.

    Source: `docs/seal.md`.
    """
    if not isinstance(mount, Mount):
        raise InputError(
            f"mount must be an em.Mount(mass, stiffness, damping), got {mount!r}."
        )
    mass, stiffness, damping = (
        scalar(f"mount {k}", getattr(mount, k))
        for k in ("mass", "stiffness", "damping")
    )
    positive("mount mass", mass)
    positive("mount stiffness", stiffness)
    not_negative("mount damping", damping)
    longest = scalar("wavelength", wavelength)
    positive("wavelength", longest)
    v, drag = as_float64("velocity", velocity), as_float64("force", force)
    if v.ndim != 1 or v.size < 3:
        raise InputError(
            "velocity must be a list of three values or more, got an array of "
            "shape "
            f"{v.shape}."
        )
    positive("velocity", v)
    ascending("velocity", v)
    if drag.ndim < 1 or drag.shape[-1] != v.size:
        raise InputError(
            f"force must have one value for each of the {v.size} velocities, got "
            f"shape {drag.shape}."
        )
    if not is_traced(drag) and np.isinf(drag).any():
        raise InputError(
            "force must be finite, or NaN where it is not known, got "
            f"{drag[np.isinf(drag)][0]:g}."
        )
    at = xp.log(v)
    step = at[1:] - at[:-1]
    rise = (drag[..., 1:] - drag[..., :-1]) / step
    near = (rise[..., :-1] * step[1:] + rise[..., 1:] * step[:-1]) / (
        step[:-1] + step[1:]
    )
    # A parabola through three points ends like this:
    ends = 2 * rise[..., :1] - near[..., :1], 2 * rise[..., -1:] - near[..., -1:]
    raised = xp.concatenate([ends[0], near, ends[1]], axis=-1)  # dF/d ln V
    slope = raised / v
    root = 2 * xp.sqrt(stiffness * mass)
    slowest = longest * xp.sqrt(stiffness / mass)
    ratio = (damping + slope) / root
    everywhere = xp.broadcast_to(v, slope.shape)
    mounted = ", ".join(
        brief(x, unit)
        for x, unit in ((mass, "kg"), (stiffness, "N/m"), (damping, "N s/m"))
    )
    inputs = (
        ("mount", mounted),
        ("velocity", brief(v, "m/s")),
        ("longest wave", brief(longest, "m")),
    )
    return Stability(
        velocity=everywhere,
        force=drag,
        slope=slope,
        ratio=ratio,
        follows=everywhere > slowest,
        error=fixed(_missed(at, rise, raised) / v / root),
        converged=xp.isfinite(ratio),
        slowest=slowest,
        model=MODEL,
        plan=PLAN,
        inputs=inputs,
    )


def _missed(at: Any, rise: Any, raised: Any) -> Any:
    """Estimated error of dF/d ln V: two to four times the term that a parabola through
    three points leaves out.

    That term is (x - x_1)(x - x_2) F[x_0, x_1, x_2, x_3], with the largest third
    divided difference of those that touch a point or its neighbours. It is the whole
    error where the points are close; where it is as large as the slope the terms after
    it are as large again, and four times are taken. NaN for fewer than five velocities,
    or where holes in the force leave no third difference.
    """
    n = at.shape[0]
    if n < 5:
        return xp.full_like(raised, xp.nan)
    bend = (rise[..., 1:] - rise[..., :-1]) / (at[2:] - at[:-2])
    # of the points i to i + 3
    third = xp.abs((bend[..., 1:] - bend[..., :-1]) / (at[3:] - at[:-3]))
    none = xp.full((*third.shape[:-1], 4), xp.nan)
    padded = xp.concatenate([none, third, none], axis=-1)
    largest = padded[..., :n]
    for i in range(1, 6):
        largest = xp.fmax(largest, padded[..., i : i + n])
    ends = (at[1] - at[0]) * (at[2] - at[0]), (at[-1] - at[-2]) * (at[-1] - at[-3])
    middle = (at[1:-1] - at[:-2]) * (at[2:] - at[1:-1])
    # NaN where the slope is
    left = xp.concatenate([ends[0][None], middle, ends[1][None]]) * largest + 0 * raised
    part = left / xp.maximum(xp.maximum(left, xp.abs(raised)), np.finfo(float).tiny)
    return 2 * left * (1 + part)
