"""Rubber of finite thickness: its kernel, and a cylinder that rolls on it, against
exact solutions and limits.
"""

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused, warned
from .cylinder_on_cells import cylinder_on_cells
from .roller_on_cells import of_bound

THREE = ([0.8e6, 0.4e6, 0.2e6], [1e-4, 1e-3, 1e-2])


def rubber(**kind):
    return em.Prony(0.4e6, *THREE, **kind)


# Chebyshev collocation of 96 terms and, independently, cells with an FFT and an active
# set of 1,300 to 1,900 cells.
EXACT = {
    "bonded": (
        rubber(),
        True,
        1.0,
        2e3,
        (
            0.016711222112096743,
            0.005620547081781458,
            0.004586806573432547,
            0.00027438613842211237,
        ),
    ),
    "fast": (
        rubber(),
        True,
        10.0,
        2e3,
        (
            0.015279295041220602,
            0.004656177529453481,
            0.0036699873438980164,
            0.00020181130143389118,
        ),
    ),
    "thick": (
        rubber(),
        True,
        1.0,
        1e2,
        (
            0.006705800224650994,
            0.0015080658453384631,
            0.0010320241474637746,
            3.703060629840817e-05,
        ),
    ),
    "slips": (
        rubber(),
        False,
        1.0,
        5e4,
        (
            0.05503275833852542,
            0.02229889764409819,
            0.018848661125922386,
            0.005457684240014849,
        ),
    ),
    "bulk": (
        rubber(bulk=1e8),
        True,
        1.0,
        5e4,
        (
            0.03398093648284591,
            0.016291890102668547,
            0.014243928616658283,
            0.0016040238587037674,
        ),
    ),
}


@pytest.mark.parametrize("case", EXACT)
def test_cylinder_on_a_layer(case):
    material, bonded, velocity, load, expected = EXACT[case]
    layer = em.layer(material, 0.006, bonded=bonded)
    curve = em.rolling(
        layer, em.Cylinder(0.05, 0.5), velocity=velocity, load=0.5 * load
    )
    got = curve.coefficient, curve.contact.leading, curve.contact.trailing, curve.depth
    np.testing.assert_allclose(got, expected, rtol=1e-7)
    assert abs(curve.coefficient - expected[0]) <= curve.error
    by_depth = em.friction(
        layer, em.Cylinder(0.05, 0.5), velocity=velocity, depth=expected[3]
    )
    np.testing.assert_allclose(
        [by_depth.mu, by_depth.normal_force / 0.5], [expected[0], load], rtol=1e-7
    )


@pytest.mark.parametrize(
    ("velocity", "mu", "leading", "trailing"),
    [
        (0.05, 0.040127887943461976, 0.002511954564153908, 0.002086623350717033),
        (1.0, 0.0811896667194903, 0.0015935402658255984, 0.00012869848555041363),
        (50.0, 0.0038997155366004388, 0.0008354906088109923, 0.0007603613209416032),
    ],
)
@pytest.mark.parametrize("thickness", [None, 1e6])
def test_half_plane_of_a_standard_solid(velocity, mu, leading, trailing, thickness):
    """Hunter 1961, exact; the half-space, and a layer so thick that it is one."""
    solid = em.StandardSolid(1e6, 9e6, 1e-3)
    body = solid if thickness is None else em.layer(solid, thickness)
    curve = em.friction(body, em.Cylinder(0.01, 1.0), velocity=velocity, load=2e3)
    np.testing.assert_allclose(
        [curve.mu, curve.contact.leading, curve.contact.trailing],
        [mu, leading, trailing],
        rtol=1e-8,
    )
    assert np.isnan(curve.depth) == (thickness is None)


@pytest.mark.parametrize(
    ("contrast", "kind", "bonded"),
    [(4, {}, True), (100, {"poisson": 0.4}, True), (100, {}, False)],
)
def test_against_cells(contrast, kind, bonded):
    """A line of cells with an FFT and an active set, which shares nothing but the
    kernel with the collocation.
    """
    branches = np.array([0.5, 0.4, 0.1]) * (contrast - 1) * 0.4e6
    layer = em.layer(em.Prony(0.4e6, branches, THREE[1], **kind), 0.006, bonded=bonded)
    curve = em.rolling(layer, em.Cylinder(0.05, 1.0), velocity=1.0, load=4e3)
    leading, trailing = float(curve.contact.leading), float(curve.contact.trailing)
    window = (
        -trailing - 0.1 * (leading + trailing),
        leading + 0.1 * (leading + trailing),
    )
    mu, *edges = cylinder_on_cells(layer, 0.05, 1.0, 4e3, window, 240)
    np.testing.assert_allclose(mu, curve.coefficient, rtol=3e-5)
    np.testing.assert_allclose(edges, [leading, trailing], rtol=5e-3)


