"""An argument can be followed from the front door to the formula that it enters, by
"find references": field by field, as `call.asked.pressure`, through the functions of a
walk, of which each gets it from one before, by every call there; none in a room below
that of its caller.

Followed are names, fields of records, keys of a literal dictionary and places of a
tuple. What a function makes of a number is a number that counts as it; what a function
that is not of the walk makes of a record is lost.

`python -m tests.house.test_walks` prints the walks.
"""

import ast
import itertools
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import pytest

import elastomdr as em

from .test_structure import FLOORS

SOURCE = Path(em.__file__).parent
MOST = 16  # functions of a walk
# each function, and as what the argument arrives there
ROAD = """verbs.roads.friction_by:call.asked.{0}
    rough.surface.surface_friction:call.asked.{0} rough.surface._check:call.asked.{0}
    call.problem.rough_scene:asked.{0} call.problem.steady_scene:asked.{0}"""
WALKS = {
    "friction:pressure": f"""verbs.friction.friction:pressure {ROAD.format("pressure")}
        rough.surface._solve:problem.pressure
        rough.road_models._ClosedIntegrals.solve:problem.pressure
        rough.multiscale.friction:problem.pressure
        rough.multiscale.solve:problem.pressure
        rough.road_model.RoadProblem.of:self.pressure
        rough.multiscale._in_batches:problem.pressure
        rough.multiscale._evaluate:pressure
        rough.road_models.Multiscale.waves:problem.pressure
        rough.multiscale.waves_of_multiscale:problem.pressure""",
    "friction:temperature": f"""verbs.friction.friction:temperature
        {ROAD.format("temperature")} material.shift.thermal_factors:temperature
        material.shift.AbstractShift.a:temperature
        material.shift.WLF._log10_a:temperature""",
    "rolling:velocity": """verbs.rolling.rolling:velocity
        verbs.rolling._rolled:call.asked.velocity
        verbs.steady.steady_contact:call.asked.velocity
        smooth.problem.check:call.asked.velocity
        call.problem.steady_scene:asked.velocity
        smooth.problem.solve:scene.points.reduced
        smooth.problem.SmoothScene.reduced:self.points.reduced
        smooth.solve.run:velocity smooth.solve._over_directions:velocity
        smooth.solve._direct:velocity smooth.solve._solve_new:velocity
        smooth.solve._solve:velocity smooth.solve._in_batches:velocity
        smooth.passage.solve_passages:velocity smooth.passage._edges:p.velocity
        smooth.passage.under_parabola:p.velocity""",
    "leak:pressure": """seal.leak.leak:pressure seal.leak._seal:pressure
        seal.leak._check:arguments.pressure seal.along.even:pressure
        seal.along._line:pressure seal.along._asked:relative_pressure
        seal.leak_form.FittedChannels.flow:relative_pressure
        seal.leak_form._numbers:relative_pressure
        seal.persson_gap.contact_of:relative_pressure
        rough.multiscale.rate_of:pressure""",
    "lubricated:velocity": """seal.lubricated.lubricated:velocity
        seal.lubricated._check:asked.velocity checks.positive_arrays:arguments.velocity
        seal.lubricated._solve:scene.velocity seal.lubricated._case:scene.velocity
        seal.film.follow:cases.parameter seal.film._walk:case.parameter
        seal.film.Case.with_parameter:parameter seal.film.solve:contact.parameter
        seal.film._newton:contact.parameter seal.film._balance:contact.parameter""",
}
# doors that are broken: what a function hands on, and what in its place
BROKEN = [
    ("friction:pressure", "friction.friction", "depth, pressure", "pressure, depth"),
    ("friction:pressure", "steady_scene", "asked.pressure", "asked.depth"),
    ("friction:pressure", "surface_friction", "scene.value", "scene.velocity"),
    ("friction:pressure", "_in_batches", "problem.pressure", "problem.rtol"),
    ("friction:temperature", "steady_scene", "asked.temperature", "asked.direction"),
    (
        "friction:temperature",
        "thermal_factors",
        "shift.a(temperature)",
        "shift.a(body)",
    ),
    ("rolling:velocity", "rolling.rolling", "velocity, load", "load, velocity"),
    ("rolling:velocity", "SmoothScene.reduced", "points.reduced", "points.vertical"),
    ("rolling:velocity", "solve_passages", "rule, velocity)", "rule, value)"),
    ("rolling:velocity", "_over_directions", "load, velocity, 0", "load, load, 0"),
    ("rolling:velocity", "_over_directions", "velocity[left]", "load[left]"),
    (
        "rolling:velocity",
        "solve.run",
        "(load), np.asarray(velocity)",
        "(load), value",
    ),
    (
        "rolling:velocity",
        "solve.run",
        "control, value, velocity",
        "control, value, value",
    ),
    (
        "rolling:velocity",
        "solve._solve",
        "control, value, velocity)",
        "control, value, value)",
    ),
    ("rolling:velocity", "solve._solve", "velocity[left]", "value[left]"),
    ("rolling:velocity", "_solve_new", "load, velocity))", "load, load))"),
    (
        "rolling:velocity",
        "_in_batches",
        "control, value, velocity)",
        "control, value, value)",
    ),
    ("rolling:velocity", "_in_batches", "velocity[batch]", "value[batch]"),
    ("leak:pressure", "leak._seal", "_Seal(pressure", "_Seal(length"),
    ("leak:pressure", "_numbers", "contact_of(fine, batch", "contact_of(fine, fine"),
    (
        "leak:pressure",
        "_numbers",
        "contact_of(coarse, batch",
        "contact_of(coarse, coarse",
    ),
    ("leak:pressure", "leak.leak", "given.pressure, given", "given.length, given"),
    ("lubricated:velocity", "_check", "flat['velocity']", "flat['load']"),
    ("lubricated:velocity", "_case", "scene.velocity", "scene.load"),
]
# a record stays what it is
KEEPS = {"replace", "replaced", "_replace", "_asdict", "items", "values"}

