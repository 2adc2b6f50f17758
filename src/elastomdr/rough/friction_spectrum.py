"""Which frequencies the friction of a rough line or surface comes from."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..call.extrapolation import excited_outside, rough_beyond
from ..call.model_choice import is_rough, of_line
from ..call.several_materials import over_materials
from ..checks import in_float64, is_traced
from ..element.law import as_foundation
from ..errors import ConvergenceWarning, InputError
from ..results.spectrum import FrictionSpectrum
from ..smooth.problem import AVERAGED, BARE
from ..surface.direction import directions
from ..surface.rough_line import RoughLine
from .ensemble import coarse_at
from .excitation import excitation
from .line import ensemble_words, surface_words
from .line_problem import set_up

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Materials, Surface
    from ..models import Line

_DIRECTIONS = 1e-2  # relative error of the direction average: bands are for figures
# by which the bands go beyond the cutoffs; what lies further out is in those at the
# ends
_MARGIN = 10.0
# relative distance of the sum of the bands from friction, to which they are scaled;
# part of `error`
_CLOSED = 3e-2


@over_materials
@in_float64
def friction_spectrum(
    material: Materials,
    surface: Surface,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    pressure: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    model: Line | Literal["line"] | None = None,
    rtol: float = 1e-4,
    per_decade: int = 4,
) -> FrictionSpectrum:
    """Splits the friction of a rough line or surface by the frequency at which the
    rubber is strained.

        mu = sum_k 2 k |u_k|^2 E''(k v) / q_mean

    u_k are the waves of the motion of an element (`elastomdr.rough.excitation`), in
    partial contact too. Averaged over directions, the line that slides at v cos(phi) is
    strained at k v cos(phi).

    Args:
        material: as for `em.friction`, a series.
        surface: an `em.RoughLine`, or a surface.
        velocity: sliding velocity [m/s]; arguments broadcast.
        load: normal force per length of line [N/m].
        pressure: nominal pressure on a surface [Pa], in place of a load.
        temperature: temperature [K], for a material with a shift law. Where friction
            heats the surface, give the raised one, `curve.temperature +
            curve.temperature_rise`.
        model: `em.Line(...)`.
        rtol: as for `em.friction`.
        per_decade: bands in each decade of frequency.

    Returns:
        An `em.FrictionSpectrum` with one more axis, the bands. They sum to the friction
        of the line, to which they are
        scaled: from within 1e-2, which `error` holds, or the point is NaN; one
            `ConvergenceWarning` counts such points.

    Raises:
        InputError: as `em.friction` with `model=em.Line(...)`.

    Exact for the line. Not differentiable.
    """
    foundation = as_foundation(material)
    if not is_rough(surface):
        raise InputError(
            "surface must be an em.RoughLine, or a surface such as em.SelfAffine, "
            f"got {surface!r}."
        )
    if is_traced(foundation, surface, velocity, load, pressure, temperature):
        raise InputError(
            "friction_spectrum must be called outside jax.grad, jit and vmap: it "
            "is not differentiable."
        )
    law = foundation.law()
    if not np.any(law.moduli) and not float(law.viscosity):
        raise InputError(
            "material must have a relaxation time or a dashpot: an elastic one "
            "dissipates nothing."
        )
    if (
        isinstance(per_decade, bool)
        or not isinstance(per_decade, (int, np.integer))
        or not 1 <= per_decade <= 20
    ):
        raise InputError(
            f"per_decade must be a whole number from 1 to 20, got {per_decade!r}."
        )
    model = of_line(model, "friction_spectrum")
    scene = set_up(
        foundation,
        surface,
        velocity=velocity,
        load=load,
        depth=None,
        pressure=pressure,
        temperature=temperature,
        model=model,
        rtol=rtol,
    )
    at, lines, control, length, loads = (
        scene.at,
        scene.lines,
        scene.control,
        scene.length,
        scene.given,
    )
    shape, v, reduced = at.shape, at.full(at.velocity).ravel(), at.reduced.ravel()
    edges = _edges(surface, lines[0], int(per_decade))
    rule_of = directions(_DIRECTIONS)
    cosines, weights = (
        (rule_of.cosines, rule_of.weights)
        if model.average
        else (np.ones(1), np.ones(1))
    )
    lanes = (
        np.outer(reduced, cosines).ravel(),
        np.repeat(loads, cosines.size),
        np.tile(cosines, v.size),
    )
    mu, error, good = (
        np.zeros((v.size, edges.size - 1)),
        np.zeros(v.size),
        np.ones(v.size, bool),
    )
    for line in lines:
        found = excitation(
            np.asarray(line.height),
            float(line.spacing),
            law,
            lanes[0],
            lanes[1],
            control,
            float(rtol),
            edges,
            lanes[2],
        )
        bands, total, missed, fine = (
            field.reshape(v.size, cosines.size, -1) for field in found
        )
        gap = np.abs(bands.sum(axis=-1) - total[..., 0])
        bands = bands * (total / bands.sum(axis=-1, keepdims=True))
        mu += np.einsum("vdb,d->vb", bands, weights) / len(lines)
        error += (missed[..., 0] + gap) @ weights / len(lines)
        good &= fine.all(axis=(1, 2)) & (
            gap @ weights <= _CLOSED * (total[..., 0] @ weights)
        )
    good &= ~coarse_at(error, mu.sum(axis=1))
    if not good.all():
        warnings.warn(
            (
                f"{int((~good).sum())} of {good.size} points did not converge; they "
                "are NaN."
            ),
            ConvergenceWarning,
            stacklevel=3,
        )

    def banded(values: np.ndarray) -> np.ndarray:
        return np.broadcast_to(
            values.reshape(*shape, -1), (*shape, edges.size - 1)
        ).copy()

    middle = np.sqrt(edges[1:] * edges[:-1])
    inputs = [
        *scene.inputs(("surface", surface_words(surface, lines[0]))),
        ("ensemble", ensemble_words(scene.seeds, lines[0].count)),
    ]
    known, kelvin = foundation.range, at.full(at.kelvin)
    outside = excited_outside(known, surface, at.reduced.reshape(shape))
    beyond = rough_beyond(known, outside, kelvin, shape, stacklevel=4)
    return FrictionSpectrum(
        velocity=banded(v),
        omega=np.multiply.outer(v, middle).reshape(*shape, -1),
        wave_number=banded(np.multiply.outer(np.ones(v.size), middle)),
        mu=banded(np.where(good[:, None], mu, np.nan)),
        error=banded(np.where(good, error, np.nan)),
        converged=banded(good),
        extrapolated=None if beyond.points is None else banded(beyond.points.ravel()),
        temperature=None if at.kelvin is None else banded(kelvin),
        pressure=None
        if length is None
        else banded(loads * at.vertical.ravel() / length),
        width=float(edges[1] / edges[0]),
        model=(AVERAGED if model.average else BARE) + scene.rule,
        plan=(
            f"{lanes[0].size * len(lines)} line solutions of {lines[0].count} "
            "samples, all branches carried"
        ),
        inputs=(*inputs, *beyond.said),
    )


def _edges(surface: Any, line: RoughLine, per_decade: int) -> np.ndarray:
    """Edges of the bands of wave number [rad/m], in whole decades."""
    if isinstance(surface, RoughLine):
        low, high = 2 * np.pi / float(surface.period), np.pi / float(surface.spacing)
    else:
        low, high = surface.q_low, surface.q_high
    first, last = (
        np.floor(np.log10(low / _MARGIN) + 1e-9),
        np.ceil(np.log10(high * _MARGIN) - 1e-9),
    )
    return 10 ** (first + np.arange(per_decade * int(last - first) + 1) / per_decade)
