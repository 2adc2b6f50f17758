"""Measured friction: shifted to a master curve, and parameters of a material calibrated
to it.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import calibration

from ..refused import refused

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

LAW = em.WLF(6.0, 110.0, 293.15)
KELVIN = np.array([268.15, 278.15, 288.15, 293.15, 303.15, 318.15])
VELOCITY = np.geomspace(1e-4, 1e-1, 12)


def bell(v):
    """A friction curve with a peak, as Grosch's."""
    return 0.3 + 0.9 * np.exp(-((np.log10(v) - 0.5) ** 2) / 9)


def measured(noise=0.01, seed=0):
    rng = np.random.default_rng(seed)
    a = 10 ** np.asarray(LAW.log10_a(KELVIN))[:, None]
    mu = bell(VELOCITY * a)
    return mu + noise * rng.normal(size=mu.shape)


def test_grosch_master_curve():
    scores = []
    for seed in range(6):
        master = em.fit.friction_master(
            VELOCITY, KELVIN[:, None], measured(0.01, seed), 293.15
        )
        truth = np.asarray(LAW.log10_a(KELVIN))
        away = KELVIN != 293.15
        scores.append(((master.log10_a - truth)[away] / master.log10_a_std[away]) ** 2)
        assert np.abs(master.log10_a - truth).max() < 0.2
    # a chi squared of 30 values that are correlated within each set
    assert 0.2 < np.mean(scores) < 3.0
    assert isinstance(master.wlf, em.WLF)
    assert abs(float(master.wlf.c1) - 6.0) < 3 * master.laws["WLF"].std["c1"]
    v = np.geomspace(master.velocity.min(), master.velocity.max(), 30)
    value, low, high = master.curve(v)
    assert np.abs(value - bell(v)).max() < 0.03
    assert np.mean((low <= bell(v)) & (bell(v) <= high)) > 0.7
    assert np.isnan(master.curve(1e6)[0])
    np.testing.assert_allclose(master.error, 0.01, rtol=0.3)
    assert master.warnings == ()
    assert "Reduced velocity" in master.plot().get_xlabel()
    assert "log10 a_T" in repr(master)


def test_errors_of_measured_friction():
    """Noise in proportion to the friction, said so or given point by point, and better
    used for it.
    """
    a = 10 ** np.asarray(LAW.log10_a(KELVIN))[:, None]
    curve = 0.1 + 1.5 * np.exp(-((np.log10(VELOCITY * a) - 0.5) ** 2) / 4)
    truth, off = np.asarray(LAW.log10_a(KELVIN)), {}
    for seed in range(4):
        mu = curve * (1 + 0.05 * np.random.default_rng(seed).normal(size=curve.shape))
        for name, error in (
            ("default", None),
            ("given", 0.05 * curve),
        ):
            master = em.fit.friction_master(
                VELOCITY, KELVIN[:, None], mu, 293.15, error=error
            )
            off.setdefault(name, []).append(master.log10_a - truth)
        np.testing.assert_allclose(master.error, (0.05 * curve).ravel())
    default, given = (np.square(off[name]).mean() for name in ("default", "given"))
    assert given < default
    for error, said in (
        ("some", "error must be a number"),
        (np.ones(5), "error must be of a shape that broadcasts"),
        (-1.0, "positive"),
    ):
        with pytest.raises(InputError, match=said):
            em.fit.friction_master(VELOCITY, KELVIN[:, None], mu, error=error)


def test_flat_friction_has_no_shift():
    rng = np.random.default_rng(0)
    flat = 0.7 + 0.01 * rng.normal(size=(KELVIN.size, VELOCITY.size))
    master = em.fit.friction_master(VELOCITY, KELVIN[:, None], flat, 293.15)
    assert any("too flat" in text for text in master.warnings)
    assert master.log10_a_std.max() > 0.2


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (
            (VELOCITY, KELVIN, measured()),
            "temperature must be of a shape that broadcasts",
        ),
        ((-VELOCITY, KELVIN[:, None], measured()), "velocity must be positive"),
        ((VELOCITY, 293.15, measured()[0]), "temperature must be 2 values"),
        (
            (VELOCITY, KELVIN[:, None], measured(), 400.0),
            "within the measured temperatures",
        ),
        ((VELOCITY, KELVIN[:, None], np.full((6, 12), np.nan)), "mu must be finite"),
    ],
)
def test_refusals_of_friction(arguments, said):
    with pytest.raises(InputError, match=said):
        em.fit.friction_master(*arguments)


