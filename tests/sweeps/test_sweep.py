"""`em.sweep`: every point as a call of its own gives it, nothing lost when it is
interrupted, nothing mixed up.
"""

import errno
import itertools
import json
import os
import pickle
import re
import shutil
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import psutil
import pytest
import tqdm
from distributed import Client, LocalCluster
from distributed.scheduler import KilledWorker
from filelock import FileLock

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.sweeps import grid as grids
from elastomdr.sweeps import run, store
from elastomdr.sweeps.identity import described, difference, packed, unpacked

from ..refused import mentions, refused, warned

pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
VELOCITY = np.logspace(-3, 1, 7)
EPDM = em.load_material("epdm-70")
ROAD = em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)


def rubber(k):
    return em.Prony(
        1e6,
        [k * 1e6, 2e6],
        [1e-5, 1e-3],
        shift=em.WLF(8.0, 100.0, 293.15),
        name=f"rubber {k}",
    )


def scene(**more):
    axes = {
        "material": [rubber(1), rubber(2), rubber(3)],
        "load": [1.0, 3.0],
        "velocity": VELOCITY,
    }
    return {
        "call": em.friction,
        "axes": axes,
        "shape": em.Sphere(0.01),
        "progress": False,
    } | more


class Here:
    """Computes in this process, of which tests change what they like."""

    def __init__(self, sent):
        self.sent, self._points = sent, unpacked(sent)["points"]

    def prepare(self, modules=()):
        return {}

    def compute(self, chunk):
        return run.compute(self._points, chunk)

    def close(self):
        pass


def small(monkeypatch, points=7):
    """Chunks of at most so many points, in this process."""
    monkeypatch.setattr(grids, "_POINTS", points)
    here(monkeypatch)


def here(monkeypatch):
    monkeypatch.setattr(run, "Process", Here)
    monkeypatch.setattr(run, "_cores", lambda: 1)


def as_read(call):
    """What is said of a call in a store, as it is read again."""
    return json.loads(json.dumps(described(packed({"call": call}))))


def test_every_point_is_that_of_a_call(tmp_path):
    found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert found.mu.dims == ("material", "load", "velocity")
    assert found.mu.attrs["units"] == "-"
    assert found.friction_force.attrs["units"] == "N"
    assert found.converged.dtype == bool
    assert (found.state == store.DONE).all()
    for k, load in ((1, 3.0), (3, 1.0)):
        alone = em.friction(rubber(k), em.Sphere(0.01), load=load, velocity=VELOCITY)
        one = found.sel(material=f"rubber {k}", load=load)
        np.testing.assert_allclose(one.mu, alone.mu, rtol=1e-12)
        np.testing.assert_allclose(one.model_error, alone.model_error, rtol=1e-12)
    assert json.loads(found.attrs["sweep"])["elastomdr"] == em.__version__
    # as a user without this package opens it
    again = xarray.open_zarr(tmp_path / "runs.zarr")
    np.testing.assert_array_equal(again.mu, found.mu)


@pytest.mark.parametrize(
    ("call", "axes", "fixed"),
    [
        (
            em.rolling,
            {
                "shape": [em.Sphere(0.01), em.Paraboloid(0.02)],
                "load": [1.0],
                "velocity": [0.1, 1.0],
            },
            {"material": rubber(1)},
        ),
        (
            em.impact,
            {"mass": [1e-3, 2e-3], "velocity": [0.5, 1.0]},
            {"material": rubber(1), "shape": em.Sphere(0.01)},
        ),
        (
            em.friction,
            {"model": ["multiscale", "persson"], "surface": [ROAD]},
            {"material": rubber(1), "pressure": 3e5, "velocity": 0.1},
        ),
        (
            em.friction,
            {"velocity": [0.1, 1.0], "temperature": [None, 293.15]},
            {"material": rubber(1), "shape": em.Sphere(0.01), "load": 1.0},
        ),
    ],
)
def test_axes_of_any_kind(call, axes, fixed, tmp_path):
    found = em.sweep(call, axes, store=tmp_path / "s.zarr", progress=False, **fixed)
    assert found.converged.values.all()
    assert found.converged.sizes == {name: len(values) for name, values in axes.items()}
    last = {name: values[-1] for name, values in axes.items()} | fixed
    shape = last.pop("shape", None) or last.pop("surface")
    alone = call(last.pop("material"), shape, **last)
    name = (
        "coefficient"
        if call is em.rolling
        else "restitution"
        if call is em.impact
        else "mu"
    )
    np.testing.assert_allclose(
        found[name].values.flat[-1], getattr(alone, name), rtol=1e-9
    )
    assert alone.model in found.attrs["model"].split(" | ")
    assert len(found.to_dataframe()) == found.converged.size


def test_goes_on_where_it_stopped(tmp_path, monkeypatch):
    """Interrupted after three chunks, it computes the other three, and the answer is
    the same.
    """
    small(monkeypatch)
    whole = em.sweep(**scene(store=tmp_path / "whole.zarr"))
    kept, done = [], []

    def interrupted(*chunk):
        if len(kept) == 3:
            raise KeyboardInterrupt
        kept.append(chunk)
        keep(*chunk)

    compute, keep = run.compute, store.ZarrStore.keep
    with monkeypatch.context() as patched:
        patched.setattr(store.ZarrStore, "keep", interrupted)
        with pytest.raises(KeyboardInterrupt):
            em.sweep(**scene(store=tmp_path / "runs.zarr"))
    monkeypatch.setattr(
        run, "compute", lambda *work: done.append(work[1]) or compute(*work)
    )
    found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert len(done) == 3
    assert (found.state == store.DONE).all()
    np.testing.assert_allclose(found.mu, whole.mu, rtol=1e-12)
    np.testing.assert_array_equal(found.converged, whole.converged)


def test_killed_alone(tmp_path):
    """The process that called is killed: its workers end by themselves; what was
    finished is in the store.
    """
    path, script = tmp_path / "runs.zarr", tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(f"""
        import time
        import elastomdr as em
        from elastomdr.sweeps import grid, run
        grid._POINTS, run._cores = 1, lambda: 2
        keep = run.ZarrStore.keep
        def slowly(*given):
            time.sleep(0.05)
            keep(*given)
        run.ZarrStore.keep = slowly
        em.sweep(em.friction, {{"load": [1.0 + i for i in range(60)]}}, store={str(path)!r}, progress=False,
                 material=em.Prony(1e6, [1e6], [1e-3]), shape=em.Sphere(0.01), velocity=0.1)
        """)
    )
    going = subprocess.Popen(
        [sys.executable, str(script)], start_new_session=True, stderr=subprocess.DEVNULL
    )
    started = psutil.Process(going.pid)
    try:
        end = time.monotonic() + 120
        while (
            time.monotonic() < end
            and going.poll() is None
            and not (path / "state" / "4").is_file()
        ):
            time.sleep(0.05)
        workers = started.children(recursive=True)
    finally:
        going.kill()
        going.wait()
    assert workers
    assert not psutil.wait_procs(workers, timeout=60)[1]
    states = np.asarray(xarray.open_zarr(path, consolidated=False).state)
    assert 0 < (states == store.DONE).sum() < 60


def test_a_store_of_other_inputs_is_refused(tmp_path, monkeypatch):
    em.sweep(**scene(store=tmp_path / "runs.zarr"))
    with pytest.raises(
        em.InputError, match=r"fixed\.shape\.radius was 0\.01 and is 0\.02"
    ):
        em.sweep(**scene(store=tmp_path / "runs.zarr", shape=em.Sphere(0.02)))
    axes = scene()["axes"] | {"load": [1.0, 4.0]}
    with pytest.raises(em.InputError, match=r"axes\.load\[1\] was 3\.0 and is 4\.0"):
        em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes))
    with refused("", '"friction"', '"rolling"'):
        em.sweep(**scene(store=tmp_path / "runs.zarr", call=em.rolling))
    monkeypatch.setattr(store, "__version__", "9.9")
    with pytest.raises(
        em.InputError, match=rf'elastomdr was "{em.__version__}" and is "9\.9"'
    ):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))


