"""What a friction law does not know stays told, through files and into traction."""

import csv

import numpy as np
import pytest

import elastomdr as em
from elastomdr.errors import InputError, written
from elastomdr.results.doubts import Doubt, carried, found, from_kinds, where

from ..refused import mentions

HOLED = em.FrictionLaw(
    [0.01, 1.0, 100.0],
    [0.5, 0.6, np.nan],
    doubts=[
        Doubt("not converged", np.array([False, False, True])),
        Doubt("extrapolated", np.array([False, True, True]), "lie beyond 3 MHz", "a b"),
    ],
)
ELASTIC = em.Prony(1e6, [], [])


def test_a_law_keeps_what_did_not_converge_and_why():
    at = where(HOLED.doubts_at([0.1, 10.0]), "not converged")
    assert np.array_equal(np.asarray(at) | np.isnan(HOLED([0.1, 10.0])), [False, True])


def test_a_file_of_a_law_keeps_its_doubts(tmp_path):
    HOLED.to_csv(tmp_path / "law.csv")
    assert em.load_friction(tmp_path / "law.csv").doubts == HOLED.doubts
    text = (tmp_path / "law.csv").read_text("utf-8").replace("# doubt, ", "# ")
    (tmp_path / "curve.csv").write_text(text, "utf-8")  # as a curve's table has them
    assert em.load_friction(tmp_path / "curve.csv").doubts == HOLED.doubts


@pytest.mark.filterwarnings("ignore::elastomdr.ConvergenceWarning")
@pytest.mark.parametrize("shape", [em.Cylinder(0.3, 0.2), em.Sphere(0.1)])
def test_traction_in_a_hole_of_the_law_did_not_converge(shape):
    pulled = em.traction(
        ELASTIC,
        shape,
        velocity=100.0,
        creepage=[1e-3, 0.5],
        load=5.0,
        friction=HOLED,
    )
    assert np.asarray(pulled.converged).tolist() == [True, False]
    assert np.isnan(pulled.force).tolist() == [False, True]
    assert where(pulled.doubts, "not converged").tolist() == [False, True]


def test_traction_beyond_the_law_is_said_of_the_friction():
    law = em.FrictionLaw([1.0, 2.0], [[0.5, 0.6]], pressure=[1e3])
    for velocity in (10.0, 1e4):
        with pytest.raises(InputError) as caught:
            em.traction(
                ELASTIC,
                em.Cylinder(0.3, 0.2),
                velocity=velocity,
                creepage=0.1,
                load=5e3,
                friction=law,
            )
        assert caught.value.argument == "friction"
        assert caught.value.got is law


def test_a_curve_in_place_of_its_law():
    curve = em.rolling(ELASTIC, em.Sphere(0.1), velocity=1.0, load=1.0)
    with pytest.raises(InputError) as caught:
        em.traction(
            ELASTIC,
            em.Sphere(0.1),
            velocity=1.0,
            creepage=0.1,
            load=1.0,
            friction=curve,
        )
    assert "FrictionLaw" in caught.value.accepted
    assert ".law()" in caught.value.hint


@pytest.mark.filterwarnings("ignore::elastomdr.ExtrapolationWarning")
def test_what_friction_rests_on_is_a_result_with_its_doubts(tmp_path):
    """A row for each part of each point, in every form; read back with its doubts."""
    tread = em.Prony(1e6, [4e6, 8e6], [1e-3, 1e-5], range={"omega": (1e-2, 1e4)})
    road = em.SelfAffine(0.8, 0.7, q_low=1e3, q_high=1e5)
    curve = em.friction(
        tread, road, velocity=[[1e-3], [10.0]], pressure=[1e5, 3e5, 5e5]
    )
    held = curve.uncertainty()
    assert held.doubts == curve.doubts
    assert {doubt.kind for doubt in held.doubts} >= {"extrapolated"}
    frame, known = held.to_pandas(), held.to_xarray()
    held.to_csv(tmp_path / "held.csv")
    held.to_excel(tmp_path / "held.xlsx")
    text = (tmp_path / "held.csv").read_text("utf-8").splitlines()
    rows = [*csv.DictReader(line for line in text if not line.startswith("#"))]
    assert [row["part"] for row in rows] == frame["part"].tolist()
    np.testing.assert_array_equal(held.to_dict()["share"], held.share)
    half = held.half_band()
    for i, part in enumerate(held):
        of_part = [row for row in rows if row["part"] == part.source]
        for name, values in (
            ("velocity [m/s]", curve.velocity),
            ("friction coefficient [-]", curve.mu),
            ("share [-]", part.share),
            ("half of the band [-]", half),
        ):
            read = [float(row[name] or np.nan) for row in of_part]
            np.testing.assert_array_equal(read, np.broadcast_to(values, (2, 3)).ravel())
        back = from_kinds([row["doubts"] for row in of_part], text)
        assert back == carried(held.doubts, np.ravel)
        at = known["share"].sel(part=part.source, velocity=10.0, pressure=3e5)
        np.testing.assert_array_equal(at, held.share[i, 1, 1])
    one = held.at([4])  # the same point, of the raveled curve
    np.testing.assert_array_equal(one.share[:, 0], held.share[:, 1, 1])
    assert one.doubts == found(carried(held.doubts, lambda at: np.ravel(at)[[4]]))
    assert all(mentions(held.summary(), doubt.kind) for doubt in held.doubts)


def test_of_rubber_of_one_temperature_that_is_not_known():
    scene = {"velocity": 1.0, "pressure": 3e5}
    road = em.SelfAffine(0.8, 0.7, q_low=1e3, q_high=1e5)
    held = em.friction(em.Prony(1e6, [4e6], [1e-3]), road, **scene).uncertainty()
    assert np.isnan(held["temperature"].share)
    tests = [each.test for each in held.surer() if np.isnan(each.after)]
    assert held["temperature"].test in tests
    assert mentions(held["temperature"].test, "DMA")


def test_a_class_of_models_is_written():
    assert "Line" in written(em.Line)


def test_the_ring_of_another_rubber():
    ring = em.o_ring(
        em.load_material("epdm-70"),
        diameter=5e-3,
        squeeze=0.2,
        time=1.0,
        temperature=293.15,
    )
    with pytest.raises(InputError) as caught:
        em.leak(
            ELASTIC,
            em.SelfAffine(0.8, rms_slope=0.1, q_low=1e4, q_high=1e6),
            o_ring=ring,
            pressure_drop=1e5,
            viscosity=1e-3,
        )
    assert caught.value.argument == "material"
    assert "temperature" in caught.value.hint


def test_the_place_of_a_material_that_is_refused():
    rubber = em.load_material("epdm-70")
    for i, pair in enumerate([[ELASTIC, rubber], [rubber, ELASTIC]]):
        with pytest.raises(InputError) as caught:
            em.rolling(pair, em.Sphere(0.1), velocity=1.0, load=1.0, temperature=293.15)
        assert f"material[{i}]" in str(caught.value)
    with pytest.raises(InputError) as caught:
        em.rolling(
            [rubber] * 2, em.Sphere(0.1), velocity=1.0, load=-1.0, temperature=293.15
        )
    assert "material" not in str(caught.value)
