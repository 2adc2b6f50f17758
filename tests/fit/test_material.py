"""From a file to a material that em.friction reads: round trips in every format, cards,
files.
"""

import html
import re
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest

import elastomdr as em
from elastomdr.errors import InputError
from elastomdr.fit import (
    abaqus_card,
    ansys_card,
    comsol_card,
    dyna_card,
    plain_card,
    radioss_card,
)
from elastomdr.fit.figures import draw_shifts

from ..io.dma_files import CELSIUS, HERTZ, KNOWN, WRITERS, measure, plain_csv, two_rows
from ..material.check import check_material

# What is doubted is asserted where a test is about it.
pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")

ROWS = measure(KNOWN)
BALL = em.Paraboloid(5e-3)
# v a_T/(2a) to 2 v a_T/a, 0.03 to 3e4 rad/s at 0 to 40 degC: within the window
VELOCITY = np.geomspace(5e-4, 0.5, 8)
# The bare line compiles faster than the average of directions, and depends on the
# material in the same way.
SCENE = {
    "load": 1.0,
    "temperature": np.array([[273.15], [293.15], [313.15]]),
    "model": em.Line(),
    "rtol": 1e-4,
}


@pytest.fixture(scope="module")
def truth():
    return em.friction(KNOWN, BALL, velocity=VELOCITY, **SCENE)


@pytest.mark.parametrize("writer", WRITERS, ids=lambda writer: writer.__name__)
def test_round_trip_to_friction(writer, tmp_path, truth):
    """Material, measurements with 0.3 % noise, file, fit, material file, friction:
    within 2 % of where it began.
    """
    fit = em.fit.material(em.read_dma(writer(tmp_path, ROWS)), 293.15, name="again")
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    material = em.load_material(tmp_path / "again.toml")
    again = em.friction(material, BALL, velocity=VELOCITY, **SCENE)
    assert again.converged.all()
    np.testing.assert_allclose(again.mu, truth.mu, rtol=0.02)


def friction_at_reference(fit, tmp_path, velocity, **scene):
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    material = em.load_material(tmp_path / "again.toml")
    return em.friction(
        material, BALL, velocity=velocity, **(SCENE | {"temperature": None} | scene)
    ).mu


def test_round_trip_of_a_master_curve(tmp_path, truth):
    """RepTate's .tts holds one curve at one temperature: no shift law comes back, and
    no temperature is given.
    """
    omega, rng = np.geomspace(3e-3, 3e5, 90), np.random.default_rng(0)
    moduli = np.asarray(KNOWN.at(293.15).complex_modulus(omega))
    rows = np.column_stack([omega, moduli.real, moduli.imag]) * (
        1 + 0.003 * rng.normal(size=(90, 3)) * [0, 1, 1]
    )
    np.savetxt(tmp_path / "known.tts", rows, header="T=20;chem=rubber;", comments="")
    fit = em.fit.material(em.read_dma(tmp_path / "known.tts"))
    again = friction_at_reference(fit, tmp_path, VELOCITY)
    np.testing.assert_allclose(again, truth.mu[1], rtol=0.02)


TIMES = np.geomspace(1e-9, 1.0, 10)
STEEP = em.Prony(6e5, np.geomspace(6e8, 1e5, 10), TIMES, shift=KNOWN.shift)
PEAKED = em.Prony(
    6e5,
    np.geomspace(6e7, 2e5, 10) * (1 + 8 * np.exp(-((np.log10(TIMES) + 5) ** 2))),
    TIMES,
    shift=KNOWN.shift,
)


