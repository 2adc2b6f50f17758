"""Exports of instruments in the variants that they come in: titles, orders, units,
decimal marks, encodings, steps.

Every file holds the same moduli of one rubber, and is read to the same SI numbers
without a warning.
"""

import warnings

import numpy as np
import pytest

import elastomdr as em

from ..refused import mentions, refused
from .dma_files import measure

RUBBER = em.Prony(
    3e6,
    np.array([400, 350, 250, 120, 45, 14, 5, 2.2, 1.2, 0.8, 0.55, 0.4, 0.3, 0.2]) * 1e6,
    np.geomspace(1e-10, 1e3, 14),
    kind="tensile",
    shift=em.WLF(7.4, 121.6, 293.15),
)
CELSIUS = np.arange(-30.0, 41.0, 10.0)
HERTZ = np.geomspace(0.1, 50, 5)
F, T, S, L = measure(RUBBER, CELSIUS, HERTZ, 0.0).T
OMEGA, SIZE, DELTA = 2 * np.pi * F, np.hypot(S, L), np.degrees(np.arctan2(L, S))
COMPLIANCE = 1 / (S + 1j * L)
SHEAR = {"kind": "shear"}
TENSILE = {"kind": "tensile"}
SPECIMEN = TENSILE | {"area": 1e-4, "length": 0.02}
STIFF = 1e-4 / 0.02 / 1e3  # N/mm per Pa


def point(x):
    return f"{x:.10g}"


def comma(x):
    return f"{x:.10g}".replace(".", ",")


def rows(columns, mark=",", text=point):
    return [mark.join(text(x) for x in row) for row in zip(*columns, strict=True)]


def table(titles, *columns, mark=",", text=point):
    return "\n".join([titles, *rows(columns, mark, text)])


def q800(*columns, text=point, encoding="latin-1"):
    """Titles in Sig1 ..., numbers below StartOfData, marks of events between them."""
    head = [
        "Version\t2.0",
        "Instrument\tDMA Q800 V21.1 Build 51",
        f"Nsig\t{len(columns)}",
    ]
    head += [f"Sig{i}\t{title}" for i, (title, _) in enumerate(columns, 1)]
    body = rows([numbers for _, numbers in columns], "\t", text)
    body.insert(3, "\t".join(["-2.000", *["1.000"] * (len(columns) - 1)]))
    return "\r\n".join(
        [*head, "Size\t17.5 x 12.8 x 1.9 mm", "StartOfData", *body]
    ).encode(encoding)


TIME, TEMP = ("Time (min)", 0.5 * np.arange(F.size)), ("Temperature (°C)", T)
STORAGE, LOSS, RATE = (
    ("Storage Modulus (MPa)", S / 1e6),
    ("Loss Modulus (MPa)", L / 1e6),
    ("Frequency (Hz)", F),
)
MORE = [
    ("Tan Delta", L / S),
    ("Static Force (N)", 0 * F + 0.01),
    ("Complex Modulus (MPa)", SIZE / 1e6),
    ("Strain (%)", 0 * F + 0.05),
    ("Storage Compliance (1/GPa)", COMPLIANCE.real * 1e9),
]
Q800 = {
    "usual": q800(TIME, TEMP, RATE, STORAGE, LOSS, MORE[0]),
    "another order": q800(TIME, TEMP, LOSS, *MORE, RATE, STORAGE),
    "decimal commas": q800(TIME, TEMP, RATE, STORAGE, LOSS, text=comma),
    "UTF-16": q800(TIME, TEMP, RATE, STORAGE, LOSS, encoding="utf-16"),
    "pascals": q800(
        TIME, TEMP, RATE, ("Storage Modulus (Pa)", S), ("Loss Modulus (Pa)", L)
    ),
    "rad/s and GPa": q800(
        TIME,
        TEMP,
        ("Angular Frequency (rad/sec)", OMEGA),
        ("Storage Modulus (GPa)", S / 1e9),
        LOSS,
    ),
    "psi and K": q800(
        TIME,
        ("Temperature (K)", T + 273.15),
        RATE,
        ("Storage Modulus (psi)", S / 6894.757293168),
        LOSS,
    ),
    "dyn/cm2 and degF": q800(
        TIME,
        ("Temperature (°F)", 1.8 * T + 32),
        RATE,
        ("Storage Modulus (dyn/cm²)", 10 * S),
        LOSS,
    ),
}


