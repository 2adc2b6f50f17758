"""28: friction of a measured rubber on a rough surface, at four temperatures, with the
band of its uncertainty.

Teaches: a material, a spectrum and a nominal pressure suffice; `em.friction` then uses
`em.Multiscale`, which has nothing to choose. The figure is `curve.plot()`: shaded is
the whole uncertainty, numerical error, what the fitted series misses of the measured
moduli, and the bound on the model; dotted is where the road excites the rubber beyond
the frequencies or temperatures at which it was measured. Dry friction has the shear of
the real contact besides, `em.AdhesiveShear`: the figure shows both parts below, and
`em.fit.adhesion` finds the law again from noisy points.

Inputs: `epdm-70` of the library, fitted to measured shear DMA of a filled EPDM (source
and grades in the file); a self-affine surface, H = 0.8, rms slope 0.7, wavelengths of 5
mm to 20 um, and 0.3 MPa: chosen here. The shear law, 6 MPa at 5 mm/s, is of the size
that was found for dry tread rubber; of this rubber none is known.

Check: under a pressure that fills the surface friction is the exact sum over its waves,
mu p = (1/2) int q^3 C dq int cos(phi) E''(q v cos phi) dphi, here by quadrature with
the branches and shift factors as they stand in the material file; friction at a
temperature is friction at 25 degC at the velocity v a_T; dry friction is hysteresis and
the stress, by its formula, on the real contact area; and the law of the stress lies in
the 95 % intervals of its fit.

    python examples/28_measured_rubber_on_a_road.py [--out DIR]
"""

import argparse
import tomllib
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from scipy.integrate import trapezoid

import elastomdr as em

FILE = Path(__file__).parents[1] / "materials" / "epdm-70.toml"
RUBBER = em.load_material(FILE)
HURST, SLOPE, LONGEST, SHORTEST = 0.8, 0.7, 5e-3, 20e-6  # -, -, m, m
ROAD = em.SelfAffine(
    HURST, rms_slope=SLOPE, q_low=2 * np.pi / LONGEST, q_high=2 * np.pi / SHORTEST
)
VELOCITY = np.geomspace(1e-5, 0.3, 41)  # m/s
# four of the temperatures at which the rubber was measured
KELVIN = np.array([270.4, 284.21, 298.15, 319.13])
PRESSURE = 3e5  # Pa
STRESS, PEAK, WIDTH, ENERGY = 6e6, 5e-3, 0.1, 8e4  # Pa, m/s, -, J/mol
DRY = em.AdhesiveShear(STRESS, PEAK, WIDTH, shift=em.Arrhenius(ENERGY, 298.15))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    with warnings.catch_warnings():
        # the figure says where, by dots
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        curve = em.friction(
            RUBBER,
            ROAD,
            velocity=VELOCITY,
            pressure=PRESSURE,
            temperature=KELVIN[:, None],
        )
    print(curve.summary())
    places = [["road", "road"], ["dry", "fit"]]
    figure, axes = plt.subplot_mosaic(places, figsize=(8.6, 8.6))
    curve.plot(
        axes["road"],
        title=f"Hysteresis of a measured EPDM on a rough surface, {PRESSURE / 1e6:g} MPa",
    )
    both = dry(axes["dry"], axes["fit"])
    figure.savefig(out / "28_measured_rubber_on_a_road.png")
    plt.close(figure)
    check(curve)
    check_parts(*both)


def dry(parts: Axes, fitted: Axes) -> tuple[em.FrictionCurve, em.fit.AdhesionFit]:
    """Friction with adhesive shear, and the law fitted to noisy points of it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        curve = em.friction(
            RUBBER,
            ROAD,
            velocity=VELOCITY,
            pressure=PRESSURE,
            temperature=298.15,
            adhesion=DRY,
        )
        scene = {
            "velocity": np.geomspace(1e-5, 0.3, 10),
            "pressure": PRESSURE,
            "temperature": KELVIN[1:, None],
        }
        bare = em.friction(RUBBER, ROAD, **scene)
        points = em.friction(RUBBER, ROAD, adhesion=DRY, **scene).mu
    points = points * (1 + 0.02 * np.random.default_rng(0).normal(size=points.shape))
    fit = em.fit.adhesion(bare, points, error="relative", reference=298.15)
    print(f"\n{curve.summary()}\n\n{fit}")
    curve.plot(parts, title="Dry friction, 25 °C")
    fit.plot(fitted)
    return curve, fit


def check_parts(curve: em.FrictionCurve, fit: em.fit.AdhesionFit) -> None:
    by_hand = (
        STRESS
        * np.exp(-WIDTH * np.log10(VELOCITY / PEAK) ** 2)
        * curve.area_ratio
        / PRESSURE
    )
    off = np.abs(curve.mu / (curve.hysteresis + by_hand) - 1).max()
    print(
        "check  hysteresis and the stress on the real contact, by its formula: "
        f"{off:.0e} apart"
    )
    assert off < 1e-12, "friction must be the sum of its parts"
    for name, truth in {"stress": STRESS, "velocity": PEAK, "width": WIDTH}.items():
        low, high = fit.interval[name]
        assert low <= truth <= high, (
            f"the {name} of the points must lie in its interval"
        )


def check(curve: em.FrictionCurve) -> None:
    card = tomllib.loads(FILE.read_text(encoding="utf-8"))
    log10_a = dict(
        zip(card["shift"]["temperature"], card["shift"]["log10_a"], strict=True)
    )
    filled, velocity = 1e10, VELOCITY[::10]  # Pa, m/s
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        # a pressure that no rubber bears, so that the surface is filled
        warnings.filterwarnings("ignore", "pressure is taken", em.ModelWarning)
        pressed = em.friction(
            RUBBER, ROAD, velocity=velocity, pressure=filled, temperature=KELVIN[1]
        )
        shifted = VELOCITY * 10 ** log10_a[KELVIN[1]]
        reference = em.friction(
            RUBBER, ROAD, velocity=shifted, pressure=PRESSURE, temperature=298.15
        )
    by_hand = np.array(
        [full_contact(card, v * 10 ** log10_a[KELVIN[1]]) / filled for v in velocity]
    )
    off = np.abs(pressed.mu / by_hand - 1).max()
    apart = np.abs(curve.mu[1] / reference.mu - 1).max()
    print(
        f"check  full contact by quadrature: {off:.0e} apart; 11 degC against 25 "
        f"degC at v a_T: {apart:.0e} apart"
    )
    assert off < 1e-4, "under a high pressure friction must be the sum over the waves"
    assert apart < 1e-4, "mu(v, T) must be mu(v a_T) at the reference temperature"


def full_contact(card: dict, speed: float) -> float:
    """The friction stress [Pa] at `speed`, v a_T [m/s], of rubber that touches
    everywhere.
    """
    phi = np.pi / 400 * (np.arange(200) + 0.5)  # a quarter of the circle, midpoints
    q = np.geomspace(2 * np.pi / LONGEST, 2 * np.pi / SHORTEST, 2001)
    c = q ** (-2 * (1 + HURST))
    c *= SLOPE**2 / (2 * np.pi * trapezoid(q**4 * c, np.log(q)))
    moduli, times = np.array(card["moduli"]), np.array(card["times"])
    x = q[:, None, None] * speed * np.cos(phi)[:, None] * times
    loss = 4 * (moduli * x / (1 + x**2)).sum(-1)  # E* = 4 G, incompressible
    angular = 4 * np.pi / 400 * loss @ np.cos(phi)
    return 0.5 * float(trapezoid(q**4 * c * angular, np.log(q)))


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
