"""Typed values out of TOML tables; every complaint names the table, the key, the value and what is accepted."""

import sys
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from ..errors import InputError, closest
from .units import Kind, quantity

T = TypeVar("T")


class Keys:
    """One TOML table, refused with the closest valid key where it holds a key that is not in `valid`."""

    def __init__(self, content: Any, where: str, valid: Iterable[str]):
        self._where = f"[{where}] " if where else ""
        valid = tuple(valid)
        if not isinstance(content, dict):
            raise InputError(f"[{where}] must be a table with the keys {', '.join(valid)}, got {content!r}.")
        for key in content:
            if key not in valid:
                hint = closest(key, valid) or f" Valid keys: {', '.join(valid)}."
                raise InputError(f"{self._where}has a key that is not known: {key!r}.{hint}".strip())
        self._content = content

    def __contains__(self, key: str) -> bool:
        return key in self._content

    def name(self, key: str) -> str:
        """The key as messages call it, such as "[contact] load"."""
        return f"{self._where}{key}"

    def get(self, key: str, read: Callable[[str, Any], T]) -> T:
        """The value of a key that must be there, as `read(name, value)` returns it."""
        if key not in self._content:
            raise InputError(f"{self.name(key)} is missing.")
        return read(self.name(key), self._content[key])


def text(name: str, value: Any) -> str:
    """A text that is not empty."""
    if not isinstance(value, str) or not value.strip():
        raise InputError(f"{name} must be a text, got {value!r}.")
    return value


def flag(name: str, value: Any) -> bool:
    """true or false."""
    if not isinstance(value, bool):
        raise InputError(f"{name} must be true or false, got {value!r}.")
    return value


def number(name: str, value: Any) -> float:
    """A plain finite number."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= sys.float_info.max:
        raise InputError(f"{name} must be a plain number, got {value!r}.")
    return float(value)


def positive_number(name: str, value: Any) -> float:
    """A plain number above zero."""
    if number(name, value) <= 0:
        raise InputError(f"{name} must be positive, got {value!r}.")
    return float(value)


def whole(name: str, value: Any, least: int, most: int) -> int:
    """A whole number within limits."""
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
        raise InputError(f"{name} must be a whole number from {least} to {most}, got {value!r}.")
    return value


def numbers(name: str, value: Any) -> list[float]:
    """A list of plain numbers."""
    if not isinstance(value, list):
        raise InputError(f"{name} must be a list of numbers, got {value!r}.")
    return [number(f"{name}[{i}]", entry) for i, entry in enumerate(value)]


def choice(*options: str) -> Callable[[str, Any], str]:
    """One of several words."""

    def read(name: str, value: Any) -> str:
        if value not in options:
            hint = closest(value, options) if isinstance(value, str) else ""
            raise InputError(f"{name} must be one of {', '.join(options)}, got {value!r}.{hint}")
        return value

    return read


def one(kind: Kind) -> Callable[[str, Any], float]:
    """A quantity with its unit, in SI."""
    return lambda name, value: quantity(name, value, kind)


def one_or_more(kind: Kind) -> Callable[[str, Any], float | list[float]]:
    """A quantity with its unit, or a list of them, in SI; a list of one counts as the one."""

    def read(name: str, value: Any) -> float | list[float]:
        if not isinstance(value, list):
            return quantity(name, value, kind)
        if not value:
            raise InputError(f"{name} must be {kind.name} or a list of them, got an empty list.")
        values = [quantity(f"{name}[{i}]", entry, kind) for i, entry in enumerate(value)]
        return values if len(values) > 1 else values[0]

    return read
