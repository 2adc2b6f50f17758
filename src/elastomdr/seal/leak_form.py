"""The leak of `em.Multiscale`: a form in mean gap, real contact and spectrum that was
fitted to three-dimensional maps.

    u = c u_P (u_P/h_rms)^-d,                      u_P by Persson's theory
    w = u^3 phi_0 (1 - A/a)^(k (A/a)^m),           phi_0 = 1 - 0.9 exp(-0.56 u/h_rms)

w/12 viscosity is the flow per width and pressure gradient, A the real contact area,
h_rms the rms height. phi_0 is the flow factor of isotropic surfaces that hardly touch
(Patir and Cheng, J. Lubr. Technol. 100 (1978) 12), which the maps meet where contact is
light. Channels close at A = a; near there all of the pressure falls at single places,
whose resistance grows as a power of about 3.45 (Dapp and Mueser, EPL 109 (2015) 44001):
k was fitted, and is near to it. The constants and the bound are those of
benchmarks/leak_fit.py.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ..arrays import fixed, namespace, xp
from ..checks import is_traced, known
from ..models import GapFlow
from ..numerics.implicit import as_doubles, numbers_with_slopes
from ..rough.psd_integrals import PER_DECADE, cell_counts, nodes
from .persson_gap import Contact, contact_of, critical_gap, mean_gap, scales

_BATCH = 64  # points that are held in memory at once
_TRACED = 24  # cells per decade where JAX traces a value
SAID = "Multiscale (form in mean gap and real contact, fitted to maps of gaps)"


class Form(NamedTuple):
    """The constants, by their letters above."""

    level: float  # c
    bend: float  # d
    closes: float  # a
    power: float  # k
    grows: float  # m


FORM = Form(level=0.945, bend=0.072, closes=0.43, power=3.45, grows=0.7)


def weighed(found: Contact, rms_height: Any, form: Form = FORM) -> tuple[Any, Any]:
    """Mean gap [m] and w [m^3]."""
    xp = namespace(found.area)
    ideal = mean_gap(found)
    gap = form.level * ideal * (ideal / rms_height) ** -form.bend
    flat = 1 - 0.9 * xp.exp(-0.56 * gap / rms_height)
    touching = xp.minimum(found.area / form.closes, 1 - 1e-12)
    through = (1 - touching) ** (form.power * touching**form.grows)
    return gap, xp.where(found.area < form.closes, gap**3 * flat * through, 0.0)


def leak(surface: Any, level: Any) -> GapFlow:
    """The answers at pressures over E*, (points,)."""
    if is_traced(surface, level):
        shared, points = as_doubles((surface, level))
        counts = cell_counts(known(fixed(surface)), _TRACED)
        flow, gap, area, *others = _with_slopes(counts)(shared, points)
        critical, error, model_error = others
        good = xp.isfinite(flow)
    else:
        level = np.asarray(level)
        parts = [
            _numbers(surface, level[i : i + _BATCH])
            for i in range(0, level.size, _BATCH)
        ]
        joined = [np.concatenate(part) for part in zip(*parts, strict=True)]
        flow, gap, area, critical, error, model_error = joined
        good = np.isfinite(flow)
    opens = area < FORM.closes
    return GapFlow(flow, gap, critical, area, opens, error, model_error, good, SAID)


def _numbers(surface: Any, level: Any) -> tuple[Any, ...]:
    """Flow, gap, area, critical gap, relative error of the flow and the bound."""
    fine, coarse = (
        contact_of(nodes(surface, count), level)
        for count in (PER_DECADE, PER_DECADE // 2)
    )
    height = surface.rms_height
    (gap, flow), (_, less) = (weighed(each, height) for each in (fine, coarse))
    with np.errstate(invalid="ignore", divide="ignore"):
        error = np.where(flow > 0, np.abs(flow - less) / flow, 0.0)
    critical = critical_gap(fine, scales(fine))
    return flow, gap, fine.area, critical, error, bound(surface, fine.area)


@functools.lru_cache(64)
def _with_slopes(counts: tuple[int, ...]) -> Callable[..., tuple[Any, ...]]:
    """`_numbers` under a transformation of JAX: derivatives of flow, gap and area."""

    def formula(surface: Any, level: Any) -> tuple[Any, ...]:
        found = contact_of(nodes(surface, _TRACED, counts=counts), level)
        gap, flow = weighed(found, (2 * np.pi * surface.moment(1)) ** 0.5)
        return flow, gap, found.area

    def like(surface: Any, level: Any) -> tuple[Any, ...]:
        return (level,) * 6

    return numbers_with_slopes(_numbers, ((formula, 3),), like)


def bound(surface: Any, area: Any) -> Any:
    """w is within a factor of 1 + this of three dimensions, for 95 % of the maps; NaN
    where channels are closed.
    """
    touching = np.minimum(area / FORM.closes, 1.0)
    with np.errstate(divide="ignore"):
        wide = np.expm1(0.15 - 0.5 * np.log1p(-touching))
    return np.where(area < FORM.closes, wide, np.nan)
