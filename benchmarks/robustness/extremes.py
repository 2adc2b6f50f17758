"""Does it hold at the ends? 20 decades of velocity, 40 branches over 24 decades,
against Hertz and power laws.

    python benchmarks/robustness/extremes.py

With tau over 24 decades, velocities from 1e-12 to 1e8 m/s do not reach both the relaxed
and the glassy end. So three spectra: one that is relaxed at 1e-12 m/s (by 12 decades),
one that is glassy at 1e8 m/s (by 11), and one in the middle, whose ends lie beyond that
range. References: Hertz, F_N = (4/3) E a d with E = E_inf or E_0, and

    v -> 0:
    mu = 2 v sum(E_k tau_k) / (E_inf R) on the line, half of that averaged over directions;
    v -> inf:  mu = (4/5) d sum(E_k / tau_k) / (E_0 v) for both, d being Hertz' glassy depth.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, plt, save, table, verdict

import elastomdr as em

EQUILIBRIUM, RADIUS, LOAD, RTOL = 4e6, 0.01, 10.0, 1e-10  # [Pa], [m], [N]
VELOCITY = np.geomspace(1e-12, 1e8, 81)  # [m/s]
SHAPE = em.Paraboloid(RADIUS)
SPECTRA = {  # shortest and longest tau [s], velocities beyond the range [m/s]
    "fast": (1e-27, 1e-3, ()),
    "middle": (1e-12, 1e12, (1e-27, 1e24)),
    "slow": (1e-1, 1e23, ()),
}
# the spectra that reach an end within the range
ENDS = {"relaxed": "fast", "glassy": "slow"}
COLUMNS = (
    "spectrum",
    "average",
    "end",
    "v [m/s]",
    "passage/nearest tau",
    "mu",
    "F_N/Hertz - 1",
    "mu/power law - 1",
    "slope",
)


def foundation(shortest: float, longest: float) -> em.Foundation:
    times = np.geomspace(shortest, longest, 40)
    return em.Foundation(EQUILIBRIUM, EQUILIBRIUM * (times / longest) ** -0.12, times)


def _name(model: Any) -> str:
    return "none" if isinstance(model, em.Line) else "direction"


def at_end(name: str, end: str, model: Any, velocity: float) -> tuple:
    """One row: load and friction at one end of one spectrum against their limits; the
    slope is d log mu / d log v.
    """
    shortest, longest, _ = SPECTRA[name]
    law = foundation(shortest, longest)
    relaxed = end == "relaxed"
    modulus = EQUILIBRIUM if relaxed else EQUILIBRIUM + law.moduli.sum()
    size = (0.75 * RADIUS * LOAD / modulus) ** (1 / 3)
    depth = size**2 / RADIUS
    if relaxed:
        limit = (
            2
            * velocity
            * (law.moduli * law.times).sum()
            / (EQUILIBRIUM * RADIUS)
            / (1 if isinstance(model, em.Line) else 2)
        )
    else:
        limit = 0.8 * depth * (law.moduli / law.times).sum() / (modulus * velocity)
    near = np.array([velocity, 2 * velocity])
    loaded = em.friction(law, SHAPE, velocity=near, load=LOAD, model=model, rtol=RTOL)
    pressed = em.friction(
        law, SHAPE, velocity=velocity, depth=depth, model=model, rtol=RTOL
    )
    passage = 2 * size / velocity
    apart = passage / longest if relaxed else shortest / passage
    return (
        name,
        _name(model),
        end,
        velocity,
        apart if relaxed else 1 / apart,
        loaded.mu[0],
        float(pressed.normal_force) / (4 / 3 * modulus * size * depth) - 1,
        loaded.mu[0] / limit - 1,
        np.log2(loaded.mu[1] / loaded.mu[0]),
    )


def main() -> None:
    record = heading(
        "Extremes: 81 velocities from 1e-12 to 1e8 m/s, 40 branches over 24 decades",
        (
            f"paraboloid, R = {RADIUS:g} m, {LOAD:g} N or the depth of Hertz' contact "
            f"under it, rtol {RTOL:g}"
        ),
        f"E_inf = {EQUILIBRIUM:g} Pa, E_k = E_inf (tau_k/tau_40)^-0.12, tau: "
        + "; ".join(
            f"{name} {low:g} ... {high:g} s" for name, (low, high, _) in SPECTRA.items()
        ),
    )
    figure, ax = plt.subplots(figsize=(8, 4.5), layout="constrained")
    rows, curves, missing = [], [], 0
    for i, (name, (shortest, longest, beyond)) in enumerate(SPECTRA.items()):
        for model, style in ((em.Line(), ":"), (em.Averaged(corrected=False), "-")):
            law = foundation(shortest, longest)
            curve = em.friction(
                law, SHAPE, velocity=VELOCITY, load=LOAD, model=model, rtol=1e-8
            )
            failed = int(np.sum(~np.isfinite(curve.mu) | ~curve.converged))
            missing += failed
            curves.append((name, _name(model), failed, curve.mu.min(), curve.mu.max()))
            label = (
                f"{name}: tau {shortest:g} ... {longest:g} s"
                if isinstance(model, em.Averaged)
                else None
            )
            ax.loglog(VELOCITY, curve.mu, style, color=f"C{i}", label=label)
            for end, velocity in zip(
                ENDS, beyond or (VELOCITY[0], VELOCITY[-1]), strict=True
            ):
                if beyond or ENDS[end] == name:
                    rows.append(at_end(name, end, model, velocity))
    record["curves"] = table(
        ("spectrum", "average", "NaN or not converged", "least mu", "largest mu"),
        curves,
    )
    record["ends"] = table(COLUMNS, rows)
    print()
    record["figures"] = [
        verdict("points that are NaN or did not converge", missing, 0),
        verdict("largest deviation from Hertz", max(abs(row[6]) for row in rows), 1e-9),
        verdict(
            "largest deviation from the power laws of friction",
            max(abs(row[7]) for row in rows),
            1e-9,
        ),
        verdict(
            "largest deviation of the exponent from +1 or -1",
            max(abs(abs(row[8]) - 1) for row in rows),
            1e-9,
        ),
    ]
    ax.set(
        xlabel="velocity [m/s]",
        ylabel="mu",
        title="Solid: averaged over directions; dotted: bare line",
    )
    ax.grid(color="0.92")
    ax.legend()
    save("robustness/extremes", record, figure)


if __name__ == "__main__":
    main()
