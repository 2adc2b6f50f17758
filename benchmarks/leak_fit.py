"""The form of `em.leak` against three-dimensional maps: `python benchmarks/leak_fit.py`.

Truth is `results/leak_maps.json` (`leak_maps.py`): at each surface and load the mean
gap over the maps, and the flow of a plane of them (`elastomdr.seal.gap_maps.medium`),
along both axes. The form has five constants: c and d of the mean gap, k, m and e of
the flow factor; channels close at a real contact of 0.415 (Wang and Mueser 2021). They are
fitted to every second surface and judged on the others, then the other way round, and
at last to all surfaces, which gives the constants of `elastomdr.seal.leak_form`. The
flow factor is fitted with the maps' own mean gap, which scatters together with their
flow, and judged with the form's.

Truth is corrected for its cells: maps of four cells per shortest wave leak less than
finer ones, by a share that grows with the shortest waves' share of the slope and
towards closing (`results/leak_grid.json`, `leak_grid.py`).

Maps scatter: `maps` is twice the standard error of ln w over the maps of a surface, and
a bound that covers the differences between form and maps covers it as well.
"""

import json
from typing import Any, NamedTuple

import numpy as np
from common import heading, save, table, verdict
from leak_grid import FILE as GRID
from leak_maps import FILE, spectrum_of, surface
from scipy.optimize import least_squares

import elastomdr as em
from elastomdr.rough.psd_integrals import PER_DECADE, nodes
from elastomdr.seal.gap_maps import effective_medium
from elastomdr.seal.leak_form import FORM, LeakForm, factor, gap_of, log_bound
from elastomdr.seal.persson_gap import contact_of, mean_gap

BANDS = ((0.0, 0.05), (0.05, 0.15), (0.15, 0.25), (0.25, 0.3), (0.3, 0.35), (0.35, 0.4))
FLOOR, MOST = 0.05, 2.0  # of the deviation of ln w by which points are weighed
SURE = 0.28  # contact up to which cells are compared: above it single places decide
FITTED = 0.38  # contact up to which the flow is fitted
LEAST = 1e-30


class Maps(NamedTuple):
    """Points of all surfaces; gaps in rms heights, flows in their cube."""

    surface: Any  # number
    area: Any  # by Persson's theory
    ideal: Any  # mean gap by Persson's theory
    gap: Any  # mean over maps
    gap_error: Any  # standard error of its logarithm
    flow: Any
    over_gap: Any  # flow over the cube of each map's own gap
    steep: Any  # dlog R/dlog q at q_high: how much the shortest waves count
    error: Any  # standard error of ln w over maps
    over_gap_error: Any
    theories: Any  # flow of each theory, (theories, points)


THEORIES = {
    "critical constriction": em.CriticalConstriction(),
    "effective medium, n = 2": em.EffectiveMedium(),
    "effective medium, closed at .415": em.EffectiveMedium(closes=0.415),
}


def _error(flows: np.ndarray) -> np.ndarray:
    """Standard error of ln w over maps, (points, maps, axes)."""
    own = np.log(np.maximum(flows.mean(-1), LEAST))
    return own.std(1, ddof=1) / own.shape[1] ** 0.5


def read() -> Maps:
    parts = []
    for number, own in json.loads(FILE.read_text()).items():
        spectrum = spectrum_of(*(own[key] for key in ("hurst", "ratio", "rolloff")))
        for kept in filter(None, own["maps"].values()):
            parts.append(_points(int(number), spectrum, kept))
    return Maps(*(np.concatenate(part, -1) for part in zip(*parts, strict=True)))


def _of_maps(flows: np.ndarray) -> float:
    """Flow through a plane of maps, along either axis."""
    return effective_medium(np.ones(flows.size), flows.ravel(), 2)


def _points(number: int, spectrum: em.SelfAffine, kept: dict[str, Any]) -> Maps:
    """One surface on maps of one size."""
    gap, flows = np.array(kept["gap"]), np.array(kept["flow"])
    good = np.isfinite(flows).all((1, 2))
    level, gap, flows = np.array(kept["level"])[good], gap[good], flows[good]
    found = contact_of(nodes(spectrum, PER_DECADE), level)
    over = flows / gap[..., None] ** 3
    height = spectrum.rms_height
    theories = [
        model.leak(spectrum, level[None]).flow[0] / height**3
        for model in THEORIES.values()
    ]
    return Maps(
        np.full(level.size, number),
        found.area,
        mean_gap(found) / height,
        gap.mean(1),
        np.log(gap).std(1, ddof=1) / gap.shape[1] ** 0.5,
        np.array([_of_maps(each) for each in flows]),
        np.array([_of_maps(each) for each in over]),
        found.steep,
        _error(flows),
        _error(over),
        np.array(theories),
    )


def of_cells(area: Any, steep: Any) -> Any:
    """ln of the flow on ever finer cells over that on four per shortest wave, but for a
    factor.
    """
    return -steep * np.log(1 - np.minimum(area, FITTED) / FORM.closes)


def cells_factor() -> float:
    """That factor, from maps on four and on eight cells."""
    terms, limits = [], []
    for number, kept in json.loads(GRID.read_text()).items():
        found = contact_of(
            nodes(spectrum_of(**surface(int(number))), PER_DECADE),
            np.array(kept["level"]),
        )
        some = found.area < SURE
        terms.append(of_cells(found.area, found.steep)[some])
        four, eight = np.array(kept["four"])[some], np.array(kept["eight"])[some]
        limits.append(4 / 3 * np.log(eight / four))
    x, y = np.concatenate(terms), np.concatenate(limits)
    return float(x @ y / (x @ x))


