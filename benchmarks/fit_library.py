"""Fits the library's materials of grade "fitted here" to measured dynamic moduli and
writes their TOML files.

    python benchmarks/fit_library.py DATA_DIR [--out DIRECTORY]

DATA_DIR holds one folder per data set, as their authors publish them (the data are not
part of this repository):

    epdm-70/tf_015p.csv, sd_10hz.csv        github.com/MarcusNi96/dma-prony-validation
    polyisoprene-34k/*.osc                  github.com/jorge-ramirez-upm/RepTate
    psa-468mp/frequency_sweep_tts.txt       github.com/3mcloud/hermes-rheo
    pv-encapsulant/freq_user_master*.csv    github.com/NREL/pyvisco

EPDM and adhesive are fitted by `em.fit.material`. The melt and the encapsulant are
shifted along the frequency axis only, by a published law or table. Moduli are the
non-negative least-squares solution for the relative deviations of storage and loss
modulus; relaxation times are log-spaced and reach half a decade beyond the data.
"""

import argparse
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from scipy.optimize import nnls

import elastomdr as em
from elastomdr.material.validity import Range, misfit_bands
from elastomdr.trees import replaced

KELVIN = np.array([0, 273.15, 0, 0])  # added to a row of data in degC


@dataclass(frozen=True)
class DataSet:
    name: str
    description: str
    citation: str
    note: str
    # columns: angular frequency [rad/s], temperature [K], storage modulus [Pa], loss
    # modulus [Pa]
    data: np.ndarray
    shift: Any  # WLF or ShiftTable
    shift_source: dict[str, str]
    liquid: bool = False  # no equilibrium modulus
    per_decade: float = 1.0  # relaxation times per decade
    kind: str = "shear"
    poisson: float = 0.5
    poisson_source: str = "Assumed incompressible; not measured"
    vertical: Any = None  # EntropicVertical
    vertical_source: dict[str, str] | None = None


def polyisoprene(data: Path) -> DataSet:
    rows = []
    for path in sorted((data / "polyisoprene-34k").glob("*.osc")):
        lines = [
            line.split() for line in path.read_text(encoding="latin-1").splitlines()[3:]
        ]
        rows += [[float(line[k]) for k in (0, 3, 1, 2)] for line in lines if line]
    likhtman = (
        "A. Likhtman 2006, materials database of RepTate "
        "(github.com/jorge-ramirez-upm/RepTate)"
    )
    return DataSet(
        "polyisoprene-34k",
        "Polyisoprene melt of 33.6 kg/mol, entangled; a liquid",
        (
            "Isotherms PI33K-8 (Leeds, D. Auhl) distributed with RepTate, "
            "github.com/jorge-ramirez-upm/RepTate (GPL-3.0)"
        ),
        (
            "With the vertical shifts of entropy elasticity, which em.fit.material "
            "finds in the data."
        ),
        np.array(rows) + KELVIN,
        em.WLF(6.63, 104.3, 263.15),
        {
            "citation": likhtman,
            "grade": "published fit",
            "note": "There 4.965 and 139.3 K at 25 degC; rewritten.",
        },
        liquid=True,
        per_decade=1.5,
        vertical=em.EntropicVertical(263.15),
        vertical_source={
            "citation": (
                "Entropy elasticity of a melt, the density taken as constant: J. D. "
                "Ferry 1980, Viscoelastic Properties of Polymers, ch. 11"
            ),
            "grade": "published fit",
        },
    )


def epdm(data: Path) -> em.fit.MaterialFit:
    return em.fit.material(
        em.read_dma(data / "epdm-70" / "tf_015p.csv"),
        298.15,
        name="epdm-70",
        description="EPDM, 70 Shore A, filled; dynamic moduli in shear at 0.15 % strain",
        citation=(
            "Shear DMA at 0.15 % strain, run tf_015p, "
            "github.com/MarcusNi96/dma-prony-validation (GPL-3.0), whose authors "
            "corrected temperatures with an empirical rule; filled: moduli fall with "
            "strain amplitude"
        ),
    )