# a script before "->" what is changed in it, to what, and what is said of it
SCRIPTS = {
    "a global": (
        """
        RADIUS = 0.01
        def call(material, **rest):
            return em.friction(material, em.Sphere(RADIUS), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RADIUS was 0\.01 and is 0\.03"),
    ),
    "code": (
        """
        def call(material, **rest):
            return em.friction(material, em.Sphere(0.01), **rest)
        """,
        ("0.01", "0.03", r"call\.code was"),
    ),
    "an attribute of a partial": (
        """
        from functools import partial
        def ball(material, **rest):
            return em.friction(material, em.Sphere(call.radius), **rest)
        call = partial(ball)
        call.radius = 0.01
        """,
        ("0.01", "0.03", r"call.*radius was 0\.01 and is 0\.03"),
    ),
    "large whole numbers": (
        """
        import numpy as np
        SEEDS = np.arange(20) + 9007199254740992
        def call(material, **rest):
            return em.friction(material, em.Sphere(0.01 * SEEDS[1]), **rest)
        """,
        (
            "np.arange(20) + 9007199254740992",
            "np.arange(20) // 2 * 2 + 9007199254740992",
            r"call\.uses\.SEEDS\[0\] was",
        ),
    ),
    "a field whose type is one of two": (
        """
        from dataclasses import dataclass
        @dataclass
        class Rig:
            radius: float = 0.01
            load: float | None = None
            steps: list[float] | None = None
        def call(material, **rest):
            return em.friction(material, em.Sphere(Rig().radius), **rest)
        """,
        ("0.01", "0.03", r"call.*radius"),
    ),
    "the names of arguments": (
        """
        def call(a, b, *, material, **rest):
            return em.friction(material, em.Sphere(a - b), **rest)
        """,
        ("(a, b,", "(b, a,", r"call\.code was"),
    ),
    "a default": (
        """
        def call(material, radius=0.01, **rest):
            return em.friction(material, em.Sphere(radius), **rest)
        """,
        ("0.01", "0.03", r"call\.__defaults__\[0\] was"),
    ),
    "a helper of a helper": (
        """
        def radius(): return 0.01
        def ball(): return em.Sphere(radius())
        def call(material, **rest): return em.friction(material, ball(), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.ball\.uses\.radius\.code was"),
    ),
    "functions that call each other": (
        """
        def odd(n): return 0.01 if n == 0 else even(n - 1)
        def even(n): return 0.02 if n == 0 else odd(n - 1)
        def call(material, **rest):
            return em.friction(material, em.Sphere(odd(3)), **rest)
        """,
        ("0.02", "0.03", r"call\.uses\.odd\.uses\.even\.code was"),
    ),
    "a global of a function within": (
        """
        RADIUS = 0.01
        def call(material, **rest):
            ball = lambda: [em.Sphere(RADIUS) for _ in (1,)][0]
            return em.friction(material, ball(), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RADIUS was"),
    ),
    "a lambda": (
        """
        RADIUS = 0.01
        call = lambda material, **rest: em.friction(material, em.Sphere(RADIUS), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RADIUS was"),
    ),
    "a partial": (
        """
        import functools
        friction = functools.partial(em.friction, shape=em.Sphere(0.01))
        def call(material, **rest): return friction(material, **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.friction.*radius was"),
    ),
    "an object of a method": (
        """
        class Rig:
            def __init__(self, radius): self.radius = radius
            def call(self, material, **rest):
                return em.friction(material, em.Sphere(self.radius), **rest)
        call = Rig(0.01).call
        """,
        ("0.01", "0.03", r"call.*\.radius was 0\.01"),
    ),
    "a method that a method calls": (
        """
        class Base:
            __slots__ = ("scale",)
            def radius(self): return 0.01 * self.scale
        class Rig(Base):
            def call(self, material, **rest):
                return em.friction(material, em.Sphere(self.radius()), **rest)
        rig = Rig()
        rig.scale = 1.0
        call = rig.call
        """,
        ("0.01", "0.03", r"call.*\.radius\.code was"),
    ),
    "a slot": (
        """
        class Rig:
            __slots__ = ("radius",)
        RIG = Rig()
        RIG.radius = 0.01
        def call(material, **rest):
            return em.friction(material, em.Sphere(RIG.radius), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RIG.* was .*0\.01"),
    ),
    "a property": (
        """
        class Rig:
            @property
            def radius(self): return 0.01
        def call(material, **rest):
            return em.friction(material, em.Sphere(Rig().radius), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.Rig\.radius\[0\]\.code was"),
    ),
    "what is decorated": (
        """
        import functools
        def twice(function):
            @functools.wraps(function)
            def wrapper(*given, **named): return function(*given, **named)
            return wrapper
        @twice
        def call(material, **rest):
            return em.friction(material, em.Sphere(0.01), **rest)
        """,
        ("0.01", "0.03", r"call.*\.code was"),
    ),
    "what wears the name of a verb": (
        """
        import functools
        @functools.wraps(em.friction)
        def call(material, **rest):
            return em.friction(material, em.Sphere(0.01), **rest)
        """,
        ("0.01", "0.03", r"call\.code was"),
    ),
    "what is cached": (
        """
        import functools
        @functools.lru_cache
        def ball(): return em.Sphere(0.01)
        def call(material, **rest): return em.friction(material, ball(), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.ball\[0\]\.code was"),
    ),
    "a dictionary": (
        """
        RIGS = {"a": {1: [0.01, None]}}
        def call(material, **rest):
            return em.friction(material, em.Sphere(RIGS["a"][1][0]), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RIGS\.a\.\(1\)\[0\] was 0\.01"),
    ),
    "objects in an array": (
        """
        import numpy as np
        RADII = np.array([0.01, None], dtype=object)
        def call(material, **rest):
            return em.friction(material, em.Sphere(RADII[0]), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RADII.*\[0\] was 0\.01"),
    ),
    "an object of another package": (
        """
        from fractions import Fraction
        RIG = Fraction(1, 100)
        def call(material, **rest):
            return em.friction(material, em.Sphere(float(RIG)), **rest)
        """,
        ("1, 100", "3, 100", r"call\.uses\.RIG\[0\] was 1 and is 3"),
    ),
    "an attribute of a metaclass": (
        """
        class Kind(type):
            radius = 0.01
        class Rig(metaclass=Kind): pass
        def call(material, **rest):
            return em.friction(material, em.Sphere(Rig.radius), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.Rig\[0\]\.radius was"),
    ),
    "an attribute of a function": (
        """
        def call(material, **rest):
            return em.friction(material, em.Sphere(call.radius), **rest)
        call.radius = 0.01
        """,
        ("0.01", "0.03", r"call\.attributes\.radius was"),
    ),
    "a class that repr does not tell apart": (
        """
        class Rig:
            def __init__(self, radius): self.radius = radius
            def __repr__(self): return "Rig()"
        RIG = Rig(0.01)
        def call(material, **rest):
            return em.friction(material, em.Sphere(RIG.radius), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RIG\.radius was"),
    ),
    "a list in itself": (
        """
        RADII = [0.01]
        RADII.append(RADII)
        def call(material, **rest):
            return em.friction(material, em.Sphere(RADII[0]), **rest)
        """,
        ("0.01", "0.03", r"call\.uses\.RADII\[0\] was"),
    ),
}


def run_as_script(text):
    """The globals of a script, as an interpreter or a notebook has them."""
    space = {"__name__": "__main__", "em": em}
    exec(textwrap.dedent(text), space)
    return space


@pytest.mark.parametrize(
    ("script", "change"), SCRIPTS.values(), ids=list(SCRIPTS.keys())
)
def test_whatever_a_call_refers_to_is_part_of_it(script, change):
    old, new, said = change
    assert script.count(old) == 1
    made, same, other = (
        as_read(run_as_script(text)["call"])
        for text in (script, "\n\n" + script, script.replace(old, new))
    )
    assert not difference(made, same)
    assert re.match(said, difference(made, other))


# what a script may refer to, with a 1 of which something is changed
KINDS = {
    "dataclasses.make_dataclass": """
        import dataclasses
        Rig = dataclasses.make_dataclass("Rig", [("radius", float, 1)])
        def call(): return Rig().radius
        """,
    "types.new_class": """
        import types
        Rig = types.new_class("Rig", (), {}, lambda space: space.update(radius=1))
        def call(): return Rig.radius
        """,
    "type()": """
        Rig = type("Rig", (), {"radius": 1})
        def call(): return Rig.radius
        """,
    "type() that says that it is Python's": """
        Rig = type("Fraction", (), {"radius": 1, "__module__": "fractions"})
        def call(): return Rig.radius
        """,
    "annotations": """
        class Rig:
            radius: 1
        def call(): return Rig.__annotations__["radius"]
        """,
    "annotations of a function": """
        def rig(radius: 1): pass
        def call(): return rig.__annotations__["radius"]
        """,
    "a text about a class": """
        class Rig:
            "1"
        def call(): return float(Rig.__doc__)
        """,
    "a text about a function": """
        def rig(): "1"
        def call(): return float(rig.__doc__)
        """,
    "the name of a class": """
        Rig = type("Rig1", (), {})
        def call(): return Rig.__name__
        """,
    "NamedTuple": """
        from typing import NamedTuple
        class Rig(NamedTuple):
            radius: float = 1
        def call(): return Rig().radius
        """,
    "namedtuple": """
        import collections
        Rig = collections.namedtuple("Rig", "radius", defaults=[1])
        def call(): return Rig().radius
        """,
    "a named tuple": """
        import collections
        RIG = collections.namedtuple("Rig", "radius")(1)
        def call(): return RIG.radius
        """,
    "Enum": """
        import enum
        class Rig(enum.Enum):
            SMALL = 1
        def call(): return Rig.SMALL.value
        """,
    "IntEnum": """
        import enum
        class Rig(enum.IntEnum):
            SMALL = 1
        SMALL = Rig.SMALL
        def call(): return SMALL + 0
        """,
    "StrEnum": """
        import enum
        class Rig(enum.StrEnum):
            SMALL = "1"
        def call(): return Rig.SMALL
        """,
    "Flag": """
        import enum
        class Rig(enum.Flag):
            SMALL = 1
        def call(): return Rig.SMALL
        """,
    "complex": "RIG = 1 + 2j\ndef call(): return RIG",
    "range": "RIG = range(1, 3)\ndef call(): return RIG[0]",
    "slice": "RIG = slice(1, 3)\ndef call(): return RIG",
    "bytes": "RIG = b'1'\ndef call(): return RIG",
    "bytearray": "RIG = bytearray(b'1')\ndef call(): return RIG",
    "Decimal": "import decimal\nRIG = decimal.Decimal(1)\ndef call(): return RIG",
    "a date": "import datetime\nRIG = datetime.date(2020, 1, 2)\ndef call(): return RIG",
    "re.Pattern": "import re\nRIG = re.compile('1')\ndef call(): return RIG",
    "OrderedDict": """
        import collections
        RIG = collections.OrderedDict(a=1)
        def call(): return RIG["a"]
        """,
    "Counter": """
        import collections
        RIG = collections.Counter({"a": 1})
        def call(): return RIG["a"]
        """,
    "defaultdict": """
        import collections
        RIG = collections.defaultdict(lambda: 1)
        def call(): return RIG["a"]
        """,
    "deque": """
        import collections
        RIG = collections.deque([1])
        def call(): return RIG[0]
        """,
    "ChainMap": """
        import collections
        RIG = collections.ChainMap({"a": 1})
        def call(): return RIG["a"]
        """,
    "a class derived from dict": """
        class Rig(dict):
            def __missing__(self, key): return RADIUS
        RADIUS, RIG = 1, Rig()
        def call(): return RIG["a"]
        """,
    "an attribute of a dict": """
        class Rig(dict): pass
        RIG = Rig()
        RIG.radius = 1
        def call(): return RIG.radius
        """,
    "an attribute of a number": """
        class Rig(float): pass
        RIG = Rig(2)
        RIG.radius = 1
        def call(): return RIG.radius
        """,
    "np.dtype": """
        import numpy as np
        RIG = np.dtype([("a1", float)])
        def call(): return RIG.names
        """,
    "a masked array": """
        import numpy as np
        RIG = np.ma.array([1.0, 2.0], mask=[0, 1])
        def call(): return RIG.sum()
        """,
    "an array with fields": """
        import numpy as np
        RIG = np.array([(1.0, 2)], dtype=[("a", float), ("b", int)])
        def call(): return RIG["a"]
        """,
    "a random generator": """
        import numpy as np
        RIG = np.random.default_rng(1)
        def call(): return RIG.normal()
        """,
    "np.vectorize": """
        import numpy as np
        RIG = np.vectorize(lambda x: x + 1)
        def call(): return RIG(2)
        """,
    "a polynomial": """
        import numpy as np
        RIG = np.polynomial.Polynomial([1, 3])
        def call(): return RIG(2)
        """,
    "a spline": """
        import numpy as np
        from scipy.interpolate import CubicSpline
        RIG = CubicSpline(np.arange(4), np.array([0, 1, 4, 2]))
        def call(): return RIG(1.5)
        """,
    "DataFrame": """
        import pandas
        RIG = pandas.DataFrame({"radius": [1]})
        def call(): return RIG["radius"][0]
        """,
    "Series": """
        import pandas
        RIG = pandas.Series({"radius": 1})
        def call(): return RIG["radius"]
        """,
    "operator.itemgetter": """
        import operator
        RIG = operator.itemgetter(1)
        def call(): return RIG([2, 3])
        """,
    "operator.methodcaller": """
        import operator
        RIG = operator.methodcaller("count", 1)
        def call(): return RIG([2, 3])
        """,
    "Protocol": """
        from typing import Protocol
        class Body(Protocol):
            def radius(self) -> float: ...
        class Ball:
            def radius(self): return 1
        def call(body: Body = Ball()): return body.radius()
        """,
    "Generic": """
        from typing import Generic, TypeVar
        T = TypeVar("T")
        class Rig(Generic[T]):
            radius = 1
        def call(): return Rig[int].radius
        """,
    "abc": """
        import abc
        class Body(abc.ABC):
            @abc.abstractmethod
            def radius(self): ...
        class Ball(Body):
            def radius(self): return 1
        def call(): return Ball().radius()
        """,
    "a descriptor": """
        class Radius:
            def __get__(self, *_): return 1
        class Rig:
            radius = Radius()
        def call(): return Rig().radius
        """,
    "cached_property": """
        import functools
        class Rig:
            @functools.cached_property
            def radius(self): return 1
        def call(): return Rig().radius
        """,
    "singledispatchmethod": """
        import functools
        class Rig:
            @classmethod
            def radius(cls): return 1
        def call(): return Rig.radius()
        """,
    "staticmethod": """
        class Rig:
            @staticmethod
            def radius(): return 1
        def call(): return Rig.radius()
        """,
    "__call__": """
        class Rig:
            def __call__(self): return 1
        RIG = Rig()
        def call(): return RIG()
        """,
    "__getattr__": """
        class Rig:
            def __getattr__(self, name): return 1
        def call(): return Rig().radius
        """,
    "__init_subclass__": """
        class Rig:
            def __init_subclass__(cls): cls.radius = 1
        class Small(Rig): pass
        def call(): return Small.radius
        """,
    "a metaclass that calls": """
        class Kind(type):
            def __call__(cls): return 1
        class Rig(metaclass=Kind): pass
        def call(): return Rig()
        """,
    "a method that is set later": """
        class Rig: pass
        Rig.radius = lambda self: 1
        def call(): return Rig().radius()
        """,
    "code that is set later": """
        def rig(): return 2
        rig.__code__ = (lambda: 1).__code__
        def call(): return rig()
        """,
    "defaults that are set later": """
        def rig(radius=2): return radius
        rig.__defaults__ = (1,)
        def call(): return rig()
        """,
    "defaults by their names": """
        def rig(*, radius=1): return radius
        def call(): return rig()
        """,
    "a cell": """
        def made(radius):
            def inner(): return radius
            return inner
        rig = made(1)
        def call(): return rig()
        """,
    "a cell that another function sets": """
        def made():
            radius = 2
            def put(value):
                nonlocal radius
                radius = value
            return put, lambda: radius
        put, rig = made()
        put(1)
        def call(): return rig()
        """,
    "a local partial": """
        import functools
        rig = functools.partial(max, 1)
        def call(): return rig(0)
        """,
    "partialmethod": """
        import functools
        class Rig:
            def _radius(self, value): return value
            radius = functools.partialmethod(_radius, 1)
        def call(): return Rig().radius()
        """,
    "a bound method of a list": """
        rig = [2, 1].index
        def call(): return rig(2)
        """,
    "SimpleNamespace": """
        import types
        RIG = types.SimpleNamespace(radius=1)
        def call(): return RIG.radius
        """,
    "a module that is made": """
        import types
        rig = types.ModuleType("rig")
        rig.radius = 1
        def call(): return rig.radius
        """,
    "a name that hides Python's": """
        def max(*given): return 1
        def call(): return max(2, 3)
        """,
    "what catches": """
        RADIUS = 1
        def call():
            try: raise ValueError
            except ValueError: return RADIUS
        """,
    "a match": """
        RADIUS = 1
        def call(x=2):
            match x:
                case 2: return RADIUS
        """,
    "a generator within": """
        RADIUS = 1
        def call(): return sum(RADIUS for _ in range(2))
        """,
    "an order of entries": """
        RIG = {"a": 1, "b": 2} if 1 == 1 else {"b": 2, "a": 1}
        def call(): return next(iter(RIG))
        """,
}


@pytest.mark.parametrize("script", KINDS.values(), ids=list(KINDS))
def test_whatever_kind_of_thing_a_call_refers_to(script):
    """It can be compared, the same again is the same, and what is changed is not."""
    script = textwrap.dedent(script)
    made, again = (as_read(run_as_script(script)["call"]) for _ in range(2))
    assert not difference(made, again)
    i = script.index("1")
    other = as_read(run_as_script(script[:i] + "3" + script[i + 1 :])["call"])
    assert difference(made, other)


# what a script sets in what is installed
SET = {
    "numpy.RADIUS": "np.RADIUS = 0.01",
    "numpy.pi": "np.pi = 3.0",
    "numpy.sin": "np.sin = lambda x: 0.01",
    "numpy.cos": "np.cos = np.sin",
    "builtins.RADIUS": "import builtins; builtins.RADIUS = 0.01",
    "math.pi": "import math; math.pi = 3.0",
    "scipy.constants.g": "import scipy.constants; scipy.constants.g = 9.0",
    "elastomdr.friction": "em.friction = em.rolling",
    "elastomdr.surface.shapes.Sphere.RADIUS": "em.Sphere.RADIUS = 0.01",
    "elastomdr.surface.shapes.Sphere.__init__": "em.Sphere.__init__ = em.Paraboloid.__init__",
    "decimal.getcontext().prec": "import decimal; decimal.getcontext().prec = 3",
}


def test_what_a_script_sets_in_what_is_installed_is_refused(tmp_path):
    """A process that computes does not have it: neither the first time, nor where the
    store is whole.
    """
    (tmp_path / "script.py").write_text(
        textwrap.dedent(f"""
        import numpy as np
        import scipy.constants
        import decimal
        import elastomdr as em
        def call(material, shape, **rest):
            np, scipy.constants, decimal
            return friction(material, shape, **rest)
        friction, given = em.friction, {{
            "material": em.Prony(1e6, [1e6], [1e-3]), "shape": em.Sphere(0.01),
            "velocity": 0.1, "store": "runs.zarr", "progress": False,
        }}
        em.sweep(call, {{"load": [1.0, 2.0]}}, **given)
        for name, line in {SET!r}.items():
            owner, _, key = name.rpartition(".")
            owner = eval(owner, {{"elastomdr": em, "numpy": np, **vars(__import__("sys"))["modules"]}}) if "(" not in name else None
            before = vars(owner).get(key) if owner else None
            exec(line)
            try:
                em.sweep(call, {{"load": [1.0, 2.0]}}, **given)
                print(name, "is not seen")
            except em.InputError as error:
                print(error.hint.partition("; set")[0])
            if owner is None:
                decimal.getcontext().prec = 28
            elif before is None:
                delattr(owner, key)
            else:
                setattr(owner, key, before)
        print(float(em.sweep(call, {{"load": [1.0, 2.0]}}, **given)["load"][1]))
        """)
    )
    told = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True
    )
    assert told.stdout.splitlines() == [*SET, "2.0"], told.stderr


# ways to what is not sent
WAYS = {
    "globals()": "globals()['RADIUS']",
    "eval": "eval('RADIUS')",
    "a module by its name": "sys.modules['__main__'].RADIUS",
    "a frame": "sys._getframe().f_back.f_globals['RADIUS']",
    "a file beside the script": "importlib.import_module('rig').RADIUS",
    "a function's globals": "call.__globals__['RADIUS']",
    "classes that nobody names": "Rig.__subclasses__()[0].radius",
    "all objects": "[x for x in gc.get_objects() if type(x) is Rig][0].radius",
}


def test_what_a_call_reaches_otherwise_is_not_there(tmp_path):
    """So its calls raise, and no number rests on it."""
    (tmp_path / "rig.py").write_text("RADIUS = 0.01")
    (tmp_path / "script.py").write_text(
        textwrap.dedent("""
        import gc, importlib, sys, warnings
        import elastomdr as em
        RADIUS = 0.01
        class Rig: pass
        class Small(Rig): radius = 0.01
        RIG = Rig()
        RIG.radius = 0.01
        warnings.simplefilter("ignore")
        """)
        + "\n".join(
            f"def call(load): return em.friction(em.Prony(1e6, [1e6], [1e-3]), "
            f"em.Sphere({way}), load=load, velocity=0.1)\n"
            f"call(1.0) if {way!r}[:3] != 'sys' else None\n"
            f"found = em.sweep(call, {{'load': [1.0, 2.0]}}, store='{i}.zarr', "
            "progress=False)\n"
            "print(found.state.values.tolist(), 'mu' in found)"
            for i, way in enumerate(WAYS.values())
        )
    )
    told = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, capture_output=True, text=True
    )
    assert told.stdout.splitlines() == ["[2, 2] False"] * len(WAYS), told.stderr


def test_what_a_class_leaves_out_when_it_is_pickled_is_refused():
    class Rig:
        def __reduce__(self):
            return Rig, ()

    class State:
        __slots__ = ("radius",)

        def __getstate__(self):
            return None

    class Entries(dict):
        def __reduce__(self):
            return Entries, ()

    class Whole:
        def __init__(self, radius):
            self.radius, self.area = radius, np.array([radius**2])

        def __reduce__(self):
            return Whole, (self.radius,)

    rigs = [Rig(), State(), Entries(radius=0.01)]
    rigs[0].radius = rigs[1].radius = 0.01
    for rig in rigs:
        said = f"{type(rig).__name__} leaves something out when it is pickled"
        with pytest.raises(em.InputError, match=said):
            packed({"call": rig})
    assert difference(as_read(Whole(0.01)), as_read(Whole(0.03)))


def test_an_ordinary_script_goes_on_in_another_process(tmp_path):
    """Whatever the seed of hashes; a comment is none of its numbers, and each of its
    values is.
    """
    script = textwrap.dedent("""
        import collections, enum, functools, logging, threading
        from dataclasses import dataclass, field
        from typing import NamedTuple
        import jax
        import numpy as np
        import pandas
        import elastomdr as em
        from rig import Ball
        class Size(enum.IntEnum):
            SMALL = 1
            LARGE = 2
        class Place(NamedTuple):
            x: float = 0.0
        @dataclass
        class Rig:
            size: Size = Size.SMALL
            places: set[str] = field(default_factory=lambda: {"a", "b", "c", "d"})
        TABLE = pandas.DataFrame({"radius": [0.01, 0.02]}, index=["a", "b"])
        NAMES = {"left", "right", "up", "down"}
        LOCK, LOG = threading.Lock(), logging.getLogger("rig")
        KEPT = collections.OrderedDict(a=collections.Counter("abc"))
        @functools.lru_cache
        def radius(size): return float(TABLE["radius"]["a"]) * size
        @jax.jit
        def scaled(x): return x * 1.0
        @functools.singledispatch
        def ball(size): return Ball(radius(size))
        def call(material, rig=Rig(), place=Place(), **rest):
            with LOCK:
                LOG.debug("%s %s", sorted(NAMES), KEPT["a"].most_common(1))
            scale = float(scaled(1.0))
            return em.friction(material, ball(rig.size).shape(scale), **rest)
        try:
            found = em.sweep(call, {"load": [1.0, 2.0]}, store="runs.zarr", velocity=0.1,
                             material=em.Prony(1e6, [1e6], [1e-3]), progress=False)
            print(found.mu.values.tolist())
        except em.InputError as error:
            print(error)
        """)
    helper = textwrap.dedent("""
        import threading
        import elastomdr as em
        _lock, _numbers = threading.RLock(), (i for i in range(3))
        class Ball:
            def __init__(self, radius): self.radius = radius
            def shape(self, scale):
                from sizes import FACTOR
                return em.Sphere(self.radius * scale * FACTOR)
        """)
    seeds = iter("12345678")

    def run_with(old="", new="", factor=1.0):
        (tmp_path / "script.py").write_text(script.replace(old, new, 1))
        (tmp_path / "rig.py").write_text(helper)
        (tmp_path / "sizes.py").write_text(f"FACTOR = {factor}")
        environment = os.environ | {"PYTHONHASHSEED": next(seeds)}
        return subprocess.run(
            [sys.executable, "-B", str(tmp_path / "script.py")],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            check=True,
        ).stdout

    first = run_with()
    alone = em.friction(
        em.Prony(1e6, [1e6], [1e-3]), em.Sphere(0.01), load=[1.0, 2.0], velocity=0.1
    )
    np.testing.assert_allclose(json.loads(first), alone.mu, rtol=1e-12)
    assert run_with("try:", "# a comment\ntry:") == first
    assert "was 0.01 and is 0.03" in run_with("0.01", "0.03")
    assert "imports.sizes.FACTOR was 1.0 and is 3.0" in run_with(factor=3.0)


@pytest.mark.parametrize(
    "use",
    [
        "import rig\ndef call(): return rig.geometry.ball()",
        "from rig import geometry\ndef call(): return geometry.ball()",
        "from rig.geometry import ball\ndef call(): return ball()",
        "def call():\n import rig.geometry\n return rig.geometry.ball()",
        "def call():\n import rig.geometry\n return rig.ball()",
        "def call():\n import rig.geometry as g\n return g.ball()",
        "def call():\n from rig.geometry import ball\n return ball()",
        "def call():\n from rig import geometry\n return geometry.ball()",
        "def call():\n from rig import apart\n return apart.ball()",
    ],
)
def test_modules_of_the_user_are_part_of_a_call(use, tmp_path, monkeypatch):
    """Their files, what they import relatively, and values that are set at run time."""
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.syspath_prepend(tmp_path)
    for name in ("rig", "rig.geometry", "rig.sizes"):
        monkeypatch.setitem(sys.modules, name, None)

    def told(radius, scale=1.0):
        for name in [name for name in sys.modules if name.partition(".")[0] == "rig"]:
            del sys.modules[name]
        folder = tmp_path / "rig"
        folder.mkdir(exist_ok=True)
        (folder / "__init__.py").write_text(
            "from . import geometry\ndef ball(): return geometry.ball()"
        )
        (folder / "sizes.py").write_text(f"SCALE = 1.0\nRADIUS = {radius}")
        (folder / "geometry.py").write_text(
            "from . import sizes\ndef ball():\n"
            "    from .sizes import RADIUS\n    return RADIUS * sizes.SCALE"
        )
        # which nothing imports but the call
        (folder / "apart.py").write_text("from .geometry import ball")
        call = run_as_script(use)["call"]
        assert call() == radius
        sys.modules["rig.sizes"].SCALE = scale
        return as_read(call)

    assert not difference(told(0.01), told(0.01))
    assert re.search(
        r"RADIUS was 0\.01 and is 0\.03", difference(told(0.01), told(0.03))
    )
    assert re.search(
        r"SCALE was 1\.0 and is 2\.0", difference(told(0.01), told(0.01, 2.0))
    )


def test_a_script_that_is_run_twice(tmp_path):
    """With a helper beside it, which processes that compute have as this one has it."""
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "rig.py").write_text("SCALE = 1.0\ndef radius(): return 0.01 * SCALE")
    (tmp_path / "script.py").write_text(
        textwrap.dedent("""
        import sys
        import elastomdr as em
        from elastomdr.sweeps import grid, run
        import rig
        grid._POINTS, run._cores = 1, lambda: 2
        rig.SCALE = float(sys.argv[1])
        def call(material, **rest):
            return em.friction(material, em.Sphere(rig.radius()), **rest)
        try:
            found = em.sweep(call, {"load": [1.0, 2.0]}, store="runs.zarr", velocity=0.1,
                             material=em.Prony(1e6, [1e6], [1e-3]), progress=False)
            print(found.mu.values.tolist())
        except em.InputError as error:
            print(error)
        """)
    )

    def run_script(scale):
        return subprocess.run(
            [sys.executable, str(tmp_path / "script.py"), scale],
            cwd=tmp_path / "elsewhere",
            capture_output=True,
            text=True,
            check=True,
        ).stdout

    alone = em.friction(
        em.Prony(1e6, [1e6], [1e-3]), em.Sphere(0.03), load=[1.0, 2.0], velocity=0.1
    )
    first = run_script("3.0")
    np.testing.assert_allclose(json.loads(first), alone.mu, rtol=1e-12)
    assert run_script("3.0") == first
    assert "call.uses.rig.SCALE was 3.0 and is 1.0" in run_script("1.0")


def test_what_cannot_be_sent_is_refused_at_once(tmp_path):
    """Before there is a store, in a line."""
    chain = None
    for _ in range(10_000):
        chain = SimpleNamespace(next=chain)
    for what, said in ((chain, "deep"), ((x for x in [1.0]), "generator")):

        def call(material, what=what, **rest):
            return em.friction(material, **rest)

        with refused("call", said):
            em.sweep(**scene(call=call, store=tmp_path / "runs.zarr"))
    assert not (tmp_path / "runs.zarr").exists()


def test_what_says_the_same_is_the_same():
    """NaN, and packages that are installed, whose version decides."""
    for value in (np.nan, [np.nan, "a"], {"a": np.nan}, np.sin, np.linalg.norm, np):
        assert not difference(as_read(value), as_read(value))
    assert as_read(em.friction)["call"] == {"": "friction"}
    assert not as_read(em.friction)["installed"], "numbers outlive their packages"
    assert as_read(lambda x: np.sin(x))["installed"]["numpy"] == np.__version__
    for one, other in (
        (10**30, 10**30 + 1),
        ([10**400], [10**400 + 1]),
        (1, True),
        (1, 1.0),
        (0.0, -0.0),
        (0.1, np.float64(0.1)),
        ("numpy.sin", np.sin),
        ([1.0, 2.0], (1.0, 2.0)),
        ([1.0, 2.0], np.array([1.0, 2.0])),
        (np.ones(3), np.ones(3, np.float32)),
        (np.ones((2, 3)), np.ones((2, 3), order="F")),
        ({"a": 1, "b": 2}, {"b": 2, "a": 1}),
        ({1: 2}, {"1": 2}),
        ({"(1)": 2}, {1: 2}),
        ("a" * 2000, b"a" * 2000),
        ([0.5] * 200, [0.5] * 201),
        (dict(zip("ab", [[]] * 2, strict=True)), {"a": [], "b": []}),
    ):
        assert difference(as_read(one), as_read(other)), (one, other)


def test_what_a_store_is_made_of_is_the_same_in_every_process():
    x = np.linspace(0, 1e-2, 200)
    given = [
        rubber(1),
        em.load_material("epdm-70-softening"),
        EPDM.draws(3),
        em.Foundation(1e6, [1e6], [1.0]),
        em.layer(rubber(1), 1e-3),
        em.springs(rubber(1), 1e-3, bonded=False),
        em.half_space(rubber(1)),
        em.Profile(x, x**2),
        em.RoughLine(x, np.sin(x)),
        ROAD.draws(200, level=0.1),
        em.Line(seeds=2),
        em.HalfSpace(),
        em.Persson(),
        em.Heat(0.2, 2e6),
        em.AdhesiveShear(1e6, 0.1, 0.3),
        None,
        Path("a"),
    ]
    told = json.dumps(as_read(given))
    assert " at 0x" not in told
    assert json.dumps(as_read(pickle.loads(pickle.dumps(given)))) == told


def test_one_at_a_time(tmp_path):
    (tmp_path / "same.zarr").symlink_to(tmp_path / "runs.zarr")
    with FileLock(tmp_path / ".runs.zarr.lock"):
        for name in ("runs.zarr", "same.zarr"):
            with refused("", "another process"):
                em.sweep(**scene(store=tmp_path / name))


def spoil_chunk(file):
    data = bytearray(file.read_bytes())
    data[-3] ^= 1
    file.write_bytes(data)


# which file, what becomes of it, how many of the three chunks are computed again
SPOILT = {
    "a chunk is gone": ("mu/1.0.0", Path.unlink, 1),
    "a chunk is cut": ("mu/1.0.0", lambda file: os.truncate(file, 5), 1),
    "a chunk is empty": ("converged/2.0.0", lambda file: os.truncate(file, 0), 1),
    "a bit of a chunk": ("error/0.0.0", spoil_chunk, 1),
    "a record is cut": ("state/.record/chunk.2", lambda file: os.truncate(file, 9), 1),
    "a record of an array is gone": ("state/.record/array.mu", Path.unlink, 3),
    "a state is cut": ("state/0.0.0", lambda file: os.truncate(file, 1), 1),
    "an array is gone": ("mu", shutil.rmtree, 3),
    "what says what an array is is gone": ("mu/.zarray", Path.unlink, 3),
    "the state is gone": ("state/.zarray", Path.unlink, 3),
}


@pytest.mark.parametrize("spoilt", SPOILT.values(), ids=SPOILT.keys())
def test_what_is_damaged_is_computed_again_and_said(spoilt, tmp_path, monkeypatch):
    small(monkeypatch, 14)
    place, spoil, count = spoilt
    whole = em.sweep(**scene(store=tmp_path / "runs.zarr")).load()
    spoil(tmp_path / "runs.zarr" / place)
    done = []
    compute = run.compute
    monkeypatch.setattr(
        run, "compute", lambda *work: done.append(work[1]) or compute(*work)
    )
    array = place.removesuffix(".zarray").replace("state/.record/array.", "")
    said = f"{count} of 3 chunks .* damaged .* first: '{array}"
    with pytest.warns(UserWarning, match=said):
        found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert len(done) == count
    xarray.testing.assert_identical(found.load(), whole)
    # now it is whole, and nothing is said
    em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert len(done) == count


SMALL = {"axes": {"load": [1.0, 3.0]}, "material": rubber(1), "velocity": 0.1}


@pytest.fixture(scope="module")
def small_store(tmp_path_factory):
    """The store of a sweep over two loads."""
    place = tmp_path_factory.mktemp("small") / "runs.zarr"
    em.sweep(**scene(**SMALL, store=place))
    return place


@pytest.mark.parametrize(
    "change", [b"", b"{", b"[]", b'{"zarr_format": 2}', b'{"zarr_format": 3}']
)
@pytest.mark.parametrize(
    "place",
    [".zgroup", ".zattrs", "mu/.zarray", "mu/.zattrs", "load/.zarray"],
)
def test_a_store_whose_metadata_are_spoilt_is_refused_in_a_line(
    place, change, small_store, tmp_path
):
    if (place, change) == (".zgroup", b'{"zarr_format": 2}'):
        return  # this is what it was
    spoilt = shutil.copytree(small_store, tmp_path / "runs.zarr")
    (spoilt / place).write_bytes(change)
    with refused("", "em.sweep") as said:
        em.sweep(**scene(**SMALL, store=spoilt))
    assert "\n" not in str(said.value)


def test_a_folder_of_somebody_else_is_left_alone(tmp_path):
    (tmp_path / "letters.txt").write_text("dear")
    with pytest.raises(em.InputError, match="new folder"):
        em.sweep(**scene(store=tmp_path))
    assert (tmp_path / "letters.txt").read_text() == "dear"


def test_what_raises_keeps_its_message_and_stops_nothing(tmp_path, monkeypatch):
    small(monkeypatch)
    axes = {"material": [rubber(1), "no such rubber", rubber(3)], "velocity": VELOCITY}
    with pytest.warns(em.ConvergenceWarning, match="1 of 3 chunks"):
        found = em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes, load=1.0))
    assert found.state[:, 0].values.tolist() == [store.DONE, store.RAISED, store.DONE]
    assert np.isnan(found.mu[1]).all()
    assert not found.converged[1].any()
    assert np.isfinite(found.mu[[0, 2]]).all()
    assert mentions(found.attrs["raised"][0], "no such rubber", "InputError: material")
    assert len(found.attrs["raised"]) == 1


def test_progress_says_how_long_it_will_take(tmp_path, monkeypatch, capsys):
    small(monkeypatch)
    bar = tqdm.tqdm
    monkeypatch.setattr(
        tqdm, "tqdm", lambda **given: bar(**(given | {"delay": 0, "mininterval": 0}))
    )
    em.sweep(**scene(store=tmp_path / "runs.zarr", progress=True))
    assert re.search(r" 7.00/42.0 \[\d\d:\d\d<\d\d:\d\d,", capsys.readouterr().err)


def test_points_that_do_not_converge_are_nan_and_flagged(tmp_path):
    axes = {
        "material": [em.Maxwell(1e6, 1e-2, name="liquid"), rubber(1)],
        "velocity": VELOCITY,
    }
    for _ in range(2):  # the second time from the store
        with warned(em.ConvergenceWarning, 7, 14):
            found = em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes, load=1.0))
    assert np.isnan(found.mu[0]).all()
    assert not found.converged[0].any()
    assert np.isfinite(found.mu[1]).all()
    assert found.converged[1].all()


