"""Titles and units of tables of measured friction."""

import re

from ...errors import InputError
from .columns import checked_unit, known_unit
from .logarithms import logarithm
from .table import METRES, Table

NAMES = {
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
EXAMPLES = {"velocity": "mm/s", "temperature": "degC", "pressure": "MPa"}


def role_of(title: str) -> str:
    """The quantity that a title without its unit names, or an empty string."""
    bare = re.sub(r"[_\s]+", " ", title.strip().lower())
    return next((role for role, pattern in NAMES.items() if re.fullmatch(pattern, bare)), "")


def with_units(table: Table) -> Table:
    """The same table with the units that stand behind a comma or a low line: "speed, mm/s", "velocity_mm_s"."""
    heads, units = list(table.titles), list(table.units)
    for i, title in enumerate(heads):
        if units[i] or role_of(title):
            continue
        for gap in re.finditer(r"\s*[,_]\s*", title):
            name, said = title[: gap.start()], title[gap.end() :]
            role = role_of(logarithm(name)[1])
            unit = next((word for word in (said, said.replace("_", "/")) if known(word, role)), "") if role else ""
            if unit or (role in ("mu", "error") and said in ("-", "%")):
                heads[i], units[i] = name, unit or said
                break
    return table._replace(titles=heads, units=units)


def known(text: str, role: str) -> str:
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


def is_unit(text: str) -> bool:
    return text.strip() in ("", "-", "1", "%") or any(known(text, role) for role in EXAMPLES)


def per_second(unit: str) -> float:
    match = _VELOCITY.fullmatch(unit)
    assert match is not None
    return (METRES | {"km": 1e3})[match[1]] / _SECONDS[match[2] or match[3]]


def checked_velocity(text: str | None) -> str | None:
    if text is not None and not (isinstance(text, str) and known(text, "velocity")):
        raise InputError(f"velocity_unit must be a unit such as m/s, mm/s, um/s, km/h, got {text!r}.")
    return None if text is None else known(text, "velocity")
