"""A function of parameters and its Jacobian as one compiled program, kept for other
measurements of the same scene.

Compiling takes some fifty times longer than computing. What a program has as constants
(material, shape, velocities, temperatures ...) are its key: where any of it differs,
another one is compiled.
"""

from collections.abc import Callable
from typing import Any

import jax
import numpy as np

from ..models import Model

_MOST = 8  # programs that are kept
_PROGRAMS: dict[Any, Any] = {}  # the least recently used one first


def with_jacobian(compute: Callable[[Any], Any], constants: Any) -> tuple[Any, Any]:
    """The value and the Jacobian of `compute` as functions of parameters, a vector.

    `constants` is a pytree of all that `compute` depends on; None where that is not
    known: nothing is kept then.
    """
    both = _program(compute, None if constants is None else _key(constants))
    last: dict[bytes, tuple[np.ndarray, np.ndarray]] = {}

    def at(p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        key = p.tobytes()
        if key not in last:
            jacobian, value = both(p)
            last.clear()
            last[key] = np.asarray(value), np.asarray(jacobian)
        return last[key]

    return lambda p: at(p)[0], lambda p: at(p)[1]


def _program(compute: Callable[[Any], Any], key: Any) -> Any:
    found = None if key is None else _PROGRAMS.pop(key, None)
    if found is None:
        found = jax.jit(jax.jacfwd(lambda p: 2 * (compute(p),), has_aux=True))
    if key is not None:
        _PROGRAMS[key] = found
        while len(_PROGRAMS) > _MOST:
            _PROGRAMS.pop(next(iter(_PROGRAMS)))
    return found


def _key(constants: Any) -> Any:
    """What is the same for the same constants; None where anything but numbers, texts
    and models is in them.
    """
    leaves, structure = jax.tree.flatten(constants)
    parts = []
    for leaf in leaves:
        if isinstance(leaf, (np.ndarray, np.generic, jax.Array)):
            array = np.asarray(leaf)
            parts.append((array.shape, array.dtype.str, array.tobytes()))
        elif isinstance(leaf, (bool, int, float, str, Model)):
            parts.append((type(leaf), leaf))
        else:
            return None
    key = structure, tuple(parts)
    try:
        hash(key)
    except TypeError:  # a static field that is no constant
        return None
    return key
