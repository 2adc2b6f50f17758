"""Arguments with units are converted to SI numbers, or refused by name; none is dropped
in silence.
"""

import inspect
import re
import subprocess
import sys

import numpy as np
import pandas as pd
import pint
import pint_pandas  # noqa: F401  the dtype "pint[mm/s]"
import pint_xarray  # noqa: F401  the accessor .pint
import pytest
import xarray as xr

import elastomdr as em
from elastomdr.units.arguments import UNITS, _unit, arguments_in_si, carries_unit

from ..refused import refused

REGISTRY = pint.UnitRegistry()
Q = REGISTRY.Quantity
NONSENSE = Q(3.0, "kg*mol*cd")
NUMBERS = re.compile(r"ArrayLike|Number|\bfloat\b|\bint\b|PixelSize|Heights|ndarray")
ANSWERS = {  # what a call returns, not what it takes
    "Plan",
    "MeasuredFriction",
    "Dma",
    "MasterCurve",
    "PronyFit",
    "MaterialFit",
    "FrictionMaster",
    "Calibration",
    "AdhesionFit",
}
SOLID, BALL = em.StandardSolid(1e6, 4e6, 0.3), em.Sphere(5e-3)
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=1e5)
PLACES = np.linspace(0.0, 1.0, 65)
RADIUS, ROLL = em.Paraboloid(5e-3), em.Cylinder(0.1, 1.0)


def public():
    """Each public callable with its arguments of numbers."""
    for package in (em, em.fit, em.reference):
        for name in package.__all__:
            value = getattr(package, name)
            if not callable(value) or name in ANSWERS:
                continue
            if inspect.isclass(value) and (
                issubclass(value, Exception) or hasattr(value, "findings")
            ):
                continue
            parameters = inspect.signature(value).parameters.values()
            numbers = [
                p.name
                for p in parameters
                if NUMBERS.search(str(p.annotation)) and p.kind != p.VAR_KEYWORD
            ]
            if numbers:
                yield name, value, numbers


PUBLIC = list(public())


def test_the_walk_finds_what_there_is():
    assert len(PUBLIC) > 60
    assert sum(len(numbers) for *_, numbers in PUBLIC) > 250


@pytest.mark.parametrize(
    ("name", "call", "numbers"), PUBLIC, ids=[name for name, *_ in PUBLIC]
)
def test_every_argument_of_numbers_refuses_a_unit_of_something_else(
    name, call, numbers
):
    others = {"exponent": 2.0} if name == "PowerLaw" else {}
    for argument in numbers:
        with refused(argument, "candela * kilogram * mole") as caught:
            call(**others | {argument: NONSENSE})
        assert caught.value.got == NONSENSE


@pytest.mark.parametrize(
    ("name", "call", "numbers"), PUBLIC, ids=[name for name, *_ in PUBLIC]
)
def test_every_argument_with_a_unit_is_converted(name, call, numbers):
    function = inspect.unwrap(call.__init__ if inspect.isclass(call) else call)
    to_numbers = arguments_in_si(function)
    for argument in set(numbers) - {"coefficient", "c", "road", "profile", "edge"}:
        unit = _unit(function.__qualname__, argument, {})
        for one in unit if isinstance(unit, tuple) else [unit]:
            given = Q(3.0, one.removesuffix(" of difference")) * Q(1.0, "mm/m")
            _, named = to_numbers((), {argument: given})
            np.testing.assert_allclose(named[argument], 3e-3, rtol=1e-12)


def described():
    """Each argument whose unit stands in the docstring: "velocity: sliding velocity
    [m/s].".
    """
    for name, call, numbers in PUBLIC:
        text = inspect.getdoc(call) or ""
        inside = re.search(r"Args:\n(.*?)(\n\n|\Z)", text, re.DOTALL)
        for argument in set(numbers) - {"columns"} if inside else ():
            line = re.search(
                rf"^    {argument}: (.*?)(?=^    \w|\Z)",
                inside[1],
                re.DOTALL | re.MULTILINE,
            )
            found = re.search(r"\[([A-Za-z0-9 ()/^*-]+)\]", line[1]) if line else None
            if found and found[1] not in ("-", "1", "Shore A"):
                yield name, call, argument, found[1]


