"""Models answer for themselves: a road model that stands outside of the package runs
through `em.friction`, and nothing inside asks which model it has.
"""

import ast
import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import elastomdr as em
from elastomdr import models
from elastomdr.rough.road_model import SurfaceFriction, SurfaceModel

SOURCE = Path(em.__file__).parent
LAW = em.WLF(17.4, 51.6, 250.0)
RUBBER = em.Prony(1e6, [1e-4, 1e-2], [2e7, 5e6], shift=LAW)
ROAD = em.SelfAffine(hurst=0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)
SCENE: dict[str, Any] = {"velocity": [1e-2, 1.0], "pressure": 3e5, "temperature": 300.0}


@dataclasses.dataclass(frozen=True)
class Toy(SurfaceModel):
    """mu is a share of the loss tangent at the longest wave; a tenth touches."""

    share: float = 0.5
    label = "toy"

    def words(self):
        return f"toy road, {self.share:g} of the loss tangent"

    def solve(self, problem):
        omega = problem.surface.q_low * problem.velocity
        modulus = problem.foundation.complex_modulus(omega)
        mu = self.share * modulus.imag / modulus.real
        area = np.full(mu.shape, 0.1)
        return SurfaceFriction(mu, area, 0.01 * mu, mu > 0, 0.02 * area)

    def bound(self, foundation, surface, velocity, area, of_area=False):
        return np.full(np.shape(area), 0.4 if of_area else 0.3)


def loss_tangent(curve):
    reduced = curve.velocity * LAW.a(curve.temperature)
    modulus = RUBBER.complex_modulus(ROAD.q_low * reduced)
    return modulus.imag / modulus.real


def test_a_road_model_from_outside_answers():
    curve: Any = em.friction(RUBBER, ROAD, model=Toy(share=0.25), **SCENE)
    np.testing.assert_allclose(curve.mu, 0.25 * loss_tangent(curve), rtol=1e-12)
    np.testing.assert_array_equal(curve.area_ratio, [0.1, 0.1])
    np.testing.assert_array_equal(curve.error, 0.01 * curve.mu)
    np.testing.assert_array_equal(curve.model_error, curve.mu * 0.3)
    assert curve.model == "toy road, 0.25 of the loss tangent"
    assert curve.converged.all()


def test_its_plan_and_its_area():
    plan = em.plan(RUBBER, ROAD, model=Toy(), **SCENE)
    assert "toy road, 0.5 of the loss tangent" in str(plan)
    shear = em.AdhesiveShear(1e6, 1e-2, 2.0)
    curve: Any = em.friction(RUBBER, ROAD, model=Toy(), adhesion=shear, **SCENE)
    stress = shear.shear_stress(curve.velocity, curve.temperature)
    np.testing.assert_allclose(curve.adhesion, 0.1 * stress / 3e5, rtol=1e-12)


def test_what_it_does_not_follow_is_said():
    """One temperature for all scales under heat; with a softening it is linear, and
    its distance from three dimensions is not known.
    """
    heat = em.Heat(conductivity=0.2, heat_capacity=1.7e6)
    hot: Any = em.friction(RUBBER, ROAD, model=Toy(), heat=heat, **SCENE)
    assert hot.model.endswith("the mean over the length scales of Multiscale")
    assert (hot.temperature_rise > 0).all()
    softening = em.Softening([1e-3, 0.1], [1.0, 0.5], [1.0, 0.7])
    soft = dataclasses.replace(RUBBER, softening=softening)
    curve: Any = em.friction(soft, ROAD, model=Toy(), **SCENE)
    assert np.isnan(curve.model_error).all()
    assert "linear" in curve.model


