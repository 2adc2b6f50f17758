"""Strain softening: the class, its place in materials and files, and what it makes of
friction on surfaces.
"""

import re

import jax
import numpy as np
import pytest
from scipy.special import erf

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit.report import abaqus_card, plain_card
from elastomdr.material.library import load_material, save_material
from elastomdr.rough.multiscale import FORM

from ..refused import mentions, refused, warned
from .check import check_material

STRAIN, STORAGE, LOSS = (
    [1e-3, 1e-2, 0.1, 1.0],
    [1.0, 0.8, 0.5, 0.4],
    [1.0, 1.3, 0.9, 0.5],
)
PAYNE = em.Softening(STRAIN, STORAGE, LOSS)


def rubber(**options):
    return em.Prony(
        1e6, [5e6, 2e7], [1e-5, 1e-3], softening=PAYNE, name="filled", **options
    )


def test_factors_meet_the_sweep_stay_monotone_and_are_held_beyond_it():
    for factor, given in zip(PAYNE.factors(STRAIN), (STORAGE, LOSS), strict=True):
        np.testing.assert_allclose(factor, given, rtol=1e-14)
    strain = np.geomspace(1e-6, 100.0, 4001)
    storage, loss = PAYNE.factors(strain)
    assert (np.diff(storage) <= 1e-15).all()
    assert (storage[0], storage[-1], loss[-1]) == (1, 0.4, 0.5)
    assert loss.max() == pytest.approx(1.3, abs=1e-5)  # no overshoot between the points
    np.testing.assert_array_equal(PAYNE.outside([1.0, 1.001]), [False, True])


def test_below_its_first_strain_a_sweep_goes_to_one_as_the_strain():
    storage, loss = em.Softening([0.1, 1.0], [0.8, 0.5], [1.2, 0.7]).factors(
        [0.0, 0.05, 0.0999999, 0.1]
    )
    np.testing.assert_allclose(storage, [1.0, 0.9, 0.8, 0.8], rtol=1e-6)
    np.testing.assert_allclose(loss, [1.0, 1.1, 1.2, 1.2], rtol=1e-6)


def test_a_complex_modulus_softens_part_by_part():
    np.testing.assert_allclose(PAYNE.of(2e6 + 1e6j, 0.1), 1e6 + 0.9e6j)


def test_factors_differentiate():
    def value(table, strain):
        return sum(em.Softening(STRAIN, table, LOSS).factors(strain))

    table, strain = np.array(STORAGE), 0.037
    with jax.enable_x64(True):
        by_table, by_strain = jax.jit(jax.grad(value, (0, 1)))(table, strain)
    h = 1e-6
    assert by_strain == pytest.approx(
        (value(table, strain + h) - value(table, strain - h)) / (2 * h), rel=1e-6
    )
    step = h * np.eye(4)[2]
    assert by_table[2] == pytest.approx(
        (value(table + step, strain) - value(table - step, strain)) / (2 * h), rel=1e-6
    )


@pytest.mark.parametrize(
    ("strain", "storage", "loss", "said"),
    [
        (
            [0.1, 1, 10],
            [1, 0.9, 0.8],
            [1, 1, 1],
            ("strain", 10),
        ),
        (
            STRAIN,
            [1.2, 1, 1, 1],
            LOSS,
            ("storage", 1, 1.2),
        ),
        (
            STRAIN,
            [1, 0.8, 0.9, 0.4],
            LOSS,
            ("storage", 0.8, 0.9, 2),
        ),
        (STRAIN, [1, 0.8, 0.5, 0], LOSS, ("storage", 0)),
        (
            STRAIN,
            [1, 0.8, 0.5, np.nan],
            LOSS,
            ("storage", "positive"),
        ),
        (STRAIN, STORAGE, [1, 1, 1, 11], ("loss", 10, 11)),
        (STRAIN, STORAGE, LOSS[:3], ("", "strain", 3)),
        ([0.1], [1], [1], ("", "strain", 2)),
        ([0.1, 0.1], [1, 1], [1, 1], ("", "strain", "ascending")),
    ],
)
def test_bad_sweeps_get_one_clear_line(strain, storage, loss, said):
    with refused(*said) as error:
        em.Softening(strain, storage, loss)
    assert "\n" not in str(error.value)


