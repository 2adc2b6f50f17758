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
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import fixed, fori_loop, xp
from ..checks import is_traced
from ..errors import InputError
from ..surface.shapes import Cylinder
from .solve import Sweep, run

if TYPE_CHECKING:
    from ..element.law import Foundation
    from ..material.relaxation import Relaxation
    from ..material.softening import Softening
    from ..surface.lines import AbstractLines
    from .passage import Passages
    from .plan import Plan

SOFTENED = "; moduli at one effective strain of the contact"
LINEAR = "; linear: softening with strain left out"
TABOR = 0.2  # representative strain over the slope at the edge
_ROUNDS = 30  # of secants; 3 to 5 are usual
_TRACED = 12
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
            "softening needs the thickness of the layer, of which its strain is a "
            "part: use em.springs(material, thickness), or give the em.Foundation one."
        )


def run_softened(
    plan: Plan,
    foundation: Foundation,
    law: Relaxation,
    lines: AbstractLines,
    value: Any,
    velocity: Any,
) -> tuple[Sweep, Softened]:
    """`run` with the moduli at the effective strain of each contact."""
    softening, traced = (
        foundation.softening,
        plan.traced or is_traced(law, lines, value, velocity, foundation),
    )
    assert softening is not None
    alone = dataclasses.replace(plan, averaged=False, corrected=False, shared=False)

    def strain(line: Passages, body: Any, thickness: Any) -> Any:
        return _strain(line, body, thickness)

    def next_of(
        factor: Any,
        own: Softening,
        law: Any,
        body: Any,
        value: Any,
        velocity: Any,
        thickness: Any,
    ) -> Any:
        """The factor at the strain of the contact that has the moduli of `factor`."""
        load = value / factor if plan.control == "load" else value
        line = run(alone, law, body, load, velocity).line
        return own.factors(strain(line, body, thickness))[0]

    given = (softening, law, lines, value, velocity, foundation.thickness)
    if traced:
        factor = _traced_factor(next_of, given)
    else:
        factor = _factor(
            lambda factor: next_of(factor, *given),
            np.ones(np.shape(value)),
            0.1 * plan.rtol,
        )
    linear = None if traced else run(plan, law, lines, value, velocity).mu
    found = run(
        plan, law, lines, value / factor if plan.control == "load" else value, velocity
    )
    amplitude = strain(found.line, lines, foundation.thickness)
    storage, loss = softening.factors(amplitude)
    ratio = loss / storage
    untouched = (abs(storage - 1) < _ROUNDING) & (abs(loss - 1) < _ROUNDING)
    line = found.line._replace(
        normal_force=storage * found.line.normal_force,
        friction_force=loss * found.line.friction_force,
    )
    error = ratio * found.error + abs(ratio * found.mu * (storage / factor - 1))
    softer = found._replace(
        mu=ratio * found.mu,
        error=error,
        line=line,
        # what one strain for all leaves is not known
        model_error=xp.where(untouched, found.model_error, xp.nan),
    )
    return softer, Softened(amplitude, storage, loss, linear)


def _strain(line: Passages, lines: AbstractLines, thickness: Any) -> Any:
    if thickness is None:
        return TABOR * lines.shape._steepness(0.5 * (line.leading + line.trailing))
    # of the profile at the edge: the indentation is d (1 - t^n), over a line or a disc
    n = line.exponent
    part = (
        1 - 2 / (n + 1) + 1 / (2 * n + 1)
        if isinstance(lines.shape, Cylinder)
        else 1 - 4 / (n + 2) + 1 / (n + 1)
    )
    return xp.sqrt(part) * line.depth / thickness


def _factor(next_of: Any, start: np.ndarray, tolerance: float) -> np.ndarray:
    """The factor that its own contact has, by secants; NaN contacts stay as they
    are.
    """
    before, after = start, next_of(start)
    off = after - before
    for _ in range(_ROUNDS):
        if not (np.abs(off) > tolerance * after).any():
            break
        here = after
        missed = next_of(here) - here
        steep = (missed - off) / np.where(here == before, 1.0, here - before)
        step = np.where(
            np.isfinite(steep) & (steep < -0.1) & (here != before),
            -missed / steep,
            missed,
        )
        before, after, off = here, np.clip(here + step, 0.5 * here, 2 * here), missed
    # loads that were equal stay so, and share a curve
    return np.round(np.where(np.isfinite(after), after, 1.0), 12)


def _traced_factor(next_of: Any, given: tuple[Any, ...]) -> Any:
    """The same while JAX traces: rounds without derivatives, then one Newton step that
    has them.
    """
    import jax

    held = fixed(given)
    start = xp.ones(xp.shape(given[3]))
    factor = fixed(fori_loop(0, _TRACED, lambda _, at: next_of(at, *held), start))
    again, slope = jax.jvp(
        lambda at: next_of(at, *held), (factor,), (xp.ones_like(factor),)
    )
    return factor + (next_of(factor, *given) - factor) / fixed(1 - slope) + 0.0 * again


def softened_words(
    soft: Softened, good: np.ndarray, beyond: np.ndarray
) -> tuple[tuple[str, str], ...]:
    """What softening has done, for results."""
    if not good.any():
        return ()
    ends = [
        f"{float(x[good].min()):.3g} to {float(x[good].max()):.3g}"
        for x in (soft.strain, soft.storage, soft.loss)
    ]
    text = (
        f"effective strain {ends[0]}; storage modulus times {ends[1]}, loss modulus "
        f"times {ends[2]}"
    )
    if beyond.any():
        text += (
            f"; {int(beyond.sum())} points beyond the strain sweep, where the factors "
            "are held"
        )
    return (("softening", text),)
