"""A road from a spectrum, a topography or self-affine numbers: rms height and slope,
and cutoffs that move.
"""

import copy
import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

import msgspec
import numpy as np
from nicegui import background_tasks, ui

import elastomdr as em

from ..cli import bodies as kinds
from ..cli.schema import Content, Table, decode, named
from ..errors import InputError
from ..results.plot_contacts import SPECTRUM, WAVE_NUMBER, roughness_in_words
from ..results.plotting import PALETTE, DrawAsk, Entry, Panels, Sketch, Trace, figure_of
from ..surface.spectrum import AbstractSpectrum
from .chart import Drawn, drawn
from .form import TableForm
from .scene import CancelledError
from .security import Folder
from .session import DRAWING, Session
from .stage import (
    BUTTON,
    Busy,
    Latest,
    Notes,
    Picture,
    Slider,
    Words,
    drop,
    length,
    sample,
)
from .words import path_of, title, with_signs

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = ("[surface] longest", "[surface] shortest")
_FIRST = (
    *_NAMES,
    "[surface] rms_slope",
    "[surface] rms_height",
    "[surface] file",
    "[surface] convention",
)
_USUAL = (100e-6, 10e-6, 3e-6)  # shortest waves that are offered [m]
_ROUNDED = 1.01  # a length is typed with three digits
_WIDEST = (1e-7, 1.0)  # wavelengths of a self-affine surface that a slider reaches [m]

# longest and shortest wave as they are typed, and the rms slope between them
Offer: TypeAlias = tuple[str, str, float]


class Road(Table):
    """The rough surface of a scene.

    Keys:
        surface: the rough surface
    """

    surface: kinds.AnySurface


@dataclass(frozen=True)
class Seen:
    """What there is to see of a surface."""

    drawn: Drawn
    words: str  # its numbers
    report: tuple[str, ...]  # of its reader
    cutoffs: tuple[float, float]  # longest and shortest wave [m]
    limits: tuple[float, float]  # of these
    offers: tuple[Offer, ...]


class RoadStage:
    """The screen."""

    def __init__(self, session: Session):
        self._session = session
        self._content = session.scenes["friction"]
        self._latest = Latest(self._redrawn)
        self._seen: Content = copy.deepcopy(self._content["surface"])
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
                self._reading, self._busy = Busy(), Busy()
                self.form = TableForm(
                    Road,
                    self._content,
                    first=_FIRST,
                    choices={"[surface] file": session.folder.measurements},
                    changed=self._typed,
                    entered=self.redraw,
                )
            with ui.element("div").classes("right"):
                self._picture = Picture(
                    "Spectrum of the road, and its rms slope down to each wavelength",
                    "road",
                )
                self._offers = ui.element("div").classes("offers")
                self._sliders = {name: self._slider(name) for name in _NAMES}
                self._notes, self._words = Notes(), Words()
        ui.timer(0.05, self.redraw, once=True)

    def _slider(self, name: str) -> Slider:
        return Slider(
            title(path_of(name)),
            _WIDEST,
            lambda metres: with_signs(length(metres)),
            lambda metres: self.form.set(name, length(metres)),
        )

    async def _sample(self) -> None:
        name = sample(self._session, "road.csv")
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
        self._reading.stop()  # another file, which is not wanted any more
        try:
            surface = await self._reading.during(
                DRAWING, recognised, self._session.folder, names[0], kind="read"
            )
        except CancelledError:
            return
        await self._take(surface)

    async def _take(self, surface: Content) -> None:
        self._content["surface"] = surface
        await self.refresh()

    def _typed(self, name: str) -> None:
        background_tasks.create(self.redraw(), name="redraw road")

    async def refresh(self) -> None:
        """Shows what others have changed."""
        self.form.draw()
        await self.redraw()

    async def look_again(self) -> None:
        """Shows the surface if the sliders of another screen have changed it."""
        if self._seen != self._content["surface"]:
            await self.refresh()

    async def redraw(self) -> None:
        """Draws the road as it is filled in; of several changes at once the last
        one.
        """
        self._session.touch()
        await self._latest()

    async def _redrawn(self) -> None:
        try:
            surface = copy.deepcopy(self._content["surface"])
            seen = await self._busy.during(
                DRAWING, look, surface, self._session, kind="road"
            )
            self.form.clear_errors()
            self._seen = surface
            self._show(seen)
        except InputError as error:
            self._clear()
            self.form.show_error(error)
        except CancelledError:
            self._clear()

    def _clear(self) -> None:
        """Takes away what there was to see of another surface."""
        self._picture.show(None)
        self._offer([])
        self._words.show("")
        self._notes.show(())
        for slider in self._sliders.values():
            slider.show(False)

    def _offer(self, offers: Sequence[Offer]) -> None:
        """Asks for the cutoffs of a road that has none."""
        self._offers.clear()
        if not offers:
            return
        with self._offers:
            ui.label("Which waves does the rubber feel?").classes("lead")
            ui.label(
                "Waves longer than some 5 mm hardly add to friction. The shortest wave "
                "is set by dirt, wear or water, usually at some micrometres. Each "
                "decade "
                "of shorter waves adds friction, and needs the moduli at ten times "
                "higher "
                "frequencies."
            ).classes("about")
            for longest, shortest, slope in offers:
                ui.button(
                    with_signs(f"{longest} to {shortest} (rms slope {slope:.2g})"),
                    on_click=partial(self._cut, longest, shortest),
                ).props(f"{BUTTON} outline")

    def _cut(self, longest: str, shortest: str) -> None:
        for name, wavelength in zip(_NAMES, (longest, shortest), strict=True):
            if name in self.form.widgets:  # a topography has no longest wave to choose
                self.form.set(name, wavelength)

    def _show(self, seen: Seen) -> None:
        self._picture.show(seen.drawn)
        self._offer(seen.offers)
        self._words.show(with_signs(seen.words))
        self._notes.show(seen.report)
        for name, slider in self._sliders.items():
            slider.show(name in self.form.widgets)
            slider.set(seen.cutoffs[name == _NAMES[1]], seen.limits)


