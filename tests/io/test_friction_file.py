"""Measured friction from files: one table in several units gives one set of points;
what is missing is named.
"""

import numpy as np
import pytest

import elastomdr as em

from ..refused import refused, warned

V, T, MU = (
    np.array([1e-3, 1e-2, 1e-1, 1.0]),
    np.array([278.15, 293.15, 313.15, 333.15]),
    np.array([0.3, 0.5, 0.7, 0.6]),
)


def write(folder, text):
    (folder / "rig.csv").write_bytes(text.encode())
    return folder / "rig.csv"


def test_a_unit_of_pressures_that_the_file_does_not_name(tmp_path):
    rows = [
        f"{v},{mu},{p}" for v, mu, p in zip(V, MU, (0.1, 0.2, 0.3, 0.4), strict=True)
    ]
    file = write(tmp_path, "\n".join(["velocity [m/s],mu,pressure", *rows]))
    found = em.read_friction(file, pressure_unit="bar")
    np.testing.assert_allclose(found.pressure, [1e4, 2e4, 3e4, 4e4])


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
    rows = [
        join.join(f"{x:.12g}" for x in row)
        for row in zip(velocity, temperature, MU, strict=True)
    ]
    found = em.read_friction(write(tmp_path, "\n".join([titles, *rows])))
    for name, values in (("velocity", V), ("temperature", T), ("mu", MU)):
        np.testing.assert_allclose(found.points[name], values, rtol=1e-11)
    assert found.report == ()
    assert found.pressure is found.error is None


@pytest.mark.parametrize(
    "title",
    ["err", "sd", "uncertainty", "error mu", "mu_err", "Fehler", "±", "u_mu", "std"],
)
def test_titles_of_errors(title, tmp_path):
    path = tmp_path / "rig.csv"
    path.write_text(f"velocity [mm/s],mu,{title}\n1,0.5,0.01\n2,0.6,0.02\n")
    np.testing.assert_array_equal(em.read_friction(path).error, [0.01, 0.02])


def test_pressure_errors_and_what_the_user_adds(tmp_path):
    file = write(
        tmp_path,
        "mu std [%],speed,load [N],COF 2,p [MPa]\n3,1,50,0.4,0.5\n5,10,50,0.6,1\n",
    )
    with warned(em.fit.FitWarning, "'load [N]'"):
        found = em.read_friction(
            file, velocity_unit="mm/s", temperature=300.0, columns={"mu": "COF 2"}
        )
    for words in ("4 'COF 2'", "5 'p [MPa]'", "2 'speed' in mm/s"):
        assert words in found.columns
    np.testing.assert_allclose(found.velocity, [1e-3, 1e-2], rtol=1e-14)
    np.testing.assert_allclose(found.pressure, [5e5, 1e6], rtol=1e-14)
    np.testing.assert_allclose(found.error, [0.012, 0.03], rtol=1e-14)
    np.testing.assert_allclose(found.temperature, 300.0)
    assert "2 points of 'rig.csv'" in repr(found)
    with warned(em.fit.FitWarning, "'load [N]'"):
        again = em.read_friction(file, velocity_unit="mm/s", columns={"mu": 4})
    assert (again.mu == found.mu).all()


