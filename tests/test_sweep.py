"""`em.sweep`: every point as a call of its own gives it, nothing lost when it is interrupted, nothing mixed up."""

import errno
import json
import os
import re
import signal
import subprocess
import sys
import textwrap
import time
from pathlib import Path

import numpy as np
import pytest
import tqdm
from filelock import FileLock

import elastomdr as em
from elastomdr.cli.main import main
from elastomdr.sweeps import grid as grids
from elastomdr.sweeps import run, store

pandas, xarray = pytest.importorskip("pandas"), pytest.importorskip("xarray")
VELOCITY = np.logspace(-3, 1, 7)


def rubber(k):
    return em.Prony(1e6, [k * 1e6, 2e6], [1e-5, 1e-3], shift=em.WLF(8.0, 100.0, 293.15), name=f"rubber {k}")


def scene(**more):
    axes = {"material": [rubber(1), rubber(2), rubber(3)], "load": [1.0, 3.0], "velocity": VELOCITY}
    return {"call": em.friction, "axes": axes, "shape": em.Sphere(0.01), "progress": False} | more


def small(monkeypatch, points=7):
    """Chunks of at most so many points, in this process."""
    monkeypatch.setattr(grids, "_POINTS", points)
    monkeypatch.setattr(run, "_cores", lambda: 1)


def test_every_point_is_that_of_a_call(tmp_path):
    found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert found.mu.dims == ("material", "load", "velocity")
    assert found.mu.attrs["units"] == "-"
    assert found.friction_force.attrs["units"] == "N"
    assert found.converged.dtype == bool
    assert found.chunk_state.values.tolist() == [store.DONE]
    for k, load in ((1, 3.0), (3, 1.0)):
        alone = em.friction(rubber(k), em.Sphere(0.01), load=load, velocity=VELOCITY)
        one = found.sel(material=f"rubber {k}", load=load)
        np.testing.assert_allclose(one.mu, alone.mu, rtol=1e-12)
        np.testing.assert_allclose(one.model_error, alone.model_error, rtol=1e-12)
    assert json.loads(found.attrs["sweep"])["elastomdr"] == em.__version__
    again = xarray.open_zarr(tmp_path / "runs.zarr")  # as a user without this package opens it
    np.testing.assert_array_equal(again.mu, found.mu)


@pytest.mark.parametrize(
    ("call", "axes", "fixed"),
    [
        (
            em.rolling,
            {"shape": [em.Sphere(0.01), em.Paraboloid(0.02)], "load": [1.0], "velocity": [0.1, 1.0]},
            {"material": rubber(1)},
        ),
        (em.impact, {"mass": [1e-3, 2e-3], "velocity": [0.5, 1.0]}, {"material": rubber(1), "shape": em.Sphere(0.01)}),
        (
            em.friction,
            {"model": ["multiscale", "persson"], "surface": [em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)]},
            {"material": rubber(1), "pressure": 3e5, "velocity": 0.1},
        ),
    ],
)
def test_axes_of_any_kind(call, axes, fixed, tmp_path):
    found = em.sweep(call, axes, store=tmp_path / "s.zarr", progress=False, **fixed)
    assert found.converged.values.all()
    assert found.converged.sizes == {name: len(values) for name, values in axes.items()}
    last = {name: values[-1] for name, values in axes.items()} | fixed
    shape = last.pop("shape", None) or last.pop("surface")
    alone = call(last.pop("material"), shape, **last)
    name = "coefficient" if call is em.rolling else "restitution" if call is em.impact else "mu"
    np.testing.assert_allclose(found[name].values.flat[-1], getattr(alone, name), rtol=1e-9)


def test_goes_on_where_it_stopped(tmp_path, monkeypatch):
    """Interrupted after three chunks, it computes the other three, and the answer is the same."""
    small(monkeypatch)
    whole = em.sweep(**scene(store=tmp_path / "whole.zarr"))
    done = []

    def interrupted(asked, chunk):
        if len(done) == 3:
            raise KeyboardInterrupt
        done.append(chunk)
        return compute(asked, chunk)

    compute = run.compute
    monkeypatch.setattr(run, "compute", interrupted)
    with pytest.raises(KeyboardInterrupt):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))
    monkeypatch.setattr(run, "compute", lambda *work: done.append(work[1]) or compute(*work))
    found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert len(done) == found.chunk_state.size == 6
    np.testing.assert_allclose(found.mu, whole.mu, rtol=1e-12)
    np.testing.assert_array_equal(found.converged, whole.converged)


