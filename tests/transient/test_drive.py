"""Coupled dynamics against free oscillation, its rigid limits, its energy balance, and
its order.
"""

import contextlib
import os
import re
import signal
import sys
import threading
import warnings
from time import process_time
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import elastomdr as em
from elastomdr.element.body_over_line import indenter
from elastomdr.element.moving_body import MotionScene, Mount
from elastomdr.surface.lines import SingleLine
from elastomdr.transient import march, refinement
from elastomdr.transient.march import run
from elastomdr.transient.problem import even_steps

from ..refused import refused

FLAT = em.RoughLine(np.arange(8) * 1e-5, np.zeros(8))
X = np.arange(64) * 1e-5
WAVY = em.RoughLine(X, 4e-6 * np.cos(2 * np.pi * X / 6.4e-4))
RUBBER = em.Foundation(4e6, [12e6], [1e-3])


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def fully_wet(time, speed, mount, amplitude, wave, rubber, load):
    """X, F_x and X' over a wave in full contact, an ordinary differential equation of
    four numbers.

    Branches carry f0 + Re F exp(iqx), F' = E_1 B' - F/tau, where the surface is B = A
    exp(-iqX): F_x = Re(F dB*/dX)/2.
    """
    modulus, tau = rubber.moduli[0], rubber.times[0]

    def parts(y):
        b = amplitude * np.exp(-1j * wave * y[0])
        force = y[2] + 1j * y[3]
        return force, -1j * wave * b, (force * np.conj(-1j * wave * b)).real / 2

    def rate(t, y):
        force, slope, drag = parts(y)
        pull = mount.stiffness * (speed * t - y[0]) + mount.damping * (speed - y[1])
        change = modulus * slope * y[1] - force / tau
        return [y[1], (pull - drag) / mount.mass, change.real, change.imag]

    y = solve_ivp(
        rate,
        (0, time[-1]),
        [0, 0, modulus * amplitude, 0],
        "DOP853",
        time,
        rtol=3e-14,
        atol=1e-18,
    ).y
    return y[0], parts(y)[2], y[1]


@pytest.mark.parametrize(
    ("speed", "mount", "last", "slips", "rtol"),
    [
        (0.2, em.Mount(0.02, 2e3, 1.0), 0.016, 2.0, 1e-3),
        (0.1, em.Mount(0.002, 2e3, 0.1), 0.021, 8.0, 1e-2),
    ],
    ids=["pulled along", "sticks, then slips"],
)
def test_meets_the_exact_motion_over_a_wave_and_its_error_covers_it(
    speed, mount, last, slips, rtol
):
    rubber, load, period, amplitude = (
        em.Foundation(4e6, [12e6], [2e-3]),
        200.0,
        6.4e-4,
        8e-6,
    )
    wave = 2 * np.pi / period
    x = period * np.arange(128) / 128
    line = em.RoughLine(x, amplitude * np.cos(wave * x))
    time = np.linspace(0, last, 57)
    place, drag, velocity = fully_wet(time, speed, mount, amplitude, wave, rubber, load)
    assert velocity.max() > slips * speed
    found = em.drive(
        rubber,
        line,
        time=time,
        position=speed * time,
        load=load,
        tangential=mount,
        rtol=rtol,
    )
    assert found.converged.all()
    off = np.abs(found.mu - drag / load)
    # the line is a spline
    assert (off <= found.error + 1e-6 * np.abs(found.mu).max()).all()
    assert found.error.max() <= rtol * max(
        np.abs(drag / load).max(), 0.03 * amplitude * wave
    )
    np.testing.assert_allclose(found.position, place, atol=rtol * np.abs(place).max())
    assert np.abs(found.imbalance).max() <= rtol * found.given.max()


