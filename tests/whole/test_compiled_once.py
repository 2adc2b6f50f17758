"""A second gradient, and a second call under `jit`, of each verb compiles nothing: what
JAX sees of two like calls is equal, though each is made of new objects.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import jax
import jax.monitoring
import numpy as np
import pytest

import elastomdr as em
from elastomdr.arrays import compiled

COMPILED: list[str] = []
TIME = np.linspace(0.0, 1.0, 3)
COARSE = {"rtol": 1e-1, "elements": 64}


def _heard(event: str, _seconds: float, **_: Any) -> None:
    if event == "/jax/core/compile/backend_compile_duration":
        COMPILED.append(event)


jax.monitoring.register_event_duration_secs_listener(_heard)


@contextmanager
def programs() -> Iterator[Callable[[], int]]:
    """How many programs are compiled within."""
    before = len(COMPILED)
    yield lambda: len(COMPILED) - before


def rubber(level: Any = 1.0) -> em.Prony:
    return em.Prony(
        0.5e6, level * np.array([3e7, 3e6]), [1e-6, 1e-3], shift=em.WLF(9, 100, 293.0)
    )


def solid() -> em.Prony:
    return em.StandardSolid(1e6, 4e6, 0.3)


def road() -> em.SelfAffine:
    return em.SelfAffine(0.8, rms_slope=0.5, q_low=2e3, q_high=2e4)


def on_road(k: Any, **options: Any) -> Any:
    return em.friction(
        rubber(), road(), velocity=0.1 * k, pressure=2e5, temperature=293.0, **options
    ).mu


def ball() -> em.Paraboloid:
    return em.Paraboloid(5e-3)


VERBS: dict[str, Callable[[Any], Any]] = {
    "friction": lambda k: em.friction(rubber(k), ball(), velocity=0.01, load=1.0).mu,
    "friction, line": lambda k: em.friction(
        rubber(k), ball(), velocity=0.01, load=1.0, model=em.Line()
    ).mu,
    "friction, road": on_road,
    "friction, road with heat": lambda k: on_road(k, heat=em.Heat(0.25, 2e6)),
    "rolling": lambda k: em.rolling(solid(), ball(), velocity=1.0, load=k).coefficient,
    "rolling, layer": lambda k: em.rolling(
        em.layer(solid(), 2e-3), em.Cylinder(5e-3, 0.01), velocity=0.01, load=10 * k
    ).coefficient,
    "leak": lambda k: em.leak(
        rubber(), road(), pressure=2e6 * k, pressure_drop=1e5, viscosity=1e-3,
        length=1e-3,
    ).rate,
    "break_out": lambda k: em.break_out(
        rubber(), road(), pressure=1e6 * k, boundary_shear=1e5, time=10.0
    ).mu,
    "traction": lambda k: em.traction(
        em.Foundation(8e7, [], []), em.Cylinder(0.3, 0.16), load=4e3 * k, velocity=25.0,
        slip=0.005, friction=0.8, tangential=em.Foundation(5e7, [1e8], [1e-2]),
    ).force,
    "indent": lambda k: em.indent(
        solid(), ball(), time=TIME, depth=k * 1e-4 * TIME
    ).force[-1],
    "slide": lambda k: em.slide(
        solid(), ball(), time=TIME, position=1e-3 * TIME, load=k, **COARSE
    ).mu[-1],
    "drive": lambda k: em.drive(
        solid(), ball(), time=TIME, position=1e-3 * TIME, load=k, **COARSE
    ).mu[-1],
}  # fmt: skip
SLOW = {"friction, road with heat", "rolling, layer", "slide", "drive"}
EVERY = [
    pytest.param(verb, marks=[pytest.mark.slow] if verb in SLOW else [])
    for verb in VERBS
]


@pytest.mark.filterwarnings("ignore:.*sliding")
@pytest.mark.parametrize("verb", EVERY)
def test_a_second_gradient_compiles_nothing(verb):
    """With another value, and with a function that is new to JAX."""
    call = VERBS[verb]
    with jax.enable_x64(True):
        with programs() as first:
            jax.grad(lambda k: call(k))(1.0)
        assert first() > 0
        with programs() as second:
            slope = jax.grad(lambda k: call(k))(1.01)
        assert second() == 0
    assert np.isfinite(slope)


@pytest.mark.parametrize("verb", EVERY)
def test_a_second_call_under_jit_compiles_nothing(verb):
    with jax.enable_x64(True):
        under_jit = jax.jit(VERBS[verb])
        with programs() as first:
            under_jit(1.0)
        assert first() > 0
        with programs() as second:
            number = under_jit(1.01)
        assert second() == 0
    assert np.isfinite(number)


@pytest.mark.parametrize("kept", [True, False])
def test_programs_that_are_made_anew_are_heard(kept):
    """The tests before would fail if a program depended on an object of its call."""

    @compiled("how")
    def step(x: Any, how: object) -> Any:
        return 2.0 * x

    def call(k: Any) -> Any:
        return step(k, "alike" if kept else object())

    jax.grad(lambda k: call(k))(1.0)
    with programs() as second:
        jax.grad(lambda k: call(k))(1.01)
    assert (second() == 0) is kept
