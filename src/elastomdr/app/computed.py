"""A screen that computes a scene: a form on the left, what has been computed on the
right, and sliders of the friction screen.
"""

import asyncio
import copy
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from nicegui import background_tasks, ui
from nicegui.events import ValueChangeEventArguments

import elastomdr as em

from ..checks import significant
from ..cli.fit import calibrated
from ..cli.schema import Content
from ..cli.units import Length, Pressure, SceneQuantity, Temperature
from ..errors import InputError, quiet
from ..results.axes import place_in_words
from ..results.curve import Ranking
from ..results.doubts import Kind as DoubtKind
from ..results.doubts import where
from ..results.plot_curves import SAME_TEMPERATURE, grouped
from ..results.words import in_words
from .cards import Cards
from .form import TableForm
from .scene import (
    COMPUTED,
    CancelledError,
    Done,
    compute,
    compute_on_road,
    of_the_road,
)
from .screens import Kind, Screen, preset
from .session import COMPUTING, DRAWING, Session
from .stage import (
    BUTTON,
    Busy,
    Latest,
    Notes,
    Picture,
    Slider,
    Words,
    drop,
    length,
    mark_of_age,
    material_names,
    sample,
    worked,
)
from .words import path_of, spoken, with_signs

# processor seconds up to which curves follow a slider, and from which they do so with
# fewer points and without draws until it rests
_FAST, _COARSE = 2.0, 0.15
_FEW = 8  # velocities of a curve that follows
_REST = 0.3  # seconds after which a slider rests
_CALIBRATED = ("q_high", "shear")
_MOST_CURVES = 8  # temperatures up to which those of dropped measurements are added


_SURE = {
    True: "significant",
    False: "not significant",
    None: "not known whether significant",
}


