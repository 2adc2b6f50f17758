"""Root search: what is no root is not called one, in NumPy and in JAX."""

import jax
import numpy as np
import pytest

from elastomdr.arrays import numpy_unless_traced, xp
from elastomdr.numerics import root


@numpy_unless_traced
def found(residual, guess):
    return root.root(residual, guess)


@pytest.mark.filterwarnings("ignore:invalid value")
@pytest.mark.parametrize(
    ("residual", "guess", "good"),
    [
        (lambda x: x - 1 + xp.array([0.0, np.nan]), [0.0, 0.0], [True, False]),
        # NaN before the root is reached, and behind it
        (lambda x: xp.where(x > 0.5, xp.nan, x - 1), [-2.0], [False]),
        (lambda x: xp.where(x > 1.5, xp.nan, xp.exp(x) - 1e-6), [2.0], [False]),
        (lambda x: xp.exp(x) - 2, [3.0], [True]),
    ],
)
def test_nan_is_no_root(residual, guess, good):
    guess = np.array(guess)
    x, done = found(residual, guess)
    np.testing.assert_array_equal(done, good)
    off = np.asarray(residual(np.asarray(x)))
    assert (np.abs(off[done]) < 1e-8).all()
    with jax.enable_x64(True):
        _, traced = jax.jit(lambda x: root.root(residual, x))(guess)
    np.testing.assert_array_equal(traced, good)
