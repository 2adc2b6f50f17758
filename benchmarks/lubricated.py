"""Processor time of a Stribeck curve against its error: `python benchmarks/lubricated.py`.

64 speeds over five and a half decades, EPDM of the library under a rib of 5 mm: smooth,
rolling and rough. The judge is the same solver on two grids more, the finest four times
as fine; it takes every fourth speed. Times are the processor's of this process, after a
call that loads and imports everything.
"""

import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

import elastomdr as em
from elastomdr.seal import lubricated as solver

RUBBER, RIB = em.load_material("epdm-70"), em.Cylinder(5e-3, 1.0)
ROD = em.SelfAffine(
    0.8, rms_height=0.3e-6, q_low=2 * np.pi / 60e-6, q_high=2 * np.pi / 0.6e-6
)
SPEEDS = np.geomspace(1e-5, 3.0, 64)
SCENES: dict[str, dict[str, Any]] = {
    "smooth": {},
    "rolling": {"rubber": "rolls"},
    "rough": {"surface": ROD, "boundary_shear": 2e5},
}
NUMBERS = ("mu", "film_thickness", "least_film", "flow")
ASKED = 2.0  # s


def curve(velocity: np.ndarray, scene: dict[str, Any]) -> em.Lubricated:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ExtrapolationWarning)
        return em.lubricated(
            RUBBER,
            RIB,
            velocity=velocity,
            load=1e3,
            viscosity=0.05,
            temperature=293.15,
            **scene,
        )


@contextmanager
def finer_grids() -> Iterator[None]:
    """Grids of at least four times the usual nodes."""
    usual = solver._FEWEST, solver._MOST
    solver._FEWEST, solver._MOST = 4, 5
    try:
        yield
    finally:
        solver._FEWEST, solver._MOST = usual


def main() -> None:
    print(f"{'':8} {'time':>6}  {'solved':>6}  {'covered':>7}  largest difference")
    print(f"{'':8} {'[s]':>6}  {'':6}  {'':7}  " + "  ".join(NUMBERS))
    for name, scene in SCENES.items():
        curve(SPEEDS[:1], scene)
        begin = time.process_time()
        found = curve(SPEEDS, scene)
        spent = time.process_time() - begin
        with finer_grids():
            judge = curve(SPEEDS[::4], scene)
        off = {
            field: np.abs(getattr(found, field)[::4] - getattr(judge, field))
            for field in NUMBERS
        }
        covered = (off["mu"] <= found.error[::4]).mean()
        relative = (np.nanmax(off[one] / getattr(judge, one)) for one in NUMBERS)
        print(
            f"{name:8} {spent:6.2f}  {found.converged.mean():6.0%}  {covered:7.0%}  "
            + "  ".join(f"{each:.1e}" for each in relative)
            + ("" if spent <= ASKED else f"  (asked: {ASKED} s)")
        )


if __name__ == "__main__":
    main()
