"""Rough friction and real contact in three dimensions: the truth that `rough_fit.py` fits
to and judges by.

    python benchmarks/rough_truth.py --seed 1 --minutes 60
    python benchmarks/rough_truth.py --seed 2 --minutes 60 --light --largest 2048
    python benchmarks/rough_truth.py --seed 3 --minutes 60 --cells --largest 512

Scene number i of a seed (with its --largest) is always the same scene, so a run that
was broken off goes on where it stopped, and two seeds may run side by side into two
files. A scene is a
surface (self-affine, roll-off, two slopes, hump; cutoff ratios 8 to 1024), a rubber
(one branch to thirteen decades, contrasts 1.3 to 1000), a speed within its losses, and
a pressure for a real contact of 0.3 to 99 % by Persson's theory, half of them below
5 %. Each is solved by `elastomdr.rough.half_space` on two maps or more, wide enough for
eight summits (four where more than 30 % touches), on two grids, of which the finer
gives the shortest wave eight cells, or four where eight would be too many. Friction
is divided by that of full contact on the same map, which takes off most of what the
waves of one map miss, and extrapolated in the size of the cells.

With --cells scenes are drawn by what friction depends on: number i falls into the cell
i of (slope of the loss at q_high) x (real contact), ratios begin at 2, and there are
solids with a loss that is small, or grows with frequency without end, beside the
rubbers. A point that moves by more than a tenth from one grid to the next is solved
again on cells half as large, where that is not more than --largest.

Units: E*(0) = 1, q_low or the wave number of the roll-off = 1, rms slope = 1: friction
goes with the rms slope and depends on p/(E* rms slope).
"""

import argparse
import json
import signal
import time
from pathlib import Path
from typing import Any

import numpy as np
from common import RESULTS

import elastomdr as em
from elastomdr.rough import half_space, multiscale
from elastomdr.rough import random_maps as maps
from elastomdr.rough.psd_integrals import direct
from elastomdr.rough.road_model import RoadProblem
from elastomdr.surface.spectrum import rough_map

FILE = RESULTS / "rough_truth.json"
RATIOS = (8, 16, 32, 64, 128, 256, 512, 1024)
# kind, its numbers, weight in the draw
SURFACES: list[tuple[str, tuple[float, ...], float]] = [
    ("self-affine", (0.3,), 1),
    ("self-affine", (0.5,), 1.5),
    ("self-affine", (0.65,), 1),
    ("self-affine", (0.8,), 3),
    ("self-affine", (0.95,), 1),
    ("roll-off", (0.8, 4.0), 1.5),  # Hurst exponent, q_rolloff/q_low
    ("roll-off", (0.6, 8.0), 1),
    ("roll-off", (0.9, 16.0), 1),
    ("two slopes", (0.9, 0.4), 1.5),  # Hurst exponents below and above the middle
    ("two slopes", (0.4, 0.9), 1),
    ("hump", (0.8, 6.0, 0.3), 1.5),  # Hurst, factor of C at its top, place in log q
    ("hump", (0.6, 10.0, 0.6), 1.5),
]
# Real contact: lowest, highest, weight in the draw, and in that with --light
CONTACT = (
    (0.003, 0.01, 0.24, 0.4),
    (0.01, 0.05, 0.28, 0.4),
    (0.05, 0.3, 0.28, 0.12),
    (0.3, 0.99, 0.2, 0.08),
)
# Cells of --cells: slopes dlog(drag)/dlog q at q_high, and real contact
SLOPES = {"falling": (-1.01, -0.25), "flat": (-0.25, 0.4), "rising": (0.4, 1.01)}
CELLS = (0.003, 0.01, 0.05, 0.25, 0.75, 0.99)
WIDE_RATIOS = (2, 2, 4, 4, 4, 8, 8, 8, 16, 16, 16, 32, 32, 64, 128)
MOVED = 0.1  # of mu, from a grid half as fine, above which a point is solved again
# Of the change of mu from a grid half as fine, the part that is left: of first order in
# the cells 1, of second 1/3. Seven scenes from 2 to 16 cells per wave lie between.
LEFT = 0.5


