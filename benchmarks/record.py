"""A record of the results of every verb: whoever changes the code without meaning to
change numbers compares with it.

    python benchmarks/record.py --compare     # prints every field that differs by more than 1e-10
    python benchmarks/record.py               # writes record.json anew

`error` and `model_error` count to 1 %, or to 1e-14: they are estimates, and follow the
steps of a search and rounding.
"""

import argparse
import dataclasses
import json
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

import elastomdr as em

FILE = Path(__file__).with_suffix(".json")
AGREES = 1e-10  # relative to the largest value of the field
ESTIMATES = {"error": 1e-2, "model_error": 1e-2}
ROUNDING = 1e-14  # of an estimate

SHIFT = em.WLF(8.86, 101.6, 293.15)
BROAD = em.Prony(
    1e6, [2e6, 1e6, 3e6, 5e5], [1e-5, 1e-3, 1e-2, 1.0], shift=SHIFT, name="broad"
)
SOLID = em.StandardSolid(1e6, 4e6, 1e-2)
BULK = em.Prony(1e6, [3e6], [0.1], kind="tensile", bulk=1e8)
KELVIN = em.KelvinVoigt(1e6, 1e3)
BALL, VELOCITY = em.Sphere(5e-3), np.geomspace(1e-4, 1e2, 9)
R = np.linspace(0.0, 4e-3, 30)
SHAPES = {
    "sphere": BALL,
    "paraboloid": em.Paraboloid(5e-3),
    "cone": em.Cone(0.1),
    "power 1.5": em.PowerLaw(1.5, 1.0),
    "power 3": em.PowerLaw(3.0, 3e3),
}
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
LINE = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=8e3)
TIME = np.linspace(0.0, 0.1, 41)


def scenes() -> dict[str, Callable[[], Any]]:
    """Every call by its name."""
    found: dict[str, Callable[[], Any]] = {}
    for name, shape in SHAPES.items():
        found[f"friction {name}"] = lambda s=shape: em.friction(
            BROAD, s, velocity=VELOCITY, load=1.0, temperature=300.0
        )
        found[f"friction {name}, line, depth"] = lambda s=shape: em.friction(
            SOLID, s, velocity=VELOCITY, depth=1e-4, model="line"
        )
    found |= {
        "friction, profile": lambda: em.friction(
            SOLID,
            em.Profile(R, 50 * R**2 + 1e5 * R**4),
            velocity=[0.1, 1.0],
            load=1.0,
            model="line",
            rtol=1e-4,
        ),
        "friction, bare average": lambda: em.friction(
            BROAD,
            BALL,
            velocity=VELOCITY,
            load=[[1.0], [5.0]],
            model=em.Averaged(corrected=False),
        ),
        "friction, bulk modulus": lambda: em.friction(
            BULK, BALL, velocity=VELOCITY, load=1.0
        ),
        "friction, dashpot": lambda: em.friction(
            KELVIN, em.Paraboloid(5e-3), velocity=VELOCITY, load=1.0
        ),
        "friction, two bodies": lambda: em.friction(
            em.half_space(SOLID, BROAD.at(300.0)), BALL, velocity=VELOCITY, load=1.0
        ),
        "friction, half-space": lambda: em.friction(
            SOLID, BALL, velocity=0.1, load=1.0, model=em.HalfSpace(cells=48)
        ),
        "friction, springs": lambda: em.friction(
            em.springs(em.StandardSolid(1e6, 4e6, 1e-2, poisson=0.4), 2e-3),
            BALL,
            velocity=VELOCITY,
            load=1.0,
        ),
        "road, multiscale": lambda: em.friction(
            BROAD, ROAD, velocity=VELOCITY, pressure=3e5, temperature=300.0
        ),
        "road, persson": lambda: em.friction(
            BROAD, ROAD, velocity=VELOCITY, pressure=3e5, model="persson"
        ),
        "road, heat": lambda: em.friction(
            BROAD,
            ROAD,
            velocity=1.0,
            pressure=3e5,
            temperature=300.0,
            heat=em.Heat(0.2, 2e6),
        ),
        "road, half-space": lambda: em.friction(
            SOLID, LINE, velocity=0.01, pressure=3e6, model=em.HalfSpace(cells=64)
        ),
        "road, line": lambda: em.friction(
            SOLID,
            LINE,
            velocity=[0.01, 0.1],
            pressure=3e5,
            model=em.Line(samples=256, seeds=2),
            rtol=1e-4,
        ),
        "road, table": lambda: em.friction(
            em.TabulatedModulus(
                np.logspace(-2, 8, 60),
                BROAD.storage(np.logspace(-2, 8, 60)),
                BROAD.loss(np.logspace(-2, 8, 60)),
            ),
            ROAD,
            velocity=VELOCITY,
            pressure=3e5,
        ),
        "bands": lambda: em.friction_spectrum(
            SOLID,
            LINE.line(seed=1, periods=1, samples=128),
            velocity=0.1,
            load=1.0,
            model=em.Line(),
        ),
        "rolling sphere": lambda: em.rolling(BROAD, BALL, velocity=VELOCITY, load=1.0),
        "rolling cylinder": lambda: em.rolling(
            em.springs(BULK, 4e-3),
            em.Cylinder(0.05, 0.1),
            velocity=VELOCITY,
            load=100.0,
        ),
        "dissipation": lambda: em.dissipation(BROAD, BALL, velocity=VELOCITY, load=1.0),
        "indent, depth": lambda: em.indent(
            BROAD, BALL, time=TIME, depth=1e-4 * np.sin(40 * TIME) ** 2
        ),
        "indent, load": lambda: em.indent(BROAD, BALL, time=TIME, load=1.0 + 0 * TIME),
        "impact": lambda: em.impact(SOLID, BALL, mass=4e-3, velocity=[0.5, 2.0]),
        "shear": lambda: em.shear(
            SOLID,
            em.Paraboloid(5e-3),
            time=TIME,
            load=1.0,
            displacement=2e-5 * np.sin(60 * TIME),
            friction=0.5,
        ),
        "slide": lambda: em.slide(
            SOLID, BALL, time=TIME, load=1.0, position=0.02 * TIME, rtol=1e-4
        ),
        "drive": lambda: em.drive(
            SOLID,
            BALL,
            time=TIME[:11],
            load=1.0,
            tangential=em.Mount(0.1, 1e3, 1.0),
            position=0.02 * TIME[:11],
            rtol=1e-3,
        ),
        "traction": lambda: em.traction(
            BROAD,
            em.Paraboloid(5e-3),
            velocity=1.0,
            creepage=[0.001, 0.02, 0.1],
            friction=0.8,
            load=5.0,
        ),
        "stability": lambda: em.stability(
            em.Mount(5.0, 5e3, 20.0),
            velocity=VELOCITY,
            force=1 / (1 + VELOCITY),
            wavelength=1e-4,
        ),
        "squeezed cord": lambda: em.o_ring(
            BROAD, 3e-3, 0.1, time=[1.0, 100.0], temperature=300.0
        ),
        "creep compliance": lambda: {
            "value": BULK.creep_compliance(TIME),
            "shear": BULK.shear().relaxation(TIME),
        },
        "library": lambda: {
            name: em.half_space(em.load_material(name))
            .complex_modulus(np.logspace(-3, 6, 10))
            .imag
            for name in em.materials()
        },
        "full contact": lambda: em.reference.full_contact_sliding(
            BROAD, LINE.line(seed=1), velocity=VELOCITY, load=1e3
        ),
    }
    return found


