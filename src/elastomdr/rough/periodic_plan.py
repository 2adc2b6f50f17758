"""The plan of a scene on a rough line or surface, before it is solved."""

from __future__ import annotations

import dataclasses
from typing import Literal


@dataclasses.dataclass(frozen=True)
class RoughPlan:
    """What will be computed, and why; `print(plan)` says it in words."""

    scene: str  # surface and material, in words
    model: str  # the model's name, as in every result
    control: Literal["load", "depth"]
    points: int
    rtol: float
    averaged: bool  # whether the direction average is taken
    lines: int  # in the ensemble
    samples: int  # of a line
    strides: tuple[int, ...]  # every how manieth sample is taken, level by level
    branches: int  # of the material
    solutions: int  # line solutions of all lines
    temperatures: int
    heated: bool

    def __str__(self) -> str:
        levels = "".join(f"every {s}th, " for s in self.strides[:-1])
        lines = [
            f"Plan: friction, {self.scene}",
            f"  model        {self.model}",
            f"  asked        {self.points} point{'s' * (self.points != 1)} by "
            f"{self.control}, relative error of mu {self.rtol:g} besides the sampling",
            f"  lines        {self.lines} of {self.samples} samples: {levels}then all "
            "of them",
            f"  branches     all {self.branches}",
        ]
        if self.temperatures > 1:
            lines.append(
                f"  temperature  {self.temperatures} of them enter as shifted "
                "velocities v a_T"
            )
        averaged = "averaged; velocities under one load share the curve of a line"
        more = ", and more for each round of heating" if self.heated else ""
        lines += [
            "  directions   "
            + (averaged if self.averaged else "one: no direction average"),
            f"  solutions    {self.solutions} periodic states, in batches on every "
            f"core{more}",
            "  not needed   the transient (the periodic state is solved for), other "
            "elements (they see the same)",
        ]
        return "\n".join(lines)
