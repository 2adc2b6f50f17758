"""Synthetic measurements of a known material, and writers for every layout of files
that `em.read_dma` reads.
"""

import io
import zipfile
from pathlib import Path
from xml.sax.saxutils import escape

import numpy as np

import elastomdr as em

KNOWN = em.Prony(
    6e5,
    np.geomspace(6e7, 2e5, 10),
    np.geomspace(1e-9, 1.0, 10),
    shift=em.WLF(5.8, 125.0, 293.15),
    name="known",
)
CELSIUS = np.arange(-10.0, 61.0, 10.0)
HERTZ = np.geomspace(0.1, 100.0, 13)

LAW = em.WLF(7.0, 120.0, 293.15)
RUBBER = em.Prony(4e5, np.geomspace(4e7, 3e5, 9), np.geomspace(1e-8, 1.0, 9), shift=LAW)
STEPS = np.arange(-20.0, 41.0, 10.0)  # degC
SWEEP = np.geomspace(0.1, 50.0, 11)  # Hz


def measure(material, celsius=CELSIUS, hertz=HERTZ, noise=0.003, seed=0, factor=1.0):
    """Rows of Hz, degC, storage and loss modulus [Pa] (times `factor`: 2 (1 + nu) for
    tension), with relative noise.
    """
    rng = np.random.default_rng(seed)
    t, f = (grid.ravel() for grid in np.meshgrid(celsius, hertz, indexing="ij"))
    moduli = np.concatenate(
        [
            factor * np.asarray(material.at(kelvin).complex_modulus(2 * np.pi * hertz))
            for kelvin in celsius + 273.15
        ]
    )
    scatter = 1 + noise * rng.normal(size=(2, t.size))
    return np.column_stack([f, t, moduli.real * scatter[0], moduli.imag * scatter[1]])


def data(celsius=STEPS, noise=0.005, seed=0, material=RUBBER, lift=None, hertz=SWEEP):
    """Measurements as `em.fit` takes them; `lift` is a vertical shift, a function of
    degC.
    """
    rows = measure(material, np.asarray(celsius), hertz, noise, seed)
    up = np.ones(len(rows)) if lift is None else lift(rows[:, 1])
    return em.fit.dma(
        2 * np.pi * rows[:, 0],
        up * rows[:, 2],
        up * rows[:, 3],
        rows[:, 1] + 273.15,
        kind="shear",
    )


def isotherms(rows):
    return [rows[rows[:, 1] == celsius] for celsius in np.unique(rows[:, 1])]


def plain_csv(folder: Path, rows) -> list[Path]:
    """One header row with the units in the names."""
    lines = [
        "freq_hz,temperature_C,G_storage_pa,G_loss_pa",
        *(",".join(map(repr, map(float, row))) for row in rows),
    ]
    return [_text(folder / "plain.csv", lines)]


def two_rows(folder: Path, rows) -> list[Path]:
    """A row of names and a row of units, megapascals, marked UTF-8."""
    lines = ["f,G_stor,G_loss,T,Set", "Hz,MPa,MPa,C,-"]
    lines += [f"{f!r},{s / 1e6!r},{l / 1e6!r},{t!r},0" for f, t, s, l in rows.tolist()]
    return [_text(folder / "two.csv", lines, "utf-8-sig")]


def tabs_in_rad(folder: Path, rows) -> list[Path]:
    """Tabs, angular frequency, kelvins and kilopascals in brackets."""
    lines = ["Angular frequency [rad/s]\tTemperature [K]\tG' [kPa]\tG'' [kPa]"]
    lines += [
        f"{2 * np.pi * f!r}\t{t + 273.15!r}\t{s / 1e3!r}\t{l / 1e3!r}"
        for f, t, s, l in rows.tolist()
    ]
    return [_text(folder / "tabs.tsv", lines)]


