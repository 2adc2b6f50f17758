"""Isotherms beside each other in one sheet: the same columns again for each of them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ...errors import InputError
from ..data import Dma, join
from .columns import Column, is_complete, measure
from .measurements import Block, Options

_SHARED = {"time", "torque", "frequency", "omega"}  # that may stand once, before the columns that repeat


def apart(block: Block, options: Options) -> list[Block]:
    """A block for each isotherm where their columns stand side by side, or the block itself.

    Columns repeat where their roles do, one sequence that makes a measurement again and again; titles and units may
    differ. Rows in which an isotherm has no cell are none of its own. The temperature is a column of each, or stands
    above each of them; raises `InputError` where it does neither and the user gives none.
    """
    if options.columns or len({c.letter for c in block.columns if measure(c.role) == "modulus"} - {""}) > 1:
        return [block]  # the user says which, or the kind of modulus has to be chosen first
    found = repeated(block.columns)
    if found is None:
        return [block]
    shared, groups = found
    starts = [min(column.place for column in group) for group in groups]
    told = all(column.role != "temperature" for column in (*shared, *groups[0]))
    temperatures = [block.above] * len(groups)
    if told:
        ends = [*starts[1:], 10**9]
        first = [0, *starts[1:]]
        temperatures = [
            tuple(one for one in block.above if start <= one.place < end)
            for start, end in zip(first, ends, strict=True)
        ]
        if any(len(one) != 1 for one in temperatures):
            if {"frequency", "omega"} & {column.role for column in shared}:
                return [block]  # two samples, or raw and smoothed values
            if options.temperature is None:
                raise InputError(
                    f"the columns {', '.join(repr(column.title) for column in groups[0])} repeat {len(groups)} times, "
                    "side by side, and have no temperature: give each a column of it, or write it above each "
                    "('T = -20 degC')."
                )
            temperatures = [()] * len(groups)
    parts = []
    for i, group in enumerate(groups):
        rows = [row for row in block.rows if any(row.cells[c.place : c.place + 1] not in ([], [""]) for c in group)]
        if rows:
            part = block._replace(columns=[*shared, *group], rows=rows, above=temperatures[i], part=(i, len(groups)))
            parts.append(part)
    return parts


def repeated(columns: Sequence[Column]) -> tuple[list[Column], list[list[Column]]] | None:
    """The columns that stand once, and those of each isotherm; None where nothing repeats."""
    ordered = sorted(columns, key=lambda column: column.place)
    roles = [column.role for column in ordered]
    for once in range(len(roles)):
        if not set(roles[:once]) <= _SHARED:
            return None
        rest = roles[once:]
        for period in range(1, len(rest) // 2 + 1):
            times = len(rest) // period
            group = ordered[once : once + period]
            whole = is_complete([*ordered[:once], *group]) and {*rest[:period]}.isdisjoint(roles[:once])
            if whole and rest == rest[:period] * times:
                return ordered[:once], [ordered[i : i + period] for i in range(once, len(roles), period)]
    return None


def together(parts: Sequence[Dma]) -> Dma:
    """Blocks of one header as one measurement, with a warning where several of them have the same temperatures."""
    found = join(*parts)
    if len(parts) < 2:
        return found
    temperatures = [np.unique(np.concatenate([one.temperature, one.time_temperature]).round()) for one in parts]
    everything = np.concatenate(temperatures)
    everything = everything[np.isfinite(everything)]
    again = np.unique(everything, return_counts=True)[1] > 1
    if not again.any():
        return found
    text = (
        f"{found.source}: {len(parts)} blocks of the same columns stand side by side, and {again.sum()} of their "
        "temperatures are in more than one: read as further points of one material. If they are of several samples, "
        "name the columns of one, as columns={'storage': 3} (--column storage=3), and those of frequency and "
        "temperature."
    )
    return replace(found, warnings=(*found.warnings, text))
