"""Rolling with creepage: the brush of `em.traction` against surfaces whose places all
know of each other.

    python benchmarks/traction_map.py --seed 1 --scenes 40

A ball on an elastic half-space in three dimensions (nu as given), and a cylinder on an
elastic, incompressible, bonded layer in plane strain, drawn. Both are marched until
steady: in each step the rubber moves on by a cell, places stick where that needs less
than mu p, and slip against the slip elsewhere. Normal and tangential loading do not
influence each other, which is exact for nu = 1/2. Checks: Kalker's coefficients C_11 of
a ball (3.40, 4.12, 5.20 at nu = 0, 1/4, 1/2, of the combined modulus 1/G = 1/(2 G_1) of
a rigid and an elastic body), Carter's cylinder. Prints the numbers of docs/accuracy.md.
"""

import argparse
import functools

import numpy as np
from scipy.linalg import toeplitz

import elastomdr as em
from elastomdr.arrays import numpy_unless_traced
from elastomdr.call.problem import Asked
from elastomdr.numerics.quadrature import gauss_on_panels
from elastomdr.smooth.cylinder import cylinder_pressure
from elastomdr.smooth.problem import SmoothCall
from elastomdr.tyre.brush import shear_compliance

ZETA = (0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7)


def ball(nu: float, zetas, cells: int = 24, turns: float = 4.0) -> np.ndarray:
    """F_x/(mu F_N) of a ball on a half-space at zeta = xi R G*/(2 a mu E*)."""
    x = (np.arange(cells) + 0.5) * (2 / cells) - 1
    radius = np.hypot(x[:, None], x)
    limit = np.sqrt(np.maximum(1 - radius**2, 0))  # mu p, G = a = 1
    displaced = _half_space(cells, nu)
    # the longest step that descends, by power iteration
    shape = (2, cells, cells)
    largest, mode = 1.0, np.random.default_rng(0).normal(size=shape)
    for _ in range(30):
        mode = displaced(mode)[:, :cells]
        largest = np.linalg.norm(mode)
        mode /= largest
    forces = []
    for zeta in zetas:
        # mu p_0 = 1 = mu E* 2 a/(pi R), so that xi = zeta pi/G*
        ahead = zeta * np.pi * (2 - nu) / 4 * (2 / cells)
        q = np.zeros(shape)
        for _ in range(int(turns * cells)):
            wanted = displaced(q)[:, 1:] + np.array([ahead, 0.0])[:, None, None]
            q = _within(displaced, wanted, limit, q, 0.95 / largest)
        forces.append(q[0].sum() / limit.sum())
    return np.array(forces)


def _half_space(cells: int, nu: float):
    """u [with a column of cells ahead] of tractions on square cells, times G."""
    dx = 2 / cells
    n = np.arange(-cells, cells + 1) * dx
    x, y = np.broadcast_arrays(n[:, None], n)
    kernels = np.zeros((3, *x.shape))
    middle, near = (x == 0) & (y == 0), (abs(x) < 3.5 * dx) & (abs(y) < 3.5 * dx)
    for where, panels in ((~near, 1), (near & ~middle, 4)):
        place, weight = gauss_on_panels(np.linspace(-0.5, 0.5, panels + 1) * dx, 4)
        for at, w in zip(place, weight, strict=True):
            for beside, w_beside in zip(place, weight, strict=True):
                a, b = x[where] - at, y[where] - beside
                r = np.hypot(a, b)
                parts = (
                    (1 - nu) / r + nu * np.array([a**2, b**2, a * b]) / r**3
                ).copy()
                parts[2] -= (1 - nu) / r
                kernels[:, where] += w * w_beside * parts
    # int 1/r over the square, half of which is int x^2/r^3
    kernels[:2, middle] = (1 - nu / 2) * 4 * dx * np.log(1 + np.sqrt(2))
    size, index = 3 * cells, np.arange(-cells, cells + 1) % (3 * cells)
    wide = np.zeros((3, size, size))
    wide[:, index[:, None], index] = kernels / (2 * np.pi)
    along, across, both = np.fft.rfft2(wide)

    def displaced(q):
        fx, fy = np.fft.rfft2(q, (size, size))
        u = np.fft.irfft2(
            [along * fx + both * fy, both * fx + across * fy], (size,) * 2
        )
        return u[:, : cells + 1, :cells]

    return displaced


def _within(displaced, wanted, limit, q, step):
    """Tractions of at most the limit that displace a surface as wanted where they are
    less, and pull against its slip elsewhere: accelerated projected descent.
    """
    ahead, momentum = q, 1.0
    for _ in range(300):
        new = ahead - step * (displaced(ahead)[:, : limit.shape[0]] - wanted)
        size = np.hypot(*new)
        new = new * np.where(size > limit, limit / np.where(size > 0, size, 1.0), 1.0)
        if np.sum((ahead - new) * (new - q)) > 0:
            momentum = 1.0
        later = 0.5 * (1 + np.sqrt(1 + 4 * momentum**2))
        ahead = new + (momentum - 1) / later * (new - q)
        change, q, momentum = np.abs(new - q).max(), new, later
        if change < 1e-7:
            break
    return q


def on_layer(limit, width: float, thickness: float, creepage: float, modulus: float):
    """F_x/int mu p of a cylinder on an elastic incompressible layer; `limit` is mu p on
    cells of this width, from the trailing edge on.
    """
    cells = limit.size
    softness = _layer(width, cells + 1, thickness) / modulus
    inside = softness[:cells, :cells]
    q = last = np.zeros(cells)
    for step in range(60 * cells):
        before = np.append(softness[1:, :cells] @ q, 0.0)[:cells]
        q = _sticking(inside, before + creepage * width, limit, np.append(q[1:], 0.0))
        if step % cells == 0:
            if step and abs(q - last).sum() < 1e-6 * limit.sum():
                break
            last = q
    return q.sum() / limit.sum()


