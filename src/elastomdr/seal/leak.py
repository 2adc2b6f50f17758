"""Leak of a static seal: a fluid flows through the channels that roughness leaves open.

    Q = (width/length) int_0^dp s(p - p_f) dp_f,     s = w/(12 viscosity)

The rubber is pressed on the surface by a pressure p that has acted for a time t, of
which the fluid carries p_f: all of the drop dp on one side, and nothing on the other.
Contact is that of an elastic body with E* = 1/J(t/a_T), since under a constant pressure
it grows, and (p - p_f)/E* decides over gaps, real contact and w [m^3], which are the
model's. The integral, and a pressure that changes along the seal, stand in `along.py`,
what a gas changes in `gas.py`.
"""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Callable, Iterator
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..arrays import numpy_unless_traced, stop_gradient, xp
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast,
    broadcast_shape,
    is_traced,
    nan_unless,
    not_negative,
    numbers_only,
    only_one,
    positive,
    possible,
    require,
    scalar,
    untraced,
    warn_unless,
)
from ..errors import InputError, amount
from ..material.validity import material_in_words
from ..models import Model, as_model, named, seeds_of
from ..results.base import WIDE, Array, Result, quantity, record, setting
from ..results.doubts import Doubt, Kind, carried
from ..results.words import (
    brief,
    given_in_words,
    in_unit,
    span,
    surface_in_words,
)
from ..rough.problem import Resting, resting_body
from ..rough.road_models import HalfSpace, Multiscale
from ..surface.lay import lay_of
from ..surface.spectrum import as_spectrum
from ..surface.topography import skewness_of
from . import gas
from .along import AlongSeal, Fluid, PressedSeal, SealFlow, Uneven, even, uneven
from .channels import Channels, RoughSeal
from .gap_maps import MappedChannels
from .gas import LeakGiven, check_absolute, check_gas, fluid_of
from .leak_form import FittedChannels
from .leak_theories import CriticalConstriction, EffectiveMedium, LeakTheory
from .o_ring import ORing, ring_of
from .pressure_profile import Profile, pressure_profile, read_along

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Material, SteadyBody
    from ..surface.spectrum import AbstractSpectrum

_KINKS = 12  # of a profile, at which cells end
_LOG_RATIO = 5.0  # of the largest to the smallest value from which on an axis is


