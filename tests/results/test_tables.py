"""Exports of what has a table and is no result: each form against the text."""

import csv
import io
from typing import Any

import numpy as np
import openpyxl
import pytest

import elastomdr as em

from ..refused import refused

OMEGA = np.geomspace(1e-2, 1e6, 60)
SOFT, HARD = (
    em.Prony(e, [2e6, 3e6], [1e-4, 1e-1], name=name)
    for e, name in ((1e6, "soft, and black"), (4e6, "hard"))
)


def fitted():
    return em.fit.prony(OMEGA, SOFT.storage(OMEGA), SOFT.loss(OMEGA))


def master():
    law = em.WLF(8.86, 101.6, 293.15)
    omega, kelvin = np.meshgrid(np.geomspace(0.1, 100, 8), [273.15, 283.15, 293.15])
    omega, kelvin = omega.ravel(), kelvin.ravel()
    reduced = omega * law.a(kelvin)
    return em.fit.master_curve(
        em.fit.dma(
            omega, SOFT.storage(reduced), SOFT.loss(reduced), kelvin, kind="shear"
        ),
        293.15,
    )


def curve():
    velocity = np.geomspace(1e-3, 1.0, 5)
    return em.friction([SOFT, HARD], em.Sphere(5e-3), velocity=velocity, load=1.0)


MADE = {
    "series": fitted,
    "master curve": master,
    "ranking": lambda: curve().ranking(velocity=0.1),
    "law": lambda: curve().select("hard").law(),
}


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
@pytest.mark.parametrize("name", MADE)
def test_every_form_has_what_the_text_has(name, tmp_path):
    table: Any = MADE[name]()
    table.to_csv(tmp_path / "x.csv")
    text = (tmp_path / "x.csv").read_text()
    said = [line for line in text.splitlines() if line.startswith("#")]
    rows = list(csv.reader(io.StringIO("\n".join(text.splitlines()[len(said) :]))))
    frame = table.to_pandas()
    assert list(frame.columns) == rows[0]
    assert [f"# {line}" for line in frame.attrs["header"]] == said
    for title, *texts in zip(*rows, strict=True):
        values = frame[title].tolist()
        if frame[title].dtype.kind in "if":
            texts = [float(each or "nan") for each in texts]
            np.testing.assert_array_equal(values, texts)
        else:
            assert [each if isinstance(each, str) else "" for each in values] == texts
        np.testing.assert_array_equal(table.to_dict()[title], values)
        assert table.to_xarray()[title].size == len(texts)
    table.to_excel(tmp_path / "x.xlsx")
    sheet = openpyxl.load_workbook(tmp_path / "x.xlsx")["result"]
    assert sheet.max_row == len(rows)
    assert [cell.value for cell in sheet[1]] == rows[0]
    assert table.summary()
    with refused("path", "xlsx"):
        table.to_excel(tmp_path / "x.csv")
