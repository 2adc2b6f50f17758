"""Coefficients against velocity: what `em.friction`, `em.rolling` and the references of
sliding return; and the ranking of the materials of a friction curve.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from .. import __version__
from ..checks import in_si, percent, significant
from ..errors import InputError
from ..linear_update import Few, apart
from .axes import Quantity
from .base import (
    NORMAL,
    NOT_STATED,
    AbstractPoints,
    Again,
    Array,
    Assumed,
    Change,
    RoadErrors,
    WithTable,
    part,
    quantity,
    record,
    setting,
)
from .doubts import TITLE, Doubt, carried, found, kinds_of_points
from .friction_law import FrictionLaw, Ranked, gridded
from .uncertainty import (
    BEYOND,
    EACH,
    ERRORS,
    FACTOR,
    FITTED,
    HEIGHTS,
    KELVIN,
    KNOWN,
    OUTSIDE,
    SHEAR,
    STRESS,
    SUREST,
    Part,
    Uncertainty,
    changed,
    computed,
    left_out,
    unforetold,
    unknown,
)
from .words import in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..io.data import MeasuredFriction
    from .plot_contacts import SteadyElements

_LISTED = 6  # curves that a summary lists one by one
_OF_RANKING = (
    "rank",
    "material",
    "friction coefficient [-]",
    "uncertainty [-]",
    "ahead of the next [-]",
    "significant",
    TITLE,
)


@part
class Contact:
    """Where the contact begins and ends on the central line, both counted from the
    apex.
    """

    leading: Array = quantity("leading edge", "m", "distance a ahead of the apex")
    trailing: Array = quantity("trailing edge", "m", "distance b behind the apex")


@part
class Lines:
    """What the random lines of `em.Line` have of their own."""

    share: Array = quantity(
        "share of the line in contact (not the real contact area)",
        "-",
        "share of the MDR line in contact",
    )
    scatter: Array | None = quantity(
        "standard error over the lines", "-", "None for one line"
    )
    numerical: Array | None = quantity(
        "estimated numerical error on these lines",
        "-",
        "None for a line given by its heights",
    )
    seeds: int = setting()  # how many lines


@record
class AbstractCurve(AbstractPoints):
    """A coefficient against velocity; `shows` is the field that holds it."""

    strain: Array | None = quantity(
        "effective strain of the contact",
        "-",
        "of a smooth body on a material that softens with strain",
        default=None,
    )
    linear: Array | None = quantity(
        "coefficient without softening",
        "-",
        "of hysteresis, where the material softens with strain",
        default=None,
    )
    error: Array = quantity(
        "estimated error of the coefficient", "-", "numerical, absolute"
    )

    shows: ClassVar[str] = "mu"
    scale: ClassVar[str] = "log"
    error_of: ClassVar[str] = "mu"

    @in_si
    def plot(
        self,
        ax: "Axes | None" = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        measured: Mapping[str, ArrayLike] | None = None,
    ) -> "Axes":
        """Draws the coefficient against velocity, one line per temperature, load or
        depth; returns matplotlib Axes.

        The band around a line is the error, numerical and of the model. Of draws of a
        material (and road) the line is their median, the band holds 95 % of them
        besides.

        Args:
            ax, style, title, label: as of every result, `Result.plot`.
            measured: points to draw on top, a mapping with "velocity" [m/s], "mu" and,
                if known, "temperature" [K], lists of the same length.
        """
        from .plot_curves import draw_curve
        from .plotting import DrawAsk

        if self.drawn:
            ask = DrawAsk(ax, style, title, label)
            return draw_curve(
                self.typical(), ask, measured=measured, spread=self.band()
            )
        return self._draw(
            partial(draw_curve, measured=measured), DrawAsk(ax, style, title, label)
        )

    @property
    def _call(self) -> Again | None:
        """The call of one material, where it can be made once more."""
        return None if isinstance(self.again, tuple) else self.again

    def elements(self, point: int | tuple[int, ...] = 0) -> SteadyElements:
        """What the elements do under a point of a curve by `em.Marched`: u(x), q(x),
        the forces of the branches, with a figure (`plot`) and a GIF (`animate`).

        `point` is its index in the fields of the curve, or in them raveled. Raises
        `InputError` for another model, and for a point that did not converge.
        """
        call, good = self._call, np.asarray(self.converged)
        contact = getattr(self, "contact", None)
        if call is None or contact is None:
            raise InputError(
                argument="model",
                got=self.model,
                accepted="em.Marched() of one material for the elements of a curve",
            )
        shape = good.shape if isinstance(point, tuple) else -1
        places = np.arange(good.size).reshape(shape)
        try:
            i = places[point]
        except IndexError:
            i = np.zeros(0, int)
        if np.ndim(i) or not good.flat[i]:
            raise InputError(
                argument="point",
                got=point,
                accepted=f"the index of a point that converged, of shape {good.shape}",
            )
        return call.elements(int(i), float(np.ravel(contact.leading)[i]))

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Of each curve the largest and the smallest coefficient and where, and the
        largest bound on the model's error.
        """
        every = self.curves()[1]
        shape = np.shape(self.converged)
        points = np.arange(np.size(self.converged)).reshape(shape)
        for curve in every[:_LISTED]:
            kind, said, _ = self.extremes(np.ravel(points[curve.place]))
            yield "at " + curve.label if curve.label else "result", f"{kind} {said}"
        if len(every) > _LISTED:
            yield "...", f"and {len(every) - _LISTED} more curves"
        bound = np.ravel(np.nan if self.model_error is None else self.model_error)
        shown = np.abs(np.ravel(self._shown()))
        share = bound / np.where(shown > 0, shown, np.nan)
        if np.isfinite(share).any():
            most = significant(100 * float(np.nanmax(share)), 2)
            yield (
                "model error",
                f"at most {most} % of the coefficient where it is known",
            )

    def _sure(self, i: int) -> str:
        """The band at a point, and what it consists of."""
        return sure(i, self._shown(), self.error, self.model_error, self._ends())

    def _left_out(self, i: int, drawn: bool) -> str:
        return left_out(self, drawn, self._of_road(i))

    def _of_road(self, i: int) -> Iterator[str]:
        """What the band of a point leaves out beside moduli and temperature."""
        return iter(())

    def uncertainty(
        self,
        *,
        level: float = 0.0,
        cutoff: float = 0.0,
        measured: MeasuredFriction | None = None,
    ) -> Uncertainty:
        """What the coefficient rests on, part by part: numerical, model, rubber, road,
        shear law, temperature; how much of it each may change, and which tests would
        make it surer.

        By convention the shortest wave of a road is changed by a factor of two each
        way, its heights by 10 % or, of a scan, its spectrum by two standard errors, the
        shear stress by 20 %, the temperature by 1 K; presets of `em.AdhesiveShear` and
        `em.Heat` are changed within their bands. The coefficient is computed again for
        each, so that this takes up to eleven times as long as the curve, and 18 times
        more where it leaves the data: there a branch beyond these changes it that they
        allow (`material.validity.beyond_data`). What measured points leave is the linear
        update of shortest wave and shear law, taken as 95 %; where it has no prediction
        nothing is narrowed, and the bound of the model only where they are measured. Of
        draws each part is apart from the others: the rubber's is half of the interval of
        95 % of its draws, on the road as it is.

        Args:
            level: relative standard deviation of C, whose 95 % take the place of the
                convention for the heights; by default that of draws of the road.
            cutoff: the same of its upper cutoff, for the shortest wave.
            measured: friction of this rubber and road, by `em.read_friction`; without
                an error 5 % or, if that is more, the rms of the residuals. Where more
                than 5 % of it is off the curve by more than the band, it narrows nothing,
                which is a doubt.

        Raises `InputError` for several materials that are no draws, and for measured
        friction where the curve is not of that.
        """
        if self.origins and not self.drawn:
            raise InputError(
                argument="material",
                got=list(self.materials),
                accepted="one for an uncertainty",
                hint="choose it by .select(name)",
            )
        if measured is not None and self.shows != "mu":
            raise InputError(
                argument="measured",
                got=self.title,
                accepted="left out but for friction",
            )
        shown, one, drawn = self, self, None
        call, doubts = self._call, self.doubts
        if self.drawn:
            one, drawn = self._of_draws()
            shown, doubts = self.typical(), self.band().doubts
        elif call is not None and (level or cutoff):
            errors = RoadErrors(level, cutoff)
            one = dataclasses.replace(self, again=call.of(call.material, errors))
        found = None if measured is None else one._beside(measured)
        doubts += (found,) if isinstance(found, Doubt) else ()
        parts = [
            drawn if drawn and each.source == drawn.source else each
            for each in one._parts(found)
        ]
        return Uncertainty.of(parts, shown, doubts)

    def _of_draws(self) -> tuple[AbstractCurve, Part | None]:
        """What they are draws of, and the part of the rubber, where that is drawn."""
        one, of_rubber, call = next(self.each_material()), self, self.once
        once = None if call is None else call.curve(Change())
        if call is not None and isinstance(once, AbstractCurve):
            one = dataclasses.replace(once, again=call)
            if not self._rubber_drawn():
                return one, None
            if any(call.errors):  # which the draws hold, too
                again = (call.of(each).curve(Change()) for each in self._rubbers())
                curves = [curve for curve in again if isinstance(curve, AbstractCurve)]
                of_rubber = once.stack(curves, [""] * len(curves), ("", ""))
        low, median, high = of_rubber.band()
        share = 0.5 * (high - low) / np.abs(median)
        said = f"95 % of {len(self.origins)} draws"
        test = "a fit of four times as many measurements"
        return one, Part("rubber", share, said, test, 0.5 * share)

    def _beside(self, measured: MeasuredFriction) -> Few | Doubt:
        """Measured points, where the curve of the same call is at these; or the doubt
        that they tell nothing.
        """
        given = vars(measured).items()
        places = {k: x for k, x in given if k in self.coordinates and x is not None}
        call = self._call and self._call.at(places)
        at, said = call and call.curve(Change()), "cannot be computed at its points"
        if isinstance(at, AbstractCurve) and at._shown().shape == measured.mu.shape:
            at = dataclasses.replace(at, again=call)
            rows, slopes = at._sloped()
            mu = np.where(at._shown() == 0, np.nan, np.abs(at._shown()))
            off, good = np.abs(measured.mu / mu - 1), np.isfinite(slopes).all(axis=0)
            each = half = np.full(mu.size, NORMAL * EACH)
            if measured.error is not None:
                each = half = NORMAL * np.fmax(measured.error / mu, SUREST)
            elif good.any():
                half = np.fmax(half, NORMAL * np.sqrt(np.mean(off[good] ** 2)))
            slopes = np.where(good, slopes, 0.0)
            few = Few(slopes, half, off + half, np.eye(mu.size, dtype=bool))
            held = Uncertainty.of(at._narrowed(rows, slopes, few), at, ())
            out = good & (off > held.half_band() + each)
            if out.sum() <= OUTSIDE * good.sum():
                these, those = self._places()[..., None], at._places()[:, None]
                same = np.isclose(these, those, rtol=1e-3, equal_nan=True)
                return few._replace(same=same.all(axis=0))
            said = f"is off by more than the band at {out.sum()} of {out.size} points"
        told = f"are not made surer by {measured.source}, which {said}"
        surer = "a calibration to points with their temperature and pressure"
        return Doubt("estimate", self.converged | True, told, surer)

    def _places(self) -> np.ndarray:
        """Velocity, temperature and force of the points, flat; NaN where not known."""
        names, none = ("velocity", "temperature", "normal_force"), 0.0 * self.converged
        every = [none + np.array(getattr(self, n), dtype=float) for n in names]
        return np.reshape(every, (3, -1))

    def _sloped(self) -> tuple[list[Part], np.ndarray]:
        """The parts, and how the coefficient changes with those that measured points
        narrow, at each point, NaN where it has no prediction.
        """
        rows, shown = [*self._rows()], self._shown()
        lost = unforetold(self.examined(), shown) | ~np.isfinite(shown)
        told = [p.after for p in rows if p.test == self._measured]
        return rows, np.array([np.where(lost, np.nan, x).ravel() for x in told])

    def _narrowed(self, rows: list[Part], slopes: np.ndarray, few: Few) -> list[Part]:
        """The parts, with the share that measured points leave; the model is not known
        better elsewhere.
        """
        left, told = few.left(slopes), self._measured
        return [
            p._replace(
                share=few.held(p.share)
                if p.source == "model"
                else left.reshape(p.share.shape) * p.share
            )
            if p.test == told
            else p
            for p in rows
        ]

    def _parts(self, measured: Few | Doubt | None) -> Iterator[Part]:
        """The parts, with what measured points leave, and what a few more would."""
        rows, slopes = self._sloped()
        there, told = apart(slopes), self._measured
        each = np.full(there.size, NORMAL * EACH)
        same = np.arange(slopes.shape[1])[:, None] == there
        few = Few(slopes[:, there], each, each, same)
        now, said = rows, ""
        if isinstance(measured, Few):
            now = self._narrowed(rows, slopes, measured)
            said = f", as {measured.error.size} measured points leave it"
            few = measured.beside(few)
        places = "; ".join(map(self._place, there.tolist()))
        test = f"{told}, at {places}" if places else told
        then = self._narrowed(rows, slopes, few)
        for row, after in zip(now, then, strict=True):
            if row.test == told:
                row = row._replace(
                    assumed=row.assumed + said, test=test, after=after.share
                )
            yield row

    def _rows(self) -> Iterator[Part]:
        """The parts; of those that measured points narrow, the slope in place of what
        these leave.
        """
        shown = self._shown()
        yield from computed(self, shown, self.error, self._bound(), self._measured)
        if self.extrapolated is not None and np.any(self.extrapolated):
            share, after = self._beyond(1.0), self._beyond(10.0)
            test = "moduli measured over one more decade at each end"
            said = "by a branch there that the data allow"
            yield Part("rubber beyond its data", share, said, test, after)
        yield from self._further()

    def _beyond(self, wider: float) -> np.ndarray:
        """What moduli beyond the data may change, where these were `wider` at each end;
        NaN where that is not known, as at temperatures beyond them.
        """
        shown = self._shown()
        curves = [self._once_more(Change(wider=wider, beyond=x)) for x in BEYOND]
        ends = [0 * shown + (np.nan if c is None else c._shown()) for c in curves]
        share = np.max(np.abs(np.array(ends) / shown - 1), axis=0)
        left, lost = (
            np.asarray((self._once_more(Change(wider=x)) or self).extrapolated, bool)
            for x in (wider, 1e99)
        )
        return np.where(left, np.where(lost, np.nan, share), 0.0)

    def _once_more(self, change: Change) -> AbstractCurve | None:
        """The curve with one thing changed; None where it cannot be computed."""
        curve = None if self._call is None else self._call.curve(change)
        return curve if isinstance(curve, AbstractCurve) else None

    def _part(self, source: str, off: Assumed, test: str, left: float) -> Part:
        """What is stated or assumed, with the share of it that the test leaves."""
        shown = np.asarray(self._shown(), dtype=float)
        ends = [self._once_more(change) for change in off[1:]]
        share, slope, lost = changed(shown, self.examined(), ends)
        after = slope if test == self._measured else left * share
        return Part(source, share, off.says + lost, test, after)

    @property
    def _measured(self) -> str:
        """The test that tells how far the model is off."""
        return f"3 points of measured {self.title.lower()}, each to {percent(EACH)}"

    def _bound(self) -> Array:
        """The bound of the model, or what the limits leave for it."""
        if ends := self._ends():
            off = [np.abs(end - self._shown()) for end in ends]
            return np.maximum(*off) - self.error
        return 0.0 * self.error if self.model_error is None else self.model_error

    def _further(self) -> Iterator[Part]:
        """The parts that are computed once more."""
        if self.temperature is not None:
            test = "the temperature of the rubber measured to 0.3 K"
            yield self._part("temperature", KELVIN, test, 0.3)

    def _ends(self) -> tuple[Array, Array] | None:
        """Limits that stand for the error and the bound of the model."""
        return None

    def _shown(self) -> Array:
        return getattr(self, self.shows)


