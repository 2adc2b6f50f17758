"""One cache of compiled code for both workers, the commands that tests start, and the
next run.

The tests compile far longer than they compute, so the compiler is asked for plainer
machine code: the programs are the same, they run three times slower, and the suite
takes half the time. `pytest -p no:cacheprovider` tests the machine code that users get.

Python's bytecode is kept beside it, even where the environment asks for none: each
worker and each command would translate JAX and the package again, 2 to 3 s each time.

Linear algebra runs on one thread: beside the other worker's, threads mostly wait for a
core, and count that as work.

Python looks for garbage seldom: tracing makes so many objects that looking took a fifth
of its time.
"""

import gc
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

collect_ignore = ["typing"]  # read by pyright, not run
# files of few, long tests: begun last, one worker would wait for the other
LONG = ("test_notebooks.py", "test_site.py", "test_examples.py", "test_same_bits.py")
# pieces of memory that a process has mapped; Linux ends one with more than 65,530
MANY = 25_000
PLAIN = (
    "--xla_backend_optimization_level=0 --xla_cpu_use_fusion_emitters=false"
    " --xla_cpu_parallel_codegen_split_count=1"
)
# of the browser: names outside of this machine do not resolve
ALONE = "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1"
# read when NumPy is loaded: by workers and the commands that tests start
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def keep_bytecode(folder: Path) -> None:
    """In a folder of its own, so that none lies among the sources."""
    os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
    os.environ["PYTHONPYCACHEPREFIX"] = sys.pycache_prefix = str(folder)
    sys.dont_write_bytecode = False


def pytest_configure(config):
    if hasattr(config, "workerinput") or not hasattr(config, "cache"):
        return  # workers inherit what is set here
    if sys.dont_write_bytecode:
        keep_bytecode(config.cache.mkdir("bytecode"))
    if "JAX_COMPILATION_CACHE_DIR" in os.environ:
        return
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(config.cache.mkdir("compiled"))
    os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.3"
    flags = f"{os.environ.get('XLA_FLAGS', '')} {PLAIN}".strip()
    # another jaxlib may not know them, and would abort
    ask = [sys.executable, "-c", "import jax; jax.devices()"]
    if (
        subprocess.run(
            ask,
            env={**os.environ, "XLA_FLAGS": flags},
            capture_output=True,
            check=False,
        ).returncode
        == 0
    ):
        os.environ["XLA_FLAGS"] = flags


def pytest_collection_modifyitems(items):
    items.sort(key=lambda item: item.path.name not in LONG)


def pytest_collection_finish():
    gc.collect()
    gc.freeze()  # modules and collected tests stay
    gc.set_threshold(50_000, 20, 10)


@pytest.fixture(autouse=True, scope="module")
def forget_programs():
    """Compiled programs take some pieces of memory each, and a worker compiles
    thousands of them.
    """
    yield
    maps = Path("/proc/self/maps")
    if maps.exists() and maps.read_bytes().count(b"\n") > MANY:
        import jax

        jax.clear_caches()


@pytest.fixture(scope="module")
def chromium():
    """A headless Chromium, the system's, driven by Playwright."""
    program = shutil.which("chromium") or shutil.which("chromium-browser")
    if program is None:
        pytest.skip("Chromium is not installed (apt-get install chromium)")
    driver = pytest.importorskip("playwright.sync_api")
    with driver.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program,
            args=["--no-sandbox", "--disable-gpu", "--in-process-gpu", ALONE],
        )
        yield browser
        browser.close()


@pytest.fixture
def write(tmp_path):
    """Writes a text file and returns its path."""

    def file(text: str, name: str = "dma.csv", encoding: str = "utf-8"):
        path = tmp_path / name
        path.write_bytes(text.encode(encoding))
        return path

    return file
