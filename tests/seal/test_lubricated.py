"""Lubricated line contacts against published and closed solutions, and their limits."""

import contextlib
import warnings
from itertools import combinations

import jax
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import brentq
from scipy.signal import savgol_filter

import elastomdr as em
from elastomdr.seal import film, lubricated
from elastomdr.seal.response import bodies_of, response
from elastomdr.seal.roughness import pressed

from ..refused import refused, warned
from .heights import measured

RUBBER = em.Prony(1e6, [3e6, 2e6], [1e-4, 1e-2], name="rubber")
BODIES = bodies_of(em.Prony(0.25, [], []))  # E* = 1 Pa
BODY = em.Cylinder(5e-3, 1.0)
ROUGH = em.SelfAffine(hurst=0.8, rms_height=3e-7, q_low=1e5, q_high=1e7)


def elastic(x):
    return 0.5 * response(BODIES, x, 0.0, 1.0)


def rigid(x):
    return np.zeros((x.size, x.size - 2))


def extrapolated(levels, number):
    coarse, fine = (number(each) for each in levels[-2:])
    return fine + (fine - coarse) / 3


def numbers(found):
    centre = film.CubicSpline(found.places, found.film)(0.0)
    near = film.CubicSpline(np.arange(found.film.size), found.film)
    least = near(np.linspace(-1, 1, 401) + found.film.argmin()).min()
    return np.array([centre, least, found.flow, found.total.max()])


@pytest.mark.parametrize(
    ("lam", "inlet", "expected"),
    [
        (3.0, -20.0, (1.0995, 1.0075, 1.2489, 0.6099)),
        (1.0, -20.0, (0.5403, 0.4434, 0.5558, 0.7866)),
        (0.1, -4.0, (0.12357, 0.09691, 0.12275, 0.9501)),
        (0.03, -4.0, (0.05779, 0.04559, 0.05765, 0.9777)),
        (0.01, -4.0, (0.02925, 0.02315, 0.02922, 0.9897)),
    ],
)
def test_elastic_isoviscous_line_contact(lam, inlet, expected):
    """Films, flow and pressure of an independent solution on 601 and 2401 points."""
    case = film.Case(lam, (-1.0, 1.0), elastic, inlet=inlet)
    found = extrapolated(film.follow([case], 129)[0], numbers)
    # the last digit of the table is worth up to 2e-4 as well
    rounding = 0.5 * 10.0 ** -(np.array([4 if lam > 0.5 else 5] * 3 + [4]))
    assert (np.abs(found - expected) < 2e-4 * found + rounding).all()


def test_four_times_finer_grid():
    cases = [film.Case(lam, (-1.0, 1.0), elastic) for lam in (1.0, 0.03, 1e-4)]
    for levels in film.follow(cases, 129, 4):
        usual, fine = extrapolated(levels[:2], numbers), extrapolated(levels, numbers)
        assert usual[:3] == pytest.approx(fine[:3], rel=1e-4)


def test_rigid_cylinder():
    """w' = 4.895 eta u R/h_min, h_0 = 1.2257 h_min (Martin 1916), from Reynolds'
    equation in theta, x = sqrt(2 R h_min) tan(theta), whose pressure vanishes at the
    exit with its slope.
    """

    def rises(exit_):
        """p' over its scale, by theta."""
        return lambda t: np.cos(t) ** 2 - (np.cos(t) ** 2 / np.cos(exit_)) ** 2

    def at_the_end(exit_):
        return quad(rises(exit_), -np.pi / 2, exit_)[0]

    exit_ = brentq(at_the_end, 0.1, 1.0, xtol=1e-14)
    load = quad(lambda t: -np.tan(t) * rises(exit_)(t), -np.pi / 2, exit_)[0]
    assert (24 * load, np.tan(exit_)) == pytest.approx((4.895, 0.4751), abs=1e-4)
    case = film.Case(100.0, (-1.0, 1.0), rigid, inlet=-2000.0)
    levels = []
    for count in (257, 513):
        contact = case.with_parameter(100.0, count)
        start = 0.13 * np.exp(-((contact.places[1:-1] + 3) ** 2) / 30)
        levels.append(film.solve(contact, start, 26.0))
    assert all(each.converged for each in levels)
    _, least, flow, _ = extrapolated(levels, numbers)
    assert least == pytest.approx(24 * load * 2 / (12 * np.pi) * 100, rel=1e-4)
    assert flow == pytest.approx(least / np.cos(exit_) ** 2, rel=1e-4)


