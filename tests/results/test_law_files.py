"""Friction laws and slip curves as other programs read them: each file read by a parser
of its own, against the law.
"""

import re
import shutil
import subprocess

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused

V, T, P = (
    np.geomspace(1e-3, 30, 6),
    np.array([263.15, 283.15, 313.15]),
    np.array([1e5, 2.5e5, 4e5]),
)
MU = np.random.default_rng(3).uniform(0.4, 1.2, (3, 3, 6))
LAW = em.FrictionLaw(V, MU, temperature=T, pressure=P)
RNG = np.random.default_rng(4)
PLACES = (
    np.exp(RNG.uniform(np.log(1e-3), np.log(30), 40)),
    RNG.uniform(T[0], T[-1], 40),
    RNG.uniform(1e5, 4e5, 40),
)


def rows_of_friction(path):
    lines = path.read_text().splitlines()
    start = lines.index("*FRICTION")
    assert all(line.startswith("**") for line in lines[:start])
    return np.array(
        [[float(x) for x in line.split(",")] for line in lines[start + 1 :]]
    )


@pytest.mark.parametrize(("units", "of_v", "of_p"), [("m", 1, 1), ("mm", 1e3, 1e-6)])
def test_abaqus_table(tmp_path, units, of_v, of_p):
    """Rows interpolated linearly, as Abaqus does, are the law; the slip rate is
    fastest, then the pressure.
    """
    from scipy.interpolate import RegularGridInterpolator

    LAW.to_abaqus(tmp_path / "law.inp", units=units)
    rows = rows_of_friction(tmp_path / "law.inp")
    kelvin, pressure, rate = (np.unique(rows[:, i]) for i in (3, 2, 1))
    shape = (kelvin.size, pressure.size, rate.size)
    assert np.prod(shape) == len(rows)
    assert np.array_equal(rows[:, 1].reshape(shape), np.broadcast_to(rate, shape))
    table = RegularGridInterpolator((kelvin, pressure, rate), rows[:, 0].reshape(shape))
    v, t, p = PLACES
    found = table(np.stack([t, p * of_p, np.clip(v * of_v, rate[0], rate[-1])], axis=1))
    np.testing.assert_allclose(found, LAW(v, t, p), rtol=5e-3)
    assert "mm/s" in (tmp_path / "law.inp").read_text() if units == "mm" else True


def test_abaqus_table_without_pressure_has_an_empty_place_for_it(tmp_path):
    em.FrictionLaw(V, MU[:, 0], temperature=T).to_abaqus(tmp_path / "law.inp")
    line = (tmp_path / "law.inp").read_text().splitlines()[-1]
    assert line.split(", ")[2] == ""
    assert float(line.split(",")[3]) == T[-1]
    em.FrictionLaw(V, MU[0, 0]).to_abaqus(tmp_path / "plain.inp")
    assert rows_of_friction(tmp_path / "plain.inp").shape[1] == 2


def test_modelica_tables(tmp_path):
    LAW.to_modelica(tmp_path / "law.txt")
    lines = (tmp_path / "law.txt").read_text().splitlines()
    assert lines[0] == "#1"
    tables, lines = {}, [line for line in lines if not line.startswith("#")]
    while lines:
        name, rows, columns = re.fullmatch(
            r"double (\w+)\((\d+),(\d+)\)", lines.pop(0)
        ).groups()
        body = [[float(x) for x in lines.pop(0).split()] for _ in range(int(rows))]
        tables[name] = np.array(body)
        assert tables[name].shape == (int(rows), int(columns))
    assert list(tables) == ["mu_1", "mu_2", "mu_3"]
    for i, table in enumerate(tables.values()):
        np.testing.assert_allclose(np.exp(table[1:, 0]), V, rtol=1e-13)
        np.testing.assert_allclose(np.exp(table[0, 1:]), P, rtol=1e-13)
        np.testing.assert_allclose(table[1:, 1:], MU[i].T, rtol=1e-14)
    em.FrictionLaw(V, MU[0, 0]).to_modelica(tmp_path / "one.txt")
    found = np.loadtxt(tmp_path / "one.txt", skiprows=4)
    np.testing.assert_allclose(
        found, np.stack([np.log(V), MU[0, 0]], 1), rtol=1e-13, atol=1e-13
    )


