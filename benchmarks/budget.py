"""What does each call and each scene take? One table for all of them.

    python benchmarks/budget.py [--only WORD]

Each row is a process of its own, with no cache of compiled code: processor seconds from
its start to its first number, of the same call again, of a curve of 64 velocities (of
histories: their one call) and of a derivative's second evaluation by velocity or load,
and the peak of its memory. A scene is its command, table and figure included. Processor
time moves by a fifth on a busy machine.

Asked: 1 s for a first number, 0.3 s for a curve, 2 s for a history, 5 s for what
iterates over temperatures or maps.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from common import heading, save, table, verdict

ROOT = Path(__file__).parents[1]
FIRST, CURVE, HISTORY, ITERATES = 1.0, 0.3, 2.0, 5.0

SETUP = """
import resource, time
import numpy as np
import elastomdr as em
rubber = em.Prony(1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), poisson=0.49, shift=em.WLF(8.86, 101.6, 293.15))
road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e6)
ball, cone, roller = em.Sphere(5e-3), em.Cone(0.1), em.Cylinder(0.05, 0.5)
layer, springs = em.layer(rubber, 5e-3), em.springs(rubber, 5e-3, bonded=False)
shear = em.AdhesiveShear(5e6, 5e-3, 0.1)
heat = em.Heat(0.25, 2e6)
t = np.linspace(0.0, 0.1, 51)
def call(x):
    return {call}
"""
MEASURE = """
def spent(x):
    start = time.process_time()
    call(x)
    return time.process_time() - start
one, many = {one}, {many}
call(one)
out = dict(first=time.process_time(), warm=spent(one), curve=spent(many))
if {traced}:
    import jax
    jax.config.update("jax_enable_x64", True)
    slope = jax.grad(lambda x: call(x).{field})
    slope(one)
    start = time.process_time()
    slope(one)
    out["gradient"] = time.process_time() - start
