"""The temperature of a rolling body: the heat of its own resistance against what it
gives off.

One temperature for the body, heat capacity C, losing heat through a conductance H to
surroundings at T_a:

    C dT/dt = P(T) - H (T - T_a),      P(T) = v F(v, T) the power of `em.rolling`.

Rubber that gets warmer gets faster, so that P falls with T above the loss peak and the
rise is less than P(T_a)/H. On the glassy side P grows with T and there may be several
steady states (`other_states`); a body that starts at T_a reaches the lowest.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..arrays import on_numpy, stop_gradient, xp
from ..call.problem import check_rtol
from ..call.several_materials import over_materials
from ..checks import (
    Array,
    argmax,
    as_float64,
    ascending,
    broadcast,
    is_traced,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    plain,
    positive_arrays,
    require,
    significant,
)
from ..element.law import Foundation, as_foundation
from ..element.layer import Layer
from ..errors import ConvergenceWarning, InputError, amount, quiet, warn
from ..material.shift import thermal_factors
from ..numerics.interpolation import halving_limit, lagrange
from ..progress_bar import counted
from ..results.axes import place_in_words
from ..results.base import Result, quantity, record
from ..results.curve import RollingCurve
from ..results.doubts import carried
from ..results.words import brief, in_words
from ..verbs.rolling import rolling

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike

# temperatures at which the steady state is looked for: two that lie between the same
# ones are missed
_SCAN = 257
_SCAN_RTOL = 1e-3  # relative error of the power there
_REFINED_SCAN = 5  # temperatures between the two on either side of it
# sets of temperatures, one call of `rolling` each; the last one of a history counts for
# those of its instants
_SETS, _SETS_WITH_HISTORY, _INSTANTS = 6, 12, 5
_HISTORY_NODES = 49  # temperatures between start and steady state, and
_FINER = 4  # by how many more between them, where the power is interpolated
# Change of ln a_T from one computed temperature to the next. Over ln v a spectrum is
# analytic within pi/2, so that eight of them miss some (step/(pi/2))^8 of the power.
_SCAN_STEP, _HISTORY_STEP = 0.5, 0.2
_STENCIL = 8
# of the last Newton step, what it may leave: its slope is good to a few per cent
_NEWTON_REMAINDER = 0.1
# fields of the steady state that a history has at every instant
_HELD = (
    "velocity",
    "load",
    "ambient",
    "conductance",
    "steady",
    "model_error",
    "other_states",
    "converged",
)
# times rtol of the rise, the error up to which a temperature is handed out
_ACCEPTED_ERROR = 10


@record
class HeatBuildUp(Result):
    """Temperature of a rolling body heated by its own resistance; NaN with
    `converged=False` where there is none.

    Without a time `temperature`, `power` and `coefficient` are those of the steady
    state. With one, the last axis of every field is time. `settling` is the time
    constant with which the body approaches its steady temperature, C/(H - dP/dT); None
    where no heat capacity was given. `plot` draws the temperature against time, or the
    steady one against velocity.
    """

    time: Array | None = quantity(
        "time", "s", "since the start at the ambient temperature", default=None
    )
    velocity: Array = quantity(
        "velocity", "m/s", "rolling velocity v", axis="rolling velocity"
    )
    load: Array = quantity("normal force", "N", "F_N")
    ambient: Array = quantity(
        "ambient temperature", "K", "of the surroundings, T_a", shown="°C"
    )
    conductance: Array = quantity(
        "conductance", "W/K", "H, from the body to its surroundings"
    )
    capacity: Array | None = quantity("heat capacity", "J/K", "C", default=None)
    temperature: Array = quantity("temperature", "K", "T", shown="°C")
    steady: Array = quantity(
        "steady temperature", "K", "T of the steady state", shown="°C"
    )
    settling: Array | None = quantity(
        "time constant", "s", "near the steady state", default=None
    )
    power: Array = quantity("dissipated power", "W", "at T")
    coefficient: Array = quantity("rolling resistance coefficient", "-", "at T")
    error: Array = quantity("estimated error of the temperature", "K")
    other_states: Array = quantity(
        "other steady states", "", "hotter ones, of a body that was hot before"
    )
    model_error: Array = quantity(
        "bound on the error of the model",
        "K",
        "of the temperature; NaN: one temperature for the whole body has none",
    )

    title: ClassVar[str] = "Heat build-up by rolling resistance"
    figure: ClassVar[str] = "plot_curves.draw_heat_build_up"
    shows: ClassVar[str] = "temperature"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the temperature"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "velocity",
        "load",
        "ambient",
        "conductance",
        "capacity",
    )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The coldest and the warmest steady state."""
        rise = np.asarray(self.steady - self.ambient)
        if np.isfinite(rise).any():
            for i in dict.fromkeys((int(np.nanargmin(rise)), int(np.nanargmax(rise)))):
                yield self._steady_in_words(i, rise)

    def _steady_in_words(self, i: int, rise: np.ndarray) -> tuple[str, str]:
        """One steady state, and where it is."""
        place = [in_words("velocity", float(np.ravel(self.velocity)[i]))]
        index = np.unravel_index(i, rise.shape)
        for axis, along in zip(self.axes(), index, strict=True):
            if axis.values.size > 1 and axis.name not in ("velocity", "time"):
                place.append(place_in_words(axis, int(along)))
        return (
            f"steady at {', '.join(place)}",
            f"{in_words('temperature', float(np.ravel(self.steady)[i]))}, "
            f"{significant(float(rise.ravel()[i]))} K above the surroundings",
        )