RUBBER = em.Prony(
    1e6, np.geomspace(2e7, 4e5, 4), np.geomspace(1e-6, 1e-2, 4), shift=LAW
)
SCENE = {
    "load": 1.0,
    "temperature": KELVIN[::2, None],
    "model": em.Line(),
    "rtol": 1e-3,
}
SPEED = np.geomspace(1e-3, 1.0, 5)


def test_calibration_finds_what_was_changed():
    """A slope of the spectrum, a level and a shift constant are found again from noisy
    friction.
    """
    middle = np.exp(np.log(np.asarray(RUBBER.times)).mean())
    other = em.Prony(
        1e6 * 10**0.1,
        np.asarray(RUBBER.moduli)
        * 10**0.1
        * (np.asarray(RUBBER.times) / middle) ** 0.08,
        RUBBER.times,
        shift=em.WLF(6.0 * 10**0.05, 110.0, 293.15),
    )
    ball = em.Paraboloid(5e-3)
    mu = em.friction(other, ball, velocity=SPEED, **SCENE).mu
    mu = mu + 2e-4 * np.random.default_rng(0).normal(size=mu.shape)
    found = em.fit.calibrate(
        RUBBER,
        ball,
        velocity=SPEED,
        measured=mu,
        parameters=("modulus", "slope", "c1"),
        **SCENE,
    )
    truth = {"modulus": 0.1, "slope": 0.08, "c1": 0.05}
    assert found.converged
    for name, value in truth.items():
        assert abs(found.parameters[name] - value) < 4 * found.std[name]
        assert found.std[name] < 0.05
    assert found.error == pytest.approx(2e-4, rel=0.5)
    np.testing.assert_allclose(found.material.moduli, other.moduli, rtol=0.1)
    np.testing.assert_allclose(
        em.friction(found.material, ball, velocity=SPEED, **SCENE).mu,
        found.computed,
        rtol=1e-6,
    )
    assert "residuals" in repr(found)


def test_an_error_from_few_points_widens_intervals_as_students_t():
    """1.96 standard deviations held 85 % of 150 truths with five points and two
    parameters; Student's t has 3.18.
    """
    ball, speed, noise = (
        em.Paraboloid(5e-3),
        SPEED[:5],
        np.array([1.0, -1.0, 0.5, 1.0, -1.5]),
    )
    scene = SCENE | {"temperature": 293.15}
    mu = em.friction(RUBBER, ball, velocity=speed, **scene).mu + 2e-4 * noise
    arguments = {
        "velocity": speed,
        "measured": mu,
        "parameters": ("modulus", "slope"),
    } | scene
    found = em.fit.calibrate(RUBBER, ball, **arguments)
    known = em.fit.calibrate(RUBBER, ball, error=found.error, **arguments)
    for name in ("modulus", "slope"):
        # else the prior's part is not widened
        assert known.std[name] < 0.1 * known.prior[name]
        assert found.std[name] / known.std[name] == pytest.approx(
            3.182 / 1.96, rel=0.05
        )


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"parameters": ("slop",)}, ("parameters", "'slope'")),
        ({"parameters": "slope"}, ("parameters", "names")),
        ({"parameters": ()}, ("parameters", "names")),
        ({"measured": [0.1, np.nan]}, ("measured", "finite")),
        (
            {"measured": [0.1], "parameters": ("slope", "time")},
            ("measured", 1, 2),
        ),
        ({"quantity": "wear"}, ("quantity",)),
        (
            {"material": em.StandardSolid(1e6, 1e6, 1.0), "parameters": ("c1",)},
            ("", "material"),
        ),
        ({"material": "rubber"}, ("material", "Prony")),
        ({"error": -1.0}, ("error", "positive")),
        ({"parameters": ("q_high",)}, ("", "spectrum")),
        ({"parameters": ("length",)}, ("parameters", "gain")),
    ],
)
def test_refusals_of_calibration(changes, said):
    arguments = {
        "material": RUBBER,
        "shape": em.Paraboloid(5e-3),
        "velocity": SPEED[:2],
        "measured": [0.1, 0.1],
        "parameters": ("slope",),
        "load": 1.0,
    } | changes
    with refused(*said):
        em.fit.calibrate(arguments.pop("material"), arguments.pop("shape"), **arguments)


