"""What a column of a DMA file holds and in which unit, from its title and its unit's cell."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

from ...errors import InputError
from .logarithms import logarithm, other_logarithm

_HZ = 2 * math.pi
UNITS: dict[str, dict[str, float]] = {  # role -> unit -> factor to SI (rad/s, Pa, s, rad); K has an offset too
    "frequency": {"hz": _HZ, "khz": 1e3 * _HZ, "mhz": 1e-3 * _HZ, "rad/s": 1.0, "krad/s": 1e3, "mrad/s": 1e-3},
    "modulus": {
        "pa": 1.0, "kpa": 1e3, "mpa": 1e6, "gpa": 1e9, "n/m2": 1.0, "n/mm2": 1e6, "psi": 6894.757293168,
        "ksi": 6894757.293168, "bar": 1e5, "dyn/cm2": 0.1, "kgf/cm2": 98066.5, "kgf/mm2": 9806650.0,
    },
    "temperature": {"degc": 1.0, "k": 1.0, "degf": 5 / 9},
    "time": {"s": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0},
    "angle": {"deg": math.pi / 180, "rad": 1.0},
    "ratio": {"": 1.0, "%": 0.01},
}  # fmt: skip
_OFFSETS = {"degc": 273.15, "k": 0.0, "degf": 459.67 * 5 / 9}
_SAME = {
    "c": "degc", "°c": "degc", "℃": "degc", "oc": "degc", "ºc": "degc", "celsius": "degc", "deg c": "degc",
    "kelvin": "k", "f": "degf", "°f": "degf", "℉": "degf", "rad/sec": "rad/s", "rads-1": "rad/s", "rad*s-1": "rad/s",
    "rad·s-1": "rad/s", "rads^-1": "rad/s", "rad/s^1": "rad/s", "hertz": "hz", "sec": "s", "second": "s",
    "seconds": "s", "minutes": "min", "hours": "h", "hr": "h", "°": "deg", "º": "deg",
    "degree": "deg", "degrees": "deg",
    "n/m^2": "n/m2", "n/mm^2": "n/mm2", "dyn/cm^2": "dyn/cm2", "dyne/cm2": "dyn/cm2", "dyne/cm^2": "dyn/cm2",
    "kgf/cm^2": "kgf/cm2", "kg/cm2": "kgf/cm2", "kgf/mm^2": "kgf/mm2", "kg/mm2": "kgf/mm2", "1": "",
    "-": "", "[-]": "", "none": "",
}  # fmt: skip

_STORAGE = "storage modulus|storage|stor|s torage|speichermodul|저장탄성률|저장 탄성률|저장탄성계수"
_LOSS = "loss modulus|loss|verlustmodul|손실탄성률|손실 탄성률|손실탄성계수"
_SPELLED = {
    "hz": "Hz", "khz": "kHz", "mhz": "mHz", "pa": "Pa", "kpa": "kPa", "mpa": "MPa", "gpa": "GPa",
    "k": "K", "degc": "degC",
    "degf": "degF", "n/m2": "N/m2", "n/mm2": "N/mm2",
}  # fmt: skip
_NAMES = {
    "omega": r"w|ω|omega|angular frequency|ang\.? freq(uency|\.)?|angular freq\.?|kreisfrequenz|각주파수",
    "frequency": r"f|freq\.?|frequency|frequenz|주파수",
    "temperature": r"temp\.?|temperature|temperatur|온도|t[ _](sample|set)|"
    r"(sample|specimen|probe|set|set ?point|program(med)?|target|nominal|furnace|oven|chamber) temp(\.|erature)?|"
    r"(probe|soll)n?temperatur",
    "time": r"(step )?time|zeit|시간",
    "storage": rf"{_STORAGE}|(modulus )?[ge]'|[ge]_?(1|p|prime|stor|storage)|re\([ge]\*?\)|"
    r"([ge]|shear|tensile|young'?s)[ _-](stor|storage|storage modulus)|storage (shear|tensile|young'?s) modulus",
    "loss": rf"{_LOSS}|(modulus )?[ge]''|[ge]_?(2|pp|dprime|double[_ -]?prime|loss)|im\([ge]\*?\)|"
    r"([ge]|shear|tensile|young'?s)[ _-](loss|loss modulus)|loss (shear|tensile|young'?s) modulus",
    "absolute": r"\|[ge]\*\|?|[ge]\*|[ge]_?abs|complex modulus|komplexer modul",
    "phase": r"phase ?angle|phase|delta|δ|phasenwinkel",
    "tangent": r"tan_?\(?(d|delta|δ)\)?|tan ?(d|delta|δ)|tand|loss (tangent|factor)|verlustfaktor",
    "relaxation": r"[ge]_?(relax|t)|[ge]\(t\)|relaxationsmodul|relax|relaxation|완화탄성률|"
    r"(stress |shear |tensile )?relaxation modulus( [ge](\(t\))?)?",
    "torque": r"(oscillation )?torque|drehmoment",
}
_KIND = {"omega": "frequency", "storage": "modulus", "loss": "modulus", "absolute": "modulus", "relaxation": "modulus",
         "phase": "angle", "tangent": "ratio"}  # fmt: skip
MODULI = ("storage", "loss", "absolute", "phase", "tangent")  # columns that speak of dynamic moduli,
PAIRS = (("storage", "loss"), ("storage", "tangent"), ("absolute", "phase"), ("absolute", "tangent"))  # and make both
_NO_LOGS = ("temperature", "phase", "torque")  # of which nobody writes logarithms
_LONGEST = 80  # characters of a title
_PATTERNS = {role: re.compile(pattern, re.IGNORECASE) for role, pattern in _NAMES.items()}


class Column(NamedTuple):
    """One column that is understood."""

    place: int
    role: str
    title: str
    unit: str  # "" where none was given, or none that is known
    letter: str  # "G", "E" or "" where the title does not say which modulus it is
    said: str = ""  # what stands in place of a unit and is none that is known
    log: str = ""  # of `LOGS`, where the column holds logarithms


def measure(role: str) -> str:
    """The kind of quantity behind a role: frequency, modulus, temperature, time, angle or ratio."""
    return _KIND.get(role, role)


def known_unit(text: str) -> str:
    """A unit in the spelling used here, or an empty string where it is none."""
    word = re.sub(r"\s+", "", text.strip().strip("[]()").strip()).lower().replace("²", "2").replace("μ", "µ")
    word = word.replace("⁻¹", "-1").replace("⋅", "·")
    word = _SAME.get(word, word)
    if text.strip().strip("[]()") in ("MHz", "mPa"):
        return ""  # 1e6 Hz and 1e-3 Pa are meant by nobody who has a DMA; whether mHz and MPa are is not for us to say
    return word if any(word in units for units in UNITS.values()) else ""


def unclear(text: str) -> bool:
    """Whether a text stands for a unit that may be one of several, so that the user has to say which."""
    return per_second(text) or re.sub(r"\s+", "", text) in ("MHz", "mPa")


def per_second(text: str) -> bool:
    """Whether a text is a unit of rates, which leaves open whether turns or radians are counted."""
    return re.sub(r"\s+", "", text) in ("1/s", "s-1", "s^-1", "s⁻¹", "/s")


def is_unit_row(cells: Sequence[str]) -> bool:
    """Whether a row gives units: some of its cells are, none is a number, few are anything else."""
    words = [cell.strip() for cell in cells if cell.strip()]
    plain = [logarithm(word.strip("[]()"))[1] for word in words]
    units = [word for word in plain if known_unit(word) or word in ("-", "N", "mm", "µm", "1/MPa")]
    numbers = [word for word in words if re.fullmatch(r"[+-]?[\d.,]+([eE][+-]?\d+)?", word)]
    return (len(units) >= 2 and not numbers) or (len(units) == 1 and len(words) == 1)


def understand(titles: Sequence[str], units: Sequence[str]) -> list[Column]:
    """The columns whose titles say what they hold; `units` from a row of its own go before those in the title."""
    columns = []
    for place, title in enumerate(titles):
        log, text = logarithm(_clean(title))
        name, unit, said = _split(text)
        below = units[place].strip() if place < len(units) else ""
        role = _role(name)
        if role is None and (unit or said):  # the end of the title was no unit after all
            role, unit, said, name = _role(text), "", "", text
        if role is None or (log and role in _NO_LOGS):
            continue
        if below.strip("[]()- "):
            unit, said = known_unit(below), "" if known_unit(below) else below.strip("[]()- ")
        of_unit, inner = logarithm(said)
        if of_unit and known_unit(inner) and log in ("", of_unit):
            log, unit, said = of_unit, known_unit(inner), ""
        if unit and unit not in UNITS.get(measure(role), {unit: 1.0}):
            if role != "torque":
                continue  # such as a "Phase" in volts
            unit = ""
        columns.append(Column(place, role, title.strip(), unit, _letter(role, name), said, log))
    return columns


def is_complete(columns: Sequence[Column]) -> bool:
    """Whether columns make a measurement: rate and both moduli, or time and relaxation."""
    roles = {column.role for column in columns}
    moduli = any(set(pair) <= roles for pair in PAIRS)
    return bool(({"frequency", "omega"} & roles and moduli) or {"time", "relaxation"} <= roles)


def _letter(role: str, name: str) -> str:
    if measure(role) != "modulus":
        return ""
    if re.match(r"((storage|loss) )?shear", name, re.IGNORECASE):
        return "G"
    if re.match(r"((storage|loss) )?(tensile|young)", name, re.IGNORECASE):
        return "E"
    behind = r"[_'*12(]|pp?\b|[ ]?(?:abs|stor|loss|relax|(?:d|double[_ -]?)?prime)|-(?:stor|loss)|\*?\)"
    match = re.search(rf"(?<![a-z])([ge])(?={behind})", name, re.IGNORECASE)
    match = match or re.match(r"\|?([GE])(?=[tT]\b)", name) or re.search(r"modulus ([GE])$", name, re.IGNORECASE)
    return match[1].upper() if match else ""


def convert(values: list[float], role: str, unit: str) -> list[float]:
    """Values in SI; the unit is one of `UNITS`."""
    factor = UNITS[measure(role)][unit]
    offset = _OFFSETS[unit] if role == "temperature" else 0.0
    return [value * factor + offset for value in values]


def spelled(unit: str) -> str:
    """A unit as an engineer writes it."""
    return _SPELLED.get(unit, unit)


def checked_unit(name: str, text: str | None, kind: str) -> str | None:
    """A user's unit in the spelling used here; raises `InputError` where it is none of its kind."""
    if text is None:
        return None
    unit = known_unit(text) if isinstance(text, str) else ""
    if unit not in UNITS[kind] or not unit:
        accepted = ", ".join(spelled(key) for key in UNITS[kind])
        raise InputError(f"{name} must be one of {accepted}, got {text!r}.")
    return unit


