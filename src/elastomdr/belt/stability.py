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

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import numpy_unless_traced, stop_gradient, xp
from ..checks import (
    Array,
    as_float64,
    ascending,
    certain,
    not_negative,
    positive,
    scalar,
    significant,
)
from ..element.moving_body import Mount
from ..errors import InputError
from ..results.axes import Axis
from ..results.base import Result, quantity, record
from ..results.words import brief, in_words, span

if TYPE_CHECKING:
    from .._types import ArrayLike, Number

MODEL = (
    "steady sliding, friction that follows the speed at once (exact to first order in "
    "the swing)"
)
PLAN = "closed form; slopes by central differences in ln V"
_LISTED = 6  # curves that a summary lists one by one
_SAME_VELOCITY = 1e-9  # relative


@record
class Stability(Result):
    """Damping of a drive about steady sliding, for each velocity; the last axis is that
    of the velocities.

    Where `follows` is False the ratio decides nothing. A velocity at which the force is
    not known, or beside one, is NaN with `converged=False`. `plot` draws the ratio,
    dotted where it decides nothing, the unstable range shaded.
    """

    velocity: Array = quantity(
        "velocity", "m/s", "V of the drive", axis="velocity of the drive"
    )
    force: Array = quantity("friction force", "N", "F(V), as given")
    slope: Array = quantity("slope of the friction force", "N s/m", "F'(V)")
    ratio: Array = quantity(
        "damping ratio",
        "-",
        "zeta; below zero swings grow",
        axis=r"damping ratio $\zeta$",
    )
    follows: Array = quantity(
        "friction follows the speed at once",
        "",
        "V > lambda sqrt(k/m); where it does not, ask em.drive",
    )
    error: Array = quantity(
        "estimated error of the damping ratio",
        "-",
        "by the differences; NaN for fewer than five velocities together",
    )
    model_error: Array = quantity(
        "bound on the error of the model",
        "-",
        "of the damping ratio; NaN: that friction follows at once has none",
    )
    slowest: Array = quantity(
        "slowest velocity that friction follows", "m/s", "lambda sqrt(k/m)", dims=""
    )

    title: ClassVar[str] = "Stability of a drive"
    figure: ClassVar[str] = "plot_curves.draw_stability"
    shows: ClassVar[str] = "ratio"
    scale: ClassVar[str] = "log"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the damping ratio"
    unflagged: ClassVar[str] = (
        "does not enter: the forces are given, what they are extrapolated from is not "
        "seen"
    )

    def axes(self) -> list[Axis]:
        """The axes of the fields by name, with their values; a force that is the same
        at all velocities names one.
        """
        return [
            axis._replace(name="friction_force") if axis.name == "load" else axis
            for axis in super().axes()
        ]

    def outcome(self) -> Iterator[tuple[str, str]]:
        """From which velocity on the ratio decides, the least ratio there, and where
        swings grow.
        """
        slowest = float(self.slowest)
        yield (
            "valid",
            f"above {in_words('velocity', slowest)}; for slower sliding use em.drive",
        )
        fields = {q.key: value for q, value in self.fields().items()}
        for curve in self.curves()[1][:_LISTED]:
            velocity, force, ratio, follows = (
                fields[key][curve.place]
                for key in ("velocity", "force", "ratio", "follows")
            )
            counts = follows & np.isfinite(ratio)
            name = "at " + curve.label if curve.label else "result"
            yield name, _least_ratio_in_words(velocity, ratio, counts, slowest)
            yield (
                "stick-slip",
                _stick_slip_in_words(velocity, force, ratio, counts, slowest),
            )
        yield from _unknown_forces(
            fields["force"], fields["converged"], fields["error"]
        )


def _unknown_forces(
    force: np.ndarray, converged: np.ndarray, error: np.ndarray
) -> Iterator[tuple[str, str]]:
    """How many forces are not known, and what that leaves out."""
    holes = np.isnan(force)
    if not holes.any():
        return
    words = (
        f"{holes.sum()} of {holes.size} forces; the ratio there and beside them is left "
        "out"
    )
    without_error = converged & np.isnan(error)
    if without_error.any():
        words += f", and its error at {without_error.sum()} others"
    yield "not known", words


