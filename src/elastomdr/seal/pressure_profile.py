"""The pressure of a dry seal along the flow, as given or in a file."""

from __future__ import annotations

import os
import re
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ..call.extrapolation import doubt_units
from ..checks import Array, as_float64, require
from ..errors import InputError
from ..files import read_text

if TYPE_CHECKING:
    from .._types import ArrayLike

Profile: TypeAlias = "tuple[ArrayLike, ArrayLike] | str | os.PathLike[str]"

_LENGTHS = {"m": 1.0, "mm": 1e-3, "µm": 1e-6, "um": 1e-6}
_PRESSURES = {"Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "bar": 1e5}
_MOST_BYTES = 10_000_000  # of a file of a profile


def read_along(x: ArrayLike, places: Array, values: Array) -> Array:
    """Values at x (any shape) between places (..., n) that ascend, those of the ends
    beyond them; (..., *shape of x).
    """
    x = as_float64("x", x)
    every = zip(
        *(each.reshape(-1, each.shape[-1]) for each in (places, values)), strict=True
    )
    read = np.array([np.interp(x, *one) for one in every])
    return read.reshape((*places.shape[:-1], *x.shape))


def pressure_profile(profile: Profile | None, fewest: int) -> tuple[Array, Array]:
    """Positions [m] and pressures [Pa], of a pair or a file, `fewest` of them or more.
    Raises `InputError`.
    """
    if isinstance(profile, (str, os.PathLike)):
        profile = _read(Path(profile))
    if not isinstance(profile, (tuple, list)) or len(profile) != 2:
        raise InputError(
            argument="profile",
            got=profile,
            accepted="a pair, positions [m] and pressures [Pa], or a file",
        )
    x, p = (as_float64("profile", each) for each in profile)
    for each in (x, p):
        require("profile", each, "finite numbers", np.isfinite)
    if x.ndim != 1 or x.shape != p.shape or x.size < fewest:
        raise InputError(
            argument="profile",
            got=profile,
            accepted=f"of {fewest} positions or more and as many pressures",
            hint=f"they have the shapes {x.shape} and {p.shape}",
        )
    if not (np.diff(x) > 0).all():
        raise InputError(
            argument="profile",
            got=x,
            accepted="of ascending positions, from the side of the fluid to that of "
            "the air",
        )
    doubt_units(x, p)
    return x, p


def _read(path: Path) -> tuple[Array, Array]:
    """A file of two columns with units in its title line. Raises `InputError`."""
    try:
        lines = read_text(path, _MOST_BYTES).splitlines()
    except (OSError, ValueError) as error:
        raise InputError(
            argument="profile", got=path, accepted="a text file", hint=str(error)
        ) from None
    title, *lines = [line for line in lines if line.strip()] or [""]
    units = re.findall(r"\[([^\[\]]*)\]", title)
    if len(units) != 2 or units[0] not in _LENGTHS or units[1] not in _PRESSURES:
        raise InputError(
            argument="profile",
            got=path,
            accepted="a file that begins with a title line such as 'position [mm], "
            "pressure [MPa]'",
            hint=f"it begins with {title[:200]!r}",
        )
    separator = next((mark for mark in ";\t" if mark in title), ",")
    if separator != ",":  # a comma is then one of decimals
        lines = [line.replace(",", ".") for line in lines]
    try:
        numbers = np.loadtxt(lines or ["nan"], delimiter=separator, ndmin=2)
    except ValueError as error:
        accepted = "a file of numbers below its title line"
        raise InputError(
            argument="profile", got=path, accepted=accepted, hint=str(error)
        ) from None
    if numbers.shape[1] != 2:
        accepted = "a file of two columns"
        raise InputError(argument="profile", got=path, accepted=accepted)
    return numbers[:, 0] * _LENGTHS[units[0]], numbers[:, 1] * _PRESSURES[units[1]]
