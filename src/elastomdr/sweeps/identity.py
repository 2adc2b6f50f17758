"""What other processes are sent to compute, and what that is in JSON, by which a store
is known again.

Both come from one pickle. A process that computes has nothing of the one that calls but
what is in it: functions with their code, globals and closures, classes and modules of
the user by value, and all else by its name in an installed package. So nothing that is
not described decides a number. It is described without making anything of it.
"""

from __future__ import annotations

import contextlib
import copy
import copyreg
import dis
import functools
import hashlib
import importlib
import importlib.machinery
import importlib.metadata
import importlib.util
import io
import itertools
import json
import pickle
import re
import site
import sys
import sysconfig
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from types import BuiltinFunctionType, CodeType, FunctionType, ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias, cast
from weakref import WeakKeyDictionary, WeakValueDictionary

import numpy as np

from ..errors import InputError

if TYPE_CHECKING:
    from cloudpickle import Pickler as Packer

# what `json` takes
Json: TypeAlias = (
    "bool | int | float | str | Sequence[Json] | Mapping[str, Json] | None"
)

_PACKAGE, _PYTHON = __name__.partition(".")[0], "Python"
_COMPILED = tuple(importlib.machinery.EXTENSION_SUFFIXES)
_LONG = 100  # entries from which on a list is described by its digest
_LONG_TEXT = 1000
# of a module, what says how it was loaded
_LOADED = {"__builtins__", "__cached__", "__loader__", "__spec__"}
# holds nothing, and is not pickled
_LOCKS = {type(make()): make for make in (threading.Lock, threading.RLock)}
_CACHED = type(functools.cache(len))
# by which a class says itself how its objects are pickled
_HOOKS = {"__reduce__", "__reduce_ex__", "__getstate__", "__setstate__"}
_PLACES = {10, 13, 14}  # of code: its file, its first line, its lines
# by what cloudpickle knows a class again: a random number
_RANDOM = re.compile("[0-9a-f]{32}")
_ASIDE = re.compile(r"$|\([a-z]")  # a key that says what kind of thing it is
_STATE_SETTERS = ("_function_setstate", "_class_setstate")  # of cloudpickle
_SUBMODULES = "_cloudpickle_submodules"  # loaded, by the way, in any order


def packed(given: object) -> bytes:
    """For other processes, with modules of the user as they are in this one, those too
    that a function imports when it is called. Raises `InputError`.
    """
    import cloudpickle

    class Packer(cloudpickle.Pickler):
        def reducer_override(self, obj: Any) -> Any:
            kind = type(obj)
            if kind in _LOCKS:
                return _LOCKS[kind], ()
            if kind in (WeakKeyDictionary, WeakValueDictionary):
                return kind, (dict(obj),)
            if kind is _CACHED and not _is_installed(obj):
                parts = obj.__wrapped__, *obj.cache_parameters().values()
                return _cached, parts, vars(obj)
            if kind is ModuleType and _is_by_value(obj):
                return ModuleType, (obj.__name__,), _contents(self, obj)
            _check_whole(obj)
            reduced: Any = super().reducer_override(obj)
            if isinstance(obj, FunctionType) and reduced is not NotImplemented:
                modules.update(_imported(obj.__code__, obj.__globals__))
            return reduced

    modules: dict[str, ModuleType] = {}
    while True:
        known = dict(modules)
        by_value = [
            module
            for _, module in sorted(list(sys.modules.items()))
            if isinstance(module, ModuleType)
            and _is_by_value(module)
            and module.__name__ not in cloudpickle.list_registry_pickle_by_value()
            and sys.modules.get(module.__name__) is module
        ]
        file = io.BytesIO()
        try:
            for module in by_value:
                cloudpickle.register_pickle_by_value(module)
            Packer(file).dump((given, known))
        except Exception as error:  # of another class with each of them
            raise InputError(
                argument="call",
                accepted="such, with its axes and fixed arguments, that it can be "
                "pickled for other processes",
                hint=str(error),
            ) from error
        finally:
            for module in by_value:
                cloudpickle.unregister_pickle_by_value(module)
        if known == modules:
            return file.getvalue()


