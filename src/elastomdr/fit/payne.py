"""`em.fit.softening`: the factors on storage and loss modulus by strain amplitude, from
strain sweeps.

Kraus' form of the Payne effect, shared by all sweeps, each about its own moduli of
small strain:

    G'/G'_0 = 1 - r x^2m/(1 + x^2m),    G''/G''_0 = 1 + 2 h x^m/(1 + x^2m),    x = strain/strain_c.

Source: G. Kraus, J. Appl. Polym. Sci.: Appl. Polym. Symp. 39 (1984) 75.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, isotonic_regression, least_squares
from scipy.special import stdtrit

from ..checks import as_float64, in_si, one_of, positive
from ..errors import InputError
from ..io.data import Dma, lists
from ..material.softening import Softening
from ..results.axes import Label
from ..results.base import WithTable
from ..trees import fill, static
from .isotherms import group
from .report import AbstractWithTable, tell

if TYPE_CHECKING:
    from jaxtyping import Float, Int
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style

# r, strain_c, m, h, by their units
NAMES = {"drop": "-", "strain": "-", "exponent": "-", "rise": "-"}
_WARMS = 2.0  # of one sweep [K]
_ALIKE = 0.05  # of the logarithm of one frequency
_LARGEST = 5.0  # strain from which a number is taken for per cent
_LOW = np.array([1e-3, np.log(1e-6), 0.1, 0.0])
_HIGH = np.array([1.0, np.log(10.0), 2.0, 8.0])
_ROUNDS = 4  # of the size of errors
_NODES = 41  # of the table that stands for Kraus' form, down to _FIRST of its strain
_FIRST = 1e-4
_PER_DECADE = 4  # points of a table of measured factors
# what is doubted: slope of ln storage over ln strain at the largest strain, falling;
# drop of the storage modulus at the smallest; standard deviation of the drop; rms of a
# sweep over the median of all
_FALLING, _SOFTENED, _UNCERTAIN, _APART = 0.1, 0.03, 0.25, 2.5


@dataclass(frozen=True, eq=False, repr=False)
class Sweeps(AbstractWithTable):
    """What strain sweeps say of the factors: Kraus' constants with intervals, and each
    point about its own sweep.
    """

    parameters: dict[str, float]  # drop r, strain_c, exponent m, rise h
    interval: dict[str, tuple[float, float]]  # 95 %
    strain: Float[np.ndarray, " n"]  # amplitude of each point [1]
    storage: Float[np.ndarray, " n"]  # factor on the storage modulus
    loss: Float[np.ndarray, " n"]
    number: Int[np.ndarray, " n"]  # which sweep
    temperature: Float[np.ndarray, " s"]  # of each sweep [K]; NaN where not known
    omega: Float[np.ndarray, " s"]  # [rad/s]; NaN where not known
    # storage and loss modulus of small strain of each sweep [Pa]
    small: Float[np.ndarray, "s 2"]
    error: tuple[float, float]  # standard deviation of one ln storage, one ln loss
    warnings: tuple[str, ...]

    title: ClassVar[str] = "strain softening"
    intervals: ClassVar[str] = "95 %, Student's t"

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the fit, as pairs of a name and a text."""
        for name, value in self.parameters.items():
            low, high = self.interval[name]
            yield name, f"{value:.4g}   ({low:.3g} to {high:.3g})"
        yield (
            "measured",
            (
                f"{self.strain.size} points of {self.omega.size} sweeps, strain "
                f"{self._spanned()}"
            ),
        )
        yield "scatter", f"{self.error[0]:.2%} of storage, {self.error[1]:.2%} of loss"
        for warning in self.warnings:
            yield "warning", warning

    def columns(self) -> dict[str, np.ndarray]:
        """Measured factors on both moduli, one row per point."""
        return {
            "strain amplitude [-]": self.strain,
            "factor on storage modulus [-]": self.storage,
            "factor on loss modulus [-]": self.loss,
            "temperature [K]": self.temperature[self.number],
            "angular frequency [rad/s]": self.omega[self.number],
        }

    def _spanned(self) -> str:
        return f"{100 * self.strain.min():.3g} to {100 * self.strain.max():.3g} %"


