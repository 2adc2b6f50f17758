"""Friction that follows the slopes of the tops of measured heights."""

import dataclasses
import pickle

import jax
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

import elastomdr as em
from elastomdr.cli.kinds import read_scene
from elastomdr.surface.height_map import _PLACES, top_slope, top_slopes
from elastomdr.trees import same

from ..refused import warned

pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")

ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
BROAD = em.Prony(
    2e6,
    [3e8 * 10 ** (-0.35 * i) for i in range(8)],
    [10.0 ** (i - 8) for i in range(8)],
)
WARM = em.Prony(
    1e6, [3e7, 1e7, 3e6], [1e-6, 1e-5, 1e-3], shift=em.WLF(8.86, 101.6, 300.0)
)
SOFTENING = em.Softening([1e-3, 1e-2, 0.1, 1.0], [1, 0.9, 0.6, 0.4], [1, 1.2, 1.0, 0.8])
SHEAR = em.AdhesiveShear(1e5, 1e-2, 0.2)
HEAT = em.Heat(0.3, 2e6, road=(1.0, 2e6))
AT = {"velocity": 0.01, "pressure": 3e5}
# (friction, real contact) of `em.HalfSpace()` on `bent` maps at `AT`, rtol 1e-2
TRUTH = {
    "Gaussian": (0.07704, 0.1565),
    "low summits": (0.02923, 0.3486),
    "rounded": (0.02582, 0.4089),
    "cut off": (0.03292, 0.3352),
    "pits": (0.05297, 0.2091),
    "peaks": (0.14311, 0.0953),
    "long waves flat": (0.06764, 0.1714),
}


def bent(kind: str):
    """A periodic map of seed 3, bent or worn, as `em.read_surface` gives it."""
    n = 128
    height, side = em.reference.rough_map(ROAD, 3, periods=3, points=n)
    rms, waves = height.std(), np.fft.fftfreq(n, 1 / n)
    kept = np.hypot(waves[:, None], waves) <= 8
    long = np.fft.ifft2(np.where(kept, np.fft.fft2(height), 0)).real
    heights = {
        "Gaussian": height,
        "low summits": np.where(height > 0, 0.3 * height, height),
        "rounded": np.where(height > 0, 0.2 * rms * np.tanh(5 * height / rms), height),
        "cut off": np.minimum(height, 0.5 * rms),
        "pits": -np.expm1(-0.4 * height / rms),
        "peaks": np.expm1(0.4 * height / rms),
        "long waves flat": np.minimum(long, 0.2 * rms) + height - long,
    }[kind]
    if kind in ("pits", "peaks"):
        heights = heights * rms / 0.4
    return em.read_surface(heights, pixel_size=side / n, shortest=2 * np.pi / 8e3)


def gaussian(surface):
    """The same spectrum with Gaussian heights."""
    return em.Spectrum(surface.q, surface.c, convention="2d")


def with_tops(log_slope):
    """A measured surface with tops of one relative slope, at all shares."""
    return dataclasses.replace(bent("Gaussian"), tops=log_slope * np.ones(_PLACES.size))


@pytest.mark.parametrize("kind", TRUTH)
def test_maps_in_three_dimensions_are_within_the_bound(kind):
    surface, (mu, area) = bent(kind), TRUTH[kind]
    curve = em.friction(BROAD, surface, **AT)
    other = em.friction(BROAD, gaussian(surface), **AT)
    assert abs(curve.mu - mu) <= curve.model_error
    # waves cut at once leave ripples on flat summits, which the tops leave out: there
    # is more friction and less contact
    flat = kind in ("low summits", "rounded", "cut off")
    assert -0.1 < np.log(mu / curve.mu) - 0.2 * flat < 0.1
    assert -0.1 < np.log(curve.area_ratio / area) - 0.1 * flat < 0.1 or kind == "peaks"
    if kind == "Gaussian":
        # chance of three longest waves a side
        assert curve.mu == pytest.approx(other.mu, rel=0.06)
    elif kind != "long waves flat":
        assert abs(np.log(other.mu / mu)) > 2 * abs(np.log(curve.mu / mu))
        assert "which friction follows" in curve.summary()


