"""What a long sweep says while it runs, and what it keeps so that an interrupted one
can be taken up again.
"""

import sys
import time
from pathlib import Path
from typing import Any

_PATIENCE = 2.0  # seconds before a bar appears
_WIDTH = 30


class Parts:
    """Finished batches of a sweep, one file each, in a folder that is removed when the
    sweep is complete.
    """

    def __init__(self, folder: Path):
        self._folder = folder

    def get(self, key: str) -> Any:
        """The arrays kept under `key`, or None."""
        import numpy as np

        try:
            return np.load(self._folder / f"{key}.npy", allow_pickle=False)
        except (OSError, ValueError, EOFError):
            return None

    def put(self, key: str, arrays: Any) -> None:
        """Keeps arrays; a folder that cannot be written costs the possibility to
        resume, not the sweep.
        """
        import numpy as np

        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            unfinished = self._folder / f"{key}.part.npy"
            np.save(unfinished, arrays)
            unfinished.replace(self._folder / f"{key}.npy")
        except OSError:
            return

    def said(self) -> str:
        """Where finished batches are, for whom it interrupts; an empty text where there
        are none.
        """
        if not any(self._folder.glob("*.npy")):
            return ""
        return (
            f"; what is finished is kept in {self._folder}, and the same command goes "
            "on from there"
        )

    def remove(self) -> None:
        """Removes what was kept."""
        for file in self._folder.glob("*.npy"):
            file.unlink(missing_ok=True)
        if self._folder.is_dir():
            self._folder.rmdir()


class Bar:
    """A progress bar on the standard error, where that is a terminal and the work takes
    more than two seconds.
    """

    def __init__(self) -> None:
        self._start, self._shown = time.monotonic(), False

    def __call__(self, done: int, total: int) -> None:
        if not sys.stderr.isatty() or time.monotonic() - self._start < _PATIENCE:
            return
        self._shown = True
        full = _WIDTH * done // total
        print(
            f"\r[{'#' * full}{'.' * (_WIDTH - full)}] {done} of {total}",
            end="",
            file=sys.stderr,
            flush=True,
        )

    def end(self) -> None:
        """Clears the line."""
        if self._shown:
            print(
                "\r" + " " * (_WIDTH + 30) + "\r", end="", file=sys.stderr, flush=True
            )