class SofteningFit(WithTable, Softening):
    """An `em.Softening` with the sweeps that it was fitted to: `sweeps` has constants,
    intervals and points.
    """

    sweeps: Sweeps = static()

    def __init__(
        self, strain: ArrayLike, storage: ArrayLike, loss: ArrayLike, sweeps: Sweeps
    ):
        super().__init__(strain, storage, loss)
        fill(self, sweeps=sweeps)

    @property
    def parameters(self) -> dict[str, float]:
        """Kraus' constants: drop r, strain_c, exponent m, rise h."""
        return self.sweeps.parameters

    @property
    def interval(self) -> dict[str, tuple[float, float]]:
        """95 % intervals of `parameters`."""
        return self.sweeps.interval

    @property
    def warnings(self) -> tuple[str, ...]:
        """What the data cannot decide."""
        return self.sweeps.warnings

    def summary(self) -> str:
        """All findings in a few lines."""
        return self.sweeps.summary()

    def header(self) -> list[str]:
        """The findings."""
        return self.sweeps.header()

    def columns(self) -> dict[str, np.ndarray]:
        """The measured factors."""
        return self.sweeps.columns()

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws the factors over strain with the measured points, in a style of
        `Result.plot`; returns matplotlib Axes.
        """
        from ..results.plotting import Dots, Trace
        from .drawing import BLUE, RED, sketch

        sweeps = self.sweeps
        plural = "s" * (sweeps.omega.size > 1)
        made = sketch(
            (
                Label("Strain amplitude", "%"),
                Label("Factor on the modulus of small strain", "-"),
            ),
            "Softening with strain",
            f"{sweeps.omega.size} sweep{plural}, {sweeps.strain.size} points",
            ax,
            style,
        )
        made.ax.set(xscale="log")
        strain = np.geomspace(sweeps.strain.min() / 3, sweeps.strain.max(), 200)
        storage, loss = map(np.asarray, self.factors(strain))
        for measured, factor, colour, mark, name in (
            (sweeps.storage, storage, BLUE, "o", "storage modulus"),
            (sweeps.loss, loss, RED, "s", "loss modulus"),
        ):
            made.add(Trace(100 * strain, factor, name, colour=colour, width=0.7))
            made.add(
                Dots(
                    100 * sweeps.strain,
                    measured,
                    colour=colour,
                    mark=mark,
                    hollow="none",
                )
            )
        made.ax.set_ylim(0.0, None)
        return made.finish()

    def __repr__(self) -> str:
        return f"SofteningFit\n{self.summary()}"


class _Data(NamedTuple):
    log_strain: np.ndarray
    values: np.ndarray  # (points, 2), ln storage and ln loss
    number: np.ndarray
    temperature: np.ndarray  # of each sweep
    omega: np.ndarray

    @property
    def sweeps(self) -> int:
        return self.omega.size

    def model(self, p: np.ndarray) -> np.ndarray:
        """ln storage and ln loss at r, ln strain_c, m, h and then ln G'_0, ln G''_0 of
        each sweep.
        """
        return _factors(self.log_strain, p[:4]) + p[4:].reshape(-1, 2)[self.number]


def _factors(log_strain: np.ndarray, p: np.ndarray) -> np.ndarray:
    """Logarithms of Kraus' factors (points, 2)."""
    x = np.exp(np.clip(p[2] * (log_strain - p[1]), -300, 300))
    return np.stack(
        [np.log1p(-p[0] / (1 + x**-2.0)), np.log1p(2 * p[3] / (x + 1 / x))], -1
    )


@in_si
def softening(
    strain_sweep: Dma | Mapping[str, ArrayLike],
    *,
    form: Literal["kraus", "table"] = "kraus",
) -> SofteningFit:
    """The softening of a filled rubber with strain (Payne effect) from one strain sweep
    or several.

    Sweeps at several temperatures and frequencies share the factors; each has moduli of
    small strain of its own.

    Args:
        strain_sweep: a `Dma` whose points have strain amplitudes, or a mapping with
            "strain" [1], "storage" and "loss" [Pa], and "temperature" [K] and "omega"
            [rad/s] where they differ, lists of one length.
        form: "kraus" for the factors of Kraus' form, or "table" for the measured ones,
            four to a decade of strain, the storage modulus kept falling.

    Returns:
        An `em.Softening` for `softening=` of a material, over the measured strains,
        with `parameters`, their 95 % `interval`, `warnings`, `summary()`, `plot()` and
        `to_csv(path)`.

    Raises:
        InputError: for data without strain amplitudes, strains in per cent, and sweeps
            of fewer than four points.

    Source: G. Kraus, J. Appl. Polym. Sci.: Appl. Polym. Symp. 39 (1984) 75.
    """
    one_of("form", form, "kraus", "table")
    data, told = _data(strain_sweep)
    p, spread, sigma = _fitted(data)
    freedom = max(data.values.size - p.size, 1)
    half = float(stdtrit(freedom, 0.975)) * spread
    low, high = np.maximum(p[:4] - half[:4], _LOW), np.minimum(p[:4] + half[:4], _HIGH)
    ends = [
        (np.exp(a), np.exp(b)) if i == 1 else (a, b)
        for i, (a, b) in enumerate(zip(low, high, strict=True))
    ]
    value = [np.exp(x) if i == 1 else x for i, x in enumerate(p[:4])]
    factors = np.exp(data.values - p[4:].reshape(-1, 2)[data.number])
    order = np.argsort(data.log_strain, kind="stable")
    sweeps = Sweeps(
        parameters={name: float(x) for name, x in zip(NAMES, value, strict=True)},
        interval={
            name: (float(a), float(b)) for name, (a, b) in zip(NAMES, ends, strict=True)
        },
        strain=np.exp(data.log_strain[order]),
        storage=factors[order, 0],
        loss=factors[order, 1],
        number=data.number[order],
        temperature=data.temperature,
        omega=data.omega,
        small=np.exp(p[4:].reshape(-1, 2)),
        error=(float(sigma[0]), float(sigma[1])),
        warnings=(*told, *_judge(data, p, spread)),
    )
    strain, table = _table(sweeps) if form == "table" else _of_kraus(data, p[:4])
    tell(sweeps.warnings)
    return SofteningFit(strain, np.minimum(table[:, 0], 1.0), table[:, 1], sweeps)


