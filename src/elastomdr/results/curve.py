"""Friction and rolling resistance against velocity: what `em.friction` and `em.rolling` return."""

from collections.abc import Iterator
from typing import Any, ClassVar, NamedTuple

import equinox as eqx
import numpy as np
from jaxtyping import Bool, Float

from .._runtime import Array, significant
from ..errors import InputError
from .axes import in_words, peak
from .friction_law import FrictionLaw, gridded
from .table import AbstractResult, Column

_SHOWN = 6  # curves that a summary lists one by one


class Contact(NamedTuple):
    """Where the contact begins and ends on the central line, both counted from the apex."""

    leading: Float[Array, "..."]  # leading edge a, ahead of the apex [m]
    trailing: Float[Array, "..."]  # trailing edge b, behind the apex [m]


class Rough(NamedTuple):
    """What belongs to a rough line or surface only; a field that does not apply is None."""

    pressure: Float[Array, "..."] | None  # nominal pressure p [Pa]
    share: Float[Array, "..."]  # share of the line in contact; NOT the real contact area of the surface
    scatter: Float[Array, "..."] | None  # standard error of mu over the lines of the ensemble
    outside: Float[Array, "..."] | None  # share of <|grad h|^2> excited beyond the frequencies of the material's data
    seeds: int  # lines in the ensemble
    rise: Float[Array, "..."] | None = None  # flash temperature, above `temperature` [K]
    cold: Float[Array, "..."] | None = None  # mu without heating
    heat: Float[Array, "..."] | None = None  # heat flux into the rubber, mu p v [W/m^2]


class AbstractCurve(AbstractResult):
    """A coefficient against velocity, and what belongs to each of its points."""

    velocity: eqx.AbstractVar[Float[Array, "..."]]
    error: eqx.AbstractVar[Float[Array, "..."]]
    converged: eqx.AbstractVar[Bool[Array, "..."]]

    quantity: ClassVar[str]  # what the curve is called in a title
    symbol: ClassVar[str]  # what its coefficient is called in a sentence
    coefficient_field: ClassVar[str]  # the field that a figure shows against velocity

    def plot(self, ax: Any = None, title: str | None = None, label: str | None = None, measured: Any = None) -> Any:
        """Draws the coefficient against velocity, one line per temperature, load or depth; returns matplotlib Axes.

        With `ax=None` on a new figure, which is the `.figure` of the answer. On axes that hold a curve already, this
        one is added to it and to the legend, under `label` or the name of its material. `measured` points are drawn
        on top: a mapping with "velocity" [m/s], "mu" and, if known, "temperature" [K], lists of the same length.
        """
        from .figure import draw

        return draw(self, ax, title, label, measured)

    def png(self, title: str | None = None, measured: Any = None) -> bytes:
        """The figure as a PNG image, 200 dots per inch."""
        from .figure import png

        return png(self, title, measured)

    def findings(self) -> Iterator[tuple[str, str]]:
        """Inputs, model, largest coefficient and where, both ends, how many points failed, the largest error."""
        fields = {column.key: value for column, value in self.fields().items()}
        yield "quantity", self.quantity
        yield from self.inputs
        yield "model", self.model
        _, all_curves = self.curves()
        for curve in all_curves[:_SHOWN]:
            velocity, value, beyond = (
                np.atleast_1d(fields.get(k, np.zeros(fields["error"].shape, dtype=bool))[curve.at])
                for k in ("velocity", self.coefficient_field, "extrapolated")
            )
            yield "at " + curve.label if curve.label else "result", self._extremes(velocity, value, beyond)
        if len(all_curves) > _SHOWN:
            yield "...", f"and {len(all_curves) - _SHOWN} more curves"
        yield "points", self.reached(f"error of {self.symbol}")
        if "model_error" in fields and np.isfinite(fields["model_error"]).any():
            bound, value = (fields[key].ravel() for key in ("model_error", self.coefficient_field))
            yield "model error", self._model_error(bound, value)

    def _model_error(self, bound: np.ndarray, value: np.ndarray) -> str:
        worst = int(np.nanargmax(bound))
        if bound[worst] == 0:
            return "none, the model is exact by definition"
        share = significant(100 * float(bound[worst] / value[worst]), 2)
        return f"{self.symbol} is off the half-space's by {significant(float(bound[worst]), 2)} ({share} %) at most"

    def _extremes(self, velocity: np.ndarray, value: np.ndarray, beyond: np.ndarray) -> str:
        order = np.argsort(velocity, kind="stable")
        order = order[np.isfinite(value[order])]
        velocity, value, beyond = velocity[order], value[order], beyond[order]
        top = peak(velocity, value)
        if top is None:
            return "no point converged"

        def point(x: float, y: float) -> str:
            mark = " (extrapolated)" if beyond[np.abs(np.log(velocity / x)).argmin()] else ""
            return f"{significant(y)} at {in_words('velocity', x)}{mark}"

        if np.ptp(velocity) == 0:
            return f"{self.symbol} = " + " to ".join(dict.fromkeys(point(velocity[0], y) for y in (value.min(), top.y)))
        low, high = (point(float(velocity[i]), float(value[i])) for i in (0, -1))
        largest = f"{top.kind} {self.symbol} = {point(top.x, top.y)}"
        if top.inside:
            return f"{largest}; ends: {low}, {high}"
        return f"{largest}, an end of the range; at the other end {low if top.x == velocity[-1] else high}"


