"""Creep and relaxation are responses to one step of stress or strain that is held: this
is tested, whatever the titles say.
"""

import contextlib

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning

from ..refused import refused, warned
from .cases import twins

SHEAR = {"kind": "shear", "temperature": 296.15}
EQUILIBRIUM, BRANCH, TAU = 1e5, 2e5, 20.0  # [Pa, Pa, s]
STRESS = 5000.0  # [Pa]
TIME = np.geomspace(0.5, 300, 25)


def compliance(t):
    """J(t) of the standard solid."""
    stiff = EQUILIBRIUM + BRANCH
    retarded = TAU * stiff / EQUILIBRIUM
    share = np.exp(-np.maximum(t, 0) / retarded) * (1 / stiff - 1 / EQUILIBRIUM)
    return np.where(t > 0, 1 / EQUILIBRIUM + share, 0.0)


def relaxation(t):
    return EQUILIBRIUM + BRANCH * np.exp(-np.asarray(t) / TAU)


def table(titles, *columns, mark=","):
    rows = zip(*columns, strict=True)
    return "\n".join([titles, *(mark.join(f"{x:.8g}" for x in row) for row in rows)])


HEAD = "Meas. Pts.\tTime\tShear Stress\tStrain\tCreep Compliance\tTorque\n"
UNITS = "\t[s]\t[Pa]\t[%]\t[1/Pa]\t[µNm]"


def interval(number, time, stress, strain):
    """An interval of a rheometer's export; J is 0 where nothing is held."""
    j = np.where(stress > 0, strain / np.maximum(stress, 1.0), 0.0)
    columns = np.arange(1, time.size + 1), time, stress, 100 * strain, j, 0.02 * stress
    body = table(HEAD + UNITS, *columns, mark="\t")
    return f"Interval:\t{number}\nNumber of Data Points:\t{time.size}\n\n{body}\n\n"


def rheometer(*intervals):
    return (
        "Data Series Information\nName:\trubber A creep recovery 1\nNumber of "
        f"Intervals:\t{len(intervals)}\n\n"
        + "".join(interval(i, *one) for i, one in enumerate(intervals, 1))
    )


CREEP = (TIME, np.full(25, STRESS), STRESS * compliance(TIME))
LATER = 300 + TIME
RECOVERED = STRESS * (compliance(LATER) - compliance(TIME))
RECOVERY = (LATER, np.zeros(25), RECOVERED)
AGAIN = (600 + TIME, np.full(25, STRESS), RECOVERED[-1] + STRESS * compliance(TIME))


def holds_first_creep(dma, rtol=1e-5):
    assert dma.response == "creep"
    np.testing.assert_allclose(dma.time, TIME, rtol=rtol)
    np.testing.assert_allclose(1 / dma.relaxation, compliance(TIME), rtol=rtol)


def test_creep_followed_by_recovery(tmp_path):
    made, *shared = twins(
        tmp_path, "creep_then_recovery.txt", rheometer(CREEP, RECOVERY)
    )
    with warned(FitWarning, "stress", "from line 4"):
        holds_first_creep(em.read_dma(made, **SHEAR))
    for path in shared:
        with warned(FitWarning, 41, "held over time"):
            dma = em.read_dma(path, **SHEAR)
        assert dma.time.size == 25
        assert 1 / dma.relaxation[-1] == pytest.approx(3.77e-6, rel=2e-3)


@pytest.mark.parametrize("restarts", [False, True])
def test_of_cycles_the_first_creep_is_read(tmp_path, restarts):
    """The second creep has the recovery of the first in it."""
    again = (TIME, *AGAIN[1:]) if restarts else AGAIN
    file = tmp_path / "cycles.txt"
    file.write_text(rheometer(CREEP, RECOVERY, again))
    said = "a second creep at one temperature" if restarts else "count on from the step"
    with pytest.warns(FitWarning) as caught:
        holds_first_creep(em.read_dma(file, **SHEAR))
    for one, word in zip(caught, ("is not held", said), strict=True):
        assert word in str(one.message)


