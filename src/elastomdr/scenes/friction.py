"""Steady sliding friction of one indenter."""

from collections.abc import Sequence
from typing import Any

from .._runtime import in_float64
from ..mapping.synthesis import PERIODS
from ..results.curve import FrictionCurve
from ..solve.heat import Heat
from .rough import is_rough, only_rough, rough_friction
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
    equivalent_length: Any = None,
    samples: int | None = None,
    periods: int = PERIODS,
    seeds: int | Sequence[int] = 1,
    sampling: float = 0.1,
    heat: Heat | None = None,
    progress: Any = None,
    store: Any = None,
) -> FrictionCurve:
    """Friction coefficient of an indenter or a rough surface in steady sliding against velocity, load and temperature.

    Arguments broadcast against each other; every field of the result has the broadcast shape.

    - `material`: `Prony` (then an incompressible-or-not half-space of it), or `Foundation` (two bodies, a layer).
    - `velocity` [m/s]; `load` [N] or `depth` [m]; `temperature` [K], for a material with a shift law.
    - `average`: "direction" for the estimate of the three-dimensional half-space, "corrected" for the same with an
      empirical correction for asymmetric contacts (`elastomdr.mapping.direction.asymmetry`; within 1 % for a ball
      where the average is up to 9 % high), None for the bare line of the textbook. Depth,
      normal force and contact edges are those of the line at the velocity itself. `model_error` in the result bounds
      the distance to the half-space.
    - `rtol`, 1e-3 to 1e-10: relative error of mu to be met. `skip=False` computes also what the plan would leave out.

    A rough line (`RoughLine`) takes `load` per length [N/m] or `depth` of its highest point [m]. A surface
    (`SelfAffine`, `Spectrum`, measured) takes a nominal `pressure` [Pa], turned into the line load p L with L = 2
    pi/q_low, the rule of the textbook, for light contact; `equivalent_length="full contact"` takes 2 m_2/m_3 of the
    spectrum's moments, better at higher loads, and a number [m] itself (`docs/rough.md` compares them with three
    dimensions). It is computed on `seeds` lines of random phases (or those of a list of seeds), each
    `periods` longest waves long, of `samples` samples (default: eight per shortest wave; four times as many, up to
    2^20, for points that need them). There `rtol` is that of the solution on these samples; `error` has the sampling
    too, and a point where it exceeds `sampling` times mu is NaN. `progress(done, total)` is called after each batch;
    `store` keeps finished batches (`get(key)`, `put(key, arrays)`).

    `heat=em.Heat(...)` heats the rubber of a surface under a `pressure` by its friction, from `temperature` on, until
    friction and flash temperature agree (`elastomdr.solve.heat`): `mu` is then the hot curve, `rough.cold` the one
    without heating, `rough.rise` the flash temperature. Points where no temperature is found are NaN.

    Exact for the line and for layers; for the half-space see `elastomdr.mapping.direction`. Raises `InputError`;
    points that do not converge are NaN and counted in one `ConvergenceWarning`. Differentiable with respect to moduli,
    times, geometry, load or depth, velocity and temperature. Source: Popov & Hess 2015, ch. 7 and 10, and
    `docs/theory.md`.
    """
    if is_rough(shape):
        return rough_friction(
            material, shape, velocity=velocity, load=load, depth=depth, pressure=pressure, temperature=temperature,
            average=average, rtol=rtol, skip=skip, equivalent_length=equivalent_length, samples=samples,
            periods=periods, seeds=seeds, sampling=sampling, heat=heat, progress=progress,
            store=store,
        )  # fmt: skip
    only_rough(equivalent_length, heat)
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
