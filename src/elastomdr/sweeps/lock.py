"""One process at a time computes a store."""

from __future__ import annotations

import contextlib
import os
import socket
import threading
import time
import uuid
from collections.abc import Iterator

from ..errors import InputError
from .storage import Files

# seconds between two renewals of a mark; who finds one waits for three of them
_RENEWAL = 10.0


class Alone:
    """What keeps other processes from a store; `check` raises where one has come all
    the same.
    """

    def __init__(self, files: Files):
        self._files = files
        name = files.place.rstrip("/").rpartition("/")[2]
        self._file = f"../.{name}.lock"
        self._owner = f"{socket.gethostname()}, process {os.getpid()}, {uuid.uuid4()}"
        self._ended = threading.Event()
        self._taken_by = ""

    @contextlib.contextmanager
    def held(self) -> Iterator[Alone]:
        """Holds the lock. Raises `InputError` where another process does."""
        folder = self._files.folder
        if folder is None:
            yield from self._marked()
            return
        from filelock import FileLock, Timeout

        lock = folder.with_name(f".{folder.name}.lock")
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            held = FileLock(lock, blocking=False)
            held.acquire()
        except Timeout as error:
            raise self._in_use("another process") from error
        except NotImplementedError:  # a file system of a cluster without locks
            yield from self._marked()
            return
        except OSError as error:
            raise InputError(
                "store must be a folder that can be written, got "
                f"{self._files.place!r}: {error.strerror or error}."
            ) from error
        try:
            yield self
        finally:
            held.release()

    def check(self) -> None:
        """Raises `InputError` where another process has taken the store."""
        if self._taken_by:
            raise self._in_use(self._taken_by)

    def _marked(self) -> Iterator[Alone]:
        """Where there are no locks that end with their process: a file that its owner
        renews; one that nobody renews is of a process that was killed.
        """
        with self._files.told():
            if (mark := self._mark()) and self._is_renewed(mark):
                raise self._in_use(mark.rpartition(",")[0])
            self._write(0)
        renewing = threading.Thread(target=self._renew, daemon=True)
        renewing.start()
        try:
            yield self
        finally:
            self._ended.set()
            renewing.join()
            if not self._taken_by:
                with contextlib.suppress(Exception):  # who comes next waits a little
                    self._files.remove([self._file])

    def _mark(self) -> str:
        (content,) = self._files.read([self._file])
        return "" if content is None else content.decode(errors="replace")

    def _write(self, count: int) -> None:
        self._files.write(self._file, f"{self._owner}, {count}".encode())

    def _is_renewed(self, mark: str) -> bool:
        end = time.monotonic() + 3 * _RENEWAL
        while time.monotonic() < end:
            time.sleep(_RENEWAL / 5)
            now = self._mark()
            if now != mark:
                return bool(now)
        return False

    def _renew(self) -> None:
        count = 0
        while not self._ended.wait(_RENEWAL):
            count += 1
            with contextlib.suppress(Exception):  # a network that fails for a moment
                mark = self._mark()
                if mark and not mark.startswith(self._owner):
                    self._taken_by = mark.rpartition(",")[0]
                    return
                self._write(count)

    def _in_use(self, by: str) -> InputError:
        return InputError(f"store {self._files.place!r} is in use by {by}.")
