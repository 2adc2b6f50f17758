"""Is every history right or flagged? Random scenes of what moves in time, against
routes that share nothing with us.

    python benchmarks/robustness/stress_motion.py [--scenes N] [--seed S] [--family F] [--show K]

`em.indent` under a depth (contact lost and regained) and under a load, `em.impact`,
`em.traction` and `em.shear`, drawn by `stress_motion_draw.py` and judged by
`stress_motion_judge.py`. Wrong is a converged answer off by more than rtol, of the
largest value of its history (in `em.shear`, which takes no rtol, by more than 1e-2);
covered one off by no more than its `error`; each beyond what the judge vouches for.
`stress_harness.py` runs it, and goes on where it was stopped.
"""

import math
import sys
from typing import Any

import numpy as np
from stress_harness import Suite, run
from stress_motion_draw import POWERS, Batch, draw
from stress_motion_judge import judge

FAMILIES = {  # shares of the scenes, and how many are drawn together
    "indent, depth": (0.32, 8),
    "indent, load": (0.1, 4),
    "impact": (0.24, 32),
    "traction": (0.14, 8),
    "shear, elastic": (0.1, 1),
    "shear, viscoelastic": (0.1, 1),
}


def answer(batch: Batch) -> Any:
    """The public call, and what of it is judged."""
    import elastomdr as em

    n, c = POWERS[batch.body], batch.size
    layer = True if batch.body == "cylinder" else None
    shapes = {
        "paraboloid": lambda: em.Paraboloid(1 / c),
        "cone": lambda: em.Cone(2 * c / math.pi),
    }
    shapes["cylinder"] = lambda: em.Cylinder(0.5 / c, 1.0)
    line = 2 * math.gamma((n + 1) / 2) / (math.sqrt(math.pi) * n * math.gamma(n / 2))
    shape = shapes.get(batch.body, lambda: em.PowerLaw(n, c * line))()
    materials = [em.Foundation(*one, per_area=layer) for one in batch.laws]
    inputs = dict(batch.inputs)
    if batch.family.startswith("indent"):
        got = em.indent(materials[0], shape, **inputs, rtol=batch.rtol)
        return {
            "depth": got.depth,
            "force": got.force,
            "error": got.error,
            "converged": got.converged,
        }
    if batch.family == "impact":
        # Every material with its own mass and speed: the diagonal of what one call
        # gives would be wasteful.
        got = [
            em.impact(
                m,
                shape,
                mass=inputs["mass"][i : i + 1],
                velocity=inputs["velocity"][i : i + 1],
            )
            for i, m in enumerate(materials)
        ]
        names = ("restitution", "max_depth", "duration", "stuck", "error", "converged")
        return {
            name: np.concatenate([getattr(one, name) for one in got]) for name in names
        }
    if batch.family == "traction":
        sheared = [em.Foundation(*one, per_area=layer) for one in inputs.pop("sheared")]
        got = [
            em.traction(
                m,
                shape,
                tangential=sheared[i],
                model=em.Line(),
                depth=inputs["depth"],
                **{
                    name: inputs[name][i : i + 1]
                    for name in ("velocity", "creepage", "friction")
                },
            )
            for i, m in enumerate(materials)
        ]
        said = {
            n: np.concatenate([getattr(g, n) for g in got])
            for n in ("force", "normal_force", "error", "converged")
        }
        said["edges"] = np.concatenate(
            [np.stack([one.contact.leading, one.contact.trailing], -1) for one in got]
        )
        return said
    sideways = em.Foundation(*batch.laws[1])
    got = em.shear(materials[0], shape, tangential=sideways, **inputs)
    return {"force": got.force, "error": got.error, "converged": got.converged}


def about(batch: Batch) -> str:
    return f"{batch.body}, {batch.laws[0].moduli.size} branches, rtol {batch.rtol:g}"


SUITE = Suite(
    name="stress_motion",
    title="Stress: random histories, each right or flagged",
    scenes=2000,
    families=FAMILIES,
    draw=draw,
    answer=answer,
    judge=judge,
    about=about,
)

if __name__ == "__main__":
    sys.exit(run(SUITE))