class _HeatGiven(NamedTuple):
    """The arguments as arrays."""

    velocity: Array
    load: Array
    ambient: Array
    conductance: Array
    capacity: Array | None = None


class _Body(NamedTuple):
    """Rolling bodies, and what cools them; points broadcast."""

    foundation: Any
    shape: Any
    velocity: Any
    load: Any
    ambient: Any  # T_a [K]
    conductance: Any  # H [W/K]
    model: Any
    rtol: float
    count: Any  # called with the number of sets of temperatures that are computed

    def roll(self, temperature: Array, ignored: type[Warning] = Warning) -> Any:
        """The rolling resistance at temperatures, without warnings of a class."""
        with quiet(ignored):
            rolled = rolling(
                self.foundation,
                self.shape,
                velocity=self.velocity,
                load=self.load,
                temperature=temperature,
                model=self.model,
                rtol=self.rtol,
            )
        self.count(1)
        return rolled


class _SteadyState(NamedTuple):
    temperature: Any  # [K]
    error: Any  # [K]
    converged: Any
    stiffness: Any  # H - dP/dT [W/K]
    rolling: Any  # the `RollingCurve` at the last iterate
    others: Any  # whether there are hotter steady states


@over_materials
@numpy_unless_traced
def heat_build_up(
    material: Materials,
    shape: Indenter,
    *,
    velocity: ArrayLike,
    load: ArrayLike,
    ambient: ArrayLike,
    conductance: ArrayLike,
    capacity: ArrayLike | None = None,
    time: ArrayLike | None = None,
    hottest: float | None = None,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
) -> HeatBuildUp:
    """Steady temperature of a rolling body that its own resistance heats, and the way
    to it from `ambient`.

    Args:
        material: as for `rolling`, with a shift law.
        shape: the body that rolls.
        velocity: velocity [m/s]; arguments broadcast.
        load: normal force [N].
        ambient: temperature of the surroundings [K].
        conductance: from the body to the surroundings, H [W/K].
        capacity: heat capacity of the body C [J/K], for a history.
        time: instants of the history [s], ascending from zero, shape (n,): fields get
            one more axis, the last.
        hottest: highest temperature that is considered [K]; by default the end of the
            material's range.
        model: as for `rolling`.
        rtol: as for `rolling`.

    Returns:
        An `em.HeatBuildUp`; `error` is that of the temperature [K]. A point that has no
        steady state below `hottest` is NaN with `converged=False`.

    Raises:
        InputError: as `rolling`, and for a material without a shift law.

    The body has one temperature, and all power goes into it. The history is exact for a
    heat flow that is linear between 49 temperatures; its error is estimated from every
    second of them. The steady state is differentiable as `rolling` is.

    Source: `docs/belt.md`.
    """
    foundation: Any = (
        material if isinstance(material, Layer) else as_foundation(material)
    )
    if foundation.shift is None:
        raise InputError(
            argument="material",
            got=foundation.name or foundation,
            accepted="one with a shift law for heat build-up",
        )
    given = _check(velocity, load, ambient, conductance, capacity, time)
    highest = _highest_temperature(foundation, hottest, given.ambient)
    points = _HeatGiven(**broadcast(given._asdict()))
    heat = points.capacity
    # With a history it is said there what is not known of the material.
    ignored = ConvergenceWarning if heat is None else Warning
    sets = _SETS if heat is None else _SETS_WITH_HISTORY
    with counted("rolling resistance while it warms up", sets) as count:
        rtol = check_rtol(rtol)
        body = _Body(foundation, shape, *points[:4], model, rtol, count)
        state = _solve(body, highest, ignored)
        if not is_traced(foundation, shape, given):
            _warn_of_failures(state.converged, highest)
        steady = _at_rest(body, state, given)
        if heat is None:
            return steady
        return _with_history(steady, body, state, heat, time)


