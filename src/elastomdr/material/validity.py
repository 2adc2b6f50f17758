"""Where a material's numbers hold: the frequencies and temperatures of the data behind them, and what lies beyond."""

import copy
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Bool

from .._runtime import is_traced, significant
from ..errors import InputError

_ROUNDING = 1e-6  # relative, by which a frequency may lie outside and count as inside
_KELVIN = 0.5  # by how much a temperature may: no data are closer to their own
# A passage lasts 2a/v, 4 over the frequency 2 v/a where it dissipates most, and all that time the contact relaxes.
# Fitted to data without noise: friction 4 to 11 % off where only 2 v/a is within them, 1 % where a quarter of it is.
SLOWEST = 0.25
_KEYS = ("frequency", "time", "temperature")

T = TypeVar("T")


class Range(NamedTuple):
    """What a material was measured at; beyond it, its moduli and shift factors are an extrapolation."""

    frequency: (
        tuple[float, float] | tuple[()] | None
    )  # at the reference temperature [rad/s]; (): nowhere, None: unknown
    temperature: tuple[float, float] | None  # [K]; None: not known, or not needed since the times do not shift
    illustrative: bool = False  # assumed, not measured: use beyond it is noted, but is worth no warning
    beyond: str = ""  # what lies outside already, of a material that was brought to a temperature

    def at(self, temperature: Any, factor: Any) -> "Range | None":
        """The range at one temperature [K], where relaxation times are `factor` times longer; None while JAX traces."""
        if is_traced(temperature, factor):
            return None
        kelvin, a = float(temperature), float(factor)
        beyond = self.beyond
        if self.temperature is not None and not _near(np.array(kelvin), self.temperature):
            beyond = f"temperature {kelvin:.6g} K, range {self._words('temperature')}"
        frequency = None if self.frequency else self.frequency
        if self.frequency and 0 < a < np.inf:
            frequency = (self.frequency[0] / a, self.frequency[1] / a)
        return Range(frequency, None, self.illustrative, beyond)

    def outside(self, rate: np.ndarray, temperature: np.ndarray | None) -> Bool[np.ndarray, "..."]:
        """Which passages lie outside: frequencies 2 v a_T/a [rad/s] and temperatures [K], of one shape."""
        outside = np.full(np.shape(rate), bool(self.beyond))
        if self.frequency == ():
            outside |= True
        elif self.frequency:
            low, high = self.frequency
            outside |= (SLOWEST * rate < low * (1 - _ROUNDING)) | (rate > high * (1 + _ROUNDING))
        if self.temperature is not None and temperature is not None:
            outside |= ~_near(temperature, self.temperature)
        return outside

    def findings(
        self, rate: np.ndarray, temperature: np.ndarray | None, of: str = "v a_T/(2a) to 2 v a_T/a"
    ) -> Iterator[str]:
        """What of the range is left, and by how far, in words; `of` says what the rates are."""
        if self.beyond:
            yield self.beyond
        known = rate[np.isfinite(rate)]
        if self.frequency is not None and known.size and self.outside(known, None).any():
            low, high = (significant(float(x), 3) for x in (SLOWEST * known.min(), known.max()))
            words = self._words("frequency") if self.frequency else "empty: the data determine the loss modulus nowhere"
            yield f"{of} from {low} to {high} rad/s, range {words}"
        if self.temperature is None or temperature is None or _near(temperature, self.temperature).all():
            return
        low, high = (f"{float(x):.6g}" for x in (temperature.min(), temperature.max()))
        yield f"temperature from {low} to {high} K, range {self._words('temperature')}"

    def _words(self, key: str) -> str:
        low, high = (significant(x, 6 if key == "temperature" else 3) for x in getattr(self, key))
        return f"{low} to {high} {'K' if key == 'temperature' else 'rad/s'}"

    def table(self) -> dict[str, list[float]]:
        """As the [range] of a material file; an empty list where the moduli are known at no frequency."""
        pairs = {"frequency": self.frequency, "temperature": self.temperature}
        return {key: [float(x) for x in pair] for key, pair in pairs.items() if pair is not None}


def as_range(value: Any, illustrative: bool = False) -> Range | None:
    """A `Range` from one, from None, or from a dict such as {"frequency": (1e-2, 1e6), "temperature": (263.15, 333)}.

    "time" [s] stands for the frequencies 1/t, an empty list of frequencies for none at which the moduli are known.
    Raises `InputError` for other keys, and for what is no pair of ascending positive numbers.
    """
    if value is None or isinstance(value, Range):
        return value
    if not isinstance(value, Mapping) or not set(value) <= set(_KEYS):
        raise InputError(f"range must be a dict with some of the keys {', '.join(_KEYS)}, got {value!r:.80}.")
    pairs: dict[str, tuple[float, float]] = {}
    nowhere = isinstance(value.get("frequency"), (list, tuple)) and not value["frequency"]
    for key, pair in value.items():
        if key == "frequency" and nowhere:
            continue
        try:
            low, high = (float(x) for x in pair)
        except (TypeError, ValueError):
            low = high = float("nan")
        if not 0 < low < high < float("inf"):
            raise InputError(f"range must have two positive numbers for {key}, the lower first, got {pair!r:.80}.")
        pairs[key] = (low, high)
    if "time" in pairs:
        pairs.setdefault("frequency", (1 / pairs["time"][1], 1 / pairs["time"][0]))
    return Range(() if nowhere else pairs.get("frequency"), pairs.get("temperature"), illustrative)


def shared(one: Range | None, other: Range | None) -> Range | None:
    """Where the numbers of two bodies in contact hold; a body without a range does not narrow it."""
    if one is None or other is None:
        return one or other
    frequency, temperature = _overlap(one.frequency, other.frequency), _overlap(one.temperature, other.temperature)
    beyond = one.beyond or other.beyond
    if _apart(frequency) or _apart(temperature):
        beyond = beyond or "two bodies whose ranges do not overlap"
    return Range(
        None if _apart(frequency) else frequency,
        None if _apart(temperature) else temperature or None,
        one.illustrative and other.illustrative,
        beyond,
    )


def with_range(module: T, value: Range | None) -> T:
    """A copy of a material or foundation, its range replaced; a range is no leaf that `eqx.tree_at` could reach."""
    module = copy.copy(module)
    object.__setattr__(module, "range", value)
    return module


def _apart(pair: tuple[float, float] | tuple[()] | None) -> bool:
    return bool(pair) and pair[0] >= pair[1]


def _overlap(
    one: tuple[float, float] | tuple[()] | None, other: tuple[float, float] | tuple[()] | None
) -> tuple[float, float] | tuple[()] | None:
    if one == () or other == ():
        return ()
    if not one or not other:
        return one or other
    return max(one[0], other[0]), min(one[1], other[1])


def _near(kelvin: np.ndarray, pair: tuple[float, float]) -> Bool[np.ndarray, "..."]:
    return (kelvin >= pair[0] - _KELVIN) & (kelvin <= pair[1] + _KELVIN)
