"""Transient sliding of one body: from rest, with jumps of velocity and load."""

import math
import warnings
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from .._runtime import as_float64, in_float64, is_traced, not_negative, positive, require
from ..errors import ConvergenceWarning, InputError
from ..foundation.law import Foundation, as_foundation
from ..mapping.lines import AbstractLines, SingleLine
from ..mapping.rough_line import RoughLine
from ..mapping.shapes import Cylinder
from ..material.relaxation import Relaxation
from ..results.slide import Slide
from ..solve.over_line import indenter, rough
from ..solve.passage import Control, estimate_sizes
from ..solve.refine import Levels, refine
from ..solve.slide import Forces, march, padded
from ..solve.timeline import cut, timeline
from .steady import BARE, LAYER, _contact, brief, describe

_ACROSS = 40  # elements over the contact on the coarsest level
_FINEST = 6  # levels beyond the coarsest
_WORK = 3e10  # elements times steps times branches of a march that is still made
_TRACED = 1024  # elements and steps of the coarser level under a transformation


LINE = "bare MDR line under a rough line (forces and friction; no real contact area; no direction average)"


class SlidePlan(NamedTuple):
    """What a history took; printing it says so."""

    elements: int  # on the finest level
    steps: int  # on the finest level
    branches: int
    levels: int
    skipped: str  # elements left out, in words

    def __str__(self) -> str:
        size = f"{self.elements} elements, {self.steps} steps, {self.branches} branches on the finest of {self.levels}"
        return f"{size} levels; {self.skipped}"


@in_float64
def slide(
    material: Any,
    shape: Any,
    *,
    time: Any,
    position: Any,
    load: Any = None,
    depth: Any = None,
    temperature: Any = None,
    rtol: float = 1e-3,
    elements: int | None = None,
) -> Slide:
    """Sliding of a body over rubber at rest, through any history of position and load, or of position and depth.

    The history is linear between the instants. At the first one the body is put down, at once, with the load or depth
    given there, on rubber that was never touched; where two instants are equal, load or depth jump.

    - `time` [s], ascending, equal neighbours allowed; `position` [m] of the body at these instants.
    - `shape`: an indenter, or an `em.RoughLine`, whose load and forces are means per length of line [N/m].
    - `load` [N, or N/m], or `depth` [m]: a number, or one for each instant. `temperature` [K] is one number.
    - `rtol`, 1e-1 to 1e-6: the error of mu to be met, relative to the largest mu of the history (or to 0.03 of the
      slope of the body, if that is more: at rest mu is zero but for the grid).
    - `elements` of the coarser of two levels: taken under `jax.jit`, `grad` and `vmap`, where the size of the contact
      is not known beforehand (`time` must be plain numbers there).

    Only the elements that the body can touch are marched. This is the bare line of the textbook: a direction average is
    defined for steady motion only. Converges to `em.friction(..., average=None)`. Raises `InputError`; points that do
    not converge are NaN and counted in one `ConvergenceWarning`. Source: Popov & Hess 2015, ch. 7; `docs/theory.md`.
    """
    per_length = isinstance(shape, RoughLine)
    foundation = as_foundation(material)
    if per_length and foundation.per_area:
        raise InputError("material must be a half-space under a RoughLine, got a layer: give the material itself.")
    lines = None if per_length else _contact(foundation, shape)[0]
    history = _history(foundation, time, position, load, depth, temperature, rtol, elements, per_length)
    found, plan = _rough(shape, history) if lines is None else _indenter(lines, history)
    model = LINE if per_length else LAYER if foundation.per_area or isinstance(shape, Cylinder) else BARE
    what = describe_line(shape) if per_length else describe(shape)
    inputs = [("material", foundation.name or "given directly"), ("shape", what), *history.inputs]
    return _pack(history, found, plan, model, tuple(inputs), per_length)


class _History(NamedTuple):
    law: Relaxation
    control: Control
    time: np.ndarray
    position: Any
    value: Any
    rtol: float
    elements: int
    traced: bool
    inputs: tuple[tuple[str, str], ...]

    @property
    def viscous(self) -> bool:
        """Whether the law has a dashpot, for all that is known."""
        return is_traced(self.law) or bool(self.law.viscosity > 0)

    @property
    def shortest(self) -> float:
        """The shortest relaxation time, or retardation time of a dashpot, that can be looked at [s]."""
        times = np.diff(self.time)
        least = float(times[times > 0].min()) if (times > 0).any() else 1.0
        law = self.law
        if is_traced(law):
            return least
        known = [float(t) for t, e in zip(law.times, law.moduli, strict=True) if e > 0]
        if law.viscosity > 0:
            known.append(float(law.viscosity / (law.equilibrium + law.moduli.sum() + 1e-300)))
        return min([least, *known])


