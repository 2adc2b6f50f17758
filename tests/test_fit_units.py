"""Titles and units of DMA files: understood in many ways, asked for where nobody says them, never guessed."""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import FitWarning


@pytest.mark.parametrize(
    ("header", "said"),
    [
        ("f,T [K],G' [Pa],G'' [Pa]", "frequency_unit='Hz' (--frequency-unit Hz)"),
        ("w,T [K],G' [Pa],G'' [Pa]", "frequency_unit='rad/s' (--frequency-unit rad/s)"),
        ("omega [MHz],T [K],G' [Pa],G'' [Pa]", "frequency_unit='rad/s'"),
        ("f [Hz],T [K],G',G''", "modulus_unit='MPa'"),
        ("f [Hz],T,G' [Pa],G'' [Pa]", "temperature_unit='degC'"),
        ("f [Hz],T [K],storage modulus [Pa],loss modulus [Pa]", "kind='shear' or 'tensile'"),
        ("f [Hz],T [K],E' [Pa],G'' [Pa]", "of shear and of tension"),
        ("a,b,c,d", "Name the columns"),
    ],
)
def test_what_nobody_says_is_asked_for(write, header, said):
    path = write(header + "\n" + "\n".join(f"{f},293.15,2e6,1e5" for f in (1, 2, 4)))
    with pytest.raises(InputError) as error:
        em.fit.read_dma(path)
    assert said in str(error.value)
    assert str(error.value).startswith("dma.csv: ")


def test_the_user_fills_in_but_does_not_overrule(write):
    path = write("f,T,storage,loss\n" + "\n".join(f"{f},20,2,0.1" for f in (1, 2, 4)))
    dma = em.fit.read_dma(path, frequency_unit="Hz", temperature_unit="degC", modulus_unit="MPa", kind="tensile")
    np.testing.assert_allclose(dma.frequency, 2 * np.pi * np.array([1, 2, 4]))
    np.testing.assert_allclose([dma.temperature[0], dma.storage[0], dma.loss[0]], [293.15, 2e6, 1e5])
    assert dma.kind == "tensile"
    path = write("f [rad/s],T [degC],E' [kPa],E'' [kPa]\n" + "\n".join(f"{f},20,2000,100" for f in (1, 2, 4)))
    dma = em.fit.read_dma(path, frequency_unit="Hz", modulus_unit="MPa")
    np.testing.assert_allclose([dma.frequency[0], dma.storage[0]], [1, 2e6])
    with pytest.raises(InputError, match="as the file's columns say"):
        em.fit.read_dma(path, kind="shear")
    with pytest.raises(InputError, match="frequency_unit must be one of Hz"):
        em.fit.read_dma(path, frequency_unit="furlong")


def test_columns_by_title_or_number(write):
    path = write("speed,stiff,damp,warm\nHz,MPa,MPa,C\n" + "\n".join(f"{f},2,0.1,20" for f in (1, 2, 4)))
    columns = {"frequency": "speed", "storage": 2, "loss": "damp", "temperature": 4}
    dma = em.fit.read_dma(path, columns=columns, kind="shear")
    np.testing.assert_allclose([dma.frequency[0], dma.storage[0], dma.temperature[0]], [2 * np.pi, 2e6, 293.15])
    with pytest.raises(InputError, match="column 1 'speed', named for time, is in Hz, which is none of s, ms, min, h"):
        em.fit.read_dma(path, columns={"time": 1, "relaxation": 2}, kind="shear")
    with pytest.raises(InputError, match="Did you mean 'storage'"):
        em.fit.read_dma(path, columns={"storge": 2})


@pytest.mark.parametrize(
    ("header", "kind"),
    [
        ("Frequency (Hz),Temperature (°C),Storage modulus G' (MPa),Loss modulus G'' (MPa)", "shear"),
        ("Frequency f [Hz],Temperature T [°C],Storage Modulus (E') (MPa),Loss Modulus (E'') (MPa)", "tensile"),
        ("Frequency - Hz,Temperature - °C,E' - MPa,E'' - MPa", "tensile"),
        ("Frequenz [Hz],Temperatur [°C],Speichermodul E' [MPa],Verlustmodul E'' [MPa]", "tensile"),
        ("주파수 (Hz),온도 (℃),저장 탄성률 G' (MPa),손실 탄성률 G'' (MPa)", "shear"),
        ('"f [Hz]","T [°C]","G\' [MPa]","G"" [MPa]"', "shear"),
        ("f,T,G',G''\n\nHz,°C,MPa,MPa\n", "shear"),
        ("f [Hz],T [°C],E storage modulus [MPa],E loss modulus [MPa]", "tensile"),
    ],
)
def test_titles_in_many_ways(write, header, kind):
    dma = em.fit.read_dma(write(header + "\n" + "\n".join(f"{f},20,2,0.1" for f in (1, 2, 4))))
    np.testing.assert_allclose([dma.frequency[0], dma.temperature[0], dma.storage[0]], [2 * np.pi, 293.15, 2e6])
    assert dma.kind == kind


