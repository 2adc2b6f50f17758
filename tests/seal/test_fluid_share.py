"""The fluid carries its share of the pressure: leaks against the integral over what is
left to contact, against a solution of the equation along the seal by another method,
and against numbers of another program.
"""

import itertools
from functools import cache

import jax
import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

import elastomdr as em
from elastomdr.cli.kinds import read_scene

from ..refused import refused
from .heights import measured

RUBBER = em.Prony(2.5e6, [], [])  # E* 10 MPa
TURNED = em.SelfAffine(
    0.8, rms_height=1e-6, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 2e-6
)
SEAL = {"viscosity": 2e-3, "width": 0.1}
LENGTH = 2e-3


def leak(pressure, drop, **given):
    given = {"length": LENGTH} | SEAL | given
    return em.leak(RUBBER, TURNED, pressure=pressure, pressure_drop=drop, **given)


def conductance(pressure):
    """s [m^3/(Pa s)] of contacts that bear these pressures."""
    return leak(pressure, 1e-7 * np.asarray(pressure)).conductance


@cache
def closing():
    """The pressure [Pa] at which channels close."""
    low, high = 1e5, 1e6
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if conductance(middle) > 0 else (low, middle)
    return low


@cache
def tabulated():
    """Logarithms of pressures below that of closing, and of their conductances."""
    sigma = closing() / (1 + np.exp(-np.linspace(-13.0, 13.0, 2601)))
    return np.log(sigma), np.log(conductance(sigma))


def interpolated(sigma):
    inside = np.exp(np.interp(np.log(np.maximum(sigma, 1.0)), *tabulated()))
    return np.where(sigma < closing(), inside, 1e-300)


def test_numbers_of_another_program():
    """Rate over that of contacts that bear all of the pressure."""
    known = {
        1e5: (1.13, 1.99, 4.76),
        2e5: (1.26, 3.7, 17),
        3e5: (1.46, 8.7, 84),
    }
    part = np.array([0.1, 0.5, 0.9])
    for pressure, expected in known.items():
        found = leak(pressure, part * pressure)
        more = found.conductance / conductance(pressure)
        np.testing.assert_allclose(more, expected, rtol=0.02)
    assert found.area_ratio == pytest.approx(0.25, abs=1e-3)


@pytest.mark.parametrize("part", [0.05, 0.5, 0.97])
@pytest.mark.parametrize("pressure", [1e5, 4e5, 1e6])
def test_the_integral_over_what_contact_bears(pressure, part):
    """With what is closed from the outlet on: it adds no resistance."""
    found = leak(pressure, part * pressure)
    low, high = np.log([(1 - part) * pressure, min(pressure, closing())])
    whole = 0.0
    if low < high:
        whole, _ = quad(
            lambda x: np.exp(x) * interpolated(np.exp(x)), low, high, limit=400
        )
    assert found.rate == pytest.approx(0.1 / LENGTH * whole, rel=1e-3, abs=1e-30)
    assert bool(found.percolates) == (whole > 0)


def test_a_seal_is_closed_until_the_fluid_opens_it():
    """Dry contact of 0.63 at 1 MPa leaks where the fluid carries half of it."""
    found = leak(1e6, np.array([1e5, 4e5, 5e5, 9e5]))
    assert found.percolates.tolist() == [False, False, True, True]
    assert (found.rate[:2] == 0).all()
    assert (found.area_ratio > 0.6).all()
    assert np.isnan(found.critical_gap).all()
    # behind the closed contact there is no fluid
    half = found.fluid_pressure(0.5 * LENGTH)
    assert (half[:2] == 0).all()
    assert (half[2:] > 4e5).all()