def softened(data: Path, fit: em.fit.MaterialFit) -> tuple[em.Prony, dict[str, Any]]:
    """`epdm-70-softening`: the EPDM with its strain sweep, and what that file holds
    beside the numbers.

    The moduli are those at the amplitude of the isotherms, 0.15 %: the factors begin
    there, with 1.
    """
    sweep = em.read_dma(data / "epdm-70" / "sd_10hz.csv")
    kept = np.argsort(sweep.strain)
    kept = kept[sweep.strain[kept] > 1.4e-3]
    strain, storage, loss = sweep.strain[kept], sweep.storage[kept], sweep.loss[kept]
    lists = rounded(
        np.array([strain, np.minimum.accumulate(storage) / storage[0], loss / loss[0]]),
        4,
    )
    text = (
        "Strain sweep at 10 Hz and 22 degC, run sd_10hz, "
        "github.com/MarcusNi96/dma-prony-validation (GPL-3.0)"
    )
    note = (
        "Factors on the moduli at 0.15 %, at which the isotherms were measured. The "
        "sweep ends at 1.14 %, where neither modulus levels off: beyond it the "
        "factors are held, and rubber on a rough surface is softer still."
    )
    source = {
        "citation": f"{text}, divided by the point at 0.15 % by benchmarks/fit_library.py",
        "grade": "measured",
    }
    info = fit.info()
    info["source"] |= {"softening": source | {"note": note}}
    info["description"] = (
        "EPDM, 70 Shore A, filled; dynamic moduli of epdm-70 with their softening up "
        "to 1.1 % strain"
    )
    return replaced(
        fit.material, name="epdm-70-softening", softening=em.Softening(*lists)
    ), info


def adhesive(data: Path) -> em.fit.MaterialFit:
    return em.fit.material(
        em.read_dma(data / "psa-468mp" / "frequency_sweep_tts.txt"),
        303.15,
        name="psa-468mp",
        description="3M 468MP, acrylic pressure-sensitive adhesive",
        citation=(
            "TRIOS export of 3M 468MP distributed with hermes-rheo, "
            "github.com/3mcloud/hermes-rheo (MIT)"
        ),
    )


def encapsulant(data: Path) -> DataSet:
    master, factors = (
        np.loadtxt(
            data / f"pv-encapsulant/freq_user_master{end}.csv",
            delimiter=",",
            skiprows=2,
            encoding="utf-8-sig",
        )
        for end in ("", "__shift_factors")
    )
    master = master[(master[:, 0] >= 1e-6) & (master[:, 0] <= 1e13)]
    citation = (
        "Example files freq_user_master of pyvisco, github.com/NREL/pyvisco "
        "(BSD-3-Clause)"
    )
    return DataSet(
        "pv-encapsulant",
        "Encapsulant polymer of photovoltaic modules; dynamic moduli in tension",
        citation,
        "Fitted to the published master curve from 1e-6 to 1e13 Hz. Its two moduli "
        "contradict each other (more loss than the slope of the storage modulus "
        "allows, most at low frequency), so that no Prony series comes closer.",
        # -5 degC is where the curve is given
        np.insert(master, 1, -5.0, axis=1) * [2 * np.pi, 1, 1e6, 1e6] + KELVIN,
        em.ShiftTable(np.round(factors[::-1, 0] + 273.15, 2), factors[::-1, 1]),
        {
            "citation": citation,
            "grade": "published fit",
            "note": "Shift factors as published with the master curve.",
        },
        kind="tensile",
        poisson=0.45,
        poisson_source="Assumed, between that of a glass and that of a rubber; not measured",
    )


