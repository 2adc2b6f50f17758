"""Have marched elements the friction of the closed forms, within their stated errors?
Drawn scenes: bodies on half-spaces and springs.

    python benchmarks/marched.py

Both are ours, and share no formula but the exact step of an element. Ratios of
processor time tell what marching costs where the program is compiled already.
"""

import sys
import time
import warnings
from pathlib import Path

import numpy as np
from common import heading, one_core, save, table, verdict

import elastomdr as em

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.smooth.test_march import drawn_scene

SCENES, RTOL = 200, 1e-3
COLUMNS = ("bodies", "scenes", "not converged", "largest difference", "covered [%]")


def main() -> None:
    one_core()
    record = heading("Marched elements against closed forms, one core")
    rows, found = [], []
    for number in range(SCENES):
        law, shape, given = drawn_scene(number)
        began = time.process_time()
        closed = em.friction(law, shape, **given)
        middle = time.process_time()
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", em.ConvergenceWarning)
            marched = em.friction(law, shape, model=em.Marched(), rtol=RTOL, **given)
        took = time.process_time() - middle
        off = abs(float(marched.mu) - float(closed.mu))
        within = off <= float(marched.error) + float(closed.error)
        good = bool(marched.converged & closed.converged)
        where = "springs" if number % 3 == 0 else "half-space"
        body = shape.label
        found.append(
            (f"{body}, {where}", good, off / closed.mu, within, took / (middle - began))
        )
    for name in dict.fromkeys(row[0] for row in found):
        of = [row[1:] for row in found if row[0] == name]
        good = [row for row in of if row[0]]
        rows.append(
            (
                name,
                len(of),
                len(of) - len(good),
                max(row[1] for row in good),
                100 * np.mean([row[2] for row in good]),
            )
        )
    record["scenes"] = table(COLUMNS, rows)
    good = [row for row in found if row[1]]
    record["figures"] = [
        verdict("scenes that converge", len(good), 0.98 * SCENES, least=True),
        verdict(
            "covered [%]", 100 * np.mean([row[3] for row in good]), 99.0, least=True
        ),
        verdict(
            "processor time over that of the closed forms, median, with compiling",
            float(np.median([row[4] for row in found])),
            1000.0,
        ),
    ]
    save("marched", record)


if __name__ == "__main__":
    main()
