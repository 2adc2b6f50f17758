"""Transient sliding against steady friction and exact creep; its depth at a load,
derivatives, steps and refusals.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.element.body_over_line import indenter, settle
from elastomdr.element.moving_body import MotionScene
from elastomdr.material.relaxation import Relaxation
from elastomdr.surface.lines import SingleLine
from elastomdr.transient import march
from elastomdr.transient.march import run
from elastomdr.transient.problem import Steps, cut, timeline

from ..refused import refused
from .test_slide_rough import RUBBER, WAVES

BALL = em.Paraboloid(0.01)
CONE = em.Cone(0.2)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


# ---------------------------------------------------------------- against steady
# sliding and exact creep


def test_meets_steady_friction_after_dwell_jump_of_velocity_and_step_of_load():
    time = np.array([0.0, 0.5, 0.54, 0.54 + 3e-3, 0.54 + 3e-3, 0.54 + 6e-3])
    position = np.array([0.0, 0.0, 0.02, 0.035, 0.035, 0.05])  # 0.5 m/s, then 5 m/s
    load = np.array([10.0, 10.0, 10.0, 10.0, 5.0, 5.0])
    slide = em.slide(RUBBER, BALL, time=time, position=position, load=load, rtol=1e-2)
    steady = em.friction(
        RUBBER, BALL, velocity=[0.5, 5.0, 5.0], load=[10.0, 10.0, 5.0], model=em.Line()
    )
    assert slide.converged.all()
    assert slide.model == steady.model
    np.testing.assert_allclose(slide.mu[[0, 1]], 0, atol=1e-4)
    np.testing.assert_allclose(slide.mu[[2, 3, 5]], steady.mu, rtol=1e-2)
    np.testing.assert_allclose(slide.depth[[2, 3, 5]], steady.depth, rtol=1e-2)
    np.testing.assert_allclose(slide.normal_force, load, rtol=1e-12)


def test_dwell_is_the_exact_creep_of_a_paraboloid():
    """a^3 = (3/4) R F J(t), d = a^2/R, at every time after the load is put on."""
    time = np.concatenate([[0.0], np.geomspace(1e-5, 10, 13)])
    slide = em.slide(RUBBER, BALL, time=time, position=0 * time, load=10.0, rtol=1e-2)
    exact = (0.75 * 0.01 * 10 * RUBBER.creep_compliance(time)) ** (2 / 3) / 0.01
    assert slide.converged.all()
    np.testing.assert_allclose(slide.depth, exact, rtol=1e-3)
    # F ~ d^1.5: the work of the sudden load, all of it stored
    elastic = 0.4 * 10 * exact[0]
    np.testing.assert_allclose([slide.work[0], slide.stored[0]], elastic, rtol=2e-3)
    np.testing.assert_allclose(
        slide.work - slide.work[0],
        10 * (exact - exact[0]),
        rtol=2e-3,
        atol=1e-3 * elastic,
    )


def steady_error(body, depth, spacing, exact):
    """Error of F_x of a body at fixed depth, in the square mean over a few steps."""
    law = Relaxation(*map(np.asarray, (4e6, [12e6], [1e-3], 0.0)))
    v, count = 1.0, round(8e-3 / spacing)
    steps = round(4e-3 / spacing)
    # so that the edges pass through all places between two elements
    x = 0.93 * spacing * np.arange(1, steps + 1)
    surface = indenter(SingleLine(body), -2e-3 + 0.3 * spacing, spacing, count, 1.0)
    seen, _ = run(
        MotionScene(law, surface),
        Steps(np.full(steps, 0.93 * spacing / v), x, np.full(steps, depth)),
        control="depth",
        balance=False,
    )
    return float(np.sqrt(np.mean((np.asarray(seen.drag)[-64:] / exact - 1) ** 2)))


@pytest.mark.parametrize(
    ("body", "depth", "parts"),
    [(BALL, 1e-4, (128, 256, 512, 1024)), (CONE, 3e-4, (128, 512))],
)
def test_second_order_in_elements_and_steps(body, depth, parts):
    """Also for a cone, at whose tip the slope jumps between two elements."""
    spacing = 4e-3 / np.array(parts)
    law = em.Foundation(4e6, [12e6], [1e-3])
    exact = float(
        em.friction(
            law, body, velocity=1.0, depth=depth, model=em.Line()
        ).friction_force
    )
    errors = [steady_error(body, depth, s, exact) for s in spacing]
    # The factor of h^2 depends on where the edges fall between elements: 1.6 to 2.9 per
    # level, 2.0 in all.
    assert 1.6 < np.polyfit(np.log(spacing), np.log(errors), 1)[0] < 2.5
    assert errors[0] < 1e-3


# ---------------------------------------------------------------- the depth at a load


@pytest.mark.parametrize("seed", range(5))
def test_depth_at_a_load_is_exact(seed):
    rng = np.random.default_rng(seed)
    level, slope = jnp.asarray(rng.normal(size=64)), jnp.asarray(rng.random(64))
    spring, force = float(seed % 2), 10.0 ** rng.uniform(-6, 3)
    for guess in (-5.0, 0.0, 50.0):
        depth = settle(level, slope, spring, jnp.asarray(force), jnp.asarray(guess))
        carried = spring * depth + jnp.sum(slope * jnp.maximum(depth - level, 0.0))
        np.testing.assert_allclose(carried, force, rtol=1e-9)
    rate = jax.grad(settle, argnums=3)(
        level, slope, spring, jnp.asarray(force), jnp.asarray(0.0)
    )
    np.testing.assert_allclose(
        rate, 1 / (spring + slope[level < depth].sum()), rtol=1e-12
    )
    if not spring:
        assert (
            settle(level, slope, spring, jnp.zeros(()), jnp.asarray(3.0)) == level.min()
        )


# ---------------------------------------------------------------- gradients


def final_mu(modulus, radius, load):
    law = em.Foundation(4e6, jnp.stack([modulus]), [1e-3])
    time = np.array([0.0, 1e-3, 3e-3])  # at rest, then 0.5 m/s
    found = em.slide(
        law,
        em.Paraboloid(radius),
        time=time,
        position=np.array([0.0, 0.0, 1e-3]),
        load=load,
        elements=192,
        rtol=1e-1,
    )
    return found.mu[-1]


@pytest.mark.slow
def test_gradients_meet_finite_differences_in_both_modes():
    at = tuple(map(jnp.asarray, (12e6, 0.01, 10.0)))
    value = jax.jit(final_mu)
    grads = jax.jit(jax.grad(final_mu, argnums=(0, 1, 2)))(*at)
    assert np.isfinite(grads).all()
    tangent = jax.jit(lambda *a: jax.jvp(final_mu, a, tuple(a))[1])(*at)
    np.testing.assert_allclose(
        tangent, sum(g * a for g, a in zip(grads, at, strict=True)), rtol=1e-9
    )
    for i, step in enumerate((2e-3, 2e-3, 2e-3)):
        ends = [
            value(*(a * (1 + sign * step * (i == j)) for j, a in enumerate(at)))
            for sign in (1, -1)
        ]
        np.testing.assert_allclose(
            grads[i] * at[i], (ends[0] - ends[1]) / (2 * step), rtol=0.05, atol=1e-4
        )


# ---------------------------------------------------------------- time steps, results,
# refusals


def test_steps_cover_the_history():
    time, place = np.array([0.0, 1.0, 1.0, 3.0]), np.array([0.0, 2.0, 2.0, 2.0])
    load = np.array([1.0, 1.0, 5.0, 7.0])
    line = timeline(time, place, load, 0.5, 1e-3, 0)
    for finer in (1, 2):
        steps, last = cut(line, time, place, load, 1e-3, finer)
        np.testing.assert_allclose(np.cumsum(steps.h)[last], time, atol=1e-9)
        np.testing.assert_allclose(steps.position[last], place)
        np.testing.assert_allclose(steps.value[last], load)
        assert np.abs(np.diff(steps.position)).max() <= 0.5 / finer + 1e-12
        assert (steps.h > 0).all()


def test_one_compiled_program_serves_all_levels(monkeypatch):
    """Elements beyond the others, steps without length, and how a motion is cut into
    pieces change nothing.
    """
    piece = march._piece.__wrapped__
    program = jax.jit(
        lambda *args, **options: piece(*args, **options),
        static_argnames=("control", "viscous", "balance"),
    )
    with monkeypatch.context() as patched:
        patched.setattr(march, "_piece", program)
        patched.setattr("elastomdr.transient.refinement._PATIENCE", -1.0)
        found = em.slide(
            RUBBER, BALL, time=[0.0, 0.1], position=[0.0, 0.0], load=10.0, rtol=1e-4
        )
    assert found.plan.levels > 2
    assert program._cache_size() == 1
    steps = Steps(jnp.full(200, 1e-4), jnp.arange(200) * 1e-5, jnp.full(200, 10.0))
    ends = []
    for count, work in ((192, 1e9), (384, 1.0)):
        monkeypatch.setattr("elastomdr.transient.march._PIECE", work)
        surface = indenter(SingleLine(BALL), -2e-3, 4e-5, count, 1.0)
        seen, _ = run(
            MotionScene(RUBBER.law(), surface),
            steps,
            np.arange(0, 200, 3),
            balance=False,
        )
        ends.append(seen)
    for exact, found in zip(*ends, strict=True):
        assert exact.shape == (67,)
        np.testing.assert_allclose(
            found, exact, rtol=1e-12, atol=1e-12 * float(jnp.abs(exact).max())
        )


def test_result_is_a_table_and_a_figure(tmp_path):
    time = np.linspace(0, 0.01, 4)
    slide = em.slide(
        em.Foundation(4e6, [12e6], [1e-3]),
        WAVES,
        time=time,
        position=0.01 * time,
        load=2.0,
    )
    slide.to_csv(tmp_path / "slide.csv")
    text = (tmp_path / "slide.csv").read_text()
    assert "normal force [N/m]" in text
    assert "bare MDR line" in text
    assert "Transient sliding" in repr(slide)
    assert set(slide.to_dict()) >= {"time", "mu", "dissipated", "model"}
    ax = slide.plot(against="position")
    assert ax.get_xlabel() == "Position [m]"
    with refused("against", "mu"):
        slide.plot(against="mu")


T2 = np.array([0.0, 1.0])


@pytest.mark.parametrize(
    "given", [{"load": 0.0}, {"depth": 0.0}, {"depth": np.array([-1e-3, -2e-3])}]
)
def test_a_body_that_is_not_pressed_down_feels_nothing(given):
    slide = em.slide(RUBBER, BALL, time=T2, position=T2, **given)
    assert slide.converged.all()
    assert np.isnan(slide.mu).all()  # there is none without a normal force
    for field in (
        slide.normal_force,
        slide.friction_force,
        slide.work,
        slide.dissipated,
    ):
        assert (field == 0).all()
    np.testing.assert_allclose(slide.depth, given.get("depth", 0.0) + 0 * T2)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"time": [1.0, 0.0]}, ("time", "[1, 0]")),
        ({"time": [0.0, 1.0, 2.0]}, ("", "position")),
        ({"time": [0.0, 0.0], "position": [0.0, 1.0]}, ("position", "equal")),
        ({"load": None}, ("", "depth")),
        ({"depth": 1e-4}, ("", "depth")),
        ({"load": -1.0}, ("load",)),
        ({"load": [1.0, 1.0, 1.0]}, ("load", "number")),
        ({"temperature": 300.0}, ("", "shift law")),
        ({"rtol": 0.0}, ("rtol",)),
        ({"elements": 3}, ("elements",)),
        ({"shape": em.FlatPunch(1e-3)}, ("shape", "FlatPunch")),
        ({"shape": "ball"}, ("shape",)),
        (
            {"material": em.Foundation.kelvin(1e6, 1e3), "load": None, "depth": 1e-4},
            ("depth", "jump"),
        ),
    ],
)
def test_refuses_bad_input(change, message):
    arguments = {
        "material": RUBBER,
        "shape": BALL,
        "time": T2,
        "position": T2,
        "load": 1.0,
    } | change
    with refused(*message):
        em.slide(arguments.pop("material"), arguments.pop("shape"), **arguments)


def test_rough_line_refuses_uneven_points():
    with pytest.raises(em.InputError, match="evenly spaced"):
        em.RoughLine([0.0, 1.0, 2.0, 4.0], np.zeros(4))
    with pytest.raises(em.InputError, match="4 entries"):
        em.RoughLine([0.0, 1.0], [0.0, 1.0])


def test_a_history_out_of_reach_is_flagged():
    """A body that is pressed past the end of its profile has no answer."""
    r = np.linspace(0, 1e-3, 9)
    with pytest.warns(em.ConvergenceWarning, match="did not converge"):
        slide = em.slide(
            RUBBER,
            em.Profile(r, r**2 / 0.02),
            time=T2,
            position=0 * T2,
            load=1e3,
            rtol=1e-1,
        )
    assert np.isnan(slide.mu).all()
    assert not slide.converged.any()
