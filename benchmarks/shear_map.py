"""Stick and slip under a ball that does not roll: `em.shear` against a half-space in
three dimensions.

    python benchmarks/shear_map.py --seed 1 --scenes 40

The elements of `em.shear` slip along the motion of the body only (Cattaneo, Mindlin).
Here each place has two tractions of at most mu p, which pull against its
slip: tangential influence of Boussinesq and Cerruti at Poisson's ratio nu (that of
`traction_map.py`), marched in steps. Drawn: nu from 0 to 1/2; displacements that turn
round at random; elastic under loads that change at random too, or a Prony series under a
depth that is put on at once and kept, so that p(r, t) follows E(t). Normal and
tangential loading do not influence each other, exact for nu = 1/2. Checks: stick alone
is 2 a G* U, all slip mu F_N.
"""

import argparse
from typing import NamedTuple

import numpy as np
from common import heading, save, table, verdict
from traction_map import _half_space, _within

import elastomdr as em
from elastomdr.errors import quiet

MU = 0.5  # of friction
# `model_error` of `em.shear`: of the largest mu F, of the largest force so far
BOUND = 0.01, 0.04
CORNERS, STEPS = 5, 8  # of a history, and steps between two of them


class Scene(NamedTuple):
    """A unit ball on a half-space, histories at (CORNERS + 1) instants."""

    nu: float
    moduli: np.ndarray  # of G [Pa]
    times: np.ndarray
    radius: np.ndarray  # of contact at the corners [m]; one throughout with memory
    slid: np.ndarray  # U over that at which all of the relaxed contact slips


def drawn(rng: np.random.Generator, memory: bool) -> Scene:
    branches = rng.integers(1, 4) if memory else 0
    radius = rng.uniform(0.5, 1, CORNERS + 1)
    return Scene(
        rng.uniform(0, 0.5),
        np.exp(rng.uniform(np.log(0.3), np.log(10), branches)),
        CORNERS * 10 ** rng.uniform(-1.5, 0.5, branches),
        np.ones(CORNERS + 1) if memory else radius / radius.max(),
        np.append(0.0, rng.uniform(-1.5, 1.5, CORNERS)),
    )


def course(scene: Scene) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Instants, loads over the largest, and displacements as `Scene.slid`."""
    corners = np.arange(CORNERS + 1)
    time = np.linspace(0, CORNERS, CORNERS * STEPS + 1)
    load = np.interp(time, corners, scene.radius**3)
    return time, load, np.interp(time, corners, scene.slid)


def in_three_dimensions(scene: Scene, cells: int) -> np.ndarray:
    """F_x/(mu F) at all instants, with F the largest normal force: mu p_0 = 1 there, of
    a contact of radius 1, all of which slips at U = (pi/2) mu p_0/G*.
    """
    time, load, slid = course(scene)
    x = (np.arange(cells) + 0.5) * (2 / cells) - 1
    place = np.hypot(x[:, None], x)
    influence, kernel = _half_space(cells, scene.nu), (2 - scene.nu) / 4
    largest, mode = 1.0, np.random.default_rng(0).normal(size=(2, cells, cells))
    for _ in range(30):
        mode = influence(mode)[:, :cells]
        largest = np.linalg.norm(mode)
        mode /= largest
    q, u = np.zeros((2, cells, cells)), np.zeros((2, cells, cells))
    f = np.zeros((scene.times.size, *u.shape))
    whole, forces = np.sqrt(np.maximum(1 - place**2, 0)).sum(), [0.0]
    most = 1 + scene.moduli.sum()
    for i in range(1, time.size):
        h = time[i] - time[i - 1]
        left = np.exp(-h / scene.times)
        gain = scene.moduli * (1 - left) * scene.times / h
        stiffness = 1 + gain.sum()
        rest = u + np.tensordot(left, f, 1)  # traction that is left without motion
        move = np.array([slid[i] - slid[i - 1], 0.0]) * np.pi / 2 * kernel / most
        a = np.cbrt(load[i])
        relaxing = (1 + scene.moduli @ np.exp(-time[i] / scene.times)) / most
        limit = np.sqrt(np.maximum(a**2 - place**2, 0)) * relaxing
        stuck = place < a
        wanted = u + move[:, None, None]
        # q with influence(q) = rest + S (u_new - u), u_new as wanted where it sticks
        goal = (rest + stiffness * (wanted - u)) * stuck
        q = _within(lambda q: influence(q), goal, limit, q * stuck, 0.95 / largest)
        new = u + (influence(q)[:, :cells] - rest) / stiffness
        f = left[:, None, None, None] * f + gain[:, None, None, None] * (new - u)
        u = new
        forces.append(q[0].sum() / whole)
    return np.array(forces)


def of_elements(scene: Scene) -> em.Shear:
    """The same contact by `em.shear`."""
    time, load, slid = course(scene)
    normal, tangential = 2 / (1 - scene.nu), 4 / (2 - scene.nu)
    most = 1 + scene.moduli.sum()
    radius = MU * 2 * normal * most / np.pi
    largest = 4 / 3 * normal / radius
    pressed = {"depth": 1 / radius} if scene.times.size else {"load": largest * load}
    return em.shear(
        em.Foundation(normal, normal * scene.moduli, scene.times, per_area=False),
        em.Paraboloid(radius),
        time=time,
        displacement=slid * np.pi / 2 / tangential / most,
        friction=MU,
        tangential=em.Foundation(tangential, tangential * scene.moduli, scene.times),
        elements=2_000,
        **pressed,
    )


def compared(scene: Scene, cells: int) -> tuple[float, float]:
    """Largest distance of the force from three dimensions over mu F, F the largest
    normal force, and over the largest force so far.
    """
    found = of_elements(scene)
    force = found.force / (MU * found.normal_force.max())
    off = abs(force - in_three_dimensions(scene, cells))[1:]
    return float(off.max()), float((off / np.maximum.accumulate(abs(force))[1:]).max())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=40)
    parser.add_argument("--cells", type=int, default=24)
    given = parser.parse_args()
    record = heading(
        "Tangential force of a ball against a half-space in three dimensions",
        f"{given.scenes} drawn histories of seed {given.seed}, {given.cells} cells",
    )
    rng, rows = np.random.default_rng(given.seed), []
    for i in range(given.scenes):
        scene = drawn(rng, memory=bool(i % 2))
        with quiet():
            rows.append((scene.nu, scene.times.size, *compared(scene, given.cells)))
    header = ("nu", "branches", "off by, of mu F", "of the largest so far")
    record["scenes"] = table(header, rows)
    _, branches, off, share = np.array(rows).T
    within = (off <= BOUND[0]) & (share <= BOUND[1])
    for name, some in (("elastic", branches == 0), ("memory", branches > 0)):
        ends = (np.quantile(x[some], 0.95) for x in (off, share))
        print(
            "  {}: 95 % within {:.4f} mu F, {:.4f} of the largest".format(name, *ends)
        )
    record["verdicts"] = [
        verdict(
            "share of the bounds that hold",
            float(within.mean()),
            0.95,
            least=True,
        )
    ]
    save("shear_map", record)


if __name__ == "__main__":
    main()
