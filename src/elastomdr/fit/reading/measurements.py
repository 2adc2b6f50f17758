"""The rows below a header become numbers in SI; what is no measurement is left out and named."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ...errors import InputError
from ..data import Dma
from .cells import Row, number
from .columns import MODULI, UNITS, Column, convert, is_complete, measure, per_second, spelled, unclear
from .duplicates import contradictions, preference, taken
from .logarithms import antilogarithm
from .misread import misread, moduli, moduli_roles
from .plausible import implausible, inconsistent, is_elastic, mixed_up
from .swapped import swapped
from .temperatures import Above, overruled
from .unsaid_logarithms import unsaid_logarithms

_QUARTER = np.pi / 2 * (1 - 1e-9)  # phase angle of a liquid without elasticity, whose storage modulus is 0 [rad]
_NAMED = 6  # bad rows that a warning names one by one


class Options(NamedTuple):
    kind: str | None
    units: dict[str, str | None]  # by measure
    temperature: float | None
    columns: dict[str, Any]


class Block(NamedTuple):
    """A header and the rows below it."""

    columns: list[Column]
    rows: list[Row]
    titles: list[str]  # of all columns
    above: tuple[Above, ...] = ()  # temperatures in the line above
    width: int = 0  # cells of its rows, where it is cut at blanks and a cell that is not there moves the others
    part: tuple[int, int] = (0, 1)  # which of how many blocks, side by side

    @property
    def told(self) -> float | None:
        """The temperature that a line above gives to all points [K]; None where there is a column, or no such line."""
        column = any(column.role == "temperature" for column in self.columns)
        return self.above[0].kelvin if len(self.above) == 1 and not column else None


def measurements(path: Path, block: Block, options: Options, units: dict[str, str]) -> Dma:
    """A block's points in SI; `units` are those that the format fixes."""
    chosen = _chosen(block.columns, block.rows, options)
    dynamic = "storage" in chosen or "absolute" in chosen
    if dynamic:
        chosen.pop("time", None)
        rate = "omega" if "omega" in chosen else "frequency"
        needed = [rate, *moduli_roles(chosen)]
    else:
        needed = ["time", "relaxation"]
    if "temperature" in chosen:
        needed.append("temperature")
    given = {role: _unit(chosen[role], options, units) for role in needed}
    checks = [role for role in ("frequency", *MODULI) if dynamic and role in chosen and role not in needed]
    known = {role: _known_unit(chosen[role], options, units) for role in checks}
    given |= {role: unit for role, unit in known.items() if unit is not None}
    checks = [role for role in checks if role in given]
    values, kept, bad = _numbers(block, chosen, given, needed, checks)
    if not values[needed[0]]:
        raise InputError(
            f"no row below the header {chosen[needed[0]].title!r} is a measurement ({'; '.join(bad[:2])})."
        )
    arrays = {role: np.array(convert(values[role], role, given[role])) for role in needed}
    extra = {role: np.array(convert(values[role], role, given[role])) for role in checks}
    kind = _kind(chosen, options)
    titles = {role: chosen[role].title for role in needed}
    none = np.zeros(0)
    storage, loss = moduli(arrays) if dynamic else (none, none)
    elastic = is_elastic(storage, loss, arrays.get("relaxation", none))
    texts = [*inconsistent(arrays.get("omega"), storage, loss, extra, chosen)]
    texts += contradictions(arrays, chosen, _others(block, chosen, needed, kept, options, units))
    texts += implausible(arrays, titles, given, modulus_given(options), elastic)
    doubts: list[str] = []
    if dynamic:
        one, other = (chosen[role] for role in moduli_roles(arrays))
        if {"storage", "loss"} <= arrays.keys():
            doubts += [*unsaid_logarithms(arrays, values, chosen)] or swapped(arrays, one, other, given)
        else:
            doubts += misread(arrays, chosen, given)
        doubts = doubts or [*mixed_up(storage, loss, [one, other], given)]
    texts += [*doubts, *_assumed([chosen[role] for role in needed]), *overruled(block.told, options.temperature)]
    if bad:
        more = f" and {len(bad) - _NAMED} more, all of them in bad_rows and in the master curve's table"
        more = more if len(bad) > _NAMED else ""
        texts.append(f"{path.name}: {len(bad)} row{'s' * (len(bad) > 1)} left out: {'; '.join(bad[:_NAMED])}{more}.")
    n = len(values[needed[0]])
    temperature = arrays.get("temperature")
    if temperature is None:
        kelvin = block.told if options.temperature is None else options.temperature
        temperature = np.full(n, np.nan if kelvin is None else kelvin)
    common: dict[str, Any] = {
        "kind": kind,
        "units": {role: _said(chosen[role].log, given[role]) for role in needed},
        "warnings": tuple(texts),
        "bad_rows": tuple(bad),
        "doubtful": bool(doubts),
        "source": path.name,
        "columns": taken(
            block.titles, [chosen[role] for role in needed], _temperature_from(block, options), block.part
        ),
    }
    if not dynamic:
        return Dma(none, none, none, none, time=arrays["time"], relaxation=arrays["relaxation"],
                   time_temperature=temperature, **common)  # fmt: skip
    return Dma(temperature, arrays[needed[0]], storage, loss, **common)


