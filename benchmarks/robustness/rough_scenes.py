"""Random scenes on rough surfaces: each converges to what an independent march finds,
or says that it did not.

    python benchmarks/robustness/rough_scenes.py [SCENES]

Surfaces, loads, speeds over 14 decades, 1 to 30 branches over 14 decades of time,
contrasts up to 1e4; a quarter as many with 15 to 40 branches over 15 to 24 decades, and
a tenth as many such on lines of 65,536 samples. The judge, `rough_march.py`, knows
nothing of the solver: it marches one element from one event to the next, with no error
but that of a line that is straight between its samples. Every scene is taken on four
times and more as many samples as `line_field` takes, until that error is a tenth
of the error that is stated. Then

- mu of `em.friction`, which chooses its own samples, and of `line_field`
  on each number of samples must agree with the march within the stated error;
- the state that `line_field` finds must come back after one exact period under the
  load asked for, the rubber must not lie below the line, and what the load's work puts
  in the branches must dissipate. The solver's contact begins and ends within a step to
  second order, so that all three are off by as much, and four times the samples must
  shrink it.

A scene that is flagged is solved again without the bound on its stated error. Where
that gives a number and the march says that it is right to 1 %, the flag is a failure.
"""

import itertools
import sys
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import heading, save, table, verdict
from line_field import LineField, line_field
from rough_march import Periodic, branch_forces, periodic

import elastomdr as em
from elastomdr.rough import ensemble

warnings.simplefilter("ignore", em.ConvergenceWarning)
warnings.simplefilter("ignore", em.ModelWarning)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(4)
_MOST = 2**19  # samples
_KNOWN = 0.1  # of the stated error: what the truth is known to
_BREACH = 1e-3  # of the conditions of contact, to be reached on the most samples
_ROUNDED = 1e-8  # breaches below this are not asked to shrink
_SETTLED = 1e-4  # of the load: misfit of the march up to which its mu is taken
_LONG = 65536  # samples of a long line
_RIGHT = 0.01  # of mu: a number that is so near the truth must not be flagged


class Level(NamedTuple):
    """A scene on some number of samples."""

    line: LineField
    true: Periodic
    breach: float  # of the conditions of contact, over the load or the depth
    away: float  # of the rubber's surface from the true one, over the depth
    waste: float  # work less dissipation, over the work


class Scene(NamedTuple):
    """What is computed, and on how many samples; None: as many as the package takes."""

    law: em.Foundation
    surface: em.SelfAffine
    motion: dict  # velocity and pressure
    samples: int | None


def drawn(rng: np.random.Generator) -> Scene:
    """Rubber of up to 30 branches, surface, velocity and pressure."""
    return _scene(rng, 10 ** rng.uniform(-10, 4, int(rng.integers(1, 31))))


def broad(rng: np.random.Generator) -> Scene:
    """Rubber whose branches lie evenly over 15 to 24 decades, as fits of master curves
    have them.
    """
    times = np.geomspace(
        10 ** rng.uniform(-14, -9), 10 ** rng.uniform(6, 10), int(rng.integers(15, 41))
    )
    return _scene(rng, times)


def long(rng: np.random.Generator) -> Scene:
    """The same on a long line, light enough for the judge."""
    scene = broad(rng)
    motion = scene.motion | {
        "pressure": float(scene.law.equilibrium) * 10 ** rng.uniform(-5, -3)
    }
    surface = em.SelfAffine(
        rng.uniform(0.5, 1.0),
        rms_slope=0.3,
        q_low=1e3,
        q_high=1e3 * 10 ** rng.uniform(1.5, 2.3),
    )
    return Scene(
        scene.law, surface, motion | {"velocity": 10 ** rng.uniform(-7, 2)}, _LONG
    )


def _scene(rng: np.random.Generator, times: np.ndarray) -> Scene:
    times, count = np.sort(times), times.size
    soft = 10 ** rng.uniform(4, 8)
    moduli = soft * 10 ** rng.uniform(-3, rng.uniform(-1, 4), count)
    low = 10 ** rng.uniform(2, 6)
    slope = 10 ** rng.uniform(-3, 0)
    surface = em.SelfAffine(
        rng.uniform(0.2, 1.0),
        rms_slope=slope,
        q_low=low,
        q_high=low * 10 ** rng.uniform(0.5, 2.3),
    )
    pressure = soft * slope * 10 ** rng.uniform(-3, 1)
    velocity = 10 ** rng.uniform(-10, 4) / low
    return Scene(
        em.Foundation(soft, moduli, times),
        surface,
        {"velocity": velocity, "pressure": pressure},
        None,
    )


