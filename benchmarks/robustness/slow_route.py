"""Steady sliding of a line by slow routes that share nothing with elastomdr: the judges
of the stress test.

Both start from a leading edge a and return the trailing edge b, F_N and F_x of the line
(Popov & Hess 2015, ch. 7),

    q(x) = E_inf [g(a) - g(x)] + eta v g'(x) + sum_k f_k(x),
    f_k(x) = E_k int_x^a exp(-(y - x)/s_k) g'(y) dy,

with s_k = v tau_k, b where q(-b) = 0, F_N = int q dx and F_x = int q g' dx. `closed`
has the integrals of a paraboloid and of a cone in closed form, with as many digits
(mpmath) as cancel. `marched` takes any body: it follows f_k element by element on
panels that shrink geometrically towards every kink, with Gauss' rule on each, in double
precision. A branch slower than the passage enters as E_k [g(a) - g(x) - h_k(x)] with
h_k = int (1 - exp(-(y - x)/s_k)) g'(y) dy, so that a small loss is not the difference
of large numbers; about ten digits of mu are left.
"""

import itertools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

NODES = np.polynomial.legendre.leggauss(12)
INNER = np.polynomial.legendre.leggauss(32)
# relaxation lengths after which nothing is left of a branch, exp(-42) = 6e-19
FAR = 42.0
LEVELS = 18  # panels towards a kink, each a quarter of the one before


class Law(NamedTuple):
    """A Prony series of E* units: E_inf [Pa], E_k [Pa], tau_k [s], eta [Pa s]."""

    equilibrium: float
    moduli: np.ndarray
    times: np.ndarray
    viscosity: float


class Body(NamedTuple):
    """The MDR line of a body: `profile` g [m], `slope` g', and where g' or a derivative
    of it jumps (x >= 0) [m].
    """

    profile: Callable[[Any], Any]
    slope: Callable[[Any], Any]
    kinks: tuple[float, ...] = (0.0,)


class Truth(NamedTuple):
    """The line at a leading edge."""

    mu: float
    normal_force: float  # [N]
    trailing: float  # b [m]


def closed(
    power: int, steepness: float, law: Law, velocity: float, leading: float
) -> Truth:
    """The line g = steepness |x|^power, power 1 or 2, in as many digits as cancel."""
    reach = max([1.0, *(velocity * law.times / leading)])
    with mp.workdps(45 + int(4 * np.log10(reach))):
        a, c, v = mp.mpf(leading), mp.mpf(steepness), mp.mpf(velocity)
        line = (_Parabola if power == 2 else _Wedge)(law, v, a, c)
        b = line.exit()
        normal, drag = line.forces(b)
        return Truth(float(drag / normal), float(normal), float(b))


class _Closed:
    """What both closed forms share; `memory` is f_k(-b)/E_k."""

    def __init__(self, law: Law, v: Any, a: Any, c: Any):
        self.a, self.c, self.spring, self.dashpot = (
            a,
            c,
            mp.mpf(law.equilibrium),
            v * mp.mpf(law.viscosity),
        )
        branches = zip(law.moduli, law.times, strict=True)
        self.branches = [
            (mp.mpf(float(e)), v * mp.mpf(float(t))) for e, t in branches if e > 0
        ]

    def exit(self):
        """b where q(-b) = 0: the false position method with halving (Illinois), zero if
        contact is lost at the apex.
        """
        low, high = self.a * mp.mpf(10) ** -30, self.a
        at_low, at_high = self.density(low), self.density(high)
        if at_low <= 0:
            return mp.mpf(0)
        # far apart: halve the logarithm, the edge may lie anywhere
        while high > 4 * low and low < self.a / 8:
            middle = mp.sqrt(low * high)
            value = self.density(middle)
            low, at_low, high, at_high = (
                (low, at_low, middle, value)
                if value < 0
                else (middle, value, high, at_high)
            )
        for _ in range(400):
            middle = (low * at_high - high * at_low) / (at_high - at_low)
            value = self.density(middle)
            if value == 0 or high - low < mp.mpf(10) ** -30 * (self.a - low):
                return middle
            if value < 0:
                high, at_high, at_low = middle, value, at_low / 2
            else:
                low, at_low, at_high = middle, value, at_high / 2
            if abs(value) < mp.mpf(10) ** -26 * mp.fsum(
                abs(part) for part in self.parts(middle)
            ):
                return middle
        raise RuntimeError("no trailing edge found")

    def parts(self, b):
        branches = [e * self.memory(b, s) for e, s in self.branches]
        return [self.spring * self.rise(b), self.dashpot * self.slope(-b), *branches]

    def density(self, b):
        return mp.fsum(self.parts(b))

    def forces(self, b):
        rise = self.rise(b)
        normal = self.spring * self.volume(b) + self.dashpot * rise
        drag = self.spring * rise**2 / 2 + self.dashpot * self.squared(b)
        for e, s in self.branches:
            normal += e * s * (rise - self.memory(b, s))
            drag += e * self.work(b, s)
        return normal, drag


