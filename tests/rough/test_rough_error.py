"""mu of a rough line and its stated error where the force jumps at the edges of
contacts, against a closed form.
"""

import re

import numpy as np
import pytest
from scipy.optimize import brentq

import elastomdr as em
from elastomdr.material.relaxation import Relaxation
from elastomdr.rough.periodic import Job, _limit, solve_line
from elastomdr.surface.height_map import top_slope
from elastomdr.surface.spectrum import synthesise

from ..refused import warned


def dashpot_on_a_cosine(
    stiff: float, eta: float, k: float, height: float, velocity: float, depth: float
):
    """mu and mean force per length of a spring and a dashpot, from q = E w + eta dw/dt
    in contact, w = d - A + A cos.

    Contact ends where q = 0, recovery goes as exp(-E t/eta), and the next wave meets it
    before its crest.
    """
    period = 2 * np.pi / k / velocity

    def w(t):
        return depth - height + height * np.cos(k * velocity * t)

    def q(t):
        return stiff * w(t) - eta * height * k * velocity * np.sin(k * velocity * t)

    def above(t):  # the free element over the line, after a crest at -period
        return w(end) * np.exp(-stiff / eta * (t + period - end)) - w(t)

    times = np.linspace(0, period / 2, 20_001)
    first = int(np.argmax(q(times) < 0))
    end = brentq(q, times[first - 1], times[first], xtol=1e-18)
    times = np.linspace(end - period, 0, 20_001)
    first = 5 + int(np.argmax(above(times)[5:] < 0))
    start = brentq(above, times[first - 1], times[first], xtol=1e-18)
    x, weight = np.polynomial.legendre.leggauss(100)
    t, weight = (start + end) / 2 + (end - start) / 2 * x, (end - start) / 2 * weight
    slope = -height * k * np.sin(k * velocity * t)  # dw/dx
    return weight @ (q(t) * slope) / (weight @ q(t)), weight @ q(t) / period


def test_force_that_jumps_at_the_edge():
    """With a dashpot alone the force jumps where contact begins: of second order, and
    the error covers it.
    """
    x = np.arange(4096) * 2 * np.pi / 1e3 / 4096
    rubber, line = (
        em.Foundation(1e6, [], [], viscosity=1e3),
        em.RoughLine(x, 1e-5 * np.cos(1e3 * x)),
    )
    for depth in (1e-5, 3e-5):
        velocity = [3.0, 10.0, 30.0, 100.0]
        exact = [dashpot_on_a_cosine(1e6, 1e3, 1e3, 1e-5, v, depth) for v in velocity]
        for samples in (4096, 65536):
            got = em.friction(
                rubber,
                line,
                velocity=velocity,
                depth=depth,
                model=em.Line(samples=samples),
            )
            mu, load = np.transpose(exact)
            np.testing.assert_allclose(
                got.normal_force, load, rtol=3e-7 * (4096 / samples) ** 2 + 1e-9
            )
            np.testing.assert_allclose(
                got.mu, mu, rtol=2e-5 * (4096 / samples) ** 2 + 1e-8
            )
            assert (np.abs(got.mu - mu) <= got.error).all()
            assert (got.error <= 1e-4 * mu).all()


def test_contacts_of_few_samples_have_an_error_that_covers():
    """One to twenty samples touch: against eight times as many samples, 97 % of the
    points at least.
    """
    draw, covered = np.random.default_rng(11), []
    for _ in range(12):
        surface = em.SelfAffine(
            draw.uniform(0.5, 1),
            rms_slope=0.3,
            q_low=1e3,
            q_high=1e3 * draw.choice([4.0, 8.0, 16.0]),
        )
        line = synthesise(surface, int(draw.integers(1e6)), 2, 4096)
        height, spacing = np.asarray(line.height), float(line.spacing)
        law = Relaxation(
            np.asarray(1e6),
            1e6 * 10 ** draw.uniform(-1, 2, 2),
            10 ** draw.uniform(-5, -2, 2),
            np.zeros(()),
        )
        velocity, load = (
            10 ** draw.uniform(-2, 3, 16),
            1e6 * height.std() * 10 ** draw.uniform(-5, -2, 16),
        )
        some, many = (
            solve_line(Job(height[::n], spacing * n, velocity, load, "load"), law)
            for n in (8, 1)
        )
        good = some.converged & many.converged
        covered += list((np.abs(some.mu - many.mu) <= some.error + many.error)[good])
    assert len(covered) > 150
    assert np.mean(covered) > 0.97


def test_contact_that_ends_within_a_step():
    """A dashpot far quicker than a step: the work of the step in which contact ends was
    of first order, off by 8e-4.
    """
    x = np.arange(256) * 2 * np.pi / 1e3 / 256
    rubber, line = (
        em.Foundation(1e6, [], [], viscosity=1e3),
        em.RoughLine(x, 1e-5 * np.cos(1e3 * x)),
    )
    exact, _ = dashpot_on_a_cosine(1e6, 1e3, 1e3, 1e-5, 1e-5, 0.77e-5)
    for samples in (1024, 4096):
        got = em.friction(
            rubber, line, velocity=1e-5, depth=0.77e-5, model=em.Line(samples=samples)
        )
        np.testing.assert_allclose(got.mu, exact, rtol=1e-5)


