"""Random scenes by the thousand: answered, judged in other processes, kept as they
finish, summed up by family.

A `Suite` draws batches of scenes, answers them with elastomdr, and judges the answers
by a slow route. A point is "right" or "wrong" (off by more than the tolerance, and
converged), "flagged" (NaN with converged=False), or "unjudged" (the judge does not
vouch for its own answer). Covered is one whose miss, less what the judge itself may be
off by, is within the stated error. Every finished batch is a line in
`out/NAME-SEED.jsonl` at the root of the repository, so that a run that was stopped goes
on where it was; other code begins anew.
"""

import argparse
import hashlib
import json
import multiprocessing
import os
import sys
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from pathlib import Path
from typing import Any, NamedTuple, Protocol

import jax
import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from common import IN_PARTS, heading, save, table, verdict

ROOT = Path(__file__).parents[2]
SAID_EVERY = 30.0  # s
AHEAD = 64  # answers that wait for their judge
# memory maps, at which compiled programs are let go: Linux allows a process 65,530
MAPS = 40_000

Verdict = tuple[str, float, float]  # kind, relative miss, miss over the stated error


class Batch(Protocol):
    """Scenes that one call answers, as numbers, so that another process can judge
    them.
    """

    @property
    def family(self) -> str: ...
    @property
    # of the batch in its family: seed and number draw it again
    def number(self) -> int: ...
    @property
    def scenes(self) -> int: ...


class Suite(NamedTuple):
    """What is stressed, and by what it is judged."""

    name: str  # of the record
    title: str
    scenes: int  # of a whole run
    # share of the scenes, and how many are drawn together
    families: dict[str, tuple[float, int]]
    # family, number, scenes together, random numbers
    draw: Callable[[str, int, int, np.random.Generator], Any]
    # the public call; at least `converged`, an entry per point
    answer: Callable[[Any], dict[str, Any]]
    judge: Callable[[Any, dict[str, Any]], list[Verdict]]
    about: Callable[[Any], str]  # a batch in a few words
    covers: str = "error"  # the field that is to cover what is missed
    covered: float = 99.0  # of what is judged [%]
    flagged: float = 1.0  # of all points, at most [%]


class Done(NamedTuple):
    """A finished batch."""

    family: str
    number: int
    scenes: int
    verdicts: list[Verdict]
    failure: str  # of the answer ("crashed") or of the judge
    crashed: bool
    answer: float  # [s]
    judge: float  # [s]
    wall: float  # since the batch that finished before [s]
    code: str  # that answered and judged, as a hash


def drawn(suite: Suite, family: str, number: int, seed: int) -> Any:
    """The batch of that number; the same for the same seed."""
    random = np.random.default_rng([seed, list(suite.families).index(family), number])
    return suite.draw(family, number, suite.families[family][1], random)


def run(suite: Suite) -> int:
    """The command line of a suite; 1 if anything was wrong or crashed."""
    options = argparse.ArgumentParser(description=suite.title)
    options.add_argument("--scenes", type=int, default=suite.scenes)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument(
        "--family", action="append", choices=list(suite.families), help="default: all"
    )
    options.add_argument(
        "--processes", type=int, default=os.cpu_count(), help="that judge"
    )
    options.add_argument(
        "--fresh", action="store_true", help="forget what an earlier run has finished"
    )
    options.add_argument(
        "--older",
        action="store_true",
        help="keep what older code has finished; the record says so",
    )
    options.add_argument(
        "--report",
        action="store_true",
        help="only sum up what is finished, by older code too",
    )
    options.add_argument(
        "--show",
        type=int,
        default=10,
        help="how many wrong or crashed ones are printed",
    )
    options.add_argument(
        "--others",
        type=int,
        default=0,
        help="how many flagged and uncovered ones are printed",
    )
    chosen = options.parse_args()

    record = heading(suite.title, f"{chosen.scenes} scenes, seed {chosen.seed}")
    wanted = {
        (family, number)
        for family, (share, together) in suite.families.items()
        if not chosen.family or family in chosen.family
        for number in range(max(1, round(share * chosen.scenes / together)))
    }
    path = ROOT / "out" / f"{suite.name}-{chosen.seed}.jsonl"
    done = {} if chosen.fresh else _kept(path, chosen.older or chosen.report)
    if chosen.report:
        wanted &= set(done)
        if not wanted:
            options.error(f"--report: nothing of this has finished, in {path.name}")
        record["inputs"].append(f"a part: {len(wanted)} batches that have finished")
    if older := sum(one.code != _code() for one in done.values()):
        record["inputs"].append(
            f"{older} batches answered and judged by an older version of the code"
        )
    if not chosen.report:
        _begin(path, done)
    order = [one for one in _in_order(suite, wanted) if one not in done]
    if len(order) < len(wanted):
        print(
            (
                f"  {len(wanted) - len(order)} of {len(wanted)} batches are kept from "
                f"before, in {path.name}"
            ),
            flush=True,
        )
    with path.open("a") as kept:
        for one in _finished(suite, order, chosen.seed, chosen.processes):
            done[one.family, one.number] = one
            kept.write(json.dumps(one) + "\n")
            kept.flush()
    found = [done[one] for one in _in_order(suite, wanted)]
    record |= _summary(suite, found)
    _print(suite, found, chosen)
    if IN_PARTS or (
        not chosen.family and not chosen.report and chosen.scenes >= suite.scenes
    ):
        save(f"robustness/{suite.name}", record)
    return (
        1
        if any(
            one.crashed or any(v[0] == "wrong" for v in one.verdicts) for one in found
        )
        else 0
    )