@pytest.mark.parametrize(
    ("rubber", "least"),
    [(KNOWN, 12), (STEEP, 8), (PEAKED, 8)],
    ids=["known", "steep", "peaked"],
)
def test_round_trip_of_relaxation(rubber, least, tmp_path):
    velocity = np.geomspace(5e-5, 0.5, 16)
    truth = em.friction(rubber, BALL, velocity=velocity, **SCENE)
    t, rng = np.geomspace(0.01, 1e3, 24), np.random.default_rng(1)
    lines = ["t,G_relax,T", "s,MPa,°C"]
    for celsius in CELSIUS:
        moduli = np.asarray(rubber.at(celsius + 273.15).relaxation(t)) * (
            1 + 0.003 * rng.normal(size=t.size)
        )
        lines += [
            f"{a!r},{b / 1e6!r},{celsius}"
            for a, b in zip(t.tolist(), moduli.tolist(), strict=True)
        ]
    (tmp_path / "relaxation.csv").write_text("\n".join(lines), encoding="cp949")
    fit = em.fit.material(em.read_dma(tmp_path / "relaxation.csv"), 293.15)
    assert 0.002 < fit.misfit["relaxation modulus"] < 0.006
    assert "relaxation modulus 0." in fit.summary()
    assert "series has it to" in fit.info()["source"]["moduli"]["note"]
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    with pytest.warns(em.ExtrapolationWarning):
        again = em.friction(
            em.load_material(tmp_path / "again.toml"), BALL, velocity=velocity, **SCENE
        )
    inside = ~np.asarray(again.extrapolated)
    # relaxation does not determine the loss modulus up to its first instant
    assert least <= inside.sum() < 48
    np.testing.assert_allclose(again.mu[inside], truth.mu[inside], rtol=0.02)


def test_the_range_of_relaxation_is_where_it_determines_the_loss_modulus():
    """Noisier data determine less of it, and what is said to be known to 3 % (95 %) is
    so.
    """
    t, kelvin, ends = np.geomspace(0.01, 1e3, 24), CELSIUS + 273.15, []
    for noise in (0.002, 0.01):
        rng, parts = np.random.default_rng(3), []
        for T in kelvin:
            moduli = np.asarray(KNOWN.at(T).relaxation(t)) * (
                1 + noise * rng.normal(size=t.size)
            )
            parts.append(em.fit.relaxation(t, moduli, T, kind="shear"))
        fit = em.fit.prony(em.fit.master_curve(em.fit.join(*parts), 293.15))
        ends.append(fit.material.range.omega)
        omega = np.geomspace(*ends[-1], 20)
        truth = np.asarray(KNOWN.at(293.15).complex_modulus(omega)).imag
        assert np.sqrt(np.mean((fit.moduli_at(omega)[1] / truth - 1) ** 2)) < 0.03
        assert 0.0005 < ends[-1][1] * fit.time.min() <= 0.1
    assert ends[1][1] < ends[0][1]


@pytest.mark.parametrize("noise", [1e-4, 0.003])
@pytest.mark.parametrize("rubber", [STEEP, PEAKED], ids=["steep", "peaked"])
def test_what_relaxed_before_the_first_instant_is_a_part_of_the_loss(rubber, noise):
    """Within the range the loss modulus is within its interval, of steep spectra and of
    peaks that are not seen too.
    """
    t, rng, parts = np.geomspace(0.01, 1e3, 24), np.random.default_rng(0), []
    for T in CELSIUS + 273.15:
        moduli = np.asarray(rubber.at(T).relaxation(t)) * (
            1 + noise * rng.normal(size=t.size)
        )
        parts.append(em.fit.relaxation(t, moduli, T, kind="shear"))
    fit = em.fit.prony(em.fit.master_curve(em.fit.join(*parts), 293.15))
    low, high = fit.material.range.omega
    omega = np.geomspace(10 * low, high, 20)
    band, truth = (
        fit.band(omega),
        np.asarray(rubber.at(293.15).complex_modulus(omega)).imag,
    )
    assert ((band.loss_low <= truth) & (truth <= band.loss_high)).mean() >= 0.95
    assert np.abs(band.loss / truth - 1).max() < 0.04
    half = float(
        re.search(
            r"loss modulus +not measured; the series has it to \+- ([\d.]+) %",
            repr(fit),
        )[1]
    )
    # told to two digits
    assert 100 * np.log(band.loss_high / band.loss).max() < half + 0.06 < 12