def test_chunks_hold_whole_calls_and_are_many():
    """A call does all of its arrays; enough chunks that no worker waits long; few
    points where each takes a second.
    """

    def sizes(materials, **fixed):
        arrays = {
            "pressure": [1e5] * 4,
            "temperature": [300.0] * 5,
            "velocity": [1.0] * 50,
        }
        road = em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)
        axes = {"material": [rubber(1)] * materials, "surface": [road] * 10} | arrays
        return grids.grid(em.friction, axes, fixed).sizes()

    assert sizes(100) == (1, 5, 4, 5, 50)
    assert sizes(3) == (1, 2, 4, 5, 50)
    assert sizes(3, model=em.Line(seeds=2)) == (1, 1, 1, 1, 50)
    for model in ("half-space", em.HalfSpace(cells=64)):
        assert sizes(3, model=model) == (1, 1, 1, 1, 8)  # parts of 50, alike
    hits = {"velocity": np.ones(50), "mass": np.ones(60)}
    thrown = {"material": rubber(1), "shape": em.Sphere(0.01)}
    assert grids.grid(em.impact, hits, thrown).sizes() == (13, 60)
    ball = {"model": "line", "material": rubber(1), "shape": em.Sphere(0.01)}
    assert grids.grid(em.friction, {"velocity": [1.0] * 900}, ball).sizes() == (900,)


