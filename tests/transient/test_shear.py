"""`em.shear` against Cattaneo and Mindlin, an event-by-event elastic solution, and its
own order.
"""

import functools
import itertools
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused, warned

E, G, R, MU, A = 4e6, 4e6 * 2 / 3, 0.01, 0.5, 2e-3
DEPTH, LOAD = A**2 / R, 4 / 3 * E * A**3 / R
NORMAL, TANGENTIAL = em.Foundation(E, [], []), em.Foundation(G, [], [])
BALL = em.Paraboloid(R)
FULL = MU * E * DEPTH / G  # displacement at which the last element slips [m]
LOOP = np.interp(np.linspace(0, 4, 41), np.arange(5), [0, 1, -1, 1, -1])
TIME = np.linspace(0.0, 4.0, 41)


def elastic(time=TIME, **changes):
    scene = {"friction": MU, "tangential": TANGENTIAL, "load": LOAD} | changes
    return em.shear(NORMAL, BALL, time=time, **scene)


@functools.cache
def loop_to_full_slip():
    return elastic(displacement=FULL * LOOP)


@pytest.mark.parametrize(
    "control", [{"load": LOAD}, {"load": None, "depth": DEPTH}], ids=["load", "depth"]
)
def test_mindlin_deresiewicz_loop(control):
    """Amplitude 0.7 mu F_N: displacement, energy per cycle, stick radius a (1 -
    T)^(1/3).
    """
    amplitude = 0.00016555785760328506
    found = elastic(displacement=amplitude * LOOP, **control)
    assert found.converged.all()
    np.testing.assert_allclose(found.force[10], 0.7 * MU * LOAD, rtol=1e-9)
    np.testing.assert_allclose(
        found.slip_loss[30] - found.slip_loss[10], 6.392600797424778e-05, rtol=1e-9
    )
    np.testing.assert_allclose(found.stick_radius[10], A * 0.3 ** (1 / 3), rtol=1e-8)
    np.testing.assert_allclose(found.force[20], -found.force[10], rtol=1e-9)
    np.testing.assert_allclose(found.work, found.slip_loss + found.stored, rtol=1e-8)
    assert found.error.max() < 1e-8 * LOAD


def test_slip_loss_of_small_amplitudes():
    """dW = (18/5) (mu F_N)^2/(G* a) {1 - (1 - T)^(5/3) - (5T/6) [1 + (1 - T)^(2/3)]}, T
    = F_x/(mu F_N) (Mindlin 1952).

    The bracket, about 5 T^3/162, in 40 digits (mpmath).
    """
    for t, bracket in ((0.1, 3.30774102783009e-5), (0.01, 3.10714099292845e-8)):
        amplitude = FULL * (1 - (1 - t) ** (2 / 3))
        found = elastic(displacement=amplitude * LOOP)
        expected = 18 / 5 * (MU * LOAD) ** 2 / (G * A) * bracket
        np.testing.assert_allclose(
            found.slip_loss[30] - found.slip_loss[10], expected, rtol=1e-9
        )


def test_cattaneo():
    """F_x = mu F_N [1 - (1 - U/U_full)^(3/2)], stick radius a sqrt(1 - U/U_full),
    stiffness 2 G* a at first.
    """
    part = np.concatenate([[0, 1e-6], np.linspace(0, 1.2, 40)[1:]])
    found = elastic(displacement=part * FULL)
    left = np.maximum(1 - part, 0)
    np.testing.assert_allclose(
        found.force, MU * LOAD * (1 - left**1.5), rtol=1e-9, atol=1e-9 * LOAD
    )
    np.testing.assert_allclose(
        found.stick_radius[:30], A * np.sqrt(left[:30]), rtol=1e-6
    )
    np.testing.assert_allclose(found.contact_radius, A, rtol=1e-8)
    np.testing.assert_allclose(found.force[1], 2 * G * A * 1e-6 * FULL, rtol=1e-5)


def test_converges_with_the_square_of_the_elements():
    # where stick ends within an element is chance: take many
    scale = np.linspace(1, 1.03, 8)
    errors = []
    for n in (200, 400, 800):
        force = [
            elastic(
                displacement=np.minimum(TIME, 1) * 0.65 * FULL,
                elements=n,
                load=None,
                depth=DEPTH * s,
            ).force[-1]
            - MU * LOAD * s**1.5 * (1 - (1 - 0.65 / s) ** 1.5)
            for s in scale
        ]
        errors.append(np.sqrt(np.mean(np.square(force))))
    slope = np.polyfit(np.log([200, 400, 800]), np.log(errors), 1)[0]
    assert -2.4 < slope < -1.7