@record
class Leak(Result):
    """Leak of a liquid or a gas through a static seal.

    Within a factor of 1 + `model_error` the rate is that of three dimensions, at 95 %
    of the points. Where `percolates` is false no channel leads through, and the rate is
    zero but for single flaws, permeation and what the model does not know. Gaps and real
    contact are those where contact bears most: of an even pressure all of it, at the
    outlet.
    """

    pressure: Array = quantity(
        "contact pressure",
        "Pa",
        "of rubber and surface, contact and fluid; the mean along the seal",
        shown="MPa",
    )
    pressure_drop: Array = quantity("pressure drop of the fluid", "Pa", shown="MPa")
    viscosity: Array = quantity("viscosity", "Pa s")
    time: Array | None = quantity(
        "time since it was pressed", "s", "None: long after", default=None
    )
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    outlet_pressure: Array | None = quantity(
        "absolute pressure behind the seal",
        "Pa",
        "None of a liquid",
        default=None,
        shown="MPa",
    )
    rate: Array = quantity(
        "leak rate", "m^3/s", "Q, volume, of a gas at the outlet", axis="leak rate"
    )
    mass_rate: Array | None = quantity(
        "mass leak rate", "kg/s", "None where no density was given", default=None
    )
    conductance: Array = quantity(
        "flow conductance",
        "m^3/(Pa s)",
        "s, flow per width and mean pressure gradient",
    )
    mean_gap: Array = quantity(
        "mean gap", "m", "u, where contact bears most", shown="µm"
    )
    critical_gap: Array = quantity(
        "critical gap",
        "m",
        "of the narrowest place of the widest channel, where contact bears most; NaN "
        "where there is none",
        shown="µm",
    )
    area_ratio: Array = quantity(
        "real contact area over nominal area", "-", "A, where contact bears most"
    )
    lifted: Array = quantity(
        "length that is lifted",
        "m",
        "over which the fluid presses harder than the rubber",
        shown="mm",
    )
    knudsen: Array | None = quantity(
        "Knudsen number",
        "-",
        "Kn, mean free path at the mean pressure over the gap of even planes",
        default=None,
    )
    percolates: Array = quantity(
        "percolates", "", "whether channels lead through the contact"
    )
    error: Array = quantity("estimated relative error of the rate", "-")
    model_error: Array | None = quantity(
        "bound of the model's relative error",
        "-",
        "the rate is within a factor of 1 + this of three dimensions; None for those",
        default=None,
    )
    # None under JAX's transformations
    profile: AlongSeal | None = None
    slip_estimated: bool = setting(default=False)  # of a gas, by one gap for all

    title: ClassVar[str] = "Leak"
    across: ClassVar[str] = "pressure"
    shows: ClassVar[str] = "rate"
    scale: ClassVar[str] = "auto"
    error_of: ClassVar[str] = "the rate, relative"
    relative_bound: ClassVar[bool] = True
    from_zero: ClassVar[bool] = False
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "pressure",
        "temperature",
        "pressure_drop",
        "viscosity",
    )

    def plot(
        self,
        ax: Axes | None = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: str = "rate",
    ) -> Axes:
        """Draws the rate, or another field, against time, pressure or pressure drop,
        whichever has most values; with the band of the model about a rate.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show)
        from ..results.plotting import (
            DrawAsk,
            DrawnLine,
            ResultSketch,
            Shaded,
            Trace,
            draw,
            logarithmic_if_wide,
        )

        def band(sketch: ResultSketch, line: DrawnLine, drawn: Trace) -> None:
            error = sketch.fields.get("model_error")
            if error is not None and show in ("rate", "mass_rate", "conductance"):
                error = sketch.along_line(error, line)
                factor = 1 + np.where(np.isfinite(error), error, np.nan)
                ends = line.y / factor, line.y * factor
                sketch.add(Shaded(line.x, *ends, colour=line.colour, of=drawn))

        counts = {axis.name: axis.values.size for axis in self.axes()}
        names = ("time", "pressure", "pressure_drop")
        x = max(names, key=lambda name: counts.get(name, int(name == "pressure")))
        ask = DrawAsk(ax, style, title, label)
        drawn = self._draw(partial(draw, x=x, y=show, also=band), ask)
        logarithmic_if_wide(drawn, getattr(self, show), _LOG_RATIO)
        return drawn

    def fluid_pressure(self, x: ArrayLike) -> Array:
        """Pressure of the fluid over that behind the seal [Pa] at places x [m], the last
        axis: from the edge on the side of the fluid, or those of a given profile.

        Read between the places of `profile`. Raises `InputError` under `jax.jit`,
        `grad` and `vmap`.
        """
        along = self.profile
        if along is None or is_traced(x):
            raise InputError(
                argument="x",
                accepted="in plain numbers, of a leak outside jax.jit, grad and vmap",
            )
        return read_along(x, along.x, along.fluid_pressure)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Ranges of rate, gaps and real contact, how far the rate may be off and at how
        many points the fluid lifts the rubber or channels are closed.
        """
        good: Any = np.asarray(self.converged)
        for name in ("rate", "mass_rate", "mean_gap", "critical_gap", "area_ratio"):
            if (value := getattr(self, name)) is not None:
                q = next(q for q in self.quantities() if q.path == name)
                unit = "" if q.unit == "-" else q.unit
                yield q.label, span(np.asarray(value)[good], unit)
        if self.model_error is not None and np.isfinite(self.model_error).any():
            factor = span(1 + np.asarray(self.model_error))
            yield "model", f"rate within a factor of {factor}"
        if self.knudsen is not None:
            numbers = span(np.asarray(self.knudsen)[good])
            by = "in each gap by itself (to a "
            if self.slip_estimated:
                by = "(an estimate, counted in full in the bound up to a "
            yield (
                "gas",
                f"expands and slips {by}Knudsen number of 0.1), here {numbers}; volumes "
                "are at the outlet",
            )
        lifted = np.asarray(self.lifted)
        if (lifted > 0).any():
            parts = span(in_unit(lifted[lifted > 0], "mm"), "mm")
            yield (
                "lifted",
                f"the fluid presses harder than the rubber over {parts} of the length, "
                f"at {int((lifted > 0).sum())} of {good.size} points",
            )
        closed = int((good & ~np.asarray(self.percolates)).sum())
        if closed:
            yield (
                "closed",
                f"no channel leads through at {closed} of {good.size} points",
            )


