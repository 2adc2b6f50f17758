"""How a surface of rubber gives way to a pressure that stands or passes: matrices.

Under hats of pressure, 1 at one node and 0 at its neighbours, a half-space or a layer is
displaced by

    u(x) = J o int K(x - s) p(s) ds,      K = -(2/pi) [ln|x| - S(x/h)],
    S(y) = ln(1 + y^2)/2 + int_0^inf (W(z) - 1 + e^-z) cos(zy)/z dz,

with S = 0 on a half-space; W is the kernel of `element/layer.py`. The integral over a
hat is a second difference of the second integral of K. J is the creep function of E*: of
a standing pressure its limit, and of one that passes with the velocity v each
retardation time lambda leaves a memory l = v lambda,

    u_l(x) = int_0^inf u(x - s) exp(-s/l) ds/l,      the rubber moves along +x,

which is exact for a u that is linear between the nodes, and these reach far ahead of the
contact. Derived here; Johnson 1985, section 5.8, for W.
"""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.special import hyperu

from ..checks import Array
from ..element.law import as_foundation
from ..element.layer import Layer, layer_kernel
from ..errors import InputError
from ..material.relaxation import KelvinChain, Relaxation, to_kelvin
from ..numerics.quadrature import gauss_on_panels

if TYPE_CHECKING:
    from ..call.types import Material

_FAR = 40.0  # y beyond which a layer is at rest, S = ln y
_FARTHEST = 1e3  # half-lengths ahead of the contact from which memories are followed
_BLOCK = 16  # places whose memories are computed at once
_AHEAD = 1.12  # ratio of distances between nodes there


class SealBody(NamedTuple):
    """One of the bodies under the pressure."""

    chain: KelvinChain  # of 1/E* [1/Pa]
    thickness: float | None  # [m]; None: a half-space
    squeeze: float  # 1 - 2 nu
    bonded: bool


def bodies_of(material: Material) -> list[SealBody]:
    """The half-space, or the layers on both sides. Raises `InputError`."""
    if not isinstance(material, Layer):
        foundation = as_foundation(material)
        if foundation.per_area:
            raise InputError(
                argument="material",
                got=material,
                accepted="a half-space (the material itself) or an em.layer under a "
                "film",
                hint="independent springs have no smooth film",
            )
        return [SealBody(_chain(foundation.law()), None, 0.0, True)]
    for cover in material.covers:
        if not cover.constant:
            raise InputError(
                argument="material",
                got=material,
                accepted="of a constant Poisson's ratio as a layer under a film",
                hint="give poisson=0.5 in place of the bulk modulus",
            )
    return [
        SealBody(
            _chain(cover.normal()),
            float(cover.thickness),
            float(np.real(cover.squeeze())),
            cover.bonded,
        )
        for cover in material.covers
    ]


def _chain(law: Relaxation) -> KelvinChain:
    if float(law.equilibrium) == 0:
        raise InputError(
            argument="material",
            accepted="a solid with an equilibrium modulus under a film",
            hint="a liquid sinks without end",
        )
    return to_kelvin(law)


def compliance(body: SealBody, held: float | None = None) -> float:
    """J(t) after the reduced time `held` [s], or long after: 1/E*(0) [1/Pa]."""
    grown = 1.0
    if held is not None:
        grown = -np.expm1(-held / np.asarray(body.chain.times))
    return float(body.chain.instantaneous + np.sum(body.chain.compliances * grown))


def response(
    bodies: list[SealBody],
    x: Array,
    velocity: float,
    unit: float,
    held: float | None = None,
) -> Array:
    """Displacement over pressure and `unit` [1/Pa] at the nodes x under each inner hat.

    x in units of `unit` [m]; `velocity` of the rubber [m/s], reduced, 0 where the
    pressure stands, for the reduced time `held` [s].
    """
    total = np.zeros((x.size, x.size - 2))
    for body in bodies:
        thickness = body.thickness
        ratio = None if thickness is None else thickness / unit
        if velocity == 0:
            total += compliance(body, held) * _elastic(x, x, ratio, body)
            continue
        ahead = _ahead(x)
        places = np.concatenate([ahead, x])
        elastic = _elastic(places, x, ratio, body)
        total += float(body.chain.instantaneous) * elastic[ahead.size :]
        memory = velocity * np.asarray(body.chain.times) / unit
        total += _remembered(elastic, places, x, memory, body)[ahead.size :]
    return 2 * total


