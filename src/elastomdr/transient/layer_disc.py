"""Axisymmetric contact on a layer as a line of independent elements, exact where W does
not depend on time.

On a layer the elements of the MDR line push each other through a smooth kernel,

    q(x) + (2/pi) int_0^a M(x, s) q(s) ds = E* o (d - g(x)),
    M(x, s) = (1/h) int_0^inf (W - 1) cos(zx/h) cos(zs/h) dz,

P = 2 int_0^a q. The operator 1 + M = L L' factorises for all contacts at once (Krein),
with L causal in x: under it the elements are independent again, whatever the history,
since contact is a disc. Element x has the weight of what a flat punch gains in
stiffness, and the profile is the depth at which an elastic contact has that radius:

    W(a) = 2 int_0^a q_1(s; a) ds,    (1 + M) q_1 = 1 on [0, a],    dW/da = 2 q_1(a; a)^2
    d(a) = [g(a) - int_0^a R(s; a) g(s) ds]/q_1(a; a),              (1 + M) R = M(., a)

so that whatever solves the line of a half-space solves the layer with another `Disc`.
Both functions are smooth in a/h: they are Chebyshev series on panels of doubling a/h.
Derived here; W(a) against Hayes et al. 1972.
"""

from __future__ import annotations

import functools
import math
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import arrays, stop_gradient, xp
from ..checks import Array, is_traced, numpy_unless_traced
from ..element.law import Foundation, half_space
from ..element.layer import Layer, layer_deficit
from ..errors import InputError
from ..material.prony import Prony
from ..numerics.quadrature import gauss, gauss_on_panels
from ..surface.disc import Disc, raised
from ..surface.profile import Profile
from ..surface.shapes import AbstractShape, Cone, Cylinder, FlatPunch, PowerLaw
from ..trees import replaced, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from ..checks import Array

_ENDS = np.array([0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0])  # panels of a/h
WIDEST = float(_ENDS[-1])  # a/h up to which the tables reach
_DEGREE = 13  # of the series on a panel
_STEPS = 3  # Newton's from the table to rounding
_TAIL = 17.0  # z = kh beyond which 1 - W is below rounding
# (a/h)^2 G/K below which rubber of a bulk modulus K is incompressible on a layer
_STIFFER = 0.01


class Resolvents(NamedTuple):
    """The elastic layer at the nodes of a panel of a/h: contacts of radius a/h =
    `alpha`, lengths in h.
    """

    alpha: Float[Array, " k"]
    s: Float[Array, "k n"]  # Gauss nodes on [0, alpha]
    ds: Float[Array, "k n"]
    unit: Float[Array, "k n"]  # q_1(s; a)
    row: Float[Array, "k n"]  # R(s; a)
    edge: Float[Array, " k"]  # q_1(a; a)


def kernel_line(
    squeeze: Array | float, bonded: bool, reach: float
) -> tuple[np.ndarray, Array]:
    """Nodes in z = kh and weights, which hold -(2/pi)(1 - W), of integrals over z up to
    x/h = `reach`.
    """
    panels = math.ceil(2 + 1.1 * reach)
    z, dz = gauss_on_panels(np.linspace(0.0, _TAIL, panels + 1), 24)
    return z, -2 / math.pi * dz * numpy_unless_traced(layer_deficit)(z, squeeze, bonded)


@numpy_unless_traced
def _resolvents(
    squeeze: Array | float, bonded: bool, low: float, high: float
) -> Resolvents:
    alpha = 0.5 * (low + high) + 0.5 * (high - low) * _places()
    count = 18 + math.ceil(2.5 * high)
    z, weight = kernel_line(squeeze, bonded, high)
    node, share = gauss(count)
    s, ds = alpha[:, None] * 0.5 * (1 + node), alpha[:, None] * 0.5 * share
    parts = []
    for a, x, dx in zip(alpha, s, ds, strict=True):
        wave, at_edge = np.cos(x[:, None] * z), np.cos(a * z)
        matrix = np.eye(count) + (wave * weight) @ wave.T * dx
        right = xp.stack([xp.ones(count), (wave * weight) @ at_edge], axis=1)
        solution = xp.linalg.solve(xp.asarray(matrix), right)
        edge = 1 - at_edge * weight @ (wave.T @ (dx * solution[:, 0]))
        parts.append((solution[:, 0], solution[:, 1], edge))
    unit, row, edge = (xp.stack(list(column)) for column in zip(*parts, strict=True))
    return Resolvents(alpha, s, ds, unit, row, edge)


