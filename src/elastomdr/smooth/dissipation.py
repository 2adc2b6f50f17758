"""Where in the relaxation spectrum a sliding or rolling contact turns its work into
heat.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    nan_unless,
    numpy_unless_traced,
    only_one,
    possible,
    warn_unless,
)
from ..errors import InputError
from ..models import Averaged, Line, as_model, named
from ..results.doubts import carried
from ..results.spectrum import Dissipation
from ..surface.direction import directions
from ..surface.shapes import Cylinder
from .cylinder import cylinder_losses
from .on_layer import is_on_layer
from .passage import Control, Losses, solve_losses
from .plan import Plan
from .problem import SmoothCall, SmoothScene, check, solve
from .solve import batch_size

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike

_SAMPLED = 0.1  # of the tolerance, which sampling may take
_LAYER_SHARE = 1e-3  # of the work that the branches may miss on a layer


@over_materials
@numpy_unless_traced
def dissipation(
    material: Materials,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
) -> Dissipation:
    """Share of each branch of the relaxation spectrum in what a sliding or rolling body
    dissipates.

        F_k = (1/v) int f_k^2/(E_k tau_k) dx,      sum_k F_k = F_x

    f_k is the force of branch k, over the contact and over the free recovery behind it,
    where the springs give back what they hold to the dashpots.

    Args:
        material: as for `friction`, a series.
        shape: a body with a convex profile.
        velocity: velocity [m/s]; arguments broadcast.
        load: normal force [N].
        depth: depth [m] in place of a load.
        temperature: temperature [K], for a material with a shift law.
        model: as for `friction`.
        rtol: as for `friction`.

    Returns:
        An `em.Dissipation`. Its fields have one more axis, the last: branches in order
        of their times, after a parallel dashpot if there is one, whose time is zero.
        `error` is the share of the work that the branches do not account for. A point
        that failed is NaN with `converged=False`.

    Raises:
        InputError: as `friction`, and for a profile that is not convex.

    Exact for the line, and for a cylinder on an `em.layer` or a half-space, in numbers
    only; bodies of revolution on an `em.layer` are refused. With the direction average
    F_k is averaged as the friction is, exact to first order in the loss. Differentiable
    as `friction` is.

    Source: derived in `docs/theory.md`, section 22.
    """
    solid: Any = material  # `over_materials` has taken a list apart
    asked = Asked(velocity, load, depth, temperature=temperature)
    call = SmoothCall("dissipation", solid, shape, asked, model, rtol)
    if is_on_layer(material, shape):
        return _on_layer(dataclasses.replace(call, quantity="rolling"))
    model = as_model(model)
    if model is not None and model.marched:
        raise InputError(
            argument="model",
            got=model,
            accepted=named(Averaged(), Line()) + " for the losses of branches",
        )
    scene = check(call, softens=False)
    _check_branches(scene.plan)
    return _shares(scene)


def _check_branches(plan: Plan) -> None:
    """Raises `InputError` where there are none to be told from each other."""
    if plan.marched:
        raise InputError(
            argument="shape",
            accepted="of a convex profile",
            hint="branches are not separated where contact may be renewed",
        )
    if plan.elastic:
        raise InputError(
            argument="material",
            accepted="one with a relaxation time or a dashpot",
            hint="an elastic one dissipates nothing",
        )


def _shares(scene: SmoothScene) -> Dissipation:
    """The solved scene, its friction shared out among the branches."""
    solved = solve(scene)
    load = xp.ravel(solved.normal_force) / scene.vertical
    dashpot, branches, work, _, good = _forces(scene, load)
    with_dashpot = possible(lambda x: x > 0, scene.law.viscosity)
    forces = xp.concatenate([dashpot[None], branches]) if with_dashpot else branches
    total = xp.sum(forces, axis=0)
    missing = abs(total / work - 1)
    good = solved.converged & (good & (missing <= scene.plan.rtol)).reshape(scene.shape)
    asked = f" to rtol={scene.plan.rtol:g}"
    warn_unless(good, "balances of losses", asked, known=~solved.converged)
    share = xp.moveaxis(forces / total, 0, -1).reshape(*scene.shape, -1)
    share = nan_unless(good[..., None], share)
    times = scene.law.times
    times = xp.concatenate([xp.zeros(1), times]) if with_dashpot else times
    factor = (scene.points.reduced / scene.points.velocity)[..., None]

    def spread(field: Array) -> Any:
        return xp.broadcast_to(field[..., None], share.shape)

    force = share * solved.friction_force[..., None]
    return Dissipation(
        velocity=spread(solved.velocity),
        temperature=None if scene.temperature is None else spread(scene.temperature),
        time=times * factor,
        share=share,
        resistance=force,
        power=force * solved.velocity[..., None],
        normal_force=spread(solved.normal_force),
        error=spread(nan_unless(good, missing.reshape(scene.shape))),
        model_error=share * np.nan,
        converged=spread(good),
        marks=carried(solved.marks, spread),
        model=scene.plan.model,
        plan=scene.plan,
        inputs=solved.inputs,
    )


def _on_layer(call: SmoothCall) -> Dissipation:
    """Of a cylinder on rubber of finite thickness, or on a half-space."""
    shape, rtol = call.shape, call.rtol
    if not isinstance(shape, Cylinder):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an em.Cylinder for the losses of an em.layer by branch",
            hint="give a ball the material itself, a half-space",
        )
    only_one({"load": call.asked.load, "depth": call.asked.depth})
    rolled, each, times = cylinder_losses(call)
    steady = rolled.steady
    total = np.sum(each, axis=0)
    missing = np.abs(total * np.asarray(shape.length) / steady.friction_force - 1)
    good = steady.converged & (missing <= max(rtol, _LAYER_SHARE))
    asked = f" to {max(rtol, _LAYER_SHARE):g}"
    warn_unless(good, "balances of losses", asked, known=~steady.converged)
    share = nan_unless(good[..., None], np.moveaxis(each / total, 0, -1))

    def spread(field: Array) -> Any:
        return np.broadcast_to(np.asarray(field)[..., None], share.shape)

    force = share * steady.friction_force[..., None]
    return Dissipation(
        velocity=spread(steady.velocity),
        temperature=None if rolled.temperature is None else spread(rolled.temperature),
        time=np.broadcast_to(times, share.shape),
        share=share,
        resistance=force,
        power=force * steady.velocity[..., None],
        normal_force=spread(steady.normal_force),
        error=spread(nan_unless(good, missing)),
        model_error=share * np.nan,
        converged=spread(good),
        marks=carried(steady.marks, spread),
        model=rolled.plan.model,
        plan=rolled.plan,
        inputs=steady.inputs,
    )


def _forces(scene: SmoothScene, load: Array) -> Losses:
    """The losses averaged as the plan says; their `error` is not."""
    plan = scene.plan
    velocity, control, value = scene.reduced, scene.control, scene.value
    cosines: Any = np.ones(1)
    weights: Any = np.ones(1)
    if plan.averaged:
        rule = directions(plan.rtol)
        cosines, weights = rule.cosines, rule.weights
        control, value = "load", xp.where(xp.isfinite(load), load, 1.0)
    slowed = (velocity[:, None] * cosines).ravel()
    value = xp.broadcast_to(value[:, None], (velocity.size, cosines.size)).ravel()
    if plan.traced:
        rule = plan.rules[0]
        every = solve_losses(scene.law, scene.lines, rule, control, value, slowed)
    else:
        every = _refined(scene, control, value, slowed)
    dashpot, branches, work = (
        field.reshape(*field.shape[:-1], velocity.size, cosines.size) @ weights
        for field in (every.dashpot, every.branches, every.friction_force)
    )
    good: Any = every.converged.reshape(velocity.size, -1).all(axis=1)
    return Losses(dashpot, branches, work, xp.nan * work, good)


def _refined(
    scene: SmoothScene, control: Control, value: np.ndarray, velocity: np.ndarray
) -> Losses:
    """The losses of many passages, with the rules of the plan tried in turn where the
    error of the work asks for it.
    """
    law, plan = scene.law, scene.plan
    every, left = None, np.arange(velocity.size)
    for rule in plan.rules:
        count = -(-left.size // batch_size(law, scene.lines, rule))
        parts = [
            solve_losses(law, scene.lines, rule, control, value[here], velocity[here])
            for here in np.array_split(left, count)
        ]
        solved = _joined(parts)
        if every is None:
            every = solved
        else:
            for whole, field in zip(every, solved, strict=True):
                whole[..., left] = field
        missed = ~(every.error <= _SAMPLED * plan.rtol * every.friction_force)
        left = np.flatnonzero(every.converged & missed)
        if not left.size:
            break
    assert every is not None
    return every


def _joined(parts: list[Losses]) -> Losses:
    fields = zip(*parts, strict=True)
    return Losses(*(xp.concatenate(field, axis=-1) for field in fields))