PLACES = ("[", *"0123456789")
Path_ = tuple[str | int, ...]  # of fields, () for a number
Held = frozenset[Path_]
NOTHING: Held = frozenset()


@cache
def trees() -> dict[str, ast.Module]:
    return {
        ".".join(path.relative_to(SOURCE).with_suffix("").parts): ast.parse(
            path.read_text("utf-8")
        )
        for path in SOURCE.rglob("*.py")
    }


def home_of(place: str) -> str:
    """The file of a function."""
    return next(home for home in trees() if place.startswith(f"{home}."))


def is_method(place: str) -> bool:
    return "." in place.removeprefix(f"{home_of(place)}.")


def is_property(function: ast.FunctionDef) -> bool:
    return any(ast.unparse(x) == "property" for x in function.decorator_list)


@cache
def names_of(home: str) -> dict[str, tuple[str, str]]:
    """What a file imports of the package: where from, and its name there."""
    room = home.split(".")[0]
    found = {}
    for node in ast.walk(trees()[home]):
        if isinstance(node, ast.ImportFrom) and node.level:
            base = [room] * (node.level == 1) + (node.module or "").split(".")
            base = ".".join(filter(None, base))
            found |= {n.asname or n.name: (base, n.name) for n in node.names}
    return found


def at(place: str) -> ast.FunctionDef:
    """The function at "room.file.name" or "room.file.Class.name"."""
    home = home_of(place)
    found: ast.AST = trees()[home]
    for name in place.removeprefix(f"{home}.").split("."):
        (found,) = (
            n for n in getattr(found, "body", []) if getattr(n, "name", "") == name
        )
    assert isinstance(found, ast.FunctionDef)
    return found


@cache
def records() -> dict[str, list[str]]:
    """The fields of each class of the package, in their order."""
    return {
        node.name: [
            f.target.id
            for f in node.body
            if isinstance(f, ast.AnnAssign) and isinstance(f.target, ast.Name)
        ]
        for tree in trees().values()
        for node in ast.walk(tree)
        if isinstance(node, ast.ClassDef)
    }


def plain(part: str | int) -> str:
    """A field, or the key of a dictionary without its brackets."""
    return str(part).strip("[]'")


def number(*held: Held) -> Held:
    """What a formula makes of what it is given."""
    return frozenset({()} if any(() in h for h in held) else ())


def field(held: Held, name: str | int) -> Held:
    return frozenset(p[1:] for p in held if p[:1] == (name,))


def within(held: Held, name: str | int) -> Held:
    return frozenset((name, *p) for p in held)


def element(held: Held) -> Held:
    """Of any place of a tuple or key of a dictionary, of a list, or of an array."""
    return frozenset(p[1:] if p and str(p[0]).startswith(PLACES) else p for p in held)