def test_fluid_along_an_even_seal():
    """Against w dp_f/dx by a solver of differential equations."""
    pressure, drop = 3e5, 2e5
    found = leak(pressure, drop)
    flux = float(found.rate) / 0.1

    def falls(x, p):
        return -flux / interpolated(pressure - p)

    x = np.linspace(0, LENGTH, 9)
    along = solve_ivp(falls, (0, LENGTH), [drop], t_eval=x[:-1], rtol=1e-8)
    expected = np.append(along.y[0], 0.0)
    np.testing.assert_allclose(found.fluid_pressure(x), expected, atol=2e-3 * drop)


def ellipse(x, mean):
    return 4 / np.pi * mean * np.sqrt(np.maximum(1 - (2 * x / LENGTH - 1) ** 2, 0.0))


@pytest.mark.parametrize(("mean", "part"), [(2e5, 0.1), (3e5, 0.5), (4.5e5, 0.7)])
def test_a_pressure_that_changes_along_the_seal(mean, part):
    """Hertz' ellipse, against the equation solved from the outlet on by an implicit
    method, up to where the fluid presses as hard as the rubber.
    """
    drop = part * mean
    x = np.linspace(0, LENGTH, 20001)
    found = em.leak(
        RUBBER, TURNED, profile=(x, ellipse(x, mean)), pressure_drop=drop, **SEAL
    )

    def at_inlet(log_flux):
        def rises(back, p):
            bears = ellipse(LENGTH - back, mean) - p
            return np.where(bears > 0, np.exp(log_flux) / interpolated(bears), 0.0)

        solved = solve_ivp(
            rises, (0, LENGTH), [0.0], method="LSODA", rtol=1e-7, atol=1e-3,
            max_step=LENGTH / 500,
        )  # fmt: skip
        return solved.y[0, -1] - drop

    guess = np.log(float(found.rate) / 0.1)
    log_flux = brentq(at_inlet, guess - 0.5, guess + 0.5, xtol=1e-4)
    assert guess == pytest.approx(log_flux, abs=2e-3)
    assert found.pressure == pytest.approx(mean, rel=1e-3)
    # where the ellipse is below the drop, on the side of the fluid
    lifted = LENGTH * 0.5 * (1 - np.sqrt(1 - (np.pi / 4 * part) ** 2))
    assert found.lifted == pytest.approx(lifted, abs=LENGTH / 64)
    assert found.fluid_pressure(0.2 * lifted) == pytest.approx(drop, rel=1e-4)
    assert found.fluid_pressure(LENGTH) == 0


def lobes(u):
    return 3.5e5 * np.exp(-(((u - 0.3) / 0.09) ** 2)) + 3.3e5 * np.exp(
        -(((u - 0.7) / 0.09) ** 2)
    )


def roof(u):
    return 4e5 * np.maximum(1 - abs(u - 0.35) / 0.2, 0.0)


@pytest.mark.parametrize(
    ("shape", "share"), [(lobes, 0.8), (lobes, 0.999), (roof, 0.95), (roof, 0.999)]
)
def test_peaks_that_the_fluid_all_but_lifts(shape, share):
    """Two lobes, and a sharp peak, against the equation itself within the error."""
    u = np.linspace(0.0, 1.0, 20001)
    pressure = 1e4 + shape(u)
    drop = share * pressure.max()
    found = em.leak(
        RUBBER, TURNED, profile=(LENGTH * u, pressure), pressure_drop=drop, **SEAL
    )
    # from the outlet on by the midpoint rule, in steps that ever finer lead to the peak
    beside = np.geomspace(1e-7, 1.0, 1500)
    peak = u[pressure.argmax()]
    steps = np.unique(np.clip([*(peak - beside), *(peak + beside), *u[::4]], 0, 1))
    ends, middles = steps[:0:-1], 0.5 * (steps[1:] + steps[:-1])[::-1]
    pressed = np.interp(np.stack([ends, middles]), u, pressure).T
    lengths = -LENGTH * np.diff(steps[::-1])

    def inlet(log_flux):
        """p_f there over the drop, less one."""
        flux, p = np.exp(log_flux), 0.0
        for (at_end, at_middle), length in zip(pressed, lengths, strict=True):
            half = p
            if at_end > p:
                half += 0.5 * length * flux / float(interpolated(at_end - p))
            if at_middle > half:
                p += length * flux / float(interpolated(at_middle - half))
            p = min(p, max(at_middle, half))
        return p / drop - 1

    guess = np.log(float(found.rate) / 0.1)
    log_flux = brentq(inlet, guess - 1, guess + 1, xtol=1e-4)
    assert found.converged
    assert abs(np.expm1(guess - log_flux)) < found.error + 2e-3


