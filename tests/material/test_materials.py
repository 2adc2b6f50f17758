"""Relaxation and creep, Radok's operators, bodies in series, shift laws: exact numbers,
stability over 20 decades.
"""

import jax
import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

SHEAR = (5e5, [2e6, 1e6, 4e5], [1e-3, 0.1, 10.0])
BULK = 5e6

# E* and G* of a half-space with constant bulk modulus: poles of the functional
# equations, held against a numerical inverse Laplace transform (Talbot) to 1e-12 where
# they were derived.
NORMAL = {
    "equilibrium": 1823529.4117647058,
    "moduli": [2e6, 1942613.234332268, 1e6, 1611798.677505719, 4e5, 857352.7940443661],
    "times": [
        0.001,
        0.0013531216245051116,
        0.1,
        0.12155947026085713,
        10.0,
        10.943263878702872,
    ],
    "relaxation": {
        0.0005: 8236558.799626811,
        0.05: 4749767.69710211,
        3.0: 2771637.4609705047,
    },
}
TANGENTIAL = {
    "equilibrium": 1291666.6666666667,
    "moduli": [
        2666666.6666666665,
        1396109.889633869,
        1333333.3333333333,
        952470.3901171485,
        533333.3333333334,
        447472.3518279299,
    ],
    "times": [
        0.001,
        0.0012124874136532667,
        0.1,
        0.11192392925540393,
        10.0,
        10.500613583330942,
    ],
    "relaxation": {
        0.0005: 7089078.067348561,
        0.05: 3685704.168696885,
        3.0: 2023040.6434301268,
    },
}


@pytest.mark.parametrize(("tangential", "exact"), [(False, NORMAL), (True, TANGENTIAL)])
def test_constant_bulk_modulus(tangential, exact):
    law = em.half_space(em.Prony(*SHEAR, bulk=BULK), tangential=tangential)
    for name in ("equilibrium", "moduli", "times"):
        np.testing.assert_allclose(getattr(law, name), exact[name], rtol=1e-10)
    for t, value in exact["relaxation"].items():
        np.testing.assert_allclose(law.relaxation(t), value, rtol=1e-10)


def test_complex_modulus_at_5_hz():
    law = em.half_space(em.Prony(*SHEAR, bulk=BULK))
    np.testing.assert_allclose(
        law.storage(2 * np.pi * 5), 5502719.623067728, rtol=1e-10
    )
    np.testing.assert_allclose(law.loss(2 * np.pi * 5), 832968.3422743441, rtol=1e-10)


def test_two_viscoelastic_bodies_in_series():
    # G = E*(1 - nu)/2 turns the given E* series into incompressible materials.
    first = em.Prony(0.25, [0.75], [1.0])
    second = em.Prony(0.5, [1.25, 1.0], [0.2, 7.0])
    law = em.half_space(first, second)
    np.testing.assert_allclose(law.equilibrium, 2 / 3, rtol=1e-10)
    np.testing.assert_allclose(
        law.moduli,
        [0.6933929163732565, 1.4382077970334346, 0.1350659532599756],
        rtol=1e-10,
    )
    np.testing.assert_allclose(
        law.times,
        [0.2878419479695209, 1.4170378501318381, 17.161786868565308],
        rtol=1e-10,
    )
    exact = [2.631051657303218, 1.525710140918546, 0.8098061458014333]
    np.testing.assert_allclose(law.relaxation([0.1, 1.0, 5.0]), exact, rtol=1e-10)


def test_dashpots_in_series():
    """1/E* adds: two dashpots make one; a Kelvin element on a dashpot has i w b (E + i
    w a)/(E + i w (a + b)).
    """
    from elastomdr.material.relaxation import Relaxation, series

    def body(modulus, viscosity):
        return Relaxation(
            np.array(modulus), np.zeros(0), np.zeros(0), np.array(viscosity)
        )

    both = series(body(0.0, 3.0), body(0.0, 6.0))
    np.testing.assert_allclose(
        [both.viscosity, both.equilibrium], [2.0, 0.0], rtol=1e-14
    )
    law, w = series(body(5.0, 3.0), body(0.0, 6.0)), np.array([0.01, 1.0, 100.0])
    exact = 6j * w * (5 + 3j * w) / (5 + 9j * w)
    np.testing.assert_allclose(law.complex_modulus(w), exact, rtol=1e-12)


