"""Scenes of the applications at the command line, and mistakes in them with what the
answer must name.
"""

ROUGH_SLIDE = """
title = "Started on a rough line"
material = "rubber.toml"
temperature = "20 degC"

[surface]
shape = "self_affine"
hurst = 0.8
rms_slope = 0.3
longest = "100 um"
shortest = "25 um"
equivalent_length = "full contact"
seed = 2
samples = 64

[[stage]]
duration = "2 ms"
pressure = "0.5 MPa"

[[stage]]
velocity = "50 mm/s"
way = "0.1 mm"

[numerics]
rtol = 5e-2
points = 8
"""

BAD_ROUGH_SLIDES = {
    "seeds": (("seed = 2", "seeds = 2"), "Did you mean 'seed'"),
    "half a seed": (("seed = 2", "seed = 0.5"), "whole number"),
    "too few samples": (("samples = 64", "samples = 2"), "samples must"),
    "a load in newton": (
        ('pressure = "0.5 MPa"', 'load = "2 N"'),
        "a force per length",
    ),
    "a pressure without a unit": (('"0.5 MPa"', "0.5"), "with its unit"),
    "an indenter beside it": (
        ("[surface]", '[indenter]\nshape = "sphere"\nradius = "1 mm"\n[surface]'),
        "[indenter] must be left out of a scene of this kind",
    ),
    "a layer": (
        ("[surface]", '[layer]\nthickness = "1 mm"\n[surface]'),
        "layer must be left out",
    ),
    "then a depth": (
        ('way = "0.1 mm"', 'way = "0.1 mm"\ndepth = "1 um"'),
        "[stage 2] must be given pressure, as the stages before",
    ),
}

IMPACT = """
title = "Bounces"
material = "rubber.toml"
temperature = ["0 degC", "20 degC"]

[indenter]
shape = "sphere"
radius = "5 mm"

[impact]
mass = ["4 g", "8 g"]
velocity = { from = "0.1 m/s", to = "1 m/s", points = 2 }

[numerics]
rtol = 1e-4
"""

BAD_IMPACTS = {
    "unknown key": (("mass =", "mas ="), "Did you mean 'mass'"),
    "no velocity": (
        ('velocity = { from = "0.1 m/s", to = "1 m/s", points = 2 }', ""),
        "[impact] velocity must be",
    ),
    "a weight": (('"4 g"', '"4 N"'), "[impact] mass[0] must be a mass"),
    "a contact": (
        ("[impact]", '[contact]\nload = "1 N"\n[impact]'),
        "[contact] must be left out of a scene",
    ),
}

WARMING = """
title = "Warms up"
material = "rubber.toml"

[indenter]
shape = "cylinder"
radius = "100 mm"
length = "50 mm"

[layer]
thickness = "15 mm"

[contact]
load = "800 N"
velocity = ["1 m/s", "2 m/s"]

[heat_build_up]
ambient = "0 degC"
conductance = "20 W/K"
hottest = "100 degC"

[numerics]
rtol = 1e-3
"""

BAD_WARMINGS = {
    "unknown key": (("ambient", "ambiant"), "Did you mean 'ambient'"),
    "no conductance": (
        ('conductance = "20 W/K"\n', ""),
        "[heat_build_up] conductance must be",
    ),
    "conductance without a unit": (('"20 W/K"', "20"), "with its unit"),
    "a conductivity": (('"20 W/K"', '"20 W/(m*K)"'), "a thermal conductance"),
    "duration alone": (
        ("hottest", 'duration = "1 h"\nhottest'),
        "belong together",
    ),
    "half a point": (
        ("hottest", 'duration = "1 h"\ncapacity = "1 kJ/K"\npoints = 2.5\nhottest'),
        "points",
    ),
    "a temperature": (
        ('title = "Warms up"', 'temperature = "20 degC"'),
        "temperature must be left out",
    ),
    "a depth": (
        ('load = "800 N"', 'depth = "1 mm"'),
        "[contact] depth must be a key that is known",
    ),
    "too hot": (('"0 degC"', '"200 degC"'), "below hottest"),
    "a conveyor beside it": (
        ("[heat_build_up]", '[conveyor]\nspacing = "1 m"\n[heat_build_up]'),
        "[conveyor] must be left out of a scene of this kind",
    ),
    "measured points": (
        ('title = "Warms up"', 'measured = "a.csv"'),
        "measured must be left out of a scene",
    ),
    "no shift law": (('"rubber.toml"', '"no-shift.toml"'), "shift law"),
}

BELT = """
title = "Belt"
material = "rubber.toml"
temperature = ["0 degC", "20 degC"]

[indenter]
shape = "cylinder"
radius = "80 mm"
length = "400 mm"

[layer]
thickness = "6 mm"

[contact]
velocity = ["1 m/s", "5 m/s"]

[conveyor]
spacing = "1.2 m"
shares = [0.2, 0.6, 0.2]
belt = "28 kg/m"
goods = ["0 kg/m", "120 kg/m"]
return_spacing = "3 m"
return_thickness = "8 mm"
"""