def test_cycles_in_one_table(tmp_path):
    columns = [np.concatenate(of) for of in zip(CREEP, RECOVERY, AGAIN, strict=True)]
    file = tmp_path / "cycles.csv"
    file.write_text(table("time [s],stress [Pa],strain [-]", *columns))
    with warned(FitWarning, 50, 27):
        holds_first_creep(em.read_dma(file, **SHEAR))
    # a compliance alone: it falls where the stress is taken away
    file.write_text(table("time [s],J(t) [1/Pa]", columns[0], columns[2] / STRESS))
    with warned(FitWarning, "creep falls there"), warned(FitWarning, UNTOLD):
        dma = em.read_dma(file, **SHEAR)
    assert 25 <= dma.time.size <= 35  # elastic recovery is a third of it
    np.testing.assert_allclose(1 / dma.relaxation[:25], compliance(TIME), rtol=1e-5)


def ramped(t):
    """Strain under a stress that rises as 50 Pa/s t: int_0^t J ds times the rate."""
    stiff = EQUILIBRIUM + BRANCH
    retarded = TAU * stiff / EQUILIBRIUM
    grown = retarded * -np.expm1(-t / retarded) * (1 / stiff - 1 / EQUILIBRIUM)
    return 50.0 * (t / EQUILIBRIUM + grown)


@pytest.mark.parametrize("count", [30, 400])
@pytest.mark.parametrize("spaced", [np.geomspace, np.linspace])
def test_a_ramp_of_stress_is_no_creep(tmp_path, spaced, count):
    """Read as creep it has half of G'' at 0.2 rad/s, with residuals of 0.13 %."""
    t = spaced(0.5, 200, count)
    stress, strain = 50 * t, ramped(t)
    titles = (
        "time [s],shear stress [Pa],shear strain [%],creep compliance J [1/Pa]",
        "time [s],shear stress [Pa],shear strain [%],relaxation modulus G(t) [Pa]",
    )
    for title, last in zip(titles, (strain / stress, stress / strain), strict=True):
        text = table(title, t, stress, 100 * strain, last)
        for path in twins(tmp_path, "stress_ramp_with_compliance.csv", text):
            with refused("", 2, "held over time"):
                em.read_dma(path, **SHEAR)


def test_a_compliance_and_a_stress_that_is_not_held(tmp_path):
    """A flow curve, without a strain: the stress alone says it."""
    file = tmp_path / "flow.csv"
    t = np.linspace(1, 100, 50)
    columns = t, np.repeat(np.linspace(100, 1000, 25), 2), compliance(t)
    file.write_text(table("time [s],stress [Pa],compliance [1/Pa]", *columns))
    with refused("", "stress"):
        em.read_dma(file, **SHEAR)


def test_a_strain_and_a_compliance_say_what_the_stress_was(tmp_path):
    """Their quotient is the stress, held in creep and not in a ramp."""
    t, file = np.geomspace(0.5, 200, 40), tmp_path / "strain.csv"
    title = "time [s],shear strain [%],creep compliance J [1/Pa]"
    file.write_text(table(title, t, 100 * ramped(t), ramped(t) / (50 * t)))
    with refused("", "stress"):
        em.read_dma(file, **SHEAR)
    # constant by construction where J is strain over what was set: nothing tells
    file.write_text(table(title, t, 100 * STRESS * compliance(t), compliance(t)))
    with warned(FitWarning, UNTOLD):
        read = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(1 / read.relaxation, compliance(t), rtol=1e-6)


UNTOLD = "nothing in the file tells"
T = np.geomspace(0.5, 200, 40)
GROWN = ramped(T)
START_UP = 0.01 * (EQUILIBRIUM * T - BRANCH * TAU * np.expm1(-T / TAU))
NOT_HELD = {
    "time [s],torque [mNm],J [1/Pa]": (T, 0.05 * T, GROWN / (50 * T)),
    "t [s],tau [Pa],J [1/Pa]": (T, 50 * T, GROWN / (50 * T)),
    "t [s],tau,J [1/Pa]": (T, 50 * T, GROWN / (50 * T)),
    "t [s],deflection [mm],J(t) [1/Pa]": (T, GROWN, GROWN / (50 * T)),
    "time [s],static force [N],deflection [mm],compliance [1/Pa]": (
        *(T, -5 * T, -GROWN, GROWN / (50 * T)),
    ),
    "time [s],deflection angle [mrad],G(t) [Pa]": (T, GROWN, 50 * T / GROWN),
    "time [s],force [N],relaxation modulus [Pa]": (T, 5 * T, 50 * T / GROWN),
    "time [s],shear rate [1/s],relaxation modulus [Pa]": (
        *(T, 0 * T + 0.01, START_UP / (0.01 * T)),
    ),
    "time [s],strain rate [1/s],compliance [1/Pa]": (
        *(T, 0 * T + 0.01, 0.01 * T / START_UP),
    ),
}