def test_creep_compliance_of_three_branches():
    # J(t) from the depth of a sphere under a step load: a^3 = (3/4) R F_0 J(t), the
    # radii computed independently.
    law = em.Foundation(0.5, [2.0, 1.0, 0.4], [1e-3, 0.1, 10.0])
    radius = {
        0.0: 0.19740230337485712,
        0.01: 0.2539288759867057,
        1.0: 0.3248960717071863,
        50.0: 0.3877476073763103,
    }
    for t, a in radius.items():
        np.testing.assert_allclose(
            law.creep_compliance(t), a**3 / (0.75 * 2.0 * 0.02), rtol=1e-9
        )


@pytest.mark.parametrize("equilibrium", [1e5, 0.0])
@pytest.mark.parametrize(("branches", "decades"), [(40, 20), (60, 24), (1, 0)])
def test_radok_is_stable_over_many_decades(equilibrium, branches, decades):
    rng = np.random.default_rng(branches)
    times = np.sort(10 ** rng.uniform(-decades / 2, decades / 2, branches))
    material = em.Prony(equilibrium, 10 ** rng.uniform(2, 8, branches), times, bulk=1e9)
    omega = np.logspace(-decades / 2, decades / 2, 60)
    g = material.complex_modulus(omega)
    law = em.half_space(material)
    assert law.moduli.size == 2 * branches
    assert (law.moduli >= 0).all()
    assert (np.diff(law.times) >= 0).all()
    exact = 4 * g * (3e9 + g) / (3e9 + 4 * g)
    np.testing.assert_allclose(law.storage(omega), exact.real, rtol=1e-12)
    np.testing.assert_allclose(law.loss(omega), exact.imag, rtol=1e-12)


def test_nearly_equal_times():
    times = np.array([1.0, 1.0 + 1e-14, 1.0 + 1e-7, 2.0])
    material = em.Prony(1e5, np.full(4, 1e6), times, bulk=1e7)
    law, omega = em.half_space(material), np.logspace(-3, 3, 13)
    g = material.complex_modulus(omega)
    np.testing.assert_allclose(
        law.complex_modulus(omega), 4 * g * (3e7 + g) / (3e7 + 4 * g), rtol=1e-12
    )


@pytest.mark.parametrize("viscosity", [0.0, 3e2])
@pytest.mark.parametrize("equilibrium", [1e5, 0.0])
def test_creep_is_the_inverse_of_relaxation(equilibrium, viscosity):
    # E(s) J(s) = 1 with s-multiplied Laplace transforms, taken from the two series' own
    # sums.
    law = em.Foundation(equilibrium, [1e6, 3e6], [1e-3, 1.0], viscosity)
    s = np.logspace(-4, 5, 10)
    relaxing = (
        equilibrium
        + viscosity * s
        + sum(e * s / (s + 1 / t) for e, t in ((1e6, 1e-3), (3e6, 1.0)))
    )
    t = np.logspace(-12, 8, 40001)
    creep = law.creep_compliance(t)
    for rate, value in zip(s, relaxing, strict=True):
        transform = np.trapezoid(rate * t * np.exp(-rate * t) * creep, np.log(t))
        # the trapezoid's own error
        np.testing.assert_allclose(transform * value, 1.0, rtol=1e-5)


def test_elastic_half_spaces_and_layers():
    elastic = em.Prony(5e6, [], [], kind="tensile", poisson=0.45)
    shear = 5e6 / (2 * 1.45)
    np.testing.assert_allclose(
        em.half_space(elastic).equilibrium, 5e6 / (1 - 0.45**2), rtol=1e-12
    )
    np.testing.assert_allclose(
        em.half_space(elastic, tangential=True).equilibrium,
        4 * shear / 1.55,
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        em.springs(elastic, 1e-3).equilibrium, 18965517241.37931, rtol=1e-10
    )
    np.testing.assert_allclose(
        em.springs(elastic, 1e-3, bonded=False).equilibrium,
        6269592476.489028,
        rtol=1e-10,
    )
    bulk = 5e6 / (3 * (1 - 0.9))
    same = em.Prony(5e6, [], [], kind="tensile", bulk=bulk)
    np.testing.assert_allclose(
        em.springs(same, 1e-3).equilibrium, 18965517241.37931, rtol=1e-10
    )
    np.testing.assert_allclose(
        em.half_space(same).equilibrium, em.half_space(elastic).equilibrium, rtol=1e-10
    )


