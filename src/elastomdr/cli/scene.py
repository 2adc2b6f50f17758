"""What the scenes of all commands share: material, layer, model of the contact,
numerics.
"""

import contextlib
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import elastomdr as em

from ..call.types import ModelName
from ..errors import InputError, advised, quiet, warn
from ..trees import replaced
from .bodies import SurfaceTable
from .schema import (
    Arguments,
    Content,
    Count,
    One,
    Positive,
    Several,
    Sweep,
    Table,
    Text,
    as_typed,
    given,
    keys_of,
    named,
    only_one,
    path_from,
)
from .units import EquivalentLength, Length, Temperature, Velocity

if TYPE_CHECKING:
    from ..results.base import Result

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
    """The rubber is a layer of any thickness on a rigid base.

    Keys:
        thickness: thickness
        bonded: whether it is bonded to its base; false where it can slip
        springs: independent springs, the textbook's, in place of the layer itself
    """

    thickness: Length
    bonded: bool = True
    springs: bool = False

    aside = True

    def on_base(self, rubber: "em.Prony", thickness: float | None = None) -> Any:
        """The layer of a rubber, or its springs; of another thickness if one is
        given.
        """
        kind = em.springs if self.springs else em.layer
        return kind(rubber, thickness or self.thickness, bonded=self.bonded)


class Numerics(Table):
    """How exactly the scene is computed.

    Keys:
        rtol: relative error to be met
    """

    rtol: Positive | None = None


class ContactTable(Table):
    """How a body is pressed on and how fast it moves, and what the contact is computed
    with.

    Keys:
        velocity: velocity of sliding or rolling
        model: what computes the contact; by default the shape decides
        corrected: averaged: corrected for asymmetric contacts, true by default
        average: line: averaged over directions, false by default
        equivalent_length: line: turns a pressure into a load; a length or "full
            contact"
        seeds: line, half-space: number of random lines or maps, or their seeds
        samples: line: samples of a line
        periods: line, half-space: length of a line, side of a map, in longest waves
        gamma: persson: share of the stored energy, 0 to 1
        stored: persson: whether stored energy is reduced in the contact area as well
        cells: half-space: cells along each side of the grid
    """

    one_of: ClassVar[tuple[str, ...]] = ()  # the keys of which there must be one

    velocity: Sweep[Velocity]
    model: ModelName | None = None
    corrected: bool | None = None
    average: bool | None = None
    equivalent_length: EquivalentLength | None = None
    seeds: int | list[int] | None = None
    samples: Count | None = None
    periods: Count | None = None
    gamma: float | None = None
    stored: bool | None = None
    cells: Count | None = None

    def __post_init__(self) -> None:
        only_one(self, *self.one_of)
        self.arguments(Path())

    def arguments(self, folder: Path) -> Arguments:
        """Its own keys, and the model with its options. Raises `InputError` for an
        option of another model.
        """
        found = given(self)
        model = found.pop("model", None)
        options = {
            key: found.pop(key)
            for key in keys_of(ContactTable)
            if key != "velocity" and key in found
        }
        if model is None and not options:
            return found
        from ..verbs.roads import KINDS

        kinds: dict[str, Any] = KINDS
        for key in options:
            homes = [n for n, k in kinds.items() if key in k.__dataclass_fields__]
            if model not in homes:
                wanted = " or ".join(f'"{name}"' for name in homes)
                got = "no model" if model is None else f'model = "{model}"'
                raise InputError(
                    argument=key,
                    got=options[key],
                    accepted=f"left out, or beside model = {wanted}",
                    hint=f"here is {got}",
                )
        return found | {"model": kinds[str(model)](**options)}


