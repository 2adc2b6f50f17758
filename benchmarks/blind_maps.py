"""Whether `model_error` holds for small measured maps that are not Gaussian: maps that no
constant was fitted to, drawn and worn in five ways, each solved over itself.

    python benchmarks/blind_maps.py        # 150 maps, some 3 minutes

`em.read_surface` is given the heights as an instrument would; `em.HalfSpace()` of that
surface is the truth.
"""

import warnings

import numpy as np
from common import heading, save, table, verdict
from non_gaussian import RUBBERS

import elastomdr as em
from elastomdr.rough.surface import _CHANCE as CHANCE
from elastomdr.rough.surface import _of_skewness

MAPS, PER_WAVE = 150, 4
COLUMNS = ["kind", "contact", "skewness", "error", "truth", "model", "bound", "covered"]
COLUMNS += ["covered if chance is none"]


def worn(kind: str, height: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Heights of which something has become of the summits or the valleys."""
    rms = height.std()
    if kind == "low summits":
        cut = rng.uniform(-0.5, 1) * rms
        return np.where(
            height > cut, cut + rng.uniform(0.05, 0.6) * (height - cut), height
        )
    if kind == "cut off":
        return np.minimum(height, rng.uniform(0.3, 1.5) * rms)
    if kind == "rounded":
        cut = rng.uniform(0, 1) * rms
        low = cut + 0.2 * rms * np.tanh((height - cut) / (0.2 * rms))
        return np.where(height > cut, low, height)
    sharper = {"pits": -rng.uniform(0.1, 0.6), "peaks": rng.uniform(0.1, 0.4)}.get(kind)
    return (
        height if sharper is None else np.expm1(sharper * height / rms) * rms / sharper
    )


def one(rng: np.random.Generator) -> list | None:
    """One map, measured and slid over; None where it cannot be."""
    periods, ratio = int(rng.choice([2, 3, 4])), 8 * int(rng.choice([1, 2]))
    cells = PER_WAVE * periods * ratio
    road = em.SelfAffine(rng.uniform(0.4, 0.95), 0.3, 1e3, 1e3 * ratio)
    seed = int(rng.integers(1_000_000))
    height, side = em.reference.rough_map(road, seed, periods=periods, points=cells)
    kind = str(
        rng.choice(["Gaussian", "low summits", "cut off", "rounded", "pits", "peaks"])
    )
    surface = em.read_surface(worn(kind, height, rng), pixel_size=side / cells)
    rubber = RUBBERS[str(rng.choice(list(RUBBERS)))]
    velocity = 10 ** rng.uniform(-3, 0)
    stiffness = abs(rubber.complex_modulus(np.array(1e3 * velocity)))
    pressure = float(stiffness * surface.rms_slope * 10 ** rng.uniform(-2.5, -0.3))
    at = {"velocity": velocity, "pressure": pressure}
    truth = em.friction(rubber, surface, **at, model=em.HalfSpace(), rtol=1e-2)
    curve = em.friction(rubber, surface, **at)
    if not truth.converged or not truth.mu > 0:
        return None
    off = abs(truth.mu - curve.mu)
    numbers = truth.area_ratio, surface.skewness, surface.skewness_error
    numbers += truth.mu, curve.mu, curve.model_error
    # the same bound, of a skewness that chance may explain taken for none
    narrow = curve.model_error
    if abs(surface.skewness) < CHANCE * surface.skewness_error:
        narrow = narrow - curve.mu * np.expm1(_of_skewness(surface, curve.area_ratio))
    covered = bool(off <= curve.model_error), bool(off <= narrow)
    return [kind, *map(float, numbers), *covered]


def main() -> None:
    warnings.simplefilter("ignore")
    record = heading("Bounds of small maps, worn or not", f"{MAPS} maps")
    rng = np.random.default_rng(6)
    rows = [row for row in (one(rng) for _ in range(MAPS)) if row is not None]
    record["points"] = rows
    kinds = sorted({row[0] for row in rows})
    shares = [
        (kind, len(of_kind), float(np.mean([row[-2] for row in of_kind])))
        for kind in kinds
        for of_kind in [[row for row in rows if row[0] == kind]]
    ]
    record["columns"] = COLUMNS
    record["table"] = table(("kind", "maps", "covered"), shares)
    share, narrow = (float(np.mean([row[i] for row in rows])) for i in (-2, -1))
    record["if chance is none"] = narrow
    print(f"  of {len(rows)} maps {narrow:.0%} if a skewness by chance counts as none")
    record["verdicts"] = [verdict("maps within the bound", share, 0.95, least=True)]
    save("blind_maps", record)


if __name__ == "__main__":
    main()
