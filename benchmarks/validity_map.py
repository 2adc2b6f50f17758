"""How far are the direction average and the bare line from the half-space, over speed,
spectrum and shape?

    python benchmarks/validity_map.py [--fresh]

The truth is `em.reference.half_space_sliding`: three dimensions, the same spectrum, 64
by 64 cells, its own error (from half and three eighths as many) beside each number. It
is kept in results/validity_map_SHAPE.json, since it takes minutes. Spectra: one branch,
and branches of equal modulus a decade apart over 5 and 9 decades; the glassy modulus is
2 to 1000 times the relaxed one. Speeds: seven, evenly spaced in their logarithm over
the range in which the line's friction is above 5% of its peak. Writes the table of the
documentation, results/validity_map.md, and how many of the points the bounds on the
models' error cover.
"""

import shutil
import sys
import warnings
from typing import Any

import numpy as np
from common import RESULTS, cached, heading, plt, save, table, verdict

import elastomdr as em

# E_inf [Pa] (as E*), the longest relaxation time [s], F_N [N]
EQUILIBRIUM, TIME, LOAD = 4e6, 1e-3, 10.0
SHAPES = {
    "paraboloid": em.Paraboloid(0.01),
    "cone": em.Cone(0.15),
    "r^4": em.PowerLaw(4, 5e5),
}
DECADES = (0, 5, 9)
CONTRASTS = (2.0, 10.0, 100.0, 1000.0)
# over the range in which the line's friction is above this part of its peak
SPEEDS, WHERE = 7, 0.05
CELLS = 64
MODELS = {
    "direction": em.Averaged(corrected=False),
    "corrected": em.Averaged(),
    "line": em.Line(),
}
AVERAGES, MARKS = ("direction", "corrected"), ("o", "s", "^", "D")
TITLES = {"direction": "direction average", "corrected": "corrected average"}
REFERENCE = 0.01  # relative error of the reference that its own estimate does not show
COLUMNS = (
    "shape",
    "decades of spectrum",
    "E_0/E_inf",
    "points known",
    "direction average off by, worst [%]",
    "corrected average, worst [%]",
    "bare line, worst [%]",
    "bound of the average there [%]",
    "bound, corrected [%]",
)
# of E_inf: the modulus of branches outside the span, so that one compiled program
# serves all spectra
ABSENT = 1e-12


def law(decades: int, contrast: float) -> em.Foundation:
    moduli = np.where(
        np.arange(10) >= 9 - decades, (contrast - 1) / (decades + 1), ABSENT
    )
    return em.Foundation(
        EQUILIBRIUM, EQUILIBRIUM * moduli, TIME * 10.0 ** np.arange(-9, 1.0)
    )


def speeds(shape: Any, material: em.Foundation) -> np.ndarray:
    sweep = np.geomspace(1e-4, 1e13, 120)
    line = em.friction(
        material, shape, velocity=sweep, load=LOAD, model=em.Line(), rtol=1e-3
    ).mu
    there = sweep[line > WHERE * np.nanmax(line)]
    return np.geomspace(there[0], there[-1], SPEEDS)


def truth(shape: Any, decades: int, contrast: float) -> dict[str, Any]:
    material = law(decades, contrast)
    velocity = speeds(shape, material)
    found = em.reference.half_space_sliding(
        material, shape, velocity=velocity, load=LOAD, points=CELLS
    )
    fields = {
        "velocity": velocity,
        "mu": found.mu,
        "error": found.error,
        "depth": found.depth,
    }
    return fields | {
        "leading": found.contact.leading,
        "trailing": found.contact.trailing,
    }


def truths(name: str, fresh: bool) -> list[dict[str, Any]]:
    """Every spectrum for one shape."""
    inputs = {
        "E_inf": EQUILIBRIUM,
        "tau": TIME,
        "load": LOAD,
        "shape": repr(SHAPES[name]),
        "decades": DECADES,
        "contrasts": CONTRASTS,
        "speeds": SPEEDS,
        "where": WHERE,
        "cells": CELLS,
    }

    def compute() -> list[dict[str, Any]]:
        found = []
        for decades in DECADES:
            for contrast in CONTRASTS:
                print(
                    f"  {name}, {decades} decades, contrast {contrast:g}",
                    file=sys.stderr,
                    flush=True,
                )
                found.append(
                    {
                        "decades": decades,
                        "contrast": contrast,
                        **truth(SHAPES[name], decades, contrast),
                    }
                )
        return found

    kept = cached(f"validity_map_{name.replace('^', '')}", inputs, compute, fresh)
    return [{k: np.array(v, dtype=float) for k, v in one.items()} for one in kept]


def compare(name: str, one: dict[str, Any]) -> dict[str, np.ndarray]:
    """Relative deviations of the models from the reference, and the bounds they
    report.
    """
    known = np.isfinite(one["mu"])
    velocity, exact = one["velocity"][known], one["mu"][known]
    material = law(int(one["decades"]), float(one["contrast"]))
    found = {"velocity": velocity, "own": one["error"][known] / exact}
    for model, chosen in MODELS.items():
        curve = em.friction(
            material,
            SHAPES[name],
            velocity=velocity,
            load=LOAD,
            rtol=1e-3,
            model=chosen,
        )
        found[model] = curve.mu / exact - 1
        found[f"{model} bound"] = curve.model_error / exact
    return found


