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
from ..cli.units import Length, Pressure, Temperature
from ..errors import InputError
from ..results.axes import place_in_words
from ..results.doubts import Kind, where
from ..results.words import in_words
from .scene import Done
from .stage import Slider, length
from .words import with_signs

_WAVES = {"longest": (1e-4, 0.1), "shortest": (1e-7, 2e-3)}  # [m]
_PRESSURES = (0.01e6, 10e6)  # [Pa]
_TEMPERATURES = (233.15, 393.15)  # [K]
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
            self._waves = {
                key: Slider(
                    f"{key.capitalize()} wavelength of the road",
                    limits,
                    lambda metres: with_signs(length(metres)),
                    lambda metres, key=key: moved(f"[surface] {key}", length(metres)),
                )
                for key, limits in _WAVES.items()
            }
            self._pressure = Slider(
                "Nominal pressure",
                _PRESSURES,
                _pressure,
                lambda pascal: moved("[contact] pressure", _pressure(pascal)),
            )
            self._temperature = Slider(
                "Rubber temperature",
                _TEMPERATURES,
                lambda temperature: with_signs(_celsius(temperature)),
                lambda temperature: moved("temperature", _celsius(temperature)),
                logarithmic=False,
            )
            self._velocity = Slider(
                "Read at velocity", _VELOCITIES, _velocity, self._read
            )
        self._values = ui.label().classes("about")
        self.look()

    def look(self) -> None:
        """Shows the values of the scene, of several the first."""
        surface = self._content.get("surface", {})
        contact = self._content.get("contact", {})
        for key, slider in self._waves.items():
            cut = surface.get("shape") in ("self_affine", "spectrum")
            _place(slider, Length, surface.get(key) if cut else None)
        _place(self._pressure, Pressure, contact.get("pressure"))
        _place(self._temperature, Temperature, self._content.get("temperature"))

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


def _place(slider: Slider, quantity: Any, value: Any) -> None:
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
