"""The exact contact step: Signorini's conditions, exact ramps, energy, order,
gradients, extremes.
"""

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

from elastomdr.element import contact_step as steps_of_elements
from elastomdr.element.contact_step import Elements, rest
from elastomdr.element.law import Foundation
from elastomdr.material.relaxation import Relaxation

from .surfaces import Indenter, Waves, solve

contact_step = jax.jit(steps_of_elements.contact_step)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


# ---------------------------------------------------------------- every step of any
# history

N = 16


def random_case(seed):
    """A law over 24 decades of tau and a history with steps over 20 decades; times,
    forces, lengths all of any size.
    """
    rng = np.random.default_rng(seed)
    k = 10
    times = np.sort(10 ** rng.uniform(-12, 12, k))
    moduli = 10 ** rng.uniform(0, 4, k) * (rng.random(k) < 0.8)
    equilibrium = 0.0 if seed % 3 == 0 else 10 ** rng.uniform(0, 3)
    viscosity = 0.0 if seed % 2 == 0 else 10 ** rng.uniform(-12, 12)
    law = Relaxation(*map(np.asarray, (equilibrium, moduli, times, viscosity)))
    steps = 10 ** rng.uniform(-10, 10, 200)
    surface = (
        np.cumsum(rng.normal(size=(201, N)), axis=0)
        * rng.choice([0.01, 1.0], size=(201, 1))
        - 0.5
    )
    return law, jnp.asarray(steps), jnp.asarray(surface)


@jax.jit
def history(law, steps, surface):
    def step(state, now):
        h, w_start, w_end = now
        after = contact_step(law, state, w_start, w_end, h)
        return after, after

    return jax.lax.scan(step, rest(law, N), (steps, surface[:-1], surface[1:]))[1]


@pytest.mark.parametrize("seed", range(12))
def test_signorini_at_every_step(seed):
    law, steps, surface = random_case(seed)
    y = history(law, steps, surface)
    assert all(np.isfinite(leaf).all() for leaf in y)
    gap = y.u - surface[1:]
    assert (y.q >= 0).all()
    assert (gap >= 0).all()
    np.testing.assert_array_equal(y.q * gap, 0.0)
    assert min((y.q > 0).sum(), (gap > 0).sum()) > 100  # the history visits both states
    if law.viscosity == 0:  # q is the force at the end of the step
        force = law.equilibrium * y.u + y.f.sum(axis=1)
        scale = law.equilibrium * np.abs(y.u) + np.abs(y.f).sum(axis=1)
        before = np.concatenate([np.zeros((1, N)), scale[:-1]])
        np.testing.assert_array_less(
            np.abs(force - y.q), 1e-12 * np.maximum(scale, before) + 1e-300
        )


@pytest.mark.parametrize("seed", range(12))
def test_work_never_falls_behind_the_energy_stored(seed):
    law, steps, surface = random_case(seed)
    y = history(law, steps, surface)
    weight = np.where(
        law.moduli > 0, 0.5 / np.where(law.moduli > 0, law.moduli, 1.0), 0.0
    )
    branches = (weight[:, None] * y.f**2).sum(axis=1)
    np.testing.assert_allclose(y.stored, branches, rtol=1e-12)
    stored = 0.5 * law.equilibrium * y.u**2 + branches
    scale = np.maximum.accumulate(np.maximum(np.abs(y.work), stored), axis=0)
    assert (y.work - stored >= -1e-12 * scale).all()
    lost = y.work - stored  # and what is lost stays lost
    assert (np.diff(lost, axis=0) >= -1e-12 * scale[1:]).all()


def press_and_release(law, h):
    one, n = jnp.ones(h.size), h.size
    state = contact_step(law, rest(law, n), 0 * one, one, h)
    return contact_step(law, state, one, -one, h)


@jax.jit
def with_derivatives(law, h):
    out, tangent = jax.jvp(
        press_and_release, (law, h), (jax.tree.map(jnp.ones_like, law), h)
    )
    return out, tangent, jax.grad(lambda law: press_and_release(law, h).u.sum())(law)


@pytest.mark.parametrize("viscosity", [0.0, 1e-20, 1.0, 1e20])
def test_no_step_is_too_long_or_too_short(viscosity):
    law = Relaxation(
        *map(np.asarray, (1.0, np.ones(41), np.logspace(-20, 20, 41), viscosity))
    )
    out, tangent, gradient = with_derivatives(law, jnp.logspace(-20, 20, 81))
    assert all(
        np.isfinite(leaf).all() for leaf in jax.tree.leaves((out, tangent, gradient))
    )
    assert ((out.u >= -1e-13) & (out.u <= 1)).all()


# ---------------------------------------------------------------- exact where the
# motion is linear


