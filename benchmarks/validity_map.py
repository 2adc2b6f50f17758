"""How far are the direction average and the bare line from the half-space, over speed, spectrum and shape?

    python benchmarks/validity_map.py

The truth is `em.reference.half_space_sliding`: three dimensions, the same spectrum, 64 by 64 cells, its own error
beside each number. Spectra: one branch, and branches of equal modulus a decade apart over 3 and 9 decades; the glassy
modulus is 2 to 1000 times the relaxed one. Speeds: five, around the peak of the line's friction and two decades to
either side. Writes the table of the documentation, results/validity_map.md.
"""

import sys
import warnings

import numpy as np
from common import RESULTS, heading, plt, save, table

import elastomdr as em

EQUILIBRIUM, TIME, LOAD = 4e6, 1e-3, 10.0  # E_inf [Pa] (as E*), the longest relaxation time [s], F_N [N]
SHAPES = {"paraboloid": em.Paraboloid(0.01), "cone": em.Cone(0.15), "r^4": em.PowerLaw(4, 5e5)}
DECADES = (0, 3, 9)
CONTRASTS = (2.0, 10.0, 100.0, 1000.0)
TRUSTED = 0.02  # relative error of the reference above which a point says nothing
COLUMNS = (
    "shape", "decades of spectrum", "E_0/E_inf", "points", "average off by, worst [%]", "at v/v_peak",
    "reference's own error there [%]", "average off by, rms [%]", "line off by, worst [%]",
)  # fmt: skip


def law(decades: int, contrast: float) -> em.Foundation:
    count = decades + 1
    moduli = np.full(count, (contrast - 1) * EQUILIBRIUM / count)
    return em.Foundation(EQUILIBRIUM, moduli, TIME * 10.0 ** np.arange(-decades, 1.0))


def compare(shape: em.Paraboloid, material: em.Foundation) -> tuple[np.ndarray, ...]:
    """Speeds over the peak's, deviations of average and line, and the reference's relative error, where it has one."""
    sweep = np.geomspace(1e-4, 1e10, 113)
    line = em.friction(material, shape, velocity=sweep, load=LOAD, average=None, rtol=1e-4)
    peak = sweep[np.nanargmax(line.mu)]
    velocity = peak * np.array([1e-2, 1e-1, 1.0, 10.0, 100.0])
    scene = {"velocity": velocity, "load": LOAD}
    truth = em.reference.half_space_sliding(material, shape, **scene)
    own = truth.error / truth.mu
    known = truth.converged & (own < TRUSTED)
    average = em.friction(material, shape, rtol=1e-4, **scene).mu / truth.mu - 1
    bare = em.friction(material, shape, rtol=1e-4, average=None, **scene).mu / truth.mu - 1
    return (velocity / peak)[known], average[known], bare[known], own[known]


def main() -> None:
    warnings.simplefilter("ignore", em.ConvergenceWarning)  # points without an answer are counted in the table
    record = heading(
        "Validity map: direction average and bare line against the half-space in three dimensions",
        f"E_inf = {EQUILIBRIUM:g} Pa (E*), longest relaxation time {TIME:g} s, load {LOAD:g} N",
        f"points whose reference is off by more than {100 * TRUSTED:g} % are left out",
    )
    rows, clouds = [], {}
    for name, shape in SHAPES.items():
        for decades in DECADES:
            for contrast in CONTRASTS:
                print(f"  {name}, {decades} decades, {contrast:g}", end="\r", file=sys.stderr)
                speed, average, bare, own = compare(shape, law(decades, contrast))
                worst = int(np.abs(average).argmax())
                off = 100 * average[worst], speed[worst], 100 * own[worst]
                spread = 100 * np.sqrt(np.mean(average**2)), 100 * bare[np.abs(bare).argmax()]
                rows.append((name, decades, contrast, f"{speed.size} of 5", *off, *spread))
                clouds[name, decades, contrast] = speed, average
    record["table"] = table(COLUMNS, rows)
    lines = ["| " + " | ".join(COLUMNS) + " |", "|" + "--:|" * len(COLUMNS)]
    lines += ["| " + " | ".join(f"{v:.3g}" if isinstance(v, float) else str(v) for v in row) + " |" for row in rows]
    RESULTS.mkdir(exist_ok=True)
    (RESULTS / "validity_map.md").write_text("\n".join(lines) + "\n", encoding="utf-8")

    figure, axes = plt.subplots(1, 3, figsize=(11, 3.9), layout="constrained", sharey=True)
    for ax, name in zip(axes, SHAPES, strict=True):
        for i, decades in enumerate(DECADES):
            for contrast, style in zip(CONTRASTS, ("o", "s", "^", "D"), strict=True):
                speed, average = clouds[name, decades, contrast]
                ax.semilogx(speed, 100 * average, f"C{i}{style}-", ms=4, lw=0.8)
        ax.set(title=name, xlabel="velocity over that of the line's peak [-]")
        ax.axhspan(-5, 5, color="0.93", zorder=0)
        ax.grid(color="0.88")
    axes[0].set_ylabel("direction average, off by [%]")
    handles = [
        plt.Line2D([], [], color=f"C{i}", label=f"{d} decades" if d else "one branch") for i, d in enumerate(DECADES)
    ]
    handles += [
        plt.Line2D([], [], color="0.3", marker=m, ls="", label=f"E_0/E_inf = {c:g}")
        for c, m in zip(CONTRASTS, ("o", "s", "^", "D"), strict=True)
    ]
    figure.legend(handles=handles, loc="outside right center", frameon=False)
    save("validity_map", record, figure)


if __name__ == "__main__":
    main()
