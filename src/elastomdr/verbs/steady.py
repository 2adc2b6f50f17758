"""What friction and rolling of smooth bodies share: the contact is that of a layer, or
of independent elements, and its curve has the same fields.
"""

from __future__ import annotations

import functools
import sys
from collections.abc import Callable
from typing import Any, NamedTuple, ParamSpec, TypeVar

from ..checks import Array, is_traced
from ..errors import InputError
from ..smooth.on_layer import beside_layer, is_on_layer, on_layer, plan_on_layer
from ..smooth.plan import Plan
from ..smooth.problem import LayerPlan, SmoothCall, Steady, check, solve
from ..smooth.softening import SOFTENED

P = ParamSpec("P")
R = TypeVar("R")


class SteadyContact(NamedTuple):
    """A solved contact, and how it was solved."""

    solution: Steady
    temperature: Array | None  # broadcast to the points
    model: str
    plan: Plan | LayerPlan
    layer: bool  # whether the rubber is a layer, exact or of springs

    def common_fields(self) -> dict[str, Any]:
        """What both curves have by the same name."""
        solution = self.solution
        return {
            "velocity": solution.velocity,
            "normal_force": solution.normal_force,
            "depth": solution.depth,
            "contact": solution.contact,
            "error": solution.error,
            "model_error": solution.model_error,
            "converged": solution.converged,
            "marks": solution.marks,
            "temperature": self.temperature,
            "strain": solution.strain,
            "linear": solution.linear,
            "model": self.model + ("" if solution.strain is None else SOFTENED),
            "plan": self.plan,
            "inputs": solution.inputs,
        }


def steady_contact(call: SmoothCall) -> SteadyContact:
    """Solves a smooth body on a layer, or on independent elements. Raises
    `InputError`.
    """
    if is_on_layer(call.material, call.shape):
        solved = on_layer(call)
        plan = solved.plan
        return SteadyContact(solved.steady, solved.temperature, plan.model, plan, True)
    scene = check(call)
    solution = beside_layer(solve(scene), call)
    return SteadyContact(
        solution,
        scene.temperature,
        scene.plan.model,
        scene.plan,
        bool(scene.foundation.per_area),
    )


def steady_plan(call: SmoothCall) -> Plan | LayerPlan:
    """The plan that `steady_contact` would follow. Raises `InputError`."""
    if is_on_layer(call.material, call.shape):
        return plan_on_layer(call)
    return check(call).plan


def in_64_bits_where(
    condition: Callable[[object, object, object], bool],
) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Refuses calls under jit, grad or vmap without 64-bit types, for programs in which
    JAX would mix both widths when the verb has returned, under the caller's setting.

    `condition` has the material, the shape and the pressure.
    """

    def decorate(verb: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(verb)
        def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
            material = args[0] if args else kwargs.get("material")
            shape = args[1] if len(args) > 1 else kwargs.get("shape")
            if (
                condition(material, shape, kwargs.get("pressure"))
                and is_traced(args, kwargs)
                and not sys.modules["jax"].config.read("jax_enable_x64")
            ):
                raise InputError(
                    argument="jax_enable_x64",
                    got=False,
                    accepted=f"True for em.{verb.__name__} under jit, grad or vmap",
                    hint="put `with jax.enable_x64(True):` around the call, or set "
                    "JAX_ENABLE_X64=1",
                )
            return verb(*args, **kwargs)

        return wrapper

    return decorate


def needs_layer(material: object, shape: object, _: object) -> bool:
    """Whether a call needs the layer, as a condition for `in_64_bits_where`."""
    return is_on_layer(material, shape)
