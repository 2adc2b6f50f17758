"""A parameter can be followed from the front door to the formula that it enters, by
"find references": each function of a walk is called, with what was made of the
parameter, by the one before, or by an earlier one to which that has returned; none by a
room below it.

`python -m tests.house.test_walks` prints the walks.
"""

import ast
import itertools
from functools import cache
from pathlib import Path
from typing import Any

import pytest

import elastomdr as em

from .test_structure import FLOORS

SOURCE = Path(em.__file__).parent
MOST = 15  # functions of a walk
STEADY = "call.problem.rough_scene call.problem.steady_scene"
ROAD = f"""verbs.friction.friction verbs.roads.friction_by
    rough.surface.surface_friction rough.surface._set_up {STEADY}"""
WALKS = {
    "friction:pressure": f"""{ROAD} rough.surface._solved
        rough.road_models._ClosedIntegrals.solve rough.multiscale.friction
        rough.multiscale.solve rough.multiscale._in_batches rough.multiscale._evaluate
        rough.road_models.Multiscale.waves rough.multiscale.waves_of_multiscale""",
    "friction:temperature": f"""{ROAD} material.shift.thermal_factors
        material.shift.AbstractShift.a material.shift.WLF._log10_a""",
    "rolling:velocity": """verbs.rolling.rolling verbs.steady.steady_contact
        smooth.problem.set_up call.problem.steady_scene smooth.problem.solve
        smooth.solve.run smooth.solve._over_directions smooth.solve._direct
        smooth.solve._solve_new smooth.solve._solve smooth.solve._in_batches
        smooth.passage.solve_passages smooth.passage._forces
        smooth.passage_integrals.forces smooth.passage_integrals._contact""",
    "leak:pressure": """seal.leak.leak seal.leak._seal seal.leak._checked
        seal.along.even seal.along._line seal.along._asked
        seal.leak_form.FittedChannels.flow seal.leak_form._numbers
        seal.persson_gap.contact_of rough.multiscale.rate_of""",
    "lubricated:velocity": """seal.lubricated.lubricated seal.lubricated._checked
        seal.lubricated._group seal.lubricated._case seal.film.follow seal.film._walk
        seal.film.Case.with_parameter seal.film.solve seal.film._newton
        seal.film._balance""",
}


@cache
def at(place: str) -> ast.FunctionDef:
    """The function at "room.file.name" or "room.file.Class.name"."""
    room, file, *names = place.split(".")
    found: Any = ast.parse((SOURCE / room / f"{file}.py").read_text("utf-8"))
    for name in names:
        (found,) = (n for n in found.body if getattr(n, "name", "") == name)
    return found


def names(*nodes: ast.AST) -> set[str]:
    every = itertools.chain(*map(ast.walk, nodes))
    return {n.id for n in every if isinstance(n, ast.Name)}


def made_of(function: ast.FunctionDef, got: set[str]) -> set[str]:
    """The names in a function that hold something of its parameters `got`."""
    steps = [
        (names(n.value), names(*n.targets))
        for n in ast.walk(function)
        if isinstance(n, ast.Assign)
    ] + [
        (names(n.iter), names(n.target))
        for n in ast.walk(function)
        if isinstance(n, ast.For | ast.comprehension)
    ]
    for _ in steps:
        got = got.union(*(made for given, made in steps if given & got))
    return got


def handed_on(
    function: ast.FunctionDef, got: set[str], to: ast.FunctionDef
) -> set[str]:
    """The parameters of the function `to` that get something of the names `got`."""
    takes, called = [a.arg for a in to.args.args], {to.name}
    for n in ast.walk(function):  # f = one if ... else another
        if isinstance(n, ast.Assign) and isinstance(n.value, ast.IfExp):
            called |= names(*n.targets) if to.name in names(n.value) else set()
    found: set[str] = set()
    for call in (n for n in ast.walk(function) if isinstance(n, ast.Call)):
        owner = call.func.value if isinstance(call.func, ast.Attribute) else None
        if getattr(call.func, "attr", getattr(call.func, "id", "")) not in called:
            continue
        given = [owner, *call.args] if takes[0] == "self" else call.args
        found |= {a for a, x in zip(takes, given, strict=False) if x and names(x) & got}
        found |= {k.arg for k in call.keywords if k.arg and names(k.value) & got}
        if any(isinstance(x, ast.Starred) and names(x) & got for x in given if x):
            found |= {*takes}
    return found


@pytest.mark.parametrize("walk", WALKS)
def test_a_walk_is_never_lost(walk):
    way = WALKS[walk].split()
    assert len(way) <= MOST
    first, parameter = walk.split(":")
    assert way[0].endswith(f".{first}")
    passed = {way[0]: made_of(at(way[0]), {parameter})}
    for place in way[1:]:
        for caller, got in reversed(passed.items()):
            if taken := handed_on(at(caller), got, at(place)):
                break
        else:
            pytest.fail(f"{walk} is lost before {place}")
        above, below = (FLOORS.index(x.split(".")[0]) for x in (caller, place))
        assert below <= above, f"{walk} climbs from {caller} to {place}"
        passed[place] = made_of(at(place), taken)


if __name__ == "__main__":
    for walk, way in WALKS.items():
        print(f"{walk}: {len(way.split())} functions", *way.split(), sep="\n  ")
