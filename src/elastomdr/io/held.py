"""Whether the rows of a table over time are the response to one step: what of stress and
strain was held, by all of its columns.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..errors import InputError, advise
from ..units.registry import KINDS, to_si
from .columns import LOGS, Column, naming, understand, unit_of
from .quantities import QUANTITIES
from .tables import TitledTable, titled_unit

if TYPE_CHECKING:
    from .._types import Kind

# ratio of the largest to the smallest stress (or strain) that counts as held
_CONSTANT = 1.05
_STEP = 0.25  # change from row to row that ends a step, less being a drift
_FEWEST_HELD = 5  # rows
BACK = 0.25  # share by which a compliance falls, or a modulus rises, after its step
_RINGING = 0.1  # share of rows up to which this is the ringing of an instrument
_STEADY = 0.9  # rank correlation with time from which numbers grow, or fall, all along
_HELD = {"creep": "stress", "relaxation": "strain"}
_EXAMPLE = {"creep": "0.1 MPa", "relaxation": "1 %"}
# what a column is by the kind of its unit, or, where it has none, by its title
_BY_UNIT = (
    ("stress", ("pressure", "force", "torque"), "(?!)"),
    ("strain", ("length", "angle"), "(?!)"),
    ("rate", ("angular frequency", "velocity"), r"rate|dot\b|speed|\u0307"),
    ("viscosity", ("viscosity",), r"visc|viskos|^(eta|\u03b7)"),
    ("", (), ""),
)
# titles of what may change while a step is held
_CHANGES = r"temp|time|zeit|modul|energ|error|std"
_CHANGES_IN_SHEAR = rf"{_CHANGES}|normal|axial|gap|spalt|thick|dicke|\bN_?[12]|\bF_?N\b"


class NoStep(InputError):
    """Rows over time that are no response to one step of stress or strain."""

    def __init__(
        self, table: TitledTable, why: str, advice: str, ended: float = -np.inf
    ):
        super().__init__(f"{table.name}: {why}{advice and ': '}{advice}.")
        self.why = why
        self.ended = ended  # their last time [s]


class _Load(NamedTuple):
    """A column that may tell what was held."""

    name: str  # number and title; of what a user gives for all rows its quantity
    role: str  # stress, strain, rate or viscosity; "" where nobody says
    titled: bool  # whether its title is one of stress or strain
    numbers: np.ndarray

    def held(
        self, ratio: np.ndarray, time: np.ndarray, rows: np.ndarray, creep: bool
    ) -> slice | None:
        """Of which `rows` it says that the step is held: none where it varies, None
        where it does not say.

        Compliance is strain over stress, modulus stress over strain (`ratio`): a column
        of one of them gives the other.
        """
        role, numbers = self.role, self.numbers[rows]
        if role == "rate" and not _varies(numbers):
            role, numbers = "strain", numbers * time[rows]
        with np.errstate(divide="ignore", invalid="ignore"):
            other = numbers / ratio[rows]
        if role in ("stress", "strain"):
            run = _run(numbers if (role == "stress") == creep else other)
            says = run.stop or self.titled or _varies(numbers)
            return run if says else None
        if role == "viscosity":  # over the modulus: strain over its rate
            varies = not creep and _way(other) != 0
        elif role == "rate":
            varies = _way(numbers) > 0
        elif _varies(numbers) and (run := _run(other)).stop:
            return run
        else:  # points are counted
            varies = _way(numbers) != 0 and not (np.diff(numbers) == 1).all()
        return slice(0, 0) if varies else None


def while_held(
    table: TitledTable,
    columns: Mapping[str, Column],
    measured_as: str,
    kind: Kind,
    ramp: float,
) -> tuple[TitledTable, str, tuple[str, ...]]:
    """The rows of a table over time while the stress (creep) or the strain (relaxation)
    is held, which of both it is, and what is left out or not known, in words.

    Compliance and modulus are columns of flow curves and ramps too: whatever is, by
    title or unit, in proportion to stress, strain or its rate must say that the step
    is held, and what has neither must not grow or fall all along. Rows within the
    `ramp` [s] are not looked at. Raises `InputError`.
    """
    count = len(table.rows)
    time = np.arange(float(count))
    if "time" in columns:
        time = columns["time"].of(table, unit_of(table, columns["time"]))
    loads = _loads(table, columns, kind, _HELD.get(measured_as, ""))
    ratio, ways = np.ones(count), {measured_as: loads}
    if measured_as in _HELD:
        ratio = _numbers(table, columns[measured_as])
    else:  # stress over strain
        ways = {
            way: [one]
            for way, role in _HELD.items()
            for one in loads
            if one.role == role
        }
    kept = [np.flatnonzero(~np.isfinite(time))]  # named later as no measurement
    found: set[str] = set()
    told = False
    for curve in _curves(time):
        late = curve[time[curve] > ramp]
        held, varies = {}, ""
        for way, loads in ways.items():
            said = {
                one.name: rows
                for one in loads
                if (rows := one.held(ratio, time, late, way == "creep")) is not None
            }
            told |= bool(said)
            rows = next(iter(said.values()), slice(_turn(ratio[late], way)))
            varies = next((name for name in said if not said[name].stop), "")
            if not varies:
                held[way] = late[rows]
        if len(held) == 1:
            ((response, rows),) = held.items()
            found.add(response)
            kept += [np.setdiff1d(curve, late), rows]
        elif not found:
            ended = float(np.nanmax(time, initial=0.0))
            raise NoStep(table, *_not_held([*ways], bool(held), table, varies), ended)
        else:  # what follows remembers this
            break
    if len(found) > 1:
        raise NoStep(table, *_not_held([*ways], False, table, ""))
    (response,) = found
    load = _HELD[response]
    untold = (
        f"{table.name}: nothing in the file tells that the {load} was held; if it was, "
        f"say so, as {naming({load: _EXAMPLE[response]})}."
    )
    remarks = [untold] * (not told and not ramp)
    places = np.sort(np.concatenate(kept))
    if places.size < count:
        line = table.rows[int(np.setdiff1d(np.arange(count), places)[0])].line
        why = (
            f"{load} is not held there"
            if told
            else f"{measured_as} turns back there, as after another step"
        )
        remarks += [
            f"{table.name}: {count - places.size} rows (line {line} on) left out: "
            f"{why}."
        ]
    rows = [table.rows[i] for i in places]
    return table._replace(rows=rows), response, tuple(remarks)


def _loads(
    table: TitledTable, columns: Mapping[str, Column], kind: Kind, held: str
) -> list[_Load]:
    """What may tell whether stress or strain was held: what the user gives for all
    rows and the columns of both, or else all others with a unit of load, motion or its
    rate, or without any.
    """
    titled = [
        _Load(role, role, True, np.ones(len(table.rows)))
        if role in table.fixed
        else _Load(columns[role].words, role, True, _numbers(table, columns[role]))
        for role in _HELD.values()
        if role in table.fixed or (role in columns and columns[role].known)
    ]
    if titled or not held:
        return [one for one in titled if one.role == held] or titled
    loads = []
    used = {one.place for one in columns.values() if one.known}
    changes = _CHANGES_IN_SHEAR if kind == "shear" else _CHANGES
    for head in table.heads:
        title, unit = titled_unit(head, *KINDS)
        column = understand(head, QUANTITIES)
        known = column and column.known and column.quantity.kind != "viscosity"
        if known or head.place in used or re.search(changes, title, re.IGNORECASE):
            continue
        bare = not unit or to_si(unit, "ratio") is not None
        for role, kinds, pattern in _BY_UNIT:
            if any(to_si(unit, kind) for kind in kinds) or (
                bare and re.search(pattern, title, re.IGNORECASE)
            ):
                numbers = np.abs(table.column(head.place))
                loads.append(_Load(head.words, role, False, numbers))
                break
    return loads


def _numbers(table: TitledTable, column: Column) -> np.ndarray:
    """The numbers of a column, in the unit that it has."""
    numbers = table.column(column.place)
    with np.errstate(over="ignore"):
        return LOGS.get(column.log, 10.0) ** numbers if column.log else numbers


def _varies(numbers: np.ndarray) -> bool:
    """Whether numbers differ by more than what is held does."""
    known = np.abs(numbers[np.isfinite(numbers)])
    return bool(known.size and np.ptp(known) > (_CONSTANT - 1) * known.max())


def _way(numbers: np.ndarray) -> int:
    """1 where numbers that vary grow all along, -1 where they fall, else 0."""
    known = numbers[np.isfinite(numbers)]
    if known.size < _FEWEST_HELD or not _varies(known):
        return 0
    ranks = np.argsort(np.argsort(known))
    along = np.corrcoef(ranks, np.arange(known.size))[0, 1]
    return int(np.sign(along)) * (abs(along) > _STEADY)


def _not_held(
    ways: Sequence[str], held: bool, table: TitledTable, varies: str
) -> tuple[str, str]:
    """Why rows over time are no response to one step, and what to do, in words."""
    what = f"stress and strain {'are both constant' if held else 'both vary'}"
    given = " or ".join(naming({_HELD[way]: _EXAMPLE[way]}) for way in ways)
    advice = f"leave out the rows while it changes, or give what was held, as {given}"
    if len(ways) == 1:
        what = f"by column {varies} the {_HELD[ways[0]]} is not held"
    if "relaxation" in ways:
        advice += f"; of a ramp its duration, as {advise('ramp=2.0', {'ramp': '2 s'})}"
    line = table.rows[0].line
    return (
        f"{what} over time from line {line} on, which is neither creep nor relaxation",
        advice,
    )


def _run(numbers: np.ndarray) -> slice:
    """The numbers, from about the first on, over which numbers hold; none where they do
    not, or drift.

    The first of them may still be on their way; the last is before a step.
    """
    few = min(_FEWEST_HELD, numbers.size)
    for start in range(min(few, numbers.size // 4) + 1):
        level = numbers[start] if numbers.size else 0.0
        if not level > 0:
            continue
        off = np.abs(numbers[start:] / level - 1)
        away = np.flatnonzero(off > _CONSTANT - 1)
        if not away.size:
            return slice(start, numbers.size)
        if away[0] >= few and off[away[0]] > _STEP:
            return slice(start, start + int(away[0]))
    return slice(0, 0)


def _turn(numbers: np.ndarray, response: str) -> int:
    """How many rows there are before a compliance falls, or a modulus rises, by more
    than noise and ringing do.
    """
    known = np.where(np.isfinite(numbers), numbers, 0.0)
    if response == "creep":
        back = known < (1 - BACK) * np.maximum.accumulate(known)
    else:
        known = np.where(known > 0, known, np.inf)
        largest = known[np.isfinite(known)].max(initial=0.0)
        back = known > np.minimum.accumulate(known) + BACK * largest
        back &= np.isfinite(known)
    if back.sum() <= _RINGING * numbers.size:
        return numbers.size
    return int(np.argmax(back))


def _curves(time: np.ndarray) -> list[np.ndarray]:
    """The rows of each curve, by ascending time: where it turns the next one begins."""
    rows = np.flatnonzero(np.isfinite(time))
    along = np.sign(np.diff(time[rows]))
    if (along < 0).sum() > (along > 0).sum():  # the last time first
        return [curve[::-1] for curve in np.split(rows, np.flatnonzero(along > 0) + 1)]
    return np.split(rows, np.flatnonzero(along < 0) + 1)
