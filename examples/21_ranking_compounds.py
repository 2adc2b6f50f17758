"""21: compounds ranked on one road, and the frequencies that decide.

Teaches: `em.friction_bands` splits the friction of a rough surface by the frequency at which the road strains the
rubber. The bands of a point sum to its friction coefficient, exactly in partial contact too; `central()` gives the
frequencies between which most of it arises. What decides the ranking is the loss in that band, v q_low to v q_high of
the road, not the loss tangent at a laboratory's 10 Hz. At 10 Hz and 0 degC that is a guess at the band by
time-temperature superposition; at 20 or 60 degC, as for rolling resistance, it asks about other frequencies.

Inputs: five compounds of the library, all illustrative, at 20 degC; the road is assumed here, of no measurement and
steeper than that of example 20: self-affine, H = 0.8, rms slope 1.3, wavelengths 5 mm to 0.1 mm; 0.2 MPa, sliding at
1 m/s. Hysteresis only, no flash temperature.

Check: the band against 10 Hz by trial, the band taken from the road, not from the engine. The compound that rubs least
is given 0.2 MPa more in one branch. In that of 10 Hz it gets the largest loss tangent at 10 Hz of all, and still rubs
least; in the middle of the band its loss tangent at 10 Hz stays the lowest, and friction grows by half. Where the
rubber touches everywhere (a line of three waves under a high load) the bands are the closed form sum (1/2) A^2 k
E''(k v)/F; on the road friction ranks the compounds nearly as tan delta at 0 degC and 10 Hz does, and less as that at
60 degC does: the trend by which treads are developed (Nordsiek, Kautschuk Gummi Kunststoffe 38 (1985) 178).

    python examples/21_ranking_compounds.py [--out DIR]
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.stats import spearmanr

import elastomdr as em

NAMES = ("tread-passenger-synthetic", "tread-winter-synthetic", "sbr-gum-like", "natural-rubber-like", "silicone-like")
COLOURS = ("#0b2540", "#1f5a94", "#a03030", "#c98a1b", "#3a8a4d")
ROAD = em.SelfAffine(0.8, rms_slope=1.3, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 1e-4)
KELVIN, PRESSURE, VELOCITY = 293.15, 2e5, 1.0  # K, Pa, m/s
TEN_HERTZ = 20 * np.pi  # rad/s


def main(out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    rubbers = [em.load_material(name) for name in NAMES]
    found = [
        em.friction_bands(rubber, ROAD, velocity=VELOCITY, pressure=PRESSURE, temperature=KELVIN) for rubber in rubbers
    ]
    friction = np.array([bands.total for bands in found])
    cool, hot = (np.array([rubber.at(k).loss_tangent(TEN_HERTZ) for rubber in rubbers]) for k in (273.15, 333.15))
    for i in np.argsort(-friction):
        low, high = (w / (2 * np.pi) for w in found[i].central())
        print(
            f"{NAMES[i]:26} mu {friction[i]:.3f}, eight tenths of it from {low:.0f} to {high:.0f} Hz; tan delta at "
            f"10 Hz: {cool[i]:.3f} at 0 degC, {hot[i]:.3f} at 60 degC"
        )

    first = np.argsort(-friction)[:2]
    asked = {"velocity": VELOCITY, "pressure": PRESSURE, "temperature": KELVIN, "seeds": 3}
    for name, curve in ((NAMES[i], em.friction(rubbers[i], ROAD, **asked)) for i in first):
        print(f"{name:26} over three lines of the road: mu {curve.mu:.3f}, standard error {curve.rough.scatter:.3f}")

    figure, (left, right) = plt.subplots(1, 2, figsize=(11.4, 4.6), layout="constrained")
    omega = np.geomspace(1.0, 1e7, 200)
    for name, bands, rubber, colour in zip(NAMES, found, rubbers, COLOURS, strict=True):
        bands.plot(left, title="Friction by frequency, 1 m/s" if rubber is rubbers[0] else None, colour=colour)
        right.loglog(omega, rubber.at(KELVIN).loss_tangent(omega), color=colour, label=f"{name}, mu {bands.total:.3f}")
    low, high = np.min([b.central()[0] for b in found]), np.max([b.central()[1] for b in found])
    right.axvspan(low, high, color="#dddddd", zorder=0, label="eight tenths of the friction")
    right.axvline(TEN_HERTZ, color="#888888", linestyle=":", label="10 Hz")
    right.set(xlabel="Frequency [rad/s]", ylabel="Loss tangent at 20 °C [-]", ylim=(1e-3, None))
    left.get_legend().remove()  # the colours are those of the other axes
    right.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    right.grid(color="#dddddd")
    figure.savefig(out / "21_ranking_compounds.png", dpi=150)
    plt.close(figure)

    check(friction, cool, hot)
    check_band(rubbers, friction)


def check(friction: np.ndarray, cool: np.ndarray, hot: np.ndarray) -> None:
    by_cool, by_hot = (float(spearmanr(friction, tangent).statistic) for tangent in (cool, hot))
    wave, height, load = np.array([1e3, 4e3, 2e4]), np.array([2e-5, 8e-6, 2e-6]), 1e4  # rad/m, m, N/m
    x = np.arange(4096) * 2 * np.pi / wave[0] / 4096
    line = em.RoughLine(x, height @ np.cos(wave[:, None] * x))
    rubber = em.half_space(em.load_material(NAMES[0]).at(KELVIN))
    full = em.friction_bands(rubber, line, velocity=VELOCITY, load=load, average=None)
    closed = float(0.5 * height**2 * wave @ rubber.loss(wave * VELOCITY) / load)
    print(
        f"check     rank correlation with tan delta {by_cool:.2f} (0 degC), {by_hot:.2f} (60 degC); full contact: mu "
        f"{full.total:.6f}, closed form {closed:.6f}"
    )
    assert by_cool > max(by_hot, 0.8), "the road must rank compounds as the loss at 0 degC, 10 Hz does"
    assert abs(full.total / closed - 1) < 1e-3, "in full contact the bands are a sum over the waves"


def check_band(rubbers: list[em.Prony], friction: np.ndarray) -> None:
    """More loss at the laboratory's frequency, or as much in the road's band, of the compound that rubs least."""
    least = int(friction.argmin())
    own = rubbers[least].at(KELVIN)
    others = np.array([rubber.at(KELVIN).loss_tangent(TEN_HERTZ) for i, rubber in enumerate(rubbers) if i != least])
    middle = VELOCITY * float(np.sqrt(ROAD.q_low * ROAD.q_high))
    found = []
    for omega in (TEN_HERTZ, middle):
        more = np.zeros(own.times.size)
        more[np.abs(np.log(own.times * omega)).argmin()] = 2e5  # Pa
        changed = em.Prony(own.equilibrium, own.moduli + more, own.times)
        mu = em.friction_bands(changed, ROAD, velocity=VELOCITY, pressure=PRESSURE).total
        tangent = float(changed.loss_tangent(TEN_HERTZ))
        print(
            f"check     {NAMES[least]}, more loss at {omega:.0f} rad/s: tan delta at 10 Hz {tangent:.3f}, mu {mu:.3f}"
        )
        found.append((tangent, mu))
    (outside, same), (inside, grown) = found
    assert outside > others.max(), "by its loss tangent at 10 Hz it would be ranked first"
    assert same < 1.1 * friction.min(), "loss outside of the band must not add to friction"
    assert inside < others.min(), "by its loss tangent at 10 Hz it would be ranked last"
    assert grown > 1.4 * friction.min(), "loss in the band must"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path(), help="folder for the figure (default: this one)")
    main(parser.parse_args().out)