def test_oblique_loading_in_any_order():
    """Normal and tangential motion at once, up and down: against a play operator in
    (depth, displacement), on the profile's levels y = g(x), written out here.
    """
    rng = np.random.default_rng(3)
    depth = DEPTH * np.abs(np.cumsum(rng.normal(0, 0.4, 30)) + 1)
    shift = FULL * np.cumsum(rng.normal(0, 0.3, 30))
    still = np.full(11, shift[-1]), np.full(11, depth[-1])
    found = elastic(
        displacement=np.append(shift, still[0]),
        load=None,
        depth=np.append(depth, still[1]),
    )

    x = (np.arange(20_000) + 0.5) / 20_000 * np.sqrt(R * depth.max()) * 1.0001
    y, sheared, expected = x**2 / R, np.zeros(20_000), []
    d0 = u0 = 0.0
    for d, u in zip(depth, shift, strict=True):
        # small steps instead of a rule within a step
        for part in np.linspace(0, 1, 201)[1:] if expected else [1.0]:
            dn, un = (
                (d0 + part * (d - d0), u0 + part * (u - u0)) if expected else (d, u)
            )
            inside = np.maximum(dn - y, 0)
            last = d0 + (part - 1 / 200) * (d - d0) if expected else 0.0
            previous = u0 + (part - 1 / 200) * (u - u0) if expected else 0.0
            carried = np.where(
                y < max(last, 1e-300) if expected else True,
                un - previous,
                0.5 * (un - previous),
            )
            sheared = np.clip(
                sheared + carried, -MU * E / G * inside, MU * E / G * inside
            )
        d0, u0 = d, u
        expected.append(2 * (x[1] - x[0]) * G * sheared.sum())
    np.testing.assert_allclose(found.force[:30], expected, atol=1e-4 * MU * LOAD)


def test_normal_part_and_second_order_in_time():
    """Viscoelastic, smooth motion: differences between 2, 4 and 8 steps fall by four;
    the error estimate holds.
    """
    rubber = em.StandardSolid(1e6, 3e6, 0.2)
    time = np.linspace(0, 2, 21)

    def force(steps):
        return em.shear(
            rubber,
            BALL,
            time=time,
            displacement=1e-4 * np.sin(2 * np.pi * time),
            friction=0.8,
            depth=4e-4 * np.sin(np.pi * time / 2) ** 2,
            elements=1000,
            steps=steps,
        )

    runs = [force(n) for n in (2, 4, 8)]
    change = [np.abs(b.force - a.force).max() for a, b in itertools.pairwise(runs)]
    np.testing.assert_allclose(
        np.log2(np.array(change[:-1]) / change[1:]), 2, atol=0.15
    )
    assert np.abs(runs[1].force - runs[2].force).max() < runs[1].error.max()
    assert np.all(
        runs[2].work - runs[2].slip_loss - runs[2].stored >= -1e-12 * runs[2].work.max()
    )  # lost in the rubber
    indentation = runs[2].normal_force  # a growing contact: Lee and Radok
    law = em.half_space(rubber)
    s = np.linspace(0, 1, 4001)
    for i in (4, 9):
        t = time[i] * s
        depth = np.interp(t, time, 4e-4 * np.sin(np.pi * time / 2) ** 2)
        modulus = law.relaxation(t[-1] - 0.5 * (t[1:] + t[:-1]))
        expected = np.sum(modulus * np.diff(4 / 3 * np.sqrt(R) * depth**1.5))
        np.testing.assert_allclose(indentation[i], expected, rtol=1e-3)


@pytest.mark.parametrize("friction", [1e6, np.inf])
@pytest.mark.parametrize(
    ("control", "start", "share"), [("depth", DEPTH, 8 / 15), ("load", LOAD, 9 / 14)]
)
def test_lifted_while_sheared(friction, control, start, share):
    """Each element sticks until its pressure is gone and loses G (U s)^2/2, where s = 1
    - (x/a)^2 of the way at a depth that falls evenly, and 1 - (x/a)^3 at such a load;
    with two instants alone. By hand.
    """
    time, way = np.array([0.0, 1.0]), 1e-5
    scene = {
        "displacement": way * time,
        "friction": friction,
        "load": None,
        control: start * (1 - time),
    }
    found = elastic(time=time, **scene)
    expected = G * way**2 * A * share
    # A finite friction lets go a little earlier. The depth falls ever faster as the
    # load goes: of order 5/3 in 1/64.
    rtol = 1e-7 if control == "depth" else 2e-3
    np.testing.assert_allclose(
        [found.work[-1], found.slip_loss[-1]], expected, rtol=rtol
    )


def test_what_is_not_finite_is_refused():
    with refused("displacement", "finite", "nan"):
        elastic(time=TIME[:3], displacement=[0, np.nan, 1])