@pytest.mark.parametrize("points", [1, 3])
def test_fewer_points_than_parameters(points):
    """The priors stand for what they do not decide; nothing is surer than an error that
    no point contradicts.
    """
    ball, speed = em.Paraboloid(5e-3), SPEED[:points]
    scene = {"velocity": speed, "load": 1.0, "temperature": 293.15}
    mu = 1.2 * em.friction(RUBBER, ball, **scene).mu
    names = ("modulus", "slope", "time", "equilibrium")
    with pytest.warns(em.fit.FitWarning, match="assumed"):
        found = em.fit.calibrate(
            RUBBER, ball, measured=mu, parameters=names, draws=20, **scene
        )
    known = em.fit.calibrate(
        RUBBER, ball, measured=mu, parameters=names, error=0.05 * mu.max(), **scene
    )
    assert found.std == pytest.approx(known.std, rel=1e-6)
    assert found.undecided
    assert found.draws is not None
    assert np.isfinite(found.draws).all()
    with refused("measured", "one point"):
        em.fit.calibrate(
            RUBBER, ball, measured=[], parameters=names, velocity=[], load=1.0
        )


ROAD = em.SelfAffine(0.8, rms_height=2e-5, q_low=1e3, q_high=8e3)
HEAVY = {
    "velocity": SPEED[:3],
    "temperature": KELVIN[::3, None],
    "pressure": 1e6,
    "model": em.Line(equivalent_length=1e-2, periods=1, samples=256),
    "rtol": 1e-6,
}


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
def test_calibration_of_a_roughness_cutoff():
    """In full contact mu = gain sum (1/2) A^2 k E''(k v)/(p L): all but the cutoff are
    one factor.
    """
    truth = em.friction(RUBBER, ROAD.ended(1.2e4), **HEAVY)
    noisy = truth.mu * (1 + 1e-3 * np.random.default_rng(0).normal(size=truth.mu.shape))
    ask = {"measured": noisy, "error": 1e-3 * noisy, **HEAVY}
    alone = em.fit.calibrate(RUBBER, ROAD, parameters=("q_high",), **ask)
    wanted = np.log10(1.2e4 / 8e3)
    assert alone.converged
    assert abs(alone.parameters["q_high"] - wanted) < 4 * alone.std["q_high"]
    assert alone.std["q_high"] < 0.01
    assert alone.shape.q_high == pytest.approx(1.2e4, rel=0.03)
    again = em.friction(alone.material, alone.shape, **HEAVY)
    np.testing.assert_allclose(again.mu, alone.computed, rtol=1e-6)

    width = {"heights": 0.1, "gain": 0.2}
    start = {"q_high": wanted, "heights": 0.0, "gain": 0.0}
    free = em.fit.calibrate(RUBBER, ROAD, parameters=start, widths=width, **ask)
    # Known of log mu are 2 heights + gain and the cutoff: what is orthogonal
    # to it in prior widths stays open.
    factor = np.array([0.0, 2 * 0.1, 0.2])
    direction, left = free.weakest
    assert left == pytest.approx(1.0, abs=1e-3)
    assert abs(np.array(list(direction.values())) @ factor) < 0.02 * np.linalg.norm(
        factor
    )
    assert abs(direction["q_high"]) < 0.05
    assert "weakest" in repr(free)
    assert list(free.prior) == list(free.parameters)


