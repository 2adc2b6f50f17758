"""Which frequencies the friction of a rough line comes from.

In steady sliding the motion u and the force q of an element are periodic in the
distance x = v t, and its law holds for each of their waves, q_k = E*(k v) u_k, in
contact or not. So the friction force per length is a sum over waves

    F_x = <q du/dx> = sum_{k>0} 2 k |u_k|^2 E''(k v),      k = 2 pi j/L,

each of which is what rubber that is strained at the frequency k v dissipates per
distance. The contact step takes u to be straight between samples, h apart, and is exact
for that motion, whose waves are those of the samples times sinc^2(k h/2), beyond the
Nyquist frequency too. The sum over all of them is the work of the step, but for what
the waves that are left out hold (|u_k|^2 falls as k^-4), and for the bends where
contact begins within a step. Derived here.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import jax
import numpy as np

from ..material.relaxation import Relaxation
from .branch_reduction import lanes as carried
from .period import coefficients
from .periodic import rises, solve_states
from .periodic_field import motion

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

_AT_ONCE = 64  # lanes, whose motions are held in memory
# multiples of the sampling wave number up to which waves of the straight pieces are
# summed
_TURNS = 6


class Excitation(NamedTuple):
    """Friction by wave number for each lane; NaN where it did not converge."""

    mu: Float[np.ndarray, "lanes bins"]
    total: Float[np.ndarray, " lanes"]  # mu from the work of the contact step
    error: Float[np.ndarray, " lanes"]  # of the total, from the sampling
    good: Bool[np.ndarray, " lanes"]


def excitation(
    height: Float[np.ndarray, " n"],
    spacing: float,
    law: Relaxation,
    velocity: Float[np.ndarray, " lanes"],
    value: Float[np.ndarray, " lanes"],
    control: str,
    rtol: float,
    edges: Float[np.ndarray, " edges"],
    stretch: Float[np.ndarray, " lanes"],
) -> Excitation:
    """mu of each lane by bins of `stretch` times the wave number, what lies outside the
    edges in the bins at the ends.

    `velocity` is times a_T, and all of the branches are carried.
    """
    parts = []
    for start in range(0, velocity.size, _AT_ONCE):
        part = slice(start, start + _AT_ONCE)
        parts.append(
            _some(
                height,
                spacing,
                law,
                velocity[part],
                value[part],
                control,
                rtol,
                edges,
                stretch[part],
            )
        )
    return Excitation(*(np.concatenate(fields) for fields in zip(*parts, strict=True)))


def _some(
    height, spacing, law, velocity, value, control, rtol, edges, stretch
) -> Excitation:
    line, state = solve_states(height, spacing, law, velocity, value, control, rtol)
    with jax.enable_x64(True):
        by = coefficients(carried(law, velocity.size), spacing / velocity)
        depth, branches = (
            np.where(line.converged, x, 0.0) for x in (state.depth, state.branches)
        )
        u = np.asarray(motion(rises(height), depth, branches, by).surface)
    n = u.shape[0]
    square = np.abs(np.fft.fft(u, axis=0) / n) ** 2
    found = np.zeros((velocity.size, edges.size - 1))
    for turn in range(_TURNS):
        j = np.arange(n) + turn * n
        k = 2 * np.pi * j / (n * spacing)
        power = (
            2
            * k[:, None]
            * square
            * (np.sinc(j / n) ** 4)[:, None]
            * _loss(law, k[:, None] * velocity)
        )
        for lane in range(velocity.size):
            place = np.searchsorted(edges, stretch[lane] * k, side="right") - 1
            found[lane] += np.bincount(
                np.clip(place, 0, edges.size - 2), power[:, lane], edges.size - 1
            )
    good = line.converged
    mu = np.where(
        good[:, None], found / np.where(good, line.load, 1.0)[:, None], np.nan
    )
    return Excitation(mu, line.mu, line.error, good)


def _loss(law: Relaxation, omega: np.ndarray) -> np.ndarray:
    """E''(omega), a branch at a time: there are as many frequencies as samples and
    lanes.
    """
    loss = float(law.viscosity) * omega
    for modulus, time in zip(
        np.asarray(law.moduli), np.asarray(law.times), strict=True
    ):
        x = omega * time
        loss += modulus * x / (1 + x**2)
    return loss
