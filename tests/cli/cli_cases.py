"""A good scene and a good material, and what to change in them to make each kind of bad
input.
"""

from pathlib import Path
from typing import Any

from elastomdr.cli.kinds import read_scene


def arguments(verb: str, name: str) -> dict[str, Any]:
    """What the scene of a command is computed with."""
    return read_scene(verb, Path(name)).arguments(Path(name).parent)


SCENE = """
title = "Slider"
material = "rubber.toml"
temperature = "20 degC"

[indenter]
shape = "paraboloid"
radius = "5 mm"

[contact]
model = "line"
load = "10 N"
velocity = { from = "1e-3 m/s", to = "1e3 mm/s", points = 4 }

[numerics]
rtol = 1e-4
"""
MATERIAL = """
kind = "shear"
poisson = 0.5
equilibrium = 1e6
moduli = [2e6, 1e6]
times = [1e-3, 1e-2]
[shift]
law = "WLF"
c1 = 8.86
c2 = 101.6
reference = 293.15
"""

# What is wrong: (what to replace, with what), what the message must say.
BAD_SCENES = {
    "model of a surface": (
        ('"line"', '"persson"'),
        'model must be "averaged", "line", "marched" or "half-space" for a paraboloid, '
        'got "persson"',
    ),
    "unknown key": (('title = "Slider"', 'titel = "Slider"'), "Did you mean 'title'"),
    "unknown table": (("[numerics]", "[numeric]"), "Did you mean 'numerics'"),
    "unknown key in a table": (("load =", "laod ="), "Did you mean 'load'"),
    "unknown key in velocity": (("points", "point"), "Did you mean 'points'"),
    "temperature below a table": (
        ("load =", 'temperature = "20 degC"\nload ='),
        "It stands at the top of the file",
    ),
    "key of a table at the top": (
        ('title = "Slider"', 'velocity = "1 m/s"'),
        "It stands in [contact]",
    ),
    "key of another shape": (
        ('radius = "5 mm"', 'radius = "5 mm"\nlength = "1 m"'),
        "[indenter] length must be a key that is known",
    ),
    "unknown shape": (('"paraboloid"', '"parabolid"'), "Did you mean 'paraboloid'"),
    "unknown model": (('"line"', '"lines"'), "Did you mean 'line'"),
    "option of another model": (
        ('"line"', '"line"\ngamma = 0.5'),
        'gamma must be left out, or beside model = "persson"',
    ),
    "option without a model": (
        ('model = "line"', "corrected = false"),
        'corrected must be left out, or beside model = "averaged"',
    ),
    "average of a smooth body": (
        ('"line"', '"line"\naverage = true'),
        '"averaged" with corrected = false',
    ),
    "a model of surfaces": (
        ('"line"', '"multiscale"'),
        'for a paraboloid, got "multiscale"',
    ),
    "unknown unit": (('"5 mm"', '"5 milimetre"'), "milimetre"),
    "no unit": (('"5 mm"', '"5"'), "5 mm"),
    "bare number": (('"5 mm"', "0.005"), "5 mm"),
    "wrong dimension": (('"10 N"', '"10 kg"'), "a force"),
    "coulomb for Celsius": (('"20 degC"', '"20 C"'), "20 degC"),
    "a difference of temperatures": (('"20 degC"', '"20 delta_degC"'), "20 degC"),
    "not a number": (('"10 N"', '"ten N"'), "ten N"),
    "NaN": (('"10 N"', '"nan N"'), "nan N"),
    "overflow": (('"10 N"', '"1e400 N"'), "finite"),
    "a decimal comma": (('"5 mm"', '"0,5 mm"'), "radius"),
    "an expression": (('"10 N"', '"10 N*((("'), "load"),
    "negative radius": (('"5 mm"', '"-5 mm"'), "radius must be positive"),
    "negative load": (('"10 N"', '"-10 N"'), "load must be positive"),
    "zero velocity": (
        ('"1e-3 m/s"', '"0 m/s"'),
        "[contact] velocity: from must be positive",
    ),
    "negative velocity": (('"1e-3 m/s"', '"-1 m/s"'), "must be positive"),
    "velocities the wrong way round": (
        ('"1e3 mm/s"', '"1e-4 m/s"'),
        "velocity: from must be above zero and below to",
    ),
    "one point": (("points = 4", "points = 1"), "points"),
    "half a point": (("points = 4", "points = 4.5"), "points"),
    "too many points": (("points = 4", "points = 100000000"), "points"),
    "below absolute zero": (('"20 degC"', '"-300 degC"'), "absolute zero"),
    "below the WLF pole": (('"20 degC"', '"-90 degC"'), "pole"),
    "no temperatures": (('"20 degC"', "[]"), "temperature must be"),
    "one bad temperature of two": (
        ('"20 degC"', '["20 degC", "20"]'),
        "temperature[1]",
    ),
    "no shift law": (('"rubber.toml"', '"no-shift.toml"'), "shift law"),
    "load and depth": (
        ('load = "10 N"', 'load = "10 N"\ndepth = "1 mm"'),
        "depth must be left out where load is given",
    ),
    "neither load nor depth": (
        ('load = "10 N"', ""),
        "load must be given, or depth",
    ),
    "no material": (('material = "rubber.toml"', ""), "material must be"),
    "no indenter": (
        ('[indenter]\nshape = "paraboloid"\nradius = "5 mm"', ""),
        "[indenter] must be",
    ),
    "no shape": (('shape = "paraboloid"', ""), "shape must be"),
    "no radius": (('radius = "5 mm"', ""), "radius must be"),
    "no velocity": (
        ('velocity = { from = "1e-3 m/s", to = "1e3 mm/s", points = 4 }', ""),
        "velocity must be",
    ),
    "a table that is none": (
        ("[numerics]\nrtol = 1e-4", "[numerics]\nrtol = { a = 1 }"),
        "rtol",
    ),
    "a text for a table": (
        (SCENE, 'material = "rubber.toml"\nindenter = "sphere"\ncontact = 3'),
        '[indenter] must be a table with the key shape, got "sphere"',
    ),
    "unknown material": (
        ('"rubber.toml"', '"rubber"'),
        "material must be in the library",
    ),
    "material file not there": (
        ('"rubber.toml"', '"ruber.toml"'),
        "Did you mean 'rubber.toml'",
    ),
    "material is a number": (('"rubber.toml"', "5"), "material must be a text"),
    "rtol too small": (("rtol = 1e-4", "rtol = 1e-15"), "rtol"),
    "rtol as text": (("rtol = 1e-4", 'rtol = "1e-4"'), "rtol"),
    "rtol NaN": (("rtol = 1e-4", "rtol = nan"), "rtol"),
    "a flat punch": (('"paraboloid"', '"flat_punch"'), "edge"),
    "springs of a bonded incompressible layer": (
        ("[contact]", '[layer]\nthickness = "8 mm"\nsprings = true\n[contact]'),
        "bonded springs",
    ),
    "layer without thickness": (
        ("[contact]", "[layer]\nbonded = false\n[contact]"),
        "thickness must be",
    ),
    "bonded as text": (
        ("[contact]", '[layer]\nthickness = "8 mm"\nbonded = "no"\n[contact]'),
        "true or false",
    ),
    "two bodies and a layer": (
        (
            "temperature",
            'other = "rubber.toml"\nlayer = { thickness = "1 mm" }\ntemperature',
        ),
        "other must be left out beside [layer]",
    ),
    "a cone without slope": (
        ('shape = "paraboloid"\nradius = "5 mm"', 'shape = "cone"'),
        "slope must be",
    ),
    "a falling cone": (
        ('shape = "paraboloid"\nradius = "5 mm"', 'shape = "cone"\nslope = -1'),
        "slope must be a positive number, got -1",
    ),
    "a coefficient of another dimension": (
        (
            'shape = "paraboloid"\nradius = "5 mm"',
            'shape = "power_law"\nexponent = 3\ncoefficient = "5 mm"',
        ),
        "m^-2",
    ),
    "a profile without a unit": (
        (
            'shape = "paraboloid"\nradius = "5 mm"',
            'shape = "profile"\nr = [0, 1]\nz = [0, 1]',
        ),
        "unit must be",
    ),
    "too short a profile": (
        (
            'shape = "paraboloid"\nradius = "5 mm"',
            'shape = "profile"\nunit = "mm"\nr = [0, 1]\nz = [0, 1]',
        ),
        "4 entries",
    ),
    "not TOML": (("[contact]", "[contact"), "valid TOML"),
    "a key twice": (('title = "Slider"', 'title = "a"\ntitle = "b"'), "valid TOML"),
    "nested too deeply": (('"Slider"', "[" * 5000), "valid TOML"),
    "a title of nothing": (('"Slider"', '" "'), "title must be a text"),
    "a zero character": (('"Slider"', '"a\\u0000b"'), "title must be a text"),
    "empty": ((SCENE, ""), "missing"),
}

