"""Draws of a material and of a surface: as wide as what is known, carried by friction
as one curve with its band.
"""

import tomllib
import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.cli.main import main

VELOCITY = np.geomspace(1e-4, 1, 9)
BALL = {"velocity": VELOCITY, "load": 1.0, "temperature": 293.15}
ROAD = em.SelfAffine(0.8, rms_slope=0.7, q_low=1e3, q_high=3e5)
LAW = em.WLF(8.9, 101.6, 293.15)


def true(vertical=None):
    moduli, times = 10 ** np.linspace(8.5, 5.2, 24), np.logspace(-9, 2, 24)
    return em.Prony(1e6, moduli, times, shift=LAW, vertical=vertical)


def measured(seed=0, material=None):
    rng, rows = np.random.default_rng(seed), []
    omega, material = np.geomspace(0.1, 300, 10), material or true()
    for kelvin in 293.15 + np.arange(-40, 51, 15.0):
        own = material.at(kelvin)
        noisy = [
            x * np.exp(0.03 * rng.standard_normal(omega.size))
            for x in (own.storage(omega), own.loss(omega))
        ]
        rows.append((np.full(omega.size, kelvin), omega, *noisy))
    return em.fit.Dma(*map(np.concatenate, zip(*rows, strict=True)), kind="shear")


@pytest.fixture(scope="module")
def fit():
    return em.fit.material(measured(), 293.15, name="tread")


def test_draws_scatter_as_the_bands_say(fit):
    draws = fit.draws(300)
    omega = np.geomspace(*fit.prony.window, 25)
    band = fit.prony.band(omega)
    for name, high in (("storage", band.storage_high), ("loss", band.loss_high)):
        scatter = np.std([np.log(getattr(each, name)(omega)) for each in draws], axis=0)
        reported = np.log(high / getattr(band, name)) / 1.96
        assert 0.75 < np.median(scatter / reported) < 1.15, name
        assert (scatter < 1.6 * reported).all()
    std = fit.master.laws["WLF"].std
    for key, size in std.items():
        assert np.std([getattr(each.shift, key) for each in draws]) == pytest.approx(
            size, rel=0.2
        )
    again, other = fit.draws(3), fit.draws(3, seed=1)
    np.testing.assert_array_equal(again[2].moduli, fit.draws(3)[2].moduli)
    assert not np.allclose(again[2].moduli, other[2].moduli)
    assert again[0].name == "draw 1 of tread"


def test_tables_scatter_as_the_fit_says():
    """Shift factors and vertical shifts that are tables: zero at the reference, as
    uncertain as reported elsewhere.
    """
    material = true(em.VerticalTable([240.0, 293.15, 350.0], [0.8, 1.0, 1.15]))
    fit = em.fit.material(measured(0, material), 293.15, law="table", vertical=True)
    draws, master = fit.draws(400), fit.master
    assert isinstance(fit.material.shift, em.ShiftTable)
    assert isinstance(fit.material.vertical, em.VerticalTable)
    for values, at, std in (
        (
            [each.shift.log10_a_table for each in draws],
            fit.material.shift.temperature,
            master.log10_a_std,
        ),
        (
            [np.log10(each.vertical.factor) for each in draws],
            fit.material.vertical.temperature,
            master.log10_b_std,
        ),
    ):
        scatter = dict(
            zip(np.asarray(at).round(2), np.std(values, axis=0), strict=True)
        )
        assert scatter[293.15] < 0.02 * max(scatter.values())
        found = [scatter[kelvin] for kelvin in master.temperature.round(2)]
        np.testing.assert_allclose(found, std, rtol=0.2)
    assert all((np.diff(each.shift.log10_a_table) < 0).all() for each in draws)


@pytest.mark.parametrize(
    "kind", ["table of shift factors", "entropy elasticity", "table of vertical shifts"]
)
def test_the_truth_lies_among_the_draws(kind):
    """Friction of the material that was measured, at temperatures beside the reference,
    over three noises.
    """
    vertical = {
        "entropy elasticity": em.EntropicVertical(293.15),
        "table of vertical shifts": em.VerticalTable(
            [240.0, 293.15, 350.0], [0.8, 1.0, 1.15]
        ),
    }.get(kind)

    def friction(material):
        kelvin = np.array([[273.15], [293.15], [323.15]])
        return em.friction(
            material, ROAD, velocity=[1e-4, 1e-3], temperature=kelvin, pressure=2e5
        )

    truth, off = friction(true(vertical)).mu, []
    for seed in range(3):
        table = (
            {"law": "table", "vertical": False}
            if vertical is None
            else {"vertical": True}
        )
        curve = friction(
            em.fit.material(measured(seed, true(vertical)), 293.15, **table).draws(20)
        )
        assert not curve.extrapolated.any()
        off.append(
            (np.log(curve.mu).mean(axis=0) - np.log(truth))
            / np.log(curve.mu).std(axis=0)
        )
    assert 0.3 < np.sqrt(np.mean(np.square(off))) < 2
    assert np.max(np.abs(off)) < 4.5


