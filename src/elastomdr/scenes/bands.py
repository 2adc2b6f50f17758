"""Which frequencies the friction of a rough line or surface comes from."""

import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np

from .._runtime import as_float64, in_float64, is_traced, plain, positive
from ..errors import ConvergenceWarning, InputError
from ..foundation.law import as_foundation
from ..mapping.direction import directions
from ..mapping.rough_line import RoughLine
from ..mapping.synthesis import PERIODS
from ..results.bands import FrictionBands
from ..solve.excitation import excitation
from .rough import ensemble_words, is_rough, surface_words
from .rough_arguments import set_up
from .steady import AVERAGED, BARE, brief

_DIRECTIONS = 1e-2  # relative error asked of the direction average: bands are to be looked at
_MARGIN = 10.0  # by which the bands go beyond the cutoffs; what lies further out is in those at the ends
_CLOSED = 1e-3  # relative distance of the sum of the bands from the work of the contact step


@in_float64
def friction_bands(
    material: Any,
    surface: Any,
    *,
    velocity: Any,
    load: Any = None,
    pressure: Any = None,
    temperature: Any = None,
    average: str | None = "direction",
    rtol: float = 1e-4,
    equivalent_length: Any = None,
    samples: int | None = None,
    periods: int = PERIODS,
    seeds: int | Sequence[int] = 1,
    sampling: float = 0.1,
    per_decade: int = 4,
) -> FrictionBands:
    """Splits the friction of a rough line or surface by the frequency at which the rubber is strained.

        mu = sum_k 2 k |u_k|^2 E''(k v) / q_mean,

    u_k the waves of the motion of an element (`elastomdr.solve.excitation`): exact for the line, in partial contact
    too. Arguments are those of `em.friction`; the result has one axis more, bands of frequency, `per_decade` in each
    decade. Averaged over directions, the line that slides at v cos(phi) is strained at k v cos(phi). Where friction
    heats the surface, give the raised temperature, `curve.temperature + curve.rough.rise`.

    Exact for the line; the bands sum to its friction, within 1e-3, or the point is NaN. Raises `InputError`; points
    that do not converge are NaN and counted in one `ConvergenceWarning`. Not differentiable.
    """
    foundation = as_foundation(material)
    if not is_rough(surface):
        raise InputError(f"surface must be an em.RoughLine, or a surface such as em.SelfAffine, got {surface!r}.")
    if is_traced(foundation, surface, velocity, load, pressure, temperature):
        raise InputError("friction_bands must be called outside jax.grad, jit and vmap: it is not differentiable.")
    law = foundation.law()
    if not np.any(law.moduli) and not float(law.viscosity):
        raise InputError("material must have a relaxation time or a dashpot: an elastic one dissipates nothing.")
    if isinstance(per_decade, bool) or not isinstance(per_decade, (int, np.integer)) or not 1 <= per_decade <= 20:
        raise InputError(f"per_decade must be a whole number from 1 to 20, got {per_decade!r}.")
    sampling = plain("sampling", sampling)
    positive("sampling", sampling)
    scene = set_up(
        foundation, surface, velocity=velocity, load=load, depth=None, pressure=pressure, temperature=temperature,
        average=average, rtol=rtol, equivalent_length=equivalent_length, samples=samples, periods=periods, seeds=seeds,
    )  # fmt: skip
    shape, lines, control, length, kelvin = scene.shape, scene.lines, scene.control, scene.length, scene.kelvin
    v, loads, reduced = np.broadcast_to(scene.velocity, shape).ravel(), scene.given, scene.reduced.ravel()
    edges = _edges(surface, lines[0], int(per_decade))
    rule_of = directions(_DIRECTIONS)
    cosines, weights = (np.ones(1), np.ones(1)) if average is None else (rule_of.cosines, rule_of.weights)
    lanes = np.outer(reduced, cosines).ravel(), np.repeat(loads, cosines.size), np.tile(cosines, v.size)
    mu, error, good = np.zeros((v.size, edges.size - 1)), np.zeros(v.size), np.ones(v.size, bool)
    for line in lines:
        found = excitation(
            np.asarray(line.height), float(line.spacing), law, lanes[0], lanes[1], control, float(rtol),
            edges, lanes[2],
        )  # fmt: skip
        bands, total, missed, fine = (field.reshape(v.size, cosines.size, -1) for field in found)
        gap = np.abs(bands.sum(axis=-1) - total[..., 0])
        mu += np.einsum("vdb,d->vb", bands, weights) / len(lines)
        error += (missed[..., 0] + gap) @ weights / len(lines)
        good &= fine.all(axis=(1, 2)) & (gap @ weights <= _CLOSED * (total[..., 0] @ weights))
    good &= error <= sampling * mu.sum(axis=1)
    if not good.all():
        warnings.warn(
            f"{int((~good).sum())} of {good.size} points did not converge; they are NaN.", ConvergenceWarning,
            stacklevel=3,
        )  # fmt: skip

    def banded(values: np.ndarray) -> np.ndarray:
        return np.broadcast_to(values.reshape(*shape, -1), (*shape, edges.size - 1)).copy()

    middle = np.sqrt(edges[1:] * edges[:-1])
    inputs = [
        ("material", foundation.name or "given directly"), ("surface", surface_words(surface, lines[0])),
        *([("pressure", brief(as_float64("pressure", pressure), "Pa"))] if pressure is not None else []),
        ("line load", brief(scene.value, "N/m")), ("velocity", brief(scene.velocity, "m/s")),
        *([] if kelvin is None else [("temperature", brief(kelvin, "K"))]),
        ("ensemble", ensemble_words(scene.seeds, lines[0].count)),
    ]  # fmt: skip
    return FrictionBands(
        velocity=banded(v),
        frequency=np.multiply.outer(v, middle).reshape(*shape, -1),
        wave_number=banded(np.multiply.outer(np.ones(v.size), middle)),
        mu=banded(np.where(good[:, None], mu, np.nan)),
        error=banded(np.where(good, error, np.nan)),
        converged=banded(good),
        temperature=None if kelvin is None else banded(np.broadcast_to(kelvin, shape)),
        pressure=None if length is None else banded(loads / length),
        width=float(edges[1] / edges[0]),
        model=(BARE if average is None else AVERAGED) + scene.rule,
        plan=f"{lanes[0].size * len(lines)} line solutions of {lines[0].count} samples, all branches carried",
        inputs=tuple(inputs),
    )


def _edges(surface: Any, line: RoughLine, per_decade: int) -> np.ndarray:
    """Edges of the bands of wave number [rad/m], in whole decades."""
    if isinstance(surface, RoughLine):
        low, high = 2 * np.pi / float(surface.period), np.pi / float(surface.spacing)
    else:
        low, high = surface.q_low, surface.q_high
    first, last = np.floor(np.log10(low / _MARGIN) + 1e-9), np.ceil(np.log10(high * _MARGIN) - 1e-9)
    return 10 ** (first + np.arange(per_decade * int(last - first) + 1) / per_decade)