def named(role: str, place: int, title: str, below: str | None, known: Column | None) -> Column:
    """The column that a user names for a role; its title may be `known` already, the unit `below` it replaces the
    title's. Raises `InputError` for logarithms of a base that is not clear.
    """
    if known is not None and measure(known.role) == measure(role):
        return known._replace(role=role)
    if other_logarithm(title):
        raise InputError(unclear_logarithm(title))
    log, text = logarithm(_clean(title))
    of_unit, unit = ("", title_unit(text)) if below is None else logarithm(below.strip("[]() "))
    return Column(place, role, title, known_unit(unit), "", log=log or of_unit)


def unclear_logarithm(title: str) -> str:
    """What is wrong with a title such as log2 G'."""
    return f"{title!r} is a logarithm of a base that is not clear: write log10 or ln, and the unit behind it."


def _role(name: str) -> str | None:
    found = _plain_role(name)
    if found is not None or len(name) > _LONGEST:
        return found
    for gap in re.finditer(r"[\s(,:-]+", name):  # said twice, in words and as a symbol
        one, other = _plain_role(name[: gap.start()].strip()), _plain_role(name[gap.end() :].strip(" )"))
        if one is not None and one == other:
            return one
    return None


def _plain_role(name: str) -> str | None:
    if name in ("T", "t"):
        return "temperature" if name == "T" else "time"
    for spelled in dict.fromkeys((name, name.replace("_", " "))):
        for role, pattern in _PATTERNS.items():
            if pattern.fullmatch(spelled):
                return role
    return None


