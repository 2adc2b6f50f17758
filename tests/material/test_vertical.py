"""Vertical shifts: at a temperature every verb gives what the same material, brought to
it, gives without one.
"""

import inspect

import jax
import numpy as np
import pytest

import elastomdr as em

from ..refused import mentions, refused
from .check import check_material

WLF = em.WLF(8.0, 90.0, 293.15)
TABLE = em.VerticalTable([233.0, 263.0, 293.15, 333.0], [0.85, 0.9, 1.0, 1.2])
SERIES = 1e6, [4e6, 2e6, 1e6], [1e-5, 1e-3, 0.1]
RUBBER = em.Prony(*SERIES, shift=WLF, vertical=TABLE)
WARM = 318.0
ROUGH = em.SelfAffine(hurst=0.8, rms_slope=0.5, q_low=1e3, q_high=1e4)
LINE = em.Line(samples=512, seeds=1)
BALL, ROLL = em.Sphere(0.01), em.Cylinder(0.05, 0.1)
SKEW = {"tangential_velocity": 0.5, "friction": 0.4, "rtol": 1e-2}


def test_entropic_and_table():
    law = em.EntropicVertical(293.15)
    np.testing.assert_allclose(
        law.b([233.15, 293.15, 353.15]),
        np.array([233.15, 293.15, 353.15]) / 293.15,
        rtol=1e-15,
    )
    np.testing.assert_allclose(TABLE.b(TABLE.temperature), TABLE.factor, rtol=1e-15)
    from scipy.interpolate import PchipInterpolator

    for factor in (TABLE.factor, [1.1, 1.0, 1.05, 1.02]):
        between = np.linspace(233.0, 333.0, 57)
        table = em.VerticalTable(TABLE.temperature, factor)
        np.testing.assert_allclose(
            table.b(between),
            PchipInterpolator(TABLE.temperature, factor)(between),
            rtol=1e-13,
        )
    assert repr(law) == "EntropicVertical(reference=293.15)"


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (lambda: em.EntropicVertical(-3.0), ("reference", "kelvin")),
        (lambda: em.VerticalTable([293.0], [1.0]), ("", 2, "entries")),
        (
            lambda: em.VerticalTable([293.0, 280.0], [1.0, 1.1]),
            ("temperature", "ascending"),
        ),
        (
            lambda: em.VerticalTable([273.0, 293.0], [1.0, 0.0]),
            ("factor", "positive"),
        ),
        (lambda: TABLE.b(340.0), ("temperature", 233, 333)),
        (
            lambda: em.Prony(*SERIES, vertical=1.1),
            ("vertical", "EntropicVertical"),
        ),
        (
            lambda: em.TabulatedModulus([1, 2, 3], [1, 2, 3], [1, 1, 1], vertical=WLF),
            ("vertical", "Entropic"),
        ),
        (
            lambda: em.half_space(RUBBER, em.Prony(*SERIES, shift=WLF)),
            ("other", "the vertical one of material"),
        ),
        (lambda: em.Prony(*SERIES).at(300.0), ("", "shift law")),
    ],
)
def test_what_has_no_meaning_is_refused(make, says):
    with refused(*says):
        make()


@pytest.mark.parametrize(
    "properties",
    [{}, {"kind": "tensile", "bulk": 5e7}, {"bulk": 2e8}, {"viscosity": 30.0}],
)
def test_at_scales_all_moduli(properties):
    rubber = em.Prony(*SERIES, shift=WLF, vertical=TABLE, **properties)
    a, b, omega = WLF.a(WARM), TABLE.b(WARM), np.logspace(-3, 6, 7)
    for kind in (rubber, rubber.shear(), rubber.tensile()):
        np.testing.assert_allclose(
            kind.at(WARM).complex_modulus(omega),
            b * kind.complex_modulus(a * omega),
            rtol=1e-12,
        )
    star = em.half_space(rubber)
    np.testing.assert_allclose(
        em.half_space(rubber.at(WARM)).complex_modulus(omega),
        b * star.complex_modulus(a * omega),
        rtol=1e-12,
    )
    table = em.TabulatedModulus(
        omega + 1,
        np.arange(1.0, 8),
        np.ones(7),
        kind="tensile",
        shift=WLF,
        vertical=TABLE,
    )
    for kind in (lambda m: m, lambda m: m.shear(), em.half_space):
        found, exact = kind(table.at(WARM)), kind(table)
        np.testing.assert_allclose(
            found.complex_modulus(omega),
            b * exact.complex_modulus(a * omega),
            rtol=1e-12,
        )
    assert rubber.at(WARM).vertical is None


def test_without_a_shift_law_times_stay():
    rubber = em.Prony(*SERIES, vertical=em.EntropicVertical(293.15))
    np.testing.assert_allclose(
        rubber.at(350.0).moduli, rubber.moduli * 350.0 / 293.15, rtol=1e-15
    )
    np.testing.assert_allclose(rubber.at(350.0).times, rubber.times, rtol=1e-15)