def test_smooth_stribeck_curve_keeps_mass():
    curve = em.lubricated(
        RUBBER, BODY, velocity=np.geomspace(1e-6, 1e2, 12), load=1e3, viscosity=0.05
    )
    assert curve.converged.all()
    assert curve.imbalance.max() < 1e-10
    assert curve.mu == pytest.approx(curve.viscous)
    assert (np.diff(curve.film_thickness) > 0).all()
    x = np.linspace(curve.profile.x.min(), curve.profile.x.max(), 4001)
    per_length = np.trapezoid(curve.pressure(x), x, axis=-1)
    carried = 1e3 / BODY.length
    np.testing.assert_allclose(per_length, carried, rtol=5e-3)


@pytest.mark.parametrize("viscosity", [1e4, 1e8])
def test_films_as_thick_as_the_body(viscosity):
    """Beside a point that is solved; the gap of a circle is no parabola there."""
    with pytest.warns(em.ConvergenceWarning, match="1 of 2 points"):
        curve = em.lubricated(
            RUBBER, BODY, velocity=0.1, load=1e3, viscosity=np.array([1.0, viscosity])
        )
    assert curve.converged.tolist() == [True, False]
    assert np.isnan(curve.mu[1])


def test_power_in_the_film():
    """Friction is what the liquid dissipates: its shear and its flow by pressure."""
    curve = em.lubricated(RUBBER, BODY, velocity=0.1, load=1e3, viscosity=0.05)
    x, h, p = curve.profile.x, curve.profile.film, curve.profile.pressure
    middle, slope = 0.5 * (h[1:] + h[:-1]), np.diff(p) / np.diff(x)
    wet = (p[1:] > 0) | (x[1:] < 0)
    flow = float(curve.flow)
    cover = np.where(wet, 1.0, flow / (0.05 * middle))
    shear = 0.05 * 0.1**2 / middle * cover
    lost = np.sum((shear + middle**3 * slope**2 / (12 * 0.05)) * np.diff(x))
    assert float(curve.mu) * 0.1 * 1e3 == pytest.approx(lost, rel=2e-3)


@pytest.mark.parametrize("rubber", ["passes", "rolls"])
@pytest.mark.parametrize("thickness", [None, 1e-3])
def test_thin_film_has_the_rubber_friction_of_the_dry_contact(rubber, thickness):
    body = RUBBER if thickness is None else em.layer(RUBBER, thickness)
    velocity = np.array([1e-2, 1.0])
    dry = em.friction(body, BODY, velocity=velocity, load=1e3).mu
    thin, thinner = (
        em.lubricated(
            body, BODY, velocity=velocity, load=1e3, viscosity=drag / velocity,
            rubber=rubber,
        )
        for drag in (1e-3, 1e-4)
    )  # fmt: skip
    off = np.abs(thin.rubber / dry - 1), np.abs(thinner.rubber / dry - 1)
    assert (off[0] < 0.03).all()
    assert (off[1] < 0.012).all()
    assert (off[1] < off[0]).all()


def test_an_elastic_film_knows_the_mean_of_both_velocities_alone():
    """Rubber that rolls along takes in twice as much as one that rests or passes."""
    elastic, velocity = em.Prony(1e6, [], []), np.array([0.1, 1.0])
    given = {"load": 1e3, "viscosity": 0.1}
    films = [
        em.lubricated(elastic, BODY, velocity=v, rubber=rubber, **given).film_thickness
        for rubber, v in (
            ("rests", 2 * velocity),
            ("passes", 2 * velocity),
            ("rolls", velocity),
        )
    ]
    np.testing.assert_allclose(films[1:], [films[0]] * 2, rtol=1e-6)


