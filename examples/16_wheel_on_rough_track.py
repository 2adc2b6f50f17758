"""16: a wheel over a rough track, and the spectrum of its force.

Teaches: `em.drive` solves bodies and contact together, and `spectrum` of its result is
what the wheel puts into its axle. A ball that rolls over rubber with a rough surface is
shaken by it: the roughness is filtered by the contact, which is longer than the short
waves, and amplified near the resonance of the mass on the contact's stiffness. `track`
is the roughness of the rubber, `normal` the mass that moves up and down.

Inputs: a standard solid with E* = 4 MPa relaxed, 8 MPa glassy, tau = 1 ms; a ball
(paraboloid) of R = 20 mm under 20 N, once with 50 g and once without mass, at 1 m/s; a
track of ten waves, 2 mm to 20 mm long, each of 10 um amplitude.

Check: without mass the normal force is the load at every instant; work = kinetic +
stored + dissipated; and the mean resistance is that of the smooth track,
em.friction(..., model=em.Line()), to a few per cent, since the waves are low.

    python examples/16_wheel_on_rough_track.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.Foundation(4e6, [4e6], [1e-3])
BALL, LOAD, VELOCITY, MASS = em.Paraboloid(0.02), 20.0, 1.0, 0.05  # m, N, m/s, kg
PERIOD, AMPLITUDE = 0.02, 1e-5  # of the track [m]
X = np.arange(128) * PERIOD / 128
PHASE = np.random.default_rng(4).uniform(0, 2 * np.pi, 10)
TRACK = em.RoughLine(
    X,
    sum(
        AMPLITUDE * np.cos(2 * np.pi * k * X / PERIOD + PHASE[k - 1])
        for k in range(1, 11)
    ),
)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    time = np.linspace(0, 3 * PERIOD / VELOCITY, 193)
    arguments = {
        "time": time,
        "position": VELOCITY * time,
        "load": LOAD,
        "track": TRACK,
        "rtol": 3e-2,
    }
    heavy = em.drive(RUBBER, BALL, normal=em.Mount(MASS), **arguments)
    light = em.drive(RUBBER, BALL, **arguments)

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.0))
    top.plot(1e3 * time, heavy.normal_force, color="#1f5a94", label="50 g")
    top.plot(
        1e3 * time,
        light.normal_force,
        color="#a03030",
        linestyle="--",
        label="without mass",
    )
    top.text(2.2, 15.2, "put down", fontsize=9)
    top.set(xlabel="Time [ms]", ylabel="Normal force [N]")
    top.set_title(
        "Ball of 20 mm radius rolling at 1 m/s over a rough track, bare MDR line"
    )
    force = heavy.spectrum(since=2 * PERIOD / VELOCITY, period=PERIOD / VELOCITY)
    force.plot(ax=bottom, title="Normal force, 50 g, last period of the track")
    resonance = np.sqrt(stiffness() / MASS) / (2 * np.pi)
    bottom.axvline(resonance, color="#a03030", linestyle="--", linewidth=1)
    bottom.text(
        resonance + 40, 0.33, "mass on the glassy contact", fontsize=9, va="top"
    )
    bottom.set(xlim=(0, 825), ylim=(1e-3, 0.4), ylabel="Normal force [N]")
    top.legend()
    figure.savefig(out / "16_wheel_on_rough_track.png")
    plt.close(figure)

    print(force.summary())
    check(heavy, light, force)


def stiffness() -> float:
    """Of the contact under the load, for a fast small motion: 2 E* a, with the glassy
    modulus and the mean radius.
    """
    radius = float(
        em.friction(
            RUBBER, BALL, velocity=VELOCITY, load=LOAD, model=em.Line()
        ).contact.leading
    )
    return 2 * float(RUBBER.instantaneous) * radius


def check(heavy: em.Drive, light: em.Drive, force: em.ForceSpectrum) -> None:
    assert heavy.converged.all()
    assert light.converged.all()
    assert np.allclose(light.normal_force, LOAD, rtol=1e-10), (
        "without mass the force is the load"
    )
    missing = np.abs(heavy.imbalance).max() / heavy.given.max()
    print(f"missing in the energy balance: {missing:.1e} of the work")
    assert missing < 1e-3, "the energy balance must close"
    smooth = float(
        em.friction(
            RUBBER, BALL, velocity=VELOCITY, load=LOAD, model=em.Line()
        ).friction_force
    )
    rough = light.friction_force[-65:-1].mean()
    print(f"mean resistance {rough:.4f} N, on a smooth track {smooth:.4f} N")
    assert abs(rough / smooth - 1) < 0.05, "low waves change the mean resistance little"
    last = heavy.normal_force[-65:-1]
    assert np.isclose(force.rms, last.std(), rtol=1e-12), (
        "the spectrum holds the mean square of the force"
    )
    assert force.rms > 0.005 * LOAD, "the mass makes the force fluctuate"
    assert force.amplitude[:10].max() > 10 * force.amplitude[15:].max(), (
        "the track has ten waves"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
