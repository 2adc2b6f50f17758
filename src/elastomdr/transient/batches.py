"""Many histories at once, in batches of few sizes, so that few programs are
compiled.
"""

from typing import Any

import numpy as np

from ..arrays import compiled, mapped, on_numpy, xp
from ..checks import Array, is_traced
from .depth_history import History, indent_between
from .panels import cuts

_BATCH = 64  # histories computed at once


def over_histories(
    function: Any,
    law: Any,
    modes: Any,
    disc: Any,
    *histories: Any,
    levels: int | None = None,
) -> Any:
    """`function` for every history, where JAX computes in one compiled call; NumPy
    arrays unless traced.
    """
    count = histories[0].shape[0]
    if on_numpy():
        static = {} if levels is None else {"levels": levels}
        found = [
            function(law, modes, disc, *(h[i] for h in histories), **static)
            for i in range(count)
        ]
        return mapped(lambda *a: np.stack(a), *found)
    size = batch(count)
    more = -count % size
    traced = is_traced(law, modes, disc, *histories)
    numpy = xp if traced else np
    full = tuple(
        numpy.concatenate([h, numpy.repeat(h[:1], more, axis=0)]) if more else h
        for h in histories
    )
    out = _mapped(law, modes, disc, *full, function=function, levels=levels, size=size)
    return mapped(lambda a: a[:count] if traced else np.asarray(a)[:count], out)


def batch(count: int) -> int:
    """How many of `count` histories are computed at once."""
    return min(_BATCH, 1 << (count - 1).bit_length())


@compiled("function", "levels", "size")
def _mapped(
    law: Any,
    modes: Any,
    disc: Any,
    *histories: Any,
    function: Any,
    levels: int | None,
    size: int,
) -> Any:
    import jax

    static = {} if levels is None else {"levels": levels}

    def one(history: tuple[Array, ...]) -> Any:
        return function(law, modes, disc, *history, **static)

    if histories[0].shape[0] == size:
        return jax.vmap(one)(histories)
    return jax.lax.map(one, histories, batch_size=size)


def indent_all(
    law: Any,
    modes: Any,
    disc: Any,
    time: np.ndarray,
    depth: np.ndarray,
    radius: np.ndarray,
    levels: int,
    size: int,
) -> History:
    """Depths that are linear between the instants, (histories, m), with panels of a
    level between the edges.

    One compiled program serves all levels: it takes `size` rows of `cuts` of any
    histories.
    """
    rows = cuts(levels)
    if on_numpy():
        parts = np.tile(np.append(rows[:, :-1], 1.0), (len(time), 1))
        found, _ = over_histories(
            indent_between, law, modes, disc, time, depth, radius, parts
        )
        return found._replace(radius=np.array(radius))
    which, row = np.divmod(np.arange(len(time) * len(rows)), len(rows))
    sums = []
    for i in range(0, which.size, size):
        taken = np.minimum(np.arange(i, i + size), which.size - 1)
        history = (a[which[taken]] for a in (time, depth, radius))
        found, _ = over_histories(
            indent_between, law, modes, disc, *history, rows[row[taken]]
        )
        sums.append(found)
    joined = mapped(
        lambda *a: np.concatenate(a)[: which.size].reshape(len(time), len(rows), -1),
        *sums,
    )
    return mapped(lambda a: a.sum(axis=1), joined)._replace(radius=np.array(radius))
