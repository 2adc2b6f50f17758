"""What a scene would compute, skip and condense, without computing it."""

from typing import Any

from .._runtime import in_float64
from ..errors import InputError
from ..solve.plan import Plan
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
) -> Plan:
    """The plan that `friction` (or `rolling`, by `quantity`) would follow; printing it says what is skipped and why.

    Arguments and errors as for `friction`.
    """
    if quantity not in ("friction", "rolling"):
        raise InputError(f"quantity must be 'friction' or 'rolling', got {quantity!r}.")
    return set_up(
        quantity, material, shape, velocity=velocity, load=load, depth=depth, pressure=pressure,
        temperature=temperature, average=average, rtol=rtol, skip=skip,
    ).plan  # fmt: skip
