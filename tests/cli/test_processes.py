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


START = """
import os, sys, jax
jax.config.update("jax_compilation_cache_dir", GIVEN) if GIVEN else None
import elastomdr as em
em.indent(em.Foundation(4e6, [], []), em.Paraboloid(0.01), time=[0.0, 1.0], load=[0.0, 1.0], adhesion=0.1)
print(jax.config.jax_compilation_cache_dir, jax.config.jax_persistent_cache_min_compile_time_secs)
"""


def start(place, given=None, **environment: str) -> str:
    """Computes something in a new process; returns where it keeps compiled code, and
    from what time of compiling on.
    """
    own = {"XDG_CACHE_HOME": str(place / "cache"), "HOME": str(place)}
    settings = {
        key: value for key, value in os.environ.items() if not key.startswith("JAX_")
    }
    code = START.replace("GIVEN", repr(given))
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
        env={**settings, **own, **environment},
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


@pytest.mark.skipif(
    sys.platform != "linux", reason="the place of the cache is the platform's"
)
def test_compiled_code_is_kept(place):
    folder = place / "cache" / "elastomdr" / "jax"
    assert start(place) == f"{folder} 0.0"
    kept = {path.name: path.stat().st_mtime_ns for path in folder.glob("*-cache")}
    assert kept
    start(place)
    # compiled nothing
    assert {
        path.name: path.stat().st_mtime_ns for path in folder.glob("*-cache")
    } == kept


@pytest.mark.skipif(
    sys.platform != "linux", reason="the place of the cache is the platform's"
)
def test_a_cache_of_the_users_own_stays_as_it_is(place):
    assert (
        start(place, JAX_COMPILATION_CACHE_DIR=str(place / "own"))
        == f"{place / 'own'} 1.0"
    )
    assert start(place, given=str(place / "own")) == f"{place / 'own'} 1.0"
    assert start(place, JAX_ENABLE_COMPILATION_CACHE="false") == "None 1.0"
    assert not (place / "cache").exists()
    (place / "cache").write_text("")
    assert start(place) == "None 1.0"  # a folder that cannot be made
