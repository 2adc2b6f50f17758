"""`em.sweep`: the product of axes of a verb, on the cores of this machine or on a
cluster.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import os
import sys
import time
import uuid
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from .. import __version__
from ..checks import in_si, warn_of_failed
from ..errors import ConvergenceWarning, InputError, warn
from ..results.base import Quantity
from ..results.doubts import FLAGS, TITLE, flags
from .grid import Grid, grid, positional
from .identity import modules_of_the_user
from .storage import Alone, Files
from .store import DONE, OPEN, RAISED, Parts, ZarrStore

if TYPE_CHECKING:
    import xarray
    from distributed import Client

    from ..results.base import Result

_NEEDED = (
    "cloudpickle",
    "dask",
    "distributed",
    "filelock",
    "fsspec",
    "tqdm",
    "xarray",
    "zarr",
)
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt, malloc.h
# by default the processes of Dask look after themselves 50 times a second, for 5 % of a
# core
_CALM = {
    "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "1s",
    "DASK_DISTRIBUTED__WORKER__MEMORY__MONITOR_INTERVAL": "1s",
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    # a lost scheduler is said once, by the process that called
    "DASK_LOGGING__DISTRIBUTED": "critical",
}
_LOGGED = 30  # seconds between two lines of progress in the log of a job
_AHEAD = 4  # chunks under way or waiting for each thread of a worker
# under way or waiting: clusters that adapt themselves grow to a worker for each five
# seconds of work that they see
_LEAST = 1000
_LOOK = 5  # seconds between two looks at how large the cluster is
_CLOSING = 5  # seconds for what is closed
# Scheduler and workers of this machine end with the process that started them, even if
# that is killed, and leave what is typed at its terminal, such as Ctrl-C, to it.
_BOUND = """
import os, threading, time
if os.getpgrp() != os.getpid():
    os.setpgid(0, 0)
def watch():
    while os.getppid() == {parent}:
        time.sleep(0.5)
    os._exit(1)
threading.Thread(target=watch, daemon=True).start()
"""


@in_si
def sweep(
    call: Callable[..., Result],
    axes: Mapping[str, Sequence[object] | np.ndarray],
    *,
    store: str | os.PathLike[str],
    client: Client | None = None,
    progress: bool = True,
    **fixed: Any,
) -> xarray.Dataset:
    """Computes a verb at every combination of the values of several arguments, and
    keeps the results in a store.

    Chunks of points are computed by worker processes; each is written to the store when
    it is done. Called again with the same arguments and store, after an interruption
    say, it computes what is missing; what is damaged on the disk, by the checksums of
    its files, as well, and warns of it.

    Args:
        call: `em.friction`, `em.rolling`, `em.impact`, or a function of yours that
            returns a result of one of these. When its code has changed, or anything
            that this refers to (globals, functions, objects, modules of yours), it is
            another call; files and environment that it reads are not looked at. Where
            it refers to what cannot be compared, the store is not gone on with.
        axes: name of an argument to its values, in the order of the dimensions of the
            answer: numbers (`velocity`, `load`, `pressure`, `temperature`, ...),
            materials, shapes and surfaces, models, or whatever else the call accepts.
        store: folder of the zarr store, new or of an earlier call with the same
            arguments; or a URL of object storage that fsspec knows, such as
            `"s3://bucket/runs.zarr"` where s3fs is installed.
        client: a `dask.distributed.Client` of any cluster; None starts one process per
            core of this machine.
        progress: whether a bar shows the share that is done and the time that is left.
        fixed: the other arguments of the call. Draws of a material, of a surface or of
            both, here or among the values of an axis, make the first axis of the
            answer, `draw`: a material and a surface for each.

    Returns:
        An `xarray.Dataset` with the fields of the result that have one value per point;
        names and units are in its attributes. Points that did not converge are NaN.
        `state` is 1 where a chunk is done and 2 where one of its calls raised; the
        messages stand in the attribute `raised`.

    Raises:
        InputError: wrong axes; a store made with other inputs or by another version, in
            use by another process, or whose metadata are damaged; a disk that is full;
            packages of `elastomdr[sweep]` that are not installed.
        ConnectionError: the cluster was lost. What was done is kept.
    """
    files = _checked_store(store)
    if client is not None and not hasattr(client, "submit"):
        raise InputError(
            f"client must be a dask.distributed.Client or None, got {client!r}."
        )
    asked = grid(call, axes, fixed)
    with Alone(files).held() as alone:
        with files.told():
            kept = ZarrStore(files, asked)
        if kept.damaged:
            warn(
                f"{len(kept.damaged)} of {kept.state.size} chunks of store "
                f"{files.place!r} are damaged and computed again; the first: "
                f"{next(iter(kept.damaged.values()))!r} is missing or not as it was "
                "written.",
                UserWarning,
            )
        _compute(asked, kept, alone, client, progress)
        with files.told():
            kept.finish()
    _warn_of_failures(asked, kept)
    return kept.opened()


def _checked_store(store: object) -> Files:
    """The files of a store, once all packages are there. Raises `InputError`."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise InputError(
            f"em.sweep needs {', '.join(missing)}: pip install elastomdr[sweep]"
        )
    return Files(store)


