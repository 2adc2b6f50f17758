"""Pressures and stresses in another unit than Pa are told by every verb of a seal, and
what presses a body in deeper than it is wide.
"""

import numpy as np
import pytest

import elastomdr as em

from ..refused import warned

SOFT = em.Prony(1e6, [1e6], [1e-2])  # E* = 4 MPa at rest
ROAD = em.SelfAffine(hurst=0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
ROD = em.Cylinder(0.01, 0.1)


def kinds(result):
    return {doubt.kind for doubt in result.doubts}


def test_a_fluid_of_300_mpa_on_a_ring():
    with warned(em.ModelWarning, "in Pa", "3.00587e+08", "75.1 times"):
        ring = em.o_ring(SOFT, 5e-3, 0.15, fluid_pressure=[3e8, 3e5])
    (doubt,) = ring.doubts
    assert doubt.kind == "estimate"
    assert doubt.points.tolist() == [True, False]
    assert not em.o_ring(SOFT, 5e-3, 0.15, fluid_pressure=3e6).doubts


@pytest.mark.parametrize("verb", ["break_out", "friction", "lubricated"])
def test_a_shear_of_200_mpa_is_more_than_rubber_bears(verb):
    shear = em.AdhesiveShear(2e8, 1e-3, 0.0)
    with warned(em.ModelWarning, "2e+08 Pa", "in Pa"):
        if verb == "break_out":
            em.break_out(SOFT, ROAD, pressure=3e5, boundary_shear=2e8)
        elif verb == "friction":
            em.friction(SOFT, ROAD, pressure=3e5, velocity=0.1, adhesion=shear)
        else:
            given = {"velocity": 0.1, "load": 10.0, "viscosity": 0.1}
            em.lubricated(SOFT, ROD, surface=ROAD, boundary_shear=shear, **given)


@pytest.mark.parametrize("factor", [0.5, 2.0, 7.0])
def test_pressures_above_the_modulus(factor):
    """All above it are an estimate, those far above it are warned of."""
    given = {"pressure": factor * 4e6, "boundary_shear": 1e6}
    if factor > 5:
        with warned(em.ModelWarning, "7 times"):
            start = em.break_out(SOFT, ROAD, **given)
    else:
        start = em.break_out(SOFT, ROAD, **given)
    assert ("estimate" in kinds(start)) is (factor > 1)


@pytest.mark.parametrize("rubber", ["rests", "passes"])
def test_a_film_on_a_contact_deeper_than_it_is_wide(rubber):
    """a^2 = 4 W R/(pi E* L) where the rubber rests: a = R at W = pi E* L R/4."""
    flat = np.pi / 4 * 4e6 * ROD.length * ROD.radius
    given = {"velocity": 0.1, "viscosity": 0.1, "rubber": rubber}
    with warned(em.ModelWarning, "deeper than the radius of contact"):
        deep = em.lubricated(SOFT, ROD, load=2 * flat, **given)
    assert deep.converged
    assert "estimate" in kinds(deep)
    assert "estimate" not in kinds(em.lubricated(SOFT, ROD, load=0.9 * flat, **given))


def test_a_film_on_a_layer_that_is_pressed_flat_says_so():
    with warned(em.ConvergenceWarning, "1 of them", "load (in N)"):
        film = em.lubricated(
            em.layer(SOFT, 5e-3), ROD, velocity=0.1, load=3e8, viscosity=0.1
        )
    assert np.isnan(film.mu)
