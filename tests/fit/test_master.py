"""Master curves: the truth is found, and intervals hold it."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit.laws import fit_laws, forms

from ..io.dma_files import KNOWN, LAW, RUBBER, STEPS, data
from ..refused import refused

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")


@pytest.fixture(scope="module")
def master():
    return em.fit.master_curve(data(), 293.15)


def test_shift_factors_are_found_within_their_intervals(master):
    truth = np.asarray(LAW.log10_a(master.temperature))
    # a power law: 1 % up is 0.02 decades sideways
    assert np.sqrt(np.mean((master.log10_a - truth) ** 2)) < 0.03
    low, high = master.log10_a_interval.T
    np.testing.assert_allclose(high - low, 2 * 1.96 * master.log10_a_std)
    assert (master.log10_a_std[np.arange(7) != 4] > 1e-4).all()
    at = np.flatnonzero(master.temperature == 293.15)[0]
    assert master.log10_a[at] == master.log10_b[at] == master.log10_a_std[at] == 0
    assert master.converged
    assert master.warnings == ()
    assert master.noise["storage modulus"] == pytest.approx(0.005, rel=0.25)


@pytest.fixture(scope="module")
def laboratories():
    return [
        em.fit.master_curve(data(noise=0.02, seed=100 + seed), 293.15)
        for seed in range(12)
    ]


def test_intervals_hold_the_truth_as_often_as_they_say(laboratories):
    """Of 72 shift factors, six each from twelve laboratories, 95 % intervals hold 62 at
    least: if neighbours miss in pairs, fewer are a chance of 1 %.
    """
    truth, held, scores = np.asarray(LAW.log10_a(STEPS + 273.15)), [], []
    for found in laboratories:
        away = np.abs(found.temperature - 293.15) > 0.1
        low, high = found.log10_a_interval[away].T
        held += ((low <= truth[away]) & (truth[away] <= high)).tolist()
        scores.append(
            (((found.log10_a - truth)[away] / found.log10_a_std[away]) ** 2).mean()
        )
    assert sum(held) >= 62
    assert np.mean(scores) > 0.2  # nor are they so wide that they could not miss


@pytest.mark.parametrize("celsius", [-30.0, 55.0])
def test_intervals_about_a_reference_outside_of_the_data_hold_the_truth(
    laboratories, celsius
):
    """The step to it is the law's, and as uncertain as the law: all shifts of a
    laboratory share its error.
    """
    held, bands = [], []
    for found in laboratories:
        moved = found.at_reference(celsius + 273.15)
        truth = np.asarray(
            LAW.at_reference(celsius + 273.15).log10_a(moved.temperature)
        )
        low, high = moved.log10_a_interval.T
        held.append(((low <= truth) & (truth <= high)).mean())
        omega = np.geomspace(*moved.window, 20)
        band, g = (
            moved.band(omega),
            np.asarray(RUBBER.at(celsius + 273.15).complex_modulus(omega)),
        )
        bands.append(((band.loss_low <= g.imag) & (g.imag <= band.loss_high)).mean())
    assert np.mean(held) > 0.85
    assert np.mean(bands) > 0.85
    assert 0.005 < moved.log10_a_std.min() < 0.05


def test_a_reference_further_than_the_law_carries():
    """60 to 120 degC: 20 degC is reached with an interval of a tenth of a decade, and
    the pole is no reference.
    """
    hot = em.fit.master_curve(data(np.arange(60.0, 121.0, 10.0)), 293.15)
    truth = np.asarray(LAW.log10_a(hot.temperature))
    assert 0.02 < hot.log10_a_std.min() < 0.3
    assert (np.abs(hot.log10_a - truth) <= 3 * hot.log10_a_std).all()
    assert any("knows that step to +- 0." in text for text in hot.warnings)
    for celsius, said in ((-150.0, "past its pole"), (-60.0, "decades only")):
        with refused("reference", 60, 120, said):
            hot.at_reference(celsius + 273.15)


def test_the_laws(master):
    assert isinstance(master.wlf, em.WLF)
    assert isinstance(master.arrhenius, em.Arrhenius)
    assert isinstance(master.vft, em.VFT)
    assert float(master.wlf.reference) == 293.15
    np.testing.assert_allclose([master.wlf.c1, master.wlf.c2], [7.0, 120.0], rtol=0.06)
    assert abs(float(master.wlf.c2) - 120) < 3 * master.laws["WLF"].std["c2"]
    assert master.laws["WLF"].rms < 0.02 < master.laws["Arrhenius"].rms
    assert master.laws["WLF"].residuals.shape == master.temperature.shape
    np.testing.assert_allclose(
        master.vft.log10_a(263.15), master.wlf.log10_a(263.15), atol=0.02
    )


@pytest.mark.parametrize("name", ["Arrhenius", "WLF", "VFT"])
def test_derivatives_of_a_laws_constants_are_differences(name):
    """They turn the uncertainty of the parameters of the search into that of the
    constants.
    """
    form = forms(293.15, 253.15)[name]
    start = np.array(form.start)
    law, derivative = form.constants(start)
    np.testing.assert_allclose(
        law.log10_a(313.15), form.value(start, 313.15), rtol=1e-12
    )
    for i, (constant, slope) in enumerate(derivative.items()):
        step = 1e-5 * np.eye(start.size)[i]
        ends = [
            float(getattr(form.constants(start + move)[0], constant))
            for move in (-step, step)
        ]
        np.testing.assert_allclose(slope, (ends[1] - ends[0]) / 2e-5, rtol=1e-7)


def test_constants_that_the_data_do_not_determine_are_said_to_be_none():
    """Shift factors of Arrhenius: no c1 and c2 make them better than larger ones of the
    same ratio would.
    """
    kelvin = np.arange(273.15, 314.0, 10.0)
    line = np.asarray(em.Arrhenius(9e4, 293.15).log10_a(kelvin))
    laws = fit_laws(kelvin, line, 0.1**2 * np.eye(5), 293.15)
    assert not laws["WLF"].determined
    assert laws["WLF"].constants().startswith("c1 and c2 not determined")
    assert laws["Arrhenius"].determined
    assert laws["Arrhenius"].constants().startswith("energy 9e+04 +- ")
    curved = fit_laws(
        kelvin, np.asarray(LAW.log10_a(kelvin)), 0.002**2 * np.eye(5), 293.15
    )
    assert all(law.determined for law in curved.values())


def test_the_band_holds_the_true_moduli(master):
    omega = np.geomspace(*master.window, 50)
    band, truth = master.band(omega), RUBBER.at(293.15).complex_modulus(omega)
    assert (
        np.mean((band.storage_low <= truth.real) & (truth.real <= band.storage_high))
        > 0.85
    )
    assert (
        np.mean((band.loss_low <= truth.imag) & (truth.imag <= band.loss_high)) > 0.85
    )
    assert np.median(band.loss_high / band.loss_low - 1) < 0.05
    assert band.inside.all()
    with pytest.warns(em.fit.FitWarning, match="2 of 3 frequencies are extrapolated"):
        assert master.band(
            np.array([master.window[0] / 10, 10.0, master.window[1] * 10])
        ).inside.tolist() == [0, 1, 0]


def test_the_order_of_the_points_does_not_matter(master):
    dma = data()
    order = np.random.default_rng(1).permutation(dma.omega.size)
    shuffled = em.fit.dma(
        *(a[order] for a in (dma.omega, dma.storage, dma.loss, dma.temperature)),
        kind="shear",
    )
    again = em.fit.master_curve(shuffled, 293.15)
    np.testing.assert_allclose(again.log10_a, master.log10_a, atol=1e-4)
    np.testing.assert_allclose(
        again.log10_a_std, master.log10_a_std, rtol=0.02, atol=1e-6
    )


@pytest.mark.parametrize("celsius", [-20.0, 15.0, 40.0])
def test_the_reference_temperature_can_be_changed(master, celsius):
    moved = master.at_reference(celsius + 273.15)
    fresh = em.fit.master_curve(data(), celsius + 273.15)
    np.testing.assert_allclose(moved.log10_a, fresh.log10_a, atol=1e-12)
    truth = np.asarray(LAW.at_reference(celsius + 273.15).log10_a(master.temperature))
    np.testing.assert_allclose(moved.log10_a, truth, atol=0.08)
    assert (np.abs(moved.log10_a - truth) <= 3 * moved.log10_a_std + 1e-9).all()
    omega = np.geomspace(*moved.window, 20)[2:-2]
    np.testing.assert_allclose(
        moved.band(omega).storage, RUBBER.at(celsius + 273.15).storage(omega), rtol=0.03
    )


@pytest.mark.parametrize(
    "lift",
    [lambda c: (c + 273.15) / 293.15, lambda c: 1 + 0.05 * np.sin(c)],
    ids=["entropy", "free"],
)
def test_vertical_shifts_are_found(lift):
    master = em.fit.master_curve(data(lift=lift), 293.15)
    truth = np.log10(lift(20.0) / lift(master.temperature - 273.15))
    assert (np.abs(master.log10_b - truth) <= 3 * master.log10_b_std + 1e-9).all()
    assert np.abs(master.log10_b - truth).max() < 0.012
    assert (
        np.abs(master.log10_a - np.asarray(LAW.log10_a(master.temperature))).max()
        < 0.08
    )
    without = em.fit.master_curve(data(lift=lift), 293.15, vertical=False)
    assert np.abs(without.log10_b).max() < 1e-4
    assert "b_T" in master.summary()
    assert "b_T" not in without.summary()
    assert without.summary().count("log10 a_T") >= without.temperature.size
    again = master.without_vertical()
    np.testing.assert_allclose(again.log10_a, without.log10_a, atol=0.01)
    # Both contain what the thermometers were off, which each fit estimates from its own
    # scatter.
    assert (again.log10_a_std >= 0.4 * without.log10_a_std).all()
    assert without.noise["storage modulus"] > 1.5 * master.noise["storage modulus"]


def test_relaxation_shifts_too():
    rng = np.random.default_rng(0)
    t, kelvin = np.geomspace(0.1, 100, 16), np.arange(253.15, 314, 10)
    moduli = np.concatenate([np.asarray(RUBBER.at(T).relaxation(t)) for T in kelvin])
    moduli *= 1 + 0.01 * rng.normal(size=moduli.size)
    dma = em.fit.relaxation(
        np.tile(t, kelvin.size), moduli, np.repeat(kelvin, t.size), kind="shear"
    )
    master = em.fit.master_curve(dma, 293.15)
    truth = np.asarray(LAW.log10_a(master.temperature))
    assert (np.abs(master.log10_a - truth) <= 3 * master.log10_a_std + 1e-9).all()
    assert np.abs(master.log10_a - truth).max() < 0.15
    both = em.fit.master_curve(em.fit.join(dma, data()), 293.15)
    assert np.abs(both.log10_a - truth).max() < 0.03
    assert both.time.size == moduli.size


@pytest.mark.parametrize("noise", [0.0, 1e-3])
def test_relaxation_that_has_come_to_an_end_is_level(noise):
    """Its slow edge is the equilibrium modulus, and no slow branches in place of it
    that would still relax there.
    """
    rng, t, parts = np.random.default_rng(0), np.geomspace(0.01, 1e3, 24), []
    for T in np.arange(-10.0, 61.0, 10.0) + 273.15:
        moduli = np.asarray(KNOWN.at(T).relaxation(t)) * (
            1 + noise * rng.normal(size=t.size)
        )
        parts.append(em.fit.relaxation(t, moduli, T, kind="shear"))
    master = em.fit.master_curve(em.fit.join(*parts), 293.15)
    time = 1 / np.geomspace(master.window[0], 0.1, 12)
    band, truth = (
        master.relaxation_band(time),
        np.asarray(KNOWN.at(293.15).relaxation(time)),
    )
    assert np.abs(band.relaxation / truth - 1).max() < 1e-4 + noise
    assert (
        (band.relaxation_low <= truth) & (truth <= band.relaxation_high)
    ).mean() > 0.9


def test_few_temperatures():
    one = em.fit.master_curve(data([20.0]))
    assert one.wlf is None
    assert any("one temperature only" in text for text in one.warnings)
    two = em.fit.master_curve(data([10.0, 20.0]), 293.15)
    assert two.wlf is None
    assert two.arrhenius is not None
    outside = em.fit.master_curve(data(), 273.15 + 60)
    assert any("extrapolating" in text for text in outside.warnings)


def test_a_ramp_is_cut_into_isotherms():
    rng = np.random.default_rng(2)
    kelvin = np.repeat(np.linspace(258.0, 308.0, 120), 3)
    omega = 2 * np.pi * np.tile([0.5, 5.0, 50.0], 120)
    moduli = np.array(
        [
            RUBBER.at(T).complex_modulus(w)
            for T, w in zip(kelvin[::6], omega[::6], strict=True)
        ]
    )
    a = 10 ** np.asarray(LAW.log10_a(kelvin))
    moduli = np.asarray(RUBBER.at(293.15).complex_modulus(omega * a))
    noise = 1 + 0.01 * rng.normal(size=(2, kelvin.size))
    master = em.fit.master_curve(
        em.fit.dma(
            omega, moduli.real * noise[0], moduli.imag * noise[1], kelvin, kind="shear"
        ),
        293.15,
    )
    assert 10 <= master.temperature.size <= 20
    assert (
        np.abs(master.log10_a - np.asarray(LAW.log10_a(master.temperature))).max()
        < 0.08
    )


def test_refusals():
    dma = data()
    for call, said in (
        (lambda: em.fit.master_curve([1, 2]), "dma must be a Dma"),
        (lambda: em.fit.master_curve(dma, -5), "reference must be in kelvin"),
        (lambda: em.fit.master_curve(dma, "20 degC"), "reference must be a number"),
        (
            lambda: em.fit.master_curve(dma, 293.15, vertical="yes"),
            "vertical must be True or False",
        ),
        (
            lambda: em.fit.master_curve(
                em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="shear")
            ),
            "five points",
        ),
    ):
        with pytest.raises(InputError, match=said):
            call()


def test_tables_and_figures(master, tmp_path):
    master.to_csv(tmp_path / "master.csv")
    lines = (tmp_path / "master.csv").read_text().splitlines()
    rows = [line for line in lines if not line.startswith("#")]
    assert len(rows) == 1 + master.omega.size
    assert any("log10 a_T" in line for line in lines)
    ax = master.plot()
    assert "rad/s" in ax.get_xlabel()
    assert "log10 a_T" in repr(master)
