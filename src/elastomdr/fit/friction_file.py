"""Reading measured friction: a table of velocity, friction coefficient and, where known, temperature and pressure."""

import os
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .._runtime import plain, positive
from ..errors import InputError, closest
from .columns import checked_unit, convert, known_unit
from .data import FitWarning
from .table import METRES, Table, read_table

_NAMES = {
    "velocity": r"v|velocity|speed|sliding (velocity|speed)|geschwindigkeit|gleitgeschwindigkeit",
    "mu": r"mu|µ|μ|cof|friction|(friction|frictional) coefficient|coefficient of friction|reib(wert|ungszahl)|"
    r"reibungskoeffizient",
    "temperature": r"t|temp\.?|temperature|temperatur",
    "pressure": r"p|(nominal |contact |mean )?pressure|druck|flächenpressung",
    "error": r"error|std|sigma|standard deviation|(error|std|standard deviation) of (mu|friction)|mu (error|std)",
}
_SECONDS = {"s": 1.0, "sec": 1.0, "min": 60.0, "h": 3600.0}
_VELOCITY = re.compile(r"(m|cm|mm|um|nm|km)(?:/(s|sec|min|h)|[ *.]?(s|min|h)\^?-1)")
_SPELLED = str.maketrans({"µ": "u", "μ": "u", "⁻": "-", "¹": "1", "·": "*", "\u2212": "-"})
_EXAMPLES = {"velocity": "mm/s", "temperature": "degC", "pressure": "MPa"}
_SHOWN = 5  # lines that are named


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredFriction:
    """Points of measured friction in SI units, one entry per row of the table; None where there is no such column."""

    velocity: Float[np.ndarray, " n"]  # [m/s]
    mu: Float[np.ndarray, " n"]
    temperature: Float[np.ndarray, " n"] | None  # [K]
    pressure: Float[np.ndarray, " n"] | None  # [Pa]
    error: Float[np.ndarray, " n"] | None  # standard deviation of mu
    source: str  # name of the file
    report: tuple[str, ...]  # what was left out

    @property
    def points(self) -> dict[str, np.ndarray]:
        """The points as `curve.plot(measured=...)` takes them."""
        found = {"velocity": self.velocity, "mu": self.mu, "temperature": self.temperature}
        return {name: values for name, values in found.items() if values is not None}

    def __repr__(self) -> str:
        spans = [("velocity", self.velocity, "m/s"), ("temperature", self.temperature, "K"),
                 ("pressure", self.pressure, "Pa"), ("mu", self.mu, "")]  # fmt: skip
        parts = [f"{name} {x.min():.4g} to {x.max():.4g} {unit}".rstrip() for name, x, unit in spans if x is not None]
        return "\n".join([f"MeasuredFriction({self.mu.size} points of {self.source!r}: {', '.join(parts)})",
                          *self.report])  # fmt: skip


def read_friction(
    path: str | os.PathLike[str],
    *,
    velocity_unit: str | None = None,
    temperature_unit: str | None = None,
    pressure_unit: str | None = None,
    temperature: Any = None,
    columns: Mapping[str, str | int] | None = None,
) -> MeasuredFriction:
    """Measured friction from a text file, one row per point; titles as "velocity [mm/s],temperature [degC],mu".

    - Columns: velocity and mu; temperature, nominal pressure and error (standard deviation of mu, or [%] of it) where
      there are any, in any order and under their usual names; others are passed over. `columns` names those that are
      not recognised, as {"mu": "COF 2"} or by number from 1.
    - Velocities in m/s, mm/s, um/s, km/h, m/min ...; temperatures in degC, K, degF; pressures in Pa, kPa, MPa, bar ...
      `velocity_unit`, `temperature_unit`, `pressure_unit` fill in what the titles leave out and never overrule them.
      `temperature` [K] is that of all points where the file has no such column.
    - Tab, semicolon, comma or blank separates; decimal commas; lines that start with # are passed over.

    Rows that are no measurement (an empty cell, no number, a velocity, temperature, pressure or error that is not
    positive, a negative coefficient) are left out, counted and named by their lines in `report` and in one
    `FitWarning`. Raises `InputError` for what cannot be read, for a unit that nobody gives, and where more than half of
    the rows would be left out.
    """
    units = {
        "velocity": _checked_velocity(velocity_unit),
        "temperature": checked_unit("temperature_unit", temperature_unit, "temperature"),
        "pressure": checked_unit("pressure_unit", pressure_unit, "modulus"),
    }
    name = Path(path).name
    table = read_table(path, "velocities and friction coefficients", _is_unit)
    places = _places(table, columns, name)
    values = {role: _in_si(table, place, role, units.get(role), name) for role, place in places.items()}
    if "error" in values and "%" in table.units[places["error"]]:
        values["error"] = values["error"] / 100 * values["mu"]
    if temperature is not None:
        kelvin = plain("temperature", temperature)
        positive("temperature", kelvin)
        if "temperature" in values:
            raise InputError(f"temperature must be left out: {name!r} has a column for it.")
        values["temperature"] = np.full(values["mu"].shape, kelvin)
    good = np.all([np.isfinite(x) & ((x >= 0) if key == "mu" else (x > 0)) for key, x in values.items()], axis=0)
    report = _left_out(table, good, name)
    for text in report:
        warnings.warn(f"{name}: {text}", FitWarning, stacklevel=2)
    kept = {role: x[good] for role, x in values.items()}
    return MeasuredFriction(
        kept["velocity"], kept["mu"], kept.get("temperature"), kept.get("pressure"), kept.get("error"), name, report
    )


