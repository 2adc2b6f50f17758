"""The constants of `em.Multiscale`, fitted to the solutions of `rough_truth.py`, how far
the form is from them, and the bound that follows.

    python benchmarks/rough_fit.py [--every 1]

Least squares on ln(mu/mu_3D) of all points whose friction moved by less than a tenth
from a grid half as fine; gamma and s, of the real contact, are of an older fit. Then
the surfaces are left out, a fourth at a time, and the materials: what is predicted for
a point without its surface or its material, whichever is worse, gives the bound that
`model_error` states, for 95 % of the points of each cell of (slope of the loss at
q_high) x (real contact). Persson's theory is compared with the same points. No figure
depends on a choice made here by hand but the form itself. `--every 10` tries all of it
on a tenth of the points in two minutes, and keeps nothing.
"""

import argparse
import itertools
import json
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from common import heading, save, table, verdict
from rough_truth import (
    FILE,
    MOVED,
    SLOPES,
    moved,
    rubber,
    slope_of_loss,
    surface_of,
    truth,
)
from scipy.optimize import least_squares

import elastomdr as em
from elastomdr.rough import multiscale
from elastomdr.rough.psd_integrals import nodes
from elastomdr.rough.random_maps import full_contact
from elastomdr.rough.road_model import RoadProblem, WaveProblem

BANDS = (0.0, 0.01, 0.05, 0.25, 0.75, 1.0)  # of real contact area
# of the form, beside the uncertainty of the truth: keeps single points from deciding
NOISE = 0.03
FITTED = ("ahead", "further", "excess", "stiffer", "narrow")
CELLS = 8  # of log q per decade: 1e-4 of mu
FOLDS = 4
FEW = 15  # points of a cell below which no bound is made of it alone
# areas of a third party (GFMD, as quoted in `docs/accuracy.md`): elastic, H = 0.8, cutoffs
# a factor of 100 apart, rms slope 0.2766
GFMD = (
    (1e-4, 0.00083),
    (1e-3, 0.00827),
    (0.005, 0.0399),
    (0.01, 0.0779),
    (0.015, 0.1147),
    (0.025, 0.1852),
    (0.04, 0.2846),
    (0.065, 0.4326),
    (0.086, 0.5403),
    (0.113, 0.6571),
    (0.147, 0.7719),
    (0.191, 0.8739),
    (0.24, 0.9406),
)


class Points:
    """The points of the record, with what each needs; arrays of shape (points,)."""

    def __init__(self, every: int = 1) -> None:
        record = [p for p in json.loads(FILE.read_text()) if p["mu"]][::every]
        self.all = len(record)
        self.truth, self.unsure = np.transpose([truth(p["mu"]) for p in record])
        self.area = np.array([truth(p["area"])[0] for p in record])
        self.surface = np.array([str(p["surface"]) for p in record])
        self.material = np.array([p["material"] for p in record])
        self.ratio = np.array([p["ratio"] for p in record], dtype=float)
        self.used = np.array([moved(p["mu"]) < MOVED for p in record])
        scenes, felt, slope, full, persson = [], [], [], [], []
        for p in record:
            kind, *numbers = p["surface"]
            surface = surface_of(kind, tuple(numbers), p["ratio"])
            body, local = rubber(p["material"]), multiscale.Local()
            modulus = body.complex_modulus
            at = np.array([p["velocity"]]), np.array([p["pressure"]])
            cells = nodes(surface, CELLS, multiscale.bends(surface, local))
            table = multiscale.table_of(modulus, cells, at[0], 32, local)
            scenes.append(WaveProblem(table, cells, *at))
            felt.append(multiscale.felt(body, surface, at[0]))
            slope.append(slope_of_loss(body, surface, p["velocity"]))
            full.append(full_contact(modulus, surface, *at)[0])
            persson.append(
                multiscale.solve(
                    em.Persson(), RoadProblem(body, surface, *at, rtol=1e-2)
                ).mu[0]
            )
        self.scenes = scenes
        self.felt = multiscale.Felt(*(np.ravel(x) for x in zip(*felt, strict=True)))
        self.slope, self.full = np.array(slope), np.array(full)
        self.mu = self.truth * self.full
        self.persson = np.log(np.array(persson) / self.mu)

    def cells(self) -> list[tuple[str, str, np.ndarray]]:
        """Each slope of the loss and each band of contact, and which points they
        have.
        """
        slopes = [low for low, _ in list(SLOPES.values())[1:]]
        of_slope = np.searchsorted(slopes, self.slope)
        return [
            (name, f"{low:.0%} to {high:.0%}", (of_slope == i) & within)
            for i, name in enumerate(SLOPES)
            for low, high in itertools.pairwise(BANDS)
            for within in [(self.area >= low) & (self.area < high)]
        ]

    def off(self, form: Any, chosen: Any = None) -> np.ndarray:
        """ln(mu/mu_3D) and ln(A/A_3D) of the chosen points, (2, points)."""
        chosen = range(self.mu.size) if chosen is None else chosen
        out = []
        for i in chosen:
            waves = multiscale.waves_of_multiscale(self.scenes[i], form)
            mu = waves.each.sum() + waves.edges[0]
            out.append((mu / self.mu[i], waves.area[0] / self.area[i]))
        return np.log(np.transpose(out))

    def fit(self, chosen: np.ndarray, start: Any) -> multiscale.Form:
        """The constants from the chosen points."""
        own = np.hypot(self.unsure[chosen], NOISE)

        def weighed(constants: np.ndarray) -> np.ndarray:
            form = start._replace(**dict(zip(FITTED, constants, strict=True)))
            return self.off(form, chosen)[0] / own

        found = least_squares(
            weighed, np.array([getattr(start, name) for name in FITTED]),
            loss="soft_l1", x_scale=0.3, diff_step=1e-3, xtol=1e-3, ftol=1e-4,
        )  # fmt: skip
        return start._replace(**dict(zip(FITTED, found.x.tolist(), strict=True)))

    def left_out(self, groups: np.ndarray, start: Any) -> np.ndarray:
        """`off` of each point by constants fitted without its group."""
        names = np.random.default_rng(0).permutation(np.unique(groups))
        off = np.empty((2, self.mu.size))
        for fold in range(FOLDS):
            own = np.isin(groups, names[fold::FOLDS])
            form = self.fit(np.flatnonzero(~own & self.used), start)
            off[:, own] = self.off(form, np.flatnonzero(own))
        return off


