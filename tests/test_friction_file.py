"""Measured friction from files: one table in several units gives one set of points; what is missing is named."""

import numpy as np
import pytest

import elastomdr as em

V, T, MU = np.array([1e-3, 1e-2, 1e-1, 1.0]), np.array([278.15, 293.15, 313.15, 333.15]), np.array([0.3, 0.5, 0.7, 0.6])


def write(folder, text):
    (folder / "rig.csv").write_bytes(text.encode())
    return folder / "rig.csv"


@pytest.mark.parametrize(
    ("titles", "velocity", "temperature", "join"),
    [
        ("velocity [m/s],temperature [K],mu", V, T, ","),
        ("# a rig\nSliding speed (mm/s);Temp. (°C);COF [-]", 1e3 * V, T - 273.15, ";"),
        ("v [um/s]\tT [degF]\tfriction coefficient", 1e6 * V, 1.8 * T - 459.67, "\t"),
        ("velocity,temperature,mu\nm/min,degC,-", 60 * V, T - 273.15, ","),
        ("Geschwindigkeit / km/h;Temperatur / °C;Reibwert", 3.6 * V, T - 273.15, ";"),
        ("v [m s^-1],T [K],µ", V, T, ","),
    ],
)
def test_one_table_in_several_units(tmp_path, titles, velocity, temperature, join):
    rows = [join.join(f"{x:.12g}" for x in row) for row in zip(velocity, temperature, MU, strict=True)]
    found = em.fit.read_friction(write(tmp_path, "\n".join([titles, *rows])))
    for name, values in (("velocity", V), ("temperature", T), ("mu", MU)):
        np.testing.assert_allclose(found.points[name], values, rtol=1e-11)
    assert found.report == ()
    assert found.pressure is found.error is None


def test_pressure_errors_and_what_the_user_adds(tmp_path):
    file = write(tmp_path, "mu std [%],speed,load [N],COF 2,p [MPa]\n3,1,50,0.4,0.5\n5,10,50,0.6,1\n")
    found = em.fit.read_friction(file, velocity_unit="mm/s", temperature=300.0, columns={"mu": "COF 2"})
    np.testing.assert_allclose(found.velocity, [1e-3, 1e-2], rtol=1e-14)
    np.testing.assert_allclose(found.pressure, [5e5, 1e6], rtol=1e-14)
    np.testing.assert_allclose(found.error, [0.012, 0.03], rtol=1e-14)
    np.testing.assert_allclose(found.temperature, 300.0)
    assert "2 points of 'rig.csv'" in repr(found)
    assert (em.fit.read_friction(file, velocity_unit="mm/s", columns={"mu": 4}).mu == found.mu).all()


def test_rows_that_are_no_measurement_are_counted_and_named(tmp_path):
    rows = ["1,20,0.5", "2,20,", "3,20,0.6", "-4,20,0.6", "5,20,slipped", "6,20,0.7", "7,20,-0.1", "8,20,0", "9,20,0.9"]
    file = write(tmp_path, "\n".join(["velocity [mm/s],temperature [degC],mu", *rows]))
    with pytest.warns(em.fit.FitWarning, match=r"rig.csv: 4 of 9 rows .* \(line 3, 5, 6, 8\)"):
        found = em.fit.read_friction(file)
    np.testing.assert_allclose(found.velocity, [1e-3, 3e-3, 6e-3, 8e-3, 9e-3])
    assert found.report[0] in repr(found)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("velocity,mu\n1,0.5\n", "velocity without a unit"),
        ("velocity [mm],mu\n1,0.5\n", "no unit of it"),
        ("velocity [m/s],temperature [MPa],mu\n1,20,0.5\n", "no unit of it"),
        ("velocity [m/s],mu [N]\n1,0.5\n", "must be a plain number"),
        ("velocity [m/s],force\n1,0.5\n", "has no mu"),
        ("velocity [m/s],mu,friction\n1,0.5,0.5\n", "more than one column for mu"),
        ("1,0.5\n2,0.6\n", "has no velocity"),
        ("velocity [m/s],mu\n-1,0.5\n-2,0.6\n3,0.5\n", "more than half"),
        ("nothing\n", "without a row of two numbers"),
    ],
)
def test_bad_files(tmp_path, text, words):
    with pytest.raises(em.InputError, match=words):
        em.fit.read_friction(write(tmp_path, text))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"velocity_unit": "mm/s"}, "velocity_unit is 'mm/s', but 'rig.csv' says 'm/s'"),
        ({"velocity_unit": "mph"}, "velocity_unit must be a unit"),
        ({"temperature_unit": "MPa"}, "temperature_unit must be"),
        ({"temperature": 300.0}, "temperature must be left out"),
        ({"columns": {"speed": 1}}, "columns must name"),
        ({"columns": {"mu": "COF"}}, "has no column 'COF'"),
        ({"columns": ["mu"]}, "columns must be a dict"),
    ],
)
def test_bad_arguments(tmp_path, given, words):
    file = write(tmp_path, "velocity [m/s],temperature [K],mu\n1,300,0.5\n2,300,0.5\n")
    with pytest.raises(em.InputError, match=words):
        em.fit.read_friction(file, **given)
    with pytest.raises(em.InputError, match="can be read"):
        em.fit.read_friction(tmp_path / "none.csv")


