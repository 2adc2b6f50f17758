"""One element under a surface that comes and goes, against an integrator with events
and against the contact step.
"""

from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import eigvals

from elastomdr.arrays import numpy_unless_traced
from elastomdr.element import contact_step as steps_of_elements
from elastomdr.element import episode
from elastomdr.element.contact_step import rest
from elastomdr.element.episode import recovery_modes, to_branches, to_modes
from elastomdr.element.moments import panel_sums
from elastomdr.material.relaxation import Relaxation
from elastomdr.rough.free_steps import line_law
from elastomdr.rough.period import coefficients as period_coefficients
from elastomdr.rough.period import sweep

# one program each, in place of one for each operation
contact_step = jax.jit(steps_of_elements.contact_step)
energies, follow, force, pressed = map(
    jax.jit, (episode.energies, episode.follow, episode.force, episode.pressed)
)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def one_element_by_events(law, corners):
    """u, q, work and heat of one element along a surface with the given corners (t, w):
    scipy, event by event.
    """
    modulus, weights, times = float(law.equilibrium), law.moduli, law.times
    glassy = modulus + weights.sum()
    state, touching = np.zeros(1 + len(weights) + 2), False  # u, f, work, heat
    for (t0, w0), (t1, w1) in pairwise(corners):
        v, now = (w1 - w0) / (t1 - t0), t0

        def rates(t, y, v=v, touching=False):
            f = y[1:-2]
            speed = v if touching else (f / times).sum() / glassy
            q = modulus * y[0] + f.sum()
            return np.concatenate(
                [
                    [speed],
                    weights * speed - f / times,
                    [q * speed, (f**2 / weights / times).sum()],
                ]
            )

        def meets(t, y, w0=w0, t0=t0, v=v):
            return y[0] - (w0 + v * (t - t0))

        def pulls(t, y):
            return modulus * y[0] + y[1:-2].sum()

        while now < t1 * (1 - 1e-14):
            event = pulls if touching else meets
            event.terminal, event.direction = True, -1
            if not touching and meets(now, state) <= 1e-13 and rates(now, state)[0] < v:
                touching = True
                continue
            solution = solve_ivp(
                lambda t, y, on=touching: rates(t, y, touching=on),
                (now, t1),
                state,
                "DOP853",
                rtol=1e-12,
                atol=1e-15,
                events=event,
            )
            now, state = solution.t[-1], solution.y[:, -1]
            touching = touching != (solution.status == 1)
    return (
        state[0],
        (modulus * state[0] + state[1:-2].sum()) * touching,
        state[-2],
        state[-1],
    )


CORNERS = [
    (0.0, -0.2),
    (1.0, 1.0),
    (1.4, -0.2),
    (1.7, -0.2),
    (2.4, 0.8),
    (3.0, 0.75),
    (3.2, 0.5),
    (4.0, 0.3),
]
BRANCHES = Relaxation(*map(np.asarray, (1.0, [3.0, 1.0, 0.5], [0.05, 0.5, 4.0], 0.0)))


def test_one_element_by_events_through_contact_recovery_and_renewed_contact():
    modes = recovery_modes(BRANCHES)
    state = pressed(BRANCHES, modes, jnp.array([CORNERS[0][1]]))
    seen = []
    for (t0, w0), (t1, w1) in pairwise(CORNERS):
        v = (w1 - w0) / (t1 - t0)
        state = follow(BRANCHES, modes, state, jnp.array([w0]), v, t1 - t0)
        seen.append(bool(state.contact[0]))
    assert sum(np.diff(np.array([False, *seen], int)) == 1) == 2  # touched twice
    held, left = energies(BRANCHES, modes, state)
    u, q, work, heat = one_element_by_events(BRANCHES, CORNERS)
    np.testing.assert_allclose(
        [state.u[0], force(BRANCHES, state, v)[0], state.work[0]],
        [u, q, work],
        rtol=1e-9,
        atol=1e-11,
    )
    # Energy audit: the heat is the integrator's own sum over the dashpots.
    np.testing.assert_allclose(heat, state.work[0] - held[0] - left[0], rtol=1e-8)


