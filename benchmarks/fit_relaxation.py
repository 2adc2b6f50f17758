"""What relaxation says of the loss modulus, and of friction: intervals and deviations within the range called known.

    python benchmarks/fit_relaxation.py [--sets 8]

Relaxation moduli of five rubbers, 24 instants from 0.01 to 1000 s at eight temperatures from -10 to 60 degC, with
noise, are fitted as `elastomdr fit` does. Within the range that the material then carries, the loss modulus is compared
with its 95 % interval, and the friction of a sphere of 5 mm at 0, 20 and 40 degC with that of the rubber itself. The
peak of "peak, not seen" relaxes before the first instant of the coldest isotherm. A fit knows friction no better than
the loss modulus: where data are noisy its interval is wider than the 2 % that are asked.
"""

import argparse
import warnings
from typing import Any

import numpy as np
from common import heading, one_core, save, table, verdict

import elastomdr as em

LAW = em.WLF(5.8, 125.0, 293.15)
KELVIN = np.arange(-10.0, 61.0, 10.0) + 273.15
TIME = np.geomspace(0.01, 1e3, 24)  # [s]
LINES = np.geomspace(1e-9, 1.0, 10)  # relaxation times [s]
SCENE = {"velocity": np.geomspace(1e-4, 0.5, 12), "load": 1.0, "average": None, "rtol": 1e-4,
         "temperature": np.array([[273.15], [293.15], [313.15]])}  # fmt: skip


def rubber(fast: float, slow: float, peak: float | None = None) -> em.Prony:
    """Ten branches whose moduli [Pa] fall from `fast` to `slow`, nine times higher about log10 tau = `peak`."""
    moduli = np.geomspace(fast, slow, LINES.size)
    if peak is not None:
        moduli = moduli * (1 + 8 * np.exp(-(((np.log10(LINES) - peak) / 0.7) ** 2) / 2))
    return em.Prony(6e5, moduli, LINES, shift=LAW)


RUBBERS = {
    "rubber": rubber(6e7, 2e5),
    "steep": rubber(6e8, 1e5),
    "very steep": rubber(6e9, 5e4),
    "peak": rubber(6e7, 2e5, -3.0),
    "peak, not seen": rubber(6e7, 2e5, -5.0),
}


def trial(body: em.Prony, mu: np.ndarray, noise: float, seed: int) -> dict[str, Any]:
    rng, parts = np.random.default_rng(seed), []
    for kelvin in KELVIN:
        moduli = np.asarray(body.at(kelvin).relaxation(TIME)) * (1 + noise * rng.normal(size=TIME.size))
        parts.append(em.fit.relaxation(TIME, moduli, kelvin, kind="shear"))
    fit = em.fit.material(em.fit.join(*parts), LAW.reference)
    limits = fit.material.range.frequency
    band = fit.prony.band(np.geomspace(*limits, 25))
    loss = np.asarray(body.at(LAW.reference).complex_modulus(band.omega)).imag
    again = em.friction(fit.material, em.Paraboloid(5e-3), **SCENE)
    inside = ~np.asarray(again.extrapolated)
    return {
        "held": (band.loss_low <= loss) & (loss <= band.loss_high),
        "half": np.log(band.loss_high / band.loss).max(),
        "loss": np.abs(band.loss / loss - 1),
        "friction": np.abs(np.asarray(again.mu) / mu - 1)[inside],
        "decades": np.log10(limits[1] / limits[0]),
    }


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=8)
    count = parser.parse_args().sets
    one_core()
    record = heading("Friction from relaxation", f"{count} sets of each rubber and noise; within the known range")
    for category in (em.fit.FitWarning, em.ExtrapolationWarning):
        warnings.simplefilter("ignore", category)
    rows, held = [], []
    for name, body in RUBBERS.items():
        mu = np.asarray(em.friction(body, em.Paraboloid(5e-3), **SCENE).mu)
        for noise in (0.001, 0.003, 0.01):
            trials = [trial(body, mu, noise, seed) for seed in range(count)]
            hits, loss, friction = (np.concatenate([t[key] for t in trials]) for key in ("held", "loss", "friction"))
            held.append(hits)
            rows.append((
                name, 100 * noise, float(np.mean([t["decades"] for t in trials])), friction.size / count,
                100 * hits.mean(), 100 * float(np.mean([t["half"] for t in trials])), 100 * loss.max(),
                100 * friction.max(), 100 * np.sqrt((friction**2).mean()),
            ))  # fmt: skip
    columns = ("rubber", "noise [%]", "range [decades]", "points of 36 within", "loss held [%]",
               "stated, widest [%]", "loss, worst [%]", "friction, worst [%]", "friction, rms [%]")  # fmt: skip
    record["rows"] = table(columns, rows)
    print()
    record["verdicts"] = [
        verdict("loss modulus held by its 95 % interval", 100 * np.concatenate(held).mean(), 90.0, " %", least=True),
        verdict("friction off by more than stated", sum(row[7] > row[5] for row in rows), 0),
        *(verdict(f"{row[0]}, noise {row[1]:g} %: friction", row[7], 2.0, " %") for row in rows if row[1] < 0.5),
    ]
    save("fit_relaxation", record)


if __name__ == "__main__":
    main()
