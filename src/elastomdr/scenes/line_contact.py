"""Where a rough line touches the rubber it slides over."""

import warnings
from typing import Any

import numpy as np

from .._runtime import in_float64, is_traced
from ..errors import ConvergenceWarning, InputError
from ..mapping.rough_line import RoughLine
from ..mapping.synthesis import PERIODS
from ..results.line_contact import LineContact
from ..solve.periodic_field import field
from .rough import is_rough, surface_words
from .rough_arguments import set_up
from .steady import BARE, brief


@in_float64
def line_contact(
    material: Any,
    surface: Any,
    *,
    velocity: Any,
    load: Any = None,
    depth: Any = None,
    pressure: Any = None,
    temperature: Any = None,
    rtol: float = 1e-6,
    equivalent_length: Any = None,
    samples: int | None = None,
    periods: int = PERIODS,
    seed: int = 0,
) -> LineContact:
    """Heights, rubber surface and contact along a rough line at one velocity, load and temperature.

    Arguments are single numbers, and otherwise as for `em.friction` of a rough line or surface; `seed` chooses the line
    of the ensemble. The direction is that of the line itself (the bare line): the direction average has no single
    field. What touches is the MDR line's contact, not the real contact of the surface. A point that does not converge
    is NaN, with one `ConvergenceWarning`. No derivatives. Raises `InputError`.
    """
    if not is_rough(surface):
        raise InputError(f"surface must be a rough line or a surface by its spectrum, got {surface!r}.")
    if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
        raise InputError(f"seed must be a whole number, 0 or more, got {seed!r}.")
    if is_traced(material, surface, velocity, load, depth, pressure, temperature):
        raise InputError(
            "line_contact has no derivatives, and cannot run under jax.jit, grad or vmap: em.friction can."
        )
    scene = set_up(
        material, surface, velocity=velocity, load=load, depth=depth, pressure=pressure, temperature=temperature,
        average=None, rtol=rtol, equivalent_length=equivalent_length, samples=samples, periods=periods,
        seeds=1 if isinstance(surface, RoughLine) else (int(seed),),
    )  # fmt: skip
    if scene.reduced.size != 1:
        raise InputError(f"velocity, {scene.control} and temperature must be single numbers, got {scene.shape}.")
    (line,) = scene.lines
    height = np.asarray(line.height)
    law, speed, value = scene.foundation.law(), float(scene.reduced.ravel()[0]), float(scene.given[0])
    found = field(height, float(line.spacing), law, speed, value, scene.control, float(rtol))
    good = bool(found.line.converged[0])
    if not good:
        warnings.warn("the point did not converge; it is NaN.", ConvergenceWarning, stacklevel=3)
    mu, load_, deep, share = (float(getattr(found.line, name)[0]) for name in ("mu", "load", "depth", "share"))
    inputs = [("material", scene.foundation.name or "given directly"), ("surface", surface_words(surface, line))]
    inputs += [] if pressure is None else [("pressure", brief(np.asarray(pressure), "Pa"))]
    inputs += [(f"line {scene.control}", brief(scene.value, "N/m" if scene.control == "load" else "m"))]
    inputs += [("velocity", brief(scene.velocity, "m/s"))]
    inputs += [] if scene.kelvin is None else [("temperature", brief(scene.kelvin, "K"))]
    return LineContact(
        x=np.asarray(line.x), height=height - height.max() + deep, surface=found.surface, force=found.force,
        touching=found.force > 0, mu=mu, load=load_, depth=deep, share=share,
        error=np.full(height.size, float(found.line.error[0])), converged=np.full(height.size, good),
        model=BARE + scene.rule, plan=f"one periodic state of {height.size} samples", inputs=tuple(inputs),
    )  # fmt: skip
