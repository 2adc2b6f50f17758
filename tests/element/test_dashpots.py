"""Every verb on rubber with a parallel dashpot, against closed forms and against an
integration from event to event.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

import elastomdr as em
from elastomdr.material.relaxation import Relaxation
from elastomdr.rough.periodic import Job, solve_line

from .kinks import under_a_cosine

E, ETA, R = 1e6, 2e3, 0.01  # [Pa, Pa s, m]
SOFT, BALL = em.Foundation.kelvin(E, ETA), em.Paraboloid(R)
SPEED = np.array([0.01, 0.3, 10.0, 1e3])


def ball(a, velocity, stiff=E, eta=ETA):
    """Normal and friction force of a paraboloid whose contact leads by a (Kelvin-Voigt
    line).
    """
    s = velocity * eta / stiff
    p = np.sqrt(a**2 + s**2) - s
    normal = 2 * stiff / (3 * R) * (a**3 + (a**2 + s**2) ** 1.5 - s**3)
    return normal, 2 * stiff / R**2 * (2 / 3 * s * (a**3 + p**3) + s**2 * p**2)


def ball_mu(load, velocity):
    a = brentq(lambda a: ball(a, velocity)[0] / load - 1, 1e-9, 1.0, xtol=1e-15)
    return ball(a, velocity)[1] / load


def test_friction_and_rolling_of_a_ball():
    depth, load = 1e-4, 2.0
    a = np.sqrt(depth * R)
    found = em.friction(SOFT, BALL, velocity=SPEED, depth=depth, model=em.Line())
    exact = np.array([ball(a, v) for v in SPEED[:3]]).T
    np.testing.assert_allclose(
        [found.normal_force[:3], found.friction_force[:3]], exact, rtol=1e-6
    )
    mu = [ball_mu(load, v) for v in SPEED[:3]]
    found = em.friction(SOFT, BALL, velocity=SPEED[:3], load=load, model=em.Line())
    np.testing.assert_allclose(found.mu, mu, rtol=1e-6)
    np.testing.assert_allclose(
        em.rolling(SOFT, BALL, velocity=SPEED[:3], load=load, model="line").coefficient,
        mu,
        1e-6,
    )
    # The average over directions, at the same load.
    x, weight = np.polynomial.legendre.leggauss(40)
    phi = np.pi / 4 * (x + 1)
    mean = [
        weight / 2 @ [np.cos(p) * ball_mu(load, v * np.cos(p)) for p in phi]
        for v in SPEED[:3]
    ]
    found = em.friction(
        SOFT, BALL, velocity=SPEED[:3], load=load, model=em.Averaged(corrected=False)
    )
    np.testing.assert_allclose(found.mu, mean, rtol=1e-5)
    # All of it is lost in the dashpot.
    lost = em.dissipation(SOFT, BALL, velocity=0.3, load=load, model="line")
    np.testing.assert_allclose(
        lost.resistance.sum(), load * ball_mu(load, 0.3), rtol=1e-6
    )
    assert lost.time.tolist() == [0.0]


def test_friction_of_a_cone():
    """mu/c = 2 z sqrt(1 - z^2/2) - z^2/2 up to z = sqrt(2/3), then 1, with z = v eta/E
    sqrt(E c/F_N).
    """
    slope, load = 0.1, 2.0
    c = np.pi / 2 * slope
    z = SPEED * ETA / E * np.sqrt(E * c / load)
    early = 2 * z * np.sqrt(np.maximum(1 - z**2 / 2, 0)) - z**2 / 2
    found = em.friction(
        SOFT, em.Cone(slope), velocity=SPEED, load=load, model=em.Line()
    )
    np.testing.assert_allclose(
        found.mu, c * np.where(z < np.sqrt(2 / 3), early, 1.0), rtol=1e-6
    )


def test_indentation():
    """By depth, in and out: E A(d) + eta dA/dt while it grows; out where q > 0. By
    load: Lee and Radok.
    """
    t, top = np.linspace(0, 2, 41), 1e-4
    soft = em.Foundation.kelvin(E, 0.2 * E)
    found = em.indent(soft, BALL, time=t, depth=top * np.minimum(t, 2 - t))
    grow = (t > 0) & (t <= 1)
    d = top * t[grow]
    force = 4 / 3 * E * np.sqrt(R) * d**1.5 + 0.2 * E * 2 * np.sqrt(R * d) * top
    np.testing.assert_allclose(found.force[grow], force, rtol=1e-9)
    # w' = -top, and E w + eta w' > 0
    kept = np.maximum(top * (2 - t[t > 1]) - 0.2 * top, 0.0)
    np.testing.assert_allclose(
        found.force[t > 1], 4 / 3 * E * np.sqrt(R) * kept**1.5, rtol=1e-8, atol=1e-9
    )
    found = em.indent(soft, BALL, time=t, load=np.full(41, 0.5))
    depth = (0.5 * 0.75 / (E * np.sqrt(R)) * -np.expm1(-t / 0.2)) ** (2 / 3)
    np.testing.assert_allclose(found.depth, depth, rtol=1e-8, atol=1e-15)
    with pytest.raises(em.InputError, match="dashpot"):
        em.indent(soft, BALL, time=t, depth=np.full(41, top))


def test_indentation_of_a_layer():
    """nu = 1/2: the operator of the layer does not depend on time, so the force is that
    of the elastic one, in time.
    """
    d, top = np.linspace(0, 1, 6), 2e-4
    solid, damped = (
        em.Prony(E / 4, [], []),
        em.Prony(E / 4, [], [], viscosity=0.2 * E / 4),
    )
    near = np.sort(np.concatenate([d[1:] - 1e-4, d[1:], d[1:] + 1e-4]))
    static = em.indent(
        em.layer(solid, 2e-3), BALL, time=near, depth=top * near
    ).force.reshape(-1, 3)
    found = em.indent(em.layer(damped, 2e-3), BALL, time=d, depth=top * d)
    force = static[:, 1] + 0.2 * (static[:, 2] - static[:, 0]) / 2e-4
    np.testing.assert_allclose(found.force[1:], force, rtol=1e-6)


@pytest.mark.slow
def test_sliding_histories_end_in_steady_sliding():
    depth, velocity = 1e-4, 0.3
    t = np.array([0.0, 0.01, 0.02, 0.03])
    down = np.minimum(t / 0.01, 1.0)
    normal, along = ball(np.sqrt(depth * R), velocity)
    found = em.slide(SOFT, BALL, time=t, position=velocity * t, depth=depth * down)
    np.testing.assert_allclose(
        [found.normal_force[-1], found.mu[-1]], [normal, along / normal], rtol=2e-3
    )
    found = em.drive(SOFT, BALL, time=t, position=velocity * t, load=normal * down)
    np.testing.assert_allclose(
        [found.depth[-1], found.mu[-1]], [depth, along / normal], rtol=1e-2
    )


def test_shear_and_traction_without_slip():
    """A dashpot along the surface adds eta times the rate: 2 a (G u + eta u'), and int
    G xi (a - x) + eta xi v.
    """
    a, shear, along = 1e-3, 2 / 3 * E, 500.0
    hard, side = em.Foundation(E, [], []), em.Foundation.kelvin(shear, along)
    t = np.linspace(0, 1, 11)
    scene = {
        "time": t,
        "depth": a**2 / R * np.minimum(1.0, 10 * t),
        "friction": 1e6,
        "tangential": side,
    }
    moved = 1e-6 * np.maximum(t - 0.1, 0.0)  # when it has come down
    found = em.shear(hard, BALL, displacement=moved, **scene)
    np.testing.assert_allclose(
        found.force[2:], 2 * a * (shear * moved + along * 1e-6)[2:], rtol=1e-9
    )
    found = em.traction(
        hard,
        BALL,
        velocity=SPEED,
        creepage=1e-3,
        depth=a**2 / R,
        friction=1e6,
        tangential=side,
        model="line",
    )
    np.testing.assert_allclose(
        found.force, 1e-3 * (2 * shear * a**2 + 2 * along * SPEED * a), rtol=1e-4
    )


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_a_surface_in_full_contact():
    """mu = pi eta v/(2 p) int q^4 C dq: the half-space, Multiscale and Persson's theory
    are all exact there.
    """
    surface = em.SelfAffine(0.8, rms_slope=0.1, q_low=1e3, q_high=8e3)
    q = np.geomspace(1e3, 8e3, 4001)
    c = q ** (-2 * 0.8 - 2)
    c *= 0.01 / (2 * np.pi * np.trapezoid(q**4 * c, np.log(q)))
    mu = np.pi * 2.0 * 0.3 / (2 * 1e9) * np.trapezoid(q**5 * c, np.log(q))
    for model, rtol in (
        (em.Multiscale(), 1e-4),
        (em.Persson(), 1e-4),
        (em.HalfSpace(cells=128), 0.1),
    ):
        found = em.friction(
            em.Foundation.kelvin(1e6, 2.0),
            surface,
            velocity=0.3,
            pressure=1e9,
            model=model,
        )
        np.testing.assert_allclose(found.mu, mu, rtol=rtol)


def test_a_pressed_surface():
    """A contact that grows: at t it is that of an elastic one under p (1 - exp(-E
    t/eta)) (Lee and Radok).
    """
    surface = em.SelfAffine(0.8, rms_slope=0.1, q_low=1e3, q_high=8e3)
    solid, damped = (
        em.Prony(E / 4, [], []),
        em.Prony(E / 4, [], [], viscosity=0.2 * E / 4),
    )
    t = np.array([0.1, 0.4, 1.0])
    found = em.press(damped, surface, pressure=2e4, time=t, model=em.Line(samples=4096))
    static = em.press(
        solid, surface, pressure=-2e4 * np.expm1(-t / 0.2), model=em.Line(samples=4096)
    )
    np.testing.assert_allclose(found.approach, static.approach, rtol=1e-4)


def test_a_ball_on_a_layer_is_refused():
    with pytest.raises(em.InputError, match="dashpot"):
        em.friction(
            em.layer(em.Prony(E / 4, [], [], viscosity=100.0), 2e-3),
            BALL,
            velocity=0.1,
            load=1.0,
        )


CASES = {
    "dashpot": (1e6, [], [], 1e3),
    "branch and dashpot": (1e6, [1e7], [1e-4], 1e2),
    "a branch about as short as a sample": (1e6, [1e10], [1e-7], 0.0),
    "a branch forgotten within a sample": (1e6, [1e11], [1e-8], 0.0),
}


@pytest.mark.parametrize("case", CASES)
def test_order_of_a_rough_line(case):
    """Light contact with a cosine: within 3e-6 at 4096 samples, of second order, and
    covered by the error.
    """
    k, height, velocity = 1e3, 1e-5, np.array([1.0, 3.0, 10.0, 30.0])
    stiff, moduli, times, eta = CASES[case]
    mu, load = np.transpose(
        [under_a_cosine(*CASES[case], k, height, v, height) for v in velocity]
    )
    law, wrong = Relaxation(*map(np.asarray, (stiff, moduli, times, eta))), []
    for n in (1024, 4096, 16384):
        x = np.arange(n) * 2 * np.pi / k / n
        heights, depth = height * np.cos(k * x), np.full(4, height)
        found = solve_line(Job(heights, x[1], velocity, depth, "depth"), law)
        assert (np.abs(found.mu - mu) <= found.error).all()
        np.testing.assert_allclose(found.load, load, rtol=4e-6 * (1024 / n) ** 1.5)
        wrong.append(np.abs(found.mu / mu - 1).max())
    assert wrong[1] < 3e-6
    assert np.polyfit(np.log([1, 4, 16]), np.log(wrong), 1)[0] < -1.7