def main() -> None:
    # points without an answer are counted in the table
    warnings.simplefilter("ignore", em.ConvergenceWarning)
    record = heading(
        (
            "Validity map: the models of em.friction against the half-space in three "
            "dimensions"
        ),
        (
            f"E_inf = {EQUILIBRIUM:g} Pa (E*), longest time {TIME:g} s, load {LOAD:g} "
            f"N; {CELLS} by {CELLS} cells"
        ),
        ", ".join(map(repr, SHAPES.values())),
        f"{SPEEDS} speeds over the range where the line's friction is above "
        f"{100 * WHERE:g} % of its peak; without the "
        "slowest, at which the average is exact and the reference's grid is not (1 to "
        "3 % low)",
    )
    rows, clouds, covered = [], {}, {model: [] for model in AVERAGES}
    for name in SHAPES:
        for one in truths(name, "--fresh" in sys.argv):
            found = compare(name, one)
            part = {key: value[1:] for key, value in found.items()}
            worst = [
                100 * part[model][np.abs(part[model]).argmax()] for model in MODELS
            ]
            at = np.abs(part["direction"]).argmax()
            bounds = [100 * part[f"{model} bound"][at] for model in AVERAGES]
            decades, contrast = int(one["decades"]), float(one["contrast"])
            rows.append(
                (
                    name,
                    decades,
                    contrast,
                    f"{part['own'].size} of {SPEEDS - 1}",
                    *worst,
                    *bounds,
                )
            )
            clouds[name, decades, contrast] = found
            for model in AVERAGES:
                covered[model] += list(
                    np.abs(part[model])
                    <= part[f"{model} bound"] + REFERENCE + part["own"]
                )
    record["table"] = table(COLUMNS, rows)
    print()
    for model, hits in covered.items():
        share = 100 * float(np.mean(hits))
        print(
            f"  {model}: the bound covers {share:.1f} % of {len(hits)} points, to "
            "the "
            "reference's own error"
        )
        record[f"covered by the bound, {model} [%]"] = share
    record["verdicts"] = [
        verdict(
            f"{model} average, {name}: farthest off the half-space",
            farthest(rows, name, model),
            5,
            " %",
        )
        for model in AVERAGES
        for name in SHAPES
    ]
    record["verdicts"] += [
        verdict(
            f"{model} average: points that the bound covers",
            100 * float(np.mean(hits)),
            99,
            " %",
            least=True,
        )
        for model, hits in covered.items()
    ]
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "--:|" * len(COLUMNS)]
    lines += ["| " + " | ".join(_cell(value) for value in row) + " |" for row in rows]
    (RESULTS / "validity_map.md").write_text("\n".join(lines) + "\n", encoding="utf-8")
    save("validity_map", record, draw(clouds))
    shutil.copy(RESULTS / "validity_map.png", RESULTS.parents[1] / "docs" / "figures")


def farthest(rows: list[tuple], shape: str, model: str) -> float:
    """The largest deviation of a model under a shape, over all spectra, contrasts and
    speeds [%].
    """
    return max(
        abs(row[4 + list(MODELS).index(model)]) for row in rows if row[0] == shape
    )


def _cell(value: Any) -> str:
    if not isinstance(value, (float, np.floating)):
        return str(value)
    return f"{value:g}" if value == round(value) else f"{value:.1f}"


def draw(clouds: dict[Any, dict[str, np.ndarray]]) -> Any:
    figure, axes = plt.subplots(
        2, 3, figsize=(11, 6.4), layout="constrained", sharey="col", sharex=True
    )
    for row, model in zip(axes, AVERAGES, strict=True):
        for ax, name in zip(row, SHAPES, strict=True):
            for i, decades in enumerate(DECADES):
                for contrast, mark in zip(CONTRASTS, MARKS, strict=True):
                    found = clouds[name, decades, contrast]
                    ax.semilogx(
                        found["velocity"],
                        100 * found[model],
                        f"C{i}{mark}-",
                        ms=4,
                        lw=0.8,
                    )
            ax.axhspan(-3, 3, color="0.93", zorder=0)
            ax.axhline(0, color="0.5", lw=0.6)
            ax.grid(color="0.9")
            ax.set_title(f"{name}, {TITLES[model]}", fontsize=10)
        row[0].set_ylabel("off the half-space by [%]")
    for ax in axes[1]:
        ax.set_xlabel("velocity [m/s]")
    handles = [
        plt.Line2D([], [], color=f"C{i}", label=f"{d} decades" if d else "one branch")
        for i, d in enumerate(DECADES)
    ]
    handles += [
        plt.Line2D(
            [], [], color="0.3", marker=mark, ls="", label=f"E_0/E_inf = {contrast:g}"
        )
        for contrast, mark in zip(CONTRASTS, MARKS, strict=True)
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    return figure


if __name__ == "__main__":
    main()
