"""Chosen parameters of a material, or of a rough surface, adjusted to measured friction
or rolling resistance: `em.fit.calibrate`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.special import stdtrit

from ..call.model_choice import is_rough
from ..call.problem import Asked
from ..checks import as_float64, in_si, one_of, positive, require
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
from ..material.shift import WLF
from ..material.tabulated import needs_series
from ..models import as_model
from ..surface.spectrum import AbstractSpectrum
from ..trees import replaced
from ..verbs.roads import KINDS, doubt_of, for_changes, hint_at_line, of_rough
from .report import TWO_SIGMA, AbstractFindings, tell

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike, Motion
    from ..call.types import Indenter, Surface

# --------------------------------------------------------------------------------------
# What a calibration may adjust: parameters of a material, of a surface, and of what
# turns one into a coefficient.
#
# All but `slope`, `cutoff` and `offset` are log10 of a factor, so that 0 leaves
# everything as it is. The parameters of a surface act on its spectrum C(q): `q_high`
# moves where it ends, C below stays as it was (beyond a table it goes on as its last
# power law), `heights` scales all heights, `length` scales the length that turns a
# pressure into a line load.
# --------------------------------------------------------------------------------------

MEANINGS = {
    "modulus": "log10 of a factor on all moduli",
    "equilibrium": "log10 of a factor on the equilibrium modulus",
    "slope": "exponent s of a factor (tau/tau_middle)^s on the moduli of the spectrum",
    "cutoff": (
        "log10 of a time tau_c [s]; moduli of branches are divided by 1 + (tau_c/tau)^2"
    ),
    "time": "log10 of a factor on all relaxation times",
    "c1": "log10 of a factor on the WLF constant c1",
    "c2": "log10 of a factor on the WLF constant c2",
    "q_high": "log10 of a factor on the upper cutoff of the surface's spectrum",
    "heights": "log10 of a factor on the heights of the surface",
    "length": (
        "log10 of a factor on equivalent_length of em.Line, the length that turns a "
        "pressure into a line load"
    ),
    "offset": "a constant added to the computed coefficient, such as adhesion",
    "gain": "log10 of a factor on the computed coefficient",
}

Change = Callable[[Prony, Any, dict[str, Any]], tuple[Prony, Any]]


def check(
    names: Mapping[str, float], material: Prony, shape: object, scene: Mapping[str, Any]
) -> None:
    """Raises `InputError` for parameters that material, shape or scene do not have."""
    if {"c1", "c2"} & names.keys() and not isinstance(material.shift, WLF):
        raise InputError(
            "parameters c1 and c2 need a material with a WLF law, got "
            f"{material.shift!r}."
        )
    if {"q_high", "heights"} & names.keys() and not isinstance(shape, AbstractSpectrum):
        raise InputError(
            "parameters q_high and heights need a surface with a spectrum, got "
            f"{shape!r}."
        )
    if "length" in names:
        model = as_model(scene.get("model"), KINDS)
        length = getattr(model, "equivalent_length", None)
        if not isinstance(length, (int, float)):
            raise InputError(
                "parameter length needs a number [m] to start from, in "
                "model=em.Line(equivalent_length=...), got "
                f"model={model!r}."
            )


def applied(
    material: Prony,
    shape: Any,
    scene: Mapping[str, Any],
    values: dict[str, Any],
    change: Change | None,
) -> tuple[Prony, Any, dict[str, Any]]:
    """Material, shape and scene with the parameters in them."""
    if change is not None:
        material, shape = change(material, shape, values)
    scene = dict(scene)
    if "q_high" in values:
        shape = shape.ended(shape.q_high * 10.0 ** values["q_high"])
    if "heights" in values:
        shape = shape.raised(10.0 ** values["heights"])
    if "length" in values:
        model: Any = as_model(scene["model"], KINDS)
        length = model.equivalent_length * 10.0 ** values["length"]
        scene["model"] = dataclasses.replace(model, equivalent_length=length)
    return _of_material(material, values), shape, scene


def _of_material(material: Prony, values: Mapping[str, float]) -> Prony:
    times, moduli = np.asarray(material.times), np.asarray(material.moduli)
    factor = {name: 10.0 ** values.get(name, 0.0) for name in MEANINGS}
    if "slope" in values and times.size:
        middle = np.exp(np.mean(np.log(times)))
        moduli = moduli * (times / middle) ** values["slope"]
    if "cutoff" in values:
        moduli = moduli / (1 + (factor["cutoff"] / times) ** 2)
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

# standard deviation of the prior of a parameter, about its start, where none is given
_WIDTH = 1.0
# of a parameter, in differences: under an indenter; on a surface across the ripples of
# few random lines, then within one
_STEPS_SMOOTH, _STEPS = (1e-3,), (0.05, 0.0125)
# change of parameters and of the sum of squares at which the search ends
_EXACTLY, _ROUGHLY = 1e-8, 1e-3
# uncertainty of a parameter over that of its prior, and correlation of two, doubted
_NOT_LEARNED, _CORRELATED = 0.7, 0.98
_LEAST = 0.2  # part of a parameter in the least known direction from which it is named


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(AbstractFindings):
    """A calibrated material and shape, the parameters that make them, and how well they
    are known.
    """

    material: Prony
    # the indenter or surface, with the parameters that act on it
    shape: Indenter | Surface
    parameters: dict[str, float]
    # standard deviation of each parameter, prior included; 1.96 times it holds 95 %, and
    # where the error of the data is estimated from few points, is as much wider as
    # Student's t
    std: dict[str, float]
    prior: dict[str, float]  # standard deviation of each parameter without the data
    covariance: Float[np.ndarray, "p p"]  # in the order of `parameters`
    measured: Float[np.ndarray, "..."]
    # by the calibrated material; NaN where the contact did not converge
    computed: Float[np.ndarray, "..."]
    residuals: Float[np.ndarray, "..."]  # measured minus computed
    # False where the contact did not converge: such a point counts for nothing
    used: Bool[np.ndarray, "..."]
    error: float  # standard deviation of the measurement, given or estimated
    evaluations: int
    warnings: tuple[str, ...]
    converged: bool

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
        most = directions[:, -1] * np.sign(
            directions[np.abs(directions[:, -1]).argmax(), -1]
        )
        return dict(zip(self.prior, most.tolist(), strict=True)), float(
            np.sqrt(spread[-1])
        )

    def findings(self) -> Iterator[tuple[str, str]]:
        """What a person needs to judge the calibration, as pairs of a name and a
        text.
        """
        for name, value in self.parameters.items():
            yield (
                name,
                (
                    f"{value:.4g} +- {TWO_SIGMA * self.std[name]:.2g}   "
                    f"{MEANINGS.get(name, 'your own')}"
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
                "least known",
                (
                    f"{' '.join(named)} (in prior widths), to {left:.0%} of what was "
                    "assumed"
                ),
            )
        rms = float(np.sqrt(np.mean(self.residuals[self.used] ** 2)))
        yield (
            "residuals",
            (
                f"{rms:.3g} rms, error of a measurement {self.error:.3g}, "
                f"{self.evaluations} evaluations"
            ),
        )
        for warning in self.warnings:
            yield "warning", warning


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
    change: Change | None = None,
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
            and starting values (0 where none is given; the cutoff starts at the
            shortest relaxation time).
        quantity: "friction", or "rolling" for the resistance.
        error: standard deviation of a measurement, one number or one per point; by
            default estimated from the residuals.
        widths: standard deviations of the priors by parameter, 1 where none is given.
        change: `change(material, shape, values)` returns the material and the shape
            that parameters of your own make.
        scene: other arguments of `em.friction`: load, pressure, temperature, model,
            rtol.

    Returns:
        A `Calibration` with the material, the shape and the uncertainty of each
        parameter.

    Raises:
        InputError: for unknown names, measurements that do not match, and a start where
            the contact has no answer.

    Jacobians are central differences. The samples of `em.Line`, which must be the same
    for all cutoffs, are by default enough for a cutoff one standard deviation of the
    prior above its start.
    """
    one_of("quantity", quantity, "friction", "rolling")
    start = _start(material, parameters, change is not None)
    check(start, material, shape, scene)
    names = list(start)
    spread = np.array([float((widths or {}).get(name, _WIDTH)) for name in names])
    positive("widths", spread)
    data, given = _checked_data(measured, error, len(names))
    scene = dict(scene, velocity=velocity)
    if isinstance(shape, AbstractSpectrum):
        width_of = dict(zip(names, spread, strict=True))
        scene["model"] = _road_model(shape, scene, width_of)
    task = _Task(
        _computer(material, shape, quantity, names, change, scene),
        np.array(list(start.values())),
        spread,
        data,
        given,
        *((_STEPS, _ROUGHLY) if is_rough(shape) else (_STEPS_SMOOTH, _EXACTLY)),
    )
    solution = _solve(task)
    values = dict(zip(names, solution.point.tolist(), strict=True))
    changed, shape, _ = applied(material, shape, scene, values, change)
    std = np.sqrt(np.diag(solution.covariance))
    doubted = tuple(_judge(names, std, spread, solution))
    tell(doubted)
    return Calibration(
        material=changed,
        shape=shape,
        parameters=values,
        std=dict(zip(names, std.tolist(), strict=True)),
        prior=dict(zip(names, spread.tolist(), strict=True)),
        covariance=solution.covariance,
        measured=data,
        computed=solution.computed,
        residuals=data - solution.computed,
        used=solution.used,
        error=float(np.sqrt(np.mean(solution.sigma**2))),
        evaluations=solution.evaluations,
        warnings=doubted,
        converged=solution.converged,
    )


