"""Surfaces: spectra and their normalisations, the lines made of them, measured profiles and files of instruments."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.mapping.synthesis import synthesise

TABLE = np.array([1e3, 1e6])
SURFACE = em.Spectrum(TABLE, 1e-17 * (TABLE / 1e3) ** -3.6, convention="2d")


def test_moments_of_a_spectrum():
    np.testing.assert_allclose(SURFACE.rms_height, 6.266521027154632e-06, rtol=1e-9)
    np.testing.assert_allclose(SURFACE.rms_slope, 0.04829559785736858, rtol=1e-9)
    same = em.SelfAffine(0.8, rms_height=6.266521027154632e-06, q_low=1e3, q_high=1e6)
    np.testing.assert_allclose(same.rms_slope, 0.04829559785736858, rtol=1e-9)
    np.testing.assert_allclose(em.Spectrum(TABLE, 4 * np.pi**2 * SURFACE.c, convention="2d/4pi^2").c, SURFACE.c)


def test_spectrum_of_a_cut():
    """C_cut = int C(sqrt(q^2 + k^2)) dk of a self-affine surface, by quadrature, and back."""
    true = em.SelfAffine(0.8, rms_height=1e-5, q_low=1e3, q_high=1e5)
    q, k = np.geomspace(1e3, 0.998e5, 300), np.concatenate([[0], np.geomspace(1, 1e5, 20000)])
    cut = np.array([2 * np.trapezoid(true.at(np.hypot(x, k)), k) for x in q])
    for name, factor in (("1d", 1), ("1d one-sided", 2), ("1d/2pi", 2 * np.pi)):
        back = em.Spectrum(q, factor * cut, convention=name)
        np.testing.assert_allclose(back.rms_height, 1e-5, rtol=2e-3)
        np.testing.assert_allclose(back.rms_slope, true.rms_slope, rtol=1e-2)


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
    waves = np.concatenate([[0], 4096 * np.sqrt(4 * power * step) * np.exp(2j * np.pi * rng.random(q.size)), [0]])
    cut = np.fft.irfft(waves, 8192) + 1e-3 * x
    rows = [f"{1e3 * a!r},{1e6 * h!r}" for a, h in zip(x.tolist(), cut.tolist(), strict=True)]
    rows[100] = f"{1e3 * x[100]!r},"
    rows.append(rows[50])
    file = tmp_path / "cut.csv"
    file.write_text("x [mm],height [um]\n" + "\n".join(rows))
    got = em.surface_from_file(file, shortest=2 * np.pi / 1.6e5)
    np.testing.assert_allclose(got.rms_height, (cut - 1e-3 * x).std(), rtol=0.02)
    assert 0.7 < got.rms_slope / surface.rms_slope < 1.2
    for word in ("1 of 8193 points without a value", "came before", "sorted"):
        assert word in " ".join(got.report)
    file.write_text("x,height\n0,0\n1,1")
    with pytest.raises(em.InputError, match="without a unit"):
        em.surface_from_file(file)


HEIGHT = np.cumsum(np.cumsum(np.random.default_rng(0).standard_normal((64, 32)), axis=0), axis=1)
READER = """
import json
import numpy as np
class Found:
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
    (folder / "map.csv").write_text("x [um],y [um],h [um]\n" + "\n".join(",".join(map(repr, row)) for row in rows))
    return em.surface_from_file(folder / "map.csv")


def test_file_of_an_instrument_by_a_reader_in_its_place(tmp_path, monkeypatch):
    """The package that reads such files is an extra; here a module of its name stands in for it."""
    expected = as_table(tmp_path, HEIGHT)
    file = tmp_path / "map.x3p"
    file.write_text(str(HEIGHT.tolist()))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(em.InputError, match=r"elastomdr\[instruments\]"):
        em.surface_from_file(file)
    monkeypatch.undo()
    (tmp_path / "SurfaceTopography.py").write_text(READER)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.syspath_prepend(tmp_path)
    got = em.surface_from_file(file)
    np.testing.assert_allclose(got.c, expected.c, rtol=1e-9)
    file.write_text("[[1, 2")
    with pytest.raises(em.InputError, match=r"got 'map.x3p': JSONDecodeError"):
        em.surface_from_file(file)


def test_file_of_an_instrument(tmp_path):
    """Needs SurfaceTopography; the test above does without."""
    topography = pytest.importorskip("SurfaceTopography")
    made = topography.Topography(HEIGHT, (128.0, 64.0), unit="um")
    made.to_x3p(tmp_path / "map.x3p")
    np.testing.assert_allclose(em.surface_from_file(tmp_path / "map.x3p").c, as_table(tmp_path, HEIGHT).c, rtol=1e-6)


def test_bad_surfaces():
    with pytest.raises(em.InputError, match="convention must be one of"):
        em.Spectrum(TABLE, SURFACE.c, convention="psd")
    with pytest.raises(em.InputError, match="ascending"):
        em.Spectrum([2.0, 1.0], [1.0, 1.0], convention="2d")
    with pytest.raises(em.InputError, match="only one of them"):
        em.SelfAffine(0.8, rms_slope=0.1, rms_height=1e-6, q_low=1.0, q_high=2.0)