def unpacked(sent: bytes) -> Any:
    """What was packed. Raises `InputError` where it cannot be made again here."""
    try:
        given, modules = pickle.loads(sent)
    except Exception as error:  # of a module that is not there, or of a class
        raise InputError(
            argument="call",
            accepted="such, with its axes and fixed arguments, that the processes "
            "that compute can make it again",
            hint=f"{type(error).__name__}: {error}",
        ) from error
    for name, module in modules.items():
        sys.modules.setdefault(name, module)
    return given


def _is_by_value(module: ModuleType) -> bool:
    """Whether it is a module of the user, in Python."""
    is_compiled = str(getattr(module, "__file__", "")).endswith(_COMPILED)
    return not (
        is_compiled or module.__name__ == "__main__" or _package(module.__name__)
    )


def _is_installed(value: Callable[..., object]) -> bool:
    """Whether it stands under its name in an installed package."""
    found: Any = sys.modules.get(str(value.__module__))
    for part in value.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is value and bool(_package(value.__module__))


def _check_whole(value: object) -> None:
    """Raises `TypeError` where a class of the user says itself how its objects are
    pickled, and leaves something out.
    """
    from cloudpickle import dumps

    kind = type(value)
    own = [vars(base) for base in kind.__mro__ if not _package(str(base.__module__))]
    if any(map(_HOOKS.intersection, own)) or (own and kind in copyreg.dispatch_table):
        copied = copy.copy(value)
        states = [dumps(object.__getstate__(v)) for v in (value, copied)]  # type: ignore[attr-defined]
        if states[0] != states[1] or (kind.__eq__ != object.__eq__ and value != copied):
            raise TypeError(f"{kind.__name__} leaves something out when it is pickled")


def _cached(function: Callable[..., object], size: int | None, typed: bool) -> object:
    return functools.lru_cache(size, typed)(function)


def _contents(packer: Packer, module: ModuleType) -> dict[str, object]:
    """What stands in a module, but for what cannot be pickled: where a function uses
    that, it raises.
    """

    def can_be_sent(value: object) -> bool:
        known = (*packer.dispatch_table, FunctionType, ModuleType, _CACHED, *_LOCKS)
        try:
            return isinstance(value, type) or (
                type(value) in known or bool(value.__reduce_ex__(5))
            )
        except Exception:  # whatever a class raises
            return False

    return {
        key: value
        for key, value in vars(module).items()
        if key not in _LOADED and can_be_sent(value)
    }


def _imported(
    code: CodeType, space: Mapping[str, object]
) -> Iterator[tuple[str, ModuleType]]:
    """The modules of the user that code imports, and those that they are in."""
    before: list[Any] = [0, None]
    for step in dis.get_instructions(code):
        if step.opname == "IMPORT_NAME":
            name = "." * before[-2] + step.argval
            for each in ("", *(f".{each}" for each in before[-1] or ())):
                # where it is not found here, it is not there either
                with contextlib.suppress(Exception):
                    package = str(space.get("__package__") or "")
                    full = importlib.util.resolve_name(name, package) + each
                    if not _package(full):
                        importlib.import_module(full)
                        parts = full.split(".")
                        for i in range(len(parts)):
                            whole = ".".join(parts[: i + 1])
                            yield whole, sys.modules[whole]
        before.append(step.argval)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _imported(constant, space)


class _Pickled:
    """What a pickle makes: something by its name, or what a part makes of others."""

    def __init__(self, of: _Pickled | None, args: Any = (), named: Any = None):
        self.of, self.args, self.named = of, args, named or {}
        self.name = ""
        self.state: Any = None
        self.entries: dict[Any, object] = {}
        self.items: list[object] = []
        self.after: list[tuple[object, object]] = []  # what is done to it, with what
        self.append = self.add = self.items.append
        self.extend = self.items.extend
        # by which a pickle makes most objects
        vars(self)["__new__"] = lambda of, *args, **named: _Pickled(of, args, named)

    def __call__(self, *args: object) -> _Pickled:
        if len(args) == 2 and isinstance(args[0], _Pickled):
            if self.name in _STATE_SETTERS:
                args[0].state = args[1]
            else:
                args[0].after.append((self, args[1]))
        return _Pickled(self, args)

    def __setstate__(self, state: object) -> None:
        self.state = state

    def __setitem__(self, key: object, value: object) -> None:
        self.entries[key] = value