def test_tensile_moduli_with_a_bulk_modulus():
    material = em.Prony(1e6, [3e6], [0.1], kind="tensile", bulk=1e7)
    omega = np.logspace(-1, 3, 9)
    x = 1j * omega * 0.1
    tensile = 1e6 + 3e6 * x / (1 + x)
    np.testing.assert_allclose(material.complex_modulus(omega), tensile, rtol=1e-12)
    np.testing.assert_allclose(
        material.shear().complex_modulus(omega),
        3e7 * tensile / (9e7 - tensile),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        material.shear().tensile().complex_modulus(omega), tensile, rtol=1e-12
    )


@pytest.mark.parametrize(
    "bulk",
    [{}, {"poisson": 0.4}, {"bulk": 1e8}],
    ids=["incompressible", "poisson", "bulk"],
)
def test_a_material_speaks_in_the_kind_it_was_given_in(bulk):
    t, omega = np.logspace(-3, 3, 7), np.logspace(-3, 3, 7)
    tensile = em.Prony(
        1e6,
        [5e5, 2e6],
        [1e-3, 10.0],
        kind="tensile",
        shift=em.WLF(8.86, 101.6, 300.0),
        **bulk,
    )
    assert (tensile.kind, tensile.equilibrium, tensile.instantaneous) == (
        "tensile",
        1e6,
        3.5e6,
    )
    np.testing.assert_allclose(tensile.relaxation(0.0), 3.5e6)
    np.testing.assert_allclose(tensile.creep_compliance(0.0), 1 / 3.5e6)
    np.testing.assert_allclose(tensile.creep_compliance(1e9), 1e-6)
    shear = tensile.shear()
    assert (shear.kind, shear.tensile().kind) == ("shear", "tensile")
    poisson = bulk.get("poisson", 0.5)
    if "bulk" not in bulk:
        np.testing.assert_allclose(
            2 * (1 + poisson) * shear.storage(omega), tensile.storage(omega), rtol=1e-12
        )
    else:
        np.testing.assert_allclose(
            1 / (3 * shear.equilibrium) + 1 / 9e8, 1e-6, rtol=1e-12
        )
    back = shear.tensile()
    np.testing.assert_allclose(back.relaxation(t), tensile.relaxation(t), rtol=1e-11)
    np.testing.assert_allclose(
        shear.at(320.0).loss(omega), tensile.at(320.0).shear().loss(omega), rtol=1e-11
    )
    one, two = em.half_space(tensile), em.half_space(shear)
    np.testing.assert_allclose(
        one.complex_modulus(omega), two.complex_modulus(omega), rtol=1e-11
    )


def test_a_dashpot_beside_a_shear_modulus_is_a_branch_in_tension_of_a_compressible_solid():
    shear = em.KelvinVoigt(1e6, 1e3, bulk=1e8)
    omega = np.logspace(1, 6, 6)
    g = 1e6 + 1e3j * omega
    np.testing.assert_allclose(
        shear.tensile().complex_modulus(omega), 9e8 * g / (3e8 + g), rtol=1e-11
    )


def test_named_materials():
    assert em.Maxwell(1e6, 0.1).relaxation(0.1) == pytest.approx(1e6 / np.e)
    assert em.KelvinVoigt(1e6, 1e3).loss(10.0) == pytest.approx(1e4)
    assert em.KelvinVoigt(2e6, 1e3).creep_compliance(2e-3) == pytest.approx(
        (1 - np.exp(-4)) / 2e6, rel=1e-12
    )
    assert em.StandardSolid(1e6, 2e6, 0.1).storage(10.0) == pytest.approx(2e6)
    assert em.Maxwell(1e6, 0.1).creep_compliance(0.3) == pytest.approx(4e-6)
    assert (
        repr(em.WLF(8.86, 101.6, 298.15)) == "WLF(c1=8.86, c2=101.6, reference=298.15)"
    )
    assert repr(em.Sphere(5e-3)) == "Sphere(radius=0.005)"
    assert "4e+06 Pa relaxed" in repr(em.half_space(em.StandardSolid(1e6, 1e6, 0.1)))
    assert "2e+06 Pa" in repr(em.StandardSolid(1e6, 1e6, 0.1, name="rubber"))
    assert "viscosity 1000 Pa s" in repr(em.KelvinVoigt(1e6, 1e3))
    batch = jax.tree.map(lambda x: np.stack([x, x]), em.StandardSolid(1e6, 1e6, 0.1))
    assert "a batch of shape (2,)" in repr(batch)