def test_small_tolerances_are_met_on_a_ball():
    """Pulled through a spring and a damper until it slides steadily; the steady
    friction is found by another solver.
    """
    ball, speed, mount, time = (
        em.Paraboloid(0.01),
        0.5,
        em.Mount(0.01, 2e4, 20.0),
        np.linspace(0, 0.02, 11),
    )
    steady = em.friction(RUBBER, ball, velocity=speed, load=5.0, model=em.Line())
    marched = []
    for rtol in (1e-2, 1e-3):
        found = em.drive(
            RUBBER,
            ball,
            time=time,
            position=speed * time,
            load=5.0,
            tangential=mount,
            rtol=rtol,
        )
        assert found.converged.all()
        marched.append(found)
        np.testing.assert_allclose(found.mu[-1], steady.mu, rtol=0.5 * rtol)
        np.testing.assert_allclose(found.depth[-1], steady.depth, rtol=0.5 * rtol)
    assert (
        np.abs(marched[0].mu - marched[1].mu) <= marched[0].error + marched[1].error
    )[1:].all()


def test_energy_of_a_load_put_on_rubber_faster_than_the_steps():
    """A flat body at rest: P (d_end - d_start)/2 is lost of the work P; steps of equal
    length missed most of it.
    """
    rubber, load = em.Foundation(1e6, [2e7, 1e7], [1e-6, 1e-4]), 20.0
    time = np.linspace(0, 0.02, 5)
    found = em.drive(rubber, FLAT, time=time, position=0 * time, load=load, rtol=1e-3)
    assert found.converged.all()
    assert np.abs(found.imbalance).max() < 1e-3 * found.given.max()
    np.testing.assert_allclose(
        found.dissipated[-1], load**2 * (1 / 1e6 - 1 / 3.1e7) / 2, rtol=1e-3
    )


def test_without_a_load_a_body_swings_freely():
    time, mount, speed = np.linspace(0, 0.01, 33), em.Mount(1e-2, 1e4), 0.3
    found = em.drive(
        RUBBER,
        em.Paraboloid(0.01),
        time=time,
        position=speed * time,
        load=0.0,
        tangential=mount,
    )
    omega = 1e3
    assert found.converged.all()
    assert not found.normal_force.any()
    np.testing.assert_allclose(
        found.position,
        speed * (time - np.sin(omega * time) / omega),
        atol=1e-2 * speed / omega,
    )


def test_elements_are_added_only_where_the_outermost_are_touched(monkeypatch):
    """A motion that does not converge is not marched again over a longer line."""
    module, time = sys.modules["elastomdr.transient.drive"], np.linspace(0, 4e-3, 5)
    arguments = {"time": time, "position": 0.5 * time, "load": 5.0}
    rough = em.drive(RUBBER, em.Paraboloid(0.01), rtol=1e-1, **arguments)
    monkeypatch.setattr(module, "_LONG", 0.0)
    monkeypatch.setattr(module, "_FINEST", rough.plan.levels - 1)
    with pytest.warns(em.ConvergenceWarning):
        fine = em.drive(RUBBER, em.Paraboloid(0.01), rtol=1e-6, **arguments)
    assert fine.plan.elements == rough.plan.elements


@pytest.mark.slow
def test_mass_on_kelvin_elements_is_a_damped_oscillator():
    """m d'' + (eta + c) d' + (E + k) d = P from rest at d = 0: frequency, damping and
    level in closed form.
    """
    modulus, viscosity, mass, k, c, load = 1e4, 4.0, 0.1, 5e3, 2.0, 5.0
    time = np.linspace(0, 0.05, 321)
    found = em.drive(
        em.Foundation.kelvin(modulus, viscosity),
        FLAT,
        time=time,
        position=0 * time,
        load=load,
        normal=em.Mount(mass, k, c),
        rtol=2e-2,
    )
    omega, damping = np.sqrt((modulus + k) / mass), (viscosity + c) / (2 * mass)
    ringing = np.sqrt(omega**2 - damping**2)
    swing = np.exp(-damping * time) * (
        np.cos(ringing * time) + damping / ringing * np.sin(ringing * time)
    )
    assert found.converged.all()
    np.testing.assert_allclose(
        found.depth, load / (modulus + k) * (1 - swing), atol=1e-3 * load / modulus
    )
    # rounding in each march
    assert np.abs(found.imbalance).max() < 1e-10 * found.given.max()


