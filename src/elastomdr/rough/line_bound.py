"""How far the MDR line may be from three dimensions on a surface under a pressure."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from ..checks import is_traced
from ..models import Line

FULL = "full contact"
# Upper envelope F(r) of mu_3D/mu_line over the cutoff ratio r = q_high/q_low: a power
# law through the figures of 270 points of a three-dimensional solver (own map; at 65 %
# contact mu_line/mu_3D is .23, .09, .034 at r = 4, 16, 64 by the book's rule and .84,
# .71, .54 by that of full contact), times the factor that takes it to the worst of all
# points at r = 64 (.02 and .36). The line is at most 1.84 (1.41) times too high, which
# is within mu (F - 1) as well. The direction average lowers a line by up to 2. Beyond r
# = 64 the power law is an extrapolation; at 4.8 decades it still covers the distance
# from Persson's theory.
_BOOK = 2.9, 0.69
_FULL_CONTACT = 1.45, 0.16
_AVERAGED = 2.0
_WIDEST = 1e5  # cutoff ratio up to which the bound is given
_SEEN = 10.0  # cutoff ratio above which a warning says what is missed


def factor(surface: Any, model: Line) -> Any:
    """F: three-dimensional friction is at most F times that of the line; NaN beyond
    where that is known.
    """
    ratio = surface.q_high / surface.q_low
    scale, power = _FULL_CONTACT if isinstance(model.equivalent_length, str) else _BOOK
    numpy: Any = jnp if is_traced(ratio) else np
    whole = scale * ratio**power * (_AVERAGED if model.average else 1.0)
    return numpy.where(ratio <= _WIDEST, whole, np.nan)


def missed(surface: Any, model: Line) -> str | None:
    """What the line misses on a surface under a pressure, for a warning; None where
    that is little.
    """
    if is_traced(surface):
        return None
    ratio = float(surface.q_high / surface.q_low)
    if ratio <= _SEEN:
        return None
    most = float(factor(surface, model))
    by = (
        f"by a factor of up to {most:.2g}"
        if np.isfinite(most)
        else "by a factor that is not known"
    )
    return (
        "the MDR line does not see how the short waves of a surface act under the "
        f"long ones, here over a cutoff ratio of {ratio:.3g}; mu may be too low {by}; "
        "use em.Multiscale()."
    )