def test_material_file_is_complete(tmp_path):
    fit = em.fit.material(
        em.read_dma(two_rows(tmp_path, ROWS)),
        293.15,
        name="my-rubber",
        citation="Here, today",
    )
    files = fit.files()
    assert sorted(files) == sorted(
        [
            f"my-rubber{end}"
            for end in (
                ".toml",
                "-master.csv",
                "-shifts.csv",
                "-prony.csv",
                "-plain.csv",
                "-abaqus.inp",
                "-ansys.mac",
                "-radioss.rad",
                "-comsol.m",
                "-dyna.k",
                "-report.html",
                "-master.png",
                "-shifts.png",
                "-cole-cole.png",
                "-van-gurp-palmen.png",
            )
        ]
    )
    assert all(
        files[name].startswith(b"\x89PNG") for name in files if name.endswith(".png")
    )
    page = html.unescape(files["my-rubber-report.html"].decode())
    assert page.count("<img") == sum(name.endswith(".png") for name in files)
    for said in (*(text for _, text in fit.findings()), *fit.warnings, "Here, today"):
        assert said in page
    (tmp_path / "my-rubber.toml").write_bytes(files["my-rubber.toml"])
    assert check_material(tmp_path / "my-rubber.toml") == []
    text = files["my-rubber.toml"].decode()
    for said in (
        "Here, today",
        "fitted here",
        "storage_residual",
        "loss_residual",
        "isotherms shifted jointly",
    ):
        assert said in text
    paths = fit.save(tmp_path)
    assert sorted(path.name for path in paths) == sorted(files)
    table = pd.read_csv(tmp_path / "my-rubber-shifts.csv", comment="#")
    np.testing.assert_allclose(table["log10 a_T [-]"], fit.master.log10_a, rtol=1e-15)
    assert fit.misfit["loss modulus"] < 0.02
    assert "WLF in the material" in repr(fit)


@pytest.mark.parametrize("law", ["WLF", "VFT", "Arrhenius", "table", "none"])
def test_every_shift_law_can_be_chosen(law, tmp_path):
    fit = em.fit.material(
        em.read_dma(plain_csv(tmp_path, ROWS)), 293.15, law=law, name="m"
    )
    em.save_material(fit.material, tmp_path / "m.toml", info=fit.info())
    loaded = em.load_material(tmp_path / "m.toml")
    assert type(loaded.shift).__name__ == {
        "table": "ShiftTable",
        "none": "NoneType",
    }.get(law, law)
    if law in ("WLF", "VFT", "table"):
        truth = np.asarray(KNOWN.shift.log10_a(CELSIUS[1:-1] + 273.15))
        np.testing.assert_allclose(
            loaded.shift.log10_a(CELSIUS[1:-1] + 273.15), truth, atol=0.05
        )


def test_shift_factors_that_are_no_wlf_become_a_table(tmp_path):
    jump = np.where(CELSIUS > 25, -1.5, 0.0) + np.asarray(
        KNOWN.shift.log10_a(CELSIUS + 273.15)
    )
    omega = 2 * np.pi * HERTZ
    moduli = [np.asarray(KNOWN.at(293.15).complex_modulus(omega * 10**x)) for x in jump]
    kelvin = CELSIUS + 273.1512775  # as instruments log it
    parts = [
        em.fit.dma(omega, m.real, m.imag, t, kind="shear")
        for m, t in zip(moduli, kelvin, strict=True)
    ]
    fit = em.fit.material(em.fit.join(*parts), 293.15)
    assert fit.law == "table"
    np.testing.assert_allclose(fit.material.shift.log10_a(293.15), 0.0, atol=1e-12)
    np.testing.assert_allclose(fit.master.log10_a, jump, atol=0.15)
    em.save_material(fit.material, tmp_path / "m.toml", info=fit.info())
    # it and the table agree
    assert not any("range" in text for text in check_material(tmp_path / "m.toml"))


