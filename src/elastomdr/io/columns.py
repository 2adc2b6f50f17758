"""What a column holds and in which unit: quantities with titles, units and limits, and
what a user says instead.
"""

import functools
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..errors import InputError, advise, closest, either
from ..units.registry import KINDS, is_unit, to_si, usual
from .sheets import number, read_sheet
from .tables import (
    MOST_COLUMNS,
    Head,
    TitledTable,
    clean,
    listed,
    main_table,
    splits,
    titled_unit,
)

LOGS = {"log10": 10.0, "ln": np.e}
_DECADIC = r"log[\s_]?10|log[\s_]?\(10\)|log₁₀|lg"
_LOG = re.compile(
    rf"({_DECADIC}|ln(?![a-z]{{2}})|log(?![a-z]{{2}}))[\s_]*(.+)", re.IGNORECASE
)
# of the first time as hh:mm:ss, above which it may be one of the day [s]
_DAYTIME = 600.0
_CONTRADICTS = 0.1  # of ln(tan delta), from which it contradicts the moduli beside it
_NAMED = 6  # columns passed over, or rows left out, that are named
_NUMBER_WITH_UNIT = re.compile(r"([+-]?\d[\d.]*(?:[eE][+-]?\d+)?)\s*([^\d\s\[].*)")


@dataclass(frozen=True)
class ColumnKind:
    """What a column may hold: `titles` are regular expressions, the preferred ones
    first.
    """

    role: str
    kind: str  # of unit, a key of `units.KINDS`
    titles: tuple[str, ...]
    # or "zero or positive", "between 0 and 90 deg"; "": of no row, NaN where not positive
    valid: str = "positive"
    option: str = ""  # the argument by which a user gives the unit
    # of the largest number, and of all temperatures [SI]
    limits: tuple[float, float] | None = None

    def rank(self, name: str) -> int | None:
        """Which of the titles a name is, the first being the preferred one; None where
        it is none.
        """
        for spelled in dict.fromkeys((name, name.replace("_", " "))):
            for i, pattern in enumerate(self.titles):
                if re.fullmatch(pattern, spelled, re.IGNORECASE):
                    return i
        return None


class Column(NamedTuple):
    """A column that is understood."""

    place: int
    quantity: ColumnKind
    title: str
    unit: str  # as it is written; "" where none is
    rank: int
    letter: str = ""  # "G" or "E", of a modulus
    log: str = ""  # of `LOGS`; "log" where the base is not said
    known: bool = True  # whether the unit is one of the quantity
    users: bool = False  # whether the unit is the user's word, whatever the title says
    sign: float = 1.0  # -1 of compression

    @property
    def role(self) -> str:
        return self.quantity.role

    @property
    def words(self) -> str:
        """Its number and title."""
        return f"{self.place + 1} {self.title!r}"

    def unit_by(self, units: Mapping[str, str]) -> str:
        """Its unit, or else the user's, by kind; "" where nobody gives one."""
        kind = self.quantity.kind.removeprefix("angular ")
        return self.unit or units.get(kind) or "-" * (kind == "ratio")

    def of(self, table: TitledTable, unit: str) -> np.ndarray:
        """The numbers of the column in SI."""
        # of a user's Hz
        kinds = [
            self.quantity.kind,
            *["frequency"] * (self.quantity.kind == "angular frequency"),
        ]
        factor, offset = next(si for kind in kinds if (si := to_si(unit, kind)))
        numbers = table.column(self.place)
        with np.errstate(over="ignore"):
            numbers = LOGS[self.log] ** numbers if self.log else numbers
        return self.sign * numbers * factor + offset


