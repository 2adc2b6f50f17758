"""What one page in the browser holds: its folder, the scenes as far as they are filled
in, what has been computed.
"""

import secrets
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path

from nicegui import Client

from ..cli.fit import Calibrated
from ..cli.schema import Content
from ..errors import InputError
from .scene import Done
from .security import Folder

_MOST = 20  # sessions that are kept although no page shows them
# One thread computes and does all that hears or silences warnings, which Python keeps for
# all threads together, so that they belong to what is computed; another one draws.
COMPUTING = ThreadPoolExecutor(1, "compute")
DRAWING = ThreadPoolExecutor(1, "draw")


@dataclass
class Session:
    """One page; it survives that the page is loaded again."""

    name: str
    folder: Folder
    # by stage, as a scene file holds them
    scenes: dict[str, Content] = field(default_factory=dict)
    done: dict[str, Done] = field(default_factory=dict)  # by stage
    rubber: Content = field(default_factory=dict)  # what is asked of a fit
    question: InputError | None = None  # what a fit needs to know
    # by the name of the material's file
    fits: Content = field(default_factory=dict)
    calibrated: Calibrated | None = None
    # material's file to the command that makes it
    notes: dict[str, str] = field(default_factory=dict)
    place: str = ""  # the screen that is shown, "" for the first one
    # which kind of scene is filled in, by the screen's key
    kinds: dict[str, str] = field(default_factory=dict)
    pages: set[str] = field(default_factory=set)  # clients of NiceGUI that show it
    used: float = 0.0

    def touch(self) -> None:
        """Notes that it is in use; of too many sessions those go that were left alone
        longest.
        """
        self.used = time.monotonic()

    def unfitted(self) -> list[str]:
        """The dropped measurements, where no rubber has been fitted to them as they are
        filled in.
        """
        latest = next(reversed(self.fits.values()), None)
        done = latest is not None and latest.asked == self.rubber
        return [] if done else self.rubber.get("data", [])

    def shown_by(self, client: Client) -> None:
        """Stays as long as NiceGUI keeps this client: until a minute after its
        connection has ended.
        """
        self.pages.add(client.id)
        client.on_delete(lambda: self.pages.discard(client.id))


class Sessions:
    """The sessions of a server, each with a folder of its own inside one that goes when
    the server ends.
    """

    def __init__(self, place: Path):
        self._place = place
        self._known: dict[str, Session] = {}

    def get(self, name: str | None) -> Session:
        """The session of this name, or a new one."""
        session = self._known.get(name or "")
        if session is None:
            name = secrets.token_hex(8)
            session = self._known[name] = Session(
                name, Folder(self._place / name), scenes=_start()
            )
            self._remove_the_oldest(session)
        session.touch()
        return session

    def _remove_the_oldest(self, new: Session) -> None:
        """Removes sessions that no page shows, so that not too many of them are
        kept.
        """
        left = [
            each for each in self._known.values() if not each.pages and each is not new
        ]
        left.sort(key=lambda each: each.used, reverse=True)
        for old in left[_MOST:]:
            self._known.pop(old.name).folder.remove()


def _start() -> dict[str, Content]:
    """What the forms of friction show at first: materials of the library on a
    self-affine road.
    """
    contact = {
        "pressure": "0.3 MPa",
        "velocity": {"from": "1e-4 m/s", "to": "10 m/s", "points": 24},
    }
    road = {
        "shape": "self_affine",
        "hurst": 0.8,
        "rms_slope": 0.7,
        "longest": "5 mm",
        "shortest": "50 um",
    }
    friction = {
        "material": "epdm-70",
        "temperature": ["0 degC", "20 degC", "40 degC"],
        "surface": road,
    }
    return {
        "friction": {**friction, "contact": contact},
        "compare": {
            "material": ["epdm-70", "tread-passenger-synthetic"],
            "temperature": "20 degC",
            "compare": {"velocity": "1 m/s"},
        },
    }