def trios(mark="\t", text=point, titles=None, encoding="utf-8"):
    """A block for each step, with titles and units of its own."""
    titles = titles or (
        "Angular frequency",
        "Step time",
        "Temperature",
        "Storage modulus",
        "Loss modulus",
        "Tan(delta)",
    )
    known = {
        "Angular frequency": ("rad/s", OMEGA),
        "Frequency": ("Hz", F),
        "Step time": ("s", F),
        "Temperature": ("°C", T),
        "Storage modulus": ("MPa", S / 1e6),
        "Loss modulus": ("MPa", L / 1e6),
        "Tan(delta)": ("", L / S),
    }
    lines = [f"File name{mark}X.tri", f"Instrument name{mark}RSA-G2", ""]
    for i, celsius in enumerate(CELSIUS, 1):
        here = celsius == T
        lines += [
            "[step]",
            f"Frequency sweep - {i}",
            mark.join(titles),
            mark.join(known[x][0] for x in titles),
        ]
        lines += [*rows([known[x][1][here] for x in titles], mark, text), ""]
    return "\r\n".join(lines).encode(encoding)


TRIOS = {
    "text": trios(),
    "csv": trios(","),
    "csv with a mark": trios(",", encoding="utf-8-sig"),
    "UTF-16": trios(encoding="utf-16"),
    "decimal commas": trios(";", comma),
    "another order": trios(
        titles=(
            "Frequency",
            "Temperature",
            "Tan(delta)",
            "Loss modulus",
            "Storage modulus",
        )
    ),
}


def netzsch(
    *names, mark=";", text=point, head="##Temp./°C;Time/min", size=1e6, single=False
):
    """A group of columns for each frequency; or one for all with a column of
    frequencies.
    """
    lines = [
        "#EXPORTTYPE:\tDATA ALL",
        "#FORMAT:\tNETZSCH5",
        "#INSTRUMENT:\tNETZSCH DMA 242",
        "",
    ]
    values = [
        (L / S if "tan" in x else L / size if "''" in x or '"' in x else S / size)
        for x in names
    ]
    if single:
        return "\r\n".join(
            [
                *lines,
                mark.join([head, "Frequency/Hz", *names]),
                *rows([T, T, F, *values], mark, text),
            ]
        )
    titles = [
        name.replace("@", f"({hertz:.3f} Hz)") for hertz in HERTZ for name in names
    ]
    columns = [x[np.isclose(F, hertz)] for hertz in HERTZ for x in values]
    body = rows([CELSIUS, 0.5 * CELSIUS, *columns], mark, text)
    return "\r\n".join([*lines, mark.join([head.replace(";", mark), *titles]), *body])


NETZSCH = {
    "usual": netzsch("E'@/MPa", "E''@/MPa", "tan d@"),
    "decimal commas": netzsch("E'@/MPa", "E''@/MPa", text=comma),
    "pascals": netzsch("E'@/Pa", "E''@/Pa", size=1),
    "a quote for two primes": netzsch("E'@/MPa", 'E"@/MPa', "tan d@"),
    "tangent only": netzsch("E'@/MPa", "tan d@"),
    "German": netzsch(
        "Speichermodul E'@/MPa", "Verlustmodul E''@/MPa", head="##Temp./°C;Zeit/min"
    ),
    "tabs": netzsch("E'@/MPa", "E''@/MPa", mark="\t"),
    "a column of frequencies": netzsch("E'/MPa", "E''/MPa", "tan d", single=True),
}
NETZSCH = {name: text.encode("latin-1") for name, text in NETZSCH.items()}


