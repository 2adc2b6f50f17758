"""What the screens share: samples, dropping files, figures, messages, work outside of the
event loop.
"""

import asyncio
import ctypes
import functools
import math
import threading
import time
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, TypeVar
from weakref import WeakSet

from nicegui import events, ui

import elastomdr as em

from ..errors import InputError
from .chart import Drawn
from .scene import CancelledError
from .security import MOST_BYTES
from .session import COMPUTING, DRAWING, Session
from .words import spoken

# where the wheel has them; a checkout has them among its examples
_OWN = Path(__file__).parent / "data"
DOCS = _OWN if _OWN.is_dir() else Path(__file__).parents[3] / "docs"
SAMPLE = _OWN if _OWN.is_dir() else Path(__file__).parents[3] / "examples" / "data"


T = TypeVar("T")
BUTTON = "no-caps unelevated"
# seconds before it is shown that something takes time, and before it is said how long
_PATIENCE, _LONG = 0.4, 2.0
_AGAIN = 0.5  # seconds until a stop that had no effect is repeated
# seconds that each kind of work took the last time, for the time left of the next
_TOOK: dict[str, float] = {}


async def worked(pool: Executor, call: Callable[..., T], *arguments: Any) -> T:
    """The result of a call that is made in a thread of its own."""
    _make_way(pool)
    return await asyncio.get_running_loop().run_in_executor(pool, call, *arguments)


def _make_way(pool: Executor) -> None:
    """Stops what gives way to all else that is to be computed."""
    for each in _GIVES_WAY if pool is COMPUTING else ():
        each.stop()


class _Work:
    """A call in another thread, which can be stopped as Ctrl-C stops a command."""

    def __init__(self) -> None:
        self._lock, self._thread, self._stopped = threading.Lock(), 0, False

    def __call__(self, call: Callable[..., T], *arguments: Any) -> T:
        try:
            with self._lock:
                if self._stopped:
                    raise CancelledError
                self._thread = threading.get_ident()
            return call(*arguments)
        finally:
            self._thread = 0  # from here on no stop begins
            with self._lock:  # one that has begun hits this, or is taken back
                _raise_in(threading.get_ident(), None)

    def stop(self) -> None:
        """Raises `CancelledError` in the thread, as soon as it is back in Python."""
        with self._lock:
            self._stopped = True
            if self._thread:
                _raise_in(self._thread, CancelledError)

    def stop_until(self, done: Callable[[], bool]) -> None:
        """Stops again and again, in the event loop, until it is done: Python drops an
        exception that falls into a `__del__` or the callback of a weak reference.
        """
        if not done():
            self.stop()
            loop = asyncio.get_running_loop()
            loop.call_later(_AGAIN, self.stop_until, done)


def _raise_in(thread: int, exception: type[BaseException] | None) -> None:
    """Raises an exception in a thread; None takes back one that it has not seen yet."""
    ctypes.pythonapi.PyThreadState_SetAsyncExc(
        ctypes.c_ulong(thread), exception and ctypes.py_object(exception)
    )


class Busy:
    """Shows that something is computed, since when and how long it may still take, and
    stops it; what `gives_way` is stopped by all else that is to be computed.
    """

    def __init__(self, *, gives_way: bool = False) -> None:
        self._gives_way = gives_way
        if gives_way:
            _GIVES_WAY.add(self)
        self._work: _Work | None = None
        self._stopping: asyncio.Future[None] | None = None
        self._began = self._share = self._took = 0.0
        with ui.element("div").classes("busy") as self._place:
            self._bar = ui.linear_progress(0.0, show_value=False)
            self._bar.props('aria-label="Progress"')
            self._text = ui.label().classes("about")
            ui.button("Stop", on_click=self.stop).props(f"{BUTTON} outline")
        self._place.visible = False
        self._timer = ui.timer(0.25, self._tick, active=False)

    @property
    def on(self) -> bool:
        """Whether something is being computed."""
        return self._work is not None

    def progress(self, finished: int, total: int) -> None:
        """Notes how much of it is done; may be called by any thread."""
        self._share = finished / max(total, 1)

    def stop(self) -> None:
        """Stops it; who waits for it gets a `CancelledError`."""
        if self._stopping is not None and not self._stopping.done():
            self._stopping.set_result(None)

    async def during(
        self,
        pool: Executor,
        call: Callable[..., T],
        *arguments: Any,
        kind: str = "",
        quiet: bool = False,
    ) -> T:
        """The result of a call that is made in a thread of its own; of the same `kind`
        are those that take about the same time; `quiet` shows nothing.
        """
        if not self._gives_way:
            _make_way(pool)
        loop = asyncio.get_running_loop()
        self._work, self._stopping = _Work(), loop.create_future()
        self._began, self._share = time.monotonic(), 0.0
        self._took = _TOOK.get(kind, 0.0)
        self._timer.active = not quiet
        try:
            result = loop.run_in_executor(pool, self._work, call, *arguments)
            await asyncio.wait(
                (result, self._stopping), return_when=asyncio.FIRST_COMPLETED
            )
            if self._stopping.done():
                result.add_done_callback(lambda stopped: stopped.exception())
                self._work.stop_until(result.done)
                raise CancelledError
            answer = await result
            if kind:
                _TOOK[kind] = time.monotonic() - self._began
            return answer
        finally:
            self._work = self._stopping = None
            self._place.visible = self._timer.active = False

    def _tick(self) -> None:
        """Says how long it takes, from what is done or from the time before."""
        spent = time.monotonic() - self._began
        self._place.visible = self.on and spent > _PATIENCE
        whole = spent / self._share if 0 < self._share < 1 else self._took
        known = whole > spent
        self._bar.props(
            "" if known else "indeterminate", remove="indeterminate" if known else ""
        )
        self._bar.value = spent / whole if known else 0.0
        left = f", about {whole - spent:.0f} s left" if known else ""
        self._text.text = f"{spent:.0f} s{left}" if spent > _LONG else ""


