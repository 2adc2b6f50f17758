"""Spectra from files: each unit and order of one table gives one surface; what is
missing or wrong is named.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main

from ..cli.cli_cases import arguments
from ..refused import mentions, refused, warned

Q = np.geomspace(1e3, 1e5, 21)  # [rad/m]
C = 1e-15 * (Q / 1e3) ** -3.6  # [m^4]
# <h^2> = 2 pi int q C dq, by hand
HEIGHT = (2 * np.pi * 1e-15 * 1e6 * (1 - 100**-1.6) / 1.6) ** 0.5
# <|grad h|^2> = 2 pi int q^3 C dq
SLOPE = (2 * np.pi * 1e-15 * 1e12 * (100**0.4 - 1) / 0.4) ** 0.5
ROUND = 1e-5  # of the tables, written with seven digits


def write(place, head, x=Q, c=C, join=",", name="road.csv"):
    text = "\n".join(
        [*head, *(f"{a:.7g}{join}{b:.7g}" for a, b in zip(x, c, strict=True))]
    )
    (place / name).write_bytes(text.encode())
    return place / name


def same(surface):
    np.testing.assert_allclose(
        [surface.rms_height, surface.rms_slope], [HEIGHT, SLOPE], rtol=ROUND
    )


@pytest.mark.parametrize(
    ("head", "first", "second", "join"),
    [
        (["q [rad/m],C [m^4]"], 1, 1, ","),
        (["Asphalt, 2024", "", "q (rad/mm); C(q) (mm^4)"], 1e-3, 1e12, ";"),
        (["# Asphalt", "# q [rad/µm], C [µm⁴]"], 1e-6, 1e24, ", "),
        (["q / rad*m^-1\tC / m^2*um^2"], 1, 1e12, "\t"),
        (["q,C", "rad/m,m4"], 1, 1, ","),
        (["frequency [cycles/mm],C [m^4]"], 1e-3 / (2 * np.pi), 1, ","),
    ],
)
def test_one_surface_in_several_units(tmp_path, head, first, second, join):
    surface = em.read_spectrum(
        write(tmp_path, head, Q * first, C * second, join), convention="2d"
    )
    same(surface)
    (said,) = surface.report
    assert mentions(said, "no `longest`", "no `shortest`")


def test_decimal_commas_and_wavelengths(tmp_path):
    file = write(tmp_path, ["lambda [mm];C [m^4]"], 2e3 * np.pi / Q, C, ";")
    file.write_text(file.read_text().replace(".", ","))
    surface = em.read_spectrum(file, convention="2d")
    same(surface)
    (said,) = surface.report
    assert mentions(said, "no `longest`", "no `shortest`")


def test_what_one_over_metre_means_is_asked(tmp_path):
    file = write(tmp_path, ["q [1/m],C [m^4]"])
    with refused("wave_number", "road.csv", "1/m", 2, "pi/lambda", "1/lambda"):
        em.read_spectrum(file, convention="2d")
    same(em.read_spectrum(file, convention="2d", wave_number="2 pi/lambda"))
    with warned(UserWarning, 11.4, "rms slope"):
        cycles = em.read_spectrum(file, convention="2d", wave_number="1/lambda")
    np.testing.assert_allclose(cycles.rms_slope, (2 * np.pi) ** 2 * SLOPE, rtol=ROUND)
    with pytest.raises(em.InputError, match="left out, or '2 pi/lambda'"):
        em.read_spectrum(
            write(tmp_path, ["q [rad/m],C [m^4]"]),
            convention="2d",
            wave_number="1/lambda",
        )


def test_what_a_title_spells_out_is_not_asked(tmp_path):
    for title, factor in (
        ("1/lambda [1/mm]", 2 * np.pi),
        ("1/λ (1/mm)", 2 * np.pi),
        ("q = 2 π/λ [1/mm]", 1.0),
    ):
        file = write(tmp_path, [f"{title},C [m^4]"], Q * 1e-3 / factor, C)
        same(em.read_spectrum(file, convention="2d"))
    with pytest.raises(em.InputError, match=r"wave_number must be .*, got '1/lambda'"):
        em.read_spectrum(file, convention="2d", wave_number="1/lambda")
    angular = (
        "2 pi (1/lambda)",
        "2*pi*(1/lambda)",
        "2 pi x 1/lambda",
        "wavenumber 2pi*1/lambda",
        "q = 2π·1/λ",
    )
    for title in angular:
        same(
            em.read_spectrum(
                write(tmp_path, [f"{title} [1/mm],C [m^4]"], Q * 1e-3), convention="2d"
            )
        )
    for title in (
        "tau 1/lambda",
        "1/(2 pi lambda)",
        "1/lambda 2 pi",
        "q/2pi = 1/lambda",
        "6.28*1/lambda",
        "1/lambda^2",
    ):
        with refused("wave_number", 2, "pi/lambda", "1/lambda"):
            em.read_spectrum(
                write(tmp_path, [f"{title} [1/mm],C [m^4]"]), convention="2d"
            )


@pytest.mark.parametrize(
    ("title", "unit"),
    [
        ("1/lambda [rad/m]", "cycles/m"),
        ("2 pi/lambda [cycles/m]", "rad/m"),
        ("1/lambda [m]", "1/m"),
        ("lambda [1/m]", "m"),
        ("wavelength [rad/m]", "rad/m"),
        ("q [m]", "rad/m"),
    ],
)
def test_title_against_its_unit(tmp_path, title, unit):
    """Nothing is taken for granted of a title that contradicts its unit; q_unit settles
    it.
    """
    x = {
        "cycles/m": Q / (2 * np.pi),
        "1/m": Q / (2 * np.pi),
        "rad/m": Q,
        "m": 2 * np.pi / Q,
    }[unit]
    file = write(tmp_path, [f"{title},C [m^4]"], x)
    with refused("q_unit", "given"):
        em.read_spectrum(file, convention="2d")
    same(em.read_spectrum(file, convention="2d", q_unit=unit))


@pytest.mark.parametrize(
    "title",
    ["log10 q [rad/m],C [m^4]", "logq [rad/m],C [m^4]", "q [rad/m],log_10(C) [m^4]"],
)
def test_logarithms_in_a_title(tmp_path, title):
    with refused("path", "logarithms"):
        em.read_spectrum(write(tmp_path, [title]), convention="2d")
    same(
        em.read_spectrum(
            write(tmp_path, ["q log-spaced [rad/m],C [m^4]"]), convention="2d"
        )
    )


def test_density_over_spatial_frequency(tmp_path):
    """One-sided over n = 1/lambda, <h^2> = int G dn, as road profiles have it: of C =
    C_0 q^-3 a cut has, over all q, int C(root(q^2 + k^2)) dk = 2 C_0/q^2, and so G = 2
    * 2 pi * 2 C_0/q^2.
    """
    n = np.geomspace(10, 1e5, 2000)
    file = write(
        tmp_path, ["n [cycles/m],G [m^3]"], n, 8 * np.pi * 1e-7 / (2 * np.pi * n) ** 2
    )
    surface = em.read_spectrum(file, convention="1d one-sided/2pi")
    np.testing.assert_allclose(
        surface.at([1e2, 1e3, 1e4]), 1e-7 / np.array([1e2, 1e3, 1e4]) ** 3, rtol=2e-3
    )


def test_what_is_mended_is_reported(tmp_path):
    x, c = Q[[0, 2, 1, *range(3, 21)]], C[[0, 2, 1, *range(3, 21)]].copy()
    file = write(tmp_path, ["q [rad/m],C [m^4]", "0,0", ",1e-16", "2e3,nan"], x, c)
    surface = em.read_spectrum(file, convention="2d")
    same(surface)
    for said in (
        "3 of 24 rows",
        "line 2, 3, 4",
        "not in order",
    ):
        assert said in " ".join(surface.report)
    with pytest.warns(UserWarning, match="unlike a real surface's"):
        wrong = em.read_spectrum(
            write(tmp_path, ["q [rad/m],C [m^4]"], Q, 1e4 * C), convention="2d"
        )
    assert "unlike a real surface" in wrong.report[0]


def test_cutoffs(tmp_path):
    file = write(tmp_path, ["q [rad/m],C [m^4]"])
    surface = em.read_spectrum(
        file, convention="2d", longest=2 * np.pi / 2e3, shortest=2 * np.pi / 3e4
    )
    slope = (2 * np.pi * 1e-15 * 1e12 * (30**0.4 - 2**0.4) / 0.4) ** 0.5
    np.testing.assert_allclose(
        [surface.q_low, surface.q_high, surface.rms_slope],
        [2e3, 3e4, slope],
        rtol=ROUND,
    )
    assert "keeps" in surface.report[0]
    assert len(surface.report) == 1
    half = em.read_spectrum(file, convention="2d", longest=2 * np.pi / 2e3)
    assert half.report[-1].startswith("no `shortest`")
    with pytest.raises(em.InputError, match="within the table"):
        em.read_spectrum(file, convention="2d", shortest=1e-6)


@pytest.mark.parametrize(
    ("head", "rows", "options", "message"),
    [
        (
            ["q [rad/m],C [m^4]"],
            ["1,1", "2,-3", "3,1"],
            {},
            ("path", -3, 3),
        ),
        (
            ["q [rad/m],C [m^4]"],
            ["3,-14", "3.5,-15", "4,-16"],
            {},
            ("path", "logarithms"),
        ),
        (["q [rad/m],C [m^4]"], ["1,1", "2,3,4"], {}, ("path", 3, 2)),
        (["q [rad/m],C [m^4]"], ["1,1", "2,3"], {}, ("path", "three rows")),
        (
            ["q [rad/m],C [m^4]"],
            ["1,1", "2,1", "2,1"],
            {},
            ("path", "ascending"),
        ),
        (["q [rad/m],C [m^3]"], ["1,1", "2,1", "3,1"], {}, ("c_unit", "'2d'")),
        (
            ["q [rad/m],C"],
            ["1,1", "2,1", "3,1"],
            {},
            ("c_unit", 2, "'C'"),
        ),
        (
            ["q [furlong],C [m^4]"],
            ["1,1", "2,1", "3,1"],
            {},
            ("q_unit", "contradict each other"),
        ),
        (
            ["q [rad/m],C [m^4]"],
            ["1,1", "2,1", "3,1"],
            {"q_unit": "rad/mm"},
            ("", "'rad/m'", "says"),
        ),
        (
            ["q [rad/m],C [m^4]"],
            ["1,1", "2,1", "3,1"],
            {"q_unit": "rad"},
            ("q_unit", "unit"),
        ),
        (["q [rad/m],n,C [m^4]"], ["1,1,1", "2,1,1", "3,1,1"], {}, ("columns", 3)),
        (
            ["q [rad/m],n,C [m^4]"],
            ["1,1,1"],
            {"columns": (1, 4)},
            ("columns", 1, 3),
        ),
        (["q [rad/m],C [m^4]"], [], {}, ("path", "two numbers")),
        (
            ["q [rad/m],C [m^4]"],
            ["1,1"],
            {"convention": "3d"},
            ("convention", "'1d one-sided/2pi'"),
        ),
        (
            ["q [rad/m],C [m^4]"],
            ["1,1"],
            {"wave_number": "k"},
            ("wave_number", "'1/lambda'", "'k'"),
        ),
    ],
)
def test_refusals(tmp_path, head, rows, options, message):
    (tmp_path / "road.csv").write_text("\n".join(head + rows))
    with refused(*message):
        em.read_spectrum(tmp_path / "road.csv", **{"convention": "2d"} | options)


def test_units_and_columns_from_the_user(tmp_path):
    file = tmp_path / "road.dat"
    file.write_text(
        "\n".join(
            f"{i} {c:.7g} {q:.7g}" for i, (q, c) in enumerate(zip(Q, C, strict=True))
        )
    )
    same(
        em.read_spectrum(
            file, convention="2d", q_unit="rad/m", c_unit="m^4", columns=(3, 2)
        )
    )


SCENE = """
material = "sbr-gum-like"
[surface]
shape = "spectrum"
{keys}
[contact]
pressure = "0.1 MPa"
velocity = ["1 mm/s"]
"""


def test_scene(tmp_path, capsys):
    write(tmp_path, ["q [1/m],C [m^4]"])
    scene = tmp_path / "scene.toml"
    keys = 'file = "road.csv"\nconvention = "2d"\nwave_number = "2 pi/lambda"\n'
    scene.write_text(SCENE.format(keys=keys + 'shortest = "100 um"'))
    shape = arguments("friction", str(scene))["shape"]
    np.testing.assert_allclose(
        [shape.q_low, shape.q_high], [1e3, 2 * np.pi / 1e-4], rtol=ROUND
    )
    for keys, message in (
        ('file = "road.csv"', "convention must be one of 2d,"),
        ('convention = "2d"', "q must be given, or file"),
        (
            'convention = "2d"\nq = [1.0, 2.0]\nc = [1.0, 1.0]\nfile = "road.csv"',
            "file must be left out where q is given",
        ),
        (
            'convention = "2d"\nq = [1.0, 2.0]\nc = [1.0, 1.0]\nshortest = "1 mm"',
            "shortest must be left out",
        ),
        ('convention = "2d"\nfile = "none.csv"', "none.csv"),
        (
            'convention = "2d"\nfile = "road.csv"',
            "[surface] wave_number must be given",
        ),
    ):
        scene.write_text(SCENE.format(keys=keys))
        assert main(["plan", str(scene)]) == 2
        said = capsys.readouterr().err
        assert said.count("\n") == 1
        assert said.startswith("elastomdr: error: scene.toml: [surface]")
        assert message in said


def test_a_scene_without_cutoffs_says_what_is_taken_and_what_is_usual(tmp_path):
    """Of a table over seven decades the ends decide friction."""
    q = 2 * np.pi / np.geomspace(0.314, 21e-9, 40)
    write(tmp_path, ["q [rad/m],C [m^4]"], q, 1e-7 * (q / q[0]) ** -3.6)
    scene = tmp_path / "scene.toml"
    scene.write_text(SCENE.format(keys='file = "road.csv"\nconvention = "2d"'))
    with warned(UserWarning, "cutoffs right"):
        shape = arguments("friction", str(scene))["shape"]
    text = em.friction(
        em.StandardSolid(1e6, 3e6, 1e-3), shape, velocity=1.0, pressure=1e6
    ).summary()
    text = " ".join(text.split())
    assert mentions(text, 0.314, 2.1e-08)
    assert mentions(text, 5, "some micrometres")


@pytest.mark.filterwarnings("ignore::elastomdr.ModelWarning")
def test_result_says_how_the_table_was_read_and_which_rule_fits(tmp_path):
    surface = em.read_spectrum(
        write(tmp_path, ["q [rad/m],C [m^4]", "0,0"]), convention="2d"
    )
    rubber = em.StandardSolid(1e6, 3e6, 1e-3)
    for pressure, words in (
        (1e3, "light contact (up to 0.03)"),
        (1e6, 'compare equivalent_length = "full contact"'),
    ):
        text = em.friction(
            rubber,
            surface,
            velocity=1.0,
            pressure=pressure,
            model=em.Line(samples=1024),
        ).summary()
        level = pressure / (4e6 * SLOPE)  # E*(0) = 4 G for an incompressible half-space
        assert f"p/(E*(0) rms slope) = {level:.4g}"[:-1] in text
        assert words in text
        assert "1 of 22 rows without a number" in text