class ComputedStage:
    """A screen with a form, a button and what has been computed."""

    def __init__(
        self,
        session: Session,
        screen: Screen,
        changed: Callable[[], None],
        elsewhere: Callable[[InputError], bool],
    ):
        self._session, self._screen, self._changed, self._elsewhere = (
            session,
            screen,
            changed,
            elsewhere,
        )
        self._follow = Latest(self._computed_roughly)
        self._moves = 0  # of sliders
        self._refining = False  # whether what follows a slider that rests is computed
        self._key = session.kinds.get(screen.key, next(iter(screen.kinds)))
        self._seconds = 0.0  # of processor time, of the last computation
        with ui.element("div").classes("stage"):
            with ui.element("div").classes("left"):
                ui.label(screen.lead).classes("lead")
                if screen.key == "friction":
                    offered = "Use sample measurement", self._sample
                    drop(
                        session,
                        "Measured friction, drawn over the curve",
                        self._dropped,
                        offered,
                    )
                if len(screen.kinds) > 1:
                    labels = {key: kind.label for key, kind in screen.kinds.items()}
                    ui.select(
                        labels, value=self._key, label="What is computed"
                    ).classes("field").on_value_change(self._other_kind)
                self._place = ui.element("div")
                self._draw_form()
                with ui.element("div").classes("buttons"):
                    self._button = ui.button(
                        screen.button, on_click=self.compute
                    ).props(BUTTON)
                    if screen.key == "friction":
                        ui.button(
                            "Calibrate to measured friction", on_click=self.calibrate
                        ).props(f"{BUTTON} outline")
                self._busy = Busy()
            with ui.element("div").classes("right"):
                self._old = mark_of_age()
                self._unfitted = ui.label().classes("alert").props("role=alert")
                self._cards = Cards()
                self._sliders = (
                    Sliders(session.scenes["friction"], self._slid)
                    if screen.key == "friction"
                    else None
                )
                self._notes = Notes()
                self._picture = Picture(
                    f"{screen.key}: the computed curves", screen.key
                )
                self._table = ui.element("div")
                self._words = Words()
        self.look()
        ui.timer(0.05, self.show_again, once=True)

    @property
    def _kind(self) -> Kind:
        """The kind of scene that is filled in."""
        return self._screen.kinds[self._key]

    def content(self) -> Content:
        """The scene as it is filled in."""
        scene = self._session.scenes[self._key]
        if self._key != "compare":
            return scene
        common = {
            k: v
            for k, v in self._session.scenes["friction"].items()
            if k not in ("measured", "temperature")
        }
        return {**common, **scene}

    def refresh(self) -> None:
        """Offers materials and files that have come meanwhile, and shows what others
        have changed.
        """
        self._draw_form()
        self.look()

    def look(self) -> None:
        """Says so where a result is shown that is not of what is filled in, here or on
        other screens, and where a dropped rubber is not the one that is taken.
        """
        self._old.visible = self._picture.shown and self._done() is None
        files = self._session.unfitted()
        self._unfitted.visible = bool(files)
        taken = self.content().get("material", "none")
        names = taken if isinstance(taken, list) else [taken]
        self._unfitted.text = (
            f"{', '.join(files)} is not fitted as it is filled in on the screen "
            "Rubber. "
            f"Here the rubber is {', '.join(n.removesuffix('.toml') for n in names)}."
        )

    def _draw_form(self) -> None:
        kind, session = self._kind, self._session

        def rubbers() -> dict[str, str]:
            return material_names(session)

        files = session.folder.measurements
        choices: Mapping[str, Any] = {
            "material": rubbers,
            "other": rubbers,
            "measured": files,
            "[indenter] file": files,
            "[surface] file": files,
            "[leak] profile": files,
        }
        self._place.clear()
        with self._place:
            if self._key not in session.scenes:
                session.scenes[self._key] = preset(
                    self._key, session.scenes["friction"]["material"]
                )
            if kind.about:
                ui.label(kind.about).classes("about")
            on_road = session.scenes[self._key].get("friction") == COMPUTED
            box: Any = None
            if self._key == "traction":
                box = ui.checkbox("Friction on the road of the road screen")
                box.set_value(on_road)
                box.on_value_change(self._on_road)
            hidden = {"title", *(("friction",) if on_road else ())}
            only = kind.only or tuple(
                key for key in kind.table.__struct_fields__ if key not in hidden
            )
            self.form = TableForm(
                kind.table,
                session.scenes[self._key],
                only=only,
                first=kind.first,
                choices=choices,
                entered=self.compute,
                changed=lambda name: self.look(),
            )
            if on_road:
                self.form.widgets["friction"] = box  # errors name it

    def _on_road(self, event: ValueChangeEventArguments) -> None:
        """Takes the friction of a wheel from the road screen, or asks for it."""
        scene = self._session.scenes[self._key]
        scene.pop("friction", None)
        if event.value:
            scene["friction"] = COMPUTED
        self._draw_form()
        self.look()

    async def _other_kind(self, event: ValueChangeEventArguments) -> None:
        self._busy.stop()
        self._clear()
        self._key = event.value
        self._session.kinds[self._screen.key] = event.value
        self._draw_form()
        await self.show_again()

    async def _sample(self) -> None:
        await self._dropped([sample(self._session, "friction.csv")])

    async def _dropped(self, names: list[str]) -> None:
        scene = self._session.scenes[self._key]
        scene["measured"] = names[0]
        scene["temperature"] = await worked(
            COMPUTING, _with_measured, scene, self._session.folder.path / names[0]
        )
        self._draw_form()
        await self.compute()

    def _done(self) -> Done | None:
        """What has been computed of what is filled in."""
        session, asked = self._session, self.content()
        if asked.get("friction") == COMPUTED:
            asked = asked | {"road": of_the_road(session.scenes["friction"])}
        computation = session.done.get(self._screen.key)
        if computation is None or not computation.belongs_to(asked, session.folder):
            return None
        return computation

    async def show_again(self) -> None:
        """Shows what has been computed before of what is filled in."""
        if (computation := self._done()) is not None:
            await self._show(computation)

    def _clear(self) -> None:
        """Takes away what has been computed of something else."""
        self._old.visible = False
        self._cards.show(None)
        if self._sliders is not None:
            self._sliders.read(None)
        self._notes.show(())
        self._picture.show(None)
        self._table.clear()
        self._words.show("")

    def _slid(self, name: str, typed: str) -> None:
        """Takes the value of a slider, and computes anew where that is fast."""
        table, _, key = name.rpartition(" ")
        if table == "[surface]":
            self._session.scenes["friction"]["surface"][key] = typed
            self.look()
        else:
            self.form.set(name, typed)
        if self._picture.shown and self._seconds < _FAST:
            background_tasks.create(self._followed(), name="follow a slider")

    async def _followed(self) -> None:
        """Computes few points at once, and all of them when the slider rests."""
        self._moves += 1
        move = self._moves
        while self._refining:
            self._busy.stop()
            await asyncio.sleep(0.01)
        await self._follow()
        if self._seconds > _COARSE:
            await asyncio.sleep(_REST)
            if move == self._moves:
                self._refining = True
                await self.compute(quiet=True)
                self._refining = False

    async def _computed_roughly(self) -> None:
        """Curves of few points, shown but not kept; all of them where that is fast."""
        if self._seconds <= _COARSE:
            return await self.compute(quiet=True)
        if self._busy.on:
            return
        try:
            computation = await self._busy.during(
                COMPUTING, self._computed_as_asked, roughly(self.content()), quiet=True
            )
            figure = await worked(DRAWING, computation.figure)
        except (InputError, CancelledError):
            return  # what is computed when the slider rests says what is wrong
        self._old.visible = False
        self._cards.show(computation, judged=False)
        self._picture.show(figure)
        if self._sliders is not None:
            self._sliders.read(computation)

    async def compute(self, quiet: bool = False) -> None:
        """Computes the scene, or says beside a field what is wrong with it; `quiet`
        leaves what is shown until there is something else to show.
        """
        if self._busy.on:
            return
        self._session.touch()
        self.form.clear_errors()
        if not quiet:
            self._clear()
            self._button.disable()
        try:
            content = copy.deepcopy(self.content())
            computation = await self._busy.during(
                COMPUTING, self._computed, content, kind=self._key, quiet=quiet
            )
            self._session.done[self._screen.key] = computation
            self._changed()
            await self._show(computation, quiet)
        except InputError as error:
            self._clear()
            self._refuse(error)
        except CancelledError:
            return
        finally:
            self._button.enable()

    def _refuse(self, error: InputError) -> None:
        """Says what is wrong beside its field, here or on the screen that lends it."""
        borrows = self._key in ("friction", "compare", "traction")
        here = self.form.field(error.argument) or not borrows
        if here or not self._elsewhere(error):
            self.form.show_error(error)

    async def calibrate(self) -> None:
        """Finds cutoff and shear law from the measured friction, and computes with
        them.
        """
        if self._busy.on:
            return
        self._session.touch()
        self.form.clear_errors()
        content, folder = copy.deepcopy(self.content()), self._session.folder.path
        try:
            found = await self._busy.during(
                COMPUTING, calibrated, content, folder, _CALIBRATED, kind="calibrate"
            )
        except InputError as error:
            self._refuse(error)
            return
        except CancelledError:
            return
        self._session.calibrated = found
        scene = self._session.scenes["friction"]
        keys = found.content.keys() & {"surface", "adhesion", "doubts"}
        scene |= {key: found.content[key] for key in keys}
        self._draw_form()
        await self.compute()
        self._notes.show(
            [
                f"{name.capitalize()}: {spoken(words)}"
                for name, words in found.lines().items()
            ]
        )

    def _computed(self, content: Content) -> Done:
        start = time.thread_time()
        computation = self._computed_as_asked(content)
        self._seconds = computation.seconds = time.thread_time() - start
        return computation

    def _computed_as_asked(self, content: Content) -> Done:
        folder, progress = self._session.folder, self._busy.progress
        if self._key != "traction":
            return compute(self._kind.verb, content, folder, progress)
        if content.get("friction") != COMPUTED:
            return compute("traction", content, folder)
        return compute_on_road(
            content, copy.deepcopy(self._session.scenes["friction"]), folder, progress
        )

    async def _show(self, computation: Done, quiet: bool = False) -> None:
        key = self._key
        figure = await worked(DRAWING, computation.figure)
        if key != self._key:
            return
        self._cards.show(computation)
        warned = computation.warnings
        doubts = (
            f"{doubt.kind.capitalize()}: {doubt.words()}."
            for doubt in computation.curve.doubts
            if not any(doubt.says in warning for warning in warned)
        )
        self._notes.show([*warned, *map(spoken, doubts)])
        summary = "\n".join(
            filter(None, (computation.result.summary(), computation.more))
        )
        self._words.show(spoken(summary))
        if self._screen.key == "compare":
            self._rank(computation.result)
        self._picture.show(figure)
        if self._sliders is not None:
            if not quiet:  # else it is at the next value already
                self._sliders.look()
            self._sliders.read(computation)
        self.look()

    def _rank(self, ranking: Ranking) -> None:
        """The rubbers, the one with most friction first, with what is significant of
        the order.
        """
        self._table.clear()
        rows = []
        for place in ranking.places:
            spread = (
                "not known"
                if np.isnan(place.uncertainty)
                else f"± {place.uncertainty:.2g}"
            )
            ahead = (
                ""
                if np.isnan(place.ahead)
                else f"{place.ahead:.2g}, {_SURE[place.significant]}"
            )
            rows.append(
                {
                    "rubber": place.material,
                    "friction": f"{place.mu:.3f}",
                    "uncertainty": spread,
                    "lead": ahead,
                    "doubts": ", ".join(dict.fromkeys(d.kind for d in place.doubts)),
                }
            )
        with self._table.classes("scroll"):
            columns = [
                {"name": name, "label": name, "field": name, "align": "left"}
                for name in rows[0]
            ]
            ui.table(rows=rows, columns=columns)


