"""Search in NumPy, differentiate the equation: derivatives of every order, batches, threads and one core."""

import os
import subprocess
import sys
import textwrap

import jax
import jax.numpy as jnp
import mpmath as mp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.element.moments import moments_on_host
from elastomdr.numerics.implicit import implicit, on_host


def _cube_root():
    """x of x^3 = a y, a shared; and a record of the shapes that the search sees."""
    seen = []

    def search(shared, points):
        seen.append(np.shape(points))
        return np.cbrt(shared * points), None

    solve = implicit(
        search, lambda x, _, a, y: x**3 - a * y, lambda _, points: (points, None)
    )
    return solve, seen


def test_derivatives_of_every_order():
    """x = (a y)^(1/3): by reverse and forward mode, mixed, and the third."""
    solve, _ = _cube_root()

    def x(a, y):
        return solve(a, y[None])[0]

    with jax.enable_x64(True):
        a, y = jnp.float64(2.0), jnp.float64(4.0)
        assert float(x(a, y)) == pytest.approx(2.0, rel=1e-15)
        assert float(jax.jit(jax.grad(x, 1))(a, y)) == pytest.approx(1 / 6, rel=1e-14)
        assert float(jax.jit(jax.jacfwd(x))(a, y)) == pytest.approx(1 / 3, rel=1e-14)
        mixed = jax.jit(jax.grad(jax.grad(x), 1))
        assert float(mixed(a, y)) == pytest.approx(2 / 9 / 8, rel=1e-14)
        third = jax.jit(jax.jacfwd(jax.hessian(lambda y: x(a, y))))
        assert float(third(y)) == pytest.approx(2 * 10 / 27 / 64, rel=1e-13)


def test_mapped_points_are_one_call_and_shared_numbers_are_many():
    solve, seen = _cube_root()
    y = np.linspace(1, 2, 6).reshape(2, 3, 1)
    with jax.enable_x64(True):
        by_points = jax.jit(jax.vmap(jax.vmap(solve, (None, 0)), (None, 0)))(2.0, y)
        assert seen == [(6,)]
        np.testing.assert_allclose(by_points, np.cbrt(2 * y), rtol=1e-15)
        seen.clear()
        by_both = jax.vmap(solve)(jnp.array([1.0, 8.0]), jnp.ones((2, 3)))
        assert len(seen) == 2
    np.testing.assert_allclose(by_both, [[1.0] * 3, [2.0] * 3], rtol=1e-15)


def test_numbers_keep_their_digits_in_a_program_of_a_user_without_64_bit_types():
    """A callback runs in a thread that does not know of `jax.enable_x64`, where JAX would round what it hands over."""
    seen = []

    def search(_, x):
        seen.append(x)
        return x + 1e-12

    def call(x):
        with jax.enable_x64(True):
            return (
                on_host(search, jnp.zeros(1), (), x.astype(float)[None] + 1e-10)[0] - 1
            ) * 1e10

    with jax.enable_x64(False):
        assert float(jax.jit(call)(1.0)) == pytest.approx(1.01, rel=1e-4)
    assert seen[0].dtype == np.float64


def test_large_arrays_on_one_core():
    """JAX's callbacks have been seen to wait for themselves where a process has one core only."""
    if not hasattr(os, "sched_setaffinity"):
        pytest.skip("this system does not bind processes to cores")
    code = """
    import os
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    import jax, numpy as np, jax.numpy as jnp
    from elastomdr.numerics.implicit import on_host
    jax.config.update("jax_enable_x64", True)
    def call(x):
        return on_host(lambda _, y: 2 * y, jax.ShapeDtypeStruct((10**6,), float), (), x * jnp.ones(10**6)).sum()
    assert float(jax.jit(call)(1.0)) == 2e6
    """
    done = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(code)],
        timeout=300,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr


def test_moments_and_their_derivatives():
    """mu_j(z) by its integral in 30 digits, and dmu_j/dz = -int c exp(-zc) P_j dc, in short and in long panels."""
    places = np.array([0.0, 1e-6, 0.3, 4.0, 50.0, 400.0])
    with jax.enable_x64(True):
        mu, slope = jax.jvp(moments_on_host(5), (jnp.asarray(places),), (jnp.ones(6),))
    with mp.workdps(30):
        for j in range(5):
            for i, z in enumerate(places):

                def weighted(power, j=j, z=z):
                    ends = [0, *(min(1, k / max(z, 1)) for k in (1, 10, 60)), 1]
                    return mp.quad(
                        lambda c: c**power * mp.exp(-z * c) * mp.legendre(j, 1 - 2 * c),
                        ends,
                    )

                assert float(mu[j, i]) == pytest.approx(
                    float(weighted(0)), rel=1e-12, abs=1e-15
                )
                assert float(slope[j, i]) == pytest.approx(
                    -float(weighted(1)), rel=1e-10, abs=1e-14
                )