def test_it_has_the_temperatures_of_multiscale_on_either_branch():
    rubber = em.Prony(
        8e5,
        8e5 * np.geomspace(400, 0.2, 12),
        np.geomspace(1e-10, 10, 12),
        shift=em.WLF(8.9, 101.6, 293.15),
    )
    road = em.SelfAffine(0.8, rms_slope=0.8, q_low=1e3, q_high=1e5)
    shear = em.AdhesiveShear(4e7, 1e-4, 0.4, shift=em.Arrhenius(1.5e5, 293.15))
    scene: Any = {"velocity": 0.015, "pressure": 3e5, "temperature": 263.0}
    scene |= {"heat": em.Heat(0.25, 1.8e6), "adhesion": shear}
    for branch, least, most in (("cold", 1.0, 25.0), ("hot", 30.0, 500.0)):
        found, exact = (
            em.friction(rubber, road, model=model, branch=branch, **scene)
            for model in (Toy(), em.Multiscale())
        )
        assert found.other_states
        assert least < found.contact_rise < most
        assert found.contact_rise == pytest.approx(float(exact.contact_rise))
        warm = em.friction(
            rubber,
            road,
            model=Toy(),
            velocity=0.015,
            pressure=3e5,
            temperature=263.0 + float(found.temperature_rise),
        )
        assert found.hysteresis == pytest.approx(float(warm.mu), rel=1e-12)


def test_without_a_bound_its_model_error_is_not_known():
    plain: Any = type("Plain", (Toy,), {"bound": SurfaceModel.bound})
    curve: Any = em.friction(RUBBER, ROAD, model=plain(), **SCENE)
    assert np.isnan(curve.model_error).all()


@pytest.mark.parametrize("given", [{"load": 10.0}, {}])
def test_it_is_for_a_surface_under_a_pressure(given):
    scene = {**SCENE, "pressure": None, **given}
    with pytest.raises(em.InputError, match=r"model must be em.Line\(\)"):
        em.friction(RUBBER, ROAD, model=Toy(), **scene)
    with pytest.raises(em.InputError, match="model must be"):
        em.friction(RUBBER, em.Sphere(0.01), velocity=1.0, load=1.0, model=Toy())


def model_classes():
    """Names of all classes of models."""
    waiting = [models.Model]
    while waiting:
        kind = waiting.pop()
        if kind.__module__.startswith("elastomdr."):
            yield kind.__name__
            waiting += kind.__subclasses__()


def asked(path, names):
    """Lines of a file in which an object is asked for its class of model."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and ast.unparse(node.func) in (
            "isinstance",
            "issubclass",
        ):
            words = {
                word.id if isinstance(word, ast.Name) else word.attr
                for word in ast.walk(node.args[1])
                if isinstance(word, (ast.Name, ast.Attribute))
            }
            if words & names:
                yield f"{path.relative_to(SOURCE)}:{node.lineno}"


def test_a_model_without_a_solution_is_refused_when_it_is_made():
    class Unfinished(SurfaceModel):
        label = "unfinished"

        def words(self):
            return "words only"

    with pytest.raises(TypeError, match="solve"):
        Unfinished()


def test_nothing_asks_which_model_it_has():
    """But the register and the check of arguments."""
    names = set(model_classes())
    assert {"Line", "HalfSpace", "Persson"} <= names
    answers = {
        SOURCE / "models.py",
        SOURCE / "call" / "model_choice.py",
        SOURCE / "verbs" / "roads.py",
    }
    assert all(list(asked(path, names)) for path in answers)
    wrong = [
        place
        for path in sorted(SOURCE.rglob("*.py"))
        if path not in answers
        for place in asked(path, names)
    ]
    assert not wrong, wrong


@pytest.mark.parametrize(
    ("name", "value"),
    [("samples", -3), ("samples", 63), ("periods", 0), ("equivalent_length", -1.0)],
)
def test_a_line_refuses_what_is_none_when_it_is_made(name, value):
    with pytest.raises(em.InputError) as refusal:
        em.Line(**{name: value})
    assert refusal.value.argument == name


def test_every_model_of_a_smooth_body_is_offered():
    for verb in (em.friction, em.rolling):
        with pytest.raises(em.InputError) as refusal:
            verb(RUBBER, em.Sphere(0.01), velocity=1.0, load=1.0, model=em.Persson())
        assert "em.Marched()" in str(refusal.value.accepted)
    with pytest.raises(em.InputError) as refusal:
        em.rolling(
            em.layer(RUBBER, 0.01),
            em.Cylinder(0.01, 0.1),
            velocity=1.0,
            load=1.0,
            model=em.Persson(),
        )
    assert "em.Marched()" not in str(refusal.value.accepted)
