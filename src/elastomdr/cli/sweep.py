"""`elastomdr sweep`: a scene at every combination of the values of its lists, into a
store.
"""

import argparse
import copy
import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import elastomdr as em

from ..errors import InputError
from . import DONE, NOT_CONVERGED
from .compute import warned_of_at_the_end
from .kinds import decoded, read_content
from .schema import Content, Table, decode, of_file

# slowest first
_ARRAYS = (
    "mass",
    "direction",
    "pressure",
    "load",
    "depth",
    "temperature",
    "velocity",
)


class SweepTable(Table):
    """What is varied besides the lists that the scene has: materials, temperatures,
    pressures, velocities.

    Keys:
        call: what is computed
        vary: keys of the scene with a list of values each, such as "surface.shortest" =
            ["1 mm"]
    """

    call: Literal["friction", "rolling", "impact"] = "friction"
    vary: dict[str, list[Any]] = {}  # noqa: RUF012


class _Sweeping(Table):
    """What a scene of a sweep has more than others.

    Keys:
        sweep: what is varied
    """

    sweep: SweepTable


@dataclass(frozen=True)
class Varied:
    """A verb whose arguments other than arrays are looked up by what varies in a
    scene.
    """

    verb: str
    names: tuple[str, ...]  # of the axes that are looked up
    values: tuple[tuple[Any, ...], ...]  # along each of them
    # one for each combination, the last axis fastest
    arguments: tuple[Content, ...]

    @property
    def __name__(self) -> str:
        return self.verb

    def __call__(
        self, material: Any = None, draw: int | None = None, **given: Any
    ) -> Any:
        from ..material.validity import Draws

        given |= {} if material is None else {"material": material}
        asked = tuple(given.pop(name) for name in self.names)
        arguments = self.arguments[[*itertools.product(*self.values)].index(asked)]
        if draw is not None:
            arguments = {
                key: value[draw - 1] if isinstance(value, Draws) else value
                for key, value in arguments.items()
            }
        return getattr(em, self.verb)(**arguments, **given)


def run(options: argparse.Namespace) -> int:
    """Computes what is missing in the store; returns the exit status."""
    path = Path(options.scene)
    if options.table and Path(options.table).suffix != ".csv":
        raise InputError(
            argument="--table",
            got=options.table,
            accepted="the name of a file that ends in .csv",
        )
    with warned_of_at_the_end(), of_file(path):
        content = read_content(path)
        call, axes = assembled(content, path.parent)
    with warned_of_at_the_end(), _client(options.scheduler) as client:
        dataset = em.sweep(call, axes, store=options.out, client=client)
    if "converged" not in dataset:  # every call raised: the warning says what
        print(f"no point was computed; wrote the messages to {options.out}")
        return NOT_CONVERGED
    sizes = ", ".join(f"{name} {size}" for name, size in dataset.sizes.items())
    good = int(dataset.converged.sum())
    print(f"{dataset.converged.size} points ({sizes}), {good} converged")
    for name, values in dataset.data_vars.items():
        if name in ("mu", "coefficient", "restitution"):
            print(f"{name}: {float(values.min()):.4g} to {float(values.max()):.4g}")
    if options.table:
        _write_table(
            dataset,
            Path(options.table),
            _header(dataset, _inputs(call, content, path)),
        )
    print(f"wrote {options.out}" + (f" and {options.table}" if options.table else ""))
    return DONE if good == dataset.converged.size else NOT_CONVERGED


def assembled(content: Content, folder: Path) -> tuple[Varied, Content]:
    """The call of a sweep and its axes, from the content of a scene file. Raises
    `InputError`.
    """
    from ..material.validity import Draws

    asked = decode(_Sweeping, {"sweep": content.get("sweep", {})}).sweep
    scene = {key: value for key, value in content.items() if key != "sweep"}
    for key, values in asked.vary.items():
        if not values:
            raise InputError(
                argument=f"[sweep.vary] {key}",
                got=values,
                accepted="a list of one value or more",
            )
    varied = {key: tuple(map(_hashable, v)) for key, v in asked.vary.items()}
    materials = scene.get("material")
    if isinstance(materials, list) and len(materials) > 1:
        varied = {"material": tuple(map(str, materials))} | varied
    arguments, arrays = [], {}
    for combination in itertools.product(*varied.values()):
        chosen = dict(zip(varied, combination, strict=True))
        others, here = _arguments(asked.call, scene, chosen, folder)
        if arguments and _as_lists(here) != _as_lists(arrays):
            raise InputError(
                argument="[sweep.vary]",
                got=list(varied),
                accepted="of keys with one value each",
                hint="lists of numbers stand in the scene",
            )
        arguments.append(others)
        arrays = here
    counts = {
        len(value)
        for others in arguments
        for value in others.values()
        if isinstance(value, Draws)
    }
    drawn = {"draw": list(range(1, min(counts) + 1))} if counts else {}
    axes = {key: list(values) for key, values in varied.items()} | drawn | arrays
    if not axes:
        raise InputError(
            argument="[sweep]",
            got=None,
            accepted="given where nothing in the scene is a list",
            hint="there is nothing to sweep over",
        )
    names, values = tuple(varied), tuple(varied.values())
    return Varied(asked.call, names, values, tuple(arguments)), axes


