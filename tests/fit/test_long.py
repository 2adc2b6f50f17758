"""Long measurements are fitted in seconds, as well as short ones; what a fit doubts is warned of as well."""

import time
import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning
from elastomdr.fit.isotherms import MOST, gathered

from ..io.dma_files import LAW, RUBBER, data

HERTZ = np.array([1.0, 10.0, 50.0])


def ramp(rows, seed=0, factor=1.0):
    """A ramp from -40 to 60 degC at three frequencies in turn, with 1 % of noise."""
    rng = np.random.default_rng(seed)
    celsius = np.repeat(np.linspace(-40.0, 60.0, rows // HERTZ.size), HERTZ.size)
    omega = 2 * np.pi * np.resize(HERTZ, celsius.size)
    reduced = omega * 10 ** np.asarray(LAW.log10_a(celsius + 273.15))
    moduli = [np.asarray(RUBBER.storage(reduced)), np.asarray(RUBBER.loss(reduced))]
    noisy = [factor * m * (1 + 0.01 * rng.normal(size=m.size)) for m in moduli]
    return em.fit.dma(omega, *noisy, celsius + 273.15, kind="shear")


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
@pytest.mark.parametrize("strain", [False, True])
def test_a_long_ramp_is_fitted_in_seconds_and_right(strain):
    long = ramp(60_000)
    if strain:
        long = em.fit.Dma(
            long.temperature,
            long.omega,
            long.storage,
            long.loss,
            "shear",
            strain=np.full(long.size, 1e-3),
        )
    start = time.process_time()
    fit = em.fit.material(long, 293.15, shift=LAW)
    assert time.process_time() - start < 10.0
    low, high = fit.prony.master.window
    omega = np.geomspace(2 * low, high / 2, 30)
    for name, off in (("storage", 0.005), ("loss", 0.01)):
        got, truth = (getattr(one, name)(omega) for one in (fit.material, RUBBER))
        np.testing.assert_allclose(got, truth, rtol=off)
    assert fit.warnings[0].startswith(f"{long.size} points are fitted as ")


def test_short_measurements_are_fitted_as_they_are():
    short = ramp(MOST)
    assert gathered(short) == (short, ())


def test_gathered_points_are_the_curve_and_passes_stay_apart():
    up, down = ramp(30_000, 0), ramp(30_000, 1, factor=1.2)
    found, words = gathered(em.fit.join(up, down))
    assert found.size <= MOST
    assert "60000 points are fitted as" in words[0]
    np.testing.assert_array_equal(np.unique(found.omega), 2 * np.pi * HERTZ)
    reduced = found.omega * 10 ** np.asarray(LAW.log10_a(found.temperature))
    ratio = found.storage / np.asarray(RUBBER.storage(reduced))
    passes = np.split(ratio, 2)  # in the order in which they were measured
    np.testing.assert_allclose(passes[0], 1.0, atol=0.01)
    np.testing.assert_allclose(passes[1], 1.2, atol=0.012)


def test_relaxation_over_time_is_gathered():
    t = np.linspace(0.1, 3000.0, 30_000)
    long = em.fit.relaxation(t, 1e6 * (1 + t**-0.3), 293.15, kind="shear")
    found, _ = gathered(long)
    assert found.time.size <= MOST
    np.testing.assert_allclose(
        found.relaxation, 1e6 * (1 + found.time**-0.3), rtol=0.002
    )


def told(call, *arguments, **options):
    """What a call returns, and what it warns of."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = call(*arguments, **options)
    assert {one.category for one in caught} <= {FitWarning}
    assert {one.filename for one in caught} <= {__file__}  # who called, not we
    return found, [str(one.message) for one in caught]


def test_what_a_fit_doubts_is_warned_of_once():
    two = data(np.array([0.0, 20.0]))
    for fit, said in (
        told(em.fit.master_curve, two),
        told(em.fit.material, two, progress=lambda done, total: None),
        told(
            em.fit.prony,
            two.omega[:11],
            two.storage[:11],
            two.loss[:11],
            kind="tensile",
        ),
    ):
        assert said
        assert said == list(fit.warnings)
        assert all(f"{'warning':<16}{text}" in fit.summary() for text in said)


def test_what_other_fits_doubt_is_warned_of():
    strain = np.array([1e-3, 2e-3, 3e-3, 5e-3])
    sweep = {
        "strain": strain,
        "storage": 2e6 - 1e8 * strain,
        "loss": 2e5 + 1e7 * strain,
    }
    fit, said = told(em.fit.softening, sweep)
    assert said
    assert said == list(fit.warnings)
    v = np.geomspace(1e-4, 1e-2, 8)
    velocity, kelvin = np.tile(v, 2), np.repeat([293.15, 313.15], v.size)
    fit, said = told(
        em.fit.friction_master, velocity, kelvin, np.full(velocity.size, 0.5)
    )
    assert said
    assert said == list(fit.warnings)


def test_the_command_line_says_a_doubt_once(tmp_path, capsys):
    rows = data(np.array([0.0, 20.0]))
    table = np.column_stack([rows.omega, rows.temperature, rows.storage, rows.loss])
    titles = "omega [rad/s],T [K],G' [Pa],G'' [Pa]"
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header=titles, comments="")
    assert main(["fit", str(tmp_path / "a.csv"), "--out", str(tmp_path)]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.count("two temperatures only") == 1


def test_a_fit_says_how_far_it_is():
    steps = []
    told(
        em.fit.material,
        data(np.array([0.0, 20.0])),
        progress=lambda *step: steps.append(step),
    )
    assert steps == [(1, 3), (2, 3), (3, 3)]
