"""Who may speak to the page, how much may be sent, and the folder that files stay
in.
"""

import hmac
import os
import re
import shutil
import time
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from starlette.types import ASGIApp, Message, Receive, Scope, Send

from ..errors import InputError

MOST_BYTES = 20_000_000  # of one file
MOST_IN_ALL = 200_000_000  # of the files of one session
MOST_SECONDS = 60.0  # for sending a file
_EXTRA = 100_000  # what a form adds to its file
_LONGEST = 100  # characters of a file's name
HEADERS = {
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "DENY",
    "X-Content-Type-Options": "nosniff",
}


class Guard:
    """An ASGI application before the page's own: lets through what has the token as the
    first part of its address.

    The address of every request, of every file and of the WebSocket begins with the
    token. A request that names another host than this machine is refused (a foreign
    page that resolves its own name to 127.0.0.1), and so is one that a browser makes
    for a page of another origin, and a body that is too large or takes too long.
    """

    def __init__(
        self,
        app: ASGIApp,
        token: str,
        *,
        bytes_: int = MOST_BYTES + _EXTRA,
        seconds: float = MOST_SECONDS,
    ):
        self.app, self._token, self._bytes, self._seconds = (
            app,
            token.encode(),
            bytes_,
            seconds,
        )

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if scope["type"] == "lifespan":
            return await self.app(scope, receive, send)
        if not self._known(scope):
            return await _refuse(
                scope,
                send,
                403,
                "elastomdr app: open the address that the terminal shows.",
            )
        if scope["type"] == "websocket":
            return await self.app(scope, receive, send)
        length = _header(scope, b"content-length")
        if length.isdigit() and int(length) > self._bytes:
            return await _refuse(scope, send, 413, _too_large())
        return await self._bounded(scope, receive, send)

    def _known(self, scope: Scope) -> bool:
        first = scope["path"].split("/")[1:2]
        host = _header(scope, b"host").lower()
        good = bool(first) and hmac.compare_digest(
            first[0].encode("utf-8", "replace"), self._token
        )
        here = host.rsplit(b":", 1)[0] in (b"127.0.0.1", b"localhost")
        # A browser names the origin with each WebSocket, with each POST and with what
        # another page asks for.
        origin = _header(scope, b"origin").lower()
        return good and here and origin in (b"", b"http://" + host)

    async def _bounded(self, scope: Scope, receive: Receive, send: Send) -> None:
        import asyncio

        end, got, answered = time.monotonic() + self._seconds, 0, False
        gone = False  # whether the browser has closed the connection
        refused: _TooMuchError | None = None

        async def within() -> Message:
            nonlocal got, refused, gone
            if answered or scope["method"] in ("GET", "HEAD"):
                # nothing but the end of the connection is awaited
                message = await receive()
                gone = message["type"] == "http.disconnect"
                return message
            try:
                message = await asyncio.wait_for(
                    receive(), max(end - time.monotonic(), 0.001)
                )
            except TimeoutError:
                refused = _TooMuchError(
                    408, f"A file must be sent within {self._seconds:g} s."
                )
                raise refused from None
            got += len(message.get("body", b""))
            if got > self._bytes:
                refused = _TooMuchError(413, _too_large())
                raise refused
            return message

        async def answer(message: Message) -> None:
            nonlocal answered
            if refused is not None and not answered:
                return  # the application's own answer to what stopped it
            answered = True
            if message["type"] == "http.response.start":
                added = [
                    (name.lower().encode(), value.encode())
                    for name, value in HEADERS.items()
                ]
                message = {**message, "headers": [*message.get("headers", []), *added]}
            await send(message)

        try:
            await self.app(scope, within, answer)
        except _TooMuchError:
            pass
        except RuntimeError:  # of Starlette, without an answer
            if not gone:
                raise
        finally:
            if refused is not None and not answered:
                await _refuse(scope, send, refused.status, str(refused))