def test_entropy_elasticity_is_found_and_is_in_the_material(tmp_path):
    """Friction at -40 to 60 degC is that of the rubber within 3 %; without the vertical
    shifts it is not.
    """
    celsius, law = np.arange(-40.0, 61.0, 10.0), em.EntropicVertical(293.15)
    rubber = em.Prony(
        KNOWN.equilibrium, KNOWN.moduli, KNOWN.times, shift=KNOWN.shift, vertical=law
    )
    rows = measure(rubber, celsius, noise=0.005)
    dma = em.fit.dma(
        2 * np.pi * rows[:, 0], *rows[:, 2:].T, rows[:, 1] + 273.15, kind="shear"
    )
    fit, plain = (
        em.fit.material(dma, 293.15, vertical=vertical, name="again")
        for vertical in (None, False)
    )
    assert repr(fit.material.vertical) == repr(law)
    assert "entropy elasticity" in fit.summary()
    em.save_material(fit.material, tmp_path / "again.toml", info=fit.info())
    assert check_material(tmp_path / "again.toml") == []
    again = em.load_material(tmp_path / "again.toml")
    scene = SCENE | {
        "temperature": celsius[:, None] + 273.15,
        "velocity": np.geomspace(2e-3, 0.05, 6),
    }
    truth, mu, without = (
        em.friction(one, BALL, **scene).mu for one in (rubber, again, plain.material)
    )
    np.testing.assert_allclose(mu, truth, rtol=0.03)
    assert np.abs(without / truth - 1).max() > 0.08
    assert max(fit.misfit.values()) < 0.01 < max(plain.misfit.values())


def test_a_vertical_law_that_is_given_is_taken_off_before_shifting():
    """Of moduli that change fivefold with temperature, shift factors would be decades
    off.
    """
    celsius = np.arange(-20.0, 61.0, 20.0)
    law = em.VerticalTable(celsius + 273.15, [0.4, 0.6, 1.0, 1.5, 2.0])
    rubber = em.Prony(
        KNOWN.equilibrium, KNOWN.moduli, KNOWN.times, shift=KNOWN.shift, vertical=law
    )
    rows = measure(rubber, celsius, noise=0.002)
    dma = em.fit.dma(
        2 * np.pi * rows[:, 0], *rows[:, 2:].T, rows[:, 1] + 273.15, kind="shear"
    )
    fit = em.fit.material(dma, 293.15, vertical=law)
    expected = KNOWN.shift.log10_a(celsius + 273.15)
    np.testing.assert_allclose(fit.master.log10_a, expected, atol=0.05)
    assert repr(fit.material.vertical) == repr(law)
    assert max(fit.misfit.values()) < 0.01


def test_none_is_found_where_there_is_none():
    assert (
        em.fit.material(
            em.fit.dma(
                2 * np.pi * ROWS[:, 0],
                *ROWS[:, 2:].T,
                ROWS[:, 1] + 273.15,
                kind="shear",
            ),
            293.15,
        ).material.vertical
        is None
    )


def ragged(noise, size=0.1):
    """Vertical shifts of 10 % without order, and a flat rubber to hide them in."""
    up = (1 + size * np.sin(ROWS[:, 1])) * (
        1 + noise * np.random.default_rng(0).normal(size=(2, len(ROWS)))
    )
    return em.fit.dma(
        2 * np.pi * ROWS[:, 0],
        up[0] * ROWS[:, 2],
        up[1] * ROWS[:, 3],
        ROWS[:, 1] + 273.15,
        kind="shear",
    )