def look(content: Content, session: Session) -> Seen:
    """What there is to see of a surface: its figure, its numbers, what its reader
    reports. Raises `InputError`.
    """
    session.folder.check([content["file"]] if "file" in content else [])
    asked = decode(Road, {"surface": content}).surface
    with named("[surface]"):
        road = asked.make(session.folder.path)
        uncut = isinstance(asked, kinds.Measured) and asked.shortest is None
        whole = road if uncut else _whole(asked, session.folder)
    longest, shortest = (2 * math.pi / float(q) for q in (road.q_low, road.q_high))
    widest, least = (_WIDEST[1], _WIDEST[0]) if whole is None else _measured(whole)
    words = (
        f"rms height   {1e6 * float(road.rms_height):.4g} um\n"
        f"rms slope    {float(road.rms_slope):.4g}, of a straight cut "
        f"{float(road.rms_slope) / math.sqrt(2):.4g}\n"
        f"wavelengths  {length(longest)} to {length(shortest)}"
    )
    return Seen(
        drawn(draw_cutoffs(road, whole)),
        words,
        tuple(getattr(road, "report", ())),
        (longest, shortest),
        (least, widest),
        tuple(_offers(asked, whole)),
    )


def draw_cutoffs(spectrum: AbstractSpectrum, whole: AbstractSpectrum | None) -> "Axes":
    """A spectrum between its cutoffs and the rms slope of the surface down to each
    wavelength, before the `whole` that it is cut from.
    """
    heading = roughness_in_words(float(spectrum.rms_height), float(spectrum.rms_slope))
    entry = Entry(heading, heading, (WAVE_NUMBER, SPECTRUM))
    sketch = Sketch(DrawAsk(), entry, Panels(1, 2))
    left, right = sketch.canvas.panels
    figure_of(left).set_size_inches(9.6, 3.8)
    left.set(xscale="log", yscale="log")
    right.set(
        xscale="log",
        xlabel="Shortest wavelength kept [mm]",
        ylabel="rms slope of the surface [-]",
    )
    for each, colour, width in ((whole, "#b8bec6", 0.7), (spectrum, PALETTE[0], 1.0)):
        if each is not None:
            q = np.geomspace(float(each.q_low), float(each.q_high), 200)
            moment = np.asarray(each.moment(3, each.q_low, q))
            slope = np.sqrt(2 * np.pi * np.maximum(moment, 0.0))
            sketch.add(Trace(q, each.at(q), colour=colour, width=width))
            sketch.add(
                Trace(2e3 * np.pi / q, slope, ax=right, colour=colour, width=width)
            )
    right.set_ylim(0.0, None)
    right.invert_xaxis()
    return sketch.finish()


def _offers(asked: kinds.AnySurface, whole: AbstractSpectrum | None) -> list[Offer]:
    """Cutoffs to choose from, with the rms slope between them, for a spectrum or a
    topography that is given without any.
    """
    of_heights = isinstance(asked, kinds.Measured)  # whose longest wave is the scan's
    longest_asked = None if of_heights else asked.longest
    if whole is None or longest_asked is not None or asked.shortest is not None:
        return []
    measured = _measured(whole)
    longest = measured[0] * _ROUNDED if of_heights else min(measured[0], 5e-3)
    by_shortest = {}
    for wave in (*_USUAL, measured[1]):
        shortest = max(wave, measured[1])
        if shortest < 0.5 * longest:
            slope = (
                2
                * math.pi
                * float(whole.moment(3, 2 * math.pi / longest, 2 * math.pi / shortest))
            )
            by_shortest[length(shortest)] = length(longest), math.sqrt(max(slope, 0.0))
    return [(first, last, slope) for last, (first, slope) in by_shortest.items()]


def _measured(whole: AbstractSpectrum) -> tuple[float, float]:
    """The longest and the shortest wave of a table, but for what rounding may add [m]."""
    longest, shortest = (2 * math.pi / float(q) for q in (whole.q_low, whole.q_high))
    return longest / _ROUNDED, shortest * _ROUNDED


def _whole(asked: kinds.AnySurface, folder: Folder) -> AbstractSpectrum | None:
    """The table or the heights that a surface is cut from; None where there are
    none.
    """
    if isinstance(asked, kinds.Measured):
        return msgspec.structs.replace(asked, shortest=None).make(folder.path)
    if not isinstance(asked, kinds.SpectrumTable) or asked.file is None:
        return None
    return msgspec.structs.replace(asked, longest=None, shortest=None).make(folder.path)


def recognised(folder: Folder, name: str) -> Content:
    """What a dropped file is, as far as its reader can tell: a spectrum, else a
    topography.
    """
    try:
        em.read_spectrum(folder.path / name, convention="2d")
    except InputError:
        return {"shape": "file", "file": name}
    return {"shape": "spectrum", "file": name}