@pytest.mark.parametrize("velocity", [1e-3, 0.1])
def test_without_a_film_friction_is_that_of_the_dry_surface(velocity):
    """Hysteresis and adhesive shear of `em.friction` under Hertz' pressure."""
    load, modulus, stress = 1e3, 4e6, 1e5  # E*(0) = 4G
    half = np.sqrt(4 * load * BODY.radius / (np.pi * modulus))
    angle = (np.arange(200) + 0.5) * np.pi / 200
    pressure, share = 2 * load / (np.pi * half) * np.sin(angle), np.sin(angle) ** 2
    dry = em.friction(
        RUBBER, ROUGH, velocity=velocity, pressure=pressure,
        adhesion=em.AdhesiveShear(stress, 1.0, 0.0),
    )  # fmt: skip
    thin = em.lubricated(
        RUBBER, BODY, velocity=velocity, load=load, viscosity=1e-13 / velocity,
        surface=ROUGH, boundary_shear=stress,
    )  # fmt: skip
    assert thin.asperity_share == pytest.approx(1, abs=1e-3)
    assert thin.viscous < 1e-7
    for found, known in (
        (thin.asperity, dry.hysteresis),
        (thin.boundary, dry.adhesion),
    ):
        mean = np.average(known, weights=share)
        assert found == pytest.approx(mean, rel=5e-3)


def test_liquid_that_closed_channels_trap_is_in_doubt():
    """Friction of the dry surface, and of one whose channels keep their liquid, are both
    within `trapped_error`.
    """
    load, modulus, stress, drag = 1e3, 4e6, 1e5, np.array([1e-10, 1e-3])
    surface = em.SelfAffine(0.8, rms_height=5e-7, q_low=1e4, q_high=1e6)
    half = np.sqrt(4 * load * BODY.radius / (np.pi * modulus))
    angle = (np.arange(12) + 0.5) * np.pi / 12
    dry = em.friction(
        RUBBER, surface, velocity=0.1,
        pressure=2 * load / (np.pi * half) * np.sin(angle),
        adhesion=em.AdhesiveShear(stress, 1.0, 0.0),
    )  # fmt: skip
    wet = em.lubricated(
        RUBBER, BODY, velocity=0.1, load=load, viscosity=drag / 0.1, surface=surface,
        boundary_shear=stress,
    )  # fmt: skip
    off = np.average(dry.mu, weights=np.sin(angle) ** 2) - wet.mu[0]
    assert 0.8 * wet.mu[0] < off < 1.01 * wet.trapped_error[0]  # the liquid carries
    kept = 0.1110  # at 1e-12 N/m with a thousandth of the floor
    assert abs(wet.mu[0] - kept) < wet.trapped_error[0]
    assert wet.trapped_error[1] == wet.trapped_share[1] == 0
    assert "at 1 of 2 points" in wet.summary()
    assert len(wet.plot().collections) == 1


def test_thick_film_does_not_feel_the_surface():
    given = {"velocity": [1.0, 10.0], "load": 1e3, "viscosity": 0.1}
    smooth = em.lubricated(RUBBER, BODY, **given)
    rough = em.lubricated(RUBBER, BODY, surface=ROUGH, boundary_shear=1e5, **given)
    assert rough.mu == pytest.approx(smooth.mu, rel=1e-2)
    assert rough.film_thickness[1] == pytest.approx(smooth.film_thickness[1], rel=1e-6)


def test_flow_factors_against_maps():
    """12 eta s over the cube of the mean gap, of another solution of contact and flow
    on maps at a real contact of .11, .21 and .32, within the bound of `em.leak`.
    """
    surface = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e5, q_high=32e5)
    over_rms, maps = np.array([0.82, 0.495, 0.31]), np.array([0.30, 0.087, 0.010])
    gap = over_rms * surface.rms_height
    ours, theirs = (pressed(RUBBER, surface, each) for each in ("maps", "patir-cheng"))
    factor, slope = ours.flow_factor(gap)
    assert (np.abs(np.log(factor / maps)) < np.log([1.3, 1.6, 2.3])).all()
    assert theirs.flow_factor(gap)[0] == pytest.approx([0.43, 0.32, 0.24], abs=0.01)
    step = 1e-6 * gap
    ahead, behind = (ours.flow_factor(gap + move)[0] for move in (step, -step))
    assert (ahead - behind) / (2 * step) == pytest.approx(slope, rel=1e-6)
    thick, closed = (ours.flow_factor(np.array([x]))[0] for x in (1e-3, 1e-12))
    assert thick == pytest.approx(1.0)
    assert 0 < closed < 1.1e-5  # not zero, without channels


