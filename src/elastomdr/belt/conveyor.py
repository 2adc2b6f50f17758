"""What the indentation of its covers costs a belt conveyor, all idlers counted.

Per length of belt, with sets of idlers a distance l apart, rolls that carry the shares
s_i of the load on a set, and the resistance F of one roll from `em.rolling`:

    w = (1/l_c) sum F_c(s_i (m_b + m_g) g l_c) + (1/l_r) sum F_r(s_j m_b g l_r),       P/L = v w

m_b belt and m_g goods per length; c the carry side, on the lower cover, r the return
side, on the upper one. F grows with about the power 1.3 of the load on a roll, so that
the roll with most of the load costs more than its share.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    as_float64,
    broadcast,
    is_traced,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    positive,
    require,
    scalar,
    significant,
)
from ..element.law import Foundation
from ..element.layer import Layer
from ..errors import InputError, warned_once
from ..results.base import Result, quantity, record
from ..results.curve import sure
from ..results.doubts import Doubt, carried
from ..results.uncertainty import left_out
from ..results.words import brief, describe, in_words
from ..surface.shapes import Cylinder
from ..trees import Tree, fill
from ..verbs.rolling import rolling

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import ModelLike

_SUM_TOLERANCE = 1e-6  # by which the shares of the load may miss one
_UNITS = {"belt": "kg/m", "goods": "kg/m", "velocity": "m/s", "temperature": "K"}


class Idlers(Tree):
    """Equal sets of idlers along one side of a conveyor, and the cover that they indent.

    Args:
        cover: `em.layer(rubber, thickness)`; or `em.springs(...)`, or a `Foundation`
            per area.
        roll: an `em.Cylinder`; all rolls of a set are alike.
        spacing: distance from set to set [m].
        shares: shares of the load on a set, one for each roll, together 1; by default a
            single roll.

    Raises:
        InputError: for shares that do not add up to 1, and values that are not
            positive.
    """

    cover: Foundation | Layer
    roll: Cylinder
    spacing: Float[Array, ""]  # l [m]
    shares: Float[Array, " rolls"]  # s_i

    def __init__(
        self,
        cover: Foundation | Layer,
        roll: Cylinder,
        *,
        spacing: Number,
        shares: ArrayLike = (1.0,),
    ):
        if (
            not isinstance(cover, (Foundation, Layer))
            or getattr(cover, "per_area", None) is False
        ):
            raise InputError(
                argument="cover",
                got=cover,
                accepted="a layer, em.layer(rubber, thickness)",
            )
        if not isinstance(roll, Cylinder):
            raise InputError(
                argument="roll", got=roll, accepted="an em.Cylinder(radius, length)"
            )
        fill(self, cover=cover, roll=roll)
        fill(
            self,
            spacing=scalar("spacing", spacing),
            shares=as_float64("shares", shares),
        )
        positive("spacing", self.spacing)
        if self.shares.ndim != 1 or not self.shares.size:
            raise InputError(
                argument="shares",
                got=shares,
                accepted="a list with one share for each roll",
            )
        positive("shares", self.shares)
        require(
            "shares",
            self.shares.sum(),
            "1 in sum",
            lambda x: abs(x - 1) < _SUM_TOLERANCE,
        )


@record
class Conveyor(Result):
    """Resistance and power per length of belt; a point of which one roll failed is NaN
    with `converged=False`.

    `power` in W/m is also that in kW per kilometre.
    """

    velocity: Array = quantity("velocity", "m/s", "belt speed v", axis="belt speed")
    belt: Array = quantity("mass of the belt", "kg/m", "per length")
    goods: Array = quantity("mass of the goods", "kg/m", "per length")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    carry: Array = quantity("resistance of the carry side", "N/m", "per length of belt")
    back: Array = quantity("resistance of the return side", "N/m", "per length of belt")
    resistance: Array = quantity("resistance", "N/m", "both sides together")
    power: Array = quantity(
        "power",
        "W/m",
        "v times the resistance",
        axis="power per length of belt",
        shown="kW/km",
    )
    coefficient: Array = quantity(
        "resistance over weight", "-", "of goods and of both strands of the belt"
    )
    error: Array = quantity("estimated error of the coefficient", "-")
    model_error: Array = quantity(
        "bound on the error of the model", "-", "of the coefficient; NaN: not known"
    )

    title: ClassVar[str] = "Indentation rolling resistance of a belt conveyor"
    shows: ClassVar[str] = "power"
    error_of: ClassVar[str] = "the coefficient"
    bound_of: ClassVar[str] = "coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "temperature",
        "belt",
        "goods",
    )

    def errors(self) -> tuple[Array, Array]:
        """Numerical error and bound of the model of the power [W/m]."""
        scale = self.power / self.coefficient
        return self.error * scale, self.model_error * scale

    def _sure(self, i: int) -> str:
        return sure(i, self.power, *self.errors())

    def _left_out(self, i: int, drawn: bool) -> str:
        return left_out(self, drawn)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Least and largest power per kilometre, and where."""
        power = np.ravel(self.power)
        if np.isfinite(power).any():
            extremes = int(np.nanargmin(power)), int(np.nanargmax(power))
            for i in dict.fromkeys(extremes):
                yield self._point_in_words(i)

    def _point_in_words(self, i: int) -> tuple[str, str]:
        """Power and resistance at one point, and where it is."""

        def at_point(values: Array) -> float:
            return float(np.ravel(values)[i])

        place = f"{in_words('velocity', at_point(self.velocity))}, "
        place += f"{significant(at_point(self.goods))} kg/m of goods"
        if self.temperature is not None:
            place += f", {in_words('temperature', at_point(self.temperature))}"
        share = 100 * (at_point(self.carry) / at_point(self.resistance))
        return (
            f"at {place}",
            f"{significant(at_point(self.power))} kW per km of belt, "
            f"{significant(share, 3)} % of it on the carry side; resistance over "
            f"weight {significant(at_point(self.coefficient))}",
        )