def test_a_law_that_was_given_is_not_drawn():
    draws = em.fit.material(measured(), 293.15, shift=LAW, vertical=False).draws(2)
    assert all(float(each.shift.c1) == pytest.approx(8.9) for each in draws)


def test_friction_of_draws_is_one_curve_with_a_band(fit):
    draws = fit.draws(12)
    curve = em.friction(draws, em.Sphere(5e-3), **BALL)
    assert curve.mu.shape == (12, 9)
    alone = em.friction(draws[3], em.Sphere(5e-3), **BALL)
    np.testing.assert_allclose(curve.mu[3], alone.mu, rtol=1e-4)
    low, middle, high = curve.band()
    np.testing.assert_allclose(middle, np.median(curve.mu, axis=0))
    assert (low < middle).all()
    assert (middle < high).all()
    assert "12 draws of tread" in curve.summary()
    assert "95 % of the draws" in curve.summary()
    typical = curve.typical()
    np.testing.assert_allclose(
        typical.model_error, np.median(curve.model_error, axis=0)
    )
    axes = curve.plot()
    assert len(axes.collections) == 1
    top = axes.collections[0].get_paths()[0].vertices[:, 1].max()
    assert top == pytest.approx(np.max(high + typical.error + typical.model_error))
    assert curve.select("draw 4 of tread").mu.shape == (9,)
    with pytest.raises(em.InputError, match="list of draws"):
        alone.band()


def test_road_and_material_are_drawn_together(fit):
    scene = {"velocity": VELOCITY[:3], "pressure": 2e5, "temperature": 293.15}
    roads = ROAD.draws(40, level=0.2, cutoff=0.5)
    slopes = np.array(
        [road.rms_slope / ROAD.ended(road.q_high).rms_slope for road in roads]
    )
    assert np.std(2 * np.log(slopes)) == pytest.approx(0.2, rel=0.35)
    assert np.std([np.log(road.q_high) for road in roads]) == pytest.approx(
        0.5, rel=0.35
    )
    draws, few = fit.draws(5), ROAD.draws(5, level=0.2)
    both = em.friction(draws, few, **scene)
    np.testing.assert_allclose(
        both.mu[2], em.friction(draws[2], few[2], **scene).mu, rtol=1e-3
    )
    only = em.friction(fit.material, few, **scene)
    np.testing.assert_allclose(
        only.mu[1], em.friction(fit.material, few[1], **scene).mu, rtol=1e-3
    )
    with pytest.raises(em.InputError, match="as many draws as shape"):
        em.friction(fit.draws(4), few, **scene)
    for bad in ({}, {"level": -1.0}):
        with pytest.raises(em.InputError, match="level"):
            ROAD.draws(5, **bad)


def test_a_file_gives_draws_of_its_misfit():
    rubber = em.load_material("epdm-70")
    omega, size, _ = np.array(rubber.range.misfit).T
    draws = rubber.draws(200)
    off = np.std(
        [np.log(each.storage(omega) / rubber.storage(omega)) for each in draws], axis=0
    )
    assert 0.5 < np.median(off / size) < 1.2
    assert draws[0].range.misfit == ()
    with pytest.raises(em.InputError, match="misfit"):
        em.load_material("natural-rubber-like").draws(5)
    with pytest.raises(em.InputError, match="n must be"):
        rubber.draws(1)


def test_a_sweep_over_draws(fit, tmp_path):
    pytest.importorskip("zarr")
    draws = fit.draws(3)
    axes = {"material": draws, "velocity": VELOCITY}
    found = em.sweep(
        em.friction,
        axes,
        store=tmp_path / "s.zarr",
        shape=em.Sphere(5e-3),
        load=1.0,
        progress=False,
    )
    assert found.material.values.tolist()[1] == "draw 2 of tread"
    np.testing.assert_allclose(
        found.mu[2],
        em.friction(draws[2], em.Sphere(5e-3), velocity=VELOCITY, load=1.0).mu,
    )


def test_a_sweep_pairs_the_draws_of_rubber_and_road(fit, tmp_path):
    """As `em.friction` of both does; another rubber without draws is the same for
    each.
    """
    pytest.importorskip("zarr")
    draws, roads = fit.draws(3), ROAD.draws(3, level=0.1, cutoff=0.2)
    scene = {"temperature": 293.15, "pressure": 2e5}
    axes = {"material": [draws, true()], "velocity": VELOCITY}
    found = em.sweep(
        em.friction,
        axes,
        store=tmp_path / "s.zarr",
        surface=roads,
        progress=False,
        **scene,
    )
    assert found.mu.dims == ("draw", "material", "velocity")
    for i, material in enumerate(axes["material"]):
        together = em.friction(material, roads, velocity=VELOCITY, **scene)
        np.testing.assert_allclose(found.mu[:, i], together.mu, rtol=1e-12)
    band = found.mu[:, 0].quantile([0.025, 0.5, 0.975], "draw")
    np.testing.assert_allclose(
        band, em.friction(draws, roads, velocity=VELOCITY, **scene).band(), rtol=1e-12
    )