def _elastic(places: Array, x: Array, ratio: float | None, body: SealBody) -> Array:
    """Half of int K over each hat of the nodes x, at the places."""
    square = np.square(places[:, None] - x)
    logarithm = np.log(np.where(square == 0, 1.0, square))
    # int int ln|X| = X^2 ln|X|/2 - 3 X^2/4, of which the latter's second differences are
    # the same everywhere
    twice = np.multiply(square, logarithm, out=logarithm)
    twice *= -0.25 / np.pi
    if ratio is not None:
        smooth = _layer_part(body.squeeze, body.bonded)(np.sqrt(square) / ratio)
        twice += (ratio**2 * smooth + 0.5 * square * np.log(ratio)) / np.pi
    slope = np.diff(twice, axis=1)
    slope /= np.diff(x)
    return np.diff(slope, axis=1) + 0.75 / np.pi * (x[2:] - x[:-2])


@functools.lru_cache(maxsize=8)
def _layer_part(squeeze: float, bonded: bool) -> Any:
    """Second integral of S from 0, for y >= 0."""
    z, weight = gauss_on_panels(np.linspace(0.0, 44.0, 221), 10)
    lacking = (layer_kernel(z, squeeze, bonded) - 1 + np.exp(-z)) / z * weight
    y = np.concatenate([np.arange(0.0, 8.0, 0.02), np.arange(8.0, _FAR + 0.05, 0.1)])
    smooth = 0.5 * np.log1p(y**2) + np.cos(y[:, None] * z) @ lacking
    ends: Any = ((1, 0.0), "not-a-knot")  # wider than its type hints
    spline = CubicSpline(y, smooth, bc_type=ends)
    once, twice = spline.antiderivative(1), spline.antiderivative(2)
    last = y[-1]

    def tail(y: Array) -> Array:
        return 0.5 * y**2 * np.log(y) - 0.75 * y**2

    def second(y: Array) -> Array:
        far = np.maximum(y, last)
        slope = once(last) - (last * np.log(last) - last)
        beyond = twice(last) + tail(far) - tail(last) + slope * (far - last)
        return np.where(y < last, twice(np.minimum(y, last)), beyond)

    return second


def _ahead(x: Array) -> Array:
    """Places ahead of the nodes, from the farthest on."""
    first = x[0]
    reach = max(_FARTHEST, 3 * abs(first))
    count = max(2, int(np.ceil(np.log(reach / abs(first)) / np.log(_AHEAD))))
    return -np.geomspace(reach, abs(first), count + 1)[:-1]


def _remembered(
    elastic: Array, places: Array, x: Array, memory: Array, body: SealBody
) -> Array:
    """Sum over the branches of J_k times the displacement that each remembers."""
    compliances = np.asarray(body.chain.compliances)
    now = np.broadcast_to(elastic[0], (memory.size, elastic.shape[1])).copy()
    if body.thickness is None:  # int ln(X + s) exp(-s/l) ds/l - ln X = U(1, 1, X/l)
        hats = 0.5 * (x[2:] - x[:-2])
        more = hyperu(1.0, 1.0, np.minimum(abs(places[0]) / memory, 1e8))
        now -= more[:, None] * hats / np.pi
    total = np.empty_like(elastic)
    total[0] = compliances @ now
    step = np.diff(places)[:, None] / memory
    mean = -np.expm1(-step) / step
    new, old = 1 - mean, mean - np.exp(-step)
    # u_l(i) = sum over j <= i of exp[-(x_i - x_j)/l] (new_j u_j + old_j u_(j-1)), in
    # blocks, from the memory at the end of the one before
    for first in range(0, step.shape[0], _BLOCK):
        block = slice(first, first + _BLOCK)
        x_block, rows = places[1:][block], new[block].shape[0]
        since = (x_block - places[first])[:, None] / memory
        fading = np.exp(
            -np.maximum(x_block[:, None] - x_block, 0.0)[..., None] / memory
        )
        fading *= np.tri(rows)[..., None]
        here, before = elastic[1:][block], elastic[block][:rows]
        total[1:][block] = (
            (np.exp(-since) * compliances) @ now
            + np.einsum("ijk,jk->ij", fading, new[block] * compliances) @ here
            + np.einsum("ijk,jk->ij", fading, old[block] * compliances) @ before
        )
        now = (
            np.exp(-since[-1])[:, None] * now
            + (fading[-1] * new[block]).T @ here
            + (fading[-1] * old[block]).T @ before
        )
    return total