class Scene(Table):
    """A scene file.

    Keys:
        title: title of the figure
        material: the rubber: a name in the library, or a material file beside the scene
        temperature: temperature of the rubber
        numerics: how exactly it is computed
    """

    # the table by which a scene of this kind is recognised
    mark: ClassVar[str] = "indenter"
    call: ClassVar[str]
    without: ClassVar[dict[str, str]] = {}  # keys of other kinds, and why not here
    rough: ClassVar[str] = "surface"  # what the call calls a [surface]

    title: Text | None = None
    material: One[Text]
    temperature: Several[Temperature] | None = None
    numerics: Numerics = Numerics()

    @classmethod
    def fits(cls, content: Content) -> bool:
        """Whether a file is a scene of this kind."""
        return cls.mark in content

    def called(self) -> str:
        """The function of elastomdr that computes the scene."""
        return self.call

    def doubted(self, result: "Result") -> "Result":
        """The result with the doubts that the scene has."""
        from ..results.doubts import Doubt

        everywhere, marks = result.converged | True, result.marks
        for said in getattr(self, "doubts", None) or ():
            marks += (Doubt("estimate", everywhere, f"rest on a calibration: {said}"),)
        return replaced(result, marks=marks) if marks else result

    def outcome(self, result: Any) -> Any:
        """What is shown and written of a result: of a comparison the ranking. Raises
        `InputError`.
        """
        compare = getattr(self, "compare", None)
        if compare is None:
            return result
        with named("[compare]"), as_typed(compare):
            return result.ranking(**given(compare))

    def said(self, result: Any) -> str:
        """What is printed below the summary of the result."""
        return ""

    def beside(self, folder: Path) -> Arguments | None:
        """The arguments of `em.rolling` for what is drawn beside the result, if
        anything. Raises `InputError`.
        """
        return None

    def further_files(self, result: Any) -> dict[str, Callable[[Path], None]]:
        """What is written besides table and figure: the end of each file's name, and
        what writes it.
        """
        return {}

    @contextlib.contextmanager
    def in_keys(self) -> Iterator[None]:
        """Calls the argument of an `InputError` by the key of the scene that holds it."""
        try:
            with as_typed(self):
                yield
        except InputError as error:
            name = error.argument
            present = given(self)
            tables = {k: t for k, t in present.items() if isinstance(t, Table)}
            if name in tables:
                error.called(f"[{name}]")
            elif name not in present and (
                home := [k for k, t in tables.items() if name in given(t)]
            ):
                with named(f"[{home[0]}]"), as_typed(tables[home[0]]):
                    raise
            elif name not in self.__struct_fields__ and (  # a key that is missing
                home := [k for k, t in tables.items() if name in keys_of(type(t))]
            ):
                of_call = self.mark if self.mark in home else home[0]
                error.called(f"[{of_call}] {name}")
            raise

    def rubber(self, folder: Path) -> Arguments:
        """The material with its temperature. Raises `InputError`."""
        material = load(folder, "material", self.material[0])
        return {"material": material} | given(self, "temperature")

    def of_surface(self, surface: SurfaceTable, folder: Path) -> Arguments:
        """What the call takes of a [surface]."""
        judged = self.call == "friction" and not hasattr(self, "compare")
        draws = getattr(self, "uncertainty", None) or (None if judged else 0)
        return {self.rough: surface.drawn(folder, draws)}

    def judged(self, result: Any, measured: "em.MeasuredFriction | None") -> Any:
        """What the result rests on, with what is stated of its road and was measured."""
        surface = getattr(self, "surface", None)
        stated = surface.errors() if surface else {}
        return result.uncertainty(**stated, measured=measured)

    def points(self, folder: Path) -> "em.MeasuredFriction | None":
        """Measured friction, with a warning for points that were left out. Raises
        `InputError`.
        """
        if (file := getattr(self, "measured", None)) is None:
            return None
        with quiet(em.fit.FitWarning), path_from("measured", folder):
            try:
                measured = em.read_friction(folder / file)
            except InputError as error:  # a scene has no options for the reader
                if advised(error.hint):
                    error.hint = 'its titles have to say it, such as "velocity [mm/s]"'
                raise
        for line in measured.report:
            warn(line, em.ModelWarning)
        return measured

    def arguments(self, folder: Path) -> Arguments:
        """The arguments of that function, in SI units, those of its tables among them;
        files are looked for in `folder`. Raises `InputError`.
        """
        found = self.rubber(folder)
        for key in self.__struct_fields__:
            table = getattr(self, key)
            with named(f"[{key}]"):
                if isinstance(table, SurfaceTable):
                    found |= self.of_surface(table, folder)
                elif isinstance(table, Table) and not table.aside:
                    found |= table.arguments(folder)
        return on_axes(found)


