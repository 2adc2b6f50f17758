"""Robust at the edges: damaged files, full disks, broken caches and interrupts end in
one clear line each.
"""

import importlib
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from ..cli.cli_cases import MATERIAL, SCENE
from ..io.dma_files import eplexor_xls

FUZZ = Path(__file__).parents[2] / "benchmarks" / "robustness" / "fuzz.py"
PROFILES = ("friction.toml", "tip.csv")  # compile long before they are checked
ROUGH = """
material = "rubber.toml"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.1
longest = "1 mm"
shortest = "0.1 mm"
[contact]
pressure = "0.1 MPa"
velocity = "1 m/s"
"""


@pytest.fixture(autouse=True)
def place(tmp_path, monkeypatch):
    (tmp_path / "rubber.toml").write_text(MATERIAL)
    (tmp_path / "scene.toml").write_text(SCENE)
    (tmp_path / "rough.toml").write_text(ROUGH)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def refused(capsys, *argv: str) -> str:
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert err.startswith("elastomdr: error: ")
    assert err.count("\n") == 1
    return err


def test_damaged_files_are_refused_in_one_line(place, monkeypatch):
    monkeypatch.syspath_prepend(FUZZ.parent)
    fuzz = importlib.import_module("fuzz")

    def late(*_):
        raise fuzz.TooLong

    before = signal.signal(signal.SIGALRM, late)
    try:
        with fuzz.only_checked(0):
            files = [
                entry
                for entry in fuzz.sources(place)
                if ".xls" not in entry[0] and entry[0] not in PROFILES
            ]
            kept = {
                name: Path(name).read_bytes()
                for name in os.listdir()
                if Path(name).is_file()
            }
            for i in range(80):
                random = np.random.default_rng([7, i])
                name, content, commands = files[i % len(files)]
                Path(name).write_bytes(fuzz.mutate(content, random))
                argv = [name if word == "FILE" else word for word in commands[0]]
                how, wrong = fuzz.run(argv)
                assert not wrong, (argv, how, wrong, Path(name).read_bytes()[:500])
                Path(name).write_bytes(kept.get(name, b""))
    finally:
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("rtol = 1e-4", "rtol = " + "9" * 400, "rtol"),
        ('"5 mm"', '"1e200 m"', "between 1e-100 and 1e+100"),
        ('"5 mm"', '"5 m^' + "9" * 320 + '"', "a unit that is known"),
        ('"rubber.toml"', '"/dev/zero"', "Not a regular file"),
        ('"rubber.toml"', '"a\\u0007b.toml"', "a?b.toml"),
    ],
)
def test_values_that_would_overflow_or_hang(place, capsys, old, new, said):
    (place / "scene.toml").write_text(SCENE.replace(old, new))
    assert said in refused(capsys, "friction", "scene.toml")


def test_material_lists_of_different_length_are_not_shown(place, capsys):
    (place / "rubber.toml").write_text(MATERIAL.replace("[1e-3, 1e-2]", "[1e-3]"))
    assert "as long as moduli" in refused(capsys, "materials", "./rubber.toml")
    (place / "rubber.toml").write_text(
        MATERIAL.replace("equilibrium = 1e6", "equilibrium = 1e308")
    )
    assert "1e100" in refused(capsys, "friction", "scene.toml")


def test_a_pipe_does_not_hang(place, capsys):
    os.mkfifo(place / "pipe.toml")
    for verb in ("friction", "indent", "fit"):
        assert "Not a regular file" in refused(capsys, verb, "pipe.toml")


def test_a_mistyped_place_on_a_profile_does_not_fill_the_memory(place):
    x = np.linspace(0, 10, 100)
    x[-1] = 1e9
    np.savetxt(
        place / "track.csv",
        np.column_stack([x, np.sin(x)]),
        delimiter=",",
        header="x [mm],h [um]",
        comments="",
    )
    with pytest.raises(em.InputError, match="mistyped"):
        em.read_surface("track.csv")


