"""Hostile texts cost what their size explains: no pattern takes the square of a field,
and what would take a hundred times its size in memory is refused before it is parsed.
"""

import contextlib
import time
import tracemalloc
import warnings

import pytest

import elastomdr as em
from elastomdr.cli.kinds import read_content
from elastomdr.files import read_toml
from elastomdr.io.sheets import cut

from ..refused import refused

N = 20_000
FIELDS = {
    "digits": "1" * N + "x",
    "points": "." * N,
    "pairs": "()" * (N // 2),
    "blanks": "x" + " " * N + "y",
    "dashes": "-" * N,
    "numbers": "x" + ".1" * (N // 2),
    "logarithms": "log(" * (N // 4),
    "underlines": "_" * N,
    "slashes": "/ " * (N // 2),
}
ROWS = "".join(f"{i},{1e6 + i},{1e5 + i},20\n" for i in range(1, 11))
TABLE = "{title},G' [Pa],G'' [Pa],T [degC]\n" + ROWS
PLACES = {
    "cell": "f [Hz],G' [Pa],G'' [Pa],T [degC]\n" + ROWS + "11,{0},1e5,20\n",
    "title": "f [Hz],G' [Pa],G'' [Pa],{0}\n" + ROWS,
    "remark": "{0}\nf [Hz],G' [Pa],G'' [Pa],T [degC]\n" + ROWS,
    "tabs": ("{0}\nf [Hz],G' [Pa],G'' [Pa],T [degC]\n" + ROWS).replace(",", "\t"),
}
READERS = (
    lambda path: em.read_dma(path, kind="shear"),
    lambda path: em.read_spectrum(path, convention="2d"),
    lambda path: em.read_friction(path, temperature=293.15),
    em.read_shifts,
)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("field", FIELDS)
def test_a_field_of_20_kB_takes_no_time(tmp_path, field, place):
    """It took up to 24 s in each reader; quadratic patterns take 0.5 s or more here."""
    file = tmp_path / "table.txt"
    file.write_text(PLACES[place].format(FIELDS[field]))
    started = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for reader in READERS:
            with contextlib.suppress(em.InputError):
                reader(file)
    assert time.process_time() - started < 4.0


def test_empty_lines_take_no_memory():
    """20 MB of them took 3.8 GB."""
    with refused("path", "10,000,000 lines", "20,000,000"):
        cut("empty.csv", "\n" * 20_000_000)
    tracemalloc.start()
    try:
        sheet = cut("empty.csv", "\n" * 200_000 + "1,2\n")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert [row.line for row in sheet.rows] == [200_001]
    assert peak < 5e6  # twenty bytes a line


def test_tables_without_end_are_refused(tmp_path):
    file = tmp_path / "tables.csv"
    file.write_text("1,2,3\n4,5,6\ntitle,x [mm],y [um]\n" * 5100)
    with refused("path_or_paths", "5,000"):
        em.read_dma(file, kind="shear")
    steps = "".join(f"1,2e6,1e5,{i // 3}\n" for i in range(15_300))
    file.write_text("f [Hz],G' [Pa],G'' [Pa],step\n" + steps)
    with refused("path_or_paths", "5,000"):
        em.read_dma(file, kind="shear")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("a" + ".a" * 20_000 + " = 1", ("", 1, 10)),
        ("x = 1\n[a" + " . 'b'" * 40 + "]", ("", 2, 10)),
        ('y = {a."b"' + '."b"' * 40 + " = 1}", ("", 1, 10)),
        ("x = " + "[" * 5000 + "]" * 5000, ("", "too deep")),
        ("x = " + "{a = " * 5000 + "1" + "}" * 5000, ("", "too deep")),
    ],
)
def test_deep_keys_of_toml_are_refused_before_they_are_parsed(tmp_path, text, said):
    file = tmp_path / "scene.toml"
    file.write_text(text)
    tracemalloc.start()
    started = time.process_time()
    try:
        with refused(*said):
            read_content(file)
        with refused(*said):
            em.load_material(file)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < 2e7
    assert time.process_time() - started < 2.0


def test_long_words_and_texts_in_toml_are_read(tmp_path):
    file = tmp_path / "some.toml"
    words = "a" * 200_000
    file.write_text(f'note = "{words}.{words}"\nversions = "1.2.3.4.5.6.7"\n')
    started = time.process_time()
    assert read_toml(file, "path")["versions"] == "1.2.3.4.5.6.7"
    assert time.process_time() - started < 1.0
    file.write_text("x = 1 # " + "a" * 6_000_000)
    with pytest.raises(em.InputError, match="6 MB, more than 5 MB"):
        read_content(file)


@pytest.mark.parametrize("title", ["[" * N, "x [mm], " + "[" * N, "p" * N])
def test_a_profile_of_pressures(tmp_path, title):
    file = tmp_path / "lip.csv"
    file.write_text(title + "\n1,2\n")
    started = time.process_time()
    with refused("", "title line") as raised:
        em.reciprocating(
            profile=file, velocity_out=0.1, velocity_in=0.1, stroke=0.1, viscosity=0.03
        )
    assert time.process_time() - started < 1.0
    assert len(str(raised.value)) < 1000
    file.write_bytes(b"x [mm], p [MPa]\n" + b"\n" * 11_000_000)
    with pytest.raises(em.InputError, match="11 MB, more than 10 MB"):
        em.reciprocating(
            profile=file, velocity_out=0.1, velocity_in=0.1, stroke=0.1, viscosity=0.03
        )