def test_rows_that_are_no_measurement_are_counted_and_named(tmp_path):
    rows = [
        "1,20,50",
        "2,20,",
        "3,20,60",
        "-4,20,60",
        "5,20,slipped",
        "mean,,60",
        "6",
        "7,20,-1",
        "8,20,0",
        "9,20,90,",
    ]
    file = write(
        tmp_path,
        "\n".join(
            ["velocity [mm/s],temperature [degC],mu [%]", *rows, "1,20,50", "2,20,50"]
        ),
    )
    with warned(em.fit.FitWarning, "rig.csv", 6, 3, 5, 9):
        found = em.read_friction(file)
    np.testing.assert_allclose(found.velocity, np.array([1, 3, 8, 9, 1, 2]) / 1e3)
    np.testing.assert_allclose(found.mu, [0.5, 0.6, 0, 0.9, 0.5, 0.5])
    assert found.report[0] in repr(found)
    file = write(
        tmp_path,
        "\n".join(["# v[mm/s] T[K] mu n", "1 293 0.5 1", "2 0.6 1", "3 293 0.7 1"]),
    )
    with warned(em.fit.FitWarning, "'n'"), warned(em.fit.FitWarning, 1, 3, 4):
        np.testing.assert_allclose(em.read_friction(file).mu, [0.5, 0.7])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("velocity [mm],mu\n1,0.5\n", ("", "'mm'", "velocity")),
        (
            "velocity [m/s],temperature [MPa],mu\n1,20,0.5\n",
            ("", "'MPa'", "temperature"),
        ),
        ("velocity [m/s],mu [N]\n1,0.5\n", ("", "'N'", "ratio")),
        ("velocity [m/s],force\n1,0.5\n", ("", "column")),
        ("velocity [m/s],mu,friction\n1,0.5,0.7\n", ("", "2 'mu'", "3 'friction'")),
        ("1,0.5\n2,0.6\n", ("", "velocity")),
        (
            "velocity [m/s],mu\n-1,0.5\n-2,0.6\n3,0.5\n",
            ("", 2, 3),
        ),
        ("velocity [m/s],mu\n1,50\n2,60\n", ("", 50, 60, "0 and 8,")),
        ("log v [m/s],mu\n1,0.5\n2,0.6\n", ("path", "logarithms", "base")),
        ("v [mm/s],mu [%],std [%]\n1,50,2\n2,60,2\n", ("", 1, "percent")),
        ("nothing\n", ("", "numbers")),
    ],
)
def test_bad_files(tmp_path, text, words):
    with refused(*words):
        em.read_friction(write(tmp_path, text))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"velocity_unit": "mph per K"}, ("velocity_unit",)),
        ({"temperature_unit": "MPa"}, ("temperature_unit",)),
        ({"temperature": 300.0}, ("temperature", "left out")),
        ({"columns": {"speed": 1}}, ("columns", "velocity", "speed")),
        ({"columns": {"mu": "COF"}}, ("columns", "'COF'", 1)),
        ({"columns": ["mu"]}, ("columns", "dict")),
    ],
)
def test_bad_arguments(tmp_path, given, words):
    file = write(tmp_path, "velocity [m/s],temperature [K],mu\n1,300,0.5\n2,300,0.5\n")
    with refused(*words):
        em.read_friction(file, **given)
    with pytest.raises(em.InputError, match="can be read"):
        em.read_friction(tmp_path / "none.csv")


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
    for mark in ";" if "," in titles else "; ":
        rows = [
            mark.join(f"{x:.12g}" for x in row)
            for row in zip(velocity, T, MU, strict=True)
        ]
        found = em.read_friction(
            write(tmp_path, "\n".join([titles.replace(";", mark), *rows]))
        )
        np.testing.assert_allclose(found.velocity, V, rtol=1e-9)
        np.testing.assert_allclose([found.mu, found.temperature], [MU, T])
        assert found.report == ()


def test_a_row_alone_above_others_is_read_once(tmp_path):
    """One row, a remark, the others; and one row alone above a remark."""
    head, first, *rest = (
        "velocity [m/s],mu",
        *(f"{v},{mu}" for v, mu in zip(V, MU, strict=True)),
    )
    file = write(tmp_path, "\n".join([head, first, "# warm now", *rest]))
    found = em.read_friction(file, temperature=293.15)
    np.testing.assert_allclose(found.velocity, V)
    file = write(tmp_path, "\n".join(["sample," + head, "A," + first, "# end", ""]))
    found = em.read_friction(file, temperature=293.15)
    np.testing.assert_allclose(found.velocity, V[:1])
