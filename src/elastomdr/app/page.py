"""The page: one screen per stage."""

from pathlib import Path

from nicegui import ui

from .computed import COMPARE, FRICTION, ROLLING, ComputedStage
from .export import ExportStage
from .road import RoadStage
from .rubber import RubberStage
from .session import Session, Sessions

_STAGES = ("Rubber", "Road", "Friction", "Compare", "Rolling", "Export")
_STYLE = Path(__file__).parent / "style.css"


def page(sessions: Sessions) -> "Page":
    """Builds the page of the session that its address names, or of a new one."""
    request = ui.context.client.request
    session = sessions.get(
        request.query_params.get("session") if request is not None else None
    )
    session.shown_by(ui.context.client)
    ui.add_css(_STYLE.read_text(encoding="utf-8"))
    ui.colors(primary="#1f5a94")
    ui.run_javascript(f"history.replaceState(null, '', '?session={session.name}')")
    return Page(session)


class Page:
    """The screens, and what a change on one of them means for the others."""

    def __init__(self, session: Session):
        self._session = session
        with ui.element("header").classes("head"):
            ui.label("elastomdr").classes("brand").props("role=heading aria-level=1")
            with (
                ui.tabs()
                .props("dense no-caps align=left outside-arrows mobile-arrows")
                .classes("tabs") as self._tabs
            ):
                for stage in _STAGES:
                    ui.tab(stage)
        with ui.tab_panels(
            self._tabs, value=_STAGES[0], animated=False, keep_alive=True
        ).classes("panels"):
            with ui.tab_panel("Rubber"):
                self.rubber = RubberStage(session, self._new_rubber)
            with ui.tab_panel("Road"):
                self.road = RoadStage(session)
            with ui.tab_panel("Friction"):
                self.friction = ComputedStage(
                    session, FRICTION, self._computed, self._on_road
                )
            with ui.tab_panel("Compare"):
                self.compare = ComputedStage(
                    session, COMPARE, self._computed, self._on_road
                )
            with ui.tab_panel("Rolling"):
                self.rolling = ComputedStage(
                    session, ROLLING, self._computed, self._on_road
                )
            with ui.tab_panel("Export"):
                self.export = ExportStage(session)
        self._tabs.on_value_change(self._look)

    def _look(self) -> None:
        for stage in (self.friction, self.compare, self.rolling):
            stage.look()

    def _new_rubber(self, name: str) -> None:
        """A fitted or dropped material is the one that the other screens take."""
        scenes = self._session.scenes
        for key in scenes.keys() - {"compare"}:
            scenes[key]["material"] = name
        compared = scenes["compare"]["material"]
        scenes["compare"]["material"] = [
            name,
            *(other for other in compared if other != name),
        ]
        for stage in (self.friction, self.compare, self.rolling):
            stage.refresh()

    def _on_road(self, message: str) -> bool:
        """Shows what is wrong with the road where the road is filled in."""
        found = self.road.form.show_error(message)
        if found:
            self._tabs.value = "Road"
        return bool(found)

    def _computed(self) -> None:
        self.export.refresh()
