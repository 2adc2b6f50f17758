"""Steady sliding on a three-dimensional viscoelastic half-space or layer, solved on a
grid of cells: of one body, or of a periodic map of heights or array of bodies.

Every body of an array meets the wakes of those before it. What the contact of a map
decides is the separation, the mean distance of the two surfaces: the mean displacement
of a periodic half-space is not defined.

A layer is stiffer than a half-space by a smooth part of the influence function of a
point,

    u(r) = P/(pi E*) [1/r - (1/h) n(r/h)],    n(y) = int_0^inf (1 - W(z)) J_0(z y) dz,

which is kept as Chebyshev series on short panels. W is odd in z, so that the whole of u
falls exponentially beyond a few thicknesses, and is taken as zero from y = 14 on.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..call.problem import Asked, doubt_depth
from ..checks import as_float64, numpy_unless_traced, positive, warn_unless
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer, layer_deficit
from ..errors import InputError
from ..material.relaxation import KelvinChain, Relaxation, scaled, to_kelvin
from ..numerics.quadrature import gauss_on_panels
from ..results.curve import Contact, FrictionCurve, HalfSpaceCurve
from ..results.words import brief, describe
from ..rough.adhesion import AdhesiveShear, on_cells
from ..rough.half_space import EXACT, area_of, settle, solve
from ..smooth.passage import estimate_sizes
from ..smooth.problem import SmoothCall, no_pressure
from ..smooth.softening import LINEAR
from ..surface.lines import SingleLine
from ..surface.shapes import AbstractShape, Cylinder, FlatPunch
from ..trees import Tree, replaced, static
from .kernel import (
    LEADS,
    Kernel,
    area_cell,
    convolution,
    sliding_kernel,
    work_against,
)
from .points import NOT_COMPARED, ReferencePoints, needs_half_space, points_of

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike
    from ..call.types import Indenter, Material

_MODEL = "half-space in three dimensions, cells of constant pressure (no reduction)"
_LAYER_MODEL = "layer in three dimensions, cells of constant pressure (no reduction)"
_PERIODIC = (
    "periodic half-space in three dimensions, one pressure per point of the map (no "
    "reduction)"
)
_ADVICE = (
    "More points resolve a thinner glassy zone; a contact that reaches the end of the "
    "body has no answer."
)
_WINDOWS = 8  # windows tried until the contact lies well inside
_FEWEST = 8  # cells that touch in the first window, below which it is far too wide
# the smooth part of a layer: its end and panels in thicknesses, and its degree on them
_FAR, _PANEL, _DEGREE = 14.0, 0.5, 9
_ENDS = 13.9  # thicknesses of a layer beyond which its surface does not move
# of the change of mu with the grid, which is of first order where the loss is small,
# and not smooth
_SAFETY = 2.0


class _BodyContact(NamedTuple):
    """The contact of one body on one grid."""

    mu: float
    force: float  # normal force [N]
    depth: float  # [m]
    # trailing, leading on the central line; rearmost, foremost of all [m]
    edges: Float[np.ndarray, "4"]
    half_width: float  # across the motion [m]
    touching: Bool[np.ndarray, "along across"]
    # of contact, the staircase of its border corrected as in `rough.half_space` [m^2]
    area: float
    settled: bool
    inside: bool  # no cell at the border of the window is in contact

    def in_metres(self, unit: float, stiff: float) -> _BodyContact:
        """Lengths from `unit`, and stresses from `stiff`, into SI units."""
        return self._replace(
            force=self.force * unit * unit * stiff,
            depth=self.depth * unit,
            edges=self.edges * unit,
            half_width=self.half_width * unit,
            area=self.area * unit * unit,
        )


class _CellProblem(NamedTuple):
    """A body under a load or at a depth, its lengths in `unit` [m], but those of the
    shape, and its stresses in the relaxed modulus.
    """

    shape: AbstractShape
    unit: float
    law: Relaxation
    chain: KelvinChain
    load: float | None
    depth: float | None
    velocity: float
    cover: Any  # what a layer changes, or None


_FAILED = _BodyContact(
    np.nan,
    np.nan,
    np.nan,
    np.full(4, np.nan),
    np.nan,
    np.zeros((1, 1), bool),
    np.nan,
    False,
    True,
)


@numpy_unless_traced
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
    (`elastomdr.rough.half_space`). The friction force is what the material
    dissipates. A point takes 50 ms to 1 s, longest with a glassy modulus a thousand
    times the relaxed one.
    """
    foundation = as_foundation(material)
    asked = Asked(velocity, load, depth, temperature=temperature)
    needs_half_space(foundation)
    if cell is not None:
        if depth is not None:
            raise InputError(
                argument="depth",
                got=depth,
                accepted="left out in a periodic cell",
                hint="give load",
            )
        return slide_periodic(foundation, shape, cell, asked, points)
    return slide(foundation, shape, asked, points, None, _MODEL)


