"""Errors are data: of every `InputError` the argument as it was typed, the value, what
is accepted.
"""

import ast
import inspect
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.compute import run as compute
from elastomdr.cli.main import _parser
from elastomdr.units.registry import registry

SOURCE = Path(em.__file__).parent
REQUIRED = {"argument", "accepted"}
KEYWORDS = REQUIRED | {"got", "hint"}

BALL = em.Sphere(5e-3)
SOFT = em.StandardSolid(1e6, 4e6, 1e-2, name="soft")
WARM = em.Prony(1e6, [2e6], [1e-2], shift=em.WLF(8.86, 101.6, 293.15), name="warm")
LIQUID = em.Prony(0.0, [2e6], [1e-2])
ROAD = em.SelfAffine(0.8, rms_slope=0.1, q_low=1e3, q_high=1e6)
TIME = np.linspace(0.0, 1.0, 5)
T, F = [293.15] * 4, [1.0, 2.0, 4.0, 8.0]
NAN = float("nan")


def friction(material=SOFT, shape=BALL, **changes):
    return em.friction(material, shape, **{"velocity": 1.0, "load": 1.0} | changes)


def on_road(material=SOFT, **changes):
    return em.friction(material, ROAD, **{"velocity": 1.0, "pressure": 1e5} | changes)


def impact(**changes):
    return em.impact(SOFT, BALL, **{"mass": 0.01, "velocity": 1.0} | changes)


def indent(**changes):
    return em.indent(SOFT, BALL, **{"time": TIME, "depth": 1e-4 * TIME} | changes)


def slide(**changes):
    given = {"time": TIME, "position": 1e-3 * TIME, "load": 1.0}
    return em.slide(SOFT, BALL, **given | changes)


def o_ring(material=SOFT, **changes):
    return em.o_ring(material, **{"diameter": 3e-3, "squeeze": 0.2} | changes)


def leak(**changes):
    given = {
        "pressure": 1e6,
        "length": 1e-3,
        "pressure_drop": 1e5,
        "viscosity": 1e-3,
    }
    return em.leak(SOFT, ROAD, **given | changes)


