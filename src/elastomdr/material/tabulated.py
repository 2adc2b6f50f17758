"""The viscoelastic solid as a table of storage and loss modulus, for steady models that
need nothing else.

Between the points both moduli follow cubics in their logarithms against u = ln omega. A
cubic has, at each point, the slope of the parabola through it and its two neighbours,
limited to what a linear viscoelastic solid can have. Each of its relaxation times adds
x^2/(1 + x^2) to the storage and x/(1 + x^2) to the loss modulus, x = omega tau, so that

    0 <= d(ln E')/du <= 2,
    -1 <= d(ln E'')/du <= 1,
    |d^2(ln E')/du^2| <= 1,
    |d^2(ln E'')/du^2| <= 1.

(With t = tanh ln x and <> a mean weighted by what each time adds, the slopes are 1 -
<t> and -<t>, and the second derivatives 2 <y^2> - 2 <y> - <y>^2, y = 1 - t, and 2 <t^2>
- 1 - <t>^2.) A slope is therefore within h/2 of the slope of the straight line across
an interval of width h beside it. Solid and cubic are both within h^2/8 of that line,
and within h^2/4 of each other. As measured, the moduli of the library's materials come
back within 0.04 % at ten points per decade, and within 0.7 % by straight lines.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, Self

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    a_text,
    alike,
    as_float64,
    ascending,
    is_traced,
    not_negative,
    numpy_unless_traced,
    one_of,
    positive,
    scalar,
    untraced,
)
from ..errors import InputError
from ..numerics.interpolation import hermite, parabola_slopes
from ..trees import Tree, fill, replaced, static
from .relaxation import KelvinChain, poisson_ratio
from .shift import AbstractShift, AbstractVertical, check_laws, thermal_factors
from .softening import Softening, as_softening
from .validity import Range, RangeLike, as_range

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, ComplexArray, Kind, Number


_STORAGE, _LOSS = (0.0, 2.0), (-1.0, 1.0)  # least and largest slope in logarithms
# times h: how far a slope may be from that of the straight line across a neighbouring
# interval
_BENDS = 0.5
_APART = 0.25  # times h^2: how far a solid may be from the cubic, in logarithms
# The error of these cubics falls as the square of the distance of the points or faster.
# Measured on the library's materials, it is 0.09 to 0.19 of what leaving out half the
# points shows where they are evenly spaced, 0.47 at most where they lie at random.
# Hence the share of that difference which is stated as the error:
LEFT_OUT = 0.5

_PER_DECADE = 6  # retardation times
_BESIDE = 10.0  # how far they reach beyond the table


class AbstractTable(Tree):
    """Storage and loss modulus by their values at some frequencies. "Modulus" stands
    for what a subclass carries.

    Beyond the ends of the table both moduli keep their last values, except that nothing
    is lost at omega = 0.
    """

    omega: Float[Array, " n"]  # angular frequencies, ascending [rad/s]
    storage_table: Float[Array, " n"]  # [Pa]
    loss_table: Float[Array, " n"]  # [Pa]

    @numpy_unless_traced
    def complex_modulus(self, omega: ArrayLike) -> ComplexArray:
        """Storage modulus plus i times loss modulus [Pa], at omega >= 0 [rad/s], any
        shape.
        """
        storage, loss = self._moduli(omega)
        return storage + 1j * loss

    def storage(self, omega: ArrayLike) -> Array:
        """Storage modulus [Pa] at omega [rad/s]."""
        return self._moduli(omega)[0]

    def loss(self, omega: ArrayLike) -> Array:
        """Loss modulus [Pa] at omega [rad/s]."""
        return self._moduli(omega)[1]

    @numpy_unless_traced
    def loss_tangent(self, omega: ArrayLike) -> Array:
        """Loss modulus over storage modulus at omega [rad/s]."""
        storage, loss = self._moduli(omega)
        return loss / storage

    def relaxation(self, t: ArrayLike) -> Array:
        """Not known from a table. Raises `InputError`, which says how a series is
        fitted to it.
        """
        raise _no_series("material", self, "relaxation")

    def creep_compliance(self, t: ArrayLike) -> Array:
        """Not known from a table. Raises `InputError`, which says how a series is
        fitted to it.
        """
        raise _no_series("material", self, "creep_compliance")

    @property
    def instantaneous(self) -> Array:
        """Not known from a table, which ends at some frequency. Raises `InputError`."""
        raise _no_series("material", self, "instantaneous")

    @numpy_unless_traced
    def _moduli(self, omega: ArrayLike) -> tuple[Array, Array]:
        omega = as_float64("omega", omega)
        not_negative("omega", omega)
        log_omega = xp.log(xp.clip(omega, self.omega[0], self.omega[-1]))
        nodes, storage, loss = map(
            xp.log, (self.omega, self.storage_table, self.loss_table)
        )
        stored = xp.exp(_cubic(nodes, storage, _STORAGE, log_omega))
        lost = xp.where(omega > 0, xp.exp(_cubic(nodes, loss, _LOSS, log_omega)), 0.0)
        return stored, lost

    @numpy_unless_traced
    def interpolation_error(
        self, low: ArrayLike = 0.0, high: ArrayLike = np.inf
    ) -> tuple[Array, Array]:
        """An upper estimate of the relative error of interpolation at any place between
        two frequencies.

        It is the smaller one of a bound, h^2/4 with h the widest step of ln omega,
        which holds for values without scatter, and an estimate: every second point is
        left out, and then the others; each is compared with the curve through those
        that remain, and half the largest difference counts. An integral over
        frequencies errs by much less, since the error changes sign from point to point:
        see `thinned`.

        Args:
            low: lowest angular frequency [rad/s], any shape.
            high: highest angular frequency [rad/s], broadcasts with `low`.

        Returns:
            Of the storage and of the loss modulus, in the shape of `low` and `high`;
            NaN where the two frequencies are beyond the same end of the table.
        """
        nodes, storage, loss = map(
            xp.log, (self.omega, self.storage_table, self.loss_table)
        )
        omega = self.omega
        lowest: Array = xp.asarray(low)[..., None]
        highest: Array = xp.asarray(high)[..., None]
        # intervals between neighbours
        crossed = (omega[1:] >= lowest) & (omega[:-1] <= highest)
        bound = xp.max(
            xp.where(crossed, _APART * xp.diff(nodes) ** 2, -xp.inf), axis=-1
        )
        # points, by their neighbours
        inside = (omega[2:] >= lowest) & (omega[:-2] <= highest)

        def largest(values: Array, slopes: tuple[float, float]) -> Array:
            distance = LEFT_OUT * xp.abs(_left_out(nodes, values, slopes))
            known = xp.max(
                xp.where(inside, distance, -xp.inf), axis=-1, initial=-xp.inf
            )
            error = xp.where(known >= 0, xp.minimum(known, bound), bound)
            return xp.where(bound >= 0, xp.expm1(error), xp.nan)

        return largest(storage, _STORAGE), largest(loss, _LOSS)

    def thinned(self) -> tuple[Self, Self]:
        """The same material by every second point of its table, and by the others, both
        with the ends.

        What is computed from a table errs by about half the larger change that these
        two make to it, or less.
        """
        count, names = self.omega.shape[0], ("omega", "storage_table", "loss_table")
        first, second = (
            replaced(self, **{name: getattr(self, name)[kept] for name in names})
            for kept in (_kept(count, 1), _kept(count, 2))
        )
        return first, second


class TabulatedModulus(AbstractTable):
    """A viscoelastic solid by measured storage and loss moduli.

    Steady models of surfaces take it as it is (`em.Persson`, full contact);
    what has a history in time or a smooth body needs a Prony series (`em.fit.prony`).
    Moduli are those of `kind`, in the table and in all methods.

    Args:
        omega: angular frequencies, ascending, shape (n,), n >= 3 [rad/s].
        storage: storage moduli, shape (n,) [Pa].
        loss: loss moduli, shape (n,) [Pa].
        kind: "shear" (G) or "tensile" (E).
        poisson: Poisson's ratio, constant, above -1 and at most 0.5.
        shift: shift law; without it, no temperature can be given.
        vertical: law of vertical shifts b_T, which multiply all moduli.
        softening: `em.Softening`, factors on the moduli at larger strains; without it
            the rubber is linear.
        name: what tables and figures call it.
        citation: where the numbers come from.
        range: where they hold, as for `em.Prony`; its frequencies are those of the
            table where it gives none. What lies beyond them is flagged as extrapolated.

    Between the points moduli follow cubics in double logarithms, with an error that
    `interpolation_error` estimates. Below the first point and above the last both
    moduli are held, and at omega = 0 nothing is lost. Raises `InputError` for lists
    that do not match, for values that are not positive, for frequencies that do not
    ascend.
    """

    omega: Float[Array, " n"]
    storage_table: Float[Array, " n"]
    loss_table: Float[Array, " n"]
    poisson: Float[Array, ""]
    shift: AbstractShift | None
    vertical: AbstractVertical | None
    softening: Softening | None
    kind: Literal["shear", "tensile"] = static()
    name: str = static()
    citation: str = static()
    range: Range | None = static()  # where the numbers hold; None: not known

    def __init__(
        self,
        omega: ArrayLike,
        storage: ArrayLike,
        loss: ArrayLike,
        *,
        kind: Kind = "shear",
        poisson: Number = 0.5,
        shift: AbstractShift | None = None,
        vertical: AbstractVertical | None = None,
        softening: Softening | None = None,
        name: str = "",
        citation: str = "",
        range: RangeLike | None = None,
    ):
        given = {"omega": omega, "storage": storage, "loss": loss}
        lists = {key: as_float64(key, value) for key, value in given.items()}
        alike(3, lists)
        for key, values in lists.items():
            positive(key, values)
        omega, storage, loss = lists.values()
        ascending("omega", omega)
        one_of("kind", kind, "shear", "tensile")
        a_text("name", name)
        a_text("citation", citation)
        check_laws(shift, vertical)
        poisson = poisson_ratio(poisson)
        known = as_range(range)
        if (known is None or known.omega is None) and not is_traced(omega):
            known = (known or Range(None, None))._replace(
                omega=(float(omega[0]), float(omega[-1]))
            )
        fill(
            self,
            omega=omega,
            storage_table=storage,
            loss_table=loss,
            poisson=poisson,
            shift=shift,
            vertical=vertical,
        )
        fill(self, softening=as_softening(softening))
        fill(self, kind=kind, name=name, citation=citation, range=known)

    def shear(self) -> "TabulatedModulus":
        """The same material by its shear modulus, G = E/(2 (1 + nu))."""
        return (
            self
            if self.kind == "shear"
            else self._as("shear", 1 / (2 * (1 + self.poisson)))
        )

    def tensile(self) -> "TabulatedModulus":
        """The same material by its tensile modulus, E = 2 (1 + nu) G."""
        return (
            self
            if self.kind == "tensile"
            else self._as("tensile", 2 * (1 + self.poisson))
        )

    @numpy_unless_traced
    def _as(self, kind: Kind, factor: Array | float) -> "TabulatedModulus":
        return replaced(
            self,
            storage_table=self.storage_table * factor,
            loss_table=self.loss_table * factor,
            kind=kind,
        )

    @numpy_unless_traced
    def at(self, temperature: Number) -> "TabulatedModulus":
        """The same material at a temperature [K]: its frequencies divided by a_T, its
        moduli multiplied by b_T.

        Raises without a shift law.
        """
        temperature = scalar("temperature", temperature)
        a, b = thermal_factors(self, temperature)
        known = None if self.range is None else self.range.at(temperature, a)
        return replaced(
            self,
            omega=self.omega / a,
            storage_table=self.storage_table * b,
            loss_table=self.loss_table * b,
            shift=None,
            vertical=None,
            range=known,
        )

    def __repr__(self) -> str:
        label = f"{self.name!r}, " if self.name else ""
        return f"TabulatedModulus({label}{self.kind}, {described(self)})"


def described(table: AbstractTable) -> str:
    """The span of a table in words, for a `repr`."""
    if is_traced(table) or np.ndim(table.omega) != 1:
        return f"{np.shape(table.omega)[-1]} points, traced or a batch"
    (low, high), (soft, stiff) = (
        x[[0, -1]] for x in (np.asarray(table.omega), np.asarray(table.storage_table))
    )
    return (
        f"{table.omega.size} points, {low:.3g}..{high:.3g} rad/s, storage "
        f"{soft:.4g}..{stiff:.4g} Pa"
    )


def _no_series(name: str, table: AbstractTable, purpose: str) -> InputError:
    kind = f', kind="{table.kind}"' if isinstance(table, TabulatedModulus) else ""
    return InputError(
        argument=name,
        got=table,
        accepted=f"a Prony series for {purpose}",
        hint=f"fit one, em.fit.prony(omega, storage, loss{kind}).material",
    )


def needs_series(name: str, material: object, purpose: str) -> None:
    """Raises `InputError` where a table of moduli is given for what needs a Prony
    series.
    """
    if isinstance(material, AbstractTable):
        raise _no_series(name, material, purpose)


def _cubic(x: Array, y: Array, slopes: tuple[float, float], wanted: Array) -> Array:
    """Values of the cubics through (x, y), with slopes within two limits, at places
    between the first and last x.
    """
    width = xp.diff(x)
    secant = xp.diff(y) / width
    slope = parabola_slopes(x, y)
    # The wider interval limits last: points that lie close together and scatter do not
    # bend the curve in a gap.
    before = np.clip(np.arange(x.shape[0]) - 1, 0, None)
    after = np.clip(np.arange(x.shape[0]), None, x.shape[0] - 2)
    wider = xp.where(width[before] > width[after], before, after)
    narrower = before + after - wider
    for side in (narrower, wider):
        slope = xp.clip(slope, *slopes)
        slope = xp.clip(
            slope,
            secant[side] - _BENDS * width[side],
            secant[side] + _BENDS * width[side],
        )
    return hermite(x, y, slope, wanted)


def _kept(count: int, first: int) -> np.ndarray:
    """Which points remain where every second one from `first` on is left out, and the
    last is not.
    """
    return np.setdiff1d(np.arange(count), np.arange(first, count - 1, 2))


def _left_out(x: Array, y: Array, slopes: tuple[float, float]) -> Array:
    """At each inner point, its distance from the curve that knows every second point,
    without it.
    """
    count = x.shape[0]
    distances, places = [], []
    for first in (1, 2):
        out, kept = np.arange(first, count - 1, 2), _kept(count, first)
        distances.append(_cubic(x[kept], y[kept], slopes, x[out]) - y[out])
        places.append(out)
    return xp.concatenate(distances)[np.argsort(np.concatenate(places))]


def to_chain(table: AbstractTable) -> tuple[KelvinChain, float]:
    """The chain of positive compliances that is nearest to the table, and how far it is
    from it.

    The distance is the root mean square, over the logarithm of frequency, of the
    difference of the complex compliances over the loss compliance: about what a loss
    computed with the chain is off. Raises `InputError` under a transformation of JAX
    with respect to the table.
    """
    untraced(
        InputError(
            argument="material",
            accepted="a series, em.Prony, under jit, grad and vmap, not a table",
        ),
        table,
    )
    from scipy.optimize import nnls

    ends = float(table.omega[0]), float(table.omega[-1])
    omega = np.geomspace(*ends, 2 + math.ceil(12 * math.log10(ends[1] / ends[0])))
    compliance = 1 / np.asarray(table.complex_modulus(omega))
    count = 2 + math.ceil(_PER_DECADE * math.log10(ends[1] / ends[0] * _BESIDE**2))
    times = np.geomspace(1 / (_BESIDE * ends[1]), _BESIDE / ends[0], count)
    terms = np.concatenate(
        [np.ones((omega.size, 1)), 1 / (1 + 1j * omega[:, None] * times)], axis=1
    )
    size = -compliance.imag
    rows = terms / size[:, None]
    wanted = compliance / size
    compliances, _ = nnls(
        np.concatenate([rows.real, rows.imag]),
        np.concatenate([wanted.real, wanted.imag]),
        maxiter=50 * count,
    )
    distance = float(np.sqrt(np.mean(np.abs(rows @ compliances - wanted) ** 2)))
    kept = compliances[1:] > 0
    return KelvinChain(
        np.asarray(compliances[0]), compliances[1:][kept], times[kept], np.zeros(())
    ), distance