def sure(
    i: int,
    shown: Array,
    error: Array,
    bound: Array | None = None,
    ends: tuple[Array, Array] | None = None,
) -> str:
    """The band at a point, of both errors where it has no ends of its own, and what it
    consists of; not negative: what slides or rolls steadily loses energy.
    """
    value, off = (float(np.ravel(x)[i]) for x in (shown, error))
    share = 100 / abs(value) if value else np.nan
    computed = f"computation {significant(share * off, 2)} %"
    if bound is None:
        return f"{computed}, no error of the model"
    half = error + bound
    ends = ends or (shown - half, shown + half)
    model, low, high = (float(np.ravel(x)[i]) for x in (bound, *ends))
    there = (
        f"{significant(max(low, 0.0), 3)} to {significant(high, 3)}"
        if np.isfinite(low + high)
        else "not known"
    )
    if not np.isfinite(model):
        return f"{there} there: no bound on the model ({computed})"
    return f"{there} there ({computed}, model {significant(share * model, 2)} %)"


@record
class FrictionCurve(AbstractCurve):
    """Friction of an indenter or a surface that slides steadily over a viscoelastic
    foundation.

    `mu` is the friction force over the normal force, `error` its estimated numerical
    error, on a surface computed on random lines with twice the standard error of their
    mean (NaN for a single line), `model_error` a bound on how far the model is from the
    half-space (empirical: `docs/accuracy.md`). On `em.springs` it is the distance from
    the layer they stand for and the bound of that. It is 0 where the model is exact by
    definition: a `Foundation` given directly. A point that did not converge is NaN with
    `converged=False`.
    """

    direction: Array | None = quantity(
        "direction", "rad", "angle to the lay of a surface", default=None, shown="°"
    )
    area_ratio: Array | None = quantity(
        "real contact area over nominal area",
        "-",
        "None where the model has none",
        default=None,
    )
    # of `em.Line` on a rough line or surface; forces are then per length of line [N/m]
    lines: Lines | None = None
    outside: Array | None = quantity(
        "share of the slope beyond the material's range",
        "-",
        "share of <|grad h|^2> outside the measured frequencies",
        default=None,
    )
    temperature_rise: Array | None = quantity(
        "flash temperature rise",
        "K",
        "above `temperature`, mean of the places where the heat arises",
        default=None,
    )
    contact_rise: Array | None = quantity(
        "temperature rise of the real contact",
        "K",
        "at the shortest wave, where it differs by scale",
        default=None,
    )
    other_states: Array | None = quantity(
        "other steady states",
        "",
        "whether friction and heat agree at other temperatures, too",
        default=None,
    )
    cold: Array | None = quantity(
        "friction coefficient without heating",
        "-",
        "where flash heating was computed",
        default=None,
    )
    hysteresis: Array | None = quantity(
        "friction coefficient of hysteresis",
        "-",
        "where adhesive shear was asked for; mu without it",
        default=None,
    )
    adhesion: Array | None = quantity(
        "friction coefficient of adhesive shear",
        "-",
        "shear stress times contact area over normal force",
        default=None,
    )
    mu_low: Array | None = quantity(
        "lower limit of the friction coefficient",
        "-",
        "with errors; shear takes away up to 0.3 of the contact",
        default=None,
    )
    mu_high: Array | None = quantity(
        "upper limit of the friction coefficient",
        "-",
        "with errors; shear presses the contact down where the rubber climbs",
        default=None,
    )
    contact_area: Array | None = quantity(
        "contact area",
        "m^2",
        "of a smooth body, from cells or where adhesive shear was asked for",
        default=None,
    )
    heat_flux: Array | None = quantity(
        "heat flux into the rubber",
        "W/m^2",
        "mu p v, less what flows into the road",
        default=None,
    )
    road_share: Array | None = quantity(
        "share of the heat that flows into the road", "-", default=None
    )
    mu: Array = quantity(
        "friction coefficient", "-", "friction force over normal force"
    )
    normal_force: Array = quantity("normal force", "N", "F_N")
    friction_force: Array = quantity("friction force", "N", "F_x against the motion")
    depth: Array | None = quantity(
        "depth", "m", "indentation depth d", default=None, shown="mm"
    )
    # leading and trailing edge [m]; None for a rough line or surface
    contact: Contact | None = None

    title: ClassVar[str] = "Friction"

    def describe(self, q: Quantity) -> Quantity:
        """Forces are per length of a rough line, and per nominal area of a surface."""
        if self.contact is None and q.path in ("normal_force", "friction_force"):
            unit, per = (
                ("N/m", "length") if self.lines is not None else ("Pa", "nominal area")
            )
            return q._replace(label=f"{q.label} per {per}", unit=unit)
        return q

    def _ends(self) -> tuple[Array, Array] | None:
        if self.mu_low is None or self.mu_high is None:
            return None
        return self.mu_low, self.mu_high

    def _of_road(self, i: int) -> Iterator[str]:
        if self.adhesion is not None:
            share = float(np.ravel(self.adhesion)[i] / np.ravel(self.mu)[i])
            yield f"the shear law ({significant(100 * share, 2)} % of mu there)"
        errors = NOT_STATED if self._call is None else self._call.errors
        if self.pressure is not None:
            if not errors.cutoff:
                yield "the shortest wave of the surface"
            if not errors.level:
                yield "the heights of the surface"

    def law(self) -> FrictionLaw:
        """mu(v, T, p) on the grid of this curve, to be interpolated, written, and given
        to `em.traction`.

        Temperature and nominal pressure are axes where they were given. Raises
        `InputError` where the points do not fill a grid, and for several materials.
        """
        if self.origins:
            raise InputError(
                argument="material",
                got=list(self.materials),
                accepted="one for a friction law",
                hint="choose it by .select(name)",
            )
        doubts = carried(self.examined(), np.ravel, failed=True)
        return gridded(_gridded_fields(self), doubts)

    def _further(self) -> Iterator[Part]:
        call = self._call
        shear, heat = (None, None) if call is None else call.bands
        errors = NOT_STATED if call is None else call.errors
        level = errors.heights()
        if self.pressure is not None:
            yield self._part("road", errors.end() or FACTOR, self._measured, 0.0)
            if level is None and call is not None and call.measured:
                test = "a scan of four times the area"
                yield self._part("road sampling", ERRORS, test, 0.5)
            else:
                level = level or HEIGHTS
                left = min(KNOWN / (level.low.higher - 1), 1.0)
                test = f"a scan of the road, its heights known to {percent(KNOWN)}"
                yield self._part("road heights", level, test, left)
        if self.adhesion is not None:
            shear = shear or STRESS
            of_mu = percent(np.nanmean(np.asarray(self.adhesion) / self.mu).item())
            shear = shear._replace(
                says=f"{shear.says}; it makes {of_mu} of mu on average"
            )
            yield self._part("shear law", shear, self._measured, 0.0)
        elif self.pressure is not None:
            yield unknown("shear law", self.mu, "no shear of the real contact", SHEAR)
        if heat is not None:
            test = (
                "conductivity and heat capacity measured, to a quarter of their bands"
            )
            yield self._part("heat", heat, test, 0.25)
        yield from super()._further()

    @in_si
    def ranking(
        self,
        velocity: float | None = None,
        temperature: float | None = None,
        pressure: float | None = None,
    ) -> Ranking:
        """The materials of a list in the order of their friction, and which differences
        are significant.

        Args:
            velocity: [m/s], within the curve; by default the middle of it, on a
                logarithmic scale.
            temperature: [K], by default the middle.
            pressure: nominal [Pa], by default the middle, on a logarithmic scale.

        Raises `InputError` for a single material, and a place outside of the curve.
        """
        return _ranked(self, velocity, temperature, pressure)

    def outcome(self) -> Iterator[tuple[str, str]]:
        """As of every curve; where its parts are known, what they are at the largest
        mu; with flash heating also the largest rise in temperature and what it does to
        mu.
        """
        yield from super().outcome()
        if (
            self.hysteresis is not None
            and self.adhesion is not None
            and np.isfinite(self.mu).any()
        ):
            i = int(np.nanargmax(self.mu))
            one, other = (
                significant(float(np.ravel(x)[i]))
                for x in (self.hysteresis, self.adhesion)
            )
            place = in_words("velocity", float(np.ravel(self.velocity)[i]))
            said = f"hysteresis {one} and adhesive shear {other} where it is largest"
            yield "parts of mu", f"{said}, at {place}"
        # where there are two, that at which moduli and shear stress are taken
        rise, before = self.contact_rise, self.cold
        where = "in the real contact "
        if rise is None:
            rise, where = self.temperature_rise, ""
        if rise is not None and before is not None and np.isfinite(rise).any():
            i = int(np.nanargmax(rise))
            most, hot, cold = (
                significant(float(np.ravel(x)[i])) for x in (rise, self.mu, before)
            )
            place = in_words("velocity", float(np.ravel(self.velocity)[i]))
            said = f"{where}at most {most} K above the rubber's, at {place}"
            yield "flash temperature", f"{said}: mu {hot}, without heating {cold}"