def _data(sweep: Dma | Mapping[str, Any]) -> tuple[_Data, list[str]]:
    """The points of the sweeps, and what was left out. Raises `InputError`."""
    values = _values(sweep)
    for name in ("strain", "storage", "loss"):
        positive(name, values[name])
    if values["strain"].max() > _LARGEST:
        raise InputError(
            argument="strain",
            got=float(values["strain"].max()),
            accepted=f"an amplitude without unit, {_LARGEST:g} at most (0.1 for 10 %)",
            hint="divide per cent by 100",
        )
    log_strain = np.log(values["strain"])
    temperature = np.nan_to_num(values["temperature"], nan=1.0)
    log_omega = np.nan_to_num(np.log(values["omega"]), nan=1.0)
    pair = np.stack([group(temperature, _WARMS)[0], group(log_omega, _ALIKE)[0]])
    number = np.unique(pair, axis=1, return_inverse=True)[1].ravel()
    whole = [i for i in range(number.max() + 1) if _is_sweep(log_strain[number == i])]
    if not whole:
        raise InputError(
            argument="strain_sweep",
            got=int(number.size),
            accepted="four points or more over a factor of 3 in strain at one "
            "temperature and frequency",
            hint=f"they are at {number.max() + 1} of them",
        )
    kept, remarks = np.isin(number, whole), []
    if not kept.all():
        remarks.append(
            f"{int((~kept).sum())} points are in no sweep of four or more, and left "
            "out."
        )
    number = np.searchsorted(whole, number[kept])
    means = [
        np.array([np.mean(values[name][kept][number == i]) for i in range(len(whole))])
        for name in ("temperature", "omega")
    ]
    logs = np.log(np.stack([values["storage"], values["loss"]], -1))[kept]
    return _Data(log_strain[kept], logs, number, *means), remarks


def _values(sweep: Dma | Mapping[str, Any]) -> dict[str, np.ndarray]:
    """Strain, moduli, temperature and angular frequency of each point, NaN where it is
    not known. Raises `InputError`.
    """
    if isinstance(sweep, Dma):
        known = np.isfinite(sweep.strain)
        if not known.any():
            raise InputError(
                argument="strain_sweep",
                got=sweep.source,
                accepted="points with a strain amplitude",
            )
        names = ("strain", "storage", "loss", "temperature", "omega")
        return {
            name: np.asarray(getattr(sweep, name), dtype=float)[known] for name in names
        }
    names: tuple[str, ...] = ("strain", "storage", "loss")
    if not isinstance(sweep, Mapping) or not set(names) <= set(sweep):
        raise InputError(
            argument="strain_sweep",
            got=sweep,
            accepted='a Dma with strain amplitudes, or a mapping with "strain", '
            '"storage" and "loss"',
        )
    columns = lists(names, tuple(sweep[name] for name in names))
    values: dict[str, np.ndarray] = dict(zip(names, columns, strict=True))
    for name in ("temperature", "omega"):
        given = np.nan if sweep.get(name) is None else sweep[name]
        try:
            values[name] = np.broadcast_to(as_float64(name, given), columns[0].shape)
        except ValueError as problem:
            raise InputError(
                argument=name,
                got=np.shape(given),
                accepted=f"one number or as many as strain, {columns[0].size}",
            ) from problem
    return values


def _is_sweep(log_strain: np.ndarray) -> bool:
    return log_strain.size >= 4 and float(np.ptp(log_strain)) >= np.log(3.0)


