"""A form made from the tables of scene files: each key is a field with its name in words,
its default and an example; and what is typed into it as the value of a scene, and back.
"""

import re
import types
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

import msgspec
from nicegui import ui

from ..cli.schema import Several, Sweep, accepted, is_list, keys_of, tables_of
from ..cli.units import SceneQuantity
from . import words

_SPAN = re.compile(r"(.+?)\s+to\s+(.+?)\s*[,;]\s*(\d+)(?:\s*points?)?", re.IGNORECASE)
_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
# The number is taken whole (possessive): "0.3" is no 0 with the unit ".3".
_UNIT = re.compile(rf"(?>{_NUMBER.pattern})\s*((?:1/)?[^\d\s].*)")


class Leaf(NamedTuple):
    """What a key that is no table accepts."""

    kinds: tuple[Any, ...]  # the types, without None
    optional: bool

    @property
    def words(self) -> tuple[str, ...]:
        """The words that it accepts, where they are listed."""
        return tuple(
            word
            for kind in self.kinds
            if get_origin(kind) is Literal
            for word in get_args(kind)
        )

    @property
    def flag(self) -> bool:
        """Whether it is true or false."""
        return self.kinds == (bool,)

    @property
    def several(self) -> bool:
        """Whether it accepts a list."""
        return any(get_origin(kind) in (list, Several, Sweep) for kind in self.kinds)

    @property
    def spread(self) -> bool:
        """Whether it accepts values from one to another."""
        return any(get_origin(kind) is Sweep for kind in self.kinds)

    @property
    def numeric(self) -> bool:
        """Whether it accepts bare numbers."""
        return any(kind in (int, float) for kind in self._innermost())

    @property
    def quantity(self) -> type[SceneQuantity] | None:
        """What it measures, None for a number or a text."""
        return next(
            (
                k
                for k in self._innermost()
                if isinstance(k, type) and issubclass(k, SceneQuantity)
            ),
            None,
        )

    @property
    def accepted(self) -> str:
        """What it accepts, in words."""
        return " or ".join(accepted(kind) for kind in self.kinds)

    def _innermost(self) -> tuple[Any, ...]:
        return tuple(
            inner
            for kind in self.kinds
            for inner in (_parts(get_args(kind)[0]) if get_args(kind) else [kind])
        )


def leaf(kind: Any) -> Leaf:
    """What the type of a key accepts."""
    parts = _parts(kind)
    return Leaf(
        tuple(member for member in parts if member is not type(None)),
        type(None) in parts or None in parts,
    )


def to_text(value: Any) -> str:
    """A value of a scene file as it is typed."""
    if value is None:
        return ""
    if isinstance(value, dict):
        first, last = str(value["from"]), str(value["to"])
        same = _UNIT.fullmatch(first), _UNIT.fullmatch(last)
        if same[0] and same[1] and same[0][3] == same[1][3]:
            first = first.removesuffix(same[0][3]).rstrip()
        return words.with_signs(f"{first} to {last}, {value['points']} points")
    joined = ", ".join(map(str, value)) if isinstance(value, list) else str(value)
    return words.with_signs(joined)


def from_text(accepts: Leaf, typed: str | None, unit: str = "") -> Any:
    """The value of a scene file that a text stands for; None where the key is left out.
    Numbers without a unit have the field's `unit`, where it has one.

    What is no value of the kind is returned as it is, so that the scene's own message
    says what is accepted.
    """
    typed = (typed or "").strip()
    typed = words.without_signs(typed)
    if not typed:
        return None
    if accepts.spread and (match := _SPAN.fullmatch(typed)) is not None:
        first, last = _with_unit([match[1], match[2]], unit)
        return {"from": first, "to": last, "points": int(match[3])}
    parts = (
        [entry.strip() for entry in re.split(r";|,\s+", typed) if entry.strip()]
        if accepts.several
        else [typed]
    )
    numeric = accepts.numeric and accepts.quantity is None
    values = (
        [_number(entry) for entry in parts]
        if numeric
        else _with_unit(parts, unit)
        if accepts.quantity or unit
        else parts
    )
    one = len(values) == 1 and not all(
        get_origin(kind) is list for kind in accepts.kinds
    )
    return values[0] if one else values


def _parts(kind: Any) -> tuple[Any, ...]:
    """The members of a union, each without its notes."""
    if get_origin(kind) is Annotated:
        return _parts(get_args(kind)[0])
    if get_origin(kind) in (Union, types.UnionType):
        return tuple(inner for member in get_args(kind) for inner in _parts(member))
    return (kind,)


