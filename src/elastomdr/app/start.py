"""The first screen: a computed example, and three ways on."""

import tempfile
from collections.abc import Awaitable, Callable
from functools import cache
from pathlib import Path

from nicegui import ui

from ..cli.schema import Content
from .cards import Cards
from .chart import Drawn
from .scene import CancelledError, Done, compute
from .security import Folder
from .session import COMPUTING, DRAWING
from .stage import BUTTON, Busy, Picture, worked

# A tread block on stone; its adhesive shear is illustrative, of the size that is found
# for dry treads.
EXAMPLE: Content = {
    "material": "tread-passenger-synthetic",
    "temperature": ["0 degC", "20 degC", "40 degC"],
    "surface": {
        "shape": "self_affine",
        "hurst": 0.8,
        "rms_slope": 1.3,
        "longest": "5 mm",
        "shortest": "0.1 mm",
    },
    "contact": {
        "pressure": "0.3 MPa",
        "velocity": {"from": "1e-4 m/s", "to": "30 m/s", "points": 18},
    },
    "heat": {
        "conductivity": "0.25 W/(m K)",
        "heat_capacity": "2 MJ/(m^3 K)",
        "road": {"conductivity": "1.5 W/(m K)", "heat_capacity": "2 MJ/(m^3 K)"},
    },
    "adhesion": {
        "stress": "5.5 MPa",
        "velocity": "5 mm/s",
        "width": 0.1,
        "energy": "80 kJ/mol",
        "reference": "20 degC",
    },
}
_WAYS = (
    (
        "My rubber",
        "Rubber",
        "Drop measured moduli (DMA): master curve, shift factors, Prony series.",
    ),
    (
        "My road",
        "Road",
        "Drop a spectrum or a topography, or give self-affine numbers.",
    ),
    (
        "My roller",
        "Rolling",
        "A roller, a wheel, a belt: rolling resistance, heat, power.",
    ),
)


class StartStage:
    """The screen.

    `go` shows another screen; `take` shows the example on the friction screen, to be
    changed.
    """

    def __init__(
        self, go: Callable[[str], None], take: Callable[[Done], Awaitable[None]]
    ):
        self._take = take
        with ui.element("div").classes("start"):
            self._fill(go)
        ui.timer(0.05, self._show, once=True)

    def _fill(self, go: Callable[[str], None]) -> None:
        ui.label(
            "How much friction, how much rolling loss, and how sure is the number?"
        ).classes("lead")
        with ui.element("div").classes("ways"):
            for name, screen, about in _WAYS:
                with ui.element("section").classes("way"):
                    ui.button(name, on_click=lambda _, to=screen: go(to)).props(BUTTON)
                    ui.label(about).classes("about")
        ui.label("An example: dry friction of a tread block on a rough road").classes(
            "lead"
        ).props("role=heading aria-level=2")
        self._busy = Busy()
        self._cards = Cards()
        self._picture = Picture("the friction of the example", "example")
        self._change = ui.button("Change the example", on_click=self._taken).props(
            f"{BUTTON} outline"
        )
        ui.label(
            "The rubber is synthetic, with moduli like those of a passenger-car tread; "
            "road and adhesive shear are assumed."
        ).classes("about")

    async def _show(self) -> None:
        try:
            computation = await self._busy.during(COMPUTING, example)
        except CancelledError:
            return
        self._cards.show(computation)
        self._picture.show(await worked(DRAWING, _figure))

    async def _taken(self) -> None:
        await self._take(await worked(COMPUTING, example))


@cache
def example() -> Done:
    """The example, computed once by a server."""
    with tempfile.TemporaryDirectory() as place:
        return compute("friction", EXAMPLE, Folder(Path(place)))


@cache
def _figure() -> Drawn:
    return example().figure()