def _chosen(columns: list[Column], rows: list[Row], options: Options) -> dict[str, Column]:
    """One column per role: of several, the first whose unit is known and that is no logarithm; of temperatures, that
    of the sample, if it has as many numbers as the others.

    Raises `InputError` for moduli of two kinds.
    """
    letters = {column.letter for column in columns if measure(column.role) == "modulus"} - {""}
    if len(letters) > 1:
        if options.kind is None:
            raise InputError("the file has moduli of shear and of tension: give kind='shear' or 'tensile' (--kind).")
        wanted = "G" if options.kind == "shear" else "E"
        columns = [column for column in columns if column.letter in ("", wanted)]
        if not is_complete(columns):
            raise InputError(f"the file has no storage and loss modulus of {options.kind}, only one of both.")
    chosen: dict[str, Column] = {}

    def holes(column: Column) -> int:
        return sum(number(cell) is None for row in rows for cell in row.cells[column.place : column.place + 1])

    fewest = min((holes(column) for column in columns if column.role == "temperature"), default=0)

    def order(column: Column) -> tuple[bool, bool, int, bool]:
        holed = column.role == "temperature" and holes(column) > fewest
        return bool(column.said), holed, preference(column), bool(column.log)

    for column in sorted(columns, key=order):
        chosen.setdefault(column.role, column)
    return chosen


def modulus_given(options: Options) -> bool:
    """Whether the user, not the file, said what the moduli are in."""
    return options.units["modulus"] is not None


def _others(
    block: Block, chosen: dict[str, Column], needed: list[str], rows: list[Row], options: Options, units: dict[str, str]
) -> Iterator[tuple[Column, np.ndarray]]:
    """Further columns of what is read, whose unit somebody says, with their numbers in SI, NaN where there are none."""
    for column in block.columns:
        kind = measure(column.role)
        if column.role not in needed or column is chosen[column.role] or column.said:
            continue
        if column.letter and chosen[column.role].letter not in ("", column.letter):
            continue  # a modulus of the other kind
        unit = column.unit or units.get(column.role) or options.units.get(kind)
        if unit or kind == "ratio":
            cells = (row.cells[column.place] if column.place < len(row.cells) else "" for row in rows)
            values = [np.nan if (value := _value(cell, column)) is None else value for cell in cells]
            yield column, np.array(convert(values, column.role, unit or ""))


def _temperature_from(block: Block, options: Options) -> str:
    """Where the temperature of points comes from that have no column of it."""
    if options.temperature is not None:
        return f"temperature {options.temperature - 273.15:g} degC, as given"
    return "temperature not known" if block.told is None else "temperature from the line above"


def _numbers(
    block: Block, chosen: dict[str, Column], given: dict[str, str], needed: list[str], checks: list[str]
) -> tuple[dict[str, list[float]], list[Row], list[str]]:
    """The numbers of good rows, by role, these rows, and what is wrong with each of the others."""
    values: dict[str, list[float]] = {role: [] for role in (*needed, *checks)}
    kept, bad = [], []
    at = f", block {block.part[0] + 1}" if block.part[1] > 1 else ""
    for row in block.rows:
        found, wrong = {}, ""
        if block.width and len(row.cells) != block.width and _moved(row, block.width):
            bad.append(f"line {row.line}{at}: it has {len(row.cells)} cells, the header {block.width} titles")
            continue
        for role in needed:
            column = chosen[role]
            cell = row.cells[column.place] if column.place < len(row.cells) else ""
            value = _value(cell, column)
            if value is None:
                wrong = f"{column.title} is {cell[:20]!r}, no {'logarithm of a ' * bool(column.log)}number"
            elif role not in ("temperature", "phase") and value <= 0:
                wrong = f"{column.title} is {value:g} {spelled(given[role])}, not positive"
            elif role == "temperature" and convert([value], role, given[role])[0] <= 0:
                wrong = f"{column.title} is {value:g} {spelled(given[role])}, not above absolute zero"
            elif role == "phase" and not 0 < convert([value], role, given[role])[0] < _QUARTER:
                asked = " (is it in deg?)" if given[role] == "rad" else ""
                wrong = f"{column.title} is {value:g} {given[role]}, not between 0 and 90 deg{asked}"
            if wrong:
                break
            found[role] = value
        if wrong:
            bad.append(f"line {row.line}{at}: {wrong}")
            continue
        kept.append(row)
        for role in checks:
            column = chosen[role]
            extra = _value(row.cells[column.place], column) if column.place < len(row.cells) else None
            found[role] = np.nan if extra is None else extra
        for role, value in found.items():
            values[role].append(value)
    return values, kept, bad


