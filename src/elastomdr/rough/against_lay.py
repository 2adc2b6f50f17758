"""Averages over the angle on a surface with a lay, in a given direction of sliding.

A wave at the angle phi to the motion shakes the rubber at the frequency w cos phi, w =
q v, and carries the share W(q, b) of the spectrum (`elastomdr.surface.lay`), b = phi +
theta its angle to the lay where the motion is at theta to it:

    drag = int W cos(phi) Im E*(w cos phi) dphi,    stiffness = int W |E*(w cos phi)|^2 dphi.

They depend on q and v by themselves, so that only the moduli are tabulated. Between the
two places where the integrand is not smooth, waves along which nothing moves (phi = 90
degrees, a power of cos phi) and those across the lay (a peak of W of width 1/g), the
angle is L/(1 + exp(-t)), t even: the integrand is analytic over t, and the trapezoidal
rule converges exponentially.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

import numpy as np

from ..arrays import Array, xp
from .psd_integrals import Averages, Moduli, Modulus, Tables, moduli_table, read_columns

if TYPE_CHECKING:
    from ..surface.lay import Lay

Which: TypeAlias = "np.ndarray | slice"  # of the points
_STEP, _STEPS = 0.5, 34  # of t, and how many on either side of zero
_LEAST = np.exp(-2 * _STEP * _STEPS)  # cosine that is looked at
_MOST = 4000  # frequencies that are averaged at once, each at all angles


class Directed(NamedTuple):
    """A surface with a lay, and the direction of sliding at each point."""

    lay: Lay | None  # None where only a map knows directions
    direction: Array  # angle to the lay [rad], (points,)

    def of(self, points: Which) -> Directed:
        """The same for some of the points."""
        return self._replace(direction=self.direction[points])


def to_points(directed: Directed | None) -> Array | None:
    """Its direction (1, points), as a number that need not be positive."""
    return None if directed is None else directed.direction[None]


def of_points(lay: Lay | None, direction: Array | None) -> Directed | None:
    """`Directed` of what `to_points` gave."""
    return None if direction is None else Directed(lay, direction[0])


class Angles(NamedTuple):
    """Nodes over the directions of waves, (points, angles)."""

    cosine: Array  # cos phi, positive
    width: Array  # of int_0^2pi dphi
    cos_square: Array  # of the angle to the lay, b
    sin_square: Array


def angles(direction: Array) -> Angles:
    """Nodes for motions at `direction` [rad] to the lay, (points,)."""
    t = _STEP * np.arange(-_STEPS, _STEPS + 1)
    near = 1 / (1 + np.exp(-t))
    far = near[::-1]
    # counted from the waves along which nothing moves, those across the lay are here
    peak = xp.mod(-direction, np.pi)[:, None]
    rest = np.pi - peak
    cosine = xp.sin(xp.concatenate([peak * near, rest * far], -1))
    # where the motion is along the lay the first part is no longer than nothing
    cosine = xp.maximum(cosine, _LEAST)
    from_peak = xp.concatenate([peak * far, rest * near], -1)
    width = 2 * _STEP * near * far
    return Angles(
        cosine,
        xp.concatenate([peak * width, rest * width], -1),
        xp.sin(from_peak) ** 2,
        xp.cos(from_peak) ** 2,
    )


def directed_table(modulus: Modulus, low: float, high: float, step: float) -> Tables:
    """The moduli that `averages` asks for, at frequencies q v from `low` to `high`."""
    return moduli_table(modulus, low * _LEAST, high, step)


def averages(
    moduli: Moduli,
    w: Array,
    q: Array,
    directed: Directed,
    finer: float,
    parted: bool,
) -> Averages:
    """`Averages` at frequencies w (points, cells, nodes) of wave numbers q (cells,
    nodes).
    """
    if not isinstance(moduli, Tables):  # JAX traces
        return _averages(moduli, w, q, directed, finer, parted)
    size = max(1, _MOST // w[0].size)
    parts = [
        _averages(moduli, w[batch], q, directed.of(batch), finer, parted)
        for batch in (slice(i, i + size) for i in range(0, w.shape[0], size))
    ]
    drag, stiffness, stiffer, lost = zip(*parts, strict=True)
    return Averages(
        np.concatenate(drag),
        np.concatenate(stiffness),
        np.concatenate(stiffer),
        np.concatenate(lost) if parted else None,
    )


def _averages(
    moduli: Moduli,
    w: Array,
    q: Array,
    directed: Directed,
    finer: float,
    parted: bool,
) -> Averages:
    assert directed.lay is not None
    over = Angles(*(x[:, None, None] for x in angles(directed.direction)))
    weight = over.width * directed.lay.weight(
        q[..., None], over.cos_square, over.sin_square
    )

    def at_angles(w: Array) -> tuple[Any, Any]:
        """Im E* and |E*|^2 at each angle."""
        if not isinstance(moduli, Tables):
            value = moduli(w[..., None] * over.cosine)
            return value.imag, value.real**2 + value.imag**2
        log_w = np.log(w)[..., None] + np.log(over.cosine)
        loss, square = read_columns(moduli, log_w, slice(None))
        return np.exp(loss), np.exp(square)

    loss, square = at_angles(w)
    stiffness = (weight * square).sum(-1)
    stiffer = 0.0 * stiffness
    if finer:
        _, in_contact = at_angles(w * np.exp(finer))
        stiffer = xp.log((weight * in_contact).sum(-1) / stiffness)
    return Averages(
        (weight * over.cosine * loss).sum(-1),
        stiffness,
        stiffer,
        (weight * loss**2).sum(-1) / stiffness if parted else None,
    )
