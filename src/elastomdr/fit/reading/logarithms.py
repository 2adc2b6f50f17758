"""Titles and units that say that a column holds logarithms: "log10 G' [Pa]", "ln(f/Hz)", "log Pa"."""

import math
import re

LOGS = {"log": 10.0, "log10": 10.0, "ln": math.e}  # what is written, and its base
_LARGEST = 690.0  # |ln| of a number that is still a float64
_DECADIC = r"log[\s_]?10|log[\s_]?\(10\)|log₁₀"
_OTHER = r"log[\s_(]*[\d₀-₉]|log_?e[\s(\[]"  # of a base that is written in another way, or of none that is used
_LOG = re.compile(rf"({_DECADIC}|(?!{_OTHER})(?:log|lg|ln)(?![a-z]{{2}}))[\s_]*(.+)", re.IGNORECASE)


def logarithm(text: str) -> tuple[str, str]:
    """Which of `LOGS` a title or a unit says, and the title or unit without it; ("", text) where it says none."""
    match = _LOG.fullmatch(text.strip())
    if match is None:
        return "", text
    log = {"lg": "log10", "ln": "ln", "log": "log"}.get(match[1].lower(), "log10")
    rest = match[2]
    end = _closing(rest)
    if end:  # log(G' [Pa]), log(w/(rad/s)) [-], log(G') [Pa]
        inside, behind = re.sub(r"/\s*\(", " (", rest[1:end]), rest[end + 1 :].strip()
        rest = f"{inside} {behind}" if behind.strip("[]()- 1") else inside
    return log, rest


def other_logarithm(title: str) -> bool:
    """Whether a title begins as a logarithm does that is none of `LOGS`, such as log2."""
    return not logarithm(title)[0] and re.match(_OTHER, title.strip(), re.IGNORECASE) is not None


def antilogarithm(value: float, log: str) -> float | None:
    """The number behind a logarithm, or None where there is none in double precision."""
    return LOGS[log] ** value if abs(value * math.log(LOGS[log])) < _LARGEST else None


def _closing(text: str) -> int:
    """Where the bracket closes that a text begins with, 0 where it begins with none."""
    depth = 0
    for i, mark in enumerate(text):
        depth += (mark == "(") - (mark == ")")
        if depth == 0:
            return i
    return 0
