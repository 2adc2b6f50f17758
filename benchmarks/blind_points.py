"""An attempt to refute `em.Multiscale` and its bound: scenes nobody has seen, drawn anew,
solved in three dimensions, and only then computed.

    python benchmarks/blind_points.py --seed 1
    python benchmarks/blind_points.py --seed 2 --count 60 --largest 1024
    python benchmarks/blind_points.py --again      # those of the record, by another form

The scenes are those of `rough_truth.py --cells`: number i of a seed lies in the cell i of
(slope of the loss at q_high) x (real contact). Nothing is fitted and no point left out:
one that did not settle, or moved by more than a tenth from a grid half as fine, is
counted. What is found for a seed replaces what the record had for it; by --again a form
that was changed since is judged by the same solutions, which it has then seen.
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
    "mu_3D/full",
    "number",
)


def scene_of(seed: int, number: int, largest: int) -> tuple[Any, np.random.Generator]:
    rng = np.random.default_rng([seed, number, 1])  # no scene of the record
    return draw_in_cell(rng, number, largest, light=False), rng


def judged(
    point: dict[str, Any], number: int, contact: float, quotient: float, unsure: float
) -> tuple:
    """A row of TITLES: the point by the model, over its solution."""
    kind, *numbers = point["surface"]
    surface = surface_of(kind, tuple(numbers), point["ratio"])
    body = rubber(point["material"])
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
        contact,
        float(curve.mu) / (quotient * float(full[0])),
        float(curve.model_error) / float(curve.mu),
        unsure,
        quotient,
        number,
    )


def summed(rows: list[tuple]) -> dict[str, Any]:
    """What stands for a seed in the record, of its rows."""
    off, bound = np.transpose([(np.log(row[5]), np.log1p(row[6])) for row in rows])
    return {
        "judged": len(rows),
        "rms": float(np.sqrt(np.mean(off**2))),
        "worst": float(np.abs(off).max()),
        "within the bound": float(np.mean(np.abs(off) <= bound)),
        "points": table(TITLES, rows),
    }


def judged_again(seed: int, found: dict[str, Any]) -> dict[str, Any]:
    """The record of a seed by the form of today."""
    rows = []
    for point in found["points"]:
        scene, _ = scene_of(seed, point["number"], found["largest"])
        known = (point[name] for name in ("number", "contact", "mu_3D/full", "unsure"))
        rows.append(judged(scene, *known))
    return found | summed(rows)


def solved(asked: argparse.Namespace) -> dict[str, Any]:
    """The record of a seed: drawn, solved, and then computed."""
    rows, left = [], {"too large": 0, "did not settle": 0, "moved": 0}
    for i in range(asked.count):
        scene, rng = scene_of(asked.seed, i, asked.largest)
        if scene is None:
            left["too large"] += 1
            continue
        point = solve(scene, rng, patience=asked.patience)
        if not point["mu"]:
            left["did not settle"] += 1
        elif moved(point["mu"]) > MOVED:
            left["moved"] += 1
        else:
            known = truth(point["area"])[0], *truth(point["mu"])
            rows.append(judged(point, i, *known))
            print(i, *rows[-1], flush=True)
    drawn = {"drawn": asked.count, "largest": asked.largest}
    return drawn | left | summed(rows)


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    which = options.add_mutually_exclusive_group(required=True)
    which.add_argument("--seed", type=int)
    which.add_argument("--again", action="store_true", help="judge the record anew")
    options.add_argument("--count", type=int, default=30, help="scenes that are drawn")
    options.add_argument(
        "--largest", type=int, default=384, help="cells to a side of the largest grid"
    )
    options.add_argument("--patience", type=float, default=60.0)
    asked = options.parse_args()
    record = json.loads(FILE.read_text()) if FILE.exists() else {}
    seeds = record.get("seeds", {})
    if asked.again:
        seeds = {seed: judged_again(int(seed), found) for seed, found in seeds.items()}
    else:
        seeds[str(asked.seed)] = solved(asked)
    for seed, found in seeds.items():
        print(seed, {name: x for name, x in found.items() if name != "points"})
    head = heading(
        "Points that no fit has seen", "by python benchmarks/blind_points.py"
    )
    save("blind_points", {**head, "seeds": seeds})


if __name__ == "__main__":
    main()