@pytest.mark.parametrize(
    ("titles", "velocity"),
    [
        ("Sliding velocity, mm/s;Temperature, K;Coefficient of friction, -", 1e3 * V),
        ("velocity_mm_s;temperature_K;mu", 1e3 * V),
        ("log10 v [m/s];T [K];mu", np.log10(V)),
        ("ln v [mm/s];T [K];mu [-]", np.log(1e3 * V)),
        ("% v [mm/s];T [K];mu [-]", 1e3 * V),
    ],
)
def test_more_titles(tmp_path, titles, velocity):
    for mark in (";", " "):
        if mark == " " and "," in titles:
            continue
        rows = [mark.join(f"{x:.12g}" for x in row) for row in zip(velocity, T, MU, strict=True)]
        found = em.fit.read_friction(write(tmp_path, "\n".join([titles.replace(";", mark), *rows])))
        np.testing.assert_allclose(found.velocity, V, rtol=1e-9)
        np.testing.assert_allclose(found.mu, MU)
        np.testing.assert_allclose(found.temperature, T)
        assert found.report == ()


@pytest.mark.parametrize(
    ("titles", "row", "words"),
    [
        ("v [mm/s],T [degC],mu", "{v},293,0.5", "566.1 to 566.1 K are implausible .as kelvins .* assumed is degC"),
        ("v [mm/s],T [K],mu", "{v},20,0.5", "20 to 20 K are implausible; assumed is K"),
        ("v [mm/s],T [K],mu", "{v},293,50", "mu of 50 in the median is implausible; assumed is a plain number"),
        ("v [km/s],T [K],mu", "{v},293,0.5", "1e.03 to 3e.03 m/s are implausible; assumed is km/s"),
        ("log v [mm/s],T [K],mu", "{v},293,0.5", "'log v' is taken as a decadic logarithm"),
    ],
)
def test_what_no_experiment_has_is_said(tmp_path, titles, row, words):
    file = write(tmp_path, "\n".join([titles, *(row.format(v=v) for v in (1, 2, 3))]))
    with pytest.warns(em.fit.FitWarning, match=words):
        found = em.fit.read_friction(file)
    assert found.mu.size == 3
    assert found.report[0] in repr(found)


def test_percent_and_rows_that_break_off(tmp_path):
    rows = ["1,20,50", "2,20,60,", "3,20,70", "mean,,60", "4", "4,20,80,9"]
    file = write(tmp_path, "\n".join(["v [mm/s],T [degC],mu [%]", *rows]))
    with pytest.warns(em.fit.FitWarning, match=r"3 of 6 rows .* \(line 5, 6, 7\)"):
        found = em.fit.read_friction(file)
    np.testing.assert_allclose(found.mu, [0.5, 0.6, 0.7])
    file = write(tmp_path, "\n".join(["# v[mm/s] T[K] mu n", "1 293 0.5 1", "2 0.6 1", "3 293 0.7 1"]))
    with pytest.warns(em.fit.FitWarning, match=r"1 of 3 rows .* \(line 3\)"):
        np.testing.assert_allclose(em.fit.read_friction(file).mu, [0.5, 0.7])


def test_an_error_in_percent_beside_a_coefficient_in_percent_is_refused(tmp_path):
    """Of mu, or of 1?"""
    file = write(tmp_path, "v [mm/s],mu [%],std [%]\n1,50,2\n2,60,2\n")
    with pytest.raises(em.InputError, match="percent of mu or of 1"):
        em.fit.read_friction(file)