KINDS: dict[str, type[Model]] = {
    kind.label: kind
    for kind in (Multiscale, CriticalConstriction, EffectiveMedium, HalfSpace)
}


def _of_maps(model: HalfSpace) -> Channels:
    return MappedChannels(model.cells, model.periods, seeds_of(model.seeds))


def _of_theory(model: LeakTheory) -> Channels:
    return model


# of each kind of model, how it answers; a new one is added here
_CHANNELS: dict[type[Model], Callable[[Any], Channels]] = {
    Multiscale: lambda _: FittedChannels(),
    HalfSpace: _of_maps,
    CriticalConstriction: _of_theory,
    EffectiveMedium: _of_theory,
}


def _channels(model: Model | str | None) -> Channels:
    """The model of a leak. Raises `InputError` for one that has none."""
    chosen = as_model(model, KINDS) or Multiscale()
    if type(chosen) not in _CHANNELS:
        raise InputError(
            argument="model",
            got=chosen,
            accepted=named(*(kind() for kind in _CHANNELS)) + " for a leak",
        )
    return _CHANNELS[type(chosen)](chosen)


_UNITS = {
    "pressure": "Pa",
    "pressure_drop": "Pa",
    "viscosity": "Pa s",
    "length": "m",
    "width": "m",
    "density": "kg/m^3",
    "outlet_pressure": "Pa",
    "mean_free_path": "m",
    "molar_mass": "kg/mol",
    "time": "s",
    "temperature": "K",
}
BOTH = "surface alone: the sum of both spectra where the rubber is rough too"


