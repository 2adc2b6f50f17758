"""Steady sliding on a three-dimensional viscoelastic half-space, solved on a grid of
cells.
"""

from __future__ import annotations

import functools
import warnings
from typing import TYPE_CHECKING, Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from ..checks import Array, in_float64
from ..element.law import Foundation, as_foundation
from ..errors import ConvergenceWarning, InputError
from ..material.relaxation import Relaxation, scaled, to_kelvin
from ..results.curve import Contact, FrictionCurve, HalfSpaceCurve
from ..results.words import describe
from ..smooth.passage import Control, estimate_sizes
from ..surface.lines import SingleLine
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch
from ..trees import replaced
from .contact import LEADS, grid, settle, work_against
from .kernel import area_cell, sliding_kernel
from .periodic import slide_periodic
from .points import NOT_COMPARED, Points, broadcast

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike
    from ..call.types import Indenter, Material

MODEL = "half-space in three dimensions, cells of constant pressure (no reduction)"
_WINDOWS = 8  # windows tried until the contact lies well inside
_FEWEST = 8  # cells that touch in the first window, below which it is far too wide
_ENDS = 13.9  # thicknesses of a layer beyond which its surface does not move
# of the change of mu with the grid, which is of first order where the loss is small,
# and not smooth
_SAFETY = 2.0


class _Found(NamedTuple):
    """One contact on one grid."""

    mu: Float[Array, ""]
    force: Float[Array, ""]  # normal force [N]
    depth: Float[Array, ""]  # [m]
    # trailing, leading on the central line; rearmost, foremost of all [m]
    edges: Float[Array, "4"]
    half_width: Float[Array, ""]  # across the motion [m]
    touching: Bool[Array, "along across"]
    # of contact, the staircase of its border corrected as in `rough.half_space` [m^2]
    area: Float[Array, ""]
    settled: Array
    inside: Array  # no cell at the border of the window is in contact

    def in_metres(self, unit: float, stiff: float) -> _Found:
        """Lengths from `unit`, and stresses from `stiff`, into SI units."""
        lengths = {
            name: getattr(self, name) * unit
            for name in ("depth", "edges", "half_width")
        }
        return self._replace(
            force=self.force * unit * unit * stiff,
            area=self.area * unit * unit,
            **lengths,
        )


_NAN = np.array(np.nan)
_FAILED = _Found(
    _NAN,
    _NAN,
    _NAN,
    np.full(4, np.nan),
    _NAN,
    np.zeros((1, 1), bool),
    _NAN,
    np.asarray(False),
    np.asarray(True),
)


@in_float64
def half_space_sliding(
    material: Material,
    shape: Indenter | ArrayLike,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    points: int = 64,
    cell: tuple[float, float] | None = None,
) -> FrictionCurve | HalfSpaceCurve:
    """Friction of a rigid body in steady, frictionless sliding on a half-space, in
    three dimensions.

    Args:
        material: a material, or a `Foundation` of E*.
        shape: an axisymmetric body; or, with `cell`, a map of heights (n_x, n_y) [m],
            positive into the rubber, x along the motion.
        velocity: sliding velocity [m/s]; arguments broadcast.
        load: normal force [N]; in a cell that of one cell.
        depth: depth [m] in place of a load; not in a cell, where the mean displacement
            is not defined.
        temperature: temperature [K], for a material with a shift law.
        points: cells along each side of the window around the contact.
        cell: sides (L_x, L_y) [m] of a periodic cell with one body, or one map, in
            each.

    Returns:
        A curve of the broadcast shape; `contact` has the edges on the central line, to
        half a cell. `error` is an estimate, twice the larger change of mu from half and
        from three eighths as many cells to all of them; in a cell the change from every
        second point of the map, which may be small by chance. Points whose contact does
        not settle, or reaches the end of the body (the equator of a sphere, the last
        point of a profile), are NaN and counted in one `ConvergenceWarning`.

    Raises:
        InputError: for neither or both of load and depth, and for a liquid, which has
            no steady state here.

    Exact but for the grid of cells of constant pressure: with the influence function of
    a cell that slides (`elastomdr.reference.kernel`) the body is alone on an infinite
    surface and never meets its wake. In a cell it meets those of its neighbours
    (`elastomdr.reference.periodic`). The friction force is what the material
    dissipates. A point takes 50 ms to 1 s, longest with a glassy modulus a thousand
    times the relaxed one.
    """
    foundation = as_foundation(material)
    if foundation.per_area:
        raise InputError(
            "material must be a half-space, got independent springs, for which "
            "em.friction is exact."
        )
    if cell is not None:
        if depth is not None:
            raise InputError(
                "depth has no meaning in a periodic cell, give load; got "
                f"depth={depth}."
            )
        return slide_periodic(
            foundation,
            shape,
            cell=cell,
            velocity=velocity,
            load=load,
            temperature=temperature,
            points=points,
        )
    return slide(
        foundation, shape, velocity, load, depth, temperature, points, None, MODEL
    )


