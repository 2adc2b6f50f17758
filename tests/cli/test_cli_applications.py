"""The command line's tables of applications: [heat_build_up], [conveyor], traction, a
rough line that slides.
"""

import os
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from ..refused import mentions
from .cli_application_cases import (
    BAD_BELTS,
    BAD_DRIVES,
    BAD_IMPACTS,
    BAD_ROUGH_SLIDES,
    BAD_WARMINGS,
    BAD_WHEELS,
    BELT,
    DRIVE,
    IMPACT,
    ROUGH_SLIDE,
    WARMING,
    WHEEL,
)
from .cli_cases import MATERIAL, SCENE, arguments

LAW = em.FrictionLaw(
    [0.01, 1.0, 30.0],
    np.array([[[0.5, 0.8, 0.6]], [[0.6, 0.9, 0.7]]]),
    [270.0, 300.0],
    [2e5],
)


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    (tmp_path / "rubber.toml").write_text(MATERIAL)
    (tmp_path / "no-shift.toml").write_text(MATERIAL[: MATERIAL.index("[shift]")])
    law = em.FrictionLaw(LAW.velocity, LAW.mu[:, 0], LAW.temperature)
    law.to_csv(tmp_path / "mu.csv")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    Path("scene.toml").write_text(text)
    return "scene.toml"


