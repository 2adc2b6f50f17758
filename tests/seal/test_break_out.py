"""Break-out after a dwell against the creep of one branch, steady shear and full
contact.
"""

import jax
import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

SOFT, HARD, TAU = 1e6, 3e6, 2.0  # in shear
LAW = em.WLF(8.86, 101.6, 293.15)
RUBBER = em.StandardSolid(SOFT, HARD, TAU, shift=LAW)
ROUGH = em.SelfAffine(0.8, rms_slope=0.6, q_low=1e4, q_high=1.6e5)
STRESS = 2e5


def test_light_contact_grows_by_the_moduli():
    """Contact in proportion to the creep of one branch: J over 1/E_inf goes from
    E_inf/(E_inf + E_1) to 1 with the time tau (E_inf + E_1)/E_inf.
    """
    dwell = np.array([1e-6, 1.0, 8.0, 30.0, 1e6])
    found = em.break_out(
        RUBBER, ROUGH, pressure=10.0, time=dwell, boundary_shear=STRESS,
        temperature=293.15,
    )  # fmt: skip
    retardation = TAU * (SOFT + HARD) / SOFT
    creep = 1 - HARD / (SOFT + HARD) * np.exp(-dwell / retardation)
    np.testing.assert_allclose(found.mu / found.mu[-1], creep, rtol=1e-5)
    assert found.mu[-1] / found.mu[0] == pytest.approx((SOFT + HARD) / SOFT, rel=1e-5)
    np.testing.assert_allclose(found.mu, STRESS * found.area_ratio / 10.0, rtol=1e-14)


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_full_contact_bears_the_whole_shear():
    found = em.break_out(RUBBER, ROUGH, pressure=1e9, boundary_shear=STRESS)
    assert found.mu == pytest.approx(STRESS / 1e9, rel=1e-9)
    assert found.area_ratio == pytest.approx(1.0, rel=1e-9)


def test_elastic_rubber_breaks_out_as_it_slides():
    """Without memory the contact at rest is that of steady sliding."""
    elastic, shear = em.Prony(1e6, [], []), em.AdhesiveShear(STRESS, 1.0, 0.0)
    pressure = np.geomspace(1e4, 5e5, 4)
    slides = em.friction(
        elastic, ROUGH, velocity=1.0, pressure=pressure, adhesion=shear
    )
    rests = em.break_out(elastic, ROUGH, pressure=pressure, boundary_shear=shear)
    np.testing.assert_allclose(rests.mu, slides.adhesion, rtol=1e-6)
    np.testing.assert_allclose(rests.model_error, slides.model_error, rtol=1e-4)


def test_a_dwell_shifts_with_temperature():
    warm = 10 ** (-8.86 * 20 / (101.6 + 20))
    scene = {"pressure": 2e5, "boundary_shear": STRESS}
    hot = em.break_out(RUBBER, ROUGH, time=3.0, temperature=313.15, **scene)
    cold = em.break_out(RUBBER, ROUGH, time=3.0 / warm, temperature=293.15, **scene)
    assert hot.mu == pytest.approx(float(cold.mu), rel=1e-9)


def test_the_largest_stress_on_the_way_counts():
    """exp(-width) per decade squared below the maximum, the maximum beyond it."""
    shear = em.AdhesiveShear(STRESS, 1e-2, 0.5, shift=LAW)
    peak = 1e-2 / float(LAW.a(303.15))
    found = em.break_out(
        RUBBER, ROUGH, pressure=2e5, boundary_shear=shear, temperature=303.15,
        velocity=peak * np.array([0.01, 0.1, 1.0, 100.0]),
    )  # fmt: skip
    expected = STRESS * np.exp(-0.5 * np.array([4.0, 1.0, 0.0, 0.0]))
    np.testing.assert_allclose(found.shear_stress, expected, rtol=1e-12)
    always = em.break_out(
        RUBBER, ROUGH, pressure=2e5, boundary_shear=shear, temperature=303.15
    )
    assert always.mu == pytest.approx(float(found.mu[-1]), rel=1e-12)


def test_real_contact_of_maps_in_three_dimensions():
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=8e4)
    scene = {"pressure": np.array([5e4, 3e5]), "time": 10.0}
    truth = em.leak(
        RUBBER, surface, pressure_drop=1.0, viscosity=1.0, length=1.0,
        model=em.HalfSpace(cells=128, seeds=2), **scene,
    ).area_ratio  # fmt: skip
    found = em.break_out(RUBBER, surface, boundary_shear=5e3, **scene)
    assert (np.abs(truth / found.area_ratio - 1) < found.model_error / found.mu).all()


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_no_bound_in_nearly_full_contact():
    """The contact is known to 1e-6 there, the growth of bonds at rest is not."""
    found = em.break_out(RUBBER, ROUGH, pressure=[1e5, 2e7, 1e9], boundary_shear=STRESS)
    assert (found.area_ratio[1:] > 0.99).all()
    assert np.isnan(found.model_error).tolist() == [False, True, True]
    finite = np.isfinite(found.model_error)
    assert (found.model_error[finite] >= 0.02 * found.mu[finite]).all()


