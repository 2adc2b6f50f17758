"""`em.FrictionLaw`: interpolation, tables, and traction with a friction that depends on
the sliding velocity.
"""

from typing import ClassVar

import jax
import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import brentq

import elastomdr as em

from ..refused import mentions, refused

V, T, P = (
    np.geomspace(1e-3, 30, 7),
    np.array([263.15, 283.15, 313.15]),
    np.array([1e5, 4e5]),
)
MU = np.random.default_rng(1).uniform(0.2, 1.0, (3, 2, 7))
LAW = em.FrictionLaw(V, MU, temperature=T, pressure=P)


def test_interpolates_as_a_lookup_table_of_another_program():
    rng = np.random.default_rng(2)
    v, t, p = (
        np.exp(rng.uniform(np.log(1e-3), np.log(30), 50)),
        rng.uniform(T[0], T[-1], 50),
        rng.uniform(1e5, 4e5, 50),
    )
    table = RegularGridInterpolator((T, np.log(P), np.log(V)), MU)
    np.testing.assert_allclose(
        LAW(v, t, p), table(np.stack([t, np.log(p), np.log(v)], axis=1)), rtol=1e-12
    )
    np.testing.assert_allclose(LAW(V, T[:, None, None], P[:, None]), MU, rtol=1e-14)


def test_derivatives():
    def value(x):
        return em.FrictionLaw(V, MU * x[3], temperature=T, pressure=P)(x[0], x[1], x[2])

    at, step = np.array([0.7, 290.0, 2e5, 1.1]), 1e-6
    with jax.enable_x64(True):
        found = np.asarray(jax.jit(jax.grad(value))(at))
    each = np.diag(at * step)
    np.testing.assert_allclose(
        found,
        [(value(at + d) - value(at - d)) / (2 * d.sum()) for d in each],
        rtol=1e-7,
    )


def test_points_beyond_the_range_of_the_rubber_stay_marked(tmp_path):
    rubber = em.Prony(1e6, [4e6], [1e-3], range={"omega": (1.0, 1e4)})
    scene = {"velocity": [1e-3, 1e-2, 0.1, 10.0], "load": 1.0, "model": em.Line()}
    with pytest.warns(em.ExtrapolationWarning):
        curve = em.friction(rubber, em.Sphere(5e-3), **scene)
    curve.to_csv(tmp_path / "curve.csv")
    curve.law().to_csv(tmp_path / "law.csv")
    files = (em.load_friction(tmp_path / f"{name}.csv") for name in ("curve", "law"))
    for law in (curve.law(), *files):
        np.testing.assert_array_equal(law.extrapolated, [True, False, False, True])
    braked = em.traction(
        em.Foundation(4e6, [], []),
        em.Sphere(5e-3),
        velocity=1.0,
        creepage=[2e-3, 0.05, 0.1, 0.2],
        friction=curve.law(),
        load=1.0,
        tangential=em.Foundation(3e6, [], []),
    )
    np.testing.assert_array_equal(braked.extrapolated, [True, False, False, True])
    assert mentions(braked.summary(), "2 of 4 points", "beyond the range")
    assert LAW.extrapolated is None
    wrong = em.Doubt("extrapolated", np.array([True]))
    with refused("doubts", "points"):
        em.FrictionLaw([1.0, 2.0], [0.1, 0.2], doubts=[wrong])


def test_outside_is_refused_and_nan_where_it_cannot_be_seen():
    with refused("velocity", 0.001, 30, "m/s", 31):
        LAW(31.0, 290.0, 2e5)
    with jax.enable_x64(True):
        assert np.isnan(jax.jit(lambda v: LAW(v, 290.0, 2e5))(31.0))


def test_a_hole_spoils_its_neighbours_only():
    law = em.FrictionLaw([1.0, 2.0, 3.0, 4.0], [0.1, np.nan, 0.3, 0.4])
    np.testing.assert_array_equal(
        np.isnan(law([1.0, 1.5, 2.0, 2.5, 3.0, 3.5])), [0, 1, 1, 1, 0, 0]
    )


