"""The files of a store, in a folder or on object storage: what zarr writes to them, and
the lock, as one process at a time computes a store.
"""

from __future__ import annotations

import contextlib
import os
import posixpath
import socket
import threading
import time
import uuid
import zlib
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError

if TYPE_CHECKING:
    from zarr.abc.store import Store
    from zarr.core.buffer import Buffer

_PARTIAL = ".partial"  # ends the name of a file that is being written to a folder
# an object takes some 30 ms to write, nearly all of it waiting; a file takes none
_WRITERS_TO_FOLDER, _WRITERS_TO_OBJECTS = 1, 16


class Files:
    """Files by their names below the store, such as `mu/0.3`.

    Each is written whole or not at all: in a folder it is renamed when it is complete,
    and an object is only there when it is complete.
    """

    def __init__(self, store: object):
        """Raises `InputError` where `store` is no folder and no URL of a file system
        that fsspec knows.
        """
        given = os.fspath(store) if isinstance(store, (str, os.PathLike)) else ""
        given = "" if "\0" in str(given) else given
        self.folder: Path | None = None  # None of object storage
        if "://" in str(given):
            self._filesystem, self._root = _opened(str(given))
            if getattr(self._filesystem, "local_file", False):
                self.folder = Path(self._root)
        else:
            self.folder = Path(str(given)).resolve()
        if self.folder is None:
            self.place, has_name = str(given).rstrip("/"), "/" in self._root.rstrip("/")
        else:
            from fsspec.implementations.local import LocalFileSystem

            self.place, has_name = str(self.folder), bool(self.folder.name)
            self._filesystem = LocalFileSystem(auto_mkdir=True)
            self._root = self.folder.as_posix()
        if not given or not has_name:
            raise InputError(
                argument="store",
                got=store,
                accepted="a folder or a URL with a bucket and a name, such as "
                "'s3://bucket/runs.zarr'",
            )

    @property
    def writers(self) -> int:
        """How many threads write chunks at a time."""
        return _WRITERS_TO_OBJECTS if self.folder is None else _WRITERS_TO_FOLDER

    def zarr_store(self) -> Any:
        """The same files as zarr takes them."""
        from zarr.storage import FsspecStore, LocalStore

        if self.folder is not None:
            return LocalStore(self.folder)
        return FsspecStore.from_url(self.place, {"use_listings_cache": False})

    @contextlib.contextmanager
    def told(self) -> Iterator[None]:
        """Says in one line what keeps the store from being read or written. Raises
        `InputError`.
        """
        # clients of object storage have exceptions of their own
        errors = Exception if self.folder is None else OSError
        try:
            yield
        except InputError:
            raise
        except errors as error:
            raise InputError(
                argument="store",
                got=self.place,
                accepted="one that can be written",
                hint=f"{getattr(error, 'strerror', None) or error}; what was finished "
                "is in it, and the same call goes on from there",
            ) from error

    def is_empty(self) -> bool:
        """Whether there is nothing, or a folder with nothing in it."""
        try:
            return not self._filesystem.ls(self._root, detail=False)
        except FileNotFoundError:
            return True

    def names(self) -> list[str]:
        """All files that are complete; what a killed process has left of others is
        removed.
        """
        root = f"{self._root}/"
        every = [path.removeprefix(root) for path in self._filesystem.find(self._root)]
        self.remove(name for name in every if name.endswith(_PARTIAL))
        return [name for name in every if not name.endswith(_PARTIAL)]

    def read(self, names: Sequence[str]) -> list[bytes | None]:
        """Contents, all asked for at the same time; None where there is no file."""
        # from the first byte on: s3fs would ask for the size of a whole file first
        count = len(names)
        contents: list[Any] = self._filesystem.cat_ranges(
            [self._path(name) for name in names], [0] * count, [None] * count
        )
        return [
            content if isinstance(content, bytes) else self._read_whole(name)
            for name, content in zip(names, contents, strict=True)
        ]

    def _read_whole(self, name: str) -> bytes | None:
        """A file that is not there, or empty: that has no first byte."""
        try:
            content: Any = self._filesystem.cat_file(self._path(name))
            return content
        except (FileNotFoundError, NotADirectoryError, IsADirectoryError):
            return None

    def write(self, name: str, content: bytes) -> None:
        path = self._path(name)
        if self.folder is None:
            self._filesystem.pipe_file(path, content)
        else:
            self._filesystem.pipe_file(path + _PARTIAL, content)
            os.replace(path + _PARTIAL, path)

    def remove(self, names: Iterable[str]) -> None:
        for name in names:
            try:
                self._filesystem.rm_file(self._path(name))
            except FileNotFoundError:
                continue

    def checksums(self, names: Sequence[str]) -> dict[str, list[int] | None]:
        """Size and CRC-32 of files; None where there is none, as zarr writes none for a
        chunk that is NaN all over.
        """
        return {
            name: None if content is None else checksum(content)
            for name, content in zip(names, self.read(names), strict=True)
        }

    def _path(self, name: str) -> str:
        return posixpath.normpath(f"{self._root}/{name}")