@pytest.mark.parametrize("h", [1e-20, 1e-6, 0.3, 2.0, 1e5, 1e20])
def test_a_ramp_is_exact(h):
    """f_k, int q dt and int q du of u = u0 + r t from any state, against the same
    integrals with 60 digits.
    """
    law = Relaxation(
        *map(jnp.asarray, (2.0, [3.0, 0.5, 7.0, 11.0], [1e-8, 0.1, 2.0, 1e7], 0.25))
    )
    u0, f0, u1 = 0.7, np.array([0.1, 0.2, 0.3, 0.05]), 1.3
    start = Elements(*(jnp.zeros(1) for _ in range(9)))._replace(
        u=jnp.full(1, u0), f=jnp.asarray(f0)[:, None]
    )
    start = start._replace(
        stored=jnp.sum(start.f**2 / (2 * law.moduli[:, None]), axis=0)
    )
    end = contact_step(law, start, jnp.full(1, u0), jnp.full(1, u1), h)
    with mp.workdps(60):
        rate, time = (mp.mpf(u1) - mp.mpf(u0)) / mp.mpf(h), mp.mpf(h)
        impulse = (
            2 * time * (mp.mpf(u0) + mp.mpf(u1)) / 2 + mp.mpf("0.25") * rate * time
        )
        for k in range(4):
            modulus, tau, f = (
                mp.mpf(float(x)) for x in (law.moduli[k], law.times[k], f0[k])
            )
            decay = mp.exp(-time / tau)
            after = f * decay + modulus * tau * rate * (1 - decay)
            impulse += f * tau * (1 - decay) + modulus * tau * rate * (
                time - tau * (1 - decay)
            )
            assert end.f[k, 0] == pytest.approx(float(after), rel=3e-15)
        assert end.impulse[0] == pytest.approx(float(impulse), rel=3e-15)
        # `work` counts E_inf u^2/2 from u = 0
        assert end.work[0] == pytest.approx(float(impulse * rate) + u0**2, rel=3e-15)
    assert end.u[0] == u1
    assert end.q[0] > 0


def test_force_at_the_end_of_a_ramp():
    """Standard solid pressed at constant rate: q = E_inf u + E_1 tau r (1 -
    exp(-t/tau)), in one step.
    """
    law = Foundation(4.0, [12.0], [0.5])
    for h in (1e-9, 0.2, 30.0):
        q = contact_step(law, rest(law, 1), jnp.zeros(1), jnp.full(1, 3.0 * h), h).q[0]
        assert q == pytest.approx(
            4 * 3 * h + 12 * 0.5 * 3 * -np.expm1(-h / 0.5), rel=1e-14
        )


@pytest.mark.parametrize("h", [1e-9, 0.1, 1.0, 50.0])
def test_kelvin_element_recovers_exactly(h):
    law = Foundation.kelvin(2.0, 0.5)
    held = contact_step(law, rest(law, 1), jnp.zeros(1), jnp.ones(1), 1.0)
    free = contact_step(law, held, jnp.ones(1), jnp.full(1, -1.0), h)
    assert free.u[0] == pytest.approx(np.exp(-2.0 * h / 0.5), rel=1e-13)
    assert free.q[0] == 0


def test_maxwell_element_recovers_its_spring_only():
    """E_inf = 0: held for t, a Maxwell element springs back by exp(-t/tau) of the
    displacement and stays there.
    """
    law = Foundation.maxwell(3.0, 2.0)
    state = contact_step(law, rest(law, 1), jnp.zeros(1), jnp.ones(1), 1e-12)
    state = contact_step(law, state, jnp.ones(1), jnp.ones(1), 2.0)
    for _ in range(3):
        state = contact_step(law, state, jnp.zeros(1), jnp.full(1, -1.0), 1e-12)
        assert state.u[0] == pytest.approx(1 - np.exp(-1.0), rel=1e-11)
    state = contact_step(law, state, jnp.full(1, -1.0), jnp.full(1, -1.0), 1e3)
    assert state.u[0] == pytest.approx(1 - np.exp(-1.0), rel=1e-11)


@pytest.mark.parametrize(("h", "away"), [(1.0, 0.5), (3.0, 0.2), (10.0, -1.0)])
def test_an_element_that_recovers_freely_feels_no_force(h, away):
    """int q dt and int q du stand still, and all of the step is time out of contact."""
    law, one = Foundation(1.0, [1.0], [1.0]), jnp.ones(1)
    pressed = contact_step(law, rest(law, 1), 0 * one, one, 1.0)
    start = contact_step(law, pressed, one, -one, 1e-6)
    assert start.q[0] == 0
    end = contact_step(law, start, away * start.u, away * start.u, h)
    assert end.u[0] > away * start.u[0]
    assert end.impulse[0] == start.impulse[0]
    assert end.work[0] == pytest.approx(float(start.work[0]), rel=1e-14)
    assert end.away[0] - start.away[0] == pytest.approx(h, rel=1e-14)