def roughly(content: Content) -> Content:
    """A scene with few velocities and without draws."""
    content = copy.deepcopy(content)
    content.pop("uncertainty", None)
    velocity = content["contact"].get("velocity")
    if isinstance(velocity, dict):
        velocity["points"] = min(velocity["points"], _FEW)
    return content


def _with_measured(content: Content, path: Path) -> Any:
    """The temperatures of a scene and, where they are few, those of measured points
    which have no curve.
    """
    given = content.get("temperature")
    texts = given if isinstance(given, list) else [given]
    try:
        with quiet(em.fit.FitWarning):
            measured = em.read_friction(path).points.get("temperature")
        computed = [float(Temperature.read(entry)) for entry in texts]
    except InputError:
        return given  # computing says what is wrong
    if measured is None:
        return given
    missing = [
        each
        for each in grouped(measured)
        if all(abs(each - one) > SAME_TEMPERATURE for one in computed)
    ]
    if not missing or len(computed) + len(missing) > _MOST_CURVES:
        return given
    every = {
        **dict(zip(computed, texts, strict=True)),
        **{each: f"{each - 273.15:.4g} degC" for each in missing},
    }
    return [every[each] for each in sorted(every)]


# Sliders of the friction screen: cutoffs, pressure and temperature move the curves, and
# the velocity is where these are read.

