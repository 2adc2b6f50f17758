"""`elastomdr app`: serves the page on this machine, and opens it in the browser."""

import argparse
import os
import secrets
import signal
import socket
import sys
import tempfile
from pathlib import Path
from typing import Any

from ..cli import DONE
from ..errors import InputError


def run(options: argparse.Namespace) -> int:
    """Serves until it is interrupted; returns the exit status."""
    with (
        socket.socket() as door,
        tempfile.TemporaryDirectory(prefix="elastomdr-app-") as place,
    ):
        _listen(door, options.port)
        os.environ["NICEGUI_STORAGE_PATH"] = str(Path(place) / "storage")
        tempfile.tempdir = place  # what is received is kept nowhere else
        try:
            token = secrets.token_urlsafe(24)
            server = serve(token, Path(place))
            address = f"http://127.0.0.1:{door.getsockname()[1]}/{token}/"
            print(f"elastomdr: open {address}   (Ctrl-C ends)", flush=True)
            if not options.no_browser:
                import webbrowser

                webbrowser.open(_redirect(address, Path(place)).as_uri())
            signal.signal(signal.SIGTERM, signal.default_int_handler)
            server.run(sockets=[door])
        except KeyboardInterrupt:
            print("elastomdr: ended", file=sys.stderr)
        finally:
            tempfile.tempdir = None
    return DONE


def _redirect(address: str, place: Path) -> Path:
    """A file that leads to the address, readable for this user alone: on the browser's
    command line, which every user of the machine can read, stands its name only.
    """
    file = place / "open.html"
    file.touch(mode=0o600)
    file.write_text(f'<meta http-equiv="refresh" content="0; url={address}">')
    return file


def serve(token: str, place: Path) -> Any:
    """The server of the page, whose addresses all begin with the token. Raises
    `InputError` without NiceGUI.
    """
    try:
        import uvicorn
        from fastapi import FastAPI
        from nicegui import ui
    except ImportError as error:
        raise InputError(
            argument="app",
            accepted="called where NiceGUI is installed",
            hint=f"pip install 'elastomdr[app]' ({error})",
        ) from error
    from .page import page
    from .security import Guard
    from .session import Sessions

    sessions = Sessions(place)
    outer = FastAPI(openapi_url=None)
    ui.run_with(
        outer,
        root=lambda: page(sessions) and None,
        title="elastomdr",
        mount_path=f"/{token}",
        tailwind=False,
        reconnect_timeout=60.0,
        show_welcome_message=False,
    )
    config = uvicorn.Config(
        Guard(outer, token),
        log_level="error",
        timeout_graceful_shutdown=1,
        lifespan="on",
    )
    return uvicorn.Server(config)


def _listen(door: socket.socket, port: int) -> None:
    """Listens on this machine only. Raises `InputError` for a port that is in use."""
    try:
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        door.bind(("127.0.0.1", port))
        door.listen()  # a browser that comes before the server is ready waits
    except (OSError, OverflowError) as error:
        raise InputError(
            argument="--port",
            got=port,
            accepted="a free port, 0 to 65535",
            hint=str(error),
        ) from error
