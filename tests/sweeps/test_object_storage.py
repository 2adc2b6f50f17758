"""`em.sweep` with its store on object storage, behind a server of the protocol of S3."""

import threading

import fsspec
import numpy as np
import pytest
from zarr.core.sync import sync

import elastomdr as em
from elastomdr.sweeps import grid, run, storage

from ..refused import refused
from .s3_server import Server

xarray = pytest.importorskip("xarray")
STORE = "bucket/project/runs.zarr"
AXES = {"load": [1.0, 2.0, 3.0], "velocity": np.logspace(-3, 1, 7)}
RUBBER = em.Prony(1e6, [1e6], [1e-3])


def swept(store, **more):
    given = {"material": RUBBER, "shape": em.Paraboloid(0.01), "progress": False}
    return em.sweep(em.friction, AXES, store=store, **(given | more))


@pytest.fixture
def small(monkeypatch):
    """Three chunks, in this process, and marks that are soon old."""
    monkeypatch.setattr(grid, "_POINTS", 7)
    monkeypatch.setattr(run, "_cores", lambda: 1)
    monkeypatch.setattr(storage, "_RENEWAL", 0.05)


@pytest.fixture
def server(monkeypatch):
    pytest.importorskip("s3fs")
    with Server() as started:
        monkeypatch.setenv("AWS_ENDPOINT_URL", started.url)
        monkeypatch.setenv("AWS_ACCESS_KEY_ID", "user")
        monkeypatch.setenv("AWS_SECRET_ACCESS_KEY", "secret")
        monkeypatch.setenv("AWS_DEFAULT_REGION", "us-east-1")
        yield started
        clients = fsspec.get_filesystem_class("s3")
        for client in clients._cache.values():
            close = client._s3.close()
            # clients of zarr work in its own thread
            sync(close) if client.asynchronous else client.loop.call_soon_threadsafe(
                client.loop.create_task, close
            )
        clients.clear_instance_cache()


def test_a_store_in_a_bucket(server, small):
    """Interrupted by an outage it goes on; what is damaged is computed again."""
    objects = server.objects
    server.refused = "state/.record/chunk.2"
    with refused("", "'s3", "written"):
        swept(f"s3://{STORE}")
    server.refused = "nothing"
    assert f"{STORE}/state/.record/chunk.1" in objects
    assert f"{STORE}/state/.record/chunk.2" not in objects
    content = objects[f"{STORE}/mu/1.0"]
    objects[f"{STORE}/mu/1.0"] = content[:-1] + bytes([content[-1] ^ 1])
    objects[f"{STORE}/error/0.0"] = b""
    said = "2 of 3 chunks of store 's3:.* are damaged .* the first: '(mu/1|error/0).0'"
    with pytest.warns(UserWarning, match=said):
        again = swept(f"s3://{STORE}")
    alone = em.friction(
        RUBBER, em.Paraboloid(0.01), load=2.0, velocity=AXES["velocity"]
    )
    np.testing.assert_array_equal(again.mu.sel(load=2.0), alone.mu)
    # as a user opens it, without this package
    opened = xarray.open_zarr(f"s3://{STORE}", chunks=None)
    np.testing.assert_array_equal(opened.mu, again.mu)
    assert (opened.state == 1).all()
    assert not [name for name in objects if name.endswith(".lock")]


def test_one_process_at_a_time_without_locks(small):
    """A mark that its owner renews keeps others out; one that nobody renews does not."""
    files = storage.Files("memory://bucket/runs.zarr")
    with storage.Alone(files).held() as alone:
        with pytest.raises(em.InputError, match=r"in use by .*, process \d+"):
            swept(files.place)
        # one that came all the same is seen
        files.write("../.runs.zarr.lock", b"other, process 1, 0")
        alone._ended.wait(0.2)
        with refused("", 1, "process"):
            alone.check()
    assert swept(files.place).converged.all()


def test_a_cluster_file_system_without_locks(small, tmp_path, monkeypatch):
    import filelock

    def refuses(*given):
        raise NotImplementedError

    monkeypatch.setattr(filelock.FileLock, "acquire", refuses)
    swept(tmp_path / "runs.zarr")
    assert not (tmp_path / ".runs.zarr.lock").exists()
    assert threading.active_count() < 20