def _in_order(suite: Suite, wanted: set[tuple[str, int]]) -> list[tuple[str, int]]:
    families = list(suite.families)
    return sorted(wanted, key=lambda one: (families.index(one[0]), one[1]))


def _code() -> str:
    """What answers and judges, as a hash."""
    here = Path(__file__).parent
    files = [
        *(ROOT / "src").rglob("*.py"),
        *here.glob("stress*.py"),
        *here.glob("slow_*.py"),
    ]
    return hashlib.sha256(
        b"".join(file.read_bytes() for file in sorted(files))
    ).hexdigest()


def _kept(path: Path, older: bool) -> dict[tuple[str, int], Done]:
    """Batches that the same code has finished, or any; a last line that an interrupt
    cut short is left out.
    """
    done, code = {}, _code()
    for line in path.read_text().splitlines() if path.exists() else ():
        try:
            one = Done(*json.loads(line))
        except (json.JSONDecodeError, TypeError):
            continue
        if older or one.code == code:
            done[one.family, one.number] = one
    return done


def _begin(path: Path, done: dict[tuple[str, int], Done]) -> None:
    path.parent.mkdir(exist_ok=True)
    path.write_text("".join(json.dumps(one) + "\n" for one in done.values()))


def _judged(
    judge: Callable, batch: Batch, found: dict[str, Any]
) -> tuple[list[Verdict], str, float]:
    """In another process: the verdicts, what failed, and the seconds."""
    begin, failure = time.perf_counter(), ""
    try:
        verdicts = judge(batch, found)
    except Exception:  # the judge's own failure: reported, never counted as right
        failure = traceback.format_exc(limit=-3)
        verdicts = [("unjudged", np.nan, np.nan)] * np.size(found["converged"])
    return verdicts, failure, time.perf_counter() - begin


def _finished(
    suite: Suite, order: list[tuple[str, int]], seed: int, processes: int
) -> Iterator[Done]:
    """Batches as they finish."""
    said = last = begin = time.perf_counter()
    code = _code()
    waiting: dict[Future, tuple[Any, float]] = {}
    count = wrong = 0
    with ProcessPoolExecutor(processes, multiprocessing.get_context("spawn")) as pool:
        for i in range(len(order) + 1):
            if i < len(order):
                batch, crash, start = (
                    drawn(suite, *order[i], seed),
                    "",
                    time.perf_counter(),
                )
                try:
                    with warnings.catch_warnings():
                        warnings.simplefilter("ignore")
                        found = suite.answer(batch)
                # a crash is what the test looks for: counted, shown, and the exit
                # status is 1
                except Exception:
                    crash = traceback.format_exc(limit=-3)
                _let_go()
                took = time.perf_counter() - start
                if crash:
                    now = time.perf_counter()
                    yield Done(
                        batch.family,
                        batch.number,
                        batch.scenes,
                        [],
                        crash,
                        True,
                        took,
                        0.0,
                        now - last,
                        code,
                    )
                    last, count = now, count + 1
                else:
                    waiting[pool.submit(_judged, suite.judge, batch, found)] = (
                        batch,
                        took,
                    )
            while waiting and (
                i == len(order)
                or len(waiting) > AHEAD
                or any(job.done() for job in waiting)
            ):
                for job in wait(waiting, SAID_EVERY, FIRST_COMPLETED).done:
                    (batch, took), (verdicts, failure, judged) = (
                        waiting.pop(job),
                        job.result(),
                    )
                    wrong += sum(v[0] == "wrong" for v in verdicts)
                    now = time.perf_counter()
                    about = batch.family, batch.number, batch.scenes
                    yield Done(
                        *about, verdicts, failure, False, took, judged, now - last, code
                    )
                    last, count = now, count + 1
                if (now := time.perf_counter()) - said > SAID_EVERY:
                    said = now
                    where = (
                        f"{order[min(i, len(order) - 1)][0]}: {count} of {len(order)} "
                        "batches"
                    )
                    print(
                        f"  {now - begin:6.0f} s, {where}, {wrong} points wrong",
                        file=sys.stderr,
                        flush=True,
                    )


