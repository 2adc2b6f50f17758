"""How the moduli of rubber on a rough surface differ from scale to scale: by the strain
and the temperature there.

The rubber that waves of wave number q deform has the strain amplitude eps(q) = share
times the rms slope of the waves up to q, and is warmer by a rise T(q) than the body.
Its modulus is

    b(T) [f(eps) Re E*(q v a(T)) + i g(eps) Im E*(q v a(T))],

f and g the factors of its softening, a and b those of its shift laws, relative to the
body's temperature. Since none of them depends on the direction of a wave, integrals
over the angle take them as factors. Beyond q_high, where there are no waves but those
of contact edges, strain and temperature are those of q_high.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ..material.vertical import thermal_factors
from .psd_integrals import namespace

_SEARCHED = 512  # wave numbers among which those of a strain are looked for
# relative distance to q_low within which the strain is not told from zero
_NEAREST = 1e-6


class Softened(NamedTuple):
    """Softening on a surface."""

    softening: Any  # em.Softening
    spectrum: Any
    share: Any  # strain over rms slope

    def strain(self, q: Any) -> Any:
        """Amplitude of strain at wave numbers q [rad/m], any shape."""
        xp = namespace(q, self.spectrum.q, self.spectrum.c, self.share)
        square = 2 * np.pi * self.spectrum.moment(3, None, q)
        return self.share * xp.sqrt(xp.maximum(square, 1e-300))

    def bends(self) -> np.ndarray:
        """Wave numbers at which the strain is that of a point of the sweep, where its
        cubics meet.
        """
        q = np.geomspace(
            float(self.spectrum.q_low), float(self.spectrum.q_high), _SEARCHED
        )
        strain = self.strain(q)
        wanted = np.asarray(self.softening.strain)
        wanted = wanted[(wanted > strain[0]) & (wanted < strain[-1])]
        right = np.searchsorted(strain, wanted)
        q = np.unique(np.geomspace(q[right - 1], q[right], 65).ravel())
        found = np.interp(wanted**2, self.strain(q) ** 2, q) if q.size else q
        return found[found > float(self.spectrum.q_low) * (1 + _NEAREST)]


class Warmed(NamedTuple):
    """Rises of temperature at stations on the scale of lengths, joined by natural cubic
    splines over log q.
    """

    log_q: Any  # ascending, the last one that of q_high (stations,)
    rise: Any  # (points, stations) [K]
    kelvin: Any  # of the body (points,)
    body: Any  # the foundation, with its shift laws

    def at(self, q: Any) -> Any:
        """The rise [K] at wave numbers q (...), in the shape (points, ...); held below
        the first station.
        """
        xp = namespace(self.log_q, self.rise, q)
        spline = basis(self.log_q, namespace(self.log_q, q).log(q).reshape(-1))
        rise = (self.rise @ spline.T).reshape(self.rise.shape[0], *np.shape(q))
        top = xp.max(self.rise, axis=-1).reshape(-1, *[1] * np.ndim(q))
        return xp.clip(rise, 0.0, top)

    def factors(self, rise: Any) -> tuple[Any, Any]:
        """a_T and b_T at rises (points, ...), over those at the body's temperature."""
        kelvin = self.kelvin.reshape(-1, *[1] * (rise.ndim - 1))
        (a, b), (a_0, b_0) = (
            thermal_factors(self.body, kelvin + rise),
            thermal_factors(self.body, kelvin),
        )
        return a / a_0, b / b_0


class Local(NamedTuple):
    """What makes moduli differ from scale to scale; nothing, as it is."""

    softened: Softened | None = None
    warmed: Warmed | None = None

    @property
    def parted(self) -> bool:
        """Whether storage and loss modulus have factors."""
        return self.softened is not None or (
            self.warmed is not None and self.warmed.body.vertical is not None
        )

    def of(self, points: Any) -> Local:
        """The same for some of the points."""
        if self.warmed is None:
            return self
        warm = self.warmed
        return self._replace(
            warmed=warm._replace(rise=warm.rise[points], kelvin=warm.kelvin[points])
        )

    def at(self, q: Any) -> tuple[Any, Any, Any]:
        """Factors at wave numbers q (cells, 2) or one: on the velocity, on the storage
        and on the loss modulus.

        They broadcast to (points, cells, 2); None for a velocity that is not changed.
        """
        speed, storage, loss = None, 1.0, 1.0
        if self.softened is not None:
            storage, loss = self.softened.softening.factors(self.softened.strain(q))
        if self.warmed is not None:
            rise = self.warmed.at(q)
            rise = rise.reshape(rise.shape[0], *(rise.shape[1:] or (1, 1)))
            speed, vertical = self.warmed.factors(rise)
            storage, loss = storage * vertical, loss * vertical
        return speed, storage, loss

    def bends(self) -> Any:
        """Wave numbers at which a factor may bend."""
        return () if self.softened is None else self.softened.bends()

    def slowest(self) -> float:
        """The smallest factor on the velocity."""
        if self.warmed is None:
            return 1.0
        return float(np.min(self.warmed.factors(self.warmed.rise)[0]))

    def arrays(self) -> tuple[Any, ...]:
        """What decides whether JAX traces."""
        of_strain = (
            ()
            if self.softened is None
            else (self.softened.share, self.softened.softening.storage)
        )
        of_strain += (
            ()
            if self.softened is None
            else (self.softened.softening.loss, self.softened.softening.strain)
        )
        return (
            of_strain
            if self.warmed is None
            else (*of_strain, self.warmed.rise, self.warmed.kelvin)
        )


def basis(knots: Any, at: Any) -> Any:
    """Values at places (n,) of the natural cubic splines that are 1 at one knot and 0
    at the others: (n, knots).
    """
    xp = namespace(knots, at)
    knots, count = xp.asarray(knots), np.shape(knots)[0]
    h, unit = xp.diff(knots), xp.asarray(np.eye(count))
    inner = np.arange(1, count - 1)
    slope = (unit[1:] - unit[:-1]) / h[:, None]
    system = xp.asarray(np.eye(count))
    rows = (
        (h[:-1] / 6)[:, None] * unit[inner - 1]
        + ((h[:-1] + h[1:]) / 3)[:, None] * unit[inner]
        + (h[1:] / 6)[:, None] * unit[inner + 1]
    )
    system = xp.concatenate([system[:1], rows, system[-1:]])
    bend = xp.linalg.solve(
        system, xp.concatenate([0 * unit[:1], slope[1:] - slope[:-1], 0 * unit[:1]])
    )
    at = xp.clip(at, knots[0], knots[-1])
    left = xp.clip(xp.searchsorted(knots, at, side="right") - 1, 0, count - 2)
    width = h[left][:, None]
    s = ((at - knots[left])[:, None]) / width
    return (
        (1 - s) * unit[left]
        + s * unit[left + 1]
        + width**2
        / 6
        * (((1 - s) ** 3 - (1 - s)) * bend[left] + (s**3 - s) * bend[left + 1])
    )
