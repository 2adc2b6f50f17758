"""Whether the rows of a table over time are the response to one step: what of stress and
strain was held, by all of its columns.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ..errors import InputError, advise, either
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
    ("rate", ("angular frequency", "velocity"), r"rate|dot\b|speed|\u0307"),
    ("stress", ("pressure", "force", "torque"), r"stress|spannung"),
    ("strain", ("length", "angle"), r"strain|dehnung"),
    ("viscosity", ("viscosity",), r"visc|viskos|^(eta|\u03b7)"),
    ("", (), ""),
)
# titles of what may change while a step is held, with the unit of a load, and without
_CHANGES = r"modul(us|i|e|n)?\b|energ|dynamic|oscill|\b(error|std)"
_CHANGES_IN_SHEAR = (
    rf"{_CHANGES}|normal(?!i[sz])|axial|gap|spalt|thick|dicke|\bN_?[12]|\bF_?N\b|"
    "\ubc95\uc120|\uc218\uc9c1|\uac04\uaca9|\uac2d"
)
_COUNTS = (
    r"temp|time|zeit|elapsed|humid|feucht|"
    r"^((meas|mess|data)\w*\.? ?)?(pts?|points?|punkte?|no|nr|number|index|count|row)\.?$"
)
_APART = 0.5  # [K], within which two temperatures are one
_AGAIN = 0.5  # share of the last time before which a time begins again


class NoStep(InputError):
    """Rows over time that are no response to one step of stress or strain."""

    def __init__(
        self, table: TitledTable, why: str, advice: str, ended: float = -np.inf
    ):
        super().__init__(
            argument="path",
            accepted="a table of the response to one step of stress or strain",
            hint=why + (": " + advice if advice else ""),
        )
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
        of one of them gives the other, which tells where it varies, but is constant by
        construction where the ratio was made with one number.
        """
        role, numbers = self.role, self.numbers[rows]
        numbers = numbers * np.copysign(1.0, np.nansum(numbers))  # compression
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
    is held. What has no column of what was held must not fall (compliance) or rise
    (modulus): there the rows end, or, where a modulus rises at first, begin. Of runs at
    one temperature, where times begin again, the first is read. Rows within the `ramp`
    [s] are not looked at. Raises `InputError`.
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
            way: [one for one in loads if one.role == role]
            for way, role in _HELD.items()
        }
    kelvin = np.full(count, np.nan)
    if "temperature" in columns:
        kelvin = table.column(columns["temperature"].place)
    kept = [np.flatnonzero(~np.isfinite(time))]  # named later as no measurement
    ended: list[tuple[float, float]] = []  # temperature and last time of each curve
    again: list[int] = []  # where times begin again
    found: set[str] = set()
    told = False
    for curve in _curves(time):
        late = curve[time[curve] > ramp]
        known = kelvin[curve][np.isfinite(kelvin[curve])]
        own = float(np.median(known)) if known.size else np.nan
        if any(
            not abs(own - other) > _APART and time[curve[0]] < _AGAIN * last
            for other, last in ended
        ):
            again.append(int(curve[0]))
            continue
        held, varies = {}, ""
        for way, loads in ways.items():
            said, sure = {}, False
            for one in loads:
                rows = one.held(ratio, time, late, way == "creep")
                if rows is not None:
                    said[one.name] = rows
                    sure |= one.role == _HELD[way]
            if not sure:
                said[columns[measured_as].words] = _turn(ratio[late], way)
            told |= sure
            varies = next((name for name in said if not said[name].stop), "")
            if not varies:
                start = max(rows.start for rows in said.values())
                held[way] = late[start : min(rows.stop for rows in said.values())]
        if len(held) == 1:
            ((response, rows),) = held.items()
            found.add(response)
            kept += [np.setdiff1d(curve, late), rows]
            ended.append((own, float(time[curve[-1]])))
        elif not found:
            last = float(np.nanmax(time, initial=0.0))
            raise NoStep(table, *_not_held([*ways], bool(held), table, varies), last)
        else:  # what follows remembers this
            break
    if len(found) > 1:
        raise NoStep(table, *_not_held([*ways], False, table, ""))
    (response,) = found
    load = _HELD[response]
    untold = (
        f"{table.name}: nothing in the file tells that the {load} was held; if it was, "
        "say so, as " + naming({load: _EXAMPLE[response]}) + "."
    )
    remarks = [untold] * (not told and not ramp)
    places = np.sort(np.concatenate(kept))
    if places.size < count:
        first = int(np.setdiff1d(np.arange(count), places)[0])
        line = table.rows[first].line
        why = f"{load} is not held there"
        if first in again:
            why = "times begin again there, as of another step"
        elif not told:
            way = "falls" if response == "creep" else "rises"
            why = f"{measured_as} {way} there, as while {load} changes"
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
    rows, or the columns of what was held and all others of its kind, or, without any,
    whatever has a unit of load, motion or its rate, or none.
    """
    titled = [
        _Load(role, role, True, np.ones(len(table.rows)))
        if role in table.fixed
        else _Load(columns[role].words, role, True, _numbers(table, columns[role]))
        for role in _HELD.values()
        if role in table.fixed or (role in columns and columns[role].known)
    ]
    loads = [one for one in titled if one.role == held] or titled
    if any(one.name in table.fixed for one in loads):
        return loads
    wanted = {one.role for one in loads}
    if held and held not in wanted:
        wanted = {role for role, *_ in _BY_UNIT}
    used = {one.place for one in columns.values() if one.known}
    always = _CHANGES_IN_SHEAR if kind == "shear" else _CHANGES
    for head in table.heads:
        title, unit = titled_unit(head, *KINDS)
        column = understand(head, QUANTITIES)
        told = column.quantity if column and column.known else None
        if head.place in used or (
            told and told.kind != "viscosity" and told.role not in _HELD.values()
        ):
            continue
        if re.search(always, title, re.IGNORECASE):
            continue
        bare = not unit or to_si(unit, "ratio") is not None
        for role, kinds, pattern in _BY_UNIT:
            if any(to_si(unit, kind) for kind in kinds) or (
                bare and re.search(pattern, title, re.IGNORECASE)
            ):
                counts = bare and role in ("", "rate")
                counts = counts and re.search(_COUNTS, title, re.IGNORECASE)
                if role in wanted and not counts:
                    numbers = table.column(head.place)
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
    given = either([naming({_HELD[way]: _EXAMPLE[way]}) for way in ways])
    advice = "leave out the rows while it changes, or give what was held, as " + given
    if len(ways) == 1:
        what = f"by column {varies} the {_HELD[ways[0]]} is not held"
    if "relaxation" in ways:
        advice += "; of a ramp its duration, as " + advise("ramp=2.0", {"ramp": "2 s"})
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


def _turn(numbers: np.ndarray, response: str) -> slice:
    """Over which rows a compliance grows, or a modulus falls once its strain is
    reached, but for noise and ringing; none where these are few.
    """
    creep = response == "creep"
    places = np.flatnonzero(np.isfinite(numbers) if creep else numbers > 0)
    known = numbers[places]
    start = 0
    if not creep and known.size:
        fallen = known < np.maximum.accumulate(known) / _CONSTANT
        top = int(known[: np.argmax(fallen) or known.size].argmax())
        start = top if known[0] < (1 - BACK) * known[top] else 0
        known = known[start:]
    if creep:
        back = known < (1 - BACK) * np.maximum.accumulate(known)
    else:
        back = known > np.minimum.accumulate(known) + BACK * known.max(initial=0.0)
    stop = known.size
    if back.sum() > _RINGING * stop:
        grows = np.diff(known[: np.argmax(back) + 1]) * (1 if creep else -1) >= 0
        stop = int(np.flatnonzero(grows).max(initial=-1)) + 2
    if stop < min(_FEWEST_HELD, places.size) or start > places.size / 2:
        return slice(0, 0)
    # of no rows all are left, to be named as what they are
    end = places[start + stop] if start + stop < places.size else numbers.size or 1
    return slice(int(places[start]) if start else 0, int(end))


def _curves(time: np.ndarray) -> list[np.ndarray]:
    """The rows of each curve, by ascending time: where it turns the next one begins."""
    rows = np.flatnonzero(np.isfinite(time))
    along = np.sign(np.diff(time[rows]))
    if (along < 0).sum() > (along > 0).sum():  # the last time first
        return [curve[::-1] for curve in np.split(rows, np.flatnonzero(along > 0) + 1)]
    return np.split(rows, np.flatnonzero(along < 0) + 1)
