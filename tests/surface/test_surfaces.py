"""Surfaces: spectra and their normalisations, the lines made of them, measured profiles
and files of instruments.
"""

import importlib
import itertools
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import gamma

import elastomdr as em
from elastomdr.surface import topography
from elastomdr.surface.spectrum import synthesise

from ..refused import mentions, refused, warned

TABLE = np.array([1e3, 1e6])
SURFACE = em.Spectrum(TABLE, 1e-17 * (TABLE / 1e3) ** -3.6, convention="2d")


def test_moments_of_a_spectrum():
    np.testing.assert_allclose(SURFACE.rms_height, 6.266521027154632e-06, rtol=1e-9)
    np.testing.assert_allclose(SURFACE.rms_slope, 0.04829559785736858, rtol=1e-9)
    same = em.SelfAffine(0.8, rms_height=6.266521027154632e-06, q_low=1e3, q_high=1e6)
    np.testing.assert_allclose(same.rms_slope, 0.04829559785736858, rtol=1e-9)
    np.testing.assert_allclose(
        em.Spectrum(TABLE, 4 * np.pi**2 * SURFACE.c, convention="2d/4pi^2").c, SURFACE.c
    )


def test_spectrum_of_a_cut():
    """C_cut = int C(sqrt(q^2 + k^2)) dk of a self-affine surface, by quadrature, and
    back.
    """
    true = em.SelfAffine(0.8, rms_height=1e-5, q_low=1e3, q_high=1e5)
    q, k = (
        np.geomspace(1e3, 0.998e5, 300),
        np.concatenate([[0], np.geomspace(1, 1e5, 20000)]),
    )
    cut = np.array([2 * np.trapezoid(true.at(np.hypot(x, k)), k) for x in q])
    for name, factor in (("1d", 1), ("1d one-sided", 2), ("1d/2pi", 2 * np.pi)):
        back = em.Spectrum(q, factor * cut, convention=name)
        np.testing.assert_allclose(back.rms_height, 1e-5, rtol=2e-3)
        np.testing.assert_allclose(back.rms_slope, true.rms_slope, rtol=1e-2)


CONVENTIONS = {
    "1d": 1.0,
    "1d one-sided": 2.0,
    "1d/2pi": 2 * np.pi,
    "1d one-sided/2pi": 4 * np.pi,
}


def of_cut(exponent):
    """C q^(exponent + 1) of a cut q^-exponent: Abel's integral in closed form."""
    return gamma((exponent + 1) / 2) / (np.sqrt(np.pi) * gamma(exponent / 2))


@pytest.mark.parametrize("points", [4, 10])
@pytest.mark.parametrize("exponent", [1.2, 2.0, 2.6])
def test_spectrum_of_a_cut_that_is_a_power_law(points, exponent):
    """At every point of the table, the last included; straight lines in linear C gave
    11 and 31 % less.
    """
    q = np.geomspace(1e3, 1e6, 3 * points + 1)
    for name, factor in CONVENTIONS.items():
        found = em.Spectrum(q, factor * 1e-4 * q**-exponent, convention=name)
        np.testing.assert_allclose(found.q, q)
        np.testing.assert_allclose(
            found.c, 1e-4 * of_cut(exponent) * q ** (-exponent - 1), rtol=1e-4
        )


def test_spectrum_of_a_cut_of_two_power_laws():
    """A knee at a point of the table: the two pieces by quadrature of Abel's integral."""
    q = np.array([1e3, 2e3, 8e3, 1e4])
    cut = np.array([5.0, 4.0, 0.2, 0.19])
    found = em.Spectrum(q, cut, convention="1d")
    slopes = np.diff(np.log(cut)) / np.diff(np.log(q))

    def fall(k):
        i = min(np.searchsorted(q, k, "right") - 1, 2)
        return slopes[i] * cut[i] * (k / q[i]) ** slopes[i] / k

    for start, c in zip(q, found.c, strict=True):
        edges = [*np.arccosh(q[q >= start] / start), 45.0]
        expected = -sum(
            quad(lambda u, q=start: fall(q * np.cosh(u)), *ends, epsabs=0, limit=200)[0]
            for ends in itertools.pairwise(edges)
        )
        np.testing.assert_allclose(c, expected / np.pi, rtol=1e-3)


