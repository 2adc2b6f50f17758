"""The tables of a fit: shifted data, shift factors, series."""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..files import csv_text
from .findings import PLUS_MINUS

if TYPE_CHECKING:
    from .master import MasterCurve
    from .payne import Sweeps
    from .series import PronyFit
    from .shear_law import AdhesionFit


def master_csv(master: "MasterCurve") -> str:
    """Shifted data, one row per point, as comma-separated text with the shifts in
    header lines.
    """
    symbol = "G" if master.kind == "shear" else "E"
    columns: Mapping[str, Any]
    if master.omega.size:
        order = np.argsort(master.omega, kind="stable")
        columns = {
            "reduced angular frequency [rad/s]": master.omega[order],
            f"storage modulus {symbol}' times b_T [Pa]": master.storage[order],
            f"loss modulus {symbol}'' times b_T [Pa]": master.loss[order],
            "isotherm [K]": master.temperature[master.isotherm[order]],
        }
    else:
        order = np.argsort(master.time, kind="stable")
        columns = {
            "reduced time [s]": master.time[order],
            f"relaxation modulus {symbol} times b_T [Pa]": master.relaxation[order],
            "isotherm [K]": master.temperature[master.time_isotherm[order]],
        }
    left_out = (("row left out", text) for text in master.dma.bad_rows)
    return _csv("MasterCurve", [*master.findings(), *left_out], columns)


def shifts_csv(master: "MasterCurve") -> str:
    """Shift factors with their standard deviations, one row per isotherm."""
    columns = {
        "temperature [K]": master.temperature,
        "log10 a_T [-]": master.log10_a,
        "standard deviation of log10 a_T [-]": master.log10_a_std,
        "log10 b_T [-]": master.log10_b,
        "standard deviation of log10 b_T [-]": master.log10_b_std,
        "separable": ~master.ambiguous,
    }
    return _csv(
        "shift factors",
        [("reference", f"{master.reference:.10g} K"), ("source", master.source)],
        columns,
    )


def prony_csv(fit: "PronyFit") -> str:
    """The series with standard deviations, one row per term; the equilibrium modulus
    has an infinite time.
    """
    symbol = "G" if fit.kind == "shear" else "E"
    material = fit.material
    columns = {
        "relaxation time [s]": [*np.asarray(material.times).tolist(), np.inf],
        "standard deviation of it [s]": [*fit.times_std.tolist(), 0.0],
        f"modulus {symbol} [Pa]": [
            *np.asarray(material.moduli).tolist(),
            float(material.equilibrium),
        ],
        "standard deviation of modulus [Pa]": [
            *fit.moduli_std.tolist(),
            fit.equilibrium_std,
        ],
    }
    return _csv(
        "Prony series", [(k, v) for k, v in fit.findings() if k != "term"], columns
    )


def adhesion_csv(fit: "AdhesionFit") -> str:
    """Measured points with both parts of the friction, one row per point."""
    columns: dict[str, Any] = {"velocity [m/s]": fit.velocity}
    if fit.temperature is not None:
        columns["temperature [K]"] = fit.temperature
    columns |= {
        "measured friction coefficient [-]": fit.measured,
        "hysteresis [-]": fit.hysteresis,
        "adhesive shear [-]": fit.adhesion,
        "residual [-]": fit.residuals,
        "standard deviation of a measurement [-]": fit.error,
        "used": fit.used,
    }
    return _csv("adhesive shear", fit.findings(), columns, fit.intervals)


def softening_csv(found: "Sweeps") -> str:
    """Measured factors on both moduli, one row per point."""
    columns = {
        "strain amplitude [-]": found.strain,
        "factor on storage modulus [-]": found.storage,
        "factor on loss modulus [-]": found.loss,
        "temperature [K]": found.temperature[found.number],
        "angular frequency [rad/s]": found.omega[found.number],
    }
    return _csv("strain softening", found.findings(), columns, found.intervals)


def _csv(
    what: str,
    findings: Iterable[tuple[str, str]],
    columns: Mapping[str, Any],
    intervals: str = PLUS_MINUS,
) -> str:
    header = [
        f"elastomdr {__version__}: {what}",
        "units: SI, in brackets in the column titles",
        f"intervals: {intervals}; a column of standard deviations holds one of them",
        *(f"{name.strip()}: {text}" for name, text in findings),
    ]
    return csv_text(header, columns)
