"""Rolling bodies, belts, cords and drives: what `em.warming`, `conveyor`, `squeezed_cord` and `stability` return."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, Literal

import numpy as np

from ..checks import significant
from ..errors import InputError
from .axes import Axis, place_in_words
from .base import Array, Result, quantity, record
from .words import in_unit, in_words, span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style

_SHOWN = 6  # curves that a summary lists one by one
_ALIKE = 1e-9  # relative, of two velocities


@record
class Warming(Result):
    """Temperature of a rolling body heated by its own resistance; NaN with `converged=False` where there is none.

    Without a time `temperature`, `power` and `coefficient` are those of the steady state. With one, the last axis of
    every field is time. `settling` is the time constant with which the body approaches its steady temperature,
    C/(H - dP/dT); None where no heat capacity was given. `plot` draws the temperature against time, or the steady one
    against velocity.
    """

    time: Array | None = quantity("time", "s", "since the start at the ambient temperature", default=None)
    velocity: Array = quantity("velocity", "m/s", "rolling velocity v", axis="rolling velocity")
    load: Array = quantity("normal force", "N", "F_N")
    ambient: Array = quantity("ambient temperature", "K", "of the surroundings, T_a", shown="°C")
    conductance: Array = quantity("conductance", "W/K", "H, from the body to its surroundings")
    capacity: Array | None = quantity("heat capacity", "J/K", "C", default=None)
    temperature: Array = quantity("temperature", "K", "T", shown="°C")
    steady: Array = quantity("steady temperature", "K", "T of the steady state", shown="°C")
    settling: Array | None = quantity("time constant", "s", "near the steady state", default=None)
    power: Array = quantity("dissipated power", "W", "at T")
    coefficient: Array = quantity("rolling resistance coefficient", "-", "at T")
    error: Array = quantity("estimated error of the temperature", "K")

    title: ClassVar[str] = "Warming by rolling resistance"
    figure: ClassVar[str] = "draw_warming"
    shows: ClassVar[str] = "temperature"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the temperature"
    coordinates: ClassVar[tuple[str, ...]] = ("time", "velocity", "load", "ambient", "conductance", "capacity")

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The coldest and the warmest steady state."""
        steady, rise = np.asarray(self.steady), np.asarray(self.steady - self.ambient)
        if np.isfinite(rise).any():
            for i in dict.fromkeys((int(np.nanargmin(rise)), int(np.nanargmax(rise)))):
                place = [in_words("velocity", float(np.ravel(self.velocity)[i]))]
                for axis, at in zip(self.axes(), np.unravel_index(i, steady.shape), strict=True):
                    if axis.values.size > 1 and axis.name not in ("velocity", "time"):
                        place.append(place_in_words(axis, int(at)))
                kelvin = in_words("temperature", float(steady.ravel()[i]))
                text = f"{kelvin}, {significant(float(rise.ravel()[i]))} K above the surroundings"
                yield f"steady at {', '.join(place)}", text