def _split(title: str) -> tuple[str, str, str]:
    """Name and unit of a title such as "G' [MPa]", "Frequency (Hz)", "E' / MPa" or "freq_hz"; third, what stands in
    brackets in place of a unit and is none that is known.
    """
    text = _clean(title)
    match = re.fullmatch(r"(.*?)\s*[\[(]\s*([^\[\]()]*)\s*[\])]", text)
    if match and (known_unit(match[2]) or not match[2].strip("- ")):
        return match[1].strip(), known_unit(match[2]), ""
    if match and _role(match[1].strip()) and _role(text) is None:
        return match[1].strip(), "", match[2]
    for pattern in (r"(.*?)\s*[/,]\s*(\S+)", r"(.+)\s+in\s+(\S+)", r"(.+?)\s+-\s+(\S+)"):
        match = re.fullmatch(pattern, text)
        if match and known_unit(match[2]):
            return match[1].strip(), known_unit(match[2]), ""
    for pattern in (r"(.+?)_(rad_?s|rad_per_s|deg_[cCfF]|[a-zA-Z]+)", r"(\S.*?)\s+([^\s]+)"):
        match = re.fullmatch(pattern, text)
        if match:
            unit = {"rads": "rad/s", "rad_s": "rad/s", "rad_per_s": "rad/s", "deg_c": "degc",
                    "deg_f": "degf"}.get(match[2].lower(), match[2])  # fmt: skip
            if known_unit(unit) and _role(match[1]):
                return match[1].strip(), known_unit(unit), ""
    return text, "", ""


def title_unit(title: str) -> str:
    """The unit at the end of a title, whatever the rest of it says; "" where there is none."""
    match = re.fullmatch(r".*?[\s(\[/,_-]([^\s(\[\])/,_-]+(?:/[^\s(\[\])]+)?)[\])]?", _clean(title))
    return known_unit(match[1]) if match else ""


def _clean(title: str) -> str:
    text = title.strip().strip('"').strip() if title.count('"') != 1 else title.strip()
    for mark in ("\u2032", "\u2019", "\u02b9", "`", "\u00b4"):
        text = text.replace(mark, "'")
    text = re.sub('[″“”"]', "''", text)
    return re.sub(r"\s+", " ", text)
