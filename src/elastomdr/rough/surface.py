"""Steady friction of a surface under a pressure, by any `SurfaceModel`: check, solve,
pack.
"""

import dataclasses
import warnings
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from ..call.extrapolation import NOT_KNOWN, Beyond, excited_outside, rough_beyond, told
from ..call.problem import Scene, rough_scene
from ..checks import is_traced, nan_unless, require, scalar
from ..element.law import surface_foundation
from ..errors import ConvergenceWarning, InputError, ModelWarning
from ..material.shift import thermal_factors
from ..material.validity import misfit
from ..models import SurfaceFriction, SurfaceModel
from ..results.curve import FrictionCurve
from ..smooth.softening import LINEAR
from ..surface.spectrum import AbstractSpectrum
from .adhesion import sheared, why_hotter
from .adhesive_shear import AdhesiveShear, check_adhesion
from .heat import Heat, check_heat
from .local_modulus import Local, Softened
from .mean import Mean

_MEGAPASCALS = 10.0  # pressure up to which it may be one in MPa [Pa]
_LEAST = 1e-4  # share of real contact below which it probably is
_HOT = (
    "; rubber at the flash temperature of its contacts (moving sources by length scale)"
)
_HOT_BY_SCALE = (
    "; rubber at a temperature for each length scale, heated by its friction"
)
_SOFTENED = "; moduli softened by the strain of each length scale"
_STRAIN_SHARE = 2.0  # factor within which the strain at a scale is taken to be known
_MOST_SHARE = 2.0


@dataclasses.dataclass(frozen=True)
class SurfacePlan:
    """What is computed for a surface under a pressure; `print(plan)` says it in
    words.
    """

    scene: str
    model: str
    points: int
    work: str
    skipped: str

    def __str__(self) -> str:
        return "\n".join(
            [
                f"Plan: friction, {self.scene}",
                f"  model: {self.model}",
                f"  {self.points} points: {self.work}",
                f"  skipped: {self.skipped}",
            ]
        )