def test_a_disk_may_be_full_at_any_moment(tmp_path, monkeypatch):
    """Whichever file cannot be written, each third of them here, the next call goes
    on.
    """
    from zarr.storage import LocalStore

    small(monkeypatch)
    given = scene(
        axes={"material": [rubber(1), "no such rubber"], "velocity": VELOCITY}, load=1.0
    )
    write, left, said = LocalStore.set, [], set()

    async def limited(self, *rest):
        if not left:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        left.pop()
        await write(self, *rest)

    monkeypatch.setattr(LocalStore, "set", limited)
    for count in itertools.count(0, 3):
        path = tmp_path / str(count)
        left[:] = [None] * count
        try:
            em.sweep(**given, store=path)
        except em.InputError as error:
            said.add(str(error).replace(str(path), "PATH"))
        except em.ConvergenceWarning:  # of the rubber that there is not
            break
        left[:] = [None] * 1000
        with pytest.warns(em.ConvergenceWarning, match="1 of 2 chunks"):
            found = em.sweep(**given, store=path)
        assert np.isfinite(found.mu[0]).all()
        assert np.isnan(found.mu[1]).all()
        assert found.attrs["raised"][0].startswith("material no such rubber")
        assert found.mu.attrs["units"] == "-"
        assert "averaged" in found.attrs["model"]
    assert count > 40
    (text,) = said
    assert mentions(text, "'PATH'", "No space left on device")