def test_ratios_that_were_found_in_three_dimensions():
    """mu over that of Gaussian heights at 1, 3 and 10 % contact of these, cutoffs a
    factor of 64 apart: skewed at all scales by -1 and +1, and cut off.
    """
    n = 512
    road = em.SelfAffine(0.8, rms_slope=0.7, q_low=1e3, q_high=6.4e4)
    k = np.fft.fftfreq(n, 1 / n)
    q = np.hypot(k[:, None], k)
    amplitude = np.where((q >= 2) & (q <= 128), np.maximum(q, 1.0) ** -1.8, 0.0)
    white = np.random.default_rng(4).standard_normal((n, n))
    height = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    height /= height.std()
    found = {
        "worn": (-3 * np.exp(-height / 3), (0.34, 0.42, 0.52)),
        "peaked": (3 * np.exp(height / 3), (2.3, 1.9, 1.6)),
        "cut off": (np.minimum(height, 0.8), (0.11, 0.19, 0.36)),
    }
    pressure = np.geomspace(1e4, 1e7, 30)
    rubber = em.Prony(1e6, [3e7, 3e6, 1e7], [1e-6, 1e-3, 1e-5])
    plain = em.friction(rubber, road, velocity=0.1, pressure=pressure)
    for heights, expected in found.values():
        tops, *_ = top_slopes(heights, 0.5 * heights, (1.0, 1.0), 0.05)
        surface = dataclasses.replace(
            bent("Gaussian"), q=road.q, c=road.c, relative_error=0 * road.q, tops=tops
        )
        curve = em.friction(rubber, surface, velocity=0.1, pressure=pressure)
        at = np.log([0.01, 0.03, 0.1])
        ratio = np.interp(at, np.log(plain.area_ratio), curve.mu / plain.mu)
        np.testing.assert_allclose(np.log(ratio), np.log(expected), atol=0.35)


@pytest.mark.parametrize("ratio", [0.4, 1.5])
def test_tops_of_one_slope_are_heights_times_that(ratio):
    """With softening, heat of both bodies and adhesion, mu and all else."""
    rubber = dataclasses.replace(WARM, softening=SOFTENING)
    tops = with_tops(np.log(ratio))
    raised = gaussian(tops).raised(ratio)
    given = {"velocity": [0.1, 1.0], "pressure": 1e5, "temperature": 300.0}
    for more in ({}, {"heat": HEAT, "adhesion": SHEAR}):
        curve, other = (
            em.friction(rubber, road, **given, **more) for road in (tops, raised)
        )
        names = ["mu", "area_ratio", "linear", "cold", "contact_rise", "adhesion"]
        for name in names if more else names[:3]:
            np.testing.assert_allclose(
                getattr(curve, name), getattr(other, name), rtol=1e-5, err_msg=name
            )
        assert curve.converged.all()


def test_the_contact_is_that_of_its_own_tops():
    surface = bent("rounded")
    curve = em.friction(BROAD, surface, **AT)
    ratio = np.exp(top_slope(surface.tops, curve.area_ratio))
    other = em.friction(BROAD, gaussian(surface).raised(float(ratio)), **AT)
    np.testing.assert_allclose(
        [curve.mu, curve.area_ratio], [other.mu, other.area_ratio], rtol=1e-6
    )
    assert ratio < 0.5
    # in full contact all waves count alike
    full = [em.friction(BROAD, s, velocity=0.01, pressure=1e9)
            for s in (surface, gaussian(surface))]  # fmt: skip
    assert full[0].mu == pytest.approx(full[1].mu, rel=1e-9)


def slope(function, at):
    step = 1e-4 * at
    return (function(at + step) - function(at - step)) / (2 * step)


@pytest.mark.parametrize(
    "more",
    [{}, {"heat": HEAT, "adhesion": SHEAR}, {"softening": SOFTENING}],
    ids=["plain", "heat and adhesion", "softening"],
)
def test_derivatives(more):
    """Of pressure, velocity and moduli at once, against differences."""
    surface, calls = bent("low summits"), dict(more)
    soft = calls.pop("softening", None)

    def mu(given):
        p, v, level = given
        rubber = em.Prony(
            1e6,
            level * np.array([3e7, 1e7, 3e6]),
            [1e-6, 1e-5, 1e-3],
            shift=em.WLF(8.86, 101.6, 300.0),
            softening=soft,
        )
        at = {"velocity": 0.1 * v, "pressure": 1e5 * p, "temperature": 300.0}
        return em.friction(rubber, surface, **at, **calls, rtol=1e-7).mu

    with jax.enable_x64(True):
        value, found = map(np.asarray, jax.jit(jax.value_and_grad(mu))(np.ones(3)))
    np.testing.assert_allclose(value, mu(np.ones(3)), rtol=1e-9)
    expected = [
        slope(lambda x, i=i: float(mu(np.where(np.arange(3) == i, x, 1.0))), 1.0)
        for i in range(3)
    ]
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-7)