def test_other_vertical_shifts_become_a_table_in_the_material():
    """The material meets the data as measured, where one without vertical shifts is 20
    % off, with wrong factors.
    """
    chosen, plain = (
        em.fit.material(ragged(0.0), 293.15, vertical=vertical)
        for vertical in (None, False)
    )
    kelvin = chosen.master.temperature
    truth = np.asarray(KNOWN.shift.log10_a(kelvin))
    assert np.abs(plain.master.log10_a - truth).max() > 0.1
    for log10_a in (chosen.master.log10_a, chosen.material.shift.log10_a(kelvin)):
        np.testing.assert_allclose(log10_a, truth, atol=0.02)
    up = 1 + 0.1 * np.sin(kelvin - 273.15)
    np.testing.assert_allclose(
        chosen.material.vertical.b(kelvin), up / (1 + 0.1 * np.sin(20.0)), rtol=0.02
    )
    assert max(chosen.misfit.values()) < 0.01 < 0.05 < max(plain.misfit.values())
    # as entropy elasticity beyond the data
    assert float(chosen.material.vertical.b(kelvin[-1] + 50)) > 0
    panels = [len(draw_shifts(fit.master).figure.axes) for fit in (chosen, plain)]
    assert panels == [2, 1]  # none for vertical shifts that were not looked for
    said = chosen.info()["source"]
    assert said["moduli"]["loss_residual"] == pytest.approx(
        chosen.misfit["loss modulus"], rel=0.05
    )
    assert "Table in the material" in said["vertical"]["note"]
    assert chosen.tabulated().vertical is chosen.material.vertical
    assert "moduli only" in abaqus_card(chosen.material)
    assert em.fit.material(ragged(0.0), 293.15, law="none").misfit == {}


def test_where_the_data_leave_it_open_there_are_none():
    fit = em.fit.material(ragged(0.15, 0.02), 293.15)
    assert fit.material.vertical is None
    assert np.abs(fit.master.log10_b).max() < 1e-4
    assert (
        em.fit.material(ragged(0.15, 0.02), 293.15, vertical=True).material.vertical
        is not None
    )


def test_cards_hold_the_same_material():
    abaqus = abaqus_card(KNOWN)
    rows = re.search(r"\*VISCOELASTIC, TIME=PRONY\n((?:[\d.e+-]+, .*\n)+)", abaqus)[
        1
    ].splitlines()
    g, k, tau = np.array([[float(x) for x in row.split(",")] for row in rows]).T
    half = float(re.search(r"NEO HOOKE, MODULI=INSTANTANEOUS\n([\d.e+-]+)", abaqus)[1])
    np.testing.assert_allclose(2 * half * g, KNOWN.moduli, rtol=1e-7)
    # from 12 digits of nearly 1
    np.testing.assert_allclose(2 * half * (1 - g.sum()), 6e5, rtol=1e-6)
    np.testing.assert_allclose(tau, KNOWN.times, rtol=1e-7)
    assert (k == 0).all()
    assert "*TRS, DEFINITION=WLF\n293.15, 5.8, 125" in abaqus
    tensile = em.Prony(1e6, [3e6], [0.1], kind="tensile", poisson=0.3)
    assert "*ELASTIC, MODULI=INSTANTANEOUS\n4000000, 0.3" in abaqus_card(tensile)
    assert "0.75, 0.75, 0.1" in abaqus_card(tensile)
    ansys = ansys_card(tensile)
    assert "MP,EX,1,4000000" in ansys
    assert ansys.count("TB,PRONY,1,1,1,") == 2
    assert "TBDATA,1,0.75,0.1" in ansys
    assert "TBDATA,1,293.15,5.8,125" in ansys_card(KNOWN)
    plain = [
        line for line in plain_card(KNOWN).splitlines() if not line.startswith("#")
    ]
    assert len(plain) == 11
    assert "a liquid" in abaqus_card(em.Maxwell(1e5, 1.0))
    table = em.Prony(
        1e6,
        [1e6],
        [1.0],
        shift=em.ShiftTable([290.0, 300.0], [1.0, -1.0]),
        name="468 mp-tape",
    )
    assert "*MATERIAL, NAME=M_468_MP_TAPE\n" in abaqus_card(table)
    for card in (abaqus_card(table), ansys_card(table)):
        assert "only at this temperature" in card.splitlines()[0]
    arrhenius = em.Prony(1e6, [1e6], [1.0], shift=em.Arrhenius(8e4, 300.0))
    assert "*TRS, DEFINITION=ARRHENIUS\n300, 80000\n" in abaqus_card(arrhenius)
    with pytest.raises(InputError, match="viscosity must be 0"):
        abaqus_card(em.KelvinVoigt(1e6, 1e3))


