"""A cylinder that slides steadily on a layer, in plane strain, on a line of cells: a
slow solution to compare `smooth.cylinder_galerkin` with.

Cells of constant pressure; their influence from the complex compliance W(kh)/E*(kv) by
one long Fourier transform, less the instantaneous half-plane above its mirror image,
which is known in closed form; contact by letting go the cells that pull and taking in
those that overlap, with a dense solve for each set.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from elastomdr.element.layer import Layer
from elastomdr.material.relaxation import to_kelvin

_PIVOTS = 100
_FINE = 4  # samples of the transform per cell
_LONGEST = 2**23  # of the transform


def cylinder_on_cells(
    layer: Layer,
    radius: float,
    velocity: float,
    load_per_length: float,
    window: tuple[float, float],
    points: int = 400,
) -> tuple[float, float, float]:
    """mu, leading and trailing edge [m] of a cylinder on `points` cells over `window`
    [m], counted from the apex.

    The window has to hold the contact; what lies outside is free of pressure. The wake
    has to fit into the longest transform: `ValueError` otherwise, and where the contact
    does not settle or meets the end of its window.
    """
    width = (window[1] - window[0]) / points
    x = window[0] + width * (np.arange(points) + 0.5)
    influence = _influence(layer, velocity, width, points)
    matrix = influence[points - 1 + np.arange(points)[:, None] - np.arange(points)]
    touching, height = np.ones(points, dtype=bool), x**2 / (2 * radius)
    for _ in range(_PIVOTS):
        both = np.stack([np.ones(points), height], axis=1)[touching]
        one, two = np.linalg.solve(matrix[np.ix_(touching, touching)], both).T
        deep = (load_per_length / width + two.sum()) / one.sum()
        p = np.zeros(points)
        p[touching] = deep * one - two
        gap = height + matrix @ p - deep
        following = (touching & (p > 0)) | (~touching & (gap < 0))
        if (following == touching).all():
            break
        touching = following
    else:
        raise ValueError("the contact does not settle")
    if touching[0] or touching[-1]:
        raise ValueError("the contact reaches the end of its window")
    first, last = np.flatnonzero(touching)[[0, -1]]
    # the pressure falls as the root of the distance: its square meets zero along a line
    # through the last two cells
    trailing = x[first] - width * np.clip(
        p[first] ** 2 / (p[first + 1] ** 2 - p[first] ** 2), 0, 1
    )
    leading = x[last] + width * np.clip(
        p[last] ** 2 / (p[last - 1] ** 2 - p[last] ** 2), 0, 1
    )
    mu = float((p * x).sum() * width / (radius * load_per_length))
    return mu, float(leading), float(-trailing)


def _influence(layer: Layer, velocity: float, width: float, points: int) -> np.ndarray:
    """Displacement at offsets -(n - 1) ... n - 1 cells from a cell under unit
    pressure.
    """
    chains = [to_kelvin(cover.normal()) for cover in layer.covers]
    at_once = float(sum(chain.instantaneous for chain in chains))
    memory = velocity * max(
        float(chain.times[-1]) for chain in chains if chain.times.size
    )
    thickness = max(float(cover.thickness) for cover in layer.covers)
    period = 4 * points * width + 60 * thickness + 40 * memory
    step = width / _FINE
    count = 2 ** math.ceil(math.log2(period / step))
    if count > _LONGEST:
        raise ValueError("the wake is too long for this transform")
    k = 2 * math.pi * np.fft.rfftfreq(count, step)
    k[0] = 1e-9 / thickness
    total: Any = sum(
        np.asarray(cover.compliance(k * float(cover.thickness), k * velocity))
        for cover in layer.covers
    )
    rest = (
        2
        / k
        * (np.conj(total) - at_once * -np.expm1(-k * thickness))
        * np.sinc(k * width / (2 * math.pi))
        * width
    )
    along = np.fft.irfft(rest, count) / step
    offsets = np.arange(1 - points, points)
    edge = width * (np.arange(1 - points, points + 1) - 0.5)
    mirror = edge * np.log(np.hypot(edge, thickness)) + thickness * np.arctan(
        edge / thickness
    )
    closed = 2 * at_once / math.pi * np.diff(mirror - edge * np.log(np.abs(edge)))
    return along[_FINE * offsets] + closed
