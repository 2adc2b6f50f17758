"""Materials in the order of their friction at one velocity and temperature, with what
of the order is significant.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import __version__
from ..checks import significant
from ..errors import InputError
from ..files import csv_text, write_files
from .friction_law import FrictionLaw, gridded
from .words import in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style
    from .curve import FrictionCurve

# the input of a result that tells what a fit misses
FITTED = "material against its data"


class Place(NamedTuple):
    """A material in a ranking."""

    material: str
    mu: float
    # absolute: numerical, and what the material's fit misses of its data; NaN where not
    # known
    uncertainty: float
    ahead: float  # of the next one; NaN for the last
    # whether `ahead` exceeds both uncertainties together; None where one is not known
    significant: bool | None


@dataclass(frozen=True, eq=False, repr=False)
class Ranking:
    """What `FrictionCurve.ranking` returns: `places`, best grip first, and where they
    hold.

    An uncertainty is the numerical error and what the fitted series misses of the
    measured moduli, no more: the error of the model is common to all materials and left
    out. The difference of two neighbours is significant where it exceeds the root of
    the sum of the squares of both. Of a material whose fit has no record, such as an
    illustrative one, it is not known.
    """

    places: tuple[Place, ...]
    velocity: float  # [m/s]
    temperature: float | None  # [K]
    pressure: float | None  # nominal [Pa]
    curve: FrictionCurve

    def where(self) -> str:
        """Velocity, temperature and pressure in words."""
        known = {
            "velocity": self.velocity,
            "temperature": self.temperature,
            "pressure": self.pressure,
        }
        return ", ".join(
            in_words(name, value) for name, value in known.items() if value is not None
        )

    def words(self) -> Iterator[str]:
        """The lines of `summary`."""
        yield f"ranking by friction at {self.where()}"
        width = max(len(place.material) for place in self.places)
        for i, place in enumerate(self.places, 1):
            spread = (
                "(uncertainty not known)"
                if np.isnan(place.uncertainty)
                else f"+- {significant(place.uncertainty, 2)}"
            )
            text = (
                f"{i:>3}  {place.material:<{width}}  mu {significant(place.mu)} "
                f"{spread}"
            )
            if np.isfinite(place.ahead):
                sure = {
                    True: "significant",
                    False: "not significant",
                    None: "not known whether significant",
                }
                text += (
                    f"; ahead by {significant(place.ahead, 2)}, "
                    f"{sure[place.significant]}"
                )
            yield text
        yield (
            "uncertainty: numerical, and of the material's fit; the model's error is "
            "common to all and left out"
        )

    def summary(self) -> str:
        """The ranking in a few lines."""
        return "\n".join(self.words())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes the ranking as comma-separated text, an empty cell for what is not
        known.
        """
        said = {True: "yes", False: "no", None: ""}
        columns = {
            "rank": np.arange(1, len(self.places) + 1),
            "material": np.array([place.material for place in self.places]),
            "friction coefficient [-]": np.array([place.mu for place in self.places]),
            "uncertainty [-]": np.array([place.uncertainty for place in self.places]),
            "ahead of the next [-]": np.array([place.ahead for place in self.places]),
            "significant": np.array([said[place.significant] for place in self.places]),
        }
        header = [
            f"elastomdr {__version__}: ranking by friction",
            self.where(),
            *list(self.words())[-1:],
        ]
        write_files({Path(path): csv_text(header, columns).encode()})

    def plot(self, style: Style | None = None, *, title: str | None = None) -> Axes:
        """Draws friction against velocity at this temperature and the ranking beside
        it; returns the left Axes.
        """
        from .plotting import draw_ranking

        return draw_ranking(self, style, title)

    def __repr__(self) -> str:
        return self.summary()


def ranked(
    curve: FrictionCurve,
    velocity: float | None,
    temperature: float | None,
    pressure: float | None,
) -> Ranking:
    """The ranking of the materials of a curve; see `FrictionCurve.ranking`."""
    if not curve.origins:
        raise InputError(
            "material must be a list for a ranking: em.friction([a, b], ...)."
        )
    laws = {name: _laws(curve.select(name)) for name in curve.materials}
    first = next(iter(laws.values()))[0]
    asked = {"velocity": velocity, "temperature": temperature, "pressure": pressure}
    for name, value in asked.items():
        if value is not None and name not in first.axes():
            raise InputError(
                f"{name} must be left out: the curve was computed without one."
            )
    at: dict[str, Any] = {}
    for name, axis in first.axes().items():
        at[name] = (
            _middle(name, np.asarray(axis)) if asked[name] is None else asked[name]
        )
    found = []
    for name, (law, error, known) in laws.items():
        mu = float(law(**at))
        found.append((name, mu, float(error(**at)) if known else np.nan))
    found.sort(key=lambda one: -one[1] if np.isfinite(one[1]) else np.inf)
    places = []
    for i, (name, mu, own) in enumerate(found):
        _, after, other = found[i + 1] if i + 1 < len(found) else ("", np.nan, np.nan)
        both = np.hypot(own, other)
        sure = None if not np.isfinite(both + after) else bool(mu - after > both)
        places.append(Place(name, mu, own, mu - after, sure))
    every = {name: (float(at[name]) if name in at else None) for name in asked}
    return Ranking(
        tuple(places),
        every["velocity"] or 0.0,
        every["temperature"],
        every["pressure"],
        curve,
    )


def _laws(curve: FrictionCurve) -> tuple[FrictionLaw, FrictionLaw, bool]:
    """mu and its uncertainty as they are interpolated, and whether the latter knows of
    the material's fit.
    """
    fields = {q.key: value.ravel() for q, value in curve.fields().items()}
    points = {
        name: fields[name]
        for name in ("velocity", "temperature", "pressure")
        if name in fields
    }
    error = np.abs(fields["error"])
    return curve.law(), gridded({**points, "mu": error}), FITTED in dict(curve.inputs)


def _middle(name: str, axis: np.ndarray) -> float:
    """The middle of an axis: of velocities and pressures that of their logarithms."""
    low, high = float(axis[0]), float(axis[-1])
    return (
        0.5 * (low + high)
        if name == "temperature"
        else min(max(float(np.sqrt(low * high)), low), high)
    )
