"""The same call gives the same bits: whatever ran before, however busy the machine is,
and in a new process.
"""

import hashlib
import json
import os
import re
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em

SOURCE = Path(em.__file__).parent
SOLID = em.StandardSolid(1e6, 9e6, 1e-2)
RUBBER = em.Prony(
    1e6, [3e7, 9e6, 3e6], [1e-4, 1e-2, 1.0], shift=em.WLF(8.86, 101.6, 293.15)
)
BALL = em.Sphere(0.01)
ROLLER = em.Cylinder(0.05, 0.5)
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
WAVE = em.RoughLine(
    np.arange(128) * 1e-5, 1e-6 * np.cos(2 * np.pi * np.arange(128) / 64)
)
LAYER = em.layer(RUBBER, 5e-3)
VELOCITY = [1e-2, 0.1, 1.0]
TIME = np.linspace(0.0, 0.02, 5)
SHEAR = em.AdhesiveShear(5e6, 6e-3, 0.24)
HEAT = em.Heat(0.3, 1.8e6)
IDLERS = em.Idlers(LAYER, ROLLER, spacing=1.0, shares=[0.2, 0.6, 0.2])
CALLS = {
    "friction, ball": lambda: em.friction(RUBBER, BALL, velocity=VELOCITY, load=1.0),
    "friction, cone": lambda: em.friction(
        RUBBER, em.Cone(0.1), velocity=VELOCITY, load=1.0
    ),
    "friction, list": lambda: em.friction(
        [RUBBER, SOLID], BALL, velocity=VELOCITY, load=1.0
    ),
    "friction, layer": lambda: em.friction(
        LAYER, ROLLER, velocity=VELOCITY, load=100.0
    ),
    "friction, rough line": lambda: em.friction(
        SOLID, WAVE, velocity=VELOCITY, load=10.0
    ),
    "friction, surface": lambda: em.friction(
        RUBBER, ROAD, velocity=VELOCITY, pressure=3e5
    ),
    "friction, heat": lambda: em.friction(
        RUBBER,
        ROAD,
        velocity=VELOCITY,
        pressure=3e5,
        temperature=293.15,
        heat=HEAT,
        adhesion=SHEAR,
    ),
    "rolling": lambda: em.rolling(LAYER, ROLLER, velocity=VELOCITY, load=100.0),
    "dissipation": lambda: em.dissipation(LAYER, ROLLER, velocity=VELOCITY, load=100.0),
    "press": lambda: em.press(
        RUBBER, ROAD, pressure=[1e5, 3e5], model=em.Line(seeds=2, samples=1024)
    ),
    "indent, depth": lambda: em.indent(
        RUBBER, BALL, time=[0, 1, 2], depth=[0, 1e-4, 5e-5], rtol=1e-3
    ),
    "indent, load": lambda: em.indent(
        SOLID, BALL, time=[0, 1, 2], load=[0, 1, 0.2], rtol=1e-2
    ),
    "impact": lambda: em.impact(SOLID, BALL, mass=1e-2, velocity=1.0, rtol=1e-2),
    "impacts": lambda: em.impact(
        SOLID, BALL, mass=1e-2, velocity=np.linspace(0.1, 1.0, 12), rtol=1e-3
    ),
    "shear": lambda: em.shear(
        RUBBER,
        BALL,
        time=TIME,
        displacement=2e-3 * TIME,
        load=1.0,
        friction=0.5,
        elements=50,
        steps=4,
    ),
    "slide": lambda: em.slide(
        RUBBER, BALL, time=TIME, position=0.02 * TIME, load=1.0, rtol=0.1
    ),
    "drive": lambda: em.drive(
        SOLID,
        BALL,
        time=TIME[:2],
        position=0.02 * TIME[:2],
        load=1.0,
        tangential=em.Mount(0.1, 1e3, 1.0),
        rtol=0.1,
    ),
    "traction": lambda: em.traction(
        RUBBER, BALL, velocity=1.0, creepage=[1e-3, 0.05], friction=0.8, load=5.0
    ),
    "conveyor": lambda: em.conveyor(
        IDLERS, IDLERS, velocity=[2.0, 5.0], belt=20.0, goods=100.0
    ),
    "cord": lambda: em.o_ring(RUBBER, 5e-3, 0.15, time=[1.0, 100.0]),
    "leak": lambda: em.leak(
        RUBBER, ROAD, pressure=[1e5, 3e5], pressure_drop=1e4, viscosity=1.0, length=1.0
    ),
    "lubricated": lambda: em.lubricated(
        RUBBER, em.Cylinder(5e-3, 1.0), velocity=[0.1, 1.0], load=1e3, viscosity=1.0
    ),
}
SLOW = {
    "friction, half-space": lambda: em.friction(
        SOLID, BALL, velocity=[0.1], load=1.0, model=em.HalfSpace(cells=32)
    ),
    "friction, ball on a layer": lambda: em.friction(
        LAYER, BALL, velocity=VELOCITY, load=1.0
    ),
    "indent, adhesion": lambda: em.indent(
        SOLID, BALL, time=[0, 1, 2], depth=[0, 1e-4, 5e-5], adhesion=0.1
    ),
    "oblique": lambda: em.impact(
        SOLID,
        BALL,
        mass=1e-2,
        velocity=1.0,
        tangential_velocity=0.5,
        friction=0.5,
        rtol=1e-3,
    ),
    "bands": lambda: em.friction_spectrum(SOLID, WAVE, velocity=0.1, load=10.0),
}


def bits(result):
    """A digest of every field of numbers."""
    fields = {
        key: value
        for key, value in result.to_dict().items()
        if isinstance(value, np.ndarray)
    }
    assert fields
    return hashlib.sha256(
        b"".join(key.encode() + fields[key].tobytes() for key in sorted(fields))
    ).hexdigest()


def of_a_new_process(calls):
    """The bits of calls by name, made in the opposite order by a process that did
    nothing before, with as many threads for linear algebra as users have.
    """
    environment = {**os.environ}
    environment.pop("OPENBLAS_NUM_THREADS", None)
    done = subprocess.run(
        [sys.executable, __file__, *reversed(calls)],
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


@contextmanager
def busy():
    """Keeps every core busy."""
    others = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(os.cpu_count() or 2)
    ]
    try:
        yield
    finally:
        for other in others:
            other.kill()
            other.wait()


def check(calls, times):
    first = {name: bits(call()) for name, call in calls.items()}
    assert of_a_new_process(list(calls)) == first
    with busy():
        for _ in range(times - 1):
            again = {name: bits(calls[name]()) for name in reversed(calls)}
            assert again == first


@pytest.mark.filterwarnings("ignore")
def test_each_verb_twice_and_in_a_new_process():
    check(CALLS, 2)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")
def test_each_verb_ten_times_and_in_a_new_process():
    check(CALLS | SLOW, 10)


def test_no_clock_decides_how_a_number_is_computed():
    """The choice of NumPy or JAX is one of size. Clocks belong to the page, to progress
    bars and to sweeps.
    """
    clock = re.compile(r"^\s*(import time\b|from time import)", re.MULTILINE)
    read = {
        path.relative_to(SOURCE).as_posix()
        for path in SOURCE.rglob("*.py")
        if clock.search(path.read_text())
    }
    may = ("app/", "cli/", "sweeps/", "progress_bar.py")
    assert all(name.startswith(may) for name in read), read


if __name__ == "__main__":
    import warnings

    warnings.simplefilter("ignore")
    print(json.dumps({name: bits((CALLS | SLOW)[name]()) for name in sys.argv[1:]}))
