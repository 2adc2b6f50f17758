"""The leak of a static seal: Reynolds' equation on maps against closed forms, gaps
against a third party's maps, the verb against its own parts.
"""

import dataclasses

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

import elastomdr as em
from elastomdr.rough.psd_integrals import nodes
from elastomdr.seal.gap_maps import (
    channels,
    effective_medium,
    flow,
    narrowest,
    pressed,
)
from elastomdr.seal.leak_theories import _medium
from elastomdr.seal.persson_gap import contact_of, mean_gap
from elastomdr.surface.lay import Lay
from elastomdr.surface.spectrum import rough_map
from elastomdr.surface.topography import MeasuredSurface

from ..refused import refused

RUBBER = em.StandardSolid(1e6, 3e6, 2.0, shift=em.WLF(8.86, 101.6, 293.15))  # in shear
ROUGH = em.SelfAffine(0.8, rms_slope=0.6, q_low=1e4, q_high=1.6e5)
SCENE = {
    "pressure": 3e5,
    "pressure_drop": 1e5,
    "viscosity": 2e-3,
    "length": 2e-3,
    "width": 0.1,
    "time": 100.0,
}


def axes(count):
    x = 2 * np.pi * (np.arange(count) + 0.5) / count
    return np.meshgrid(x, x, indexing="ij")


def extrapolated(gap):
    """The flow on ever finer grids, of second order."""
    coarse, fine = (flow(gap(*axes(count))).conductance[0] for count in (32, 64))
    return (4 * fine - coarse) / 3


def test_ridges_across_and_along_the_flow():
    """1/<g^-3> and <g^3> of g = 1 + a cos x, a = 1/2."""
    found = flow(1 + 0.5 * np.cos(axes(64)[0]))
    across, along = (1 - 0.25) ** 2.5 / (1 + 0.125), 1 + 1.5 * 0.25
    np.testing.assert_allclose(found.conductance, [across, along], rtol=1e-12)
    assert across == pytest.approx(0.4330127, rel=1e-7)


def test_egg_box():
    assert extrapolated(lambda x, y: 1 + 0.5 * np.cos(x) * np.cos(y)) == pytest.approx(
        0.9225, abs=5e-5
    )


def test_maps_that_equal_their_own_negative():
    """ln g^3 and its negative are one map, moved: w is the root of the product of both
    ends (Keller 1964; Dykhne 1971).
    """
    smooth = extrapolated(lambda x, y: np.exp(0.5 * np.cos(x) * np.cos(y)))
    assert smooth == pytest.approx(1.0, abs=3e-4)
    x, y = axes(64)
    board = np.where(np.sin(x) * np.sin(y) > 0, 1.0, 4.0)  # g^3
    across = flow(board ** (1 / 3)).conductance
    np.testing.assert_allclose(across, 2.0, rtol=0.01)


def test_another_solver():
    """reynoldsflow 0.1.3 (V. A. Yastrebov, BSD-3), periodic, on the same map."""
    x, y = axes(48)
    gap = 0.35 + np.cos(2 * x + y) * np.sin(y - x) + 0.6 * np.cos(3 * x - 2 * y + 0.4)
    gap = np.maximum(gap + 0.3 * np.sin(5 * y + x), 0.0)
    theirs = 0.0025564272839497643, 0.07488123302430472
    np.testing.assert_allclose(flow(gap).conductance, theirs, rtol=1e-10)


def test_channels_and_closed_maps():
    nothing = flow(np.zeros((8, 8)))
    assert nothing.conductance == (0.0, 0.0)
    assert nothing.percolates == (False, False)
    pool, channel = np.zeros((40, 60)), np.zeros((40, 60))
    pool[10:20, 5:20] = 1.0
    pool[35:, 30:] = pool[:5, 30:] = 2.0  # one pool, across an end
    assert flow(pool) == nothing
    channel[30:, :] = channel[:6, :] = 2.0
    found = flow(channel)
    assert found.percolates == (False, True)
    np.testing.assert_allclose(found.conductance, [0, 16 / 40 * 8], rtol=1e-12)


