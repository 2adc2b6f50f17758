"""Fits the library's materials of grade "fitted here" to measured dynamic moduli and writes their TOML files.

    python benchmarks/fit_library.py DATA_DIR [--out DIRECTORY]

DATA_DIR holds one folder per data set, as their authors publish them (the data are not part of this repository):

    epdm-70/tf_015p.csv                     github.com/MarcusNi96/dma-prony-validation
    polyisoprene-34k/*.osc                  github.com/jorge-ramirez-upm/RepTate
    psa-468mp/frequency_sweep_tts.txt       github.com/3mcloud/hermes-rheo
    pv-encapsulant/freq_user_master*.csv    github.com/NREL/pyvisco

Isotherms are shifted along the frequency axis only, as the material model does: by a published law or table, or by the
WLF constants that leave the smallest residuals. Moduli are the non-negative least-squares solution for the relative
deviations of storage and loss modulus; relaxation times are log-spaced and reach half a decade beyond the data.
"""

import argparse
import csv
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import minimize, nnls

import elastomdr as em

KELVIN = np.array([0, 273.15, 0, 0])  # added to a row of data in degC


@dataclass(frozen=True)
class DataSet:
    name: str
    description: str
    citation: str
    note: str
    data: np.ndarray  # columns: angular frequency [rad/s], temperature [K], storage modulus [Pa], loss modulus [Pa]
    shift: Any  # WLF or ShiftTable
    shift_source: dict[str, str] | None = None  # None: the constants are fitted, from those of `shift`
    shift_note: str = "Fitted together with the moduli."
    liquid: bool = False  # no equilibrium modulus
    per_decade: float = 1.0  # relaxation times per decade
    kind: str = "shear"
    poisson: float = 0.5
    poisson_source: str = "Assumed incompressible; not measured"


def epdm(data: Path) -> DataSet:
    with open(data / "epdm-70" / "tf_015p.csv", newline="", encoding="utf-8") as file:
        keys = ("freq_hz", "temperature_C", "G_storage_pa", "G_loss_pa")
        table = np.array([[float(row[key]) for key in keys] for row in csv.DictReader(file)])
    return DataSet(
        "epdm-70",
        "EPDM, 70 Shore A, filled; dynamic moduli in shear at 0.15 % strain",
        "Shear DMA at 0.15 % strain, run tf_015p, github.com/MarcusNi96/dma-prony-validation (GPL-3.0)",
        "Filled: moduli fall with strain amplitude, and these hold near 0.15 %. The data's temperatures were corrected "
        "by their authors with an empirical rule.",
        table * [2 * np.pi, 1, 1, 1] + KELVIN,
        em.WLF(3.0, 83.0, 298.15),
        shift_note="Uncertain: published methods find log10 a_T at -10 degC of these data anywhere from 0.4 to 3.5. "
        "Constants c1 = 3.0 and c2 = 83 K leave residuals of 0.065 and 0.068.",
    )


def polyisoprene(data: Path) -> DataSet:
    rows = []
    for path in sorted((data / "polyisoprene-34k").glob("*.osc")):
        lines = [line.split() for line in path.read_text(encoding="latin-1").splitlines()[3:]]
        rows += [[float(line[k]) for k in (0, 3, 1, 2)] for line in lines if line]
    likhtman = "A. Likhtman 2006, materials database of RepTate (github.com/jorge-ramirez-upm/RepTate)"
    return DataSet(
        "polyisoprene-34k",
        "Polyisoprene melt of 33.6 kg/mol, entangled; a liquid",
        "Isotherms PI33K-8 (Leeds, D. Auhl) distributed with RepTate, github.com/jorge-ramirez-upm/RepTate (GPL-3.0)",
        "No vertical shift, although a melt's moduli follow density times temperature: the model leaves that out.",
        np.array(rows) + KELVIN,
        em.WLF(6.63, 104.3, 263.15),
        {"citation": likhtman, "grade": "published fit", "note": "There 4.965 and 139.3 K at 25 degC; rewritten."},
        liquid=True,
        per_decade=1.5,
    )


def adhesive(data: Path) -> DataSet:
    rows = []
    text = (data / "psa-468mp" / "frequency_sweep_tts.txt").read_text(encoding="utf-8-sig")
    for step in text.split("[Step]")[1:]:
        lines = [line.split("\t") for line in step.splitlines()]
        names, units = (next(line for line in lines if line[0] == word) for word in ("Variables", "Units"))
        columns = [names.index(k) for k in ("Angular frequency", "Temperature", "Storage modulus", "Loss modulus")]
        factors = [{"rad/s": 1.0, "°C": 1.0, "kPa": 1e3, "MPa": 1e6}[units[column]] for column in columns]
        points = [line for line in lines if line[0].startswith("Data point")]
        rows += [[float(line[c]) * factor for c, factor in zip(columns, factors, strict=True)] for line in points]
    rows = [row for row in rows if min(row[2:]) > 0]
    return DataSet(
        "psa-468mp",
        "3M 468MP, acrylic pressure-sensitive adhesive",
        "TRIOS export of 3M 468MP distributed with hermes-rheo, github.com/3mcloud/hermes-rheo (MIT)",
        "Left out: one point at -40 degC and 20 Hz whose loss modulus is negative.",
        np.array(rows) + KELVIN,
        em.WLF(8.48, 139.2, 303.15),
    )


