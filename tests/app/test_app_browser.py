"""The page in a real browser, served as the command serves it, with no network but this
machine.
"""

import os
import re
import signal
import subprocess
import sys
import tomllib
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

from elastomdr.cli.main import main

from .walk import Walk

SAMPLE = Path(__file__).parents[2] / "examples" / "data"
SCREENS = (
    "Start",
    "Rubber",
    "Road",
    "Friction",
    "Compare",
    "Rolling",
    "Tyre",
    "Seal",
    "Export",
)
PICTURE = ".picture:visible:has(.main-svg)"
ERROR = ".q-field--error .q-field__messages:visible"
POINTED = """() => {
    const element = [...document.querySelectorAll('.chart')].find(e => e.offsetParent);
    const curve = element.data.findIndex(each => each.mode === 'lines');
    getElement(Number(element.id.slice(1))).Plotly.Fx.hover(element, [{ curveNumber: curve, pointNumber: 1 }]);
    return /0 °C.* [(].* to .*[)]/.test(element.querySelector('.hoverlayer').textContent);
}"""
# where the first point of an isotherm is in the window
ISOTHERM = """name => {
    const element = [...document.querySelectorAll('.chart')].find(e => e.offsetParent);
    const trace = element.data.find(each => each.mode === 'markers' && each.name === name);
    const { xaxis, yaxis } = element._fullLayout;
    const { x, y } = element.getBoundingClientRect();
    return [x + xaxis._offset + xaxis.d2p(trace.x[0]), y + yaxis._offset + yaxis.d2p(trace.y[0])];
}"""
# nothing reaches beyond the window, and no message covers the field below
WHOLE = """() => document.documentElement.scrollWidth <= document.documentElement.clientWidth
    && [...document.querySelectorAll('.q-tab-panel:not([style*="none"]) *')].every(e => !e.offsetParent
        || e.getBoundingClientRect().right <= innerWidth + 1 || e.closest('.words, .frame, .scroll'))
    && [...document.querySelectorAll('.chart .main-svg')].every(e => !e.offsetParent
        || e.getBoundingClientRect().right <= e.closest('.chart').getBoundingClientRect().right + 1)
    && [...document.querySelectorAll('.q-field--error .q-field__messages')].every(e => !e.offsetParent
        || e.getBoundingClientRect().bottom <=
           e.closest('.field').parentElement.nextElementSibling.getBoundingClientRect().top)"""
# nothing moves, which nobody sees and each frame of which is work
STILL = """addEventListener('DOMContentLoaded', () => {
    const style = document.head.appendChild(document.createElement('style'));
    style.textContent = '* { animation: none !important; transition: none !important; }';
});"""
FOCUSED = """() => {
    const e = document.activeElement, outline = getComputedStyle(e).outlineStyle;
    if (e == document.body) return null;
    const field = e.closest('.q-field')?.querySelector('.q-field__label');
    return [e.closest('[aria-label]')?.ariaLabel || (field ?? e).innerText.trim().split('\\n').at(-1), outline != 'none'];
}"""


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    """What the browser is told to open."""
    return tmp_path_factory.mktemp("browser") / "told"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """Where the server keeps its folder."""
    return tmp_path_factory.mktemp("server")


