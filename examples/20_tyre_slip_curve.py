"""20: from a measured compound and a road to the slip curve of a tyre, and which part
of the grip comes from what.

Teaches: the whole way in public calls. `em.friction` with a rubber that softens,
`em.AdhesiveShear` and `em.Heat` gives the friction mu(v, T, p) of dry rubber;
`curve.law()` is that table as an `em.FrictionLaw`, which `to_csv`, `to_abaqus`,
`to_fric_coef` and `to_modelica` write for other programs; `em.traction` with the law as
its `friction` and the `slip` of a wheel that brakes is a viscoelastic brush, whose
`to_tir` writes a Magic Formula.

Inputs: measured, `epdm-70-softening` of the library, shear DMA of a filled EPDM with
its strain sweep, -10 to 53 degC and up to 1.1 % strain. Illustrative: its shift factors
as a WLF law, 0.11 decades off, since flash temperatures go beyond the table; softening
from 1 to 100 % strain, where filled rubber loses a factor of 2 to 10; shear of 5.5 MPa
at 5 mm/s with width 0.1 and 80 kJ/mol, of the size found for dry treads (Lorenz et al.,
J. Chem. Phys. 142 (2015) 194701); a road of H = 0.8, rms slope 1.3, 5 mm to 2 um, with
the heat of stone. Wheel, assumed: radius 0.3 m, width 0.16 m, structure 80 MPa/m, and a
tread that with pattern and carcass shears as much as 70 mm of this rubber.

Check: the table, read by numpy and interpolated by scipy, is the law to rounding; an
elastic tread slips by the brush of tyre mechanics, mu F_N [1 - (1 - zeta)^3] with zeta
= xi R G/(h k a mu); the peak lies between 5 and 15 % slip, with a force over load of
0.7 to 1.5; the Magic Formula misses the curve by less than 0.05.

    python examples/20_tyre_slip_curve.py [--out DIR] [--table FILE]
"""

import argparse
import tempfile
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.interpolate import RegularGridInterpolator
from scipy.optimize import curve_fit

import elastomdr as em

MEASURED = em.load_material("epdm-70-softening")
REFERENCE = 298.15  # K
HEAT = em.Heat(conductivity=0.25, heat_capacity=2e6, road=(1.5, 2e6))
DRY = em.AdhesiveShear(5.5e6, 5e-3, 0.1, shift=em.Arrhenius(8e4, 293.15))
ROAD = em.SelfAffine(
    0.8, rms_slope=1.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 2e-6
)
VELOCITY = np.geomspace(1e-3, 30.0, 14)  # sliding [m/s]
KELVIN = np.array([273.15, 293.15, 313.15])
PRESSURE = np.array([1.2e5, 2.1e5, 3.6e5])  # Pa

# m; Pa/m
TYRE, STRUCTURE = em.Cylinder(radius=0.3, length=0.16), em.Foundation(8e7, [], [])
THICKNESS, SPEED = 70e-3, 25.0  # of what shears [m], of the road [m/s]
LOAD = np.array([2e3, 4e3, 6e3])  # N
SLIP = np.concatenate(
    [
        np.geomspace(1e-3, 0.02, 8),
        np.linspace(0.025, 0.16, 19),
        np.geomspace(0.18, 0.99, 12),
    ]
)
WHEEL = {"velocity": SPEED, "slip": SLIP, "load": LOAD[:, None], "rtol": 1e-4}
BEYOND = {
    "strain": [0.03, 0.1, 0.3, 1.0],
    "storage": [0.7, 0.5, 0.4, 0.35],
    "loss": [1.1, 0.9, 0.7, 0.6],
}


def rubber(softening: em.Softening | None) -> em.Prony:
    """The EPDM with the WLF law of its shift factors."""
    kelvin, log10_a = (
        MEASURED.shift.temperature,
        MEASURED.shift.log10_a(MEASURED.shift.temperature),
    )
    laws = curve_fit(
        lambda t, a, b: -a * (t - REFERENCE) / (b + t - REFERENCE),
        kelvin,
        log10_a,
        p0=(8.0, 100.0),
    )[0]
    return em.Prony(
        MEASURED.equilibrium,
        MEASURED.moduli,
        MEASURED.times,
        kind="shear",
        shift=em.WLF(*laws, REFERENCE),
        softening=softening,
        name="EPDM",
    )


