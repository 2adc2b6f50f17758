"""What the indentation of its covers costs a belt conveyor, all idlers counted.

Per length of belt, with sets of idlers a distance l apart, rolls that carry the shares
s_i of the load on a set, and the resistance F of one roll from `em.rolling`:

    w = (1/l_c) sum F_c(s_i (m_b + m_g) g l_c) + (1/l_r) sum F_r(s_j m_b g l_r),       P/L = v w

m_b belt and m_g goods per length; c the carry side, on the lower cover, r the return
side, on the upper one. F grows with about the power 1.3 of the load on a roll, so that
the roll with most of the load costs more than its share.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    as_float64,
    broadcast_shape,
    is_traced,
    nan_unless,
    not_negative,
    numpy_unless_traced,
    positive,
    require,
    scalar,
)
from ..element.law import Foundation
from ..element.layer import Layer
from ..errors import InputError
from ..results.words import brief, describe
from ..surface.shapes import Cylinder
from ..trees import Tree, fill, static
from ..verbs.rolling import rolling
from .conveyor_result import Conveyor

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import ModelLike

_WHOLE = 1e-6  # by which the shares of the load may miss one


class Idlers(Tree):
    """Equal sets of idlers along one side of a conveyor, and the cover that they dent.

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
                f"cover must be a layer, em.layer(rubber, thickness), got {cover!r}."
            )
        if not isinstance(roll, Cylinder):
            raise InputError(
                f"roll must be an em.Cylinder(radius, length), got {roll!r}."
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
                f"shares must be a list with one share for each roll, got {shares!r}."
            )
        positive("shares", self.shares)
        require(
            "sum of the shares", self.shares.sum(), "1", lambda x: abs(x - 1) < _WHOLE
        )


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

    Exact, in plane strain, for covers given as `em.layer`, and idlers far enough apart
    for the cover to recover between them; within a roll the load is taken as even.
    Bearings, flexure of belt and goods, and lifting are left out. Differentiable as
    `rolling` is.

    Source: `docs/belt.md`.
    """
    for name, side in (("carry", carry), ("back", back)):
        if not isinstance(side, Idlers):
            raise InputError(
                f"{name} must be em.Idlers(cover, roll, spacing=...), got {side!r}."
            )
    given = {"velocity": velocity, "belt": belt, "goods": goods, "gravity": gravity}
    if temperature is not None:
        given["temperature"] = temperature
    arrays = {name: as_float64(name, value) for name, value in given.items()}
    for name, value in arrays.items():
        (not_negative if name == "goods" else positive)(name, value)
    shape = broadcast_shape(**arrays)
    whole = {name: xp.broadcast_to(value, shape) for name, value in arrays.items()}
    v, mass, load, g = (
        whole[name] for name in ("velocity", "belt", "goods", "gravity")
    )
    sides = [
        _side(side, on, v, whole.get("temperature"), model, rtol)
        for side, on in ((carry, (mass + load) * g), (back, mass * g))
    ]
    good = sides[0].converged & sides[1].converged
    weight = (2 * mass + load) * g
    loaded, empty = (nan_unless(good, side.resistance) for side in sides)
    error = nan_unless(good, sides[0].error + sides[1].error) / weight
    inputs = []
    for name, side in (("carry side", carry), ("return side", back)):
        rolls = "1 roll" if side.shares.size == 1 else f"{side.shares.size} rolls"
        cover = side.cover.name or "cover given directly"
        inputs.append(
            (
                name,
                (
                    f"{cover}; {describe(side.roll)}; {rolls} every "
                    f"{brief(side.spacing, 'm')}"
                ),
            )
        )
    said = [
        f"{name}: {side.said}"
        for name, side in zip(("carry", "return"), sides, strict=True)
        if side.said
    ]
    units = {"belt": "kg/m", "goods": "kg/m", "velocity": "m/s", "temperature": "K"}
    inputs += [
        (name, brief(arrays[name], unit))
        for name, unit in units.items()
        if name in arrays
    ]
    inputs += [("extrapolated", "; ".join(said))] if said else []
    return Conveyor(
        velocity=v,
        belt=mass,
        goods=load,
        temperature=whole.get("temperature"),
        carry=loaded,
        back=empty,
        resistance=loaded + empty,
        power=(loaded + empty) * v,
        coefficient=(loaded + empty) / weight,
        error=error,
        converged=good,
        extrapolated=_either(sides),
        model=sides[0].model,
        plan=sides[0].plan,
        inputs=tuple(inputs),
    )


class _Side(Tree):
    """One side of the belt, per length of it."""

    resistance: Any  # [N/m]
    error: Any  # estimated error of it [N/m]
    converged: Any
    # of any of its rolls; None where the range of its cover is not known
    extrapolated: Any
    said: Any = static()  # what lies beyond the range, in words
    model: str = static()
    plan: Any = static()


def _either(sides: list[_Side]) -> Any:
    """Where one of the sides lies beyond the range of its cover, of those whose range
    is known.
    """
    known = [side.extrapolated for side in sides if side.extrapolated is not None]
    return np.logical_or.reduce(known) if known else None


def _side(
    side: Idlers, weight: Any, velocity: Any, kelvin: Any, model: Any, rtol: float
) -> _Side:
    """Resistance of all rolls of a side under a weight per length of belt [N/m]; equal
    rolls are computed once.
    """
    shares, count = side.shares, np.ones(side.shares.size)
    if not is_traced(shares):
        shares, count = np.unique(shares, return_counts=True)
    found = rolling(
        side.cover,
        side.roll,
        velocity=velocity[..., None],
        load=weight[..., None] * side.spacing * shares,
        temperature=None if kelvin is None else kelvin[..., None],
        model=model,
        rtol=rtol,
    )
    total, error = (
        xp.sum(xp.asarray(x) * count, axis=-1)
        for x in (found.resistance, found.error * found.normal_force)
    )
    good = xp.all(xp.asarray(found.converged), axis=-1)
    beyond = None if found.extrapolated is None else np.any(found.extrapolated, axis=-1)
    said = dict(found.inputs).get("extrapolated")
    return _Side(
        total / side.spacing,
        error / side.spacing,
        good,
        beyond,
        said,
        found.model,
        found.plan,
    )