def test_a_channel_that_winds_twice():
    """It goes around one axis twice before it is back, so that neither axis is open in
    one step.
    """
    is_open = np.zeros((60, 60), bool)
    i = np.arange(120)
    for j in (0, 1):
        is_open[i % 60, (i // 2 + j) % 60] = True
    pools, windings = channels(is_open)
    assert list(windings.values()) == [(2, 1)]
    assert np.unique(pools[is_open]).size == 1
    assert flow(1.0 * is_open).percolates == (True, True)


def test_the_narrowest_place_of_the_widest_channel():
    gap = np.full((16, 16), 3.0)
    gap[8, :] = 1.0
    gap[8, 4] = 2.0  # the way along the first axis; along the second all is open
    assert narrowest(gap) == 2.5
    assert np.isnan(narrowest(np.zeros((4, 4))))


def test_a_plane_of_maps():
    """Two kinds alike often: the root of their product (Keller 1964)."""
    half = [0.5, 0.5]
    assert effective_medium(half, [1.0, 4.0], 2) == pytest.approx(2.0, rel=1e-12)
    assert effective_medium(half, [3.0, 3.0], 2) == pytest.approx(3.0, rel=1e-12)
    assert effective_medium(half, [0.0, 3.0], 2) == 0.0
    assert np.isnan(effective_medium(half, [np.nan, 3.0], 2))


# third party's maps (GFMD), H 0.8, cutoff ratio 100: p/E*, mean gap over rms height
MAPS = np.array(
    [
        [1e-4, 2.629],
        [1e-3, 1.883],
        [5e-3, 1.181],
        [0.01, 0.854],
        [0.015, 0.664],
        [0.025, 0.44],
        [0.04, 0.264],
    ]
).T


def test_mean_gap_is_that_of_a_third_partys_maps():
    surface = em.SelfAffine(0.8, rms_slope=0.2766, q_low=1e4, q_high=1e6)
    found = em.leak(
        em.Foundation(1.0, [], []),
        surface,
        pressure=MAPS[0],
        pressure_drop=1e-5,
        viscosity=1.0,
        length=1.0,
    )
    np.testing.assert_allclose(found.mean_gap / surface.rms_height, MAPS[1], rtol=0.07)


def test_perssons_gap_is_its_double_integral():
    level, area = 0.02, 0.1
    spectrum = em.SelfAffine(0.6, rms_slope=area, q_low=1.0, q_high=8.0)

    def of_wave(q):
        w = (np.pi * spectrum.moment(3, 1.0, q)) ** -0.5
        inner, _ = quad(
            lambda t: (0.45 + 3 * 0.55 * erf(t) ** 2) * np.exp(-(t**2)) / t,
            min(w * level, 8.0),
            8.0,
        )
        return q**2 * spectrum.at(q) * w * inner

    # w grows as (q - q_low)^-1/2, and the inner integral ends it
    whole, _ = quad(of_wave, 1.0 + 1e-12, 8.0, limit=400, epsrel=1e-7)
    found = mean_gap(contact_of(nodes(spectrum), np.array([level])))
    assert found[0] == pytest.approx(np.sqrt(np.pi) * whole, rel=2e-4)


def test_a_medium_of_one_gap_and_contact():
    """(1 - A)(w_1 - w)/(w_1 + (n-1) w) = A/(n-1) is linear: w = w_1 (1 - A n/(n-1))."""
    for closes, area in ((0.5, 0.2), (0.42, 0.3)):
        w = _medium(np.array([1.0]), np.array([2.0]), area, closes=closes)
        assert w == pytest.approx(8 * (1 - area / closes), rel=1e-10)
    assert _medium(np.array([1.0]), np.array([2.0]), 0.5, closes=0.5) == 0.0


def test_rate_is_conductance_times_drop():
    found = em.leak(RUBBER, ROUGH, density=900.0, **SCENE)
    rate = 0.1 / 2e-3 * found.conductance * 1e5
    np.testing.assert_allclose(found.rate, rate, rtol=1e-14)
    np.testing.assert_allclose(found.mass_rate, 900 * rate, rtol=1e-14)
    thin = em.leak(RUBBER, ROUGH, **{**SCENE, "viscosity": [1e-3, 4e-3]})
    np.testing.assert_allclose(thin.rate, found.rate * [2.0, 0.5], rtol=1e-14)
    assert found.percolates
    assert found.critical_gap > 0
    assert em.leak(RUBBER, ROUGH, **SCENE).mass_rate is None


def test_pressed_for_a_time_it_is_elastic_with_the_creep_of_that_time():
    time, kelvin = np.array([0.1, 10.0, 1e4]), np.array([[293.15], [313.15]])
    found = em.leak(RUBBER, ROUGH, **{**SCENE, "time": time}, temperature=kelvin)
    assert found.rate.shape == (2, 3)
    a = 10 ** (-8.86 * 20 / (101.6 + 20))
    reduced = np.array([time, time / a])
    modulus = 1 / em.half_space(RUBBER).creep_compliance(reduced)
    for i, j in np.ndindex(2, 3):
        elastic = em.Foundation(modulus[i, j], [], [])
        alone = em.leak(elastic, ROUGH, **{**SCENE, "time": None})
        for field in ("rate", "mean_gap", "critical_gap", "area_ratio", "model_error"):
            np.testing.assert_allclose(
                getattr(found, field)[i, j], getattr(alone, field), rtol=1e-9
            )
    # creep closes channels, until it is at its end
    assert (np.diff(found.rate, axis=1) <= 0).all()
    assert (found.rate[:, 0] > found.rate[:, 1]).all()


def test_it_scales_with_lengths_and_moduli():
    """Twice as large in all directions at the same slope: w grows as its cube."""
    large = em.SelfAffine(0.8, rms_slope=0.6, q_low=5e3, q_high=8e4)
    steep = em.SelfAffine(0.8, rms_slope=1.2, q_low=1e4, q_high=1.6e5)
    found = em.leak(RUBBER, ROUGH, **SCENE)
    np.testing.assert_allclose(
        em.leak(RUBBER, large, **SCENE).conductance, 8 * found.conductance, rtol=1e-9
    )
    twice = em.leak(RUBBER, steep, **{**SCENE, "pressure": 6e5, "pressure_drop": 2e5})
    np.testing.assert_allclose(twice.conductance, 8 * found.conductance, rtol=1e-9)
    np.testing.assert_allclose(twice.area_ratio, found.area_ratio, rtol=1e-12)


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_limits():
    """Barely touched the flow is that between planes at the mean gap; in nearly full
    contact nothing flows.
    """
    pressure = np.array([1e-3, 2e8])
    found = em.leak(
        RUBBER, ROUGH, **{**SCENE, "pressure": pressure, "pressure_drop": 1e-4}
    )
    w = 12 * 2e-3 * found.conductance[0]
    assert 0.9 < w / found.mean_gap[0] ** 3 < 1.0
    assert found.percolates.tolist() == [True, False]
    assert found.rate[1] == 0
    assert found.area_ratio[1] > 0.99
    assert found.mean_gap[1] == 0


def test_maps_in_three_dimensions():
    """Default and theories against gaps of the half-space; the default within the bound
    and the maps' scatter.
    """
    scene = {
        **SCENE,
        "pressure": np.array([2.5e4, 7.5e4, 1.5e5, 4e6]),
        "pressure_drop": 1e3,
    }
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=8e4)
    truth = em.leak(RUBBER, surface, model=em.HalfSpace(cells=128, seeds=3), **scene)
    found = em.leak(RUBBER, surface, **scene)
    assert (
        truth.percolates.tolist() == found.percolates.tolist() == [*3 * [True], False]
    )
    np.testing.assert_allclose(truth.mean_gap[:3], found.mean_gap[:3], rtol=0.15)
    off = np.abs(np.log(truth.rate[:3] / found.rate[:3]))
    assert (off < np.log1p(found.model_error + truth.error)[:3]).all()
    assert truth.model_error is None
    narrow = em.leak(RUBBER, surface, model="critical constriction", **scene)
    middle = em.leak(RUBBER, surface, model=em.EffectiveMedium(), **scene)
    assert (narrow.rate > truth.rate)[:3].all()
    assert (middle.rate > truth.rate)[:3].all()
    assert np.isnan(middle.model_error).all()


@pytest.mark.parametrize("seeds", [1, 2])
def test_maps_in_nearly_full_contact_are_closed_for_sure(seeds):
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=8e4)
    scene = SCENE | {"pressure": 4e6, "pressure_drop": 1e3}
    model = em.HalfSpace(cells=64, seeds=seeds)
    found = em.leak(RUBBER, surface, model=model, **scene)
    assert found.area_ratio > 0.5
    assert found.rate == 0
    assert found.error == 0


