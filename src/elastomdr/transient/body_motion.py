"""Masses on springs and dampers coupled to a line of elements: one step for bodies and
contact.

The body stands at X along the line, at depth d. A drive at D(t) pulls it, a load P(t)
presses it:

    m_t X'' = k_t (D - X) + c_t (D' - X') - F_x,        or X = D without a tangential mount,
    m_n d'' = P - k_n d - c_n d' - F_N,                 or F_N = P without a normal one,

F_x and F_N being those of the elements (`transient.body_over_line`). Bodies take the
trapezoidal rule, elements the exact contact step, both of second order, and they are
solved together. The force of an element is linear in its displacement at the end, and
so is its mean over the step, which is what accelerates a body: with d+ = d + h (d' +
d'+)/2 the normal equation is

    A d+ + sum W S max(0, d+ - l) = known,        A = 2 m/h^2 + k/2 + c/h,

piecewise linear, solved exactly (`transient.depth_from_load`); the tangential one takes
a fixed number of Newton steps. The work of the mean forces is that of the elements but
for those whose contact begins or ends within the step.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

from ..arrays import checkpointed, compiled, cond, fixed, in_steps, mapped, on_numpy, xp
from ..checks import Array
from ..element.contact_step import coefficients, fade, lag, released
from ..material.relaxation import Relaxation
from .body_over_line import AbstractOverLine
from .depth_from_load import settle
from .mount import Mount
from .slide_march import Line, energy, felt_by, press, untouched

_NEWTON = 4  # steps for the place of a body that is pulled through a spring, under JAX
# steps at most on NumPy, to a balance of forces relative to the largest of them
_SECANTS, _CLOSE = 40, 1e-12
_INSTANT = 1e-12  # duration of the first touch, over the shortest time


class Scene(NamedTuple):
    """What stays the same during the motion."""

    law: Relaxation
    surface: AbstractOverLine
    tangential: Mount | None
    normal: Mount | None


class Motion(NamedTuple):
    """Bodies and elements at one instant, and the work done since the start."""

    line: Line
    position: Array  # X [m]
    velocity: Array  # X' [m/s]
    depth: Array  # d [m]
    sinking: Array  # d' [m/s]
    drag: Array  # F_x [N]
    normal: Array  # F_N [N]
    work: Array  # of the contact forces on the elements [J]
    driven: Array  # of the drive [J]
    pressed: Array  # of the load [J]
    damped: Array  # lost in the dampers [J]


def put_down(scene: Scene, position: Array, load: Array, shortest: Any) -> Motion:
    """The body at rest, put down at once with its load on rubber that was never
    touched.
    """
    c = coefficients(scene.law, _INSTANT * shortest)
    rise, slope = scene.surface.rise_and_slope(position)
    line, weight = untouched(scene.law, scene.surface, position), scene.surface.weight
    fading = fade(c, line.f)
    spring = 0.0 if scene.normal is None else scene.normal.stiffness
    between, level = scene.surface.between, released(c, line.u, fading.seen) - rise
    depth = settle(level, weight * c.stiffness[0], spring, load, xp.zeros(()), between)
    line, work = press(c, line, fading, rise, depth)
    work = xp.sum(weight * work)
    zero = xp.zeros(())
    normal, drag = felt_by(weight, line.q, slope, depth - level if between else None)
    held = spring * depth**2 / 2
    return Motion(
        line,
        position + zero,
        zero,
        depth,
        zero,
        drag,
        normal,
        work,
        zero,
        work + held,
        zero,
    )


def _advance(
    scene: Scene,
    c: Any,
    y: Motion,
    before: tuple[Array, Array],
    after: tuple[Array, Array],
    h: Any,
) -> Motion:
    (drive, load), (drive_end, load_end) = before, after
    weight, up, along = scene.surface.weight, scene.normal, scene.tangential
    between = scene.surface.between
    fading = fade(c, y.line.f)
    u_free = released(c, y.line.u, fading.seen)
    # Mean force of an element over the step, if it follows the surface: mean S (w+ -
    # idle).
    mean = (0.5 * c.equilibrium + c.drag)[0]
    idle = y.line.u - (c.equilibrium * y.line.u + fading.mean) / mean

    def depth_at(rise: Array, guess: Array) -> Array:
        if up is None:
            return settle(
                u_free - rise, weight * c.stiffness[0], 0.0, load_end, guess, between
            )
        inertia = 2 * up.mass / h**2 + up.stiffness / 2 + up.damping / h
        known = (
            2 * up.mass * y.sinking / h + (load + load_end) / 2 - up.stiffness * y.depth
        )
        return settle(
            idle - rise,
            weight * mean,
            inertia,
            known + inertia * y.depth,
            guess,
            between,
        )

    def forces(moved: Array, guess: Array) -> tuple[Array, tuple[Array, Array]]:
        """Mean F_x of the step in which the body moves so far; mean F_N, and the depth
        at the end.
        """
        rise = scene.surface.rise(y.position + moved)
        _, slope = scene.surface.rise_and_slope(y.position + moved / 2)
        depth = depth_at(rise, guess)
        excess = depth + rise - idle
        normal, drag = felt_by(
            weight, mean * xp.maximum(excess, 0.0), slope, excess if between else None
        )
        return drag, (normal, depth)

    guess = y.depth + h * y.sinking
    if along is None:
        moved = drive_end - y.position
    else:
        inertia = 2 * along.mass / h**2 + along.stiffness / 2 + along.damping / h
        pull = (
            along.stiffness * ((drive + drive_end) / 2 - y.position)
            + along.damping * (drive_end - drive) / h
        )
        known = 2 * along.mass * y.velocity / h + pull

        search = _by_secants if on_numpy() else _by_newton
        moved, guess = search(forces, inertia, known, h * y.velocity, guess)

    drag_mean, (_, depth) = forces(moved, guess)
    position = y.position + moved
    rise = scene.surface.rise(position)
    _, slope = scene.surface.rise_and_slope(position - lag(c) * moved)
    line, work = press(c, y.line, fading, rise, depth)
    normal, drag = felt_by(
        weight, line.q, slope, depth + rise - u_free if between else None
    )
    sunk, driven, damped = depth - y.depth, drag_mean * moved, xp.zeros(())
    if along is not None:
        stretch = along.stiffness * ((drive + drive_end) / 2 - y.position - moved / 2)
        slip = drive_end - drive - moved
        driven = (stretch + along.damping * slip / h) * (drive_end - drive)
        damped = along.damping * slip**2 / h
    if up is not None:
        damped = damped + up.damping * sunk**2 / h
    return Motion(
        line=line,
        position=position,
        velocity=moved / h if along is None else 2 * moved / h - y.velocity,
        depth=depth,
        sinking=sunk / h if up is None else 2 * sunk / h - y.sinking,
        drag=drag,
        normal=normal,
        work=y.work + xp.sum(weight * work),
        driven=y.driven + driven,
        pressed=y.pressed + (load + load_end) / 2 * sunk,
        damped=y.damped + damped,
    )


def _by_newton(
    forces: Callable[..., Any], inertia: Array, known: Array, moved: Array, guess: Array
) -> tuple[Array, Array]:
    """Where inertia moved + F_x(moved) = known, and a guess for the depth there."""
    import jax

    def improve(
        state: tuple[Array, Array], _: None
    ) -> tuple[tuple[Array, Array], None]:
        moved, guess = state
        drag, steepness, (_, guess) = jax.jvp(
            functools.partial(forces, guess=guess),
            (moved,),
            (xp.ones_like(moved),),
            has_aux=True,
        )
        return (
            moved - (inertia * moved + drag - known) / _tangent(inertia, steepness),
            guess,
        ), None

    # A loop, not four copies: compiling takes far longer than most motions.
    return jax.lax.scan(improve, (moved, guess), None, length=_NEWTON)[0]


def _by_secants(
    forces: Callable[..., Any], inertia: Array, known: Array, moved: Array, guess: Array
) -> tuple[Array, Array]:
    """The same without derivatives."""
    steepness, before = 0.0, None
    for _ in range(_SECANTS):
        drag, (_, guess) = forces(moved, guess)
        miss = inertia * moved + drag - known
        if not abs(miss) > _CLOSE * (abs(inertia * moved) + abs(drag) + abs(known)):
            break
        if before is not None:
            steepness = (drag - before[1]) / (moved - before[0])
        before = moved, drag
        moved = moved - miss / _tangent(inertia, steepness)
        if moved == before[0]:
            break
    return moved, guess


def _tangent(inertia: Array, steepness: Array | float) -> Array:
    """Where the contact pulls ahead the more the body moves, the tangent is not taken
    below half the inertia.
    """
    return inertia + xp.maximum(steepness, -0.5 * inertia)


def energies(scene: Scene, y: Motion, drive: Array) -> tuple[Array, Array]:
    """Of the masses and of the springs they hang on [J]."""
    kinetic, spring = xp.zeros(()), xp.zeros(())
    if scene.tangential is not None:
        kinetic = scene.tangential.mass * y.velocity**2 / 2
        spring = scene.tangential.stiffness * (drive - y.position) ** 2 / 2
    if scene.normal is not None:
        kinetic = kinetic + scene.normal.mass * y.sinking**2 / 2
        spring = spring + scene.normal.stiffness * y.depth**2 / 2
    return kinetic, spring


class History(NamedTuple):
    """What a motion leaves behind at each instant; the first three are what
    `transient.refinement` looks at.
    """

    depth: Array
    normal: Array
    drag: Array
    position: Array
    velocity: Array
    sinking: Array
    work: Array
    stored: Array
    driven: Array
    pressed: Array
    damped: Array
    kinetic: Array  # [J]
    spring: Array  # in the springs of the mounts [J]


@compiled("samples", "early")
def run(
    scene: Scene,
    time: Array,
    drive: Array,
    load: Array,
    shortest: Any,
    samples: int,
    used: Any,
    early: int = 0,
) -> tuple[History, Line]:
    """The whole motion: what is known at the instants, and the line at the end. `used`
    contact steps are made between two instants, in a program that has room for
    `samples`.

    A load that is put on at once is answered on all time scales of the rubber: the
    first interval is divided by `early` further instants in geometric series, from the
    `shortest` time on.
    """
    number = xp.arange(samples + 1)

    def given(t: Any) -> tuple[Array, Array]:
        return xp.interp(t, time, drive), xp.interp(t, time, load)

    @checkpointed
    def interval(scene: Scene, start: Motion, begin: Array, end: Array) -> Motion:
        h = (end - begin) / used
        c = coefficients(scene.law, h)
        now = given(begin + (end - begin) * xp.minimum(number / used, 1.0))

        def one(state: Motion, now: Any) -> tuple[Motion, None]:
            going, before, after = now
            step = functools.partial(
                _advance, scene, c, before=before, after=after, h=h
            )
            return cond(going, step, lambda y: y, state), None

        ends = [
            tuple(part[at] for part in now) for at in (slice(None, -1), slice(1, None))
        ]
        return in_steps(one, start, (number[:-1] < used, *ends))[0]

    def seen(t: Any, y: Motion) -> History:
        kinetic, spring = energies(scene, y, given(t)[0])
        return History(
            y.depth,
            y.normal,
            y.drag,
            y.position,
            y.velocity,
            y.sinking,
            y.work,
            energy(scene.law, y.line, scene.surface.weight),
            y.driven,
            y.pressed,
            y.damped,
            kinetic,
            spring,
        )

    def step(y: Motion, ends: tuple[Array, Array]) -> tuple[Motion, History]:
        y = interval(scene, y, *ends)
        return y, seen(ends[1], y)

    start = put_down(scene, drive[0], load[0], shortest)
    first = time[1] - time[0]
    ratio = fixed(xp.minimum(shortest / first, 0.5)) ** (1 / max(early, 1))
    instants = xp.concatenate(
        [time[:1], time[0] + first * ratio ** xp.arange(early, 0, -1), time[1:]]
    )
    last, history = in_steps(step, start, (instants[:-1], instants[1:]))
    history = mapped(
        lambda begin, kept: xp.concatenate([begin[None], kept[early:]]),
        seen(instants[0], start),
        history,
    )
    return history, last.line