def test_hertz_against_his_mean_pressure():
    """Little fluid passes the resistances one after the other, 1/int dx/s: less than
    under the mean pressure over the whole width, and nothing where the middle closes.
    """
    for mean, known in ((1.947e5, 0.616), (2.992e5, 0.3126), (3.557e5, 0.1475)):
        x = np.linspace(0, LENGTH, 2001)
        scene = SEAL | {"pressure_drop": 1e-3 * mean}
        found = em.leak(RUBBER, TURNED, profile=(x, ellipse(x, mean)), **scene)
        even = leak(mean, 1e-3 * mean)
        middles = 0.5 * (x[1:] + x[:-1])
        series = LENGTH / np.sum(np.diff(x) / interpolated(ellipse(middles, mean)))
        assert found.conductance == pytest.approx(series, rel=5e-3)
        assert found.rate / even.rate == pytest.approx(known, rel=5e-3)
    x = np.linspace(0, LENGTH, 2001)
    shut = em.leak(
        RUBBER, TURNED, profile=(x, ellipse(x, 4.5e5)), pressure_drop=1e3, **SEAL
    )
    assert shut.rate == 0
    assert not shut.percolates
    assert shut.fluid_pressure(0.9 * LENGTH) == 0


def test_an_even_profile_is_an_even_pressure():
    """Of a liquid and of a gas that slips; and its bound."""
    gas = {"outlet_pressure": 1e5, "mean_free_path": 1e-8}
    for given in ({}, gas):
        even = leak(3e5, [1e5, 2.5e5], **given)
        found = em.leak(
            RUBBER, TURNED, profile=([1.0, 1.0 + LENGTH], [3e5, 3e5]),
            pressure_drop=[1e5, 2.5e5], **SEAL, **given,
        )  # fmt: skip
        np.testing.assert_allclose(found.rate, even.rate, rtol=1e-3)
        np.testing.assert_allclose(found.model_error, even.model_error, rtol=1e-3)
        np.testing.assert_allclose(found.area_ratio, even.area_ratio, rtol=1e-6)
        if given:
            np.testing.assert_allclose(found.knudsen, even.knudsen, rtol=3e-3)
        x = LENGTH * np.array([0.0, 0.3, 0.8, 1.0])
        np.testing.assert_allclose(
            found.fluid_pressure(1.0 + x), even.fluid_pressure(x), atol=500.0
        )


def test_little_gas_near_a_vacuum_and_near_closing():
    """Drops far below the pressure, and that far above the pressure behind the seal:
    nothing is lost in differences.
    """
    x, pressure = np.array([0.0, LENGTH]), np.array([4.4e5, 4.4e5])
    gas = {"outlet_pressure": 1.0, "mean_free_path": 0.0}
    for drop in (1.0, 1e2):
        found = em.leak(
            RUBBER, TURNED, profile=(x, pressure), pressure_drop=drop, **SEAL, **gas
        )
        assert found.rate == pytest.approx(
            float(leak(4.4e5, drop, **gas).rate), rel=2e-3
        )
        assert (np.diff(found.profile.fluid_pressure) < 0).all()


