"""What a store was made of, in JSON: values exactly, functions by their code and all
that it refers to.
"""

from __future__ import annotations

import builtins
import copyreg
import dis
import functools
import hashlib
import importlib
import importlib.metadata
import importlib.util
import json
import site
import sys
import sysconfig
import threading
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from types import (
    CodeType,
    FunctionType,
    GetSetDescriptorType,
    MemberDescriptorType,
    ModuleType,
)
from typing import Any

import numpy as np

from .. import __version__
from ..arrays import as_numpy
from ..material.validity import Draws
from ..trees import Tree

_PACKAGE, _PYTHON = __name__.partition(".")[0], "Python"
_LONG = 100  # entries from which on a list is described by its digest
_LONG_TEXT = 1000
_MOST = 1_000_000  # objects that are looked at
_UNKNOWN = "!unknown"  # the key of what cannot be compared
_LOCKS = (type(threading.Lock()), type(threading.RLock()))
# compiled ones, whose other fields decide no number: of functools.cache and of jax.jit
_WRAPPERS = ("_lru_cache_wrapper", "PjitFunction")
# of a class, what follows from the rest or decides no number
_NOT_OF_A_CLASS = {
    "__module__",
    "__qualname__",
    "__dict__",
    "__weakref__",
    "__doc__",
    "__annotations__",
    "__abstractmethods__",
    "_abc_impl",
    "__slotnames__",
    "__firstlineno__",
    "__static_attributes__",
}
_LOADS = {"LOAD_GLOBAL", "LOAD_NAME", "LOAD_FROM_DICT_OR_GLOBALS"}


def described(value: Any) -> Any:
    """A value in JSON: two are equal if they say the same to a call; what cannot be
    compared is equal to nothing.
    """
    try:
        return _Reader().read(value)
    except RecursionError:
        return _unknown(value, "which is nested too deeply")


def difference(made: Any, asked: Any, name: str = "") -> str:
    """Where two descriptions differ first, in words that name both; an empty text where
    they do not.
    """
    if isinstance(asked, dict) and _UNKNOWN in asked:
        return not_comparable(asked, name)
    if isinstance(made, dict) and isinstance(asked, dict):
        entries = (
            difference(
                made.get(key), asked.get(key), f"{name}.{key}".strip(".") or name
            )
            for key in dict.fromkeys([*made, *asked])
        )
        return next(filter(None, entries), "")
    if isinstance(made, list) and isinstance(asked, list) and len(made) == len(asked):
        entries = (
            difference(*pair, f"{name}[{i}]")
            for i, pair in enumerate(zip(made, asked, strict=True))
        )
        return next(filter(None, entries), "")
    before, now = json.dumps(made), json.dumps(asked)
    if made == asked or before == now:  # NaN is not equal to itself
        return ""
    before, now = (
        text if len(text) < 120 else f"{text[:117]}..." for text in (before, now)
    )
    return f"{name} was {before} and is {now}"


def not_comparable(described: Any, name: str = "") -> str:
    """What in a description is equal to nothing, and why; an empty text where all of it
    can be compared.
    """
    if isinstance(described, dict) and _UNKNOWN in described:
        return f"{name} is {described[_UNKNOWN]}"
    entries: Iterable[tuple[str, Any]] = ()
    if isinstance(described, dict):
        entries = (
            (f"{name}.{key}".strip("."), part) for key, part in described.items()
        )
    elif isinstance(described, list):
        entries = ((f"{name}[{i}]", part) for i, part in enumerate(described))
    return next(filter(None, (not_comparable(part, at) for at, part in entries)), "")


def modules_of_the_user() -> list[ModuleType]:
    """All that are loaded and not installed, other than the script."""
    return [
        module
        for name, module in sorted(sys.modules.items())
        if isinstance(module, ModuleType)
        and name not in ("__main__", "__mp_main__")
        and not _package(name)
    ]


def _installed(name: str) -> str:
    """Package and version of a module that is none of the user's."""
    package = _package(name)
    return f"{package} {_version(package)}" if package else ""


