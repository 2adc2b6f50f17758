"""20: from a DMA file and a road to the slip curve of a tyre.

Teaches: the whole way in public calls. `em.read_dma` and `em.fit.material` make a material of a laboratory's file,
`em.read_spectrum` a road of a table; `em.friction` gives mu(v, T, p), with and without flash temperature;
`curve.law()` is that table as an `em.FrictionLaw`, which `to_csv` writes for any tyre model and `em.load_friction`
reads; `em.traction` with the law as its `friction` and the `slip` of a wheel that brakes is a viscoelastic brush.

Inputs: data/dma.csv and data/road.csv, made up with noise (data/README.md): tensile DMA, -20 to 60 degC, 0.2 to 100 Hz;
spectrum of an asphalt-like surface, of which waves from 5 mm to 0.1 mm are kept: assumed, a rms slope of 0.68. Name
your own files with --dma and --road. Heat 0.25 W/(m K), 2 MJ/(m^3 K): assumed, as in example 19. Wheel: tread 8 mm
thick and 0.16 m wide without a pattern, radius 0.3 m, and a structure of 80 MPa/m, which makes a contact 10 cm long at
4 kN: assumed. Only hysteresis is in mu, no adhesion: a dry tyre has more.

Check: the table, read by numpy and interpolated by scipy, is the law to rounding; with an elastic tread the slip curve
is the brush of tyre mechanics, mu F_N [1 - (1 - zeta)^3] with zeta = xi R G/(h k a mu), mu from that table.

    python examples/20_tyre_slip_curve.py [--out DIR] [--table FILE] [--dma FILE] [--road FILE]
"""

import argparse
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import RegularGridInterpolator

import elastomdr as em

REFERENCE = 293.15  # K
DATA = Path(__file__).parent / "data"
WAVES = {"longest": 5e-3, "shortest": 1e-4}  # m
HEAT = em.Heat(conductivity=0.25, heat_capacity=2e6)
VELOCITY = np.geomspace(1e-2, 30.0, 15)  # sliding [m/s]
KELVIN = np.array([258.15, 278.15, 298.15])
PRESSURE = np.array([1.2e5, 2.1e5, 3.6e5])  # Pa

TYRE, STRUCTURE = em.Cylinder(radius=0.3, length=0.16), em.Foundation(8e7, [], [])  # m; Pa/m
THICKNESS, SPEED = 8e-3, 25.0  # of the tread [m], of the road [m/s]
LOAD = np.array([2e3, 4e3, 6e3])  # N
SLIP = np.concatenate([np.geomspace(4e-4, 0.02, 12), np.linspace(0.025, 0.1, 10), np.geomspace(0.11, 0.99, 16)])
WHEEL = {"velocity": SPEED, "slip": SLIP, "load": LOAD[:, None], "rtol": 1e-4}


