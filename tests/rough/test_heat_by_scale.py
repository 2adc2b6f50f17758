"""Temperature by length scale: the fixed point and its conduction against slow sums,
its limits, balance, gradients.
"""

import dataclasses
import time
from pathlib import Path

import jax
import numpy as np
import pytest
from scipy.special import i0e, k0e

import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.element.law import surface_foundation
from elastomdr.rough import temperature_by_scale as warm
from elastomdr.rough.psd_integrals import integral_to, nodes
from elastomdr.rough.road_model import WaveProblem

from ..refused import mentions, refused, warned

WLF = em.WLF(c1=8.86, c2=101.6, reference=293.15)
RUBBER = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=WLF)
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=2e3, q_high=1e5)
HEAT = em.Heat(0.25, 2e6)
STONE = em.Heat(0.25, 2e6, road=(1.5, 2e6))
SHEAR = em.AdhesiveShear(3e5, 6e-3, 0.1, shift=em.Arrhenius(9e4, 293.15))
ASKED = {
    "velocity": np.array([1e-3, 0.1, 10.0]),
    "pressure": 2e5,
    "temperature": 293.15,
}


def rise_of(heat, velocity, flux, waves, at, area, shear):
    """Rises at three wave numbers by plain sums over distance and depth, and the share
    of the road.
    """
    q, each, end = at.q.ravel(), waves.each[0].ravel(), float(at.end)
    whole = each.sum() + waves.edges[0] + shear
    k = np.geomspace(1e-3 * q[0], 1e4 * end, 500)
    dk = np.gradient(k)
    dk[0] += k[0]

    def profile(q, k):
        return 4 * q**2 / (k**2 + 4 * q**2)

    depth = (
        each @ profile(q[:, None], k) + waves.edges[0] * profile(end, k) + shear
    ) / whole
    r = np.geomspace(1e-5 / end, np.pi / q[0], 3000)
    w = velocity / (2 * heat.conductivity / heat.heat_capacity)
    kernel = (
        i0e(w * r)
        * k0e(r * np.hypot(w, k)[:, None])
        * np.exp((w - np.hypot(w, k)[:, None]) * r)
    )

    def excess(q):
        return (
            1
            / np.interp(
                np.log(np.minimum(q, np.pi / r)), np.log([*q_sorted, end]), area
            )
            - 1
        )

    q_sorted = q
    factor = 2 / (np.pi * heat.conductivity)

    def mean(f, q):
        return factor * ((np.trapezoid(kernel * excess(q) * r, r, axis=1) * f) @ dk)

    road = 0.0
    if heat.road is not None:
        own = np.trapezoid(excess(end) * i0e(w * r), r) / heat.conductivity
        road = mean(depth, end) / (own + np.trapezoid(excess(end), r) / heat.road[0])
    scales = (q[q.size // 2], end)
    return (
        [
            flux * (mean(profile(s, k) * depth, s) - road * mean(profile(s, k), s))
            for s in scales
        ],
        scales,
        road,
    )


@pytest.mark.parametrize(
    ("heat", "adhesion"), [(HEAT, None), (STONE, None), (STONE, SHEAR)]
)
def test_conduction_is_what_plain_sums_make_of_it(heat, adhesion):
    """Of a rubber that hardly feels the temperature, so that the state is that of the
    body's.
    """
    rubber = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=em.Arrhenius(1e-3, 293.15))
    law = None if adhesion is None else em.AdhesiveShear(3e5, 6e-3, 0.1)
    curve = em.friction(
        rubber,
        ROAD,
        velocity=0.3,
        pressure=2e5,
        temperature=293.15,
        heat=heat,
        adhesion=law,
    )
    body, at = surface_foundation(rubber), nodes(ROAD, 64)
    found = em.Multiscale().waves(
        WaveProblem(body.complex_modulus, at, np.array([0.3]), np.array([2e5]))
    )
    shares = em.Multiscale().contact(integral_to(found.rate, at.weight), found.stiffer)
    shares = np.append(shares[0].ravel(), shares[0, -1, -1])
    shear = 0.0 if law is None else float(law.shear_stress(0.3)) * found.area[0] / 2e5
    rises, _, road = rise_of(
        heat, 0.3, float(curve.mu) * 2e5 * 0.3, found, at, shares, shear
    )
    assert curve.contact_rise == pytest.approx(rises[1], rel=0.01)
    if heat.road is not None:
        assert curve.road_share == pytest.approx(road, rel=0.01)


# of dry tread rubber
ICE_COLD = em.AdhesiveShear(6e6, 5e-3, 0.1, shift=em.Arrhenius(8e4, 298.15))


def tread(**more):
    """Plain tread rubber without the misfit to its data, which would be part of
    `error`.
    """
    shipped = em.load_material("tread-passenger-synthetic")
    return em.Prony(
        shipped.equilibrium, shipped.moduli, shipped.times, shift=shipped.shift, **more
    )


@pytest.fixture
def reference(monkeypatch):
    """The second solution of the same equations, `benchmarks/heat_reference.py`."""
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    import heat_reference

    return heat_reference


@pytest.mark.parametrize(
    ("heat", "scene"),
    [
        (HEAT, {"velocity": 5.0, "temperature": 263.15}),
        (HEAT, {"velocity": 5.0, "temperature": 263.15, "adhesion": ICE_COLD}),
        (STONE, {"velocity": 5.0, "temperature": 263.15, "adhesion": ICE_COLD}),
        (
            STONE,
            {
                "velocity": 0.3,
                "temperature": 283.15,
                "adhesion": ICE_COLD,
                "model": em.Persson(),
            },
        ),
        (STONE, {"velocity": 20.0, "temperature": 303.15}),
    ],
)
def test_error_covers_a_second_solution(heat, scene, reference):
    """Cold rubber with activated shear was 0.4 to 7 % off, up to 8 times its
    `error`.
    """
    asked = {"pressure": 3e5, "heat": heat, **scene}
    curve = em.friction(tread(), ROAD, **asked)
    second = reference.Point(tread(), ROAD, **asked).solve()
    assert second.settled
    assert abs(curve.mu - second.mu) <= curve.error
    assert curve.error < 1e-3 * curve.mu
    assert curve.contact_rise == pytest.approx(second.contact_rise, rel=1e-3)
    assert curve.area_ratio == pytest.approx(second.area, rel=1e-3)
    if heat.road is not None:
        assert curve.road_share == pytest.approx(second.road_share, rel=1e-3)


def test_a_point_that_needs_finer_stations_gets_them(reference, monkeypatch):
    """Of two points one needs them, of cold rubber whose friction grows three times as
    it warms.
    """
    asked = {"pressure": 1e6, "temperature": 263.15, "heat": HEAT, "adhesion": ICE_COLD}
    velocity = np.array([1e-4, 22.0])
    both = em.friction(tread(), ROAD, velocity=velocity, **asked)
    assert (both.error < 1e-3 * both.mu).all()
    for i, v in enumerate(velocity):
        alone = em.friction(tread(), ROAD, velocity=v, **asked)
        assert alone.mu == pytest.approx(both.mu[i], rel=1e-8)
        second = reference.Point(tread(), ROAD, velocity=v, **asked).solve()
        assert abs(alone.mu - second.mu) <= alone.error
    monkeypatch.setattr(warm, "_MOST", 5e-3)
    monkeypatch.setattr(warm, "_LEVELS", warm._LEVELS[: warm._USUAL + 1])
    with pytest.warns(em.ConvergenceWarning, match="1 of 2"):
        usual = em.friction(tread(), ROAD, velocity=velocity, **asked)
    np.testing.assert_array_equal(usual.converged, [True, False])


def test_where_hot_rubber_has_more_friction_it_is_said_why():
    asked = {"pressure": 3e5, "temperature": 263.15, "velocity": [0.1, 5.0]}
    hot = em.friction(tread(), ROAD, heat=HEAT, adhesion=ICE_COLD, **asked)
    cold = em.friction(tread(), ROAD, adhesion=ICE_COLD, **asked)
    np.testing.assert_allclose(hot.cold, cold.mu, rtol=1e-9)
    assert (hot.mu > 1.3 * hot.cold).all()
    said = dict(hot.inputs)["heat raises mu"]
    i = int(np.argmax(hot.mu / hot.cold))
    softer = hot.area_ratio[i] / cold.area_ratio[i]
    stronger = hot.adhesion[i] / cold.adhesion[i] / softer
    assert softer > 1
    assert stronger > 1
    assert mentions(
        said, f"{softer:.4g} times as large", f"{stronger:.4g} times as high"
    )
    assert (
        "heat raises mu" not in em.friction(tread(), ROAD, heat=HEAT, **asked).summary()
    )


def test_heat_is_friction_power():
    for adhesion in (None, SHEAR):
        curve = em.friction(RUBBER, ROAD, heat=STONE, adhesion=adhesion, **ASKED)
        power = curve.mu * ASKED["pressure"] * curve.velocity
        np.testing.assert_allclose(
            curve.heat_flux / (1 - curve.road_share), power, rtol=1e-4
        )
        assert ((curve.road_share > 0) & (curve.road_share < 1)).all()
        assert (curve.contact_rise > curve.temperature_rise).all()


def test_hot_friction_is_that_of_its_temperatures():
    curve = em.friction(RUBBER, ROAD, heat=HEAT, **ASKED)
    assert curve.converged.all()
    np.testing.assert_array_equal(curve.cold, em.friction(RUBBER, ROAD, **ASKED).mu)
    assert curve.contact_rise[-1] > 5
    hottest, body = (
        em.friction(RUBBER, ROAD, **ASKED | {"temperature": 293.15 + t}).mu
        for t in (curve.contact_rise, 0)
    )
    # between body and contact
    assert ((curve.mu - hottest) * (curve.mu - body) <= 1e-9).all()
    assert "rise by wavelength" in curve.summary()
    assert "each length scale" in curve.model


def test_limits_of_temperature():
    cold = em.friction(RUBBER, ROAD, **ASKED)
    good = em.friction(RUBBER, ROAD, heat=em.Heat(1e7, 1e13), **ASKED)
    np.testing.assert_allclose(good.mu, cold.mu, rtol=1e-5)
    with pytest.warns(em.ModelWarning, match="not linear there"):
        full = em.friction(RUBBER, ROAD, heat=HEAT, **ASKED | {"pressure": 3e9})
    assert (full.temperature_rise < 1e-6).all()
    slow = em.friction(
        RUBBER, ROAD, heat=HEAT, **ASKED | {"velocity": np.array([1e-9, 1e-8])}
    )
    # no Peclet number left
    np.testing.assert_allclose(*(slow.contact_rise / slow.heat_flux), rtol=0.01)
    none = em.friction(
        RUBBER, ROAD, heat=em.Heat(0.25, 2e6, road=(1e-12, 2e6)), **ASKED
    )
    np.testing.assert_allclose(
        none.mu, em.friction(RUBBER, ROAD, heat=HEAT, **ASKED).mu, rtol=1e-9
    )
    # what arises on the surface is shared by two equal bodies at rest
    twin = em.friction(
        em.Prony(0.5e6, [1.0], [1e-3], shift=WLF),
        ROAD,
        velocity=1e-7,
        pressure=2e5,
        temperature=293.15,
        heat=em.Heat(0.25, 2e6, road=(0.25, 2e6)),
        adhesion=em.AdhesiveShear(3e5, 6e-3, 0.0),
    )
    assert twin.road_share == pytest.approx(0.5, abs=0.005)


def test_a_profile_far_from_that_of_cold_rubber(reference):
    """Cold, the finest waves would be heated by thousands of kelvins; the one steady
    state is 144 K hot.
    """
    tread = em.load_material("tread-passenger-synthetic")
    road = em.SelfAffine(
        0.8, rms_slope=1.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 1e-4
    )
    given = {"pressure": 1.2e5, "temperature": 258.15, "heat": HEAT}
    velocity = np.array([8.8, 16.0, 30.0])
    curve = em.friction(tread, road, velocity=velocity, **given)
    assert curve.converged.all()
    second = [
        reference.Point(tread, road, velocity=v, **given).solve().contact_rise
        for v in velocity
    ]
    assert max(second) == pytest.approx(144, abs=10)
    np.testing.assert_allclose(curve.contact_rise, second, rtol=5e-4)
    assert not curve.other_states.any()


@pytest.mark.parametrize("road", [None, (400.0, 3e6)])
def test_extrapolated_is_where_the_hottest_rubber_is_beyond_its_data(road):
    """Moduli are taken up to the rise of the contacts, which was 100 K above the mean
    that was looked at; on a road of metal waves below the surface are hotter still.
    """
    rubber = tread(range={"temperature": (253.15, 353.15)})
    rough = em.SelfAffine(0.8, rms_slope=0.8, q_low=1e3, q_high=1e6)
    with pytest.warns(em.ExtrapolationWarning, match="from 273.15 to"):
        curve = em.friction(
            rubber,
            rough,
            velocity=np.geomspace(0.01, 30, 9),
            pressure=3e5,
            temperature=273.15,
            heat=em.Heat(0.25, 2e6, road=road),
        )
    by_contact = 273.15 + curve.contact_rise > 353.15
    by_mean = 273.15 + curve.temperature_rise > 353.15
    assert (by_contact & ~by_mean).any()
    assert (curve.extrapolated >= by_contact).all()
    if road is None:
        np.testing.assert_array_equal(curve.extrapolated, by_contact)
        said, hottest = curve.summary(), curve.contact_rise.max()
        assert f"temperature from 273.15 to {273.15 + hottest:.6g} K" in said
        assert f"{hottest:.3g} K at 0.0063 mm" in said
        assert f"at most {hottest:.4g} K" in said


def test_waves_are_outside_the_data_at_their_own_temperatures():
    rubber = tread(range={"omega": (1.0, 1e6)})
    given = {"velocity": [3.0, 30.0], "pressure": 1e6, "temperature": 283.15}
    curve = em.friction(rubber, ROAD, heat=HEAT, **given)
    with pytest.warns(em.ExtrapolationWarning, match="measured frequencies"):
        cold = em.friction(rubber, ROAD, **given)
    q = np.geomspace(2e3, 1e5, 3001)
    middle, slope = np.sqrt(q[1:] * q[:-1]), np.diff(q**0.4)  # q^3 C = q^(-2 H + 1)
    for i, v in enumerate(given["velocity"]):
        coldest, hottest = (
            slope[middle * v * rubber.shift.a(283.15 + rise) > 1e6].sum() / slope.sum()
            for rise in (0.0, curve.contact_rise[i])
        )
        assert cold.outside[i] == pytest.approx(coldest, abs=2e-3)
        assert hottest - 2e-3 <= curve.outside[i] <= coldest + 2e-3
    assert curve.outside[1] < cold.outside[1] - 0.5


# shear that grows with temperature faster than conduction leads its heat away
FOLDED = em.Prony(
    8e5,
    8e5 * np.geomspace(400, 0.2, 12),
    np.geomspace(1e-10, 10, 12),
    shift=em.WLF(8.9, 101.6, 293.15),
)
FOLD = {
    "pressure": 3e5,
    "temperature": 263.0,
    "heat": em.Heat(0.25, 1.8e6),
    "adhesion": em.AdhesiveShear(4e7, 1e-4, 0.4, shift=em.Arrhenius(1.5e5, 293.15)),
}
FOLDED_ROAD = em.SelfAffine(0.8, rms_slope=0.8, q_low=1e3, q_high=1e5)


def test_the_cold_branch_up_to_its_fold_and_the_hot_one_down(reference):
    """Near the fold the hot state was given for the cold one, without a word, or NaN.

    The second solution follows rubber that warms up, or cools down, in small steps.
    """
    velocity = np.array([0.048, 0.052, 0.06, 0.07, 0.0949])
    asked = {"velocity": velocity, "model": "persson", **FOLD}
    cold = em.friction(FOLDED, FOLDED_ROAD, **asked)
    hot = em.friction(FOLDED, FOLDED_ROAD, branch="hot", **asked)
    np.testing.assert_array_equal(cold.other_states, velocity < 0.0625)
    np.testing.assert_array_equal(hot.other_states, cold.other_states)
    for i in (1, 2, 4):
        point = reference.Point(
            FOLDED, FOLDED_ROAD, velocity=velocity[i], **FOLD, model=em.Persson()
        )
        warmed, cooled = point.solve(0.0, 0.1), point.solve(90.0, 0.1)
        assert cooled.settled
        assert warmed.settled == cold.other_states[i]  # slowly past the fold
        if warmed.settled:
            assert abs(cold.mu[i] - warmed.mu) <= cold.error[i]
        assert abs(hot.mu[i] - cooled.mu) <= hot.error[i]
    np.testing.assert_array_equal(cold.mu[3:], hot.mu[3:])  # there is one only
    assert (hot.mu[:3] > 7 * cold.mu[:3]).all()
    for curve in (cold, hot):
        (doubt,) = (d for d in curve.doubts if d.kind == "hot branch")
        np.testing.assert_array_equal(doubt.points, cold.other_states)


def test_the_fold_is_where_the_cold_branch_ends():
    """As closely as it is looked at, every point has a state, and one on either side."""
    low, high = 0.01, 0.02  # of Multiscale
    for _ in range(3):
        velocity = np.linspace(low, high, 9)
        curve = em.friction(FOLDED, FOLDED_ROAD, velocity=velocity, **FOLD)
        assert curve.converged.all()
        last = int(curve.other_states.sum()) - 1
        assert curve.other_states[: last + 1].all()
        assert (curve.mu[: last + 1] < 0.5).all()
        assert (curve.mu[last + 1 :] > 4).all()
        low, high = velocity[last], velocity[last + 1]


@pytest.mark.parametrize(
    ("model", "velocity", "mu"),
    [("multiscale", [0.0771, 0.0812], 0.4650), ("persson", [0.45, 0.4782], 0.3127)],
)
def test_coarse_cells_do_not_end_the_cold_branch(model, velocity, mu):
    """On coarse cells they folded near .077 and .448 m/s; the last states are those of
    finer ones.
    """
    rubber = em.Prony(
        5e5,
        5e5 * np.geomspace(600, 0.1, 14),
        np.geomspace(1e-11, 10, 14),
        shift=em.WLF(10, 110, 283.15),
    )
    road = em.SelfAffine(0.7, rms_slope=0.9, q_low=2e3, q_high=1e5)
    shear = em.AdhesiveShear(3e7, 1e-4, 0.35, shift=em.Arrhenius(1.4e5, 283.15))
    cold, hot = (
        em.friction(
            rubber,
            road,
            velocity=velocity,
            pressure=4e5,
            temperature=263.15,
            heat=em.Heat(0.22, 1.7e6),
            adhesion=shear,
            model=model,
            branch=branch,
        )
        for branch in ("cold", "hot")
    )
    assert (cold.mu < 0.5).all()
    assert (hot.mu > 1.8).all()
    assert cold.mu[-1] == pytest.approx(mu, rel=2e-3)
    assert cold.other_states.all()
    assert hot.other_states.all()


def test_branches_under_jit():
    def both(velocity):
        return [
            em.friction(FOLDED, FOLDED_ROAD, velocity=velocity, branch=branch, **FOLD)
            for branch in ("cold", "hot")
        ]

    velocity = np.array([0.015, 0.0949])
    with jax.enable_x64(True):
        traced = jax.jit(both)(velocity)
    for one, plain in zip(traced, both(velocity), strict=True):
        np.testing.assert_allclose(one.mu, plain.mu, rtol=1e-9)
        np.testing.assert_array_equal(one.other_states, [True, False])


def test_bad_branch():
    for branch, heat, words in (
        ("warm", HEAT, ("branch", "warm", "cold", "hot")),
        ("hot", None, ("branch", "hot", "em.Heat")),
    ):
        with refused(*words):
            em.friction(RUBBER, ROAD, heat=heat, branch=branch, **ASKED)
    with refused("", "branch", "heat"):
        em.friction(RUBBER, em.Sphere(1e-3), velocity=1.0, load=1.0, branch="hot")


def test_why_there_is_no_steady_state_and_the_advice_helps():
    """A shift table ends below the temperature at which less heat is made than is led
    away; that of a law which goes on is found, and said to be extrapolated.
    """
    rubber = em.load_material("epdm-70")
    table = rubber.shift
    road = em.SelfAffine(0.8, rms_slope=0.6, q_low=2e3, q_high=1e5)
    shear = em.AdhesiveShear(6e6, 5e-3, 0.1, shift=em.Arrhenius(8e4, 298.15))
    asked = {"velocity": np.geomspace(1e-3, 10, 12), "temperature": 273.15}
    asked |= {"pressure": 3e5, "heat": HEAT, "adhesion": shear}
    with (
        pytest.warns(em.ExtrapolationWarning),
        warned(em.ConvergenceWarning, "6 of 12 points", "326.12 K", "shift law"),
    ):
        curve = em.friction(rubber, road, **asked)
    assert dict(curve.inputs)["no steady state"].startswith("at 6 of 12 points")
    assert np.isnan(curve.mu[6:]).all()
    c1, c2, reference = 17.4, 51.6 + 40.0, 298.15
    longer = np.append(table.temperature, [340.0, 370.0, 500.0])
    beyond = -c1 * (longer[-3:] - reference) / (c2 + longer[-3:] - reference)
    beyond += table.log10_a_table[-1] - (
        -c1 * (326.12 - reference) / (c2 + 326.12 - reference)
    )
    law = em.ShiftTable(longer, np.append(table.log10_a_table, beyond))
    free = dataclasses.replace(rubber, shift=law)
    with pytest.warns(em.ExtrapolationWarning, match=r"temperature from 273\.15 to"):
        on = em.friction(free, road, **asked)
    assert on.converged.all()
    np.testing.assert_array_equal(on.extrapolated[6:], True)
    assert (on.contact_rise[6:] > 326.12 - 273.15).all()
    np.testing.assert_allclose(on.mu[:5], curve.mu[:5], rtol=1e-5)


def test_a_warm_body_does_not_shorten_the_law_of_a_cold_one():
    """The rise that a table allows is that of each point: a body at its end stood
    beside a cold one, whose contacts were then looked for up to 3 K only.
    """
    ends = em.ShiftTable([260.0, 293.15, 325.0], WLF.log10_a([260.0, 293.15, 325.0]))
    short = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=ends)
    given = {"velocity": 10.0, "pressure": 2e5, "heat": HEAT}
    alone = em.friction(short, ROAD, temperature=293.15, **given)
    assert alone.contact_rise > 3
    both = em.friction(short, ROAD, temperature=[293.15, 320.0], **given)
    np.testing.assert_allclose(both.mu[0], alone.mu, rtol=1e-9)


