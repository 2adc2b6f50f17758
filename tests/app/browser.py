"""A headless Chromium, driven by its DevTools protocol."""

import base64
import json
import shutil
import subprocess
import tempfile
import time
from pathlib import Path
from typing import Any
from urllib.request import urlopen

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-sync",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--remote-debugging-port=0",
    "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
)
PROGRAM = shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page; names outside of this machine do not resolve."""

    def __init__(self, width: int = 1280, height: int = 900):
        from websockets.sync.client import connect

        self._home = tempfile.TemporaryDirectory(
            prefix="chromium-", ignore_cleanup_errors=True
        )
        self.downloads = Path(self._home.name) / "downloads"
        assert PROGRAM is not None
        self._process = subprocess.Popen(
            [PROGRAM, *FLAGS, f"--user-data-dir={self._home.name}", "about:blank"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        found = Path(self._home.name) / "DevToolsActivePort"
        wait(lambda: found.exists() and found.read_text().count("\n"), "Chromium", 60)
        port = found.read_text().split()[0]
        with urlopen(f"http://127.0.0.1:{port}/json/list", timeout=30) as answer:
            target = next(page for page in json.load(answer) if page["type"] == "page")
        self._connection = connect(target["webSocketDebuggerUrl"], max_size=None)
        self._socket = self._connection.__enter__()
        self._number, self.console = 0, []
        for domain in ("Page", "Runtime", "DOM"):
            self.call(f"{domain}.enable")
        self.call(
            "Browser.setDownloadBehavior",
            behavior="allow",
            downloadPath=str(self.downloads),
        )
        self.resize(width, height)

    def call(self, method: str, **parameters: Any) -> Any:
        """The answer to a command of the protocol."""
        self._number += 1
        self._socket.send(
            json.dumps({"id": self._number, "method": method, "params": parameters})
        )
        while True:
            message = json.loads(self._socket.recv(timeout=60))
            if message.get("method") == "Runtime.exceptionThrown":
                self.console.append(message["params"]["exceptionDetails"]["text"])
            if message.get("id") == self._number:
                assert "error" not in message, message
                return message["result"]

    def js(self, expression: str) -> Any:
        """The value of an expression of JavaScript."""
        answer = self.call(
            "Runtime.evaluate",
            expression=expression,
            returnByValue=True,
            awaitPromise=True,
        )
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def until(self, expression: str, seconds: float = 60) -> Any:
        """Waits until an expression is true, and returns it."""
        return wait(lambda: self.js(expression), expression, seconds)

    def open(self, address: str) -> None:
        self.call("Page.navigate", url=address)
        self.until(
            "document.querySelectorAll('.start').length && window.socket?.connected"
        )

    def resize(self, width: int, height: int = 900) -> None:
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def click(self, text: str) -> None:
        """Clicks the visible button or tab of this text."""
        named = f"e => e.innerText.trim() == {json.dumps(text)} && e.offsetParent"
        find = f"[...document.querySelectorAll('button,[role=tab]')].find({named})"
        self.until(f"!!{find}")
        self.js(f"{find}.click()")

    def drop(self, selector: str, *files: Path) -> None:
        """Puts files into the file field within an element."""
        root = self.call("DOM.getDocument")["root"]["nodeId"]
        node = self.call(
            "DOM.querySelector", nodeId=root, selector=f"{selector} input[type=file]"
        )["nodeId"]
        self.call(
            "DOM.setFileInputFiles", nodeId=node, files=[str(file) for file in files]
        )

    def press(self, key: str, code: int) -> None:
        """Presses a key and lets go of it."""
        for kind in ("keyDown", "keyUp"):
            text = {"text": "\r"} if key == "Enter" and kind == "keyDown" else {}
            self.call(
                "Input.dispatchKeyEvent",
                type=kind,
                key=key,
                code=key,
                windowsVirtualKeyCode=code,
                **text,
            )

    def screenshot(self, path: Path) -> None:
        size = self.call("Page.getLayoutMetrics")["cssContentSize"]
        clip = {
            "x": 0,
            "y": 0,
            "width": size["width"],
            "height": min(size["height"], 6000),
            "scale": 1,
        }
        image = self.call(
            "Page.captureScreenshot", captureBeyondViewport=True, clip=clip
        )
        path.write_bytes(base64.b64decode(image["data"]))

    def close(self) -> None:
        self._connection.__exit__(None, None, None)
        self._process.terminate()
        self._process.wait(timeout=30)
        self._home.cleanup()


def wait(condition: Any, what: str, seconds: float) -> Any:
    """The first true value of a condition."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        if found := condition():
            return found
        time.sleep(0.1)
    raise AssertionError(f"waited {seconds} s for {what}")
