"""35: how hard a dry rod breaks out of its seal after a rest of a second to ten days.

Teaches: real contact grows while rubber creeps into the roughness, and with it the force
that shears it, `em.break_out`; all of the contact at once is a bound from above, with
the band of what the contact may be off. Steady sliding with the same shear
(`em.friction(adhesion=)`) is the bound from below. Beside it stands the interlocking: a
rod must climb out of its imprint, which `em.slide` finds on a line of the surface.

Inputs: `epdm-70`, whose data end after eight minutes at 20 degC (dotted beyond); the
seal of example 22, an O-ring of 3 mm on a rod of 20 mm, here at 0.35 MPa; shear stress
of 0.2 MPa of the real contact, at all velocities (assumed).

Check: the break-out of light contact grows as the creep compliance of the rubber, whose
value is known without a surface; a long dwell ends at the relaxed contact; the bounds
are in order.

    python examples/35_break_out.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.load_material("epdm-70")
SHAFT = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 4e-6
)
PRESSURE, NORMAL = 0.35e6, 24.0  # Pa, N on the whole ring
SHEAR, SPEED, WAY = 2e5, 1e-2, 30e-6  # Pa, m/s, m
KELVIN = {"20 °C": 293.15, "0 °C": 273.15}
DWELL = np.geomspace(1.0, 1e6, 37)  # s
RESTS = np.array([1.0, 10.0, 100.0, 1000.0])
LINE = SHAFT.line(seed=1, periods=4, samples=512)
COLOURS = ("#123c66", "#3c9fbf")


def break_out(kelvin: float, pressure: float, time) -> em.BreakOut:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        return em.break_out(
            RUBBER,
            SHAFT,
            pressure=pressure,
            time=time,
            temperature=kelvin,
            boundary_shear=SHEAR,
        )


def sliding(kelvin: float) -> em.FrictionCurve:
    return em.friction(
        RUBBER,
        SHAFT,
        velocity=SPEED,
        temperature=kelvin,
        pressure=PRESSURE,
        adhesion=em.AdhesiveShear(SHEAR, 1.0, 0.0),
    )


def sliding_on_line(kelvin: float) -> float:
    load = PRESSURE * SHAFT.full_contact_length
    rubber = RUBBER.at(kelvin)
    curve = em.friction(rubber, LINE, velocity=SPEED, load=load, model=em.Line())
    return float(curve.mu)


def interlocking(kelvin: float) -> np.ndarray:
    """Largest friction coefficient of a start on the line after each rest."""
    most = []
    for rest in RESTS:
        time = np.concatenate([[0.0], rest + np.linspace(0, WAY / SPEED, 31)])
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", em.ExtrapolationWarning)
            slid = em.slide(
                RUBBER.at(kelvin),
                LINE,
                time=time,
                position=SPEED * np.maximum(time - rest, 0),
                load=PRESSURE * SHAFT.full_contact_length,
                rtol=2e-2,
            )
        most.append(np.nanmax(slid.mu))
    return np.array(most)


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    for (name, kelvin), colour in zip(KELVIN.items(), COLOURS, strict=True):
        grown = break_out(kelvin, PRESSURE, DWELL)
        steady = sliding(kelvin)
        force, off = NORMAL * grown.mu, NORMAL * grown.model_error
        left.fill_between(
            DWELL, force - off, force + off, color=colour, alpha=0.15, lw=0
        )
        left.plot(DWELL, force, ":", color=colour)
        known = np.where(grown.extrapolated, np.nan, force)
        left.plot(DWELL, known, color=colour, label=f"break-out, {name}")
        level = NORMAL * float(steady.adhesion)
        left.axhline(level, color=colour, ls="--", lw=1)
        left.plot([], [], "--", color=colour, lw=1, label=f"sliding, {name}")
        most = NORMAL * interlocking(kelvin)
        right.plot(RESTS, most, "o-", color=colour, label=f"break-out, {name}")
        level = NORMAL * sliding_on_line(kelvin)
        right.axhline(level, color=colour, ls="--", lw=1)
        right.plot([], [], "--", color=colour, lw=1, label=f"sliding, {name}")
        print(
            f"{name}: shear {force[0]:.2f} N after a second, {force[-1]:.2f} N at the "
            f"end, {NORMAL * float(steady.adhesion):.2f} N sliding; interlocking "
            f"{most[0]:.2f} to {most[-1]:.2f} N, {level:.2f} N sliding"
        )
        check(kelvin, grown, steady, most)
    left.set_title("Shear of the real contact")
    right.set_title("Interlocking, on one line")
    for ax in (left, right):
        ax.set(xlabel="Dwell [s]", xscale="log", ylabel="Friction force [N]")
        ax.set(ylim=(0, 1.45 * ax.get_ylim()[1]))
        ax.legend(loc="upper left", ncols=2)
    figure.savefig(out / "35_break_out.png")
    plt.close(figure)
    print(grown.summary())


def check(
    kelvin: float, grown: em.BreakOut, steady: em.FrictionCurve, most: np.ndarray
) -> None:
    times = np.array([1.0, 1e5])
    creep = RUBBER.at(kelvin).creep_compliance(times)
    light = break_out(kelvin, 10.0, times).mu
    assert np.isclose(light[1] / light[0], creep[1] / creep[0], rtol=1e-3)
    assert (np.diff(grown.mu) >= 0).all(), "more after a longer dwell"
    relaxed = break_out(kelvin, PRESSURE, None).mu
    assert np.isclose(grown.mu[-1], relaxed, rtol=1e-3)
    assert (grown.mu > float(steady.adhesion)).all(), "the bounds are in order"
    assert (np.diff(most) > 0).all()
    assert most[0] > NORMAL * sliding_on_line(kelvin)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
