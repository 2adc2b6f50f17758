"""Chosen parameters of a material, a rough surface or a shear law, adjusted to measured
friction or rolling resistance: `em.fit.calibrate`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import ndtri, stdtrit

from ..call.model_choice import is_rough
from ..call.problem import Asked
from ..checks import (
    as_float64,
    in_si,
    one_of,
    positive,
    require,
    scalar,
    whole_number,
)
from ..errors import (
    ConvergenceWarning,
    ExtrapolationWarning,
    InputError,
    ModelWarning,
    closest,
    quiet,
    warn,
)
from ..material.prony import Prony
from ..material.shift import WLF, Arrhenius
from ..material.tabulated import needs_series
from ..results.axes import Label
from ..results.doubts import Doubt, counted_kinds
from ..rough.adhesion import AdhesiveShear
from ..surface.spectrum import AbstractSpectrum
from ..trees import replaced
from ..verbs.roads import doubt_of, for_changes, hint_at_line, of_rough
from .report import TWO_SIGMA, AbstractWithTable, tell

if TYPE_CHECKING:
    from jaxtyping import Bool, Float
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Motion, Style
    from ..call.types import Indenter, Surface
    from ..results.curve import FrictionCurve, RollingCurve

# --------------------------------------------------------------------------------------
# What a calibration may adjust: parameters of a material, of a surface, of a shear law,
# and of what turns one into a coefficient.
#
# All but `slope` are log10 of a factor, so that 0 leaves everything as it is. The
# parameters of a surface act on its spectrum C(q): `q_high` moves where it ends, C below
# stays as it was (beyond a table it goes on as its last power law), `heights` scales all
# heights.
# --------------------------------------------------------------------------------------

MEANINGS = {
    "modulus": "log10 of a factor on all moduli",
    "equilibrium": "log10 of a factor on the equilibrium modulus",
    "slope": "exponent s of a factor (tau/tau_middle)^s on the moduli of the spectrum",
    "time": "log10 of a factor on all relaxation times",
    "c1": "log10 of a factor on the WLF constant c1",
    "c2": "log10 of a factor on the WLF constant c2",
    "q_high": "log10 of a factor on the upper cutoff of the surface's spectrum",
    "heights": "log10 of a factor on the heights of the surface",
    "stress": "log10 of a factor on the largest stress of the shear law",
    "velocity": "log10 of a factor on the velocity of that stress",
    "width": "log10 of a factor on the width of the shear law",
    "energy": "log10 of a factor on the activation energy of the shear law",
    "gain": "log10 of a factor on the computed coefficient",
}

SHEAR = "shear"  # stands for all parameters of the shear law
_UNITS = {  # and how many make one of SI
    "q_high": (" rad/m", 1.0),
    "stress": (" MPa", 1e-6),
    "velocity": (" mm/s", 1e3),
    "width": ("", 1.0),
    "energy": (" kJ/mol", 1e-3),
}
_OF_LAW = ("stress", "velocity", "width", "energy")
# 0.9 eV for the shift of a typical law is of the size found where that is from
_ENERGY, _ROOM = 9e4, 293.15  # [J/mol], [K]
_SAME = 1.0  # of temperatures that are one [K]


def check(
    names: Mapping[str, float], material: Prony, shape: object, scene: Mapping[str, Any]
) -> None:
    """Raises `InputError` for parameters that material, shape or scene do not have."""
    if {"c1", "c2"} & names.keys() and not isinstance(material.shift, WLF):
        raise InputError(
            argument="material",
            got=material,
            accepted="one with a WLF law for the parameters c1 and c2",
        )
    if {"q_high", "heights"} & names.keys() and not isinstance(shape, AbstractSpectrum):
        raise InputError(
            argument="shape",
            got=shape,
            accepted="a surface with a spectrum for the parameters q_high and heights",
        )
    law = scene.get("adhesion")
    for name in names:
        if name in _OF_LAW and name not in _parameters_of(law):
            raise InputError(
                argument="parameters",
                got=name,
                accepted="among those of the shear law in adhesion",
                hint="energy needs an em.Arrhenius as its shift, width one above 0.",
            )


def applied(
    material: Prony,
    shape: Any,
    scene: Mapping[str, Any],
    values: dict[str, Any],
) -> tuple[Prony, Any, dict[str, Any]]:
    """Material, shape and scene with the parameters in them."""
    scene = dict(scene)
    if "q_high" in values:
        shape = shape.ended(shape.q_high * 10.0 ** values["q_high"])
    if "heights" in values:
        shape = shape.raised(10.0 ** values["heights"])
    if set(_OF_LAW) & values.keys():
        scene["adhesion"] = _shear(scene["adhesion"], values)
    return _of_material(material, values), shape, scene


def _parameters_of(law: AdhesiveShear | None) -> dict[str, float]:
    """The parameters of a shear law of which a factor can be found."""
    if law is None:
        return {}
    found = {name: float(getattr(law, name)) for name in _OF_LAW[:3]}
    if isinstance(law.shift, Arrhenius):
        found["energy"] = float(law.shift.energy)
    return {name: value for name, value in found.items() if value > 0}


def _shear(law: AdhesiveShear, values: Mapping[str, float]) -> AdhesiveShear:
    """A shear law with the parameters in it."""
    new = {
        name: value * 10.0 ** values.get(name, 0.0)
        for name, value in _parameters_of(law).items()
    }
    shift = law.shift
    if "energy" in new and isinstance(shift, Arrhenius):
        shift = Arrhenius(new["energy"], shift.reference)
    return AdhesiveShear(
        new["stress"], new["velocity"], new.get("width", 0.0), shift=shift
    )


def _find_law(scene: Mapping[str, Any]) -> Mapping[str, Any]:
    """The shear law of a scene to begin with, a typical one where it has none, and
    with a typical shift where it has none and temperatures differ.
    """
    law, kelvin = scene.get("adhesion"), scene.get("temperature")
    law = AdhesiveShear.preset() if law is None else law
    if kelvin is not None and law.shift is None and np.ptp(kelvin) > _SAME:
        flat = np.ravel(np.asarray(as_float64("temperature", kelvin)))
        reference = float(flat[np.argmin(np.abs(flat - _ROOM))])
        law = replaced(law, shift=Arrhenius(_ENERGY, reference))
    return {"adhesion": law}


def _of_material(material: Prony, values: Mapping[str, float]) -> Prony:
    times, moduli = np.asarray(material.times), np.asarray(material.moduli)
    factor = {name: 10.0 ** values.get(name, 0.0) for name in MEANINGS}
    if "slope" in values and times.size:
        middle = np.exp(np.mean(np.log(times)))
        moduli = moduli * (times / middle) ** values["slope"]
    law = material.shift
    if isinstance(law, WLF):
        law = replaced(law, c1=law.c1 * factor["c1"], c2=law.c2 * factor["c2"])
    return replaced(
        material,
        equilibrium=material.equilibrium * factor["equilibrium"] * factor["modulus"],
        moduli=moduli * factor["modulus"],
        times=times * factor["time"],
        shift=law,
    )


# --------------------------------------------------------------------------------------
# Chosen parameters of a material, or of a rough surface, adjusted to measured friction
# or rolling resistance.
#
# Least squares with Gaussian priors; Jacobians by central differences of whole calls.
# --------------------------------------------------------------------------------------

# standard deviation of the prior of a parameter, about its start, where none is given:
# of a shear law that of published ones, else a decade
_WIDTH = 1.0
_WIDTHS = {"stress": 0.3, "velocity": 1.5, "width": 0.3, "energy": 0.15}
# of a parameter, in differences: under an indenter; on a surface across the ripples of
# few random lines, then within one
_STEPS_SMOOTH, _STEPS = (1e-3,), (0.05, 0.0125)
# change of parameters and of the sum of squares at which the search ends
_EXACTLY, _ROUGHLY = 1e-8, 1e-3
# uncertainty of a parameter over that of its prior, and correlation of two, doubted
_NOT_LEARNED, _CORRELATED = 0.7, 0.98
_ASSUMED = 0.05  # error of few points, over the largest of them
# error over the coefficient, no measurement being surer: the best class of machines by
# ISO 7500-1 has its force to 0.5 %, and specimens differ by more
_SUREST = 1e-3
_MISFIT = 1.5  # rms of the residuals over the error given, doubted
_HALF = 0.6745  # standard deviations within which half of all points lie
_LEAST_STEPS = 3  # between points of one temperature, by which chance is estimated
_LARGE = 0.1  # residuals over what was measured, both rms, that follow no chance
_FAR = 3.5  # standard deviations, of all points but those, off the curve
_NAMED = 3  # points far off that are named, the farthest
_DEGREES = 5.0  # of freedom of the distribution from which draws are proposed
_ROUNDS = 3  # of proposals, each of the size and place of the draws before
_POOR = 0.05  # part of the draws that count, below which their intervals are doubted
_LEAST_WAVES = 1.1  # q_high over q_low, below which there is no surface to speak of
_LEAST = 0.2  # part of a parameter in the least known direction from which it is named


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(AbstractWithTable):
    """A calibrated material, shape and shear law, the parameters that make them, and how
    well they are known.
    """

    material: Prony
    # the indenter or surface, with the parameters that act on it
    shape: Indenter | Surface
    adhesion: AdhesiveShear | None  # the shear law, where there is one
    parameters: dict[str, float]
    # standard deviation of each parameter, prior included; 1.96 times it holds 95 %, and
    # where the error of the data is estimated from few points, is as much wider as
    # Student's t
    std: dict[str, float]
    prior: dict[str, float]  # standard deviation of each parameter without the data
    covariance: Float[np.ndarray, "p p"]  # in the order of `parameters`
    # of the parameters, all equally likely, where they were asked for
    draws: Float[np.ndarray, "n p"] | None
    velocity: Float[np.ndarray, "..."]  # [m/s]
    temperature: Float[np.ndarray, "..."] | None  # [K]
    measured: Float[np.ndarray, "..."]
    # by the calibrated material; NaN where the contact did not converge
    computed: Float[np.ndarray, "..."]
    residuals: Float[np.ndarray, "..."]  # measured minus computed
    # False where the contact did not converge, or beside it: a point that counts for
    # nothing
    used: Bool[np.ndarray, "..."]
    error: float  # standard deviation of the measurement
    scatter: str  # where that comes from, and whether it follows the coefficient
    evaluations: int
    warnings: tuple[str, ...]
    converged: bool
    doubts: tuple[Doubt, ...]  # of the curve that was computed

    title: ClassVar[str] = "calibration"

    @property
    def weakest(self) -> tuple[dict[str, float], float]:
        """The direction that the data determine least, and its standard deviation with
        the data over that without.

        Parameters are in units of their priors; the direction has length 1. Along it
        the parameters may be exchanged for each other with the least effect on what is
        computed: only another kind of measurement can decide it.
        """
        width = np.array(list(self.prior.values()))
        spread, directions = np.linalg.eigh(self.covariance / np.outer(width, width))
        most = directions[:, -1]
        most = most * np.sign(most[np.abs(most).argmax()])
        return dict(zip(self.prior, most.tolist(), strict=True)), float(
            np.sqrt(spread[-1])
        )

    def interval(self, name: str, share: float = 0.95) -> tuple[float, float]:
        """What holds a parameter with a probability of `share`, as `parameters` has it
        (log10 of a factor to the start; `in_units` has units): quantiles of the draws,
        without them by its standard deviation. Raises `InputError`.
        """
        one_of("name", name, *self.parameters)
        tail = 0.5 * (1 - float(scalar("share", share)))
        if self.draws is None:
            half = float(ndtri(1 - tail)) * self.std[name]
            return self.parameters[name] - half, self.parameters[name] + half
        column = self.draws[:, list(self.parameters).index(name)]
        low, high = np.quantile(column, (tail, 1 - tail))
        return float(low), float(high)

    @property
    def undecided(self) -> list[str]:
        """The parameters that are as uncertain as they were without the data."""
        return [
            name
            for name, after in self.std.items()
            if after > _NOT_LEARNED * self.prior[name]
        ]

    @property
    def decided(self) -> list[str]:
        """The others."""
        return [name for name in self.parameters if name not in self.undecided]

    def _in_units(self, name: str) -> tuple[list[float], str]:
        """What a parameter changes, or the factor that it is, the ends of its 95 %
        interval, and the unit.
        """
        values = _parameters_of(self.adhesion)
        if isinstance(self.shape, AbstractSpectrum):
            values["q_high"] = float(self.shape.q_high)
        at = self.parameters[name]
        ends = np.array([at, *self.interval(name)])
        if name == "slope":
            return ends.tolist(), ""
        unit, times = _UNITS.get(name, ("", 1.0))
        # of others the factor itself
        there = times * (values[name] if name in values else 10.0**at)
        return (there * 10.0 ** (ends - at)).tolist(), unit

    def in_units(self, name: str) -> str:
        """A parameter in the unit of what it changes, with its 95 % interval; where the
        data do not decide it only within which it was assumed.
        """
        (value, low, high), unit = self._in_units(name)
        if name in self.undecided:
            return (
                f"not decided by the data, assumed within {low:.2g} to {high:.2g}{unit}"
            )
        return f"{value:.3g}{unit} ({low:.3g} to {high:.3g})"

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the calibration, as pairs of a name and a
        text.
        """
        for name, value in self.parameters.items():
            yield (
                name,
                (
                    f"{self.in_units(name)}   {value:.4g} +- "
                    f"{TWO_SIGMA * self.std[name]:.2g} {MEANINGS[name]}"
                ),
            )
        if len(self.parameters) > 1:
            direction, left = self.weakest
            named = [
                f"{slope:+.2f} {name}"
                for name, slope in direction.items()
                if abs(slope) > _LEAST
            ]
            yield (
                "weakest",
                (
                    f"{' '.join(named)} (in prior widths), to {left:.0%} of what was "
                    "assumed"
                ),
            )
        rms = float(np.sqrt(np.mean(self.residuals[self.used] ** 2)))
        yield (
            "residuals",
            (
                f"{rms:.3g} rms, error of a measurement {self.error:.3g} "
                f"({self.scatter}), {self.evaluations} evaluations"
            ),
        )
        for label, here in self._by_temperature():
            left = self.residuals[here & self.used]
            yield (
                f"at {label}",
                f"residuals {left.mean():+.2g} on average, "
                f"{float(np.sqrt(np.mean(left**2))):.2g} rms of {left.size} points",
            )
        if doubted := counted_kinds(self.doubts):
            yield "doubts", f"{doubted} of the computed; intervals hold no model_error"
        for warning in self.warnings:
            yield "warning", warning

    def _by_temperature(self) -> Iterator[tuple[str, np.ndarray]]:
        """Each temperature in words, where there are several, and its points."""
        from .drawing import celsius

        kelvin = np.zeros(0) if self.temperature is None else self.temperature.round(2)
        for level in np.unique(kelvin) if kelvin.size and np.ptp(kelvin) else ():
            here = kelvin == level
            if self.used[here].any():
                yield celsius(float(level)), here

    def columns(self) -> dict[str, np.ndarray]:
        """The points, measured and computed."""
        columns = {
            "velocity [m/s]": self.velocity,
            "temperature [K]": self.temperature,
            "measured [-]": self.measured,
            "computed [-]": self.computed,
            "residual [-]": self.residuals,
            "used": self.used,
        }
        return {name: x.ravel() for name, x in columns.items() if x is not None}

    def plot(self, ax: Axes | None = None, style: Style | None = None) -> Axes:
        """Draws what was measured over what is computed at the same points, in a style
        of `Result.plot`; returns matplotlib Axes.
        """
        from .drawing import draw_friction, sketch

        made = sketch(
            (Label("Velocity", "m/s"), Label("Coefficient", "-")),
            "Measured, and as calibrated",
            ", ".join(
                f"{name} {value:.3g}{unit}"
                for name in self.decided
                for (value, *_), unit in [self._in_units(name)]
            ),
            ax,
            style,
        )
        draw_friction(
            made,
            self.velocity.ravel(),
            None if self.temperature is None else self.temperature.ravel(),
            self.measured.ravel(),
            {"calibrated": self.computed.ravel()},
        )
        return made.finish()


