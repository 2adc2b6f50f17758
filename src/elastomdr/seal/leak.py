"""Leak of a static seal: a fluid flows through the channels that roughness leaves open.

    Q = (width/length) s pressure_drop,     s = w/(12 viscosity)

The rubber is pressed on the surface by a pressure p that has acted for a time t. Its
contact is that of an elastic body with E* = 1/J(t/a_T), since under a constant pressure
the contact grows, and p over E* decides over gaps, real contact and w [m^3], which are
the model's. What a gas changes stands in `gas.py`.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import numpy_unless_traced, xp
from ..call.extrapolation import NOT_KNOWN, held_beyond
from ..call.problem import check_carries
from ..call.several_materials import over_materials
from ..checks import (
    as_float64,
    broadcast,
    broadcast_shape,
    certain,
    is_traced,
    nan_unless,
    not_negative,
    positive,
    warn_unless,
)
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import InputError
from ..material.shift import thermal_factors
from ..material.validity import material_in_words
from ..models import GapFlow, HalfSpace, Model, Multiscale, as_model
from ..results.base import Array, Result, quantity, record, setting
from ..results.words import brief, span
from ..surface.spectrum import as_spectrum
from . import gas
from .gas import check_absolute, check_gas
from .leak_theories import CriticalConstriction, EffectiveMedium

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Material
    from ..surface.spectrum import AbstractSpectrum

_LOG_RATIO = 5.0  # of the largest to the smallest value from which on an axis is


@record
class Leak(Result):
    """Leak of a liquid or a gas through a static seal.

    Within a factor of 1 + `model_error` the rate is that of three dimensions, at 95 %
    of the points. Where `percolates` is false no channel leads through, and the rate is
    zero but for single flaws, permeation and what the model does not know.
    """

    pressure: Array = quantity("contact pressure", "Pa", shown="MPa")
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
        "s, flow per width and pressure gradient",
    )
    mean_gap: Array = quantity("mean gap", "m", "u", shown="µm")
    critical_gap: Array = quantity(
        "critical gap",
        "m",
        "of the narrowest place of the widest channel, NaN where there is none",
        shown="µm",
    )
    area_ratio: Array = quantity("real contact area over nominal area", "-", "A")
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
    slip_estimated: bool = setting(default=False)  # of a gas, by one gap for all

    title: ClassVar[str] = "Leak"
    across: ClassVar[str] = "pressure"
    shows: ClassVar[str] = "rate"
    scale: ClassVar[str] = "auto"
    error_of: ClassVar[str] = "the rate, relative"
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
        """Draws the rate, or another field, against time or pressure, whichever has more
        values; with the band of the model about a rate.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show)
        from ..results.plotting import LIGHT, Ask, Line, Sketch, draw, frame

        def band(sketch: Sketch, line: Line) -> None:
            if show not in ("rate", "mass_rate", "conductance"):
                return
            if self.model_error is None:
                return
            error = sketch.along_line(sketch.fields["model_error"], line)
            factor = 1 + np.where(np.isfinite(error), error, np.nan)
            if not np.isfinite(line.y * factor).any():
                return  # a band of NaN would take its limits from the axes
            ends = line.y / factor, line.y * factor
            look = {"color": line.colour, "alpha": LIGHT, "linewidth": 0}
            sketch.ax.fill_between(line.x, *ends, **look)

        counts = {axis.name: axis.values.size for axis in self.axes()}
        x = "time" if counts.get("time", 0) >= counts.get("pressure", 1) else "pressure"
        ask = Ask(ax, style, title, label)
        drawn = self._draw(draw, ask, x=x, y=show, also=band)
        values = np.asarray(getattr(self, show))
        values = values[np.isfinite(values) & (values > 0)]
        if values.size and values.max() > _LOG_RATIO * values.min():
            drawn.set_yscale("log")
            frame(drawn)
        return drawn

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Ranges of rate, gaps and real contact, how far the rate may be off and at how
        many points channels are closed.
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
    pressure: ArrayLike,
    pressure_drop: ArrayLike,
    viscosity: ArrayLike,
    length: ArrayLike,
    width: ArrayLike = 1.0,
    density: ArrayLike | None = None,
    outlet_pressure: ArrayLike | None = None,
    mean_free_path: ArrayLike | None = None,
    molar_mass: ArrayLike | None = None,
    time: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
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
        material: as for `em.press`, a series.
        surface: roughness by its spectrum; where the rubber is rough too, the sum of
            both spectra.
        pressure: pressure with which rubber and surface are pressed together [Pa], of a
            ring with what its fluid adds (`em.o_ring(..., fluid_pressure=)`). What the
            fluid between them carries of it is left out. Arguments broadcast.
        pressure_drop: pressure of the fluid before the seal over that behind it [Pa],
            below `pressure`: a seal that is not pressed harder than its fluid opens.
        viscosity: dynamic viscosity [Pa s]; a kinematic one times the density.
        length: of the contact along the flow [m].
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
        model: `em.Multiscale()` by default, a form that was fitted to maps; to compare
            with, `em.CriticalConstriction()` and `em.EffectiveMedium()`;
            `em.HalfSpace()` solves Reynolds' equation on maps of gaps.

    Returns:
        An `em.Leak` of the broadcast shape. `error` is relative, of the rate; by
        `em.HalfSpace` it is twice the standard error over its maps (NaN for one) and
        about what its cells hold back. `model_error` bounds the model: the rate is
        within a factor of 1 + `model_error` of three dimensions at 95 % of the points;
        infinite from a real contact of 0.38 on, where channels may as well be closed,
        NaN for the theories.

    Raises:
        InputError: for values that are not positive, a pressure drop that is not below
            the pressure, and models that have no leak or no derivatives.

    Laminar flow, without capillary forces, swelling and permeation through the rubber.
    A gas slips by an estimate, 1 + 6 Kn, which `model_error` counts in full; by
    `em.HalfSpace` it slips in each gap by itself. `model_error` is NaN above a Knudsen
    number of 0.1. The fluid does not lift the rubber within the
    seal. Differentiable with `em.Multiscale` with respect to material, surface,
    pressures, viscosity, sizes, time and temperature. Source: `docs/theory.md`.
    """
    foundation = pressed_bodies(material, surface, time)
    chosen = as_model(model, KINDS) or Multiscale()
    given = _checked(
        {
            "pressure": pressure,
            "pressure_drop": pressure_drop,
            "viscosity": viscosity,
            "length": length,
            "width": width,
            "density": density,
            "outlet_pressure": outlet_pressure,
            "mean_free_path": mean_free_path,
            "molar_mass": molar_mass,
            "time": time,
            "temperature": temperature,
        }
    )
    shape = broadcast_shape(**given)
    relative_pressure, factor = relative_pressure_of(
        foundation, _of_rubber(foundation, given)
    )
    gaps = _gaps(chosen, surface, relative_pressure)
    good = xp.broadcast_to(gaps.good, shape)
    beyond = NOT_KNOWN
    if not is_traced(relative_pressure, *given.values()):
        warn_unless(good, "points")
        factor = np.broadcast_to(factor, shape)
        temperatures = given["temperature"]
        beyond = held_beyond(foundation.range, given["time"], temperatures, factor)
    return Leak(
        **_fields(given, gaps, good, shape),
        extrapolated=beyond.points,
        slip_estimated=given["outlet_pressure"] is not None and gaps.slip is None,
        model=_model_in_words(given, gaps),
        plan=gaps.work,
        inputs=(*_inputs_in_words(foundation, surface, given), *beyond.said),
    )


def _of_rubber(foundation: Foundation, given: dict[str, Any]) -> dict[str, Any]:
    """The arguments as the rubber has them: a temperature that a gas needs does not
    change a rubber without a law for it.
    """
    lawless = foundation.shift is None and foundation.vertical is None
    only_gas = lawless and given["molar_mass"] is not None
    return given | {"temperature": None} if only_gas else given


def _gaps(model: Any, surface: Any, relative_pressure: Any) -> GapFlow:
    """The model's answers, in the shape of the pressures."""
    gaps = model.leak(surface, relative_pressure.ravel())
    numbers = {
        name: xp.reshape(x, relative_pressure.shape)
        for name, x in gaps._asdict().items()
        if name not in ("said", "work") and x is not None
    }
    return gaps._replace(**numbers)


