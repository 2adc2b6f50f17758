"""Mistakes that users make: each is met by a message that says what to write. Scenes to
start from, and stick-slip.
"""

from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.init import kinds
from elastomdr.cli.main import main

from ..refused import mentions, refused, warned

SCENE = """
material = "tread-passenger-synthetic"
temperature = "20 degC"
[indenter]
shape = "sphere"
radius = "5 mm"
[contact]
load = "10 N"
velocity = "1 mm/s"
"""
SCENES = Path(__file__).parents[2] / "examples" / "scenes"
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
RUBBER, BALL = em.StandardSolid(1e6, 1e6, 1e-2), em.Sphere(5e-3)


@pytest.fixture(autouse=True)
def _in_its_own_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


MISTAKES = {
    "C": (
        '"20 degC"',
        '"20 C"',
        'temperature must be a temperature, got "20 C": write "20 degC".',
    ),
    "Fahrenheit": ('"20 degC"', '"68 F"', 'write "68 degF"'),
    "20": ('"20 degC"', "20", 'got 20. Did you mean "20 degC"?'),
    "20 in quotes": (
        '"20 degC"',
        '"20"',
        'got "20". Did you mean "20 degC"?',
    ),
    "comma": (
        '"10 N"',
        '"10,5 N"',
        'load must be a number with a decimal point, not a comma, got "10,5 N": write "10.5 N".',
    ),
    "point and comma": ('"10 N"', '"1.000,5 N"', 'write "1000.5 N"'),
    "5": ('"5 mm"', "5", 'Did you mean "5 mm"?'),
    "pressure": (
        'load = "10 N"',
        'pressure = "0.3 MPa"',
        "pressed on with a load or a depth",
    ),
    "file": (
        '"tread-passenger-synthetic"',
        '"compond.toml"',
        "Did you mean 'compound.toml'? Looked for in ",
    ),
    "name": (
        '"tread-passenger-synthetic"',
        '"tread-pasenger"',
        "Did you mean 'tread-passenger-synthetic'?",
    ),
    "no name": (
        '"tread-passenger-synthetic"',
        '"compound"',
        '"compound.toml" beside the scene',
    ),
}


@pytest.mark.parametrize("case", MISTAKES)
def test_scenes(case, capsys):
    right, wrong, said = MISTAKES[case]
    em.save_material(em.load_material("nbr-linder"), "compound.toml")
    Path("compond-scene.toml").write_text(SCENE.replace(right, wrong))
    assert main(["friction", "compond-scene.toml"]) == 2
    assert said in capsys.readouterr().err
    assert list(Path().glob("*.csv")) == []


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
# liquids
@pytest.mark.parametrize(
    "name", [name for name in em.materials() if "polyisoprene" not in name]
)
@pytest.mark.parametrize("slope", [0.05, 1.0])
def test_pressure_in_megapascals(name, slope):
    road = em.SelfAffine(0.8, rms_slope=slope, q_low=1e3, q_high=1e5)
    with warned(em.ModelWarning, 0.3, 300000):
        found = em.friction(em.load_material(name), road, velocity=0.01, pressure=0.3)
    assert found.converged


def test_a_small_pressure_is_computed():
    """A small number is no unit: in light contact mu hardly depends on the pressure."""
    soft = em.StandardSolid(2e4, 2e5, 1e-3)
    with warned(em.ModelWarning, 1.06, 3e-05):
        low = em.friction(soft, ROAD, velocity=0.01, pressure=1.06)
    high = em.friction(soft, ROAD, velocity=0.01, pressure=10.6)
    assert low.mu == pytest.approx(float(high.mu), rel=0.1)


@pytest.mark.parametrize("shape", [ROAD, em.Sphere(5e-3)], ids=["road", "ball"])
def test_temperature_in_celsius(shape):
    rubber = em.load_material("tread-passenger-synthetic")
    force = {"pressure": 3e5} if shape is ROAD else {"load": 1.0}
    with refused("temperature", 20, 293.15):
        em.friction(rubber, shape, velocity=0.01, temperature=20, **force)