def rheocompass(text=point, german=False, encoding="utf-16"):
    """An interval for each temperature; torsion, so that the moduli are of shear."""
    words = (
        "Interval and data points:|Interval data:|Point No.|Temperature|Angular "
        "Frequency|Storage Modulus|Loss Modulus"
    )
    if german:
        words = (
            "Abschnitt und "
            "Daten:|Abschnittsdaten:|Messpkt.|Temperatur|Kreisfrequenz|Speichermodul|Verlustmodul"
        )
    first, second, *titles = words.split("|")
    lines = ["Project:\trubber", "Test:\tsweep"]
    for i, celsius in enumerate(CELSIUS, 1):
        here = celsius == T
        lines += [
            "",
            f"{first}\t{i}\t{HERTZ.size}",
            "\t".join([second, *titles, "Shear Strain", "Torque", "Status"]),
        ]
        lines += ["", "\t\t[°C]\t[rad/s]\t[MPa]\t[MPa]\t[%]\t[mN·m]\t"]
        body = rows(
            [
                1 + np.arange(5),
                T[here],
                OMEGA[here],
                S[here] / 3e6,
                L[here] / 3e6,
                0 * F[here] + 0.1,
                F[here],
            ],
            "\t",
            text,
        )
        lines += [f"\t{row}\tME-" for row in body]
    return "\r\n".join(lines).encode(encoding)


RHEOCOMPASS = {
    "usual": rheocompass(),
    "German, decimal commas": rheocompass(comma, german=True),
    "UTF-16 without a mark": rheocompass(encoding="utf-16-le"),
    "UTF-8 with a mark": rheocompass(encoding="utf-8-sig"),
}


def matrix(storage, loss, mark=";", text=point, first="f [Hz]", blocks=False):
    """A pair of columns for each temperature; with `blocks` all storage moduli before
    all loss moduli.
    """
    order = (
        [(name, c) for name in (storage, loss) for c in CELSIUS]
        if blocks
        else [(name, c) for c in CELSIUS for name in (storage, loss)]
    )
    values = [
        ((L / S if "tan" in name else L / 1e6) if name is loss else S / 1e6)[c == T]
        for name, c in order
    ]
    rate = HERTZ * (2 * np.pi if "rad" in first else 1)
    return table(
        mark.join([first, *(name.replace("@", f"{c:g}") for name, c in order)]),
        rate,
        *values,
        mark=mark,
        text=text,
    )


