"""`em.friction_spectrum` against closed forms of full contact, and against
`em.friction` where contact is partial.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.results.spectrum import FrictionSpectrum

from ..refused import refused, warned

RUBBER = em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3])
WAVES = np.array([1000.0, 5000.0, 30000.0])  # k [rad/m]
HEIGHTS = np.array([2e-5, 8e-6, 2e-6])  # A [m]
X = np.arange(4096) * 2 * np.pi / WAVES[0] / 4096
LINE = em.RoughLine(X, HEIGHTS @ np.cos(WAVES[:, None] * X))
VELOCITY = np.array([0.01, 0.3, 10.0])
SOLID = em.StandardSolid(1e6, 9e6, 1e-4, shift=em.WLF(8.86, 101.6, 293.15))
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1.2e3, q_high=2e4)


def waves_of(found):
    """What lies in the bands next to each of the three waves, and the rest."""
    near = np.array(
        [np.abs(np.log(found.wave_number[0] / k)) < np.log(1.8) for k in WAVES]
    )
    return found.mu @ near.T, found.mu[:, ~near.any(axis=0)]


@pytest.mark.parametrize(
    "rubber", [RUBBER, em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3], 20.0)]
)
def test_full_contact_is_a_sum_over_the_waves(rubber):
    """mu = sum (1/2) A^2 k E''(k v)/F, each wave in its own band."""
    found = em.friction_spectrum(
        rubber, LINE, velocity=VELOCITY, load=1000.0, model=em.Line(), rtol=1e-6
    )
    expected = (
        0.5
        * HEIGHTS**2
        * WAVES
        * rubber.loss(np.multiply.outer(VELOCITY, WAVES))
        / 1000.0
    )
    bands, rest = waves_of(found)
    np.testing.assert_allclose(bands, expected, rtol=2e-4)
    # Straight lines between the samples have a little beyond.
    assert np.all(np.abs(rest).max(axis=1) < 3e-6 * expected.max(axis=1))
    np.testing.assert_allclose(
        found.omega, VELOCITY[:, None] * found.wave_number, rtol=1e-12
    )
    low, high = found.central(0.5)
    assert np.all(
        (low < high)
        & (low > WAVES[0] * VELOCITY / 2)
        & (high < 2 * WAVES[-1] * VELOCITY)
    )


def test_what_the_waves_of_straight_pieces_lack_is_an_error():
    """128 samples a wave, straight between them: the wave keeps sinc^4(1/128) of its
    power, and the bands are scaled to friction.
    """
    x = np.arange(512) * 2 * np.pi / WAVES[1] / 16
    line = em.RoughLine(x, HEIGHTS[1] * np.cos(WAVES[1] * x))
    scene = {"velocity": VELOCITY, "load": 1000.0, "model": em.Line(), "rtol": 1e-6}
    found = em.friction_spectrum(RUBBER, line, **scene)
    friction = em.friction(RUBBER, line, **scene)
    np.testing.assert_allclose(found.mu.sum(axis=1), friction.mu, rtol=1e-5)
    gap = (found.error[:, 0] - friction.error) / friction.mu
    assert np.all(gap < 1.1 * (1 - np.sinc(1 / 128) ** 4))


def test_averaged_over_directions():
    """sum (1/2) A^2 k <cos(phi) E''(k v cos(phi))>/F: those of each wave lie at and
    below its own frequency.
    """
    found = em.friction_spectrum(
        RUBBER, LINE, velocity=VELOCITY, load=1000.0, model=em.Line(average=True)
    )
    phi = (np.arange(4000) + 0.5) / 4000 * np.pi / 2
    loss = (
        RUBBER.loss(np.multiply.outer(np.multiply.outer(VELOCITY, WAVES), np.cos(phi)))
        @ np.cos(phi)
        / phi.size
    )
    np.testing.assert_allclose(
        found.total, (0.5 * HEIGHTS**2 * WAVES * loss).sum(axis=1) / 1000.0, rtol=1e-3
    )
    assert np.all(found.mu[:, found.wave_number[0] > 1.8 * WAVES[-1]] < 1e-9)


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
def test_partial_contact_sums_to_friction():
    scene = {
        "pressure": 5e4,
        "temperature": np.array([283.15, 303.15])[:, None],
        "model": em.Line(),
        "rtol": 1e-4,
    }
    velocity = np.array([0.1, 1.0, 10.0])
    found = em.friction_spectrum(SOLID, ROAD, velocity=velocity, **scene)
    friction = em.friction(SOLID, ROAD, velocity=velocity, **scene)
    assert friction.lines.share.min() < 0.2
    np.testing.assert_allclose(found.total, friction.mu, rtol=1e-3)
    assert found.mu.min() >= 0
    finer = em.friction_spectrum(SOLID, ROAD, velocity=velocity, per_decade=8, **scene)
    np.testing.assert_allclose(
        finer.mu.reshape(*found.total.shape, -1, 2).sum(axis=-1), found.mu, rtol=1e-9
    )
    assert found.plot().get_ylabel() == "Friction coefficient per decade [-]"
    assert "eight tenths" in found.summary()
    assert "angular frequency [rad/s]" in found.csv()


def test_the_middle_of_the_friction():
    """Even over the logarithm within a band: of decades with 1/4 and 3/4, half lies
    from 10 to 10^(5/3) rad/s.
    """
    omega = 10 ** np.array([[0.5, 1.5]])
    found = FrictionSpectrum(
        velocity=np.ones((1, 2)),
        omega=omega,
        wave_number=omega,
        mu=np.array([[0.1, 0.3]]),
        error=np.zeros((1, 2)),
        model_error=np.full((1, 2), np.nan),
        converged=np.ones((1, 2), bool),
        width=10.0,
        model="",
        plan=None,
        inputs=(),
    )
    np.testing.assert_allclose(
        np.ravel(found.central(0.5)), [10.0, 10 ** (5 / 3)], rtol=1e-12
    )


def test_failed_points_are_nan(monkeypatch):
    monkeypatch.setattr("elastomdr.rough.ensemble.SAMPLING", 1e-9)
    with warned(em.ConvergenceWarning, "1 of 1"):
        found = em.friction_spectrum(
            SOLID, ROAD, velocity=1.0, pressure=5e4, model=em.Line()
        )
    assert np.isnan(found.mu).all()
    assert np.isnan(found.central()[0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"surface": em.Sphere(1e-3)}, ("surface", "em.RoughLine")),
        ({"per_decade": 0}, ("per_decade", "whole number")),
        ({"pressure": None}, ("", "pressure")),
        ({"temperature": 290.0}, ("", "shift law")),
        ({"velocity": -1.0}, ("velocity", "positive")),
        ({"velocity": [1.0, 2.0], "pressure": [1.0, 2.0, 3.0]}, ("", "broadcast")),
        ({"model": em.Averaged()}, ("model", "em.Line")),
    ],
)
def test_bad_input(changes, message):
    with refused(*message):
        em.friction_spectrum(
            RUBBER, **{"surface": ROAD, "velocity": 1.0, "pressure": 1e5, **changes}
        )