RAMP = (50 * T, GROWN / (50 * T), 50 * T / GROWN)  # stress, "J", "G"
for varies in (
    *("engineering stress [Pa]", "true stress [MPa]", "sigma_xy", "P", "F [N]"),
    *("Standardkraft", "Standardkraft [N]", "M [mNm]", "load [kg]", "P [V]"),
):
    NOT_HELD[f"t [s],{varies},J [1/Pa]"] = (T, RAMP[0], RAMP[1])
    NOT_HELD[f"t [s],{varies},G(t) [Pa]"] = (T, RAMP[0], RAMP[2])
for varies in ("Traverse", "Traverse [mm]", "crosshead", "eps [%]", "twist [mrad]"):
    NOT_HELD[f"t [s],{varies},J [1/Pa]"] = (T, GROWN, RAMP[1])
    NOT_HELD[f"t [s],{varies},G(t) [Pa]"] = (T, GROWN, RAMP[2])
NOT_HELD |= {
    "t [s],stretch,G(t) [Pa]": (T, 1 + 0.01 * T, START_UP / (0.01 * T)),
    "t [s],gamma dot,G(t) [Pa]": (T, 0 * T + 0.01, START_UP / (0.01 * T)),
    "t [s],gamma dot [1/s],J [1/Pa]": (T, 0 * T + 0.01, 0.01 * T / START_UP),
    "t [s],speed [1/min],J [1/Pa]": (T, 0.02 * T, RAMP[1]),
    "t [s],viscosity [Pa s],G(t) [Pa]": (T, START_UP / 0.01, START_UP / (0.01 * T)),
    "t [s],viscosity,G(t) [Pa]": (T, START_UP / 0.01, START_UP / (0.01 * T)),
    # what is held here is the other of both
    "t [s],P,J [1/Pa]": (T, relaxation(T), 1 / relaxation(T)),
    "t [s],eps,G(t) [Pa]": (T, compliance(T), 1 / compliance(T)),
}


@pytest.mark.parametrize("titles", NOT_HELD)
def test_forces_angles_and_rates_say_that_nothing_was_held(tmp_path, titles):
    """Whatever is in proportion to stress or strain, by its unit or by what it does;
    the user's word is believed.
    """
    columns, file = NOT_HELD[titles], tmp_path / "test.csv"
    file.write_text(table(titles, *columns))
    with refused("", 2, "held over time"):
        em.read_dma(file, **SHEAR)
    creep = not any(one in titles for one in ("G(t)", "modulus"))
    said = {"stress": "1 kPa"} if creep else {"strain": "1 %"}
    read = em.read_dma(file, columns=said, **SHEAR)
    np.testing.assert_allclose(read.relaxation, columns[-1] ** (-1.0 if creep else 1.0))


@pytest.mark.parametrize(
    ("titles", "columns"),
    [
        ("time [s],torque [mNm],J [1/Pa]", (0 * T + 2, compliance(T))),
        ("time [s],displacement [mm],G(t) [Pa]", (0 * T - 0.1, relaxation(T))),
        ("time [s],crosshead [mm],G(t) [Pa]", (0 * T + 3, relaxation(T))),
        ("time [s],Standardkraft [N],J [1/Pa]", (0 * T + 3, compliance(T))),
        # compression with its sign
        ("time [s],stress [Pa],J [1/Pa]", (0 * T - 1000, compliance(T))),
        ("time [s],strain [%],G(t) [Pa]", (0 * T - 1, relaxation(T))),
        ("time [s],strain [-],stress [Pa]", (0 * T - 1, -relaxation(T))),
        (
            "time [s],torque [mNm],normal force [N],gap [mm],J [1/Pa]",
            (0 * T + 2, np.cos(T), 1 + T, compliance(T)),
        ),
        (
            "time [s],torque [mNm],수직력 [N],간격 [mm],J [1/Pa]",
            (0 * T + 2, np.cos(T), 1 + T, compliance(T)),
        ),
    ],
)
def test_forces_angles_and_rates_of_what_was_held(tmp_path, titles, columns):
    file = tmp_path / "test.csv"
    file.write_text(table(titles, T, *columns), encoding="utf-8")
    read = em.read_dma(file, **SHEAR)
    last = 1 / columns[-1] if "J" in titles else np.abs(columns[-1])
    np.testing.assert_allclose(read.relaxation, last, rtol=1e-6)