def test_derivatives():
    def rate(x):
        rubber = em.StandardSolid(x[0], 3e6, x[1])
        surface = em.SelfAffine(0.8, rms_slope=x[2], q_low=1e4, q_high=1.6e5)
        return em.leak(
            rubber, surface, **{**SCENE, "pressure": x[3], "viscosity": x[4]}
        ).rate

    x = np.array([1e6, 2.0, 0.6, 3e5, 2e-3])
    with jax.enable_x64(True):
        slopes = np.asarray(jax.jit(jax.grad(rate))(x))
    step = 1e-4 * x
    by_hand = [(rate(x + h) - rate(x - h)) / (2 * h.sum()) for h in np.diag(step)]
    np.testing.assert_allclose(slopes, by_hand, rtol=1e-4)
    with refused("model", "em.Multiscale", "jit"):
        jax.grad(
            lambda p: (
                em.leak(
                    RUBBER,
                    ROUGH,
                    model=em.CriticalConstriction(),
                    **{**SCENE, "pressure": p},
                ).rate
            )
        )(3e5)


@pytest.mark.parametrize("bits", [32, 64])
@pytest.mark.parametrize("pressure", [3e5, 1e7])
def test_derivatives_of_open_and_closed_channels_with_any_types(pressure, bits):
    def leak(p):
        return em.leak(RUBBER, ROUGH, **{**SCENE, "pressure": p})

    step = 1e-4 * pressure
    with jax.enable_x64(bits == 64):
        for key in ("rate", "mean_gap", "area_ratio"):
            slope = jax.grad(lambda p, key=key: getattr(leak(p), key))(pressure)
            ends = [getattr(leak(pressure + h), key) for h in (step, -step)]
            by_hand = (ends[0] - ends[1]) / (2 * step)
            np.testing.assert_allclose(slope, by_hand, rtol=1e-4, atol=1e-12)
    assert (leak(pressure).rate == 0) == (pressure == 1e7)


