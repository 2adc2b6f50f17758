"""Sliding in a direction to the lay of a surface, and over a measured map itself."""

import dataclasses
import json
import warnings
from pathlib import Path

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.kinds import read_scene
from elastomdr.rough import against_lay, half_space
from elastomdr.surface.height_map import _PLACES
from elastomdr.surface.lay import Lay
from elastomdr.surface.topography import MeasuredSurface

from ..refused import refused

SOLID = em.Foundation(1e6, np.full(6, 2e6), np.geomspace(1e-6, 1e-1, 6))
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)


def ground(peklenik: float, road: em.SelfAffine = ROAD) -> MeasuredSurface:
    """A surface as `em.read_surface` gives it, with one Peklenik number at all
    scales.
    """
    lay = Lay(road.q, np.full(road.q.size, np.log(peklenik)), 0 * road.q, 0.0)
    return MeasuredSurface(
        q=road.q,
        c=road.c,
        relative_error=0 * road.q,
        measured_height=road.rms_height,
        skewness=0.0,
        report=(),
        lay=lay,
    )


def test_a_lay_of_peklenik_number_one_is_none():
    """The same numbers bit by bit; and of one that is hardly more, by tables of each
    angle in place of those averaged over it, nearly the same.
    """
    at = {"velocity": [1e-2, 1.0], "pressure": 1e5}
    for model in (em.Multiscale(), em.Persson()):
        plain = em.friction(SOLID, ROAD, **at, model=model)
        turned, nearly, mean = (
            em.friction(SOLID, ground(g), **at, model=model, direction=direction)
            for g, direction in ((1.0, 0.4), (1 + 1e-9, 0.4), (1.0, None))
        )
        for name in ("mu", "area_ratio", "error", "model_error"):
            for one in (turned, mean):
                np.testing.assert_array_equal(getattr(one, name), getattr(plain, name))
        np.testing.assert_allclose(nearly.mu, plain.mu, rtol=2e-6)
        np.testing.assert_allclose(nearly.area_ratio, plain.area_ratio, rtol=2e-6)
    np.testing.assert_array_equal(turned.direction, [0.4, 0.4])


@pytest.mark.filterwarnings("ignore:pressure is taken")
@pytest.mark.parametrize("model", [em.Multiscale(), em.HalfSpace(seeds=2, cells=64)])
def test_full_contact_is_the_closed_form_in_all_directions(model):
    """Where Im E* goes with the frequency, mu goes with int W cos^2 phi dphi, the mean
    square slope along the motion: 2 (cos^2 t + g^2 sin^2 t)/(1 + g^2) times the mean.
    """
    material, at = em.Foundation.kelvin(1e6, 2.0), {"velocity": 0.3, "pressure": 1e9}
    direction = np.array([0.0, 0.5, np.pi / 2])
    mean = em.friction(material, ROAD, **at).mu
    curve = em.friction(material, ground(3.0), **at, model=model, direction=direction)
    expected = (np.cos(direction) ** 2 + 9 * np.sin(direction) ** 2) / 5
    np.testing.assert_allclose(curve.mu / mean, expected, rtol=1e-4)


def test_without_a_direction_the_bound_holds_all():
    at = {"velocity": 1e-2, "pressure": 1e5}
    mean = em.friction(SOLID, ground(4.0), **at)
    assert mean.mu == em.friction(SOLID, ROAD, **at).mu
    ends = em.friction(SOLID, ground(4.0), **at, direction=[0.0, np.pi / 2])
    assert ends.mu[0] < mean.mu < ends.mu[1]
    assert (np.abs(ends.mu - mean.mu) < mean.model_error).all()
    assert "mean over directions" in mean.summary()


@pytest.mark.parametrize("peklenik", [2.0, 4.0])
def test_the_bound_holds_the_sampling_error_of_a_lay(peklenik):
    """Lays that are read from six small maps of one surface: friction by the true lay
    is within what the error of each adds to the bound.
    """
    true, lays = ground(peklenik), []
    for seed in range(6):
        heights, side = em.reference.rough_map(true, seed, periods=3, points=96)
        with warnings.catch_warnings():  # that the surface is not isotropic
            warnings.simplefilter("ignore")
            lays.append(em.read_surface(heights, pixel_size=side / 96).lay)
    at = {"velocity": 1e-2, "pressure": 1e5, "rtol": 1e-4}
    at["direction"] = np.array([0.0, 0.8, np.pi / 2])
    exact = em.friction(SOLID, true, **at)
    for lay in lays:
        sampled = em.friction(SOLID, dataclasses.replace(true, lay=lay), **at)
        known = dataclasses.replace(lay, error=0 * lay.error)
        without = em.friction(SOLID, dataclasses.replace(true, lay=known), **at)
        assert (sampled.mu == without.mu).all()
        added = sampled.model_error - without.model_error
        assert (added > 0).all()
        assert (np.abs(sampled.mu - exact.mu) <= added).all()
        assert "sampling error" in sampled.summary()
        assert "sampling error" not in without.summary()


