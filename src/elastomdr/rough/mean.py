"""What friction on lines or maps is at each point: a mean, where there are several."""

from typing import NamedTuple

from ..checks import Array


class Mean(NamedTuple):
    """The answer at each point, a mean over lines or maps where there are several."""

    mu: Array
    error: Array
    load: Array
    depth: Array
    share: Array
    good: Array
    scatter: Array | None  # standard error of mu