CALLS = {
    # verb, wrong changes, argument, value
    "wrong sign": (friction, {"velocity": -1.0}, "velocity", -1.0),
    "wrong type": (friction, {"velocity": "fast"}, "velocity", "fast"),
    "missing": (friction, {"velocity": None}, "velocity", None),
    "neither": (friction, {"load": None}, "load", None),
    "both": (friction, {"depth": 1e-4}, "depth", 1e-4),
    "not a number": (friction, {"load": NAN}, "load", NAN),
    "shapes": (
        friction,
        {"velocity": [1.0, 2.0], "load": [1.0, 2.0, 3.0]},
        "load",
        [1.0, 2.0, 3.0],
    ),
    "empty": (friction, {"velocity": []}, "velocity", []),
    "complex": (friction, {"velocity": 1j}, "velocity", 1j),
    "a flag": (friction, {"velocity": True}, "velocity", True),
    "wrong unit": (
        friction,
        {"velocity": registry().Quantity(1.0, "N")},
        "velocity",
        ...,
    ),
    "one bad material": (
        friction,
        {"material": [SOFT, "rubber"]},
        "material[1]",
        "rubber",
    ),
    "no materials": (friction, {"material": []}, "material", []),
    "no shift law": (friction, {"temperature": 300.0}, "temperature", 300.0),
    "celsius": (friction, {"material": WARM, "temperature": 20.0}, "temperature", 20.0),
    "at the pole": (
        friction,
        {"material": WARM, "temperature": 150.0},
        "temperature",
        150.0,
    ),
    "unknown model": (friction, {"model": "lines"}, "model", "lines"),
    "model of a road": (friction, {"model": em.Persson()}, "model", em.Persson()),
    "no model": (friction, {"model": 3}, "model", 3),
    "tolerance": (friction, {"rtol": 1.0}, "rtol", 1.0),
    "heat of a ball": (friction, {"heat": em.Heat(0.2, 2e6)}, "heat", ...),
    "direction of a ball": (friction, {"direction": 0.1}, "direction", 0.1),
    "pressure on a ball": (friction, {"pressure": 1e5}, "pressure", 1e5),
    "no shape": (friction, {"shape": "ball"}, "shape", "ball"),
    "a punch": (friction, {"shape": em.FlatPunch(1e-3)}, "shape", ...),
    "a liquid": (on_road, {"material": LIQUID}, "material", ...),
    "branch of a road": (on_road, {"branch": "warm"}, "branch", "warm"),
    "no pressure": (on_road, {"pressure": -1.0}, "pressure", -1.0),
    "heat without temperature": (on_road, {"heat": em.Heat(0.2, 2e6)}, ..., ...),
    "rolling": (
        lambda **given: em.rolling(SOFT, BALL, **given),
        {"velocity": 1.0, "load": "heavy"},
        "load",
        "heavy",
    ),
    "mass": (impact, {"mass": 0.0}, "mass", 0.0),
    "speed": (impact, {"velocity": NAN}, "velocity", NAN),
    "temperature of an impact": (impact, {"temperature": 300.0}, "temperature", 300.0),
    "history": (indent, {"time": TIME[::-1]}, "time", ...),
    "length of a history": (indent, {"depth": [0.0, 1e-4]}, "depth", ...),
    "without history": (indent, {"depth": None}, "load", None),
    "way": (slide, {"position": TIME[:3]}, "position", ...),
    "way with both": (slide, {"depth": 1e-4}, "depth", 1e-4),
    "cord": (o_ring, {"diameter": -1.0}, "diameter", -1.0),
    "rubber of a ring": (o_ring, {"material": "nbr"}, "material", "nbr"),
    "viscosity": (leak, {"viscosity": -1.0}, "viscosity", -1.0),
    "length of a leak": (leak, {"length": None}, "length", None),
    "radius": (em.Sphere, {"radius": 0.0}, "radius", 0.0),
    "spectrum": (
        em.SelfAffine,
        {
            "hurst": 0.8,
            "rms_slope": 0.1,
            "rms_height": 1e-6,
            "q_low": 1e3,
            "q_high": 1e6,
        },
        "rms_height",
        1e-6,
    ),
    "times": (
        em.Prony,
        {"equilibrium": 1e6, "moduli": [1e6], "times": [1.0, 2.0]},
        "times",
        [1.0, 2.0],
    ),
    "poisson": (
        em.Prony,
        {"equilibrium": 1e6, "moduli": [], "times": [], "poisson": 0.6},
        "poisson",
        0.6,
    ),
    "no such material": (
        em.load_material,
        {"name_or_path": "unobtainium"},
        "name_or_path",
        "unobtainium",
    ),
    "no such data": (em.read_dma, {"path_or_paths": "no.csv"}, "path_or_paths", ...),
    "no such scan": (
        em.read_surface,
        {"path_or_heights": "no.csv"},
        "path_or_heights",
        ...,
    ),
    "no such points": (em.read_friction, {"path": "no.csv"}, "path", ...),
    "no such spectrum": (
        em.read_spectrum,
        {"path": "no.csv", "convention": "2d"},
        "path",
        ...,
    ),
    "fit of a number": (em.fit.material, {"dma": 3}, "dma", 3),
    "moduli": (
        em.fit.prony,
        {"omega": F, "storage": [1e6] * 4, "loss": [-1.0] * 4},
        "loss",
        -1.0,
    ),
    "points of friction": (
        em.fit.friction_master,
        {"velocity": F, "temperature": T[:3], "mu": [0.5] * 4},
        "temperature",
        ...,
    ),
}


def raises() -> list[tuple[str, set[str]]]:
    """Where an `InputError` is made, and the keywords that it gets."""
    found = []
    for path in sorted(SOURCE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Call) and "InputError" in (
                getattr(node.func, "id", ""),
                getattr(node.func, "attr", ""),
            ):
                words = {word.arg or "" for word in node.keywords}
                positional = {f"position {i}" for i in range(len(node.args))}
                where = f"{path.relative_to(SOURCE).as_posix()}:{node.lineno}"
                found.append((where, words | positional))
    return found