class _Unpickler(pickle._Unpickler):  # the one in Python, as parts are no types
    """Makes parts, and nothing of what they stand for."""

    def __init__(self, sent: bytes):
        super().__init__(io.BytesIO(sent))
        self.modules: set[str] = set()

    def find_class(self, module: str, name: str) -> Any:
        self.modules.add(module)
        is_short = _package(module) in (_PACKAGE, "cloudpickle")
        part = _Pickled(None)
        part.name = name if is_short else f"{module}.{name}"
        return part


def described(sent: bytes) -> dict[str, Json]:
    """What a packed dict says, in JSON: two are equal if all that a call can see of
    them is. With the versions of packages that it names, by module, and digests of
    modules of the user that are compiled. Raises `InputError`.
    """
    unpickler, reader = _Unpickler(sent), _Reader()
    given, modules = unpickler.load()
    try:
        told = reader.fields(given) | {"imports": reader.fields(modules)}
    except RecursionError as error:
        raise InputError(
            argument="axes", accepted="nested less deeply, as fixed arguments must"
        ) from error
    hidden = {"cloudpickle", _PACKAGE, *(() if reader.code else ("numpy",))}
    installed = {
        name: _version(name)
        for name in sorted(unpickler.modules | reader.modules)
        if _package(name) not in hidden
    }
    return {**told, "installed": installed}


class _Reader:
    """Says what the parts of a pickle are, each once. Keys in parentheses are none of a
    dict, and no fields.
    """

    def __init__(self) -> None:
        self._before: dict[int, int] = {}  # number by id
        self.modules: set[str] = set()  # that are named as a whole
        self.code = False

    def read(self, value: object) -> Json:
        if value is None or isinstance(value, (int, float)):
            return value
        if isinstance(value, (str, bytes, bytearray)):
            return _text(value)
        if isinstance(value, tuple):
            return {"(tuple)": self._many([*map(self.read, value)])}
        if isinstance(value, frozenset):
            return {"(frozenset)": self._set(value)}
        if isinstance(value, _Pickled) and value.name:
            return {"": value.name}
        if id(value) in self._before:
            return {"(part)": self._before[id(value)]}
        self._before[id(value)] = len(self._before) + 1
        if isinstance(value, dict):
            told = self.fields(value)
            return told if len(told) <= _LONG else self._many([*told.items()])
        if isinstance(value, list):
            return self._many([*map(self.read, value)])
        if isinstance(value, set):
            return {"(set)": self._set(value)}
        return self._made(value) if isinstance(value, _Pickled) else str(value)

    def _many(self, told: Sequence[Json]) -> Json:
        """Entries; of many their digest."""
        if len(told) <= _LONG:
            return told
        return {"(many)": f"{len(told)}, digest {_digest(json.dumps(told).encode())}"}

    def _set(self, values: Iterable[object]) -> Json:
        return self._many(sorted(map(self.read, values), key=json.dumps))

    def fields(self, fields: Mapping[Any, object]) -> dict[str, Json]:
        pairs = [(self._key(key), self.read(each)) for key, each in fields.items()]
        # keys may be objects that say the same
        return {"(pairs)": pairs} if len(dict(pairs)) < len(pairs) else dict(pairs)

    def _key(self, key: object) -> str:
        if isinstance(key, str) and key and key[0] != "(":
            return key
        return f"({json.dumps(self.read(key))})"

    def _made(self, part: _Pickled) -> Json:
        maker = cast(_Pickled, part.of)
        if maker.args == ("CodeType",):
            kept = [each for i, each in enumerate(part.args) if i not in _PLACES]
            return _digest(json.dumps([*map(self.read, kept)]).encode())
        if maker.name == "subimport":
            self.modules.add(part.args[0])
            return {"": part.args[0]}
        if maker.name == "_make_function":
            self.code = True
            code, slots = part.args[0], part.state[1]
            del slots[_SUBMODULES]
            parts = {"code": code, "uses": slots.pop("__globals__"), **slots}
            return self.fields(parts | {"attributes": part.state[0]})
        args = [
            self.read(each)
            for each in part.args
            if not (isinstance(each, str) and _RANDOM.fullmatch(each))
        ]
        told: dict[str, Json] = {
            "(values)": _values(part),
            "(class)": self.read(maker),
            "(of)": args,
            "(named)": self.fields(part.named),
            "(items)": self._many([*map(self.read, part.items)]),
            "(entries)": self.fields(part.entries),
            "(after)": self.read(tuple(part.after)) if part.after else None,
        }
        both: Any = part.state
        if not isinstance(both, tuple) or len(both) != 2:
            both = (part.state, None)
        state, slots = both  # those of `__dict__`, and of `__slots__`
        if isinstance(state or {}, dict) and isinstance(slots or {}, dict):
            told |= {"(slots)": self.fields(slots or {})} | self.fields(state or {})
        else:
            told["(state)"] = self.read(part.state)
        parenthesized = {
            "(values)",
            "(of)",
            "(named)",
            "(items)",
            "(entries)",
            "(after)",
            "(slots)",
        }
        return {k: v for k, v in told.items() if v or k not in parenthesized}


