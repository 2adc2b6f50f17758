"""The shift law that a material made from a master curve carries: the given one, or the one that the data follow."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..material.shift import ShiftTable
from .given_law import about

if TYPE_CHECKING:
    from .master import MasterCurve

LAWS = ("auto", "WLF", "Arrhenius", "VFT", "table", "none")
TEMPERATURE_DIGITS = 2  # decimals of a material's range and of its table of shift factors, which have to agree [K]
_DIGITS = 8  # of a law in the material: what follows is rounding, and differs between machines


def check_law(law: Any) -> None:
    """Raises `InputError` unless `law` is one of `LAWS`."""
    if law not in LAWS:
        raise InputError(f"law must be one of {', '.join(LAWS)}, got {law!r}.")


def shift_law(master: "MasterCurve", law: str) -> tuple[str, Any]:
    """The name of a law and the law itself, None for "none"; `law` is one of `LAWS`."""
    if master.joint.law is not None and law == "auto":
        return "given", about(master.joint.law, master.reference, master.measured_at)
    chosen = _choose(master) if law == "auto" else law
    return chosen, None if chosen == "none" else _table(master) if chosen == "table" else _law(master, chosen)


def _choose(master: "MasterCurve") -> str:
    if master.temperature.size < 2:
        return "none"
    if master.temperature.size == 2:
        return "Arrhenius"
    return "WLF" if master.laws["WLF"].holds else "table"


def _law(master: "MasterCurve", name: str) -> Any:
    if name not in master.laws:
        raise InputError(
            f"law must be one that these data allow ({', '.join([*master.laws, 'none'])}), got {name!r}: there are "
            f"{master.temperature.size} temperatures."
        )
    law = master.laws[name].law
    return type(law)(*(rounded(float(getattr(law, field)), _DIGITS) for field in law.__dataclass_fields__))


def _table(master: "MasterCurve") -> ShiftTable:
    """The shift factors as a table, with the reference temperature as one of its entries."""
    if master.temperature.size < 2:
        raise InputError("law must be 'none' for data of one temperature, got 'table'.")
    away = np.abs(master.temperature - master.reference) > 0.5
    temperature = np.append(master.temperature[away], master.reference).round(TEMPERATURE_DIGITS)
    log10_a = np.append(master.log10_a[away], 0.0).round(_DIGITS)
    order = np.argsort(temperature)
    return ShiftTable(temperature[order], np.minimum.accumulate(log10_a[order]))


def rounded(value: float, digits: int) -> float:
    """A number to so many significant digits."""
    return float(f"{value:.{digits - 1}e}")
