"""What the scenes of all commands share: material, layer, model of the contact,
numerics.
"""

import abc
import contextlib
import dataclasses
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated, Any, ClassVar

import elastomdr as em

from ..call.types import ModelName
from ..errors import InputError
from .bodies import AnyShape, equivalent_length
from .schema import (
    Count,
    One,
    Positive,
    Several,
    Sweep,
    Table,
    Text,
    given,
    keys_of,
    named,
    only_one,
)
from .units import Length, Temperature, Velocity

_AXES = (
    "velocity",
    "velocity_out",
    "slip",
    "creepage",
    "mass",
    "pressure",
    "pressure_drop",
    "load",
    "depth",
    "direction",
    "goods",
    "ambient",
    "temperature",
    "squeeze",
    "fluid_pressure",
    "time",
)


class LayerTable(Table):
    """The rubber is a layer of any thickness on a rigid base."""

    thickness: Annotated[Length, "thickness"]
    bonded: Annotated[
        bool, "whether it is bonded to its base; false where it can slip"
    ] = True
    springs: Annotated[
        bool, "independent springs, the textbook's, in place of the layer itself"
    ] = False

    def on_base(self, rubber: Any, thickness: float | None = None) -> Any:
        """The layer of a rubber, or its springs; of another thickness if one is
        given.
        """
        kind = em.springs if self.springs else em.layer
        return kind(
            rubber,
            self.thickness if thickness is None else thickness,
            bonded=self.bonded,
        )


class Numerics(Table):
    """How exactly the scene is computed."""

    rtol: Annotated[Positive | None, "relative error to be met"] = None

    def chosen(self) -> dict[str, Any]:
        """`rtol`, empty for the default."""
        return given(self, "rtol")


@contextlib.contextmanager
def models_by_name() -> Iterator[None]:
    """Errors about a model in the words of scene files: "line" with average=true, not
    em.Line(average=True).
    """
    from ..models import KINDS

    try:
        yield
    except InputError as error:
        message = str(error)
        for label, kind in KINDS.items():
            message = re.sub(
                rf"em\.{kind.__name__}\(\)|(?<![.\w]){kind.__name__}\([^()]*\)",
                f'"{label}"',
                message,
            )
            message = re.sub(
                rf"em\.{kind.__name__}\(([^()]*)\)", rf'"{label}" with \1', message
            )
        message = (
            f"[contact] {message}" if message.startswith("model must") else message
        )
        raise InputError(
            message.replace("=True", "=true").replace("=False", "=false")
        ) from error


class ContactTable(Table):
    """How a body is pressed on and how fast it moves, and what the contact is computed
    with.
    """

    one_of: ClassVar[tuple[str, ...]] = ()  # the keys of which there must be one

    velocity: Annotated[Sweep[Velocity], "velocity of sliding or rolling"]
    model: Annotated[
        ModelName | None, "what computes the contact; by default the shape decides"
    ] = None
    corrected: Annotated[
        bool | None, "averaged: corrected for asymmetric contacts, true by default"
    ] = None
    average: Annotated[
        bool | None, "line: averaged over directions, false by default"
    ] = None
    equivalent_length: Annotated[
        Text | None, 'line: turns a pressure into a load; a length or "full contact"'
    ] = None
    seeds: Annotated[
        int | list[int] | None,
        "line, half-space: number of random lines or maps, or their seeds",
    ] = None
    samples: Annotated[Count | None, "line: samples of a line"] = None
    periods: Annotated[
        Count | None,
        "line, half-space: length of a line, side of a map, in longest waves",
    ] = None
    gamma: Annotated[float | None, "persson: share of the stored energy, 0 to 1"] = None
    stored: Annotated[
        bool | None,
        "persson: whether stored energy is reduced in the contact area as well",
    ] = None
    cells: Annotated[Count | None, "half-space: cells along each side of the grid"] = (
        None
    )

    def __post_init__(self) -> None:
        only_one(self, *self.one_of)
        self._model()

    def arguments(self) -> dict[str, Any]:
        """Velocity, load or depth, and model."""
        return given(self, "velocity", *self.one_of) | self._model()

    def _model(self) -> dict[str, Any]:
        """The model as an object, empty for the default. Raises `InputError` for an
        option of another model.
        """
        options = given(
            self,
            *(key for key in keys_of(ContactTable) if key not in ("velocity", "model")),
        )
        if self.model is None and not options:
            return {}
        from ..models import KINDS

        kinds: dict[str, Any] = KINDS
        for key in options:
            homes = [
                name
                for name, kind in kinds.items()
                if key in {field.name for field in dataclasses.fields(kind)}
            ]
            if self.model not in homes:
                wanted = " or ".join(f'"{name}"' for name in homes)
                got = "no model" if self.model is None else f'model = "{self.model}"'
                raise InputError(f"{key} belongs to model = {wanted}, got {got}.")
        if "equivalent_length" in options:
            options["equivalent_length"] = equivalent_length(
                options["equivalent_length"]
            )
        return {"model": kinds[self.model or ""](**options)}


