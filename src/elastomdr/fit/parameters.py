"""What a calibration may adjust: parameters of a material, of a surface, and of what
turns one into a coefficient.

All but `slope`, `cutoff` and `offset` are log10 of a factor, so that 0 leaves
everything as it is. The parameters of a surface act on its spectrum C(q): `q_high`
moves where it ends, C below stays as it was (beyond a table it goes on as its last
power law), `heights` scales all heights, `length` scales the length that turns a
pressure into a line load.
"""

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

import equinox as eqx
import jax.numpy as jnp

from ..errors import InputError
from ..material.prony import Prony
from ..material.shift import WLF
from ..models import Line, as_model
from ..surface.spectrum import AbstractSpectrum

MEANINGS = {
    "modulus": "log10 of a factor on all moduli",
    "equilibrium": "log10 of a factor on the equilibrium modulus",
    "slope": "exponent s of a factor (tau/tau_middle)^s on the moduli of the spectrum",
    "cutoff": (
        "log10 of a time tau_c [s]; moduli of branches are divided by 1 + (tau_c/tau)^2"
    ),
    "time": "log10 of a factor on all relaxation times",
    "c1": "log10 of a factor on the WLF constant c1",
    "c2": "log10 of a factor on the WLF constant c2",
    "q_high": "log10 of a factor on the upper cutoff of the surface's spectrum",
    "heights": "log10 of a factor on the heights of the surface",
    "length": (
        "log10 of a factor on equivalent_length of em.Line, the length that turns a "
        "pressure into a line load"
    ),
    "offset": "a constant added to the computed coefficient, such as adhesion",
    "gain": "log10 of a factor on the computed coefficient",
}
OF_SURFACE = ("q_high", "heights", "length")

Change = Callable[[Prony, Any, dict[str, Any]], tuple[Prony, Any]]


def check(
    names: Mapping[str, Any], material: Prony, shape: Any, scene: Mapping[str, Any]
) -> None:
    """Raises `InputError` for parameters that material, shape or scene do not have."""
    if {"c1", "c2"} & names.keys() and not isinstance(material.shift, WLF):
        raise InputError(
            "parameters c1 and c2 need a material with a WLF law, got "
            f"{material.shift!r}."
        )
    if {"q_high", "heights"} & names.keys() and not isinstance(shape, AbstractSpectrum):
        raise InputError(
            "parameters q_high and heights need a surface with a spectrum, got "
            f"{shape!r}."
        )
    if "length" in names:
        model = as_model(scene.get("model"))
        if not isinstance(model, Line) or not isinstance(
            model.equivalent_length, (int, float)
        ):
            raise InputError(
                "parameter length needs a number [m] to start from, in "
                "model=em.Line(equivalent_length=...), got "
                f"model={model!r}."
            )


def applied(
    material: Prony,
    shape: Any,
    scene: Mapping[str, Any],
    values: dict[str, Any],
    change: Change | None,
) -> tuple[Prony, Any, dict[str, Any]]:
    """Material, shape and scene with the parameters in them; those of the material are
    differentiable.
    """
    if change is not None:
        material, shape = change(material, shape, values)
    scene = dict(scene)
    if "q_high" in values:
        shape = shape.ended(shape.q_high * 10.0 ** values["q_high"])
    if "heights" in values:
        shape = shape.raised(10.0 ** values["heights"])
    if "length" in values:
        model = as_model(scene["model"])
        assert isinstance(model, Line)
        length = model.equivalent_length * 10.0 ** values["length"]
        scene["model"] = dataclasses.replace(model, equivalent_length=length)
    return _of_material(material, values), shape, scene


def _of_material(material: Prony, values: dict[str, Any]) -> Prony:
    times, moduli = jnp.asarray(material.times), jnp.asarray(material.moduli)
    equilibrium = jnp.asarray(material.equilibrium)
    if "slope" in values and times.size:
        middle = jnp.exp(jnp.mean(jnp.log(times)))
        moduli = moduli * (times / middle) ** values["slope"]
    if "cutoff" in values:
        moduli = moduli / (1 + (10.0 ** values["cutoff"] / times) ** 2)
    equilibrium = equilibrium * 10.0 ** (
        values.get("equilibrium", 0.0) + values.get("modulus", 0.0)
    )
    moduli, times = (
        moduli * 10.0 ** values.get("modulus", 0.0),
        times * 10.0 ** values.get("time", 0.0),
    )
    material = eqx.tree_at(
        lambda m: (m.equilibrium, m.moduli, m.times),
        material,
        (equilibrium, moduli, times),
    )
    if {"c1", "c2"} & values.keys():
        law: Any = material.shift
        factors = (10.0 ** values.get("c1", 0.0), 10.0 ** values.get("c2", 0.0))
        law = eqx.tree_at(
            lambda s: (s.c1, s.c2), law, (law.c1 * factors[0], law.c2 * factors[1])
        )
        material = eqx.tree_at(lambda m: m.shift, material, law)
    return material
