"""Computing a scene, and the files that come of it: the TOML that reproduces it, its
tables and its figure; a slip curve with the friction of its own rubber on the road.
"""

import contextlib
import dataclasses
import inspect
import io
import json
import math
import tempfile
import zipfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np

import elastomdr as em

from ..cli.compute import how_drawn
from ..cli.kinds import decoded, toml, without_empty
from ..cli.schema import Content
from ..errors import InputError, heard, quiet
from ..results.base import Result
from ..results.uncertainty import Uncertainty
from .chart import Drawn, drawn
from .security import Folder
from .words import spoken

_JUDGED = 10.0  # seconds up to which what takes four times as long is computed as well
_FILES = (
    "file",
    "measured",
    "friction",
    "profile",
)  # keys that name a file beside the scene


class CancelledError(BaseException):
    """Raised where a computation is stopped by its user; as an interrupt from the
    keyboard, nothing but who started the computation may catch it.
    """


@dataclass
class Done:
    """A computed scene; that of a comparison has a ranking as its result."""

    verb: str
    content: Content
    result: Any
    warnings: tuple[str, ...]
    plot_options: Content = field(repr=False)
    asked: Content = field(repr=False)  # as it was filled in
    more: str = ""  # what is said below the summary
    # files that it was computed with and that the page may replace, as they were
    made: dict[str, bytes] = field(default_factory=dict, repr=False)
    measured: em.MeasuredFriction | None = None
    parts: Uncertainty | None = None  # what its uncertainty consists of
    seconds: float = 0.0  # of processor time that it took

    def belongs_to(self, asked: Content, folder: Folder) -> bool:
        """Whether it has been computed of this, with the files as they are now."""
        return without_empty(self.asked) == without_empty(asked) and all(
            (folder.path / name).read_bytes() == content
            for name, content in self.made.items()
        )

    def figure(self) -> Drawn:
        """The figure, with the table of the result as its numbers."""
        return drawn(self.result.plot(**self.plot_options), self.csv)

    @cached_property
    def shown(self) -> Any:
        """What cards and readings show: of draws their median, with half of the
        interval that holds 95 % of them as part of the error.
        """
        result = self.result
        if not isinstance(result, Result) or not result.drawn:
            return result
        low, middle, high = result.band()
        half = 0.5 * (high - low) / (middle if result.relative_bound else 1.0)
        typical = result.typical()
        return dataclasses.replace(typical, error=typical.error + half)

    @property
    def judges(self) -> bool:
        """Whether there is more to know of its uncertainty, which takes some time."""
        can = isinstance(self.result, em.FrictionCurve | em.RollingCurve)
        several = can and bool(self.result.origins) and not self.result.drawn
        return can and not several and self.parts is None and self.seconds < _JUDGED

    def judge(self) -> None:
        """Computes what its uncertainty consists of."""
        with quiet():  # of points that are not shown
            self.parts = decoded(self.verb, self.content).judged(
                self.result, self.measured
            )

    @property
    def curve(self) -> Any:
        """The result itself, of a ranking the curves that are ranked."""
        return self.result.curve if self.verb == "compare" else self.result

    def csv(self) -> bytes:
        """The table, as the command line writes it."""
        return written(self.result.to_csv, "table.csv")

    def excel(self) -> bytes:
        """All that was computed as a workbook. Raises `InputError` without openpyxl."""
        return written(self.curve.to_excel, "table.xlsx")

    def law(self, form: str) -> bytes:
        """Friction over velocity, temperature and pressure, of draws their median, for
        another program, in a form of `em.FrictionLaw`. Raises `InputError`.
        """
        return written(getattr(self.shown.law(), f"to_{form}"), "law")

    def tir(self) -> bytes:
        """The Magic Formula of a slip curve as a property file. Raises `InputError`
        where it has none.
        """
        wheel = decoded(self.verb, self.content).indenter  # type: ignore[attr-defined]
        return written(
            partial(self.result.to_tir, radius=wheel.radius, width=wheel.length),
            "tyre.tir",
        )


def bundle(
    computation: Done, folder: Folder, stem: str, notes: tuple[str, ...] = ()
) -> bytes:
    """A zip archive of the scene, the files it names, its table and its figure."""
    scene, figure = computation.content, computation.figure()
    files = {f"{stem}.toml": toml(computation.verb, scene, stem, notes).encode()}
    for name in files_of(scene):
        here = computation.made.get(name)
        files[name] = (folder.path / name).read_bytes() if here is None else here
    files[f"out/{stem}-{computation.verb}.csv"] = computation.csv()
    for kind in ("png", "svg"):
        files[f"out/{stem}-{computation.verb}.{kind}"] = figure.saved(kind)
    return zipped(files)


