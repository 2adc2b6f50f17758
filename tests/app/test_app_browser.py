"""The page in a real browser, served as the command serves it, with no network but this
machine.
"""

import os
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from elastomdr.cli.main import main

from .browser import PROGRAM, Browser, wait

SAMPLE = Path(__file__).parents[2] / "examples" / "data"
SHOWN = (
    "[...document.querySelectorAll('.picture')].filter(e => e.offsetParent && "
    "e.querySelector('canvas')).length"
)
POINTED = """(() => {
    const element = [...document.querySelectorAll('.chart')].find(e => e.offsetParent);
    const chart = getElement(Number(element.id.slice(1))).chart;
    const [x, y] = chart.getOption().series[0].data[1];
    const [left, top] = chart.convertToPixel({ xAxisIndex: 0, yAxisIndex: 0 }, [x, y]);
    chart.dispatchAction({ type: 'showTip', x: left, y: top });
    return element.innerText;
})()"""
WIDE = "document.documentElement.scrollWidth <= document.documentElement.clientWidth"
CUT = """[...document.querySelectorAll('.q-tab-panel:not([style*="none"]) *')].filter(e => e.offsetParent
    && e.getBoundingClientRect().right > innerWidth + 1 && !e.closest('.words, .frame, .scroll')).length"""

LONG = (
    "[...document.querySelectorAll('.q-field--error .q-field__messages')].filter(e => "
    "e.offsetParent)"
)
HERE = ".q-tab-panel:not([style*='none'])"
ALERTS = "[...document.querySelectorAll('.alert')].filter(e => e.offsetParent)"
BELOW = f"{LONG}[0].closest('.field').parentElement.nextElementSibling"


@pytest.fixture(scope="module")
def address(tmp_path_factory):
    """A server of its own; at its end its folder is gone."""
    place = tmp_path_factory.mktemp("server")
    command = [sys.executable, "-m", "elastomdr", "app", "--no-browser"]
    with subprocess.Popen(
        command,
        cwd=place,
        env={**os.environ, "TMPDIR": str(place)},
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        line = server.stdout.readline()
        wait(lambda: list(place.glob("elastomdr-app-*")), "the folder", 60)
        yield line.split()[2]
        server.send_signal(signal.SIGTERM)
        assert server.wait(timeout=30) == 0
    assert not list(place.iterdir())  # nothing is left, here or beside


def status(address, **options):
    try:
        with urlopen(Request(address, **options), timeout=60) as answer:
            return answer.status
    except HTTPError as error:
        return error.code


def test_only_who_has_the_address(address):
    origin, token = address.rstrip("/").rsplit("/", 1)
    assert origin.startswith("http://127.0.0.1:")
    wait(lambda: _answers(address), "the server", 60)
    assert status(address) == 200
    assert status(f"{origin}/") == 403
    assert status(f"{origin}/_nicegui_ws/socket.io/?EIO=4&transport=polling") == 403
    assert status(f"{address}_nicegui_ws/socket.io/?EIO=4&transport=polling") == 200
    assert status(address, headers={"Host": "example.org"}) == 403
    assert status(f"{origin}/{token[::-1]}/") == 403
    polling = f"{address}_nicegui_ws/socket.io/?EIO=4&transport=polling"
    assert status(polling, headers={"Origin": "https://example.org"}) == 403
    assert status(polling, headers={"Origin": origin}) == 200


def _answers(address):
    try:
        return status(address)
    except OSError:
        return None


@pytest.mark.skipif(
    PROGRAM is None, reason="Chromium is not installed (apt-get install chromium)"
)
def test_from_files_to_friction(address, tmp_path):
    wait(lambda: _answers(address), "the server", 60)
    browser = Browser()
    try:
        browser.open(address)
        browser.until(
            f"{SHOWN} == 1 && document.querySelectorAll('.result').length == 5"
        )
        browser.click("My rubber")
        (tmp_path / "none.csv").touch()
        browser.drop(HERE, tmp_path / "none.csv")
        browser.until(f"{ALERTS}.some(e => e.innerText.includes('is empty'))")
        browser.drop(HERE, SAMPLE / "dma.csv")
        browser.until(f"{SHOWN} >= 3 && !{ALERTS}.length")
        browser.click("Road")
        browser.until(f"{SHOWN} == 1")
        browser.drop(".q-tab-panel:not([style*='none'])", SAMPLE / "road.csv")
        # never guessed
        browser.until("document.body.innerText.includes('Convention of C is missing')")
        browser.click("Use sample road")
        browser.until("document.body.innerText.includes('0.8034')")
        slider = (
            "[...document.querySelectorAll('.q-slider [tabindex]')].filter(e => "
            "e.offsetParent)[1]"
        )
        browser.js(f"{slider}.focus()")
        # a cutoff moves by a key, and the figure with it
        browser.press("ArrowRight", 39)
        browser.until(
            "document.body.innerText.includes('wavelengths') && "
            "!document.body.innerText.includes('0.8034')"
        )
        browser.click("Friction")
        browser.until(
            "[...document.querySelectorAll('input')].some(e => e.value == '0.3 "
            "MPa' && e.offsetParent)"
        )
        browser.js(
            "[...document.querySelectorAll('input')].find(e => e.value == '0.3 "
            "MPa' && e.offsetParent).focus()"
        )
        browser.press("Enter", 13)
        browser.until(f"{SHOWN} == 1")
        # value and band of each curve at the pointer
        browser.until(
            f"/Sliding velocity.*\\n.*\\n.*0 °C.* [(].* to .*[)]/.test({POINTED})"
        )
        # is no friction, which takes some words
        browser.drop(".q-tab-panel:not([style*='none'])", SAMPLE / "dma.csv")
        browser.until(
            f"{LONG}.some(e => e.innerText.includes('there is no column of velocity'))"
        )
        for width in (390, 1280):
            browser.resize(width)
            browser.until(
                f"{LONG}.every(e => e.getBoundingClientRect().bottom <= "
                f"{BELOW}.getBoundingClientRect().top)"
            )
        browser.click("Export")
        browser.click("Scene (TOML)")
        scene = browser.downloads / "friction.toml"
        wait(scene.exists, "the download", 60)
        content = tomllib.loads(scene.read_text(encoding="utf-8"))
        assert content["material"] == "dma.toml"
        assert content["surface"]["file"] == "road.csv"
        for width in (390, 1280):  # nothing is cut
            browser.resize(width)
            for stage in ("Start", "Rubber", "Road", "Friction", "Export"):
                find = f"find(e => e.innerText.trim() == '{stage}')"
                browser.js(
                    f"[...document.querySelectorAll('[role=tab]')].{find}.click()"
                )
                browser.until(
                    "document.querySelector('[role=tab][aria-selected=true]').innerText.trim() "
                    f"== '{stage}'"
                )
                browser.until(f"{WIDE} && {CUT} == 0", 20)
        assert not browser.console
    finally:
        browser.close()


def test_ports(capsys):
    assert main(["app", "--no-browser", "--port", "70000"]) == 2
    assert "--port must be a free port" in capsys.readouterr().err
