"""From points to isotherms: long measurements gathered, which points belong together, how
noisy they are, whether they were measured twice, whether storage and loss modulus are
exchanged.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..errors import InputError, advise
from ..io.data import SAME_STRAIN, Dma, in_strain_sweep, strains, untold
from ..material.shift import AbstractShift
from .laws import log10_a
from .spectrum import LOSS, RELAXATION, STORAGE, MeasuredPoints, closest_passive

# --------------------------------------------------------------------------------------
# Long measurements, such as ramps of temperature that are written every second,
# gathered before they are fitted.
#
# A fit takes as long as there are points, and neighbours of the same frequency,
# temperature and strain say the same. The mean of ln modulus over a cell differs from the
# modulus at the mean place by w^2/24 of its second derivative, w being the width of the
# cell: 3e-4 for 1 K where a glass transition is steepest.
# --------------------------------------------------------------------------------------

MOST = 1000  # points of a measurement that is fitted as it is
_KELVIN = 0.1  # width of the narrowest cells in temperature [K],
# and in ln(omega) or ln(t); both are doubled until there are no more than MOST cells
_RATE = 0.01
# a cell that is left for more than this part of the measurement belongs to another pass
# when it comes again
_PASS = 20

_TYPICAL = "WLF(8.86, 101.6, 20degC)"  # law


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
    temperature: np.ndarray,
    log_rate: np.ndarray,
    strain: np.ndarray,
    widths: tuple[float, float],
) -> np.ndarray:
    """The number of the cell of each point, in the order in which cells are met."""
    n = temperature.size
    if not n:
        return np.zeros(0, dtype=int)
    log_strain = np.log(np.where(strain > 0, strain, 1e-12)) / SAME_STRAIN
    place = (
        np.stack([temperature / widths[0], log_rate / widths[1], log_strain])
        .round()
        .astype(int)
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


# --------------------------------------------------------------------------------------
# Which points belong to one isotherm, and how noisy an isotherm is by itself.
# --------------------------------------------------------------------------------------

# temperatures with no gap above it are one isotherm [K]
TOLERANCE = 1.5
_HOTTEST = 1500.0  # above which no DMA is run [K]
_ALIKE = 1.3  # neighbours per independent point below which they count as independent
# widest range of temperatures that still counts as one isotherm, where they run without
# a gap [K]
_BIN = 4.0


class Isotherms(NamedTuple):
    """Points and the temperature of each isotherm, ascending."""

    points: MeasuredPoints
    temperature: np.ndarray  # mean temperature of each isotherm [K]
    deviation: np.ndarray  # of each point's temperature from that mean [K]


def isotherms(dma: Dma, law: AbstractShift | None = None) -> Isotherms:
    """Groups the points of `dma` into isotherms: temperatures with no gap above
    `TOLERANCE` are one.

    Temperatures that run through without gaps, as in a ramp, are cut into bins. With a
    shift `law` one frequency is enough. Raises `InputError` where a temperature is not
    known or there are too few points.
    """
    temperatures = dma.temperatures
    _check_points(dma)
    rates = np.concatenate([dma.omega, 1 / dma.time])
    if law is not None:
        a = 10 ** log10_a(law, temperatures)
        rates = rates * a / a.min()
    if rates.max() < 1.5 * rates.min():
        raise InputError(
            argument="dma",
            got=dma.source,
            accepted="measured over a range of frequencies (or times)",
            hint=f"it spans {rates.min():.4g} to {rates.max():.4g} rad/s only; a "
            "sweep of temperature at one frequency needs a shift law, as "
            + advise("shift=em.WLF(8.86, 101.6, 293.15)", {"shift": _TYPICAL})
            + ", a file of factors, or "
            + advise("universal", {"shift": "universal"}),
        )
    number, mean = group(temperatures)
    n = dma.omega.size
    rate, offset = np.log(dma.omega), temperatures - mean[number]
    extra = np.zeros(temperatures.size)
    if law is not None:
        extra = log10_a(law, temperatures) - log10_a(law, mean)[number]

    def per_channel(values: np.ndarray) -> np.ndarray:
        """Values of the points for storage, loss and relaxation."""
        return np.concatenate([values[:n], values])

    points = MeasuredPoints(
        np.repeat([STORAGE, LOSS, RELAXATION], [n, n, dma.time.size]),
        np.concatenate([rate, rate, -np.log(dma.time)]),
        np.log(np.concatenate([dma.storage, dma.loss, dma.relaxation])),
        per_channel(number),
        per_channel(extra),
    )
    return Isotherms(points, mean, per_channel(offset))


def _check_points(dma: Dma) -> None:
    """Raises `InputError` for temperatures that are not known or too high, for sweeps
    of strain, and for too few points.
    """
    temperatures = dma.temperatures
    if not dma.has_temperatures:
        rates = np.concatenate([dma.omega, 1 / dma.time])
        raise InputError(
            argument="temperature",
            accepted="given, where it is not in the data",
            hint=untold(rates[~np.isfinite(temperatures)]),
        )
    if temperatures.max() > _HOTTEST:
        raise InputError(
            argument="temperature",
            got=float(temperatures.max()),
            accepted=f"{_HOTTEST:g} K or less",
            hint="check its column and unit",
        )
    if dma.omega.size and in_strain_sweep(dma).all():
        raise InputError(
            argument="dma",
            got=strains(dma.strain),
            accepted="sweeps of frequency, not of strain",
            hint="they have no master curve; em.fit.softening(dma) makes their "
            "em.Softening",
        )
    if temperatures.size < 5:
        lost = len(dma.bad_rows)
        why = ""
        if lost:
            why = (
                f"{lost} rows of {dma.source} were left out, such as {dma.bad_rows[0]}"
            )
        raise InputError(
            argument="dma",
            got=temperatures.size,
            accepted="five points or more",
            hint=why,
        )


def group(
    temperature: np.ndarray, tolerance: float = TOLERANCE
) -> tuple[np.ndarray, np.ndarray]:
    """Number of the isotherm of each temperature, and the mean temperature of each
    isotherm, ascending [K].
    """
    order = np.argsort(temperature, kind="stable")
    ascending = temperature[order]
    starts = np.flatnonzero(np.diff(ascending, prepend=-np.inf) > tolerance)
    number, count = np.zeros(temperature.size, dtype=int), 0
    for start, stop in zip(starts, [*starts[1:], temperature.size], strict=True):
        span = ascending[stop - 1] - ascending[start]
        bins = max(1, int(np.ceil(span / max(_BIN, 2 * tolerance))))
        inside = np.minimum(
            (
                (ascending[start:stop] - ascending[start]) / max(span, 1e-9) * bins
            ).astype(int),
            bins - 1,
        )
        _, inside = np.unique(inside, return_inverse=True)
        number[order[start:stop]] = count + inside
        count += int(inside.max()) + 1
    # equal ones give their value
    mean = np.array([temperature[number == i].mean() for i in range(count)]).round(9)
    return number, mean


def curves(points: MeasuredPoints) -> list[np.ndarray]:
    """Indices of each isotherm's points of each channel, in order of frequency."""
    sorted_indices = []
    for i in np.unique(points.isotherm):
        for channel in np.unique(points.channel):
            indices = np.flatnonzero(
                (points.isotherm == i) & (points.channel == channel)
            )
            if indices.size:
                sorted_indices.append(
                    indices[np.argsort(points.log_rate[indices], kind="stable")]
                )
    return sorted_indices