Changed = dict[str, ast.FunctionDef]
Entered = tuple[str, frozenset]  # a function, with what its parameters hold
Got = dict[str, dict[ast.expr, set[str]]]  # by each function, from each call of it


class Walk:
    """The functions of a walk, which are entered where one calls another."""

    def __init__(self, functions: Changed):
        self.functions = functions
        self.got: dict[Entered, Got] = {}
        self.known: dict[Entered, Held] = {}

    def handed(self, caller: str, name: str) -> Got:
        """What each function gets of one that holds nothing but `name`."""
        root, *path = name.split(".")
        given: dict[str, Held] = {root: frozenset({tuple(path)})}
        self.enter(caller, given)
        return self.got[caller, frozenset(given.items())]

    def enter(self, place: str, given: dict[str, Held]) -> Held:
        """What a function returns."""
        key = place, frozenset(given.items())
        if key not in self.known:
            self.known[key], self.got[key] = NOTHING, {}  # of a call of itself
            self.known[key] = Frame(self, place, given, self.got[key]).run()
        return self.known[key]

    def called(self, name: str, owner: ast.expr | None, by: str) -> str | None:
        """The function of the walk that a call in a function means."""
        home = home_of(by)
        imported = names_of(home)
        if owner is None:
            home, name = imported.get(name, (home, name))
        elif isinstance(owner, ast.Name) and owner.id in imported:
            home = ".".join(imported[owner.id]).removeprefix(".")
        else:
            found = filter(is_method, self.functions)
            return next((p for p in found if p.endswith(f".{name}")), None)
        place = f"{home}.{name}"
        return place if place in self.functions else None


