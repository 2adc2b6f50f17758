"""Ensembles of lines with the spectrum of a surface: how many samples they take, and which seeds."""

import numpy as np
import pytest

import elastomdr as em

RUBBER = em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3])


def test_light_contact_takes_the_samples_it_needs():
    asked = {"velocity": [1e-3, 1e-1, 10.0], "pressure": [[1.0], [1e5]], "average": None}
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4)
    found = em.friction(RUBBER, surface, **asked)
    assert found.converged.all()
    assert "of up to" in dict(found.inputs)["ensemble"]
    fine = em.friction(RUBBER, surface, samples=2**17, sampling=1.0, **asked)
    assert (np.abs(found.mu - fine.mu) <= found.error + fine.error).all()
    assert (found.error <= 0.1 * found.mu).all()
    few = {"samples": 1024, **asked}  # asked for, and kept to
    with pytest.warns(em.ConvergenceWarning, match="more samples"):
        coarse = em.friction(RUBBER, surface, **few)
    assert not coarse.converged[0].all()
    assert coarse.converged[1].all()


def test_seeds_by_name_and_by_number():
    asked = {"velocity": [0.1, 1.0], "pressure": 1e5, "average": None, "samples": 1024}
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4)
    first, second = (em.friction(RUBBER, surface, seeds=[seed], **asked) for seed in (0, 7))
    both = em.friction(RUBBER, surface, seeds=[0, 7], **asked)
    np.testing.assert_allclose(both.mu, 0.5 * (first.mu + second.mu), rtol=1e-6)
    assert "seeds 0, 7" in dict(both.inputs)["ensemble"]
    np.testing.assert_array_equal(first.mu, em.friction(RUBBER, surface, **asked).mu)
    assert (first.mu != second.mu).all()
