"""Transient sliding on rough lines: the spline, a closed form in full contact,
energies, renewed contact.
"""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.element.body_over_line import rough
from elastomdr.element.moving_body import MotionScene
from elastomdr.material.relaxation import Relaxation
from elastomdr.surface.rough_line import spline, spline_coefficients
from elastomdr.transient.march import run
from elastomdr.transient.problem import Steps

RUBBER = em.Foundation(4e6, [12e6, 3e6], [1e-3, 1e-1])
POINTS = np.arange(96) * 1e-5
MODES = ((1e-6, 1), (5e-7, 3), (2e-7, 5))  # amplitude [m], waves in the period
WAVES = em.RoughLine(
    POINTS, sum(a * np.cos(2 * np.pi * m * POINTS / 9.6e-4 + m) for a, m in MODES)
)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def test_spline_interpolates_and_is_periodic():
    from scipy.interpolate import CubicSpline

    length = WAVES.period
    truth = CubicSpline(
        np.append(POINTS, length),
        np.append(WAVES.height, WAVES.height[0]),
        bc_type="periodic",
    )
    for shift in (0.0, 0.3, -7.25, 1001.5):
        height, slope = spline(
            spline_coefficients(jnp.asarray(WAVES.height)), jnp.asarray(shift)
        )
        place = (POINTS + shift * 1e-5) % length
        np.testing.assert_allclose(height, truth(place), atol=1e-18)
        np.testing.assert_allclose(slope / 1e-5, truth(place, 1), atol=1e-13)
    finer = WAVES.finer(2)
    np.testing.assert_allclose(finer.height[1::2], truth(POINTS + 5e-6), atol=1e-18)
    assert np.isclose(finer.period, length, rtol=1e-14)


def test_depth_of_a_rough_line_counts_from_the_highest_place_of_its_spline():
    """So `em.slide` and `em.friction`, which refines the line through its spline, mean
    the same depth.
    """
    from scipy.interpolate import CubicSpline

    ends = np.append(POINTS, WAVES.period), np.append(WAVES.height, WAVES.height[0])
    truth = CubicSpline(*ends, bc_type="periodic")
    highest = truth(truth.derivative().roots(extrapolate=False)).max()
    np.testing.assert_allclose(
        [WAVES.highest, WAVES.finer(2).highest], highest, rtol=1e-12
    )
    assert WAVES.height.max() < highest - 1e-10
    assert em.RoughLine(POINTS, 0 * POINTS).highest == 0
    slope = jax.grad(lambda h: em.RoughLine(POINTS, h).highest)(
        jnp.asarray(WAVES.height)
    )
    higher = em.RoughLine(POINTS, WAVES.height + 1e-12 * np.arange(96)).highest
    np.testing.assert_allclose(
        (higher - WAVES.highest) / 1e-12, slope @ np.arange(96.0), rtol=1e-3
    )


def test_full_contact_is_the_closed_form():
    """F_x per length = sum (1/2) A^2 k E''(k v), the mean force E_inf times the mean
    displacement.
    """
    v, k = 0.02, 2 * np.pi / float(WAVES.period)
    time = np.linspace(0, 0.8, 5)
    slide = em.slide(RUBBER, WAVES, time=time, position=v * time, depth=1e-5, rtol=1e-2)
    exact = sum(0.5 * a**2 * m * k * RUBBER.loss(m * k * v) for a, m in MODES)
    assert slide.converged.all()
    np.testing.assert_allclose(slide.friction_force[-1], exact, rtol=1e-4)
    sunk = 1e-5 - float(WAVES.highest - WAVES.height.mean())
    np.testing.assert_allclose(
        slide.normal_force[-1], RUBBER.relaxation(0.8) * sunk, rtol=1e-3
    )


