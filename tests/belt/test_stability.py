"""`em.stability` against closed forms of the slope, a drive that grows and decays, and
its refusals.
"""

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.belt.stability import unstable_ranges

from ..refused import mentions, refused

MOUNT = em.Mount(2.0, 8e4, 5.0)
# 1/m, s, N: one wave in full contact, F = HIGH x/(1 + x^2), x = K v TAU
K, TAU, HIGH = 2e3 * np.pi, 2e-3, 31.4
SPEED = np.geomspace(0.01, 1.0, 81)


def force(v):
    return HIGH * K * v * TAU / (1 + (K * v * TAU) ** 2)


def test_slope_of_a_wave_in_full_contact():
    """F' in closed form; central differences in ln v leave h^2/6 of the third
    derivative, h = 0.058, at most 1e-3 F.
    """
    x = K * SPEED * TAU
    exact = HIGH * K * TAU * (1 - x**2) / (1 + x**2) ** 2
    found = em.stability(MOUNT, velocity=SPEED, force=force(SPEED), wavelength=1e-3)
    assert (np.abs(found.slope - exact) < 2e-3 * force(SPEED) / SPEED).all()
    np.testing.assert_allclose(
        found.ratio, (5.0 + found.slope) / (2 * np.sqrt(8e4 * 2.0)), rtol=1e-14
    )
    np.testing.assert_allclose(found.slowest, 1e-3 * 200.0, rtol=1e-14)
    np.testing.assert_array_equal(found.follows, SPEED > 0.2)
    fine = np.geomspace(0.01, 1.0, 161)
    other = em.stability(
        MOUNT, velocity=fine, force=force(fine), wavelength=1e-3
    ).slope[::2]
    off, less = (np.abs(y - exact)[1:-1].max() for y in (found.slope, other))
    assert 1.8 < np.log2(off / less) < 2.2


def test_uneven_velocities_and_more_curves():
    """Exact for F = a + b ln v + c ln^2 v, ends included, whatever the spacing."""
    at = np.array([-3.0, -2.5, -1.0, -0.9, 0.7])
    drags = np.array([1.0 + 0.3 * at, 2.0 - 0.2 * at + 0.1 * at**2])
    found = em.stability(MOUNT, velocity=np.exp(at), force=drags, wavelength=1e-3)
    np.testing.assert_allclose(
        found.slope * np.exp(at), [0.3 + 0 * at, -0.2 + 0.2 * at], atol=1e-13
    )
    assert found.ratio.shape == found.velocity.shape == found.follows.shape == (2, 5)


def test_error_covers_the_differences():
    """Against the slope in closed form; unknown for four velocities, and beside a force
    that is.
    """
    x = K * SPEED * TAU
    exact = HIGH * K * TAU * (1 - x**2) / (1 + x**2) ** 2
    found = em.stability(MOUNT, velocity=SPEED, force=force(SPEED), wavelength=1e-3)
    off = np.abs(found.slope - exact) / (2 * np.sqrt(8e4 * 2.0))
    assert (off < found.error).all()
    # elsewhere the difference crosses zero
    close = off * SPEED > 0.05 * (off * SPEED).max()
    # 2 of the term left out, its largest nearby
    assert (found.error[close] < 9 * off[close]).all()
    few = em.stability(
        MOUNT, velocity=SPEED[:4], force=force(SPEED[:4]), wavelength=1e-3
    )
    assert np.isnan(few.error).all()
    hole = np.where(np.arange(81) == 9, np.nan, force(SPEED))
    holed = em.stability(MOUNT, velocity=SPEED, force=hole, wavelength=1e-3)
    assert np.flatnonzero(~holed.converged).tolist() == [8, 9, 10]
    np.testing.assert_array_equal(np.isfinite(holed.error), holed.converged)
    assert "1 of 81 forces" in holed.summary()


def peaked(v):  # F [N] and dF/d ln v
    x = np.log(v / 0.02) / 0.8
    return 5 + 3 * np.exp(-(x**2)), -7.5 * x * np.exp(-(x**2))


@pytest.mark.parametrize("count", [7, 13, 25])
@pytest.mark.parametrize("law", [peaked, lambda v: (10 * v**-0.2, -2 * v**-0.2)])
def test_error_covers_coarse_tables(count, law):
    """A peak a third of a decade wide on points a fifth to half a decade apart, and a
    power law.
    """
    for v in (
        np.geomspace(1e-3, 1.0, count),
        np.geomspace(1e-3, 1.0, count) * (1 + 0.1 * (-1.0) ** np.arange(count)),
    ):
        drag, exact = law(v)
        found = em.stability(MOUNT, velocity=v, force=drag, wavelength=1e-3)
        off = np.abs(found.slope - exact / v) / (2 * np.sqrt(8e4 * 2.0))
        assert (off < found.error).all()
        assert (found.error * v).max() < 7 * (off * v).max()


