"""Traction against creepage or slip, what `em.traction` returns; and the Magic Formula
fitted to it, written as a property file for tyre models.

F_x = D sin(C atan(B k - E (B k - atan(B k)))) with the longitudinal slip k, positive
where the tyre drives, and

    D = (PDX1 + PDX2 f) F_z,
    E = PEX1 + PEX2 f,
    B C D = (PKX1 + PKX2 f) F_z,
    C = PCX1,
    f = F_z/F_0 - 1.

Source: H. B. Pacejka 2012, Tire and Vehicle Dynamics, ch. 4 (the longitudinal part of
MF-Tyre 5.2, without shifts).
"""

import os
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, ClassVar, NamedTuple

import numpy as np

from .. import __version__
from ..checks import in_si, positive, significant
from ..errors import InputError
from ..files import as_path, write_files
from ..results.axes import Quantity
from ..results.base import Array, Result, quantity, record
from ..results.curve import Contact
from ..results.doubts import in_words
from ..results.words import span

COEFFICIENTS = ("PCX1", "PDX1", "PEX1", "PKX1", "PDX2", "PEX2", "PKX2")
_START = (1.6, 1.0, 0.0, 20.0, 0.0, 0.0, 0.0)
_LOWEST = (1.0, 0.01, -20.0, 0.5, -1.0, -20.0, -200.0)
_HIGHEST = (1.99, 5.0, 1.0, 500.0, 1.0, 20.0, 200.0)


class MagicFormula(NamedTuple):
    """Coefficients of the Magic Formula of one speed and temperature, and how far it is
    from the slip curve.
    """

    coefficients: dict[str, float]  # by their names in a property file
    nominal: float  # F_0 [N]
    residual: float  # root mean square of F_x/F_N
    worst: float  # largest deviation of F_x/F_N
    load: tuple[float, float]  # lowest and highest [N]
    slip: float  # largest
    velocity: float  # of the road [m/s]

    def force(self, slip: Array, load: Array) -> np.ndarray:
        """F_x [N] at braking slips s = (V - v)/V, a force against the motion counted
        positive, and loads [N].
        """
        slip, load = np.asarray(slip, dtype=float), np.asarray(load, dtype=float)
        return load * _coefficient(
            [self.coefficients[n] for n in COEFFICIENTS], slip, load / self.nominal - 1
        )


def _coefficient(p: Sequence[float], slip: np.ndarray, f: np.ndarray) -> np.ndarray:
    shape, grip, bend = p[0], p[1] + p[4] * f, p[2] + p[5] * f
    x = (p[3] + p[6] * f) / (shape * grip) * slip
    return grip * np.sin(shape * np.arctan(x - bend * (x - np.arctan(x))))


class TractionPeak(NamedTuple):
    """The largest traction of each curve, over the last axis; NaN where no point of it
    is known.
    """

    creepage: np.ndarray  # xi at which it was computed, no interpolation
    coefficient: np.ndarray  # F_x/F_N
    inside: np.ndarray  # False at an end of the curve, beyond which it may grow
    place: tuple[np.ndarray, ...]  # of the point, an index into the fields

    @property
    def slip(self) -> np.ndarray:
        """The same as a slip, s = xi/(1 + xi): the velocity of slip over that of the
        road.
        """
        return self.creepage / (1 + self.creepage)


