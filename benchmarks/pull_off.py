"""Pull-off of a sticky ball from viscoelastic rubber: `em.indent(adhesion=)` against
boundary elements whose surfaces attract each other.

    python benchmarks/pull_off.py --seed 1 --scenes 30

Rings of constant pressure on a half-space (exact influence, elliptic integrals), each
with its whole memory, under the traction of Lennard-Jones between the surfaces, (8
w/3 e) [(e/g)^3 - (e/g)^9] at a gap g: no edge, no cutoff and no work of adhesion that
depends on a speed, and nothing shared with the package. Newton's method finds all gaps
after a step. The ball rests until all has relaxed, or is pressed on at the rate at which
it is then pulled off. `em.Adhesion` is told the strength, 1.026 w/e. Drawn: Prony series
of 1 to 3 branches, rates over four decades, the range e, the depth. Check: without
branches the pull is that of JKR, within what is known of this range.
"""

import argparse
from typing import NamedTuple

import numpy as np
from common import heading, save, table, verdict
from scipy.special import ellipe, ellipk

import elastomdr as em
from elastomdr.errors import quiet

RELAXED, RADIUS, WORK = 1e6, 1e-2, 0.05  # Pa, m, J/m^2
WIDTH = np.cbrt(np.pi * WORK * RADIUS**2 / RELAXED)
SCALE = WIDTH**2 / RADIUS  # depth of JKR
JKR = 1.5 * np.pi * WORK * RADIUS
STRENGTH = 8 / 3 * (3**-0.5 - 3**-1.5)  # of Lennard-Jones, over work/range
STEPS = 25  # to a depth of SCALE
_EXACT = 1e-9  # of the range


class Scene(NamedTuple):
    """A ball pressed and pulled; depths in SCALE, speeds in SCALE per second."""

    moduli: np.ndarray  # of the branches [Pa]
    times: np.ndarray  # [s]
    tabor: float  # SCALE over the range, over pi^(2/3)
    top: float
    rate: float
    rests: bool  # until all has relaxed, at the top

    @property
    def range(self) -> float:
        return SCALE / (np.pi ** (2 / 3) * self.tabor)

    def course(self) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and depths [m] of the steps after a rest at the first depth."""
        glassy = 1 + self.moduli.sum() / RELAXED
        low = -(glassy ** (2 / 3)) - 1
        down = np.arange(1, int((self.top - low) * STEPS) + 1) / STEPS
        up = np.arange(0 if self.rests else int((self.top - 1) * STEPS)) + 1
        depth = np.concatenate([1 + up / STEPS, self.top - down])
        start = self.top if self.rests else 1.0
        way = abs(np.diff(depth, prepend=start))
        return np.cumsum(way) / self.rate, np.append(start, depth) * SCALE


def drawn(rng: np.random.Generator) -> Scene:
    branches = rng.integers(1, 4)
    ratio = np.exp(rng.uniform(np.log(2), np.log(50)))
    share = rng.dirichlet(np.ones(branches))
    return Scene(
        (ratio - 1) * RELAXED * share,
        np.sort(10 ** rng.uniform(-2, 0, branches)),
        rng.uniform(2.2, 4.5),
        rng.uniform(3.1, 5),
        10 ** rng.uniform(-2, 2),
        bool(rng.integers(2)),
    )


def disc(r: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Displacement at r of unit pressure on discs b, of E* = 1."""
    m = (np.minimum(r, b) / np.maximum(r, b)) ** 2
    inner = 4 / np.pi * b * ellipe(m)
    outer = 4 / np.pi * r * (ellipe(m) - (1 - m) * ellipk(np.minimum(m, 1 - 1e-15)))
    return np.where(r < b, inner, outer)


