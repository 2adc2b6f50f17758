"""Whether the data separate a horizontal shift from a vertical one.

Where storage and loss modulus are one power law, M ~ omega^n with the same n (a
constant loss tangent), a shift by x decades along the frequency is one by n x decades
along the modulus: no data separate them, and only the prior for the vertical shift
chooses. A slope that changes, or differs between the moduli, separates them.
"""

import numpy as np

from .joint import Joint
from .shifting import LN10, Shifts

# relative standard deviation of a step between neighbours above which it may not be
# separable
_POOR = 0.12
# relative standard deviation below which a power law is no matter: it is steep
_SLIGHT = 0.05
_EXCHANGED = 0.5  # part of its variance that is exchange with the vertical shifts
# width of the vertical shifts below which there are none: nothing to be separated from
_FIXED = 1e-4
# standard deviations by which a misfit of the power law must exceed chance to be a
# landmark
_SURE = 3.0


def separable(joint: Joint) -> np.ndarray:
    """Whether the data separate the horizontal shift of an isotherm, from its neighbour
    on the anchor's side, from b_T.

    They do not where its uncertainty is a fair part of it and would mostly be gone if
    the vertical shifts were known; nor where both isotherms follow one power law within
    their scatter.
    """
    shifts, clear = joint.shifts, np.ones(joint.shifts.size, dtype=bool)
    if shifts.size == 1 or shifts.posterior.widths[-1] < _FIXED:
        return clear
    x, by_x = shifts.horizontal(shifts.posterior.mean)
    step_x, step_y = np.diff(by_x, axis=0), np.diff(shifts.vertical(), axis=0)
    covariance = shifts.posterior.covariance
    both = step_x @ covariance @ step_y.T
    known = np.linalg.solve(
        step_y @ covariance @ step_y.T + 1e-12 * np.eye(len(step_y)), both.T
    )
    variance = np.diag(step_x @ covariance @ step_x.T)
    exchanged = np.einsum("ij,ji->i", both, known) / np.maximum(variance, 1e-300)
    relative = np.sqrt(variance) / np.maximum(np.abs(np.diff(x)), 1e-12)
    poor = (relative > _POOR) & (exchanged > _EXCHANGED)
    bare = [
        relative[i] > _SLIGHT and _power_law(shifts, i, joint.inflation)
        for i in range(shifts.size - 1)
    ]
    for i in np.flatnonzero(poor | bare):
        clear[i + 1 if i >= shifts.anchor else i] = False
    return clear


def _power_law(shifts: Shifts, cold: int, alike: float) -> bool:
    """Whether an isotherm and the next one follow one power law, within chance.

    Chi squared of it is compared with that of a parabola in ln omega of its own for
    each modulus.
    """
    points, posterior = shifts.points, shifts.posterior
    at = (points.isotherm == cold) | (points.isotherm == cold + 1)
    channel, warm = points.channel[at], points.isotherm[at] == cold + 1
    log10_a = shifts.horizontal(posterior.mean)[0]
    rate = points.log_rate[at] + LN10 * (
        log10_a[points.isotherm[at]] + points.offset[at]
    )
    rate = rate - rate.mean()
    weight = np.sqrt(posterior.weights[at] / alike) / posterior.noise[channel]
    kinds = [channel == which for which in np.unique(channel)]
    levels = [kind & side for kind in kinds for side in (warm, ~warm)]
    misfits = []
    for shapes in ([rate], [kind * rate**k for kind in kinds for k in (1, 2)]):
        design = np.stack([*levels, *shapes], axis=1) * weight[:, None]
        value = points.log_value[at] * weight
        off = value - design @ np.linalg.lstsq(design, value, rcond=None)[0]
        misfits.append(float(off @ off))
    freedom = 2 * len(kinds) - 1
    return misfits[0] - misfits[1] < freedom + _SURE * np.sqrt(2 * freedom)
