"""Isotherms of a master curve, shifted by hand: shift factors, overlap and law follow."""

import dataclasses
from collections.abc import Awaitable, Callable
from typing import Any

import numpy as np
from nicegui import background_tasks, ui

from ..checks import significant
from ..fit.figures import draw_shifts
from ..fit.laws import fit_laws
from ..fit.master import MasterCurve
from .chart import Drawn, drawn
from .session import DRAWING
from .stage import BUTTON, Latest, Slider, worked
from .words import spoken

_REACH = 1.5  # how far an isotherm may be shifted from the fit [decades]


class ShiftEditor:
    """A slider for one isotherm at a time, which can be dragged in the figure as well.

    `show` is called with the figures of master curve and shift factors, None for those
    of the fit; `use` with the table of shift factors, to fit with them.
    """

    def __init__(
        self,
        show: Callable[[dict[str, Drawn] | None], None],
        use: Callable[[bytes], Awaitable[None]],
    ):
        self._show, self._use = show, use
        self._master: Any = None
        self._offsets = np.zeros(0)  # from the fit [decades]
        # offset of an isotherm that is being dragged
        self._grabbed: float | None = None
        self._numbers: dict[str, int] = {}  # of isotherms, by what they are called
        self._restarts = 0  # how often all went back to a fit
        self._redraw = Latest(self._drawn)
        ui.on("isotherm", self._dragged)
        title = "Shift isotherms: drag one in the figure, or here"
        with ui.expansion(title).classes("more") as self._fold:
            self._isotherm = ui.select({}, label="Isotherm").classes("field")
            self._isotherm.on_value_change(self._chosen)
            self._slider = Slider(
                "Shift factor log₁₀ a_T",
                (-_REACH, _REACH),
                lambda decades: f"{decades:.3f}",
                self._moved,
                logarithmic=False,
            )
            self._said = ui.label().classes("words")
            with ui.element("div").classes("buttons"):
                ui.button("Back to the fit", on_click=self._back).props(
                    f"{BUTTON} outline"
                )
                ui.button("Fit with these factors", on_click=self._taken).props(BUTTON)
        self._fold.visible = False

    def edit(
        self, master: MasterCurve | None, offsets: np.ndarray | None = None
    ) -> None:
        """Takes the master curve of a fit and the shifts by hand [decades], which it
        changes in place; None, or a single isotherm, hides it.
        """
        if master is not None and master.temperature.size < 2:
            master = None
        self._fold.visible = master is not None
        self._master = master
        self._restarts += 1
        if master is None:
            return
        self._offsets = (
            np.zeros(master.temperature.size) if offsets is None else offsets
        )
        names = {
            i: _celsius(temperature) for i, temperature in enumerate(master.temperature)
        }
        by_hand = bool(self._offsets.any())
        far = self._offsets if by_hand else master.temperature - master.reference
        farthest = int(np.abs(far).argmax())
        self._numbers = {name: i for i, name in names.items()}
        self._isotherm.set_options(names, value=farthest)
        self._chosen()
        if by_hand:
            background_tasks.create(self._redraw(), name="show shifts by hand")

    def _chosen(self) -> None:
        i = self._isotherm.value
        if self._master is None or i is None:
            return
        fitted = float(self._master.log10_a[i])
        limits = fitted - _REACH, fitted + _REACH
        self._slider.set(fitted + float(self._offsets[i]), limits)
        self._said.text = _in_words(_edited(self._master, self._offsets), i)

    def _moved(self, decades: float) -> None:
        i = self._isotherm.value
        self._offsets[i] = decades - float(self._master.log10_a[i])
        background_tasks.create(self._redraw(), name="shift an isotherm")

    def _dragged(self, event: Any) -> None:
        """Follows an isotherm in the figure, which moves by itself until it is let go."""
        i = self._numbers.get(event.args["name"])
        if self._master is None or i is None:
            return
        if self._grabbed is None:
            self._grabbed = float(self._offsets[i])
            self._isotherm.value = i
            self._fold.open()
        # over time, longer times are a smaller shift factor
        sign = 1.0 if self._master.omega.size else -1.0
        offset = self._grabbed + sign * float(event.args["decades"])
        fitted = float(self._master.log10_a[i])
        decades = fitted + float(np.clip(offset, -_REACH, _REACH))
        if event.args["end"]:
            self._grabbed = None
        self._slider.set(decades)
        self._moved(decades)

    async def _drawn(self) -> None:
        if self._master is None:
            return
        offsets, i, restarts = (
            self._offsets.copy(),
            self._isotherm.value,
            self._restarts,
        )
        figures, words = await worked(DRAWING, _figures, self._master, offsets, i)
        if restarts != self._restarts:
            return
        if self._grabbed is not None:
            figures.pop("master")
        self._show(figures)
        self._said.text = words

    def _back(self) -> None:
        self._restarts += 1
        self._offsets[:] = 0.0
        self._chosen()
        self._show(None)

    async def _taken(self) -> None:
        factors = self._master.log10_a + self._offsets
        rows = zip(self._master.temperature - 273.15, factors, strict=True)
        table = "".join(f"{celsius:.6g},{factor:.6g}\n" for celsius, factor in rows)
        await self._use(f"T [degC],log10 a_T\n{table}".encode())


