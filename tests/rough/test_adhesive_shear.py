"""Adhesive shear: the law by its formula, on the area of real contact of each model,
errors, scenes, derivatives.
"""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.rough.multiscale import _AREA_BOUND

from ..refused import mentions, refused

RUBBER = em.StandardSolid(
    1e6, 9e6, 1e-3, shift=em.WLF(8.9, 101.6, 293.15), name="solid"
)
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=3e4)
LAW = em.AdhesiveShear(5e6, 3e-3, 0.12, shift=em.Arrhenius(9e4, 293.15))
SCENE = {
    "velocity": np.geomspace(1e-4, 1, 5),
    "pressure": 1e5,
    "temperature": np.array([[283.15], [303.15]]),
}


def formula(v, kelvin, stress=5e6, peak=3e-3, width=0.12, energy=9e4):
    a = np.exp(energy / 8.31446261815324 * (1 / kelvin - 1 / 293.15))
    return stress * np.exp(-width * np.log10(v * a / peak) ** 2)


def test_the_stress_is_a_bell_in_log_velocity_that_warmth_moves_to_higher_ones():
    v = np.geomspace(1e-6, 10, 9)
    assert LAW.shear_stress(v, 303.15) == pytest.approx(formula(v, 303.15), rel=1e-13)
    assert LAW.shear_stress(3e-3, 293.15) == pytest.approx(5e6, rel=1e-14)
    assert LAW.shear_stress(0.3, 293.15) == pytest.approx(
        5e6 * np.exp(-0.48), rel=1e-13
    )
    a = float(LAW.shift.a(313.15))
    assert LAW.shear_stress(3e-3 / a, 313.15) == pytest.approx(5e6, rel=1e-13)
    athermal = em.AdhesiveShear(5e6, 3e-3, 0.12)
    assert athermal.shear_stress(v[:, None], [280.0, 320.0]) == pytest.approx(
        np.repeat(formula(v, 293.15)[:, None], 2, 1), rel=1e-13
    )


@pytest.mark.parametrize("model", ["multiscale", "persson"])
def test_on_a_surface_friction_is_hysteresis_and_the_shear_of_the_real_contact(model):
    bare = em.friction(RUBBER, ROAD, model=model, **SCENE)
    both = em.friction(RUBBER, ROAD, model=model, adhesion=LAW, **SCENE)
    shear = formula(SCENE["velocity"], SCENE["temperature"]) * bare.area_ratio / 1e5
    assert np.array_equal(both.hysteresis, bare.mu)
    assert both.adhesion == pytest.approx(shear, rel=1e-12)
    assert both.mu == pytest.approx(both.hysteresis + both.adhesion, rel=1e-15)
    assert both.friction_force == pytest.approx(both.mu * 1e5, rel=1e-14)
    assert bare.hysteresis is None
    # What the area may be off, by the rule of docs/theory.md; cutoffs are no further
    # apart than in three dimensions.
    a, b, _ = _AREA_BOUND
    off = (a - b * np.log(bare.area_ratio)) * (1 - bare.area_ratio) ** 0.25
    off = np.expm1(off * (ROAD.q_high / ROAD.q_low / 8) ** -0.1)
    # and what shear does to it, numerical errors left out
    room = np.maximum(1 - bare.mu * shear, bare.area_ratio)
    high = (both.mu + bare.model_error + shear * off) / room
    low = bare.mu - bare.model_error + shear * (1 - off) * (1 - 0.3 * shear**2)
    bound = np.maximum(high - both.mu, both.mu - low)
    bound = np.where(shear > 1, np.nan, bound)
    assert both.model_error == pytest.approx(bound, rel=1e-4, nan_ok=True)
    assert np.all(both.error >= bare.error)
    assert np.all(both.error < 1e-5 * both.mu)
    assert "adhesive shear" in both.model
    assert "parts of mu" in both.summary()
    assert {
        "friction coefficient of hysteresis [-]",
        "friction coefficient of adhesive shear [-]",
    } <= set(both.columns())


