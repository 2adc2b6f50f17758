"""What an editor and a type checker see of the package."""

import ast
import dataclasses
import importlib
import inspect
import pickle
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import elastomdr as em


@pytest.mark.parametrize("package", [em, em.fit], ids=["elastomdr", "elastomdr.fit"])
def test_the_stub_names_what_the_package_has(package):
    stub = Path(str(package.__file__)).with_suffix(".pyi")
    named = {}
    for node in ast.parse(stub.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            home = "." * node.level + (node.module or "")
            named |= {str(alias.asname): home for alias in node.names}
        elif isinstance(node, ast.AnnAssign):
            named[ast.unparse(node.target)] = None
    assert sorted(named) == sorted(package.__all__)
    for name, module in named.items():
        if module:
            home = importlib.import_module(module, package.__name__)
            assert getattr(package, name) is getattr(home, name)


DEFENDED = {
    # each verb has a plan of its own, and several materials a tuple of them
    "Result.plan",
    "Result.to_dict()",  # arrays and texts by name
    # those of `plot`, which each class of results has of its own
    "Result.interactive(options)",
    "save_material(info)",
    "calibrate(scene)",  # any other argument of the verb
    "sweep(fixed)",
    # the arguments of the verb that asks the model
}


def annotated(
    node: ast.stmt, within: str = ""
) -> Iterator[tuple[str, ast.expr | None]]:
    """Names of fields, arguments and answers in the source of a class or function, with
    their annotations.
    """
    if isinstance(node, ast.ClassDef):
        for inner in node.body:
            yield from annotated(inner, f"{node.name}.")
    elif isinstance(node, ast.AnnAssign):
        name = ast.unparse(node.target)
        if not name.startswith("_"):
            yield within + name, node.annotation
    elif isinstance(node, ast.FunctionDef) and (
        not node.name.startswith("_") or node.name in ("__init__", "__call__")
    ):
        of = node.args
        for given in (*of.posonlyargs, *of.args, of.vararg, *of.kwonlyargs, of.kwarg):
            if given is not None and given.arg not in ("self", "cls"):
                yield f"{within}{node.name}({given.arg})", given.annotation
        if node.name != "__init__":
            yield f"{within}{node.name}()", node.returns


def sources(value: Any) -> Iterator[Any]:
    """What a public name is made of: a function, or a class with those of this package
    that it derives from.
    """
    if inspect.isclass(value):
        yield from (
            base
            for base in value.__mro__
            if base.__module__.split(".")[0] == "elastomdr"
        )
    elif callable(value):
        yield inspect.unwrap(value)


def test_any_in_a_public_signature_is_defended():
    public = [
        getattr(package, name)
        for package in (em, em.fit, em.reference, em.elements)
        for name in package.__all__
    ]
    found, bare, count = set(), set(), 0
    for source in {each for value in public for each in sources(value)}:
        for name, annotation in annotated(ast.parse(inspect.getsource(source)).body[0]):
            count += 1
            if annotation is None:
                bare.add(name)
            elif re.search(r"\bAny\b", ast.unparse(annotation)):
                found.add(name)
    assert count > 1000
    assert not bare, "not annotated at all"
    assert found == DEFENDED


def test_errors_have_what_they_say_as_attributes():
    """Argument, value and what is accepted; also after a way through pickle, as from a
    worker of Dask.
    """
    with pytest.raises(em.InputError) as raised:
        em.friction(
            em.Prony(1e6, [1e6], [1.0]), em.Sphere(-1.0), velocity=1.0, load=1.0
        )
    for error in (raised.value, pickle.loads(pickle.dumps(raised.value))):
        assert str(error) == "radius must be positive and finite, got -1."
        assert (error.argument, error.got) == ("radius", -1.0)
        assert (error.accepted, error.hint) == ("positive and finite", "")
    with pytest.raises(em.InputError) as raised:
        em.load_material("epdm-70").at(20.0)
    assert raised.value.argument == "temperature"
    assert raised.value.hint.startswith("20 degC is 293.15 K")
    with pytest.raises(TypeError):
        em.InputError("a sentence")  # pyright: ignore[reportCallIssue]


EVERY = (
    "error model_error converged extrapolated doubts to_csv to_dict to_pandas to_xarray "
    "to_excel plot summary"
)


@pytest.mark.parametrize(
    ("result", "names"),
    [
        (
            em.FrictionCurve,
            "velocity mu normal_force friction_force depth contact model plan hysteresis"
            " adhesion area_ratio temperature_rise uncertainty elements law",
        ),
        (em.RollingCurve, "coefficient resistance moment power"),
        (
            em.Leak,
            "rate conductance mean_gap critical_gap area_ratio percolates fluid_pressure",
        ),
        (
            em.Lubricated,
            "mu viscous asperity film_thickness least_film flow pressure",
        ),
        (
            em.Reciprocating,
            "film_out film_in net_leak friction_out friction_in",
        ),
        (
            em.Indentation,
            "edge_speed work_factor zone_ratio pull_off jump_in loop_energy",
        ),
        *(
            (each, "")
            for each in (
                em.BreakOut, em.Conveyor, em.Dissipation, em.Drive, em.FrictionSpectrum,
                em.HeatBuildUp, em.Impact, em.ORing, em.RoughContact, em.Shear, em.Slide,
                em.Stability, em.Traction,
            )
        ),
    ],
)  # fmt: skip
def test_results_have_what_users_were_promised(result, names):
    has = {*dir(result), *(field.name for field in dataclasses.fields(result))}
    assert not {*f"{EVERY} {names}".split()} - has