@record
class RollingCurve(AbstractCurve):
    """Rolling resistance of a body on a viscoelastic foundation.

    From the dissipated power P: `resistance` is P/v, `coefficient` that over the normal
    force (its estimated, absolute error is `error`), `moment` is resistance times the
    rolling radius. A point that did not converge is NaN with `converged=False`.
    """

    velocity: Array = quantity(
        "velocity", "m/s", "rolling velocity v", axis="rolling velocity"
    )
    coefficient: Array = quantity(
        "rolling resistance coefficient", "-", "resistance over normal force"
    )
    resistance: Array = quantity("resistance", "N", "P/v")
    moment: Array = quantity("moment", "N m", "resistance times the rolling radius")
    power: Array = quantity("dissipated power", "W", "P")
    normal_force: Array = quantity("normal force", "N", "F_N")
    depth: Array = quantity("depth", "m", "indentation depth d", shown="mm")
    contact: Contact

    title: ClassVar[str] = "Rolling resistance"
    shows: ClassVar[str] = "coefficient"
    error_of: ClassVar[str] = "the coefficient"


@record
class HalfPlaneCurve(AbstractCurve):
    """Friction of a cylinder that slides steadily across its axis over a half-plane,
    per length of the cylinder.

    `em.reference.half_plane_sliding` returns it.
    """

    mu: Array = quantity("friction coefficient", "-", "friction force over load")
    load_per_length: Array = quantity("load per length", "N/m")
    friction_per_length: Array = quantity("friction force per length", "N/m")
    contact: Contact

    title: ClassVar[str] = "Friction"
    coordinates: ClassVar[tuple[str, ...]] = (
        "velocity",
        "temperature",
        "load_per_length",
    )


