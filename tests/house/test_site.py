"""The documentation site builds without a warning, holds every page and example,
fetches nothing from elsewhere, and is read in a browser without a part that is cut.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from elastomdr.cli.keys import sections
from elastomdr.cli.kinds import KINDS

ROOT = Path(__file__).parents[2]
QUIET = {"NO_COLOR": "1", "NO_MKDOCS_2_WARNING": "1"}
# Elements that reach beyond the window, and lie in nothing that scrolls.
CUT = """[...document.querySelectorAll('.md-header *, .md-main *, .md-footer *')].filter(e => {
    const box = e.getBoundingClientRect();
    if (!box.width || box.right <= document.documentElement.clientWidth + 1) return false;
    if (e.closest('svg') || !e.checkVisibility()) return false;
    for (let p = e; p; p = p.parentElement) if (/auto|scroll/.test(getComputedStyle(p).overflowX)) return false;
    return true;
}).map(e => e.tagName + '.' + e.className + ': ' + e.textContent.slice(0, 60)).slice(0, 5)"""
COLOURS = (
    "[...document.querySelectorAll('.highlight code span')].map(e => "
    "getComputedStyle(e).color)"
)
WIDE = "document.documentElement.scrollWidth > document.documentElement.clientWidth"


@pytest.fixture
def page(chromium):
    errors = []
    page = chromium.new_page()
    page.on("pageerror", lambda error: errors.append(error))
    yield page
    page.close()
    assert not errors


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    for package in ("mkdocs", "material", "mkdocstrings", "math_core"):
        pytest.importorskip(package)
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "mkdocs",
        "build",
        "--strict",
        "--site-dir",
        str(folder),
    ]
    built = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, **QUIET}
    )
    assert built.returncode == 0, built.stdout + built.stderr
    assert "WARNING" not in built.stderr
    return folder


def test_every_page_is_there(site):
    pages = {path.stem for path in (ROOT / "docs").glob("*.md")}
    examples = {
        path.relative_to(ROOT).with_suffix("")
        for path in (ROOT / "examples").rglob("[0-9][0-9]_*.py")
    }
    assert len(examples) > 20
    for page in [
        *pages,
        *examples,
        "api/index",
        "benchmarks",
        "robustness",
        "materials",
        "contributing",
        "changelog",
    ]:
        assert (site / f"{page}.html").stat().st_size > 2000, page


def test_every_key_of_a_scene_is_on_its_page(site):
    text = (site / "scenes.html").read_text(encoding="utf-8")
    kinds = [kind for verb in KINDS.values() for kind in verb]
    for kind in kinds:
        for section in sections(kind):
            for key in section.keys:
                assert f"<code>{key.name}</code>" in text, key.name


def test_what_the_pages_show(site):
    index = (site / "api" / "index.html").read_text(encoding="utf-8")
    for name in (
        "friction.friction",
        "prony.Prony",
        "master.master_curve",
        "surface.read_surface",
        "half_space_sliding",
    ):
        assert re.search(rf'href="[\w-]+\.html#elastomdr\.[\w.]*{name}"', index), name
    pages = [page.read_text(encoding="utf-8") for page in (site / "api").glob("*.html")]
    # tables of arguments
    assert sum(page.count("<span>DESCRIPTION</span>") for page in pages) > 100
    # and of the fields of results
    assert sum(page.count(">ATTRIBUTE<") for page in pages) > 15
    assert not any("Args:" in page for page in pages)
    theory = (site / "theory.html").read_text(encoding="utf-8")
    assert theory.count("<math") > 200
    assert "arithmatex" not in theory
    rough = (site / "rough.html").read_text(encoding="utf-8")
    assert "figures/28_measured_rubber_on_a_road.png" in rough
    assert (site / "figures" / "28_measured_rubber_on_a_road.png").exists()
    assert "MISSED" not in rough
    bench = (site / "benchmarks.html").read_text(encoding="utf-8")
    for image in re.findall(r'<img[^>]*src="([^"]+)"', bench):
        assert (site / image).exists(), image
    gallery = (site / "examples" / "index.html").read_text(encoding="utf-8")
    cards = re.findall(r'<li>\s*<p><a href="([^"]+)"><img[^>]*src="([^"]+)"', gallery)
    assert len(cards) == len(
        [
            *(ROOT / "examples").rglob("[0-9]*_*.py"),
            *(ROOT / "examples").rglob("*.ipynb"),
        ]
    )
    assert all((site / "examples" / link).exists() for card in cards for link in card)


def test_titles_of_examples_are_whole_sentences(site):
    """Where the docstring is wrapped, too: the page goes on with the next sentence."""
    page = (site / "examples" / "27_seal_drive.html").read_text(encoding="utf-8")
    title, first = re.search(r"<h1[^>]*>(.*?)</h1>\s*<p>(.*?)\s", page).groups()
    assert title.startswith("Does the drive of a dry seal stick and slip?")
    assert first == "A"
    for path in (ROOT / "examples").rglob("[0-9][0-9]_*.py"):
        made = site / path.relative_to(ROOT).with_suffix(".html")
        text = made.read_text(encoding="utf-8")
        (opening,) = re.findall(r"<h1[^>]*>.*?</h1>\s*<p>(\w+)", text)
        assert opening[0].isupper(), path.name  # not the rest of a broken sentence


def test_sections_are_numbered_in_order(site):
    numbered = 0
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8").split("md-content", 1)[1]
        sections = [(0, 0)]
        for level, number in re.findall(
            r'<h([23]) id="[^"]*">(\d+(?:\.\d+)?)\.? ', text
        ):
            above, below = sections[-1]
            assert number == (
                f"{above + 1}" if level == "2" else f"{above}.{below + 1}"
            ), page
            sections.append((above + 1, 0) if level == "2" else (above, below + 1))
        numbered += len(sections) > 5
    assert numbered >= 1


def test_nothing_is_fetched_from_elsewhere(site):
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(
            r'<(?:script|img|link)[^>]*(?:src|href)="(?:https?:)?//', text
        ), page


def test_nothing_is_cut(site, page):
    """On a phone and on a small screen, opened from files."""
    # one example
    files = [
        file
        for file in sorted(site.rglob("*.html"))
        if not re.match(r"(?!20)\d\d_", file.name)
    ]
    assert len(files) > 40
    for file in files:
        page.goto(file.as_uri())
        for width in (390, 1280):
            page.set_viewport_size({"width": width, "height": 900})
            page.wait_for_function(
                f"!({WIDE}) && !{CUT}.length", polling=50, timeout=10e3
            )


def test_search_and_code(site, page):
    page.goto((site / "tour.html").as_uri())
    buttons = "document.querySelectorAll('.highlight button[title^=Copy]').length"
    page.wait_for_function(
        f"{buttons} > 5 && {buttons} == document.querySelectorAll('.highlight "
        "pre').length"
    )
    assert page.evaluate(f"new Set({COLOURS}).size") > 4
    page.locator(".md-search__input").fill("squeezed cord")
    page.wait_for_selector(".md-search-result__link[href*=o_ring]", state="attached")