MATRIX = {
    "decimal commas": matrix("E' (@ °C) [MPa]", "E'' (@ °C) [MPa]", text=comma),
    "slashes": matrix("E'(@°C)/MPa", "E''(@°C)/MPa", ","),
    "behind": matrix("E' [MPa] @ °C", "E'' [MPa] @ °C", ","),
    "blocks": matrix("E' @ °C [MPa]", "E'' @ °C [MPa]", "\t", blocks=True),
    "omega": matrix("E'_@C (MPa)", "E''_@C (MPa)", ",", first="omega (rad/s)"),
    "tangent": matrix("E' (@ °C) [MPa]", "tan delta (@ °C)"),
    "commas": matrix("E', @ °C, MPa", "E'', @ °C, MPa"),
    "temperatures above": "\n".join(
        [
            ";".join(["", *(f"{c:g} °C;" for c in CELSIUS)]),
            matrix("E' [MPa]", "E'' [MPa]", text=comma),
        ]
    ),
    "frequencies": table(
        ";".join(
            ["T [°C]", *(f"{x} ({h:g} Hz) [MPa]" for h in HERTZ for x in ("E'", "E''"))]
        ),
        CELSIUS,
        *(x[np.isclose(F, h)] / 1e6 for h in HERTZ for x in (S, L)),
        mark=";",
    ),
    "blocks of one frequency": "\n\n".join(
        f"Frequency: {h:g} Hz\n"
        + table(
            "T [°C];E' [MPa];E'' [MPa]",
            CELSIUS,
            *(x[np.isclose(F, h)] / 1e6 for x in (S, L)),
            mark=";",
        )
        for h in HERTZ
    ),
}
EPLEXOR = "Nr;Strain dyn;f;T;E';E'';|E*|;tan delta\n;%;Hz;°C;MPa;MPa;MPa;"
OTHERS = {
    "Eplexor": table(
        EPLEXOR,
        F,
        0 * F + 0.1,
        F,
        T,
        S / 1e6,
        L / 1e6,
        SIZE / 1e6,
        L / S,
        mark=";",
        text=comma,
    ),
    "pyvisco": table(
        "f,E_stor,E_loss,T,Set\nHz, MPa, MPa, C, -", F, S / 1e6, L / 1e6, T, 0 * F
    ),
    "steps": table(
        "Step,T [°C],f [Hz],Strain [%],E' [MPa],E'' [MPa]", T, T, F, F, S / 1e6, L / 1e6
    ),
    "German": table(
        "Temperatur in °C;Frequenz in Hz;Speichermodul E' in MPa;Verlustfaktor",
        T,
        F,
        S / 1e6,
        L / S,
        mark=";",
        text=comma,
    ),
}
CASES = [
    (f"{n} {k}", data, TENSILE)
    for n, group in (("Q800", Q800), ("TRIOS", TRIOS))
    for k, data in group.items()
]
CASES += [
    (f"{n} {k}", data, {})
    for n, group in (("Netzsch", NETZSCH), ("matrix", MATRIX), ("", OTHERS))
    for k, data in group.items()
]
CASES += [
    (f"RheoCompass {k}", data, {"shear": True}) for k, data in RHEOCOMPASS.items()
]
QUANTITIES = {
    "|E*| and phase": ("T [°C],f [Hz],|E*| [MPa],delta [°]", (SIZE / 1e6, DELTA), {}),
    "E' and phase": ("T [°C],f [Hz],E' [MPa],Phasenwinkel [°]", (S / 1e6, DELTA), {}),
    "E'' and tangent": ("T [°C],f [Hz],E'' [MPa],tan delta", (L / 1e6, L / S), {}),
    "eta* and tangent": (
        "T [°C],f [Hz],|eta*| [Pa s],tan delta [-]",
        (SIZE / 3 / OMEGA, L / S),
        {"shear": True},
    ),
    "eta* and phase": (
        "T (°C),f [Hz],Complex viscosity η* (kPa·s),Phase angle (°)",
        (SIZE / 3e3 / OMEGA, DELTA),
        {"shear": True},
    ),
    "eta' and eta''": (
        "T [°C],f [Hz],eta' [Pa·s],eta'' [Pa·s]",
        (L / 3 / OMEGA, S / 3 / OMEGA),
        {"shear": True},
    ),
    "eta'' first": (
        "T [°C],f [Hz],η'' [Pas],η' [Pas]",
        (S / 3 / OMEGA, L / 3 / OMEGA),
        {"shear": True},
    ),
    "J' and J''": (
        "T [°C],f [Hz],J' [1/MPa],J'' [1/MPa]",
        (COMPLIANCE.real * 1e6, -COMPLIANCE.imag * 1e6),
        TENSILE,
    ),
    "D' and D''": (
        "T [°C],f [Hz],D' [1/Pa],D'' [1/Pa]",
        (COMPLIANCE.real, -COMPLIANCE.imag),
        {},
    ),
    "mm2/N": (
        "T [°C],f [Hz],Storage compliance [mm²/N],Loss compliance [mm²/N]",
        (COMPLIANCE.real * 1e6, -COMPLIANCE.imag * 1e6),
        TENSILE,
    ),
    "K* and phase": (
        "T [°C],f [Hz],K* [N/mm],Phase [deg]",
        (SIZE * STIFF, DELTA),
        SPECIMEN,
    ),
    "K' and K''": (
        "T [°C],f [Hz],K' [N/m],K'' [N/m]",
        (S * STIFF * 1e3, L * STIFF * 1e3),
        SPECIMEN,
    ),
    "stiffness and tangent": (
        "T [°C],f [Hz],Dynamic stiffness [kN/m],tan delta",
        (SIZE * STIFF, L / S),
        SPECIMEN,
    ),
}
CASES += [
    (name, table(titles, T, F, *columns), options)
    for name, (titles, columns, options) in QUANTITIES.items()
]


