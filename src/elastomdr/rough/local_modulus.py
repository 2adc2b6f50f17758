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

import functools
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ..arrays import Array, xp
from ..material.shift import thermal_factors
from ..numerics.quadrature import gauss_unit
from .against_lay import Directed, Which
from .heat import highest_rise

if TYPE_CHECKING:
    from ..call.types import SteadyBody
    from ..material.softening import Softening
    from ..surface.spectrum import AbstractSpectrum

_SEARCHED = 512  # wave numbers among which those of a strain are looked for
_OF_STRAIN = 64  # nodes of the mean over strains
_ONSET = 0.1  # c of `place_of`
# of the way from q_low to q_high; the root of zero has no derivative
_LEAST_SHARE = 1e-300
# relative distance to q_low within which the strain is not told from zero
_NEAREST = 1e-6


class SoftenedByScale(NamedTuple):
    """Softening on a surface."""

    softening: Softening
    spectrum: AbstractSpectrum
    share: Array  # strain over rms slope

    def strain(self, q: Array) -> Any:
        """Amplitude of strain at wave numbers q [rad/m], any shape."""
        square = 2 * np.pi * self.spectrum.moment(3, None, q)
        return self.share * xp.sqrt(xp.maximum(square, 1e-60))

    def level(self) -> Any:
        """E* over that of small strain, the root mean square over the slopes of all
        waves, which real contact depends on: since strains grow as the root of these,
        the square is the integral of 2 t f(t eps)^2 over t from 0 to 1.
        """
        nodes, weights, _ = gauss_unit(_OF_STRAIN)
        strain = self.strain(xp.asarray(self.spectrum.q_high))
        storage, _ = self.softening.factors(strain * nodes)
        return xp.sqrt(xp.sum(2 * weights * nodes * storage**2))

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
        places = np.interp(wanted**2, self.strain(q) ** 2, q) if q.size else q
        return places[places > float(self.spectrum.q_low) * (1 + _NEAREST)]


class Warmed(NamedTuple):
    """Rises of temperature at stations on the scale of lengths, joined by cubic splines
    over `place_of`.

    Nothing is heated at q_low, where P = 1: the rise is zero there, and needs no
    station.
    """

    ends: Array  # log q_low and log q_high (2,)
    rise: Array  # at the stations, `log_stations` (points, stations) [K]
    temperature: Array  # of the body (points,)
    body: SteadyBody  # with its shift laws

    def log_q(self) -> Any:
        """Where the stations are."""
        return log_stations(self.rise.shape[1], self.ends)

    def at(self, q: Array) -> Any:
        """The rise [K] at wave numbers q (...), in the shape (points, ...); that of
        q_high beyond it.
        """
        place = place_of(xp.log(q).reshape(-1), self.ends)
        rise = self.rise @ basis(self.rise.shape[1], place).T
        highest = highest_rise(self.body, self.temperature)
        rise = xp.clip(rise, 0.0, np.reshape(highest, (-1, 1)))
        return rise.reshape(self.rise.shape[0], *np.shape(q))

    def factors(self, rise: Array) -> tuple[Any, Any]:
        """a_T and b_T at rises (points, ...), over those at the body's temperature."""
        temperature = self.temperature.reshape(-1, *[1] * (rise.ndim - 1))
        (a, b), (a_0, b_0) = (
            thermal_factors(self.body, temperature + rise),
            thermal_factors(self.body, temperature),
        )
        return a / a_0, b / b_0


