"""Adhesive shear added to a curve of hysteresis: friction by both, with what the area
of contact may be off.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

from ..arrays import xp
from ..errors import InputError
from ..results.curve import FrictionCurve
from ..surface.shapes import Cylinder

if TYPE_CHECKING:
    from .adhesive_shear import AdhesiveShear

_SKEWED = 0.2  # of 1 - b/a: against 56 contacts in three dimensions (docs/accuracy.md)
# relative error of an area of 64 by 64 cells about the contact, its border corrected
_STAIRCASE = 0.01
_ADDED = "; adhesive shear on the {area}"


def sheared(
    curve: FrictionCurve,
    adhesion: AdhesiveShear,
    share: Any,
    error: Any,
    bound: Any,
    area: str,
    **more: Any,
) -> FrictionCurve:
    """`curve`, whose mu is that of hysteresis, with the shear of the real contact
    added.

    Args:
        share: area of contact over normal force [1/Pa], of the curve's shape.
        error: relative numerical error of the area.
        bound: relative bound on its distance from three dimensions, or None.
        area: what area it is, in words.
        more: fields of the result that go with it.
    """
    kelvin = curve.temperature
    rise = curve.temperature_rise if curve.contact_rise is None else curve.contact_rise
    if kelvin is not None and rise is not None:
        # of a point without an answer, whose area is NaN
        kelvin = kelvin + xp.where(xp.isnan(rise), 0.0, rise)
    added = adhesion.shear_stress(curve.velocity, kelvin) * share
    mu = curve.mu + added
    model_error = curve.model_error
    if bound is not None:
        model_error = (0.0 if model_error is None else model_error) + added * bound
    return dataclasses.replace(
        curve,
        mu=mu,
        hysteresis=curve.mu,
        adhesion=added,
        friction_force=mu * curve.normal_force,
        error=curve.error + added * error,
        model_error=model_error,
        model=curve.model + _ADDED.format(area=area),
        inputs=(*curve.inputs, ("adhesion", adhesion.words())),
        **more,
    )


def on_contact(
    curve: FrictionCurve, adhesion: AdhesiveShear, shape: Any, layer: bool
) -> FrictionCurve:
    """`sheared` under a smooth body, on an area from its leading edge a and its
    trailing edge b on the central line.

    A cylinder touches over (a + b) times its length, exactly. Under a body of
    revolution the contact is half a disc ahead and half an ellipse behind, (pi/2) a (a
    + b): exact where nothing is lost, and close to what cells find.
    """
    assert curve.contact is not None
    ahead, behind = curve.contact.leading, curve.contact.trailing
    if isinstance(shape, Cylinder):
        area, bound, words = (
            (ahead + behind) * shape.length,
            0.0,
            "area between its edges",
        )
    else:
        area, words = (
            0.5 * xp.pi * ahead * (ahead + behind),
            "area (pi/2) a (a + b) from its edges",
        )
        bound = xp.nan if layer else _SKEWED * abs(1 - behind / ahead)
    return sheared(
        curve, adhesion, area / curve.normal_force, 0.0, bound, words, contact_area=area
    )


def on_cells(curve: FrictionCurve, adhesion: AdhesiveShear) -> FrictionCurve:
    """`sheared` under a smooth body on the cells that touch, in three dimensions."""
    area = curve.contact_area
    assert area is not None
    return sheared(
        curve,
        adhesion,
        area / curve.normal_force,
        _STAIRCASE,
        None,
        "area of the cells that touch",
    )


def no_area(adhesion: Any, what: str, instead: str) -> None:
    """Refuses adhesion where no area of contact is known. Raises `InputError`."""
    if adhesion is not None:
        raise InputError(
            f"adhesion acts on the area of real contact, which {what} does not "
            f"have: {instead}."
        )