out["memory"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
import json
print(json.dumps(out))
"""


class Case(NamedTuple):
    """A call of x, one velocity or many, and what its curve may take [s]."""

    name: str
    call: str
    field: str = "mu"
    curve: float = CURVE
    one: str = "0.1"
    many: str = "np.logspace(-5, 1, 64)"
    traced: bool = True
    why: str = ""  # it takes more


def _steady(verb: str, field: str, load: str) -> list[Case]:
    bodies = {
        "ball on a half-space": ("rubber", "ball"),
        "cone on a half-space": ("rubber", "cone"),
        "ball on springs": ("springs", "ball"),
        "cone on springs": ("springs", "cone"),
        "ball on a layer": ("layer", "ball"),
        "roller on a layer": ("layer", "roller"),
        "roller on a half-space": ("rubber", "roller"),
    }
    return [
        Case(
            f"{verb}: {name}",
            f"em.{verb}({material}, {shape}, velocity=x, load={load})",
            field,
        )
        for name, (material, shape) in bodies.items()
    ]


CASES = (
    *_steady("friction", "mu", "1.0"),
    *_steady("rolling", "coefficient", "1.0"),
    Case("friction: a road", "em.friction(rubber, road, velocity=x, pressure=3e5)"),
    Case(
        "friction: a road, adhesion and heat",
        "em.friction(rubber, road, velocity=x, pressure=3e5, temperature=293.15, "
        "heat=heat, adhesion=shear)",
        curve=ITERATES,
        why="iterates over temperatures by scale",
    ),
    Case(
        "friction: a road as lines",
        'em.friction(rubber, road.ended(1e5), velocity=x, pressure=3e5, model="line")',
        curve=ITERATES,
        traced=False,
        why="lines of 16384 points and more",
    ),
    Case(
        "press: a road",
        "em.press(rubber, road, pressure=x, time=1.0)",
        "area_ratio",
        one="3e5",
        many="np.geomspace(1e4, 1e6, 64)",
    ),
    Case(
        "leak",
        "em.leak(rubber, road, pressure=x, pressure_drop=1e4, viscosity=1e-3, "
        "length=1e-3)",
        "rate",
        one="3e5",
        many="np.geomspace(1e5, 1e6, 64)",
    ),
    Case(
        "lubricated",
        "em.lubricated(rubber, em.Cylinder(0.01, 1.0), velocity=x, load=100.0, "
        "viscosity=0.1)",
        curve=HISTORY,
        traced=False,
    ),
    Case(
        "indent",
        "em.indent(rubber, ball, time=t, load=x * t)",
        "depth.sum()",
        curve=HISTORY,
        one="100.0",
        many="100.0",
    ),
    Case(
        "impact",
        "em.impact(rubber, ball, mass=1e-3, velocity=x)",
        "restitution",
        curve=HISTORY,
        one="1.0",
        many="np.geomspace(0.1, 10, 8)",
        traced=False,
    ),
    Case(
        "slide",
        "em.slide(rubber, ball, time=t, position=x * t, load=1.0)",
        curve=HISTORY,
        one="0.01",
        many="0.01",
        traced=False,
    ),
    Case(
        "drive",
        "em.drive(rubber, ball, em.Mount(mass=0.1, stiffness=1e4, damping=1.0), time=t, "
        "base=x * t, load=1.0)",
        curve=HISTORY,
        one="0.01",
        many="0.01",
        traced=False,
    ),
    Case(
        "shear",
        "em.shear(rubber, ball, time=t, load=1.0, friction=0.5, "
        "displacement=x * np.sin(60 * t))",
        curve=HISTORY,
        one="2e-5",
        many="2e-5",
        traced=False,
    ),
    Case(
        "traction",
        "em.traction(rubber, ball, velocity=1.0, creepage=x, friction=0.8, load=5.0)",
        curve=HISTORY,
        one="0.02",
        many="np.geomspace(1e-3, 0.1, 16)",
        traced=False,
    ),
)


def measured(case: Case) -> dict[str, Any]:
    """What a process of its own says of a call."""
    code = SETUP.replace("{call}", case.call)
    measure = MEASURE
    for key in ("one", "many", "field", "traced"):
        measure = measure.replace(f"{{{key}}}", str(getattr(case, key)))
    return json.loads(_process(sys.executable, "-W", "ignore", "-c", code + measure))


def scene(verb: str, path: Path) -> dict[str, Any]:
    """What the command of a scene takes."""
    with tempfile.TemporaryDirectory() as place:
        code = (
            "import json, resource, sys, time\n"
            "from elastomdr.cli.main import main\n"
            f"status = main([{verb!r}, {str(path)!r}, '--out', {place!r}])\n"
            "peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024\n"
            "print(json.dumps(dict(first=time.process_time(), memory=peak)))"
        )
        return json.loads(
            _process(sys.executable, "-W", "ignore", "-c", code).split("\n")[-1]
        )


def _process(*command: str) -> str:
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"XDG_CACHE_HOME": cache}
        ended = subprocess.run(
            command, capture_output=True, text=True, env=environment, check=False
        )
    if ended.returncode:
        raise RuntimeError(ended.stderr[-2000:])
    return ended.stdout.strip()


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--only", default="", help="rows with this word alone")
    only = options.parse_args().only
    record = heading("A budget for every call and every scene", "processor seconds")
    rows, verdicts = [], []
    for case in CASES:
        if only not in case.name:
            continue
        found = measured(case)
        keys = ("first", "warm", "curve", "gradient", "memory")
        rows.append(
            (case.name, *(found.get(key, float("nan")) for key in keys), case.why)
        )
        first = HISTORY if case.curve == HISTORY else FIRST
        verdicts += [
            verdict(f"{case.name}, first", found["first"], first, unit=" s"),
            verdict(f"{case.name}, curve", found["curve"], case.curve, unit=" s"),
        ]
    record["calls"] = table(
        ("call", "first [s]", "warm [s]", "curve [s]", "gradient [s]", "MiB", "why"),
        rows,
    )
    rows = []
    for path in sorted((ROOT / "examples" / "scenes").glob("*.toml")):
        command = re.search(r"elastomdr (\w+)", path.read_text(encoding="utf-8"))
        if only not in path.stem or command is None or command[1] == "sweep":
            continue
        found = scene(command[1], path)
        rows.append((path.stem, command[1], found["first"], found["memory"]))
        verdicts.append(
            verdict(f"scene {path.stem}", found["first"], ITERATES, unit=" s")
        )
    record["scenes"] = table(("scene", "command", "processor [s]", "MiB"), rows)
    record["verdicts"] = verdicts
    if not only:
        save("budget", record)


if __name__ == "__main__":
    main()