def test_a_spectrum_ended_elsewhere():
    """Below its new end C stays; beyond a table it goes on as its last power law."""
    q = np.array([5e2, 2e3, 7e3, 8e3, 1.1e4])
    shorter, longer = ROAD.ended(7e3), ROAD.ended(1.2e4)
    np.testing.assert_allclose(shorter.at(q[:3]), ROAD.at(q[:3]))
    assert shorter.at(8e3) == 0
    np.testing.assert_allclose(
        longer.at(q), ROAD.c[0] * (q / 1e3) ** -3.6 * (q >= 1e3), rtol=1e-12
    )
    assert longer.ended(8e3).rms_slope == pytest.approx(ROAD.rms_slope, rel=1e-12)
    kinked = em.Spectrum([1e3, 2e3, 8e3], [1.0, 1.0, 1e-3], convention="2d")
    assert kinked.ended(4e3).moment(3) == pytest.approx(
        kinked.moment(3, 1e3, 4e3), rel=1e-12
    )
    assert kinked.ended(2e3).q.size == 2
    assert ROAD.raised(2.0).rms_height == pytest.approx(2 * ROAD.rms_height, rel=1e-12)
    with refused("q_high", "q_low"):
        ROAD.ended(1e3)
    with pytest.raises(InputError, match="factor must be positive"):
        ROAD.raised(0.0)


KELVINS = np.repeat([278.15, 293.15, 308.15], 7)
RIG = {
    "velocity": np.tile(np.geomspace(1e-6, 0.1, 7), 3),
    "temperature": KELVINS,
    "pressure": 3e5,
}
TREAD = em.load_material("tread-passenger-synthetic")
GROUND = em.SelfAffine(0.8, rms_slope=0.7, q_low=1.26e3, q_high=1e5)
KNOWN = {"q_high": 0.5, "stress": 0.3, "velocity": 1.0, "width": 0.3, "energy": 0.1}


def drawn_rig(seed, noise=0.03):
    """Logarithms of the factors on cutoff and typical shear law, and friction so."""
    random = np.random.default_rng(seed)
    truth = random.normal(size=5) * list(KNOWN.values())
    cutoff, stress, velocity, width, energy = 10.0**truth
    law = em.AdhesiveShear(
        6e6 * stress,
        5e-3 * velocity,
        0.1 * width,
        shift=em.Arrhenius(9e4 * energy, 293.15),
    )
    mu = em.friction(TREAD, GROUND.ended(1e5 * cutoff), adhesion=law, **RIG).mu
    size = noise * mu.mean()
    return truth, mu + size * random.normal(size=mu.shape), size


def test_intervals_of_cutoff_and_shear_hold_the_truth():
    """By standard deviations, and by draws; sixty cases: calibration_coverage.py."""
    linear, by_draws = [], []
    for seed in range(4):
        truth, mu, size = drawn_rig(100 + seed)
        found = em.fit.calibrate(
            TREAD,
            GROUND,
            measured=mu,
            error=size,
            parameters=("q_high", "shear"),
            widths=KNOWN,
            draws=0 if seed else 60,
            **RIG,
        )
        assert list(found.parameters) == list(KNOWN)
        for name, value in zip(KNOWN, truth, strict=True):
            low, high = found.interval(name, 0.9)
            (linear if found.draws is None else by_draws).append(low <= value <= high)
    assert np.mean(linear) > 0.7
    assert np.mean(by_draws) > 0.6
    assert found.adhesion is not None
    again = em.friction(TREAD, found.shape, adhesion=found.adhesion, **RIG)
    np.testing.assert_allclose(again.mu, found.computed, rtol=1e-12)