def _let_go() -> None:
    """Thousands of scenes of hundreds of kinds compile more programs than a process may
    hold.
    """
    maps = Path("/proc/self/maps")
    if maps.exists() and maps.read_bytes().count(b"\n") > MAPS:
        jax.clear_caches()


def _summary(suite: Suite, found: list[Done]) -> dict[str, Any]:
    """Table and verdicts of all families, printed and returned."""
    rows = []
    for family in dict.fromkeys(one.family for one in found):
        ours = [one for one in found if one.family == family]
        said = [v for one in ours for v in one.verdicts]
        kinds = [v[0] for v in said]
        judged = [v for v in said if v[0] in ("right", "wrong")]
        rows.append(
            (
                family,
                sum(one.scenes for one in ours),
                len(said),
                *(kinds.count(k) for k in KINDS),
                sum(one.scenes for one in ours if one.crashed),
                max((v[1] for v in judged), default=np.nan),
                max((v[2] for v in judged), default=np.nan),
                _covered(judged),
                sum(one.answer for one in ours),
                sum(one.judge for one in ours),
            )
        )
    columns = (
        "family",
        "scenes",
        "points",
        *KINDS,
        "crashed",
        "largest miss",
        f"over `{suite.covers}`",
        "covered [%]",
    )
    record: dict[str, Any] = {
        "families": table((*columns, "answers [s]", "judges [s]"), rows)
    }
    said = [v for one in found for v in one.verdicts]
    kinds, points = [v[0] for v in said], max(len(said), 1)
    judged = [v for v in said if v[0] in ("right", "wrong")]
    print()
    record["verdicts"] = [
        verdict("points wrong and not flagged", kinds.count("wrong"), 0),
        verdict(
            "scenes that crashed", sum(one.scenes for one in found if one.crashed), 0
        ),
        verdict(
            "points that the judge could not judge",
            100 * kinds.count("unjudged") / points,
            1,
            " %",
        ),
        verdict(
            f"true error within `{suite.covers}`",
            _covered(judged),
            suite.covered,
            " %",
            least=True,
        ),
        verdict(
            "points flagged", 100 * kinds.count("flagged") / points, suite.flagged, " %"
        ),
    ]
    record["seconds"] = {
        name: sum(getattr(one, name) for one in found)
        for name in ("answer", "judge", "wall")
    }
    print(
        "  "
        + ", ".join(
            f"{name} {value:.0f} s" for name, value in record["seconds"].items()
        )
    )
    return record


KINDS = ("right", "wrong", "flagged", "unjudged")


def _covered(judged: list[Verdict]) -> float:
    return 100 * float(np.mean([v[2] <= 1 for v in judged])) if judged else float("nan")


def _print(suite: Suite, found: list[Done], chosen: argparse.Namespace) -> None:
    """The points worth a look, with what draws them again."""
    points = [(one, i, v) for one in found for i, v in enumerate(one.verdicts)]
    wrong = [p for p in points if p[2][0] == "wrong"]
    others = [
        p
        for p in points
        if p[2][0] in ("flagged", "unjudged") or (p[2][0] == "right" and p[2][2] > 1)
    ]
    for one, i, (kind, miss, over) in wrong[: chosen.show] + others[: chosen.others]:
        batch = drawn(suite, one.family, one.number, chosen.seed)
        print(
            f"  {kind.upper() if kind == 'wrong' else kind}, miss {miss:.2g}, "
            f"{over:.2g} times its error: point {i} of {one.family} {one.number}, "
            f"{suite.about(batch)}"
        )
    for one in [one for one in found if one.failure][: chosen.show]:
        batch = drawn(suite, one.family, one.number, chosen.seed)
        how = "CRASHED" if one.crashed else "judge failed"
        print(
            f"\n  {how}: {one.family} {one.number}, {suite.about(batch)}\n{one.failure}"
        )