def test_friction_of_a_cut_is_that_of_its_surface():
    """em.friction of a table of a profile, four points a decade: .69 of C before."""
    q = np.geomspace(1e3, 1e6, 13)
    c = 1e-4 * of_cut(2.6) * q**-3.6
    rubber = em.load_material("tread-passenger-synthetic")
    mu = [
        em.friction(rubber, surface, velocity=0.1, pressure=3e5, temperature=293.15).mu
        for surface in (
            em.Spectrum(q, 2e-4 * q**-2.6, convention="1d one-sided"),
            em.Spectrum(q, c, convention="2d"),
        )
    ]
    np.testing.assert_allclose(mu[0], mu[1], rtol=1e-3)


@pytest.mark.parametrize(
    ("c", "said"),
    [
        ([3.0, 2.0, 2.0], ("c", 2, 1100)),
        ([1.0, 400.0, 399.0], ("c", "over wider bands")),
        (np.linspace(2, 1, 6000), ("q", 5000)),
    ],
)
def test_cuts_that_are_none_of_an_isotropic_surface(c, said):
    with refused(*said):
        em.Spectrum(np.geomspace(1e3, 1.1e3, len(c)), c, convention="1d")


def test_moments_of_a_spectrum_in_closed_form():
    """C = q^-3 from 1 to 4 rad/m: m_1 = 3/4, m_2 = ln 4, m_3 = 3."""
    surface = em.Spectrum([1.0, 4.0], [1.0, 1 / 64], convention="2d")
    np.testing.assert_allclose(
        [surface.moment(k) for k in (1, 2, 3)], [0.75, np.log(4), 3.0], rtol=1e-12
    )
    np.testing.assert_allclose(surface.moment(3, 2.0, 9.0), 2.0, rtol=1e-12)
    np.testing.assert_allclose(surface.rms_height, np.sqrt(1.5 * np.pi), rtol=1e-12)
    np.testing.assert_allclose(surface.rms_slope, np.sqrt(6 * np.pi), rtol=1e-12)
    np.testing.assert_allclose(
        surface.full_contact_length, 2 * np.log(4) / 3, rtol=1e-12
    )


def test_lines_of_a_spectrum():
    surface = em.SelfAffine(0.7, rms_slope=0.2, q_low=1e3, q_high=4e4, q_rolloff=3e3)
    lines = [synthesise(surface, seed) for seed in (0, 0, 1)]
    assert (lines[0].height == lines[1].height).all()
    assert (lines[0].height != lines[2].height).any()
    np.testing.assert_allclose(lines[2].rms_height, surface.rms_height, rtol=1e-9)
    np.testing.assert_allclose(lines[2].rms_slope, surface.rms_slope, rtol=1e-2)


def test_measured_profile(tmp_path):
    surface = em.SelfAffine(0.8, rms_height=2e-5, q_low=2e3, q_high=2e5)
    x = np.arange(8192) * 5e-6
    step = 2 * np.pi / (8192 * 5e-6)
    rng = np.random.default_rng(0)
    q, k = step * np.arange(1, 4096), np.concatenate([[0], np.geomspace(10, 2e5, 2000)])
    power = np.array([2 * np.trapezoid(surface.at(np.hypot(w, k)), k) for w in q])
    waves = np.concatenate(
        [
            [0],
            4096 * np.sqrt(4 * power * step) * np.exp(2j * np.pi * rng.random(q.size)),
            [0],
        ]
    )
    cut = np.fft.irfft(waves, 8192) + 1e-3 * x
    rows = [
        f"{1e3 * a!r},{1e6 * h!r}"
        for a, h in zip(x.tolist(), cut.tolist(), strict=True)
    ]
    rows[100] = f"{1e3 * x[100]!r},"
    rows.append(rows[50])
    file = tmp_path / "cut.csv"
    file.write_text("x [mm],height [um]\n" + "\n".join(rows))
    got = em.read_surface(file, shortest=2 * np.pi / 1.6e5)
    np.testing.assert_allclose(got.measured_height, (cut - 1e-3 * x).std(), rtol=0.02)
    assert got.rms_height < 1.1 * got.measured_height
    kept = 2 * np.pi * surface.moment(3, got.q_low, got.q_high)
    np.testing.assert_allclose(got.rms_slope, kept**0.5, rtol=0.05)
    for word in ("1 of 8193 points without a value", "came before"):
        assert word in " ".join(got.report)
    file.write_text("x,height\n0,0\n1,1")
    with pytest.raises(em.InputError, match="no unit of length"):
        em.read_surface(file)


