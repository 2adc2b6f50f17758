"""Which frequencies friction comes from: what `em.friction_bands` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, plain, require, significant
from .axes import in_words
from .table import AbstractResult, Column


class FrictionBands(AbstractResult):
    """Friction of a rough surface by the frequency at which it strains the rubber.

    The last axis runs over bands of frequency, even in its logarithm, those before it are the points of the call. The
    bands of a point sum to its friction coefficient, `total`.
    """

    velocity: Float[Array, "... bands"]  # sliding velocity v [m/s]
    frequency: Float[Array, "... bands"]  # middle of the band, angular [rad/s]
    wave_number: Float[Array, "... bands"]  # frequency/v: of waves across the motion [rad/m]
    mu: Float[Array, "... bands"]  # part of the friction coefficient
    error: Float[Array, "... bands"]  # estimated error of the total
    converged: Bool[Array, "... bands"]
    temperature: Float[Array, "... bands"] | None  # T [K]
    pressure: Float[Array, "... bands"] | None  # nominal pressure [Pa]
    width: float = eqx.field(static=True)  # of a band: its upper frequency over its lower one
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)

    quantity: ClassVar[str] = "Friction by frequency"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "temperature", "pressure", "frequency")

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("pressure", "nominal pressure", "Pa", optional=True),
            Column("frequency", "frequency", "rad/s"),
            Column("wave_number", "wave number", "rad/m"),
            Column("mu", "part of the friction coefficient", "-"),
            Column("error", "estimated error of their sum", "-"),
            Column("converged", "converged", ""),
        )

    @property
    def total(self) -> Float[Array, "..."]:
        """The friction coefficient, the sum of its bands."""
        return np.asarray(self.mu).sum(axis=-1)

    def central(self, share: float = 0.8) -> tuple[Float[np.ndarray, "..."], Float[np.ndarray, "..."]]:
        """Frequencies [rad/s] between which the middle `share` of the friction arises, as much below as above.

        Within a band friction counts as even over the logarithm of frequency. Raises `InputError`.
        """
        share = plain("share", share)
        require("share", share, "above 0 and below 1", lambda x: (x > 0) & (x < 1))
        mu, middle = np.asarray(self.mu), np.log(np.asarray(self.frequency))
        half = 0.5 * np.log(self.width)
        found = np.full((2, *mu.shape[:-1]), np.nan)
        for at in np.ndindex(mu.shape[:-1]):
            if np.isfinite(mu[at]).all() and mu[at].sum() > 0:
                below = np.concatenate([[0.0], np.cumsum(mu[at])]) / mu[at].sum()
                edges = np.append(middle[at] - half, middle[at][-1] + half)
                found[(slice(None), *at)] = np.exp(np.interp([0.5 - 0.5 * share, 0.5 + 0.5 * share], below, edges))
        return found[0], found[1]

    def plot(self, ax: Any = None, title: str | None = None, label: str | None = None, colour: Any = None) -> Any:
        """Draws the part of friction per decade of frequency, one line per point; returns matplotlib Axes.

        With `ax=None` on a new figure, which is the `.figure` of the answer. On axes that hold a line already, the
        lines are added to it and to the legend, under `label` or the name of the material; `colour` is that of a
        result of one point.
        """
        from .bands_figure import draw_bands

        return draw_bands(self, ax, title, label, colour)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, and where eight tenths of each point's friction arise."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        low, high = self.central()
        total, velocity = self.total, np.asarray(self.velocity)[..., 0]
        for at in list(np.ndindex(total.shape))[:6]:
            if np.isfinite(total[at]):
                place = f"at {self.named(at) or in_words('velocity', float(velocity[at]))}"
                yield (
                    place,
                    f"mu = {significant(float(total[at]))}, eight tenths of it from "
                    + (f"{significant(float(low[at]), 2)} to {significant(float(high[at]), 2)} rad/s"),
                )
        yield "points", self.reached("error of mu")

    def named(self, at: tuple[int, ...]) -> str:
        """What sets one point apart from the others."""
        words = []
        for name in ("velocity", "temperature", "pressure"):
            values = getattr(self, name)
            if values is not None and np.ptp(values) > 0:
                words.append(in_words(name, float(np.asarray(values)[..., 0][at])))
        return ", ".join(words)
