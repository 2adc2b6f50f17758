"""A material from Shore A alone: Gent's modulus, the spectrum of a library material,
graded as an estimate.
"""

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.material.validity import misfit

from ..material.check import check_material
from ..refused import refused


# by hand from the paper
@pytest.mark.parametrize(
    ("shore", "modulus"), [(40, 1.689e6), (60, 3.605e6), (80, 9.349e6)]
)
def test_the_modulus_is_that_of_gent(shore, modulus):
    rubber = em.fit.from_hardness(shore)
    assert float(rubber.at(296.15).tensile().relaxation(3.0)) == pytest.approx(
        modulus, rel=2e-3
    )
    other = em.load_material("sbr-gum-like")
    np.testing.assert_allclose(
        rubber.loss_tangent([1.0, 1e3]), other.loss_tangent([1.0, 1e3])
    )
    assert [float(x) for x in misfit(rubber, 1.0, 1e3)] == [1.0, 1.0]  # a factor of two


@pytest.mark.parametrize("like", em.materials())
def test_like_each_material_of_the_library(like):
    """Those without a shift law are known at 23 degC as they are."""
    if not isinstance(em.load_material(like), em.Prony):
        with pytest.raises(em.InputError, match="like must be a Prony"):
            em.fit.from_hardness(70, like=like)
        return
    if not em.load_material(like).equilibrium > 0:
        with pytest.raises(em.InputError, match="like must be a rubber"):
            em.fit.from_hardness(70, like=like)
        return
    rubber = em.fit.from_hardness(70, like=like)
    read = rubber if rubber.shift is None else rubber.at(296.15)
    assert float(read.tensile().relaxation(3.0)) == pytest.approx(5.520e6, rel=1e-3)


def test_like_a_material_that_is_known_elsewhere_only():
    cold = em.Prony(
        1e6,
        [1e6],
        [1.0],
        name="cold",
        range=em.load_material("nbr-linder").range._replace(
            temperature=(253.15, 263.15)
        ),
    )
    with refused("like", 23):
        em.fit.from_hardness(70, like=cold)


def test_refusals():
    for shore, like, said in (
        (95, "sbr-gum-like", "shore_a must be 20 to 90"),
        (60, "nothing", "like must be in the library"),
    ):
        with pytest.raises(em.InputError, match=said):
            em.fit.from_hardness(shore, like=like)


def test_the_command_line(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert (
        main(
            [
                "fit",
                "--shore-a",
                "65",
                "--like",
                "natural-rubber-like",
                "--name",
                "sole",
            ]
        )
        == 0
    )
    assert "within a factor of two" in capsys.readouterr().out
    assert check_material("sole.toml") == []
    assert 'grade = "estimated"' in (tmp_path / "sole.toml").read_text()
    assert main(["fit"]) == main(["fit", "a.csv", "--shore-a", "65"]) == 2
    assert "--shore-a" in capsys.readouterr().err
