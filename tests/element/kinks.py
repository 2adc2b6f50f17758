"""An element under a cosine that passes, from event to event: an answer that shares
nothing with the package.
"""

import numpy as np
from scipy.optimize import brentq


def under_a_cosine(stiff, moduli, times, eta, k, height, velocity, depth):
    """mu and mean force per length of a periodic line height cos(k x) whose crests are
    `depth` [m] deep.

    In contact the branches follow a cosine in closed form, from it they recover by the
    eigenvectors of their equations; both ends of contact are found by bracketing,
    period after period until nothing changes.
    """
    moduli, times = np.asarray(moduli, float), np.asarray(times, float)
    omega, period = k * velocity, 2 * np.pi / k / velocity
    steady = height * moduli * 1j * omega * times / (1 + 1j * omega * times)
    move = (
        np.append(0.0, 1 / times) / (stiff + moduli.sum())
        if eta == 0
        else -np.append(stiff, 0 * times + 1) / eta
    )
    rates = np.vstack([move, moduli[:, None] * move])
    rates[1:, 1:] -= np.diag(1 / times)
    lam, vector = np.linalg.eig(rates)

    def w(t):
        return depth - height + height * np.cos(omega * t)

    def part(t):
        return (steady[:, None] * np.exp(1j * omega * np.atleast_1d(t))).real

    def held(f, since, t):
        return part(t) + (f[:, None] - part(since)) * np.exp(
            -(np.atleast_1d(t) - since) / times[:, None]
        )

    def force(f, since, t):
        return (
            stiff * w(t)
            - eta * height * omega * np.sin(omega * t)
            + held(f, since, t).sum(axis=0)
        )

    def free(y, t):
        return (
            vector
            @ (
                np.exp(lam[:, None] * np.atleast_1d(t))
                * np.linalg.solve(vector, y)[:, None]
            )
        ).real

    # of q dw/dx and of q, on panels that narrow towards the start
    def integrals(f, since, until):
        edges = since + np.append(
            0, np.geomspace(min(*times, period, until - since) / 20, until - since, 80)
        )
        x, weight = np.polynomial.legendre.leggauss(12)
        t = (
            (edges[:-1] + edges[1:])[:, None] + np.diff(edges)[:, None] * x
        ).ravel() / 2
        weight = (np.diff(edges)[:, None] / 2 * weight).ravel()
        q = force(f, since, t)
        return np.array([weight @ (q * -height * k * np.sin(omega * t)), weight @ q])

    f = part(0.0)[:, 0]
    while True:
        t = np.linspace(0, period, 20_001)
        i = int(np.argmax(force(f, 0.0, t) < 0))
        end = brentq(
            lambda s, f=f: force(f, 0.0, s)[0], t[i - 1], t[i], xtol=1e-16 * period
        )
        y = np.append(w(end), held(f, 0.0, end))
        t = np.linspace(end, period, 20_001)
        i = 5 + int(np.argmax((free(y, t - end)[0] < w(t))[5:]))
        start = brentq(
            lambda s, y=y, end=end: free(y, s - end)[0, 0] - w(s),
            t[i - 1],
            t[i],
            xtol=1e-16 * period,
        )
        again = free(y, start - end)[1:, 0]
        work, load = integrals(f, 0.0, end) + integrals(again, start, period)
        before, f = f, held(again, start, period)[:, 0]
        if np.abs(f - before).sum() <= 1e-13 * np.abs(steady).sum():
            return work / load, load / period