def _model_in_words(given: dict[str, Any], gaps: GapFlow) -> str:
    if given["outlet_pressure"] is None:
        return gaps.said
    return gaps.said + (gas.SAID if gaps.slip is None else gas.SAID_OF_MAPS)


def pressed_bodies(material: Any, surface: Any, time: Any) -> Foundation:
    """The foundation of rubber that is pressed on a rough surface. Raises
    `InputError`.
    """
    if isinstance(material, Layer):
        raise InputError(
            "material must be a half-space under a rough surface, whose waves are far "
            "shorter than a layer is thick, got an em.layer: give its rubber alone."
        )
    foundation = as_foundation(material)
    as_spectrum("surface", surface)
    if foundation.per_area:
        raise InputError(
            "material must be a half-space under a rough surface, got independent "
            "springs: give their rubber alone."
        )
    if time is None:
        check_carries(foundation)
    return foundation


_CHECKS = {"outlet_pressure": check_absolute, "mean_free_path": not_negative}


def _checked(arguments: dict[str, Any]) -> dict[str, Any]:
    """The arguments as arrays. Raises `InputError`."""
    given: dict[str, Any] = dict.fromkeys(arguments)
    for name, value in arguments.items():
        if value is not None:
            given[name] = as_float64(name, value)
            _CHECKS.get(name, positive)(name, given[name])
    check_gas(given)
    pressure, drop = given["pressure"], given["pressure_drop"]
    broadcast_shape(pressure=pressure, pressure_drop=drop)
    if not is_traced(pressure, drop) and not certain(np.less, drop, pressure):
        pairs = np.broadcast_arrays(drop, pressure)
        worst = int(np.argmax(pairs[0] - pairs[1]))
        high, low = (float(x.flat[worst]) for x in pairs)
        raise InputError(
            "pressure_drop must be below pressure, got "
            f"{high:g} Pa at {low:g} Pa: a fluid that presses harder than the rubber "
            "lifts it, and the seal opens. For a seal on which the fluid "
            "presses, such as an O-ring, give the sum of both pressures, that of "
            "the squeeze and that of the fluid."
        )
    return given


