"""Rough lines: steady periodic sliding, the direction average, scene files."""

import warnings

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.surface.spectrum import synthesise

from ..refused import refused

RUBBER = em.Foundation(1e6, [2e7, 5e6], [1e-5, 1e-3])
WAVES = np.array([1000.0, 5000.0, 30000.0])  # k [rad/m]
HEIGHTS = np.array([2e-5, 8e-6, 2e-6])  # A [m]
TABLE = np.array([1e3, 1e6])
SURFACE = em.Spectrum(TABLE, 1e-17 * (TABLE / 1e3) ** -3.6, convention="2d")


def cosines(points: int, heights=HEIGHTS) -> em.RoughLine:
    x = np.arange(points) * 2 * np.pi / WAVES[0] / points
    return em.RoughLine(x, heights @ np.cos(WAVES[:, None] * x))


def rough(points: int = 4096, seed: int = 3) -> em.RoughLine:
    return synthesise(
        em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=4e4), seed, 4, points
    )


def march(
    line: em.RoughLine, law: em.Foundation, velocity: float, depth: float, periods: int
) -> tuple[float, ...]:
    """The contact step of one branch, period after period in plain Python: mu by work,
    by dissipation, and the load.
    """
    (stiff,), (tau,), soft = law.moduli, law.times, float(law.equilibrium)
    surface = (
        np.roll(line.height[::-1], -int(np.argmax(line.height[::-1])) - 1)
        - line.height.max()
        + depth
    )
    h = float(line.spacing) / velocity
    keep = np.exp(-h / tau)
    gain = stiff * (1 - keep) * tau / h
    u = f = q = work = heat = load = 0.0
    for period in range(periods):
        if period == periods - 1:
            work = heat = load = 0.0
        for w in surface:
            free = u - (soft * u + keep * f) / (soft + gain)
            new = max(free, w)
            rate, after = (new - u) / h, (soft + gain) * (max(free, w) - free)
            settled = stiff * tau * rate
            # int f^2 ds/(E tau) of f = settled + (f - settled) exp(-s/tau), exactly
            rest = f - settled
            heat += (
                settled**2 * h
                + 2 * settled * rest * tau * (1 - keep)
                + rest**2 * tau / 2 * (1 - keep**2)
            ) / (stiff * tau)
            work += 0.5 * (q + after) * (new - u)
            f, u, q = keep * f + gain * (new - u), new, after
            load += q
    load *= float(line.spacing)
    return work / load, heat / load, load / float(line.period)


def test_full_contact_of_cosines():
    got = em.friction(
        RUBBER, cosines(16384), velocity=0.3, load=600.0, model=em.Line(samples=65536)
    )
    np.testing.assert_allclose(got.mu, 0.0014075137994553225, rtol=1e-9)
    np.testing.assert_allclose(got.friction_force, 0.8445082796731935, rtol=1e-8)
    np.testing.assert_allclose(got.depth, 6e-4 + HEIGHTS.sum(), rtol=1e-9)
    assert got.lines.share == 1
    by_depth = em.friction(
        RUBBER,
        cosines(16384),
        velocity=0.3,
        depth=got.depth,
        model=em.Line(samples=65536),
    )
    np.testing.assert_allclose(by_depth.normal_force, 600.0, rtol=1e-8)


def test_direction_average_of_a_cosine():
    """<cos(phi) E''(w cos(phi))> = E_1/(w tau) (1 - 1/sqrt(1 + (w tau)^2)), at w tau =
    0.1, 1, 10.
    """
    kernel = np.array([0.04962809790010864, 0.2928932188134525, 0.09004962809790011])
    x = np.arange(1024) * 2 * np.pi / 1e3 / 1024
    one = em.Foundation(1e6, [1e6], [1e-3])
    got = em.friction(
        one,
        em.RoughLine(x, 1e-5 * np.cos(1e3 * x)),
        velocity=[0.1, 1, 10],
        load=600.0,
        rtol=1e-5,
        model=em.Line(average=True),
    )
    exact = 0.5 * 1e-10 * 1e3 * 1e6 * kernel / 600
    np.testing.assert_allclose(got.mu, exact, rtol=1e-5)
    assert (np.abs(got.mu - exact) <= got.error).all()


def test_partial_contact_against_a_march():
    line, one = rough(1024), em.Foundation(1e6, [2e7], [3e-4])
    got = em.friction(one, line, velocity=1.0, depth=2e-5, model=em.Line(samples=4096))
    work, heat, load = march(line.finer(4), one, 1.0, 2e-5, 30)
    assert 0.01 < got.lines.share < 0.9
    # what friction puts in is what the branch dissipates
    np.testing.assert_allclose(got.mu, heat, rtol=2e-4)
    # the plain march does not know of bends in a step
    np.testing.assert_allclose(got.normal_force, load, rtol=1e-5)
    assert abs(heat - work) < got.error


