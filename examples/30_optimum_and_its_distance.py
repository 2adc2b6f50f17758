"""30: four branch moduli for more grip on a wet road at no more rolling resistance, and
how far that is from the data.

Teaches: `jax.value_and_grad` through `em.friction` (Multiscale) and `em.rolling`,
compiled once, gives scipy's SLSQP exact gradients over several scenes. An optimum is
only as good as its distance from what was measured: the change of the moduli is
compared with the misfit of the material to its data, and the draws of `material.draws`
show whether the gain is larger than the uncertainty.

Inputs: `epdm-70` of the library, fitted to measured shear DMA from -10 to 53 degC; a
self-affine road, 0.3 MPa, 5 degC, 0.3 to 3 m/s (hysteresis: wet, no adhesion); a solid
tyre 15 mm thick that acts as springs, free to slip on its hub, 20 m/s, 3 kN, 60 degC;
moduli may change by a factor of 1.5: chosen here. 60 degC lies beyond the data, where
the last step of the shift factors goes on.

Check: both gradients against differences; the constraint is met; grip of the optimum by
a plain call.

    python examples/30_optimum_and_its_distance.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import jax
import jax.numpy as jnp
import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import minimize

import elastomdr as em

MEASURED = em.load_material("epdm-70")
TABLE = MEASURED.shift
# 1/K
SLOPE = (TABLE.log10_a_table[-1] - TABLE.log10_a_table[-2]) / (
    TABLE.temperature[-1] - TABLE.temperature[-2]
)
# K, to which the shift factors go on as straight as between the last two temperatures
END = 343.15
SHIFT = em.ShiftTable(
    np.append(TABLE.temperature, END),
    np.append(
        TABLE.log10_a_table,
        TABLE.log10_a_table[-1] + SLOPE * (END - TABLE.temperature[-1]),
    ),
)
RUBBER = em.Prony(
    MEASURED.equilibrium,
    MEASURED.moduli,
    MEASURED.times,
    shift=SHIFT,
    vertical=MEASURED.vertical,
    range=MEASURED.range,
    name="epdm-70",
)
BRANCHES = np.array([1, 3, 5, 7])  # whose moduli are free
MOST = np.log(1.5)
ROAD = em.SelfAffine(0.8, rms_slope=0.7, q_low=1.2e3, q_high=3e5)
WET = {"velocity": np.array([0.3, 1.0, 3.0]), "pressure": 3e5, "temperature": 278.15}
TYRE = em.Cylinder(0.3, 0.2)  # radius, width [m]
WARM = {"velocity": 20.0, "load": 3e3, "temperature": 333.15}


def rubber(change: np.ndarray) -> em.Prony:
    """The material with its four moduli times exp(change)."""
    moduli = RUBBER.moduli * jnp.exp(np.eye(RUBBER.moduli.size)[:, BRANCHES] @ change)
    return em.Prony(
        RUBBER.equilibrium,
        moduli,
        RUBBER.times,
        shift=RUBBER.shift,
        vertical=RUBBER.vertical,
        name="changed",
    )


def grip(change: np.ndarray) -> jax.Array:
    return jnp.mean(em.friction(rubber(change), ROAD, **WET).mu)


def resistance(change: np.ndarray) -> jax.Array:
    return jnp.asarray(
        em.rolling(
            em.springs(rubber(change), 15e-3, bonded=False), TYRE, **WARM
        ).coefficient
    )


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    warnings.simplefilter("ignore", em.ExtrapolationWarning)  # said below
    start = np.zeros(4)
    with jax.enable_x64(True):
        both = [jax.jit(jax.value_and_grad(f)) for f in (grip, resistance)]
        (mu, by_mu), (roll, by_roll) = (f(start) for f in both)
        check_gradients(both, (by_mu, by_roll))
        scale = np.array([float(mu), float(roll)])

        def relative(which: int, x: np.ndarray) -> tuple[float, np.ndarray]:
            value, slope = both[which](x)
            return float(value) / scale[which], np.asarray(slope) / scale[which]

        found = minimize(
            lambda x: tuple(-part for part in relative(0, x)),
            start,
            jac=True,
            method="SLSQP",
            bounds=[(-MOST, MOST)] * 4,
            options={"ftol": 1e-8},
            constraints={
                "type": "ineq",
                "fun": lambda x: 1 - relative(1, x)[0],
                "jac": lambda x: -relative(1, x)[1],
            },
        )
        gain, held = relative(0, found.x)[0], relative(1, found.x)[0]
    assert found.success, found.message
    factors = np.exp(np.eye(RUBBER.moduli.size)[:, BRANCHES] @ found.x)
    best = em.Prony(
        RUBBER.equilibrium,
        RUBBER.moduli * factors,
        RUBBER.times,
        shift=RUBBER.shift,
        vertical=RUBBER.vertical,
        name="optimum",
    )
    omega, *misfit = np.array(RUBBER.range.misfit).T
    off = [
        np.log(getattr(best, name)(omega) / getattr(RUBBER, name)(omega))
        for name in ("storage", "loss")
    ]
    times = [
        np.sqrt(np.mean(change**2) / np.mean(size**2))
        for change, size in zip(off, misfit, strict=True)
    ]
    draws = em.friction(RUBBER.draws(100), ROAD, **WET).mu.mean(axis=1)
    spread = float(np.std(draws)) / scale[0]
    print(
        "factors on the moduli of "
        + ", ".join(
            f"{RUBBER.times[k]:.0e} s: {np.exp(x):.2f}"
            for k, x in zip(BRANCHES, found.x, strict=True)
        )
    )
    print(
        f"grip at 5 degC {100 * (gain - 1):+.1f} %, known to +- "
        f"{100 * spread:.1f} % "
        "(one sigma of the draws)"
    )
    print(f"rolling resistance at 60 degC {100 * (held - 1):+.2f} %")
    print(
        f"outside what was measured: storage {times[0]:.1f} and loss modulus "
        f"{times[1]:.1f} times the misfit; the data end at "
        f"{RUBBER.range.temperature[1] - 273.15:.0f} degC"
    )
    draw(best, omega, off, misfit, out / "30_optimum_and_its_distance.png")
    assert held < 1 + 1e-6, "rolling resistance must be held"
    assert gain > 1, "there must be something to gain"
    plain = float(np.mean(em.friction(best, ROAD, **WET).mu)) / scale[0]
    print(f"check  grip of the optimum by a plain call: {abs(plain - gain):.0e} apart")
    assert abs(plain - gain) < 1e-5, "the compiled call must be the plain one"


def check_gradients(both: list, slopes: tuple) -> None:
    for f, slope in zip(both, slopes, strict=True):
        step = 1e-3 * np.eye(4)
        difference = np.array([float(f(h)[0] - f(-h)[0]) / 2e-3 for h in step])
        off = np.abs(difference - slope).max() / np.abs(slope).max()
        print(f"check  gradient against differences: {off:.0e}")
        assert off < 1e-3, "the gradient must meet the difference"


def draw(
    best: em.Prony, omega: np.ndarray, off: list, misfit: list, path: Path
) -> None:
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    velocity = np.geomspace(1e-3, 10, 40)
    for material, label in (
        (RUBBER.draws(60), "as measured, 95 % of its draws"),
        (best, "optimum"),
    ):
        curve = em.friction(material, ROAD, **(WET | {"velocity": velocity}))
        colour = "#c8702a" if material is best else "#1f5a94"
        if material is not best:
            low, middle, high = curve.band()
            left.fill_between(velocity, low, high, color=colour, alpha=0.2, linewidth=0)
        left.semilogx(
            velocity,
            curve.mu if material is best else middle,
            color=colour,
            label=label,
        )
    left.axvspan(
        WET["velocity"][0],
        WET["velocity"][-1],
        color="#eeeeee",
        zorder=0,
        label="optimised",
    )
    left.set(
        xlabel="Sliding velocity [m/s]",
        ylabel="Friction coefficient [-]",
        ylim=(0, None),
    )
    left.set_title("Hysteresis on the road, 5 °C")
    for change, size, colour, name in zip(
        off, misfit, ("#1f5a94", "#c8702a"), ("storage", "loss"), strict=True
    ):
        right.semilogx(
            omega, 100 * change, color=colour, label=f"{name}: optimum over measured"
        )
        right.fill_between(
            omega,
            -100 * size,
            100 * size,
            color=colour,
            alpha=0.2,
            linewidth=0,
            label=f"{name}: misfit",
        )
    right.set(
        xlabel="Angular frequency at 25 °C [rad/s]", ylabel="Change of the modulus [%]"
    )
    right.set_title("How far the optimum is from what was measured")
    for ax in (left, right):
        ax.legend()
    figure.savefig(path)
    plt.close(figure)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