def test_rigid_drive_under_a_load_is_em_slide():
    time = np.linspace(0, 0.02, 9)
    arguments = {"time": time, "position": 0.05 * time, "load": 20.0, "rtol": 3e-2}
    slide, drive = (
        em.slide(RUBBER, WAVY, **arguments),
        em.drive(RUBBER, WAVY, **arguments),
    )
    assert drive.converged.all()
    np.testing.assert_allclose(drive.mu[2:], slide.mu[2:], rtol=1e-2)
    np.testing.assert_allclose(drive.depth[2:], slide.depth[2:], rtol=1e-2)


def test_mount_of_a_whole_body_shared_among_its_lines():
    """A line under 20 N/m of 40 N has half of everything, so that it swings as the
    whole does.
    """
    whole = em.Mount(5.0, 5e3, 20.0)
    shared = whole.for_line(20.0, 40.0)
    assert (shared.mass, shared.stiffness, shared.damping) == (2.5, 2.5e3, 10.0)
    assert jax.grad(lambda f: whole.for_line(20.0, f).stiffness)(40.0) == pytest.approx(
        -2.5e3 / 40
    )
    for arguments, words in (
        ((0.0, 40.0), ("load", 0)),
        ((20.0, -1.0), ("normal_force", -1)),
    ):
        with refused(*words):
            whole.for_line(*arguments)


def test_swing_of_a_body_without_friction():
    """X' = V (1 - cos wt) without a damper: 2 in each period. With one the rest of it
    dies as exp(-c t/2m).
    """
    mass, k, speed = 0.5, 800.0, 0.03
    period = 2 * np.pi * np.sqrt(mass / k)
    time = period * np.arange(3 * 24 + 1) / 24

    def pulled(c, speed=speed):
        return em.drive(
            em.Foundation.kelvin(1e4, 1.0),
            FLAT,
            time=time,
            position=speed * time,
            load=1.0,
            rtol=1e-1,
            tangential=em.Mount(mass, k, c),
        )

    still = pulled(0.0, 0.0)
    assert np.isnan(still.swing(period)).all()
    for wrong in (0.0, 1e-9, 4 * period):
        with refused("period"):
            still.swing(wrong)
    # zeta = 0.1
    whole = jax.jit(jax.vmap(lambda c: pulled(c).swing(period)))
    swing = whole(jnp.array([0.0, 4.0]))
    np.testing.assert_allclose(swing[0], 2.0, rtol=1e-2)
    fade = np.exp(-2 * np.pi * 0.1 / np.sqrt(1 - 0.1**2))
    np.testing.assert_allclose(swing[1, 2:] / swing[1, 1:-1], fade, rtol=3e-2)


@pytest.mark.slow
def test_stiff_spring_drags_the_body_and_no_contact_leaves_it_free():
    time = np.linspace(0, 0.01, 9)
    stiff = em.drive(
        RUBBER,
        WAVY,
        time=time,
        position=0.05 * time,
        load=20.0,
        tangential=em.Mount(1e-2, 1e6, 50.0),
        rtol=5e-2,
    )
    assert stiff.converged.all()
    # The body rings with v/omega = 5 um at first, which fades with c/2m = 2500 1/s;
    # F_x/k is below 1 um.
    np.testing.assert_allclose(stiff.position[2:], stiff.drive[2:], atol=1e-6)
    time = np.linspace(0, 0.01, 129)
    free = em.drive(
        RUBBER,
        FLAT,
        time=time,
        position=0.05 * time,
        load=20.0,
        tangential=em.Mount(1e-3, 1e3),
        rtol=1e-2,
    )
    # a flat body feels no friction: X = v (t - sin(omega t)/omega)
    omega = np.sqrt(1e6)
    np.testing.assert_allclose(
        free.position, 0.05 * (time - np.sin(omega * time) / omega), atol=2e-3 * 5e-4
    )


