"""Impact by adaptive integration of the reduced equations: the judge of `em.impact` in
the stress test.

While the contact grows every element is in contact since it was touched, so with A(d)
the elastic force over E*,

    m d'' = -E_inf A(d) - eta A'(d) d' - sum_k F_k,    F_k' = E_k A'(d) d' - F_k/tau_k.

On retreat (Ting 1966) the elements in contact at t are those that were touched before
s(t), where the force at the edge vanishes, E_inf [d(t) - d(s)] + eta d'(t) + sum_k G_k
= 0, G_k = E_k int_s^t e^{-(t-r)/tau_k} d'(r) dr, and

    F_k' = -F_k/tau_k + E_k e^{-(t-s)/tau_k} A'(d(s)) d'(s) s',
    G_k' = -G_k/tau_k + E_k [d'(t) - e^{..} d'(s) s'],
    s' = [E_inf d' + eta d'' + sum_k (E_k d' - G_k/tau_k)] / {[E_inf + sum_k E_k e^{-(t-s)/tau_k}] d'(s)},

until s = 0. At the turn s' is 0/0: there the motion is a parabola, for which the edge's
condition is solved in closed form a short way further. In units of the speed before
impact and of the depth of an elastic body with all moduli; scipy integrates it,
implicitly.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from slow_route import Law

AHEAD = 3e-5  # the way from the turn, over the time of approach
CALLS = 10000  # of the right-hand side, after which the judge gives up
FADED = 1e-11  # of the speed: nothing comes back


class Struck(NamedTuple):
    """Restitution, largest depth [m], duration [s]; stuck as restitution 0 and an
    infinite duration.
    """

    restitution: float
    depth: float
    duration: float


def struck(
    law: Law, power: float, factor: float, mass: float, speed: float, rtol: float = 1e-9
) -> Struck:
    """Impact of a body with A(d) = factor d^power."""
    soft, eta = law.equilibrium, law.viscosity
    everything = soft + law.moduli.sum()
    unit = (0.5 * mass * speed**2 * (power + 1) / (everything * factor)) ** (
        1 / (power + 1)
    )
    clock = unit / speed
    # d'' = -c d^p ..., with moduli over their sum: the energy 1/2 = c/(p + 1) at depth
    # 1.
    c = 0.5 * (power + 1)
    e, tau = law.moduli / everything, law.times / clock
    soft, eta = soft / everything, eta / everything / clock

    calls = itertools.count()

    def approach(_: float, y: np.ndarray) -> np.ndarray:
        if next(calls) > CALLS:
            raise ArithmeticError("the judge takes too long")
        d, v, f = max(y[0], 0.0), y[1], y[2:]
        rise = c * power * d ** (power - 1) * v
        return np.r_[
            v, -(soft * c * d**power + eta * rise + f.sum()), e * rise - f / tau
        ]

    def turned(_: float, y: np.ndarray) -> float:
        return y[1] - FADED

    def stopped(_: float, y: np.ndarray) -> float:
        # a liquid whose force fades faster than it could throw back
        return 1.0 if soft > 0 else y[1] - 1e-7

    turned.terminal, turned.direction = True, -1
    stopped.terminal, stopped.direction = True, -1
    none = np.zeros(e.size)
    options = {"method": "LSODA", "rtol": rtol, "atol": rtol * 1e-3}
    slowest = 1e14
    up = solve_ivp(
        approach,
        (0, slowest),
        np.r_[0, 1, none],
        events=(turned, stopped),
        dense_output=True,
        **options,
    )
    if up.t_events[1].size:
        end, at_end = up.t_events[1][0], up.y_events[1][0]
        if end * (1e-7 - approach(end, at_end)[1]) > 1e-6:
            up = solve_ivp(
                approach,
                (0, slowest),
                np.r_[0, 1, none],
                events=turned,
                dense_output=True,
                **options,
            )
        else:
            return Struck(0.0, float(at_end[0] * unit), np.inf)
    if not up.success or not up.t_events[0].size:
        raise ArithmeticError("the approach did not end")
    top, at_top = up.t_events[0][0], up.y_events[0][0]
    deepest, force = at_top[0], -approach(0, at_top)[1]
    if force <= 1e-14:
        return Struck(0.0, float(deepest * unit), np.inf)
    # Near the top d' = -force (t - top): G_k of the parabola between top - w and top +
    # late.
    w = AHEAD * min(top, 1 / force)

    def parabola(late: float) -> np.ndarray:
        """int_{-w}^{late} e^{-(late - r)/tau} (-force r) dr for each branch."""
        z = (late + w) / tau
        gone = -np.expm1(-z)
        # int e^{-(late-r)/tau} r dr = tau [late + w e^{-z} - tau gone] and, for slow
        # branches, (late^2 - w^2)/2
        exact = tau * (late + w * np.exp(-z) - tau * gone)
        near = (
            0.5 * (late**2 - w**2) - (late**3 / 6 - 0.5 * late * w**2 - w**3 / 3) / tau
        )
        return -force * np.where(z > 1e-3, exact, near)

    def edge(late: float) -> float:
        return (
            -0.5 * soft * force * (late**2 - w**2)
            - eta * force * late
            + (e * parabola(late)).sum()
        )

    late = brentq(edge, 0.0, w, xtol=1e-16 * w, rtol=1e-14)
    touched = top - w
    motion = up.sol
    # F_k of the elements that were touched before top - w only fades from then on.
    inner = motion(touched)[2:]
    faded = inner * np.exp(-(w + late) / tau)
    start = np.r_[
        deepest - 0.5 * force * late**2,
        FADED - force * late,
        faded,
        e * parabola(late),
        touched,
    ]
    n = e.size

    def retreat(t: float, y: np.ndarray) -> np.ndarray:
        if next(calls) > 2 * CALLS:
            raise ArithmeticError("the judge takes too long")
        v, f, g, s = y[1], y[2 : 2 + n], y[2 + n : 2 + 2 * n], max(y[-1], 0.0)
        d_s, v_s = motion(s)[:2]
        d_s = max(d_s, 0.0)
        kept = e * np.exp(-(t - s) / tau)
        bend = -(soft * c * d_s**power + f.sum())
        s_rate = (soft * v + eta * bend + (e * v - g / tau).sum()) / (
            (soft + kept.sum()) * max(v_s, 1e-300)
        )
        gained = kept * c * power * d_s ** (power - 1) * v_s * s_rate
        return np.r_[
            v, bend, gained - f / tau, e * v - kept * v_s * s_rate - g / tau, s_rate
        ]

    def left(_: float, y: np.ndarray) -> float:
        return y[-1] - 1e-9 * top

    left.terminal, left.direction = True, -1
    down = solve_ivp(retreat, (top + late, slowest), start, events=left, **options)
    if not down.t_events[0].size:
        raise ArithmeticError("the retreat did not end")
    return Struck(
        float(-down.y_events[0][0][1]),
        float(deepest * unit),
        float(down.t_events[0][0] * clock),
    )