def slide(
    foundation: Foundation,
    shape: Any,
    velocity: Any,
    load: Any,
    depth: Any,
    temperature: Any,
    points: int,
    cover: Any,
    model: str,
) -> FrictionCurve:
    """One isolated body; `cover` is None on a half-space, or what a layer changes
    (`reference.layer`).
    """
    if not isinstance(shape, AbstractShape) or isinstance(shape, (Cylinder, FlatPunch)):
        raise InputError(
            "shape must be an axisymmetric body with a smooth edge (em.Paraboloid, "
            "em.Sphere, em.Cone, em.PowerLaw, em.Profile), or a map of heights with "
            f"its cell, got {shape!r}."
        )
    law = foundation.law()
    scene = broadcast(
        foundation,
        velocity=velocity,
        load=load,
        depth=depth,
        temperature=temperature,
        points=points,
    )
    at = scene.at
    found = [_one(shape, law, scene, cover, i) for i in range(scene.velocity.size)]
    good = np.array([bool(fine.settled) for fine, _ in found])

    def field(values: list[Any]) -> Any:
        return np.where(good, np.array([float(v) for v in values]), np.nan).reshape(
            at.shape
        )

    if not good.all():
        warnings.warn(
            f"{int((~good).sum())} of {good.size} contacts did not settle; they are "
            "NaN. More points resolve a thinner "
            "glassy zone; a contact that reaches the end of the body has no answer.",
            ConvergenceWarning,
            stacklevel=4,
        )
    fine = [pair[0] for pair in found]
    force = field([f.force for f in fine]) * at.vertical
    mu = field([f.mu for f in fine])
    return FrictionCurve(
        velocity=at.full(at.velocity),
        mu=mu,
        normal_force=force,
        friction_force=mu * force,
        depth=field([f.depth for f in fine]),
        contact_area=field([f.area for f in fine]),
        contact=Contact(
            field([f.edges[1] for f in fine]), field([-f.edges[0] for f in fine])
        ),
        error=field([error for _, error in found]),
        converged=good.reshape(at.shape),
        temperature=at.full(at.kelvin),
        model=model,
        plan=grid_words(points),
        inputs=(*scene.inputs(("shape", describe(shape))), NOT_COMPARED),
    )


def grid_words(points: int) -> str:
    """The grids of one point, for results and plans."""
    return f"{points} by {points} cells; half as many and three eighths for the error"