def _judge(
    names: list[str], std: np.ndarray, prior: np.ndarray, solution: _Solution
) -> Iterator[str]:
    """What cannot be relied on; `prior` are standard deviations without the data."""
    if not solution.converged:
        yield "The search did not converge."
    if missing := int((~solution.used).sum()):
        yield (
            f"{missing} of {solution.used.size} points have no computed answer and count "
            "for nothing."
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


def _checked_data(
    measured: ArrayLike, error: ArrayLike | None, parameters: int
) -> tuple[np.ndarray, np.ndarray | None]:
    """The measurements and their errors, where these are given. Raises `InputError`."""
    data = np.asarray(as_float64("measured", measured))
    require("measured", data, "finite", np.isfinite)
    if data.size < parameters:
        raise InputError(
            "measured must have as many points as there are parameters, "
            f"{parameters}, got {data.size}."
        )
    if error is None:
        return data, None
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
                f"measured must have the shape of what is computed, {first.shape}, "
                f"got {self.data.shape}."
            )
        missing = int((~np.isfinite(first)).sum())
        if first.size - missing < self.begin.size:
            raise InputError(
                "parameters must start where the contact has an answer, got NaN "
                f"at {missing} points."
            )
        return first

    def guessed_error(self) -> np.ndarray:
        size = 0.05 * max(float(np.abs(self.data).max()), 1e-12)
        return np.full(self.data.shape, size)

    def scatter(self, computed: np.ndarray, used: np.ndarray) -> np.ndarray:
        """The error of the data, from what is left of them."""
        left = (self.data - computed)[used]
        freedom = max(left.size - self.begin.size, 1)
        size = max(np.sqrt((left**2).sum() / freedom), 1e-9)
        return np.full(self.data.shape, size)