def materials() -> dict[str, tuple[np.ndarray, np.ndarray, float]]:
    """Moduli beside an equilibrium modulus of 1, relaxation times, decades of the
    times.
    """
    rubbers: dict[str, tuple[np.ndarray, np.ndarray, float]] = {}
    for contrast in (1.3, 3, 11, 100, 1000):
        rubbers[f"one{contrast}"] = np.array([contrast - 1.0]), np.ones(1), 0
    flat = ((3, 11), (3, 100), (6, 30), (6, 300), (10, 1.3), (10, 2))
    power = ((4, 30), (5, 100), (6, 1000), (8, 300), (9, 1000), (13, 1000))
    for slope, cases in (("flat", flat), ("pow", power)):
        for decades, contrast in cases:
            times = np.geomspace(
                10 ** (-decades / 2), 10 ** (decades / 2), 2 * decades + 1
            )
            steep = np.log10(contrast) / decades if slope == "pow" else 0.0
            weight = times**-steep
            moduli = (contrast - 1) * weight / weight.sum()
            rubbers[f"{slope}{decades}_{contrast}"] = moduli, times, decades
    for contrast in (30, 300):
        root = contrast**0.5
        moduli = np.array([contrast - root, root - 1])
        rubbers[f"two_{contrast}"] = moduli, np.array([1e-2, 1e2]), 4
    return rubbers


MATERIALS = materials()
# Of --cells beside these: losses small beside the storage modulus of 1, which fall, stay
# and grow with frequency at all that waves see, and one that goes on growing.
SMALL = {"small falling": -1, "small flat": 0, "small rising": 1}
VISCOUS = "kelvin-voigt"


def rubber(name: str) -> em.Foundation:
    if name == VISCOUS:
        return em.Foundation(1.0, [], [], viscosity=1.0)
    if name in SMALL:
        slope = SMALL[name]
        if slope:  # one relaxation far below or above the waves, whose loss is 1e-3
            return (
                em.Foundation(1.0, [1e-3 * 1e4], [1e-4])
                if slope > 0
                else (em.Foundation(1.0, [1e-3], [1e4]))
            )
        times = np.geomspace(1e-16, 1e16, 97)
        return em.Foundation(1.0, np.full(97, 1e-4), times)
    moduli, times, _ = MATERIALS[name]
    return em.Foundation(1.0, moduli, times)


def surface_of(kind: str, numbers: tuple[float, ...], ratio: float) -> Any:
    """A spectrum of rms slope 1, its lowest wave number (or its roll-off's) 1."""
    if kind == "self-affine":
        return em.SelfAffine(numbers[0], rms_slope=1.0, q_low=1.0, q_high=ratio)
    if kind == "roll-off":
        hurst, factor = numbers
        return em.SelfAffine(
            hurst,
            rms_slope=1.0,
            q_low=1 / factor,
            q_high=ratio / factor,
            q_rolloff=1.0,
        )
    q = np.geomspace(1.0, ratio, 20 * int(np.ceil(np.log10(ratio))) + 1)
    if kind == "two slopes":
        below, above = numbers
        middle = np.sqrt(ratio)
        exponent = np.where(q < middle, below, above)
        c = (q / middle) ** (-2 * (1 + exponent))
    else:
        hurst, factor, place = numbers
        width = 0.12 * np.log(ratio)
        bump = np.exp(-0.5 * ((np.log(q) - place * np.log(ratio)) / width) ** 2)
        c = q ** (-2 * (1 + hurst)) * factor**bump
    spectrum = em.Spectrum(q, c, convention="2d")
    return spectrum.raised(1 / float(spectrum.rms_slope))


class Taken(Exception):
    """The time of a contact is over."""