def unstable_ranges(
    velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, slowest: float
) -> list[tuple[float, float]]:
    """Ranges of velocity in which swings grow, from where the ratio crosses zero,
    linear in ln V in between.

    One that begins below `slowest`, from which on the ratio counts, begins there.
    """
    ranges: list[tuple[float, float]] = []
    x = np.log(velocity)
    for i in np.flatnonzero(counts & (ratio < 0)):
        ends = []
        for j in (i - 1, i + 1):
            known = 0 <= j < ratio.size and np.isfinite(ratio[j])
            if known and ratio[j] >= 0:
                crossing = x[i] + (x[j] - x[i]) * ratio[i] / (ratio[i] - ratio[j])
                ends.append(max(crossing, np.log(slowest)))
            else:
                ends.append(np.log(slowest) if known and not counts[j] else x[i])
        low, high = (float(np.exp(end)) for end in ends)
        if ranges and i > 0 and counts[i - 1] and ratio[i - 1] < 0:
            low = ranges.pop()[0]
        ranges.append((low, high))
    return ranges


def _stick_slip_in_words(
    velocity: np.ndarray,
    force: np.ndarray,
    ratio: np.ndarray,
    counts: np.ndarray,
    slowest: float,
) -> str:
    """Yes or no, and the friction force there."""
    limit = in_words("velocity", slowest)
    if not counts.any():
        return (
            f"not decided: friction follows the speed only above {limit}; use em.drive"
        )
    ranges = unstable_ranges(velocity, ratio, counts, slowest)
    if not ranges:
        forces = span(force[counts], "N")
        return f"no, above {limit}: swings die out; friction {forces}"
    forces = span(force[counts & (ratio < 0)], "N")
    return f"yes, {_ranges_in_words(ranges, slowest)}: swings grow; friction {forces}"


def _least_ratio_in_words(
    velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, slowest: float
) -> str:
    if not counts.any():
        return "the ratio decides at none of these velocities"
    least = np.flatnonzero(counts)[ratio[counts].argmin()]
    place = in_words("velocity", float(velocity[least]))
    words = f"damping ratio at least {significant(float(ratio[least]))}, at {place}: "
    ranges = unstable_ranges(velocity, ratio, counts, slowest)
    if not ranges:
        return words + "swings die out"
    return f"{words}swings grow {_ranges_in_words(ranges, slowest)}"


def _ranges_in_words(ranges: list[tuple[float, float]], slowest: float) -> str:
    return " and ".join(_range_in_words(low, high, slowest) for low, high in ranges)


def _range_in_words(low: float, high: float, slowest: float) -> str:
    if low <= slowest * (1 + _SAME_VELOCITY):
        return f"from below {significant(slowest)} to {significant(high)} m/s"
    if low == high:
        return f"at {in_words('velocity', low)}"
    return f"at {significant(low)} to {significant(high)} m/s"


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
    mass, stiffness, damping = _checked_mount(mount)
    longest = scalar("wavelength", wavelength)
    positive("wavelength", longest)
    v, friction = _checked_curve(velocity, force)
    x = xp.log(v)
    secants, dF_dlnV = _slopes(x, friction)
    slope = dF_dlnV / v
    critical_damping = 2 * xp.sqrt(stiffness * mass)
    slowest = longest * xp.sqrt(stiffness / mass)
    ratio = (damping + slope) / critical_damping
    everywhere = xp.broadcast_to(v, slope.shape)
    mount_in_words = ", ".join(
        brief(value, unit)
        for value, unit in ((mass, "kg"), (stiffness, "N/m"), (damping, "N s/m"))
    )
    return Stability(
        velocity=everywhere,
        force=friction,
        slope=slope,
        ratio=ratio,
        follows=everywhere > slowest,
        error=stop_gradient(_slope_error(x, secants, dF_dlnV) / v / critical_damping),
        model_error=xp.full(slope.shape, xp.nan),
        converged=xp.isfinite(ratio),
        slowest=slowest,
        model=MODEL,
        plan=PLAN,
        inputs=(
            ("mount", mount_in_words),
            ("velocity", brief(v, "m/s")),
            ("longest wave", brief(longest, "m")),
        ),
    )