def test_the_area_of_a_map_of_cells_carries_the_shear_too():
    road = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
    # its shear is below the pressure
    law = em.AdhesiveShear(5e5, 3e-3, 0.12, shift=LAW.shift)
    cells = em.friction(
        RUBBER,
        road,
        velocity=0.01,
        pressure=2e5,
        temperature=293.15,
        adhesion=law,
        rtol=1e-2,
        model=em.HalfSpace(seeds=2, cells=128),
    )
    smooth = em.friction(
        RUBBER, road, velocity=0.01, pressure=2e5, temperature=293.15, adhesion=law
    )
    shear = formula(0.01, 293.15, 5e5) / 2e5
    assert cells.adhesion == pytest.approx(shear * cells.area_ratio, rel=1e-12)
    assert cells.mu == pytest.approx(cells.hysteresis + cells.adhesion, rel=1e-15)
    assert abs(cells.mu - smooth.mu) < smooth.model_error + cells.error
    assert cells.error > 1e-3 * cells.adhesion  # the scatter of the area, of two maps


def test_shear_above_the_pressure_is_no_prediction():
    both = em.friction(RUBBER, ROAD, adhesion=LAW, **SCENE)
    over = both.adhesion > 1
    assert 0 < over.sum() < over.size
    np.testing.assert_array_equal(np.isnan(both.model_error), over)
    said = f"{over.sum()} of 10 points have no bound"
    most = both.adhesion[over].max()
    assert mentions(both.summary(), said, f"up to {most:.4g} times", "mu_low")
    weak = em.friction(
        RUBBER, ROAD, adhesion=em.AdhesiveShear(5e4, 3e-3, 0.12), **SCENE
    )
    assert np.isfinite(weak.model_error).all()
    assert "no prediction" not in weak.summary()
    ball = em.friction(
        em.Prony(1e6, [1.0], [1e-3]),
        em.Paraboloid(0.01),
        velocity=1e-2,
        load=2.0,
        adhesion=em.AdhesiveShear(2e6, 1e-2, 0.1),
    )
    assert ball.adhesion > 1
    assert np.isnan(ball.model_error)
    assert ball.mu_low < ball.mu < ball.mu_high
    cells = em.friction(
        RUBBER,
        em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3),
        velocity=0.01,
        pressure=2e5,
        temperature=293.15,
        adhesion=LAW,
        rtol=1e-2,
        model=em.HalfSpace(seeds=1, cells=64),
    )
    assert cells.adhesion > 1
    assert np.isnan(cells.model_error)
    assert np.isnan(cells.mu_low)  # the scatter of a single map is not known