BAD_MATERIALS = {
    "negative times": (("times = [1e-3", "times = [-1e-3"), "times must be positive"),
    "NaN moduli": (("moduli = [2e6", "moduli = [nan"), "moduli"),
    "infinite moduli": (("moduli = [2e6", "moduli = [inf"), "moduli"),
    "negative moduli": (("moduli = [2e6", "moduli = [-2e6"), "moduli"),
    "lists of different length": (("[1e-3, 1e-2]", "[1e-3]"), "times must be as long"),
    "Poisson's ratio too large": (("poisson = 0.5", "poisson = 0.6"), "poisson"),
    "Poisson's ratio too small": (("poisson = 0.5", "poisson = -1"), "poisson"),
    "poisson and bulk": (
        ("poisson = 0.5", "poisson = 0.5\nbulk = 2e9"),
        "bulk must be left out",
    ),
    "unknown kind": (('"shear"', '"sheer"'), "kind"),
    "unknown key": (("equilibrium", "equilibrum"), "Did you mean 'equilibrium'"),
    "not TOML": (("[shift]", "[shift"), "valid TOML"),
}

INDENT = """
title = "Pressed"
material = "rubber.toml"
temperature = "20 degC"

[indenter]
shape = "paraboloid"
radius = "5 mm"

[history]
program = "triangle"
depth = "0.1 mm"
duration = "2 ms"
points = 9

[numerics]
rtol = 1e-4
"""