def _warn_of_failures(asked: Grid, kept: ZarrStore) -> None:
    """One warning of calls that raised, or else of points that did not converge."""
    if raised := kept.raised():
        warn(
            f"{len(raised)} of {kept.state.size} chunks hold calls that raised; their "
            f"points are NaN. The first: {next(iter(raised.values()))} All are in the "
            "attribute 'raised'.",
            ConvergenceWarning,
        )
    else:
        warn_of_failed(kept.not_converged(), int(np.prod(asked.shape)), "points")


def _compute(
    asked: Grid, kept: ZarrStore, alone: Alone, client: Client | None, progress: bool
) -> None:
    """Computes the chunks that are open, and keeps each."""
    from tqdm import tqdm

    chunks = asked.chunks()
    todo = [number for number in range(len(chunks)) if kept.state[number] == OPEN]
    total = int(np.prod(asked.shape))
    sizes = [
        int(np.prod([place.stop - place.start for place in chunk])) for chunk in chunks
    ]
    left = sum(sizes[number] for number in todo)
    bar = tqdm(
        total=total,
        initial=total - left,
        unit=" points",
        unit_scale=True,
        disable=not (progress and todo),
        file=sys.stderr,
        delay=2,
        dynamic_ncols=True,
        mininterval=0.1 if sys.stderr.isatty() else _LOGGED,
    )
    # it may kill this process
    apart = len(todo) > 1 or not kept.raised().keys().isdisjoint(todo)
    with (
        bar,
        _workers(client, len(todo) if apart else 0) as work,
        _writers(kept) as keep,
    ):
        for number, computed in work(asked, chunks, todo):
            alone.check()
            if isinstance(computed, str):
                # it killed its workers, and is open for the next call
                message = f"{_place(asked, chunks[number])}: {computed}"
                parts, models, state = {}, [], OPEN
            else:
                parts, message, models = computed
                state = RAISED if message else DONE
            keep(number, parts, message, models, state)
            bar.update(sizes[number])


@contextlib.contextmanager
def _writers(kept: ZarrStore) -> Iterator[Callable[..., None]]:
    """What hands chunks to threads that write them, and waits where they are behind.
    Raises `InputError` for a store that cannot be written.
    """
    writing: set[Future[None]] = set()

    def finish(most: int) -> None:
        nonlocal writing
        while len(writing) > most:
            done, writing = wait(writing, return_when=FIRST_COMPLETED)
            for each in done:
                each.result()

    def keep(*chunk: Any) -> None:
        with kept.files.told():
            writing.add(threads.submit(kept.keep, *chunk))
            finish(2 * kept.files.writers)

    with ThreadPoolExecutor(kept.files.writers) as threads:
        yield keep
        with kept.files.told():
            finish(0)


@contextlib.contextmanager
def _workers(
    client: Client | None, count: int
) -> Iterator[Callable[..., Iterator[tuple[int, Any]]]]:
    """What computes chunks: the client's cluster, one of up to `count` processes of
    this machine, or this process.
    """
    if client is not None:
        yield lambda *work: _on_cluster(client, *work)
    elif not count or (cores := _cores()) < 2:
        yield lambda asked, chunks, todo: (
            (number, compute(asked, chunks[number])) for number in todo
        )
    else:
        with _local(min(count, cores)) as started:
            yield lambda *work: _on_cluster(started, *work)


@contextlib.contextmanager
def _local(workers: int) -> Iterator[Client]:
    """A client of a cluster of this machine, which is closed also where its scheduler
    is gone.
    """
    from distributed import Client

    cluster = _cluster(workers)
    try:
        client = Client(cluster)
        try:
            yield client
        finally:
            with contextlib.suppress(Exception):
                client.close(timeout=_CLOSING)
    finally:
        _close(cluster)