def drift_of(
    points: Points, off: np.ndarray, chosen: np.ndarray
) -> tuple[float, float]:
    """Slope of ln(mu/mu_3D) over log10 of the cutoff ratio at the same real contact,
    and its standard error.
    """
    columns = np.ones_like(off), np.log(points.area), np.log10(points.ratio)
    x, y = np.transpose(columns)[chosen], off[chosen]
    weight = 1 / np.hypot(points.unsure[chosen], NOISE)
    normal = np.linalg.inv((x.T * weight**2) @ x)
    best = normal @ (x.T * weight**2) @ y
    rest = (weight * (y - x @ best)) ** 2
    error = np.sqrt(normal[2, 2] * rest.sum() / (y.size - 3))
    return float(best[2]), float(error)


def rms(x: np.ndarray) -> float:
    return float(np.sqrt(np.mean(x**2))) if x.size else float("nan")


def rows_of(points: Points, off: np.ndarray) -> list[tuple]:
    """Points used and not, rms, mean and worst of those used: by slope of the loss and
    real contact, by cutoff ratio, above and below 1 % contact, and of all.
    """
    groups = [(f"{slope}, {area}", at) for slope, area, at in points.cells()]
    groups += [
        (f"cutoff ratio {r:g}", points.ratio == r) for r in np.unique(points.ratio)
    ]
    groups += [
        ("contact above 1 %", points.area >= 0.01),
        ("contact below 1 %", points.area < 0.01),
        ("all", points.area >= 0),
    ]
    return [
        (
            name,
            int(at[points.used].sum()),
            int(at[~points.used].sum()),
            *_figures(off[at & points.used]),
        )
        for name, at in groups
    ]


def _figures(off: np.ndarray) -> tuple[float, float, float]:
    if not off.size:
        return np.nan, np.nan, np.nan
    return rms(off), float(off.mean()), float(np.abs(off).max())


def bound_of(
    points: Points, off: np.ndarray, steep: bool
) -> tuple[float, float, float]:
    """a, b, c of |ln(mu/mu_3D)| <= shape (a - b ln A) (1 + c m^2), `shape` that of
    `multiscale.shape_of_bound`, that holds for 95 % of the points of each cell and of
    each cutoff ratio, with the least mean.
    """
    x = -np.log(np.maximum(points.area, multiscale._LEAST))
    near = multiscale.shape_of_bound(np.minimum(points.area, 0.99), points.ratio)
    ratios = np.minimum(points.ratio, multiscale._WIDE)
    groups = [at for *_, at in points.cells()]
    groups = [at & points.used for at in (*groups, *(ratios == r for r in set(ratios)))]
    groups = [at for at in groups if at.sum() >= FEW]
    best = (np.inf, 0.0, 0.0, 0.0)
    slopes = np.linspace(0.0, 3.0, 13) if steep else [0.0]
    for part, c in itertools.product(np.linspace(0.0, 1.0, 41), slopes):
        shape = near * (1 - part + part * x / 4) * (1 + c * points.felt.steep**2)
        size = max(
            np.quantile(np.abs(off[g]) / shape[g], 0.95, method="inverted_cdf")
            for g in groups
        )
        mean = float(np.mean(size * shape))
        a, b = size * (1 - part), size * part / 4
        best = min(best, (mean, float(a), float(b), float(c)))
    return best[1:]