_TRIANGLE = 'program = "triangle"\ndepth = "0.1 mm"\nduration = "2 ms"\npoints = 9'
BAD_INDENTS = {
    "unknown key": (("duration", "duraton"), "Did you mean 'duration'"),
    "unknown program": (('"triangle"', '"triangel"'), "Did you mean 'triangle'"),
    "key of another program": (
        ("points = 9", 'frequency = "1 Hz"'),
        "[history] frequency must be a key that is known",
    ),
    "no history": ((f"[history]\n{_TRIANGLE}", ""), "[history] must be"),
    "depth and load": (
        ("points = 9", 'load = "1 N"'),
        "depth must be left out where load is given",
    ),
    "neither": (('depth = "0.1 mm"', ""), "load must be given, or depth"),
    "time without a unit": (('"2 ms"', '"2"'), "with its unit"),
    "a depth that is a force": (('"0.1 mm"', '"1 N"'), "must be a length"),
    "lists of different length": (
        (_TRIANGLE, 'time = ["0 s", "1 s"]\ndepth = ["0 mm", "1 mm", "0 mm"]'),
        "as long as",
    ),
    "descending times": (
        (_TRIANGLE, 'time = ["1 s", "0 s"]\ndepth = ["0 mm", "1 mm"]'),
        "ascending",
    ),
    "a load that pulls": (
        (_TRIANGLE, 'time = ["0 s", "1 s"]\nload = ["0 N", "-1 N"]'),
        "needs adhesion",
    ),
    "one point": (("points = 9", "points = 1"), "from 2 to"),
    "adhesion of another kind": (
        ('temperature = "20 degC"', 'adhesion = "1 N"'),
        "energy per area",
    ),
}

SLIDE = """
title = "Started"
material = "rubber.toml"
temperature = "20 degC"

[indenter]
shape = "paraboloid"
radius = "5 mm"

[[stage]]
duration = "2 ms"
load = "2 N"

[[stage]]
velocity = "500 mm/s"
way = "4 mm"

[[stage]]
velocity = "-500 mm/s"
duration = "2 ms"
load = "1 N"

[numerics]
rtol = 5e-2
points = 8
"""

BAD_SLIDES = {
    "no stage": (
        (SLIDE[SLIDE.index("[[stage]]") : SLIDE.index("[numerics]")], ""),
        "[[stage]] must be",
    ),
    "one bracket": (
        (
            SLIDE[SLIDE.index("[[stage]]") : SLIDE.index("[numerics]")],
            "[stage]\nload = '1 N'\n",
        ),
        "two brackets",
    ),
    "unknown key": (('way = "4 mm"', 'wey = "4 mm"'), "Did you mean 'way'"),
    "way without velocity": (
        ('velocity = "500 mm/s"\n', ""),
        "[stage 2] velocity must be given",
    ),
    "way and duration": (
        ('way = "4 mm"', 'way = "4 mm"\nduration = "1 s"'),
        "[stage 2] duration must be left out",
    ),
    "no load at first": (
        ('load = "2 N"', ""),
        "[stage 1] must be given one of load, depth",
    ),
    "a load, then a depth": (
        ('load = "1 N"', 'depth = "1 mm"'),
        "[stage 3] must be given load, as the stages before",
    ),
    "no duration": (
        ('duration = "2 ms"\nload = "2 N"', 'load = "2 N"'),
        "duration must be",
    ),
    "a load that pulls": (
        ('load = "1 N"', 'load = "-1 N"'),
        "load must be zero or positive",
    ),
    "velocity without a unit": (('"500 mm/s"', '"500"'), "with its unit"),
}
