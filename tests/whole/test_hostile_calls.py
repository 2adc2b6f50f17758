"""Every public call with values that nobody means, at each of its arguments: an
`InputError`, or a result that says where it holds.
"""

import atexit
import inspect
import random
import shutil
import signal
import tempfile
import warnings
from pathlib import Path

import numpy as np
import pytest

import elastomdr as em
from elastomdr.results.base import Result

SOLID = em.Prony(1e6, [2e6], [1e-2], shift=em.WLF(8.86, 101.6, 293.15), name="a solid")
SPHERE = em.Sphere(5e-3)
ROLLER = em.Cylinder(0.03, 0.1)
ROAD = em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e5)
X = np.linspace(0, 2e-3, 65)
LINE = em.RoughLine(X, 1e-5 * np.sin(2 * np.pi * X / 2e-3))
TIME = np.linspace(0, 0.1, 9)
COVER = em.springs(SOLID, 5e-3, bonded=False)
IDLERS = em.Idlers(COVER, ROLLER, spacing=1.2, shares=(0.3, 0.4, 0.3))
V = np.array([0.01, 1.0])
CURVE = em.friction(SOLID, SPHERE, velocity=V, load=1.0)
OMEGA = np.logspace(-1, 5, 25)
MODULUS = SOLID.complex_modulus(OMEGA)
DMA = em.fit.dma(
    np.tile(np.logspace(-1, 2, 9), 3),
    *[
        np.concatenate(
            [getattr(SOLID.at(T), part)(np.logspace(-1, 2, 9)) for T in (280, 290, 300)]
        )
        for part in ("storage", "loss")
    ],
    np.repeat([280.0, 290.0, 300.0], 9),
    kind="shear",
)
FOLDER = Path(tempfile.mkdtemp())
atexit.register(shutil.rmtree, FOLDER)
LAW = FOLDER / "law.csv"
CURVE.law().to_csv(LAW)


def table(name, *columns):
    path = FOLDER / name
    path.write_text("\n".join([",".join(row) for row in zip(*columns, strict=True)]))
    return path


def column(title, numbers):
    return [title, *map(str, numbers)]


DMA_FILE = table(
    "dma.csv",
    column("frequency [Hz]", OMEGA / 2 / np.pi),
    column("G' [Pa]", MODULUS.real),
    column("G'' [Pa]", MODULUS.imag),
    column("temperature [degC]", np.full(25, 20.0)),
)
FRICTION_FILE = table(
    "friction.csv", column("velocity [m/s]", [0.1, 1.0]), column("mu", [0.5, 0.6])
)
SHIFT_FILE = table(
    "shifts.csv",
    column("temperature [degC]", [10, 20, 30]),
    column("log10 a_T", [1.0, 0.0, -1.0]),
)
SPECTRUM_FILE = table(
    "spectrum.csv",
    column("q [1/m]", np.logspace(3, 5, 9)),
    column("C [m^4]", 1e-4 * np.logspace(3, 5, 9) ** -3.6),
)
INNER = [1.0]
INNER.append(INNER)