@pytest.mark.parametrize("samples", [256, 1024])
def test_error_where_rubber_gives_way_within_a_step(samples):
    """eta/E over the step from 4e-4 to 5: in between the bend of a step is neither
    closed form nor resolved.
    """
    x = np.arange(samples) * 2 * np.pi / 1e3 / samples
    rubber, line = (
        em.Foundation(1e6, [], [], viscosity=1e3),
        em.RoughLine(x, 1e-5 * np.cos(1e3 * x)),
    )
    velocity = np.geomspace(1e-5, 3e-2, 8)
    found = em.friction(
        rubber, line, velocity=velocity, depth=0.77e-5, model=em.Line(samples=samples)
    )
    exact = np.array(
        [dashpot_on_a_cosine(1e6, 1e3, 1e3, 1e-5, v, 0.77e-5)[0] for v in velocity]
    )
    assert (np.abs(found.mu - exact) <= found.error).all()
    assert (found.error < 5e-3 * found.mu).all()


BROAD = np.geomspace(1e-10, 1e4, 20)  # relaxation times [s]
TREAD = em.Foundation(2e6, 3e6 * (BROAD / 1e-10) ** -0.1, BROAD)


def test_a_broad_spectrum_on_a_long_line_converges():
    """20 branches over 14 decades: forces in contact passed through the modes of free
    recovery, and mu was NaN.

    mu is that of `benchmarks/robustness/rough_march.py`, from event to event, on four
    times the samples.
    """
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=2e3, q_high=2e5)
    line = synthesise(surface, 2, 4, 16384)
    velocity = np.geomspace(1e-6, 100, 8)[:7]
    load = np.full(7, 0.6)
    job = Job(line.height, float(line.spacing), velocity, load, "load")
    found = solve_line(job, TREAD.law())
    assert found.converged.all()
    assert (found.error < 0.01 * found.mu).all()
    truth = [
        0.0139054,
        0.0161710,
        0.0186927,
        0.0212329,
        0.0236236,
        0.0261357,
        0.0283870,
    ]
    assert (np.abs(found.mu - truth) <= found.error).all()


def test_a_coarse_level_that_was_not_solved_costs_no_point():
    """mu of every 64th, 16th, 4th and each sample, of second order: without one of the
    coarse ones the error covers.
    """
    mus = [np.array([1.0 + 1e-4 * 16.0**level]) for level in (3, 2, 1, 0)]
    bare = np.array([False])
    _, every = _limit(list(mus), bare)
    for missing in range(3):
        some = [
            mu if level != missing else np.array([np.nan])
            for level, mu in enumerate(mus)
        ]
        mu, error = _limit(some, bare)
        assert mu == mus[-1]
        assert every * (1 - 1e-9) <= error < 0.02
    _, error = _limit([*(np.array([np.nan]) for _ in range(3)), mus[-1]], bare)
    assert np.isnan(error)