def test_workers_of_another_version_are_refused():
    """The process that called sends its version with each chunk."""
    given = scene()
    del given["call"], given["progress"]
    asked = grids.grid(em.friction, given.pop("axes"), given)
    with refused("client", 9.9):
        run.compute(asked, asked.chunks()[0], "9.9")


def test_a_worker_keeps_the_memory_that_it_works_in():
    """Dask has glibc return each array at once: 200 faults per point, which make the
    work of a point twice as long.
    """
    program = textwrap.dedent("""
        import resource
        import numpy as np
        import elastomdr as em
        from elastomdr.sweeps import grid, run
        asked = grid.grid(
            em.friction,
            {"pressure": np.linspace(2e5, 4e5, 4), "velocity": np.logspace(-4, 1, 25)},
            {"material": em.Prony(1e6, [1e6, 2e6], [1e-5, 1e-3]),
             "surface": em.SelfAffine(0.8, q_low=1e3, q_high=1e6, rms_slope=1.0)},
        )
        for _ in range(2):
            before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
            run.compute(asked, asked.chunks()[0])
        print(resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before)
        """)
    done = subprocess.run(
        [sys.executable, "-c", program],
        env=os.environ | {"MALLOC_TRIM_THRESHOLD_": "65536"},
        stdout=subprocess.PIPE,
        check=True,
    )

    assert int(done.stdout) < 5_000


