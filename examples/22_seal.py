"""22: a dry O-ring on a reciprocating rod: friction against speed and temperature,
start after a dwell.

Teaches: `em.o_ring` turns a squeeze into a pressure, `em.friction` on a rough surface
that into a force; `em.slide` starts it after a dwell on a line of that surface,
`surface.line(seed)`. Whether its drive sticks and slips: example 27.

Inputs: `epdm-70` (fitted to shear DMA) and `silicone-like` (synthetic, illustrative) of
the library; O-ring of 3 mm cord on a rod of 20 mm, squeezed by 8 % for 1 h; rod ground
rough, H = 0.8, rms slope 0.3, wavelengths of 100 um to 4 um: chosen here. Hysteresis
only, no adhesion: docs/seal.md.

Check: pressed into full contact the friction is a sum over waves in closed form, with
the loss modulus alone, and the start after a dwell, with its break-out, follows from
the relaxation of each branch by hand; the line load of the seal lies within what small
strain (Johnson 1985, section 5.6) and the measured formula (Lindley 1967) leave open, C
= s [ln(4/s) - 1] solved here; all temperatures lie on one curve of v a_T (Grosch 1963).

    python examples/22_seal.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import brentq

import elastomdr as em

NAMES = ("epdm-70", "silicone-like")
CORD, ROD, SQUEEZE, AGE = 3e-3, 20e-3, 0.08, 3600.0  # m, m, -, s
SHAFT = em.SelfAffine(
    0.8, rms_slope=0.3, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 4e-6
)
VELOCITY = np.geomspace(1e-4, 0.1, 31)  # m/s
KELVIN = np.array([293.15, 303.15, 323.15])
LINE = SHAFT.line(seed=1, periods=4, samples=512)
DWELLS = np.array([1.0, 100.0])  # s


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8))
    colours = ("#1f3d7a", "#d08a2e", "#a03030")
    for name, dash in zip(NAMES, ("-", "--"), strict=True):
        rubber = em.load_material(name)
        with warnings.catch_warnings():
            # the data of epdm-70 end after eight minutes
            warnings.simplefilter("ignore", em.ExtrapolationWarning)
            cord = em.o_ring(rubber, CORD, SQUEEZE, time=AGE, temperature=KELVIN[0])
        pressure, normal = float(cord.pressure), float(cord.line_load) * np.pi * ROD
        curve = em.friction(
            rubber,
            SHAFT,
            velocity=VELOCITY,
            temperature=KELVIN[:, None],
            pressure=pressure,
        )
        force = curve.mu * normal
        print(
            f"{name}: {cord.line_load:.0f} N/m on {1e3 * cord.width:.2f} mm, "
            f"{1e-6 * pressure:.2f} MPa, {normal:.0f} N on the rod; friction "
            f"{force.min():.2f} to {force.max():.2f} N"
        )
        for row, kelvin, colour in zip(force, KELVIN, colours, strict=True):
            left.loglog(
                VELOCITY,
                row,
                dash,
                color=colour,
                label=f"{name}, {kelvin - 273.15:g} °C",
            )
        if name == NAMES[0]:
            started = start(right, rubber.at(KELVIN[0]), pressure)
            check(rubber, curve, started, float(cord.line_load))
    left.set(
        xlabel="Speed of the rod [m/s]",
        ylabel="Friction force of the seal [N]",
        ylim=(None, 3),
    )
    left.set_title(f"O-ring of {1e3 * CORD:g} mm, squeezed by {100 * SQUEEZE:g} %")
    right.set(xlabel="Way of the rod [µm]", ylabel="Friction / steady friction [-]")
    right.set_title(f"Start at 10 mm/s after a dwell, {NAMES[0]}")
    for ax in (left, right):
        ax.legend(loc="upper right", ncols=2 if ax is left else 1)
    figure.savefig(out / "22_seal.png")
    plt.close(figure)


def start(ax: plt.Axes, rubber: em.Prony, pressure: float) -> list[em.Slide]:
    load, speed, way = pressure * SHAFT.full_contact_length, 1e-2, 150e-6
    steady = float(
        em.friction(rubber, LINE, velocity=speed, load=load, model=em.Line()).mu
    )
    found = []
    for dwell, colour in zip(DWELLS, ("#8bb4d9", "#0b2540"), strict=True):
        time = np.concatenate([[0.0], dwell + np.linspace(0, way / speed, 241)])
        position = speed * np.maximum(time - dwell, 0)
        slid = em.slide(
            rubber, LINE, time=time, position=position, load=load, rtol=2e-2
        )
        ax.plot(
            1e6 * position[1:],
            slid.mu[1:] / steady,
            color=colour,
            label=f"after {dwell:g} s",
        )
        print(
            f"    start after {dwell:g} s: at most "
            f"{np.nanmax(slid.mu) / steady:.2f} "
            "of steady friction"
        )
        found.append(slid)
    ax.axhline(1, color="#888888", linewidth=1)
    return found


def check(
    rubber: em.Prony, curve: em.FrictionCurve, started: list[em.Slide], line_load: float
) -> None:
    assert curve.converged.all(), "every point must converge"
    assert all(slid.converged.all() for slid in started), "every instant must converge"
    # (half width over diameter)^2
    s = brentq(lambda s: s * (np.log(4 / s) - 1) - SQUEEZE, 1e-6, 0.5)
    strain = 2 * np.pi / 3 * 3 * float(rubber.at(KELVIN[0]).relaxation(AGE)) * CORD * s
    print(
        f"check     line load {line_load:.1f} N/m by Lindley's formula, "
        f"{strain:.1f} "
        "N/m by that of small strain"
    )
    assert 0.7 * strain < line_load < strain, (
        "the measured formula is some way below that of small strain"
    )
    shifted = VELOCITY[10] * rubber.shift.a(KELVIN[1]) / rubber.shift.a(KELVIN)
    pressure = float(curve.pressure.flat[0])
    same = em.friction(
        rubber, SHAFT, velocity=shifted, temperature=KELVIN, pressure=pressure
    ).mu
    assert np.allclose(same, same[1], rtol=1e-4), (
        "all temperatures on one curve of v a_T"
    )
    relaxed, load = rubber.at(KELVIN[0]), 1e4  # N/m, far more than it takes
    full = em.friction(relaxed, LINE, velocity=1e-2, load=load, model=em.Line())
    expected = float(
        em.reference.full_contact_sliding(relaxed, LINE, velocity=1e-2, load=load)
    )
    print(
        f"check     full contact: mu = {float(full.mu):.6e}, sum over waves "
        f"{expected:.6e}"
    )
    assert np.isclose(full.mu, expected, rtol=1e-3), (
        "the sum over waves in full contact"
    )
    time, position = (
        np.asarray(getattr(started[0], name)) for name in ("time", "position")
    )
    slid = np.asarray(
        em.slide(relaxed, LINE, time=time, position=position, load=load, rtol=2e-2).mu
    )[1:]
    by_hand = broken_out(relaxed, time[1:] - DWELLS[0], position[1:]) / load
    off = np.abs(slid - by_hand).max() / by_hand.max()
    print(
        f"check     breaking out of full contact: mu = {slid.max():.6e}, by hand "
        f"{by_hand.max():.6e}; {off:.0e} apart"
    )
    assert off < 2e-2, "the rubber's relaxation by hand"  # as the start was asked for


def broken_out(rubber: em.Prony, time: np.ndarray, position: np.ndarray) -> np.ndarray:
    """Friction of LINE in full contact [N/m], pressed for DWELLS[0], then pulled at an
    even speed from time 0 on.

    A wave, exp(i k v t) at a place of the rubber since then and 1 before, strains a
    branch E exp(-t/tau) to E [exp(-(dwell + t)/tau) + i k v (exp(i k v t) -
    exp(-t/tau))/(i k v + 1/tau)]; E* = 4 G, incompressible.
    """
    waves = 2 / LINE.count * np.fft.rfft(LINE.height)[1:-1]
    k = 2 * np.pi * np.arange(1, waves.size + 1) / LINE.period
    t, ikv = np.maximum(time, 0)[:, None], 1j * k * position[-1] / time[-1]
    held = 4 * float(rubber.equilibrium) * np.exp(ikv * t)
    for modulus, tau in zip(
        4 * np.asarray(rubber.moduli), np.asarray(rubber.times), strict=True
    ):
        moved = ikv * (np.exp(ikv * t) - np.exp(-t / tau)) / (ikv + 1 / tau)
        held = held + modulus * (np.exp(-(DWELLS[0] + t) / tau) + moved)
    return np.sum(np.abs(waves) ** 2 / 2 * k * np.imag(held * np.exp(-ikv * t)), axis=1)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
