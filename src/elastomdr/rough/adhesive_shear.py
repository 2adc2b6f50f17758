"""Adhesive shear of dry contact: the stress with which rubber resists sliding where it
really touches.

Chains of the rubber bind to the counterface, are stretched, let go and bind again
(Schallamach 1963). Over the velocity that gives a bell in log v, which with time and
temperature shifts by a law of its own:

    tau(v, T) = stress exp(-width log10(v a_T/velocity)^2).

Friction by it is tau A/F_N, A the area of real contact: tau area_ratio/p on a surface.
Source: B. Lorenz, Y. R. Oh, S. K. Nam, S. H. Jeon and B. N. J. Persson, J. Chem. Phys.
142 (2015) 194701.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    as_float64,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    scalar,
    written,
)
from ..errors import InputError
from ..material.shift import AbstractShift
from ..trees import Tree, fill

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number

_DECADE = float(np.log(10.0))


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
                "shift must be a shift law such as em.Arrhenius(energy, "
                "reference), "
                f"got {shift!r}."
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
                raise InputError(
                    "temperature must be given: the adhesion has a shift law."
                )
            decades = decades + self.shift.log10_a(temperature)
        elif temperature is not None:
            decades = decades + xp.zeros_like(as_float64("temperature", temperature))
        return self.stress * xp.exp(-self.width * decades**2)

    def words(self) -> str:
        """The law in one line."""
        if is_traced(self):
            return "adhesive shear"
        text = (
            f"{float(self.stress) / 1e6:.4g} MPa at {float(self.velocity):.4g} m/s, "
            f"width {float(self.width):.4g}"
        )
        return f"{text}, {'athermal' if self.shift is None else repr(self.shift)}"

    def __repr__(self) -> str:
        return written(self)


def check_adhesion(adhesion: Any, temperature: Any) -> None:
    """Raises `InputError` unless a shear law can be used, or none is given."""
    if adhesion is None:
        return
    if not isinstance(adhesion, AdhesiveShear):
        raise InputError(
            "adhesion must be an em.AdhesiveShear(stress, velocity, width), got "
            f"{adhesion!r}."
        )
    if adhesion.shift is not None and temperature is None:
        raise InputError(
            "adhesion has a shift law and needs a temperature [K]; shift=None "
            "makes it athermal."
        )