def test_a_shift_law_that_ends():
    table = em.ShiftTable([280.0, 293.15, 296.0], WLF.log10_a([280.0, 293.15, 296.0]))
    short = em.Prony(0.5e6, [3e7, 3e6], [1e-6, 1e-3], shift=table)
    with pytest.warns(em.ConvergenceWarning, match="1 of 3 .* up to 296 K"):
        curve = em.friction(short, ROAD, heat=HEAT, **ASKED)
    np.testing.assert_array_equal(curve.converged, [True, True, False])
    assert np.isnan(curve.temperature_rise[-1])


def test_persson_softening_and_vertical_shifts_take_part():
    soft = em.Softening(
        [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.4], [1.0, 1.1, 0.9, 0.5]
    )
    rubber = em.Prony(
        0.5e6,
        [3e7, 3e6],
        [1e-6, 1e-3],
        shift=WLF,
        softening=soft,
        vertical=em.EntropicVertical(293.15),
    )
    for model in ("persson", "multiscale"):
        curve = em.friction(rubber, ROAD, heat=STONE, model=model, **ASKED)
        assert curve.converged.all()
        assert (curve.error < 1e-3 * curve.mu).all()
        assert (abs(curve.mu / curve.cold - 1)[1:] > 1e-3).all()


def test_a_hot_curve_is_fast():
    tread = em.load_material("tread-passenger-synthetic")
    asked = {
        "velocity": np.geomspace(1e-3, 10, 24),
        "temperature": np.array([[283.0], [293.0], [313.0]]),
    }

    def least(heat):
        em.friction(tread, ROAD, pressure=2e5, heat=heat, **asked)
        spent = []
        for _ in range(3):
            start = time.process_time()
            em.friction(tread, ROAD, pressure=2e5, heat=heat, **asked)
            spent.append(time.process_time() - start)
        return min(spent)

    # .48 s and .018 s on a quiet machine; a ratio holds on a slow one, too
    assert least(HEAT) < 50 * least(None)


