"""The history of a sliding body as it was given: its arguments checked, and what is
known of its time scales.
"""

from typing import Any, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import (
    alike,
    as_float64,
    finite,
    in_kelvin,
    is_traced,
    not_negative,
    only_one,
)
from ..element.law import Foundation
from ..errors import InputError
from ..material.relaxation import Relaxation, scaled
from ..material.shift import thermal_factors
from ..material.validity import Range
from ..results.words import brief
from ..smooth.passage import Control
from ..surface.rough_line import RoughLine

_TRACED = 1024  # elements and steps of the coarser level under a transformation

LINE = (
    "bare MDR line under a rough line (forces and friction; no real contact area; no "
    "direction average)"
)


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
    traced: bool
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
    foundation: Foundation,
    time: Any,
    position: Any,
    load: Any,
    depth: Any,
    temperature: Any,
    rtol: Any,
    elements: Any,
    per_length: bool,
) -> GivenHistory:
    """The history that `em.slide` and `em.drive` were asked for. Raises `InputError`
    for one that they cannot take.
    """
    if is_traced(time):
        raise InputError(
            "time must be plain numbers under jax.jit, grad and vmap: "
            "differentiate in position instead."
        )
    time, position = as_float64("time", time), as_float64("position", position)
    alike(2, time=time, position=position)
    finite("time", time)
    finite("position", position)
    if (np.diff(time) < 0).any():
        i = int(np.argmin(np.diff(time)))
        raise InputError(
            f"time must not fall, got {time[i]:g} followed by {time[i + 1]:g} s "
            f"(entries {i} and {i + 1})."
        )
    still = np.diff(time) == 0
    if not is_traced(position) and (np.diff(position)[still] != 0).any():
        raise InputError(
            "position must not jump: it differs where two instants of time are equal."
        )
    control: Control = "load" if only_one(load=load, depth=depth) == "load" else "depth"
    value = as_float64(control, load if depth is None else depth)
    if value.shape not in ((), time.shape):
        raise InputError(
            f"{control} must be one number, or one for each of {time.size} "
            f"instants, got {value.shape}."
        )
    if control == "load":
        not_negative("load", value)
    else:
        finite("depth", value)
    if (
        isinstance(rtol, bool)
        or not isinstance(rtol, (int, float))
        or not 1e-6 <= rtol <= 1e-1
    ):
        raise InputError(f"rtol must be a number from 1e-6 to 1e-1, got {rtol!r}.")
    if elements is not None and (not isinstance(elements, int) or elements < 16):
        raise InputError(
            f"elements must be a whole number, 16 at least, got {elements!r}."
        )
    law = foundation.law()
    kelvin, factor = None, 1.0
    inputs = [("time", brief(time, "s")), ("position", brief(position, "m"))]
    inputs.append(
        (
            control,
            brief(value, ("N/m" if per_length else "N") if control == "load" else "m"),
        )
    )
    if temperature is not None:
        kelvin = as_float64("temperature", temperature)
        in_kelvin("temperature", kelvin)
        factor, vertical = thermal_factors(foundation, kelvin)
        law = scaled(law, vertical)
        law = Relaxation(
            law.equilibrium, law.moduli, law.times * factor, law.viscosity * factor
        )
        inputs.append(("temperature", brief(kelvin, "K")))
    inputs.append(("relative tolerance", f"{rtol:g}"))
    traced = is_traced(law, position, value)
    value = (xp if traced else np).broadcast_to(value, time.shape)
    if control == "depth" and not traced and float(law.viscosity) > 0:
        jumps = np.diff(np.concatenate([np.zeros(1), value]))[
            np.concatenate([np.ones(1, bool), still])
        ]
        if (
            np.maximum(value[np.concatenate([np.ones(1, bool), still])], 0)
            * (jumps > 0)
            > 0
        ).any():
            raise InputError(
                "depth must not jump on a material with a viscosity, whose force "
                "would be infinite."
            )
    return GivenHistory(
        law,
        control,
        time,
        position,
        value,
        float(rtol),
        elements or _TRACED,
        traced,
        tuple(inputs),
        foundation.range,
        kelvin,
        factor,
    )


def describe_line(line: RoughLine) -> str:
    """A rough line in words."""
    text = f"{line.label}, {line.count} points, period {float(line.period):.4g} m"
    return (
        text
        if is_traced(line)
        else f"{text}, rms height {float(line.rms_height):.4g} m"
    )
