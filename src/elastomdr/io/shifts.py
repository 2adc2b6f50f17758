"""`em.read_shifts`: lists of shift factors, as instruments' programs write them beside
a master curve.
"""

import os

import numpy as np

from ..checks import in_si
from ..errors import InputError
from ..material.shift import ShiftTable
from .columns import Quantity, read_columns
from .dma import checked_units

QUANTITIES = (
    Quantity(
        "temperature",
        "temperature",
        (r"t|temp\.?|temperature|temperatur",),
        option="temperature_unit",
        limits=(100.0, 800.0),
    ),
    Quantity("shift", "ratio", (r"a_?t?|shift ?factors?|verschiebungsfaktor(en)?",)),
)


@in_si
def read_shifts(
    path: str | os.PathLike[str],
    *,
    columns: dict[str, str | int] | None = None,
    temperature_unit: str | None = None,
) -> ShiftTable:
    """A shift law from a list of temperatures and shift factors, such as "T
    [degC],log_aT".

    Args:
        path: a text file or a spreadsheet; factors as a_T, or their logarithms as
            "log10 a_T", "log aT" or "ln aT".
        columns: columns by quantity (temperature, shift), as in `em.read_dma`.
        temperature_unit: unit of the temperatures, where the file has none.

    Returns:
        The list as a law; between its temperatures it is interpolated.

    Raises:
        InputError: for what cannot be read, and units that nobody gives.
    """
    units = checked_units(temperature=temperature_unit)
    found = read_columns(
        path, QUANTITIES, ("temperature", "shift"), columns, units, log="log10"
    )  # nobody's log a_T is ln
    name, _, values, bad, _ = found
    if bad:
        raise InputError(f"{name}: {'; '.join(bad[:3])}.")
    order = np.argsort(values["temperature"])
    return ShiftTable(values["temperature"][order], np.log10(values["shift"][order]))