def surface_friction(
    material: Any,
    surface: AbstractSpectrum,
    model: SurfaceModel,
    *,
    velocity: Any,
    pressure: Any,
    temperature: Any,
    rtol: Any,
    heat: Heat | None,
    adhesion: AdhesiveShear | None,
    strain_share: Any,
    progress: Callable[[int, int], None] | None,
) -> FrictionCurve:
    """`em.friction` of a surface that is given by its spectrum, under a pressure; see
    there.
    """
    foundation, scene = _set_up(
        material, surface, model, velocity, pressure, temperature, rtol, heat
    )
    check_adhesion(adhesion, temperature)
    strain_share = _checked_share(strain_share)
    scene = scene._replace(
        traced=scene.traced or is_traced(heat, adhesion, strain_share)
    )
    shape, kelvin, traced = scene.shape, scene.kelvin, scene.traced
    pressures = scene.full(scene.value)  # [Pa]
    # by the material at its reference temperature
    carried = (pressures / scene.vertical).ravel()
    solved = partial(
        model.solve, foundation, surface, rtol=float(rtol), progress=progress
    )
    softened = None
    if foundation.softening is not None and model.softens:
        softened = Softened(foundation.softening, surface, strain_share)
    local = Local(softened)
    found = solved(scene.reduced.ravel(), carried, local=local)
    if not traced:
        _doubt_unit(found, pressures.ravel())
    reduced, warm, cold, by_scale = scene.reduced, None, found, None
    if heat is not None and model.heats_by_scale:
        found, by_scale, local = _heated(
            heat, adhesion, foundation, surface, model, scene, found, local, solved
        )
        if not traced:
            factors = thermal_factors(
                foundation, scene.full(kelvin).ravel() + by_scale.mean
            )
            reduced, carried = (
                scene.full(scene.velocity) * factors[0].reshape(shape),
                pressures.ravel() / factors[1],
            )
    elif heat is not None:
        if adhesion is not None:
            raise InputError(
                "heat with adhesion needs em.Multiscale() or em.Persson(), got "
                f"{model!r}."
            )
        v, t, p = (scene.full(a).ravel() for a in (scene.velocity, kelvin, pressures))

        from .flash import SETTLED, warmed

        def again(reduced: np.ndarray, pressure: np.ndarray, coarse: bool) -> Mean:
            return _as_mean(solved(reduced, pressure, local=local))

        warm = warmed(heat, foundation, surface, v, t, p, _as_mean(found), again)
        reduced = warm.reduced.reshape(shape)
        found = found._replace(
            mu=warm.mean.mu,
            area=warm.mean.share,
            good=warm.mean.good,
            error=warm.mean.error + SETTLED * np.abs(warm.mean.mu - cold.mu),
        )
    if not traced and not found.good.all():
        warnings.warn(
            (
                f"{int((~found.good).sum())} of {found.good.size} points did not "
                f"converge to rtol={rtol:g}; they are NaN."
            )
            + (
                f" Maps: {found.said}; more cells hold more of them."
                if found.said
                else ""
            ),
            ConvergenceWarning,
            stacklevel=4,
        )

    def field(values: Any) -> Any:
        return nan_unless(found.good, values).reshape(shape)

    outside = None if traced else excited_outside(foundation.range, surface, reduced)
    series = np.zeros(()) if traced else _misfit(foundation, surface, reduced.ravel())
    label = (
        surface.label if is_traced(surface) else f"{surface.label}, {surface.words()}"
    )
    inputs = scene.inputs(
        ("surface", label),
        *(("as read", text) for text in getattr(surface, "report", ())),
    )
    if heat is not None:
        inputs.append(
            ("heat", heat.words(None if traced else float(2 * np.pi / surface.q_low)))
        )
    inputs += (
        []
        if by_scale is None or traced
        else _scales_in_words(by_scale, np.asarray(found.good))
    )
    straight, spread = None, (0.0, 0.0)
    if softened is not None:
        straight, spread, said = _softening(
            softened, foundation, surface, model, scene, found, local, carried, rtol
        )
        inputs += said
    elif foundation.softening is not None:
        inputs.append(
            (
                "softening",
                (
                    "of the material is left out: this model is linear, its moduli "
                    "are of small strain"
                ),
            )
        )
    inputs += [] if not found.said else [("maps", found.said)]
    if np.any(series):
        inputs.append(
            (
                "material against its data",
                f"at most {np.max(series):.0%} of mu, part of the error",
            )
        )
    if outside is not None:
        inputs.append(
            (
                "excited beyond",
                (
                    f"the material's data: at most {np.nanmax(outside):.0%} of <|grad "
                    "h|^2>"
                ),
            )
        )
    beyond = (
        NOT_KNOWN
        if traced
        else rough_beyond(foundation.range, outside, kelvin, shape, stacklevel=4)
    )
    inputs += beyond.said
    if softened is not None and not traced:
        beyond = _strained_beyond(softened, surface, beyond, shape, foundation.range)
        inputs += beyond.said[-1:]
    kind = (
        ""
        if foundation.softening is None
        else LINEAR
        if softened is None
        else _SOFTENED
    )
    stress = field(found.mu * pressures.ravel())
    curve = FrictionCurve(
        velocity=scene.full(scene.velocity),
        mu=field(found.mu),
        normal_force=field(pressures.ravel()),
        friction_force=stress,
        depth=None,
        contact=None,
        error=field(found.error + series * abs(found.mu)),
        converged=found.good.reshape(shape),
        temperature=scene.full(kelvin),
        model=model.words() + kind + _hot(model, heat),
        plan=_plan(foundation, scene, surface, model, heat),
        inputs=tuple(inputs),
        extrapolated=beyond.points,
        model_error=_model_error(
            model, foundation, surface, found, reduced, spread[0], field
        ),
        pressure=pressures,
        area_ratio=field(found.area),
        temperature_rise=None if warm is None else field(warm.rise),
        cold=None if heat is None else field(cold.mu),
        heat_flux=None if warm is None else field(warm.heat),
        linear=None if straight is None else field(straight),
        outside=outside,
    )
    if by_scale is not None:
        curve = dataclasses.replace(
            curve,
            temperature_rise=field(by_scale.mean),
            contact_rise=field(by_scale.contact),
            heat_flux=field(by_scale.flux * (1 - by_scale.to_road)),
            road_share=None
            if heat is None or heat.road is None
            else field(by_scale.to_road),
        )
    if adhesion is None:
        return curve
    area, of_area, more = field(found.area), field(found.area_error), {}
    if heat is not None:
        stress = adhesion.shear_stress(scene.full(scene.velocity), scene.full(kelvin))
        more = {"cold": curve.cold + stress * field(cold.area) / pressures}
    bound = _model_error(
        model, foundation, surface, found, reduced, spread[1], field, of_area=True
    )
    both = sheared(
        curve,
        adhesion,
        area / pressures,
        of_area / area,
        bound,
        "area of real contact",
        **more,
    )
    if heat is None or traced:
        return both
    return dataclasses.replace(
        both, inputs=(*both.inputs, *why_hotter(both, field(cold.area), stress))
    )


def _checked_share(share: Any) -> Any:
    share = scalar("strain_share", share)
    require(
        "strain_share",
        share,
        f"above 0 and at most {_MOST_SHARE:g}",
        lambda x: (x > 0) & (x <= _MOST_SHARE),
    )
    return share