def draw(rng: np.random.Generator, largest: int, light: bool) -> dict[str, Any] | None:
    """A scene and its grid; None where that would be too large."""
    weights = np.array([weight for *_, weight in SURFACES])
    kind, numbers, _ = SURFACES[
        int(rng.choice(len(SURFACES), p=weights / weights.sum()))
    ]
    ratio = int(rng.choice(RATIOS))
    name = str(rng.choice(list(MATERIALS)))
    low, high, *_ = CONTACT[int(rng.choice(4, p=[c[2 + light] for c in CONTACT]))]
    area = float(np.exp(rng.uniform(np.log(low), np.log(high))))
    half = MATERIALS[name][2] / 2 + 1.2
    place = rng.uniform(-half, half)
    if kind == "roll-off" and ratio < 4 * numbers[1]:
        return None
    surface = surface_of(kind, numbers, ratio)
    velocity = 10**place / np.sqrt(float(surface.q_low) * float(surface.q_high))
    return on_grid(kind, numbers, ratio, name, velocity, area, largest)


def on_grid(
    kind: str,
    numbers: tuple[float, ...],
    ratio: int,
    name: str,
    velocity: float,
    area: float,
    largest: int,
) -> dict[str, Any] | None:
    """The scene with its pressure, and the grid that it is solved on."""
    surface, material = surface_of(kind, numbers, ratio), rubber(name)
    pressure = pressure_for(area, material, surface, velocity)
    one = maps.MapGrid(4 * ratio, 1, 2 * np.pi / float(surface.q_low))
    at = np.array([velocity]), np.array([pressure])
    carried = maps.summits(material.complex_modulus, surface, *at, one)[0]
    periods = int(np.ceil(np.sqrt((4 if area > 0.3 else 8) / carried)))
    fits = [n for n in (8, 4) if n * periods * ratio <= largest]
    if not fits:
        return None
    return {
        "surface": [kind, *numbers],
        "ratio": ratio,
        "material": name,
        "velocity": float(velocity),
        "pressure": pressure,
        "periods": periods,
        "per_wave": fits[0],
        "summits": float(carried * periods**2),
    }


def slope_of_loss(material: em.Foundation, surface: Any, velocity: float) -> float:
    """dlog(drag)/dlog q at q_high, drag as in `rough.psd_integrals`."""
    near = velocity * float(surface.q_high) * np.exp([-0.05, 0.05])
    low, high = np.log(direct(material.complex_modulus, near).drag)
    return float(high - low) / 0.1


def draw_in_cell(
    rng: np.random.Generator, number: int, largest: int, light: bool
) -> dict[str, Any] | None:
    """The scene of this number of --cells, and its grid; with --light of less than 5 %
    contact.
    """
    least, most = list(SLOPES.values())[number % 3]
    contact = number // 3 % (2 if light else len(CELLS) - 1)
    weights = np.array([weight for *_, weight in SURFACES])
    names = [
        *MATERIALS,
        *5 * [VISCOUS, *SMALL],
        *3 * [n for n in MATERIALS if "one" in n],
    ]
    while True:
        kind, numbers, _ = SURFACES[
            int(rng.choice(len(SURFACES), p=weights / weights.sum()))
        ]
        ratio, name = int(rng.choice(WIDE_RATIOS)), str(rng.choice(names))
        if kind == "roll-off" and ratio < 4 * numbers[1]:
            continue
        half = MATERIALS[name][2] / 2 + 1.5 if name in MATERIALS else 1.5
        place = rng.uniform(-half, half) if name not in SMALL else 0.0
        surface, material = surface_of(kind, numbers, ratio), rubber(name)
        middle = float(
            surface.q_high
            if name == VISCOUS
            else np.sqrt(float(surface.q_low) * float(surface.q_high))
        )
        velocity = 10**place / middle
        if least <= slope_of_loss(material, surface, velocity) < most:
            break
    area = float(np.exp(rng.uniform(*np.log(CELLS[contact : contact + 2]))))
    return on_grid(kind, numbers, ratio, name, velocity, area, largest)


