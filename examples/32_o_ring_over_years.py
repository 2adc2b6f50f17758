"""32: how long an O-ring holds its sealing force, over thirty years and at three
temperatures.

Teaches: `em.o_ring` over time is the master curve's relaxation on the load of the
squeezed cord; `fluid_pressure` adds what the fluid presses; lines are dotted where the
rubber was not measured for as long. A ring that its groove keeps at its length presses
harder than one that may lengthen: `model_error` is the distance.

Inputs: `epdm-70`, whose data end after eight minutes at 20 degC; a cord of 5 mm,
squeezed by a fifth in a groove 7 mm wide, against 2 MPa. Chemical ageing and
compression set are not in it (docs/seal.md).

Check: force falls with time and temperature, towards the same relaxed value; the
fluid's pressure adds to it in full; the held ring presses 20 to 40 % harder.

    python examples/32_o_ring_over_years.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import elastomdr as em

YEAR = 365.25 * 86400.0  # s
RUBBER = em.load_material("epdm-70")
CORD, SQUEEZE, GROOVE, FLUID = 5e-3, 0.2, 7e-3, 2e6  # m, -, m, Pa
TIME = np.geomspace(1.0, 30 * YEAR, 60)
KELVIN = np.array([[268.15], [293.15], [323.15]])


def ring(formula) -> em.ORing:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        return em.o_ring(
            RUBBER,
            CORD,
            SQUEEZE,
            time=TIME,
            temperature=KELVIN,
            formula=formula,
            fluid_pressure=FLUID,
            groove_width=GROOVE,
        )


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    found = ring("free")
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4), layout="constrained")
    found.plot(left, show="line_load", title="Sealing force")
    found.plot(right, show="sealing_pressure", title="Pressure against 2 MPa of fluid")
    figure.savefig(out / "32_o_ring_over_years.png")
    plt.close(figure)
    print(found.summary())
    check(found, ring("held"))


def check(found: em.ORing, held: em.ORing) -> None:
    assert (np.diff(found.line_load, axis=1) <= 0).all(), "force falls with time"
    assert (np.diff(found.line_load[:, 0]) < 0).all(), "and with temperature"
    assert np.ptp(found.line_load[:, -1]) < 1e-3 * found.line_load[0, -1]
    assert np.allclose(found.sealing_pressure - found.pressure, FLUID, rtol=1e-6)
    harder = held.line_load / found.line_load - 1
    assert harder.min() > 0.2
    assert harder.max() < 0.4
    assert np.allclose(found.model_error, harder * found.line_load)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