class Local(NamedTuple):
    """What makes moduli differ from scale to scale, and waves from direction to
    direction; nothing, as it is.
    """

    softened: SoftenedByScale | None = None
    warmed: Warmed | None = None
    directed: Directed | None = None

    @property
    def parted(self) -> bool:
        """Whether storage and loss modulus have factors."""
        return self.softened is not None or (
            self.warmed is not None and self.warmed.body.vertical is not None
        )

    @property
    def by_point(self) -> bool:
        """Whether moduli differ between points of one velocity."""
        alike = self.softened is None or np.ndim(self.softened.share) == 0
        return not alike or self.warmed is not None or self.directed is not None

    def raised(self, ratio: Array) -> Local:
        """The same on heights times `ratio` (points,), which strain the rubber more."""
        if self.softened is None:
            return self
        share = self.softened.share * ratio[:, None, None]
        return self._replace(softened=self.softened._replace(share=share))

    def of(self, points: Which) -> Local:
        """The same for some of the points."""
        local, warm = self, self.warmed
        if warm is not None:
            rise, temperature = warm.rise[points], warm.temperature[points]
            local = local._replace(
                warmed=warm._replace(rise=rise, temperature=temperature)
            )
        if self.directed is not None:
            local = local._replace(directed=self.directed.of(points))
        return local

    def at(self, q: Array) -> tuple[Any, Any, Any]:
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
            else (*of_strain, self.warmed.rise, self.warmed.temperature)
        )


def place_of(log_q: Array, ends: Array) -> Any:
    """The place of log q between q_low and q_high, from 0 to 1, held beyond them.

    With u the share of the way from log q_low to log q_high the place s has u = (1 + c)
    s^4/(s^2 + c). Contact is lost from q_low on, often within a thousandth of the way,
    and as 1/P ~ sqrt(pi G) the rise then grows as sqrt(u), which is smooth over s,
    while splines over log q would be of order 1.5. Further on s goes with the root of
    u.
    """
    u = xp.clip((log_q - ends[0]) / (ends[1] - ends[0]), _LEAST_SHARE, 1.0) / (
        1 + _ONSET
    )
    return xp.sqrt(0.5 * (u + xp.sqrt(u * (u + 4 * _ONSET))))


def log_stations(count: int, ends: Array) -> Any:
    """log q of stations at even places, 1/count to 1."""
    square = (np.arange(1, count + 1) / count) ** 2
    return ends[0] + (ends[1] - ends[0]) * (
        (1 + _ONSET) * square**2 / (square + _ONSET)
    )


@functools.lru_cache(maxsize=16)
def _splines(count: int) -> np.ndarray:
    """Coefficients of the splines of `basis`: (powers from 3 to 0, pieces,
    stations).

    Those of `scipy.interpolate.CubicSpline`, whose import takes longer than to heat a
    road. The unknowns are h^2 times the second derivatives at the knots (de Boor, A
    Practical Guide to Splines, ch. IV).
    """
    values = np.eye(count + 1)
    smooth, bend = np.zeros((2, count + 1, count + 1))
    for knot in range(1, count):
        smooth[knot, knot - 1 : knot + 2] = 1, 4, 1
        bend[knot, knot - 1 : knot + 2] = 6, -12, 6
    if count > 2:  # the third derivative is the same on both sides of the knot
        smooth[0, :3] = smooth[-1, -3:] = 1, -2, 1
    else:  # three knots have a parabola
        smooth[0, :2] = smooth[-1, -2:] = 1, -1
    second = np.linalg.solve(smooth, bend)
    cubic = (second[1:] - second[:-1]) / 6
    slope = values[1:] - values[:-1] - (2 * second[:-1] + second[1:]) / 6
    scales = count ** np.arange(3.0, -1.0, -1.0)[:, None, None]  # 1/h to the powers
    return (scales * np.stack([cubic, second[:-1] / 2, slope, values[:-1]]))[..., 1:]


def basis(count: int, place: Array) -> Any:
    """Values at places (n,) of the cubic splines, zero at place 0, that are 1 at one
    station and 0 at the others.

    Their end pieces are those of their neighbours ("not a knot"), of fourth order up to
    the ends: (n, count).
    """
    left = xp.clip(xp.floor(place * count).astype(int), 0, count - 1)
    s = (place - left / count)[:, None]
    cubic = xp.take(_splines(count), left, axis=1)
    return ((cubic[0] * s + cubic[1]) * s + cubic[2]) * s + cubic[3]