_VELOCITIES = (1e-7, 100.0)  # [m/s]
# doubts that are said of a reading; what has no bound is said in place of one
_SAID: tuple[DoubtKind, ...] = ("extrapolated", "hot branch", "bound", "estimate")


class Sliders:
    """The sliders of a scene of friction.

    `moved` is called with the field and the text that stands for its new value, such as
    "[contact] pressure" and "0.3 MPa".
    """

    def __init__(self, content: Content, moved: Callable[[str, str], Any]):
        self._content = content
        self._done: Done | None = None
        with ui.element("div").classes("sliders"):
            self._of = {
                field: Slider(
                    label,
                    limits,
                    lambda value, typed=typed: with_signs(typed(value)),
                    lambda value, name=field, typed=typed: moved(name, typed(value)),
                    logarithmic=quantity is not Temperature,
                )
                for field, (label, limits, quantity, typed) in _MOVED.items()
            }
            self._velocity = Slider(
                "Read at velocity", _VELOCITIES, _velocity, self._read
            )
        self._values = ui.label().classes("about")
        self.look()

    def look(self) -> None:
        """Shows the values of the scene, of several the first; of waves only where a
        surface is cut at them.
        """
        for field, slider in self._of.items():
            *tables, key = path_of(field)
            place = self._content
            for table in tables:
                place = place.get(table, {})
            cut = place.get("shape", "spectrum") in ("self_affine", "spectrum")
            cut = cut and not (key == "shortest" and "cutoff" in place)
            _place(slider, _MOVED[field][2], place.get(key) if cut else None)

    def read(self, computation: Done | None) -> None:
        """Reads the curves of a result where the velocity's slider is."""
        first = self._done is None
        self._done = computation
        self._values.visible = computation is not None
        if computation is None:
            return
        velocity = np.unique(np.asarray(computation.shown.velocity))
        low, high = float(velocity[0]), float(velocity[-1])
        middle = float(np.sqrt(low * high))
        inside = float(np.clip(self._velocity.value, low, high))
        read_at = middle if first else inside
        if low < high:
            self._velocity.set(read_at, (low, high))
        self._velocity.show(low < high)
        self._read(read_at)

    def _read(self, velocity: float) -> None:
        if self._done is None:
            return
        readings = "; ".join(_readings(self._done.shown, velocity))
        self._values.text = with_signs(f"At {_velocity(velocity)}: {readings}")