def written(capsys, verb: str, scene: str, stem: str, title: str) -> pd.DataFrame:
    """Runs what must succeed, into a new folder: a few lines, one table and one figure;
    returns the table.
    """
    assert main([verb, scene, "--out", "out"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert len(out.splitlines()) <= 7
    assert "\ndoubts " in out
    assert title in Path(f"out/{stem}.csv").read_text()
    assert f"out/{stem}.csv" in out.replace(os.sep, "/")
    assert sorted(p.name for p in Path("out").iterdir() if p.suffix != ".tir") == [
        f"{stem}.csv",
        f"{stem}.png",
    ]
    assert Path(f"out/{stem}.png").read_bytes().startswith(b"\x89PNG")
    return pd.read_csv(f"out/{stem}.csv", comment="#")


def tyre():
    return em.layer(em.load_material("rubber.toml"), 15e-3)


def test_impact(capsys):
    table = written(capsys, "impact", write(IMPACT), "scene-impact", "Bounces")
    found = em.impact(
        em.load_material("rubber.toml"),
        em.Sphere(5e-3),
        velocity=np.geomspace(0.1, 1.0, 2),
        rtol=1e-4,
        mass=np.array([[4e-3], [8e-3]]),
        temperature=np.array([[[273.15]], [[293.15]]]),
    )
    np.testing.assert_allclose(
        table["coefficient of restitution [-]"], found.restitution.ravel(), rtol=1e-12
    )
    np.testing.assert_allclose(
        table["mass [kg]"], np.tile(np.repeat([4e-3, 8e-3], 2), 2), rtol=1e-12
    )


def test_warming(capsys):
    table = written(
        capsys, "rolling", write(WARMING), "scene-heat_build_up", "Warms up"
    )
    warm = em.heat_build_up(
        tyre(),
        em.Cylinder(0.1, 0.05),
        velocity=[1.0, 2.0],
        load=800.0,
        ambient=273.15,
        conductance=20.0,
        hottest=373.15,
        rtol=1e-3,
    )
    np.testing.assert_allclose(table["steady temperature [K]"], warm.steady, rtol=1e-12)


def test_warming_over_time(capsys):
    text = 'capacity = "2 kJ/K"\nduration = "10 min"\npoints = 5\nhottest'
    table = written(
        capsys,
        "rolling",
        write(WARMING, ("hottest", text)),
        "scene-heat_build_up",
        "Warms up",
    )
    np.testing.assert_allclose(table["time [s]"], np.tile(np.linspace(0, 600, 5), 2))
    cold = table["temperature [K]"].to_numpy().reshape(2, 5)
    np.testing.assert_allclose(cold[:, 0], 273.15, atol=1e-9)
    assert (np.diff(cold) > 0).all()


def test_conveyor(capsys):
    table = written(capsys, "rolling", write(BELT), "scene-conveyor", "Belt")
    below, above = (em.layer(em.load_material("rubber.toml"), h) for h in (6e-3, 8e-3))
    carry = em.Idlers(
        below, em.Cylinder(0.08, 0.4), spacing=1.2, shares=[0.2, 0.6, 0.2]
    )
    # as long as three rolls
    back = em.Idlers(above, em.Cylinder(0.08, 1.2), spacing=3.0)
    found = em.conveyor(
        carry,
        back,
        velocity=[1.0, 5.0],
        belt=28.0,
        goods=np.array([[0.0], [120.0]]),
        temperature=np.array([[[273.15]], [[293.15]]]),
    )
    np.testing.assert_allclose(table["power [W/m]"], found.power.ravel(), rtol=1e-12)
    np.testing.assert_allclose(
        table["temperature [K]"], found.temperature.ravel(), rtol=1e-12
    )


@pytest.mark.parametrize("friction", ['"mu.csv"', "0.8"])
def test_traction(capsys, friction):
    table = written(
        capsys,
        "traction",
        write(WHEEL, ('"mu.csv"', friction)),
        "scene-traction",
        "Brakes",
    )
    slip, kelvin = np.geomspace(0.01, 0.9, 5), np.array([273.15, 293.15])[:, None, None]
    found = em.traction(
        em.Foundation(8e7, [], []),
        em.Cylinder(0.3, 0.16),
        velocity=25.0,
        slip=slip,
        temperature=kelvin,
        load=np.array([[2e3], [4e3]]),
        friction=em.load_friction("mu.csv") if "csv" in friction else 0.8,
        tangential=em.springs(em.load_material("rubber.toml"), 8e-3, tangential=True),
        rtol=1e-4,
    )
    np.testing.assert_allclose(
        table["traction coefficient [-]"], found.coefficient.ravel(), rtol=1e-12
    )
    np.testing.assert_allclose(table["slip [-]"], np.tile(slip, 4), rtol=1e-12)
    assert {p.name for p in Path("out").glob("*.tir")} == {
        f"scene-traction-{t}degC.tir" for t in (0, 20)
    }
    found.to_tir("warm.tir", radius=0.3, width=0.16, temperature=293.15)
    assert (
        Path("out/scene-traction-20degC.tir").read_text()
        == Path("warm.tir").read_text()
    )


def test_traction_of_a_ball(capsys):
    wheel = WHEEL[WHEEL.index("[indenter]") : WHEEL.index("[contact]")]
    ball = '[indenter]\nshape = "paraboloid"\nradius = "5 mm"\n\n'
    slip = "slip = { from = 0.01, to = 0.9, points = 5 }"
    scene = write(
        WHEEL,
        (wheel, ball),
        ('"mu.csv"', "0.5"),
        (slip, "creepage = [0.01, 0.1]"),
        ('load = ["2 kN", "4 kN"]', 'load = "5 N"'),
    )
    table = written(capsys, "traction", scene, "scene-traction", "Brakes")
    found = em.traction(
        em.load_material("rubber.toml"),
        em.Paraboloid(5e-3),
        velocity=25,
        creepage=[0.01, 0.1],
        load=5,
        friction=0.5,
        temperature=np.array([[273.15], [293.15]]),
        rtol=1e-4,
    )
    np.testing.assert_allclose(
        table["tractive force [N]"], found.force.ravel(), rtol=1e-12
    )
    assert not list(Path("out").glob("*.tir"))  # a ball is no tyre


LEAK = """
title = "Leaks"
material = "rubber.toml"
temperature = "20 degC"

[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.5
longest = "200 um"
shortest = "10 um"

[leak]
pressure = { from = "20 kPa", to = "80 kPa", points = 3 }
pressure_drop = "0.1 bar"
viscosity = "50 mPa s"
density = "0.87 g/cm^3"
length = "1 mm"
width = "0.1 m"
time = ["1 s", "1 day"]
model = "critical constriction"
"""


def test_leak(capsys):
    table = written(capsys, "leak", write(LEAK), "scene-leak", "Leaks")
    found = em.leak(
        em.load_material("rubber.toml"),
        em.SelfAffine(
            0.8, rms_slope=0.5, q_low=2 * np.pi / 2e-4, q_high=2 * np.pi / 1e-5
        ),
        pressure=[2e4, 4e4, 8e4],
        pressure_drop=1e4,
        viscosity=0.05,
        density=870,
        length=1e-3,
        width=0.1,
        time=[[1.0], [86400.0]],
        temperature=293.15,
        model=em.CriticalConstriction(),
    )
    assert found.percolates.any()
    np.testing.assert_allclose(
        table["mass leak rate [kg/s]"], found.mass_rate.ravel(), rtol=1e-12
    )


def test_rough_slide(capsys):
    table = written(
        capsys, "slide", write(ROUGH_SLIDE), "scene-slide", "Started on a rough line"
    )
    surface = em.SelfAffine(
        0.8, rms_slope=0.3, q_low=2 * np.pi / 1e-4, q_high=2 * np.pi / 25e-6
    )
    load = 5e5 * surface.full_contact_length
    np.testing.assert_allclose(table["normal force [N/m]"], load, rtol=1e-9)
    history = arguments("slide", "scene.toml")
    again = em.slide(
        em.load_material("rubber.toml"),
        surface.line(seed=2, samples=64),
        temperature=293.15,
        rtol=5e-2,
        **{k: history[k] for k in ("time", "position", "load")},
    )
    # Its wavelengths come out of their units with another last digit, by which an
    # element meets the line a step later.
    np.testing.assert_allclose(
        table["friction coefficient [-]"], again.mu, atol=1e-3 * again.mu.max()
    )
    rule = arguments(
        "slide", write(ROUGH_SLIDE, ('equivalent_length = "full contact"\n', ""))
    )["load"]
    np.testing.assert_allclose(rule, 5e5 * 1e-4, rtol=1e-12)  # p times the longest wave
    per_length = arguments(
        "slide", write(ROUGH_SLIDE, ('pressure = "0.5 MPa"', 'load = "3 N/m"'))
    )["load"]
    np.testing.assert_array_equal(per_length, 3.0)


def test_drive(capsys):
    table = written(
        capsys, "slide", write(DRIVE), "scene-drive", "Started on a rough line"
    )
    history = arguments("slide", "scene.toml")
    part = float(history["load"][0]) / 10.0
    surface = em.SelfAffine(
        0.8, rms_slope=0.3, q_low=2 * np.pi / 1e-4, q_high=2 * np.pi / 25e-6
    )
    given = {k: history[k] for k in ("time", "position", "load", "temperature", "rtol")}
    line = surface.line(seed=2, samples=64)
    again = em.drive(
        em.load_material("rubber.toml"),
        line,
        tangential=em.Mount(part, 1e3 * part),
        **given,
    )
    np.testing.assert_allclose(
        table["pull of the drive [N/m]"], again.pull, atol=1e-3 * again.pull.max()
    )
    assert mentions(again.summary(), "drive's", "last fifth")


def test_zero_where_nothing_is_something():
    """A drive without a damper, or without a spring, is a drive."""
    scene = write(DRIVE, ("stiffness =", 'damping = "0 N*s/m"\nstiffness ='))
    mount = arguments("slide", scene)["tangential"]
    assert mount.damping == 0.0
    damper = ('stiffness = "1 kN/m"', 'damping = "2 kN*s/m"\nstiffness = "0 N/m"')
    mount = arguments("slide", write(DRIVE, damper))["tangential"]
    assert mount.stiffness == 0.0


CASES = {
    **{
        f"impact: {name}": ("impact", IMPACT, *case)
        for name, case in BAD_IMPACTS.items()
    },
    **{
        f"heat_build_up: {name}": ("rolling", WARMING, *case)
        for name, case in BAD_WARMINGS.items()
    },
    **{f"belt: {name}": ("rolling", BELT, *case) for name, case in BAD_BELTS.items()},
    **{
        f"traction: {name}": ("traction", WHEEL, *case)
        for name, case in BAD_WHEELS.items()
    },
    **{f"drive: {name}": ("slide", DRIVE, *case) for name, case in BAD_DRIVES.items()},
    **{
        f"slide: {name}": ("slide", ROUGH_SLIDE, *case)
        for name, case in BAD_ROUGH_SLIDES.items()
    },
    "leak without an oil": (
        "leak",
        LEAK,
        ('viscosity = "50 mPa s"\n', ""),
        "viscosity",
    ),
    "leak of a kinematic viscosity": (
        "leak",
        LEAK,
        ("50 mPa s", "46 cSt"),
        "[leak] viscosity must be a dynamic viscosity",
    ),
    "leak of an open seal": (
        "leak",
        LEAK,
        ("0.1 bar", "1 bar"),
        "the seal opens",
    ),
    "leak to a tolerance": (
        "leak",
        LEAK,
        ("[leak]", "[numerics]\nrtol = 1e-3\n[leak]"),
        "numerics must be left out",
    ),
    "friction of a warming": (
        "friction",
        WARMING,
        ("Warms", "Warms"),
        "belongs to elastomdr rolling",
    ),
    "plan of a belt": (
        "plan",
        BELT,
        ("Belt", "Belt"),
        "[conveyor] must be left out of a scene",
    ),
    "traction of a slider": ("traction", SCENE, ("Slider", "Slider"), "slip"),
    "rolling of a wheel that brakes": (
        "rolling",
        WHEEL,
        ("Brakes", "Brakes"),
        "friction must be left out of a scene",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_refuses(capsys, name):
    verb, text, change, message = CASES[name]
    scene = write(text, change)
    before = set(Path().iterdir())
    assert main([verb, scene]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("elastomdr: error: scene.toml: ")
    assert err.count("\n") == 1
    assert re.search(re.escape(message), err), err
    assert set(Path().iterdir()) == before