def test_no_bound_where_shear_exceeds_the_pressure():
    """Its limits and doubts are those of friction without hysteresis."""
    elastic, stress = em.Prony(1e6, [], []), np.array([0.5e6, 2e6])
    rests = [
        em.break_out(elastic, ROUGH, pressure=1e5, boundary_shear=each)
        for each in stress
    ]
    slides = [
        em.friction(
            elastic,
            ROUGH,
            velocity=1.0,
            pressure=1e5,
            adhesion=em.AdhesiveShear(each, 1.0, 0.0),
        )
        for each in stress
    ]
    assert [rest.mu > 1 for rest in rests] == [False, True]
    assert [bool(np.isnan(rest.model_error)) for rest in rests] == [False, True]
    for rest, slide in zip(rests, slides, strict=True):
        np.testing.assert_allclose(rest.mu_low, slide.mu_low, rtol=1e-4)
        np.testing.assert_allclose(rest.mu_high, slide.mu_high, rtol=1e-4)
        for kind in ("no prediction", "bound"):
            assert [d.says for d in rest.doubts if d.kind == kind] == [
                d.says for d in slide.doubts if d.kind == kind
            ]


def test_limits_have_derivatives_beyond_the_pressure():
    def ends(pressure):
        found = em.break_out(RUBBER, ROUGH, pressure=pressure, boundary_shear=2e6)
        return found.mu_low, found.mu_high

    assert ends(1e5)[0] > 0.7
    with jax.enable_x64(True):
        slopes = jax.jacrev(ends)(1e5)
    h = 10.0
    for i, slope in enumerate(slopes):
        centred = (ends(1e5 + h)[i] - ends(1e5 - h)[i]) / (2 * h)
        assert slope == pytest.approx(centred, rel=1e-4)


def test_derivative():
    def mu(pressure):
        return em.break_out(
            RUBBER, ROUGH, pressure=pressure, time=1.0, boundary_shear=STRESS,
            temperature=293.15,
        ).mu  # fmt: skip

    with jax.enable_x64(True):
        slope = float(jax.jit(jax.grad(mu))(2e5))
    assert slope == pytest.approx((mu(2.001e5) - mu(1.999e5)) / 200, rel=1e-4)


def test_summary_and_figure():
    found = em.break_out(
        RUBBER, ROUGH, pressure=2e5, boundary_shear=STRESS, temperature=293.15,
        time=np.geomspace(0.1, 1e3, 5),
    )  # fmt: skip
    assert "contact lets go" in found.summary()
    ax = found.plot()
    assert ax.get_xscale() == "log"
    assert "Break-out" in ax.get_ylabel()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"boundary_shear": -1.0}, ("boundary_shear", -1)),
        ({"time": 0.0}, ("time", 0)),
        ({"velocity": -1.0}, ("velocity", -1)),
        ({"surface": em.Sphere(1e-3)}, ("surface", "Sphere")),
        ({"model": em.Line()}, ("model", "break-out")),
        ({"model": em.HalfSpace()}, ("model", "break-out")),
        (
            {"boundary_shear": em.AdhesiveShear(1e5, 1.0, 0.1, shift=LAW)},
            ("temperature", "boundary_shear", "shift law"),
        ),
        (
            {"material": em.Maxwell(1e6, 1.0), "time": None},
            ("material", "equilibrium"),
        ),
    ],
)
def test_bad_input(change, words):
    given = {"material": RUBBER, "surface": ROUGH, "pressure": 1e5}
    given |= {"boundary_shear": STRESS, "time": 1.0} | change
    with refused(*words):
        em.break_out(**given)


@pytest.mark.parametrize("show", ["mu", "area_ratio"])
def test_figure_has_the_band_of_the_error(show):
    given = {"pressure": 1e6, "boundary_shear": STRESS, "temperature": 293.15}
    found = em.break_out(RUBBER, ROUGH, time=[1.0, 10.0, 100.0], **given)
    ax = found.plot(show=show)
    (band,) = ax.collections
    heights = band.get_paths()[0].vertices[:, 1]
    assert (found.mu_high > 1.01 * found.mu).any()
    values = getattr(found, show)
    assert heights.max() == pytest.approx((values * found.mu_high / found.mu).max())
    assert heights.min() == pytest.approx((values * found.mu_low / found.mu).min())
    said = [label.get_text() for label in ax.get_legend().get_texts()]
    assert "numerical and model error" in said


def test_the_bound_of_softened_rubber_is_the_same_under_jit():
    soft = em.Softening([1e-3, 1e-2, 1.0], [1.0, 0.8, 0.5], [1.0, 1.1, 0.9])
    rubber = em.Prony(1e6, [2e6], [1e-3], softening=soft)

    def bound(pressure):
        return em.break_out(
            rubber, ROUGH, pressure=pressure, boundary_shear=STRESS
        ).model_error

    pressure = np.array([1e5, 2e5])
    with jax.enable_x64(True):
        traced = jax.jit(bound)(pressure)
    assert np.isfinite(traced).all()
    np.testing.assert_allclose(traced, bound(pressure), rtol=1e-9)