def _readings(result: em.FrictionCurve, velocity: float) -> Iterator[str]:
    """Friction of each curve at a velocity, of each point where that is the only one."""
    axis, curves = result.curves()
    bound = np.nan if result.model_error is None else result.model_error
    found: Content = {kind: where(result.doubts, kind) for kind in _SAID}
    marks = {kind: points for kind, points in found.items() if points is not None}
    fields = np.broadcast_arrays(
        result.velocity, result.mu, result.error + bound, *marks.values()
    )
    for curve in curves:
        x, *rows = (np.atleast_1d(each[curve.place]) for each in fields)
        if np.ptp(x) > 0:
            values = [float(np.interp(np.log(velocity), np.log(x), y)) for y in rows]
            yield _reading(curve.label, values, marks)
            continue
        for i in range(x.size):
            place = place_in_words(axis, i) if x.size > 1 else ""
            name = ", ".join(filter(None, (curve.label, place)))
            yield _reading(name, [float(y[i]) for y in rows], marks)


def _reading(name: str, values: Sequence[float], marks: Iterable[str]) -> str:
    """Friction, its uncertainty, and how far each kind of doubt holds there."""
    mu, half, *shares = values
    name = f"{name}: " if name else ""
    if np.isnan(mu):
        return f"{name}did not converge"
    known = np.isfinite(half)
    spread = f"± {significant(half, 2)}" if known else "without a bound of the model"
    doubted = (f", {kind}" for kind, share in zip(marks, shares, strict=True) if share)
    return f"{name}µ = {significant(mu, 3)} {spread}{''.join(doubted)}"


def _place(slider: Slider, quantity: type[SceneQuantity], value: Any) -> None:
    """Puts a slider where a value is, and hides it where there is none to read."""
    try:
        slider.set(float(quantity.read(value[0] if isinstance(value, list) else value)))
    except InputError:
        slider.show(False)  # the field says what is wrong
    else:
        slider.show(True)


def _pressure(pascal: float) -> str:
    return f"{pascal / 1e6:.3g} MPa"


def _celsius(temperature: float) -> str:
    return f"{round(temperature - 273.15, 1) + 0.0:g} degC"


def _velocity(velocity: float) -> str:
    return in_words("velocity", float(significant(velocity, 3)))


# by field: what is moved, between which values, what it measures, how it is typed
_MOVED = {
    "[surface] longest": (
        "Longest wavelength of the road",
        (1e-4, 0.1),
        Length,
        length,
    ),
    "[surface] shortest": (
        "Shortest wavelength of the road",
        (1e-7, 2e-3),
        Length,
        length,
    ),
    "[contact] pressure": ("Nominal pressure", (0.01e6, 10e6), Pressure, _pressure),
    "temperature": ("Rubber temperature", (233.15, 393.15), Temperature, _celsius),
}