def test_narrow_channels_carry_a_thicker_film():
    """Against Patir and Cheng's factors, which hardly fall in heavy contact; boundary to
    full film over eight decades of velocity.
    """
    scene = {"velocity": np.geomspace(1e-7, 10.0, 9), "load": 1e3, "viscosity": 0.05}
    maps, theirs = (
        em.lubricated(RUBBER, BODY, surface=ROUGH, flow_factor=each, **scene)
        for each in ("maps", "patir-cheng")
    )
    assert maps.converged.all()
    assert (maps.asperity_share[:4] < 0.9 * theirs.asperity_share[:4]).all()
    assert (maps.film_thickness[:3] > 1.5 * theirs.film_thickness[:3]).all()
    assert maps.mu[-2:] == pytest.approx(theirs.mu[-2:], rel=1e-3)
    assert "em.leak" in maps.model
    assert "Patir" in theirs.model


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"shape": em.Sphere(1e-2)}, ("shape",)),
        (
            {"surface": ROUGH, "flow_factor": "reynolds"},
            ("flow_factor", "patir-cheng"),
        ),
        ({"rubber": "slides"}, ("rubber",)),
        ({"boundary_shear": 1e5}, ("", "surface")),
        ({"viscosity": -1.0}, ("viscosity",)),
        ({"rubber": "rolls", "time": 1.0}, ("time",)),
        ({"material": em.Maxwell(1e6, 1.0)}, ("material",)),
    ],
)
def test_what_is_refused(change, named):
    given = {"velocity": 0.1, "load": 1e3, "viscosity": 0.1} | change
    material, shape = given.pop("material", RUBBER), given.pop("shape", BODY)
    with refused(*named):
        em.lubricated(material, shape, **given)


X = np.linspace(0.0, 2e-3, 2001)
STEEP = np.where(
    X < 5e-4,
    3e6 * np.sin(np.pi * X / 1e-3) ** 2,
    3e6 * np.cos(np.pi * (X - 5e-4) / 3e-3) ** 2,
)


def test_inverse_theory_and_the_steeper_flank():
    """h_0 = sqrt(8 eta U/(9 p'_max)) with p'_max = pi p/(2 w) of each flank."""
    scene = {"velocity_out": 0.1, "velocity_in": 0.1, "stroke": 0.1, "viscosity": 0.03}
    tight = em.reciprocating(profile=(X, STEEP), **scene)
    loose = em.reciprocating(profile=(X, STEEP[::-1]), **scene)
    slopes = np.array([np.pi * 3e6 / 1e-3, np.pi * 3e6 / 3e-3])
    films = 0.5 * np.sqrt(8 * 0.03 * 0.1 / (9 * slopes))
    assert [float(tight.film_out), float(tight.film_in)] == pytest.approx(
        films, rel=1e-4
    )
    assert float(tight.net_leak) == 0
    assert float(loose.net_leak) == pytest.approx((films[1] - films[0]) * 0.1, rel=1e-3)


@pytest.mark.parametrize(("separator", "point"), [(", ", "."), (";", ","), ("\t", ".")])
def test_profile_from_a_file(tmp_path, separator, point):
    path = tmp_path / "profile.csv"
    rows = [("position [mm]", "pressure [MPa]")]
    rows += [
        (str(x * 1e3).replace(".", point), str(p / 1e6).replace(".", point))
        for x, p in zip(X, STEEP, strict=True)
    ]
    path.write_text("\n".join(map(separator.join, rows)) + "\n", encoding="utf-8")
    scene = {"velocity_out": 0.1, "velocity_in": 0.1, "stroke": 0.1, "viscosity": 0.03}
    given, read = (
        em.reciprocating(profile=each, **scene) for each in ((X, STEEP), path)
    )
    assert float(read.film_out) == pytest.approx(float(given.film_out), rel=1e-9)