def _check(
    velocity: ArrayLike,
    load: ArrayLike,
    ambient: ArrayLike,
    conductance: ArrayLike,
    capacity: ArrayLike | None,
    time: ArrayLike | None,
) -> _HeatGiven:
    """Raises `InputError`."""
    if (time is None) != (capacity is None):
        name = "time" if time is None else "capacity"
        raise InputError(
            argument=name,
            accepted="given for the history, or neither of time and capacity",
        )
    return _HeatGiven(
        **positive_arrays(
            {
                "velocity": velocity,
                "load": load,
                "ambient": ambient,
                "conductance": conductance,
                "capacity": capacity,
            }
        )
    )


def _highest_temperature(
    foundation: Foundation | Layer, hottest: float | None, ambient: Array
) -> float:
    """The highest temperature to consider [K]. Raises `InputError`."""
    if hottest is None:
        if foundation.range is None or foundation.range.temperature is None:
            raise InputError(
                argument="hottest",
                accepted="given [K]",
                hint="the material does not say up to which temperature it holds",
            )
        hottest = foundation.range.temperature[1]
    highest = plain("hottest", hottest)
    accepted = "below hottest, " + amount(highest, "K")
    require("ambient", ambient, accepted, lambda x: x < highest)
    return highest


def _solve(body: _Body, highest: float, ignored: type[Warning]) -> _SteadyState:
    """Where P(T) = H (T - T_a): bracketed, then two steps of Newton's method, through
    the last of which derivatives pass.
    """
    ambient, conductance = body.ambient, body.conductance
    low, high, others = _bracket(body, ambient, highest, _SCAN)
    for _ in range(2):
        low, high, _ = _bracket(body, low, high, _REFINED_SCAN)
    width = xp.where(high > low, high - low, 1.0)
    ends = body.roll(xp.stack([low, high]))
    guess = low + (ends.power[0] - conductance * (low - ambient)) / (
        conductance - (ends.power[1] - ends.power[0]) / width
    )
    # rubber may be so cold that its shift factor overflows
    guess = xp.where(xp.isfinite(guess), guess, low)
    middle = xp.clip(
        xp.clip(guess, low, high), ambient + width / 2, highest - width / 2
    )
    around = body.roll(xp.stack([middle - width / 2, middle, middle + width / 2])).power
    stiffness = conductance - stop_gradient((around[2] - around[0]) / width)
    guess = middle + (around[1] - conductance * (middle - ambient)) / stiffness
    guess = stop_gradient(xp.clip(xp.where(xp.isfinite(guess), guess, low), low, high))
    at_guess = body.roll(guess, ignored)
    heating = conductance * (guess - ambient)
    step = (at_guess.power - heating) / stop_gradient(stiffness)
    steady = guess + step
    error = stop_gradient(
        _NEWTON_REMAINDER * abs(step)
        + at_guess.error
        / at_guess.coefficient
        * conductance
        * (guess - ambient)
        / stiffness
    )
    converged = (
        at_guess.converged
        & (error <= _ACCEPTED_ERROR * body.rtol * (steady - ambient))
        & (stiffness > 0)
    )
    return _SteadyState(
        nan_unless(converged, xp.asarray(steady)),
        nan_unless(converged, xp.asarray(error)),
        converged,
        stop_gradient(stiffness),
        at_guess,
        others & converged,
    )


def _warn_of_failures(converged: Array, highest: float) -> None:
    if not converged.all():
        warn(
            f"{int((~converged).sum())} of {converged.size} points have no steady "
            f"temperature below {highest:g} K, or none that can be found; they are "
            "NaN.",
            ConvergenceWarning,
        )