def _opened(url: str) -> tuple[Any, str]:
    """The file system of a URL and the path in it. Raises `InputError`."""
    from fsspec.core import url_to_fs

    try:
        # another process may write between two looks
        return url_to_fs(url, use_listings_cache=False)
    except (ImportError, ValueError) as error:
        raise InputError(
            argument="store",
            got=url,
            accepted="a folder or a URL of a file system that fsspec knows and whose "
            "package is installed",
            hint=str(error),
        ) from error


def remembered(store: Store) -> Any:
    """The same store, which keeps `checksums` of what is written through it, so that
    nothing has to be read again for them.
    """
    from zarr.storage import WrapperStore

    class Written(WrapperStore[Any]):
        # by file: size and CRC-32, or None of one that was deleted
        checksums: dict[str, list[int] | None]

        async def set(self, key: str, value: Buffer) -> None:
            await super().set(key, value)
            self.checksums[key] = checksum(value.to_bytes())

        async def set_if_not_exists(self, key: str, value: Buffer) -> None:
            await super().set_if_not_exists(key, value)
            self.checksums.pop(key, None)  # not known

        async def _set_many(self, values: Iterable[tuple[str, Buffer]]) -> None:
            for key, value in values:
                await self.set(key, value)

        async def delete(self, key: str) -> None:
            await super().delete(key)
            self.checksums[key] = None

    written = Written(store)
    written.checksums = {}
    return written


def checksum(content: bytes) -> list[int]:
    """Size and CRC-32."""
    return [len(content), zlib.crc32(content)]


# seconds between two renewals of a mark; who finds one waits for three of them
_RENEWAL = 10.0


class Alone:
    """What keeps other processes from a store; `check` raises where one has come all
    the same.
    """

    def __init__(self, files: Files):
        self._files = files
        name = files.place.rstrip("/").rpartition("/")[2]
        self._file = f"../.{name}.lock"
        self._owner = f"{socket.gethostname()}, process {os.getpid()}, {uuid.uuid4()}"
        self._ended = threading.Event()
        self._taken_by = ""

    @contextlib.contextmanager
    def held(self) -> Iterator[Alone]:
        """Holds the lock. Raises `InputError` where another process does."""
        folder = self._files.folder
        if folder is None:
            yield from self._marked()
            return
        from filelock import FileLock, Timeout

        lock = folder.with_name(f".{folder.name}.lock")
        try:
            folder.parent.mkdir(parents=True, exist_ok=True)
            held = FileLock(lock, blocking=False)
            held.acquire()
        except Timeout as error:
            raise self._in_use("another process") from error
        except NotImplementedError:  # a file system of a cluster without locks
            yield from self._marked()
            return
        except OSError as error:
            raise InputError(
                argument="store",
                got=self._files.place,
                accepted="a folder that can be written",
                hint=str(error.strerror or error),
            ) from error
        try:
            yield self
        finally:
            held.release()

    def check(self) -> None:
        """Raises `InputError` where another process has taken the store."""
        if self._taken_by:
            raise self._in_use(self._taken_by)

    def _marked(self) -> Iterator[Alone]:
        """Where there are no locks that end with their process: a file that its owner
        renews; one that nobody renews is of a process that was killed.
        """
        with self._files.told():
            if (mark := self._mark()) and self._is_renewed(mark):
                raise self._in_use(mark.rpartition(",")[0])
            self._write(0)
        renewing = threading.Thread(target=self._renew, daemon=True)
        renewing.start()
        try:
            yield self
        finally:
            self._ended.set()
            renewing.join()
            if not self._taken_by:
                with contextlib.suppress(Exception):  # who comes next waits a little
                    self._files.remove([self._file])

    def _mark(self) -> str:
        (content,) = self._files.read([self._file])
        return "" if content is None else content.decode(errors="replace")

    def _write(self, count: int) -> None:
        self._files.write(self._file, f"{self._owner}, {count}".encode())

    def _is_renewed(self, mark: str) -> bool:
        end = time.monotonic() + 3 * _RENEWAL
        while time.monotonic() < end:
            time.sleep(_RENEWAL / 5)
            now = self._mark()
            if now != mark:
                return bool(now)
        return False

    def _renew(self) -> None:
        count = 0
        while not self._ended.wait(_RENEWAL):
            count += 1
            with contextlib.suppress(Exception):  # a network that fails for a moment
                mark = self._mark()
                if mark and not mark.startswith(self._owner):
                    self._taken_by = mark.rpartition(",")[0]
                    return
                self._write(count)

    def _in_use(self, by: str) -> InputError:
        return InputError(
            argument="store",
            got=self._files.place,
            accepted=f"in use by nobody else, but {by} writes to it",
        )