@pytest.mark.parametrize(
    ("x", "pressure", "said"),
    [
        (1e3 * X, STEEP, "the contact is 2 m wide. If 2 mm are meant"),
        (X, 1e-6 * STEEP, "of 3 Pa at most. If 3 MPa are meant"),
    ],
)
def test_a_profile_in_mm_or_mpa_is_doubted(x, pressure, said):
    with pytest.warns(em.ModelWarning, match=said):
        em.reciprocating(profile=(x, pressure), **STROKES)


@pytest.mark.parametrize(("noise", "said"), [(1e-4, False), (1e-3, True), (1e-2, True)])
def test_noise_of_a_profile_is_part_of_the_error_and_said(noise, said):
    """As smoothing it shows, which is what the warning advises."""
    scene = STROKES | {"viscosity": 0.3}
    x, clean = X[::5], STEEP[::5]
    noisy = clean + noise * 3e6 * np.random.default_rng(1).standard_normal(x.size)
    right = float(em.reciprocating(profile=(x, clean), **scene).film_out)
    with (
        pytest.warns(em.ModelWarning, match="smoother profile")
        if said
        else contextlib.nullcontext()
    ):
        found = em.reciprocating(profile=(x, noisy), **scene)
    film = float(found.film_out)
    assert abs(film - right) <= 1.5 * float(found.error)
    smooth = savgol_filter(noisy, 31, 3)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", em.ModelWarning)
        again = em.reciprocating(profile=(x, smooth), **scene)
    assert abs(float(again.film_out) - right) < abs(film - right)


RING = em.o_ring(RUBBER, 5e-3, 0.15)
STROKES = {"velocity_out": 0.1, "velocity_in": 0.1, "stroke": 0.1, "viscosity": 0.03}


def test_o_ring_leaks_by_the_faster_stroke_out():
    found = em.reciprocating(RUBBER, o_ring=RING, **STROKES | {"velocity_out": 0.3})
    # an inlet of Hertz: films as (eta U)^0.6
    assert float(found.film_out / found.film_in) == pytest.approx(3**0.6, rel=0.02)
    assert float(found.net_leak) > 0
    errors = float(found.error + found.film_in_error)
    assert float(found.net_leak_error) == pytest.approx(0.1 * errors)


def test_the_pressure_of_the_fluid_thins_the_film_that_an_o_ring_lets_in():
    """At a given width films of Hertz' inlet are as pressure to the power of -0.8."""
    ring = em.o_ring(RUBBER, 5e-3, 0.15, fluid_pressure=2e6)
    thick = STROKES | {"viscosity": 0.1}
    without, under = (
        em.reciprocating(RUBBER, o_ring=each, **thick) for each in (RING, ring)
    )
    assert float(under.film_out) == float(without.film_out)
    ratio = float(ring.sealing_pressure / ring.pressure)
    thinner = float(without.film_in / under.film_in)
    assert thinner == pytest.approx(ratio**0.8, rel=0.02)
    assert float(without.net_leak) == 0 < float(under.net_leak)
    pushed = float(without.friction_out - under.friction_out)
    assert pushed == pytest.approx(2e6 * float(under.film_out), rel=1e-9)
    assert "2 MPa of its fluid" in under.summary()