@functools.lru_cache(64)
def _of_numbers(squeeze: float, bonded: bool, panel: int) -> Resolvents:
    return _resolvents(squeeze, bonded, float(_ENDS[panel]), float(_ENDS[panel + 1]))


class _Place(NamedTuple):
    """Radii in the tables: their panels, Chebyshev's polynomials there, and half the
    width of a panel [m].
    """

    panel: Array
    chebyshev: Float[Array, "... n"]
    half_width: Array


class LayerDisc(Disc):
    """The contact of an axisymmetric body on a layer, as elements that are
    independent.
    """

    thickness: Float[Array, ""]
    stiffness: Float[Array, "panels n"]  # W(a)/(2a)
    edge: Float[Array, "panels n"]  # q_1(a; a)
    pull: Float[Array, "panels n"]  # int R g ds over a^p
    held: Float[Array, "panels n"]  # int q_1 g ds over a^(p+1)
    places: Float[Array, " k"]  # a, at which
    depths: Float[Array, " k"]  # d(a), a guess for its inverse
    areas: Float[Array, " k"]  # and A(a)
    squeeze: Any
    bonded: bool = static()

    def profile(self, x: Array) -> Array:
        """d(x): the depth at which an elastic contact has this radius."""
        if self.flat:
            return xp.zeros_like(x)
        inside = self._inside(x)
        return self._depth_and_slope(inside)[0] + (x - inside)

    def slope(self, x: Array) -> Array:
        """dd/da."""
        if self.flat:
            return xp.zeros_like(x)
        return self._depth_and_slope(self._inside(x))[1]

    def _depth_and_slope(self, x: Array) -> tuple[Array, Array]:
        """d(x) and its derivative inside of the largest contact."""
        place = self._place(x)
        edge, bend = self._read(self.edge, place)
        value, rise = self._read(self.pull, place)
        p = self._tip_power
        scale = raised(x, p)
        depth = (self.shape._profile(x) - value * scale) / edge
        # int R g ds = value x^p
        pulled = rise * scale + value * p * raised(x, p - 1)
        return depth, (self.shape._slope(x) - pulled - depth * bend) / edge

    def weight(self, x: Array) -> Array:
        """dW/da = 2 q_1(a; a)^2."""
        return 2 * self._read(self.edge, self._place(self._inside(x)))[0] ** 2

    def width(self, a: Array) -> Array:
        """W(a), the stiffness of a flat punch of radius a over E*."""
        place = self._place(self._inside(a))
        return 2 * a * self._read(self.stiffness, place)[0]

    def area(self, a: Array) -> Array:
        """A(a): an elastic contact carries E* A."""
        inside = self._inside(a)
        scale = inside * raised(inside, self._tip_power)
        held = self._read(self.held, self._place(inside))[0] * scale
        return self.width(inside) * self.profile(inside) - 2 * held

    def energy(self, a: Array) -> Array:
        """V(a): an elastic contact stores E* V."""
        node, share = gauss_on_panels(np.array([0.0, 0.02, 0.2, 1.0]), 16)
        x = a[..., None] * node
        gap = self.profile(a)[..., None] - self.profile(x)
        return 0.5 * xp.sum(a[..., None] * share * self.weight(x) * gap**2, axis=-1)

    @property
    def largest(self) -> Any:
        limit = (xp if is_traced(self.shape, self.thickness) else np).minimum(
            self.shape.largest_contact, WIDEST * self.thickness
        )
        return limit * (1 - 1e-12)

    def radius_of_depth(self, depth: Array) -> Array:
        """a at which an elastic contact has this depth; zero for d <= 0, NaN beyond the
        table.
        """
        if self.flat:
            return xp.where(depth > 0, self.shape.largest_contact, 0.0)
        return self._inverse(
            xp.asarray(depth),
            self.depths,
            self._tip_power,
            self._depth_and_slope,
        )

    def radius_of_area(self, area: Array) -> Array:
        """a with A(a) = `area`; as `radius_of_depth`."""
        if self.flat:
            return xp.where(area > 0, self.shape.largest_contact, 0.0)
        return self._inverse(
            xp.asarray(area),
            self.areas,
            1 + self._tip_power,
            lambda a: (self.area(a), self.width(a) * self.slope(a)),
        )

    def _inverse(
        self,
        value: Array,
        levels: Array,
        power: float,
        value_and_slope: Callable[[Array], tuple[Array, Array]],
    ) -> Array:
        touches = value > 0
        value = xp.where(touches, value, levels[0])
        log = xp.log(stop_gradient(value))
        known, places = (
            xp.log(xp.asarray(stop_gradient(x))) for x in (levels, self.places)
        )
        guess = xp.interp(log, known, places) + xp.minimum(log - known[0], 0.0) / power
        a = xp.exp(guess)
        top = xp.asarray(self.largest)
        for i in range(_STEPS):
            a = stop_gradient(xp.minimum(a, top))
            height, rise = value_and_slope(a)
            if i < _STEPS - 1:  # on logarithms, where it is nearly straight
                a = a * xp.exp(
                    xp.clip((log - xp.log(height)) * height / (a * rise), -1.0, 1.0)
                )
            else:
                a = a + (value - height) / stop_gradient(rise)
        beyond = value > levels[-1] * (1 + 1e-12)
        return xp.where(touches, xp.where(beyond, xp.nan, a), 0.0)

    @property
    def _tip_power(self) -> float:
        return tip_power(self.shape)

    def _power(self) -> tuple[float | None, Any]:
        """A power at the axis, where panels of the line begin; its coefficient is not
        asked for.
        """
        return (self.shape.exponent if isinstance(self.shape, PowerLaw) else None), None

    def _inside(self, x: Array) -> Array:
        return xp.minimum(xp.asarray(x), xp.asarray(self.largest))

    def _place(self, a: Array) -> _Place:
        """Where radii a stand in the tables."""
        alpha = a / self.thickness
        panel = xp.clip(
            xp.ceil(xp.log2(xp.maximum(stop_gradient(alpha), 1e-9))).astype(int) + 1,
            0,
            _ENDS.size - 2,
        )
        ends = arrays(_ENDS)
        half = 0.5 * (ends[panel + 1] - ends[panel])
        y = (alpha - ends[panel]) / half - 1
        columns = [xp.ones_like(y), y]
        for _ in range(_DEGREE - 1):
            columns.append(2 * y * columns[-1] - columns[-2])
        return _Place(panel, xp.stack(columns, axis=-1), half * self.thickness)

    def _read(self, table: Array, place: _Place) -> tuple[Array, Array]:
        """A function at a place of the tables, and its derivative by the radius."""
        rows = arrays(table)[place.panel]
        slopes = place.chebyshev @ xp.asarray(_slopes())
        return (
            xp.sum(place.chebyshev * rows, axis=-1),
            xp.sum(slopes * rows, axis=-1) / place.half_width,
        )


