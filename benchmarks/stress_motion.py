"""Is every history right or flagged? Random scenes of what moves in time, against routes that share nothing with us.

    python benchmarks/stress_motion.py [--scenes N] [--seed S] [--show K] [--family F]

`em.indent` under a depth (contact lost and regained; judged element by element and event by event, `slow_elements.py`)
and under a load (a plain march, extrapolated, `slow_load.py`), `em.impact` (reduced equations by scipy,
`slow_impact.py`), `em.traction` (closed forms with mpmath, a march where elements stick again) and `em.shear` (play
operators, both `slow_friction.py`). 1 to 60 branches, their times over 24 decades, around the duration of the scene, or
nearly equal; moduli over 12 decades, with and without equilibrium modulus and dashpot; bodies from a cone to |x|^12,
cylinders on layers. Wrong is a converged answer off by more than rtol, of the largest value of its history (in
`em.shear`, which takes no rtol, by more than 1e-2); covered one off by no more than its `error`; each
beyond what the judge vouches for; flagged one that is NaN with converged=False.
"""

import argparse
import itertools
import math
import multiprocessing
import os
import sys
import time
import traceback
import warnings
from concurrent.futures import ProcessPoolExecutor
from typing import Any, NamedTuple

import numpy as np
from slow_elements import Line, force, recovery
from slow_friction import brush, brush_march, sheared_elastic, sheared_slowly
from slow_impact import struck
from slow_load import depths
from slow_route import Law, closed

POWERS = {"paraboloid": 2.0, "cone": 1.0, "r^1.5": 1.5, "r^12": 12.0, "cylinder": 2.0}
SHARES = {  # of the scenes, and how many are drawn together
    "indent, depth": (0.32, 8), "indent, load": (0.08, 4), "impact": (0.32, 32), "traction": (0.2, 8),
    "shear, elastic": (0.05, 1), "shear, viscoelastic": (0.03, 1),
}  # fmt: skip
BRANCHES = (1, 3, 8, 60)
INSTANTS = 6


class Batch(NamedTuple):
    """Scenes of one compiled shape, as numbers, so that another process can judge them."""

    family: str
    number: int  # of the batch in its family: seed and number draw it again
    scenes: int
    laws: list[Law]
    body: str
    size: float  # coefficient of g = size |x|^power
    inputs: dict[str, Any]
    rtol: float


Verdict = tuple[str, float, float]  # kind, relative miss, miss over the stated error