class _ConveyorGiven(NamedTuple):
    """The arguments as arrays."""

    velocity: Array
    belt: Array
    goods: Array
    gravity: Array
    temperature: Array | None


class _Side(NamedTuple):
    """One side of the belt, per length of it."""

    resistance: Any  # [N/m]
    error: Any  # estimated error of the resistance [N/m]
    model_error: Any  # bound on the model's, as of `em.rolling` [N/m]
    converged: Any
    marks: tuple[Doubt, ...]  # of any of its rolls
    model: str
    plan: Any


@numpy_unless_traced
def conveyor(
    carry: Idlers,
    back: Idlers,
    *,
    velocity: ArrayLike,
    belt: ArrayLike,
    goods: ArrayLike,
    temperature: ArrayLike | None = None,
    gravity: float = 9.81,
    model: ModelLike | None = None,
    rtol: float = 1e-6,
) -> Conveyor:
    """Indentation rolling resistance and power of a whole belt conveyor, per length of
    belt.

        w = (1/l_c) sum F_c(s_i (m_b + m_g) g l_c) + (1/l_r) sum F_r(s_j m_b g l_r),       P/L = v w

    Args:
        carry: the `Idlers` of the loaded side.
        back: the `Idlers` of the returning side.
        velocity: v [m/s]; velocity, belt, goods and temperature broadcast.
        belt: mass of the belt per length m_b [kg/m].
        goods: mass of the goods per length m_g [kg/m]; 0 for an empty belt.
        temperature: temperature [K], for covers with a shift law.
        gravity: g [m/s^2].
        model: as for `rolling`, of each roll; on covers every model gives the same.
        rtol: as for `rolling`, of each roll.

    Returns:
        An `em.Conveyor` of the broadcast shape. A point of which one roll failed is NaN
        with `converged=False`.

    Raises:
        InputError: as `rolling`, and for negative masses.

    Exact in plane strain for covers given as `em.layer`, what the ends of the rolls
    change on rubber that goes on beyond them within `model_error`, and idlers far
    enough apart for the cover to recover between them; within a roll the load is taken
    as even. Bearings, flexure of belt and goods, and lifting are left out.
    Differentiable as `rolling` is.

    Source: `docs/belt.md`.
    """
    for name, side in (("carry", carry), ("back", back)):
        if not isinstance(side, Idlers):
            raise InputError(
                argument=name, got=side, accepted="em.Idlers(cover, roll, spacing=...)"
            )
    given = _check(velocity, belt, goods, temperature, gravity)
    points = _ConveyorGiven(**broadcast(given._asdict()))
    speed, temperatures = points.velocity, points.temperature
    carry_weight = (points.belt + points.goods) * points.gravity
    return_weight = points.belt * points.gravity
    with warned_once():
        loaded = _solve(carry, carry_weight, speed, temperatures, model, rtol)
        empty = _solve(back, return_weight, speed, temperatures, model, rtol)
    converged = loaded.converged & empty.converged
    weight = (2 * points.belt + points.goods) * points.gravity
    on_carry = nan_unless(converged, loaded.resistance)
    on_return = nan_unless(converged, empty.resistance)
    return Conveyor(
        velocity=speed,
        belt=points.belt,
        goods=points.goods,
        temperature=temperatures,
        carry=on_carry,
        back=on_return,
        resistance=on_carry + on_return,
        power=(on_carry + on_return) * speed,
        coefficient=(on_carry + on_return) / weight,
        error=nan_unless(converged, loaded.error + empty.error) / weight,
        model_error=nan_unless(converged, loaded.model_error + empty.model_error)
        / weight,
        converged=converged,
        marks=carried((*loaded.marks, *empty.marks)),
        model="; ".join(dict.fromkeys((loaded.model, empty.model))),
        plan=loaded.plan,
        inputs=_inputs_in_words(carry, back, given),
    )


