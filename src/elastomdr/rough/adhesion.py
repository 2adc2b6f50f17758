"""Adhesive shear of dry contact, the stress with which rubber resists sliding where it
really touches; and friction by it and by hysteresis, with what the area of contact may
be off.

Chains of the rubber bind to the counterface, are stretched, let go and bind again
(Schallamach 1963). Over the velocity that gives a bell in log v, which with time and
temperature shifts by a law of its own:

    tau(v, T) = stress exp(-width log10(v a_T/velocity)^2).

Friction by it is tau A/F_N, A the area of real contact: tau area_ratio/p on a surface.
Source: B. Lorenz, Y. R. Oh, S. K. Nam, S. H. Jeon and B. N. J. Persson, J. Chem. Phys.
142 (2015) 194701.
"""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import is_traced, xp
from ..call.extrapolation import sheared_too_hard, under_smooth
from ..checks import (
    Array,
    as_float64,
    certain,
    not_negative,
    numpy_unless_traced,
    positive,
    scalar,
    significant,
    written,
)
from ..element.layer import Layer
from ..errors import InputError
from ..material.shift import AbstractShift
from ..results.curve import FrictionCurve
from ..results.doubts import Doubt
from ..results.words import in_words
from ..surface.shapes import Cylinder
from ..trees import Tree, fill

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number
    from ..call.types import Indenter, Material

_DECADE = float(np.log(10.0))
MOST_SHEAR = 1.0  # tau A/F_N above which the sum is no prediction (docs/rough.md)
# relative bound of a real contact below which not its area decides how far the sum may be
# off, but what a shear law leaves out: contacts that shear changes, bonds that grow
# in sliding and at rest
KNOWN_AREA = 0.02
_SKEWED = 0.2  # of 1 - b/a: against 56 contacts in three dimensions (docs/accuracy.md)
# relative error of an area of 64 by 64 cells about the contact, its border corrected
_STAIRCASE = 0.01
_ADDED = "; adhesive shear on the {area}"


class AdhesiveShear(Tree):
    """Shear stress of real dry contact, stress exp(-width log10(v a_T/velocity)^2), for
    `em.friction(adhesion=...)`.

    Args:
        stress: largest shear stress [Pa].
        velocity: sliding velocity of the largest stress [m/s], at the reference
            temperature of `shift`.
        width: width of the bell, c in exp(-c log10(v/v_0)^2), 0 or more [1]; 0 for a
            stress that does not depend on velocity.
        shift: a_T of the adhesion, such as em.Arrhenius(energy, reference): not that of
            the moduli, as a rule. None for a stress that does not depend on
            temperature.

    For dry tread rubber 5 to 7 MPa, some mm/s, and about 0.1 were found. Source: Lorenz
    et al., J. Chem. Phys. 142 (2015) 194701.

    Raises:
        InputError: for a stress or velocity that is not positive, and a negative width.
    """

    stress: Float[Array, ""]  # [Pa]
    velocity: Float[Array, ""]  # v_0 [m/s]
    width: Float[Array, ""]  # c
    shift: AbstractShift | None

    def __init__(
        self,
        stress: Number,
        velocity: Number,
        width: Number,
        *,
        shift: AbstractShift | None = None,
    ):
        fill(
            self,
            stress=scalar("stress", stress),
            velocity=scalar("velocity", velocity),
            width=scalar("width", width),
        )
        positive("stress", self.stress)
        positive("velocity", self.velocity)
        not_negative("width", self.width)
        if shift is not None and not isinstance(shift, AbstractShift):
            raise InputError(
                argument="shift",
                got=shift,
                accepted="a shift law such as em.Arrhenius(energy, reference)",
            )
        fill(self, shift=shift)

    @numpy_unless_traced
    def shear_stress(
        self, velocity: ArrayLike, temperature: ArrayLike | None = None
    ) -> Float[Array, "..."]:
        """tau [Pa] at sliding velocities [m/s] and temperatures of the interface [K]
        that broadcast.

        Raises `InputError` where the law has a shift and no temperature is given.
        """
        velocity = as_float64("velocity", velocity)
        positive("velocity", velocity)
        decades = xp.log(velocity / self.velocity) / _DECADE
        if self.shift is not None:
            if temperature is None:
                raise _needs_temperature("the adhesion")
            decades = decades + self.shift.log10_a(temperature)
        elif temperature is not None:
            decades = decades + xp.zeros_like(as_float64("temperature", temperature))
        return self.stress * xp.exp(-self.width * decades**2)

    def words(self) -> str:
        """The law in one line."""
        if is_traced(self):
            return "adhesive shear"
        if self.shift is None and self.width == 0:
            return f"{float(self.stress) / 1e6:.4g} MPa at every velocity"
        numbers = (
            f"{float(self.stress) / 1e6:.4g} MPa at {float(self.velocity):.4g} m/s, "
            f"width {float(self.width):.4g}"
        )
        return f"{numbers}, {'athermal' if self.shift is None else repr(self.shift)}"

    def __repr__(self) -> str:
        return written(self)


def check_adhesion(
    adhesion: AdhesiveShear | None, temperature: ArrayLike | None
) -> None:
    """Raises `InputError` unless a shear law can be used, or none is given."""
    if adhesion is None:
        return
    if not isinstance(adhesion, AdhesiveShear):
        raise InputError(
            argument="adhesion",
            got=adhesion,
            accepted="an em.AdhesiveShear(stress, velocity, width)",
        )
    if adhesion.shift is not None and temperature is None:
        raise _needs_temperature("the adhesion")


def _needs_temperature(law: str) -> InputError:
    return InputError(
        argument="temperature",
        accepted=f"given [K], since {law} has a shift law",
        hint="shift=None makes it athermal",
    )


