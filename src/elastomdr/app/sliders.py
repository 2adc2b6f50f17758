"""Sliders of the friction screen: cutoffs, pressure and temperature move the curves, and
the velocity is where these are read.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np
from nicegui import ui

import elastomdr as em

from ..checks import significant
from ..cli.schema import Content
from ..cli.units import Length, Pressure, SceneQuantity, Temperature
from ..errors import InputError
from ..results.axes import place_in_words
from ..results.doubts import Kind, where
from ..results.words import in_words
from .scene import Done
from .stage import Slider, length
from .words import path_of, with_signs

_VELOCITIES = (1e-7, 100.0)  # [m/s]
# doubts that are said of a reading; what has no bound is said in place of one
_SAID: tuple[Kind, ...] = ("extrapolated", "hot branch", "bound", "estimate")


class Sliders:
    """The sliders of a scene of friction.

    `moved` is called with the field and the text that stands for its new value, such as
    "[contact] pressure" and "0.3 MPa".
    """

    def __init__(self, content: Content, moved: Callable[[str, str], Any]):
        self._content = content
        self._done: Done | None = None
        with ui.element("div").classes("sliders"):
            self._of = {
                field: Slider(
                    label,
                    limits,
                    lambda value, typed=typed: with_signs(typed(value)),
                    lambda value, name=field, typed=typed: moved(name, typed(value)),
                    logarithmic=quantity is not Temperature,
                )
                for field, (label, limits, quantity, typed) in _MOVED.items()
            }
            self._velocity = Slider(
                "Read at velocity", _VELOCITIES, _velocity, self._read
            )
        self._values = ui.label().classes("about")
        self.look()

    def look(self) -> None:
        """Shows the values of the scene, of several the first; of waves only where a
        surface is cut at them.
        """
        for field, slider in self._of.items():
            *tables, key = path_of(field)
            place = self._content
            for table in tables:
                place = place.get(table, {})
            cut = place.get("shape", "spectrum") in ("self_affine", "spectrum")
            _place(slider, _MOVED[field][2], place.get(key) if cut else None)

    def read(self, computation: Done | None) -> None:
        """Reads the curves of a result where the velocity's slider is."""
        first = self._done is None
        self._done = computation
        self._values.visible = computation is not None
        if computation is None:
            return
        velocity = np.unique(np.asarray(computation.shown.velocity))
        low, high = float(velocity[0]), float(velocity[-1])
        middle = float(np.sqrt(low * high))
        inside = float(np.clip(self._velocity.value, low, high))
        read_at = middle if first else inside
        if low < high:
            self._velocity.set(read_at, (low, high))
        self._velocity.show(low < high)
        self._read(read_at)

    def _read(self, velocity: float) -> None:
        if self._done is None:
            return
        readings = "; ".join(_readings(self._done.shown, velocity))
        self._values.text = with_signs(f"At {_velocity(velocity)}: {readings}")


def _readings(result: em.FrictionCurve, velocity: float) -> Iterator[str]:
    """Friction of each curve at a velocity, of each point where that is the only one."""
    axis, curves = result.curves()
    bound = np.nan if result.model_error is None else result.model_error
    found: Content = {kind: where(result.doubts, kind) for kind in _SAID}
    marks = {kind: points for kind, points in found.items() if points is not None}
    fields = np.broadcast_arrays(
        result.velocity, result.mu, result.error + bound, *marks.values()
    )
    for curve in curves:
        x, *rows = (np.atleast_1d(each[curve.place]) for each in fields)
        if np.ptp(x) > 0:
            values = [float(np.interp(np.log(velocity), np.log(x), y)) for y in rows]
            yield _reading(curve.label, values, marks)
            continue
        for i in range(x.size):
            place = place_in_words(axis, i) if x.size > 1 else ""
            name = ", ".join(filter(None, (curve.label, place)))
            yield _reading(name, [float(y[i]) for y in rows], marks)


def _reading(name: str, values: Sequence[float], marks: Iterable[str]) -> str:
    """Friction, its uncertainty, and how far each kind of doubt holds there."""
    mu, half, *shares = values
    name = f"{name}: " if name else ""
    if np.isnan(mu):
        return f"{name}did not converge"
    known = np.isfinite(half)
    spread = f"± {significant(half, 2)}" if known else "without a bound of the model"
    doubted = (f", {kind}" for kind, share in zip(marks, shares, strict=True) if share)
    return f"{name}µ = {significant(mu, 3)} {spread}{''.join(doubted)}"


def _place(slider: Slider, quantity: type[SceneQuantity], value: Any) -> None:
    """Puts a slider where a value is, and hides it where there is none to read."""
    try:
        slider.set(float(quantity.read(value[0] if isinstance(value, list) else value)))
    except InputError:
        slider.show(False)  # the field says what is wrong
    else:
        slider.show(True)


def _pressure(pascal: float) -> str:
    return f"{pascal / 1e6:.3g} MPa"


def _celsius(temperature: float) -> str:
    return f"{round(temperature - 273.15, 1) + 0.0:g} degC"


def _velocity(velocity: float) -> str:
    return in_words("velocity", float(significant(velocity, 3)))


# by field: what is moved, between which values, what it measures, how it is typed
_MOVED = {
    "[surface] longest": (
        "Longest wavelength of the road",
        (1e-4, 0.1),
        Length,
        length,
    ),
    "[surface] shortest": (
        "Shortest wavelength of the road",
        (1e-7, 2e-3),
        Length,
        length,
    ),
    "[contact] pressure": ("Nominal pressure", (0.01e6, 10e6), Pressure, _pressure),
    "temperature": ("Rubber temperature", (233.15, 393.15), Temperature, _celsius),
}
