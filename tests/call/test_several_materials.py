"""A list of materials is a first axis of every verb, and names tell them apart."""

import dataclasses
import threading
import warnings

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import heard, quiet

from ..refused import refused

SOFT = em.StandardSolid(1e6, 4e6, 1e-2, name="soft")
HARD = em.Prony(3e6, [2e6, 5e6], [1e-3, 0.1], name="hard")
BALL, TIME = em.Paraboloid(5e-3), np.linspace(0, 0.05, 6)
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
CALLS = {
    "friction": lambda m: em.friction(m, BALL, velocity=[0.1, 1.0], load=1.0),
    "road": lambda m: em.friction(m, ROAD, velocity=[0.1, 1.0], pressure=3e5),
    "line": lambda m: em.friction(m, BALL, velocity=[0.1, 1.0], load=1.0, model="line"),
    "rolling": lambda m: em.rolling(m, BALL, velocity=[0.1, 1.0], load=1.0),
    "dissipation": lambda m: em.dissipation(m, BALL, velocity=[0.1, 1.0], load=1.0),
    "indent": lambda m: em.indent(
        m, BALL, time=TIME, depth=1e-4 * np.sin(40 * TIME) ** 2
    ),
    "impact": lambda m: em.impact(m, BALL, mass=4e-3, velocity=[0.5, 2.0]),
    "shear": lambda m: em.shear(
        m, BALL, time=TIME, load=1.0, displacement=1e-5 * TIME / 0.05, friction=0.5
    ),
    "slide": lambda m: em.slide(
        m, BALL, time=TIME, load=1.0, position=0.02 * TIME, rtol=1e-2
    ),
    "traction": lambda m: em.traction(
        m, BALL, velocity=1.0, creepage=[0.001, 0.1], friction=0.8, load=5.0
    ),
    "cord": lambda m: em.o_ring(m, 3e-3, 0.1, time=[1.0, 100.0]),
    "leak": lambda m: em.leak(
        m, ROAD, pressure=[1e5, 3e5], pressure_drop=1e4, viscosity=1e-3, length=1e-3
    ),
    "break_out": lambda m: em.break_out(
        m, ROAD, pressure=[1e5, 3e5], boundary_shear=1e5
    ),
    "lubricated": lambda m: em.lubricated(
        m, em.Cylinder(5e-3, 1.0), velocity=[0.1, 1.0], load=1e3, viscosity=1.0
    ),
}


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS)
def test_a_list_of_materials_is_a_first_axis(call):
    together, alone = call([SOFT, HARD]), [call(SOFT), call(HARD)]
    assert together.materials == ("soft", "hard")
    assert type(together) is type(alone[0])
    for i, one in enumerate(alone):
        chosen = together.select(("soft", "hard")[i])
        for (quantity, value), other in zip(
            one.fields().items(), chosen.fields().values(), strict=True
        ):
            # errors follow the steps of a search
            rtol = 0.05 if "error" in quantity.label else 1e-9
            np.testing.assert_allclose(value, other, rtol=rtol, err_msg=quantity.label)
    assert together.to_xarray().sizes["material"] == 2
    assert "soft" in together.summary()
    assert "hard" in together.summary()


def test_names_tell_materials_apart():
    nameless = em.StandardSolid(2e6, 4e6, 1e-2)
    curve = em.friction(
        [SOFT, nameless, SOFT], BALL, velocity=[0.1, 1.0, 10.0], load=1.0
    )
    assert curve.materials == ("soft", "material 2", "soft (2)")
    assert curve.mu.shape == (3, 3)
    labels = [text.get_text() for text in curve.plot().get_legend().get_texts()]
    for name in curve.materials:
        assert [label.partition(":")[0] for label in labels].count(name) == 1
    assert "material" in curve.csv()
    np.testing.assert_array_equal(
        em.friction(material=[SOFT], shape=BALL, velocity=1.0, load=1.0).mu.shape, (1,)
    )


def test_a_list_passes_through_gradients():
    def total(modulus):
        rubbers = [em.StandardSolid(modulus, 4e6, 1e-2), HARD]
        return em.friction(rubbers, BALL, velocity=0.3, load=1.0).mu.sum()

    with jax.enable_x64(True):
        slope = jax.grad(total)(1e6)
    high, low = (total(1e6 * (1 + h)) for h in (1e-4, -1e-4))
    np.testing.assert_allclose(slope, (high - low) / 2e2, rtol=1e-5)


def test_warnings_of_all_materials_are_one():
    liquids = [
        em.Maxwell(1e6, 1e-2, name="one"),
        em.Maxwell(2e6, 1e-2, name="two"),
        SOFT,
    ]
    with pytest.warns(em.ConvergenceWarning) as caught:
        curve = em.friction(liquids, em.Sphere(0.01), velocity=[1.0, 2.0], load=1.0)
    assert curve.mu.shape == (3, 2)
    assert len(caught) == 1
    assert "one, two: " in str(caught[0].message)


def test_an_empty_list_is_refused():
    with refused("material", "[]"):
        em.friction([], BALL, velocity=1.0, load=1.0)


def test_a_plan_of_several_materials():
    plans = em.plan([SOFT, HARD], BALL, velocity=[0.1, 1.0], load=1.0)
    assert list(map(str, plans)) == [
        str(em.plan(m, BALL, velocity=[0.1, 1.0], load=1.0)) for m in (SOFT, HARD)
    ]
    assert [line for line in str(plans).splitlines() if line in ("soft", "hard")] == [
        "soft",
        "hard",
    ]


def test_a_wrong_entry_is_named_by_its_place():
    with refused("material[1]", "'rubber'"):
        em.friction([SOFT, "rubber"], BALL, velocity=1.0, load=1.0)
    with refused("material[0]"):
        em.friction([None, SOFT], BALL, velocity=1.0, load=1.0)
    with refused("velocity", -1.0) as found:
        em.friction([SOFT, HARD], BALL, velocity=-1.0, load=1.0)
    assert found.value.got == -1.0
    warm = dataclasses.replace(HARD, shift=em.WLF(17.44, 51.6, 263.0))
    with refused("", "material[1] (soft)", "temperature"):
        em.friction([warm, SOFT], BALL, velocity=1.0, load=1.0, temperature=293.0)


def test_warnings_are_heard_while_another_thread_silences_its_own():
    """`warnings.catch_warnings` puts back, at its end, what it found at its beginning:
    entered before another thread listens, left meanwhile, it took the warnings away.
    """
    entered, listening, left = (threading.Event() for _ in range(3))

    def draw():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            entered.set()
            listening.wait()
        left.set()

    thread = threading.Thread(target=draw)
    thread.start()
    entered.wait()
    known = em.Prony(1e6, [4e6], [1e-3], range={"omega": (1.0, 10.0)})
    with heard() as said:
        listening.set()
        left.wait()
        em.friction(known, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
        with quiet(em.ExtrapolationWarning):
            em.friction([known] * 2, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
    thread.join()
    assert [each.category for each in said] == [em.ExtrapolationWarning]
    with pytest.warns(em.ExtrapolationWarning), quiet(em.ModelWarning):
        em.friction(known, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
