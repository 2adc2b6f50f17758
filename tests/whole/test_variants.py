"""Random scenes of each kind with a closed form: the public call against the formula,
evaluated here.
"""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import dawsn

import elastomdr as em

DRAWS = 3


def spread(rng, low, high, size=None):
    """Numbers of any size between two limits, evenly in the logarithm."""
    return np.exp(rng.uniform(np.log(low), np.log(high), size))


def rubber(rng):
    return (
        spread(rng, 1e5, 1e7),
        spread(rng, 1e5, 1e8, 3),
        np.sort(spread(rng, 1e-4, 10, 3)),
    )


def creep_step(rng):
    """a^3 = (3/4) R F J(t) on a standard solid, J = 1/E_inf - (1/E_inf - 1/E_0) exp(-t
    E_inf/(E_0 tau)).
    """
    soft, stiff, tau, radius = (
        *spread(rng, 1e5, 1e8, 2),
        spread(rng, 1e-3, 10),
        spread(rng, 1e-3, 1),
    )
    load, time = (
        spread(rng, 1e-6, 1e-3) * soft * radius**2,
        np.append(0, np.sort(spread(rng, 1e-5, 100, 3))),
    )
    glass = soft + stiff
    compliance = 1 / soft - (1 / soft - 1 / glass) * np.exp(
        -time * soft / (glass * tau)
    )
    found = em.indent(
        em.Foundation(soft, [stiff], [tau]), em.Paraboloid(radius), time=time, load=load
    )
    a = np.cbrt(0.75 * radius * load * compliance)
    return (found.contact_radius, a), (found.depth, a**2 / radius)


def ramp(rng):
    """F = 2 v sqrt(R v) [2/3 E_inf t^1.5 + sum E_k (tau sqrt t - tau^1.5
    D(sqrt(t/tau)))], D Dawson's function.
    """
    (soft, moduli, tau), radius, v = (
        rubber(rng),
        spread(rng, 1e-3, 1),
        spread(rng, 1e-6, 1e-2),
    )
    t = min(spread(rng, 1e-3, 10), 0.1 * radius / v)
    found = em.indent(
        em.Foundation(soft, moduli, tau),
        em.Paraboloid(radius),
        time=[0, t / 3, t],
        depth=[0, v * t / 3, v * t],
        rtol=1e-10,
    )
    branches = np.sum(moduli * (tau * np.sqrt(t) - tau**1.5 * dawsn(np.sqrt(t / tau))))
    return [
        (
            found.force[2],
            2 * v * np.sqrt(radius * v) * (2 / 3 * soft * t**1.5 + branches),
        )
    ]


def ting(rng):
    """Contact radius after the turn of a triangle: int_{t1}^t E(t-s) d'(s) ds = 0, a =
    sqrt(R v t1).
    """
    (soft, moduli, tau), radius, turn = (
        rubber(rng),
        spread(rng, 1e-3, 1),
        spread(rng, 1e-3, 10),
    )
    v = spread(rng, 1e-5, 1e-3) * radius / turn
    time = turn * np.array([0, 0.5, 1, 1.02, 1.1, 1.3])

    def response(start, t):  # of a constant rate from `start` to t, at t
        return soft * (t - start) + np.sum(moduli * tau * -np.expm1(-(t - start) / tau))

    edges = []
    for t in time[3:]:
        up = lambda s, t=t: response(s, t) - 2 * response(turn, t)  # noqa: E731
        edges.append(
            np.sqrt(radius * v * brentq(up, 0, turn, xtol=1e-300, rtol=1e-14))
            if up(0) > 0
            else 0.0
        )
    found = em.indent(
        em.Foundation(soft, moduli, tau),
        em.Paraboloid(radius),
        time=time,
        depth=v * np.minimum(time, 2 * turn - time),
    )
    return [
        (
            found.contact_radius[3:] / found.contact_radius[2],
            np.array(edges) / found.contact_radius[2],
        )
    ]