# maps whose points are a metre apart: the unit does not matter there
in_steps_of_one = pytest.mark.filterwarnings("ignore:a scan is")
HEIGHT = 0.1 * np.cumsum(
    np.cumsum(np.random.default_rng(0).standard_normal((64, 32)), axis=0), axis=1
)
READER = """
import json
import numpy as np
class Found:
    default_channel = property(lambda self: self)
    dim, unit, nb_grid_pts, physical_sizes = 2, "um", (64, 32), (128.0, 64.0)
    def __init__(self, path):
        self.values = json.loads(open(path).read())
    topography = lambda self: self
    heights = lambda self: np.ma.masked_invalid(np.array(self.values, float))
open_topography = Found
"""


def as_table(folder, height):
    i, j = np.indices(height.shape)
    rows = np.stack([2.0 * i, 2.0 * j, height], axis=-1).reshape(-1, 3).tolist()
    (folder / "map.csv").write_text(
        "x [um],y [um],h [um]\n" + "\n".join(",".join(map(repr, row)) for row in rows)
    )
    return em.read_surface(folder / "map.csv")


def test_file_of_an_instrument_by_a_reader_in_its_place(tmp_path, monkeypatch):
    """The package that reads such files is an extra; here a module of its name stands
    in for it.
    """
    expected = as_table(tmp_path, HEIGHT)
    file = tmp_path / "map.x3p"
    file.write_text(str(HEIGHT.tolist()))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(em.InputError, match=r"elastomdr\[instruments\]"):
        em.read_surface(file)
    monkeypatch.undo()
    (tmp_path / "SurfaceTopography.py").write_text(READER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    got = em.read_surface(file)
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-9)
    file.write_text("[[1, 2")
    with pytest.raises(em.InputError, match=r"map\.x3p': JSONDecodeError"):
        em.read_surface(file)


@pytest.mark.filterwarnings("ignore:.*mpi4py:ImportWarning")
def test_file_of_an_instrument(tmp_path):
    """By SurfaceTopography; the test above does without."""
    from SurfaceTopography import Topography

    made = Topography(HEIGHT, (128.0, 64.0), unit="um")
    made.to_x3p(tmp_path / "map.x3p")
    np.testing.assert_allclose(
        em.read_surface(tmp_path / "map.x3p").c, as_table(tmp_path, HEIGHT).c, rtol=1e-6
    )


def test_bad_surfaces():
    with refused("convention"):
        em.Spectrum(TABLE, SURFACE.c, convention="psd")
    with refused("q", 2, 3):
        em.Spectrum([1e2, 1e4], [1e-9, 1e-15], convention="1d")
    with pytest.raises(em.InputError, match="ascending"):
        em.Spectrum([2.0, 1.0], [1.0, 1.0], convention="2d")
    with refused("rms_height", "rms_slope"):
        em.SelfAffine(0.8, rms_slope=0.1, rms_height=1e-6, q_low=1.0, q_high=2.0)


@pytest.mark.parametrize(
    "given",
    [{"rms_slope": 1e200}, {"rms_height": 1e-200}, {"rms_slope": 1.0, "q_high": 1e300}],
)
def test_a_spectrum_beyond_double_precision(given):
    with pytest.raises(em.InputError, match=r"rms_|1e100"):
        em.SelfAffine(0.8, **{"q_low": 1e3, "q_high": 1e6, **given})


