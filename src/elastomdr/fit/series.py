"""Prony series from dynamic moduli, relaxation, or both: what `em.fit.prony` does and
returns.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, Self

import numpy as np

from ..arrays import one_thread
from ..checks import in_si, one_of, positive, scalar, significant
from ..errors import InputError, advise, quiet
from ..io.data import KINDS, lists
from ..material.prony import Prony
from ..material.validity import Range, misfit_bands
from .doubts import JudgedSeries, of_series, relaxation_excess
from .isotherms import alike
from .master import MasterCurve
from .report import (
    TWO_SIGMA,
    AbstractWithTable,
    DynamicBand,
    RelaxationBand,
    dynamic_band,
    header_of,
    relaxation_band,
    tell,
)
from .shifting import AtReference, Joint, at_reference, curve, join
from .spectrum import LOSS, RELAXATION, STORAGE, MeasuredPoints
from .terms import (
    Data,
    Met,
    SlowEnd,
    Terms,
    check_terms,
    choose_terms,
    slow_end,
    trade_off,
    verdict,
    weigh,
)

if TYPE_CHECKING:
    from jaxtyping import Float
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Kind, Number, Style
    from ..material.shift import AbstractShift, AbstractVertical

# --------------------------------------------------------------------------------------
# The loss modulus, which makes friction, from relaxation: a smooth estimate for the
# series, and its range.
#
# Few exponentials that meet G(t) exactly may have a loss modulus that is several per cent
# off, too small near the fast end above all: relaxation from t_0 on has lost what relaxes
# within t_0, and that is still a part of the loss at angular frequencies a decade or two
# below 1/t_0 (of order (omega t_0)^(1 - n) where G ~ t^-n). The smooth spectrum carries
# on.
# --------------------------------------------------------------------------------------

_LN10 = float(np.log(10.0))
# times 1/t, the largest angular frequency that relaxation from t on says something of
_EARLY = 0.1
_PER_DECADE = 6  # estimates of the loss modulus
# half a 95 % interval of ln(loss modulus) up to which relaxation determines it,
_KNOWN = 0.03
# or times the smallest such interval, where it is known nearly as well as anywhere,
_BEST = 1.5
_LEAST_KNOWN = 0.06  # but never a wider one: noisier data would seem to determine more
# decades; over fewer, what seems to be known is where errors happen to cancel
_SHORTEST = 0.5
# decades between neighbouring dynamic points from which the loss modulus between them
# may be unknown
_WIDE = 0.5
# standard deviation of ln(loss modulus) above which an estimate is worth nothing
_WIDEST = 0.5
_CHANNELS = {"storage": STORAGE, "loss": LOSS, "relaxation": RELAXATION}


def with_loss(data: Data, joint: Joint, state: AtReference) -> Data:
    """Data with the smooth spectrum's loss modulus added where there is relaxation and
    no dynamic modulus.

    Each estimate counts by its own uncertainty; `Data.measured` says that they are not
    data.
    """
    rate = _grid(data.points)
    if not rate.size:
        return data
    value, std = curve(joint, state, rate, np.full(rate.size, LOSS))
    sure = std < _WIDEST
    rate, value, std = rate[sure], value[sure], std[sure]
    noise = data.noise.copy()
    if not (data.points.channel == LOSS).any():
        noise[LOSS] = noise[RELAXATION]
    weights = np.minimum((noise[LOSS] / std) ** 2, 1.0) * data.alike
    more = MeasuredPoints(
        np.full(rate.size, LOSS),
        rate,
        value,
        np.zeros(rate.size, dtype=int),
        np.zeros(rate.size),
    )
    return Data(
        MeasuredPoints(
            *(np.concatenate(both) for both in zip(data.points, more, strict=True))
        ),
        noise,
        np.concatenate([data.weights, weights]),
        data.alike,
        data.points.channel.size,
    )


def known_range(
    points: MeasuredPoints,
    joint: Joint,
    state: AtReference,
    loss: Callable[[np.ndarray], np.ndarray],
) -> tuple[float, float] | tuple[()]:
    """Angular frequencies at which the moduli of a series are known: those of dynamic
    data, and where relaxation determines its loss modulus to 3 %, or nearly as well as
    anywhere, and nowhere between to worse than 6 %; rounded [rad/s].

    The widest stretch, of half a decade at least; () where there is none. Relaxation
    and dynamic data, or isotherms of dynamic data that do not overlap, make one stretch
    where the loss modulus is known between them too.
    """
    dynamic = np.unique(points.log_rate[points.channel != RELAXATION])
    unknown = [
        gap
        for gap in itertools.pairwise(dynamic)
        if np.ptp(gap) > _WIDE * _LN10 and _unknown(joint, state, gap, loss)
    ]
    edges = [*dynamic[:1], *(x for gap in unknown for x in gap), *dynamic[-1:]]
    ends = [
        float(x)
        for x in max(zip(edges[::2], edges[1::2], strict=True), key=np.ptp, default=())
    ]
    rate = _grid(points)
    if rate.size:
        half = _half(joint, state, rate, loss)
        relaxed = _widest(
            rate, half, float(np.clip(_BEST * half.min(), _KNOWN, _LEAST_KNOWN))
        )
        both = bool(ends and relaxed)
        if both and _unknown(
            joint,
            state,
            (min(max(ends), max(relaxed)), max(min(ends), min(relaxed))),
            loss,
        ):
            ends = max(ends, relaxed, key=np.ptp)
        else:
            ends += relaxed
    if not ends:
        return ()
    low, high = (float(f"{np.exp(x):.4g}") for x in (min(ends), max(ends)))
    return low, high


def known_to(
    joint: Joint,
    state: AtReference,
    window: tuple[float, float],
    limits: tuple[float, float] | tuple[()],
    loss: Callable[[np.ndarray], np.ndarray],
) -> str:
    """How well the loss modulus of a series is known between two angular frequencies
    [rad/s], in words.

    Half of the widest 95 % interval, that of the smooth spectrum widened by its
    distance to the series. Without such limits, half of the narrowest within the
    `window` of relaxation data.
    """
    low, high = limits or (window[0], max(_EARLY * window[1], 1.001 * window[0]))
    rate = np.log(np.geomspace(low, high, _PER_DECADE * 4))
    half = 100 * _half(joint, state, rate, loss)
    if not limits:
        return (
            f"not measured, and known to {100 * _LEAST_KNOWN:g} % over no half "
            f"decade: at best to +- {half.min():.2g} % (95 %), at "
            f"{np.exp(rate[half.argmin()]):.3g} rad/s; friction is extrapolated"
        )
    return (
        f"not measured; the series has it to +- {half.max():.2g} % (95 %) from "
        f"{low:.3g} to {high:.3g} "
        "rad/s, and friction no better"
    )


def _unknown(
    joint: Joint,
    state: AtReference,
    gap: tuple[float, float],
    loss: Callable[[np.ndarray], np.ndarray],
) -> bool:
    """Whether between two ln(omega), ascending, the loss modulus is known to worse than
    6 % somewhere.
    """
    low, high = gap
    if high <= low:
        return False
    rate = np.linspace(low, high, int(np.ceil((high - low) / _LN10 * _PER_DECADE)) + 1)
    return bool(_half(joint, state, rate, loss).max() > _LEAST_KNOWN)


def _widest(rate: np.ndarray, half: np.ndarray, limit: float) -> list[float]:
    """Ends of the widest stretch whose intervals are within a limit at either end, and
    between within half as much again (`_BEST`), but nowhere above the widest that
    counts as known.
    """
    near = half <= min(_BEST * limit, _LEAST_KNOWN)
    # first of one, next after it
    edges = np.flatnonzero(np.diff(near, prepend=False, append=False))
    known = [
        rate[a:b][half[a:b] <= limit]
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]
    ends = [
        (float(x[0]), float(x[-1]))
        for x in known
        if x.size and np.ptp(x) >= _SHORTEST * _LN10
    ]
    return list(max(ends, key=np.ptp, default=()))


def _half(
    joint: Joint,
    state: AtReference,
    rate: np.ndarray,
    loss: Callable[[np.ndarray], np.ndarray],
) -> np.ndarray:
    """Half of the 95 % interval of ln(loss modulus) of a series at ln(omega), as
    `bands.dynamic_band` has it.
    """
    value, std = curve(joint, state, rate, np.full(rate.size, LOSS))
    return TWO_SIGMA * np.hypot(std, np.log(loss(np.exp(rate))) - value)


def _grid(points: MeasuredPoints) -> np.ndarray:
    """ln(omega) where relaxation says something and no dynamic modulus does."""
    relaxed = points.log_rate[points.channel == RELAXATION]
    if not relaxed.size:
        return relaxed
    low, high = relaxed.min(), max(relaxed.max() + np.log(_EARLY), relaxed.min() + 1e-3)
    rate = np.linspace(
        low, high, max(2, int(np.ceil((high - low) / _LN10 * _PER_DECADE)) + 1)
    )
    dynamic = points.log_rate[points.channel != RELAXATION]
    return (
        rate
        if not dynamic.size
        else rate[(rate < dynamic.min()) | (rate > dynamic.max())]
    )


# --------------------------------------------------------------------------------------
# Prony series from dynamic moduli, relaxation, or both: what `em.fit.prony` does and
# returns.
# --------------------------------------------------------------------------------------

_INCOMPRESSIBLE = (
    "Poisson's ratio is assumed to be 0.5; tensile moduli become those of shear and "
    "of contact with it, so give it where it is known, as "
    + advise("poisson=0.4", {"poisson": "0.4"})
    + "."
)


@dataclass(frozen=True, eq=False, repr=False)
class PronyFit(AbstractWithTable):
    """A Prony series through data, its distance from them, and the uncertainty of each
    number.

    Residuals are relative, prediction over data minus one. Standard deviations follow
    from the scatter of the data about the series, and from how much neighbouring
    residuals resemble each other. `kind` says whether moduli are of shear or tension.
    """

    material: Prony
    # root mean square of the relative residuals; NaN where there are no such data
    storage_residual: float
    loss_residual: float
    relaxation_residual: float
    # relative, per point, for "storage", "loss", "relaxation"
    residuals: dict[str, Float[np.ndarray, " m"]]
    # [Pa]; 0 for a liquid. Where the interval is wider, that of an interval that holds
    # it
    equilibrium_std: float
    # 95 %, with what may relax more slowly than the data reach [Pa]
    equilibrium_interval: tuple[float, float]
    moduli_std: Float[np.ndarray, " n"]  # [Pa]
    times_std: Float[np.ndarray, " n"]  # [s]
    # of ln moduli, ln times and, for a solid, ln equilibrium
    covariance: Float[np.ndarray, "p p"]
    omega: Float[np.ndarray, " m"]  # data, as fitted [rad/s]
    storage: Float[np.ndarray, " m"]  # [Pa]
    loss: Float[np.ndarray, " m"]  # [Pa]
    time: Float[np.ndarray, " k"]  # [s]
    relaxation: Float[np.ndarray, " k"]  # [Pa]
    kind: Kind
    warnings: tuple[str, ...]
    converged: bool
    # number of terms asked for; None: the data chose. Terms without a modulus are left
    # out
    asked: int | None
    # where both moduli contradict each other: how closely passive materials meet them
    trade_off: tuple[Met, ...]
    joint: Joint  # the smooth spectrum whose intervals `band` uses
    master: MasterCurve | None

    @property
    def terms(self) -> int:
        """Number of relaxation times."""
        return int(self.material.times.size)

    @property
    def window(self) -> tuple[float, float]:
        """Lowest and highest angular frequency of the data; for relaxation, 1/t
        [rad/s].
        """
        rates = np.concatenate([self.omega, 1 / self.time])
        return float(rates.min()), float(rates.max())

    def moduli_at(self, omega: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
        """Storage and loss modulus [Pa] of the series, in the data's own kind, at omega
        [rad/s] of any shape.
        """
        return np.asarray(self.material.storage(omega)), np.asarray(
            self.material.loss(omega)
        )

    def relaxation_at(self, time: ArrayLike) -> np.ndarray:
        """Relaxation modulus [Pa] of the series, in the data's own kind, at times [s]
        of any shape.
        """
        return np.asarray(self.material.relaxation(time))

    def band(self, omega: ArrayLike) -> DynamicBand:
        """Storage and loss modulus of the series with 95 % intervals, at angular
        frequencies [rad/s], any shape.

        The intervals are those of a smooth spectrum through the same data (with the
        uncertainty of the shifts, where the data are a master curve), widened by the
        distance between that and the series. Frequencies outside `window` are
        extrapolated: `inside` marks them, and a `FitWarning` counts them.
        """
        return dynamic_band(self.joint, self._state, self.window, omega, self.moduli_at)

    def relaxation_band(self, time: ArrayLike) -> RelaxationBand:
        """Relaxation modulus of the series with its 95 % interval, at times [s] of any
        shape; otherwise as `band`.
        """
        return relaxation_band(
            self.joint, self._state, self.window, time, self.relaxation_at
        )

    @property
    def _left_out(self) -> str:
        if self.asked is None or self.asked == self.terms:
            return ""
        return f"; {self.asked} were asked for, the data give the others no modulus"

    @property
    def loss_known(self) -> str:
        """How well relaxation determines the loss modulus within the material's range;
        "" where it was measured.
        """
        limits = (
            None
            if self.loss.size or self.material.range is None
            else self.material.range.omega
        )
        if limits is None:
            return ""
        return known_to(
            self.joint, self._state, self.window, limits, lambda w: self.moduli_at(w)[1]
        )

    @property
    def _state(self) -> AtReference:
        return (
            self.master.state
            if self.master is not None
            else at_reference(self.joint, self.joint.shifts.temperature[0])
        )

    def columns(self) -> dict[str, np.ndarray]:
        """The series with standard deviations, one row per term; the equilibrium
        modulus has an infinite time.
        """
        symbol = "G" if self.kind == "shear" else "E"
        material = self.material
        return {
            "relaxation time [s]": np.append(material.times, np.inf),
            "standard deviation of it [s]": np.append(self.times_std, 0.0),
            f"modulus {symbol} [Pa]": np.append(material.moduli, material.equilibrium),
            "standard deviation of modulus [Pa]": np.append(
                self.moduli_std, self.equilibrium_std
            ),
        }

    def header(self) -> list[str]:
        """Title, units, intervals and findings, without the terms."""
        told = ((name, text) for name, text in self.findings() if name != "term")
        return header_of("Prony series", told)

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws data, series and band against frequency on `ax`, or on a new figure, in
        a style of `Result.plot`; returns matplotlib Axes.
        """
        from ..results.plotting import Dots
        from .drawing import BLUE, RED, celsius, draw_band, draw_beyond, of_moduli

        dynamic, (low, high) = bool(self.omega.size), self.window
        title = self.material.name or "Prony series"
        if self.master is not None:
            title += f" at {celsius(self.master.reference)}"
        small = f"rms relative residuals: {self.residuals_in_words()}"
        made = of_moduli(self.kind, dynamic, title, small, ax, style)
        if self.master is not None:
            self.master.draw_points(made)
        elif dynamic:
            made.add(Dots(self.omega, self.storage, "storage modulus", colour=BLUE))
            made.add(
                Dots(
                    self.omega,
                    self.loss,
                    "loss modulus",
                    colour=RED,
                    mark="s",
                    hollow="none",
                )
            )
        else:
            made.add(
                Dots(self.time, self.relaxation, "relaxation modulus", colour=BLUE)
            )
        if not dynamic:
            low, high = 1 / high, 1 / low
        wide, inside = np.geomspace(low / 10, 10 * high, 400), (low, high, 300)
        label = f"Prony series, {self.terms} terms"
        with quiet():  # the warnings of the fit have been said
            if dynamic:
                draw_beyond(made, wide, self.moduli_at(wide))
                draw_band(made, self.band(np.geomspace(*inside)), label)
            else:
                draw_beyond(made, wide, [self.relaxation_at(wide)])
                draw_band(made, self.relaxation_band(np.geomspace(*inside)), label)
        return made.finish()

    def residuals_in_words(self) -> str:
        """The rms residual of each modulus that was fitted."""
        sizes = {
            "storage": self.storage_residual,
            "loss": self.loss_residual,
            "relaxation": self.relaxation_residual,
        }
        return ", ".join(
            f"{name} {100 * size:.2g} %"
            for name, size in sizes.items()
            if np.isfinite(size)
        )

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the series, as pairs of a name and a text."""
        decades = np.log10(self.window[1] / self.window[0])
        yield (
            "terms",
            f"{self.terms} over {decades:.1f} decades ({self.kind} moduli)"
            f"{self._left_out}",
        )
        yield "residuals", f"{self.residuals_in_words()} rms"
        if self.trade_off:
            rows = (
                f"{100 * m.storage:.2g}, {100 * m.loss:.2g} % (balance {m.balance:g})"
                for m in self.trade_off
            )
            yield (
                "trade-off",
                "storage and loss of the closest passive materials: " + "; ".join(rows),
            )
        if range_of_loss := self.loss_known:
            yield "loss modulus", range_of_loss
        yield "equilibrium", self._equilibrium_in_words()
        for modulus, std, time in zip(
            self.material.moduli, self.moduli_std, self.material.times, strict=True
        ):
            yield (
                "term",
                f"tau {significant(float(time)):>10} s   {float(modulus):10.4g} +- "
                f"{TWO_SIGMA * std:.2g} Pa",
            )
        for warning in self.warnings:
            yield "warning", warning

    def _equilibrium_in_words(self) -> str:
        equilibrium = float(self.material.equilibrium)
        if equilibrium:
            low, high = self.equilibrium_interval
            return f"{equilibrium:.4g} Pa, {low:.4g} to {high:.4g} Pa with 95 %"
        if float(self.material.times.max()) * self.window[0] < 1:
            return "0: a liquid"
        return "0: none is visible in the data; below them the series is a liquid"


@in_si
@one_thread()
def prony(
    omega: ArrayLike | MasterCurve | None = None,
    storage: ArrayLike | None = None,
    loss: ArrayLike | None = None,
    *,
    time: ArrayLike | None = None,
    relaxation: ArrayLike | None = None,
    terms: int | None = None,
    equilibrium: bool | None = None,
    balance: float | None = None,
    kind: Kind | None = None,
    poisson: float | None = None,
    shift: AbstractShift | None = None,
    vertical: AbstractVertical | None = None,
    name: str = "",
    citation: str = "",
) -> PronyFit:
    """The Prony series that comes closest, relatively, to storage and loss moduli, to
    relaxation, or to both.

    Moduli are not negative, so that the series is passive; times are refined, and may
    lie outside the data.

    Args:
        omega: angular frequencies [rad/s], shape (n,); or a `MasterCurve`, which brings
            all data.
        storage: storage moduli [Pa], shape (n,).
        loss: loss moduli [Pa], shape (n,).
        time: times of relaxation data [s], shape (m,).
        relaxation: relaxation moduli [Pa], shape (m,).
        terms: number of terms; by default chosen by the Akaike information criterion,
            at most one and a half per decade.
        equilibrium: whether there is an equilibrium modulus; by default chosen
            likewise.
        balance: how many times more exactly the storage modulus is to be met than the
            loss modulus; by default this follows their scatter, and is 1 where no
            passive material meets both: `trade_off` has what others give.
        kind: "shear" or "tensile"; by default what the master curve says, or shear.
        poisson: Poisson's ratio of the material; by default 0.5, with a warning for
            tensile moduli.
        shift: shift law of the material.
        vertical: its law of vertical shifts.
        name: name of the material.
        citation: source of the material.

    Returns:
        A `PronyFit`, whose `material` is the series.

    Raises:
        InputError: for lists that do not match, values that are not positive, and too
            few points.

    Source: `docs/fitting.md`.
    """
    master = None
    if isinstance(omega, MasterCurve):
        master = omega
        measured = _Measured.of([getattr(master, name) for name in _Measured._fields])
    else:
        measured = _Measured.of((omega, storage, loss, time, relaxation))
    if kind is None:
        kind = "shear" if master is None else master.kind
    one_of("kind", kind, *KINDS)
    points = measured.points()
    check_terms(terms, points.log_rate)
    balance = _checked_options(equilibrium, balance)
    joint, state = _smooth(points) if master is None else (master.joint, master.state)
    noise, systematic = weigh(joint.shifts.posterior.noise, points, balance)
    data = Data(points, noise, joint.shifts.posterior.weights, joint.inflation)
    chosen = choose_terms(with_loss(data, joint, state), terms, equilibrium)
    series = _solve(data, joint, state, chosen)
    trades = trade_off(points) if systematic else ()
    warnings = series.doubts(data, joint, trades, measured.omega)
    if kind == "tensile" and poisson is None:
        warnings = (*warnings, _INCOMPRESSIBLE)
    tell(warnings)
    material = Prony(
        series.equilibrium,
        series.moduli,
        series.times,
        range=series.known(
            measured.omega, None if master is None else master.measured_at
        ),
        kind=kind,
        poisson=0.5 if poisson is None else poisson,
        shift=shift,
        vertical=vertical,
        name=name,
        citation=citation,
    )
    return PronyFit(
        material=material,
        storage_residual=series.rms("storage"),
        loss_residual=series.rms("loss"),
        relaxation_residual=series.rms("relaxation"),
        residuals=series.parts(),
        equilibrium_std=series.equilibrium_std,
        equilibrium_interval=series.interval,
        moduli_std=series.moduli_std,
        times_std=series.times_std,
        covariance=series.covariance,
        converged=series.converged,
        **measured._asdict(),
        kind=kind,
        warnings=warnings,
        asked=None if terms is None else int(terms),
        trade_off=trades,
        joint=joint,
        master=master,
    )


class _Measured(NamedTuple):
    """Moduli at one temperature."""

    omega: np.ndarray  # [rad/s]
    storage: np.ndarray  # [Pa]
    loss: np.ndarray
    time: np.ndarray  # [s]
    relaxation: np.ndarray  # [Pa]

    @classmethod
    def of(cls, given: Sequence[ArrayLike | None]) -> Self:
        """From lists in this order. Raises `InputError`."""
        names = cls._fields
        return cls(*lists(names[:3], given[:3]), *lists(names[3:], given[3:]))

    def points(self) -> MeasuredPoints:
        """All values, one after the other. Raises `InputError` for too few of them."""
        n, slow = self.omega.size, self.time.size
        if 2 * n + slow < 3:
            raise InputError(
                argument="omega",
                got=n,
                accepted="two points or more, or time three, with their moduli",
            )
        log_omega = np.log(self.omega)
        points = MeasuredPoints(
            np.repeat([STORAGE, LOSS, RELAXATION], [n, n, slow]),
            np.concatenate([log_omega, log_omega, -np.log(self.time)]),
            np.log(np.concatenate([self.storage, self.loss, self.relaxation])),
            np.zeros(2 * n + slow, dtype=int),
            np.zeros(2 * n + slow),
        )
        if np.ptp(points.log_rate) < np.log(1.5):
            raise InputError(
                argument="omega",
                got=float(np.exp(np.ptp(points.log_rate))),
                accepted="over a range of frequencies, a factor of 1.5 or more",
            )
        return points


def _checked_options(equilibrium: object, balance: Number | None) -> float | None:
    """The balance. Raises `InputError`."""
    if not isinstance(equilibrium, bool | None):
        raise InputError(
            argument="equilibrium",
            got=equilibrium,
            accepted="True, False or None (the data decide)",
        )
    if balance is None:
        return None
    balance = float(scalar("balance", balance))
    positive("balance", balance)
    return balance


class _Series(NamedTuple):
    """A series, and how well it is known."""

    channel: np.ndarray  # of each residual
    residuals: np.ndarray  # relative
    equilibrium: float  # [Pa]
    moduli: list[float]  # [Pa]
    times: list[float]  # [s]
    interval: tuple[float, float]  # of the equilibrium modulus, 95 % [Pa]
    moduli_std: np.ndarray
    times_std: np.ndarray
    covariance: np.ndarray
    end: SlowEnd
    limits: (
        tuple[float, float] | tuple[()]
    )  # frequencies between which the data determine the series
    converged: bool

    @property
    def equilibrium_std(self) -> float:
        low, high = self.interval
        equilibrium = self.equilibrium
        return max(equilibrium - low, high - equilibrium) / TWO_SIGMA

    def residuals_of(self, name: str) -> np.ndarray:
        """Residuals of storage, loss or relaxation."""
        return self.residuals[self.channel == _CHANNELS[name]]

    def parts(self) -> dict[str, np.ndarray]:
        """Residuals of what was measured."""
        parts = {name: self.residuals_of(name) for name in _CHANNELS}
        return {name: deviation for name, deviation in parts.items() if deviation.size}

    def rms(self, name: str) -> float:
        deviation = self.residuals_of(name)
        return float(np.sqrt(np.mean(deviation**2))) if deviation.size else float("nan")

    def doubts(
        self, data: Data, joint: Joint, trades: tuple[Met, ...], omega: np.ndarray
    ) -> tuple[str, ...]:
        """What cannot be relied on."""
        judged = JudgedSeries(
            data=data,
            residuals=self.residuals,
            contradiction=verdict(trades, self.rms("storage"), self.rms("loss")),
            excess=relaxation_excess(joint),
            converged=self.converged,
            equilibrium=self.equilibrium,
            interval=self.interval,
            end=self.end,
            limits=self.limits,
            omega=omega,
        )
        return tuple(of_series(judged))

    def known(
        self, omega: np.ndarray, measured_at: tuple[float, float] | None
    ) -> Range:
        """The range of the series as a material, and its misfit."""
        misfit = misfit_bands(
            omega, self.residuals_of("storage"), self.residuals_of("loss")
        )
        return Range(self.limits, measured_at, misfit=misfit)


def _solve(data: Data, joint: Joint, state: AtReference, chosen: Terms) -> _Series:
    """The series of a choice of terms, with its uncertainty."""
    points, noise = data.points, data.noise
    off = chosen.posterior.residuals[: points.channel.size]
    chi = float(
        (data.weights * (off / noise[points.channel]) ** 2).sum() / data.weights.sum()
    )
    covariance = chosen.posterior.covariance * max(1.0, chi)  # misfit is not noise
    std = np.sqrt(np.diag(covariance))
    count = chosen.log_times.size
    moduli, times = np.exp(chosen.log_moduli), np.exp(chosen.log_times)
    equilibrium, *numbers = (
        float(f"{x:.6g}") for x in (chosen.equilibrium, *moduli, *times)
    )

    def sensitivity(omega: np.ndarray) -> np.ndarray:
        z = omega[:, None] * times
        return (moduli / (z + 1 / z)).sum(1)

    end = slow_end(points, noise)
    return _Series(
        channel=points.channel,
        residuals=np.expm1(-off),
        equilibrium=equilibrium,
        moduli=numbers[:count],
        times=numbers[count:],
        interval=_equilibrium_interval(joint, state, end, equilibrium, std[-1]),
        moduli_std=moduli * std[:count],
        times_std=times * std[count : 2 * count],
        covariance=covariance,
        end=end,
        limits=known_range(points, joint, state, sensitivity),
        converged=chosen.posterior.converged,
    )


def _equilibrium_interval(
    joint: Joint, state: AtReference, end: SlowEnd, equilibrium: float, std: float
) -> tuple[float, float]:
    """The 95 % interval of the equilibrium modulus [Pa], vertical shifts included, which
    move all of the series; it holds what the slow end of the data leaves open.
    """
    if not equilibrium:
        return 0.0, 0.0
    channel = STORAGE if end.kind == "storage" else RELAXATION
    at_end = np.array([np.log(end.rate)]), np.array([channel])
    lifted = float(curve(joint, state, *at_end)[1][0])
    half = TWO_SIGMA * equilibrium * float(np.hypot(std, lifted))
    return max(min(equilibrium - half, end.low), 0.0), max(equilibrium + half, end.end)


def _smooth(points: MeasuredPoints) -> tuple[Joint, AtReference]:
    """The smooth spectrum through data of one temperature."""
    shifts = join(points, np.array([293.15]), np.zeros(1), "none")
    count = alike(points, shifts.posterior.residuals)
    if count > 1:
        shifts = join(
            points, np.array([293.15]), np.zeros(1), "none", count, near=shifts
        )
    joint = Joint(shifts, (), count, 1.0, shifts, 1.0)
    return joint, at_reference(joint, joint.shifts.temperature[0])