@record
class Traction(Result):
    """Steady rolling with creepage; a point that did not converge is NaN with
    `converged=False`.

    `plot` draws the traction coefficient against creepage, or the slip where that was
    given; dashed is the friction coefficient, what a contact has that slips all over.
    """

    road: Array | None = quantity(
        "velocity of the road", "m/s", "V, where a slip was given", default=None
    )
    velocity: Array = quantity("velocity", "m/s", "rolling velocity v")
    creepage: Array = quantity("creepage", "-", "xi", shown="%")
    slip: Array | None = quantity(
        "slip", "-", "s = (V - v)/V, where it was given", default=None, shown="%"
    )
    friction: Array = quantity("Coulomb's friction coefficient", "-", "mu")
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    coefficient: Array = quantity(
        "traction coefficient", "-", "F_x/F_N", axis="traction coefficient $F_x/F_N$"
    )
    force: Array = quantity("tractive force", "N", "F_x")
    stick: Array = quantity("part of the contact that sticks", "-", "of its length")
    slip_power: Array = quantity(
        "power of creepage", "W", "of the tractive force on the creepage, F_x xi v"
    )
    rolling: Array = quantity(
        "rolling resistance coefficient", "-", "of the normal contact"
    )
    normal_force: Array = quantity("normal force", "N", "F_N")
    depth: Array = quantity("depth", "m", shown="mm")
    contact: Contact
    error: Array = quantity(
        "estimated error of the traction coefficient", "-", "at its contact size"
    )
    model_error: Array = quantity(
        "bound on the error of the model",
        "-",
        "of the traction coefficient; NaN: not known",
    )

    title: ClassVar[str] = "Traction"
    figure: ClassVar[str] = "plot_curves.draw_traction"
    across: ClassVar[str] = "creepage"
    shows: ClassVar[str] = "coefficient"
    scale: ClassVar[str] = "auto"
    from_zero: ClassVar[bool] = False
    error_of: ClassVar[str] = "the coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "slip",
        "creepage",
        "road",
        "velocity",
        "temperature",
        "normal_force",
        "depth",
        "friction",
    )

    def describe(self, q: Quantity) -> Quantity:
        """Beside the velocity of the road the other one is that of rolling."""
        return (
            q._replace(label="rolling velocity")
            if q.path == "velocity" and self.road is not None
            else q
        )

    def peak(self) -> TractionPeak:
        """The point of largest absolute traction on each curve, whose points lie along
        the last axis.

        With a friction coefficient that falls with the sliding velocity it lies inside;
        with one that rises, or a constant one, at the end, where all of the contact
        slips.
        """
        coefficient = np.atleast_1d(np.asarray(self.coefficient))
        creepage = np.atleast_1d(np.asarray(self.creepage))
        known = np.isfinite(coefficient)
        place = np.where(known, np.abs(coefficient), -1.0).argmax(axis=-1)
        index = (*np.indices(place.shape), place)
        top = creepage[index][..., None]
        inside = np.asarray(
            (known & (creepage < top)).any(axis=-1)
            & (known & (creepage > top)).any(axis=-1)
        )
        return TractionPeak(creepage[index], coefficient[index], inside, index)

    @in_si
    def magic_formula(self, *, temperature: float | None = None) -> MagicFormula:
        """The Magic Formula fitted to this slip curve, of one speed and temperature,
        over its loads.

        `temperature` [K] says which, where there are several. Raises `InputError` for
        several speeds or temperatures, and fewer than eight points that brake.
        """
        return _fitted(self, temperature)

    @in_si
    def to_tir(
        self,
        path: str | os.PathLike[str],
        *,
        radius: float,
        width: float,
        temperature: float | None = None,
    ) -> None:
        """Writes the Magic Formula as a property file (.tir, PAC2002) in SI units: the
        longitudinal part only.

        `radius` and `width` of the tyre [m] go into the file; how far the fit is from
        the curve stands at its top. `temperature` [K] says which, where there are
        several. Raises `InputError` as `magic_formula` does, and where the file cannot
        be written.
        """
        positive("radius", radius)
        positive("width", width)
        formula = _fitted(self, temperature)
        content = _property_file(formula, radius, width, in_words(self.doubts))
        write_files({as_path(path): content.encode()})

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The largest traction, how far its model is from a surface, and the rolling
        loss.
        """
        good, bound = np.asarray(self.converged), np.asarray(self.model_error)
        if good.any():
            yield "traction coefficient", span(np.asarray(self.coefficient)[good])
        if (bound > 0).any():
            most = significant(float(np.nanmax(bound)), 2)
            yield "model error", f"at most {most} of the traction coefficient"
        if good.any():
            yield "rolling resistance", span(np.asarray(self.rolling)[good])


def _fitted(curve: Traction, temperature: float | None) -> MagicFormula:
    """The Magic Formula of the braking points of a slip curve. Raises `InputError`."""
    mu, slip, load = _braking_points(curve, temperature)
    loads = np.unique(np.round(load, 6))
    nominal = float(loads[loads.size // 2])
    # at one load nothing is known of what changes with it
    free = len(COEFFICIENTS) if loads.size > 1 else 4
    fixed = list(_START[free:])

    def deviation(p: np.ndarray) -> np.ndarray:
        return _coefficient([*p, *fixed], slip, load / nominal - 1) - mu

    fit = _least_squares(deviation, mu, slip, free)
    coefficients = map(float, [*fit.x, *fixed])
    return MagicFormula(
        coefficients=dict(zip(COEFFICIENTS, coefficients, strict=True)),
        nominal=nominal,
        residual=float(np.sqrt(np.mean(fit.fun**2))),
        worst=float(abs(fit.fun).max()),
        load=(float(loads[0]), float(loads[-1])),
        slip=float(slip.max()),
        velocity=float(
            np.ravel(curve.velocity if curve.road is None else curve.road)[0]
        ),
    )


def _braking_points(
    curve: Traction, temperature: float | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """F_x/F_N, slip and load of the points that brake, at one speed and temperature.
    Raises `InputError`.
    """
    mu = np.asarray(curve.coefficient, dtype=float)
    temperatures = curve.temperature
    if temperature is not None:
        mu = np.where(_is_at(temperature, temperatures), mu, np.nan)
        temperatures = None
    for name, values in (
        ("temperature", temperatures),
        ("velocity of the road", curve.road),
    ):
        if values is not None and np.ptp(values) > 0:
            raise InputError(
                argument=name,
                got=float(np.ptp(values)),
                accepted="one for a Magic Formula, without a difference between values",
            )
    creepage = np.broadcast_to(np.asarray(curve.creepage), mu.shape)
    load = np.broadcast_to(np.asarray(curve.normal_force), mu.shape)
    slip = creepage / (1 + creepage)
    brakes = np.isfinite(mu) & (slip > 0) & (mu > 0)
    if brakes.sum() < 8:
        raise InputError(
            argument="slip",
            got=int(brakes.sum()),
            accepted="eight known braking points or more for a Magic Formula",
        )
    return mu[brakes], slip[brakes], load[brakes]


def _least_squares(
    deviation: Callable[[np.ndarray], np.ndarray],
    mu: np.ndarray,
    slip: np.ndarray,
    free: int,
) -> Any:
    """The fit of the first `free` coefficients, from a start that the curve gives."""
    from scipy.optimize import least_squares

    steepest = np.median((mu / slip)[slip <= np.quantile(slip, 0.15)])
    start = np.clip(
        [_START[0], mu.max(), _START[2], float(steepest), *_START[4:]],
        np.array(_LOWEST) + 1e-3,
        np.array(_HIGHEST) - 1e-3,
    )[:free]
    return least_squares(
        deviation,
        start,
        bounds=(_LOWEST[:free], _HIGHEST[:free]),
        x_scale=np.maximum(abs(start), 0.1),
    )


def _is_at(temperature: float, temperatures: Array | None) -> np.ndarray:
    """Which points have a temperature. Raises `InputError` where none has."""
    known = (
        np.zeros(0) if temperatures is None else np.asarray(temperatures, dtype=float)
    )
    equal = np.isclose(known, temperature, rtol=0, atol=1e-6)
    if not equal.any():
        listed = ", ".join(f"{value:g} K" for value in np.unique(known))
        raise InputError(
            argument="temperature",
            got=temperature,
            accepted=f"one of the slip curve, {listed}"
            if listed
            else "left out for a slip curve without temperatures",
        )
    return equal


def _property_file(
    formula: MagicFormula, radius: float, width: float, doubts: Iterable[str]
) -> str:
    """The text of a .tir file, the doubts of its curve among the comments."""
    zero = ("PDX3", "PEX3", "PEX4", "PKX3", "PHX1", "PHX2", "PVX1", "PVX2")
    scaling = ("LFZO", "LCX", "LMUX", "LEX", "LKX", "LHX", "LVX")
    tables: dict[str, dict[str, Any]] = {
        "MDI_HEADER": {
            "FILE_TYPE": "'tir'",
            "FILE_VERSION": 3.0,
            "FILE_FORMAT": "'ASCII'",
        },
        "UNITS": {
            "LENGTH": "'meter'",
            "FORCE": "'newton'",
            "ANGLE": "'radians'",
            "MASS": "'kg'",
            "TIME": "'second'",
        },
        "MODEL": {
            "PROPERTY_FILE_FORMAT": "'PAC2002'",
            "USE_MODE": 1,
            "LONGVL": formula.velocity,
        },
        "DIMENSION": {"UNLOADED_RADIUS": float(radius), "WIDTH": float(width)},
        "VERTICAL": {"FNOMIN": formula.nominal},
        "LONG_SLIP_RANGE": {"KPUMIN": -formula.slip, "KPUMAX": formula.slip},
        "VERTICAL_FORCE_RANGE": {"FZMIN": formula.load[0], "FZMAX": formula.load[1]},
        "SCALING_COEFFICIENTS": dict.fromkeys(scaling, 1.0),
        "LONGITUDINAL_COEFFICIENTS": formula.coefficients | dict.fromkeys(zero, 0.0),
    }
    lines = [
        f"$ elastomdr {__version__}: Magic Formula (PAC2002) of longitudinal force, "
        "fitted to a slip curve in braking",
        f"$ residual of F_x/F_z: {formula.residual:.4f} rms, {formula.worst:.4f} at "
        "worst; driving is its mirror image",
        "$ without lateral force, moments, vertical stiffness and rim: add those of your "
        "tyre",
        *(f"$ {line}" for line in doubts),
    ]
    for name, values in tables.items():
        lines.append(f"[{name}]")
        for key, value in values.items():
            written = value if isinstance(value, str) else f"{value:.10g}"
            lines.append(f"{key:<24} = {written}")
    return "\n".join(lines) + "\n"
