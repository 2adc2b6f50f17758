"""A squeezed rubber cord by finite elements: `python benchmarks/o_ring_fe.py`.

Plane strain, neo-Hookean and incompressible (bulk modulus 1e4 G), between rigid walls
without friction: W = (G/2)(tr F^T F - 3) + p (J - 1) - p^2/(2 K), displacements by
quadrilaterals of nine nodes, pressures linear in each, which is stable for
incompressible solids. A quarter of the cord, by symmetry. The wall is a penalty on the
nodes of the surface; its stiffness and the mesh are doubled for the error. The table
compares the load per length with Lindley's formula, as `em.o_ring` has it, and with
Hertz' at small strain, and the width of the contact with sqrt(8 W d/(pi E*)).
"""

import itertools
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from common import heading, save, table, verdict
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

import elastomdr as em

SQUEEZES = (0.02, 0.05, 0.08, 0.10, 0.15, 0.20, 0.25, 0.30)
BULK = 1e4  # over G
STEP = 0.02  # of the squeeze from one solution to the next


def mesh(n: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Nodes of a quarter of the unit disc, elements of nine nodes, nodes of its surface
    and the lengths that these stand for.
    """
    m = 2 * n + 1
    u, v = np.meshgrid(np.linspace(0, 1, m), np.linspace(0, 1, m), indexing="ij")
    # from a square to the disc
    nodes = np.stack([u * np.sqrt(1 - v**2 / 2), v * np.sqrt(1 - u**2 / 2)], -1)
    number = np.arange(m * m).reshape(m, m)
    elements = [
        number[i : i + 3, j : j + 3].ravel()
        for i, j in itertools.product(range(0, m - 1, 2), repeat=2)
    ]
    rim = np.concatenate([number[:, -1], number[-1, -2::-1]])  # from the top down
    place = nodes.reshape(-1, 2)[rim]
    length = np.zeros(rim.size)
    for k in range(0, rim.size - 1, 2):  # Simpson's rule on each side of an element
        side = np.linalg.norm(np.diff(place[k : k + 3], axis=0), axis=1).sum()
        length[k : k + 3] += side * np.array([1, 4, 1]) / 6
    return nodes.reshape(-1, 2), np.array(elements), rim, length


def _shape() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Slopes of the nine functions at the nine points of Gauss, (points, 9, 2), the
    weights, and where the points are.
    """

    def line(x: Any) -> Any:
        return np.array([0.5 * x * (x - 1), 1 - x * x, 0.5 * x * (x + 1)])

    def slope(x: Any) -> Any:
        return np.array([x - 0.5, -2 * x, x + 0.5])

    g, w = np.polynomial.legendre.leggauss(3)
    slopes, weights, places = [], [], []
    for (a, wa), (b, wb) in itertools.product(zip(g, w, strict=True), repeat=2):
        slopes.append(
            np.stack(
                [
                    np.outer(slope(a), line(b)).ravel(),
                    np.outer(line(a), slope(b)).ravel(),
                ],
                -1,
            )
        )
        weights.append(wa * wb)
        places.append((a, b))
    return np.array(slopes), np.array(weights), np.array(places), line(g)


SLOPES, WEIGHTS, PLACES, _ = _shape()


def energy(own: Any, corners: Any) -> Any:
    """Of one element, over G: displacements (9, 2), the three numbers of the pressure
    and the strain along the cord, flat.
    """
    moved, pressure, along = own[:18].reshape(9, 2), own[18:21], 1 + own[21]
    total = 0.0
    for slope, weight, (a, b) in zip(SLOPES, WEIGHTS, PLACES, strict=True):
        jacobian = corners.T @ slope
        grown = slope @ jnp.linalg.inv(jacobian)
        f = jnp.eye(2) + moved.T @ grown
        volume = jnp.linalg.det(f) * along
        p = pressure[0] + a * pressure[1] + b * pressure[2]
        stored = 0.5 * (jnp.sum(f * f) + along**2 - 3) - jnp.log(volume)
        stored = stored + p * (volume - 1) - p * p / (2 * BULK)
        total = total + weight * jnp.linalg.det(jacobian) * stored
    return total


FORCES = jax.jit(jax.vmap(jax.grad(energy)))
TANGENTS = jax.jit(jax.vmap(jax.hessian(energy)))


def squeeze(
    n: int, stiff: float, squeezes: tuple[float, ...], free_along: bool
) -> list[tuple[float, ...]]:
    """Load per length over G d and width over d at each squeeze; the cord keeps its
    length, or is `free_along` it: no force acts there.
    """
    nodes, elements, rim, length = mesh(n)
    count = nodes.shape[0]
    size = 2 * count + 3 * len(elements) + 1
    places = np.concatenate(
        [
            (2 * elements[:, :, None] + np.arange(2)).reshape(len(elements), 18),
            2 * count + 3 * np.arange(len(elements))[:, None] + np.arange(3),
            np.full((len(elements), 1), size - 1),
        ],
        axis=1,
    )
    rows = np.repeat(places, 22, axis=1).ravel()
    columns = np.tile(places, (1, 22)).ravel()
    held = np.concatenate(
        [
            2 * np.flatnonzero(nodes[:, 0] == 0),
            2 * np.flatnonzero(nodes[:, 1] == 0) + 1,
            [] if free_along else [size - 1],
        ]
    )
    free = np.setdiff1d(np.arange(size), held.astype(int))
    corners = nodes[elements]
    state, done, at, found = np.zeros(size), 0.0, 2 * rim + 1, []
    while len(found) < len(squeezes):
        done = min(done + STEP, squeezes[len(found)])
        wall = 1 - done
        for _ in range(40):
            over = nodes[rim, 1] + state[at] - wall
            touching = over > 0
            force = np.zeros(size)
            np.add.at(force, places.ravel(), np.ravel(FORCES(state[places], corners)))
            push = np.where(touching, stiff * length * over, 0.0)
            np.add.at(force, at, push)
            tangent = np.ravel(TANGENTS(state[places], corners))
            extra = np.where(touching, stiff * length, 0.0)
            matrix = coo_matrix(
                (
                    np.concatenate([tangent, extra]),
                    (np.concatenate([rows, at]), np.concatenate([columns, at])),
                ),
                (size, size),
            ).tocsc()
            change = spsolve(matrix[free][:, free], -force[free])
            state[free] += change
            if np.abs(change[: 2 * count - 2 * n]).max() < 1e-11:
                break
        else:
            raise RuntimeError(f"no equilibrium at {done}")
        if done >= squeezes[len(found)] - 1e-12:
            load = 2 * push.sum()  # both halves
            x = nodes[rim, 0] + state[2 * rim]
            last = np.flatnonzero(push > 0)[-1]
            # the pressure falls to zero like a root: its square is straight
            p = (push / length)[last - 1 : last + 1] ** 2
            edge = x[last] + p[1] * (x[last] - x[last - 1]) / max(p[0] - p[1], 1e-300)
            edge = min(edge, x[last + 1])
            largest = (push / length).max() / (load / (2 * edge))
            bulge = 1 + state[2 * rim[-1]]
            found.append((load / 2, edge, largest, bulge))  # over G d, d, mean, d
    return found


def main() -> None:
    record = heading(
        "A squeezed cord by finite elements",
        "plane strain (held) or without force along the cord (free), neo-Hookean, "
        "incompressible, no friction at the walls",
    )
    titles = (
        "squeeze",
        "W/(E d)",
        "change by mesh and penalty",
        "Lindley's over it",
        "em.o_ring's load over it",
        "2a/d",
        "em.o_ring's width over it",
        "largest over mean pressure",
        "width of the cord over d",
    )
    every: list[tuple] = []
    rubber = em.Prony(3.0, [], [])  # E is 9 Pa
    for free_along in (False, True):
        name = "free" if free_along else "held"
        with jax.enable_x64(True):
            coarse, fine, soft = (
                squeeze(n, stiff, SQUEEZES, free_along)
                for n, stiff in ((8, 4e3), (14, 4e3), (14, 1e3))
            )
        rows = []
        for c, (w, a, largest, bulge), less, softer in zip(
            SQUEEZES, fine, coarse, soft, strict=True
        ):
            load = w / 3  # over E d
            off = abs(less[0] / w - 1) + abs(softer[0] / w - 1)
            ring = em.o_ring(rubber, 1.0, c, formula=name)
            ours = float(ring.line_load) / 9 / load, float(ring.width) / a
            lindley = (1.25 * c**1.5 + 50 * c**6) / load
            rows.append((c, load, off, lindley, ours[0], a, ours[1], largest, bulge))
        print(name)
        record[name] = table(titles, rows)
        every += rows
    record["verdicts"] = [
        verdict("load by mesh and penalty", max(r[2] for r in every), 0.02),
        verdict(
            "load of em.o_ring off finite elements",
            max(abs(r[4] - 1) for r in every),
            0.01,
        ),
        verdict(
            "width of em.o_ring off finite elements, from 5 %",
            max(abs(r[6] - 1) for r in every if r[0] >= 0.05),
            0.08,
        ),
    ]
    save("o_ring_fe", record)


if __name__ == "__main__":
    main()
