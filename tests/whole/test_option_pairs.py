"""Every pair of options of `em.friction` and `em.rolling`: `jit` and `vmap` are the plain
call, gradients are its differences.

Options that work alone broke together: heat on a surface with a lay had no gradient,
and no test asked.
"""

from itertools import combinations
from typing import Any

import jax
import numpy as np
import pytest

import elastomdr as em
from elastomdr.surface.height_map import _PLACES
from elastomdr.surface.lay import Lay
from elastomdr.surface.topography import MeasuredSurface

pytestmark = pytest.mark.filterwarnings("ignore::elastomdr.errors.ExtrapolationWarning")

WLF = em.WLF(8.86, 101.6, 293.15)
SOFT = em.Softening([1e-3, 1e-2, 0.1, 1.0], [1.0, 0.8, 0.5, 0.4], [1.0, 1.1, 0.9, 0.5])
MEASURED = {"omega": (1e3, 1e6)}  # what is asked for lies in part beyond
HEAT = em.Heat(0.25, 2e6, road=(1.5, 2e6))
SHEAR = em.AdhesiveShear(3e5, 6e-3, 0.1, shift=em.Arrhenius(9e4, 293.15))
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=2e3, q_high=2e4)
# of friction of a surface under a pressure
ON_ROAD = (
    "heat",
    "hot",
    "adhesion",
    "direction",
    "softening",
    "vertical",
    "persson",
    "skewness",
    "tabulated",
)
# of a smooth body
SMOOTH = (
    "depth",
    "line",
    "adhesion",
    "softening",
    "vertical",
    "layer",
    "cylinder",
    "tabulated",
)
# velocity [m/s], pressure [Pa], load [N] or depth [m], temperature [K], level of moduli
AT = {
    "road": np.array([0.1, 2e5, 293.0, 1.0]),
    "ball": np.array([0.01, 5.0, 293.0, 1.0]),
}
DEPTH = 2e-4


def rubber(options: tuple[str, ...], level: Any) -> Any:
    more: dict[str, Any] = {"shift": WLF, "range": MEASURED}
    if "softening" in options:
        more["softening"] = SOFT
    if "vertical" in options:
        more["vertical"] = em.EntropicVertical(293.15)
    if "tabulated" in options:
        omega = np.geomspace(1e-3, 1e11, 141)
        w = omega[:, None] * np.array([1e-6, 1e-3])
        loss = w / (1 + w**2) @ np.array([3e7, 3e6])
        storage = 0.5e6 + w**2 / (1 + w**2) @ np.array([3e7, 3e6])
        return em.TabulatedModulus(omega, level * storage, level * loss, **more)
    return em.Prony(0.5e6, level * np.array([3e7, 3e6]), [1e-6, 1e-3], **more)


def surface(options: tuple[str, ...]) -> Any:
    if not {"direction", "skewness"} & set(options):
        return ROAD
    q = ROAD.q
    lay = Lay(q, np.full(q.size, np.log(3.0)), 0 * q, 0.0)
    return MeasuredSurface(
        q=q,
        c=ROAD.c,
        relative_error=0 * q,
        measured_height=ROAD.rms_height,
        skewness=-0.5 if "skewness" in options else 0.0,
        skewness_error=0.1 if "skewness" in options else 0.0,
        tops=-0.2 * _PLACES if "skewness" in options else None,
        report=(),
        lay=lay if "direction" in options else None,
    )


def on_road(options: tuple[str, ...], at: Any) -> Any:
    velocity, pressure, temperature, level = at
    return em.friction(
        rubber(options, level),
        surface(options),
        velocity=velocity,
        pressure=pressure,
        temperature=temperature,
        rtol=1e-8,
        heat=HEAT if {"heat", "hot"} & set(options) else None,
        branch="hot" if "hot" in options else "cold",
        adhesion=SHEAR if "adhesion" in options else None,
        direction=0.4 if "direction" in options else None,
        model="persson" if "persson" in options else None,
    )


def smooth(verb: Any, options: tuple[str, ...], at: Any) -> Any:
    velocity, load, temperature, level = at
    material = rubber(options, level)
    if "layer" in options:
        material = em.layer(material, 5e-3)
    body = em.Cylinder(0.02, 0.05) if "cylinder" in options else em.Sphere(0.02)
    pressed = {"depth": load * DEPTH / 5.0} if "depth" in options else {"load": load}
    more = {"adhesion": SHEAR} if "adhesion" in options else {}
    model = "line" if "line" in options else None
    return verb(
        material,
        body,
        velocity=velocity,
        temperature=temperature,
        model=model,
        rtol=1e-8,
        **pressed,
        **more,
    )