def relative_pressure_of(
    foundation: Foundation, given: dict[str, Any]
) -> tuple[Any, Any]:
    """p/E*, in the shape of what it depends on, and a_T."""
    time, temperature = given["time"], given["temperature"]
    shape = broadcast_shape(
        pressure=given["pressure"], time=time, temperature=temperature
    )
    factor, vertical = (
        (1.0, 1.0) if temperature is None else thermal_factors(foundation, temperature)
    )
    compliance = (
        1 / foundation.equilibrium
        if time is None
        else foundation.creep_compliance(time / factor)
    )
    relative_pressure = given["pressure"] / vertical * compliance
    return xp.broadcast_to(relative_pressure, shape) + 0.0, factor


def _fields(
    given: dict[str, Any], gaps: GapFlow, good: Any, shape: tuple[int, ...]
) -> dict[str, Any]:
    """The numbers of the result."""
    flow, knudsen, expansion, density = gaps.flow, None, 1.0, given["density"]
    model_error = gaps.model_error
    if given["outlet_pressure"] is not None:
        flow, knudsen, expansion, of_gas = gas.gas_flow(given, gaps.flow, gaps.slip)
        density = of_gas if density is None else density
        model_error = gas.bound(model_error, knudsen)
    conductance = flow / (12 * given["viscosity"])
    rate = given["width"] / given["length"] * conductance * given["pressure_drop"]
    rate = rate * expansion
    mass_rate = None if density is None else rate * density
    numbers = {
        "rate": rate,
        "mass_rate": mass_rate,
        "conductance": conductance,
        "mean_gap": gaps.gap,
        "critical_gap": gaps.critical_gap,
        "area_ratio": gaps.area,
        "error": gaps.error,
        "model_error": model_error,
        "knudsen": knudsen,
    }
    fields = {
        name: None if value is None else nan_unless(good, xp.broadcast_to(value, shape))
        for name, value in numbers.items()
    }
    kept = (
        "pressure",
        "pressure_drop",
        "viscosity",
        "outlet_pressure",
        "time",
        "temperature",
    )
    return broadcast(
        **{name: given[name] for name in kept},
        **fields,
        percolates=gaps.percolates,
        converged=good,
    )


def _inputs_in_words(
    foundation: Foundation, surface: Any, given: dict[str, Any]
) -> list[tuple[str, str]]:
    words = "" if is_traced(surface) else f", {surface.words()}"
    inputs = [
        *material_in_words(foundation),
        ("surface", f"{surface.label}{words}"),
        ("roughness", BOTH),
    ]
    inputs += [
        (name.replace("_", " "), brief(given[name], unit))
        for name, unit in _UNITS.items()
        if given[name] is not None
    ]
    if _of_rubber(foundation, given)["temperature"] is not given["temperature"]:
        inputs.append(("rubber", "without a shift law, the same at every temperature"))
    return inputs if given["time"] is not None else [*inputs, ("relaxed", "completely")]