def test_a_seal_that_is_closed_all_along_until_the_fluid_opens_it():
    """Against a march of another program, within its steps."""
    surface = em.SelfAffine(
        0.75, rms_height=2e-6, q_low=2 * np.pi / 150e-6, q_high=2 * np.pi / 5e-6
    )
    x = np.linspace(0, 1e-3, 801)
    given = {"profile": (x, 8.5e5 * np.sin(np.pi * x / 1e-3)), "viscosity": 1e-3}
    rubber = em.Prony(1.5e6, [1e6], [1e-2])
    drop = np.array([4e5, 4.5e5, 5e5, 6e5, 8e5])
    found = em.leak(rubber, surface, pressure_drop=drop, **given)
    assert found.rate[0] == 0
    np.testing.assert_allclose(
        found.rate[1:], [2.1e-14, 2.8e-12, 2.2e-10, 9.3e-8], rtol=0.03
    )
    assert (found.error < 0.02).all()


@pytest.mark.parametrize("place", [0.1, 0.9])
def test_a_drop_just_below_a_sharp_peak(place):
    """As through its upper half alone, twice as finely: the fluid lifts what is below on
    its own side, and behind the peak that hardly holds it.
    """
    whole = LENGTH * np.array([0.0, place, 1.0]), 3e5 * np.array([0.0, 1.0, 0.0])
    upper = (
        LENGTH * np.array([place / 2, place, (1 + place) / 2]),
        whole[1]
        + [
            1.5e5,
            0.0,
            1.5e5,
        ],
    )
    scene = {"pressure_drop": [2.7e5, 2.85e5, 2.97e5]} | SEAL
    found, alone = (
        em.leak(RUBBER, TURNED, profile=each, **scene) for each in (whole, upper)
    )
    assert found.converged.all()
    off = np.abs(np.log(found.rate / alone.rate))
    assert (off < found.error + 0.03).all()


SMOOTH = em.SelfAffine(
    0.8, rms_height=1e-6, q_low=2 * np.pi / 100e-6, q_high=2 * np.pi / 2e-6
)
STEP = LENGTH * np.array([0.0, 0.6975, 0.7, 1.0]), [0.9e5, 0.9e5, 3e5, 3e5]


@pytest.mark.parametrize(
    ("profile", "long", "off"),
    [
        # the fluid lifts what is below it, and the flank holds back next to nothing
        (STEP, 0.3, 2e-3),
        (
            (LENGTH * np.array([0.0, 1e-3, 0.999, 1.0]), [0.0, 3e5, 3e5, 0.0]),
            0.998,
            3e-4,
        ),
    ],
)
def test_a_plateau_between_steep_flanks(profile, long, off):
    """As the even seal of the plateau alone, and a little less."""
    scene = {"pressure_drop": [1.5e5, 2.6e5, 2.97e5], "viscosity": 0.05}
    rubber = em.Prony(2.5e6, [1e3], [1e-9])
    found = em.leak(rubber, SMOOTH, profile=profile, **scene)
    plateau = em.leak(rubber, SMOOTH, pressure=3e5, length=long * LENGTH, **scene)
    assert found.converged.all()
    share = found.rate / plateau.rate
    assert ((share > 1 - off - 1e-4) & (share < 1 + 1e-4)).all()
    assert (found.error < 2e-3).all()


def test_a_plateau_in_a_fine_profile():
    """The kinks are found among many positions."""
    x = LENGTH * np.linspace(0.0, 1.0, 401)
    fine = np.union1d(x, STEP[0])
    scene = {"pressure_drop": 1.5e5, "viscosity": 0.05}
    rubber = em.Prony(2.5e6, [1e3], [1e-9])
    many = em.leak(rubber, SMOOTH, profile=(fine, np.interp(fine, *STEP)), **scene)
    few = em.leak(rubber, SMOOTH, profile=STEP, **scene)
    assert many.rate == pytest.approx(float(few.rate), rel=1e-4)


