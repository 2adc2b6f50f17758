"""Back to three dimensions: pressure and displacement over the radius, from the
elements of the line.

p(r) = -(1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx and u(r) = (2/pi) int_0^r
u(x)/sqrt(r^2 - x^2) dx (Popov & Hess 2015, ch. 3). On every panel q and u are the
polynomials through their Gauss nodes; with x = sqrt(r^2 + t^2), or x = r sin(t), the
weights are smooth, and Gauss' rule does the rest, panel by panel.
"""

import itertools
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from ..checks import Array
from ..element.episode import Modes, recovery_modes
from ..errors import InputError
from ..material.relaxation import Relaxation
from ..numerics.quadrature import gauss, shares_to_legendre
from ..surface.disc import Disc
from .depth_history import (
    NODES,
    cuts,
    edges_of_growth,
    indent_between,
    over_histories,
)
from .depth_history import edges as edges_of
from .indentation_route import DepthOrLoad, refined
from .layer_disc import ElasticLine, LayerDisc, line_of

_CUTS = np.append(cuts(2)[:, :-1], 1.0)[None]  # of the panels
_POINTS, _WEIGHTS = gauss(12)
_OWN, _OWN_WEIGHTS = gauss(4)
_RTOL = 1e-6  # of a depth that is solved again in between


class IndentedElements(NamedTuple):
    """The elements of an indentation and what was asked for: what a result carries
    along to find its surface.
    """

    law: Relaxation  # at the temperature
    disc: Disc
    course: DepthOrLoad

    def field(
        self,
        depth: np.ndarray,
        force: np.ndarray,
        r: np.ndarray,
        time: float,
        field_name: str,
    ) -> np.ndarray:
        """The "pressure" or "displacement" at radii r [m] and one time [s], after the
        axes of the histories.

        `depth` and `force` are those that were found, time along the last axis. Raises
        `InputError`.
        """
        modes = recovery_modes(self.law)
        leading, instants = depth.shape[:-1], depth.shape[-1]
        rows = [
            None if quantity is None else np.reshape(quantity, (-1, instants))
            for quantity in self.course
        ]
        values = []
        found = (x.reshape(-1, instants) for x in (depth, force))
        for i, (row, carried) in enumerate(zip(*found, strict=True)):
            history = DepthOrLoad(
                *(None if quantity is None else quantity[i] for quantity in rows)
            )
            first, last = history.time[0], history.time[-1]
            if not first <= time <= last:
                raise InputError(
                    argument="time",
                    got=time,
                    accepted=f"within the history, {first:g} to {last:g} s",
                )
            if not np.isfinite(row).all():
                values.append(np.full(r.shape, np.nan))
                continue
            knots = refined(self.law, modes, self.disc, history, (row, carried), _RTOL)
            surface = surface_at(self.law, modes, self.disc, *knots, time)
            values.append(getattr(surface, field_name)(r))
        return np.stack(values).reshape((*leading, *r.shape))


class PanelSeries(NamedTuple):
    """Legendre series on panels of the line, of q and u."""

    edges: np.ndarray  # (panels + 1,) [m]
    q: np.ndarray  # (panels, n) coefficients
    u: np.ndarray  # (panels, n)
    # places where q falls to zero at once: the edge of a flat punch [m], and by how
    # much
    jump: np.ndarray
    local: bool  # a layer: pressure and displacement are those of the element

    def pressure(self, r: np.ndarray) -> np.ndarray:
        """p [Pa] at radii r [m], any shape."""
        if self.local:
            return _value(self.edges, self.q, r)
        slope = legendre.legder(self.q, axis=1) * (2 / np.diff(self.edges))[:, None]
        total = np.zeros(r.shape)
        for left, right, series in zip(
            self.edges[:-1], self.edges[1:], slope, strict=True
        ):
            low = np.maximum(left, r)
            t0 = np.sqrt(np.maximum((low - r) * (low + r), 0.0))
            t1 = np.sqrt(np.maximum((right - r) * (right + r), 0.0))
            half = np.where(right > r, 0.5 * (t1 - t0), 0.0)[..., None]
            t = t0[..., None] + half * (1 + _POINTS)
            x = np.sqrt(r[..., None] ** 2 + t**2)
            inner = legendre.legval(
                np.clip(2 * (x - left) / (right - left) - 1, -1, 1), series
            )
            total -= (
                np.sum(half * _WEIGHTS * inner / np.where(x > 0, x, 1.0), axis=-1)
                / np.pi
            )
        edge, fall = self.jump
        outside = (edge - r) * (edge + r)
        with np.errstate(divide="ignore"):
            return total + np.where(
                outside > 0,
                fall / np.pi / np.sqrt(np.where(outside > 0, outside, 1.0)),
                0.0,
            )

    def displacement(self, r: np.ndarray) -> np.ndarray:
        """u [m] at radii r [m], any shape."""
        if self.local:
            return _value(self.edges, self.u, r)
        total = np.zeros(r.shape)
        safe = np.where(r > 0, r, 1.0)
        for left, right, series in zip(
            self.edges[:-1], self.edges[1:], self.u, strict=True
        ):
            t0 = np.arcsin(np.minimum(left / safe, 1.0))
            t1 = np.arcsin(np.minimum(right / safe, 1.0))
            half = 0.5 * (t1 - t0)[..., None]
            x = safe[..., None] * np.sin(t0[..., None] + half * (1 + _POINTS))
            inner = legendre.legval(
                np.clip(2 * (x - left) / (right - left) - 1, -1, 1), series
            )
            total += 2 / np.pi * np.sum(half * _WEIGHTS * inner, axis=-1)
        return np.where(r > 0, total, _value(self.edges, self.u, np.zeros(r.shape)))


