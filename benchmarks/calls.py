"""How many calls of named Python functions a point on a road makes, and in which files: of the
second call, in which nothing is loaded. Not a measurement of time.

    python benchmarks/calls.py [--files 12]
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import elastomdr as em

SOURCE = Path(em.__file__).parent
RUBBER = em.load_material("epdm-70")
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e6)
POINT: dict[str, Any] = {"velocity": 0.1, "pressure": 3e5, "temperature": 303.15}
SCENES: dict[str, dict[str, Any]] = {
    "a point on a road": {},
    "with heat and shear": {
        "heat": em.Heat(conductivity=0.25, heat_capacity=1.8e6),
        "adhesion": em.AdhesiveShear(3e5, 6e-3, 0.1),
    },
}


def calls(function: Callable[[], object]) -> Counter[str]:
    """Calls by file of the package, all others as "elsewhere"."""
    files: Counter[str] = Counter()

    def seen(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_code.co_name[0] != "<":
            path = Path(frame.f_code.co_filename)
            inside = path.is_relative_to(SOURCE)
            files[str(path.relative_to(SOURCE)) if inside else "elsewhere"] += 1

    sys.setprofile(seen)
    try:
        function()
    finally:
        sys.setprofile(None)
    return files


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--files", type=int, default=12)
    shown = parser.parse_args().files
    for scene, given in SCENES.items():

        def point(given: dict[str, Any] = given) -> object:
            return em.friction(RUBBER, ROAD, **POINT, **given)

        point()
        files = calls(point)
        inside = files.total() - files["elsewhere"]
        print(f"{scene}: {inside} calls in the package, {files.total()} in all")
        for file, count in files.most_common(shown):
            print(f"  {count:6} {file}")


if __name__ == "__main__":
    main()