def jkr(rng):
    """F = (4/3) E a^3/R - sqrt(8 pi E gamma a^3), d = a^2/R - sqrt(2 pi a gamma/E); it
    ends at -(3/2) pi gamma R.
    """
    modulus, radius = spread(rng, 1e5, 1e9), spread(rng, 1e-3, 1)
    gamma = modulus * radius * spread(rng, 1e-9, 1e-6)
    least = np.cbrt(9 * np.pi * gamma * radius**2 / (8 * modulus))
    a = least * rng.uniform(1.05, 3)
    force = 4 / 3 * modulus * a**3 / radius - np.sqrt(
        8 * np.pi * modulus * gamma * a**3
    )
    pull = -1.5 * np.pi * gamma * radius
    load = np.array([max(force, 0), force, pull])
    found = em.indent(
        em.Foundation(modulus, [], []),
        em.Paraboloid(radius),
        time=[0, 1, 2],
        load=load,
        adhesion=gamma,
    )
    stretch = np.sqrt(2 * np.pi * a * gamma / modulus)
    return (found.contact_radius[1:], np.array([a, least])), (
        found.depth[1] + stretch,
        a**2 / radius,
    )


def kendall(rng):
    """F = -2 a E sqrt(2 pi a gamma/E)."""
    modulus, a = spread(rng, 1e5, 1e9), spread(rng, 1e-3, 1)
    gamma = modulus * a * spread(rng, 1e-9, 1e-5)
    stretch = np.sqrt(2 * np.pi * a * gamma / modulus)
    depth = stretch * np.array([0, -0.5, -1])
    found = em.indent(
        em.Foundation(modulus, [], []),
        em.FlatPunch(a),
        time=[0, 1, 2],
        depth=depth,
        adhesion=gamma,
    )
    return [(found.force[1:], 2 * a * modulus * depth[1:])]


def brush(rng):
    """F_x = mu F_N [1 - (1 - zeta)^3], zeta = xi R G/(2 a mu E); all slips beyond zeta
    = 1.
    """
    modulus, radius, mu, zeta = (
        spread(rng, 1e5, 1e9),
        spread(rng, 1e-3, 1),
        spread(rng, 0.05, 2),
        rng.uniform(0.01, 1.3),
    )
    shear, a = modulus * rng.uniform(0.6, 1), radius * spread(rng, 0.02, 0.2)
    found = em.traction(
        em.Foundation(modulus, [], []),
        em.Paraboloid(radius),
        velocity=1.0,
        friction=mu,
        depth=a**2 / radius,
        creepage=zeta * 2 * a * mu * modulus / (radius * shear),
        tangential=em.Foundation(shear, [], []),
    )
    return [(found.coefficient, mu * (1 - max(1 - zeta, 0) ** 3))]


def carter(rng):
    """xi = (mu a/R) (1 - sqrt(1 - F_x/(mu F_N))), load pi E a^2 L/(4 R)."""
    modulus, radius, length = spread(rng, 1e5, 1e9), *spread(rng, 1e-3, 1, 2)
    mu, part, a = (
        spread(rng, 0.05, 2),
        rng.uniform(0.02, 0.99),
        radius * spread(rng, 0.02, 0.2),
    )
    found = em.traction(
        em.Prony(modulus / 4, [], []),
        em.Cylinder(radius, length),
        velocity=1.0,
        friction=mu,
        creepage=mu * a / radius * (1 - np.sqrt(1 - part)),
        load=np.pi * modulus * a**2 * length / (4 * radius),
    )
    return [(found.coefficient, mu * part)]


def relaxation_in_shear(rng):
    """F = 2 a G(t) U at a constant depth, nothing slipping: the edge lies between two
    elements.
    """
    (soft, moduli, tau), radius = rubber(rng), spread(rng, 1e-3, 1)
    a, moved = 0.1 * radius, spread(rng, 1e-6, 1e-4) * radius
    time = np.append(0, np.sort(spread(rng, 1e-3, 10, 3)))
    found = em.shear(
        em.Foundation(1e6, [], []),
        em.Paraboloid(radius),
        time=time,
        displacement=moved,
        friction=np.inf,
        depth=a**2 / radius,
        tangential=em.Foundation(soft, moduli, tau),
    )
    return [
        (found.force, 2 * a * moved * (soft + np.exp(-time[:, None] / tau) @ moduli))
    ]


@pytest.mark.parametrize(
    ("kind", "rtol"),
    [
        (creep_step, 1e-12),
        (ramp, 1e-10),
        (ting, 1e-9),
        (jkr, 1e-9),
        (kendall, 1e-12),
        (brush, 1e-12),
        (carter, 1e-12),
        (relaxation_in_shear, 1e-12),
    ],
    ids=lambda x: getattr(x, "__name__", ""),
)
def test_random_scenes(kind, rtol):
    for seed in range(DRAWS):
        for found, expected in kind(np.random.default_rng([seed, 4])):
            np.testing.assert_allclose(
                found, expected, rtol=rtol, atol=rtol * np.abs(expected).max()
            )