def test_vmap_and_many_points_are_each_alone():
    surface = bent("pits")
    pressure = np.array([3e4, 3e5, 3e6])

    def mu(p):
        return em.friction(BROAD, surface, velocity=0.01, pressure=p).mu

    alone = [float(mu(p)) for p in pressure]
    np.testing.assert_allclose(mu(pressure), alone, rtol=1e-9)
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.vmap(mu)(pressure), alone, rtol=1e-9)
    both = em.friction([BROAD, WARM.at(300.0)], surface, **AT)
    assert float(both.mu[0]) == float(em.friction(BROAD, surface, **AT).mu)


def test_other_models_say_that_they_take_gaussian_heights():
    surface = bent("rounded")
    for model in (em.Persson(), em.HalfSpace(cells=64, periods=1)):
        curves = [
            em.friction(BROAD, road, **AT, model=model, rtol=1e-2)
            for road in (surface, gaussian(surface))
        ]
        assert curves[0].mu == curves[1].mu
        assert curves[0].model_error > curves[0].mu
        assert "leaves out" in curves[0].summary()
    itself = em.friction(BROAD, surface, **AT, model=em.HalfSpace(), rtol=1e-2)
    assert itself.model_error is None
    assert itself.mu == pytest.approx(TRUTH["rounded"][0], rel=2e-3)
    # its contact is that of `em.friction` at rest, with the bound of that
    held = em.break_out(BROAD, surface, pressure=1e4, boundary_shear=1e5)
    plain = em.break_out(BROAD, gaussian(surface), pressure=1e4, boundary_shear=1e5)
    assert held.area_ratio > 1.2 * plain.area_ratio


def test_tops_are_kept_by_what_is_made_of_a_surface(tmp_path):
    surface = bent("low summits")
    assert same(pickle.loads(pickle.dumps(surface)).tops, surface.tops)
    assert same(surface.raised(2.0).tops, surface.tops)
    assert same(surface.draws(2, level=0.1)[0].tops, surface.tops)
    with warned(em.ModelWarning, "random maps"):
        assert same(surface.ended(2 * surface.q_high).tops, surface.tops)
    short = surface.ended(0.6 * surface.q_high)
    np.testing.assert_allclose(short.tops[:14], surface.tops[:14], atol=0.2)
    assert not same(short.tops, surface.tops)

    swept = em.sweep(
        em.friction,
        {"velocity": [0.01]},
        store=tmp_path / "swept.zarr",
        progress=False,
        material=BROAD,
        surface=surface,
        pressure=3e5,
    )
    expected = em.friction(BROAD, surface, velocity=[0.01], pressure=3e5)
    np.testing.assert_array_equal(swept["mu"], expected.mu)

    height = surface.map.height
    np.savetxt(tmp_path / "road.txt", height)
    (tmp_path / "road.toml").write_text(
        f"""
        material = "sbr-gum-like"
        [surface]
        shape = "file"
        file = "road.txt"
        unit = "m"
        pixel_size = "{surface.map.steps[0]:.12g} m"
        shortest = "{2e3 * np.pi / 8e3:.12g} mm"
        [contact]
        pressure = "0.1 MPa"
        velocity = "0.1 m/s"
        """
    )
    scene = read_scene("friction", tmp_path / "road.toml").arguments(tmp_path)
    np.testing.assert_allclose(scene["shape"].tops, surface.tops, atol=1e-9)