@record
class HalfSpaceCurve(AbstractCurve):
    """Friction of a map of heights that slides steadily over a half-space, for one cell
    of the periodic array.

    `em.reference.half_space_sliding` returns it for a `cell`.
    """

    mu: Array = quantity(
        "friction coefficient", "-", "friction force over normal force"
    )
    normal_force: Array = quantity("normal force", "N", "of one cell")
    friction_force: Array = quantity("friction force", "N", "of one cell")
    area: Array = quantity("contact area over cell area", "-")
    separation: Array = quantity("mean distance of the surfaces", "m")

    title: ClassVar[str] = "Friction"


@dataclass(frozen=True, eq=False, repr=False)
class Ranking(WithTable):
    """What `FrictionCurve.ranking` returns: `places`, best grip first, and where they
    hold.

    An uncertainty is the numerical error and what the fitted series misses of the
    measured moduli, no more: the error of the model is common to all materials and left
    out. The difference of two neighbours is significant where it exceeds the root of
    the sum of the squares of both. Of a material whose fit has no record, such as an
    illustrative one, and beyond the data of either it is not known.
    """

    places: tuple[Ranked, ...]
    velocity: float  # [m/s]
    temperature: float | None  # [K]
    pressure: float | None  # nominal [Pa]
    curve: FrictionCurve

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """Those of the places, one point each."""
        doubts = (doubt for place in self.places for doubt in place.doubts)
        return carried(doubts, failed=True)

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

    def headline(self) -> Iterator[tuple[str, str]]:
        """What a command prints: where it holds, and the places in order."""
        yield "ranking", f"by friction at {self.where()}"
        width = max(len(place.material) for place in self.places)
        for i, place in enumerate(self.places, 1):
            yield str(i), f"{place.material:<{width}}  {place.words()}"

    def words(self) -> Iterator[str]:
        """The lines of `summary`."""
        yield from (f"{name:<8}{words}" for name, words in self.headline())
        for place in self.places:
            for doubt in place.doubts:
                yield f"{place.material}, {doubt.kind}: {doubt.says}"
        yield (
            "uncertainty: numerical error and misfit of the material; the model error, "
            "common to all, is left out"
        )

    def summary(self) -> str:
        """The ranking in a few lines."""
        return "\n".join(self.words())

    def header(self) -> list[str]:
        """Where it holds, doubts, and what an uncertainty is."""
        said = list(self.words())[1 + len(self.places) :]
        return [f"elastomdr {__version__}: ranking by friction", self.where(), *said]

    def columns(self) -> dict[str, np.ndarray]:
        """The places; what is not known is NaN, or an empty text."""
        words = {True: "yes", False: "no", None: ""}
        rows = [
            (
                rank,
                place.material,
                place.mu,
                place.uncertainty,
                place.ahead,
                words[place.significant],
                str(kinds_of_points(place.doubts, ())),
            )
            for rank, place in enumerate(self.places, 1)
        ]
        return dict(
            zip(_OF_RANKING, map(np.array, zip(*rows, strict=True)), strict=True)
        )

    def plot(self, style: Style | None = None, *, title: str | None = None) -> Axes:
        """Draws friction against velocity at this temperature and the ranking beside
        it; returns the left Axes.
        """
        from .plot_curves import draw_ranking
        from .plotting import DrawAsk

        laws = [self.curve.select(place.material).law() for place in self.places]
        order = [self.curve.materials.index(place.material) for place in self.places]
        point = {"temperature": self.temperature, "pressure": self.pressure}
        at = {name: x for name, x in point.items() if x is not None}
        ranked = list(zip(self.places, laws, order, strict=True))
        ask = DrawAsk(None, style, title)
        return draw_ranking(ranked, self.where(), self.velocity, at, ask)

    def __repr__(self) -> str:
        return self.summary()