@pytest.mark.parametrize(
    ("titles", "scale"),
    [
        ("t [s],strain [%],J [1/Pa]", 1e5),
        ("t [s],angle [mrad],J [1/Pa]", 3.0),
        ("t [s],displacement [mm],J [1/Pa]", 3.0),
        ("t [s],P,J [1/Pa]", 3.0),
        ("t [s],stress [Pa],G(t) [Pa]", 0.01),
        ("t [s],force [N],G(t) [Pa]", 2.0),
        ("t [s],torque [mNm],G(t) [Pa]", 2.0),
        ("t [s],P [V],G(t) [Pa]", 3.0),
    ],
)
def test_what_a_column_was_made_of_proves_nothing(tmp_path, titles, scale):
    """J is strain over the stress that was set, also while it is no longer held; G is
    stress over the strain that was set, also while it is still on its way.
    """
    file, t = tmp_path / "test.csv", np.arange(1.0, 33.0)
    creep = "J" in titles
    grown = compliance(t) - np.where(t > 16, compliance(t - 16), 0.0)
    eased = np.where(t > 3, relaxation(t - 3), relaxation(0) * t / 3)
    values, rows = (grown, slice(0, 16)) if creep else (eased, slice(2, 32))
    file.write_text(table(titles, t, scale * values, values))
    with (
        warned(FitWarning, UNTOLD),
        warned(FitWarning, "falls there" if creep else "rises there"),
    ):
        read = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(read.time, t[rows])
    np.testing.assert_allclose(
        read.relaxation, values[rows] ** (-1.0 if creep else 1.0)
    )
    # it grows, or falls, all along
    wrong = compliance(t)[::-1] if creep else 50 * t
    file.write_text(table(titles, t, scale * wrong, wrong))
    with refused("", "is not held"):
        em.read_dma(file, **SHEAR)


def test_of_a_relaxation_alone_the_rise_is_cut(tmp_path):
    """A strain is ramped up in 3 s; the fall is what is wanted."""
    t, file = np.arange(1.0, 41.0), tmp_path / "rise.csv"
    modulus = np.where(t > 3, relaxation(t - 3), relaxation(0) * t / 3)
    file.write_text(table("t [s],G(t) [Pa]", t, modulus))
    with warned(FitWarning, UNTOLD), warned(FitWarning, "2 rows", "line 2"):
        dma = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(dma.relaxation, modulus[2:])


@pytest.mark.parametrize(
    "beside",
    ["measured stress [Pa]", "shear stress [kPa]", "force [N]", "Spannung real"],
)
def test_a_measured_stress_overrules_the_one_that_was_set(tmp_path, beside):
    file = tmp_path / "set.csv"
    columns = T, 0 * T + 1000, 50 * T, GROWN / (50 * T)
    file.write_text(table(f"t [s],stress [Pa],{beside},J [1/Pa]", *columns))
    with refused("", beside):
        em.read_dma(file, **SHEAR)
    file.write_text(
        table(f"t [s],stress [Pa],{beside},strain [-]", *columns[:3], GROWN)
    )
    with refused("path_or_paths", "stress"):
        em.read_dma(file, **SHEAR)
    said = em.read_dma(file, columns={"stress": "1 kPa"}, **SHEAR)
    np.testing.assert_allclose(said.relaxation, 1000 / GROWN, rtol=1e-6)


def test_a_length_beside_the_strain_of_a_creep(tmp_path):
    """It hardly varies; the strain does. A dynamic force is another matter."""
    file, strain = tmp_path / "creep.csv", 1000 * compliance(T)
    columns = T, 10 * (1 + strain), np.cos(T), 0 * T + 1000, strain
    titles = "t [s],length [mm],dynamic force [N],stress [Pa],strain [-]"
    file.write_text(table(titles, *columns))
    read = em.read_dma(file, kind="tensile", temperature=296.15)
    np.testing.assert_allclose(read.relaxation, 1 / compliance(T), rtol=1e-6)
    assert read.response == "creep"