@pytest.mark.parametrize("shape", [em.Sphere(5), em.Paraboloid(5)])
@pytest.mark.parametrize("verb", ["friction", "rolling", "indent", "impact"])
def test_radius_in_millimetres(shape, verb):
    given = {
        "indent": {"time": [0.0, 1.0], "load": 1.0},
        "impact": {"mass": 1.0, "velocity": 1.0},
    }.get(verb, {"velocity": 0.01, "load": 1.0})
    rubber = em.StandardSolid(1e6, 1e6, 1e-2)
    with warned(em.ModelWarning, 5, 0.005, '"5 mm"'):
        getattr(em, verb)(rubber, shape, **given)


def test_radius_in_a_scene(capsys):
    Path("ball.toml").write_text(SCENE.replace('"5 mm"', '"5 m"'))
    assert main(["friction", "ball.toml"]) == 0
    assert mentions(capsys.readouterr().err, "warning", "radius of the sphere", 5)


def test_material_that_is_not_there():
    em.save_material(em.load_material("nbr-linder"), "compound.toml")
    Path("compond-notes.toml").write_text("title = 'no material'")
    with refused("", "'compound.toml'", "Did you mean"):
        em.load_material("compond.toml")
    with refused("", "'nbr-linder'", "Did you mean"):
        em.load_material("nbr-lindner.toml")
    with refused("", "'nbr-linder'", "elastomdr materials"):
        em.load_material("nbr_linder")


def test_pressure_on_a_ball():
    with refused("pressure", 300000, "load"):
        em.friction(
            em.load_material("nbr-linder"), em.Sphere(5e-3), velocity=0.01, pressure=3e5
        )


def test_moduli_exchanged():
    f, kelvin = np.geomspace(0.1, 100, 8), np.linspace(253.15, 293.15, 5)
    law = em.WLF(8.9, 101.6, 293.15)
    rubber = em.Prony(
        1e6, np.full(8, 3e7), np.geomspace(1e-7, 1, 8), kind="tensile", shift=law
    )
    omega, t = (x.ravel() for x in np.meshgrid(2 * np.pi * f, kelvin))
    reduced = omega * law.a(t)
    dma = em.fit.dma(
        omega, rubber.loss(reduced), rubber.storage(reduced), t, kind="tensile"
    )
    with refused("dma", "exchanged"):
        em.fit.master_curve(dma, 293.15)


@pytest.mark.parametrize("kind", kinds())
def test_scenes_to_start_from(kind, capsys):
    assert main(["init", "mine.toml", "--kind", kind]) == 0
    command = capsys.readouterr().out.splitlines()[-1].split()
    assert command[0] == "elastomdr"
    assert command[2] == "mine.toml"
    assert f"#   {' '.join(command)}\n" in Path("mine.toml").read_text()
    # what a command names: head and every second point
    lines = (SCENES / "measured_friction.csv").read_text().splitlines(keepends=True)
    Path("rig.csv").write_text("".join(lines[:3] + lines[3::2]))
    assert main(command[1:]) == 0
    assert "not converged" not in capsys.readouterr().out
    assert main(["init", "mine.toml"]) == 2
    assert "this one exists" in capsys.readouterr().err


def test_scene_to_start_from_by_its_own_name(capsys):
    assert main(["init"]) == 0
    assert "slider.toml" in capsys.readouterr().out
    assert main(["init", "mine.txt"]) == 2
    assert "ends in .toml" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("swing", "said"),
    [(0.0, "no: "), (0.3, "no: "), (0.7, "not decided: "), (1.0, "yes: ")],
)
def test_stick_slip_of_a_motion(swing, said):
    """A body driven at 1 mm/s whose velocity is 1 - s sin, or, for s = 1, stands and
    jumps.
    """
    time = np.linspace(0, 10, 2001)
    wave = np.sin(2 * np.pi * time)
    velocity = 1e-3 * (1 + swing * wave if swing < 1 else np.maximum(np.pi * wave, 0))
    found = _motion(time, velocity, friction=2.0 + wave, normal=10.0)
    assert found.stick_slip().startswith(said)
    assert found.stick_slip().endswith("friction 1 to 3 N/m")
    assert found.stick_slip(40.0).endswith("friction 4 to 12 N")
    assert "stick-slip" in found.summary()