def test_two_ribs_hold_the_fluid_between_them():
    """Where the fluid presses harder than a valley it lifts that, and loses nothing."""
    x = np.linspace(0, LENGTH, 401)
    pressure = 3e5 * np.sin(2 * np.pi * x / LENGTH) ** 2
    found = em.leak(RUBBER, TURNED, profile=(x, pressure), pressure_drop=2.5e5, **SEAL)
    one = em.leak(
        RUBBER, TURNED, profile=(x[:201], pressure[:201]), pressure_drop=2.5e5, **SEAL
    )
    assert 0 < found.rate < one.rate
    valley = found.fluid_pressure(0.5 * LENGTH)
    assert found.fluid_pressure(0.48 * LENGTH) == pytest.approx(float(valley))
    assert 0 < valley < 2.5e5
    assert found.lifted > 0.1 * LENGTH
    assert "fluid presses harder" in found.summary()


def test_the_bound_is_that_of_what_contact_bears():
    """Of a little fluid it is the model's at the pressure; of much, between those at the
    ends; of a seal that only the fluid opens, finite.
    """
    little = leak(3e5, 1.0)
    at_inlet, at_outlet = leak(3e4, 1e-3).model_error, little.model_error
    much = leak(3e5, 2.7e5).model_error
    assert at_inlet < much < at_outlet
    opened = leak(1e6, 9e5).model_error
    assert at_inlet < opened < 1
    assert leak(1e6, 1e5).model_error == np.inf
    # each pressure off by its own bound, one way
    sigma = np.linspace(3e4, 3e5, 1001)
    each = leak(sigma, 1e-6 * sigma)
    least = np.trapezoid(each.conductance / (1 + each.model_error), sigma)
    most = np.trapezoid(each.conductance * (1 + each.model_error), sigma)
    whole = np.trapezoid(each.conductance, sigma)
    assert much == pytest.approx(max(most / whole, whole / least) - 1, rel=1e-3)


def test_an_o_ring():
    """Its pressure is Hertz' ellipse, with what its fluid adds everywhere."""
    scene = SEAL | {"pressure_drop": 2e5}
    ring = em.o_ring(RUBBER, 3e-3, [0.02, 0.03], fluid_pressure=2e5)
    found = em.leak(RUBBER, TURNED, o_ring=ring, **scene)
    for i in (0, 1):
        width = float(ring.width[i])
        x = np.linspace(0, width, 20001)
        pressure = ring.pressure_at(x - 0.5 * width)[i] + 2e5
        alone = em.leak(RUBBER, TURNED, profile=(x, pressure), **scene)
        np.testing.assert_allclose(found.rate[i], alone.rate, rtol=2e-3)
    np.testing.assert_allclose(found.pressure, ring.sealing_pressure, rtol=1e-12)
    assert (found.lifted == 0).all()
    rolled = em.load_material("epdm-70")
    aged = em.o_ring(rolled, 3e-3, 0.05, time=100.0, temperature=293.15)
    given = {"o_ring": aged, "pressure_drop": 1e4} | SEAL
    taken = em.leak(rolled, TURNED, **given)
    named = em.leak(
        rolled, TURNED, time=100.0, temperature=293.15, length=aged.width, **given
    )
    assert taken.rate == named.rate
    assert taken.time == 100.0


@pytest.mark.parametrize(
    "model", ["critical constriction", em.HalfSpace(cells=64, seeds=2)]
)
def test_other_models_along_the_seal(model):
    """An even profile, by few contacts of maps within their error."""
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e4, q_high=4e4)
    scene = {"pressure_drop": 6e4, "model": model} | SEAL
    even = em.leak(RUBBER, surface, pressure=1e5, length=LENGTH, **scene)
    found = em.leak(RUBBER, surface, profile=([0.0, LENGTH], [1e5, 1e5]), **scene)
    np.testing.assert_allclose(found.rate, even.rate, rtol=0.05)
    dry = em.leak(
        RUBBER, surface, pressure=1e5, length=LENGTH, **scene | {"pressure_drop": 10.0}
    )
    assert even.conductance > 1.2 * dry.conductance


def test_kinematic_viscosity():
    found = leak(3e5, 1e5, viscosity=None, kinematic_viscosity=46e-6, density=870.0)
    assert found.rate == leak(3e5, 1e5, viscosity=46e-6 * 870.0).rate
    assert found.viscosity == 46e-6 * 870.0


