"""What a scene would compute, skip and condense, without computing it."""

from collections.abc import Sequence
from typing import Any

from .._runtime import in_float64
from ..errors import InputError
from ..mapping.synthesis import PERIODS
from ..solve.heat import Heat
from ..solve.periodic_plan import RoughPlan
from ..solve.plan import Plan
from .rough import is_rough, only_rough, rough_plan
from .steady import set_up


@in_float64
def plan(
    material: Any,
    shape: Any,
    *,
    velocity: Any,
    load: Any = None,
    depth: Any = None,
    pressure: Any = None,
    temperature: Any = None,
    average: str | None = "direction",
    rtol: float = 1e-6,
    skip: bool = True,
    quantity: str = "friction",
    equivalent_length: Any = None,
    samples: int | None = None,
    periods: int = PERIODS,
    seeds: int | Sequence[int] = 1,
    heat: Heat | None = None,
) -> Plan | RoughPlan:
    """The plan that `friction` (or `rolling`, by `quantity`) would follow; printing it says what is skipped and why.

    Arguments and errors as for `friction`.
    """
    if quantity not in ("friction", "rolling"):
        raise InputError(f"quantity must be 'friction' or 'rolling', got {quantity!r}.")
    if is_rough(shape):
        if quantity != "friction":
            raise InputError(f"quantity must be 'friction' on a rough surface, got {quantity!r}.")
        return rough_plan(
            material, shape, velocity=velocity, load=load, depth=depth, pressure=pressure, temperature=temperature,
            average=average, rtol=rtol, skip=skip, equivalent_length=equivalent_length, samples=samples,
            periods=periods, seeds=seeds, heat=heat,
        )  # fmt: skip
    only_rough(equivalent_length, heat)
    return set_up(
        quantity, material, shape, velocity=velocity, load=load, depth=depth, pressure=pressure,
        temperature=temperature, average=average, rtol=rtol, skip=skip,
    ).plan  # fmt: skip