class _Solution(NamedTuple):
    point: np.ndarray
    computed: np.ndarray
    covariance: np.ndarray
    used: np.ndarray
    sigma: np.ndarray  # standard deviation of the data
    evaluations: int
    converged: bool


def _solve(task: _Task) -> _Solution:
    """Least squares, repeated with the error that is left where none is given. Raises
    `InputError`.
    """
    used = np.isfinite(task.first())
    sigma = task.guessed_error() if task.error is None else task.error
    point, evaluations, converged = task.begin, 0, False
    for _ in range(3 if task.error is None else 1):
        for step in task.steps:
            answer = _search(task, step, point, used, sigma)
            point, evaluations = answer.x, evaluations + int(answer.nfev)
            converged = bool(answer.success)
        computed = task.compute(point)
        used = used & np.isfinite(computed)
        if task.error is None:
            sigma = task.scatter(computed, used)
    # An error that is estimated from few points is itself uncertain: Student's t in
    # place of 1.96.
    freedom = max(int(used.sum()) - point.size, 1)
    wider = float(stdtrit(freedom, 0.975)) / TWO_SIGMA if task.error is None else 1.0
    matrix = task.jacobian(point, task.steps[0])[used]
    matrix = matrix / (wider * sigma[used][:, None])
    covariance = np.linalg.inv(matrix.T @ matrix + np.diag(task.spread**-2.0))
    computed = task.compute(point)
    return _Solution(point, computed, covariance, used, sigma, evaluations, converged)


def _start(
    material: Prony, parameters: Sequence[str] | Mapping[str, float], own_model: bool
) -> dict[str, float]:
    """The parameters and where they start. Raises `InputError`."""
    needs_series("material", material, "a calibration")
    if not isinstance(material, Prony):
        raise InputError(f"material must be a Prony, got {type(material).__name__}.")
    if (
        isinstance(parameters, str)
        or not isinstance(parameters, (Sequence, Mapping))
        or not parameters
    ):
        raise InputError(
            "parameters must be names, or a dict of names and starts, got "
            f"{parameters!r}."
        )
    start: dict[str, float] = {}
    for name in parameters:
        if name not in MEANINGS and not own_model:
            hint = closest(str(name), MEANINGS)
            raise InputError(
                f"parameters must be among {', '.join(MEANINGS)}, got {name!r}.{hint}"
            )
        value = 0.0
        if isinstance(parameters, Mapping):
            value = parameters[name]
        elif name == "cutoff":
            value = float(np.log10(material.times[0])) if material.times.size else 0.0
        start[name] = float(as_float64(f"parameters[{name!r}]", value))
    return start


def _computer(
    material: Prony,
    shape: Indenter | Surface,
    quantity: Motion,
    names: list[str],
    change: Change | None,
    scene: Mapping[str, Any],
) -> Callable[[np.ndarray], np.ndarray]:
    """What is computed from parameters; what was computed last is kept."""
    from ..verbs.friction import friction
    from ..verbs.rolling import rolling

    last: dict[bytes, np.ndarray] = {}

    def compute(p: np.ndarray) -> np.ndarray:
        values: dict[str, float] = dict(zip(names, p.tolist(), strict=True))
        body, form, rest = applied(material, shape, scene, values, change)
        with quiet(ConvergenceWarning, ExtrapolationWarning, ModelWarning):
            if quantity == "friction":
                result = friction(body, form, **rest).mu
            else:
                result = rolling(body, form, **rest).coefficient
        gain, offset = 10.0 ** values.get("gain", 0.0), values.get("offset", 0.0)
        return np.asarray(result) * gain + offset

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