def logarithm(title: str) -> tuple[str, str]:
    """Which logarithm a title says ("log10", "ln", or "log" without a base), and the
    title without it.
    """
    match = _LOG.fullmatch(title.strip())
    if match is None:
        return "", title
    log, rest = match[1].lower(), match[2]
    if rest.startswith("("):  # log(G' [Pa]), log(w/(rad/s)) [-], log(G') [Pa]
        depth = np.cumsum([(mark == "(") - (mark == ")") for mark in rest])
        end = int(np.argmax(depth == 0))
        if end:
            inside = re.sub(r"/\s*\(", " (", rest[1:end])
            behind = rest[end + 1 :].strip()
            rest = f"{inside} {behind}" if behind.strip("[]()- 1") else inside
    return log if log in ("ln", "log") else "log10", rest.lstrip("_ ")


@functools.lru_cache(maxsize=4096)
def understand(head: Head, quantities: tuple[ColumnKind, ...]) -> Column | None:
    """The column below a title; None where the title is none of the quantities."""
    log, title = logarithm(clean(head.title))
    below = head.below.strip("[]() ")
    below = "" if below in ("-", "") else below
    refused: Column | None = None
    ways = [*splits(title), (title, "")]
    if below:
        ways = [
            (title, below),
            *(
                (name, below)
                for name, unit in splits(title)
                if title.endswith(("]", ")")) or is_unit(unit)
            ),
        ]
    for name, unit in ways:
        of_unit, inner = logarithm(unit)
        for quantity in quantities:
            rank = _rank(quantity, name.strip())
            if rank is None or (log and quantity.kind in ("temperature", "angle")):
                continue
            column = Column(
                head.place,
                quantity,
                head.title.strip(),
                unit,
                rank,
                _letter(quantity, name),
                log,
            )
            if not unit or to_si(unit, quantity.kind):
                return column
            if of_unit and to_si(inner, quantity.kind):
                return column._replace(
                    unit=inner, log=of_unit if log in ("", of_unit) else log
                )
            if (
                not (log and unit == "-")
                and refused is None
                and (below or re.search(r"[\[(]", title))
            ):
                refused = column._replace(known=False)
    return refused


def naming(values: Mapping[str, str | int]) -> str:
    """How a user names columns or numbers for roles, in Python and on the command
    line.
    """
    options = [f"{role}={one}" for role, one in values.items()]
    return advise(f"columns={dict(values)}", {"column": options})


def naming_one(*columns: Column) -> str:
    """How a user names one of several columns."""
    return either([naming({one.role: one.place + 1}) for one in columns])


class Understood(NamedTuple):
    """The columns of a table: those whose titles say what they hold, those that a user
    names, and the numbers that a user gives for all rows [SI].
    """

    read: list[Column]
    named: dict[str, Column]
    constants: dict[str, float]

    @property
    def all(self) -> list[Column]:
        return [*self.read, *self.named.values()]

    @property
    def of_user(self) -> set[str]:
        """The roles that a user names."""
        return {*self.named, *self.constants}

    def in_words(self) -> list[str]:
        return [f"{one.words} as {one.role}" for one in self.all]


def understand_table(
    columns: Mapping[str, str | int] | None,
    table: TitledTable,
    quantities: tuple[ColumnKind, ...],
) -> Understood:
    """What the columns of a table are, a user's word before its titles. Raises
    `InputError`.
    """
    named, constants = named_columns(columns, table, quantities)
    places = {column.place for column in named.values()}
    read = [
        column
        for head in table.heads
        if (column := understand(head, quantities))
        and column.role not in (*named, *constants)
        and column.place not in places
    ]
    return Understood(read, named, constants)


def check_columns(columns: Mapping[str, str | int] | None) -> None:
    if columns is not None and not isinstance(columns, Mapping):
        raise InputError(
            argument="columns",
            got=columns,
            accepted="a dict from quantities to titles, such as "
            "{'temperature': 'Title 2'}",
        )


