"""The shift law that a material made from a master curve carries: the given one, or the
one that the data follow.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..material.shift import ShiftTable
from ..material.vertical import AbstractVertical, EntropicVertical, VerticalTable
from .given_law import about

if TYPE_CHECKING:
    from .master import MasterCurve

LAWS = ("auto", "WLF", "Arrhenius", "VFT", "table", "none")
# decimals of a material's range and of its table of shift factors, which have to agree
# [K]
TEMPERATURE_DIGITS = 2
_NONE = 1e-4  # log10 b_T below which it is none
# by how much a table of vertical shifts reaches beyond the data, as entropy elasticity
# [K]
_ONWARD = 100.0
# of a law in the material: what follows is rounding, and differs between machines
_DIGITS = 8


def check_law(law: Any) -> None:
    """Raises `InputError` unless `law` is one of `LAWS`."""
    if law not in LAWS:
        raise InputError(f"law must be one of {', '.join(LAWS)}, got {law!r}.")


def shift_law(master: "MasterCurve", law: str) -> tuple[str, Any]:
    """The name of a law and the law itself, None for "none"; `law` is one of `LAWS`."""
    if master.joint.law is not None and law == "auto":
        return "given", about(master.joint.law, master.reference, master.measured_at)
    chosen = _choose(master) if law == "auto" else law
    return chosen, None if chosen == "none" else _table(
        master
    ) if chosen == "table" else _law(master, chosen)


def _choose(master: "MasterCurve") -> str:
    if master.temperature.size < 2:
        return "none"
    if master.temperature.size == 2:
        return "Arrhenius"
    return "WLF" if master.laws["WLF"].holds else "table"


def _law(master: "MasterCurve", name: str) -> Any:
    if name not in master.laws:
        raise InputError(
            "law must be one that these data allow "
            f"({', '.join([*master.laws, 'none'])}), got {name!r}: there are "
            f"{master.temperature.size} temperatures."
        )
    law = master.laws[name].law
    return type(law)(
        *(
            rounded(float(getattr(law, field)), _DIGITS)
            for field in law.__dataclass_fields__
        )
    )


def _table(master: "MasterCurve") -> ShiftTable:
    """The shift factors as a table, with the reference temperature as one of its
    entries.
    """
    if master.temperature.size < 2:
        raise InputError("law must be 'none' for data of one temperature, got 'table'.")
    away = np.abs(master.temperature - master.reference) > 0.5
    temperature = np.append(master.temperature[away], master.reference).round(
        TEMPERATURE_DIGITS
    )
    log10_a = np.append(master.log10_a[away], 0.0).round(_DIGITS)
    order = np.argsort(temperature)
    return ShiftTable(temperature[order], np.minimum.accumulate(log10_a[order]))


def vertical_law(master: "MasterCurve") -> AbstractVertical | None:
    """The law of vertical shifts that a material carries: none, entropy elasticity
    where the shifts are those, a table.

    Beyond the data a table goes on by entropy elasticity: the range of the material
    says where they end.
    """
    reference, kelvin, log10_b = (
        float(master.reference),
        master.temperature,
        -master.log10_b,
    )
    if np.abs(log10_b).max() < _NONE:
        return None
    if np.abs(log10_b - np.log10(kelvin / reference)).max() < _NONE:
        return EntropicVertical(reference)
    away = np.abs(kelvin - reference) > 0.5
    temperature = np.append(kelvin[away], reference).round(TEMPERATURE_DIGITS)
    order = np.argsort(temperature)
    temperature, factor = (
        temperature[order],
        (10 ** np.append(log10_b[away], 0.0))[order],
    )
    beyond = np.array(
        [max(temperature[0] - _ONWARD, temperature[0] / 2), temperature[-1] + _ONWARD]
    )
    ends = beyond / temperature[[0, -1]] * factor[[0, -1]]
    temperature = np.concatenate([beyond[:1], temperature, beyond[1:]]).round(
        TEMPERATURE_DIGITS
    )
    return VerticalTable(
        temperature, np.concatenate([ends[:1], factor, ends[1:]]).round(_DIGITS)
    )


def rounded(value: float, digits: int) -> float:
    """A number to so many significant digits."""
    return float(f"{value:.{digits - 1}e}")
