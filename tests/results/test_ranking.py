"""Rankings of materials: order, place, what is significant, table, figure and the
command.
"""

import csv

import matplotlib.pyplot as plt
import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.material.validity import Range
from elastomdr.trees import replaced

from ..refused import refused

ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
V = np.geomspace(1e-3, 1.0, 4)


def rubber(name, scale, misfit):
    """Loss in proportion to `scale`; the loss modulus is known to `misfit`, not at all
    for None.
    """
    rows = (
        ()
        if misfit is None
        else tuple((10.0**k, misfit, misfit) for k in np.arange(-2, 12, 0.25))
    )
    known = None if misfit is None else Range((1e-3, 1e12), None, misfit=rows)
    return em.Prony(
        1e6, np.full(9, scale * 2e5), np.logspace(-8, 0, 9), name=name, range=known
    )


def curve(*rubbers):
    return em.friction(list(rubbers), ROAD, velocity=V, pressure=3e5)


def test_order_place_and_what_is_significant():
    one = curve(
        rubber("low", 1.0, 0.05), rubber("high", 1.5, 0.05), rubber("near", 1.52, 0.05)
    )
    found = one.ranking(velocity=V[1])
    assert [place.material for place in found.places] == ["near", "high", "low"]
    assert [place.significant for place in found.places] == [False, True, None]
    for place in found.places:
        assert place.mu == pytest.approx(one.select(place.material).mu[1], rel=1e-13)
        assert place.uncertainty == pytest.approx(
            one.select(place.material).error[1], rel=1e-12
        )
    mu = [place.mu for place in found.places]
    assert found.places[0].ahead == pytest.approx(mu[0] - mu[1], rel=1e-12)
    assert np.isnan(found.places[2].ahead)
    assert "ahead by" in repr(found)
    assert "not significant" in repr(found)
    middle = one.ranking()
    assert middle.velocity == pytest.approx(np.sqrt(V[0] * V[-1]))
    assert (middle.temperature, middle.pressure) == (None, pytest.approx(3e5))


def test_what_no_fit_tells_is_not_known():
    found = curve(rubber("low", 1.0, None), rubber("high", 1.5, 0.05)).ranking(
        velocity=1e-2
    )
    assert np.isnan(found.places[1].uncertainty)
    assert found.places[0].significant is None
    assert "not known whether significant" in found.summary()


def test_beyond_the_data_of_either_nothing_is_significant():
    measured = rubber("high", 1.5, 0.05)
    narrow = replaced(measured, range=measured.range._replace(omega=(1e-3, 10.0)))
    for pair in (
        (narrow, rubber("low", 1.0, 0.05)),
        (rubber("low", 1.0, 0.05), narrow),
    ):
        with pytest.warns(em.ExtrapolationWarning):
            one = curve(*pair)
        first, _ = one.ranking(velocity=V[1]).places
        assert first.ahead > first.uncertainty
        assert first.significant is None
        assert "not known whether significant" in first.words()


def test_a_point_without_an_answer_is_last():
    one = curve(rubber("low", 1.0, 0.05), rubber("high", 1.5, 0.05))
    one.mu[1, 2] = np.nan
    assert [place.material for place in one.ranking(velocity=V[2]).places] == [
        "low",
        "high",
    ]


def test_bad_input():
    one = curve(rubber("low", 1.0, 0.05), rubber("high", 1.5, 0.05))
    with refused("velocity", "friction law"):
        one.ranking(velocity=20.0)
    with pytest.raises(em.InputError, match="material must be a list"):
        one.select("low").ranking()
    with refused("temperature", "left out"):
        one.ranking(temperature=293.15)


SCENE = """title = "Two of them"
material = ["epdm-70", "tread-winter-synthetic"]
temperature = "20 degC"
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.5
longest = "5 mm"
shortest = "0.2 mm"
[contact]
pressure = "0.3 MPa"
velocity = { from = "1e-3 m/s", to = "1e-1 m/s", points = 3 }
"""


def test_command(tmp_path, capsys):
    (tmp_path / "two.toml").write_text(SCENE + '[compare]\nvelocity = "1e-2 m/s"\n')
    assert main(["compare", str(tmp_path / "two.toml"), "--out", str(tmp_path)]) == 0
    assert "ranking   by friction at 0.01 m/s" in capsys.readouterr().out
    lines = [
        x
        for x in (tmp_path / "two-compare.csv").read_text().splitlines()
        if not x.startswith("#")
    ]
    rows = list(csv.DictReader(lines))
    assert [row["rank"] for row in rows] == ["1", "2"]
    asked = [em.load_material(row["material"]) for row in rows]
    road = em.SelfAffine(
        0.8, rms_slope=0.5, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 2e-4
    )
    mu = em.friction(asked, road, velocity=1e-2, temperature=293.15, pressure=3e5).mu
    assert [float(row["friction coefficient [-]"]) for row in rows] == pytest.approx(
        list(mu), rel=1e-5
    )
    assert mu[0] > mu[1]
    image = plt.imread(tmp_path / "two-compare.png")
    assert np.ptp(image[..., :3]) > 0.5
    plt.close("all")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (
            ("", '[compare]\nvelocity = "9 m/s"'),
            "[compare] velocity",
        ),
        (
            ('["epdm-70", "tread-winter-synthetic"]', '"epdm-70"'),
            "material must be a list",
        ),
        (("", "[compare]\nspeed = 1"), "speed"),
    ],
)
def test_bad_scenes(change, said, tmp_path, capsys):
    scene = SCENE.replace(*change) if change[0] else SCENE + change[1]
    (tmp_path / "two.toml").write_text(scene)
    assert main(["compare", str(tmp_path / "two.toml"), "--out", str(tmp_path)]) == 2
    assert said in capsys.readouterr().err
    (tmp_path / "two.toml").write_text(SCENE + "[compare]\n")
    assert main(["friction", str(tmp_path / "two.toml"), "--out", str(tmp_path)]) == 2
    assert "elastomdr compare" in capsys.readouterr().err