def branch_losses(history):
    """int sum f_k^2/(E_k tau_k) dt of elements that follow u exactly: a loop of its
    own, Gauss points in each step.
    """
    steps, u, modulus, tau = history
    node, weight = np.polynomial.legendre.leggauss(24)
    f, loss = np.zeros_like(u[0]), 0.0
    for h, before, after in zip(steps, u[:-1], u[1:], strict=True):
        rate = (after - before) / h
        t = h * (node + 1) / 2
        at = f[:, None] * np.exp(-t / tau) + modulus * tau * rate[:, None] * -np.expm1(
            -t / tau
        )
        loss += (at**2 @ weight).mean() * h / 2 / (modulus * tau)
        f = f * np.exp(-h / tau) + modulus * tau * rate * -np.expm1(-h / tau)
    return loss


def test_energy_is_stored_or_lost_in_the_branches():
    """In full contact the work is that stored and what the branches lose, integrated
    apart, to 1e-8 of the work.
    """
    law = Relaxation(*map(np.asarray, (4e6, np.array([12e6]), np.array([1e-3]), 0.0)))
    surface = rough(jnp.asarray(WAVES.height), WAVES.spacing, WAVES.highest)
    h = np.geomspace(1e-5, 1e-3, 64)
    h[0] = 1e-15  # put down at once
    x = np.cumsum(np.full(64, 7e-6))
    depth = 1e-5 + 1e-6 * np.sin(np.arange(64.0))
    steps = Steps(*map(jnp.asarray, (h, x, depth)))
    seen, _ = run(MotionScene(law, surface), steps, control="depth", balance=False)
    u = np.stack(
        [
            np.zeros(96),
            *(depth[:, None] + jax.jit(jax.vmap(surface.rise))(jnp.asarray(x))),
        ]
    )
    lost = branch_losses((h, u, 12e6, 1e-3))
    np.testing.assert_allclose(
        seen.work[-1] - seen.stored[-1],
        lost,
        rtol=0,
        atol=1e-8 * float(seen.work[-1]),
    )


def test_zero_load_and_renewed_contact_everywhere_at_once():
    """A flat line on one standard element: pressed, lifted, pressed again before the
    element has recovered.
    """
    flat = em.RoughLine(POINTS, 0 * POINTS)
    law = em.Foundation(1e6, [4e6], [1e-2])
    time = np.array([0.0, 0.01, 0.01, 0.02, 0.02, 0.03])
    slide = em.slide(
        law,
        flat,
        time=time,
        position=0 * time,
        load=[8.0, 8.0, 0.0, 0.0, 8.0, 8.0],
        rtol=1e-2,
    )
    # At the load: u = F J(t); the load is taken off and put on again, all by
    # superposition of creep.
    creep = law.creep_compliance(np.maximum(time, 0))
    one, two = (
        law.creep_compliance(np.maximum(time - 0.01, 0)),
        law.creep_compliance(np.maximum(time - 0.02, 0)),
    )
    exact = 8 * np.array(
        [creep[0], creep[1], creep[2] - one[2], creep[3] - one[3], 0, 0]
    )
    exact[4:] = 8 * (creep[4:] - one[4:] + two[4:])
    assert slide.converged.all()
    np.testing.assert_allclose(slide.depth, exact, rtol=1e-4)
    np.testing.assert_allclose(slide.normal_force, [8, 8, 0, 0, 8, 8], atol=1e-9)
    np.testing.assert_array_equal(
        np.isnan(slide.mu), [False, False, True, True, False, False]
    )


def test_a_branch_far_faster_than_the_step_does_nothing():
    surface = rough(jnp.asarray(WAVES.height), WAVES.spacing, WAVES.highest)
    steps = Steps(jnp.full(64, 1e-3), 3e-6 * jnp.arange(64.0), jnp.full(64, 1.0))
    stiff, plain = (
        Relaxation(
            *map(np.asarray, (4e6, np.array([1e7, e]), np.array([1e-2, 1e-12]), 0.0))
        )
        for e in (1e9, 0.0)
    )
    found, expected = (
        run(MotionScene(law, surface), steps, balance=False)[0]
        for law in (stiff, plain)
    )
    np.testing.assert_allclose(found.drag[5:], expected.drag[5:], rtol=1e-4)
    np.testing.assert_allclose(found.depth, expected.depth, rtol=1e-4)