def test_a_wide_bound_names_lay_and_skewness_and_the_advice_helps():
    lay = dataclasses.replace(ground(4.0).lay, error=np.array([0.6, 0.3]))
    rough = dataclasses.replace(ground(4.0), lay=lay)
    worn = dataclasses.replace(ground(1.0), lay=None, tops=-_PLACES)
    at = {"velocity": 1e-2, "pressure": 2e4}
    along, across = {"direction": 0.0}, {"direction": np.pi / 2}
    heavy = {"pressure": 2e6}
    steep = ground(40.0)
    cases = (
        # surface and call with a wide bound, what is said, and what has a smaller one
        (rough, {}, "a `direction` has less", rough, across),
        (rough, along, "Peklenik numbers have a sampling error", ground(4.0), along),
        (steep, along, "directions of their own", steep, along | heavy),
        (worn, {}, "tops of the heights have other slopes", worn, heavy),
    )
    for surface, call, reason, other, advice in cases:
        wide = em.friction(SOLID, surface, **at | call)
        assert reason in why_wide(wide)
        better = em.friction(SOLID, other, **at | advice)
        assert better.model_error / better.mu < wide.model_error / wide.mu
    assert "tops" not in why_wide(em.friction(SOLID, rough, **at))


def why_wide(curve):
    return "; ".join(doubt.says for doubt in curve.doubts if doubt.kind == "bound")


def test_random_maps_of_a_measured_surface_have_a_bound():
    """Of its heights, its lay and their sampling errors; random maps of a spectrum and
    the measured map itself have none.
    """
    at = {"velocity": 1e-2, "pressure": 4e5, "rtol": 1e-2}
    maps = em.HalfSpace(seeds=2, cells=64)
    lay = dataclasses.replace(ground(2.0).lay, error=np.array([0.3, 0.2]))
    skewed = dataclasses.replace(
        ground(1.0), lay=None, tops=-0.2 * _PLACES, skewness_error=0.2
    )
    curve = em.friction(SOLID, skewed, **at, model=maps)
    at_contact = 0.2 * np.sqrt(-np.log(curve.area_ratio))
    at_all = 0.2 * np.sqrt(np.mean(_PLACES**2))
    expected = np.expm1(2 * at_contact + 0.05 * at_all + 0.25 * 0.2)
    assert curve.model_error == pytest.approx(expected * curve.mu, rel=1e-12)
    assert em.friction(SOLID, ROAD, **at, model=maps).model_error is None
    for given in ({}, {"direction": 0.3}):
        directed, exact = (
            em.friction(SOLID, surface, **at, **given, model=maps)
            for surface in (
                dataclasses.replace(ground(2.0), lay=lay),
                ground(2.0),
            )
        )
        assert directed.mu == exact.mu
        assert directed.model_error > exact.model_error > 0
        assert "model error" in directed.summary()


def test_draws_keep_the_limits_of_the_model():
    """As a result without draws has them, in the numbers of one draw."""
    lay = dataclasses.replace(ground(4.0).lay, error=np.full(ROAD.q.size, 0.2))
    surface = dataclasses.replace(
        ground(4.0), lay=lay, tops=-_PLACES, skewness_error=0.1
    )
    given = {"velocity": 0.1, "pressure": 1e4}
    one = em.friction(SOLID, surface, **given)
    alone = dict(one.inputs)
    drawn = em.friction(SOLID, surface.draws(3, level=0.1), **given)
    assert why_wide(one)[:12] in why_wide(drawn)
    assert why_wide(drawn.typical()) == why_wide(drawn)
    assert dict(drawn.inputs)["direction"].startswith("in 3 of 3 draws, first: ")
    for row in ("heights", "direction"):
        assert row in drawn.summary()
        assert alone[row][:12] in dict(drawn.inputs)[row]


@pytest.mark.parametrize("direction", [None, 0.4])
@pytest.mark.parametrize("model", [em.Multiscale(), em.Persson()])
def test_the_bound_of_a_lay_is_the_same_under_jit(model, direction):
    surface = ground(2.0)
    lay = dataclasses.replace(surface.lay, error=np.full(2, 0.1))
    surface = dataclasses.replace(surface, lay=lay)

    def bound(velocity):
        return em.friction(
            SOLID, surface, velocity=velocity, pressure=1e5, model=model,
            direction=direction,
        ).model_error  # fmt: skip

    at = np.array([1e-2, 1.0])
    with jax.enable_x64(True):
        traced = jax.jit(bound)(at)
    np.testing.assert_allclose(traced, bound(at), rtol=1e-9)