def named_columns(
    columns: Mapping[str, str | int] | None,
    table: TitledTable,
    quantities: tuple[ColumnKind, ...],
) -> tuple[dict[str, Column], dict[str, float]]:
    """The columns, and the numbers for all rows [SI], that a user names for roles;
    those not in the table are left out.

    A column is named by its title or its number from 1, with "[unit]" behind it where
    the file's unit is missing or wrong, in "log10(...)" or "ln(...)" where it holds
    logarithms: "storage": 3, "3 [MPa]", "log10(3) [Pa]". A number with a unit holds for
    all rows: "frequency": "10 Hz".
    """
    roles = {quantity.role: quantity for quantity in reversed(quantities)}
    named, constants = {}, {}
    for role, wanted in (columns or {}).items():
        if role not in roles:
            raise InputError(
                argument="columns",
                got=role,
                accepted=f"by {', '.join(roles)}",
                hint=closest(str(role), list(roles)),
            )
        if isinstance(wanted, bool) or not isinstance(wanted, (int, str)):
            raise InputError(
                argument="columns",
                got=wanted,
                accepted=f"titles or numbers of columns, as {role}",
            )
        title = str(wanted).strip()
        place, unit, log = _place(title, table.heads)
        if place is not None:
            head = next(head for head in table.heads if head.place == place)
            column = _named_column(table, head, roles[role], unit, quantities)
            named[role] = column._replace(log=log) if log else column
        elif (constant := _NUMBER_WITH_UNIT.fullmatch(title)) and (
            si := to_si(constant[2], roles[role].kind)
        ):
            constants[role] = float(constant[1]) * si[0] + si[1]
    return named, constants


def _named_column(
    table: TitledTable,
    head: Head,
    quantity: ColumnKind,
    unit: str,
    quantities: tuple[ColumnKind, ...],
) -> Column:
    """The column that a user names for a quantity, in the user's unit, if there is
    one. Raises `InputError`.
    """
    role, kind = quantity.role, quantity.kind
    column = understand(head, quantities)
    if column is None or (column.role != role and column.quantity.kind != kind):
        column = _column_without_role(head, quantity)
    elif "relaxation" in (role, column.role) and role != column.role and not unit:
        raise InputError(
            argument="columns",
            got=head.title,
            accepted=f"such that {role} is no {column.role} modulus by its title",
            hint="moduli over frequency and relaxation over time are not the same",
        )
    if role != column.role:
        column = column._replace(quantity=quantity)
    if not unit:
        return column
    if not to_si(unit, kind):
        raise InputError(
            argument="columns",
            got=unit,
            accepted=f"with a unit of {kind} for {role}, {usual(kind)}",
        )
    return column._replace(unit=unit, known=True, users=True)


def _column_without_role(head: Head, quantity: ColumnKind) -> Column:
    """A column whose title does not say that it holds the quantity, with the unit that
    stands there.
    """
    in_title = titled_unit(head, quantity.kind)[1]
    bracketed = re.search(r"[\[(]([^\[\]()]+)[\])]\s*$", head.title)
    unit = head.below.strip("[]() ") or in_title or (bracketed[1] if bracketed else "")
    return Column(
        head.place,
        quantity,
        head.title,
        unit,
        0,
        log=logarithm(head.title)[0],
        known=not unit or to_si(unit, quantity.kind) is not None,
    )


def choose(columns: Sequence[Column], table: TitledTable) -> dict[str, Column]:
    """One column for each role: the preferred title, of these the first with fewest
    holes.

    Raises `InputError` where two that are equally good differ.
    """
    chosen: dict[str, Column] = {}
    holes = {
        column.place: int(np.isnan(table.column(column.place)).sum())
        for column in columns
    }

    def order(column: Column) -> tuple[tuple[bool, bool, int], bool, int]:
        many = holes[column.place] > len(table.rows) / 10
        return (not column.known, many, column.rank), bool(column.log), column.place

    for column in sorted(columns, key=order):
        first = chosen.setdefault(column.role, column)
        if (
            first is column
            or order(column)[0] != order(first)[0]
            or not column.quantity.valid
        ):
            continue
        one, other = (_si(each, table) for each in (first, column))
        if (
            one is not None
            and other is not None
            and _differ(one, other, column.quantity.kind)
        ):
            isotherms = (
                "isotherms side by side need their temperatures above them, one for "
                "each, as '-20 degC'; of two samples "
            ) * (first.title == column.title)
            raise InputError(
                argument="path",
                accepted=f"a table with one column of {column.role}, not two that "
                f"differ, {first.words} and {column.words}",
                hint=f"{isotherms}name one, as " + naming_one(first, column),
            )
    return {role: _by_the_clock(column, table) for role, column in chosen.items()}


