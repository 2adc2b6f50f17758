"""`em.sweep`: the product of axes of a verb, on the cores of this machine or on a cluster."""

from __future__ import annotations

import contextlib
import ctypes
import functools
import os
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from ..errors import ConvergenceWarning, InputError
from .grid import Grid, grid
from .store import DONE, OPEN, RAISED, Store

if TYPE_CHECKING:
    import xarray
    from distributed import Client

    from ..results.base import Result

_NEEDED = ("dask", "distributed", "filelock", "tqdm", "xarray", "zarr")
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt, malloc.h
_CALM = {  # by default the processes of Dask look after themselves 50 times a second, for 5 % of a core
    "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "1s",
    "DASK_DISTRIBUTED__WORKER__MEMORY__MONITOR_INTERVAL": "1s",
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
}
_LOGGED = 30  # seconds between two lines of progress in the log of a job
_AHEAD = 4  # chunks under way or waiting for each worker


def sweep(
    call: Callable[..., Result],
    axes: Mapping[str, Sequence[object] | np.ndarray],
    *,
    store: str | os.PathLike[str],
    client: Client | None = None,
    progress: bool = True,
    **fixed: Any,
) -> xarray.Dataset:
    """Computes a verb at every combination of the values of several arguments, and keeps the results in a store.

    Chunks of points are computed by worker processes; each is written to the store when it is done. Called again
    with the same arguments and store, after an interruption say, it computes what is missing.

    Args:
        call: `em.friction`, `em.rolling`, `em.impact`, or a function of yours that returns a result of one of these.
        axes: name of an argument to its values, in the order of the dimensions of the answer: numbers
            (`velocity`, `load`, `pressure`, `temperature`, ...), materials, shapes and surfaces, models, or
            whatever else the call accepts.
        store: folder of the zarr store, new or of an earlier call with the same arguments.
        client: a `dask.distributed.Client` of any cluster; None starts one process per core of this machine.
        progress: whether a bar shows the share that is done and the time that is left.
        fixed: the other arguments of the call.

    Returns:
        An `xarray.Dataset` with the fields of the result that have one value per point; names and units are in its
        attributes. Points that did not converge are NaN. `chunk_state` is 1 where a chunk is done and 2 where a call
        raised, whose message stands in the attribute `raised`.

    Raises:
        InputError: wrong axes; a store made with other inputs or by another version, or in use by another
            process; a disk that is full; packages of `elastomdr[sweep]` that are not installed.
        ConnectionError: the cluster was lost. What was done is kept.
    """
    missing = [name for name in _NEEDED if not _installed(name)]
    if missing:
        raise InputError(f"em.sweep needs {', '.join(missing)}: pip install elastomdr[sweep]")
    asked, path = grid(call, axes, fixed), Path(store)
    with _alone(path):
        try:
            kept = Store(path, asked)
            kept.describe(_computed(asked, kept, client, progress))
        except OSError as error:
            if isinstance(error, ConnectionError):
                raise
            raise InputError(
                f"store {str(path)!r} cannot be written: {error.strerror or error}. What was finished is in it, and "
                "the same call goes on from there."
            ) from error
    if raised := kept.raised():
        first = next(iter(raised.values()))
        warnings.warn(
            f"{len(raised)} of {kept.state.size} chunks hold calls that raised; their points are NaN. The first: "
            f"{first} All are in the attribute 'raised'.",
            ConvergenceWarning,
            stacklevel=2,
        )
    elif failed := kept.not_converged():
        warnings.warn(
            f"{failed} of {int(np.prod(asked.shape))} points did not converge; they are NaN.",
            ConvergenceWarning,
            stacklevel=2,
        )
    return kept.opened()


def _computed(asked: Grid, kept: Store, client: Client | None, progress: bool) -> dict[str, str]:
    """Computes the chunks that are open; what a result says of itself."""
    from tqdm import tqdm

    chunks = asked.chunks()
    todo = [number for number in range(len(chunks)) if kept.state[number] == OPEN]
    told: dict[str, str] = {}
    total = int(np.prod(asked.shape))
    sizes = [int(np.prod([place.stop - place.start for place in chunk])) for chunk in chunks]
    left = sum(sizes[number] for number in todo)
    bar = tqdm(
        total=total, initial=total - left, unit=" points", unit_scale=True, disable=not (progress and todo),
        file=sys.stderr, delay=2, dynamic_ncols=True, mininterval=0.1 if sys.stderr.isatty() else _LOGGED,
    )  # fmt: skip
    with bar, _workers(client, len(todo)) as work:
        for number, (parts, message, words) in work(asked, chunks, todo):
            kept.keep(number, chunks[number], parts, message, RAISED if message else DONE)
            told = told or words
            bar.update(sizes[number])
    return told


@contextlib.contextmanager
def _workers(client: Client | None, count: int) -> Iterator[Callable[..., Iterator[tuple[int, Any]]]]:
    """What computes chunks: the client's cluster, one of processes of this machine, or this process for one alone."""
    if client is not None:
        yield lambda *work: _on_cluster(client, *work)
    elif count < 2 or (cores := _cores()) < 2:
        yield lambda asked, chunks, todo: ((number, compute(asked, chunks[number])) for number in todo)
    else:
        from distributed import Client as Connected

        with _cluster(min(count, cores)) as cluster, Connected(cluster) as started:
            yield lambda *work: _on_cluster(started, *work)