# A call that works, with the least that it needs.
CALLS = {
    "Prony": (em.Prony, {"equilibrium": 1e6, "moduli": [1e6], "times": [1.0]}),
    "KelvinVoigt": (em.KelvinVoigt, {"modulus": 1e6, "viscosity": 1e3}),
    "Maxwell": (em.Maxwell, {"modulus": 1e6, "time": 1.0}),
    "StandardSolid": (
        em.StandardSolid,
        {"equilibrium": 1e6, "modulus": 1e6, "time": 1.0},
    ),
    "TabulatedModulus": (
        em.TabulatedModulus,
        {"omega": OMEGA, "storage": MODULUS.real, "loss": MODULUS.imag},
    ),
    "Foundation": (em.Foundation, {"equilibrium": 1e6, "moduli": [1e6], "times": [1]}),
    "Softening": (
        em.Softening,
        {"strain": [0.01, 0.1], "storage": [1, 0.5], "loss": [1, 0.6]},
    ),
    "WLF": (em.WLF, {"c1": 8.86, "c2": 101.6, "reference": 293.15}),
    "Arrhenius": (em.Arrhenius, {"energy": 1e5, "reference": 293.15}),
    "VFT": (em.VFT, {"b": 1000.0, "t0": 200.0, "reference": 293.15}),
    "ShiftTable": (
        em.ShiftTable,
        {"temperature": [280.0, 293.15, 300.0], "log10_a": [1.0, 0.0, -1.0]},
    ),
    "EntropicVertical": (em.EntropicVertical, {"reference": 293.15}),
    "VerticalTable": (
        em.VerticalTable,
        {"temperature": [280.0, 293.15, 300.0], "factor": [0.9, 1.0, 1.1]},
    ),
    "Sphere": (em.Sphere, {"radius": 1e-3}),
    "Paraboloid": (em.Paraboloid, {"radius": 1e-3}),
    "Cone": (em.Cone, {"slope": 0.1}),
    "FlatPunch": (em.FlatPunch, {"radius": 1e-3}),
    "PowerLaw": (em.PowerLaw, {"exponent": 2.0, "coefficient": 1.0}),
    "Cylinder": (em.Cylinder, {"radius": 1e-3, "length": 1e-2}),
    "Profile": (em.Profile, {"r": X, "z": X**2}),
    "RoughLine": (em.RoughLine, {"x": X, "height": LINE.height}),
    "SelfAffine": (
        em.SelfAffine,
        {"hurst": 0.8, "rms_slope": 0.3, "q_low": 1e3, "q_high": 1e5},
    ),
    "Spectrum": (
        em.Spectrum,
        {"q": [1e3, 1e4], "c": [1e-15, 1e-19], "convention": "2d"},
    ),
    "half_space": (em.half_space, {"material": SOLID}),
    "layer": (em.layer, {"material": SOLID, "thickness": 1e-2}),
    "springs": (em.springs, {"material": SOLID, "thickness": 1e-2, "bonded": False}),
    "Mount": (em.Mount, {"mass": 1.0}),
    "Idlers": (em.Idlers, {"cover": COVER, "roll": ROLLER, "spacing": 1.0}),
    "Heat": (em.Heat, {"conductivity": 0.2, "heat_capacity": 2e6}),
    "Adhesion": (em.Adhesion, {"work": 0.05, "cutoff": 1e-7}),
    "AdhesiveShear": (
        em.AdhesiveShear,
        {"stress": 1e5, "velocity": 0.01, "width": 0.3},
    ),
    "Averaged": (em.Averaged, {}),
    "Line": (em.Line, {}),
    "Persson": (em.Persson, {}),
    "HalfSpace": (em.HalfSpace, {}),
    "EffectiveMedium": (em.EffectiveMedium, {}),
    "FrictionLaw": (em.FrictionLaw, {"velocity": V, "mu": [0.3, 0.4]}),
    "friction": (
        em.friction,
        {"material": SOLID, "shape": SPHERE, "velocity": V, "load": 1.0},
    ),
    "friction of a road": (
        em.friction,
        {"material": SOLID, "shape": ROAD, "velocity": V, "pressure": 1e5},
    ),
    "rolling": (
        em.rolling,
        {"material": SOLID, "shape": SPHERE, "velocity": V, "load": 1.0},
    ),
    "plan": (
        em.plan,
        {"material": SOLID, "shape": SPHERE, "velocity": V, "load": 1.0},
    ),
    "dissipation": (
        em.dissipation,
        {"material": COVER, "shape": ROLLER, "velocity": V, "load": 100.0},
    ),
    "heat_build_up": (
        em.heat_build_up,
        {
            "material": COVER,
            "shape": ROLLER,
            "velocity": 1.0,
            "load": 100.0,
            "ambient": 293.15,
            "conductance": 1.0,
            "hottest": 373.0,
        },
    ),
    "conveyor": (
        em.conveyor,
        {"carry": IDLERS, "back": IDLERS, "velocity": V, "belt": 20.0, "goods": 100.0},
    ),
    "stability": (
        em.stability,
        {
            "mount": em.Mount(1.0, 1e4),
            "velocity": [0.1, 0.2, 0.4],
            "force": [1.0, 0.9, 0.7],
            "wavelength": 1e-2,
        },
    ),
    "traction": (
        em.traction,
        {
            "material": COVER,
            "shape": ROLLER,
            "velocity": 1.0,
            "creepage": [0.001, 0.1],
            "friction": 0.5,
            "load": 100.0,
            "tangential": em.Foundation(1e6, [1e6], [1e-2]),
        },
    ),
    "indent": (
        em.indent,
        {"material": SOLID, "shape": SPHERE, "time": TIME, "depth": 1e-3 * TIME},
    ),
    "impact": (
        em.impact,
        {"material": SOLID, "shape": SPHERE, "mass": 1e-3, "velocity": 0.1},
    ),
    "slide": (
        em.slide,
        {
            "material": SOLID,
            "shape": SPHERE,
            "time": TIME,
            "position": 0.1 * TIME,
            "load": 1.0,
            "rtol": 0.1,
            "elements": 16,
        },
    ),
    "shear": (
        em.shear,
        {
            "material": SOLID,
            "shape": SPHERE,
            "time": TIME,
            "displacement": 1e-4 * TIME,
            "friction": 0.5,
            "load": 1.0,
            "elements": 8,
            "steps": 8,
        },
    ),
    "press": (em.press, {"material": SOLID, "surface": ROAD, "pressure": 1e5}),
    "leak": (
        em.leak,
        {
            "material": SOLID,
            "surface": ROAD,
            "pressure": 3e5,
            "pressure_drop": 1e4,
            "viscosity": 1e-3,
            "length": 1e-3,
        },
    ),
    "break_out": (
        em.break_out,
        {"material": SOLID, "surface": ROAD, "pressure": 1e5, "boundary_shear": 1e5},
    ),
    "o_ring": (
        em.o_ring,
        {"material": SOLID, "diameter": 5e-3, "squeeze": 0.15},
    ),
    "lubricated": (
        em.lubricated,
        {
            "material": em.layer(SOLID, 5e-3),
            "shape": ROLLER,
            "velocity": 0.1,
            "load": 100.0,
            "viscosity": 0.1,
        },
    ),
    "reciprocating": (
        em.reciprocating,
        {
            "profile": (
                np.linspace(0, 1e-3, 33),
                1e6 * np.sin(np.linspace(0, np.pi, 33)) ** 2,
            ),
            "velocity_out": 0.1,
            "velocity_in": 0.1,
            "stroke": 0.1,
            "viscosity": 0.1,
        },
    ),
    "cite": (em.cite, {"result": CURVE}),
    "load_friction": (em.load_friction, {"path": LAW}),
    "load_material": (em.load_material, {"name_or_path": "epdm-70"}),
    "save_material": (
        em.save_material,
        {"material": SOLID, "path": FOLDER / "solid.toml"},
    ),
    "read_dma": (em.read_dma, {"path_or_paths": DMA_FILE}),
    "read_friction": (em.read_friction, {"path": FRICTION_FILE}),
    "read_shifts": (em.read_shifts, {"path": SHIFT_FILE}),
    "read_spectrum": (
        em.read_spectrum,
        {"path": SPECTRUM_FILE, "convention": "2d", "wave_number": "2 pi/lambda"},
    ),
    "read_surface": (
        em.read_surface,
        {
            "path_or_heights": 1e-6 * np.random.default_rng(1).normal(size=(16, 16)),
            "pixel_size": 1e-6,
        },
    ),
    "sweep": (
        em.sweep,
        {
            "call": em.friction,
            "axes": {"velocity": V},
            "store": FOLDER / "s.zarr",
            "progress": False,
            "material": SOLID,
            "shape": SPHERE,
            "load": 1.0,
        },
    ),
    "fit.dma": (
        em.fit.dma,
        {
            "omega": OMEGA,
            "storage": MODULUS.real,
            "loss": MODULUS.imag,
            "temperature": np.full(25, 293.15),
            "kind": "shear",
        },
    ),
    "fit.relaxation": (
        em.fit.relaxation,
        {
            "time": OMEGA,
            "modulus": SOLID.relaxation(OMEGA),
            "temperature": np.full(25, 293.15),
            "kind": "shear",
        },
    ),
    "fit.from_hardness": (em.fit.from_hardness, {"shore_a": 60.0}),
    "fit.softening": (
        em.fit.softening,
        {
            "strain_sweep": {
                "strain": np.logspace(-4, 0, 9),
                "storage": 1e6 / (1 + np.logspace(-4, 0, 9)),
                "loss": 1e5 / (1 + np.logspace(-4, 0, 9)),
            }
        },
    ),
    "fit.join": (em.fit.join, {"parts": DMA}),
    "fit.master_curve": (em.fit.master_curve, {"dma": DMA, "reference": 290.0}),
    "fit.prony": (
        em.fit.prony,
        {"omega": OMEGA, "storage": MODULUS.real, "loss": MODULUS.imag, "terms": 3},
    ),
    "fit.abaqus_card": (em.fit.abaqus_card, {"material": SOLID}),
    "fit.ansys_card": (em.fit.ansys_card, {"material": SOLID}),
    "fit.comsol_card": (em.fit.comsol_card, {"material": SOLID}),
    "fit.dyna_card": (em.fit.dyna_card, {"material": SOLID}),
    "fit.plain_card": (em.fit.plain_card, {"material": SOLID}),
    "fit.radioss_card": (em.fit.radioss_card, {"material": SOLID}),
    "fit.friction_master": (
        em.fit.friction_master,
        {
            "velocity": np.tile([1e-3, 1e-2, 1e-1, 1.0], 2),
            "temperature": np.repeat([283.15, 293.15], 4),
            "mu": [0.2, 0.4, 0.7, 1.0, 0.1, 0.2, 0.4, 0.7],
        },
    ),
    "reference.full_contact_sliding": (
        em.reference.full_contact_sliding,
        {"material": SOLID, "line": LINE, "velocity": V, "load": 10.0},
    ),
    "reference.half_plane_sliding": (
        em.reference.half_plane_sliding,
        {
            "material": SOLID,
            "radius": 1e-2,
            "velocity": 0.1,
            "load_per_length": 10.0,
            "points": 64,
        },
    ),
    "reference.half_space_sliding": (
        em.reference.half_space_sliding,
        {
            "material": SOLID,
            "shape": SPHERE,
            "velocity": 0.1,
            "load": 1.0,
            "points": 16,
        },
    ),
    "reference.layer_sliding": (
        em.reference.layer_sliding,
        {
            "material": em.layer(SOLID, 5e-3),
            "shape": SPHERE,
            "velocity": 0.1,
            "load": 1.0,
            "points": 16,
        },
    ),
    "reference.rough_map": (
        em.reference.rough_map,
        {
            "spectrum": em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e4),
            "points": 160,
        },
    ),
}

