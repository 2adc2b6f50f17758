"""What is known of a material's numbers: the range of the data behind them, what lies
beyond it, the misfit to them, and materials drawn from what is not known.

A list of draws is computed as one material with a band. Of a material whose file
records how far it is from its data, band by band, the draws are the same series with
its moduli off by as much: relative deviations of storage and loss modulus, normal, of
that size, which resemble each other over a decade of frequency. What else is not known,
such as the shift factors, a file does not record.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol, TypeAlias, TypeVar

import numpy as np

from ..arrays import xp
from ..checks import Array, is_traced, significant, whole_number
from ..errors import InputError
from ..results.base import NOT_STATED, RoadErrors
from ..trees import replaced

if TYPE_CHECKING:
    from jaxtyping import Bool

    from .._types import ArrayLike


_ROUNDING = 1e-6  # relative, by which a frequency may lie outside and count as inside
_KELVIN = 0.5  # by how much a temperature may: no data are closer to their own
# A passage lasts 2a/v, 4 over the frequency 2 v/a where it dissipates most, and all
# that time the contact relaxes. Fitted to data without noise: friction 4 to 11 % off
# where only 2 v/a is within them, 1 % where a quarter of it is.
SLOWEST = 0.25
_KEYS = ("omega", "time", "temperature")
_BANDS = 4  # per decade, in which the misfit is recorded
_DIGITS = 3  # of a recorded misfit

_DECADES = 0.5  # distance at which deviations have a correlation of exp(-1/2)
# of a modulus's logarithm: changes that no frequency of the data sees are left out
_RIDGE = 1e-2

_PER_DECADE = 3  # branches of a series that moduli within the data are fitted with
_SOLID = 1e-3  # share of the slowest modulus that stays, without which it is a liquid

T = TypeVar("T")


class Series(Protocol):
    """What draws ask of a Prony series, which derives from this file."""

    @property
    def name(self) -> str: ...
    @property
    def range(self) -> Range | None: ...
    @property
    def equilibrium(self) -> Array: ...
    @property
    def moduli(self) -> Array: ...
    @property
    def times(self) -> Array: ...
    def storage(self, omega: ArrayLike, /) -> Array: ...
    def loss(self, omega: ArrayLike, /) -> Array: ...


S = TypeVar("S", bound=Series)


class Range(NamedTuple):
    """What a material was measured at; beyond it, its moduli and shift factors are an
    extrapolation.
    """

    # at the reference temperature [rad/s]; (): nowhere, None: unknown
    omega: tuple[float, float] | tuple[()] | None
    # [K]; None: not known, or not needed since the times do not shift
    temperature: tuple[float, float] | None
    # assumed, not measured: use beyond it is noted, but is worth no warning
    illustrative: bool = False
    # what lies outside already, of a material that was brought to a temperature
    beyond: str = ""
    # omega [rad/s], rms deviation of storage and loss, per band
    misfit: tuple[tuple[float, float, float], ...] = ()
    # of no particular rubber: the file grades the moduli themselves as illustrative
    illustrative_moduli: bool = False
    within: float = 0.0  # root mean square of the misfit of what draws are of

    def at(self, temperature: Array, factor: Array | float) -> "Range | None":
        """The range at one temperature [K], where relaxation times are `factor` times
        longer; None while JAX traces.
        """
        if is_traced(temperature, factor):
            return None
        degrees, a = float(temperature), float(factor)
        beyond = self.beyond
        if self.temperature is not None and not _near(
            np.array(degrees), self.temperature
        ):
            beyond = f"temperature {degrees:.6g} K, range {self._words('temperature')}"
        omega = None if self.omega else self.omega
        rows: tuple[tuple[float, float, float], ...] = ()
        if 0 < a < np.inf:
            rows = tuple(
                (omega / a, storage, loss) for omega, storage, loss in self.misfit
            )
            if self.omega:
                omega = (self.omega[0] / a, self.omega[1] / a)
        return self._replace(omega=omega, temperature=None, beyond=beyond, misfit=rows)

    def outside(
        self, rate: np.ndarray, temperature: np.ndarray | None
    ) -> Bool[np.ndarray, "..."]:
        """Which passages lie outside: frequencies 2 v a_T/a [rad/s] and temperatures
        [K], of one shape.
        """
        outside = xp.full(np.shape(rate), bool(self.beyond))
        if self.omega == ():
            outside = xp.ones(np.shape(rate), bool)
        elif self.omega:
            low, high = self.omega
            outside = outside | (SLOWEST * rate < low * (1 - _ROUNDING))
            outside = outside | (rate > high * (1 + _ROUNDING))
        if self.temperature is not None and temperature is not None:
            outside = outside | ~_near(temperature, self.temperature)
        return outside

    def findings(
        self,
        rate: np.ndarray,
        temperature: np.ndarray | None,
        of: str = "the passage means frequencies (v a_T/(2a) to 2 v a_T/a)",
    ) -> Iterator[str]:
        """What of the range is left, and by how far, in words; `of` says what the rates
        are.
        """
        if self.beyond:
            yield self.beyond
        known = rate[np.isfinite(rate)]
        if self.omega is not None and known.size and self.outside(known, None).any():
            low, high = (
                significant(float(x), 3) for x in (SLOWEST * known.min(), known.max())
            )
            words = (
                self._words("omega")
                if self.omega
                else "empty: the data determine the loss modulus nowhere"
            )
            extent = f"of {low}" if low == high else f"from {low} to {high}"
            yield f"{of} {extent} rad/s, range {words}"
        if (
            self.temperature is None
            or temperature is None
            or _near(temperature, self.temperature).all()
        ):
            return
        low, high = (f"{float(x):.6g}" for x in (temperature.min(), temperature.max()))
        yield f"temperature from {low} to {high} K, range {self._words('temperature')}"

    def _words(self, key: str) -> str:
        low, high = (
            significant(x, 6 if key == "temperature" else 3) for x in getattr(self, key)
        )
        return f"{low} to {high} {'K' if key == 'temperature' else 'rad/s'}"

    def table(self) -> dict[str, list[float]]:
        """As the [range] of a material file; an empty list where the moduli are known
        at no frequency.

        The misfit is no part of it: a file has it in a table of its own.
        """
        pairs = {"omega": self.omega, "temperature": self.temperature}
        return {
            key: [float(x) for x in pair]
            for key, pair in pairs.items()
            if pair is not None
        }


# What a caller may give for a range.
RangeLike: TypeAlias = "Range | dict[str, tuple[float, float]] | dict[str, list[float]]"


def as_range(value: object, illustrative: bool = False) -> Range | None:
    """A `Range` from one, from None, or from a dict such as {"omega": (1e-2, 1e6),
    "temperature": (263.15, 333)}.

    "time" [s] stands for the frequencies 1/t, an empty list of frequencies for none at
    which the moduli are known. Raises `InputError` for other keys, and for what is no
    pair of ascending positive numbers.
    """
    if value is None or isinstance(value, Range):
        return value
    if not isinstance(value, Mapping) or not set(value) <= set(_KEYS):
        raise InputError(
            argument="range",
            got=value,
            accepted=f"a dict with some of the keys {', '.join(_KEYS)}",
        )
    pairs: dict[str, Any] = {}
    for key, pair in value.items():
        if key == "omega" and isinstance(pair, (list, tuple)) and not pair:
            pairs[key] = ()
            continue
        try:
            low, high = (float(x) for x in pair)
        except (TypeError, ValueError):
            low = high = float("nan")
        if not 0 < low < high < float("inf"):
            raise InputError(
                argument="range",
                got=pair,
                accepted=f"two positive numbers for {key}, the lower first",
            )
        pairs[key] = (low, high)
    if "time" in pairs:
        pairs.setdefault("omega", (1 / pairs["time"][1], 1 / pairs["time"][0]))
    return Range(pairs.get("omega"), pairs.get("temperature"), illustrative)


def shared(one: Range | None, other: Range | None) -> Range | None:
    """Where the numbers of two bodies in contact hold; a body without a range does not
    narrow it.
    """
    if one is None or other is None:
        return one or other
    omega = _overlap(one.omega, other.omega)
    temperature = _overlap(one.temperature, other.temperature)
    beyond = one.beyond or other.beyond
    if _apart(omega) or _apart(temperature):
        beyond = beyond or "two bodies whose ranges do not overlap"
    return Range(
        None if _apart(omega) else omega,
        None if _apart(temperature) else temperature or None,
        one.illustrative and other.illustrative,
        beyond,
        tuple(sorted(one.misfit + other.misfit)),
        one.illustrative_moduli or other.illustrative_moduli,
        max(one.within, other.within),
    )


def material_in_words(material: object) -> list[tuple[str, str]]:
    """The inputs of a result that say of which rubber it is."""
    return [("material", getattr(material, "name", "") or "given directly")]


def misfit_bands(
    omega: ArrayLike, storage: ArrayLike, loss: ArrayLike
) -> tuple[tuple[float, float, float], ...]:
    """The deviations of a material from its data as `Range.misfit` records them: root
    mean squares, four a decade.

    Args:
        omega: angular frequencies at the reference temperature, one per measured point
            [rad/s].
        storage: relative deviations of the storage modulus there, material over data
            minus one.
        loss: those of the loss modulus.

    Returns:
        One row for each band with data: its middle [rad/s], and both root mean squares,
            to three digits.
    """
    omega = np.asarray(omega, dtype=float)
    squares = np.square([np.asarray(storage), np.asarray(loss)])
    band = np.floor(_BANDS * np.log10(omega)).astype(int)
    rows = []
    for number in np.unique(band):
        middle = 10 ** ((number + 0.5) / _BANDS)
        sizes = np.sqrt(squares[:, band == number].mean(axis=1))
        rows.append(tuple(float(f"{x:.{_DIGITS - 1}e}") for x in (middle, *sizes)))
    return tuple(rows)


def misfit(material: Any, low: Any, high: Any) -> tuple[Array, Array]:
    """How far a material is from the data that it was fitted to, between two
    frequencies.

    Args:
        material: a material or a foundation; one brought to a temperature is asked
            about frequencies at that one.
        low: lowest angular frequency [rad/s], any shape.
        high: highest angular frequency [rad/s], broadcasts with `low`.

    Returns:
        Root mean square relative deviations of the storage and of the loss modulus, in
        the shape of `low` and `high`;
        NaN where it is not known: no record, no data between the two, or values that
            JAX traces.
    """
    shape = np.broadcast_shapes(np.shape(low), np.shape(high))
    unknown = np.full(shape, np.nan)
    rows = () if material.range is None else material.range.misfit
    if not rows or is_traced(low, high):
        return unknown, unknown
    omega, *sizes = np.array(rows).T
    half = 10 ** (0.5 / _BANDS)
    inside = (omega * half >= np.asarray(low)[..., None]) & (
        omega / half <= np.asarray(high)[..., None]
    )
    count = inside.sum(axis=-1)
    storage, loss = (
        np.where(
            count > 0,
            np.sqrt((inside * size**2).sum(axis=-1) / np.maximum(count, 1)),
            np.nan,
        )
        for size in sizes
    )
    return storage, loss


def _apart(pair: tuple[float, float] | tuple[()] | None) -> bool:
    return bool(pair) and pair[0] >= pair[1]


def _overlap(
    one: tuple[float, float] | tuple[()] | None,
    other: tuple[float, float] | tuple[()] | None,
) -> tuple[float, float] | tuple[()] | None:
    if one == () or other == ():
        return ()
    if not one or not other:
        return one or other
    return max(one[0], other[0]), min(one[1], other[1])


def _near(
    temperature: np.ndarray, pair: tuple[float, float]
) -> Bool[np.ndarray, "..."]:
    return (temperature >= pair[0] - _KELVIN) & (temperature <= pair[1] + _KELVIN)


class Draws(list[T]):
    """Draws of one material or of one surface, `of` which they are, in words from what
    they were drawn and, of a surface, how well it is known.
    """

    def __init__(
        self,
        each: Iterable[T],
        of: T,
        words: str,
        errors: RoadErrors = NOT_STATED,
    ):
        super().__init__(each)
        self.of, self.words, self.errors = of, words, errors

    @property
    def name(self) -> str:
        """That of the material, or what kind of surface it is."""
        return getattr(self.of, "name", "") or getattr(self.of, "label", "")

    def made(self, make: Callable[[T], T]) -> Draws[T]:
        """Draws of what is made of each."""
        return Draws(map(make, self), make(self.of), self.words, self.errors)

    def __reduce__(self) -> Any:
        return type(self), (list(self), self.of, self.words, self.errors)


def check_draws(n: object, seed: object) -> None:
    """Raises `InputError` unless they are whole numbers, of draws at least two."""
    whole_number("n", n, 2)
    whole_number("seed", seed, 0)


def drawn_from_misfit(material: S, n: int, seed: int) -> Draws[S]:
    """Draws of a series from its recorded misfit. Raises `InputError` where it has
    none.
    """
    check_draws(n, seed)
    rows = () if material.range is None else material.range.misfit
    if not rows or is_traced(material):
        raise InputError(
            argument="material",
            got=material,
            accepted="one with a record of how far it is from its data ([misfit] in "
            "its file)",
            hint="nothing says how uncertain it is; em.fit.material(...).draws(n) "
            "draws from the data",
        )
    omega, *sizes = np.array(rows).T
    apart = np.subtract.outer(np.log10(omega), np.log10(omega)) / _DECADES
    root = root_of(np.exp(-0.5 * apart**2))
    rng = np.random.default_rng(seed)
    deviations = np.concatenate(
        [size * (rng.standard_normal((n, omega.size)) @ root.T) for size in sizes],
        axis=1,
    )
    changes = deviations @ by_moduli(material, omega).T
    materials = [changed(material, change, i) for i, change in enumerate(changes, 1)]
    words = "recorded misfit to its data; shift factors as they are"
    return Draws(materials, without_misfit(material), words)


def root_of(covariance: np.ndarray) -> np.ndarray:
    """R with R R^T the covariance."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def by_moduli(material: Series, omega: np.ndarray) -> np.ndarray:
    """Takes changes of ln storage and ln loss modulus at `omega` to changes of ln
    equilibrium and ln moduli.
    """
    x = omega[:, None] * np.asarray(material.times)
    strengths = np.asarray(material.moduli) / (1 + x**2)
    slow = np.full((omega.size, 1), float(material.equilibrium))
    seen = np.concatenate(
        [
            np.hstack([slow, strengths * x**2])
            / np.asarray(material.storage(omega))[:, None],
            np.hstack([0 * slow, strengths * x])
            / np.asarray(material.loss(omega))[:, None],
        ]
    )
    return np.linalg.solve(seen.T @ seen + _RIDGE * np.eye(seen.shape[1]), seen.T)