@over_materials
@numpy_unless_traced
def leak(
    material: Material | Sequence[Material],
    surface: AbstractSpectrum,
    *,
    pressure: ArrayLike | None = None,
    profile: tuple[ArrayLike, ArrayLike] | str | os.PathLike[str] | None = None,
    o_ring: ORing | None = None,
    pressure_drop: ArrayLike,
    viscosity: ArrayLike | None = None,
    kinematic_viscosity: ArrayLike | None = None,
    length: ArrayLike | None = None,
    width: ArrayLike = 1.0,
    density: ArrayLike | None = None,
    outlet_pressure: ArrayLike | None = None,
    mean_free_path: ArrayLike | None = None,
    molar_mass: ArrayLike | None = None,
    time: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    direction: float | None = None,
    model: Multiscale
    | CriticalConstriction
    | EffectiveMedium
    | HalfSpace
    | str
    | None = None,
) -> Leak:
    """Leak of a liquid or a gas through a static seal, from its roughness and the
    rubber's creep.

    Args:
        material: as for `em.press`.
        surface: roughness by its spectrum; where the rubber is rough too, the sum of
            both spectra.
        pressure: pressure with which rubber and surface are pressed together [Pa], the
            same along the flow; of a ring with what its fluid adds (`em.o_ring(...,
            fluid_pressure=)`). Arguments broadcast.
        profile: in its place a pressure that changes along the flow, from the side of
            the fluid on: positions [m] and pressures [Pa], or a file with these two
            columns and their units in its title line, such as position [mm], pressure
            [MPa].
        o_ring: in its place an `em.o_ring` result of the same rubber, with its time and
            temperature: the pressure is Hertz' ellipse, and with a `fluid_pressure` what
            that adds, everywhere.
        pressure_drop: pressure of the fluid before the seal over that behind it [Pa],
            below the largest pressure: a seal that is nowhere pressed harder than its
            fluid opens.
        viscosity: dynamic viscosity [Pa s].
        kinematic_viscosity: in its place [m^2/s], of a liquid, with `density`.
        length: of the contact along the flow [m]; a profile and an O-ring have their own.
        width: of the contact across the flow [m], such as the circumference of a ring.
        density: density [kg/m^3], of a gas that at the outlet: gives `mass_rate`.
        outlet_pressure: pressure behind the seal [Pa], absolute: makes the fluid an
            ideal gas, whose `rate` is the volume at this pressure.
        mean_free_path: of the molecules of the gas at the outlet [m]; 0 without slip.
        molar_mass: molar mass of the gas [kg/mol], with the temperature in place of
            the mean free path: gives `mass_rate` as well.
        time: how long the pressure has acted since it was put on at once [s]; None for
            long after.
        temperature: temperature [K], for a material with a shift law, and with
            molar_mass, where it is that of the gas; a rubber without a shift law is then
            the same at every temperature. The viscosity is that given.
        direction: of the flow, as an angle to the lay of a measured surface [rad]: 0
            along the grooves, pi/2 across. `em.HalfSpace()` computes that flow; by others
            it is what `model_error` holds of the lay, without it of both ways.
        model: `em.Multiscale()` by default, a form that was fitted to maps; to compare
            with, `em.CriticalConstriction()` and `em.EffectiveMedium()`;
            `em.HalfSpace()` solves Reynolds' equation on maps of gaps.

    Returns:
        An `em.Leak` of the broadcast shape. `error` is relative, of the rate; by
        `em.HalfSpace` it is twice the standard error over its maps (NaN for one) and
        about what its cells hold back. `model_error` bounds the model: the rate is
        within a factor of 1 + `model_error` of three dimensions at 95 % of the points,
        by the bounds at the pressures that contact bears along the seal; infinite where
        all of these have a real contact of 0.38 or more, at which channels may as well be
        closed, NaN for the theories. Lay and skewness of a measured surface, which the
        model does not know, are in the bound, up to a Peklenik number of 5 and a skewness
        of 1, beyond which it is NaN, as where it is ten thousand or more.

    Raises:
        InputError: for values that are not positive, a pressure drop that is not below
            the pressure, and models that have no leak or no derivatives.

    The fluid carries its share: where it has the pressure p_f, contact bears p - p_f.
    A softening of the material is followed as in `em.break_out`, but by `em.HalfSpace`.
    Laminar flow, without capillary forces, swelling and permeation through the rubber.
    A gas slips by an estimate, 1 + 6 Kn, which `model_error` counts in full; by
    `em.HalfSpace` it slips in each gap by itself. `model_error` is NaN above a Knudsen
    number of 0.1. Differentiable with `em.Multiscale` and `pressure` with respect to
    material, surface, pressures, viscosity, sizes, time and temperature. Source:
    `docs/seal.md`.
    """
    if o_ring is not None:
        o_ring = ring_of(material, o_ring)
        time = _of_ring("time", time, o_ring.time)
        temperature = _of_ring("temperature", temperature, o_ring.temperature)
    solid: Any = material  # `over_materials` has taken a list apart
    foundation = resting_body(solid, time)
    as_spectrum("surface", surface)
    chosen = _channels(model)
    seal = _seal(pressure, profile, o_ring, length)
    given = _check(
        {
            "pressure": seal.pressure,
            "pressure_drop": pressure_drop,
            "viscosity": viscosity,
            "kinematic_viscosity": kinematic_viscosity,
            "length": seal.length,
            "width": width,
            "density": density,
            "outlet_pressure": outlet_pressure,
            "mean_free_path": mean_free_path,
            "molar_mass": molar_mass,
            "time": time,
            "temperature": temperature,
        },
        seal.peak,
    )
    shape = broadcast_shape(given._asdict())
    fluid, given = fluid_of(given)
    temperature = _of_rubber(foundation, given)
    rest = Resting.of(foundation, surface, given.time, temperature)
    way = None if direction is None else _angle(direction)
    rough = RoughSeal(surface, foundation.softening, way)
    pressed = PressedSeal(chosen, rough, rest.soft, given.pressure_drop, fluid)
    if seal.pressure_at is None:
        flow = even(pressed, given.pressure, given.length)
    else:
        flow = _along(pressed, seal, seal.pressure_at)
    good = xp.broadcast_to(flow.good, shape)
    why = "" if seal.pressure_at is None else _STEEP
    warn_unless(good, "points", reason=why)
    doubts = rest.doubts(seal.peak, shape, chosen.softens)
    inputs = tuple(_inputs_in_words(foundation, pressed, given, seal))
    found = _report(given, flow, good, inputs)
    wide = _judge(pressed, found.model_error, good)
    of_ring = () if o_ring is None else o_ring.examined()
    theirs = carried(of_ring, lambda points: xp.broadcast_to(points.any(), shape))
    return dataclasses.replace(found, marks=(*doubts, *wide, *theirs))