HOSTILE = {
    "None": None,
    "True": True,
    "0": 0,
    "-1": -1,
    "2.5": 2.5,
    "10**18": 10**18,
    "10**400": 10**400,
    "nan": np.nan,
    "inf": np.inf,
    "1e308": 1e308,
    "5e-324": 5e-324,
    "1j": 1j,
    "no": "no",
    "an empty text": "",
    "1 mm": "1 mm",
    "a long text": "a/" * 2500,
    "a zero byte": "a\0b",
    "bytes": b"1",
    "[]": [],
    "[nan]": [np.nan],
    "[1, 'a']": [1.0, "a"],
    "[None]": [None],
    "a ragged list": [[1.0], [1.0, 2.0]],
    "a list in itself": INNER,
    "a matrix": np.ones((3, 3)),
    "an empty array": np.ones((2, 0)),
    "flags": np.array([True, False]),
    "objects": np.array([None, "a"], dtype=object),
    "dates": np.array(["2020-01-01"], dtype="datetime64[D]"),
    "{}": {},
    "{'a': 1}": {"a": 1},
    "a set": {1.0},
    "a function": lambda *given, **named: given,
    "a class": em.Prony,
    "an object": object(),
    "a material": SOLID,
    "a body": SPHERE,
    "a road": ROAD,
    "a result": CURVE,
    "a generator": (i for i in range(3)),
}
_SECONDS = 60


