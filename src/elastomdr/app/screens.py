"""What the screens compute: kinds of scenes, their fields, and what is filled in at first."""

import copy
from typing import Any, NamedTuple

from ..cli.schema import Content
from ..cli.seals import (
    BreakOutScene,
    LeakScene,
    LubricatedScene,
    RingScene,
    StrokeScene,
)
from ..cli.steady import (
    ConveyorScene,
    RollingScene,
    SurfaceComparison,
    SurfaceFrictionScene,
    WarmingScene,
    WheelTraction,
)
from .scene import COMPUTED


class Kind(NamedTuple):
    """A kind of scene."""

    verb: str  # of the command
    table: Any
    label: str = ""  # where a screen has several kinds
    only: tuple[str, ...] = ()  # keys that have fields; all where empty
    first: tuple[str, ...] = ()  # fields that are not put away under "More"
    about: str = ""


class Screen(NamedTuple):
    """How a screen differs from the others; its kinds by the names of their scenes."""

    key: str
    lead: str
    button: str
    kinds: dict[str, Kind]
    docs: str  # the page of the docs


_FIRST = (
    "temperature",
    "[contact] pressure",
    "[contact] velocity",
    "measured",
    "heat",
    "adhesion",
    "[heat] preset",
    "[heat] conductivity",
    "[heat] heat_capacity",
    "[heat.road] preset",
    "[heat.road] conductivity",
    "[heat.road] heat_capacity",
    "[adhesion] preset",
    "[adhesion] stress",
    "[adhesion] velocity",
    "[adhesion] width",
)
_ROLLING = (
    "temperature",
    "layer",
    "[contact] load",
    "[contact] velocity",
    "[contact] slip",
    "[layer] thickness",
    "[layer] bonded",
    "[structure] stiffness",
    "[conveyor] shares",
)
_RING = (
    "temperature",
    "[o_ring] time",
    "[o_ring] fluid_pressure",
    "[o_ring] groove_width",
    "[stroke] width",
)
FRICTION = Screen(
    "friction",
    "The chosen rubber on the road of the road screen.",
    "Compute friction",
    {
        "friction": Kind(
            "friction",
            SurfaceFrictionScene,
            only=tuple(
                key
                for key in SurfaceFrictionScene.__struct_fields__
                if key not in ("surface", "title", "other", "layer", "roller", "doubts")
            ),
            first=_FIRST,
        )
    },
    "rough",
)
COMPARE = Screen(
    "compare",
    "Several rubbers under the conditions of the friction screen.",
    "Compare rubbers",
    {
        "compare": Kind(
            "compare",
            SurfaceComparison,
            only=("material", "temperature", "compare"),
            first=(*_FIRST, "[compare] velocity", "[compare] temperature"),
        )
    },
    "accuracy",
)
ROLLING = Screen(
    "rolling",
    "A cover under a roll, a wheel, a belt.",
    "Compute",
    {
        "rolling": Kind("rolling", RollingScene, "Rolling resistance", first=_ROLLING),
        "heat_build_up": Kind(
            "rolling", WarmingScene, "Temperature of a wheel", first=_ROLLING
        ),
        "conveyor": Kind(
            "rolling", ConveyorScene, "Power of a belt conveyor", first=_ROLLING
        ),
    },
    "belt",
)
TYRE = Screen(
    "tyre",
    "A tyre that brakes: its slip curve, and the Magic Formula through it.",
    "Compute the slip curve",
    {
        "traction": Kind(
            "traction",
            WheelTraction,
            first=_ROLLING,
            about="Friction on the road of the road screen is that of this rubber, "
            "with "
            "heat and adhesion of the friction screen, where the wheel needs it. "
            "Otherwise it is a number or a table.",
        )
    },
    "tyre",
)
SEAL = Screen(
    "seal",
    "A seal at rest, or on a rod that moves.",
    "Compute",
    {
        "seal": Kind(
            "leak",
            LeakScene,
            "Leak of a static seal",
            only=(
                "material",
                "temperature",
                "surface",
                "leak",
                "o_ring",
                "uncertainty",
            ),
            first=(
                "temperature",
                "[surface] longest",
                "[surface] shortest",
                "[surface] rms_height",
                "[leak] pressure",
                "[leak] viscosity",
                "[leak] length",
                "[leak] width",
                "[leak] time",
            ),
            about="Of a liquid, or of a gas where an outlet pressure is given. Pressed "
            "evenly, by a profile from a dropped file, or by an O-ring.",
        ),
        "o_ring": Kind(
            "o_ring",
            RingScene,
            "Sealing force of an O-ring over years",
            only=("material", "temperature", "o_ring"),
            first=_RING,
            about="Of the relaxation of the rubber; ageing and compression set are not "
            "in it.",
        ),
        "stroke": Kind(
            "reciprocating",
            StrokeScene,
            "Leak of an O-ring on a moving rod",
            only=("material", "temperature", "o_ring", "stroke"),
            first=_RING,
            about="The rod carries a film out and, while it moves in, most of it back.",
        ),
        "lubricated": Kind(
            "lubricated",
            LubricatedScene,
            "Film and friction of a lubricated seal",
            only=("material", "temperature", "indenter", "surface", "lubricated"),
            first=("temperature", "[lubricated] boundary_shear", "[lubricated] time"),
            about="Over velocity this is the Stribeck curve.",
        ),
        "break_out": Kind(
            "break_out",
            BreakOutScene,
            "Start of a dry seal after a rest",
            only=("material", "temperature", "surface", "break_out"),
            first=(
                "temperature",
                "[surface] longest",
                "[surface] shortest",
                "[surface] rms_slope",
                "[break_out] time",
            ),
            about="A bound from above: all of the real contact lets go at once.",
        ),
    },
    "seal",
)


