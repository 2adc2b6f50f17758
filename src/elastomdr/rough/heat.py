"""Conduction of friction heat: closed forms of moving sources.

A heat source on the insulated surface of a half-space moves along x at v. With thermal
conductivity lambda [W/(m K)], heat capacity per volume rho c [J/(m^3 K)], diffusivity D
= lambda/(rho c) and w = v/2D, a unit of power at the distance r and the angle phi from
a point warms it, in the steady state, by exp(-w (r + r cos phi))/(2 pi lambda r)
(Jaeger 1942); on average over angles by I0(w r) exp(-w r)/(2 pi lambda r).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from .._types import Branch, Road, Rubber
from ..checks import (
    as_float64,
    as_number,
    is_traced,
    not_negative,
    numpy_unless_traced,
    one_of,
    positive,
    scalar,
)
from ..errors import InputError
from ..results.base import Assumed, Change
from ..results.words import brief
from ..trees import Tree, fill, static

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, Number, Scalar
    from ..call.types import SteadyBody
    from ..checks import Array

HIGHEST = 1000.0  # largest rise that is looked for [K]
NO_STATE = "no steady state"  # a row of results


class Typical(NamedTuple):
    """What typically conducts heat: conductivities [W/(m K)] and heat capacities per
    volume [J/(m^3 K)].
    """

    conductivity: float
    heat_capacity: float
    ends: Sequence[tuple[float, float]]  # low and high, of the bands of both
    says: str  # bands and sources


# Bands hold what the sources have, the heat capacity of rubber, of which there is one
# source, 10 %. That of asphalt is 2110 kg/m^3 times 750 to 1150 J/(kg K), measured on
# mixtures of several rocks, voids and binders at 60 to 70 degC (Zou et al.).
TYPICAL = {
    "filled rubber": Typical(
        0.23,
        2.2e6,
        ((0.17, 2.0e6), (0.25, 2.4e6)),
        "typical, not measured: 0.17 to 0.25 W/(m K), 2 to 2.4 MJ/(m^3 K); CIBSE Guide "
        "A, table 3.36; library of LBNL THERM 7.6",
    ),
    "asphalt": Typical(
        0.9,
        1.95e6,
        ((0.5, 1.6e6), (1.2, 2.4e6)),
        "typical, not measured: 0.5 to 1.2 W/(m K), 1.6 to 2.4 MJ/(m^3 K); CIBSE Guide "
        "A, table 3.36; Carlson et al., J. Mater. Civ. Eng. 22 (2010) 186; Zou et al., "
        "J. Jiangsu Univ. (Nat. Sci.) 37 (2016) 347 (abstract)",
    ),
    "concrete": Typical(
        1.7,
        2.2e6,
        ((1.5, 2.0e6), (1.95, 2.35e6)),
        "typical, not measured: 1.5 to 1.95 W/(m K), 2 to 2.35 MJ/(m^3 K); Carlson et "
        "al., J. Mater. Civ. Eng. 22 (2010) 186; NISTIR 6551 (2000); ASHRAE "
        "Fundamentals (2005)",
    ),
    "glass": Typical(
        1.0,
        2.15e6,
        ((0.99, 2.1e6), (1.05, 2.22e6)),
        "typical, not measured: 0.99 to 1.05 W/(m K), 2.1 to 2.22 MJ/(m^3 K); CIBSE "
        "Guide A, table 3.36; ASHRAE Fundamentals (2005)",
    ),
    "steel": Typical(
        45.0,
        3.8e6,
        ((45.0, 3.74e6), (50.0, 3.91e6)),
        "typical, not measured: 45 to 50 W/(m K), 3.74 to 3.91 MJ/(m^3 K); CIBSE Guide "
        "A, table 3.36; ASHRAE Fundamentals (2005); library of LBNL THERM 7.6",
    ),
}


class Heat(Tree):
    """What conducts the heat of friction, for `em.friction(heat=...)`; its methods are
    closed forms of moving sources.

    Args:
        conductivity: thermal conductivity of the rubber [W/(m K)].
        heat_capacity: heat capacity per volume, density times specific heat [J/(m^3
            K)].
        road: conductivity and heat capacity of the counterface, a pair in the same
            units; None for one that takes no heat. Its spots in contact are taken as
            steady, which they are after the time that `words()` tells. Or "asphalt",
            "concrete", "glass" or "steel" for typical values, as of `preset`.

    Raises:
        InputError: for values that are not positive, and a road that is no pair.
    """

    conductivity: Scalar  # lambda [W/(m K)]
    heat_capacity: Scalar  # rho c [J/(m^3 K)]
    road: tuple[Scalar, Scalar] | None  # the same of the counterface
    # names of rubber and road whose values are typical
    typical: tuple[str, str] = static()

    def __init__(
        self,
        conductivity: Number,
        heat_capacity: Number,
        *,
        road: tuple[Number, Number] | Road | None = None,
    ):
        called = ""
        if isinstance(road, str):
            one_of("road", road, *get_args(Road))
            called, road = road, TYPICAL[road][:2]
        if road is not None and (not isinstance(road, (tuple, list)) or len(road) != 2):
            raise InputError(
                argument="road",
                got=road,
                accepted="a pair, conductivity and heat capacity, or None",
            )
        pairs = [("conductivity", conductivity), ("heat_capacity", heat_capacity)]
        pairs += [("road", value) for value in road or ()]
        values = []
        for name, value in pairs:
            value = scalar(name, value)
            positive(name, value)
            values.append(as_number(value))
        fill(
            self,
            conductivity=values[0],
            heat_capacity=values[1],
            road=tuple(values[2:]) or None,
            typical=("", called),
        )

    @classmethod
    def preset(
        cls,
        rubber: Rubber = "filled rubber",
        *,
        road: tuple[Number, Number] | Road | None = None,
    ) -> Heat:
        """Typical values in place of measured ones, with a band that
        `curve.uncertainty()` takes up and a source that `words()` tells.

        Args:
            rubber: "filled rubber".
            road: as of the class.

        Raises:
            InputError: for other names.
        """
        one_of("rubber", rubber, *get_args(Rubber))
        heat = cls(*TYPICAL[rubber][:2], road=road)
        fill(heat, typical=(rubber, heat.typical[1]))
        return heat

    def at_end(self, end: int) -> Heat:
        """With what is typical at the low end of its band, 0, or the high one, 1."""
        rubber, road = (TYPICAL[x].ends[end] if x else None for x in self.typical)
        own = self.conductivity, self.heat_capacity
        return Heat(*(rubber or own), road=road or self.road)

    def band(self) -> Assumed | None:
        """That of presets; None where nothing is typical."""
        names = " and ".join(filter(None, self.typical))
        ends = Change(conducts=0), Change(conducts=1)
        return Assumed(f"{names}, typical", *ends) if names else None

    @property
    def diffusivity(self) -> Scalar:
        """D = lambda/(rho c) [m^2/s]."""
        return self.conductivity / self.heat_capacity

    def words(self, longest: float | None = None) -> str:
        """In one line; with the longest wave of a surface [m] also when the spots of
        the road are steady.
        """

        def of(name: str, one: Scalar, other: Scalar) -> str:
            known = f", {name} ({TYPICAL[name].says})" if name else ""
            return (
                f"conductivity {brief(one, 'W/(m K)')}, "
                f"heat capacity {brief(other, 'J/(m^3 K)')}{known}"
            )

        rubber, road = self.typical
        sentence = of(rubber, self.conductivity, self.heat_capacity)
        if self.road is None:
            return sentence
        sentence += f"; road: {of(road, *self.road)}"
        if longest is None:
            return sentence
        return (
            f"{sentence}, steady after "
            f"{(longest / 2) ** 2 * self.road[1] / self.road[0]:.2g} s of contact"
        )

    @numpy_unless_traced
    def uniform_flux(
        self, flux: ArrayLike, time: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Surface temperature rise [K] of a half-space under an even `flux` [W/m^2]
        after `time` [s]; exact.

        dT = 2 q sqrt(t/(pi lambda rho c)). Carslaw & Jaeger 1959, 2.9. Raises
        `InputError`.
        """
        flux, time = _arrays({"flux": flux, "time": time})
        not_negative("time", time)
        return (
            2 * flux * np.sqrt(time / (np.pi * self.conductivity * self.heat_capacity))
        )

    @numpy_unless_traced
    def moving_band(
        self, flux: ArrayLike, half_width: ArrayLike, velocity: ArrayLike, x: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Steady surface temperature rise [K] at `x` [m] from the middle of an endless
        band that moves towards +x.

        `flux` q [W/m^2] on |x| < b = `half_width` [m], at `velocity` v [m/s]; x moves
        with it, the trailing edge is x = -b. Exact (Jaeger 1942):

            dT = (q/(pi lambda w)) int_{w(x-b)}^{w(x+b)} exp(-u) K0(|u|) du,   w = v/2D,

        in closed form, since (u e^u (K0 + K1))' = e^u K0 and (u e^-u (K0 - K1))' = e^-u
        K0. Raises `InputError`.
        """
        flux, half, velocity, x = _arrays(
            {"flux": flux, "half_width": half_width, "velocity": velocity, "x": x}
        )
        positive("half_width", half)
        positive("velocity", velocity)
        w = velocity / (2 * self.diffusivity)
        return (
            flux
            / (np.pi * self.conductivity * w)
            * (_jaeger(w * (x + half)) - _jaeger(w * (x - half)))
        )

    @numpy_unless_traced
    def moving_disc(
        self, flux: ArrayLike, radius: ArrayLike, velocity: ArrayLike
    ) -> Float[np.ndarray, "..."]:
        """Steady temperature rise [K], mean over a disc of `radius` a [m] and even
        `flux` q [W/m^2], moving at v.

            dT = (2 q a/lambda) int_0^1 (2/pi) [acos s - s sqrt(1 - s^2)]
                 I0(2 w a s) exp(-2 w a s) ds,
            w = v/2D,

        exact at every Peclet number w a: the bracket is the overlap of two discs at the
        distance 2 a s. At rest 8 q a/(3 pi lambda) (Carslaw & Jaeger 1959, 10.5). To
        1e-9. Raises `InputError`.
        """
        from scipy.special import i0e

        flux, radius, velocity = _arrays(
            {"flux": flux, "radius": radius, "velocity": velocity}
        )
        positive("radius", radius)
        not_negative("velocity", velocity)
        t = np.arange(-4.2, 3.2, 0.02)
        x = np.pi * np.sinh(t)
        with np.errstate(over="ignore"):
            s, rest = 1 / (1 + np.exp(-x)), 1 / (1 + np.exp(x))  # s, 1 - s
        step = 0.02 * np.pi * np.cosh(t) * s * rest
        root = np.sqrt(rest * (1 + s))
        overlap = 2 / np.pi * (np.arcsin(root) - s * root)
        passed = (velocity * radius / self.diffusivity)[..., None]
        return (
            2 * flux * radius / self.conductivity * (i0e(passed * s) @ (overlap * step))
        )


def _jaeger(u: np.ndarray) -> np.ndarray:
    """int_0^u exp(-s) K0(|s|) ds."""
    from scipy.special import k0e, k1e

    size = np.maximum(np.abs(u), 1e-300)
    ahead = 1 + size * np.exp(-2 * size) * (k0e(size) - k1e(size))
    behind = size * (k0e(size) + k1e(size)) - 1
    return np.where(u == 0, 0.0, np.where(u > 0, ahead, -behind))


def _arrays(values: Mapping[str, ArrayLike]) -> list[np.ndarray]:
    return list(
        np.broadcast_arrays(
            *(as_float64(name, value) for name, value in values.items())
        )
    )


def check_heat(
    heat: Heat | None,
    temperature: ArrayLike | None,
    branch: Branch,
    traced: bool,
    by_scale: bool = False,
) -> None:
    """Raises `InputError` unless flash temperature can be found, by scale or one for
    all, or is not asked for.
    """
    one_of("branch", branch, *get_args(Branch))
    if heat is None:
        if branch != "cold":
            raise InputError(
                argument="branch",
                got=branch,
                accepted="'cold' without heat=em.Heat(...)",
            )
        return
    if traced and not by_scale:
        raise InputError(
            argument="heat",
            accepted="left out under jax.grad, jit and vmap with em.Line() and "
            "em.HalfSpace()",
            hint="the flash temperature is differentiable with em.Multiscale() and "
            "em.Persson() only",
        )
    if not isinstance(heat, Heat):
        raise InputError(
            argument="heat",
            got=heat,
            accepted="an em.Heat(conductivity, heat_capacity)",
        )
    if temperature is None:
        raise InputError(
            argument="temperature",
            accepted="given [K] with heat, that of the rubber without the flash",
            hint="the material needs a shift law",
        )


def highest_rise(body: SteadyBody, temperature: Array) -> Any:
    """The largest rise to look for at each point [K]: that of a shift law's end above
    the body, or 1000 K.
    """
    if is_traced(body, temperature):
        return HIGHEST
    laws = [law for law in (body.shift, body.vertical) if law is not None]
    hottest = min(law._hottest for law in laws)
    # a temperature at the end itself may be rounded to one beyond it
    return np.clip(hottest * (1 - 1e-12) - np.asarray(temperature), 0.0, HIGHEST)


def why_no_state(
    runaway: Array, body: SteadyBody, temperature: Array
) -> list[tuple[str, str]]:
    """A row for results with points at which friction makes more heat than is led away
    up to the highest rise.
    """
    if not runaway.any():
        return []
    highest = highest_rise(body, temperature)
    ends = np.unique(np.round((temperature + highest)[runaway], 2))
    limit = " to ".join(f"{end:.6g}" for end in ends[[0, -1][: ends.size]])
    sentence = (
        f"at {int(runaway.sum())} of {runaway.size} points friction makes more heat than "
        f"is led away at every temperature of the contacts up to {limit} K"
    )
    if (highest[runaway] < HIGHEST).any():
        sentence += (
            ", where the shift law of the material ends; with a law that goes on, such as "
            "em.WLF, there is an answer, which is extrapolated"
        )
    return [(NO_STATE, sentence)]