def test_materials_and_foundations_carry_it():
    table = em.TabulatedModulus(
        [1, 10, 100], [1e6] * 3, [1e5] * 3, softening=PAYNE, shift=em.WLF(5, 100, 293)
    )
    series = rubber(shift=em.WLF(5, 100, 293))
    for material in (series, table, rubber(bulk=2e9, shift=em.WLF(5, 100, 293))):
        changed = (
            material.at(313.0),
            material.shear(),
            material.tensile(),
            em.half_space(material),
        )
        assert all(other.softening is PAYNE for other in changed)
    assert em.KelvinVoigt(1e6, 10.0, softening=PAYNE).softening is PAYNE
    assert em.springs(series, 0.01, bonded=False).softening is PAYNE
    assert em.half_space(rubber(), rubber()).softening is PAYNE
    with pytest.warns(em.ModelWarning, match="taken as linear"):
        assert em.half_space(rubber(), em.Prony(1e6, [], [])).softening is None
    with refused("softening", "em.Softening"):
        em.Prony(1e6, [], [], softening=0.5)


def test_files_carry_it(tmp_path):
    path = tmp_path / "filled.toml"
    save_material(rubber(), path)
    back = load_material(path).softening
    for key in ("strain", "storage", "loss"):
        np.testing.assert_array_equal(getattr(back, key), getattr(PAYNE, key))
    text = path.read_text()
    assert "factors on the loss" in text
    assert "loss moduli [Pa]" not in text
    path.write_text(text.replace("    0.4,", "    0.6,"))
    with refused("", "filled.toml", "softening"):
        load_material(path)
    path.write_text(re.sub(r"loss = \[.*?\n\][^\n]*\n", "", text, flags=re.DOTALL))
    with refused("name_or_path", "[softening] loss"):
        load_material(path)
    path.write_text(text.replace("    1.3,", ""))
    with refused("name_or_path", "[softening] loss", 3, 4):
        load_material(path)


def test_the_check_wants_its_source_and_a_sweep_from_small_strain(tmp_path):
    path = tmp_path / "filled.toml"
    save_material(
        em.Prony(
            1e6, [], [], softening=em.Softening([0.5, 1.0], [0.4, 0.3], [0.9, 0.8])
        ),
        path,
    )
    findings = "\n".join(check_material(path))
    assert mentions(findings, "citation", "[source.softening]")
    assert mentions(findings, 0.4, 0.5, 2)


def test_cards_say_that_they_are_of_small_strain():
    for card in (abaqus_card(rubber()), plain_card(rubber())):
        assert mentions(card, 0.4, 1)


KRAUS = np.geomspace(1e-4, 3.0, 160)


def kraus(strain):
    """Factors as Kraus' form has them."""
    return 0.3 + 0.7 / (1 + strain / 0.02), 0.4 + 0.6 / (1 + strain / 0.1)


SOFT = em.Softening(KRAUS, *kraus(KRAUS))
ROAD = em.SelfAffine(0.8, rms_slope=0.6, q_low=1e3, q_high=1e5, q_rolloff=3e3)
# E* = 4 G, incompressible
BRANCHES = 4 * np.array([3e6, 8e6, 2e7]), np.array([1e-4, 1e-3, 1e-2])


def of_rubber(softening, **options):
    return em.Prony(1e6, BRANCHES[0] / 4, BRANCHES[1], softening=softening, **options)


