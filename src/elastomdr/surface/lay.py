"""How the spectrum of a ground, turned or brushed surface depends on direction.

With b the angle of a wave to the lay, the direction in which the grooves run,

    C(q, b) = C(q) W,    W = 2/(g + 1/g) / (g cos^2 b + sin^2 b/g)^2,

of mean 1 over the angle, so that C(q) is the spectrum averaged over directions. This is
a self-affine surface of H = 1 that is stretched along the lay by the Peklenik number g
(the ratio of the lengths of correlation; Peklenik, Proc. Inst. Mech. Eng. 182 (1967)
108). In any narrow band of waves the rms slope across the lay is g times that along it:

    <W e^(2 i b)> = -(g^2 - 1)/(g^2 + 1) = -tanh(ln g).

So ln g is found from measured heights scale by scale, as the second moment of their
periodogram over the angle. A band of N independent waves has that moment of an
isotropic surface by chance with a standard deviation of 1/sqrt(2 N) in each component.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..arrays import xp
from ..trees import Tree, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import Array

# |<W e^(2ib)>| averaged over the scales from which on a surface counts as anisotropic: C
# across the lay is then 1.5 times that along it; and standard errors, likewise
_LEAST, _CERTAIN = 0.1, 4.0
_BETWEEN = 0.1  # scatter of that moment from band to band besides chance
_BEND = 0.2  # of ln g from node to node, standard deviation of the prior
_LARGEST = 0.999  # of the moment of a band: a Peklenik number of 45
_MOST_TURNED = -0.5  # least ln g: at some scales waves may lie the other way
# by how much the fourth moment may differ from that of W: a cross-hatch is further off
_CROSSED = 0.2


class Lay(Tree):
    """The Peklenik number of a surface by scale, and the direction of its lay."""

    q: Float[np.ndarray, " n"]  # [rad/m]
    log_peklenik: Float[np.ndarray, " n"]  # ln g
    error: Float[np.ndarray, " n"]  # standard error of ln g
    angle: float = static()  # of the lay to x of the map [rad], from 0 to pi

    @property
    def peklenik(self) -> Float[np.ndarray, " n"]:
        """g at the wave numbers `q`."""
        return np.exp(self.log_peklenik)

    def weight(self, q: Array, cos_square: Array, sin_square: Array) -> Array:
        """W at wave numbers q, of the squares of cos b and sin b; beyond the ends of the
        table g is that at its end.
        """
        log_g = xp.interp(xp.log(q), xp.log(self.q), self.log_peklenik)
        g, least = xp.exp(log_g), xp.exp(-log_g)
        return 2 / (g + least) / (g * cos_square + least * sin_square) ** 2

    def at(self, q: np.ndarray) -> Lay:
        """The same lay by a table at other wave numbers."""
        log_q, old = np.log(q), np.log(self.q)
        log_peklenik = np.interp(log_q, old, self.log_peklenik)
        return Lay(q, log_peklenik, np.interp(log_q, old, self.error), self.angle)

    def off(self, errors: float) -> Lay:
        """The same lay, ln g off by so many of its standard errors at all scales."""
        return Lay(
            self.q, self.log_peklenik + errors * self.error, self.error, self.angle
        )

    def words(self) -> str:
        """Direction of the lay and Peklenik numbers, in a few words."""
        places = [0, self.q.size // 2, self.q.size - 1]
        numbers = ", ".join(
            f"{self.peklenik[i]:.3g} (within a factor of {np.exp(self.error[i]):.2g}) at "
            f"{2 * np.pi / self.q[i]:.3g} m"
            for i in places
        )
        return (
            f"its lay runs at {np.degrees(self.angle):.0f} degrees from x; Peklenik "
            f"numbers {numbers}"
        )


def lay_of(spectrum: object) -> Lay | None:
    """The lay of a surface; None of those that are isotropic."""
    return getattr(spectrum, "lay", None)


class Periodogram(NamedTuple):
    """Waves of one map over what the isotropic spectrum lets expect."""

    q: np.ndarray  # [rad/m]
    angle: np.ndarray  # of each wave to x [rad]
    ratio: np.ndarray  # power over C
    copies: np.ndarray  # 2 for waves that stand for their opposite as well
    independent: float  # share of the waves that are independent


class _AngularMoments(NamedTuple):
    """Moments over the angle of bands about each node, less what the grid makes."""

    second: np.ndarray  # of exp(2 i b), b counted from x
    fourth: np.ndarray  # of exp(4 i b)
    number: np.ndarray  # independent waves


def measured_lay(maps: list[Periodogram], q: np.ndarray) -> tuple[Lay | None, str]:
    """The lay of a surface by its maps at nodes `q`, None where it is isotropic within
    chance or nearly so; and what there is to say of a cross-hatch.
    """
    moments = _moments(maps, q)
    held = moments.number >= 1
    weight = moments.number / (1 + 2 * moments.number * _BETWEEN**2) * held
    if held.sum() < 3:
        return None, ""
    mean = (weight * moments.second).sum() / weight.sum()
    error = (2 * weight.sum()) ** -0.5
    lay = None
    if abs(mean) > max(_LEAST, _CERTAIN * error):
        lay = _fitted(moments, q, held, float(np.angle(mean)) / 2)
    return lay, _crossed(moments, weight, error, lay)


def _moments(maps: list[Periodogram], q: np.ndarray) -> _AngularMoments:
    # waves exactly at the end of a band belong to it in any unit of length
    ends = np.sqrt(q[1:] * q[:-1]) * (1 + 1e-9)
    sums = np.zeros((3, q.size), dtype=complex)
    number = np.zeros(q.size)
    for one in maps:
        band = np.digitize(one.q, ends)
        inside = (one.q >= q[0] * 0.999) & (one.q <= q[-1] * 1.001)
        band, copies = band[inside], one.copies[inside]
        counted = np.bincount(band, copies, q.size)
        for order in range(3):
            turned = np.exp(2j * order * one.angle[inside])
            by_grid = _sum(band, copies * turned, q.size) / np.maximum(counted, 1)
            total = _sum(band, copies * one.ratio[inside], q.size)
            moment = _sum(band, copies * one.ratio[inside] * turned, q.size)
            sums[order] += moment - (total * by_grid if order else 0.0)
        number += counted / 2 * one.independent
    whole = np.maximum(sums[0].real, 1e-300)
    return _AngularMoments(sums[1] / whole, sums[2] / whole, number)


def _sum(band: np.ndarray, values: np.ndarray, size: int) -> np.ndarray:
    real, imaginary = (
        np.bincount(band, component, size)
        for component in (np.real(values), np.imag(values))
    )
    return real + 1j * imaginary


def _fitted(
    moments: _AngularMoments, q: np.ndarray, held: np.ndarray, across: float
) -> Lay:
    """ln g at the nodes: a smooth curve through the bands, each with its error."""
    along = (moments.second * np.exp(-2j * across)).real
    measured_log_g = np.arctanh(np.clip(along, -_LARGEST, _LARGEST))
    # of waves about one direction fewer carry the moment, but they scatter less
    weight = np.where(held, 2 * moments.number * np.exp(-np.abs(measured_log_g)), 0.0)
    bend = np.diff(np.eye(q.size), 2, axis=0) / _BEND
    curvature = bend.T @ bend + np.diag(weight)
    log_g = np.maximum(
        np.linalg.solve(curvature, weight * measured_log_g), _MOST_TURNED
    )
    error = np.sqrt(np.diag(np.linalg.inv(curvature)))
    return Lay(q, log_g, error, float((across + np.pi / 2) % np.pi))


def _crossed(
    moments: _AngularMoments, weight: np.ndarray, error: float, lay: Lay | None
) -> str:
    """A sentence where the directions of the waves are not those about one lay."""
    expected = np.zeros(weight.size, dtype=complex)
    if lay is not None:
        b = np.pi * (np.arange(720) + 0.5) / 720
        w = lay.weight(lay.q[:, None], np.cos(b) ** 2, np.sin(b) ** 2)
        expected = (w * np.cos(4 * b)).mean(axis=1) * np.exp(4j * lay.angle)
    apart = (weight * (moments.fourth - expected)).sum() / weight.sum()
    if abs(apart) < max(_CROSSED, _CERTAIN * error):
        return ""
    return (
        "its waves are not those of one lay, as of a cross-hatch or of two ways of "
        "finishing: what depends on direction is known roughly"
    )
