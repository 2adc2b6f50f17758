"""Steady sliding where an element may leave and touch again: one element marched
through the whole profile.

In steady motion every element has the same history, so the passage of one element from
the leading edge x = a to x = -a (beyond which the surface only retreats) is the whole
field: the normal force is int q dx = v int q dt, and the friction force of the line int
q du. `smooth.passage` is faster and more accurate, but holds for convex profiles, where
contact is lost once and for all.

All points and lines march together as the elements of one `diffrax` solve, each in
units of its own passage time. The march is of second order in the sample spacing; its
limit is extrapolated from a series of marches, with an error.
"""

from __future__ import annotations

import functools
import math
from typing import TYPE_CHECKING, NamedTuple

import diffrax
import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, in_float64, numpy_unless_traced
from ..element.contact_step import rest
from ..element.elements import ContactStep, RigidSurface, forces
from ..material.relaxation import Relaxation
from ..numerics.interpolation import halving_limit
from ..numerics.root import search
from ..results.plot_contacts import SteadyElements
from ..surface.lines import AbstractLines
from .passage import Control, Passages, estimate_sizes, largest_size

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_BLOCK = 64  # contact steps per step of the solver
_FEWEST, _MOST = 256, 2**15  # samples per passage
_RISE = 2.5  # of log F_N with log A, about
_SMALL = 0.1  # error of mu, relative, up to which it is an estimate
_ROUNDING = 1e-13  # relative error of mu per square root of samples
# contact steps per instant and instants per passage of what is shown, and how many
# passages long the elements are followed
_BETWEEN, _SHOWN, _FOLLOWED = 8, 400, 3


class _March(NamedTuple):
    """One march, per point."""

    size: Float[Array, " points"]  # contact size A [m]
    normal: Float[Array, " points"]  # [N]
    drag: Float[Array, " points"]  # [N]
    trailing: Float[Array, " points"]  # [m]
    good: Bool[Array, " points"]


class _Passing(eqx.Module):
    """The rigid surface over one element per line and point: w = g(a) - g(x), x = a (1
    - 2 t), t from 0 to 1.
    """

    lines: AbstractLines
    size: Float[Array, " points"]

    def __call__(self, t: Array) -> Float[Array, " elements"]:
        entry, line = self.lines.entry(self.size), jnp.arange(self.lines.count)[:, None]
        top = self.lines.profile(entry, self.size, line)
        return (top - self.lines.profile(entry * (1 - 2 * t), self.size, line)).reshape(
            -1
        )


@numpy_unless_traced
def march_passages(
    law: Relaxation,
    lines: AbstractLines,
    control: Control,
    value: Float[Array, " points"],  # load [N] or depth [m]
    velocity: Float[Array, " points"],  # times a_T [m/s]
    rtol: float,
) -> Passages:
    """Steady passages by marching, of numbers; samples double until `rtol` of mu is met
    or 2^15 are used up.

    What a direction misses of `rtol` is in its `error`, since it may weigh little in an
    average; not converged is where the error is no longer small against mu. `trailing`
    is where contact is lost for the last time, to within one sample.
    """
    count = velocity.size
    # one program for all counts up to the next power of 2: it takes seconds to compile
    padded = (0, (1 << (count - 1).bit_length()) - count)
    value, velocity = (np.pad(x, padded, mode="edge") for x in (value, velocity))
    load = value if control == "load" else None
    log_size = np.log(estimate_sizes(law, lines, control, value, velocity))
    samples, marches = _FEWEST, []
    while True:
        march = _at_load(law, lines, velocity, load, log_size, samples, 1e-3 * rtol)
        marches.append(march)
        log_size = np.where(march.good, np.log(march.size), log_size)
        if len(marches) >= 3:
            good, error = _judged(marches[-3:], samples, load)
            met = error <= rtol * np.abs(march.drag / march.normal)
            if samples >= _MOST or not np.any(march.good & ~(good & met)):
                break
        samples *= 2
    size, normal, drag = map(halving_limit, marches[-2][:3], marches[-1][:3])
    leading, trailing = lines.entry(size)[0], march.trailing
    passages = Passages(
        mu=drag / normal,
        normal_force=normal,
        friction_force=drag,
        depth=lines.depth(size),
        leading=leading,
        trailing=trailing,
        exponent=lines.rise(leading, trailing),
        error=error,
        converged=good,
    )
    return Passages(*(field[:count] for field in passages))