def test_the_slopes_of_tops():
    """Of a ramp whose upper half is a third as steep, as a profile and a map; flat tops
    are kept from zero, and what is too small is that of more.
    """
    upper = np.exp(-(_PLACES**2)) < 0.49
    for shape, steps in (((1,), (1.0,)), ((1, 40), (1.0, 2.0))):
        ramp = np.cumsum(np.repeat([3.0, 1.0], 1000)).reshape(-1, *shape[1:-1])
        ramp = ramp if len(shape) == 1 else ramp.reshape(-1, 1) * np.ones(shape)
        tops, *_ = top_slopes(ramp, 0.5 * ramp, steps, 0.01)
        assert tops[0] == 0
        np.testing.assert_allclose(tops[upper], -0.5 * np.log(5.0), atol=2e-3)
        flat, *_ = top_slopes(np.minimum(ramp, 3000.0), 0.5 * ramp, steps, 0.01)
        assert np.log(0.02) <= flat.min() < -3
        coarse, *_ = top_slopes(np.square(ramp), 0.5 * ramp, steps, 0.5)
        few = np.exp(-(_PLACES**2)) < 0.3 * 0.5**2
        assert (coarse[few] == coarse[-1]).all()
        assert coarse[few][0] != coarse[~few][-1]


def island_map(seed: int) -> np.ndarray:
    """A Gaussian map of 256 points a side and 3 micrometres rms."""
    n, rng = 256, np.random.default_rng(seed)
    k = np.hypot(*np.meshgrid(np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(n, 1 / n)))
    amplitude = np.where((k >= 6) & (k <= 72), np.maximum(k, 1) ** -1.8, 0)
    white = np.fft.fft2(rng.standard_normal((n, n)))
    height = np.fft.ifft2(white * amplitude).real
    return 3e-6 * height / height.std()


def read(height, **given):
    return em.read_surface(height, pixel_size=1e-6, **given)


ON_ROAD = {"velocity": 0.1, "temperature": 293.15, "pressure": 5e5}
TREAD = em.load_material("tread-passenger-synthetic")


@pytest.mark.parametrize(("kind", "true"), [("low", 0.1087), ("cut", 0.0770)])
def test_polished_maps_are_read_with_all_waves_they_have(kind, true):
    """Seed 60, against em.HalfSpace(): friction has no jump where the spectrum ends a
    little earlier.
    """
    h = island_map(60)
    surface = read(
        np.where(h > 0, 0.3 * h, h) if kind == "low" else np.minimum(h, 3e-6)
    )
    assert surface.q_high > 50 * 2 * np.pi / 256e-6
    curve = em.friction(TREAD, surface, **ON_ROAD)
    assert abs(curve.mu / true - 1) < 0.15
    assert abs(curve.mu - true) < curve.model_error
    ends = surface.q_high * np.geomspace(0.4, 0.9999, 12)
    mu = [float(em.friction(TREAD, surface.ended(q), **ON_ROAD).mu) for q in ends]
    assert np.diff(np.log([*mu, float(curve.mu)])).min() > -0.02
    np.testing.assert_allclose(curve.mu, mu[-1], rtol=1e-3)


def test_a_cutoff_is_found_on_a_polished_map():
    surface = read(np.minimum(island_map(1), 0.9e-6))
    true = 0.5 * surface.q_high
    velocity = np.geomspace(1e-4, 0.1, 6)
    at = {**ON_ROAD, "velocity": velocity, "temperature": np.full(6, 293.15)}
    measured = em.friction(TREAD, surface.ended(true), **at).mu
    fit = em.fit.calibrate(
        TREAD,
        surface,
        measured=measured,
        error=0.01 * measured,
        parameters=("q_high",),
        **at,
    )
    low, high = fit.interval("q_high")
    assert low <= np.log10(0.5) <= high
    assert abs(fit.residuals / measured).max() < 0.01


def test_plateaus_are_within_a_wider_bound():
    """Two heights, with skewness 0: em.HalfSpace() has far less friction and more
    contact at low pressures; with adhesion more friction.
    """
    b = island_map(10)
    steps = 3e-6 * np.tanh(10 * b / b.std()) + 0.05 * island_map(1)
    surface = read(steps)
    stiff = abs(em.half_space(BROAD).complex_modulus(np.array(surface.q_low * 1e-2)))
    pressure = np.array([0.01, 0.1]) * float(stiff) * surface.rms_slope
    at = {"velocity": 1e-2, "pressure": pressure}
    curve = em.friction(BROAD, surface, **at)
    found = em.friction(BROAD, surface, model=em.HalfSpace(), rtol=1e-2, **at)
    assert (abs(found.mu - curve.mu) < curve.model_error + found.error).all()
    assert [doubt.kind for doubt in curve.doubts] == ["bound"]
    # dry, on summits that were polished flat
    flat = read(np.minimum(island_map(20), 0.9e-6))
    pressure = 6e5
    for shear in (1.5, 6.0):
        dry = em.AdhesiveShear(shear * pressure, 1e-2, 0.1)
        at = {"velocity": 1e-2, "pressure": pressure, "adhesion": dry}
        curve = em.friction(BROAD, flat, **at)
        found = em.friction(BROAD, flat, model=em.HalfSpace(), rtol=1e-2, **at)
        assert found.mu > 2 * curve.mu
        assert curve.mu_low < found.mu < curve.mu_high
    # Gaussian heights have none of it
    assert read(island_map(1)).flat.max() < 0.1