@functools.cache
def _package(name: str) -> str:
    """The package of a module that is none of the user's, or Python."""
    top = name.partition(".")[0]
    if top == _PACKAGE:
        return _PACKAGE
    file = getattr(sys.modules.get(name), "__file__", None)
    if file is None and name not in sys.modules:
        found = importlib.util.find_spec(top)
        file = found.origin if found else None
    if file is None or file in ("built-in", "frozen"):
        return _PYTHON if top in sys.stdlib_module_names else ""
    path = Path(file).resolve()
    paths = sysconfig.get_paths()
    packages = {paths["purelib"], paths["platlib"], site.getusersitepackages()}
    if {"site-packages", "dist-packages"} & set(path.parts) or any(
        path.is_relative_to(Path(each).resolve()) for each in packages
    ):
        return top
    standard = (paths["stdlib"], paths["platstdlib"])
    is_standard = any(path.is_relative_to(Path(each).resolve()) for each in standard)
    return _PYTHON if is_standard else ""


@functools.cache
def _version(package: str) -> str:
    if package == _PACKAGE:
        return __version__
    if package == _PYTHON:
        return f"{sys.version_info.major}.{sys.version_info.minor}"
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:
        names = importlib.metadata.packages_distributions().get(package, ())
        return ", ".join(map(importlib.metadata.version, names))


