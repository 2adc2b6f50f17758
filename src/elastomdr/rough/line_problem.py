"""The arguments of a scene on a rough line or surface, checked and broadcast, with its
lines; and how far the MDR line may be from three dimensions under a pressure.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from ..call.problem import SteadyScene, rough_scene
from ..checks import (
    is_traced,
    scalar,
    untraced,
    whole_number,
)
from ..element.law import Foundation, as_foundation
from ..errors import InputError
from ..models import Line, seeds_of
from ..results.words import brief
from ..surface.rough_line import RoughLine
from ..surface.spectrum import MOST, AbstractSpectrum
from .ensemble import ensemble
from .heat import check_heat
from .problem import RoughCall

if TYPE_CHECKING:
    from .._types import Number
    from ..call.types import Surface
    from ..checks import Array

# p/(E*(0) rms slope) up to which the book's rule is one of light contact
# (docs/rough.md)
_LIGHT = 0.03
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


class RoughScene(NamedTuple):
    """The points of a call on lines, with the lines, and what they are pressed with."""

    at: SteadyScene
    lines: list[RoughLine]
    seeds: tuple[int, ...]  # of the lines
    control: Literal["load", "depth"]
    given: np.ndarray  # line load over b_T [N/m] or depth [m] of each point, flat
    # that turns the pressure into a line load [m]; None without a pressure
    length: float | None
    rule: str  # how, in words

    def inputs(self, *surface: tuple[str, str]) -> list[tuple[str, str]]:
        """For results: the material, the `surface`, the points, and what pressure the
        line has where it has one.
        """
        rows, given = (
            self.at.inputs(*surface, load="N/m"),
            self.given * self.at.vertical.ravel(),
        )
        return (
            rows if self.length is None else [*rows, ("line load", brief(given, "N/m"))]
        )


def check(call: RoughCall, model: Line) -> RoughScene:
    """Checks the arguments and makes the lines. Raises `InputError`."""
    surface, asked, heat = call.surface, call.asked, call.heat
    foundation = as_foundation(call.material)
    points = rough_scene(
        foundation, surface, call.rtol, asked, "pressure", "load", "depth"
    )
    untraced(
        InputError(
            argument="model",
            got=model,
            accepted="em.Multiscale() or em.Persson() under jax.grad, jit and vmap, on "
            "a surface under a pressure",
            hint="rough lines have no derivatives",
        ),
        surface,
        points,
        model.equivalent_length,
    )
    check_heat(heat, asked.temperature, call.branch, False)
    if heat is not None and (isinstance(surface, RoughLine) or asked.pressure is None):
        raise InputError(
            argument="heat",
            got=heat,
            accepted="left out without a pressure on a surface given by its spectrum",
            hint="the flash temperature depends on the contact area of a surface, "
            "which a line has not",
        )
    whole_number("periods", model.periods, 1, MOST)
    if model.samples is not None:
        whole_number("samples", model.samples, 64, MOST)
    which = seeds_of(model.seeds)
    length, rule = _length(surface, points.name, model.equivalent_length)
    lines = ensemble(surface, model.samples, model.periods, which)
    given = np.ravel(points.at_reference())
    return RoughScene(
        points,
        lines,
        which,
        "depth" if points.name == "depth" else "load",
        given if length is None else given * length,
        length,
        rule,
    )


def _length(
    surface: Surface, name: str, equivalent_length: Number | str | None
) -> tuple[float | None, str]:
    """The length that turns a pressure into a line load, None without one, and the rule
    in words; `name` is given.
    """
    if name != "pressure":
        if equivalent_length is not None:
            raise InputError(
                argument="equivalent_length",
                got=equivalent_length,
                accepted=f"left out with a {name}",
                hint="it turns a pressure into a line load",
            )
        return (
            None,
            "; load per length of line, no pressure"
            if name == "load"
            else "; depth of the line",
        )
    if equivalent_length is not None and not isinstance(equivalent_length, str):
        length = float(scalar("equivalent_length", equivalent_length))
        return length, f"; pressure p as line load p L with L = {length:.4g} m as given"
    if not isinstance(surface, AbstractSpectrum):
        raise InputError(
            argument="equivalent_length",
            accepted="given to em.Line [m] for a pressure on a RoughLine, the width of "
            "surface that the line stands for",
            hint="the load per length is pressure times equivalent_length; or give "
            "load, in N/m",
        )
    if equivalent_length is None:
        length = float(2 * np.pi / surface.q_low)
        return length, (
            f"; pressure p as line load p L with L = 2 pi/q_low = {length:.4g} m "
            "(Popov & Hess 2015, ch. 10; the "
            "equivalence holds to a factor of order one, in light contact)"
        )
    if equivalent_length != FULL:
        raise InputError(
            argument="equivalent_length",
            got=equivalent_length,
            accepted=f"a length [m] or {FULL!r}",
        )
    length = float(surface.full_contact_length)
    return length, (
        "; pressure p as line load p L with L = 2 <q^2 C>/<q^3 "
        f"C> = {length:.4g} m, that of full contact"
    )


def load_level(
    foundation: Foundation,
    surface: Surface,
    pressure: Array,
    rule: Number | str | None,
) -> list[tuple[str, str]]:
    """For results: p/(E*(0) rms slope), half the share of relaxed rubber that touches
    or more; which rule fits.

    `rule` is the `equivalent_length` of the caller's model. Nothing for a line, whose
    pressure has a length of its own.
    """
    if isinstance(surface, RoughLine):
        return []
    level = np.asarray(pressure, dtype=np.float64) / (
        float(foundation.equilibrium) * surface.rms_slope
    )
    words = f"p/(E*(0) rms slope) = {brief(level, '').strip()}: "
    if level.max() <= _LIGHT:
        words += f"light contact (up to {_LIGHT}), for which the book's rule is made"
    elif rule is None:
        words += (
            f"beyond light contact ({_LIGHT}): mu comes out too low by this rule, "
            f'compare equivalent_length = "{FULL}"'
        )
    else:
        words += f"beyond light contact ({_LIGHT})"
    return [("load level", words)]


def factor(surface: AbstractSpectrum, model: Line) -> float:
    """F: three-dimensional friction is at most F times that of the line; NaN beyond
    where that is known.
    """
    ratio = float(surface.q_high / surface.q_low)
    if ratio > _WIDEST:
        return np.nan
    scale, power = _FULL_CONTACT if isinstance(model.equivalent_length, str) else _BOOK
    return scale * ratio**power * (_AVERAGED if model.average else 1.0)


def missed(surface: Surface, model: Line) -> str | None:
    """What the line misses on a surface under a pressure, for a warning; None where
    that is little.
    """
    if not isinstance(surface, AbstractSpectrum) or is_traced(surface):
        return None
    ratio = float(surface.q_high / surface.q_low)
    if ratio <= _SEEN:
        return None
    most = factor(surface, model)
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
