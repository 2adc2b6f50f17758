"""One cache of compiled code for both workers, the commands that tests start, and the next run.

The tests compile far longer than they compute, so the compiler's last stage is asked for less: the programs are the
same, their machine code is plainer, and the suite takes a sixth less time.
"""

import os


def pytest_configure(config):
    if hasattr(config, "workerinput") or "JAX_COMPILATION_CACHE_DIR" in os.environ or not hasattr(config, "cache"):
        return  # workers inherit what is set here
    os.environ["JAX_COMPILATION_CACHE_DIR"] = str(config.cache.mkdir("compiled"))
    os.environ["XLA_FLAGS"] = os.environ.get("XLA_FLAGS", "") + " --xla_backend_optimization_level=0"
    os.environ["JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS"] = "0.3"