def test_a_film_thinner_than_any_rod_is_smooth_is_not_known():
    """Of 6 nm, whose shear is a thousandth of that of a real contact."""
    speed = np.array([1e-4, 1e-3, 0.3])
    motion = STROKES | {"velocity_out": speed, "velocity_in": 0.3, "viscosity": 0.1}
    with warned(em.ModelWarning, 1.5e-08, "stroke out"):
        found = em.reciprocating(RUBBER, o_ring=RING, **motion)
    for name in ("film_out", "friction_out", "net_leak", "work", "error"):
        known = np.isfinite(getattr(found, name)).tolist()
        assert known == [False, False, True], name
    assert np.isfinite(found.film_in).all()
    assert np.isfinite(found.friction_in).all()
    assert found.converged.tolist() == [False, False, True]
    doubt = next(d for d in found.doubts if "three rms heights" in d.says)
    assert doubt.kind == "no prediction"
    assert doubt.points.tolist() == [True, True, False]
    assert "three rms heights" in found.summary()
    oils = {"velocity_in": speed, "viscosity": 0.1 * 0.3 / speed}  # the same eta U
    thick = em.reciprocating(RUBBER, o_ring=RING, **motion | oils)
    np.testing.assert_allclose(thick.film_out, found.film_out[2], rtol=1e-9)


@pytest.mark.filterwarnings("ignore:pressure is taken")
def test_friction_never_drives_the_rod():
    """Where the fall of pressure in the film exceeds its shear, by the rule."""
    ring = em.o_ring(RUBBER, 5e-3, 0.15, fluid_pressure=1e8)
    with warned(em.ModelWarning, "would drive"):
        found = em.reciprocating(RUBBER, o_ring=ring, **STROKES | {"viscosity": 10.0})
    assert np.isnan(found.friction_out)
    assert np.isfinite(found.film_out)
    assert found.friction_in > 0
    assert np.isnan(found.work)
    steep = em.o_ring(RUBBER, 5e-3, 0.15, fluid_pressure=1e6)
    known = em.reciprocating(RUBBER, o_ring=steep, **STROKES | {"viscosity": 10.0})
    assert known.friction_out > 0


@pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")
def test_both_strokes_are_warned_of_at_once():
    rubber = em.load_material("epdm-70")
    ring = em.o_ring(rubber, 5e-3, 0.15, time=1e8, temperature=293.15)
    with pytest.warns(em.ExtrapolationWarning) as caught:
        em.reciprocating(rubber, o_ring=ring, **STROKES)
    assert len(caught) == 1


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"material": em.Prony(1.1e6, [3e6], [1e-4])}, ("material", "rubber")),
        ({"material": []}, ("material", "list")),
        ({"material": None}, ("material", "o_ring")),
        (
            {"o_ring": None, "profile": (X, STEEP), "material": [3.0]},
            ("material[0]", "rubber"),
        ),
        ({"o_ring": em.o_ring(RUBBER, 5e-3, [0.1, 0.2])}, ("o_ring", "single")),
    ],
)
def test_what_strokes_refuse(change, named):
    given = {"material": RUBBER, "o_ring": RING} | STROKES | change
    with refused(*named):
        em.reciprocating(**given)


def test_strokes_of_an_o_ring_at_its_time_and_temperature():
    """A ring that relaxed is that of a softer rubber."""
    rubber = em.StandardSolid(1e6, 3e6, 2.0, shift=em.WLF(8.86, 101.6, 293.15))
    ring = em.o_ring(rubber, 5e-3, 0.15, time=1e6, temperature=303.15)
    found = em.reciprocating(rubber, o_ring=ring, **STROKES)
    soft = em.Prony(1e6, [], [])
    known = em.reciprocating(soft, o_ring=em.o_ring(soft, 5e-3, 0.15), **STROKES)
    assert float(found.film_out) == pytest.approx(float(known.film_out), rel=1e-9)


TRACED = {
    "velocity": lambda v: em.lubricated(RUBBER, BODY, velocity=v, load=1e3, viscosity=1.0),
    "surface": lambda h: em.lubricated(
        RUBBER, BODY, velocity=1.0, load=1e3, viscosity=1.0,
        surface=em.SelfAffine(0.8, rms_height=h, q_low=1e5, q_high=1e7),
    ),
    "shear": lambda tau: em.lubricated(
        RUBBER, BODY, velocity=1.0, load=1e3, viscosity=1.0, surface=ROUGH,
        boundary_shear=tau,
    ),
    "stroke": lambda v: em.reciprocating(profile=(X, STEEP), **STROKES | {"stroke": v}),
    "ring": lambda v: em.reciprocating(
        RUBBER, o_ring=em.o_ring(RUBBER, v, 0.15), **STROKES
    ),
    "rubber": lambda e: em.reciprocating(
        em.Prony(e, [], []), o_ring=RING, **STROKES
    ),
}  # fmt: skip