def _angle(direction: float) -> float:
    """The direction of the flow [rad]. Raises `InputError`."""
    numbers_only({"direction": direction}, "bounds alone depend on it")
    angle: Any = scalar("direction", direction)
    require("direction", angle, "finite [rad]", np.isfinite)
    return float(angle)


class _Seal(NamedTuple):
    """How rubber and surface are pressed together along the flow."""

    pressure: Any  # the mean [Pa]
    length: Any  # [m]
    peak: Any  # the largest pressure [Pa]
    start: float = 0.0  # place on the side of the fluid [m]
    pressure_at: Callable[[Any], Any] | None = None  # of parts of the length
    said: str = ""
    kinks: Array = np.zeros(0)  # parts of the length


def _seal(
    pressure: ArrayLike | None,
    profile: Profile | None,
    ring: ORing | None,
    length: ArrayLike | None,
) -> _Seal:
    """The one that is given of the three. Raises `InputError`."""
    only_one({"pressure": pressure, "profile": profile, "o_ring": ring})
    if pressure is not None:
        if length is None:
            raise InputError(argument="length", accepted="given where pressure is")
        return _Seal(pressure, length, pressure)
    untraced(
        _pressure_alone(),
        profile,
        ring,
        length,
    )
    if ring is not None:
        return _of_hertz(ring, length)
    x, p = pressure_profile(profile, 2)
    not_negative("profile", p)
    whole = float(x[-1] - x[0])
    _check_length(length, whole, "the profile")
    mean = float(np.sum(0.5 * (p[1:] + p[:-1]) * np.diff(x))) / whole

    def between(parts: Array) -> Any:
        return np.interp(x[0] + whole * parts, x, p)

    said = f"{x.size} points, of {brief(p.max(), 'Pa')} at most"
    # those at which the slope jumps most
    jumps = abs(np.diff(np.diff(p) / np.diff(x)))
    most = 1 + np.argsort(-jumps, kind="stable")[:_KINKS]
    kinks = (x[most] - x[0]) / whole
    return _Seal(mean, whole, float(p.max()), float(x[0]), between, said, kinks)


def _of_hertz(ring: ORing, length: ArrayLike | None) -> _Seal:
    """Hertz' ellipse, and what the fluid of the ring adds, everywhere."""
    _check_length(length, ring.width, "the O-ring")
    added: Any = 0.0
    if ring.sealing_pressure is not None:
        added = ring.sealing_pressure - ring.pressure
    peak = 4 / np.pi * ring.pressure

    def ellipse(parts: Array) -> Array:
        across = np.sqrt(1 - (2 * parts - 1) ** 2)
        return (peak[..., None] * across) + np.asarray(added)[..., None]

    return _Seal(
        ring.pressure + added, ring.width, peak + added, 0.0, ellipse,
        "Hertz' ellipse of an O-ring",
    )  # fmt: skip


def _pressure_alone() -> InputError:
    return InputError(
        argument="pressure",
        accepted="given under jax.jit, grad and vmap, in place of profile or o_ring",
        hint="their flow is searched with concrete numbers",
    )


def _check_length(length: ArrayLike | None, known: Array | float, whose: str) -> None:
    if length is None:
        return
    if not np.allclose(as_float64("length", length), known, rtol=1e-6, atol=0):
        raise InputError(
            argument="length",
            got=length,
            accepted=f"left out, or that of {whose}, {brief(known, 'm')}",
        )


def _of_ring(name: str, value: ArrayLike | None, of_ring: Array | None) -> Any:
    """Time or temperature of an O-ring. Raises `InputError` where another is given."""
    if value is None or of_ring is None:
        return of_ring if value is None else value
    if not np.allclose(as_float64(name, value), of_ring, rtol=1e-9, atol=0):
        raise InputError(
            argument=name,
            got=value,
            accepted=f"left out, or that of the O-ring, {of_ring}",
        )
    return of_ring


