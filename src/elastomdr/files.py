"""Reading what a user points at: a regular file of a sensible size, so that a pipe or a device cannot hang a run."""

import errno
import os
import stat
from pathlib import Path

_MOST_BYTES = 200_000_000


def read_bytes(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> bytes:
    """The content of a file; raises `OSError` for a folder, a pipe, a device, or more than `most` bytes."""
    path = Path(path)
    found = path.stat()
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "Not a regular file")
    if found.st_size > most:
        raise OSError(errno.EFBIG, f"{found.st_size / 1e6:.0f} MB, more than {most / 1e6:g} MB")
    return path.read_bytes()


def read_text(path: str | os.PathLike[str]) -> str:
    """A UTF-8 text, with or without its mark; raises `OSError` as `read_bytes` does, and `UnicodeDecodeError`."""
    return read_bytes(path).decode("utf-8-sig").replace("\r\n", "\n").replace("\r", "\n")