@numpy_unless_traced
def layer_disc(
    shape: AbstractShape, thickness: Array | float, squeeze: Array | float, bonded: bool
) -> LayerDisc:
    """The contact of a body on a layer whose kernel W is that of a constant 1 - 2 nu =
    `squeeze`.
    """
    traced = is_traced(shape, thickness, squeeze)
    top = np.inf
    if not traced:
        top = float(np.asarray(shape.largest_contact) / np.asarray(thickness))
    columns: list = []
    for panel in range(_ENDS.size - 1):
        if is_traced(squeeze):
            ends = float(_ENDS[panel]), float(_ENDS[panel + 1])
            line = _resolvents(squeeze, bonded, *ends)
        else:
            line = _of_numbers(float(np.asarray(squeeze)), bonded, panel)
        columns.append(_tables(shape, thickness, squeeze, bonded, line))
        if line.alpha[-1] > top:
            columns += [columns[-1]] * (_ENDS.size - 2 - panel)
            break
    tables = (xp.stack(list(column)) for column in zip(*columns, strict=True))
    middle, half = 0.5 * (_ENDS[:-1] + _ENDS[1:]), 0.5 * np.diff(_ENDS)
    places = (middle[:, None] + half[:, None] * _places()).ravel()
    places = np.minimum(places, 0.999 * top) * thickness
    places = xp.minimum(places, 0.999 * shape.largest_contact)
    disc = LayerDisc(
        shape,
        "half-space",
        xp.asarray(thickness),
        *tables,
        places=places,
        depths=places,
        areas=places,
        squeeze=squeeze,
        bonded=bonded,
    )
    if disc.flat:
        return disc
    depths, areas = stop_gradient(
        (disc.profile(xp.asarray(places)), disc.area(xp.asarray(places)))
    )
    return replaced(disc, depths=depths, areas=areas)