def _along(
    pressed: PressedSeal,
    seal: _Seal,
    pressure_at: Callable[[Array], Array],
) -> SealFlow:
    """The flow where the pressure changes along it, in the shape of its points."""
    soft, drop, (expands, path) = pressed.soft, pressed.drop, pressed.fluid
    arrays = (soft, drop, expands, path, seal.length, seal.peak)
    untraced(
        _pressure_alone(),
        pressed.rough,
        *arrays,
    )
    shape = np.broadcast_shapes(*map(np.shape, arrays))
    soft, drop, expands, path, length, peak = (
        np.broadcast_to(each, shape).ravel() for each in arrays
    )

    def flat(parts: Array) -> Array:
        along = pressure_at(parts)
        return np.broadcast_to(along, (*shape, parts.size)).reshape(-1, parts.size)

    pressed = pressed._replace(soft=soft, drop=drop, fluid=Fluid(expands, path))
    start = np.full(soft.shape, seal.start)
    flow = uneven(pressed, Uneven(start, length, peak, flat, seal.kinks))
    of_points = {
        name: value.reshape(shape)
        for name, value in flow._asdict().items()
        if isinstance(value, np.ndarray)
    }
    profile: Any = flow.profile
    places = (each.reshape(*shape, -1) for each in vars(profile).values())
    return flow._replace(**of_points, profile=AlongSeal(*places))


def _of_rubber(foundation: SteadyBody, given: LeakGiven) -> Array | None:
    """The temperature as the rubber has it: one that a gas needs does not change a
    rubber without a law for it.
    """
    lawless = foundation.shift is None and foundation.vertical is None
    return None if lawless and given.molar_mass is not None else given.temperature


def _model_in_words(given: LeakGiven, flow: SealFlow) -> str:
    if given.outlet_pressure is None:
        return flow.said
    return flow.said + (gas.SAID_OF_MAPS if flow.slips_by_itself else gas.SAID)


_STEEP = (
    "A peak of the pressure that is all but carried by the fluid holds it back over a "
    "length that cannot be resolved."
)
_CHECKS = {"outlet_pressure": check_absolute, "mean_free_path": not_negative}


def _check(arguments: dict[str, ArrayLike | None], peak: ArrayLike) -> LeakGiven:
    """The arguments as arrays. Raises `InputError`."""
    arrays = {
        name: as_float64(name, value)
        for name, value in arguments.items()
        if value is not None
    }
    for name, value in arrays.items():
        _CHECKS.get(name, positive)(name, value)
    kinematic = arrays.pop("kinematic_viscosity", None)
    only_one({"viscosity": arrays.get("viscosity"), "kinematic_viscosity": kinematic})
    if kinematic is not None:
        if "density" not in arrays or "outlet_pressure" in arrays:
            raise InputError(
                argument="kinematic_viscosity",
                got=kinematic,
                accepted="given [m^2/s] with the density [kg/m^3] of a liquid",
                hint="their product is the dynamic viscosity, which a gas has at every "
                "pressure",
            )
        arrays["viscosity"] = kinematic * arrays["density"]
    given = LeakGiven(**arrays)
    check_gas(given)
    drop, peak = given.pressure_drop, as_float64("pressure", peak)
    broadcast_shape({"pressure": peak, "pressure_drop": drop})
    if not possible(lambda low, high: np.all(low < high), drop, peak):
        pairs = np.broadcast_arrays(drop, peak)
        worst = int(np.argmax(pairs[0] - pairs[1]))
        high, low = (float(x.flat[worst]) for x in pairs)
        raise InputError(
            argument="pressure_drop",
            got=high,
            accepted="below pressure, " + amount(low, "Pa"),
            hint="a fluid that presses harder than the rubber lifts it, and the seal "
            "opens; for a seal on which the fluid presses, such as an O-ring, give the "
            "sum of both pressures, that of the squeeze and that of the fluid",
        )
    return given


