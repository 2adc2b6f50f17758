"""31: how much oil leaks past an O-ring, against its squeeze, over years and roughness.

Teaches: `em.o_ring` gives pressure and width of the contact, to whose pressure that of
the oil is added, since it presses on the ring; `em.leak` gives what flows through the
channels that the roughness of the face leaves open, where contact bears what the oil
between does not. The rate falls over decades while real contact grows towards 42 %,
where channels close; the band is how far the model may be off. Rubber relaxes while it
creeps into the roughness: the leak changes little in years.

Inputs: `epdm-70` at 20 degC, whose data end after eight minutes, so that what is later
is extrapolated (dotted); an O-ring of 5 mm on a turned face, H = 0.8, wavelengths of
200 to 4 um, rms heights of 4 to 6 um; oil of 0.05 Pa s at 1 bar.

Check: more squeeze leaks less; the published theories leak more; twice the viscosity
halves the rate.

    python examples/31_leak.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

RUBBER = em.load_material("epdm-70")
CORD, RING, KELVIN = 5e-3, 50e-3, 293.15  # diameters [m], temperature
DROP, OIL = 1e5, 0.05  # Pa, Pa s
SQUEEZE = np.linspace(0.01, 0.12, 67)
TIMES = {"1 s": 1.0, "5 min": 300.0, "10 years": 3.2e8}
HEIGHTS = {"4 µm": 4e-6, "5 µm": 5e-6, "6 µm": 6e-6}
AGES, USUAL = np.geomspace(1.0, 1e9, 37), 0.04  # s, squeeze


def face(rms_height: float) -> em.SelfAffine:
    return em.SelfAffine(
        0.8, rms_height=rms_height, q_low=2 * np.pi / 200e-6, q_high=2 * np.pi / 4e-6
    )


def leak(rms_height: float, squeeze, time, viscosity: float = OIL, model=None):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        cord = em.o_ring(
            RUBBER, CORD, squeeze, time=time, temperature=KELVIN, formula="free"
        )
        return em.leak(
            RUBBER,
            face(rms_height),
            pressure=cord.pressure + DROP,
            pressure_drop=DROP,
            viscosity=viscosity,
            length=cord.width,
            width=np.pi * RING,
            time=time,
            temperature=KELVIN,
            model=model,
        )


def draw(ax, x, found: em.Leak, colour: str, label: str) -> None:
    rate = np.where(found.rate > 0, 1e9 * found.rate, np.nan)
    factor = 1 + np.where(np.isfinite(found.model_error), found.model_error, np.nan)
    beyond = found.extrapolated
    ax.plot(x, rate, ":", color=colour, label=label if np.all(beyond) else None)
    if not np.all(beyond):
        ax.plot(x, np.where(beyond, np.nan, rate), color=colour, label=label)
    ax.fill_between(
        x, rate / factor, rate * factor, color=colour, alpha=0.15, linewidth=0
    )


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.6, 3.8), sharey=True)
    colours = ("#7fb0dd", "#3c7fbf", "#123c66")
    for (name, time), colour in zip(TIMES.items(), colours, strict=True):
        found = leak(HEIGHTS["4 µm"], SQUEEZE, time)
        draw(left, 100 * SQUEEZE, found, colour, name)
    for (name, height), colour in zip(HEIGHTS.items(), colours, strict=True):
        draw(right, AGES / 86400, leak(height, USUAL, AGES), colour, name)
    left.set(
        xlabel="Squeeze [%]",
        xlim=(0.8, 8.2),
        ylabel="Leak rate [mm³/s]",
        yscale="log",
        ylim=(1e-6, 1),
    )
    left.set_title("Rms height 4 µm")
    right.set(xlabel="Time since it was pressed [days]", xscale="log")
    right.set_title(f"Squeezed by {100 * USUAL:g} %")
    left.legend(loc="upper right", title="After")
    right.legend(loc="upper right", title="Rms height", ncols=3)
    figure.savefig(out / "31_leak.png")
    plt.close(figure)
    usual = leak(HEIGHTS["4 µm"], USUAL, 60.0)
    print(usual.summary())
    check(usual)


def check(usual: em.Leak) -> None:
    at_one_minute = leak(HEIGHTS["4 µm"], SQUEEZE, 60.0)
    flows = at_one_minute.percolates
    assert flows.any()
    assert not flows.all()
    assert (np.diff(at_one_minute.rate[flows]) < 0).all(), "more squeeze leaks less"
    thick = leak(HEIGHTS["4 µm"], USUAL, 60.0, viscosity=2 * OIL)
    assert np.isclose(thick.rate, usual.rate / 2, rtol=1e-12)
    for model in (em.CriticalConstriction(), em.EffectiveMedium()):
        theory = leak(HEIGHTS["4 µm"], USUAL, 60.0, model=model)
        print(f"{model.label} over the default: {theory.rate / usual.rate:.2f}")
        assert theory.rate > usual.rate, "theories leak more"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