def preset(key: str, rubber: str | list[str]) -> Content:
    """What the form of a kind shows at first; `rubber` is that of the friction screen,
    taken where it was fitted or dropped on the page.
    """
    rubber = rubber[0] if isinstance(rubber, list) else rubber
    scene, suited = _PRESETS[key]
    taken = rubber.endswith(".toml") or key == "traction"
    return {"material": rubber if taken else suited, **copy.deepcopy(scene)}


_ROLL = {"shape": "cylinder", "radius": "79.5 mm", "length": "400 mm"}
_GROUND = {"shape": "self_affine", "hurst": 0.8}
_O_RING = {"diameter": "5 mm", "squeeze": 0.2}
# by kind, with the rubber of the library that suits it
_PRESETS: dict[str, tuple[Content, str]] = {
    "rolling": (
        {
            "temperature": ["0 degC", "20 degC", "40 degC"],
            "indenter": _ROLL,
            "layer": {"thickness": "6 mm"},
            "contact": {
                "load": ["0.3 kN", "1 kN"],
                "velocity": {"from": "0.5 m/s", "to": "10 m/s", "points": 16},
            },
        },
        "epdm-70",
    ),
    "heat_build_up": (
        {
            "indenter": {"shape": "cylinder", "radius": "100 mm", "length": "50 mm"},
            "layer": {"thickness": "15 mm"},
            "contact": {"load": "800 N", "velocity": ["1 m/s", "2 m/s", "4 m/s"]},
            "heat_build_up": {"ambient": "-10 degC", "conductance": "1.2 W/K"},
        },
        "tread-passenger-synthetic",
    ),
    "conveyor": (
        {
            "temperature": "10 degC",
            "indenter": _ROLL,
            "layer": {"thickness": "6 mm"},
            "contact": {"velocity": {"from": "0.5 m/s", "to": "5 m/s", "points": 10}},
            "conveyor": {
                "spacing": "1.2 m",
                "shares": [0.2, 0.6, 0.2],
                "belt": "28 kg/m",
                "goods": "120 kg/m",
                "return_spacing": "3 m",
            },
        },
        "epdm-70",
    ),
    "traction": (
        {
            "temperature": "20 degC",
            "friction": COMPUTED,
            "indenter": {"shape": "cylinder", "radius": "300 mm", "length": "160 mm"},
            "structure": {"stiffness": "80 MPa/m"},
            "layer": {"thickness": "8 mm"},
            "contact": {
                "load": ["2 kN", "4 kN", "6 kN"],
                "velocity": "10 m/s",
                "slip": {"from": 0.001, "to": 0.9, "points": 40},
            },
        },
        "",
    ),
    "seal": (  # an O-ring on a turned face, oil at 2 bar
        {
            "temperature": "20 degC",
            "surface": _GROUND
            | {"rms_height": "3 um", "longest": "200 um", "shortest": "4 um"},
            "leak": {
                "pressure": ["0.25 MPa", "0.3 MPa", "0.4 MPa"],
                "pressure_drop": "0.2 MPa",
                "viscosity": "50 mPa*s",
                "length": "1 mm",
                "width": "160 mm",
                "time": ["1 min", "1 h", "1 day", "30 days", "1 year", "10 years"],
            },
        },
        "epdm-70",
    ),
    "o_ring": (
        {
            "temperature": ["-5 degC", "20 degC", "50 degC"],
            "o_ring": _O_RING
            | {
                "time": {"from": "1 min", "to": "10 years", "points": 24},
                "fluid_pressure": "2 MPa",
                "groove_width": "7 mm",
            },
        },
        "epdm-70",
    ),
    "stroke": (
        {
            "temperature": "20 degC",
            "o_ring": _O_RING | {"time": "5 min", "fluid_pressure": "2 MPa"},
            "stroke": {
                "velocity_out": {"from": "50 mm/s", "to": "1 m/s", "points": 16},
                "velocity_in": "0.1 m/s",
                "length": "100 mm",
                "viscosity": "50 mPa*s",
                "width": "160 mm",
            },
        },
        "epdm-70",
    ),
    "lubricated": (  # a rib on a ground rod
        {
            "temperature": "20 degC",
            "indenter": {"shape": "cylinder", "radius": "5 mm", "length": "160 mm"},
            "surface": _GROUND
            | {"rms_height": "0.3 um", "longest": "60 um", "shortest": "0.6 um"},
            "lubricated": {
                "velocity": {"from": "1e-5 m/s", "to": "1 m/s", "points": 24},
                "load": "160 N",
                "viscosity": "50 mPa*s",
                "boundary_shear": "0.2 MPa",
                "time": "5 min",
            },
        },
        "epdm-70",
    ),
    "break_out": (  # the rod of example 35
        {
            "temperature": ["0 degC", "20 degC"],
            "surface": _GROUND
            | {"rms_slope": 0.3, "longest": "100 um", "shortest": "4 um"},
            "break_out": {
                "pressure": "0.35 MPa",
                "boundary_shear": "0.2 MPa",
                "time": {"from": "1 s", "to": "10 days", "points": 24},
            },
        },
        "epdm-70",
    ),
}