class FrictionCurve(AbstractCurve):
    """Friction of an indenter that slides steadily over a viscoelastic foundation; every field has one value per point.

    `mu` is the friction force over the normal force, `error` its estimated numerical error (absolute), `model_error` a
    bound on how far the model is from the half-space (absolute, empirical: `docs/accuracy.md`). It is 0 where the model
    is exact by definition: layers, and the bare line of a `Foundation` given directly. A point that did not
    converge is NaN with `converged=False`. `temperature` is None where none was given, `extrapolated` where the range
    of the material is not known.
    """

    velocity: Float[Array, "..."]  # sliding velocity v [m/s]
    mu: Float[Array, "..."]  # friction coefficient
    normal_force: Float[Array, "..."]  # F_N [N]
    friction_force: Float[Array, "..."]  # F_x, against the motion [N]
    depth: Float[Array, "..."]  # indentation depth d [m]
    contact: Contact | None  # leading and trailing edge [m]; None for a rough line
    error: Float[Array, "..."]  # estimated error of mu
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, "..."] | None = None  # whether the material is used beyond its range; None: not known
    model_error: Float[Array, "..."] | None = None  # bound on the model's error of mu; None: no reduced model
    rough: Rough | None = None  # of a rough line or surface: forces are then per length of line [N/m], contact is None

    quantity: ClassVar[str] = "Friction"
    symbol: ClassVar[str] = "mu"
    coefficient_field: ClassVar[str] = "mu"

    def law(self, cold: bool = False) -> FrictionLaw:
        """mu(v, T, p) on the grid of this curve, to be interpolated, written, and given to `em.traction`.

        Temperature and nominal pressure are axes where they were given. `cold` takes the friction without flash
        heating. Raises `InputError` where the points do not fill a grid.
        """
        fields = {column.key: value.ravel() for column, value in self.fields().items()}
        if cold and "cold" not in fields:
            raise InputError("cold must be False: this curve was computed without heat, and is the cold one.")
        points = {name: fields[name] for name in ("velocity", "temperature", "pressure") if name in fields}
        return gridded({**points, "mu": fields["cold" if cold else "mu"]})

    def findings(self) -> Iterator[tuple[str, str]]:
        """As of every curve; with flash heating also the largest rise in temperature and what it does to mu."""
        yield from super().findings()
        rise, before = (None, None) if self.rough is None else (self.rough.rise, self.rough.cold)
        if rise is not None and before is not None and np.isfinite(rise).any():
            i = int(np.nanargmax(rise))
            most, v, hot, cold = (float(x.ravel()[i]) for x in (rise, self.velocity, self.mu, before))
            text = f"at most {significant(most)} K above the rubber's, at {in_words('velocity', v)}: mu "
            yield "flash temperature", f"{text}{significant(hot)}, without heating {significant(cold)}"

    @property
    def table(self) -> tuple[Column, ...]:
        unit, per = ("N", "") if self.rough is None else ("N/m", " per length")
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            *(() if self.rough is None else _ROUGH),
            Column("mu", "friction coefficient", "-"),
            Column("normal_force", f"normal force{per}", unit),
            Column("friction_force", f"friction force{per}", unit),
            *(_CONTACT if self.rough is None else (c for c in _CONTACT if not c.field.startswith("contact."))),
        )