def fit_prony(
    case: DataSet, log10_a: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray, float]:
    """Equilibrium modulus, moduli, times, and the root of the summed mean squares of
    both relative deviations.
    """
    omega, (storage, loss) = (
        case.data[:, 0] * 10**log10_a,
        case.data[:, 2:].T / lift(case),
    )
    start, end = -np.log10(omega.max()) - 0.5, -np.log10(omega.min()) + 0.5
    times = np.logspace(start, end, round((end - start) * case.per_decade) + 1)
    x = omega[:, None] * times
    matrix = np.vstack(
        [x**2 / (1 + x**2) / storage[:, None], x / (1 + x**2) / loss[:, None]]
    )
    # zero for a liquid: its solution is then zero
    relaxed = np.append(1 / storage, 0 * loss) * (not case.liquid)
    solution, misfit = nnls(np.column_stack([matrix, relaxed]), np.ones(2 * len(omega)))
    kept = solution[:-1] > 0
    return solution[-1], solution[:-1][kept], times[kept], misfit / len(omega) ** 0.5


def lift(case: DataSet) -> Any:
    """b_T of each point."""
    return (
        1.0 if case.vertical is None else np.asarray(case.vertical.b(case.data[:, 1]))
    )


def rounded(values: Any, digits: int) -> Any:
    """Values to significant digits, as floats."""
    return (
        [rounded(value, digits) for value in values]
        if np.ndim(values)
        else float(f"{values:.{digits - 1}e}")
    )


def build(case: DataSet, out: Path) -> str:
    """Fits one material, writes its file and says how well it fits; the residuals are
    those of the rounded numbers.
    """
    shift = case.shift
    omega, temperature, storage, loss = case.data.T
    storage, loss = storage / lift(case), loss / lift(case)
    log10_a = np.asarray(shift.log10_a(temperature))
    reduced = omega * 10**log10_a
    numbers = [rounded(value, 5) for value in fit_prony(case, log10_a)[:3]]
    material = em.Prony(
        *numbers,
        kind=case.kind,
        poisson=case.poisson,
        shift=shift,
        vertical=case.vertical,
        name=case.name,
    )
    fitted = material.complex_modulus(reduced)
    deviations = np.array([fitted.real / storage - 1, fitted.imag / loss - 1])
    residuals = rounded(np.sqrt((deviations**2).mean(axis=1)), 2)
    covered = shift.temperature if isinstance(shift, em.ShiftTable) else temperature
    limits = np.round([min(covered), max(covered)], 2).tolist()
    fitted_here = {
        "citation": f"{case.citation}, fitted by benchmarks/fit_library.py",
        "grade": "fitted here",
    }
    info = {
        "description": case.description,
        "range": {
            "omega": rounded([reduced.min(), reduced.max()], 3),
            "temperature": limits,
        },
        "source": {
            "moduli": fitted_here
            | {
                "note": case.note,
                "storage_residual": residuals[0],
                "loss_residual": residuals[1],
            },
            "shift": case.shift_source,
            "poisson": {"citation": case.poisson_source, "grade": "illustrative"},
            "range": {
                "citation": f"Span of the data: {case.citation}",
                "grade": "measured",
            },
        },
    }
    if case.vertical_source is not None:
        info["source"]["vertical"] = case.vertical_source
    # the range itself is in `info`
    known = Range(None, None, misfit=misfit_bands(reduced, *deviations))
    em.save_material(
        replaced(material, range=known), out / f"{case.name}.toml", info=info
    )
    return (
        f"{case.name}: {material.times.size} branches, rms residuals "
        f"{residuals[0]:.2g} and {residuals[1]:.2g}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(
        description="Fits the library's materials to measured dynamic moduli."
    )
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(__file__).parents[1] / "materials",
        metavar="DIRECTORY",
    )
    arguments = parser.parse_args()
    for read in (polyisoprene, encapsulant):
        print(build(read(arguments.data), arguments.out))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.fit.FitWarning)  # they go into the file
        for fit in (epdm(arguments.data), adhesive(arguments.data)):
            written = [(fit.material, fit.info())]
            if fit.material.name == "epdm-70":
                written.append(softened(arguments.data, fit))
            for material, info in written:
                em.save_material(
                    material, arguments.out / f"{material.name}.toml", info=info
                )
            off = fit.prony.storage_residual, fit.prony.loss_residual
            print(
                f"{fit.material.name}: {fit.prony.terms} branches, rms residuals "
                f"{off[0]:.2g} and {off[1]:.2g}"
            )


if __name__ == "__main__":
    main()
