"""A material by its storage and loss moduli: values, error, derivatives, files,
surfaces, and what refuses it.
"""

import os
import warnings
from pathlib import Path

import equinox as eqx
import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.call.extrapolation import excited_outside
from elastomdr.element.law import as_foundation, surface_foundation
from elastomdr.errors import InputError
from elastomdr.material.library import material_info
from elastomdr.material.validity import Range, misfit, misfit_bands, shared

from ..io.dma_files import RUBBER, data
from ..refused import mentions, refused
from .check import check_material

DATA = Path(
    os.environ.get(
        "ELASTOMDR_DATA", Path(__file__).parents[3] / "shared" / "data" / "dma"
    )
)
KELVIN = 293.15
SURFACE = em.SelfAffine(0.8, rms_height=1e-4, q_low=1e3, q_high=1e6)
SLIDING = {"pressure": 3e5, "velocity": np.geomspace(1e-3, 1.0, 5)}
FORM = em.Persson(stored=True)
LIBRARY = ("sbr-gum-like", "tread-passenger-synthetic", "epdm-70", "psa-468mp")


def sampled(material, per_decade, low=-4.0, high=9.0, **properties):
    omega = np.logspace(low, high, round((high - low) * per_decade) + 1)
    modulus = material.complex_modulus(omega)
    return em.TabulatedModulus(omega, modulus.real, modulus.imag, **properties)


@pytest.fixture(scope="module")
def table():
    return sampled(RUBBER, 10, -2, 6, shift=RUBBER.shift, name="table", citation="Here")


@pytest.mark.parametrize("per_decade", [4, 8, 10, 20])
@pytest.mark.parametrize("name", LIBRARY)
def test_the_stated_error_bounds_the_interpolation(name, per_decade):
    material = em.load_material(name)
    ends = np.log10([0.1 / material.times[-1], 10 / material.times[0]])
    found = sampled(material, per_decade, *ends)
    omega = np.geomspace(found.omega[0], found.omega[-1], 5001)
    exact, stated = material.complex_modulus(omega), found.interpolation_error()
    off = (
        abs(found.storage(omega) / exact.real - 1),
        abs(found.loss(omega) / exact.imag - 1),
    )
    for error, bound in zip(off, stated, strict=True):
        assert error.max() < bound < 0.06 * (4 / per_decade) ** 2
    if per_decade == 10:
        assert max(error.max() for error in off) < 4e-4
    np.testing.assert_allclose(
        found.complex_modulus(found.omega),
        material.complex_modulus(found.omega),
        rtol=1e-12,
    )
    np.testing.assert_allclose(
        found.loss_tangent(omega), found.loss(omega) / found.storage(omega), rtol=1e-12
    )


def test_the_stated_error_bounds_that_of_uneven_points():
    material, rng = em.load_material("epdm-70"), np.random.default_rng(0)
    for _ in range(5):
        omega = 10 ** (np.arange(-3, 9, 0.125) + 0.1 * rng.uniform(-0.5, 0.5, 96))
        modulus, between = (
            material.complex_modulus(omega),
            np.geomspace(omega[0], omega[-1], 5001),
        )
        found, exact = (
            em.TabulatedModulus(omega, modulus.real, modulus.imag),
            material.complex_modulus(between),
        )
        storage, loss = found.interpolation_error()
        assert abs(found.storage(between) / exact.real - 1).max() < storage
        assert abs(found.loss(between) / exact.imag - 1).max() < loss


