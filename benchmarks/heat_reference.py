"""Hot friction on a rough surface a second time, plainly: one point at a time, the
temperature at every wave number.

The equations are those of docs/theory.md, sections 21, 23 and 24. Nothing of
the solution in `elastomdr.rough` is used, only the constants of Multiscale. The way from q_low to
q_high is log(q/q_low) = log(q_high/q_low) t^4 with even steps of t within each piece of
the spectrum, since a rise that begins as the root of log(q/q_low) is smooth over t. All
integrals are Simpson's, the distances r are those of half the waves, pi/q, the moduli
are averaged over the angle on a grid of their own, and the state is that which rubber
reaches that was cold.
"""

import itertools
from typing import Any, NamedTuple

import numpy as np
from scipy.integrate import cumulative_simpson, simpson
from scipy.interpolate import CubicHermiteSpline, CubicSpline
from scipy.special import erf, erfinv, i0e, k0e

from elastomdr.element.law import surface_foundation
from elastomdr.material.shift import thermal_factors
from elastomdr.rough.multiscale import FORM
from elastomdr.rough.road_models import Persson

STEPS = 300  # of t, for the whole way
PER_DECADE = 12  # wave numbers in depth
PER_LOG = 8  # frequencies of the tables of moduli in a factor of e
WARMEST = 1000.0  # rise up to which there are tables [K]
BEYOND = 3e3  # how far beyond q_high contact edges have waves


class Hot(NamedTuple):
    """What is found at one point."""

    mu: float
    area: float
    contact_rise: float  # [K]
    road_share: float
    settled: bool


class Moduli(NamedTuple):
    """Averages over the angle, as splines of their logarithm over log frequency."""

    drag: Any  # int cos Im E* dphi
    storage: Any  # int (Re E*)^2 dphi
    loss: Any  # int (Im E*)^2 dphi


class Grid(NamedTuple):
    """Wave numbers and the distances that belong to them."""

    log_q: np.ndarray
    q: np.ndarray  # ascending
    power: np.ndarray  # q^4 C


def grid_of(spectrum: Any) -> Grid:
    """Even steps of t in each piece of the spectrum, a multiple of two; a piece ends
    where P(q e^a) becomes that at q_high as well.
    """
    table, c = np.log(np.asarray(spectrum.q)), np.log(np.asarray(spectrum.c))
    bend = max(table[-1] - FORM.ahead, table[0])
    ends = ((np.union1d(table, bend) - table[0]) / (table[-1] - table[0])) ** 0.25
    counts = [
        2 * int(np.ceil(0.5 * STEPS * (b - a) + 4)) for a, b in itertools.pairwise(ends)
    ]
    pieces = [
        np.linspace(a, b, n + 1)[1:]
        for a, b, n in zip(ends[:-1], ends[1:], counts, strict=True)
    ]
    t = np.concatenate([[0.0], *pieces])
    log_q = table[0] + (table[-1] - table[0]) * t**4
    return Grid(log_q, np.exp(log_q), np.exp(4 * log_q + np.interp(log_q, table, c)))


def moduli_of(modulus: Any, low: float, high: float) -> Moduli:
    """Tables for frequencies from `low` to `high`; cos phi = 1/cosh(x), dphi =
    dx/cosh(x), four quarters.
    """
    x = np.linspace(0.0, 30.0, 601)
    cosine = 1 / np.cosh(x)
    log_w = np.linspace(
        np.log(low) - 1, np.log(high) + 1, int(PER_LOG * (np.log(high / low) + 2))
    )
    value = np.stack([modulus(np.exp(w) * cosine) for w in log_w])
    means = [
        4 * simpson(part * cosine, x=x)
        for part in (value.imag * cosine, value.real**2, value.imag**2)
    ]
    return Moduli(
        *(CubicSpline(log_w, np.log(np.maximum(mean, 1e-300))) for mean in means)
    )


