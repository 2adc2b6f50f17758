"""Adhesive shear added to a curve of hysteresis: friction by both, with what the area
of contact may be off.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import is_traced, xp
from ..checks import significant
from ..errors import InputError
from ..results.curve import FrictionCurve
from ..results.words import in_words
from ..surface.shapes import Cylinder

if TYPE_CHECKING:
    from .adhesive_shear import AdhesiveShear

MOST_SHEAR = 1.0  # tau A/F_N above which the sum is no prediction (docs/rough.md)
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
    return dataclasses.replace(
        curve,
        mu=mu,
        hysteresis=curve.mu,
        adhesion=added,
        friction_force=mu * curve.normal_force,
        error=curve.error + added * error,
        model_error=_bounded(curve.model_error, added, bound),
        model=curve.model + _ADDED.format(area=area),
        inputs=(
            *curve.inputs,
            ("adhesion", adhesion.words()),
            *_no_prediction(curve, added),
        ),
        **more,
    )


def _bounded(model_error: Any, added: Any, bound: Any) -> Any:
    """The bound of hysteresis and that of the area, NaN where the shear exceeds the
    pressure; None where none is.
    """
    if bound is None:
        if is_traced(added) or not (added > MOST_SHEAR).any():
            return model_error
        bound = 0.0
    total = (0.0 if model_error is None else model_error) + added * bound
    return xp.where(added > MOST_SHEAR, xp.nan, total)


def _no_prediction(curve: FrictionCurve, added: Any) -> tuple[tuple[str, str], ...]:
    """In words, where the shear exceeds the pressure, and from which real contact
    on.
    """
    if is_traced(added):
        return ()
    over = np.asarray(added > MOST_SHEAR)
    if not over.any():
        return ()
    text = (
        f"{int(over.sum())} of {over.size} points: the shear of the contact exceeds "
        "its pressure"
    )
    if curve.area_ratio is not None:
        least = (curve.area_ratio[over] / added[over]).min()
        text += (
            f", from a real contact of {significant(float(least), 2)} on, p over the "
            "shear stress"
        )
    most = significant(float(added[over].max()))
    text += (
        f"; it is up to {most} times that and would change the contact, which the sum "
        "leaves out"
    )
    return (("no prediction", f"{text}; model_error is NaN there"),)


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


def why_hotter(
    curve: FrictionCurve, cold_area: Any, cold_stress: Any
) -> tuple[tuple[str, str], ...]:
    """In words, why friction is higher on hot than on cold rubber, where it is.

    Args:
        curve: of both parts, at the temperatures that they make.
        cold_area: real contact over nominal area without heating, of the curve's shape.
        cold_stress: shear stress at the temperature of the body [Pa], likewise.
    """
    assert curve.cold is not None
    assert curve.adhesion is not None
    assert curve.hysteresis is not None
    assert curve.pressure is not None
    assert curve.area_ratio is not None
    higher = curve.mu > curve.cold + curve.error
    if not higher.any():
        return ()
    i = np.unravel_index(
        np.argmax(np.where(higher, curve.mu / curve.cold, 0.0)), higher.shape
    )
    stress, area = np.broadcast_to(cold_stress, higher.shape)[i], cold_area[i]
    before = stress * area / curve.pressure[i]
    softer = curve.area_ratio[i] / area
    stronger = curve.adhesion[i] / before / softer
    lossier = curve.hysteresis[i] / (curve.cold[i] - before)
    shear = f"the shear stress there {significant(float(stronger))} times"
    if stronger > 1:
        shear += ", since warmth moves it towards its maximum"
    text = (
        f"{int(higher.sum())} of {higher.size} points, most at "
        f"{in_words('velocity', float(curve.velocity[i]))}: of what cold rubber has, "
        f"the real contact is {significant(float(softer))} times, since warm rubber "
        f"is softer, {shear}, hysteresis {significant(float(lossier))} times"
    )
    return (("hot above cold", text),)