class Frame:
    """One call of a function: what its names hold."""

    def __init__(
        self,
        walk: Walk,
        place: str,
        given: dict[str, Held],
        got: Got,
    ):
        self.walk, self.place, self.env, self.got = walk, place, dict(given), got
        self.inner: dict[str, ast.FunctionDef] = {}
        self.returns: dict[str, Held] = {}

    def run(self) -> Held:
        function = self.walk.functions[self.place]
        for node in ast.walk(function):
            if isinstance(node, ast.FunctionDef) and node is not function:
                self.inner[node.name] = node
        before = None
        while before != (self.env, self.returns):
            before = dict(self.env), dict(self.returns)
            self.block(function.body, "")
        return self.returns.get("", NOTHING)

    def hold(self, name: str, held: Held) -> None:
        self.env[name] = self.env.get(name, NOTHING) | held

    def block(self, body: list[ast.stmt], inside: str) -> None:
        for node in body:
            match node:
                case ast.FunctionDef():
                    self.block(node.body, node.name)
                case ast.Return(value=ast.expr() as value):
                    held = self.returns.get(inside, NOTHING)
                    self.returns[inside] = held | self.held(value)
                case ast.Assign():
                    for target in node.targets:
                        self.bind(target, self.held(node.value))
                case (
                    ast.AnnAssign(value=ast.expr() as value)
                    | ast.AugAssign(value=value)
                ):
                    self.bind(node.target, self.held(value))
                case ast.For():
                    self.bind(node.target, element(self.held(node.iter)))
                case _:
                    for inner in ast.iter_child_nodes(node):
                        if isinstance(inner, ast.expr):
                            self.held(inner)
            for part in ("body", "orelse", "finalbody"):
                if not isinstance(node, ast.FunctionDef):
                    self.block(getattr(node, part, []), inside)

    def bind(self, target: ast.expr, held: Held) -> None:
        match target:
            case ast.Name(id=name):
                self.hold(name, held)
            case ast.Tuple(elts=parts) | ast.List(elts=parts):
                for i, part in enumerate(parts):
                    whole = frozenset(p for p in held if not p)
                    self.bind(part, field(held, i) | whole)
            case ast.Subscript(value=ast.Name(id=name)):
                self.hold(name, held)

    def held(self, node: ast.expr | None) -> Held:
        match node:
            case ast.Name(id=name):
                return self.env.get(name, NOTHING)
            case ast.Attribute(value=value, attr=name):
                held = self.held(value)
                if name in ("size", "shape", "ndim", "dtype"):
                    return NOTHING
                place = self.walk.called(name, value, self.place)
                own = field(held, name) | number(held)
                if own or place is None or not is_property(self.walk.functions[place]):
                    return own
                return self.enter(node, place, {"self": held})
            case ast.Subscript(value=value, slice=part):
                held, _ = self.held(value), self.held(part)
                if isinstance(part, ast.Constant) and isinstance(part.value, str | int):
                    number_or_key = part.value, f"[{part.value!r}]"
                    one = self.join(field(held, x) for x in number_or_key)
                    return one | (held & element(held))
                return element(held)
            case ast.Call():
                return self.call(node)
            case ast.Tuple(elts=parts):
                return self.join(
                    element(self.held(x)) if isinstance(x, ast.Starred)
                    else within(self.held(x), i)
                    for i, x in enumerate(parts)
                )  # fmt: skip
            case ast.List(elts=parts) | ast.BoolOp(values=parts):
                return self.join(map(self.held, parts))
            case ast.Starred(value=value) | ast.NamedExpr(value=value):
                return self.held(value)
            case ast.IfExp(body=one, orelse=other, test=test):
                self.held(test)
                return self.held(one) | self.held(other)
            case ast.Dict(keys=keys, values=values):
                return self.join(
                    within(self.held(x), f"[{k.value!r}]") if isinstance(k, ast.Constant)
                    else self.held(x)
                    for k, x in zip(keys, values, strict=True)
                )  # fmt: skip
            case (
                ast.ListComp(elt=one) | ast.GeneratorExp(elt=one) | ast.SetComp(elt=one)
            ):
                self.over(node.generators)
                return self.held(one)
            case ast.DictComp(key=key, value=one, generators=[loop]):
                over, pair = loop.iter, loop.target
                same = isinstance(pair, ast.Tuple) and ast.dump(pair.elts[0]).replace(
                    "Store", "Load"
                ) == ast.dump(key)
                if same and isinstance(over, ast.Call):  # of items(): key by key
                    return self.held(over)
                self.over(node.generators)
                return self.held(one)
            case ast.Lambda(body=body):
                self.held(body)
                return NOTHING
            case None:
                return NOTHING
        parts = [n for n in ast.iter_child_nodes(node) if isinstance(n, ast.expr)]
        return number(*map(self.held, parts))

    def over(self, loops: list[ast.comprehension]) -> None:
        for loop in loops:
            self.bind(loop.target, element(self.held(loop.iter)))
            for test in loop.ifs:
                self.held(test)

    @staticmethod
    def join(parts: Iterable[Held]) -> Held:
        return frozenset(itertools.chain(*parts))

    def call(self, node: ast.Call) -> Held:
        owner = node.func.value if isinstance(node.func, ast.Attribute) else None
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        own = NOTHING if owner is None else self.held(owner)
        place = self.walk.called(name, owner, self.place)
        if name in self.env and place is None:
            place = self.chosen(name)
        if name in self.inner:
            takes = [a.arg for a in self.inner[name].args.args]
            for parameter, held in self.given(node, takes, 0).items():
                self.hold(parameter, held)
            return self.returns.get(name, NOTHING)
        if place is not None:
            arguments = self.walk.functions[place].args
            takes = [a.arg for a in (*arguments.args, *arguments.kwonlyargs)]
            bound = is_method(place)
            given = self.given(node, takes, bound)
            if bound:
                given[takes[0]] = own
            return self.enter(node, place, given)
        if name in records() and records()[name]:
            given = self.given(node, records()[name], 0)
            return self.join(within(held, key) for key, held in given.items())
        held = [self.held(x) for x in node.args]
        named = {k.arg: self.held(k.value) for k in node.keywords}
        if name in KEEPS:
            whole = held[0] if owner is None or name == "replace" else own
            kept = frozenset(p for p in whole if not p or p[0] not in named)
            return kept | self.join(within(h, k) for k, h in named.items() if k)
        if name == "broadcast_shape":  # a shape is none of the numbers that have it
            return NOTHING
        return number(own, *held, *named.values())

    def enter(self, call: ast.expr, place: str, given: dict[str, Held]) -> Held:
        given = {k: v for k, v in given.items() if v}
        got = self.got.setdefault(place, {}).setdefault(call, set())
        for key, held in given.items():
            got |= {".".join(map(plain, (key, *path))) for path in held}
        return self.walk.enter(place, given) if given else NOTHING

    def chosen(self, name: str) -> str | None:
        """The function of the walk that `name = one if ... else other` may be."""
        for node in ast.walk(self.walk.functions[self.place]):
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.IfExp):
                for one in (node.value.body, node.value.orelse):
                    if (
                        isinstance(one, ast.Name)
                        and ast.unparse(node.targets[0]) == name
                    ):
                        place = self.walk.called(one.id, None, self.place)
                        if place is not None:
                            return place
        return None

    def given(self, node: ast.Call, takes: list[str], skip: int) -> dict[str, Held]:
        """What each parameter gets."""
        found: dict[str, Held] = {}
        position = skip
        for x in node.args:
            held = self.held(x)
            if isinstance(x, ast.Starred):
                for i, name in enumerate(takes[position:]):
                    found[name] = found.get(name, NOTHING) | field(held, i)
                continue
            if position < len(takes):
                found[takes[position]] = held
            position += 1
        for k in node.keywords:
            held = self.held(k.value)
            if k.arg is None:
                for name in takes:
                    found[name] = self.join(
                        (found.get(name, NOTHING), field(held, f"[{name!r}]"))
                    )
            else:
                found[k.arg] = held
        return found


