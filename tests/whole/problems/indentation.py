"""Indentation with closed-form answers: (name, call, expected fields at instants,
relative tolerance).
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

import elastomdr as em


class Problem(NamedTuple):
    name: str
    solve: Callable[[], Any]
    expected: dict[str, dict[int, float]]  # field: {index of the instant: value}
    rtol: float


TIMES = np.array([0, 0.25, 0.5, 0.8, 1.0, 1.1, 1.25, 1.4, 1.5095304990693228, 2.0])


def _triangle() -> Any:
    solid = em.Foundation(1.0, [3.0], [0.5])
    return em.indent(
        solid, em.Paraboloid(1.0), time=TIMES, depth=0.01 * np.minimum(TIMES, 2 - TIMES)
    )


def _creep() -> Any:
    rubber = em.Foundation(0.5, [2.0, 1.0, 0.4], [1e-3, 0.1, 10.0])
    return em.indent(rubber, em.Paraboloid(2.0), time=[0.0, 0.01, 1.0, 50.0], load=0.02)


def _viscous() -> Any:
    liquid = em.Prony(0.0, [], [], viscosity=1000.0)
    return em.indent(liquid, em.Paraboloid(0.05), time=[0.0, 0.5, 1.0, 2.0], load=1.0)


RADIUS, GAMMA = 0.01, 0.05
SOLID = em.Foundation(1.0, [3.0], [0.5])
BALL = em.Paraboloid(1.0)
# shrinks, grows again
TWICE = np.interp(
    TIMES, [0, 0.5, 1.0, 1.1, 1.4, 2.0], [0, 0.01, 0.004, 0.006, 0.012, 0.012]
)
# a load that goes to zero and returns
PULSES = np.interp(TIMES, [0, 0.5, 1.0, 1.25, 2.0], [0, 3e-3, 0, 0, 3e-3])
ELASTIC = em.Foundation(1e6, [], [])
PULL = -0.002356194490192345


def _jkr_load() -> Any:
    load = [0.0, PULL, 0.0, 1.0]
    return em.indent(
        ELASTIC, em.Paraboloid(RADIUS), time=np.arange(4.0), load=load, adhesion=GAMMA
    )


def _jkr_depth() -> Any:
    depth = [0.0, -2.261484826944946e-06, -4.7040780046055166e-06, -4.8e-06]
    return em.indent(
        ELASTIC, em.Paraboloid(RADIUS), time=np.arange(4.0), depth=depth, adhesion=GAMMA
    )


def _kendall() -> Any:
    depth = np.array([0.0, -1e-5, -1.772453850905516e-05, -1.8e-5])
    return em.indent(
        ELASTIC, em.FlatPunch(1e-3), time=np.arange(4.0), depth=depth, adhesion=GAMMA
    )


PROBLEMS = [
    Problem(
        "Ting: triangle of depth on a standard solid",
        _triangle,
        {
            "force": {
                1: 0.0005794989781560522,
                2: 0.0014512858598840772,
                3: 0.0025931973387766775,
                4: 0.00337335122148522,
                5: 0.0022812690663025583,
                6: 0.001043828585770497,
                7: 0.0002573474388334263,
                9: 0.0,
            },
            "contact_radius": {
                5: 0.09399199927902938,
                6: 0.07955805525392792,
                7: 0.05350519706527801,
                9: 0.0,
            },
            "work": {8: 8.858856666520433e-06, 9: 8.858856666520433e-06},
            "dissipated": {9: 8.858856666520433e-06},
        },
        1e-10,
    ),
    Problem(
        "creep under a step load, three branches: a^3 = (3/4) R F J(t)",
        _creep,
        {
            "contact_radius": {
                0: 0.19740230337485712,
                1: 0.2539288759867057,
                2: 0.3248960717071863,
                3: 0.3877476073763103,
            },
            "depth": {
                0: 0.019483834688849563,
                1: 0.03223993702993588,
                2: 0.05277872870538058,
                3: 0.07517410351302664,
            },
        },
        1e-13,
    ),
    Problem(
        "viscous half-space under a constant load",
        _viscous,
        {
            "depth": {0: 0.0, 3: 0.014115540433215428},
            "contact_radius": {3: 0.026566464229565278},
        },
        1e-12,
    ),
    Problem(
        "JKR under a load",
        _jkr_load,
        {
            "contact_radius": {
                0: 0.00041347012014067967,
                1: 0.00026046985393390226,
                2: 0.00041347012014067967,
            },
            "depth": {0: 5.698584674971604e-06, 1: -2.261484826944946e-06},
        },
        1e-9,
    ),
    Problem(
        "JKR at a depth",
        _jkr_depth,
        {
            "force": {1: PULL, 2: -0.0013089969389957472, 3: 0.0},
            "contact_radius": {
                1: 0.00026046985393390226,
                2: 0.0001252208449714013,
                3: 0.0,
            },
        },
        1e-9,
    ),
    Problem(
        "Kendall: flat punch",
        _kendall,
        {"force": {2: -0.03544907701811032, 3: 0.0}},
        1e-12,
    ),
]
