"""Units as they stand in the titles of tables, by pint: a text and a kind of quantity
to factor and offset to SI.
"""

import functools
import re
from typing import Any

# kind of quantity -> its SI unit, and units that are recognised in capitals and small
# letters alike
KINDS = {
    "frequency": ("rad/s", "Hz kHz mHz rad/s"),
    "angular frequency": ("rad/s", "rad/s"),
    "modulus": ("Pa", "Pa kPa MPa GPa"),
    "pressure": ("Pa", "Pa kPa MPa bar"),
    "temperature": ("K", "degC K degF"),
    "time": ("s", "s ms min h"),
    "angle": ("rad", "deg rad"),
    "ratio": ("-", "- %"),
    "strain": ("-", "% -"),
    "viscosity": ("Pa*s", "Pa*s mPa*s kPa*s"),
    "compliance": ("1/Pa", "1/Pa 1/kPa 1/MPa"),
    "stiffness": ("N/m", "N/m N/mm kN/m"),
    "area": ("m^2", "m^2 cm^2 mm^2"),
    "velocity": ("m/s", "m/s mm/s um/s km/h m/min"),
    "length": ("m", "m mm um nm"),
    "wave number": ("rad/m", "rad/m cycles/m 1/m"),
    "force": ("N", "kN mN"),
    "torque": ("N*m", "N*m mN*m"),
    "m^4": ("m^4", "m^4 mm^4 um^4"),
    "m^3": ("m^3", "m^3 mm^3 um^3"),
}
_SPELLED = str.maketrans(
    {
        "μ": "µ",
        "⁻": "-",
        "¹": "1",
        "²": "2",
        "³": "3",
        "⁴": "4",
        "·": "*",
        "⋅": "*",
        "\u2212": "-",
        "º": "°",
        "\u00d7": "*",
    }
)
_ALIASES = {  # in small letters, without blanks
    "c": "degC",
    "°c": "degC",
    "℃": "degC",
    "oc": "degC",
    "degc": "degC",
    "deg_c": "degC",
    "celsius": "degC",
    "°f": "degF",
    "℉": "degF",
    "degf": "degF",
    "deg_f": "degF",
    "k": "kelvin",
    "kelvin": "kelvin",
    "pas": "Pa*s",
    "mpas": "mPa*s",
    "kpas": "kPa*s",
    "pct": "percent",
    "prozent": "percent",
    "°": "degree",
    "deg": "degree",
    "sec": "second",
    "hr": "hour",
    "rads": "rad/s",
    "rad_s": "rad/s",
    "rad_per_s": "rad/s",
    "rad/sec": "rad/s",
    "rads**-1": "rad/s",
    "hertz": "Hz",
    "dyne/cm**2": "dyn/cm**2",
    "kg/cm**2": "kgf/cm**2",
    "kg/mm**2": "kgf/mm**2",
    "-": "",
    "1": "",
    "none": "",
}
_ALIASES.update(
    (f"{prefix}met{ending}", f"{prefix}meter")
    for prefix in ("nano", "micro", "milli")
    for ending in ("er", "ers", "re", "res")
)


@functools.cache
def registry() -> Any:
    """The one registry of units (making it takes half a second)."""
    import pint

    return pint.UnitRegistry()


def to_si(spelling: str, kind: str) -> tuple[float, float] | None:
    """Factor and offset that turn numbers in a unit into SI; None for a text that is no
    unit of this kind.

    Hz counts turns. Of a frequency, 1/s leaves open whether turns or radians are
    counted, and is no unit; of an angular frequency it can only be rad/s, and Hz is no
    unit.
    """
    unit = _parsed(spelling, kind)
    if unit is None:
        return None
    word = spelling.lower()
    if kind == "frequency" and not re.search("hz|hertz|rad|cycle|rev|turn|rpm", word):
        return None
    if kind == "angular frequency" and re.search("hz|hertz", word):
        return None
    turns = (
        2 * 3.141592653589793
        if kind == "frequency" and re.search("hz|hertz", word)
        else 1.0
    )
    si = _pint(KINDS[kind][0])
    zero, one, two = (
        float(registry().Quantity(x, unit).to(si).magnitude) for x in (0.0, 1.0, 2.0)
    )
    if abs(two - 2 * one + zero) > 1e-9 * abs(two):  # a level, such as dB
        return None
    return (round(one - zero, 12) if zero else one) * turns, zero


def quantity_of(values: Any, spelling: str) -> Any:
    """Values in a unit that is given as a text, as pint's quantity; None for a text
    that is no unit.
    """
    unit = _pint(str(spelling))
    return None if unit is None else registry().Quantity(values, unit)


def is_unit(cell: str) -> bool:
    """Whether a cell holds a unit and nothing else; an empty one does not."""
    return is_level(cell) or any(_parsed(cell, kind) is not None for kind in KINDS)


def is_level(unit: str) -> bool:
    """Whether a unit is that of a level, such as dB re 1e-6 m."""
    return re.match(r"dB(?![A-Za-z])", _plain(unit)) is not None


def usual(kind: str) -> str:
    """Examples of units of a kind, for messages."""
    return ", ".join(KINDS[kind][1].replace("-", "none").split())


_LONGEST = 100  # characters of a unit: pint takes minutes for a million
# an exponent of three digits, or one that has its own
_TOWER = re.compile(r"\*\*[\s(+-]*(\d{3,}|[\w.]+[\s)]*\*\*)")


def harmless(unit: str) -> bool:
    """Whether pint may see it: it would compute 9**9**9**9, and read a million
    characters for minutes.
    """
    return len(unit) <= _LONGEST and not _TOWER.search(unit.replace("^", "**"))


@functools.cache
def _parsed(spelling: str, kind: str) -> Any:
    """pint's unit, None where the text is none of this kind."""
    known = {unit.lower(): unit for unit in KINDS[kind][1].split()}
    if _alike(spelling, KINDS[kind][0]):
        return _pint(spelling)
    word = known.get(_plain(spelling).lower(), "")  # hz, pa, mpa
    return _pint(word) if word else None


def _alike(spelling: str, unit: str) -> bool:
    unit_given, unit_wanted = _pint(spelling), _pint(unit)
    angular = "rad" in unit.split("/")  # angles have no dimension
    return (
        unit_given is not None
        and dict(unit_given.dimensionality) == dict(unit_wanted.dimensionality)
        and (
            bool(dict(unit_wanted.dimensionality))
            or angular == any(word in str(unit_given) for word in ("radian", "degree"))
        )
    )


def _plain(spelling: str) -> str:
    return spelling.strip().strip("[]()").strip().translate(_SPELLED)


@functools.cache
def _pint(spelling: str) -> Any:
    if not harmless(spelling):
        return None
    # N.m, Pa-s, mNm
    word = re.sub(
        r"(?<=[A-Za-zµ])[.-](?=[A-Za-z])|(?<=N)(?=mm?\b)",
        "*",
        _plain(spelling).replace("^", "**"),
    )
    word = re.sub(r"(?<=[A-Za-z])(-?\d)", r"**\1", word)  # mm2, s-1
    bare = re.sub(r"\s+", "", word)
    word = _ALIASES.get(bare.lower(), word)
    if not re.search("[A-Za-zµ°%]", word):
        return registry().parse_units("") if not word and spelling.strip() else None
    try:
        unit = registry().parse_units(word)
        # some that pint reads have none: products with dB
        return unit if unit.dimensionality is not None else None
    except Exception:  # pint lets errors of its parser through, of many types
        return None
