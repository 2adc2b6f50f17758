"""Steady sliding of a cylinder on a viscoelastic half-plane (Hunter's problem), solved
on a line of cells.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..call.problem import Asked
from ..checks import as_float64, numpy_unless_traced, positive, scalar, warn_unless
from ..element.law import Foundation, as_foundation
from ..material.relaxation import KelvinChain, Relaxation, to_kelvin
from ..results.curve import Contact, HalfPlaneCurve
from ..rough.half_space import EXACT, settle
from .kernel import LEADS, convolution, sliding_kernel, strip_cell, work_against
from .points import NOT_COMPARED, needs_half_space, points_of

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import Material

MODEL = "half-plane (plane strain), cells of constant pressure (no reduction)"
_WINDOWS = 8  # windows tried until the contact lies well inside


class _CylinderContact(NamedTuple):
    """One contact on one grid."""

    mu: float
    edges: Float[np.ndarray, "2"]  # trailing, leading [m]
    settled: bool
    inside: bool


class _Problem(NamedTuple):
    """A cylinder under a load."""

    radius: float  # [m]
    law: Relaxation
    chain: KelvinChain
    load: float  # per length [N/m]
    velocity: float  # times a_T [m/s]


_FAILED = _CylinderContact(np.nan, np.full(2, np.nan), False, True)


@numpy_unless_traced
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
        that did not converge are NaN and counted in one `ConvergenceWarning`.

    Raises:
        InputError: for values that are not positive, and for a liquid.

    Exact but for the grid, see `half_space_sliding`.

    Source: the problem is that of Hunter 1961, there for one relaxation time.
    """
    foundation, cylinder_radius = _check(material, radius)
    load = as_float64("load_per_length", load_per_length)
    positive("load_per_length", load)
    scene = points_of(
        foundation, Asked(velocity, load, temperature=temperature), points
    )
    steady, law = scene.steady, foundation.law()
    chain = to_kelvin(law)
    contacts, errors = zip(
        *(
            _point(_Problem(float(cylinder_radius), law, chain, w, v), points)
            for w, v in zip(scene.value, scene.velocity, strict=True)
        ),
        strict=True,
    )
    good = np.array([contact.settled for contact in contacts])
    warn_unless(good, "contacts")

    def field(values: Iterable[Any]) -> Any:
        return scene.field(good, values)

    mu = field(contact.mu for contact in contacts)
    load = (scene.value * scene.vertical).reshape(steady.shape)
    rows = scene.inputs(
        ("shape", f"cylinder, radius {float(cylinder_radius):g} m"), load="N/m"
    )
    return HalfPlaneCurve(
        velocity=steady.full(steady.velocity),
        mu=mu,
        load_per_length=load,
        friction_per_length=mu * load,
        contact=Contact(
            field(contact.edges[1] for contact in contacts),
            field(-contact.edges[0] for contact in contacts),
        ),
        error=field(errors),
        converged=good.reshape(steady.shape),
        temperature=steady.full(steady.temperature),
        model=MODEL,
        plan=(
            f"{points} cells; three eighths, half and three quarters as many for the "
            "error"
        ),
        inputs=(*rows, NOT_COMPARED),
    )


def _check(material: Material, radius: Number) -> tuple[Foundation, Any]:
    """The half-space and the radius. Raises `InputError`."""
    foundation = as_foundation(material)
    needs_half_space(foundation)
    radius = scalar("radius", radius)
    positive("radius", radius)
    return foundation, radius


def _point(problem: _Problem, points: int) -> tuple[_CylinderContact, float]:
    """A contact, and the estimated error of its mu."""
    # Hertz, the widest that there can be
    relaxed = 2 * np.sqrt(
        problem.load * problem.radius / (np.pi * float(problem.law.equilibrium))
    )
    for lead in LEADS:
        window, rough = _near_contact(problem, 1.2 * relaxed, lead)
        if not rough.settled:
            continue
        coarse = [
            _solve(problem, window, rough.edges, count, lead)
            for count in (3 * points // 8, 3 * points // 4, points // 2)
        ]
        fine = _solve(problem, window, coarse[-1].edges, points, lead)
        if all(one.settled and one.inside for one in (*coarse, fine)):
            return fine, 2 * max(abs(fine.mu - one.mu) for one in coarse)
    return _FAILED, np.nan


def _near_contact(
    problem: _Problem, widest: float, lead: float
) -> tuple[np.ndarray, _CylinderContact]:
    """A window that the contact fills by half at least, and the contact there on coarse
    cells: a glassy one is narrow.
    """
    window = np.array([-widest, widest])
    rough = _solve(problem, window, 0.5 * window, 128, lead)
    for _ in range(_WINDOWS):
        if not rough.settled:
            break
        before, length = window, rough.edges[1] - rough.edges[0]
        window = rough.edges + 0.1 * length * np.array([-1.0, 1.0])
        if rough.inside and np.ptp(window) > 0.5 * np.ptp(before):
            break
        rough = _solve(problem, window, rough.edges, 128, lead)
    return window, rough


def _solve(
    problem: _Problem, window: np.ndarray, edges: np.ndarray, count: int, lead: float
) -> _CylinderContact:
    """The contact on `count` cells of a window, begun between `edges`."""
    length = window[1] - window[0]
    h = length / count
    x = window[0] + h * (np.arange(count) + 0.5)
    # any will do; this keeps the kernel positive
    slowest = np.max(problem.chain.times, initial=0.0)
    far = 4 * length + problem.velocity * slowest

    def kernel_of(lead: float) -> Any:
        def elastic(places: np.ndarray) -> np.ndarray:
            return strip_cell(places[:, None], h, far)

        return sliding_kernel(elastic, problem.chain, problem.velocity, h, count, lead)

    kernel = kernel_of(lead)
    contact = settle(
        convolution(kernel.displacement, problem.law, problem.velocity, (h, h), lead),
        -((x - lead * h) ** 2 / (2 * problem.radius))[:, None],
        ((x > edges[0]) & (x < edges[1]))[:, None].astype(float),
        EXACT,
        load=problem.load / h,
    )
    # the force acts from centre to centre
    slope = kernel.slope if lead == 0 else kernel_of(0.0).slope
    mu = work_against(slope, contact.pressure) * h / problem.load
    pressure = contact.pressure[:, 0]
    touching = np.flatnonzero(pressure > 0)
    if touching.size < 2:
        return _FAILED
    first, last = touching[0], touching[-1]
    # The pressure falls as the root of the distance: its square meets zero along a line
    # through the last two cells.
    square = pressure**2

    def beyond(end: int, inner: int) -> float:
        return h * np.clip(square[end] / (square[inner] - square[end]), 0.0, 1.0)

    ends = x[first] - beyond(first, first + 1), x[last] + beyond(last, last - 1)
    inside = first > 0 and last < count - 1
    return _CylinderContact(mu, np.array(ends), contact.settled, inside)