_GIVES_WAY: WeakSet[Busy] = WeakSet()


class Latest:
    """Does work for the last of the requests that come while it is being done."""

    def __init__(self, work: Callable[[], Awaitable[None]]):
        self._work = work
        self._wanted = self._done = 0

    async def __call__(self) -> None:
        """Asks for the work; returns at once where others are asking already."""
        self._wanted += 1
        if self._wanted > self._done + 1:
            return
        while self._done < self._wanted:
            now = self._wanted
            try:
                await self._work()
            finally:
                self._done = now


class Slider:
    """A quantity on a logarithmic or linear scale, with its value; `moved` is called
    with the value while it is moved.
    """

    def __init__(
        self,
        label: str,
        limits: tuple[float, float],
        as_text: Callable[[float], str],
        moved: Callable[[float], Any],
        *,
        logarithmic: bool = True,
    ):
        self._text, self._logarithmic = as_text, logarithmic
        with ui.element("div").classes("slider") as self._place:
            ui.label(label)
            self._value = ui.label().classes("value")
            low, high = (self._at(limit) for limit in limits)
            step = (high - low) / 200
            self._slider = ui.slider(min=low, max=high, step=step, value=low)
            self._slider.props(f'aria-label="{label}"')

        def changed(event: events.GenericEventArguments) -> None:
            value = self._of(float(event.args))
            self._value.text = as_text(value)
            moved(value)

        self._slider.on(
            "update:model-value", changed, throttle=0.05, leading_events=False
        )

    @property
    def value(self) -> float:
        """The quantity."""
        return self._of(float(self._slider.value or 0.0))

    def set(self, value: float, limits: tuple[float, float] | None = None) -> None:
        """Shows a value, between other limits where these are given."""
        if limits is not None:
            low, high = (self._at(limit) for limit in limits)
            self._slider.props["min"], self._slider.props["max"] = low, high
            self._slider.props["step"] = (high - low) / 200
        self._slider.value = self._at(value)
        self._value.text = self._text(value)

    def show(self, shown: bool) -> None:
        """Shows or hides it."""
        self._place.visible = shown

    def _at(self, value: float) -> float:
        return math.log10(value) if self._logarithmic else value

    def _of(self, place: float) -> float:
        return 10**place if self._logarithmic else place


def length(metres: float) -> str:
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


def material_names(session: Session) -> dict[str, str]:
    """What a rubber may be: the fitted and dropped ones of this page, then the
    library.
    """
    of_page = {
        name: f"{name.removesuffix('.toml')} (this page)"
        for name in session.folder.names(".toml")
    }
    return of_page | {name: name for name in _library()}


@functools.cache
def _library() -> tuple[str, ...]:
    """The materials of the library, looked for once by a server: that takes long."""
    return tuple(em.materials())


def sample(session: Session, name: str) -> str:
    """Keeps a sample in the session's folder; returns its name there."""
    return session.folder.keep(name, SAMPLE.joinpath(name).read_bytes())