class RollingCurve(AbstractCurve):
    """Rolling resistance of a body on a viscoelastic foundation; every field has one value per point.

    From the dissipated power P: `resistance` is P/v, `coefficient` that over the normal force (its estimated, absolute
    error is `error`), `moment` is resistance times the rolling radius. A point that did not converge is NaN with
    `converged=False`. `temperature` is None where none was given, `extrapolated` where the range of the material is not
    known.
    """

    velocity: Float[Array, "..."]  # rolling velocity v [m/s]
    coefficient: Float[Array, "..."]  # rolling resistance coefficient
    resistance: Float[Array, "..."]  # resisting force P/v [N]
    moment: Float[Array, "..."]  # resisting moment [N m]
    power: Float[Array, "..."]  # dissipated power P [W]
    normal_force: Float[Array, "..."]  # F_N [N]
    depth: Float[Array, "..."]  # indentation depth d [m]
    contact: Contact  # leading and trailing edge [m]
    error: Float[Array, "..."]  # estimated error of the coefficient
    converged: Bool[Array, "..."]
    temperature: Float[Array, "..."] | None  # T [K]
    model: str = eqx.field(static=True)
    plan: Any = eqx.field(static=True)
    inputs: tuple[tuple[str, str], ...] = eqx.field(static=True)
    extrapolated: Bool[Array, "..."] | None = None  # whether the material is used beyond its range; None: not known
    model_error: Float[Array, "..."] | None = None  # bound on the model's error of the coefficient

    quantity: ClassVar[str] = "Rolling resistance"
    symbol: ClassVar[str] = "coefficient"
    coefficient_field: ClassVar[str] = "coefficient"

    @property
    def table(self) -> tuple[Column, ...]:
        return (
            Column("velocity", "velocity", "m/s"),
            Column("temperature", "temperature", "K", optional=True),
            Column("coefficient", "rolling resistance coefficient", "-"),
            Column("resistance", "resistance", "N"),
            Column("moment", "moment", "N m"),
            Column("power", "dissipated power", "W"),
            Column("normal_force", "normal force", "N"),
            *_CONTACT,
        )


_CONTACT = (
    Column("depth", "depth", "m"),
    Column("contact.leading", "leading edge", "m"),
    Column("contact.trailing", "trailing edge", "m"),
    Column("error", "estimated error of the coefficient", "-"),
    Column("model_error", "bound on the error of the model", "-", optional=True),
    Column("converged", "converged", ""),
    Column("extrapolated", "beyond the range of the material", "", optional=True),
)
_ROUGH = (
    Column("rough.pressure", "nominal pressure", "Pa", optional=True),
    Column("rough.share", "share of the line in contact (not the real contact area)", "-"),
    Column("rough.scatter", "standard error over the lines", "-", optional=True),
    Column("rough.outside", "share of the slope beyond the material's range", "-", optional=True),
    Column("rough.rise", "flash temperature rise", "K", optional=True),
    Column("rough.cold", "friction coefficient without heating", "-", optional=True),
    Column("rough.heat", "heat flux into the rubber", "W/m^2", optional=True),
)