def draw(family: str, number: int, scenes: int, random: np.random.Generator) -> Batch:
    """Scenes of a family."""
    body = "paraboloid"
    if family.startswith("indent"):
        body = str(random.choice(list(POWERS)))
    elif family == "impact":
        body = str(random.choice(["paraboloid", "cone", "r^1.5"]))
    elif family == "traction":
        body = str(random.choice(["paraboloid", "cylinder"]))
    power = POWERS[body]
    length = 10 ** random.uniform(-9, 2)  # of the contact
    steepness = 10 ** random.uniform(-4, 0)
    size = steepness * length ** (1 - power)
    depth = size * length**power
    span = 10 ** random.uniform(-12, 12)
    laws = [law(random, span, family, body) for _ in range(scenes if family in ("impact", "traction") else 1)]
    rtol = 1e-6
    inputs: dict[str, Any] = {}
    if family == "indent, depth":
        times = np.cumsum(np.c_[np.zeros(scenes), span * 10 ** random.uniform(-3, 0, (scenes, INSTANTS - 1))], axis=1)
        moved = random.uniform(-0.4, 1.0, (scenes, INSTANTS))
        moved[:, 0] = 0.0 if laws[0].viscosity > 0 else np.where(random.random(scenes) < 0.5, 0, abs(moved[:, 0]))
        inputs = {"time": times, "depth": depth * moved}
        rtol = float(random.choice([1e-4, 1e-6, 1e-9]))
    elif family == "indent, load":
        times = np.cumsum(np.c_[np.zeros(scenes), span * 10 ** random.uniform(-2, 0, (scenes, INSTANTS - 1))], axis=1)
        part = np.where(random.random((scenes, INSTANTS)) < 0.2, 0, random.uniform(0, 1, (scenes, INSTANTS)))
        part[:, -1] = random.uniform(0.1, 1, scenes)
        inputs = {"time": times, "load": 10 ** random.uniform(-9, 9) * part}
        rtol = 1e-4
    elif family == "impact":
        # Mass and speed so that an elastic body of all moduli has a contact of about `span`.
        stiff = laws[0].equilibrium + laws[0].moduli.sum()
        speed = 10 ** random.uniform(-10, 10) * 10 ** random.uniform(-1, 1, scenes)
        factor = elastic(body, size)
        mass = stiff * factor * (speed * span) ** (power + 1) / speed**2 * 10 ** random.uniform(-1, 1, scenes)
        inputs = {"mass": mass, "velocity": speed}
    elif family == "traction":
        velocity = length / span * 10 ** random.uniform(-2, 2, scenes)
        sheared = [law(random, span, family, body) for _ in range(scenes)]
        mu = 10 ** random.uniform(-2, 0.5, scenes)
        mu = np.where(random.random(scenes) < 0.05, random.choice([0.0, np.inf], scenes), mu)
        creep = np.where(np.isfinite(mu), np.maximum(mu, 0.01), 1.0) * steepness * 10 ** random.uniform(-4, 1, scenes)
        creep = np.where(random.random(scenes) < 0.03, 0.0, creep)
        inputs = {"velocity": velocity, "creep": creep, "friction": mu, "depth": depth, "sheared": sheared}
    else:
        times = np.cumsum(np.r_[0.0, span * 10 ** random.uniform(-2, 0, INSTANTS - 1)])
        mu = 10 ** random.uniform(-2, 0.5)
        top = np.full(INSTANTS, depth)
        if family == "shear, elastic":
            laws = [bare(random), bare(random)]
            if random.random() < 0.6:
                top = depth * random.uniform(0, 1, INSTANTS)
        else:
            laws = [law(random, span, family, body), law(random, span, family, body)]
        ratio = (laws[0].equilibrium + laws[0].moduli.sum()) / (laws[1].equilibrium + laws[1].moduli.sum())
        far = mu * depth * ratio * 10 ** random.uniform(-3, 1)
        inputs = {"time": times, "displacement": far * random.uniform(-1, 1, INSTANTS), "friction": mu, "depth": top}
        rtol = 1e-2
    return Batch(family, number, scenes, laws, body, size, inputs, rtol)


def bare(random: np.random.Generator) -> Law:
    return Law(10 ** random.uniform(0, 12), np.zeros(0), np.zeros(0), 0.0)


def law(random: np.random.Generator, span: float, family: str, body: str) -> Law:
    """A Prony series: anywhere, around a duration, or with nearly equal times."""
    kind, count = random.random(), 3  # each number and body is compiled once
    if family in ("indent, depth", "impact") and body == "paraboloid":
        count = int(random.choice(BRANCHES, p=FEW_OFTEN))
    times = 10 ** random.uniform(-12, 12, count)
    if kind < 0.6:
        times = span * 10 ** random.uniform(-3, 3, count)
    elif kind < 0.75:
        times = span * 10 ** random.uniform(-2, 2) * (1 + 10 ** random.uniform(-15, -2, count))
    times = np.unique(times)
    while times.size < count:  # a branch that became equal to another
        times = np.unique(np.append(times, times[-1] * 2.0))
    base = 10 ** random.uniform(0, 12)
    moduli = 10 ** random.uniform(0, 12, count) if random.random() < 0.4 else base * 10 ** random.uniform(-2, 2, count)
    soft = 10 ** random.uniform(0, 12) if random.random() < 0.3 else base * 10 ** random.uniform(-2, 1)
    if random.random() < 0.15 and family != "traction":
        soft = 0.0
    dashpot = 0.0
    if random.random() < 0.2 and not family.startswith("shear"):
        dashpot = base * span * 10 ** random.uniform(-4, 1)
    return Law(soft, moduli, times, dashpot)


FEW_OFTEN = (0.4, 0.35, 0.2, 0.05)  # of the numbers of branches


def elastic(body: str, size: float) -> float:
    """A(d)/d^((n+1)/n) of an elastic body with g = size |x|^n: force over E*."""
    n = POWERS[body]
    return 2 * n / (n + 1) * size ** (-1 / n)


