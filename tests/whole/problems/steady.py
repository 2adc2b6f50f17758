"""Steady sliding and rolling with closed-form answers: (name, call, expected fields,
relative tolerance).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import elastomdr as em


class Problem(NamedTuple):
    name: str
    solve: Callable[..., Any]  # keyword arguments are passed on to the call
    expected: dict[str, float]
    rtol: float


def _kelvin_voigt(eta: float = 0.02) -> em.Foundation:
    return em.Foundation.kelvin(1.0, eta)


def _solid() -> em.Foundation:
    return em.Foundation(4e6, [12e6], [1e-3])


def _idler(**options: Any) -> Any:
    belt = em.Foundation(7e6 / 0.008, [250e6 / 0.008], [1875 / 250e6])
    return em.rolling(
        belt, em.Cylinder(0.159 / 2, 1.0), velocity=5.2, load=2000.0, **options
    )


PROBLEMS = [
    Problem(
        "Kelvin-Voigt paraboloid at a depth",
        lambda **k: em.friction(
            _kelvin_voigt(),
            em.Paraboloid(1.0),
            velocity=0.5,
            depth=4e-4,
            **{"model": em.Line(), **k},
        ),
        {
            "normal_force": 1.2120226591665965e-05,
            "friction_force": 1.6240453183331932e-07,
            "mu": 0.013399463335527976,
            "leading": 0.02,
            "trailing": 0.012360679774997897,
        },
        1e-9,
    ),
    Problem(
        "Kelvin-Voigt paraboloid at a load",
        lambda **k: em.friction(
            _kelvin_voigt(),
            em.Paraboloid(1.0),
            velocity=1.0,
            load=1e-4,
            **{"model": em.Line(), **k},
        ),
        {
            "mu": 0.026914531367677307,
            "depth": 0.0016356835790403367,
            "leading": 0.040443585140790085,
            "trailing": 0.02511855027635902,
        },
        1e-9,
    ),
    Problem(
        "Kelvin-Voigt cone at a load",
        lambda **k: em.friction(
            _kelvin_voigt(),
            em.Cone(np.tan(0.2)),
            velocity=1.0,
            load=1e-3,
            **{"model": em.Line(), **k},
        ),
        {"mu": 0.19964190035938026, "depth": 0.01726668487430574},
        1e-9,
    ),
    Problem(
        "standard solid paraboloid at a load",
        lambda **k: em.friction(
            _solid(),
            em.Paraboloid(0.01),
            velocity=1.0,
            load=10.0,
            **{"model": em.Line(), **k},
        ),
        {
            "mu": 0.10866233408272157,
            "depth": 0.000491282325759344,
            "leading": 0.0022164889482227156,
            "trailing": 0.0014041185336033906,
        },
        1e-8,
    ),
    Problem(
        "Maxwell paraboloid at a depth",
        lambda **k: em.friction(
            em.Foundation.maxwell(12e6, 1e-3),
            em.Paraboloid(0.01),
            velocity=1.0,
            depth=1e-4,
            **{"model": em.Line(), **k},
        ),
        {
            "normal_force": 0.7771322854702978,
            "friction_force": 0.03804348079027608,
            "mu": 0.04895367429916166,
            "trailing": 0.0005936242600400401,
        },
        1e-8,
    ),
    Problem(
        "standard solid, direction-averaged",
        lambda **k: em.friction(
            _solid(),
            em.Paraboloid(0.01),
            velocity=1.0,
            load=10.0,
            **{"model": em.Averaged(corrected=False), **k},
        ),
        {"mu": 0.07304661009876835},
        1e-6,
    ),
    Problem(
        "low speed, half-space estimate: mu = v sum(E_k tau_k)/(E_inf R)",
        lambda **k: em.friction(
            _solid(), em.Paraboloid(0.01), velocity=1e-3, load=10.0, **k
        ),
        {"mu": 0.0003},
        0.005,
    ),
    Problem(
        "low speed, bare line: twice the half-space",
        lambda **k: em.friction(
            _solid(),
            em.Paraboloid(0.01),
            velocity=1e-3,
            load=10.0,
            **{"model": em.Line(), **k},
        ),
        {"mu": 0.0006},
        0.005,
    ),
    Problem(
        "three-parameter belt under an idler",
        _idler,
        {
            "resistance": 29.20365380701196,
            "coefficient": 0.01460182690350598,
            "leading": 0.006415553890351275,
            "trailing": 0.005180424046743101,
        },
        1e-8,
    ),
    Problem(
        "elastic sphere on a layer: F_N = pi k a^4/(4R)",
        lambda **k: em.friction(
            em.springs(em.Prony(5e6, [], [], kind="tensile", poisson=0.45), 1e-3),
            em.Paraboloid(0.5),
            velocity=1.0,
            depth=1e-4,
            **k,
        ),
        {"normal_force": 297.909648185239, "mu": 0.0},
        1e-10,
    ),
]