def test_draws_are_those_of_the_posterior():
    """Where everything is linear and Gaussian draws have its mean and covariance; an
    error that is estimated widens them as Student's t.
    """
    random = np.random.default_rng(1)
    x = np.linspace(-1, 1, 12)
    for error in (0.1, None):
        task = calibration._Task(
            lambda p: p[0] + p[1] * x,
            np.zeros(2),
            np.array([1.0, 0.2]),
            0.3 + 0.1 * x + 0.1 * random.normal(size=12),
            None if error is None else np.full(12, error),
            (1e-3,),
            1e-8,
        )
        solution = calibration._solve(task)
        draws, counted = calibration._draw(task, solution, 4000, 0)
        assert counted > 0.3
        std = np.sqrt(np.diag(solution.covariance))
        np.testing.assert_allclose(draws.mean(0), solution.point, atol=0.12 * std.max())
        np.testing.assert_allclose(draws.std(0), std, rtol=0.15)


@pytest.mark.parametrize("follows", [False, True])
def test_intervals_hold_the_truth_whatever_the_scatter_follows(follows):
    """No error given, friction over a decade, scatter of one size or a share of it:
    absolute errors alone held the slope of the latter in 78 to 82 % of such cases.
    """
    x, truth = np.linspace(-1, 1, 24), np.array([np.log(0.5), 1.2])
    mu, held, said = np.exp(truth[0] + truth[1] * x), [], []
    for seed in range(200):
        noise = 0.05 * np.random.default_rng(seed).normal(size=24)
        task = calibration._Task(
            lambda p: np.exp(p[0] + p[1] * x),
            truth + 0.05,
            np.array([3.0, 3.0]),
            mu + noise * (mu if follows else mu.mean()),
            None,
            (1e-3,),
            1e-8,
        )
        solution = calibration._solve(task)
        std = np.sqrt(np.diag(solution.covariance))
        held.append(np.abs(solution.point - truth) < 1.645 * std)
        said.append("share" in solution.scatter)
    assert np.all(np.abs(np.mean(held, axis=0) - 0.9) < 0.045)
    assert abs(np.mean(said) - follows) < 0.1


@pytest.mark.parametrize("points", [3, 1])
def test_a_point_without_an_answer_beside_the_solution(points):
    """It has no derivative: intervals are those of the others."""
    x = np.array([3.0, 1.0, 2.0])[:points]

    def compute(p):
        return np.where((x == 3) & (abs(p) > 0.01), np.nan, (1 + p) * x)

    task = calibration._Task(
        compute, np.zeros(1), np.ones(1), x, 0.1 * np.ones(points), (0.05,), 1e-8
    )
    if points == 1:
        with refused("measured", 1):
            calibration._solve(task)
        return
    solution = calibration._solve(task)
    assert solution.used.tolist() == [False, True, True]
    assert solution.covariance[0, 0] == pytest.approx(1 / (1 + 500))
    said = calibration._judge(task, ["gain"], np.ones(1), solution, 1.0)
    assert any(each.startswith("1 of 3") for each in said)


@pytest.mark.parametrize("error", [1e-9, None])
def test_computed_points_are_no_surer_than_a_measurement(error):
    """Nor are draws, which would be narrow without end."""
    ball = em.Paraboloid(5e-3)
    at = {"velocity": SPEED, "load": 1.0, "temperature": 293.15}
    mu = em.friction(RUBBER, ball, **at).mu
    ask = {"measured": mu, "parameters": ["modulus"], **at}
    with pytest.warns(em.fit.FitWarning, match="5 of 5"):
        found = em.fit.calibrate(RUBBER, ball, error=error, draws=40, **ask)
    assert found.error == pytest.approx(1e-3 * np.sqrt(np.mean(mu**2)))
    known = em.fit.calibrate(RUBBER, ball, error=1.001e-3 * mu, **ask)
    assert known.warnings == ()
    # a factor, not its logarithm
    ends = 10.0 ** np.array([known.parameters["modulus"], *known.interval("modulus")])
    value, low, high = (f"{end:.3g}" for end in ends)
    assert known.in_units("modulus") == f"{value} ({low} to {high})"
    assert found.std["modulus"] == pytest.approx(known.std["modulus"], rel=0.01)
    assert np.std(found.draws) == pytest.approx(known.std["modulus"], rel=0.4)