def test_draws_vary_lay_and_skewness():
    lay = dataclasses.replace(ground(4.0).lay, error=np.array([0.6, 0.1]))
    surface = dataclasses.replace(
        ground(4.0), lay=lay, skewness=-0.2, skewness_error=0.3
    )
    draws = surface.draws(400, level=0.1, seed=3)
    assert "Peklenik number within" in draws.words
    off = [draw.lay.log_peklenik - lay.log_peklenik for draw in draws]
    skewness = [draw.skewness for draw in draws]
    # standard deviations of 400 draws are within 4 / sqrt(800) of themselves
    np.testing.assert_allclose(np.std(off, axis=0), lay.error, rtol=0.15)
    assert np.std(skewness) == pytest.approx(0.3, rel=0.15)
    assert np.mean(skewness) == pytest.approx(-0.2, abs=4 * 0.3 / 20)
    # C is what it was drawn as without a lay, and what is known is not varied
    plain = dataclasses.replace(ground(4.0), lay=None).draws(3, level=0.1, seed=3)
    for drawn, other in zip(draws, plain, strict=False):
        np.testing.assert_array_equal(drawn.c, other.c)
        assert (other.lay, other.skewness) == (None, 0.0)


def test_a_plan_and_a_scene_have_the_direction(tmp_path):
    at = {"velocity": 1e-2, "pressure": 1e5, "direction": [0.0, 1.0]}
    plan = em.plan(SOLID, ground(4.0), **at)
    assert plan.points == 2
    assert "angle to the lay" in str(plan)

    heights, side = em.reference.rough_map(ground(4.0), periods=2, points=64)
    np.savetxt(tmp_path / "ground.txt", heights)
    (tmp_path / "ground.toml").write_text(
        f"""
        material = "sbr-gum-like"
        [surface]
        shape = "file"
        file = "ground.txt"
        unit = "m"
        pixel_size = "{side / 64:.9g} m"
        [contact]
        pressure = "0.1 MPa"
        velocity = "0.1 m/s"
        direction = ["0 deg", "90 deg"]
        """
    )
    scene = read_scene("friction", tmp_path / "ground.toml")
    with pytest.warns(UserWarning, match="not isotropic"):
        curve = em.friction(**scene.arguments(tmp_path))
    assert [axis.name for axis in curve.axes()] == ["direction"]
    np.testing.assert_allclose(curve.direction, [0.0, np.pi / 2])
    assert (curve.mu[0] < curve.mu[1]).all()


def test_a_derivative_by_the_direction():
    """Of the average that both models take; a whole call has the same rule as by other
    arguments.
    """
    w, q = np.full((1, 1, 1), 30.0), np.full((1, 1), 3e3)

    def drag(direction):
        directed = against_lay.Directed(ground(3.0).lay, direction)
        return against_lay.averages(lambda w: 1.0 + 1j * w, w, q, directed, 0.0, False)[
            0
        ]

    at = np.array([0.7])
    with jax.enable_x64(True):
        slope = jax.jit(lambda t: jax.jvp(drag, (t,), (np.ones(1),))[1])(at)
    np.testing.assert_allclose(
        slope, (drag(at + 1e-4) - drag(at - 1e-4)) / 2e-4, rtol=1e-5
    )


def test_directions_that_are_refused():
    at = {"velocity": 0.1, "direction": 0.2}
    for angle in (90.0, np.nan):
        with refused("direction", "angle"):
            em.friction(SOLID, ROAD, velocity=0.1, pressure=3e5, direction=angle)
    with refused("", "direction", "em.Multiscale"):
        em.friction(SOLID, ROAD, pressure=1e5, model=em.Line(), **at)
    with refused("", "direction", "em.Multiscale"):
        em.plan(SOLID, ROAD, pressure=1e5, model=em.Line(), **at)
    with refused("", "direction"):
        em.friction(SOLID, em.Sphere(1e-2), load=1.0, **at)