@record
class Conveyor(Result):
    """Resistance and power per length of belt; a point of which one roll failed is NaN with `converged=False`.

    `power` in W/m is also that in kW per kilometre.
    """

    velocity: Array = quantity("velocity", "m/s", "belt speed v", axis="belt speed")
    belt: Array = quantity("mass of the belt", "kg/m", "per length")
    goods: Array = quantity("mass of the goods", "kg/m", "per length")
    temperature: Array | None = quantity("temperature", "K", "None where none was given", default=None, shown="°C")
    carry: Array = quantity("resistance of the carry side", "N/m", "per length of belt")
    back: Array = quantity("resistance of the return side", "N/m", "per length of belt")
    resistance: Array = quantity("resistance", "N/m", "both sides together")
    power: Array = quantity("power", "W/m", "v times the resistance", axis="power per length of belt", shown="kW/km")
    coefficient: Array = quantity("resistance over weight", "-", "of goods and of both strands of the belt")
    error: Array = quantity("estimated error of the coefficient", "-")

    title: ClassVar[str] = "Indentation rolling resistance of a belt conveyor"
    shows: ClassVar[str] = "power"
    error_of: ClassVar[str] = "the coefficient"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "temperature", "belt", "goods")

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Least and largest power per kilometre, and where."""
        power = np.ravel(self.power)
        if np.isfinite(power).any():
            for i in dict.fromkeys((int(np.nanargmin(power)), int(np.nanargmax(power)))):
                place = f"{in_words('velocity', float(np.ravel(self.velocity)[i]))}, "
                place += f"{significant(float(np.ravel(self.goods)[i]))} kg/m of goods"
                if self.temperature is not None:
                    place += f", {in_words('temperature', float(np.ravel(self.temperature)[i]))}"
                share = significant(100 * float(np.ravel(self.carry)[i] / np.ravel(self.resistance)[i]), 3)
                over = significant(float(np.ravel(self.coefficient)[i]))
                text = f"{significant(float(power[i]))} kW per km of belt, {share} % of it on the carry side"
                yield f"at {place}", f"{text}; resistance over weight {over}"


@record
class SqueezedCord(Result):
    """Contact of a squeezed cord with either wall.

    `error` is that of the arithmetic alone, zero: what the formula itself leaves open `model` says.
    """

    diameter: Array = quantity("diameter of the cord", "m", "d", shown="mm")
    squeeze: Array = quantity("squeeze", "-", "C, part of d", axis="squeeze of the diameter", shown="%")
    time: Array | None = quantity("time since it was squeezed", "s", "None: relaxed", default=None)
    temperature: Array | None = quantity("temperature", "K", "None where none was given", default=None, shown="°C")
    line_load: Array = quantity("line load", "N/m", "W, force per length of cord", axis="force per length of cord")
    width: Array = quantity("width of the contact", "m", "2a", shown="mm")
    pressure: Array = quantity(
        "mean pressure", "Pa", "W/2a, of the contact; the largest is 4/pi of it", axis="mean pressure of the contact",
        shown="MPa",
    )  # fmt: skip
    error: Array = quantity("error of the arithmetic", "N/m")

    title: ClassVar[str] = "Squeezed cord"
    across: ClassVar[str] = "squeeze"
    scale: ClassVar[str] = "auto"
    shows: ClassVar[str] = "pressure"
    error_of: ClassVar[str] = "the arithmetic"
    coordinates: ClassVar[tuple[str, ...]] = ("time", "squeeze", "temperature", "diameter")

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: Literal["pressure", "width", "line_load"] = "pressure",
    ) -> "Axes":
        """Draws pressure, width or line_load against time where there are several times, else against the squeeze.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        shown = ("pressure", "width", "line_load")
        if show not in shown:
            raise InputError(f"show must be one of {', '.join(shown)}, got {show!r}.")
        from .plotting import Ask, draw

        x = "time" if any(axis.name == "time" for axis in self.axes()) else "squeeze"
        return self._draw(draw, Ask(ax, style, title, label), x=x, y=show)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of line load, width and pressure."""
        yield "line load", span(self.line_load, "N/m")
        yield "contact width", span(in_unit(self.width, "mm"), "mm")
        yield "mean pressure", span(in_unit(self.pressure, "MPa"), "MPa")


@record
class Stability(Result):
    """Damping of a drive about steady sliding, for each velocity; the last axis is that of the velocities.

    Where `follows` is False the ratio decides nothing. A velocity at which the force is not known, or beside one, is
    NaN with `converged=False`. `plot` draws the ratio, dotted where it decides nothing, the unstable range shaded.
    """

    velocity: Array = quantity("velocity", "m/s", "V of the drive", axis="velocity of the drive")
    force: Array = quantity("friction force", "N", "F(V), as given")
    slope: Array = quantity("slope of the friction force", "N s/m", "F'(V)")
    ratio: Array = quantity("damping ratio", "-", "zeta; below zero swings grow", axis=r"damping ratio $\zeta$")
    follows: Array = quantity(
        "friction follows the speed at once", "", "V > lambda sqrt(k/m); where it does not, ask em.drive"
    )
    error: Array = quantity(
        "estimated error of the damping ratio", "-", "by the differences; NaN for fewer than five velocities together"
    )
    slowest: Array = quantity("slowest velocity that friction follows", "m/s", "lambda sqrt(k/m)", dims="")

    title: ClassVar[str] = "Stability of a drive"
    figure: ClassVar[str] = "draw_stability"
    shows: ClassVar[str] = "ratio"
    scale: ClassVar[str] = "log"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the damping ratio"
    unflagged: ClassVar[str] = "does not enter: the forces are given, what they are extrapolated from is not seen"

    def axes(self) -> list[Axis]:
        """The axes of the fields by name, with their values; a force that is the same at all velocities names one."""
        return [axis._replace(name="friction_force") if axis.name == "load" else axis for axis in super().axes()]

    def outcome(self) -> Iterator[tuple[str, str]]:
        """From which velocity on the ratio decides, the least ratio there, and where swings grow."""
        yield "decides", f"above {in_words('velocity', float(self.slowest))}; slower than that ask em.drive"
        fields = {q.key: value for q, value in self.fields().items()}
        for curve in self.curves()[1][:_SHOWN]:
            velocity, ratio, counts = (fields[key][curve.at] for key in ("velocity", "ratio", "follows"))
            counts = counts & np.isfinite(ratio)
            text = _growing(velocity, ratio, counts, float(self.slowest))
            yield "at " + curve.label if curve.label else "result", text
            known = _sticks(velocity, fields["force"][curve.at], ratio, counts, float(self.slowest))
            yield "stick-slip", known
        holes, alone = np.isnan(fields["force"]), fields["converged"] & np.isnan(fields["error"])
        if holes.any():
            text = f"{holes.sum()} of {holes.size} forces; the ratio there and beside them is left out"
            yield "not known", text + (f", and its error at {alone.sum()} others" if alone.any() else "")


def unstable(velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float) -> list[tuple[float, float]]:
    """Ranges of velocity in which swings grow, from where the ratio crosses zero, linear in ln V in between.

    One that begins below `limit`, from which on the ratio counts, begins there.
    """
    found: list[tuple[float, float]] = []
    at = np.log(velocity)
    for i in np.flatnonzero(counts & (ratio < 0)):
        ends = []
        for j in (i - 1, i + 1):
            known = 0 <= j < ratio.size and np.isfinite(ratio[j])
            if known and ratio[j] >= 0:
                crossing = at[i] + (at[j] - at[i]) * ratio[i] / (ratio[i] - ratio[j])
                ends.append(max(crossing, np.log(limit)))
            else:
                ends.append(np.log(limit) if known and not counts[j] else at[i])
        if found and i > 0 and counts[i - 1] and ratio[i - 1] < 0:
            found[-1] = (found[-1][0], float(np.exp(ends[1])))
        else:
            found.append((float(np.exp(ends[0])), float(np.exp(ends[1]))))
    return found


def _sticks(velocity: np.ndarray, force: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float) -> str:
    """Yes or no, and the friction force there."""
    if not counts.any():
        return f"not decided: friction follows the speed only above {in_words('velocity', limit)}; ask em.drive"
    ranges = unstable(velocity, ratio, counts, limit)
    if not ranges:
        return f"no, above {in_words('velocity', limit)}: swings die out; friction {span(force[counts], 'N')}"
    falls = force[counts & (ratio < 0)]
    return f"yes, {' and '.join(_range(*ends, limit) for ends in ranges)}: swings grow; friction {span(falls, 'N')}"


def _growing(velocity: np.ndarray, ratio: np.ndarray, counts: np.ndarray, limit: float) -> str:
    if not counts.any():
        return "no velocity at which the ratio decides"
    least = np.flatnonzero(counts)[ratio[counts].argmin()]
    place = in_words("velocity", float(velocity[least]))
    text = f"damping ratio at least {significant(float(ratio[least]))}, at {place}: "
    ranges = unstable(velocity, ratio, counts, limit)
    if not ranges:
        return text + "swings die out"
    return text + "swings grow " + " and ".join(_range(low, high, limit) for low, high in ranges)


def _range(low: float, high: float, limit: float) -> str:
    if low <= limit * (1 + _ALIKE):
        return f"from below {significant(limit)} to {significant(high)} m/s"
    return f"at {in_words('velocity', low)}" if low == high else f"at {significant(low)} to {significant(high)} m/s"