@in_si
def calibrate(
    material: Prony,
    shape: Indenter | Surface,
    *,
    velocity: ArrayLike,
    measured: ArrayLike,
    parameters: Sequence[str] | Mapping[str, float],
    quantity: Motion = "friction",
    error: ArrayLike | None = None,
    widths: Mapping[str, float] | None = None,
    draws: int = 0,
    seed: int = 0,
    **scene: Any,  # of either verb
) -> Calibration:
    """The parameters with which computed friction, or rolling resistance, comes closest
    to measurements.

    Each parameter has a Gaussian prior about its start. One that ends as uncertain as
    it began is not determined by the data, and a warning says so; `weakest` names what
    the data determine least.

    Args:
        material: the material to begin with, a `Prony`.
        shape: the indenter or surface to begin with.
        velocity: sliding velocities [m/s].
        measured: measured coefficients, of the shape that the scene has.
        parameters: names from `elastomdr.fit.calibration.MEANINGS`, or a dict of names
            and starting values (0 where none is given). "shear" stands for stress,
            velocity, width and, with several temperatures, energy of `adhesion`, or of
            a law that is typical of dry treads.
        quantity: "friction", or "rolling" for the resistance.
        error: standard deviation of a measurement, one number or one per point, at
            least 0.1 % of it; by default estimated from the residuals, the same at all
            points or in proportion to what is computed, whichever they suit better, or
            where there are no more points than parameters 5 % of the largest.
        widths: standard deviations of the priors by parameter, where none is given
            those of published shear laws (stress and width .3, velocity 1.5, energy
            .15), and else 1.
        draws: number of draws of the parameters given the data, by importance sampling
            of whole calls, three for each; 0 for none.
        seed: of the draws.
        scene: other arguments of `em.friction`: load, pressure, temperature, adhesion,
            heat, model, rtol.

    Returns:
        A `Calibration` with the material, the shape, the shear law and the uncertainty
        of each parameter.

    Raises:
        InputError: for unknown names, measurements that do not match, and a start where
            the contact has no answer.

    Jacobians are central differences. The samples of `em.Line`, which must be the same
    for all cutoffs, are by default enough for a cutoff one standard deviation of the
    prior above its start.
    """
    one_of("quantity", quantity, "friction", "rolling")
    whole_number("draws", draws, least=0)
    whole_number("seed", seed, least=0)
    if not isinstance(parameters, str) and {SHEAR, *_OF_LAW} & set(parameters):
        scene |= _find_law(scene)
    start = _start(material, parameters, scene)
    check(start, material, shape, scene)
    names = list(start)
    widths = _WIDTHS | dict(widths or {})
    spread = np.array([float(widths.get(name, _WIDTH)) for name in names])
    positive("widths", spread)
    data, given = _checked_data(measured, error, len(names))
    scene = dict(scene, velocity=velocity)
    if isinstance(shape, AbstractSpectrum):
        width_of = dict(zip(names, spread, strict=True))
        scene["model"] = _road_model(shape, scene, width_of)
    verb = _quietly(quantity)
    task = _Task(
        _computer(material, shape, verb, names, scene, data.shape),
        np.array(list(start.values())),
        spread,
        data,
        given,
        *((_STEPS, _ROUGHLY) if is_rough(shape) else (_STEPS_SMOOTH, _EXACTLY)),
    )
    solution = _solve(task)
    values = dict(zip(names, solution.point.tolist(), strict=True))
    changed, shape, scene = applied(material, shape, scene, values)
    std = np.sqrt(np.diag(solution.covariance))
    drawn, counted = _draw(task, solution, draws, seed) if draws else (None, 1.0)
    places = {
        name: np.broadcast_to(as_float64(name, scene[name]), data.shape)
        for name in ("velocity", "temperature")
        if scene.get(name) is not None
    }
    residuals = data - solution.computed
    doubted = (
        *_judge(task, names, std, solution, counted),
        *_name_far(residuals, solution, places),
    )
    if given is None:
        doubted += tuple(_name_trend(residuals, data, solution.used, places))
    size = np.sqrt(np.mean(residuals[solution.used] ** 2)) if given is None else given
    if sure := int((size < _SUREST * np.abs(data)).sum()):
        doubted += (
            f"{sure} of {data.size} points are surer than {_SUREST:.1%} of the "
            "coefficient, as computed ones are and no measurement is: that is taken as "
            "their error.",
        )
    if error is None and given is not None:
        doubted = (
            f"Points are too few ({data.size}) to show their scatter beside "
            f"{len(names)} parameters: an error of {_ASSUMED:.0%} of the largest is "
            "assumed, and intervals rest on it and on the priors.",
            *doubted,
        )
    tell(doubted)
    return Calibration(
        material=changed,
        shape=shape,
        adhesion=scene.get("adhesion"),
        draws=drawn,
        velocity=places["velocity"],
        temperature=places.get("temperature"),
        parameters=values,
        std=dict(zip(names, std.tolist(), strict=True)),
        prior=dict(zip(names, spread.tolist(), strict=True)),
        covariance=solution.covariance,
        measured=data,
        computed=solution.computed,
        residuals=residuals,
        used=solution.used,
        error=float(np.sqrt(np.mean(solution.sigma**2))),
        scatter="given" if error is not None else solution.scatter,
        evaluations=solution.evaluations,
        warnings=doubted,
        converged=solution.converged,
        doubts=verb(changed, shape, **scene).doubts,
    )