def _places(table: Table, columns: Any, name: str) -> dict[str, int]:
    """The column of each quantity, from its title or from the user."""
    if not (columns is None or isinstance(columns, Mapping)):
        raise InputError(f"columns must be a dict such as {{'mu': 'COF 2'}}, got {columns!r}.")
    listed = ", ".join(f"{i}: {title}" for i, title in enumerate(table.titles, start=1)) or "no titles"
    bare = [re.sub(r"[_\s]+", " ", title.strip().lower()) for title in table.titles]
    places: dict[str, int] = {}
    for role, pattern in _NAMES.items():
        found = [i for i, title in enumerate(bare) if re.fullmatch(pattern, title)]
        if len(found) > 1 and role not in (columns or {}):
            raise InputError(f"path: {name!r} has more than one column for {role} ({listed}); say which in columns.")
        if found:
            places[role] = found[0]
    for role, wanted in (columns or {}).items():
        if role not in _NAMES:
            raise InputError(f"columns must name {', '.join(_NAMES)}, got {role!r}.{closest(str(role), _NAMES)}")
        titles = [title.strip() for title in table.titles]
        place = wanted - 1 if type(wanted) is int else titles.index(wanted) if wanted in titles else -1
        if not 0 <= place < len(table.units):
            raise InputError(f"columns: {name!r} has no column {wanted!r} for {role} ({listed}).")
        places = {key: at for key, at in places.items() if at != place} | {role: place}
    for role in ("velocity", "mu"):
        if role not in places:
            raise InputError(
                f'path: {name!r} must have the columns "velocity [m/s]" and "mu", and has no {role} ({listed}); '
                f"name it, as columns={{{role!r}: 1}}."
            )
    return places


def _in_si(table: Table, place: int, role: str, user: str | None, name: str) -> np.ndarray:
    """The values of a column; its unit from its title, or else from the user, who does not overrule it."""
    said, values = table.units[place].strip(), table.data[:, place]
    if role in ("mu", "error"):
        if said not in ("", "-", "1") and not (role == "error" and said == "%"):
            raise InputError(f"path: {name!r} gives {role} in {said!r}, which must be a plain number.")
        return values
    if said and not _known(said, role):
        raise InputError(f"path: {name!r} gives {role} in {said!r}, which is no unit of it, as {_EXAMPLES[role]}.")
    given = _known(said, role)
    if given and user and given != user:
        raise InputError(f"{role}_unit is {user!r}, but {name!r} says {said!r}.")
    unit = given or user
    if not unit:
        raise InputError(
            f"path: {name!r} has a {role} without a unit; write it into the title, as "
            f'"{role} [{_EXAMPLES[role]}]", or give {role}_unit.'
        )
    if role == "velocity":
        return values * _per_second(unit)
    return np.array(convert(values.tolist(), "temperature" if role == "temperature" else "storage", unit))


def _known(text: str, role: str) -> str:
    """A unit as it is compared, or an empty string where it is none of its kind."""
    if role == "velocity":
        bare = re.sub(r"\s+", "", text.translate(_SPELLED))
        return bare if _VELOCITY.fullmatch(bare) else ""
    unit = known_unit(text)
    kind = "temperature" if role == "temperature" else "modulus"
    try:
        return checked_unit(role, unit, kind) or "" if unit else ""
    except InputError:
        return ""


def _is_unit(text: str) -> bool:
    return text.strip() in ("", "-", "1", "%") or any(_known(text, role) for role in _EXAMPLES)


def _per_second(unit: str) -> float:
    match = _VELOCITY.fullmatch(unit)
    assert match is not None
    return (METRES | {"km": 1e3})[match[1]] / _SECONDS[match[2] or match[3]]


def _checked_velocity(text: str | None) -> str | None:
    if text is not None and not (isinstance(text, str) and _known(text, "velocity")):
        raise InputError(f"velocity_unit must be a unit such as m/s, mm/s, um/s, km/h, got {text!r}.")
    return None if text is None else _known(text, "velocity")


def _left_out(table: Table, good: np.ndarray, name: str) -> tuple[str, ...]:
    out = [line for line, kept in zip(table.lines, good, strict=True) if not kept]
    if not out:
        return ()
    shown = ", ".join(map(str, out[:_SHOWN])) + (", ..." if len(out) > _SHOWN else "")
    text = f"{len(out)} of {good.size} rows are no measurement and were left out (line {shown})"
    if 2 * len(out) > good.size:
        raise InputError(f"path: {name!r}: {text}: more than half. Velocity and mu must be positive numbers.")
    return (text,)