def main(out: Path, table: Path, dma: Path, spectrum: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    fit = em.fit.material(em.read_dma(dma), REFERENCE, name="tread", poisson=0.5, citation=dma.name)
    tread, road = fit.material, em.read_spectrum(spectrum, convention="2d", **WAVES)

    curve = em.friction(
        tread,
        road,
        velocity=VELOCITY,
        temperature=KELVIN[:, None, None],
        pressure=PRESSURE[:, None],
        heat=HEAT,
        rtol=1e-3,
    )
    print(curve.summary())
    curve.law().to_csv(table)
    laws = {"with flash temperature": em.load_friction(table), "without": curve.law(cold=True)}

    sheared = em.springs(tread, THICKNESS, tangential=True)
    warm, cold = (
        em.traction(STRUCTURE, TYRE, friction=law, temperature=KELVIN[:, None, None], tangential=sheared, **WHEEL)
        for law in laws.values()
    )
    draw(curve, warm, cold).savefig(out / "20_tyre_slip_curve.png", dpi=150)
    plt.close("all")
    for name, found in zip(laws, (warm, cold), strict=True):
        top = found.peak()
        for i, kelvin in enumerate(KELVIN):
            peaks = ", ".join(f"{mu:.3f} at {s:.0%}" for mu, s in zip(top.coefficient[i], top.slip[i], strict=True))
            slides = ", ".join(f"{mu:.3f}" for mu in found.coefficient[i, :, -1])
            print(f"{kelvin - 273.15:4.0f} degC, {name}: largest F_x/F_N {peaks} slip; sliding {slides} (2, 4, 6 kN)")
    check(table, laws["with flash temperature"], float(sheared.equilibrium) * THICKNESS)


def draw(curve: em.FrictionCurve, warm: em.Traction, cold: em.Traction) -> plt.Figure:
    figure, axes = plt.subplots(2, 2, figsize=(10.4, 7.6), layout="constrained")
    first, runs = axes[0, 0], ((warm, "-"), (cold, "--"))
    for i, colour in enumerate(("#1f5a94", "#3a8a4d", "#a03030")):
        first.semilogx(VELOCITY, curve.mu[i, 1], color=colour, label=f"{KELVIN[i] - 273.15:.0f} °C")
        first.semilogx(VELOCITY, curve.cold[i, 1], "--", color=colour)
    first.set(xlabel="Sliding velocity [m/s]", ylabel="Friction coefficient [-]", ylim=(0, None))
    first.set_title("Tread on the road, 0.21 MPa", fontsize=10, loc="left")
    for i, ax in enumerate(axes.flat[1:]):
        for j, colour in enumerate(("#8bb4d9", "#1f5a94", "#0b2540")):
            for found, style in runs:
                force, at = found.force[i, j] / 1e3, found.peak().place[-1][i, j]
                label = f"{LOAD[j] / 1e3:.0f} kN" if found is warm else None
                ax.plot(100 * SLIP, force, style, color=colour, label=label)
                ax.plot(100 * SLIP[-1], force[-1], "s", color=colour, markersize=6)
                ax.plot(100 * SLIP[at], force[at], "o", color="#a03030", markersize=4, zorder=3)
        ax.set(xlabel="Slip [%]", ylabel="Braking force [kN]", ylim=(0, None), xscale="log")
        ax.set_title(
            f"{KELVIN[i] - 273.15:.0f} °C, {SPEED:g} m/s; dot: largest, square: sliding", fontsize=10, loc="left"
        )
    for ax in axes.flat:
        ax.grid(color="#dddddd")
        ax.set_axisbelow(True)
        ax.set_ylim(0, 1.15 * ax.get_ylim()[1])
        ax.legend(frameon=False, fontsize=9, ncols=3, loc="upper left", title="dashed: without flash", title_fontsize=8)
    return figure


def check(table: Path, law: em.FrictionLaw, modulus: float) -> None:
    kelvin, pressure, velocity, mu = np.loadtxt(table, delimiter=",", skiprows=4).T
    axes = [np.unique(kelvin), np.log(np.unique(pressure)), np.log(np.unique(velocity))]
    lookup = RegularGridInterpolator(axes, mu.reshape([axis.size for axis in axes]))
    slide = SLIP * SPEED
    half = (1.5 * LOAD * TYRE.radius / (8e7 * TYRE.length)) ** (1 / 3)
    mean = (LOAD / (2 * half * TYRE.length))[:, None]
    places = np.broadcast_arrays(KELVIN[:, None, None], np.log(mean), np.log(slide))
    found = lookup(np.stack(places, axis=-1))
    off = np.abs(found / law(slide, KELVIN[:, None, None], mean) - 1).max()

    elastic = em.traction(
        STRUCTURE, TYRE, friction=law, temperature=KELVIN[:, None, None],
        tangential=em.springs(em.Prony(modulus, [], [], shift=em.WLF(8.86, 101.6, 293.15)), THICKNESS, tangential=True),
        **WHEEL,
    )  # fmt: skip
    zeta = SLIP / (1 - SLIP) * TYRE.radius * modulus / (THICKNESS * 8e7 * half[:, None] * found)
    brush = found * (1 - (1 - np.minimum(zeta, 1)) ** 3)
    gap = np.abs(elastic.coefficient / brush - 1).max()
    print(f"check     table read by numpy and scipy: off by {off:.0e}; elastic tread against the brush: {gap:.0e}")
    assert off < 1e-12, "any program must read the table as it was written"
    assert gap < 1e-6, "an elastic tread must follow the brush"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(), help="folder for the figure (default: this one)")
    parser.add_argument("--table", type=Path, help="where to keep the table mu(v, T, p), a CSV file")
    parser.add_argument("--dma", type=Path, default=DATA / "dma.csv", help="storage and loss modulus of the tread")
    parser.add_argument(
        "--road", type=Path, default=DATA / "road.csv", help='spectrum C(q) of the road, convention "2d"'
    )
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        main(given.out, given.table or Path(scratch) / "mu.csv", given.dma, given.road)