class _Reader:
    """Describes a value and what it refers to; each function, class and module once."""

    def __init__(self) -> None:
        self._count = 0
        self._stopped = False  # by what cannot be compared
        self._within: dict[int, int] = {}  # depth of what is being described, by id
        # what was described once, by id; held, so that the id stays its own
        self._before: dict[int, Any] = {}

    def read(self, value: Any) -> Any:
        self._count += 1
        if self._stopped:
            return None
        if self._count > _MOST:
            return self._unknown(value, f"and more than {_MOST} are before it")
        if value is None or isinstance(value, (bool, int, float)):
            return value
        if isinstance(value, (str, bytes)):
            return _text(value)
        if id(value) in self._within:
            return f"itself, {len(self._within) - self._within[id(value)]} above"
        self._within[id(value)] = len(self._within)
        try:
            return self._object(value)
        finally:
            del self._within[id(value)]

    def _object(self, value: Any) -> Any:
        value = as_numpy(value)
        if isinstance(value, (FunctionType, type, ModuleType)):
            return self._once(value)
        if isinstance(value, CodeType):
            return _digest(json.dumps(self._code(value)).encode())
        if isinstance(value, Draws):
            about = {"": "Draws", "name": value.name, "words": value.words}
            return about | {"each": self._entries(list(value))}
        if isinstance(value, Mapping):
            entries = {self._key(key): self.read(each) for key, each in value.items()}
            return entries if len(entries) <= _LONG else _of_many(entries)
        if isinstance(value, np.generic) or type(value) is np.ndarray:
            return self._array(value)
        if type(value) in (list, tuple):
            is_numbers = all(isinstance(each, (int, float)) for each in value)
            return self._array(value) if is_numbers else self._entries(value)
        if isinstance(value, (set, frozenset)):
            return sorted((self.read(each) for each in value), key=json.dumps)
        return self._instance(value)

    def _key(self, key: Any) -> str:
        return key if isinstance(key, str) else f"({json.dumps(self.read(key))})"

    def _entries(self, values: Any) -> Any:
        entries = [self.read(each) for each in values]
        return entries if len(entries) <= _LONG else _of_many(entries)

    def _array(self, values: Any) -> Any:
        """Numbers; more than twelve by their digest."""
        array = np.ascontiguousarray(values)
        if array.dtype.hasobject:
            return self._entries(array.tolist()) if array.ndim else self.read(values)
        if array.size <= 12 and array.dtype.kind in "biuf":
            return array.tolist() if np.ndim(values) else array.item()
        array = array.astype(float) if array.dtype.kind in "iu" else array
        shape = "x".join(map(str, array.shape))
        ends = f"{array.flat[0]!s} to {array.flat[-1]!s}" if array.size else "empty"
        return f"{array.dtype} {shape}, {ends}, digest {_digest(array.tobytes())}"

    def _instance(self, value: Any) -> Any:
        """An object by its class, and by its fields or what it would be pickled as."""
        kind = type(value)
        name = kind.__name__ if _top(kind) == _PACKAGE else self.read(kind)
        if isinstance(value, Tree):
            return {"": name} | self._fields(vars(value))
        if isinstance(value, _LOCKS):  # holds no number
            return {"": name}
        if isinstance(value, (GetSetDescriptorType, MemberDescriptorType)):
            return {"": name, "name": value.__qualname__}
        if isinstance(value, property):
            parts = [value.fget, value.fset, value.fdel]
            return {"": name, "functions": self.read(parts)}
        if isinstance(value, (staticmethod, classmethod)):
            return {"": name, "function": self.read(value.__func__)}
        if kind.__name__ in _WRAPPERS:
            return {"": name, "function": self.read(value.__wrapped__)}
        try:
            reduced = copyreg.dispatch_table.get(kind)
            made = reduced(value) if reduced else value.__reduce_ex__(4)
        except Exception:  # what a class of anybody raises
            return self._unknown(value)
        if isinstance(made, str):
            home = str(getattr(value, "__module__", None) or kind.__module__)
            return {"": name, "name": f"{home}.{made}", "of": _source(home)}
        maker, arguments, *parts = made
        parts = [list(each) if isinstance(each, Iterator) else each for each in parts]
        state = parts.pop(0) if parts else None
        is_plain = maker is copyreg.__newobj__ and arguments == (kind,)  # type: ignore[attr-defined]
        if is_plain and isinstance(state, dict | None) and not any(parts):
            return {"": name} | self._fields(state or {})
        return {"": name, "made of": self.read([maker, arguments, state, parts])}

    def _unknown(self, value: Any, why: str = "which cannot be compared") -> Any:
        self._stopped = True
        return _unknown(value, why)

    def _fields(self, fields: Mapping[str, Any]) -> dict[str, Any]:
        return {str(key): self.read(each) for key, each in sorted(fields.items())}

    def _once(self, value: Any) -> Any:
        """A function, a class or a module; its name where it was described before."""
        name = getattr(value, "__qualname__", value.__name__)
        if id(value) in self._before:
            return f"{name}, described above"
        self._before[id(value)] = value
        if isinstance(value, ModuleType):
            return self._module(value)
        home = _package(value.__module__ or "")
        if home and (isinstance(value, type) or _found(value) is value):
            return (
                name
                if home == _PACKAGE
                else f"{value.__module__}.{name}, {_installed(value.__module__)}"
            )
        if isinstance(value, type):
            return {"": name, "bases": self.read(value.__bases__)} | self._fields(
                {
                    key: each
                    for key, each in vars(value).items()
                    if key not in _NOT_OF_A_CLASS
                }
            )
        return {"": name} | self._function(value)

    def _module(self, module: ModuleType) -> Any:
        """A module of the user as a whole; others by their version."""
        if home := _installed(module.__name__):
            return f"{module.__name__}, {home}"
        return {"": module.__name__, "of": _source(module.__name__)} | self._fields(
            {key: each for key, each in vars(module).items() if key[:2] != "__"}
        )

    def _function(self, function: FunctionType) -> dict[str, Any]:
        """A function by its code, what it holds, and what it refers to."""
        space, code = function.__globals__, function.__code__
        cells = dict(zip(code.co_freevars, function.__closure__ or (), strict=True))
        about = {
            "defaults": self.read(
                [
                    *(function.__defaults__ or ()),
                    *(function.__kwdefaults__ or {}).items(),
                ]
            ),
            "holds": {name: self._cell(cell) for name, cell in cells.items()},
        }
        home = _installed(str(space.get("__name__", "")))
        if home:
            about["of"] = home
        else:
            about["code"] = _digest(json.dumps(self._code(code)).encode())
            about["attributes"] = self._fields(vars(function))
            about["uses"] = self._referred_to(code, space)
        return {key: told for key, told in about.items() if told}

    def _cell(self, cell: Any) -> Any:
        try:
            return self.read(cell.cell_contents)
        except ValueError:  # empty
            return "not defined"

    def _code(self, code: CodeType) -> list[Any]:
        """What a function of a user does, without where it stands."""
        constants = [
            self._code(each) if isinstance(each, CodeType) else _constant(each)
            for each in code.co_consts
        ]
        arguments = [code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount]
        names = [*code.co_names, *code.co_varnames]
        return [code.co_code.hex(), names, arguments, code.co_flags, constants]

    def _referred_to(self, code: CodeType, space: dict[str, Any]) -> dict[str, Any]:
        """The globals and imports of a function and of those within it, by the names
        under which it uses them.
        """
        uses: dict[str, Any] = {}
        for path in _paths(code):
            value, taken = _followed(path, space)
            if ".".join(taken) not in uses and value is not _BUILT_IN:
                uses[".".join(taken)] = (
                    "not defined" if value is _MISSING else self.read(value)
                )
        for name, level, wanted in _imports(code):
            uses |= self._imported(name, level, wanted, space)
        for each in code.co_consts:
            if isinstance(each, CodeType):
                uses = self._referred_to(each, space) | uses
        return dict(sorted(uses.items()))

    def _imported(
        self, name: str, level: int, wanted: tuple[str, ...], space: dict[str, Any]
    ) -> dict[str, Any]:
        """What a function imports; only modules of the user are imported for that."""
        full = "." * level + name
        try:
            full = importlib.util.resolve_name(full, space.get("__package__"))
            if home := _installed(full):
                return {full: f"{full}, {home}"}
            module: Any = importlib.import_module(full)
        except ModuleNotFoundError:
            return {full: "not found"}
        except Exception as error:  # whatever a module of the user does
            why = f"which cannot be imported: {type(error).__name__}: {error}"
            return {full: self._unknown(full, why)}
        if not wanted:
            return {full: self.read(module)}
        parts = {each: getattr(module, each, _MISSING) for each in wanted}
        return {
            f"{full}.{each}": "not defined" if part is _MISSING else self.read(part)
            for each, part in parts.items()
        }