class Folder:
    """The files of one session; nothing is read or written elsewhere."""

    def __init__(self, path: Path, most: int = MOST_IN_ALL):
        path.mkdir(parents=True, exist_ok=True)
        self.path, self._most = path, most

    def names(self, *endings: str) -> list[str]:
        """The names of the files, of these endings where any are given, newest
        first.
        """
        files = [
            file
            for file in self.path.iterdir()
            if file.is_file() and (file.suffix in endings or not endings)
        ]
        return [
            file.name
            for file in sorted(files, key=lambda file: -file.stat().st_mtime_ns)
        ]

    def measurements(self) -> list[str]:
        """The names of the files that are no materials."""
        return [name for name in self.names() if not name.endswith(".toml")]

    def keep(self, name: str, content: bytes, *, anew: bool = False) -> str:
        """Writes a file; returns the name that it has here. Raises `InputError` for one
        that is too large or empty.

        Another file of the same name stays, as a scene may read it, and the new one is
        numbered; `anew` replaces it.
        """
        if not content:
            raise InputError(
                argument="file",
                got=name,
                accepted="a file with content",
                hint="it is empty (0 bytes): export or copy it again",
            )
        if len(content) > MOST_BYTES:
            raise InputError(
                argument="file",
                got=name,
                accepted=f"of {MOST_BYTES / 1e6:g} MB or less",
            )
        here = safe(name)
        if not anew:
            stem, dot, ending = here.rpartition(".")
            names = (
                here,
                *(
                    f"{stem}-{k}{dot}{ending}" if dot else f"{here}-{k}"
                    for k in range(2, 1000)
                ),
            )
            here = next(each for each in names if self._free(each, content))
        held_bytes = sum(
            file.stat().st_size for file in self.path.iterdir() if file.name != here
        )
        if held_bytes + len(content) > self._most:
            raise InputError(
                argument="file",
                got=name,
                accepted="such that the files of this page have "
                f"{self._most / 1e6:g} MB or less in all",
            )
        unfinished = self.path / f".{here}.part"
        unfinished.write_bytes(content)
        os.replace(unfinished, self.path / here)
        return here

    def _free(self, name: str, content: bytes) -> bool:
        """Whether there is no other file of this name."""
        path = self.path / name
        return not path.exists() or (
            path.stat().st_size == len(content) and path.read_bytes() == content
        )

    def check(self, names: Iterable[Any]) -> None:
        """Raises `InputError` for a name that is no file of this folder."""
        for name in names:
            if not isinstance(name, str) or name not in self.names():
                raise InputError(
                    argument="file", got=name, accepted="one that was dropped here"
                )

    def remove(self) -> None:
        """Removes the folder with all files."""
        shutil.rmtree(self.path, ignore_errors=True)


def safe(name: str) -> str:
    """A file's name without folders and without what a shell or another system would
    trip over.
    """
    last = re.split(r"[/\\]", name)[-1]
    cleaned = re.sub(r"[^\w.() -]+", "-", last).strip(" .-")
    stem, dot, ending = cleaned.rpartition(".")
    short = (
        f"{stem[: _LONGEST - len(ending[:20])]}{dot}{ending[:20]}"
        if dot
        else cleaned[:_LONGEST]
    )
    return short or "file"


class _TooMuchError(Exception):
    def __init__(self, status: int, message: str):
        super().__init__(message)
        self.status = status


def _too_large() -> str:
    return f"A file must be {MOST_BYTES / 1e6:g} MB or less."


def _header(scope: Scope, name: bytes) -> bytes:
    return next(
        (value for key, value in scope.get("headers", ()) if key.lower() == name), b""
    )


async def _refuse(scope: Scope, send: Send, status: int, message: str) -> None:
    if scope["type"] == "websocket":
        return await send({"type": "websocket.close", "code": 1008})
    headers = [
        (b"content-type", b"text/plain; charset=utf-8"),
        (b"connection", b"close"),
    ]
    await send({"type": "http.response.start", "status": status, "headers": headers})
    await send({"type": "http.response.body", "body": message.encode()})
