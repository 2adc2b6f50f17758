"""Every error of a reader that says what to give is followed, and what is then read is
right.

`N` stands for the number of a column and `UNIT` for a unit: what a person who knows the
file puts there. Advice for Python and for the command line stand side by side, and must
be the same.
"""

import re

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.fit import _column
from elastomdr.cli.main import main

from ..refused import refused, warned
from .dma_files import KNOWN, measure, plain_csv

F, T, S, L = measure(KNOWN, np.array([0.0, 20.0]), np.geomspace(0.1, 50, 6)).T
STEMS = {"frequency": "Hz", "temperature": "degC", "storage": "MPa", "loss": "MPa"}
TITLES = "f [Hz],T [degC],G' [MPa],G'' [MPa]"
PLACES = {"frequency": 1, "temperature": 2, "storage": 3, "loss": 4}


def written(titles, extra=(), columns=(F, T, S / 1e6, L / 1e6)):
    rows = zip(*columns, *extra, strict=True)
    return "\n".join([titles, *(",".join(f"{x:.12g}" for x in row) for row in rows)])


def followed(message, given, truth):
    """The options that a message asks for, with the truth in place of its N and
    UNIT.
    """
    places, units = truth["places"], truth["units"]
    options = {**given, "columns": dict(given.get("columns", {}))}
    if "(--kind" in message or "kind='shear'" in message:
        return options | {"kind": "shear"}
    if "ROLE" in message:
        for role in places:
            options["columns"][role] = f"{places[role]} [{units[role]}]"
        return options
    inside = ",".join(re.findall(r"columns=\{(.*?)\}", message))
    python = re.findall(r"'(\w+)': '?([^',]+)'?", inside)
    shell = re.findall(r"--column (?:'(\w+)=([^']*)'|(\w+)=(\w+))", message)
    assert python == [tuple(filter(None, one)) for one in shell], message
    for role, wanted in python:
        if wanted.isdigit() and int(wanted) != places[role]:
            continue  # the other of two
        options["columns"][role] = re.sub(
            r"\b[NM]\b", str(places[role]), wanted
        ).replace("UNIT", units[role])
    for option in re.findall(r"\(--(\w+)-unit\)", message):
        options[f"{option}_unit"] = units[{"modulus": "storage"}.get(option, option)]
        options["columns"] = dict(given.get("columns", {}))
    assert options != {**given, "columns": dict(given.get("columns", {}))}, (
        f"nothing to follow: {message}"
    )
    return options


