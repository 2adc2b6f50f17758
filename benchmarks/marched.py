"""Have marched elements the friction of the closed forms, within their stated errors?
Drawn scenes: bodies on half-spaces and springs.

    python benchmarks/marched.py [--minutes 25] [--first 0] [--scenes 200]

Both are ours, and share no formula but the exact step of an element. A line is printed
for every scene; what is done within the minutes is kept, with its count. Ratios of
processor time are of second calls, where the program is compiled already.
"""

import argparse
import sys
import time
import warnings
from pathlib import Path
from typing import NamedTuple

import numpy as np
from common import heading, one_core, save, table, verdict

import elastomdr as em

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.smooth.test_march import drawn_scene

RTOL = 1e-3
COLUMNS = (
    "bodies",
    "scenes",
    "not converged",
    "largest difference",
    "largest difference over error",
    "covered [%]",
)


class Scene(NamedTuple):
    body: str
    converged: bool
    difference: float  # of mu, relative
    stated: float  # the sum of both errors, relative
    slower: float  # processor time over that of the closed forms

    @property
    def covered(self) -> bool:
        return self.difference <= self.stated


def solve(number: int) -> Scene:
    law, shape, given = drawn_scene(number)

    def timed(**options) -> tuple[em.FrictionCurve, float]:
        em.friction(law, shape, **given, **options)  # compiles
        began = time.process_time()
        curve = em.friction(law, shape, **given, **options)
        return curve, time.process_time() - began

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ConvergenceWarning)
        closed, least = timed()
        marched, took = timed(model=em.Marched(), rtol=RTOL)
    mu = float(closed.mu)
    where = "springs" if number % 3 == 0 else "half-space"
    return Scene(
        f"{shape.label}, {where}",
        bool(marched.converged & closed.converged),
        abs(float(marched.mu) - mu) / mu,
        float(marched.error + closed.error) / mu,
        took / least,
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=25.0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--scenes", type=int, default=200)
    given = parser.parse_args()
    one_core()
    record = heading("Marched elements against closed forms, one core")
    until, found = time.monotonic() + 60 * given.minutes, []
    for number in range(given.first, given.first + given.scenes):
        if time.monotonic() > until:
            break
        found.append(solve(number))
        scene = found[-1]
        said = "covered" if scene.covered else "OUTSIDE" if scene.converged else "NaN"
        print(
            f"  {number:3d} {scene.body:25s} off by {scene.difference:.1e} of mu, "
            f"stated {scene.stated:.1e}: {said}",
            flush=True,
        )
    rows = []
    for body in dict.fromkeys(scene.body for scene in found):
        of = [scene for scene in found if scene.body == body]
        good = [scene for scene in of if scene.converged]
        rows.append(
            (
                body,
                len(of),
                len(of) - len(good),
                max(scene.difference for scene in good),
                max(scene.difference / scene.stated for scene in good),
                100 * np.mean([scene.covered for scene in good]),
            )
        )
    record["scenes"] = table(COLUMNS, rows)
    good = [scene for scene in found if scene.converged]
    covered = sum(scene.covered for scene in good)
    slower = float(np.median([scene.slower for scene in found]))
    record["figures"] = [
        verdict("scenes", len(found), 200, least=True),
        verdict("of them converged", len(good), 0.98 * len(found), least=True),
        verdict("of those within their errors", covered, len(good), least=True),
        verdict("processor time over that of the closed forms, median", slower, 1000.0),
    ]
    save("marched", record)


if __name__ == "__main__":
    main()