def _checked_mount(mount: object) -> tuple[Array, Array, Array]:
    """Mass, stiffness and damping. Raises `InputError`."""
    if not isinstance(mount, Mount):
        raise InputError(
            argument="mount",
            got=mount,
            accepted="an em.Mount(mass, stiffness, damping)",
        )
    mass, stiffness, damping = (
        scalar(f"mount.{name}", getattr(mount, name))
        for name in ("mass", "stiffness", "damping")
    )
    positive("mount.mass", mass)
    positive("mount.stiffness", stiffness)
    not_negative("mount.damping", damping)
    return mass, stiffness, damping


def _checked_curve(velocity: ArrayLike | None, force: ArrayLike) -> tuple[Array, Array]:
    """Velocities and forces that match. Raises `InputError`."""
    v, friction = as_float64("velocity", velocity), as_float64("force", force)
    if v.ndim != 1 or v.size < 3:
        raise InputError(
            argument="velocity", got=v.shape, accepted="a list of three values or more"
        )
    positive("velocity", v)
    ascending("velocity", v)
    if friction.ndim < 1 or friction.shape[-1] != v.size:
        raise InputError(
            argument="force",
            got=friction.shape,
            accepted=f"of one value for each of the {v.size} velocities",
        )
    if certain(lambda x: np.isinf(x).any(), friction):
        raise InputError(
            argument="force",
            got=float(friction[np.isinf(friction)][0]),
            accepted="finite, or NaN where it is not known",
        )
    return v, friction


def _slopes(x: Array, friction: Array) -> tuple[Any, Any]:
    """Slopes of the secants between neighbours, and dF/dx at the points by parabolas
    through three of them.
    """
    step = x[1:] - x[:-1]
    secants = (friction[..., 1:] - friction[..., :-1]) / step
    inner = (secants[..., :-1] * step[1:] + secants[..., 1:] * step[:-1]) / (
        step[:-1] + step[1:]
    )
    # a parabola through three points ends like this
    first = 2 * secants[..., :1] - inner[..., :1]
    last = 2 * secants[..., -1:] - inner[..., -1:]
    return secants, xp.concatenate([first, inner, last], axis=-1)


def _slope_error(x: Array, secants: Array, dF_dx: Array) -> Any:
    """Estimated error of dF/dx: two to four times the term that a parabola through
    three points leaves out.

    That term is (x - x_1)(x - x_2) F[x_0, x_1, x_2, x_3], with the largest third
    divided difference of those that touch a point or its neighbours. It is the whole
    error where the points are close; where it is as large as the slope the terms after
    it are as large again, and four times are taken. NaN for fewer than five velocities,
    or where holes in the force leave no third difference.
    """
    n = x.shape[0]
    if n < 5:
        return xp.full_like(dF_dx, xp.nan)
    second = (secants[..., 1:] - secants[..., :-1]) / (x[2:] - x[:-2])
    # of the points i to i + 3
    third = xp.abs((second[..., 1:] - second[..., :-1]) / (x[3:] - x[:-3]))
    none = xp.full((*third.shape[:-1], 4), xp.nan)
    padded = xp.concatenate([none, third, none], axis=-1)
    largest = padded[..., :n]
    for i in range(1, 6):
        largest = xp.fmax(largest, padded[..., i : i + n])
    first = (x[1] - x[0]) * (x[2] - x[0])
    last = (x[-1] - x[-2]) * (x[-1] - x[-3])
    inner = (x[1:-1] - x[:-2]) * (x[2:] - x[1:-1])
    factors = xp.concatenate([first[None], inner, last[None]])
    left_out = factors * largest + 0 * dF_dx  # NaN where the slope is
    larger = xp.maximum(left_out, xp.abs(dF_dx))
    share = left_out / xp.maximum(larger, np.finfo(float).tiny)
    return 2 * left_out * (1 + share)