def test_units_that_are_not_known_are_not_overruled(write):
    rows = "\n".join(f"{f},20,2,0.1" for f in (1, 2, 4))
    for header in ("f [Hz],T [K],G' [furlong],G'' [furlong]\n", "f,T,G',G''\nHz,K,furlong,furlong\n"):
        with pytest.raises(InputError, match="'furlong', which is none of Pa"):
            em.fit.read_dma(write(header + rows), modulus_unit="MPa")
    for unit, option in (("1/s", "frequency_unit"), ("MHz", "frequency_unit")):
        path = write(f"f [{unit}],T [degC],G' [MPa],G'' [MPa]\n" + rows)
        with pytest.raises(InputError, match=f"may be several .*{option}="):
            em.fit.read_dma(path)
        np.testing.assert_allclose(em.fit.read_dma(path, frequency_unit="Hz").frequency[0], 2 * np.pi)
    path = write("a [Hz],b [°C],stiff [kPa],damp [kPa]\n" + rows)
    columns = {"frequency": 1, "temperature": 2, "storage": 3, "loss": 4}
    with pytest.warns(em.fit.FitWarning, match="low for a solid polymer, unless it is a gel"):
        assert em.fit.read_dma(path, columns=columns, kind="shear", modulus_unit="MPa").storage[0] == 2e3


def test_moduli_of_both_kinds_in_one_file(write):
    path = write("f [Hz],T [degC],E' [MPa],G'' [MPa],G' [MPa],E'' [MPa]\n" + 3 * "1,20,6,0.2,2,0.6\n")
    with pytest.raises(InputError, match="of shear and of tension"):
        em.fit.read_dma(path)
    for kind, storage, loss in (("shear", 2e6, 2e5), ("tensile", 6e6, 6e5)):
        dma = em.fit.read_dma(path, kind=kind)
        np.testing.assert_allclose([dma.storage[0], dma.loss[0]], [storage, loss])
    with pytest.raises(InputError, match="only one of both"):
        em.fit.read_dma(write("f [Hz],T [degC],E' [MPa],G'' [MPa]\n" + 3 * "1,20,6,0.2\n"), kind="shear")


def test_the_unit_of_an_angular_frequency(write):
    """No unit is none, whatever the title; 1/s of an angular frequency can only be rad/s, and 1/s of another not."""
    rows = "\n".join(f"{w},20,2,0.1" for w in (1, 2, 4))
    path = write("omega,T [degC],G' [MPa],G'' [MPa]\n" + rows)
    assert em.fit.read_dma(path, frequency_unit="rad/s").frequency[0] == 1
    with pytest.warns(FitWarning, match="Hz and rad/s mixed up"):
        assert em.fit.read_dma(path, frequency_unit="Hz").frequency[0] == pytest.approx(2 * np.pi)
    assert em.fit.read_dma(write("omega [1/s],T [degC],G' [MPa],G'' [MPa]\n" + rows)).frequency[0] == 1
    with pytest.raises(InputError, match="'furlong', which is none of Hz"):
        em.fit.read_dma(write("omega [furlong],T [degC],G' [MPa],G'' [MPa]\n" + rows))


def test_a_column_that_is_named_keeps_what_its_title_says(write):
    path = write("f [Hz],T [degC],E' [MPa],E'' [MPa]\n" + "\n".join(f"{f},20,0.1,2" for f in (1, 2, 4)))
    dma = em.fit.read_dma(path, columns={"storage": 4, "loss": 3})
    np.testing.assert_allclose([dma.storage[0], dma.loss[0]], [2e6, 1e5])
    assert dma.kind == "tensile"