def _judged(
    marches: list[_March], samples: int, load: Array | None
) -> tuple[Array, Array]:
    """Which points have an error that is small against mu, and the error of mu.

    If two changes from N to 2N samples stand as h^2 has them, the limit is off by a
    third of the last change at most; half of it is taken. Otherwise something is not
    yet resolved (where contact ends between two samples, a branch much faster than a
    sample), and the larger of three times the last change and the one before is taken.
    Measured against `solve_passages` on 3000 random points (8 branches over 11 decades,
    with and without a dashpot) it covered the true error of all but a few.
    """
    first, second, third = (march.drag / march.normal for march in marches)
    change, before = np.abs(third - second), np.abs(second - first)
    regular = np.abs(second - first - 4 * (third - second)) < 0.2 * change
    error = np.where(regular, 0.5 * change, np.maximum(3 * change, before))
    error = error + _ROUNDING * math.sqrt(samples) * np.abs(third)
    if load is not None:
        missed = [np.abs(march.normal / load - 1) for march in marches]
        error = error + np.abs(third) * (missed[-2] + missed[-1])
    good = functools.reduce(np.logical_and, (march.good for march in marches))
    return good & (error <= _SMALL * np.abs(third)), error


def _at_load(
    law: Relaxation,
    lines: AbstractLines,
    velocity: Array,
    load: Array | None,
    log_size: Array,
    samples: int,
    close: float,
) -> _March:
    """A march at the given size, or at the one that carries the load, sought from
    there.
    """
    marches: list[_March] = []

    def excess(log_size: Array) -> Array:
        marches[:] = [_march(law, lines, velocity, np.exp(log_size), samples)]
        return np.log(marches[0].normal / (1.0 if load is None else load))

    if load is None:
        excess(log_size)
        return marches[0]
    met = search(excess, log_size, close, _RISE, largest_size(lines, load))[1]
    return marches[0]._replace(good=marches[0].good & met)


@in_float64
@jax.jit
def _march(
    law: Relaxation, lines: AbstractLines, velocity: Array, size: Array, samples: Array
) -> _March:
    """One march of all points and lines."""
    entry = lines.entry(size)
    duration = (2 * entry / velocity[None]).reshape(-1)
    scaled = Relaxation(
        law.equilibrium,
        law.moduli,
        law.times[:, None] / duration[None],
        law.viscosity / duration,
    )
    solution = diffrax.diffeqsolve(
        RigidSurface(_Passing(lines, size)),
        ContactStep(_BLOCK),
        t0=0.0,
        t1=1.0,
        dt0=_BLOCK / samples,
        y0=rest(law, duration.size),
        args=scaled,
        max_steps=_MOST // _BLOCK,
        throw=False,
    )
    state = jax.tree.map(lambda saved: saved[-1], solution.ys)
    impulse, work, away = (
        integral.reshape(entry.shape)
        for integral in (state.impulse, state.work, state.away)
    )
    weight = lines.weight(size)
    normal = jnp.sum(weight * 2 * entry * impulse, axis=0)
    drag = jnp.sum(weight * work, axis=0)
    succeeded = solution.result == diffrax.RESULTS.successful
    good = succeeded & jnp.isfinite(normal) & jnp.isfinite(drag)
    return _March(size, normal, drag, (entry * (1 - 2 * away))[0], good)


@in_float64
def steady_elements(
    law: Relaxation,
    lines: AbstractLines,
    size: Float[Array, " 1"],
    velocity: Float[Array, " 1"],  # times a_T [m/s]
    per: str,
    title: str,
) -> SteadyElements:
    """The elements under a contact of this size, from rest ahead of it."""
    a = lines.entry(size)[:1]
    duration = (2 * a / velocity)[0]
    scaled = Relaxation(
        law.equilibrium,
        law.moduli,
        law.times[:, None] / duration,
        law.viscosity / duration,
    )

    def profile(x: Array) -> Array:
        line = jnp.zeros((1, 1), int)
        return lines.profile(jnp.clip(x, -a, a), size, line)[0]

    def surface(t: Array) -> Array:
        return profile(a) - profile(a * (1 - 2 * t))

    t = jnp.linspace(0.0, _FOLLOWED, _FOLLOWED * _SHOWN + 1)
    y = diffrax.diffeqsolve(
        RigidSurface(surface),
        ContactStep(_BETWEEN),
        t0=0.0,
        t1=float(_FOLLOWED),
        dt0=None,
        stepsize_controller=diffrax.StepTo(t),
        y0=rest(law, 1),
        args=scaled,
        saveat=diffrax.SaveAt(steps=True, t0=True),
        max_steps=t.size - 1,
    ).ys
    assert y is not None
    felt = forces(scaled, y)

    def shown(values: Array) -> np.ndarray:
        return np.asarray(values)[::-1, ..., 0].T

    return SteadyElements(
        x=np.asarray((a * (1 - 2 * t))[0, ::-1]),
        surface=np.asarray(jax.vmap(surface)(t))[::-1, 0],
        u=shown(y.u),
        q=shown(felt.q),
        branches=shown(felt.branches),
        spring=shown(felt.spring),
        per=per,
        title=title,
    )