def _judge(
    task: _Task,
    names: list[str],
    std: np.ndarray,
    solution: _Solution,
    counted: float,
) -> Iterator[str]:
    """What cannot be relied on; `counted` is the part of the draws that count."""
    if counted < _POOR:
        yield (
            f"Only {counted:.1%} of the draws count: the data leave the parameters a "
            "shape that these do not reach. Ask for more draws."
        )
    if not solution.converged:
        yield "The search did not converge."
    if missing := int((~solution.used).sum()):
        yield (
            f"{missing} of {solution.used.size} points have no computed answer, or none "
            "beside it, and count for nothing."
        )
    off = ((task.data - solution.computed) / solution.sigma)[solution.used]
    # far points are named one by one
    misfit = float(np.median(np.abs(off))) / _HALF
    if task.error is not None and misfit > _MISFIT:
        yield (
            f"Residuals are {misfit:.2g} times the error given: these parameters do not "
            "describe the data, and their intervals mean nothing."
        )
    prior, moves = task.spread, solution.point - task.begin
    for name, moved, before in zip(names, moves, prior, strict=True):
        if abs(moved) > _FAR * before:
            yield (
                f"{name} went {abs(moved) / before:.2g} times as far as was assumed of it "
                "beforehand: something else is missing."
            )
    for name, after, before in zip(names, std, prior, strict=True):
        if after > _NOT_LEARNED * before:
            yield (
                f"{name} is hardly determined by the data: its uncertainty, "
                f"{after:.2g}, is that of the prior, {before:.2g}."
            )
    correlation = solution.covariance / np.outer(std, std)
    for i, j in zip(*np.tril_indices(len(names), -1), strict=True):
        if abs(correlation[i, j]) > _CORRELATED:
            yield (
                f"{names[j]} and {names[i]} cannot be separated (correlation "
                f"{correlation[i, j]:.3f})."
            )


