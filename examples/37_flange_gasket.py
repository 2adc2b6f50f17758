"""37: a rubber gasket between flanges: nitrogen in service, helium in the leak test.

Teaches: a gas leaks by the squares of its absolute pressures, and slips at the walls of
narrow channels (`em.leak(..., outlet_pressure=, molar_mass=)`). Helium, whose molecules
fly farther, slips more: how much more it leaks than nitrogen depends on how closed the
gasket is, so that one factor does not translate the test into service. The finish of the
faces decides over the bolts' pressure that is needed.

Inputs: `epdm-70` of the library at 20 degC, five minutes after the bolts were tightened;
springs keep the pressure, which hence is constant; mean diameter 100 mm, 5 mm wide;
faces with H = 0.8, wavelengths of 200 to 4 um, rms heights of 2 and 4 um, taken as those
of one face (the other sits tight); 1 bar over the atmosphere. Viscosities 17.6 and 19.6
uPa s. Limit: 1e-3 mbar l/s, a usual leak rate of a technically tight joint.

Check: leak falls with the pressure; the finer face needs less; the ratio of the gases
grows as the channels close, from that of their viscosities on.

    python examples/37_flange_gasket.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER, KELVIN, HELD = em.load_material("epdm-70"), 293.15, 300.0
FINISHES = {"2 µm": (2e-6, "#3c7fbf"), "4 µm": (4e-6, "#d08a2e")}  # rms height [m]
GASES = {"nitrogen": (17.6e-6, 0.02801, "-"), "helium": (19.6e-6, 0.0040026, "--")}
PRESSURE = np.geomspace(0.15e6, 1.5e6, 49)  # Pa, of rubber and face
DROP, OUTLET = 1e5, 101325.0  # Pa
LENGTH, EDGE = 5e-3, np.pi * 0.1  # m
CLOSED = 0.45  # real contact that is well beyond that of the last channel, 0.415
LIMIT = 1e-4  # Pa m^3/s, 1e-3 mbar l/s


def leak(rms_height: float, viscosity: float, molar_mass: float) -> em.Leak:
    face = em.SelfAffine(
        0.8, rms_height=rms_height, q_low=2 * np.pi / 200e-6, q_high=2 * np.pi / 4e-6
    )
    return em.leak(
        RUBBER, face, pressure=PRESSURE, pressure_drop=DROP, outlet_pressure=OUTLET,
        viscosity=viscosity, molar_mass=molar_mass, length=LENGTH, width=EDGE,
        time=HELD, temperature=KELVIN,
    )  # fmt: skip


def needed(found: em.Leak) -> float:
    """Least pressure [Pa] from which the leak is below the limit for certain, or all
    channels are.
    """
    # not where the bound is infinite or NaN
    below = found.rate * OUTLET < LIMIT / (1 + found.model_error)
    # where the gas has all of its pressure, the rubber bears that much less
    inside = np.interp(PRESSURE - DROP, PRESSURE, found.area_ratio)
    return float(PRESSURE[np.flatnonzero(below | (inside > CLOSED))[0]])


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8))
    found = {}
    for finish, (height, colour) in FINISHES.items():
        for gas, (viscosity, mass, dash) in GASES.items():
            each = found[finish, gas] = leak(height, viscosity, mass)
            flow = np.where(each.rate > 0, 10 * OUTLET * each.rate, np.nan)  # mbar l/s
            label = f"{gas}, rms height {finish}"
            left.plot(PRESSURE / 1e6, flow, dash, color=colour, label=label)
            factor = 1 + np.where(
                np.isfinite(each.model_error), each.model_error, np.nan
            )
            if gas == "nitrogen":
                band = flow / factor, flow * factor
                left.fill_between(PRESSURE / 1e6, *band, color=colour, alpha=0.15, lw=0)
            print(f"{label}: {needed(each) / 1e6:.2f} MPa needed")
        nitrogen, helium = (found[finish, gas] for gas in GASES)
        some = nitrogen.rate > 0
        ratio = helium.rate[some] / nitrogen.rate[some]
        right.plot(PRESSURE[some] / 1e6, ratio, color=colour, label=finish)
    left.axhline(10 * LIMIT, color="#a03030", lw=1)
    left.text(PRESSURE[0] / 1e6, 13 * LIMIT, "limit", color="#a03030")
    left.set(ylabel="Leak [mbar l/s]", yscale="log", ylim=(1e-7, None))
    left.legend(loc="lower left")
    right.axhline(17.6 / 19.6, color="grey", lw=0.8)
    right.text(
        PRESSURE[0] / 1e6, 1.02 * 17.6 / 19.6, "without slip", color="grey", va="bottom"
    )
    right.set(ylabel="Leak of helium over nitrogen")
    right.legend(loc="upper left", title="rms height")
    for ax in (left, right):
        ax.set(xlabel="Pressure of the gasket [MPa]", xscale="log")
    figure.savefig(out / "37_flange_gasket.png")
    plt.close(figure)
    check(found)


def check(found: dict[tuple[str, str], em.Leak]) -> None:
    for each in found.values():
        open_ = each.rate > 0
        assert (np.diff(each.rate[open_]) < 0).all()
    for gas in GASES:
        assert needed(found["2 µm", gas]) < needed(found["4 µm", gas])
    for finish in FINISHES:
        nitrogen, helium = (found[finish, gas] for gas in GASES)
        some = nitrogen.rate > 0
        ratio = helium.rate[some] / nitrogen.rate[some]
        assert (np.diff(ratio) > 0).all()
        assert ratio[0] > 17.6 / 19.6


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
