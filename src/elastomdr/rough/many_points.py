"""Points on one surface by the tens of thousands: the same integrals, compiled by JAX
for an accelerator.

On a processor NumPy is as fast, and starts at once (`benchmarks/accelerator.py`).
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np

from ..arrays import Array, on_jax
from .local_modulus import Local
from .psd_integrals import Nodes, Tables
from .road_model import WaveByWave, WaveProblem

# points from which an accelerator is asked for: below, compiling takes longer
_MANY = 20_000
_BATCH = 16_384  # some gigabytes of memory


def worth_compiling(count: int, local: Local) -> bool:
    """Whether so many points are asked for that an accelerator which JAX finds is
    faster. Softening, heat and direction, which differ from point to point, stay on
    NumPy.
    """
    if count < _MANY or any(field is not None for field in local):
        return False
    import jax

    return jax.default_backend() != "cpu"


def friction_and_area(
    model: WaveByWave,
    wave_nodes: Nodes,
    table: Tables,
    velocity: Array,
    pressure: Array,
) -> tuple[np.ndarray, np.ndarray]:
    """mu and area of real contact at points (velocity [m/s], pressure [Pa]), flat."""
    return on_jax(_in_batches, model, wave_nodes, table, velocity, pressure)


def _in_batches(
    model: WaveByWave,
    wave_nodes: Nodes,
    table: Tables,
    velocity: Array,
    pressure: Array,
) -> tuple[Any, Any]:
    import jax

    program = _program(model, table.step, table.first)
    shared = jax.device_put((wave_nodes, table.cubics))
    count = velocity.size
    size = min(_BATCH, count)
    answers = []
    for start in range(0, count, size):
        # the last batch is filled up, so that one program serves all
        points = np.minimum(np.arange(start, start + size), count - 1)
        answers.append(program(*shared, velocity[points], pressure[points]))
    mu, area = (np.concatenate(batch)[:count] for batch in zip(*answers, strict=True))
    return mu, area


@functools.lru_cache(maxsize=8)
def _program(model: WaveByWave, step: float, first: int) -> Any:
    import jax

    def evaluate(
        wave_nodes: Nodes, cubics: np.ndarray, velocity: Array, pressure: Array
    ) -> Any:
        table = Tables(step, first, cubics)
        waves = model.waves(WaveProblem(table, wave_nodes, velocity, pressure))
        return waves.each.sum((-2, -1)) + waves.edges, waves.area

    return jax.jit(evaluate)
