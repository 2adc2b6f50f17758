"""What results of a fit share: how they print, and curves with 95 % intervals."""

from __future__ import annotations

import abc
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from ..checks import as_float64, positive
from ..errors import warn
from ..io.data import FitWarning
from ..notebook_tables import html_table
from .laws import LawFit
from .shifting import AtReference, Joint, curve
from .spectrum import LOSS, RELAXATION, STORAGE

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

# --------------------------------------------------------------------------------------
# What all results of a fit print in words, shift factors among it.
# --------------------------------------------------------------------------------------

PLUS_MINUS = "+- is half a 95 % interval: 1.96 standard deviations"
# a 95 % interval is the value plus and minus this many standard deviations
TWO_SIGMA = 1.96


def tell(doubts: Iterable[str]) -> None:
    """Issues each doubt of a result, which its summary prints, as a `FitWarning` too."""
    for text in doubts:
        warn(text, FitWarning)


class AbstractFindings(abc.ABC):
    """A result that prints as a few lines of names and texts."""

    intervals: ClassVar[str] = PLUS_MINUS  # what the stated intervals are

    @abc.abstractmethod
    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the result, as pairs of a name and a text."""

    def summary(self) -> str:
        """All findings in a few lines; intervals are 95 %, and the first line says
        so.
        """
        lines = [f"{name:<16}{text}" for name, text in self.findings()]
        return "\n".join([f"{'intervals':<16}{self.intervals}", *lines])

    def __repr__(self) -> str:
        return f"{type(self).__name__}\n{self.summary()}"

    def _repr_html_(self) -> str:
        return html_table(
            type(self).__name__, [("intervals", self.intervals), *self.findings()]
        )


def of_shifts(
    temperature: np.ndarray,
    log10_a: np.ndarray,
    std: np.ndarray,
    laws: Mapping[str, LawFit],
    more: Sequence[str] | None = None,
) -> Iterator[tuple[str, str]]:
    """A line per temperature, with `more` text behind it, and one per shift law."""
    more = [""] * temperature.size if more is None else more
    for kelvin, x, size, text in zip(temperature, log10_a, std, more, strict=True):
        yield (
            f"{kelvin - 273.15:8.2f} degC",
            f"log10 a_T {x:8.3f} +- {TWO_SIGMA * size:.3f}{text}",
        )
    for name, fit in laws.items():
        yield name, f"{fit.constants()}; rms residual {fit.rms:.3f} decades"


# --------------------------------------------------------------------------------------
# Curves with 95 % intervals: storage and loss modulus over frequency, relaxation over
# time.
# --------------------------------------------------------------------------------------


class Band(NamedTuple):
    """Storage and loss modulus at the reference temperature with their 95 % intervals;
    every array as `omega`.
    """

    omega: Float[np.ndarray, "..."]  # angular frequency [rad/s]
    storage: Float[np.ndarray, "..."]  # [Pa]
    storage_low: Float[np.ndarray, "..."]
    storage_high: Float[np.ndarray, "..."]
    loss: Float[np.ndarray, "..."]  # [Pa]
    loss_low: Float[np.ndarray, "..."]
    loss_high: Float[np.ndarray, "..."]
    # False where omega lies outside the measured (reduced) frequencies
    inside: Bool[np.ndarray, "..."]


class RelaxationBand(NamedTuple):
    """Relaxation modulus at the reference temperature with its 95 % interval; every
    array as `time`.
    """

    time: Float[np.ndarray, "..."]  # [s]
    relaxation: Float[np.ndarray, "..."]  # [Pa]
    relaxation_low: Float[np.ndarray, "..."]
    relaxation_high: Float[np.ndarray, "..."]
    # False where 1/t lies outside the measured (reduced) frequencies
    inside: Bool[np.ndarray, "..."]


def dynamic_band(
    joint: Joint,
    state: AtReference,
    window: tuple[float, float],
    omega: Any,
    series: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None,
) -> Band:
    """The smooth curve of a joint fit, or a `series` through it, whose interval grows
    by its distance to the curve.
    """
    omega = as_float64("omega", omega)
    positive("omega", omega)
    flat = np.atleast_1d(omega).ravel()
    own = None if series is None else np.concatenate(series(flat))
    values = _interval(
        joint,
        state,
        np.tile(np.log(flat), 2),
        np.repeat([STORAGE, LOSS], flat.size),
        own,
    )
    # storage, loss, then both limits of either
    parts = [half for value in values for half in np.split(value, 2)]
    inside = _check_outside(flat, window, "frequencies")
    ordered = (*parts[0::2], *parts[1::2], inside)
    return Band(omega, *(part.reshape(omega.shape) for part in ordered))


def relaxation_band(
    joint: Joint,
    state: AtReference,
    window: tuple[float, float],
    time: Any,
    series: Callable[[np.ndarray], np.ndarray] | None = None,
) -> RelaxationBand:
    """The same of the relaxation modulus."""
    time = as_float64("time", time)
    positive("time", time)
    flat = np.atleast_1d(time).ravel()
    own = None if series is None else series(flat)
    values = _interval(joint, state, -np.log(flat), np.full(flat.size, RELAXATION), own)
    inside = _check_outside(1 / flat, window, "times")
    return RelaxationBand(
        time, *(part.reshape(time.shape) for part in (*values, inside))
    )


def _interval(
    joint: Joint,
    state: AtReference,
    log_rate: np.ndarray,
    channel: np.ndarray,
    own: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    smooth, std = curve(joint, state, log_rate, channel)
    value = smooth if own is None else np.log(own)
    std = np.sqrt(std**2 + (value - smooth) ** 2)
    return (
        np.exp(value),
        np.exp(value - TWO_SIGMA * std),
        np.exp(value + TWO_SIGMA * std),
    )


def _check_outside(
    rate: np.ndarray, window: tuple[float, float], what: str
) -> np.ndarray:
    """Whether rates [rad/s] lie inside the measured window; those outside are counted
    in one `FitWarning`.
    """
    inside = (rate >= window[0] * (1 - 1e-9)) & (rate <= window[1] * (1 + 1e-9))
    if not inside.all():
        warn(
            f"{int((~inside).sum())} of {inside.size} {what} are extrapolated: they "
            f"lie outside the measured {window[0]:.3g} to {window[1]:.3g} rad/s.",
            FitWarning,
        )
    return inside
