"""Time-temperature superposition, from isotherms to a `MasterCurve`: other responses
as relaxation, the joint fit, the shift law and the table that a material carries.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..arrays import one_thread
from ..checks import (
    in_kelvin,
    in_si,
    not_negative,
    positive,
    scalar,
    significant,
    whole_number,
)
from ..errors import InputError
from ..files import csv_text
from ..io.data import Dma, of_one_strain, strains, without_copies
from ..material.prony import Prony
from ..material.shift import (
    AbstractShift,
    AbstractVertical,
    Arrhenius,
    EntropicVertical,
    ShiftTable,
    VerticalTable,
)
from ..material.tabulated import TabulatedModulus
from ..material.validity import Range, misfit_bands
from ..trees import replaced
from .doubts import JudgedShifts, of_shifts
from .isotherms import Isotherms, gathered, group, isotherms, refuse_exchanged
from .laws import LawFit, given_law, law_about, words
from .report import (
    TWO_SIGMA,
    AbstractWithTable,
    DynamicBand,
    RelaxationBand,
    dynamic_band,
    header_of,
    relaxation_band,
    shifts_in_words,
    tell,
)
from .shifting import (
    LN10,
    AtReference,
    Joint,
    Shifts,
    at_reference,
    entropic,
    fit_jointly,
    rough_shifts,
    separable,
    without_vertical,
)
from .spectrum import CHANNELS, LOSS, RELAXATION, STORAGE

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Kind, Number, Style
    from ..material.shift import VFT, WLF
    from ..results.plotting import Sketch

# --------------------------------------------------------------------------------------
# The shift law that a material made from a master curve carries: the given one, or the
# one that the data follow.
# --------------------------------------------------------------------------------------

LAWS = ("auto", "WLF", "Arrhenius", "VFT", "table", "none")
# decimals of a material's range and of its table of shift factors, which have to agree
# [K]
TEMPERATURE_DIGITS = 2
_NONE = 1e-4  # log10 b_T below which it is none
# by how much a table of vertical shifts reaches beyond the data, as entropy elasticity
# [K]
_ONWARD = 100.0
# of a law in the material: what follows is rounding, and differs between machines
_DIGITS = 8


def check_law(law: object) -> None:
    """Raises `InputError` unless `law` is one of `LAWS`."""
    if law not in LAWS:
        raise InputError(argument="law", got=law, accepted=f"one of {', '.join(LAWS)}")


def shift_law(master: "MasterCurve", law: str) -> tuple[str, Any]:
    """The name of a law and the law itself, None for "none"; `law` is one of `LAWS`."""
    if master.joint.law is not None and law == "auto":
        return "given", law_about(
            master.joint.law, master.reference, master.measured_at
        )
    chosen = _choose(master) if law == "auto" else law
    return chosen, None if chosen == "none" else _table(
        master
    ) if chosen == "table" else _law(master, chosen)


def _choose(master: "MasterCurve") -> str:
    if master.temperature.size < 2:
        return "none"
    if master.temperature.size == 2:
        return "Arrhenius"
    return "WLF" if master.laws["WLF"].holds else "table"


def _law(master: "MasterCurve", name: str) -> Any:
    if name not in master.laws:
        raise InputError(
            argument="law",
            got=name,
            accepted=f"one that these data allow ({', '.join([*master.laws, 'none'])})",
            hint=f"there are {master.temperature.size} temperatures",
        )
    law = master.laws[name].law
    return type(law)(
        *(
            rounded(float(getattr(law, field)), _DIGITS)
            for field in law.__dataclass_fields__
        )
    )


def _table(master: "MasterCurve") -> ShiftTable:
    """The shift factors as a table, with the reference temperature as one of its
    entries.
    """
    if master.temperature.size < 2:
        raise InputError(
            argument="law", got="table", accepted="'none' for data of one temperature"
        )
    away = np.abs(master.temperature - master.reference) > 0.5
    temperature = np.append(master.temperature[away], master.reference).round(
        TEMPERATURE_DIGITS
    )
    log10_a = np.append(master.log10_a[away], 0.0).round(_DIGITS)
    order = np.argsort(temperature)
    return ShiftTable(temperature[order], np.minimum.accumulate(log10_a[order]))


def vertical_law(master: "MasterCurve") -> AbstractVertical | None:
    """The law of vertical shifts that a material carries: none, entropy elasticity
    where the shifts are those, a table.

    Beyond the data a table goes on by entropy elasticity: the range of the material
    says where they end.
    """
    reference = float(master.reference)
    temperatures = master.temperature
    log10_b = -master.log10_b
    if np.abs(log10_b).max() < _NONE:
        return None
    if np.abs(log10_b - np.log10(temperatures / reference)).max() < _NONE:
        return EntropicVertical(reference)
    away = np.abs(temperatures - reference) > 0.5
    temperature = np.append(temperatures[away], reference).round(TEMPERATURE_DIGITS)
    order = np.argsort(temperature)
    temperature = temperature[order]
    factor = (10 ** np.append(log10_b[away], 0.0))[order]
    beyond = np.array(
        [max(temperature[0] - _ONWARD, temperature[0] / 2), temperature[-1] + _ONWARD]
    )
    ends = beyond / temperature[[0, -1]] * factor[[0, -1]]
    temperature = np.concatenate([beyond[:1], temperature, beyond[1:]]).round(
        TEMPERATURE_DIGITS
    )
    return VerticalTable(
        temperature, np.concatenate([ends[:1], factor, ends[1:]]).round(_DIGITS)
    )


def rounded(value: float, digits: int) -> float:
    """A number to so many significant digits."""
    return float(f"{value:.{digits - 1}e}")


# --------------------------------------------------------------------------------------
# Other responses than relaxation as relaxation: creep compliance, stress after a ramp,
# a storage modulus alone.
#
# What was measured, M(t), is a functional of the relaxation modulus G(t):
#
#     creep            M = 1/J(t)                                  with int_0^t G(t - s) dJ(s) = 1
#     ramp of r
#     M = (1/r) int_(t-r)^t G(s) ds
#     t from the start of the ramp, ln s at its mean
#     storage modulus  M = G'(omega)                               with t = 1/omega
#
# G/M depends on the shape of the spectrum only, and little on that. It is taken from the
# smooth spectrum through G, found from the ratio before, until it settles. After a ramp G
# is not sought at t but at the mean of ln s over the ramp, where the ratio is nearly 1
# for any spectrum: just behind the ramp, that is well before t.
# --------------------------------------------------------------------------------------

_ROUNDS = 12
_SETTLED = 2e-3  # change of ln(ratio) at which it counts as found
_DEGREE = 3  # of the polynomial whose slope gives the first ratio
_STEEPEST = 0.9  # slope d(ln M)/d(ln t) that the first ratio is made for


def as_relaxation(dma: Dma, law: AbstractShift | None) -> Dma:
    """The same measurement with its response turned into relaxation; itself where it is
    relaxation.
    """
    if (dma.response == "relaxation" and not dma.ramp) or not dma.time.size:
        return dma
    ratio, time = _first(dma), _middle(dma.time, dma.ramp)
    near = None
    for _ in range(_ROUNDS):
        relaxation = replace(
            dma,
            time=time,
            relaxation=dma.relaxation * ratio,
            response="relaxation",
            ramp=0.0,
        )
        data = isotherms(relaxation, law)
        near = rough_shifts(data, law, near)
        before, ratio = ratio, _ratio(dma, time, data, near)
        if np.abs(np.log(ratio / before)).max() < _SETTLED:
            break
    words = f"{dma.described}, as relaxation by the spectrum"
    return replace(
        dma,
        time=time,
        relaxation=dma.relaxation * ratio,
        response="relaxation",
        ramp=0.0,
        columns=tuple(f"{column}; {words}" for column in dma.columns),
    )


def _first(dma: Dma) -> np.ndarray:
    """G/M of a power law with the slope that each isotherm has."""
    number, mean = group(dma.time_temperature)
    ratio = np.ones(dma.time.size)
    for i in range(mean.size):
        indices = np.flatnonzero(number == i)
        u = np.log(dma.time[indices])
        if np.unique(u).size < _DEGREE + 2:
            continue
        curve = np.polynomial.Polynomial.fit(
            u, np.log(dma.relaxation[indices]), _DEGREE
        )
        m = np.clip(-curve.deriv()(u), 1e-3, _STEEPEST)
        if dma.response == "creep":
            ratio[indices] = np.sinc(m)
    return ratio


def _middle(time: np.ndarray, ramp: float) -> np.ndarray:
    """The mean of ln s between t - ramp and t, as a time."""
    if not ramp:
        return time
    early = time - ramp
    return np.exp((time * np.log(time) - early * np.log(early)) / ramp - 1)


def _ratio(dma: Dma, time: np.ndarray, data: Isotherms, shifts: Shifts) -> np.ndarray:
    """G/M of a smooth spectrum at the times of all points."""
    p = shifts.posterior.mean
    times = np.exp(shifts.log_times + p[shifts.places])
    order = np.argsort(times)
    series = Prony(
        float(np.exp(p[shifts.equilibrium])),
        np.exp(p[shifts.spectrum])[order],
        times[order],
    )
    timed = slice(2 * dma.omega.size, None)
    shift = (
        shifts.horizontal(p)[0][data.points.isotherm[timed]] + data.points.offset[timed]
    )
    factor = np.exp(-LN10 * shift)
    reduced = dma.time * factor
    wanted = np.asarray(series.relaxation(time * factor))
    if dma.response == "creep":
        return wanted * np.asarray(series.creep_compliance(reduced))
    if dma.response == "storage":
        return wanted / np.asarray(series.storage(1 / reduced))
    return wanted / _after_ramp(series, reduced, dma.ramp * factor)


def _after_ramp(series: Prony, time: np.ndarray, ramp: np.ndarray) -> np.ndarray:
    """(1/r) int_(t-r)^t G(s) ds."""
    x, r = time[:, None] / series.times, ramp[:, None] / series.times
    mean = np.exp(-(x - r)) * -np.expm1(-r) / r
    return float(series.equilibrium) + mean @ np.asarray(series.moduli)


# --------------------------------------------------------------------------------------
# From the points of a master curve, which overlap and scatter, to a table of
# moduli.
# --------------------------------------------------------------------------------------

_MOST = 100  # bands per decade


def tabulate(
    master: "MasterCurve",
    per_decade: int,
    shift: AbstractShift | None,
    vertical: AbstractVertical | None,
    poisson: Number,
    name: str,
    citation: str,
) -> TabulatedModulus:
    """A table from the shifted data: in each band of log omega the means of log omega,
    log storage and log loss.
    """
    whole_number("per_decade", per_decade, 1, _MOST)
    logs = np.log([master.omega, master.storage, master.loss])
    band = np.floor(
        per_decade * (logs[0] - logs[0].min(initial=np.inf)) / np.log(10)
    ).astype(int)
    numbers = np.unique(band)
    if numbers.size < 3:
        raise InputError(
            argument="master",
            got=numbers.size,
            accepted="in three bands of frequency or more, with storage and loss "
            "moduli",
            hint=f"there are {master.omega.size} points",
        )
    omega, storage, loss = np.exp(
        [logs[:, band == number].mean(axis=1) for number in numbers]
    ).T
    table = TabulatedModulus(
        omega,
        storage,
        loss,
        kind=master.kind,
        poisson=poisson,
        shift=shift,
        vertical=vertical,
        name=name,
        citation=citation,
    )
    stored, lost = table.storage(master.omega), table.loss(master.omega)
    scatter = misfit_bands(
        master.omega, stored / master.storage - 1, lost / master.loss - 1
    )
    known = Range(
        (float(omega[0]), float(omega[-1])), master.measured_at, misfit=scatter
    )
    return replaced(table, range=known)


# --------------------------------------------------------------------------------------
# Time-temperature superposition: isotherms become one master curve, with the
# uncertainty of every shift.
# --------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False, repr=False)
class MasterCurve(AbstractWithTable):
    """Isotherms shifted to one reference temperature: b_T M(omega; T) = M(omega a_T;
    T_ref).

    There is one entry per isotherm in `temperature`, `log10_a`, `log10_b`, their
    standard deviations and `ambiguous`, and one per measured point in `omega` and the
    fields after it. A standard deviation covers noise, the freedom of the vertical
    shift, the choice whether there is any, and the error of the isotherms'
    temperatures. `warnings` says in words what cannot be relied on.
    """

    reference: float  # T_ref [K]
    kind: Kind
    # mean temperature of each isotherm, ascending [K]
    temperature: Float[np.ndarray, " n"]
    # horizontal shift, 0 at the reference temperature [decades]
    log10_a: Float[np.ndarray, " n"]
    log10_a_std: Float[np.ndarray, " n"]
    log10_b: Float[np.ndarray, " n"]  # vertical shift, 0 at the reference temperature
    log10_b_std: Float[np.ndarray, " n"]
    covariance: Float[np.ndarray, "n n"]  # of log10_a
    # where horizontal and vertical shift cannot be separated
    ambiguous: Bool[np.ndarray, " n"]
    laws: dict[str, LawFit]  # "WLF", "Arrhenius", "VFT": those that could be fitted
    omega: Float[np.ndarray, " m"]  # reduced angular frequency omega a_T [rad/s]
    storage: Float[np.ndarray, " m"]  # b_T times storage modulus [Pa]
    loss: Float[np.ndarray, " m"]  # b_T times loss modulus [Pa]
    isotherm: Int[np.ndarray, " m"]  # number of the isotherm of each point
    time: Float[np.ndarray, " k"]  # reduced time t/a_T [s]
    relaxation: Float[np.ndarray, " k"]  # b_T times relaxation modulus [Pa]
    time_isotherm: Int[np.ndarray, " k"]
    # relative standard deviation of the data about the curve, per kind of modulus
    noise: dict[str, float]
    warnings: tuple[str, ...]
    converged: bool
    source: str
    dma: Dma
    given: str  # the shift law that the user gave, in words; "" where the data gave it
    joint: Joint  # the posterior of spectrum and shifts that all of this is read from
    state: AtReference

    @property
    def wlf(self) -> WLF | None:
        """The WLF law (`em.WLF`) about the reference temperature; None where it could
        not be fitted.
        """
        return self._law("WLF")

    @property
    def arrhenius(self) -> Arrhenius | None:
        """The Arrhenius law (`em.Arrhenius`) about the reference temperature; None
        where it could not be fitted.
        """
        return self._law("Arrhenius")

    @property
    def vft(self) -> VFT | None:
        """The VFT law (`em.VFT`) about the reference temperature; None where it could
        not be fitted.
        """
        return self._law("VFT")

    def _law(self, name: str) -> Any:
        return self.laws[name].law if name in self.laws else None

    @property
    def log10_a_interval(self) -> Float[np.ndarray, "n 2"]:
        """95 % interval of log10 a_T, low and high."""
        return self.log10_a[:, None] + np.outer(
            self.log10_a_std, [-TWO_SIGMA, TWO_SIGMA]
        )

    @property
    def window(self) -> tuple[float, float]:
        """Lowest and highest reduced angular frequency of the data; for relaxation, 1/t
        [rad/s].
        """
        rates = np.concatenate([self.omega, 1 / self.time])
        return float(rates.min()), float(rates.max())

    @property
    def measured_at(self) -> tuple[float, float]:
        """Lowest and highest temperature of the data, at least 1 K apart, rounded as a
        material has them [K].
        """
        ends = self.temperature.min(), self.temperature.max()
        cold, warm = (round(float(x), TEMPERATURE_DIGITS) for x in ends)
        return (cold, warm) if cold < warm else (cold - 0.5, warm + 0.5)

    def at_reference(self, temperature: float) -> "MasterCurve":
        """The same master curve about another reference temperature [K]."""
        temperature = float(scalar("temperature", temperature))
        positive("temperature", temperature)
        return _assemble(self.dma, self.joint, temperature, self.ambiguous, self.given)

    @one_thread()
    def without_vertical(self) -> "MasterCurve":
        """The same isotherms shifted along the frequency only.

        As `master_curve(..., vertical=False)` does, but the uncertainty contains what
        vertical shifts would change, and `ambiguous` says still where they cannot be
        separated.
        """
        return _assemble(
            self.dma,
            without_vertical(self.joint),
            self.reference,
            self.ambiguous,
            self.given,
        )

    @one_thread()
    def with_entropy(self) -> "MasterCurve | None":
        """The same isotherms with b_T = T_ref/T, as of entropy elasticity; None where
        the data ask for other shifts.
        """
        joint = entropic(self.joint)
        return (
            None
            if joint is None
            else _assemble(self.dma, joint, self.reference, self.ambiguous, self.given)
        )

    def band(self, omega: ArrayLike) -> DynamicBand:
        """The smooth curve through the data with its 95 % intervals, at angular
        frequencies [rad/s], any shape.

        The intervals contain the uncertainty of the shifts. Outside `window` the curve
        is an extrapolation: `inside` says so point by point, and a `FitWarning` counts
        them. Raises `InputError` for frequencies that are not positive.
        """
        return dynamic_band(self.joint, self.state, self.window, omega)

    def relaxation_band(self, time: ArrayLike) -> RelaxationBand:
        """The smooth relaxation modulus with its 95 % interval, at times [s] of any
        shape; otherwise as `band`.
        """
        return relaxation_band(self.joint, self.state, self.window, time)

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws the shifted data with curve and band on `ax`, or on a new figure, in a
        style of `Result.plot`; returns matplotlib Axes.
        """
        from .drawing import celsius, draw_band, of_moduli

        dynamic, (low, high) = bool(self.omega.size), self.window
        title = f"Master curve at {celsius(self.reference)}"
        made = of_moduli(self.kind, dynamic, title, self.source, ax, style)
        self.draw_points(made)
        band = (
            self.band(np.geomspace(low, high, 300))
            if dynamic
            else self.relaxation_band(np.geomspace(1 / high, 1 / low, 300))
        )
        draw_band(made, band, "smooth spectrum")
        return made.finish()

    def draw_points(self, made: Sketch) -> None:
        """Draws the shifted data, one colour for each temperature."""
        from .drawing import DrawnIsotherms, draw_isotherms

        every = [
            DrawnIsotherms(self.omega, self.storage, self.isotherm, "storage modulus"),
            DrawnIsotherms(
                self.omega, self.loss, self.isotherm, "loss modulus", "s", "none"
            ),
        ]
        if not self.omega.size:
            measured = self.time, self.relaxation, self.time_isotherm
            every = [DrawnIsotherms(*measured, "relaxation modulus")]
        draw_isotherms(made, self.temperature, self.reference, every)

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the shifts, as pairs of a name and a text."""
        yield "data", self.dma.summary()
        yield "strain", strains(self.dma.strain) or "amplitude not known"
        yield "reference", f"{significant(self.reference - 273.15, 5)} degC"
        low, high = self.window
        yield (
            "reduced window",
            f"{low:.3g} to {high:.3g} rad/s, {np.log10(high / low):.1f} decades",
        )
        yield (
            "scatter",
            ", ".join(
                f"{name} {100 * size:.2g} %" for name, size in self.noise.items()
            ),
        )
        if self.temperature.size > 1:
            yield (
                "temperatures",
                (
                    f"known to +- {TWO_SIGMA * self.state.temperature_error:.2g} K "
                    "(95 %), "
                    "which all intervals contain"
                ),
            )
        vertical = [
            (
                f"   log10 b_T {y:7.4f} +- "
                f"{TWO_SIGMA * std:.4f}{'  (not separable)' * bool(mark)}"
            )
            for y, std, mark in zip(
                self.log10_b, self.log10_b_std, self.ambiguous, strict=True
            )
            if (np.abs(self.log10_b) + self.log10_b_std > 1e-4).any()
        ]
        if self.given:
            yield "shift factors", self.given
        if not self.given or (np.abs(self.log10_b) > 1e-4).any():
            yield from shifts_in_words(
                self.temperature,
                self.log10_a,
                self.log10_a_std,
                self.laws,
                vertical,
            )
        for warning in self.warnings:
            yield "warning", warning

    def header(self) -> list[str]:
        """Title, units, intervals and findings, and the rows left out."""
        left_out = (("row left out", row) for row in self.dma.bad_rows)
        return header_of("MasterCurve", [*self.findings(), *left_out])

    def columns(self) -> dict[str, np.ndarray]:
        """Shifted data, one row per point."""
        symbol = "G" if self.kind == "shear" else "E"
        if self.omega.size:
            order = np.argsort(self.omega, kind="stable")
            return {
                "reduced angular frequency [rad/s]": self.omega[order],
                f"storage modulus {symbol}' times b_T [Pa]": self.storage[order],
                f"loss modulus {symbol}'' times b_T [Pa]": self.loss[order],
                "isotherm [K]": self.temperature[self.isotherm[order]],
            }
        order = np.argsort(self.time, kind="stable")
        return {
            "reduced time [s]": self.time[order],
            f"relaxation modulus {symbol} times b_T [Pa]": self.relaxation[order],
            "isotherm [K]": self.temperature[self.time_isotherm[order]],
        }


@in_si
@one_thread()
def master_curve(
    dma: Dma,
    reference: float | None = None,
    vertical: bool = True,
    *,
    shift: AbstractShift | Literal["universal"] | None = None,
    temperature_error: float | None = None,
) -> MasterCurve:
    """Shifts all isotherms jointly to one reference temperature.

    Storage and loss modulus (and relaxation, where there is any) of every isotherm
    share one non-negative smooth spectrum, and horizontal shifts fall with temperature.
    Temperatures with no gap above 1.5 K are one isotherm.

    Args:
        dma: the measurement, with temperatures.
        reference: reference temperature [K]; by default the measured temperature
            nearest to 20 degC. Outside the data it is reached by a shift law, whose
            uncertainty enters.
        vertical: vertical shifts between none and those of entropy elasticity, with a
            free part as wide as the data need; False for none.
        shift: a law that the shifts follow as it is, with which temperature sweeps at
            one frequency have a master curve as well: `em.WLF`, ..., factors shifted by
            hand (`em.read_shifts`), or "universal", WLF's law with universal constants
            about the T_g at which storage and loss modulus suit each other best. By
            default the data decide.
        temperature_error: standard error of the temperature of an isotherm [K], part of
            every interval; by default what the scatter of the shift factors about a law
            says, and 0.3 K where it says nothing.

    Returns:
        A `MasterCurve` with shifts, laws, uncertainties and warnings.

    Raises:
        InputError: for anything but a `Dma` with temperatures, or a reference that is
            no temperature or further outside than the law can carry the data.

    Source: `docs/fitting.md`.
    """
    check_dma(dma)
    if temperature_error is not None:
        temperature_error = float(scalar("temperature_error", temperature_error))
        not_negative("temperature_error", temperature_error)
    if reference is not None:
        reference = float(scalar("reference", reference))
        # liquid nitrogen is colder than any reference
        in_kelvin("reference", reference, 70.0)
    dma, means = gathered(dma)
    dma, left = of_one_strain(dma)
    if shift is not None and not isinstance(shift, AbstractShift):
        # whether there are temperatures at all
        isotherms(dma, Arrhenius(1e5, 293.15))
    law, origin = given_law(shift, dma)
    dma = as_relaxation(dma, law)
    sorted_dma = isotherms(dma, law)
    refuse_exchanged(dma, law)
    if (once := without_copies(dma)) is not dma:
        dma, sorted_dma = once, isotherms(once, law)
    if reference is None:
        reference = float(
            sorted_dma.temperature[np.argmin(np.abs(sorted_dma.temperature - 293.15))]
        )
    dma = replace(dma, warnings=(*dma.warnings, *means, *left))
    given = f"{words(law)}, {origin}" if law is not None else ""
    joint = fit_jointly(sorted_dma, bool(vertical), law, temperature_error)
    master = _assemble(dma, joint, reference, None, given)
    tell((*means, *left, *master.warnings))
    return master


def _assemble(
    dma: Dma,
    joint: Joint,
    reference: float,
    ambiguous: np.ndarray | None = None,
    given: str = "",
) -> MasterCurve:
    shifts, state = joint.shifts, at_reference(joint, reference)
    points = shifts.points
    reduced = points.log_rate + LN10 * (state.log10_a[points.isotherm] + points.offset)
    lifted = np.exp(points.log_value + state.ln_b[points.isotherm])
    by_channel = [points.channel == which for which in (STORAGE, LOSS, RELAXATION)]
    noise = {
        name: float(np.sqrt(np.mean(shifts.posterior.residuals[where] ** 2)))
        for name, where in zip(CHANNELS, by_channel, strict=True)
        if where.any()
    }
    if ambiguous is None:
        ambiguous = ~separable(joint)
    judged = JudgedShifts(dma, joint, state, reference, ambiguous, noise, reduced)
    return MasterCurve(
        reference=reference,
        kind=dma.kind,
        temperature=shifts.temperature,
        log10_a=state.log10_a,
        log10_a_std=np.sqrt(np.maximum(np.diag(state.covariance), 0.0)),
        log10_b=state.ln_b / LN10,
        log10_b_std=state.ln_b_std / LN10,
        covariance=state.covariance,
        ambiguous=ambiguous,
        laws=state.laws,
        omega=np.exp(reduced[by_channel[STORAGE]]),
        storage=lifted[by_channel[STORAGE]],
        loss=lifted[by_channel[LOSS]],
        isotherm=points.isotherm[by_channel[STORAGE]],
        time=np.exp(-reduced[by_channel[RELAXATION]]),
        relaxation=lifted[by_channel[RELAXATION]],
        time_isotherm=points.isotherm[by_channel[RELAXATION]],
        noise=noise,
        warnings=tuple(of_shifts(judged)),
        converged=shifts.posterior.converged,
        source=dma.source,
        dma=dma,
        given=given,
        joint=joint,
        state=state,
    )


def shifts_csv(master: MasterCurve) -> str:
    """Shift factors with their standard deviations, one row per isotherm."""
    columns = {
        "temperature [K]": master.temperature,
        "log10 a_T [-]": master.log10_a,
        "standard deviation of log10 a_T [-]": master.log10_a_std,
        "log10 b_T [-]": master.log10_b,
        "standard deviation of log10 b_T [-]": master.log10_b_std,
        "separable": ~master.ambiguous,
    }
    said = ("reference", f"{master.reference:.10g} K"), ("source", master.source)
    return csv_text(header_of("shift factors", said), columns)


def check_dma(dma: object) -> None:
    """Raises `InputError` for what is no measurement."""
    if not isinstance(dma, Dma):
        raise InputError(
            argument="dma", got=dma, accepted="a Dma, as em.read_dma returns it"
        )
