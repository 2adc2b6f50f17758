"""Indentation over time: what `em.indent` returns."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from ..checks import (
    as_float64,
    in_float64,
    is_traced,
    not_negative,
    scalar,
    significant,
)
from ..errors import InputError
from ..results.base import Array, quantity, record
from ..results.words import in_words
from .history_result import AbstractHistory

if TYPE_CHECKING:
    from .._types import ArrayLike, Number
    from .surface_fields import Elements

_SHOWN = 4  # histories that a summary lists one by one


@record
class Indentation(AbstractHistory):
    """A body pressed into a viscoelastic foundation; every field has one value per
    instant, time along the last axis.

    `work` is what the body has done on the surface, int F dd. `stored` is the elastic
    energy of the surface in contact, which a withdrawing body can in part get back.
    `dissipated` is what the material has turned into heat, computed apart from the work
    so that `work - stored - dissipated` is an audit, and `locked`, the elastic energy
    in surface that is out of contact, which turns into heat as that recovers (a renewed
    contact before that brings it back). `error` is the estimated numerical error of
    what was asked for, the force under a given depth and the depth under a given load,
    over its largest value in the history. An instant that did not converge is NaN with
    `converged=False`; heat for which the audit does not close to `rtol` of the largest
    work, under a load that falls, is NaN alone. With adhesion see `em.indent`. `plot`
    draws depth, force and contact radius against time and the force against depth, on
    axes that are given the last alone; with `ax=None` it returns the first of four
    Axes.
    """

    depth: Array = quantity("depth", "m", "indentation depth d", shown="mm")
    force: Array = quantity("force", "N", "F, positive where it presses")
    contact_radius: Array = quantity(
        "contact radius", "m", "a; under a cylinder the half-width", shown="mm"
    )
    work: Array = quantity("work", "J", "done by the body on the surface")
    stored: Array = quantity("stored energy", "J", "elastic, of the surface in contact")
    locked: Array = quantity(
        "energy left in free surface", "J", "elastic, out of contact"
    )
    dissipated: Array = quantity("dissipated energy", "J", "with what is locked")
    error: Array = quantity(
        "estimated relative error", "-", "over the largest value in the history"
    )
    temperature: Array | None = quantity(
        "temperature", "K", "of the whole history", default=None, dims=""
    )
    # and their history, from which `pressure` follows; None with adhesion
    surface: Elements | None = None

    title: ClassVar[str] = "Indentation"
    figure: ClassVar[str] = "plot_contacts.draw_indentation"
    across: ClassVar[str] = "depth"
    shows: ClassVar[str] = "force"
    error_of: ClassVar[str] = "force or depth, relative"

    @in_float64
    def pressure(self, r: ArrayLike, time: Number) -> np.ndarray:
        """Contact pressure p(r) [Pa] at radii [m] and one time [s]: of the shape of r,
        after the histories' axes.

        p(r) = -(1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx, from the force density q of
        the line (Popov & Hess 2015, ch. 3); on a layer q itself. Zero out of contact.
        """
        return self._surface(r, time, "pressure")

    @in_float64
    def displacement(self, r: ArrayLike, time: Number) -> np.ndarray:
        """Displacement u(r) [m] of the surface, positive into the material, at radii
        [m] and one time [s].

        u(r) = (2/pi) int_0^r u(x)/sqrt(r^2 - x^2) dx, in contact and out of it: a
        contact that has ended leaves an imprint until it has recovered. On a layer u
        itself. Shapes as `pressure`.
        """
        return self._surface(r, time, "displacement")

    def _surface(self, r: Any, time: Any, what: str) -> np.ndarray:
        if is_traced(self, r, time):
            raise InputError(
                f"{what} is for numbers: call it outside jit, grad and vmap."
            )
        r, time = as_float64("r", r), scalar("time", time)
        not_negative("r", r)
        if self.origins:
            return np.stack(
                [one._surface(r, time, what) for one in self.each_material()]
            )
        if self.surface is None:
            raise InputError(f"{what} is not computed with adhesion.")
        return self.surface.at(np.asarray(self.depth), r, float(time), what)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Largest depth and force, and what is left at the end."""
        yield "plan", str(self.plan)
        fields = {q.key: np.atleast_1d(value) for q, value in self.fields().items()}
        last = fields["depth"].shape[-1]
        rows = {key: value.reshape(-1, last) for key, value in fields.items()}
        for i in range(min(len(rows["depth"]), _SHOWN)):
            name = f"history {i}" if len(rows["depth"]) > 1 else "result"
            yield name, _in_short({key: value[i] for key, value in rows.items()})
        if len(rows["depth"]) > _SHOWN:
            yield "...", f"and {len(rows['depth']) - _SHOWN} more histories"


def _in_short(row: dict[str, np.ndarray]) -> str:
    """Largest depth, force and radius of a history, where it ends, and what was
    dissipated.
    """
    if not np.isfinite(row["depth"]).any():
        return "no instant converged"

    def most(key: str, name: str) -> str:
        i = int(np.nanargmax(row[key]))
        return (
            f"{in_words(name, float(row[key][i]))} at "
            f"{significant(float(row['time'][i]))} s"
        )

    known = np.flatnonzero(np.isfinite(row["depth"]))[-1]
    end = (
        f"{in_words('depth', float(row['depth'][known]))}, "
        f"{in_words('load', float(row['force'][known]))}"
    )
    text = f"deepest {most('depth', 'depth')}; largest force {most('force', 'load')}; "
    text += f"largest radius {most('contact_radius', 'radius')}; at the end {end}"
    lost, work = (float(row[key][known]) for key in ("dissipated", "work"))
    if np.isfinite(lost):
        text += f"; dissipated {significant(lost)} J"
        # Adhesion pulls the body in, so that less than nothing may have been put in, or
        # less than was dissipated.
        text += (
            f" of {significant(work)} J"
            if work >= lost
            else f"; work of the body {significant(work)} J"
        )
    return text