def _name_trend(
    residuals: np.ndarray,
    data: np.ndarray,
    used: np.ndarray,
    places: Mapping[str, np.ndarray],
) -> Iterator[str]:
    """Residuals that are large and change slowly with velocity: successive differences
    of chance have twice the mean square of its values (von Neumann 1941).
    """
    warmth = places.get("temperature", np.zeros(data.shape))[used]
    order = np.lexsort((places["velocity"][used], warmth))
    left, size = residuals[used][order], np.mean(data[used] ** 2)
    steps = np.diff(left)[np.diff(warmth[order]) == 0]
    square = np.mean(left**2)
    if steps.size < _LEAST_STEPS or square < _LARGE**2 * size:
        return
    if np.mean(steps**2) < square:
        yield (
            f"Residuals are {np.sqrt(square / size):.0%} of what was measured and follow "
            "the velocity: these parameters do not describe the data, and their "
            "intervals mean nothing."
        )


def _name_far(
    residuals: np.ndarray, solution: _Solution, places: Mapping[str, np.ndarray]
) -> Iterator[str]:
    """Points that lie off the curve as no scatter of the others would have it."""
    off = np.where(solution.used, residuals / solution.sigma, 0.0)
    size = max(float(np.median(np.abs(off[solution.used]))) / _HALF, 1e-12)
    far = np.argsort(-np.abs(off), axis=None)
    far = far[: int((np.abs(off) > _FAR * size).sum())]
    if not far.size:
        return
    named = []
    for i in far[:_NAMED]:
        at = f"{places['velocity'].flat[i]:.3g} m/s"
        if "temperature" in places:
            at += f", {places['temperature'].flat[i] - 273.15:.4g} degC"
        named.append(f"{at} ({residuals.flat[i]:+.2g})")
    yield (
        f"Far off the curve, more than {_FAR:g} times the scatter of the others: "
        f"{far.size} of {off.size} points, at {'; '.join(named)}"
        f"{' ...' if far.size > _NAMED else '.'}"
    )


