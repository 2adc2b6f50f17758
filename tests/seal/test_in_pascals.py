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
    """A fluid presses from all sides: that of hydraulics is no doubt of the rubber."""
    with warned(em.ModelWarning, "in Pa", "3e+08"):
        ring = em.o_ring(SOFT, 5e-3, 0.15, fluid_pressure=[3e8, 35e6])
    (doubt,) = ring.doubts
    assert doubt.kind == "estimate"
    assert doubt.points.tolist() == [True, False]


def test_a_profile_of_300_mpa_under_a_rod():
    x = np.linspace(0.0, 1e-3, 101)
    given = {"velocity_out": [0.5, 0.4], "velocity_in": 0.5, "stroke": 0.05}

    def moved(highest):
        profile = (x, highest * np.sin(np.pi * x / 1e-3))
        return em.reciprocating(profile=profile, viscosity=1.0, **given)

    with warned(em.ModelWarning, "in Pa", "3e+08"):
        hard = moved(3e8)
    assert [d.points.tolist() for d in hard.doubts if d.kind == "estimate"] == [
        [True, True]
    ]
    assert "estimate" not in kinds(moved(3e6))


@pytest.mark.parametrize("stress", [3e7, 5e7])
@pytest.mark.parametrize("verb", ["break_out", "road", "sphere", "cells", "lubricated"])
def test_a_shear_far_above_the_modulus(verb, stress):
    """At rest 4 MPa, at the rates of friction up to 8 MPa: 30 MPa is within five times
    that, and 50 MPa is not; a tenth of both nowhere.
    """
    given = {"velocity": 10.0, "load": 1.0}

    def found(stress):
        shear = em.AdhesiveShear(stress, 1e-3, 0.0)
        if verb == "break_out":
            return em.break_out(SOFT, ROAD, pressure=3e5, boundary_shear=stress)
        if verb == "road":
            return em.friction(SOFT, ROAD, pressure=3e5, velocity=1.0, adhesion=shear)
        if verb == "lubricated":
            rough = {"surface": ROAD, "boundary_shear": shear, "viscosity": 0.1}
            return em.lubricated(SOFT, ROD, velocity=0.1, load=10.0, **rough)
        model = em.HalfSpace(cells=32) if verb == "cells" else None
        ball = em.Sphere(0.01)
        return em.friction(SOFT, ball, model=model, adhesion=shear, **given)

    def doubted(result):
        estimates = [d for d in result.doubts if d.kind == "estimate"]
        return any("shear stress" in each.says for each in estimates)

    if stress > 4e7 or verb == "break_out":
        with warned(em.ModelWarning, f"{stress:g} Pa", "in Pa", "times the modulus"):
            assert doubted(found(stress))
    else:
        assert not doubted(found(stress))
    assert not doubted(found(stress / 10))


def test_a_pressure_on_a_liquid():
    liquid = em.Prony(0.0, [1e6], [1e-2])
    given = {"pressure": 3e5, "boundary_shear": 1e-3, "time": 1e4}
    with warned(em.ModelWarning, "all but flows"):
        em.break_out(liquid, ROAD, **given)


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
