"""Master curves of data that do not say enough, or contradict themselves: it is said,
and in the intervals.
"""

import numpy as np
import pytest

import elastomdr as em

from ..io.dma_files import LAW, RUBBER, STEPS, SWEEP, data, measure

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")


def test_a_plateau_is_not_separable():
    """On a plateau with a constant loss tangent a horizontal shift is a vertical
    one.
    """
    tau = np.geomspace(1e-30, 1e40, 281)
    flat = em.Prony(0.0, 5e4 * tau**-0.06, tau, shift=em.WLF(4.0, 110.0, 293.15))
    rows = data(
        np.arange(20.0, 71.0, 10.0), material=flat, lift=lambda c: 1 + 0.02 * np.cos(c)
    )
    master = em.fit.master_curve(rows, 293.15)
    assert master.ambiguous[2:].any()
    assert any("cannot be separated" in text for text in master.warnings)
    # Intervals are too narrow here (the covariance takes ripples fitted to noise for
    # landmarks): the warning counts.
    assert master.log10_a_std.max() > 0.05
    # whatever is exchanged, the curve passes through the data
    omega = np.geomspace(*master.window, 20)
    np.testing.assert_allclose(
        master.band(omega).storage, flat.at(293.15).storage(omega), rtol=0.2
    )


@pytest.mark.parametrize("seed", range(3))
def test_a_constant_loss_tangent_is_not_separable(seed):
    """The same without vertical shifts: small residuals do not make known what no data
    can show.
    """
    tau = np.geomspace(1e-30, 1e40, 281)
    flat = em.Prony(0.0, 5e4 * tau**-0.1, tau, shift=em.WLF(4.0, 110.0, 293.15))
    rows = data(np.arange(20.0, 51.0, 10.0), material=flat, seed=seed)
    master = em.fit.master_curve(rows, 293.15)
    assert master.ambiguous.sum() == 3  # all but the anchor
    assert any("cannot be separated" in text for text in master.warnings)
    if seed == 0:
        assert not em.fit.master_curve(rows, 293.15, vertical=False).ambiguous.any()


def test_isotherms_that_do_not_overlap_are_named():
    master = em.fit.master_curve(
        data([-20.0, 20.0, 30.0], hertz=np.geomspace(1, 10, 12)), 293.15
    )
    assert any(
        "do not overlap" in text and "-20 and 20 degC" in text
        for text in master.warnings
    )
    assert master.log10_a_std[0] > 5 * master.log10_a_std[2]


def test_a_gap_is_bridged_with_an_interval_that_says_so():
    """Two decades and a half without data: the step across is uncertain by some tenths
    of a decade, and held.
    """
    held, widths = [], []
    for seed in range(6):
        master = em.fit.master_curve(
            data([-30.0, 10.0, 20.0, 30.0], hertz=np.geomspace(1, 20, 10), seed=seed),
            293.15,
        )
        off = master.log10_a - np.asarray(LAW.log10_a(master.temperature))
        held.append(abs(off[0]) <= 1.96 * master.log10_a_std[0])
        widths.append(master.log10_a_std[0])
    assert sum(held) >= 5
    assert 0.1 < np.mean(widths) < 0.6


def test_gross_outliers_lose_their_hold():
    """One storage modulus in thirteen is a hundred times too large."""
    clean = data()
    wrong = np.where(np.arange(clean.storage.size) % 13 == 5, 100.0, 1.0)
    dirty = em.fit.dma(
        clean.omega, clean.storage * wrong, clean.loss, clean.temperature, kind="shear"
    )
    master = em.fit.master_curve(dirty, 293.15)
    truth = np.asarray(LAW.log10_a(master.temperature))
    assert np.abs(master.log10_a - truth).max() < 0.1
    (said,) = (
        text for text in master.warnings if "6 of 154 values are outliers" in text
    )
    assert said.count(" rad/s") == 6


def test_two_processes_are_not_thermorheologically_simple():
    rows = [
        measure(RUBBER, np.array([c]), SWEEP, 0.005, 0)
        for c in (-20.0, 0.0, 20.0, 40.0)
    ]
    other = em.Prony(0, [4e6, 4e6], [1e-2, 1e-1], shift=em.Arrhenius(2e4, 293.15))
    more = [
        measure(other, np.array([c]), SWEEP, 0.0, 0) for c in (-20.0, 0.0, 20.0, 40.0)
    ]
    f, t, s, l = (np.concatenate(rows) + np.concatenate(more) * [0, 0, 1, 1]).T
    master = em.fit.master_curve(
        em.fit.dma(2 * np.pi * f, s, l, t + 273.15, kind="shear"), 293.15
    )
    assert any(
        text.startswith("Not thermorheologically simple") for text in master.warnings
    )


def test_points_that_are_copies_count_once():
    """A table pasted twice says no more than once: intervals must not shrink."""
    rows = measure(RUBBER, noise=0.01)
    both = np.concatenate([rows, rows])
    once, twice = (
        em.fit.master_curve(
            em.fit.dma(
                2 * np.pi * r[:, 0], r[:, 2], r[:, 3], r[:, 1] + 273.15, kind="shear"
            ),
            293.15,
        )
        for r in (rows, both)
    )
    np.testing.assert_array_equal(once.log10_a_std, twice.log10_a_std)
    repeated = [
        any("104 of 208 points repeat" in text for text in each.warnings)
        for each in (once, twice, twice.at_reference(303.15))
    ]
    assert repeated == [False, True, True]


def test_two_measurements_that_contradict_each_other_are_said_by_how_much():
    """Relaxation three times too large, as a tensile modulus taken for one of shear is,
    at the isotherms of both.
    """
    time = np.geomspace(0.01, 100, 15)
    for factor, celsius in ((3.0, STEPS), (3.0, STEPS[:-1] + 4.0), (1.1, STEPS)):
        slow = [
            em.fit.relaxation(
                time,
                factor * np.asarray(RUBBER.at(kelvin).relaxation(time)),
                kelvin,
                kind="shear",
            )
            for kelvin in np.asarray(celsius) + 273.15
        ]
        fit = em.fit.material(em.fit.join(data(), *slow), 293.15)
        texts = [text for text in fit.warnings if "contradict each other" in text]
        if factor == 1.1:
            assert not texts
            continue
        assert "relaxation modulus is 3 times" in texts[0]
        assert all("by a factor of 3" in text for text in texts[1:])
        # between isotherms of the other, a vertical shift makes up for it
        assert len(texts) > (celsius is STEPS)
        assert not any("thermorheologically" in text for text in fit.warnings)


def test_a_law_that_misses_the_data_is_said():
    """Arrhenius' law for what WLF's is true of, forced on it."""
    found = em.fit.material(data(), 293.15, law="Arrhenius", vertical=False)
    assert max(found.misfit.values()) > 0.1
    (text,) = (
        text
        for text in found.warnings
        if text.startswith("Material and shift law miss the data")
    )
    assert "Arrhenius misses" in text
    assert not any(
        "shift law miss" in text
        for text in em.fit.material(data(), 293.15, vertical=False).warnings
    )