def _check(
    velocity: ArrayLike,
    belt: ArrayLike,
    goods: ArrayLike,
    temperature: ArrayLike | None,
    gravity: ArrayLike,
) -> _ConveyorGiven:
    """Raises `InputError`."""
    given = _ConveyorGiven(
        as_float64("velocity", velocity),
        as_float64("belt", belt),
        as_float64("goods", goods),
        as_float64("gravity", gravity),
        None if temperature is None else as_float64("temperature", temperature),
    )
    for name, value in given._asdict().items():
        if value is not None:
            (not_negative if name == "goods" else positive)(name, value)
    return given


def _solve(
    side: Idlers,
    weight: Array,
    velocity: Array,
    temperature: Array | None,
    model: ModelLike | None,
    rtol: float,
) -> _Side:
    """Resistance of all rolls of a side under a weight per length of belt [N/m]; equal
    rolls are computed once.
    """
    shares, count = side.shares, np.ones(side.shares.size)
    if not is_traced(shares):
        shares, count = np.unique(shares, return_counts=True)
    rolls = rolling(
        side.cover,
        side.roll,
        velocity=velocity[..., None],
        load=weight[..., None] * side.spacing * shares,
        temperature=None if temperature is None else temperature[..., None],
        model=model,
        rtol=rtol,
    )

    def summed(of_rolls: Array) -> Any:
        return xp.sum(xp.asarray(of_rolls) * count, axis=-1)

    return _Side(
        summed(rolls.resistance) / side.spacing,
        summed(rolls.error * rolls.normal_force) / side.spacing,
        summed(xp.asarray(rolls.model_error) * rolls.normal_force) / side.spacing,
        xp.all(xp.asarray(rolls.converged), axis=-1),
        carried(rolls.examined(), lambda points: points.any(axis=-1)),
        rolls.model,
        rolls.plan,
    )


def _inputs_in_words(
    carry: Idlers, back: Idlers, given: _ConveyorGiven
) -> tuple[tuple[str, str], ...]:
    inputs = []
    for name, side in (("carry side", carry), ("return side", back)):
        rolls = "1 roll" if side.shares.size == 1 else f"{side.shares.size} rolls"
        cover = side.cover.name or "cover given directly"
        spacing = brief(side.spacing, "m")
        words = f"{cover}; {describe(side.roll)}; {rolls} every {spacing}"
        inputs.append((name, words))
    inputs += [
        (name, brief(value, unit))
        for name, unit in _UNITS.items()
        if (value := getattr(given, name)) is not None
    ]
    return tuple(inputs)