def _values(part: _Pickled) -> Json:
    """The numbers of a small array, for those who read it."""
    if not part.of or not part.of.name.endswith(".numeric._frombuffer"):
        return None
    data, dtype, shape, _ = part.args
    if len(data) > _LONG or dtype.args[0][0] not in "biuf":
        return None
    return np.frombuffer(data, dtype.args[0]).reshape(shape).tolist()


def difference(made: Json, asked: Json, name: str = "") -> str:
    """Where two descriptions differ first, in words that name both; an empty text where
    they do not.
    """
    before, now = json.dumps(made), json.dumps(asked)
    if before == now:
        return ""
    parts: list[tuple[Json, Json, str]] = []
    if isinstance(made, Mapping) and isinstance(asked, Mapping):
        for key in dict.fromkeys([*made, *asked]):
            at = name if _ASIDE.match(key) else f"{name}.{key}"
            parts.append((made.get(key), asked.get(key), at))
        before, now = json.dumps([*made]), json.dumps([*asked])
    elif isinstance(made, list) and isinstance(asked, list) and len(made) == len(asked):
        parts = [
            (*pair, f"{name}[{i}]")
            for i, pair in enumerate(zip(made, asked, strict=True))
        ]
    if found := next(filter(None, itertools.starmap(difference, parts)), ""):
        return found
    before, now = (
        f"{text[:117]}..." if len(text) > 120 else text for text in (before, now)
    )
    return f"{name.strip('.')} was {before} and is {now}"


@functools.cache
def _package(name: str) -> str:
    """The package of a module that is none of the user's, or Python."""
    top = name.partition(".")[0]
    if top == _PACKAGE:
        return _PACKAGE
    module = sys.modules.get(name)
    # a package without a file of its own has a folder
    file = getattr(module, "__file__", None) or next(
        iter(getattr(module, "__path__", ())), None
    )
    if file is None and module is not None and top != name:
        return _package(name.rpartition(".")[0])
    if file is None and module is None:
        found = importlib.util.find_spec(top)
        file = found.origin if found else None
    if file is None or file in ("built-in", "frozen"):
        return _PYTHON if top in sys.stdlib_module_names else ""
    return top if (place := _place(file)) == "packages" else place


def _place(file: str) -> str:
    """Whether a file is among the packages that are installed, or of Python."""
    path, paths = Path(file).resolve(), sysconfig.get_paths()
    packages = {paths["purelib"], paths["platlib"], site.getusersitepackages()}
    if {"site-packages", "dist-packages"} & set(path.parts) or any(
        path.is_relative_to(Path(each).resolve()) for each in packages
    ):
        return "packages"
    standard = (paths["stdlib"], paths["platstdlib"])
    is_standard = any(path.is_relative_to(Path(each).resolve()) for each in standard)
    return _PYTHON if is_standard else ""


def installed_folders() -> list[str]:
    """Where modules are found, but for Python's of the user."""
    ours = str(Path(__file__).parents[2])
    compiled = {
        str(Path(str(module.__file__)).parent)
        for module in list(sys.modules.values())
        if str(getattr(module, "__file__", None)).endswith(_COMPILED)
        and not _package(module.__name__)
    }
    return [path for path in sys.path if _place(path) or path in (ours, *compiled)]


def standing(named: Iterable[str] = ()) -> dict[str, dict[str, str]]:
    """What stands under each name in modules of installed packages and their classes:
    in those that are named, and in all that are loaded of what numbers rest upon.
    """
    names = set(named)
    for name in names:
        with contextlib.suppress(ImportError):
            importlib.import_module(name)
    names |= {"builtins", "math", *filter(_computes, sys.modules)}
    return {
        name: dict(_standing(sys.modules[name]))
        for name in sorted(names & sys.modules.keys() - {"sys"})
    }


