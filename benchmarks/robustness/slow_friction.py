"""Traction and tangential loading by slow routes that share nothing with elastomdr:
judges of the stress test.

Traction of a parabola g = c x^2 (a paraboloid, or a cylinder on a layer) whose edges
are known: with r the distance behind the leading edge a, x = a - r and s_k = v tau_k,

    q(r) = E_inf c (a^2 - x^2) + 2 c eta v x + sum_k 2 c E_k s_k [(x + s_k) - (a + s_k) e^{-r/s_k}],
    tau(r) = xi [G_inf r + eta_t v + sum_k G_k s_k (1 - e^{-r/s_k})],

an element slips from where tau = mu q on; both are integrated in closed form with as
many digits as cancel. A march of each element through the contact says whether one
sticks again, and is the answer then.

Tangential loading: elements as play operators, tau+ = clip(tau + G dU, -mu q+, mu q+),
exact for elastic ones between two instants, in many steps for viscoelastic ones at a
constant depth, and Gauss' rule over panels of x that are halved.
"""

import itertools
from typing import Any

import numpy as np
from mpmath import mp
from slow_elements import integral
from slow_route import Law

_PLACES = np.unique(
    np.r_[
        np.geomspace(1e-12, 0.5, 120),
        np.linspace(0.01, 0.99, 99),
        1 - np.geomspace(1e-12, 0.5, 80),
    ]
)


def brush(
    normal: Law,
    sheared: Law,
    steepness: float,
    velocity: float,
    edges: tuple[float, float],
    mu: float,
    creep: float,
) -> float:
    """F_x per weight of elements that slip to the end once they slip."""
    reach = max(
        [
            1.0,
            *(
                velocity * t / (edges[0] + edges[1])
                for law in (normal, sheared)
                for t in law.times
            ),
        ]
    )
    with mp.workdps(40 + int(4 * np.log10(reach))):
        a, b, c, v, xi = (
            mp.mpf(float(x)) for x in (*edges, steepness, velocity, creep)
        )
        friction, length = mp.mpf(mu), a + b
        rest = [
            (mp.mpf(float(e)), v * mp.mpf(float(t)))
            for e, t in zip(normal.moduli, normal.times, strict=True)
        ]
        shear = [
            (mp.mpf(float(e)), v * mp.mpf(float(t)))
            for e, t in zip(sheared.moduli, sheared.times, strict=True)
        ]
        soft, drag = mp.mpf(normal.equilibrium), v * mp.mpf(normal.viscosity)
        still, pull = mp.mpf(sheared.equilibrium), v * mp.mpf(sheared.viscosity)

        def q(r: Any) -> Any:
            x = a - r
            branch = mp.fsum(
                2 * c * e * s * ((x + s) - (a + s) * mp.exp(-r / s)) for e, s in rest
            )
            return soft * c * (a - x) * (a + x) + 2 * c * drag * x + branch

        def pressed(r: Any) -> Any:
            x = a - r
            elastic = soft * c * (a**2 * r - (a**3 - x**3) / 3) + c * drag * (
                a**2 - x**2
            )
            return elastic + mp.fsum(
                2
                * c
                * e
                * s
                * (((a + s) ** 2 - (x + s) ** 2) / 2 + (a + s) * s * mp.expm1(-r / s))
                for e, s in rest
            )

        def tau(r: Any) -> Any:
            return xi * (
                still * r + pull - mp.fsum(e * s * mp.expm1(-r / s) for e, s in shear)
            )

        def summed(r: Any) -> Any:
            return xi * (
                still * r**2 / 2
                + pull * r
                + mp.fsum(e * s * (r + s * mp.expm1(-r / s)) for e, s in shear)
            )

        if xi == 0 or mp.isinf(friction):
            return float(summed(length))
        low = mp.mpf(0)
        for part in _PLACES:
            high = length * mp.mpf(float(part))
            if friction * q(high) <= tau(high):
                break
            low = high
        else:
            high = length
        for _ in range(90):
            middle = (low + high) / 2
            if friction * q(middle) > tau(middle):
                low = middle
            else:
                high = middle
        return float(summed(low) + friction * (pressed(length) - pressed(low)))


