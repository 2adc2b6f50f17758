"""Columns of logarithms: read where title or unit say so and which, refused where the base is not clear."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import FitWarning

ROWS = "\n".join(f"{f},20,{6 + 0.1 * f},{5 + 0.1 * f}" for f in (-1, 0, 0.5))


@pytest.mark.parametrize(
    ("header", "base", "rate", "modulus"),
    [
        ("log10 f [Hz],T [degC],log10 G' [kPa],log10 G'' [kPa]", 10, 2 * np.pi, 1e3),
        ("log10(f/Hz),T [degC],log10(G'/kPa) [-],log10(G''/kPa) [-]", 10, 2 * np.pi, 1e3),
        ("lg(w/(rad/s)),T [degC],lg(G') [Pa],lg(G'' [Pa])", 10, 1.0, 1.0),
        ("log_10 ω (rad/s),T [degC],log₁₀ G' / Pa,log10G'' / Pa", 10, 1.0, 1.0),
        ("log10_freq_hz,temperature_C,log10_G_storage_pa,log10_G_loss_pa", 10, 2 * np.pi, 1.0),
        ("ln f,T,ln G',ln G''\nHz,degC,kPa,kPa", np.e, 2 * np.pi, 1e3),
        ("f,T,G',G''\nln Hz,degC,ln kPa,ln(kPa)", np.e, 2 * np.pi, 1e3),
        ("ln f [Hz],T [degC],G' [ln MPa],ln G'' [ln MPa]", np.e, 2 * np.pi, 1e6),
    ],
)
def test_logarithms_are_read_as_their_titles_say(write, header, base, rate, modulus):
    dma = em.fit.read_dma(write(header + "\n" + ROWS))
    exponent = np.array([-1, 0, 0.5])
    np.testing.assert_allclose(dma.frequency, rate * base**exponent, rtol=1e-13)
    np.testing.assert_allclose(dma.storage, modulus * base ** (6 + 0.1 * exponent), rtol=1e-13)
    np.testing.assert_allclose(dma.loss, modulus * base ** (5 + 0.1 * exponent), rtol=1e-13)
    assert dma.kind == "shear"
    said = "log10" if base == 10 else "ln"
    assert dma.units["storage"].startswith(f"{said} of ")
    assert dma.units["temperature"] == "degC"


def test_a_logarithm_without_a_base_is_decadic_and_it_is_said(write):
    path = write("log t [s],log G(t) [Pa],T [degC]\n" + "\n".join(f"{t},{6 - 0.1 * t},20" for t in (-1, 0, 2)))
    with pytest.warns(FitWarning, match=r"'log t \[s\]', 'log G\(t\) \[Pa\]': assumed are decadic logarithms"):
        dma = em.fit.read_dma(path)
    np.testing.assert_allclose(dma.time, [0.1, 1, 100])
    np.testing.assert_allclose(dma.relaxation, 10 ** np.array([6.1, 6, 5.8]))
    with pytest.warns(FitWarning, match="decadic"):
        dma = em.fit.read_dma(write("log w [rad/s],T [degC],log G' [Pa],log tan delta\n1,20,6,-1\n2,20,6.2,-1\n"))
    np.testing.assert_allclose(dma.loss, 0.1 * dma.storage)


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("log10 f,T [K],log10 G' [Pa],log10 G'' [Pa]", "the unit of 'log10 f' is not in the file.*frequency_unit='Hz'"),
        ("log10 f [Hz],T [K],log10 G',log10 G'' [Pa]", "modulus_unit='MPa'"),
        ("log2 f [Hz],T [K],log2 G' [Pa],log2 G'' [Pa]", "'log2 f .Hz.' is a logarithm of a base that is not clear"),
        ("log_e f [Hz],T [K],log_e G' [Pa],log_e G'' [Pa]", "base that is not clear: write log10 or ln"),
        ("log f [ln Hz],T [K],log G' [Pa],log G'' [Pa]", "'ln Hz', which is none of Hz"),
    ],
)
def test_what_stays_ambiguous_is_refused(write, header, said):
    with pytest.raises(InputError, match=said):
        em.fit.read_dma(write(header + "\n" + ROWS))


def test_logarithms_that_the_user_names(write):
    path = write("log10 a [Hz],T [degC],ln stiffness [MPa],ln damp [MPa]\n" + ROWS)
    dma = em.fit.read_dma(path, columns={"frequency": 1, "storage": 3, "loss": 4}, kind="shear")
    np.testing.assert_allclose(
        [dma.frequency[1], dma.storage[1], dma.loss[1]], [2 * np.pi, 1e6 * np.exp(6), 1e6 * np.exp(5)]
    )
    path = write("log2 a [Hz],T [degC],G' [Pa],G'' [Pa]\n" + ROWS)
    with pytest.raises(InputError, match=r"'log2 a .Hz.' is a logarithm of a base"):
        em.fit.read_dma(path, columns={"frequency": 1})
    path = write("log10 f,T [degC],log10 G',log10 G''\n" + ROWS)
    dma = em.fit.read_dma(path, frequency_unit="Hz", modulus_unit="kPa")
    np.testing.assert_allclose([dma.frequency[1], dma.storage[1]], [2 * np.pi, 1e9])


def test_plain_columns_go_before_their_logarithms_and_numbers_that_are_none_are_named(write):
    header = "log f [Hz],f [Hz],T [degC],log G' [Pa],G' [Pa],log G'' [Pa],G'' [Pa]\n"
    dma = em.fit.read_dma(write(header + "0,1,20,6,1e6,5,1e5\n1,10,20,6.3,2e6,5,1e5\n"))
    np.testing.assert_allclose([dma.frequency[1], dma.storage[1]], [20 * np.pi, 2e6])
    with pytest.raises(InputError, match=r"G' \[Pa\] is '2e6', no logarithm of a number"):
        em.fit.read_dma(write("ln f [Hz],T [degC],ln G' [Pa],ln G'' [Pa]\n1,20,2e6,1e5\n2,20,2e6,1e5\n"))