def _at_rest(body: _Body, state: _SteadyState, given: _HeatGiven) -> HeatBuildUp:
    """The result of the steady state."""
    power = body.conductance * (state.temperature - body.ambient)
    return HeatBuildUp(
        velocity=body.velocity,
        load=body.load,
        ambient=body.ambient,
        conductance=body.conductance,
        steady=state.temperature,
        error=state.error,
        model_error=state.error + xp.nan,
        temperature=state.temperature,
        power=power,
        other_states=state.others,
        converged=state.converged,
        coefficient=power / (body.velocity * body.load),
        marks=carried(state.rolling.examined()),
        model=state.rolling.model,
        plan=state.rolling.plan,
        inputs=_inputs_in_words(state.rolling.inputs, given),
    )


def _with_history(
    steady: HeatBuildUp,
    body: _Body,
    state: _SteadyState,
    heat: Array,
    time: ArrayLike | None,
) -> HeatBuildUp:
    """The result with an axis of time, the last one. Raises `InputError` for a time
    that is no list of instants.
    """
    instants = as_float64("time", time)
    if instants.ndim != 1:
        raise InputError(
            argument="time", got=instants.shape, accepted="a list of instants"
        )
    ascending("time", instants)
    not_negative("time", instants)
    temperature, power, error, way = _history(body, state.temperature, heat, instants)

    def over_time(values: Array) -> Any:
        return xp.broadcast_to(values[..., None], temperature.shape)

    def since_start(points: Array) -> Any:
        # what was to be doubted once has heated all that follows
        return xp.moveaxis(xp.cumsum(points, axis=0) > 0, 0, -1)

    held = {name: over_time(getattr(steady, name)) for name in _HELD}
    return dataclasses.replace(
        steady,
        **held,
        capacity=over_time(heat),
        settling=over_time(heat / state.stiffness),
        error=over_time(state.error) + error,
        temperature=temperature,
        power=power,
        time=xp.broadcast_to(instants, temperature.shape),
        coefficient=power / (held["velocity"] * held["load"]),
        marks=carried(way.examined(), since_start),
    )


def _inputs_in_words(
    of_rolling: tuple[tuple[str, str], ...], given: _HeatGiven
) -> tuple[tuple[str, str], ...]:
    """The inputs of rolling but its temperature, those of the heat before the last."""
    inputs = [pair for pair in of_rolling if pair[0] != "temperature"]
    inputs[-1:-1] = [
        (words, brief(value, unit))
        for value, words, unit in (
            (given.ambient, "ambient", "K"),
            (given.conductance, "conductance", "W/K"),
            (given.capacity, "heat capacity", "J/K"),
        )
        if value is not None
    ]
    return tuple(inputs)


def _bracket(
    body: _Body, low: Array, high: Array | float, count: int
) -> tuple[Any, Any, Any]:
    """The two neighbours, of `count` temperatures from low to high, between which the
    body stops warming up, as far as a coarse power tells, and whether it warms up again
    above; Newton's method may leave them.
    """
    body = body._replace(rtol=max(body.rtol, _SCAN_RTOL))
    temperature, power, _ = map(
        stop_gradient, _powers(body, low, high, count, _SCAN_STEP)
    )
    # NaN ends the search, and the point is found not to be met
    cools = ~(power - body.conductance * (temperature - body.ambient) > 0)
    others = (cools[1:-1] & ~cools[2:]).any(axis=0)
    cools = xp.concatenate(
        [xp.zeros_like(cools[:1]), cools[1:-1], xp.ones_like(cools[:1])]
    )
    index = argmax(cools)[None]
    below = xp.take_along_axis(temperature, index - 1, axis=0)[0]
    return below, xp.take_along_axis(temperature, index, axis=0)[0], others


def _powers(
    body: _Body,
    low: Array,
    high: Array | float,
    count: int,
    step: float,
    finer: int = 1,
) -> tuple[Any, Any, Any]:
    """`count` temperatures from low to high along the first axis, the power at them,
    and its estimated error, relatively.

    Powers change with ln a_T, by `step` at most between those that are computed. The
    others are interpolated, and those at `finer` temperatures for each asked for.
    """
    few = _enough(body, low, high, count, step)
    computed = body.roll(_evenly(low, high, few)).power
    if few == count and finer == 1:
        return _evenly(low, high, count), computed, 0.0
    count = finer * (count - 1) + 1
    place = np.linspace(0.0, few - 1.0, count)
    power, lower = (_interpolated(computed, place, n) for n in (_STENCIL, _STENCIL - 2))
    off = np.abs(lower - power) / np.where(power > 0, power, 1.0)
    return _evenly(low, high, count), power, np.max(off, axis=0)


