"""`elastomdr fit` and `elastomdr calibrate`: what they print and write, and what they
refuse in one line.
"""

import argparse
import re
import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.checks import percent
from elastomdr.cli.fit import Fit, add_arguments, content_of
from elastomdr.cli.main import main
from elastomdr.cli.schema import decode
from elastomdr.trees import replaced

from ..cli.cli_cases import arguments
from ..io.dma_files import KNOWN, measure, two_rows
from ..material.check import check_material
from ..refused import mentions

ROWS = measure(KNOWN)
ROOT = Path(__file__).parents[2]


def test_command_line(tmp_path, monkeypatch, capsys):
    two_rows(tmp_path, ROWS)
    monkeypatch.chdir(tmp_path)
    assert (
        main(
            [
                "fit",
                "two.csv",
                "--reference",
                "-5degC",
                "--out",
                "new/folder",
                "--name",
                "fitted",
                "--verbose",
            ]
        )
        == 0
    )
    out, err = capsys.readouterr()
    assert err == ""
    for said in (
        "log10 a_T",
        "WLF",
        "residuals",
        "-5 degC",
        f"{len([*(tmp_path / 'new' / 'folder').iterdir()]) - 1} more files",
        "fitted.toml",
    ):
        assert said in out
    assert check_material(tmp_path / "new" / "folder" / "fitted.toml") == []
    scene = (
        'material = "new/folder/fitted.toml"\ntemperature = "20 '
        'degC"\n[indenter]\nshape = "sphere"\nradius = "5 mm"\n'
    )
    (tmp_path / "s.toml").write_text(
        scene + '[contact]\nload = "1 N"\nvelocity = ["1 mm/s", "1 cm/s"]\n'
    )
    assert arguments("friction", "s.toml")["material"].name == "fitted"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["two.csv", "--reference", "20 parsec"], "a temperature"),
        (["tow.csv"], '"tow.csv": No such'),
        (["two.csv", "--kind", "shearing"], "--kind must be"),
        (["two.csv", "--terms", "0"], "terms must be"),
        (["two.csv", "--law", "wolf"], "law must be"),
        (
            ["two.csv", "--reference", "-200degC"],
            "-10 to 60 degC",
        ),
        (["two.csv", "--name", "a/b"], "--name must be"),
        (["two.csv", "--column", "storage"], "--column[0] must be"),
        (["two.csv", "--poisson", "0.9"], "poisson must be"),
        (["two.csv", "--out", "two.csv"], "--out must be a folder"),
        (["nounit.csv"], "--frequency-unit"),
        (["notemperature.csv"], "--temperature 20degC"),
        (["short.csv"], "five points"),
        (["two.csv", "tensile.csv"], "one kind"),
        (["one.csv"], "range of frequencies"),
        (["hot.csv"], "between 100 and 800 K"),
        (["noloss.csv"], "--storage-only"),
    ],
)
def test_bad_input_is_one_line_and_no_file(
    arguments, said, tmp_path, monkeypatch, capsys
):
    two_rows(tmp_path, ROWS)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "nounit.csv").write_text(
        "f,T [K],G' [Pa],G'' [Pa]\n1,293,2e6,1e5\n2,293,2e6,1e5\n"
    )
    (tmp_path / "notemperature.csv").write_text(
        "f [Hz],G' [Pa],G'' [Pa]\n" + "\n".join(f"{f},2e6,1e5" for f in range(1, 9))
    )
    (tmp_path / "one.csv").write_text(
        "f [Hz],T [K],G' [Pa],G'' [Pa]\n" + 9 * "10,293,2e6,1e5\n"
    )
    (tmp_path / "hot.csv").write_text(
        "f [Hz],T [degC],G' [Pa],G'' [Pa]\n" + "1,2e5,2e6,1e5\n9,9e5,2e6,1e5\n" * 4
    )
    (tmp_path / "noloss.csv").write_text(
        "f [Hz],T [degC],G' [Pa],damp\n1,20,2e6,1\n2,20,2e6,1\n"
    )
    (tmp_path / "short.csv").write_text(
        "f [Hz],T [degC],G' [Pa],G'' [Pa]\n1,20,2e6,1e5\n"
    )
    (tmp_path / "tensile.csv").write_text(
        "f [Hz],T [degC],E' [Pa],E'' [Pa]\n1,20,2e6,1e5\n2,20,2e6,1e5\n"
    )
    before = sorted(path.name for path in tmp_path.rglob("*"))
    assert main(["fit", *arguments]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("elastomdr: error: ")
    assert err.count("\n") == 1
    assert said in err
    assert sorted(path.name for path in tmp_path.rglob("*")) == before


def test_temperatures_without_a_unit_are_in_celsius():
    def asked(*arguments):
        parser = argparse.ArgumentParser()
        add_arguments(parser)
        return decode(Fit, content_of(parser.parse_args(["a.csv", *arguments])))

    kelvin = [253.15, 273.15, 293.15]
    assert asked("--temperature", "-20,0,20").temperature == pytest.approx(kelvin)
    assert asked("--reference", "293.15 K").reference == 293.15
    assert asked("--reference", "20").reference == 293.15


RIG = """
title = "Rig"
material = "tread-passenger-synthetic"
temperature = ["5 degC", "35 degC"]

[surface]
shape = "self_affine"
hurst = 0.8
rms_height = "0.1 mm"
longest = "5 mm"
shortest = "0.1 mm"

[contact]
pressure = "0.5 MPa"
velocity = ["1 mm/s", "10 mm/s"]
"""


def write_rig(folder, pressure=""):
    """A scene, and friction of another cutoff and a shear law."""
    road = em.SelfAffine(0.8, rms_height=1e-4, q_low=2 * np.pi / 5e-3, q_high=6e4)
    road = road.ended(1.2e5)
    law = em.AdhesiveShear(8e6, 2e-2, 0.1, shift=em.Arrhenius(8e4, 293.15))
    velocity, celsius = np.geomspace(1e-6, 0.1, 7), np.array([[5.0], [35.0]])
    mu = em.friction(
        em.load_material("tread-passenger-synthetic"),
        road,
        velocity=velocity,
        temperature=celsius + 273.15,
        pressure=5e5,
        adhesion=law,
    ).mu
    rows = [f"velocity [mm/s];temperature [degC];mu [%];error{pressure and ';p [bar]'}"]
    for (i, j), value in np.ndenumerate(mu):
        rows.append(
            f"{velocity[j] * 1e3:.9g};{celsius[i, 0]};{value * 100:.9g};0.01{pressure}"
        )
    (folder / "rig.csv").write_text("\n".join(rows))
    (folder / "rig.toml").write_text(RIG)


def test_calibrated_scene_gives_the_calibrated_curve(tmp_path, monkeypatch, capsys):
    """In another folder, with units of its own: what was written is computed again, and
    is what was measured.
    """
    monkeypatch.chdir(tmp_path)
    write_rig(tmp_path, ";5")
    command = ["calibrate", "rig.toml", "--measured", "rig.csv", "--out", "new"]
    assert main(command) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert len(out.splitlines()) == 5
    folder = tmp_path / "new"
    scene = arguments("friction", "new/rig-calibrated.toml")
    assert scene["temperature"].shape == (2, 1)
    data = em.read_friction(tmp_path / "rig.csv")
    at = {"velocity": data.velocity, "temperature": data.temperature, "pressure": 5e5}
    law, rubber = scene["adhesion"], em.load_material(folder / "rig-material.toml")
    surface = em.read_spectrum(folder / "rig-surface.csv", convention="2d")
    text = (folder / "rig-calibrate.csv").read_text().splitlines()
    rows = [line.split(",") for line in text if not line.startswith("#")]
    computed = [float(row[rows[0].index("computed [-]")]) for row in rows[1:]]
    for body, road in ((scene["material"], scene["shape"]), (rubber, surface)):
        again = em.friction(body, road, adhesion=law, **at).mu
        np.testing.assert_allclose(again, computed, rtol=1e-9)
    np.testing.assert_allclose(computed, data.mu, atol=0.01)
    assert main(["friction", "new/rig-calibrated.toml", "--out", "new"]) == 0


POINTS = """velocity [mm/s],temperature [degC],mu
0.1,5,0.50
1,5,0.72
10,5,0.88
0.1,20,0.44
1,20,0.61
10,20,0.83
100,20,1.01
"""


def with_an_error(folder, scene):
    return scene.replace("# cutoff_error", "cutoff_error", 1)


def with_draws(folder, scene):
    """Of a rubber that knows its misfit, whose draws need no more."""
    rubber = em.load_material("epdm-70")
    known = ((1.0, 0.02, 0.03), (1e4, 0.02, 0.03))
    assert rubber.range is not None
    limits = rubber.range._replace(misfit=known)
    em.save_material(replaced(rubber, range=limits), folder / "known.toml")
    scene = scene.replace('"tread-passenger-synthetic"', '"known.toml"', 1)
    return "uncertainty = 2\n" + with_an_error(folder, scene)


def on_a_map(folder, scene):
    """Skew heights without a lay, whose directions would take a minute."""
    along = 2 * np.pi * np.arange(64) / 64
    phases = np.random.default_rng(0).uniform(0, 2 * np.pi, (8, 17))
    heights = sum(
        np.cos(i * along[:, None] + j * along + phases[i, j]) / (i * i + j * j)
        for i in range(8)
        for j in range(-7, 8)
        if i or j > 0
    )
    np.savetxt(folder / "map.csv", np.exp(heights), delimiter=",")  # skew
    head, tail = scene.split("[surface]", 1)
    _, tail = tail.split("[contact]", 1)
    of_file = 'shape = "file"\nfile = "map.csv"\npixel_size = "1 um"\nunit = "um"\n'
    return f"{head}[surface]\n{of_file}\n[contact]{tail}"


@pytest.mark.parametrize(
    "changed",
    [lambda folder, scene: scene, with_an_error, with_draws, on_a_map],
    ids=["template", "cutoff_error", "uncertainty", "map"],
)
def test_the_written_scene_is_computed(changed, tmp_path, monkeypatch, capsys):
    """Also where only the points have temperatures, which its shear law needs."""
    monkeypatch.chdir(tmp_path)
    assert main(["init", "--kind", "calibrate", "rig.toml"]) == 0
    scene = (tmp_path / "rig.toml").read_text()
    (tmp_path / "rig.toml").write_text(changed(tmp_path, scene))
    (tmp_path / "rig.csv").write_text(POINTS)
    asked = ["rig.toml", "--measured", "rig.csv", "--out", "new"]
    assert main(["calibrate", *asked]) == 0
    text = (tmp_path / "new" / "rig-calibrated.toml").read_text()
    known, left = (
        tomllib.loads(each)["surface"].get("cutoff_error", 0.0)
        for each in ((tmp_path / "rig.toml").read_text(), text)
    )
    assert known in (left, 0.0)  # the points stand for what they tell
    assert 'measured = "' in text
    assert "# found: " in text
    assert "# doubts: " in text
    capsys.readouterr()
    asked = ["friction", "new/rig-calibrated.toml", "--out", "new", "--verbose"]
    assert main(asked) == 0
    out, err = capsys.readouterr()
    assert "error" not in err.replace("model_error", "")
    doubted = tomllib.loads(text)["doubts"]
    assert doubted  # which go with the numbers, into every file
    # those of the curve among them, whose moduli are of no particular rubber
    of_curve = [said for said in doubted if "illustrative" in said]
    given = tomllib.loads((tmp_path / "rig.toml").read_text())
    assert bool(of_curve) == given["material"].startswith("tread")
    surface = (tmp_path / "new" / "rig-surface.csv").read_text()
    rubber = (tmp_path / "new" / "rig-material.toml").read_text()
    for said in doubted:
        assert f"rest on a calibration: {said}" in out
        assert f"# calibrated: {said}" in surface
        assert said in rubber


def test_a_calibration_without_doubts_is_computed(tmp_path, monkeypatch):
    """Of measured moduli, at frequencies that they have."""
    monkeypatch.chdir(tmp_path)
    scene = RIG.replace("tread-passenger-synthetic", "epdm-70")
    (tmp_path / "rig.toml").write_text(scene)
    velocity = np.geomspace(1e-4, 1e-2, 5)
    road = em.SelfAffine(0.8, rms_height=1e-4, q_low=2 * np.pi / 5e-3, q_high=6e4)
    mu = em.friction(
        em.load_material("epdm-70"),
        road.ended(7e4),
        velocity=velocity,
        temperature=293.15,
        pressure=5e5,
    ).mu
    noise = 1 + 0.01 * np.array([1, -1, 0, 1, -1])
    rows = [
        f"{v:.6g},20,{x:.6g},{x / 50:.6g}"
        for v, x in zip(velocity, mu * noise, strict=True)
    ]
    head = "velocity [m/s],temperature [degC],mu,error"
    (tmp_path / "rig.csv").write_text("\n".join([head, *rows]))
    asked = ["--measured", "rig.csv", "--parameters", "q_high", "--out", "new"]
    assert main(["calibrate", "rig.toml", *asked]) == 0
    written = "new/rig-calibrated.toml"
    assert "doubts" not in tomllib.loads((tmp_path / written).read_text())
    assert main(["friction", written, "--out", "new"]) == 0


def test_what_nothing_decides_is_not_written(tmp_path, monkeypatch, capsys):
    """Values that moved within what was assumed are no calibration."""
    monkeypatch.chdir(tmp_path)
    write_rig(tmp_path)
    known = RIG.replace("[surface]", "[surface]\ncutoff_error = 0.001", 1)
    (tmp_path / "rig.toml").write_text(known)
    asked = ["--measured", "rig.csv", "--parameters", "q_high", "--out", "new"]
    assert main(["calibrate", "rig.toml", *asked]) == 0
    assert "nothing" in capsys.readouterr().out
    written = {path.name for path in (tmp_path / "new").iterdir()}
    assert written == {"rig-calibrate.csv", "rig-calibrate.png"}


def test_a_column_of_measured_friction_can_be_named(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_rig(tmp_path, ";5")
    text = (tmp_path / "rig.csv").read_text()
    (tmp_path / "rig.csv").write_text(text.replace("mu [%]", "F3 [%]", 1))
    command = ["calibrate", "rig.toml", "--measured", "rig.csv", "--out", "new"]
    asked = [*command, "--parameters", "q_high"]
    assert main(asked) == 2
    said = capsys.readouterr().err
    assert "--column" in said
    assert "columns=" not in said  # which is Python's
    assert main([*asked, "--column", "mu=F3 [%]"]) in (0, 3)
    read = capsys.readouterr().out.splitlines()[0]
    assert read.startswith("read ")
    assert "mu from 3 'F3 [%]'" in read
    # a scene could not read the file that it would name
    assert "measured" not in (tmp_path / "new" / "rig-calibrated.toml").read_text()


def test_calibration_of_heights_alone(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    write_rig(tmp_path)
    more = 'measured = "rig.csv"\n[adhesion]\nstress = "8 MPa"\nvelocity = "20 mm/s"\n'
    more += 'width = 0.1\nenergy = "80 kJ/mol"\nreference = "20 degC"\n'
    content = RIG.replace("[surface]", more + "[surface]\ncutoff_error = 0.5", 1)
    (tmp_path / "rig.toml").write_text(content)
    asked = ["--parameters", "heights, q_high", "--draws", "20", "--verbose"]
    assert main(["calibrate", "rig.toml", *asked]) == 0
    out, _ = capsys.readouterr()
    assert "log10 a_T" in out
    left = tomllib.loads((tmp_path / "rig-calibrated.toml").read_text())["surface"]
    assert left["cutoff_error"] == 0.5  # beforehand: the points tell the rest
    scene = arguments("friction", "rig-calibrated.toml")
    surface = em.read_spectrum("rig-surface.csv", convention="2d")
    np.testing.assert_allclose(scene["shape"].c, surface.c, rtol=1e-12)
    assert float(scene["shape"].rms_height) == pytest.approx(1e-4, rel=0.2)


def advised(scene):
    """What a scene rests on, the advice of measured friction, and what it promises."""
    curve = em.friction(**scene)
    held = curve.uncertainty()
    advice = next(each for each in held.surer() if "measured friction" in each.test)
    places = re.findall(r"(\S+) degC, (\S+) m/s", advice.test)
    celsius, speed = np.array(places, dtype=float).T
    kelvin = celsius + 273.15
    t = np.abs(np.unique(scene["temperature"]) - kelvin[:, None]).argmin(axis=1)
    v = np.abs(np.log(scene["velocity"] / speed[:, None])).argmin(axis=1)
    return held, advice, (speed, kelvin, curve.mu[t, v])


def test_who_follows_the_advice_gets_what_it_promises(tmp_path, monkeypatch, capsys):
    """Cutoff and shear stress are not known apart by the three points, but mu is."""
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "examples" / "scenes" / "tread.toml").read_text()
    text = text.split("[roller]")[0].replace("points = 24", "points = 4")
    (tmp_path / "tread.toml").write_text(text)
    held, advice, points = advised(arguments("friction", "tread.toml"))
    rows = zip(*points, 0.05 * points[-1], strict=True)
    table = [f"{v},{t},200000,{mu},{error}" for v, t, mu, error in rows]
    titles = "velocity [m/s],temperature [K],pressure [Pa],mu,error"
    (tmp_path / "three.csv").write_text("\n".join([titles, *table]))
    assert main(["calibrate", "tread.toml", "--measured", "three.csv"]) == 0
    assert main(["friction", "tread-calibrated.toml", "--uncertainty"]) == 0
    assert mentions(capsys.readouterr().out, f"band {percent(advice.after)}, then")
    new = pd.read_csv("tread-calibrated-friction-uncertainty.csv", comment="#")
    half = new["half of the band [-]"].to_numpy()[: held.value.size]
    np.testing.assert_allclose(half.max(), advice.after, rtol=1e-3)
    promised = held.half_band(advice.test).ravel()
    np.testing.assert_allclose(half, promised, rtol=1e-3)
    assert (half < held.half_band().ravel()).all()


@pytest.mark.parametrize(
    ("options", "change", "argument", "facts"),
    [
        ([], ("", ""), "--measured", ()),
        (["--measured", "gone.csv"], ("", ""), "--measured", ("gone.csv",)),
        (
            ["--measured", "rig.csv", "--parameters", "q_hihg"],
            ("", ""),
            "--parameters",
            ("q_high", "q_hihg", "shear, "),
        ),
        (
            ["--measured", "rig.csv", "--parameters", "gain"],
            ("", ""),
            "--parameters",
            ("gain",),
        ),
        (["--measured", "rig.csv", "--draws", "few"], ("", ""), "--draws", ("few",)),
        (
            ["--measured", "rig.csv", "--column", "speed=9"],
            ("", ""),
            "--column",
            ("velocity", "speed"),
        ),
        (["--measured", "rig.csv", "--out", "rig.csv"], ("", ""), "--out", ()),
        (
            ["--measured", "rig.csv"],
            ('"0.5 MPa"', '["0.5 MPa", "1 MPa"]'),
            "pressure",
            ("rig.csv",),
        ),
        (["--measured", "rig.csv"], ("hurst = 0.8", "hurts = 0.8"), "hurts", ()),
        (
            ["--measured", "rig.csv"],
            ('"tread-passenger-synthetic"', '["tread-passenger-synthetic", "epdm-70"]'),
            "material",
            (),
        ),
    ],
)
def test_calibrations_that_are_refused(
    options, change, argument, facts, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    write_rig(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG.replace(*change) if change[0] else RIG)
    before = sorted(path.name for path in tmp_path.rglob("*"))
    assert main(["calibrate", "rig.toml", *options]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.count("\n") == 1
    assert all(fact in err for fact in (argument, *facts)), err
    assert sorted(path.name for path in tmp_path.rglob("*")) == before