def attraction(gap: np.ndarray, reach: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressure at gaps, negative where surfaces attract, and its slope."""
    x, most = reach / gap, 8 * WORK / (3 * reach)
    return most * (x**9 - x**3), most * (3 * x**3 - 9 * x**9) / gap


class Rings:
    """A ball over rings of a half-space, `cells` of them."""

    def __init__(self, scene: Scene, cells: int):
        self.scene = scene
        widest = (1.25 * np.sqrt(scene.top) + 0.4) * WIDTH
        edges = np.linspace(0, widest, cells + 1)
        self.r = 0.5 * (edges[1:] + edges[:-1])
        under = disc(self.r[:, None], edges[1:])
        self.influence = under - np.pad(under[:, :-1], ((0, 0), (1, 0)))
        self.area = np.pi * np.diff(edges**2)
        self.height = self.r**2 / (2 * RADIUS)

    def gap(
        self,
        free: np.ndarray | float,
        stiffness: float,
        depth: float,
        guess: np.ndarray,
        reach: float,
    ) -> np.ndarray | None:
        """Gaps g = height - depth + free + K p(g)/S; None where none is found."""
        base = self.height - depth + free
        compliance = self.influence / stiffness

        def missing(gap: np.ndarray) -> np.ndarray:
            return gap - base - compliance @ attraction(gap, reach)[0]

        gap, left = guess, missing(guess)
        for _ in range(40):
            if abs(left).max() < _EXACT * reach:
                return gap
            slope = np.eye(gap.size) - compliance * attraction(gap, reach)[1]
            step = np.linalg.solve(slope, left)
            tried = []
            for part in 0.5 ** np.arange(8):
                new = np.clip(gap - part * step, 0.8 * gap, 1.5 * gap + 0.3 * reach)
                tried.append((new, missing(new)))
                size = np.linalg.norm(tried[-1][1])
                if size < (1 - 0.1 * part) * np.linalg.norm(left):
                    break
            gap, left = min(tried, key=lambda pair: np.linalg.norm(pair[1]))
        return None

    def at_rest(self, depth: float) -> np.ndarray | None:
        """Gaps on relaxed rubber: from those of Hertz, the range being shortened."""
        a, reach = np.sqrt(RADIUS * depth), 3 * self.scene.range
        inside = np.minimum(a / self.r, 1)
        hertz = (2 * a**2 - self.r**2) * np.arcsin(inside)
        hertz += self.r * a * np.sqrt(1 - inside**2)
        gap = np.maximum(self.height - depth + hertz / (np.pi * RADIUS), 0) + reach
        before = reach
        for reach in np.geomspace(before, self.scene.range, 9):
            guess = np.where(gap < 2 * before, gap * reach / before, gap)
            found = self.gap(0.0, RELAXED, depth, guess, reach)
            if found is None:
                return None
            gap, before = found, reach
        return gap

    def pull(self) -> float:
        """Largest pull [N] until the ball jumps off; NaN where its start or a
        step before was not solved.
        """
        scene = self.scene
        time, depth = scene.course()
        gap, now, place = self.at_rest(depth[0]), 0.0, depth[0]
        if gap is None:
            return np.nan
        u, f = gap - self.height + place, np.zeros((gap.size, scene.times.size))
        ahead = [*zip(time, depth[1:], np.full(time.size, 2), strict=True)][::-1]
        least = 0.0
        while ahead:
            end, after, halvings = ahead.pop()
            y = (end - now) / scene.times
            gain = scene.moduli * -np.expm1(-y) / y
            stiffness = RELAXED + gain.sum()
            left = f * np.exp(-y)
            free = u - (RELAXED * u + left.sum(axis=1)) / stiffness
            guess = np.maximum(gap - (after - place), 0.9 * gap)
            found = self.gap(free, stiffness, after, guess, scene.range)
            if found is None and halvings:
                middle = 0.5 * (now + end), 0.5 * (place + after), halvings - 1
                ahead += [(end, after, halvings - 1), middle]
                continue
            if found is None:
                return -least if least < -JKR else np.nan
            moved = found - self.height + after - u
            u, f = u + moved, left + gain * moved[:, None]
            force = float(self.area @ attraction(found, scene.range)[0])
            if least < -0.5 * JKR and force > 0.3 * least:
                break
            gap, now, place = found, end, after
            least = min(least, force)
        return -least


def compared(scene: Scene, cells: int) -> tuple[float, float, float, float]:
    """Pull of the rings and of `em.indent` over that of JKR, zone over radius, and
    `model_error`.
    """
    time, depth = scene.course()
    rested = 1e9 * scene.times.max()
    found = em.indent(
        em.Foundation(RELAXED, scene.moduli, scene.times),
        em.Paraboloid(RADIUS),
        time=np.append(0.0, rested + np.append(0.0, time)),
        depth=np.append(depth[0], depth),
        adhesion=em.Adhesion(WORK, strength=STRENGTH * WORK / scene.range),
    )
    zone = found.zone_ratio[np.nanargmin(found.force)]
    ours = -found.pull_off.force / JKR
    rings = Rings(scene, cells).pull()
    return rings / JKR, float(ours), float(zone), float(found.model_error[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=30)
    parser.add_argument("--cells", type=int, default=160)
    given = parser.parse_args()
    record = heading(
        "Pull-off of a ball against boundary elements with Lennard-Jones attraction",
        f"{given.scenes} drawn scenes of seed {given.seed}, {given.cells} rings",
    )
    rng, rows = np.random.default_rng(given.seed), []
    for _ in range(given.scenes):
        scene = drawn(rng)
        with quiet():
            found = compared(scene, given.cells)
        ratio = 1 + scene.moduli.sum() / RELAXED
        way = "rest" if scene.rests else "press"
        rows.append((way, ratio, scene.tabor, scene.rate, *found))
    record["scenes"] = table(
        (
            "before",
            "E_inf/E_0",
            "Tabor",
            "rate [D/s]",
            "rings",
            "em.indent",
            "zone",
            "bound",
        ),
        rows,
    )
    rings, ours, zone, bound = np.array([row[4:] for row in rows]).T
    solved = np.isfinite(rings)
    record["solved"] = int(solved.sum())
    print(f"  {record['solved']} of {given.scenes} scenes solved by the rings")
    rings, ours, zone, bound = (x[solved] for x in (rings, ours, zone, bound))
    off = np.log(ours / rings)
    classes = []
    for low, high in ((0, 0.15), (0.15, 0.25), (0.25, 0.5), (0.5, 1), (1, np.inf)):
        within = (zone >= low) & (zone < high)
        if within.any():
            some = off[within]
            rms, worst = np.sqrt(np.mean(some**2)), some[abs(some).argmax()]
            classes.append((f"{low:g} to {high:g}", some.size, rms, worst))
    record["zones"] = table(
        ("zone over radius", "scenes", "rms of ln(pull)", "worst"), classes
    )
    known = np.isfinite(bound)
    covered = abs(ours / rings - 1)[known] <= bound[known]
    record["verdicts"] = [
        verdict(
            "share of the bounds that hold", float(covered.mean()), 0.95, least=True
        )
    ]
    save("pull_off", record)


if __name__ == "__main__":
    main()
