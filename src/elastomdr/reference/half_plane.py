"""Steady sliding of a cylinder on a viscoelastic half-plane (Hunter's problem), solved
on a line of cells.
"""

from __future__ import annotations

import functools
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, argmax, in_float64, positive, scalar
from ..element.law import as_foundation
from ..errors import ConvergenceWarning, InputError
from ..material.relaxation import KelvinChain, Relaxation, to_kelvin
from ..results.curve import Contact, HalfPlaneCurve
from .contact import LEADS, grid, settle, work_against
from .kernel import sliding_kernel, strip_cell
from .points import NOT_COMPARED, broadcast

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import Material

MODEL = "half-plane (plane strain), cells of constant pressure (no reduction)"
_WINDOWS = 8  # windows tried until the contact lies well inside


class _Found(NamedTuple):
    """One contact on one grid."""

    mu: Float[Array, ""]
    edges: Float[Array, "2"]  # trailing, leading [m]
    settled: Array
    inside: Array


_FAILED = _Found(
    np.array(np.nan), np.full(2, np.nan), np.asarray(False), np.asarray(True)
)


@in_float64
def half_plane_sliding(
    material: Material,
    radius: Number,
    *,
    velocity: ArrayLike,
    load_per_length: ArrayLike,
    temperature: ArrayLike | None = None,
    points: int = 1024,
) -> HalfPlaneCurve:
    """Friction of a long cylinder in steady, frictionless sliding across its axis on a
    half-plane (plane strain).

    Args:
        material: a material, or a `Foundation` of E*.
        radius: radius of the cylinder [m].
        velocity: sliding velocity [m/s]; arguments broadcast.
        load_per_length: normal force per length of the cylinder [N/m].
        temperature: temperature [K], for a material with a shift law.
        points: cells of the grid.

    Returns:
        A curve of the broadcast shape, without depth: displacements of a half-plane
        hold to a constant only. `error` is an estimate, twice the largest change of mu
        from three eighths, half and three quarters as many cells to all of them. Points
        that did not settle are NaN and counted in one `ConvergenceWarning`.

    Raises:
        InputError: for values that are not positive, and for a liquid.

    Exact but for the grid, see `half_space_sliding`.

    Source: the problem is that of Hunter 1961, there for one relaxation time.
    """
    foundation = as_foundation(material)
    if foundation.per_area:
        raise InputError(
            "material must be a half-space, got a layer: em.friction is exact for "
            "layers."
        )
    radius = scalar("radius", radius)
    positive("radius", radius)
    scene = broadcast(
        foundation,
        velocity=velocity,
        load_per_length=load_per_length,
        temperature=temperature,
        points=points,
    )
    at, law = scene.at, foundation.law()
    chain = to_kelvin(law)
    found = [
        _one(float(radius), law, chain, w, v, points)
        for w, v in zip(scene.value, scene.velocity, strict=True)
    ]
    good = np.array([bool(fine.settled) for fine, _ in found])
    if not good.all():
        warnings.warn(
            (
                f"{int((~good).sum())} of {good.size} contacts did not settle; they "
                "are NaN."
            ),
            ConvergenceWarning,
            stacklevel=3,
        )

    def field(values: list[Any]) -> Any:
        return np.where(good, np.array([float(v) for v in values]), np.nan).reshape(
            at.shape
        )

    fine = [pair[0] for pair in found]
    mu = field([f.mu for f in fine])
    load = (scene.value * scene.vertical).reshape(at.shape)
    rows = scene.inputs(("shape", f"cylinder, radius {float(radius):g} m"), load="N/m")
    return HalfPlaneCurve(
        velocity=at.full(at.velocity),
        mu=mu,
        load_per_length=load,
        friction_per_length=mu * load,
        contact=Contact(
            field([f.edges[1] for f in fine]), field([-f.edges[0] for f in fine])
        ),
        error=field([error for _, error in found]),
        converged=good.reshape(at.shape),
        temperature=at.full(at.kelvin),
        model=MODEL,
        plan=(
            f"{points} cells; three eighths, half and three quarters as many for the "
            "error"
        ),
        inputs=(*rows, NOT_COMPARED),
    )


def _one(
    radius: float,
    law: Relaxation,
    chain: KelvinChain,
    load: float,
    velocity: float,
    points: int,
) -> tuple[_Found, Any]:
    """A contact, and the estimated error of its mu."""
    # Hertz, the widest that there can be
    relaxed = float(np.sqrt(4 * load * radius / (np.pi * law.equilibrium)))
    window = np.array([-1.2 * relaxed, 1.2 * relaxed])
    for lead in LEADS:
        solve = functools.partial(_solve, radius, law, chain, load, velocity, lead=lead)
        rough = solve(window, 0.5 * window, count=128)
        # a glassy contact is narrow: look closer until it fills half of the window
        for _ in range(_WINDOWS):
            if not bool(rough.settled):
                break
            length = float(rough.edges[1] - rough.edges[0])
            window, before = (
                np.array(
                    [rough.edges[0] - 0.1 * length, rough.edges[1] + 0.1 * length]
                ),
                window,
            )
            if bool(rough.inside) and window[1] - window[0] > 0.5 * (
                before[1] - before[0]
            ):
                break
            rough = solve(window, rough.edges, count=128)
        if not bool(rough.settled):
            continue
        coarse = [
            solve(window, rough.edges, count=count)
            for count in (3 * points // 8, 3 * points // 4, points // 2)
        ]
        fine = solve(window, coarse[-1].edges, count=points)
        if all(bool(one.settled & one.inside) for one in (*coarse, fine)):
            return fine, 2 * max(abs(fine.mu - one.mu) for one in coarse)
    return _FAILED, np.nan


@functools.partial(jax.jit, static_argnames=("count",))
def _solve(
    radius, law, chain, load, velocity, window, edges, *, count: int, lead: Array
) -> _Found:
    length = window[1] - window[0]
    h = length / count
    x = window[0] + h * (jnp.arange(count) + 0.5)

    # any will do; this keeps the kernel positive
    far = 4 * length + velocity * jnp.max(chain.times, initial=0.0)

    def elastic(at):
        return strip_cell(at[:, None], h, far)

    def kernel_of(lead):
        return sliding_kernel(elastic, chain, velocity, h, count, lead)

    kernel = kernel_of(lead)
    height = ((x - lead * h) ** 2 / (2 * radius))[:, None]
    on = grid(kernel.displacement, law, velocity, (h, h), lead)
    begin = ((x > edges[0]) & (x < edges[1]))[:, None]
    solution = settle(on, height, begin, "load", load / h)
    p = solution.pressure
    # from centre to centre
    slope = jax.lax.cond(lead == 0, lambda: kernel.slope, lambda: kernel_of(0.0).slope)
    mu = work_against(slope, p) * h / load
    touching = (p > 0)[:, 0]
    # The pressure falls as the root of the distance: its square meets zero along a line
    # through the last two cells.
    square = p[:, 0] ** 2
    first, last = argmax(touching), count - 1 - argmax(touching[::-1])
    trailing = x[first] - h * jnp.clip(
        square[first] / (square[first + 1] - square[first]), 0.0, 1.0
    )
    leading = x[last] + h * jnp.clip(
        square[last] / (square[last - 1] - square[last]), 0.0, 1.0
    )
    return _Found(
        mu,
        jnp.stack([trailing, leading]),
        solution.settled,
        ~(touching[0] | touching[-1]),
    )