SCENE = """
material = "MATERIAL"
uncertainty = 4
[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.5
longest = "5 mm"
shortest = "50 um"
level_error = 0.2
[contact]
pressure = "0.2 MPa"
velocity = { from = "1e-4 m/s", to = "0.1 m/s", points = 3 }
"""


def test_a_scene_with_uncertainty(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE.replace("MATERIAL", "epdm-70"))
    assert main(["friction", str(path), "--out", str(tmp_path)]) == 0
    assert "95 % of the draws" in capsys.readouterr().out
    path.write_text(SCENE.replace("MATERIAL", "natural-rubber-like"))
    assert main(["friction", str(path), "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "4 draws" in said  # of the road
    assert "shortest wave" in said
    unknown = SCENE.replace("MATERIAL", "natural-rubber-like")
    path.write_text(unknown.replace("level_error = 0.2", ""))
    assert main(["friction", str(path), "--out", str(tmp_path)]) == 2
    assert "misfit" in capsys.readouterr().err
    alone = SCENE.replace("MATERIAL", "epdm-70").replace("uncertainty = 4", "")
    path.write_text(alone)
    asked = ["friction", str(path), "--out", str(tmp_path), "--uncertainty"]
    assert main(asked) == 0
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 5
    road = em.SelfAffine(
        0.8, rms_slope=0.5, q_low=2 * np.pi / 5e-3, q_high=2 * np.pi / 5e-5
    )
    at = {"velocity": np.geomspace(1e-4, 0.1, 3), "pressure": 2e5}
    held = em.friction(em.load_material("epdm-70"), road, **at)
    share = held.uncertainty(level=0.2)["road heights"].share
    table = (tmp_path / "scene-friction-uncertainty.csv").read_text().splitlines()
    rows = [line.split(",") for line in table if line.startswith("road heights")]
    share_of = next(row for row in table if row.startswith("part,")).split(",")
    column = share_of.index("share [-]")
    np.testing.assert_allclose([float(row[column]) for row in rows], share, rtol=1e-6)
    pytest.importorskip("zarr")
    path.write_text(
        SCENE.replace("MATERIAL", "epdm-70") + '[sweep]\ncall = "friction"\n'
    )
    table = tmp_path / "t.csv"
    assert (
        main(
            [
                "sweep",
                str(path),
                "--out",
                str(tmp_path / "s.zarr"),
                "--table",
                str(table),
            ]
        )
        == 0
    )
    assert "draw 4, velocity 3" in capsys.readouterr().out


LEAK = """[leak]
pressure = "1 MPa"
viscosity = "1 mPa s"
length = "1 mm"
pressure_drop = "0.1 MPa"
"""


def test_errors_of_a_road_that_nothing_takes_are_refused(tmp_path, capsys):
    """A leak without draws, and a comparison, have no rows for them."""
    path = tmp_path / "scene.toml"
    head, contact = SCENE.replace("uncertainty = 4\n", "").split("[contact]")
    for verb, text in (
        ("leak", head.replace("MATERIAL", "epdm-70") + LEAK),
        (
            "compare",
            head.replace('"MATERIAL"', '["epdm-70", "natural-rubber-like"]')
            + f"[contact]{contact}",
        ),
    ):
        path.write_text(text)
        assert main([verb, str(path), "--out", str(tmp_path)]) == 2
        said = capsys.readouterr().err
        assert "level_error" in said
        assert "beside uncertainty" in said


def test_draws_of_several_materials_are_refused_with_the_reason(tmp_path, capsys):
    path = tmp_path / "scene.toml"
    several = '["epdm-70", "natural-rubber-like"]'
    path.write_text(SCENE.replace('"MATERIAL"', several))
    assert main(["friction", str(path), "--out", str(tmp_path)]) == 2
    said = capsys.readouterr().err
    assert "uncertainty" in said
    assert "several materials" in said


def test_the_page_shows_the_draws_of_a_leak(tmp_path):
    """Half of the interval of 95 %, in the error that is relative to the rate."""
    pytest.importorskip("nicegui")
    from elastomdr.app.scene import compute
    from elastomdr.app.security import Folder

    head = SCENE.replace("MATERIAL", "epdm-70").split("[contact]")[0]
    with warnings.catch_warnings(action="ignore"):
        done = compute("leak", tomllib.loads(head + LEAK), Folder(tmp_path))
    low, median, high = done.result.band()
    assert high > 2 * low
    half = 0.5 * (high - low) / median
    np.testing.assert_allclose(done.shown.error, half, rtol=1e-4)
