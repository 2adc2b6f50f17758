"""How warm a rolling body gets: the heat of its own resistance against what it gives
off.

One temperature for the body, heat capacity C, losing heat through a conductance H to
surroundings at T_a:

    C dT/dt = P(T) - H (T - T_a),      P(T) = v F(v, T) the power of `em.rolling`.

Rubber that gets warmer gets faster, so that P falls with T above the loss peak and the
rise is less than P(T_a)/H. On the glassy side P grows with T and there may be several
steady states; a body that starts at T_a reaches the lowest.
"""

from __future__ import annotations

import math
import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import fixed, on_numpy, xp
from ..call.several_materials import over_materials
from ..checks import (
    argmax,
    as_float64,
    ascending,
    broadcast_shape,
    is_traced,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    plain,
    positive,
)
from ..element.law import as_foundation
from ..element.layer import Layer
from ..errors import ConvergenceWarning, InputError
from ..results.words import brief
from ..verbs.rolling import rolling
from .heat_build_up_result import HeatBuildUp

if TYPE_CHECKING:
    from .._types import ArrayLike
    from ..call.types import Indenter, Materials, ModelLike

# temperatures at which the steady state is looked for: two that lie between the same
# ones are missed
_SCAN = 257
_NEAR = 5  # temperatures between the two on either side of it
_WAY = 49  # temperatures between start and steady state, for the history
# points up to which one program is compiled (`smooth.solve`): few bodies are computed
# in such parts
_TOGETHER = 64
_FEW = 5  # bodies; of more, as many temperatures at a time as the history has
# of the last Newton step, what it may leave: its slope is good to a few per cent
_LEFT = 0.1
# times rtol of the rise, the error up to which a temperature is handed out
_REACHED = 10


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

    Source: derived in `docs/wheel.md`.
    """
    foundation: Any = (
        material if isinstance(material, Layer) else as_foundation(material)
    )
    if foundation.shift is None:
        raise InputError(
            "material must have a shift law to warm up, got "
            f"{foundation.name or 'one without'}."
        )
    given = {
        "velocity": velocity,
        "load": load,
        "ambient": ambient,
        "conductance": conductance,
    }
    if capacity is not None:
        given["capacity"] = capacity
    if (time is None) != (capacity is None):
        raise InputError(
            "time and capacity belong together: give both for the history, or neither."
        )
    arrays = {name: as_float64(name, value) for name, value in given.items()}
    for name, value in arrays.items():
        positive(name, value)
    together = broadcast_shape(**arrays)
    if hottest is None:
        if foundation.range is None or foundation.range.temperature is None:
            raise InputError(
                "hottest must be given [K]: the material does not say up to which "
                "temperature it holds."
            )
        hottest = foundation.range.temperature[1]
    hottest = plain("hottest", hottest)
    if (
        not is_traced(arrays["ambient"])
        and not (np.asarray(arrays["ambient"]) < hottest).all()
    ):
        raise InputError(
            f"ambient must be below hottest, {hottest:g} K, got "
            f"{brief(arrays['ambient'], 'K')}."
        )
    traced = is_traced(foundation, shape, *arrays.values())
    v, f, ta, h = (
        xp.broadcast_to(arrays[k], together)
        for k in ("velocity", "load", "ambient", "conductance")
    )

    def run(kelvin: Any, ignored: type[Warning] = Warning) -> Any:
        with warnings.catch_warnings():
            # of temperatures on the way; those of the answer come below
            warnings.simplefilter("ignore", ignored)
            return rolling(
                foundation,
                shape,
                velocity=v,
                load=f,
                temperature=kelvin,
                model=model,
                rtol=rtol,
            )

    low, high = _bracket(run, ta, h, hottest, _SCAN)
    for _ in range(2):
        low, high = _bracket(run, low, h, high, _NEAR, ta)
    width = xp.where(high > low, high - low, 1.0)
    ends = run(xp.stack([low, high]))
    guess = low + (ends.power[0] - h * (low - ta)) / (
        h - (ends.power[1] - ends.power[0]) / width
    )
    # rubber may be so cold that its shift factor overflows
    guess = xp.where(xp.isfinite(guess), guess, low)
    middle = xp.clip(xp.clip(guess, low, high), ta + width / 2, hottest - width / 2)
    around = run(xp.stack([middle - width / 2, middle, middle + width / 2])).power
    slope = fixed((around[2] - around[0]) / width)
    guess = middle + (around[1] - h * (middle - ta)) / (h - slope)
    guess = fixed(xp.clip(xp.where(xp.isfinite(guess), guess, low), low, high))
    # The steady state itself may be beyond what is known of the material, and so may be
    # the way to it.
    at = run(guess, ConvergenceWarning if capacity is None else Warning)
    step = (at.power - h * (guess - ta)) / fixed(h - slope)
    steady = guess + step
    error = fixed(
        _LEFT * abs(step) + at.error / at.coefficient * h * (guess - ta) / (h - slope)
    )
    good = at.converged & (error <= _REACHED * rtol * (steady - ta)) & (h > slope)
    steady, error = (nan_unless(good, xp.asarray(x)) for x in (steady, error))
    if not traced and not good.all():
        text = (
            f"no steady temperature below {hottest:g} K, or none that can be found; "
            "they are NaN."
        )
        text = f"{int((~good).sum())} of {good.size} points have {text}"
        warnings.warn(text, ConvergenceWarning, stacklevel=3)
    power = h * (steady - ta)
    fields: dict[str, Any] = {
        "velocity": v,
        "load": f,
        "ambient": ta,
        "conductance": h,
        "steady": steady,
        "error": error,
    }
    fields["capacity"] = fields["settling"] = None
    now: dict[str, Any] = {"temperature": steady, "power": power, "time": None}
    beyond = at
    if capacity is not None:
        heat = xp.broadcast_to(arrays["capacity"], together)
        fields["capacity"] = heat
        fields["settling"] = heat / fixed(h - slope)
        instants = as_float64("time", time)
        if instants.ndim != 1:
            raise InputError(
                f"time must be a list of instants, got shape {instants.shape}."
            )
        ascending("time", instants)
        not_negative("time", instants)
        kelvin, flow, off, beyond = _history(run, ta, steady, h, heat, instants)
        fields = {
            k: x if x is None else xp.broadcast_to(x[..., None], kelvin.shape)
            for k, x in fields.items()
        }
        fields["error"] = fields["error"] + off
        good = xp.broadcast_to(good[..., None], kelvin.shape)
        now = {
            "temperature": kelvin,
            "power": flow,
            "time": xp.broadcast_to(instants, kelvin.shape),
        }
    inputs = [pair for pair in beyond.inputs if pair[0] != "temperature"]
    inputs[-1:-1] = [
        ("ambient", brief(arrays["ambient"], "K")),
        ("conductance", brief(arrays["conductance"], "W/K")),
    ]
    if capacity is not None:
        inputs.insert(-1, ("heat capacity", brief(arrays["capacity"], "J/K")))
    return HeatBuildUp(
        **now,
        **fields,
        converged=good,
        coefficient=now["power"] / (fields["velocity"] * fields["load"]),
        extrapolated=_since_the_start(beyond.extrapolated, capacity is not None),
        model=at.model,
        plan=at.plan,
        inputs=tuple(inputs),
    )


def _since_the_start(extrapolated: Any, history: bool) -> Any:
    """Of a history, along whose first axis it comes: what was beyond the range once has
    heated all that follows.
    """
    if extrapolated is None or not history:
        return extrapolated
    return np.moveaxis(np.logical_or.accumulate(extrapolated, axis=0), 0, -1)


def _bracket(
    run: Any, low: Any, h: Any, high: Any, count: int, ambient: Any = None
) -> tuple[Any, Any]:
    """The two neighbours, of `count` temperatures from low to high, between which the
    body stops warming up.
    """
    ambient = low if ambient is None else ambient
    part = np.linspace(0.0, 1.0, count).reshape(-1, *[1] * np.ndim(low))
    kelvin = fixed(low + part * (high - low))
    power = fixed(_powers(run, kelvin))
    # NaN ends the search, and the point is found not to be met
    colder = ~(power - h * (kelvin - ambient) > 0)
    colder = xp.concatenate(
        [xp.zeros_like(colder[:1]), colder[1:-1], xp.ones_like(colder[:1])]
    )
    index = np.argmax(colder, axis=0)[None] if on_numpy() else argmax(colder)[None]
    kelvin = xp.asarray(kelvin)
    return tuple(xp.take_along_axis(kelvin, index - i, axis=0)[0] for i in (1, 0))  # type: ignore[return-value]


def _powers(run: Any, kelvin: Any) -> Any:
    """Power at temperatures along the first axis, in parts of a size that is compiled
    once: that takes far longer.
    """
    bodies = max(1, math.prod(np.shape(kelvin)[1:]))
    each = _TOGETHER // bodies if bodies <= _FEW else _WAY
    parts = -(-kelvin.shape[0] // each)
    if not on_numpy() or parts == 1:
        return run(kelvin).power
    power = np.empty(kelvin.shape)
    # each part from end to end, so that one spectrum is carried in all of them
    for i in range(parts):
        power[i::parts] = run(kelvin[i::parts]).power
    return power


def _history(
    run: Any, ambient: Any, steady: Any, h: Any, heat: Any, time: Any
) -> tuple[Any, Any, Any, Any]:
    """Temperature and power at the instants, the error of the temperature, by every
    second node, and the rolling there.

    Between two nodes the net heat flow N = P - H (T - T_a) is taken as linear in T, so
    that the time from one to the other is C (T' - T)/(N - N') ln(N/N'), and T within is
    an exponential in time.
    """
    part = np.linspace(0.0, 1.0, _WAY).reshape(-1, *[1] * np.ndim(ambient))
    top = xp.where(xp.isfinite(steady), steady, ambient + 1.0)
    kelvin = ambient + part * (top - ambient)
    net = xp.asarray(_powers(run, kelvin)) - h * (kelvin - ambient)
    # at the steady state by definition
    net = xp.concatenate([net[:-1], xp.zeros_like(net[:1])])

    def follow(kelvin: Any, net: Any) -> Any:
        slope = (net[1:] - net[:-1]) / (kelvin[1:] - kelvin[:-1])
        small = abs(slope) * (kelvin[1:] - kelvin[:-1]) < 1e-9 * net[:-1]
        safe = xp.where(small, 1.0, slope)
        ratio = net[1:] / net[:-1]
        log = xp.log(xp.where(ratio > 0, ratio, 1.0))
        # the last never ends
        spent = (
            heat
            * xp.where(small, (kelvin[1:] - kelvin[:-1]) / net[:-1], log / safe)[:-1]
        )
        starts = xp.concatenate([xp.zeros_like(spent[:1]), xp.cumsum(spent, axis=0)])
        since = time - starts[..., None]  # nodes, points, instants
        index = xp.maximum(xp.sum(since >= 0, axis=0) - 1, 0)[None]

        def pick(field: Any) -> Any:
            return xp.take_along_axis(
                xp.broadcast_to(field[..., None], since.shape), index, axis=0
            )[0]

        gone, begin = xp.take_along_axis(since, index, axis=0)[0], pick(kelvin[:-1])
        flow, rate = pick(net[:-1]), pick(safe) / heat[..., None]
        rise = xp.where(
            pick(small),
            flow * gone / heat[..., None],
            flow / pick(safe) * xp.expm1(rate * gone),
        )
        return begin + rise

    fine, coarse = follow(kelvin, net), follow(kelvin[::2], net[::2])
    known = xp.isfinite(steady)[..., None]
    fine = fine + (fine - coarse) / 3
    fine = xp.where(known & xp.isfinite(fine), fine, xp.asarray(ambient)[..., None])
    way = run(xp.moveaxis(fine, -1, 0), ConvergenceWarning)
    power = xp.asarray(xp.moveaxis(way.power, 0, -1))
    off = fixed(abs(fine - coarse))
    return *(nan_unless(known, x) for x in (fine, power, off)), way
