"""Indentation over time: what `em.indent` returns."""

from collections.abc import Iterator
from typing import Any, ClassVar

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, as_float64, in_float64, is_traced, not_negative, scalar, significant
from ..errors import InputError
from ..foundation.modes import recovery_modes
from ..mapping.disc import Disc
from ..material.relaxation import Relaxation
from ..solve.control import Course, refined
from ..solve.surface import surface_at
from .axes import in_words
from .table import AbstractResult, Column

_RTOL = 1e-6  # of a depth that is solved again in between
_SHOWN = 4  # histories that a summary lists one by one


class Indentation(AbstractResult):
    """A body pressed into a viscoelastic foundation; every field has one value per instant, time along the last axis.

    `work` is what the body has done on the surface, int F dd. `stored` is the elastic energy of the surface in contact,
    which a withdrawing body can in part get back. `dissipated` is what the material has turned into heat, computed
    apart from the work so that `work - stored - dissipated` is an audit, and `locked`, the elastic energy in surface
    that is out of contact, which turns into heat as that recovers (a renewed contact before that brings it back).
    `error` is the estimated numerical error of what was asked for, the force under a given depth and the depth under a
    given load, over its largest value in the history. An instant that did not converge is NaN with `converged=False`;
    heat for which the audit does not close to `rtol` of the largest work, under a load that falls, is NaN alone.
    With adhesion see `em.indent`.
    """

    time: Float[Array, "..."]  # t [s]
    depth: Float[Array, "..."]  # indentation depth d [m]
    force: Float[Array, "..."]  # F, positive when pressing [N]
    contact_radius: Float[Array, "..."]  # a; under a cylinder the half-width [m]
    work: Float[Array, "..."]  # [J]
    stored: Float[Array, "..."]  # [J]
    locked: Float[Array, "..."]  # [J]
    dissipated: Float[Array, "..."]  # [J]
    error: Float[Array, "..."]  # estimated, relative
    converged: Bool[Array, "..."]
    temperature: Float[Array, ""] | None  # T [K]
    law: Relaxation  # of the elements, at the temperature
    disc: Disc
    course: Course | None  # what was asked for; None with adhesion
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, "..."] | None = None  # whether the material is used beyond its range; None: not known

    quantity: ClassVar[str] = "Indentation"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("time", "time", "s"),
            Column("depth", "depth", "m"),
            Column("force", "force", "N"),
            Column("contact_radius", "contact radius", "m"),
            Column("work", "work", "J"),
            Column("stored", "stored energy", "J"),
            Column("locked", "energy left in free surface", "J"),
            Column("dissipated", "dissipated energy", "J"),
            Column("error", "estimated relative error", "-"),
            Column("converged", "converged", ""),
            Column("extrapolated", "beyond the range of the material", "", optional=True),
        )

    @in_float64
    def pressure(self, r: Any, time: Any) -> Array:
        """Contact pressure p(r) [Pa] at radii [m] and one time [s]: of the shape of r, after the histories' axes.

        p(r) = -(1/pi) int_r^inf q'(x)/sqrt(x^2 - r^2) dx, from the force density q of the line (Popov & Hess 2015, ch.
        3); on a layer q itself. Zero out of contact.
        """
        return self._surface(r, time, "pressure")

    @in_float64
    def displacement(self, r: Any, time: Any) -> Array:
        """Displacement u(r) [m] of the surface, positive into the material, at radii [m] and one time [s].

        u(r) = (2/pi) int_0^r u(x)/sqrt(r^2 - x^2) dx, in contact and out of it: a contact that has ended leaves an
        imprint until it has recovered. On a layer u itself. Shapes as `pressure`.
        """
        return self._surface(r, time, "displacement")

    def _surface(self, r: Any, time: Any, what: str) -> Array:
        if is_traced(self, r, time):
            raise InputError(f"{what} is for numbers: call it outside jit, grad and vmap.")
        r, time = as_float64("r", r), scalar("time", time)
        not_negative("r", r)
        if self.course is None:
            raise InputError(f"{what} is not computed with adhesion.")
        course, modes = self.course, recovery_modes(self.law)
        leading, instants = self.depth.shape[:-1], self.depth.shape[-1]
        rows = [None if part is None else np.reshape(part, (-1, instants)) for part in course]
        values = []
        for i, depth in enumerate(self.depth.reshape(-1, instants)):
            history = Course(*(None if part is None else part[i] for part in rows))
            first, last = history.time[0], history.time[-1]
            if not first <= time <= last:
                raise InputError(f"time must be within the history, {first:g} to {last:g} s, got {float(time):g}.")
            if not np.isfinite(depth).all():
                values.append(np.full(r.shape, np.nan))
                continue
            knots = refined(self.law, modes, self.disc, history, depth, _RTOL)
            surface = surface_at(self.law, modes, self.disc, *knots, float(time))
            values.append(getattr(surface, what)(r))
        return np.stack(values).reshape((*leading, *r.shape))

    def plot(self, ax: Any = None, title: str | None = None, label: str | None = None) -> Any:
        """Draws depth, force and contact radius against time and the force against depth; returns matplotlib Axes.

        With `ax=None` four panels on a new figure, which is the `.figure` of the answer (the first Axes). On axes that
        are given, the force against the depth, under `label`.
        """
        from .indentation_figure import draw

        return draw(self, ax, title, label)

    def png(self, title: str | None = None) -> bytes:
        """The figure as a PNG image, 200 dots per inch."""
        from .indentation_figure import png

        return png(self, title)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, plan, largest depth and force and what is left at the end, failures, the largest error."""
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        yield "plan", str(self.plan)
        fields = {column.key: np.atleast_1d(value) for column, value in self.fields().items()}
        last = fields["depth"].shape[-1]
        rows = {key: value.reshape(-1, last) for key, value in fields.items()}
        for i in range(min(len(rows["depth"]), _SHOWN)):
            name = f"history {i}" if len(rows["depth"]) > 1 else "result"
            yield name, _in_short({key: value[i] for key, value in rows.items()})
        if len(rows["depth"]) > _SHOWN:
            yield "...", f"and {len(rows['depth']) - _SHOWN} more histories"
        yield "instants", self.reached("relative error")


def _in_short(row: dict[str, np.ndarray]) -> str:
    """Largest depth, force and radius of a history, where it ends, and what was dissipated."""
    if not np.isfinite(row["depth"]).any():
        return "no instant converged"

    def most(key: str, name: str) -> str:
        i = int(np.nanargmax(row[key]))
        return f"{in_words(name, float(row[key][i]))} at {significant(float(row['time'][i]))} s"

    known = np.flatnonzero(np.isfinite(row["depth"]))[-1]
    end = f"{in_words('depth', float(row['depth'][known]))}, {in_words('load', float(row['force'][known]))}"
    text = f"deepest {most('depth', 'depth')}; largest force {most('force', 'load')}; "
    text += f"largest radius {most('contact_radius', 'radius')}; at the end {end}"
    if np.isfinite(row["dissipated"][known]):
        lost, work = (significant(float(row[key][known])) for key in ("dissipated", "work"))
        text += f"; dissipated {lost} J of {work} J"
    return text
