"""Elements of a foundation under a given depth, event by event: the judge of
indentation in the stress test.

An element at x is touched where d(t) > g(x) - (-u). In contact u = d(t) - g(x) is
linear between two instants, and

    f_k(t) = f_k0 e^{-t/tau_k} + E_k d' tau_k (1 - e^{-t/tau_k}),
    q = E_inf u + eta d' + sum_k f_k;

it lets go where q = 0 and then recovers freely, u = sum_j c_j e^{-sigma_j t} sigma_j
the roots of E_inf - eta sigma
- sum_k E_k sigma/(1/tau_k - sigma) = 0, one between two rates each (bisection in 60
  digits), until the body meets it
again. Both instants are found by bisection, so that an element is exact to rounding.
The force is the rule of Clenshaw and Curtis over panels of x, halved wherever halving
changes it. Nothing is shared with elastomdr.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp
from slow_route import Law

# Nodes (almost) at the ends as well: a kink close to the end of a panel would be missed
# without them.
NODES = -np.cos(np.pi * np.arange(9) / 8) * (1 - 1e-10)
WEIGHTS = np.linalg.solve(
    np.polynomial.legendre.legvander(NODES, 8).T, np.r_[2.0, np.zeros(8)]
)
GRID = np.unique(
    np.r_[
        np.geomspace(1e-9, 1, 28),
        np.linspace(0, 1, 25)[1:],
        1 - np.geomspace(1e-5, 0.04, 6),
    ]
)
_EVENTS = 12  # contact gained or lost by one element between two instants
_HALVINGS = 34  # of the panels
_BLUR = 1e-13  # of the depths' scale: what counts as a gap


class Modes(NamedTuple):
    """Free recovery: rates sigma_j [1/s]; y_k = phi_kj u; phi, 1 - phi and what
    projects (u, y_k) on the modes.
    """

    rate: np.ndarray
    shape: np.ndarray  # (branches, modes)
    force: np.ndarray  # 1 - phi (branches, modes)
    onto: np.ndarray  # (branches + 1, modes): of u first


def recovery(law: Law) -> Modes:
    """Modes of free recovery, in 60 digits."""
    with mp.workdps(60):
        soft, eta = mp.mpf(law.equilibrium), mp.mpf(law.viscosity)
        order = np.argsort(-law.times)
        e = [mp.mpf(float(x)) for x in law.moduli[order]]
        tau = [mp.mpf(float(x)) for x in law.times[order]]
        rates = [1 / t for t in tau]

        def secular(s: Any) -> Any:
            return (
                soft
                - eta * s
                - mp.fsum(ek * s / (r - s) for ek, r in zip(e, rates, strict=True))
            )

        roots = []
        low_ends = [mp.mpf(0), *rates[:-1]]
        spans = list(zip(low_ends, rates, strict=True))
        if eta > 0:
            spans.append((rates[-1], (rates[-1] + (soft + mp.fsum(e)) / eta) * 2))
        for i, (low, high) in enumerate(spans):
            if i == 0 and soft == 0:
                roots.append(mp.mpf(0))
                continue
            for _ in range(170):
                narrow = high - low < mp.mpf(10) ** -28 * low
                middle = (
                    (low + high) / 2
                    if narrow or low == 0 or high < 4 * low
                    else mp.sqrt(low * high)
                )
                if low == 0:
                    middle = high / 1024
                if secular(middle) > 0:
                    low = middle
                else:
                    high = middle
            roots.append((low + high) / 2)
        phi = [[1 / (1 - s * t) for s in roots] for t in tau]
        rest = [[-s * t / (1 - s * t) for s in roots] for t in tau]
        onto = [[] for _ in range(len(tau) + 1)]
        for j in range(len(roots)):
            mass = [ek * t for ek, t in zip(e, tau, strict=True)]
            norm = eta + mp.fsum(m * p[j] ** 2 for m, p in zip(mass, phi, strict=True))
            onto[0].append(eta / norm)
            for k, m in enumerate(mass):
                onto[k + 1].append(m * phi[k][j] / norm)
        back = np.argsort(order)
        parts = (
            np.array([[float(x) for x in row] for row in rows])
            for rows in (phi, rest, onto[1:])
        )
        shape, force, project = (part[back] for part in parts)
        first = np.array([[float(x) for x in onto[0]]])
        return Modes(
            np.array([float(s) for s in roots]),
            shape,
            force,
            np.concatenate([first, project]),
        )


class Line(NamedTuple):
    """A body's line: g(x), the x of a depth, and weight per length (2, or 2 L under a
    cylinder).
    """

    profile: Callable[[Any], Any]
    reach: Callable[[Any], Any]
    weight: float


def densities(
    law: Law, modes: Modes, g: np.ndarray, time: np.ndarray, depth: np.ndarray
) -> np.ndarray:
    """q at every instant of elements where the body stands at heights g: (elements,
    instants).
    """
    n, scale = g.size, max(np.abs(depth).max(), 1e-300)
    contact = depth[0] > g
    u = np.where(contact, depth[0] - g, 0.0)
    f = law.moduli * u[:, None]
    c = np.zeros((n, modes.rate.size))
    out = [np.where(contact, law.equilibrium * u + f.sum(1), 0.0)]
    decay = law.times

    def pressed(
        f: np.ndarray, u: np.ndarray, slope: float, t: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        z = t[:, :, None] / decay
        branch = f[:, None] * np.exp(-z) - law.moduli * slope * decay * np.expm1(-z)
        q = (
            law.equilibrium * (u[:, None] + slope * t)
            + law.viscosity * slope
            + branch.sum(2)
        )
        return q, branch

    for t0, t1, d0, d1 in zip(time[:-1], time[1:], depth[:-1], depth[1:], strict=True):
        h, slope = t1 - t0, (d1 - d0) / (t1 - t0)
        done = np.zeros(n)
        free_at = np.zeros(n)  # when the modes' clock of an element stood at zero
        at_once = (
            contact
            & (law.equilibrium * u + law.viscosity * slope + f.sum(1) < 0)
            & (law.viscosity > 0)
        )
        y = u[:, None] - f / law.moduli
        c[at_once] = np.c_[u, y][at_once] @ modes.onto
        contact = contact & ~at_once
        open_ = np.ones(n, bool)
        for _ in range(_EVENTS):
            i = np.flatnonzero(open_ & contact)
            if i.size:
                left = h - done[i]
                t = left[:, None] * GRID
                q = pressed(f[i], u[i], slope, t)[0]
                lost = (
                    q
                    < -1e-14
                    * np.abs(law.equilibrium * u[i] + np.abs(f[i]).sum(1))[:, None]
                )
                which = lost.any(1)
                hold = i[~which]
                _, branch = pressed(f[hold], u[hold], slope, left[~which][:, None])
                f[hold], u[hold], open_[hold] = branch[:, 0], d1 - g[hold], False
                j, first = i[which], lost[which].argmax(1)
                tw = t[which]
                low = np.where(
                    first > 0, tw[np.arange(j.size), np.maximum(first - 1, 0)], 0.0
                )
                high = tw[np.arange(j.size), first]
                for _ in range(60):
                    middle = 0.5 * (low + high)
                    bad = pressed(f[j], u[j], slope, middle[:, None])[0][:, 0] < 0
                    low, high = np.where(bad, low, middle), np.where(bad, middle, high)
                f[j] = pressed(f[j], u[j], slope, high[:, None])[1][:, 0]
                u[j] = u[j] + slope * high
                c[j] = np.c_[u[j], u[j][:, None] - f[j] / law.moduli] @ modes.onto
                done[j] += high
                free_at[j], contact[j] = done[j], False
            i = np.flatnonzero(open_ & ~contact)
            if not i.size:
                if not open_.any():
                    break
                continue
            t = done[i][:, None] + (h - done[i])[:, None] * GRID

            def gap(
                i: np.ndarray,
                t: np.ndarray,
                since: np.ndarray = free_at,
                at: tuple = (d0, slope),
            ) -> np.ndarray:
                fading = np.exp(-modes.rate * (t - since[i][:, None])[:, :, None])
                return (c[i][:, None] * fading).sum(2) - (
                    at[0] + at[1] * t - g[i][:, None]
                )

            met = gap(i, t) < -_BLUR * scale
            which = met.any(1)
            hold = i[~which]
            c[hold] *= np.exp(-modes.rate * (h - free_at[hold])[:, None])
            open_[hold] = False
            j, first = i[which], met[which].argmax(1)
            tw = t[which]
            low = np.where(
                first > 0, tw[np.arange(j.size), np.maximum(first - 1, 0)], done[j]
            )
            high = tw[np.arange(j.size), first]
            for _ in range(60):
                middle = 0.5 * (low + high)
                bad = gap(j, middle[:, None])[:, 0] < 0
                low, high = np.where(bad, low, middle), np.where(bad, middle, high)
            c[j] *= np.exp(-modes.rate * (high - free_at[j])[:, None])
            f[j] = law.moduli * (c[j] @ modes.force.T)
            u[j] = d0 + slope * high - g[j]
            done[j], contact[j] = high, True
        if open_.any():
            raise ArithmeticError("an element gains and loses contact too often")
        held = law.equilibrium * u + law.viscosity * slope + f.sum(1)
        out.append(np.where(contact, held, 0.0))
        free = ~contact
        u[free] = c[free].sum(1)
    return np.stack(out, axis=1)


def force(
    law: Law, modes: Modes, line: Line, time: np.ndarray, depth: np.ndarray
) -> tuple[np.ndarray, float]:
    """Force [N] at every instant, and how far the last halvings moved it, relative to
    the largest.
    """
    if depth.max() <= 0:
        return np.zeros(time.size), 0.0
    edges = np.unique(np.r_[0.0, line.reach(depth[depth > 0])])
    total, moved = integral(
        lambda x: densities(law, modes, line.profile(x), time, depth), edges
    )
    return line.weight * total, moved


def integral(
    values: Callable[[np.ndarray], np.ndarray], ends: np.ndarray, rtol: float = 1e-12
) -> tuple[Any, float]:
    """int values dx over [ends[0], ends[-1]], values (places, ...), and what the last
    halvings moved, relative.
    """

    def panels(low: np.ndarray, high: np.ndarray) -> np.ndarray:
        half = 0.5 * (high - low)
        x = (low + half)[:, None] + half[:, None] * NODES
        return half[:, None] * np.einsum(
            "pnt,n->pt", values(x.ravel()).reshape(*x.shape, -1), WEIGHTS
        )

    low, high = ends[:-1], ends[1:]
    whole, total, moved = panels(low, high), 0.0, 0.0
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        parts = panels(np.r_[low, middle], np.r_[middle, high])
        left, right = parts[: low.size], parts[low.size :]
        change = np.abs(left + right - whole).max(1)
        largest = max(np.abs(total + (left + right).sum(0)).max(), 1e-300)
        again = change > rtol * largest
        total = total + (left + right)[~again].sum(0)
        moved = float(change[again].sum() / largest)
        if not again.any():
            return total, rtol
        low, high = np.r_[low[again], middle[again]], np.r_[middle[again], high[again]]
        whole = np.r_[left[again], right[again]]
    return total + whole.sum(0), moved