def decimal_comma(folder: Path, rows) -> list[Path]:
    """Semicolons, decimal commas, German titles, Latin-1."""
    lines = ["Frequenz (Hz);Temperatur (°C);G' (MPa);G'' (MPa)"]
    lines += [
        ";".join(f"{x:.12g}" for x in (f, t, s / 1e6, l / 1e6)).replace(".", ",")
        for f, t, s, l in rows.tolist()
    ]
    return [_text(folder / "comma.csv", lines, "latin-1")]


def korean(folder: Path, rows) -> list[Path]:
    """Korean titles in cp949; the sign for degrees Celsius is one of its own there."""
    lines = ["주파수(Hz),온도(℃),G'(MPa),G''(MPa)"]
    lines += [f"{f!r},{t!r},{s / 1e6!r},{l / 1e6!r}" for f, t, s, l in rows.tolist()]
    return [_text(folder / "korean.csv", lines, "cp949")]


def trios(folder: Path, rows) -> list[Path]:
    """Sections of a TRIOS export, whose units change from step to step."""
    lines = [
        "[Version]",
        "TA Instruments LIMS export format version\t0",
        "[Header]",
        "Document ID\txxx",
    ]
    for i, part in enumerate(isotherms(rows)):
        unit, size = (("kPa", 1e3), ("MPa", 1e6))[i % 2]
        lines += [
            "[Step]",
            f"Step name\tFrequency sweep ({part[0, 1]:.1f} °C)",
            f"Number of points\t{len(part)}",
            "Variables\tRun time\tTemperature\tAngular frequency\tOscillation "
            "torque\tStorage modulus\tLoss modulus\tTan(delta)\tFrequency",
            f"Units\ts\t°C\trad/s\tµN.m\t{unit}\tMPa\t\tHz",
        ]
        lines += [
            (
                "Data "
                f"point\t{60 * j}\t{t!r}\t{2 * np.pi * f!r}\t1.5\t{s / size!r}\t{l / 1e6!r}\t{l / s!r}\t{f!r}"
            )
            for j, (f, t, s, l) in enumerate(part.tolist())
        ]
    return [_text(folder / "trios.txt", lines)]


def reptate(folder: Path, rows) -> list[Path]:
    """RepTate's .osc, one file per temperature."""
    paths = []
    for part in isotherms(rows):
        lines = [
            f"T={part[0, 1]:g};Mw=33;chem=PI;",
            "w\tG'\tG\"\tTemp",
            "rad/s\tPa\tPa\t°C",
        ]
        lines += [
            f"{2 * np.pi * f:12.6g} {s:16.9g} {l:16.9g} {t:12.6g}"
            for f, t, s, l in part.tolist()
        ]
        paths.append(_text(folder / f"melt_{part[0, 1]:g}C.osc", lines, "latin-1"))
    return paths


_EPLEXOR = ("Nr", "F stat.", "Time", "f", "T", "G'", "G''", "|G*|", "tan delta")
_EPLEXOR_UNITS = ("", "N", "s", "Hz", "°C", "MPa", "MPa", "MPa", "")


def _eplexor_rows(rows):
    for i, (f, t, s, l) in enumerate(rows.tolist()):
        yield [
            i + 1.0,
            -28.9,
            60.0 * i,
            f,
            t,
            s / 1e6,
            l / 1e6,
            np.hypot(s, l) / 1e6,
            l / s,
        ]


def eplexor_xls(folder: Path, rows) -> list[Path]:
    """The sheet of an Eplexor as .xls, with its second sheet of settings."""
    import xlwt

    book = xlwt.Workbook()
    sheet = book.add_sheet("Exported Data")
    for i, cells in enumerate([_EPLEXOR, _EPLEXOR_UNITS, *_eplexor_rows(rows)]):
        for j, cell in enumerate(cells):
            sheet.write(i, j, cell)
    settings = book.add_sheet("Data header")
    for i, cells in enumerate(
        [
            ["Measurement type:", "Temp. Freq. Sweep"],
            ["", "Static load", "Dynamic load", 0.5, 1.5],
        ]
    ):
        for j, cell in enumerate(cells):
            settings.write(i, j, cell)
    path = folder / "eplexor.xls"
    book.save(str(path))
    return [path]


