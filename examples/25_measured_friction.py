"""25: measured friction: shifted to a master curve, drawn over the computed one, and
what it says about the roughness.

Teaches: `em.read_friction` reads a table of points; `em.fit.friction_master` (Grosch)
shifts them, the curve's `plot(measured=)` draws them, and `em.fit.calibrate` finds the
upper cutoff of a spectrum, first alone, then with all that is not known either:
heights, and a factor on the coefficient.

Inputs: the points of scenes/measured_friction.csv, which are synthetic: those of this
engine for q_high = 50000 rad/m, with a noise of 3 %. Name your own file with --data.
`tread-passenger-synthetic` of the library, a synthetic spectrum with the measured shift
law of an SBR; a self-affine road, H = 0.8, rms height 50 um, q_low = 2000 rad/m, 0.5
MPa: assumed.

Check: the shift factors of the friction lie within three of their standard deviations
of the WLF law published for the SBR (Wu, Fujii, Kawahara and Isono, e-J. Soft Mater. 3
(2007) 41), written out here: Grosch's finding (1963). The cutoff by which the points
were made lies within three standard deviations; the other unknowns widen its interval
at least threefold; and the direction of which the data say least is one in which more
height is a smaller factor. Since the points come from the same engine, that engine is
held, on a line of the calibrated surface pressed into full contact, against the sum
over its waves, mu = sum (1/2) A^2 k E''(k v)/load, and, very slow, against v eta
<h'^2>/load, eta the sum of the rubber's moduli times their relaxation times.

    python examples/25_measured_friction.py [--out DIR] [--data FILE]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.load_material("tread-passenger-synthetic")
DATA = Path(__file__).parent / "scenes" / "measured_friction.csv"
SCENE = {"pressure": 5e5}  # Pa, unless the file has a column of it
# as far as the profilometer sees
KNOWN = em.SelfAffine(0.8, rms_height=5e-5, q_low=2e3, q_high=2e4)
# upper cutoff by which the points were made [rad/m], scatter of a measurement, likewise
TRUTH, NOISE = 5e4, 0.03
WIDTHS = {"heights": 0.1, "gain": 0.15}  # decades: what is known of them beforehand


def main(out: Path, data: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    points = em.read_friction(data)
    error = NOISE * points.mu if points.error is None else points.error
    scene = SCENE if points.pressure is None else SCENE | {"pressure": points.pressure}
    if points.temperature is None or np.ptp(points.temperature) == 0:
        raise em.InputError(
            argument="data",
            got=data.name,
            accepted="points at two temperatures or more: one alone cannot be shifted",
        )
    master = em.fit.friction_master(
        points.velocity, points.temperature, points.mu, 293.15, error=error
    )
    at = {"velocity": points.velocity, "temperature": points.temperature}
    measured = {"measured": points.mu, "error": error, **at, **scene}
    alone = em.fit.calibrate(RUBBER, KNOWN, parameters=("q_high",), **measured)
    start = alone.parameters | dict.fromkeys(WIDTHS, 0.0)
    free = em.fit.calibrate(RUBBER, KNOWN, parameters=start, widths=WIDTHS, **measured)
    print(f"{points}\n\n{master}\n\n{alone}\n\n{free}")

    places = [["shifted", "undecided"], ["drawn", "drawn"]]
    figure, axes = plt.subplot_mosaic(places, figsize=(8.6, 8.0), width_ratios=(3, 2))
    master.plot(axes["shifted"])
    velocity = np.geomspace(points.velocity.min(), points.velocity.max(), 41)
    kelvin = np.unique(points.temperature)[:, None]
    scene["pressure"] = float(np.median(scene["pressure"]))
    curve = em.friction(
        RUBBER, alone.shape, velocity=velocity, temperature=kelvin, **scene
    )
    curve.plot(axes["drawn"], title="Calibrated cutoff", measured=points.points)
    left = {"q_high alone": alone.std["q_high"] / alone.prior["q_high"]}
    left |= {
        f"{name}, with others": free.std[name] / free.prior[name] for name in free.std
    }
    axes["undecided"].barh(
        list(left), list(left.values()), color=["#1f5a94", *["#c08a3e"] * 3]
    )
    axes["undecided"].set(
        xlabel="Uncertainty over that beforehand [-]",
        title="What the data left undecided",
        xlim=(0, 1),
    )
    axes["undecided"].invert_yaxis()
    figure.savefig(out / "25_measured_friction.png")
    plt.close(figure)

    check(master, alone, free, made_here=data == DATA)


def check(
    master: em.fit.FrictionMaster,
    alone: em.fit.Calibration,
    free: em.fit.Calibration,
    made_here: bool,
) -> None:
    if made_here:
        against_truth(master, alone, free)
    # N/m, m/s
    line, rubber, load, speed = (
        alone.shape.line(samples=1024),
        RUBBER.at(293.15),
        1e5,
        1e-2,
    )
    pressed = float(
        em.friction(rubber, line, velocity=speed, load=load, model=em.Line()).mu
    )
    expected = float(
        em.reference.full_contact_sliding(rubber, line, velocity=speed, load=load)
    )
    print(f"check  full contact: mu = {pressed:.6e}, sum over waves {expected:.6e}")
    assert np.isclose(pressed, expected, rtol=1e-3), (
        "the sum over waves in full contact"
    )
    # m/s, so slow that the rubber is a spring with the viscosity sum E*_k tau_k
    slow = 1e-10
    crept = float(
        em.friction(rubber, line, velocity=slow, load=load, model=em.Line()).mu
    )
    # E* = 4 G, incompressible
    viscosity = 4 * float(np.sum(rubber.moduli * rubber.times))
    by_hand = slow * viscosity * float(line.rms_slope) ** 2 / load
    print(
        f"check  full contact, slow: mu = {crept:.6e}, by slope and viscosity "
        f"{by_hand:.6e}"
    )
    assert np.isclose(crept, by_hand, rtol=1e-3), "the viscous limit"


def against_truth(
    master: em.fit.FrictionMaster, alone: em.fit.Calibration, free: em.fit.Calibration
) -> None:
    celsius = master.temperature - 273.15
    # about 20 degC
    wlf = -13.2 * (celsius + 42) / (39.7 + celsius + 42) + 13.2 * 62 / (39.7 + 62)
    off = np.abs(master.log10_a - wlf)
    print(
        f"check  log10 a_T of friction {np.round(master.log10_a, 2)}, of the SBR "
        f"as published {np.round(wlf, 2)}"
    )
    assert (off <= 3 * master.log10_a_std + 1e-3).all(), (
        "friction must shift as the rubber does"
    )
    wanted = np.log10(TRUTH / KNOWN.q_high)
    for name, found in (("alone", alone), ("with the others", free)):
        far = abs(found.parameters["q_high"] - wanted) / found.std["q_high"]
        factor = 10 ** (1.96 * found.std["q_high"])
        print(
            f"check  cutoff {name}: {found.shape.q_high:.3g} rad/m, to a factor of "
            f"{factor:.2f}; {far:.1f} std off"
        )
        assert far < 3, "the true cutoff must lie in the interval"
    assert free.std["q_high"] > 3 * alone.std["q_high"], (
        "the unknowns must widen the interval"
    )
    direction, left = free.weakest
    assert left > 0.5, "along one direction the data must say little"
    assert direction["heights"] * direction["gain"] < 0, (
        "in which higher roughness is a smaller factor"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    parser.add_argument(
        "--data",
        type=Path,
        default=DATA,
        help="CSV file: velocity, temperature and mu, with units",
    )
    given = parser.parse_args()
    try:
        main(given.out, given.data)
    except em.InputError as error:
        parser.error(f"--data {given.data}: {error}")