# options of a film; of rough ones the surface is worn, ground, or as it is
SOFT = em.Softening([1e-3, 1e-2, 0.1, 1.0], [1.0, 0.9, 0.7, 0.5], [1.0, 1.1, 0.9, 0.5])
OPTIONS = ("softening", "layer", "skewness", "lay", "shear", "time", "warm", "patir")
PAIRS = [OPTIONS, *combinations(OPTIONS, 2)]


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "options",
    [pytest.param(p, marks=[pytest.mark.slow] * (len(p) == 2)) for p in PAIRS],
    ids="-".join,
)
def test_options_of_many_points_are_those_of_each(options):
    more = {"shift": em.WLF(8.86, 101.6, 293.15)} if "warm" in options else {}
    if "softening" in options:
        more["softening"] = SOFT
    rubber = em.Prony(1e6, [3e6, 2e6], [1e-4, 1e-2], **more)
    if "layer" in options:
        rubber = em.layer(rubber, 5e-3)
    surface = measured(
        ROUGH,
        np.log(3.0) if "lay" in options else None,
        -0.5 if "skewness" in options else 0.0,
    )
    given = {"surface": surface, "load": 1e3, "viscosity": 0.04}
    given |= {"boundary_shear": 1e5} if "shear" in options else {}
    given |= {"time": 10.0} if "time" in options else {}
    given |= {"temperature": 300.0} if "warm" in options else {}
    given |= {"flow_factor": "patir-cheng"} if "patir" in options else {}
    velocity = [1e-3, 0.1]
    together = em.lubricated(rubber, BODY, velocity=velocity, **given)
    left_out = [d for d in together.doubts if "softening" in d.says]
    assert bool(left_out) == ("softening" in options)
    for i, one in enumerate(velocity):
        alone = em.lubricated(rubber, BODY, velocity=one, **given)
        for field in ("mu", "film_thickness", "asperity_share", "flow"):
            many = getattr(together, field)[i]
            assert many == pytest.approx(float(getattr(alone, field)), rel=1e-3), field


@pytest.mark.parametrize("name", TRACED)
def test_what_is_traced_is_refused(name):
    named = {"shear": "boundary_shear", "ring": "o_ring", "rubber": "material"}
    with jax.enable_x64(True), refused(named.get(name, name), "jax.jit"):
        jax.jit(TRACED[name])(0.1)


def test_the_error_of_two_grids_is_their_difference():
    """What extrapolating changes is not known without a third."""
    coarser, coarse, fine = np.ones(11), np.full(11, 0.94), np.full(11, 0.92)
    three = lubricated._judge(coarser, coarse, fine)
    two = lubricated._judge(np.full(11, np.nan), coarse, fine)
    assert (two.error >= 0.02).all()
    assert (three.error < two.error).all()
    assert not two.settled()


def test_rubbers_of_a_list_move_under_the_rings_of_the_same_list():
    names = ("soft", "hard")
    rubbers = [
        em.Prony(e, [2e5], [1e-2], name=name)
        for e, name in zip((8e5, 3e6), names, strict=True)
    ]
    ring, motion = em.o_ring(rubbers, 5e-3, 0.15), STROKES | {"viscosity": 10.0}
    both = em.reciprocating(rubbers[::-1], o_ring=ring, **motion)
    assert both.materials == names[::-1]
    for rubber in rubbers:
        alone = em.reciprocating(rubber, o_ring=em.o_ring(rubber, 5e-3, 0.15), **motion)
        found = both.select(rubber.name)
        np.testing.assert_array_equal(found.film_out, alone.film_out)
        np.testing.assert_array_equal(found.friction_in, alone.friction_in)
    assert set(both.to_pandas()["material"]) == set(names)
    with refused("material[1]", "Prony"):
        em.reciprocating([rubbers[0], 3.0], o_ring=ring, **motion)