def arguments(call, given):
    """All that a call takes by name, those of its `**properties` included."""
    names = dict(given)
    for name, parameter in inspect.signature(call).parameters.items():
        if parameter.kind not in (parameter.VAR_KEYWORD, parameter.VAR_POSITIONAL):
            names.setdefault(name, parameter.default)
    return names


def flags(call):
    return {
        name
        for name, parameter in inspect.signature(call).parameters.items()
        if isinstance(parameter.default, bool)
    }


def cases():
    return [
        (name, argument, value)
        for name, (call, given) in CALLS.items()
        for argument in arguments(call, given)
        for value in HOSTILE
        if (argument, value) != ("load", "10**18") or name[:9] != "reference"  # minutes
    ]


class TooLong(BaseException):
    """Of a call that takes longer than anybody waits."""


def too_long(*_):
    raise TooLong


def outcome(name, argument, value):
    """What is wrong with what a call does; an empty text where nothing is."""
    call, given = CALLS[name]
    if argument == "progress" and callable(HOSTILE[value]):
        return ""  # what it does is its own
    named = dict(given) | {argument: HOSTILE[value]}
    places = [named.pop("parts")] if "parts" in named else []
    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(_SECONDS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)
            result = call(*places, **named)
    except em.InputError:
        return ""
    except TooLong:
        return f"more than {_SECONDS} s"
    except BaseException as error:
        return f"{type(error).__name__}: {error}"[:300]
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
    if argument in flags(call) and not isinstance(HOSTILE[value], (bool, np.bool_)):
        return f"took {value} for a flag"
    converged = getattr(result, "converged", None)
    if not isinstance(converged, np.ndarray) or not hasattr(result, "mu"):
        return ""
    # a body without a load has no coefficient
    is_known = np.isfinite(result.mu) | ~converged | (value == "0")
    return "" if is_known.all() else "converged to what is not finite"