class TestLimits:
    """What is known of mu where shear may change the contact."""

    def test_they_open_from_the_bounds_of_the_parts_as_shear_grows(self):
        """Without a step where the shear reaches the pressure."""
        at = {"velocity": 0.1, "pressure": 1e5}
        rubber = RUBBER.at(293.15)

        def dry(stress):
            law = em.AdhesiveShear(stress, 0.1, 0.0)
            return em.friction(rubber, ROAD, adhesion=law, **at)

        def numbers(stress):
            found = dry(stress)
            return [found.mu, found.mu_low, found.mu_high, found.model_error]

        bare = em.friction(rubber, ROAD, **at)
        once = float(dry(1e6).adhesion)
        reach = np.concatenate([np.geomspace(1e-5, 0.1, 5), np.arange(0.15, 2, 0.05)])
        stress = reach * 1e6 / once
        mu, low, high, bound = np.array([numbers(each) for each in stress.tolist()]).T
        assert high[0] - mu[0] == pytest.approx(bare.model_error, rel=1e-3)
        assert mu[0] - low[0] == pytest.approx(bare.model_error, rel=1e-3)
        below = reach < 1
        np.testing.assert_array_equal(np.isnan(bound), ~below)
        off = np.maximum(high - mu, mu - low)
        np.testing.assert_allclose(bound[below], off[below], rtol=1e-5)
        for end in (mu, low, high, bound[below]):
            steps = np.diff(end)[5:]
            assert (np.diff(end) > 0).all()
            # the largest step of a smooth curve is near its neighbours
            assert (steps[1:] < 1.3 * steps[:-1] + 0.02 * end.max()).all()
        a, h, area = reach, float(bare.mu), float(bare.area_ratio)
        assert (low < h + a * np.where(below, 1 - 0.3 * a**2, 0.7)).all()
        assert (low[~below] > 0.5 * (h + 0.7 * a)[~below]).all()
        grown = (h + a) / np.maximum(1 - h * a, area)
        assert (high > grown).all()
        assert (high < 1.4 * grown).all()
        beside = [1e6 / once * x for x in (0.999, 1.001)]
        with jax.enable_x64(True):
            slopes = np.array([jax.jit(jax.jacfwd(numbers))(x) for x in beside])
            traced = np.array([jax.jit(numbers)(x) for x in beside])
        np.testing.assert_allclose(traced, [numbers(x) for x in beside], rtol=1e-9)
        assert np.isfinite(slopes[0]).all()
        assert np.isfinite(slopes[1, :3]).all()
        assert (slopes[:, :3] > 0).all()
        h = 1e-4 * beside[0]
        ends = (np.array(numbers(beside[0] + x), dtype=float) for x in (h, -h))
        centred = -np.diff(list(ends), axis=0)[0] / (2 * h)
        np.testing.assert_allclose(slopes[0], centred, rtol=1e-5)

    def test_the_part_of_the_model_and_its_band_hold_them(self):
        strong = em.AdhesiveShear(2e6, 0.1, 0.0)
        both = em.friction(
            RUBBER.at(293.15),
            ROAD,
            velocity=0.1,
            pressure=[1e5, 2e5, 5e5],
            adhesion=strong,
        )
        assert (both.hysteresis * both.adhesion > 0.01).all()
        found, mu = both.uncertainty(), both.mu
        off = np.maximum(both.mu_high - mu, mu - both.mu_low)
        parts = found["numerical"].share + found["model"].share
        np.testing.assert_allclose(parts, off / mu)
        assert (found.half_band() >= off / mu).all()

    def test_no_contact_is_larger_than_the_nominal_one(self):
        """However steep and strong: all touches, and bears the stress."""
        law = em.AdhesiveShear(5e7, 3e-3, 0.0)
        road = em.SelfAffine(0.8, rms_slope=1.0, q_low=1e3, q_high=3e4)
        at = {"velocity": 0.1, "pressure": 1e5}
        both = em.friction(RUBBER.at(293.15), road, adhesion=law, **at)
        assert both.hysteresis * both.adhesion > 1
        most = (both.hysteresis + both.adhesion) / both.area_ratio
        assert most < both.mu_high < 1.3 * most

    def test_the_upper_one_is_a_wedge_that_rubber_climbs(self):
        """With tan(phi) for hysteresis and tan(delta) for shear: tan(phi + delta)."""
        from elastomdr.rough.adhesion import sheared

        at = {"velocity": 0.1, "load": 1.0}
        curve = em.friction(RUBBER.at(293.15), em.Paraboloid(0.01), **at)
        zero = np.zeros(())
        phi, delta = 0.2, 0.9
        curve = dataclasses.replace(curve, mu=np.tan(phi), error=zero, model_error=zero)
        law = em.AdhesiveShear(1.0, 0.1, 0.0)
        made = sheared(curve, law, np.tan(delta), 0.0, 0.0, "wedge", np.array(1e6))
        np.testing.assert_allclose(made.mu_high, np.tan(phi + delta), rtol=1e-12)
        low = np.tan(phi) + 0.7 * np.tan(delta)
        np.testing.assert_allclose(made.mu_low, low, rtol=1e-12)

    @pytest.mark.parametrize("velocity", [1e-3, 1e-2, 1.0])
    def test_the_mean_slope_of_a_contact_is_below_its_hysteresis(self, velocity):
        """Which the upper limit rests on: in three dimensions, where the slope weighted
        by the pressure is mu.
        """
        from elastomdr.rough.half_space import solve

        n, side = 128, 2 * np.pi / 500.0
        k = 2 * np.pi * np.fft.fftfreq(n, side / n)
        q = np.hypot(*np.meshgrid(k, k, indexing="ij"))
        inside = (q >= 1e3) & (q <= 1.2e4)
        road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1.2e4)
        power = np.where(inside, road.at(np.clip(q, 1e3, 1.2e4)), 0.0)
        noise = np.random.default_rng(3).standard_normal((n, n))
        waves = np.fft.fft2(noise) * np.sqrt(power) * 2 * np.pi / side * n
        height = np.fft.ifft2(waves).real
        slope = np.fft.ifft2(1j * k[:, None] * waves).real
        times, moduli = np.geomspace(1e-7, 1, 8), np.geomspace(2e8, 5e5, 8)
        law = em.half_space(em.Prony(1e6, moduli, times)).law()
        for pressure in (2e5, 1e6):
            found = solve(
                law.complex_modulus,
                height,
                (side, side),
                velocity=velocity,
                pressure=pressure,
            )
            mu, touching = found.stress / pressure, found.pressure > 0
            # the map moves towards +x: rubber climbs where heights fall along it
            by_pressure = -(found.pressure * slope).mean() / pressure
            assert by_pressure == pytest.approx(mu, rel=0.05)
            assert 0.2 * mu < -slope[touching].mean() < 0.9 * mu

    def test_they_and_the_doubt_are_in_all_that_is_made_of_the_curve(self, tmp_path):
        scene = SCENE | {"temperature": 293.15}
        both = em.friction(RUBBER, ROAD, adhesion=LAW, **scene)
        lost = np.asarray(both.adhesion > 1)
        table = both.to_pandas()
        low, high = (
            f"{end} limit of the friction coefficient [-]" for end in ("lower", "upper")
        )
        np.testing.assert_array_equal(table[low], both.mu_low)
        np.testing.assert_array_equal(table[high], both.mu_high)
        both.to_csv(tmp_path / "dry.csv")
        laws = both.law(), em.load_friction(tmp_path / "dry.csv")
        for law in laws:
            (points,) = {
                np.asarray(d.points).ravel().tobytes()
                for d in law.doubts
                if d.kind == "no prediction" and np.array_equal(d.points.ravel(), lost)
            }
            assert points == lost.tobytes()
        ends = np.concatenate(
            [c.get_paths()[0].vertices[:, 1] for c in both.plot().collections]
        )
        for end in (both.mu_low[lost].min(), both.mu_high[lost].max()):
            assert np.isclose(ends, end).any()
        i = int(both.mu.argmax())
        how = dict(both.headline())["how sure"]
        assert mentions(how, f"{both.mu_low[i]:.3g} to {both.mu_high[i]:.3g} there")

    def test_they_are_known_under_jit(self):
        def ends(v):
            at = {"velocity": v, "pressure": 1e5, "temperature": 293.15}
            both = em.friction(RUBBER, ROAD, adhesion=LAW, **at)
            return both.mu_low, both.mu_high

        with jax.enable_x64(True):
            traced = jax.jit(ends)(SCENE["velocity"])
        np.testing.assert_allclose(traced, ends(SCENE["velocity"]), rtol=1e-9)