def _by_the_clock(column: Column, table: TitledTable) -> Column:
    """A column of times, in seconds where they are written as hh:mm:ss.

    Raises `InputError` for times of day, which do not tell when the test began.
    """
    if column.quantity.kind != "time" or np.isnan(table.clock(column.place)).all():
        return column
    times = table.clock(column.place)
    times = times[np.isfinite(times)]
    # Elapsed time begins near the step; a time of day may end a day later, near zero.
    if times[0] > _DAYTIME:
        raise InputError(
            argument="path",
            accepted="a table whose times count from the step of strain or stress",
            hint=f"column {column.words} begins at {times[0] / 3600:.4g} h and lasts "
            f"{np.ptp(times):.4g} s, a time of day: write seconds since the step "
            "in its place",
        )
    return column._replace(unit="s", known=True)


def measured(
    table: TitledTable, chosen: Mapping[str, Column]
) -> tuple[dict[str, np.ndarray], np.ndarray, list[str]]:
    """The numbers of the good rows by role [SI], which rows these are, and what is
    wrong with each of the others.

    Raises `InputError` for a unit that
    nobody gives, and for numbers outside the limits of their quantity.
    """
    given = {role: unit_of(table, column) for role, column in chosen.items()}
    values = {role: column.of(table, given[role]) for role, column in chosen.items()}
    wrong = _rows_of_wrong_width(table)
    good = np.ones(len(table.rows), bool)
    good[list(wrong)] = False
    for role, column in chosen.items():
        x, valid = values[role], column.quantity.valid
        if not valid:
            values[role] = np.where(x > 0, x, np.nan)
            continue
        in_range = {"positive": x > 0, "zero or positive": x >= 0}.get(
            valid, (x > 0) & (x < np.pi / 2)
        )
        for i in map(int, np.flatnonzero(good & ~(np.isfinite(x) & in_range))):
            cell = _cell(table, i, column.place)
            words = f"{cell[:20]!r}, not a number"
            if np.isfinite(x[i]):
                value = f"{number(cell):g} {given[role]}"
                words = f"{value.removesuffix(' -')}, not {valid}"
            good[i], wrong[i] = False, f"{column.title} is {words}"
    bad = [f"line {table.rows[i].line}: {wrong[i]}" for i in sorted(wrong)]
    kept = {role: x[good] for role, x in values.items()}
    if good.any():
        _check_limits(chosen, kept, given)
    return kept, good, bad


def _rows_of_wrong_width(table: TitledTable) -> dict[int, str]:
    """What is wrong with rows cut at blanks that lack a cell, or have numbers behind
    their last one.
    """
    if not table.width:
        return {}
    return {
        i: f"it has {len(row.cells)} cells in place of {table.width}"
        for i, row in enumerate(table.rows)
        if len(row.cells) < table.width
        or any(np.isfinite(number(cell)) for cell in row.cells[table.width :])
    }


def _cell(table: TitledTable, row: int, place: int) -> str:
    cells = table.rows[row].cells
    return cells[place] if place < len(cells) else ""


def _check_limits(
    chosen: Mapping[str, Column],
    values: Mapping[str, np.ndarray],
    units: Mapping[str, str],
) -> None:
    """Raises `InputError` for numbers outside the limits of their quantity."""
    for role, column in chosen.items():
        quantity, known = column.quantity, values[role][np.isfinite(values[role])]
        # a tan delta of a melt may be any: a unit that is written is believed
        written = column.users or (role == "tangent" and column.unit)
        if quantity.limits is None or written or not known.size:
            continue
        low, high = quantity.limits
        least = known.min() if quantity.kind == "temperature" else known.max()
        if least >= low and known.max() <= high:
            continue
        alike = [
            one
            for one in chosen.values()
            if one.quantity.kind == quantity.kind and units[one.role] == units[role]
        ]
        ways = [
            naming({one.role: f"{one.place + 1} [{unit}]" for one in alike})
            for unit in ("%-" if quantity.kind == "ratio" else ["UNIT"])
        ]
        raise InputError(
            argument="path",
            accepted=f"a table whose column {column.words}, read"
            f"{_in(units[role]) or ' without a unit'}, is between "
            + f"{low:g} and {high:g} {KINDS[quantity.kind][0]}".rstrip(" -"),
            hint=f"it goes from {known.min():.4g} to {known.max():.4g}; give the "
            "right unit, even if it is that, as " + either(ways),
        )