def test_contact_step_converges_to_the_exact_element():
    """Slope 2 of the step method against the element solved without steps."""
    modes = recovery_modes(BRANCHES)
    corners = CORNERS[:6]
    exact = pressed(BRANCHES, modes, jnp.array([corners[0][1]]))
    for (t0, w0), (t1, w1) in pairwise(corners):
        exact = follow(
            BRANCHES, modes, exact, jnp.array([w0]), (w1 - w0) / (t1 - t0), t1 - t0
        )
    target = force(BRANCHES, exact, 0.0)[0]
    counts = np.array([3000, 12000, 48000])
    law = jax.tree.map(jnp.asarray, BRANCHES)

    @jax.jit
    def marched(w, h):
        state, _ = jax.lax.scan(
            lambda s, e: (contact_step(law, s, *e, h), None),
            rest(law, 1),
            (w[:-1], w[1:]),
        )
        return state.q[0]

    errors = []
    for n in counts:
        t = np.linspace(0, corners[-1][0], n + 1)
        errors.append(
            abs(marched(np.interp(t, *np.transpose(corners))[:, None], t[1]) - target)
        )
    slope = np.polyfit(np.log(counts), np.log(errors), 1)[0]
    assert -2.6 < slope < -1.5
    assert errors[-1] < 1e-7 * target


def test_modes_and_branches_are_inverse():
    liquid = Relaxation(
        np.asarray(0.0), BRANCHES.moduli, BRANCHES.times, BRANCHES.viscosity
    )
    damped = Relaxation(
        BRANCHES.equilibrium, BRANCHES.moduli, BRANCHES.times, np.asarray(0.3)
    )
    for law in (BRANCHES, liquid, damped):
        modes = recovery_modes(law)
        m = np.random.default_rng(1).uniform(0, 1, (modes.rate.size, 5))
        f = to_branches(law, modes, m)
        rate = -(modes.rate[:, None] * m).sum(0)
        np.testing.assert_allclose(
            law.equilibrium * m.sum(0) + f.sum(0) + law.viscosity * rate, 0, atol=1e-12
        )
        np.testing.assert_allclose(to_modes(law, modes, m.sum(0), f), m, rtol=1e-11)


@pytest.mark.parametrize("seed", range(2))
def test_random_elements_with_renewed_contact(seed):
    """Random branches and paths: force, work and heat against scipy, contact by
    contact.
    """
    rng = np.random.default_rng(seed)
    times = np.sort(10 ** rng.uniform(-1.5, 1, 3))
    law = Relaxation(
        *map(np.asarray, (rng.uniform(0.2, 2), rng.uniform(0.2, 4, 3), times, 0.0))
    )
    corners = list(
        zip(np.arange(10) * 0.4, np.append(-0.1, rng.uniform(-0.4, 1, 9)), strict=True)
    )
    corners[4] = (corners[4][0], -0.3)  # let go at least once
    modes = recovery_modes(law)
    state = pressed(law, modes, jnp.array([corners[0][1]]))
    v = 0.0
    for (t0, w0), (t1, w1) in pairwise(corners):
        v = (w1 - w0) / (t1 - t0)
        state = follow(law, modes, state, jnp.array([w0]), v, t1 - t0)
    got = [float(x[0]) for x in (state.u, force(law, state, v), state.work, state.heat)]
    np.testing.assert_allclose(
        got, one_element_by_events(law, corners), rtol=1e-8, atol=1e-10
    )


