"""The steady motion of rubber over a rough line, marched from one event to the next:
the judge of `rough_scenes.py`.

The line is straight between its samples, and on that line nothing is approximated: on a
slope s the branches follow

    f_k(t) = E_k tau_k s + (f_k(0) - E_k tau_k s) exp(-t/tau_k),

contact ends at the root of q = E_inf u + sum f_k, wherever it lies between two samples,
a free element recovers in its own modes, u = sum c_j exp(-y_j t) with f_k = E_k
y_j/(y_j - 1/tau_k) c_j exp(-y_j t), and contact begins where that meets the line. What
is left is the curvature of the line between samples, of second order. Nothing is taken
from the solver but a state to start the search for the periodic one with.
"""

from typing import NamedTuple

import numpy as np
from line_field import LineField
from scipy.optimize import brentq

import elastomdr as em

# periods, that slower branches are cut to, so that a period's change is not rounding
_SLOWEST = 1e7
# periods over tau from which nothing of a branch's start is left at the end
_FELT = 36.0
# of a step: where to look for a sign before a root
_GRID = np.concatenate([[0.0], np.geomspace(1e-9, 1.0, 31)])
# samples that free recovery is compared with the line at in one go: at first, and at
# most
_CHUNK, _CHUNKS = 32, 4096
_NUDGE = 1e-6  # of the load or the depth, for the differences of a Jacobian
_TURNS = 25  # at most, of the search for the periodic state
_CLOSE = 1e-9  # of the load: what a periodic state is found to


class Periodic(NamedTuple):
    """The periodic motion on a line of straight pieces."""

    mu: float
    depth: float
    surface: np.ndarray  # u at the samples, in the order of `LineField.surface`
    # what is left of the search: change over the period and error of the load, over the
    # load
    misfit: float
    start: float  # the same of the state that the search began with


