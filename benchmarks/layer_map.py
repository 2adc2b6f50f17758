"""Balls and cones that slide on a layer: the averaged line with its kernel against
three dimensions.

    python benchmarks/layer_map.py
    compares what is recorded with the averaged line of today
    python benchmarks/layer_map.py --solve
    solves what is missing in three dimensions first (hours)

Every point is a load that gives the relaxed contact a width 2a/h, a contrast of glassy
to relaxed modulus, and a velocity v tau/a. Results: benchmarks/results/layer_map.json.
"""

import argparse
import itertools
import json
import warnings
from pathlib import Path

import numpy as np

import elastomdr as em

HERE = Path(__file__).parent / "results" / "layer_map.json"
WIDTHS = (0.3, 1.0, 2.0, 4.0, 6.0)  # 2a/h of the relaxed contact
BODIES = {"ball": em.Paraboloid(1.0), "cone": em.Cone(0.2)}
# name: glassy over relaxed modulus, branches per decade-wide step
RUBBERS = {"10": (10, 1), "100": (100, 1), "30 broad": (30, 4), "100 broad": (100, 4)}
BASES = {
    "0.5 bonded": (0.5, True),
    "0.3 bonded": (0.3, True),
    "0.5 slips": (0.5, False),
}
VELOCITIES = (0.03, 0.2, 1.0, 5.0, 30.0)  # v tau/a, tau the middle of the spectrum


def rubber(kind: str, poisson: float) -> em.Prony:
    """Relaxed E* of 1 Pa; broad ones have four times, a decade apart."""
    contrast, count = RUBBERS[kind]
    times = 10.0 ** (np.arange(count) - (count - 1) / 2)
    shear = (1 - poisson) / 2
    return em.Prony(
        shear, np.full(count, shear * (contrast - 1) / count), times, poisson=poisson
    )


def points() -> list[tuple]:
    """Body, base, rubber, width, velocity; bases besides the first on a part of the
    map.
    """
    every = itertools.product(BODIES, BASES, RUBBERS, WIDTHS, VELOCITIES)
    return [
        p
        for p in every
        if p[1] == "0.5 bonded" or (p[2] in ("10", "100") and p[3] in (1.0, 4.0))
    ]


def load_of(body: str, base: str, width: float) -> float:
    """Load [N] that gives a relaxed contact of this width over the thickness."""
    poisson, bonded = BASES[base]
    elastic = em.layer(
        em.Prony((1 - poisson) / 2, [], [], poisson=poisson), 1.0, bonded=bonded
    )
    low, high = 1e-6, 1e6
    for _ in range(60):
        middle = np.sqrt(low * high)
        radius = em.indent(
            elastic, BODIES[body], time=[0.0, 1.0], load=[middle, middle]
        ).contact_radius[-1]
        low, high = (middle, high) if radius < width / 2 else (low, middle)
    return float(middle)


def key(point: tuple) -> str:
    return " | ".join(str(p) for p in point)


def solve(found: dict) -> None:
    loads: dict[tuple, float] = {}
    for point in points():
        body, base, kind, width, speed = point
        if key(point) in found:
            continue
        place = (body, base, width)
        loads[place] = loads.get(place) or load_of(*place)
        poisson, bonded = BASES[base]
        cover = em.layer(rubber(kind, poisson), 1.0, bonded=bonded)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            curve = em.reference.layer_sliding(
                cover,
                BODIES[body],
                velocity=0.5 * width * speed,
                load=loads[place],
                points=64,
            )
        entry = {"load": loads[place], "velocity": 0.5 * width * speed}
        entry |= {
            name: float(getattr(curve, name)) for name in ("mu", "depth", "error")
        }
        found[key(point)] = entry
        HERE.write_text(json.dumps(found, indent=1) + "\n")


def compare(found: dict) -> np.ndarray:
    """Per point: how far the corrected average is off, its bound, whether it is a ball,
    and the cells' own error.
    """
    rows = []
    for place in dict.fromkeys(p[:4] for p in points()):
        body, base, kind, _ = place
        entries = [
            found[key((*place, v))] for v in VELOCITIES if key((*place, v)) in found
        ]
        entries = [e for e in entries if e["error"] < 0.02 * e["mu"]]
        if not entries:
            continue
        poisson, bonded = BASES[base]
        cover = em.layer(rubber(kind, poisson), 1.0, bonded=bonded)
        velocity = np.array([e["velocity"] for e in entries])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            curve = em.friction(
                cover,
                BODIES[body],
                velocity=velocity,
                load=entries[0]["load"],
                rtol=1e-3,
            )
        truth = np.array([e["mu"] for e in entries])
        error = np.array([e["error"] for e in entries]) / truth
        part = np.stack(
            [
                curve.mu / truth - 1,
                curve.model_error / curve.mu,
                np.full(len(truth), body == "ball"),
                error,
            ]
        )
        rows.append(part[:, np.isfinite(part).all(axis=0)].T)
    return np.concatenate(rows)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--solve", action="store_true")
    options = parser.parse_args()
    record = json.loads(HERE.read_text()) if HERE.exists() else {}
    if options.solve:
        solve(record)
    rows = compare(record)
    off, bound, ball = rows[:, 0], rows[:, 1], rows[:, 2] == 1
    for name, which in (("balls", ball), ("cones", ~ball)):
        if which.any():
            held = np.mean(np.abs(off[which]) <= bound[which] + rows[which, 3])
            print(
                f"{name}: {which.sum()} points, the corrected average is within "
                f"{100 * np.percentile(np.abs(off[which]), 95):.1f} % in 95 % of "
                f"them, {100 * np.abs(off[which]).max():.1f} % off at most; the bound "
                f"holds in {100 * held:.0f} %"
            )