# what is asked for, and not asked; warnings; whose arguments others take
OTHERS = {
    "fit",
    "reference",
    "InputError",
    "ConvergenceWarning",
    "ExtrapolationWarning",
}
OTHERS |= {
    "ModelWarning",
    "FitWarning",
    "progress",
    "materials",
    "CriticalConstriction",
}
OTHERS |= {
    "elements",
    "Marched",
    "Multiscale",
    "MeasuredFriction",
    "FrictionCurve",
    "RollingCurve",
    "Plan",
}
OTHERS |= {
    "Doubt",
    "Layer",
    "FilmProfile",
    "Calibration",
    "AdhesionFit",
    "PronyFit",
    "Dma",
}
OTHERS |= {"FrictionMaster", "MaterialFit", "MasterCurve", "SofteningFit"}
# take seconds and more
OTHERS |= {"drive", "calibrate", "adhesion", "material", "friction_spectrum"}


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Names of files are hostile values, too."""
    monkeypatch.chdir(tmp_path)


def test_every_public_call_is_here():
    called = {name.split(" ")[0].rpartition(".")[2] for name in CALLS}
    names = {*em.__all__, *em.fit.__all__, *em.reference.__all__} - OTHERS - called
    unknown = [
        name
        for name in sorted(names)
        if name[0] != "_" and not is_result(getattr(em, name, None))
    ]
    assert not unknown


def is_result(thing):
    return isinstance(thing, type) and issubclass(thing, Result)


@pytest.mark.parametrize("name", CALLS)
def test_hostile_values(name):
    """Each argument with three of the values."""
    mine = [case for case in cases() if case[0] == name]
    chosen = random.Random(name).sample(mine, min(len(mine), 30))
    wrong = {case: said for case in chosen if (said := outcome(*case))}
    assert not wrong


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_every_hostile_value(name):
    wrong = {
        case: said for case in cases() if case[0] == name if (said := outcome(*case))
    }
    assert not wrong