def test_what_friction_does_not_decide_is_said():
    """One temperature and one flank: no energy, and a summit that is not known."""
    slow = {"velocity": np.geomspace(1e-6, 3e-6, 8), "temperature": 293.15}
    law = em.AdhesiveShear(6e6, 5e-3, 0.1, shift=em.Arrhenius(9e4, 293.15))
    mu = em.friction(TREAD, GROUND, adhesion=law, pressure=3e5, **slow).mu
    mu = np.array(mu) * (1 + 0.1 * np.random.default_rng(0).normal(size=8))
    found = em.fit.calibrate(
        TREAD,
        GROUND,
        measured=mu,
        error=0.1 * mu,
        adhesion=law,
        parameters=("shear",),
        pressure=3e5,
        **slow,
    )
    assert list(found.parameters) == ["stress", "velocity", "width"]
    assert "stress" in found.undecided
    said = dict(found.findings())
    assert "not decided" in said["stress"]
    with refused("parameters", "energy"):
        em.fit.calibrate(
            TREAD,
            GROUND,
            measured=mu,
            adhesion=em.AdhesiveShear(6e6, 5e-3, 0.1),
            parameters=("energy",),
            pressure=3e5,
            **slow,
        )
    with refused("draws", -1):
        em.fit.calibrate(
            TREAD, GROUND, measured=mu, draws=-1, parameters=("q_high",), **slow
        )


def test_parameters_that_do_not_describe_the_data():
    """A cutoff alone, where most of the friction is adhesion."""
    _, mu, size = drawn_rig(3)
    with pytest.warns(em.fit.FitWarning, match="times the error given"):
        found = em.fit.calibrate(
            TREAD,
            GROUND,
            measured=mu,
            error=size,
            parameters=("q_high",),
            widths={"q_high": 0.2},
            **RIG,
        )
    assert any(said.startswith("q_high went") for said in found.warnings)


def test_a_trend_that_no_parameter_follows_is_said():
    """Dry friction by the cutoff alone, no error given; and what has one is quiet."""
    law = em.AdhesiveShear(4.5e6, 2e-3, 0.14)
    at = {"velocity": np.geomspace(1e-3, 0.1, 5), "pressure": 3e5}
    rubber = TREAD.at(293.15)
    dry, wet = (
        em.friction(rubber, GROUND.ended(5e4), adhesion=shear, **at).mu
        for shear in (law, None)
    )
    with pytest.warns(em.fit.FitWarning, match="follow the velocity"):
        em.fit.calibrate(rubber, GROUND, measured=dry, parameters=["q_high"], **at)
    noisy = wet * (1 + 0.03 * np.random.default_rng(0).normal(size=wet.shape))
    found = em.fit.calibrate(
        rubber, GROUND, measured=noisy, parameters=["q_high"], **at
    )
    assert found.warnings == ()
    curve = em.friction(rubber, found.shape, **at)
    assert {d.kind for d in found.doubts} == {d.kind for d in curve.doubts} != set()
    assert "doubts" in found.summary()


def test_points_far_off_and_the_table(tmp_path):
    _, mu, size = drawn_rig(3)
    mu[3] *= 1.5
    with pytest.warns(em.fit.FitWarning, match="Far off"):
        found = em.fit.calibrate(
            TREAD,
            GROUND,
            measured=mu,
            error=size,
            parameters=("q_high", "shear"),
            **RIG,
        )
    assert f"{RIG['velocity'][3]:.3g} m/s" in " ".join(found.warnings)
    assert found.in_units("q_high").startswith(f"{found.shape.q_high:.3g} rad/m (")
    assert {"at 5 °C", "at 20 °C", "at 35 °C"} <= dict(found.findings()).keys()
    points, *_ = found.plot().get_lines()
    np.testing.assert_allclose(points.get_ydata(), mu[:7])
    found.to_csv(tmp_path / "table.csv")
    again = em.read_friction(tmp_path / "table.csv", columns={"mu": "measured [-]"})
    np.testing.assert_allclose(again.mu, mu)
    np.testing.assert_allclose(again.temperature, KELVINS)