def _ranked(
    curve: FrictionCurve,
    velocity: float | None,
    temperature: float | None,
    pressure: float | None,
) -> Ranking:
    """The ranking of the materials of a curve; see `FrictionCurve.ranking`."""
    if not curve.origins:
        raise InputError(
            argument="material",
            got=None,
            accepted="a list for a ranking, em.friction([a, b], ...)",
        )
    laws = {name: _laws(curve.select(name)) for name in curve.materials}
    axes = next(iter(laws.values()))[0].axes()
    asked = {"velocity": velocity, "temperature": temperature, "pressure": pressure}
    for name, value in asked.items():
        if value is not None and name not in axes:
            raise InputError(
                argument=name,
                got=value,
                accepted="left out: the curve was computed without one",
            )
    point: dict[str, Any] = {
        name: float(_middle(name, np.asarray(axis)) if given is None else given)
        for name, axis in axes.items()
        for given in [asked[name]]
    }
    places = [
        Ranked(
            name,
            float(mu(**point)),
            float(error(**point)) if fitted else np.nan,
            np.nan,
            None,
            found(mu.doubts_at(**point)),
        )
        for name, (mu, error, fitted) in laws.items()
    ]
    places.sort(key=lambda place: -place.mu if np.isfinite(place.mu) else np.inf)
    return Ranking(
        tuple(_led(places)),
        point["velocity"],
        point.get("temperature"),
        point.get("pressure"),
        curve,
    )


