"""Contact on a layer of rubber by cells: the judge of the stress test of layers.
Nothing is shared with elastomdr.

The surface of a layer of thickness h on a rigid base answers a wave of pressure by u =
2 W(kh) p/(k E*). `cylinder` slides on cells whose answers come from one long transform,
and finds its contact by elimination with a dense matrix; `ball` is pressed into an
elastic layer on a square of cells, by conjugate gradients (Polonsky and Keer 1999).
"""

from typing import Any

import numpy as np
from slow_route import Law
from slow_surface import modulus


def answer(z: Any, poisson: float, bonded: bool) -> np.ndarray:
    """W(z)/z, also at z = 0."""
    z = np.maximum(np.asarray(z, dtype=float), 1e-6)
    e = np.exp(-2 * np.minimum(z, 300))
    if not bonded:
        return ((1 - e) ** 2 / (1 - e**2 + 4 * z * e)) / z
    kappa = 3 - 4 * poisson
    y, term = (2 * z) ** 2, 2 * z
    rest = np.zeros_like(z)
    for n in range(1, 12):
        term = term * y / (2 * n * (2 * n + 1))
        rest += term
    # (sinh 2z - 2z) e^-2z
    rest = np.where(z < 1, rest * e, 0.5 * (1 - e**2) - 2 * z * e)
    sine, cosine = 0.5 * (1 - e**2), 0.5 * (1 + e**2)
    over = 2 * (kappa - 1) * sine + 2 * rest
    return over / (2 * kappa * cosine + (1 + kappa**2 + 4 * z**2) * e) / z


def cylinder(
    law: Law,
    poisson: float,
    bonded: bool,
    thickness: float,
    radius: float,
    velocity: float,
    load: float,
    size: float,
    cells: int,
) -> tuple[float, float, float]:
    """mu, leading and trailing edge of a cylinder under a load per length; `size` about
    half its contact.
    """
    step = size / cells
    memory = (
        velocity * law.times.max(initial=0.0) * (1 + law.moduli.sum() / law.equilibrium)
    )
    count = 1 << int(
        np.ceil(np.log2((40 * memory + 20 * thickness + 40 * size) / step))
    )
    if count > 1 << 22:
        raise ArithmeticError("too long a memory for cells")
    k = 2 * np.pi * np.fft.rfftfreq(count, step)
    own = np.conj(modulus(law, k * velocity))
    waves = 2 * thickness * answer(k * thickness, poisson, bonded) / own
    kernel = np.fft.irfft(waves, count)  # of the force of a cell over its width
    half = int(1.6 * cells)
    x = step * np.arange(-half, half + 1)
    place = np.arange(x.size)
    matrix = kernel[(place[:, None] - place) % count]
    on, gap0 = np.abs(x) <= size, -(x**2) / (2 * radius)
    for _ in range(100):
        some = np.flatnonzero(on)
        scale = abs(kernel[0])
        system = np.zeros((some.size + 1, some.size + 1))
        system[:-1, :-1] = matrix[np.ix_(some, some)] / scale
        system[:-1, -1], system[-1, :-1] = -1.0, 1.0
        found = np.linalg.solve(system, np.append(gap0[some] / scale, load / step))
        p = np.zeros(x.size)
        p[some] = found[:-1]
        gap = matrix @ p - found[-1] * scale - gap0
        pull, overlap = on & (p <= 0), ~on & (gap < -1e-12 * size**2 / radius)
        if not (pull | overlap).any():
            break
        on = (on & ~pull) | overlap
    else:
        raise ArithmeticError("no contact found")
    if on[0] or on[-1] or np.abs(np.diff(on.astype(int))).sum() != 2:
        raise ArithmeticError("the contact is not one strip within its window")
    drag = step * (p * x).sum() / radius
    return (
        float(drag / load),
        float(x[on].max() + 0.5 * step),
        float(-x[on].min() + 0.5 * step),
    )


def ball(
    poisson: float,
    bonded: bool,
    thickness: float,
    radius: float,
    depth: float,
    cells: int,
) -> float:
    """Force over E* of an elastic layer under a paraboloid at a depth."""
    # no contact is wider than the cut at the surface, and hardly at all
    reach = 1.1 * np.sqrt(2 * radius * depth)
    step = reach / cells
    count = 1 << int(np.ceil(np.log2((2 * reach + 8 * thickness) / step)))
    k = (
        2
        * np.pi
        * np.hypot(np.fft.fftfreq(count, step)[:, None], np.fft.rfftfreq(count, step))
    )
    waves = 2 * thickness * answer(k * thickness, poisson, bonded)
    # A cell of even pressure, not a wave: its own share by the transform of a square.
    x = step * (np.arange(count) - count // 2)
    wanted = depth - (x[:, None] ** 2 + x**2) / (2 * radius)
    p = np.where(wanted > 0, np.sqrt(np.maximum(wanted, 0.0)), 0.0)
    direction, old, free = np.zeros_like(p), 1.0, True

    def bent(q: np.ndarray) -> np.ndarray:
        return np.fft.irfft2(waves * np.fft.rfft2(q), s=q.shape)

    for turn in range(2000):
        on = p > 0
        gap = bent(p) - wanted
        now = (gap[on] ** 2).sum()
        direction = np.where(on, gap + (0.0 if free else now / old) * direction, 0.0)
        back = bent(direction)
        length = (gap[on] * direction[on]).sum() / (back[on] * direction[on]).sum()
        p = np.maximum(p - length * direction, 0.0)
        again = (p == 0) & (gap < 0)
        free = bool(again.any())
        p = np.where(again, p - length * gap, p)
        old = now
        if turn > 5 and not free and np.sqrt(now / max(on.sum(), 1)) < 1e-8 * depth:
            return float(p.sum() * step**2)
    raise ArithmeticError("no contact found")
