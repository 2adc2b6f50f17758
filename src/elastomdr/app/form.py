"""A form made from the tables of scene files: each key is a field with its name in words,
its default and an example; and what is typed into it as the value of a scene, and back.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias

from nicegui import ui

from ..cli import typed
from ..cli.schema import Content, Key, Table, about, keys_of
from ..errors import InputError
from . import words


def to_text(value: object) -> str:
    """A value of a scene file as the page writes it."""
    return words.with_signs(typed.to_text(value))


def from_text(key: Key, entry: str | None, unit: str = "") -> Any:
    """The value of a scene file that a text on the page stands for."""
    return typed.from_text(key, words.without_signs(entry or ""), unit)


Choices: TypeAlias = Mapping[str, Callable[[], Mapping[str, str] | Sequence[str]]]


class TableForm:
    """Fields for the keys of a table; what is typed goes into `content`, which is what
    a scene file holds.

    Args:
        table: the type of the table.
        content: what the fields show and change.
        only: the keys of the table that are shown, in this order; by default all.
        first: keys of inner tables that are not put away under "more".
        choices: by the name of a field, such as "material" or "[surface] file", what
            there is to choose from.
        changed: called after each change with the name of the field.
        entered: called when Enter is pressed in a field.
        left: called when a field that is typed into loses the focus.
    """

    def __init__(
        self,
        table: type[Table],
        content: Content,
        *,
        only: Sequence[str] = (),
        first: Sequence[str] = (),
        choices: Choices | None = None,
        changed: Callable[[str], object] = lambda name: None,
        entered: Callable[[], Any] | None = None,
        left: Callable[[], Any] | None = None,
    ):
        self.table, self.content = table, content
        self.only, self.first = only, set(first)
        self.choices, self.changed = dict(choices or {}), changed
        self._called = {"keydown.enter": entered, "blur": left}
        self.widgets: dict[str, Any] = {}
        self._folded: dict[str, list[ui.expansion]] = {}  # field to what hides it
        self._place = ui.element("div").classes("form")
        self._alert = ui.label().classes("alert").props("role=alert")
        self._alert.visible = False
        self.draw()

    def draw(self) -> None:
        """Makes the fields anew from the content."""
        self.widgets, self._folded = {}, {}
        self._place.clear()
        keys = keys_of(self.table)
        shown = [keys[key] for key in self.only or keys if key in keys]
        with self._place:
            self._keys(shown, (), self.content)

    def set(self, name: str, value: Any) -> None:
        """Gives a field a value as if it had been typed."""
        self.widgets[name].value = value if isinstance(value, bool) else to_text(value)

    def clear_errors(self) -> None:
        """Takes all messages away."""
        self._alert.visible = False
        for widget in self.widgets.values():
            _mark(widget, None)

    def show_error(self, error: InputError) -> str:
        """Puts an error beside the field that it names; returns the field's name,
        empty where there is none here.
        """
        self.clear_errors()
        name = self.field(error.argument)
        message = words.in_words(error, name)
        shown: Any = self.widgets.get(name)
        for fold in self._folded.get(name, ()):
            fold.open()
        if hasattr(shown, "error"):
            _mark(shown, message)
            shown.run_method("focus")
        else:
            shown, self._alert.text, self._alert.visible = self._alert, message, True
        shown.client.run_javascript(f"elastomdr.look({shown.id})")
        return name

    def field(self, argument: str) -> str:
        """The field of an argument, or of one of its entries."""
        ends = f"{argument}["
        return next((n for n in self.widgets if ends.startswith(f"{n}[")), "")

    def _keys(
        self, keys: Sequence[Key], path: tuple[str, ...], content: Content
    ) -> None:
        """The fields of one table; those that are seldom needed are folded away. A key
        that scenes of this kind must leave out has none, nor has a list of tables.
        """
        at_once, rest = [], []
        for key in keys:
            name = _name((*path, key.name))
            if not key.kinds or (key.listed and key.tables):
                continue
            if key.required or content.get(key.name) or name in self.first:
                at_once.append(key)
            elif name not in words.ELSEWHERE:
                rest.append(key)
        with ui.element("div").classes("fields"):
            for key in at_once:
                self._key(key, path, content)
        if not rest:
            return
        before = set(self.widgets)
        with (
            ui.expansion("More").classes("more").props("dense") as fold,
            ui.element("div").classes("fields"),
        ):
            for key in rest:
                self._key(key, path, content)
        for name in self.widgets.keys() - before:
            self._folded.setdefault(name, []).append(fold)

    def _key(self, key: Key, path: tuple[str, ...], content: Content) -> None:
        path = (*path, key.name)
        if not key.tables:
            return self._leaf(key, path, content)
        with ui.element("fieldset").classes("group"):
            if len(key.tables) > 1:
                return self._union(key, path, content)
            self._table(key, path, content)

    def _table(self, key: Key, path: tuple[str, ...], content: Content) -> None:
        """A table within the table; one that may be left out has a box to tick."""
        (table,), name, title = key.tables, key.name, words.title(path)
        box = None
        if key.default is None:
            box = ui.checkbox(title, value=name in content)
            self.widgets[_name(path)] = box
        else:
            _legend(title)
        place = ui.element("div")

        def draw() -> None:
            place.clear()
            if box is None or box.value:
                if content.get(name) is None:
                    content[name] = {}
                with place:
                    self._keys([*keys_of(table).values()], path, content[name])

        def ticked() -> None:
            content.pop(name, None)
            self._forget(path)
            draw()
            self.changed(name)

        if box is not None:
            box.on_value_change(ticked)
        draw()

    def _union(self, key: Key, path: tuple[str, ...], content: Content) -> None:
        """A table of several kinds, of which one is chosen."""
        by_word = {str(t.__struct_config__.tag): t for t in key.tables}
        tag = str(key.tables[0].__struct_config__.tag_field)
        inner = content.setdefault(key.name, {})
        inner.setdefault(tag, next(iter(by_word)))
        name = _name((*path, tag))
        _legend(words.title(path))
        select = ui.select(
            {word: word.replace("_", " ") for word in by_word},
            value=inner[tag],
            label=words.title((*path, tag)),
        ).classes("field")
        said = ui.label().classes("about")
        self.widgets[name] = select
        place = ui.element("div")

        def draw() -> None:
            place.clear()
            table = by_word[inner[tag]]
            said.text = about(table)
            with place:
                self._keys([*keys_of(table).values()], path, inner)

        def chosen() -> None:
            if select.value == inner.get(tag):
                return
            known = keys_of(by_word[select.value])
            kept = {k: value for k, value in inner.items() if k in known}
            inner.clear()
            inner.update({tag: select.value, **kept})
            self._forget(path, keep=name)
            draw()
            self.changed(name)

        select.on_value_change(chosen)
        draw()

    def _leaf(self, key: Key, path: tuple[str, ...], content: Content) -> None:
        name, value = _name(path), content.get(key.name)
        label = words.label(path, key.quantity) + (" *" if key.required else "")
        default = "automatic" if key.default is None else str(key.default)
        if name in self.choices:
            widget = self._choice(name, label, key, value)
        elif key.flag:
            widget = _flag(label, key, value)
        elif key.words:
            first = "choose" if key.required else words.NOTHING.get(key.name, default)
            options = {"": first, **words.choices(key.name, key.words)}
            widget = ui.select(options, value=value or "", label=label)
        else:
            example = _example(key)
            widget = ui.input(label, value=to_text(value), placeholder=example)
            for event, called in self._called.items():
                if called is not None:
                    widget.on(event, called)
        widget.classes("field")
        if not isinstance(widget, ui.checkbox):
            meaning = words.hint(path, key.meaning)
            if not key.required and key.default is not None:
                default = f"{default} where nothing is chosen"
                meaning = "; ".join(filter(None, (meaning, default)))
            widget.props["hint"] = meaning
            widget.props("hide-bottom-space" if not meaning else "")
        self.widgets[name] = widget

        def changed() -> None:
            new = self._value(widget, key, path)
            if new == content.get(key.name):
                return
            if new is None:
                content.pop(key.name, None)
            else:
                content[key.name] = new
            _mark(widget, None)
            self._alert.visible = False
            self.changed(name)

        widget.on_value_change(changed)

    def _choice(self, name: str, label: str, key: Key, value: Any) -> ui.select:
        """A field with what there is to choose from, one or several."""
        options = _as_options(self.choices[name]())
        several = key.several and (isinstance(value, list) or name in self.first)
        for each in value if isinstance(value, list) else [value]:
            if each:
                options.setdefault(each, each)
        widget = ui.select(
            options,
            value=([] if several else None) if value is None else value,
            label=label,
            multiple=several,
            clearable=not key.required,
        )
        return widget.props("use-chips" if several else "")

    def _value(self, widget: Any, key: Key, path: tuple[str, ...]) -> Any:
        value = widget.value
        if key.flag:
            answers = {"": None, "true": True, "false": False}
            return answers[value] if key.optional else value
        if _name(path) in self.choices or key.words:
            return value or None
        return from_text(key, value, words.unit(path, key.quantity))

    def _forget(self, path: tuple[str, ...], keep: str = "") -> None:
        """Drops the fields of a table that is drawn anew."""
        mark = f"[{'.'.join(path)}] "
        for name in [
            name for name in self.widgets if name.startswith(mark) and name != keep
        ]:
            del self.widgets[name]


def _name(path: tuple[str, ...]) -> str:
    """A key's place as the errors of scene files call it, such as "[contact] load"."""
    return f"[{'.'.join(path[:-1])}] {path[-1]}" if path[1:] else path[0]


def _example(key: Key) -> str:
    if key.quantity is None:
        return "1, 2, 3" if key.several and key.numeric else ""
    example = words.with_signs(key.quantity.example)
    if key.spread:
        return f"{example}, or A to B, 24 points"
    return f"{example}, or several" if key.several else example


def _as_options(choices: Mapping[str, str] | Sequence[str]) -> dict[str, str]:
    return (
        dict(choices)
        if isinstance(choices, Mapping)
        else {name: name for name in choices}
    )


def _flag(label: str, key: Key, value: Any) -> ui.checkbox | ui.select:
    """A box to tick; of three answers where the default is one of its own."""
    if not key.optional:
        shown = key.default if value is None else value
        return ui.checkbox(label.removesuffix(" *"), value=shown)
    options = {"": "automatic", "true": "yes", "false": "no"}
    chosen = "" if value is None else str(value).lower()
    return ui.select(options, value=chosen, label=label)


def _legend(title: str) -> None:
    with ui.element("legend"):
        ui.label(title)


def _mark(widget: Any, message: str | None) -> None:
    if hasattr(widget, "error"):
        widget.error = message
