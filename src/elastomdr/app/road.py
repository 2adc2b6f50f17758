"""A road from a spectrum, a topography or self-affine numbers: rms height and slope,
and cutoffs that move.
"""

import json
import math
from typing import Annotated, Any

import msgspec
from nicegui import background_tasks, ui

import elastomdr as em

from ..cli import bodies as kinds
from ..cli.schema import Table, decode
from ..errors import InputError
from ..results.plot_contacts import draw_cutoffs
from .chart import drawn
from .form import Form
from .security import Folder
from .session import DRAWING, Session
from .stage import SAMPLE, Notes, Picture, Words, drop, worked
from .words import path_of, title

_NAMES = ("[surface] longest", "[surface] shortest")
_FIRST = (
    *_NAMES,
    "[surface] rms_slope",
    "[surface] rms_height",
    "[surface] file",
    "[surface] convention",
)
_WIDEST = (1e-7, 1.0)  # wavelengths of a self-affine surface that a slider reaches [m]


class Road(Table):
    """The rough surface of a scene."""

    surface: Annotated[kinds.AnySurface, "the rough surface"]


class RoadStage:
    """The screen."""

    def __init__(self, session: Session):
        self._session = session
        self._content = session.scenes["friction"]
        self._wanted = self._drawn = 0
        with ui.element("div").classes("stage"):
            with ui.element("div").classes("left"):
                ui.label(
                    "Drop a power spectrum or a measured topography, or give "
                    "self-affine numbers."
                ).classes("lead")
                drop(
                    session,
                    "Spectrum or topography",
                    self._dropped,
                    ("Use sample road", self._sample),
                )
                self.form = Form(
                    Road,
                    self._content,
                    first=_FIRST,
                    choices={"[surface] file": self._files},
                    changed=self._typed,
                    entered=self.redraw,
                )
            with ui.element("div").classes("right"):
                self._picture = Picture(
                    "Spectrum of the road, and its rms slope down to each wavelength",
                    "road",
                )
                self._sliders = {name: self._slider(name) for name in _NAMES}
                self._notes, self._words = Notes(), Words()
        ui.timer(0.05, self.redraw, once=True)

    def _slider(self, name: str) -> ui.slider:
        label = title(path_of(name))
        above = ui.label(label).classes("slider-label")
        slider = ui.slider(min=-7.0, max=0.0, step=0.01, value=-3.0).props(
            f'aria-label="{label}"'
        )
        above.bind_visibility_from(slider)

        def moved(event: Any) -> None:
            self.form.set(name, _length(10 ** float(event.args)))

        return slider.on(
            "update:model-value", moved, throttle=0.05, leading_events=False
        )

    def _files(self) -> list[str]:
        return [
            name for name in self._session.folder.names() if not name.endswith(".toml")
        ]

    async def _sample(self) -> None:
        name = self._session.folder.keep(
            "road.csv", SAMPLE.joinpath("road.csv").read_bytes()
        )
        await self._take(
            {
                "shape": "spectrum",
                "file": name,
                "convention": "2d",
                "longest": "5 mm",
                "shortest": "50 um",
            }
        )

    async def _dropped(self, names: list[str]) -> None:
        await self._take(
            await worked(DRAWING, recognised, self._session.folder, names[0])
        )

    async def _take(self, surface: dict[str, Any]) -> None:
        self._content["surface"] = surface
        self.form.draw()
        await self.redraw()

    def _typed(self, name: str) -> None:
        background_tasks.create(self.redraw(), name="redraw road")

    async def redraw(self) -> None:
        """Draws the road as it is filled in; of several changes at once the last
        one.
        """
        self._session.touch()
        self._wanted += 1
        if self._wanted > self._drawn + 1:
            return
        while self._drawn < self._wanted:
            now = self._wanted
            try:
                seen = await worked(
                    DRAWING,
                    look,
                    json.loads(json.dumps(self._content["surface"])),
                    self._session,
                )
                self.form.clear_errors()
                self._show(seen)
            except InputError as error:
                self._clear()
                self.form.show_error(str(error))
            finally:
                self._drawn = now

    def _clear(self) -> None:
        """Takes away what there was to see of another surface."""
        self._picture.show(None)
        self._words.show("")
        self._notes.show(())

    def _show(self, seen: dict[str, Any]) -> None:
        self._picture.show(seen["drawn"])
        self._words.show(seen["words"])
        self._notes.show(seen["report"])
        for name, slider in self._sliders.items():
            slider.visible = name in self.form.widgets
            limits = [math.log10(wave) for wave in seen["limits"]]
            slider.props["min"], slider.props["max"] = limits
            slider.value = math.log10(seen["cutoffs"][name == _NAMES[1]])


def look(content: dict[str, Any], session: Session) -> dict[str, Any]:
    """What there is to see of a surface: its figure, its numbers, what its reader
    reports. Raises `InputError`.
    """
    session.folder.check([content["file"]] if "file" in content else [])
    asked = decode(Road, {"surface": content}).surface
    try:
        road = asked.make(session.folder.path)
        whole = _whole(asked, session.folder)
    except InputError as error:
        raise InputError(f"[surface] {error}") from error
    waves = [2 * math.pi / float(q) for q in (road.q_low, road.q_high)]
    limits = (
        [2 * math.pi / float(q) for q in (whole.q_high, whole.q_low)]
        if whole is not None
        else list(_WIDEST)
    )
    words = (
        f"rms height   {1e6 * float(road.rms_height):.4g} um\n"
        f"rms slope    {float(road.rms_slope):.4g}, of a straight cut "
        f"{float(road.rms_slope) / math.sqrt(2):.4g}\n"
        f"wavelengths  {_length(waves[0])} to {_length(waves[1])}"
    )
    return {
        "drawn": drawn(draw_cutoffs(road, whole)),
        "words": words,
        "report": list(getattr(road, "report", ())),
        "cutoffs": waves,
        "limits": limits,
    }


def _whole(asked: Any, folder: Folder) -> Any:
    """The table that a spectrum is cut from; None where there is none."""
    if not isinstance(asked, kinds.Spectrum) or asked.file is None:
        return None
    return msgspec.structs.replace(asked, longest=None, shortest=None).make(folder.path)


def recognised(folder: Folder, name: str) -> dict[str, Any]:
    """What a dropped file is, as far as its reader can tell: a spectrum, else a
    topography.
    """
    path = folder.path / name
    try:
        em.read_spectrum(path, convention="2d")
        return {"shape": "spectrum", "file": name}
    except InputError:
        pass
    try:
        em.read_surface(path)
        return {"shape": "file", "file": name}
    except InputError as error:
        heights = "pixel_size" in str(error) or "unit" in str(error)
        return {"shape": "file" if heights else "spectrum", "file": name}


def _length(metres: float) -> str:
    """A length as it is typed."""
    unit, size = next(
        (
            (u, s)
            for u, s in (("m", 1.0), ("mm", 1e-3), ("um", 1e-6))
            if metres >= 0.9995 * s
        ),
        ("nm", 1e-9),
    )
    return f"{metres / size:.3g} {unit}"