def _heated(
    heat: Heat,
    adhesion: AdhesiveShear | None,
    foundation: Any,
    surface: Any,
    model: SurfaceModel,
    scene: Scene,
    cold: SurfaceFriction,
    local: Local,
    solved: Callable[..., SurfaceFriction],
) -> tuple[SurfaceFriction, Any, Local]:
    """Friction at the temperatures that it makes, and those."""
    from .temperature_by_scale import HIGHEST, Problem, reach, warmed

    v, kelvin, p = (
        scene.full(a).ravel() for a in (scene.velocity, scene.kelvin, scene.value)
    )
    reduced, carried = scene.reduced.ravel(), p / scene.vertical.ravel()
    highest = HIGHEST if scene.traced else reach(foundation, kelvin)
    problem = Problem(
        foundation,
        surface,
        local.softened,
        heat,
        adhesion,
        v,
        reduced,
        kelvin,
        p,
        carried,
    )
    by_scale = warmed(problem, model, highest)
    hot = local._replace(warmed=by_scale.warmed)
    found = solved(reduced, carried, local=hot)
    good = found.good & cold.good & by_scale.good
    return found._replace(error=found.error + by_scale.error, good=good), by_scale, hot


def _scales_in_words(by_scale: Any, good: np.ndarray) -> list[tuple[str, str]]:
    """The rise of temperature by length scale, where it is largest."""
    said = []
    if good.any():
        i = int(np.argmax(np.where(good, by_scale.contact, -np.inf)))
        length, rise = (
            2 * np.pi / np.exp(by_scale.warmed.log_q()),
            by_scale.warmed.rise[i],
        )
        parts = [
            f"{rise[k]:.3g} K at {1e3 * length[k]:.2g} mm"
            for k in (0, rise.size // 2, -1)
        ]
        said.append(("rise by wavelength", f"{', '.join(parts)}, where it is largest"))
    if by_scale.several.any():
        said.append(
            (
                "hot branch",
                (
                    f"{int(by_scale.several.sum())} points have a second, hotter "
                    "steady "
                    "state, which rubber reaches that was hot before; the colder one "
                    "is given"
                ),
            )
        )
    return said


def _softening(
    softened: Softened,
    foundation: Any,
    surface: Any,
    model: SurfaceModel,
    scene: Scene,
    found: SurfaceFriction,
    local: Local,
    carried: Any,
    rtol: Any,
) -> tuple[Any, tuple[Any, Any], list[tuple[str, str]]]:
    """mu without softening; how far mu and, relatively, the area are off at half and
    twice the strain; all in words.

    Nothing of it under a transformation of JAX, but that how far they are off is not
    known.
    """
    if scene.traced:
        return None, (np.nan, np.nan), []
    v = scene.reduced.ravel()
    carried = (scene.full(scene.value) / scene.vertical).ravel()

    def at(share: Any) -> Any:
        other = local._replace(
            softened=None if share is None else softened._replace(share=share)
        )
        return model.solve(
            foundation, surface, v, carried, other, max(float(rtol), 1e-3), None
        )

    straight, here = at(None), at(softened.share)
    others = [
        at(softened.share * factor) for factor in (_STRAIN_SHARE, 1 / _STRAIN_SHARE)
    ]
    off = np.max([abs(other.mu - here.mu) for other in others], axis=0)
    off_area = np.max([abs(other.area / here.area - 1) for other in others], axis=0)
    strain = float(softened.strain(surface.q_high))
    storage, loss = (float(x) for x in softened.softening.factors(strain))
    ratio, more = (
        (a / b)[found.good]
        for a, b in ((here.mu, straight.mu), (here.area, straight.area))
    )
    text = (
        f"strain up to {strain:.2g}, where the storage modulus is {storage:.0%} and "
        f"the loss modulus {loss:.0%}"
    )
    if ratio.size:
        text += (
            f"; hysteresis {ratio.min():.2f} to {ratio.max():.2f} times, contact area "
            f"{more.min():.2f} to {more.max():.2f} times those without"
        )
    return straight.mu, (off, off_area), [("softening", text)]


def _strained_beyond(
    softened: Softened, surface: Any, beyond: Beyond, shape: tuple[int, ...], known: Any
) -> Beyond:
    """All points, where the surface strains the rubber more than its sweep did."""
    strain, last = (
        float(softened.strain(surface.q_high)),
        float(softened.softening.strain[-1]),
    )
    if strain <= last * (1 + 1e-9):
        return beyond._replace(said=())
    what = (
        f"strains up to {strain:.2g} on a sweep that ends at {last:.2g}, whose last "
        "factors are held"
    )
    return told(
        np.ones(shape, dtype=bool),
        what,
        known is not None and known.illustrative,
        stacklevel=4,
    )


def surface_plan(
    material: Any,
    surface: AbstractSpectrum,
    model: SurfaceModel,
    *,
    velocity: Any,
    pressure: Any,
    temperature: Any,
    rtol: Any,
    heat: Heat | None,
) -> SurfacePlan:
    """`em.plan` of a surface under a pressure; see there."""
    scene = _set_up(
        material, surface, model, velocity, pressure, temperature, rtol, heat
    )
    return _plan(*scene, surface, model, heat)


def _plan(
    foundation: Any,
    scene: Scene,
    surface: AbstractSpectrum,
    model: SurfaceModel,
    heat: Heat | None,
) -> SurfacePlan:
    name = foundation.name or "a foundation given directly"
    work, skipped = model.work(surface)
    points = int(np.prod(scene.shape))
    label = (
        surface.label if is_traced(surface) else f"{surface.label}, {surface.words()}"
    )
    return SurfacePlan(
        f"{label} on {name}", model.words() + _hot(model, heat), points, work, skipped
    )


def _hot(model: SurfaceModel, heat: Heat | None) -> str:
    if heat is None:
        return ""
    return _HOT_BY_SCALE if model.heats_by_scale else _HOT


def _set_up(
    material: Any,
    surface: Any,
    model: SurfaceModel,
    velocity: Any,
    pressure: Any,
    temperature: Any,
    rtol: Any,
    heat: Any,
) -> tuple[Any, Scene]:
    """The foundation and its points, checked. Raises `InputError`."""
    foundation = surface_foundation(material)
    scene = rough_scene(
        foundation,
        surface,
        velocity=velocity,
        pressure=pressure,
        temperature=temperature,
        rtol=rtol,
    )
    check_heat(
        heat,
        temperature,
        scene.traced or is_traced(heat),
        model.heats_by_scale,
    )
    if not scene.traced:  # averages over directions look far below a frequency
        low, high = 1e-89 / float(surface.q_low), 1e97 / float(surface.q_high)
        text = (
            f"between {low:.0e} and {high:.0e} m/s on this surface, times the shift "
            "factor"
        )
        require("velocity", scene.reduced, text, lambda v: (v > low) & (v < high))
    return foundation, scene


def _as_mean(found: SurfaceFriction) -> Mean:
    unknown = np.full(np.shape(found.mu), np.nan)
    return Mean(found.mu, found.error, unknown, unknown, found.area, found.good, None)


def _doubt_unit(found: SurfaceFriction, pressure: np.ndarray) -> None:
    """Warns of a pressure that is likely to be meant in MPa: a small number, under
    which hardly anything touches.
    """
    area = np.where(found.good & (pressure <= _MEGAPASCALS), found.area, 1.0)
    least = int(np.argmin(area))
    if area[least] < _LEAST:
        given = f"{pressure[least]:g}"
        warnings.warn(
            f"pressure is taken in Pa: {given} Pa give a real contact of "
            f"{area[least]:.1g} of the nominal area. If {given} MPa are meant, write "
            f"{1e6 * pressure[least]:g}.",
            ModelWarning,
            stacklevel=4,
        )


def _misfit(
    foundation: Any, surface: AbstractSpectrum, reduced: np.ndarray
) -> np.ndarray:
    """Relative change of mu for what a material misses of the data that it was fitted
    to; 0 where that is not known.

    Friction goes with the loss modulus, and in light contact with the reciprocal of the
    storage modulus: both root mean squares, over the frequencies from q_low v a_T to
    q_high v a_T, or over all of the data where those lie beyond them.
    """
    within = np.hypot(
        *misfit(foundation, surface.q_low * reduced, surface.q_high * reduced)
    )
    whole = np.nan_to_num(np.hypot(*misfit(foundation, 0.0, np.inf)))
    return np.where(np.isfinite(within), within, whole)


def _model_error(
    model: SurfaceModel,
    foundation: Any,
    surface: AbstractSpectrum,
    found: SurfaceFriction,
    reduced: Any,
    spread: Any,
    field: Callable[[Any], Any],
    of_area: bool = False,
) -> Any:
    """Bound on mu's distance from three dimensions, or on the area's relative one; None
    for that model itself.

    `spread` is what the strain at a scale, not known better than within a factor of
    two, adds to it. The bound itself holds with softening as without: each scale is
    linear, and moduli that change with the wave number are what it was established for.
    """
    if foundation.softening is not None and not model.softens:
        return field(np.full(np.shape(found.mu), np.nan))
    bound = model.bound(foundation, surface, reduced.ravel(), found.area, of_area)
    if bound is None:
        return None
    return field((bound if of_area else abs(found.mu) * bound) + spread)