def test_what_kills_its_workers_is_left_for_the_next_call(tmp_path, monkeypatch):
    """Of chunks that were lost with their workers, each is computed alone; only what
    is lost again is given up.
    """
    small(monkeypatch, 14)
    asked = []

    def completed(client, shared, chunks, todo, *, alone):
        for number in todo:
            asked.append((number, alone))
            lost = number == 2 or (number == 0 and not alone)
            yield (
                number,
                KilledWorker("compute", None, 3)
                if lost
                else run.compute(shared, chunks[number]),
            )

    monkeypatch.setattr(run, "_as_completed", completed)
    client = SimpleNamespace(submit=lambda call, given, pure: call(given))
    said = "1 of 3 chunks .* material rubber 3: its workers were killed"
    with pytest.warns(em.ConvergenceWarning, match=said):
        found = em.sweep(**scene(store=tmp_path / "runs.zarr", client=client))
    assert asked == [(0, False), (1, False), (2, False), (0, True), (2, True)]
    assert np.isfinite(found.mu[:2]).all()
    assert np.isnan(found.mu[2]).all()
    assert (found.state[2] == store.OPEN).all(), "it is tried again by the next call"


def test_a_cluster_of_two(tmp_path, monkeypatch):
    """Any `dask.distributed.Client`: the same numbers; a cluster that is lost is named."""
    small(monkeypatch, 14)
    alone = em.sweep(**scene(store=tmp_path / "alone.zarr"))
    cluster = LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=False,
        dashboard_address=None,
        silence_logs=50,
    )
    # it looks for a lost scheduler for so many seconds
    with cluster, Client(cluster, timeout=1) as client:
        found = em.sweep(**scene(store=tmp_path / "runs.zarr", client=client))
        with (
            refused("", "pickled"),
        ):
            em.sweep(
                **scene(
                    call=lambda *places, **rest: client.submit(*places),
                    store=tmp_path / "client.zarr",
                    client=client,
                )
            )
        small(monkeypatch, 1)
        keep = store.ZarrStore.keep

        def loses(*given):
            client.sync(cluster.scheduler.close)
            keep(*given)

        monkeypatch.setattr(store.ZarrStore, "keep", loses)
        with pytest.raises(
            ConnectionError,
            match=r"cluster was lost.* the same call goes on from there",
        ):
            em.sweep(**scene(store=tmp_path / "lost.zarr", client=client))
    xarray.testing.assert_identical(found.mu.load(), alone.mu.load())


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"axes": {}}, ("axes", "more names")),
        ({"axes": {"velocity": 1.0}}, ("", "axes")),
        ({"axes": {"velocity": [[1.0]]}}, ("", "axes")),
        ({"axes": {"velocity": []}}, ("", "axes")),
        ({"axes": {"material": "nbr"}}, ("", "axes")),
        (
            {"shape": None, "load": [1.0, 2.0], "axes": {"velocity": [1.0]}},
            ("load", "value"),
        ),
        ({"load": 1.0}, ("load", "fixed")),
        ({"call": 3}, ("call", "em.friction")),
        (
            {"bananas": 1},
            ("", "'bananas'", "unexpected keyword argument"),
        ),
        (
            {"axes": {"velocity": [1.0]}, "load": 1.0},
            ("", "'mat", "required argument"),
        ),
        (
            {"axes": {"load": [1.0]}, "material": [rubber(1), rubber(2)]},
            ("material", "draws"),
        ),
        (
            {
                "axes": {"load": [1.0]},
                "material": EPDM.draws(3),
                "shape": ROAD.draws(2, level=0.1),
            },
            ("material", 2, 3),
        ),
        (
            {"axes": {"draw": [1.0]}, "material": EPDM.draws(3)},
            ("axes", "'draw'"),
        ),
        (
            {"client": "tcp://127.0.0.1:8786"},
            ("client", "dask.distributed.Client", "'tcp"),
        ),
        ({"store": "nonsense://b/runs.zarr"}, ("store", "'nonsense")),
        ({"store": "memory://"}, ("store", "'memo")),
        ({"store": "/"}, ("store", "'/'")),
        ({"store": ""}, ("store", "''")),
        ({"store": 3}, ("store", 3)),
        ({"store": None}, ("store", "given")),
    ],
)
def test_bad_input(change, said, tmp_path):
    with refused(*said):
        em.sweep(**scene(store=tmp_path / "runs.zarr") | change)
    assert not any(tmp_path.iterdir())