def test_a_hole_is_local():
    v = np.geomspace(1e-3, 1.0, 9)
    drag = np.where(np.arange(9) == 4, np.nan, 10 * v**-0.2)
    found = em.stability(MOUNT, velocity=v, force=drag, wavelength=1e-3)
    assert np.flatnonzero(~found.converged).tolist() == [3, 4, 5]
    np.testing.assert_array_equal(np.isfinite(found.error), found.converged)
    assert "1 of 9 forces" in found.summary()
    # no four neighbours are left
    holes = np.where(np.arange(9) % 4 == 3, np.nan, 10 * v**-0.2)
    found = em.stability(MOUNT, velocity=v, force=holes, wavelength=1e-3)
    assert "3 others" in found.summary()


def test_swings_that_grow_below_the_limit_too():
    """The range begins at lambda sqrt(k/m) = 0.2 m/s, not at the first velocity above
    it.
    """
    v = np.geomspace(0.01, 1.0, 8)  # 0.139, 0.268 m/s beside the limit
    found = em.stability(
        em.Mount(2.0, 8e4, 0.1), velocity=v, force=10 * v**-0.2, wavelength=1e-3
    )
    assert mentions(found.summary(), 0.2, 1, "m/s")


def test_levels_of_a_constant_force_are_named():
    levels = np.ones(5) * np.array([[1.0], [2.0]])
    found = em.stability(
        MOUNT, velocity=np.geomspace(0.1, 1, 5), force=levels, wavelength=1e-3
    )
    assert "at friction force 2 N" in found.summary()
    assert set(found.to_xarray().sizes) == {"friction_force", "velocity"}


def test_table_summary_and_figure(tmp_path):
    """Swings grow where F' < -c and friction follows: from one crossing of zero to the
    other, or to the end.
    """
    light = em.Mount(2.0, 200.0, 4.0)
    found = em.stability(
        light,
        velocity=SPEED,
        force=np.array([force(SPEED), 0.5 * force(SPEED)]),
        wavelength=1e-3,
    )
    ((low, high),) = unstable_ranges(
        SPEED, found.ratio[0], found.follows[0], float(found.slowest)
    )
    # c (1 + x^2)^2 + HIGH K TAU (1 - x^2) = 0
    x = np.roots([4.0, 0, 8.0 - HIGH * K * TAU, 0, 4.0 + HIGH * K * TAU])
    crossings = np.sort(x.real[(np.abs(x.imag) < 1e-12) & (x.real > 0)]) / (K * TAU)
    np.testing.assert_allclose([low, high], crossings, rtol=1e-2)
    assert f"swings grow at {low:.4g} to {high:.4g} m/s" in found.summary()
    calm = em.stability(
        em.Mount(2.0, 200.0, 900.0), velocity=SPEED, force=force(SPEED), wavelength=1e-3
    )
    assert "swings die out" in calm.summary()
    slow = em.stability(
        em.Mount(2.0, 8e6, 5.0), velocity=SPEED, force=force(SPEED), wavelength=1e-3
    )
    assert "none of these velocities" in slow.summary()
    found.to_csv(tmp_path / "drive.csv")
    text = (tmp_path / "drive.csv").read_text()
    for said in (
        "damping ratio [-]",
        "# mount: 2 kg, 200 N/m, 4 N s/m",
        "# longest wave: 0.001 m",
    ):
        assert said in text
    assert found.to_dict()["slope"].shape == (2, 81)
    assert found.to_xarray().sizes["velocity"] == 81
    ax = found.plot()
    # long lines of a legend are broken to its width
    words = [text.get_text().replace("\n", " ") for text in ax.get_legend().get_texts()]
    assert words == [
        "no. 0",
        "no. 1",
        "swings grow",
        r"$\lambda\sqrt{k/m}$: below it the ratio is not valid",
    ]
    assert ax.get_xscale() == "log"


def test_gradient():
    """d zeta/d k = -zeta/2k."""
    with jax.enable_x64(True):
        derivative = jax.grad(
            lambda k: em.stability(
                em.Mount(2.0, k, 5.0),
                velocity=SPEED,
                force=force(SPEED),
                wavelength=1e-3,
            ).ratio[9]
        )
        slope = jax.jit(derivative)(8e4)
    expected = em.stability(
        MOUNT, velocity=SPEED, force=force(SPEED), wavelength=1e-3
    ).ratio[9]
    np.testing.assert_allclose(slope, -expected / 1.6e5, rtol=1e-12)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"mount": 3.0}, ("mount", "em.Mount")),
        ({"mount": em.Mount(1.0)}, ("mount.stiffness", "positive")),
        ({"velocity": [1.0, 2.0], "force": [1.0, 2.0]}, ("velocity", "three values")),
        ({"velocity": SPEED[::-1]}, ("velocity", "ascending")),
        ({"force": 1.0}, ("force", 81)),
        ({"force": np.full(81, np.inf)}, ("force", "finite")),
        ({"wavelength": 0.0}, ("wavelength", "positive")),
    ],
)
def test_refusals(change, words):
    given = {
        "mount": MOUNT,
        "velocity": SPEED,
        "force": force(SPEED),
        "wavelength": 1e-3,
    } | change
    with refused(*words):
        em.stability(given.pop("mount"), **given)
