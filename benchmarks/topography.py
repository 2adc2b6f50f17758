"""How well `em.read_surface` recovers the known spectrum of synthetic maps and
profiles.

Gaussian self-affine surfaces of 256 x 256 points and profiles of 2048 points, Hurst
exponent 0.5, 0.7 and 0.9. The roll-off lies at an eighth of the scan's length, at its
length, or at four times that. Scans are "periodic"; "cut" out of a surface four times
as large, so that longer waves are in them; or "sampled" at every fourth point of one
four times as fine, so that shorter waves are folded back.

`python benchmarks/topography.py` takes two minutes.
"""

import numpy as np
from common import heading, save, table, verdict

import elastomdr as em

POINTS = {1: 2048, 2: 256}
# waves of it in the length of the scan
ROLLOFF = {"inside": 8.0, "at": 1.0, "outside": 0.25}
KINDS = ("periodic", "cut", "sampled")
HURST = (0.5, 0.7, 0.9)
SCANS = {1: 40, 2: 12}
SLOPE = 0.1  # between neighbours


def true(q, hurst, rolloff):
    """C of all these surfaces, up to a factor."""
    return np.maximum(q / rolloff, 1.0) ** (-2 - 2 * hurst)


def heights(dimensions, points, step, hurst, rolloff, seed):
    """A periodic Gaussian surface (or a straight cut of one) with <h^2> = int C d^2q
    over the waves of its grid.
    """
    white = np.fft.rfftn(
        np.random.default_rng(seed).standard_normal((points,) * dimensions)
    )
    short = 2 * np.pi * np.fft.rfftfreq(points, step)
    lowest = short[1]
    if dimensions == 2:
        q = np.hypot(2 * np.pi * np.fft.fftfreq(points, step)[:, None], short)
        c = true(q, hurst, rolloff)
    else:  # C_cut = 2 int_0^inf C(k cosh u) k cosh(u) du
        q, u = np.maximum(short, lowest / 10), np.linspace(0, 9, 300)
        fine = np.geomspace(q[0], q[-1], 400)
        values = [
            2 * np.trapezoid(true(k * np.cosh(u), hurst, rolloff) * k * np.cosh(u), u)
            for k in fine
        ]
        c = np.exp(np.interp(np.log(q), np.log(fine), np.log(values)))
    amplitude = np.sqrt(c * lowest**dimensions * points**dimensions)
    amplitude.flat[0] = 0
    return np.fft.irfftn(amplitude * white, (points,) * dimensions, range(dimensions))


def scan(dimensions, kind, hurst, waves, seed):
    """Heights, step, and the factor and roll-off of their C."""
    points = POINTS[dimensions]
    rolloff = 2 * np.pi / points * waves
    if kind == "periodic":
        height = heights(dimensions, points, 1.0, hurst, rolloff, seed)
    elif kind == "cut":
        height = heights(dimensions, 4 * points, 1.0, hurst, rolloff, seed)[
            (slice(100, 100 + points),) * dimensions
        ]
    else:
        height = heights(dimensions, 4 * points, 0.25, hurst, rolloff, seed)[
            (slice(None, None, 4),) * dimensions
        ]
    factor = SLOPE / np.diff(height, axis=0).std()
    return factor * height, 1.0, factor**2, rolloff


def recovered(dimensions, kind, hurst, waves, scans):
    """C over the true C, and ln of that over its stated error, each (scans, nodes)."""
    ratios, scores = [], []
    for seed in range(scans):
        height, step, factor, rolloff = scan(dimensions, kind, hurst, waves, seed)
        found = em.read_surface(height, pixel_size=step, shortest=4 * step)
        ratios.append(found.c / (factor * true(found.q, hurst, rolloff)))
        scores.append(np.log(ratios[-1]) / found.relative_error)
    return np.array(ratios), np.array(scores)


def main():
    record = heading(
        "Spectra of measured surfaces: recovered over true C",
        *__doc__.split("\n\n")[1].splitlines(),
    )
    rows = []
    for dimensions in (2, 1):
        for kind in KINDS:
            for name, waves in ROLLOFF.items():
                for hurst in HURST:
                    ratio, score = recovered(
                        dimensions, kind, hurst, waves, SCANS[dimensions]
                    )
                    log = np.log(ratio)
                    worst = np.exp(np.abs(log.mean(axis=0)).max()) - 1
                    rows.append(
                        (
                            "map" if dimensions == 2 else "profile",
                            kind,
                            name,
                            hurst,
                            ratio.mean(),
                            np.exp(log.mean()),
                            worst,
                            log.std(),
                            (score**2).mean() ** 0.5,
                        )
                    )
    columns = (
        "scan",
        "kind",
        "roll-off",
        "Hurst",
        "mean of ratio",
        "geometric mean",
        "worst band",
        "rms of ln",
        "rms of ln over stated error",
    )
    record["rows"] = table(columns, rows)
    print()
    record["verdicts"] = []
    for what in ("map", "profile"):
        of = [row for row in rows if row[0] == what]
        off = max(abs(row[5] - 1) for row in of)
        record["verdicts"].append(
            verdict(
                f"{what}s: geometric mean of C over the band off by",
                100 * off,
                15,
                " %",
            )
        )
        score = max(row[8] for row in of)
        record["verdicts"].append(
            verdict(f"{what}s: scatter over the stated error", score, 1.25)
        )
    save("topography", record)


if __name__ == "__main__":
    main()
