"""`em.fit.adhesion`: the adhesive shear that measured friction leaves to hysteresis,
with profile intervals.

Measured friction is hysteresis + tau(v, T) s, with s the real contact area over the
normal force, both computed. The logarithm of tau is a parabola in log v + log a_T, so
that stress, velocity and width are its height, place and bend; the bend and the place
are known badly where the velocities see one flank only, and intervals must not be
symmetric. Each parameter is therefore moved, all others found anew, until the sum of
squares has grown by Student's t^2.
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, ClassVar, Literal, NamedTuple, TypeAlias

import numpy as np

from ..checks import as_float64, in_si, plain, positive, require
from ..errors import InputError
from ..io.data import MeasuredFriction
from ..material.shift import GAS_CONSTANT, Arrhenius
from ..results.axes import Label
from ..results.curve import FrictionCurve
from ..results.friction_law import gridded
from ..rough.adhesion import AdhesiveShear
from .report import AbstractWithTable, tell

if TYPE_CHECKING:
    from jaxtyping import Bool, Float, Int
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style

UNITS = {
    "stress": "Pa",
    "velocity": "m/s",
    "width": "-",
    "energy": "J/mol",
    "q_high": "rad/m",
}
_SAME = 1.0  # of temperatures that are one [K]
_LN10 = float(np.log(10.0))
_LIMITS = {
    "stress": (np.log(1e2), np.log(1e12)),
    "width": (0.0, 20.0),
    "energy": (0.0, 5.0),
}
# decades beyond the measured velocities, as far as a summit of the stress is looked for
_FAR = 8.0
# tried to begin with
_WIDTHS = (0.02, 0.08, 0.3, 1.0)
_ENERGIES = (0.3, 0.6, 0.9, 1.3, 2.0)
_PLACES = 9
_CUTOFFS = 7
_MISFIT = 1.5  # rms of the residuals over the error given, doubted
_PLACES_OF = ("velocity", "temperature", "pressure")  # of a point
_STARTS = 3  # of these, the best, from which the search sets out

# of ln q: hysteresis and area of contact over normal force [1/Pa] at the points
Parts: TypeAlias = Callable[[float | None], tuple[np.ndarray, np.ndarray]]
Ends: TypeAlias = tuple[float, float]
# of one compound, or by the cutoff of its surface
Curves: TypeAlias = FrictionCurve | Mapping[float, FrictionCurve]


@dataclass(frozen=True, eq=False, repr=False)
class AdhesionFit(AbstractWithTable):
    """A shear law fitted to measured friction, its parameters with 95 % intervals, and
    both parts at each point.
    """

    law: AdhesiveShear  # for em.friction(adhesion=)
    q_high: float | None  # cutoff of the surface, where it was free [rad/m]
    # stress [Pa], velocity [m/s], width, energy [J/mol], q_high [rad/m]
    parameters: dict[str, float]
    # 95 %; infinite, or 0, where the data do not bound a parameter
    interval: dict[str, tuple[float, float]]
    velocity: Float[np.ndarray, " n"]  # [m/s]
    temperature: Float[np.ndarray, " n"] | None  # [K]
    measured: Float[np.ndarray, " n"]
    hysteresis: Float[np.ndarray, " n"]  # computed, held
    adhesion: Float[np.ndarray, " n"]  # fitted
    residuals: Float[np.ndarray, " n"]  # measured minus both
    # False where the contact did not converge: such a point counts for nothing
    used: Bool[np.ndarray, " n"]
    # standard deviation of each point, given or estimated
    error: Float[np.ndarray, " n"]
    reference: float | None  # temperature of `velocity` of the law [K]
    # stress where hysteresis is off by the bound of its model [Pa]
    level: tuple[float, float] | None
    compound: Int[np.ndarray, " n"]  # which of several each point is of, from 0
    warnings: tuple[str, ...]
    converged: bool

    title: ClassVar[str] = "adhesive shear"
    intervals: ClassVar[str] = "95 %, by the profile of the sum of squares"

    @property
    def carried(self) -> tuple[float, ...]:
        """The stress with which each compound by itself would be closest to its
        measurement, over that of all: how well the law carries from one to another.
        """
        found = []
        for number in np.unique(self.compound):
            here = self.used & (self.compound == number)
            shape, left = self.adhesion / self.error, self.residuals / self.error
            found.append(
                1 + float(shape[here] @ left[here] / (shape[here] @ shape[here]))
            )
        return tuple(found)

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the fit, as pairs of a name and a text."""
        for name, value in self.parameters.items():
            low, high = self.interval[name]
            yield (
                name,
                f"{value:.4g} {UNITS[name]}   ({low:.3g} to {high:.3g})".replace(
                    " -   ", "   "
                ),
            )
        if self.reference is not None:
            yield "reference", f"{self.reference - 273.15:.5g} degC, of velocity"
        share = self.adhesion[self.used] / (self.adhesion + self.hysteresis)[self.used]
        yield "adhesion", f"{share.min():.0%} to {share.max():.0%} of the friction"
        rms = float(np.sqrt(np.mean(self.residuals[self.used] ** 2)))
        yield (
            "residuals",
            (
                f"{rms:.3g} rms of {int(self.used.sum())} points, error of a point "
                f"{self.error.mean():.3g}"
            ),
        )
        if self.compound.any():
            alone = ", ".join(f"{times:.3g}" for times in self.carried)
            yield "compounds", f"stress of each by itself over that of all: {alone}"
        if self.level is not None:
            low, high = self.level
            yield (
                "model",
                (
                    f"stress {low:.4g} to {high:.4g} Pa where hysteresis is off by its "
                    "model error"
                ),
            )
        yield (
            "area",
            "what the real contact area is off goes into the stress one to one",
        )
        for warning in self.warnings:
            yield "warning", warning

    def columns(self) -> dict[str, np.ndarray]:
        """Measured points with both parts of the friction, one row per point."""
        columns = {
            "velocity [m/s]": self.velocity,
            "temperature [K]": self.temperature,
            "compound": self.compound + 1 if self.compound.any() else None,
            "measured friction coefficient [-]": self.measured,
            "hysteresis [-]": self.hysteresis,
            "adhesive shear [-]": self.adhesion,
            "residual [-]": self.residuals,
            "standard deviation of a measurement [-]": self.error,
            "used": self.used,
        }
        return {name: x for name, x in columns.items() if x is not None}

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws measured friction with the fitted sum and hysteresis alone, in a style
        of `Result.plot`; returns matplotlib Axes.
        """
        from .drawing import draw_friction, sketch

        low, high = (x / 1e6 for x in self.interval["stress"])
        stress = f"{self.parameters['stress'] / 1e6:.3g} MPa"
        made = sketch(
            (Label("Sliding velocity", "m/s"), Label("Friction coefficient", "-")),
            "Hysteresis and adhesive shear",
            f"stress {stress} ({low:.3g} to {high:.3g}, 95 %)",
            ax,
            style,
        )
        draw_friction(
            made,
            self.velocity,
            self.temperature,
            np.where(self.used, self.measured, np.nan),
            {
                "fitted sum": self.hysteresis + self.adhesion,
                "hysteresis": self.hysteresis,
            },
        )
        return made.finish()


class _FittedPoints(NamedTuple):
    """What is fitted, flat; `off` and all that is made of it leave out points that count
    for nothing.
    """

    log_v: np.ndarray  # log10 of the velocity
    warm: np.ndarray | None  # (1/T - 1/T_ref) 1e5/(R ln 10): decades per 100 kJ/mol
    mu: np.ndarray
    used: np.ndarray  # whether a point counts
    size: np.ndarray  # of those that do: their error, or what it is in proportion to
    parts: Parts
    cutoff: Ends | None  # of ln q

    @property
    def names(self) -> list[str]:
        names = ["stress", "velocity", "width"]
        return (
            names
            + ["energy"] * (self.warm is not None)
            + ["q_high"] * (self.cutoff is not None)
        )

    @property
    def limits(self) -> np.ndarray:
        slow, fast = self.spanned()
        of_data = {
            "velocity": (slow - _FAR, fast + _FAR),
            "q_high": self.cutoff,
        }
        return np.array([(_LIMITS | of_data)[name] for name in self.names], dtype=float)

    def spanned(self) -> Ends:
        """The least and the largest log10 of the velocity."""
        log_v = self.log_v[self.used]
        return float(log_v.min()), float(log_v.max())

    def off(self, p: np.ndarray) -> np.ndarray:
        """Model less measurement, over the size."""
        return (self.model(p) - self.mu)[self.used] / self.size

    def chi(self, p: np.ndarray) -> float:
        """The sum of squares."""
        return float((self.off(p) ** 2).sum())

    def hysteresis(self, p: np.ndarray) -> np.ndarray:
        return self.parts(p[-1] if self.cutoff is not None else None)[0]

    def model(self, p: np.ndarray) -> np.ndarray:
        """mu at ln stress, log10 velocity, width, energy/1e5, ln q_high."""
        x = self.log_v - p[1]
        if self.warm is not None:
            x = x + p[3] * self.warm
        h, s = self.parts(p[-1] if self.cutoff is not None else None)
        return h + np.exp(p[0] - p[2] * x**2) * s


class _MeasuredFriction(NamedTuple):
    """What was measured, flat; None of what is not known."""

    velocity: np.ndarray
    temperature: np.ndarray | None
    pressure: np.ndarray | None
    error: np.ndarray | None
    mu: np.ndarray
    compound: np.ndarray


class _Computed(NamedTuple):
    """What a curve has at the points."""

    hysteresis: np.ndarray
    share: np.ndarray  # area of contact over normal force [1/Pa]
    off: np.ndarray  # the model error of hysteresis


@in_si
def adhesion(
    curve: Curves | Sequence[Curves],
    measured: MeasuredFriction | ArrayLike | Sequence[MeasuredFriction | ArrayLike],
    *,
    error: ArrayLike | Literal["relative"] | None = None,
    reference: float | None = None,
) -> AdhesionFit:
    """The adhesive shear (`em.AdhesiveShear`) with which computed hysteresis comes
    closest to measured friction.

    Stress, velocity and width are fitted, and where the temperatures differ the energy
    of an Arrhenius law for its shift. Hysteresis and real contact area are held as
    computed, or move with the cutoff of the surface.

    Args:
        curve: friction computed without adhesion, with its real contact area: best at
            the measured points themselves, `em.friction(rubber, road,
            velocity=data.velocity, temperature=data.temperature, pressure=p)`; on a
            grid of velocities, temperatures and pressures it is interpolated. With the
            cutoff free, several of them by cutoff, `{q: em.friction(rubber,
            road.ended(q), ...) for q in ...}`, four or more. A list of them, one for
            each of several compounds, is fitted by one law.
        measured: measured friction, as `em.read_friction` returns it, or coefficients
            of the shape of `curve.mu`; with a list of curves a list as long.
        error: standard deviation of a measured mu, one number or one per point; by
            default that of the data's file. If there is none it is estimated, of one
            size for all points, or in proportion to the friction with "relative".
        reference: temperature at which the law has its `velocity` [K]; by default the
            measured one nearest to 20 degC.

    Returns:
        An `AdhesionFit`: `law` for `em.friction(adhesion=)`, `parameters` and their 95
            % `interval`, of several compounds `carried`, the stress that each has by
            itself over the common one, and in `warnings` what the data cannot decide.

    Raises:
        InputError: for a curve without area of contact, points that do not match, and
            fewer points than parameters.

    The intervals contain the scatter of the data, not what the model of hysteresis and
    area is off.
    """
    compounds = [
        (curves, _measured(points, next(iter(curves.values())), number))
        for number, (curves, points) in enumerate(_of_compounds(curve, measured))
    ]
    data = _joined([points for _, points in compounds])
    temperature, mu = data.temperature, data.mu
    computed = {}
    for q in compounds[0][0]:
        parts = [_at_points(curves[q], points) for curves, points in compounds]
        computed[q] = _Computed(*map(np.concatenate, zip(*parts, strict=True)))
    used = np.isfinite(mu)
    for each in computed.values():
        used &= np.isfinite(each.hysteresis) & np.isfinite(each.share)
    if temperature is None:
        reference = None
    elif reference is None:
        reference = float(temperature[np.argmin(np.abs(temperature - 293.15))])
    else:
        reference = float(plain("reference", reference))
    warm = None
    if (
        temperature is not None
        and reference is not None
        and np.ptp(temperature[used]) > _SAME
    ):
        warm = (1 / temperature - 1 / reference) * 1e5 / (GAS_CONSTANT * _LN10)
    known, size = _sizes(error, data, used)
    points = _FittedPoints(
        np.log10(data.velocity), warm, mu, used, size, *_between(computed)
    )
    count = int(used.sum())
    if count <= len(points.names):
        raise InputError(
            argument="measured",
            got=count,
            accepted=f"more points with an answer than the {len(points.names)} "
            f"parameters, {', '.join(points.names)}",
        )
    p, success = _search(points)
    for _ in range(2 if isinstance(error, str) else 0):
        # in proportion to the sum, not to its scatter
        size = np.maximum(points.model(p)[used], 0.05 * mu[used].max())
        points = points._replace(size=size)
        p, success = _descend(points, p)
    freedom = count - p.size
    scale = 1.0 if known else np.sqrt(points.chi(p) / freedom)
    bounds = _intervals(points, p, scale, freedom, known)
    points = points._replace(size=points.size * scale)
    fit = _report(points, data, computed, p, bounds, reference, known, success)
    tell(fit.warnings)
    return fit


def _of_compounds(
    curve: object, measured: object
) -> list[tuple[Mapping[float, FrictionCurve], object]]:
    """The curves by their cutoff, and what was measured, of each compound. Raises
    `InputError`.
    """
    several = isinstance(curve, list)
    curves = [_checked_curves(each) for each in (curve if several else [curve])]
    points = measured if several else [measured]
    cutoffs = {frozenset(each) for each in curves}
    if len(cutoffs) != 1:
        accepted = "one or more, of the same cutoffs"
        raise InputError(argument="curve", got=list(cutoffs), accepted=accepted)
    if not isinstance(points, list) or len(points) != len(curves):
        accepted = f"a list as long as that of the curves, {len(curves)}"
        raise InputError(argument="measured", got=points, accepted=accepted)
    return list(zip(curves, points, strict=True))


def _joined(compounds: list[_MeasuredFriction]) -> _MeasuredFriction:
    """The points of all compounds. Raises `InputError` where some have a temperature or
    an error and others have none.
    """
    columns = {}
    for name in _MeasuredFriction._fields:
        column = [getattr(each, name) for each in compounds]
        given = [values for values in column if values is not None]
        if 0 < len(given) < len(column) and name != "pressure":
            raise InputError(
                argument="measured",
                got=f"{name} of {len(given)} of {len(column)} compounds",
                accepted=f"with {name} for all compounds or for none",
            )
        columns[name] = np.concatenate(given) if len(given) == len(column) else None
    return _MeasuredFriction(**columns)


def _checked_curves(curve: object) -> Mapping[float, FrictionCurve]:
    """The curves by their cutoff; of a single one by 0. Raises `InputError`."""
    curves = curve if isinstance(curve, Mapping) else {0.0: curve}
    are_curves = all(isinstance(each, FrictionCurve) for each in curves.values())
    if not are_curves or len(curves) in (0, 2, 3):
        count = f" of {len(curves)}" if isinstance(curve, Mapping) else ""
        raise InputError(
            argument="curve",
            got=f"{type(curve).__name__}{count}",
            accepted="an em.FrictionCurve, or four or more of them by their cutoff, "
            "{q_high: curve}",
        )
    return curves


def _measured(measured: object, curve: FrictionCurve, number: int) -> _MeasuredFriction:
    """Velocity, temperature, pressure, mu and error of the points, flat."""
    given: MeasuredFriction | FrictionCurve = curve
    if isinstance(measured, MeasuredFriction):
        given, mu, error = measured, measured.mu, measured.error
    else:
        mu, error = np.asarray(as_float64("measured", measured)), None
        if mu.shape != np.shape(curve.mu):
            raise InputError(
                argument="measured",
                got=mu.shape,
                accepted=f"of the shape of the curve, {np.shape(curve.mu)}",
            )
    require("measured", mu, "finite", np.isfinite)

    def flat(value: ArrayLike | None) -> np.ndarray | None:
        return None if value is None else np.asarray(value, dtype=float).ravel()

    return _MeasuredFriction(
        np.ravel(np.asarray(given.velocity, dtype=float)),
        flat(given.temperature),
        flat(given.pressure),
        flat(error),
        mu.ravel(),
        np.full(mu.size, number),
    )


def _at_points(curve: FrictionCurve, data: _MeasuredFriction) -> _Computed:
    """What a curve has at the points. Raises `InputError` where it cannot."""
    if curve.area_ratio is not None and curve.pressure is not None:
        share = curve.area_ratio / curve.pressure
    elif curve.contact_area is not None:
        share = curve.contact_area / curve.normal_force
    else:
        raise InputError(
            argument="curve",
            got=curve.model,
            accepted="one with the real contact area, of a surface under a pressure "
            "by em.Multiscale(), em.Persson() or em.HalfSpace()",
        )
    alone = curve.mu if curve.hysteresis is None else curve.hysteresis
    off = (
        np.zeros(np.shape(alone))
        if curve.model_error is None or curve.adhesion is not None
        else curve.model_error
    )
    values = [np.asarray(x, dtype=float).ravel() for x in (alone, share, off)]
    if _meets(curve, data):
        return _Computed(*values)
    flat = {
        name: np.ravel(getattr(curve, name))
        for name in _PLACES_OF
        if getattr(curve, name) is not None
    }
    asked = {name: getattr(data, name) for name in flat}
    if asked.get("pressure", 0.0) is None and np.ptp(flat["pressure"]) == 0:
        asked["pressure"] = np.full(data.mu.shape, flat["pressure"][0])
    missing = [name for name, value in asked.items() if value is None]
    if missing or (data.temperature is not None and "temperature" not in flat):
        lacking = (
            f"no {missing[0]}"
            if missing
            else "temperatures that the curve was not computed for"
        )
        raise InputError(
            argument="curve",
            accepted=f"computed at the measured points, which have {lacking}",
            hint="give em.friction the velocity, temperature and pressure of the "
            "measurement",
        )
    try:
        laws = (gridded({**flat, "mu": np.abs(x)}) for x in values)
        return _Computed(*(np.asarray(law(**asked)) for law in laws))
    except InputError as problem:
        problem.inside("at the measured points", "curve")
        raise


def _meets(curve: FrictionCurve, data: _MeasuredFriction) -> bool:
    """Whether a curve has been computed at the points themselves."""
    if np.size(curve.mu) != data.mu.size:
        return False
    pairs = [(getattr(curve, name), getattr(data, name)) for name in _PLACES_OF]
    return all(
        np.allclose(np.ravel(of_curve), given, rtol=1e-6)
        for of_curve, given in pairs
        if of_curve is not None and given is not None
    )


def _between(computed: Mapping[float, _Computed]) -> tuple[Parts, Ends | None]:
    """Hysteresis and area by ln q: those computed, or cubics between those at several
    cutoffs; and the ends of ln q.
    """
    if len(computed) == 1:
        (only,) = computed.values()
        return (lambda _: (only.hysteresis, only.share)), None
    from scipy.interpolate import CubicSpline

    q = np.array(sorted(computed))
    positive("curve", q)
    with np.errstate(divide="ignore"):
        logs = np.log([(computed[k].hysteresis, computed[k].share) for k in q])
    whole = np.isfinite(logs).all((0, 1))
    spline = CubicSpline(np.log(q), np.where(whole, logs, 0.0))

    def parts(log_q: float | None) -> tuple[np.ndarray, np.ndarray]:
        h, s = np.where(whole, np.exp(spline(log_q)), np.nan)
        return h, s

    return parts, (float(np.log(q[0])), float(np.log(q[-1])))


def _sizes(
    error: ArrayLike | str | None, data: _MeasuredFriction, used: np.ndarray
) -> tuple[bool, np.ndarray]:
    """Whether the error of each point is known, and what it is, or in proportion to
    what.
    """
    if isinstance(error, str):
        if error != "relative":
            raise InputError(
                argument="error", got=error, accepted="numbers, 'relative' or None"
            )
        mu = np.abs(data.mu)
        return False, np.maximum(mu, 0.05 * mu.max())[used]
    given = data.error if error is None else np.asarray(as_float64("error", error))
    if given is None:
        return False, np.ones(int(used.sum()))
    try:
        given = np.broadcast_to(
            given.ravel() if given.size == data.mu.size else given, data.mu.shape
        )
    except ValueError as problem:
        raise InputError(
            argument="error",
            got=given.shape,
            accepted=f"of the shape of the measured points, {data.mu.shape}",
        ) from problem
    positive("error", given)
    return True, given[used]


def _search(points: _FittedPoints) -> tuple[np.ndarray, bool]:
    """Least squares from the best of many starts, in which the stress follows from all
    else.
    """
    slow, fast = points.spanned()
    axes = [np.linspace(slow - 2.0, fast + 2.0, _PLACES), np.array(_WIDTHS)]
    axes += [] if points.warm is None else [np.array(_ENERGIES)]
    axes += [] if points.cutoff is None else [np.linspace(*points.cutoff, _CUTOFFS)]
    starts = []
    for rest in np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, len(axes)):
        p = np.concatenate([[0.0], rest])
        h = points.hysteresis(p)
        shape = (points.model(p) - h)[points.used] / points.size
        left = (points.mu - h)[points.used] / points.size
        stress = max(float(shape @ left) / max(float(shape @ shape), 1e-300), 1e3)
        starts.append((float(((left - stress * shape) ** 2).sum()), np.log(stress), p))
    starts.sort(key=lambda start: start[0])
    descents = []
    for _, log_stress, p in starts[:_STARTS]:
        p[0] = np.clip(log_stress, *_LIMITS["stress"])
        p, success = _descend(points, p)
        descents.append((points.chi(p), p, success))
    return min(descents, key=lambda one: one[0])[1:]


def _descend(
    points: _FittedPoints, p: np.ndarray, held: int | None = None
) -> tuple[np.ndarray, bool]:
    """Least squares from `p`, the parameter of number `held` as it is."""
    from scipy.optimize import least_squares

    free = np.array([i for i in range(p.size) if i != held])
    low, high = points.limits[free].T

    def whole(x: np.ndarray) -> np.ndarray:
        parameters = p.copy()
        parameters[free] = x
        return parameters

    answer = least_squares(
        lambda x: points.off(whole(x)),
        np.clip(p[free], low + 1e-9, high - 1e-9),
        jac="3-point",
        bounds=(low, high),
        x_scale="jac",
        xtol=1e-10,
        ftol=1e-12,
        gtol=1e-12,
        max_nfev=400,
    )
    return whole(answer.x), bool(answer.success)


def _intervals(
    points: _FittedPoints,
    p: np.ndarray,
    scale: float,
    freedom: int,
    known: bool,
) -> list[tuple[float, float]]:
    """Where the sum of squares, all other parameters found anew, has grown by the
    square of 1.96 or Student's t.
    """
    from scipy.special import ndtri, stdtrit

    times = float(ndtri(0.975) if known else stdtrit(freedom, 0.975))
    allowed = points.chi(p) + (scale * times) ** 2
    step = 1e-5
    columns = [points.model(p + h) - points.model(p - h) for h in step * np.eye(p.size)]
    matrix = np.stack(columns, axis=-1)[points.used] / (2 * step * points.size[:, None])
    spread = (
        np.sqrt(np.maximum(np.diag(np.linalg.pinv(matrix.T @ matrix)), 0.0)) * scale
    )
    return [
        (
            _end(points, p, i, -1, allowed, spread[i]),
            _end(points, p, i, 1, allowed, spread[i]),
        )
        for i in range(p.size)
    ]


def _end(
    points: _FittedPoints,
    p: np.ndarray,
    i: int,
    side: int,
    allowed: float,
    spread: float,
) -> float:
    """One end of the interval of parameter i; the end of what is looked at where it is
    not bounded before.
    """
    from scipy.optimize import brentq

    limit = float(points.limits[i][(side + 1) // 2])
    last = p

    # it depends on where the last search ended: once found, a sign stays
    @functools.cache
    def over(x: float) -> float:
        nonlocal last
        start = last.copy()
        start[i] = x
        last, _ = _descend(points, start, i)
        return points.chi(last) - allowed

    step = 1.96 * float(np.clip(spread, 1e-6, abs(limit - p[i]) or 1e-6))
    inside = x = float(p[i])
    if over(inside) > 0:
        return inside
    while x != limit:
        x = max(x - step, limit) if side < 0 else min(x + step, limit)
        if over(x) > 0:
            return float(brentq(over, inside, x, xtol=2e-3 * abs(x - p[i]), rtol=1e-10))  # pyright: ignore
        inside, step = x, 1.7 * step
    return limit


class _Estimate(NamedTuple):
    """Parameters in their units, and how well they are known."""

    values: dict[str, float]
    interval: dict[str, tuple[float, float]]  # 95 %
    # whether the search reached the lower, the upper limit of a parameter
    open_ends: dict[str, tuple[bool, bool]]


_IN_UNITS: dict[str, Callable[[float], float]] = {
    "stress": np.exp,
    "velocity": lambda x: 10.0**x,
    "width": float,
    "energy": lambda x: 1e5 * x,
    "q_high": np.exp,
}


def _estimate(points: _FittedPoints, p: np.ndarray, bounds: list[Ends]) -> _Estimate:
    """Parameters and intervals from those of the search."""
    values = {
        name: float(_IN_UNITS[name](x)) for name, x in zip(points.names, p, strict=True)
    }
    interval, open_ends = {}, {}
    for name, ends, limits in zip(points.names, bounds, points.limits, strict=True):
        at_low, at_high = (abs(x - y) < 1e-6 for x, y in zip(ends, limits, strict=True))
        low, high = (float(_IN_UNITS[name](x)) for x in ends)
        if name != "q_high":
            low, high = 0.0 if at_low else low, float("inf") if at_high else high
        interval[name], open_ends[name] = (low, high), (at_low, at_high)
    if any(open_ends["velocity"]):  # the further the summit, the higher it is
        interval["stress"] = interval["stress"][0], float("inf")
        open_ends["stress"] = False, True
    return _Estimate(values, interval, open_ends)


def _report(
    points: _FittedPoints,
    data: _MeasuredFriction,
    computed: Mapping[float, _Computed],
    p: np.ndarray,
    bounds: list[Ends],
    reference: float | None,
    known: bool,
    success: bool,
) -> AdhesionFit:
    estimate = _estimate(points, p, bounds)
    values = estimate.values
    shift = None
    if values.get("energy", 0.0) > 0 and reference is not None:
        shift = Arrhenius(values["energy"], reference)
    law = AdhesiveShear(
        values["stress"], values["velocity"], values["width"], shift=shift
    )
    hysteresis, mu = points.hysteresis(p), points.model(p)
    error = np.full(points.mu.shape, np.nan)
    error[points.used] = points.size
    fit = AdhesionFit(
        law=law,
        q_high=values.get("q_high"),
        parameters=values,
        interval=estimate.interval,
        velocity=data.velocity,
        temperature=data.temperature,
        measured=points.mu,
        hysteresis=hysteresis,
        adhesion=mu - hysteresis,
        residuals=points.mu - mu,
        used=points.used,
        error=np.where(points.used, error, np.nanmean(error)),
        reference=reference,
        level=_level(points, computed, p),
        compound=data.compound,
        converged=success,
        warnings=(),
    )
    misfit = float(np.sqrt(np.mean((fit.residuals[points.used] / points.size) ** 2)))
    return replace(
        fit, warnings=tuple(_judge(points, fit, estimate, misfit if known else 0.0))
    )


def _judge(
    points: _FittedPoints, fit: AdhesionFit, estimate: _Estimate, misfit: float
) -> Iterator[str]:
    """What cannot be relied on; `misfit` is the rms of the residuals over the error
    given.
    """
    ends, used = estimate.open_ends, fit.used
    if not fit.converged and not any(ends["velocity"]):
        yield "The search did not converge."
    if missing := int((~used).sum()):
        yield (
            f"{missing} of {used.size} points have no computed hysteresis or contact "
            "area and are left out."
        )
    names = [n for n in ("stress", "velocity", "energy") if any(ends.get(n, ()))]
    if names:
        yield (
            f"{' and '.join(names)} cannot be determined: over "
            f"{float(np.ptp(points.log_v[used])):.2g} decades of velocity the data "
            "show "
            "no maximum of the stress. Measure at lower or higher velocities, or at "
            "more "
            "temperatures."
        )
    if estimate.interval["width"][0] == 0.0:
        yield (
            "width cannot be distinguished from 0: over the measured velocities the "
            "stress is constant, or rises or falls as a power, within the scatter."
        )
    if ends["width"][1]:
        yield (
            "width is not bounded above: the stress falls off within the distance of "
            "two "
            "velocities."
        )
    if points.cutoff is not None and any(ends["q_high"]):
        low, high = np.exp(points.cutoff)
        yield (
            f"q_high reaches the end of the cutoffs that were computed, {low:.3g} to "
            f"{high:.3g} rad/m: compute more."
        )
    if above := int((fit.hysteresis > fit.measured)[used].sum()):
        yield (
            f"At {above} of {int(used.sum())} points the computed hysteresis alone is "
            "above the measured friction."
        )
    if misfit > _MISFIT:
        yield (
            f"Residuals are {misfit:.2g} times the error given: hysteresis and this "
            "law "
            "do not describe the data."
        )
    if fit.temperature is None or points.warm is None:
        yield (
            "Measured at one temperature: how the adhesion shifts with temperature is "
            "not known."
        )


def _level(
    every: _FittedPoints,
    computed: Mapping[float, _Computed],
    p: np.ndarray,
) -> Ends | None:
    """The stress, all else held, where hysteresis is lower and higher by the bound of
    its model.
    """
    off, used = next(iter(computed.values())).off, every.used
    h = every.hysteresis(p)
    if len(computed) > 1 or not (
        np.isfinite(off[used]).all() and (off[used] > 0).any()
    ):
        return None
    shape = ((every.model(p) - h)[used]) / every.size
    if not shape @ shape > 0:
        return None
    up, down = (
        float(
            shape @ ((every.mu - h + side * off)[used] / every.size) / (shape @ shape)
        )
        for side in (1, -1)
    )
    return float(np.exp(p[0]) * max(down, 0.0)), float(np.exp(p[0]) * up)