def _number(typed: str) -> Any:
    if _NUMBER.fullmatch(typed) is None:
        return typed
    return int(typed) if re.fullmatch(r"[-+]?\d{1,15}", typed) else float(typed)


def _with_unit(parts: list[str], unit: str = "") -> list[str]:
    """Numbers without a unit take that of the last one, "0, 20, 40 degC", or else that
    of the field.
    """
    match = _UNIT.fullmatch(parts[-1].strip())
    unit = unit if match is None else match[3]
    if not unit:
        return parts
    return [
        f"{entry} {unit}" if _NUMBER.fullmatch(entry.strip()) else entry
        for entry in parts
    ]


Choices = Mapping[str, Callable[[], Mapping[str, str] | Sequence[str]]]


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
        table: Any,
        content: dict[str, Any],
        *,
        only: Sequence[str] = (),
        first: Sequence[str] = (),
        choices: Choices | None = None,
        changed: Callable[[str], Any] | None = None,
        entered: Callable[[], Any] | None = None,
        left: Callable[[], Any] | None = None,
    ):
        self.left = left
        self.table, self.content, self.only, self.first = (
            table,
            content,
            only,
            set(first),
        )
        self.choices, self.changed, self.entered = dict(choices or {}), changed, entered
        self.widgets: dict[str, Any] = {}
        self._folded: dict[str, Any] = {}  # field to the expansion that hides it
        self._silent = False
        self._place = ui.element("div").classes("form")
        self._alert = ui.label().classes("alert").props("role=alert")
        self._alert.visible = False
        self._units: dict[str, str] = {}
        self.draw()

    def draw(self) -> None:
        """Makes the fields anew from the content."""
        self.widgets, self._folded = {}, {}
        self._place.clear()
        keys = keys_of(self.table)
        with self._place:
            self._keys(
                {key: keys[key] for key in self.only or keys if key in keys},
                (),
                self.content,
            )

    def set(self, name: str, value: Any) -> None:
        """Gives a field a value as if it had been typed."""
        self.widgets[name].value = value if isinstance(value, bool) else to_text(value)

    def refresh_choices(self) -> None:
        """Looks anew for what there is to choose from, such as files that have been
        dropped.
        """
        self._silent = True
        for name, choices in self.choices.items():
            if (widget := self.widgets.get(name)) is not None:
                options = _as_options(choices())
                kept = widget.value
                for value in kept if isinstance(kept, list) else [kept]:
                    if value:
                        options.setdefault(value, value)
                widget.set_options(options, value=kept)
        self._silent = False

    def clear_errors(self) -> None:
        """Takes all messages away."""
        self._alert.visible = False
        for widget in self.widgets.values():
            _mark(widget, None)

    def show_error(self, message: str) -> str:
        """Puts a message beside the field that it names; returns the field's name,
        empty where there is none here.
        """
        self.clear_errors()
        name = self._field(message)
        message = words.in_words(message, (name,) if name else ())
        if not hasattr(self.widgets.get(name), "error"):
            self._alert.text = message
            self._alert.visible = True
            return name
        _mark(self.widgets[name], message)
        if (fold := self._folded.get(name)) is not None:
            fold.open()
        self.widgets[name].run_method("focus")
        return name

    def _field(self, message: str) -> str:
        """The field that a message begins with, or that it names first."""
        for name in sorted(self.widgets, key=len, reverse=True):
            if re.match(rf"{re.escape(name)}(?!\w)", message):
                return name
        words, last = (
            re.findall(r"\w+", message),
            {name.split()[-1]: name for name in reversed(self.widgets)},
        )
        table = re.match(r"\[(\w+)\]", message)
        within = {
            key: name
            for key, name in last.items()
            if table is None or name.startswith(table[0])
        }
        if table is None:  # the argument of a call
            return last.get(words[0], "") if words else ""
        return next(
            (
                field_names[word]
                for field_names in (within, last)
                for word in words
                if word in field_names
            ),
            "",
        )

    def _keys(
        self, fields: Mapping[str, Any], path: tuple[str, ...], content: dict[str, Any]
    ) -> None:
        """The fields of one table; those that are seldom needed are folded away."""
        shown = [
            key
            for key, field in fields.items()
            if self._is_first(key, field, path, content)
        ]
        with ui.element("div").classes("fields"):
            for key in shown:
                self._key(key, fields[key], path, content)
        rest = [
            key
            for key in fields
            if key not in shown
            and not self._is_nothing(fields[key])
            and _name((*path, key)) not in words.ELSEWHERE
        ]
        if not rest:
            return
        before = set(self.widgets)
        with (
            ui.expansion("More").classes("more").props("dense") as fold,
            ui.element("div").classes("fields"),
        ):
            for key in rest:
                self._key(key, fields[key], path, content)
        for name in self.widgets.keys() - before:
            self._folded.setdefault(name, fold)

    def _is_first(
        self, key: str, field: Any, path: tuple[str, ...], content: dict[str, Any]
    ) -> Any:
        name = _name((*path, key))
        return not self._is_nothing(field) and (
            field.required or content.get(key) or name in self.first
        )

    def _is_nothing(self, field: Any) -> bool:
        """A key that scenes of this kind must leave out, or a list of tables, for which
        there are no forms.
        """
        return not leaf(field.type).kinds or (
            is_list(field.type) and bool(tables_of(field.type))
        )

    def _key(
        self, key: str, field: Any, path: tuple[str, ...], content: dict[str, Any]
    ) -> None:
        tables = list(tables_of(field.type))
        if not tables:
            return self._leaf(key, field, path, content)
        if len(tables) > 1:
            return self._union(key, field, tables, path, content)
        self._table(key, field, tables[0], path, content)

    def _table(
        self,
        key: str,
        field: Any,
        table: Any,
        path: tuple[str, ...],
        content: dict[str, Any],
    ) -> None:
        """A table within the table; one that may be left out has a box to tick."""
        with ui.element("fieldset").classes("group"):
            optional = field.default is None
            title = words.title((*path, key))
            if not optional:
                _legend(title)
            box = ui.checkbox(title, value=key in content) if optional else None
            place = ui.element("div")

            def draw() -> None:
                place.clear()
                if box is None or box.value:
                    inner = content.get(key) if optional or key in content else None
                    inner = content.setdefault(key, {}) if inner is None else inner
                    with place:
                        self._keys(keys_of(table), (*path, key), inner)

            def ticked() -> None:
                if not box.value:  # type: ignore[union-attr]
                    content.pop(key, None)
                self._forget((*path, key))
                draw()
                self._tell(key)

            if box is not None:
                self.widgets[_name((*path, key))] = box
                box.on_value_change(ticked)
            draw()

    def _union(
        self,
        key: str,
        field: Any,
        tables: Sequence[Any],
        path: tuple[str, ...],
        content: dict[str, Any],
    ) -> None:
        """A table of several kinds, of which one is chosen."""
        configs = [table.__struct_config__ for table in tables]
        tag = configs[0].tag_field
        by_word = {
            config.tag: table for config, table in zip(configs, tables, strict=True)
        }
        inner = content.setdefault(key, {})
        inner.setdefault(tag, next(iter(by_word)))
        name = _name((*path, key, tag))
        with ui.element("fieldset").classes("group"):
            _legend(words.title((*path, key)))
            kinds = {word: word.replace("_", " ") for word in by_word}
            select = ui.select(
                kinds, value=inner[tag], label=words.title((*path, key, tag))
            ).classes("field")
            about = ui.label().classes("about")
            self.widgets[name] = select
            place = ui.element("div")

            def draw() -> None:
                place.clear()
                about.text = (by_word[inner[tag]].__doc__ or "").split("\n")[0]
                with place:
                    self._keys(keys_of(by_word[inner[tag]]), (*path, key), inner)

            def chosen() -> None:
                if select.value == inner.get(tag):
                    return
                kept = {
                    k: v
                    for k, v in inner.items()
                    if k in keys_of(by_word[select.value])
                }
                inner.clear()
                inner.update({tag: select.value, **kept})
                self._forget((*path, key), keep=name)
                draw()
                self._tell(name)

            select.on_value_change(chosen)
            draw()

    def _leaf(
        self, key: str, field: Any, path: tuple[str, ...], content: dict[str, Any]
    ) -> None:
        accepts, name = leaf(field.type), _name((*path, key))
        label = words.label((*path, key), accepts.quantity) + (
            " *" if field.required else ""
        )
        value = content.get(key)
        meaning = words.hint((*path, key), _meaning(field.type))
        self._units[name] = words.unit((*path, key), accepts.quantity)
        if name in self.choices:
            widget = self._choice(name, label, field, accepts, value)
        elif accepts.flag:
            widget = _flag(label, field, accepts, value)
        elif accepts.words:
            first = "choose" if field.required else _default(field.default)
            options = {"": first, **words.choices(key, accepts.words)}
            widget = ui.select(options, value=value or "", label=label)
        else:
            widget = ui.input(
                label=label, value=to_text(value), placeholder=_example(accepts)
            )
            if self.entered is not None:
                widget.on("keydown.enter", self.entered)
            if self.left is not None:
                widget.on("blur", self.left)
        widget.classes("field")
        if not isinstance(widget, ui.checkbox):
            has_default = field.default not in (None, msgspec.NODEFAULT)
            if has_default:
                default = f"{_default(field.default)} where nothing is chosen"
                meaning = "; ".join(filter(None, (meaning, default)))
            widget.props["hint"] = meaning
            widget.props("hide-bottom-space" if not meaning else "")
        self.widgets[name] = widget

        def typed() -> None:
            if self._silent:
                return
            new = self._value(widget, accepts, name)
            if new == content.get(key):
                return
            if new is None:
                content.pop(key, None)
            else:
                content[key] = new
            _mark(widget, None)
            self._alert.visible = False
            self._tell(name)

        widget.on_value_change(typed)

    def _choice(
        self, name: str, label: str, field: Any, accepts: Leaf, value: Any
    ) -> Any:
        """A field with what there is to choose from, one or several."""
        options = _as_options(self.choices[name]())
        several = accepts.several and (isinstance(value, list) or name in self.first)
        for each in value if isinstance(value, list) else [value]:
            if each:
                options.setdefault(each, each)
        widget = ui.select(
            options,
            value=([] if several else None) if value is None else value,
            label=label,
            multiple=several,
            clearable=not field.required,
        )
        return widget.props("use-chips" if several else "")

    def _value(self, widget: Any, accepts: Leaf, name: str) -> Any:
        value = widget.value
        if accepts.flag:
            return (
                {"": None, "true": True, "false": False}[value]
                if accepts.optional
                else value
            )
        if name in self.choices or accepts.words:
            return value or None
        return from_text(accepts, value, self._units[name])

    def _forget(self, path: tuple[str, ...], keep: str = "") -> None:
        """Drops the fields of a table that is drawn anew."""
        mark = f"[{'.'.join(path)}] "
        for name in [
            name for name in self.widgets if name.startswith(mark) and name != keep
        ]:
            del self.widgets[name]

    def _tell(self, name: str) -> None:
        if self.changed is not None:
            self.changed(name)


