"""36: the stopper of a prefilled syringe: does it leak in storage, and what force moves it?

Teaches: an interference fit is judged by two numbers that pull apart. The rib of the
stopper relaxes at a fixed squeeze, so that its pressure falls with the time of storage
(`em.o_ring`), while under it the rubber creeps into the roughness of the barrel
(`em.leak`, `em.break_out`). The glide force is that of a film of silicone oil
(`em.lubricated`). Twice the squeeze leaks a hundredth, and needs twice the force; the
time of storage matters little for either, as far as rubber only relaxes.

Inputs: `epdm-70` of the library (a stopper is of bromobutyl, for which put your own
material) at 20 degC; three ribs of 0.6 mm radius, taken as halves of cords between
walls, in a barrel of 8.65 mm; roughness of rubber and barrel together, H = 0.8,
wavelengths of 100 to 2 um, rms height 2.4 um, of moulded rubber; water at 50 kPa;
silicone oil of 1000 cSt and 970 kg/m^3; shear stress of the real contact 0.3 MPa
(assumed, of a siliconised barrel). Storage begins with the assembly.

Check: leak and force of the tighter fit; the pressure falls in storage; gliding needs
less force than starting.

    python examples/36_syringe_stopper.py [--out DIR]
"""

import argparse
import itertools
import warnings
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER, KELVIN = em.load_material("epdm-70"), 293.15
RIB, RIBS, BARREL = 0.6e-3, 3, 8.65e-3  # radius, number, diameter [m]
FITS = {0.04: "#7fb0dd", 0.06: "#3c7fbf", 0.08: "#123c66"}  # squeeze of the rib
FACE = em.SelfAffine(
    0.8, rms_height=2.4e-6, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 2e-6
)
STORED = np.geomspace(1.0, 86400.0, 33)  # s
WATER, DROP = 1e-3, 5e4  # Pa s, Pa
OIL, SHEAR, SPEED = 1000e-6 * 970, 3e5, np.geomspace(1e-4, 1e-1, 13)  # Pa s, Pa, m/s
EDGE = np.pi * BARREL


class Fit(NamedTuple):
    ring: em.ORing
    leak: em.Leak
    start: np.ndarray  # N
    glide: np.ndarray  # N, after a day


def fit(squeeze: float) -> Fit:
    ring = em.o_ring(
        RUBBER, 2 * RIB, squeeze, time=STORED, temperature=KELVIN, formula="free"
    )
    held = {"time": STORED, "temperature": KELVIN}
    # one rib alone keeps the water back for certain
    leak = em.leak(
        RUBBER, FACE, pressure=ring.pressure + DROP, pressure_drop=DROP,
        viscosity=WATER, length=ring.width, width=EDGE, **held,
    )  # fmt: skip
    start = em.break_out(
        RUBBER, FACE, pressure=ring.pressure, boundary_shear=SHEAR, **held
    )
    day = em.o_ring(
        RUBBER, 2 * RIB, squeeze, time=86400.0, temperature=KELVIN, formula="free"
    )
    load = float(day.line_load)
    glide = em.lubricated(
        RUBBER, em.Cylinder(RIB, EDGE), velocity=SPEED, load=load * EDGE,
        viscosity=OIL, surface=FACE, boundary_shear=SHEAR, temperature=KELVIN,
        time=86400.0,
    )  # fmt: skip
    return Fit(
        ring,
        leak,
        RIBS * start.mu * ring.line_load * EDGE,
        RIBS * glide.mu * load * EDGE,
    )


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(11, 3.6))
    fits = {}
    for squeeze, colour in FITS.items():
        with warnings.catch_warnings():
            # a day is beyond the data of the rubber, and fast asperities
            warnings.simplefilter("ignore", em.ExtrapolationWarning)
            each = fits[squeeze] = fit(squeeze)
        rate, look = 1e9 * each.leak.rate * 86400, {"color": colour}
        known = ~each.leak.extrapolated
        look["label"] = f"squeezed by {100 * squeeze:.0f} %"
        left.plot(STORED[known], rate[known], **look)
        left.plot(STORED[~known], rate[~known], ":", color=colour)
        factor = 1 + each.leak.model_error
        factor[~np.isfinite(factor)] = np.nan
        left.fill_between(
            STORED, rate / factor, rate * factor, color=colour, alpha=0.15
        )
        middle.plot(STORED[known], each.start[known], **look)
        middle.plot(STORED[~known], each.start[~known], ":", color=colour)
        right.plot(1e3 * SPEED, each.glide, **look)
        print(
            f"{100 * squeeze:.0f} %: {each.ring.pressure[0] / 1e6:.2f} to "
            f"{each.ring.pressure[-1] / 1e6:.2f} MPa, real contact "
            f"{each.leak.area_ratio[-1]:.2f}, leak {rate[-1]:.2g} mm^3/day, start "
            f"{each.start[-1]:.1f} N, glide {each.glide.min():.2f} to "
            f"{each.glide.max():.2f} N"
        )
    left.set(xlabel="Storage [s]", xscale="log", yscale="log")
    left.set(ylabel="Leak of one rib [mm³/day]", title="Leak in storage")
    middle.set(xlabel="Storage [s]", xscale="log", ylim=(0, 2.8))
    middle.set(ylabel="Force [N]", title="Force to start")
    right.set(xlabel="Velocity [mm/s]", xscale="log", ylim=(0, 2.8))
    right.set(ylabel="Force [N]", title="Force to glide on silicone oil")
    middle.legend(loc="lower right")
    figure.savefig(out / "36_syringe_stopper.png")
    plt.close(figure)
    check(list(fits.values()))


def check(fits: list[Fit]) -> None:
    for each in fits:
        assert each.ring.pressure[-1] < 0.9 * each.ring.pressure[0], "the rib relaxes"
        assert each.glide.max() < each.start.min(), "a film is easier than dry contact"
    for loose, tight in itertools.pairwise(fits):
        assert (tight.leak.rate <= loose.leak.rate).all()
        assert (tight.start > loose.start).all()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