# the second point takes the finest level
LEVELS = {"velocity": np.array([1e-4, 22.0]), "pressure": 1e6, "temperature": 263.15}


def hot_by_level(velocity):
    return em.friction(
        tread(), ROAD, heat=HEAT, adhesion=ICE_COLD, **LEVELS | {"velocity": velocity}
    )


def test_vmap_is_the_plain_call_on_the_levels_that_it_needs():
    """The second point was computed on the third level, with the error of the
    finest.
    """
    plain = hot_by_level(LEVELS["velocity"])
    with jax.enable_x64(True):
        mapped = jax.vmap(hot_by_level)(LEVELS["velocity"])
    for name in ("mu", "error", "contact_rise", "temperature_rise", "heat_flux"):
        np.testing.assert_allclose(
            getattr(mapped, name), getattr(plain, name), rtol=1e-9, err_msg=name
        )


@pytest.mark.slow
def test_jvp_has_the_number_of_the_plain_call():
    velocity, step = LEVELS["velocity"], 1e-3
    with jax.enable_x64(True):
        number, slope = jax.jvp(lambda v: hot_by_level(v).mu, (velocity,), (velocity,))
    np.testing.assert_allclose(number, hot_by_level(velocity).mu, rtol=1e-12)
    fast, slow = (hot_by_level(velocity * (1 + s)).mu for s in (step, -step))
    np.testing.assert_allclose(slope, (fast - slow) / (2 * step), rtol=1e-4)


