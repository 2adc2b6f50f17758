"""19: the flash temperature of a tread that slides on a rough road.

Teaches: `heat=em.Heat(...)` warms the rubber in its contacts by its own friction. `mu` is then the hot curve,
`cold` the one without heating, `temperature_rise` the temperature between them. Slow contacts lose their heat to the
rubber around them as fast as it comes; fast ones keep it for as long as a contact lasts.

Inputs: the synthetic passenger tread at 10 degC; a self-affine road, H = 0.8, rms slope 0.5, wavelengths of 5 mm to
50 um, 0.2 MPa; conductivity 0.25 W/(m K) and heat capacity 2 MJ/(m^3 K), assumed.

Check: the heat that flows into the rubber is the power of friction; friction at the raised temperature, computed
anew, is the hot curve; one moving disc is 8 q a/(3 pi lambda) warm at rest, and at high speed as warm as its chords,
each of which heats the rubber for the time it takes to pass.

    python examples/19_flash_temperature.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

TREAD = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 50e-6)
HEAT = em.Heat(conductivity=0.25, heat_capacity=2e6)
PRESSURE, KELVIN = 2e5, 283.15  # Pa, K
ASKED = {"pressure": PRESSURE}


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    velocity = np.geomspace(1e-3, 10.0, 41)
    curve = em.friction(TREAD, ROAD, velocity=velocity, temperature=KELVIN, heat=HEAT, **ASKED)
    print(curve.summary())

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.0), sharex=True, layout="constrained")
    top.semilogx(velocity, curve.cold, "--", color="#1f5a94", label="rubber at 10 °C throughout")
    top.semilogx(velocity, curve.mu, color="#a03030", label="with flash temperature")
    whole = curve.error + np.nan_to_num(curve.model_error)
    top.fill_between(velocity, curve.mu - whole, curve.mu + whole, color="#a03030", alpha=0.16, linewidth=0)
    top.set(ylabel="Friction coefficient [-]", ylim=(0, None))
    top.set_title("Passenger tread (synthetic) on a rough road, 0.2 MPa", fontsize=10)
    top.legend(frameon=False)
    bottom.loglog(velocity, curve.temperature_rise, color="#a03030")
    bottom.set(xlabel="Sliding velocity [m/s]", ylabel="Flash temperature rise [K]")
    for ax in (top, bottom):
        ax.grid(color="#dddddd")
        ax.set_axisbelow(True)
    figure.savefig(out / "19_flash_temperature.png", dpi=150)
    plt.close(figure)

    check(curve)


def check(curve: em.FrictionCurve) -> None:
    power = curve.friction_force * curve.velocity / (curve.normal_force / PRESSURE)
    assert np.allclose(curve.heat_flux, power, rtol=1e-8), "heat into the rubber must be friction power"
    anew = em.friction(TREAD, ROAD, velocity=curve.velocity, temperature=KELVIN + curve.temperature_rise, **ASKED)
    assert np.allclose(anew.mu, curve.mu, rtol=1e-6), "the hot curve is friction at the raised temperature"
    assert (np.diff(curve.temperature_rise) > 0).all(), "faster is warmer"

    flux, radius, fast = 1e6, 1e-4, 1e3  # W/m^2, m, m/s
    at_rest = 8 * flux * radius / (3 * np.pi * HEAT.conductivity)
    assert np.isclose(HEAT.moving_disc(flux, radius, 0.0), at_rest, rtol=1e-9)
    y = (np.arange(100_000) + 0.5) / 100_000
    chord = 2 * radius * np.sqrt(1 - y**2)
    mean = np.sum(2 / 3 * HEAT.uniform_flux(flux, chord / fast) * chord) / np.sum(chord)
    assert np.isclose(HEAT.moving_disc(flux, radius, fast), mean, rtol=1e-4)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(), help="folder for the figure (default: this one)")
    main(parser.parse_args().out)