BODIES = {
    "a ball under a load": lambda k: em.friction(
        RUBBER, em.Sphere(0.01 * k), velocity=SPEEDS, load=1.0
    ),
    "a cone at a depth": lambda k: em.friction(
        RUBBER, em.Cone(0.1 * k), velocity=SPEEDS, depth=1e-5, model=em.Line()
    ),
    "a paraboloid on springs": lambda k: em.friction(
        em.springs(RUBBER, 1e-2), em.Paraboloid(0.01 * k), velocity=SPEEDS, load=1.0
    ),
}
RUBBER = em.Prony(1e6, np.geomspace(1e8, 1e6, 4), np.logspace(-5, 1, 4), poisson=0.4)
SPEEDS = np.array([1e-3, 0.1, 10.0])


@pytest.mark.parametrize("body", BODIES)
def test_numbers_under_jit_are_those_outside(body):
    """In all bits: one search, and the plan is made of the same values."""

    def fields(k):
        r = BODIES[body](k)
        return r.mu, r.error, r.depth, r.contact.trailing, r.converged

    with jax.enable_x64(True):
        for inside, outside in zip(jax.jit(fields)(1.0), fields(1.0), strict=True):
            np.testing.assert_array_equal(inside, outside)


def test_values_that_no_contact_has_give_nan_under_jit():
    def mu(load, velocity):
        return em.friction(
            RUBBER, em.Cone(0.1), velocity=velocity, load=load, model=em.Line()
        ).mu

    with jax.enable_x64(True):
        found = jax.jit(mu)(np.array([1.0, -1.0, 1.0]), np.array([0.1, 0.1, np.nan]))
    np.testing.assert_array_equal(np.isfinite(found), [True, False, False])


def _paraboloid(modulus, velocity):
    """mu of a standard solid under a paraboloid of 5 mm and 1 N that slides, in mpmath, from its line force density.

    q = E (a^2 - x^2)/R + (2 E_1 s/R) [(x + s) - (a + s) exp(-(a - x)/s)], s = v tau, with q(-b) = 0, integrated.
    """
    relaxed, radius, s = mp.mpf(10) ** 6, mp.mpf("5e-3"), velocity * mp.mpf("1e-3")
    share = 2 * modulus * s / relaxed

    def density(x, a):
        return a**2 - x**2 + share * (x + s - (a + s) * mp.exp(-(a - x) / s))

    def force(x, a):
        return (
            a**2 * x
            - x**3 / 3
            + share * (x**2 / 2 + s * x - (a + s) * s * mp.exp(-(a - x) / s))
        )

    def drag(x, a):
        memory = x**3 / 3 + s * x**2 / 2 - (a + s) * s * (x - s) * mp.exp(-(a - x) / s)
        return a**2 * x**2 / 2 - x**4 / 4 + share * memory

    def missed(a, b):
        return [density(-b, a), relaxed / radius * (force(a, a) - force(-b, a)) - 1]

    a, b = mp.findroot(missed, (mp.mpf("7e-4"), mp.mpf("6e-4")))
    return 2 * relaxed / radius**2 * (drag(a, a) - drag(-b, a))


def test_second_derivatives_against_forty_digits():
    """A Newton step with slopes held, by which they were found until 0.2, has first derivatives only."""

    def mu(x):
        law = em.Foundation(1e6, [3e6 * x[0]], [1e-3])
        return em.friction(
            law,
            em.Paraboloid(5e-3),
            velocity=x[1],
            load=1.0,
            model=em.Line(),
            rtol=1e-9,
        ).mu

    with jax.enable_x64(True):
        found = jax.jit(jax.hessian(mu))(jnp.ones(2))
    with mp.workdps(40):
        for i, orders in enumerate(((2, 0), (1, 1), (0, 2))):
            exact = mp.diff(lambda x, y: _paraboloid(3 * 10**6 * x, y), (1, 1), orders)
            assert float(found[i // 2, (i + 1) // 2]) == pytest.approx(
                float(exact), rel=1e-11
            )


def test_derivatives_of_derivatives_in_reverse():
    """`jax.grad` of `jax.grad`, of numbers alone: the inner one is no program by itself."""

    def depth(load):
        return em.friction(
            em.Prony(1e6, [], []), em.Paraboloid(5e-3), velocity=1.0, load=load
        ).depth

    with jax.enable_x64(True):
        load = 4.0  # d of F = (4/3) E* sqrt(R) d^(3/2) goes as F^(2/3)
        assert float(jax.grad(jax.grad(depth))(load)) == pytest.approx(
            -2 / 9 * depth(load) / load**2, rel=1e-10
        )
