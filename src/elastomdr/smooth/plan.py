"""The plan: a scene turned into the least work that answers it, before anything is
computed.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from ..checks import certain
from ..material.relaxation import Relaxation
from ..surface.direction import directions, shared_curve_size
from ..surface.lines import AbstractLines
from ..surface.profile import Profile
from ..surface.sampling import Rule, ladder
from ..surface.shapes import AbstractShape, Cone, PowerLaw
from .passage import Control, estimate_sizes

TRACED = 0.03  # of rtol, aimed for while JAX traces: nothing can be refined then
_ROUND = 2  # power from which on an apex is round enough


@dataclasses.dataclass(frozen=True)
class PlanAsked:
    """What a plan is made for."""

    quantity: str  # "friction" or "rolling"
    scene: str  # indenter and foundation, in words
    model: str  # the model's name, as in every result
    control: Control
    points: int
    temperatures: int  # different temperatures asked for
    rtol: float
    averaged: bool  # whether the direction average is taken
    # whether the average is corrected for the asymmetry of the contact
    corrected: bool
    # whether elements are marched in time steps; of a plan also where contact may be
    # renewed
    marched: bool


@dataclasses.dataclass(frozen=True)
class Plan(PlanAsked):
    """What will be computed, what is skipped, and why; `print(plan)` says it in
    words.
    """

    branches: int
    rules: tuple[Rule, ...]  # sampling rules, to be tried in this order
    directions: int  # directions per velocity
    # velocities share line solutions, one grid per load and temperature-shifted curve
    shared: bool
    # line solutions to begin with; where the error asks for it a curve gets twice as
    # many, and so on
    solutions: int
    # under a JAX transformation: values are not known, so nothing that depends on them
    # is skipped
    traced: bool
    elastic: bool  # no branch and no dashpot: nothing is lost, mu is zero
    # whether mu of the line may bend sharply at some velocity, see `_bends`
    bends: bool

    def __str__(self) -> str:
        return "\n".join([f"Plan: {self.quantity}, {self.scene}", *_described(self)])


def make_plan(
    asked: PlanAsked,
    law: Relaxation,
    lines: AbstractLines,
    value: np.ndarray | None,  # load or depth of each point; None while traced
    velocity: np.ndarray | None,  # times a_T
) -> Plan:
    """Plans a scene from its numbers; while JAX traces, from what is known without
    them.
    """
    control, points, rtol = asked.control, asked.points, asked.rtol
    renewed = isinstance(lines.shape, Profile) and not lines.shape.convex
    elastic = certain(lambda m, v: v == 0 and not np.any(m), law.moduli, law.viscosity)
    averaged = asked.averaged and not elastic
    inner = TRACED * rtol if value is None else rtol
    bends = averaged and _bends(lines.shape)
    count = 1
    if averaged:
        level = traced_level(rtol, bends) if value is None else 0
        count = directions(inner, level).cosines.size
    # Under a depth each point has its own load, which is found first.
    solutions = points * count + (points if averaged and control == "depth" else 0)
    traced = value is None or velocity is None
    shared = False
    rules = ladder(lines.shape, inner, strips=lines.count > 1)
    if value is not None and velocity is not None:
        # Contacts are the larger, the slower the motion and the higher the load.
        ends = np.array([value.max()]), np.array([velocity.min()])
        widest = float(estimate_sizes(law, lines, control, *ends)[0])
        rules = ladder(
            lines.shape,
            rtol,
            float(lines.shape.largest_contact) / (1.3 * widest),
            lines.count > 1,
        )
        if averaged and (control == "load" or bends):
            with_grid = _on_shared_curves(control, value, velocity, points, rtol)
            if bends or with_grid < solutions:
                shared, solutions = True, with_grid
    given = {x.name: getattr(asked, x.name) for x in dataclasses.fields(PlanAsked)}
    given |= {"averaged": averaged, "marched": asked.marched or renewed}
    return Plan(
        **given,
        branches=law.moduli.shape[0],
        rules=rules[:1] if traced else rules,
        directions=count,
        shared=shared,
        solutions=solutions,
        traced=traced,
        elastic=elastic,
        bends=bends,
    )


def _on_shared_curves(
    control: Control, value: np.ndarray, velocity: np.ndarray, points: int, rtol: float
) -> int:
    """How many lines are solved where the velocities of one load share a curve."""
    curves = [velocity] if points == 1 else velocity[:, None]
    if control == "load" and points > 1:
        curves = [velocity[value == x] for x in np.unique(value)]
    nodes = [shared_curve_size(v, rtol) for v in curves]
    return sum(n + v.size * (v.size <= n) for n, v in zip(nodes, curves, strict=True))


def _bends(shape: AbstractShape) -> bool:
    """Whether mu of the line may bend sharply at some velocity, so that no single
    velocity's directions show it.

    Behind a sharp apex contact is lost almost at once beyond some velocity, the more
    suddenly the stiffer the rubber is at first: under a cone, at E_0/E_inf = 1000,
    mu_line(log v) is as good as kinked. A profile given by points may be anything. The
    average then comes from a curve of the line, which shows what it does not resolve.
    """
    return isinstance(shape, (Cone, Profile)) or (
        isinstance(shape, PowerLaw) and shape.exponent < _ROUND
    )


def traced_level(rtol: float, bends: bool) -> int:
    """How often steps of the average are halved while JAX traces: nothing can be
    refined then.

    Of cones at contrasts from 10 to 1e5 the average was off by 4e-4/8^level at most.
    """
    return max(0, math.ceil(math.log(1e-3 / rtol, 8))) if bends else 0


def _described(plan: Plan) -> list[str]:
    lines = [f"  model        {plan.model}"]
    request = (
        f"{plan.points} point{'s' * (plan.points != 1)} by {plan.control}, relative "
        f"error of mu {plan.rtol:g}"
    )
    lines.append(f"  asked        {request}")
    lines.append(f"  contact      {_contact(plan)}")
    lines.append(f"  branches     {_branches(plan)}")
    if plan.temperatures > 1:
        sentence = (
            f"{plan.temperatures} temperatures enter as shifted velocities v a_T: one "
            "spectrum serves all"
        )
        lines.append(f"  temperature  {sentence}")
    lines.append(f"  directions   {_directions(plan)}")
    lines.append(
        "  not needed   the transient, the history of other elements (in steady "
        "motion one passage is the field),"
    )
    lines.append(
        "               surface shape and pressure in 3D, derivatives: none of "
        "them asked for"
    )
    return lines


def _contact(plan: Plan) -> str:
    rule = plan.rules[0]
    if plan.marched:
        return (
            "exact contact steps in diffrax march elements through the profile, where "
            "they may touch again"
        )
    if rule.exact:
        return (
            "closed form: the profile is polynomial, its integrals with every branch "
            "are exact, no time steps"
        )
    more = (
        f"; up to {plan.rules[-1].samples} where the error estimate asks for it"
        if len(plan.rules) > 1
        else ""
    )
    return (
        f"{rule.samples} samples of the profile along the contact, exact in every "
        f"branch, no time steps{more}"
    )


def _branches(plan: Plan) -> str:
    if plan.elastic:
        return "none, and no dashpot: nothing is lost, mu is zero and is not computed"
    return f"all {plan.branches} carried" if plan.branches else "none but the dashpot"


def _directions(plan: Plan) -> str:
    if not plan.averaged:
        return "one: no direction average"
    each = f"{plan.directions} per velocity"
    if plan.shared:
        alone = plan.points * plan.directions
        if plan.solutions >= alone:
            return (
                f"{each}, from a line curve for each load, since friction may bend: "
                f"{plan.solutions} line solutions, "
                "more where it does"
            )
        sentence = (
            f"{each}; velocities share one line curve per load: {plan.solutions} line "
            f"solutions instead of {alone}"
        )
        return f"{sentence}, more where friction bends" if plan.bends else sentence
    return f"{each}: {plan.solutions} line solutions"