def test_line_of_a_surface():
    """`surface.line(seed)` has the surface's rms height and, as its slope, the whole
    |grad h|.
    """
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    line = surface.line(seed=3, periods=2, samples=1024)
    np.testing.assert_allclose(line.period, 2 * 2 * np.pi / 1e3, rtol=1e-12)
    np.testing.assert_allclose(np.std(line.height), surface.rms_height, rtol=1e-2)
    np.testing.assert_allclose(line.rms_slope, 0.3, rtol=2e-2)
    assert (surface.line(seed=3, periods=2, samples=1024).height == line.height).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"periods": 2.5}, ("periods", 1)),
        ({"samples": "many"}, ("samples", 64)),
        ({"samples": 2**30}, ("samples", 64, 67108864)),
        ({"periods": 2**26}, ("q_high", 125, 20000, "periods")),
    ],
)
def test_a_line_that_is_never_drawn(given, message):
    """In an instant, and not when the memory is gone; `em.friction` says the same."""
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with refused(*message):
        surface.line(**given)
    rubber = em.Foundation(1e6, [1e6], [1.0])
    with refused(*message):
        em.friction(rubber, surface, velocity=1.0, pressure=1e5, model=em.Line(**given))


def isotropic_map(n: int = 96) -> np.ndarray:
    """Heights [um] of random phases under C ~ q^-3.6, from 2 to 24 waves of n points,
    rms 10.
    """
    rng = np.random.default_rng(5)
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(n, 1 / n)))
    amplitude = np.where((k >= 2) & (k <= n / 4), np.maximum(k, 1.0) ** -1.8, 0.0)
    height = np.fft.ifft2(amplitude * np.exp(2j * np.pi * rng.random((n, n)))).real
    return 10 * height / height.std()


def map_file(path, rows, **options):
    path.write_text(
        "x [um],y [um],h [um]\n"
        + "\n".join(",".join(map(repr, row)) for row in np.asarray(rows).tolist())
    )
    return em.read_surface(path, **options)


def test_maps_with_flaws(tmp_path):
    """Holes, repeated and shuffled points, and coarse heights are mended or at least
    named, and change little.
    """
    height, rng = isotropic_map(), np.random.default_rng(0)
    n = len(height)
    rows = np.stack([*(10.0 * i for i in np.indices((n, n))), height], axis=-1).reshape(
        -1, 3
    )
    clean = map_file(tmp_path / "map.csv", rows)
    assert all(
        text.startswith(("rms ", "cut at", "heights of", "no `shortest`"))
        for text in clean.report
    )

    shuffled = map_file(tmp_path / "map.csv", rng.permutation(rows))
    np.testing.assert_allclose(shuffled.c, clean.c, rtol=1e-9)
    assert shuffled.report == clean.report

    higher = np.array([0, 0, 0.2])
    again = map_file(
        tmp_path / "map.csv",
        np.concatenate([rows, rows[:500] + higher, rows[:500] - higher]),
    )
    np.testing.assert_allclose(again.c, clean.c, rtol=1e-9)
    assert mentions(again.report, 1000, "heights averaged")

    coarse = map_file(
        tmp_path / "map.csv",
        np.column_stack([rows[:, :2], 4 * np.round(rows[:, 2] / 4)]),
    )
    assert "coarsely rounded" in coarse.report[0]

    for share in (0.02, 0.1, 0.3):
        holed = rows.copy()
        side = round(n * share**0.5)
        holed[
            (holed[:, :2] >= 200).all(axis=1)
            & (holed[:, :2] < 200 + 10 * side).all(axis=1),
            2,
        ] = np.nan
        got = map_file(tmp_path / "map.csv", holed, shortest=2 * np.pi / clean.q_high)
        assert "bridged smoothly" in got.report[0]
        assert abs(got.rms_slope / clean.rms_slope - 1) < max(0.05, share)
        assert bool(slices(got.report, f"{share:.0%} of the scan")) == (share > 0.05)


def test_table_that_begins_with_a_hole(tmp_path):
    x = np.arange(256) * 10.0
    height = np.cumsum(np.random.default_rng(1).standard_normal(256))
    for holes in (["0,"], ["0,nan", "10,-"]):
        rows = [
            *holes,
            *(
                f"{a!r},{h!r}"
                for a, h in zip(
                    x[len(holes) :].tolist(), height[len(holes) :].tolist(), strict=True
                )
            ),
        ]
        (tmp_path / "cut.csv").write_text("x [um],height [um]\n" + "\n".join(rows))
        got = em.read_surface(tmp_path / "cut.csv")
        assert f"{len(holes)} of 256 points without a value" in got.report[0]


