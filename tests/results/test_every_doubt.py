"""Each kind of doubt, made by each verb that can have it, is found in every place where
the result is shown: attributes, table, header, summary, xarray, dict, figure and card.
Where laws, bands, rankings and traction carry them on, see `test_doubts.py`.
"""

import dataclasses
from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.app import cards
from elastomdr.results.base import Result
from elastomdr.results.doubts import KINDS, SHORT
from elastomdr.surface.topography import MeasuredSurface
from elastomdr.trees import replaced

from ..call.test_extrapolation import (
    BALL,
    BLIND,
    EVEN,
    NO_RANGE,
    OUTSIDE,
    ROAD,
    ROLLER,
    RUBBER,
    WAVE,
)
from .test_doubts import MADE, kinds, points

SOLID = NO_RANGE.at(293.15)
SPRINGS = em.springs(SOLID, 1e-2, bonded=False)
ELASTIC = em.Prony(1e6, [], [])
V = [0.1, 1.0]
DEEP = [1e-4, 8e-3]  # the second is deeper than the ball's contact is wide
FLOW = {"viscosity": 1e-3, "length": 1e-3, "pressure_drop": 1e4}
STRONG = {"boundary_shear": 1e5}
WORN = MeasuredSurface(
    q=np.array([1e3, 1e5]),
    c=ROAD.at([1e3, 1e5]),
    relative_error=np.zeros(2),
    measured_height=float(ROAD.rms_height),
    skewness=-1.4,
    report=(),
    tops=np.linspace(0.0, -3.0, 21),
)
STIFF = em.Foundation(1e9, [1e10], [1e-3], shift=em.WLF(8.86, 101.6, 293.15))


def illustrative(name: str) -> Result:
    made_up = replaced(RUBBER, range=RUBBER.range._replace(illustrative_moduli=True))
    return OUTSIDE[name](made_up)


def slid() -> em.Slide:
    return em.slide(
        SOLID,
        BALL,
        time=EVEN,
        position=0.02 * EVEN,
        depth=np.where(EVEN > 0.01, *DEEP[::-1]),
        rtol=0.1,
    )


def conveyor() -> em.Conveyor:
    side = em.Idlers(SPRINGS, ROLLER, spacing=1.0)
    return em.conveyor(side, side, velocity=2.0, belt=20.0, goods=[0.0, 1e6])


def warming(material: object, shape: em.Cylinder, **scene: object) -> em.HeatBuildUp:
    return em.heat_build_up(material, shape, velocity=1.0, **scene)


