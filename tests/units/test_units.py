"""Units in files and on the command line, by published factors."""

import re

import numpy as np
import pytest

from elastomdr.cli import units
from elastomdr.units.registry import KINDS, to_si

# the international pound and inch [kg, m], standard gravity
POUND, INCH, GRAVITY = 0.45359237, 0.0254, 9.80665
PSI = POUND * GRAVITY / INCH**2

# What each unit is in SI: factor, and offset.
FACTORS = {
    "pressure": {"Pa": 1, "kPa": 1e3, "MPa": 1e6, "bar": 1e5, "N/mm^2": 1e6},
    "modulus": {
        "Pa": 1,
        "kPa": 1e3,
        "MPa": 1e6,
        "GPa": 1e9,
        "N/mm2": 1e6,
        "N/mm^2": 1e6,
        "N/m^2": 1,
        "bar": 1e5,
        "psi": PSI,
        "ksi": 1e3 * PSI,
        "dyn/cm2": 0.1,
        "dyne/cm^2": 0.1,
        "kgf/cm2": 1e4 * GRAVITY,
        "kg/cm2": 1e4 * GRAVITY,
        "kg/mm2": 1e6 * GRAVITY,
        "mpa": 1e6,
        "lbf/in^2": PSI,
    },
    "frequency": {
        "Hz": 2 * np.pi,
        "kHz": 2e3 * np.pi,
        "mHz": 2e-3 * np.pi,
        "rad/s": 1,
        "rads": 1,
        "rpm": 2 * np.pi / 60,
        "1/s": None,
    },
    "angular frequency": {"rad/s": 1, "1/s": 1, "s-1": 1, "Hz": None},
    "temperature": {
        "K": 1,
        "C": (1, 273.15),
        "°C": (1, 273.15),
        "degC": (1, 273.15),
        "degF": (5 / 9, 273.15 - 32 * 5 / 9),
        "°F": (5 / 9, 273.15 - 32 * 5 / 9),
    },
    "time": {"s": 1, "ms": 1e-3, "min": 60, "h": 3600, "hr": 3600, "sec": 1},
    "angle": {"rad": 1, "deg": np.pi / 180, "°": np.pi / 180},
    "ratio": {"-": 1, "%": 0.01},
    "strain": {"-": 1, "%": 0.01},
    "viscosity": {"Pa*s": 1, "Pa s": 1, "mPa*s": 1e-3, "kPa*s": 1e3},
    "compliance": {"1/Pa": 1, "1/kPa": 1e-3, "1/MPa": 1e-6},
    "stiffness": {"N/m": 1, "N/mm": 1e3, "kN/m": 1e3},
    "area": {"m^2": 1, "mm^2": 1e-6, "mm2": 1e-6, "cm^2": 1e-4},
    "velocity": {
        "m/s": 1,
        "mm/s": 1e-3,
        "um/s": 1e-6,
        "km/h": 1 / 3.6,
        "m/min": 1 / 60,
        "in/s": INCH,
    },
    "length": {"m": 1, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "in": INCH},
    "wave number": {"1/m": 1, "rad/m": 1, "1/um": 1e6},
    "force": {"N": 1, "kN": 1e3, "mN": 1e-3, "kgf": 9.80665},
    "torque": {"N*m": 1, "Nm": 1, "mNm": 1e-3, "µNm": 1e-6, "N.mm": 1e-3},
    "m^4": {"m^4": 1, "mm^4": 1e-12, "um^4": 1e-24},
    "m^3": {"m^3": 1, "mm^3": 1e-9, "um^3": 1e-18},
}


@pytest.mark.parametrize("kind", KINDS)
def test_units_of_titles(kind):
    for text, expected in FACTORS[kind].items():
        found = to_si(text, kind)
        if expected is None:
            assert found is None, text
        else:
            factor, offset = (
                expected if isinstance(expected, tuple) else (expected, 0.0)
            )
            np.testing.assert_allclose(found, (factor, offset), rtol=1e-9, err_msg=text)


PREFIX = {
    "G": 1e9,
    "M": 1e6,
    "k": 1e3,
    "c": 1e-2,
    "m": 1e-3,
    "u": 1e-6,
    "µ": 1e-6,
    "n": 1e-9,
}
OTHERS = {
    "deg": np.pi / 180,
    "°": np.pi / 180,
    "min": 60,
    "h": 3600,
    "day": 86400,
    "bar": 1e5,
    "t": 1e3,
    "g": 1e-3,
    "degC": 1,
    "kg": 1,
    "l": 1e-3,
    "cP": 1e-3,
    "St": 1e-4,
    **{name: 1 for name in ("m", "N", "K", "s", "Pa", "Hz", "J", "W", "rad", "mol")},
}


def by_parts(unit):
    """The factor of a unit from those of its parts, above and below the stroke."""
    above, *below = unit.replace("(", "/(").replace("//(", "/(").strip("/").split("/")

    def of(word):
        word = re.sub(r"(?<=[a-z])(?=\d)", "^", word.strip("()"))  # mm2
        word, _, power = word.partition("^")
        single = OTHERS.get(word) or PREFIX[word[0]] * OTHERS[word[1:]]
        return float(single) ** int(power or 1)

    def product(words):
        return np.prod(
            [
                of(word)
                for word in words.strip("()").replace(" ", "*").split("*")
                if word != "1"
            ]
        )

    return product(above) / np.prod([product(words) for words in below])


@pytest.mark.parametrize("si", units.USUAL)
def test_units_of_the_command_line(si):
    """Each unit that is converted without a library, from its prefixes and powers."""

    class Kind(units.SceneQuantity, what="a quantity", unit=si, example=f"1 {si}"): ...

    for unit in units.USUAL[si]:
        offset = 273.15 if unit == "degC" else 0.0
        np.testing.assert_allclose(
            Kind.convert("3", unit),
            3 * by_parts(unit) + offset,
            rtol=1e-12,
            err_msg=unit,
        )


def test_units_that_a_library_converts():
    assert units.Pressure.read("2 psi") == pytest.approx(2 * PSI, rel=1e-9)
    assert units.Pressure.read("2 ksi") == pytest.approx(2e3 * PSI, rel=1e-9)
    assert units.Force.read("2 lbf") == pytest.approx(2 * POUND * GRAVITY, rel=1e-9)
    assert units.Length.read("3 in") == pytest.approx(3 * INCH, rel=1e-12)
    assert units.Velocity.read("36 km/h") == 10.0
    assert units.Temperature.read("-40 degC") == 233.15
    assert units.Temperature.read("-40 degF") == pytest.approx(233.15, rel=1e-12)