def encapsulant(data: Path) -> DataSet:
    master, factors = (
        np.loadtxt(data / f"pv-encapsulant/freq_user_master{end}.csv", delimiter=",", skiprows=2, encoding="utf-8-sig")
        for end in ("", "__shift_factors")
    )
    master = master[(master[:, 0] >= 1e-6) & (master[:, 0] <= 1e13)]
    citation = "Example files freq_user_master of pyvisco, github.com/NREL/pyvisco (BSD-3-Clause)"
    return DataSet(
        "pv-encapsulant",
        "Encapsulant polymer of photovoltaic modules; dynamic moduli in tension",
        citation,
        "Fitted to the published master curve from 1e-6 to 1e13 Hz. Its two moduli contradict each other (more loss "
        "than the slope of the storage modulus allows, most at low frequency), so that no Prony series comes closer.",
        np.insert(master, 1, -5.0, axis=1) * [2 * np.pi, 1, 1e6, 1e6] + KELVIN,  # -5 degC is where the curve is given
        em.ShiftTable(np.round(factors[::-1, 0] + 273.15, 2), factors[::-1, 1]),
        {"citation": citation, "grade": "published fit", "note": "Shift factors as published with the master curve."},
        kind="tensile",
        poisson=0.45,
        poisson_source="Assumed, between that of a glass and that of a rubber; not measured",
    )


def fit_prony(case: DataSet, log10_a: np.ndarray) -> tuple[float, np.ndarray, np.ndarray, float]:
    """Equilibrium modulus, moduli, times, and the root of the summed mean squares of both relative deviations."""
    omega, (storage, loss) = case.data[:, 0] * 10**log10_a, case.data[:, 2:].T
    start, end = -np.log10(omega.max()) - 0.5, -np.log10(omega.min()) + 0.5
    times = np.logspace(start, end, round((end - start) * case.per_decade) + 1)
    x = omega[:, None] * times
    matrix = np.vstack([x**2 / (1 + x**2) / storage[:, None], x / (1 + x**2) / loss[:, None]])
    relaxed = np.append(1 / storage, 0 * loss) * (not case.liquid)  # zero for a liquid: its solution is then zero
    solution, misfit = nnls(np.column_stack([matrix, relaxed]), np.ones(2 * len(omega)))
    kept = solution[:-1] > 0
    return solution[-1], solution[:-1][kept], times[kept], misfit / len(omega) ** 0.5


def fit_wlf(case: DataSet) -> em.WLF:
    """The WLF constants, to four digits, with which the Prony series comes closest to the data."""
    temperature, reference = case.data[:, 1], float(case.shift.reference)

    def misfit(logarithms: np.ndarray) -> float:
        c1, c2 = np.exp(logarithms)
        if reference - c2 > temperature.min() - 1:  # the law's pole must stay below the data
            return 1e3
        return fit_prony(case, -c1 * (temperature - reference) / (c2 + temperature - reference))[-1]

    options = {"xatol": 1e-5, "fatol": 1e-9}
    best = minimize(misfit, np.log([case.shift.c1, case.shift.c2]), method="Nelder-Mead", options=options)
    return em.WLF(*rounded(np.exp(best.x), 4), reference)


def rounded(values: Any, digits: int) -> Any:
    """Values to significant digits, as floats."""
    return [rounded(value, digits) for value in values] if np.ndim(values) else float(f"{values:.{digits - 1}e}")


def build(case: DataSet, out: Path) -> str:
    """Fits one material, writes its file and says how well it fits; the residuals are those of the rounded numbers."""
    shift = case.shift if case.shift_source else fit_wlf(case)
    omega, temperature, storage, loss = case.data.T
    log10_a = np.asarray(shift.log10_a(temperature))
    reduced = omega * 10**log10_a
    numbers = [rounded(value, 5) for value in fit_prony(case, log10_a)[:3]]
    material = em.Prony(*numbers, kind=case.kind, poisson=case.poisson, shift=shift, name=case.name)
    fitted = material.complex_modulus(reduced) * (2 * (1 + case.poisson) if case.kind == "tensile" else 1)
    deviations = np.array([fitted.real / storage - 1, fitted.imag / loss - 1])
    residuals = rounded(np.sqrt((deviations**2).mean(axis=1)), 2)
    covered = shift.temperature if isinstance(shift, em.ShiftTable) else temperature
    limits = np.round([min(covered), max(covered)], 2).tolist()
    fitted_here = {"citation": f"{case.citation}, fitted by benchmarks/fit_library.py", "grade": "fitted here"}
    info = {
        "description": case.description,
        "range": {"frequency": rounded([reduced.min(), reduced.max()], 3), "temperature": limits},
        "source": {
            "moduli": fitted_here
            | {"note": case.note, "storage_residual": residuals[0], "loss_residual": residuals[1]},
            "shift": case.shift_source or fitted_here | {"note": case.shift_note},
            "poisson": {"citation": case.poisson_source, "grade": "illustrative"},
            "range": {"citation": f"Span of the data: {case.citation}", "grade": "measured"},
        },
    }
    em.save_material(material, out / f"{case.name}.toml", info=info)
    return f"{case.name}: {material.times.size} branches, rms residuals {residuals[0]:.2g} and {residuals[1]:.2g}"


def main() -> None:
    parser = argparse.ArgumentParser(description="Fits the library's materials to measured dynamic moduli.")
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[1] / "materials", metavar="DIRECTORY")
    arguments = parser.parse_args()
    for read in (epdm, polyisoprene, adhesive, encapsulant):
        print(build(read(arguments.data), arguments.out))


if __name__ == "__main__":
    main()
