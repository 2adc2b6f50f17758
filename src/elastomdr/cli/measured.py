"""Measured friction from a CSV file, to be drawn over a computed curve."""

import csv
from pathlib import Path
from typing import Any

from ..errors import InputError
from .units import TEMPERATURE, VELOCITY, number_in

_COLUMNS = ("velocity", "mu", "temperature")


def read_measured(path: Path) -> dict[str, Any]:
    """Columns velocity, mu and, if there is one, temperature, in SI; titles carry units, "velocity [mm/s],mu".

    Lines that start with # are passed over. Raises `InputError`.
    """
    import numpy as np

    try:
        lines = [line for line in path.read_text().splitlines() if line.strip() and not line.lstrip().startswith("#")]
    except (OSError, ValueError) as error:
        raise InputError(f"measured must be a text file that can be read, got {path.name!r}: {error}.") from error
    rows = [[cell.strip() for cell in row] for row in csv.reader(lines)]
    titles = [title.partition("[") for title in rows[0]] if rows else []
    names = [name.strip() for name, _, _ in titles]
    if not {"velocity", "mu"} <= set(names) <= set(_COLUMNS) or len(set(names)) < len(names):
        raise InputError(
            f'measured: {path.name!r} must have the columns "velocity [m/s]", "mu" and at most "temperature [degC]", '
            f"got {', '.join(rows[0]) if rows else 'nothing'}."
        )
    found: dict[str, Any] = {}
    for place, (name, (_, _, unit)) in enumerate(zip(names, titles, strict=True)):
        kind = {"velocity": VELOCITY, "temperature": TEMPERATURE}.get(name)
        unit = unit.partition("]")[0].strip()
        if kind is not None and not unit:
            raise InputError(f"measured: {path.name!r} has a {name} without a unit, such as [{kind.unit}].")
        try:
            values = [float(row[place]) for row in rows[1:]]
        except (ValueError, IndexError) as error:
            raise InputError(f"measured: {path.name!r} has a {name} that is missing or no number.") from error
        found[name] = np.array(
            values if kind is None else [number_in(f"measured {name}", v, unit, kind) for v in values]
        )
    return found
