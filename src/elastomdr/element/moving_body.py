"""A body over elements: one step for the contact, and for masses on springs and
dampers.

The body stands at X along the line, at depth d. A drive at D(t) pulls it, a load P(t)
presses it:

    m_t X'' = k_t (D - X) + c_t (D' - X') - F_x,        or X = D without a tangential mount,
    m_n d'' = P - k_n d - c_n d' - F_N,                 or F_N = P without a normal one,

or its depth is given. F_x and F_N are the forces of the elements
(`element.body_over_line`). Bodies take the trapezoidal rule, elements the exact
contact step, both of second order, and they are solved together. The force of an
element is linear in its displacement at the end, and so is its mean over the step,
which is what accelerates a body: with d+ = d + h (d' + d'+)/2 the normal equation is

    A d+ + sum W S max(0, d+ - l) = known,        A = 2 m/h^2 + k/2 + c/h,

piecewise linear, solved exactly (`element.body_over_line.settle`); the tangential one takes a
fixed number of Newton steps. The work of the mean forces is that of the elements but
for those whose contact begins or ends within the step.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

from ..arrays import on_numpy, xp
from ..checks import Array, not_negative, positive, scalar
from ..material.relaxation import Relaxation
from ..trees import Tree, fill
from .body_over_line import AbstractOverLine, felt_by, settle, total
from .contact_step import (
    Coefficients,
    Elements,
    Fading,
    advance,
    coefficients,
    fade,
    if_so,
    lag,
    released,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import Number, Plain

_NEWTON = 4  # steps for the place of a body that is pulled through a spring, under JAX
# steps at most on NumPy, to a balance of forces relative to the largest of them
_SECANTS, _CLOSE = 40, 1e-12


class InTurn(NamedTuple):
    """Where depth and load may rule in turn: the value of a step is what either goes
    towards.
    """

    part: Float[Array, " steps"]  # of what is left of the way, that a step goes
    by_depth: Bool[Array, " steps"]  # which of them rules


class Steps(NamedTuple):
    """Contact steps: how long each is, and where the history stands at its end."""

    h: Float[Array, " steps"]  # [s]
    position: Float[Array, " steps"]  # X [m]
    value: Float[Array, " steps"]  # load [N] or depth [m]
    in_turn: InTurn | None = None


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
        fill(
            self,
            mass=scalar("mass", mass),
            stiffness=scalar("stiffness", stiffness),
            damping=scalar("damping", damping),
        )
        positive("mass", self.mass)
        not_negative("stiffness", self.stiffness)
        not_negative("damping", self.damping)

    def for_line(self, load: Number, normal_force: Number) -> Mount:
        """The share that a metre of rough line has of this mount of a whole body,
        load/normal_force of it.

        `load` [N/m] of the line, `normal_force` [N] of the whole body on the rubber,
        for which the line stands. Raises `InputError`.
        """
        given = scalar("load", load), scalar("normal_force", normal_force)
        positive("load", given[0])
        positive("normal_force", given[1])
        share = given[0] / given[1]
        return Mount(share * self.mass, share * self.stiffness, share * self.damping)


class MotionScene(NamedTuple):
    """What stays the same during the motion."""

    law: Relaxation
    surface: AbstractOverLine
    tangential: Mount | None = None
    normal: Mount | None = None


class LineMemory(NamedTuple):
    """What n elements remember from one step to the next; see
    `element.contact_step.Elements`.
    """

    u: Float[Array, " n"]  # [m]
    f: Float[Array, "k n"]  # [Pa m]
    q: Float[Array, " n"]  # [Pa m]
    velocity: Float[Array, " n"] | None  # [m/s], which only a dashpot needs
    stored: Float[Array, " n"]  # in the branches [Pa m^2]
    w: Float[Array, " n"]  # where the rigid surface is [m]


class BodyMotion(NamedTuple):
    """Body and elements at one instant, and the work done since the start."""

    line: LineMemory
    drive: Array  # D [m]
    value: Array  # load [N], or depth [m]
    position: Array  # X [m]
    velocity: Array  # X' [m/s]
    depth: Array  # d [m]
    sinking: Array  # d' [m/s]
    ahead: Array  # guess for the depth at the end of the next step [m]
    work: Array  # of the contact forces on the elements [J]
    driven: Array  # of the drive [J]
    pressed: Array  # of the load [J]
    damped: Array  # lost in the dampers [J]


def untouched(scene: MotionScene, place: Array, viscous: bool) -> BodyMotion:
    """A body just above rubber at rest, where the first step ends."""
    position, zero = place + 0.0, xp.zeros(())
    rise = scene.surface.rise(position)
    none, f = xp.zeros_like(rise), xp.zeros((scene.law.moduli.shape[0], rise.size))
    velocity = none if viscous else None
    line = LineMemory(none, f, none, velocity, none, rise - xp.max(rise))
    # From above, where all are touched: a dashpot carries a sudden load within 1e-10 m,
    # where a search from below ends too early.
    above = xp.max(-rise)
    motion = BodyMotion(line, position, *[zero] * (len(BodyMotion._fields) - 2))
    return motion._replace(position=position, ahead=above)


def put_down(
    scene: MotionScene, y: BodyMotion, begin: Steps, viscous: bool
) -> tuple[BodyMotion, tuple[Array, Array | None]]:
    """The body at rest, put down at once with its load."""
    surface, spring = scene.surface, 0.0
    if scene.normal is not None:
        spring = scene.normal.stiffness
    c = coefficients(scene.law, begin.h, viscous=viscous)
    rise, slope = surface.rise_and_slope(y.position)
    fading = fade(c, y.line.f)
    touch_depth = released(c, y.line.u, fading.seen) - rise
    stiffness = surface.weight * c.stiffness[0]
    depth = settle(
        touch_depth, stiffness, spring, begin.value, y.ahead, surface.between
    )
    if begin.in_turn is not None:
        depth = xp.where(begin.in_turn.by_depth, begin.value, depth)
    line, element_work = _press(c, y.line, fading, rise, depth)
    work = total(surface.weight, element_work)
    excess = depth - touch_depth if surface.between else None
    value = begin.value
    if begin.in_turn is not None:
        felt = felt_by(surface.weight, line.q, slope, excess)[0]
        value = xp.where(begin.in_turn.by_depth, felt, value)
    motion = y._replace(
        line=line,
        value=value,
        depth=depth,
        ahead=depth,
        work=work,
        pressed=work + spring * depth**2 / 2,
    )
    return motion, (slope, excess)


def advance_body(
    scene: MotionScene,
    c: Coefficients,
    y: BodyMotion,
    end: Steps,
    control: Literal["load", "depth"],
    viscous: bool,
    balance: bool,
) -> tuple[BodyMotion, tuple[Array, Array | None]]:
    """One step of body and elements, and the slope of the body and what the elements
    are pressed beyond u_free at its end.
    """
    surface = scene.surface
    fading = if_so(end.h >= 0, functools.partial(fade, c), y.line.f)
    u_free = released(c, y.line.u, fading.seen)
    mean: Any = _MeanForce(scene, c, y, end, fading) if balance else None

    def depth_at(rise: Array, guess: Array) -> Array:
        if control == "depth":
            return end.value
        if end.in_turn is not None:
            touch_depth = u_free - rise
            return _in_turn(c, y, end.value, end.in_turn, touch_depth, surface, guess)
        if scene.normal is not None:
            return mean.depth_at(rise, guess)
        stiffness = surface.weight * c.stiffness[0]
        return settle(u_free - rise, stiffness, 0.0, end.value, guess, surface.between)

    def forces(moved: Array, guess: Array) -> tuple[Array, Array]:
        """Mean F_x of the step in which the body moves so far; the depth at the end."""
        rise = surface.rise(y.position + moved)
        _, slope = surface.rise_and_slope(y.position + moved / 2)
        depth = depth_at(rise, guess)
        return mean.drag(depth + rise, slope), depth

    moved, guess = end.position - y.position, y.ahead
    if scene.tangential is not None:
        moved, guess = _pulled(scene.tangential, forces, y, end)
    position = y.position + moved
    rise, slope = surface.rise_and_slope(position)
    if balance and end.in_turn is None:
        drag, depth = forces(moved, guess)
    else:
        drag, depth = xp.zeros(()), depth_at(rise, guess)
    if viscous:
        _, slope = surface.rise_and_slope(position - lag(c) * moved)
    line, element_work = _press(c, y.line, fading, rise, depth)
    done = total(surface.weight, element_work)
    excess = depth + rise - u_free if surface.between else None
    after = y._replace(
        line=line,
        drive=end.position,
        value=end.value,
        position=position,
        depth=depth,
        work=y.work + done,
    )
    if end.in_turn is not None:
        part, by_depth = end.in_turn
        felt = felt_by(surface.weight, line.q, slope, excess)[0]
        load = y.value + (end.value - y.value) * part
        after = after._replace(value=xp.where(by_depth, felt, load))
    after = _moved(scene, y, after, end.h, drag)
    if end.in_turn is not None and viscous:
        # a dashpot's force jumps with the rate of the depth
        by_rate = end.in_turn.by_depth & (scene.law.viscosity > 0)
        pressed = xp.where(by_rate, y.pressed + done, after.pressed)
        after = after._replace(pressed=pressed)
    return after, (slope, excess)


def _in_turn(
    c: Coefficients,
    y: BodyMotion,
    target: Array,
    in_turn: InTurn,
    touch_depth: Array,
    surface: AbstractOverLine,
    guess: Array,
) -> Array:
    """The depth at the end of a step in which depth or load goes on towards its end."""
    load = y.value + (target - y.value) * in_turn.part
    # With a dashpot q is a mean over the end of the step: so is the load.
    load = xp.maximum(load - (load - y.value) * lag(c), 0.0)
    lowest = xp.min(touch_depth)
    guess = xp.where(load > 0, guess, lowest)
    stiffness = surface.weight * c.stiffness[0]
    carrying = settle(touch_depth, stiffness, 0.0, load, guess, surface.between)
    # without a load it lies on the surface
    carrying = xp.where(load > 0, carrying, lowest)
    given = y.depth + (target - y.depth) * in_turn.part
    return xp.where(in_turn.by_depth, given, carrying)


class _MeanForce:
    """The mean force of the elements over a step, if they follow the surface: mean S
    (w+ - idle).
    """

    def __init__(
        self,
        scene: MotionScene,
        c: Coefficients,
        y: BodyMotion,
        end: Steps,
        fading: Fading,
    ):
        self.scene, self.y, self.end = scene, y, end
        self.stiffness = (0.5 * c.equilibrium + c.drag)[0]
        self.idle = y.line.u - (c.equilibrium * y.line.u + fading.mean) / self.stiffness

    def drag(self, w: Array, slope: Array) -> Array:
        """F_x for the surface at w at the end, db/dX in the middle of the step."""
        weight, excess = self.scene.surface.weight, w - self.idle
        q = self.stiffness * xp.maximum(excess, 0.0)
        between = self.scene.surface.between
        return felt_by(weight, q, slope, excess if between else None)[1]

    def depth_at(self, rise: Array, guess: Array) -> Array:
        """The depth at the end of a body on a normal mount."""
        mount, surface, y = self.scene.normal, self.scene.surface, self.y
        assert mount is not None
        inertia = _inertia(mount, self.end.h)
        known = (
            2 * mount.mass * y.sinking / self.end.h
            + (y.value + self.end.value) / 2
            - mount.stiffness * y.depth
        )
        return settle(
            self.idle - rise,
            surface.weight * self.stiffness,
            inertia,
            known + inertia * y.depth,
            guess,
            surface.between,
        )


def _inertia(mount: Mount, h: Array) -> Array:
    """A: force per displacement in a step of the trapezoidal rule."""
    return 2 * mount.mass / h**2 + mount.stiffness / 2 + mount.damping / h


def _pulled(
    mount: Mount, forces: Callable[..., Any], y: BodyMotion, end: Steps
) -> tuple[Array, Array]:
    """How far the body moves that is pulled through a spring, and a guess for its
    depth.
    """
    pull = (
        mount.stiffness * ((y.drive + end.position) / 2 - y.position)
        + mount.damping * (end.position - y.drive) / end.h
    )
    known = 2 * mount.mass * y.velocity / end.h + pull
    search = _by_secants if on_numpy() else _by_newton
    return search(forces, _inertia(mount, end.h), known, end.h * y.velocity, y.ahead)


def _moved(
    scene: MotionScene, y: BodyMotion, after: BodyMotion, h: Array, drag: Array
) -> BodyMotion:
    """`after` with its velocities and what drive, load and dampers did; `drag` is the
    mean F_x.
    """
    moved, sunk = after.position - y.position, after.depth - y.depth
    velocity, sinking, driven, damped = moved / h, sunk / h, drag * moved, 0.0
    if scene.tangential is not None:
        mount, pulled = scene.tangential, after.drive - y.drive
        velocity = 2 * moved / h - y.velocity
        stretch = (y.drive + after.drive) / 2 - y.position - moved / 2
        slip = pulled - moved
        driven = (mount.stiffness * stretch + mount.damping * slip / h) * pulled
        damped = mount.damping * slip**2 / h
    if scene.normal is not None:
        sinking = 2 * sunk / h - y.sinking
        damped = damped + scene.normal.damping * sunk**2 / h
    ahead = sunk if scene.normal is None else h * sinking
    return after._replace(
        velocity=velocity,
        sinking=sinking,
        ahead=after.depth + ahead,
        driven=y.driven + driven,
        pressed=y.pressed + (y.value + after.value) / 2 * sunk,
        damped=y.damped + damped,
    )


def _press(
    c: Coefficients, line: LineMemory, fading: Fading, rise: Array, depth: Array
) -> tuple[LineMemory, Array]:
    """The line after a step at whose end the body stands at `depth`, and the work done
    on each element [Pa m^2].
    """
    zero = xp.zeros_like(line.u)
    w = depth + rise
    # The integrals of `advance` count from zero in each step and are summed at once: an
    # element carries few numbers.
    velocity = zero if line.velocity is None else line.velocity
    before = Elements(
        line.u, line.f, line.q, velocity, zero, zero, zero, line.stored, zero
    )
    after = advance(c, before, line.w, w, fading, functools.partial(if_so, c.h[0] >= 0))
    work = after.inelastic + 0.5 * c.equilibrium * (after.u**2 - line.u**2)
    velocity = None if line.velocity is None else after.velocity
    return LineMemory(after.u, after.f, after.q, velocity, after.stored, w), work


def _by_newton(
    forces: Callable[..., Any], inertia: Array, known: Array, moved: Array, guess: Array
) -> tuple[Array, Array]:
    """Where inertia moved + F_x(moved) = known, and a guess for the depth there."""
    import jax

    def improve(
        state: tuple[Array, Array], _: None
    ) -> tuple[tuple[Array, Array], None]:
        moved, guess = state
        drag, steepness, guess = jax.jvp(
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
    """The same without derivatives, by secants: two values of the force as a rule.
    SciPy's would take a third to see that it has converged.
    """
    steepness, before = 0.0, None
    for _ in range(_SECANTS):
        drag, guess = forces(moved, guess)
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
