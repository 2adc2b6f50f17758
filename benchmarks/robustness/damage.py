"""Random damage to files, for `fuzz.py`: bytes, lines, numbers, values, encodings."""

import re

import numpy as np

VALUES = (
    "nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "-1",
    "1e400",
    "1e308",
    "1e-320",
    "99999999999999999999999",
    "true",
    '""',
    "[]",
    "{}",
    "[[1]]",
    '"x"',
    "1979-05-27",
    "07:32:00",
    '"1e400 m"',
    '"nan m"',
    '"5 mm"',
    '"-5 mm"',
    '"0 s"',
    '"10 N"',
    '"1e-300 m/s"',
    '"1e300 m/s"',
    '"20 degC"',
    '"/dev/null"',
    '"/dev/zero"',
    '"."',
    '"\\u0000"',
    '"é µ"',
    "'''a\nb'''",
    "0x7f",
    "1_000",
    "3.5",
    '"m**m"',
    '"5 m**(1/0)"',
    '"5 m^9999999999"',
    "[1, 2, 'a']",
    '["1 s", "2 s"]',
    "[nan, 1e308, -1e308, 1]",
)
NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
VALUE = re.compile(
    rb"(?m)(?<== )(\"[^\"\n]*\"|\[[^\]\n]*\]|\{[^}\n]*\}|[^\s\"\[{#][^\s,}#]*)"
)


def mutate(content: bytes, random: np.random.Generator) -> bytes:
    """The content, damaged once to three times."""
    for _ in range(random.integers(1, 4)):
        content = _DAMAGES[random.integers(len(_DAMAGES))](content, random)
    return content


def _flip(content: bytes, random: np.random.Generator) -> bytes:
    data = bytearray(content)
    for _ in range(random.integers(1, 5)):
        if data:
            data[random.integers(len(data))] = random.integers(256)
    return bytes(data)


def _cut(content: bytes, random: np.random.Generator) -> bytes:
    return content[: random.integers(len(content) + 1)]


def _lines(content: bytes, random: np.random.Generator) -> bytes:
    """A line deleted, doubled or exchanged with another."""
    lines = content.split(b"\n")
    i, j = random.integers(len(lines), size=2)
    match random.integers(3):
        case 0:
            del lines[i]
        case 1:
            lines.insert(j, lines[i])
        case _:
            lines[i], lines[j] = lines[j], lines[i]
    return b"\n".join(lines)


def _value(content: bytes, random: np.random.Generator) -> bytes:
    """A value of a TOML file replaced."""
    return _replaced(
        content, VALUE, VALUES[random.integers(len(VALUES))].encode(), random
    )


def _number(content: bytes, random: np.random.Generator) -> bytes:
    """A number anywhere replaced, also inside texts and lists."""
    choices = (
        b"nan",
        b"inf",
        b"-1",
        b"0",
        b"1e400",
        b"1e300",
        b"1e-300",
        b"",
        b"x",
        b"1,5",
        b"9" * 400,
        b"-0",
        b"1e9",
        b"2",
    )
    return _replaced(content, NUMBER, choices[random.integers(len(choices))], random)


def _replaced(
    content: bytes, pattern: re.Pattern, new: bytes, random: np.random.Generator
) -> bytes:
    found = list(pattern.finditer(content))
    if not found:
        return content
    one = found[random.integers(len(found))]
    return content[: one.start()] + new + content[one.end() :]


def _encoded(content: bytes, random: np.random.Generator) -> bytes:
    text = content.decode("utf-8", "replace")
    codecs = ("utf-16", "utf-16-le", "utf-32", "utf-8-sig", "cp949", "latin-1", "utf-7")
    return text.encode(codecs[random.integers(len(codecs))], "replace")


def _breaks(content: bytes, random: np.random.Generator) -> bytes:
    return content.replace(
        b"\n", (b"\r\n", b"\r", b"\0", b"\n\n", b"")[random.integers(5)]
    )


def _binary(content: bytes, random: np.random.Generator) -> bytes:
    return random.bytes(int(random.integers(0, 3000)))


def _inserted(content: bytes, random: np.random.Generator) -> bytes:
    tokens = (
        b"[",
        b"]",
        b"{",
        b'"',
        b"'",
        b"=",
        b"#",
        b"\0",
        b"\xff\xfe",
        b"[[contact]]\n",
        b"[x.y]\n",
        b"," * 500,
        b"[" * 3000,
    )
    i = int(random.integers(len(content) + 1))
    return content[:i] + tokens[random.integers(len(tokens))] + content[i:]


_DAMAGES = (
    _flip,
    _cut,
    _lines,
    _lines,
    _value,
    _value,
    _value,
    _number,
    _number,
    _number,
    _encoded,
    _breaks,
    _binary,
    _inserted,
)