def test_the_error_between_two_frequencies(table):
    low, high = np.array([1e-2, 1e2, 1e7]), np.array([1e6, 1e3, 1e8])
    storage, loss = table.interpolation_error(low, high)
    whole = table.interpolation_error()
    assert (storage[0], loss[0]) == whole
    assert storage[1] <= whole[0]
    assert np.isnan(storage[2])  # beyond the table nothing is known
    assert np.isnan(loss[2])
    few = em.TabulatedModulus([1.0, 10.0, 100.0], [1e6, 2e6, 4e6], [1e5, 1e5, 1e5])
    np.testing.assert_allclose(few.storage(10**0.5), np.sqrt(2) * 1e6)
    np.testing.assert_allclose(few.interpolation_error(), 0.0, atol=1e-12)  # power laws
    two = few.thinned()[0]
    np.testing.assert_allclose(
        two.interpolation_error([[0.0], [2.0]], 3.0)[0][:, 0],
        np.expm1(np.log(100) ** 2 / 4),
    )
    one, other = table.thinned()
    np.testing.assert_array_equal(one.omega, table.omega[::2])
    np.testing.assert_array_equal(
        other.omega, np.append(table.omega[[0]], [*table.omega[1::2], table.omega[-1]])
    )


def test_scatter_does_not_bend_the_curve():
    """Dense points that scatter, and two close together beside a gap: close to the
    straight lines.
    """
    rng, omega = (
        np.random.default_rng(0),
        np.sort(10 ** np.random.default_rng(1).uniform(-2, 6, 300)),
    )
    modulus = RUBBER.complex_modulus(omega)
    scatter = np.exp(0.03 * rng.normal(size=(2, 300)))
    found = em.TabulatedModulus(
        omega, scatter[0] * modulus.real, scatter[1] * modulus.imag
    )
    between = np.geomspace(omega[0], omega[-1], 20001)
    for curve, values in (
        (found.storage, found.storage_table),
        (found.loss, found.loss_table),
    ):
        line = np.interp(np.log(between), np.log(omega), np.log(values))
        assert abs(np.log(curve(between)) - line).max() < 0.03
    pair = em.TabulatedModulus(
        [0.3, 1.0, 1.01, 2.0, 6.0],
        np.array([1, 1, 1.1, 1.1, 1.2]) * 1e6,
        np.full(5, 1e5),
    )
    assert pair.storage(np.geomspace(1.01, 2.0, 100)).max() < 1.2e6


@pytest.mark.parametrize("name", LIBRARY)
def test_a_solid_bends_by_one_at_most(name):
    """What limits the slopes: |d^2 ln M/d(ln omega)^2| <= 1, hence interpolation by
    straight lines within h^2/8.
    """
    for solid in (
        em.load_material(name),
        em.KelvinVoigt(1e6, 1e3),
        em.Maxwell(1e6, 1e-3),
    ):
        u = np.linspace(-15, 25, 8001)
        for part in (solid.storage(np.exp(u)), solid.loss(np.exp(u))):
            assert (
                abs(np.gradient(np.gradient(np.log(part), u), u)[2:-2]).max() < 1 + 1e-6
            )


def test_beyond_the_table_moduli_are_held(table):
    omega = np.array([0.0, 1e-9, 1e9])
    np.testing.assert_allclose(
        table.storage(omega), table.storage_table[[0, 0, -1]], rtol=1e-12
    )
    np.testing.assert_allclose(
        table.loss(omega), [0.0, table.loss_table[0], table.loss_table[-1]], rtol=1e-12
    )


def test_kinds():
    shear = sampled(RUBBER, 8, poisson=0.4)
    tensile = shear.tensile()
    assert (shear.kind, tensile.kind) == ("shear", "tensile")
    assert shear.shear() is shear
    assert tensile.tensile() is tensile
    np.testing.assert_allclose(
        tensile.storage(3.0), 2.8 * shear.storage(3.0), rtol=1e-12
    )
    np.testing.assert_allclose(tensile.shear().loss_table, shear.loss_table, rtol=1e-12)
    ratio = em.half_space(tensile).complex_modulus(3.0) / shear.complex_modulus(3.0)
    np.testing.assert_allclose(ratio, 2 / 0.6, rtol=1e-12)
    np.testing.assert_allclose(
        em.half_space(tensile).complex_modulus(3.0) / tensile.complex_modulus(3.0),
        1 / (1 - 0.16),
        rtol=1e-12,
    )
    sheared = em.half_space(shear, tangential=True)
    np.testing.assert_allclose(sheared.loss(3.0) / shear.loss(3.0), 4 / 1.6, rtol=1e-12)