# of each class of results, calls with the kinds of doubts that they have beside "not
# converged", which all have, and "extrapolated" and "illustrative", which all have that
# see a material (`OUTSIDE`)
CALLS: dict[str, list[tuple[str, Callable[[], Result]]]] = {
    "FrictionCurve": [
        ("estimate", lambda: em.friction(SOLID, BALL, velocity=V, depth=DEEP)),
        *((kind, made) for kind, made in MADE.items() if kind != "illustrative"),
    ],
    "RollingCurve": [
        ("estimate", lambda: em.rolling(SOLID, BALL, velocity=V, depth=DEEP)),
        (
            "no prediction",
            lambda: em.rolling(SOLID, ROLLER, velocity=V, load=100.0),
        ),
        ("bound", lambda: OUTSIDE["RollingCurve"](RUBBER)),
    ],
    "Dissipation": [
        (
            "estimate, no prediction",
            lambda: em.dissipation(SOLID, BALL, velocity=V, depth=DEEP),
        ),
    ],
    "FrictionSpectrum": [
        (
            "no prediction",
            lambda: em.friction_spectrum(SOLID, WAVE, velocity=0.1, load=10.0),
        ),
    ],
    "RoughContact": [
        (
            "estimate, no prediction",
            lambda: em.press(SOLID, ROAD, pressure=[1e4, 3e8], model=em.Line(seeds=2)),
        ),
    ],
    "Indentation": [
        (
            "estimate",
            lambda: em.indent(SOLID, BALL, time=[0, 1.0, 2.0], depth=[0.0, *DEEP]),
        ),
        (
            "no prediction",
            lambda: em.indent(SPRINGS, BALL, time=[0, 1.0], depth=[0, 1e-4]),
        ),
    ],
    "Impact": [
        (
            "estimate",
            lambda: em.impact(SOLID, BALL, mass=1.0, velocity=[1e-2, 50.0], rtol=1e-2),
        ),
        (
            "no prediction",
            lambda: em.impact(SPRINGS, BALL, mass=1e-3, velocity=V, rtol=1e-2),
        ),
    ],
    "Slide": [("estimate, no prediction", slid)],
    "Drive": [
        (
            "estimate, no prediction",
            lambda: em.drive(
                SOLID,
                BALL,
                time=EVEN[:3],
                position=EVEN[:3],
                load=[1.0, 1.0, 4000.0],
                tangential=em.Mount(0.1, 1e3),
                rtol=0.1,
            ),
        ),
    ],
    "ForceSpectrum": [
        ("estimate, no prediction", lambda: slid().spectrum("normal_force")),
    ],
    "Shear": [
        (
            "estimate, no prediction",
            lambda: em.shear(
                SOLID,
                BALL,
                time=EVEN[:3],
                displacement=1e-6 * EVEN[:3],
                depth=[0.0, *DEEP],
                friction=0.5,
                elements=8,
                steps=2,
            ),
        ),
    ],
    "Traction": [
        (
            "estimate, no prediction",
            lambda: em.traction(
                SOLID,
                BALL,
                velocity=1.0,
                creepage=[1e-3, 1e-2],
                friction=0.5,
                depth=8e-3,
            ),
        ),
        (
            "bound",
            lambda: em.traction(
                ELASTIC,
                BALL,
                velocity=1.0,
                creepage=[1e-6, 1e-1],
                friction=0.5,
                load=1.0,
            ),
        ),
    ],
    "Conveyor": [("estimate, no prediction", conveyor)],
    "HeatBuildUp": [
        (
            "estimate, no prediction, not converged",
            lambda: warming(
                em.springs(NO_RANGE, 1e-2, bonded=False),
                ROLLER,
                load=[100.0, 1e6],
                ambient=293.0,
                conductance=1.0,
                hottest=320.0,
            ),
        ),
        (
            "hot branch",
            lambda: warming(
                STIFF,
                em.Cylinder(0.1, 0.05),
                load=2000.0,
                ambient=265.0,
                conductance=[0.05, 0.2],
                hottest=392.0,
            ),
        ),
    ],
    "ORing": [
        ("bound", lambda: em.o_ring(SOLID, 5e-3, [0.01, 0.25], fluid_pressure=1e5)),
    ],
    "Leak": [
        (
            "estimate, bound",
            lambda: em.leak(SOLID, ROAD, pressure=[2e4, 3e8], **FLOW),
        ),
        (
            "no prediction",
            lambda: em.leak(
                SOLID, ROAD, pressure=[2e4, 3e5], model="effective medium", **FLOW
            ),
        ),
    ],
    "BreakOut": [
        (
            "estimate, no prediction",
            lambda: em.break_out(SOLID, ROAD, pressure=[1e4, 3e8], **STRONG),
        ),
        ("bound", lambda: em.break_out(SOLID, WORN, pressure=[1e2, 1e4], **STRONG)),
    ],
    "Lubricated": [
        (
            "estimate, no prediction, not converged",
            lambda: em.lubricated(
                SOLID,
                em.Cylinder(1e-2, 0.1),
                velocity=0.1,
                viscosity=1e-2,
                load=[1.0, 3e7],
            ),
        ),
    ],
    "Reciprocating": [
        (
            "no prediction",
            lambda: em.reciprocating(
                SOLID,
                o_ring=em.o_ring(SOLID, 5e-3, 0.15),
                velocity_out=[1e-4, 0.2],
                velocity_in=0.1,
                stroke=0.1,
                viscosity=0.1,
            ),
        ),
    ],
    "Stability": [("no prediction", BLIND["Stability"])],
    "HalfPlaneCurve": [],
    "HalfSpaceCurve": [],
}
# what no call of a class can have, and why
NEVER = {
    "extrapolated": set(BLIND),  # forces are given; a reference takes what it gets
    "illustrative": set(BLIND),
    "estimate": {  # no depth; a squeeze of at most a quarter
        *("FrictionSpectrum", "ORing", "Reciprocating", *BLIND),
    },
    # between two ends; the references are what models are compared with
    "no prediction": {"ORing", "HalfPlaneCurve", "HalfSpaceCurve"},
    "bound": {  # no bound is established, or none is needed, or it is a quarter at most
        *("Dissipation", "FrictionSpectrum", "RoughContact"),
        *("Indentation", "Impact", "Slide", "Drive", "ForceSpectrum", "Shear"),
        *("Conveyor", "HeatBuildUp", "Lubricated", "Reciprocating", *BLIND),
    },
    "hot branch": set(CALLS) - {"FrictionCurve", "HeatBuildUp"},  # nothing heats
}


