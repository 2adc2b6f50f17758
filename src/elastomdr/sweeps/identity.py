"""What a store was made of, in JSON: values exactly, functions by their code and all
that it refers to.

What is described is a closed list (`_Reader`). Anything else cannot be compared: a
store that was made with it is not gone on with, and says why.
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
import logging
import site
import sys
import sysconfig
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path, PurePath
from types import (
    BuiltinFunctionType,
    CellType,
    CodeType,
    FunctionType,
    GenericAlias,
    GetSetDescriptorType,
    MappingProxyType,
    MemberDescriptorType,
    MethodType,
    ModuleType,
    UnionType,
)
from typing import Any, TypeAlias, get_args, get_origin

import numpy as np

from .. import __version__
from ..arrays import as_numpy
from ..material.validity import Draws

# what `json` takes
Json: TypeAlias = "bool | int | float | str | list[Json] | dict[str, Json] | None"

_PACKAGE, _PYTHON = __name__.partition(".")[0], "Python"
_LONG = 100  # entries from which on a list is described by its digest
_LONG_TEXT = 1000
_POINTER = 8  # bytes
_MOST = 1_000_000  # objects that are looked at
_UNKNOWN = "!unknown"  # the key of what cannot be compared
_REMEDY = (
    "numbers, texts, arrays, lists, dicts, functions, and objects that hold nothing "
    "but their fields can be"
)
# what holds no number; slots among what a class has
_IDLE = (
    type(threading.Lock()),
    type(threading.RLock()),
    logging.Logger,
    GetSetDescriptorType,
    MemberDescriptorType,
)
# compiled ones, whose other fields decide no number: of functools.cache and of jax.jit
_WRAPPERS = ("_lru_cache_wrapper", "PjitFunction")
# what leads from a function to code and values that it does not name
_DOORS = {
    "globals",
    "__globals__",
    "eval",
    "exec",
    "__import__",
    "import_module",
    "modules",
    "currentframe",
    "_getframe",
}
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


def described(value: object) -> Json:
    """A value in JSON: two are equal if they say the same to a call; what cannot be
    compared is equal to nothing.
    """
    try:
        return _Reader().read(value)
    except RecursionError:
        return _unknown(value, "which is nested too deeply")


def difference(made: Json, asked: Json, name: str = "") -> str:
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


def not_comparable(described: Json, name: str = "") -> str:
    """What in a description is equal to nothing, and why; an empty text where all of it
    can be compared.
    """
    if isinstance(described, dict) and _UNKNOWN in described:
        return f"{name} is {described[_UNKNOWN]}"
    entries: Iterable[tuple[str, Json]] = ()
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
    """Describes a value and what it refers to; each function, class and module once.

    The list of what it can describe is closed: plain data, functions of Python with all
    that they refer to, classes, modules, what stands under its name in an installed
    package, and objects that hold nothing but their fields.
    """

    def __init__(self) -> None:
        self._count = 0
        self._stopped = False  # by what cannot be compared
        self._within: dict[int, int] = {}  # depth of what is being described, by id
        # what was described once, by id; held, so that the id stays its own
        self._before: dict[int, object] = {}

    def read(self, value: object) -> Json:
        self._count += 1
        if self._stopped:
            return None
        if self._count > _MOST:
            return self._unknown(value, f"and more than {_MOST} are before it")
        ours = _package(type(value).__module__) in (_PACKAGE, _PYTHON)
        if value is None or (ours and isinstance(value, (bool, int, float))):
            return value
        if ours and isinstance(value, (str, bytes)):
            return _text(value)
        if id(value) in self._within:
            return f"itself, {len(self._within) - self._within[id(value)]} above"
        self._within[id(value)] = len(self._within)
        try:
            return self._object(as_numpy(value))
        finally:
            del self._within[id(value)]

    def _object(self, value: Any) -> Json:
        kind = type(value)
        if kind in (dict, MappingProxyType):
            return self._many(
                {
                    key if type(key) is str else f"({json.dumps(self.read(key))})": each
                    for key, each in value.items()
                }
            )
        if kind is Draws:
            about = {"": "Draws", "name": value.name, "words": value.words}
            return about | {"each": self._many(list(value))}
        if kind is np.ndarray or isinstance(value, np.generic):
            return self._array(value)
        if kind in (list, tuple):
            is_numbers = all(type(each) in (bool, int, float) for each in value)
            return self._array(value) if is_numbers else self._many(value)
        if kind in (set, frozenset):
            return sorted((self.read(each) for each in value), key=json.dumps)
        if isinstance(value, PurePath):
            return {"": "Path", "name": str(value)}
        if name := _installed_name(value):
            is_door = name.partition(",")[0].rpartition(".")[2] in _DOORS
            return self._door(name) if is_door else name
        if isinstance(value, (FunctionType, type, ModuleType)):
            return self._once(value)
        if isinstance(value, CodeType):
            return _digest(json.dumps(_code(value)).encode())
        return self._instance(value)

    def _many(self, entries: Sequence[object] | dict[str, object]) -> Json:
        """The entries of a list or a dict; of many their digest."""
        told = (
            self._fields(entries)
            if not isinstance(entries, Sequence)
            else [self.read(each) for each in entries]
        )
        if len(told) <= _LONG:
            return told
        if unknown := not_comparable(told):
            return {_UNKNOWN: f"{len(told)} entries, of which {unknown}"}
        return f"{len(told)} entries, digest {_digest(json.dumps(told).encode())}"

    def _fields(self, fields: Mapping[str, object]) -> dict[str, Json]:
        return {key: self.read(each) for key, each in fields.items()}

    def _array(self, values: Any) -> Json:
        """Numbers; more than twelve by their digest."""
        array = np.ascontiguousarray(values)
        if array.dtype.hasobject:
            return self._many(array.tolist())
        if array.size <= 12 and array.dtype.kind in "biuf":
            return array.tolist() if np.ndim(values) else array.item()
        if array.dtype.kind in "iu":  # as the same floats, where these hold all digits
            floats = array.astype(float)
            exact = np.array_equal(floats.astype(array.dtype), array)
            array = floats if exact else array
        shape = "x".join(map(str, array.shape))
        ends = f"{array.flat[0]!s} to {array.flat[-1]!s}" if array.size else "empty"
        return f"{array.dtype} {shape}, {ends}, digest {_digest(array.tobytes())}"

    def _instance(self, value: Any) -> Json:
        """What holds others in places that are known; objects whose fields are all
        that they hold.
        """
        kind = type(value)
        name = self.read(kind)
        held: dict[str, object] = {}
        if isinstance(value, MethodType):
            held = {"function": value.__func__, "self": value.__self__}
        elif kind is functools.partial:
            held = {"function": value.func, "given": [value.args, value.keywords]}
            held |= {"attributes": vars(value)} if vars(value) else {}
        elif isinstance(value, (UnionType, GenericAlias)):
            held = {"of": [get_origin(value), *get_args(value)]}
        elif isinstance(value, property):
            held = {"functions": [value.fget, value.fset, value.fdel]}
        elif isinstance(value, (staticmethod, classmethod)):
            held = {"function": value.__func__}
        elif kind.__name__ in _WRAPPERS:
            held = {"function": value.__wrapped__}
        elif isinstance(value, BuiltinFunctionType):
            held = {"name": value.__qualname__, "self": value.__self__}
        elif isinstance(value, tuple) and _package(kind.__module__) == _PACKAGE:
            held = value._asdict()  # type: ignore[attr-defined]
        elif isinstance(value, _IDLE):
            pass
        elif _holds_only_fields(kind):
            state: Any = object.__getstate__(value)  # type: ignore[attr-defined]
            fields, slots = state if isinstance(state, tuple) else (state, None)
            held = dict(sorted(((fields or {}) | (slots or {})).items()))
        else:
            return self._unknown(value)
        return {"": name} | self._fields(held)

    def _unknown(
        self, value: object, why: str = f"which cannot be compared: {_REMEDY}"
    ) -> Json:
        self._stopped = True
        return _unknown(value, why)

    def _door(self, name: str) -> Json:
        self._stopped = True
        return {
            _UNKNOWN: f"a function that uses {name!r}, by which it may reach anything: "
            "it can be compared if it names what it uses"
        }

    def _once(self, value: FunctionType | type | ModuleType) -> Json:
        """A function, a class or a module; its name where it was described before."""
        name = getattr(value, "__qualname__", value.__name__)
        if id(value) in self._before:
            return f"{name}, described above"
        self._before[id(value)] = value
        if isinstance(value, ModuleType):
            return self._module(value)
        if isinstance(value, type):
            made_by = {"made by": type(value)} if type(value) is not type else {}
            fields = {
                key: each
                for key, each in sorted(vars(value).items())
                if key not in _NOT_OF_A_CLASS
            }
            return {"": name} | self._fields(
                {"bases": value.__bases__} | made_by | fields
            )
        return {"": name} | self._function(value)

    def _module(self, module: ModuleType) -> Json:
        """A module of the user as a whole."""
        if not str(getattr(module, "__file__", None) or ".py").endswith(".py"):
            return self._unknown(module, "which is compiled")
        named = {
            key: each for key, each in sorted(vars(module).items()) if key[:2] != "__"
        }
        return {"": module.__name__} | self._fields(named)

    def _function(self, function: FunctionType) -> dict[str, Json]:
        """A function by its code, what it holds, and what it refers to."""
        space, code = function.__globals__, function.__code__
        cells = zip(code.co_freevars, function.__closure__ or (), strict=True)
        about = {
            "defaults": self.read(
                [*(function.__defaults__ or ()), function.__kwdefaults__ or {}]
            ),
            "holds": {name: self._cell(cell) for name, cell in cells},
        }
        home = _installed(str(space.get("__name__", "")))
        if home:
            about["of"] = home
        else:
            about["code"] = _digest(json.dumps(_code(code)).encode())
            about["attributes"] = self._fields(dict(sorted(vars(function).items())))
            about["uses"] = dict(sorted(self._referred_to(code, space).items()))
        return {key: told for key, told in about.items() if told}

    def _cell(self, cell: CellType) -> Json:
        try:
            return self.read(cell.cell_contents)
        except ValueError:  # empty
            return "not defined"

    def _referred_to(self, code: CodeType, space: dict[str, object]) -> dict[str, Json]:
        """The globals and imports of a function and of those within it, by the names
        under which it uses them.
        """
        if doors := sorted(_DOORS.intersection(code.co_names)):
            return {doors[0]: self._door(doors[0])}
        uses: dict[str, Json] = {}
        for path in _paths(code):
            name, value = _followed(path, space)
            if name not in uses:
                uses[name] = "not defined" if value is _MISSING else self.read(value)
        for name, level, within in _imports(code):
            uses |= self._imported("." * level + name, within, space)
        for each in code.co_consts:
            if isinstance(each, CodeType):
                uses = self._referred_to(each, space) | uses
        return uses

    def _imported(
        self, name: str, within: tuple[str, ...], space: dict[str, object]
    ) -> dict[str, Json]:
        """A module that a function imports, its parents, and those modules that it
        imports from `within` it, as wholes; only those of the user are imported.
        """
        try:
            full = importlib.util.resolve_name(
                name, str(space.get("__package__") or "")
            )
            if home := _installed(full):
                return {full: f"{full}, {home}"}
            parts = full.split(".")
            wholes = [".".join(parts[: i + 1]) for i in range(len(parts))]
            package = hasattr(importlib.import_module(full), "__path__")
            inner = [f"{full}.{each}" for each in within if package]
            wholes += [each for each in inner if importlib.util.find_spec(each)]
            return {each: self.read(importlib.import_module(each)) for each in wholes}
        except ModuleNotFoundError:
            return {name: "not found"}
        except Exception as error:  # whatever a module of the user does
            why = f"which cannot be imported: {type(error).__name__}: {error}"
            return {name: self._unknown(name, why)}


_MISSING = object()


def _holds_only_fields(kind: type) -> bool:
    """Whether an object has no memory but that of its `__dict__` and its slots, as
    `object.__reduce_ex__` asks it; false of all that derives from a dict, a float ...
    """
    has = [kind.__dictoffset__ > 0, kind.__weakrefoffset__ > 0]
    names = len(copyreg._slotnames(kind))  # type: ignore[attr-defined]
    most = object.__basicsize__ + _POINTER * (sum(has) + names)
    return not kind.__itemsize__ and kind.__basicsize__ <= most


def _code(code: CodeType) -> list[Any]:
    """What a function of a user does, without where it stands."""
    constants = [
        _code(each) if isinstance(each, CodeType) else _constant(each)
        for each in code.co_consts
    ]
    arguments = [code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount]
    names = [*code.co_names, *code.co_varnames]
    steps = code.co_code.hex() + code.co_exceptiontable.hex()
    return [steps, names, arguments, code.co_flags, constants]


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


def _followed(path: list[str], space: dict[str, object]) -> tuple[str, object]:
    """What a path of names leads to, through modules of the user; and its name."""
    name, *rest = path
    value = space.get(name, getattr(builtins, name, _MISSING))
    for attribute in rest:
        if not isinstance(value, ModuleType) or _package(value.__name__):
            break
        name = f"{name}.{attribute}"
        value = getattr(value, attribute, _MISSING)
    return name, value


def _imports(code: CodeType) -> Iterator[tuple[str, int, tuple[str, ...]]]:
    """The imports within code: module, level, and what is taken from the module."""
    before: list[Any] = [0, None]
    for step in dis.get_instructions(code):
        if step.opname == "IMPORT_NAME":
            yield step.argval, before[-2], before[-1] or ()
        before.append(step.argval)


def _installed_name(value: object) -> str:
    """What stands under its name in an installed package, by that and the version; a
    text that is empty for all else.
    """
    if isinstance(value, ModuleType):
        home = _installed(value.__name__)
        return home and f"{value.__name__}, {home}"
    name = getattr(value, "__qualname__", getattr(value, "__name__", None))
    module = getattr(value, "__module__", None)
    if module is None and isinstance(value, np.ufunc):
        module = "scipy.special"
    if not isinstance(name, str) or not isinstance(module, str):
        return ""
    found: Any = sys.modules.get(module)
    for part in name.split("."):
        found = getattr(found, part, None)
    home = _installed(module)
    if not home or not (found is value or isinstance(value, type)):
        return ""
    return name if _package(module) == _PACKAGE else f"{module}.{name}, {home}"


def _unknown(value: object, why: str) -> Json:
    return {_UNKNOWN: f"an object of the type {type(value).__name__}, {why}"}


def _text(value: str | bytes) -> str:
    if isinstance(value, str) and len(value) <= _LONG_TEXT:
        return value
    data = value.encode("utf-8", "surrogatepass") if isinstance(value, str) else value
    return f"{type(value).__name__} of length {len(value)}, digest {_digest(data)}"


def _constant(value: object) -> str:
    return repr(sorted(map(repr, value)) if isinstance(value, frozenset) else value)


def _digest(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
