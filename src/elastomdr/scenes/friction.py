"""Steady sliding friction of one indenter."""

from typing import Any

from .._runtime import in_float64
from ..results.curve import FrictionCurve
from .steady import set_up, solve


@in_float64
def friction(
    material: Any,
    shape: Any,
    *,
    velocity: Any,
    load: Any = None,
    depth: Any = None,
    pressure: Any = None,
    temperature: Any = None,
    average: str | None = "direction",
    rtol: float = 1e-6,
    skip: bool = True,
) -> FrictionCurve:
    """Friction coefficient of an indenter in steady sliding against velocity, load or depth, and temperature.

    Arguments broadcast against each other; every field of the result has the broadcast shape.

    - `material`: `Prony` (then an incompressible-or-not half-space of it), or `Foundation` (two bodies, a layer).
    - `velocity` [m/s]; `load` [N] or `depth` [m]; `temperature` [K], for a material with a shift law.
    - `average`: "direction" for the estimate of the three-dimensional half-space, "corrected" for the same with an
      empirical correction for asymmetric contacts (`elastomdr.mapping.direction.asymmetry`; within 1 % for a ball
      where the average is up to 9 % high), None for the bare line of the textbook. Depth,
      normal force and contact edges are those of the line at the velocity itself. `model_error` in the result bounds
      the distance to the half-space.
    - `rtol`, 1e-3 to 1e-10: relative error of mu to be met. `skip=False` computes also what the plan would leave out.

    Exact for the line and for layers; for the half-space see `elastomdr.mapping.direction`. Raises `InputError`;
    points that do not converge are NaN and counted in one `ConvergenceWarning`. Differentiable with respect to moduli,
    times, geometry, load or depth, velocity and temperature. Source: Popov & Hess 2015, ch. 7 and 10, and
    `docs/theory.md`.
    """
    scene = set_up(
        "friction", material, shape, velocity=velocity, load=load, depth=depth, pressure=pressure,
        temperature=temperature, average=average, rtol=rtol, skip=skip,
    )  # fmt: skip
    found = solve(scene)
    return FrictionCurve(
        velocity=found.velocity,
        mu=found.mu,
        normal_force=found.normal_force,
        friction_force=found.friction_force,
        depth=found.depth,
        contact=found.contact,
        error=found.error,
        model_error=found.model_error,
        converged=found.converged,
        extrapolated=found.extrapolated,
        temperature=scene.temperature,
        model=scene.plan.model,
        plan=scene.plan,
        inputs=found.inputs,
    )
