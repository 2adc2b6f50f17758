"""21: compounds ranked on one road, and the frequencies that decide.

Teaches: on a road the loss tangent in the band of frequencies from v q_low to v q_high
ranks compounds, and not that at a laboratory's 10 Hz and 20 degC. `em.friction` gives
the friction; `em.friction_spectrum` splits that of a line of the same road by the
frequency at which the rubber is strained, and its `central()` is the band in which most
of it arises.

Inputs: five compounds of the library, all illustrative, at 20 degC; the road is assumed
here, of no measurement: self-affine, H = 0.8, rms slope 1.3, wavelengths 5 mm to 0.1
mm; 0.2 MPa, sliding at 1 m/s. Contact is light, a few per cent. Hysteresis only, no
flash temperature.

Check: the band against 10 Hz by trial, the band taken from the road, not from the
engine. The compound that rubs least is given 0.2 MPa more in one branch. In that of 10
Hz it gets the largest loss tangent at 10 Hz of all, and still rubs least; in the middle
of the band its loss tangent at 10 Hz stays as it was, and friction grows. By their mean
loss tangent over the band the order of the compounds is that of friction, by that at 10
Hz it is not; by that at 0 degC and 10 Hz it is nearer than by that at 60 degC, the
trend by which treads are developed (Nordsiek, Kautschuk Gummi Kunststoffe 38 (1985)
178). Where the rubber touches everywhere (a line of three waves under a high load) the
bands are the closed form sum (1/2) A^2 k E''(k v)/F.

    python examples/21_ranking_compounds.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import spearmanr

import elastomdr as em

NAMES = (
    "tread-passenger-synthetic",
    "tread-winter-synthetic",
    "sbr-gum-like",
    "natural-rubber-like",
    "silicone-like",
)
COLOURS = ("#0b2540", "#1f5a94", "#a03030", "#c98a1b", "#3a8a4d")
ROAD = em.SelfAffine(
    0.8, rms_slope=1.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 1e-4
)
KELVIN, PRESSURE, VELOCITY = 293.15, 2e5, 1.0  # K, Pa, m/s
# for the split by frequency
LINE = em.Line(average=True, equivalent_length="full contact")
# rad/s
TEN_HERTZ, MIDDLE = 20 * np.pi, VELOCITY * float(np.sqrt(ROAD.q_low * ROAD.q_high))


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    rubbers = [em.load_material(name) for name in NAMES]
    asked = {"velocity": VELOCITY, "pressure": PRESSURE, "temperature": KELVIN}
    curves = [em.friction(rubber, ROAD, **asked) for rubber in rubbers]
    friction = np.array([curve.mu for curve in curves])
    with warnings.catch_warnings():
        # of the line the split is used, not the level
        warnings.simplefilter("ignore", em.ModelWarning)
        found = [
            em.friction_spectrum(rubber, ROAD, model=LINE, **asked)
            for rubber in rubbers
        ]
    cool, room, hot = (
        tangents(rubbers, TEN_HERTZ, kelvin) for kelvin in (273.15, KELVIN, 333.15)
    )
    inside = VELOCITY * np.geomspace(ROAD.q_low, ROAD.q_high, 33)
    band = np.mean([tangents(rubbers, omega, KELVIN) for omega in inside], axis=0)
    for i in np.argsort(-friction):
        low, high = (w / (2 * np.pi) for w in found[i].central())
        print(
            f"{NAMES[i]:26} mu {friction[i]:.3f} at {curves[i].area_ratio:.1%} "
            f"contact, eight tenths from {low:.0f} to {high:.0f} Hz; tan delta in the "
            f"band {band[i]:.3f}, at 10 Hz {room[i]:.3f}"
        )

    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 4.2))
    omega = np.geomspace(1.0, 1e7, 200)
    for name, bands, curve, rubber, colour in zip(
        NAMES, found, curves, rubbers, COLOURS, strict=True
    ):
        bands.plot(
            left,
            title="By frequency, 1 m/s, line" if rubber is rubbers[0] else None,
            colour=colour,
        )
        right.loglog(
            omega,
            rubber.at(KELVIN).loss_tangent(omega),
            color=colour,
            label=f"{name}, mu {curve.mu:.3f}",
        )
    low, high = (
        np.min([b.central()[0] for b in found]),
        np.max([b.central()[1] for b in found]),
    )
    right.axvspan(
        low, high, color="#dddddd", zorder=0, label="eight tenths of the friction"
    )
    right.axvline(TEN_HERTZ, color="#888888", linestyle=":", label="10 Hz")
    right.set(
        xlabel="Angular frequency [rad/s]",
        ylabel="Loss tangent at 20 °C [-]",
        ylim=(1e-3, None),
    )
    left.autoscale(axis="y")
    left.set_ylim(0, None)
    left.get_legend().remove()  # the colours are those of the other axes
    figure.legend(
        *right.get_legend_handles_labels(), loc="outside lower center", ncols=3
    )
    figure.savefig(out / "21_ranking_compounds.png")
    plt.close(figure)

    check(friction, band, cool, room, hot)
    check_band(rubbers, friction)


def tangents(rubbers: list[em.Prony], omega: float, kelvin: float) -> np.ndarray:
    """Loss tangents at `omega` [rad/s] and `kelvin` [K]."""
    return np.array(
        [float(rubber.at(kelvin).loss_tangent(omega)) for rubber in rubbers]
    )


def check(friction: np.ndarray, *orders: np.ndarray) -> None:
    by_band, by_cool, by_room, by_hot = (
        float(spearmanr(friction, tangent).statistic) for tangent in orders
    )
    # rad/m, m, N/m
    wave, height, load = np.array([1e3, 4e3, 2e4]), np.array([2e-5, 8e-6, 2e-6]), 1e4
    x = np.arange(4096) * 2 * np.pi / wave[0] / 4096
    line = em.RoughLine(x, height @ np.cos(wave[:, None] * x))
    rubber = em.half_space(em.load_material(NAMES[0]).at(KELVIN))
    full = em.friction_spectrum(
        rubber, line, velocity=VELOCITY, load=load, model=em.Line()
    )
    closed = float(0.5 * height**2 * wave @ rubber.loss(wave * VELOCITY) / load)
    print(
        f"check     rank correlation with tan delta {by_band:.2f} (band), "
        f"{by_room:.2f} (10 Hz), {by_cool:.2f} (10 Hz, 0 degC), {by_hot:.2f} (10 Hz, "
        f"60 degC); full contact: mu {full.total:.6f}, closed form {closed:.6f}"
    )
    assert by_band > 0.9 > by_room, (
        "the loss tangent in the band must rank the compounds"
    )
    assert by_cool > by_hot, (
        "at 10 Hz that of 0 degC must say more than that of 60 degC"
    )
    assert abs(full.total / closed - 1) < 1e-3, (
        "in full contact the bands are a sum over the waves"
    )


def check_band(rubbers: list[em.Prony], friction: np.ndarray) -> None:
    """More loss at the laboratory's frequency, or as much in the road's band, of the
    compound that rubs least.
    """
    least = int(friction.argmin())
    own = rubbers[least].at(KELVIN)
    others = np.array(
        [
            rubber.at(KELVIN).loss_tangent(TEN_HERTZ)
            for i, rubber in enumerate(rubbers)
            if i != least
        ]
    )
    found = []
    for omega in (TEN_HERTZ, MIDDLE):
        more = np.zeros(own.times.size)
        more[np.abs(np.log(own.times * omega)).argmin()] = 2e5  # Pa
        changed = em.Prony(own.equilibrium, own.moduli + more, own.times)
        mu = float(em.friction(changed, ROAD, velocity=VELOCITY, pressure=PRESSURE).mu)
        tangent = float(changed.loss_tangent(TEN_HERTZ))
        print(
            f"check     {NAMES[least]}, more loss at {omega:.0f} rad/s: tan delta "
            f"at 10 Hz {tangent:.3f}, mu {mu:.3f}"
        )
        found.append((tangent, mu))
    (outside, same), (inside, grown) = found
    assert outside > others.max(), (
        "by its loss tangent at 10 Hz it would be ranked first"
    )
    assert same < 1.1 * friction.min(), (
        "loss outside of the band must not add to friction"
    )
    assert abs(inside / float(own.loss_tangent(TEN_HERTZ)) - 1) < 0.05, (
        "its loss tangent at 10 Hz hardly changes"
    )
    assert grown > 1.1 * friction.min(), "loss in the band must"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