class ColumnsRead(NamedTuple):
    """What a file holds whose one table is known by its columns."""

    table: TitledTable
    chosen: dict[str, Column]
    values: dict[str, np.ndarray]  # of the good rows, by role [SI]
    bad: list[str]  # what is wrong with the others


def read_columns(
    path: str | os.PathLike[str],
    quantities: tuple[ColumnKind, ...],
    required: Sequence[str],
    columns: Mapping[str, str | int] | None,
    units: Mapping[str, str],
    log: str = "",
) -> ColumnsRead:
    """The one table of a file by its columns.

    A logarithm without a base is `log`, where that is given.
    """
    check_columns(columns)
    sheet = read_sheet(path)
    table = main_table(sheet)
    if table is None:
        raise InputError(argument="path", accepted=NUMBERS)
    table = table._replace(name=sheet.name, units=units)
    refuse_wide([table])
    understood = understand_table(columns, table, quantities)
    for role, wanted in (columns or {}).items():
        if role not in understood.of_user:
            raise InputError(
                argument="columns",
                got=wanted,
                accepted=f"for {role} a column of {sheet.name!r}, which has "
                f"{listed(table.heads)}",
            )
    candidates = [
        one._replace(log=log) if one.log == "log" and log else one
        for one in understood.read
    ]
    chosen = choose([*candidates, *understood.named.values()], table)
    for role in required:
        if role not in {*chosen, *understood.constants}:
            known = [f"{one.words} as {role}" for role, one in chosen.items()]
            raise InputError(
                argument="path",
                accepted=f"a table with a column of {role}",
                hint=missing(known, table),
            )
    values, good, bad = measured(table, chosen)
    values |= {
        role: np.full(int(good.sum()), value)
        for role, value in understood.constants.items()
    }
    return ColumnsRead(table, chosen, values, bad)


def units_of(table: TitledTable, chosen: Mapping[str, Column]) -> dict[str, str]:
    """The unit of each column, as it is written, and the logarithm of it."""
    return {
        role: f"{column.log} of " * bool(column.log) + column.unit_by(table.units)
        for role, column in chosen.items()
    }


def checked_units(given: Mapping[str, str | None]) -> dict[str, str]:
    """The units that a user gives, by kind. Raises `InputError` for what is none of its
    kind.
    """
    for kind, unit in given.items():
        if unit is not None and not (isinstance(unit, str) and to_si(unit, kind)):
            raise InputError(
                argument=f"{kind}_unit",
                got=unit,
                accepted=f"a unit of {kind} such as {usual(kind)}",
            )
    return {kind: unit for kind, unit in given.items() if unit is not None}


def refuse_contradiction(
    table: TitledTable, chosen: Mapping[str, Column], columns: Sequence[Column]
) -> None:
    """Raises `InputError` where a column of tan delta is not the loss over the storage
    modulus beside it.
    """
    tangent = next((one for one in columns if one.role == "tangent"), None)
    if tangent is None or not {"storage", "loss"} <= chosen.keys():
        return
    loss, storage = chosen["loss"], chosen["storage"]
    viscous, elastic, ratio = (_si(one, table) for one in (loss, storage, tangent))
    if viscous is None or elastic is None or ratio is None:
        return
    with np.errstate(divide="ignore", invalid="ignore"):
        factors = np.abs(ratio * elastic / viscous)
    factors = factors[np.isfinite(factors) & (factors > 0)]
    factor = float(np.median(factors)) if factors.size else 1.0
    in_percent = not tangent.unit and abs(np.log(factor / 100)) < _CONTRADICTS
    if in_percent or abs(np.log(factor)) < _CONTRADICTS:
        return
    raise InputError(
        argument="path",
        accepted=f"a table whose column {tangent.words} is the ratio of {loss.words} "
        f"and {storage.words}",
        hint=f"it is {factor:.3g} times that (median of the rows); name the one that "
        "is right, as " + naming_one(loss, tangent),
    )


