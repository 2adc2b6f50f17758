"""Bodies that move over elements in `diffeqsolve`: against closed forms and another
solver, and with what diffrax offers.
"""

from functools import cache

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix
import pytest

import elastomdr as em

LAW = em.Foundation(1.2e6, [2.8e6], [2e-3])
RADIUS, MASS, SPEED = 1e-2, 5e-3, 1.0
STEP = em.elements.ContactStep(4)


@pytest.fixture(autouse=True)
def float64():
    with jax.enable_x64(True):
        yield


@cache
def paraboloid(count):
    """The same function each time: one to compile for."""
    x = (np.arange(count) + 0.5) * (8e-3 / count) - 4e-3
    return lambda X: -((x - X) ** 2) / RADIUS


def ball(count=200, **others):
    """A paraboloid above `count` elements over 8 mm."""
    return em.elements.MovingBody(
        MASS, surface=paraboloid(count), spacing=8e-3 / count, **others
    )


def bounce(body, law, steps=256, **options):
    """Its step is an array: one compiled solve serves every number of them."""
    return diffrax.diffeqsolve(
        body,
        STEP,
        0.0,
        4e-3,
        jnp.asarray(4e-3 * STEP.samples / steps),
        body.start(law, sinking=SPEED),
        law,
        **options,
    )


def test_a_ball_bounces_as_by_impact():
    """`em.impact` marches no elements; what is left of the grid falls by four."""
    exact = em.impact(LAW, em.Paraboloid(RADIUS), mass=MASS, velocity=SPEED)
    coarse, fine = (
        bounce(ball(count), LAW, steps).ys.sinking[-1]
        for count, steps in ((100, 128), (200, 256))
    )
    off = np.abs(np.array([coarse, fine]) / -SPEED - float(exact.restitution))
    assert off[1] < 3e-4
    assert 3 < off[0] / off[1] < 5


def test_order_two_in_the_step():
    """A mass on Kelvin elements under a flat body is a damped oscillator."""
    law, mass, spring, damper, load = (
        em.Foundation(3.0, [], [], 0.4),
        2.0,
        1.0,
        0.1,
        5.0,
    )
    body = em.elements.MovingBody(
        mass, spring, damper, load, surface=lambda X: jnp.zeros(4), spacing=0.25
    )
    gamma, natural = (0.4 + damper) / (2 * mass), (3.0 + spring) / mass
    omega, rest = np.sqrt(natural - gamma**2), load / (3.0 + spring)
    decayed = np.exp(-gamma) * (np.cos(omega) + gamma / omega * np.sin(omega))
    off = []
    for steps in (32, 64, 128):
        step = jnp.asarray(STEP.samples / steps)
        end = diffrax.diffeqsolve(body, STEP, 0.0, 1.0, step, body.start(law), law).ys
        off.append(float(end.depth[-1]) - rest * (1 - decayed))
    np.testing.assert_allclose(np.log2(np.divide(off[:-1], off[1:])), 2.0, atol=0.05)


def test_what_is_saved_and_where_it_stops():
    """ts, steps and a dense solution of one solve; contact lost and a body that turns
    are events.
    """
    body = ball()
    saved = bounce(
        body,
        LAW,
        saveat=diffrax.SaveAt(ts=[1e-3, 2e-3], steps=True, dense=True),
        max_steps=64,
    )
    assert saved.ys.depth.size == 2 + 64
    exact = bounce(body, LAW, saveat=diffrax.SaveAt(ts=[1e-3, 2e-3])).ys.depth
    for t, depth in zip((1e-3, 2e-3), exact, strict=True):
        np.testing.assert_allclose(saved.evaluate(t).depth, depth, rtol=1e-12)

    lost = diffrax.Event(
        lambda t, y, args, **_: (y.sinking < 0) & (jnp.max(y.line.q) <= 0)
    )
    end = bounce(body, LAW, event=lost)
    assert end.result == diffrax.RESULTS.event_occurred
    depths = bounce(body, LAW, saveat=diffrax.SaveAt(steps=True), max_steps=64)
    np.testing.assert_allclose(end.ys.sinking, depths.ys.sinking[-1:], rtol=1e-12)

    turns = diffrax.Event(
        lambda t, y, args, **_: y.sinking, optimistix.Newton(1e-10, 1e-12)
    )
    turned = bounce(body, LAW, event=turns)
    assert abs(float(turned.ys.sinking[-1])) < 1e-9
    k = int(np.argmax(depths.ys.depth))
    assert depths.ts[k - 1] <= turned.ts[0] <= depths.ts[k + 1]


def test_steps_to_a_tolerance():
    """Errors as lengths, by halved steps: they fall with the tolerance, and so do the
    steps where nothing happens.
    """
    body = ball()
    exact = bounce(body, LAW, 4096).ys.sinking[-1]
    off, steps = [], []
    for rtol in jnp.array([1e-3, 1e-4, 1e-5]):
        controller = diffrax.PIDController(rtol=rtol, atol=1e-4 * rtol)
        found = bounce(body, LAW, stepsize_controller=controller)
        off.append(abs(float(found.ys.sinking[-1] / exact - 1)))
        steps.append(int(found.stats["num_accepted_steps"]))
    assert off[0] < 1e-2
    assert off[2] < off[1] < off[0]
    assert off[2] < 1e-4
    assert steps[0] < steps[1] < steps[2] < 200
    to = diffrax.StepTo(jnp.linspace(0, 4e-3, 65))
    np.testing.assert_allclose(
        diffrax.diffeqsolve(
            body,
            STEP,
            0.0,
            4e-3,
            None,
            body.start(LAW, sinking=SPEED),
            LAW,
            stepsize_controller=to,
        ).ys.depth,
        bounce(body, LAW).ys.depth,
        rtol=1e-10,
    )