class _Parabola(_Closed):
    def slope(self, x):
        return 2 * self.c * x

    def rise(self, b):
        return self.c * (self.a - b) * (self.a + b)

    def volume(self, b):
        a = self.a
        return self.c * (a**2 * (a + b) - (a**3 + b**3) / 3)

    def squared(self, b):
        return 4 * self.c**2 * (self.a**3 + b**3) / 3

    def memory(self, b, s):
        return 2 * self.c * s * ((s - b) - (self.a + s) * mp.exp(-(self.a + b) / s))

    def work(self, b, s):
        a, gone = self.a, mp.exp(-(self.a + b) / s)
        whole = (a**3 + b**3) / 3 + s * (a**2 - b**2) / 2  # int (x + s) x dx
        return 4 * self.c**2 * s * (whole - (a + s) * s * ((b + s) * gone + a - s))


class _Wedge(_Closed):
    def slope(self, x):
        return self.c * mp.sign(x)

    def rise(self, b):
        return self.c * (self.a - b)

    def volume(self, b):
        a = self.a
        return self.c * (a * (a + b) - (a**2 + b**2) / 2)

    def squared(self, b):
        return self.c**2 * (self.a + b)

    def memory(self, b, s):
        return self.c * s * (2 * mp.exp(-b / s) - 1 - mp.exp(-(self.a + b) / s))

    def work(self, b, s):
        front, back = -mp.expm1(-self.a / s), -mp.expm1(-b / s)
        return self.c**2 * s * (self.a + b - s * (front + back + front * back))


def marched(body: Body, law: Law, velocity: float, leading: float) -> Truth:
    """The line of any body, marched from its leading edge."""
    moduli, decay = law.moduli[law.moduli > 0], velocity * law.times[law.moduli > 0]
    slow = decay > leading
    stiff = law.equilibrium + moduli[slow].sum()
    viscous = law.viscosity * velocity
    top = body.profile(leading)

    def walk(ends: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, float, float]:
        """f_k/E_k (fast) or h_k (slow) at the last of descending `ends`, and what was
        added to F_N and F_x.
        """
        normal = drag = 0.0
        state = start
        node, weight = 0.5 * (1 + NODES[0]), 0.5 * NODES[1]
        for x0, x1 in itertools.pairwise(ends):
            x = x0 - (x0 - x1) * np.append(node, 1.0)
            gone = x0 - x
            passed = _local(body, x, gone, decay, slow)
            kept = np.exp(-gone[:, None] / decay)
            carried = kept * state + np.where(
                slow, -np.expm1(-gone[:, None] / decay) * (top - body.profile(x0)), 0.0
            )
            values = carried + passed
            state = values[-1]
            rest = values[:-1] @ np.where(slow, -moduli, moduli)
            slope, width = body.slope(x[:-1]), (x0 - x1) * weight
            elastic = stiff * (top - body.profile(x[:-1]))
            normal += width @ (elastic + viscous * slope + rest)
            drag += width @ ((viscous * slope + rest) * slope)
        return state, normal, drag

    kinks = [k for k in body.kinks if 0 < k < leading]
    at_apex, ahead_normal, ahead_drag = walk(
        _graded([leading, *reversed(kinks), 0.0]), np.zeros(moduli.size)
    )

    def behind(b: float) -> tuple[float, float, float]:
        inner = [-k for k in kinks if k < b]
        state, normal, drag = walk(_graded([0.0, *inner, -b]), at_apex)
        density = (
            stiff * (top - body.profile(b))
            - viscous * body.slope(b)
            + state @ np.where(slow, -moduli, moduli)
        )
        return density, normal, drag

    if behind(1e-12 * leading)[0] <= 0:
        b = 0.0
        normal = drag = 0.0
    else:
        left = brentq(
            lambda log: behind(leading * -np.expm1(log))[0],
            -50.0,
            -1e-12,
            xtol=1e-13,
            rtol=1e-13,
        )
        b = leading * -np.expm1(left)
        _, normal, drag = behind(b)
    rise = top - body.profile(b)
    normal, drag = normal + ahead_normal, drag + ahead_drag + 0.5 * stiff * rise**2
    return Truth(drag / normal, normal, b)