def own_noise(points: MeasuredPoints) -> np.ndarray:
    """Standard deviation of ln(modulus) about a smooth curve through each isotherm
    alone, per channel; NaN if unknown.
    """
    squares, freedom = np.zeros(3), np.zeros(3)
    for indices in curves(points):
        degree = min(4, indices.size // 3)
        left = np.unique(points.log_rate[indices]).size - degree - 1
        if left < 2:
            continue
        u = points.log_rate[indices]
        u = (u - u.mean()) / max(float(np.ptp(u)), 1e-9)
        fit = np.polynomial.polynomial.polyval(
            u, np.polynomial.polynomial.polyfit(u, points.log_value[indices], degree)
        )
        size = np.abs(points.log_value[indices] - fit)
        size = np.minimum(size, 4 * np.median(size) + 1e-12)  # an outlier is not noise
        squares[points.channel[indices[0]]] += (size**2).sum()
        freedom[points.channel[indices[0]]] += indices.size - degree - 1
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.sqrt(squares / np.where(freedom > 0, freedom, np.nan))


def alike(points: MeasuredPoints, residuals: np.ndarray) -> float:
    """How many neighbours along an isotherm carry the information of one point, since
    their residuals are alike.

    (1 + rho)/(1 - rho) with rho the correlation of neighbours, 0 for noise, towards 1
    for a misfit of the model; 1 where they are hardly alike.
    """
    rho = min(0.9, max(0.0, _correlation(points, residuals)))
    count = (1 + rho) / (1 - rho)
    return count if count > _ALIKE else 1.0


def _correlation(points: MeasuredPoints, residuals: np.ndarray) -> float:
    pairs = [
        (
            residuals[indices][1:] @ residuals[indices][:-1],
            residuals[indices] @ residuals[indices],
        )
        for indices in curves(points)
    ]
    values = [
        both / max(one, 1e-300)
        for (both, one), indices in zip(pairs, curves(points), strict=True)
        if indices.size >= 5
    ]
    return float(np.mean(values)) if values else 0.0


# --------------------------------------------------------------------------------------
# Whether storage and loss modulus look exchanged: which of both a passive material can
# have.
#
# The storage modulus of a passive material rises with frequency, and by how much, its
# loss modulus says. How close the closest such material (`closest_passive`) comes to an
# isotherm as named, and how close with both exchanged, decides. Nothing tells a power law
# omega^(1/2) in both from itself exchanged.
# --------------------------------------------------------------------------------------

# rms relative misfit as named above which moduli are suspect, if exchanged they meet it
_MISFIT = 0.1
_CLOSER = 3.0  # and are so many times closer
# ratio of the highest to the lowest frequency of an isotherm that says anything
_LEAST_RANGE = 2.0
_LARGEST = 1e100  # modulus [Pa], and temperature [K]; what is beyond is damaged
_FEWEST = 5  # points that say anything
_MOST = 100  # points of an isotherm that are looked at


def refuse_exchanged(dma: Dma, law: AbstractShift | None = None) -> None:
    """Raises `InputError` where no passive material has the moduli as named, and one
    has them exchanged: the isotherms, or the master curve along a `law`.
    """
    exchanged = moduli_exchanged(dma.temperature, dma.omega, dma.storage, dma.loss)
    if law is not None and not exchanged and dma.omega.size:
        reduced = dma.omega * 10 ** log10_a(law, dma.temperature)
        exchanged = moduli_exchanged(
            np.zeros(reduced.size), reduced, dma.storage, dma.loss
        )
    if exchanged:
        ways = {"storage": dma.places.get("loss"), "loss": dma.places.get("storage")}
        hint = "storage and loss modulus look exchanged"
        if ways.keys() <= dma.places.keys():
            read = (f"{role} from column {dma.places[role]}" for role in ways)
            hint += f" ({', '.join(read)})"
            options = [f"{role}={place}" for role, place in ways.items()]
            hint += "; exchange them, " + advise(f"columns={ways}", {"column": options})
        raise InputError(
            argument="dma",
            got=dma.source,
            accepted="of a passive material",
            hint=hint,
        )


def moduli_exchanged(
    temperature: np.ndarray, omega: np.ndarray, storage: np.ndarray, loss: np.ndarray
) -> bool:
    """Whether isotherms suit no passive material as named, and one with storage and
    loss modulus exchanged.

    Arrays of one shape in SI units. The median isotherm decides.
    """
    if omega.size < _FEWEST:
        return False
    storage, loss = (np.minimum(x, _LARGEST) for x in (storage, loss))
    bounded = np.where(np.isfinite(temperature), np.minimum(temperature, 1e4), 0.0)
    number, mean = group(bounded, TOLERANCE)
    named, exchanged = [], []
    for i in range(mean.size):
        indices = np.flatnonzero(number == i)
        indices = indices[np.argsort(omega[indices], kind="stable")]
        indices = indices[
            np.linspace(0, indices.size - 1, min(indices.size, _MOST)).astype(int)
        ]
        if omega[indices[-1]] / _LEAST_RANGE > omega[indices[0]]:
            named.append(_misfit(omega[indices], storage[indices], loss[indices]))
            exchanged.append(_misfit(omega[indices], loss[indices], storage[indices]))
    if not named or not float(np.median(named)) > _MISFIT:
        return False
    other = float(np.median(exchanged))
    return other < _MISFIT and other * _CLOSER < float(np.median(named))


def _misfit(omega: np.ndarray, storage: np.ndarray, loss: np.ndarray) -> float:
    """Rms relative distance of the closest passive material; NaN where none is
    found.
    """
    is_storage = np.arange(2 * omega.size) < omega.size
    closest = closest_passive(
        np.tile(np.log(omega), 2), np.log(np.concatenate([storage, loss])), is_storage
    )
    return np.nan if closest is None else closest.misfit
