"""Are wrong signs, factors and units noticed? Each mutation changes one place in a copy of the source.

    python benchmarks/robustness/mutations.py               # all, some 10 minutes on one core
    python benchmarks/robustness/mutations.py brush units   # those whose file or name contains one of these words;
                                                            # the record keeps the others

A mutation is caught where its tests fail. The tests named are those nearest to it: what they let pass, another test of
the suite may still catch, but a reader of them cannot rely on that.
"""

import argparse
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import common

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "elastomdr"
LIMIT = 120.0  # of the tests of one mutation [s]; where a search never ends, that is noticed too


class Mutation(NamedTuple):
    """One wrong place."""

    what: str
    file: str  # below src/elastomdr
    old: str  # stands there exactly once
    new: str
    tests: str  # arguments of pytest, below tests/; what stands behind " -k " selects


MUTATIONS = [
    # --- material
    Mutation(
        "sign of the dashpot in the complex modulus", "material/relaxation.py",
        "loss + omega * law.viscosity", "loss - omega * law.viscosity", "test_materials.py",
    ),
    Mutation(
        "dashpot dropped from the flow of a liquid", "material/relaxation.py",
        "total_viscosity = xp.asarray(law.viscosity) + xp.sum(", "total_viscosity = xp.sum(", "test_materials.py",
    ),
    Mutation(
        "flow dropped from the dashpot of a series", "material/relaxation.py",
        "rate = xp.sum(compliances / times) + fluidity", "rate = xp.sum(compliances / times)", "test_materials.py",
    ),
    Mutation(
        "side of the pole from which a retardation time is sought", "material/secular.py",
        "too_near = side * value > 0", "too_near = value > 0", "test_materials.py",
    ),
    Mutation(
        "sign of Newton's step, and with it of all derivatives of retardation times", "material/secular.py",
        "xp.where(finite, origin + distance + step, xp.inf)", "xp.where(finite, origin + distance - step, xp.inf)",
        "test_materials.py",
    ),
    Mutation(
        "sign in the denominator of WLF", "material/shift.py",
        "return -self.c1 * above / (self.c2 + above)", "return -self.c1 * above / (self.c2 - above)",
        "test_materials.py",
    ),
    Mutation(
        "c1 at another reference temperature", "material/shift.py",
        "WLF(self.c1 * self.c2 / c2, c2, temperature)", "WLF(self.c1, c2, temperature)", "test_materials.py",
    ),
    Mutation(
        "Arrhenius' law upside down", "material/shift.py",
        "(1 / temperature - 1 / self.reference) / _LN10", "(1 / self.reference - 1 / temperature) / _LN10",
        "test_materials.py -k 'arrhenius or shift'",
    ),
    Mutation(
        "factor of two between tensile and shear tables", "material/tabulated.py",
        'self._as("tensile", 2 * (1 + self.poisson))', 'self._as("tensile", 1 * (1 + self.poisson))',
        "test_tabulated.py -k kinds",
    ),
    Mutation(
        "a table shifted the wrong way by temperature", "material/tabulated.py",
        "omega=self.omega / factor", "omega=self.omega * factor", "test_tabulated.py -k temperature",
    ),
    # --- mapping
    Mutation(
        "factor of two in G* at a constant Poisson's ratio", "mapping/radok.py",
        "scaled(shear, 4 / (2 - material.poisson))", "scaled(shear, 2 / (2 - material.poisson))", "test_materials.py",
    ),
    Mutation(
        "factor of two in E* at a constant bulk modulus", "mapping/radok.py",
        "spring(9 * bulk / 4)", "spring(9 * bulk / 2)", "test_materials.py",
    ),
    Mutation(
        "factor of two in a bonded layer", "mapping/radok.py",
        "2 * (1 - material.poisson) / (1 - 2 * material.poisson)",
        "(1 - material.poisson) / (1 - 2 * material.poisson)",
        "test_materials.py",
    ),
    Mutation(
        'sign of the cutoff term for convention="1d"', "mapping/spectrum.py",
        "c += cut[-1] / (np.pi", "c -= cut[-1] / (np.pi", "test_surfaces.py -k spectrum",
    ),
    Mutation(
        "factor of two between one-sided and two-sided cuts", "mapping/spectrum.py",
        '(0.5 if "one-sided" in convention else 1.0)', "1.0", "test_surfaces.py -k spectrum",
    ),
    Mutation(
        "2 pi between wave numbers and spatial frequencies", "mapping/spectrum.py",
        '/ (2 * np.pi if "/2pi" in convention else 1.0)', '/ (np.pi if "/2pi" in convention else 1.0)',
        "test_surfaces.py -k spectrum",
    ),
    Mutation(
        '4 pi^2 of convention="2d/4pi^2"', "mapping/spectrum.py",
        "c = c / (4 * np.pi**2)", "c = c / (2 * np.pi) ** 3", "test_surfaces.py -k spectrum",
    ),
    Mutation(
        "power 4 for 3 in the rms slope", "mapping/spectrum.py",
        "(2 * np.pi * self.moment(3)) ** 0.5", "(2 * np.pi * self.moment(4)) ** 0.5", "test_surfaces.py -k spectrum",
    ),
    Mutation(
        "term dropped from the line of a profile", "mapping/profile.py",
        "c * (3 * k2 - 4 * knots * k1 + knots**2 * k0)", "c * (3 * k2 - 4 * knots * k1)",
        "test_steady.py -k given_as_points",
    ),
    # --- foundation
    Mutation(
        "factor of two in phi2", "foundation/decay.py",
        "xp.where(y < 1, 0.5 * series,", "xp.where(y < 1, series,", "test_contact_step.py",
    ),
    Mutation(
        "< for <= where an element recovers freely", "foundation/step.py",
        "free = ~contact & (state.q <= 0)", "free = ~contact & (state.q < 0)", "test_contact_step.py",
    ),
    Mutation(
        "factor of two in the loss of a strike", "foundation/step.py",
        "moduli * (half - 0.5 * mean**2)", "moduli * (half - mean**2)", "test_contact_step.py test_element.py",
    ),
    Mutation(
        "normal factor for a tangential table", "foundation/law.py",
        "factor = 4 / (2 - nu) if tangential else 2 / (1 - nu)",
        "factor = 2 / (2 - nu) if tangential else 2 / (1 - nu)",
        "test_tabulated.py -k 'kinds or foundation'",
    ),
    Mutation(
        "factor of two in the stiffness of a layer", "foundation/law.py",
        "layer_operator(own, bonded), 1 / thickness)", "layer_operator(own, bonded), 2 / thickness)",
        "test_materials.py",
    ),
    # --- solve
    Mutation(
        "term dropped from the work of a panel", "solve/memory.py",
        "work=m.work + m.far * panel.ahead + panel.work", "work=m.work + panel.work", "test_steady.py test_energy.py",
    ),
    Mutation(
        "sign in the moment of a panel", "solve/memory.py",
        "(mean / 2 - c[1] / 6)", "(mean / 2 + c[1] / 6)", "test_steady.py",
    ),
    Mutation(
        "equilibrium spring's share of friction, factor of two", "solve/integrals.py",
        "return 0.5 * self._springs() * self.rise() ** 2", "return self._springs() * self.rise() ** 2",
        "test_steady.py",
    ),
    Mutation(
        "sign of the dashpot in the exit density", "solve/integrals.py",
        "return density - self.p.velocity * law.viscosity", "return density + self.p.velocity * law.viscosity",
        "test_energy.py test_steady.py",
    ),
    Mutation(
        "estimated error of a passage dropped", "solve/passage.py",
        "(drag_error + xp.abs(mu) * normal_error) / normal",
        "(0 * drag_error + 0 * xp.abs(mu) * normal_error) / normal",
        "test_error.py test_rough_error.py test_steady.py",
    ),
    Mutation(
        "friction over half the load", "solve/passage.py",
        "mu = drag / normal\n", "mu = 2 * drag / normal\n", "test_steady.py",
    ),
    Mutation(
        "power of P in Persson's stress factor", "solve/roads.py",
        "return gamma + (1 - gamma) * shares**2", "return gamma + (1 - gamma) * shares", "test_multiscale.py",
    ),
    Mutation(
        "factor of two in P = erf(1/(2 sqrt G))", "solve/roads.py",
        "erf(0.5 / xp.sqrt(xp.maximum(spread, 1e-300)))", "erf(1.0 / xp.sqrt(xp.maximum(spread, 1e-300)))",
        "test_multiscale.py",
    ),
    Mutation(
        "factor of two in full contact", "solve/multiscale.py",
        "at=at, full=at.weight * at.power * drag / (2 * p)", "at=at, full=at.weight * at.power * drag / p",
        "test_multiscale.py",
    ),
    Mutation(
        "stress of contact edges, factor of two", "solve/multiscale.py",
        "beyond = 4 * p[..., 0] * end", "beyond = 2 * p[..., 0] * end", "test_multiscale.py",
    ),
    Mutation(
        "tangential dashpot's stiffness in the march", "solve/brush.py",
        "xp.sum(gain, axis=1) + tangential.viscosity * r.velocity / h", "xp.sum(gain, axis=1)", "test_traction.py",
    ),
    Mutation(
        "sign of the tangential dashpot in the march", "solve/brush.py",
        "xp.sum(gain, axis=1) + tangential.viscosity * r.velocity / h",
        "xp.sum(gain, axis=1) - tangential.viscosity * r.velocity / h", "test_traction.py",
    ),
    Mutation(
        "tangential dashpot dropped from the integral", "solve/brush.py",
        "* late, axis=0) * distance**2 + dashpot * distance", "* late, axis=0) * distance**2", "test_traction.py",
    ),
    Mutation(
        "factor of two in Carter's contact", "solve/brush.py",
        "half = xp.sqrt(4 * line_load", "half = xp.sqrt(2 * line_load", "test_traction.py",
    ),
    Mutation(
        "factor of two in the momentum of a rebound", "solve/impact.py",
        "speed = node.speed - 0.5 * h * (node.force + force) / body.mass",
        "speed = node.speed - h * (node.force + force) / body.mass", "test_impact.py",
    ),
    Mutation(
        "dashpot dropped from an approach", "solve/impact.py",
        "force = xp.sum(forces, axis=0) + body.viscosity * rate", "force = xp.sum(forces, axis=0)", "test_impact.py",
    ),
    Mutation(
        "factor of two in conduction", "solve/heat.py",
        "return 2 * flux * np.sqrt(time", "return flux * np.sqrt(time", "test_heat.py",
    ),
    Mutation(
        "cold and hot side of a moving source exchanged", "solve/heat.py",
        "np.where(u > 0, ahead, -behind)", "np.where(u > 0, behind, -ahead)", "test_heat.py",
    ),
    Mutation(
        "correction of a map upside down", "solve/maps.py",
        "found.stress / p * full[i] / own", "found.stress / p * own / full[i]", "test_half_space.py",
    ),
    Mutation(
        "a cell with one summit taken for an answer", "solve/maps.py",
        "good = np.isfinite(mu).all(axis=0) & (enough >= 1)", "good = np.isfinite(mu).all(axis=0)",
        "test_half_space.py",
    ),
    Mutation(
        "factor of two in stored energy", "solve/creep.py",
        "_elastic(disc, radius, depth) + 0.5 * squares", "_elastic(disc, radius, depth) + squares",
        "test_indentation.py test_energy.py",
    ),
    Mutation(
        "factor of two in the work of adhesion", "solve/adhesion.py",
        "jnp.sqrt(2 * jnp.pi * a * self.gamma / self.modulus)", "jnp.sqrt(jnp.pi * a * self.gamma / self.modulus)",
        "test_indentation.py",
    ),
    Mutation(
        "break of a contact under a load found as under a depth", "solve/adhesion.py",
        "2 * a * slope - 3 * self.stretch(a)", "2 * a * slope - 2 * self.stretch(a)", "test_indentation.py",
    ),
    Mutation(
        "slip of one sign only", "solve/shear.py",
        "slips = jnp.abs(trial) > limit", "slips = trial > limit", "test_shear.py",
    ),
    Mutation(
        "factor of two in the heat of slip", "solve/shear.py",
        "0.5 * (first + now) * slid", "(first + now) * slid", "test_shear.py",
    ),
    Mutation(
        "factor of two in the tangential momentum of an impact", "solve/oblique.py",
        "speed - 0.5 * h * (force + after) / mass", "speed - h * (force + after) / mass", "test_oblique.py",
    ),
    Mutation(
        "sense of the motion over a map", "solve/half_space.py",
        "value = np.conj(modulus(np.abs(kx) * velocity))", "value = modulus(np.abs(kx) * velocity)",
        "test_half_space.py",
    ),
    Mutation(
        "waves along the motion counted twice", "solve/half_space.py",
        "twice[0] = 1.0", "twice[0] = 2.0", "test_half_space.py",
    ),
    Mutation(
        "time of lumped slow branches upside down", "solve/condense.py",
        "(total / rate)[None]", "(rate / total)[None]", "test_steady.py test_edges.py",
    ),
    Mutation(
        "factor of two in the heights of a synthetic line", "mapping/synthesis.py",
        "share = 2 * np.pi * spectrum.moment(1", "share = np.pi * spectrum.moment(1", "test_surfaces.py -k lines",
    ),
    # --- scenes
    Mutation(
        "weight of the returning belt dropped", "recipes/conveyor.py",
        "weight = (2 * mass + load) * g", "weight = (mass + load) * g", "test_conveyor.py",
    ),
    Mutation(
        "Young's modulus for E* in Hertz' formula of a cord", "recipes/squeezed_cord.py",
        'modulus = young if formula == "lindley" else plane', "modulus = young", "test_squeezed_cord.py",
    ),
    Mutation(
        "relaxation times of a branch shifted the wrong way", "scenes/dissipation.py",
        "time=times * factor", "time=times / factor", "test_dissipation.py",
    ),
    Mutation(
        "moment 2 for 3 in the extrapolation of roads", "scenes/beyond.py",
        "surface.moment(3, low, high) / surface.moment(3)", "surface.moment(2, low, high) / surface.moment(2)",
        "test_extrapolation.py -k 'slope or rough'",
    ),
    Mutation(
        "amplitude for slope in the extrapolation of lines", "scenes/beyond.py",
        "np.square(q * np.abs(", "np.square(np.abs(", "test_extrapolation.py -k 'slope or rough'",
    ),
    Mutation(
        "sign of the slope in the stability of a drive", "recipes/stability.py",
        "ratio = (damping + slope) / root", "ratio = (damping - slope) / root", "test_stability.py",
    ),
    Mutation(
        "factor of two in the moment of a rolling body", "scenes/rolling.py",
        "moment=found.friction_force * radius", "moment=2 * found.friction_force * radius",
        "test_steady.py -k rolling",
    ),
    # --- reference
    Mutation(
        "factor of two in the answer of a loaded cell", "reference/kernel.py",
        "corner(low, near)) / math.pi", "corner(low, near)) / (2 * math.pi)",
        "test_reference.py -k 'hertz or boundary'",
    ),
    Mutation(
        "wake ahead of the indenter", "reference/kernel.py",
        "offsets = (jnp.arange(-(count - 1), count) - lead) * h",
        "offsets = -(jnp.arange(-(count - 1), count) - lead) * h",
        "test_reference.py -k 'hertz or boundary or hunter'",
    ),
    Mutation(
        "sign of friction on the half-space", "reference/contact.py",
        "return -jnp.sum(pressure * spread", "return jnp.sum(pressure * spread",
        "test_reference.py -k 'hertz or boundary or hunter'",
    ),
    Mutation(
        "factor of two in G of the reference", "reference/persson.py",
        "rate = q**4 * c / 8 * stiff", "rate = q**4 * c / 4 * stiff", "test_persson.py",
    ),
    # --- io, cli
    Mutation(
        "Hz taken for rad/s", "io/units.py",
        "turns = 2 * 3.141592653589793 if", "turns = 1.0 if", "test_units.py",
    ),
    Mutation(
        "kg/mm2 taken for kg/cm2", "io/units.py",
        '"kg/mm**2": "kgf/mm**2"', '"kg/mm**2": "kgf/cm**2"', "test_units.py",
    ),
    Mutation(
        "ksi off by ten", "io/units.py",
        '"none": "",', '"none": "", "ksi": "100*psi",', "test_units.py",
    ),
    Mutation(
        "offset of temperatures dropped", "io/units.py",
        "* turns, zero", "* turns, 0.0", "test_units.py",
    ),
    Mutation(
        "natural logarithms read as decadic ones", "io/columns.py",
        '"ln": np.e}', '"ln": 10.0}', "test_read_dma.py -k moduli_in_other_words",
    ),
    Mutation(
        "kPa off by ten on the command line", "cli/units.py",
        '"kPa": "1e3"', '"kPa": "1e4"', "test_units.py",
    ),
    Mutation(
        "degrees Celsius off by 0.15 K on the command line", "cli/units.py",
        'Decimal("273.15")', 'Decimal("273")', "test_units.py",
    ),
    # --- fit
    Mutation(
        "relaxation shifted the wrong way by temperature", "fit/misfit.py",
        "(dma.time / _factor(", "(dma.time * _factor(", "test_tabulated.py -k misfit",
    ),
    Mutation(
        "storage for loss in the misfit", "fit/misfit.py",
        "(moduli / (x + 1 / x)).sum(axis=1) / dma.loss", "(moduli * x / (x + 1 / x)).sum(axis=1) / dma.loss",
        "test_tabulated.py -k misfit",
    ),
    Mutation(
        "c2 measured from the lowest temperature", "fit/laws.py",
        "WLF(c1, room + gap, reference)", "WLF(c1, gap, reference)", "test_fit_master.py",
    ),
    Mutation(
        "loss angle of a power law, factor of two", "fit/level.py",
        "/ np.tan(power * np.pi / 2), end", "/ np.tan(power * np.pi / 4), end",
        "test_fit_prony.py test_fit_relaxation.py",
    ),
    Mutation(
        "storage and loss exchanged for a passive material", "fit/passive.py",
        "np.where(storage, x / (x + 1 / x), 1 / (x + 1 / x))", "np.where(storage, 1 / (x + 1 / x), x / (x + 1 / x))",
        "test_read_dma.py -k swapped",
    ),
    # --- results
    Mutation(
        "width of a band taken twice", "results/spectrum.py",
        "half = 0.5 * np.log(self.width)", "half = np.log(self.width)", "test_bands.py",
    ),
    Mutation(
        "unit in the title of a column", "results/indentation.py",
        'quantity("contact radius", "m",', 'quantity("contact radius", "mm",', "test_results.py",
    ),
    Mutation(
        "work in N", "results/indentation.py",
        'quantity("work", "J",', 'quantity("work", "N",', "test_results.py",
    ),
    Mutation(
        "millimetres on an axis without a factor", "results/base.py",
        "{words[1:]} [{self.shown or self.unit}]", "{words[1:]} [{self.unit}]", "test_figures.py test_results.py",
    ),
]  # fmt: skip


