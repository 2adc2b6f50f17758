"""The shear law that measured friction leaves to hysteresis: known laws found again,
intervals, what is undecided.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

RUBBER = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(0.8, rms_slope=0.7, q_low=1.26e3, q_high=3.1e5)
TRUTH = {"stress": 6e6, "velocity": 4e-3, "width": 0.1, "energy": 9e4}
LAW = em.AdhesiveShear(6e6, 4e-3, 0.1, shift=em.Arrhenius(9e4, 293.15))
KELVIN = np.array([[278.15], [293.15], [308.15]])
SCENE = {
    "velocity": np.geomspace(1e-6, 0.1, 10),
    "temperature": KELVIN,
    "pressure": 3e5,
    "rtol": 1e-4,
}


@pytest.fixture(scope="module")
def bare():
    return em.friction(RUBBER, ROAD, **SCENE)


@pytest.fixture(scope="module")
def mu():
    return em.friction(RUBBER, ROAD, adhesion=LAW, **SCENE).mu


def noisy(mu, seed=0, noise=0.02):
    return mu * (1 + noise * np.random.default_rng(seed).normal(size=mu.shape))


def test_without_noise_the_law_comes_back(bare, mu):
    fit = em.fit.adhesion(bare, mu, error=1e-6)
    for name, value in TRUTH.items():
        assert fit.parameters[name] == pytest.approx(value, rel=1e-6), name
    assert fit.converged
    assert fit.reference == 293.15
    assert fit.warnings == ()
    again = em.friction(RUBBER, ROAD, adhesion=fit.law, **SCENE)
    assert again.mu == pytest.approx(mu, rel=1e-6)


@pytest.mark.parametrize("error", ["known", "relative", None])
def test_intervals_hold_the_truth_about_as_often_as_they_say(bare, mu, error):
    """12 draws of four intervals of 95 %: fewer than 41 of 48 would be three standard
    deviations off; the benchmark adhesion_coverage.py draws 200.
    """
    inside = []
    for seed in range(12):
        given = 0.02 * mu if error == "known" else error
        fit = em.fit.adhesion(bare, noisy(mu, seed), error=given)
        inside += [
            fit.interval[name][0] <= value <= fit.interval[name][1]
            for name, value in TRUTH.items()
        ]
        for name, value in TRUTH.items():  # no interval is so wide that it must
            assert fit.interval[name][1] - fit.interval[name][0] < 0.6 * value
    assert np.mean(inside) >= 0.86


def test_a_free_cutoff_is_found_with_it(bare, mu):
    curves = {
        q: em.friction(RUBBER, ROAD.ended(q), **SCENE)
        for q in np.geomspace(3e4, 3e6, 7)
    }
    exact = em.fit.adhesion(curves, mu, error=0.02 * mu)
    assert exact.q_high == pytest.approx(3.1e5, rel=0.03)  # cubics between cutoffs
    assert exact.parameters["stress"] == pytest.approx(6e6, rel=0.03)
    fit, held = (
        em.fit.adhesion(curve, noisy(mu, 1), error=0.02 * mu)
        for curve in (curves, bare)
    )
    low, high = fit.interval["q_high"]
    assert low <= 3.1e5 <= high
    widths = [np.diff(np.log(f.interval["stress"]))[0] for f in (fit, held)]
    assert widths[0] > 2 * widths[1]  # area and stress exchange for each other


def test_what_the_data_cannot_decide_is_said(bare, mu):
    slow = {
        **SCENE,
        "velocity": np.geomspace(1e-6, 1e-5, 6),
        "temperature": KELVIN[1:2],
    }
    curve = em.friction(RUBBER, ROAD, **slow)
    measured = noisy(em.friction(RUBBER, ROAD, adhesion=LAW, **slow).mu, 3)
    fit = em.fit.adhesion(curve, measured, error=0.02 * measured)
    assert "energy" not in fit.parameters
    assert fit.law.shift is None
    said = " ".join(fit.warnings)
    assert "cannot be determined" in said
    assert "one temperature" in said
    assert np.isinf(fit.interval["velocity"][1])
    assert np.isinf(fit.interval["stress"][1])
    low = em.fit.adhesion(bare, 0.5 * bare.mu, error=0.02 * mu)
    assert "above the measured friction" in " ".join(low.warnings)
    wrong = em.fit.adhesion(bare, noisy(mu, 0, 0.1), error=0.01 * mu)
    assert "do not describe" in " ".join(wrong.warnings)


def test_a_table_of_friction_is_taken_as_it_is_read(bare, mu, tmp_path):
    v, t = (np.broadcast_to(x, mu.shape).ravel() for x in (SCENE["velocity"], KELVIN))
    rows = [
        f"{a:.12g},{b:.12g},{c:.12g}"
        for a, b, c in zip(v, t - 273.15, noisy(mu).ravel(), strict=True)
    ]
    path = tmp_path / "rig.csv"
    path.write_text(
        "\n".join(["velocity [m/s],temperature [degC],mu", *rows]), encoding="utf-8"
    )
    data = em.read_friction(path)
    from_file = em.fit.adhesion(bare, data, error="relative")
    direct = em.fit.adhesion(bare, noisy(mu), error="relative")
    for name in TRUTH:
        assert from_file.parameters[name] == pytest.approx(
            direct.parameters[name], rel=1e-5
        )
    finer = em.friction(
        RUBBER, ROAD, **{**SCENE, "velocity": np.geomspace(1e-6, 0.1, 91)}
    )
    on_grid = em.fit.adhesion(finer, data, error="relative")
    assert on_grid.parameters["stress"] == pytest.approx(
        direct.parameters["stress"], rel=1e-4
    )


def test_the_result_has_words_a_table_and_a_figure(bare, mu, tmp_path):
    fit = em.fit.adhesion(bare, noisy(mu), error="relative")
    said = repr(fit)
    for text in (
        "95 %, by the profile",
        "stress",
        "J/mol",
        "of the friction",
        "model error",
    ):
        assert text in said
    fit.to_csv(tmp_path / "fit.csv")
    rows = [
        row
        for row in (tmp_path / "fit.csv").read_text(encoding="utf-8").splitlines()
        if row[0] != "#"
    ]
    assert len(rows) == 31
    assert fit.hysteresis + fit.adhesion + fit.residuals == pytest.approx(
        fit.measured, rel=1e-12
    )
    assert fit.plot().get_xlabel() == "Sliding velocity [m/s]"
    low, high = fit.level
    assert low < fit.parameters["stress"] < high


def test_bad_input_is_one_clear_line(bare, mu):
    line = em.friction(
        em.StandardSolid(1e6, 1e6, 1e-2), em.Sphere(0.01), velocity=[0.1, 1.0], load=1.0
    )
    for call, named in (
        (lambda: em.fit.adhesion(line, [0.5, 0.6]), "real contact area"),
        (lambda: em.fit.adhesion(bare, mu.ravel()), "measured"),
        (lambda: em.fit.adhesion(bare, mu, error="percent"), "error"),
        (lambda: em.fit.adhesion(bare, mu, error=-1.0), "error"),
        (lambda: em.fit.adhesion({1e5: bare, 2e5: bare}, mu), "curve"),
        (lambda: em.fit.adhesion(mu, mu), "curve"),
        (
            lambda: em.fit.adhesion(
                em.friction(RUBBER, ROAD, velocity=[1e-3, 1e-2], pressure=3e5),
                [0.5, 0.6],
            ),
            "more",
        ),
    ):
        with pytest.raises(InputError, match=named) as caught:
            call()
        assert "\n" not in str(caught.value)


class TestSeveralCompounds:
    """One law for several rubbers on one road."""

    SOFT = em.Prony(
        RUBBER.equilibrium,
        0.6 * RUBBER.moduli,
        RUBBER.times,
        shift=RUBBER.shift,
        name="softer",
    )

    def test_the_law_of_all_comes_back_where_one_alone_sees_one_flank(self):
        """Each was measured on another side of the summit of its stress."""
        scenes = [
            SCENE | {"velocity": np.geomspace(*ends, 6)}
            for ends in ((1e-7, 1e-4), (1e-3, 1e-1))
        ]
        rubbers = [RUBBER, self.SOFT]
        pairs = list(zip(rubbers, scenes, strict=True))
        curves = [em.friction(rubber, ROAD, **scene) for rubber, scene in pairs]
        measured = [
            em.friction(rubber, ROAD, adhesion=LAW, **scene).mu
            for rubber, scene in pairs
        ]
        fit = em.fit.adhesion(curves, measured, error=1e-6)
        for name, value in TRUTH.items():
            assert fit.parameters[name] == pytest.approx(value, rel=1e-6), name
        assert fit.carried == pytest.approx((1.0, 1.0), abs=1e-6)
        np.testing.assert_array_equal(fit.compound, np.repeat([0, 1], 18))
        np.testing.assert_allclose(fit.measured, np.concatenate(measured, None))

    def test_how_well_it_carries_is_the_stress_of_each_by_itself(
        self, bare, mu, tmp_path
    ):
        other = em.friction(self.SOFT, ROAD, **SCENE)
        stronger = em.AdhesiveShear(7.2e6, 4e-3, 0.1, shift=LAW.shift)
        measured = em.friction(self.SOFT, ROAD, adhesion=stronger, **SCENE).mu
        fit = em.fit.adhesion([bare, other], [mu, measured], error="relative")
        first, second = fit.carried
        assert second / first == pytest.approx(1.2, rel=0.05)
        assert first < 1 < second
        said = dict(fit.findings())["compounds"]
        assert f"{first:.3g}, {second:.3g}" in said
        fit.to_csv(tmp_path / "both.csv")
        lines = (tmp_path / "both.csv").read_text().splitlines()
        rows = [line for line in lines if not line.startswith("#")]
        place = rows[0].split(",").index("compound")
        assert {row.split(",")[place] for row in rows[1:]} == {"1", "2"}

    def test_softening_that_is_left_out_does_not_carry(self):
        """A rubber that softens at the strains of asperities has more contact: without
        its softening the same friction takes a larger stress, with it the same.
        """
        payne = em.Softening(
            [1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.35], [1.0, 0.9, 0.6, 0.4]
        )
        fields = {"shift": RUBBER.shift, "name": "filled"}
        filled = em.Prony(
            RUBBER.equilibrium, RUBBER.moduli, RUBBER.times, softening=payne, **fields
        )
        linear = em.Prony(RUBBER.equilibrium, RUBBER.moduli, RUBBER.times, **fields)
        unfilled = self.SOFT
        measured = [
            em.friction(rubber, ROAD, adhesion=LAW, **SCENE).mu
            for rubber in (filled, unfilled)
        ]

        def apart(rubber, share=0.5):
            curves = [
                em.friction(each, ROAD, strain_share=share, **SCENE)
                for each in (rubber, unfilled)
            ]
            first, second = em.fit.adhesion(curves, measured, error="relative").carried
            return first / second

        assert apart(filled) == pytest.approx(1.0, abs=1e-6)
        assert apart(filled, 0.25) == pytest.approx(1.13, abs=0.03)
        assert apart(filled, 1.0) == pytest.approx(1 / 1.12, abs=0.03)
        assert apart(linear) == pytest.approx(2.26, abs=0.1)

    def test_bad_lists_are_one_clear_line(self, bare, mu):
        for curves, measured, argument in (
            ([bare, bare], [mu], "measured"),
            ([bare, bare], mu, "measured"),
            ([bare, {1e5: bare, 2e5: bare, 3e5: bare, 4e5: bare}], [mu, mu], "curve"),
        ):
            with pytest.raises(InputError) as caught:
                em.fit.adhesion(curves, measured)
            assert caught.value.argument == argument