def on_fine_cells(maps: Maps, cells: float) -> Maps:
    """The flows that finer cells would have."""
    more = np.exp(cells * of_cells(maps.area, maps.steep))
    return maps._replace(flow=maps.flow * more, over_gap=maps.over_gap * more)


def fitted(maps: Maps, some: np.ndarray) -> LeakForm:
    """The constants from the points `some`."""
    columns = np.stack([np.ones(some.sum()), -np.log(maps.ideal[some])], -1)
    wanted = np.log(maps.gap / maps.ideal)[some]
    (level, bend), *_ = np.linalg.lstsq(columns, wanted, rcond=None)
    some = some & (maps.over_gap > 0) & (maps.area < FITTED)
    spread = np.hypot(FLOOR, np.minimum(maps.over_gap_error[some], MOST))
    truth = np.log(maps.over_gap[some])

    def off(x: np.ndarray) -> np.ndarray:
        form = FORM._replace(power=x[0], grows=x[1], leans=x[2])
        own = factor(maps.gap[some], maps.area[some], maps.steep[some], form)
        return (np.log(np.maximum(own, LEAST)) - truth) / spread

    power, grows, leans = least_squares(off, [2.5, 0.5, 0.0], loss="soft_l1").x
    return LeakForm(np.exp(level), bend, power, grows, leans)


def flow_of(maps: Maps, form: LeakForm) -> np.ndarray:
    gap = gap_of(maps.ideal, form)
    return gap**3 * factor(gap, maps.area, maps.steep, form)


def off_of(flow: np.ndarray, truth: np.ndarray) -> np.ndarray:
    """ln of a model over the maps; infinite where one of them is closed."""
    closed = (flow > 0) != (truth > 0)
    both = (flow > 0) & (truth > 0)
    ratio = np.where(both, flow, 1.0) / np.where(both, truth, 1.0)
    return np.where(closed, np.copysign(np.inf, flow - truth), np.log(ratio))


def quantile(values: np.ndarray, share: float = 0.95) -> float:
    """Of absolute values, infinite ones included."""
    values = np.sort(np.abs(values))
    return float(values[int(np.ceil(share * values.size)) - 1])


def by_contact(maps: Maps, off: np.ndarray, allowed: np.ndarray) -> list[tuple]:
    """How far form and theories are from maps, in bands of real contact."""
    rows = []
    for low, high in BANDS:
        band = (maps.area > low) & (maps.area <= high)
        if not band.any():
            continue
        theories = [
            float(np.exp(np.median(off_of(theory[band], maps.flow[band]))))
            for theory in maps.theories
        ]
        scatter = np.minimum(maps.error[band], MOST)
        rows.append(
            (
                f"{low:.2f} to {high:.2f}",
                int(band.sum()),
                int((maps.flow[band] == 0).sum()),
                float(np.median(off[band])),
                quantile(off[band], 0.68),
                quantile(off[band]),
                2 * float(np.sqrt(np.mean(scatter**2))),
                float(np.mean(np.abs(off[band]) <= allowed[band])),
                *theories,
            )
        )
    return rows


def main() -> None:
    cells = cells_factor()
    maps = on_fine_cells(read(), cells)
    count = np.unique(maps.surface).size
    record = heading(
        "The form of em.leak against three-dimensional maps",
        f"{count} surfaces, {maps.area.size} points",
    )
    record["cells"] = round(cells, 4)
    even = maps.surface % 2 == 0
    of_even, of_odd, of_all = (fitted(maps, s) for s in (even, ~even, even | ~even))
    forms = {"even": of_even, "odd": of_odd, "all": of_all, "in leak_form": FORM}
    record["constants"] = table(
        ("fitted to", *LeakForm._fields),
        [(name, *(round(float(x), 4) for x in form)) for name, form in forms.items()],
    )
    flow = np.where(even, flow_of(maps, of_odd), flow_of(maps, of_even))
    gap = np.where(even, gap_of(maps.ideal, of_odd), gap_of(maps.ideal, of_even))
    off, allowed = off_of(flow, maps.flow), log_bound(maps.area)
    record["held out"] = table(
        (
            "real contact",
            "points",
            "maps closed",
            "median ln",
            "68 % of |ln|",
            "95 % of |ln|",
            "of maps",
            "within bound",
            *(f"{name} over maps" for name in THEORIES),
        ),
        by_contact(maps, off, allowed),
    )
    light, middle = maps.area <= 0.15, (maps.area > 0.15) & (maps.area <= 0.25)
    bounded = np.isfinite(allowed)
    within = float(np.mean(np.abs(off) <= allowed, where=bounded))
    record["verdicts"] = [
        verdict("mean gap", quantile(np.log(gap / maps.gap)), np.log(1.07)),
        verdict("flow below 15 % contact", quantile(off[light]), np.log(1.3)),
        verdict("flow at 15 to 25 %", quantile(off[middle]), np.log(1.6)),
        verdict("share within a finite bound", within, 0.95, least=True),
    ]
    save("leak_fit", record)


if __name__ == "__main__":
    main()