def test_a_temperature_shifts_it(table):
    warm, factor = table.at(313.15), float(RUBBER.shift.a(313.15))
    np.testing.assert_allclose(warm.loss(3.0 / factor), table.loss(3.0), rtol=1e-10)
    np.testing.assert_allclose(warm.range.omega, np.array(table.range.omega) / factor)
    assert warm.shift is None
    with refused("temperature", 300.0, "shift="):
        warm.at(300.0)


def test_repr(table):
    assert repr(table) == (
        "TabulatedModulus('table', shear, 81 points, 0.01..1e+06 rad/s, storage "
        "4e+05..2.004e+07 Pa)"
    )
    assert repr(em.half_space(table)).startswith(
        "TabulatedFoundation('table', 81 points"
    )
    assert "traced or a batch" in repr(jax.tree.map(lambda x: np.stack([x, x]), table))


def test_derivatives_against_finite_differences():
    exact = sampled(RUBBER, 5, -1, 3)
    start = [np.array(x) for x in (exact.omega, exact.storage_table, exact.loss_table)]
    at = np.array([0.05, 0.37, 4.1, 88.0, 2e3])
    weights = np.linspace(1.0, 2.0, 5)

    def value(omega, storage, loss, where=at):
        found = em.half_space(
            em.TabulatedModulus(omega, storage, loss)
        ).complex_modulus(where)
        return (weights * (found.real / 1e6 + found.imag / 1e5)).sum()

    with jax.enable_x64(True):
        gradients = [
            np.asarray(x)
            for x in jax.jit(jax.grad(value, argnums=(0, 1, 2, 3)))(*start, at)
        ]
        mapped = jax.jit(jax.vmap(lambda s: value(start[0], s, start[2])))(
            np.stack([start[1], 2 * start[1]])
        )
        compiled = jax.jit(lambda m: m.loss(at))(exact)
    np.testing.assert_allclose(mapped[0], value(*start), rtol=1e-12)
    np.testing.assert_allclose(compiled, exact.loss(at), rtol=1e-12)
    arguments, h = [*start, at], 1e-6
    for which, gradient in enumerate(gradients):
        for k in range(len(arguments[which])):
            ends = []
            for sign in (1, -1):
                moved = [x.copy() for x in arguments]
                moved[which][k] *= 1 + sign * h
                ends.append(value(*moved))
            slope = (ends[0] - ends[1]) / (2 * h)
            np.testing.assert_allclose(
                gradient[k] * arguments[which][k], slope, rtol=1e-6, atol=1e-6
            )


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            {"omega": [1.0, 1.0, 3.0]},
            ("omega", 1),
        ),
        ({"storage": [1e6, -1e6, 1e6]}, ("storage", "-1e")),
        ({"loss": [1e5, 0.0, 1e5]}, ("loss", 0)),
        (
            {"loss": [1e5, 1e5]},
            ("", 3),
        ),
        ({"omega": [1.0], "storage": [1.0], "loss": [1.0]}, ("", 3, "entries")),
        ({"kind": "bulk"}, ("kind", "'shear'", "'tensile'", "'bulk'")),
        ({"poisson": 0.6}, ("poisson", -1, 0.5, 0.6)),
        ({"shift": 3}, ("shift", "WLF")),
        ({"name": 3}, ("name", 3)),
        ({"range": {"omega": (2, 1)}}, ("range",)),
    ],
)
def test_bad_input(change, words):
    good = {
        "omega": [1.0, 2.0, 3.0],
        "storage": [1e6, 2e6, 3e6],
        "loss": [1e5, 1e5, 1e5],
    }
    with refused(*words):
        em.TabulatedModulus(**(good | change))


