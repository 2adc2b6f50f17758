"""Gauss' rules on one interval and on adjoining panels, each computed once."""

from __future__ import annotations

import functools
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.polynomial import laguerre, legendre

from ..arrays import xp
from ..checks import Array

if TYPE_CHECKING:
    from jaxtyping import Float


@functools.cache
def gauss(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights on [-1, 1], exact for polynomials of degree 2 count - 1."""
    nodes, weights = legendre.leggauss(count)
    return _read_only(nodes), _read_only(weights)


@functools.cache
def gauss_unit(count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes c and weights w on [0, 1], and T[i, j] = (2j+1) w_i P_j(1 - 2 c_i), which
    takes samples at the nodes to Legendre coefficients.
    """
    nodes, weights = gauss(count)
    c, w = 0.5 * (1 + nodes), 0.5 * weights
    polynomials = legendre.legvander(1 - 2 * c, count - 1)
    to_legendre = w[:, None] * polynomials * (2 * np.arange(count) + 1)
    return _read_only(c), _read_only(w), _read_only(to_legendre)


@functools.cache
def gauss_laguerre(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights of int_0^inf exp(-s) f(s) ds."""
    nodes, weights = laguerre.laggauss(count)
    return _read_only(nodes), _read_only(weights)


@functools.cache
def shares_to_legendre(count: int) -> np.ndarray:
    """T[j, i] = (2j+1) P_j(x_i): from the nodes' shares w_i f(x_i) of an integral to
    the Legendre coefficients of f, times the length of the interval.
    """
    nodes, _ = gauss(count)
    polynomials = legendre.legvander(nodes, count - 1)
    return _read_only(polynomials.T * (2 * np.arange(count)[:, None] + 1))


def gauss_on_panels(
    edges: Float[Array, "*batch panels+1"], count: int
) -> tuple[Any, Any]:
    """Nodes and weights, (..., panels * count), of Gauss' rule with `count` points on
    each of adjoining panels; arrays of NumPy where the edges are.
    """
    nodes, weights = gauss(count)
    half = 0.5 * (edges[..., 1:] - edges[..., :-1])[..., None]
    x = edges[..., :-1, None] + half * (1 + nodes)
    dx = xp.broadcast_to(half * weights, x.shape)
    flat = (*edges.shape[:-1], -1)
    return x.reshape(flat), dx.reshape(flat)


def graded(levels: int, ratio: float = 0.15) -> tuple[float, ...]:
    """Divisions of [0, 1] that shrink geometrically towards 0, for an algebraic
    singularity there.
    """
    return (0.0, *(ratio**k for k in range(levels, 0, -1)), 1.0)


def _read_only(array: np.ndarray) -> np.ndarray:
    """An array that a cache may hand out to everyone."""
    array.flags.writeable = False
    return array
