"""Whether the `error` of `em.HalfSpace()` on a small measured map holds: pieces of large
maps with and without a lay, each solved as an instrument's map would be, against the
whole.

    python benchmarks/measured_maps.py        # a minute

The whole is periodic, with eight of its longest waves a side; the pieces have four and
two of them and do not meet at their edges. `error` has the number of summits that carry
the load, and what the cells about the edges add to the slopes along the motion.
"""

import itertools
import warnings

import numpy as np
from common import heading, save, table, verdict

import elastomdr as em
from elastomdr.rough import half_space
from elastomdr.surface.lay import Lay
from elastomdr.surface.topography import MeasuredSurface

PERIODS, CELLS, SEEDS, VELOCITY = 8, 256, 2, 1e-2
PEKLENIK = (1.0, 2.0, 4.0, 8.0)
PRESSURES = (2e4, 1e5, 4e5)  # [Pa]
DIRECTIONS = (0.0, np.pi / 2)  # to the lay, which runs along x [rad]
PARTS = (2, 4)  # of the side of the whole
RUBBER = em.Foundation(1e6, np.full(6, 2e6), np.geomspace(1e-6, 1e-1, 6))
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
COLUMNS = ("g", "direction", "part", "pressure", "contact", "answer", "off", "error")


def ground(peklenik: float) -> MeasuredSurface:
    """The surface that the whole map is drawn from."""
    lay = Lay(ROAD.q, np.full(ROAD.q.size, np.log(peklenik)), 0 * ROAD.q, 0.0)
    return MeasuredSurface(
        q=ROAD.q,
        c=ROAD.c,
        relative_error=0 * ROAD.q,
        measured_height=ROAD.rms_height,
        skewness=0.0,
        report=(),
        lay=lay,
    )


def pieces(whole: np.ndarray, step: float) -> list[tuple[int, MeasuredSurface]]:
    """Pieces of the map as they would be read; without those that hold too few waves."""
    read = []
    for part, place in itertools.product(PARTS, (0, 1)):
        n = CELLS // part
        inside = slice(place * n, (place + 1) * n)
        try:
            read.append((part, em.read_surface(whole[inside, inside], pixel_size=step)))
        except em.InputError as refused:
            print(refused)
    return read


def rows_of(peklenik: float, seed: int) -> list[tuple]:
    """A row for each piece, pressure and direction."""
    whole, side = em.reference.rough_map(
        ground(peklenik), seed, periods=PERIODS, points=CELLS
    )
    rows, read = [], pieces(whole, side / CELLS)
    for pressure, direction in itertools.product(PRESSURES, DIRECTIONS):
        truth = half_space.solve(
            RUBBER.complex_modulus,
            whole,
            (side, side),
            velocity=VELOCITY,
            pressure=pressure,
            angle=direction,
            double=False,
        )
        for part, surface in read:
            curve = em.friction(
                RUBBER,
                surface,
                velocity=VELOCITY,
                pressure=pressure,
                direction=direction,
                model=em.HalfSpace(),
                rtol=1e-2,
            )
            off = float(curve.mu) * pressure / truth.stress - 1
            error = float(curve.error) * pressure / truth.stress
            answer = bool(curve.converged)
            turned = float(np.degrees(direction))
            row = peklenik, turned, part, pressure, truth.area, answer, off, error
            rows.append(row)
    return rows


def main() -> None:
    warnings.simplefilter("ignore")
    record = heading(
        "Pieces of a map against the whole",
        f"{SEEDS} maps of {CELLS} x {CELLS} cells for each Peklenik number",
    )
    rows = []
    for peklenik, seed in itertools.product(PEKLENIK, range(SEEDS)):
        rows += rows_of(peklenik, seed)
    record["columns"], record["points"] = COLUMNS, rows
    answered = [row for row in rows if row[5]]
    summary = []
    for peklenik, part in itertools.product(PEKLENIK, PARTS):
        some = [row for row in answered if (row[0], row[2]) == (peklenik, part)]
        all_of_them = sum((row[0], row[2]) == (peklenik, part) for row in rows)
        off, error = (np.array([row[i] for row in some]) for i in (6, 7))
        held = float(np.mean(np.abs(off) <= error))
        rms = float(np.sqrt((off**2).mean()))
        summary.append((peklenik, part, all_of_them, len(some), rms, held))
    columns = ("g", "part", "points", "with an answer", "rms off", "within error")
    record["summary"] = table(columns, summary)
    held = [abs(row[6]) <= row[7] for row in answered]
    record["verdicts"] = [
        verdict("points within their error", float(np.mean(held)), 0.95, least=True),
        verdict("points with an answer", len(answered) / len(rows), 0.9, least=True),
    ]
    save("measured_maps", record)


if __name__ == "__main__":
    main()
