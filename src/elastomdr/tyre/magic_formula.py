"""The Magic Formula of braking: fitted to a slip curve, and written as a property file
for tyre models.

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

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import __version__
from ..checks import positive
from ..errors import InputError
from ..files import write_files

if TYPE_CHECKING:
    import os

    from .traction_result import Traction

NAMES = ("PCX1", "PDX1", "PEX1", "PKX1", "PDX2", "PEX2", "PKX2")
_START = (1.6, 1.0, 0.0, 20.0, 0.0, 0.0, 0.0)
_LOW, _HIGH = (
    (1.0, 0.01, -20.0, 0.5, -1.0, -20.0, -200.0),
    (1.99, 5.0, 1.0, 500.0, 1.0, 20.0, 200.0),
)


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

    def force(self, slip: Any, load: Any) -> np.ndarray:
        """F_x [N] at braking slips s = (V - v)/V, a force against the motion counted
        positive, and loads [N].
        """
        slip, load = np.asarray(slip, dtype=float), np.asarray(load, dtype=float)
        return load * _coefficient(
            [self.coefficients[n] for n in NAMES], slip, load / self.nominal - 1
        )


def _coefficient(p: Any, slip: np.ndarray, f: np.ndarray) -> np.ndarray:
    shape, grip, bend = p[0], p[1] + p[4] * f, p[2] + p[5] * f
    x = (p[3] + p[6] * f) / (shape * grip) * slip
    return grip * np.sin(shape * np.arctan(x - bend * (x - np.arctan(x))))


def fitted(curve: Traction, temperature: float | None = None) -> MagicFormula:
    """The Magic Formula of a slip curve at one speed, and one temperature of those that
    it has [K].

    Raises `InputError`.
    """
    from scipy.optimize import least_squares

    mu = np.asarray(curve.coefficient, dtype=float)
    kelvin = curve.temperature
    if temperature is not None:
        mu = np.where(_at(temperature, kelvin), mu, np.nan)
        kelvin = None
    for name, values in (("temperature", kelvin), ("velocity of the road", curve.road)):
        if values is not None and np.ptp(values) > 0:
            raise InputError(
                f"{name} must be one for a Magic Formula, got {np.ptp(values):.3g} "
                "between values."
            )
    creepage = np.broadcast_to(np.asarray(curve.creepage), mu.shape)
    slip, load = (
        creepage / (1 + creepage),
        np.broadcast_to(np.asarray(curve.normal_force), mu.shape),
    )
    good = np.isfinite(mu) & (slip > 0) & (mu > 0)
    if good.sum() < 8:
        raise InputError(
            "slip must have eight known braking points or more for a Magic "
            "Formula, "
            f"got {good.sum()}."
        )
    mu, slip, load = mu[good], slip[good], load[good]
    loads = np.unique(np.round(load, 6))
    nominal = float(loads[loads.size // 2])
    free = len(NAMES) if loads.size > 1 else 4
    rest = list(_START[free:])

    def off(p: np.ndarray) -> np.ndarray:
        return _coefficient([*p, *rest], slip, load / nominal - 1) - mu

    start = np.clip(
        [
            1.6,
            mu.max(),
            0.0,
            float(np.median((mu / slip)[slip <= np.quantile(slip, 0.15)])),
            0,
            0,
            0,
        ],
        np.array(_LOW) + 1e-3,
        np.array(_HIGH) - 1e-3,
    )[:free]
    found = least_squares(
        off,
        start,
        bounds=(_LOW[:free], _HIGH[:free]),
        x_scale=np.maximum(abs(start), 0.1),
    )
    values = [*found.x, *rest]
    return MagicFormula(
        coefficients=dict(zip(NAMES, map(float, values), strict=True)),
        nominal=nominal,
        residual=float(np.sqrt(np.mean(found.fun**2))),
        worst=float(abs(found.fun).max()),
        load=(float(loads[0]), float(loads[-1])),
        slip=float(slip.max()),
        velocity=float(
            np.ravel(curve.velocity if curve.road is None else curve.road)[0]
        ),
    )


def _at(temperature: float, kelvin: Any) -> np.ndarray:
    """Which points have a temperature. Raises `InputError` where none has."""
    known = np.zeros(0) if kelvin is None else np.asarray(kelvin, dtype=float)
    which = np.isclose(known, temperature, rtol=0, atol=1e-6)
    if not which.any():
        had = (
            ", ".join(f"{value:g} K" for value in np.unique(known))
            or "none, since the slip curve has none"
        )
        raise InputError(
            f"temperature must be one of the slip curve ({had}), got {temperature!r}."
        )
    return which


def write(
    curve: Traction,
    path: str | os.PathLike[str],
    radius: float,
    width: float,
    temperature: float | None = None,
) -> None:
    """Writes the property file. Raises `InputError`."""
    positive("radius", radius)
    positive("width", width)
    one = fitted(curve, temperature)
    zero = ("PDX3", "PEX3", "PEX4", "PKX3", "PHX1", "PHX2", "PVX1", "PVX2")
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
            "LONGVL": one.velocity,
        },
        "DIMENSION": {"UNLOADED_RADIUS": float(radius), "WIDTH": float(width)},
        "VERTICAL": {"FNOMIN": one.nominal},
        "LONG_SLIP_RANGE": {"KPUMIN": -one.slip, "KPUMAX": one.slip},
        "VERTICAL_FORCE_RANGE": {"FZMIN": one.load[0], "FZMAX": one.load[1]},
        "SCALING_COEFFICIENTS": dict.fromkeys(
            ("LFZO", "LCX", "LMUX", "LEX", "LKX", "LHX", "LVX"), 1.0
        ),
        "LONGITUDINAL_COEFFICIENTS": one.coefficients | dict.fromkeys(zero, 0.0),
    }
    lines = [
        (
            f"$ elastomdr {__version__}: Magic Formula (PAC2002) of longitudinal "
            "force, fitted to a slip curve in braking"
        ),
        (
            f"$ residual of F_x/F_z: {one.residual:.4f} rms, {one.worst:.4f} at "
            "worst; driving is its mirror image"
        ),
        (
            "$ lateral force, moments, vertical stiffness and rim are not in it: the "
            "program's own have to be added"
        ),
    ]
    for name, values in tables.items():
        lines += [
            f"[{name}]",
            *(
                f"{key:<24} = {x if isinstance(x, str) else f'{x:.10g}'}"
                for key, x in values.items()
            ),
        ]
    write_files({Path(path): ("\n".join(lines) + "\n").encode()})