def is_ours(name: str) -> bool:
    """Whether a module is of this package, but for this room, which decides nothing."""
    here = __name__.rpartition(".")[0]
    return name.partition(".")[0] == _PACKAGE and not name.startswith(here)


def _computes(name: str) -> bool:
    is_public = "._" not in name and not name.startswith("numpy.f2py")
    return is_ours(name) or (name.partition(".")[0] in ("numpy", "scipy") and is_public)


def _standing(module: ModuleType) -> Iterator[tuple[str, str]]:
    name = module.__name__
    # what loops of a package have left over, types as a rule, depends on hashes
    public = () if is_ours(name) else getattr(module, "__all__", ())
    for key, value in list(vars(module).items()):
        if public and key not in public and isinstance(value, (type, np.dtype)):
            continue
        # what others set themselves while they are used is left out
        is_state = isinstance(value, (str, bool, type(None))) or (
            key[0] == "_" and not _computes(name)
        )
        if key[:2] != "__" and (is_ours(name) or not is_state):
            # what is loaded when it is first used stands under its own name
            is_set = is_ours(name) and getattr(value, "__name__", key) != key
            yield key, f"= {_brief(value)}" if is_set else _brief(value)
        if isinstance(value, type) and value.__module__ == name:
            for field, each in list(vars(value).items()):
                yield f"{key}.{field}", _brief(each)
    if name == "decimal":
        yield "getcontext().prec", _brief(module.getcontext().prec)
    if name.partition(".")[0] == "jax":
        yield "config", str(sys.modules["jax"].config.jax_enable_x64)


def _brief(value: Any) -> str:
    """A number or a text, a function by its code; begins with "=" where it is of
    nothing that is installed.
    """
    if isinstance(value, (staticmethod, classmethod)):
        value = value.__func__
    elif isinstance(value, property):
        value = value.fget
    if value is None or isinstance(value, (bool, int, float, complex, str)):
        return f"= {value!r}"
    if isinstance(value, tuple):
        return str([*map(_brief, value)])
    if type(value) is np.ndarray:
        return f"{value.dtype}, digest {_digest(value.tobytes())}"
    if isinstance(value, FunctionType):
        home = str(value.__globals__.get("__name__"))
        more = map(_brief, (value.__defaults__, *(value.__kwdefaults__ or {}).values()))
        code = _digest(value.__code__.co_code)
        sign = "" if _package(home) else "= "
        return f"{sign}{home}.{value.__qualname__}, {code}, {[*more]}"
    name = (
        value.__name__
        if isinstance(value, (type, np.ufunc, BuiltinFunctionType))
        else ""
    )
    return f"{type(value).__name__} {name}"


def set_here(there: Mapping[str, Mapping[str, str]]) -> str:
    """What first stands in a module of this process otherwise than in another one."""
    here = standing(sys.modules.keys() & there)
    for name, fields in there.items():
        for key, value in here.get(name, {}).items():
            # what another module adds when it is loaded may not be there yet
            if fields.get(key, "" if value[0] == "=" else value) != value:
                return f"{name}.{key}"
    return ""


def _version(module: str) -> str:
    """The version of what a module is of; the digest of one of the user's that is
    compiled.
    """
    package = _package(module)
    if package == _PYTHON:
        return sys.version.partition(" ")[0]
    if not package:
        file = getattr(sys.modules.get(module), "__file__", None)
        return _digest(Path(file).read_bytes()) if file else ""
    try:
        return importlib.metadata.version(package)
    except importlib.metadata.PackageNotFoundError:  # it has another name there
        return str(getattr(sys.modules.get(package), "__version__", ""))


def _text(value: str | bytes | bytearray) -> Json:
    if isinstance(value, str) and len(value) <= _LONG_TEXT:
        return value
    data = value.encode("utf-8", "surrogatepass") if isinstance(value, str) else value
    return {f"({type(value).__name__})": f"length {len(value)}, digest {_digest(data)}"}


def _digest(data: bytes | bytearray) -> str:
    return hashlib.sha256(data).hexdigest()[:16]