def numbers(result: Any) -> dict[str, list]:
    """The arrays of a result, by name."""
    fields = (
        {"value": result}
        if isinstance(result, np.ndarray)
        else result
        if isinstance(result, dict)
        else vars(result)
    )
    found = {}
    for name, value in fields.items():
        parts = vars(value) if dataclasses.is_dataclass(value) else {"": value}
        for part, x in parts.items():
            if isinstance(x, (np.ndarray, float)) and np.asarray(x).dtype.kind in "fb":
                found[f"{name}.{part}".strip(".")] = (
                    np.asarray(x, dtype=float).ravel().tolist()
                )
    return found


def differences(before: dict, after: dict) -> list[str]:
    """A line for each field that differs."""
    lines = []
    for scene, fields in before.items():
        if "refused" in fields or "refused" in after.get(scene, {"refused": "is gone"}):
            if fields != after.get(scene):
                lines.append(
                    f"{scene}: {fields.get('refused', 'a result')} -> "
                    f"{after.get(scene, {}).get('refused')}"
                )
            continue
        for name, values in fields.items():
            one, two = np.array(values), np.array(after[scene].get(name, []))
            if one.shape != two.shape:
                lines.append(
                    f"{scene}: {name} has {two.size} values instead of {one.size}"
                )
                continue
            known = np.isfinite(one)
            if (known != np.isfinite(two)).any():
                lines.append(f"{scene}: {name} is NaN elsewhere")
            elif known.any() and (size := np.abs(one[known]).max()) > 0:
                change, kind = np.abs(two - one)[known].max(), name.split(".")[-1]
                off = change / size
                if off > ESTIMATES.get(kind, AGREES) and not (
                    kind in ESTIMATES and change < ROUNDING
                ):
                    lines.append(f"{scene}: {name} differs by {off:.1e}")
    return lines


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--compare", action="store_true")
    parser.add_argument("--file", type=Path, default=FILE)
    arguments = parser.parse_args()
    found = {}
    for name, call in scenes().items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                found[name] = numbers(call())
            except (TypeError, ValueError) as error:
                found[name] = {"refused": str(error).splitlines()[0][:150]}
    if arguments.compare:
        lines = differences(json.loads(arguments.file.read_text()), found)
        print("\n".join(lines) or f"{len(found)} scenes agree")
    else:
        arguments.file.write_text(json.dumps(found))
        refused = [
            f"{name}: {fields['refused']}"
            for name, fields in found.items()
            if "refused" in fields
        ]
        print("\n".join([f"{len(found)} scenes written", *refused]))


if __name__ == "__main__":
    main()