def test_in_full_contact_no_bound_is_known_of_the_law():
    """The area is that of the surface, exactly: its bound says nothing of the shear."""
    weak, soft = em.AdhesiveShear(5e4, 3e-3, 0.12), em.StandardSolid(1e5, 1e5, 1e-3)
    smooth = em.SelfAffine(0.8, rms_slope=0.1, q_low=1e3, q_high=3e4)
    scene = {"velocity": [1e-3, 0.1], "pressure": 1e5, "temperature": None}
    bare = em.friction(soft, smooth, **scene)
    found = em.friction(soft, smooth, adhesion=weak, **scene)
    assert (found.area_ratio > 0.99).all()
    assert np.isfinite(bare.model_error).all()
    assert np.isnan(found.model_error).all()
    (doubt,) = (d for d in found.doubts if "shear law" in d.says)
    assert doubt.kind == "no prediction"
    assert np.asarray(doubt.points).all()
    jitted = jax.jit(
        lambda v: (
            em.friction(
                soft, smooth, adhesion=weak, **scene | {"velocity": v}
            ).model_error
        )
    )
    with jax.enable_x64(True):
        assert np.isnan(jitted(np.array([1e-3, 0.1]))).all()


def test_of_several_materials_each_has_its_parts():
    soft = em.StandardSolid(5e5, 9e6, 1e-3, shift=RUBBER.shift, name="soft")
    both = em.friction([RUBBER, soft], ROAD, adhesion=LAW, **SCENE)
    assert both.adhesion.shape == (2, 2, 5)
    assert np.all(both.adhesion[1] > both.adhesion[0])  # the softer one touches more
    assert both.plot() is not None


def test_under_a_smooth_body_the_area_is_that_between_its_edges():
    law, load = em.AdhesiveShear(1e5, 1e-2, 0.1), 2.0
    elastic = em.Prony(1e6, [1.0], [1e-3])
    ball = em.friction(
        elastic, em.Paraboloid(0.01), velocity=1e-2, load=load, adhesion=law
    )
    a = (0.75 * load * 0.01 / 4e6) ** (1 / 3)  # Hertz, E* = 4 G
    assert ball.contact_area == pytest.approx(np.pi * a**2, rel=1e-5)
    assert ball.adhesion == pytest.approx(1e5 * np.pi * a**2 / load, rel=1e-5)
    roll = em.friction(
        em.springs(RUBBER, 2e-3, bonded=False),
        em.Cylinder(0.05, 0.1),
        velocity=0.1,
        load=50.0,
        adhesion=law,
    )
    assert roll.contact_area == pytest.approx(
        0.1 * (roll.contact.leading + roll.contact.trailing), rel=1e-14
    )
    assert roll.mu == pytest.approx(
        roll.hysteresis + formula(0.1, 293.15, 1e5, 1e-2, 0.1) * roll.contact_area / 50
    )