def _layer(width: float, count: int, thickness: float) -> np.ndarray:
    """u on cells by traction on cells, times G: the half-plane less its far field in
    closed form, and the rest by waves.
    """
    ends = (np.arange(count + 1) - 0.5) * width

    def integral(b):  # of ln(x^2 + b^2)/2
        square = np.where(ends**2 + b**2 > 0, ends**2 + b**2, 1.0)
        corner = b * np.arctan(ends / b) if b else 0.0
        return np.diff(0.5 * ends * np.log(square) - ends + corner)

    row = 0.5 / np.pi * (integral(thickness) - integral(0.0))
    panels = np.concatenate([[0], np.geomspace(1e-6, 1, 30), np.arange(1.5, 40, 0.5)])
    y, weight = gauss_on_panels(panels, 8)
    k = y / thickness
    rest = shear_compliance(k, thickness, 0.5) - 0.5 / k * -np.expm1(-y)
    waves = np.cos(np.outer(np.arange(count) * width, k)) * np.sinc(
        k * width / 2 / np.pi
    )
    return toeplitz(row + width / np.pi / thickness * waves @ (rest * weight))


def _sticking(softness, wanted, limit, q):
    """As `_within`, by elimination: which cells stick is found by pivoting."""
    state = np.sign(np.where(abs(q) >= limit * (1 - 1e-9), q, 0.0))
    for _ in range(100):
        sticks, q = state == 0, state * limit
        if sticks.any():
            known = softness[np.ix_(sticks, ~sticks)] @ q[~sticks]
            q[sticks] = np.linalg.solve(
                softness[np.ix_(sticks, sticks)], wanted[sticks] - known
            )
        behind = (softness @ q - wanted) * state
        slips = np.where(abs(q) > limit, np.sign(q), 0.0)
        new = np.where(sticks, slips, np.where(behind > 0, 0.0, state))
        if (new == state).all():
            break
        state = new
    return np.clip(q, -limit, limit)


def drawn_layers(seed: int, scenes: int, cells: int = 64) -> np.ndarray:
    """Rows of L/h, mu, F_x/(mu F_N) of `em.traction`, its bound, and the exact one."""
    rng, rows, roll = np.random.default_rng(seed), [], em.Cylinder(0.05, 1.0)
    for _ in range(scenes):
        thickness, load = 10 ** rng.uniform(-3.3, -1), 10 ** rng.uniform(2, 4.3)
        mu, modulus = 10 ** rng.uniform(-1, 0.2), 1e6
        layer = em.layer(em.Prony(modulus, [], []), thickness)
        pulled = functools.partial(
            em.traction, layer, roll, velocity=1.0, friction=mu, load=load
        )
        contact = pulled(creepage=0.0).contact
        half = float(contact.leading + contact.trailing) / 2
        creepage = mu * half / 0.05 * 10 ** rng.uniform(-1.3, 0.7, 3)
        found = pulled(creepage=creepage)
        x = ((np.arange(cells) + 0.5) / cells * 2 - 1) * half
        limit = mu * _pressure(layer, roll, load, half, x)
        for xi, brush, bound in zip(
            creepage, found.coefficient, found.model_error, strict=True
        ):
            exact = on_layer(limit, 2 * half / cells, thickness, xi, modulus)
            rows.append((half / thickness, mu, brush / mu, bound / mu, exact))
    return np.array(rows)


@numpy_unless_traced
def _pressure(layer, roll, load, half, x):
    """Of an elastic layer under the roll [Pa], as `em.traction` has it."""
    asked = Asked(np.array(1.0), np.array(load), None)
    _, _, contact = cylinder_pressure(
        SmoothCall("rolling", layer, roll, asked, None, 1e-6)
    )
    order = np.arange(1, contact.terms.shape[1] + 1)
    waves = np.sin(np.arccos(x / half)[:, None] * order)
    return np.maximum(waves @ contact.terms[0], 0.0)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scenes", type=int, default=40)
    asked = parser.parse_args()
    kalker = {0.0: 3.40, 0.25: 4.12, 0.5: 5.20}
    print("| zeta | brush |", *(f"nu = {nu} |" for nu in kalker))
    print("|" + "---|" * (2 + len(kalker)))
    columns = [ball(nu, ZETA) for nu in kalker]
    brush = 1 - (1 - np.array(ZETA)) ** 3
    for row in zip(ZETA, brush, *columns, strict=True):
        print("|", " | ".join(f"{value:.3f}" for value in row), "|")
    for nu, c_11 in kalker.items():
        slope = float(ball(nu, [0.004])[0]) / (1 - 0.996**3)
        print(
            f"nu = {nu}: slope over the brush's {slope:.2f}, Kalker {c_11 * (2 - nu) / 4:.2f}"
        )
    rows = drawn_layers(asked.seed, asked.scenes)
    apart = rows[:, 2] - rows[:, 4]
    covered = np.abs(apart) <= rows[:, 3]
    print(
        f"{len(rows)} points on layers, L/h {rows[:, 0].min():.2g} to "
        f"{rows[:, 0].max():.2g}: brush less exact {apart.min():+.3f} to "
        f"{apart.max():+.3f} mu, bound covers {covered.mean():.1%}"
    )


if __name__ == "__main__":
    main()
