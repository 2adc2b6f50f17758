"""Which points of a steady scene use a material beyond the range of its data, and which
pressures and stresses are likely to be meant in another unit: doubts that every verb
hands over.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import stop_gradient, xp
from ..checks import Array, certain, is_traced
from ..checks import known as known_values
from ..element.law import as_foundation
from ..element.layer import Layer
from ..errors import ExtrapolationWarning, ModelWarning, warn
from ..material.shift import thermal_factors
from ..material.validity import Range
from ..results.doubts import Doubt
from ..surface.rough_line import RoughLine
from ..surface.spectrum import AbstractSpectrum
from ..trees import replaced

if TYPE_CHECKING:
    from jaxtyping import Float

    from .types import Material, SteadyBody

# share of a rough surface's mean square slope that may lie outside the range
_OUTSIDE = 0.1
_CELLS = 400  # of the slope, where each wave has a temperature of its own
_FAR = 5.0  # stress over the modulus from which on there is a warning
_NONE = 100.0  # modulus below which rubber is a liquid rather [Pa]
# what no contact of a profile has: a wider one [m], and a lower largest pressure [Pa]
_WIDEST, _LOWEST = 0.1, 1e3
_MEGAPASCALS = 10.0  # pressure up to which it may be one in MPa [Pa]
_LEAST = 1e-4  # share of real contact below which it probably is
_HIGHEST = 1e8  # pressure of a fluid or a seal from which on there is a warning [Pa]


def told(
    known: Range | None, points: Array, findings: str = "", quiet: bool = False
) -> tuple[Doubt, ...]:
    """The doubts of points that use a material beyond its range, and of a material whose
    moduli are illustrative; with a warning, unless `quiet` or the range is an assumption
    only.
    """
    if known is None:
        return ()
    extrapolated = Doubt("extrapolated", points)
    if findings:
        extrapolated = replaced(extrapolated, says=f"{extrapolated.says}: {findings}")
    if not (quiet or known.illustrative):
        warn_of(extrapolated)
    return extrapolated, *illustrative(known, np.shape(points))


def pressed_too_hard(pressure: Array, modulus: Array) -> tuple[Doubt, ...]:
    """Where a pressure exceeds the modulus of the rubber under it; with a warning where
    it does so by far, since it may be meant in another unit.
    """
    over = _over(
        "pressure is taken in Pa, and load in N: a pressure",
        pressure,
        modulus,
        "Rubber is not linear there",
    )
    says = (
        "have a pressure above the modulus of the rubber under it, where rubber is not "
        "linear, as it is taken here"
    )
    return (Doubt("estimate", over > 1, says, "a pressure as it occurs"),)


def sheared_too_hard(stress: Array, modulus: Array) -> tuple[Doubt, ...]:
    """Where the shear stress of a real contact is far above the modulus of the rubber
    under it; with a warning, since it may be meant in another unit.
    """
    over = _over(
        "The shear stress of the real contact is taken in Pa: one",
        stress,
        modulus,
        "Rubber bears some MPa, and no such multiple",
    )
    says = (
        "have a shear stress of the real contact far above the modulus of the rubber "
        "under it, which no contact was found to bear"
    )
    return (Doubt("estimate", over > _FAR, says, "a shear stress as it was found"),)


def modulus_at(
    body: SteadyBody,
    wave_number: Array | float,
    reduced: Array,
    vertical: Array | float,
) -> Array:
    """|E*| [Pa] that contacts of a wave number [1/m] meet at velocities v a_T [m/s]."""
    return abs(body.complex_modulus(wave_number * reduced)) * vertical


def under_smooth(
    material: Material, velocity: Array, temperature: Array | None, size: Array
) -> Array:
    """|E*| [Pa] under a smooth body by the half-length of its contact [m]; NaN on
    springs, which have none.
    """
    body = as_foundation(material.material if isinstance(material, Layer) else material)
    if body.per_area:
        return np.full(np.shape(velocity), np.nan)
    factor, vertical = thermal_factors(body, temperature)
    return modulus_at(body, 1 / size, velocity * factor, vertical)


def pressed_as_none_is(pressure: Array) -> tuple[Doubt, ...]:
    """Where a pressure that no modulus limits is more than any seal holds; with a
    warning, since it may be meant in another unit.
    """
    pressure = known_values(stop_gradient(pressure))
    points = pressure > _HIGHEST
    if certain(np.any, points):
        warn(
            f"pressure is taken in Pa: {np.nanmax(pressure):g} Pa is more than seals "
            "hold.",
            ModelWarning,
        )
    says = f"have a pressure above {_HIGHEST:g} Pa, more than seals hold"
    return (Doubt("estimate", points, says, "a pressure as it occurs"),)


def doubt_units(x: Array, pressure: Array) -> None:
    """Warns of positions of a profile that are likely to be meant in mm, and of
    pressures in MPa.
    """
    width, highest = float(x[-1] - x[0]), float(pressure.max())
    if width > _WIDEST:
        warn(
            f"profile: positions are taken in m, and the contact is {width:g} m wide. "
            f"If {width:g} mm are meant, write positions times 1e-3.",
            ModelWarning,
        )
    if highest < _LOWEST:
        warn(
            f"profile: pressures are taken in Pa, of {highest:g} Pa at most. If "
            f"{highest:g} MPa are meant, write pressures times 1e6.",
            ModelWarning,
        )


def hardly_pressed(pressure: Array, area: Array, good: Array) -> None:
    """Warns of a pressure that is likely to be meant in MPa: a small number, under
    which hardly anything touches.
    """
    area = np.where(good & (pressure <= _MEGAPASCALS), area, 1.0)
    least = int(np.argmin(area))
    if area[least] < _LEAST:
        given = f"{pressure[least]:g}"
        warn(
            f"pressure is taken in Pa: {given} Pa give a real contact of "
            f"{area[least]:.1g} of the nominal area. If {given} MPa are meant, write "
            f"{1e6 * pressure[least]:g}.",
            ModelWarning,
        )


def _over(given: str, stress: Array, modulus: Array, why: str) -> Array:
    """A stress over the modulus of the rubber under it; with a warning where it is far
    above that.
    """
    stress, modulus = known_values(stop_gradient((stress, modulus)))
    with np.errstate(all="ignore"):
        over = stress / modulus
    if certain(lambda over: np.any(over > _FAR), over):
        most = int(np.nanargmax(over))
        high, low = (
            np.broadcast_to(x, np.shape(over)).flat[most] for x in (stress, modulus)
        )
        times = (
            f"{high / low:.3g} times the modulus of the rubber under it, {low:.2g} Pa"
        )
        if low < _NONE:
            times = f"on rubber that all but flows there: its modulus is {low:.2g} Pa"
        warn(f"{given} of {high:g} Pa is {times}. {why}.", ModelWarning)
    return over


def beyond_sweep(
    points: Array, known: Range | None, strains: str = ""
) -> tuple[Doubt, ...]:
    """The doubt of points that strain the material more than its sweep of strains did,
    by which `strains` in words; none of a material of which nothing is known and
    nothing found.
    """
    says = "lie beyond the strain sweep of the material, whose last factors are held"
    says += strains and f": {strains}"
    doubt = Doubt("extrapolated", points, says, "a sweep to larger strains")
    return () if known is None and not doubt.found() else (doubt,)


def warn_of(extrapolated: Doubt) -> None:
    """Counts its points in a warning, where there are any that are known."""
    points = extrapolated.points
    if certain(np.any, points):
        count = f"{int(np.sum(points))} of {np.size(points)} points"
        warn(f"{count} {extrapolated.says}.", ExtrapolationWarning)


def illustrative(known: Range | None, shape: tuple[int, ...]) -> tuple[Doubt, ...]:
    """The doubt of all points of a material whose moduli are of no particular rubber."""
    if known is None or not known.illustrative_moduli:
        return ()
    return (Doubt("illustrative", np.ones(shape, bool)),)


def _looked_at(*values: Any) -> tuple[Any, bool, bool]:
    """The values without derivatives, which a mask does not have; whether JAX still
    traces them, so that they cannot be told in words; and whether it did before.
    """
    if not is_traced(values):
        return values, False, False
    plain = known_values(stop_gradient(values))
    return plain, is_traced(plain), True


def steady_beyond(
    known: Range | None, reduced: Any, size: Array | float, temperature: Any
) -> tuple[Doubt, ...]:
    """Passages at the velocities `reduced` = v a_T [m/s] of contacts of half the length
    `size` [m].

    A parabola's passage dissipates most at the frequency 2 v a_T/a, and nine tenths
    between a quarter and twice of it. A quarter is the reciprocal of the time that it
    lasts, and must be within the range too.
    """
    if known is None:
        return ()
    (reduced, size, temperature), traced, quiet = _looked_at(reduced, size, temperature)
    with np.errstate(all="ignore"):
        rate = reduced / size * 2
    points = known.outside(rate, temperature)
    findings = () if traced else known.findings(rate, temperature)
    return told(known, points, "; ".join(findings), quiet)


def held_beyond(
    known: Range | None,
    time: Any,
    temperature: Any,
    factor: Any,
    shape: tuple[int, ...],
) -> tuple[Doubt, ...]:
    """What is put on at once and held for a `time` [s], or without one for ever, at
    points of a shape to which temperature and a_T broadcast.
    """
    if known is None:
        return ()
    held = np.inf if time is None else time
    (held, temperature, factor), traced, quiet = _looked_at(held, temperature, factor)
    with np.errstate(all="ignore"):
        rate = xp.broadcast_to(4 * factor / held, shape)
    if temperature is not None:
        temperature = xp.broadcast_to(temperature, shape)
    points = known.outside(rate, temperature)
    of = (
        "held for ever means a frequency"
        if time is None
        else "the time held means frequencies (a_T/t to 4 a_T/t)"
    )
    findings = () if traced else known.findings(rate, temperature, of)
    return told(known, points, "; ".join(findings), quiet)


def excited_outside(
    known: Range | None,
    surface: RoughLine | AbstractSpectrum,
    reduced: Array,
    factor: Callable[[Any], Any] | None = None,
) -> Float[Array, "..."] | None:
    """Share of the mean square slope that is excited, at q v a_T, beyond the
    frequencies of the data; without derivatives.

    `factor`, of rubber that is hotter at some wave numbers of a spectrum than at
    others: that on v a_T at wave numbers (n,), shape (points, n).
    """
    if known is None or known.omega is None:
        return None
    (surface, reduced), _, _ = _looked_at(surface, reduced)
    if not known.omega:
        return xp.ones(np.shape(reduced))
    if factor is not None and not isinstance(surface, RoughLine):
        steps = np.linspace(0.0, 1.0, _CELLS + 1)
        ends = surface.q_low * (surface.q_high / surface.q_low) ** steps
        q, share = xp.sqrt(ends[1:] * ends[:-1]), xp.diff(surface.moment(3, None, ends))
        (hotter,), _, _ = _looked_at(factor(q))
        omega = reduced.reshape(-1, 1) * q * hotter
        beyond = (omega < known.omega[0]) | (omega > known.omega[1])
        return (beyond @ (share / share.sum())).reshape(reduced.shape)
    low, high = (frequency / reduced for frequency in known.omega)
    if isinstance(surface, RoughLine):
        q = 2 * xp.pi * xp.fft.rfftfreq(surface.count, surface.spacing)
        power = xp.square(q * xp.abs(xp.fft.rfft(surface.height)))
        power = xp.append(xp.zeros(1), xp.cumsum(power))
        # a flat line excites nothing
        whole = xp.where(power[-1] == 0, 1.0, power[-1])
        until_high = power[xp.searchsorted(q, high, "right")]
        inside = xp.where(
            power[-1] == 0, 1.0, (until_high - power[xp.searchsorted(q, low)]) / whole
        )
    else:
        inside = surface.moment(3, low, high) / surface.moment(3)
    return xp.clip(1 - inside, 0.0, 1.0)


def rough_beyond(
    known: Range | None,
    outside: Array | None,
    temperature: Array | None,
    shape: tuple[int, ...],
    rise: Array | float = 0.0,
) -> tuple[Doubt, ...]:
    """Points where more than a tenth of the slope is excited `outside`, or at a
    temperature that was not measured, with the `rise` [K] by friction or without it.

    A point whose rise is not known has failed, and is not beyond the range for that.
    """
    if known is None:
        return ()
    if outside is None and known.temperature is None and not known.beyond:
        return illustrative(known, shape)
    (outside, temperature, rise), traced, quiet = _looked_at(outside, temperature, rise)
    only, rate, temperatures = known._replace(omega=None), np.zeros((2, *shape)), None
    if temperature is not None:
        body = xp.broadcast_to(temperature, shape)
        hot = xp.broadcast_to(rise, shape)
        temperatures = xp.stack([body, body + xp.where(xp.isnan(hot), 0.0, hot)])
    points: Any = only.outside(rate, temperatures).any(axis=0)
    findings = [] if traced else list(only.findings(rate, temperatures))
    if outside is not None:
        points = points | (outside > _OUTSIDE)
        if not traced and (outside > _OUTSIDE).any():
            most = f"up to {outside.max():.0%} of the mean square slope"
            findings.append(
                f"{most} lies outside the measured frequencies of the material"
            )
    return told(known, points, "; ".join(findings), quiet)