def test_a_surface_with_worn_summits_has_a_wider_bound():
    """Skewness of measured heights is reported by scale; friction follows the slopes of
    their tops, which widen its bound and stand in the result.
    """
    n = 256
    k = np.fft.fftfreq(n, 1 / n)
    q = np.hypot(k[:, None], k[None])
    amplitude = np.where((q >= 4) & (q <= 32), np.maximum(q, 1.0) ** -1.8, 0.0)
    white = np.random.default_rng(3).standard_normal((n, n))
    gaussian = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    gaussian *= 20e-6 / gaussian.std()
    worn = -np.exp(-gaussian / 40e-6) * 40e-6
    plain = em.read_surface(gaussian, pixel_size=10e-6)
    with warned(em.ModelWarning, "model_error", "likely"):
        skewed = em.read_surface(worn, pixel_size=10e-6)
    assert abs(plain.skewness) < plain.skewness_error
    assert -2.0 < skewed.skewness < -1.0
    assert any("skewness -1." in row for row in skewed.report)
    rubber, at = em.StandardSolid(1e6, 3e7, 1e-3), {"velocity": 0.1, "pressure": 1e5}
    same = em.Spectrum(skewed.q, skewed.c, convention="2d")
    found, reference, even = (
        em.friction(rubber, road, **at) for road in (skewed, same, plain)
    )
    assert found.mu < 0.7 * reference.mu
    at_contact, at_all = (
        top_slope(skewed.tops, found.area_ratio),
        np.sqrt(np.mean(skewed.tops**2)),
    )
    added = 0.2 * abs(at_contact) + 0.05 * at_all + 0.25 * skewed.skewness_error
    assert found.model_error > np.expm1(added) * found.mu
    assert even.model_error / even.mu < 0.65 * found.model_error / found.mu
    # one number of one point, both ends of several
    assert re.search(r"has 0\.\d+ times the rms slope", found.summary())
    several = em.friction(rubber, skewed, velocity=0.1, pressure=[1e5, 1e6])
    assert re.search(r"has 0\.\d+ to [\d.]+ times the rms slope", several.summary())
    assert "rms slope of all" not in reference.summary()


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
@pytest.mark.parametrize("worn", [False, True])
def test_a_finer_scan_does_not_widen_the_bound_of_skewness(worn):
    """Of a small part of the surface: it has few long waves, and says nothing of them
    that the larger scan does not know better. The skewness of all scales is that of one
    map which has them all.
    """
    n = 1024
    k = np.fft.fftfreq(n, 1 / n)
    q = np.hypot(k[:, None], k[None])
    amplitude = np.where((q >= 4) & (q <= 200), np.maximum(q, 1.0) ** -1.8, 0.0)
    white = np.random.default_rng(3).standard_normal((n, n))
    heights = np.fft.ifft2(np.fft.fft2(white) * amplitude).real
    heights *= 20e-6 / heights.std()
    if worn:
        heights = -np.exp(-heights / 40e-6) * 40e-6
    coarse = heights.reshape(n // 4, 4, n // 4, 4).mean(axis=(1, 3)), 20e-6
    fine = heights[100:356, 500:756], 5e-6

    def read(*scans):
        maps, steps = zip(*scans, strict=True)
        return em.read_surface(list(maps), pixel_size=list(steps))

    def bound(surface):
        return np.hypot(surface.skewness, 1.5 * surface.skewness_error)

    alone, small, joined = read(coarse), read(fine), read(coarse, fine)
    whole = read((heights, 5e-6))
    assert worn or bound(small) > bound(alone)
    assert bound(joined) <= bound(alone)
    assert joined.skewness_error <= alone.skewness_error < small.skewness_error
    assert joined.skewness == pytest.approx(whole.skewness, abs=0.1)
    assert read(fine, coarse).skewness == joined.skewness
    assert any("heights of all scans" in row for row in joined.report)
    # a second map of the same scales brings none
    assert bound(read(coarse, coarse)) == bound(alone)


def test_other_heights_and_cutoffs_keep_what_was_measured():
    """Lay, skewness and the map itself; beyond the map it is left out, and said."""
    rng = np.random.default_rng(2)
    white = np.fft.fft2(rng.standard_normal((64, 64)))
    x, y = np.meshgrid(*[np.fft.fftfreq(64, 1 / 64)] * 2, indexing="ij")
    stretched = np.hypot(3 * x, y)
    heights = np.fft.ifft2(white / (9 + stretched**2)).real
    heights *= 2e-5 / heights.std()
    with pytest.warns(UserWarning, match="not isotropic"):
        whole = em.read_surface(heights, pixel_size=1e-5)
    higher, short = whole.raised(2.0), whole.ended(0.5 * whole.q_high)
    assert higher.rms_height == pytest.approx(2 * whole.rms_height, rel=1e-12)
    np.testing.assert_allclose(higher.map.height, 2 * whole.map.height)
    assert (higher.lay, higher.skewness) == (whole.lay, whole.skewness)

    # what is read off them is what they are now
    assert higher.measured_height == pytest.approx(2 * whole.measured_height)
    longer_waves = whole.measured_height**2 - whole.rms_height**2
    assert short.measured_height == pytest.approx(
        (longer_waves + short.rms_height**2) ** 0.5
    )
    both = higher.ended(0.5 * whole.q_high)
    drawn = whole.draws(2, level=0.1)[0]
    for surface in (higher, short, both, drawn):
        now, *as_read = surface.report
        assert surface.words() in now
        assert f"skewness {surface.skewness:.2f} +-" in now
        assert tuple(as_read) == whole.report

    assert short.map.cut == short.q_high == short.lay.q[-1]
    np.testing.assert_array_equal(short.lay.q, short.q)
    assert short.skewness_error == pytest.approx(whole.skewness_error, rel=0.2)
    # too few waves: nothing is known of their skewness
    assert whole.ended(1.5 * whole.q_low).skewness_error == 1.0
    np.testing.assert_allclose(
        short.lay.weight(short.q, 1.0, 0.0), whole.lay.weight(short.q, 1.0, 0.0)
    )

    with pytest.warns(em.ModelWarning, match="takes random maps"):
        longer = whole.ended(2 * whole.q_high)
    assert longer.map is None
    assert longer.lay.peklenik[-1] == whole.lay.peklenik[-1]
    for drawn, has_map in (
        (whole.draws(2, level=0.1), True),
        (whole.draws(2, cutoff=0.3), False),
    ):
        assert all((one.map is not None) == has_map for one in drawn)
        assert all(one.lay is not None for one in drawn)
