"""`em.cite`: the publications that a result used, as BibTeX."""

import re

import pytest

import elastomdr as em


def keys(text):
    return re.findall(r"^@\w+{(.*),$", text, re.MULTILINE)


def test_of_smooth_and_rough_bodies():
    rubber = em.load_material("epdm-70")
    ball = em.friction(rubber, em.Sphere(5e-3), velocity=0.1, load=1.0)
    cited = em.cite(ball)
    assert keys(cited) == [
        "elastomdr",
        "popov-hess-2015",
        "radok-1957",
        "material-epdm-70",
    ]
    assert f"version = {{{em.__version__}}}" in cited
    assert r"tf\_015p" in cited  # where the numbers of the material come from
    road = em.SelfAffine(0.8, rms_slope=1.0, q_low=1e3, q_high=1e4)
    shear = em.AdhesiveShear(5e6, 1e-3, 0.1)
    dry = em.friction(
        rubber, road, velocity=0.1, pressure=1e5, temperature=293.15, adhesion=shear
    )
    assert keys(em.cite(dry)) == [
        "elastomdr",
        "persson-2001",
        "lorenz-2015",
        "material-epdm-70",
    ]


def test_of_several_materials_and_of_your_own():
    own = em.Prony(1e6, [1e6], [1e-3], name="own")
    pair = [own, em.load_material("nbr-linder")]
    both = em.rolling(pair, em.Cylinder(0.05, 0.1), velocity=1.0, load=10.0)
    assert keys(em.cite(both)) == [
        "elastomdr",
        "radok-1957",
        "johnson-1985",
        "material-nbr-linder",
    ]


def test_only_results_have_references():
    for given in (em.Sphere(1.0), 3):
        with pytest.raises(em.InputError) as error:
            em.cite(given)
        assert error.value.argument == "result"
        assert error.value.got is given
