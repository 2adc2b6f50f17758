"""The cache of compiled code on disk, by which a second start compiles nothing."""

import functools
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

# JAX by itself leaves out what compiles in less than a second, which is most of what a
# scene needs
_SETTINGS = {
    "jax_persistent_cache_min_compile_time_secs": 0.0,
    "jax_persistent_cache_min_entry_size_bytes": -1,
}


@functools.cache
def keep_compiled_code() -> None:
    """Lets JAX keep compiled code between runs, in the user's cache folder.

    Nothing is changed where JAX has been given a cache already, by
    `JAX_COMPILATION_CACHE_DIR` or in its configuration, where it has been told to keep
    none, or where the folder cannot be written.
    """
    import jax

    config: Any = jax.config  # its attributes are made at run time
    if (
        config.jax_compilation_cache_dir is not None
        or not config.jax_enable_compilation_cache
    ):
        return
    if (folder := _usable(_default_folder())) is None:
        return
    config.update("jax_compilation_cache_dir", folder)
    for name, value in _SETTINGS.items():
        if name.upper() not in os.environ:
            config.update(name, value)


def _default_folder() -> str | None:
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = os.path.expanduser(os.path.join(base, "elastomdr", "jax")) if base else ""
    # no home folder: "~" stays as it is
    return folder if os.path.isabs(folder) else None


def _usable(folder: str | None) -> str | None:
    """The folder, made if need be, or None where nothing can be written in it."""
    if folder is None:
        return None
    try:
        Path(folder).mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder):
            return folder
    except (OSError, ValueError):
        return None
