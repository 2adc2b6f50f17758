"""The schema of scene files: units, and the keys as help and documentation show
them.
"""

import dataclasses
import re
from pathlib import Path

import pytest

import elastomdr as em
from elastomdr.cli.bodies import HeatTable, ShearOfContact
from elastomdr.cli.keys import as_text, sections
from elastomdr.cli.kinds import KINDS
from elastomdr.cli.main import main
from elastomdr.cli.schema import decode
from elastomdr.cli.units import (
    USUAL,
    InputError,
    Length,
    SceneQuantity,
    Temperature,
    Velocity,
)
from elastomdr.trees import same
from elastomdr.verbs.roads import KINDS as MODELS

from ..refused import refused


def quantities(kind=SceneQuantity):
    return [
        kind,
        *(below for child in kind.__subclasses__() for below in quantities(child)),
    ]


def test_a_preset_of_a_scene_is_that_of_python():
    def made(table, **entry):
        return next(iter(decode(table, entry).arguments(Path()).values()))

    road = {"preset": "steel"}
    both = made(HeatTable, preset="filled rubber", road=road)
    assert same(both, em.Heat.preset(road="steel"))
    own = {"conductivity": "0.3 W/(m K)", "heat_capacity": "2 MJ/(m^3 K)"}
    half = made(HeatTable, **own, road=road)
    assert same(half, em.Heat(0.3, 2e6, road="steel"))
    other = made(HeatTable, preset="filled rubber", road=own)
    assert same(other, em.Heat.preset(road=(0.3, 2e6)))
    moves = {"energy": "90 kJ/mol", "reference": "20 degC"}
    law = made(ShearOfContact, preset="rubber on a road", **moves)
    shift = em.Arrhenius(9e4, 293.15)
    assert same(law, em.AdhesiveShear.preset(shift=shift))
    assert same(
        made(ShearOfContact, stress="6 MPa", velocity="5 mm/s", width=0.1, **moves),
        em.AdhesiveShear(6e6, 5e-3, 0.1, shift=shift),
    )
    with refused("velocity", "preset"):
        made(ShearOfContact, stress="6 MPa")


def test_usual_units_are_those_of_pint():
    import pint

    registry = pint.UnitRegistry()
    for unit, usual in USUAL.items():
        kind = next(kind for kind in quantities()[1:] if kind.unit == unit)
        for name in usual:
            expected = (
                registry.Quantity(3.7, registry.parse_units(name.replace("m2", "m^2")))
                .to(unit)
                .magnitude
            )
            assert kind.convert("3.7", name) == pytest.approx(expected, rel=4e-16), name


def test_decimal_numbers_are_converted_exactly():
    assert Length.read("100 um") == 1e-4
    assert Length.read("0.3 mm") == 3e-4
    assert Temperature.read("20 degC") == 293.15
    assert Temperature.read("-35degC") == 238.15
    assert Velocity.read("3.6e-3 km/h") == 1e-3
    assert Length.read("1 inch") == pytest.approx(0.0254)  # by pint
    assert Temperature.read("77 degF") == pytest.approx(298.15)


@pytest.mark.parametrize("kind", quantities()[1:], ids=lambda kind: kind.__name__)
def test_examples_are_quantities_of_their_kind(kind):
    assert kind.read(kind.example) != 0
    with pytest.raises(InputError, match=re.escape(kind.what)):
        kind.read("5")


@pytest.mark.parametrize(
    "text",
    [
        "1e400 m",
        "-1e99999999999999999999 m",
        "1e-99999999999999999999 m",
        "0 mm",
        "-1 m",
    ],
)
def test_numbers_without_meaning(text):
    with pytest.raises(InputError, match=r"positive|between") as refused:
        Length.read(text)
    assert refused.value.got == text


def test_every_key_has_a_meaning():
    for verb, kinds in KINDS.items():
        for kind in kinds:
            for section in sections(kind):
                assert section.about
                assert section.keys
                for key in section.keys:
                    assert key.meaning, (verb, section.title, key.name)
                    assert key.accepted


def test_the_help_of_a_command_has_its_keys(capsys):
    for verb in KINDS:
        with pytest.raises(SystemExit) as done:
            main([verb, "--help"])
        assert done.value.code == 0
        assert capsys.readouterr().out.rstrip().endswith(as_text(verb).rstrip())


def test_options_of_models_are_keys_of_the_contact():
    (contact,) = (
        part for part in sections(KINDS["friction"][0]) if part.title == "[contact]"
    )
    keys = {key.name for key in contact.keys}
    for model in MODELS.values():
        assert {field.name for field in dataclasses.fields(model)} <= keys