def test_shift_laws():
    wlf = em.WLF(8.86, 101.6, 243.15)
    np.testing.assert_allclose(wlf.a(320.0), 0.00015290292827224386, rtol=1e-10)
    moved = wlf.at_reference(298.15)
    np.testing.assert_allclose(
        [moved.c1, moved.c2], [5.748250319284802, 156.6], rtol=1e-10
    )
    vft = em.VFT(2072.731838671008, 141.55, 243.15)
    np.testing.assert_allclose(vft.a(320.0), wlf.a(320.0), rtol=1e-12)
    same = vft.to_wlf()
    np.testing.assert_allclose([same.c1, same.c2], [8.86, 101.6], rtol=1e-12)
    for law in (wlf, vft):
        energy = law.activation_energy(320.0)
        np.testing.assert_allclose(energy, 55417.14599017189, rtol=1e-10)
    np.testing.assert_allclose(moved.a(298.15), 1.0, rtol=1e-12)


def test_arrhenius():
    law = em.Arrhenius(80e3, 298.15)
    expected = np.exp(80e3 / 8.31446261815324 * (1 / 310.0 - 1 / 298.15))
    np.testing.assert_allclose(law.a(310.0), expected, rtol=1e-12)
    np.testing.assert_allclose(law.activation_energy([290.0, 310.0]), 80e3, rtol=1e-12)


def test_shift_table_passes_through_its_points():
    temperature, log10_a = (
        np.array([280.0, 290.0, 300.0, 320.0]),
        np.array([1.5, 0.6, 0.0, -0.8]),
    )
    table = em.ShiftTable(temperature, log10_a)
    np.testing.assert_allclose(table.log10_a(temperature), log10_a, atol=1e-14)
    assert (np.diff(table.log10_a(np.linspace(280, 320, 100))) < 0).all()
    assert table.reference == pytest.approx(300.0)


def test_at_a_temperature():
    material = em.Prony(
        1e5, [1e6], [1e-2], viscosity=5.0, shift=em.WLF(8.86, 101.6, 293.15)
    )
    warm, factor = material.at(313.15), material.shift.a(313.15)
    np.testing.assert_allclose(warm.times, 1e-2 * factor)
    np.testing.assert_allclose(warm.viscosity, 5.0 * factor)
    with refused("temperature", 300.0, "shift="):
        warm.at(300.0)


def test_gradients_of_the_functional_equations():
    def relaxation(modulus, time):
        return em.half_space(
            em.Prony(5e5, [modulus, 1e6], [time, 0.1], bulk=BULK)
        ).relaxation(2e-3)

    with jax.enable_x64(True):
        by_modulus, by_time = jax.jit(jax.grad(relaxation, argnums=(0, 1)))(2e6, 1e-3)
        forward = jax.jit(jax.jacfwd(relaxation))(2e6, 1e-3)
    np.testing.assert_allclose(by_modulus, forward, rtol=1e-10)
    h = 1e-5
    for got, move in (
        (float(by_modulus) * 2e6, lambda s: relaxation(2e6 * (1 + s), 1e-3)),
        (float(by_time) * 1e-3, lambda s: relaxation(2e6, 1e-3 * (1 + s))),
    ):
        np.testing.assert_allclose(got, (move(h) - move(-h)) / (2 * h), rtol=1e-7)


def test_moduli_do_not_depend_on_the_frequencies_beside_them():
    """Many frequencies are summed in blocks: the bits are those of each alone."""
    tread = em.load_material("tread-passenger-synthetic")
    omega = np.geomspace(1e-8, 1e12, 3000).reshape(50, 60)
    whole = tread.complex_modulus(omega)
    for row in (0, 7, 49):
        for column in (0, 13, 59):
            alone = tread.complex_modulus(omega[row, column])
            assert alone == whole[row, column]