def _figures(
    master: MasterCurve, offsets: np.ndarray, i: int
) -> tuple[dict[str, Drawn], str]:
    """Master curve and shift factors with these offsets, and what there is to say."""
    edited = _edited(master, offsets)
    shown = {
        "master": drawn(edited.plot()),
        "shifts": drawn(draw_shifts(edited)),
    }
    return shown, _in_words(edited, i)


def _edited(master: MasterCurve, offsets: np.ndarray) -> Any:
    """The master curve with isotherms moved from the fit [decades]; the smooth curve
    behind them stays that of the fit.
    """
    factors = master.log10_a + offsets
    return dataclasses.replace(
        master,
        log10_a=factors,
        omega=master.omega * 10.0 ** offsets[master.isotherm],
        time=master.time / 10.0 ** offsets[master.time_isotherm],
        laws=fit_laws(master.temperature, factors, master.covariance, master.reference),
    )


def _in_words(master: MasterCurve, i: int) -> str:
    """Shift factor, overlap and law."""
    lines = [f"log10 a_T  {master.log10_a[i]:.3f} at {_celsius(master.temperature[i])}"]
    distance, count = overlap(master, i)
    lines.append(
        f"overlap    {count} points of E' within the neighbours, "
        f"{significant(100 * distance, 2)} % off them (rms)"
        if count
        else "overlap    none with the neighbours"
    )
    lines += [
        f"{name:<9}  {law.constants()}; {significant(law.rms, 2)} decades off (rms)"
        for name, law in master.laws.items()
        if name in ("WLF", "Arrhenius")
    ]
    return spoken("\n".join(lines))


def overlap(master: MasterCurve, i: int) -> tuple[float, int]:
    """How far an isotherm's storage moduli (or relaxation moduli) are from a line
    through those of its two neighbours, relative, rms, and how many points that are.
    """
    dynamic = bool(master.omega.size)
    x, y, number = (
        (master.omega, master.storage, master.isotherm)
        if dynamic
        else (master.time, master.relaxation, master.time_isotherm)
    )
    on_isotherm, beside = number == i, np.abs(number - i) == 1
    order = np.argsort(x[beside])
    across, up = np.log(x[beside][order]), np.log(y[beside][order])
    places = np.log(x[on_isotherm])
    inside = (places >= across[0]) & (places <= across[-1])
    if not inside.any():
        return 0.0, 0
    off = np.log(y[on_isotherm][inside]) - np.interp(places[inside], across, up)
    return float(np.sqrt(np.mean(off**2))), int(inside.sum())


def _celsius(temperature: float) -> str:
    return f"{round(float(temperature) - 273.15, 1) + 0.0:g} °C"
