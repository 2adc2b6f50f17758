"""What a fit reports: its findings in words, curves with 95 % intervals, tables, and
material cards for finite-element programs.
"""

from __future__ import annotations

import abc
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from .. import __version__
from ..checks import as_float64, in_si, positive, whole_number
from ..errors import InputError, warn
from ..files import no_formula
from ..io.data import FitWarning
from ..material.prony import Prony
from ..material.shift import VFT, WLF, Arrhenius
from ..material.tabulated import needs_series
from ..notebook_tables import html_figure, html_table
from ..results.base import WithTable
from .laws import LawFit
from .shifting import AtReference, Joint, curve
from .spectrum import LOSS, RELAXATION, STORAGE

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike

# --------------------------------------------------------------------------------------
# What all results of a fit print in words, shift factors among it.
# --------------------------------------------------------------------------------------

PLUS_MINUS = "+- is half a 95 % interval: 1.96 standard deviations"
# a 95 % interval is the value plus and minus this many standard deviations
TWO_SIGMA = 1.96


def tell(doubts: Iterable[str]) -> None:
    """Issues each doubt of a result, which its summary prints, as a `FitWarning` too."""
    for doubt in doubts:
        warn(doubt, FitWarning)


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
        lines = [f"{name:<16}{sentence}" for name, sentence in self.findings()]
        return "\n".join([f"{'intervals':<16}{self.intervals}", *lines])

    def __repr__(self) -> str:
        return f"{type(self).__name__}\n{self.summary()}"

    def _repr_html_(self) -> str:
        table = html_table(
            type(self).__name__, [("intervals", self.intervals), *self.findings()]
        )
        plot = getattr(self, "plot", None)
        return table if plot is None else table + html_figure(plot(style="paper"))


class AbstractWithTable(AbstractFindings, WithTable):
    """One that has a table."""

    title: ClassVar[str]  # of the table

    def header(self) -> list[str]:
        """Title, units, intervals and findings."""
        return header_of(self.title, self.findings(), self.intervals)


def shifts_in_words(
    temperature: np.ndarray,
    log10_a: np.ndarray,
    std: np.ndarray,
    laws: Mapping[str, LawFit],
    more: Sequence[str] = (),
) -> Iterator[tuple[str, str]]:
    """A line per temperature, with `more` text behind it, and one per shift law."""
    more = more or [""] * temperature.size
    for value, x, size, remark in zip(temperature, log10_a, std, more, strict=True):
        yield (
            f"{value - 273.15:8.2f} degC",
            f"log10 a_T {x:8.3f} +- {TWO_SIGMA * size:.3f}{remark}",
        )
    for name, fit in laws.items():
        yield name, f"{fit.constants()}; rms residual {fit.rms:.3f} decades"


# --------------------------------------------------------------------------------------
# Curves with 95 % intervals: storage and loss modulus over frequency, relaxation over
# time.
# --------------------------------------------------------------------------------------


class DynamicBand(NamedTuple):
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
    omega: ArrayLike,
    series: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]] | None = None,
) -> DynamicBand:
    """The smooth curve of a joint fit, or a `series` through it, whose interval grows
    by its distance to the curve.
    """
    omega = np.asarray(as_float64("omega", omega))
    positive("omega", omega)
    flat = np.atleast_1d(omega).ravel()
    of_series = None if series is None else np.concatenate(series(flat))
    values = _interval(
        joint,
        state,
        np.tile(np.log(flat), 2),
        np.repeat([STORAGE, LOSS], flat.size),
        of_series,
    )
    # storage, loss, then both limits of either
    parts = [half for value in values for half in np.split(value, 2)]
    inside = _check_outside(flat, window, "frequencies")
    ordered = (*parts[0::2], *parts[1::2], inside)
    return DynamicBand(omega, *(bound.reshape(omega.shape) for bound in ordered))


def relaxation_band(
    joint: Joint,
    state: AtReference,
    window: tuple[float, float],
    time: ArrayLike,
    series: Callable[[np.ndarray], np.ndarray] | None = None,
) -> RelaxationBand:
    """The same of the relaxation modulus."""
    time = np.asarray(as_float64("time", time))
    positive("time", time)
    flat = np.atleast_1d(time).ravel()
    of_series = None if series is None else series(flat)
    values = _interval(
        joint, state, -np.log(flat), np.full(flat.size, RELAXATION), of_series
    )
    inside = _check_outside(1 / flat, window, "times")
    return RelaxationBand(
        time, *(bound.reshape(time.shape) for bound in (*values, inside))
    )


