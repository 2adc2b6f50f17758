"""33: the friction of a lubricated seal over speed, from boundary friction to full film.

Teaches: `em.lubricated` over velocity is the Stribeck curve. On a rough rod asperities
carry the load of the EPDM while the film is thin: hysteresis about them and the shear of
their real contact make the friction. With speed the film lifts the rubber off, friction
falls to a minimum and then grows with the shear of the oil; a smooth rod has the last
branch only. How far apart both are is the film over the rms height. With
`em.reciprocating` the film is what a rod carries out: a seal that is steep on the side of
the oil brings back more than it lets out. So does an O-ring without pressure; under that
of its oil the side of the air is the steeper one, and it leaks. Warm oil is thin, and so
are the films.

Inputs: `epdm-70` at 20 degC that has been pressed for five minutes; a rib of 5 mm radius
under 1 N/mm; oil of 0.05 Pa s; a ground rod, H = 0.8, wavelengths of 60 to 0.6 um, rms
height 0.3 um, shear stress 0.2 MPa of the real contact (assumed). O-ring of 5 mm,
squeezed by 15 % for five minutes, on a smooth rod; the oil has 0.018 Pa s at 50 degC.

Check: parts sum up; a fast rod does not feel its roughness; friction has a minimum; the
film grows with speed; the ring leaks the more the higher the pressure, and less in the
warm.

    python examples/33_stribeck.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.load_material("epdm-70")
RIB, LOAD = em.Cylinder(5e-3, 1.0), 1e3  # per metre
OIL, SHEAR, KELVIN, HELD = 0.05, 2e5, 293.15, 300.0
ROD = em.SelfAffine(
    0.8, rms_height=0.3e-6, q_low=2 * np.pi / 60e-6, q_high=2 * np.pi / 0.6e-6
)
SPEEDS = np.geomspace(1e-5, 3.0, 64)
STROKE, PEAK = 0.1, 3e6  # m, Pa
FLANKS = 0.5e-3, 1.5e-3  # m
PRESSURES, OILS = (0.0, 2e6, 4e6), {293.15: 0.05, 323.15: 0.018}  # Pa; K: Pa s


def stribeck(surface: em.SelfAffine | None) -> em.Lubricated:
    with warnings.catch_warnings():
        # asperities excite the rubber beyond its data
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        return em.lubricated(
            RUBBER,
            RIB,
            velocity=SPEEDS,
            load=LOAD,
            viscosity=OIL,
            surface=surface,
            boundary_shear=None if surface is None else SHEAR,
            temperature=KELVIN,
            time=HELD,
        )


def lip(towards_oil: float, towards_air: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressure of a dry lip over its place, from the oil to the air."""
    x = np.linspace(-towards_oil, towards_air, 2001)
    flank = np.where(x < 0, towards_oil, towards_air)
    return x, PEAK * np.cos(0.5 * np.pi * x / flank) ** 2


def stroke(towards_oil: float, towards_air: float) -> em.Reciprocating:
    return em.reciprocating(
        profile=lip(towards_oil, towards_air),
        velocity_out=0.1,
        velocity_in=0.1,
        stroke=STROKE,
        viscosity=OIL,
    )


def ring_stroke(pressure: float, kelvin: float) -> em.Reciprocating:
    given = {"time": HELD, "temperature": kelvin, "fluid_pressure": pressure}
    # slower, the films are thinner than any rod is smooth
    strokes = {"velocity_out": 0.5, "velocity_in": 0.5, "stroke": STROKE}
    with warnings.catch_warnings():
        # at 50 degC five minutes are beyond the data of the rubber
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        ring = em.o_ring(RUBBER, 5e-3, 0.15, **given)
        return em.reciprocating(RUBBER, o_ring=ring, viscosity=OILS[kelvin], **strokes)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    rough, smooth = stribeck(ROD), stribeck(None)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    below = np.zeros(SPEEDS.size)
    parts = {
        "shear of real contact": (rough.boundary, "#7fb0dd"),
        "hysteresis about asperities": (rough.asperity, "#3c7fbf"),
        "oil": (rough.viscous, "#f0c36d"),
    }
    for name, (part, colour) in parts.items():
        left.fill_between(SPEEDS, below, below + part, color=colour, label=name, lw=0)
        below = below + part
    left.plot(SPEEDS, rough.mu, color="#123c66", label="rough rod")
    left.plot(SPEEDS, smooth.mu, "--", color="black", label="smooth rod")
    left.set(xlabel="Velocity [m/s]", xscale="log", ylabel="Friction coefficient")
    left.set(ylim=(0, None), xlim=(SPEEDS[0], SPEEDS[-1]))
    left.legend(loc="upper right")
    right.plot(SPEEDS, 1e6 * rough.film_thickness, color="#123c66", label="rough rod")
    right.plot(SPEEDS, 1e6 * smooth.film_thickness, "--k", label="smooth rod")
    right.axhline(0.3, color="grey", lw=0.8)
    right.text(SPEEDS[0] * 1.3, 0.31, "rms height", color="grey", va="bottom")
    right.set(xlabel="Velocity [m/s]", xscale="log", yscale="log")
    right.set(ylabel="Mean gap at the apex [µm]", xlim=(SPEEDS[0], SPEEDS[-1]))
    right.legend(loc="upper left")
    figure.savefig(out / "33_stribeck.png")
    plt.close(figure)
    print(rough.summary())
    tight, loose = stroke(*FLANKS), stroke(*FLANKS[::-1])
    for name, found in (("oil", tight), ("air", loose)):
        leak = 1e9 * float(found.net_leak)
        print(f"steep towards the {name}: {leak:.0f} mm^3 per stroke and metre of seal")
    strokes = {
        kelvin: [ring_stroke(pressure, kelvin) for pressure in PRESSURES]
        for kelvin in OILS
    }
    print("O-ring: mm^3 per stroke and metre; friction out and in, N/m")
    for kelvin, found in strokes.items():
        for pressure, each in zip(PRESSURES, found, strict=True):
            leak, forces = (
                1e9 * float(each.net_leak),
                (each.friction_out, each.friction_in),
            )
            print(
                f"  {kelvin - 273.15:.0f} degC, {1e-6 * pressure:.0f} MPa: {leak:.1f}; "
                + " and ".join(f"{float(force):.1f}" for force in forces)
            )
    check(rough, smooth, tight, loose, strokes)


def check(
    rough: em.Lubricated,
    smooth: em.Lubricated,
    tight: em.Reciprocating,
    loose: em.Reciprocating,
    strokes: dict[float, list[em.Reciprocating]],
) -> None:
    parts = rough.viscous + rough.asperity + rough.boundary + rough.rubber
    np.testing.assert_allclose(rough.mu, parts, rtol=1e-12)
    assert rough.converged.all()
    assert abs(rough.mu[-1] / smooth.mu[-1] - 1) < 0.02, "a fast rod is as if smooth"
    least = int(rough.mu.argmin())
    assert 0 < least < SPEEDS.size - 1, "friction has a minimum"
    assert (np.diff(rough.film_thickness) > 0).all()
    assert float(tight.net_leak) == 0 < float(loose.net_leak)
    cold, warm = (
        np.array([float(each.net_leak) for each in found]) for found in strokes.values()
    )
    assert cold[0] == warm[0] == 0
    assert (np.diff(cold) > 0).all()
    assert (warm[1:] < cold[1:]).all()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