def compound() -> em.Prony:
    """With the measured softening, and beyond it an illustrative one."""
    sweep = MEASURED.softening
    lists = {
        key: np.append(getattr(sweep, key)[:-2], more) for key, more in BEYOND.items()
    }
    return rubber(em.Softening(**lists))


def main(out: Path, table: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    tread = compound()
    curve = em.friction(
        tread,
        ROAD,
        velocity=VELOCITY,
        temperature=KELVIN[:, None, None],
        pressure=PRESSURE[:, None],
        heat=HEAT,
        adhesion=DRY,
        rtol=1e-3,
    )
    print(curve.summary())
    law = curve.law()
    law.to_csv(table)
    parts = sources(tread)

    sheared = em.springs(rubber(None), THICKNESS, tangential=True)
    found = em.traction(
        STRUCTURE,
        TYRE,
        friction=em.load_friction(table),
        temperature=KELVIN[:, None, None],
        tangential=sheared,
        **WHEEL,
    )
    draw(curve, found, parts).savefig(out / "20_tyre_slip_curve.png")
    plt.close("all")
    top = found.peak()
    for i, kelvin in enumerate(KELVIN):
        peaks = ", ".join(
            f"{mu:.2f} at {s:.1%}"
            for mu, s in zip(top.coefficient[i], top.slip[i], strict=True)
        )
        slides = ", ".join(f"{mu:.2f}" for mu in found.coefficient[i, :, -1])
        print(
            f"{kelvin - 273.15:4.0f} degC: largest F_x/F_N {peaks} slip; sliding "
            f"{slides} (2, 4, 6 kN)"
        )
    one = em.traction(
        STRUCTURE,
        TYRE,
        friction=law,
        temperature=KELVIN[1],
        tangential=sheared,
        **WHEEL,
    )
    check(table, law, float(sheared.equilibrium) * THICKNESS, top, one.magic_formula())


def sources(tread: em.Prony) -> dict[str, em.FrictionCurve]:
    """Friction at 20 degC and 0.21 MPa, with one part more in each line."""
    place = {
        "velocity": VELOCITY,
        "temperature": KELVIN[1],
        "pressure": PRESSURE[1],
        "rtol": 1e-3,
    }
    linear, swept = rubber(None), rubber(MEASURED.softening)
    parts = {
        "hysteresis, small strain": em.friction(linear, ROAD, **place),
        "+ softening as measured, to 1 %": em.friction(swept, ROAD, **place),
        "+ softening beyond": em.friction(tread, ROAD, **place),
        "+ adhesive shear": em.friction(tread, ROAD, adhesion=DRY, **place),
        "+ heat": em.friction(tread, ROAD, adhesion=DRY, heat=HEAT, **place),
        "all, without softening": em.friction(
            linear, ROAD, adhesion=DRY, heat=HEAT, **place
        ),
    }
    shown = [int(np.argmin(abs(np.log(VELOCITY / v)))) for v in (1e-2, 1e-1, 1.0, 10.0)]
    head = "  ".join(f"{VELOCITY[i]:7.2g}" for i in shown)
    print(
        f"{'mu at 20 degC, 0.21 MPa, v [m/s]':<34}{head}   contact at "
        f"{VELOCITY[shown[2]]:.2g} m/s"
    )
    for name, part in parts.items():
        numbers = "  ".join(f"{part.mu[i]:7.2f}" for i in shown)
        print(f"{name:<34}{numbers}   {part.area_ratio[shown[2]]:.1%}")
    return parts


def draw(
    curve: em.FrictionCurve, found: em.Traction, parts: dict[str, em.FrictionCurve]
) -> plt.Figure:
    figure, axes = plt.subplots(2, 2, figsize=(8.6, 6.8))
    first, second, third, last = axes.flat
    styles = (
        ("#888888", ":"),
        ("#888888", "--"),
        ("#888888", "-"),
        ("#c8702a", "--"),
        ("#a03030", "-"),
        ("#3a8a4d", "-."),
    )
    for (name, part), (colour, line) in zip(parts.items(), styles, strict=True):
        first.semilogx(VELOCITY, part.mu, line, color=colour, label=name)
    first.set_title("Which part comes from what, 20 °C, 0.21 MPa")
    for i, colour in enumerate(("#1f5a94", "#3a8a4d", "#a03030")):
        second.semilogx(
            VELOCITY, curve.mu[i, 1], color=colour, label=f"{KELVIN[i] - 273.15:.0f} °C"
        )
        second.semilogx(VELOCITY, curve.cold[i, 1], "--", color=colour)
        at = found.peak().place[-1][i, 1]
        last.plot(
            100 * SLIP,
            found.force[i, 1] / 1e3,
            color=colour,
            label=f"{KELVIN[i] - 273.15:.0f} °C",
        )
        last.plot(
            100 * SLIP[at], found.force[i, 1, at] / 1e3, "o", color=colour, markersize=5
        )
    second.set_title("Friction at 0.21 MPa; dashed: without heat")
    last.set_title(f"Braking force, 4 kN, {SPEED:g} m/s; dot: the largest")
    for j, colour in enumerate(("#8bb4d9", "#1f5a94", "#0b2540")):
        at = found.peak().place[-1][1, j]
        third.plot(
            100 * SLIP,
            found.coefficient[1, j],
            color=colour,
            label=f"{LOAD[j] / 1e3:.0f} kN",
        )
        third.plot(
            100 * SLIP[at], found.coefficient[1, j, at], "o", color=colour, markersize=5
        )
    third.set_title(f"Slip curve at 20 °C, {SPEED:g} m/s; dot: the largest")
    for ax in (first, second):
        ax.set(
            xlabel="Sliding velocity [m/s]",
            ylabel="Friction coefficient [-]",
            ylim=(0, None),
        )
    third.set(
        xlabel="Slip [%]",
        ylabel="Braking force over load [-]",
        ylim=(0, None),
        xlim=(0, 100),
    )
    last.set(
        xlabel="Slip [%]", ylabel="Braking force [kN]", ylim=(0, None), xlim=(0, 100)
    )
    for ax in axes.flat:
        ax.legend(
            loc="upper right",
            ncols=2 if ax is first else 1,
            fontsize=7,
            columnspacing=1,
        )
    first.set_ylim(0, 1.7)
    return figure


def check(
    table: Path, law: em.FrictionLaw, modulus: float, top: tuple, formula: tuple
) -> None:
    rows = [row for row in table.read_text().splitlines() if not row.startswith("#")]
    columns = np.loadtxt(rows[1:], delimiter=",", usecols=range(4)).T
    kelvin, pressure, velocity, mu = columns
    axes = [np.unique(kelvin), np.log(np.unique(pressure)), np.log(np.unique(velocity))]
    lookup = RegularGridInterpolator(axes, mu.reshape([axis.size for axis in axes]))
    slide = SLIP * SPEED
    half = (1.5 * LOAD * TYRE.radius / (8e7 * TYRE.length)) ** (1 / 3)
    mean = (LOAD / (2 * half * TYRE.length))[:, None]
    places = np.broadcast_arrays(KELVIN[:, None, None], np.log(mean), np.log(slide))
    found = lookup(np.stack(places, axis=-1))
    off = np.abs(found / law(slide, KELVIN[:, None, None], mean) - 1).max()

    elastic = em.traction(
        STRUCTURE,
        TYRE,
        friction=law,
        temperature=KELVIN[:, None, None],
        tangential=em.springs(
            em.Prony(modulus, [], [], shift=em.WLF(8.86, 101.6, 293.15)),
            THICKNESS,
            tangential=True,
        ),
        **WHEEL,
    )
    zeta = (
        SLIP
        / (1 - SLIP)
        * TYRE.radius
        * modulus
        / (THICKNESS * 8e7 * half[:, None] * found)
    )
    brush = found * (1 - (1 - np.minimum(zeta, 1)) ** 3)
    gap = np.abs(elastic.coefficient / brush - 1).max()
    print(
        f"check     table read by numpy and scipy: off by {off:.0e}; elastic tread "
        f"against the brush: {gap:.0e}"
    )
    print(
        f"check     Magic Formula at 20 degC: {formula.residual:.3f} rms of "
        f"F_x/F_N, {formula.worst:.3f} at worst"
    )
    assert off < 1e-12, "any program must read the table as it was written"
    assert gap < 1e-6, "an elastic tread must follow the brush"
    assert np.all((top.slip > 0.04) & (top.slip < 0.15)), "tyres have their peak there"
    assert np.all((top.coefficient > 0.7) & (top.coefficient < 1.5)), (
        "dry tyres grip like that"
    )
    assert formula.residual < 0.05, "the Magic Formula must fit"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    parser.add_argument(
        "--table", type=Path, help="where to keep the table mu(v, T, p), a CSV file"
    )
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch, warnings.catch_warnings():
        # flash temperatures, fine waves
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        main(given.out, given.table or Path(scratch) / "mu.csv")