def refuse_wide(tables: Sequence[TitledTable]) -> None:
    """Raises `InputError` for a table with more columns than a measurement has."""
    for table in tables:
        if len(table.heads) > MOST_COLUMNS:
            raise InputError(
                argument="path",
                accepted=f"a table of {MOST_COLUMNS:,} columns at most",
                hint=f"it has {len(table.heads):,}: leave out what is not needed, or "
                "exchange rows and columns",
            )


def unit_of(table: TitledTable, column: Column) -> str:
    """The unit of a column: its own, or else the user's. Raises `InputError` where
    there is none.
    """
    quantity = column.quantity
    place = column.place + 1
    ways = naming({column.role: f"{place} [UNIT]"})
    if column.log == "log":
        raise InputError(
            argument="path",
            accepted="a table whose logarithms say their base",
            hint=f"{column.title!r} does not; name it, as "
            + naming({column.role: f"log10({place}) [UNIT]"})
            + ", or with ln in place of log10",
        )
    if not column.known:
        # such as 1/MPa of a compliance
        other = is_unit(column.unit) and "frequency" not in quantity.kind
        raise InputError(
            argument="path",
            accepted=f"a table whose column {column.words} has a unit of "
            f"{quantity.kind} ({usual(quantity.kind)} ...), as {column.role} "
            "needs",
            hint=f"it is {column.unit!r}"
            + ("" if other else "; if it is meant as one, give it as " + ways),
        )
    unit = column.unit_by(table.units)
    if not unit:
        option = quantity.option
        option = advise(option, {option: ""}) + " or " if option else ""
        raise InputError(
            argument="path",
            accepted=f"a table whose column {column.words} has a unit",
            hint="give it, as " + option + ways + f", one of {usual(quantity.kind)}",
        )
    return unit


def taken(table: TitledTable, chosen: Mapping[str, Column]) -> str:
    """In words, which columns are read as what, in which unit, and which are passed
    over.
    """
    units = units_of(table, chosen)
    titles = ", ".join(
        f"{role} from {column.words}"
        + _in(units[role]) * (units[role] not in column.title)
        for role, column in chosen.items()
    )
    rest = [head.words for head in unread(table, chosen) if head.title]
    more = f" and {len(rest) - _NAMED} more" if len(rest) > _NAMED else ""
    return titles + f"; passed over: {', '.join(rest[:_NAMED])}{more}" * bool(rest)


def _in(unit: str) -> str:
    return f" in {unit}" * (unit != "-")


def unread(table: TitledTable, chosen: Mapping[str, Column]) -> list[Head]:
    """The columns that are passed over."""
    places = {column.place for column in chosen.values()}
    return [head for head in table.heads if head.place not in places]


def left_out(name: str, bad: Sequence[str], where: str) -> tuple[str, ...]:
    """A warning on rows that are no measurement; `where` all of them are named."""
    if not bad:
        return ()
    more = f" and {len(bad) - _NAMED} more, all of them in {where}" * (
        len(bad) > _NAMED
    )
    return (
        (
            f"{name}: {len(bad)} row{'s' * (len(bad) > 1)} left out: "
            f"{'; '.join(bad[:_NAMED])}{more}."
        ),
    )


