"""Roughness spectra of isotropic surfaces: self-affine ones and tables, with the
normalisation named.

C(q) [m^4] is the two-dimensional power spectrum with <h^2> = int C d^2q = 2 pi int q C
dq, no factor 4 pi^2. Between its points it is a power law, so that every moment is a
sum of closed forms,

    int_a^b q^m C dq,    C = C_a (q/a)^s:    C_a a^(m+1) [(b/a)^(m+s+1) - 1]/(m+s+1),

and a self-affine spectrum is a table of two or three points. The line of the MDR has
the spectrum C_1D = pi q C, two-sided: it keeps <h^2>, and its mean square slope is the
full <|grad h|^2>, twice that of a cut (Popov & Hess 2015, ch. 10).

Lines and maps are drawn with random phases from a seed. On a line with the period L the
waves are q_j = 2 pi j/L, and the wave j carries what the band of width 2 pi/L about it
holds,

    A_j^2/2 = 2 int C_1D dq = 2 pi int_band q C dq,     h(x) = sum A_j cos(q_j x + phase_j),

so that the rms height is that of the surface whatever the period. Amplitudes are those
of the spectrum: every seed has the same rms values. On a map of side L each wave (i, j)
carries C(q) (2 pi/L)^2, q = 2 pi |(i, j)|/L, and the heights are then scaled to the rms
slope of the surface, from which the sum over the waves of a square differs a little.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..arrays import xp
from ..checks import (
    alike,
    as_float64,
    as_number,
    ascending,
    certain,
    in_si,
    is_traced,
    not_negative,
    numpy_unless_traced,
    only_one,
    positive,
    possible,
    require,
    scalar,
    untraced,
    whole_number,
)
from ..errors import InputError, closest
from ..material.validity import Draws, check_draws
from ..results.base import RoadErrors
from ..results.words import length_in_words
from ..trees import Tree, fill, static
from .lay import Lay, lay_of
from .rough_line import RoughLine, line_of_heights

if TYPE_CHECKING:
    from jaxtyping import Float
    from matplotlib.axes import Axes

    from .._types import Array, ArrayLike, Convention, Number, Scalar


CONVENTIONS = {
    "2d": "<h^2> = int C d^2q",
    "2d/4pi^2": "<h^2> = int C d^2q / (4 pi^2)",
    "1d": "of a straight cut, <h^2> = int C dq over all q, positive and negative",
    "1d one-sided": "of a straight cut, <h^2> = int C dq over q > 0",
    "1d/2pi": (
        "of a straight cut, <h^2> = int C dq / (2 pi) over all q, positive and negative"
    ),
    "1d one-sided/2pi": "of a straight cut, <h^2> = int C dq / (2 pi) over q > 0",
}

PER_WAVE = 8  # samples of the shortest wave
PERIODS = 4  # longest waves in a period of the line
_INNER = 4  # points along each side of the cell of a wave where a map has a lay
_PIECES = 4  # of the spectrum of a cut while it falls, or q rises, by a factor e
_TAIL = 25  # factors e by which a cut falls beyond its last point before it is nothing
_MOST_OF_CUT = 5000  # points of the spectrum of a cut: the time grows as the square
MOST = 2**26  # samples of a line, which are half a gigabyte


class AbstractSpectrum(Tree):
    """An isotropic surface by its power spectrum, a power law between the points q."""

    q: Float[np.ndarray, " n"]  # wave numbers, ascending [rad/m]
    c: Float[np.ndarray, " n"]  # C, normalised by <h^2> = int C d^2q [m^4]
    label: ClassVar[str]
    load_unit: ClassVar[str] = "N/m"  # of the lines that stand for it

    @property
    def q_low(self) -> Scalar:
        """Lower cutoff [rad/m]."""
        return as_number(self.q[0])

    @property
    def q_high(self) -> Scalar:
        """Upper cutoff [rad/m]."""
        return as_number(self.q[-1])

    @property
    def rms_height(self) -> Scalar:
        """Root of the mean square height [m]."""
        return as_number((2 * np.pi * self.moment(1)) ** 0.5)

    @property
    def rms_slope(self) -> Scalar:
        """Root of the mean of |grad h|^2; that of a straight cut is smaller by the root
        of 2.
        """
        return as_number((2 * np.pi * self.moment(3)) ** 0.5)

    @property
    def full_contact_length(self) -> Scalar:
        """2 m_2/m_3, m_k = int q^k C dq [m]: with it p L is the line load whose
        friction in full contact is that of the surface, for a loss modulus that does
        not depend on frequency (each wave has 2/q).
        """
        return as_number(2 * self.moment(2) / self.moment(3))

    def at(self, q: ArrayLike) -> Float[np.ndarray, "..."]:
        """C(q) [m^4], zero outside the cutoffs."""
        q = np.asarray(q, dtype=np.float64)
        with np.errstate(divide="ignore"):
            value = np.exp(np.interp(np.log(q), np.log(self.q), np.log(self.c)))
        inside = (q >= self.q_low * (1 - 1e-12)) & (q <= self.q_high * (1 + 1e-12))
        return np.where(inside, value, 0.0)

    def moment(
        self, power: float, low: ArrayLike | None = None, high: ArrayLike | None = None
    ) -> Array:
        """int q^power C dq from `low` to `high` (default: the cutoffs), arrays of
        limits allowed.
        """
        integral = self._until(power, self.q_high if high is None else high)
        return integral if low is None else integral - self._until(power, low)

    @numpy_unless_traced
    def _until(self, power: float, q: ArrayLike) -> Array:
        q = xp.clip(q, self.q_low, self.q_high)
        start = xp.log(self.q[:-1])
        slope = xp.diff(xp.log(self.c)) / xp.diff(xp.log(self.q)) + power + 1
        width = xp.clip(xp.log(q)[..., None] - start, 0.0, xp.diff(xp.log(self.q)))
        flat = xp.abs(slope * width) < 1e-9
        safe = xp.where(xp.abs(slope) < 1e-12, 1.0, slope)
        integrals = xp.where(
            flat, width * (1 + 0.5 * slope * width), xp.expm1(slope * width) / safe
        )
        return xp.sum(self.c[:-1] * self.q[:-1] ** (power + 1) * integrals, axis=-1)

    def line(
        self, seed: int = 0, periods: int = 1, samples: int | None = None
    ) -> RoughLine:
        """An `em.RoughLine` of this surface, for `em.slide` and `em.drive`, its phases
        from `seed`.

        As in `em.friction`: C_1D(q) = pi q C(q), over `periods` of the longest wave
        (where `em.friction` takes 4), in `samples` points (a power of 2 that resolves
        the shortest wave where none is given).
        """
        return synthesise(self, seed, periods, samples)

    def ended(self, q_high: Number) -> "AbstractSpectrum":
        """The same spectrum up to `q_high` [rad/m]; beyond its last point it goes on as
        its last power law. Raises `InputError`, under a transformation of JAX too.
        """
        end: Any = as_number(scalar("q_high", q_high))
        untraced(
            InputError(
                argument="q_high",
                accepted="plain numbers, which say what points of a table are kept",
                hint="of em.SelfAffine(..., q_high=) friction has a derivative",
            ),
            self,
            end,
        )
        require(
            "q_high",
            end,
            f"above q_low, {self.q_low:g} rad/m",
            lambda q: q > self.q_low,
        )
        log_q, log_c = np.log(self.q), np.log(self.c)
        piece = min(int(np.searchsorted(self.q, end)), len(log_q) - 1)
        slope = (log_c[piece] - log_c[piece - 1]) / (log_q[piece] - log_q[piece - 1])
        last = np.exp(log_c[piece - 1] + slope * (np.log(end) - log_q[piece - 1]))
        kept = np.asarray(self.q) < end * (1 - 1e-12)
        return Spectrum(
            np.append(self.q[kept], end), np.append(self.c[kept], last), convention="2d"
        )

    def raised(self, factor: Number) -> "AbstractSpectrum":
        """The same surface with all heights times `factor`."""
        times: Any = as_number(scalar("factor", factor))
        positive("factor", times)
        return Spectrum(self.q, self.c * times**2, convention="2d")

    def draws(
        self, n: int, *, level: Number = 0.0, cutoff: Number = 0.0, seed: int = 0
    ) -> "Draws[AbstractSpectrum]":
        """The same surface with another C and another upper cutoff, log-normal, for
        `em.friction` and `em.sweep`.

        Args:
            n: how many, 2 or more.
            level: relative standard deviation of C, the same at all wave numbers.
            cutoff: relative standard deviation of `q_high`.
            seed: of the random numbers.

        Raises:
            InputError: for numbers that are negative, not whole, or all zero.
        """
        check_draws(n, seed)
        sizes = np.array([scalar("level", level), scalar("cutoff", cutoff)])
        not_negative("level", sizes[0])
        not_negative("cutoff", sizes[1])
        if not sizes.any():
            raise InputError(
                argument="level",
                got=0.0,
                accepted="above 0, or cutoff",
                hint="nothing says how uncertain the surface is",
            )
        factors = np.exp(sizes * np.random.default_rng(seed).standard_normal((n, 2)))
        lowest = 1.001 * self.q_low
        surfaces = [
            self.raised(a**0.5).ended(max(self.q_high * b, lowest)) for a, b in factors
        ]
        errors = RoadErrors(*sizes.tolist())
        return Draws(surfaces, self, errors.words(), errors)

    def plot(
        self, axes: Sequence[Axes] | None = None, seed: int = 0
    ) -> tuple[Axes, Axes]:
        """The line made from `seed`, and the spectrum, side by side; returns the two
        matplotlib Axes.
        """
        from ..results.plot_contacts import draw_surface, roughness_in_words

        line = synthesise(self, seed)
        surface = roughness_in_words(float(self.rms_height), float(self.rms_slope))
        return draw_surface(
            (np.asarray(line.x), np.asarray(line.height)),
            (np.asarray(self.q), np.asarray(self.c)),
            (f"Line of the method, seed {seed}", f"{surface} (surface)"),
            axes=axes,
        )

    def words(self) -> str:
        """rms values and both cutoffs, in a few words."""
        longest, shortest = (
            length_in_words(2 * np.pi / float(q)) for q in (self.q_low, self.q_high)
        )
        return (
            f"rms height {length_in_words(float(self.rms_height))}, rms slope "
            f"{self.rms_slope:.4g} (of the surface; of a cut "
            f"{self.rms_slope / np.sqrt(2):.4g}), wavelengths {longest} to {shortest} "
            f"(cutoffs {self.q_low:.4g} and {self.q_high:.4g} rad/m)"
        )


class SelfAffine(AbstractSpectrum):
    """A self-affine surface, C ~ q^(-2-2H) from q_rolloff to q_high and constant from
    q_low to q_rolloff.

    Given by the Hurst exponent H (0 to 1), either the rms slope (of the surface, |grad
    h|) or the rms height [m], and the cutoffs [rad/m]; without `q_rolloff` it is
    self-affine from q_low on. Differentiable with respect to all of them. Raises
    `InputError`.
    """

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    hurst: Scalar
    label: ClassVar[str] = "self-affine surface"

    def __init__(
        self,
        hurst: Number,
        rms_slope: Number | None = None,
        q_low: Number | None = None,
        q_high: Number | None = None,
        q_rolloff: Number | None = None,
        *,
        rms_height: Number | None = None,
    ):
        exponent: Any = as_number(scalar("hurst", hurst))
        require("hurst", exponent, "from 0 to 1", lambda x: (x >= 0) & (x <= 1))
        only_one({"rms_slope": rms_slope, "rms_height": rms_height})
        for name, given in (("q_low", q_low), ("q_high", q_high)):
            if given is None:
                raise InputError(
                    argument=name,
                    accepted="given [rad/m]",
                    hint="friction depends on both cutoffs",
                )
        low, high = scalar("q_low", q_low), scalar("q_high", q_high)
        knee = low if q_rolloff is None else scalar("q_rolloff", q_rolloff)
        positive("q_low", low)
        positive("q_high", high)
        name, wanted = (
            ("rms_slope", rms_slope)
            if rms_height is None
            else ("rms_height", rms_height)
        )
        value = scalar(name, wanted)
        positive(name, value)
        if not possible(np.less_equal, low, knee):
            raise InputError(
                argument="q_rolloff",
                got=float(knee),
                accepted=f"q_low, {low:g} rad/m, or more",
            )
        if not possible(np.less, knee, high):
            raise InputError(
                argument="q_high",
                got=float(high),
                accepted=f"above {knee:g} rad/m, where the spectrum begins to fall",
            )
        whole = q_rolloff is None or certain(np.equal, knee, low)
        q, c = _power_law(exponent, [low, high] if whole else [low, knee, high], knee)
        fill(self, hurst=exponent, q=q, c=c)
        fill(self, c=_scaled(c, value, getattr(self, name)))
        if not possible(lambda c: ((c > 0) & np.isfinite(c)).all(), self.c):
            given = f"{name}={value:g} between {low:g} and {high:g} rad/m"
            raise InputError(
                argument=name,
                got=float(value),
                accepted="of a surface whose power spectrum double precision holds",
                hint=f"it is between {low:g} and {high:g} rad/m",
            )

    def __repr__(self) -> str:
        if is_traced(self):
            return "SelfAffine(traced)"
        return f"SelfAffine(hurst={self.hurst:g}, {self.words()})"


@numpy_unless_traced
def _power_law(hurst: Scalar, corners: list[Array], knee: Array) -> tuple[Array, Array]:
    q = xp.stack(corners)
    return q, xp.where(q <= knee, 1.0, (q / knee) ** (-2 - 2 * hurst))


@numpy_unless_traced
def _scaled(c: Array, value: Array, unscaled: Scalar) -> Array:
    return c * (value / unscaled) ** 2


class Spectrum(AbstractSpectrum):
    """An isotropic surface by a table of its power spectrum; `convention` says how it
    is normalised, never guessed.

    - "2d": C(q) [m^4] with <h^2> = int C d^2q;  "2d/4pi^2": with <h^2> = int C d^2q/(4
      pi^2)
    - "1d": spectrum of a straight cut [m^3], <h^2> = int C dq over all q;  "1d
      one-sided": over q > 0; "1d/2pi": int C dq/(2 pi) over all q;  "1d one-sided/2pi":
      over q > 0. Turned into the two-dimensional one of an isotropic surface, C =
      -(1/pi) int_q^inf C_cut'(k)/sqrt(k^2 - q^2) dk, the cut being a power law
      between its points and, beyond the last, as before it.

    `q` [rad/m] ascends, without repeats. Compare `rms_height` and `rms_slope` with what
    is known of the surface: a wrong convention shows there. Raises `InputError`.
    """

    q: Float[np.ndarray, " n"]
    c: Float[np.ndarray, " n"]
    convention: str = static()
    label: ClassVar[str] = "surface by its spectrum"

    def __init__(self, q: ArrayLike, c: ArrayLike, *, convention: Convention):
        check_convention(convention)
        q, c = np.asarray(as_float64("q", q)), as_float64("c", c)
        if not convention.startswith("2d"):
            untraced(
                InputError(
                    argument="c",
                    accepted=f"plain numbers under jit, grad and vmap, for {convention=!r}",
                ),
                c,
            )
        if c.ndim == 2:
            raise InputError(
                argument="c",
                got=c.shape,
                accepted="a list as long as q, the spectrum of an isotropic surface",
                hint="average a map over directions, or give the heights to "
                "em.read_surface",
            )
        alike(2, {"q": q, "c": c})
        positive("q", q)
        ascending("q", q)
        positive("c", c)
        if convention == "2d/4pi^2":
            c = c / (4 * np.pi**2)
        elif convention != "2d":
            factor = (0.5 if "one-sided" in convention else 1.0) / (
                2 * np.pi if "/2pi" in convention else 1.0
            )
            c = _from_cut(q, np.asarray(factor * c))
        fill(self, convention=convention, q=q, c=c)

    def __repr__(self) -> str:
        return (
            f"Spectrum({self.q.size} points, convention={self.convention!r}, "
            f"{self.words()})"
        )


def check_convention(convention: object) -> None:
    """Raises `InputError`, with all that there are, where it is none."""
    if not isinstance(convention, str) or convention not in CONVENTIONS:
        hint = closest(str(convention), CONVENTIONS)
        listed = "; ".join(
            f"{name!r}: {meaning}" for name, meaning in CONVENTIONS.items()
        )
        raise InputError(
            argument="convention",
            got=convention,
            accepted=f"one of {listed}",
            hint=hint,
        )


def _from_cut(q: np.ndarray, cut: np.ndarray) -> np.ndarray:
    """The two-dimensional spectrum of an isotropic surface from that of its cuts.

    With k = q/cos(t) the piece cut = c (a/k)^p of a table adds

        C = (p c)/(pi q) int (a cos(t)/q)^p dt,

    whose integrand is smooth: Gauss' rule of two points, within 1e-4 of C. Beyond its
    last point the cut goes on as its last power law, as far as it holds anything.
    """
    if not 3 <= q.size <= _MOST_OF_CUT:
        raise InputError(
            argument="q",
            got=q.size,
            accepted=f"3 to {_MOST_OF_CUT} points where c is the spectrum of a cut",
            hint="ten a decade, averaged over bands of q, are enough",
        )
    log_q, log_cut = np.log(q), np.log(cut)
    fall = (log_cut[-2] - log_cut[-1]) / (log_q[-1] - log_q[-2])
    if not fall > 0:
        raise InputError(
            argument="c",
            got=float(cut[-1]),
            accepted=f"less than {cut[-2]:.4g} m^3 at its last point, since the "
            "spectrum of a cut falls with q",
            hint=f"noise may begin at q = {q[-1]:g} rad/m; leave those points out",
        )
    beyond = np.arange(1.0, _TAIL + 1)  # steps by which the cut falls by a factor e
    log_q = np.append(log_q, log_q[-1] + beyond / fall)
    log_cut = np.append(log_cut, log_cut[-1] - beyond)
    steps = np.maximum(np.abs(np.diff(log_cut)), np.diff(log_q))
    pieces = np.ceil(_PIECES * steps).astype(int)
    place = np.append(
        np.concatenate([i + np.arange(n) / n for i, n in enumerate(pieces)]),
        pieces.size,
    )
    log_q, log_cut = (np.interp(place, np.arange(y.size), y) for y in (log_q, log_cut))
    power = -np.diff(log_cut) / np.diff(log_q)
    weight = power * np.exp(log_cut[:-1]) / np.pi
    nodes, shares = np.polynomial.legendre.leggauss(2)
    c = np.zeros(q.size)
    for i, first in enumerate(np.cumsum(pieces[: q.size]) - pieces[: q.size]):
        t = np.arccos(np.minimum(q[i] / np.exp(log_q[first:]), 1.0))
        half = np.diff(t)[:, None] / 2
        cosine = np.cos(t[:-1, None] + half * (1 + nodes))
        below = log_q[first:-1, None] - np.log(q[i]) + np.log(cosine)
        held = (half * np.exp(power[first:, None] * below)) @ shares
        c[i] = weight[first:] @ held / q[i]
        if not c[i] > 0:
            raise InputError(
                argument="c",
                got=float(cut[i]),
                accepted="falling with q, as the spectrum of a cut through an "
                "isotropic surface",
                hint=f"it does not fall about q = {q[i]:g} rad/m; average it over "
                "wider bands of q, or leave out the part below the roll-off",
            )
    return c


def as_spectrum(name: str, value: object) -> AbstractSpectrum:
    """`value` if it is a spectrum. Raises `InputError`."""
    if isinstance(value, (tuple, list)):
        raise InputError(
            argument=name,
            got=value,
            accepted="one spectrum",
            hint="of two rough partners give the sum, em.Spectrum(q, first.at(q) + "
            'second.at(q), convention="2d")',
        )
    if not isinstance(value, AbstractSpectrum):
        raise InputError(
            argument=name,
            got=value,
            accepted="an em.SelfAffine, an em.Spectrum or a measured surface",
        )
    return value


def line_count(spectrum: AbstractSpectrum, periods: int, per_wave: float) -> int:
    """Samples of a line, a power of two. Raises `InputError` beyond `MOST`."""
    untraced(
        InputError(
            argument="samples",
            accepted="given where JAX traces the cutoffs of a surface",
            hint="how many samples a line needs depends on them",
        ),
        spectrum.q,
    )
    needed = periods * per_wave * spectrum.q_high / spectrum.q_low
    if not needed <= MOST:
        raise InputError(
            argument="q_high",
            got=float(spectrum.q_high),
            accepted=f"{MOST * spectrum.q_low / (periods * per_wave):.3g} rad/m at "
            f"most, for {MOST} samples on a line of {periods} of the longest waves",
            hint="give a shorter longest wave, a longer shortest one, or fewer periods",
        )
    return max(64, 2 ** math.ceil(math.log2(needed) - 1e-9))


@numpy_unless_traced
def synthesise(
    spectrum: AbstractSpectrum,
    seed: int,
    periods: int = PERIODS,
    samples: int | None = None,
    per_wave: float = PER_WAVE,
) -> RoughLine:
    """One line of the ensemble, `periods` longest wavelengths long, with so many
    samples `per_wave` where their number is not given; the same numbers for the same
    seed.
    """
    whole_number("periods", periods, 1, MOST)
    if samples is not None:
        whole_number("samples", samples, 64, MOST)
    n = line_count(spectrum, periods, per_wave) if samples is None else samples
    length = 2 * np.pi * periods / spectrum.q_low
    step = 2 * np.pi / length
    wave = step * np.arange(1, n // 2)
    share = 2 * np.pi * spectrum.moment(1, wave - 0.5 * step, wave + 0.5 * step)
    phase = 2 * np.pi * np.random.default_rng(seed).random(n // 2 - 1)
    # beyond the cutoffs there is nothing, and the root has no derivative
    present = share > 0
    amplitude = xp.where(present, xp.sqrt(2 * xp.where(present, share, 1.0)), 0.0)
    waves = 0.5 * n * amplitude * np.exp(1j * phase)
    waves = xp.pad(waves, (1, n // 2 - wave.shape[0]))
    return line_of_heights(xp.fft.irfft(waves, n), length / n)


@in_si
def rough_map(
    spectrum: AbstractSpectrum,
    seed: int = 0,
    *,
    periods: int = 2,
    points: int = 256,
    direction: float = 0.0,
) -> "tuple[Float[np.ndarray, 'points points'], float]":
    """Heights [m] of a square cell of the surface, `periods` longest wavelengths wide,
    and its side [m].

    For `em.reference.half_space_sliding`. Of a surface with a lay x is at the angle
    `direction` to it [rad]. Raises `InputError` where `points` do not
    give the shortest wave four.
    """
    spectrum = as_spectrum("spectrum", spectrum)
    whole_number("periods", periods, 1, MOST)
    whole_number("points", points, 8, 8192)
    whole_number("seed", seed, 0, MOST)
    side = float(2 * np.pi * periods / spectrum.q_low)
    least = 4 * periods * spectrum.q_high / spectrum.q_low
    if points % 4 or points < least * (1 - 1e-9):
        raise InputError(
            argument="points",
            got=points,
            accepted=f"a multiple of 4, {math.ceil(least)} or more, for four on the "
            "shortest wave",
        )
    along = np.fft.fftfreq(points, 1 / points)
    q = 2 * np.pi / side * np.hypot(along[:, None], along[None, : points // 2 + 1])
    power = spectrum.at(np.where(q > 0, q, np.inf)) * (2 * np.pi / side) ** 2
    lay = lay_of(spectrum)
    if lay is not None:
        power = power * _towards(lay, along, side, direction)
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((points, points)))
    waves = np.sqrt(power) * white / np.maximum(np.abs(white), 1e-300)
    height = np.fft.irfft2(waves, s=(points, points))
    along = np.where(2 * np.abs(along) == points, 0.0, along)
    slopes = [
        np.fft.irfft2(2j * np.pi / side * k * waves, s=height.shape)
        for k in (along[:, None], along[None, : points // 2 + 1])
    ]
    return height * (
        spectrum.rms_slope / np.sqrt(sum(np.mean(slope**2) for slope in slopes))
    ), side


def _towards(lay: Lay, along: np.ndarray, side: float, direction: float) -> np.ndarray:
    """W of each wave of `rough_map`, the mean over its cell of the plane of waves: about
    the lay W changes within a cell.
    """
    inner = (np.arange(_INNER) + 0.5) / _INNER - 0.5
    mean = np.zeros((along.size, along.size // 2 + 1))
    for off_x in inner:
        for off_y in inner:
            k_x = along[:, None] + off_x
            k_y = along[None, : along.size // 2 + 1] + off_y
            k = np.hypot(k_x, k_y)
            to_lay = np.arctan2(k_y, k_x) + direction
            q = 2 * np.pi / side * k
            mean += lay.weight(q, np.cos(to_lay) ** 2, np.sin(to_lay) ** 2)
    return mean / inner.size**2
