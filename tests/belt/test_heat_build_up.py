"""`em.heat_build_up` against Lambert's function, scipy's integrator, the balance of
power, and its refusals.
"""

import dataclasses

import jax
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import lambertw

import elastomdr as em

from ..refused import refused

BETA, COLD, LOAD, HEAT = 0.04, 293.15, 800.0, 200.0  # 1/K, K, N, J/K
WHEEL = em.Cylinder(0.1, 0.05)
SHIFT = em.ShiftTable([COLD, COLD + 100], [0.0, -100 * BETA / np.log(10)])
# one short time: P = P_0 exp(-beta dT)
RUBBER = em.Foundation(1e9, [1e9], [1e-9], shift=SHIFT)
SCENE = {
    "velocity": np.array([0.5, 1.0, 2.0]),
    "load": LOAD,
    "ambient": COLD,
    "hottest": COLD + 99,
}


@pytest.fixture(scope="module")
def power():
    return em.rolling(
        RUBBER, WHEEL, velocity=SCENE["velocity"], load=LOAD, temperature=COLD
    ).power


def test_steady_state(power):
    """beta dT exp(beta dT) = beta P_0/H."""
    conductance = power[1] / 50
    warm = em.heat_build_up(RUBBER, WHEEL, conductance=conductance, **SCENE)
    rise = warm.steady - COLD
    expected = lambertw(BETA * power / conductance).real / BETA
    np.testing.assert_allclose(rise, expected, rtol=3e-6)
    assert (np.abs(rise - expected) < warm.error + 1e-6 * expected).all()
    np.testing.assert_allclose(warm.power, power * np.exp(-BETA * rise), rtol=1e-5)
    np.testing.assert_allclose(
        warm.coefficient * LOAD * SCENE["velocity"], warm.power, rtol=1e-12
    )
    assert warm.settling is None
    said = dict(warm.findings())
    assert said["load"] == "800 N"  # once, though given to three points
    assert said["velocity"] == "0.5 to 2 m/s (3 values)"
    assert "steady at 0.5 m/s" in said


def test_history(power):
    conductance = power[1] / 50
    time = HEAT / conductance * np.array([0.0, 0.02, 0.1, 0.3, 1.0, 10.0])
    warm = em.heat_build_up(
        RUBBER, WHEEL, conductance=conductance, capacity=HEAT, time=time, **SCENE
    )
    for i, first in enumerate(power):
        way = solve_ivp(
            lambda _, rise, p=first: (
                (p * np.exp(-BETA * rise) - conductance * rise) / HEAT
            ),
            (0, time[-1]),
            [0.0],
            t_eval=time,
            rtol=1e-10,
            atol=1e-10,
        )
        np.testing.assert_allclose(
            warm.temperature[i] - COLD, way.y[0], atol=2e-5 * way.y[0].max()
        )
    slope = -BETA * power * np.exp(-BETA * (warm.steady[:, 0] - COLD))
    np.testing.assert_allclose(
        warm.settling[:, 0], HEAT / (conductance - slope), rtol=1e-2
    )
    assert (np.diff(warm.temperature, axis=-1) > 0).all()
    assert warm.temperature.shape == warm.time.shape == (3, 6)
    assert "above the surroundings" in warm.summary()
    warm.plot()


def test_axes_in_any_order(power):
    """Velocity first, load last: curves over velocity, and an axis of the Dataset for
    each of the two.
    """
    load = np.array([400.0, 800.0, 1200.0])
    scene = SCENE | {"velocity": SCENE["velocity"][:, None], "load": load}
    found = em.heat_build_up(RUBBER, WHEEL, conductance=power[1] / 50, **scene)
    assert dict(found.to_xarray().sizes) == {"velocity": 3, "load": 3}
    lines = [
        line for line in found.summary().splitlines() if line.startswith("steady at")
    ]
    assert [line.partition("  ")[0] for line in lines] == [
        "steady at 0.5 m/s, 400 N",
        "steady at 2 m/s, 1200 N",
    ]
    ax = found.plot()
    assert [x.get_text() for x in ax.get_legend().get_texts()] == [
        "400 N",
        "800 N",
        "1200 N",
    ]
    for line, kelvin in zip(ax.get_lines(), found.temperature.T, strict=True):
        np.testing.assert_array_equal(line.get_xdata(), SCENE["velocity"])
        np.testing.assert_array_equal(line.get_ydata(), kelvin - 273.15)
    fields = {  # a history, made up
        "time": np.array([0.0, 5.0, 10.0]),
        "ambient": COLD + np.array([0.0, 10.0])[:, None, None],
        "capacity": np.array([[100.0], [200.0]]),
        "converged": True,
        "temperature": COLD + np.arange(12).reshape(2, 2, 3),
    }
    names = (
        "velocity",
        "load",
        "conductance",
        "steady",
        "settling",
        "power",
        "coefficient",
        "error",
        "other_states",
        "model_error",
    )
    fields = {
        name: np.broadcast_to(x, (2, 2, 3))
        for name, x in (dict.fromkeys(names, 1.0) | fields).items()
    }
    found = dataclasses.replace(found, marks=(), **fields)
    assert dict(found.to_xarray().sizes) == {"ambient": 2, "capacity": 2, "time": 3}
    assert "heat capacity [J/K]" in found.csv()
    ax = found.plot()
    words = [x.get_text() for x in ax.get_legend().get_texts()]
    assert words == [
        "20 °C, 100 J/K",
        "20 °C, 200 J/K",
        "30 °C, 100 J/K",
        "30 °C, 200 J/K",
        "steady",
    ]
    np.testing.assert_array_equal(ax.get_lines()[0].get_xdata(), [0.0, 5.0, 10.0])