CASES = {  # what is written, and where it differs from the usual places and units
    "no frequency unit": (written("f,T [degC],G' [MPa],G'' [MPa]"), {}),
    "no unit of omega": (written("omega,T [degC],G' [MPa],G'' [MPa]"), {}),
    "rates in 1/s": (written("f [1/s],T [degC],G' [MPa],G'' [MPa]"), {}),
    "omega in Hz": (written("omega [Hz],T [degC],G' [MPa],G'' [MPa]"), {}),
    "no units at all": (written("f,T,G',G''"), {}),
    "no modulus unit": (written("f [Hz],T [degC],G',G''"), {}),
    "units that nobody knows": (
        written("f [Hz],T [degC],G' [MegaPa],G'' [MegaPa]"),
        {},
    ),
    "no kind": (
        written("f [Hz],T [degC],storage modulus [MPa],loss modulus [MPa]"),
        {},
    ),
    "unknown titles": (written("a,b,c,d"), {}),
    "no titles": (written("")[1:], {}),
    "half of the titles": (written("f [Hz],T [degC],stiff [MPa],damp [MPa]"), {}),
    "a bare log": (
        written(
            "f [Hz],T [degC],log G' [Pa],log G'' [Pa]",
            columns=(F, T, *np.log10([S, L]) - 6),
        ),
        {},
    ),
    "log2": (
        written("f [Hz],T [degC],log2 a [MPa],G'' [MPa]", (S / 1e6,)),
        {"storage": 5},
    ),
    "MPa called Pa": (written("f [Hz],T [degC],G' [Pa],G'' [Pa]"), {}),
    "MPa called mPa": (written("f [Hz],T [degC],G' [mPa],G'' [mPa]"), {}),
    "degC called K": (written("f [Hz],T [K],G' [MPa],G'' [MPa]"), {}),
    "two frequencies": (written(TITLES + ",frequency [Hz]", (7 * F,)), {}),
    "two moduli": (
        written(TITLES + ",storage modulus [MPa]", (0.5 * S / 1e6,)),
        {"storage": 3},
    ),
    "swapped": (written("f [Hz],T [degC],G'' [MPa],G' [MPa]"), {}),
    "blanks in titles": (
        written("f T gap width G' G''", columns=(F, T, F, S / 1e6, L / 1e6)).replace(
            ",", " "
        ),
        {"storage": 4, "loss": 5},
    ),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_advice_leads_to_the_truth(name, write):
    text, elsewhere = CASES[name]
    truth = {"places": PLACES | elsewhere, "units": STEMS}
    path, given, messages = write(text), {}, []
    for _ in range(10):
        try:
            dma = em.read_dma(path, **given)
            if name == "swapped":
                em.fit.master_curve(dma)
            break
        except em.InputError as error:
            messages.append(str(error))
            given = followed(str(error), given, truth)
    else:
        pytest.fail("\n".join(messages))
    assert messages
    np.testing.assert_allclose(dma.omega, 2 * np.pi * F, rtol=1e-9)
    np.testing.assert_allclose(dma.temperature, T + 273.15, rtol=1e-9)
    np.testing.assert_allclose([dma.storage, dma.loss], [S, L], rtol=1e-9)
    assert dma.kind == "shear"
    # as the shell gives them
    columns = dict(
        _column(f"{role}={wanted}") for role, wanted in given["columns"].items()
    )
    np.testing.assert_array_equal(
        em.read_dma(path, **given | {"columns": columns}).storage, dma.storage
    )


@pytest.mark.parametrize(
    ("titles", "columns"),
    [
        ("Temperature [degC],Time [s],E' [MPa]", {"relaxation": 3}),
        ("Temperature [degC],Time [s],Dynamic stiffness [N/mm]", {"relaxation": 3}),
    ],
)
def test_what_is_no_relaxation_is_neither_advised_nor_taken_for_it(
    titles, columns, write
):
    path = write(written(titles, columns=(T, F, S / 1e6)))
    with pytest.raises(em.InputError) as error:
        em.read_dma(path, kind="tensile")
    assert "relaxation" not in error.value.hint
    with refused("", "relaxation"):
        em.read_dma(path, kind="tensile", columns=columns)


def test_a_sweep_at_one_frequency_that_is_not_in_the_file(write):
    path = write(
        written(
            "T [degC],Time [s],G' [MPa],G'' [MPa]", columns=(T, F, S / 1e6, L / 1e6)
        )
    )
    with refused("", "'10 Hz'", "frequency"):
        em.read_dma(path)
    np.testing.assert_allclose(
        em.read_dma(path, columns={"frequency": "10 Hz"}).omega, 20 * np.pi
    )


def test_temperatures_that_nobody_gives(write):
    """One temperature is not advised where frequencies repeat, as in several isotherms;
    a column for each is.
    """
    text = written("f [Hz],G' [MPa],G'' [MPa]", columns=(F, S / 1e6, L / 1e6))
    with warned(em.fit.FitWarning, "'T = -20 degC'", "frequencies") as caught:
        em.read_dma(write(text))
    assert "20degC" not in str(caught[0].message)
    head, *rows = text.splitlines()
    text = "\n".join([head, "T = 0 degC", *rows[:6], "T = 20 degC", *rows[6:]])
    np.testing.assert_allclose(em.read_dma(write(text)).temperature, T + 273.15)


def test_advice_on_the_command_line(tmp_path, monkeypatch, capsys):
    """The same material as from the file whose titles are right."""
    rows = measure(KNOWN, np.arange(-10.0, 31.0, 10.0), np.geomspace(0.1, 50, 9))
    plain_csv(tmp_path, rows)
    content = (tmp_path / "plain.csv").read_text()
    (tmp_path / "odd.csv").write_text(
        content.replace("G_storage_pa,G_loss_pa", "stiff,damp")
    )
    monkeypatch.chdir(tmp_path)
    assert main(["fit", "odd.csv"]) == 2
    assert "as --column ROLE=N," in capsys.readouterr().err
    odd = [
        "odd.csv",
        "--column",
        "storage=3 [Pa]",
        "--column",
        "loss=damp [Pa]",
        "--kind",
        "shear",
    ]
    for arguments in (["plain.csv"], odd):
        assert (
            main(["fit", *arguments, "--name", "rubber", "--out", arguments[0][:-4]])
            == 0
        )
    one, two = (
        (tmp_path / folder / "rubber-prony.csv").read_text()
        for folder in ("plain", "odd")
    )
    assert one.replace("plain.csv", "odd.csv") == two


@pytest.mark.parametrize(
    ("text", "given"),
    [
        ("v,mu,T [degC]", {"columns": {"velocity": "1 [mm/s]"}}),
        ("v [mm/s],mu,T", {"columns": {"temperature": "3 [degC]"}}),
        ("v [mm/s],slip,T [degC]", {"columns": {"mu": 2}}),
        ("v [mms],mu,T [degC]", {"columns": {"velocity": "1 [mm/s]"}}),
        ("v [km/s],mu,T [degC]", {"columns": {"velocity": "1 [mm/s]"}}),
        ("v [mm/s],mu,T [K]", {"columns": {"temperature": "3 [degC]"}}),
        ("v [mm/s],mu,T [degC],speed [mm/s]", {"columns": {"velocity": 1}}),
    ],
)
def test_friction(text, given, write):
    rows = [(50, 0.5, 20, 10), (2000, 0.7, 20, 20)]
    path = write(written(text, columns=np.array(rows).T[: text.count(",") + 1]))
    with pytest.raises(em.InputError) as error:
        em.read_friction(path)
    key = next(iter(given))
    assert (
        f"columns={{{next(iter(given['columns']))!r}: "
        if key == "columns" and "slip" not in text
        else "columns={'ROLE': N}"
        if key == "columns"
        else key
    ) in str(error.value)
    found = em.read_friction(path, **given)
    np.testing.assert_allclose(
        [found.velocity, found.mu, found.temperature],
        [[0.05, 2.0], [0.5, 0.7], [293.15] * 2],
    )


@pytest.mark.parametrize(
    ("titles", "factor", "advice", "given"),
    [
        (
            "q [1/m],C [m^4]",
            1.0,
            ("wave_number", "'2 pi/lambda'"),
            {"wave_number": "2 pi/lambda"},
        ),
        ("q,C [m^4]", 1.0, ("q_unit", "'rad/m'"), {"q_unit": "rad/m"}),
        ("q [rad/m],C", 1.0, ("c_unit", "'m^4'"), {"c_unit": "m^4"}),
        (
            "1/lambda [rad/m],C [m^4]",
            1.0,
            ("q_unit", "'rad/m'"),
            {"q_unit": "rad/m"},
        ),
        (
            "1/lambda [rad/m],C [m^4]",
            1 / (2 * np.pi),
            ("q_unit", "'cycles/m'"),
            {"q_unit": "cycles/m"},
        ),
        ("n,q [rad/m],C [m^4]", 1.0, ("columns", "columns ="), {"columns": (2, 3)}),
    ],
)
def test_spectra(titles, factor, advice, given, write):
    q = np.geomspace(1e3, 1e5, 21)
    columns = (q * factor, 1e-15 * (q / 1e3) ** -3.6)
    path = write(
        written(
            titles,
            columns=(np.arange(21), *columns) if titles.startswith("n") else columns,
        )
    )
    with refused(*advice):
        em.read_spectrum(path, convention="2d")
    np.testing.assert_allclose(
        em.read_spectrum(path, convention="2d", **given).q_high, 1e5
    )


def test_a_message_lists_the_first_of_many_columns(tmp_path):
    """As of a file whose line ends were lost: one row of hundreds of columns."""
    path = tmp_path / "wide.csv"
    path.write_text(
        "x" * 900 + "".join(f",c{i}" for i in range(399)) + "\n" + ",".join("1" * 400)
    )
    with pytest.raises(em.InputError, match="24: c22, and 376 more") as said:
        em.read_dma(path)
    assert len(str(said.value)) < 900
