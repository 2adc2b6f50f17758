"""Creep, relaxation after a ramp, and a storage modulus alone: read, and turned into
relaxation by the spectrum.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from ..io.test_read_instruments import RUBBER, table
from ..refused import mentions, refused, warned

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

CELSIUS = np.arange(-30.0, 41.0, 10.0)
INSTANTS = np.geomspace(1.1, 1000, 16)
T, TIME = (grid.ravel() for grid in np.meshgrid(CELSIUS, INSTANTS, indexing="ij"))


def of(method, *arguments):
    """A response of the rubber at each temperature and instant."""
    return np.concatenate(
        [np.asarray(getattr(RUBBER.at(c + 273.15), method)(INSTANTS)) for c in CELSIUS]
    )


def after_ramp(ramp):
    """The mean of the relaxation modulus over the ramp, by quadrature of its own."""
    x, w = np.polynomial.legendre.leggauss(40)
    found = []
    for c, t in zip(T, TIME, strict=True):
        # substituted s = exp(log)
        log = 0.5 * (np.log(t) + np.log(t - ramp)) + 0.5 * np.log(t / (t - ramp)) * x
        s = np.exp(log)
        modulus = np.asarray(RUBBER.at(c + 273.15).relaxation(s))
        found.append((w * 0.5 * np.log(t / (t - ramp)) * s * modulus).sum() / ramp)
    return np.array(found)


NOISE = 1 + 0.005 * np.random.default_rng(0).normal(size=T.size)
CREEP = of("creep_compliance") * NOISE


def off(fit):
    """Largest relative error of the relaxation modulus over the times of the data, at
    20 degC.
    """
    t = np.geomspace(fit.master.time.min(), fit.master.time.max(), 30)
    return np.abs(
        np.asarray(fit.material.relaxation(t))
        / np.asarray(RUBBER.at(293.15).relaxation(t))
        - 1
    ).max()


@pytest.mark.parametrize(
    ("titles", "columns", "options"),
    [
        (
            "T [degC],t [s],Creep compliance [1/MPa]",
            (CREEP * 1e6,),
            {"kind": "tensile"},
        ),
        ("T [degC],t [s],D(t) [1/Pa]", (CREEP,), {}),
        (
            "T [degC],Time [s],Kriechnachgiebigkeit [1/GPa]",
            (CREEP * 1e9,),
            {"kind": "tensile"},
        ),
        (
            "T [degC],t [s],Strain [%],Stress [MPa]",
            (CREEP * 1e7, 0 * T + 0.1),
            {"kind": "tensile"},
        ),
        (
            "T [degC],t [s],Strain [-]",
            (CREEP * 1e5,),
            {"kind": "tensile", "columns": {"stress": "0.1 MPa"}},
        ),
    ],
)
def test_creep_is_read(titles, columns, options, write):
    dma = em.read_dma(write(table(titles, T, TIME, *columns)), **options)
    assert (dma.response, dma.kind, dma.size) == ("creep", "tensile", T.size)
    np.testing.assert_allclose(dma.relaxation, 1 / CREEP, rtol=1e-8)
    assert "creep compliance, 1.1 to 1e+03 s" in dma.summary()


def test_creep_becomes_a_material(write):
    dma = em.read_dma(
        write(table("T [degC],t [s],Creep compliance [1/MPa]", T, TIME, CREEP * 1e6)),
        kind="tensile",
    )
    fit = em.fit.material(dma, 293.15)
    assert off(fit) < 0.05
    inverse = np.asarray(RUBBER.at(243.15).creep_compliance(2.0)) * np.asarray(
        RUBBER.at(243.15).relaxation(2.0)
    )
    assert inverse < 0.9  # 1/J is no relaxation
    t = np.geomspace(1e-2, 1e4, 9)
    true = np.asarray(RUBBER.at(293.15).creep_compliance(t))
    np.testing.assert_allclose(
        np.asarray(fit.material.creep_compliance(t)), true, rtol=0.05
    )
    assert "as relaxation" in fit.summary()


def test_creep_of_reptate(tmp_path):
    paths = []
    for c in CELSIUS:
        strain = 1000 * CREEP[c == T]
        paths.append(tmp_path / f"rubber{c:g}.creep")
        rows = "\n".join(
            f"{t:.8g}\t{x:.8g}" for t, x in zip(INSTANTS, strain, strict=True)
        )
        paths[-1].write_text(
            f"T={c:g};Mw=1;stress=1000;chem=X;\nt\tstrain\ns\t-\n{rows}\n"
        )
    dma = em.read_dma(paths)
    np.testing.assert_allclose(dma.relaxation, 1 / CREEP, rtol=1e-6)
    assert (dma.response, dma.kind) == ("creep", "shear")


def test_a_ramp_is_convolved(write):
    """Also points right behind it, where a modulus that ignores the ramp is off by a
    fifth.
    """
    ramp = 1.0
    measured = after_ramp(ramp) * (1 + 0.3 * (NOISE - 1))
    assert np.abs(measured / of("relaxation") - 1).max() > 0.2
    path = write(
        table("T [degC],t [s],Relaxation modulus E [MPa]", T, TIME, measured / 1e6)
    )
    fit = em.fit.material(em.read_dma(path, ramp=ramp), 293.15)
    assert off(fit) < 0.03
    with warned(em.fit.FitWarning, 5, "points within"):
        em.read_dma(path, ramp=5.0)
    with refused("ramp", "shorter"):
        em.read_dma(path, ramp=5000.0)
    with refused("ramp", "left out"):
        em.read_dma(
            write(table("T [degC],t [s],D(t) [1/Pa]", T, TIME, CREEP)), ramp=ramp
        )


def test_what_was_held_decides_what_it_is(write):
    stress = of("relaxation") * 0.01
    dma = em.read_dma(
        write(
            table("T [degC],t [s],Stress [Pa],Strain [%]", T, TIME, stress, 0 * T + 1)
        ),
        kind="tensile",
    )
    assert dma.response == "relaxation"
    np.testing.assert_allclose(dma.relaxation, of("relaxation"), rtol=1e-8)
    path = write(
        table("T [degC],t [s],Stress [Pa],Strain [%]", T, TIME, stress, TIME / 100)
    )
    with pytest.raises(em.InputError, match=r"both vary.*--column 'stress=0.1 MPa'"):
        em.read_dma(path, kind="tensile")
    held = em.read_dma(path, kind="tensile", columns={"strain": "1 %"})
    np.testing.assert_allclose(held.relaxation, of("relaxation"), rtol=1e-8)


def test_a_storage_modulus_alone(write):
    """Where it is all there is; where other columns are not understood, it is asked."""
    hertz = np.geomspace(0.1, 50, 8)
    t, f = (grid.ravel() for grid in np.meshgrid(CELSIUS, hertz, indexing="ij"))
    storage = np.concatenate(
        [np.asarray(RUBBER.at(c + 273.15).storage(2 * np.pi * hertz)) for c in CELSIUS]
    )
    with warned(em.fit.FitWarning, "no loss modulus"):
        dma = em.read_dma(write(table("T [degC],f [Hz],E' [Pa]", t, f, storage)))
    fit = em.fit.material(dma, 293.15)
    omega = np.geomspace(*fit.master.window, 30)
    np.testing.assert_allclose(
        fit.material.storage(omega), RUBBER.at(293.15).storage(omega), rtol=0.06
    )
    assert any("not measured" in text for _, text in fit.findings())
    path = write(table("T [degC],f [Hz],E' [Pa],damp", t, f, storage, f))
    with pytest.raises(em.InputError, match=r"storage_only=True \(--storage-only\)"):
        em.read_dma(path)
    with pytest.warns(em.fit.FitWarning, match="no loss modulus"):
        np.testing.assert_array_equal(
            em.read_dma(path, storage_only=True).relaxation, dma.relaxation
        )


def test_different_responses_are_not_joined(write):
    one = em.read_dma(write(table("T [degC],t [s],D(t) [1/Pa]", T, TIME, CREEP)))
    two = em.fit.relaxation(TIME, of("relaxation"), T + 273.15, kind="tensile")
    with refused("parts", "response over time"):
        em.fit.join(one, two)


def test_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "ramp.csv").write_text(
        table("T [degC],t [s],E(t) [MPa]", T, TIME, after_ramp(1.0) / 1e6)
    )
    assert main(["fit", "ramp.csv", "--ramp", "1s", "--reference", "20degC"]) == 0
    assert mentions(capsys.readouterr().out, 1, "relaxation after")
    assert main(["fit", "ramp.csv", "--ramp", "fast"]) == 2
    assert mentions(capsys.readouterr().err, "--ramp", '"10 s"', '"fast"')
