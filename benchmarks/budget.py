"""What does each call and each scene take? One table for all of them.

    python benchmarks/budget.py [--only WORD]

Each row is a process of its own, with no cache of compiled code: processor seconds from
its start to its first number, of the same call again, of a curve of 64 velocities (of
histories: their one call) and of a derivative's second evaluation by velocity or load;
how many modules it had loaded by its first number, and the peak of its memory. The
first row is `import elastomdr` alone. A scene is its command, table and figure included.

Asked: 1 s for a first number, 0.3 s for a curve, 2 s for a history, 5 s for what
iterates over temperatures or maps, and for a scene. What takes more stands in the table
with its reason, and must keep what it took. `python benchmarks/check.py --only budget`
compares with the record that is committed: no time may grow by half. Processor time
doubles where all cores are busy, so that each is the least of two processes, or of
three calls; a record and its check need the same quiet all the same.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, NamedTuple

from common import RESULTS, heading, save, table, verdict

ROOT = Path(__file__).parents[1]
SCENE_FILES = sorted((ROOT / "examples" / "scenes").glob("*.toml"))
FIRST, CURVE, HISTORY, ITERATES = 1.0, 0.3, 2.0, 5.0

SETUP = """
import sys, tempfile, time
from operator import attrgetter
from pathlib import Path
import numpy as np
import elastomdr as em
{made}
def call(x):
    return {call}
"""
# What calls are made of; a row makes what it names.
MADE = {
    "rubber": "em.Prony(1e6, np.geomspace(1e8, 1e6, 16), np.logspace(-7, 2, 16), "
    "poisson=0.49, shift=em.WLF(8.86, 101.6, 293.15))",
    "road": "em.SelfAffine(0.8, rms_slope=0.5, q_low=1e3, q_high=1e6)",
    "ball": "em.Sphere(5e-3)",
    "parabola": "em.Paraboloid(5e-3)",
    "cone": "em.Cone(0.1)",
    "power": "em.PowerLaw(1.5, 1.0)",
    "r": "np.linspace(0.0, 4e-3, 30)",
    "profile": "em.Profile(r, r**2 / 8e-3 + 0.02 * r)",
    "roller": "em.Cylinder(0.05, 0.5)",
    "layer": "em.layer(rubber, 5e-3)",
    "springs": "em.springs(rubber, 5e-3, bonded=False)",
    "bonded": "em.springs(rubber, 5e-3)",
    "sheared": "em.springs(rubber, 5e-3, tangential=True)",
    "idlers": "em.Idlers(layer, roller, spacing=1.0, shares=[0.2, 0.6, 0.2])",
    "place": "np.linspace(0.0, 1e-3, 101)",
    "shear": "em.AdhesiveShear(5e6, 5e-3, 0.1)",
    "heat": "em.Heat(0.25, 2e6)",
    "t": "np.linspace(0.0, 0.1, 51)",
    "data": f"Path({str(ROOT / 'examples' / 'data')!r})",
    "isotherms": "em.read_dma(data / 'dma.csv')",
    "pulled": "lambda x: attrgetter('velocity', 'temperature', 'mu')"
    "(em.read_friction(data / x))",
    "heights": "1e-7 * np.random.default_rng(0).normal(size=(256, 256))",
    "scan": "np.cumsum(heights, axis=0) + np.cumsum(heights, axis=1)",
}
MEASURE = """
def spent(x):
    times = []
    while sum(times) < (1.0 if len(times) < 3 else 0.1):
        start = time.process_time()
        call(x)
        times.append(time.process_time() - start)
    return min(times)
one, many = {one}, {many}
call(one)
out = dict(first=time.process_time(), modules=len(sys.modules))
out.update(warm=spent(one), curve=spent(many))
if {traced}:
    import jax
    jax.config.update("jax_enable_x64", True)
    slope = jax.grad(lambda x: call(x).{field})
    slope(one)
    start = time.process_time()
    slope(one)
    out["gradient"] = time.process_time() - start