def test_killed_with_its_workers(tmp_path):
    """A process with two workers is killed; the next one goes on from what was marked."""
    path = tmp_path / "runs.zarr"
    script = tmp_path / "script.py"
    script.write_text(
        textwrap.dedent(f"""
        import sys, time
        import elastomdr as em
        from elastomdr.sweeps import grid
        grid._POINTS = 1
        def slowly(material, shape, **rest):
            time.sleep(0.2)
            return em.friction(material, shape, **rest)
        em.sweep(slowly, {{"load": [1.0 + i for i in range(100)]}}, store={str(path)!r}, progress=False,
                 material=em.Prony(1e6, [1e6], [1e-3]), shape=em.Sphere(0.01), velocity=0.1)
        """)
    )
    going = subprocess.Popen([sys.executable, str(script)], start_new_session=True)
    try:
        end = time.monotonic() + 120
        while time.monotonic() < end and going.poll() is None and not (path / "mu").is_dir():
            time.sleep(0.1)
        time.sleep(0.5)
    finally:
        os.killpg(going.pid, signal.SIGKILL)
        going.wait()
    states = np.asarray(xarray.open_zarr(path, consolidated=False).chunk_state)
    assert 0 < (states == store.DONE).sum() < 100
    before = {file.name: file.stat().st_mtime_ns for file in (path / "mu").iterdir()}

    def slowly(material, shape, **rest):
        return em.friction(material, shape, **rest)

    grids_points, grids._POINTS = grids._POINTS, 1
    try:
        found = em.sweep(
            slowly, {"load": [1.0 + i for i in range(100)]}, store=path, progress=False,
            material=em.Prony(1e6, [1e6], [1e-3]), shape=em.Sphere(0.01), velocity=0.1,
        )  # fmt: skip
    finally:
        grids._POINTS = grids_points
    assert (found.chunk_state == store.DONE).all()
    assert np.isfinite(found.mu).all()
    after = {file.name: file.stat().st_mtime_ns for file in (path / "mu").iterdir()}
    again = [name for name in before if after[name] != before[name]]
    assert len(again) <= 1 + (states == store.OPEN).sum() - (100 - len(before)), "finished chunks computed twice"


def test_a_store_of_other_inputs_is_refused(tmp_path, monkeypatch):
    em.sweep(**scene(store=tmp_path / "runs.zarr"))
    with pytest.raises(em.InputError, match=r"fixed\.shape\.radius was 0\.01 and is 0\.02"):
        em.sweep(**scene(store=tmp_path / "runs.zarr", shape=em.Sphere(0.02)))
    axes = scene()["axes"] | {"load": [1.0, 4.0]}
    with pytest.raises(em.InputError, match=r"axes\.load\[1\] was 3\.0 and is 4\.0"):
        em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes))
    monkeypatch.setattr(store, "__version__", "9.9")
    with pytest.raises(em.InputError, match=rf'elastomdr was "{em.__version__}" and is "9\.9"'):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))


def test_one_at_a_time(tmp_path):
    with FileLock(tmp_path / ".runs.zarr.lock"), pytest.raises(em.InputError, match="in use by another process"):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))


def test_a_folder_of_somebody_else_is_left_alone(tmp_path):
    (tmp_path / "letters.txt").write_text("dear")
    with pytest.raises(em.InputError, match="new folder"):
        em.sweep(**scene(store=tmp_path))
    assert (tmp_path / "letters.txt").read_text() == "dear"


def test_what_raises_keeps_its_message_and_stops_nothing(tmp_path, monkeypatch):
    small(monkeypatch)
    axes = {"material": [rubber(1), "no such rubber", rubber(3)], "velocity": VELOCITY}
    with pytest.warns(em.ConvergenceWarning, match="1 of 3 chunks"):
        found = em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes, load=1.0))
    assert found.chunk_state.values.tolist() == [store.DONE, store.RAISED, store.DONE]
    assert np.isnan(found.mu[1]).all()
    assert not found.converged[1].any()
    assert np.isfinite(found.mu[[0, 2]]).all()
    assert "no such rubber" in found.attrs["raised"]["1"]


def test_progress_says_how_long_it_will_take(tmp_path, monkeypatch, capsys):
    small(monkeypatch)
    bar = tqdm.tqdm
    monkeypatch.setattr(tqdm, "tqdm", lambda **given: bar(**(given | {"delay": 0, "mininterval": 0})))
    em.sweep(**scene(store=tmp_path / "runs.zarr", progress=True))
    assert re.search(r" 7.00/42.0 \[\d\d:\d\d<\d\d:\d\d,", capsys.readouterr().err)