def _history(
    foundation: Foundation,
    time: Any,
    position: Any,
    load: Any,
    depth: Any,
    temperature: Any,
    rtol: Any,
    elements: Any,
    per_length: bool,
) -> _History:
    if is_traced(time):
        raise InputError("time must be plain numbers under jax.jit, grad and vmap: differentiate in position instead.")
    time, position = as_float64("time", time), as_float64("position", position)
    if time.ndim != 1 or time.shape[0] < 2 or position.shape != time.shape:
        raise InputError(
            "time and position must be lists of the same length, two instants at least, "
            f"got shapes {time.shape} and {position.shape}."
        )
    require("time", time, "finite", np.isfinite)
    require("position", position, "finite", np.isfinite)
    if (np.diff(time) < 0).any():
        i = int(np.argmin(np.diff(time)))
        raise InputError(
            f"time must not fall, got {time[i]:g} followed by {time[i + 1]:g} s (entries {i} and {i + 1})."
        )
    still = np.diff(time) == 0
    if not is_traced(position) and (np.diff(position)[still] != 0).any():
        raise InputError("position must not jump: it differs where two instants of time are equal.")
    if (load is None) == (depth is None):
        given = "neither" if load is None else "both"
        raise InputError(f"load or depth must be given, and only one of them, got {given}.")
    control: Control = "load" if depth is None else "depth"
    value = as_float64(control, load if depth is None else depth)
    if value.shape not in ((), time.shape):
        raise InputError(f"{control} must be one number, or one for each of {time.size} instants, got {value.shape}.")
    if control == "load":
        not_negative("load", value)
    else:
        require("depth", value, "finite", np.isfinite)
    if isinstance(rtol, bool) or not isinstance(rtol, (int, float)) or not 1e-6 <= rtol <= 1e-1:
        raise InputError(f"rtol must be a number from 1e-6 to 1e-1, got {rtol!r}.")
    if elements is not None and (not isinstance(elements, int) or elements < 16):
        raise InputError(f"elements must be a whole number, 16 at least, got {elements!r}.")
    law = foundation.law()
    inputs = [("time", brief(time, "s")), ("position", brief(position, "m"))]
    inputs.append((control, brief(value, ("N/m" if per_length else "N") if control == "load" else "m")))
    if temperature is not None:
        if foundation.shift is None:
            raise InputError("temperature was given, but the material has no shift law; leave the temperature out.")
        kelvin = as_float64("temperature", temperature)
        positive("temperature", kelvin)
        factor = foundation.shift.a(kelvin)
        law = Relaxation(law.equilibrium, law.moduli, law.times * factor, law.viscosity * factor)
        inputs.append(("temperature", brief(kelvin, "K")))
    inputs.append(("relative tolerance", f"{rtol:g}"))
    traced = is_traced(law, position, value)
    value = (jnp if traced else np).broadcast_to(value, time.shape)
    if control == "depth" and not traced and float(law.viscosity) > 0:
        jumps = np.diff(np.concatenate([np.zeros(1), value]))[np.concatenate([np.ones(1, bool), still])]
        if (np.maximum(value[np.concatenate([np.ones(1, bool), still])], 0) * (jumps > 0) > 0).any():
            raise InputError("depth must not jump on a material with a viscosity, whose force would be infinite.")
    return _History(law, control, time, position, value, float(rtol), elements or _TRACED, traced, tuple(inputs))


