"""Reading and writing files: regular ones of a sensible size are read, and what is
written is whole or not there.
"""

import codecs
import contextlib
import errno
import os
import re
import stat
import tempfile
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

from .errors import InputError

_MOST_BYTES = 200_000_000
_LINK = "It is a link: remove it, or name the file behind it"
_NUMBER = r"(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
# where a cell begins: = and @ always; signs where something is called or piped, before
# the name of a cell, and where more is reckoned than a number with its unit
_FORMULA = re.compile(
    r"((?:^|[,;\t])\s*)(?=[=@\uff1d\uff20]|[+-][^,;\t]*[(|!]"
    rf"|[+-](?!{_NUMBER}(?:[\s%,;\t]|$))\s*(?:\$?[A-Za-z]{{1,3}}\$?\d|[\w.$]+[-+*/^&]))"
)
_MOST_TOML = 5_000_000  # bytes of a scene or a material
_DEEPEST = 10  # parts of a dotted key
_PART = r"""(?:[\w-]++|"[^"\n]*+"|'[^'\n]*+')[ \t]*+"""
_DEEP_KEY = re.compile(rf"(?<![\w\"'-]){_PART}(?:\.[ \t]*+{_PART}){{{_DEEPEST}}}")


@contextlib.contextmanager
def file_as_typed(path: object) -> Iterator[None]:
    """Gives an `InputError` about the file `path` its name as it was typed."""
    try:
        yield
    except InputError as error:
        if error.argument == "path":
            error.got = path
        raise


def as_path(path: Any, name: str = "path") -> Path:
    """A path from its name; raises `InputError` for what is none."""
    if not isinstance(path, (str, os.PathLike)):
        raise InputError(argument=name, got=path, accepted="the name of a file")
    return Path(path)


def read_bytes(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> bytes:
    """The content of a file; raises `OSError` for a folder, a pipe, a device, or more
    than `most` bytes.
    """
    path = Path(path)
    status = path.stat()
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "Not a regular file")
    if status.st_size > most:
        raise OSError(
            errno.EFBIG, f"{status.st_size / 1e6:.0f} MB, more than {most / 1e6:g} MB"
        )
    return path.read_bytes()


def read_text(path: str | os.PathLike[str], most: int = _MOST_BYTES) -> str:
    """A UTF-8 text, or a UTF-16 one that says so by its mark, as editors of Windows
    write them.

    Raises `OSError` as `read_bytes` does, and `UnicodeDecodeError`.
    """
    raw = read_bytes(path, most)
    encoding = (
        "utf-16"
        if raw.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE))
        else "utf-8-sig"
    )
    return raw.decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def read_toml(path: str | os.PathLike[str], argument: str) -> dict[str, Any]:
    """What a TOML file holds that was typed as an argument. Raises `InputError`.

    Its size and the depth of its keys are limited before it is parsed: a key of 20,000
    parts takes 1.5 GB.
    """
    try:
        text = read_text(path, _MOST_TOML)
        if deep := _DEEP_KEY.search(text):
            line = text.count("\n", 0, deep.start()) + 1
            raise ValueError(f"a key in line {line} has more than {_DEEPEST} parts")
        return tomllib.loads(text)
    except OSError as error:
        cause, accepted = error, "a file that can be read"
        hint = error.strerror or str(error)
    except UnicodeDecodeError as error:
        cause, accepted = error, "a file of UTF-8 text"
        line = error.object[: error.start].count(b"\n") + 1
        hint = f"line {line} is none; save it as UTF-8"
    # of tomllib, with line and column, and of a path that is none
    except ValueError as error:
        cause, accepted, hint = error, "valid TOML", " ".join(str(error).split())
    except RecursionError as error:
        hint = "arrays or tables within each other, too deep"
        cause, accepted = error, "valid TOML"
    raise InputError(
        argument=argument, got=str(path), accepted=accepted, hint=hint
    ) from cause


def write_files(files: Mapping[Path, bytes]) -> None:
    """Writes files that are complete whenever they are there: to neighbours first, then
    all of them moved into place. What is there keeps its permissions; a pipe or a
    terminal is written into.

    Raises `InputError` in one line, and leaves nothing behind, where a folder is
    missing or cannot be written, and for a link to a file.
    """
    prepared: dict[Path, Path] = {}
    target = Path()
    try:
        for target, content in files.items():
            mode = _mode(target)
            if mode is None:
                continue
            handle, name = tempfile.mkstemp(dir=target.parent, prefix=".elastomdr-")
            prepared[target] = Path(name)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
                file.flush()
                # a full disk shows here, before anything is replaced
                os.fsync(file.fileno())
            # mkstemp makes private files
            prepared[target].chmod(mode)
        for target, temporary in prepared.items():
            temporary.replace(target)
        for target in files.keys() - prepared.keys():
            _write_into(target, files[target])
    except (OSError, ValueError) as error:
        reason = (
            error.strerror if isinstance(error, OSError) and error.strerror else error
        )
        raise InputError(
            argument="path",
            got=str(target),
            accepted="a file that can be written",
            hint=str(reason),
        ) from error
    finally:
        for temporary in prepared.values():
            temporary.unlink(missing_ok=True)


def _mode(target: Path) -> int | None:
    """The permissions of a file, or of a new one; None of a pipe or a terminal. Raises
    `OSError` for what cannot be written.
    """
    try:
        status = target.stat()
    except FileNotFoundError:
        if target.is_symlink():
            raise OSError(errno.EINVAL, _LINK) from None
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
    if stat.S_ISCHR(status.st_mode) or stat.S_ISFIFO(status.st_mode):
        return None
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "Not a regular file")
    if target.is_symlink():
        raise OSError(errno.EINVAL, _LINK)
    if not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return stat.S_IMODE(status.st_mode)


def _write_into(target: Path, content: bytes) -> None:
    """Raises `OSError` for a pipe that nobody reads, rather than wait."""
    at_once = getattr(os, "O_NONBLOCK", 0)  # which Windows lacks
    handle = os.open(target, os.O_WRONLY | at_once)
    if at_once:
        os.set_blocking(handle, True)
    with os.fdopen(handle, "wb") as file:
        file.write(content)


def csv_text(header: Iterable[str], columns: Mapping[str, Any]) -> str:
    """A comma-separated table: header lines that start with "# ", the titles, one row
    per entry of the columns.

    Numbers have as many digits, up to 17, as it takes to read back the same float64;
    NaN is an empty cell. No text is a formula of a spreadsheet.
    """
    values = [
        column.tolist() if hasattr(column, "tolist") else list(column)
        for column in columns.values()
    ]
    lines = [no_formula(f"# {' '.join(line.split())}") for line in header]
    lines += [
        ",".join(map(_cell, columns)),
        *(",".join(map(_cell, row)) for row in zip(*values, strict=True)),
    ]
    return "\n".join(lines) + "\n"


def no_formula(line: str) -> str:
    """A line with an apostrophe before each cell that a spreadsheet would compute."""
    return _FORMULA.sub(r"\1'", line)


def _cell(value: object) -> str:
    if isinstance(value, float):
        return "" if value != value else repr(float(value))
    entry = no_formula(str(value))
    return (
        f'"{entry.replace(chr(34), 2 * chr(34))}"'
        if set(entry) & set(',"\n')
        else entry
    )