@pytest.fixture(scope="module")
def address(place, told):
    """A server of its own; at its end its folder is gone."""
    browser = told.with_name("browser")
    browser.write_text(f'#!/bin/sh\necho "$@" > {told}\n')
    browser.chmod(0o700)
    command = [sys.executable, "-m", "elastomdr", "app"]
    with subprocess.Popen(
        command,
        cwd=place,
        env={**os.environ, "TMPDIR": str(place), "BROWSER": str(browser)},
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        # it listens before it says so
        yield server.stdout.readline().split()[2]
        server.send_signal(signal.SIGTERM)
        assert server.wait(timeout=30) == 0
    assert not list(place.iterdir())  # nothing is left, here or beside


@pytest.fixture(scope="module")
def opened(address, chromium):
    """One page for all tests of this file: to load it takes the longest."""
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(60e3)
    page.add_init_script(STILL)
    page.goto(address)
    page.locator(".result").nth(4).wait_for()
    yield page
    page.close()


@pytest.fixture
def page(opened):
    """The page, on its first screen, without an error of its scripts."""
    errors = []
    opened.on("pageerror", lambda error: errors.append(error))
    tab(opened, "Start")
    yield opened
    assert not errors


def tab(page, screen):
    page.locator(f"[role=tab]:has(:text-is('{screen}'))").click()
    page.locator(f".of-{screen.lower()}:visible > *:visible").first.wait_for()


def button(page, name):
    return page.locator(f"button:visible:has(:text-is('{name}'))")


def drop(page, *files):
    """Drops files once those before have arrived: meanwhile Quasar takes no other."""
    upload = page.locator(".q-tab-panel:visible .q-uploader").first
    upload.locator(".q-uploader__list:empty").wait_for(state="attached")
    upload.locator("input[type=file]").set_input_files(files)


def says(page, where, words):
    page.locator(where, has_text=words).first.wait_for()


def shows(page, pictures):
    """That many, once the screen before has gone."""
    driver = pytest.importorskip("playwright.sync_api")
    driver.expect(page.locator(PICTURE)).to_have_count(pictures, timeout=30e3)


def status(address, **options):
    try:
        with urlopen(Request(address, **options), timeout=60) as answer:
            return answer.status
    except HTTPError as error:
        return error.code


def test_only_who_has_the_address(address):
    origin, token = address.rstrip("/").rsplit("/", 1)
    assert origin.startswith("http://127.0.0.1:")
    assert status(address) == 200
    assert status(f"{origin}/") == 403
    assert status(f"{origin}/_nicegui_ws/socket.io/?EIO=4&transport=polling") == 403
    assert status(f"{address}_nicegui_ws/socket.io/?EIO=4&transport=polling") == 200
    assert status(address, headers={"Host": "example.org"}) == 403
    assert status(f"{origin}/{token[::-1]}/") == 403
    polling = f"{address}_nicegui_ws/socket.io/?EIO=4&transport=polling"
    assert status(polling, headers={"Origin": "https://example.org"}) == 403
    assert status(polling, headers={"Origin": origin}) == 200


def test_the_browser_is_told_a_file(address, told, chromium):
    """Command lines are readable for every user of the machine, the file for one."""
    page = chromium.new_page()
    for _ in range(200):
        if told.exists() and told.read_text():
            break
        page.wait_for_timeout(50)
    (uri,) = told.read_text().split()
    assert address.rstrip("/").rsplit("/", 1)[1] not in uri
    file = Path(uri.removeprefix("file://"))
    assert file.stat().st_mode & 0o777 == 0o600
    page.goto(uri)
    page.wait_for_url(f"{address}?session=*")
    page.close()


def test_from_files_to_friction(page):
    """On the way each screen is read on a phone and on a small screen, and nothing on it
    is a serious finding of axe-core, such as a contrast that is too low.
    """
    shows(page, 1)
    button(page, "My rubber").click()
    drop(page, SAMPLE / "dma.csv")
    says(page, ".words:visible", "frequency from 2")
    an_isotherm_is_dragged(page)
    tab(page, "Road")
    shows(page, 1)
    drop(page, SAMPLE / "road.csv")
    says(page, ERROR, "Convention of C must be")  # never guessed
    button(page, "Use sample road").click()
    says(page, ".words:visible", "0.8034")
    # a cutoff moves by a key, and the figure with it
    page.locator(".q-slider [tabindex]:visible").nth(1).press("ArrowRight")
    page.locator(".words:visible", has_not_text="0.8034").wait_for()
    tab(page, "Friction")
    page.get_by_label("Nominal pressure p [MPa]").locator("visible=true").press("Enter")
    shows(page, 1)
    page.wait_for_function(POINTED, polling=100)  # value and band of each curve
    drop(page, SAMPLE / "dma.csv")  # is no friction, which takes some words
    says(page, ERROR, "a table with a column of velocity")
    tab(page, "Export")
    with page.expect_download() as download:
        button(page, "Scene (TOML)").click()
    scene = tomllib.loads(download.value.path().read_text(encoding="utf-8"))
    assert scene["material"] == "dma.toml"
    assert scene["surface"]["file"] == "road.csv"
    findings = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()
    for screen in SCREENS:
        tab(page, screen)
        for width in (390, 1280):
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_function(WHOLE, polling=50, timeout=60e3)
        found = findings.run(page, options=AXE).response["violations"]
        assert not [each for each in found if each["impact"] in SERIOUS], screen


def an_isotherm_is_dragged(page):
    """Shift factor and overlap follow; back at the fit all is as it was."""
    x, y = page.evaluate(ISOTHERM, "60 °C")
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 40, y, steps=2)
    page.mouse.up()
    says(page, ".words:visible", re.compile(r"log10 a_T  -(1|2\.[012]).* at 60 °C"))
    button(page, "Back to the fit").click()
    says(page, ".words:visible", "-2.506 at 60 °C")


