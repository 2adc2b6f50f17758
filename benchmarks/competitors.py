"""The same line of elements under a paraboloid, integrated in time by stock solvers, by
a loop over equal steps that are exact in every branch, and by elastomdr's contact step.

With xi = (a - x)/a from entry to exit, forces per length in units of E_inf a^2/R, and
y_k = a/(v tau_k),

    df_k/dxi = (E_k/E_inf) (2 - 2 xi) - y_k f_k,
    q = xi (2 - xi) + sum_k f_k,
    dN/dxi = q,
    dT/dxi = 2 (1 - xi) q

until q = 0: F_N = E_inf (a^3/R) N and F_x = E_inf (a^4/R^2) T.
"""

import functools
from collections.abc import Callable

import diffrax
import jax
import jax.numpy as jnp
import numpy as np
import optimistix
import scene
import scipy.integrate

from elastomdr.element.contact_step import rest
from elastomdr.element.elements import ContactStep, RigidSurface
from elastomdr.material.relaxation import Relaxation

# (leading edges, velocities) -> (mu, F_N)
Lines = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]

jax.config.update("jax_enable_x64", True)

SHARES = scene.MODULI / scene.EQUILIBRIUM
BLOCK = 64  # contact steps per step of the solver


def kvaerno5(tolerance: float) -> Lines:
    """Stock diffrax: Kvaerno5, adaptive steps, an event at the exit, vmapped over the
    lines and compiled as a whole.
    """
    return _in_units(lambda decay: _kvaerno5(decay, tolerance))


@jax.jit
def _kvaerno5(decay, tolerance):
    def force(t, y, args, **kwargs):
        return t * (2 - t) + jnp.sum(y[0])

    def rates(xi, y, decay):
        q = force(xi, y, decay)
        return SHARES * (2 - 2 * xi) - decay * y[0], q, 2 * (1 - xi) * q

    def line(decay):
        zero = jnp.zeros(())
        solution = diffrax.diffeqsolve(
            diffrax.ODETerm(rates),
            diffrax.Kvaerno5(),
            t0=0.0,
            t1=2.0,
            dt0=None,
            y0=(jnp.zeros(SHARES.size), zero, zero),
            args=decay,
            stepsize_controller=diffrax.PIDController(rtol=tolerance, atol=tolerance),
            event=diffrax.Event(
                force, optimistix.Newton(1e-10, 1e-10), direction=False
            ),
            max_steps=50_000,
            throw=False,
        )
        ended = solution.result == diffrax.RESULTS.event_occurred
        return tuple(jnp.where(ended, solution.ys[i][-1], jnp.nan) for i in (1, 2))

    return jax.vmap(line)(decay)


def exponential(samples: int) -> Lines:
    """What one writes by hand: equal steps, exact in every branch, trapezoids, a `scan`
    compiled for all lines.
    """
    return _in_units(lambda decay: _exponential(decay, samples))


@functools.partial(jax.jit, static_argnames="samples")
def _exponential(decay, samples):
    h = 2.0 / samples
    z = decay.T * h
    keep, share = jnp.exp(-z), SHARES[:, None] * -jnp.expm1(-z) / z

    def step(state, xi):
        f, before, normal, drag, touches = state
        change = (2 - 2 * xi + h) * h
        f = keep * f + share * change
        q = xi * (2 - xi) + jnp.sum(f, axis=0)
        last = touches & (q <= 0)  # contact ends where q, linear over the step, is zero
        part = jnp.where(
            last,
            before / jnp.where(last, before - q, 1.0),
            jnp.where(touches, 1.0, 0.0),
        )
        mean = 0.5 * part * (before + jnp.maximum(q, 0.0))
        return (f, q, normal + h * mean, drag + change * mean, touches & (q > 0)), None

    zero = jnp.zeros(decay.shape[0])
    start = (jnp.zeros(z.shape), zero, zero, zero, jnp.ones(zero.shape, bool))
    _, _, normal, drag, _ = jax.lax.scan(step, start, h * jnp.arange(1, samples + 1))[0]
    return normal, drag


def contact_step(samples: int) -> Lines:
    """elastomdr's contact step in diffrax, `samples` equal steps from x = a to x = -a,
    all lines together.
    """

    @jax.jit
    def lines(decay):
        count = decay.shape[0]
        solution = diffrax.diffeqsolve(
            RigidSurface(lambda xi: jnp.full(count, xi * (2 - xi))),
            ContactStep(BLOCK),
            t0=0.0,
            t1=2.0,
            dt0=2.0 * BLOCK / samples,
            y0=rest(Relaxation(1.0, SHARES, SHARES, 0.0), count),
            args=Relaxation(1.0, SHARES, 1 / decay.T, 0.0),
            max_steps=samples // BLOCK + 1,
        )
        return solution.ys.impulse[-1], solution.ys.work[-1]

    return _in_units(lines)


def solve_ivp(method: str, tolerance: float) -> Lines:
    """A Python loop over `scipy.integrate.solve_ivp` with a terminal event at the
    exit.
    """

    def force(xi, y, decay):
        return xi * (2 - xi) + y[:-2].sum()

    def rates(xi, y, decay):
        q = force(xi, y, decay)
        return np.concatenate(
            [SHARES * (2 - 2 * xi) - decay * y[:-2], [q, 2 * (1 - xi) * q]]
        )

    force.terminal, force.direction = True, -1
    start = np.zeros(SHARES.size + 2)

    def lines(decay):
        ends = []
        for row in decay:
            found = scipy.integrate.solve_ivp(
                rates,
                (0, 2),
                start,
                method=method,
                events=force,
                args=(row,),
                rtol=tolerance,
                atol=tolerance,
            )
            ends.append(found.y[-2:, -1] if found.status == 1 else (np.nan, np.nan))
        return np.transpose(ends)

    return _in_units(lines)


def at_load(
    lines: Lines, velocity: np.ndarray, load: float, most: int = 20
) -> tuple[np.ndarray, int]:
    """mu at a load, by secant steps on log F_N against log a, and the passes over all
    lines that this took.
    """
    # Hertz, relaxed
    size = np.full(
        velocity.size, (0.75 * scene.RADIUS * load / scene.EQUILIBRIUM) ** (1 / 3)
    )
    slope, before, count = np.full(velocity.size, 3.0), None, 0
    while True:
        mu, force = lines(size, velocity)
        excess, place, count = np.log(force / load), np.log(size), count + 1
        if np.nanmax(np.abs(excess)) < 1e-8 or count == most:
            return mu, count
        if before is not None:
            moved = place - before[0]
            secant = (excess - before[1]) / np.where(moved == 0, 1, moved)
            slope = np.where((secant > 1) & (secant < 5), secant, slope)
        before = place, excess
        size = np.exp(place - excess / slope)


def _in_units(lines: Callable) -> Lines:
    def solved(size: np.ndarray, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        normal, drag = (
            np.asarray(x)
            for x in lines(size[:, None] / (velocity[:, None] * scene.TIMES))
        )
        return (
            drag / normal * size / scene.RADIUS,
            scene.EQUILIBRIUM * size**3 / scene.RADIUS * normal,
        )

    return solved
