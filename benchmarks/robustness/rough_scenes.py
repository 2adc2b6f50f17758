"""Random scenes on rough surfaces: each converges to what an independent check accepts, or says that it did not.

    python benchmarks/robustness/rough_scenes.py [SCENES]

Surfaces, loads, speeds over 14 decades, 1 to 30 branches over 14 decades of time, contrasts up to 1e4. The check knows
nothing of the solver: from the motion u of the rubber that `em.line_contact` returns it computes the force of every
branch by the closed form of a periodic motion, and asks whether there is a gap where there is no force and a push where
there is contact, whether the mean force is the load, and whether mu is what the branches dissipate. `em.friction`,
which skips, must agree with that mu within its `error`.
"""

import sys
import warnings
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, save, table, verdict

import elastomdr as em

warnings.simplefilter("ignore", em.ConvergenceWarning)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
_SMALL = 1e-4  # mu below which rounding of the load shows in the work


def drawn(rng: np.random.Generator) -> tuple[em.Foundation, em.SelfAffine, dict]:
    """Rubber, surface, velocity and pressure."""
    count = int(rng.integers(1, 31))
    times = np.sort(10 ** rng.uniform(-10, 4, count))
    soft = 10 ** rng.uniform(4, 8)
    moduli = soft * 10 ** rng.uniform(-3, rng.uniform(-1, 4), count)
    low = 10 ** rng.uniform(2, 6)
    slope = 10 ** rng.uniform(-3, 0)
    surface = em.SelfAffine(rng.uniform(0.2, 1.0), rms_slope=slope, q_low=low, q_high=low * 10 ** rng.uniform(0.5, 2.3))
    pressure = soft * slope * 10 ** rng.uniform(-3, 1)
    velocity = 10 ** rng.uniform(-10, 4) / low
    return em.Foundation(soft, moduli, times), surface, {"velocity": velocity, "pressure": pressure}


def checked(law: em.Foundation, velocity: float, found: em.LineContact) -> tuple[float, float]:
    """Largest breach of the conditions of contact and of the load, over the mean load; mu by dissipation."""
    u = found.surface[::-1]  # in the order in which an element of the rubber meets the line, which moves to +x
    h = float(found.x[1]) / velocity
    du = np.roll(u, -1) - u  # over the step from i to i + 1
    q, heat = float(law.equilibrium) * u, 0.0
    for modulus, tau in zip(law.moduli, law.times, strict=True):
        z = h / tau
        keep, gain = np.exp(-z), -np.expm1(-z) / z
        # f_{i+1} = keep f_i + E gain du_i, periodic: by the transform of the recurrence
        turn = np.exp(2j * np.pi * np.fft.rfftfreq(u.size))
        divisor = turn - keep
        divisor[0] = -np.expm1(-z)
        f = np.fft.irfft(modulus * gain * np.fft.rfft(du) / divisor, u.size)
        q = q + f
        settled = modulus * tau * du / h
        rest = f - settled
        if z > 0.1:
            once, twice = -np.expm1(-z), -np.expm1(-2 * z)
            lost = settled**2 * h + 2 * settled * rest * tau * once + rest**2 * tau / 2 * twice
        else:  # the three would cancel: Gauss' rule over the step, to 1e-10
            at = 0.5 * (1 + NODES)[:, None]
            force = f * np.exp(-z * at) + modulus * du * -np.expm1(-z * at) / z
            lost = h * 0.5 * WEIGHTS @ force**2
        heat += lost.sum() / (modulus * tau)
    load, touching = found.load, found.touching[::-1]
    breach = max(
        np.abs(q[~touching]).max(initial=0.0), -q[touching].min(initial=0.0), abs(q.mean() - load),
        float(law.equilibrium) * (found.height - found.surface).max(),
    ) / load  # fmt: skip
    return float(breach), float(heat / (load * u.size * float(found.x[1])))


def main(scenes: int) -> None:
    record = heading("Random scenes on rough surfaces", f"{scenes} scenes, seeded")
    rng = np.random.default_rng(11)
    rows, silent, flagged, breaches, gaps, outside = [], 0, 0, [], [], 0
    for number in range(scenes):
        law, surface, scene = drawn(rng)
        line = em.line_contact(law, surface, **scene)
        curve = em.friction(law, surface, model=em.Line(), rtol=1e-6, **scene)
        if not (line.converged.all() and curve.converged.all()):
            flagged += 1
            rows.append((number, law.moduli.size, line.x.size, bool(line.converged.all()), bool(curve.converged)))
            continue
        breach, mu = checked(law, scene["velocity"], line)
        breaches.append(breach)
        gap = abs(float(curve.mu) - mu)
        error = float(curve.error if curve.lines.numerical is None else curve.lines.numerical)
        gaps.append(abs(line.mu - mu) / max(mu, _SMALL))
        outside += bool(gap > error + 1e-7 * mu)
        silent += bool(breach > 1e-5)
        if breach > 1e-5 or gap > error + 1e-7 * mu:
            rows.append(
                (
                    number,
                    law.moduli.size,
                    line.x.size,
                    breach,
                    gap / mu,
                    error / mu,
                )
            )
    if rows:
        record["noted"] = [list(map(float, row)) for row in rows]
        for row in rows:
            print("  noted:", row)
    record["share"] = table(
        ("scenes", "flagged", "breach of contact, median", "largest", "work against dissipation, median", "largest"),
        [(scenes, flagged, float(np.median(breaches)), max(breaches), float(np.median(gaps)), max(gaps))],
    )
    record["verdicts"] = [
        verdict("wrong and not flagged (a condition of contact broken by over 1e-5 of the mean load)", silent, 0),
        verdict("mu outside its stated error", outside, 0.01 * scenes),
        verdict(
            f"energy put in less energy dissipated, over that or {_SMALL:g} of load times way, the largest",
            max(gaps),
            1e-6,
        ),
        verdict("flagged, share of scenes", flagged / scenes, 0.05),
    ]
    save("robustness/rough_scenes", record)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
