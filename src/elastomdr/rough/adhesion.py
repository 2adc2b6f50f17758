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
from typing import TYPE_CHECKING, NamedTuple, get_args

import numpy as np

from .._types import Dry
from ..arrays import is_traced, xp
from ..call.extrapolation import sheared_too_hard, under_smooth
from ..checks import (
    Array,
    as_float64,
    certain,
    not_negative,
    numpy_unless_traced,
    one_of,
    positive,
    scalar,
    significant,
    written,
)
from ..element.layer import Layer
from ..errors import InputError
from ..material.shift import AbstractShift
from ..results.base import Assumed, Change
from ..results.curve import FrictionCurve
from ..results.doubts import Doubt, where
from ..results.words import in_words
from ..surface.shapes import Cylinder
from ..trees import Tree, fill, static

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
# of a real contact under shear, at most (Sahli et al., PNAS 115 (2018) 471)
LOST = 0.3
_SKEWED = 0.2  # of 1 - b/a: against 56 contacts in three dimensions (docs/accuracy.md)
# relative error of an area of 64 by 64 cells about the contact, its border corrected
_STAIRCASE = 0.01
_ADDED = "; adhesive shear on the {area}"


# stress [Pa], velocity [m/s] ("some mm/s") and width
_VALUES = {"rubber on a road": (6e6, 5e-3, 0.1)}
TYPICAL = {
    "rubber on a road": Assumed(
        "typical, not measured: 5 to 7 MPa; Lorenz et al., J. Chem. Phys. 142 (2015) "
        "194701",
        Change(stress=5 / 6),
        Change(stress=7 / 6),
    )
}


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

    Raises:
        InputError: for a stress or velocity that is not positive, and a negative width.
    """

    stress: Float[Array, ""]  # [Pa]
    velocity: Float[Array, ""]  # v_0 [m/s]
    width: Float[Array, ""]  # c
    shift: AbstractShift | None
    typical: str = static()  # the name of a preset

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
        fill(self, shift=shift, typical="")

    @classmethod
    def preset(
        cls, name: Dry = "rubber on a road", *, shift: AbstractShift | None = None
    ) -> AdhesiveShear:
        """A typical law in place of a measured one, with a band that
        `curve.uncertainty()` takes up and a source that `words()` tells.

        Args:
            name: "rubber on a road": 6 MPa, 5 to 7 MPa being published, 5 mm/s, 0.1.
            shift: as of the class; 90 kJ/mol is of the size found there.

        Raises:
            InputError: for other names.
        """
        one_of("name", name, *get_args(Dry))
        law = cls(*_VALUES[name], shift=shift)
        fill(law, typical=name)
        return law

    def band(self) -> Assumed | None:
        """That of a preset; None for other laws."""
        return TYPICAL.get(self.typical)

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
        words = f"{float(self.stress) / 1e6:.4g} MPa at "
        if self.shift is None and self.width == 0:
            return f"{words}every velocity"
        words += f"{float(self.velocity):.4g} m/s, width {float(self.width):.4g}"
        words += f", {'athermal' if self.shift is None else repr(self.shift)}"
        band = self.band()
        return words if band is None else f"{words}, {self.typical} ({band.says})"

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
    missed = 0.0 if curve.model_error is None else curve.model_error
    known = Known.of(
        added, error, bound, curve.area_ratio, (curve.mu, curve.error, missed)
    )
    mu = curve.mu + added
    return dataclasses.replace(
        curve,
        mu=mu,
        mu_low=known.low,
        mu_high=known.high,
        hysteresis=curve.mu,
        adhesion=added,
        friction_force=mu * curve.normal_force,
        error=known.error,
        model_error=known.bound,
        model=curve.model + _ADDED.format(area=area),
        inputs=(*curve.inputs, ("adhesion", adhesion.words())),
        marks=(*curve.marks, *sheared_too_hard(stress, modulus), *known.doubts),
    )


class Known(NamedTuple):
    """What is known of a coefficient with adhesive shear (docs/theory.md, section
    24).
    """

    error: Array  # numerical
    low: Array  # limits, errors and all
    high: Array
    bound: Array  # on what the model misses; NaN where nobody knows
    doubts: tuple[Doubt, ...]

    @classmethod
    def of(
        cls,
        added: Array,
        error: Array | float,
        bound: Array | float | None,
        area_ratio: Array | None,
        hysteresis: tuple[Array | float, Array | float, Array | float] = (
            0.0,
            0.0,
            0.0,
        ),
    ) -> Known:
        """Of the coefficient of shear `added`, `error` and `bound` of its area, both
        relative, and mu, error and bound of `hysteresis`.

        Shear takes contact away, as its square and no more than was seen; and where the
        rubber climbs, shear presses it down, as if by 1/(1 - s tau A/F_N) times the
        load, s the mean slope of the contact, at most mu of hysteresis; until all is in
        contact.
        """
        climbed, of_climbed, missed = hysteresis
        mu, numerical = climbed + added, of_climbed + added * error
        off = error + (0.0 if bound is None else bound)
        kept = 1 - LOST * xp.minimum(added, MOST_SHEAR) ** 2
        low = climbed - of_climbed - missed + added * xp.maximum(1 - off, 0.0) * kept
        low = xp.maximum(low, 0.0)
        room = xp.maximum(
            1 - climbed * added, 0.0 if area_ratio is None else area_ratio
        )
        high = mu + of_climbed + missed + added * off
        high = high / xp.where(room > 0, room, xp.nan)
        apart = xp.maximum(xp.maximum(high - mu, mu - low) - numerical, 0.0)
        doubts = _unforetold(added, None if area_ratio is None else bound)
        apart = xp.where(where(doubts, "no prediction"), xp.nan, apart)
        return cls(numerical, low, high, apart, doubts)


def _unforetold(added: Array, bound: Array | float | None) -> tuple[Doubt, ...]:
    """Where the shear exceeds the pressure; and where the area of a real contact is
    known so well that its `bound` says nothing of the sum.
    """
    over = xp.asarray(added > MOST_SHEAR)
    says = "the shear of the contact exceeds its pressure"
    if certain(lambda x: (x > MOST_SHEAR).any(), added):
        most = significant(float(added[over].max()))
        says += f"; it is up to {most} times that and would change the contact"
    exceeds = _no_prediction(over, says)
    if bound is None:
        return (exceeds,)
    full = xp.broadcast_to(xp.asarray(bound < KNOWN_AREA), over.shape)
    says = "real contact is all but complete, and what the shear law leaves out decides"
    return exceeds, _no_prediction(full, says)


def _no_prediction(points: Array, why: str) -> Doubt:
    says = f"have no bound on the model, but limits, `mu_low` and `mu_high`: {why}"
    return Doubt("no prediction", points, says, "measured friction")


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
    cold, adhesion, hysteresis, area, pressure, stress = (
        np.broadcast_to(np.asarray(x, dtype=float), curve.mu.shape)
        for x in (
            curve.cold,
            curve.adhesion,
            curve.hysteresis,
            curve.area_ratio,
            curve.pressure,
            cold_stress,
        )
    )
    higher = curve.mu > cold + curve.error
    if not higher.any():
        return ()
    i = np.unravel_index(np.argmax(np.where(higher, curve.mu / cold, 0.0)), cold.shape)
    before = stress[i] * cold_area[i] / pressure[i]
    softer = area[i] / cold_area[i]
    stronger = adhesion[i] / before / softer
    lossier = hysteresis[i] / (cold[i] - before)
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
