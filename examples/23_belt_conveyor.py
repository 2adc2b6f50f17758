"""23: what the indentation of its covers costs a belt conveyor: resistance, and power
per kilometre.

Teaches: `em.conveyor` counts the idlers of both sides, each roll at its own load, over
speeds, temperatures and goods, for covers with a whole spectrum; `em.rolling` is one
roll of it. On springs a small loss tangent gives a formula with the powers of the
conveyor literature, f = (3/pi) tan(delta) a/D. One idler in detail is example 04.

Inputs: `epdm-70` of the library, fitted to shear DMA at 0.15 % strain (EPDM is used for
hot goods; by the Payne effect a cover at 3 % is softer than this). Covers 6 mm below
and 8 mm above, steel idlers of 159 mm, troughs of three rolls every 1.2 m with 20, 60
and 20 % of the load, return rolls every 3 m, 28 kg/m of belt 1.2 m wide, 120 kg/m of
goods: chosen here, of the usual size. The covers are layers bonded to the carcass
(`em.layer`), exact in plane strain. Beside them, dotted, the textbook's springs, 4 G/h,
free to slip on the carcass.

Check: on springs, pressure behind the leading edge of a Winkler cover in closed form,
forces by quadrature, for three parameters (Lodewijks 1995) and for the whole spectrum
(Rudolphi & Reicks 2006, Rubber Chem. Technol. 79), one roll and the sum over all rolls
of the belt; the limit of small damping by an integral over the autocorrelation of the
elastic contact; and for a constant tan(delta) the formula above.

    python examples/23_belt_conveyor.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

import elastomdr as em

RUBBER = em.load_material("epdm-70")
# the covers that meet carry and return rolls
BELOW, ABOVE = (em.layer(RUBBER, h) for h in (6e-3, 8e-3))
SPRINGS = [em.springs(RUBBER, h, bonded=False) for h in (6e-3, 8e-3)]  # the textbook's
DIAMETER, WIDTH = 0.159, 1.2  # m
TROUGH, SINGLE = em.Cylinder(DIAMETER / 2, WIDTH / 3), em.Cylinder(DIAMETER / 2, WIDTH)
CARRY = em.Idlers(BELOW, TROUGH, spacing=1.2, shares=[0.2, 0.6, 0.2])
RETURN = em.Idlers(ABOVE, SINGLE, spacing=3.0)
ON_SPRINGS = [
    em.Idlers(SPRINGS[0], TROUGH, spacing=1.2, shares=[0.2, 0.6, 0.2]),
    em.Idlers(SPRINGS[1], SINGLE, spacing=3.0),
]
BELT, GOODS = 28.0, np.array([0.0, 120.0, 240.0])  # kg/m
VELOCITY = np.geomspace(0.5, 10.0, 13)  # m/s
KELVIN = 273.15 + np.array([0.0, 10.0, 20.0, 40.0])
MIDDLE = 0.6 * (BELT + GOODS[1]) * 9.81 * 1.2  # load of the middle roll of a trough [N]
AT = 10  # of the velocities, for the table


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    run = {
        "velocity": VELOCITY,
        "belt": BELT,
        "goods": GOODS[:, None, None],
        "temperature": KELVIN[:, None],
    }
    with warnings.catch_warnings():
        # of 6 points in 312; they are dotted in the figure
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        cost, textbook = (
            em.conveyor(CARRY, RETURN, rtol=1e-5, **run),
            em.conveyor(*ON_SPRINGS, **run),
        )
    print(cost.summary())
    table(cost, textbook)
    at = {"velocity": VELOCITY, "load": MIDDLE, "temperature": KELVIN[:, None]}
    roll, springs = (
        em.rolling(BELOW, TROUGH, rtol=1e-5, **at),
        em.rolling(SPRINGS[0], TROUGH, **at),
    )
    wide = (roll.contact.leading + roll.contact.trailing)[:, AT] / 6e-3
    print(
        f"middle roll: contact {wide.min():.2f} to {wide.max():.2f} times as wide "
        "as "
        "the cover is thick"
    )

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(8.6, 3.4))
    for i, (kelvin, colour) in enumerate(
        zip(KELVIN, ("#1f3d7a", "#3a7fb5", "#d08a2e", "#a03030"), strict=True)
    ):
        label = f"{kelvin - 273.15:g} °C"
        left.semilogx(VELOCITY, roll.coefficient[i], color=colour, label=label)
        left.semilogx(
            VELOCITY, springs.coefficient[i], ":", color=colour, linewidth=1.3
        )
        # W/m is kW/km
        middle.plot(VELOCITY, cost.power[1, i], color=colour, label=label)
        right.plot(BELT + GOODS, cost.power[:, i, AT], "o-", color=colour, label=label)
    left.set(
        xlabel="Belt speed [m/s]",
        ylabel="Resistance of the middle roll / its load [-]",
        ylim=(0, None),
    )
    left.set_title(f"One roll, {MIDDLE / TROUGH.length:.0f} N/m; dotted: springs")
    middle.set(
        xlabel="Belt speed [m/s]",
        ylabel="Power per kilometre [kW]",
        xlim=(0, None),
        ylim=(0, None),
    )
    middle.set_title(f"Both sides, {GOODS[1]:g} kg/m of goods")
    right.set(
        xlabel="Mass of belt and goods [kg/m]",
        ylabel="Power per kilometre [kW]",
        xlim=(0, None),
        ylim=(0, None),
    )
    right.set_title(f"Against the load, at {VELOCITY[AT]:.2g} m/s")
    for ax in (left, middle, right):
        ax.legend()
    figure.savefig(out / "23_belt_conveyor.png")
    plt.close(figure)

    check(springs, textbook)


def table(cost: em.Conveyor, textbook: em.Conveyor) -> None:
    print(
        f"at {VELOCITY[AT]:.2f} m/s with {GOODS[1]:g} kg/m of goods; f of the "
        "whole "
        "belt: resistance over weight"
    )
    print("T [degC]   carry [kW/km]   return [kW/km]   f [-]   springs over layer")
    for i, kelvin in enumerate(KELVIN):
        there = (1, i, AT)
        sides = (
            f"{VELOCITY[AT] * cost.carry[there]:13.3f}   "
            f"{VELOCITY[AT] * cost.back[there]:14.3f}"
        )
        over = textbook.power[there] / cost.power[there]
        print(
            f"{kelvin - 273.15:8.0f}   {sides}   {cost.coefficient[there]:.5f}   "
            f"{over:.2f}"
        )


def winkler(cover: em.Foundation, velocity: float, load_per_width: float) -> float:
    """Resistance over load of a Winkler cover, pressure in closed form, trailing edge
    where it is zero.

    q D = E_0 (a^2 - x^2) + sum 2 E_k [a y (1 - e^-w)/w - y^2 (w - 1 + e^-w)/w^2], y = a
    - x, w = y/(v tau_k).
    """
    s = velocity * cover.times

    def pressure(x: float, a: float) -> float:
        y = a - x
        w = np.maximum(y / s, 1e-300)
        first, second = (
            -np.expm1(-w) / w,
            np.where(w < 1e-4, 0.5 - w / 6, (w + np.expm1(-w)) / w**2),
        )
        return (
            cover.equilibrium * (a**2 - x**2)
            + 2 * cover.moduli @ (a * y * first - y**2 * second)
        ) / DIAMETER

    def forces(a: float) -> tuple[float, float]:
        b = -brentq(pressure, -a, 0.0, args=(a,), xtol=1e-17)
        normal, _ = quad(pressure, -b, a, args=(a,), epsrel=1e-11)
        resistance, _ = quad(
            lambda x: pressure(x, a) * 2 * x / DIAMETER, -b, a, epsrel=1e-11
        )
        return normal, resistance

    a = brentq(lambda a: forces(a)[0] - load_per_width, 1e-4, 5e-2, xtol=1e-16)
    normal, resistance = forces(a)
    return resistance / normal


def first_order(cover: em.Foundation, velocity: float, load_per_width: float) -> float:
    """Sum of E_k int C(r) e^(-r/s_k) dr over the load, C the autocorrelation of the
    slope in the elastic contact.
    """
    a = (0.75 * DIAMETER * load_per_width / cover.equilibrium) ** (1 / 3)

    def correlation(r: float) -> float:
        c = a - r / 2
        return 4 / DIAMETER**2 * (2 / 3 * c**3 - r**2 * c / 2)

    total = 0.0
    for modulus, tau in zip(cover.moduli, cover.times, strict=True):
        s = velocity * tau
        end = min(2 * a, 40 * s)
        total += (
            modulus
            * quad(
                lambda r, s=s: correlation(r) * np.exp(-r / s), 0, end, epsrel=1e-10
            )[0]
        )
    return total / load_per_width


def check(roll: em.RollingCurve, cost: em.Conveyor) -> None:
    three, force, line = (
        em.springs(em.load_material("conveyor-cover"), 6e-3),
        MIDDLE,
        MIDDLE / TROUGH.length,
    )
    for name, cover, computed in (
        (
            "three parameters",
            three,
            em.rolling(three, TROUGH, velocity=5.2, load=force).coefficient,
        ),
        (
            "whole spectrum",
            em.springs(RUBBER.at(KELVIN[2]), 6e-3, bonded=False),
            roll.coefficient[2, AT],
        ),
    ):
        velocity = 5.2 if cover is three else VELOCITY[AT]
        expected = winkler(cover, velocity, line)
        print(f"check     {name}: f = {computed:.9f}, closed form {expected:.9f}")
        assert np.isclose(computed, expected, rtol=2e-6), (
            "the closed form of a Winkler cover"
        )

    full, upper = (
        em.springs(RUBBER.at(KELVIN[2]), h, bonded=False) for h in (6e-3, 8e-3)
    )
    # loads of a side roll and of a return roll [N]
    side, idle = MIDDLE / 3, BELT * 9.81 * 3.0
    carried = [
        n * f * winkler(full, VELOCITY[AT], f / TROUGH.length)
        for n, f in ((2, side), (1, MIDDLE))
    ]
    expected = VELOCITY[AT] * (
        sum(carried) / 1.2 + idle * winkler(upper, VELOCITY[AT], idle / WIDTH) / 3.0
    )
    print(
        f"check     whole belt: {cost.power[1, 2, AT]:.6f} kW/km, rolls in closed "
        f"form, summed: {expected:.6f} kW/km"
    )
    assert np.isclose(cost.power[1, 2, AT], expected, rtol=2e-6), (
        "the sum of rolls in closed form"
    )

    off = []
    for part in (1e-3, 1e-4):  # of the branches
        weak = em.Foundation(full.equilibrium, part * full.moduli, full.times)
        computed = em.rolling(weak, TROUGH, velocity=5.0, load=force).coefficient
        off.append(computed / first_order(weak, 5.0, line) - 1)
        print(
            f"check     {part:g} of the branches: off the limit of small damping "
            f"by {off[-1]:.1e}"
        )
    assert abs(off[1]) < 2e-3, "the limit of small damping"
    assert np.isclose(off[0] / off[1], 10, rtol=0.1), "of first order in the damping"

    # two to a decade: E'' constant
    flat = em.Foundation(1e9, np.full(16, 1e5), np.geomspace(10**-6.65, 10**0.85, 16))
    computed = em.rolling(flat, TROUGH, velocity=5.0, load=force).coefficient
    # of branches evenly on the axis of ln tau
    tangent = np.pi / 2 * 1e5 / np.log(10**0.5) / 1e9
    expected = 3 / np.pi * tangent * (0.75 * line / (1e9 * DIAMETER**2)) ** (1 / 3)
    print(
        f"check     constant tan(delta): f = {computed:.6e}, (3/pi) tan(delta) "
        f"a/D = {expected:.6e}"
    )
    assert np.isclose(computed, expected, rtol=5e-3), (
        "the formula of the literature, for small damping"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