def _tables(
    shape: AbstractShape,
    thickness: Array | float,
    squeeze: Array | float,
    bonded: bool,
    line: Resolvents,
) -> list:
    """Series on a panel of stiffness, edge, pull and held (`LayerDisc`)."""
    total, power = xp.sum(line.ds * line.unit, axis=1), tip_power(shape)
    pull = held = xp.zeros_like(total)
    if not isinstance(shape, FlatPunch):
        a = line.alpha * thickness
        if isinstance(shape, Profile):  # its pieces are panels of the rule
            pull, held = _over_pieces(shape, thickness, line, squeeze, bonded)
        else:
            end = shape.largest_contact * (1 - 1e-12)
            g = shape._profile(xp.minimum(line.s * thickness, end))
            pull = xp.sum(line.ds * line.row * g, axis=1)
            held = xp.sum(line.ds * line.unit * g, axis=1) * thickness
        pull, held = pull / a**power, held / a ** (power + 1)
    functions = (total / line.alpha, line.edge, pull, held)
    return [_series(values) for values in functions]


def tip_power(shape: AbstractShape) -> float:
    """Power with which a profile rises at its tip, or a lower one."""
    match shape:
        case PowerLaw():
            return float(shape.exponent)
        case Cone() | Profile():
            return 1.0
    return 2.0


@numpy_unless_traced
def _over_pieces(
    shape: Profile,
    h: Array | float,
    resolvents: Resolvents,
    squeeze: Array | float,
    bonded: bool,
) -> tuple[Array, Array]:
    z, weight = kernel_line(squeeze, bonded, float(resolvents.alpha[-1]))
    places = xp.asarray(shape.r) / h
    pulls, helds = [], []
    for k, alpha in enumerate(resolvents.alpha):
        edges = xp.minimum(places, xp.minimum(alpha, places[-1] * (1 - 1e-12)))
        s, ds = gauss_on_panels(edges, 6)
        wave = xp.cos(s[:, None] * z) * weight
        inner = np.cos(resolvents.s[k][:, None] * z)
        unit = 1 - wave @ (inner.T @ (resolvents.ds[k] * resolvents.unit[k]))
        row = wave @ (
            np.cos(alpha * z) - inner.T @ (resolvents.ds[k] * resolvents.row[k])
        )
        g = shape._profile(s * h)
        pulls.append(xp.sum(ds * row * g))
        helds.append(xp.sum(ds * unit * g) * h)
    return xp.stack(pulls), xp.stack(helds)


class ElasticLine(NamedTuple):
    """The kernel M of a layer in numbers, lengths in m."""

    z: np.ndarray
    weight: Any  # -(2/pi)(1 - W) dz
    thickness: float
    nodes: int

    def kernel(self, x: np.ndarray, s: np.ndarray) -> np.ndarray:
        """(2/pi) M(x, s) [1/m]."""
        wave = np.cos(x[:, None] / self.thickness * self.z) * self.weight
        return wave @ np.cos(s[:, None] / self.thickness * self.z).T / self.thickness

    def of_unit(self, x: np.ndarray, a: float) -> np.ndarray:
        """q_1(x; a) at places x <= a: the force density under a flat punch of radius
        a.
        """
        node, share = gauss(self.nodes)
        s, ds = 0.5 * a * (1 + node), 0.5 * a * share
        unit = np.linalg.solve(
            np.eye(self.nodes) + self.kernel(s, s) * ds, np.ones(self.nodes)
        )
        return (1 - self.kernel(x.ravel(), s) @ (ds * unit)).reshape(x.shape)