def _one(
    shape: AbstractShape, law: Relaxation, scene: Points, cover: Any, i: int
) -> tuple[_Found, float]:
    """A point on the full grid, and how far mu may be off for the grid: from half of it
    and from three eighths.
    """
    value, velocity = scene.value[i], scene.velocity[i]
    size = estimate_sizes(
        law,
        SingleLine(shape),
        scene.control,
        scene.value[i : i + 1],
        scene.velocity[i : i + 1],
    )
    size = float(np.asarray(size)[0])
    if not 0 < size < np.inf:
        return _FAILED, np.nan
    # Solved with lengths in this size and stresses in the relaxed modulus: the sums
    # over cells hold in any units.
    stiff = float(law.equilibrium)
    law = scaled(law, 1 / stiff)
    chain, velocity = to_kelvin(law), velocity / size
    value = value / size if scene.control == "depth" else value / size / size / stiff
    cover = None if cover is None else replaced(cover, thickness=cover.thickness / size)
    round_start = _round(32)
    for lead in LEADS:
        # anew: one that did not settle may have led astray
        window = np.array([-1.6, 1.6, 1.6])
        solve = functools.partial(
            _solve,
            shape,
            size,
            law,
            chain,
            scene.control,
            value,
            velocity,
            cover,
            lead=lead,
        )
        rough = solve(window, round_start)
        for _ in range(_WINDOWS):
            if bool(rough.inside):
                break
            window = 1.5 * window
            rough = solve(window, round_start)
        if (
            not bool(rough.settled & rough.inside)
            or int(rough.touching.sum()) < _FEWEST
        ):
            continue
        # at least 1.4 cells of the coarser grid
        margin = max(0.1, 1.4 / (scene.cells / 4 - 1.4))
        beyond = margin * float(rough.edges[3] - rough.edges[2])
        closer = np.array(
            [
                rough.edges[2] - beyond,
                rough.edges[3] + beyond,
                (1 + margin) * rough.half_width,
            ]
        )
        coarse = solve(closer, _seen(rough.touching, window, closer, scene.cells // 2))
        fine = solve(closer, _seen(coarse.touching, closer, closer, scene.cells))
        if bool(coarse.settled & fine.settled & coarse.inside & fine.inside):
            third = solve(
                closer, _seen(coarse.touching, closer, closer, 3 * scene.cells // 8)
            )
            others = [coarse, third] if bool(third.settled & third.inside) else [coarse]
            error = _SAFETY * max(abs(float(fine.mu - other.mu)) for other in others)
            return fine.in_metres(size, stiff), error
    return _FAILED, np.nan


def _round(count: int) -> Bool[np.ndarray, "count count"]:
    """The contact to begin with: the cells about the middle, 30 % of all."""
    x = np.arange(count) - 0.5 * (count - 1)
    r = np.hypot(x[:, None], x[None])
    return r < np.quantile(r, 0.3)


def _seen(
    touching: Array, window: Array, closer: Array, count: int
) -> Bool[np.ndarray, "count count"]:
    """The contact in one window, on the cells of another: each as the cell there in
    which its centre lies.
    """
    cells, centres = touching.shape[0], (np.arange(count) + 0.5) / count
    x = closer[0] + (closer[1] - closer[0]) * centres
    i = np.floor((x - window[0]) / (window[1] - window[0]) * cells)
    j = np.floor((0.5 + (centres - 0.5) * closer[2] / window[2]) * cells)
    i, j = (np.clip(k, 0, cells - 1).astype(int) for k in (i, j))
    return np.asarray(touching)[np.ix_(i, j)]


@functools.partial(jax.jit, static_argnames=("control",))
def _solve(
    shape,
    unit,
    law,
    chain,
    control: Control,
    value,
    velocity,
    cover,
    window,
    start,
    *,
    lead: Array,
) -> _Found:
    """The contact in a window from window[0] to window[1] along the motion, and
    window[2] to either side.

    Lengths are in `unit` [m], but those of the shape, and stresses in the relaxed
    modulus.
    """
    largest = shape.largest_contact / unit
    count = start.shape[0]
    h, width = (window[1] - window[0]) / count, 2 * window[2] / count
    x = window[0] + h * (jnp.arange(count) + 0.5)
    y = width * (jnp.arange(count) - 0.5 * (count - 1))
    across = jnp.arange(count) * width

    def elastic(at):
        whole = area_cell(at[:, None], across[None], h, width)
        if cover is None:
            return whole
        r = jnp.hypot(at[:, None], across[None])
        return jnp.where(
            r < _ENDS * cover.thickness, whole - cover.less(r, (h, width)), 0.0
        )

    def of_cells(lead):
        return sliding_kernel(elastic, chain, velocity, h, count, lead)

    kernel = of_cells(lead)
    r = jnp.hypot((x - lead * h)[:, None], y[None])
    height = shape._height(jnp.minimum(r, largest * (1 - 1e-9)) * unit) / unit
    beyond = r >= largest
    height = jnp.where(beyond, 1e3 * (window[1] - window[0]), height)
    on = grid(kernel.displacement, law, velocity, (h, width), lead, cover)
    solution = settle(
        on, height, start, control, value / (h * width) if control == "load" else value
    )
    p = solution.pressure
    # not at the end of the body
    whole = ~jnp.any((p > 0) & (r > largest - jnp.hypot(h, width)))
    force = jnp.sum(p) * h * width
    # from centre to centre
    slope = jax.lax.cond(lead == 0, lambda: kernel.slope, lambda: of_cells(0.0).slope)
    mu = work_against(slope, p) * h * width / force
    touching = p > 0
    line = touching[:, count // 2]
    edges = [
        jnp.min(jnp.where(line, x, jnp.inf)) - h / 2,
        jnp.max(jnp.where(line, x, -jnp.inf)) + h / 2,
    ]
    every = jnp.any(touching, axis=1)
    edges += [
        jnp.min(jnp.where(every, x, jnp.inf)) - h / 2,
        jnp.max(jnp.where(every, x, -jnp.inf)) + h / 2,
    ]
    half_width = (
        jnp.max(jnp.where(jnp.any(touching, axis=0), jnp.abs(y), 0.0)) + width / 2
    )
    border = jnp.any(touching[jnp.array([0, -1])]) | jnp.any(
        touching[:, jnp.array([0, -1])]
    )
    steps = sum(jnp.sum(jnp.diff(touching.astype(int), axis=i) != 0) for i in (0, 1))
    area = (jnp.sum(touching) - (jnp.pi - 1 + jnp.log(2.0)) / 24 * steps) * h * width
    return _Found(
        mu,
        force,
        solution.depth,
        jnp.stack(edges),
        half_width,
        touching,
        area,
        solution.settled & whole,
        ~border,
    )
