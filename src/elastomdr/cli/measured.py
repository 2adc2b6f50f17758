"""Measured friction from a CSV file, to be drawn over a computed curve."""

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError

if TYPE_CHECKING:
    from ..fit.reading.friction_file import MeasuredFriction


def read_measured(path: Path) -> "MeasuredFriction":
    """The points of `em.fit.read_friction`; what it left out is said with the result. Raises `InputError`."""
    from ..fit.data import FitWarning
    from ..fit.reading.friction_file import read_friction

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", FitWarning)
            return read_friction(path)
    except InputError as error:
        raise InputError(f"measured: {error}") from error