def ball(samples, spacing):
    """A ball on mounts in both directions, over rubber: the depth, the place and the
    missing energy at the end.
    """
    # 6 mm of the finest
    surface = indenter(
        SingleLine(em.Paraboloid(0.01)), -2e-3 + 0.3 * spacing, spacing, 600, 1.0
    )
    law = jax.tree.map(jnp.asarray, RUBBER.law())
    scene = MotionScene(law, surface, Mount(0.02, 5e3, 1.0), Mount(0.02, 1e3, 0.5))
    time = np.linspace(0, 4e-3, 5)
    given = (0.4 * time, np.full(5, 10.0), 1e-3, 0)
    steps, instants = even_steps(time, *given, samples)
    seen, _ = run(scene, steps, instants)
    given, kept = seen.driven + seen.pressed, seen.work + seen.damped
    spring = 2.5e3 * (0.4 * time - seen.position) ** 2 + 500 * seen.depth**2
    np.testing.assert_allclose(seen.spring, spring, rtol=1e-12)
    missing = jnp.abs(given - kept - seen.kinetic - spring).max() / given.max()
    return np.array([seen.depth[-1], seen.position[-1]]), float(missing)


def test_second_order_and_energy_balance():
    sizes = 2 ** np.arange(3)
    ends, missing = zip(*(ball(int(32 * s), 4e-5 / s) for s in sizes), strict=True)
    change = np.abs(np.diff(ends, axis=0)).max(axis=0) / np.abs(ends[-1])
    assert (change < 0.05).all()
    last = np.abs(ends[-1] - ends[-2]) / np.abs(ends[-1])
    assert (last < 1e-3).all()
    slope = -np.polyfit(np.log(sizes), np.log(missing), 1)[0]
    assert slope > 1.7
    assert missing[-1] < 1e-3


@pytest.mark.slow
def test_gradient_through_the_motion_meets_finite_differences():
    time = np.linspace(0, 4e-3, 5)

    def place(mass, modulus):
        rubber = em.Foundation(4e6, jnp.stack([modulus]), [1e-3])
        found = em.drive(
            rubber,
            WAVY,
            time=time,
            position=0.05 * time,
            load=20.0,
            tangential=em.Mount(mass, 1e4, 1.0),
            rtol=1e-1,
        )
        return found.position[-1] * 1e4

    at = (jnp.asarray(5e-3), jnp.asarray(12e6))
    both = jax.jit(jax.value_and_grad(place, argnums=(0, 1)))
    slopes = both(*at)[1]
    for i in range(2):
        ends = [
            both(*(a * (1 + s * 1e-4 * (i == j)) for j, a in enumerate(at)))[0]
            for s in (1, -1)
        ]
        np.testing.assert_allclose(
            slopes[i] * at[i], (ends[0] - ends[1]) / 2e-4, rtol=2e-3, atol=1e-6
        )


@pytest.mark.slow
def test_reverse_gradient_of_a_record_with_many_branches():
    """By the spring and the level of twelve moduli, of stick and slip over 60 instants:
    some 600 steps of two marches. A record of 400 instants, 20 branches and 256
    elements takes 1.6 GB, most of it to compile.
    """
    time, times = np.linspace(0, 0.06, 60), np.geomspace(1e-4, 1.0, 12)

    def place(stiffness, level):
        rubber = em.Prony(1e6, level * np.full(12, 0.75e6), times)
        found = em.drive(
            rubber,
            em.Sphere(5e-3),
            time=time,
            position=0.04 * time,
            load=1.0,
            tangential=em.Mount(0.1, stiffness, 1.0),
            elements=64,
        )
        return found.position[-1] * 1e3

    at = np.array([1e4, 1.0])
    with jax.enable_x64(True):
        both = jax.jit(jax.value_and_grad(place, argnums=(0, 1)))
        slopes = both(*at)[1]
        for i, step in enumerate(np.diag(1e-4 * at)):
            ends = [both(*(at + s * step))[0] for s in (1, -1)]
            np.testing.assert_allclose(
                slopes[i] * at[i], (ends[0] - ends[1]) / 2e-4, rtol=1e-4
            )


