"""The rough line of the MDR from a spectrum, C_1D(q) = pi q C(q), and a map of the
surface; random phases from a seed.

On a period L the waves are q_j = 2 pi j/L, and the wave j carries what the band of
width 2 pi/L about it holds,

    A_j^2/2 = 2 int C_1D dq = 2 pi int_band q C dq,     h(x) = sum A_j cos(q_j x + phase_j),

so that the rms height is that of the surface whatever the period. Amplitudes are those
of the spectrum, phases even between 0 and 2 pi: every seed has the same rms values.
Source: Popov & Hess 2015, ch. 10.
"""

import math
from typing import TYPE_CHECKING, Any

import jax.numpy as jnp
import numpy as np

from ..checks import is_traced
from ..errors import InputError
from ..models import whole_number
from .rough_line import RoughLine, line_of_heights

if TYPE_CHECKING:
    from .spectrum import AbstractSpectrum

PER_WAVE = 8  # samples of the shortest wave
PERIODS = 4  # longest waves in a period of the line
MOST = 2**26  # samples of a line: half a gigabyte of heights


def line_count(spectrum: "AbstractSpectrum", periods: int, per_wave: float) -> int:
    """Samples of a line, a power of two. Raises `InputError` beyond `MOST`."""
    needed = periods * per_wave * spectrum.q_high / spectrum.q_low
    if not needed <= MOST:
        raise InputError(
            f"the surface, from q = {spectrum.q_low:.3g} to {spectrum.q_high:.3g} "
            f"rad/m, needs {needed:.3g} samples on a line of {periods} of its longest "
            f"waves, and at most {MOST} are drawn: give a shorter longest wave or "
            "a longer shortest one."
        )
    return max(64, 2 ** math.ceil(math.log2(needed) - 1e-9))


def synthesise(
    spectrum: "AbstractSpectrum",
    seed: int,
    periods: int = PERIODS,
    samples: int | None = None,
) -> RoughLine:
    """One line of the ensemble, `periods` longest wavelengths long; the same numbers
    for the same seed.
    """
    whole_number("periods", periods, 1, MOST)
    if samples is not None:
        whole_number("samples", samples, 64, MOST)
    if samples is None and is_traced(spectrum.q):
        raise InputError(
            "samples must be given where JAX traces the cutoffs of a surface: how "
            "many a line needs depends on them."
        )
    n = line_count(spectrum, periods, PER_WAVE) if samples is None else samples
    length = 2 * np.pi * periods / spectrum.q_low
    numpy: Any = jnp if is_traced(spectrum) else np
    step = 2 * np.pi / length
    wave = step * np.arange(1, n // 2)
    share = 2 * np.pi * spectrum.moment(1, wave - 0.5 * step, wave + 0.5 * step)
    phase = 2 * np.pi * np.random.default_rng(seed).random(n // 2 - 1)
    # beyond the cutoffs there is nothing, and the root has no derivative
    some = share > 0
    amplitude = numpy.where(some, numpy.sqrt(2 * numpy.where(some, share, 1.0)), 0.0)
    waves = numpy.pad(
        0.5 * n * amplitude * np.exp(1j * phase), (1, n // 2 - wave.shape[0])
    )
    return line_of_heights(numpy.fft.irfft(waves, n), length / n)