PROFILE = ([0.0, LENGTH], [3e5, 3e5])
RING = em.o_ring(RUBBER, 3e-3, 0.05)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"pressure": 1e5, "profile": PROFILE}, ("profile", 'pressure')),
        ({}, ("", 'o_ring', 'pressure')),
        ({"pressure": 1e5}, ("length",)),
        ({"profile": PROFILE, "length": 1e-3}, ("length", 'left out')),
        ({"o_ring": RING, "length": 1e-3}, ("length", 'left out')),
        ({"profile": ([0.0, LENGTH], [-1e5, 3e5])}, ("profile", 'positive')),
        ({"profile": ([0.0, LENGTH], [5e4, 9e4])}, ("pressure_drop", 'seal opens')),
        ({"profile": ([0.0], [5e5])}, ("profile", 2)),
        ({"o_ring": 1e5}, ("o_ring", 'em.o_ring')),
        ({"o_ring": em.o_ring(em.Prony(1e6, [], []), 3e-3, 0.05)}, ("material", 'rubber')),
        ({"profile": PROFILE, "viscosity": None}, ("", 'kinematic_viscosity', 'viscosity')),
        (
            {"profile": PROFILE, "viscosity": None, "kinematic_viscosity": 1e-6},
            ("kinematic_viscosity", 'density'),
        ),
    ],
)  # fmt: skip
def test_bad_input(change, words):
    with refused(*words):
        em.leak(RUBBER, TURNED, **SEAL | {"pressure_drop": 1e5} | change)
    viscous = em.StandardSolid(2.5e6, 1e6, 1.0)
    ring = em.o_ring(viscous, 3e-3, 0.05, time=10.0)
    with refused("time", "O-ring"):
        em.leak(viscous, TURNED, o_ring=ring, time=1.0, pressure_drop=1e4, **SEAL)


SOFTENING = em.Softening([1e-3, 1e-2, 0.1, 1.0], [1, 0.9, 0.7, 0.5], [1, 1.1, 0.9, 0.5])
# options of a leak, of which each pair is taken together
OPTIONS = {
    "time": {"time": 30.0},
    "temperature": {"temperature": 300.0},
    "gas": {"outlet_pressure": 1e5, "mean_free_path": 6e-8},
    "air": {"outlet_pressure": 1e5, "molar_mass": 0.029, "temperature": 300.0},
    "density": {"density": 900.0},
    "kinematic": {"kinematic_viscosity": 1e-5, "density": 900.0},
    "closed outlet": {"pressure": 9e5, "pressure_drop": 7e5},
    "bulk": {"bulk": 1e8},
    "rolloff": {"q_rolloff": 2e4},
    "softening": {"softening": SOFTENING},
    "lay": {"lay": np.log(3.0), "direction": 0.4},
    "skewness": {"skewness": -0.5},
}
FLUIDS = "gas", "air", "density", "kinematic"  # of which "gas" and "density" agree
PAIRS = [
    pair
    for pair in itertools.combinations(OPTIONS, 2)
    if not set(pair) <= set(FLUIDS) or pair == ("gas", "density")
]
# of which there are no derivatives, with the argument that says so
UNDERIVED = {
    "profile": {"profile": PROFILE},
    "constriction": {"model": em.CriticalConstriction()},
    "medium": {"model": em.EffectiveMedium()},
}
OTHERS = [name for name in OPTIONS if name not in FLUIDS]
# every pair is in one of the first, which take all at once; each by itself in the others
TOGETHER = [
    (),
    *((*OTHERS, *fluid) for fluid in (("gas", "density"), ("air",), ("kinematic",))),
    *(pytest.param(pair, marks=pytest.mark.slow) for pair in PAIRS),
]