@pytest.mark.slow
def test_gradients_through_softening_heat_and_adhesion():
    def mu(velocity, kelvin, level):
        soft = em.Softening(
            [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.4], [1.0, 1.1, 0.9, 0.5]
        )
        rubber = em.Prony(
            0.5e6, level * np.array([3e7, 3e6]), [1e-6, 1e-3], shift=WLF, softening=soft
        )
        return em.friction(
            rubber,
            ROAD,
            velocity=velocity,
            pressure=2e5,
            temperature=kelvin,
            heat=STONE,
            adhesion=SHEAR,
            rtol=1e-8,
        ).mu

    at = np.array([1.0, 293.0, 1.0])
    with jax.enable_x64(True):
        slopes = jax.grad(mu, (0, 1, 2))(*at)
    for i, step in enumerate(np.diag([1e-3, 0.05, 1e-3])):
        near, far = (
            float(mu(*(at + n * step))) - float(mu(*(at - n * step))) for n in (1, 2)
        )
        assert float(slopes[i]) == pytest.approx(
            (8 * near - far) / (12 * step[i]), rel=1e-5
        )


def test_bad_heat():
    for road, words in (
        ((1.0,), ("road", "pair")),
        ((-1.0, 2e6), ("road", "positive", -1)),
    ):
        with refused(*words):
            em.Heat(0.25, 2e6, road=road)


def test_the_series_for_jax_is_the_function_of_bessel():
    x = np.geomspace(1e-8, 1e4, 300)
    with jax.enable_x64(True):
        np.testing.assert_allclose(jax.jit(warm._k0e)(x), k0e(x), rtol=4e-7)


def test_splines_begin_at_zero_and_meet_their_stations():
    places = np.arange(1, 6) / 5
    basis = numpy_unless_traced(warm.basis)
    np.testing.assert_allclose(basis(5, places), np.eye(5), atol=1e-14)
    between = np.linspace(0, 1, 9)
    np.testing.assert_allclose(
        basis(5, between) @ (places - 2 * places**3),
        between - 2 * between**3,
        atol=1e-14,
    )
    twice = np.arange(1, 11) / 10
    some = np.array([0.3, -1.0, 2.0, 0.1, 4.0])
    np.testing.assert_allclose(
        basis(10, between) @ (basis(5, twice) @ some),
        basis(5, between) @ some,
        atol=1e-13,
    )
