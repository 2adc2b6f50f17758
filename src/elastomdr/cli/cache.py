"""The cache of compiled code that makes a second start fast."""

import os
import sys
import tempfile
from pathlib import Path

DAMAGED = "the cache of compiled code is damaged, so everything was compiled anew: remove elastomdr's cache folder."


def enable_cache() -> None:
    """Lets JAX keep compiled code between runs, in the user's cache folder or in JAX_COMPILATION_CACHE_DIR.

    Where neither can be written, everything is compiled anew, as if there were no cache.
    """
    import jax

    folder = _usable(os.environ.get("JAX_COMPILATION_CACHE_DIR") or _default_folder())
    jax.config.update("jax_compilation_cache_dir", folder)
    # JAX by itself leaves out what compiles in less than a second, which is most of what a scene needs.
    jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
    jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)


def _default_folder() -> str | None:
    if sys.platform == "win32":
        base = os.environ.get("LOCALAPPDATA")
    elif sys.platform == "darwin":
        base = "~/Library/Caches"
    else:
        base = os.environ.get("XDG_CACHE_HOME") or "~/.cache"
    folder = os.path.expanduser(os.path.join(base, "elastomdr", "jax")) if base else ""
    return folder if os.path.isabs(folder) else None  # no home folder: "~" stays as it is


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