def pressure_for(
    area: float, material: em.Foundation, surface: Any, velocity: float
) -> float:
    """Pressure at which Persson's theory has a real contact of `area`."""
    low, high = np.log(1e-6), np.log(3e3)
    for _ in range(20):
        middle = 0.5 * (low + high)
        at = np.array([velocity]), np.exp([middle])
        problem = RoadProblem(material, surface, *at, rtol=1e-2)
        persson = multiscale.solve(em.Persson(), problem)
        low, high = (middle, high) if persson.area[0] < area else (low, middle)
    return float(np.exp(middle))


def solve(
    scene: dict[str, Any],
    rng: np.random.Generator,
    surface: Any = None,
    patience: float = 240.0,
) -> dict[str, Any]:
    """The scene with friction over that in full contact, and real contact, of each map
    on both grids; None where a contact did not settle, within `patience` seconds of the
    processor. Of the `surface` in the scene, or of that given.
    """
    if surface is None:
        kind, *numbers = scene["surface"]
        surface = surface_of(kind, tuple(numbers), scene["ratio"])
    modulus = rubber(scene["material"]).complex_modulus
    periods, fine = scene["periods"], scene["per_wave"]
    points = 4 * int(-(-fine * periods * scene["ratio"] // 4))
    seeds = 2 if points > 1024 else 3
    mu, area, variance = [], [], []
    signal.signal(signal.SIGPROF, _over)
    for _ in range(seeds):
        seed = int(rng.integers(2**26))
        heights, side = rough_map(surface, seed, periods=periods, points=points)
        at = {"velocity": scene["velocity"], "pressure": scene["pressure"]}
        own = maps.full_contact_of_map(modulus, heights, (side, side), **at)
        try:
            pair, start = [], None
            for grid in (heights[::2, ::2], heights):
                signal.setitimer(signal.ITIMER_PROF, patience)
                contact = half_space.solve(
                    modulus, grid, (side, side), **at, start=start, double=False
                )
                signal.setitimer(signal.ITIMER_PROF, 0)
                start = np.repeat(np.repeat(contact.pressure, 2, 0), 2, 1)
                if not contact.settled:
                    raise Taken
                pair.append((contact.stress / scene["pressure"] / own, contact.area))
        except Taken:
            signal.setitimer(signal.ITIMER_PROF, 0)
            return {**scene, "mu": None, "area": None, "variance": None}
        mu.append([pair[0][0], pair[1][0]])
        area.append([pair[0][1], pair[1][1]])
        on = half_space.waves(modulus, scene["velocity"], heights.shape, (side, side))
        variance.append(_variance(on, contact.pressure, heights))
    return {
        **scene,
        "mu": _short(mu),
        "area": _short(area),
        "variance": float(f"{np.mean(variance):.4g}"),
    }


def _variance(on: half_space.MapWaves, pressure: Any, heights: Any) -> float:
    """Of the pressure on the finer grid, over that in full contact."""
    full = np.fft.irfft2(np.fft.rfft2(heights) * on.inverse, heights.shape)
    return float(np.var(pressure) / np.var(full))


def _over(*_: Any) -> None:
    raise Taken


def _short(rows: list[list[float]]) -> list[list[float]]:
    return [[float(f"{value:.5g}") for value in row] for row in rows]


def truth(values: list[list[float]]) -> tuple[float, float]:
    """Mean over the maps for ever finer cells, and its relative standard uncertainty:
    from the scatter of maps, and half of what extrapolation adds.
    """
    coarse, fine = np.array(values).T
    last = fine + LEFT * (fine - coarse)
    mean = float(last.mean())
    scatter = float(last.std(ddof=1) / np.sqrt(last.size))
    moved = abs(float((last - fine).mean()))
    # the scatter of two or three maps is itself uncertain
    return mean, float(np.hypot(max(scatter, 0.004 * mean), 0.5 * moved)) / mean


def moved(values: list[list[float]]) -> float:
    """By how much a mean over the maps changed from the coarser grid to the finer."""
    coarse, fine = np.array(values).T
    return abs(float(np.mean(fine / coarse - 1)))


def write(points: list[dict[str, Any]], file: Path) -> None:
    rows = ",\n".join(json.dumps(point) for point in points)
    file.write_text(f"[\n{rows}\n]\n")


def solve_again(points: list[dict[str, Any]], asked: argparse.Namespace) -> None:
    """Points that moved with the grid, the smallest grids first, with cells half as
    large as long as they move and the grid is not larger than asked.
    """

    def cells(point: dict[str, Any]) -> int:
        return int(2 * point["per_wave"] * point["periods"] * point["ratio"])

    end = time.monotonic() + 60 * asked.minutes
    while left := [
        i
        for i, p in enumerate(points)
        if p["mu"] and moved(p["mu"]) > MOVED and cells(p) <= asked.largest
        if not p.get("stuck")
    ]:
        if time.monotonic() > end:
            break
        i = min(left, key=lambda i: cells(points[i]))
        point = points[i]
        rng = np.random.default_rng([asked.seed, *point["number"]])
        scene = {**point, "per_wave": 2 * point["per_wave"]}
        solved = solve(scene, rng, patience=asked.patience)
        before = moved(point["mu"])
        points[i] = solved if solved["mu"] else {**point, "stuck": True}
        write(points, asked.file)
        now = f"{moved(solved['mu']):.2f}" if solved["mu"] else "not settled"
        print(
            point["number"], cells(point), f"moved {before:.2f}, then {now}", flush=True
        )


def main() -> None:
    options = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    options.add_argument("--seed", type=int, required=True)
    options.add_argument(
        "--again",
        action="store_true",
        help="no new scenes: those that moved with the grid, on finer grids",
    )
    options.add_argument("--minutes", type=float, default=60.0)
    options.add_argument(
        "--largest", type=int, default=1024, help="cells to a side of the largest grid"
    )
    options.add_argument("--light", action="store_true", help="more of light contact")
    options.add_argument("--cells", action="store_true", help="by slope and contact")
    options.add_argument(
        "--slope",
        choices=SLOPES,
        help="of --cells: of this slope and below 1 %% contact",
    )
    options.add_argument(
        "--ratio", type=int, choices=RATIOS, help="scenes of this cutoff ratio alone"
    )
    options.add_argument(
        "--patience", type=float, default=240.0, help="seconds for one contact"
    )
    options.add_argument("--file", type=Path, default=FILE)
    asked = options.parse_args()
    points = json.loads(asked.file.read_text()) if asked.file.exists() else []
    if asked.again:
        solve_again(points, asked)
        return
    done = {tuple(point["number"]) for point in points}
    end, i = time.monotonic() + 60 * asked.minutes, -1
    while time.monotonic() < end:
        i += 1
        if (asked.seed, i) in done:
            continue
        if asked.slope and (
            list(SLOPES)[i % 3] != asked.slope or i // 3 % (2 if asked.light else 5)
        ):
            continue
        rng = np.random.default_rng([asked.seed, i])
        scene = (
            draw_in_cell(rng, i, asked.largest, asked.light)
            if asked.cells
            else draw(rng, asked.largest, asked.light)
        )
        if scene is None or (asked.ratio and scene["ratio"] != asked.ratio):
            continue
        start = time.process_time()
        solved = solve(scene, rng, patience=asked.patience)
        while asked.cells and solved["mu"] and moved(solved["mu"]) > MOVED:
            finer = {**scene, "per_wave": 2 * solved["per_wave"]}
            if finer["per_wave"] * finer["periods"] * finer["ratio"] > asked.largest:
                break
            again = solve(finer, rng, patience=asked.patience)
            if not again["mu"]:
                break
            solved = again
        point = {"number": [asked.seed, i], **solved}
        points.append(point)
        write(points, asked.file)
        said = "did not settle"
        if point["mu"]:
            said = f"mu/full {truth(point['mu'])}, area {truth(point['area'])}"
        print(
            f"{i}: {scene['surface']} {scene['ratio']} {scene['material']} "
            f"{scene['periods']}x{scene['per_wave']}: {said}, "
            f"{time.process_time() - start:.0f} s",
            flush=True,
        )


if __name__ == "__main__":
    main()