def _evenly(low: Array, high: Array | float, count: int) -> Any:
    share = np.linspace(0.0, 1.0, count).reshape(-1, *[1] * np.ndim(low))
    return low + share * (high - low)


def _enough(
    body: _Body, low: Array, high: Array | float, count: int, step: float
) -> int:
    """How many temperatures, of `count`, are computed; all where JAX traces."""
    if not on_numpy() or count <= _STENCIL:
        return count
    a, _ = thermal_factors(body.foundation, _evenly(low, high, count))
    steepest = np.max(np.abs(np.diff(np.log(a), axis=0)), initial=0.0)
    if not np.isfinite(steepest):
        return count
    return min(count, max(_STENCIL, 1 + math.ceil((count - 1) * steepest / step)))


def _interpolated(power: Array, place: np.ndarray, stencil: int) -> Any:
    """Powers between those at even temperatures along the first axis; in logarithms
    where they are positive.
    """
    index, weights = lagrange(place, stencil, power.shape[0])
    positive_everywhere = not np.any(power <= 0)
    values = np.log(power) if positive_everywhere else power
    between = np.einsum("ts,ts...->t...", weights, values[index])
    return np.exp(between) if positive_everywhere else between


class _Way(NamedTuple):
    temperature: Array  # at the instants [K]
    power: Array
    error: Array  # of the temperature, by every second node
    rolling: RollingCurve


def _history(body: _Body, steady: Array, heat: Array, time: Array) -> _Way:
    """The way to the steady state, by the net power at nodes of temperature."""
    ambient = body.ambient
    top = xp.where(xp.isfinite(steady), steady, ambient + 1.0)
    finer = _FINER if on_numpy() else 1
    temperature, power, off = _powers(
        body, ambient, top, _HISTORY_NODES, _HISTORY_STEP, finer
    )
    net = xp.asarray(power) - body.conductance * (temperature - ambient)
    # at the steady state by definition
    net = xp.concatenate([net[:-1], xp.zeros_like(net[:1])])
    fine = _follow(temperature, net, heat, time)
    coarse = _follow(temperature[::2], net[::2], heat, time)
    known = xp.isfinite(steady)[..., None]
    fine = halving_limit(coarse, fine)
    fine = xp.where(known & xp.isfinite(fine), fine, xp.asarray(ambient)[..., None])
    way = body.roll(xp.moveaxis(fine, -1, 0), ConvergenceWarning)
    body.count(_INSTANTS - 1)
    power = xp.asarray(xp.moveaxis(way.power, 0, -1))
    # The temperature follows the power: its rise by no larger a part.
    rise = fine - xp.asarray(ambient)[..., None]
    error = stop_gradient(abs(fine - coarse) + xp.asarray(off)[..., None] * rise)
    shown = (nan_unless(known, x) for x in (fine, power, error))
    return _Way(*shown, rolling=way)


def _follow(temperature: Array, net: Array, heat: Array, time: Array) -> Any:
    """Temperature at the instants, from the net heat flow N = P - H (T - T_a) at nodes
    along the first axis.

    Between two nodes N is taken as linear in T, so that the time from one to the other
    is C (T' - T)/(N - N') ln(N/N'), and T within is an exponential in time.
    """
    warmer = temperature[1:] - temperature[:-1]
    slope = (net[1:] - net[:-1]) / warmer
    small = abs(slope) * warmer < 1e-9 * net[:-1]
    safe = xp.where(small, 1.0, slope)
    ratio = net[1:] / net[:-1]
    log = xp.log(xp.where(ratio > 0, ratio, 1.0))
    # the last never ends
    spent = heat * xp.where(small, warmer / net[:-1], log / safe)[:-1]
    starts = xp.concatenate([xp.zeros_like(spent[:1]), xp.cumsum(spent, axis=0)])
    since = time - starts[..., None]  # nodes, points, instants
    index = xp.maximum(xp.sum(since >= 0, axis=0) - 1, 0)[None]

    def pick(field: Array) -> Any:
        return xp.take_along_axis(
            xp.broadcast_to(field[..., None], since.shape), index, axis=0
        )[0]

    elapsed, begin = xp.take_along_axis(since, index, axis=0)[0], pick(temperature[:-1])
    flow, rate = pick(net[:-1]), pick(safe) / heat[..., None]
    rise = xp.where(
        pick(small),
        flow * elapsed / heat[..., None],
        flow / pick(safe) * xp.expm1(rate * elapsed),
    )
    return begin + rise
