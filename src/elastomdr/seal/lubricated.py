"""A rubber body and its counterface with a film of liquid between them, in plane strain.

In the frame of the contact both surfaces move along x, the rubber with u_r and the
counterface with u_c: a rod under a seal (u_r = 0, u_c = v), a slider on rubber (v, 0), a
roller on rubber (v, v). Per length W' of the load, with the displacement w of the
rubber,

    mu v W' = int eta (u_c - u_r)^2/h dx + (u_r + u_c)/2 int h p_f' dx       viscous
              + |u_c - u_r| int (mu_a p_a + tau A) dx                        asperities
              + u_r int p w' dx                                              rubber

the powers that are dissipated: in the film, in the rubber about asperities and by the
shear of their contacts, and in the rubber as it passes. `film.py` has the equations of
the film, `response.py` those of the rubber, `roughness.py` those of the asperities.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline

from ..arrays import numpy_unless_traced, one_thread
from ..call.extrapolation import (
    held_beyond,
    modulus_at,
    pressed_too_hard,
    sheared_too_hard,
    steady_beyond,
    told,
)
from ..call.problem import Asked, doubt_depth
from ..call.several_materials import over_materials
from ..checks import (
    broadcast_shape,
    in_kelvin,
    numbers_only,
    one_of,
    positive_arrays,
    warn_unless,
)
from ..element.law import as_foundation
from ..element.layer import Layer
from ..errors import InputError, quiet
from ..material.prony import Prony
from ..material.shift import thermal_factors
from ..material.validity import material_in_words
from ..numerics.interpolation import halving_limit
from ..results.base import Array, Result, part, quantity, record
from ..results.doubts import Doubt, where
from ..results.words import brief, describe, in_unit, span
from ..rough.adhesion import AdhesiveShear, shear_law
from ..rough.problem import softening_left_out
from ..smooth.problem import SmoothCall
from ..surface.shapes import Cylinder
from ..surface.spectrum import AbstractSpectrum, as_spectrum
from ..trees import replaced
from . import film as films
from .leak import BOTH
from .pressure_profile import read_along
from .response import SealBody, bodies_of, compliance, response
from .roughness import (
    FlowFactor,
    Roughness,
    Rubbing,
    Touching,
    half_space_of,
    pressed,
    rubbing,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Material
    from ..element.law import Foundation
    from ..element.layer import Layer as LayerType

_NODES = 129  # of the coarsest grid
_SHOWN = 2 * _NODES - 1  # of a profile, those of the second grid
_FEWEST, _MOST = 2, 4  # grids, each twice as dense as the one before
_CHANGED = 3e-4  # relative change of what is extrapolated, above which another follows
_UNSURE = 0.25  # part of that change that counts as error
_FLAGGED = 3e-3  # relative error of the finer grid above which a point is not solved
_UNITS = {"velocity": "m/s", "load": "N", "viscosity": "Pa s", "time": "s"}
# film over the radius above which the gap is no parabola: it is off by x^2/4R^2, 2.5 %
# where it has doubled, x^2 = 2 h R
_THICKEST = 0.05
_DOUBTED = 0.01  # part of mu from which on a doubt about trapped liquid is said
# velocities of rubber and counterface in the frame of the contact, over that asked for
MOTIONS = {"rests": (0.0, 1.0), "passes": (1.0, 0.0), "rolls": (1.0, 1.0)}
_MODEL = "Reynolds' equation and half-plane in plane strain, steady"
_ROUGH = {
    "maps": "; load shared by the gaps of em.leak, and its flow factor",
    "patir-cheng": "; load shared by the gaps of em.leak, flow factor of Patir and Cheng",
}
# of a solved film, in the order of `_numbers`
_NUMBERS = (
    "mu",
    "viscous",
    "asperity",
    "boundary",
    "rubber",
    "film_thickness",
    "least_film",
    "flow",
    "asperity_share",
    "trapped_share",
    "trapped_error",
)


@part
class FilmProfile:
    """Film and pressures at places along the motion; the last axis of each field."""

    x: Array = quantity(
        "place", "m", "along the motion, from the apex", dims="... place", shown="mm"
    )
    film: Array = quantity("film", "m", "mean gap", dims="... place", shown="µm")
    pressure: Array = quantity(
        "pressure of the film", "Pa", "p_f", dims="... place", shown="MPa"
    )
    asperity_pressure: Array = quantity(
        "pressure of the asperities", "Pa", "p_a", dims="... place", shown="MPa"
    )


@record
class Lubricated(Result):
    """Lubricated contact of a cylinder, at every velocity.

    `mu` is the sum of `viscous`, `asperity`, `boundary` and `rubber`; `error` is its
    numerical error. Where channels may be closed, from a real contact of 0.38 on, liquid
    may stay in them or leave: `trapped_error` says what that may change in `mu`, and is
    zero where channels are open. What else the model leaves out is not bounded:
    `model_error` is NaN. A point that was not solved is NaN with `converged=False`.
    """

    velocity: Array = quantity("velocity", "m/s", "v")
    load: Array = quantity("load", "N", "F_N")
    viscosity: Array = quantity("viscosity", "Pa s", "of the liquid")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    mu: Array = quantity("friction coefficient", "-", "dissipated power over v F_N")
    viscous: Array = quantity("viscous friction", "-", "part of mu, of the liquid")
    asperity: Array = quantity(
        "friction of asperities", "-", "part of mu, hysteresis about asperities"
    )
    boundary: Array = quantity(
        "boundary friction", "-", "part of mu, shear of the real contact"
    )
    rubber: Array = quantity(
        "friction of the rubber",
        "-",
        "part of mu, hysteresis of the rubber that passes",
    )
    film_thickness: Array = quantity(
        "film at the apex", "m", "mean gap at x = 0", shown="µm"
    )
    least_film: Array = quantity("least film", "m", "least mean gap", shown="µm")
    flow: Array = quantity("flow per width", "m^2/s", "of the liquid")
    asperity_share: Array = quantity(
        "load on asperities", "-", "part of the load that asperities carry"
    )
    trapped_share: Array = quantity(
        "load on trapped liquid",
        "-",
        "part of the load that liquid carries where channels may be closed",
    )
    trapped_error: Array = quantity(
        "what trapped liquid may change",
        "-",
        "how far mu may be off as liquid in closed channels stays there, or leaves",
    )
    imbalance: Array = quantity(
        "imbalance of flow", "-", "largest difference of flow along the film, over it"
    )
    error: Array = quantity("error of the friction coefficient", "-", "numerical")
    model_error: Array = quantity("model error", "-", "NaN: not known")
    profile: FilmProfile

    title: ClassVar[str] = "Lubricated friction"
    across: ClassVar[str] = "velocity"
    scale: ClassVar[str] = "log"
    shows: ClassVar[str] = "mu"
    error_of: ClassVar[str] = "the friction coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "viscosity",
        "load",
        "temperature",
    )

    def pressure(self, x: ArrayLike) -> Array:
        """Pressure of the film [Pa] at places x [m] along the motion, from the apex, the
        last axis; read between the places of `profile`, which has that of the
        asperities.
        """
        return read_along(x, self.profile.x, self.profile.pressure)

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: Literal["mu", "film_thickness", "least_film", "flow"] = "mu",
    ) -> "Axes":
        """Draws friction, with a band where trapped liquid is in doubt, or film or flow
        against the velocity.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show, "mu", "film_thickness", "least_film", "flow")
        from ..results.plotting import (
            DrawAsk,
            DrawnLine,
            ResultSketch,
            Shaded,
            Trace,
            draw,
        )

        def band(sketch: ResultSketch, line: DrawnLine, drawn: Trace) -> None:
            error = sketch.along_line(sketch.fields["trapped_error"], line)
            if show == "mu" and (error > 0).any():
                ends = line.y - error, line.y + error
                said = "liquid in closed channels stays or leaves"
                sketch.add(Shaded(line.x, *ends, said, colour=line.colour, of=drawn))

        return self._draw(
            partial(draw, y=show, also=band), DrawAsk(ax, style, title, label)
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of friction, film and flow."""
        yield "friction coefficient", span(self.mu)
        yield "film at the apex", span(in_unit(self.film_thickness, "µm"), "µm")
        yield "least film", span(in_unit(self.least_film, "µm"), "µm")
        yield "load on asperities", span(self.asperity_share)
        if (doubted := self._doubted()).any():
            yield (
                "trapped liquid",
                f"channels may be closed at {int(doubted.sum())} of {doubted.size} "
                "points, and liquid in them may stay or leave: friction is off by up to "
                f"{span(np.asarray(self.trapped_error)[doubted])} there",
            )

    def _doubted(self) -> np.ndarray:
        """Where trapped liquid may change friction by more than `_DOUBTED` of it."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.trapped_error > _DOUBTED * self.mu)


@over_materials
@numpy_unless_traced
def lubricated(
    material: Prony | Foundation | LayerType | Sequence[Prony],
    shape: Cylinder,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    viscosity: ArrayLike,
    surface: AbstractSpectrum | None = None,
    boundary_shear: float | AdhesiveShear | None = None,
    temperature: ArrayLike | None = None,
    time: ArrayLike | None = None,
    rubber: Literal["rests", "passes", "rolls"] = "rests",
    flow_factor: FlowFactor = "maps",
) -> Lubricated:
    """Film, pressure and friction of a lubricated cylinder: over velocity, the Stribeck
    curve.

    Args:
        material: a material, or an `em.layer` on a rigid base.
        shape: `em.Cylinder`: its radius is that of the undeformed gap, whichever body is
            round.
        velocity: velocity v [m/s]; arguments broadcast.
        load: load on the length of the cylinder [N].
        viscosity: viscosity of the liquid at the temperature [Pa s].
        surface: roughness by its spectrum, where both partners are rough the sum of
            both; None where they are smooth.
        boundary_shear: shear stress of the real contact [Pa], or an `em.AdhesiveShear`.
        temperature: temperature [K], for a material with a shift law.
        time: how long the pressure has stood on rubber that rests [s]; None for long
            after.
        rubber: "rests" under a counterface that moves, as a seal on a rod does; "passes"
            under a rigid body that slides on it; "rolls" with the counterface, both at v.
        flow_factor: how a rough contact lets the liquid through: "maps", as `em.leak`,
            or "patir-cheng" to compare with.

    Returns:
        An `em.Lubricated` of the broadcast shape.

    Raises:
        InputError: for anything but a cylinder, a material without equilibrium modulus,
            springs, arguments out of range, and under `jax.jit`, `grad` and `vmap`.

    Exact in plane strain for smooth surfaces, small strains and a liquid of constant
    viscosity, flooded, with a film thin against the radius (above a twentieth of it
    points are NaN); conserves mass where the film ruptures. Roughness enters by its mean
    gap. Source: `docs/seal.md`; Giacopini et al., J. Tribol. 132 (2010) 041702; Patir &
    Cheng, J. Lubr. Technol. 100 (1978) 12.
    """
    solid: Any = material  # `over_materials` has taken a list apart
    scene = _check(
        _FilmAsked(
            solid,
            shape,
            velocity,
            load,
            viscosity,
            temperature,
            time,
            rubber,
            surface,
            boundary_shear,
        )
    )
    one_of("flow_factor", flow_factor, *_ROUGH)
    shear = _checked_shear(boundary_shear, surface, temperature)
    solved = [_Solved() for _ in range(scene.velocity.size)]
    rough = None if surface is None else pressed(solid, surface, flow_factor)
    with one_thread():
        for points in scene.groups():
            for i, result in zip(
                points, _solve(scene, points, rough, shear), strict=True
            ):
                solved[i] = result
    good = np.array([each.good for each in solved])
    lost = np.isnan([each.half for each in solved]).sum()
    flat = (
        f"{lost} of them have no dry contact, as where the load (in N) presses a layer "
        "flat."
    )
    warn_unless(good, "points", reason=flat if lost else "")
    model = _MODEL + ("" if surface is None else _ROUGH[flow_factor])
    return _report(scene, solved, good, model, shear)


class _Solved(NamedTuple):
    """A point: the numbers of `_numbers`, their errors, and the profile."""

    numbers: Array = np.full(len(_NUMBERS), np.nan)
    errors: Array = np.full(len(_NUMBERS), np.nan)
    profile: Array | None = None
    imbalance: float = np.nan
    half: float = np.nan  # half-width of the dry contact [m]
    beyond: bool = False  # whether the asperities use the material extrapolated
    good: bool = False


class _FilmAsked(NamedTuple):
    """The arguments as they were given."""

    material: Material
    shape: Cylinder
    velocity: ArrayLike
    load: ArrayLike
    viscosity: ArrayLike
    temperature: ArrayLike | None
    time: ArrayLike | None
    rubber: str
    surface: AbstractSpectrum | None
    boundary_shear: float | AdhesiveShear | None


class _FilmScene(NamedTuple):
    """The arguments, flat, in SI units."""

    material: Any
    shape: Cylinder
    surface: AbstractSpectrum | None
    rubber: str
    dims: tuple[int, ...]
    velocity: Array
    load: Array
    viscosity: Array
    temperature: Array | None
    time: Array | None
    factor: Array  # a_T
    vertical: Array  # b_T

    def groups(self) -> Iterator[Array]:
        """Numbers of points that differ in velocity and viscosity only."""
        given = (self.load, self.temperature, self.time)
        key = np.column_stack([each for each in given if each is not None])
        group = np.unique(key, axis=0, return_inverse=True)[1].ravel()
        for i in np.unique(group):
            yield np.flatnonzero(group == i)


def _check(asked: _FilmAsked) -> _FilmScene:
    """The arguments, checked and broadcast. Raises `InputError`."""
    numbers_only(asked._asdict())
    if not isinstance(asked.shape, Cylinder):
        raise InputError(
            argument="shape",
            got=asked.shape,
            accepted="an em.Cylinder(radius, length) under a film",
        )
    if asked.surface is not None:
        as_spectrum("surface", asked.surface)
    one_of("rubber", asked.rubber, *MOTIONS)
    if asked.time is not None and asked.rubber != "rests":
        raise InputError(
            argument="time",
            got=asked.time,
            accepted="left out for rubber that moves through the contact",
        )
    arrays = positive_arrays(
        {
            "velocity": asked.velocity,
            "load": asked.load,
            "viscosity": asked.viscosity,
            "temperature": asked.temperature,
            "time": asked.time,
        }
    )
    dims = broadcast_shape(arrays)
    flat = {
        name: np.broadcast_to(value, dims).ravel() for name, value in arrays.items()
    }
    temperatures = flat.get("temperature")
    if temperatures is not None:
        in_kelvin("temperature", temperatures)
    solid: Any = asked.material
    factor, vertical = (
        np.broadcast_to(each, flat["load"].shape)
        for each in thermal_factors(solid, temperatures)
    )
    bodies_of(solid)  # refuses what carries no film
    return _FilmScene(
        solid,
        asked.shape,
        asked.surface,
        asked.rubber,
        dims,
        flat["velocity"],
        flat["load"],
        flat["viscosity"],
        temperatures,
        flat.get("time"),
        factor,
        vertical,
    )


def _checked_shear(
    shear: float | AdhesiveShear | None,
    surface: AbstractSpectrum | None,
    temperature: ArrayLike | None,
) -> AdhesiveShear | None:
    """The shear of the real contact as a law. Raises `InputError`."""
    if shear is None:
        return None
    if surface is None:
        raise InputError(
            argument="boundary_shear",
            got=shear,
            accepted="left out without a rough surface",
            hint="it acts where that touches, and the film keeps a smooth one apart; "
            "give surface",
        )
    return shear_law(shear, temperature)


class _Scales(NamedTuple):
    """The dry contact of a point, of which everything is a multiple."""

    half: float  # a [m]
    edges: tuple[float, float]  # over a
    pressure: float  # p_ref [Pa]
    film: float  # a^2/R [m]


def _solve(
    scene: _FilmScene,
    points: Array,
    rough: Roughness | None,
    shear: AdhesiveShear | None,
) -> list[_Solved]:
    """Points of one load, temperature and time."""
    bodies = bodies_of(scene.material)
    scales = _dry(scene, points, bodies)
    rubbed, beyond = _rubbing(scene, points, scales, rough)
    out = [_Solved(half=each.half) for each in scales]
    known = [i for i, each in enumerate(scales) if np.isfinite(each.half)]
    cases = [
        _case(scene, int(points[i]), scales[i], bodies, rough, rubbed[i]) for i in known
    ]
    touching = [
        _touching(scene, int(point), each, rough, one, shear)
        for point, each, one in zip(points, scales, rubbed, strict=True)
    ]

    # numbers of each grid, from the one half as dense as the coarsest
    grids: dict[int, list[Array]] = {}

    def judged(number: int, by_grid: list[films.Film]) -> _Judged:
        """The numbers of the last grids, extrapolated."""
        i, case = known[number], cases[number]
        args = (scene, int(points[i]), scales[i], case.parameter, touching[i])
        if number not in grids:
            coarser = films.coarsened(case, by_grid[0])
            unknown = np.full(len(_NUMBERS), np.nan)
            grids[number] = [unknown if coarser is None else _numbers(coarser, *args)]
        grid_numbers = grids[number]
        grid_numbers += [
            _numbers(each, *args) for each in by_grid[len(grid_numbers) - 1 :]
        ]
        return _judge(*grid_numbers[-3:])

    def enough(number: int, by_grid: list[films.Film]) -> bool:
        return len(by_grid) >= _FEWEST and judged(number, by_grid).settled()

    if not cases:
        return out
    solved = films.follow(cases, _NODES, _MOST, enough)
    for number, by_grid in enumerate(solved):
        if len(by_grid) < 2:
            continue
        judgement = judged(number, by_grid)
        if not judgement.known():  # or the asperities' friction is not
            continue
        if not judgement.numbers[5] < _THICKEST * float(scene.shape.radius):
            continue
        i = known[number]
        out[i] = _Solved(
            judgement.numbers,
            judgement.error,
            _profile(by_grid[-1], scales[i]),
            by_grid[-1].imbalance,
            scales[i].half,
            bool(beyond[i]),
            True,
        )
    return out


class _Judged(NamedTuple):
    """Numbers of a point, extrapolated from two grids."""

    numbers: Array
    error: Array
    change: Array  # from those extrapolated one grid before; NaN: not known

    def known(self) -> bool:
        """Whether friction, films and flow are known, on the finer grid."""
        judged = [0, 5, 6, 7]
        off = self.error[judged] / np.abs(self.numbers[judged])
        return bool((off < _FLAGGED).all())

    def settled(self) -> bool:
        """Whether no finer grid is needed."""
        judged = [0, 5, 6, 7]
        change = self.change[judged] / np.abs(self.numbers[judged])
        return self.known() and bool((change < _CHANGED).all())


def _judge(coarser: Array, coarse: Array, fine: Array) -> _Judged:
    """Of three grids. The extrapolated numbers are of fourth order, so that the error
    left in them is a sixteenth of their change or so; a quarter of it is taken.
    """
    before, better = _extrapolated(coarser, coarse), _extrapolated(coarse, fine)
    change = np.abs(better - before)
    # what extrapolating changes is not known of two grids: all of their difference
    left = np.where(np.isnan(change), np.abs(fine - coarse), _UNSURE * change)
    error = np.abs(better - fine) + left
    return _Judged(better, error, change)


def _extrapolated(coarse: Array, fine: Array) -> Array:
    better = halving_limit(coarse, fine)
    return np.where(better * fine < 0, fine, better)  # of what is all but zero


def _dry(scene: _FilmScene, points: Array, bodies: list[SealBody]) -> list[_Scales]:
    """The dry contacts."""
    first, radius = int(points[0]), float(scene.shape.radius)
    line = float(scene.load[first] / scene.shape.length)
    held = _held(scene, first)
    u_rubber = MOTIONS[scene.rubber][0]
    if u_rubber == 0 and bodies[0].thickness is None:
        soft = compliance(bodies[0], held) / scene.vertical[first]
        half = np.sqrt(4 * line * radius * soft / np.pi)
        leading = trailing = np.full(points.size, half)
    else:
        leading, trailing = _dry_edges(scene, points, held)
    half = 0.5 * (leading + trailing)
    return [
        _Scales(a, (-ahead / a, behind / a), 2 * line / (np.pi * a), a**2 / radius)
        for a, ahead, behind in zip(half, leading, trailing, strict=True)
    ]


def _held(scene: _FilmScene, point: int) -> float | None:
    """Reduced time for which the pressure has stood [s]."""
    return (
        None if scene.time is None else float(scene.time[point] / scene.factor[point])
    )


def _dry_edges(
    scene: _FilmScene, points: Array, held: float | None
) -> tuple[Array, Array]:
    """Edges of the dry contact ahead of the apex and behind it [m]."""
    from ..smooth.cylinder import cylinder_on_layer

    material, velocity = scene.material, scene.velocity[points]
    temperature = None if scene.temperature is None else scene.temperature[points]
    if MOTIONS[scene.rubber][0] == 0:
        material, velocity, temperature = _at_rest(material, held), 1.0, None
    with quiet():
        load = scene.load[points] / (
            scene.vertical[points] if temperature is None else 1
        )
        asked = Asked(velocity, load, temperature=temperature)
        dry_contact = cylinder_on_layer(
            SmoothCall("friction", material, scene.shape, asked, rtol=1e-4)
        ).steady
    return np.asarray(dry_contact.contact.leading), np.asarray(
        dry_contact.contact.trailing
    )


def _at_rest(layer: Layer, held: float | None) -> Layer:
    """The layer as an elastic one, of its modulus long after or after a time."""
    material = layer.material
    if not isinstance(material, Prony):
        raise InputError(
            argument="material",
            got=material,
            accepted="an em.Prony as a layer under a film",
        )
    shear = material.shear()
    modulus = shear.equilibrium if held is None else 1 / shear.creep_compliance(held)
    elastic = replaced(
        material if material.poisson is None else shear,
        equilibrium=np.asarray(modulus),
        moduli=np.zeros(0),
        times=np.zeros(0),
        viscosity=np.zeros(()),
        shift=None,
        vertical=None,
    )
    other = None if layer.other is None else _at_rest(layer.other, held)
    return replaced(layer, material=elastic, other=other)


def _rubbing(
    scene: _FilmScene, points: Array, scales: list[_Scales], rough: Roughness | None
) -> tuple[list[Rubbing | None], Array]:
    """Friction of the asperities at each point, None on smooth surfaces, and whether it
    is beyond the data of the rubber.
    """
    if rough is None or scene.surface is None:
        return [None] * points.size, np.zeros(points.size, bool)
    temperature = (
        None if scene.temperature is None else float(scene.temperature[points[0]])
    )
    largest = float(np.nanmax([each.pressure for each in scales]))
    out, beyond = rubbing(
        scene.material,
        scene.surface,
        # a rolling contact presses its asperities for as long as it passes
        scene.velocity[points],
        largest,
        temperature,
    )
    return list(out), beyond


def _case(
    scene: _FilmScene,
    point: int,
    scales: _Scales,
    bodies: list[SealBody],
    rough: Roughness | None,
    rubbed: Rubbing | None,
) -> films.Case:
    """The film of a point, over its scales."""
    u_rubber, u_counter = MOTIONS[scene.rubber]
    velocity, radius = float(scene.velocity[point]), float(scene.shape.radius)
    mean = 0.5 * (u_rubber + u_counter) * velocity
    parameter = (
        12 * scene.viscosity[point] * mean * radius**2
        / (scales.half**3 * scales.pressure)
    )  # fmt: skip
    softness = scales.pressure * radius / (scales.half * scene.vertical[point])
    passing = float(u_rubber * velocity * scene.factor[point])
    held = _held(scene, point)

    def respond(x: Array) -> Array:
        return softness * response(bodies, x, passing, scales.half, held)

    case = films.Case(float(parameter), scales.edges, respond)
    if rough is None or rubbed is None:
        return case
    modulus = _stiffened(scene, point, rough, rubbed)
    return case._replace(
        roughness=rough.rms / scales.film,
        asperities=partial(_asperities, rough, modulus, scales),
        factor=partial(_factor, rough, scales),
    )


def _touching(
    scene: _FilmScene,
    point: int,
    scales: _Scales,
    rough: Roughness | None,
    rubbed: Rubbing | None,
    shear: AdhesiveShear | None,
) -> Touching | None:
    """What asperities do at a point, over its scales; None on smooth surfaces."""
    if rough is None or rubbed is None:
        return None
    stress = 0.0
    if shear is not None:
        temperature = None if scene.temperature is None else scene.temperature[point]
        stress = float(shear.shear_stress(scene.velocity[point], temperature))
    modulus = _stiffened(scene, point, rough, rubbed)
    at_closing, _ = rough.pressure(np.asarray(rough.closes), modulus)
    return Touching(
        rubbed,
        scales.pressure,
        stress / scales.pressure,
        rough.closes / scales.film,
        float(at_closing) / scales.pressure,
    )


def _stiffened(
    scene: _FilmScene, point: int, rough: Roughness, rubbed: Rubbing
) -> float:
    """E* of the rubber about asperities [Pa]."""
    return rough.modulus * rubbed.stiffening * float(scene.vertical[point])


def _asperities(
    rough: Roughness, modulus: float, scales: _Scales, film: Array
) -> tuple[Array, Array]:
    pressure, slope = rough.pressure(film * scales.film, modulus)
    return pressure / scales.pressure, slope * (scales.film / scales.pressure)


def _factor(rough: Roughness, scales: _Scales, film: Array) -> tuple[Array, Array]:
    factor, slope = rough.flow_factor(film * scales.film)
    return factor, slope * scales.film


def _numbers(
    solution: films.Film,
    scene: _FilmScene,
    point: int,
    scales: _Scales,
    parameter: float,
    touching: Touching | None,
) -> Array:
    """A solved film in numbers, `_NUMBERS`."""
    x, film, fluid = solution.places, solution.film, solution.pressure
    width = np.gradient(x)
    width[[0, -1]] *= 0.5
    u_rubber, u_counter = MOTIONS[scene.rubber]
    slide, mean = u_counter - u_rubber, 0.5 * (u_rubber + u_counter)
    per_load, slope = 1 / films.LOAD, scales.half / float(scene.shape.radius)
    asperity_pressure, share = solution.asperity_pressure, np.zeros(x.size)
    asperity = boundary = trapped = doubt = 0.0
    if touching is not None:
        share = touching.share(asperity_pressure)
        asperity, boundary = (
            per_load * abs(slide) * touching.friction(width, asperity_pressure)
        )
        trapped, doubt = per_load * touching.trapped(
            width, film, fluid, asperity_pressure
        )
        doubt *= abs(slide)
    # where the pressure falls H < H_m; behind the rupture the liquid covers H_m/H
    wet = np.ones(x.size)
    wet[film.argmin() :] = np.minimum(solution.flow / film[film.argmin() :], 1.0)
    # beyond both ends the gap is a parabola: int dx/H, H = x^2/2 - l, and of H_m/H^2
    lower = 0.5 * x[0] ** 2 - film[0]
    beyond = 2 / abs(x[0]) * (1 + 2 * lower / (3 * x[0] ** 2))
    beyond += wet[-1] * x[-1] / (3 * film[-1])
    sheared = slide**2 / mean * parameter / 12
    sheared *= width @ (wet * (1 - share) / film) + beyond
    pumped = mean * np.sum(0.5 * (film[1:] + film[:-1]) * np.diff(fluid))
    viscous = per_load * slope * (sheared + pumped)
    total, bent = solution.total, film - 0.5 * x**2
    rubber = np.sum(0.5 * (total[1:] + total[:-1]) * np.diff(bent))
    rubber *= per_load * u_rubber * slope
    number = np.arange(x.size)
    least = int(film.argmin())
    near = np.linspace(max(least - 1, 0), min(least + 1, x.size - 1), 401)
    return np.array([
        viscous + asperity + boundary + rubber,
        viscous,
        asperity,
        boundary,
        rubber,
        CubicSpline(x, film)(0.0) * scales.film,
        CubicSpline(number, film)(near).min() * scales.film,
        solution.flow * scales.film * mean * scene.velocity[point],
        per_load * (width @ asperity_pressure),
        trapped,
        doubt,
    ])  # fmt: skip


def _profile(film: films.Film, scales: _Scales) -> Array:
    """Of every grid the nodes of the second."""
    every = (film.places.size - 1) // (_SHOWN - 1)
    return np.stack(
        [
            film.places[::every] * scales.half,
            film.film[::every] * scales.film,
            film.pressure[::every] * scales.pressure,
            film.asperity_pressure[::every] * scales.pressure,
        ]
    )


def _report(
    scene: _FilmScene,
    solved: list[_Solved],
    good: Array,
    model: str,
    shear: AdhesiveShear | None,
) -> Lubricated:
    """The result, with what lies beyond the data of the material."""
    dims = scene.dims

    def shaped(values: ArrayLike) -> Any:
        return np.reshape(np.asarray(values, dtype=float), dims)

    numbers = np.array([each.numbers for each in solved]).reshape(-1, len(_NUMBERS))
    unsolved = np.full((4, _SHOWN), np.nan)
    profiles = np.array(
        [unsolved if each.profile is None else each.profile for each in solved]
    )
    profile = [profiles[:, i].reshape(*dims, -1) for i in range(4)]
    beyond = _beyond(scene, solved)
    left_out = softening_left_out(half_space_of(scene.material), dims)
    temperature = scene.temperature
    inputs = [
        *material_in_words(scene.material),
        ("shape", describe(scene.shape).replace(" on a layer", "")),
        ("rubber", scene.rubber),
        *(
            (name, brief(np.unique(values), unit))  # as asked for, before broadcasting
            for name, unit in _UNITS.items()
            if (values := getattr(scene, name)) is not None
        ),
    ]
    if temperature is not None:
        inputs.append(("temperature", brief(np.unique(temperature), "K")))
    if scene.surface is not None:
        inputs.append(("surface", f"{scene.surface.label}, {scene.surface.words()}"))
        inputs.append(("roughness", BOTH))
    if shear is not None:
        inputs.append(("boundary shear", shear.words()))
    named = dict(zip(_NUMBERS, map(shaped, numbers.T), strict=True))
    return Lubricated(
        velocity=shaped(scene.velocity),
        load=shaped(scene.load),
        viscosity=shaped(scene.viscosity),
        temperature=None if temperature is None else shaped(temperature),
        **named,
        imbalance=shaped([each.imbalance for each in solved]),
        error=shaped([each.errors[0] for each in solved]),
        model_error=np.full(dims, np.nan),
        profile=FilmProfile(*profile),
        converged=good.reshape(dims),
        marks=(*beyond, *_too_much(scene, solved), *_sheared(scene, shear), *left_out),
        model=model,
        plan=f"Newton's method on {_NODES} and more nodes, extrapolated",
        inputs=tuple(inputs),
    )


def _too_much(scene: _FilmScene, solved: list[_Solved]) -> tuple[Doubt, ...]:
    """Where the dry contact is deeper than it is wide, or presses harder than the modulus
    of a half-space on which it would be as wide.
    """
    half = np.array([each.half for each in solved])
    depth = np.square(half) / (2 * float(scene.shape.radius))
    deep = doubt_depth(scene.material, scene.shape, depth.reshape(scene.dims))
    pressure = 2 * scene.load / (np.pi * half * float(scene.shape.length))
    modulus = 2 * pressure * float(scene.shape.radius) / half
    return *deep, *pressed_too_hard(
        pressure.reshape(scene.dims), modulus.reshape(scene.dims)
    )


def _sheared(scene: _FilmScene, shear: AdhesiveShear | None) -> tuple[Doubt, ...]:
    """Where the shear stress of the real contact is far above the modulus there."""
    if shear is None or scene.surface is None:
        return ()
    body, reduced = half_space_of(scene.material), scene.velocity * scene.factor
    wave_number = scene.surface.q_high
    modulus = modulus_at(as_foundation(body), wave_number, reduced, scene.vertical)
    stress = shear.shear_stress(scene.velocity, scene.temperature)
    return sheared_too_hard(stress.reshape(scene.dims), modulus.reshape(scene.dims))


def _beyond(scene: _FilmScene, solved: list[_Solved]) -> tuple[Doubt, ...]:
    """Points beyond the data of the material, by the rubber or by its asperities."""
    known = scene.material.range
    shape = scene.velocity.shape
    with quiet():
        if MOTIONS[scene.rubber][0] == 0:
            rubber = held_beyond(
                known, scene.time, scene.temperature, scene.factor, shape
            )
        else:
            half = np.array([each.half for each in solved])
            rubber = steady_beyond(
                known, scene.velocity * scene.factor, half, scene.temperature
            )
    if not rubber:
        return ()
    points = where(rubber, "extrapolated") | np.array([each.beyond for each in solved])
    points = np.broadcast_to(points, shape).reshape(scene.dims)
    return told(
        known, points, "frequencies or times of the rubber, or of its asperities"
    )