@pytest.mark.parametrize("blocks", [False, True])
@pytest.mark.parametrize("response", ["creep", "relaxation"])
def test_times_that_begin_again_are_another_step(tmp_path, response, blocks):
    """Of the same specimen, which remembers the first."""
    t, file = np.arange(1.0, 21.0), tmp_path / "again.csv"
    loads, ratio = (1000.0, 2000.0), compliance(t)
    titles, title = "time [s],stress [Pa],J [1/Pa]", "time [s],J [1/Pa]"
    if response == "relaxation":
        loads, ratio = (0.01, 0.02), relaxation(t)
        titles, title = "time [s],strain [-],G(t) [Pa]", "time [s],G(t) [Pa]"
    for with_load in (True, False):
        runs = [
            (t, *[0 * t + load] * with_load, ratio * (1 + 0.2 * i))
            for i, load in enumerate(loads)
        ]
        heads = titles if with_load else title
        text = table(heads, *(np.concatenate(of) for of in zip(*runs, strict=True)))
        if blocks:
            parts = (table(heads, *run) for run in runs)
            text = "\n\n".join(f"Interval:\t{i}\n\n{p}" for i, p in enumerate(parts))
        file.write_text(text)
        with pytest.warns(FitWarning) as caught:
            dma = em.read_dma(file, **SHEAR)
        said = "a second" if blocks else "times begin again"
        assert any(said in str(one.message) for one in caught)
        np.testing.assert_allclose(dma.time, t)
        np.testing.assert_allclose(
            dma.relaxation, ratio ** (-1.0 if response == "creep" else 1.0)
        )


def test_blocks_with_temperatures_of_the_user_are_isotherms(tmp_path):
    file = tmp_path / "blocks.csv"
    parts = [table("time [s],G(t) [Pa]", TIME, relaxation(TIME) * i) for i in (1, 2)]
    file.write_text("\n\n".join(parts))
    said = {"kind": "shear", "temperature": [296.15, 316.15]}
    with warned(FitWarning, UNTOLD):
        assert em.read_dma(file, **said).time.size == 50


@pytest.mark.parametrize(
    "title",
    [
        "Real-time stress [Pa]",
        "temperature-compensated torque [uNm]",
        "Stress modulated [Pa]",
        "normalized stress [Pa]",
        "Real-time displacement [mm]",
        "elapsed force [N]",
    ],
)
def test_the_unit_of_a_load_wins_over_words_of_its_title(tmp_path, title):
    file = tmp_path / "ramp.csv"
    file.write_text(table(f"t [s],{title},J [1/Pa]", T, 50 * T, GROWN / (50 * T)))
    with refused("", title):
        em.read_dma(file, **SHEAR)


@pytest.mark.parametrize(
    ("title", "beside"),
    [
        ("", None),
        ("no", np.arange(1, T.size + 1)),
        ("Meas. Pts.", np.arange(1, T.size + 1) + (np.arange(T.size) > 20)),
        ("point", np.arange(10, 10 * T.size + 1, 10)),
        ("elapsed", 5 + T),
        ("humidity [%]", 40 + T / 10),
        ("shear modulus [Pa]", relaxation(T)[::-1]),
        ("status", 0 * T),
        ("normal force [N]", np.cos(T)),
        ("gap [mm]", 1 + T / 100),
        ("shear rate [1/s]", np.exp(-T)),
        ("energy [J]", T),
        ("chamber [degC]", 23 + T / 10),
        ("elapsed [min]", 5 + T / 60),
        ("torque [mNm]", 0 * T),
    ],
)
def test_where_nothing_tells_what_was_held_this_is_said(tmp_path, title, beside):
    """So where a compliance or a modulus stands alone, or beside what may vary."""
    file = tmp_path / "test.csv"
    for name, values, said, ramp in (
        ("J [1/Pa]", compliance(T), {"stress": "1 kPa"}, None),
        ("G(t) [Pa]", relaxation(T), {"strain": "1 %"}, 0.1),
    ):
        columns = [T, values] if beside is None else [T, beside, values]
        titles = ["t [s]", *[title] * (beside is not None), name]
        file.write_text(table(",".join(titles), *columns))
        with warned(FitWarning, UNTOLD):
            read = em.read_dma(file, **SHEAR)
        np.testing.assert_allclose(read.time, T)
        em.read_dma(file, columns=said, **SHEAR)
        if ramp:
            em.read_dma(file, ramp=ramp, **SHEAR)


