"""34: the squeeze of an O-ring that keeps a leak limit at the least friction, for two
compounds and two finishes of the spindle.

Teaches: leak falls with the squeeze (`em.leak`), friction grows (`em.friction` with the
shear of the real contact), so that the best squeeze is the least one that is tight for
certain: with the band of compound and surface, and the bound of the leak model, below
the limit. The pressure of a squeeze is in proportion to the modulus that it must
overcome in the roughness, and that of the oil is not. Where the oil has all of its
pressure, it bears itself; behind it the rubber does, so that a softer compound is
somewhat tighter at the same squeeze, and at its own squeeze causes less friction: that
of what contact bears. A finer finish needs less squeeze. Tolerances of the squeeze come
on top.

Inputs: `epdm-70` and `silicone-like` (synthetic) of the library at 20 degC, a year after
assembly (extrapolated for the first); cord of 3 mm on a spindle of 20 mm, oil of 0.05 Pa
s at 1 bar; turned and fine turned, H = 0.8, wavelengths of 200 to 4 um; shear stress of
the real contact 0.2 MPa (assumed), spindle at 1 mm/s. Bands: twelve draws of hardness
(modulus +-15 %, about 5 IRHD) and of the rms height (+-10 %), with `model_error`. Limit:
half a cubic centimetre a day, chosen here.

Check: leak falls and friction grows with the squeeze; a step less does not keep the
limit; the softer compound and the finer finish are better.

    python examples/34_squeeze_for_a_leak.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBERS = {"epdm-70": "#123c66", "silicone-like": "#d08a2e"}
FINISHES = {"4 µm": (4e-6, "-"), "6 µm": (6e-6, "--")}  # rms height [m]
CORD, SPINDLE, KELVIN, AGE = 3e-3, 20e-3, 293.15, 3.15e7  # m, m, K, s
DROP, OIL, SPEED, SHEAR = 1e5, 0.05, 1e-3, 2e5  # Pa, Pa s, m/s, Pa
LIMIT = 0.5e-6 / 86400  # m^3/s
SQUEEZE = np.linspace(0.01, 0.12, 45)
DRAWS, HARDNESS, HEIGHT = 12, 0.15, 0.10  # number, relative standard deviations


class Band(NamedTuple):
    usual: np.ndarray
    low: np.ndarray
    high: np.ndarray


class Seal(NamedTuple):
    leak: Band  # m^3/s
    force: Band  # N
    choice: int  # number of the least squeeze that is tight for certain


def of_draw(
    rubber: em.Prony, rms_height: float
) -> tuple[em.Leak, np.ndarray, np.ndarray]:
    """Leak, friction force [N] and how far that may be off, over the squeeze."""
    face = em.SelfAffine(
        0.8, rms_height=rms_height, q_low=2 * np.pi / 200e-6, q_high=2 * np.pi / 4e-6
    )
    ring = em.o_ring(
        rubber, CORD, SQUEEZE, time=AGE, temperature=KELVIN, formula="free"
    )
    edge = np.pi * SPINDLE
    leak = em.leak(
        rubber,
        face,
        pressure=ring.pressure + DROP,
        pressure_drop=DROP,
        viscosity=OIL,
        length=ring.width,
        width=edge,
        time=AGE,
        temperature=KELVIN,
    )
    # what oil carries between rubber and face is not for their contact to bear
    along = leak.profile
    fluid = np.trapezoid(along.fluid_pressure, along.x) / ring.width
    bears = ring.pressure + DROP - fluid
    curve = em.friction(
        rubber,
        face,
        velocity=SPEED,
        temperature=KELVIN,
        pressure=bears,
        adhesion=em.AdhesiveShear(SHEAR, 1.0, 0.0),
    )
    normal = bears * ring.width * edge
    return leak, curve.mu * normal, curve.model_error * normal


def stiffer(rubber: em.Prony, factor: float) -> em.Prony:
    return em.Prony(
        rubber.equilibrium * factor,
        rubber.moduli * factor,
        rubber.times,
        shift=rubber.shift,
        vertical=rubber.vertical,
        range=rubber.range,
    )


def seal(rubber: em.Prony, rms_height: float) -> Seal:
    rng = np.random.default_rng(1)
    hard, high = 1 + np.array([[HARDNESS], [HEIGHT]]) * rng.normal(size=(2, DRAWS))
    found = [of_draw(rubber, rms_height)]
    found += [
        of_draw(stiffer(rubber, factor), rms_height * more)
        for factor, more in zip(hard, high, strict=True)
    ]
    rate = np.array([leak.rate for leak, _, _ in found])
    factor = np.array([1 + leak.model_error for leak, _, _ in found])
    force, off = (np.array([each[i] for each in found]) for i in (1, 2))
    # near closing the bound is infinite, on closed seals too
    most = np.where(np.isfinite(factor), rate * np.minimum(factor, 1e99), np.inf)
    leak = Band(rate[0], (rate / factor).min(0), most.max(0))
    friction = Band(force[0], (force - off).min(0), (force + off).max(0))
    return Seal(leak, friction, int(np.flatnonzero(leak.high < LIMIT)[0]))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4))
    seals: dict[tuple[str, str], Seal] = {}
    percent = 100 * SQUEEZE
    for name, colour in RUBBERS.items():
        for finish, (height, dash) in FINISHES.items():
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", em.ExtrapolationWarning)
                each = seals[name, finish] = seal(em.load_material(name), height)
            i, shown = each.choice, np.isfinite(each.leak.high)
            left.plot(percent[shown], 1e9 * each.leak.usual[shown], dash, color=colour)
            band = 1e9 * each.leak.low[shown], 1e9 * each.leak.high[shown]
            left.fill_between(percent[shown], *band, color=colour, alpha=0.12, lw=0)
            label = f"{name}, {finish}"
            right.plot(percent, each.force.usual, dash, color=colour, label=label)
            band = each.force.low, each.force.high
            right.fill_between(percent, *band, color=colour, alpha=0.12, lw=0)
            left.plot(percent[i], 1e9 * each.leak.usual[i], "o", color=colour)
            right.plot(percent[i], each.force.usual[i], "o", color=colour)
            print(
                f"{label}: squeezed by {percent[i]:.2f} %, leak "
                f"{8.64e10 * each.leak.usual[i]:.2f} cm^3/day (at most "
                f"{8.64e10 * each.leak.high[i]:.2f}), friction "
                f"{each.force.usual[i]:.2f} N ({each.force.low[i]:.2f} to "
                f"{each.force.high[i]:.2f})"
            )
    left.axhline(1e9 * LIMIT, color="#a03030", lw=1)
    left.text(percent[-1], 1.2e9 * LIMIT, "limit", color="#a03030", ha="right")
    left.set(ylabel="Leak rate [mm³/s]", yscale="log", title="Leak, after a year")
    right.set(ylabel="Friction force [N]", ylim=(0, 8), title="Friction at 1 mm/s")
    for ax in (left, right):
        ax.set(xlabel="Squeeze [%]", xlim=(percent[0], percent[-1]))
    right.legend(loc="upper left")
    figure.savefig(out / "34_squeeze_for_a_leak.png")
    plt.close(figure)
    best = min(seals, key=lambda key: seals[key].force.usual[seals[key].choice])
    print(f"least friction within the limit: {', '.join(best)}")
    check(seals, best)


def check(seals: dict[tuple[str, str], Seal], best: tuple[str, str]) -> None:
    for each in seals.values():
        flows = each.leak.usual > 0
        assert (np.diff(each.leak.usual[flows]) < 0).all()
        assert (np.diff(each.force.usual) > 0).all()
        assert each.leak.high[each.choice] < LIMIT <= each.leak.high[each.choice - 1]
        assert each.leak.low[each.choice] <= each.leak.usual[each.choice]
    assert best == ("silicone-like", "4 µm"), "the softer compound, the finer finish"
    for name in RUBBERS:
        fine, coarse = (seals[name, finish].choice for finish in FINISHES)
        assert fine < coarse, "a rougher face needs more squeeze"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
