"""What a file of moduli may hold: quantities with the titles of their columns, and which
of them together are a measurement.
"""

from .columns import ColumnKind
from .data import COLDEST

_POLYMERS = (1e3, 3e10)  # [Pa], between which the largest modulus of a file lies
QUANTITIES = (
    ColumnKind(
        "frequency",
        "frequency",
        (r"f|freq\.?|frequency|frequenz|주파수",),
        option="frequency_unit",
    ),
    ColumnKind(
        "frequency",
        "angular frequency",
        (
            r"w|ω|omega|angular frequency|ang\.? freq(uency|\.)?|angular freq\.?|kreisfrequenz|각주파수",
        ),
        option="frequency_unit",
    ),
    ColumnKind(
        "temperature",
        "temperature",
        (
            r"(sample|specimen|probe) temp(\.|erature)?|t[ _]sample|proben?temperatur",
            r"(?-i:T)|temp\.?|temperature|temperatur|온도",
            r"t[ _]set|(set|set ?point|program(med)?|target|nominal|furnace|oven|chamber) temp(\.|erature)?|"
            "solltemperatur",
        ),
        option="temperature_unit",
        limits=(COLDEST, 800.0),
    ),
    ColumnKind(
        "time", "time", (r"(?-i:t)|(step )?time|zeit|시간",), option="time_unit"
    ),
    ColumnKind(
        "storage",
        "modulus",
        (
            r"storage modulus|storage|stor|s torage|speichermodul|저장 ?탄성(률|계수)|(modulus )?[ge]'|"
            r"[ge]_?(1|p|prime|stor|storage)|re\([ge]\*?\)|storage (shear|tensile|young'?s) modulus|"
            r"([ge]|shear|tensile|young'?s)[ _-](stor|storage|storage modulus)",
        ),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    ColumnKind(
        "loss",
        "modulus",
        (
            r"loss modulus|loss|verlustmodul|손실 ?탄성(률|계수)|(modulus )?[ge]''|"
            r"[ge]_?(2|pp|dprime|double[_ -]?prime|loss)|im\([ge]\*?\)|loss (shear|tensile|young'?s) modulus|"
            r"([ge]|shear|tensile|young'?s)[ _-](loss|loss modulus)",
        ),
        option="modulus_unit",
    ),
    ColumnKind(
        "absolute",
        "modulus",
        (r"\|[ge]\*\|?|[ge]\*|[ge]_?abs|(complex|dynamic) modulus|komplexer modul",),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    ColumnKind(
        "phase",
        "angle",
        (r"phase ?angle|phase|delta|δ|phasenwinkel",),
        valid="between 0 and 90 deg",
    ),
    ColumnKind(
        "tangent",
        "ratio",
        (
            r"tan_?\(?(d|delta|δ)\)?|tan ?(d|delta|δ)|tand|loss (tangent|factor)|verlustfaktor",
        ),
        limits=(0.0, 3.0),
    ),
    ColumnKind(
        "relaxation",
        "modulus",
        (
            r"[ge]_?(relax|t)|[ge]\(t\)|relaxationsmodul|relax|relaxation|완화탄성률|relaxation modulus [ge]|"
            r"(stress |shear |tensile )?relaxation modulus( [ge]\(t\))?",
        ),
        option="modulus_unit",
        limits=_POLYMERS,
    ),
    ColumnKind(
        "strain",
        "strain",
        (
            r"(oscillation|oscillatory|dynamic) strain( amplitude)?|strain (amplitude|ampl\.?|dyn|dynamic)",
            r"((shear|tensile) )?strain( \u03b3| gamma)?|(strain )?amplitude|\u03b3|\u03b3_?0|gamma|(?-i:g)|"
            r"epsilon|ε|dehnung|scherdehnung|deformation|scherdeformation|(dehnungs|deformations)amplitude",
        ),
        valid="",
        limits=(1e-8, 5.0),
    ),
    ColumnKind(
        "viscosity",
        "viscosity",
        (r"\|?(eta|η|h)\*\|?|complex viscosity|komplexe viskosität|eta_?(abs|star)",),
    ),
    ColumnKind(
        "viscosity_real",
        "viscosity",
        (r"(eta|η|h)(_?1|'|_?prime)|(dynamic|real|storage) viscosity",),
    ),
    ColumnKind(
        "viscosity_imaginary",
        "viscosity",
        (
            r"(eta|η|h)(_?2|''|_?(double_?prime|dprime|pp))|(imaginary|loss|out[- ]of[- ]phase) viscosity",
        ),
    ),
    ColumnKind(
        "compliance",
        "compliance",
        (r"\|[jd]\*\|?|[jd]\*|[jd]_?abs|(complex|dynamic) compliance",),
    ),
    ColumnKind(
        "compliance_storage",
        "compliance",
        (
            r"[jd](_?1|'|_?(prime|stor|storage))|storage compliance|speichernachgiebigkeit",
        ),
    ),
    ColumnKind(
        "compliance_loss",
        "compliance",
        (
            r"[jd](_?2|''|_?(pp|dprime|double_?prime|loss))|loss compliance|verlustnachgiebigkeit",
        ),
    ),
    ColumnKind(
        "creep",
        "compliance",
        (
            r"[jd]\(t\)|((creep|shear|tensile|shear creep|tensile creep) )?compliance( [jd](\(t\))?)?|"
            r"kriechnachgiebigkeit|creep|[jd]_?(creep|t)|(?-i:[JD])",
        ),
    ),
    ColumnKind(
        "stiffness",
        "stiffness",
        (
            r"\|?k\*\|?|k_?(abs|dyn)|((dynamic|complex) )?stiffness|(dynamische )?steifigkeit",
        ),
    ),
    ColumnKind(
        "stiffness_storage",
        "stiffness",
        (r"k(_?1|'|_?(prime|stor|storage))|(storage|elastic) stiffness",),
    ),
    ColumnKind(
        "stiffness_loss",
        "stiffness",
        (r"k(_?2|''|_?(pp|dprime|double_?prime|loss))|(loss|viscous) stiffness",),
    ),
    ColumnKind(
        "stress",
        "modulus",
        (
            r"((shear|tensile) )?stress( \u03c3| sigma)?|(schub)?spannung|\u03c3|sigma|"
            r"\u03c4|tau",
        ),
    ),
)
_PAIRS = (
    ("storage", "loss"),
    ("storage", "tangent"),
    ("absolute", "phase"),
    ("absolute", "tangent"),
    ("storage", "phase"),
    ("loss", "tangent"),
    ("compliance_storage", "compliance_loss"),
    ("compliance_storage", "tangent"),
    ("compliance", "phase"),
    ("compliance", "tangent"),
    ("viscosity_real", "viscosity_imaginary"),
    ("viscosity", "phase"),
    ("viscosity", "tangent"),
    ("stiffness_storage", "stiffness_loss"),
    ("stiffness_storage", "tangent"),
    ("stiffness", "phase"),
    ("stiffness", "tangent"),
)
_TIMED = (("relaxation",), ("creep",), ("stress", "strain"))


def lacking(roles: set[str]) -> str:
    """What is missing to make a measurement of columns, in words; an empty text where
    nothing is.
    """
    moduli = any(set(pair) <= roles for pair in _PAIRS)
    timed = any(set(group) <= roles for group in _TIMED)
    if (moduli and "frequency" in roles) or (timed and "time" in roles):
        return ""
    if {"relaxation", "creep"} & roles:
        return "there is no column of time"
    if "time" in roles and {"stress", "strain"} & roles:
        other, example = (
            ("stress", "0.1 MPa") if "strain" in roles else ("strain", "1 %")
        )
        return (
            f"there is no column of {other}; where it was held, give it, as '{example}'"
        )
    lack = [] if "frequency" in roles else ["frequency"]
    if not moduli:
        lack += (
            ["loss modulus (or tangent, phase)"]
            if {"storage", "absolute"} & roles
            else ["storage and loss modulus"]
        )
    return f"there is no column of {' and '.join(lack)}"


def needed_roles(roles: set[str], users: set[str]) -> tuple[str, ...]:
    """The roles that make the measurement: rate and both moduli, or time and what was
    measured over it; temperature.

    Of several pairs of moduli the one with most of what the user names.
    """
    pairs = [pair for pair in _PAIRS if set(pair) <= roles and "frequency" in roles]
    pair = max(pairs, key=lambda pair: len(users.intersection(pair)), default=None)
    if pair:
        return ("frequency", *pair, "temperature", "strain")
    timed = next(
        (group for group in _TIMED if set(group) <= roles and "time" in roles), None
    )
    return (
        ("time", *timed, "temperature")
        if timed
        else ("frequency", "storage", "temperature", "strain")
    )
