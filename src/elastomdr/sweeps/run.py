"""`em.sweep`: the product of axes of a verb, on the cores of this machine or on a
cluster.
"""

from __future__ import annotations

import contextlib
import ctypes
import functools
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import uuid
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from importlib.util import find_spec
from itertools import islice
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from .. import __version__
from ..checks import in_si, warn_of_failed
from ..errors import ConvergenceWarning, InputError, warn
from ..results.axes import Quantity
from ..results.doubts import FLAGS, TITLE, flags
from .grid import Grid, grid, positional
from .identity import (
    described,
    installed_folders,
    is_ours,
    packed,
    set_here,
    standing,
    unpacked,
)
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
# what a pipe raises whose other end has ended, or that is closed
_ENDED = (EOFError, OSError, ValueError, pickle.UnpicklingError)
# as many processes compute as there are cores
_ONE_CORE = {f"{name}_NUM_THREADS": "1" for name in ("OMP", "MKL", "OPENBLAS")}
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3  # of mallopt, malloc.h
_LOGGED = 30  # seconds between two lines of progress in the log of a job
_AHEAD = 4  # chunks under way or waiting for each thread of a worker
# under way or waiting: clusters that adapt themselves grow to a worker for each five
# seconds of work that they see
_LEAST = 1000
_LOOK = 5  # seconds between two looks at how large the cluster is


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
            returns a result of one of these. It is sent to other processes, with all
            that it refers to (globals, functions, objects, modules of yours), and is
            another call when any of this is changed. These processes have nothing
            else of the script: packages are as they are installed, caches empty.
            Files and environment that a call reads are not looked at.
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
        InputError: wrong axes; what cannot be pickled, or rests on what was set in an
            installed package; a store made with other inputs or by another version, in
            use by another process, or whose metadata are damaged; a disk that is full;
            packages of `elastomdr[sweep]` that are not installed.
        ConnectionError: the cluster was lost. What was done is kept.
    """
    files = _checked_store(store)
    if client is not None and not hasattr(client, "submit"):
        raise InputError(
            argument="client", got=client, accepted="a dask.distributed.Client or None"
        )
    asked = grid(call, axes, fixed)
    sent = packed(asked.parts())
    told = described(sent)
    with Alone(files).held() as alone, contextlib.closing(Process(sent)) as first:
        with files.told():
            kept = ZarrStore(files, asked, told)
        if kept.damaged:
            warn(
                f"{len(kept.damaged)} of {kept.state.size} chunks of store "
                f"{files.place!r} are damaged and computed again; the first: "
                f"{next(iter(kept.damaged.values()))!r} is missing or not as it was "
                "written.",
                UserWarning,
            )
        _check_installed(first, cast(dict[str, str], told["installed"]))
        work = functools.partial(_on_this_machine, first)
        if client is not None:
            work = functools.partial(_on_cluster, client, sent)
        _compute(asked, kept, alone, work, progress)
        with files.told():
            kept.finish()
    _warn_of_failures(asked, kept)
    return kept.opened()


def _checked_store(store: object) -> Files:
    """The files of a store, once all packages are there. Raises `InputError`."""
    missing = [name for name in _NEEDED if find_spec(name) is None]
    if missing:
        raise InputError(
            argument="store",
            got=store,
            accepted=f"given where {', '.join(missing)} are installed",
            hint="pip install elastomdr[sweep]",
        )
    return Files(store)


def _check_installed(process: Process, named: Iterable[str]) -> None:
    """Raises `InputError` where something was set in what is installed: a process that
    computes has it as it is installed.
    """
    try:
        there = process.prepare({*named, *filter(is_ours, sys.modules)})
    except _ENDED as error:
        raise ConnectionError(
            "a process that computes ended at once; what it said stands above."
        ) from error
    if changed := set_here(there):
        raise InputError(
            argument="call",
            accepted="without what was set in an installed package, which the "
            "processes that compute do not have",
            hint=f"{changed}; set it within a function that is the call",
        )


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
    asked: Grid,
    kept: ZarrStore,
    alone: Alone,
    work: Callable[..., Generator[tuple[int, Any]]],
    progress: bool,
) -> None:
    """Computes the chunks that are open by `work`, and keeps each."""
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
    with (
        bar,
        _writers(kept) as keep,
        contextlib.closing(work(chunks, todo)) as finished,
    ):
        for number, computed in finished:
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


class Process:
    """A process of this machine that computes, and has nothing of this one but what it
    is sent: no values, no modules of the user, no change of what is installed.
    """

    def __init__(self, sent: bytes):
        self.sent = sent
        self._start()

    def _start(self) -> None:
        program = (
            f"import sys; sys.path[:] = {installed_folders()!r}; "
            f"from {__name__} import serve; serve({os.getpid()})"
        )
        self._is_ready = self._is_closed = False
        self._process = subprocess.Popen(
            [sys.executable, "-c", program],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=_ONE_CORE | os.environ,
        )

    def _answer(self, asked: object) -> Any:
        process: Any = self._process
        pickle.dump(asked, process.stdin)
        process.stdin.flush()
        answer = pickle.load(process.stdout)
        if isinstance(answer, InputError):
            raise answer
        return answer

    def prepare(self, modules: Iterable[str] = ()) -> dict[str, dict[str, str]]:
        """What stands there in modules that are installed. Raises `InputError`."""
        standing = self._answer((self.sent, [*modules]))
        self._is_ready = True
        return standing

    def compute(self, chunk: tuple[slice, ...]) -> Any:
        """What came of a chunk; in words where that killed the process."""
        try:
            if not self._is_ready:
                self.prepare()
            return self._answer(chunk)
        except _ENDED:
            if not self._is_closed:
                self.close()
                self._start()
            return "its process was killed, possibly for lack of memory."

    def close(self) -> None:
        self._is_closed = True
        self._process.kill()
        with contextlib.suppress(OSError):  # of what was not read
            self._process.__exit__(None, None, None)


def serve(parent: int) -> None:
    """What such a process does, until that which started it has ended."""
    asked, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    os.dup2(2, 1)  # what a call prints
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # it is ended by its parent

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(0.5)
        os._exit(1)

    def answer(what: object) -> None:
        pickle.dump(what, answers)
        answers.flush()

    threading.Thread(target=watch, daemon=True).start()
    sent, modules = pickle.load(asked)
    try:
        points = _given(sent)
        answer(standing(modules))
        while True:
            answer(compute(points, pickle.load(asked)))
    except InputError as error:
        answer(error)
    except EOFError:
        return


def _on_this_machine(
    first: Process, chunks: list[tuple[slice, ...]], todo: list[int]
) -> Generator[tuple[int, Any]]:
    """Chunks as they are finished, in any order, by one process for each core; a few
    are under way.
    """
    count = max(1, min(len(todo), _cores()))
    processes = [first, *(Process(first.sent) for _ in range(count - 1))]
    idle: SimpleQueue[Process] = SimpleQueue()
    for process in processes:
        idle.put(process)

    def computed(number: int) -> tuple[int, Any]:
        process = idle.get()
        try:
            return number, process.compute(chunks[number])
        finally:
            idle.put(process)

    waiting = iter(todo)
    under_way: set[Future[tuple[int, Any]]] = set()
    threads = ThreadPoolExecutor(count)
    try:
        while True:
            for number in islice(waiting, 2 * count - len(under_way)):
                under_way.add(threads.submit(computed, number))
            if not under_way:
                return
            done, under_way = wait(under_way, return_when=FIRST_COMPLETED)
            yield from (each.result() for each in done)
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.close()


def _on_cluster(
    client: Client, sent: bytes, chunks: list[Any], todo: list[int]
) -> Generator[tuple[int, Any]]:
    """Chunks as they are finished, in any order; a few per worker are under way at a
    time.

    When a worker dies, Dask suspects every chunk that it had, so those that are given
    up are computed once more, each alone. What is given up again has killed workers by
    itself; what it did is answered in words.
    """
    from distributed.scheduler import KilledWorker
    from distributed.utils import CancelledError, TimeoutError  # type: ignore[attr-defined]

    # unlike scattered data made again if lost
    shared = client.submit(_given, sent, pure=False) if todo else None
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
) -> Generator[tuple[int, Any]]:
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


def _given(sent: bytes) -> Grid:
    """What a worker computes."""
    return unpacked(sent)["points"]


def compute(
    asked: Grid, chunk: tuple[slice, ...], version: str = __version__
) -> tuple[Parts, str, list[str]]:
    """The calls of a chunk: arrays and attributes by field, what was raised, the models
    that were used.
    """
    if version != __version__:
        raise InputError(
            argument="client",
            got=__version__,
            accepted=f"with workers of elastomdr {version}",
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
                argument="call",
                got=values.shape,
                accepted=f"a function that gives one value per point, {expected}, as "
                f"its {q.key}",
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