def test_pressure_by_the_rule_of_full_contact():
    """Waves of one length in full contact: the friction stress of a half-space, <h^2>
    q^2 <cos E''(q v cos)>/2.
    """
    narrow = em.SelfAffine(0.0, rms_height=1e-6, q_low=1e3, q_high=1.01e3)
    one = em.Foundation(1e6, [1e6], [1e-3])
    model = em.Line(average=True, equivalent_length="full contact", samples=1024)
    scene = {"velocity": 1.0, "pressure": 1e5, "model": model, "rtol": 1e-5}
    found = em.friction(one, narrow, **scene)
    assert found.lines.share == 1
    # E'' = E_1 w tau/(1 + (w tau)^2), at w tau = 1.005 for waves along the motion
    phi = (np.arange(4000) + 0.5) * np.pi / 2 / 4000
    w = 1.005 * np.cos(phi)
    stress = 1e-12 * 1.005e3**2 / 2 * np.mean(np.cos(phi) * 1e6 * w / (1 + w**2))
    np.testing.assert_allclose(found.mu, stress / 1e5, rtol=0.01)
    plan = em.plan(one, narrow, **scene)
    assert str(plan) == str(found.plan)
    assert "full contact" in found.model


def test_elastic_line_loses_nothing():
    """Full contact: mean u is load over E*, depth that and the highest wave on top."""
    got = em.friction(
        em.Foundation(1e6, [], []),
        cosines(1024),
        velocity=0.3,
        load=[3.0, 600.0],
        model=em.Line(),
    )
    np.testing.assert_array_equal(got.mu, 0.0)
    np.testing.assert_allclose(got.depth[1], 6e-4 + HEIGHTS.sum(), rtol=1e-9)
    assert got.converged.all()


def test_plan_of_a_rough_line():
    many = em.Foundation(1e6, 1e6 * np.ones(9), np.geomspace(1e-12, 1e6, 9))
    plan = em.plan(
        many, rough(1024), velocity=np.geomspace(1e-4, 1, 5), load=10.0, model=em.Line()
    )
    assert plan.points == 5
    assert "1 line of 4096 samples" in str(plan)
    with refused("quantity", "friction", "rolling"):
        em.plan(many, rough(1024), velocity=1.0, load=10.0, quantity="rolling")


def test_order_in_the_sample_spacing():
    line = cosines(1024, np.array([2e-5, 4e-6, 0.0]))
    mu = [
        float(
            em.friction(
                RUBBER, line, velocity=0.1, load=3.0, model=em.Line(samples=n)
            ).mu
        )
        for n in (4096, 16384, 65536)
    ]
    assert np.log(abs((mu[2] - mu[0]) / (mu[2] - mu[1]))) / np.log(4) > 1.5