def _draw(
    task: _Task, solution: _Solution, count: int, seed: int
) -> tuple[np.ndarray, float]:
    """Draws of the parameters given the data, and the part of them that count.

    Importance sampling: proposed from Student's distribution about the solution, then
    twice about the mean and with the covariance of what has been drawn, wider tails
    than the posterior's each time. Whole calls need no derivatives, so that no sampler
    that asks for them would do with fewer.
    """
    random, size = np.random.default_rng(seed), solution.point.size
    mean, covariance = solution.point, solution.covariance
    points, weight = mean[None], np.ones(1)
    for _ in range(_ROUNDS):
        root = np.linalg.cholesky(covariance)
        chi = random.chisquare(_DEGREES, (count, 1)) / _DEGREES
        steps = random.standard_normal((count, size)) / np.sqrt(chi)
        points = mean + steps @ root.T
        proposed = -0.5 * (_DEGREES + size) * np.log1p((steps**2).sum(1) / _DEGREES)
        log = np.array([task.likelihood(p, solution) for p in points]) - proposed
        weight = np.exp(log - log.max())
        weight /= weight.sum()
        mean = weight @ points
        left = points - mean
        # what few draws have left out is not lost
        covariance = (left.T * weight) @ left + 0.05 * solution.covariance
    chosen = random.choice(count, count, p=weight)
    return points[chosen], float(1 / (weight**2).sum() / count)