def test_a_damaged_spreadsheet_is_one_line(place, capfd):
    rows = np.column_stack(
        [np.geomspace(0.1, 10, 9), np.full(9, 20.0), np.full(9, 1e6), np.full(9, 1e5)]
    )
    (file,) = eplexor_xls(place, rows)[:1]
    whole = file.read_bytes()
    for damaged in (whole[:512], whole[:700], whole[:30] + b"\x07" + whole[31:]):
        file.write_bytes(damaged)
        assert main(["fit", file.name]) == 2
        out, err = capfd.readouterr()
        assert out == ""
        assert err.count("\n") == 1
        assert file.name in err


def test_a_folder_that_cannot_be_written(place, capsys):
    (place / "file").write_text("")
    assert "--out" in refused(capsys, "friction", "scene.toml", "--out", "file/below")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_output_to_a_full_disk_is_one_line():
    command = [sys.executable, "-m", "elastomdr", "materials"]
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            command,
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
            timeout=60,
        )
    assert done.returncode == 2
    assert (
        done.stderr
        == "elastomdr: error: the output cannot be written: No space left on device.\n"
    )


@pytest.mark.skipif(os.name != "posix", reason="needs a POSIX shell")
def test_output_that_is_closed_is_no_reason_to_fail():
    code = (
        "import sys; from elastomdr.cli.main import main; sys.exit(main(['materials']))"
    )
    done = subprocess.run(
        ["sh", "-c", '"$0" -c "$1" >&-', sys.executable, code],
        stderr=subprocess.PIPE,
        text=True,
        check=False,
        timeout=60,
    )
    assert done.returncode == 0
    assert done.stderr == ""


LINE = """
material = "epdm-70"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.3
longest = "1 mm"
shortest = "0.1 mm"
[contact]
pressure = "0.1 MPa"
velocity = "1 mm/s"
model = "line"
"""


@pytest.mark.skipif(
    sys.platform != "linux", reason="the place of the cache is the platform's"
)
def test_compiled_code_is_kept_and_a_damaged_cache_is_one_line(place):
    # a rough line is computed by JAX
    (place / "line.toml").write_text(LINE)
    environment = {
        key: value for key, value in os.environ.items() if not key.startswith("JAX_")
    }
    environment["XDG_CACHE_HOME"] = str(place / "cache")

    def line():
        argv = [sys.executable, "-m", "elastomdr", "friction", "line.toml"]
        done = subprocess.run(
            argv,
            capture_output=True,
            text=True,
            env=environment,
            check=False,
            timeout=120,
        )
        assert done.returncode == 0, done.stderr
        folder = place / "cache" / "elastomdr" / "jax"
        return done, {path: path.stat().st_mtime_ns for path in folder.glob("*-cache")}

    first, files = line()
    assert files
    second, same = line()
    assert same == files  # compiled nothing
    for path in files:
        path.write_bytes(b"damaged")
    third, _ = line()
    assert first.stdout == second.stdout == third.stdout
    assert not second.stderr.count("damaged")
    assert third.stderr.count("\n") == 1
    assert "compiled code" in third.stderr


@pytest.mark.parametrize("changed", ["velocity", "load", "radius"])
def test_float32_input_gives_the_float64_result_of_the_rounded_numbers(changed):
    given = {
        "velocity": np.array([0.1, 0.3]),
        "load": np.array([0.7, 0.7]),
        "radius": np.array(0.0123),
    }
    narrow = given | {changed: given[changed].astype(np.float32)}
    wide = narrow | {changed: narrow[changed].astype(np.float64)}
    curves = []
    for numbers in (narrow, wide):
        body = em.Paraboloid(numbers["radius"])
        scene = {
            "velocity": numbers["velocity"],
            "load": numbers["load"],
            "model": em.Line(),
        }
        curves.append(em.friction(em.Foundation(4e6, [12e6], [1e-3]), body, **scene))
    assert curves[0].mu.dtype == np.float64
    np.testing.assert_array_equal(curves[0].mu, curves[1].mu)