def _report(
    given: LeakGiven, flow: SealFlow, good: Array, inputs: tuple[tuple[str, str], ...]
) -> Leak:
    """The result but for its marks, one of which depends on its bound."""
    outlet, model_error = given.outlet_pressure, flow.model_error
    expansion, knudsen = 1.0, None
    flows = flow.through > 0
    if outlet is not None:
        expansion = 1 + 0.5 * given.pressure_drop / outlet
        knudsen = xp.where(flows, flow.slip, xp.nan)
        model_error = gas.bound(model_error, knudsen)
    conductance = flow.through / expansion / (12 * given.viscosity)
    rate = given.width / given.length * conductance * given.pressure_drop
    rate, density = rate * expansion, given.density
    numbers = {
        "rate": rate,
        "mass_rate": None if density is None else rate * density,
        "conductance": conductance,
        "mean_gap": flow.gap,
        "critical_gap": flow.critical_gap,
        "area_ratio": flow.area,
        "lifted": flow.lifted,
        "error": flow.error,
        # that of closed channels, infinite, would make NaN of a zero cotangent
        "model_error": stop_gradient(model_error),
        "knudsen": knudsen,
    }
    shape = good.shape
    fields = {
        name: None if value is None else nan_unless(good, xp.broadcast_to(value, shape))
        for name, value in numbers.items()
    }
    profile = None
    if flow.profile is not None:
        places = vars(flow.profile).values()
        profile = AlongSeal(
            *(np.where(good[..., None], each, np.nan) for each in places)
        )
    return Leak(
        **broadcast(
            {
                "pressure": given.pressure,
                "pressure_drop": given.pressure_drop,
                "viscosity": given.viscosity,
                "outlet_pressure": outlet,
                "time": given.time,
                "temperature": given.temperature,
                **fields,
                "percolates": flows,
                "converged": good,
            }
        ),
        profile=profile,
        slip_estimated=outlet is not None and not flow.slips_by_itself,
        model=_model_in_words(given, flow),
        plan=flow.work,
        inputs=inputs,
    )


def _heights_in_words(pressed: PressedSeal) -> list[str]:
    """What a measured surface has that the model does not know."""
    surface, remarks = pressed.rough.surface, []
    skewness = getattr(surface, "skewness", 0.0)
    turned = pressed.model.turns and pressed.rough.direction is not None
    if lay_of(surface) is not None and not turned:
        remarks.append(
            "the surface has a lay, along which more flows and across which less, through "
            "channels that close earlier: the rate is that of its mean spectrum"
        )
    if skewness_of(surface):
        error = getattr(surface, "skewness_error", 0.0)
        remarks.append(
            f"heights of skewness {skewness:.2f} +- {error:.2f} where the model has "
            "Gaussian ones: past worn summits less flows, past peaks more"
        )
    return remarks


def _judge(
    pressed: PressedSeal, model_error: Array | None, good: Array
) -> tuple[Doubt, ...]:
    """Where the bound is wide, or not known, of a surface whose lay or skewness is why."""
    remarks = _heights_in_words(pressed)
    if not remarks or model_error is None:
        return ()
    remedy = "a measured leak, or a surface without lay and with Gaussian heights"
    cases: list[tuple[Kind, Array, str]] = [
        ("bound", model_error > WIDE, "a bound on the model above half of")
    ]
    # theories have none for any heights, and maps none with softening
    of_maps = isinstance(pressed.model, MappedChannels)
    if isinstance(pressed.model, FittedChannels) or (
        of_maps and pressed.rough.softening is None
    ):
        cases.append(
            ("no prediction", xp.isnan(model_error), "no bound on the model for")
        )
    return tuple(
        Doubt(
            kind,
            stop_gradient(points & good),
            "; ".join([f"have {words} the leak rate", *remarks]),
            remedy,
        )
        for kind, points, words in cases
    )


def bodies_in_words(
    foundation: SteadyBody, surface: AbstractSpectrum
) -> list[tuple[str, str]]:
    """The rubber, the surface, and where the roughness is."""
    return [
        *material_in_words(foundation),
        ("surface", surface_in_words(surface)),
        ("roughness", BOTH),
    ]


def _inputs_in_words(
    foundation: SteadyBody, pressed: PressedSeal, given: LeakGiven, seal: _Seal
) -> list[tuple[str, str]]:
    surface, _, direction = pressed.rough
    inputs = bodies_in_words(foundation, surface)
    inputs += given_in_words(given, _UNITS)
    if seal.said:
        inputs.append(("profile", seal.said))
    inputs += [("as read", remark) for remark in getattr(surface, "report", ())]
    if direction is not None:
        known = "" if lay_of(surface) is not None else ": no lay is known"
        inputs.append(("direction", f"{brief(direction, 'rad')} to the lay{known}"))
    inputs += [("heights", remark) for remark in _heights_in_words(pressed)]
    if _of_rubber(foundation, given) is not given.temperature:
        inputs.append(("rubber", "without a shift law, the same at every temperature"))
    return inputs