class TestExtremes:
    def test_no_friction(self):
        found = elastic(displacement=FULL * LOOP, friction=0)
        assert np.all(found.force == 0)
        assert np.all(found.work == 0)

    def test_no_slip(self):
        """mu = inf: 2 G* a U at a constant depth, and nothing lost."""
        found = elastic(
            displacement=FULL * LOOP, friction=np.inf, load=None, depth=DEPTH
        )
        np.testing.assert_allclose(
            found.force, 2 * G * A * FULL * LOOP, rtol=1e-6, atol=1e-12
        )
        assert np.all(found.slip_loss == 0)

    def test_no_load(self):
        found = elastic(displacement=FULL * LOOP, load=0.0)
        assert found.converged.all()
        assert np.all(found.force == 0)

    def test_unloaded_after_shear(self):
        """What is stored when the load goes is given back, by slip; the force ends at
        zero.
        """
        part = np.minimum(TIME / 2, 1)
        found = elastic(
            displacement=0.5 * FULL * part, load=LOAD * np.minimum(2 - TIME / 2, 1)
        )
        assert abs(found.force[-1]) < 1e-6 * LOAD
        np.testing.assert_allclose(
            found.work[-1], found.slip_loss[-1] + found.stored[-1], rtol=1e-8
        )

    def test_a_relaxation_time_far_below_the_step(self):
        """A branch that has relaxed at once is not there."""
        fast = em.Foundation(E, [3 * E], [1e-9])
        found = em.shear(
            fast,
            BALL,
            time=TIME,
            displacement=FULL * LOOP,
            friction=MU,
            load=LOAD,
            tangential=TANGENTIAL,
        )
        same = loop_to_full_slip()
        np.testing.assert_allclose(found.force[1:], same.force[1:], atol=2e-6 * LOAD)

    @pytest.mark.filterwarnings("ignore:.*deeper than the radius")
    def test_a_liquid_sinks_beyond_its_body(self):
        liquid = em.Foundation(0.0, [E], [1e-2])
        scene = {
            "displacement": 0,
            "friction": MU,
            "load": LOAD,
            "tangential": TANGENTIAL,
        }
        with warned(em.ConvergenceWarning, "40 of 41", "wider"):
            found = em.shear(liquid, em.Sphere(1e-3), time=TIME, **scene)
        assert not found.converged[-1]
        assert np.isnan(found.force[-1])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"load": None}, ("", "depth")),
        ({"friction": -1.0}, ("friction", "positive")),
        ({"time": [0.0, 0.0]}, ("time", "ascending")),
        ({"displacement": [1.0, 2.0]}, ("", "long")),
        ({"tangential": None}, ("tangential",)),
        ({"elements": 1}, ("elements", 2, 1000000)),
        ({"load": -1.0}, ("load", "positive")),
    ],
)
def test_bad_input(changes, message):
    with refused(*message):
        elastic(**({"displacement": FULL * LOOP} | changes))


def test_a_dashpot_is_not_moved_at_once():
    with refused("depth", 0):
        em.shear(
            em.KelvinVoigt(1e6, 1e3),
            BALL,
            time=TIME,
            displacement=0.0,
            friction=MU,
            depth=DEPTH,
        )


def test_table_and_figure():
    found = loop_to_full_slip()
    assert "tangential force [N]" in found.csv()
    assert "41, all converged" in found.summary()
    assert found.plot().get_ylabel() == "Tangential force [N]"


def test_body_above_the_surface_feels_nothing():
    """A negative depth is no contact, as for em.indent and em.slide."""
    time = np.linspace(0, 1, 5)
    laws = {"tangential": em.Foundation(3e6, [], []), "friction": 0.3, "elements": 200}
    depth = np.array([1e-4, 0.0, -1e-4, 0.0, 1e-4])
    found, bare = (
        em.shear(
            em.Foundation(4e6, [], []),
            em.Paraboloid(0.01),
            time=time,
            displacement=1e-5 * time,
            depth=d,
            **laws,
        )
        for d in (depth, np.maximum(depth, 0))
    )
    assert found.converged.all()
    assert found.force[2] == found.normal_force[2] == 0
    np.testing.assert_allclose(found.force, bare.force, rtol=1e-12)
    np.testing.assert_allclose(found.normal_force, bare.normal_force, rtol=1e-12)


@pytest.fixture
def shear_map(monkeypatch):
    """`benchmarks/shear_map.py`, a half-space in three dimensions."""
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "benchmarks")
    import shear_map

    return shear_map


@pytest.mark.parametrize("memory", [False, True])
def test_model_error_of_a_ball_reaches_three_dimensions(shear_map, memory):
    scene = shear_map.drawn(np.random.default_rng(3), memory)._replace(nu=0.5)
    found = shear_map.of_elements(scene)
    limit = MU * found.normal_force.max()
    truth = limit * shear_map.in_three_dimensions(scene, 20)
    grid = 3e-3 * limit  # of 20 places across
    assert (abs(found.force - truth) <= found.model_error + grid).all()
    sizes = MU * found.normal_force, abs(found.force)
    parts = zip(sizes, shear_map.BOUND, strict=True)
    expected = np.min([part * np.maximum.accumulate(x) for x, part in parts], axis=0)
    np.testing.assert_allclose(found.model_error, expected, rtol=1e-12)


@pytest.mark.parametrize("friction", [0.0, np.inf])
def test_all_slip_and_all_stick_are_exact(friction):
    found = elastic(displacement=FULL * LOOP, friction=friction, elements=100)
    assert (found.model_error == 0).all()