TIME = np.linspace(0, 0.02, 9)
VERBS = {
    "friction": lambda m, **t: em.friction(
        m, BALL, velocity=[1e-3, 0.1], load=2.0, **t
    ),
    "depth": lambda m, **t: em.friction(m, BALL, velocity=0.1, depth=2e-4, **t),
    "layer": lambda m, **t: em.friction(
        em.springs(m, 1e-3, bonded=False), ROLL, velocity=1.0, load=50.0, **t
    ),
    "rolling": lambda m, **t: em.rolling(m, BALL, velocity=0.1, load=2.0, **t),
    "dissipation": lambda m, **t: em.dissipation(m, BALL, velocity=0.1, load=2.0, **t),
    "traction": lambda m, **t: em.traction(
        m, BALL, velocity=1.0, creepage=0.01, friction=0.5, load=2.0, **t
    ),
    "multiscale": lambda m, **t: em.friction(
        m, ROUGH, velocity=[0.01, 1.0], pressure=3e5, **t
    ),
    "heat": lambda m, **t: em.friction(
        m, ROUGH, velocity=5.0, pressure=3e5, heat=em.Heat(0.2, 2e5), model=LINE, **t
    ),
    "line": lambda m, **t: em.friction(
        m, ROUGH, velocity=0.1, pressure=3e5, model=LINE, rtol=1e-4, **t
    ),
    "line, depth": lambda m, **t: em.friction(
        m, ROUGH, velocity=0.1, depth=1e-3, model=LINE, rtol=1e-4, **t
    ),
    "bands": lambda m, **t: em.friction_spectrum(
        m, ROUGH, velocity=0.1, pressure=3e5, model=LINE, **t
    ),
    "indent": lambda m, **t: em.indent(
        m, BALL, time=TIME, load=np.minimum(TIME * 200, 2.0), **t
    ),
    "adhesion": lambda m, **t: em.indent(
        m, BALL, time=TIME, load=2.0 - TIME * 50, adhesion=0.1, **t
    ),
    "impact": lambda m, **t: em.impact(
        m, BALL, mass=0.05, velocity=[0.5, 2.0], rtol=1e-2, **t
    ),
    "oblique": lambda m, **t: em.impact(m, BALL, mass=0.05, velocity=1.0, **SKEW, **t),
    "slide": lambda m, **t: em.slide(
        m, BALL, time=TIME, position=TIME * 0.1, load=2.0, rtol=1e-2, **t
    ),
    "persson": lambda m, **t: em.friction(
        m, ROUGH, pressure=3e5, velocity=0.1, model=em.Persson(), **t
    ),
    "half-space": lambda m, **t: em.reference.half_space_sliding(
        m, BALL, velocity=1e-4, load=0.5, points=32, **t
    ),
    "half-plane": lambda m, **t: em.reference.half_plane_sliding(
        m, 0.01, velocity=9.0, load_per_length=9, points=64, **t
    ),
    "cord": lambda m, **t: em.o_ring(m, diameter=0.005, squeeze=0.15, time=1e-4, **t),
    "leak": lambda m, **t: em.leak(
        m, ROUGH, pressure=3e5, pressure_drop=1e5, viscosity=1.0, length=1.0, **t
    ),
    "lubricated": lambda m, **t: em.lubricated(
        m,
        em.Cylinder(5e-3, 1.0),
        velocity=1.0,
        load=1e3,
        viscosity=1.0,
        rubber="rolls",
        **t,
    ),
}
SETTINGS = {
    "temperature",
    "inputs",
    "plan",
    "surface",
    "extrapolated",
    "model",
    "origins",
}


def _numbers(result, prefix=""):
    """All numbers of a result, by name."""
    for name, value in vars(result).items():
        if name in SETTINGS or value is None or isinstance(value, (str, bool)):
            continue
        if hasattr(value, "__dataclass_fields__") or hasattr(value, "_fields"):
            items = value._asdict() if hasattr(value, "_asdict") else vars(value)
            yield from (
                (f"{prefix}{name}.{k}", np.asarray(v))
                for k, v in items.items()
                if np.ndim(v) or v is not None
            )
        else:
            yield f"{prefix}{name}", np.asarray(value)


@pytest.mark.parametrize("verb", VERBS)
def test_every_verb_as_the_material_brought_to_the_temperature(verb):
    """Against moduli that are scaled before the verb sees them; forces, work and power
    scale, friction follows.
    """
    call, where = VERBS[verb], {"temperature": WARM}
    # the flash temperature moves b_T along: the law is needed, so compare at the
    # temperature found
    if verb == "heat":
        hot = call(RUBBER, **where)
        there = float(hot.temperature_rise) + WARM
        assert 2 < there - WARM < 15
        exact = em.friction(
            RUBBER.at(there), ROUGH, velocity=5.0, pressure=3e5, model=LINE
        )
        np.testing.assert_allclose(
            [float(hot.mu), float(hot.depth)], [exact.mu, exact.depth], rtol=1e-3
        )
        return
    found, exact = (
        dict(_numbers(call(RUBBER, **where))),
        dict(_numbers(call(RUBBER.at(WARM)))),
    )
    assert found.keys() == exact.keys()
    loose = 1e-2 if verb == "slide" else 2e-3 if verb in ("oblique", "bands") else 2e-4
    for name, value in exact.items():
        if "error" in name or name == "imbalance" or value.dtype == object:
            continue
        scale = np.nan_to_num(np.abs(value)).max(initial=0.0)
        np.testing.assert_allclose(
            found[name],
            value,
            rtol=loose,
            atol=loose * scale,
            err_msg=f"{verb}: {name}",
        )