def _checked_data(
    measured: ArrayLike, error: ArrayLike | None, parameters: int
) -> tuple[np.ndarray, np.ndarray | None]:
    """The measurements and their errors, where these are given, or the points too few
    for an estimate. Raises `InputError`.
    """
    data = np.asarray(as_float64("measured", measured))
    require("measured", data, "finite", np.isfinite)
    if not data.size:
        raise InputError(argument="measured", accepted="one point or more")
    if error is None:
        if data.size > parameters:
            return data, None
        error = _ASSUMED * np.abs(data).max()
    given = np.broadcast_to(as_float64("error", error), data.shape)
    positive("error", given)
    return data, given


def _road_model(
    shape: AbstractSpectrum, scene: Mapping[str, Any], spread: dict[str, float]
) -> Any:
    """The model of a surface, fine enough for every cutoff that the search may reach."""
    finer = 10.0 ** min(spread["q_high"], 1.0) if "q_high" in spread else 1.0
    load, depth, pressure = (scene.get(name) for name in ("load", "depth", "pressure"))
    velocity: Any = scene.get("velocity")
    asked = Asked(velocity, load, depth, pressure)
    model = of_rough(scene.get("model"), shape, scene.get("pressure"))
    model = for_changes(model, shape, finer)
    hint_at_line(scene.get("model"), shape, asked)
    doubt = None if scene.get("pressure") is None else doubt_of(model, shape)
    if doubt is not None:
        warn(doubt, ModelWarning)
    return model


