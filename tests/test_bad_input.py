"""Every refusal names the argument and what is accepted; nothing that has no meaning gets a number."""

import jax
import numpy as np
import pytest

import elastomdr as em

SOLID = em.Foundation(1e6, [1e6], [1e-3])
SPHERE = em.Sphere(5e-3)
WARM = em.Prony(1e5, [1e6], [1e-3], shift=em.WLF(8.86, 101.6, 293.15))

CASES = {
    "negative times": (lambda: em.Prony(1.0, [1.0], [-1.0]), "times must be positive"),
    "unsorted times": (lambda: em.Prony(1.0, [1.0, 1.0], [1.0, 0.1]), "times must be ascending.*1 followed by 0.1"),
    "repeated times": (lambda: em.Prony(1.0, [1.0, 1.0], [1.0, 1.0]), "times must be ascending"),
    "NaN moduli": (lambda: em.Prony(1.0, [np.nan], [1.0]), "moduli must be zero or positive.*nan"),
    "negative modulus": (lambda: em.Foundation(1.0, [-1.0], [1.0]), "moduli must be zero or positive"),
    "lengths": (lambda: em.Prony(1.0, [1.0], [1.0, 2.0]), "same length"),
    "nothing carries": (lambda: em.Prony(0.0, [], []), "all zero"),
    "text": (lambda: em.Prony("soft", [1.0], [1.0]), "equilibrium must be a number"),
    "poisson": (lambda: em.Prony(1.0, [], [], poisson=0.6), "poisson must be above -1 and at most 0.5, got 0.6"),
    "poisson below": (lambda: em.Prony(1.0, [], [], poisson=-1.0), "poisson"),
    "poisson and bulk": (lambda: em.Prony(1.0, [], [], poisson=0.4, bulk=1e9), "exclude each other"),
    "bulk below a ninth": (lambda: em.Prony(1e6, [1e9], [1.0], kind="tensile", bulk=1e8), "ninth"),
    "kind": (lambda: em.Prony(1.0, [], [], kind="bulk"), "'shear' or 'tensile'"),
    "name": (lambda: em.Prony(1.0, [], [], name=3), "name must be a text, got 3"),
    "traced exponent": (
        lambda: jax.grad(lambda n: em.PowerLaw(n, 1.0).profile_1d(1.0))(1.5),
        "exponent must be a plain number: it is not differentiable",
    ),
    "profile curve": (lambda: em.Profile([0, 1, 2, 3], [0, 1, 4, 9], curve="linear"), "'spline' or 'monotone'"),
    "shift": (lambda: em.Prony(1.0, [], [], shift=0.5), "shift must be a WLF"),
    "shift table": (lambda: em.ShiftTable([300.0, 290.0], [0.0, 1.0]), "temperature must be ascending"),
    "outside the table": (lambda: em.ShiftTable([290.0, 300.0], [1.0, 0.0]).a(310.0), "within the shift table"),
    "WLF pole": (lambda: em.WLF(8.86, 101.6, 293.15).a(190.0), "above the WLF pole at 191.55 K.*got 190"),
    "close above the WLF pole": (
        lambda: em.friction(
            em.StandardSolid(1e6, 1e6, 1e-3, shift=em.WLF(8.86, 101.6, 293.15)),
            em.Sphere(5e-3),
            velocity=1.0,
            load=1.0,
            temperature=194.0,
        ),
        "temperature must keep the velocity times a_T between.*got 194 K",
    ),
    "no velocity": (
        lambda: em.friction(em.StandardSolid(1e6, 1e6, 1e-3), em.Sphere(5e-3), velocity=[], load=1.0),
        "must not be empty",
    ),
    "time before the step": (lambda: em.StandardSolid(1e6, 1e6, 1e-3).relaxation([-1.0]), "t must be zero or positive"),
    "negative frequency": (lambda: em.StandardSolid(1e6, 1e6, 1e-3).storage(-1.0), "omega must be zero or positive"),
    "Maxwell modulus": (lambda: em.Maxwell(-1.0, 1.0), "modulus must be zero or positive"),
    "Maxwell time": (lambda: em.Maxwell(1.0, -1.0), "time must be positive"),
    "VFT pole": (lambda: em.VFT(2000.0, 141.5, 243.15).a(141.0), "above the VFT pole"),
    "radius": (lambda: em.Sphere(-1.0), "radius must be positive"),
    "radius array": (lambda: em.Sphere([1.0, 2.0]), "radius must be a single number"),
    "thickness": (lambda: em.springs(em.Prony(1e6, [], [], poisson=0.4), 0.0), "thickness must be positive"),
    "bonded incompressible layer": (lambda: em.springs(em.Prony(1e6, [], []), 1e-3), "poisson must be below 0.5"),
    "profile start": (lambda: em.Profile([1.0, 2.0, 3.0, 4.0], [0.0, 1.0, 2.0, 3.0]), "r must start at 0"),
    "profile falls": (lambda: em.Profile([0.0, 1.0, 2.0, 3.0], [0.0, 1.0, 0.5, 3.0]), "z must not fall"),
    "material": (lambda: em.friction("rubber", SPHERE, velocity=1.0, load=1.0), "material must be"),
    "shape": (lambda: em.friction(SOLID, 5e-3, velocity=1.0, load=1.0), "shape must be"),
    "both": (lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, depth=1e-4), "load or depth"),
    "neither": (lambda: em.friction(SOLID, SPHERE, velocity=1.0), "load or depth.*neither"),
    "zero velocity": (lambda: em.friction(SOLID, SPHERE, velocity=0.0, load=1.0), "velocity must be positive.*got 0"),
    "one bad velocity": (lambda: em.friction(SOLID, SPHERE, velocity=[1.0, -2.0], load=1.0), "velocity.*got -2"),
    "infinite load": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=np.inf),
        "load must be positive and finite",
    ),
    "zero depth": (lambda: em.friction(SOLID, SPHERE, velocity=1.0, depth=0.0), "depth must be positive"),
    "pressure": (lambda: em.friction(SOLID, SPHERE, velocity=1.0, pressure=1e5), "pressure belongs to a rough surface"),
    "no shift law": (
        lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, temperature=300.0),
        "temperature was given.*no shift law",
    ),
    "below the pole": (
        lambda: em.friction(WARM, SPHERE, velocity=1.0, load=1.0, temperature=150.0),
        "above the WLF pole",
    ),
    "celsius taken for kelvin": (
        lambda: em.friction(WARM, SPHERE, velocity=1.0, load=1.0, temperature=-10.0),
        "temperature must be positive",
    ),
    "broadcast": (lambda: em.friction(SOLID, SPHERE, velocity=[1.0, 2.0], load=[1.0, 2.0, 3.0]), "must broadcast"),
    "model": (lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, model="lines"), "model must be"),
    "rtol": (lambda: em.friction(SOLID, SPHERE, velocity=1.0, load=1.0, rtol=1e-14), "rtol must be"),
    "flat punch": (lambda: em.friction(SOLID, em.FlatPunch(1e-3), velocity=1.0, load=1.0), "FlatPunch.*edge"),
    "sharp tip": (lambda: em.friction(SOLID, em.PowerLaw(0.5, 1.0), velocity=1.0, load=1.0), "exponent must be 1"),
    "cone rolls": (lambda: em.rolling(SOLID, em.Cone(0.1), velocity=1.0, load=1.0), "shape must roll"),
    "cylinder on a half-space": (
        lambda: em.friction(WARM, em.Cylinder(0.1, 1.0), velocity=1.0, depth=1e-4),
        "depth must be left out for a cylinder on a half-space",
    ),
    "beyond the profile": (
        lambda: em.friction(
            SOLID, em.Profile([0.0, 1e-3, 2e-3, 3e-3], [0.0, 1e-4, 4e-4, 9e-4]), velocity=1.0, depth=1.0
        ),
        "depth must be below",
    ),
    "quantity": (lambda: em.plan(SOLID, SPHERE, velocity=1.0, load=1.0, quantity="wear"), "quantity must be"),
    "two shift laws": (lambda: em.half_space(WARM, em.Prony(1.0, [], [])), "same shift law"),
}


@pytest.mark.parametrize("case", CASES)
def test_refused(case):
    call, message = CASES[case]
    with pytest.raises(em.InputError, match=message) as caught:
        call()
    assert "\n" not in str(caught.value)
    assert isinstance(caught.value, ValueError)
