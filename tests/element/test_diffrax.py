"""The contact step as a diffrax solver: samples, interface, batches, gradients."""

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.element.contact_step import rest
from elastomdr.element.elements import ContactStep, RigidSurface
from elastomdr.element.law import Foundation
from elastomdr.errors import InputError
from elastomdr.material.relaxation import Relaxation

from .surfaces import Indenter, Waves, solve


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


def test_samples_are_single_steps():
    law = Foundation(0.1, [3.0, 2.0], [0.01, 0.5], 0.05)
    one, many = (
        solve(law, Waves(5), 2.0, 256, 5, samples=samples) for samples in (1, 32)
    )
    for a, b in zip(one.ys, many.ys, strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-10, atol=1e-14)
    assert (int(one.stats["num_steps"]), int(many.stats["num_steps"])) == (256, 8)


def test_interface_to_diffrax():
    law, term = Foundation.kelvin(1.0, 0.1), RigidSurface(Waves(3))
    assert ContactStep().order(term) == 2
    with pytest.raises(InputError, match="ContactStep for a RigidSurface"):
        diffrax.diffeqsolve(term, diffrax.Heun(), 0.0, 1.0, 0.1, rest(law, 3), law)
    solution = solve(
        law,
        Waves(3),
        2.0,
        64,
        3,
        samples=1,
        most=64,
        saveat=diffrax.SaveAt(dense=True, steps=True),
    )
    middle = solution.evaluate(0.5 * (solution.ts[10] + solution.ts[11]))
    np.testing.assert_allclose(middle.u, 0.5 * (solution.ys.u[10] + solution.ys.u[11]))
    # compiled apart: its sines differ in the last digit
    surface = jax.vmap(Waves(3))(solution.ts[:64])
    assert (solution.ys.u[:64] >= surface - 1e-15).all()


@pytest.mark.filterwarnings("ignore:Explicitly requested dtype")
def test_32_bits_are_refused_after_a_solve_in_64():
    law, x = Foundation(1.2e6, [2.8e6], [2e-3]), np.linspace(-4e-3, 4e-3, 41)
    ball = em.elements.MovingBody(
        5e-3, surface=lambda place: -((x - place) ** 2) / 1e-2, spacing=x[1] - x[0]
    )

    def solved(start):
        return diffrax.diffeqsolve(ball, ContactStep(), 0.0, 2e-5, 1e-5, start, law).ys

    start = ball.start(law, sinking=1.0)
    assert solved(start).depth.shape == (1,)
    assert em.elements.energy(law, start).dtype == np.float64
    with jax.enable_x64(False):
        for argument, call in {
            "y0": lambda: ball.start(law, sinking=1.0),
            "y0 ": lambda: solved(start),
            "state": lambda: em.elements.energy(law, start),
            "state ": lambda: em.elements.forces(law, start),
        }.items():
            with pytest.raises(InputError) as caught:
                call()
            assert caught.value.argument == argument.strip()


def test_batches_and_step_to():
    law = Foundation(1.0, [5.0], [0.1])
    times = jnp.asarray([0.0, 0.1, 0.3, 1.0])

    def run(velocity):
        surface = Indenter(jnp.asarray(0.1), 1.0, velocity)
        controller = diffrax.StepTo(times)
        return diffrax.diffeqsolve(
            RigidSurface(surface),
            ContactStep(8),
            0.0,
            1.0,
            None,
            rest(law, 1),
            law,
            stepsize_controller=controller,
        ).ys.work[-1, 0]

    velocities = jnp.asarray([0.05, 0.1, 0.2])
    np.testing.assert_allclose(
        jax.vmap(run)(velocities), [run(v) for v in velocities], rtol=1e-13
    )


@pytest.mark.slow
def test_gradients_forward_and_reverse():
    """d(mu)/d(E_inf, E_k, tau_k, eta, a): both modes agree, and with central
    differences.
    """

    def friction(p, adjoint):
        law = Relaxation(p["equilibrium"], p["moduli"], p["times"], p["viscosity"])
        y = solve(
            law,
            Indenter(p["entry"], 1.0, 0.05),
            4.1,
            64,
            samples=16,
            most=4,
            adjoint=adjoint,
        ).ys
        return y.work[-1, 0] / y.impulse[-1, 0]

    p = dict(
        equilibrium=1.0,
        moduli=jnp.asarray([5.0, 2.0]),
        times=jnp.asarray([0.1, 3.0]),
        viscosity=0.2,
        entry=0.1,
    )
    p = jax.tree.map(lambda x: jnp.array(x, jnp.float64), p)
    reverse = jax.jit(
        jax.value_and_grad(lambda p: friction(p, diffrax.RecursiveCheckpointAdjoint()))
    )
    forward = jax.jit(
        lambda p, d: jax.jvp(lambda p: friction(p, diffrax.ForwardMode()), (p,), (d,))[
            1
        ]
    )
    gradient = reverse(p)[1]
    for name, leaf in p.items():
        for i in range(leaf.size):
            step = (
                jnp.zeros(leaf.size)
                .at[i]
                .set(1e-6 * leaf.reshape(-1)[i])
                .reshape(leaf.shape)
            )
            up, down = ({**p, name: leaf + sign * step} for sign in (1, -1))
            slope = float(jnp.sum(gradient[name] * step))
            assert slope == pytest.approx(
                float(0.5 * (reverse(up)[0] - reverse(down)[0])), rel=1e-5
            )
            assert slope == pytest.approx(
                float(forward(p, jax.tree.map(jnp.zeros_like, p) | {name: step})),
                rel=1e-10,
            )


def test_reverse_derivative_of_stick_slip_is_the_forward_one():
    instants = np.linspace(0, 25e-3, 26)
    x = jnp.arange(32) * 1e-3 / 32
    k = 2 * np.pi / 1e-3

    def mean_place(branch, adjoint):
        law = em.Foundation(1e6, [branch], [2e-3])
        slider = em.elements.MovingBody(
            None,
            load=400.0,
            surface=lambda place: 5e-5 * (jnp.cos(k * (x - place)) - 1),
            spacing=1 / 32,
            tangential=em.Mount(2.0, 8e4),
            drive=lambda t: 0.15 * t,
        )
        return diffrax.diffeqsolve(
            slider,
            em.elements.ContactStep(16),
            0.0,
            instants[-1],
            None,
            slider.start(law),
            law,
            saveat=diffrax.SaveAt(ts=instants),
            stepsize_controller=diffrax.StepTo(ts=instants),
            max_steps=instants.size,
            adjoint=adjoint,
        ).ys.position.mean()

    at = jnp.asarray(4e6)
    forward = jax.jit(jax.jacfwd(lambda e: mean_place(e, diffrax.ForwardMode())))
    reverse = jax.jit(
        jax.grad(lambda e: mean_place(e, diffrax.RecursiveCheckpointAdjoint()))
    )
    np.testing.assert_allclose(reverse(at), forward(at), rtol=1e-9)