BALL, LINE = (
    em.Paraboloid(5e-3),
    em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e3).line(samples=64),
)
REFUSED = {
    "as_foundation": as_foundation,
    "layer": lambda m: em.springs(m, 1e-3),
    "other": lambda m: em.half_space(RUBBER, m),
    "half_space": lambda m: em.half_space(m, RUBBER),
    "friction": lambda m: em.friction(m, BALL, velocity=1.0, load=1.0),
    "rough line": lambda m: em.friction(m, LINE, velocity=1.0, load=1.0),
    "plan": lambda m: em.plan(m, BALL, velocity=1.0, load=1.0),
    "rolling": lambda m: em.rolling(m, BALL, velocity=1.0, load=1.0),
    "heat_build_up": lambda m: em.heat_build_up(
        m, em.Cylinder(0.1, 1.0), velocity=1.0, load=1.0, ambient=293.0, conductance=1.0
    ),
    "indent": lambda m: em.indent(m, BALL, time=[0.0, 1.0], depth=1e-4),
    "impact": lambda m: em.impact(m, BALL, mass=1e-3, velocity=1.0),
    "slide": lambda m: em.slide(
        m, BALL, time=[0.0, 1.0], position=[0.0, 1e-3], load=1.0
    ),
    "shear": lambda m: em.shear(
        m, BALL, time=[0.0, 1.0], displacement=1e-4, depth=1e-4, friction=0.5
    ),
    "traction": lambda m: em.traction(
        m, BALL, velocity=1.0, friction=0.5, depth=1e-4, creepage=0.01
    ),
    "o_ring": lambda m: em.o_ring(m, diameter=5e-3, squeeze=0.2),
    "leak": lambda m: em.leak(
        m,
        SURFACE,
        pressure=3e5,
        pressure_drop=1e5,
        viscosity=1.0,
        length=1.0,
        time=1.0,
    ),
    "lubricated": lambda m: em.lubricated(
        m, em.Cylinder(5e-3, 1.0), velocity=1.0, load=1.0, viscosity=1.0
    ),
    "half-space": lambda m: em.reference.half_space_sliding(
        m, BALL, velocity=1.0, load=1.0
    ),
    "card": em.fit.abaqus_card,
    "plain card": em.fit.plain_card,
    "calibrate": lambda m: em.fit.calibrate(
        m, BALL, velocity=[1.0], measured=[0.5], parameters=["modulus"], load=1.0
    ),
}


@pytest.mark.parametrize("verb", REFUSED)
def test_what_has_a_history_or_a_smooth_body_refuses_it(verb, table):
    for body in (table, em.half_space(table)):
        with pytest.raises(InputError) as error:
            REFUSED[verb](body)
        said = str(error.value)
        assert "a Prony series" in said
        assert (
            f"got Tabulated{'Modulus' if body is table else 'Foundation'}('table'"
            in said
        )
        assert mentions(said, "em.fit.prony")
        assert "\n" not in said


def test_surface_foundation(table):
    found = surface_foundation(table)
    assert surface_foundation(found) is found
    assert (found.per_area, found.name, found.range) == (False, "table", table.range)
    assert eqx.tree_equal(found.shift, table.shift)
    assert isinstance(surface_foundation(RUBBER), em.Foundation)
    layer = em.springs(em.Prony(1e6, [], [], poisson=0.4), 1e-3)
    assert surface_foundation(layer) is layer
    with pytest.raises(InputError, match="material must be a material"):
        surface_foundation(3)


@pytest.mark.parametrize(("per_decade", "within"), [(5, 1e-3), (10, 1e-4), (20, 1e-5)])
def test_persson_on_a_table_is_persson_on_its_series(per_decade, within):
    """The errors of interpolation change sign from point to point, and fall with the
    order of the cubics.
    """
    exact = em.friction(RUBBER, SURFACE, model=FORM, **SLIDING)
    found = em.friction(sampled(RUBBER, per_decade), SURFACE, model=FORM, **SLIDING)
    np.testing.assert_allclose(found.mu, exact.mu, rtol=within)
    np.testing.assert_allclose(found.area_ratio, exact.area_ratio, rtol=within)
    assert (abs(found.mu - exact.mu) < found.error).all()
    assert (found.error < 10 * within * found.mu).all()