def test_of_stairs_the_first_step_is_read(tmp_path):
    t = np.arange(1.0, 41.0)
    stress = np.where(t <= 20, 1000.0, 2000.0)
    strain = 1000 * compliance(t) + 1000 * compliance(t - 20)
    file = tmp_path / "stairs.csv"
    columns = t, stress, strain, strain / stress
    file.write_text(
        table("time [s],stress [Pa],strain [-],compliance [1/Pa]", *columns)
    )
    with warned(FitWarning, 20, 22):
        dma = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(1 / dma.relaxation, compliance(t[:20]), rtol=1e-6)


def test_a_second_step_of_strain_is_left_out(tmp_path):
    t = np.arange(1.0, 41.0)
    modulus = relaxation(t) + np.where(t > 20, relaxation(t - 20), 0.0)
    strain = np.where(t <= 20, 0.01, 0.02)
    file = tmp_path / "steps.csv"
    for titles, *columns in (
        ("time [s],strain [-],relaxation modulus [Pa]", t, strain, modulus),
        ("time [s],G(t) [Pa]", t, modulus),
    ):
        file.write_text(table(titles, *columns))
        told = len(columns) == 3
        with (
            warned(FitWarning, 20, 22),
            contextlib.nullcontext() if told else warned(FitWarning, UNTOLD),
        ):
            dma = em.read_dma(file, **SHEAR)
        np.testing.assert_allclose(dma.relaxation, relaxation(t[:20]), rtol=1e-6)


def test_intervals_of_one_step_are_one_relaxation(tmp_path):
    """A rheometer samples fast, then slowly, while the strain is held."""
    fast, slow = np.linspace(0.1, 5, 20), np.linspace(6, 100, 20)
    file = tmp_path / "relaxation.txt"
    parts = [
        f"Interval:\t{i}\n\n"
        + table(
            "Time\tStrain\tRelaxation Modulus\n[s]\t[%]\t[Pa]",
            t,
            0 * t + 1,
            relaxation(t),
            mark="\t",
        )
        for i, t in enumerate((fast, slow), 1)
    ]
    file.write_text("\n\n".join(parts))
    dma = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(dma.relaxation, relaxation(dma.time), rtol=1e-6)
    assert dma.time.size == 40


def test_times_that_count_on_at_another_temperature_are_refused(tmp_path):
    t = np.linspace(1, 100, 20)
    parts = [
        f"T = {20 + 20 * i} degC\n"
        + table("time [s],G(t) [Pa]", t + 200 * i, relaxation(t))
        for i in range(3)
    ]
    file = tmp_path / "relaxation.csv"
    file.write_text("\n".join(parts))
    with refused("", 25, "another temperature"):
        em.read_dma(file, kind="shear")


def test_stress_that_settles_is_held(tmp_path):
    """Two rows on the way up, and noise of a per cent, are no other test."""
    t = np.geomspace(0.1, 100, 40)
    stress = 1000 * (1 + 0.01 * np.sin(np.arange(40)))
    stress[:2] = 300, 800
    file = tmp_path / "creep.csv"
    columns = t, stress, 1000 * compliance(t), compliance(t)
    file.write_text(
        table("time [s],stress [Pa],strain [-],compliance [1/Pa]", *columns)
    )
    with warned(FitWarning, "2 rows", "line 2"):
        dma = em.read_dma(file, **SHEAR)
    np.testing.assert_allclose(1 / dma.relaxation, compliance(t[2:]), rtol=1e-6)


@pytest.mark.parametrize("way", [1, -1])
def test_isotherms_of_creep_in_one_table_have_stresses_of_their_own(tmp_path, way):
    """Also with the last time first; a row without a time is named as it was."""
    curves = [
        (t := TIME[::way], 0 * t + 20.0 * i, 0 * t + 1000.0 / (i + 1), compliance(t))
        for i in range(3)
    ]
    text = table(
        "time [s],T [degC],stress [Pa],compliance [1/Pa]",
        *(np.concatenate(of) for of in zip(*curves, strict=True)),
    )
    file = tmp_path / "creep.csv"
    file.write_text(text + "\n,40,333.3,1e-6")
    with warned(FitWarning, 1, 77, "time"):
        dma = em.read_dma(file, kind="shear")
    assert dma.time.size == 75
    np.testing.assert_allclose(1 / dma.relaxation, compliance(dma.time), rtol=1e-6)