def slide(
    foundation: Foundation,
    shape: Indenter | ArrayLike,
    asked: Asked,
    points: int,
    cover: CoverOfCells | None,
    model: str,
) -> FrictionCurve:
    """One isolated body; `cover` is None on a half-space, or what a layer changes
    (`CoverOfCells`).
    """
    if not isinstance(shape, AbstractShape) or isinstance(shape, (Cylinder, FlatPunch)):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="an axisymmetric body with a smooth edge (em.Paraboloid, "
            "em.Sphere, em.Cone, em.PowerLaw, em.Profile), or a map of heights with "
            "its cell",
        )
    scene = points_of(foundation, asked, points)
    law, steady = foundation.law(), scene.steady
    contacts, errors = zip(
        *(_point(shape, law, scene, cover, i) for i in range(scene.velocity.size)),
        strict=True,
    )
    good = np.array([contact.settled for contact in contacts])
    warn_unless(good, "contacts", reason=_ADVICE)

    def field(values: Iterable[Any]) -> Any:
        return scene.field(good, values)

    force = field(contact.force for contact in contacts) * steady.vertical
    mu = field(contact.mu for contact in contacts)
    leading = field(contact.edges[1] for contact in contacts)
    return FrictionCurve(
        velocity=steady.full(steady.velocity),
        mu=mu,
        normal_force=force,
        friction_force=mu * force,
        depth=field(contact.depth for contact in contacts),
        contact_area=field(contact.area for contact in contacts),
        contact=Contact(
            leading,
            field(-contact.edges[0] for contact in contacts),
        ),
        error=field(errors),
        converged=good.reshape(steady.shape),
        marks=doubt_depth(foundation, shape, shape._profile(leading)),
        temperature=steady.full(steady.temperature),
        model=model,
        plan=grid_words(points),
        inputs=(*scene.inputs(("shape", describe(shape))), NOT_COMPARED),
    )


def grid_words(points: int) -> str:
    """The grids of one point, for results and plans."""
    return f"{points} by {points} cells; half as many and three eighths for the error"


def _point(
    shape: AbstractShape,
    law: Relaxation,
    scene: ReferencePoints,
    cover: CoverOfCells | None,
    i: int,
) -> tuple[_BodyContact, float]:
    """A point on the full grid, and how far mu may be off for the grid."""
    value, velocity = scene.value[i : i + 1], scene.velocity[i : i + 1]
    sizes = estimate_sizes(law, SingleLine(shape), scene.control, value, velocity)
    size, stiff = float(np.asarray(sizes)[0]), float(law.equilibrium)
    if not 0 < size < np.inf:
        return _FAILED, np.nan
    # Solved with lengths in this size and stresses in the relaxed modulus: the sums
    # over cells hold in any units.
    law, given = scaled(law, 1 / stiff), float(value[0]) / size
    by_depth = scene.control == "depth"
    problem = _CellProblem(
        shape,
        size,
        law,
        to_kelvin(law),
        None if by_depth else given / size / stiff,
        given if by_depth else None,
        float(velocity[0]) / size,
        None if cover is None else replaced(cover, thickness=cover.thickness / size),
    )
    for lead in LEADS:
        # anew: one that did not settle may have led astray
        window, coarse = _near_contact(problem, lead)
        if window is not None:
            fine, error = _on_fine_cells(problem, lead, window, coarse, scene.cells)
            if fine.settled:
                return fine.in_metres(size, stiff), error
    return _FAILED, np.nan


def _near_contact(
    problem: _CellProblem, lead: float
) -> tuple[np.ndarray | None, _BodyContact]:
    """The window in which the contact lies, and the contact there on coarse cells; None
    where it does not settle.
    """
    window = np.array([-1.6, 1.6, 1.6])
    rough = _solve(problem, window, _round(32), lead)
    for _ in range(_WINDOWS):
        if rough.inside:
            break
        window = 1.5 * window
        rough = _solve(problem, window, _round(32), lead)
    enough = rough.settled and rough.inside and int(rough.touching.sum()) >= _FEWEST
    return window if enough else None, rough