def _close(cluster: Any) -> None:
    from dask import config  # type: ignore[attr-defined]
    from distributed.core import Status

    try:
        with config.set({"distributed.comm.timeouts.connect": _CLOSING}):
            cluster.close(timeout=_CLOSING)
    except Exception:  # what cannot be asked to end is ended
        for started in (cluster.scheduler, *cluster.workers.values()):
            with contextlib.suppress(AttributeError, ProcessLookupError):
                started.process.kill()
        cluster.status = Status.closed


def _cluster(workers: int) -> Any:
    """Processes of this machine that import nothing of the user's script, which
    therefore needs no main guard.
    """
    if sys.platform == "win32":
        from distributed import LocalCluster

        return LocalCluster(
            n_workers=workers, threads_per_worker=1, dashboard_address=None
        )
    from distributed.deploy.subprocess import SubprocessCluster

    added = {name: value for name, value in _CALM.items() if name not in os.environ}
    os.environ.update(added)
    bound = _BOUND.format(parent=os.getpid())
    try:
        return SubprocessCluster(
            host="127.0.0.1",
            n_workers=workers,
            threads_per_worker=1,
            dashboard_address=cast(str, None),
            silence_logs=50,
            scheduler_kwargs={"preload": bound},
            worker_kwargs={"preload_nanny": bound},
        )
    finally:
        for name in added:
            del os.environ[name]


def _on_cluster(
    client: Client, asked: Grid, chunks: list[Any], todo: list[int]
) -> Iterator[tuple[int, Any]]:
    """Chunks as they are finished, in any order; a few per worker are under way at a
    time.

    When a worker dies, Dask suspects every chunk that it had, so those that are given
    up are computed once more, each alone. What is given up again has killed workers by
    itself; what it did is answered in words.
    """
    from distributed.scheduler import KilledWorker
    from distributed.utils import CancelledError, TimeoutError  # type: ignore[attr-defined]

    # unlike scattered data made again if lost
    shared = client.submit(_given, _pickled(asked), pure=False) if todo else None
    suspects: list[int] = []
    try:
        for number, outcome in _as_completed(client, shared, chunks, todo, alone=False):
            if isinstance(outcome, KilledWorker):
                suspects.append(number)
            else:
                yield number, outcome
        for number, outcome in _as_completed(
            client, shared, chunks, suspects, alone=True
        ):
            if isinstance(outcome, KilledWorker):
                outcome = "its workers were killed, possibly for lack of memory."
            yield number, outcome
    except (CancelledError, TimeoutError, OSError) as error:
        why = (
            ""
            if isinstance(error, CancelledError)
            else f" ({error or type(error).__name__})"
        )
        raise ConnectionError(
            f"the cluster was lost{why}; what was finished is in the store, and "
            "the same call goes on from there."
        ) from error


def _as_completed(
    client: Client, shared: Any, chunks: list[Any], todo: list[int], *, alone: bool
) -> Iterator[tuple[int, Any]]:
    """The chunks of a list with what came of them, or that they killed their workers;
    at most so many under way.
    """
    from distributed import as_completed
    from distributed.scheduler import KilledWorker

    # of one group of tasks, which wait at the scheduler until a worker is free
    name = f"compute-{uuid.uuid4()}"
    under_way: dict[Any, Any] = {}
    waiting = iter(todo)
    completed, looked = as_completed(), -_LOOK
    most = 1
    try:
        while True:
            # clusters grow and shrink
            if not alone and time.monotonic() > looked + _LOOK:
                workers = client.scheduler_info(n_workers=-1)["workers"].values()
                most = max(
                    _LEAST, _AHEAD * sum(worker["nthreads"] for worker in workers)
                )
                looked = time.monotonic()
            for number in islice(waiting, most - len(under_way)):
                future = client.submit(
                    compute, shared, chunks[number], __version__, key=(name, number)
                )
                under_way[future.key] = future
                completed.add(future)
            if not under_way:
                return
            future = next(completed)
            _, number = under_way.pop(future.key).key
            try:
                outcome = future.result()
            except KilledWorker as error:
                outcome = error
            del future  # or the worker keeps its result
            yield number, outcome
    finally:
        with contextlib.suppress(Exception):  # of a cluster that may be gone
            client.cancel(list(under_way.values()))


def _pickled(asked: Grid) -> bytes:
    """For other processes, with the modules of the user as they are in this one; those
    that cannot be pickled are imported there. Raises `InputError`.
    """
    import cloudpickle

    modules = modules_of_the_user()
    by_value = set(modules) - {
        sys.modules[name]
        for name in cloudpickle.list_registry_pickle_by_value()
        if name in sys.modules
    }
    try:
        for module in by_value:
            cloudpickle.register_pickle_by_value(module)
        with contextlib.suppress(Exception):  # what a class of anybody raises
            return cloudpickle.dumps(asked)
    finally:
        for module in by_value:
            cloudpickle.unregister_pickle_by_value(module)
    try:
        return cloudpickle.dumps(asked)
    except Exception as error:  # of another class with each of them
        raise InputError(
            "call, axes and fixed arguments must be such that they can be pickled, for "
            f"other processes: {error}"
        ) from error


