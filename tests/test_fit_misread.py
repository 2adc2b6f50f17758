"""A loss tangent or a phase angle in another unit than its title says, or beside the other modulus: found where no
passive material has them as they are read, and nowhere else.
"""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning

from .dma_files import KNOWN, measure
from .test_fit_swapped import MATERIALS

CELSIUS = np.array([-10.0, 10.0, 30.0])
OTHERWISE = "suit no passive material as they are named, and one if"


def measured(material, noise=0.01):
    """f [Hz], T [degC], storage and loss modulus, |G*| [Pa], loss tangent and phase angle [rad]."""
    f, celsius, storage, loss = measure(material, CELSIUS, np.geomspace(0.1, 50, 12), noise).T
    return f, celsius, storage, loss, np.hypot(storage, loss), loss / storage, np.arctan2(loss, storage)


def table(f, celsius, first, second, titles):
    rows = [",".join(f"{x:.12g}" for x in row) for row in zip(f, celsius, first, second, strict=True)]
    return "\n".join([f"f [Hz],T [degC],{titles}", *rows])


@pytest.mark.parametrize("name", MATERIALS)
def test_right_units_are_read_without_a_word(name, write):
    f, celsius, storage, loss, absolute, tangent, angle = measured(MATERIALS[name])
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        for titles, first, second in (
            ("G' [Pa],tan delta", storage, tangent),
            ("G' [Pa],tan delta [%]", storage, 100 * tangent),
            ("|G*| [Pa],phase [deg]", absolute, np.degrees(angle)),
            ("|G*| [Pa],phase [rad]", absolute, angle),
        ):
            dma = em.fit.read_dma(write(table(f, celsius, first, second, titles)))
            np.testing.assert_allclose(dma.storage, storage, rtol=1e-9)
            np.testing.assert_allclose(dma.loss, loss, rtol=1e-9)


def wrong(name):
    f, celsius, storage, loss, absolute, tangent, angle = measured(
        MATERIALS["glass"] if name == "deg called rad" else KNOWN
    )
    titles, first, second = {
        "percent without a unit": ("G' [Pa],tan delta", storage, 100 * tangent),
        "a ratio called percent": ("G' [Pa],tan delta [%]", storage, tangent),
        "rad called deg": ("|G*| [Pa],phase [deg]", absolute, angle),
        "deg called rad": ("|G*| [Pa],phase [rad]", absolute, np.degrees(angle)),
        "loss called storage": ("G' [Pa],tan delta", loss, tangent),
        "exchanged": ("G' [Pa],tan delta", loss, storage / loss),
    }[name]
    return table(f, celsius, first, second, titles)


@pytest.mark.filterwarnings("ignore:.*rows left out")
@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("percent without a unit", f"\"G' \\[Pa\\]\" and 'tan delta' {OTHERWISE} 'tan delta' is in %. Assumed are"),
        ("a ratio called percent", "'tan delta \\[%\\]' (is a ratio|in %)"),
        ("rad called deg", "Assumed .*'phase \\[deg\\]' in deg"),
        ("deg called rad", "phase \\[rad\\]' is in deg. Assumed .*'phase \\[rad\\]' in rad"),
        ("loss called storage", f'{OTHERWISE} "G\' \\[Pa\\]" is the loss modulus. Assumed'),
        ("exchanged", "is the loss modulus and 'tan delta' storage over loss modulus. Assumed"),
    ],
)
def test_wrong_units_and_names_are_said(name, said, write):
    with pytest.warns(FitWarning, match=said):
        em.fit.read_dma(write(wrong(name)))


@pytest.mark.parametrize(
    ("titles", "factor", "said"),
    [
        ("|G*| [Pa]", 10.0, "the absolute modulus '|G*| [Pa]' is 10 times"),
        ("|G*| [kPa]", 1.0, "the absolute modulus '|G*| [kPa]' is 1e+03 times"),
        ("|G*|", 1.0, ""),  # in what, nobody says
        ("|G*| [kPa]", 1e-3, ""),
        ("phase [deg]", 1.0, "the phase angle 'phase [deg]' is 0.0175 times"),
        ("phase [rad]", 1.0, ""),
        ("tan delta", 2.0, "the loss tangent 'tan delta' is 2 times"),
    ],
)
def test_columns_that_say_the_same_are_compared(titles, factor, said, write):
    f, celsius, storage, loss, absolute, tangent, angle = measured(KNOWN)
    third = {"|": absolute, "p": angle, "t": tangent}[titles[0]] * factor
    text = table(f, celsius, storage, loss, f"G' [Pa],G'' [Pa],{titles}").splitlines()
    text[1:] = [f"{line},{x}" for line, x in zip(text[1:], third, strict=True)]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        em.fit.read_dma(write("\n".join(text)))
    assert [said in str(one.message) and 'Assumed are "G\' [Pa]" and' in str(one.message) for one in caught] == (
        [True] if said else []
    )


def test_a_loss_tangent_beside_modulus_and_phase_is_compared_too(write):
    f, celsius, _, _, absolute, tangent, angle = measured(KNOWN)
    text = table(f, celsius, absolute, angle, "|G*| [Pa],phase [rad],tan delta").splitlines()
    text[1:] = [f"{line},{100 * x}" for line, x in zip(text[1:], tangent, strict=True)]
    with pytest.warns(FitWarning, match="loss tangent 'tan delta' is 100 times .* Assumed are .*phase"):
        em.fit.read_dma(write("\n".join(text)))


def test_moduli_a_thousand_times_too_small_are_said(write):
    """A rubber slightly above 1 kPa, from its plateau into its transition: numbers in MPa, titles in kPa."""
    f, celsius, storage, loss, *_ = measured(em.load_material("sbr-gum-like"))
    assert 1e6 < storage.max() < 1e7
    assert (loss > storage).any()
    with pytest.warns(FitWarning, match="low for a solid polymer, unless it is a gel; assumed is the unit"):
        em.fit.read_dma(write(table(f, celsius, storage / 1e6, loss / 1e6, "G' [kPa],G'' [kPa]")))