def eplexor_xlsx(folder: Path, rows) -> list[Path]:
    """The same sheet as .xlsx, written by hand."""

    def cell(value) -> str:
        if isinstance(value, str):
            return f'<c t="inlineStr"><is><t>{escape(value)}</t></is></c>'
        return f"<c><v>{value!r}</v></c>"

    body = "".join(
        f"<row>{''.join(map(cell, cells))}</row>"
        for cells in [_EPLEXOR, _EPLEXOR_UNITS, *_eplexor_rows(rows)]
    )
    main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
    office = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
    package = "http://schemas.openxmlformats.org/package/2006"
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{package}/content-types"><Default Extension="rels" ContentType="application/'
        'vnd.openxmlformats-package.relationships+xml"/><Default Extension="xml" ContentType="application/xml"/></Types>',
        "_rels/.rels": (
            f'<Relationships xmlns="{package}/relationships"><Relationship Id="r1" '
            f'Type="{office}/'
            'officeDocument" Target="xl/workbook.xml"/></Relationships>'
        ),
        "xl/workbook.xml": f'<workbook xmlns="{main}" xmlns:r="{office}"><sheets><sheet name="Exported Data" sheetId="1" '
        'r:id="r1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{package}/relationships"><Relationship Id="r1" Type="{office}/'
        'worksheet" Target="worksheets/sheet1.xml"/></Relationships>',
        "xl/worksheets/sheet1.xml": f'<worksheet xmlns="{main}"><sheetData>{body}</sheetData></worksheet>',
    }
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w") as archive:
        for name, text in parts.items():
            archive.writestr(name, '<?xml version="1.0" encoding="UTF-8"?>' + text)
    path = folder / "eplexor.xlsx"
    path.write_bytes(buffer.getvalue())
    return [path]


def q800(folder: Path, rows) -> list[Path]:
    """TA Q800: titles in lines Sig1 ..., numbers below StartOfData, Latin-1; it says no
    kind.
    """
    titles = (
        "Time (min)",
        "Temperature (°C)",
        "Frequency (Hz)",
        "Storage Modulus (MPa)",
        "Loss Modulus (MPa)",
    )
    lines = ["Version\t2.0", "Instrument\tDMA Q800 V21.1 Build 51", "Nsig\t5"]
    lines += [f"Sig{i}\t{title}" for i, title in enumerate(titles, start=1)]
    lines += ["Size\t10 x 5 x 2 mm", "StartOfData"]
    lines += [
        f"{i / 2}\t{t!r}\t{f!r}\t{s / 1e6!r}\t{l / 1e6!r}"
        for i, (f, t, s, l) in enumerate(rows.tolist())
    ]
    return [_text(folder / "q800.txt", lines, "latin-1")]


def netzsch(folder: Path, rows) -> list[Path]:
    """Netzsch 242: one group of columns for each frequency, semicolons, Latin-1."""
    hertz = np.unique(rows[:, 0])
    heads = [
        f"{name}({f!r} Hz){unit}"
        for f in hertz.tolist()
        for name, unit in (("G'", "/MPa"), ("G''", "/MPa"))
    ]
    lines = [
        "#EXPORTTYPE:\tDATA ALL",
        "#DECIMAL:\tPOINT",
        "#RANGE:\t-60/2.0(K/min)/80",
        "##Temp./°C;Time/min;" + ";".join(heads),
    ]
    for part in isotherms(rows):
        cells = [
            f"{x / 1e6!r}"
            for row in part[np.argsort(part[:, 0])].tolist()
            for x in row[2:]
        ]
        lines.append(";".join([repr(float(part[0, 1])), "1.0", *cells]))
    return [_text(folder / "netzsch.csv", lines, "latin-1")]