def test_kernel_tends_to_its_limits():
    """Half-space for short waves, exponentially; Winkler and Reynolds for long ones,
    with a power of kh.
    """
    z = np.array([0.02, 0.04])
    for kind, bonded, limit, power in [
        ({"poisson": 0.4}, True, z * 0.2 / (2 * 0.6**2), 2),
        ({"poisson": 0.5}, True, 2 / 3 * z**3, 2),
        ({"poisson": 0.5}, False, z / 2, 4),
    ]:
        layer = em.layer(em.Prony(1e6, [], [], **kind), 1.0, bonded=bonded)
        off = layer.kernel(z) / limit - 1
        assert abs(off[0]) < 2e-3
        np.testing.assert_allclose(off[1] / off[0], 2**power, rtol=0.02)
        deep = np.array([12.0, 13.0])
        lacks = np.real(layer.deficit(deep, np.ones(2)))
        np.testing.assert_allclose(lacks[1] / lacks[0], np.exp(-2.0), rtol=0.2)


def test_elastic_layer_against_its_thickness():
    """Ratios of load at 2a/h from an independent solution."""
    curve = em.rolling(
        em.layer(em.Prony(1e6, [], []), 0.01),
        em.Cylinder(1.0, 10.0),
        velocity=1.0,
        load=np.array([1.248, 4.048, 18.28])
        * 10
        * np.pi
        / 4
        * 4e6
        * np.array([0.005, 0.02, 0.05]) ** 2,
        rtol=1e-4,
    )
    np.testing.assert_allclose(curve.contact.leading, [0.005, 0.02, 0.05], rtol=2e-4)
    np.testing.assert_allclose(curve.coefficient, 0, atol=1e-12)


def test_thin_layers_that_are_compressible_or_slip_tend_to_springs():
    """The distance falls with about the third power of thickness over width, at least
    with the second.
    """
    for kind, bonded in [({"poisson": 0.4}, True), ({}, False)]:
        off = []
        for thickness in (8e-3, 4e-3, 2e-3):
            cover = em.springs(rubber(**kind), thickness, bonded=bonded)
            half = 0.02  # about the same contact on each
            load = 2 / 3 * half**3 / 5 * float(cover.equilibrium)
            layer = em.layer(rubber(**kind), thickness, bonded=bonded)
            springs, exact = (
                em.rolling(
                    body, em.Cylinder(5.0, 1.0), velocity=1.0, load=load, rtol=1e-4
                ).coefficient
                for body in (cover, layer)
            )
            off.append(float(abs(exact / springs - 1)))
        assert off[2] < 0.002
        assert off[0] > 4 * off[1] > 16 * off[2]


def test_springs_say_how_far_they_are():
    solid, roller = rubber(poisson=0.49), em.Cylinder(0.05, 1.0)
    curve = em.rolling(em.springs(solid, 0.006), roller, velocity=[0.1, 1.0], load=2e3)
    exact = em.rolling(em.layer(solid, 0.006), roller, velocity=[0.1, 1.0], load=2e3)
    apart = abs(curve.coefficient - exact.coefficient)
    np.testing.assert_allclose(curve.model_error, apart + exact.model_error, rtol=1e-3)
    assert (exact.model_error > 0.01 * exact.coefficient).all()
    assert "model error" in curve.summary()
    assert np.isnan(
        em.rolling(
            em.springs(solid, 0.006), em.Sphere(0.05), velocity=1.0, load=10.0
        ).model_error
    )


@pytest.mark.parametrize(
    ("layer", "velocity", "line"),
    [
        (em.layer(rubber(), 6e-3), 1.0, 1e3),
        (em.layer(rubber(), 6e-3), 10.0, 5e4),
        (em.layer(rubber(poisson=0.45), 6e-3), 1.0, 2e4),
        (em.layer(rubber(), 6e-3, bonded=False), 1.0, 1e3),
        (em.layer(em.Prony(1e6, [1e8], [1e-3]), 6e-3), 5.0, 2e5),
    ],
)
def test_ends_of_a_roller_lie_within_their_bound(layer, velocity, line):
    """Against cells in three dimensions, for a short and a longer roller; the bound is
    not many times too wide.
    """
    shares = []
    for length in (0.12, 0.3):
        fine, coarse, bound = of_bound(layer, 0.08, velocity, line, length, 40)
        assert abs(fine) + abs(fine - coarse) < bound
        shares.append(abs(fine) / bound)
    assert max(shares) > 0.03