def dissipated(law: em.Foundation, velocity: float, line: LineField) -> float:
    """mu of a rubber surface that is straight between samples: what its branches turn
    into heat.
    """
    # in the order in which an element of the rubber meets the line, which moves to +x
    u = line.surface[::-1]
    h = float(line.x[1]) / velocity
    du = np.roll(u, -1) - u  # over the step from i to i + 1
    moduli, times, heat = np.asarray(law.moduli), np.asarray(law.times), 0.0
    for modulus, tau, f in zip(
        moduli, times, branch_forces(moduli, times, u, h), strict=True
    ):
        z = h / tau
        settled = modulus * tau * du / h
        rest = f - settled
        if z > 0.1:
            once, twice = -np.expm1(-z), -np.expm1(-2 * z)
            lost = (
                settled**2 * h
                + 2 * settled * rest * tau * once
                + rest**2 * tau / 2 * twice
            )
        else:  # the three would cancel: Gauss' rule over the step, to 1e-10
            at = 0.5 * (1 + NODES)[:, None]
            force = f * np.exp(-z * at) + modulus * du * -np.expm1(-z * at) / z
            lost = h * 0.5 * WEIGHTS @ force**2
        heat += lost.sum() / (modulus * tau)
    return float(heat / (line.load * u.size * float(line.x[1])))


def level(scene: Scene, samples: int | None) -> Level | None:
    """A scene on so many samples, beside the truth; None where the solver says that it
    did not converge.
    """
    law, velocity = scene.law, scene.motion["velocity"]
    line = line_field(law, scene.surface, samples, **scene.motion)
    if not line.converged:
        return None
    true = periodic(law, line, velocity)
    below = (line.height - line.surface).max() / line.depth
    force = abs(line.force.mean() / line.load - 1)
    away = np.abs(line.surface - true.surface).max() / true.depth
    waste = abs(dissipated(law, velocity, line) / line.mu - 1)
    return Level(
        line, true, float(max(true.start, below, force)), float(away), float(waste)
    )


def levels_of(scene: Scene, samples: int, error: float) -> list[Level | None]:
    """The scene on more and more samples, until the truth is known beside an error of
    mu.
    """
    levels = [level(scene, samples)]
    while not good_enough(levels, error) and samples * 4 <= _MOST:
        samples *= 4
        levels.append(level(scene, samples))
    return levels


def flagged_though_right(scene: Scene) -> tuple[float, float, float]:
    """mu of a flagged scene without the bound on its error, the truth, and what that is
    known to; or NaN.
    """
    bound, ensemble.SAMPLING = ensemble.SAMPLING, np.inf
    try:
        curve = em.friction(
            scene.law,
            scene.surface,
            model=em.Line(samples=scene.samples),
            rtol=1e-6,
            **scene.motion,
        )
        line = line_field(scene.law, scene.surface, scene.samples, **scene.motion)
    finally:
        ensemble.SAMPLING = bound
    mu = float(curve.mu)
    if not (curve.converged.all() and line.converged):
        return mu, np.nan, np.nan
    levels = levels_of(scene, line.x.size, _RIGHT * abs(mu))
    return (
        (mu, np.nan, np.nan)
        if levels[-1] is None
        else (mu, levels[-1].true.mu, known(levels))
    )


def known(levels: list[Level | None]) -> float:
    """What the truth of the last level is known to: a third of its last change, as for
    an error of first order, and what is left of the search for it (rounding, up to 1e-5
    on long lines; mu felt a fiftieth of that at most).
    """
    if (
        len(levels) < 2
        or levels[-1] is None
        or levels[-2] is None
        or levels[-1].true.misfit > _SETTLED
    ):
        return np.inf
    true = levels[-1].true
    return abs(true.mu - levels[-2].true.mu) / 3 + true.misfit * abs(true.mu)