@pytest.fixture(scope="module")
def synthetic():
    """The surfaces of known spectrum of `benchmarks/topography.py`."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
        return importlib.import_module("topography")


# of the roll-off, in the length of the scan
@in_steps_of_one
@pytest.mark.parametrize("waves", [8.0, 1.0, 0.25])
@pytest.mark.parametrize("kind", ["periodic", "cut", "sampled"])
@pytest.mark.parametrize(
    ("dimensions", "hurst", "scans"), [(2, 0.5, 6), (2, 0.9, 6), (1, 0.7, 20)]
)
def test_recovered_spectrum(synthetic, dimensions, hurst, scans, kind, waves):
    """C of known surfaces within 15 % on average over the band, and within its stated
    error.
    """
    ratio, score = synthetic.recovered(dimensions, kind, hurst, waves, scans)
    assert abs(np.exp(np.log(ratio).mean()) - 1) < 0.15
    assert 0.5 < (score**2).mean() ** 0.5 < 1.3
    if dimensions == 2:
        assert np.abs(np.log(ratio.mean(axis=0)[-6:])).max() < np.log(1.15)


def slices(report, start):
    return [text for text in report if text.startswith(start)]


@in_steps_of_one
def test_heights_and_slopes_of_data_and_spectrum(synthetic):
    """Long waves that the spectrum leaves out are reported, and both slopes."""
    for dimensions in (1, 2):
        height, step, _, _ = synthetic.scan(dimensions, "cut", 0.9, 0.25, seed=0)
        got = em.read_surface(height, pixel_size=step)
        (heights,), slopes = (
            slices(got.report, "rms height"),
            slices(got.report, "rms slope"),
        )
        assert got.rms_height < got.measured_height
        assert mentions(heights, "<h^2>", "waves longer")
        measured, in_spectrum = (float(text.split()[2]) for text in slopes)
        differences = [np.diff(height, axis=i) / step for i in range(dimensions)]
        expected = sum(np.mean((one - one.mean()) ** 2) for one in differences) ** 0.5
        np.testing.assert_allclose(measured, expected, rtol=2e-2)
        np.testing.assert_allclose(in_spectrum, got.rms_slope, rtol=1e-3)
    # a step up and down, too wide for a spike, where the window is small
    height[3:10, 3:10] += 20.0
    stepped = em.read_surface(height, pixel_size=step)
    # 49 of 65536 points make no skewness of their own
    assert abs(stepped.skewness - got.skewness) < 0.05
    (asymmetry,) = slices(stepped.report, "heights of these")
    assert mentions(asymmetry, 49, 65536, 6)


def test_moments_of_the_heights_between_two_wave_numbers():
    """Of A (cos(8 x) + cos(16 x)/2), with shorter waves that are left out."""
    step = 2 * np.pi / 512
    x, size = step * np.arange(512), 3e-6
    long = size * (np.cos(8 * x) + 0.5 * np.cos(16 * x))
    scan = topography.Scan(long + 0.2 * size * np.cos(100 * x), (step,))
    found = topography._moments(scan, topography._waves(scan), 4.0, 32.0)
    np.testing.assert_allclose(found.rms, np.sqrt(0.625) * size, rtol=1e-9)
    np.testing.assert_allclose(found.skewness, 0.375 / 0.625**1.5, rtol=1e-9)


@in_steps_of_one
def test_white_noise_is_cut_off(synthetic):
    height, step, factor, rolloff = synthetic.scan(2, "cut", 0.8, 0.25, seed=1)
    noisy = height + 0.1 * np.random.default_rng(0).standard_normal(height.shape)
    got = em.read_surface(noisy, pixel_size=step)
    assert "white noise" in got.report[0]
    assert 4.5 < 2 * np.pi / got.q_high < 20
    ratio = got.c / (factor * synthetic.true(got.q, 0.8, rolloff))
    np.testing.assert_allclose(np.log(ratio[-6:]).mean(), 0, atol=0.15)
    kept = em.read_surface(noisy, pixel_size=step, shortest=4.0)
    np.testing.assert_allclose(2 * np.pi / kept.q_high, 4.0)


def test_a_spectrum_that_ends_is_kept_to_its_end():
    height = isotropic_map(256)  # up to 64 waves, four steps
    n = np.fft.fft2(height)
    k = np.hypot(
        *np.meshgrid(np.fft.fftfreq(256, 1 / 256), np.fft.fftfreq(256, 1 / 256))
    )
    ended = np.fft.ifft2(np.where(k <= 30, n, 0)).real
    got = em.read_surface(1e-6 * ended, pixel_size=1e-5)
    # the window of the scan smears by a wave
    assert 29 < got.q_high * 256e-5 / (2 * np.pi) < 32
    assert got.lay is None


@in_steps_of_one
def test_scans_joined(synthetic):
    """One surface, from afar and from close by: the spectrum goes from the longest to
    the shortest wave of both.
    """
    whole = synthetic.heights(2, 1024, 1.0, 0.8, 0.01, seed=2)
    whole = 0.1 * whole / np.diff(whole, axis=0).std()
    scans = [whole[::4, ::4], whole[:200, :200]]
    got = em.read_surface(scans, pixel_size=[4.0, 1.0])
    np.testing.assert_allclose(
        [2 * np.pi / got.q_low, 2 * np.pi / got.q_high], [512, 4]
    )
    joined = slices(got.report, "2 scans joined")[0]
    assert 1 < float(joined.split("factor of ")[1].split()[0]) < 3
    shape = got.c / synthetic.true(got.q, 0.8, 0.01)
    assert np.log(shape / shape[-1]).std() < 0.25
    for scan, size in zip(scans, (4.0, 1.0), strict=True):
        alone = em.read_surface(scan, pixel_size=size)
        inside = (got.q >= alone.q_low) & (got.q <= alone.q_high)
        error = np.interp(np.log(got.q[inside]), np.log(alone.q), alone.relative_error)
        assert (
            np.abs(np.log(got.c[inside] / alone.at(got.q[inside]))) < 3 * error + 0.1
        ).all()
        assert (got.relative_error[inside] < 1.2 * error + 0.02).all()
    apart = em.read_surface([scans[0], 2 * scans[1]], pixel_size=[4.0, 1.0])
    assert (
        float(slices(apart.report, "2 scans")[0].split("factor of ")[1].split()[0])
        > 2.5
    )


@in_steps_of_one
def test_lay_of_a_stretched_surface(synthetic):
    """A map that is isotropic has no lay; squeezed in x, its lay runs along y, and rms
    slopes by scale say how far it is stretched, within what chance allows.

    At H = 0.8 a stretch by 3 is a Peklenik number of 3^0.9 by those slopes.
    """
    height, step, _, _ = synthetic.scan(2, "cut", 0.8, 0.25, seed=0)
    plain = em.read_surface(height, pixel_size=step)
    assert plain.lay is None
    assert not slices(plain.report, "the surface is not")
    with warned(UserWarning, "not isotropic", "lay runs at"):
        stretched = em.read_surface(height[::3], pixel_size=1.0)
    assert slices(stretched.report, "the surface is not")
    lay = stretched.lay
    off = (lay.log_peklenik - 0.9 * np.log(3)) / np.hypot(lay.error, 0.1)
    assert np.sqrt((off**2).mean()) < 1.5
    # at random wave numbers W is 1 on average over the angle
    angle = np.pi * (np.arange(200) + 0.5) / 200
    weight = lay.weight(lay.q[:, None], np.cos(angle) ** 2, np.sin(angle) ** 2)
    np.testing.assert_allclose(weight.mean(axis=1), 1, rtol=1e-12)


@in_steps_of_one
def test_cross_hatch(synthetic):
    grooves = synthetic.scan(2, "cut", 0.8, 0.25, seed=0)[0][::3]
    grooves = grooves[:, : grooves.shape[0]]
    crossed = grooves + grooves.T
    assert any(
        "cross-hatch" in said
        for said in em.read_surface(crossed, pixel_size=1.0).report
    )


def test_arrays_and_files_of_heights(tmp_path):
    """Arrays, masked arrays, matrices and columns in files, and pixels that are not
    square give the same surface.
    """
    height = 1e-6 * isotropic_map()
    expected = em.read_surface(height, pixel_size=1e-5)
    np.savetxt(tmp_path / "map.csv", 1e6 * height, delimiter=",")
    for got in (
        em.read_surface(tmp_path / "map.csv", pixel_size=1e-5, unit="um"),
        em.read_surface(height.tolist(), pixel_size=(1e-5, 1e-5)),
        em.read_surface(
            np.ma.masked_array(height, np.zeros(height.shape)), pixel_size=1e-5
        ),
        em.read_surface([height], pixel_size=[1e-5]),
    ):
        np.testing.assert_allclose(got.c, expected.c, rtol=1e-6)
    profile = height.ravel()[:900]
    np.savetxt(tmp_path / "cut.txt", 1e6 * profile)
    got = em.read_surface(
        tmp_path / "cut.txt", pixel_size=1e-5, unit="um", shortest=4e-5
    )
    np.testing.assert_allclose(
        got.c, em.read_surface(profile, pixel_size=1e-5, shortest=4e-5).c, rtol=1e-6
    )
    holed = height.copy()
    holed[10:12, 20:30] = np.nan
    assert "bridged smoothly" in em.read_surface(holed, pixel_size=1e-5).report[0]
    wide = em.read_surface(height[:, ::2], pixel_size=(1e-5, 2e-5))
    inside = wide.q < 0.4 * wide.q_high
    np.testing.assert_allclose(wide.c[inside], expected.at(wide.q[inside]), rtol=0.25)


def test_file_of_an_instrument_without_a_size(tmp_path):
    height = 1e-6 * isotropic_map()
    np.save(tmp_path / "map.npy", 1e6 * height)
    with refused("unit", "given", "'map.npy'"):
        em.read_surface(tmp_path / "map.npy", pixel_size=1e-5)
    with refused("pixel_size", "given", "'map.npy'"):
        em.read_surface(tmp_path / "map.npy", unit="um")
    got = em.read_surface(tmp_path / "map.npy", unit="um", pixel_size=1e-5)
    np.testing.assert_allclose(
        got.c, em.read_surface(height, pixel_size=1e-5).c, rtol=1e-6
    )


@pytest.mark.parametrize(
    ("height", "options", "message"),
    [
        (HEIGHT, {}, ("pixel_size", "heights")),
        (HEIGHT, {"pixel_size": 0.0}, ("pixel_size", 0)),
        (
            HEIGHT,
            {"pixel_size": (1.0, -1.0)},
            ("pixel_size", -1),
        ),
        (HEIGHT, {"pixel_size": (1.0, 1.0, 1.0)}, ("pixel_size", 1.0)),
        (
            HEIGHT,
            {"pixel_size": 1e-6},
            ("path_or_heights", "pixel_size"),
        ),
        (HEIGHT, {"pixel_size": 2.0, "unit": "um"}, ("unit", "metres")),
        (
            HEIGHT,
            {"pixel_size": 2.0, "shortest": 1e3},
            ("shortest", 4, 16, 1000),
        ),
        (
            HEIGHT,
            {"pixel_size": 2.0, "shortest": 1.0},
            ("shortest", 1),
        ),
        (
            HEIGHT[:1],
            {"pixel_size": 2.0},
            ("path_or_heights", 16, 1, 32),
        ),
        (
            HEIGHT[:, :1],
            {"pixel_size": 2.0},
            ("path_or_heights", 16, 64, 1),
        ),
        (HEIGHT[:9], {"pixel_size": 2.0}, ("path_or_heights", 16, 9, 32)),
        (
            HEIGHT[:, 0],
            {"pixel_size": 2.0, "shortest": 0.1},
            ("shortest", "two steps"),
        ),
        (
            HEIGHT[:40, 0],
            {"pixel_size": 2.0},
            ("path_or_heights", 64, 40),
        ),
        (
            HEIGHT[None],
            {"pixel_size": 2.0},
            ("path_or_heights", "(n_x", "n_y)", 1, 64, 32),
        ),
        (np.full((32, 32), np.nan), {"pixel_size": 2.0}, ("path_or_heights", "finite")),
        (np.zeros((32, 32)), {"pixel_size": 2.0}, ("path_or_heights", "plane")),
        (
            [HEIGHT, HEIGHT],
            {"pixel_size": [2.0]},
            ("pixel_size", 2),
        ),
        ({}, {"pixel_size": 2.0}, ("path_or_heights", "heights")),
    ],
)
def test_bad_scans(height, options, message):
    with refused(*message):
        em.read_surface(height, **options)


@pytest.mark.parametrize(
    "given",
    [
        {"periods": -1},
        {"periods": 0},
        {"points": 128.0},
        {"points": None},
        {"points": 2**16},
        {"seed": -1},
    ],
)
def test_a_map_that_is_never_drawn(given):
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with pytest.raises(em.InputError):
        em.reference.rough_map(surface, **given)


def test_lines_without_end():
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with refused("seeds", 1, 1000, 1000000000000):
        em.friction(
            em.Foundation(1e6, [1e6], [1.0]),
            surface,
            velocity=1.0,
            pressure=1e5,
            model=em.Line(seeds=10**12),
        )


@pytest.mark.filterwarnings("ignore")  # a skewed surface with a lay
@pytest.mark.parametrize("k", [1e-3, 1e3, 1 / 3])
@pytest.mark.parametrize("n", [96, 100])
def test_the_unit_of_length_changes_nothing(k, n):
    """Waves exactly at the ends of a band are in it whatever rounding makes of them."""
    white = np.fft.fft2(np.random.default_rng(1).standard_normal((n, n)))
    x, y = np.meshgrid(*[np.fft.fftfreq(n, 1 / n)] * 2, indexing="ij")
    heights = np.fft.ifft2(white / (9 + np.hypot(3 * x, y) ** 2)).real
    heights = -np.exp(-heights / (2 * heights.std())) * 4e-5
    one, other = (
        em.read_surface(heights * unit, pixel_size=1e-5 * unit) for unit in (1.0, k)
    )
    for name, power in (("skewness", 0), ("skewness_error", 0), ("q", -1), ("c", 4)):
        np.testing.assert_allclose(
            getattr(other, name), getattr(one, name) * k**power, rtol=1e-9
        )
    np.testing.assert_allclose(
        other.lay.log_peklenik, one.lay.log_peklenik, rtol=1e-8, atol=1e-10
    )


def test_complex_heights_are_refused():
    heights = np.random.default_rng(1).standard_normal((64, 64)) * 1e-6
    for given in (heights + 1e-6j, [heights, heights + 0j]):
        with pytest.raises(em.InputError, match="must be real numbers"):
            em.read_surface(given, pixel_size=1e-5)


def test_a_cutoff_that_jax_traces_is_refused_where_a_table_is_cut():
    """And has a derivative where the cutoff is the spectrum's own: here, of shorter waves
    at one rms slope, a negative one.
    """
    heights = np.random.default_rng(1).standard_normal((64, 64)) * 1e-6
    measured = em.read_surface(heights, pixel_size=1e-5, shortest=2e-5)
    rubber = em.StandardSolid(1e6, 3e7, 1e-3)

    def mu(road):
        return em.friction(rubber, road, velocity=0.1, pressure=1e5).mu

    def own(q_high):
        return mu(em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=q_high))

    with jax.enable_x64(True):
        for road in (
            measured,
            em.Spectrum([1e4, 1e6], [1e-18, 1e-25], convention="2d"),
        ):
            with refused("q_high", "plain numbers"):
                jax.grad(lambda q, road=road: mu(road.ended(q)))(1e5)
        slope = float(jax.grad(own)(8e3))
    assert slope < 0
    assert own(8.4e3) < own(7.6e3)


def test_a_profile_of_points_is_not_known_beyond_them():
    r = np.linspace(0.0, 1e-3, 51)
    points = em.Profile(r, r**2 / 0.02)
    inside, outside = np.array([-1e-3, 0.0, 1e-3]), np.array([-1.001e-3, 1.001e-3])
    for known in (points._profile, points._slope):
        assert np.isfinite(known(inside)).all()
        assert np.isnan(known(outside)).all()