def test_where_the_ends_of_a_roller_are_not_known():
    solid, roller = rubber(), em.Cylinder(0.08, 0.2)
    soft = em.Softening([1e-3, 0.1], [1.0, 0.5], [1.0, 0.6])

    def known(layer, load, **more):
        run = {"velocity": 1.0, "load": load, **more}
        return np.isfinite(em.rolling(layer, roller, **run).model_error)

    layer = em.layer(solid, 6e-3)
    assert known(layer, 200.0)
    assert not known(layer, None, depth=5e-4)
    assert not known(em.layer(solid, 0.3), 200.0)  # all but a half-space
    assert not known(em.layer(solid, 6e-3, other=layer), 200.0)
    assert not known(em.layer(rubber(bulk=2e9), 6e-3), 200.0)
    assert not known(em.layer(rubber(softening=soft), 6e-3), 200.0)
    assert not known(solid, 200.0)


def test_kelvin_voigt_on_a_half_space():
    """Its pressure is a Hertz ellipse shifted by v eta/E, and a term that is infinite
    at the leading edge.
    """
    e, eta, radius, load = 4e6, 4e3, 0.05, 2e3
    for v in (0.1, 10.0):
        curve = em.friction(
            em.KelvinVoigt(e / 4, eta / 4),
            em.Cylinder(radius, 1.0),
            velocity=v,
            load=load,
        )
        half = (curve.contact.leading + curve.contact.trailing) / 2
        shift = (curve.contact.leading - curve.contact.trailing) / 2
        # without memory the slope and its rate obey (1 - s d/dx) H p = slope: c_0 and
        # the singular term from the load
        s = v * eta / e
        c0 = e * half / (2 * radius)
        singular = load / half / np.pi - c0 / 2
        # H p = -(2/E) (c_0 T_1 - c_s) has to be -(x - s)/R
        np.testing.assert_allclose(2 / e * singular, (s - shift) / radius, rtol=1e-6)
        np.testing.assert_allclose(
            curve.mu,
            (shift + half * (np.pi / 2 * singular) * half / load) / radius,
            rtol=1e-6,
        )


def test_a_table_of_moduli_and_its_series():
    omega = np.logspace(-2, 7, 91)
    modulus = rubber().complex_modulus(omega)
    table = em.TabulatedModulus(
        omega, modulus.real, np.maximum(modulus.imag, 1e-3 * modulus.real)
    )
    roller = em.Cylinder(0.05, 1.0)
    by_table = em.rolling(
        em.layer(table, 0.006), roller, velocity=[0.3, 3.0], load=2e3, rtol=0.05
    )
    by_series = em.rolling(
        em.layer(rubber(), 0.006), roller, velocity=[0.3, 3.0], load=2e3
    )
    assert (abs(by_table.coefficient - by_series.coefficient) < by_table.error).all()
    np.testing.assert_allclose(by_table.coefficient, by_series.coefficient, rtol=0.03)


def test_two_covers():
    """Two equal covers are one of half the modulus; a very stiff one leaves the other
    alone.
    """
    roller, solid = em.Cylinder(0.05, 1.0), rubber()
    both = em.layer(solid, 0.006, other=em.layer(solid, 0.006))
    half = em.layer(em.Prony(0.2e6, np.array(THREE[0]) / 2, THREE[1]), 0.006)
    got, expected = (
        em.rolling(x, roller, velocity=[0.1, 10.0], load=2e3) for x in (both, half)
    )
    np.testing.assert_allclose(got.coefficient, expected.coefficient, rtol=1e-8)
    np.testing.assert_allclose(got.depth, expected.depth, rtol=1e-7)
    stiff = em.layer(solid, 0.006, other=em.layer(em.Prony(1e13, [], []), 0.002))
    got, expected = (
        em.rolling(x, roller, velocity=1.0, load=2e3)
        for x in (stiff, em.layer(solid, 0.006))
    )
    np.testing.assert_allclose(got.coefficient, expected.coefficient, rtol=1e-5)


def test_a_liquid_and_broad_spectra():
    liquid = em.rolling(
        em.layer(em.Maxwell(1e6, 0.01), 0.006),
        em.Cylinder(0.05, 1.0),
        velocity=[1.0, 10.0],
        load=2e3,
    )
    np.testing.assert_allclose(liquid.coefficient, [0.0153929, 0.00154873], rtol=1e-5)
    broad = em.layer(
        em.Prony(4e5, np.logspace(4, 6, 16), np.logspace(-8, 2, 16)), 0.006
    )
    curve = em.rolling(
        broad,
        em.Cylinder(0.05, 1.0),
        velocity=np.logspace(-3, 2, 6),
        load=2e3,
        rtol=1e-5,
    )
    assert curve.converged.all()
    assert (curve.error < 1e-5 * curve.coefficient).all()


