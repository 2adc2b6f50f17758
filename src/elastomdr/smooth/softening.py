"""Softening with strain under smooth bodies: one effective strain of the contact, its
moduli, and the contact anew.

On a half-space the strain is 0.2 times the slope f'(a) of the body at the edge of
contact: 0.2 a/R for a ball and 0.2 tan(beta) for a cone, the representative strains of
Tabor (The Hardness of Metals, 1951; Johnson 1985, section 6.3). In a layer of springs
it is the compression over the thickness, its root mean square over the contact.

At that strain the storage modulus is f and the loss modulus g times that of small
strain. To first order in the loss the contact follows the storage modulus and friction
is proportional to the loss modulus: the contact is the linear one under the load F/f,
and mu is g/f times its mu. f and the contact are found together.
"""

from __future__ import annotations

import dataclasses
import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import Array
from ..errors import InputError
from ..numerics.implicit import as_doubles, implicit
from ..numerics.root import search
from ..surface.shapes import Cylinder
from .solve import SolvedPoints, run

if TYPE_CHECKING:
    from jaxtyping import PyTree

    from ..element.law import Foundation
    from ..material.relaxation import Relaxation
    from ..surface.lines import AbstractLines
    from .passage import Passages
    from .plan import Plan

SOFTENED = "; moduli at one effective strain of the contact"
LINEAR = "; linear: softening with strain left out"
TABOR = 0.2  # representative strain over the slope at the edge
_LONGEST = 0.7  # step of the logarithm of a factor
_ROUNDING = 1e-12


class Softened(NamedTuple):
    """What the strain has done to each point."""

    strain: Any  # effective strain of the contact
    storage: Any  # factor f
    loss: Any  # factor g
    linear: Any  # mu without softening; None while JAX traces


def check_softening(foundation: Foundation, lines: AbstractLines) -> None:
    """Raises `InputError` where a layer softens whose thickness is not known."""
    layer = foundation.per_area or isinstance(lines.shape, Cylinder)
    if foundation.softening is not None and layer and foundation.thickness is None:
        raise InputError(
            argument="thickness",
            accepted="given for a layer that softens, whose strain is a part of it",
            hint="use em.springs(material, thickness), or give the em.Foundation one",
        )


def run_softened(
    plan: Plan,
    foundation: Foundation,
    law: Relaxation,
    lines: AbstractLines,
    value: Array,
    velocity: Array,
) -> tuple[SolvedPoints, Softened]:
    """`run` with the moduli at the effective strain of each contact."""
    softening, traced = foundation.softening, plan.traced
    assert softening is not None
    alone = dataclasses.replace(plan, averaged=False, corrected=False, shared=False)
    shared, points = (softening, law, lines, foundation.thickness), (value, velocity)
    if traced:
        factor = _traced_factor(alone)(*as_doubles((shared, points)))
        linear = None
    else:
        factor = _factor(alone, shared, points)
        linear = run(plan, law, lines, value, velocity).mu
    sweep = run(
        plan, law, lines, value / factor if plan.control == "load" else value, velocity
    )
    amplitude = _strain(sweep.line, lines, foundation.thickness)
    storage, loss = softening.factors(amplitude)
    ratio = loss / storage
    untouched = (abs(storage - 1) < _ROUNDING) & (abs(loss - 1) < _ROUNDING)
    line = sweep.line._replace(
        normal_force=storage * sweep.line.normal_force,
        friction_force=loss * sweep.line.friction_force,
    )
    error = ratio * sweep.error + abs(ratio * sweep.mu * (storage / factor - 1))
    softer = sweep._replace(
        mu=ratio * sweep.mu,
        error=error,
        line=line,
        # what one strain for all leaves is not known
        model_error=xp.where(untouched, sweep.model_error, xp.nan),
    )
    return softer, Softened(amplitude, storage, loss, linear)


def _strain(line: Passages, lines: AbstractLines, thickness: Array | None) -> Any:
    if thickness is None:
        return TABOR * lines.shape._steepness(0.5 * (line.leading + line.trailing))
    # of the profile at the edge: the indentation is d (1 - t^n), over a line or a disc
    n = line.exponent
    mean_square = (
        1 - 2 / (n + 1) + 1 / (2 * n + 1)
        if isinstance(lines.shape, Cylinder)
        else 1 - 4 / (n + 2) + 1 / (n + 1)
    )
    return xp.sqrt(mean_square) * line.depth / thickness


def _next_factor(alone: Plan, factor: Array, shared: PyTree, points: PyTree) -> Any:
    """The factor at the strain of the contact that has the moduli of `factor`."""
    softening, law, lines, thickness = shared
    value, velocity = points
    load = value / factor if alone.control == "load" else value
    line = run(alone, law, lines, load, velocity).line
    return softening.factors(_strain(line, lines, thickness))[0]


def _factor(alone: Plan, shared: PyTree, points: PyTree) -> np.ndarray:
    """The factor that its own contact has, one where there is none."""

    def residual(log_factor: Array) -> Array:
        factor = np.exp(log_factor)
        return log_factor - np.log(_next_factor(alone, factor, shared, points))

    # A slope of one takes the next factor itself; the last step leaves its square.
    start = np.zeros(np.shape(points[0]))
    after = np.exp(search(residual, start, alone.rtol, 1.0, longest=_LONGEST)[0])
    # loads that were equal stay so, and share a curve
    return np.round(np.where(np.isfinite(after), after, 1.0), 12)


@functools.cache
def _traced_factor(alone: Plan) -> Any:
    """`_factor` of (shared, points) while JAX traces, with derivatives."""

    def search(shared: PyTree, points: PyTree) -> tuple[Any, None]:
        return _factor(alone, shared, points), None

    def equation(factor: Array, _: None, shared: PyTree, points: PyTree) -> Any:
        return _next_factor(alone, factor, shared, points) - factor

    return implicit(search, equation, lambda _, points: (points[0], None))


def softened_words(soft: Softened, good: np.ndarray) -> tuple[tuple[str, str], ...]:
    """What softening has done, for results."""
    if not good.any():
        return ()
    ends = [
        f"{float(x[good].min()):.3g} to {float(x[good].max()):.3g}"
        for x in (soft.strain, soft.storage, soft.loss)
    ]
    sentence = (
        f"effective strain {ends[0]}; storage modulus times {ends[1]}, loss modulus "
        f"times {ends[2]}"
    )
    return (("softening", sentence),)
