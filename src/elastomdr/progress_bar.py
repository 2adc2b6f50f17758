"""How far a long computation is: what computes counts its steps, `em.progress` shows
them.
"""

import contextlib
import contextvars
import math
import sys
import threading
import time
import warnings
from collections.abc import Callable, Iterator
from typing import Any

from .errors import InputError

DELAY = 0.8  # seconds before a bar appears
_REFRESH = 1.0  # seconds after which the clock is drawn anew, and
_SHORTEST = 0.1  # between two drawings
_KNOWN = "{desc}: {percentage:3.0f} %|{bar}| {elapsed}, {remaining} left"
_UNKNOWN = "{desc}: {elapsed}"

_bar: contextvars.ContextVar["_Bar | None"] = contextvars.ContextVar(
    "progress", default=None
)


class _Bar:
    """A bar that appears after `DELAY` and keeps its clock going while nothing is
    counted.
    """

    def __init__(self, doing: str):
        self._title, self._total, self._done = doing, 0.0, 0.0
        self._drawn: Any = None
        # filters of warnings are those of all threads: not from the clock's
        self._kind = _kind_of_bar() if _in_notebook() else None
        self._end = threading.Event()
        self._lock = threading.Lock()
        self._since = time.time()  # when it was begun
        self._seen = math.inf  # when it was drawn last
        self._clock = threading.Thread(target=self._keep_going, daemon=True)
        self.counting = False
        self._clock.start()

    def _keep_going(self) -> None:
        wait = DELAY
        while not self._end.wait(wait):
            self._draw()
            wait = _REFRESH

    def at(self, doing: str, done: float, total: float) -> None:
        """`done` of `total` steps of what is being done; a total of 0 is not known."""
        with self._lock:
            if doing != self._title or done < self._done:
                self._since = time.time()  # something new, with a time left of its own
            self._title, self._done, self._total = doing, min(done, total), total
        if time.monotonic() - self._seen > _SHORTEST:
            self._draw()

    def _draw(self) -> None:
        with self._lock:
            if self._drawn is None:
                kind = self._kind or _kind_of_bar()
                self._drawn = kind(desc=self._title, leave=False, bar_format=_UNKNOWN)
            bar = self._drawn
            bar.set_description_str(self._title, refresh=False)
            bar.bar_format = _KNOWN if self._total else _UNKNOWN
            bar.start_t = self._since
            bar.total, bar.n = self._total or None, self._done
            bar.refresh()
            self._seen = time.monotonic()

    def close(self) -> None:
        self._end.set()
        self._clock.join()
        if self._drawn is not None:
            self._drawn.close()


def _kind_of_bar() -> Any:
    """The bar of tqdm for a notebook, or for a terminal."""
    if not _in_notebook():
        from tqdm import tqdm

        return tqdm
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # a notebook without widgets has bars of text
        from tqdm.auto import tqdm

    return tqdm


@contextlib.contextmanager
def progress(doing: str = "computing") -> Iterator[None]:
    """Shows how far what is computed within is, and the time left, on a terminal or in
    a notebook.

    Args:
        doing: what is being done, in a few words; calls that know more say so.

    Returns:
        A context, for `with`.

    Raises:
        InputError: where `doing` is no text.

    A bar appears after 0.8 s and vanishes at the end; where the standard error is
    neither a terminal nor a notebook's, there is none.

        with em.progress():
            curve = em.friction(rubber, road, ...)
    """
    if not isinstance(doing, str):
        raise InputError(argument="doing", got=doing, accepted="a text")
    if _bar.get() is not None or not (sys.stderr.isatty() or _in_notebook()):
        yield
        return
    bar = _Bar(doing)
    token = _bar.set(bar)
    try:
        yield
    finally:
        _bar.reset(token)
        bar.close()


def _in_notebook() -> bool:
    """Whether this process runs a notebook's cells: that ipykernel was imported, which
    other tools do, is not enough.
    """
    ipython = sys.modules.get("IPython")
    shell = None if ipython is None else ipython.get_ipython()
    return hasattr(shell, "kernel")


@contextlib.contextmanager
def counted(doing: str, total: float) -> Iterator[Callable[[float], None]]:
    """A function that adds steps to those that are done, of `total`. What is counted
    within something that is counted is not shown.
    """
    bar = _bar.get()
    if bar is None or bar.counting:
        yield lambda steps: None
        return
    done = 0.0

    def add(steps: float) -> None:
        nonlocal done
        done += steps
        bar.at(doing, done, total)

    bar.counting = True
    try:
        add(0.0)
        yield add
    finally:
        bar.counting = False


def reporter(
    doing: str, also: Callable[[int, int], None] | None
) -> Callable[[int, int], None]:
    """A function of the steps done and their total, which hands them on to `also`;
    after the last of them only the time is shown. Raises `InputError`.
    """
    if also is not None and not callable(also):
        raise InputError(
            argument="progress",
            got=also,
            accepted="a function of the points done and of all of them",
        )

    def report(done: int, total: int) -> None:
        bar = _bar.get()
        if bar is not None and not bar.counting:
            bar.at(doing, done, 0 if done >= total else total)
        if also is not None:
            also(done, total)

    return report
