"""Random scenes on rough surfaces: each converges to what an independent march finds, or says that it did not.

    python benchmarks/robustness/rough_scenes.py [SCENES]

Surfaces, loads, speeds over 14 decades, 1 to 30 branches over 14 decades of time, contrasts up to 1e4. The judge,
`rough_march.py`, knows nothing of the solver: it marches one element from one event to the next, with no error but that
of a line that is straight between its samples. Every scene is taken on four times and more as many samples as
`em.line_contact` takes, until that error is a tenth of the error that is stated. Then

- mu of `em.friction`, which skips and chooses its own samples, and of `em.line_contact` on each number of samples must
  agree with the march within the stated error;
- the state that `em.line_contact` finds must come back after one exact period under the load asked for, the rubber must
  not lie below the line, and what the load's work puts in the branches must dissipate. The solver's contact begins and
  ends within a step to second order, so that all three are off by as much, and four times the samples must shrink it.
"""

import itertools
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, save, table, verdict
from rough_march import Periodic, branch_forces, periodic

import elastomdr as em

warnings.simplefilter("ignore", em.ConvergenceWarning)
warnings.simplefilter("ignore", em.ModelWarning)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
_MOST = 2**19  # samples
_KNOWN = 0.1  # of the stated error: what the truth is known to
_BREACH = 1e-3  # of the conditions of contact, to be reached on the most samples
_ROUNDED = 1e-8  # breaches below this are not asked to shrink


class Level(NamedTuple):
    """A scene on some number of samples."""

    line: em.LineContact
    true: Periodic
    breach: float  # of the conditions of contact, over the load or the depth
    away: float  # of the rubber's surface from the true one, over the depth
    waste: float  # work less dissipation, over the work


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


def dissipated(law: em.Foundation, velocity: float, line: em.LineContact) -> float:
    """mu of a rubber surface that is straight between samples: what its branches turn into heat."""
    u = line.surface[::-1]  # in the order in which an element of the rubber meets the line, which moves to +x
    h = float(line.x[1]) / velocity
    du = np.roll(u, -1) - u  # over the step from i to i + 1
    moduli, times, heat = np.asarray(law.moduli), np.asarray(law.times), 0.0
    for modulus, tau, f in zip(moduli, times, branch_forces(moduli, times, u, h), strict=True):
        z = h / tau
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
    return float(heat / (line.load * u.size * float(line.x[1])))


def level(law: em.Foundation, surface: em.SelfAffine, scene: dict, samples: int | None) -> Level | None:
    """A scene on so many samples, beside the truth; None where the solver says that it did not converge."""
    line = em.line_contact(law, surface, model=em.Line(samples=samples), **scene)
    if not line.converged.all():
        return None
    true = periodic(law, line, scene["velocity"])
    below = (line.height - line.surface).max() / line.depth
    force = abs(line.force.mean() / line.load - 1)
    away = np.abs(line.surface - true.surface).max() / true.depth
    waste = abs(dissipated(law, scene["velocity"], line) / line.mu - 1)
    return Level(line, true, float(max(true.start, below, force)), float(away), float(waste))


def known(levels: list[Level | None]) -> float:
    """What the truth of the last level is known to: a third of its last change, as for an error of first order."""
    if len(levels) < 2 or levels[-1] is None or levels[-2] is None or levels[-1].true.misfit > 1e-6:
        return np.inf
    return abs(levels[-1].true.mu - levels[-2].true.mu) / 3


def main(scenes: int) -> None:
    record = heading("Random scenes on rough surfaces", f"{scenes} scenes, seeded")
    rng = np.random.default_rng(11)
    rows, flagged, unknown, outside, wrong = [], 0, 0, 0, 0
    lines, lines_outside, last, falls, wasted = 0, 0, [], [], []
    for number in range(scenes):
        law, surface, scene = drawn(rng)
        curve = em.friction(law, surface, model=em.Line(), rtol=1e-6, **scene)
        first = em.line_contact(law, surface, **scene)
        if not (curve.converged.all() and first.converged.all()):
            flagged += 1
            rows.append((number, law.moduli.size, first.x.size, bool(first.converged.all()), bool(curve.converged)))
            continue
        mu, error, samples = float(curve.mu), float(curve.lines.numerical), first.x.size
        levels = [level(law, surface, scene, samples)]
        while not good_enough(levels, error) and samples * 4 <= _MOST:
            samples *= 4
            levels.append(level(law, surface, scene, samples))
        if levels[-1] is None or not known(levels) <= _KNOWN * error:
            unknown += 1
            rows.append((number, law.moduli.size, samples, "truth not known"))
            continue
        truth, sure = levels[-1].true.mu, known(levels)
        away = abs(mu - truth)
        outside += away > error + sure
        wrong += away > 3 * error + sure
        if away > error + sure:
            rows.append((number, law.moduli.size, first.x.size, away / mu, error / mu))
        for each in filter(None, levels):
            stated = float(each.line.error[0])
            if sure <= _KNOWN * stated:
                lines += 1
                lines_outside += abs(each.line.mu - truth) > stated + sure
        last.append(levels[-1])
        for one, four in itertools.pairwise(levels):
            if one is not None and four is not None and one.true.misfit < 1e-6 and one.breach > _ROUNDED:
                falls.append(one.breach / four.breach)
                wasted.append(one.waste / four.waste)
    if rows:
        record["noted"] = [list(map(str, row)) for row in rows]
        for row in rows:
            print("  noted:", row)
    breaches, away, waste = ([getattr(one, name) for one in last] for name in ("breach", "away", "waste"))
    record["share"] = table(
        ("scenes", "flagged", "breach of contact, median", "largest", "surface off, largest", "work less heat, median",
         "largest"),
        [(scenes, flagged, float(np.median(breaches)), max(breaches), max(away), float(np.median(waste)), max(waste))],
    )  # fmt: skip
    record["verdicts"] = [
        verdict("wrong and not flagged (mu off by over three stated errors)", wrong, 0),
        verdict(
            f"a condition of contact broken by over {_BREACH:g} of the mean load on the most samples, scenes",
            sum(breach > _BREACH for breach in breaches),
            0,
        ),
        verdict("mu outside its stated error", outside, 0.01 * scenes),
        verdict(f"the same of em.line_contact, on {lines} numbers of samples", lines_outside, 0.01 * lines),
        verdict("scenes whose truth is not known to a tenth of the stated error", unknown, 0.01 * scenes),
        verdict("fall of the breach on four times the samples, median", float(np.median(falls)), 12, least=True),
        verdict("the same, the least", min(falls), 3, least=True),
        verdict("fall of work less dissipation, median", float(np.median(wasted)), 6, least=True),
        verdict("work less dissipation on the most samples, over the work, the largest", max(waste), 0.03),
        verdict("flagged, share of scenes", flagged / scenes, 0.05),
    ]
    save("robustness/rough_scenes", record)


def good_enough(levels: list[Level | None], error: float) -> bool:
    """Whether the truth is known beside the stated error, on samples on which contact is as it should be."""
    return known(levels) <= _KNOWN * error and levels[-1] is not None and levels[-1].breach <= _BREACH


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
