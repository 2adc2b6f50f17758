"""The rough line of the MDR from a spectrum: C_1D(q) = pi q C(q), random phases from a seed.

On a period L the waves are q_j = 2 pi j/L, and the wave j carries what the band of width 2 pi/L about it holds,

    A_j^2/2 = 2 int C_1D dq = 2 pi int_band q C dq,     h(x) = sum A_j cos(q_j x + phase_j),

so that the rms height is that of the surface whatever the period. Amplitudes are those of the spectrum, phases even
between 0 and 2 pi: every seed has the same rms values. Source: Popov & Hess 2015, ch. 10.
"""

import math

import numpy as np

from .rough_line import RoughLine
from .spectrum import AbstractSpectrum

PER_WAVE = 8  # samples of the shortest wave
PERIODS = 4  # longest waves in a period of the line


def line_count(spectrum: AbstractSpectrum, periods: int, per_wave: float) -> int:
    """Samples of a line, a power of two."""
    needed = periods * per_wave * spectrum.q_high / spectrum.q_low
    return max(64, 2 ** math.ceil(math.log2(needed) - 1e-9))


def synthesise(spectrum: AbstractSpectrum, seed: int, periods: int = PERIODS, samples: int | None = None) -> RoughLine:
    """One line of the ensemble, `periods` longest wavelengths long; the same numbers for the same seed."""
    n = line_count(spectrum, periods, PER_WAVE) if samples is None else samples
    length = 2 * np.pi * periods / spectrum.q_low
    step = 2 * np.pi / length
    wave = step * np.arange(1, n // 2)
    share = 2 * np.pi * spectrum.moment(1, wave - 0.5 * step, wave + 0.5 * step)
    phase = 2 * np.pi * np.random.default_rng(seed).random(wave.size)
    waves = np.zeros(n // 2 + 1, dtype=complex)
    waves[1 : n // 2] = 0.5 * n * np.sqrt(2 * share) * np.exp(1j * phase)
    return RoughLine(length / n * np.arange(n), np.fft.irfft(waves, n))
