"""What the roughness of the counterface adds to a film: pressure, flow, friction.

The pressure is shared, p = p_fluid + p_a(u): p_a is the pressure at which `em.leak` has
the mean gap u (`leak_form.py`). Rubber that the roughness excites while it slides is stiffer than
at rest: by the ratio of the areas that `em.Multiscale` has in real contact at rest and
at the velocity, both under a small pressure.

The flow factor phi = w/u^3 is that of the leak's form, whose pressure and real contact
A are those at the gap u,

    phi = [1 - 0.9 exp(-0.56 u/R_q)] [(1 - c) (1 - A/a)^(k D^-e (A/a)^m) + c]

with its letters (`leak_form.py`). Where all channels are closed phi would be zero, and
the film's equation would have no solution: c = 1e-4 is left. The first bracket alone is
the factor of Patir and Cheng (J. Lubr. Technol. 100 (1978) 12) for isotropic surfaces,
which hardly falls with contact. The shear flow factor is left out.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator, PPoly

from ..checks import Array
from ..element.law import as_foundation
from ..element.layer import Layer
from ..errors import quiet
from ..material.prony import Prony
from ..material.shift import thermal_factors
from ..rough.psd_integrals import nodes
from ..surface.spectrum import AbstractSpectrum
from .channels import RoughSeal
from .leak_form import UNSURE, barely_touching, gap_of, through
from .persson_gap import contact_of, mean_gap

if TYPE_CHECKING:
    from ..call.types import Material

FlowFactor = Literal["maps", "patir-cheng"]

# pressures of the curve over E* times the rms slope
_LEVELS = np.geomspace(1e-7, 10.0, 41)
_CLOSED = 1e-3  # mean gap over the rms height below which the curve is extended
_SMALL = 1e-3  # pressure over E* times rms slope at which areas are compared
_RTOL = 1e-4  # of the friction at these pressures
_PRESSURES = np.geomspace(1e-5, 3.0, 11)  # of the friction, over the largest pressure
_CHANNELS = 1e-4  # c, what is left of channels where all of them are closed
_GAPS = 257  # gaps between which the flow through channels is interpolated
_SLOW = 1e-6  # q v tau at which the roughness moves so slowly that rubber is relaxed


class Roughness(NamedTuple):
    """The pressed surface."""

    rms: float  # R_q [m]
    curve: PchipInterpolator  # gap [m] to ln(p_a/E*(0)), for the relaxed rubber
    steepness: PPoly  # its derivative
    last: tuple[float, float]  # gaps between which the curve is known
    modulus: float  # E*(0) [Pa]
    closes: float  # gap [m] below which channels may be closed
    # gap [m] to the log of phi's second bracket, and its derivative
    channels: PchipInterpolator | None
    opening: PPoly | None

    def pressure(self, gap: Array, modulus: float) -> tuple[Array, Array]:
        """p_a [Pa] and its slope by the gap; exponential beyond the curve."""
        inside = np.clip(gap, *self.last)
        slope = self.steepness(inside)
        pressure = modulus * np.exp(
            np.minimum(self.curve(inside) + slope * (gap - inside), 300.0)
        )
        return pressure, pressure * slope

    def flow_factor(self, gap: Array) -> tuple[Array, Array]:
        """phi and its slope by the gap; the second bracket is even beyond the curve."""
        over = gap / self.rms
        factor = barely_touching(over)
        slope = 0.56 * (1 - factor) / self.rms
        if self.channels is None or self.opening is None:
            return factor, slope
        inside = np.clip(gap, *self.last)
        channels = np.exp(self.channels(inside))
        steep = np.where(gap == inside, self.opening(inside), 0.0)
        return factor * channels, channels * (slope + factor * steep)


class Rubbing(NamedTuple):
    """Friction of the asperities at a velocity, by their pressure."""

    least: float  # pressure [Pa] below which mu is even and the area linear
    mu: PchipInterpolator  # ln(pressure) to that of hysteresis
    share: PchipInterpolator  # to the logarithm of real contact area over nominal
    stiffening: float  # modulus over that at rest

    def friction_and_contact(self, pressure: Array) -> tuple[Array, Array]:
        """mu and real contact at pressures [Pa]."""
        place = np.log(np.maximum(pressure, self.least))
        faint = np.minimum(pressure / self.least, 1.0)
        return self.mu(place), faint * np.exp(self.share(place))


class Touching(NamedTuple):
    """What asperities do at one point; pressures over `unit`, gaps as those given."""

    rubbing: Rubbing
    unit: float  # [Pa]
    stress: float  # shear of the real contact
    closes: float  # gap below which channels may be closed
    at_closing: float  # pressure of the asperities at that gap

    def share(self, pressure: Array) -> Array:
        """Real contact under pressures that asperities carry."""
        return self.rubbing.friction_and_contact(pressure * self.unit)[1]

    def friction(self, width: Array, pressure: Array) -> Array:
        """Hysteresis and shear of the real contact, both summed over the `width` of
        each place.
        """
        mu, share = self.rubbing.friction_and_contact(pressure * self.unit)
        return np.array([width @ (mu * pressure), self.stress * (width @ share)])

    def trapped(
        self, width: Array, film: Array, fluid: Array, pressure: Array
    ) -> Array:
        """The load that liquid carries where channels may be closed, and how far the
        sum of `friction` may be off: if it leaves, asperities carry all of the pressure
        there; if none could leave since channels closed, no more than at closing.
        """
        closed = film < self.closes
        left = np.where(closed, fluid + pressure, pressure)
        stayed = np.where(closed, np.minimum(pressure, self.at_closing), pressure)
        here, *ends = (
            float(self.friction(width, each).sum()) for each in (pressure, left, stayed)
        )
        return np.array(
            [width @ np.where(closed, fluid, 0.0), max(abs(x - here) for x in ends)]
        )


def half_space_of(material: Material) -> Any:
    """What waves that are short against a layer meet: its material."""
    return material.material if isinstance(material, Layer) else material


def pressed(
    material: Material, surface: AbstractSpectrum, flow_factor: FlowFactor
) -> Roughness:
    """The gaps of `em.leak` under pressures on relaxed rubber, and the flow through
    them.
    """
    foundation = as_foundation(half_space_of(material))
    modulus, softening = float(foundation.equilibrium), foundation.softening
    softened, cells = RoughSeal(surface, softening).softened(), nodes(surface)
    rms, level = float(surface.rms_height), _LEVELS * float(surface.rms_slope)
    gap = rms * gap_of(mean_gap(contact_of(cells, level, softened)) / rms)
    open_ = gap > _CLOSED * rms
    gap, log_pressure = gap[open_][::-1], np.log(level[open_][::-1])
    curve, last = PchipInterpolator(gap, log_pressure), (gap[0], gap[-1])
    gap = np.geomspace(*last, _GAPS)
    contacts = contact_of(cells, np.exp(curve(gap)), softened)
    closes = float(np.interp(-UNSURE, -contacts.area, gap))  # area falls with the gap
    channels = opening = None
    if flow_factor == "maps":
        open_part = through(contacts.area, contacts.steep)
        left = np.log(open_part + _CHANNELS * (1 - open_part))
        channels = PchipInterpolator(gap, left)
        opening = channels.derivative()
    steepness = curve.derivative()
    return Roughness(rms, curve, steepness, last, modulus, closes, channels, opening)


def rubbing(
    material: Material,
    surface: AbstractSpectrum,
    velocity: Array,
    largest: float,
    temperature: float | None,
) -> tuple[list[Rubbing], Array]:
    """Friction by `em.Multiscale` at each velocity [m/s], up to about the `largest`
    pressure [Pa]; and at which the material is extrapolated.
    """
    from ..verbs.friction import friction

    body = half_space_of(material)
    pressures = _PRESSURES * largest
    rubs = partial(friction, body, surface, temperature=temperature, rtol=_RTOL)
    with quiet():
        sliding: Any = rubs(velocity=velocity[:, None], pressure=pressures)
        small, slow = _compared(body, surface, temperature)
        areas: Any = rubs(velocity=np.append(slow, velocity), pressure=small).area_ratio
    stiffening = areas[0] / areas[1:]
    place = np.log(pressures)
    out = [
        Rubbing(
            float(pressures[0]),
            PchipInterpolator(place, mu),
            PchipInterpolator(place, np.log(np.maximum(share, 1e-99))),
            float(stiff),
        )
        for mu, share, stiff in zip(
            sliding.mu, sliding.area_ratio, stiffening, strict=True
        )
    ]
    beyond: Any = sliding.extrapolated
    if beyond is None:
        return out, np.zeros(len(out), bool)
    return out, np.asarray(np.any(beyond, axis=1))


def _compared(
    body: Prony, surface: AbstractSpectrum, temperature: float | None
) -> tuple[float, float]:
    """A small pressure [Pa], and a velocity so slow that all is relaxed [m/s]."""
    foundation = as_foundation(body)
    factor = float(thermal_factors(foundation, temperature)[0])
    slowest = float(np.max(foundation.times, initial=1e-9))
    modulus = float(foundation.equilibrium)
    return _SMALL * modulus * float(surface.rms_slope), _SLOW / (
        float(surface.q_high) * slowest * factor
    )