def _led(places: list[Ranked]) -> Iterator[Ranked]:
    """Places in order, with their leads."""
    for place, following in pairwise([*places, None]):
        if place is not None and following is not None:
            ahead = place.mu - following.mu
            both = np.hypot(place.uncertainty, following.uncertainty)
            kinds = {doubt.kind for doubt in (*place.doubts, *following.doubts)}
            known = np.isfinite(both + ahead) and "extrapolated" not in kinds
            leads = bool(ahead > both) if known else None
            yield place._replace(ahead=ahead, significant=leads)
        elif place is not None:
            yield place


def _laws(curve: FrictionCurve) -> tuple[FrictionLaw, FrictionLaw, bool]:
    """mu and its uncertainty as they are interpolated, and whether the latter knows of
    the material's fit.
    """
    points = _gridded_fields(curve) | {"mu": np.abs(np.ravel(curve.error))}
    return curve.law(), gridded(points), FITTED in dict(curve.inputs)


def _gridded_fields(curve: FrictionCurve) -> dict[str, np.ndarray]:
    """mu, and the points it is at, flat."""
    names = ("velocity", "temperature", "pressure", "mu")
    fields = curve.fields().items()
    return {q.key: value.ravel() for q, value in fields if q.key in names}


def _middle(name: str, axis: np.ndarray) -> float:
    """The middle of an axis: of velocities and pressures that of their logarithms."""
    low, high = float(axis[0]), float(axis[-1])
    return (
        0.5 * (low + high)
        if name == "temperature"
        else min(max(float(np.sqrt(low * high)), low), high)
    )