def zipped(files: Mapping[str, bytes]) -> bytes:
    """A zip archive of files by their names."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return buffer.getvalue()


def files_of(content: Content) -> list[str]:
    """The files beside the scene that it names."""
    files, rubber = [], content.get("material", [])
    names = [*(rubber if isinstance(rubber, list) else [rubber]), content.get("other")]
    files += [name for name in names if isinstance(name, str) and _is_file(name)]
    for table in (
        content,
        *(inner for inner in content.values() if isinstance(inner, dict)),
    ):
        files += [table[key] for key in _FILES if isinstance(table.get(key), str)]
    return list(dict.fromkeys(files))


def compute(
    verb: str,
    content: Content,
    folder: Folder,
    progress: Callable[[int, int], None] | None = None,
) -> Done:
    """Computes a scene as the command line does. Raises `InputError` that begins with
    the key at fault.
    """
    # what is typed meanwhile does not matter
    content = json.loads(json.dumps(without_empty(content)))
    scene = decoded(verb, content)
    folder.check(files_of(content))
    made = {
        name: (folder.path / name).read_bytes()
        for name in files_of(content)
        if name == TABLE or name.endswith(".toml")
    }
    with heard() as said:
        arguments = scene.arguments(folder.path)
        measured = scene.points(folder.path)
        plot_options = how_drawn(scene, arguments, measured)
        call = getattr(em, scene.called())
        tells = "progress" in inspect.signature(call).parameters
        more = {"progress": progress} if tells else {}
        with scene.in_keys(), _within(arguments.get("friction")):
            result = call(**arguments, **more)
        result = scene.outcome(scene.doubted(result))
    texts = tuple(dict.fromkeys(spoken(each.message) for each in said))
    return Done(
        verb,
        content,
        result,
        texts,
        plot_options,
        content,
        made=made,
        measured=measured,
    )


@contextlib.contextmanager
def _within(law: object) -> Iterator[None]:
    """Says of a value beyond a table of friction what to do."""
    try:
        yield
    except InputError as error:
        axes = law.axes() if isinstance(law, em.FrictionLaw) else {}
        axis, got = axes.get(error.argument), error.got
        if (
            axis is not None
            and isinstance(got, float)
            and not axis[0] <= got <= axis[-1]
        ):
            error.inside("", "friction")
            error.hint = "Computed on the road of the road screen it covers what the wheel needs."
        raise


def written(write: Callable[[Path], object], name: str) -> bytes:
    """What a function writes into a file."""
    with tempfile.TemporaryDirectory() as place:
        path = Path(place) / name
        write(path)
        return path.read_bytes()


def _is_file(name: str) -> bool:
    return name.endswith(".toml") or "/" in name or "\\" in name


COMPUTED = "computed"  # stands in the place of a coefficient or a table
TABLE = "tread-friction.csv"
_PRESSURES = 3
_PER_DECADE = 8  # velocities
_MARGIN = 1.01  # by which the table reaches beyond what the wheel needs
_OF_THE_ROAD = ("surface", "heat", "adhesion", "numerics")
_REPLACED = ("pressure", "load", "depth", "velocity")  # of its contact


def compute_on_road(
    wheel: Content,
    road: Content,
    folder: Folder,
    progress: Callable[[int, int], None],
) -> Done:
    """Computes a slip curve whose friction is "computed".

    Args:
        wheel: the scene of the slip curve.
        road: the scene of the friction screen, of which rubber, temperature, pressure
            and velocity are replaced.
        folder: where the table of friction is kept.
        progress: called with the parts done and all of them; may raise to stop.

    Returns:
        The slip curve, as of a scene that names the table.

    Raises:
        InputError: beginning with "[surface]" for the road, else with the key of the
            slip curve.
    """
    scene = _scene_of_friction(wheel, road, folder)
    try:
        table = compute("friction", scene, folder, progress)
    except InputError as error:
        if not error.argument.startswith(("[surface]", "material")):
            error.inside("", "friction")
        raise
    folder.keep(TABLE, table.csv(), anew=True)
    computation = compute("traction", wheel | {"friction": TABLE}, folder)
    computation.asked = wheel | {"road": of_the_road(road)}
    computation.warnings = (
        *(f"Friction of the tread: {warning}" for warning in table.warnings),
        *computation.warnings,
    )
    pressures, span = scene["contact"]["pressure"], scene["contact"]["velocity"]
    computation.more = (
        "friction of the tread computed on the road of the road screen, at "
        f"{pressures[0]} to {pressures[-1]}, {span['from']} to {span['to']}"
    )
    return computation


def _scene_of_friction(wheel: Content, road: Content, folder: Folder) -> Content:
    """The friction screen's scene with the rubber of the wheel, at its temperatures,
    pressures and velocities.
    """
    pressure, velocity = _needed(wheel, folder)
    low, high = pressure.min() / _MARGIN, pressure.max() * _MARGIN
    slow, fast = velocity.min() / _MARGIN, velocity.max() * _MARGIN
    taken = of_the_road(road)
    taken["contact"]["pressure"] = [
        f"{each / 1e6:.5g} MPa" for each in np.geomspace(low, high, _PRESSURES)
    ]
    points = 2 + math.ceil(_PER_DECADE * math.log10(fast / slow))
    taken["contact"]["velocity"] = {
        "from": f"{slow:.5g} m/s",
        "to": f"{fast:.5g} m/s",
        "points": points,
    }
    return taken | {
        key: wheel[key] for key in ("material", "temperature") if key in wheel
    }


def of_the_road(road: Content) -> Content:
    """What a slip curve whose friction is computed takes of the friction screen."""
    contact = {
        key: value for key, value in road["contact"].items() if key not in _REPLACED
    }
    taken = {key: road[key] for key in _OF_THE_ROAD if key in road}
    return without_empty(taken) | {"contact": contact}


def _needed(wheel: Content, folder: Folder) -> tuple[np.ndarray, np.ndarray]:
    """Mean pressures of the contact [Pa] and sliding velocities [m/s] of a wheel."""
    content = wheel | {"friction": 1.0}
    scene: Any = decoded("traction", content)
    folder.check(files_of(content))
    arguments = scene.arguments(folder.path)
    way = "slip" if "slip" in arguments else "creepage"
    sliding = np.abs(np.asarray(arguments[way]) * arguments["velocity"])
    if not (sliding > 0).all():
        raise InputError(
            argument=f"[contact] {way}",
            got=0.0,
            accepted="other than zero where friction is computed",
            hint="nothing slides",
        )
    # The normal contact does not depend on slip: any one serves.
    once = em.traction(**arguments | {way: 0.5})
    width = once.contact.leading + once.contact.trailing
    return np.asarray(once.normal_force / (width * scene.indenter.length)), sliding