def test_derivatives_through_both_parts_are_those_of_differences():
    start = np.array([5e6, 3e-3, 0.12, 9e4, 1e5, 9e6, 300.0])

    def mu(factor):
        stress, velocity, width, energy, pressure, modulus, kelvin = (
            start[i] * factor[i] for i in range(7)
        )
        law = em.AdhesiveShear(
            stress, velocity, width, shift=em.Arrhenius(energy, 293.15)
        )
        solid = em.StandardSolid(1e6, modulus, 1e-3, shift=em.WLF(8.9, 101.6, 293.15))
        return em.friction(
            solid,
            ROAD,
            velocity=0.05,
            pressure=pressure,
            temperature=kelvin,
            adhesion=law,
            rtol=1e-9,
        ).mu

    with jax.enable_x64(True):
        slopes = np.array(jax.jit(jax.grad(mu))(jnp.ones(7)))
    # all seven at once, their parts of one size, so that none hides behind another
    assert np.abs(slopes).min() > 1e-3
    x = np.array([1, -1, 1, 1, -1, 1, 1]) / slopes
    h = 1e-4
    centred = (
        8 * (mu(1 + h * x) - mu(1 - h * x)) - mu(1 + 2 * h * x) + mu(1 - 2 * h * x)
    ) / (12 * h)
    # cells of the traced integrals do not end where P(q e^a) reaches q_high
    assert slopes @ x == pytest.approx(centred, rel=5e-5)


def test_derivatives_under_a_smooth_body():
    def mu(stress, load):
        law = em.AdhesiveShear(stress * 1e5, 1e-2, 0.1)
        return em.friction(
            em.StandardSolid(1e6, 9e6, 1e-2),
            em.Paraboloid(0.01),
            velocity=0.02,
            load=load,
            adhesion=law,
            rtol=1e-8,
        ).mu

    with jax.enable_x64(True):
        exact = np.array(jax.jit(jax.grad(mu, (0, 1)))(1.0, 1.0), dtype=float)
    h = 1e-3
    centred = [
        float(mu(1 + h, 1.0) - mu(1 - h, 1.0)) / (2 * h),
        float(mu(1.0, 1 + h) - mu(1.0, 1 - h)) / (2 * h),
    ]
    assert exact == pytest.approx(centred, rel=1e-5)


LINE = em.RoughLine(np.arange(64) / 64e3, 1e-6 * np.sin(2 * np.pi * np.arange(64) / 64))


@pytest.mark.parametrize(
    ("call", "named"),
    [
        (lambda: em.AdhesiveShear(-1.0, 1e-3, 0.1), ("stress", -1)),
        (lambda: em.AdhesiveShear(1e6, 0.0, 0.1), ("velocity", 0)),
        (lambda: em.AdhesiveShear(1e6, 1e-3, -0.1), ("width", -0.1)),
        (lambda: em.AdhesiveShear(1e6, 1e-3, 0.1, shift=9e4), ("shift", 90000)),
        (lambda: LAW.shear_stress(1.0), ("temperature", "shift law")),
        (
            lambda: em.friction(RUBBER, ROAD, velocity=1.0, pressure=1e5, adhesion=5e6),
            ("adhesion", "em.AdhesiveShear"),
        ),
        (
            lambda: em.friction(RUBBER, ROAD, velocity=1.0, pressure=1e5, adhesion=LAW),
            ("temperature", "shift law"),
        ),
        (
            lambda: em.friction(
                RUBBER, em.Sphere(0.01), velocity=1.0, load=1.0, adhesion=LAW
            ),
            ("temperature", "shift law"),
        ),
        (
            lambda: em.friction(RUBBER, LINE, velocity=1.0, load=1.0, adhesion=LAW),
            ("adhesion", "area of real contact"),
        ),
        (
            lambda: em.friction(RUBBER, ROAD, velocity=1.0, load=1.0, adhesion=LAW),
            ("adhesion", "area of real contact"),
        ),
        (
            lambda: em.friction(
                RUBBER, ROAD, velocity=1.0, pressure=1e5, model="line", adhesion=LAW
            ),
            ("adhesion", "em.Multiscale"),
        ),
        (
            lambda: em.plan(
                RUBBER, LINE, velocity=1.0, load=1.0, temperature=300.0, adhesion=LAW
            ),
            ("adhesion", "area of real contact"),
        ),
    ],
)
def test_bad_input_is_one_clear_line(call, named):
    with refused(*named) as caught:
        call()
    assert "\n" not in str(caught.value)


