"""What would the marches of `elastomdr.transient` cost, were their loop diffrax's?

    python benchmarks/one_march.py

`elastomdr.transient.march.march` is the loop of sliding and driven bodies, tangential
loading, falling loads and oblique impact. Here `diffrax.diffeqsolve` takes its place:
64 contact steps are a step of the solver, as with `em.ContactStep(samples=64)`, its
`SaveAt` keeps what is seen at their ends, and its default adjoint gives the gradient.
Both make the same steps and must give the same numbers. Each figure is from a process
of its own, without compiled code from before, in processor seconds on one core; the
ways take turns. `numpy` is the same loop on NumPy, as small problems take it.
"""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from common import heading, one_core, save, table, timed, verdict

SCENES = ("slide", "drive", "shear")
WAYS = ("numpy", "compiled", "diffrax")
TURNS = 3
INSTANTS = np.linspace(0.0, 0.02, 9)


def main() -> None:
    record = heading("One march, our loop and diffrax's", "processor seconds, one core")
    rows = []
    for scene in SCENES:
        found = {way: measured(scene, way) for way in WAYS}
        ours, theirs = found["compiled"], found["diffrax"]
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
        "warm over ours",
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
    # em.shear takes numbers alone
    plain = way == "numpy" or scene == "shear"
    for task in ("number",) if plain else ("number", "gradient"):
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
    if way == "diffrax":
        march_by_diffrax()
    ball = em.Sphere(0.01)

    def result(modulus: Any) -> Any:
        solid = em.Foundation(1e6, np.ones(1) * modulus, [1e-2])
        place = 0.2 * INSTANTS**2 / INSTANTS[-1]
        given = {"time": INSTANTS, "load": 1.0 + 0 * INSTANTS}
        if scene == "slide":
            one = em.slide(solid, ball, **given, position=place, **cut(modulus))
            return one.friction_force
        if scene == "drive":
            mount = em.Mount(0.1, 1e4, 1.0)
            one = em.drive(
                solid, ball, **given, position=place, tangential=mount, **cut(modulus)
            )
            return one.friction_force
        one = em.shear(
            solid,
            ball,
            **given,
            displacement=1e-5 * np.sin(300 * INSTANTS),
            friction=0.5,
            tangential=solid,
        )
        return one.force

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
    from elastomdr.transient import refinement, shear

    refinement._PATIENCE = shear._MUCH = -1.0


def march_by_diffrax() -> None:
    """`diffrax.diffeqsolve` in place of the compiled loop."""
    import diffrax
    import jax
    import jax.numpy as jnp

    from elastomdr.transient import march as module

    size = module._BLOCK

    class Nothing(diffrax.AbstractTerm):
        """The steps hold all that is prescribed."""

        def vf(self, t: Any, y: Any, args: Any) -> Any:
            return y

        def contr(self, t0: Any, t1: Any, **kwargs: Any) -> Any:
            return t1 - t0

        def prod(self, vf: Any, control: Any) -> Any:
            return vf

    class Blocks(diffrax.AbstractSolver):
        """A block of contact steps; time counts blocks."""

        block: Callable[..., Any]
        term_structure: ClassVar = diffrax.AbstractTerm
        interpolation_cls: ClassVar[Any] = diffrax.LocalLinearInterpolation

        def order(self, terms: Any) -> int:
            return 2

        def init(self, terms: Any, t0: Any, t1: Any, y0: Any, args: Any) -> None:
            return None

        def step(
            self,
            terms: Any,
            t0: Any,
            t1: Any,
            y0: Any,
            args: Any,
            solver_state: None,
            made_jump: Any,
        ) -> Any:
            number = jnp.round(t0).astype(int)
            y1 = self.block(y0[0], jax.tree.map(lambda x: x[number], args))
            ends = {"y0": y0, "y1": y1}
            return y1, None, ends, None, diffrax.RESULTS.successful

        def func(self, terms: Any, t0: Any, y0: Any, args: Any) -> Any:
            return y0

    def on_diffrax(
        step: Any, look: Any, state: Any, steps: Any, instants: Any, prepare: Any
    ) -> tuple[Any, Any]:
        count = steps.h.shape[0]
        steps = module.padded(steps, count)
        filled = steps.h.shape[0]
        is_seen = steps.h >= 0
        if instants is not None:
            is_seen = jnp.zeros(filled, bool).at[instants].set(True)

        def one(state: Any, now: Any) -> tuple[Any, Any]:
            state, details = step(state, now[0])
            return state, module.if_so(now[1], look, state, details)

        def block(state: Any, part: Any) -> tuple[Any, Any]:
            given, is_seen = part
            given = given._replace(h=jnp.where(given.h > 0, given.h, given.h[0]))
            return jax.lax.scan(one, state, (prepare(given), is_seen))

        blocks = jax.tree.map(
            lambda x: jnp.reshape(x, (-1, size, *x.shape[1:])), (steps, is_seen)
        )
        first = jax.tree.map(lambda x: x[0], blocks)
        none = module._zeros(lambda *x: block(*x)[1], state, first)
        number = blocks[0].h.shape[0]
        solution = diffrax.diffeqsolve(
            Nothing(),
            Blocks(block),
            t0=0.0,
            t1=jnp.sum(blocks[0].h[:, 0] > 0).astype(float),
            dt0=1.0,
            y0=(state, none),
            args=blocks,
            saveat=diffrax.SaveAt(
                subs=[
                    diffrax.SubSaveAt(steps=True, fn=lambda t, y, args: y[1]),
                    diffrax.SubSaveAt(t1=True, fn=lambda t, y, args: y[0]),
                ]
            ),
            max_steps=number,
        )
        seen, end = solution.ys
        chosen = slice(count) if instants is None else instants
        seen = jax.tree.map(lambda x: x.reshape(filled, *x.shape[2:])[chosen], seen)
        return jax.tree.map(lambda x: x[-1], end), seen

    module._on_jax = on_diffrax


if __name__ == "__main__":
    if len(sys.argv) > 1:
        child(*sys.argv[1:])
    else:
        main()
