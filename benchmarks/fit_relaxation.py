"""What relaxation says of the loss modulus, and of friction: intervals and deviations
within the range called known.

    python benchmarks/fit_relaxation.py [--sets 8]

Relaxation moduli of five rubbers and three of the library, 24 instants from 0.01 to
1000 s at eight temperatures from -10 to 60 degC, and of two with a spectrum that hardly
falls, 20 instants from 0.5 to 1000 s at five temperatures from 0 to 40 degC, with
noise, are fitted as `elastomdr fit` does. Within the range that the material then
carries, the loss modulus is compared with its 95 % interval, and the friction of a
sphere of 5 mm at 0, 20 and 40 degC with that of the rubber itself; the interval also at
all frequencies up to 0.1/t where it is narrower than +- 50 %, range or not. The peak of
"peak, not seen" relaxes before the first instant of the coldest isotherm; the rubbers
of the library relax by little above a plateau within the window, and are known so badly
that the range may be empty. A fit knows friction no better than the loss modulus: where
data are noisy its interval is wider than the 2 % that are asked.
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
SCENE = {
    "velocity": np.geomspace(1e-4, 0.5, 12),
    "load": 1.0,
    "model": em.Line(),
    "rtol": 1e-4,
    "temperature": np.array([[273.15], [293.15], [313.15]]),
}


def rubber(fast: float, slow: float, peak: float | None = None) -> em.Prony:
    """Ten branches whose moduli [Pa] fall from `fast` to `slow`, nine times higher
    about log10 tau = `peak`.
    """
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
    **{
        name: em.load_material(name)
        for name in ("sbr-gum-like", "natural-rubber-like", "silicone-like")
    },
}
# relaxation times [s]; their moduli are 97 small steps of a power law
WIDE = np.logspace(-11, 5, 97)
SHORT = {
    "filled, short data": em.Prony(3e6, 1e5 * (WIDE / 1e-3) ** -0.12, WIDE, shift=LAW),
    "silicone, short data": em.Prony(3e5, 6e3 * (WIDE / 1e-3) ** -0.1, WIDE, shift=LAW),
}
STATED = 1.5  # upper limit over value up to which an interval counts as one


def trial(
    body: em.Prony, mu: np.ndarray, noise: float, seed: int, short: bool
) -> dict[str, Any]:
    rng, parts = np.random.default_rng(seed), []
    time = np.geomspace(0.5, 1e3, 20) if short else TIME
    for kelvin in KELVIN[1:6] if short else KELVIN:
        moduli = np.asarray(body.at(kelvin).relaxation(time)) * (
            1 + noise * rng.normal(size=time.size)
        )
        parts.append(em.fit.relaxation(time, moduli, kelvin, kind="shear"))
    fit = em.fit.material(em.fit.join(*parts), LAW.reference)
    limits = fit.material.range.omega
    low, high = fit.prony.window
    held, half, _ = compared(body, fit, np.geomspace(low, 0.1 * high, 40))
    found = {
        "anywhere": held[half < np.log(STATED)],
        "empty": not limits,
        "decades": 0.0,
        "half": np.zeros(0),
    }
    found |= dict.fromkeys(("held", "loss", "friction"), np.zeros(0))
    again = em.friction(fit.material, em.Paraboloid(5e-3), **SCENE)
    inside = ~np.asarray(again.extrapolated)
    if not limits:
        return found | {"more": inside.any()}
    held, half, loss = compared(body, fit, np.geomspace(*limits, 25))
    friction = np.abs(np.asarray(again.mu) / mu - 1)[inside]
    within = {
        "held": held,
        "half": half.max(keepdims=True),
        "loss": loss,
        "friction": friction,
    }
    return (
        found
        | within
        | {
            "decades": np.log10(limits[1] / limits[0]),
            "more": friction.max(initial=0.0) > half.max(),
        }
    )


def compared(
    body: em.Prony, fit: em.fit.MaterialFit, omega: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Whether the loss modulus is held by its interval, half of that (of its
    logarithm), and its relative error.
    """
    band = fit.prony.band(omega)
    loss = np.asarray(body.at(LAW.reference).complex_modulus(band.omega)).imag
    held = (band.loss_low <= loss) & (loss <= band.loss_high)
    return held, np.log(band.loss_high / band.loss), np.abs(band.loss / loss - 1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sets", type=int, default=8)
    count = parser.parse_args().sets
    one_core()
    record = heading(
        "Friction from relaxation",
        f"{count} sets of each rubber and noise; within the known range",
    )
    for category in (em.fit.FitWarning, em.ExtrapolationWarning):
        warnings.simplefilter("ignore", category)
    rows, more, ranges = [], 0, 0
    for name, body in (RUBBERS | SHORT).items():
        mu = np.asarray(em.friction(body, em.Paraboloid(5e-3), **SCENE).mu)
        for noise in (0.001, 0.003, 0.01):
            trials = [
                trial(body, mu, noise, seed, name in SHORT) for seed in range(count)
            ]
            keys = ("held", "anywhere", "half", "loss", "friction")
            held, anywhere, half, loss, friction = (
                np.concatenate([t[key] for t in trials]) for key in keys
            )
            more += sum(bool(t["more"]) for t in trials)
            ranges += sum(not t["empty"] for t in trials)
            rms = float(np.sqrt(np.mean(friction**2))) if friction.size else 0.0
            rows.append(
                (
                    name,
                    100 * noise,
                    sum(not t["empty"] for t in trials),
                    float(np.mean([t["decades"] for t in trials])),
                    friction.size / count,
                    100 * held.mean() if held.size else None,
                    100 * anywhere.mean(),
                    *(
                        (100 * half.mean(), 100 * loss.max())
                        if half.size
                        else (None, None)
                    ),
                    *(
                        (100 * friction.max(), 100 * rms)
                        if friction.size
                        else (None, None)
                    ),
                )
            )
    columns = (
        "rubber",
        "noise [%]",
        "sets with a range",
        "range [decades]",
        "points of 36 within",
        "loss held [%]",
        "held to 50 % [%]",
        "stated, widest [%]",
        "loss, worst [%]",
        "friction, worst [%]",
        "friction, rms [%]",
    )
    record["rows"] = table(columns, rows)
    print()
    within, anywhere = (
        [row[5] for row in rows if row[5] is not None],
        [row[6] for row in rows],
    )
    record["verdicts"] = [
        verdict(
            "within the range, held by its 95 % interval, least of any",
            min(within),
            90.0,
            " %",
            least=True,
        ),
        verdict(
            "where stated to 50 %, held by its 95 % interval, least of any",
            min(anywhere),
            90.0,
            " %",
            least=True,
        ),
        verdict("where stated to 50 %, most of any", max(anywhere), 99.0, " %"),
        verdict(
            (
                "friction off by more than the widest 95 % interval stated, of "
                f"{ranges} sets"
            ),
            100 * more / ranges,
            5.0,
            " %",
        ),
        *(
            verdict(f"{row[0]}, noise {row[1]:g} %: friction", row[9], 2.0, " %")
            for row in rows
            if row[1] < 0.5 and row[9] is not None
        ),
    ]
    save("fit_relaxation", record)


if __name__ == "__main__":
    main()