def read(path, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        return em.read_dma(path, **options)


@pytest.mark.parametrize(
    ("data", "options"), [case[1:] for case in CASES], ids=[case[0] for case in CASES]
)
def test_every_variant_gives_the_same_numbers(data, options, tmp_path):
    path = tmp_path / "export.csv"
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    options = dict(options)
    shear = options.pop("shear", False)
    dma = read(path, **options)
    order, wanted = (
        np.lexsort((dma.omega, dma.temperature.round(6))),
        np.lexsort((F, T)),
    )
    factor = 3 if shear else 1
    np.testing.assert_allclose(dma.temperature[order], T[wanted] + 273.15, rtol=1e-9)
    # frequencies in titles are rounded
    np.testing.assert_allclose(dma.omega[order], OMEGA[wanted], rtol=1e-3)
    np.testing.assert_allclose(factor * dma.storage[order], S[wanted], rtol=1e-8)
    np.testing.assert_allclose(factor * dma.loss[order], L[wanted], rtol=1e-8)
    assert (dma.kind, dma.bad_rows) == ("shear" if shear else "tensile", ())


def test_a_stiffness_needs_its_specimen(write):
    """The error says what to give, and that is right (`SPECIMEN` above)."""
    path = write(
        table("T [°C],f [Hz],K* [N/mm],Phase [deg]", T, F, SIZE * STIFF, DELTA)
    )
    with pytest.raises(em.InputError, match=r"--area '100 mm2' --length '20 mm'"):
        em.read_dma(path, kind="tensile")


def test_columns_by_number_without_a_header(write):
    path = write("\n".join(rows([F, T, S / 1e6, L / 1e6], "  ")))
    columns = {
        "frequency": "1 [Hz]",
        "temperature": "2 [degC]",
        "storage": "3 [MPa]",
        "loss": "4 [MPa]",
    }
    np.testing.assert_allclose(
        read(path, columns=columns, kind="tensile").loss, L, rtol=1e-8
    )


def files(folder, name):
    paths = []
    for celsius in CELSIUS:
        here = celsius == T
        paths.append(folder / name.format(f"{celsius:g}"))
        paths[-1].write_text(
            table("f [Hz],E' [MPa],E'' [MPa]", F[here], S[here] / 1e6, L[here] / 1e6)
        )
    return paths


@pytest.mark.parametrize(
    "name", ["sample_{}C.csv", "{} degC.csv", "batch 7, {}°C, second run.csv"]
)
def test_temperatures_in_the_names_of_files(name, tmp_path):
    dma = read(files(tmp_path, name))
    np.testing.assert_allclose(dma.temperature, T + 273.15)
    assert mentions(dma.columns[0], -30, "temperature")


@pytest.mark.parametrize(
    "name", ["sample-{}C.csv", "{}.csv", "{}C_60C.csv", "x33{}K.csv"]
)
def test_names_that_may_mean_something_else_give_none(name, tmp_path):
    """A dash that may be a minus, no unit, two temperatures, a number of something
    else: then they are given.
    """
    paths = files(tmp_path, name)[3:]
    with pytest.warns(em.fit.FitWarning, match="no temperature"):
        em.read_dma(paths)
    kelvin = CELSIUS[3:] + 273.15
    np.testing.assert_allclose(
        np.unique(read(paths, temperature=kelvin).temperature), kelvin
    )


def test_temperatures_that_can_only_be_degrees_are_asked_for(tmp_path):
    path = files(tmp_path, "{}.csv")[4]
    with refused("temperature", 20, 293.15):
        em.read_dma(path, temperature=20.0)
    np.testing.assert_allclose(read(path, temperature=293.15).temperature, 293.15)
    with refused("temperature", "kelvin"):
        em.fit.dma(OMEGA, S, L, T + 40, kind="tensile")
    with refused("reference", "kelvin"):
        em.fit.master_curve(em.fit.dma(OMEGA, S, L, T + 273.15, kind="tensile"), 20.0)