def drop(
    session: Session,
    label: str,
    taken: Callable[[list[str]], Awaitable[None]],
    sample: tuple[str, Callable[[], Awaitable[None]]],
    *,
    multiple: bool = False,
) -> None:
    """A place to drop files on, and a button for a sample.

    `taken` is called with the names that the files have in the session's folder. What
    cannot be taken is said above.
    """
    failed = ui.label().classes("alert").props("role=alert")
    failed.visible = False

    def refuse(message: str) -> None:
        failed.text, failed.visible = message, True

    async def take(work: Awaitable[None]) -> None:
        session.touch()
        failed.visible = False
        try:
            await work
        except InputError as error:
            refuse(f"{error} Nothing has been changed.")
        except OSError as error:
            refuse(f"The file could not be kept: {error.strerror or error}.")

    async def kept(files: Sequence[Any]) -> None:
        await taken(
            [session.folder.keep(file.name, await file.read()) for file in files]
        )

    async def arrived(event: events.MultiUploadEventArguments) -> None:
        await take(kept(event.files))

    async def sampled() -> None:
        await take(sample[1]())

    upload = ui.upload(
        label=label,
        multiple=multiple,
        auto_upload=True,
        max_file_size=MOST_BYTES,
        on_multi_upload=arrived,
        on_rejected=lambda: refuse(f"A file must be {MOST_BYTES / 1e6:g} MB or less."),
    )
    upload.classes("drop").props(f'flat bordered aria-label="{label}"')
    # Once the browser knows that they have arrived; not reset(), which would break off
    # a file that is arriving meanwhile.
    remove = f"() => runMethod({upload.id}, 'removeUploadedFiles', [])"
    upload.on("uploaded", js_handler=remove)
    upload.on(
        "failed",
        lambda: refuse("The file did not arrive: too large, or too slow."),
        args=[],
    )
    ui.button(sample[0], on_click=sampled).props(f"{BUTTON} outline")


def mark_of_age() -> ui.label:
    """A line, hidden at first, which says that what is shown is not of what is filled
    in.
    """
    mark = ui.label("What is shown was computed before the last change.").classes(
        "note"
    )
    mark.visible = False
    return mark


class Picture:
    """A figure that one can point at, with what saves it; `about` is read out in place
    of it, `stem` begins the names of its files; isotherms of a master curve can be
    dragged where `dragged` says so.
    """

    def __init__(self, about: str, stem: str, *, dragged: bool = False):
        self._about, self._stem, self._dragged = about, stem, dragged
        self._drawn: Drawn | None = None
        self._panels: list[tuple[ui.plotly, ui.label, ui.label]] = []
        self._place = ui.element("div").classes("picture")
        with ui.element("div").classes("buttons save") as self._save:
            ui.label("Save as").classes("about")
            for kind in ("png", "svg", "csv"):
                button = ui.button(
                    kind.upper(), on_click=functools.partial(self._give, kind)
                )
                button.props(f'flat dense aria-label="Save as {kind.upper()}"')
            ui.label("Drag a box to zoom, double-click to zoom back").classes("about")
        self._place.visible = self._save.visible = False

    @property
    def shown(self) -> bool:
        """Whether there is a figure."""
        return self._drawn is not None

    def show(self, drawn: Drawn | None) -> None:
        """Shows a figure, or nothing; one of the same curves stays zoomed as it is."""
        self._drawn = drawn
        self._place.visible = self._save.visible = drawn is not None
        if drawn is None:
            return
        if len(self._panels) != len(drawn.charts):
            self._place.clear()
            with self._place:
                self._panels = [self._panel() for _ in drawn.charts]
        for chart, plot, (panel, heading, notes) in zip(
            drawn.charts, drawn.plots(), self._panels, strict=True
        ):
            heading.text = spoken(chart.title)
            notes.text = spoken(chart.sentence)
            panel.update_figure(plot)
            dragged = str(self._dragged).lower()
            panel.client.run_javascript(f"elastomdr.ready({panel.id}, {dragged})")

    def _panel(self) -> tuple[ui.plotly, ui.label, ui.label]:
        with ui.element("figure").classes("panel"):
            heading = ui.label().classes("panel-title")
            notes = ui.label().classes("panel-notes")
            panel = ui.plotly({"data": [], "layout": {}}).classes("chart")
            panel.props(f'role=img aria-label="{self._about}"')
        return panel, heading, notes

    async def _give(self, kind: str) -> None:
        if self._drawn is not None:
            content = await worked(DRAWING, self._drawn.saved, kind)
            ui.download.content(content, f"{self._stem}.{kind}")


class Notes:
    """What is worth a warning, one line each."""

    def __init__(self) -> None:
        self._place = ui.element("div").classes("notes")

    def show(self, texts: Sequence[str]) -> None:
        """Shows these texts in the place of the ones before."""
        self._place.clear()
        with self._place:
            for note in texts:
                ui.label(note).classes("note")


class Words:
    """A text in lines of their own, such as a summary."""

    def __init__(self) -> None:
        self._label = ui.label().classes("words").props("tabindex=0")
        self._label.visible = False

    def show(self, summary: str) -> None:
        """Shows a text in the place of the one before."""
        self._label.text, self._label.visible = summary, bool(summary)
