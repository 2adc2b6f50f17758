"""The command line as a process of its own: how little it loads, and where it keeps
compiled code.
"""

import os
import subprocess
import sys

import pytest

import elastomdr as em

from .cli_cases import SCENE


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*argv: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        argv,
        capture_output=True,
        text=True,
        env={**os.environ, **environment},
        check=False,
        timeout=120,
    )


CODES = {
    "import": "import elastomdr; dir(elastomdr)",
    "help": (
        "import elastomdr.cli.main as m\ntry: m.main(['--help'])\nexcept SystemExit "
        "as e: assert not e.code"
    ),
    "help of a command": (
        "import elastomdr.cli.main as m\ntry: m.main(['friction', '--help'])\n"
        "except SystemExit as e: assert not e.code"
    ),
    "bad scene": (
        "import elastomdr.cli.main as m\nassert m.main(['friction', 'scene.toml']) == 2"
    ),
}


@pytest.mark.parametrize("code", CODES)
def test_what_is_not_needed_is_not_loaded(place, code):
    (place / "scene.toml").write_text(SCENE.replace("load", "laod"))
    code = CODES[code]
    heavy = "{'jax', 'matplotlib', 'numpy', 'scipy', 'pint', 'equinox', 'diffrax'}"
    done = run(
        sys.executable,
        "-c",
        (
            f"{code}\nimport sys; assert not {heavy} & set(sys.modules), "
            "sys.modules.keys()"
        ),
    )
    assert done.returncode == 0, done.stderr


def test_the_command_itself(place):
    (place / "scene.toml").write_text(SCENE.replace("load", "laod"))
    command = [sys.executable, "-m", "elastomdr"]
    done = run(*command, "friction", "scene.toml")
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (2, "", 1)
    assert run(*command, "--version").stdout.strip() == f"elastomdr {em.__version__}"


CACHES = """
import sys, jax
from elastomdr.arrays import keep_compiled_code

def kept(folder, enabled=True):
    keep_compiled_code.cache_clear()
    jax.config.update("jax_compilation_cache_dir", folder)
    jax.config.update("jax_enable_compilation_cache", enabled)
    keep_compiled_code()
    config = jax.config
    return (
        config.jax_compilation_cache_dir,
        config.jax_persistent_cache_min_compile_time_secs,
    )

own, place = sys.argv[1:]
keep_compiled_code()
assert jax.config.jax_compilation_cache_dir == own  # by the environment
assert kept("given") == ("given", 1.0)
assert kept(None, enabled=False) == (None, 1.0)
assert not os.path.exists(place)
open(place, "w").close()
assert kept(None) == (None, 1.0)  # a folder that cannot be made
os.remove(place)
assert kept(None) == (os.path.join(place, "elastomdr", "jax"), 0.0)
"""


@pytest.mark.skipif(
    sys.platform != "linux", reason="the place of the cache is the platform's"
)
def test_a_cache_of_the_users_own_stays_as_it_is(place):
    """That verbs keep compiled code, and what a damaged cache is told, is seen in
    `tests/whole/test_edges.py`.
    """
    own, cache = str(place / "own"), str(place / "cache")
    settings = {
        key: value for key, value in os.environ.items() if not key.startswith("JAX_")
    }
    settings |= {"JAX_COMPILATION_CACHE_DIR": own, "XDG_CACHE_HOME": cache}
    done = subprocess.run(
        [sys.executable, "-c", f"import os{CACHES}", own, cache],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env=settings,
    )
    assert done.returncode == 0, done.stderr