def test_persson_at_a_temperature(table):
    one = em.friction(
        table, SURFACE, pressure=3e5, velocity=1e-3, temperature=303.15, model=FORM
    )
    other = em.friction(
        table.at(303.15), SURFACE, pressure=3e5, velocity=1e-3, model=FORM
    )
    # the same integrals with nodes that differ by the shift
    np.testing.assert_allclose(one.mu, other.mu, rtol=1e-8)


def test_full_contact_on_a_table():
    rubber = sampled(RUBBER, 20)
    found, exact = (
        em.reference.full_contact_sliding(m, LINE, velocity=[0.01, 0.1], load=1e5)
        for m in (rubber, RUBBER)
    )
    np.testing.assert_allclose(found, exact, rtol=1e-4)


def test_what_is_excited_beyond_the_table_is_flagged():
    narrow = sampled(RUBBER, 10, 2, 5)
    # q v from 1 to 1e3, from 50 to 5e4, from 1e4 to 1e7 rad/s
    reduced = np.array([1e-3, 0.05, 10.0])
    outside = excited_outside(narrow.range, SURFACE, reduced)
    assert narrow.range == Range((1e2, 1e5), None)
    assert outside[0] > 0.1
    assert outside[1] < 0.1
    assert outside[2] > 0.85
    given = sampled(
        RUBBER, 10, 2, 5, range={"omega": (1.0, 1e6), "temperature": (273.15, 303.15)}
    )
    assert given.range.omega == (1.0, 1e6)
    only = sampled(RUBBER, 10, 2, 5, range={"temperature": (273.15, 303.15)})
    assert only.range == Range((1e2, 1e5), (273.15, 303.15))


def test_a_file(table, tmp_path, capsys):
    path = tmp_path / "table.toml"
    known = table.range._replace(
        temperature=(263.15, 313.15), misfit=((1.0, 0.01, 0.02), (2.0, 0.03, 0.04))
    )
    graded = {"citation": "Here", "grade": "measured"}
    sources = dict.fromkeys(("moduli", "shift", "poisson", "range"), graded)
    properties = {
        "kind": "tensile",
        "poisson": 1 / 3,
        "shift": table.shift,
        "name": "table",
        "citation": "Here",
    }
    rubber = em.TabulatedModulus(
        table.omega, table.storage_table, table.loss_table, range=known, **properties
    )
    em.save_material(rubber, path, info={"description": "A table", "source": sources})
    again = em.load_material(path)
    assert eqx.tree_equal(again, rubber)
    assert again.range == known
    assert check_material(path) == []
    info = material_info(path)
    assert len(info["omega"]) == 81
    copy = tmp_path / "copy.toml"
    em.save_material(again, copy, info=info)
    assert copy.read_bytes() == path.read_bytes()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("loss = [1e5, 2e5, 3e5]", ""), "loss must be given"),
        (
            ("loss = [1e5, 2e5, 3e5]", "loss = [1e5, 2e5]"),
            "loss must be as long as omega, 3",
        ),
        (
            ("poisson = 0.5", "bulk = 2e9"),
            "bulk must be left",
        ),
        (
            ("poisson = 0.5", "poisson = 0.5\nviscosity = 1.0"),
            "viscosity must be left",
        ),
        (
            ("poisson = 0.5", "poisson = 0.5\ntimes = [1.0]"),
            "equilibrium must be given",
        ),
        (
            ("storage = [1e6", "storage = [-1e6"),
            "finite, got -1e",
        ),
        (("[misfit]", "[misfit]\nnoise = [1.0]"), "[misfit] noise"),
        (
            ("loss_residual = [0.1]", "loss_residual = []"),
            "[misfit] loss_residual",
        ),
        (
            ("loss_residual = [0.1]", "loss_residual = [-0.1]"),
            "both residuals",
        ),
    ],
)
def test_a_bad_file(change, words, tmp_path):
    path = tmp_path / "bad.toml"
    text = """
kind = "shear"
poisson = 0.5
omega = [1.0, 10.0, 100.0]
storage = [1e6, 2e6, 3e6]
loss = [1e5, 2e5, 3e5]
[misfit]
omega = [1.0]
storage_residual = [0.1]
loss_residual = [0.1]
"""
    path.write_text(text)
    assert isinstance(em.load_material(path), em.TabulatedModulus)
    path.write_text(text.replace(*change))
    with pytest.raises(InputError) as error:
        em.load_material(path)
    assert words in str(error.value)
    assert str(path) in str(error.value)