def test_the_units_are_those_of_the_docstrings():
    count = 0
    for name, call, argument, text in described():
        function = inspect.unwrap(call.__init__ if inspect.isclass(call) else call)
        unit = _unit(function.__qualname__, argument, {})
        wanted = REGISTRY.parse_units(
            re.sub(r" (?=[A-Za-z])", "*", text.replace("Ohm", "ohm"))
        )
        every = unit if isinstance(unit, (tuple, list)) else [unit]
        dimensions = [
            REGISTRY.parse_units(one.removesuffix(" of difference")).dimensionality
            for one in every
        ]
        assert wanted.dimensionality in dimensions, (
            f"{name}({argument}) is {text} in words, {unit} in the table"
        )
        count += 1
    assert count > 80


CALLS = {
    "friction": lambda **k: em.friction(SOLID, BALL, **k).mu,
    "friction on a road": lambda **k: em.friction(SOLID, ROAD, **k).mu,
    "rolling": lambda **k: em.rolling(SOLID, BALL, **k).resistance,
    "o_ring": lambda **k: em.o_ring(SOLID, squeeze=0.1, **k).line_load,
    "leak": lambda **k: em.leak(SOLID, ROAD, density=900.0, **k).mass_rate,
    "gas leak": lambda **k: em.leak(SOLID, ROAD, **k).rate,
    "break_out": lambda **k: em.break_out(SOLID, ROAD, **k).mu,
    "lubricated": lambda **k: em.lubricated(SOLID, em.Cylinder(5e-3, 1.0), **k).flow,
    "reciprocating": lambda **k: (
        em.reciprocating(
            profile=(1e-3 * PLACES, 1e6 * PLACES * (1.0 - PLACES)), **k
        ).net_leak
    ),
    "stability": lambda **k: (
        em.stability(em.Mount(1.0, 1e3), force=np.array([1.0, 2.0, 1.5]), **k).slope
    ),
    "sphere": lambda **k: em.Sphere(**k).radius,
    "Adhesion": lambda **k: em.Adhesion(**k).length(1e6),
    "Prony": lambda **k: em.Prony(**k).storage(10.0),
    "SelfAffine": lambda **k: em.SelfAffine(hurst=0.8, rms_slope=0.3, **k).rms_height,
    "RoughLine": lambda **k: em.RoughLine(**k).height,
}
GIVEN = {
    "friction": {"velocity": np.array([0.01, 0.1]), "load": 0.01},
    "friction on a road": {"velocity": 0.1, "pressure": 1e5},
    "rolling": {"velocity": 0.1, "depth": 1e-4},
    "o_ring": {"diameter": 5e-3, "time": 10.0},
    "leak": {
        "pressure": np.array([2e4, 4e4]),
        "pressure_drop": 1e3,
        "viscosity": 0.1,
        "length": 1e-3,
        "time": 10.0,
    },
    "gas leak": {
        "pressure": 2e4,
        "pressure_drop": 1e3,
        "viscosity": 2e-5,
        "length": 1e-3,
        "time": 10.0,
        "outlet_pressure": 1e5,
        "mean_free_path": 6e-8,
    },
    "break_out": {
        "pressure": np.array([2e4, 4e4]),
        "boundary_shear": 1e5,
        "time": 10.0,
        "velocity": 0.1,
    },
    "lubricated": {
        "velocity": np.array([0.1, 0.2]),
        "load": 100.0,
        "viscosity": 0.1,
        "time": 10.0,
    },
    "reciprocating": {
        "velocity_out": np.array([0.1, 0.2]),
        "velocity_in": 0.1,
        "stroke": 0.1,
        "viscosity": 0.1,
    },
    "stability": {"velocity": np.array([0.1, 0.2, 0.3]), "wavelength": 1e-3},
    "sphere": {"radius": 5e-3},
    "Adhesion": {"work": 0.05, "strength": 1e5},
    "Prony": {
        "equilibrium": 1e6,
        "moduli": np.array([1e6, 2e6]),
        "times": np.array([0.1, 1.0]),
    },
    "SelfAffine": {"q_low": 1e3, "q_high": 1e5},
    "RoughLine": {"x": np.arange(8.0), "height": np.sin(np.arange(8.0))},
}


@pytest.mark.parametrize("name", CALLS)
def test_a_call_with_units_is_the_call_in_si(name):
    plain = CALLS[name](**GIVEN[name])
    asked = {
        key: Q(1e3 * value, UNITS[key]) * Q(1.0, "mm/m")
        for key, value in GIVEN[name].items()
    }
    np.testing.assert_allclose(CALLS[name](**asked), plain, rtol=1e-9)


