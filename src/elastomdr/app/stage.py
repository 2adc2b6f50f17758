"""What the screens share: samples, dropping files, figures, messages, work outside of the
event loop.
"""

import asyncio
import base64
from collections.abc import Awaitable, Callable, Sequence
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, TypeVar

from nicegui import events, ui

import elastomdr as em

from ..errors import InputError
from .security import MOST_BYTES
from .session import Session

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
    """A figure, as an image with a description."""

    def __init__(self, about: str):
        with ui.element("div").classes("frame"):
            self._image = ui.element("img").classes("figure").props(f'alt="{about}"')
        self._image.visible = False

    @property
    def shown(self) -> bool:
        """Whether there is a figure."""
        return self._image.visible

    def show(self, svg: bytes | None) -> None:
        """Shows an SVG image, or nothing."""
        self._image.visible = svg is not None
        if svg is not None:
            self._image.props["src"] = (
                f"data:image/svg+xml;base64,{base64.b64encode(svg).decode()}"
            )


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