def test_the_check_of_a_table(tmp_path):
    path = tmp_path / "odd.toml"
    omega, storage = np.array([1e-3, 1.0, 1e3]), np.array([2e6, 1e6, 3e6])
    em.save_material(
        em.TabulatedModulus(
            omega, storage, 0.1 * storage, range={"omega": (1e-6, 1.0)}
        ),
        path,
    )
    findings = " | ".join(check_material(path))
    assert mentions(findings, "50%", 1, "rad/s")
    assert "range is wider" in findings


def test_misfit():
    rows = misfit_bands([1.0, 1.5, 100.0], [0.03, 0.05, 0.1], [0.1, -0.1, 0.2])
    # four bands a decade
    np.testing.assert_allclose(
        [row[0] for row in rows], [10**0.125, 10**2.125], rtol=5e-3
    )
    assert [row[1:] for row in rows] == [
        (round(float(np.hypot(0.03, 0.05) / 2**0.5), 4), 0.1),
        (0.1, 0.2),
    ]
    rubber = em.Prony(
        1e6,
        [1e6],
        [1.0],
        shift=em.WLF(6.0, 110.0, KELVIN),
        range=Range((1.0, 100.0), None, misfit=rows),
    )
    storage, loss = misfit(rubber, [0.1, 50.0, 0.1, 1e4], [10.0, 200.0, 1e3, 1e5])
    np.testing.assert_allclose(loss[:3], [0.1, 0.2, np.sqrt(0.025)])
    assert storage[1] == 0.1
    assert np.isnan([storage[3], loss[3]]).all()
    assert np.isnan(misfit(em.Prony(1e6, [1e6], [1.0]), 1.0, 10.0)).all()
    factor = float(rubber.shift.a(313.15))
    for body in (
        rubber.at(313.15),
        em.half_space(rubber.at(313.15)),
        surface_foundation(rubber.at(313.15)),
    ):
        assert misfit(body, 50.0 / factor, 200.0 / factor) == (0.1, 0.2)
    assert shared(rubber.range, Range(None, None)).misfit == rows


def test_a_fit_knows_its_misfit(tmp_path):
    noise = 0.02
    fit = em.fit.material(data(noise=noise), KELVIN, name="fitted")
    storage, loss = misfit(fit.material, 1.0, 1e4)
    assert 0.5 * noise < storage < 1.5 * noise
    assert 0.5 * noise < loss < 1.5 * noise
    whole = misfit(fit.material, 0.0, np.inf)
    for size, name in zip(whole, ("storage modulus", "loss modulus"), strict=True):
        # bands hold different numbers of points
        np.testing.assert_allclose(size, fit.misfit[name], rtol=0.2)
    em.save_material(fit.material, tmp_path / "fitted.toml", info=fit.info())
    assert em.load_material(tmp_path / "fitted.toml").range == fit.material.range
    master = fit.master
    alone = em.fit.prony(master.omega, master.storage, master.loss)
    assert misfit(alone.material, 1.0, 1e4)[0] < 1.5 * noise
    assert np.isfinite(misfit(em.load_material("epdm-70"), 1.0, 1e4)).all()