def answer(batch: Batch) -> Any:
    """The public call, and what of it is judged."""
    import elastomdr as em

    n, c = POWERS[batch.body], batch.size
    layer = True if batch.body == "cylinder" else None
    shapes = {"paraboloid": lambda: em.Paraboloid(1 / c), "cone": lambda: em.Cone(2 * c / math.pi)}
    shapes["cylinder"] = lambda: em.Cylinder(0.5 / c, 1.0)
    line = 2 * math.gamma((n + 1) / 2) / (math.sqrt(math.pi) * n * math.gamma(n / 2))
    shape = shapes.get(batch.body, lambda: em.PowerLaw(n, c * line))()
    materials = [em.Foundation(*one, per_area=layer) for one in batch.laws]
    inputs = dict(batch.inputs)
    if batch.family.startswith("indent"):
        got = em.indent(materials[0], shape, **inputs, rtol=batch.rtol)
        return {"depth": got.depth, "force": got.force, "error": got.error, "converged": got.converged}
    if batch.family == "impact":
        # Every material with its own mass and speed: the diagonal of what one call gives would be wasteful.
        got = [
            em.impact(m, shape, mass=inputs["mass"][i : i + 1], velocity=inputs["velocity"][i : i + 1])
            for i, m in enumerate(materials)
        ]
        names = ("restitution", "max_depth", "duration", "stuck", "error", "converged")
        return {name: np.concatenate([getattr(one, name) for one in got]) for name in names}
    if batch.family == "traction":
        sheared = [em.Foundation(*one, per_area=layer) for one in inputs.pop("sheared")]
        got = [
            em.traction(
                m, shape, tangential=sheared[i], average=None, depth=inputs["depth"],
                **{name: inputs[name][i : i + 1] for name in ("velocity", "creep", "friction")},
            )
            for i, m in enumerate(materials)
        ]  # fmt: skip
        said = {
            n: np.concatenate([getattr(g, n) for g in got]) for n in ("force", "normal_force", "error", "converged")
        }
        said["edges"] = np.concatenate([np.stack(one.contact, -1) for one in got])
        return said
    sideways = em.Foundation(*batch.laws[1])
    got = em.shear(materials[0], shape, tangential=sideways, **inputs)
    return {"force": got.force, "error": got.error, "converged": got.converged}