@pytest.mark.filterwarnings("ignore:heights of skewness")
def test_a_worn_map_itself():
    """Summits worn flat at all scales: the spectrum does not know of them, the map and
    the slopes of its tops do.

    The map is periodic, so that its solution by itself is the truth.
    """
    cells, side = 64, 2 * np.pi * 2 / 1e3
    heights = em.reference.rough_map(ROAD, 3, periods=2, points=cells)[0]
    heights = np.where(heights > 0, 0.1 * heights, heights)
    worn = em.read_surface(heights, pixel_size=side / cells)
    at = {"velocity": 0.1, "pressure": 1e5}
    truth = np.mean(
        [
            half_space.solve(
                SOLID.complex_modulus, heights, (side, side), **at, angle=angle
            ).stress
            / at["pressure"]
            for angle in (0.0, np.pi / 2)
        ]
    )
    curve = em.friction(SOLID, worn, **at, model=em.HalfSpace(), rtol=1e-3)
    assert curve.mu == pytest.approx(truth, rel=0.04)
    assert abs(curve.mu - truth) < curve.error
    default = em.friction(SOLID, worn, **at)
    assert abs(default.mu - truth) < default.model_error
    gaussian = em.Spectrum(worn.q, worn.c, convention="2d")
    assert em.friction(SOLID, gaussian, **at).mu > 1.3 * truth
    assert "64 by 64 cells" in curve.summary()


@pytest.mark.filterwarnings("ignore:the surface is not isotropic")
def test_a_piece_of_a_ground_surface():
    """Pieces of four times as large a map, two of the longest waves a side: `error`
    holds what few summits and the edges change, along the lay above all. Where hardly a
    summit carries the load there is no answer, and the summary says what has one.
    """
    periods, cells = 8, 256
    whole, side = em.reference.rough_map(ground(8.0), 1, periods=periods, points=cells)
    pressures = np.array([2e4, 1e5])
    truth = [
        half_space.solve(
            SOLID.complex_modulus, whole, (side, side), velocity=1e-2, pressure=p,
            double=False,
        ).stress / p
        for p in pressures
    ]  # fmt: skip
    for piece in (whole[:64, :64], whole[64:128, 64:128]):
        surface = em.read_surface(piece, pixel_size=side / cells)
        at = {"velocity": 1e-2, "model": em.HalfSpace(), "rtol": 1e-2, "direction": 0.0}
        curve = em.friction(SOLID, surface, **at, pressure=pressures)
        assert curve.converged.all()
        assert (np.abs(curve.mu - truth) < curve.error).all()
        assert "more mean square" in curve.summary()
    with pytest.warns(em.ConvergenceWarning, match="a larger map, more pressure"):
        light = em.friction(SOLID, surface, **at, pressure=[5e2, 1e5])
    np.testing.assert_array_equal(light.converged, [False, True])
    assert "em.Multiscale() needs no map" in light.summary()


def test_a_map_that_moves_along_its_diagonal():
    """A map turned by 90 degrees that moves along y is the map that moves along x."""
    heights, side = em.reference.rough_map(ROAD, 1, periods=2, points=32 * 2)
    at = {"velocity": 0.1, "pressure": 2e5, "double": False}
    turned = np.roll(heights[::-1], 1, axis=0).T
    results = [
        half_space.solve(SOLID.complex_modulus, h, (side, side), **at, angle=angle)
        for h, angle in ((heights, np.pi / 4), (turned, -np.pi / 4))
    ]
    assert results[0].stress == pytest.approx(results[1].stress, rel=1e-3)


def test_the_page_gives_what_is_recorded_of_ground_surfaces():
    """The means and the ends of docs/rough.md, from benchmarks/anisotropic.py."""
    root = Path(__file__).parents[2]
    page = " ".join((root / "docs" / "rough.md").read_text(encoding="utf-8").split())
    record = (root / "benchmarks" / "results" / "anisotropic.json").read_text()
    points = json.loads(record)["points"]
    columns = [(1, 0), (3, 0), (3, 90), (9, 0), (9, 90)]  # Peklenik number, degrees

    def at(g, degrees):
        return [p for p in points if (p["g"], p["direction"]) == (g, degrees)]

    light = [p for p in points if p["g"] > 1 and p["level"] == 0.01]
    assert all(0.01 < p["contact"] < 0.03 for p in light)
    ends = [f(p[k] for p in light) for k in ("multiscale", "area") for f in (min, max)]
    said = "1 to 3 %, {:.2f} to {:.2f} times (real contact {:.2f} to {:.2f} times)"
    assert said.format(*ends) in page
    times = np.array([p["multiscale"] for p in points if p["g"] > 1])
    lightest = [p["level"] == 0.01 for p in points if p["g"] > 1]
    assert lightest[abs(np.log(times)).argmax()]
    means = [np.exp(np.log([p["multiscale"] for p in at(*c)]).mean()) for c in columns]
    words = (
        "gives, on average, {:.2f} times the friction of the maps along the lay and "
        "{:.2f} times across it at $g=3$, {:.2f} and {:.2f} times at $g=9$"
    )
    assert words.format(*means[1:]) in page
    within = np.log1p([p["bound"] for p in points if p["g"] > 1])
    held = int((abs(np.log(times)) <= within).sum())
    assert f"holds {held} of {times.size} points" in page