class OfBodies(Scene):
    """A scene in which a body or a surface meets one rubber or two, or a layer.

    Keys:
        material: the rubber: a name in the library, or a material file beside the
            scene; a list compares several
        other: the second body, where it is no rigid one: two half-spaces in contact
        layer: the rubber is a layer on a rigid base
    """

    material: Several[Text]  # type: ignore[assignment]
    other: Text | None = None
    layer: LayerTable | None = None

    def __post_init__(self) -> None:
        if self.other is not None and self.layer is not None:
            raise InputError(
                argument="other",
                got=self.other,
                accepted="left out beside [layer]",
                hint="two bodies are two half-spaces in contact",
            )
        if hasattr(self, "compare") and len(self.material) < 2:
            raise InputError(
                argument="material",
                got=list(self.material),
                accepted="a list of two or more to be compared",
            )

    def rubbers(self, folder: Path) -> list[Any]:
        """The materials."""
        return [load(folder, "material", name) for name in self.material]

    def rubber(self, folder: Path) -> Arguments:
        """The material with its temperature, unless that has been applied to it
        already.
        """
        rubbers = self.rubbers(folder)
        several = len(rubbers) > 1
        if self.layer is not None:
            with named("[layer]"):
                rubbers = made(rubbers, self.layer.on_base)
        if self.other is not None:
            if several:
                raise InputError(
                    argument="material",
                    got=list(self.material),
                    accepted="a single one beside other",
                    hint="these are two bodies in contact",
                )
            return _pair(
                rubbers[0], load(folder, "other", self.other), self.temperature or ()
            )
        return {"material": rubbers if several else rubbers[0]} | given(
            self, "temperature"
        )


def made(of: list[Any], make: Callable[[Any], Any]) -> list[Any]:
    """What is made of each material, still draws where these are."""
    from ..material.validity import Draws

    return of.made(make) if isinstance(of, Draws) else [make(each) for each in of]


def load(folder: Path, key: str, name: str) -> Any:
    """A material of the library, or of a file beside the scene."""
    is_file = name.endswith(".toml") or "/" in name or "\\" in name
    # by a list: asking for a name may fail, as where it is too long
    beside = {path.stem for path in folder.glob("*.toml")}
    with path_from(key, folder):
        if not is_file and name not in em.materials() and name in beside:
            raise InputError(
                argument="name_or_path",
                got=name,
                accepted=f'in the library, or "{name}.toml" beside the scene',
            )
        return em.load_material(folder / name if is_file else name)


def on_axes(arguments: Arguments) -> Arguments:
    """Gives each list an axis of its own: temperature first, then load or depth or
    goods, velocity last.
    """
    import numpy as np

    shaped, after = dict(arguments), 0
    for name in _AXES:
        value = arguments.get(name)
        if isinstance(value, Several):
            shaped[name] = value[0]
            if len(value) > 1:
                shaped[name] = np.asarray(value).reshape(-1, *[1] * after)
                after += 1
    return shaped


def _pair(
    material: "em.Prony", other: "em.Prony", temperatures: Sequence[float]
) -> Arguments:
    """Two bodies in contact. Where they shift differently, both are brought to the one
    temperature first.
    """
    from ..material.shift import same_thermal

    if same_thermal(material, other):
        found: Arguments = {"material": em.half_space(material, other)}
        return found | ({"temperature": temperatures} if temperatures else {})
    if len(temperatures) != 1:
        raise InputError(
            argument="temperature",
            got=list(temperatures) or None,
            accepted="a single value where material and other have different shift laws",
        )
    (temperature,) = temperatures
    pair = em.half_space(
        *(
            body.at(temperature) if body.shift or body.vertical else body
            for body in (material, other)
        )
    )
    return {
        "material": em.Foundation(
            pair.equilibrium,
            pair.moduli,
            pair.times,
            pair.viscosity,
            per_area=False,
            name=f"{pair.name} at {temperature:g} K",
            range=pair.range,
        )
    }
