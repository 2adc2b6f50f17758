"""Strain amplitudes: sweeps of strain and of frequency are two things, and two strains
are not one sample.
"""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.fit import FitWarning

from ..refused import mentions, refused
from .dma_files import KNOWN, isotherms, measure

SMALL = measure(KNOWN, np.arange(-10.0, 41.0, 10.0), np.geomspace(0.1, 50, 7))
LARGE = SMALL * [1, 1, 0.6, 0.8]
AMPLITUDES = np.geomspace(0.01, 20, 12)  # per cent
PAYNE = np.array(
    [
        (10.0, 20.0, 4e6 / (1 + x) + 1.5e6, 6e5 * np.sqrt(x) / (1 + x) + 2e5)
        for x in AMPLITUDES
    ]
)
TITLES = "f [Hz],T [degC],G' [Pa],G'' [Pa]"


def written(*sweeps, title="Strain [%]"):
    """Rows below titles, with the strain in front."""
    rows = [
        (s, *row)
        for strain, sweep in sweeps
        for s, row in zip(np.broadcast_to(strain, len(sweep)), sweep, strict=True)
    ]
    return "\n".join(
        [f"{title},{TITLES}", *(",".join(f"{x:.12g}" for x in row) for row in rows)]
    )


@pytest.mark.parametrize(
    "title",
    [
        "Strain [%]",
        "Oscillation strain (%)",
        "\u03b3 / %",
        "strain_dyn_pct",
        "Dehnung/%",
    ],
)
def test_a_sweep_of_strain(title, write):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        dma = em.read_dma(write(written((AMPLITUDES, PAYNE), title=title)))
    np.testing.assert_allclose(dma.strain, AMPLITUDES / 100)
    assert dma.strain_sweeps().size == AMPLITUDES.size
    assert "strain amplitude 0.01 to 20 %" in dma.summary()
    shown = dma._repr_html_()
    for each in dma.summary().split(", "):
        assert each in shown
    with refused("dma", 0.01, 20, "em.fit.softening"):
        em.fit.master_curve(dma)


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_a_sweep_of_strain_and_sweeps_of_frequency_in_one_file(write):
    both = em.read_dma(write(written((0.1, SMALL), (AMPLITUDES, PAYNE))))
    np.testing.assert_allclose(np.sort(both.strain_sweeps().strain), AMPLITUDES / 100)
    master = em.fit.master_curve(both, 293.15)
    alone = em.fit.master_curve(em.read_dma(write(written((0.1, SMALL)))), 293.15)
    np.testing.assert_array_equal(master.log10_a, alone.log10_a)
    assert mentions(master.dma.warnings, "12 points", 0.01, 20)
    assert ("strain", "0.1 %") in list(master.findings())


@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_sweeps_at_two_strains_are_not_one_sample(write, tmp_path, monkeypatch, capsys):
    path = write(written((0.1, SMALL), (5.0, LARGE)), "two.csv")
    two = em.read_dma(path)
    fit = em.fit.material(two, 293.15)
    alone = em.fit.material(em.read_dma(write(written((0.1, SMALL)))), 293.15)
    np.testing.assert_array_equal(fit.material.moduli, alone.material.moduli)
    assert mentions(fit.warnings, "0.1 % is used", "5 % left out")
    assert fit.misfit == alone.misfit
    np.testing.assert_allclose(two.at_strain(0.05).storage, LARGE[:, 2])
    with refused("strain", 0.1, 5, 0.02):
        two.at_strain(0.02)
    monkeypatch.chdir(tmp_path)
    given = ["--strain", "5%", "--reference", "20degC", "--verbose"]
    assert main(["fit", str(path), *given]) == 0
    assert "strain          5 %" in capsys.readouterr().out
    assert "strain amplitude of 5 %" in (tmp_path / "two.toml").read_text()


def test_strains_that_follow_the_temperature_are_one_sample(write):
    """A rheometer that holds its torque: no temperature and frequency at two
    strains.
    """
    dma = em.read_dma(write(written((10 ** (SMALL[:, 1] / 20 - 1), SMALL))))
    assert em.fit.master_curve(dma, 293.15).dma.size == SMALL.shape[0]


def test_a_strain_without_a_unit(write):
    """Asked for where it varies; passed over where it is one number for all."""
    assert np.isnan(
        em.read_dma(write(written((0.1, SMALL), title="Strain"))).strain
    ).all()
    path = write(written((0.1, SMALL), (5.0, LARGE), title="Strain"))
    with refused("", 1, "'Strain'", "columns={'strain'", "'1"):
        em.read_dma(path)
    np.testing.assert_allclose(
        np.unique(em.read_dma(path, columns={"strain": "1 [%]"}).strain), [0.001, 0.05]
    )


def test_joining_and_copies_keep_the_strain(write):
    one, two = (em.read_dma(write(written((x, SMALL)), f"{x}.csv")) for x in (0.1, 5.0))
    both = em.fit.join(one, two, em.fit.dma([1.0], [1e6], [1e5], 293.15, kind="shear"))
    np.testing.assert_allclose(
        both.strain, np.r_[np.full(len(SMALL), 1e-3), np.full(len(SMALL), 0.05), np.nan]
    )
    with pytest.warns(FitWarning, match="no temperature"):
        assert np.isnan(
            em.read_dma(write("f [Hz],G' [Pa],G'' [Pa]\n1,2e6,1e5\n2,2e6,1e5")).strain
        ).all()


@pytest.mark.parametrize("strain", [True, False])
@pytest.mark.filterwarnings("ignore::elastomdr.fit.FitWarning")
def test_steps_of_a_file_are_told_apart(strain, write):
    """An amplitude sweep as step 1, sweeps of frequency after it; without strains it is
    left out when read.
    """
    steps = [(1, AMPLITUDES, PAYNE)] + [
        (2 + i, 0.1, part) for i, part in enumerate(isotherms(SMALL))
    ]
    rows = [
        (n, *([x] * strain), *row)
        for n, a, part in steps
        for x, row in zip(np.broadcast_to(a, len(part)), part, strict=True)
    ]
    titles = "Step," + "Strain [%]," * strain + TITLES
    path = write(
        "\n".join([titles, *(",".join(f"{x:.12g}" for x in row) for row in rows)])
    )
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        dma = em.read_dma(path)
    assert [("12 points in steps" in str(one.message)) for one in caught] == [True] * (
        not strain
    )
    assert dma.strain_sweeps().size == AMPLITUDES.size * strain
    fit = em.fit.master_curve(dma, 293.15)
    assert fit.dma.size == len(SMALL)


def test_a_step_column_stands_for_the_isotherms(write):
    """One temperature for each step, where no column has them."""
    parts = isotherms(SMALL)
    rows = [(i, row[0], *row[2:]) for i, part in enumerate(parts) for row in part]
    path = write(
        "\n".join(
            [
                "Set,f [Hz],G' [Pa],G'' [Pa]",
                *(",".join(f"{x:.12g}" for x in row) for row in rows),
            ]
        )
    )
    celsius = np.array([part[0, 1] for part in parts])
    np.testing.assert_allclose(
        em.read_dma(path, temperature=celsius + 273.15).temperature,
        SMALL[:, 1] + 273.15,
    )