def _motion(time, velocity, friction, normal):
    from elastomdr.transient.history_result import Drive

    flat = np.full(time.size, normal)
    zero = np.zeros(time.size)
    known = dict(
        time=time,
        drive=1e-3 * time,
        position=1e-3 * time,
        velocity=velocity,
        depth=zero,
        mu=friction / normal,
        normal_force=flat,
        friction_force=friction,
        pull=friction,
        given=zero,
        kinetic=zero,
        stored=zero,
        dissipated=zero,
        imbalance=zero,
        error=zero,
        model_error=zero,
        converged=np.ones(time.size, bool),
        per_length=True,
        model="",
        plan="",
        inputs=(),
    )
    return Drive(**known)


def test_stick_slip_of_a_drive():
    v = np.geomspace(0.1, 1, 9)
    for damping, said in (
        (0.1, "yes, "),
        (1e3, "no, above 0.02 m/s: swings die out; friction 10 to "),
    ):
        mount = em.Mount(2.0, 800.0, damping)
        summary = em.stability(
            mount, velocity=v, force=10 * v**-0.2, wavelength=1e-3
        ).summary()
        (line,) = (
            line for line in summary.splitlines() if line.startswith("stick-slip")
        )
        assert line.split(maxsplit=1)[1].startswith(said)
        assert line.endswith(" N")


@pytest.mark.parametrize(
    "given", [{"load": 10.0}, {"depth": 1e-5}], ids=["load", "depth"]
)
def test_a_load_on_a_surface_makes_it_a_line(given):
    rubber = em.StandardSolid(1e6, 1e6, 1e-2)
    name = next(iter(given))
    with pytest.warns(
        em.ModelWarning,
        match=rf"{name} on a surface is .* line.*give pressure= \[Pa\].*em.Multiscale",
    ):
        curve = em.friction(rubber, ROAD, velocity=0.01, **given)
    # asked for: no warning
    same = em.friction(rubber, ROAD, velocity=0.01, model=em.Line(), **given)
    assert curve.mu == same.mu
    with pytest.warns(em.ModelWarning, match=f"{name} on a surface"):
        em.plan(rubber, ROAD, velocity=0.01, **given)
    # what is refused is not warned of first: warnings are errors here
    for verb in (em.friction, em.plan):
        with pytest.raises(em.InputError, match="velocity must be positive"):
            verb(rubber, ROAD, velocity=-1.0, **given)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            lambda: em.friction(RUBBER, BALL, velocities=1.0, load=1.0),
            r"friction\(\) has no argument 'velocities'"
            r"\. Did you mean 'velocity'\?",
        ),
        (
            lambda: em.Sphere(radus=1.0),
            r"Sphere\(\) has no argument 'radus'\. Did you mean 'radius'\?",
        ),
        (
            lambda: em.Line(seed=1),
            r"Line\(\) has no argument 'seed'\. Did you mean 'seeds'\?",
        ),
        (
            lambda: em.fit.master_curve(None, refrence=1.0),
            r"'refrence'\. Did you mean 'reference'\?",
        ),
        (
            lambda: em.Sphere(zzz=1.0),
            r"Sphere\(\) has no argument 'zzz'\. Arguments are radius\.",
        ),
    ],
)
def test_arguments_that_are_not_there(call, message):
    with pytest.raises(TypeError, match=message):
        call()


def test_names_that_are_not_there():
    with pytest.raises(
        AttributeError,
        match=r"'elastomdr' has no attribute 'Spere'\. Did you mean 'Sphere'\?$",
    ):
        em.Spere  # noqa: B018
    with pytest.raises(
        AttributeError,
        match=r"'elastomdr\.fit' has no attribute 'materal'\. Did you mean 'material'",
    ):
        em.fit.materal  # noqa: B018
    with pytest.raises(AttributeError, match=r"Did you mean 'rough_map'\?$"):
        em.reference.roughmap  # noqa: B018


def test_shapes_that_do_not_fit_are_told_by_name():
    with refused("temperature", "(6,)", "(3,)") as caught:
        em.friction(
            RUBBER,
            BALL,
            velocity=[0.1] * 6,
            load=1.0,
            temperature=[290.0, 300.0, 310.0],
        )
    assert list(caught.value.got) == [290.0, 300.0, 310.0]


def test_a_key_that_belongs_elsewhere_and_is_misspelled(capsys):
    Path("ball.toml").write_text("frictoin = 0.5\n" + SCENE)
    assert main(["friction", "ball.toml"]) == 2
    assert mentions(capsys.readouterr().err, "frictoin", "'friction'")
