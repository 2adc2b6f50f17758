"""Dropouts of profilometers, written as numbers, do not move the friction; they are
said, and too many are refused.
"""

import re
import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning
from elastomdr.io.surface import without_dropouts

from ..refused import mentions, refused, warned

STEP = 1e-5  # [m]


def rough(shape, hurst=0.8, seed=0, rms=50e-6):
    """Heights of a self-affine profile or map."""
    q = np.sqrt(
        sum(np.meshgrid(*[np.fft.fftfreq(n) ** 2 for n in shape], indexing="ij"))
    )
    size = np.where(q > 0, np.maximum(q, 4 / max(shape)), np.inf) ** -(
        hurst + len(shape) / 2
    )
    phase = np.exp(2j * np.pi * np.random.default_rng(seed).random(shape))
    height = np.fft.ifftn(size * phase).real
    return rms * height / height.std()


PROFILE = rough((4096,))
MAP = rough((96, 96))
RUBBER = em.Prony(1e6, [3e7, 1e7, 3e6], [1e-7, 1e-5, 1e-3])


def friction(surface):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return float(em.friction(RUBBER, surface, velocity=1.0, pressure=3e5).mu)


def with_values(height, places, value):
    damaged = height.copy()
    damaged.ravel()[places] = value
    return damaged


@pytest.mark.parametrize(
    ("places", "value", "words"),
    [
        (
            [1000],
            -9999e-6,
            "1 of 4096 .* 1 times -0.009999 m",
        ),
        ([1000], 0.0123, "1 of 4096 .* spikes, .* 0.012"),
        (
            slice(100, 900, 20),
            -9999e-6,
            "40 of 4096 .* 40 times -0.009999 m",
        ),
        (
            slice(100, 140),
            -32768e-8,
            "40 of 4096 .* 40 times -0.00032768 m",
        ),
        ([0, -1], 0.007, "2 of 4096 .* 2 times 0.007 m"),
    ],
)
def test_dropouts_do_not_move_friction(places, value, words):
    with pytest.warns(FitWarning, match=words):
        got = em.read_surface(with_values(PROFILE, places, value), pixel_size=STEP)
    assert re.search(words, got.report[0])
    within = 0.01
    if places == slice(100, 140):
        # a bridge has no slopes of its own: it takes up to its share of the points over
        # twice that of the real contact, an eighth, from the slope of the tops
        within = 40 / 4096 / (2 * 0.125)
    assert friction(got) == pytest.approx(
        friction(em.read_surface(PROFILE, pixel_size=STEP)), rel=within
    )


def test_few_codes_next_to_the_lowest_height(tmp_path):
    """Half a per cent at -32768, the heights of the rest in whole numbers down to
    -32000, as files have them.
    """
    counts = np.round(32000 * PROFILE / np.abs(PROFILE).max())
    counts[1000:1020] = -32768
    file = tmp_path / "heights.txt"
    file.write_text("\n".join(f"{x:.0f}" for x in counts))
    with warned(FitWarning, 20, 4096):
        em.read_surface(file, pixel_size=STEP, unit="nm")


def test_a_lowest_height_that_repeats_is_asked_about():
    """Just below the others it may be a code or a floor: it is kept, and said."""
    damaged = with_values(PROFILE, slice(1000, 1040), PROFILE.min() - 1e-8)
    with warned(FitWarning, "lowest height", "-0.000", "40 times"):
        got = em.read_surface(damaged, pixel_size=STEP)
    assert "40 times" in got.report[0]


def test_codes_beside_a_spike_that_is_further_away():
    damaged = with_values(with_values(PROFILE, slice(500, 540), -9999e-6), [77], 0.05)
    with pytest.warns(FitWarning) as caught:
        em.read_surface(damaged, pixel_size=STEP)
    codes, spike = (str(one.message) for one in caught)
    assert mentions(codes, "heights", "dropouts", "40 times -0.009999 m")
    assert mentions(spike, "heights", "spikes")


@pytest.mark.parametrize("titles", ["x [mm],height [um]", "x [mm],y [mm],height [um]"])
def test_dropouts_in_files_are_found_before_points_are_sorted_and_averaged(
    titles, tmp_path
):
    height = MAP if "y" in titles else PROFILE
    damaged = 1e6 * with_values(height, slice(50, 3000, 300), -9999e-6)
    place = [1e3 * STEP * axis.ravel() for axis in np.indices(height.shape)]
    rows = np.column_stack([*place, damaged.ravel()])
    np.random.default_rng(0).shuffle(rows)
    np.savetxt(tmp_path / "scan.csv", rows, delimiter=",", header=titles, comments="")
    with warned(FitWarning, "scan.csv", 10, -0.009999):
        got = em.read_surface(tmp_path / "scan.csv")
    clean = em.read_surface(height, pixel_size=STEP)
    np.testing.assert_allclose(got.c, clean.c, rtol=0.05)


@pytest.mark.parametrize(
    ("share", "value", "words"),
    [
        (
            0.3,
            -9999e-6,
            ("path_or_heights", "12", 4096),
        ),
        (0.7, -9999e-6, ("path_or_heights", "three quarters")),
        (0.04, None, ("path_or_heights", "98%", 4096)),
    ],
)
def test_too_many_dropouts_are_refused(share, value, words):
    rng = np.random.default_rng(0)
    at = rng.random(PROFILE.size) < share
    values = rng.normal(0, 5e-3, int(at.sum())) if value is None else value
    with refused(*words):
        em.read_surface(with_values(PROFILE, at, values), pixel_size=STEP)


def test_surfaces_have_no_dropouts():
    for seed in range(40):
        hurst = 0.1 + 0.02 * seed
        profile, area = rough((1024,), hurst, seed), rough((64, 64), hurst, seed)
        grooves = 2e-4 * (np.arange(64) % 20 == 7)
        polished = np.minimum(profile, np.quantile(profile, 0.6))
        stepped = profile + 1e-4 * (np.arange(1024) // 60 % 2)
        for height in (
            profile,
            polished,
            stepped,
            profile.round(6),
            -(profile**2),
            area,
            area + grooves,
        ):
            kept, words = without_dropouts(height)
            assert not words
            np.testing.assert_array_equal(kept, height)
    assert not without_dropouts(np.sin(np.arange(4096) / 20))[1]


def test_the_command_line_says_dropouts_once(tmp_path, capsys):
    x = 1e3 * STEP * np.arange(PROFILE.size)
    rows = np.column_stack([x, 1e6 * with_values(PROFILE, [1000], -9999e-6)])
    np.savetxt(
        tmp_path / "scan.csv",
        rows,
        delimiter=",",
        header="x [mm],height [um]",
        comments="",
    )
    em.save_material(
        em.Prony(1e6, [1e7], [1e-5], name="rubber"), tmp_path / "rubber.toml"
    )
    scene = """material = "rubber.toml"\n[surface]\nshape = "file"\nfile = "scan.csv"
[contact]\npressure = "0.3 MPa"\nvelocity = ["1 mm/s", "1 m/s"]\n"""
    (tmp_path / "scene.toml").write_text(scene)
    assert main(["friction", str(tmp_path / "scene.toml"), "--out", str(tmp_path)]) == 0
    said = [line for line in capsys.readouterr().err.splitlines() if "dropouts" in line]
    (line,) = said
    assert mentions(line, "warning", "scan.csv", "1 of 4096", "1 times -0.009999 m")