def test_a_master_curve_becomes_a_table():
    fit = em.fit.material(
        data(noise=0.01),
        KELVIN,
        name="measured",
        citation="The laboratory",
        poisson=0.45,
    )
    found = fit.tabulated()
    assert (found.name, found.citation, found.kind) == (
        "measured",
        "The laboratory",
        "shear",
    )
    assert found.shift is fit.material.shift
    assert found.poisson == 0.45
    assert (np.diff(found.omega) > 0).all()
    assert found.omega.size <= 8 * np.log10(found.omega[-1] / found.omega[0]) + 1
    assert found.range.omega == (found.omega[0], found.omega[-1])
    assert found.range.temperature == fit.material.range.temperature
    scatter = misfit(found, *found.range.omega)
    assert all(2e-3 < size < 1.5e-2 for size in scatter)
    assert all(error < 0.03 for error in found.interpolation_error())
    truth = RUBBER.at(KELVIN)
    inside = np.geomspace(*found.range.omega, 200)
    assert abs(found.loss(inside) / truth.loss(inside) - 1).max() < 0.06
    on_table, on_series, exact = (
        em.friction(m, SURFACE, model=FORM, **SLIDING).mu
        for m in (found, fit.material, truth)
    )
    np.testing.assert_allclose(on_table, exact, rtol=0.02)
    np.testing.assert_allclose(on_table, on_series, rtol=0.02)
    assert fit.tabulated(per_decade=4).omega.size < found.omega.size
    for bad in (0, 2.5, True):
        with refused("per_decade", "whole number"):
            fit.tabulated(per_decade=bad)


def test_a_tensile_master_curve_is_a_tensile_table():
    shear = data(noise=1e-3)
    stretched = em.fit.dma(
        shear.omega,
        3 * shear.storage,
        3 * shear.loss,
        shear.temperature,
        kind="tensile",
    )
    found = em.fit.material(stretched, KELVIN, poisson=0.5).tabulated()
    assert found.kind == "tensile"
    np.testing.assert_allclose(
        found.shear().storage(10.0), RUBBER.at(KELVIN).storage(10.0), rtol=0.01
    )


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_relaxation_makes_no_table():
    time = np.geomspace(1e-2, 1e2, 20)
    relaxing = em.fit.relaxation(time, RUBBER.relaxation(time), KELVIN, kind="shear")
    with refused("master", "loss moduli"):
        em.fit.material(relaxing, KELVIN).tabulated()


@pytest.mark.skipif(
    not DATA.is_dir(), reason="measured data are not here; set ELASTOMDR_DATA"
)
@pytest.mark.parametrize(
    ("file", "kelvin", "low", "high"),
    [
        ("epdm-70/tf_015p.csv", 298.15, 0.97, 1.03),
        ("psa-468mp/frequency_sweep_tts.txt", 303.15, 0.97, 1.03),
    ],
)
def test_from_measured_data_to_friction(file, kelvin, low, high):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.fit.FitWarning)
        fit = em.fit.material(em.read_dma(DATA / file), kelvin)
    found = fit.tabulated()
    on_table, on_series = (
        em.friction(m, SURFACE, model=FORM, **SLIDING) for m in (found, fit.material)
    )
    ratio = on_series.mu / on_table.mu
    assert on_table.converged.all()
    assert low < ratio.min()
    assert ratio.max() < high


@pytest.mark.parametrize("kind", ["shear", "tensile"])
@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_what_a_table_does_not_know_is_advised_and_the_advice_works(kind):
    found = sampled(RUBBER, 10, -2, 6, kind=kind)
    for name in ("relaxation", "creep_compliance", "instantaneous"):
        with refused("material", name) as caught:
            getattr(found, name)(1.0)
        advice = caught.value.hint.partition("fit one, ")[2]
        names = {
            "em": em,
            "omega": found.omega,
            "storage": found.storage_table,
            "loss": found.loss_table,
        }
        answer = getattr(eval(advice, names), name)
        if name == "relaxation":
            assert float(answer(1e-2)) == pytest.approx(
                float(RUBBER.relaxation(1e-2)), rel=0.02
            )


def test_a_dashpot_beside_the_glassy_modulus():
    material = em.KelvinVoigt(2e6, 1e3)
    assert material.instantaneous == material.relaxation(0.0) == 2e6
    assert material.creep_compliance(0.0) == 0
    assert material.creep_compliance(10.0) == pytest.approx(1 / 2e6)
    solid = em.StandardSolid(1e6, 4e6, 1e-2)
    assert float(solid.creep_compliance(0.0)) == pytest.approx(
        1 / float(solid.instantaneous), rel=1e-14
    )
