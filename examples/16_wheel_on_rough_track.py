"""16: a wheel over a rough track, and the spectrum of its force.

Teaches: `em.drive` solves bodies and contact together. A ball that rolls over rubber with a rough surface is shaken by
it: the roughness is filtered by the contact, which is longer than the short waves, and amplified near the resonance of
the mass on the contact's stiffness. `track` is the roughness of the rubber, `normal` the mass that moves up and down.

Inputs: a standard solid with E* = 4 MPa relaxed, 8 MPa glassy, tau = 1 ms; a ball (paraboloid) of R = 20 mm under 20 N,
once with 50 g and once without mass, at 1 m/s; a track of ten waves, 2 mm to 20 mm long, each of 10 um amplitude.

Check: without mass the normal force is the load at every instant; work = kinetic + stored + dissipated; and the mean
resistance is that of the smooth track, em.friction(..., model=em.Line()), to a few per cent, since the waves are low.

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
TRACK = em.RoughLine(X, sum(AMPLITUDE * np.cos(2 * np.pi * k * X / PERIOD + PHASE[k - 1]) for k in range(1, 11)))


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    time = np.linspace(0, 3 * PERIOD / VELOCITY, 193)
    arguments = {"time": time, "position": VELOCITY * time, "load": LOAD, "track": TRACK, "rtol": 3e-2}
    heavy = em.drive(RUBBER, BALL, normal=em.Mount(MASS), **arguments)
    light = em.drive(RUBBER, BALL, **arguments)

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.0), layout="constrained")
    top.plot(1e3 * time, heavy.normal_force, color="#1f5a94", label="50 g")
    top.plot(1e3 * time, light.normal_force, color="#a03030", linestyle="--", label="without mass")
    top.text(2.2, 15.2, "put down", fontsize=9)
    top.set(xlabel="Time [ms]", ylabel="Normal force [N]")
    top.set_title("Ball of 20 mm radius rolling at 1 m/s over a rough track, bare MDR line", fontsize=10)
    frequency, force = spectrum(time, heavy.normal_force)
    _, dip = spectrum(time, light.depth)
    bottom.bar(frequency - 6, force, width=10, color="#1f5a94", label="normal force, 50 g [N]")
    bottom.bar(frequency + 6, 1e6 * dip, width=10, color="#c08a30", label="depth, without mass [µm]")
    bottom.set(xlabel="Frequency [Hz]", ylabel="Amplitude [N], [µm]", yscale="log", xlim=(0, 525))
    for ax in (top, bottom):
        ax.grid(color="#dddddd")
        ax.set_axisbelow(True)
        ax.legend(frameon=False)
    figure.savefig(out / "16_wheel_on_rough_track.png", dpi=150)
    plt.close(figure)

    check(heavy, light)


def spectrum(time: np.ndarray, signal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes at the ten frequencies of the track, over the last of its periods."""
    last = signal[-65:-1]
    amplitude = 2 * np.abs(np.fft.rfft(last - last.mean())) / last.size
    frequency = np.fft.rfftfreq(last.size, time[1] - time[0])
    return frequency[1:11], amplitude[1:11]


def check(heavy: em.Drive, light: em.Drive) -> None:
    assert heavy.converged.all()
    assert light.converged.all()
    assert np.allclose(light.normal_force, LOAD, rtol=1e-10), "without mass the force is the load"
    missing = np.abs(heavy.imbalance).max() / heavy.given.max()
    print(f"missing in the energy balance: {missing:.1e} of the work")
    assert missing < 1e-3, "the energy balance must close"
    smooth = float(em.friction(RUBBER, BALL, velocity=VELOCITY, load=LOAD, model=em.Line()).friction_force)
    rough = light.friction_force[-65:-1].mean()
    print(f"mean resistance {rough:.4f} N, on a smooth track {smooth:.4f} N")
    assert abs(rough / smooth - 1) < 0.05, "low waves change the mean resistance little"
    assert heavy.normal_force[-65:-1].std() > 0.005 * LOAD, "the mass makes the force fluctuate"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(), help="folder for the figure (default: this one)")
    main(parser.parse_args().out)