def of_options(options):
    """Rate, real contact, gap and bounds of five numbers, with the options."""
    given = {"pressure": 2.5e5, "pressure_drop": 1e5}
    for name in options:
        given |= (OPTIONS | UNDERIVED)[name]
    if "profile" in given:
        del given["pressure"]
    more = {name: given.pop(name) for name in ("bulk", "softening") if name in given}
    knee = given.pop("q_rolloff", None)
    heights = {name: given.pop(name) for name in ("lay", "skewness") if name in given}
    if "kinematic_viscosity" not in given:
        given["viscosity"] = 2e-3

    def numbers(x):
        rubber = em.Prony(
            1e6 * x[0], [3e6 * x[1]], [2.0], shift=em.WLF(8.86, 101.6, 293.15), **more
        )
        surface = em.SelfAffine(
            0.8, rms_slope=0.6 * x[2], q_low=1e4, q_high=1.6e5, q_rolloff=knee
        )
        if heights:
            surface = measured(surface, **heights)
        changed = {"pressure_drop": given["pressure_drop"] * x[4]}
        if "profile" not in given:
            changed |= {"pressure": given["pressure"] * x[3], "length": LENGTH}
        found = em.leak(rubber, surface, width=0.1, **given | changed)
        values = found.rate, found.area_ratio, found.mean_gap
        return [*values, found.model_error, found.error]

    return numbers


@pytest.mark.parametrize("options", TOGETHER, ids="-".join)
def test_options_under_jax(options):
    """`jit` and `vmap` against the plain call, gradients against differences."""
    numbers = of_options(options)
    places = np.array([np.ones(5), np.full(5, 1.01)])
    ways = np.array([[1.0, -0.5, 0.3, 0.7, 0.2], [0.2, 0.4, -0.3, 0.9, -0.6]])
    with jax.enable_x64(True):
        values, slopes = jax.jit(
            jax.vmap(lambda x, way: jax.jvp(numbers, (x,), (way,)))
        )(places, ways)
    for i, (x, way) in enumerate(zip(places, ways, strict=True)):
        plain = np.array(numbers(x))
        np.testing.assert_allclose([v[i] for v in values], plain, rtol=1e-9)
        ahead, behind = (np.array(numbers(x + h * way)) for h in (1e-4, -1e-4))
        differences = (ahead - behind)[:3] / 2e-4
        np.testing.assert_allclose([v[i] for v in slopes[:3]], differences, rtol=1e-4)


@pytest.mark.parametrize("option", [name for name in OPTIONS if name[:6] != "closed"])
@pytest.mark.parametrize("other", UNDERIVED)
def test_options_without_derivatives(option, other):
    """Many points are each alone; under JAX the argument that has none is named."""
    numbers = of_options((option, other))
    drops = np.array([1.0, 0.6])
    together = numbers([1.0, 1.0, 1.0, 1.0, drops])
    for i, drop in enumerate(drops):
        alone = numbers([1.0, 1.0, 1.0, 1.0, drop])
        assert alone[0] > 0
        np.testing.assert_allclose([v[i] for v in together], alone, rtol=1e-9)
    argument = "pressure" if other == "profile" else "model"
    with jax.enable_x64(True), refused(argument, "jit"):
        jax.jit(numbers)(np.ones(5))


def test_gradient_in_reverse():
    """Of one number by five, as `jax.grad` gives it; its formula has fewer nodes."""
    rate = of_options(("time", "gas"))
    x = np.ones(5)
    with jax.enable_x64(True):
        slopes = np.asarray(jax.grad(lambda x: rate(x)[0])(x))
    for i, h in enumerate(1e-4 * np.eye(5)):
        difference = (rate(x + h)[0] - rate(x - h)[0]) / 2e-4
        assert slopes[i] == pytest.approx(difference, rel=3e-4)


@pytest.mark.parametrize("given", [{"profile": PROFILE}, {"o_ring": RING}])
def test_pressures_along_the_seal_are_refused_under_jax(given):
    with refused("pressure", "jax.jit"):
        jax.grad(
            lambda p: em.leak(RUBBER, TURNED, pressure_drop=p, **SEAL, **given).rate
        )(1e4)