def _arguments(
    verb: str, scene: Content, chosen: Content, folder: Path
) -> tuple[Content, Content]:
    """The arguments of the call for one choice of what varies: those that are looked
    up, and those that are arrays.
    """
    import numpy as np

    content = copy.deepcopy(scene)
    for key, value in chosen.items():
        _put(content, key, list(value) if isinstance(value, tuple) else value)
    arguments = decoded(verb, content).arguments(folder)
    arrays = {
        name: np.ravel(arguments.pop(name))
        for name in _ARRAYS
        if np.size(arguments.get(name, 0)) > 1
    }
    return arguments, arrays


def _as_lists(arrays: Content) -> dict[str, list[float]]:
    return {name: values.tolist() for name, values in arrays.items()}


def _put(scene: Content, key: str, value: Any) -> None:
    """Sets a key such as "surface.shortest". Raises `InputError` where the scene has no
    such table.
    """
    *tables, last = key.split(".")
    place: Any = scene
    for table in tables:
        place = place.get(table) if isinstance(place, dict) else None
    if not isinstance(place, dict):
        raise InputError(
            argument=f"[sweep.vary] {key}",
            got=key,
            accepted="a key in a table that the scene has",
        )
    place[last] = value


def _hashable(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


def _client(address: str | None) -> Any:
    """A client of the cluster at an address. Raises `InputError` where there is
    none.
    """
    import contextlib
    import logging

    if address is None:
        return contextlib.nullcontext()
    try:
        from distributed import Client

        logging.disable()  # Dask logs a lost cluster with pages of tracebacks
        return Client(address, timeout="10s")
    except (OSError, ValueError, ImportError) as error:
        accepted, hint = "the address of a running Dask scheduler", str(error)
        if isinstance(error, ImportError):
            accepted = "left out where distributed is not installed"
            hint = "pip install elastomdr[sweep]"
        raise InputError(
            argument="--scheduler", got=address, accepted=accepted, hint=hint
        ) from error


def _write_table(dataset: Any, path: Path, header: Iterable[str]) -> None:
    """All points as rows, titled as in the tables of curves, so that `em.load_friction`
    reads a map of friction.

    The header stands above.
    """
    from ..files import csv_text, write_files

    points = dataset.drop_vars("state")
    frame = points.to_dataframe().reset_index()
    columns = {}
    for name in frame.columns:
        about = points[name].attrs
        unit = f" [{about['units']}]" if about.get("units") else ""
        columns[about.get("long_name", name) + unit] = frame[name].to_numpy()
    write_files({path: csv_text(header, columns).encode()})


def _inputs(call: Varied, content: Content, path: Path) -> Iterator[tuple[str, str]]:
    """What went in: scene and title, and each material and body that was computed,
    once.
    """
    yield "scene", path.name
    if title := content.get("title"):
        yield "title", " ".join(str(title).split())
    materials = [
        getattr(given.get("material"), "name", "") or "given directly"
        for given in call.arguments
    ]
    yield "material", ", ".join(dict.fromkeys(materials))
    bodies = {
        _in_words(given["shape"]): None for given in call.arguments if "shape" in given
    }
    if bodies:
        yield "surface" if "surface" in content else "indenter", "; ".join(bodies)


def _in_words(body: Any) -> str:
    """A body or a surface, or draws of one."""
    from ..material.validity import Draws
    from ..results.words import describe

    if isinstance(body, Draws):
        return f"{body.name}, {body.words}"
    return f"{body.label}, {body.words()}" if hasattr(body, "words") else describe(body)


def _header(dataset: Any, inputs: Iterable[tuple[str, str]]) -> Iterator[str]:
    yield f"elastomdr {em.__version__}: sweep"
    yield "units: SI, in brackets in the column titles"
    yield from (f"{name}: {words}" for name, words in inputs)
    yield from (
        f"{name}: {value}" for name, value in dataset.attrs.items() if name != "sweep"
    )
