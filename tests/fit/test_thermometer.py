"""The error of isotherms' temperatures: found from the scatter about a law, and part of
the intervals.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit.laws import USUAL, slopes, temperature_error

from ..io.dma_files import KNOWN, data
from ..refused import mentions

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

KELVIN = np.array(
    [253.15, 263.15, 273.15, 283.15, 293.15, 303.15, 313.15, 323.15, 333.15]
)
LAW = KNOWN.shift


def factors(error, seed, kelvin=KELVIN, law=LAW):
    off = error * np.random.default_rng(seed).normal(size=kelvin.size)
    return np.asarray(law.log10_a(kelvin + off)) - float(law.log10_a(kelvin[0]))


def test_found_from_the_scatter_about_a_law():
    known = 0.002**2 * np.eye(KELVIN.size)
    for error, low, high in ((0.0, 0.0, 0.06), (0.3, 0.2, 0.4), (0.6, 0.4, 0.8)):
        found = [
            temperature_error(KELVIN, factors(error, seed), known) for seed in range(20)
        ]
        assert low <= np.sqrt(np.mean(np.square(found))) <= high
    np.testing.assert_allclose(
        slopes(KELVIN, factors(0.0, 0))[3], -5.8 * 125 / (125 - 10) ** 2, rtol=0.03
    )


def test_the_usual_error_where_the_scatter_says_nothing():
    known = 0.002**2 * np.eye(KELVIN.size)
    assert temperature_error(KELVIN[:3], factors(0.0, 0)[:3], known[:3, :3]) == USUAL
    jumps = factors(0.0, 0) - 1.5 * (KELVIN > 290)  # no law, and no thermometer
    assert temperature_error(KELVIN, jumps, known) == USUAL


def test_what_is_expected_where_the_factors_are_hardly_known():
    """The likelihood is flat: half normal with two chances in three and nothing with
    one, mean square 2/3 USUAL^2.
    """
    found = temperature_error(KELVIN, factors(0.0, 0), 100.0**2 * np.eye(KELVIN.size))
    np.testing.assert_allclose(found, USUAL * np.sqrt(2 / 3), rtol=0.015)


def trial(seed, error, kelvin=KELVIN, **options):
    """Hits of log10 a_T, and of the loss modulus over the window."""
    celsius = kelvin - 273.15
    off = error * np.random.default_rng([seed, 1]).normal(size=celsius.size)
    moved = data(celsius + off, noise=0.005, seed=seed, material=KNOWN)
    dma = em.fit.dma(
        moved.omega, moved.storage, moved.loss, np.repeat(kelvin, 11), kind="shear"
    )
    master = em.fit.master_curve(dma, 293.15, **options)
    low, high = master.log10_a_interval.T
    truth, omega = np.asarray(LAW.log10_a(kelvin)), np.geomspace(*master.window, 30)
    band, loss = master.band(omega), np.asarray(KNOWN.at(293.15).loss(omega))
    return (
        ((low <= truth) & (truth <= high))[kelvin != 293.15],
        (band.loss_low <= loss) & (loss <= band.loss_high),
    )


@pytest.mark.parametrize("error", [0.0, 0.3])
def test_intervals_hold_with_and_without_an_error(error):
    """One line a decade, 6 draws: benchmarks/fit_coverage.py --thermometers counts
    300.
    """
    hits = [trial(seed, error) for seed in range(6)]
    for part in zip(*hits, strict=True):
        assert np.concatenate(part).mean() >= 0.87
    if error:
        without = np.concatenate(
            [trial(seed, error, temperature_error=0.0)[0] for seed in range(4)]
        )
        assert without.mean() < 0.75


def test_it_may_be_given_and_is_said():
    dma = data(KELVIN - 273.15, material=KNOWN)
    one, other = (
        em.fit.master_curve(dma, 293.15, temperature_error=error)
        for error in (0.0, 1.0)
    )
    expected = np.abs(slopes(KELVIN, np.asarray(LAW.log10_a(KELVIN))))
    at = KELVIN == 293.15
    np.testing.assert_allclose(
        np.sqrt(other.log10_a_std**2 - one.log10_a_std**2)[~at],
        np.hypot(expected, expected[at])[~at],
        rtol=0.1,
    )
    assert mentions(other.summary(), 2, 95)
    assert other.laws["WLF"].std["c2"] > one.laws["WLF"].std["c2"]
    with pytest.raises(InputError, match="temperature_error must be"):
        em.fit.master_curve(dma, 293.15, temperature_error=-1.0)