def test_tables(tmp_path):
    """What is written is what is read, whoever wrote it: the law, or a curve with its
    other columns.
    """
    law = em.FrictionLaw(
        V, np.where(np.max(MU) == MU, np.nan, MU), temperature=T, pressure=P
    )
    law.to_csv(tmp_path / "law.csv")
    again = em.load_friction(tmp_path / "law.csv")
    for name in ("velocity", "temperature", "pressure", "mu"):
        np.testing.assert_array_equal(getattr(again, name), getattr(law, name))
    lines = (tmp_path / "law.csv").read_text().splitlines()
    assert (
        lines[3]
        == "temperature [K],pressure [Pa],velocity [m/s],friction coefficient [-],doubts"
    )
    mixed = [*lines[:4], *np.random.default_rng(0).permutation(lines[4:])]
    (tmp_path / "mixed.csv").write_text("\n".join(mixed))
    np.testing.assert_array_equal(em.load_friction(tmp_path / "mixed.csv").mu, law.mu)
    (tmp_path / "mixed.csv").write_text("\n".join(mixed[:-1]))
    with pytest.raises(em.InputError, match=r"a full grid.*1 missing"):
        em.load_friction(tmp_path / "mixed.csv")
    (tmp_path / "wrong.csv").write_text(
        "velocity [mm/s],friction coefficient [-]\n1,0.5\n"
    )
    with pytest.raises(em.InputError, match=r"one column 'velocity \[m/s\]'"):
        em.load_friction(tmp_path / "wrong.csv")


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
def test_from_a_curve(tmp_path):
    rubber = em.StandardSolid(1e6, 9e6, 1e-4, shift=em.WLF(8.86, 101.6, 293.15))
    road = em.SelfAffine(0.8, rms_slope=0.3, q_low=1.2e3, q_high=2e4)
    points = {
        "velocity": np.array([1.0, 0.1]),
        "temperature": np.array([[[283.15]], [[303.15]]]),
    }
    curve = em.friction(
        rubber,
        road,
        pressure=np.array([[1e5], [2e5]]),
        model=em.Line(),
        rtol=1e-3,
        heat=em.Heat(0.25, 2e6),
        **points,
    )
    law = curve.law()
    np.testing.assert_array_equal(law.mu, curve.mu[..., ::-1])
    curve.to_csv(tmp_path / "curve.csv")
    np.testing.assert_array_equal(em.load_friction(tmp_path / "curve.csv").mu, law.mu)
    assert "friction law" not in curve.summary()
    smooth = em.friction(
        rubber, em.Paraboloid(1e-2), velocity=[0.1, 1.0], load=1.0, model=em.Line()
    )
    assert smooth.law().temperature is None


E, G, R, A = 4e6, 4e6 * 2 / 3, 0.01, 2e-3
LOAD = 4 / 3 * E * A**3 / R
NORMAL, TANGENTIAL, BALL = (
    em.Foundation(E, [], []),
    em.Foundation(G, [], []),
    em.Paraboloid(R),
)
CREEP = np.array([0.05, 0.0, 1e-3, 0.1, 0.29, 0.31, 2.0, -0.05])


def test_traction_with_friction_of_the_sliding_velocity():
    """The brush with mu(v |xi|, p), p = F_N/(pi a^2) the mean pressure of Hertz."""
    pressure = LOAD / (np.pi * A**2)
    law = em.FrictionLaw(
        V, np.stack([MU[0, 0], MU[0, 0] / 2]), pressure=[pressure / 2, pressure * 2]
    )
    found = em.traction(
        NORMAL,
        BALL,
        velocity=10.0,
        creepage=CREEP,
        friction=law,
        load=LOAD,
        tangential=TANGENTIAL,
    )
    slip = np.where(CREEP == 0, V[0], 10 * np.abs(CREEP))
    mu = 0.75 * np.interp(np.log(slip), np.log(V), MU[0, 0])
    zeta = np.minimum(np.abs(CREEP) * R * G / (2 * A * mu * E), 1)
    np.testing.assert_allclose(found.friction, mu, rtol=1e-9)
    np.testing.assert_allclose(
        found.coefficient,
        np.sign(CREEP) * mu * (1 - (1 - zeta) ** 3),
        rtol=1e-9,
        atol=1e-16,
    )
    peak = found.peak()
    assert (
        np.abs(found.coefficient).max()
        == np.abs(peak.coefficient)
        == np.abs(found.coefficient[peak.place])
    )
    assert "friction law" in found.summary()
    assert found.plot().get_xlabel() == "Creepage [%]"


def test_carter_with_friction_of_the_sliding_velocity():
    load, creep = np.pi * E * A**2 / (4 * R), np.array([0.05, 1.0])
    law = em.FrictionLaw(V, MU[0, 0])
    found = em.traction(
        em.half_space(em.Prony(E / 4, [], [])),
        em.Cylinder(R, 1.0),
        velocity=10.0,
        creepage=creep,
        friction=law,
        load=load,
    )
    mu = np.interp(np.log(10 * creep), np.log(V), MU[0, 0])
    part = np.minimum(creep * R / (mu * A), 1)
    np.testing.assert_allclose(found.coefficient, mu * part * (2 - part), rtol=1e-9)