def test_a_table_of_the_edge_takes_speeds_with_a_unit():
    found = em.Adhesion(0.05, edge=(Q([1.0, 2.0], "mm/s"), [1.0, 3.0]))
    assert np.allclose(found.edge, [[1e-3, 2e-3], [1.0, 3.0]])


def test_the_examples_of_the_issue():
    plain = em.friction(SOLID, BALL, velocity=0.01, load=0.01)
    asked = em.friction(
        SOLID, BALL, velocity=Q(np.array([10]), "mm/s"), load=Q(10, "mN")
    )
    np.testing.assert_allclose(asked.mu, [float(plain.mu)], rtol=1e-12)
    assert float(asked.normal_force[0]) == pytest.approx(0.01)


def test_a_list_of_quantities_and_nested_ones():
    line = em.friction(
        SOLID, BALL, velocity=[Q(10.0, "mm/s"), Q(0.1, "m/s")], load=0.01
    )
    np.testing.assert_allclose(line.velocity, [0.01, 0.1])
    with refused("velocity", "m/s", 1):
        em.friction(SOLID, BALL, velocity=[Q(10.0, "mm/s"), Q(1, "kg")], load=0.01)
    heat = em.Heat(
        0.2, Q(2.0, "MJ/(m^3*K)"), road=(Q(1.2, "W/(m*degC)"), Q(2.0, "MJ/(m^3*K)"))
    )
    assert heat.heat_capacity == 2e6
    np.testing.assert_allclose(heat.road, (1.2, 2e6))


def test_temperatures_and_their_differences():
    law = em.WLF(8.86, Q(101.6, "delta_degC"), Q(20, "degC"))
    assert (float(law.c2), float(law.reference)) == (101.6, 293.15)
    assert float(em.WLF(8.86, 101.6, Q(68, "degF")).reference) == pytest.approx(
        293.15, rel=1e-14
    )
    np.testing.assert_allclose(
        law.a(Q(np.array([10.0, 20.0]), "degC")), law.a(np.array([283.15, 293.15]))
    )
    with refused("c2", 101.6, "degree_Celsius"):
        em.WLF(8.86, Q(101.6, "degC"), 293.15)
    with refused("reference", 20, "delta_degree_Celsius"):
        em.WLF(8.86, 101.6, Q(20, "delta_degC"))


def test_what_pint_would_mistake():
    # turns, for pint 10 rad/s
    with refused("omega", "rad/s", 10):
        SOLID.storage(Q(10, "Hz"))
    assert (
        SOLID.storage(Q(10, "rad/s"))
        == SOLID.storage(10.0)
        == SOLID.storage(Q(10, "1/s"))
    )
    with refused("slope", 5):
        em.Cone(Q(5, "degree"))
    assert float(em.Cone(Q(5, "percent")).slope) == pytest.approx(0.05)


def test_units_that_depend_on_other_arguments():
    by_line = em.friction(SOLID, ROAD, velocity=1.0, load=Q(0.01, "N/mm"), model="line")
    assert (
        by_line.mu == em.friction(SOLID, ROAD, velocity=1.0, load=10.0, model="line").mu
    )
    with refused("load", "N/m", 10):
        em.friction(SOLID, ROAD, velocity=1.0, load=Q(10, "N"), model="line")
    with refused("load", 10.0):
        em.friction(SOLID, BALL, velocity=1.0, load=Q(10.0, "N/m"))
    assert float(em.PowerLaw(2, Q(0.1, "1/mm")).coefficient) == pytest.approx(100.0)
    q, c = np.array([1e3, 3e3, 1e4]), np.array([1e-3, 3e-5, 1e-6])  # 1/m, mm^3
    read = em.Spectrum(Q(q, "1/m"), Q(c, "mm^3"), convention="1d")
    np.testing.assert_allclose(
        read.c, em.Spectrum(q, 1e-9 * c, convention="1d").c, rtol=1e-9
    )
    with pytest.raises(em.InputError, match=r"c must be in m\^4"):
        em.Spectrum(Q(q, "1/m"), Q(c, "mm^3"), convention="2d")


