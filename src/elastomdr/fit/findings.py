"""What all results of a fit print in words, shift factors among it."""

import abc
from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

import numpy as np

from ..notebook_tables import html_table
from .laws import LawFit

PLUS_MINUS = "+- is half a 95 % interval: 1.96 standard deviations"
# a 95 % interval is the value plus and minus this many standard deviations
TWO_SIGMA = 1.96


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