def surface_at(
    law: Relaxation,
    modes: Modes,
    disc: Disc,
    time: np.ndarray,
    depth: np.ndarray,
    instant: float,
) -> PanelSeries:
    """The line at one instant of a history, from all that happened before it."""
    instant = max(
        instant, time[0] + 1e-14 * (time[-1] - time[0])
    )  # what a step at the first instant leaves is looked at after it
    before = time < instant
    t = np.append(time[before], instant)
    d = np.append(depth[before], np.interp(instant, time, depth))
    grows = bool((np.diff(d) >= 0).all())
    find = edges_of_growth if grows else edges_of
    reached = over_histories(find, law, modes, disc, t[None], d[None])
    _, row = over_histories(
        indent_between, law, modes, disc, t[None], d[None], reached, _CUTS
    )
    edges, q, u = row.edges[0], row.q[0], row.u[0]
    radius = float(reached[0, -1])
    wide = np.diff(edges) > 1e-13 * max(edges[-1], 1e-300)
    _, weights = gauss(q.shape[1])
    to_series = shares_to_legendre(q.shape[1]) * (0.5 * weights)
    kept = np.concatenate([[0.0], edges[1:][wide]])
    jump = (
        np.array([radius, float(q[0, 0])]) if disc.flat and radius > 0 else np.zeros(2)
    )
    if isinstance(disc, LayerDisc):
        return _on_layer(disc, kept, q[wide] @ to_series.T, u[wide] @ to_series.T, jump)
    return PanelSeries(
        kept,
        q[wide] @ to_series.T,
        u[wide] @ to_series.T,
        jump,
        disc.kind != "half-space",
    )


def _on_layer(
    disc: LayerDisc, edges: np.ndarray, q: np.ndarray, u: np.ndarray, jump: np.ndarray
) -> PanelSeries:
    """From the independent elements of a layer to q and u of the line, on more panels
    beyond the contact.

    A contact of radius b that goes deeper by dd gains q_1(s; b) dd, so that q(s) =
    -int_s^a q_1(s; b) dq(b); the same sum of the elements' displacements is what u
    would be without the kernel.
    """
    layer = line_of(disc)
    nodes, weights = gauss(NODES)
    to_series = shares_to_legendre(NODES) * (0.5 * weights)
    h = float(disc.thickness)
    far = edges[-1] + h * np.array(
        [0.1, 0.25, 0.5, 0.8, 1.2, 1.7, 2.3, 3.0, 4.0, 5.5, 7.5, 10.0, 14.0]
    )
    every = np.append(edges, far)
    s = every[:-1, None] + 0.5 * np.diff(every)[:, None] * (1 + nodes)
    inner, ds = s[: len(q)], 0.5 * np.diff(edges)[:, None] * weights

    falls = np.array(
        [float(jump[1]), float(legendre.legval(1.0, u[-1])) if len(u) else 0.0]
    )
    line, free = _gathered(layer, edges, np.stack([q, u]), falls, inner)
    spread = layer.kernel(s.ravel(), inner.ravel()) @ (ds * free).ravel()
    moved = spread.reshape(s.shape)
    moved[: len(q)] += free
    pressure = np.concatenate([line, np.zeros((len(far), NODES))])
    if jump[1]:
        jump = np.array(
            [
                jump[0],
                jump[1] * float(layer.of_unit(np.array([edges[-1]]), edges[-1])[0]),
            ]
        )
    return PanelSeries(every, pressure @ to_series.T, moved @ to_series.T, jump, False)


def _gathered(
    layer: ElasticLine,
    edges: np.ndarray,
    series: np.ndarray,
    falls: np.ndarray,
    s: np.ndarray,
) -> np.ndarray:
    """-int_s^a q_1(s; b) dv(b) at all places s, for each v(b) of the `series` on panels
    that falls to zero at its end by its entry of `falls`.
    """
    total = falls[:, None, None] * layer.of_unit(s, edges[-1])
    slope = legendre.legder(series, axis=2) * (2 / np.diff(edges))[:, None]
    for panel, (left, right) in enumerate(itertools.pairwise(edges)):
        rise = slope[:, panel].T
        # the part of this panel that lies beyond s: Gauss points of its own for the
        # panel that holds s
        places = left + 0.5 * (right - left) * (1 + _POINTS)
        shares = 0.5 * (right - left) * _WEIGHTS * legendre.legval(_POINTS, rise)
        below = s < left
        for place, share in zip(places, shares.T, strict=True):
            unit = np.where(below, layer.of_unit(s, place), 0.0)
            total = total - share[:, None, None] * unit
        for i in np.argwhere((s >= left) & (s < right)):
            low = s[tuple(i)]
            half = 0.5 * (right - low)
            places = low + half * (1 + _OWN)
            rate = legendre.legval(2 * (places - left) / (right - left) - 1, rise)
            unit = [float(layer.of_unit(np.array([low]), b)[0]) for b in places]
            total[(slice(None), *i)] -= half * np.sum(
                _OWN_WEIGHTS * rate * unit, axis=1
            )
    return total


def _value(edges: np.ndarray, series: np.ndarray, x: Array) -> np.ndarray:
    """A panel-wise series at x, zero beyond the last panel."""
    if len(series) == 0:
        return np.zeros(np.shape(x))
    i = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(series) - 1)
    place = np.clip(2 * (x - edges[i]) / (edges[i + 1] - edges[i]) - 1, -1, 1)
    return np.where(
        x <= edges[-1],
        legendre.legval(place, np.moveaxis(series[i], -1, 0), tensor=False),
        0.0,
    )
