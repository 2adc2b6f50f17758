"""Friction of a polynomial profile to any number of digits, by none of elastomdr's
machinery: the external reference.

For a profile g(x) on a line of Prony elements, sliding at velocity v with contact from
x = -b to x = a, the force density is (Popov & Hess 2015, ch. 7, with s_k = v tau_k)

    q(x) = E_inf [g(a) - g(x)] + sum_k E_k I_k(x),    I_k(x) = Q_k(x) - Q_k(a) exp(-(a - x)/s_k),

where Q_k, of Q_k - s_k Q_k' = s_k g', is a polynomial if g is one. F_N = int q dx and
F_x = int q g' dx are then elementary as well. The digits that cancel for s_k >> a are
carried by mpmath. A sphere enters by the power series of its profile x artanh(x/R), cut
where nothing is left of it. Directions are averaged by scipy's adaptive quadrature.
"""

import math
from dataclasses import dataclass

from mpmath import mp
from scipy.integrate import quad

DIGITS = 18  # of a line's mu


@dataclass(frozen=True)
class Line:
    """An MDR line: the slope g' as a polynomial, and the Prony series of its
    elements.
    """

    slope: tuple[float, ...]  # coefficients of x^0, x^1, ... in g' [m^-j]
    equilibrium: float  # E_inf [Pa]
    moduli: tuple[float, ...]  # E_k [Pa]
    times: tuple[float, ...]  # tau_k [s]


@dataclass(frozen=True)
class Sliding:
    """A line in steady sliding."""

    mu: float
    normal_force: float  # [N]
    leading: float  # a [m]
    trailing: float  # b [m]


def paraboloid(radius: float) -> tuple[float, ...]:
    """g' of g = x^2/R."""
    return (0.0, 2 / radius)


def sphere(radius: float, largest: float) -> tuple[float, ...]:
    """g' of g = x artanh(x/R) = sum_n R (x/R)^(2n+2)/(2n+1), exact to 1e-17 for contact
    radii up to `largest`.
    """
    terms = math.ceil(math.log(1e-17) / (2 * math.log(largest / radius)))
    slope = [0.0] * (2 * terms)
    slope[1::2] = [
        (2 * n + 2) / (2 * n + 1) / radius ** (2 * n + 1) for n in range(terms)
    ]
    return tuple(slope)


def slide(
    line: Line, velocity: float, *, load: float | None = None, leading: float
) -> Sliding:
    """Steady sliding with its leading edge at `leading` [m], or at a load [N], with the
    edge sought from there.
    """
    cancelling = 1 + len(line.slope) * velocity * max(line.times) / leading
    with mp.workdps(
        DIGITS + 12 + math.ceil(2 * (len(line.slope) + 1) * math.log10(cancelling))
    ):
        contact = _Contact(line, velocity)
        a, ratio = mp.mpf(leading), mp.mpf("0.7")
        for _ in range(50):
            ratio = contact.exit(a, ratio)
            b = ratio * a
            force, stiffness = contact.normal_force(a, b)
            if load is None or abs(force / load - 1) < mp.mpf(10) ** -DIGITS:
                return Sliding(
                    float(contact.friction_force(a, b) / force),
                    float(force),
                    float(a),
                    float(b),
                )
            a *= mp.exp(-mp.log(force / load) * force / (stiffness * a))
    raise RuntimeError(f"no contact found for a load of {load} N at {velocity} m/s")


def direction_average(
    line: Line, velocity: float, load: float, leading: float
) -> float:
    """(2/pi) int_0^{pi/2} cos(phi) mu_line(v cos(phi)) dphi at the same load, to about
    1e-12 of it.

    With phi = (pi/2)(1 - exp(-y)), since mu_line is smooth in the logarithm of
    velocity; beyond y = 16 nothing is left.
    """
    last = leading

    def integrand(y: float) -> float:
        nonlocal last
        angle = math.pi / 2 * math.exp(-y)  # pi/2 - phi
        found = slide(line, velocity * math.sin(angle), load=load, leading=last)
        last = found.leading
        return angle * math.sin(angle) * found.mu

    return 2 / math.pi * quad(integrand, 0, 16, epsabs=0, epsrel=1e-11, limit=200)[0]


class _Contact:
    """The closed forms at one velocity."""

    def __init__(self, line: Line, velocity: float):
        self.slope = [mp.mpf(c) for c in line.slope]
        self.profile = _integral(self.slope)
        self.equilibrium = mp.mpf(line.equilibrium)
        branches = [
            (mp.mpf(e), mp.mpf(velocity) * mp.mpf(t))
            for e, t in zip(line.moduli, line.times, strict=True)
        ]
        self.branches = [(e, s, _response(self.slope, s)) for e, s in branches]

    def density(self, a, b):
        """q(-b) and its derivative by b."""
        q = self.equilibrium * (_at(self.profile, a) - _at(self.profile, b))
        slope = -_at(self.slope, b) * (
            self.equilibrium + mp.fsum(e for e, _, _ in self.branches)
        )
        for modulus, s, response in self.branches:
            branch = modulus * self._memory(a, b, s, response)
            q, slope = q + branch, slope - branch / s
        return q, slope

    def exit(self, a, ratio):
        """b/a, where q(-b) = 0."""
        low, high = mp.mpf(0), mp.mpf(1)
        for _ in range(200):
            q, slope = self.density(a, ratio * a)
            low, high = (ratio, high) if q > 0 else (low, ratio)
            following = ratio - q / (slope * a)
            following = following if low < following < high else (low + high) / 2
            if abs(following - ratio) < mp.mpf(10) ** -DIGITS * (1 - ratio):
                return following
            ratio = following
        raise RuntimeError("no trailing edge found")

    def normal_force(self, a, b):
        """F_N and its derivative by a; that by b is q(-b) = 0."""
        whole = _integral(self.profile)
        force = self.equilibrium * (
            _at(self.profile, a) * (a + b) - _at(whole, a) + _at(whole, -b)
        )
        stiffness = self.equilibrium * (a + b)
        for modulus, s, response in self.branches:
            rise = _at(self.profile, a) - _at(self.profile, b)
            force += modulus * s * (rise - self._memory(a, b, s, response))
            stiffness -= modulus * s * mp.expm1(-(a + b) / s)
        return force, stiffness * _at(self.slope, a)

    def friction_force(self, a, b):
        force = (
            self.equilibrium * (_at(self.profile, a) - _at(self.profile, b)) ** 2 / 2
        )
        for modulus, s, response in self.branches:
            product = _integral(_product(response, self.slope))
            decay = _at(response, b) * mp.exp(-(a + b) / s) - _at(response, -a)
            force += modulus * (
                _at(product, a) - _at(product, -b) - _at(response, a) * decay
            )
        return force

    def _memory(self, a, b, s, response):
        """I_k(-b)."""
        return _at(response, -b) - _at(response, a) * mp.exp(-(a + b) / s)


def _response(slope, s):
    """Q of Q - s Q' = s g'."""
    response = [mp.mpf(0)] * (len(slope) + 1)
    for j in range(len(slope) - 1, -1, -1):
        response[j] = s * (slope[j] + (j + 1) * response[j + 1])
    return response[:-1]


def _at(coefficients, x):
    return mp.polyval(coefficients[::-1], x)


def _integral(coefficients):
    return [mp.mpf(0)] + [c / (j + 1) for j, c in enumerate(coefficients)]


def _product(first, second):
    product = [mp.mpf(0)] * (len(first) + len(second) - 1)
    for i, c in enumerate(second):
        if c:
            for j, d in enumerate(first):
                product[i + j] += c * d
    return product
