"""27: does the drive of a dry seal stick and slip? A plain yes or no for each speed,
fast and slow.

Teaches: `em.stability` says from a friction curve whether a drive damps its swings,
where friction follows the speed at once; slower than that the rubber remembers the
waves of the rod, and `em.drive` moves drive and seal together, here for several drives
in one `jax.vmap`. `Drive.swing` is how far the velocity swings in each period.

Inputs: seal and rod of example 22 at 20 degC, of which one line, as long as the longest
wave, stands for the contact; pneumatic drive of 5e3 N/m, 5 kg and 20 N s/m: chosen
here. Hysteresis only, no adhesion: docs/seal.md.

Check: Newton's law over the last second of each motion, m dX' = int (k (D - X) + c (D'
- X') - F) dt, and its energy, what the drive gives being kept by spring and mass or
spent on friction and damper, from what is returned and for stick-slip too; a body that
has settled feels the steady friction; and a stiff drive does not stick and slip where a
soft one does, the trend found by Rabinowicz (Proc. Phys. Soc. 71 (1958) 668) and since.

    python examples/27_seal_drive.py [--out DIR]
"""

import argparse
import warnings
from functools import partial
from pathlib import Path

import jax
import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

NAMES = ("epdm-70", "silicone-like")
CORD, ROD, SQUEEZE, AGE, KELVIN = 3e-3, 20e-3, 0.08, 3600.0, 293.15  # m, m, -, s, K
LONGEST = 100e-6  # m
SHAFT = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / LONGEST, q_high=2 * np.pi / 4e-6
)
LINE = SHAFT.line(seed=2, periods=1, samples=128)
VELOCITY = np.geomspace(1e-4, 0.1, 13)  # m/s
MASS, STIFFNESS, DAMPING, STIFF = 5.0, 5e3, 20.0, 1e5  # kg, N/m, N s/m, N/m
# s; in which the drive is drawn until its spring holds the friction
TIME, DRAWN = np.linspace(0, 2.6, 391), 0.05
PERIOD = 2 * np.pi * np.sqrt(MASS / STIFFNESS)  # of the drive by itself [s]
# Which rubber, speed of the drive [m/s], its stiffness [N/m].
CASES = [(0, v, STIFFNESS) for v in (1e-4, 3e-4, 1e-3)] + [
    (1, 3e-4, STIFFNESS),
    (0, 3e-4, STIFF),
]


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    rubbers, loads, normals, curves = [], [], [], []
    for name, colour in zip(NAMES, ("#1f5a94", "#a03030"), strict=True):
        rubber = em.load_material(name).at(KELVIN)
        with warnings.catch_warnings():
            # the data of epdm-70 end after eight minutes
            warnings.simplefilter("ignore", em.ExtrapolationWarning)
            cord = em.o_ring(rubber, CORD, SQUEEZE, time=AGE)
        normal, load = (
            float(cord.line_load) * np.pi * ROD,
            float(cord.pressure) * SHAFT.full_contact_length,
        )
        curve = em.friction(
            rubber,
            LINE,
            velocity=VELOCITY,
            load=load,
            model=em.Line(),
            rtol=1e-3,
        )
        known = em.stability(
            em.Mount(MASS, STIFFNESS, DAMPING),
            velocity=VELOCITY,
            force=curve.mu * normal,
            wavelength=LONGEST,
        )
        least, slowest = known.ratio[known.follows].min(), float(known.slowest)
        said = "slides steadily" if least > 0 else "STICKS AND SLIPS at some speed"
        print(
            f"{name}: above {1e3 * slowest:.1f} mm/s it {said}, damping ratio at "
            f"least {least:.3f}"
        )
        left.semilogx(VELOCITY, known.ratio, ":", color=colour)
        on = known.follows
        left.semilogx(
            VELOCITY[on],
            known.ratio[on],
            color=colour,
            label=f"{name}: {'no' if least > 0 else 'yes'}",
        )
        for kept, value in zip(
            (rubbers, loads, normals, curves),
            (rubber, load, normal, curve),
            strict=True,
        ):
            kept.append(value)

    moved = driven(rubbers, np.array(loads), np.array(normals), curves)
    after = moved["swing"][:, PERIOD * np.arange(moved["swing"].shape[1]) > 1.5]  # s
    # a period with an instant that did not converge is NaN:
    swings = np.nanmax(after, axis=1)
    assert ((swings > 0.5) | np.isfinite(after).all(axis=1)).all(), (
        "a no needs all of them"
    )
    for (which, speed, stiffness), swing, velocity, colour in zip(
        CASES,
        swings,
        moved["velocity"],
        ("#0b2540", "#3a7fb5", "#3a8a4d", "#a03030", "#888888"),
        strict=True,
    ):
        answer = "yes" if swing > 0.5 else "no"
        what = f"{NAMES[which]}, {1e3 * speed:g} mm/s" + (
            ", stiff" if stiffness == STIFF else ""
        )
        said = "STICKS AND SLIPS" if swing > 0.5 else "slides steadily"
        print(
            f"{what}: it {said}, velocity swings by {swing:.2f} of the drive's "
            "after "
            "1.5 s"
        )
        seen = np.isfinite(velocity)
        if stiffness == STIFFNESS:
            right.plot(
                TIME[seen],
                velocity[seen] / speed,
                color=colour,
                linewidth=1.2,
                label=f"{what}: {answer}",
            )
    left.axhline(0, color="#888888", linewidth=1)
    left.axvline(slowest, color="#888888", linestyle="--", linewidth=1)
    left.set(
        xlabel="Speed of the drive [m/s]",
        ylabel="Damping ratio of drive and seal [-]",
        ylim=(-0.5, 0.2),
    )
    left.set_title("Stick-slip, fast? Dotted: decides nothing")
    right.set(
        xlabel="Time [s]",
        ylabel="Velocity of the rod / of the drive [-]",
        ylim=(0, 5),
        xlim=(0, 2.6),
    )
    right.set_title("Stick-slip, slow? Drive of 5 kN/m")
    for ax in (left, right):
        ax.legend(ncols=2 if ax is right else 1)
    figure.savefig(out / "27_seal_drive.png")
    plt.close(figure)
    check(moved, swings, curves, np.array(normals))


