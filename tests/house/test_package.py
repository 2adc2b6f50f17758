"""What is written about the package in several places agrees; what a wheel has to carry
is there.
"""

import re
import tomllib
from pathlib import Path

import elastomdr as em

ROOT = Path(__file__).parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def words(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def test_one_version_and_licence():
    version = PROJECT["project"]["version"]
    assert em.__version__ == version
    assert f"version: {version}\n" in words("CITATION.cff")
    assert f"## [{version}]" in words("CHANGELOG.md")
    assert PROJECT["project"]["license"] == "MIT"
    assert "license: MIT\n" in words("CITATION.cff")
    assert words("LICENSE").startswith("MIT License")


def test_classifiers_agree_with_what_is_required():
    named = [
        c
        for c in PROJECT["project"]["classifiers"]
        if re.search(r"Python :: 3\.\d+$", c)
    ]
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    assert named[0].endswith(oldest)
    assert "Typing :: Typed" in PROJECT["project"]["classifiers"]
    assert (ROOT / "src" / "elastomdr" / "py.typed").exists()


def test_every_extra_is_explained():
    listed = words("docs/tour.md").split("## Install")[1].split("##")[0]
    assert set(re.findall(r"`(\w+)`:", listed)) >= set(
        PROJECT["project"]["optional-dependencies"]
    ) - {"cluster"}


def test_wheel_carries_materials_and_scenes_to_start_from():
    wheel = PROJECT["tool"]["hatch"]["build"]["targets"]["wheel"]
    assert wheel["force-include"]["materials"] == "elastomdr/material/data"
    assert all((ROOT / source).exists() for source in wheel["force-include"])
    assert {path.stem for path in (ROOT / "materials").glob("*.toml")} <= set(
        em.materials()
    )
    assert list((ROOT / "src" / "elastomdr" / "cli" / "templates").glob("*.toml"))
