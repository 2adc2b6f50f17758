"""What the screens share: samples, dropping files, figures, messages, work outside of the
event loop.
"""

import asyncio
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from nicegui import events, ui

import elastomdr as em

from ..errors import InputError
from .chart import Chart, Drawn
from .security import MOST_BYTES
from .session import DRAWING, Session

# where the wheel has them; a checkout has them among its examples
_OWN = Path(__file__).parent / "data"
SAMPLE = _OWN if _OWN.is_dir() else Path(__file__).parents[3] / "examples" / "data"


T = TypeVar("T")
BUTTON = "no-caps unelevated"


async def worked(pool: Executor, call: Callable[..., T], *arguments: Any) -> T:
    """The result of a call that is made in a thread of its own."""
    return await asyncio.get_running_loop().run_in_executor(pool, call, *arguments)


def material_names(session: Session) -> dict[str, str]:
    """What a rubber may be: the fitted and dropped ones of this page, then the
    library.
    """
    own = {
        name: f"{name.removesuffix('.toml')} (this page)"
        for name in session.folder.names(".toml")
    }
    return own | {name: name for name in em.materials()}


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

    def refuse(text: str) -> None:
        failed.text, failed.visible = text, True

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
        # not reset(), which would break off a file that is arriving meanwhile
        upload.run_method("removeUploadedFiles")

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
    of it, `stem` begins the names of its files.
    """

    def __init__(self, about: str, stem: str):
        self._about, self._stem = about, stem
        self._drawn: Drawn | None = None
        self._panels: list[ui.echart] = []
        self._texts: list[tuple[ui.label, ui.label]] = []
        self._place = ui.element("div").classes("picture")
        with ui.element("div").classes("buttons save") as self._save:
            ui.label("Save as").classes("about")
            for kind in ("png", "svg", "csv"):
                button = ui.button(kind.upper(), on_click=partial(self._give, kind))
                button.props(f'flat dense aria-label="Save as {kind.upper()}"')
        self._place.visible = self._save.visible = False

    @property
    def shown(self) -> bool:
        """Whether there is a figure."""
        return self._drawn is not None

    def show(self, drawn: Drawn | None) -> None:
        """Shows a figure, or nothing; one of the same curves stays zoomed as it is."""
        same = _curves(drawn) == _curves(self._drawn)
        self._drawn = drawn
        self._place.visible = self._save.visible = drawn is not None
        if drawn is None:
            return
        if not same:
            self._place.clear()
            with self._place:
                made = [self._panel(chart) for chart in drawn.charts]
            self._panels = [panel for panel, _ in made]
            self._texts = [texts for _, texts in made]
        for chart, panel, texts in zip(
            drawn.charts, self._panels, self._texts, strict=True
        ):
            texts[0].text, texts[1].text = chart.title, "\n".join(chart.notes)
            if same:
                panel.options.update(chart.options)
                panel.update()
            panel.client.run_javascript(f"elastomdr.label({panel.id})")

    def _panel(self, chart: Chart) -> tuple[ui.echart, tuple[ui.label, ui.label]]:
        with ui.element("figure").classes("panel"):
            texts = (
                ui.label().classes("panel-title"),
                ui.label().classes("panel-notes"),
            )
            panel = ui.echart(dict(chart.options)).classes("chart")
            panel.props(f'role=img aria-label="{self._about}"')
        return panel, texts

    async def _give(self, kind: str) -> None:
        if self._drawn is not None:
            content = await worked(DRAWING, self._drawn.saved, kind)
            ui.download.content(content, f"{self._stem}.{kind}")


def _curves(drawn: Drawn | None) -> list[tuple[str, str]] | None:
    """What is drawn, without its numbers."""
    return drawn and [
        (each["type"], each["name"])
        for chart in drawn.charts
        for each in chart.options["series"]
    ]


class Notes:
    """What is worth a warning, one line each."""

    def __init__(self) -> None:
        self._place = ui.element("div").classes("notes")

    def show(self, texts: Sequence[str]) -> None:
        """Shows these texts in the place of the ones before."""
        self._place.clear()
        with self._place:
            for text in texts:
                ui.label(text).classes("note")


class Words:
    """A text in lines of their own, such as a summary."""

    def __init__(self) -> None:
        self._label = ui.label().classes("words").props("tabindex=0")
        self._label.visible = False

    def show(self, text: str) -> None:
        """Shows a text in the place of the one before."""
        self._label.text, self._label.visible = text, bool(text)
