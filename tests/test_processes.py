"""The command line as a process of its own: how little it loads, and where it keeps compiled code."""

import os
import subprocess
import sys

import jax
import pytest

import elastomdr as em
from elastomdr.cli import cache

from .cli_cases import SCENE


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*argv: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        argv, capture_output=True, text=True, env={**os.environ, **environment}, check=False, timeout=120
    )


@pytest.mark.parametrize("code", ["import elastomdr; dir(elastomdr)", "HELP", "VERSION"])
def test_what_is_not_needed_is_not_loaded(code):
    ask = "import elastomdr.cli.main as m\ntry: m.main(['--{}'])\nexcept SystemExit as e: assert not e.code"
    code = {"HELP": ask.format("help"), "VERSION": ask.format("version")}.get(code, code)
    heavy = "{'jax', 'matplotlib', 'numpy', 'scipy', 'pint', 'equinox', 'diffrax'}"
    done = run(sys.executable, "-c", f"{code}\nimport sys; assert not {heavy} & set(sys.modules), sys.modules.keys()")
    assert done.returncode == 0, done.stderr


def test_the_command_itself(place):
    (place / "scene.toml").write_text(SCENE.replace("load", "laod"))
    command = [sys.executable, "-c", "import sys; from elastomdr.cli.main import main; sys.exit(main())"]
    done = run(*command, "friction", "scene.toml")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert run(*command, "--version").stdout.strip() == f"elastomdr {em.__version__}"


@pytest.fixture
def jax_settings():
    names = (
        "jax_compilation_cache_dir",
        "jax_persistent_cache_min_compile_time_secs",
        "jax_persistent_cache_min_entry_size_bytes",
    )
    before = {name: getattr(jax.config, name) for name in names}
    yield
    for name, value in before.items():
        jax.config.update(name, value)


@pytest.mark.usefixtures("jax_settings")
def test_cache_folder(place, monkeypatch):
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(place / "cache"))
    cache.enable_cache()
    assert jax.config.jax_compilation_cache_dir == str(place / "cache" / "elastomdr" / "jax")
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(place / "own"))
    cache.enable_cache()
    assert jax.config.jax_compilation_cache_dir == str(place / "own")
    (place / "file").write_text("")
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(place / "file" / "below"))
    cache.enable_cache()
    assert jax.config.jax_compilation_cache_dir is None