def test_table_summary_and_figure(tmp_path):
    pressure, time = np.geomspace(1.1e5, 3e6, 5), np.array([[1.0], [1e4]])
    found = em.leak(
        RUBBER, ROUGH, **{**SCENE, "pressure": pressure, "time": time, "density": 1e3}
    )
    found.to_csv(tmp_path / "leak.csv")
    text = (tmp_path / "leak.csv").read_text()
    for said in (
        "leak rate [m^3/s]",
        "mass leak rate [kg/s]",
        "Multiscale",
        "percolates",
    ):
        assert said in text
    sizes = dict(found.to_xarray().sizes)
    assert sizes.pop("place") == found.profile.x.shape[-1]
    assert sizes == {"time": 2, "pressure": 5}
    closed = int((~found.percolates).sum())
    assert closed > 0
    assert f"no channel leads through at {closed} of 10 points" in found.summary()
    assert "rate within a factor of" in found.summary()
    ax = found.plot()
    assert ax.get_yscale() == "log"
    assert "Leak rate" in ax.get_ylabel()
    assert "gap" in found.plot(show="mean_gap").get_ylabel()
    with refused("show", "rate"):
        found.plot(show="leak")


def test_friction_refuses_a_model_of_leaks():
    with refused("model", "friction"):
        em.friction(
            RUBBER, ROUGH, velocity=0.1, pressure=1e5, model=em.EffectiveMedium()
        )
    with refused("model", "effective medium"):
        em.friction(RUBBER, ROUGH, velocity=0.1, pressure=1e5, model="effective medium")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"pressure_drop": 3e5}, ("pressure_drop", "opens", 300000)),
        ({"pressure_drop": -1.0}, ("pressure_drop", -1)),
        ({"viscosity": 0.0}, ("viscosity", 0)),
        ({"length": 0.0}, ("length", 0)),
        ({"length": None}, ("length", "pressure")),
        ({"density": -1.0}, ("density", -1)),
        ({"surface": em.Sphere(1e-3)}, ("surface", "Sphere")),
        ({"model": "persson"}, ("model", "em.Multiscale")),
        ({"model": em.Persson()}, ("model", "leak", "Persson")),
        ({"model": em.Line()}, ("model", "leak")),
        (
            {"material": em.springs(RUBBER, 1e-3, bonded=False)},
            ("material", "half-space"),
        ),
        (
            {"material": em.Maxwell(1e6, 1.0), "time": None},
            ("material", "equilibrium"),
        ),
    ],
)
def test_bad_input(change, words):
    given = {"material": RUBBER, "surface": ROUGH, **SCENE, **change}
    with refused(*words):
        em.leak(**given)
    with refused("closes", 0, 1):
        em.EffectiveMedium(closes=1.0)