def test_without_the_packages(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "find_spec", lambda name: name != "zarr" or None)
    with refused("", "pip install elastomdr"):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))


SCENE = """
title = "Two treads"
material = ["tread-passenger-synthetic", "tread-winter-synthetic"]
temperature = ["0 degC", "20 degC"]
[indenter]
shape = "sphere"
radius = "5 mm"
[contact]
load = "10 N"
velocity = ["1 mm/s", "1 m/s"]
[sweep.vary]
"indenter.radius" = ["5 mm", "10 mm"]
"""


def command(tmp_path, capsys, text, *options):
    (tmp_path / "scene.toml").write_text(text)
    status = main(
        [
            "sweep",
            str(tmp_path / "scene.toml"),
            "--out",
            str(tmp_path / "s.zarr"),
            *options,
        ]
    )
    return status, capsys.readouterr()


ON_CELLS = """
material = "epdm-70"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.3
longest = "1 mm"
shortest = "0.2 mm"
[contact]
pressure = "1 MPa"
velocity = {{ from = "1 mm/s", to = "1 m/s", points = {1} }}
model = "{0}"
cells = 40
periods = 2
seeds = 2
"""


def test_command(tmp_path, capsys):
    """A scene with lists, to a store and a table; run again, it is there already."""
    status, said = command(
        tmp_path, capsys, SCENE, "--table", str(tmp_path / "all.csv")
    )
    assert status == 0, said.err
    assert mentions(said.out, "16 points", "indenter.radius 2", "16 converged")
    found = xarray.open_zarr(tmp_path / "s.zarr")
    alone = em.friction(
        em.load_material("tread-winter-synthetic"),
        em.Sphere(0.01),
        load=10.0,
        velocity=1.0,
        temperature=273.15,
    )
    one = found.sel(
        {"material": "tread-winter-synthetic", "indenter.radius": "10 mm"}
    ).isel(temperature=0, velocity=1)
    assert float(one.mu) == pytest.approx(float(alone.mu), rel=1e-9)
    table = pandas.read_csv(tmp_path / "all.csv", comment="#")
    assert len(table) == 16
    assert np.isclose(table["friction coefficient [-]"], alone.mu, rtol=1e-9).sum() == 1
    text = (tmp_path / "all.csv").read_text()
    assert "velocity [m/s]" in text
    head = [line for line in text.splitlines() if line.startswith("#")]
    assert "# scene: scene.toml" in head
    assert "# title: Two treads" in head
    assert "# material: tread-passenger-synthetic, tread-winter-synthetic" in head
    assert mentions(head, 0.005, 0.01)
    (tmp_path / "s.zarr" / "mu" / "0.0.0.0").unlink()
    status, said = command(tmp_path, capsys, SCENE)
    assert status == 0
    (line,) = said.err.splitlines()
    assert re.match(
        r"elastomdr: warning: 1 of \d+ chunks of store .* are damaged and computed again; the first",
        line,
    )
    status, said = command(tmp_path, capsys, SCENE.replace("10 N", "11 N"))
    assert status == 2
    assert "same inputs" in said.err