def held_of(
    points: Points, off: np.ndarray, terms: tuple[float, float, float] | None
) -> dict[str, float]:
    """The share of the points of each cell that the stated bound covers."""
    within = np.abs(off) <= np.log1p(multiscale.bound(terms, points.area, points.felt))
    return {
        f"{slope}, {area}": float(np.mean(within[at & points.used]))
        for slope, area, at in points.cells()
        if (at & points.used).sum() >= FEW
    }


def areas_of_a_third_party() -> list[tuple]:
    """Real contact by the form over that of GFMD."""
    surface = em.SelfAffine(0.8, rms_slope=0.2766, q_low=1.0, q_high=100.0)
    elastic = em.Foundation(1.0, [1e-9], [1.0])
    rows = []
    for pressure, area in GFMD:
        curve = em.friction(
            elastic, surface, velocity=1e-6, pressure=pressure, rtol=1e-3
        )
        assert curve.area_ratio is not None
        found = float(curve.area_ratio)
        rows.append((pressure, area, found, found / area - 1))
    return rows


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--every", type=int, default=1)
    every = parser.parse_args().every
    points = Points(every)
    record = heading(
        "em.Multiscale against maps in three dimensions",
        f"{points.used.sum()} of {points.all} points (the others moved by more than "
        f"{MOVED:.0%} from a grid half as fine), {len(np.unique(points.surface))} "
        f"surfaces, {len(np.unique(points.material))} materials; uncertainty of the "
        f"truth {rms(points.unsure[points.used]):.3f} rms",
    )
    form = points.fit(np.flatnonzero(points.used), multiscale.FORM)
    print(f"fitted:         {form}\nin the package: {multiscale.FORM}")
    shipped, areas = points.off(multiscale.FORM)
    titles = ("points", "dropped", "rms", "mean", "worst")
    record["multiscale"] = table(("Multiscale", *titles), rows_of(points, shipped))
    record["persson"] = table(("Persson", *titles), rows_of(points, points.persson))
    record["area"] = table(("real contact", *titles), rows_of(points, areas))
    left_out = [points.left_out(g, form) for g in (points.surface, points.material)]
    worse, worse_area = np.where(np.abs(left_out[0]) > np.abs(left_out[1]), *left_out)
    record["left out"] = table(
        ("left out: the worse of surface and material", *titles),
        rows_of(points, worse),
    )
    each = [rms(off[0][points.used]) for off in left_out]
    print(f"left out: surfaces {each[0]:.3f} rms, materials {each[1]:.3f} rms")
    record["third party"] = table(
        ("p/E*", "A of GFMD", "A of the form", "off"), areas_of_a_third_party()
    )
    bounds = {
        "multiscale": bound_of(points, worse, steep=True),
        "persson": bound_of(points, points.persson, steep=True),
        "area": bound_of(points, worse_area, steep=False),
    }
    for name, (a, b, c) in bounds.items():
        print(
            f"{name}: |ln of the ratio| <= shape ({a:.4f} - {b:.4f} ln A) (1 + "
            f"{c:.2f} m^2) for 95 %"
        )
    for name, off in (("drift", shipped), ("drift of persson", points.persson)):
        wide = points.used & (points.area < 0.3) & (points.ratio >= 8)
        record[name] = drift_of(points, off, wide)
        slope, error = record[name]
        print(f"{name} per decade of the cutoff ratio: {slope:+.3f} +- {error:.3f}")
    record["constants"], record["bound"] = multiscale.FORM._asdict(), bounds
    record["fitted anew"] = anew(points, form, shipped)
    record["left out by"] = {"surfaces": each[0], "materials": each[1]}
    held = {
        "Multiscale": held_of(points, worse, em.Multiscale().bound_terms(False)),
        "Persson": held_of(points, points.persson, em.Persson().bound_terms(False)),
        "real contact": held_of(points, worse_area, em.Multiscale().bound_terms(True)),
    }
    record["share within the bound"] = held
    some = points.used & (points.area >= 0.01)
    light = points.used & (points.area < 0.01)
    third = max(abs(row[3]) for row in record_rows(record["third party"]))
    over = np.log(points.mu / points.full) + shipped
    record["verdicts"] = [
        verdict("rms above 1 % contact", rms(shipped[some]), 0.04),
        verdict("rms below 1 % contact", rms(shipped[light]), 0.08),
        verdict("worst", float(np.abs(shipped[points.used]).max()), 0.25),
        verdict("left out by surface, rms", each[0], 0.05),
        verdict("left out by material, rms", each[1], 0.055),
        verdict("rms over that of a new fit", record["fitted anew"]["rms over"], 1.1),
        verdict("ln of mu over that of full contact, most", float(over.max()), 0.002),
        verdict("drift per decade of the ratio", abs(record["drift"][0]), 0.01),
        verdict("real contact, rms", rms(areas[points.used]), 0.08),
        verdict("real contact over a third party's, worst", third, 0.04),
        verdict(
            "least share of a cell within the bound",
            min((s for shares in held.values() for s in shares.values()), default=1.0),
            0.95, least=True,
        ),
        verdict("points of the record", float(points.used.sum()), 500, least=True),
    ]  # fmt: skip
    figure = draw(points, shipped)
    if every == 1:
        save("rough_fit", record, figure)