BAD_BELTS = {
    "unknown key": (("goods", "gods"), "Did you mean 'goods'"),
    "no belt": (('belt = "28 kg/m"', ""), "[conveyor] belt must be"),
    "a mass": (('"28 kg/m"', '"28 kg"'), "a mass per length"),
    "less than no goods": (
        ('"0 kg/m"', '"-1 kg/m"'),
        "goods[0] must be zero or positive",
    ),
    "shares that are not one": (
        ("0.6", "0.5"),
        "[conveyor] shares must be 1",
    ),
    "shares as a text": (("[0.2, 0.6, 0.2]", '"a fifth"'), "list of numbers"),
    "a load": (
        ("velocity =", 'load = "1 kN"\nvelocity ='),
        "[contact] load must be a key that is known",
    ),
    "no layer": (('[layer]\nthickness = "6 mm"', ""), "[layer]"),
    "a ball": (
        (
            'shape = "cylinder"\nradius = "80 mm"\nlength = "400 mm"',
            'shape = "sphere"\nradius = "1 mm"',
        ),
        "cylinder",
    ),
    "the bare line": (
        ("[contact]", '[contact]\nmodel = "line"'),
        "[contact] model must be a key that is known",
    ),
}

WHEEL = """
title = "Brakes"
material = "rubber.toml"
temperature = ["0 degC", "20 degC"]
friction = "mu.csv"

[indenter]
shape = "cylinder"
radius = "300 mm"
length = "160 mm"

[structure]
stiffness = "80 MPa/m"

[layer]
thickness = "8 mm"

[contact]
load = ["2 kN", "4 kN"]
velocity = "25 m/s"
slip = { from = 0.01, to = 0.9, points = 5 }

[numerics]
rtol = 1e-4
"""

BAD_WHEELS = {
    "unknown key": (("friction =", "fricton ="), "Did you mean 'friction'"),
    "no friction": (('friction = "mu.csv"', ""), "friction must be"),
    "friction below zero": (
        ('friction = "mu.csv"', "friction = -0.1"),
        "friction must be zero or positive",
    ),
    "a table that is not there": (('"mu.csv"', '"nu.csv"'), "nu.csv"),
    "a table that is none": (
        ('"mu.csv"', '"rubber.toml"'),
        "must be a table with one column",
    ),
    "a locked wheel": (("to = 0.9", "to = 1.0"), "below 1"),
    "slip and creepage": (
        ("slip =", "creepage = 0.1\nslip ="),
        "creepage must be left out where slip is given",
    ),
    "neither": (
        ("slip = { from = 0.01, to = 0.9, points = 5 }", ""),
        "slip must be given, or creepage",
    ),
    "no slip at all": (
        ("{ from = 0.01, to = 0.9, points = 5 }", "[]"),
        "slip must be a number, a list",
    ),
    "slip as a text": (
        ("{ from = 0.01, to = 0.9, points = 5 }", '"10 %"'),
        "slip must be a number",
    ),
    "unknown key in slip": (("points", "point"), "Did you mean 'points'"),
    "slip the wrong way round": (
        ("from = 0.01", "from = 0.95"),
        "slip: from must be above zero and below to",
    ),
    "no structure": (
        ('[structure]\nstiffness = "80 MPa/m"', ""),
        "[structure] must be",
    ),
    "a stiffness": (('"80 MPa/m"', '"80 N/m"'), "a stiffness per area"),
    "no load": (('load = ["2 kN", "4 kN"]', ""), "load must be"),
    "a ball on a structure": (
        (
            'shape = "cylinder"\nradius = "300 mm"\nlength = "160 mm"',
            'shape = "sphere"\nradius = "5 mm"',
        ),
        "[structure] must be left out of a scene of this kind",
    ),
    "outside of the table": (
        ('velocity = "25 m/s"', 'velocity = "250 m/s"'),
        "friction must be a law that covers the velocity",
    ),
}

_TABLE = (
    '[drive]\nmass = "1 kg"\nstiffness = "1 kN/m"\nnormal_force = "10 '
    'N"\n\n[[stage]]\nvelocity = "5 mm/s"'
)
DRIVE = ROUGH_SLIDE.replace(
    '[[stage]]\nduration = "2 ms"', _TABLE + '\nduration = "2 ms"'
).replace('[[stage]]\nvelocity = "50 mm/s"\nway = "0.1 mm"\n', "")

BAD_DRIVES = {
    "unknown key": (("stiffness", "stifness"), "Did you mean 'stiffness'"),
    "no mass": (('mass = "1 kg"\n', ""), "[drive] mass must be"),
    "a damping below zero": (
        ("stiffness =", 'damping = "-1 N*s/m"\nstiffness ='),
        "zero or positive and finite",
    ),
    "a mass that is a force": (('"1 kg"', '"1 N"'), "a mass"),
    "no force on the whole body": (
        ('normal_force = "10 N"\n', ""),
        "[drive] normal_force must be",
    ),
    "a depth": (('pressure = "0.5 MPa"', 'depth = "1 um"'), "stages with a load"),
    "no load": (('pressure = "0.5 MPa"', 'pressure = "0 MPa"'), "load above zero"),
    "a jump of the load": (
        ("[numerics]", '[[stage]]\nduration = "1 ms"\npressure = "1 MPa"\n[numerics]'),
        "ascending, without repeats",
    ),
}