def _rough(shape: RoughLine, history: _History) -> tuple[Levels, SlidePlan]:
    """Marches one period under a rough line."""
    law = jax.tree.map(jnp.asarray, history.law)
    traced = history.traced or is_traced(shape)
    even = max(4, -(-history.elements // max(history.time.size - 1, 1)))
    spacing = None if is_traced(history.position, history.value) else float(shape.spacing)
    line = timeline(history.time, history.position, history.value, spacing, history.shortest, even)
    size: list[int] = []

    def solve(level: int) -> tuple[Forces, Any]:
        finer = 2**level
        steps, last = cut(line, history.time, history.position, history.value, history.shortest, finer)
        surface = rough(shape._finer(finer), shape.spacing / finer, shape.highest)
        forces, _ = march(law, surface, padded(steps), control=history.control, viscous=history.viscous)
        size[:] = surface.count, steps.h.shape[0]
        forces = Forces(*(field[last] for field in forces))
        return forces if is_traced(forces) else jax.tree.map(np.asarray, forces), np.bool_(True)

    work = shape.count * line.part.size * law.times.size
    found = refine(solve, history.rtol, _finest(work, traced), shape.rms_slope)
    text = f"every element of the period of {float(shape.period):.4g} m can be touched"
    return found, SlidePlan(size[0], size[1], int(law.times.size), found.levels, text)


def _finest(work: int, traced: bool) -> int:
    """The finest level that is still marched, for elements times steps times branches of the coarsest."""
    most = 1 if traced else _FINEST
    while most > 1 and 4.0**most * work > _WORK:
        most -= 1
    return most


def describe_line(line: RoughLine) -> str:
    """A rough line in words."""
    text = f"{line.label}, {line.count} points, period {float(line.period):.4g} m"
    return text if is_traced(line) else f"{text}, rms height {float(line.rms_height):.4g} m"


def _indenter(lines: AbstractLines, history: _History) -> tuple[Levels, SlidePlan]:
    """Marches the elements that an indenter can touch; more of them where it turns out to reach further."""
    law = jax.tree.map(jnp.asarray, history.law)
    sizes = _sizes(law, lines, history.control, jnp.asarray(history.value), float(np.ptp(history.time)))
    reach = 1.6 * sizes[1]
    while True:
        found, plan, outside = _within(lines, law, history, sizes, reach)
        if not outside or float(reach) > 30 * float(sizes[1]):
            return found, plan
        reach = 2 * reach


def _within(
    lines: AbstractLines, law: Relaxation, history: _History, sizes: tuple[Any, Any], reach: Any
) -> tuple[Levels, SlidePlan, bool]:
    """Marches the elements up to `reach` [m] from the body's path; whether the outermost of them were touched."""
    glassy, widest = sizes
    traced = history.traced or is_traced(lines)
    numpy = jnp if is_traced(history.position) else np
    first, length = numpy.min(history.position) - reach, numpy.ptp(history.position) + 2 * reach
    if traced:
        spacing, count = length / history.elements, history.elements
        even = max(4, -(-history.elements // max(history.time.size - 1, 1)))
        line = timeline(history.time, history.position, history.value, None, history.shortest, even)
    else:
        spacing = float(2 * math.sqrt(glassy * widest) / _ACROSS)
        count = 32 * math.ceil(float(length) / spacing / 32)
        line = timeline(history.time, history.position, history.value, spacing, history.shortest, 0)
    size, outside = [0, 0], [False]
    largest = lines.shape.largest_contact
    deepest = jnp.where(jnp.isinf(largest), jnp.inf, lines.depth(largest * (1 - 1e-12)))

    def solve(level: int) -> tuple[Forces, Any]:
        finer = 2**level
        steps, last = cut(line, history.time, history.position, history.value, history.shortest, finer)
        surface = indenter(lines, first + 0.5 * spacing / finer, spacing / finer, count * finer, reach)
        forces, end = march(law, surface, padded(steps), control=history.control, viscous=history.viscous)
        size[:] = surface.count, steps.h.shape[0]
        # The outermost elements must never have been touched, else the body reaches further than was thought.
        u = end.u.reshape(-1, count * finer)
        inside = (u[:, 0] == 0).all() & (u[:, -1] == 0).all()
        forces = Forces(*(field[last] for field in forces))
        room = forces.depth < deepest
        if not is_traced(forces):
            forces, inside, room = jax.tree.map(np.asarray, (forces, inside, room))
            outside[0] = not inside
        return forces, inside & room

    work = count * line.part.size * max(law.times.size, 1) * (1 if isinstance(lines, SingleLine) else count // 2)
    found = refine(solve, history.rtol, _finest(work, traced), lines.depth(widest) / widest)
    text = "elements that the body cannot touch are left out"
    return found, SlidePlan(size[0], size[1], int(law.times.size), found.levels, text), outside[0]


def _sizes(law: Relaxation, lines: AbstractLines, control: Control, value: Any, duration: float) -> tuple[Any, Any]:
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


def _pack(
    history: _History, found: Levels, plan: Any, model: str, inputs: tuple[tuple[str, str], ...], per_length: bool
) -> Slide:
    numpy = jnp if is_traced(found) else np
    if not is_traced(found) and not found.good.all():
        text = f"{int((~found.good).sum())} of {found.good.size} points did not converge to rtol={history.rtol:g}; "
        warnings.warn(f"{text}they are NaN.", ConvergenceWarning, stacklevel=4)

    def shown(field: Any) -> Any:
        return numpy.where(found.good, field, numpy.nan)

    forces = found.forces
    gone = np.diff(history.time)
    speed = numpy.where(gone > 0, numpy.diff(history.position) / np.where(gone > 0, gone, 1.0), 0.0)
    velocity = numpy.concatenate([numpy.zeros(1), speed])
    return Slide(
        time=history.time,
        position=history.position,
        velocity=velocity,
        mu=shown(found.mu),
        normal_force=shown(forces.normal),
        friction_force=shown(forces.drag),
        depth=shown(forces.depth),
        work=shown(forces.work),
        stored=shown(forces.stored),
        dissipated=shown(forces.work - forces.stored),
        error=shown(found.error),
        converged=found.good,
        per_length=per_length,
        model=model,
        plan=plan,
        inputs=inputs,
    )
