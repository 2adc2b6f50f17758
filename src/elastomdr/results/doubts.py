"""What there is to doubt in a number, as data: of which kind, at which points, why, and
what would help.

A doubt is looked for at every point, so that its mask exists under `jit` too; one that is
found at no point is kept by whoever looked, and not shown. Sentences are made when shown.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from ..checks import Array, is_traced
from ..trees import Tree, replaced, static

Kind = Literal[
    "not converged",
    "no prediction",
    "extrapolated",
    "hot branch",
    "bound",
    "illustrative",
    "estimate",
]
KINDS: tuple[Kind, ...] = get_args(Kind)


class _Usual(NamedTuple):
    """What is said of points, and what would help, where nothing more is known."""

    says: str
    remedy: str


_USUAL: dict[Kind, _Usual] = {
    "not converged": _Usual(
        "did not converge and are NaN", "what the ConvergenceWarning beside them names"
    ),
    "no prediction": _Usual(
        "have no bound on the model",
        "a measured value to compare with",
    ),
    "extrapolated": _Usual(
        "lie beyond the range of the material",
        "moduli measured at those frequencies and temperatures",
    ),
    "hot branch": _Usual(
        "have another steady state (`other_states`), which rubber reaches that was hotter "
        "or colder before",
        "",
    ),
    "bound": _Usual("have a bound on the model above half of the value", ""),
    "illustrative": _Usual(
        "rest on moduli that are illustrative, of no particular rubber",
        "a material fitted to your own data",
    ),
    "estimate": _Usual("are estimates", ""),
}
# of each kind, in a line and in a figure
SHORT: dict[Kind, str] = {
    "not converged": "not converged (left out)",
    "no prediction": "no prediction (no bound on the model)",
    "extrapolated": "extrapolated",
    "hot branch": "hot branch (another steady state)",
    "bound": "bound above half of the value",
    "illustrative": "illustrative moduli",
    "estimate": "an estimate",
}
# a line of `in_words`, or of a result's summary, as a comment
_LINE = re.compile(r"# (?:doubt, )?([^:]+): \d+ of \d+ points (.*?)(; surer: (.*))?\s*")
TITLE = "doubts"  # of the column of a table that names the kinds of each point


class Doubt(Tree):
    """One reason to doubt a number.

    Two are equal where all four fields are, the points by value.
    """

    kind: Kind = static()
    points: Array  # bool, of the shape of the result's points
    says: str = static(default="")  # of the points: "lie beyond the range of ..."
    remedy: str = static(default="")  # what would help; "" where nothing is known

    def __post_init__(self) -> None:
        if not self.says:
            vars(self).update(_USUAL[self.kind]._asdict())

    def found(self) -> bool:
        """Whether it holds at any point; True while JAX traces them."""
        return is_traced(self.points) or bool(np.any(self.points))

    def words(self) -> str:
        """At how many points, why, and what would help."""
        points = np.asarray(self.points)
        sentence = f"{int(points.sum())} of {points.size} points {self.says}"
        return f"{sentence}; surer: {self.remedy}" if self.remedy else sentence

    def _values(self) -> tuple[Any, ...]:
        points = np.asarray(self.points)
        return self.kind, self.says, self.remedy, points.shape, points.tobytes()

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Doubt) and self._values() == other._values()

    def __hash__(self) -> int:
        return hash(self._values())


def found(doubts: Iterable[Doubt]) -> tuple[Doubt, ...]:
    """Those that hold at any point, by kind."""
    shown = [doubt for doubt in doubts if doubt.found()]
    return tuple(sorted(shown, key=lambda doubt: KINDS.index(doubt.kind)))


def where(doubts: Iterable[Doubt], kind: Kind) -> Array | None:
    """The points at which there is a doubt of a kind; None where none was looked for."""
    points: Array | None = None
    for doubt in doubts:
        if doubt.kind == kind:
            points = doubt.points if points is None else points | doubt.points
    return points


def carried(
    doubts: Iterable[Doubt],
    change: Callable[[Any], Any] = lambda points: points,
    failed: bool = False,
) -> tuple[Doubt, ...]:
    """The doubts of what a result was made from, at its own points: `change` takes their
    masks there, and those that say the same become one.

    What did not converge is NaN in what is made from it, which says so itself, unless
    it has no such flag of its own and takes that of the `failed` with it.
    """
    every: dict[tuple[str, str, str], Doubt] = {}
    for doubt in doubts:
        if doubt.kind == "not converged" and not failed:
            continue
        key, points = (doubt.kind, doubt.says, doubt.remedy), change(doubt.points)
        if key in every:
            points = points | every[key].points
        every[key] = replaced(doubt, points=points)
    return tuple(every.values())


def counted_kinds(doubts: Iterable[Doubt]) -> str:
    """At how many points there is each kind, in a line; "" where there is none."""
    doubts = list(doubts)
    said = []
    for kind, words in SHORT.items():
        if (points := where(doubts, kind)) is not None and np.any(points):
            count, size = int(np.sum(points)), np.size(points)
            said.append(f"{words} at {'all' if count == size else count} of {size}")
    return ", ".join(said) + (" points" if said else "")


def kinds_of_points(doubts: Iterable[Doubt], shape: tuple[int, ...]) -> np.ndarray:
    """The kinds of each point, such as "extrapolated; bound", as texts of this shape."""
    names = np.full(shape, "", dtype=object)
    for kind in KINDS:
        points = where(doubts, kind)
        if points is not None:
            here = np.broadcast_to(np.asarray(points), shape)
            names[here] = [f"{n}; {kind}" if n else kind for n in names[here]]
    return names.astype(str)


# attributes of an array of flags, by the CF conventions: one bit for each kind
FLAGS: dict[str, Any] = {
    "long_name": "doubts",
    "flag_masks": [1 << bit for bit in range(len(KINDS))],
    "flag_meanings": " ".join(kind.replace(" ", "_") for kind in KINDS),
}


def flags(doubts: Iterable[Doubt], shape: tuple[int, ...]) -> np.ndarray:
    """The kinds of each point as bits, which `FLAGS` names."""
    bits = np.zeros(shape, np.uint8)
    for mask, kind in zip(FLAGS["flag_masks"], KINDS, strict=True):
        if (points := where(doubts, kind)) is not None:
            bits |= np.where(points, np.uint8(mask), np.uint8(0))
    return bits


def from_kinds(names: Sequence[str], lines: Iterable[str] = ()) -> tuple[Doubt, ...]:
    """The doubts of points whose kinds a table names, as `kinds_of_points` writes them;
    why, and what would help, is taken from lines of `in_words` where there are any.
    """
    of_points = [name.split("; ") for name in names]
    told: dict[str, list[tuple[str, str]]] = {}
    for found_line in filter(None, map(_LINE.fullmatch, lines)):
        kind, says, _, remedy = found_line.groups(default="")
        told.setdefault(kind, []).append((says, remedy))
    return tuple(
        Doubt(kind, points, *reason)
        for kind in KINDS
        if (points := np.array([kind in each for each in of_points])).any()
        for reason in told.get(kind, [("", "")])
    )


def in_words(doubts: Iterable[Doubt]) -> Iterator[str]:
    """A line for each, as comments in files of other programs."""
    return (f"doubt, {doubt.kind}: {doubt.words()}" for doubt in doubts)
