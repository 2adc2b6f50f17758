"""Surfaces as they are measured, with a lay and skewed heights."""

import numpy as np

from elastomdr.surface.lay import Lay
from elastomdr.surface.topography import MeasuredSurface


def measured(road, lay=None, skewness=0.0):
    """The surface as one that was measured, with a lay of this ln g at all scales."""
    q = road.q
    if lay is not None:
        lay = Lay(q, np.full(q.size, lay), np.zeros(q.size), 0.0)
    return MeasuredSurface(
        q=q, c=road.c, relative_error=0 * q, measured_height=road.rms_height,
        skewness=skewness, skewness_error=0.0, report=(), lay=lay,
    )  # fmt: skip
