"""The three-dimensional half-space: its solver against its conditions, and em.HalfSpace
on surfaces.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.rough import half_space
from elastomdr.rough import random_maps as maps

from ..refused import refused, warned

SOLID = em.Foundation(1e6, np.full(6, 2e6), np.geomspace(1e-6, 1e-1, 6))
ROAD = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
SIDE = 2 * np.pi / 1e3 * 2


@pytest.fixture(scope="module")
def heights():
    return em.reference.rough_map(ROAD, 3, periods=2, points=64)[0]


@pytest.mark.parametrize("share", [0.02, 0.3, 5.0])
@pytest.mark.parametrize("velocity", [1e-2, 0.1, 1.0])
def test_signorini(heights, share, velocity):
    """Pressures push and carry the load, gaps are open and zero in contact, and the
    stress is -<p du/dx>: with displacements by a complex transform, wave by wave.
    """
    pressure = share * 1e6 * 0.3
    found = half_space.solve(
        SOLID.complex_modulus,
        heights,
        (SIDE, SIDE),
        velocity=velocity,
        pressure=pressure,
    )
    assert found.settled
    assert np.mean(found.pressure) == pytest.approx(pressure, rel=1e-12)
    k = 2 * np.pi * np.fft.fftfreq(64, 1 / 64) / SIDE
    kx, q = k[:, None], np.hypot(k[:, None], k)
    q[0, 0] = 1e300  # the mean displacement is not defined
    modulus = np.conj(SOLID.complex_modulus(np.abs(kx) * velocity))
    modulus = np.where(kx > 0, modulus, np.conj(modulus))
    modulus[32] = modulus[32].real  # as much with the motion as against it
    waves = 2 / (q * modulus) * np.fft.fft2(found.pressure)
    u = np.fft.ifft2(waves).real
    touching = found.pressure > 0
    gap = u - heights - np.mean((u - heights)[touching])
    assert found.pressure.min() >= 0
    assert np.abs(gap[touching]).max() < 1e-6 * heights.std()
    assert gap[~touching].min(initial=0.0) > -1e-6 * heights.std()
    assert found.separation == pytest.approx(gap.mean(), abs=1e-6 * heights.std())
    slope = np.where(np.arange(64)[:, None] == 32, 0, 1j * kx)
    stress = -np.mean(found.pressure * np.fft.ifft2(slope * waves).real)
    assert stress == pytest.approx(found.stress, rel=1e-6)
    if share >= 0.3:
        # Heights are counted into the rubber; the border of the contact, which turns
        # within a cell, is a small part of it.
        slopes = np.fft.ifft2(slope * np.fft.fft2(heights)).real
        given = -np.mean(found.pressure * slopes)
        assert given == pytest.approx(found.stress, rel=0.08)
    single = half_space.solve(
        SOLID.complex_modulus,
        heights,
        (SIDE, SIDE),
        velocity=velocity,
        pressure=pressure,
        double=False,
    )
    assert single.stress == pytest.approx(found.stress, rel=1e-3)


@pytest.mark.parametrize("by", ["load", "depth"])
def test_elimination_and_iteration_agree(monkeypatch, by):
    """A ball of 10 mm, whose radius of contact is 2.7 mm where nothing lags."""
    given = {"load": 10.0} if by == "load" else {"depth": 5e-4}

    def slide():
        return em.reference.half_space_sliding(
            SOLID, em.Paraboloid(0.01), velocity=0.1, points=32, **given
        )

    eliminated = slide()
    monkeypatch.setattr(half_space, "_FEW", 0)
    iterated = slide()
    for name in ("mu", "normal_force", "depth", "contact_area"):
        assert getattr(eliminated, name) == pytest.approx(
            getattr(iterated, name), rel=1e-8
        )


def test_products_compiled_by_jax_change_nothing(heights, monkeypatch):
    """What an accelerator computes, here on the processor."""
    given = {"velocity": 0.1, "pressure": 1e5}
    plain = half_space.solve(SOLID.complex_modulus, heights, (SIDE, SIDE), **given)
    monkeypatch.setattr(
        half_space, "on_accelerator", lambda cells, count: half_space.compiled(cells)
    )
    compiled = half_space.solve(SOLID.complex_modulus, heights, (SIDE, SIDE), **given)
    assert compiled.products == plain.products
    assert compiled.stress == pytest.approx(plain.stress, rel=1e-9)
    assert compiled.area == pytest.approx(plain.area, rel=1e-9)


def test_a_neighbour_saves_work_and_changes_nothing(heights):
    given = {"velocity": 0.1, "pressure": 1e5}
    cold = half_space.solve(SOLID.complex_modulus, heights, (SIDE, SIDE), **given)
    near = half_space.solve(
        SOLID.complex_modulus, heights, (SIDE, SIDE), velocity=0.12, pressure=1e5
    )
    warm = half_space.solve(
        SOLID.complex_modulus, heights, (SIDE, SIDE), **given, start=near.pressure
    )
    assert warm.stress == pytest.approx(cold.stress, rel=1e-7)
    assert warm.products <= cold.products


def test_area_is_that_of_finer_grids():
    fine = em.reference.rough_map(ROAD, 1, periods=4, points=512)[0]
    waves = np.fft.rfft2(fine)
    area = []
    for n in (128, 512):
        kept = np.zeros((n, n // 2 + 1), complex)
        half = n // 2
        kept[:half, :half], kept[-half + 1 :, :half] = (
            waves[:half, :half],
            waves[-half + 1 :, :half],
        )
        heights = np.fft.irfft2(kept, s=(n, n)) * (n / 512) ** 2
        found = half_space.solve(
            SOLID.complex_modulus,
            heights,
            (2 * SIDE,) * 2,
            velocity=0.1,
            pressure=1e5,
            double=False,
        )
        area.append(found.area)
    assert area[0] == pytest.approx(area[1], rel=0.03)


def test_surfaces():
    velocity = np.array([1e-2, 0.1, 1.0])
    done = []
    curve = em.friction(
        SOLID,
        ROAD,
        velocity=velocity,
        pressure=2e5,
        model=em.HalfSpace(cells=128, seeds=2),
        rtol=1e-3,
        progress=lambda *so_far: done.append(so_far),
    )
    other = em.friction(SOLID, ROAD, velocity=velocity, pressure=2e5)
    assert curve.converged.all()
    assert done[-1] == (6, 6)
    assert curve.model_error is None
    assert (np.abs(curve.mu - other.mu) <= curve.error + other.model_error).all()
    np.testing.assert_allclose(curve.area_ratio, other.area_ratio, rtol=0.15)
    assert "summits" in curve.summary()
    assert "128 by 128" in str(
        em.plan(
            SOLID, ROAD, velocity=velocity, pressure=2e5, model=em.HalfSpace(cells=128)
        )
    )


def test_one_map_says_nothing_of_scatter():
    curve = em.friction(
        SOLID, ROAD, velocity=0.1, pressure=2e5, model=em.HalfSpace(cells=64), rtol=1e-3
    )
    assert np.isfinite(curve.mu)
    assert np.isnan(curve.error)


@pytest.mark.filterwarnings("ignore:pressure is taken")
@pytest.mark.parametrize("seeds", [1, 2])
def test_full_contact_is_the_closed_form(seeds):
    """mu = (pi eta v/2p) int q^4 C dq of Kelvin elements, E'' = eta omega, whatever
    waves a map is made of: `error` has no share of a sample, of which it was 7.5 %.

    C = A q^-3.6 from q_0 to q_1: int q^3 C dq = A (q_1^0.4 - q_0^0.4)/0.4 = <|grad
    h|^2>/2 pi, int q^4 C dq likewise.
    """
    viscosity, velocity, pressure = 2.0, 0.3, 1e9
    material = em.Foundation.kelvin(1e6, viscosity)
    curve = em.friction(
        material,
        ROAD,
        velocity=velocity,
        pressure=pressure,
        model=em.HalfSpace(cells=64, seeds=seeds),
    )
    low, high = 1e3, 8e3
    fourth = (
        0.3**2
        / (2 * np.pi)
        * (high**1.4 - low**1.4)
        / 1.4
        / ((high**0.4 - low**0.4) / 0.4)
    )
    exact = np.pi * viscosity * velocity * fourth / (2 * pressure)
    assert abs(curve.mu - exact) <= curve.error
    assert curve.error < 1e-5 * exact
    assert curve.area_ratio == 1.0


def test_next_to_full_contact_a_small_sample_is_within_its_error():
    """Maps of four longest waves against those of 64 times as many."""
    scene = {"velocity": 0.3, "pressure": np.array([1.5e6, 2.5e6])}
    small = em.friction(SOLID, ROAD, model=em.HalfSpace(periods=2, seeds=12), **scene)
    large = em.friction(SOLID, ROAD, model=em.HalfSpace(periods=8), **scene)
    np.testing.assert_allclose(small.area_ratio, [0.945, 0.998], atol=3e-3)
    assert (abs(small.mu - large.mu) <= small.error).all()
    assert (small.error < 0.03 * small.mu).all()


@pytest.mark.filterwarnings("ignore::elastomdr.ConvergenceWarning")
def test_a_cell_with_one_summit_is_no_answer():
    model = em.HalfSpace(cells=32, periods=1, seeds=2)
    curve = em.friction(
        SOLID, ROAD, velocity=10.0, pressure=2e4, model=model, rtol=1e-3
    )
    assert not curve.converged
    assert np.isnan(curve.mu)


def test_cells_that_do_not_resolve_are_refused():
    with refused("cells", 16):
        em.friction(
            SOLID, ROAD, velocity=0.1, pressure=1e5, model=em.HalfSpace(cells=16)
        )
    wide = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e2, q_high=1e6)
    with refused("cells", "em.Multiscale"):
        em.friction(SOLID, wide, velocity=0.1, pressure=1e5, model=em.HalfSpace())


def test_summits_grow_with_the_cell_and_the_load():
    at = {"velocity": np.array([0.1]), "pressure": np.array([1e5])}
    small = maps.summits(
        SOLID.complex_modulus, ROAD, *at.values(), maps.MapGrid(32, 1, SIDE / 2)
    )
    large = maps.summits(
        SOLID.complex_modulus, ROAD, *at.values(), maps.MapGrid(128, 4, 2 * SIDE)
    )
    assert large == pytest.approx(16 * small)
    heavy = maps.summits(
        SOLID.complex_modulus,
        ROAD,
        np.array([0.1]),
        np.array([1e9]),
        maps.MapGrid(128, 4, 2 * SIDE),
    )
    assert heavy == pytest.approx(16)


def graded(decades):
    """Rubber with two branches a decade, its modulus rising as the root of omega."""
    branch = np.arange(int(2 * decades))
    moduli = 1e6 * (10**0.5 - 1) * 10 ** (0.5 * branch)
    return em.Prony(1e6, moduli, 10.0 ** -(1 + 0.5 * branch))


def test_high_contrast_in_heavy_contact():
    """A contrast of 1000, where a third of the cells touch: BiCGSTAB diverges there."""
    rubber = graded(3)
    road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=3.2e4)
    heights = em.reference.rough_map(road, 0, periods=2, points=256)[0]
    found = half_space.solve(
        rubber.complex_modulus,
        heights,
        (SIDE, SIDE),
        velocity=3e-4,
        pressure=4e5,
        double=False,
    )
    assert found.settled
    assert 0.3 < np.mean(found.pressure > 0) < 0.4
    assert found.products < 1500


def test_a_solver_that_does_not_converge_is_named(monkeypatch):
    """With what the warning says to do the same iterations are enough."""
    monkeypatch.setattr(half_space, "_PIVOTS", 20)
    monkeypatch.setattr(half_space, "_KEPT", 5)
    monkeypatch.setattr(half_space, "_RESTARTS", 1)
    monkeypatch.setattr(half_space, "_FEW", 0)
    rubber, model = graded(3), em.HalfSpace(seeds=2, periods=2)
    given = {"velocity": 1e-3, "pressure": 4e5, "model": model, "rtol": 1e-3}
    road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1.6e4)
    with warned(em.ConvergenceWarning, "2 of 2"):
        curve = em.friction(rubber, road, **given)
    assert np.isnan(curve.mu)
    assert "a lower upper cutoff" in dict(curve.inputs)["maps"]
    for eased in (
        em.friction(rubber, road.ended(4e3), **given),
        em.friction(graded(1), road, **given),
    ):
        assert np.isfinite(eased.mu)
        assert "did not converge" not in dict(eased.inputs)["maps"]
