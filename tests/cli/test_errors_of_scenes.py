"""Errors of scenes name the key as it stands in the file, and the value as typed."""

import tomllib
from pathlib import Path
from typing import Literal

import pytest

import elastomdr as em
from elastomdr.checks import one_of
from elastomdr.cli.kinds import decoded
from elastomdr.cli.main import main
from elastomdr.cli.schema import accepted
from elastomdr.cli.units import shown_beside
from elastomdr.errors import Amount, InputError, amount

BODY = """
material = "epdm-70"
temperature = "20 degC"
[indenter]
shape = "sphere"
radius = "5 mm"
[contact]
load = "10 N"
velocity = "1 m/s"
"""
ROUGH = """
material = "epdm-70"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_height = "3 um"
longest = "200 um"
shortest = "4 um"
"""
LEAK = f"""{ROUGH}
[leak]
pressure = "1 MPa"
pressure_drop = "2 bar"
viscosity = "0.05 Pa s"
length = "1 mm"
"""
SLIDES = f"""{ROUGH}
[contact]
pressure = "1 MPa"
velocity = "1 m/s"
"""
ROAD = """
[heat]
conductivity = "0.25 W/(m K)"
heat_capacity = "2 MJ/(m^3 K)"
[heat.road]
"""
SPAN = 'velocity = { from = "5 m/s", to = "1 m/s", points = 3 }'
WAVE = "[surface] shortest"
CASES = {
    "a key of a nested table": (
        ("friction", SLIDES + ROAD + 'conductivity = "-1.5 W/(m K)"'),
        ("[heat.road] conductivity", "-1.5 W/(m K)"),
    ),
    "a missing key of a nested table": (
        ("friction", SLIDES + ROAD + 'conductivity = "1.5 W/(m K)"'),
        ("[heat.road] heat_capacity", None),
    ),
    "a value beside a preset": (
        ("friction", SLIDES + ROAD + 'preset = "glass"\nconductivity = "1 W/(m K)"'),
        ("[heat.road] conductivity", "1 W/(m K)"),
    ),
    "a preset that is not known": (
        ("friction", SLIDES + ROAD + 'preset = "wood"'),
        ("[heat.road] preset", "wood"),
    ),
    "a width beside a preset": (
        (
            "friction",
            SLIDES + '[adhesion]\npreset = "rubber on a road"\nwidth = 0.2',
        ),
        ("[adhesion] width", 0.2),
    ),
    "a span the wrong way round": (
        ("friction", BODY.replace('velocity = "1 m/s"', SPAN)),
        ("[contact] velocity", "5 m/s"),
    ),
    "a wave that is too short": (
        ("friction", SLIDES.replace('"4 um"', '"0.5 mm"')),
        (WAVE, "0.5 mm"),
    ),
    "a wave beyond the rolloff": (
        ("friction", SLIDES.replace('"4 um"', '"60 um"\nrolloff = "50 um"')),
        (WAVE, "60 um"),
    ),
    "a rolloff beyond the longest wave": (
        ("friction", SLIDES.replace('"4 um"', '"4 um"\nrolloff = "1 mm"')),
        ("[surface] rolloff", "1 mm"),
    ),
    "a key that is missing in the call": (
        ("leak", LEAK.replace('length = "1 mm"', "")),
        ("[leak] length", None),
    ),
    "another key that is missing in the call": (
        ("leak", LEAK + 'outlet_pressure = "1 bar"'),
        ("[leak] molar_mass", None),
    ),
    "two keys of which one is enough": (
        ("friction", BODY.replace('load = "10 N"', 'load = "10 N"\ndepth = "1 mm"')),
        ("[contact] depth", "1 mm"),
    ),
    "a value that the call refuses": (
        ("leak", LEAK.replace('"2 bar"', '"3 MPa"')),
        ("[leak] pressure_drop", "3 MPa"),
    ),
    "one of a list that the call refuses": (
        ("leak", LEAK.replace('"2 bar"', '["2 bar", "3 MPa"]')),
        ("[leak] pressure_drop", "3 MPa"),
    ),
    "a temperature outside of the shift table": (
        ("leak", LEAK.replace('"20 degC"', '"200 degC"')),
        ("temperature", "200 degC"),
    ),
    "one of a span that the call refuses": (
        (
            "leak",
            LEAK.replace('"2 bar"', '{ from = "2 MPa", to = "8 MPa", points = 3 }'),
        ),
        ("[leak] pressure_drop", "8e+06 Pa"),
    ),
}