def test_a_leak_that_was_nowhere_found_is_drawn():
    found = em.leak(RUBBER, ROUGH, **SCENE | {"time": [1.0, 10.0, 100.0]})
    unknown = np.full(3, np.nan)
    nowhere = dataclasses.replace(
        found, rate=unknown, model_error=unknown, converged=np.zeros(3, bool)
    )
    assert nowhere.plot().has_data()


def measured(peklenik=1.0, skewness=0.0, error=0.0):
    """A measured surface with a lay on all scales and a skewness."""
    log_g = np.full(ROUGH.q.size, np.log(peklenik))
    return MeasuredSurface(
        q=ROUGH.q, c=ROUGH.c, relative_error=0 * ROUGH.q,
        measured_height=ROUGH.rms_height, skewness=skewness, skewness_error=error,
        report=("read from a file",),
        lay=Lay(ROUGH.q, log_g, 0 * log_g, 0.0) if peklenik > 1 else None,
    )  # fmt: skip


LIGHT = {**SCENE, "pressure": 1e5, "pressure_drop": 1e3}


def test_lay_and_skewness_are_in_the_bound_and_said():
    plain = em.leak(RUBBER, measured(), **LIGHT)
    assert plain.model_error == em.leak(RUBBER, ROUGH, **LIGHT).model_error
    assert not plain.doubts
    for surface, word in (
        (measured(3.0), "a lay, along which"),
        (measured(skewness=-0.8), "heights of skewness -0.80"),
        (measured(error=0.4), "heights of skewness 0.00"),
    ):
        found = em.leak(RUBBER, surface, **LIGHT)
        assert found.rate == plain.rate
        assert found.model_error > 2 * plain.model_error
        (doubt,) = found.doubts
        assert doubt.kind == "bound"
        assert word in doubt.says
        assert word in found.summary()
        assert "read from a file" in found.summary()
    # beyond what was tried, and where channels across may be closed
    for surface, word in (
        (measured(8.0), "a lay, along which"),
        (measured(skewness=1.5), "heights of skewness 1.50"),
    ):
        found = em.leak(RUBBER, surface, **LIGHT)
        assert np.isnan(found.model_error)
        (doubt,) = found.doubts
        assert doubt.kind == "no prediction"
        assert word in doubt.says
        assert doubt.remedy
    # a factor of ten thousand and more tells nothing
    pressure = np.geomspace(1e5, 3e5, 99)
    harder = em.leak(RUBBER, measured(skewness=0.99), **{**LIGHT, "pressure": pressure})
    finite = np.isfinite(harder.model_error)
    assert finite[0]
    assert np.isnan(harder.model_error).any()
    assert (harder.model_error[finite] < 1e4).all()
    closed = em.leak(RUBBER, measured(4.0), **{**LIGHT, "pressure": 2e5})
    assert closed.model_error == np.inf
    with jax.enable_x64(True):
        traced = jax.jit(
            lambda p: em.leak(RUBBER, measured(3.0), **{**LIGHT, "pressure": p})
        )(1e5)
    one = em.leak(RUBBER, measured(3.0), **LIGHT)
    assert traced.model_error == pytest.approx(float(one.model_error), rel=1e-9)
    assert [doubt.kind for doubt in traced.doubts] == ["bound"]


