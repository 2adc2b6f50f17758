"""Long measurements, such as ramps of temperature that are written every second,
gathered before they are fitted.

A fit takes as long as there are points, and neighbours of the same frequency,
temperature and strain say the same. The mean of ln modulus over a cell differs from the
modulus at the mean place by w^2/24 of its second derivative, w being the width of the
cell: 3e-4 for 1 K where a glass transition is steepest.
"""

from dataclasses import replace

import numpy as np

from ..io.data import SAME_STRAIN, Dma

MOST = 1000  # points of a measurement that is fitted as it is
_KELVIN = 0.1  # width of the narrowest cells in temperature [K],
# and in ln(omega) or ln(t); both are doubled until there are no more than MOST cells
_RATE = 0.01
# a cell that is left for more than this part of the measurement belongs to another pass
# when it comes again
_PASS = 20


def gathered(dma: Dma) -> tuple[Dma, tuple[str, ...]]:
    """A measurement of at most `MOST` points, and in words what was done to a longer
    one.

    Passes (heating and cooling, a second sweep) stay apart, so that what contradicts
    itself still does.
    """
    known = (
        np.isfinite(dma.temperature).all() and np.isfinite(dma.time_temperature).all()
    )
    if dma.size <= MOST or not known:
        return dma, ()
    widths = (_KELVIN, _RATE)
    while True:
        dynamic = _cells(dma.temperature, np.log(dma.omega), dma.strain, widths)
        timed = _cells(
            dma.time_temperature,
            np.log(dma.time),
            np.full(dma.time.size, np.nan),
            widths,
        )
        count = _number_of(dynamic) + _number_of(timed)
        if count <= MOST:
            break
        widths = (2 * widths[0], 2 * widths[1])
    of_omega = {
        "temperature": False,
        "omega": True,
        "storage": True,
        "loss": True,
        "strain": False,
    }
    of_time = {"time_temperature": False, "time": True, "relaxation": True}
    means = {
        name: _mean(getattr(dma, name), dynamic, log) for name, log in of_omega.items()
    }
    means |= {
        name: _mean(getattr(dma, name), timed, log) for name, log in of_time.items()
    }
    words = (
        f"{dma.size} points are fitted as {count} means of neighbours, within "
        f"{widths[0]:g} K and {100 * np.expm1(widths[1]):.2g} % of frequency or time: "
        "scatter and misfit are those of the means."
    )
    return replace(dma, **means), (words,)


def _cells(
    kelvin: np.ndarray,
    log_rate: np.ndarray,
    strain: np.ndarray,
    widths: tuple[float, float],
) -> np.ndarray:
    """The number of the cell of each point, in the order in which cells are met."""
    n = kelvin.size
    if not n:
        return np.zeros(0, dtype=int)
    level = np.log(np.where(strain > 0, strain, 1e-12)) / SAME_STRAIN
    place = (
        np.stack([kelvin / widths[0], log_rate / widths[1], level]).round().astype(int)
    )
    cell = np.unique(place, axis=1, return_inverse=True)[1].reshape(-1)
    order = np.argsort(cell, kind="stable")
    begins = np.diff(cell[order], prepend=-1) != 0
    begins |= np.diff(order, prepend=0) > max(n / _PASS, 1)
    number = np.empty(n, dtype=int)
    number[order] = np.cumsum(begins) - 1
    first = np.unique(number, return_index=True)[1]
    return np.argsort(np.argsort(first))[number]


def _number_of(cells: np.ndarray) -> int:
    return int(cells.max(initial=-1)) + 1


def _mean(values: np.ndarray, cells: np.ndarray, log: bool) -> np.ndarray:
    """The mean of each cell, of logarithms where `log`; of equal values their value."""
    if not values.size:
        return values
    first = values[np.unique(cells, return_index=True)[1]]
    # Differences of equal values are zero, which sums of them are only nearly: a ramp at
    # three frequencies has three afterwards too.
    apart = np.log(values / first[cells]) if log else values - first[cells]
    mean = np.bincount(cells, apart) / np.bincount(cells)
    return first * np.exp(mean) if log else first + mean
