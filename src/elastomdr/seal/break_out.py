"""Break-out after a dwell: the shear of a real contact that has grown at rest.

    mu = tau A(t)/p,        A(t) the real contact of an elastic body with E* = 1/J(t/a_T)

Under a constant pressure the contact grows, so that after the dwell t it is that of an
elastic body with the creep of that time, by any model of a surface under a pressure.
tau is the largest shear stress that the interface passes on the way from rest to the
velocity of the start. That all of the contact bears it at once, before any of it is
lost, is a bound from above: a contact that lets go piece by piece needs less, though no
less than steady sliding.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Literal, NamedTuple

import numpy as np

from ..arrays import numpy_unless_traced, stop_gradient, xp
from ..call.extrapolation import sheared_too_hard
from ..call.several_materials import over_materials
from ..checks import (
    broadcast,
    broadcast_shape,
    is_traced,
    nan_unless,
    positive_arrays,
    warn_unless,
)
from ..element.law import Foundation
from ..errors import InputError
from ..models import Model, as_model, named
from ..results.base import Array, Result, quantity, record
from ..results.words import given_in_words, span
from ..rough.adhesion import AdhesiveShear, Known, shear_law
from ..rough.local_modulus import Local, SoftenedByScale
from ..rough.problem import Resting, resting_body
from ..rough.road_model import RoadProblem
from ..rough.road_models import Multiscale, Persson
from ..rough.surface import bound_of_heights, by_strain, off_by_strain
from ..surface.spectrum import AbstractSpectrum, as_spectrum
from .leak import bodies_in_words

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import ArrayLike, Style
    from ..call.types import Material

_KINDS: dict[str, type[Model]] = {k.label: k for k in (Multiscale, Persson)}
_RTOL, _MOST = 1e-6, 1e-3  # of the area that is aimed at, and at most
_UNITS = {"pressure": "Pa", "time": "s", "velocity": "m/s", "temperature": "K"}


@record
class BreakOut(Result):
    """Break-out of a rough contact after a dwell, by the shear of its real contact.

    `error` is numerical. `model_error` bounds what the real contact may be off, and what
    shear takes away of it; NaN where the shear exceeds the pressure, and in nearly full
    contact, which is known better than the stress: bonds that grow stronger at rest are
    not in it. There `mu_low` and `mu_high` are left.
    """

    pressure: Array = quantity("contact pressure", "Pa", "p", shown="MPa")
    time: Array | None = quantity("dwell", "s", "t, None: long after", default=None)
    velocity: Array | None = quantity(
        "velocity of the start", "m/s", "None: past the largest stress", default=None
    )
    temperature: Array | None = quantity(
        "temperature", "K", "None where none was given", default=None, shown="°C"
    )
    mu: Array = quantity(
        "break-out coefficient", "-", "tau A/p, largest shear force over normal force"
    )
    mu_low: Array = quantity(
        "lower limit of the break-out coefficient",
        "-",
        "with errors; shear takes away up to 0.3 of the contact",
    )
    mu_high: Array = quantity(
        "upper limit of the break-out coefficient",
        "-",
        "with errors, without growth of the contact under shear",
    )
    area_ratio: Array = quantity("real contact area over nominal area", "-", "A")
    shear_stress: Array = quantity(
        "shear stress of the real contact", "Pa", "tau, largest up to the velocity"
    )
    error: Array = quantity("error of the break-out coefficient", "-", "numerical")
    model_error: Array = quantity(
        "bound of the model's error of the break-out coefficient", "-"
    )

    title: ClassVar[str] = "Break-out after a dwell"
    across: ClassVar[str] = "time"
    scale: ClassVar[str] = "log"
    shows: ClassVar[str] = "mu"
    error_of: ClassVar[str] = "the break-out coefficient"
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "pressure",
        "temperature",
        "velocity",
    )

    def plot(
        self,
        ax: Axes | None = None,
        style: Style | None = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: Literal["mu", "area_ratio"] = "mu",
    ) -> Axes:
        """Draws the break-out coefficient or the real contact against the dwell, with
        the band of its error, numerical and of the model.

        The rest as of every result, `Result.plot`. Raises `InputError`.
        """
        self._check_shown(show, "mu", "area_ratio")
        from ..results.plot_curves import draw_break_out
        from ..results.plotting import DrawAsk

        return self._draw(
            partial(draw_break_out, y=show), DrawAsk(ax, style, title, label)
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The ranges of the coefficient and of the real contact."""
        good: Any = np.asarray(self.converged)
        yield "break-out coefficient", span(self.mu[good])
        yield "real contact", span(self.area_ratio[good])
        yield "bound", "all of the contact lets go at once; hysteresis is not counted"