def _given(pickled: bytes) -> Grid:
    """What a worker computes. Raises `InputError` where it lacks a module for that."""
    import cloudpickle

    try:
        return cloudpickle.loads(pickled)
    except ImportError as error:
        raise InputError(
            "call, axes and fixed arguments must be of modules that the workers can "
            f"import: {error}."
        ) from error


def compute(
    asked: Grid, chunk: tuple[slice, ...], version: str = __version__
) -> tuple[Parts, str, list[str]]:
    """The calls of a chunk: arrays and attributes by field, what was raised, the models
    that were used.
    """
    if version != __version__:
        raise InputError(
            f"client must have workers with elastomdr {version}, got one with "
            f"{__version__}."
        )
    _keep_memory()
    shape = tuple(along.stop - along.start for along in chunk)
    parts: Parts = {}
    messages, models = [], []
    for where, arguments in asked.calls(chunk):
        try:
            expected = np.zeros(shape, bool)[where].shape
            model, fields = _call(asked, arguments, expected)
        except Exception as error:
            place = _place(asked, chunk, where)
            messages.append(f"{place}: {type(error).__name__}: {error}")
            continue
        models += [model] * (model not in models)
        for q, values in fields.items():
            if q.key not in parts:
                parts[q.key] = _empty(values.dtype, shape), _attributes(q)
            parts[q.key][0][where] = values
    return parts, " | ".join(messages), models


def _call(
    asked: Grid, arguments: Mapping[str, object], expected: tuple[int, ...]
) -> tuple[str, dict[Any, np.ndarray]]:
    """Model and fields of one call, without those that are axes. Raises `InputError`
    for a field with another shape than expected.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        by_position, by_name = positional(arguments)
        result = asked.call(*by_position, **by_name)
    axes = [axis.name for axis in asked.axes]
    fields = {q: values for q, values in result.fields().items() if q.key not in axes}
    fields[_DOUBTS] = flags(result.doubts, np.shape(result.converged))
    for q, values in fields.items():
        if values.shape != expected:
            raise InputError(
                f"call must give one value per point, {expected}, got {q.key} of the "
                f"shape {values.shape}."
            )
    return result.model, fields


def _empty(dtype: np.dtype, shape: tuple[int, ...]) -> np.ndarray:
    """What stands in a chunk where nothing was computed."""
    return np.full(shape, np.nan) if dtype.kind == "f" else np.zeros(shape, dtype)


_DOUBTS = Quantity(TITLE, "", path=TITLE, key=TITLE)


def _attributes(q: Quantity) -> Mapping[str, object]:
    if q is _DOUBTS:
        return FLAGS
    about = {"long_name": q.label, "units": q.unit, "description": q.meaning}
    return {key: words for key, words in about.items() if words}


@functools.cache
def _keep_memory() -> None:
    """Lets a worker of Dask use its memory again.

    Dask's MALLOC_TRIM_THRESHOLD_ makes glibc return each array of more than 128 KiB to
    the system, and ask for the next one page by page: twice the work of the sums
    themselves.
    """
    if "MALLOC_TRIM_THRESHOLD_" in os.environ:
        with contextlib.suppress(OSError, TypeError, AttributeError):  # no glibc
            libc = ctypes.CDLL(None)
            libc.mallopt(_TRIM_THRESHOLD, 256 << 20)
            libc.mallopt(_MMAP_THRESHOLD, 32 << 20)


def _place(asked: Grid, chunk: tuple[slice, ...], where: tuple[Any, ...] = ()) -> str:
    """Which points of a chunk they are, by the values of the axes along which they are
    not all.
    """
    named = []
    where = where or (slice(None),) * len(chunk)
    for axis, place, i in zip(asked.axes, chunk, where, strict=True):
        labels = (
            axis.labels[place]
            if isinstance(i, slice)
            else axis.labels[place.start + i : place.start + i + 1]
        )
        if len(labels) < len(axis.values) or len(labels) == 1:
            named.append(
                f"{axis.name} {labels[0]}"
                + (f" to {labels[-1]}" if len(labels) > 1 else "")
            )
    return ", ".join(named) or "all"


def _cores() -> int:
    from dask.system import cpu_count  # knows affinity and the limits of containers

    return cpu_count()