def test_derivatives_by_every_adjoint():
    """Rebound of a ball that is pulled over the rubber, by a modulus and by its
    speed.
    """

    def rebound(p, adjoint):
        law = em.Foundation(1.2e6, p[:1], [2e-3])
        body = ball(64, tangential=em.Mount(MASS, 50.0), drive=lambda t: 0.3 * t)
        y = diffrax.diffeqsolve(
            body,
            STEP,
            0.0,
            2e-3,
            2e-3 / 8,
            body.start(law, sinking=p[1], velocity=0.3),
            law,
            max_steps=8,
            adjoint=adjoint,
        ).ys
        return y.sinking[-1] + y.velocity[-1]

    p = jnp.array([2.8e6, SPEED])
    value = jax.jit(lambda p: rebound(p, diffrax.DirectAdjoint()))
    steps = 1e-5 * np.diag(p)
    slopes = [float(value(p + h) - value(p - h)) / 2e-5 for h in steps]
    forward = jax.jacfwd(lambda p: rebound(p, diffrax.ForwardMode()))(p)
    np.testing.assert_allclose(forward * p, slopes, rtol=1e-5)
    for adjoint in (diffrax.RecursiveCheckpointAdjoint(), diffrax.DirectAdjoint()):
        reverse = jax.grad(lambda p, a=adjoint: rebound(p, a))(p)
        np.testing.assert_allclose(reverse, forward, rtol=1e-9)


def test_energy_and_forces():
    """What the ball loses is stored and dissipated; the forces of the elements carry
    it.
    """
    body = ball(tangential=em.Mount(MASS))
    law = LAW
    y = diffrax.diffeqsolve(
        body,
        STEP,
        0.0,
        1.2e-3,
        1.2e-3 / 64,
        body.start(law, velocity=0.5, sinking=SPEED),
        law,
    ).ys
    y = jax.tree.map(lambda x: x[-1], y)
    kinetic = 0.5 * MASS * (0.5**2 + SPEED**2 - y.velocity**2 - y.sinking**2)
    assert float(kinetic) == pytest.approx(float(y.work), rel=2e-3)
    stored = float(body.spacing * jnp.sum(em.elements.energy(law, y)))
    assert 0.3 * float(y.work) < stored < float(y.work)
    felt = em.elements.forces(law, y)
    touched = felt.q > 0
    total = felt.spring + felt.branches.sum(axis=0)
    np.testing.assert_allclose(total[touched], felt.q[touched], rtol=1e-9)
    np.testing.assert_allclose(total[~touched], 0.0, atol=1e-9 * felt.q.max())
    assert 30 < touched.sum() < 180


def test_a_body_without_mass_carries_its_load():
    x = jnp.linspace(-4e-3, 4e-3, 400)
    body = em.elements.MovingBody(
        None,
        load=lambda t: 3.0 + 100 * t,
        surface=lambda X: -((x - X) ** 2) / RADIUS,
        spacing=x[1] - x[0],
        drive=lambda t: 0.2 * t,
    )
    y = diffrax.diffeqsolve(
        body,
        STEP,
        0.0,
        0.01,
        5e-4,
        body.start(LAW),
        LAW,
        saveat=diffrax.SaveAt(steps=True),
    )
    carried = body.spacing * jnp.sum(y.ys.line.q[:20], axis=1)
    np.testing.assert_allclose(carried, 3.0 + 100 * y.ts[:20], rtol=2e-4)
    np.testing.assert_allclose(y.ys.position[:20], 0.2 * y.ts[:20])


def test_refused():
    body = ball()
    rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
    with pytest.raises(em.InputError, match="half_space") as raised:
        diffrax.diffeqsolve(body, STEP, 0.0, 1.0, 0.1, body.start(LAW), rubber)
    assert raised.value.argument == "args"
    soft = em.Softening([0.01, 1.0], [1.0, 0.5], [1.0, 0.5])
    softening = em.half_space(em.Prony(1e6, [1e6], [1e-3], softening=soft))
    with pytest.raises(em.InputError, match="soften"):
        diffrax.diffeqsolve(body, STEP, 0.0, 1.0, 0.1, body.start(LAW), softening)
    for given, name in (
        ({"mass": -1.0}, "mass"),
        ({"mass": None, "spring": 1.0}, "spring"),
        ({"mass": 1.0, "tangential": 3.0}, "tangential"),
        ({"mass": 1.0, "spacing": 0.0}, "spacing"),
    ):
        given = {"surface": jnp.zeros, "spacing": 1.0, **given}
        with pytest.raises(em.InputError) as raised:
            em.elements.MovingBody(**given)
        assert raised.value.argument == name
    with pytest.raises(em.InputError):
        em.elements.rest(LAW, 0)


def test_never_in_32_bits():
    with jax.enable_x64(False), pytest.raises(em.InputError, match="enable_x64"):
        diffrax.diffeqsolve(
            em.elements.RigidSurface(lambda t: jnp.full(3, t)),
            STEP,
            0.0,
            1.0,
            0.1,
            em.elements.rest(LAW, 3),
            LAW,
        )