def of_dyna(card):
    """Shear moduli, rates and bulk modulus, by columns of ten."""
    title, _, head, blank, *rows = [
        line for line in card.splitlines() if not line.startswith("$")
    ]
    assert (title, blank) == ("*MAT_GENERAL_VISCOELASTIC_TITLE", "")
    assert (int(head[:10]), head[10:20].strip()) == (3, "")  # density is not known
    table = np.array([[float(row[i : i + 10]) for i in (0, 10)] for row in rows])
    return table[:, 0], table[:, 1], float(head[20:30])


def of_radioss(card):
    """The same of a deck in columns of twenty, of which integers take ten."""
    lines = [line for line in card.splitlines() if not line.startswith("#")]
    law, _, density, head, mu, blank, alpha, empty, visc, order, *rows = lines
    assert (law, visc) == ("/MAT/LAW42/3", "/VISC/PRONY/3")
    assert (density.strip(), blank, empty) == ("", "", "")
    assert int(head[80:90]) == 0  # its terms stand in the second block
    assert int(order[:10]) == len(rows)
    table = np.array(
        [[float(row[i : i + 20]) for i in (0, 20, 40, 60)] for row in rows]
    )
    assert (table[:, 2:] == 0).all()
    ground = float(mu[:20]) * float(alpha[:20]) / 2
    moduli, nu = np.array([ground, *table[:, 0]]), float(head[:20])
    bulk = 2 * moduli.sum() * (1 + nu) / (3 * (1 - 2 * nu))
    return moduli, np.array([0.0, *table[:, 1]]), bulk


@pytest.mark.parametrize(
    ("write", "read", "accuracy"),
    [(dyna_card, of_dyna, 1e-4), (radioss_card, of_radioss, 1e-8)],
)
@pytest.mark.parametrize(
    "material",
    [KNOWN, em.Prony(1e6, [3e6, 2e9], [0.1, 1e-9], kind="tensile", poisson=0.3)],
    ids=["shear", "tensile"],
)
def test_cards_of_explicit_programs_relax_as_the_material(
    write, read, accuracy, material
):
    card = write(material, 3)
    moduli, rates, bulk = read(card)
    t = np.geomspace(1e-10, 1e3, 40)
    relaxed = (moduli * np.exp(-rates * t[:, None])).sum(axis=1)
    shear = material.shear()
    np.testing.assert_allclose(relaxed, shear.relaxation(t), rtol=accuracy)
    nu = min(material.poisson, 0.4995)
    expected = 2 * shear.instantaneous * (1 + nu) / (3 * (1 - 2 * nu))
    assert bulk == pytest.approx(expected, rel=accuracy)
    assert ("only at this temperature" in card) == (material.shift is not None)
    assert "density" in card