def test_drive_and_warming():
    mount = em.Mount(0.1, 1e4, 1.0)
    arguments = {
        "time": np.linspace(0, 0.01, 5),
        "position": np.linspace(0, 1e-3, 5),
        "load": 2.0,
        "rtol": 1e-2,
    }
    found = em.drive(RUBBER, BALL, tangential=mount, temperature=WARM, **arguments)
    exact = em.drive(RUBBER.at(WARM), BALL, tangential=mount, **arguments)
    np.testing.assert_allclose(
        found.friction_force, exact.friction_force, rtol=1e-2, atol=1e-4
    )
    warm = em.heat_build_up(
        RUBBER,
        BALL,
        velocity=0.5,
        load=2.0,
        ambient=293.15,
        conductance=1e-3,
        hottest=330.0,
    )
    at = em.rolling(RUBBER.at(float(warm.steady)), BALL, velocity=0.5, load=2.0)
    np.testing.assert_allclose(warm.power, at.power, rtol=1e-5)
    assert float(warm.steady) > 294


def test_list_of_materials():
    plain = em.Prony(*SERIES, shift=WLF, name="plain")
    both = em.friction([RUBBER, plain], BALL, velocity=0.1, load=2.0, temperature=WARM)
    assert both.mu.shape == (2,)
    one = em.friction(plain, BALL, velocity=0.1, load=2.0, temperature=WARM)
    np.testing.assert_allclose(both.mu[1], one.mu, rtol=1e-12)
    assert abs(both.mu[0] / one.mu - 1) > 0.01


def friction_of_factors(kelvin, factor):
    """Of a ball, at a temperature and with the last value of the table changed."""
    last = jax.numpy.array([1.0, 1.0, 1.0, factor])
    law = em.VerticalTable(TABLE.temperature, TABLE.factor * last)
    rubber = em.Prony(*SERIES, shift=WLF, vertical=law)
    return em.friction(
        rubber, BALL, velocity=0.1, load=2.0, temperature=WARM * kelvin
    ).friction_force


def friction_of_a_surface(kelvin):
    return em.friction(
        RUBBER, ROUGH, velocity=0.1, pressure=3e5, temperature=WARM * kelvin
    ).mu


def entropic_factor(reference):
    return em.EntropicVertical(293.15 * reference).b(WARM)


@pytest.mark.parametrize(
    "function", [friction_of_factors, friction_of_a_surface, entropic_factor]
)
def test_gradients(function):
    """Against central differences, through b_T of the temperature, of a table and of a
    reference.
    """
    count, h = len(inspect.signature(function).parameters), 1e-4
    with jax.enable_x64(True):
        slopes = jax.jit(jax.grad(function, tuple(range(count))))(*np.ones(count))
        for slope, step in zip(slopes, h * np.eye(count), strict=True):
            change = function(*(1 + step)) - function(*(1 - step))
            assert abs(float(slope)) > 1e-3
            np.testing.assert_allclose(slope, change / (2 * h), rtol=1e-4)


@pytest.mark.parametrize("law", [em.EntropicVertical(293.15), TABLE])
def test_file_round_trip(tmp_path, law):
    path = tmp_path / "rubber.toml"
    rubber = em.Prony(*SERIES, shift=WLF, vertical=law, name="rubber")
    em.save_material(rubber, path)
    again = em.load_material(path)
    assert repr(again.vertical) == repr(law)
    np.testing.assert_array_equal(
        again.vertical.b([250.0, 300.0]), law.b([250.0, 300.0])
    )
    path.write_text(
        path.read_text()
        .replace('law = "table"', 'law = "tables"')
        .replace('"entropic"', '"entropik"')
    )
    with refused("", "entropic"):
        em.load_material(path)


def test_check_finds_a_law_that_does_not_cover_the_range(tmp_path):

    path = tmp_path / "rubber.toml"
    rubber = em.Prony(
        *SERIES,
        shift=em.WLF(8.0, 110.0, 293.15),
        vertical=TABLE,
        name="rubber",
        range={"omega": (1.0, 1e5), "temperature": (203.0, 330.0)},
    )
    em.save_material(rubber, path)
    findings = "\n".join(check_material(path))
    assert mentions(findings, "vertical shifts", "range")
    assert mentions(findings, "citation", "[source.vertical]")
