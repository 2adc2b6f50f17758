"""Tables of heights and of spectra as people have them: traces one below the other,
exports of stylus instruments, holes on a slope, codes beside heights, dust.
"""

import re
import warnings

import numpy as np
import pytest
from scipy.special import gamma

import elastomdr as em
from elastomdr.fit import FitWarning

from ..cli.cli_cases import arguments
from ..refused import mentions, refused
from .cases import twins
from .test_dropouts import rough

STEP = 1e-5  # [m]
TRACES = [rough((1200,), seed=seed, rms=20e-6) for seed in range(4)]
RUBBER = "tread-passenger-synthetic"


def table(titles, *columns):
    rows = zip(*columns, strict=True)
    return "\n".join([titles, *(",".join(f"{x:.9g}" for x in row) for row in rows)])


def mu(surface):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # of small maps
        return em.friction(
            em.load_material(RUBBER),
            surface,
            velocity=0.1,
            pressure=3e5,
            temperature=293.15,
        )


def quiet(source, **options):
    """A surface without the warning that its few heights are skew."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ModelWarning)
        return em.read_surface(source, **options)


def below(traces, turn=1):
    """x [mm] and heights [um] of traces one below the other."""
    x = 1e3 * STEP * np.arange(traces[0].size)
    ways = [x if i % 2 == 0 else x[::turn] for i in range(len(traces))]
    heights = [
        1e6 * trace[:: 1 if i % 2 == 0 else turn] for i, trace in enumerate(traces)
    ]
    return np.concatenate(ways), np.concatenate(heights)


@pytest.mark.parametrize("turn", [1, -1])
def test_traces_one_below_the_other_are_scans(tmp_path, turn):
    """Also forth and back, where x turns in place of starting again."""
    file = tmp_path / "traces.csv"
    file.write_text(table("x [mm],height [um]", *below(TRACES, turn)))
    got, expected = quiet(file), quiet(TRACES, pixel_size=STEP)
    # where x turns, a place is measured twice
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-5 if turn == 1 else 0.01)
    assert "read as 4 traces" in got.report[0]


def test_four_traces(tmp_path):
    """Their mean, point by point, has a slope of 0.029 and a friction of 0.0041."""
    text = table("x [mm],height [um]", *below(TRACES))
    made, *shared = twins(tmp_path, "profile_four_traces.csv", text)
    alone = [quiet(trace, pixel_size=STEP).rms_slope for trace in TRACES]
    assert quiet(made).rms_slope == pytest.approx(np.mean(alone), rel=0.1)
    for path in shared:
        surface = quiet(path)
        assert surface.rms_slope == pytest.approx(0.057, rel=0.02)
        same = em.Spectrum(surface.q, surface.c, convention="2d")
        assert mu(same).mu == pytest.approx(0.010, rel=0.1)
        # of tops that are four traces' chance
        assert abs(mu(surface).mu / 0.010 - 1) < 0.25
        assert abs(mu(surface).mu - mu(same).mu) < mu(surface).model_error


def test_points_that_come_again_with_other_heights_are_refused(tmp_path):
    """Traces whose points are mixed, and two maps in one table."""
    file = tmp_path / "mixed.csv"
    x, heights = below(TRACES)
    order = np.random.default_rng(0).permutation(x.size)
    file.write_text(table("x [mm],height [um]", x[order], heights[order]))
    with refused("path_or_heights", 3600, 4800):
        em.read_surface(file)
    i, j = np.indices((32, 32)).reshape(2, -1)
    maps = [rough((32, 32), seed=seed).ravel() for seed in (1, 2)]
    columns = [np.tile(i, 2), np.tile(j, 2), 1e6 * np.concatenate(maps)]
    file.write_text(table("x [um],y [um],height [um]", *columns))
    with refused("path_or_heights", 1024, 2048):
        em.read_surface(file)


def test_places_measured_twice_are_averaged(tmp_path):
    """The same heights again, but for noise."""
    noise = 1e-7 * np.random.default_rng(0).standard_normal((2, 1200))
    x = np.tile(np.arange(1200), 2) * 1e3 * STEP
    order = np.argsort(x, kind="stable")
    heights = 1e6 * (TRACES[0] + noise).ravel()
    file = tmp_path / "again.csv"
    file.write_text(table("x [mm],height [um]", x[order], heights[order]))
    got = em.read_surface(file, shortest=1e-4)
    assert mentions(got.report, 1200, "heights averaged")
    expected = em.read_surface(TRACES[0], pixel_size=STEP, shortest=1e-4)
    np.testing.assert_allclose(got.c, expected.c, rtol=0.02)


STYLUS = """Scan Parameters
Scan Type,Standard Scan
Stylus,Radius: 2.5 um
ASH,468.0 um,0.0 um,733.0 um,0.0 um,2.89171 um