def grids_of_source(text):
    """The arrays of the DATA statements of a Fortran source, by name."""
    assert (
        max(len(line) for line in text.splitlines() if not line.startswith("C")) <= 72
    )
    size = {k: int(v) for k, v in re.findall(r"n([vpt]) = (\d+)", text)}
    grids = {
        "gv": np.full(size["v"], np.nan),
        "gp": np.full(size["p"], np.nan),
        "gt": np.full(size["t"], np.nan),
    }
    grids["gm"] = np.full((size["v"], size["p"], size["t"]), np.nan)
    for name, rest, first, last, values in re.findall(
        r"data \((g\w)\(i([,\d]*)\), i=(\d+),(\d+)\) /\n     \*   ([^/]*) /", text
    ):
        place = (
            slice(int(first) - 1, int(last)),
            *(int(x) - 1 for x in rest.split(",") if x),
        )
        grids[name][place] = [float(x.replace("d", "e")) for x in values.split(",")]
    return grids


def test_user_subroutine_holds_the_law(tmp_path):
    LAW.to_fric_coef(tmp_path / "law.for", units="mm")
    grids = grids_of_source((tmp_path / "law.for").read_text())
    np.testing.assert_allclose(np.exp(grids["gv"]), 1e3 * V, rtol=1e-9)
    np.testing.assert_allclose(np.exp(grids["gp"]), 1e-6 * P, rtol=1e-9)
    np.testing.assert_allclose(grids["gt"], T, rtol=1e-10)
    np.testing.assert_allclose(grids["gm"], MU.transpose(2, 1, 0), rtol=1e-10)


@pytest.mark.skipif(shutil.which("gfortran") is None, reason="no Fortran compiler")
def test_user_subroutine_computes_the_law_and_its_derivatives(tmp_path):
    LAW.to_fric_coef(tmp_path / "law.for")
    (tmp_path / "aba_param.inc").write_text("      implicit real*8 (a-h,o-z)\n")
    v, t, p = PLACES
    program = """      program one
      implicit real*8 (a-h,o-z)
      dimension f(1), d(1,3), props(1), fields(1,1), j(2), r(3)
      character*80 s
      do i = 1, 40
         read *, v, t, p
         call fric_coef(f, d, 1, 1, 1, 1, j, r, s, s, s, props, v, p, t, fields)
         print *, f(1), d(1,1), d(1,2), d(1,3)
      end do
      end
"""
    program = program.replace("s, s, s, props, v", "s, s, s,\n     *      props, v")
    (tmp_path / "one.for").write_text(program)
    compile_ = [
        "gfortran",
        "-fallow-argument-mismatch",
        "-o",
        "one",
        "one.for",
        "law.for",
    ]
    subprocess.run(compile_, cwd=tmp_path, check=True, capture_output=True)
    given = "\n".join(
        f"{x:.17g} {y:.17g} {z:.17g}" for x, y, z in zip(v, t, p, strict=True)
    )
    done = subprocess.run(
        [tmp_path / "one"], input=given, capture_output=True, text=True, check=True
    )
    mu, by_v, by_p, by_t = np.array(
        [line.split() for line in done.stdout.splitlines()], dtype=float
    ).T
    np.testing.assert_allclose(mu, LAW(v, t, p), rtol=1e-8)
    for found, step in (
        (by_v, (1e-6 * v, 0, 0)),
        (by_p, (0, 0, 1e-6 * p)),
        (by_t, (0, 1e-4, 0)),
    ):
        plus, minus = (
            LAW(v + s * step[0], t + s * step[1], p + s * step[2]) for s in (1, -1)
        )
        np.testing.assert_allclose(
            found, (plus - minus) / (2 * sum(step)), rtol=1e-3, atol=1e-9
        )


def slip_curve(loads, kelvin=None):
    slip = np.concatenate([np.geomspace(1e-3, 0.1, 14), np.linspace(0.12, 0.9, 10)])
    law = em.FrictionLaw([1e-3, 1.0, 30.0], [1.1, 1.2, 0.8]) if kelvin is None else None
    rubber, wheel = (
        em.StandardSolid(3e5, 2e5, 1e-3),
        em.Cylinder(radius=0.3, length=0.16),
    )
    return em.traction(
        em.Foundation(8e7, [], []),
        wheel,
        friction=law if law is not None else 1.0,
        velocity=20.0,
        slip=slip,
        load=np.asarray(loads)[:, None],
        tangential=em.springs(rubber, 8e-3, tangential=True),
        rtol=1e-4,
    )