def judge(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    """A verdict per instant, impact or point."""
    return {
        "indent, depth": _indent_depth, "indent, load": _indent_load, "impact": _impact, "traction": _traction,
        "shear, elastic": _shear, "shear, viscoelastic": _shear,
    }[batch.family](batch, found)  # fmt: skip


def said(
    values: Any, truth: Any, error: Any, good: Any, scale: float, own: float, rtol: float, also: Any = None
) -> list[Verdict]:
    """Verdicts on values of one history, `error` relative to `scale`."""
    out = []
    for i, value in enumerate(values):
        if not good[i]:
            out.append(("flagged" if np.isnan(value) else "wrong", np.nan, np.nan))
            continue
        miss = abs(value - truth[i]) / scale
        beyond = max(miss - own, 0.0)
        wrong = not math.isfinite(miss) or beyond > rtol or (also is not None and also[i] > rtol)
        over = beyond / error[i] if error[i] > 0 else (math.inf if beyond > 0 else 0.0)
        if own > rtol:
            out.append(("unjudged", np.nan, np.nan))
        else:
            out.append(("wrong" if wrong else "right", float(miss), float(over)))
    return out


def _line(batch: Batch) -> Line:
    n, c = POWERS[batch.body], batch.size
    return Line(lambda x: c * np.abs(x) ** n, lambda d: (d / c) ** (1 / n), 2.0)


def _indent_depth(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, modes = [], recovery(batch.laws[0])
    for i, (t, d) in enumerate(zip(batch.inputs["time"], batch.inputs["depth"], strict=True)):
        try:
            truth, own = force(batch.laws[0], modes, _line(batch), t, d)
        except ArithmeticError:
            out += [("unjudged", np.nan, np.nan)] * t.size
            continue
        scale = np.abs(truth).max()
        rows = (found[name][i] for name in ("error", "converged"))
        out += said(found["force"][i], truth, *rows, scale if scale > 0 else 1.0, own + 3e-12, batch.rtol)
    return out


def _indent_load(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, line = [], _line(batch)
    for i, (t, p) in enumerate(zip(batch.inputs["time"], batch.inputs["load"], strict=True)):
        deepest = np.nanmax(np.append(found["depth"][i], -np.inf))
        try:
            if not deepest > 0:
                raise ArithmeticError
            # The elements only have to reach far enough: 1.3 times the radius of the deepest instant said.
            truth, own = depths(batch.laws[0], line, t, p, 1.3 * float(line.reach(deepest)))
        except ArithmeticError:
            truth, own = np.full(t.size, np.nan), np.inf
        scale = np.abs(truth).max()
        rows = (found[name][i] for name in ("error", "converged"))
        out += said(found["depth"][i], truth, *rows, scale, own, batch.rtol)
    return out


def _impact(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, power = [], (POWERS[batch.body] + 1) / POWERS[batch.body]
    factor = elastic(batch.body, batch.size)
    for i, one in enumerate(batch.laws):
        value, good, error = (found[name][i] for name in ("restitution", "converged", "error"))
        if not good:
            out += said([value], [0], [0], [good], 1.0, 0.0, batch.rtol)
            continue
        for rtol, own in ((1e-9, 3e-7), (1e-11, 3e-8)):
            try:
                truth = struck(one, power, factor, batch.inputs["mass"][i], batch.inputs["velocity"][i], rtol)
            except (ArithmeticError, ValueError):
                verdict = [("unjudged", np.nan, np.nan)]
                continue
            depth = abs(found["max_depth"][i] / truth.depth - 1) if truth.restitution > 0 else 0.0
            verdict = said([value], [truth.restitution], [error], [good], 1.0, own, batch.rtol, [depth - own])
            if verdict[0][0] == "right" and verdict[0][2] <= 1:
                break
        out += verdict
    return out


def _traction(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, power = [], int(POWERS[batch.body])
    for i, one in enumerate(batch.laws):
        sheared, (v, xi, mu) = (
            batch.inputs["sheared"][i],
            (batch.inputs[n][i] for n in ("velocity", "creep", "friction")),
        )
        value, load, good = (float(found[name][i]) for name in ("force", "normal_force", "converged"))
        error, edges = float(found["error"][i]), tuple(map(float, found["edges"][i]))
        if not good:
            out += said([value], [0], [0], [good], 1.0, 0.0, batch.rtol)
            continue
        normal = closed(power, batch.size, one, float(v), edges[0])
        also = [abs(normal.normal_force / load - 1) + abs(normal.trailing - edges[1]) / edges[0] - 1e-9]
        again, own = False, 1e-11
        truth = brush(one, sheared, batch.size, float(v), edges, float(mu), float(xi))
        if math.isfinite(mu) and xi > 0 and mu > 0:
            coarse, again = brush_march(one, sheared, batch.size, v, edges, mu, xi, 1500)
            again |= abs(coarse / truth - 1) > 1e-3  # it slips and sticks again within the first step
        if again:
            marches = [coarse, *(brush_march(one, sheared, batch.size, v, edges, mu, xi, n)[0] for n in (3000, 6000))]
            last, before = (4 * marches[2] - marches[1]) / 3, (4 * marches[1] - marches[0]) / 3
            truth, own = last, abs(last - before) / max(abs(last), 1e-300)
        scale = abs(truth) if truth != 0 else 1.0
        weight_error = [error * load / scale]
        limit = max(batch.rtol, 1e-13 * load / scale)  # no more of a traction far below the load
        out += said([value], [truth], weight_error, [good], scale, own, limit, also)
    return out


def _shear(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    given, (normal, sideways) = batch.inputs, batch.laws
    if batch.family == "shear, elastic":
        truth, own = sheared_elastic(
            normal.equilibrium,
            sideways.equilibrium,
            given["friction"],
            batch.size,
            given["depth"],
            given["displacement"],
        )
    else:
        route = (normal, sideways, given["friction"], batch.size, given["depth"][0], given["time"])
        coarse, middle, fine = (sheared_slowly(*route, given["displacement"], n) for n in (150, 300, 600))
        truth = (4 * fine - middle) / 3
        own = float(np.abs(truth - (4 * middle - coarse) / 3).max() / np.abs(truth).max())
    scale = np.abs(truth).max()
    return said(found["force"], truth, found["error"] / scale, found["converged"], scale, own, batch.rtol)


def main() -> int:
    options = argparse.ArgumentParser(description="Random histories against slow routes.")
    options.add_argument("--scenes", type=int, default=2000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument("--show", type=int, default=10, help="how many wrong scenes are printed")
    options.add_argument("--others", type=int, default=0, help="how many flagged and uncovered ones are printed")
    options.add_argument("--family", choices=list(SHARES))
    chosen = options.parse_args()
    from common import heading, save, table, verdict

    record = heading("Stress: random histories, each right or flagged", f"{chosen.scenes} scenes, seed {chosen.seed}")
    begin, batches, crashed = time.perf_counter(), [], []
    for number, (family, (share, together)) in enumerate(SHARES.items()):
        if chosen.family in (None, family):
            for i in range(max(1, round(share * chosen.scenes / together))):
                batches.append(draw(family, i, together, np.random.default_rng([chosen.seed, number, i])))
    spent: dict[str, float] = {}
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn")) as pool:
        waiting = []
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            for batch in batches:
                start = time.perf_counter()
                try:
                    waiting.append((batch, found := answer(batch), pool.submit(judge, batch, found)))
                except Exception:
                    crashed.append((batch, traceback.format_exc(limit=-3)))
                spent[batch.family] = spent.get(batch.family, 0.0) + time.perf_counter() - start
        took = time.perf_counter() - begin
        verdicts = []
        for batch, found, said_of in waiting:
            try:
                verdicts.append((batch, found, said_of.result()))
            except Exception:  # the judge's own failure: reported, never counted as right
                verdicts.append((batch, found, [("unjudged", np.nan, np.nan)] * found["converged"].size))
                print(traceback.format_exc(limit=-2))
    rows, wrong, others = [], [], []
    for family in dict.fromkeys(batch.family for batch in batches):
        ours = [(b, f, i, v) for b, f, all_of in verdicts if b.family == family for i, v in enumerate(all_of)]
        kinds = [v[0] for *_, v in ours]
        ratios = np.array([v[2] for *_, v in ours if v[0] in ("right", "wrong")])
        rows.append(
            (family, sum(b.scenes for b in batches if b.family == family), len(kinds), kinds.count("wrong"),
             kinds.count("flagged"), kinds.count("unjudged"), sum(b.scenes for b, _ in crashed if b.family == family),
             float(np.nanmax([0.0, *(v[1] for *_, v in ours)])),
             100 * float(np.mean(np.append(ratios, 0.0)[: max(ratios.size, 1)] <= 1)), spent[family])
        )  # fmt: skip
        wrong += [one for one in ours if one[-1][0] == "wrong"]
        others += [one for one in ours if one[-1][0] in ("flagged", "unjudged") or one[-1][2] > 1]
    columns = (
        "family",
        "scenes",
        "points",
        "wrong",
        "flagged",
        "unjudged",
        "crashed",
        "largest miss",
        "covered [%]",
        "[s]",
    )
    record["families"] = table(columns, rows)
    for name, list_of, count in (("WRONG", wrong, chosen.show), ("noted", others, chosen.others)):
        for batch, _, i, said_of in itertools.islice(list_of, count):
            about = f"{batch.body}, {batch.laws[0].moduli.size} branches, rtol {batch.rtol:g}"
            print(
                f"  {name} {said_of[0]}, miss {said_of[1]:.2g}, over its error {said_of[2]:.2g}: point {i} of "
                f"draw({batch.family!r}, {batch.number}), {about}"
            )
    for batch, text in crashed[: chosen.show]:
        print(f"\n  CRASHED draw({batch.family!r}, {batch.number}), {batch}\n{text}")
    ratios = np.array([v[2] for *_, all_of in verdicts for v in all_of if v[0] in ("right", "wrong")])
    points = max(sum(row[2] for row in rows), 1)
    print()
    record["verdicts"] = [
        verdict("points wrong and not flagged", len(wrong), 0),
        verdict("scenes that crashed", sum(row[6] for row in rows), 0),
        verdict("points that the judge could not judge", 100 * sum(row[5] for row in rows) / points, 1, " %"),
        verdict("true error within `error`", 100 * float(np.mean(ratios <= 1)), 99, " %", least=True),
        verdict("points flagged", 100 * sum(row[4] for row in rows) / points, 1, " %"),
    ]
    record["seconds"] = {"answers": took, "all": time.perf_counter() - begin}
    print(f"  {took:.0f} s for the answers, compiling included; {record['seconds']['all']:.0f} s with the judges")
    if chosen.family is None and chosen.scenes >= 1000:
        save("stress_motion", record)
    return 1 if wrong or crashed else 0


if __name__ == "__main__":
    sys.exit(main())