def line_of(disc: LayerDisc) -> ElasticLine:
    """The elastic line under a contact of numbers."""
    reach = float(disc.largest / disc.thickness)
    alpha = min(reach, WIDEST)
    z, weight = kernel_line(float(disc.squeeze), disc.bonded, alpha + 14.0)
    return ElasticLine(
        z, weight, float(disc.thickness), 18 + math.ceil(2.5 * min(alpha, 4.0))
    )


@functools.cache
def _places() -> np.ndarray:
    """Chebyshev's nodes on [-1, 1], ascending."""
    return -np.cos(np.pi * (np.arange(_DEGREE + 1) + 0.5) / (_DEGREE + 1))


@functools.cache
def _slopes() -> np.ndarray:
    """T_n' = sum_m T_m S[m, n]."""
    slopes = np.zeros((_DEGREE + 1, _DEGREE + 1))
    slopes[:-1] = np.polynomial.chebyshev.chebder(np.eye(_DEGREE + 1))
    return slopes


def _series(values: Array) -> Array:
    """Chebyshev coefficients from values at `_places`."""
    order = np.polynomial.chebyshev.chebvander(_places(), _DEGREE).T * 2 / (_DEGREE + 1)
    order[0] *= 0.5
    return xp.asarray(order) @ values


def of_layer(material: Layer, shape: AbstractShape) -> tuple[LayerDisc, Foundation]:
    """The elements of an axisymmetric contact on a layer and what they are made of.
    Raises `InputError`.
    """
    if isinstance(shape, Cylinder):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="axisymmetric in a normal contact on an em.layer",
            hint="em.rolling and em.friction take a Cylinder; here it is known on "
            "em.springs(material, thickness), in a scene springs = true, with bonded "
            "= false if the layer is incompressible",
        )
    if material.other is not None:
        raise InputError(
            argument="material",
            got=material,
            accepted="one em.layer under an axisymmetric body, without a second cover",
        )
    solid: Any = material.material
    if not isinstance(solid, Prony):
        raise InputError(
            argument="material",
            got=solid,
            accepted="a series (em.Prony) for a history in time",
        )
    # incompressible, as far as `incompressible_enough` allows
    if not material.constant:
        shear = solid.shear()
        solid = Prony(
            shear.equilibrium,
            shear.moduli,
            shear.times,
            viscosity=shear.viscosity,
            shift=shear.shift,
            vertical=shear.vertical,
            softening=shear.softening,
            name=shear.name,
        )
    squeeze = 0.0 if not material.constant else material.squeeze()
    squeeze = squeeze if is_traced(squeeze) else float(np.asarray(squeeze))
    foundation = half_space(solid)
    return layer_disc(shape, material.thickness, squeeze, material.bonded), foundation


def incompressible_enough(
    material: Layer, disc: LayerDisc, radius: Array, force: Array
) -> None:
    """Refuses a constant bulk modulus where it would show, since W then depends on
    time. Raises `InputError`.
    """
    bulk: Any = getattr(material.material, "bulk", None)
    if bulk is None or is_traced(bulk, disc, radius, force):
        return
    touches = np.isfinite(radius) & (radius > 0)
    a = np.asarray(radius)[touches]
    if not a.size:
        return
    shear = np.asarray(force)[touches] / (4 * np.asarray(disc.area(a)))
    share = float(np.max((a / float(disc.thickness)) ** 2 * shear / float(bulk)))
    if share > _STIFFER:
        raise InputError(
            argument="bulk",
            got=float(bulk),
            accepted="left out, or so large that (a/h)^2 G/K stays below "
            f"{_STIFFER:g} in a history on a layer",
            hint=f"it reaches {share:.2g} here; give a constant Poisson's ratio in "
            "its place, or use em.springs(material, thickness) where the contact is "
            "much wider than the layer is thick",
        )