_SCENE = """material = "epdm-70"
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_height = "3 um"
longest = "200 um"
shortest = "4 um"
"""
_RING = """[o_ring]
diameter = "3 mm"
squeeze = [0.03, 0.05]
time = ["1 s", "1 min"]
fluid_pressure = "1 bar"
"""
_LEAK = """[leak]
pressure_drop = "1 bar"
kinematic_viscosity = "46 cSt"
density = "870 kg/m^3"
"""
FACE = em.SelfAffine(
    0.8, rms_height=3e-6, q_low=2 * np.pi / 200e-6, q_high=2 * np.pi / 4e-6
)
OIL = {"pressure_drop": 1e5, "viscosity": 46e-6 * 870.0}


def test_scene_of_an_o_ring(tmp_path):
    scene = tmp_path / "scene.toml"
    scene.write_text(_SCENE + _RING + _LEAK, encoding="utf-8")
    rubber = em.load_material("epdm-70")
    found = em.leak(**read_scene("leak", scene).arguments(tmp_path))
    assert found.rate.shape == (2, 2)
    for i, time in enumerate((1.0, 60.0)):
        ring = em.o_ring(
            rubber,
            3e-3,
            [0.03, 0.05],
            time=time,
            temperature=293.15,
            fluid_pressure=1e5,
        )
        alone = em.leak(rubber, FACE, o_ring=ring, **OIL)
        np.testing.assert_allclose(found.rate[i], alone.rate, rtol=1e-4)
    for change, words in (
        (("[leak]", '[leak]\ntime = "1 s"'), r"\[leak\] time must be left out"),
        (
            ('"epdm-70"', '["epdm-70", "silicone-like"]'),
            "material must be a single one",
        ),
        (("[leak]", '[leak]\npressure = "1 MPa"'), "pressure"),
    ):
        text = (_SCENE + _RING + _LEAK).replace(*change, 1)
        scene.write_text(text, encoding="utf-8")
        with pytest.raises(em.InputError, match=words):
            em.leak(**read_scene("leak", scene).arguments(tmp_path))


def test_scene_of_a_profile(tmp_path):
    scene, profile = tmp_path / "scene.toml", tmp_path / "lip.csv"
    profile.write_text(
        "position [mm], pressure [MPa]\n0, 0\n0.4, 0.5\n0.6, 0.4\n1, 0\n",
        encoding="utf-8",
    )
    more = 'profile = "lip.csv"\ntime = "1 min"\n'
    scene.write_text(_SCENE + _LEAK + more, encoding="utf-8")
    found = em.leak(**read_scene("leak", scene).arguments(tmp_path))
    given = [0.0, 4e-4, 6e-4, 1e-3], [0.0, 5e5, 4e5, 0.0]
    rubber = em.load_material("epdm-70")
    alone = em.leak(rubber, FACE, profile=given, time=60.0, temperature=293.15, **OIL)
    assert found.rate == pytest.approx(float(alone.rate), rel=1e-12)
    assert found.lifted > 0


def test_lengths_of_a_seal_under_one_pressure():
    """They were refused by NumPy where the pressure is a single number."""
    given = {"pressure": 3e5, "pressure_drop": 1e5, "viscosity": 1e-3}
    rubber = em.Prony(1e6, [2e6], [1e-2])
    road = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
    lengths = [[1e-3, 2e-3, 4e-3]]
    found = em.leak(rubber, road, length=lengths, **given)
    alone = em.leak(rubber, road, length=2e-3, **given)
    assert found.rate.shape == (1, 3)
    np.testing.assert_allclose(found.rate[0, 1], alone.rate, rtol=1e-12)
    np.testing.assert_allclose(
        found.fluid_pressure([5e-4])[0, 1], alone.fluid_pressure([5e-4]), rtol=1e-12
    )