def changed(material: S, change: np.ndarray, number: int) -> S:
    """A draw: equilibrium and moduli times exp(change)."""
    factors = np.exp(change)
    name = f"draw {number} of {material.name}" if material.name else f"draw {number}"
    return replaced(
        without_misfit(material),
        equilibrium=np.asarray(material.equilibrium * factors[0]),
        moduli=material.moduli * factors[1:],
        name=name,
    )


def without_misfit(material: S) -> S:
    """The material without its misfit, which would be counted twice beside draws: among
    them, and in the error of each.
    """
    if material.range is None:
        return material
    within = _size(material.range)
    return replaced(material, range=material.range._replace(misfit=(), within=within))


def _size(known: Range) -> float:
    """The root mean square of the misfit."""
    rows = np.array(known.misfit).reshape(-1, 3)[:, 1:]
    return float(np.sqrt(np.mean(rows**2))) if rows.size else known.within


def beyond_data(material: object, wider: float, decades: float | None) -> object | None:
    """The series with data `wider` at each end, and with a branch so many decades beyond
    them, beyond their slow end where that is negative, which is as strong as they allow:
    the other branches, within the data, make up for it there but for the misfit.
    Without it for 0, the series itself for None; None for what has no record of its
    data.

    Of all spectra that agree with the data those with a single further branch change
    what is linear in the spectrum most: both are positive.
    """
    from scipy.optimize import bisect, nnls

    series: Any = material
    known: Range | None = getattr(material, "range", None)
    if known is None or not known.omega:
        return None
    low, high = known.omega[0] / wider, known.omega[1] * wider
    if decades is None:
        return replaced(series, range=known._replace(omega=(low, high)))
    if not _size(known) or float(getattr(material, "viscosity", 1.0)):
        return None
    count = int(_PER_DECADE * np.log10(high / low)) + 2
    omega = np.geomspace(low, high, 2 * count)
    modulus: Any = series.complex_modulus(omega)
    if not (modulus.imag > 0).all():  # elastic: there is nothing to be off by
        return None

    def seen(times: np.ndarray | float) -> np.ndarray:
        """Unit branches in the moduli of the data, relative to these."""
        x = np.multiply.outer(omega, times)
        both = np.concatenate([1 / (1 + x**-2), 1 / (x + 1 / x)])
        return (both.T / np.concatenate([modulus.real, modulus.imag])).T

    # the last one is the equilibrium
    times = np.append(np.geomspace(1 / high, 1 / low, count), np.inf)
    further = 10.0**-decades / (high if decades > 0 else low)
    within, alone = seen(times), seen(further)

    def fitted(strength: float) -> tuple[np.ndarray, float]:
        found, off = nnls(within, 1 - strength * alone)
        return found, off / np.sqrt(2 * omega.size)

    strength, limit = 0.0, np.hypot(fitted(0.0)[1], _size(known))
    if decades:
        least, most = np.log10(modulus.real[[0, -1]])
        most_allowed: Any = bisect(
            lambda x: fitted(10**x)[1] - limit, least - 16, most + 12, xtol=1e-5
        )
        strength = 10**most_allowed
    every = np.append(times, further)
    order = np.argsort(every)
    moduli = np.append(fitted(strength)[0], strength)[order]
    return replaced(
        series,
        equilibrium=np.maximum(moduli[-1], _SOLID * modulus.real[0]),
        moduli=moduli[:-1],
        times=every[order][:-1],
    )
