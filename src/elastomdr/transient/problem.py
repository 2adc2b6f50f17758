"""The history of a sliding body as it was given: its arguments checked, what is known
of its time scales, and its contact steps.

It is linear between its instants; two equal ones are a jump of load or depth. Where
motion or load changes abruptly, the rubber answers on all its time scales: the first
step after it is divided geometrically, down to the shortest relaxation time. Every step
of the finer levels is a part of one of the coarsest, so that errors fall in proportion
to the square of the step.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import stop_gradient, xp
from ..call.problem import check_rtol, doubt_depth
from ..checks import (
    Array,
    alike,
    as_float64,
    finite,
    in_kelvin,
    is_traced,
    nan_unless,
    not_negative,
    numbers_only,
    only_one,
    scalar,
    whole_number,
)
from ..element.law import Foundation, as_foundation, half_space
from ..element.moving_body import Steps
from ..errors import InputError, ModelWarning, warn
from ..material.prony import Prony
from ..material.relaxation import Relaxation, scaled
from ..material.shift import thermal_factors
from ..material.validity import Range, material_in_words
from ..results.doubts import Doubt
from ..results.words import brief, describe
from ..smooth.passage import Control
from ..smooth.problem import BARE, LAYER, NO_UNIT, contact, in_no_unit
from ..surface.lines import AbstractLines
from ..surface.rough_line import RoughLine
from ..surface.shapes import AbstractShape, Cylinder

if TYPE_CHECKING:
    from .._types import ArrayLike

_TRACED = 1024  # elements and steps of the coarser level under a transformation

_FEWEST = 4  # steps between two instants
MOST_ELEMENTS = 1_000_000  # that may be asked for, of a contact or of steps
# change of a rate, relative to the larger of both, from which it counts as abrupt
_ABRUPT = 0.3
_HALVINGS = 40  # of the first step after an abrupt change, at most
_INSTANT = 1e-12  # duration of a jump, over the shortest time of the scene

LINE = (
    "bare MDR line under a rough line (forces and friction; no real contact area; no "
    "direction average)"
)


class Bound(NamedTuple):
    """How far a model is at most from three dimensions: 0 where it is exact, NaN where
    that is not known, for this reason.
    """

    size: Any = 0.0
    why: str = ""  # "springs stand for a layer"
    remedy: str = ""
    warns: bool = False  # what is left out, the rubber has

    def at(self, computed: Array) -> Array:
        """At the points that are computed; NaN elsewhere."""
        return nan_unless(computed, self.size + 0.0 * computed)

    def marks(self, computed: Array) -> tuple[Doubt, ...]:
        """The doubt in a result for which it is not known; some with a warning."""
        if not self.why:
            return ()
        says = f"have no bound on the model: {self.why}"
        unknown = (computed != 0) & xp.isnan(self.size + 0.0 * computed)
        doubt = Doubt("no prediction", unknown, says, self.remedy)
        if self.warns:
            warn(f"{doubt.words()}.", ModelWarning)
        return (doubt,)


def unknown(why: str, remedy: str = "") -> Bound:
    """No bound is established."""
    return Bound(np.nan, why, remedy)


SPRINGS = unknown(
    "springs stand for a layer", "em.layer(material, thickness), the layer itself"
)
STEADY_LINE = unknown(
    "the bare line overstates steady friction of a half-space by up to a factor of 2, "
    "and what it does to a history is not known",
    "em.friction for steady sliding",
)
ROUGH_LINE = unknown("a rough line is no surface")
SOFTENED = Bound(
    np.nan,
    "the softening of the rubber by strain is left out, moduli are those of small strain",
    "em.friction for steady sliding, which follows it",
    warns=True,
)


def bound_on(
    foundation: Foundation, shape: AbstractShape | RoughLine, on_half_space: Bound
) -> Bound:
    """Of a linear model that is exact on springs that are given per area."""
    if foundation.softening is not None:
        return SOFTENED
    if foundation.slab is not None:
        return SPRINGS
    if in_no_unit(foundation, shape):
        return unknown(*NO_UNIT)
    return Bound() if foundation.per_area else on_half_space


class SlidePlan(NamedTuple):
    """What a history took; printing it says so."""

    elements: int  # on the finest level
    steps: int  # on the finest level
    branches: int
    levels: int
    skipped: str  # elements left out, in words

    def __str__(self) -> str:
        size = (
            f"{self.elements} elements, {self.steps} steps, {self.branches} branches "
            f"on the finest of {self.levels}"
        )
        return f"{size} levels; {self.skipped}"


class SlidingBody(NamedTuple):
    """A body and what it slides over."""

    foundation: Foundation
    over: RoughLine | AbstractLines
    per_length: bool  # whether loads and forces are per metre of line
    model: str
    words: tuple[tuple[str, str], ...]

    @property
    def bound(self) -> Bound:
        """Of the model."""
        over = self.over if isinstance(self.over, RoughLine) else self.over.shape
        bound = bound_on(self.foundation, over, STEADY_LINE)
        return ROUGH_LINE if self.per_length and not bound.warns else bound

    def doubt_depth(self, depth: Array) -> tuple[Doubt, ...]:
        """The doubt of an indenter that is too deep."""
        if isinstance(self.over, RoughLine):
            return ()
        return doubt_depth(self.foundation, self.over.shape, depth)


def sliding_body(material: object, shape: Any) -> SlidingBody:
    """Raises `InputError` for a pair that does not go together."""
    foundation = as_foundation(material)
    rubber = material_in_words(foundation)
    if isinstance(shape, RoughLine):
        if foundation.per_area:
            raise InputError(
                argument="material",
                got=material,
                accepted="a half-space under a RoughLine",
                hint="give the material itself",
            )
        words = (*rubber, ("shape", describe_line(shape)))
        return SlidingBody(foundation, shape, True, LINE, words)
    lines = contact(foundation, shape)[0]
    on_layer = foundation.per_area or isinstance(shape, Cylinder)
    words = (*rubber, ("shape", describe(shape)))
    return SlidingBody(foundation, lines, False, LAYER if on_layer else BARE, words)


class GivenHistory(NamedTuple):
    """Position and load, or depth, at the instants of a history, and the law at its
    temperature.
    """

    law: Relaxation
    control: Control
    time: np.ndarray
    position: Any
    value: Any
    rtol: float
    elements: int
    traced: bool  # law, body, position, value or what else the motion depends on
    inputs: tuple[tuple[str, str], ...]
    range: Range | None  # of the material
    temperature: Any  # [K], or None
    factor: Any  # a_T

    @property
    def viscous(self) -> bool:
        """Whether the law has a dashpot, for all that is known."""
        return is_traced(self.law) or bool(self.law.viscosity > 0)

    @property
    def shortest(self) -> float:
        """The shortest relaxation time, or retardation time of a dashpot, that can be
        looked at [s].
        """
        times = np.diff(self.time)
        least = float(times[times > 0].min()) if (times > 0).any() else 1.0
        law = self.law
        if is_traced(law):
            return least
        known = [float(t) for t, e in zip(law.times, law.moduli, strict=True) if e > 0]
        if law.viscosity > 0:
            known.append(
                float(law.viscosity / (law.equilibrium + law.moduli.sum() + 1e-300))
            )
        return min([least, *known])


def given_history(
    body: SlidingBody,
    time: ArrayLike,
    position: ArrayLike,
    load: ArrayLike | None,
    depth: ArrayLike | None,
    temperature: ArrayLike | None,
    rtol: float,
    elements: int | None,
    *others: object,
) -> GivenHistory:
    """The history that `em.slide` and `em.drive` were asked for; the motion depends on
    `others` too. Raises `InputError` for one that they cannot take.
    """
    time, position = _path(time, position)
    control: Control = (
        "load" if only_one({"load": load, "depth": depth}) == "load" else "depth"
    )
    value = as_float64(control, load if depth is None else depth)
    if value.shape not in ((), time.shape):
        raise InputError(
            argument=control,
            got=value,
            accepted=f"one number, or one for each of {time.size} instants",
            hint=f"it has the shape {value.shape}",
        )
    if control == "load":
        not_negative("load", value)
    else:
        finite("depth", value)
    rtol = check_rtol(rtol, "1e-6", "1e-1")
    if elements is not None:
        whole_number("elements", elements, 16, MOST_ELEMENTS)
    law, temperature, factor = at_temperature(body.foundation, temperature)
    unit = "m" if control == "depth" else "N/m" if body.per_length else "N"
    inputs = [
        ("time", brief(time, "s")),
        ("position", brief(position, "m")),
        (control, brief(value, unit)),
    ]
    if temperature is not None:
        inputs.append(("temperature", brief(temperature, "K")))
    inputs.append(("relative tolerance", f"{rtol:g}"))
    traced = is_traced(law, position, value)
    value = (xp if traced else np).broadcast_to(value, time.shape)
    if control == "depth" and not traced and float(law.viscosity) > 0:
        _check_jumps(time, value)
    return GivenHistory(
        law=law,
        control=control,
        time=time,
        position=position,
        value=value,
        rtol=rtol,
        elements=elements or _TRACED,
        traced=traced or is_traced(body.over, others),
        inputs=tuple(inputs),
        range=body.foundation.range,
        temperature=temperature,
        factor=factor,
    )


def _path(time: Any, position: Any) -> tuple[np.ndarray, Any]:
    """Instants and places. Raises `InputError` for what no body can follow."""
    numbers_only({"time": time}, "differentiate in position instead")
    time, position = as_float64("time", time), as_float64("position", position)
    alike(2, {"time": time, "position": position})
    finite("time", time)
    finite("position", position)
    if (np.diff(time) < 0).any():
        i = int(np.argmin(np.diff(time)))
        raise InputError(
            argument="time",
            got=[float(t) for t in time[i : i + 2]],
            accepted="ascending [s]; two equal instants are a jump",
            hint=f"entries {i} and {i + 1}",
        )
    still = np.diff(time) == 0
    if not is_traced(position) and (np.diff(position)[still] != 0).any():
        raise InputError(
            argument="position",
            got=position,
            accepted="the same where two instants of time are equal",
        )
    return time, position


def _check_jumps(time: np.ndarray, depth: np.ndarray) -> None:
    """Raises `InputError` for depths into the rubber that a dashpot cannot follow."""
    sudden = np.append(True, np.diff(time) == 0)
    if ((np.diff(depth, prepend=0.0) > 0) & (depth > 0) & sudden).any():
        raise InputError(
            argument="depth",
            got=depth,
            accepted="without jumps into a material with a viscosity",
            hint="its force would be infinite",
        )


def at_temperature(
    foundation: Foundation, temperature: Any
) -> tuple[Relaxation, Any, Any]:
    """The law with times and moduli shifted to a temperature [K], that as an array, and
    a_T; None leaves it.
    """
    law = foundation.law()
    if temperature is None:
        return law, None, 1.0
    temperature = scalar("temperature", temperature)
    in_kelvin("temperature", temperature)
    factor, vertical = thermal_factors(foundation, temperature)
    if not is_traced(factor) and not 1e-60 < float(factor) < 1e60:
        raise InputError(
            argument="temperature",
            got=float(temperature),
            accepted="near where the shift law was measured [K]",
            hint=f"a_T = {factor:.3g}",
        )
    law = scaled(law, vertical)
    return (
        Relaxation(
            law.equilibrium, law.moduli, law.times * factor, law.viscosity * factor
        ),
        temperature,
        factor,
    )


def describe_line(line: RoughLine) -> str:
    """A rough line in words."""
    description = (
        f"{line.label}, {line.count} points, period {float(line.period):.4g} m"
    )
    return (
        description
        if is_traced(line)
        else f"{description}, rms height {float(line.rms_height):.4g} m"
    )


def check_shape(shape: object) -> None:
    """Raises `InputError` for what is no indenter."""
    if not isinstance(shape, AbstractShape):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an em.Sphere, em.Cone, em.Profile, em.Cylinder or the like",
        )


def standing(foundations: list[Foundation], material: object, shape: object) -> bool:
    """Whether the scene is one on a layer. Raises `InputError` for what is no shape, and
    where half-space and shape do not go together.
    """
    check_shape(shape)
    kinds = {foundation.is_springs(shape) for foundation in foundations}
    if len(kinds) > 1:
        raise InputError(
            argument="material", accepted="a list of half-spaces or a list of layers"
        )
    per_area = kinds.pop()
    if isinstance(shape, Cylinder) and not per_area:
        raise no_cylinder(material)
    return per_area


def no_cylinder(material: object) -> InputError:
    """What is said of a cylinder on a half-space."""
    return InputError(
        argument="material",
        got=material,
        accepted="independent springs, em.springs(material, thickness), under a "
        "Cylinder",
        hint="a cylinder on a half-space is no MDR problem; in a scene the springs are "
        "a [layer] with springs = true, with bonded = false if it is incompressible",
    )


def both_laws(material: object, tangential: object) -> tuple[Foundation, Foundation]:
    """E* of a material or `Foundation`, and G* of it or of what is given. Raises
    `InputError`.
    """
    normal = as_foundation(material)
    if tangential is None:
        if not isinstance(material, Prony):
            raise InputError(
                argument="tangential",
                accepted="given with a Foundation, which knows the normal direction only",
                hint="em.half_space(material, tangential=True), or an em.Foundation of "
                "G*",
            )
        return normal, half_space(material, tangential=True)
    if isinstance(tangential, Prony):
        return normal, half_space(tangential, tangential=True)
    if not isinstance(tangential, Foundation):
        raise InputError(
            argument="tangential", got=tangential, accepted="an em.Foundation of G*"
        )
    return normal, tangential


class Timeline(NamedTuple):
    """The coarsest steps after the body is put down: which interval each belongs to and
    how far in it ends, from 0 to 1.
    """

    interval: np.ndarray  # (steps,)
    fraction: np.ndarray  # at the end of each step
    share: np.ndarray  # of the interval that the step takes
    instant: np.ndarray  # (instants - 1,) index of the step that ends there


def timeline(
    time: np.ndarray,
    position: Array,
    value: Array,
    spacing: float | None,
    shortest: float,
    even: int,
    grading: int = 1,
    early: bool | None = None,
) -> Timeline:
    """Cuts a history. A moving body takes one step per `spacing` [m]; `even` steps per
    interval where that is None. They narrow towards both ends with a `grading`; and
    `early`, after an abrupt change, down to the shortest time.
    """
    early = spacing is not None if early is None else early
    pieces: list[np.ndarray] = []
    before: np.ndarray | None = None
    for j, length in enumerate(np.diff(time)):
        if length == 0:
            pieces.append(np.ones(1))
            before = None
            continue
        count = even
        if spacing is not None:
            way = abs(position[j + 1] - position[j])
            count = max(_FEWEST, math.ceil(way / spacing))
        parts = np.diff(places(count, grading))
        if early:
            change = np.array([position[j + 1] - position[j], value[j + 1] - value[j]])
            rate = change / length
            if before is None or _is_abrupt(before, rate):
                halvings = math.ceil(math.log2(length * parts[0] / shortest))
                halves = 0.5 ** np.arange(1, min(_HALVINGS, max(0, halvings)) + 1)
                first = parts[0] * np.append(
                    halves, halves[-1:] if halves.size else 1.0
                )
                parts = np.concatenate([first[::-1], parts[1:]])
            before = rate
        pieces.append(parts)
    sizes = [piece.size for piece in pieces]
    return Timeline(
        interval=np.repeat(np.arange(len(pieces)), sizes),
        fraction=np.concatenate([np.cumsum(piece) for piece in pieces]),
        share=np.concatenate(pieces),
        instant=np.cumsum(sizes) - 1,
    )


def places(count: int, power: int) -> np.ndarray:
    """Divisions of [0, 1] that narrow towards both ends, unless the power is 1; those
    of `count` are among those of twice as many.
    """
    place = np.linspace(0.0, 1.0, count + 1)
    if power == 1:
        return place
    return place**power / (place**power + place[::-1] ** power)


def _is_abrupt(before: np.ndarray, rate: np.ndarray) -> bool:
    larger = np.maximum(np.abs(rate), np.abs(before))
    return bool((np.abs(rate - before) > _ABRUPT * larger).any())


def cut(
    line: Timeline,
    time: np.ndarray,
    position: Array,
    value: Array,
    shortest: float,
    finer: int,
) -> tuple[Steps, np.ndarray]:
    """The steps, each divided into `finer` equal ones, and the index of the last step
    before each instant. In the first step the body is put down at once.
    """
    duration = np.diff(time)
    times = duration[duration > 0]
    jump = _INSTANT * min(shortest, float(times.min()) if times.size else shortest)
    interval = np.repeat(line.interval, finer)
    within = (np.tile(np.arange(finer) + 1, line.share.size) / finer - 1) * np.repeat(
        line.share, finer
    )
    share = np.clip(np.repeat(line.fraction, finer) + within, 0.0, 1.0)
    last = finer * (line.instant + 1) - 1
    share[last] = 1.0
    length = np.where(duration > 0, duration, jump)
    h = np.repeat(line.share / finer, finer) * length[interval]

    def along(values: Array) -> Any:
        left = values[:-1][interval]
        ends = left + share * (values[1:][interval] - left)
        return xp.concatenate([values[:1], ends])

    steps = Steps(np.append(jump, h), along(position), along(value))
    return steps, np.append(0, last + 1)


def even_steps(
    time: np.ndarray,
    position: Array,
    value: Array,
    shortest: float,
    early: int,
    samples: int,
) -> tuple[Steps, np.ndarray]:
    """As `cut`, with `samples` equal steps between two instants.

    A load that is put on at once is answered on all time scales of the rubber: the
    first interval is divided by `early` further instants in geometric series, from the
    `shortest` time on.
    """
    first = time[1] - time[0]
    ratio = xp.minimum(shortest / first, 0.5) ** (1 / max(early, 1))
    ratio = stop_gradient(ratio)
    more = time[0] + first * ratio ** np.arange(early, 0, -1)
    instants = xp.concatenate([time[:1], more, time[1:]])
    duration = xp.diff(instants)
    fractions = np.arange(1, samples + 1) / samples
    ends = (instants[:-1, None] + duration[:, None] * fractions).reshape(-1)
    begin = xp.reshape(_INSTANT * shortest, 1)
    steps = Steps(
        xp.concatenate([begin, xp.repeat(duration / samples, samples)]),
        xp.concatenate([position[:1], xp.interp(ends, time, position)]),
        xp.concatenate([value[:1], xp.interp(ends, time, value)]),
    )
    kept = samples * (early + np.arange(1, time.size))
    return steps, np.append(0, kept)