@pytest.mark.parametrize("step", [0.15, 0.6])
def test_waves_that_reading_leaves_out_are_in_the_bound(step):
    """Terraces have slopes at waves of less than four steps: in light contact friction
    grows with the rms slope, in full contact with its square.
    """
    height = island_map(1)
    within = height / 3e-6 - np.floor(height / 3e-6) - 0.5
    stairs = 3e-6 * (height / 3e-6 - within + 0.5 * np.tanh(within / step))
    surface = read(stairs)
    k = 2e6 * np.pi * np.fft.fftfreq(256)
    squares = (np.abs(np.fft.fft2(stairs) / stairs.size) * np.hypot(k[:, None], k)) ** 2
    lost = np.log(squares.sum() ** 0.5 / surface.rms_slope)
    assert surface.left_out == pytest.approx(lost, abs=0.05)
    given = read(stairs, shortest=8e-6)
    assert abs(given.left_out) < 0.05
    assert abs(surface.ended(0.5 * surface.q_high).left_out) < 0.05
    at = {"velocity": 0.01, "pressure": [1e5, 1e9]}
    curve, without = (
        em.friction(BROAD, road, **at)
        for road in (surface, dataclasses.replace(surface, left_out=0.0))
    )
    np.testing.assert_allclose(curve.mu, without.mu, rtol=1e-12)
    added = (curve.model_error - without.model_error) / curve.mu
    expected = np.expm1(abs(surface.left_out) * (1 + curve.area_ratio))
    np.testing.assert_allclose(added, expected, rtol=1e-6)
    doubted = [doubt.points for doubt in curve.doubts if "shortest" in doubt.says]
    np.testing.assert_array_equal(np.any(doubted, axis=0), expected > 0.1)


def test_summits_without_the_fine_waves_are_within_a_wider_bound():
    """Worn smooth above the median: fine waves are missing there, and long ones are not,
    which one ratio of slopes does not say; em.HalfSpace() slides over the map.
    """
    height = island_map(71)
    smooth = gaussian_filter(height, 2.5, mode="wrap")
    worn = 1 / (1 + np.exp(-(smooth - np.median(smooth)) / 3e-7))
    surface = read(height + worn * (smooth - height))
    at = {"velocity": 0.1, "pressure": 1e6, "rtol": 1e-2}
    curve = em.friction(BROAD, surface, **at)
    found = em.friction(BROAD, surface, model=em.HalfSpace(), **at)
    assert abs(found.mu - curve.mu) < curve.model_error
    alike = dataclasses.replace(surface, unlike=0 * surface.unlike)
    assert curve.model_error > 1.3 * em.friction(BROAD, alike, **at).model_error
    shares = np.exp(-(_PLACES**2))
    np.testing.assert_array_less(0.4, surface.unlike[shares < 0.15])
    assert read(height).unlike[shares > 0.05].max() < 0.1
    # the end of the spectrum ends the difference with it
    assert surface.ended(0.2 * surface.q_high).unlike.mean() < surface.unlike.mean() / 2


def test_the_tops_of_scans_alike_are_those_of_all():
    """Not of the first of them alone."""
    scans = [em.read_surface(island_map(i), pixel_size=1e-6) for i in (1, 2)]
    both = em.read_surface([island_map(1), island_map(2)], pixel_size=1e-6)
    few = np.exp(-(_PLACES**2)) > 0.05
    mean = np.mean([scan.tops for scan in scans], axis=0)
    np.testing.assert_allclose(both.tops[few], mean[few], atol=0.01)