def stored_spread(gamma: float, stored: bool) -> Any:
    """G of R, where dG/S(G) = dR."""
    if not stored:
        return lambda rate: rate
    log_g = np.linspace(np.log(1e-12), np.log(1e12), 8001)
    g = np.exp(log_g)
    share = erf(0.5 / np.sqrt(g))
    rate = g[0] + cumulative_simpson(
        g / (gamma + (1 - gamma) * share**2), x=log_g, initial=0
    )
    back = CubicSpline(np.log(rate), log_g)
    return lambda rate: np.exp(back(np.log(np.maximum(rate, 1e-11))))


class Point:
    """One point of a curve and what temperatures make of it."""

    def __init__(
        self,
        material: Any,
        spectrum: Any,
        *,
        velocity: float,
        pressure: float,
        temperature: float,
        heat: Any,
        adhesion: Any = None,
        model: Any = None,
        strain_share: float = 0.5,
    ):
        self.body, self.heat, self.adhesion = (
            surface_foundation(material),
            heat,
            adhesion,
        )
        self.velocity, self.pressure, self.kelvin = velocity, pressure, temperature
        self.model, self.at = model, grid_of(spectrum)
        gamma, stored = (
            (model.gamma, model.stored)
            if isinstance(model, Persson)
            else (FORM.gamma, True)
        )
        self.gamma, self.spread = gamma, stored_spread(gamma, stored)
        q = self.at.q
        self.softer, self.lossier = np.ones(q.size), np.ones(q.size)
        if self.body.softening is not None:
            square = (
                2
                * np.pi
                * cumulative_simpson(self.at.power, x=self.at.log_q, initial=0)
            )
            self.softer, self.lossier = self.body.softening.factors(
                strain_share * np.sqrt(square)
            )
        warmest = thermal_factors(
            self.body, temperature + np.linspace(0, self._most(), 200)
        )[0]
        low, high = (
            velocity * q[0] * warmest.min(),
            velocity * q[-1] * warmest.max() * BEYOND,
        )
        self.moduli = moduli_of(self.body.complex_modulus, low, high)
        self._conduct()

    def _most(self) -> float:
        """The largest rise that the shift law allows."""
        from elastomdr.errors import InputError

        rise = WARMEST
        while rise > 1:
            try:
                thermal_factors(self.body, self.kelvin + rise)
                return rise
            except InputError:
                rise *= 0.97
        return rise

    def _conduct(self) -> None:
        """r^2 I0(w r) K0(r sqrt(w^2 + k^2)) at r = pi/q, and its integral over log r
        from zero to pi/q.
        """
        q = self.at.q
        w = self.velocity * self.heat.heat_capacity / (2 * self.heat.conductivity)
        self.w = w
        decades = np.log10(q[-1] / q[0]) + 8
        self.log_k = np.log(1e-3 * q[0]) + np.linspace(
            0, decades * np.log(10), 2 * int(PER_DECADE * decades / 2) + 1
        )
        self.k = np.exp(self.log_k)
        root = np.hypot(w, self.k)

        def kernel(r: np.ndarray) -> np.ndarray:
            return (
                i0e(w * r)
                * k0e(root[:, None] * r)
                * np.exp(-(self.k[:, None] ** 2) / (root + w)[:, None] * r)
                * r**2
            )

        self.r = np.pi / q
        self.kernel = kernel(self.r)
        near = np.linspace(np.log(self.r[-1]) - 16, np.log(self.r[-1]), 321)
        below = simpson(kernel(np.exp(near)), x=near)
        # log r falls as log q rises
        onwards = cumulative_simpson(self.kernel, x=self.at.log_q, initial=0)
        self.inside = below[:, None] + onwards[:, -1:] - onwards
        self.line_inside = simpson(np.exp(near) * i0e(w * np.exp(near)), x=near)

    def over_k(self, values: np.ndarray) -> np.ndarray:
        """int dk of values (..., k); below the smallest k they are even."""
        return simpson(values * self.k, x=self.log_k) + values[..., 0] * self.k[0]

    def shares(self, rate: np.ndarray, stiffer: Any = 0.0) -> np.ndarray:
        """P of R, and of the log of how much stiffer contacts are than their wave."""

        def share(spread: np.ndarray) -> np.ndarray:
            return np.where(rate > 1e-9, erf(0.5 / np.sqrt(spread)), 1.0)

        plain = self.spread(rate)
        return share(plain * np.exp((1 - share(plain)) * stiffer))

    def stiffer(self, log_q: np.ndarray, rise: np.ndarray) -> np.ndarray:
        """Of rubber that is not softened, at the temperatures of the waves."""
        a, _ = thermal_factors(self.body, self.kelvin + rise)
        w = log_q + np.log(self.velocity * a)
        finer, own = (
            np.exp(self.moduli.storage(x)) + np.exp(self.moduli.loss(x))
            for x in (w + FORM.finer, w)
        )
        return np.log(finer / own)

    def averages(self, q: Any, rise: Any, softer: Any, lossier: Any) -> tuple[Any, Any]:
        """D_r and S_t at wave numbers and rises."""
        a, b = thermal_factors(self.body, self.kelvin + np.asarray(rise))
        w = np.log(q * self.velocity * a)
        drag = b * lossier * np.exp(self.moduli.drag(w))
        stiffness = (b * softer) ** 2 * np.exp(self.moduli.storage(w)) + (
            b * lossier
        ) ** 2 * np.exp(self.moduli.loss(w))
        return drag, stiffness

    def friction(
        self, rise: np.ndarray
    ) -> tuple[np.ndarray, float, float, np.ndarray, float]:
        """Friction per log q, that of edges, that of shear, P, and the area, at rises
        of the wave numbers.
        """
        p, at = self.pressure, self.at
        drag, stiffness = self.averages(at.q, rise, self.softer, self.lossier)
        rate = at.power * stiffness / (8 * p**2)
        until = cumulative_simpson(rate, x=at.log_q, initial=0)
        multiscale = not isinstance(self.model, Persson)
        stiffer = self.stiffer(at.log_q, rise) if multiscale else np.zeros_like(rise)
        share = self.shares(until, stiffer)
        last = float(share[-1])
        area = last + last**3 * (1 - last) / 4 if multiscale else last
        full = at.power * drag / (2 * p)
        shear = 0.0
        if self.adhesion is not None:
            stress = self.adhesion.shear_stress(self.velocity, self.kelvin + rise[-1])
            shear = float(stress) * area / p
        if not multiscale:
            factor = self.gamma + (1 - self.gamma) * share**2
            return full * factor * share, 0.0, shear, share, area
        ahead = np.minimum(at.log_q + FORM.ahead, at.log_q[-1])
        log_until = CubicHermiteSpline(
            at.log_q[1:], np.log(until[1:]), rate[1:] / until[1:]
        )
        there = self.stiffer(ahead, np.interp(ahead, at.log_q, rise))
        later = self.shares(np.exp(log_until(ahead)), there)
        own = 2 * rate * later ** (4 / 3)
        source = 2 * rate * np.exp(stiffer) * share**0.6
        below = cumulative_simpson(at.power, x=at.log_q, initial=0)
        distance = cumulative_simpson(below, x=at.log_q, initial=0)
        distance[1:] /= below[1:]
        steep = np.zeros_like(share)
        steep[1:] = FORM.further * (1 - share[1:] ** 0.25) / distance[1:]
        fine = source * steep / (1 + steep**8) ** 0.125
        of_edges = fading = 0.0
        x = np.linspace(0, np.log(BEYOND), 401)
        for part, fall in (
            (6 * fine, 2),
            (4 * source - 16 * fine, 4),
            (6 * fine, 6),
        ):
            grown = (at.q / at.q[-1]) ** fall
            until_q = cumulative_simpson(part * grown, x=at.log_q, initial=0)
            of_edges = of_edges + until_q / grown
            fading = fading + until_q[-1] * np.exp(-fall * x)
        spread = 0.25 / erfinv(last) ** 2 if last < 1 else 0.5 * until[-1]
        whole = last * (1 + 2 * spread) - 1
        whole += 2 * np.sqrt(spread / np.pi) * np.exp(-0.25 / spread)
        height = at.power / simpson(at.power, x=at.log_q)
        mean = simpson(height * at.log_q, x=at.log_q)
        width = np.sqrt(simpson(height * (at.log_q - mean) ** 2, x=at.log_q))
        more = FORM.excess - FORM.stiffer * stiffer[-1] * np.sqrt(last)
        more -= FORM.narrow * (1 - last**0.25) * np.exp(-width)
        whole *= np.exp((1 - last) ** 1.5 * more)
        of_own = simpson(own, x=at.log_q)
        own *= min(1.0, whole / of_own)
        level = max(whole - of_own, 0.0) / simpson(source, x=at.log_q)
        each = 2 * p * (own + level * of_edges) * drag / stiffness
        beyond = self.averages(
            at.q[-1] * np.exp(x), rise[-1], self.softer[-1], self.lossier[-1]
        )
        edges = 2 * p * level * simpson(fading * beyond[0] / beyond[1], x=x)
        return each, edges, shear, share, area

    def made(self, rise: np.ndarray) -> tuple[np.ndarray, float, float, float]:
        """The rises that friction makes at these, mu, the area and the share of the
        road.
        """
        at, conductivity = self.at, self.heat.conductivity
        each, edges, shear, share, area = self.friction(rise)
        mu = simpson(each, x=at.log_q) + edges + shear
        flux = mu * self.pressure * self.velocity
        depth = 4 * at.q**2 / (self.k[:, None] ** 2 + 4 * at.q**2)  # D_q(k) (k, q)
        # S(k)
        heat = (simpson(each * depth, x=at.log_q) + edges * depth[:, -1] + shear) / mu
        lost = 1 / share - 1
        around = (
            cumulative_simpson(self.kernel * lost, x=at.log_q, initial=0)
            + lost * self.inside
        )
        factor = 2 / (np.pi * conductivity)
        volume = factor * self.over_k((around * depth * heat[:, None]).T)
        to_road = 0.0
        if self.heat.road is not None:
            surface = factor * self.over_k((around * depth).T)
            top = factor * self.over_k(around[:, -1] * heat)
            line = (
                simpson(self.r * i0e(self.w * self.r) * lost, x=at.log_q)
                + lost[-1] * self.line_inside
            )
            still = simpson(self.r * lost, x=at.log_q) + lost[-1] * self.r[-1]
            resistance = line / conductivity + still / self.heat.road[0]
            to_road = top / resistance if resistance > 0 else 0.0
            volume = volume - to_road * surface
        return flux * volume, float(mu), area, to_road

    def solve(self, start: float = 0.0, pace: float = 0.5) -> Hot:
        """From cold, or from a rise of `start` [K]: relaxed until it comes near, then by
        Anderson's method with five steps of memory. At a small `pace` it is the way on
        which rubber warms up or cools down.
        """
        most = 0.999 * self._most()
        rise, before = np.full(self.at.q.size, start), np.inf
        places: list[np.ndarray] = []
        rests: list[np.ndarray] = []
        for _ in range(400):
            off = self.made(rise)[0] - rise
            size = np.abs(off).max()
            if size <= 1e-9 * max(1.0, rise.max()):
                break
            pace = 0.5 * pace if size > before else min(1.1 * pace, 1.0)
            places, rests, before = [*places[-5:], rise], [*rests[-5:], off], size
            step = pace * off
            if size < 0.01 * rise.max() and len(rests) > 1:
                moved, turned = np.diff(places, axis=0).T, np.diff(rests, axis=0).T
                weight = np.linalg.lstsq(turned, off, rcond=1e-10)[0]
                step = off - (moved + turned) @ weight
            rise = np.clip(rise + step, 0.0, most)
        made, mu, area, to_road = self.made(rise)
        settled = (
            np.abs(made - rise).max() <= 1e-6 * max(1.0, rise.max())
            and rise.max() < most
        )
        return Hot(mu, area, float(rise[-1]), float(to_road), bool(settled))
