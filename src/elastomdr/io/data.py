"""Measured dynamic moduli and relaxation, in SI units, and what is known of where they
come from.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

import numpy as np

from ..checks import alike, as_float64, in_kelvin, in_si, one_of, positive, scalar
from ..errors import InputError, advise
from ..notebook_tables import html_table

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike, Kind, Response

KINDS = ("shear", "tensile")
COLDEST = 100.0  # temperature below which a number is one of degrees [K]
SAME_STRAIN = float(np.log(1.15))  # of ln(strain amplitude), within which two are one
_SAME_RATE = 0.01  # of ln(omega), likewise,
_SAME_PLACE = 2.0  # and of temperature [K]: a sweep of strain warms its sample
# different strains at one temperature and frequency that make a sweep of them
_SWEEP = 4
_OF_OMEGA = ("temperature", "omega", "storage", "loss", "strain")
_NONE = np.zeros(0)
# frequencies that are not met twice, relative to all, below which they are those of
# several sweeps
_NEW = 0.75


class FitWarning(UserWarning):
    """Issued where measured data were read or used in a way that their owner should
    know of.
    """


@dataclass(frozen=True, eq=False)
class Dma:
    """Dynamic mechanical analysis: storage and loss modulus against angular frequency,
    relaxation against time.

    Either part may be empty. `warnings` says what was assumed or left out when the data
    were read, `bad_rows` names each row left out, `units` what each column was in
    before it was converted to SI.
    """

    # T of each point; NaN where it is not known [K]
    temperature: Float[np.ndarray, " n"]
    omega: Float[np.ndarray, " n"]  # angular frequency omega [rad/s]
    storage: Float[np.ndarray, " n"]  # storage modulus [Pa]
    loss: Float[np.ndarray, " n"]  # loss modulus [Pa]
    kind: Kind  # what the moduli are
    # t after a strain step [s]
    time: Float[np.ndarray, " m"] = field(default_factory=lambda: _NONE)
    # relaxation modulus [Pa]
    relaxation: Float[np.ndarray, " m"] = field(default_factory=lambda: _NONE)
    # T of those points [K]
    time_temperature: Float[np.ndarray, " m"] = field(default_factory=lambda: _NONE)
    units: dict[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    bad_rows: tuple[str, ...] = ()
    # whether the frequencies are reduced ones: a master curve somebody else made
    shifted: bool = False
    source: str = ""
    copies: int = 0  # points that were left out because they repeat others
    columns: tuple[str, ...] = ()  # which columns of the file were taken as what
    places: dict[str, int] = field(default_factory=dict)  # their numbers, by role
    # "creep": `relaxation` is 1/J(t); "storage": G'(omega) alone, at t = 1/omega
    response: Response = "relaxation"
    # duration of the ramp of strain, from whose start `time` counts [s]; 0: a step
    ramp: float = 0.0
    # its amplitude [-]; NaN: not known
    strain: Float[np.ndarray, " n"] = field(default_factory=lambda: _NONE)

    def __post_init__(self) -> None:
        one_of("kind", self.kind, *KINDS)
        if np.size(self.strain) == 0:
            object.__setattr__(self, "strain", np.full(np.shape(self.omega), np.nan))
        for name in (*_OF_OMEGA, "relaxation", "time_temperature"):
            like = "omega" if name in _OF_OMEGA else "time"
            alike(0, {like: getattr(self, like), name: np.asarray(getattr(self, name))})
        for name in ("omega", "storage", "loss", "time", "relaxation"):
            if np.size(getattr(self, name)):
                _positive(name, getattr(self, name))

    @property
    def size(self) -> int:
        """Number of measured points, in frequency and in time."""
        return self.omega.size + self.time.size

    @property
    def temperatures(self) -> np.ndarray:
        """T of all points, those in frequency first [K]."""
        return np.concatenate([self.temperature, self.time_temperature])

    @property
    def has_temperatures(self) -> bool:
        """Whether the temperature of every point is known."""
        return bool(np.isfinite(self.temperatures).all())

    def __repr__(self) -> str:
        return f"Dma({self.summary()})"

    def summary(self) -> str:
        """How many points of what, over which frequencies, times and temperatures, in
        one line.
        """
        return f"{self.kind}, " + ", ".join(words for _, words in self._findings())

    def _repr_html_(self) -> str:
        rows = [("kind", self.kind), *self._findings()]
        rows += [("warning", sentence) for sentence in self.warnings]
        return html_table(f"Dma {self.source}".rstrip(), rows)

    def _findings(self) -> Iterator[tuple[str, str]]:
        """What was measured, a name and a few words each."""
        if self.omega.size:
            low, high = self.omega.min(), self.omega.max()
            yield (
                "over frequency",
                f"{self.omega.size} points of storage and loss modulus, {low:.3g} "
                f"to {high:.3g} rad/s",
            )
        if self.time.size:
            low, high, unit = self.time.min(), self.time.max(), "s"
            if self.response == "storage":
                low, high, unit = 1 / high, 1 / low, "rad/s"
            yield (
                "over time",
                f"{self.time.size} points of {self.described}, {low:.3g} to "
                f"{high:.3g} {unit}",
            )
        known = self.temperatures[np.isfinite(self.temperatures)] - 273.15
        yield (
            "temperature",
            f"{known.min():.1f} to {known.max():.1f} degC"
            if known.size
            else "temperature not known",
        )
        if words := strains(self.strain):
            yield "strain", f"strain amplitude {words}"

    @property
    def described(self) -> str:
        """What was measured over time, in words."""
        words = {"creep": "creep compliance", "storage": "storage modulus without loss"}
        words = words.get(self.response, "relaxation")
        return f"{words} after a ramp of {self.ramp:g} s" if self.ramp else words

    def where(self, points: Bool[np.ndarray, " n"]) -> "Dma":
        """The same measurement with some of its points in frequency only; those in time
        stay.
        """
        return replace(
            self, **{name: getattr(self, name)[points] for name in _OF_OMEGA}
        )

    def strain_sweeps(self) -> "Dma":
        """The points of its amplitude sweeps: only the strain varies there. Empty where
        there are none.
        """
        return replace(
            self.where(in_strain_sweep(self)),
            time=_NONE,
            relaxation=_NONE,
            time_temperature=_NONE,
        )

    def at_strain(self, strain: float) -> "Dma":
        """The frequency sweeps at one strain amplitude [-], within 15 % of it.

        Raises `InputError` where nothing was measured at it.
        """
        strain = float(scalar("strain", strain))
        positive("strain", strain)
        near = (
            np.abs(np.log(np.where(self.strain > 0, self.strain, np.nan) / strain))
            < SAME_STRAIN
        )
        if not near.any():
            measured = strains(self.strain) or "not known"
            raise InputError(
                argument="strain",
                got=strain,
                accepted=f"one of those measured ({measured})",
            )
        return self.where(near)

    @in_si
    def at(self, temperature: float) -> "Dma":
        """The same data, all of them taken at one temperature [K]."""
        return replace(
            self,
            temperature=np.full(self.omega.size, float(temperature)),
            time_temperature=np.full(self.time.size, float(temperature)),
        )


@in_si
def dma(
    omega: ArrayLike,
    storage: ArrayLike,
    loss: ArrayLike,
    temperature: ArrayLike,
    *,
    kind: Kind,
    source: str = "arrays",
) -> Dma:
    """Dynamic moduli from arrays in SI units: omega [rad/s], storage and loss [Pa],
    temperature [K], one per point.

    `temperature` may be one number for all points. `kind` is "shear" or "tensile".
    Raises `InputError` for arrays that do not match, and for values that are not
    positive and finite.
    """
    omega, g1, g2 = (
        _positive(n, v)
        for n, v in (("omega", omega), ("storage", storage), ("loss", loss))
    )
    alike(1, {"omega": omega, "storage": g1, "loss": g2})
    return Dma(_temperatures(temperature, omega), omega, g1, g2, kind, source=source)


@in_si
def relaxation(
    time: ArrayLike,
    modulus: ArrayLike,
    temperature: ArrayLike,
    *,
    kind: Kind,
    source: str = "arrays",
) -> Dma:
    """Relaxation moduli from arrays in SI units: time [s], modulus [Pa], temperature
    [K]; otherwise as `dma`.
    """
    t, g = _positive("time", time), _positive("modulus", modulus)
    alike(1, {"time": t, "modulus": g})
    temperatures = _temperatures(temperature, t)
    return Dma(
        _NONE,
        _NONE,
        _NONE,
        _NONE,
        kind,
        time=t,
        relaxation=g,
        time_temperature=temperatures,
        source=source,
    )


def join(*parts: Dma) -> Dma:
    """Several measurements of one material as one: runs, files, frequency and time
    domain together.

    Raises `InputError` where shear and tensile moduli meet, or raw data and a master
    curve.
    """
    if not parts or not all(isinstance(measurement, Dma) for measurement in parts):
        raise InputError(
            argument="parts", got=parts, accepted="Dma, as read_dma returns them"
        )
    if len({measurement.kind for measurement in parts}) > 1:
        raise InputError(
            argument="parts",
            got=[one.kind for one in parts],
            accepted="of one kind, shear or tensile",
            hint="convert one of them first",
        )
    if len({measurement.shifted for measurement in parts}) > 1:
        raise InputError(
            argument="parts",
            got=[one.shifted for one in parts],
            accepted="all raw or all shifted, no isotherms with a master curve",
        )

    timed = [measurement for measurement in parts if measurement.time.size] or [
        parts[0]
    ]
    if len({(measurement.response, measurement.ramp) for measurement in timed}) > 1:
        words = " and ".join(
            dict.fromkeys(measurement.described for measurement in timed)
        )
        raise InputError(
            argument="parts",
            got=words,
            accepted="of one response over time",
            hint="fit them one by one",
        )

    def chain(name: str) -> np.ndarray:
        return np.concatenate([getattr(measurement, name) for measurement in parts])

    several = len({measurement.source for measurement in parts}) > 1
    differ = several and len({measurement.columns for measurement in parts}) > 1
    arrays = (*_OF_OMEGA, "time", "relaxation", "time_temperature")
    return replace(
        parts[0],
        **{name: chain(name) for name in arrays},
        response=timed[0].response,
        ramp=timed[0].ramp,
        units={
            key: ", ".join(
                _each(
                    (measurement.units[key],)
                    for measurement in parts
                    if key in measurement.units
                )
            )
            for key in dict.fromkeys(
                key for measurement in parts for key in measurement.units
            )
        },
        warnings=_each(measurement.warnings for measurement in parts),
        bad_rows=_each(_placed(one, one.bad_rows, several) for one in parts),
        source=", ".join(_each((measurement.source,) for measurement in parts)),
        columns=_each(_placed(one, one.columns, differ) for one in parts),
    )


def _placed(measurement: Dma, lines: Sequence[str], several: bool) -> list[str]:
    """What is said of a file, with its name where there are several; of files that have
    been joined it is there already.
    """
    place = f"{measurement.source}: " * (several and "," not in measurement.source)
    return [place + line for line in lines]


def _each(lists: Iterable[Iterable[str]]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(line for texts in lists for line in texts))


def _positive(name: str, values: ArrayLike) -> np.ndarray:
    array = np.atleast_1d(as_float64(name, values))
    alike(1, {name: array})
    positive(name, array)
    return array


def _temperatures(value: ArrayLike, like: np.ndarray) -> np.ndarray:
    array = _positive("temperature", value)
    in_kelvin("temperature", array, COLDEST)
    if array.size == 1:
        return np.full(like.size, array[0])
    alike(1, {"omega": like, "temperature": array})
    return array


def without_copies(dma: Dma) -> Dma:
    """The same data, each point once: a point that agrees in all its numbers with
    another one is no measurement.
    """
    dynamic = np.stack(
        [*(getattr(dma, name) for name in _OF_OMEGA[:4]), np.nan_to_num(dma.strain)],
        axis=1,
    )
    timed = np.stack([dma.time_temperature, dma.time, dma.relaxation], axis=1)
    kept, of_time = (
        np.sort(np.unique(rows, axis=0, return_index=True)[1])
        for rows in (dynamic, timed)
    )
    copies = dma.size - kept.size - of_time.size
    if not copies:
        return dma
    parts = {name: getattr(dma, name)[kept] for name in _OF_OMEGA}
    parts |= {
        name: getattr(dma, name)[of_time]
        for name in ("time", "relaxation", "time_temperature")
    }
    return replace(dma, **parts, copies=dma.copies + copies)


def strains(strain: np.ndarray) -> str:
    """The strain amplitudes of a measurement in words, such as "0.1 %" or "0.1 to 5 %";
    "" where none is known.
    """
    known = 100 * strain[np.isfinite(strain)]
    if not known.size:
        return ""
    levels = [f"{x:.3g}" for x in (known.min(), known.max())]
    alike = known.max() < known.min() * np.exp(SAME_STRAIN)
    return f"{np.median(known):.3g} %" if alike else f"{levels[0]} to {levels[1]} %"


def in_strain_sweep(dma: Dma) -> np.ndarray:
    """Which points are those of a sweep of strain: several strains at their temperature
    and frequency, and at their temperature and strain no other frequency.
    """
    in_sweep = np.zeros(dma.omega.size, bool)
    known = np.flatnonzero(dma.strain > 0)
    temperature = np.nan_to_num(dma.temperature)
    rate = np.log(dma.omega)
    log_strain = np.log(np.where(dma.strain > 0, dma.strain, 1.0))
    for i in known:
        here = known[np.abs(temperature[known] - temperature[i]) < _SAME_PLACE]
        sweep = here[np.abs(rate[here] - rate[i]) < _SAME_RATE]
        if (
            sweep.size < _SWEEP
            or 1 + (np.diff(np.sort(log_strain[sweep])) > 1e-3).sum() < _SWEEP
        ):
            continue
        alone = (
            np.abs(
                rate[here[np.abs(log_strain[here] - log_strain[i]) < SAME_STRAIN]]
                - rate[i]
            )
            < _SAME_RATE
        )
        in_sweep[i] = np.ptp(log_strain[sweep]) > 2 * SAME_STRAIN and alone.all()
    return in_sweep


def of_one_strain(dma: Dma) -> tuple[Dma, tuple[str, ...]]:
    """What makes one sample of a measurement at several strains, and in words what was
    left out.

    Sweeps of strain are left out, and, where a temperature and frequency were measured
    at several strains, all but the smallest of them. Strains that follow the
    temperature, as those of a rheometer that holds its torque, stay.
    """
    swept = in_strain_sweep(dma)
    remarks: list[str] = []
    if swept.all():
        return dma, ()
    if swept.any():
        remarks.append(
            f"A sweep of strain, {int(swept.sum())} points from "
            f"{strains(dma.strain[swept])}, is left out: "
            "em.fit.softening reads it."
        )
    rest = dma.where(~swept) if remarks else dma
    levels = _levels(rest)
    if len(levels) > 1:
        others = [strains(rest.strain[of_strain]) for of_strain in levels[1:]]
        remarks.append(
            "Sweeps at several strain amplitudes are not one sample: that at "
            f"{strains(rest.strain[levels[0]])} is used, that at "
            f"{' and '.join(others)} left out; "
            + advise("dma.at_strain(...)", {"strain": ""})
            + " chooses another."
        )
        rest = rest.where(levels[0])
    return rest, tuple(remarks)


def _levels(dma: Dma) -> list[np.ndarray]:
    """The points of each strain amplitude, the smallest with a range of frequencies
    first; [] where no temperature and frequency were measured at two of them.
    """
    known = np.flatnonzero(dma.strain > 0)
    order = known[np.argsort(dma.strain[known], kind="stable")]
    steps = np.diff(np.log(dma.strain[order])) > SAME_STRAIN
    groups = np.split(order, np.flatnonzero(steps) + 1)
    temperature = np.round(np.nan_to_num(dma.temperature) / _SAME_PLACE)
    places = [
        set(
            zip(
                temperature[rows],
                np.round(np.log(dma.omega[rows]) / (2 * _SAME_RATE)),
                strict=True,
            )
        )
        for rows in groups
    ]
    if sum(len(one) for one in places) < len(set().union(*places)) + 2:
        return []
    # a stable sort: ascending strains
    groups.sort(key=lambda rows: not _is_sweep(dma.omega[rows]))
    return [np.isin(np.arange(dma.omega.size), rows) for rows in groups]


def _is_sweep(omega: np.ndarray) -> bool:
    return omega.size >= _SWEEP and bool(omega.max() > 1.5 * omega.min())


def describe_list(
    values: Sequence[float] | np.ndarray, unit: str, most: int = 12
) -> str:
    """Numbers in one line: "-10, 0 and 10 degC"."""
    texts = [f"{value:.4g}" for value in values]
    if len(texts) > most:
        texts = [*texts[: most - 1], f"... (of {len(values)})"]
    body = texts[0] if len(texts) == 1 else ", ".join(texts[:-1]) + f" and {texts[-1]}"
    return f"{body} {unit}"


def lists(names: Sequence[str], values: Sequence[ArrayLike | None]) -> list[np.ndarray]:
    """Values that go together as lists of one length, all positive, or empty where none
    is given.
    """
    missing = [name for name, value in zip(names, values, strict=True) if value is None]
    if len(missing) == len(names):
        return [np.zeros(0)] * len(names)
    if missing:
        raise InputError(
            argument=missing[0],
            got=None,
            accepted=f"given: {', '.join(names)} go together",
        )
    arrays = [
        np.atleast_1d(as_float64(name, value))
        for name, value in zip(names, values, strict=True)
    ]
    alike(0, dict(zip(names, arrays, strict=True)))
    for name, array in zip(names, arrays, strict=True):
        positive(name, array)
    return arrays


def untold(rates: np.ndarray) -> str:
    """What to do about points, of these frequencies or times, whose temperature is not
    known.
    """
    if np.unique(np.log(rates).round(3)).size < _NEW * rates.size:
        return (
            "frequencies (or times) repeat, as in several isotherms; give each its "
            "own temperature, in a column, or in a line 'T = -20 degC' above its "
            "block."
        )
    way = advise("temperature=293.15", {"temperature": "20degC"})
    return "give temperature, such as " + way + "."


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredFriction:
    """Points of measured friction in SI units, one entry per row of the table; None
    where there is no such column.
    """

    velocity: Float[np.ndarray, " n"]  # [m/s]
    mu: Float[np.ndarray, " n"]
    temperature: Float[np.ndarray, " n"] | None  # [K]
    pressure: Float[np.ndarray, " n"] | None  # [Pa]
    error: Float[np.ndarray, " n"] | None  # standard deviation of mu
    source: str  # name of the file
    columns: str  # which are read as what, in words
    report: tuple[str, ...]  # what was left out

    @property
    def points(self) -> dict[str, np.ndarray]:
        """The points as `curve.plot(measured=...)` takes them."""
        names = ("velocity", "mu", "temperature")
        columns = {name: getattr(self, name) for name in names}
        return {name: values for name, values in columns.items() if values is not None}

    def __repr__(self) -> str:
        units = {"velocity": "m/s", "temperature": "K", "pressure": "Pa", "mu": ""}
        parts = [
            f"{name} {x.min():.4g} to {x.max():.4g} {unit}".rstrip()
            for name, unit in units.items()
            if (x := getattr(self, name)) is not None
        ]
        return "\n".join(
            [
                (
                    f"MeasuredFriction({self.mu.size} points of {self.source!r}: "
                    f"{', '.join(parts)})"
                ),
                self.columns,
                *self.report,
            ]
        )