def main(scenes: int) -> None:
    families = (
        (drawn, scenes, 11),
        (broad, -(-scenes // 4), 12),
        (long, -(-scenes // 10), 13),
    )
    drawn_scenes = []
    for draw, count, seed in families:
        rng = np.random.default_rng(seed)
        drawn_scenes += [(draw.__name__, draw(rng)) for _ in range(count)]
    numbers = ", ".join(f"{count} {draw.__name__}" for draw, count, _ in families)
    record = heading(
        "Random scenes on rough surfaces",
        f"{len(drawn_scenes)} scenes, seeded: {numbers}",
    )
    rows, flagged, mistaken, unknown, outside, wrong = [], [], 0, 0, 0, 0
    lines, lines_outside, last, falls, wasted = 0, 0, [], [], []
    for number, (family, scene) in enumerate(drawn_scenes):
        branches = scene.law.moduli.size
        curve = em.friction(
            scene.law,
            scene.surface,
            model=em.Line(samples=scene.samples),
            rtol=1e-6,
            **scene.motion,
        )
        first = line_field(scene.law, scene.surface, scene.samples, **scene.motion)
        if not (curve.converged.all() and first.converged):
            mu, truth, sure = flagged_though_right(scene)
            right = abs(mu - truth) <= _RIGHT * abs(truth) and sure <= _RIGHT * abs(
                truth
            )
            mistaken += right
            flagged.append(
                (
                    number,
                    family,
                    branches,
                    first.x.size,
                    mu,
                    truth,
                    "yes" if right else "no",
                )
            )
            continue
        assert curve.lines is not None
        assert curve.lines.numerical is not None
        mu, error = float(curve.mu), float(curve.lines.numerical)
        levels = levels_of(scene, first.x.size, error)
        if levels[-1] is None or not known(levels) <= _KNOWN * error:
            unknown += 1
            rows.append((number, family, branches, first.x.size, "truth not known"))
            continue
        truth, sure = levels[-1].true.mu, known(levels)
        away = abs(mu - truth)
        outside += away > error + sure
        wrong += away > 3 * error + sure
        if away > error + sure:
            rows.append((number, family, branches, first.x.size, away / mu, error / mu))
        for each in filter(None, levels):
            stated = each.line.error
            if sure <= _KNOWN * stated:
                lines += 1
                lines_outside += abs(each.line.mu - truth) > stated + sure
        last.append(levels[-1])
        for one, four in itertools.pairwise(levels):
            if (
                one is not None
                and four is not None
                and one.true.misfit < 1e-6
                and one.breach > _ROUNDED
            ):
                falls.append(one.breach / four.breach)
                wasted.append(one.waste / four.waste)
    if rows:
        record["noted"] = [list(map(str, row)) for row in rows]
        for row in rows:
            print("  noted:", row)
    if flagged:
        columns = (
            "scene",
            "kind",
            "branches",
            "samples",
            "mu without the flag",
            "truth",
            "right to 1 %",
        )
        record["flagged"] = table(columns, flagged)
    breaches, away, waste = (
        [getattr(one, name) for one in last] for name in ("breach", "away", "waste")
    )
    record["share"] = table(
        (
            "scenes",
            "flagged",
            "breach of contact, median",
            "largest",
            "surface off, largest",
            "work less heat, median",
            "largest",
        ),
        [
            (
                len(drawn_scenes),
                len(flagged),
                float(np.median(breaches)),
                max(breaches),
                max(away),
                float(np.median(waste)),
                max(waste),
            )
        ],
    )
    record["verdicts"] = [
        verdict("wrong and not flagged (mu off by over three stated errors)", wrong, 0),
        verdict(
            (
                f"a condition of contact broken by over {_BREACH:g} of the mean load "
                "on the most samples, scenes"
            ),
            sum(breach > _BREACH for breach in breaches),
            0,
        ),
        verdict("mu outside its stated error", outside, 0.01 * len(drawn_scenes)),
        verdict(
            f"the same of line_field, on {lines} numbers of samples",
            lines_outside,
            0.01 * lines,
        ),
        verdict(
            "scenes whose truth is not known to a tenth of the stated error",
            unknown,
            0.01 * len(drawn_scenes),
        ),
        verdict(
            "fall of the breach on four times the samples, median",
            float(np.median(falls)),
            12,
            least=True,
        ),
        verdict("the same, the least", min(falls), 3, least=True),
        verdict(
            "fall of work less dissipation, median",
            float(np.median(wasted)),
            6,
            least=True,
        ),
        verdict(
            "work less dissipation on the most samples, over the work, the largest",
            max(waste),
            0.03,
        ),
        verdict("flagged, share of scenes", len(flagged) / len(drawn_scenes), 0.05),
        verdict("flagged though right to 1 %, scenes", mistaken, 0),
    ]
    save("robustness/rough_scenes", record)


def good_enough(levels: list[Level | None], error: float) -> bool:
    """Whether the truth is known beside the stated error, on samples on which contact
    is as it should be.
    """
    return (
        known(levels) <= _KNOWN * error
        and levels[-1] is not None
        and levels[-1].breach <= _BREACH
    )


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 200)