def test_points_that_do_not_converge_are_nan_and_flagged(tmp_path):
    axes = {"material": [em.Maxwell(1e6, 1e-2, name="liquid"), rubber(1)], "velocity": VELOCITY}
    for _ in range(2):  # the second time from the store
        with pytest.warns(em.ConvergenceWarning, match="7 of 14 points did not converge; they are NaN"):
            found = em.sweep(**scene(store=tmp_path / "runs.zarr", axes=axes, load=1.0))
    assert np.isnan(found.mu[0]).all()
    assert not found.converged[0].any()
    assert np.isfinite(found.mu[1]).all()
    assert found.converged[1].all()


def test_chunks_hold_whole_calls_and_are_many():
    """A call does all of its arrays; enough chunks that no worker waits long; few points where each takes a second."""

    def sizes(materials, **fixed):
        arrays = {"pressure": [1e5] * 4, "temperature": [300.0] * 5, "velocity": [1.0] * 50}
        road = em.SelfAffine(0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)
        axes = {"material": [rubber(1)] * materials, "surface": [road] * 10} | arrays
        return grids.grid(em.friction, axes, fixed).sizes()

    assert sizes(100) == (1, 5, 4, 5, 50)
    assert sizes(3) == (1, 2, 4, 5, 50)
    for model in ("half-space", em.Line(seeds=2)):
        assert sizes(3, model=model) == (1, 1, 1, 1, 50)
    assert grids.grid(em.friction, {"velocity": [1.0] * 900}, {"model": "line", "shape": em.Sphere(0.01)}).sizes() == (
        900,
    )


def test_a_full_disk_leaves_a_store_that_goes_on(tmp_path, monkeypatch):
    small(monkeypatch)
    keep, kept = store.Store.keep, []

    def full(self, number, *rest):
        if len(kept) == 2:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        kept.append(number)
        keep(self, number, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(store.Store, "keep", full)
        with pytest.raises(em.InputError, match=r"cannot be written: No space left"):
            em.sweep(**scene(store=tmp_path / "runs.zarr"))
    found = em.sweep(**scene(store=tmp_path / "runs.zarr"))
    assert np.isfinite(found.mu).all()


def test_a_cluster_of_two(tmp_path, monkeypatch):
    """Any `dask.distributed.Client`: the same numbers, though a worker dies; a worker keeps the memory it works in."""
    import resource

    from distributed import Client

    def dies_once(material, shape, **rest):
        if not (tmp_path / "died").exists():
            (tmp_path / "died").touch()
            os._exit(1)
        return em.friction(material, shape, **rest)

    small(monkeypatch)
    alone = em.sweep(**scene(store=tmp_path / "alone.zarr"))
    road = em.SelfAffine(0.8, q_low=1e3, q_high=1e6, rms_slope=1.0)
    axes = {
        "material": [rubber(1), rubber(2)],
        "pressure": np.linspace(2e5, 4e5, 20),
        "velocity": np.logspace(-4, 1, 50),
    }
    with run._cluster(2) as cluster, Client(cluster) as client:
        found = em.sweep(**scene(call=dies_once, store=tmp_path / "runs.zarr", client=client))
        monkeypatch.setattr(grids, "_POINTS", 1000)
        em.sweep(em.friction, axes, surface=road, store=tmp_path / "road.zarr", client=client)
        faults = client.run(lambda: resource.getrusage(resource.RUSAGE_SELF).ru_minflt)
    np.testing.assert_array_equal(found.mu, alone.mu)
    assert (tmp_path / "died").exists()
    assert sum(faults.values()) < 150_000, "200 per point make the work of a point twice as long"


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"axes": {}}, "axes must be a dict of one or more names"),
        ({"axes": {"velocity": 1.0}}, r"axes\['velocity'\] must be a list"),
        ({"axes": {"velocity": [[1.0]]}}, r"axes\['velocity'\] must be a list"),
        ({"axes": {"velocity": []}}, r"axes\['velocity'\] must be a list"),
        ({"axes": {"material": "nbr"}}, r"axes\['material'\] must be a list"),
        ({"shape": None, "load": [1.0, 2.0], "axes": {"velocity": [1.0]}}, "load must be one value or an axis"),
        ({"load": 1.0}, "load must be an axis or fixed"),
        ({"call": 3}, "call must be em.friction"),
    ],
)
def test_bad_input(change, said, tmp_path):
    with pytest.raises(em.InputError, match=said):
        em.sweep(**scene(store=tmp_path / "runs.zarr") | change)
    assert not (tmp_path / "runs.zarr").exists()