def test_against_elements_with_a_sliding_velocity_of_their_own():
    """A brush whose elements slip at v (xi - u'), k_t u = mu(v s) q with s = xi - u',
    step by step: how far the one velocity of the body is from it. A friction that
    changes by 10 % per decade: 2 % at most.
    """
    k, kt, length, v, half = 2e9, 0.5e9, 0.1, 10.0, 0.05
    mu, radius = np.interp(np.log10(V), [-3, 2], [0.5, 0.75]), 0.3
    law = em.FrictionLaw(V, mu)
    load = 2 / 3 * k * half**3 / radius * length
    creep = np.array([0.1, 0.2, 0.4, 1.0])
    found = em.traction(
        em.Foundation(k, [], []),
        em.Cylinder(radius, length),
        velocity=v,
        creepage=creep,
        friction=law,
        load=load,
        tangential=em.Foundation(kt, [], []),
    )
    r = np.linspace(0, 2 * half, 801)
    q, h = k * (r * (2 * half - r)) / (2 * radius), r[1]
    for xi, coefficient in zip(creep, found.coefficient, strict=True):
        u, force = 0.0, 0.0
        for pressed in q[1:]:

            def excess(s, u=u, pressed=pressed, xi=xi):
                return kt * (u + h * (xi - s)) - pressed * np.interp(
                    np.log10(max(v * s, V[0])), np.log10(V), mu
                )

            s = brentq(excess, 0.0, 10 * xi) if excess(0.0) > 0 else 0.0
            u += h * (xi - s)
            force += kt * u * h * length
        assert abs(coefficient / (force / load) - 1) < 0.02


class TestShiftLaws:
    SHIFT = em.WLF(8.86, 101.6, 293.15)
    TREAD = em.StandardSolid(1e6, 9e6, 1e-3, shift=SHIFT)
    WHEEL: ClassVar = {"velocity": 1.0, "creepage": 0.01, "friction": 0.8, "load": 2e3}

    def test_of_the_tread_under_an_elastic_structure(self):
        """Shear of a layer is G(t)/h, at the temperature given as by the material
        brought to it.
        """
        sheared = em.springs(self.TREAD, 8e-3, tangential=True)
        np.testing.assert_allclose(sheared.moduli, np.asarray(self.TREAD.moduli) / 8e-3)
        tyre = em.Foundation(1e8, [], []), em.Cylinder(0.3, 0.16)
        warm = em.traction(*tyre, **self.WHEEL, temperature=303.15, tangential=sheared)
        at = em.springs(self.TREAD.at(303.15), 8e-3, tangential=True)
        np.testing.assert_allclose(
            warm.force,
            em.traction(*tyre, **self.WHEEL, tangential=at).force,
            rtol=1e-12,
        )
        assert (
            abs(
                warm.force / em.traction(*tyre, **self.WHEEL, tangential=sheared).force
                - 1
            )
            > 1e-3
        )

    def test_that_differ_are_refused(self):
        other = em.half_space(
            em.StandardSolid(1e6, 9e6, 1e-3, shift=em.WLF(5.0, 100.0, 293.15)),
            tangential=True,
        )
        with refused("tangential", "shift law"):
            em.traction(
                self.TREAD, BALL, **self.WHEEL, temperature=303.15, tangential=other
            )


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: em.FrictionLaw([1.0, 0.5], [0.1, 0.2]), ("velocity", "ascending")),
        (lambda: em.FrictionLaw([1.0, 2.0], [0.1, 0.2, 0.3]), ("mu", "shape")),
        (
            lambda: em.FrictionLaw([1.0, 2.0], [0.1, -0.2]),
            ("mu", "positive"),
        ),
        (
            lambda: em.FrictionLaw([1.0, 2.0], [0.1, np.inf]),
            ("mu", "positive"),
        ),
        (lambda: LAW(1.0, 290.0), ("pressure",)),
        (
            lambda: em.FrictionLaw([1.0], [0.1])(1.0, temperature=290.0),
            ("temperature", "left out"),
        ),
        (lambda: LAW([1.0, 2.0], [290.0, 291.0, 292.0], 2e5), ("", "broadcast")),
        (lambda: em.load_friction("no such file"), ("path", "text file")),
        (
            lambda: em.springs(
                em.Prony(1e6, [], []), 1e-3, bonded=False, tangential=True
            ),
            ("bonded", "True"),
        ),
        (
            lambda: em.traction(
                NORMAL,
                BALL,
                velocity=1.0,
                creepage=0.1,
                friction=LAW,
                load=LOAD,
                tangential=TANGENTIAL,
            ),
            ("temperature",),
        ),
        (
            lambda: em.traction(
                em.half_space(em.Prony(1e6, [], [])),
                em.Cylinder(R, 1.0),
                velocity=1.0,
                creepage=0.1,
                friction=0.5,
                load=1.0,
                temperature=300.0,
            ),
            ("temperature", "left out"),
        ),
    ],
)
def test_bad_input(call, message):
    with refused(*message):
        call()