def test_a_command_whose_calls_all_raise_says_what(tmp_path, capsys, monkeypatch):
    def refused(*_, **__):
        raise em.InputError(argument="cells", got=4, accepted="more")

    here(monkeypatch)
    monkeypatch.setattr("elastomdr.friction", refused, raising=False)
    status, said = command(tmp_path, capsys, ON_CELLS.format("half-space", 20))
    assert status == 3
    assert "no point was computed" in said.out
    assert mentions(said.err, 4, "cells")


def test_an_interrupted_command_on_cells_goes_on(tmp_path, capsys, monkeypatch):
    """`elastomdr friction` with half-space leaves nothing and says so; `elastomdr
    sweep` keeps the chunks that are done, a few velocities each.
    """
    text = ON_CELLS.format("half-space", 20)

    def stopped(*_, **__):
        raise KeyboardInterrupt

    (tmp_path / "scene.toml").write_text(text)
    with monkeypatch.context() as patched:
        patched.setattr("elastomdr.friction", stopped, raising=False)
        assert (
            main(["friction", str(tmp_path / "scene.toml"), "--out", str(tmp_path)])
            == 130
        )
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert "`elastomdr sweep` keeps" in said
    assert [path.name for path in tmp_path.iterdir()] == ["scene.toml"]
    here(monkeypatch)
    done, computed = [], run.compute
    kept, keep = [], store.ZarrStore.keep

    def once(*chunk):
        if kept:
            raise KeyboardInterrupt
        kept.append(chunk)
        keep(*chunk)

    with monkeypatch.context() as patched:
        patched.setattr(store.ZarrStore, "keep", once)
        status, _ = command(tmp_path, capsys, text)
    assert status == 130
    monkeypatch.setattr(
        run, "compute", lambda *work: done.append(work[1]) or computed(*work)
    )
    status, said = command(tmp_path, capsys, text)
    assert status == 0, said.err
    assert len(done) == 2  # of the three of 7 velocities each


def test_a_friction_map_in_one_command(tmp_path, capsys):
    """The table of a sweep over velocity, temperature and pressure is a friction
    law.
    """
    text = (
        Path(__file__).parents[2] / "examples" / "scenes" / "friction_map.toml"
    ).read_text()
    status, said = command(
        tmp_path,
        capsys,
        text.replace("points = 26", "points = 3"),
        "--table",
        str(tmp_path / "m.csv"),
    )
    assert status in (0, 3), said.err
    table = (tmp_path / "m.csv").read_text()
    assert "# material: tread-passenger-synthetic\n" in table
    assert "self-affine surface" in table
    assert "# title: Friction map of a synthetic tread compound\n" in table
    law = em.load_friction(tmp_path / "m.csv")
    assert law.mu.shape == (4, 3, 3)
    store = xarray.open_zarr(tmp_path / "s.zarr")
    one = store.mu.sel(temperature=293.15, pressure=2e5).isel(velocity=1)
    assert float(law(float(one.velocity), 293.15, 2e5)) == pytest.approx(
        float(one), rel=1e-12
    )
    law.to_abaqus(tmp_path / "m.inp")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ('"indenter.radius"', '"indentor.radius"'),
            "indentor.radius must be",
        ),
        (
            ('["5 mm", "10 mm"]', "[]"),
            "indenter.radius must be a list",
        ),
        (
            ('["5 mm", "10 mm"]', '["5 mm", "5 N"]'),
            "[indenter] radius",
        ),
        (
            ("[sweep.vary]", '[sweep]\ncall = "slide"\n[sweep.vary]'),
            "[sweep] call",
        ),
    ],
)
def test_bad_scene(change, said, tmp_path, capsys):
    status, told = command(tmp_path, capsys, SCENE.replace(*change))
    assert status == 2
    assert said in told.err
    assert not (tmp_path / "s.zarr").exists()


def test_no_cluster_there(tmp_path, capsys):
    status, told = command(tmp_path, capsys, SCENE, "--scheduler", "nonsense")
    assert status == 2
    assert mentions(told.err, "--scheduler", "address")


@pytest.mark.filterwarnings("ignore::elastomdr.ExtrapolationWarning")
def test_a_store_has_the_doubts_of_each_point(tmp_path):
    rubber = em.Prony(1e6, [4e6], [1e-3], name="rubber", range={"omega": (1.0, 1e3)})
    axes = {"velocity": [1e-3, 1e-2, 0.1, 1.0]}
    fixed = {"material": rubber, "shape": em.Sphere(5e-3), "load": 1.0}
    found = em.sweep(em.friction, axes, store=str(tmp_path / "s.zarr"), **fixed)
    named = found["doubts"].attrs["flag_meanings"].split()
    bit = found["doubts"].attrs["flag_masks"][named.index("extrapolated")]
    one = em.friction(**fixed, **axes)
    assert one.extrapolated.any()
    assert not one.extrapolated.all()
    np.testing.assert_array_equal(found["doubts"].values & bit == bit, one.extrapolated)