@over_materials
@numpy_unless_traced
def break_out(
    material: Material | Sequence[Material],
    surface: AbstractSpectrum,
    *,
    pressure: ArrayLike,
    boundary_shear: float | AdhesiveShear,
    time: ArrayLike | None = None,
    velocity: ArrayLike | None = None,
    temperature: ArrayLike | None = None,
    model: Multiscale | Persson | str | None = None,
) -> BreakOut:
    """Break-out of a rough contact after a dwell: the shear of its real contact, which
    grows while it rests.

    Args:
        material: as for `em.press`.
        surface: roughness by its spectrum; where the rubber is rough too, that of the sum
            of both spectra.
        pressure: nominal pressure that contact bears [Pa], less what a fluid between
            rubber and surface carries; arguments broadcast.
        boundary_shear: shear stress of the real contact [Pa], or an `em.AdhesiveShear`.
        time: dwell, for which the pressure has acted since it was put on at once [s];
            None for long after.
        velocity: velocity that the start reaches [m/s]: of an `em.AdhesiveShear` the
            largest stress up to it counts. None for a start beyond its maximum.
        temperature: temperature [K], for a material or a shear with a shift law.
        model: `em.Multiscale()` by default, or `em.Persson()`.

    Returns:
        An `em.BreakOut` of the broadcast shape.

    Raises:
        InputError: for arguments out of range, and models without a real contact.

    A model: the real contact, by `model`, and a stress that does not depend on pressure
    and dwell. A softening of the material is followed as by `em.friction`, at half of the
    rms slope of each length scale. A bound from above: all of the contact bears the
    largest stress at once. Not counted: hysteresis; the interlocking that `em.slide`
    finds on a line estimates it from above. Differentiable. Source: `docs/seal.md`.
    """
    solid: Any = material  # `over_materials` has taken a list apart
    foundation = resting_body(solid, time)
    as_spectrum("surface", surface)
    chosen: Any = as_model(model, _KINDS) or Multiscale()
    if chosen.label not in _KINDS:
        raise InputError(
            argument="model",
            got=chosen,
            accepted=named(Multiscale(), Persson()) + " for a break-out",
        )
    shear = shear_law(boundary_shear, temperature)
    arrays = positive_arrays(
        {
            "pressure": pressure,
            "time": time,
            "velocity": velocity,
            "temperature": temperature,
        }
    )
    given = _Start(**arrays)
    shape = broadcast_shape(arrays)
    rest = Resting.of(foundation, surface, given.time, given.temperature)
    contact = _contact(chosen, rest, given.pressure * rest.soft)
    stress = _largest_stress(shear, given)
    mu = stress * contact.area / given.pressure
    good = xp.broadcast_to(contact.good, shape)
    warn_unless(good, "points")
    known = Known.of(mu, contact.error, contact.bound, contact.area)
    numbers = {
        "mu": mu,
        "mu_low": known.low,
        "mu_high": known.high,
        "area_ratio": contact.area,
        "shear_stress": stress,
        "error": known.error,
        "model_error": known.bound,
    }
    fields = {
        name: nan_unless(good, xp.broadcast_to(value, shape))
        for name, value in numbers.items()
    }
    return BreakOut(
        **broadcast({**given._asdict(), **fields, "converged": good}),
        marks=(
            *rest.doubts(given.pressure, shape, chosen.softens),
            *sheared_too_hard(xp.broadcast_to(stress, shape), 1 / rest.soft),
            *known.doubts,
        ),
        model=f"{chosen.words()}; its shear at once",
        plan="real contact of an elastic body with the creep of the dwell",
        inputs=(
            *bodies_in_words(foundation, surface),
            ("shear of the contact", shear.words()),
            *(
                ("dwell" if name == "time" else name, said)
                for name, said in given_in_words(given, _UNITS)
            ),
        ),
    )


class _Start(NamedTuple):
    """What is given to `em.break_out`, under its names, as arrays."""

    pressure: Array
    time: Array | None = None
    velocity: Array | None = None
    temperature: Array | None = None


class _RealContact(NamedTuple):
    """The real contact at each point, over the nominal area."""

    area: Any
    error: Any  # relative, numerical
    bound: Any  # relative, of the model
    good: Any


def _contact(
    model: Multiscale | Persson, rest: Resting, relative_pressure: Array
) -> _RealContact:
    """The contact of an elastic body at pressures over its E* of small strain."""
    surface, softened, softening = (
        rest.surface,
        rest.softened(),
        rest.foundation.softening,
    )
    assert isinstance(surface, AbstractSpectrum)  # `as_spectrum` has looked
    one, flat = Foundation(1.0, [], [], softening=softening), relative_pressure.ravel()
    slow = xp.ones_like(flat)
    problem = RoadProblem(one, surface, slow, flat, Local(softened), _RTOL)
    solved = model.solve(problem)
    bound = model.bound(one, surface, slow, solved.area, of_area=True)
    assert bound is not None  # `_KINDS` are no truths themselves
    bound = bound + bound_of_heights(
        model, *stop_gradient((surface, solved.area)), True
    )
    if softened is not None:
        bound = bound + _of_strain(model, problem, softened)
    error = solved.area_error / xp.where(solved.area > 0, solved.area, 1.0)
    # its friction is zero: what has to settle is the area
    good = solved.good & (stop_gradient(error) <= _MOST)
    numbers = solved.area, error, bound, good
    return _RealContact(*(xp.reshape(x, relative_pressure.shape) for x in numbers))


def _of_strain(
    model: Multiscale | Persson, problem: RoadProblem, softened: SoftenedByScale
) -> Any:
    """How far the real contact is off where the strain of each scale is."""
    if is_traced(problem):
        return off_by_strain(model, problem)[1]
    return by_strain(model, problem, softened).of_area


def _largest_stress(shear: AdhesiveShear, given: _Start) -> Any:
    """The largest stress up to the velocity [Pa]: beyond its maximum, that."""
    if given.velocity is None:
        return shear.stress
    peak, temperature = shear.velocity, None
    if shear.shift is not None and given.temperature is not None:
        temperature = given.temperature
        peak = peak / shear.shift.a(temperature)
    return shear.shear_stress(xp.minimum(given.velocity, peak), temperature)