def shear_law(
    shear: float | AdhesiveShear, temperature: ArrayLike | None
) -> AdhesiveShear:
    """The law of a `boundary_shear`, which may be one stress [Pa]. Raises
    `InputError`.
    """
    if not isinstance(shear, AdhesiveShear):
        stress = as_float64("boundary_shear", shear)
        positive("boundary_shear", stress)
        shear = AdhesiveShear(stress, 1.0, 0.0)
    if shear.shift is not None and temperature is None:
        raise _needs_temperature("boundary_shear")
    return shear


def sheared(
    curve: FrictionCurve,
    adhesion: AdhesiveShear,
    share: Array,
    error: Array | float,
    bound: Array | float | None,
    area: str,
    modulus: Array,
) -> FrictionCurve:
    """`curve`, whose mu is that of hysteresis, with the shear of the real contact
    added.

    Args:
        share: area of contact over normal force [1/Pa], of the curve's shape.
        error: relative numerical error of the area.
        bound: relative bound on its distance from three dimensions, or None.
        area: what area it is, in words.
        modulus: of the rubber in its contacts, at their rate [Pa].
    """
    temperature = curve.temperature
    rise = curve.temperature_rise if curve.contact_rise is None else curve.contact_rise
    if temperature is not None and rise is not None:
        # of a point without an answer, whose area is NaN
        temperature = temperature + xp.where(xp.isnan(rise), 0.0, rise)
    stress = adhesion.shear_stress(curve.velocity, temperature)
    added = stress * share
    mu = curve.mu + added
    complete = None
    if curve.area_ratio is not None and bound is not None:
        complete = xp.asarray(bound < KNOWN_AREA)
        bound = xp.where(complete, xp.nan, bound)
    return dataclasses.replace(
        curve,
        mu=mu,
        hysteresis=curve.mu,
        adhesion=added,
        friction_force=mu * curve.normal_force,
        error=curve.error + added * error,
        model_error=_bounded(curve.model_error, added, bound),
        model=curve.model + _ADDED.format(area=area),
        inputs=(*curve.inputs, ("adhesion", adhesion.words())),
        marks=(
            *curve.marks,
            *sheared_too_hard(stress, modulus),
            *_no_prediction(curve, added),
            *_of_law(complete),
        ),
    )


def _exceeds(added: Array) -> bool:
    """Whether the shear is known to exceed the pressure at a point."""
    return certain(lambda added: (added > MOST_SHEAR).any(), added)


def _bounded(
    model_error: Array | None, added: Array, bound: Array | float | None
) -> Array | None:
    """The bound of hysteresis and that of the area, NaN where the shear exceeds the
    pressure; None where none is.
    """
    if bound is None:
        if not _exceeds(added):
            return model_error
        bound = 0.0
    total = (0.0 if model_error is None else model_error) + added * bound
    return xp.where(added > MOST_SHEAR, xp.nan, total)


def _no_prediction(curve: FrictionCurve, added: Array) -> tuple[Doubt, ...]:
    """Where the shear exceeds the pressure, and from which real contact on."""
    if not _exceeds(added):
        return ()
    over = np.asarray(added > MOST_SHEAR)
    says = "have no bound on the model: the shear of the contact exceeds its pressure"
    if curve.area_ratio is not None:
        least = (curve.area_ratio[over] / added[over]).min()
        says += (
            f", from a real contact of {significant(float(least), 2)} on, p over the "
            "shear stress"
        )
    most = significant(float(added[over].max()))
    says += (
        f"; it is up to {most} times that and would change the contact, which the sum "
        "leaves out"
    )
    return (Doubt("no prediction", over, says, "measured friction"),)


def _of_law(complete: Array | None) -> tuple[Doubt, ...]:
    """Where the area of a real contact is known so well that its bound says nothing of
    the sum.
    """
    if complete is None:
        return ()
    says = (
        "have no bound on the model: their real contact is all but complete, and what "
        "the shear law leaves out decides"
    )
    return (Doubt("no prediction", complete, says, "measured friction"),)


def on_contact(
    curve: FrictionCurve, adhesion: AdhesiveShear, shape: Indenter, material: Material
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
        bound = (
            xp.nan if isinstance(material, Layer) else _SKEWED * abs(1 - behind / ahead)
        )
    curve = dataclasses.replace(curve, contact_area=area)
    modulus = under_smooth(material, curve.velocity, curve.temperature, ahead)
    share = area / curve.normal_force
    return sheared(curve, adhesion, share, 0.0, bound, words, modulus)


def on_cells(
    curve: FrictionCurve, adhesion: AdhesiveShear, material: Material
) -> FrictionCurve:
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
        under_smooth(
            material, curve.velocity, curve.temperature, xp.sqrt(area / xp.pi)
        ),
    )


def no_area(adhesion: AdhesiveShear | None, subject: str, instead: str) -> None:
    """Refuses adhesion where no area of contact is known. Raises `InputError`."""
    if adhesion is not None:
        raise InputError(
            argument="adhesion",
            got=adhesion,
            accepted=f"left out for {subject}, which has no area of real contact",
            hint=instead,
        )


def why_hotter(
    curve: FrictionCurve, cold_area: np.ndarray, cold_stress: np.ndarray
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
    shear = f"the shear stress in it {significant(float(stronger))} times as high"
    if stronger > 1:
        shear += " (warmth moves it towards its maximum)"
    sentence = (
        f"at {int(higher.sum())} of {higher.size} points, most at "
        f"{in_words('velocity', float(curve.velocity[i]))}. Warmed rubber compared with "
        f"cold: the real contact is {significant(float(softer))} times as large (warm "
        f"rubber is softer), {shear}, hysteresis {significant(float(lossier))} times "
        "as high"
    )
    return (("heat raises mu", sentence),)
