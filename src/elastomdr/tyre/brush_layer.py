"""The brush on a layer under a cylinder: the exact pressure, and elements with the
shear stiffness of the layer.

A tangential load on a bonded layer displaces its surface, wave by wave, by u(k) = (2/k)
W_t(kh) tau(k)/E*,

    W_t = (2 kap sinh 2z + 4z)/(2 kap cosh 2z + 1 + kap^2 + 4z^2),      kap = 3 - 4 nu, z = kh,

the normal kernel with the other sign (same source), which is G/h for long waves.
Elements that know nothing of each other have one stiffness, taken at k = pi/(2L), L the
half-length of the contact: G/h of a thin layer, exact where the contact is wide, and on
a half-space pi E*/(4L), with which the traction at small creepage is that of Carter.

An element sticks from the leading edge on until its traction, that of a ramp
(`tyre.brush`), reaches mu p. Whether it sticks again is found by a march, whose force
counts there.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ..material.relaxation import Relaxation
from ..numerics.decay import ramp_weights

_STEPS = 1024
_HALVINGS = 50


class Pulled(NamedTuple):
    force: np.ndarray  # [N/m]
    stick: np.ndarray  # part of the contact's length
    error: np.ndarray  # [N/m]


def shear_compliance(k: np.ndarray, thickness: float, poisson: float) -> np.ndarray:
    """u/tau of a bonded layer at the waves k, times G [m]."""
    z = k * thickness
    kappa, e = 3 - 4 * poisson, np.exp(-2 * z)
    above = kappa * (1 - e**2) + 4 * z * e
    below = kappa * (1 + e**2) + (1 + kappa**2 + 4 * z**2) * e
    return (1 - poisson) / k * above / below


def pull(
    law: Relaxation,
    stiffness: np.ndarray,
    velocity: np.ndarray,
    half: np.ndarray,
    terms: np.ndarray,
    friction: np.ndarray,
    creepage: np.ndarray,
) -> Pulled:
    """Traction of points: `law` is G(t) [Pa], `stiffness` per G [1/m], `terms` of the
    pressure; numbers only.
    """
    order = np.arange(1, terms.shape[1] + 1)
    length, steep = 2 * half, creepage * stiffness

    def pressure(r: np.ndarray) -> np.ndarray:
        angle = np.arccos(np.clip(1 - r / half, -1, 1))
        return np.maximum(np.sum(terms * np.sin(angle[:, None] * order), axis=1), 0.0)

    def carried(r: np.ndarray) -> np.ndarray:
        """int p from the leading edge to r."""
        angle = np.arccos(np.clip(1 - r / half, -1, 1))[:, None]
        less = np.where(
            order == 1, angle, np.sin((order - 1) * angle) / np.maximum(order - 1, 1)
        )
        return half * np.sum(
            terms * 0.5 * (less - np.sin((order + 1) * angle) / (order + 1)), axis=1
        )

    def ramp(r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        _, early, late = ramp_weights(r / (velocity * law.times[:, None]))
        traction = law.equilibrium * r + law.moduli @ (early + late) * r
        return steep * traction, steep * (
            0.5 * law.equilibrium * r**2 + law.moduli @ late * r**2
        )

    def limit(r: np.ndarray) -> np.ndarray:
        p = pressure(r)
        return np.where(p > 0, friction * np.where(p > 0, p, 1.0), 0.0)

    def march(steps: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        s = np.arange(steps + 1) / steps
        place = s**2 * (3 - 2 * s)
        held, shear = np.zeros((law.moduli.size, half.size)), np.zeros_like(half)
        tau, total, stuck = (
            np.zeros_like(half),
            np.zeros_like(half),
            np.zeros_like(half),
        )
        first, slipped, again = (
            np.full(half.size, steps),
            np.zeros(half.size, bool),
            np.zeros(half.size, bool),
        )
        for i in range(steps):
            h = length * (place[i + 1] - place[i])
            kept, early, late = ramp_weights(h / (velocity * law.times[:, None]))
            gain = law.moduli[:, None] * (early + late)
            free = stiffness * (law.equilibrium * shear + np.sum(kept * held, axis=0))
            stiff = stiffness * (law.equilibrium + np.sum(gain, axis=0))
            most, full = limit(length * place[i + 1]), creepage * h
            slips = free + stiff * full > most
            moved = np.where(slips, (most - free) / stiff, full)
            new = np.where(slips, most, free + stiff * full)
            again |= slipped & ~slips & (new < most * (1 - 1e-9)) & (i < steps - 1)
            first = np.where(slips & ~slipped, i, first)
            stuck += np.where(slips, 0.0, place[i + 1] - place[i])
            held, shear = kept * held + gain * moved, shear + moved
            total, tau, slipped = total + 0.5 * h * (tau + new), new, slipped | slips
        ends = np.append(place, 1.0)
        low, high = ends[np.maximum(first - 1, 0)], ends[np.minimum(first + 2, steps)]
        return total, stuck, np.stack([low, high]) * length, again

    total, stuck, (low, high), again = march(_STEPS)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        sticks = ramp(middle)[0] < limit(middle)
        low, high = np.where(sticks, middle, low), np.where(sticks, high, middle)
    end = np.where(
        np.isinf(friction) | (creepage == 0),
        length,
        np.where(friction == 0, 0.0, 0.5 * (low + high)),
    )
    slid = np.maximum(carried(length) - carried(end), 0.0)
    slid = np.where(
        end < length, np.where(np.isinf(friction), 0.0, friction) * slid, 0.0
    )
    smooth = ramp(end)[1] + slid
    if again.any():
        coarse = march(_STEPS // 2)[0]
        error = np.where(again, np.abs(total - coarse), 1e-9 * smooth)
    else:
        error = 1e-9 * smooth
    return Pulled(
        np.where(again, total, smooth), np.where(again, stuck, end / length), error
    )


def typical_wave(half: np.ndarray) -> np.ndarray:
    """k at which elements of a brush are as stiff as the layer [1/m]."""
    return math.pi / (2 * half)