_MISSING, _BUILT_IN = object(), object()


def _paths(code: CodeType) -> Iterator[list[str]]:
    """The global names that code loads, each with the attributes that it takes next."""
    path: list[str] = []
    for step in dis.get_instructions(code):
        if path and step.opname in ("LOAD_ATTR", "LOAD_METHOD"):
            path.append(step.argval)
            continue
        if path:
            yield path
        path = [step.argval] if step.opname in _LOADS else []
    if path:
        yield path


def _followed(path: list[str], space: dict[str, Any]) -> tuple[Any, list[str]]:
    """What a path of names leads to, through modules of the user; and how far."""
    name, *rest = path
    if name not in space:
        return _BUILT_IN if hasattr(builtins, name) else _MISSING, [name]
    value, taken = space[name], [name]
    for attribute in rest:
        if not isinstance(value, ModuleType) or _package(value.__name__):
            break
        taken.append(attribute)
        value = getattr(value, attribute, _MISSING)
    return value, taken


def _imports(code: CodeType) -> Iterator[tuple[str, int, tuple[str, ...]]]:
    """The imports within code: module, level, and the names that are taken from it."""
    before: list[Any] = [0, None]
    for step in dis.get_instructions(code):
        if step.opname == "IMPORT_NAME":
            yield step.argval, before[-2], before[-1] or ()
        before.append(step.argval)


def _found(value: Any) -> Any:
    """What stands in its module under the name of a function or class."""
    found: Any = sys.modules.get(value.__module__ or "")
    for part in value.__qualname__.split("."):
        found = getattr(found, part, None)
    return found


def _top(kind: type) -> str:
    return kind.__module__.partition(".")[0]


def _source(module: str) -> str:
    """Package and version of a module; a digest of the file where a module of the user
    is compiled, an empty text where it is not.
    """
    file = Path(getattr(sys.modules.get(module), "__file__", None) or "")
    if _installed(module) or file.suffix in (".py", "") or not file.is_file():
        return _installed(module)
    return _digest(file.read_bytes())


def _unknown(
    value: Any, why: str = "which cannot be compared with another"
) -> dict[str, str]:
    return {_UNKNOWN: f"an object of the type {type(value).__name__}, {why}"}


def _text(value: str | bytes) -> str:
    if isinstance(value, str) and len(value) <= _LONG_TEXT:
        return value
    data = value.encode("utf-8", "surrogatepass") if isinstance(value, str) else value
    return f"{type(value).__name__} of length {len(value)}, digest {_digest(data)}"


def _of_many(entries: Any) -> Any:
    """Many entries by their digest, unless one of them cannot be compared."""
    if unknown := not_comparable(entries):
        return {_UNKNOWN: f"{len(entries)} entries, of which {unknown}"}
    return f"{len(entries)} entries, digest {_digest(json.dumps(entries).encode())}"


def _constant(value: Any) -> str:
    return repr(sorted(map(repr, value)) if isinstance(value, frozenset) else value)


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