def integrals(velocity, pressure, share, factors):
    """Friction and area of Persson's theory and of Multiscale, by plain sums over 6000
    waves and 90 angles: (mu, area) of each.
    """
    edges = np.linspace(np.log(1e3), np.log(1e5), 6001)
    q, step = np.exp(0.5 * (edges[1:] + edges[:-1])), edges[1] - edges[0]
    phi = (np.arange(90) + 0.5) * np.pi / 180

    def averages(q, strain=None):
        """Of E* at q v; of rubber that does not soften where no strain is given."""
        iwt = 1j * (q * velocity)[:, None, None] * np.cos(phi)[:, None] * BRANCHES[1]
        modulus = 4e6 + (BRANCHES[0] * iwt / (1 + iwt)).sum(-1)
        if strain is not None:
            storage, loss = (factor[:, None] for factor in factors(strain))
            modulus = storage * modulus.real + 1j * loss * modulus.imag
        return 2 * np.pi * (np.cos(phi) * modulus.imag).mean(1), 2 * np.pi * (
            abs(modulus) ** 2
        ).mean(1)

    power = q**4 * ROAD.at(q)
    # mean square slope of the waves up to q
    slope = np.cumsum(2 * np.pi * power * step)
    strain = share * np.sqrt(slope - np.pi * power * step)
    drag, stiffness = averages(q, strain)
    rate = power * stiffness / (8 * pressure**2)

    def contact(spread):
        return erf(0.5 / np.sqrt(spread))

    def stored(rates, gamma):
        """G where S = gamma + (1 - gamma) P^2 is inside its integral, at the end of
        each step.
        """
        spread, out = 1e-12, [1e-12]
        for each in rates:
            half = spread + 0.5 * step * each * (
                gamma + (1 - gamma) * contact(spread) ** 2
            )
            spread += step * each * (gamma + (1 - gamma) * contact(half) ** 2)
            out.append(spread)
        return np.array(out)

    spread = stored(rate, 0.5)
    shares = contact(0.5 * (spread[1:] + spread[:-1]))
    area, full = contact(spread[-1]), power * drag * step / (2 * pressure)
    persson = (full * 0.5 * (1 + shares**2) * shares).sum()

    form, plain = FORM, stored(rate, FORM.gamma)

    def in_contact(plain, q):
        """G and P, of contacts that are finer than their waves."""
        finer = averages(q * np.exp(form.finer))[1] / averages(q)[1]
        spread = plain * finer ** (1 - contact(plain))
        return spread, contact(spread)

    shares = in_contact(0.5 * (plain[1:] + plain[:-1]), q)[1]
    ahead = np.minimum(np.log(q) + form.ahead, edges[-1])
    later = in_contact(np.interp(ahead, edges, plain), np.exp(ahead))[1]
    end, last = (x[0] for x in in_contact(plain[-1:], np.array([1e5])))
    whole = last * (1 + 2 * end) + 2 * np.sqrt(end / np.pi) * np.exp(-0.25 / end) - 1
    stiffer = np.log(
        np.divide(*(averages(1e5 * np.exp([x]))[1] for x in (form.finer, 0)))
    )
    width = np.sqrt(np.cov(np.log(q), aweights=power, ddof=0))
    more = form.excess - form.stiffer * stiffer[0] * np.sqrt(last)
    more -= form.narrow * (1 - last**0.25) * np.exp(-width)
    whole *= np.exp((1 - last) ** 1.5 * more)
    own = 2 * rate * later ** (4 / 3)
    of_own = own.sum() * step
    own *= min(1.0, whole / of_own)
    source = 2 * rate * averages(q * np.exp(form.finer))[1] / averages(q)[1]
    source *= shares**0.6
    level = max(0.0, whole - of_own) / (source.sum() * step)
    below = np.cumsum(power) - 0.5 * power
    distance = (np.cumsum(below) - 0.5 * below) * step / below
    steep = form.further * (1 - shares**0.25) / distance
    fine = source * steep / (1 + steep**8) ** 0.125
    # far beyond q_high, whose rubber is strained as at q_high
    count = q.size + int(np.log(3e3) / step)
    lag = step * np.arange(count)
    near, far = 4 * np.exp(-4 * lag), 6 * np.exp(-2 * lag) * (1 - np.exp(-2 * lag)) ** 2
    near[0] /= 2  # of half a step
    spectrum = np.convolve(source - fine, near)[:count]
    spectrum += np.convolve(fine, far)[:count]
    spectrum *= level * step
    spectrum[: q.size] += own
    strained = np.full(count, share * np.sqrt(slope[-1]))
    strained[: q.size] = strain
    on_drag, on_stiffness = averages(q[0] * np.exp(lag), strained)
    multiscale = 2 * pressure * (spectrum * on_drag / on_stiffness).sum() * step
    return (persson, area), (multiscale, last + last**3 * (1 - last) / 4)


@pytest.mark.parametrize(
    ("velocity", "pressure"), [(1e-3, 1e6), (0.1, 2e5), (10.0, 1e6)]
)
def test_softened_friction_is_its_integrals_evaluated_independently(velocity, pressure):
    asked = {"velocity": velocity, "pressure": pressure, "strain_share": 0.7}
    found = integrals(velocity, pressure, 0.7, kraus)
    for model, (mu, area) in zip(("persson", "multiscale"), found, strict=True):
        curve = em.friction(of_rubber(SOFT), ROAD, model=model, **asked)
        assert curve.mu == pytest.approx(mu, rel=3e-3)
        assert curve.area_ratio == pytest.approx(area, rel=3e-3)
        straight = em.friction(of_rubber(None), ROAD, model=model, **asked)
        assert curve.linear == pytest.approx(float(straight.mu), rel=2e-3)
        assert curve.area_ratio > 1.5 * straight.area_ratio
        assert curve.model_error > 0
        assert "softened by the strain" in curve.model
        assert "contact area" in curve.summary()


def test_the_bound_holds_what_the_strain_may_be():
    """Within 1.35 in light contact: the larger change of mu is added to the bound of a
    linear rubber with that contact.
    """
    asked = {"velocity": 0.1, "pressure": 5e4}
    found, more, less = (
        em.friction(of_rubber(SOFT), ROAD, strain_share=0.5 * factor, **asked)
        for factor in (1.0, 1.35, 1 / 1.35)
    )
    assert found.area_ratio < 0.12
    change = max(abs(float(x.mu) - float(found.mu)) for x in (more, less))
    of_linear = em.Multiscale().bound(
        em.half_space(of_rubber(None)), ROAD, np.array(0.1), found.area_ratio
    )
    expected = float(of_linear) * float(found.mu) + change
    assert float(found.model_error) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("model", ["persson", "multiscale"])