def test_one_law_per_element():
    """Times (k, n) and numbers (n,): n laws at once, as one after the other."""
    tau = jnp.asarray([[0.1, 1.0, 10.0], [2.0, 20.0, 200.0]])
    eta, w, h = (
        jnp.asarray([0.0, 0.1, 5.0]),
        jnp.asarray([0.5, 1.0, -1.0]),
        jnp.asarray([0.2, 0.3, 1.0]),
    )
    law = Relaxation(jnp.asarray(1.0), jnp.asarray([3.0, 4.0]), tau, eta)
    first = contact_step(law, rest(law, 3), jnp.zeros(3), jnp.ones(3), h)
    together = contact_step(law, first, jnp.ones(3), w, h)
    for i in range(3):
        own = Relaxation(law.equilibrium, law.moduli, tau[:, i], eta[i])
        first = contact_step(own, rest(own, 1), jnp.zeros(1), jnp.ones(1), h[i])
        alone = contact_step(own, first, jnp.ones(1), w[i : i + 1], h[i])
        for one, all_ in zip(alone, together, strict=True):
            np.testing.assert_allclose(
                one[..., 0], all_[..., i], rtol=1e-14, atol=1e-16
            )


# ---------------------------------------------------------------- order

# Steady sliding of a paraboloid, one line (closed forms: entry, exit where q = 0,
# elementary integrals). The inputs and values are the oracles
# slide_KV_parabola_fixed_depth (FN = 2E/(3R)[a^3 + (a^2+s^2)^1.5 - s^3], Fx = 2E/R^2
# [(2/3) s (a^3+p^3) + s^2 p^2], s = v eta/E, p = sqrt(a^2+s^2) - s),
# slide_Maxwell_parabola_fixed_depth (q = 2 E1 s/R [(x+s) - (a+s) exp(-(a-x)/s)]) and
# slide_SLS_parabola_fixed_load_v1.0.
SLIDING = {
    "kelvin": (
        Foundation.kelvin(1.0, 0.02),
        0.02,
        1.0,
        0.5,
        1.2120226591665965e-05,
        1.6240453183331932e-07,
    ),
    "maxwell": (
        Foundation.maxwell(12e6, 1e-3),
        1e-3,
        0.01,
        1.0,
        0.7771322854702978,
        0.03804348079027608,
    ),
    "solid": (
        Foundation(4e6, [12e6], [1e-3]),
        0.0022164889482227156,
        0.01,
        1.0,
        10.0,
        10 * 0.10866233408272157,
    ),
}
COUNTS = [256, 512, 1024, 2048]


@jax.jit
def slide(law, surface, count):
    y = solve(law, surface, 2 * surface.entry / surface.velocity, count).ys
    return surface.velocity * y.impulse[-1, 0], y.work[-1, 0]


@pytest.mark.parametrize("name", SLIDING)
def test_second_order_in_normal_and_friction_force(name):
    law, entry, radius, velocity, normal, friction = SLIDING[name]
    law, surface = jax.tree.map(
        np.asarray, (law.law(), Indenter(entry, radius, velocity))
    )
    forces = np.array([slide(law, surface, count) for count in COUNTS])
    errors = np.abs(forces / [normal, friction] - 1)
    slopes = np.polyfit(np.log(COUNTS), np.log(errors), 1)[0]
    np.testing.assert_allclose(slopes, -2, atol=0.03)
    assert max(errors[-1]) < 3e-6


@jax.jit
def over_waves(law, count):
    y = solve(law, Waves(12), 2.0, count, 12).ys
    return y.impulse[-1], y.work[-1]


@pytest.mark.parametrize(
    "law",
    [
        Relaxation(1.0, [0.0, 0.0], [1.0, 2.0], 0.1),
        Relaxation(1.0, [5.0, 0.0], [0.1, 1.0], 0.0),
        Relaxation(0.1, [3.0, 2.0], [0.05, 0.5], 0.05),
    ],
    ids=["kelvin", "solid", "both"],
)
def test_second_order_through_loss_of_contact_and_return(law):
    """Contact begins and ends inside steps, at 12 phases, more than once; against a
    march 16 times finer.
    """
    law = Relaxation(
        law.equilibrium, np.array(law.moduli), np.array(law.times), law.viscosity
    )
    counts = [256, 512, 1024, 2048, 4096]
    reference = np.array(over_waves(law, 65536))
    errors = [
        np.sqrt(
            np.mean((np.array(over_waves(law, count)) / reference - 1) ** 2, axis=1)
        )
        for count in counts
    ]
    slopes = np.polyfit(np.log(counts), np.log(errors), 1)[0]
    np.testing.assert_allclose(slopes, -2, atol=0.2)
