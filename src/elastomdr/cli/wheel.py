"""Scenes of `elastomdr traction`: a wheel or a ball that rolls with a creepage, or
brakes with a slip.
"""

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any, ClassVar

import elastomdr as em

from ..errors import InputError
from .indenter import AnyShape, Cylinder, OfRevolution
from .scene import Contact, Scene, body, load, on_axes
from .schema import Several, Sweep, Table, given, path_from
from .units import AreaStiffness, Force, Length, Velocity


class TractionContact(Contact):
    """How the body is pressed on, how fast it rolls and how much it slips."""

    one_of: ClassVar[tuple[str, ...]] = ("slip", "creepage")
    load: Annotated[Several[Force], "normal force"]
    velocity: Annotated[
        Sweep[Velocity], "with a slip that of the road, with a creepage that of rolling"
    ]
    slip: Annotated[
        Sweep[float] | None, "velocity of slip over that of the road, below 1"
    ] = None
    creepage: Annotated[
        Sweep[float] | None,
        "velocity of slip over the rolling velocity, in place of the slip",
    ] = None


class _Traction(Scene):
    """Traction of a body that rolls."""

    call: ClassVar[str] = "traction"
    friction: Annotated[
        float | str,
        "Coulomb's coefficient, or a table mu(v, T, p) as elastomdr friction writes it",
    ]
    indenter: Annotated[AnyShape, "the body"]
    contact: Annotated[TractionContact, "how it is pressed on and moved"]

    def rolling(self, folder: Path) -> dict[str, Any]:
        """The arguments but for the material."""
        friction: Any = self.friction
        if isinstance(friction, str):
            with path_from("friction"):
                friction = em.load_friction(folder / friction)
        found = given(self, "temperature") | self.numerics.chosen()
        found |= given(self.contact, "load") | self.contact.arguments()
        return {"shape": body(self.indenter, folder), "friction": friction} | on_axes(
            found
        )


class Traction(_Traction):
    """Traction of a ball on a half-space."""

    indenter: Annotated[OfRevolution, "the ball"]

    def arguments(self, folder: Path) -> dict[str, Any]:
        return self.rolling(folder) | {
            "material": load(folder, "material", self.material[0])
        }


class Structure(Table):
    """What carries the load of a wheel."""

    stiffness: Annotated[AreaStiffness, "of the structure, per area of the contact"]


class Tread(Table):
    """What is sheared: a layer of the material."""

    thickness: Annotated[Length, "thickness"]


class WheelTraction(_Traction):
    """Traction of a wheel."""

    mark: ClassVar[str] = "structure"
    indenter: Annotated[Cylinder, "the wheel"]
    structure: Annotated[Structure, "what carries the load"]
    layer: Annotated[Tread, "the tread, which is sheared"]

    @classmethod
    def fits(cls, content: dict[str, Any]) -> bool:
        """Whether the body is a cylinder."""
        shape = content.get("indenter")
        return isinstance(shape, dict) and shape.get("shape") == "cylinder"

    def arguments(self, folder: Path) -> dict[str, Any]:
        rubber = load(folder, "material", self.material[0])
        carries = em.Foundation(
            self.structure.stiffness,
            [],
            [],
            name=f"{rubber.name or 'tread'} on an elastic structure",
        )
        sheared = em.springs(rubber, self.layer.thickness, tangential=True)
        return self.rolling(folder) | {"material": carries, "tangential": sheared}

    def said(self, result: Any) -> str:
        """Why there is no property file, where there is none."""
        try:
            self._temperatures(result)
        except InputError as error:
            return f"no .tir file: {error}"
        return ""

    def further_files(self, result: Any) -> dict[str, Callable[[Path], None]]:
        """The Magic Formula as a property file, one for each temperature; none where it
        cannot be fitted.
        """
        try:
            temperatures = self._temperatures(result)
        except InputError:  # said below the summary
            return {}
        size = {"radius": self.indenter.radius, "width": self.indenter.length}
        return {
            end: partial(result.to_tir, temperature=kelvin, **size)
            for end, kelvin in temperatures.items()
        }

    @staticmethod
    def _temperatures(result: Any) -> dict[str, float | None]:
        """The temperatures of which a Magic Formula is fitted, by the ends of their
        files. Raises `InputError`.
        """
        import numpy as np

        kelvins = (
            [] if result.temperature is None else np.unique(result.temperature).tolist()
        )
        several = {f"-{kelvin - 273.15:.6g}degC.tir": kelvin for kelvin in kelvins}
        temperatures: dict[str, float | None] = (
            {".tir": None} if len(kelvins) < 2 else {**several}
        )
        for kelvin in temperatures.values():
            result.magic_formula(temperature=kelvin)
        return temperatures
