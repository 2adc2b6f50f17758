"""Friction on rough surfaces by slow routes that share nothing with elastomdr: judges
of the stress test of surfaces.

`theory` evaluates the integrals of Persson's theory and of `em.Multiscale` as
`docs/theory.md` states them, by Gauss' rule on panels of log q that shrink towards the
lower cutoff and on panels of the angle that shrink towards where a wave runs across the
motion; the area that grows with magnification by an ordinary differential equation.
`full_contact` is the sum over the waves of a line, `cells` a contact in three
dimensions by elimination with a dense matrix, `at_rest` a line pressed into elements by
bisection on its own sorted samples.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq
from scipy.special import erf
from slow_route import Law

X, W = np.polynomial.legendre.leggauss(8)
TO_SERIES = np.linalg.inv(np.polynomial.legendre.legvander(X, 7))
# theory.md, section 23
SHIFT, LEVEL, SLOPE, POWER, EDGE, RISE = 0.5591, 0.5342, 0.6075, 0.3736, 0.5577, 0.7962
FAR = 30.0


class Theory(NamedTuple):
    """mu of both models, and the real contact."""

    mu: float
    area: float
    full: float  # mu of full contact


def modulus(law: Law, omega: Any) -> Any:
    """E*(omega) of a series."""
    w = np.asarray(omega, dtype=float)
    z = 1j * w[..., None] * law.times
    return law.equilibrium + 1j * w * law.viscosity + (law.moduli * z / (1 + z)).sum(-1)


def averages(
    law: Law, omega: np.ndarray, panels: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """int cos Im E*(w cos) dphi, int (Re E*)^2 dphi and int (Im E*)^2 dphi at each
    omega.
    """
    ends = np.linspace(0.0, 40.0, panels + 1)
    s = 0.5 * (ends[1:] + ends[:-1])[:, None] + 0.5 * np.diff(ends)[:, None] * X
    u = (0.5 * np.pi * np.exp(-s)).ravel()
    weight = 4 * u * (0.5 * np.diff(ends)[:, None] * W).ravel()
    cosine = np.sin(u)
    out = np.empty((3, omega.size))
    for i, w in enumerate(omega):
        value = modulus(law, w * cosine)
        out[:, i] = weight @ np.stack(
            [cosine * value.imag, value.real**2, value.imag**2], 1
        )
    return tuple(out)


@functools.lru_cache(maxsize=256)
def _stored(gamma: float) -> Callable[[Any], Any]:
    """log G of log R where dG/dR = S(G), G(0) = 0: R is the integral of 1/S, turned
    round.
    """
    log_g = np.linspace(np.log(1e-6), np.log(1e40), 6001)
    half = 0.5 * np.diff(log_g)
    g = np.exp(log_g[:-1, None] + half[:, None] * (1 + X))
    slow = 1 / (gamma + (1 - gamma) * erf(0.5 / np.sqrt(g)) ** 2)
    r = np.exp(log_g[0]) + np.append(0.0, np.cumsum(half * ((g * slow) @ W)))
    inverse = CubicSpline(np.log(r), log_g)
    return lambda x: np.where(
        x < log_g[0], x, inverse(np.clip(x, log_g[0], np.log(r[-1])))
    )


def theory(
    law: Law,
    q: np.ndarray,
    c: np.ndarray,
    velocity: float,
    pressure: float,
    model: str,
    gamma: float = 0.5,
    stored: bool = True,
    soften: Callable[[Any], Any] | None = None,
    kinks: Any = (),
    fine: int = 1,
) -> Theory:
    """Persson's theory or Multiscale at a point; `soften(strain over s)` gives the
    factors on both moduli.

    `kinks` are the wave numbers where a factor may have one.
    """
    ends = [np.log(q[0])]
    for i in range(q.size - 1):
        width = np.log(q[i + 1] / q[i])
        count = max(2, int(np.ceil(3 * fine * width)))
        if i == 0:
            even = width / count
            ends += list(ends[0] + even * 2.0 ** np.arange(-40.0, 0.5 / fine, 1 / fine))
            ends += list(np.linspace(ends[-1], np.log(q[1]), count)[1:])
        else:
            ends += list(np.linspace(np.log(q[i]), np.log(q[i + 1]), count + 1)[1:])
    bends = np.append(np.log(kinks), np.log(q[-1]) - SHIFT)
    ends = np.unique(np.append(ends, bends[bends > ends[0]]))
    half, middle = 0.5 * np.diff(ends), 0.5 * (ends[1:] + ends[:-1])
    x = middle[:, None] + half[:, None] * X
    weight = half[:, None] * W
    log_q, log_c = np.log(q), np.log(c)
    power = np.exp(4 * x + np.interp(x, log_q, log_c))
    end_power = np.exp(4 * log_q[-1] + log_c[-1])
    drag, real, lost = (
        a.reshape(x.shape)
        for a in averages(law, velocity * np.exp(x).ravel(), 20 * fine)
    )
    edge = 0.5 * np.log(FAR) * (1 + np.polynomial.legendre.leggauss(24 * fine)[0])
    edge_weight = 0.5 * np.log(FAR) * np.polynomial.legendre.leggauss(24 * fine)[1]
    far = averages(law, velocity * q[-1] * np.exp(np.append(0.0, edge)), 20 * fine)
    f = g = np.ones_like(x)
    f_end = g_end = 1.0
    if soften is not None:
        slopes = _Until(2 * np.pi * power, ends)
        f, g = soften(np.sqrt(slopes(x)))
        f_end, g_end = soften(np.sqrt(slopes(np.array([log_q[-1]]))))
        f_end, g_end = float(f_end[0]), float(g_end[0])
    drag, stiffness = g * drag, f**2 * real + g**2 * lost
    far_drag, far_stiffness = g_end * far[0], f_end**2 * far[1] + g_end**2 * far[2]
    rate = power * stiffness / (8 * pressure**2)
    until = _Until(rate, ends)

    def share(r: Any) -> Any:
        r = np.maximum(r, 1e-300)
        spread = np.exp(_stored(gamma)(np.log(r))) if stored else r
        return erf(0.5 / np.sqrt(spread))

    total = float((rate * weight).sum())
    area = float(share(np.array([total]))[0])
    full = weight * power * drag / (2 * pressure)
    if model == "persson":
        shares = share(until(x))
        mu = (full * (gamma + (1 - gamma) * shares**2) * shares).sum()
        return Theory(float(mu), area, float(full.sum()))
    end = end_power * far_stiffness[0] / (8 * pressure**2)
    later = np.maximum(share(until(np.minimum(x + SHIFT, log_q[-1]))), area)
    level = 1 - (1 - LEVEL) * (1 - area) * (end / total) ** SLOPE
    weights = (
        level * area
        + (1 - level * area) * (later - area) / max(1 - area, 1e-12) * later**POWER
    )
    rise = end / total * ((power * weight).sum() / end_power)
    beyond = 4 * pressure * end * far_drag[1:] / far_stiffness[1:] * np.exp(-2 * edge)
    edges = EDGE * area * (1 - area) * rise**RISE * float(beyond @ edge_weight)
    return Theory(float((full * weights).sum()) + edges, area, float(full.sum()))


class _Until:
    """int from the first end of `values` given at Gauss' nodes of panels, as a function
    of the upper limit.
    """

    def __init__(self, values: np.ndarray, ends: np.ndarray):
        half = 0.5 * np.diff(ends)
        self._ends, self._half = ends, half
        self._whole = np.concatenate([[0.0], np.cumsum(half * (values @ W))])
        self._series = np.array(
            [np.polynomial.legendre.legint(TO_SERIES @ v, lbnd=-1) for v in values]
        )

    def __call__(self, x: Any) -> np.ndarray:
        at = np.clip(
            np.searchsorted(self._ends, x, side="right") - 1, 0, self._half.size - 1
        )
        local = np.clip((x - self._ends[at]) / self._half[at] - 1, -1, 1)
        inside = (np.polynomial.legendre.legvander(local, 8) * self._series[at]).sum(-1)
        return np.clip(
            self._whole[at] + self._half[at] * inside,
            self._whole[at],
            self._whole[at + 1],
        )


def full_contact(
    law: Law, heights: np.ndarray, spacing: float, velocity: float, load: float
) -> float:
    """mu of a line that touches everywhere, wave by wave in a plain loop; NaN where it
    would have to pull.
    """
    n, drag, force = heights.size, 0.0, np.full(heights.size, load)
    place = np.arange(n)
    for j in range(1, n // 2 + 1):
        wave = np.exp(-2j * np.pi * j * place / n) @ heights / n
        k = 2 * np.pi * j / (n * spacing)
        own = complex(modulus(law, k * velocity))
        both = 1 if 2 * j == n else 2
        drag += both * abs(wave) ** 2 * k * own.imag
        force = force + both * np.real(
            np.conj(own) * wave * np.exp(2j * np.pi * j * place / n)
        )
    return drag / load if force.min() > 0 else np.nan


def cells(
    law: Law, heights: np.ndarray, side: float, velocity: float, pressure: float
) -> float:
    """mu of a map in three dimensions."""
    n = len(heights)
    j = np.fft.fftfreq(n, 1 / n)
    kx, k = 2 * np.pi / side * j[:, None], 2 * np.pi / side * np.hypot(j[:, None], j)
    own = modulus(law, np.abs(kx) * velocity)
    own = np.where(kx > 0, np.conj(own), own)
    own[n // 2] = own[n // 2].real
    k[0, 0] = 1.0
    kernel = 2 / (k * own)
    kernel[0, 0] = 0.0
    answer = np.fft.ifft2(kernel).real
    a, b = (each.ravel() for each in np.indices((n, n)))
    matrix = answer[(a[:, None] - a) % n, (b[:, None] - b) % n]
    h = (heights - heights.mean()).ravel()
    on, p = h > np.quantile(h, 0.5), np.zeros(h.size)
    for turn in range(200):
        some = np.flatnonzero(on)
        system = np.ones((some.size + 1, some.size + 1))
        system[-1, -1] = 0.0
        scale = np.abs(answer).max()
        system[:-1, :-1] = matrix[np.ix_(some, some)] / scale
        found = np.linalg.solve(system, np.append(h[some] / scale, pressure * h.size))
        p = np.zeros(h.size)
        p[some] = found[:-1]
        gap = matrix @ p + found[-1] * scale - h
        pull, overlap = on & (p <= 0), ~on & (gap < -1e-12 * h.std())
        if not (pull | overlap).any():
            break
        on = (on & ~pull) | (overlap if turn % 4 != 3 else False)
    else:
        raise ArithmeticError("no contact found")
    power = np.abs(np.fft.fft2(p.reshape(n, n)) / p.size) ** 2
    loss = np.where(kx == 0, 0.0, np.abs(own.imag))
    stress = (power * 2 * np.abs(kx) * loss / (k * np.abs(own) ** 2))[k > 0].sum()
    return float(stress / pressure)


def at_rest(heights: np.ndarray, load: float) -> tuple[float, float]:
    """Mean gap and share in contact of a line under the mean load over the modulus [m],
    straight between its points.
    """
    g = heights.max() - heights
    low, high = np.minimum(g, np.roll(g, -1)), np.maximum(g, np.roll(g, -1))
    rise = np.maximum(high - low, 1e-300)

    def carried(d: float) -> float:
        part = np.clip(d - low, 0, rise)
        return float(np.mean(0.5 * part**2 / rise + np.maximum(d - high, 0.0))) - load

    d = brentq(carried, 0.0, g.max() + load, xtol=1e-15 * g.max(), rtol=1e-14)
    return float(g.mean() - d + load), float(np.mean(np.clip((d - low) / rise, 0, 1)))


def creep(law: Law, time: float) -> float:
    """J(t) by Talbot's inversion of 1/(s E(s)), s-multiplied, in 40 digits."""
    with mp.workdps(40):

        def transform(s: Any) -> Any:
            branches = zip(law.moduli, law.times, strict=True)
            stiff = mp.fsum(
                mp.mpf(float(e)) * s * mp.mpf(float(t)) / (1 + s * mp.mpf(float(t)))
                for e, t in branches
            )
            return 1 / (
                s * (mp.mpf(law.equilibrium) + s * mp.mpf(law.viscosity) + stiff)
            )

        return float(
            mp.invertlaplace(transform, mp.mpf(time), method="talbot", degree=40)
        )