def test_factors_of_one_change_nothing(model):
    asked = {"velocity": np.geomspace(1e-3, 10, 5), "pressure": 3e5, "model": model}
    one = em.friction(
        of_rubber(em.Softening([1e-4, 1.0], [1, 1], [1, 1])), ROAD, **asked
    )
    straight = em.friction(of_rubber(None), ROAD, **asked)
    for field in ("mu", "area_ratio", "model_error"):
        np.testing.assert_allclose(
            getattr(one, field), getattr(straight, field), rtol=1e-13
        )
    assert straight.linear is None


def test_even_factors_are_a_softer_rubber():
    half = em.Softening([1e-9, 1e-8], [0.5, 0.5], [0.5, 0.5])
    with warned(em.ExtrapolationWarning, 1e-08, "sweep"):
        curve = em.friction(of_rubber(half), ROAD, velocity=0.1, pressure=1e5)
    softer = em.Prony(0.5e6, BRANCHES[0] / 8, BRANCHES[1])
    assert curve.mu == pytest.approx(
        float(em.friction(softer, ROAD, velocity=0.1, pressure=1e5).mu), rel=1e-12
    )
    assert curve.extrapolated.all()


def test_models_that_are_linear_say_so():
    surface = em.SelfAffine(0.8, rms_slope=0.3, q_low=1e3, q_high=8e3)
    curve, straight = (
        em.friction(
            em.Foundation(
                1e6, np.full(6, 2e6), np.geomspace(1e-6, 1e-1, 6), softening=softening
            ),
            surface,
            velocity=0.1,
            pressure=2e5,
            model=em.HalfSpace(cells=64),
            rtol=1e-3,
        )
        for softening in (SOFT, None)
    )
    assert curve.mu == straight.mu
    assert np.isnan(curve.model_error)
    assert "strain left out" in curve.model
    assert "this model is linear" in curve.summary()


@pytest.mark.parametrize("share", [0.0, -1.0, 50.0, np.nan])
def test_a_share_that_is_none(share):
    with refused("strain_share", 0, 2):
        em.friction(
            of_rubber(SOFT), ROAD, velocity=0.1, pressure=1e5, strain_share=share
        )


@pytest.mark.slow
def test_gradients_through_softening():
    def mu(storage, share, velocity):
        soft = em.Softening(STRAIN, 1 - storage * (1 - np.array(STORAGE)), LOSS)
        asked = {
            "velocity": velocity,
            "pressure": 3e5,
            "strain_share": share,
            "rtol": 1e-8,
        }
        return em.friction(of_rubber(soft), ROAD, **asked).mu

    at = np.array([0.9, 0.5, 0.1])
    with jax.enable_x64(True):
        slopes = jax.grad(mu, (0, 1, 2))(*at)
    for i, step in enumerate(1e-4 * np.diag(at)):
        difference = (float(mu(*(at + step))) - float(mu(*(at - step)))) / (2 * step[i])
        assert float(slopes[i]) == pytest.approx(difference, rel=1e-5)


def test_a_list_of_materials_and_a_scene(tmp_path):
    both = em.friction(
        [of_rubber(None, name="soft"), of_rubber(SOFT, name="hard")],
        ROAD,
        velocity=0.1,
        pressure=1e5,
    )
    assert both.mu.shape == (2,)
    save_material(of_rubber(SOFT, name="filled"), tmp_path / "filled.toml")
    (tmp_path / "road.toml").write_text(
        'material = "filled.toml"\n[surface]\nshape = "self_affine"\nhurst = 0.8\nrms_slope = 0.6\n'
        'longest = "6 mm"\nshortest = "60 um"\n[contact]\npressure = "0.1 MPa"\nvelocity = "0.1 m/s"\n'
        "strain_share = 0.25\n"
    )
    assert main(["friction", str(tmp_path / "road.toml"), "--out", str(tmp_path)]) == 0
    assert (
        "coefficient without softening" in (tmp_path / "road-friction.csv").read_text()
    )


def test_measured_factors_may_rise_by_noise():
    """The nearest factors that fall, in least squares, are taken, and it is said."""
    strain, loss = [1e-3, 1e-2, 0.1, 1.0], [1.0, 1.0, 1.0, 0.8]
    with warned(em.ModelWarning, "2.0%"):
        noisy = em.Softening(strain, [0.98, 1.02, 0.7, 0.72], loss)
    np.testing.assert_allclose(noisy.storage, [1.0, 1.0, 0.71, 0.71], rtol=1e-12)
    em.Softening(strain, noisy.storage, loss)  # as a file of it is read: no warning
    for storage in ([1.0, 0.8, 0.9, 0.4], [1.06, 1.06, 0.8, 0.7]):
        with refused("storage"):
            em.Softening(strain, storage, loss)
