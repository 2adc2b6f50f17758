"""What do the compiled marches of `elastomdr.transient` cost, by diffrax and by a bare
loop?

    python benchmarks/one_march.py

Large problems of sliding and driven bodies and falling loads are one `diffrax.diffeqsolve` of blocks of 64 contact steps
(`elastomdr.element.elements.in_blocks`). Here `jax.lax.scan` takes its
place: it makes the same steps and must give the same numbers. Each figure is from a
process of its own, without compiled code from before, in processor seconds on one core;
the ways take turns. `numpy` is the same march on NumPy, as small problems take it.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np
from common import heading, one_core, save, table, timed, verdict

SCENES = ("slide", "drive")
WAYS = ("numpy", "scan", "diffrax")
TURNS = 3
INSTANTS = np.linspace(0.0, 0.02, 9)


def main() -> None:
    record = heading("One march, by scan and by diffrax", "processor seconds, one core")
    rows = []
    for scene in SCENES:
        found = {way: measured(scene, way) for way in WAYS}
        ours, theirs = found["scan"], found["diffrax"]
        off = np.abs(np.subtract(ours["value"], theirs["value"])).max()
        rows += [
            (
                scene,
                way,
                one["first"],
                one["warm"],
                one["warm"] / ours["warm"],
                one.get("first gradient", np.nan),
                one.get("warm gradient", np.nan),
                off / np.abs(ours["value"]).max(),
            )
            for way, one in found.items()
        ]
    columns = (
        "march",
        "way",
        "first number [s]",
        "warm [s]",
        "warm over scan",
        "first gradient [s]",
        "warm gradient [s]",
        "difference",
    )
    record["table"] = table(columns, rows)
    record["figures"] = [
        verdict("largest difference of both loops", max(row[-1] for row in rows), 1e-9)
    ]
    save("one_march", record)


def measured(scene: str, way: str) -> dict[str, Any]:
    """First calls from a process of their own, the least of the warm ones."""
    found: dict[str, Any] = {}
    for task in ("number",) if way == "numpy" else ("number", "gradient"):
        command = [sys.executable, __file__, scene, way, task]
        environment = os.environ | {
            "JAX_ENABLE_X64": "1",
            "JAX_ENABLE_COMPILATION_CACHE": "0",
        }
        done = subprocess.run(
            command, capture_output=True, text=True, check=True, env=environment
        )
        found |= json.loads(done.stdout.splitlines()[-1])
    return found


def child(scene: str, way: str, task: str) -> None:
    one_core()
    import jax

    import elastomdr as em

    if way != "numpy":
        compile_all()
    if way == "scan":
        march_by_scan()
    ball = em.Sphere(0.01)

    def result(modulus: Any) -> Any:
        solid = em.Foundation(1e6, np.ones(1) * modulus, [1e-2])
        place = 0.2 * INSTANTS**2 / INSTANTS[-1]
        given = {"time": INSTANTS, "load": 1.0 + 0 * INSTANTS}
        if scene == "slide":
            one = em.slide(solid, ball, **given, position=place, **cut(modulus))
            return one.friction_force
        mount = em.Mount(0.1, 1e4, 1.0)
        one = em.drive(
            solid, ball, **given, position=place, tangential=mount, **cut(modulus)
        )
        return one.friction_force

    def cut(modulus: Any) -> dict[str, Any]:
        traced = isinstance(modulus, jax.core.Tracer)
        return {"rtol": 1e-1} | ({"elements": 512} if traced else {})

    if task == "number":
        call: Callable[[], Any] = lambda: np.asarray(result(9e6))  # noqa: E731
        first, warm = "first", "warm"
    else:
        slope = jax.jit(jax.grad(lambda modulus: result(modulus)[-1]))
        call = lambda: np.asarray(slope(9e6))  # noqa: E731
        first, warm = "first gradient", "warm gradient"
    begin, turns = timed(call), timed(call, TURNS)
    key = "value" if task == "number" else "slope"
    found = {first: begin.cpu, warm: turns.cpu, key: turns.value.tolist()}
    print(json.dumps(found))


def compile_all() -> None:
    """As if every problem were so large that it is compiled."""
    from elastomdr.transient import refinement

    refinement._PATIENCE = -1.0


def march_by_scan() -> None:
    """`jax.lax.scan` in place of diffrax's loop."""
    import jax

    from elastomdr.element import elements as module

    def in_scan(block: Callable[..., Any], start: Any, blocks: Any) -> tuple[Any, Any]:
        return jax.lax.scan(block, start, blocks)

    module.in_blocks = in_scan


if __name__ == "__main__":
    if len(sys.argv) > 1:
        child(*sys.argv[1:])
    else:
        main()