def test_materials_temperatures_and_shapes():
    wlf = em.WLF(8.9, 101.6, 293.15)
    solid = rubber(shift=wlf, name="rubber")
    roller = em.Cylinder(0.05, 1.0)
    layers = [em.layer(solid, 0.006), em.layer(solid, 0.003)]
    curve = em.rolling(
        layers,
        roller,
        velocity=[[0.1], [1.0]],
        load=2e3,
        temperature=[283.15, 293.15, 303.15],
    )
    assert curve.coefficient.shape == (2, 2, 3)
    cold = em.rolling(em.layer(solid.at(283.15), 0.006), roller, velocity=0.1, load=2e3)
    np.testing.assert_allclose(curve.coefficient[0, 0, 0], cold.coefficient, rtol=1e-9)
    assert "bonded to a rigid base" in str(
        em.plan(layers[0], roller, velocity=1.0, load=2e3)
    )


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda: em.layer(rubber(), 0.0), ("thickness", "positive")),
        (lambda: em.layer("rubber", 0.01), ("material",)),
        (lambda: em.layer(rubber(), 0.01, other=0.01), ("other", "em.layer")),
        (
            lambda: em.rolling(
                em.layer(rubber(), 6e-3), em.Cylinder(1, 1), velocity=1, depth=6e-3
            ),
            ("depth", 0.006),
        ),
        (
            lambda: em.rolling(rubber(), em.Cylinder(0.05, 1), velocity=1, depth=1e-3),
            ("depth", "left out"),
        ),
        (
            lambda: em.rolling(
                em.Maxwell(1e6, 1), em.Cylinder(0.05, 1), velocity=1, load=1
            ),
            ("material", "equilibrium modulus"),
        ),
        (lambda: em.springs(rubber(), 6e-3), ("poisson", "em.layer")),
    ],
)
def test_bad_input(call, text):
    with refused(*text):
        call()


def test_what_is_said():
    with warned(em.ConvergenceWarning, "deeper than the layer"):
        curve = em.rolling(
            em.layer(rubber(), 1e-3, bonded=False),
            em.Cylinder(0.05, 1.0),
            velocity=1.0,
            load=5e4,
        )
    assert np.isnan(curve.coefficient)
    assert not curve.converged
    with warned(em.ModelWarning, "half the contact"):
        em.rolling(
            em.layer(rubber(), 6e-3), em.Cylinder(0.05, 0.01), velocity=1.0, load=50.0
        )


@pytest.mark.slow
def test_gradient_against_differences():
    jax = pytest.importorskip("jax")
    where = np.array([0.006, 4e5, 8e5, 0.05, 2000.0, 1.0])

    def coefficient(x):
        thickness, relaxed, branch, radius, load, velocity = x
        solid = em.Prony(relaxed, [branch, 4e5], [1e-4, 1e-2])
        layer, roller = em.layer(solid, thickness), em.Cylinder(radius, 1.0)
        return em.rolling(
            layer, roller, velocity=velocity, load=load, rtol=1e-5
        ).coefficient

    with jax.enable_x64(True):
        got = jax.jit(jax.grad(coefficient))(where)
    for i, x in enumerate(where):
        step = np.zeros(6)
        step[i] = 1e-3 * x
        difference = (
            8 * (coefficient(where + step) - coefficient(where - step))
            - (coefficient(where + 2 * step) - coefficient(where - 2 * step))
        ) / (12e-3 * x)
        np.testing.assert_allclose(got[i], difference, rtol=1e-7)


def test_a_branch_much_shorter_than_the_passage_carries_the_load():
    """Few terms know little of such a contact: the load was missed by 7 %. By cells of
    `half_plane_sliding`, 0.2 um.
    """
    short = em.half_space(em.Prony(2.5e5, [1e9], [1e-7]))
    curve = em.friction(short, em.Cylinder(0.01, 0.1), velocity=10.0, load=10.0)
    np.testing.assert_allclose(curve.normal_force, 10.0, rtol=1e-8)
    np.testing.assert_allclose(curve.mu, 0.05892, atol=2e-4)


def test_a_load_that_presses_the_layer_through_is_no_number_and_costs_no_time():
    """The other points of the call stand."""
    rubber = em.layer(em.Prony(1e6, [4e6, 2e6], [0.3, 0.01]), 2e-3)
    with pytest.warns(em.ConvergenceWarning, match="1 of 2"):
        found = em.friction(
            rubber, em.Cylinder(0.05, 0.1), velocity=0.2, load=[1e30, 100.0]
        )
    assert found.converged.tolist() == [False, True]
    assert np.isnan(found.mu[0])
    alone = em.friction(rubber, em.Cylinder(0.05, 0.1), velocity=0.2, load=100.0)
    np.testing.assert_allclose(found.mu[1], alone.mu, rtol=1e-6)