@pytest.mark.parametrize("given", [{"rms_slope": 1e200}, {"rms_height": 1e-200}, {"rms_slope": 1.0, "q_high": 1e300}])
def test_a_spectrum_beyond_double_precision(given):
    with pytest.raises(em.InputError, match="whose power spectrum double precision holds, got rms_"):
        em.SelfAffine(0.8, **{"q_low": 1e3, "q_high": 1e6, **given})


def test_line_of_a_surface():
    """`surface.line(seed)` has the surface's rms height and, as its slope, the whole |grad h|."""
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    line = surface.line(seed=3, periods=2, samples=1024)
    np.testing.assert_allclose(line.period, 2 * 2 * np.pi / 1e3, rtol=1e-12)
    np.testing.assert_allclose(np.std(line.height), surface.rms_height, rtol=1e-2)
    np.testing.assert_allclose(line.rms_slope, 0.3, rtol=2e-2)
    assert (surface.line(seed=3, periods=2, samples=1024).height == line.height).all()


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"periods": 2.5}, "periods must be a whole number, 1 to"),
        ({"samples": "many"}, "samples must be a whole number, 64 to"),
        ({"samples": 2**30}, "samples must be a whole number, 64 to 67108864"),
        ({"periods": 2**26}, "needs 1.07e\\+10 samples on a line"),
    ],
)
def test_a_line_that_is_never_drawn(given, message):
    """In an instant, and not when the memory is gone; `em.friction` says the same."""
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with pytest.raises(em.InputError, match=message):
        surface.line(**given)
    rubber = em.Foundation(1e6, [1e6], [1.0])
    with pytest.raises(em.InputError, match=message):
        em.friction(rubber, surface, velocity=1.0, pressure=1e5, **given)


def isotropic_map(n: int = 96) -> np.ndarray:
    """Heights [um] of random phases under C ~ q^-3.6, from 2 to 24 waves of n points, rms 10."""
    rng = np.random.default_rng(5)
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(n, 1 / n)))
    amplitude = np.where((k >= 2) & (k <= n / 4), np.maximum(k, 1.0) ** -1.8, 0.0)
    height = np.fft.ifft2(amplitude * np.exp(2j * np.pi * rng.random((n, n)))).real
    return 10 * height / height.std()


def map_file(path, rows):
    path.write_text("x [um],y [um],h [um]\n" + "\n".join(",".join(map(repr, row)) for row in np.asarray(rows).tolist()))
    return em.surface_from_file(path)


def test_maps_with_flaws(tmp_path):
    """Holes, repeated and shuffled points, and coarse heights are mended or at least named, and change little."""
    height, rng = isotropic_map(), np.random.default_rng(0)
    n = len(height)
    rows = np.stack([*(10.0 * i for i in np.indices((n, n))), height], axis=-1).reshape(-1, 3)
    clean = map_file(tmp_path / "map.csv", rows)
    assert clean.report == ()

    shuffled = map_file(tmp_path / "map.csv", rng.permutation(rows))
    np.testing.assert_allclose(shuffled.c, clean.c, rtol=1e-9)
    assert shuffled.report == ("points did not come row by row: sorted",)

    higher = np.array([0, 0, 0.2])
    again = map_file(tmp_path / "map.csv", np.concatenate([rows, rows[:500] + higher, rows[:500] - higher]))
    np.testing.assert_allclose(again.c, clean.c, rtol=1e-9)
    assert "1000 points at a place that came before: heights averaged" in again.report

    coarse = map_file(tmp_path / "map.csv", np.column_stack([rows[:, :2], 4 * np.round(rows[:, 2] / 4)]))
    assert "coarsely rounded" in coarse.report[0]

    for share in (0.02, 0.1, 0.3):
        holed = rows.copy()
        side = round(n * share**0.5)
        holed[(holed[:, :2] >= 200).all(axis=1) & (holed[:, :2] < 200 + 10 * side).all(axis=1), 2] = np.nan
        got = map_file(tmp_path / "map.csv", holed)
        assert "bridged smoothly" in got.report[0]
        assert -1.2 * share < got.rms_slope / clean.rms_slope - 1 < 0.05
        assert ("low by about" in got.report[0]) == (share > 0.05)


def test_table_that_begins_with_a_hole(tmp_path):
    x = np.arange(256) * 10.0
    height = np.cumsum(np.random.default_rng(1).standard_normal(256))
    for holes in (["0,"], ["0,nan", "10,-"]):
        rows = [
            *holes,
            *(f"{a!r},{h!r}" for a, h in zip(x[len(holes) :].tolist(), height[len(holes) :].tolist(), strict=True)),
        ]
        (tmp_path / "cut.csv").write_text("x [um],height [um]\n" + "\n".join(rows))
        got = em.surface_from_file(tmp_path / "cut.csv")
        assert f"{len(holes)} of 256 points without a value" in got.report[0]


@pytest.mark.parametrize(
    "given", [{"periods": -1}, {"periods": 0}, {"points": 128.0}, {"points": None}, {"points": 2**16}, {"seed": -1}]
)
def test_a_map_that_is_never_drawn(given):
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with pytest.raises(em.InputError, match="must be a whole number"):
        em.reference.rough_map(surface, **given)


def test_lines_without_end():
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=2e4)
    with pytest.raises(em.InputError, match="seeds must be a whole number, 1 to 1000, got 1000000000000"):
        em.friction(em.Foundation(1e6, [1e6], [1.0]), surface, velocity=1.0, pressure=1e5, seeds=10**12)