class _Element:
    """One element of rubber, and the heights in the order in which it meets them, from
    the highest (0) on.
    """

    def __init__(self, law: em.Foundation, rise: np.ndarray, step: float):
        cut = np.minimum(np.asarray(law.times), _SLOWEST * step * rise.size)
        # those that are cut are one branch
        rising, which = np.unique(cut, return_inverse=True)
        self.relaxed, self.times = float(law.equilibrium), rising[::-1]
        self.moduli = np.bincount(which, np.asarray(law.moduli))[::-1]
        self.rise, self.step, self.period = (
            np.append(rise, rise[0]),
            step,
            step * rise.size,
        )
        self.slope = np.diff(self.rise) / step
        self.rates = self._rates()
        # f_k of u = 1
        self.modes = (
            self.moduli[:, None] * self.rates / (self.rates - 1 / self.times[:, None])
        )
        # by which the modes are orthogonal
        weighed = self.modes / (self.moduli * self.times)[:, None]
        self.parts = weighed.T / (weighed * self.modes).sum(axis=0)[:, None]

    def _rates(self) -> np.ndarray:
        """y_j of E_inf + sum E_k y/(y - 1/tau_k) = 0: one below each 1/tau_k, by
        bisection.
        """
        poles, found = 1 / self.times, []
        for low, high in zip(
            np.append(poles[0] * 1e-30, poles[:-1]), poles, strict=True
        ):
            while True:
                middle = np.sqrt(low * high) if high > 4 * low else 0.5 * (low + high)
                if middle in (low, high):
                    break
                if self.relaxed + (self.moduli * middle / (middle - poles)).sum() > 0:
                    low = middle
                else:
                    high = middle
            found.append(0.5 * (low + high))
        return np.array(found)

    def pressed(
        self, forces: np.ndarray, slope: float, time: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Forces of the branches after `time` in contact, and their impulses."""
        lost, settled = -np.expm1(-time / self.times), self.moduli * self.times * slope
        rest = forces - settled
        return forces - rest * lost, settled * time + rest * self.times * lost

    def march(
        self, forces: np.ndarray, depth: float
    ) -> tuple[np.ndarray, float, float, np.ndarray]:
        """One period from the highest point on: forces at its end, mean force, mean
        power, u at the samples.
        """
        line, count, step = self.rise + depth, self.rise.size - 1, self.step
        surface = line.copy()
        impulse = work = since = 0.0
        i = 0
        while i < count:  # in contact, from `since` after sample i on
            slope, time = float(self.slope[i]), step - since
            u = line[i] + slope * since
            new, part = self.pressed(forces, slope, time)
            lost = self.relaxed * line[i + 1] + new.sum() < 0
            if lost:
                time = self._end(forces, slope, u, time)
                new, part = self.pressed(forces, slope, time)
            push = self.relaxed * (u + slope * time / 2) * time + part.sum()
            impulse, work, forces = impulse + push, work + push * slope, new
            if lost:
                i, since, forces = self._recover(forces, line, i, since + time, surface)
            else:
                i, since = i + 1, 0.0
        return forces, impulse / self.period, work / self.period, surface[:-1]

    def _end(self, forces: np.ndarray, slope: float, u: float, time: float) -> float:
        """When q falls to zero for good, within `time`."""

        def q(t):
            return (
                self.relaxed * (u + slope * t) + self.pressed(forces, slope, t)[0].sum()
            )

        return _last_root(q, 0.0, time, 0.0)

    def _recover(
        self,
        forces: np.ndarray,
        line: np.ndarray,
        i: int,
        begun: float,
        surface: np.ndarray,
    ) -> tuple[int, float, np.ndarray]:
        """From `begun` after sample i on: the sample and the time after it at which a
        free element meets the line, and its forces then. Writes u at the samples on the
        way.
        """
        parts, step, count = self.parts @ forces, self.step, line.size - 1
        begun += i * step
        first, size = i + 1, _CHUNK
        while first <= count:
            last = min(count, first + size - 1)
            u = (
                np.exp(-np.outer(np.arange(first, last + 1) * step - begun, self.rates))
                @ parts
            )
            met = np.flatnonzero(u < line[first : last + 1])
            passed = int(met[0]) if met.size else u.size
            surface[first : first + passed] = u[:passed]
            first += passed
            if met.size:
                break
            size = min(4 * size, _CHUNKS)
        else:
            raise RuntimeError(
                "an element passed the highest point without touching it"
            )
        before = (first - 1) * step - begun  # until the sample before

        def gap(t):
            return np.exp(-self.rates * t) @ parts - (
                line[first - 1] + self.slope[first - 1] * (t - before)
            )

        met = _last_root(gap, max(before, 0.0), before + step, before + step)
        forces = self.modes @ (np.exp(-self.rates * met) * parts)
        since = met - before
        return (
            (first, 0.0, forces)
            if since >= step * (1 - 1e-13)
            else (first - 1, since, forces)
        )


def _last_root(function, start: float, end: float, otherwise: float) -> float:
    """Where a function that is negative at the end ceased to be positive, or
    `otherwise` if it never was positive.
    """
    places = start + (end - start) * _GRID
    positive = np.flatnonzero(np.array([function(t) for t in places]) > 0)
    if not positive.size or positive[-1] == places.size - 1:
        return otherwise
    return float(
        brentq(
            function, places[positive[-1]], places[positive[-1] + 1], xtol=1e-14 * end
        )
    )


def periodic(law: em.Foundation, line: LineField, velocity: float) -> Periodic:
    """The periodic motion at the load of `line`, on its heights; the search begins with
    its state.
    """
    top = int(np.argmax(line.height[::-1]))
    height, u = (np.roll(field[::-1], -top) for field in (line.height, line.surface))
    element = _Element(law, height - height[0], float(line.x[1]) / velocity)
    load, deep = float(line.load), float(height[0])
    forces = branch_forces(element.moduli, element.times, u, element.step)[:, 0]
    lost = -np.expm1(-element.period / element.times)
    felt = np.flatnonzero(element.period / element.times < _FELT)

    def left(x):
        """What a period leaves of periodicity and load, over the load, and the
        motion.
        """
        nonlocal forces  # what is forgotten within a period starts as it ended last
        forces[felt] = x[:-1] * load
        end, mean, power, surface = element.march(forces, x[-1] * deep)
        misfit = np.append(((end - forces) / lost)[felt], load - mean) / load
        forces = end.copy()
        return misfit, power / mean / velocity, surface

    x = np.append(forces[felt] / load, 1.0)
    misfit, mu, surface = left(x)
    start = np.abs(misfit).max()
    nudges = _NUDGE * np.append(np.maximum(1.0, np.abs(x[:-1])), 1.0)
    slopes = [(left(x + nudge)[0] - misfit) / nudge.sum() for nudge in np.diag(nudges)]
    inverse = np.linalg.pinv(np.transpose(slopes))
    for _ in range(_TURNS):
        if np.abs(misfit).max() < _CLOSE:
            break
        move = -inverse @ misfit
        move *= min(1.0, 0.3 / max(abs(move[-1]), 1e-300))
        x, before = x + move, misfit
        misfit, mu, surface = left(x)
        seen = inverse @ (misfit - before)
        if move @ seen != 0:  # Broyden
            inverse += np.outer(move - seen, move @ inverse) / (move @ seen)
    surface = np.roll(surface, top)[::-1]
    return Periodic(
        float(mu),
        float(x[-1] * deep),
        surface,
        float(np.abs(misfit).max()),
        float(start),
    )


def branch_forces(
    moduli: np.ndarray, times: np.ndarray, u: np.ndarray, step: float
) -> np.ndarray:
    """f_k at the samples of a periodic u that is straight between them, in the order of
    time.
    """
    turn = np.exp(2j * np.pi * np.fft.rfftfreq(u.size))
    change = np.fft.rfft(np.roll(u, -1) - u)
    found = []
    for modulus, tau in zip(moduli, times, strict=True):
        z = step / tau
        divisor = turn - np.exp(-z)
        # f_{i+1} = exp(-z) f_i + E (1 - exp(-z))/z du_i, and f is periodic
        divisor[0] = -np.expm1(-z)
        found.append(
            np.fft.irfft(modulus * -np.expm1(-z) / z * change / divisor, u.size)
        )
    return np.array(found)
