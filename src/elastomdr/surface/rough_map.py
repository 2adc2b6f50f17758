"""A map of the heights of a surface from its spectrum; random phases from a seed.

On a map of side L each wave (i, j) carries C(q) (2 pi/L)^2, q = 2 pi |(i, j)|/L, and
the heights are then scaled to the rms slope of the surface, from which the sum over the
waves of a square differs a little.
"""

import math
from typing import TYPE_CHECKING

import numpy as np

from ..checks import in_si
from ..errors import InputError
from ..models import whole_number
from .spectrum import AbstractSpectrum, as_spectrum

if TYPE_CHECKING:
    from jaxtyping import Float

_MOST = 2**26  # longest waves along a side


@in_si
def rough_map(
    spectrum: AbstractSpectrum, seed: int = 0, *, periods: int = 2, points: int = 256
) -> "tuple[Float[np.ndarray, 'points points'], float]":
    """Heights [m] of a square cell of the surface, `periods` longest wavelengths wide,
    and its side [m].

    For `em.reference.half_space_sliding`. Raises `InputError` where `points` do not
    give the shortest wave four.
    """
    spectrum = as_spectrum("spectrum", spectrum)
    whole_number("periods", periods, 1, _MOST)
    whole_number("points", points, 8, 8192)
    whole_number("seed", seed, 0, _MOST)
    side = float(2 * np.pi * periods / spectrum.q_low)
    least = 4 * periods * spectrum.q_high / spectrum.q_low
    if points % 4 or points < least * (1 - 1e-9):
        raise InputError(
            f"points must be a multiple of 4, at least {math.ceil(least)} for "
            f"four on the shortest wave, got {points}."
        )
    along = np.fft.fftfreq(points, 1 / points)
    q = 2 * np.pi / side * np.hypot(along[:, None], along[None, : points // 2 + 1])
    power = spectrum.at(np.where(q > 0, q, np.inf)) * (2 * np.pi / side) ** 2
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((points, points)))
    waves = np.sqrt(power) * white / np.maximum(np.abs(white), 1e-300)
    height = np.fft.irfft2(waves, s=(points, points))
    along = np.where(2 * np.abs(along) == points, 0.0, along)
    slopes = [
        np.fft.irfft2(2j * np.pi / side * k * waves, s=height.shape)
        for k in (along[:, None], along[None, : points // 2 + 1])
    ]
    return height * (
        spectrum.rms_slope / np.sqrt(sum(np.mean(slope**2) for slope in slopes))
    ), side