def _moved(row: Row, width: int) -> bool:
    """Whether a row that is cut at blanks has lost cells, or has more numbers than there are columns."""
    return len(row.cells) < width or any(number(cell) is not None for cell in row.cells[width:])


def _assumed(columns: list[Column]) -> Iterator[str]:
    """A warning on titles whose logarithm has no base."""
    titles = ", ".join(repr(column.title) for column in columns if column.log == "log")
    if titles:
        yield f"{titles}: assumed are decadic logarithms (log10); write ln in the title where they are natural ones."


def _said(log: str, unit: str) -> str:
    """How a column is written, in words: "MPa", or "log10 of MPa"."""
    words = ["ln" if log == "ln" else "log10"] if log else []
    return " of ".join([*words, spelled(unit)] if unit or not log else words)


def _value(cell: str, column: Column) -> float | None:
    """The number that a cell stands for, None where it stands for none."""
    value = number(cell)
    if value is None or not np.isfinite(value):
        return None
    return antilogarithm(value, column.log) if column.log else value


def _unit(column: Column, options: Options, fixed: dict[str, str]) -> str:
    """The unit of a column: the file's own, that of the format, or the user's."""
    kind = measure(column.role)
    if column.role == "omega" and per_second(column.said):
        return "rad/s"  # the radian is 1, and the title says that the frequency is an angular one
    if kind == "ratio":
        return column.unit
    if column.said and not unclear(column.said):
        known = ", ".join(spelled(unit) for unit in UNITS[kind])
        raise InputError(f"the unit of {column.title!r} is {column.said!r}, which is none of {known}: write it as one.")
    unit = column.unit or fixed.get(column.role) or options.units.get(kind)
    if unit and unit not in UNITS[kind]:  # of a column that the user named
        raise InputError(
            f"column {column.place + 1} {column.title!r}, named for {column.role}, is in {spelled(unit)}, which is "
            f"none of {', '.join(map(spelled, UNITS[kind]))}."
        )
    if unit:
        return unit
    option = {"frequency": "frequency_unit", "modulus": "modulus_unit", "temperature": "temperature_unit",
              "time": "time_unit", "angle": ""}[kind]  # fmt: skip
    if kind == "angle":
        raise InputError(
            f"the unit of {column.title!r} is not in the file: name it in the title, as '{column.title} [deg]'."
        )
    missing = f"may be several ({column.said})" if column.said else "is not in the file"
    example = {"frequency": "Hz", "modulus": "MPa", "temperature": "degC", "time": "s"}[kind]
    example = "rad/s" if column.role == "omega" else example
    raise InputError(
        f"the unit of {column.title!r} {missing}; give it, as {option}={example!r} "
        f"(--{option.replace('_', '-')} {example})."
    )


def _known_unit(column: Column, options: Options, fixed: dict[str, str]) -> str | None:
    """The unit of a column that is only compared with others; None where nobody says it."""
    kind = measure(column.role)
    if kind == "ratio" or column.unit:
        return column.unit if column.unit in UNITS[kind] else None
    return fixed.get(column.role) or options.units[kind] if kind == "modulus" and not column.said else None


def _kind(chosen: dict[str, Column], options: Options) -> str:
    letters = {chosen[r].letter for r in ("storage", "loss", "absolute", "relaxation") if r in chosen} - {""}
    if "torque" in chosen:
        letters.add("G")  # torque means torsion, and torsion is shear
    if len(letters) > 1:
        raise InputError(
            f"moduli must be all of shear or all of tension, got columns of {' and '.join(sorted(letters))}."
        )
    found = {"G": "shear", "E": "tensile"}.get("".join(letters))
    if found and options.kind and found != options.kind:
        raise InputError(f"kind must be {found!r}, as the file's columns say, got {options.kind!r}.")
    kind = found or options.kind
    if kind is None:
        raise InputError(
            "whether the moduli are of shear or tension is not in the file; give it, as kind='shear' or 'tensile' "
            "(--kind shear or --kind tensile)."
        )
    return kind