def matrix(folder: Path, rows) -> list[Path]:
    """One pair of columns for each temperature, decimal commas."""
    parts = isotherms(rows)
    heads = [
        f"{name} ({part[0, 1]:g} °C) [MPa]" for part in parts for name in ("G'", "G''")
    ]
    lines = [";".join(["f [Hz]", *heads])]
    for same in zip(*(part.tolist() for part in parts), strict=True):
        cells = [same[0][0], *(x / 1e6 for row in same for x in row[2:])]
        lines.append(";".join(f"{x:.12g}" for x in cells).replace(".", ","))
    return [_text(folder / "matrix.csv", lines)]


def rheocompass(folder: Path, rows) -> list[Path]:
    """Anton Paar RheoCompass: UTF-16, an interval for each temperature, a row of units
    in brackets.
    """
    lines = ["Project:\tmelt", "Test:\tsweep"]
    for i, part in enumerate(isotherms(rows), start=1):
        lines += ["", f"Interval and data points:\t{i}\t{len(part)}"]
        lines += [
            (
                "Interval data:\tPoint No.\tTemperature\tAngular Frequency\tStorage "
                "Modulus\tLoss Modulus\tTorque"
            )
        ]
        lines += ["", "\t\t[°C]\t[rad/s]\t[Pa]\t[Pa]\t[mN·m]"]
        lines += [
            f"\t{j}\t{t!r}\t{2 * np.pi * f!r}\t{s!r}\t{l!r}\t0.1"
            for j, (f, t, s, l) in enumerate(part.tolist())
        ]
    return [_text(folder / "rheocompass.csv", lines, "utf-16")]


def beside(folder: Path, rows) -> list[Path]:
    """The same columns again for each isotherm, side by side, with the temperature
    above.
    """
    parts = isotherms(rows)
    lines = [
        ",".join(f"T = {part[0, 1]:g} degC,," for part in parts),
        ",".join(["f [Hz],G' [Pa],G'' [Pa]"] * len(parts)),
    ]
    for same in zip(*(part.tolist() for part in parts), strict=True):
        lines.append(",".join(f"{f!r},{s!r},{l!r}" for f, _, s, l in same))
    return [_text(folder / "beside.csv", lines)]


def below(folder: Path, rows) -> list[Path]:
    """One header, and a line with the temperature above each isotherm."""
    lines = ["a rubber of 5 phr, measured at night", "f [Hz],G' [Pa],G'' [Pa]"]
    for i, part in enumerate(isotherms(rows), start=1):
        lines += [
            f"Step {i}: {part[0, 1]:g} °C",
            *(f"{f!r},{s!r},{l!r}" for f, _, s, l in part.tolist()),
            "",
        ]
    return [_text(folder / "below.csv", lines)]


def sheets(folder: Path, rows) -> list[Path]:
    """A spreadsheet with a sheet for each temperature, which is its name."""
    import xlwt

    book = xlwt.Workbook()
    for part in isotherms(rows):
        sheet = book.add_sheet(f"{part[0, 1]:g} °C")
        for i, cells in enumerate(
            [("f [Hz]", "G' [Pa]", "G'' [Pa]"), *np.delete(part, 1, 1).tolist()]
        ):
            for j, cell in enumerate(cells):
                sheet.write(i, j, cell)
    book.save(str(folder / "sheets.xls"))
    return [folder / "sheets.xls"]


WRITERS = (
    plain_csv,
    two_rows,
    tabs_in_rad,
    decimal_comma,
    korean,
    trios,
    reptate,
    eplexor_xls,
    eplexor_xlsx,
)
LAYOUTS = (*WRITERS, q800, netzsch, matrix, rheocompass, sheets, beside, below)


def _text(path: Path, lines, encoding: str = "utf-8") -> Path:
    path.write_bytes(("\n".join(lines) + "\n").encode(encoding))
    return path