"""
# The peak of a process on Linux is its own by VmHWM, while ru_maxrss begins with that
# of its parent.
ENDED = """
import json, pathlib, re, resource
status = pathlib.Path("/proc/self/status")
if status.exists():
    peak = int(re.search(r"VmHWM:\\s+(\\d+)", status.read_text())[1])
else:
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
print(json.dumps({**out, "memory": peak / 1024}))
"""


class Case(NamedTuple):
    """A call of x, one velocity or many; what its first number and its curve may take
    [s], and why where that is more than asked.
    """

    name: str
    call: str
    field: str = "mu"
    curve: float = CURVE
    one: str = "0.1"
    many: str = "np.logspace(-5, 1, 64)"
    traced: bool = True
    first: float = FIRST
    why: str = ""


MATERIALS = {"half-space": "rubber", "springs": "springs", "layer": "layer"}
SLIDERS = ("ball", "parabola", "cone", "power", "profile", "roller")
ROLLERS = ("ball", "parabola", "roller")
TEMPERATURES = "iterates over temperatures"
# The least that a call may take warm, one point or a curve [s]
FLOORS = {
    "friction: parabola on half-space, warm": 0.3e-3,
    "friction: cone on half-space, warm": 3e-3,
    "friction: parabola on half-space, curve": 2e-3,
}
# What takes more than asked: first number and curve [s], and why.
_STRIPS = "24 strips and more across the contact"
_POINTS = "a profile of 30 points: panels between all of them"
_LINES = "160 lines of the layer to 1e-6, of degree 14 to 56"
_BESSEL = "Bessel functions of 8,200 waves, once"
_COMPILED = "compiled once on a machine"
_CALLS = "one point: 1,500 calls of Python, half of them checks, plan and result"
ALLOWED: dict[str, tuple[float, float, str]] = {
    "friction: power on half-space": (1.0, 0.5, "no polynomial: panels to the apex"),
    "friction: profile on half-space": (1.5, 0.5, _POINTS),
    "friction: cone on springs": (1.0, 1.0, _STRIPS),
    "friction: power on springs": (1.0, 1.0, _STRIPS),
    "friction: profile on springs": (1.5, 5.0, f"{_POINTS}, 16 strips"),
    **{
        f"{verb}: {shape} on layer": (2.0, 1.0, _LINES)
        for verb, shapes in (("friction", SLIDERS[:-1]), ("rolling", ROLLERS[:-1]))
        for shape in shapes
    },
    "dissipation: roller on half-space": (1.5, CURVE, _BESSEL),
    "dissipation: roller on layer": (1.5, 0.5, _BESSEL),
    "dissipation: cone on springs": (1.0, 2.0, f"losses by branch, {_STRIPS}"),
    "conveyor": (1.0, 0.5, "two sides, three rolls"),
    "heat_build_up: ball on layer": (5.0, 5.0, f"{TEMPERATURES}; {_LINES}"),
    "friction: a road, adhesion and heat": (2.0, 2.0, "temperatures by scale"),
    "friction: a road as lines": (3.0, 5.0, f"lines of 65536 samples, {_COMPILED}"),
    "press: a road": (2.0, 2.0, "gaps by contact share, integrals over waves"),
    "lubricated": (1.0, 2.0, "films of 64 velocities by Newton's method"),
    "drive": (3.0, 3.0, "steps halved until mu settles"),
    "drive: roller on springs": (3.0, 3.0, "steps halved until mu settles"),
    "slide": (2.0, 2.0, "steps halved until mu settles"),
    "slide: ball on springs": (5.0, 3.0, "50,000 elements in strips, compiled"),
    **{
        name: (3.0, 3.0, "16 steps of 2,000 elements between two instants, twice")
        for name in ("shear", "shear: ball on springs")
    },
    "friction: parabola on half-space": (FIRST, CURVE, _CALLS),
    "friction: cone on half-space": (FIRST, CURVE, f"{_CALLS}, and a search of edges"),
    "sweep": (HISTORY, HISTORY, "loads xarray, zarr and dask, 950 modules"),
    "read_surface: a profile": (1.5, CURVE, "loads SciPy's interpolation and ndimage"),
    "scene seal_drive": (8.0, 8.0, "30,000 steps of 1,000 elements, compiled for 3 s"),
}


def _steady(verb: str, field: str, shapes: tuple[str, ...]) -> list[Case]:
    """A verb with every body on every foundation that it takes."""
    cases = []
    for place, material in MATERIALS.items():
        for shape in shapes:
            name = f"{verb}: {shape} on {place}"
            call = f"em.{verb}({material}, {shape}, velocity=x, load=1.0)"
            # Derivatives of the others go the same ways; those of balls on a layer
            # compile for 15 s.
            traced = shape == "roller" or (
                place != "layer" and shape in ("ball", "cone")
            )
            cases.append(Case(name, call, field, traced=traced))
    return cases


# Histories and traction: call, field, one x, many of it, and the other foundations that
# the verb takes, with what stands in place of the ball and besides.
MOTIONS = {
    "indent": (
        "em.indent({rubber}, {ball}, time=t, load=x * t{more})",
        ("depth.sum()", "100.0", "100.0"),
        {"springs": ("ball", ""), "layer": ("ball", "")},
    ),
    "impact": (
        "em.impact({rubber}, {ball}, mass=1e-3, velocity=x{more})",
        ("restitution", "1.0", "np.geomspace(0.1, 3.0, 8)"),
        {"springs": ("ball", ""), "layer": ("ball", "")},
    ),
    "slide": (
        "em.slide({rubber}, {ball}, time=t, position=x * t, load=1.0{more})",
        ("mu", "0.01", "0.01"),
        {"springs": ("ball", "")},
    ),
    "drive": (
        "em.drive({rubber}, {ball}, time=t, position=x * t, load=1.0, "
        "tangential=em.Mount(mass=0.1, stiffness=1e4, damping=1.0){more})",
        ("mu", "0.01", "0.01"),
        {"springs": ("roller", "")},
    ),
    "shear": (
        "em.shear({rubber}, {ball}, time=t, load=1.0, friction=0.5, "
        "displacement=x * np.sin(60 * t){more})",
        ("mu", "2e-5", "2e-5"),
        {"springs": ("ball", ", tangential=sheared")},
    ),
    "traction": (
        "em.traction({rubber}, {ball}, velocity=1.0, creepage=x, friction=0.8, "
        "load=5.0{more})",
        ("mu", "0.02", "np.geomspace(1e-3, 0.1, 16)"),
        {"springs": ("roller", ", tangential=sheared"), "layer": ("roller", "")},
    ),
}


def _motions() -> list[Case]:
    """Each verb of `MOTIONS` with a ball on a half-space, and on what else it takes."""
    cases = []
    for verb, (call, (field, one, many), others) in MOTIONS.items():
        for place, (body, more) in {"": ("ball", ""), **others}.items():
            material = place or "rubber"
            # rubber that slips on its base is not sheared
            material = "bonded" if more else material
            cases.append(
                Case(
                    f"{verb}: {body} on {place}" if place else verb,
                    call.format(rubber=material, ball=body, more=more),
                    field,
                    curve=HISTORY,
                    one=one,
                    many=many,
                    traced=verb == "indent" and not place,
                )
            )
    return cases


CASES = (
    Case(
        "indent: two presses, 51 depths",
        "em.indent(rubber, ball, time=t, depth=x * np.sin(120 * t) ** 2)",
        "force.sum()",
        curve=HISTORY,
        one="1e-4",
        many="1e-4",
        traced=False,
    ),
    *_steady("friction", "mu", SLIDERS),
    *_steady("rolling", "coefficient", ROLLERS),
    *(
        case._replace(traced=False)
        for case in _steady("dissipation", "mu", ("ball", "cone", "roller"))
        if not case.name.endswith(("ball on layer", "cone on layer"))
    ),
    Case(
        "heat_build_up: ball on half-space",
        "em.heat_build_up(rubber, ball, velocity=x, load=1.0, ambient=293.15, "
        "conductance=1e-3, hottest=400.0)",
        "temperature",
        curve=ITERATES,
        many="np.logspace(-2, 0, 8)",
        traced=False,
        why=TEMPERATURES,
    ),
    Case(
        "heat_build_up: roller on layer, history",
        "em.heat_build_up(layer, roller, velocity=x, load=200.0, ambient=293.15, "
        "conductance=0.1, hottest=400.0, capacity=100.0, time=np.linspace(0, 5e3, 51))",
        "temperature",
        curve=ITERATES,
        many="np.logspace(-2, 0, 8)",
        traced=False,
        why=TEMPERATURES,
    ),
    Case(
        "heat_build_up: ball on layer",
        "em.heat_build_up(layer, ball, velocity=x, load=1.0, ambient=293.15, "
        "conductance=1e-3, hottest=400.0)",
        "temperature",
        curve=ITERATES,
        many="1.0",
        traced=False,
        first=ITERATES,
        why=TEMPERATURES,
    ),
    Case(
        "conveyor",
        "em.conveyor(idlers, idlers, velocity=x, belt=20.0, goods=100.0)",
        "resistance",
        many="np.linspace(1.0, 8.0, 64)",
        traced=False,
    ),
    Case(
        "friction_spectrum: a road",
        "em.friction_spectrum(rubber, road.ended(1e5), velocity=x, pressure=3e5)",
        many="0.1",
        curve=ITERATES,
        first=ITERATES,
        traced=False,
        why="lines of 16384 points and more",
    ),
    Case(
        "o_ring",
        "em.o_ring(rubber, 5e-3, x)",
        "pressure",
        one="0.1",
        many="np.linspace(0.05, 0.25, 64)",
    ),
    Case(
        "break_out",
        "em.break_out(rubber, road, pressure=x, boundary_shear=5e6, time=1.0)",
        one="3e5",
        many="np.geomspace(1e4, 1e6, 64)",
        traced=False,
    ),
    Case(
        "reciprocating",
        "em.reciprocating(profile=(place, 1e12 * place * (1e-3 - place)), "
        "velocity_out=x, velocity_in=0.1, stroke=0.1, viscosity=0.1)",
        "net_leak",
        many="np.logspace(-3, 0, 64)",
        traced=False,
    ),
    Case(
        "stability",
        "em.stability(em.Mount(1.0, 1e3), velocity=np.linspace(0.1, 1.0, 64), "
        "force=np.exp(-np.linspace(0.1, 1.0, 64)) + x, wavelength=1e-3)",
        "slope",
        many="0.1",
        traced=False,
    ),
    Case(
        "plan",
        "em.plan(rubber, ball, velocity=x, load=1.0)",
        traced=False,
    ),
    Case("friction: a road", "em.friction(rubber, road, velocity=x, pressure=3e5)"),
    Case(
        "friction: a road, adhesion and heat",
        "em.friction(rubber, road, velocity=x, pressure=3e5, temperature=293.15, "
        "heat=heat, adhesion=shear)",
        curve=ITERATES,
        traced=False,
        why="iterates over temperatures by scale; its derivative compiles for minutes",
    ),
    Case(
        "friction: a road as lines",
        'em.friction(rubber, road.ended(1e5), velocity=x, pressure=3e5, model="line")',
        curve=ITERATES,
        traced=False,
        why="lines of 16384 points and more",
    ),
    Case(
        "press: a road",
        "em.press(rubber, road, pressure=x, time=1.0)",
        "separation",
        one="3e5",
        many="np.geomspace(1e4, 1e6, 64)",
    ),
    Case(
        "leak",
        "em.leak(rubber, road, pressure=x, pressure_drop=1e4, viscosity=1e-3, "
        "length=1e-3)",
        "rate",
        one="3e5",
        many="np.geomspace(1e5, 1e6, 64)",
    ),
    Case(
        "lubricated",
        "em.lubricated(rubber, em.Cylinder(0.01, 1.0), velocity=x, load=100.0, "
        "viscosity=0.1)",
        curve=HISTORY,
        traced=False,
    ),
    *_motions(),
    Case(
        "sweep",
        "em.sweep(em.friction, {'velocity': np.geomspace(1e-3, 1.0, x)}, "
        "store=tempfile.mkdtemp() + '/runs', progress=False, material=rubber, "
        "shape=ball, load=1.0)",
        one="1",
        many="64",
        curve=HISTORY,
        traced=False,
    ),
)


READERS = (
    Case(
        "read_dma",
        "em.read_dma(data / x, kind='tensile')",
        one="'dma.csv'",
        many="'dma-q800.txt'",
    ),
    Case(
        "read_surface: a profile",
        "em.read_surface(data / x)",
        one="'profile.csv'",
        many="'profile.csv'",
    ),
    Case(
        "read_surface: a map of 256 by 256",
        "em.read_surface(scan, pixel_size=x)",
        one="1e-6",
        many="1e-6",
        curve=ITERATES,
        why="a map: spectra by direction and by part",
    ),
    Case(
        "read_spectrum",
        "em.read_spectrum(data / x, convention='2d')",
        one="'road.csv'",
        many="'road.csv'",
    ),
    Case("load_material", "em.load_material(x)", one="'epdm-70'", many="'epdm-70'"),
    Case("materials", "em.materials()", many="0.1"),
    Case(
        "fit.material: isotherms",
        "em.fit.material(isotherms, x)",
        one="293.15",
        many="293.15",
        curve=HISTORY,
        why="shifts, series and intervals of 9 isotherms",
    ),
    Case(
        "fit.friction_master",
        "em.fit.friction_master(*pulled(x))",
        one="'friction.csv'",
        many="'friction.csv'",
        curve=HISTORY,
    ),
)
CASES += tuple(case._replace(traced=False) for case in READERS)


def _made(code: str) -> str:
    """The assignments that some code needs, in their order."""
    lines: list[str] = []
    for name, value in reversed(MADE.items()):
        needed = re.search(rf"(?<![.\w]){name}(?![=\w])", "\n".join([code, *lines]))
        lines = [f"{name} = {value}", *lines] if needed else lines
    return "\n".join(lines)


def measured(case: Case) -> dict[str, Any]:
    """What a process of its own says of a call."""
    code = SETUP.replace("{call}", case.call).replace("{made}", _made(case.call))
    measure = MEASURE
    for key in ("one", "many", "field", "traced"):
        measure = measure.replace(f"{{{key}}}", str(getattr(case, key)))
    return _least(code + measure + ENDED)


def scene(verb: str, path: Path) -> dict[str, Any]:
    """What the command of a scene takes."""
    with tempfile.TemporaryDirectory() as place:
        code = (
            "import time\n"
            "from elastomdr.cli.main import main\n"
            f"main([{verb!r}, {str(path)!r}, '--out', {place!r}])\n"
            "out = dict(first=time.process_time())\n"
        )
        return _least(code + ENDED)


def _least(code: str) -> dict[str, Any]:
    """What two processes say, the smaller of each number."""
    one, two = _said(code), _said(code)
    return {key: min(one[key], two[key]) for key in one}


def _said(code: str) -> dict[str, Any]:
    """The last line that a process prints, which has no cache of compiled code."""
    with tempfile.TemporaryDirectory() as cache:
        environment = os.environ | {"XDG_CACHE_HOME": cache}
        ended = subprocess.run(
            [sys.executable, "-W", "ignore", "-c", code],
            capture_output=True,
            text=True,
            env=environment,
            check=False,
        )
    if ended.returncode:
        raise RuntimeError(ended.stderr[-2000:])
    return json.loads(ended.stdout.strip().split("\n")[-1])


def _weight() -> tuple[Any, ...]:
    """The row of `import elastomdr` alone."""
    code = (
        "import sys, time\nimport elastomdr\n"
        "out = dict(first=time.process_time(), modules=len(sys.modules))\n"
    )
    row, nothing = _least(code + ENDED), float("nan")
    numbers = row["first"], nothing, nothing, nothing, row["modules"], row["memory"]
    return ("import elastomdr", *numbers, "")


CALLS = (
    "call",
    "first [s]",
    "warm [s]",
    "curve [s]",
    "gradient [s]",
    "modules",
    "MiB",
    "why",
)
SCENES = "scene", "command", "processor [s]", "MiB", "why"


def _calls(only: str, record: dict[str, Any]) -> list[Any]:
    """Rows of the calls with a word in their name."""
    rows = [] if only else [_weight()]
    for case in CASES:
        if only not in case.name:
            continue
        first, curve, why = ALLOWED.get(case.name, (case.first, case.curve, case.why))
        try:
            row = measured(case)
        except RuntimeError as error:
            if not case.traced:
                raise
            print(f"  no derivative of {case.name}: {str(error)[-200:]}")
            row, why = measured(case._replace(traced=False)), f"{why}; no derivative"
        keys = ("first", "warm", "curve", "gradient", "modules", "memory")
        rows.append((case.name, *(row.get(key, float("nan")) for key in keys), why))
        first = max(first, HISTORY) if case.curve == HISTORY else first
        limits = {"first": first, "curve": curve, "gradient": curve}
        verdicts = _verdicts(case.name, row, limits)
        kept = [dict(zip(CALLS, row, strict=True)) for row in rows]
        _keep(record, calls=kept, verdicts=verdicts)
    return rows


def _verdicts(
    name: str, row: dict[str, float], limits: dict[str, float]
) -> list[dict[str, Any]]:
    """Each time of a row beside its limit, that of `FLOORS` where there is one."""
    verdicts = []
    for key in ("first", "warm", "curve", "gradient"):
        label = f"{name}, {key}"
        limit = FLOORS.get(label, limits.get(key))
        if limit is not None and key in row:
            verdicts.append(verdict(label, row[key], limit, unit=" s"))
    return verdicts


def _scenes(only: str, record: dict[str, Any]) -> list[Any]:
    """Rows of the shipped scenes; of a sweep the user chooses the size."""
    rows = []
    for path in SCENE_FILES:
        command = re.search(r"elastomdr (\w+)", path.read_text(encoding="utf-8"))
        if only not in path.stem or command is None or command[1] == "sweep":
            continue
        row = scene(command[1], path)
        name = f"scene {path.stem}"
        allowed, _, why = ALLOWED.get(name, (ITERATES, ITERATES, ""))
        rows.append((path.stem, command[1], row["first"], row["memory"], why))
        verdicts = [verdict(name, row["first"], allowed, unit=" s")]
        kept = [dict(zip(SCENES, row, strict=True)) for row in rows]
        _keep(record, scenes=kept, verdicts=verdicts)
    return rows


def _keep(record: dict[str, Any], **rows: list[dict[str, Any]]) -> None:
    """Writes rows into the record in the place of those of the same name: a run that is
    stopped leaves what it has measured.
    """
    path = RESULTS / "budget.json"
    kept = json.loads(path.read_text()) if path.exists() else {}
    names = {"calls": "call", "scenes": "scene", "verdicts": "name"}
    known = {"import elastomdr", *(case.name for case in CASES)}
    known |= {path.stem for path in SCENE_FILES}
    for key, name in names.items():
        together = (*kept.get(key, ()), *rows.get(key, ()))
        kept[key] = list({row[name]: row for row in together}.values())
        kept[key] = [row for row in kept[key] if _named(row[name]) in known]
    save("budget", {**record, **kept})


def _named(verdict: str) -> str:
    """The row that a verdict belongs to."""
    return re.sub(r"^scene |, (first|warm|curve|gradient)$", "", verdict)


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    options.add_argument("--only", default="", help="rows with this word alone, anew")
    only = options.parse_args().only
    record = heading("A budget for every call and every scene", "processor seconds")
    calls = _calls(only, record)
    if calls:
        table(CALLS, calls)
    scenes = _scenes(only, record)
    if scenes:
        table(SCENES, scenes)


if __name__ == "__main__":
    main()
