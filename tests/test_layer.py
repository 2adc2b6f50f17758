"""Rubber of finite thickness: its kernel, and a cylinder that rolls on it, against exact solutions and limits."""

import numpy as np
import pytest

import elastomdr as em

THREE = ([0.8e6, 0.4e6, 0.2e6], [1e-4, 1e-3, 1e-2])


def rubber(**kind):
    return em.Prony(0.4e6, *THREE, **kind)


# Chebyshev collocation of 96 terms and, independently, cells with an FFT and an active set of 1,300 to 1,900 cells.
EXACT = {
    "bonded": (rubber(), True, 1.0, 2e3, (0.016711222112096743, 0.005620547081781458, 0.004586806573432547,
               0.00027438613842211237)),
    "fast": (rubber(), True, 10.0, 2e3, (0.015279295041220602, 0.004656177529453481, 0.0036699873438980164,
             0.00020181130143389118)),
    "thick": (rubber(), True, 1.0, 1e2, (0.006705800224650994, 0.0015080658453384631, 0.0010320241474637746,
              3.703060629840817e-05)),
    "slips": (rubber(), False, 1.0, 5e4, (0.05503275833852542, 0.02229889764409819, 0.018848661125922386,
              0.005457684240014849)),
    "bulk": (rubber(bulk=1e8), True, 1.0, 5e4, (0.03398093648284591, 0.016291890102668547, 0.014243928616658283,
             0.0016040238587037674)),
}  # fmt: skip


@pytest.mark.parametrize("case", EXACT)
def test_cylinder_on_a_layer(case):
    material, bonded, velocity, load, expected = EXACT[case]
    layer = em.layer(material, 0.006, bonded=bonded)
    curve = em.rolling(layer, em.Cylinder(0.05, 0.5), velocity=velocity, load=0.5 * load)
    got = curve.coefficient, curve.contact.leading, curve.contact.trailing, curve.depth
    np.testing.assert_allclose(got, expected, rtol=1e-7)
    assert abs(curve.coefficient - expected[0]) <= curve.error
    by_depth = em.friction(layer, em.Cylinder(0.05, 0.5), velocity=velocity, depth=expected[3])
    np.testing.assert_allclose([by_depth.mu, by_depth.normal_force / 0.5], [expected[0], load], rtol=1e-7)


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
        [curve.mu, curve.contact.leading, curve.contact.trailing], [mu, leading, trailing], rtol=1e-8
    )
    assert np.isnan(curve.depth) == (thickness is None)
