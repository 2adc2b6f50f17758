"""The plan of a scene on a rough line or surface: what each point carries, what is left
out, before it is solved.
"""

import dataclasses

import numpy as np

from ..material.relaxation import Relaxation
from .branch_reduction import FORGOTTEN, lumped
from .periodic import LIGHT, first_guess, rises, strides_of


@dataclasses.dataclass(frozen=True)
class RoughPlan:
    """What will be computed, what is skipped, and why; `print(plan)` says it in words.

    Counts of branches are the smallest and the largest over the velocities that a line
    is solved at, None while JAX traces; so is `share`, the part of the line in contact
    by a first guess.
    """

    scene: str  # surface and material, in words
    model: str  # the model's name, as in every result
    control: str  # "load" or "depth"
    points: int
    rtol: float
    averaged: bool  # whether the direction average is taken
    lines: int  # in the ensemble
    samples: int  # of a line
    strides: tuple[int, ...]  # every how manieth sample is taken, level by level
    branches: int  # of the material
    kept_branches: tuple[int, int] | None  # one by one, the lump among them
    forgotten: tuple[int, int] | None  # within a step, part of the dashpot
    slow: tuple[int, int] | None  # lumped into one
    cost: float  # bound of mu's relative change by lumping
    share: tuple[float, float] | None
    passed_stretches: (
        int  # velocities of a line whose free stretches are passed in one go
    )
    solutions: int | None  # line solutions of all lines
    temperatures: int
    heated: bool
    skip: bool

    def __str__(self) -> str:
        return "\n".join([f"Plan: friction, {self.scene}", *_described(self)])


def plan_lines(
    *,
    scene: str,
    model: str,
    line: tuple[np.ndarray, float] | None,
    lines: int,
    samples: int,
    points: int,
    law: Relaxation,
    solved_at: tuple[np.ndarray, np.ndarray] | None,
    control: str,
    rtol: float,
    averaged: bool,
    solutions: int | None,
    skip: bool,
    heated: bool,
    temperatures: int,
) -> RoughPlan:
    """The plan, from heights and spacing of one line and the velocities and loads it is
    solved at; None: traced.
    """
    count = law.moduli.shape[0]
    plan = RoughPlan(
        scene=scene,
        model=model,
        control=control,
        points=points,
        rtol=rtol,
        averaged=averaged,
        lines=lines,
        samples=samples,
        strides=tuple(strides_of(samples)),
        branches=count,
        kept_branches=None,
        forgotten=None,
        slow=None,
        cost=0.0,
        share=None,
        passed_stretches=0,
        solutions=None if solutions is None else lines * solutions,
        temperatures=temperatures,
        heated=heated,
        skip=skip,
    )
    if line is None or solved_at is None:
        return plan
    (height, spacing), (velocity, value) = line, solved_at
    step = spacing / velocity
    reduced_law, cost = lumped(law, step, samples * step, rtol)
    share = first_guess(rises(height), reduced_law, samples * step, value, control)[-1]
    kept = np.count_nonzero(reduced_law.moduli, axis=0)
    fast = np.count_nonzero(step / np.asarray(law.times)[:, None] > FORGOTTEN, axis=0)
    real = np.count_nonzero(np.asarray(law.moduli))
    slow = np.maximum(real - fast - kept + 1, 0) * (real - fast > kept)
    if not skip:
        kept, fast, slow, cost = np.full_like(kept, real), 0 * fast, 0 * slow, 0 * cost
    return dataclasses.replace(
        plan,
        kept_branches=_ends(kept),
        forgotten=_ends(fast),
        slow=_ends(slow),
        cost=float(cost.max()),
        share=(float(share.min()), float(share.max())),
        passed_stretches=int(np.sum(share < LIGHT)) if skip else 0,
    )


def _ends(counts: np.ndarray) -> tuple[int, int]:
    return int(counts.min()), int(counts.max())


def _between(ends: tuple[int, int]) -> str:
    return f"{ends[0]}" if ends[0] == ends[1] else f"{ends[0]} to {ends[1]}"


def _described(plan: RoughPlan) -> list[str]:
    levels = "".join(f"every {s}th, " for s in plan.strides[:-1])
    lines = [
        f"  model        {plan.model}",
        f"  asked        {plan.points} point{'s' * (plan.points != 1)} by "
        f"{plan.control}, relative error of mu {plan.rtol:g} besides the sampling",
        (
            f"  lines        {plan.lines} of {plan.samples} samples: {levels}then all "
            "of them"
        ),
    ]
    lines += [f"  branches     {branches}" for branches in _branches(plan)]
    if plan.share is not None:
        low, high = plan.share
        lines.append(
            f"  contact      {low:.1%} to {high:.1%} of the line, roughly (not the "
            "real contact area)"
        )
    lines.append(f"  stretches    {_stretches(plan)}")
    if plan.temperatures > 1:
        lines.append(
            f"  temperature  {plan.temperatures} of them enter as shifted "
            "velocities "
            "v a_T"
        )
    if plan.averaged and plan.control == "load":
        lines.append(
            "  directions   averaged; velocities under one load share the curve "
            "of a line"
        )
    else:
        lines.append(
            "  directions   "
            f"{'averaged' if plan.averaged else 'one: no direction average'}"
        )
    if plan.solutions is not None:
        more = ", and more for each round of heating" if plan.heated else ""
        lines.append(
            f"  solutions    {plan.solutions} periodic states, in batches on every "
            f"core{more}"
        )
    lines.append(
        "  not needed   the transient (the periodic state is solved for), other "
        "elements (they see the same)"
    )
    return lines


def _branches(plan: RoughPlan) -> list[str]:
    if plan.kept_branches is None or plan.forgotten is None or plan.slow is None:
        return [
            (
                f"all {plan.branches} carried: under a JAX transformation their values "
                "are not known"
            )
        ]
    texts = [
        (
            f"{_between(plan.kept_branches)} of {plan.branches} carried, each velocity its "
            "own "
            "window"
        )
    ]
    if plan.forgotten[1]:
        texts.append(
            f"{_between(plan.forgotten)} forgotten within a sample: dashpots, "
            "exactly so in the sampled motion"
        )
    if plan.slow[1]:
        texts.append(
            f"{_between(plan.slow)} slower than the line's period, lumped into "
            "one of "
            "those carried"
        )
        texts.append(f"this costs at most {plan.cost:.1e} of mu, counted in the error")
    return texts if plan.skip else [*texts, "skipping switched off"]


def _stretches(plan: RoughPlan) -> str:
    if not plan.skip:
        return "skipping switched off"
    if plan.share is None:
        return "none passed in one go: under a JAX transformation values are not known"
    if plan.passed_stretches == 0:
        return f"none passed in one go: more than {LIGHT:.0%} of the line is in contact"
    return (
        f"where nothing can touch passed in one go, where less than {LIGHT:.0%} of "
        "the line is in contact"
    )