def test_every_error_names_argument_and_what_is_accepted():
    every = raises()
    assert len(every) > 600
    assert not [place for place, words in every if not REQUIRED <= words <= KEYWORDS]


@pytest.mark.parametrize("case", CALLS)
def test_a_wrong_call_names_argument_value_and_what_is_accepted(case):
    call, changes, argument, value = CALLS[case]
    with pytest.raises(em.InputError) as caught:
        call(**changes)
    error = caught.value
    if argument is not ...:
        assert error.argument == argument, str(error)
    if argument in inspect.signature(call).parameters:
        assert argument in changes
    if value is not ...:
        np.testing.assert_equal(error.got, value)
    assert error.accepted
    said = str(error)
    assert said.startswith(error.subject)
    assert f" must be {error.accepted}" in said


READERS = {
    "path_or_paths": em.read_dma,
    "path_or_heights": em.read_surface,
    "path": em.read_friction,
    "name_or_path": em.load_material,
}


@pytest.mark.parametrize("argument", READERS)
@pytest.mark.parametrize("content", [None, "a", "a,b\n1,2\n", "\0"])
def test_a_wrong_file_is_named_as_typed(argument, content, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("data").mkdir()
    if content is not None:
        Path("data/wrong.csv").write_text(content)
    # SurfaceTopography, which is asked of some files, takes seconds to begin
    ways = {"a": [str], "\0": [Path]}.get(content, [str, Path])
    for typed in (way("data/wrong.csv") for way in ways):
        with pytest.raises(em.InputError) as caught:
            READERS[argument](typed)
        error = caught.value
        if error.argument == argument:
            assert str(error.got) == str(typed)
        else:  # what the file does not say
            assert (argument, error.argument) == ("path_or_heights", "unit")
    with pytest.raises(em.InputError) as caught:
        em.read_dma(["data/wrong.csv"])
    assert caught.value.got == "data/wrong.csv"


SCENE = """
material = "rubber.toml"
temperature = "20 degC"

[indenter]
shape = "sphere"
radius = "5 mm"

[contact]
velocity = "1 m/s"
load = "1 N"
"""
SCENES = {
    "misspelt key": ("load =", "laod =", "[contact] laod", "laod"),
    "wrong value": ('"1 N"', '"1 m"', "[contact] load", "1 m"),
    "wrong sign": ('"1 m/s"', '"-1 m/s"', "[contact] velocity", "-1 m/s"),
    "missing key": ('radius = "5 mm"', "", "[indenter] radius", None),
    "both": ("load =", 'depth = "1 mm"\nload =', "[contact] depth", ...),
    "unknown model": ("load =", 'model = "lines"\nload =', "[contact] model", "lines"),
    "unknown shape": ('"sphere"', '"ball"', "[indenter] shape", "ball"),
    "missing file": ("rubber.toml", "no.toml", "material", ...),
    "heat of a ball": (
        "[contact]",
        '[heat]\nconductivity = "0.2 W/(m K)"\ncapacity = "2 MJ/(m^3 K)"\n[contact]',
        ...,
        ...,
    ),
}


@pytest.mark.parametrize("case", SCENES)
def test_a_wrong_scene_names_table_and_key(case, tmp_path):
    old, new, argument, value = SCENES[case]
    em.save_material(WARM, tmp_path / "rubber.toml")
    (tmp_path / "scene.toml").write_text(SCENE.replace(old, new))
    options = _parser().parse_args(
        ["friction", str(tmp_path / "scene.toml"), "--out", str(tmp_path)]
    )
    with pytest.raises(em.InputError) as caught:
        compute(options)
    error = caught.value
    if argument is not ...:
        assert error.argument == argument, str(error)
    if value is not ...:
        assert error.got == value
    assert error.accepted
    assert str(error).startswith("scene.toml: ")
