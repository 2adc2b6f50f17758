"""A rubber ball that bounces: the numbers of `test_impact.py` and
`test_impact_extremes.py`.
"""

import math

import elastomdr as em

R, M, V, E = 0.01, 0.02, 1.5, 4e6
DM = (15 * M * V**2 / (16 * E * math.sqrt(R))) ** 0.4  # depth of an elastic impact [m]
BALL = em.Paraboloid(R)


def impact(foundation, **changes):
    return em.impact(foundation, BALL, **{"mass": M, "velocity": V} | changes)


def kelvin_voigt(beta):
    return em.Foundation.kelvin(E, E * beta * DM / V)


# restitution, largest depth over DM, contact time times V/DM: reduced equations,
# integrated by DOP853 to 1e-13
KELVIN_VOIGT = {
    0.01: (0.9813716099400652, 0.9925023731402302, 2.9388713496325383),
    0.1: (0.83640465, None, None),
    0.5: (0.47624092155534664, 0.7392735043912477, 2.7723438100911473),
    2.0: (0.14305466, None, None),
}