def _name(path: tuple[str, ...]) -> str:
    """A key's place as the errors of scene files call it, such as "[contact] load"."""
    return f"[{'.'.join(path[:-1])}] {path[-1]}" if path[1:] else path[0]


def _meaning(kind: Any) -> str:
    return next(
        (note for note in getattr(kind, "__metadata__", ()) if isinstance(note, str)),
        "",
    )


def _default(default: Any) -> str:
    if default is None or default is msgspec.NODEFAULT:
        return "automatic"
    return str(default)


def _example(accepts: Leaf) -> str:
    quantity = accepts.quantity
    if quantity is None:
        return "1, 2, 3" if accepts.several and accepts.numeric else ""
    example = words.with_signs(quantity.example)
    if accepts.spread:
        return f"{example}, or A to B, 24 points"
    return f"{example}, or several" if accepts.several else example


def _as_options(choices: Mapping[str, str] | Sequence[str]) -> dict[str, str]:
    return (
        dict(choices)
        if isinstance(choices, Mapping)
        else {name: name for name in choices}
    )


def _flag(label: str, field: Any, accepts: Leaf, value: Any) -> Any:
    """A box to tick; of three answers where the default is one of its own."""
    if not accepts.optional:
        shown = field.default if value is None else value
        return ui.checkbox(label.removesuffix(" *"), value=shown)
    options = {"": "automatic", "true": "yes", "false": "no"}
    chosen = {None: "", True: "true", False: "false"}[value]
    return ui.select(options, value=chosen, label=label)


def _legend(title: str) -> None:
    with ui.element("legend"):
        ui.label(title)


def _mark(widget: Any, message: str | None) -> None:
    if hasattr(widget, "error"):
        widget.error = message