@pytest.mark.slow
def test_gradient(power):
    """d dT/dH = -dT/(H (1 + beta dT))."""
    conductance = float(power[1] / 50)

    def rise(h):
        return (
            em.heat_build_up(
                RUBBER, WHEEL, conductance=h, rtol=1e-8, **SCENE | {"velocity": 1.0}
            ).steady
            - COLD
        )

    with jax.enable_x64(True):
        expected = lambertw(BETA * 50).real / BETA
        found = jax.grad(rise)(conductance)
    np.testing.assert_allclose(
        found, -expected / conductance / (1 + BETA * expected), rtol=1e-4
    )


def test_no_steady_state(power):
    """Too little cooling: NaN and one warning, not the end of the range."""
    with pytest.warns(em.ConvergenceWarning, match="no steady temperature below"):
        warm = em.heat_build_up(
            RUBBER, WHEEL, conductance=power[1] * np.array([1e-9, 0.02, 1.0]), **SCENE
        )
    assert np.isnan(warm.steady[0])
    assert warm.converged.tolist() == [False, True, True]


def test_the_lowest_of_three_steady_states():
    """A stable and an unstable one 5 K apart, another 44 K above: scipy warms the body
    up from the cold.
    """
    rubber = em.Foundation(1e9, [1e10], [1e-3], shift=em.WLF(8.86, 101.6, 293.15))
    wheel, scene = em.Cylinder(0.1, 0.05), {"velocity": 1.0, "load": 2000.0}
    found = em.heat_build_up(
        rubber, wheel, ambient=265.0, conductance=0.2, hottest=392.0, **scene
    )
    kelvin = np.linspace(265, 270, 101)
    power = np.asarray(em.rolling(rubber, wheel, temperature=kelvin, **scene).power)
    way = solve_ivp(
        lambda _, y: np.interp(y, kelvin, power) - 0.2 * (y - 265),
        (0, 1e4),
        [265.0],
        rtol=1e-8,
    )
    np.testing.assert_allclose(found.steady, way.y[0, -1], atol=1e-2)
    conductance = np.array([0.05, 0.15, 0.2, 1.0])
    several = em.heat_build_up(
        rubber, wheel, ambient=265.0, conductance=conductance, hottest=392.0, **scene
    )
    kelvin = np.linspace(265, 392, 1001)
    power = np.asarray(em.rolling(rubber, wheel, temperature=kelvin, **scene).power)
    warms = power > conductance[:, None] * (kelvin - 265)
    states = (warms[:, 1:] != warms[:, :-1]).sum(axis=1)
    np.testing.assert_array_equal(states, [1, 1, 3, 3])
    np.testing.assert_array_equal(several.other_states, states > 1)


def test_rubber_too_cold_to_be_known():
    """Far below the shift law's range: NaN with its flag, with and without a
    history.
    """
    tyre = em.springs(
        em.load_material("tread-passenger-synthetic"), 15e-3, bonded=False
    )
    with pytest.warns(em.ConvergenceWarning, match="that can be found"):
        found = em.heat_build_up(
            tyre,
            em.Cylinder(0.1, 0.05),
            velocity=2.0,
            load=800.0,
            ambient=200.15,
            conductance=1.2,
            capacity=1e3,
            time=[0.0, 100.0],
        )
    assert not found.converged.any()
    assert np.isnan(found.temperature).all()


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"material": em.Foundation(1e9, [1e9], [1e-9])}, ("material", "shift law")),
        ({"hottest": None}, ("hottest",)),
        ({"hottest": 280.0}, ("ambient", "below hottest")),
        ({"conductance": 0.0}, ("conductance", "positive")),
        ({"time": [0.0, 1.0]}, ("capacity", "time")),
        ({"capacity": 1.0, "time": [1.0, 0.5]}, ("time", "ascending")),
        ({"conductance": [1.0, 2.0]}, ("", "broadcast")),
    ],
)
def test_refusals(change, words):
    scene = {"material": RUBBER, "conductance": 1.0, **SCENE} | change
    with refused(*words):
        em.heat_build_up(scene.pop("material"), WHEEL, **scene)
