"""How well a fit predicts points that it was not given: rows held out, and whole
isotherms left out.

    python benchmarks/fit_held_out.py DATA_DIR

DATA_DIR as for `fit_library.py`. Of every data set a quarter of the points, every
fourth along each isotherm, is held out in turn. Master curve and Prony series come from
the others, with vertical shifts or without as `em.fit.material` chooses, and residuals
are those of the held-out points. Then each isotherm between the coldest and the warmest
is left out, and predicted with the shifts of its neighbours: the WLF law plus its
residuals, interpolated. The target is 10 % rms of both moduli with at most one and a
half terms per decade.

The first two figures are those of the master curve: predicted moduli are divided by the
vertical shift of their isotherm. "As used" is the material that the fit delivers, with
its laws of shifts and nothing else, against the same points as measured. The second
table has the materials that the default command and `--no-vertical` deliver, against
all of their data.
"""

import argparse
import warnings
from pathlib import Path
from typing import Any

import numpy as np
from common import heading, one_core, save, table, verdict

import elastomdr as em
from elastomdr.fit.pipeline import deviations

FOLDS = 4


def part(dma: em.fit.Dma, at: np.ndarray) -> em.fit.Dma:
    return em.fit.dma(
        dma.omega[at], dma.storage[at], dma.loss[at], dma.temperature[at], kind=dma.kind
    )


def foretold(
    dma: em.fit.Dma, test: np.ndarray, reference: float
) -> tuple[np.ndarray, float]:
    """Relative errors at the points `test` from a fit of all others, and its terms per
    decade: of both moduli of the master curve, then of those of the material that the
    fit delivers.
    """
    # as the command does, which chooses vertical shifts or none
    fit = em.fit.material(part(dma, ~test), reference)
    master, series = fit.master, fit.prony
    kelvin = dma.temperature[test]
    shift, lift = (
        np.interp(kelvin, master.temperature, log10)
        for log10 in (master.log10_a, master.log10_b)
    )
    if master.wlf is not None:
        bent = np.interp(kelvin, master.temperature, master.laws["WLF"].residuals)
        inside = (kelvin >= master.temperature[0]) & (kelvin <= master.temperature[-1])
        shift = np.where(inside, np.asarray(master.wlf.log10_a(kelvin)) + bent, shift)
    moduli = series.moduli_at(dma.omega[test] * 10**shift)
    errors = [
        found / 10**lift / seen[test] - 1
        for found, seen in zip(moduli, (dma.storage, dma.loss), strict=True)
    ]
    errors += deviations(fit.material, part(dma, test)).values()
    return np.array(errors), series.terms / np.log10(
        series.window[1] / series.window[0]
    )


def row(
    name: str, what: str, trials: list[tuple[np.ndarray, float]]
) -> tuple[Any, ...]:
    errors = np.concatenate([errors for errors, _ in trials], axis=1)
    rms, typical = np.sqrt((errors**2).mean(axis=1)), np.median(np.abs(errors), axis=1)
    return (
        name,
        what,
        len(trials),
        *(100 * rms),
        *(100 * typical[:2]),
        max(density for _, density in trials),
    )


def delivered(name: str, dma: em.fit.Dma) -> tuple[Any, ...]:
    """How far the materials of the default command and of `--no-vertical` are from all
    data as measured.
    """
    fits = [em.fit.material(dma, vertical=vertical) for vertical in (None, False)]
    sizes = [100 * size for fit in fits for size in fit.pipeline.values()]
    return name, fits[0].master.reference - 273.15, *sizes


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    data = parser.parse_args().data
    one_core()
    record = heading("What a fit has not seen", "measured data; errors are relative")
    warnings.simplefilter("ignore", em.fit.FitWarning)
    sets = (
        ("polyisoprene", sorted((data / "polyisoprene-34k").glob("*.osc")), 263.15),
        ("EPDM-70", data / "epdm-70" / "tf_015p.csv", 298.15),
        ("468MP adhesive", data / "psa-468mp" / "frequency_sweep_tts.txt", 303.15),
        ("encapsulant", data / "pv-encapsulant" / "freq_user_raw.csv", 268.15),
    )
    rows, materials = [], []
    for name, path, reference in sets:
        dma = em.read_dma(path)
        kelvin = em.fit.master_curve(dma, reference).temperature
        isotherm = np.abs(dma.temperature[:, None] - kelvin).argmin(axis=1)
        rank = np.argsort(np.lexsort((dma.omega, isotherm)))
        held = [foretold(dma, rank % FOLDS == fold, reference) for fold in range(FOLDS)]
        left = [
            foretold(dma, isotherm == i, reference) for i in range(1, kelvin.size - 1)
        ]
        materials.append(delivered(name, dma))
        rows += [row(name, "every fourth point", held), row(name, "an isotherm", left)]
    columns = (
        "data",
        "held out",
        "fits",
        "storage, rms [%]",
        "loss, rms [%]",
        "as used: storage, rms [%]",
        "as used: loss, rms [%]",
        "storage, median [%]",
        "loss, median [%]",
        "terms per decade, most",
    )
    record["held out"] = table(columns, rows)
    print()
    columns = (
        "material, of all points",
        "reference [degC]",
        "default: storage, rms [%]",
        "default: loss, rms [%]",
        "--no-vertical: storage, rms [%]",
        "--no-vertical: loss, rms [%]",
    )
    record["delivered"] = table(columns, materials)
    print()
    record["verdicts"] = [
        verdict(f"{one[0]}, {one[1]}, {which}", one[at], bound, unit)
        for one in rows
        for which, at, bound, unit in (
            ("storage", 3, 10.0, " %"),
            ("loss", 4, 10.0, " %"),
            ("storage as used", 5, 10.0, " %"),
            ("loss as used", 6, 10.0, " %"),
            ("terms a decade", 9, 1.5, ""),
        )
    ]
    record["verdicts"] += [
        verdict(
            f"{one[0]}, material of the {how}, {which} as used", one[at], 10.0, " %"
        )
        for one in materials
        for how, which, at in (
            ("default command", "storage", 2),
            ("default command", "loss", 3),
            ("command with --no-vertical", "storage", 4),
            ("command with --no-vertical", "loss", 5),
        )
    ]
    save("fit_held_out", record)


if __name__ == "__main__":
    main()