def _cluster(workers: int) -> Any:
    """Processes of this machine that import nothing of the user's script, which therefore needs no main guard."""
    if sys.platform == "win32":
        from distributed import LocalCluster

        return LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    from distributed.deploy.subprocess import SubprocessCluster

    added = {name: text for name, text in _CALM.items() if name not in os.environ}
    os.environ.update(added)
    try:
        return SubprocessCluster(
            host="127.0.0.1", n_workers=workers, threads_per_worker=1, dashboard_address=cast(str, None),
            silence_logs=40,
        )  # fmt: skip
    finally:
        for name in added:
            del os.environ[name]


def _on_cluster(client: Client, asked: Grid, chunks: list[Any], todo: list[int]) -> Iterator[tuple[int, Any]]:
    """Chunks as they are finished, in any order; a few per worker are under way at a time."""
    from distributed import as_completed
    from distributed.scheduler import KilledWorker
    from distributed.utils import CancelledError, TimeoutError  # type: ignore[attr-defined]

    numbers: dict[Any, int] = {}
    under_way: dict[Any, Any] = {}
    waiting = iter(todo)
    shared = client.submit(_given, asked, pure=False) if todo else None  # unlike scattered data made again if lost
    done = as_completed()

    def submit(count: int) -> None:
        for number in islice(waiting, count):
            future = client.submit(compute, shared, chunks[number], pure=False)
            numbers[future.key], under_way[future.key] = number, future
            done.add(future)

    try:
        submit(_AHEAD * max(1, len(client.scheduler_info(n_workers=-1)["workers"])))
        for future in done:
            number = numbers.pop(future.key)
            del under_way[future.key]
            try:
                found = future.result()
            except KilledWorker as error:
                raise ConnectionError(
                    f"workers died again and again over chunk {number}, for want of memory perhaps: {error}"
                ) from error
            yield number, found
            submit(1)
    except (CancelledError, TimeoutError, OSError) as error:
        if isinstance(error, ConnectionError) and "workers died" in str(error):
            raise
        raise ConnectionError(
            f"the cluster was lost ({error or type(error).__name__}); what was finished is in the store, and the same "
            "call goes on from there."
        ) from error
    finally:
        with contextlib.suppress(Exception):  # of a cluster that may be gone
            client.cancel(list(under_way.values()))


def _given(asked: Grid) -> Grid:
    return asked


def compute(asked: Grid, chunk: tuple[slice, ...]) -> tuple[dict[str, Any], str, dict[str, str]]:
    """The calls of a chunk: arrays and attributes by field, what was raised, provenance."""
    _keep_memory()
    shape = tuple(place.stop - place.start for place in chunk)
    parts: dict[str, Any] = {}
    messages, told = [], {}
    for where, arguments in asked.calls(chunk):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                result = _call(asked.call, arguments)
            fields = result.fields()
        except Exception as error:
            messages.append(f"{_place(asked, chunk, where)}: {type(error).__name__}: {error}")
            continue
        told = told or {"model": result.model}
        for q, values in fields.items():
            if q.key in arguments and np.ndim(arguments[q.key]):
                continue  # an axis already
            if q.key not in parts:
                about = {"long_name": q.label, "units": q.unit, "description": q.meaning}
                empty = np.zeros(shape, bool) if values.dtype == bool else np.full(shape, np.nan)
                parts[q.key] = (empty, {key: text for key, text in about.items() if text})
            parts[q.key][0][where] = values
    return parts, " | ".join(messages), told


@functools.cache
def _keep_memory() -> None:
    """Lets a worker of Dask use its memory again.

    Dask's MALLOC_TRIM_THRESHOLD_ makes glibc return each array of more than 128 KiB to the system, and ask for the
    next one page by page: twice the work of the sums themselves.
    """
    if "MALLOC_TRIM_THRESHOLD_" in os.environ:
        with contextlib.suppress(OSError, TypeError, AttributeError):  # no glibc
            libc = ctypes.CDLL(None)
            libc.mallopt(_TRIM_THRESHOLD, 256 << 20)
            libc.mallopt(_MMAP_THRESHOLD, 32 << 20)


def _call(call: Callable[..., Any], arguments: dict[str, Any]) -> Any:
    """The call, with material and shape in their places, whatever the axes call a shape."""
    rest = dict(arguments)
    places = [rest.pop("material")] if "material" in rest else []
    body = [name for name in ("shape", "surface") if name in rest]
    if places and body:
        places.append(rest.pop(body[0]))
    return call(*places, **rest)


def _place(asked: Grid, chunk: tuple[slice, ...], where: tuple[Any, ...]) -> str:
    """Which call of a chunk it is, by the values of the axes that it does not do at once."""
    named = [
        f"{axis.name} {axis.labels[place.start + i]}"
        for axis, place, i in zip(asked.axes, chunk, where, strict=True)
        if not isinstance(i, slice)
    ]
    return ", ".join(named) or "all"


@contextlib.contextmanager
def _alone(path: Path) -> Iterator[None]:
    """Keeps other processes from the store; a lock that ends with the process that holds it."""
    from filelock import FileLock, Timeout

    lock = path.with_name(f".{path.name}.lock")
    try:
        path.absolute().parent.mkdir(parents=True, exist_ok=True)
        held = FileLock(lock, blocking=False)
        held.acquire()
    except Timeout as error:
        raise InputError(f"store {str(path)!r} is in use by another process.") from error
    except OSError as error:
        raise InputError(f"store must be a folder that can be written, got {str(path)!r}: {error.strerror}.") from error
    try:
        yield
    finally:
        held.release()


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _installed(name: str) -> bool:
    from importlib.util import find_spec

    return find_spec(name) is not None