def refused(options: tuple[str, ...]) -> bool:
    """Pairs that have no meaning, or no derivative: each says so in an error."""
    pair = set(options)
    return (
        pair == {"depth", "cylinder"}  # plane strain
        or ("tabulated" in pair and pair.isdisjoint({"layer", "cylinder"}))
    )


def solved(scene: str, options: tuple[str, ...], at: Any) -> Any:
    if scene == "road":
        return on_road(options, at)
    return smooth(getattr(em, scene), options, at)


def coefficient(scene: str, options: tuple[str, ...], at: Any) -> Any:
    curve = solved(scene, options, at)
    return curve.coefficient if scene == "rolling" else curve.mu


PAIRS = [("road", pair) for pair in combinations(ON_ROAD, 2)]
PAIRS += [("friction", pair) for pair in combinations(SMOOTH, 2)]
PAIRS += [
    ("rolling", pair) for pair in combinations(SMOOTH, 2) if "adhesion" not in pair
]
UNTRACED = [("depth", "layer"), ("layer", "tabulated"), ("cylinder", "tabulated")]
TRACED = [
    (scene, pair)
    for scene, pair in PAIRS
    if scene == "road" or not (refused(pair) or pair in UNTRACED)
]
# what compiles or computes for seconds
LONG = {"hot", "layer", "tabulated"}
QUICKLY_DERIVED = [
    ("road", ("adhesion", "direction")),
    ("friction", ("depth", "line")),
]


def marked(pairs: list[Any], long: Any) -> list[Any]:
    """As parameters, the `long` ones slow."""
    return [
        pytest.param(
            scene,
            pair,
            id="-".join((scene, *pair)),
            marks=[pytest.mark.slow] if long(scene, pair) else [],
        )
        for scene, pair in pairs
    ]


@pytest.mark.parametrize(
    ("scene", "pair"), marked(TRACED, lambda _, pair: LONG & set(pair))
)
def test_jit_and_vmap_are_the_plain_call(scene, pair):
    at = AT[scene if scene == "road" else "ball"]
    both = np.stack([at, 1.01 * at])
    plain = solved(scene, pair, at)
    main, other = (coefficient(scene, pair, x) for x in both)
    with jax.enable_x64(True):
        traced = jax.jit(lambda x: solved(scene, pair, x))(at)
        mapped = jax.vmap(lambda x: coefficient(scene, pair, x))(both)
    numbers = plain.fields()
    # of what a second look costs a trace has none, and no small number in its place
    missing = {q.key for q in numbers} - {q.key for q in traced.fields()}
    assert missing <= {"linear"}
    for q, values in traced.fields().items():
        rounding = 1e-10 * main if q.key == "error" else 0.0
        np.testing.assert_allclose(
            np.asarray(values), numbers[q], rtol=1e-9, atol=rounding, err_msg=q.key
        )
    np.testing.assert_allclose(np.asarray(mapped), [main, other], rtol=1e-9)


@pytest.mark.parametrize(
    ("scene", "pair"),
    marked(TRACED, lambda scene, pair: (scene, pair) not in QUICKLY_DERIVED),
)
def test_gradients_are_differences(scene, pair):
    """By velocity, pressure, load or depth, temperature, and the level of the moduli:
    what mu changes by a relative change of each, of fourth order.
    """
    at = AT[scene if scene == "road" else "ball"]
    with jax.enable_x64(True):
        slopes = jax.grad(lambda x: coefficient(scene, pair, x))(at)
    main = float(coefficient(scene, pair, at))
    steps = np.diag(at * np.array([1e-3, 1e-3, 2e-4, 1e-3]))
    for i, step in enumerate(steps):
        values = [coefficient(scene, pair, at + n * step) for n in (-2, -1, 1, 2)]
        change = float(np.dot([1, -8, 8, -1], values)) / (12 * step[i])
        # those of a road are integrals over 24 cells a decade, without ends where
        # moduli soften from one piece of a sweep to the next
        assert float(slopes[i]) * at[i] == pytest.approx(
            change * at[i], abs=3e-5 * main, rel=3e-4
        ), i


@pytest.mark.parametrize(("scene", "pair"), [x for x in PAIRS if x not in TRACED])
def test_what_is_refused_says_so(scene, pair):
    """Plainly, or under `jit` alone."""
    at = AT["ball"]
    if refused(pair):
        with pytest.raises(em.InputError, match="must be"):
            solved(scene, pair, at)
        return
    assert np.isfinite(coefficient(scene, pair, at))
    with jax.enable_x64(True), pytest.raises(em.InputError, match="must be"):
        jax.jit(lambda x: coefficient(scene, pair, x))(at)