def test_without_the_packages(tmp_path, monkeypatch):
    monkeypatch.setattr(run, "_installed", lambda name: name != "zarr")
    with pytest.raises(em.InputError, match=r"needs zarr: pip install elastomdr\[sweep\]"):
        em.sweep(**scene(store=tmp_path / "runs.zarr"))


SCENE = """
material = ["tread-passenger-synthetic", "tread-winter-synthetic"]
temperature = ["0 degC", "20 degC"]
[indenter]
shape = "sphere"
radius = "5 mm"
[contact]
load = "10 N"
velocity = ["1 mm/s", "1 m/s"]
[sweep.vary]
"indenter.radius" = ["5 mm", "10 mm"]
"""


def command(tmp_path, capsys, text, *options):
    (tmp_path / "scene.toml").write_text(text)
    status = main(["sweep", str(tmp_path / "scene.toml"), "--out", str(tmp_path / "s.zarr"), *options])
    return status, capsys.readouterr()


def test_command(tmp_path, capsys):
    """A scene with lists, to a store and a table; run again, it is there already."""
    status, said = command(tmp_path, capsys, SCENE, "--table", str(tmp_path / "all.csv"))
    assert status == 0, said.err
    assert "16 points (material 2, indenter.radius 2, temperature 2, velocity 2), 16 converged" in said.out
    found = xarray.open_zarr(tmp_path / "s.zarr")
    alone = em.friction(
        em.load_material("tread-winter-synthetic"), em.Sphere(0.01), load=10.0, velocity=1.0, temperature=273.15
    )
    one = found.sel({"material": "tread-winter-synthetic", "indenter.radius": "10 mm"}).isel(temperature=0, velocity=1)
    assert float(one.mu) == pytest.approx(float(alone.mu), rel=1e-9)
    table = pandas.read_csv(tmp_path / "all.csv", comment="#")
    assert len(table) == 16
    assert np.isclose(table["friction coefficient [-]"], alone.mu, rtol=1e-9).sum() == 1
    assert "velocity [m/s]" in (tmp_path / "all.csv").read_text()
    status, said = command(tmp_path, capsys, SCENE, "--table", str(tmp_path / "all.xlsx"))
    assert status == 0
    sheet = pandas.read_excel(tmp_path / "all.xlsx", engine="openpyxl")
    assert sheet.columns.tolist() == table.columns.tolist()
    np.testing.assert_allclose(sheet["friction coefficient [-]"], table["friction coefficient [-]"], rtol=1e-12)
    status, said = command(tmp_path, capsys, SCENE.replace("10 N", "11 N"))
    assert status == 2
    assert "was made with other inputs" in said.err


def test_a_friction_map_in_one_command(tmp_path, capsys):
    """The table of a sweep over velocity, temperature and pressure is a friction law."""
    text = (Path(__file__).parents[1] / "examples" / "scenes" / "friction_map.toml").read_text()
    status, said = command(
        tmp_path, capsys, text.replace("points = 26", "points = 3"), "--table", str(tmp_path / "m.csv")
    )
    assert status in (0, 3), said.err
    law = em.load_friction(tmp_path / "m.csv")
    assert law.mu.shape == (4, 3, 3)
    store = xarray.open_zarr(tmp_path / "s.zarr")
    one = store.mu.sel(temperature=293.15, pressure=2e5).isel(velocity=1)
    assert float(law(float(one.velocity), 293.15, 2e5)) == pytest.approx(float(one), rel=1e-12)
    law.to_abaqus(tmp_path / "m.inp")


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('"indenter.radius"', '"indentor.radius"'), "a table that the scene does not have: 'indentor.radius'"),
        (('["5 mm", "10 mm"]', "[]"), "indenter.radius must be a list of one value or more"),
        (('["5 mm", "10 mm"]', '["5 mm", "5 N"]'), "[indenter] radius must be a length"),
        (("[sweep.vary]", '[sweep]\ncall = "slide"\n[sweep.vary]'), "[sweep] call must be one of friction"),
    ],
)
def test_bad_scene(change, said, tmp_path, capsys):
    status, told = command(tmp_path, capsys, SCENE.replace(*change))
    assert status == 2
    assert said in told.err
    assert not (tmp_path / "s.zarr").exists()


def test_no_cluster_there(tmp_path, capsys):
    status, told = command(tmp_path, capsys, SCENE, "--scheduler", "nonsense")
    assert status == 2
    assert "--scheduler must be the address" in told.err
