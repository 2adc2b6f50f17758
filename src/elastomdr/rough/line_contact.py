"""Where a rough line touches the rubber it slides over."""

from __future__ import annotations

import dataclasses
import warnings
from typing import TYPE_CHECKING, Literal

import numpy as np

from ..call.extrapolation import excited_outside, rough_beyond
from ..call.model_choice import is_rough, of_line
from ..call.several_materials import over_materials
from ..checks import in_float64, is_traced
from ..errors import ConvergenceWarning, InputError
from ..models import seeds_of
from ..smooth.problem import BARE
from ..surface.rough_line import RoughLine
from .line import surface_words
from .line_contact_result import LineContact
from .line_problem import set_up
from .periodic_field import field

if TYPE_CHECKING:
    from .._types import Number
    from ..call.types import Material, Surface
    from ..models import Line


@over_materials
@in_float64
def line_contact(
    material: Material,
    surface: Surface,
    *,
    velocity: Number,
    load: Number | None = None,
    depth: Number | None = None,
    pressure: Number | None = None,
    temperature: Number | None = None,
    model: Line | Literal["line"] | None = None,
    rtol: float = 1e-6,
) -> LineContact:
    """Heights, rubber surface and contact along a rough line at one velocity, load and
    temperature.

    The line is that of the first seed of the model, in its own direction: the direction
    average has no single field.

    Args:
        material: as for `em.friction`, a series.
        surface: an `em.RoughLine`, or a surface.
        velocity: sliding velocity [m/s], a single number as all other arguments.
        load: normal force per length of line [N/m].
        depth: depth [m] in place of a load.
        pressure: nominal pressure on a surface [Pa], in place of a load.
        temperature: temperature [K], for a material with a shift law.
        model: `em.Line(...)`.
        rtol: as for `em.friction`.

    Returns:
        An `em.LineContact`. What touches is the contact of the MDR line, not the real
        contact of the surface. A point that does not converge is NaN, with one
        `ConvergenceWarning`.

    Raises:
        InputError: as `em.friction` with `model=em.Line(...)`.

    Exact for the line. Not differentiable.
    """
    if not is_rough(surface):
        raise InputError(
            "surface must be a rough line or a surface by its spectrum, got "
            f"{surface!r}."
        )
    model = of_line(model, "line_contact")
    if model.average:
        raise InputError(
            "model must be em.Line() without average in em.line_contact: the "
            "average has no single field."
        )
    model = dataclasses.replace(
        model, seeds=1 if isinstance(surface, RoughLine) else seeds_of(model.seeds)[:1]
    )
    if is_traced(material, surface, velocity, load, depth, pressure, temperature):
        raise InputError(
            "line_contact has no derivatives, and cannot run under jax.jit, grad "
            "or vmap: em.friction can."
        )
    scene = set_up(
        material,
        surface,
        velocity=velocity,
        load=load,
        depth=depth,
        pressure=pressure,
        temperature=temperature,
        model=model,
        rtol=rtol,
    )
    at = scene.at
    if at.reduced.size != 1:
        raise InputError(
            f"velocity, {at.name} and temperature must be single numbers, got "
            f"{at.shape}."
        )
    (line,) = scene.lines
    height = np.asarray(line.height)
    law, speed, value = (
        at.foundation.law(),
        float(at.reduced.ravel()[0]),
        float(scene.given[0]),
    )
    found = field(
        height, float(line.spacing), law, speed, value, scene.control, float(rtol)
    )
    good = bool(found.line.converged[0])
    if not good:
        warnings.warn(
            "the point did not converge; it is NaN.", ConvergenceWarning, stacklevel=3
        )
    mu, load_, deep, share = (
        float(getattr(found.line, name)[0]) for name in ("mu", "load", "depth", "share")
    )
    known = at.foundation.range
    outside = excited_outside(known, surface, at.reduced.reshape(()))
    beyond = rough_beyond(known, outside, at.kelvin, (), stacklevel=4)
    vertical = float(at.vertical.ravel()[0])
    return LineContact(
        x=np.asarray(line.x),
        height=height - height.max() + deep,
        surface=found.surface,
        force=vertical * found.force,
        touching=found.force > 0,
        mu=mu,
        load=vertical * load_,
        depth=deep,
        share=share,
        error=np.full(height.size, float(found.line.error[0])),
        converged=np.full(height.size, good),
        extrapolated=None
        if beyond.points is None
        else np.full(height.size, beyond.points),
        model=BARE + scene.rule,
        plan=f"one periodic state of {height.size} samples",
        inputs=(*scene.inputs(("surface", surface_words(surface, line))), *beyond.said),
    )
