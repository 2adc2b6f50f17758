"""Friction of a rough line or surface under a transformation of JAX: each point has its
own directions.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import jax.numpy as jnp

from ..checks import Array, is_traced
from ..material.relaxation import Relaxation
from ..surface.direction import directions, quadrature_error
from ..surface.rough_line import RoughLine
from .ensemble import AVERAGE
from .mean import Mean
from .periodic_gradient import Differentiable, solve_traced

if TYPE_CHECKING:
    from jaxtyping import Float


def traced_mean_of_lines(
    lines: list[RoughLine],
    law: Relaxation,
    velocity: Float[Array, " n"],
    value: Float[Array, " n"],
    control: Any,
    rtol: float,
    average: bool,
) -> Mean:
    """Mean over the lines, as `rough.ensemble.mean_of_lines`: the same numbers, with
    derivatives.
    """
    runs = [
        _one_line(line, law, velocity, value, control, rtol, average) for line in lines
    ]
    mu, error, load, depth, share = (
        jnp.stack(values).mean(axis=0) for values in list(zip(*runs, strict=True))[:5]
    )
    good = jnp.stack([run.good for run in runs]).all(axis=0)
    scatter = (
        jnp.std(jnp.stack([run.mu for run in runs]), axis=0, ddof=1) / len(runs) ** 0.5
        if len(runs) > 1
        else None
    )
    return Mean(mu, error, load, depth, share, good & jnp.isfinite(mu), scatter)


def _one_line(line: RoughLine, law, velocity, value, control, rtol, average) -> Mean:
    spacing = line.spacing

    def solved(velocity: Array, value: Array, control: Any) -> Differentiable:
        if not is_traced(spacing):
            return solve_traced(
                line.height, float(spacing), law, velocity, value, control, rtol
            )
        # A line stretched by a factor passes in the same time at as many times the
        # speed, with slopes as much smaller.
        found = solve_traced(
            line.height, 1.0, law, velocity / spacing, value, control, rtol
        )
        return found._replace(mu=found.mu / spacing, error=found.error / spacing)

    if not average:
        own = solved(velocity, value, control)
        return Mean(
            own.mu, own.error, own.load, own.depth, own.share, own.good > 0, None
        )
    rule = directions(max(rtol, AVERAGE))
    own = solved(velocity, value, control)
    slowed = velocity[:, None] * rule.cosines
    loads = jnp.broadcast_to(own.load[:, None], slowed.shape)
    every = solved(slowed.ravel(), loads.ravel(), "load")
    each = every.mu.reshape(slowed.shape)
    mu, half, quarter = (
        (each * weights).sum(axis=1)
        for weights in (rule.weights, rule.half, rule.quarter)
    )
    sampled = (every.error.reshape(slowed.shape) * rule.weights).sum(axis=1)
    error = quadrature_error(mu, half, quarter, rule.tail) + sampled
    good = (own.good > 0) & (every.good.reshape(slowed.shape) > 0).all(axis=1)
    return Mean(mu, error, own.load, own.depth, own.share, good, None)