Scan Data
{blank}Lateral um,Raw Micrometer,
"""


@pytest.mark.parametrize("blank", ["", "\n"])
def test_export_of_a_stylus_instrument(tmp_path, blank):
    """A header of pairs, and lines that end with empty cells."""
    height = 0.4 * rough((800,), rms=1.0)
    rows = [f"{0.16 * i:.2f},{h:.5f},," for i, h in enumerate(height)]
    text = STYLUS.format(blank=blank) + "\n".join(rows)
    for path in twins(tmp_path, "stylus_csv_with_header.csv", text):
        surface = em.read_surface(path, shortest=4 * 0.16e-6)
        np.testing.assert_allclose(2 * np.pi / surface.q_low, 64e-6, rtol=1e-6)
        np.testing.assert_allclose(2 * np.pi / surface.q_high, 0.64e-6, rtol=1e-6)
        assert surface.measured_height == pytest.approx(0.4e-6, rel=0.1)


def test_a_csv_that_is_no_table_is_asked_of_surface_topography(tmp_path):
    pytest.importorskip("SurfaceTopography")
    height = 1e6 * rough((48, 32), rms=4e-6)
    matrix = "\n".join(" ".join(map(repr, row)) for row in height.T.tolist())
    file = tmp_path / "map.csv"
    file.write_text(f"# Width: 96 um\n# Height: 64 um\n# Value units: um\n{matrix}\n")
    got = em.read_surface(file)
    expected = em.read_surface(1e-6 * height, pixel_size=2e-6)
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-6)


def test_columns_and_their_units(tmp_path):
    x, height = 1e3 * STEP * np.arange(1200), 1e6 * TRACES[0]
    time = np.arange(1200.0)
    expected = em.read_surface(TRACES[0], pixel_size=STEP)
    file = tmp_path / "more.csv"
    for titles, options in (
        ("t,x,z", {"columns": (2, 3), "unit": ("mm", "um")}),
        ("t,x,z", {"columns": ["x", "z"], "unit": ["mm", "um"]}),
        ("t [s],x [mm],z [um]", {"columns": (2, 3)}),
        ("t,x,z [um]", {"columns": (2, 3), "unit": "mm"}),
    ):
        file.write_text(table(titles, time, x, height))
        got = em.read_surface(file, **options)
        np.testing.assert_allclose(got.c, expected.c, rtol=1e-4)
    for options, said in (
        ({"columns": (2, 4)}, "columns must be numbers from 1 to 3 or titles of 1: t"),
        ({"columns": (2, 3), "unit": ["mm"] * 3}, "one for each of the 2 columns"),
        ({"columns": (2,)}, r"two columns \(x, height\) or three.*it has 1"),
        ({"columns": (2, 3), "unit": ["mm", "s"]}, "unit must be a unit of length"),
    ):
        with pytest.raises(em.InputError, match=said):
            em.read_surface(file, **options)


def test_columns_and_units_of_a_scene(tmp_path):
    columns = np.arange(1200.0), 1e3 * STEP * np.arange(1200), 1e6 * TRACES[0]
    (tmp_path / "more.csv").write_text(table("t,x,z", *columns))
    scene = tmp_path / "scene.toml"
    scene.write_text(
        'material = "tread-passenger-synthetic"\n[surface]\nshape = "file"\n'
        'file = "more.csv"\ncolumns = [2, 3]\nunit = ["mm", "um"]\n'
        '[contact]\npressure = "0.3 MPa"\nvelocity = "1 m/s"\n'
    )
    got = arguments("friction", str(scene))["shape"]
    expected = em.read_surface(TRACES[0], pixel_size=STEP)
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-4)


@pytest.mark.parametrize("shape", [(128, 96), (2048,)])
def test_holes_on_a_slope(shape):
    """A tilt changes nothing of the spectrum; where no plane is to be subtracted, the
    bridges of the holes follow the slope.
    """
    height = rough(shape, rms=4e-6)
    tilt = sum(1e-5 * (k + 1) * i for k, i in enumerate(np.indices(shape)))
    holed = height.copy()
    for corner in (0, 40):
        holed[(slice(corner, corner + 25),) * len(shape)] = np.nan
    flat, tilted = (
        em.read_surface(one, pixel_size=STEP) for one in (holed, holed + tilt)
    )
    np.testing.assert_allclose(tilted.c, flat.c, rtol=1e-6)
    assert tilted.measured_height == pytest.approx(flat.measured_height, rel=1e-6)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a slope is skew, and has a direction
        whole, bridged = (
            em.read_surface(
                one + tilt, pixel_size=STEP, detrend=False, shortest=1e-4
            ).measured_height
            for one in (height, holed)
        )
    assert bridged == pytest.approx(whole, rel=2e-3)


@pytest.mark.parametrize(
    ("step", "scale", "said"),
    [
        (0.625, 1.0, r"160 m long.*pixel_size|rms slope of"),
        (STEP, 1e-7, "rms slope of .* 0.001 to 3"),
    ],
)
def test_sizes_that_no_surface_has_are_warned_of(step, scale, said):
    height = scale * rough((256, 256))
    with pytest.warns(UserWarning, match=said) as caught:
        got = em.read_surface(height, pixel_size=step)
    for warning in caught:
        assert str(warning.message) in got.report
    assert any("unlike a real surface" in sentence for sentence in got.report)
    assert (step > 0.1) == any("160 m long" in sentence for sentence in got.report)


def test_counts_at_the_end_of_their_type_are_dropouts():
    """-32768 at 1.5 % of the places of a map whose counts reach down to -32000, in steps
    of 1.7 nm.
    """
    counts = np.round(31500 * np.tanh(1.2 * rough((128, 128), rms=1.0) / 2))
    lost = np.random.default_rng(2).random(counts.shape) < 0.015
    lsb = 1.7e-9
    damaged = lsb * np.where(lost, -32768.0, counts)
    with pytest.warns(FitWarning, match=re.escape(f"{lost.sum()} times -5.57056e-05")):
        got = em.read_surface(damaged, pixel_size=STEP)
    holed = em.read_surface(np.where(lost, np.nan, lsb * counts), pixel_size=STEP)
    np.testing.assert_allclose(got.c, holed.c, rtol=1e-9)


def test_a_map_that_ends_in_a_flat_is_no_dropout():
    """Pits cut off at their bottom: the lowest value is at 10 % of the places, and is
    the end of no type.
    """
    height = np.round(rough((128, 128)) / 1e-8) * 1e-8
    floor = np.quantile(height, 0.1)
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        warnings.simplefilter("ignore", em.ModelWarning)
        got = em.read_surface(np.maximum(height, floor), pixel_size=STEP)
    assert "dropouts" not in " ".join(got.report)


def test_a_pit_that_moves_no_friction_moves_no_bound():
    """25 points near a corner, 20 rms heights deep, had a skewness of -2 and a bound of
    1.25 in place of 0.08.
    """
    height = rough((256, 256), rms=20e-6)
    pitted = height.copy()
    pitted[8:13, 12:17] -= 20 * 20e-6
    with pytest.warns(FitWarning, match="1 of 65536 points are spikes"):
        surface = em.read_surface(pitted, pixel_size=STEP, shortest=4 * STEP)
    clean = mu(em.read_surface(height, pixel_size=STEP, shortest=4 * STEP))
    dusty = mu(surface)
    assert dusty.mu == pytest.approx(clean.mu, rel=5e-3)
    assert dusty.model_error == pytest.approx(clean.model_error, rel=0.2)
    assert any("of 65536 points" in said for said in surface.report)


def test_third_octaves_of_a_profile(tmp_path):
    q = np.geomspace(1e3, 1e6, 31)
    text = table("q [rad/m],C [m^3]", q, 1e-4 * q**-2.6)
    whole = 1e-4 / (2 * np.sqrt(np.pi) * gamma(1.3) / gamma(1.8))
    for path in twins(tmp_path, "profile_psd_third_octaves.csv", text):
        surface = em.read_spectrum(path, convention="1d one-sided")
        np.testing.assert_allclose(surface.q, q, rtol=1e-6)
        np.testing.assert_allclose(surface.c, whole * q**-3.6, rtol=2e-4)


def test_levels_in_decibels_are_refused(tmp_path):
    text = table("wavelength [mm],texture level [dB re 1e-6 m]", [160, 80], [45, 48])
    for path in twins(tmp_path, "texture_levels_db.csv", text):
        with refused("path", 2, 13473):
            em.read_spectrum(path, convention="1d one-sided")


def test_the_advice_on_levels_gives_the_surface():
    """Third octaves of C = 1e-4 q^-2.6, as levels and back by what the error says."""
    q = np.geomspace(1e3, 1e6, 31)
    width = 0.2316 * q
    level = 10 * np.log10(1e-4 * q**-2.6 * width / 1e-12)
    got = em.Spectrum(q, 1e-12 * 10 ** (level / 10) / width, convention="1d one-sided")
    expected = em.Spectrum(q, 1e-4 * q**-2.6, convention="1d one-sided")
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-9)
    assert abs(2 ** (1 / 6) - 2 ** (-1 / 6) - 0.2316) < 1e-4


def test_infinite_heights_are_missing():
    """Also beside each other, where their difference is no number."""
    height = np.random.default_rng(0).standard_normal((64, 64)) * 1e-7
    missing = height.copy()
    height[3, 4:9], height[20:30, 40], height[21, 40] = np.inf, -np.inf, np.inf
    missing[~np.isfinite(height)] = np.nan
    for points in (np.s_[:], np.s_[3]):
        found, other = (
            em.read_surface(each[points], pixel_size=1e-6) for each in (height, missing)
        )
        np.testing.assert_array_equal(found.c, other.c)
        assert found.report == other.report