def _local(
    body: Body, x: np.ndarray, reach: np.ndarray, decay: np.ndarray, slow: np.ndarray
) -> np.ndarray:
    """int_0^reach w(r) g'(x + r) dr of each place and branch, w = exp(-r/s) or, for
    slow branches, 1 - exp(-r/s).
    """
    long = np.minimum(reach[:, None], FAR * decay)
    node, weight = 0.5 * (1 + INNER[0]), 0.5 * INNER[1]
    r = long[..., None] * node
    factor = np.where(
        slow[:, None], -np.expm1(-r / decay[:, None]), np.exp(-r / decay[:, None])
    )
    return (factor * body.slope(x[:, None, None] + r) @ weight) * long


def _graded(ends: list[float]) -> np.ndarray:
    """Descending panel ends, ever finer towards each of the given ends."""
    shrink = 0.5 * 0.25 ** np.arange(LEVELS)
    parts = [
        x0 - (x0 - x1) * np.r_[0.0, shrink[::-1], 1 - shrink[1:]]
        for x0, x1 in itertools.pairwise(ends)
    ]
    return np.append(np.concatenate(parts), ends[-1])


def from_points(r: np.ndarray, z: np.ndarray) -> Body:
    """The body of the spline through points (smooth on its axis), by Gauss' rule on
    Abel's integral.

    g = x int f'(x sin t) dt and g' = int [f' + r f''](x sin t) dt over a quarter turn,
    cut where x sin t meets a point; kept between two points as Chebyshev series in
    sqrt(x - r_i), which is how they start behind a point. Before the first point, where
    the spline is one cubic, by the rule itself: a series has no digits left far closer
    to the axis.
    """
    spline = CubicSpline(r, z, bc_type=((1, 0.0), "not-a-knot"))
    node, weight = np.polynomial.legendre.leggauss(16)

    def abel(x: float) -> tuple[float, float]:
        cuts = np.append(np.arcsin(np.append(r[r < x], x) / x)[:-1], np.pi / 2)
        half = 0.5 * np.diff(cuts)[:, None]
        radius = x * np.sin(cuts[:-1, None] + half * (1 + node))
        first, second = spline(radius, 1), spline(radius, 2)
        return x * np.sum(half * weight * first), np.sum(
            half * weight * (first + radius * second)
        )

    degree = 30
    angle = np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    places = r[:-1, None] + np.diff(r)[:, None] * (0.5 * (1 + angle)) ** 2
    values = np.array([[abel(x) for x in row] for row in places])
    series = np.polynomial.chebyshev.chebfit(
        angle, np.moveaxis(values, 1, 0).reshape(degree + 1, -1), degree
    )
    series = series.reshape(degree + 1, r.size - 1, 2)

    def line(x: Any, which: int) -> Any:
        x = np.abs(np.asarray(x, dtype=float))
        i = np.clip(np.searchsorted(r, x, side="right") - 1, 0, r.size - 2)
        t = 2 * np.sqrt(np.maximum(x - r[i], 0) / np.diff(r)[i]) - 1
        radius = np.minimum(x, r[1])[..., None] * np.sin(0.25 * np.pi * (1 + node))
        first, second = spline(radius, 1), spline(radius, 2)
        near = x[..., None] * first if which == 0 else first + radius * second
        far = np.polynomial.chebyshev.chebval(t, series[:, i, which], tensor=False)
        return np.where(x <= r[1], 0.25 * np.pi * near @ weight, far)

    return Body(lambda x: line(x, 0), lambda x: np.sign(x) * line(x, 1), tuple(r[:-1]))