def test_each_kind_is_made_by_each_class_or_cannot_be():
    assert set(CALLS) == {*OUTSIDE, *BLIND}
    for name, calls in CALLS.items():
        made = {kind for said, _ in calls for kind in said.split(", ")}
        never = {kind for kind, names in NEVER.items() if name in names}
        everywhere = {"not converged"}
        if name in OUTSIDE:
            everywhere |= {"extrapolated", "illustrative"}
        assert made | never | everywhere == set(KINDS), name
        assert not made & never, name


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("name", "said", "made"),
    [
        pytest.param(name, said, made, id=f"{name}: {said}")
        for name, calls in CALLS.items()
        for said, made in calls
    ],
)
def test_a_doubt_is_found_wherever_its_result_is_shown(name, said, made):
    result = made()
    assert type(result).__name__ == name
    expected = set(said.split(", "))
    assert expected <= kinds(result.doubts)
    shown_everywhere(result, expected)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize("name", OUTSIDE)
def test_what_every_result_may_have_is_found_wherever_it_is_shown(name):
    """Points that failed, or lie outside the data, of illustrative moduli."""
    result = illustrative(name)
    (doubt,) = (each for each in result.doubts if each.kind == "illustrative")
    assert doubt.points.all()
    assert result.extrapolated.any()
    shown_everywhere(failed(result), {"not converged", "extrapolated", "illustrative"})


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "name",
    [
        "Stability",
        *(pytest.param(n, marks=pytest.mark.slow) for n in list(BLIND)[1:]),
    ],
)
def test_of_what_sees_no_material_points_that_failed_are_found(name):
    shown_everywhere(failed(BLIND[name]()), {"not converged"})


def failed(result: Result) -> Result:
    """With a first point that did not converge."""
    converged = np.array(result.converged)
    converged.flat[0] = False
    result = dataclasses.replace(result, converged=converged)
    assert points(result.doubts, "not converged").flat[0]
    return result


def shown_everywhere(result: Result, expected: set[str]) -> None:
    cells = pd.Series(result.columns()["doubts"].astype(str))
    data, frame = result.to_xarray(), result.to_pandas()
    flags = data["doubts"].attrs
    bits = dict(zip(flags["flag_meanings"].split(), flags["flag_masks"], strict=True))
    for kind in expected:
        where = points(result.doubts, kind)
        assert where.shape == np.shape(result.converged)
        assert where.any()
        np.testing.assert_array_equal(cells.str.contains(kind), where.ravel())
        bit = bits[kind.replace(" ", "_")]
        np.testing.assert_array_equal(data["doubts"].values & bit == bit, where)
        assert f"doubt, {kind}" in data.attrs
        assert f"doubt, {kind}" in frame.attrs
        assert kind in kinds(result.to_dict()["doubts"])
        assert f"{kind}: " in "\n".join(result.header())
        assert kind in result.summary()
    drawn = " ".join(text.get_text() for text in result.plot().texts)
    plt.close("all")
    card = " ".join(note for each in cards.cards(result) for note in each.notes)
    for kind in expected - {"not converged"}:  # of which a figure says how many
        assert SHORT[kind] in " ".join(drawn.split())
        assert f"{cards._KINDS.get(kind, kind)}: " in card