AXE = {
    "resultTypes": ["violations"],
    "runOnly": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa"],
}
SERIOUS = ("serious", "critical")
DAMAGED = {
    "none.csv": b"",
    "binary.csv": bytes(range(256)) * 40,
    "words.csv": b"no,numbers\nat,all\n",
    "x.xlsx": b"PK\3\4",
}


def test_damaged_files(page, tmp_path):
    """What is wrong is said, and what was computed of another file goes."""
    for name, content in DAMAGED.items():
        (tmp_path / name).write_bytes(content)
    none, *others = (tmp_path / name for name in DAMAGED)
    for screen in ("Friction", "Rubber", "Road"):
        tab(page, screen)
        drop(page, none)
        says(page, ".alert:visible", "'none.csv': it is empty")
    for file in others[:2]:
        drop(page, file)
        says(page, ERROR, file.name)
        assert not page.locator(PICTURE).count()
    button(page, "Use sample road").click()
    page.locator(PICTURE).wait_for()
    assert not page.locator(ERROR).count()
    assert not page.locator(".alert:visible").count()
    tab(page, "Rubber")
    for file in others:
        drop(page, file)
        says(page, ERROR, file.name)
        assert not page.locator(PICTURE).count()


def test_back_is_the_screen_before(page):
    """And an error is scrolled to, with the focus in its field."""
    shown = "[role=tab][aria-selected=true]"
    tab(page, "Rubber")
    tab(page, "Rolling")
    field = page.get_by_label("Load F [N]").locator("visible=true").first
    field.fill("3 smoots")
    page.evaluate("scrollTo(0, 1e5)")
    field.press("Enter")
    says(page, ERROR, "smoots")
    page.wait_for_function(
        "() => { const e = document.activeElement, y = e.getBoundingClientRect().top;"
        " return e.value == '3 smoots' && y > 0 && y < innerHeight; }"
    )
    for before in ("Rubber", "Start"):
        page.go_back()
        says(page, shown, before)
    page.go_forward()
    says(page, shown, "Rubber")


def test_two_tabs(page):
    """They know nothing of each other; one that is loaded again is as it was."""
    with page.context.expect_page() as opened:
        page.evaluate("open(location.pathname)")
    other = opened.value
    tab(page, "Road")
    button(page, "Use sample road").click()
    says(page, ".words:visible", "0.8034")
    tab(other, "Road")
    says(other, ".words:visible", "0.7")
    assert other.url != page.url
    other.close()
    page.reload()
    says(page, ".words:visible", "0.8034")


def test_by_keyboard_alone(page):
    """Each stop has a name and is seen; a result is changed and saved."""
    reach(page, "Change the example")
    page.keyboard.press("Enter")
    shows(page, 1)
    before = page.locator(".number:visible").all_inner_texts()
    reach(page, "Nominal pressure p [MPa]")
    page.keyboard.press("Control+A")
    page.keyboard.type("0.1")
    page.keyboard.press("Enter")
    page.wait_for_function(
        "before => document.querySelectorAll('.number')[5]?.innerText != before",
        arg=before[0],
    )
    reach(page, "Friction", back=True)
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("Enter")
    reach(page, "CSV")
    with page.expect_download() as download:
        page.keyboard.press("Enter")
    assert "pressure" in download.value.path().read_text(encoding="utf-8")


def reach(page, name, back=False):
    """Presses Tab until something of this name has the focus."""
    stops = []
    while name.lower() not in stops:
        assert len(stops) < 80, stops
        page.keyboard.press("Shift+Tab" if back else "Tab")
        if stop := page.evaluate(FOCUSED):
            said, seen = stop
            assert said, stops
            assert seen, said
            stops.append(said.lower())


@pytest.fixture
def walk(address, chromium, place):
    """A page of its own to walk through."""
    page = chromium.new_page(viewport={"width": 1280, "height": 900})
    page.set_default_timeout(30e3)
    page.add_init_script(STILL)
    errors = []
    page.on("pageerror", lambda error: errors.append(error))
    page.goto(address)
    page.locator(".result").nth(4).wait_for()
    yield lambda seed: Walk(page, place, seed)
    page.close()
    assert not errors


@pytest.mark.parametrize("seed", [1])
def test_a_walk(walk, seed):
    walk(seed).steps(25)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 6))
def test_a_long_walk(walk, seed):
    """50 steps each, 200 in all."""
    walk(seed).steps(50)


def test_ports(capsys):
    assert main(["app", "--no-browser", "--port", "70000"]) == 2
    assert "--port must be a free port" in capsys.readouterr().err
