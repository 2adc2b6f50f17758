"""19: the flash temperature of a tread that slides on a rough road.

Teaches: `heat=em.Heat(...)` warms the rubber in its contacts by its own friction, each
length scale to a temperature of its own. `mu` is then the hot curve, `cold` the one
without heating; `temperature_rise` is the mean of the places where the heat arises,
`contact_rise` the rise of the real contact. With `road=` the road takes its share of
the heat, much of it where sliding is slow. Slow contacts lose their heat to the rubber
around them as fast as it comes; fast ones keep it for as long as a contact lasts.

Inputs: the synthetic passenger tread at 10 degC; a self-affine road, H = 0.8, rms slope
0.5, wavelengths of 5 mm to 50 um, 0.2 MPa; conductivity 0.25 W/(m K) and heat capacity
2 MJ/(m^3 K), of the road 1 W/(m K) and the same, assumed.

Check: the heat that flows into rubber and road is the power of friction; hot friction
lies between that of the cold body and that of rubber as warm as its real contact; one
moving disc is 8 q a/(3 pi lambda) warm at rest, and at high speed as warm as its
chords, each of which heats the rubber for the time it takes to pass.

    python examples/19_flash_temperature.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

TREAD = em.load_material("tread-passenger-synthetic")
ROAD = em.SelfAffine(
    0.8, rms_slope=0.5, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 50e-6
)
HEAT = em.Heat(conductivity=0.25, heat_capacity=2e6, road=(1.0, 2e6))
PRESSURE, KELVIN = 2e5, 283.15  # Pa, K
ASKED = {"pressure": PRESSURE}


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    velocity = np.geomspace(1e-3, 10.0, 41)
    curve = em.friction(
        TREAD, ROAD, velocity=velocity, temperature=KELVIN, heat=HEAT, **ASKED
    )
    print(curve.summary())

    figure, (top, bottom) = plt.subplots(2, 1, figsize=(7.2, 6.0), sharex=True)
    top.semilogx(
        velocity, curve.cold, "--", color="#1f5a94", label="rubber at 10 °C throughout"
    )
    top.semilogx(velocity, curve.mu, color="#a03030", label="with flash temperature")
    whole = curve.error + np.nan_to_num(curve.model_error)
    top.fill_between(
        velocity,
        curve.mu - whole,
        curve.mu + whole,
        color="#a03030",
        alpha=0.16,
        linewidth=0,
    )
    top.set(ylabel="Friction coefficient [-]", ylim=(0, None))
    top.set_title("Passenger tread (synthetic) on a rough road, 0.2 MPa")
    top.legend()
    alone = em.friction(
        TREAD,
        ROAD,
        velocity=velocity,
        temperature=KELVIN,
        heat=em.Heat(0.25, 2e6),
        **ASKED,
    )
    bottom.loglog(velocity, curve.contact_rise, color="#a03030", label="real contact")
    bottom.loglog(
        velocity,
        curve.temperature_rise,
        "-.",
        color="#a03030",
        label="mean of where the heat arises",
    )
    bottom.loglog(
        velocity,
        alone.contact_rise,
        ":",
        color="#555555",
        label="real contact, road takes no heat",
    )
    bottom.set(xlabel="Sliding velocity [m/s]", ylabel="Temperature rise [K]")
    bottom.legend()
    figure.savefig(out / "19_flash_temperature.png")
    plt.close(figure)

    check(curve)


def check(curve: em.FrictionCurve) -> None:
    power = curve.friction_force * curve.velocity / (curve.normal_force / PRESSURE)
    assert np.allclose(curve.heat_flux / (1 - curve.road_share), power, rtol=1e-3), (
        "all heat is friction power"
    )
    hottest = em.friction(
        TREAD,
        ROAD,
        velocity=curve.velocity,
        temperature=KELVIN + curve.contact_rise,
        **ASKED,
    )
    warm = curve.contact_rise > 1  # kelvin
    between = (curve.mu - hottest.mu) * (curve.mu - curve.cold) <= 0
    assert between[warm].all(), "hot friction lies between both"
    assert (np.diff(curve.contact_rise) > 0).all(), "faster is warmer"

    flux, radius, fast = 1e6, 1e-4, 1e3  # W/m^2, m, m/s
    at_rest = 8 * flux * radius / (3 * np.pi * HEAT.conductivity)
    assert np.isclose(HEAT.moving_disc(flux, radius, 0.0), at_rest, rtol=1e-9)
    y = (np.arange(100_000) + 0.5) / 100_000
    chord = 2 * radius * np.sqrt(1 - y**2)
    mean = np.sum(2 / 3 * HEAT.uniform_flux(flux, chord / fast) * chord) / np.sum(chord)
    assert np.isclose(HEAT.moving_disc(flux, radius, fast), mean, rtol=1e-4)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
