"""10: a pull-off test: a ball is pressed on rubber and pulled off at several speeds;
from the forces follow the work of adhesion at rest and the cutoff of its edge.

Teaches: `adhesion=em.Adhesion(...)` of `em.indent`; `pull_off`, `model_error`; how two
unknowns are fitted, and how surely.

Inputs: data/pull_off_test.csv, speed and largest pull of a ball of 10 mm radius that
was pressed 30 um deep within 1 s on EPDM at 23 degC (library, measured) and rested
there for 10 s; faster pulls move the edge faster than the data of the rubber reach. The
pulls are made up: computed for 80 mJ/m^2 and 0.2 um, with 4 % of noise.

Check: the 90 % intervals of the fit hold both.

    python examples/10_adhesion.py [--out DIR]
"""

import argparse
import warnings
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from scipy.optimize import least_squares

import elastomdr as em

RADIUS, DEPTH, PRESS, REST, LOW = 10e-3, 30e-6, 1.0, 10.0, -30e-6  # m, m, s, s, m
TRUE = {"work": 0.08, "cutoff": 2e-7}  # J/m^2, m
DATA = Path(__file__).parent / "data" / "pull_off_test.csv"


def pulled(speed: np.ndarray, work: float, cutoff: float) -> em.Indentation:
    """Tests at these speeds [m/s], one on each row."""
    way = np.linspace(0, DEPTH - LOW, 120)
    up = PRESS + REST + way / speed[:, None]
    return em.indent(
        em.load_material("epdm-70"),
        em.Sphere(RADIUS),
        time=np.insert(up, [0, 0], [0.0, PRESS], axis=1),
        depth=np.append([0.0, DEPTH], DEPTH - way),
        adhesion=em.Adhesion(work, cutoff=cutoff),
        temperature=296.15,
    )


def main(out: Path) -> None:
    plt.style.use("elastomdr.figures")
    out.mkdir(parents=True, exist_ok=True)
    speed, pull = np.loadtxt(DATA, delimiter=",", skiprows=2, unpack=True)
    tried = np.unique(speed)

    def misfit(logarithm: np.ndarray) -> np.ndarray:
        found = pulled(tried, *np.exp(logarithm))
        force = np.interp(np.log(speed), np.log(tried), -found.pull_off.force)
        return np.log(force / pull)

    with warnings.catch_warnings():  # edges of values that are tried on the way
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        fit = least_squares(misfit, np.log([0.05, 1e-7]), diff_step=0.02, xtol=1e-3)
    spread = np.sqrt(2 * fit.cost / (len(pull) - 2))
    sigma = spread * np.sqrt(np.diag(np.linalg.inv(fit.jac.T @ fit.jac)))
    low, high = np.exp(fit.x - 1.8 * sigma), np.exp(fit.x + 1.8 * sigma)
    best = pulled(tried, *np.exp(fit.x))
    print(best.summary())

    figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 4.2), layout="constrained")
    for i in (0, -1):
        left.plot(
            1e6 * best.depth[i], 1e3 * best.force[i], label=f"{1e6 * tried[i]:g} µm/s"
        )
    left.set(xlabel="Depth [µm]", ylabel="Force [mN]", ylim=(-30, 60))
    force = -1e3 * best.pull_off.force
    bound = best.model_error[:, 0]
    right.semilogx(1e6 * tried, force, label="fit")
    right.fill_between(1e6 * tried, force * (1 - bound), force * (1 + bound), alpha=0.2)
    right.plot(1e6 * speed, 1e3 * pull, "o", fillstyle="none", label="measured")
    right.set(xlabel="Speed [µm/s]", ylabel="Largest pull [mN]", ylim=(0, None))
    for ax in (left, right):
        ax.legend()
    figure.savefig(out / "10_adhesion.png")
    plt.close(figure)

    for (name, true), ends in zip(
        TRUE.items(), zip(low, high, strict=True), strict=True
    ):
        print(f"check     {name} {ends[0]:.3g} to {ends[1]:.3g}, made with {true:g}")
        assert ends[0] < true < ends[1], f"the interval of {name} must hold it"


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(),
        help="folder for the figure (default: this one)",
    )
    main(parser.parse_args().out)