def brush_march(
    normal: Law,
    sheared: Law,
    steepness: float,
    velocity: float,
    edges: tuple[float, float],
    mu: float,
    creep: float,
    steps: int,
) -> tuple[float, bool]:
    """F_x per weight, step by step, and whether an element that slipped sticks
    again.
    """
    a, length = edges[0], edges[0] + edges[1]
    s = np.arange(steps + 1) / steps
    # a dashpot may slip over any short way behind the leading edge
    r = length * s**8 * (9 - 8 * s)
    x, c = a - r, steepness
    dr = np.diff(r)
    f, p = np.zeros(normal.moduli.size), np.zeros(sheared.moduli.size)
    z, zt = (
        dr[:, None] / (velocity * normal.times),
        dr[:, None] / (velocity * sheared.times),
    )
    kept, gain = np.exp(-z), -np.expm1(-z) / z
    lag = np.where(z < 1e-4, 0.5 - z / 6, (1 - gain) / np.where(z > 0, z, 1))
    keep, mean = np.exp(-zt), sheared.moduli * -np.expm1(-zt) / zt
    stiffness = sheared.equilibrium + mean.sum(1) + sheared.viscosity * velocity / dr
    q = (
        normal.equilibrium * c * (a - x) * (a + x)
        + 2 * c * normal.viscosity * velocity * x
    )
    for i in range(steps):  # slope 2 c x, linear over the step
        f = kept[i] * f + normal.moduli * 2 * c * dr[i] * (
            x[i] * gain[i] + (x[i + 1] - x[i]) * lag[i]
        )
        q[i + 1] += f.sum()
    limit = mu * np.maximum(q, 0)
    u, tau, total, slipped, again = (
        0.0,
        min(creep * sheared.viscosity * velocity, limit[0]),
        0.0,
        False,
        False,
    )
    for i in range(steps):
        free = sheared.equilibrium * u + (keep[i] * p).sum()
        trial = free + stiffness[i] * creep * dr[i]
        slips = trial > limit[i + 1]
        new = limit[i + 1] if slips else trial
        moved = (new - free) / stiffness[i]
        again |= (
            slipped
            and not slips
            and trial < limit[i + 1] * (1 - 1e-9)
            and i < steps - 1
        )
        slipped |= bool(slips)
        p = keep[i] * p + mean[i] * moved
        u += moved
        total += 0.5 * dr[i] * (tau + new)
        tau = new
    return total, bool(again)


def sheared_elastic(
    modulus: float,
    sideways: float,
    mu: float,
    steepness: float,
    depth: np.ndarray,
    displacement: np.ndarray,
) -> tuple[np.ndarray, float]:
    """F_x [N] at the instants, a parabola g = c x^2 whose depth and displacement are
    linear in between.
    """

    def tractions(x: np.ndarray) -> np.ndarray:
        g = steepness * x**2
        q = modulus * np.maximum(depth[0] - g, 0)
        tau = np.clip(sideways * displacement[0], -mu * q, mu * q)
        out = [tau]
        for d0, d1, u0, u1 in zip(
            depth[:-1], depth[1:], displacement[:-1], displacement[1:], strict=True
        ):
            share = np.where(
                d0 >= g,
                1.0,
                np.where(d1 > g, (d1 - g) / np.where(d1 > d0, d1 - d0, 1.0), 0.0),
            )
            q = modulus * np.maximum(d1 - g, 0)
            tau = np.clip(tau + sideways * (u1 - u0) * share, -mu * q, mu * q)
            out.append(tau)
        return np.stack(out, 1)

    ends = np.unique(np.r_[0.0, np.sqrt(depth[depth > 0] / steepness)])
    total, own = integral(tractions, ends)
    return 2 * total, own


def sheared_slowly(
    normal: Law,
    sheared: Law,
    mu: float,
    steepness: float,
    depth: float,
    time: np.ndarray,
    displacement: np.ndarray,
    steps: int,
) -> tuple[np.ndarray, float]:
    """F_x [N] at the instants at a depth that is put on at once and kept, in `steps`
    steps between two instants.
    """
    glassy = sheared.equilibrium + sheared.moduli.sum()
    # the first step e^-16 of the interval, so that what is put on at once is resolved
    grade = 16.0
    place = np.expm1(grade * np.arange(steps + 1) / steps) / np.expm1(grade)

    def tractions(x: np.ndarray) -> np.ndarray:
        pressed = depth - steepness * x**2
        limit = mu * (normal.equilibrium + normal.moduli.sum()) * pressed
        tau = np.clip(glassy * displacement[0], -limit, limit)
        u = tau / glassy
        p = sheared.moduli[:, None] * u
        out = [tau]
        for t0, t1, u0, u1 in zip(
            time[:-1], time[1:], displacement[:-1], displacement[1:], strict=True
        ):
            for s0, s1 in itertools.pairwise(place):
                h = (t1 - t0) * (s1 - s0)
                z = h / sheared.times
                keep, mean = (
                    np.exp(-z)[:, None],
                    (sheared.moduli * -np.expm1(-z) / z)[:, None],
                )
                stiffness = sheared.equilibrium + mean.sum()
                faded = np.exp(-(t0 - time[0] + s1 * (t1 - t0)) / normal.times)
                limit = (
                    mu * (normal.equilibrium + (normal.moduli * faded).sum()) * pressed
                )
                free = sheared.equilibrium * u + (keep * p).sum(0)
                tau = np.clip(free + stiffness * (u1 - u0) * (s1 - s0), -limit, limit)
                moved = (tau - free) / stiffness
                p, u = keep * p + mean * moved, u + moved
            out.append(tau)
        return np.stack(out, 1)

    total, own = integral(
        tractions, np.sqrt(depth / steepness) * np.linspace(0, 1, 9), 1e-8
    )
    return 2 * total, own