@pytest.mark.parametrize(
    "law", [None, em.WLF(8.9, 101.6, 293.15), em.Arrhenius(8e4, 293.15)], ids=str
)
def test_a_card_of_comsol_relaxes_as_the_material(law):
    """Read back with its own shift, at another temperature than its reference."""
    material = em.Prony(1e6, [3e6, 2e9], [0.1, 1e-9], shift=law, poisson=0.49)
    card = comsol_card(material)
    kelvin, r_const = 313.15, 8.314462618

    def number(text):
        text = re.sub(r"\[[^\]]*\]", "", text).replace("^", "**")
        names = {"T_rubber": kelvin, "R_const": r_const, "exp": np.exp}
        return eval(text, names | {"a_T": factor})

    factor = 1.0
    set_to = dict(re.findall(r"\.set\('(\w+)', '([^']*)'\);", card))
    factor = number(set_to.get("a_T", "1"))
    columns = {
        name: [number(one) for one in re.findall(r"'([^']*)'", values)]
        for name, values in re.findall(r"\.set\('(\w+)', \{([^}]*)\}\);", card)
    }
    t = np.geomspace(1e-10, 1e3, 40)
    relaxed = number(set_to["G"]) + sum(
        g * np.exp(-t / tau)
        for g, tau in zip(columns["Gvm"], columns["tauvm"], strict=True)
    )
    there = material if law is None else material.at(kelvin)
    np.testing.assert_allclose(relaxed, there.relaxation(t), rtol=1e-6)
    bulk = 2 * material.instantaneous * 1.49 / (3 * 0.02)
    assert number(set_to["K"]) == pytest.approx(bulk, rel=1e-6)
    assert "Viscoelasticity" not in comsol_card(em.Prony(1e6, [], []))


def test_cards_of_an_elastic_rubber_and_of_a_liquid():
    elastic = em.Prony(1e6, [], [])
    assert "/VISC" not in radioss_card(elastic)
    assert of_dyna(dyna_card(elastic, 3))[0].tolist() == [1e6]
    moduli, rates, _ = of_radioss(radioss_card(em.Maxwell(1e5, 1.0), 3))
    assert moduli[0] == pytest.approx(0.1, rel=1e-3)  # of which the notes say so
    assert "a liquid" in radioss_card(em.Maxwell(1e5, 1.0))
    assert rates.tolist() == [0.0, 1.0]


def test_more_terms_than_a_card_takes():
    many = em.Prony(1e5, np.full(18, 1e5), np.geomspace(1e-9, 1, 18))
    with pytest.raises(InputError, match="17 relaxation times"):
        dyna_card(many)
    for terms, said in ((5, False), (6, True)):  # and the equilibrium
        fewer = em.Prony(1e5, np.full(terms, 1e5), np.geomspace(1e-9, 1, terms))
        remarks = [x for x in dyna_card(fewer).splitlines() if x.startswith("$")]
        assert any(" six" in x for x in remarks) == said
    assert len(of_radioss(radioss_card(many, 3))[0]) == 19


@pytest.mark.parametrize("dynamic", [True, False])
def test_moduli_that_never_change_are_drawn_without_warnings(dynamic):
    """A damaged file may hold one value throughout: limits of a logarithmic axis must
    not come from it alone.
    """
    rate = np.geomspace(1.0, 100.0, 8)
    if dynamic:
        dma = em.fit.dma(rate, np.full(8, 1e6), np.full(8, 1e5), 293.15, kind="shear")
    else:
        dma = em.fit.relaxation(rate, np.full(8, 1e6), 293.15, kind="shear")
    fit = em.fit.material(dma)
    images = [
        content for name, content in fit.files("flat").items() if name.endswith(".png")
    ]
    assert len(images) == (3 if dynamic else 1)
    assert all(content.startswith(b"\x89PNG") for content in images)
    storage, loss = fit.prony.moduli_at(rate)
    ax = fit.prony.plot()
    assert ax.get_xscale() == ax.get_yscale() == "log"
    assert (
        ax.get_ylim()[0] < (storage if not dynamic else np.minimum(storage, loss)).min()
    )


def test_names_of_functions_are_not_shadowed_by_modules():
    """Whatever of `em.fit` is used first, its functions stay functions."""
    code = (
        "import elastomdr as em; em.fit.MaterialFit; em.fit.PronyFit; em.fit.Dma; "
        "em.fit.Calibration;"
    )
    code += "assert all(callable(getattr(em.fit, name)) for name in em.fit.__all__)"
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)


def test_import_of_the_package_stays_light():
    code = (
        "import sys, elastomdr as em; em.fit; assert not {'jax', 'scipy', "
        "'numpy', 'matplotlib'} & sys.modules.keys()"
    )
    subprocess.run([sys.executable, "-W", "error", "-c", code], check=True)