def computed(verb, content):
    scene = decoded(verb, content)
    with scene.in_keys():
        return getattr(em, scene.called())(**scene.arguments(Path()))


@pytest.mark.parametrize("case", CASES)
def test_errors_name_key_and_value_as_typed(case):
    (verb, text), (argument, got) = CASES[case]
    with pytest.raises(InputError) as refused:
        computed(verb, tomllib.loads(text))
    assert refused.value.argument == argument
    assert refused.value.got == got


@pytest.mark.parametrize(
    ("wrong", "near"),
    [("longst", "longest"), ("hurts", "hurst"), ("first", None), ("wave", None)],
)
def test_only_near_misses_are_offered(wrong, near):
    text = SLIDES.replace("longest", wrong) if near else SLIDES + f"{wrong} = 1"
    with pytest.raises(InputError) as refused:
        decoded("friction", tomllib.loads(text))
    assert ("Did you mean" in refused.value.hint) == bool(near)
    assert near is None or repr(near) in refused.value.hint
    assert refused.value.hint == refused.value.hint.strip()


def test_the_ends_of_a_span_are_called_as_in_the_file():
    with pytest.raises(InputError) as refused:
        decoded("friction", tomllib.loads(BODY.replace('velocity = "1 m/s"', SPAN)))
    assert [place for _, place in refused.value.places] == [""]
    assert refused.value.subject == "from"


@pytest.mark.parametrize("typed", ["0 mm", "1e-101 m", "1e101 m"])
def test_lengths_are_positive_and_may_be_squared(typed):
    """Before a call is made of them."""
    text = BODY.replace('radius = "5 mm"', f'radius = "{typed}"')
    assert typed in text
    with pytest.raises(InputError) as refused:
        decoded("friction", tomllib.loads(text))
    assert refused.value.got == typed


@pytest.mark.parametrize(
    ("case", "amounts"),
    [
        ("a wave that is too short", ["0.2 mm"]),
        ("a wave beyond the rolloff", ["50 um"]),
        ("a rolloff beyond the longest wave", ["0.2 mm"]),
        ("a value that the call refuses", ["1 MPa"]),
        ("a temperature outside of the shift table", ["-10 degC", "60 degC"]),
    ],
)
def test_what_is_accepted_is_in_the_unit_typed(
    case, amounts, capsys, tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    (verb, text), _ = CASES[case]
    table = em.ShiftTable([263.15, 293.15, 333.15], [2.0, 0.0, -1.0])
    em.save_material(em.Prony(1e6, [2e6], [1e-2], shift=table), Path("rubber.toml"))
    Path("scene.toml").write_text(text.replace("epdm-70", "rubber.toml"))
    assert main([verb, "scene.toml"]) == 2
    said = capsys.readouterr().err.split(", got ")[0]
    assert all(amount in said for amount in amounts)


def test_amounts_without_a_usual_unit_are_in_si():
    said = InputError(argument="x", accepted="below " + amount(0.25, "m"), got="1 inch")
    words = said.words(shown=shown_beside(said.got))
    assert "0.25 m," in words
    assert '"1 inch"' in words
    assert shown_beside("2 km/h")(Amount(10.0, "m/s")) == "36 km/h"
    assert shown_beside("293 K")(Amount(300.0, "K")) == "300 K"
    assert shown_beside(None)(Amount(300.0, "K")) == "26.85 degC"


def test_one_word_is_no_choice():
    with pytest.raises(InputError) as refused:
        one_of("way", "up", "down")
    assert refused.value.accepted == "'down'"
    assert accepted((Literal["cylinder"],)) == "cylinder"
    assert accepted((Literal["cone", "sphere"],)) == "one of cone, sphere"