class _Task(NamedTuple):
    """What is computed from parameters, and what it is to meet."""

    compute: Callable[[np.ndarray], np.ndarray]
    begin: np.ndarray
    spread: np.ndarray  # standard deviations of the priors about `begin`
    data: np.ndarray
    error: np.ndarray | None  # standard deviation of the data; None: to be estimated
    steps: tuple[float, ...]  # of parameters in differences, the later ones closer
    close: float  # change at which the search ends

    def jacobian(self, p: np.ndarray, step: float) -> np.ndarray:
        """By central differences; NaN where the contact did not converge."""

        columns = [
            (self.compute(p + h) - self.compute(p - h)) / (2 * step)
            for h in step * np.eye(p.size)
        ]
        return np.stack(columns, axis=-1)

    def first(self) -> np.ndarray:
        """What is computed at the start. Raises `InputError` where that does not fit."""
        first = self.compute(self.begin)
        if first.shape != self.data.shape:
            raise InputError(
                argument="measured",
                got=self.data.shape,
                accepted=f"of the shape of what is computed, {first.shape}",
            )
        self.answered(np.isfinite(first))
        return first

    def answered(self, used: np.ndarray) -> None:
        """Raises `InputError` where there is no answer at any point."""
        if not used.any():
            raise InputError(
                argument="measured",
                accepted="where the contact has an answer, at one point or more",
                hint=f"what is computed is NaN at all {used.size} points",
            )

    def likelihood(self, p: np.ndarray, solution: _Solution) -> float:
        """Logarithm of the probability of parameters given the data, up to a constant;
        an error that was estimated is integrated over.
        """
        used, computed = solution.used, self.compute(p)[solution.used]
        if not np.isfinite(computed).all():
            return -np.inf
        square = (((self.data[used] - computed) / solution.sigma[used]) ** 2).sum()
        fit = -0.5 * square
        if solution.estimated:
            fit = -0.5 * computed.size * np.log(square)
        return float(fit - 0.5 * (((p - self.begin) / self.spread) ** 2).sum())

    def scatter(
        self, computed: np.ndarray, used: np.ndarray, follows: bool
    ) -> np.ndarray:
        """The error of the data, from what is left of them: the same at all points, or
        one that follows what is computed.
        """
        shape = np.ones(self.data.shape)
        if follows:
            size = np.where(used, np.abs(computed), 0.0)
            shape = np.maximum(size, 1e-3 * size.max())
        left = ((self.data - computed) / shape)[used]
        freedom = max(left.size - self.begin.size, 1)
        return shape * max(np.sqrt((left**2).sum() / freedom), 1e-12)


class _Solution(NamedTuple):
    point: np.ndarray
    computed: np.ndarray
    covariance: np.ndarray
    used: np.ndarray
    sigma: np.ndarray  # standard deviation of the data
    estimated: bool  # whether that is what the residuals say
    scatter: str  # which, in words
    evaluations: int
    converged: bool


def _solve(task: _Task) -> _Solution:
    """Least squares; where no error is given with the same at all points, with one that
    follows the coefficient, and with the likelier of the two. Raises `InputError`.
    """
    computed = task.first()
    used = np.isfinite(computed)
    surest = np.maximum(_SUREST * np.abs(task.data), 1e-9)
    guess = np.full(task.data.shape, _ASSUMED * np.abs(task.data).max())
    raw = guess if task.error is None else task.error
    point, evaluations, converged = task.begin, 0, False
    found: list[np.ndarray] = []
    for follows in (False, True, None) if task.error is None else (None,):
        if follows:
            raw = task.scatter(computed, used, follows)
        elif found:
            raw = min(found, key=lambda sigma: np.log(sigma[used]).mean())
        for step in task.steps:
            sigma = np.maximum(raw, surest)
            answer = _search(task, step, point, used, sigma)
            point, evaluations = answer.x, evaluations + int(answer.nfev)
            converged = bool(answer.success)
        computed = task.compute(point)
        used &= np.isfinite(computed)
        if follows is not None:
            found.append(task.scatter(computed, used, follows))
    scatter = "assumed"
    if task.error is None:
        follows = raw is found[1]
        raw = task.scatter(computed, used, follows)
        share = "a share of the coefficient" if follows else "the same everywhere"
        scatter = f"from the residuals, {share}"
    sigma = np.maximum(raw, surest)
    estimated = task.error is None and bool((raw > surest).any())
    # An error that is estimated from few points is itself uncertain: Student's t in
    # place of 1.96.
    freedom = max(int(used.sum()) - point.size, 1)
    wider = float(stdtrit(freedom, 0.975)) / TWO_SIGMA if estimated else 1.0
    matrix = task.jacobian(point, task.steps[0])
    # one with an answer here and none beside it says nothing of the parameters
    used = used & np.isfinite(matrix).all(axis=-1)
    task.answered(used)
    matrix = matrix[used] / (wider * sigma[used][:, None])
    covariance = np.linalg.inv(matrix.T @ matrix + np.diag(task.spread**-2.0))
    return _Solution(
        point,
        computed,
        covariance,
        used,
        sigma,
        estimated,
        scatter,
        evaluations,
        converged,
    )