def driven(
    rubbers: list[em.Prony], loads: np.ndarray, normals: np.ndarray, curves: list
) -> dict[str, np.ndarray]:
    """The motions of each rubber at once, forces as of the whole seal, for which the
    line stands (`Mount.for_line`).
    """
    which = np.array([case[0] for case in CASES])
    speed, stiffness = (np.array([case[i] for case in CASES]) for i in (1, 2))
    hold = (
        np.array([float(curves[i].law()(v)) * normals[i] for i, v, _ in CASES])
        / stiffness
    )

    def pulled(
        rubber: em.Prony,
        v: jax.Array,
        k: jax.Array,
        hold: jax.Array,
        load: jax.Array,
        normal: jax.Array,
    ) -> dict:
        place = hold * np.minimum(TIME / DRAWN, 1) + v * TIME
        mount = em.Mount(MASS, k, DAMPING).for_line(load, normal)
        found = em.drive(
            rubber,
            LINE,
            time=TIME,
            position=place,
            load=load,
            tangential=mount,
            rtol=0.1,
        )
        spring = k * (place - found.position)  # of the whole drive [N]
        return {
            "velocity": found.velocity,
            "swing": found.swing(PERIOD),
            "pull": spring,
            "friction": found.mu * normal,
        }

    found = []
    for i, rubber in enumerate(rubbers):
        own = which == i
        with jax.enable_x64(True):
            each = (
                speed[own],
                stiffness[own],
                hold[own],
                loads[which[own]],
                normals[which[own]],
            )
            found.append(jax.vmap(partial(pulled, rubber))(*each))
    back = np.argsort(np.argsort(which, kind="stable"))  # into the order of CASES
    return {
        name: np.concatenate([np.asarray(each[name]) for each in found])[back]
        for name in found[0]
    }


def check(
    moved: dict[str, np.ndarray], swings: np.ndarray, curves: list, normals: np.ndarray
) -> None:
    late = TIME[-1] - 1.0 < TIME
    for i, (which, speed, stiffness) in enumerate(CASES):
        velocity, pull, friction = (
            moved[name][i][late] for name in ("velocity", "pull", "friction")
        )
        known = np.isfinite(pull) & np.isfinite(friction)
        time, velocity, pull, friction = (
            x[known] for x in (TIME[late], velocity, pull, friction)
        )
        given = np.trapezoid(pull + DAMPING * (speed - velocity) - friction, time)
        off = abs(MASS * (velocity[-1] - velocity[0]) - given) / np.trapezoid(
            friction, time
        )
        # What the drive gives through spring and damper; the place of the rod is that
        # of the drive less pull/k.
        work = speed * np.trapezoid(pull + DAMPING * (speed - velocity), time)
        kept = (pull[-1] ** 2 - pull[0] ** 2) / (2 * stiffness) + MASS * (
            velocity[-1] ** 2 - velocity[0] ** 2
        ) / 2
        spent = np.trapezoid(friction, speed * time - pull / stiffness)
        spent += DAMPING * np.trapezoid((speed - velocity) ** 2, time)
        lost = abs(work - kept - spent) / work
        print(
            f"check     {1e3 * speed:g} mm/s: momentum off by {off:.0e}, energy by "
            f"{lost:.0e}"
        )
        # a tenth of what the motion was asked for
        assert max(off, lost) < 1e-2, "momentum and energy of the rod"
        if swings[i] < 0.1:
            steady = float(curves[which].law()(speed)) * normals[which]
            print(
                f"check     {1e3 * speed:g} mm/s: settled, friction "
                f"{friction.mean() / steady - 1:+.1e}"
            )
            assert abs(friction.mean() / steady - 1) < 0.02, (
                "a rod that has settled feels the steady friction"
            )
    soft, stiff = swings[1], swings[-1]
    print(
        f"check     0.3 mm/s: swing {soft:.2f} with {STIFFNESS:g} N/m, {stiff:.2f} "
        f"with {STIFF:g} N/m"
    )
    assert stiff < 0.2 * soft, (
        "a stiff drive must not stick and slip where a soft one does"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    # a minute in all: a bar on a terminal
    with em.progress("moving five drives"):
        main(parser.parse_args().out)
