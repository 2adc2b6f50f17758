"""Which frequencies the friction of a rough line or surface comes from.

In steady sliding the motion u and the force q of an element are periodic in the
distance x = v t, and its law holds for each of their waves, q_k = E*(k v) u_k, in
contact or not. So the friction force per length is a sum over waves

    F_x = <q du/dx> = sum_{k>0} 2 k |u_k|^2 E''(k v),      k = 2 pi j/L,

each of which is what rubber that is strained at the frequency k v dissipates per
distance. The contact step takes u to be straight between samples, h apart, and is exact
for that motion, whose waves are those of the samples times sinc^2(k h/2), beyond the
Nyquist frequency too. The sum over all of them is the work of the step, but for what
the waves that are left out hold (|u_k|^2 falls as k^-4), and for the bends where
contact begins within a step. Derived here.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Literal

import jax
import numpy as np

from ..call.extrapolation import excited_outside, rough_beyond
from ..call.model_choice import is_rough, of_line
from ..call.problem import Asked
from ..call.several_materials import over_materials
from ..checks import in_float64, warn_unless, whole_number
from ..element.law import Foundation, as_foundation
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..results.doubts import Doubt, carried
from ..results.spectrum import FrictionSpectrum
from ..smooth.problem import AVERAGED, BARE
from ..surface.direction import directions
from ..surface.rough_line import RoughLine
from .ensemble import LinePoints, coarse_at
from .free_steps import line_law
from .line import ensemble_words, surface_words
from .line_problem import RoughScene, check
from .period import coefficients, motion
from .periodic import Job, SolvedLine, rises, solve_states
from .problem import RoughCall, not_rough

if TYPE_CHECKING:
    from jaxtyping import Float

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
_AT_ONCE = 64  # points, whose motions are held in memory
# multiples of the sampling wave number up to which waves of the straight pieces are
# summed
_TURNS = 6


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

    u_k are the waves of the motion of an element (`elastomdr.rough.friction_spectrum`), in
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
    _check(foundation, surface, per_decade)
    model = of_line(model, "friction_spectrum")
    asked = Asked(velocity, load, None, pressure, temperature)
    scene = check(RoughCall(foundation, surface, asked, rtol), model)
    edges = _edges(surface, scene.lines[0], int(per_decade))
    mu, error, good = _solve(scene, model.average, float(rtol), edges)
    warn_unless(good, "points")
    points = scene.at
    outside = excited_outside(
        foundation.range, surface, points.reduced.reshape(points.shape)
    )
    beyond = rough_beyond(
        foundation.range, outside, points.full(points.temperature), points.shape
    )
    spectrum = _report(scene, edges, mu, error, good, beyond)
    inputs = [
        *scene.inputs(("surface", surface_words(surface, scene.lines[0]))),
        ("ensemble", ensemble_words(scene.seeds, scene.lines[0].count)),
    ]
    return dataclasses.replace(
        spectrum,
        model=(AVERAGED if model.average else BARE) + scene.rule,
        plan=(
            f"{good.size * _directions(model.average)[0].size * len(scene.lines)} line "
            f"solutions of {scene.lines[0].count} samples, all branches carried"
        ),
        inputs=tuple(inputs),
    )


def _check(foundation: Foundation, surface: Surface, per_decade: int) -> None:
    """Raises `InputError` for what has no spectrum of friction."""
    if not is_rough(surface):
        raise not_rough(surface)
    law = foundation.law()
    if not np.any(law.moduli) and not float(law.viscosity):
        raise InputError(
            argument="material",
            accepted="one with a relaxation time or a dashpot",
            hint="an elastic one dissipates nothing",
        )
    whole_number("per_decade", per_decade, 1, 20)


def _directions(average: bool) -> tuple[np.ndarray, np.ndarray]:
    """Cosines of the directions of sliding, and their weights."""
    if not average:
        return np.ones(1), np.ones(1)
    rule = directions(_DIRECTIONS)
    return rule.cosines, rule.weights


def _solve(
    scene: RoughScene, average: bool, rtol: float, edges: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """mu by bands of wave number (points, bands), the error of its sum and where there
    is an answer (points,): means over lines and directions.
    """
    reduced, bins = scene.at.reduced.ravel(), edges.size - 1
    cosines, weights = _directions(average)
    shape = (reduced.size, cosines.size)
    mu, error = np.zeros((reduced.size, bins)), np.zeros(reduced.size)
    good = np.ones(reduced.size, bool)
    ask = LinePoints(
        np.outer(reduced, cosines).ravel(),
        np.repeat(scene.given, cosines.size),
        scene.control,
        rtol,
    )
    stretch = np.tile(cosines, reduced.size)
    for line in scene.lines:
        by_bands, solved = _excited(
            ask.on(line), scene.at.foundation.law(), edges, stretch
        )
        total, missed, fine = (
            field.reshape(shape)
            for field in (solved.mu, solved.error, solved.converged)
        )
        bands = by_bands.reshape(*shape, bins)
        gap = np.abs(bands.sum(axis=-1) - total)
        bands = bands * (total / bands.sum(axis=-1))[..., None]
        mu += np.einsum("vdb,d->vb", bands, weights) / len(scene.lines)
        error += (missed + gap) @ weights / len(scene.lines)
        closed = gap @ weights <= _CLOSED * (total @ weights)
        good &= fine.all(axis=1) & closed
    return mu, error, good & ~coarse_at(error, mu.sum(axis=1))


def _report(
    scene: RoughScene,
    edges: np.ndarray,
    mu: np.ndarray,
    error: np.ndarray,
    good: np.ndarray,
    beyond: tuple[Doubt, ...],
) -> FrictionSpectrum:
    """The numbers of the result; its last axis are the bands."""
    points, bands = scene.at, edges.size - 1
    middle = np.sqrt(edges[1:] * edges[:-1])
    velocity = points.full(points.velocity).ravel()

    def banded(values: np.ndarray) -> np.ndarray:
        return np.broadcast_to(
            values.reshape(*points.shape, -1), (*points.shape, bands)
        ).copy()

    pressure = None
    if scene.length is not None:
        pressure = banded(scene.given * points.vertical.ravel() / scene.length)
    return FrictionSpectrum(
        velocity=banded(velocity),
        omega=np.multiply.outer(velocity, middle).reshape(*points.shape, -1),
        wave_number=banded(np.multiply.outer(np.ones(velocity.size), middle)),
        mu=banded(np.where(good[:, None], mu, np.nan)),
        error=banded(np.where(good, error, np.nan)),
        model_error=banded(np.full(velocity.size, np.nan)),
        converged=banded(good),
        marks=carried(beyond, lambda points: banded(np.ravel(points))),
        temperature=None
        if points.temperature is None
        else banded(points.full(points.temperature)),
        pressure=pressure,
        width=float(edges[1] / edges[0]),
        model="",
        plan="",
        inputs=(),
    )


def _edges(surface: Surface, line: RoughLine, per_decade: int) -> np.ndarray:
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


def _excited(
    job: Job,
    law: Relaxation,
    edges: Float[np.ndarray, " edges"],
    stretch: Float[np.ndarray, " points"],
) -> tuple[Float[np.ndarray, "points bins"], SolvedLine]:
    """mu of each point by bins of `stretch` times the wave number, what lies outside the
    edges in the bins at the ends; and the points, NaN where they did not converge.
    """
    bands, lines = [], []
    for start in range(0, job.velocity.size, _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        part = job._replace(velocity=job.velocity[some], value=job.value[some])
        by_bins, line = _few_excited(part, law, edges, stretch[some])
        bands.append(by_bins)
        lines.append(line)
    return np.concatenate(bands), SolvedLine(
        *map(np.concatenate, zip(*lines, strict=True))
    )


def _few_excited(
    job: Job,
    law: Relaxation,
    edges: Float[np.ndarray, " edges"],
    stretch: Float[np.ndarray, " points"],
) -> tuple[Float[np.ndarray, "points bins"], SolvedLine]:
    line, state = solve_states(job, law)
    velocity, spacing, good = job.velocity, job.spacing, line.converged
    with jax.enable_x64(True):
        by = coefficients(line_law(law), spacing / velocity)
        depth, branches = (
            np.where(good, x, 0.0) for x in (state.depth, state.branches)
        )
        u = np.asarray(motion(rises(job.height), depth, branches, by).surface)
    n = u.shape[0]
    square = np.abs(np.fft.fft(u, axis=0) / n) ** 2
    by_bins = np.zeros((velocity.size, edges.size - 1))
    # waves of straight pieces: those of the samples times sinc^2(k h/2), beyond Nyquist
    for turn in range(_TURNS):
        j = np.arange(n) + turn * n
        k = 2 * np.pi * j / (n * spacing)
        power = (
            2
            * k[:, None]
            * square
            * (np.sinc(j / n) ** 4)[:, None]
            * _loss(law, k[:, None] * velocity)
        )
        for point in range(velocity.size):
            place = np.searchsorted(edges, stretch[point] * k, side="right") - 1
            by_bins[point] += np.bincount(
                np.clip(place, 0, edges.size - 2), power[:, point], edges.size - 1
            )
    load = np.where(good, line.load, 1.0)
    return np.where(good[:, None], by_bins / load[:, None], np.nan), line


def _loss(law: Relaxation, omega: np.ndarray) -> np.ndarray:
    """E''(omega), a branch at a time: there are as many frequencies as samples and
    points.
    """
    loss = float(law.viscosity) * omega
    for modulus, time in zip(
        np.asarray(law.moduli), np.asarray(law.times), strict=True
    ):
        x = omega * time
        loss += modulus * x / (1 + x**2)
    return loss