def test_one_asperity_with_a_long_period():
    ball = em.friction(
        RUBBER, em.Paraboloid(1e-3), velocity=[1e-3, 0.1], depth=1e-6, model=em.Line()
    )
    gaps = []
    for period in (4e-3, 16e-3):
        n = round(period / 2e-6)
        x = np.arange(n) * 2e-6
        shape = -np.minimum((x - x[n // 2]) ** 2 / 1e-3, 3e-6)
        line = em.friction(
            RUBBER,
            em.RoughLine(x, shape),
            velocity=[1e-3, 0.1],
            depth=1e-6,
            model=em.Line(),
        )
        gaps.append(np.abs(line.mu / ball.mu - 1).max())
    assert gaps[1] < 5e-3
    assert gaps[1] <= gaps[0] + 2e-4


def test_master_curve():
    wlf = em.WLF(c1=8.86, c2=101.6, reference=293.15)
    rubber = em.Prony(
        0.5e6, 1e6 * np.ones(12), np.geomspace(1e-12, 1e10, 12), shift=wlf
    )
    v = np.array([1e-3, 1.0])
    asked = {"pressure": 1e5, "model": em.Line(samples=4096)}
    surface = em.SelfAffine(0.8, rms_slope=0.2, q_low=1e3, q_high=1e4)
    cold = em.friction(rubber, surface, velocity=v, temperature=283.15, **asked)
    same = em.friction(
        rubber, surface, velocity=v * wlf.a(283.15), temperature=293.15, **asked
    )
    np.testing.assert_allclose(cold.mu, same.mu, rtol=1e-8)
    assert "2 pi/q_low" in cold.model
    for word in ("rms height", "rms slope", "cutoffs"):
        assert word in cold.summary()
    wide = em.friction(
        rubber,
        surface,
        velocity=v,
        temperature=283.15,
        **asked | {"model": em.Line(samples=4096, equivalent_length=1e-3)},
    )
    np.testing.assert_allclose(wide.normal_force, 1e5 * 1e-3, rtol=1e-7)
    lines = em.friction(
        rubber,
        surface,
        velocity=v,
        temperature=283.15,
        **asked | {"model": em.Line(samples=4096, seeds=2)},
    )
    assert (lines.lines.scatter > 0).all()


def test_progress_ends_with_all_of_it():
    told = []
    em.friction(
        RUBBER,
        rough(),
        velocity=[0.1, 1.0],
        load=5.0,
        model=em.Line(),
        progress=lambda *at: told.append(at),
    )
    assert told[-1] == (2, 2)


def test_random_scenes_converge_or_say_so():
    rng = np.random.default_rng(7)
    for seed in range(4):
        load = 10.0 ** rng.uniform(-1, 4, 8)
        velocity = 10.0 ** rng.uniform(-9, 5, 8)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", em.ConvergenceWarning)
            got = em.friction(
                RUBBER, rough(seed=seed), velocity=velocity, load=load, model=em.Line()
            )
        np.testing.assert_allclose(
            got.normal_force[got.converged], load[got.converged], rtol=1e-8
        )
        assert (got.mu[got.converged] > 0).all()
        assert np.isnan(got.mu[~got.converged]).all()
        assert got.converged.mean() > 0.7


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"pressure": None}, ("", "pressure")),
        ({"load": 3.0}, ("load", "pressure", 3)),
        ({"pressure": -1.0}, ("pressure", "positive")),
        ({"temperature": 300.0}, ("", "shift law")),
        ({"model": "lines"}, ("model", "'line'")),
        ({"model": "averaged"}, ("model", "use")),
        (
            {"model": em.Persson(), "pressure": None, "load": 1.0},
            ("model", "em.Line"),
        ),
        (
            {"model": em.Multiscale(), "shape": rough()},
            ("model", "em.Line", "rough line"),
        ),
        (
            {"material": em.Foundation.maxwell(1e6, 1.0), "model": em.Line()},
            ("material", "equilibrium modulus"),
        ),
        ({"shape": rough()}, ("", "equivalent_length")),
    ],
)
def test_bad_input(change, message):
    asked = {
        "material": RUBBER,
        "shape": SURFACE,
        "velocity": 1.0,
        "pressure": 1e5,
        "model": em.Line(),
    } | change
    with refused(*message):
        em.friction(asked.pop("material"), asked.pop("shape"), **asked)


def test_lines_have_no_derivatives():
    """What JAX traces is refused wherever it enters a line."""

    def mu(velocity=1.0, pressure=1e5, slope=0.2, modulus=2e7, length=None):
        surface = em.SelfAffine(0.8, rms_slope=slope, q_low=1e3, q_high=4e3)
        rubber = em.Foundation(1e6, [modulus], [1e-4])
        model = em.Line(samples=256, equivalent_length=length)
        given = {"velocity": velocity, "pressure": pressure, "model": model}
        return em.friction(rubber, surface, **given).mu

    ways = jax.grad, jax.jit
    for name, value in {
        "velocity": 1.0,
        "pressure": 1e5,
        "slope": 0.2,
        "modulus": 2e7,
        "length": 1e-3,
    }.items():
        for way in ways:
            refused = pytest.raises(em.InputError, match="have no derivatives")
            with jax.enable_x64(True), refused:
                way(lambda x, name=name: mu(**{name: x}))(value)


@pytest.mark.parametrize("seeds", [0, [1, 1], [1.5]])
def test_bad_seeds(seeds):
    with refused("seeds"):
        em.Line(seeds=seeds)


SCENE = """
material = "tread-passenger-synthetic"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.2
longest = "5 mm"
shortest = "0.2 mm"
[contact]
model = "line"
{contact}
velocity = ["0.01 m/s", "0.1 m/s"]
"""


FULL = 'model = "line"\nequivalent_length = "full contact"'


def test_scene(tmp_path, capsys, monkeypatch):
    scene = tmp_path / "road.toml"
    scene.write_text(SCENE.format(contact='pressure = "0.05 MPa"'))
    assert main(["friction", str(scene), "--out", str(tmp_path), "--verbose"]) == 0
    said = capsys.readouterr().out
    for word in ("rms height", "rms slope", "cutoffs", "2 pi/q_low"):
        assert word in said
    table = (tmp_path / "road-friction.csv").read_text()
    assert "not the real contact" in table
    assert (tmp_path / "road-friction.png").stat().st_size > 10_000
    assert main(["plan", str(scene)]) == 0
    assert "periodic states" in capsys.readouterr().out
    assert main(["rolling", str(scene)]) == 2
    scene.write_text(
        SCENE.format(contact='pressure = "0.05 MPa"').replace('model = "line"', FULL)
    )
    assert main(["plan", str(scene)]) == 0
    assert "that of full contact" in capsys.readouterr().out
    scene.write_text(SCENE.format(contact=""))
    assert main(["friction", str(scene)]) == 2
    assert "pressure" in capsys.readouterr().err
