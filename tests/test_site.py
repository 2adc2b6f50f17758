"""The documentation site builds without a warning, holds every page and example, and fetches nothing from elsewhere."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    for package in ("mkdocs", "mkdocstrings", "latex2mathml"):
        pytest.importorskip(package)
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    built = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, "NO_COLOR": "1"})
    assert built.returncode == 0, built.stdout + built.stderr
    assert "WARNING" not in built.stderr
    return folder


def test_every_page_is_there(site):
    pages = {path.stem for path in (ROOT / "docs").glob("*.md")}
    examples = {path.relative_to(ROOT).with_suffix("") for path in (ROOT / "examples").rglob("[0-9][0-9]_*.py")}
    assert len(examples) > 20
    for page in [*pages, *examples, "api", "benchmarks", "robustness", "materials", "contributing", "changelog"]:
        assert (site / page / "index.html").stat().st_size > 2000, page


def test_what_the_pages_show(site):
    friction = (site / "api" / "index.html").read_text(encoding="utf-8")
    for name in ("friction.friction", "prony.Prony", "surface.read_surface", "half_space_sliding"):
        assert name in friction
    assert friction.count("<th>Argument</th>") >= 10
    assert "Args:" not in friction
    theory = (site / "theory" / "index.html").read_text(encoding="utf-8")
    assert theory.count("<math") > 200
    assert "arithmatex" not in theory
    rough = (site / "rough" / "index.html").read_text(encoding="utf-8")
    assert "../figures/28_measured_rubber_on_a_road.png" in rough
    assert (site / "figures" / "28_measured_rubber_on_a_road.png").exists()
    assert "MISSED" not in rough
    bench = (site / "benchmarks" / "index.html").read_text(encoding="utf-8")
    for image in re.findall(r'<img[^>]*src="([^"]+)"', bench):
        assert (site / "benchmarks" / image).resolve().exists(), image


def test_nothing_is_fetched_from_elsewhere(site):
    for page in site.rglob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r'<(?:script|img|link)[^>]*(?:src|href)="(?:https?:)?//', text), page