def applied(mutation: Mutation, source: Path) -> None:
    """Changes the place in a copy of the source."""
    path = source / "elastomdr" / mutation.file
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace(mutation.old, mutation.new), encoding="utf-8")


def gone() -> list[str]:
    """Places that the source does not have, or has several times."""
    counts = [(m, (PACKAGE / m.file).read_text(encoding="utf-8").count(m.old)) for m in MUTATIONS]
    return [f"{m.file} has {count} times: {m.old}" for m, count in counts if count != 1]


def tested(source: Path, files: list[str], chosen: str, limit: float | None) -> subprocess.CompletedProcess[str]:
    """Tests of a copy of the source, up to the first that fails."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", *(f"tests/{file}" for file in files)]
    command += ["-k", chosen] if chosen else []
    environment = os.environ | {"PYTHONPATH": str(source)}
    return subprocess.run(
        command, cwd=ROOT, env=environment, capture_output=True, text=True, timeout=limit, check=False
    )


def noticed(mutation: Mutation, folder: Path) -> tuple[bool, str, float]:
    """Whether a test fails, which one, and how long it took [s]."""
    source = folder / "src"
    shutil.copytree(ROOT / "src", source, ignore=shutil.ignore_patterns("__pycache__"))
    applied(mutation, source)
    files, _, chosen = mutation.tests.partition(" -k ")
    begin = time.perf_counter()
    try:
        run = tested(source, files.split(), chosen.strip("'"), LIMIT)
    except subprocess.TimeoutExpired:
        return True, f"no end within {LIMIT:g} s", LIMIT
    took = time.perf_counter() - begin
    if run.returncode not in (0, 1):  # no test was chosen, or none can be imported
        raise SystemExit(f"pytest cannot judge {mutation.what}:\n{run.stdout}{run.stderr}")
    failed = re.search(r"^(?:FAILED|ERROR) tests/(.+?)(?: - |$)", run.stdout, re.MULTILINE)
    return run.returncode != 0, failed[1] if failed else "", took


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", help="only mutations whose file or name contains one of these")
    words = parser.parse_args().words
    if missing := gone():
        raise SystemExit("\n".join(missing))
    chosen = [m for m in MUTATIONS if not words or any(word in f"{m.file} {m.what}" for word in words)]
    record = common.heading("Mutations", f"{len(MUTATIONS)} changes of one place each, the tests nearest to it")
    files = {file for m in chosen for file in m.tests.partition(" -k ")[0].split()}
    run = tested(ROOT / "src", sorted(files), "", None)  # who fails anyway notices nothing
    if run.returncode:
        raise SystemExit(f"tests fail without a mutation:\n{run.stdout}{run.stderr}")
    rows = []
    for mutation in chosen:
        with tempfile.TemporaryDirectory() as folder:
            caught, by, took = noticed(mutation, Path(folder))
        word = "caught" if caught else "SURVIVED"
        print(f"  {word:9} {took:5.0f} s  {mutation.file}: {mutation.what}  {by}", flush=True)
        rows.append((mutation.file, mutation.what, mutation.old, mutation.new, word, by))
    names = ("file", "what", "instead of", "written", "outcome", "by")
    found = {row[:2]: dict(zip(names, row, strict=True)) for row in rows}
    kept = common.RESULTS / "robustness" / "mutations.json"
    before = json.loads(kept.read_text())["mutations"] if words and kept.exists() else []
    found = {(row["file"], row["what"]): row for row in before} | found
    record["mutations"] = [found[m.file, m.what] for m in MUTATIONS if (m.file, m.what) in found]
    survived = sum(row["outcome"] != "caught" for row in record["mutations"])
    record["verdicts"] = [common.verdict("mutations that no test notices", survived, 0)]
    common.save("robustness/mutations", record)
    sys.exit(survived > 0)


if __name__ == "__main__":
    main()
