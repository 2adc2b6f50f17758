"""Ensembles of lines with the spectrum of a surface: their samples and their seeds."""

import numpy as np
import pytest

import elastomdr as em

# of the width of the spectrum
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
RUBBER = em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3])


def test_light_contact_asks_for_more_samples():
    asked = {"velocity": [1e-3, 1e-1, 10.0], "pressure": [[1.0], [1e5]]}
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4)
    with pytest.warns(em.ConvergenceWarning, match="more samples"):
        found = em.friction(RUBBER, surface, model=em.Line(), **asked)
    assert not found.converged[0].all()
    assert np.isnan(found.mu[~found.converged]).all()
    assert found.converged[1].all()
    fine = em.friction(RUBBER, surface, model=em.Line(samples=2**17), **asked)
    assert fine.converged.all()
    off = np.abs(found.mu - fine.mu)[1]
    assert (off <= (found.lines.numerical + fine.lines.numerical)[1]).all()
    assert (found.lines.numerical <= 0.1 * found.mu)[1].all()


def test_seeds_by_name_and_by_number():
    asked = {"velocity": [0.1, 1.0], "pressure": 1e5}
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4)
    first, second = (
        em.friction(RUBBER, surface, model=em.Line(seeds=[seed], samples=1024), **asked)
        for seed in (0, 7)
    )
    both = em.friction(
        RUBBER, surface, model=em.Line(seeds=[0, 7], samples=1024), **asked
    )
    np.testing.assert_allclose(both.mu, 0.5 * (first.mu + second.mu), rtol=1e-6)
    assert "seeds 0, 7" in dict(both.inputs)["ensemble"]
    np.testing.assert_array_equal(
        first.mu, em.friction(RUBBER, surface, model=em.Line(samples=1024), **asked).mu
    )
    assert (first.mu != second.mu).all()