def _place(wanted: str, heads: Sequence[Head]) -> tuple[int | None, str, str]:
    """Where a column stands that a user names, with the unit and the logarithm that the
    user adds.
    """
    for head in heads:
        if head.title.strip() == wanted and wanted:
            return head.place, "", ""
    unit = log = ""
    if match := re.fullmatch(r"(.+?)\s*\[([^\[\]]+)\]", wanted):
        wanted, unit = match[1], match[2]
    if match := re.fullmatch(r"(log10|ln)\((.+)\)", wanted):
        log, wanted = match[1], match[2].strip()
    by_title = next(
        (head.place for head in heads if head.title.strip() == wanted), None
    )
    if by_title is None and re.fullmatch(r"\d+", wanted):
        by_title = next(
            (head.place for head in heads if head.place == int(wanted) - 1), None
        )
    return by_title, unit, log


def _si(column: Column, table: TitledTable) -> np.ndarray | None:
    """The numbers of a column in SI, None where its unit is not known."""
    unit = column.unit_by(table.units)
    return (
        column.of(table, unit)
        if unit and column.known and column.log != "log"
        else None
    )


def _differ(one: np.ndarray, other: np.ndarray, kind: str) -> bool:
    """Whether two columns contradict each other: by 3 K, by 2 % in frequency or time,
    by 5 % else, in the median.
    """
    known = np.isfinite(one) & np.isfinite(other) & (one > 0) & (other > 0)
    if not known.any():
        return False
    if kind == "temperature":
        return bool(np.median(np.abs(one - other)[known]) > 3)
    apart = np.median(np.abs(np.log(one[known] / other[known])))
    return bool(
        apart > (0.02 if kind in ("frequency", "angular frequency", "time") else 0.05)
    )


def _rank(quantity: ColumnKind, name: str) -> int | None:
    """The rank of a name, also of one that is said twice, in words and as a symbol:
    "Storage modulus (E')".
    """
    known_rank = quantity.rank(name)
    if known_rank is not None or len(name) > 80:
        return known_rank
    for gap in re.finditer(r"[\s(,:-]+", name):
        ranks = [
            quantity.rank(piece)
            for piece in (name[: gap.start()].strip(), name[gap.end() :].strip(" )"))
        ]
        if None not in ranks:
            return min(rank for rank in ranks if rank is not None)
    return None


def _letter(quantity: ColumnKind, name: str) -> str:
    """ "G" or "E", where the name of a modulus says which it is."""
    if quantity.kind == "viscosity":
        return "G"
    if quantity.kind == "compliance" and re.match(r"\|?D[*'(_12]", name):
        return "E"
    if quantity.kind not in ("modulus", "compliance", "strain"):
        return ""
    if re.match(r"((storage|loss)[ _])?shear", name, re.IGNORECASE):
        return "G"
    if re.match(r"((storage|loss)[ _])?(tensile|young)", name, re.IGNORECASE):
        return "E"
    behind = (
        r"[_'*12(]|pp?\b|[ ]?(?:abs|stor|loss|relax|(?:d|double[_ -]?)?prime)"
        r"|-(?:stor|loss)|\*?\)"
    )
    match = re.search(rf"(?<![a-z])([ge])(?={behind})", name, re.IGNORECASE)
    match = (
        match
        or re.match(r"\|?([GE])(?=[tT]?\b)", name)
        or re.search(r"modulus ([GE])$", name, re.IGNORECASE)
    )
    return match[1].upper() if match else ""


NUMBERS = "a table with rows of numbers"


def missing(recognised: Sequence[str], table: TitledTable) -> str:
    """What was found in a table, in words, and how to name what was not."""
    blanks = ""
    if table.width and not any(head.title for head in table.heads):
        blanks = (
            f"no line above the numbers can be cut at blanks into {table.width} "
            "titles: separate them by commas; "
        )
    known = ", ".join(recognised) or "none"
    return (
        f"{blanks}recognised is {known} of the columns {listed(table.heads)}; name the "
        "others by title or number, as "
        + advise("columns={'ROLE': N}", {"column": "ROLE=N"})
        + ", with 'N [UNIT]' where the title has no unit; a number for all rows is "
        "given as '10 Hz'"
    )