def _interval(
    joint: Joint,
    state: AtReference,
    log_rate: np.ndarray,
    channel: np.ndarray,
    of_series: np.ndarray | None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    smooth, std = curve(joint, state, log_rate, channel)
    value = smooth if of_series is None else np.log(of_series)
    std = np.sqrt(std**2 + (value - smooth) ** 2)
    return (
        np.exp(value),
        np.exp(value - TWO_SIGMA * std),
        np.exp(value + TWO_SIGMA * std),
    )


def _check_outside(
    rate: np.ndarray, window: tuple[float, float], quantity: str
) -> np.ndarray:
    """Whether rates [rad/s] lie inside the measured window; those outside are counted
    in one `FitWarning`.
    """
    inside = (rate >= window[0] * (1 - 1e-9)) & (rate <= window[1] * (1 + 1e-9))
    if not inside.all():
        warn(
            f"{int((~inside).sum())} of {inside.size} {quantity} are extrapolated: "
            "they "
            f"lie outside the measured {window[0]:.3g} to {window[1]:.3g} rad/s.",
            FitWarning,
        )
    return inside


# --------------------------------------------------------------------------------------
# What stands above tables.
# --------------------------------------------------------------------------------------


def header_of(
    title: str, findings: Iterable[tuple[str, str]], intervals: str = PLUS_MINUS
) -> list[str]:
    """The lines above a table of a fit."""
    return [
        f"elastomdr {__version__}: {title}",
        "units: SI, in brackets in the column titles",
        f"intervals: {intervals}; a column of standard deviations holds one of them",
        *(" ".join(f"{name.strip()}: {said}".split()) for name, said in findings),
    ]


# --------------------------------------------------------------------------------------
# Material cards of a Prony series for finite-element programs: text, in SI units (Pa,
# s, K).
#
# Formats as in the Abaqus Keywords Guide (*ELASTIC, *HYPERELASTIC, *VISCOELASTIC, *TRS)
# and the Mechanical APDL command reference (TB,PRONY: pairs of relative modulus and time,
# at most 100; TB,SHIFT), in PyDyna (the fields of *MAT_GENERAL_VISCOELASTIC) and in the
# configuration of OpenRadioss (those of /MAT/LAW42 and /VISC/PRONY). Not run in any of
# these programs.
# --------------------------------------------------------------------------------------

# equilibrium part that stands for zero where a program wants the sum of the parts below
# 1
_FLOOR = 1e-6
_NO_TABLE = (
    "only at this temperature: the shift law of the material is not in this card"
)
_LABEL = 70  # characters of a name; Abaqus takes 80, and wants a letter first
_INCOMPRESSIBLE = 0.499  # Poisson's ratio above which bulk parts are left out
_EXPLICIT = 0.4995  # stands for 0.5 in explicit programs
DYNA_TERMS = 18  # of *MAT_GENERAL_VISCOELASTIC, with the equilibrium modulus


_RUBBER = "model.physics('solid').feature('rubber')"
_COMSOL = f"""\
% choose the domains; in two dimensions write 2 for 3
model.param.set('T_rubber', '{{}}');
model.param.set('a_T', '{{}}');
model.physics('solid').create('rubber', 'LinearElasticModel', 3);
{_RUBBER}.set('IsotropicOption', 'KG');
{_RUBBER}.set('K_mat', 'userdef');
{_RUBBER}.set('G_mat', 'userdef');
{_RUBBER}.set('K', '{{:.10g}}[Pa]');
{_RUBBER}.set('G', '{{:.10g}}[Pa]');
"""
_COMSOL_TERMS = f"""\
{_RUBBER}.create('vis1', 'Viscoelasticity', 3);
{_RUBBER}.feature('vis1').set('Gvm', {{{{{{}}}}}});
{_RUBBER}.feature('vis1').set('tauvm', {{{{{{}}}}}});
"""


def abaqus_card(material: Prony) -> str:
    """Abaqus keywords *ELASTIC or *HYPERELASTIC, *VISCOELASTIC and *TRS for a material
    at its reference temperature.

    Parts are relative to the instantaneous modulus. A constant Poisson's ratio below
    0.5 gives shear and bulk the same parts; an incompressible material gets none in
    bulk and a neo-Hookean law.

    Args:
        material: the material, a `Prony`.

    Returns:
        The lines of the card.

    Raises:
        InputError: for a parallel dashpot, and for a constant bulk modulus.
    """
    name, shear, poisson, parts, notes = _parts(material)
    lines = [f"** {note}" for note in notes] + [f"*MATERIAL, NAME={name}"]
    bulk = np.zeros_like(parts) if poisson > _INCOMPRESSIBLE else parts
    if poisson > _INCOMPRESSIBLE:
        lines += [
            "*HYPERELASTIC, NEO HOOKE, MODULI=INSTANTANEOUS",
            f"{shear / 2:.8g}, 0.",
        ]
    else:
        lines += [
            "*ELASTIC, MODULI=INSTANTANEOUS",
            f"{2 * (1 + poisson) * shear:.8g}, {poisson:.6g}",
        ]
    lines.append("*VISCOELASTIC, TIME=PRONY")
    for g, k, time in zip(parts, bulk, material.times, strict=True):
        lines.append(f"{g:.12g}, {k:.12g}, {float(time):.8g}")
    law = _as_wlf(material)
    if law is not None:
        values = [f"{float(v):.8g}" for v in (law.reference, law.c1, law.c2)]
        lines += [
            "** log10 a_T = -C1 (T - T_0)/(C2 + T - T_0), T in K",
            "*TRS, DEFINITION=WLF",
            ", ".join(values),
        ]
    elif isinstance(material.shift, Arrhenius):
        energy = float(material.shift.energy)
        reference = float(material.shift.reference)
        lines += [
            (
                "** energy [J/mol]; set the gas constant and absolute zero with "
                "*PHYSICAL CONSTANTS"
            ),
            "*TRS, DEFINITION=ARRHENIUS",
            f"{reference:.8g}, {energy:.8g}",
        ]
    elif material.shift is not None:
        lines.insert(0, f"** {_NO_TABLE}")
    return "\n".join(lines) + "\n"


@in_si
def ansys_card(material: Prony, number: int = 1) -> str:
    """Mechanical APDL commands MP, TB,PRONY and TB,SHIFT for a material at its
    reference temperature.

    Args:
        material: the material, a `Prony`.
        number: number of the material in the model.

    Returns:
        The lines of the card.

    Raises:
        InputError: as `abaqus_card`.
    """
    name, shear, poisson, parts, notes = _parts(material)
    lines = [f"! {note}" for note in (name, *notes)]
    if poisson > _INCOMPRESSIBLE:
        lines.append(
            "! incompressible: nu = 0.4999 stands for 0.5; use elements with a "
            "mixed formulation"
        )
    lines += [
        f"MP,EX,{number},{2 * (1 + poisson) * shear:.8g}",
        f"MP,PRXY,{number},{min(poisson, 0.4999):.6g}",
    ]
    for which in ("SHEAR", "BULK") if poisson <= _INCOMPRESSIBLE else ("SHEAR",):
        lines.append(f"TB,PRONY,{number},1,{parts.size},{which}")
        for i, (share, time) in enumerate(zip(parts, material.times, strict=True)):
            lines.append(f"TBDATA,{2 * i + 1},{share:.12g},{float(time):.8g}")
    law = _as_wlf(material)
    if law is not None:
        lines += [
            (
                "! reduced time is A t, log10 A = C1 (T - Tref)/(C2 + T - Tref), T in "
                "K: A = 1/a_T"
            ),
            f"TB,SHIFT,{number},1,3,WLF",
            f"TBDATA,1,{float(law.reference):.8g},{float(law.c1):.8g},{float(law.c2):.8g}",
        ]
    elif material.shift is not None:
        lines.insert(0, f"! {_NO_TABLE}")
    return "\n".join(lines) + "\n"


@in_si
def dyna_card(material: Prony, number: int = 1) -> str:
    """LS-DYNA keyword *MAT_GENERAL_VISCOELASTIC (MAT_076) for a material at its
    reference temperature; to five digits, its density left blank.

    Its manual is quoted with "up to 18 terms", the text of PyDyna (2024) says "up to six
    cards": beyond six the card has a remark, at which no run stops.

    Args:
        material: the material, a `Prony` of at most 17 relaxation times.
        number: number of the material in the model.

    Returns:
        The lines of the card.

    Raises:
        InputError: as `abaqus_card`, and for more relaxation times.
    """
    card = _explicit(material, number)
    if len(card.terms) > DYNA_TERMS:
        raise InputError(
            argument="material",
            got=material,
            accepted=f"one of at most {DYNA_TERMS - 1} relaxation times for this card",
        )
    lines = [f"$ {note}" for note in card.notes]
    lines += ["$ more terms than six: check that all were read"] * (len(card.terms) > 6)
    lines += [
        "*MAT_GENERAL_VISCOELASTIC_TITLE",
        card.name,
        f"{int(number):10}{'':10}{card.bulk:10.5g}",
        "",
        *(f"{modulus:10.5g}{rate:10.5g}" for modulus, rate in card.terms),
    ]
    return "\n".join(lines) + "\n"


@in_si
def radioss_card(material: Prony, number: int = 1) -> str:
    """Radioss blocks /MAT/LAW42 and /VISC/PRONY for a material at its reference
    temperature, its density left blank.

    Args:
        material: the material, a `Prony`.
        number: number of the material in the model.

    Returns:
        The lines of the blocks.

    Raises:
        InputError: as `abaqus_card`.
    """
    card = _explicit(material, number)
    (equilibrium, _), *terms = card.terms
    rows = "".join(f"{g:20.10g}{rate:20.10g}{0:20}{0:20}\n" for g, rate in terms)
    notes = "".join(f"# {note}\n" for note in card.notes)
    law = (
        f"{notes}/MAT/LAW42/{int(number)}\n{card.name}\n{'':20}\n"
        f"{card.poisson:20.10g}{0:20}{'':10}{0:10}{0:20}{0:10}{0:10}\n"
        f"{equilibrium:20.10g}\n\n{2:20}\n\n"
    )
    if not terms:  # a block of no terms is refused
        return law
    order = f"{len(terms):10}{'':10}{0:20}{0:10}{0:10}"
    return f"{law}/VISC/PRONY/{int(number)}\n{order}\n{rows}"


def comsol_card(material: Prony) -> str:
    """COMSOL commands (LiveLink, a .m file) that add the material to a model with Solid
    Mechanics; names as in files that COMSOL 5.3 and 6.2 exported, not run in it.

    Relaxation times are shifted by a parameter, T_rubber, one temperature for all; a
    shift function of the node, for a field, is to be set by hand.

    Args:
        material: the material, a `Prony`.

    Returns:
        The lines of the file.

    Raises:
        InputError: as `abaqus_card`.
    """
    card = _explicit(material, 1)
    (equilibrium, _), *terms = card.terms
    a_t = "1"
    law = _as_wlf(material) or material.shift
    t_0 = f"{float(getattr(law, 'reference', 293.15)):.8g}[K]"
    over = f"(T_rubber-{t_0})"
    if isinstance(law, WLF):
        a_t = f"10^(-{float(law.c1):.8g}*{over}/({float(law.c2):.8g}[K]+{over}))"
    elif isinstance(law, Arrhenius):
        a_t = f"exp(-{float(law.energy):.8g}[J/mol]*{over}/(R_const*T_rubber*{t_0}))"
    notes = (f"% {x}\n" for x in card.notes if a_t == "1" or x != _NO_TABLE)
    text = "".join(notes) + _COMSOL.format(t_0, a_t, card.bulk, equilibrium)
    if not terms:
        return text
    g = " ...\n".join(f"'{modulus:.10g}[Pa]'" for modulus, _ in terms)
    tau = " ...\n".join(f"'a_T/{rate:.10g}[1/s]'" for _, rate in terms)
    return text + _COMSOL_TERMS.format(g, tau)


def plain_card(material: Prony) -> str:
    """Relaxation times and moduli as a comma-separated table, with the rest of the
    material in header lines.

    Args:
        material: the material, a `Prony`.

    Returns:
        The lines of the table.
    """
    _check_series(material, "a table of relaxation times")
    symbol = "G" if material.kind == "shear" else "E"
    notes = (material.name or "unnamed", *_describe(material))
    lines = [no_formula(f"# {note}") for note in notes]
    lines.append(f"# {symbol}(t) = {symbol}_inf + sum_k {symbol}_k exp(-t/tau_k)")
    lines.append(f"# {symbol}_inf [Pa]: {float(material.equilibrium):.10g}")
    lines.append(f"tau [s],{symbol} [Pa]")
    lines += [
        f"{float(t):.10g},{float(m):.10g}"
        for t, m in zip(material.times, material.moduli, strict=True)
    ]
    return "\n".join(lines) + "\n"


def _check_series(material: object, purpose: str) -> None:
    needs_series("material", material, purpose)
    if not isinstance(material, Prony):
        raise InputError(argument="material", got=material, accepted="a Prony")


class _CardParts(NamedTuple):
    """A series as cards have it."""

    name: str
    shear: float  # instantaneous shear modulus [Pa]
    poisson: float
    parts: np.ndarray  # of the modulus
    notes: list[str]


class _Explicit(NamedTuple):
    """A material as explicit programs have it."""

    name: str
    poisson: float  # of short times
    bulk: float  # [Pa]
    terms: list[tuple[float, float]]  # shear modulus [Pa] and rate [1/s], 0 first
    notes: list[str]


def _explicit(material: Prony, number: int) -> _Explicit:
    whole_number("number", number, 1, 10**9)  # of as many digits as a column takes
    name, shear, poisson, parts, notes = _parts(material)
    terms = [(shear * (1 - float(parts.sum())), 0.0)]
    terms += zip(shear * parts, 1 / np.asarray(material.times), strict=True)
    notes += [_NO_TABLE] * (material.shift is not None)
    notes += [
        f"bulk modulus constant, by at most {_EXPLICIT} for Poisson's ratio",
        "fill in the density, which the material does not say",
    ]
    poisson = min(poisson, _EXPLICIT)
    bulk = 2 * shear * (1 + poisson) / (3 * (1 - 2 * poisson))
    return _Explicit(name, poisson, bulk, terms, notes)


def _parts(material: Prony) -> _CardParts:
    _check_series(material, "a card of Prony terms")
    if float(material.viscosity) > 0:
        raise InputError(
            argument="viscosity",
            got=float(material.viscosity),
            accepted="0 for a card of Prony terms",
        )
    if material.poisson is None:
        raise InputError(
            argument="material",
            got=material,
            accepted="one with a constant Poisson's ratio for a card, not a constant "
            "bulk modulus",
        )
    moduli = np.asarray(material.moduli, dtype=float)
    equilibrium, notes = float(material.equilibrium), list(_describe(material))
    if equilibrium == 0:
        equilibrium = _FLOOR * float(moduli.sum())
        notes.append(
            f"a liquid: {_FLOOR:g} of the modulus stays, since the parts must sum "
            "to "
            "less than 1"
        )
    glassy = equilibrium + float(moduli.sum())
    label = re.sub(r"[^A-Z0-9_]+", "_", (material.name or "rubber").upper())[:_LABEL]
    name = label if label[0].isalpha() else f"M_{label}"
    poisson = float(material.poisson)
    in_shear = 2 * (1 + poisson) if material.kind == "tensile" else 1.0
    return _CardParts(name, glassy / in_shear, poisson, moduli / glassy, notes)


def _describe(material: Prony) -> Iterator[str]:
    yield (
        f"{'shear' if material.kind == 'shear' else 'tensile'} Prony series; units "
        "Pa, s, K"
    )
    if material.shift is not None:
        yield f"relaxation times at {float(material.shift.reference):.6g} K"
    if material.vertical is not None:
        yield (
            "moduli only at this temperature: the vertical shifts of the material "
            "have no place here"
        )
    if material.softening is not None:
        last = float(material.softening.strain[-1])
        left = float(material.softening.storage[-1])
        yield (
            f"small strains: softening (storage modulus times {left:.3g} at "
            f"{last:.3g}) has no place in this card"
        )
    if material.citation:
        yield " ".join(material.citation.split())


def _as_wlf(material: Prony) -> WLF | None:
    if isinstance(material.shift, WLF):
        return material.shift
    return material.shift.to_wlf() if isinstance(material.shift, VFT) else None