def _fitted(data: _Data) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """r, ln strain_c, m, h and the moduli of small strain; their standard deviations;
    errors of ln storage and loss.
    """
    small_strain = np.array(
        [data.values[data.number == i].max(0) for i in range(data.sweeps)]
    )
    small_strain[:, 1] = [
        data.values[data.number == i, 1].min() for i in range(data.sweeps)
    ]
    low = np.concatenate([_LOW, np.full(small_strain.size, -50.0)])
    high = np.concatenate([_HIGH, np.full(small_strain.size, 80.0)])
    sigma, best = np.full(2, 0.02), None
    middle, end = np.median(data.log_strain), data.log_strain.max()
    for start in ((0.5, middle, 0.5, 0.5), (0.7, end, 0.5, 1.0), (0.3, end, 0.8, 0.2)):
        trial = _solve(
            data,
            sigma,
            np.concatenate([start, small_strain.ravel()]),
            low,
            high,
        )
        best = trial if best is None or trial.cost < best.cost else best
    assert best is not None
    for _ in range(_ROUNDS):
        off = data.model(best.x) - data.values
        sigma = np.maximum(
            np.sqrt(
                (off**2).sum(0) / max(data.values.shape[0] - 0.5 * best.x.size, 1.0)
            ),
            1e-9,
        )
        best = _solve(data, sigma, best.x, low, high)
    spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(best.jac.T @ best.jac)), 0.0))
    return best.x, spread, sigma


def _solve(
    data: _Data,
    sigma: np.ndarray,
    start: np.ndarray,
    low: np.ndarray,
    high: np.ndarray,
) -> OptimizeResult:
    return least_squares(
        lambda p: ((data.model(p) - data.values) / sigma).ravel(),
        np.clip(start, low + 1e-6, high - 1e-6),
        jac="3-point",
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-12,
        ftol=1e-12,
        max_nfev=300,
    )


def _of_kraus(data: _Data, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Strains and factors of Kraus' form, up to the largest measured strain."""
    last = float(data.log_strain.max())
    nodes = np.linspace(min(p[1], last) + np.log(_FIRST), last, _NODES)
    return np.exp(nodes), np.exp(_factors(nodes, p))


def _table(sweeps: Sweeps) -> tuple[np.ndarray, np.ndarray]:
    """Means of the measured factors in even steps of log strain, those of storage
    falling.
    """
    x = np.log(sweeps.strain)
    steps = max(2, int(np.ceil(np.ptp(x) / np.log(10.0) * _PER_DECADE)))
    which = np.minimum((steps * (x - x[0]) / np.ptp(x)).astype(int), steps - 1)
    rows = [
        (x[step].mean(), sweeps.storage[step].mean(), sweeps.loss[step].mean())
        for step in (which == i for i in range(steps))
        if step.any()
    ]
    nodes, storage, loss = np.array(rows).T
    storage = isotonic_regression(storage, increasing=False).x
    return np.exp(nodes), np.stack([storage, loss], -1)


def _judge(data: _Data, p: np.ndarray, spread: np.ndarray) -> Iterator[str]:
    """What cannot be relied on in Kraus' form through strain sweeps."""
    first, last = data.log_strain.min(), data.log_strain.max()
    log_storage = _factors(np.array([first, last - 0.01, last]), p[:4])[:, 0]
    if log_storage[1] - log_storage[2] > 0.01 * _FALLING:
        yield (
            "The storage modulus still falls at the largest strain, "
            f"{100 * np.exp(last):.3g} %: where it levels off is an extrapolation. The "
            "factors end there, and are held beyond."
        )
    if 1 - np.exp(log_storage[0]) > _SOFTENED:
        yield (
            f"At the smallest strain, {100 * np.exp(first):.3g} %, the rubber has "
            "softened already: the moduli of small strain are an extrapolation."
        )
    # a rise of zero is no limit
    lowest = (p[:4] - _LOW < 1e-6) & (np.arange(4) != 3)
    if (lowest | (_HIGH - p[:4] < 1e-6)).any():
        yield (
            "A constant of Kraus' form is at the end of what is looked at: take the "
            "table (form='table')."
        )
    if spread[0] > _UNCERTAIN:
        yield f"The drop of the storage modulus is known to +- {2 * spread[0]:.2g} only."
    off = (data.model(p) - data.values) ** 2
    rms = np.sqrt([off[data.number == i].mean(axis=0) for i in range(data.sweeps)])
    apart = (rms > _APART * np.median(rms, axis=0)).any(axis=1)
    for i in np.flatnonzero(apart & (apart.size > 1)):
        celsius, hertz = data.temperature[i] - 273.15, data.omega[i] / (2 * np.pi)
        where = "" if np.isnan(celsius) else f" at {celsius:.3g} degC"
        where += "" if np.isnan(hertz) else f" and {hertz:.3g} Hz"
        yield (
            f"The sweep{where} does not follow the factors of the others: they depend "
            "on "
            "it."
        )