def anew(points: Points, form: multiscale.Form, shipped: np.ndarray) -> dict[str, Any]:
    """How far the constants of a fit are from those of the package. They were rounded
    when the record had fewer points and stay while no fit is better by a twentieth.
    """
    off = points.off(form)[0][points.used]
    shipped = shipped[points.used]
    between = off - shipped
    return {
        **form._asdict(),
        "rms over": rms(shipped) / rms(off),
        "rms of mu between": rms(between),
        "most of mu between": float(np.abs(between).max()),
    }


def record_rows(rows: list[dict[str, Any]]) -> list[tuple]:
    return [tuple(row.values()) for row in rows]


def draw(points: Points, off: np.ndarray) -> Any:
    """Friction over that in three dimensions against the real area of contact, with the
    stated bounds, and against the cutoff ratio.
    """
    figure, axes = plt.subplots(
        1, 3, figsize=(11, 3.6), layout="constrained", sharey=True
    )
    area = np.geomspace(0.002, 1, 100)
    cases = (
        ("em.Multiscale", em.Multiscale(), off),
        ("em.Persson", em.Persson(), points.persson),
    )
    for axis, (name, model, found) in zip(axes, cases, strict=False):
        far = multiscale.bound(
            model.bound_terms(False),
            area,
            multiscale.Felt(64.0, *np.array([100.0, 0.4, 0.2])),
        )
        axis.fill_between(
            100 * area, 1 / (1 + far), 1 + far, color="#1f5a94", alpha=0.12, lw=0,
            label="stated bound, m = 0.4",
        )  # fmt: skip
        for low, high, marker, colour in (
            (2, 4, "v", "#8a6d1f"),
            (8, 16, "o", "#1f5a94"),
            (32, 64, "s", "#c23b22"),
            (128, 1024, "^", "#3a7d34"),
        ):
            at = (points.ratio >= low) & (points.ratio <= high) & points.used
            axis.plot(
                100 * points.area[at], np.exp(found[at]), marker, color=colour, ms=3.5,
                alpha=0.8, mec="none", label=f"cutoff ratio {low} to {high}",
            )  # fmt: skip
        axis.set(xscale="log", xlabel="real area of contact [%]", title=name)
    ratios = np.unique(points.ratio)
    for (name, _, found), colour, shift in zip(
        cases, ("#1f5a94", "#c23b22"), (0.96, 1.04), strict=True
    ):
        groups = [found[(points.ratio == ratio) & points.used] for ratio in ratios]
        middle = np.exp([g.mean() for g in groups])
        spread = [g.std() / np.sqrt(max(g.size - 1, 1)) for g in groups]
        axes[2].errorbar(
            shift * ratios, middle, np.array(spread) * middle, fmt="o-", color=colour,
            ms=4, lw=1, capsize=2, label=name,
        )  # fmt: skip
    axes[2].set(
        xscale="log", xlabel="cutoff ratio", title="mean over the points, +- its error"
    )
    axes[2].set_xticks(ratios, [f"{r:g}" for r in ratios])
    for axis in axes:
        axis.axhline(1, color="#8a8a8a", lw=0.8)
        axis.set_yscale("log")
        axis.set_yticks([0.5, 0.7, 1, 1.4, 2], ["0.5", "0.7", "1", "1.4", "2"])
        axis.minorticks_off()
    axes[0].set_ylabel("mu over mu in three dimensions")
    axes[1].legend(fontsize=7)
    axes[2].legend(fontsize=7)
    return figure


if __name__ == "__main__":
    main()