def test_a_reverse_gradient_takes_time_in_proportion_to_the_march():
    """Sixteen times the blocks of steps took 200 times as long while what was seen of
    the whole history was part of the state. The best of nine ratios is taken, as what
    else the machine does lengthens either.
    """

    class Lag(NamedTuple):
        h: jax.Array
        w: jax.Array

    def slope(blocks):
        steps = Lag(jnp.full(64 * blocks, 1e-3), jnp.linspace(0, 1, 64 * blocks))

        def total(rate):
            def step(u, now):
                return u + now.h * rate * (now.w - u), now.w

            seen = march.march(
                step, jnp.multiply, jnp.zeros(64), steps, None, lambda block: block
            )[1]
            return jnp.sum(seen)

        return jax.jit(jax.grad(total)).lower(2.0).compile()

    def seconds(slope):
        begin = process_time()
        slope(2.0).block_until_ready()
        return process_time() - begin

    few, many = slope(32), slope(512)
    assert min(seconds(many) / seconds(few) for _ in range(9)) < 4 * 16


def test_refuses_bad_mounts():
    for name, value in {"mass": 0.0, "stiffness": -1.0, "damping": np.nan}.items():
        with refused(name, f"{value:g}"):
            em.Mount(**{"mass": 1.0, name: value})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"tangential": 3.0}, ("tangential", "em.Mount")),
        ({"track": WAVY}, ("track",)),
        ({"time": [0.0, 0.0]}, ("time", "ascending")),
        ({"load": -1.0}, ("load",)),
        (
            {"material": em.Foundation(1e9, [], [], per_area=True)},
            ("material", "half-space"),
        ),
    ],
)
def test_refuses_bad_input(change, message):
    arguments = {
        "material": RUBBER,
        "time": [0.0, 1.0],
        "position": [0.0, 0.0],
        "load": 1.0,
    } | change
    with refused(*message):
        em.drive(arguments.pop("material"), WAVY, **arguments)


FAST = {
    "material": em.Prony(2e5, [1e6], [1e-3]),
    "shape": em.Paraboloid(0.01),
    "load": 2.0,
    "tangential": Mount(0.05, 2e3, 1.0),
}


@pytest.mark.parametrize("speed", [0.3, 20.0])
def test_a_motion_that_takes_too_long_is_refused_with_one_that_does_not(
    monkeypatch, speed
):
    """The work is known beforehand; the part of the motion that the refusal names is
    computed.
    """
    monkeypatch.setattr(refinement, "_WORK", 5e5)
    time = np.linspace(0, 0.05 / speed, 401)

    def part(until):
        some = time[time <= until]
        return em.drive(**FAST, time=some, position=speed * some, rtol=0.1)

    with refused("position", "shorter") as caught:
        part(time[-1])
    lasts = float(re.search(r"the first (\S+) s of it", str(caught.value))[1])
    assert 0.02 * time[-1] < lasts < time[-1]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ConvergenceWarning)
        assert part(lasts).time.size > 2
    with refused("position", "shorter"):
        part(5 * lasts)


def test_a_long_motion_can_be_interrupted(monkeypatch):
    """Ctrl-C while it is marched ends it within the piece, of the many it has."""
    pieces = []

    @contextlib.contextmanager
    def counted(doing, total):
        assert doing.startswith("motion on grid 1 of at most")

        def count(steps):
            pieces.append(steps / total)
            if len(pieces) == 2:  # a signal, which arrives within compiled code
                threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()

        yield count

    monkeypatch.setattr(march, "counted", counted)
    monkeypatch.setattr(march, "_PIECE", 2e6)
    time = np.linspace(0, 0.5, 51)
    # a run in the background ignores it, and packages take it for themselves
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            em.drive(**FAST, time=time, position=4.0 * time)
    finally:
        signal.signal(signal.SIGINT, before)
    assert 2 <= len(pieces) < 0.5 / max(pieces)