def _start(
    material: Prony,
    parameters: Sequence[str] | Mapping[str, float],
    scene: Mapping[str, Any],
) -> dict[str, float]:
    """The parameters and where they start. Raises `InputError`."""
    needs_series("material", material, "a calibration")
    if not isinstance(material, Prony):
        raise InputError(argument="material", got=material, accepted="a Prony")
    if (
        isinstance(parameters, str)
        or not isinstance(parameters, (Sequence, Mapping))
        or not parameters
    ):
        raise InputError(
            argument="parameters",
            got=parameters,
            accepted="names, or a dict of names and starts",
        )
    start: dict[str, float] = {}
    for name in parameters:
        if name == SHEAR:
            kelvin = scene.get("temperature")
            several = kelvin is not None and np.ptp(kelvin) > _SAME
            law = _parameters_of(scene["adhesion"])
            start |= {key: 0.0 for key in law if key != "energy" or several}
            continue
        if name not in MEANINGS:
            hint = closest(str(name), (SHEAR, *MEANINGS))
            raise InputError(
                argument="parameters",
                got=name,
                accepted=f"among {', '.join((SHEAR, *MEANINGS))}",
                hint=hint,
            )
        value = 0.0
        if isinstance(parameters, Mapping):
            value = parameters[name]
        start[name] = float(as_float64(f"parameters[{name!r}]", value))
    return start


def _quietly(quantity: Motion) -> Callable[..., FrictionCurve | RollingCurve]:
    """The verb, without its warnings."""
    from ..verbs.friction import friction
    from ..verbs.rolling import rolling

    verb = friction if quantity == "friction" else rolling
    return quiet(ConvergenceWarning, ExtrapolationWarning, ModelWarning)(verb)


def _computer(
    material: Prony,
    shape: Indenter | Surface,
    verb: Callable[..., FrictionCurve | RollingCurve],
    names: list[str],
    scene: Mapping[str, Any],
    size: tuple[int, ...],
) -> Callable[[np.ndarray], np.ndarray]:
    """What is computed from parameters, of the shape `size`, NaN where a surface has no
    waves left; what was computed last is kept.
    """
    last: dict[bytes, np.ndarray] = {}
    lowest = -np.inf
    if "q_high" in names and isinstance(shape, AbstractSpectrum):
        lowest = np.log10(_LEAST_WAVES * float(shape.q_low / shape.q_high))

    def compute(p: np.ndarray) -> np.ndarray:
        values: dict[str, float] = dict(zip(names, p.tolist(), strict=True))
        if values.get("q_high", 0.0) < lowest:
            return np.full(size, np.nan)
        body, form, rest = applied(material, shape, scene, values)
        curve = verb(body, form, **rest)
        result = getattr(curve, curve.shows)
        return np.asarray(result) * 10.0 ** values.get("gain", 0.0)

    def kept(p: np.ndarray) -> np.ndarray:
        key = p.tobytes()
        if key not in last:
            if len(last) > 4 * p.size:
                last.clear()
            last[key] = compute(p)
        return last[key]

    return kept


def _search(
    task: _Task, step: float, point: np.ndarray, used: np.ndarray, sigma: np.ndarray
) -> OptimizeResult:
    """Least squares from `point`, with the prior as further residuals; a point that
    fails repels the search.
    """

    def residuals(p: np.ndarray) -> np.ndarray:
        left = (task.data - task.compute(p))[used] / sigma[used]
        left = np.where(np.isfinite(left), left, 1e3)
        return np.concatenate([left, (task.begin - p) / task.spread])

    def derivative(p: np.ndarray) -> np.ndarray:
        matrix = -task.jacobian(p, step)[used] / sigma[used][:, None]
        matrix = np.where(np.isfinite(matrix), matrix, 0.0)
        return np.concatenate([matrix, -np.diag(1 / task.spread)])

    slope: Any = derivative  # scipy's types know no function here
    return least_squares(
        residuals, point, jac=slope, xtol=task.close, ftol=task.close, max_nfev=60
    )
