"""Slide.spectrum and Drive.spectrum: amplitudes and power of a force that is known."""

import dataclasses

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

TIME = np.linspace(0, 0.4, 401)  # 1 ms
SLIDE = em.slide(
    em.Foundation(1e6, [1e6], [0.01]),
    em.Paraboloid(0.01),
    time=TIME[:9],
    position=0.1 * TIME[:9],
    depth=1e-4,
    rtol=1e-2,
)
FORCE = 5 + 2 * np.cos(2 * np.pi * 20 * TIME) + 0.3 * np.sin(2 * np.pi * 70 * TIME)


def motion(force=FORCE, time=TIME):
    return dataclasses.replace(
        SLIDE,
        time=time,
        normal_force=force,
        friction_force=0.1 * force,
        mu=0.1 + 0 * force,
        model_error=0 * force,
        converged=force == force,
        marks=(),
    )


def test_amplitudes_of_whole_periods():
    found = motion().spectrum(since=0.1, period=0.05)
    expected = np.where(
        np.isclose(found.frequency, 20),
        2.0,
        np.where(np.isclose(found.frequency, 70), 0.3, 0.0),
    )
    # 70 Hz has 3.5 waves in a period of 0.05 s, and whole ones in the six periods that
    # are left.
    np.testing.assert_allclose(found.amplitude, expected, atol=1e-12)
    assert found.rms == pytest.approx(np.sqrt(2.0 + 0.045), rel=1e-12)
    assert float(found.mean) == pytest.approx(5.0, rel=1e-12)
    assert "largest amplitude" in found.summary()
    assert "2 N at 20 Hz" in found.summary()
    assert (
        motion().spectrum("friction_force", since=0.1, period=0.05).amplitude
        <= 0.2 + 1e-12
    ).all()


def test_what_dies_out_is_in_the_error():
    settled = motion().spectrum(since=0.2, period=0.05)
    dying = motion(
        FORCE + np.exp(-TIME / 0.1) * np.cos(2 * np.pi * 20 * TIME)
    ).spectrum(since=0.2, period=0.05)
    assert settled.error.max() < 1e-10
    off = np.abs(dying.amplitude - settled.amplitude)
    at = np.argmin(abs(dying.frequency - 20))
    assert off[at] > 0.02
    assert dying.error[at] > 0.5 * off[at]


def test_density_of_noise():
    """White noise of variance s^2 has the density 2 s^2 dt."""
    noise = np.random.default_rng(2).normal(0, 3.0, 4001)
    found = motion(noise, np.linspace(0, 4, 4001)).spectrum()
    assert found.density.mean() == pytest.approx(2 * 9.0 * 1e-3, rel=0.05)
    assert found.rms == pytest.approx(noise.std(), rel=0.05)
    assert np.isnan(found.error).all()
    assert found.plot().get_yscale() == "log"
    assert motion().spectrum(period=0.05).plot().get_xlabel() == "Frequency [Hz]"


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"force": "pull"}, ("force", "normal_force", "friction_force")),
        ({"since": 0.399}, ("since", "eight instants", 0.399)),
        ({"period": 0.0505e-1}, ("period",)),
        ({"period": 1.0}, ("period",)),
    ],
)
def test_bad_input(arguments, text):
    with refused(*text):
        motion().spectrum(**arguments)


def test_uneven_or_failed_instants_are_refused():
    with refused("time", "evenly"):
        motion(time=TIME**1.1).spectrum()
    with refused("since", "converged"):
        motion(np.where(TIME > 0.2, np.nan, FORCE)).spectrum()
