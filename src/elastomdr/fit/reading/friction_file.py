"""Reading measured friction: a table of velocity, friction coefficient and, where known, temperature and pressure."""

import os
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from ..._runtime import plain, positive
from ...errors import InputError, closest
from ..data import FitWarning
from .columns import checked_unit, convert, spelled
from .friction_columns import EXAMPLES, NAMES, checked_velocity, is_unit, known, per_second, role_of, with_units
from .logarithms import LOGS, logarithm
from .plausible import TEMPERATURES, kelvins_as_celsius
from .table import Table, read_table

_SHOWN = 5  # lines that are named
_LARGEST = 8.0  # mu, in the median, above which it is in percent
_VELOCITIES = (1e-12, 1e3)  # of any experiment [m/s]


@dataclass(frozen=True, eq=False, repr=False)
class MeasuredFriction:
    """Points of measured friction in SI units, one entry per row of the table; None where there is no such column."""

    velocity: Float[np.ndarray, " n"]  # [m/s]
    mu: Float[np.ndarray, " n"]
    temperature: Float[np.ndarray, " n"] | None  # [K]
    pressure: Float[np.ndarray, " n"] | None  # [Pa]
    error: Float[np.ndarray, " n"] | None  # standard deviation of mu
    source: str  # name of the file
    report: tuple[str, ...]  # what was left out, what is assumed, and what looks wrong

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
      `temperature` [K] is that of all points where the file has no such column. Velocities may be logarithms, as
      "log10 v [m/s]" says; mu may be in [%].
    - Tab, semicolon, comma or blank separates; decimal commas; lines that start with # are passed over.

    Rows that are no measurement (an empty cell, no number, a velocity, temperature, pressure or error that is not
    positive, a negative coefficient) are left out, counted and named by their lines in `report` and in one
    `FitWarning`. Raises `InputError` for what cannot be read, for a unit that nobody gives, and where more than half of
    the rows would be left out. Temperatures, velocities and coefficients that no experiment has are said likewise, with
    the unit that was assumed.
    """
    units = {
        "velocity": checked_velocity(velocity_unit),
        "temperature": checked_unit("temperature_unit", temperature_unit, "temperature"),
        "pressure": checked_unit("pressure_unit", pressure_unit, "modulus"),
    }
    name = Path(path).name
    table = with_units(read_table(path, "velocities and friction coefficients", is_unit, ragged=True))
    places = _places(table, columns, name)
    log = logarithm(table.titles[places["velocity"]])[0] if table.titles else ""
    if log:
        with np.errstate(over="ignore"):
            table.data[:, places["velocity"]] = LOGS[log] ** table.data[:, places["velocity"]]
    values = {role: _in_si(table, place, role, units.get(role), name) for role, place in places.items()}
    if "error" in values and "%" in table.units[places["error"]]:
        if "%" in table.units[places["mu"]]:
            raise InputError(
                f"path: {name!r} gives mu and its error in %, which may be percent of mu or of 1: give the error as a "
                "plain number."
            )
        values["error"] = values["error"] / 100 * values["mu"]
    if temperature is not None:
        kelvin = plain("temperature", temperature)
        positive("temperature", kelvin)
        if "temperature" in values:
            raise InputError(f"temperature must be left out: {name!r} has a column for it.")
        values["temperature"] = np.full(values["mu"].shape, kelvin)
    good = np.all([np.isfinite(x) & ((x >= 0) if key == "mu" else (x > 0)) for key, x in values.items()], axis=0)
    kept = {role: x[good] for role, x in values.items()}
    report = (*_left_out(table, good, name), *_implausible(kept, table, places, units["temperature"], log))
    for text in report:
        warnings.warn(f"{name}: {text}", FitWarning, stacklevel=2)
    return MeasuredFriction(
        kept["velocity"], kept["mu"], kept.get("temperature"), kept.get("pressure"), kept.get("error"), name, report
    )


def _places(table: Table, columns: Any, name: str) -> dict[str, int]:
    """The column of each quantity, from its title or from the user."""
    if not (columns is None or isinstance(columns, Mapping)):
        raise InputError(f"columns must be a dict such as {{'mu': 'COF 2'}}, got {columns!r}.")
    listed = ", ".join(f"{i}: {title}" for i, title in enumerate(table.titles, start=1)) or "no titles"
    roles = [role_of(title) for title in table.titles]
    if "velocity" not in roles:  # of which alone people write logarithms
        behind = [role_of(logarithm(title)[1]) for title in table.titles]
        roles = [one or (other if other == "velocity" else "") for one, other in zip(roles, behind, strict=True)]
    places: dict[str, int] = {}
    for role in NAMES:
        found = [i for i, named in enumerate(roles) if named == role]
        if len(found) > 1 and role not in (columns or {}):
            raise InputError(f"path: {name!r} has more than one column for {role} ({listed}); say which in columns.")
        if found:
            places[role] = found[0]
    for role, wanted in (columns or {}).items():
        if role not in NAMES:
            raise InputError(f"columns must name {', '.join(NAMES)}, got {role!r}.{closest(str(role), NAMES)}")
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
        if said not in ("", "-", "1", "%"):
            raise InputError(f"path: {name!r} gives {role} in {said!r}, which must be a plain number, or in %.")
        return values / 100 if said == "%" and role == "mu" else values
    if said and not known(said, role):
        raise InputError(f"path: {name!r} gives {role} in {said!r}, which is no unit of it, as {EXAMPLES[role]}.")
    given = known(said, role)
    if given and user and given != user:
        raise InputError(f"{role}_unit is {user!r}, but {name!r} says {said!r}.")
    unit = given or user
    if not unit:
        raise InputError(
            f"path: {name!r} has a {role} without a unit; write it into the title, as "
            f'"{role} [{EXAMPLES[role]}]", or give {role}_unit.'
        )
    if role == "velocity":
        return values * per_second(unit)
    return np.array(convert(values.tolist(), "temperature" if role == "temperature" else "storage", unit))


def _left_out(table: Table, good: np.ndarray, name: str) -> tuple[str, ...]:
    out = [line for line, kept in zip(table.lines, good, strict=True) if not kept]
    if not out:
        return ()
    shown = ", ".join(map(str, out[:_SHOWN])) + (", ..." if len(out) > _SHOWN else "")
    text = f"{len(out)} of {good.size} rows are no measurement and were left out (line {shown})"
    if 2 * len(out) > good.size:
        raise InputError(f"path: {name!r}: {text}: more than half. Velocity and mu must be positive numbers.")
    return (text,)


def _implausible(
    values: dict[str, np.ndarray], table: Table, places: dict[str, int], user: str | None, log: str
) -> Iterator[str]:
    """Warnings on numbers that no experiment has, and what was assumed."""
    if log == "log":
        yield (
            f"{table.titles[places['velocity']]!r} is taken as a decadic logarithm (log10); write ln in the title "
            "where it is a natural one"
        )
    if not values["mu"].size:
        return
    if (middle := float(np.median(values["mu"]))) > _LARGEST:
        yield (
            f"mu of {middle:.3g} in the median is implausible; assumed is a plain number. Write mu [%] in the title if "
            "it is in percent"
        )
    low, high = float(values["velocity"].min()), float(values["velocity"].max())
    if low < _VELOCITIES[0] or high > _VELOCITIES[1]:
        said = table.units[places["velocity"]].strip() or "the unit that was given"
        yield f"velocities from {low:.3g} to {high:.3g} m/s are implausible; assumed is {said}. Check the unit"
    if "temperature" in places:
        kelvin = values["temperature"]
        unit = known(table.units[places["temperature"]].strip(), "temperature") or user
        kelvins = kelvins_as_celsius(kelvin - 273.15, melt=False) if unit == "degc" else ""
        if kelvin.min() < TEMPERATURES[0] or kelvin.max() > TEMPERATURES[1] or kelvins:
            yield (
                f"temperatures from {kelvin.min():.4g} to {kelvin.max():.4g} K are implausible{kelvins}; assumed is "
                f"{spelled(unit or '')}. Check whether they are in degC or K"
            )