def test_maps_along_and_across_a_lay_are_within_the_bound():
    """Of 3 to 1, and of worn summits; by gaps in three dimensions."""
    level = 0.02 * float(ROUGH.rms_slope)
    for seed in (1, 2):
        options = {"periods": 2, "points": 128}
        laid, side = rough_map(measured(3.0), seed, **options)
        w = flow(pressed(laid, side, level).gap).conductance
        rubber = em.Foundation(1.0, [], [])
        scene = {
            "pressure": level,
            "pressure_drop": 1e-6,
            "viscosity": 1.0,
            "length": 1.0,
        }
        found = em.leak(rubber, measured(3.0), **scene)
        off = np.abs(np.log(np.array(w) / (12 * float(found.conductance))))
        assert (off > np.log1p(em.leak(rubber, ROUGH, **scene).model_error)).all()
        assert (off < np.log1p(found.model_error)).all()


def test_direction_to_a_lay():
    """Maps lie in it; of others it is in the bound."""
    ways = 0.0, 0.5, np.pi / 2
    lay, scene = measured(2.0), {**LIGHT, "pressure": 5e4}
    found = [em.leak(RUBBER, lay, direction=way, **scene) for way in ways]
    either = em.leak(RUBBER, lay, **scene)
    bounds = [float(each.model_error) for each in found]
    assert bounds[0] < bounds[2] <= either.model_error
    assert bounds[0] > em.leak(RUBBER, ROUGH, direction=0.0, **scene).model_error
    assert found[0].rate == either.rate
    assert "to the lay" in found[2].summary()
    maps = [
        em.leak(
            RUBBER, lay, direction=way, model=em.HalfSpace(cells=128, seeds=2), **scene
        )
        for way in ways
    ]
    rates = [float(each.rate) for each in maps]
    assert rates[0] > rates[1] > rates[2]
    assert maps[0].model_error is None
    for truth, form in zip(maps, found, strict=True):
        off = abs(np.log(float(truth.rate / form.rate)))
        assert off < np.log1p(form.model_error)
    with refused("direction", "nan"):
        em.leak(RUBBER, lay, direction=np.nan, **scene)


def test_maps_of_a_measured_surface_have_a_bound():
    """Gaussian maps whose two axes are taken as one medium."""
    model = em.HalfSpace(cells=64, seeds=1)
    assert em.leak(RUBBER, measured(), model=model, **LIGHT).model_error is None
    for surface in (measured(2.0), measured(skewness=-0.5)):
        found = em.leak(RUBBER, surface, model=model, **LIGHT)
        assert 0.5 < found.model_error < np.inf