@pytest.mark.parametrize("viscosity", [0.0, 40.0])
def test_one_period_of_a_rough_line_is_made_of_contact_steps(viscosity):
    """The sweep of rough lines has a step of its own, which one kernel runs: in contact
    the same, free its own.
    """
    law, rise = (
        Relaxation(
            1e6, np.array([2e6, 5e5]), np.array([2e-4, 3e-3]), np.asarray(viscosity)
        ),
        1e-6 * np.cos(2 * np.pi * np.arange(65) / 64),
    )
    rise, h, depth = np.minimum(rise - rise[0], 0.0), 1e-4, 5e-7
    start = np.array([[0.1], [0.3]])  # the slowest first
    found = sweep(
        rise,
        64,
        1,
        np.array([depth]),
        start,
        period_coefficients(line_law(law), np.array([h])),
        2,
        True,
    )
    state = rest(law, 1)._replace(
        u=jnp.array([depth]), f=jnp.asarray(start[::-1]), q=jnp.ones(1)
    )
    touching = 0
    for w0, w1 in pairwise(rise + depth):
        state = contact_step(law, state, jnp.array([w0]), jnp.array([w1]), h)
        touching += int(state.q[0] > 0)
    np.testing.assert_allclose(found.u, state.u, rtol=1e-12)
    np.testing.assert_allclose(found.branches[::-1], state.f, rtol=2e-3)
    assert int(found.touching[0]) == touching


@pytest.mark.parametrize("viscosity", [0.0, 3e-3, 40.0])
@pytest.mark.parametrize("moduli", [[2e6, 5e5, 1e7], [2e6, 0.0, 1e-3], [1e9, 1e9, 1e3]])
def test_free_steps_have_the_rates_of_free_recovery(viscosity, moduli):
    """Eigenvalues of a free step are exp(-h/lambda), lambda those of u' and f_k' by
    scipy; whatever the step.
    """
    moduli, times = np.array(moduli), np.array([2e-7, 2e-4, 3e-3])
    law = Relaxation(np.asarray(1e6), moduli, times, np.asarray(viscosity))
    if viscosity:
        move = -np.append(1e6, np.ones(3)) / viscosity  # u' by u and f
    else:
        move = np.append(0.0, 1 / times) / (1e6 + moduli.sum())
    rates = np.vstack([move, moduli[:, None] * move])
    rates[1:, 1:] -= np.diag(1 / times)
    live = np.append(True, moduli > 0)
    rates = -np.sort(-eigvals(rates[live][:, live]).real)
    for h in (1e-9, 1e-6, 1e-4, 1e-2):
        by = period_coefficients(line_law(law), np.array([h]))
        gain, keep = np.append(1e6, by.gain[:, 0]), np.append(1.0, by.keep[:, 0])
        step = np.diag(keep) - np.outer(gain, by.give * np.append(1.0, by.seen[:, 0]))
        found = -np.sort(-eigvals(step[: live.sum(), : live.sum()]).real)
        exact = (
            np.exp(h * rates) if viscosity else np.append(np.exp(h * rates[1:]), 0.0)
        )
        np.testing.assert_allclose(found, exact, rtol=1e-7, atol=1e-11)


@pytest.mark.parametrize("count", [3, 12, 20])
def test_moments_on_numpy_and_on_jax_agree(count):
    """NumPy makes an array of all moments, JAX sums as it goes: the same sums, for
    short and for long panels.
    """
    rng = np.random.default_rng(count)
    c, kappa = (
        rng.normal(size=(count, *[1] * 5)),
        rng.normal(size=(2 * count, *[1] * 5)),
    )
    z = np.concatenate([[0.0], np.geomspace(1e-9, 1e6, 60)]).reshape(1, 1, 1, 1, -1)
    numbers = numpy_unless_traced(panel_sums)(c, kappa, z)
    with jax.enable_x64(True):
        compiled = jax.jit(panel_sums)(c, kappa, z)
    for here, there in zip(numbers, compiled, strict=True):
        np.testing.assert_allclose(
            np.broadcast_to(here, z.shape), there, rtol=1e-11, atol=1e-13
        )
