"""Scenes with values that nobody means: each is read, or refused by its key."""

import copy
import math
import random
import re
import tomllib
from pathlib import Path

import pytest

from elastomdr.cli.kinds import KINDS, decoded
from elastomdr.cli.schema import keys_of
from elastomdr.cli.sweep import assembled
from elastomdr.errors import InputError

SCENES = sorted(Path(__file__).parents[2].glob("examples/scenes/*.toml"))
HOSTILE = [
    True,
    0,
    -1,
    10**30,
    math.nan,
    math.inf,
    "",
    "no",
    "1 mm",
    "-3 mm",
    "0 N",
    "20 %",
    "1e400 m",
    "nan m/s",
    "1 m" + "x" * 5000,
    "a/" * 2500,
    "a\0b",
    [],
    [[]],
    ["0 N", "5 mm"],
    [0, "1 mm"],
    ["20 %", "30 %"],
    [1.0, None],
    {},
    {"from": "1 m", "to": 0},
    {"a": [1]},
    [{}],
    [{"load": "1 mm"}, 3],
    {"vary": {"a": 5}},
]


def verb_of(path):
    return re.search(r"elastomdr (\w+) ", path.read_text())[1]


def places(content, before=()):
    """The keys and entries of a scene, by their steps."""
    for step, value in (
        content.items() if isinstance(content, dict) else enumerate(content)
    ):
        yield (*before, step)
        if isinstance(value, (dict, list)):
            yield from places(value, (*before, step))


def keys(tables, before=()):
    """The keys that a scene may have, whether the example has them or not."""
    for table in tables:
        for name, key in keys_of(table).items():
            yield (*before, name)
            if len(before) < 3:
                yield from keys(key.tables, (*before, name))


def changed(content, steps, value):
    content = copy.deepcopy(content)
    *tables, last = steps
    place = content
    for step in tables:
        if isinstance(place, dict):
            place.setdefault(step, {})
        place = place[step]
        place = place[0] if isinstance(place, list) and isinstance(last, str) else place
    place[last] = value
    return content


def read(verb, content, folder):
    """What a command does with a scene before it computes."""
    if verb == "sweep":
        assembled(content, folder)
    else:
        decoded(verb, content).arguments(folder)


def every(path):
    """What is done to a scene: each of its keys, and each that it might have, with each
    value.
    """
    verb, content = verb_of(path), tomllib.loads(path.read_text())
    kinds = KINDS.get(verb, ())
    kind = next((kind for kind in kinds if kind.fits(content)), (*kinds, None)[-1])
    steps = {*places(content), *(keys([kind]) if kind else ())}
    return verb, content, [(s, v) for s in sorted(steps, key=str) for v in HOSTILE]


def wrong(path, count=None):
    verb, content, cases = every(path)
    if count is not None:
        cases = random.Random(path.stem).sample(cases, min(count, len(cases)))
    found = []
    for steps, value in cases:
        try:
            scene = changed(content, steps, value)
        except (TypeError, AttributeError, IndexError, KeyError):
            continue  # a table of the example is no table
        try:
            read(verb, scene, path.parent)
        except InputError:
            continue
        except Exception as error:
            found.append(
                (steps, str(value)[:40], f"{type(error).__name__}: {error}"[:200])
            )
    return found


@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_a_hostile_value_is_refused_by_its_key(path):
    assert not wrong(path, 60)


@pytest.mark.slow
@pytest.mark.parametrize("path", SCENES, ids=[path.stem for path in SCENES])
def test_every_hostile_value_at_every_key(path):
    assert not wrong(path)
