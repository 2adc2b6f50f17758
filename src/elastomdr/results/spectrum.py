"""Friction and loss divided over the spectrum: what `em.friction_spectrum` and
`em.dissipation` return.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from ..checks import plain, require, significant
from .base import AbstractPoints, Array, quantity, record, setting
from .words import in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.typing import ColorType

    from .._types import Style


@record
class FrictionSpectrum(AbstractPoints):
    """Friction of a rough surface by the frequency at which it strains the rubber.

    The last axis runs over bands of frequency, even in its logarithm, those before it
    are the points of the call. The bands of a point sum to its friction coefficient,
    `total`.
    """

    omega: Array = quantity(
        "angular frequency",
        "rad/s",
        "middle of the band",
        axis="angular frequency of excitation",
    )
    wave_number: Array = quantity(
        "wave number", "rad/m", "omega/v: of waves across the motion"
    )
    mu: Array = quantity(
        "part of the friction coefficient", "-", axis="friction coefficient per decade"
    )
    error: Array = quantity("estimated error of their sum", "-")
    model_error: Array = quantity(
        "model error", "-", "NaN: how far a line's bands are from a surface's"
    )
    width: float = setting()  # of a band: its upper frequency over its lower one

    title: ClassVar[str] = "Friction by frequency"
    across: ClassVar[str] = "omega"
    shows: ClassVar[str] = "mu"
    scale: ClassVar[str] = "log"
    error_of: ClassVar[str] = "mu"
    last: ClassVar[str] = "wave_number"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "temperature",
        "pressure",
        "wave_number",
    )

    @property
    def total(self) -> Array:
        """The friction coefficient, the sum of its bands."""
        return np.asarray(self.mu).sum(axis=-1)

    def central(self, share: float = 0.8) -> tuple[np.ndarray, np.ndarray]:
        """Frequencies [rad/s] between which the middle `share` of the friction arises,
        as much below as above.

        Within a band friction counts as even over the logarithm of frequency. Raises
        `InputError`.
        """
        share = plain("share", share)
        require("share", share, "above 0 and below 1", lambda x: (x > 0) & (x < 1))
        mu, middle = np.asarray(self.mu), np.log(np.asarray(self.omega))
        half = 0.5 * np.log(self.width)
        limits = np.full((2, *mu.shape[:-1]), np.nan)
        for point in np.ndindex(mu.shape[:-1]):
            if np.isfinite(mu[point]).all() and mu[point].sum() > 0:
                below = np.concatenate([[0.0], np.cumsum(mu[point])]) / mu[point].sum()
                edges = np.append(middle[point] - half, middle[point][-1] + half)
                limits[(slice(None), *point)] = np.exp(
                    np.interp([0.5 - 0.5 * share, 0.5 + 0.5 * share], below, edges)
                )
        return limits[0], limits[1]

    def plot(
        self,
        ax: "Axes | None" = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        colour: ColorType | None = None,
    ) -> "Axes":
        """Draws the part of friction per decade of frequency, so that the area under a
        line is its mu.

        `colour` is that of a result of one point; the rest as of every result,
        `Result.plot`.
        """
        from .plot_curves import draw_friction_spectrum
        from .plotting import DrawAsk

        return self._draw(
            partial(draw_friction_spectrum, width=self.width, colour=colour),
            DrawAsk(ax, style, title, label),
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Where eight tenths of each point's friction arise."""
        low, high = self.central()
        total, velocity = self.total, np.asarray(self.velocity)[..., 0]
        for curve in self.curves("wave_number")[1][:6]:
            point = curve.place[:-1]
            if np.isfinite(total[point]):
                share_words = (
                    f"{significant(float(low[point]), 2)} to "
                    f"{significant(float(high[point]), 2)} rad/s"
                )
                place = curve.label or in_words("velocity", float(velocity[point]))
                yield (
                    f"at {place}",
                    (
                        f"mu = {significant(float(total[point]))}, eight tenths of it "
                        f"from {share_words}"
                    ),
                )


@record
class Dissipation(AbstractPoints):
    """Loss of each branch; the last axis of every field runs over the branches of the
    relaxation spectrum.

    A point that failed is NaN, with `converged=False`. `plot` draws the shares against
    relaxation time; that of a parallel dashpot is in the legend.
    """

    time: Array = quantity(
        "relaxation time", "s", "tau_k at the temperature, 0 for a parallel dashpot"
    )
    share: Array = quantity("share of the dissipation", "-", "F_k/F_x", shown="%")
    resistance: Array = quantity(
        "part of the resistance",
        "N",
        "F_k, the branch's part of friction or resistance",
    )
    power: Array = quantity("power", "W", "F_k v, turned into heat")
    normal_force: Array = quantity("normal force", "N", "F_N")
    error: Array = quantity(
        "share not accounted for",
        "-",
        "share of the work that the branches together do not account for",
    )
    model_error: Array = quantity(
        "model error", "-", "NaN: how far shares are from those in three dimensions"
    )

    title: ClassVar[str] = "Where the loss happens"
    figure: ClassVar[str] = "plot_curves.draw_dissipation"
    across: ClassVar[str] = "time"
    shows: ClassVar[str] = "share"
    scale: ClassVar[str] = "log"
    error_of: ClassVar[str] = "the sum of the shares"
    last: ClassVar[str] = "branch"
    coordinates: ClassVar[tuple[str, ...]] = ("velocity", "temperature", "normal_force")

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The branch that dissipates most, at the first and at the last point."""
        time, share, velocity = (
            np.reshape(x, (-1, np.shape(x)[-1]))
            for x in (self.time, self.share, self.velocity)
        )
        for i in {0: None, len(share) - 1: None}:
            if np.isfinite(share[i]).all() and share.shape[1]:
                most = int(share[i].argmax())
                sentence = (
                    f"{significant(100 * float(share[i, most]), 3)} % at tau = "
                    f"{significant(float(time[i, most]), 3)}"
                )
                yield (
                    f"at {significant(float(velocity[i, 0]), 3)} m/s",
                    f"most, {sentence} s",
                )
