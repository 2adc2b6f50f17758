"""17: a tread block that brakes: friction lags behind the falling speed, and the block
recoils when it stops.

Teaches: `em.drive` with a drive that slows down. The tread (rubber) slides over the
road (a rough line); what holds the block is a spring and a damper. Friction remembers:
while the block slows down it is not that of steady sliding at the same speed. At rest
rubber friction is zero, and what the spring held lets the block swing back.

Inputs: synthetic: E* = 1 MPa relaxed, branches of 2, 3 and 4 MPa at 20, 2 and 0.2
ms; a road of five waves, 2 mm to 0.4 mm long; 1.5 kN per metre pressed on, so that road
and block touch everywhere; block 2 kg/m on 200 kN/m/m and 1 kN s/m/m; from 0.5 m/s to
rest in 40 ms.

Check: in full contact the memory of the rubber is one complex number per wave and
branch, s' = z' - s/tau with z = exp(i k X), and F_x = sum (1/2) A^2 k E_j Im(conj(z)
s): the same motion by scipy's integrator, which knows no element. And the steady
friction before the brakes bite, sum (1/2) A^2 k E''(k v) over the load.

    python examples/17_braking_tread_block.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import solve_ivp

import elastomdr as em

RUBBER = em.Foundation(1e6, [4e6, 3e6, 2e6], [2e-4, 2e-3, 2e-2])
PERIOD, POINTS = 2e-3, 64
WAVES = np.arange(1, 6)
K, AMPLITUDE = 2 * np.pi * WAVES / PERIOD, 4e-5 / WAVES  # 1/m, m
PHASE = np.random.default_rng(2).uniform(0, 2 * np.pi, WAVES.size)
X = np.arange(POINTS) * PERIOD / POINTS
ROAD = em.RoughLine(
    X, (AMPLITUDE * np.cos(np.multiply.outer(X, K) + PHASE)).sum(axis=1)
)
LOAD, MOUNT = 1500.0, em.Mount(2.0, 2e5, 1000.0)  # per metre of line: N; kg, N/m, N s/m
SPEED, BEFORE, BRAKING, AFTER = 0.5, 0.03, 0.04, 0.02  # m/s, s
TIME = np.linspace(0, BEFORE + BRAKING + AFTER, 361)
# velocity of the drive [m/s]
WHEEL = SPEED * np.clip(1 - (TIME - BEFORE) / BRAKING, 0, 1)
DRIVE = np.concatenate([[0], np.cumsum(np.diff(TIME) * (WHEEL[1:] + WHEEL[:-1]) / 2)])


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    block = em.drive(
        RUBBER, ROAD, time=TIME, position=DRIVE, load=LOAD, tangential=MOUNT
    )
    velocity, drag = reduced()
    speed = np.linspace(0, SPEED, 300)
    steady = (0.5 * AMPLITUDE**2 * K * RUBBER.loss(np.multiply.outer(speed, K))).sum(
        axis=1
    ) / LOAD

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    left.plot(1e3 * TIME, WHEEL, color="#888888", label="drive")
    left.plot(1e3 * TIME, block.velocity, color="#1f5a94", label="block, em.drive")
    left.plot(
        1e3 * TIME[::10],
        velocity[::10],
        "o",
        color="#a03030",
        markerfacecolor="none",
        label="reduced equations",
    )
    left.set(xlabel="Time [ms]", ylabel="Velocity [m/s]")
    braking = TIME >= BEFORE
    right.plot(speed, steady, color="#888888", label="steady, closed form")
    right.plot(
        block.velocity[braking],
        block.mu[braking],
        color="#1f5a94",
        label="braking, em.drive",
    )
    right.set(xlabel="Velocity of the block [m/s]", ylabel="Friction coefficient [-]")
    left.set_title("Tread block on a road of five waves, braking")
    right.set_title("1.5 kN/m, bare MDR line in full contact")
    for ax in (left, right):
        ax.legend()
    figure.savefig(out / "17_braking_tread_block.png")
    plt.close(figure)

    assert block.converged.all(), "every instant must converge"
    late = TIME > 2e-3  # the first instants hold the start from rest
    off = (
        np.abs(block.velocity - velocity)[late].max() / SPEED,
        np.abs(block.mu - drag / LOAD)[late].max(),
    )
    print(
        f"check     off the reduced equations: velocity {off[0]:.1e} of 0.5 m/s, "
        f"mu {off[1]:.1e}"
    )
    assert off[0] < 2e-3, "the same velocity"
    assert off[1] < 2e-3 * block.mu.max(), "the same friction"
    before = block.mu[(TIME > 0.75 * BEFORE) & (TIME < BEFORE)].mean()
    print(f"check     mu before braking {before:.5f}, closed form {steady[-1]:.5f}")
    assert abs(before / steady[-1] - 1) < 0.05, (
        "steady friction, but for the swing of the start"
    )


def reduced() -> tuple[np.ndarray, np.ndarray]:
    """Velocity [m/s] and F_x [N/m] of a block in full contact, with a complex memory
    per wave and branch.
    """
    modulus, tau = np.asarray(RUBBER.moduli), np.asarray(RUBBER.times)
    strength = 0.5 * np.multiply.outer(AMPLITUDE**2 * K, modulus)

    def drag_of(place: float, s: np.ndarray) -> float:
        return float((strength * (np.exp(-1j * K * place)[:, None] * s).imag).sum())

    def rates(t: float, y: np.ndarray) -> np.ndarray:
        place, speed = y[0].real, y[1].real
        s = y[2:].reshape(strength.shape)
        ds = 1j * (K * speed * np.exp(1j * K * place))[:, None] - s / tau
        pull = MOUNT.stiffness * (np.interp(t, TIME, DRIVE) - place)
        pull += MOUNT.damping * (np.interp(t, TIME, WHEEL) - speed)
        return np.concatenate(
            [[speed, (pull - drag_of(place, s)) / MOUNT.mass], ds.ravel()]
        )

    # put down at once: glassy
    start = np.concatenate([[0, 0], np.ones(strength.size)]).astype(complex)
    run = solve_ivp(
        rates,
        (0, TIME[-1]),
        start,
        t_eval=TIME,
        rtol=1e-7,
        atol=1e-10,
        max_step=TIME[1],
    )
    drag = [drag_of(y[0].real, y[2:].reshape(strength.shape)) for y in run.y.T]
    return run.y[1].real, np.array(drag)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