def _on_fine_cells(
    problem: _CellProblem,
    lead: float,
    window: np.ndarray,
    rough: _BodyContact,
    cells: int,
) -> tuple[_BodyContact, float]:
    """The contact on `cells` to a side close around that of a first window, and how far
    its mu may be off, from half and from three eighths as many cells.
    """
    # at least 1.4 cells of the coarser grid
    margin = max(0.1, 1.4 / (cells / 4 - 1.4))
    beyond = margin * float(rough.edges[3] - rough.edges[2])
    closer = np.array(
        [
            rough.edges[2] - beyond,
            rough.edges[3] + beyond,
            (1 + margin) * rough.half_width,
        ]
    )

    def solved(count: int, start: _BodyContact, of: np.ndarray) -> _BodyContact:
        begun = _seen(start.touching, of, closer, count)
        return _solve(problem, closer, begun, lead)

    coarse = solved(cells // 2, rough, window)
    fine = solved(cells, coarse, closer)
    if not (coarse.settled and fine.settled and coarse.inside and fine.inside):
        return _FAILED, np.nan
    third = solved(3 * cells // 8, coarse, closer)
    others = [coarse, third] if third.settled and third.inside else [coarse]
    return fine, _SAFETY * max(abs(fine.mu - other.mu) for other in others)


def _round(count: int) -> Bool[np.ndarray, "count count"]:
    """The contact to begin with: the cells about the middle, 30 % of all."""
    x = np.arange(count) - 0.5 * (count - 1)
    r = np.hypot(x[:, None], x[None])
    return r < np.quantile(r, 0.3)


def _seen(
    touching: np.ndarray, window: np.ndarray, closer: np.ndarray, count: int
) -> Bool[np.ndarray, "count count"]:
    """The contact in one window, on the cells of another: each as the cell there in
    which its centre lies.
    """
    cells, centres = touching.shape[0], (np.arange(count) + 0.5) / count
    x = closer[0] + (closer[1] - closer[0]) * centres
    i = np.floor((x - window[0]) / (window[1] - window[0]) * cells)
    j = np.floor((0.5 + (centres - 0.5) * closer[2] / window[2]) * cells)
    i, j = (np.clip(k, 0, cells - 1).astype(int) for k in (i, j))
    return touching[np.ix_(i, j)]


def _solve(
    problem: _CellProblem, window: np.ndarray, start: np.ndarray, lead: float
) -> _BodyContact:
    """The contact in a window from window[0] to window[1] along the motion, and
    window[2] to either side, on the cells of `start`, which says where it begins.
    """
    count = start.shape[0]
    h, width = (window[1] - window[0]) / count, 2 * window[2] / count
    x = window[0] + h * (np.arange(count) + 0.5)
    y = width * (np.arange(count) - 0.5 * (count - 1))
    largest = float(problem.shape.largest_contact) / problem.unit
    r = np.hypot((x - lead * h)[:, None], y[None])
    rise = problem.shape._height(np.minimum(r, largest * (1 - 1e-9)) * problem.unit)
    height = np.where(
        r >= largest, -1e3 * (window[1] - window[0]), -np.asarray(rise) / problem.unit
    )
    kernel = _kernel(problem, h, width, count, lead)
    contact = settle(
        convolution(
            kernel.displacement,
            problem.law,
            problem.velocity,
            (h, width),
            lead,
            problem.cover,
        ),
        height,
        start.astype(float),
        EXACT,
        load=None if problem.load is None else problem.load / (h * width),
        depth=problem.depth,
    )
    pressure, touching = contact.pressure, contact.pressure > 0
    # the force acts from centre to centre
    centred = kernel if lead == 0 else _kernel(problem, h, width, count, 0.0)
    force = pressure.sum() * h * width
    beyond_end = touching & (r > largest - np.hypot(h, width))
    border = touching[[0, -1]].any() or touching[:, [0, -1]].any()
    return _BodyContact(
        work_against(centred.slope, pressure) * h * width / force,
        force,
        contact.depth,
        _edges(touching, x, h),
        np.where(touching.any(axis=0), np.abs(y), 0.0).max() + width / 2,
        touching,
        area_of(touching) * touching.size * h * width,
        contact.settled and not beyond_end.any(),
        not border,
    )


def _kernel(
    problem: _CellProblem, h: float, width: float, count: int, lead: float
) -> Kernel:
    """The influence of a cell, of a layer less than that of a half-space."""
    across, cover = (np.arange(count) * width)[None], problem.cover

    def elastic(places: np.ndarray) -> np.ndarray:
        x = places[:, None]
        whole = area_cell(x, across, h, width)
        if cover is None:
            return whole
        r = np.hypot(x, across)
        near = r < _ENDS * cover.thickness
        return np.where(near, whole - cover.less(r, (h, width)), 0.0)

    return sliding_kernel(elastic, problem.chain, problem.velocity, h, count, lead)


def _edges(touching: np.ndarray, x: np.ndarray, h: float) -> Float[np.ndarray, "4"]:
    """Where contact begins and ends along the motion, on the central line and of all
    cells; infinite where there is none.
    """
    ends = []
    for line in (touching[:, touching.shape[1] // 2], touching.any(axis=1)):
        ends += [
            np.where(line, x, np.inf).min() - h / 2,
            np.where(line, x, -np.inf).max() + h / 2,
        ]
    return np.array(ends)


def slide_periodic(
    foundation: Foundation,
    shape: Indenter | ArrayLike,
    cell: ArrayLike,
    asked: Asked,
    points: int,
) -> HalfSpaceCurve:
    """`half_space_sliding` of a map or an array of bodies on a periodic cell."""
    sides = _sides(cell)
    heights, name = _heights(shape, sides, points)
    scene = points_of(foundation, asked, points)
    steady, area = scene.steady, float(np.prod(sides))
    law = foundation.law()

    def solved(on: np.ndarray) -> list[Any]:
        return [
            solve(law.complex_modulus, on, sides, velocity=float(v), pressure=float(p))
            for p, v in zip(scene.value / area, scene.velocity, strict=True)
        ]

    fine, coarse = solved(heights), solved(heights[::2, ::2])
    good = np.array(
        [f.settled and c.settled for f, c in zip(fine, coarse, strict=True)]
    )
    warn_unless(good, "contacts")

    def field(values: Iterable[Any]) -> Any:
        return scene.field(good, values)

    drag = area * field(contact.stress for contact in fine)
    change = drag - area * field(contact.stress for contact in coarse)
    force = scene.value.reshape(steady.shape)
    grid = f"{heights.shape[0]} by {heights.shape[1]} points"
    inputs = dict(scene.inputs(("shape", name)))
    inputs |= {"cell": _metres(sides), "grid": grid}
    return HalfSpaceCurve(
        velocity=steady.full(steady.velocity),
        mu=drag / force,
        normal_force=force * steady.vertical,
        friction_force=drag * steady.vertical,
        area=field((contact.pressure > 0).mean() for contact in fine),
        separation=field(contact.separation for contact in fine),
        error=abs(change) / force,
        converged=good.reshape(steady.shape),
        temperature=steady.full(steady.temperature),
        model=_PERIODIC,
        plan=f"{grid}, and every second of them along each side for the error",
        inputs=(*inputs.items(), NOT_COMPARED),
    )


def _sides(cell: ArrayLike) -> tuple[float, float]:
    sides = as_float64("cell", cell)
    if sides.shape not in ((), (2,)):
        raise InputError(
            argument="cell",
            got=cell,
            accepted="the sides (L_x, L_y) of a periodic cell [m], or one for both",
        )
    positive("cell", sides)
    along, across = np.broadcast_to(sides, (2,)).tolist()
    return along, across


def _heights(
    shape: Indenter | ArrayLike, sides: tuple[float, float], points: int
) -> tuple[np.ndarray, str]:
    """Heights into the rubber [m] on the cell, and what they are in words."""
    if isinstance(shape, AbstractShape):
        x, y = (np.arange(points) / points - 0.5 for _ in range(2))
        r = np.hypot(x[:, None] * sides[0], y[None] * sides[1])
        widest = float(shape.largest_contact)
        if widest < r.max():
            raise InputError(
                argument="cell",
                got=sides,
                accepted=f"within the body, whose radius is {widest:g} m",
            )
        return -np.asarray(shape.height(r)), f"{describe(shape)}, one in each cell"
    heights = np.asarray(as_float64("shape", shape))
    if (
        heights.ndim != 2
        or any(n % 4 or n < 8 for n in heights.shape)
        or not np.isfinite(heights).all()
    ):
        raise InputError(
            argument="shape",
            got=heights.shape,
            accepted="a body or a map of finite heights [m] into the rubber, (n_x, "
            "n_y), both multiples of 4 and at least 8",
        )
    return heights, f"map of heights, {math.sqrt(np.var(heights)):.3g} m rms"


def _metres(sides: tuple[float, float]) -> str:
    return f"{brief(sides[0], 'm')} by {brief(sides[1], 'm')}"


class CoverOfCells(Tree):
    """What a layer changes in the half-space's cells."""

    near: np.ndarray  # Chebyshev coefficients of n on panels of y
    bend: np.ndarray  # of its Laplacian
    squeeze: Any  # 1 - 2 nu
    thickness: Any
    bonded: bool = static()

    def less(self, r: np.ndarray, cell: tuple[float, float]) -> np.ndarray:
        """By how much a loaded cell moves the surface at r less than that of a
        half-space, per unit of pressure.
        """
        y = r / self.thickness
        # mean over the cell
        table = (
            self.near
            + self.bend * (cell[0] ** 2 + cell[1] ** 2) / 48 / self.thickness**2
        )
        i = np.clip((y / _PANEL).astype(int), 0, table.shape[0] - 1)
        t = 2 * (y / _PANEL - i) - 1
        rows = table[i]
        b1 = b2 = np.zeros_like(y)
        for n in range(_DEGREE, 0, -1):
            b1, b2 = rows[..., n] + 2 * t * b1 - b2, b1
        return (
            cell[0] * cell[1] / (np.pi * self.thickness) * (rows[..., 0] + t * b1 - b2)
        )


@numpy_unless_traced
def layer_sliding(
    material: Layer,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    load: ArrayLike | None = None,
    depth: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    points: int = 64,
) -> FrictionCurve:
    """Friction of a rigid body in steady, frictionless sliding on a layer, in three
    dimensions.

    Arguments, result and errors as of `half_space_sliding`, whose cells it uses with
    the influence function of the layer; `material` is an `em.layer` of a material with
    a constant Poisson's ratio. The body is alone on an infinite layer. Raises
    `InputError` as well for a constant bulk modulus, and for two covers.
    """
    asked = Asked(velocity, load, depth, temperature=temperature)
    cover, foundation = cover_of(material), foundation_of(material)
    return slide(foundation, shape, asked, points, cover, _LAYER_MODEL)


def friction_on_cells(
    call: SmoothCall, adhesion: AdhesiveShear | None, cells: int
) -> FrictionCurve:
    """`em.friction` of a smooth body on a half-space or a layer with `em.HalfSpace`.
    Raises `InputError`.
    """
    material, asked = call.material, call.asked
    no_pressure(call.shape, asked.pressure)
    solver: Any = layer_sliding if isinstance(material, Layer) else half_space_sliding
    curve = solver(
        material,
        call.shape,
        velocity=asked.velocity,
        load=asked.load,
        depth=asked.depth,
        temperature=asked.temperature,
        points=cells,
    )
    if getattr(material, "softening", None) is not None:
        curve = dataclasses.replace(curve, model=curve.model + LINEAR)
    return curve if adhesion is None else on_cells(curve, adhesion, material)


def cover_of(material: Layer) -> CoverOfCells:
    """The kernel of a layer. Raises `InputError` for one that depends on time."""
    if not isinstance(material, Layer):
        raise InputError(argument="material", got=material, accepted="an em.layer(...)")
    if material.other is not None or not material.constant:
        raise InputError(
            argument="material",
            got=material,
            accepted="one em.layer of a material with a constant Poisson's ratio in "
            "three dimensions",
        )
    squeeze = float(np.asarray(material.squeeze()))
    return CoverOfCells(
        *_tables(squeeze, material.bonded),
        squeeze,
        float(material.thickness),
        material.bonded,
    )


def foundation_of(material: Layer) -> Any:
    """The half-space of the same material."""
    from ..element.law import half_space

    return half_space(material.material)


@functools.lru_cache(16)
def _tables(squeeze: float, bonded: bool) -> tuple[np.ndarray, np.ndarray]:
    from scipy.special import j0

    z, dz = gauss_on_panels(np.linspace(0.0, 20.0, 61), 24)
    lack = dz * numpy_unless_traced(layer_deficit)(z, squeeze, bonded)
    nodes = np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))
    order = np.polynomial.chebyshev.chebvander(nodes, _DEGREE).T * 2 / (_DEGREE + 1)
    order[0] *= 0.5
    y = _PANEL * (np.arange(round(_FAR / _PANEL))[:, None] + 0.5 * (1 + nodes))
    wave = j0(y[..., None] * z)
    return (wave @ lack) @ order.T, -(wave @ (lack * z**2)) @ order.T
