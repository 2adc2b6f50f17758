"""Random histories, judged by routes that share nothing with elastomdr.

Indentation under a depth element by element and event by event (`slow_elements.py`),
under a load by a plain march, extrapolated (`slow_load.py`), impacts by the reduced
equations in scipy (`slow_impact.py`), traction in closed form with mpmath, by a march
where elements stick again, and tangential loading by play operators
(`slow_friction.py`).
"""

import math
from typing import Any

import numpy as np
from slow_elements import Line, force, recovery
from slow_friction import brush, brush_march, sheared_elastic, sheared_slowly
from slow_impact import struck
from slow_load import depths
from slow_route import closed
from stress_harness import Verdict
from stress_motion_draw import POWERS, Batch, elastic


def judge(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    """A verdict per instant, impact or point."""
    return {
        "indent, depth": _indent_depth,
        "indent, load": _indent_load,
        "impact": _impact,
        "traction": _traction,
        "shear, elastic": _shear,
        "shear, viscoelastic": _shear,
    }[batch.family](batch, found)


def said(
    values: Any,
    truth: Any,
    error: Any,
    good: Any,
    scale: float,
    own: float,
    rtol: float,
    also: Any = None,
) -> list[Verdict]:
    """Verdicts on values of one history, `error` relative to `scale`."""
    out = []
    for i, value in enumerate(values):
        if not good[i]:
            out.append(("flagged" if np.isnan(value) else "wrong", np.nan, np.nan))
            continue
        miss = abs(value - truth[i]) / scale
        beyond = max(miss - own, 0.0)
        wrong = (
            not math.isfinite(miss)
            or beyond > rtol
            or (also is not None and also[i] > rtol)
        )
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
    for i, (t, d) in enumerate(
        zip(batch.inputs["time"], batch.inputs["depth"], strict=True)
    ):
        try:
            truth, own = force(batch.laws[0], modes, _line(batch), t, d)
        except ArithmeticError:
            out += [("unjudged", np.nan, np.nan)] * t.size
            continue
        scale = np.abs(truth).max()
        rows = (found[name][i] for name in ("error", "converged"))
        out += said(
            found["force"][i],
            truth,
            *rows,
            scale if scale > 0 else 1.0,
            own + 3e-12,
            batch.rtol,
        )
    return out


def _indent_load(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, line = [], _line(batch)
    for i, (t, p) in enumerate(
        zip(batch.inputs["time"], batch.inputs["load"], strict=True)
    ):
        deepest = np.nanmax(np.append(found["depth"][i], -np.inf))
        for finer in (False, True):
            try:
                if not deepest > 0:
                    raise ArithmeticError
                # The elements only have to reach far enough: 1.3 times the radius of
                # the deepest instant said.
                truth, own = depths(
                    batch.laws[0], line, t, p, 1.3 * float(line.reach(deepest)), finer
                )
            except ArithmeticError:
                truth, own = np.full(t.size, np.nan), np.inf
            rows = (found[name][i] for name in ("error", "converged"))
            verdicts = said(
                found["depth"][i], truth, *rows, np.abs(truth).max(), own, batch.rtol
            )
            if _plain(verdicts):
                break
        out += verdicts
    return out


def _plain(verdicts: list[Verdict]) -> bool:
    """Whether a finer judge is not needed."""
    return all(v[0] == "flagged" or (v[0] == "right" and v[2] <= 1) for v in verdicts)


def _impact(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, power = [], (POWERS[batch.body] + 1) / POWERS[batch.body]
    factor = elastic(batch.body, batch.size)
    for i, one in enumerate(batch.laws):
        value, good, error = (
            found[name][i] for name in ("restitution", "converged", "error")
        )
        if not good:
            out += said([value], [0], [0], [good], 1.0, 0.0, batch.rtol)
            continue
        for rtol, own in ((1e-9, 3e-7), (1e-11, 3e-8)):
            try:
                truth = struck(
                    one,
                    power,
                    factor,
                    batch.inputs["mass"][i],
                    batch.inputs["velocity"][i],
                    rtol,
                )
            except (ArithmeticError, ValueError):
                verdict = [("unjudged", np.nan, np.nan)]
                continue
            depth = (
                abs(found["max_depth"][i] / truth.depth - 1)
                if truth.restitution > 0
                else 0.0
            )
            verdict = said(
                [value],
                [truth.restitution],
                [error],
                [good],
                1.0,
                own,
                batch.rtol,
                [depth - own],
            )
            if verdict[0][0] == "right" and verdict[0][2] <= 1:
                break
        out += verdict
    return out


def _traction(batch: Batch, found: dict[str, Any]) -> list[Verdict]:
    out, power = [], int(POWERS[batch.body])
    for i, one in enumerate(batch.laws):
        sheared, (v, xi, mu) = (
            batch.inputs["sheared"][i],
            (batch.inputs[n][i] for n in ("velocity", "creepage", "friction")),
        )
        value, load, good = (
            float(found[name][i]) for name in ("force", "normal_force", "converged")
        )
        error, edges = (
            float(found["error"][i]),
            (float(found["edges"][i][0]), float(found["edges"][i][1])),
        )
        if not good:
            out += said([value], [0], [0], [good], 1.0, 0.0, batch.rtol)
            continue
        normal = closed(power, batch.size, one, float(v), edges[0])
        also = [
            abs(normal.normal_force / load - 1)
            + abs(normal.trailing - edges[1]) / edges[0]
            - 1e-9
        ]
        again, own, coarse = False, 1e-11, np.nan
        truth = brush(one, sheared, batch.size, float(v), edges, float(mu), float(xi))
        if math.isfinite(mu) and xi > 0 and mu > 0:
            coarse, again = brush_march(
                one, sheared, batch.size, v, edges, mu, xi, 1500
            )
            # it slips and sticks again within the first step
            again |= abs(coarse / truth - 1) > 1e-3
        if again:
            marches = [coarse]
            for steps in (3000, 6000, 12000, 24000):
                marches.append(
                    brush_march(one, sheared, batch.size, v, edges, mu, xi, steps)[0]
                )
                if len(marches) > 2:
                    truth, before = (
                        (4 * marches[k] - marches[k - 1]) / 3 for k in (-1, -2)
                    )
                    own = abs(truth - before) / max(abs(truth), 1e-300)
                    if own < 1e-3 * batch.rtol:
                        break
        scale = abs(truth) if truth != 0 else 1.0
        weight_error = [error * load / scale]
        # no more of a traction far below the load
        limit = max(batch.rtol, 1e-13 * load / scale)
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
        route = (
            normal,
            sideways,
            given["friction"],
            batch.size,
            given["depth"][0],
            given["time"],
        )
        for finest in (600, 1200):
            (coarse, _), (middle, _), (fine, own) = (
                sheared_slowly(*route, given["displacement"], finest // part)
                for part in (4, 2, 1)
            )
            truth = (4 * fine - middle) / 3
            own += float(
                np.abs(truth - (4 * middle - coarse) / 3).max() / np.abs(truth).max()
            )
            scale = np.abs(truth).max()
            verdicts = said(
                found["force"],
                truth,
                found["error"] / scale,
                found["converged"],
                scale,
                own,
                batch.rtol,
            )
            if _plain(verdicts):
                break
        return verdicts
    scale = np.abs(truth).max()
    return said(
        found["force"],
        truth,
        found["error"] / scale,
        found["converged"],
        scale,
        own,
        batch.rtol,
    )