class Scene(Table):
    """A scene file."""

    # the table by which a scene of this kind is recognised
    mark: ClassVar[str] = "indenter"
    call: ClassVar[str]

    title: Annotated[Text | None, "title of the figure"] = None
    material: Annotated[
        One[Text],
        "the rubber: a name in the library, or a material file beside the scene",
    ]
    temperature: Annotated[Several[Temperature] | None, "temperature of the rubber"] = (
        None
    )
    numerics: Annotated[Numerics, "how exactly it is computed"] = Numerics()

    @classmethod
    def fits(cls, content: dict[str, Any]) -> bool:
        """Whether a file is a scene of this kind."""
        return cls.mark in content

    def called(self) -> str:
        """The function of elastomdr that computes the scene."""
        return self.call

    def said(self, result: Any) -> str:
        """What is printed below the summary of the result."""
        return ""

    def beside(self, folder: Path) -> dict[str, Any] | None:
        """The arguments of `em.rolling` for what is drawn beside the result, if
        anything. Raises `InputError`.
        """
        return None

    def further_files(self, result: Any) -> dict[str, Callable[[Path], None]]:
        """What is written besides table and figure: the end of each file's name, and
        what writes it.
        """
        return {}

    @abc.abstractmethod
    def arguments(self, folder: Path) -> dict[str, Any]:
        """The arguments of that function, in SI units; files are looked for in
        `folder`. Raises `InputError`.
        """


class OfBodies(Scene):
    """A scene in which a body or a surface meets one rubber or two, or a layer."""

    material: Annotated[  # type: ignore[assignment]
        Several[Text],
        (
            "the rubber: a name in the library, or a material file beside the scene; "
            "a list compares several"
        ),
    ]
    other: Annotated[
        Text | None,
        "the second body, where it is no rigid one: two half-spaces in contact",
    ] = None
    layer: Annotated[LayerTable | None, "the rubber is a layer on a rigid base"] = None

    def __post_init__(self) -> None:
        if self.other is not None and self.layer is not None:
            raise InputError(
                "other and [layer] exclude each other: two bodies are two "
                "half-spaces in contact."
            )

    def rubbers(self, folder: Path) -> list[Any]:
        """The materials."""
        return [load(folder, "material", name) for name in self.material]

    def common(self, folder: Path) -> dict[str, Any]:
        """`material`, `rtol` and, unless it has been applied to the material already,
        `temperature`.
        """
        arguments = self.numerics.chosen() | given(self, "temperature")
        rubbers = self.rubbers(folder)
        several = len(rubbers) > 1
        if self.layer is not None:
            with named("[layer]"):
                rubbers = made(rubbers, [self.layer.on_base(each) for each in rubbers])
        if self.other is None or self.layer is not None:
            return arguments | {"material": rubbers if several else rubbers[0]}
        if several:
            raise InputError(
                "material must be a single one beside other: two bodies in contact."
            )
        return _pair(rubbers[0], load(folder, "other", self.other), arguments)


def made(of: list[Any], parts: list[Any]) -> list[Any]:
    """What was made of each material, still draws where these are."""
    from ..material.validity import Draws

    return Draws(parts, of.name, of.words) if isinstance(of, Draws) else parts


def load(folder: Path, key: str, name: str) -> Any:
    """A material of the library, or of a file beside the scene."""
    is_file = name.endswith(".toml") or "/" in name or "\\" in name
    # by a list: asking for a name may fail, as where it is too long
    beside = {path.stem for path in folder.glob("*.toml")}
    with named(f"{key}:"):
        if not is_file and name not in em.materials() and name in beside:
            raise InputError(
                f"{name!r} is not in the library, but a file beside the scene: write "
                f'"{name}.toml".'
            )
        return em.load_material(str(folder / name) if is_file else name)


def on_axes(arguments: dict[str, Any]) -> dict[str, Any]:
    """Gives each list an axis of its own: temperature first, then load or depth or
    goods, velocity last.
    """
    import numpy as np

    shaped, after = dict(arguments), 0
    for name in _AXES:
        value = arguments.get(name)
        if isinstance(value, Several):
            shaped[name] = (
                np.asarray(value).reshape(-1, *[1] * after)
                if len(value) > 1
                else value[0]
            )
            after += len(value) > 1
    return shaped


def body(shape: AnyShape, folder: Path) -> Any:
    """The body of an [indenter]."""
    with named("[indenter]"):
        return shape.make(folder)


def _pair(material: Any, other: Any, arguments: dict[str, Any]) -> dict[str, Any]:
    """Two bodies in contact. Where they shift differently, both are brought to the one
    temperature first.
    """
    import numpy as np

    from ..material.shift import same_thermal

    if same_thermal(material, other):
        return arguments | {"material": em.half_space(material, other)}
    temperature, *more = np.ravel(arguments.pop("temperature", ()))[:2].tolist() or [
        None
    ]
    if temperature is None or more:
        got = "several" if more else "none"
        raise InputError(
            f"temperature must be a single value, got {got}: material and other "
            "have different shift laws."
        )
    bodies = [
        body.at(temperature) if body.shift or body.vertical else body
        for body in (material, other)
    ]
    pair = em.half_space(*bodies)
    name = f"{pair.name} at {temperature:g} K"
    return arguments | {
        "material": em.Foundation(
            pair.equilibrium,
            pair.moduli,
            pair.times,
            pair.viscosity,
            per_area=False,
            name=name,
            range=pair.range,
        )
    }