def test_property_file(tmp_path):
    """Read by a parser of its own, with the formula written out here; the residual is
    the one that the file says.
    """
    curve = slip_curve([2e3, 4e3, 6e3])
    curve.to_tir(tmp_path / "tyre.tir", radius=0.3, width=0.16)
    text = (tmp_path / "tyre.tir").read_text()
    found = {
        key: value.strip("' ")
        for key, value in re.findall(r"^(\w+) *= *(.+)$", text, re.MULTILINE)
    }
    p = {
        key: float(value)
        for key, value in found.items()
        if re.fullmatch(r"[-+.\de]+", value)
    }
    assert found["PROPERTY_FILE_FORMAT"] == "PAC2002"
    assert found["LENGTH"] == "meter"
    assert (p["FNOMIN"], p["FZMIN"], p["FZMAX"], p["LONGVL"]) == pytest.approx(
        (4e3, 2e3, 6e3, 20.0), rel=1e-6
    )
    load, kappa = np.asarray(curve.normal_force), -np.asarray(curve.slip)
    f = load / p["FNOMIN"] - 1
    d, k = (
        load * (p["PDX1"] + p["PDX2"] * f),
        load * (p["PKX1"] + p["PKX2"] * f) * np.exp(p["PKX3"] * f),
    )
    b, e = (
        k / (p["PCX1"] * d),
        (p["PEX1"] + p["PEX2"] * f + p["PEX3"] * f**2)
        * (1 - p["PEX4"] * np.sign(kappa)),
    )
    force = d * np.sin(
        p["PCX1"] * np.arctan(b * kappa - e * (b * kappa - np.arctan(b * kappa)))
    )
    off = -force / load - curve.coefficient
    said = [
        float(x)
        for x in re.search(r"F_x/F_z: ([\d.]+) rms, ([\d.]+) at worst", text).groups()
    ]
    assert [np.sqrt(np.mean(off**2)), abs(off).max()] == pytest.approx(said, abs=6e-5)
    assert said[0] < 0.03
    again = curve.magic_formula()
    np.testing.assert_allclose(again.force(curve.slip, load), -force, rtol=1e-6)


def test_one_of_several_temperatures(tmp_path):
    """A property file has one temperature: that which is named, and the same as if
    nothing else had been computed.
    """
    law = em.FrictionLaw(
        [1e-3, 1.0, 30.0],
        [[1.1, 1.2, 0.8], [0.9, 1.0, 0.6]],
        temperature=[280.0, 300.0],
    )
    rubber = em.StandardSolid(3e5, 2e5, 1e-3, shift=em.WLF(8.86, 101.6, 293.15))
    slip = np.concatenate([np.geomspace(1e-3, 0.1, 10), np.linspace(0.12, 0.9, 6)])

    def brakes(kelvin):
        return em.traction(
            em.Foundation(8e7, [], []),
            em.Cylinder(radius=0.3, length=0.16),
            friction=law,
            velocity=20.0,
            slip=slip,
            load=4e3,
            temperature=kelvin,
            tangential=em.springs(rubber, 8e-3, tangential=True),
            rtol=1e-4,
        )

    curve = brakes(np.array([[280.0], [300.0]]))
    with refused("temperature", "Magic Formula"):
        curve.to_tir(tmp_path / "x", radius=0.3, width=0.16)
    with refused("temperature", 280, 300, 290):
        curve.magic_formula(temperature=290)
    one = brakes(300.0).magic_formula()
    assert curve.magic_formula(temperature=300.0).coefficients == pytest.approx(
        one.coefficients, rel=1e-4
    )
    curve.to_tir(tmp_path / "x", radius=0.3, width=0.16, temperature=280.0)
    assert "PDX1" in (tmp_path / "x").read_text()


def test_what_has_no_file(tmp_path):
    hole = em.FrictionLaw([1.0, 2.0], [0.3, np.nan])
    for write in (hole.to_abaqus, hole.to_fric_coef, hole.to_modelica):
        with refused("mu", 1, 2):
            write(tmp_path / "x")
    with pytest.raises(em.InputError, match="units must be 'm'"):
        LAW.to_abaqus(tmp_path / "x", units="inch")
    with pytest.raises(em.InputError, match="radius must be positive"):
        slip_curve([4e3]).to_tir(tmp_path / "x", radius=0.0, width=0.1)
    assert not list(tmp_path.iterdir())
