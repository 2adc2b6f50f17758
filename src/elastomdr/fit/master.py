"""Time-temperature superposition: isotherms become one master curve, with the
uncertainty of every shift.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ..arrays import one_thread
from ..checks import in_kelvin, in_si, not_negative, positive, scalar, significant
from ..errors import InputError
from ..io.data import Dma, of_one_strain, strains, without_copies
from ..material.shift import AbstractShift, Arrhenius
from ..material.tabulated import TabulatedModulus
from .bands import Band, RelaxationBand, dynamic_band, relaxation_band
from .chosen_law import TEMPERATURE_DIGITS, check_law, shift_law, vertical_law
from .findings import TWO_SIGMA, AbstractFindings, of_shifts
from .given_law import given_law, words
from .isotherms import isotherms
from .joint import AtReference, Joint, about, entropic, fit_jointly, without_vertical
from .judge import judge
from .laws import LawFit
from .responses import as_relaxation
from .separable import separable
from .shifting import LN10
from .spectrum import CHANNELS, LOSS, RELAXATION, STORAGE
from .swapped import refuse_swapped
from .tabulate import tabulate

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Kind, LawName, Number, Style
    from ..material.shift import VFT, WLF


@dataclass(frozen=True, eq=False, repr=False)
class MasterCurve(AbstractFindings):
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
    def log10_b_interval(self) -> Float[np.ndarray, "n 2"]:
        """95 % interval of log10 b_T, low and high."""
        return self.log10_b[:, None] + np.outer(
            self.log10_b_std, [-TWO_SIGMA, TWO_SIGMA]
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

    def tabulated(
        self,
        *,
        per_decade: int = 8,
        law: LawName = "auto",
        poisson: Number = 0.5,
        name: str = "",
        citation: str = "",
    ) -> TabulatedModulus:
        """The shifted data as a material for steady models of surfaces, averaged in
        bands of log omega.

        Args:
            per_decade: bands per decade of frequency, from 1 to 100. A band without
                data is left out.
            law: the shift law, as for `em.fit.material`: "auto", "WLF", "Arrhenius",
                "VFT", "table" or "none".
            poisson: Poisson's ratio of the material, constant.
            name: what tables and figures call it.
            citation: where the data come from.

        Returns:
            A table of moduli of the kind of the data. Its `interpolation_error` is that
            of the cubics between the bands; how far the data scatter about it is its
            misfit (`elastomdr.material.validity.misfit`).

        Raises `InputError` for relaxation data, or fewer than three bands with data.
        """
        check_law(law)
        return tabulate(
            self,
            per_decade,
            shift_law(self, law)[1],
            vertical_law(self),
            poisson,
            name,
            citation,
        )

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

    def band(self, omega: ArrayLike) -> Band:
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
        from .figures import draw_master

        return draw_master(self, ax, style)

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
                "thermometer",
                (
                    f"isotherms to +- {TWO_SIGMA * self.state.thermometer:.2g} K (95 "
                    "%), "
                    "in all intervals"
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
        ]
        if self.given:
            yield "shift factors", self.given
        if not self.given or (np.abs(self.log10_b) > 1e-4).any():
            yield from of_shifts(
                self.temperature, self.log10_a, self.log10_a_std, self.laws, vertical
            )
        for text in self.warnings:
            yield "warning", text

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the shifted data, one row per point, with the shifts in header lines
        that start with "# ".
        """
        from ..files import write_files
        from .tables import master_csv

        write_files({Path(path): master_csv(self).encode()})


@in_si
@one_thread()
def master_curve(
    dma: Dma,
    reference: float | None = None,
    vertical: bool = True,
    *,
    shift: AbstractShift | Literal["universal"] | None = None,
    tolerance: float = 1.5,
    temperature_error: float | None = None,
) -> MasterCurve:
    """Shifts all isotherms jointly to one reference temperature.

    Storage and loss modulus (and relaxation, where there is any) of every isotherm
    share one non-negative smooth spectrum, and horizontal shifts fall with temperature.

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
        tolerance: temperatures with no gap above it [K] are one isotherm.
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
    if not isinstance(dma, Dma):
        raise InputError(
            f"dma must be a Dma, as em.read_dma returns it, got {type(dma).__name__}."
        )
    if not isinstance(vertical, (bool, np.bool_)):
        raise InputError(f"vertical must be True or False, got {vertical!r}.")
    tolerance = float(scalar("tolerance", tolerance))
    positive("tolerance", tolerance)
    if temperature_error is not None:
        temperature_error = float(scalar("temperature_error", temperature_error))
        not_negative("temperature_error", temperature_error)
    if reference is not None:
        reference = float(scalar("reference", reference))
        # liquid nitrogen is colder than any reference
        in_kelvin("reference", reference, 70.0)
    dma, left = of_one_strain(dma)
    if shift is not None and not isinstance(shift, AbstractShift):
        # whether there are temperatures at all
        isotherms(dma, tolerance, Arrhenius(1e5, 293.15))
    law, origin = given_law(shift, dma)
    dma = as_relaxation(dma, tolerance, law)
    sorted_dma = isotherms(dma, tolerance, law)
    refuse_swapped(dma, law)
    if (once := without_copies(dma)) is not dma:
        dma, sorted_dma = once, isotherms(once, tolerance, law)
    if reference is None:
        reference = float(
            sorted_dma.temperature[np.argmin(np.abs(sorted_dma.temperature - 293.15))]
        )
    dma = replace(dma, warnings=(*dma.warnings, *left))
    given = f"{words(law)}, {origin}" if law is not None else ""
    joint = fit_jointly(sorted_dma, bool(vertical), law, temperature_error)
    return _assemble(dma, joint, reference, None, given)


def _assemble(
    dma: Dma,
    joint: Joint,
    reference: float,
    ambiguous: np.ndarray | None = None,
    given: str = "",
) -> MasterCurve:
    shifts, state = joint.shifts, about(joint, reference)
    points = shifts.points
    reduced = points.log_rate + LN10 * (state.log10_a[points.isotherm] + points.offset)
    lifted = np.exp(points.log_value + state.ln_b[points.isotherm])
    at = [points.channel == which for which in (STORAGE, LOSS, RELAXATION)]
    master = MasterCurve(
        reference=reference,
        kind=dma.kind,
        temperature=shifts.temperature,
        log10_a=state.log10_a,
        log10_a_std=np.sqrt(np.maximum(np.diag(state.covariance), 0.0)),
        log10_b=state.ln_b / LN10,
        log10_b_std=state.ln_b_std / LN10,
        covariance=state.covariance,
        ambiguous=~separable(joint) if ambiguous is None else ambiguous,
        laws=state.laws,
        omega=np.exp(reduced[at[STORAGE]]),
        storage=lifted[at[STORAGE]],
        loss=lifted[at[LOSS]],
        isotherm=points.isotherm[at[STORAGE]],
        time=np.exp(-reduced[at[RELAXATION]]),
        relaxation=lifted[at[RELAXATION]],
        time_isotherm=points.isotherm[at[RELAXATION]],
        noise={
            name: float(np.sqrt(np.mean(shifts.posterior.residuals[where] ** 2)))
            for name, where in zip(CHANNELS, at, strict=True)
            if where.any()
        },
        warnings=(),
        converged=shifts.posterior.converged,
        source=dma.source,
        dma=dma,
        given=given,
        joint=joint,
        state=state,
    )
    return replace(master, warnings=judge(master))