SCENE_FILE = """
material = "tread-passenger-synthetic"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.7
longest = "5 mm"
shortest = "20 um"
[adhesion]
stress = "6 MPa"
velocity = "5 mm/s"
width = 0.1
{more}
[contact]
pressure = "0.3 MPa"
velocity = ["1 mm/s", "10 mm/s"]
"""


def test_a_scene_has_a_table_for_it(tmp_path, capsys):
    path = tmp_path / "dry.toml"
    path.write_text(
        SCENE_FILE.format(more='energy = "80 kJ/mol"\nreference = "20 degC"'),
        encoding="utf-8",
    )
    assert main(["friction", str(path), "--out", str(tmp_path), "--verbose"]) == 0
    said = capsys.readouterr().out
    assert "6 MPa at 0.005 m/s" in said
    header, *rows = [
        x
        for x in (tmp_path / "dry-friction.csv").read_text("utf-8").splitlines()
        if x[0] != "#"
    ]
    table = dict(
        zip(
            header.split(","), np.array([row.split(",") for row in rows]).T, strict=True
        )
    )
    mu, one, other, area = (
        table[f"{name} [-]"].astype(float)
        for name in (
            "friction coefficient",
            "friction coefficient of hysteresis",
            "friction coefficient of adhesive shear",
            "real contact area over nominal area",
        )
    )
    assert mu == pytest.approx(one + other, rel=1e-12)
    v = np.array([1e-3, 1e-2])
    assert other == pytest.approx(
        formula(v, 293.15, 6e6, 5e-3, 0.1, 8e4) * area / 3e5, rel=1e-9
    )
    assert main(["plan", str(path)]) == 0
    path.write_text(SCENE_FILE.format(more='energy = "80 kJ/mol"'), encoding="utf-8")
    assert main(["friction", str(path), "--out", str(tmp_path)]) == 2
    assert "reference belong together" in capsys.readouterr().err


def test_with_heat_a_point_without_an_answer_is_nan():
    """Its temperature, NaN, is none that a shift law takes; other points keep
    theirs.
    """
    # shift factors up to 53 degC only, beyond which heat has no answer
    rubber = em.load_material("epdm-70")
    heat, road = (
        em.Heat(0.25, 2e6),
        em.SelfAffine(0.8, rms_slope=1.0, q_low=1.2e3, q_high=3e5),
    )
    with pytest.warns(em.ConvergenceWarning):
        found = em.friction(
            rubber,
            road,
            velocity=[1e-4, 10.0],
            pressure=3e5,
            temperature=293.15,
            heat=heat,
            adhesion=LAW,
        )
    assert list(found.converged) == [True, False]
    assert np.isfinite(found.mu[0])
    assert np.isnan([found.mu[1], found.adhesion[1]]).all()


def test_a_preset_has_a_band_that_the_uncertainty_takes_and_a_source():
    law = em.AdhesiveShear.preset(shift=em.Arrhenius(9e4, 293.15))
    assert [float(law.stress), float(law.velocity), float(law.width)] == [
        6e6,
        5e-3,
        0.1,
    ]
    with refused("name", "rubber on a road", "ice"):
        em.AdhesiveShear.preset("ice")
    asked = {"velocity": [1e-3, 0.1], "pressure": 1e5, "temperature": 293.15}
    curve = em.friction(RUBBER, ROAD, adhesion=law, **asked)
    said = dict(curve.inputs)["adhesion"]
    assert mentions(said, "typical, not measured", 5, 7, "Lorenz")
    part = curve.uncertainty()["shear law"]
    assert mentions(part.assumed, 5, 7, "Lorenz")
    ends = [
        em.friction(
            RUBBER,
            ROAD,
            adhesion=em.AdhesiveShear(stress, 5e-3, 0.1, shift=law.shift),
            **asked,
        )
        for stress in (5e6, 7e6)
    ]
    apart = np.max([np.abs(end.mu / curve.mu - 1) for end in ends], axis=0)
    np.testing.assert_allclose(part.share, apart, rtol=1e-3)
    assert 0.01 < apart.max() < 1 / 6
    measured = dict(ends[0].inputs)["adhesion"]
    assert "typical" not in measured