@pytest.mark.parametrize(
    "velocity",
    [
        xr.DataArray([10.0, 100.0], attrs={"units": "mm/s"}),
        xr.DataArray([10.0, 100.0], attrs={"units": "mm/s"}).pint.quantify(),
        pd.Series([10.0, 100.0], dtype="pint[mm/s]"),
        pd.Index(pd.Series([10.0, 100.0], dtype="pint[mm/s]")),
        em.friction(SOLID, BALL, velocity=[0.01, 0.1], load=0.01).to_xarray().velocity,
    ],
    ids=["attrs", "pint-xarray", "pint-pandas", "index", "of a result"],
)
def test_xarray_and_pandas(velocity):
    plain = em.friction(SOLID, BALL, velocity=[0.01, 0.1], load=0.01)
    np.testing.assert_allclose(
        em.friction(SOLID, BALL, velocity=velocity, load=0.01).mu, plain.mu, rtol=1e-12
    )


def test_a_unit_that_nobody_knows():
    velocity = pd.Series([10.0, 100.0])
    velocity.attrs["units"] = "furlongish"
    with refused("velocity", "'furlongish'"):
        em.friction(SOLID, BALL, velocity=velocity, load=0.01)


class Foreign(np.ndarray):
    """An array with a unit, as astropy has."""

    unit = "mm / s"


def test_quantities_of_other_packages_are_refused():
    with refused("velocity", "plain number"):
        em.friction(SOLID, BALL, velocity=np.array([10.0]).view(Foreign), load=0.01)


def test_a_sweep_takes_units(tmp_path):
    axes = {"velocity": Q(np.array([10.0, 100.0]), "mm/s")}
    swept = em.sweep(
        em.friction,
        axes,
        store=tmp_path / "a.zarr",
        progress=False,
        material=SOLID,
        shape=BALL,
        load=Q(10.0, "mN"),
    )
    np.testing.assert_allclose(swept.velocity, [0.01, 0.1])
    np.testing.assert_allclose(
        swept.mu, em.friction(SOLID, BALL, velocity=[0.01, 0.1], load=0.01).mu
    )


def test_names_of_parameters_that_are_no_arguments():
    """The log10 of a factor on the times is called "time" in a calibration."""
    with refused("parameters", 1):
        em.fit.calibrate(
            SOLID,
            BALL,
            velocity=[0.1],
            measured=[0.1],
            parameters={"time": Q(1, "s")},
            load=1.0,
        )


def test_plain_values_have_no_unit():
    plain = (
        1.0,
        1,
        None,
        "text",
        [1.0, 2.0],
        (1, None),
        np.float64(1.0),
        np.arange(3),
        pd.Series([1.0]),
        BALL,
        SOLID,
        {"a": 1.0},
        xr.DataArray([1.0]),
        np.ma.masked_array([1.0]),
    )
    assert not any(map(carries_unit, plain))


def test_calls_without_units_do_not_load_pint():
    code = (
        "import sys, elastomdr as em; em.friction(em.StandardSolid(1e6, 4e6, .3), "
        "em.Sphere(5e-3), velocity=[.1, .2],load=1.0)._repr_html_(); sys.exit('pint' "
        "in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_methods_of_results_convert_as_well(tmp_path):
    friction = em.friction([SOLID, SOLID], BALL, velocity=[0.01, 0.1], load=0.01)
    assert str(friction.ranking(Q(50.0, "mm/s"))) == str(friction.ranking(0.05))
    measured = {"velocity": Q(np.array([20.0, 50.0]), "mm/s"), "mu": [0.01, 0.01]}
    lines = friction.select("material 1").plot(measured=measured).lines
    drawn = next(line for line in lines if line.get_label() == "measured")
    np.testing.assert_allclose(drawn.get_xdata(), [0.02, 0.05])
    braked = em.traction(
        SOLID,
        BALL,
        velocity=1.0,
        creepage=np.linspace(1e-3, 0.1, 9),
        friction=0.8,
        load=5.0,
    )
    files = tmp_path / "plain.tir", tmp_path / "units.tir"
    braked.to_tir(files[0], radius=0.3, width=0.2)
    braked.to_tir(files[1], radius=Q(300, "mm"), width=Q(0.2, "m"))
    assert files[0].read_text() == files[1].read_text()
    columns = [1.0, 10.0], [1e6, 2e6], [1e5, 2e5], [293.15, 293.15]
    swept = em.fit.dma(*columns, kind="shear")
    assert (swept.at(Q(40, "degC")).temperature == 313.15).all()
