"""An attempt to refute `em.Multiscale` and its bound: scenes nobody has seen, drawn anew,
solved in three dimensions, and only then computed.

    python benchmarks/blind_points.py --seed 1
    python benchmarks/blind_points.py --seed 2 --count 60 --largest 1024

The scenes are those of `rough_truth.py --cells`: number i of a seed lies in the cell i of
(slope of the loss at q_high) x (real contact). Nothing is fitted and no point left out:
one that did not settle, or moved by more than a tenth from a grid half as fine, is
counted. What is found for a seed replaces what the record had for it.
"""

import argparse
import json
from typing import Any

import numpy as np
from common import RESULTS, heading, save, table
from rough_truth import (
    MOVED,
    draw_in_cell,
    moved,
    rubber,
    slope_of_loss,
    solve,
    surface_of,
    truth,
)

import elastomdr as em
from elastomdr.rough.random_maps import full_contact

FILE = RESULTS / "blind_points.json"
TITLES = (
    "surface",
    "ratio",
    "rubber",
    "slope",
    "contact",
    "mu/mu_3D",
    "bound",
    "unsure",
)


def judged(point: dict[str, Any]) -> tuple:
    """A row of TITLES: the point by the model, over its solution."""
    kind, *numbers = point["surface"]
    surface = surface_of(kind, tuple(numbers), point["ratio"])
    body, (quotient, unsure) = rubber(point["material"]), truth(point["mu"])
    at = {"velocity": point["velocity"], "pressure": point["pressure"]}
    full = full_contact(
        body.complex_modulus, surface, *(np.array([x]) for x in at.values())
    )
    curve = em.friction(body, surface, **at)
    return (
        " ".join(map(str, point["surface"])),
        point["ratio"],
        point["material"],
        slope_of_loss(body, surface, point["velocity"]),
        truth(point["area"])[0],
        float(curve.mu) / (quotient * float(full[0])),
        float(curve.model_error) / float(curve.mu),
        unsure,
    )


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    options.add_argument("--seed", type=int, required=True)
    options.add_argument("--count", type=int, default=30, help="scenes that are drawn")
    options.add_argument(
        "--largest", type=int, default=384, help="cells to a side of the largest grid"
    )
    options.add_argument("--patience", type=float, default=60.0)
    asked = options.parse_args()
    rows, left = [], {"too large": 0, "did not settle": 0, "moved": 0}
    for i in range(asked.count):
        rng = np.random.default_rng([asked.seed, i, 1])  # no scene of the record
        scene = draw_in_cell(rng, i, asked.largest, light=False)
        if scene is None:
            left["too large"] += 1
            continue
        point = solve(scene, rng, patience=asked.patience)
        if not point["mu"]:
            left["did not settle"] += 1
        elif moved(point["mu"]) > MOVED:
            left["moved"] += 1
        else:
            rows.append(judged(point))
            print(i, *rows[-1], flush=True)
    record = json.loads(FILE.read_text()) if FILE.exists() else {}
    seeds = record.get("seeds", {})
    off, bound = (np.array([row[i] for row in rows]) for i in (5, 6))
    seeds[str(asked.seed)] = {
        "drawn": asked.count,
        "largest": asked.largest,
        **left,
        "judged": len(rows),
        "rms": float(np.sqrt(np.mean(np.log(off) ** 2))),
        "worst": float(np.max(np.abs(np.log(off)))),
        "within the bound": float(np.mean(np.abs(np.log(off)) <= np.log1p(bound))),
        "points": table(TITLES, rows),
    }
    print({name: x for name, x in seeds[str(asked.seed)].items() if name != "points"})
    head = heading(
        "Points that no fit has seen", "by python benchmarks/blind_points.py"
    )
    save("blind_points", {**head, "seeds": seeds})


if __name__ == "__main__":
    main()