class Lost(Exception):
    """No function before hands an argument on, or some call of one does not."""


def doors(
    walk: str, changed: Changed | None = None, first: str | None = None
) -> list[tuple[str, str]]:
    """The nearest caller of each function of a walk, and the function. A parameter that
    is lost at any call on the way raises `Lost`.
    """
    way = [tuple(step.split(":")) for step in WALKS[walk].split()]
    functions = {place: at(place) for place, _ in way} | (changed or {})
    found, whole = [], Walk(functions)
    for i, (place, arrives) in enumerate(way[1:], 1):
        callers = {}
        for caller, name in way[:i]:
            held = first if first and caller == way[0][0] else name
            calls = whole.handed(caller, held).get(place, {})
            if calls:
                callers[caller] = all(arrives in got for got in calls.values())
        if not callers or not all(callers.values()):
            raise Lost(f"{walk} is lost before {place}")
        found.append(([*callers][-1], place))
    return found


@pytest.mark.parametrize("walk", WALKS)
def test_a_walk_is_never_lost(walk):
    found = doors(walk)
    assert len(found) < MOST
    for caller, place in found:
        above, below = (FLOORS.index(x.split(".")[0]) for x in (caller, place))
        assert below <= above, f"{walk} climbs from {caller} to {place}"


@pytest.mark.parametrize("walk", WALKS)
def test_no_other_parameter_goes_the_same_way(walk):
    verb, asked = at(WALKS[walk].split(":")[0]), walk.split(":")[1]
    others = {a.arg for a in (*verb.args.args, *verb.args.kwonlyargs)} - {asked}
    assert len(others) > 6
    for other in {*others, "colour"}:
        with pytest.raises(Lost):
            doors(walk, first=other)


@pytest.mark.parametrize(("walk", "function", "door", "other"), BROKEN)
def test_a_broken_door_loses_it(walk, function, door, other):
    places = [step.split(":")[0] for step in WALKS[walk].split()]
    (place,) = (x for x in places if x.endswith(f".{function}"))
    parts = ast.unparse(at(place)).split(door)
    assert len(parts) > 1
    for i in range(1, len(parts)):  # each alone
        text = door.join(parts[:i]) + other + door.join(parts[i:])
        (changed,) = ast.parse(text).body
        assert isinstance(changed, ast.FunctionDef)
        with pytest.raises(Lost):
            doors(walk, {place: changed})


@pytest.mark.parametrize("walk", WALKS)
def test_every_function_hands_it_on(walk):
    """Without what it got no function can call the next ones."""

    class Dropped(ast.NodeTransformer):
        def visit_Name(self, node: ast.Name) -> ast.AST:
            return ast.Constant(None) if node.id == root else node

    arrives = dict(step.split(":") for step in WALKS[walk].split())
    for caller in {caller for caller, _ in doors(walk)}:
        root = arrives[caller].split(".")[0]
        (changed,) = ast.parse(ast.unparse(at(caller))).body
        assert isinstance(changed, ast.FunctionDef)
        changed.body = [Dropped().visit(node) for node in changed.body]
        with pytest.raises(Lost):
            doors(walk, {caller: changed})


if __name__ == "__main__":
    for walk, way in WALKS.items():
        print(f"{walk}: {len(way.split())} functions", *way.split(), sep="\n  ")
        doors(walk)
