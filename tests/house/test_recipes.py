"""The recipes of CONTRIBUTING.md, applied as they stand there to a copy of the package."""

import ast
import os
import re
import shutil
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import elastomdr as em

ROOT = Path(__file__).parents[2]


class Recipe:
    """A section of CONTRIBUTING.md: its steps, each with a file and the code for it."""

    def __init__(self, title: str):
        text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
        section = text.partition(f"\n## {title}\n")[2].partition("\n## ")[0]
        steps = re.split(r"^\d+\. ", section, flags=re.MULTILINE)[1:]
        self.steps = []
        for step in steps:
            code = re.search(r"^   ```python\n(.*?)^   ```$", step, re.DOTALL | re.M)
            if code is not None:
                path = re.search(r"`src/elastomdr/([\w/]+\.pyi?)`", step)
                assert path is not None, step
                self.steps.append((path.group(1), textwrap.dedent(code.group(1))))


class Copy:
    """A copy of the package that a test may change, and run."""

    def __init__(self, folder: Path):
        self.source = folder / "src"
        shutil.copytree(
            Path(em.__file__).parent,
            self.source / "elastomdr",
            ignore=shutil.ignore_patterns("__pycache__"),
        )

    def insert(self, path: str, code: str, *, before: str, after: str = "") -> None:
        """Puts code above the line `before`, the first one below `after`, with its
        indentation.
        """
        file = self.source / "elastomdr" / path
        text = file.read_text(encoding="utf-8")
        start = text.index(after)
        line = re.compile(rf"^( *){re.escape(before)}", re.MULTILINE)
        place = line.search(text, start)
        assert place is not None, f"{path} has no line {before!r}"
        lines = textwrap.indent(code, place.group(1))
        text = text[: place.start()] + lines + text[place.start() :]
        file.write_text(text, encoding="utf-8")

    def replace(self, path: str, line: str, new: str) -> None:
        """Another line in the place of one."""
        file = self.source / "elastomdr" / path
        text = file.read_text(encoding="utf-8")
        assert text.count(line) == 1, f"{path} has no line {line!r}"
        file.write_text(text.replace(line, new), encoding="utf-8")

    def run(self, code: str, folder: Path) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-c", textwrap.dedent(code)],
            env={**os.environ, "PYTHONPATH": str(self.source)},
            cwd=folder,
            capture_output=True,
            text=True,
            timeout=120,
        )


@pytest.fixture
def copy(tmp_path):
    return Copy(tmp_path)


def test_a_road_model(copy, tmp_path):
    steps = Recipe("A model").steps
    model, imported, kind, label, name, stub, said, key, word = steps
    (tmp_path / "scene.toml").write_text(
        'material = "rubber.toml"\n'
        '[surface]\nshape = "self_affine"\nhurst = 0.8\nq_low = "1e3 rad/m"\nq_high = "1e5 rad/m"\n'
        "rms_slope = 0.5\n"
        '[contact]\npressure = "3 bar"\nvelocity = "1 m/s"\nmodel = "toy"\n'
        "share = 0.25\n",
        encoding="utf-8",
    )
    use = """
        import elastomdr as em
        from elastomdr.app import words
        from elastomdr.cli.keys import as_text
        from elastomdr.cli.main import main
        rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
        road = em.SelfAffine(hurst=0.8, q_low=1e3, q_high=1e5, rms_slope=0.5)
        given = {"velocity": [0.1, 1.0], "pressure": 3e5}
        curve = em.friction(rubber, road, model="toy", **given)
        half = em.friction(rubber, road, model=em.Toy(share=0.25), **given)
        assert (curve.mu == rubber.loss_tangent(1e3 * curve.velocity) / 2).all()
        assert (2 * half.mu == curve.mu).all()
        try:
            em.Toy(share=2.0)
        except em.InputError as error:
            assert (error.argument, error.got) == ("share", 2.0)
        em.save_material(rubber, "rubber.toml")
        assert main(["friction", "scene.toml"]) == 0
        row = open("scene-friction.csv").read().splitlines()[-1]
        assert f"{half.mu[1]:.6g}"[:6] in row, row
        assert "share of the loss tangent" in as_text("friction")
        assert words.title(("contact", "share")) == "Share of the loss tangent"
        print("Toy as Toy" in open(em.__file__ + "i").read())
    """
    assert "toy" in copy.run(use, tmp_path).stderr
    for function in ast.walk(ast.parse(model[1])):
        if isinstance(function, ast.FunctionDef):
            assert function.returns is not None, function.name
            assert all(given.annotation for given in function.args.args[1:])
    copy.insert(model[0], f"{model[1]}\n\n", before="@constructor_in_si")
    copy.insert(imported[0], imported[1], before="from ..surface.rough_line")
    copy.insert(kind[0], kind[1], before="HalfSpace,", after="KINDS: dict")
    copy.insert(label[0], label[1], before='"half-space",')
    copy.replace(
        name[0], '"rough.road_models": (', f'"rough.road_models": ({name[1].strip()} '
    )
    copy.insert(stub[0], stub[1], before="from .rough.road_models import Persson")
    copy.insert(said[0], said[1], before="gamma: persson", after="class ContactTable")
    copy.insert(key[0], key[1], before="gamma: float", after="class ContactTable")
    copy.insert(word[0], word[1], before='"gamma":')
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split()[-1:] == ["True"], ran.stdout + ran.stderr


def test_an_indenter(copy, tmp_path):
    shape, rule, table = Recipe("An indenter").steps
    (tmp_path / "scene.toml").write_text(
        'material = "rubber.toml"\n'
        '[indenter]\nshape = "near_sphere"\nradius = "5 mm"\n'
        '[contact]\nload = "1 N"\nvelocity = "1 m/s"\n',
        encoding="utf-8",
    )
    use = """
        import numpy as np
        import elastomdr as em
        from elastomdr.cli.main import main
        from elastomdr.surface.shapes import NearSphere
        near = NearSphere(5e-3)
        r = np.linspace(0.0, 2e-3, 5)
        # Abel's integral of f', r = x sin(t)
        t = (np.arange(400) + 0.5) * np.pi / 800
        rise = near._steepness(r[:, None] * np.sin(t))
        abel = r * np.mean(rise, axis=1) * np.pi / 2
        np.testing.assert_allclose(near.profile_1d(r), abel, rtol=1e-5)
        rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
        given = {"velocity": 1.0, "load": 1.0}
        curve = em.friction(rubber, near, **given)
        points = em.Profile(r := np.linspace(0.0, 5e-3, 2001), near.height(r))
        other = em.friction(rubber, points, **given)
        np.testing.assert_allclose(curve.mu, other.mu, rtol=1e-4)
        em.save_material(rubber, "rubber.toml")
        assert main(["friction", "scene.toml"]) == 0
        print("near-sphere" in repr(curve) or curve.mu > 0)
    """
    assert "NearSphere" in copy.run(use, tmp_path).stderr
    copy.insert(shape[0], f"{shape[1]}\n\n", before="class Cone(PowerShape)")
    copy.insert(rule[0], rule[1], before="power = shape", after="def _along")
    imported = "from .shapes import AbstractShape"
    copy.replace(rule[0], imported, imported + ", NearSphere")
    copy.insert(table[0], f"{table[1]}\n\n", before="class ConeTable")
    copy.replace(
        table[0],
        "    | ProfileTable\n)",
        "    | ProfileTable\n    | NearSphereTable\n)",
    )
    public = '        "Paraboloid",'
    copy.replace("__init__.py", public, f'{public}\n        "NearSphere",')
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split()[-1:] == ["True"], ran.stderr


def test_a_doubt(copy, tmp_path):
    (file, imported), (place, mark) = Recipe("A doubt").steps
    use = """
        import elastomdr as em
        rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
        given = {"velocity": [0.1, 100.0], "load": 1.0}
        curve = em.friction(rubber, em.Sphere(5e-3), **given)
        curve.to_csv("curve.csv")
        print("degrades" in repr(curve.doubts), "degrades" in repr(curve.law().doubts),
            "degrades" in open("curve.csv").read())
    """
    assert "True" not in copy.run(use, tmp_path).stdout
    copy.insert(file, imported, before="from ..results.curve import")
    copy.insert(place, mark, before="if adhesion is None:", after="def _on_smooth")
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split() == ["True"] * 3, ran.stderr


def test_a_key_of_a_scene(copy, tmp_path):
    (file, said), (_, field), (_, used) = Recipe("A key of a scene").steps
    use = """
        import numpy as np
        import elastomdr as em
        from elastomdr.cli.keys import as_text
        from elastomdr.cli.main import main
        rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
        em.save_material(rubber, "rubber.toml")
        for name, layer in (("a", "plies = 2\\nthickness = '2 mm'"), ("b", "thickness = '4 mm'")):
            open(f"{name}.toml", "w").write(
                "material = 'rubber.toml'\\n[layer]\\n" + layer +
                "\\n[indenter]\\nshape = 'cylinder'\\nradius = '5 mm'\\nlength = '1 m'\\n"
                "[contact]\\nload = '50 N'\\nvelocity = '1 m/s'\\n"
            )
            assert main(["rolling", f"{name}.toml"]) == 0
        tables = [open(f"{n}-rolling.csv").read().splitlines()[-1] for n in "ab"]
        print(tables[0] == tables[1], "bonded to each other" in as_text("rolling"))
    """
    assert "plies" in copy.run(use, tmp_path).stderr
    copy.insert(file, f"    {said}", before='"""', after="springs: independent")
    copy.insert(file, field, before="thickness: Length", after="class LayerTable")
    copy.insert(file, used, before="kind = em.springs", after="class LayerTable")
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split()[-2:] == ["True", "True"], ran.stdout + ran.stderr


def test_a_field_of_a_result(copy, tmp_path):
    (declared, field), (packed, value) = Recipe("A field of a result").steps
    use = """
        import elastomdr as em
        rubber = em.Prony(equilibrium=1e6, moduli=[1e6], times=[1e-3])
        ball = em.Sphere(5e-3)
        curve = em.friction(rubber, ball, velocity=[0.1, 1.0], load=1.0)
        assert (curve.power == curve.velocity * curve.friction_force).all()
        curve.to_csv("curve.csv")
        print("friction power [W]" in open("curve.csv").read())
    """
    assert "power" in copy.run(use, tmp_path).stderr
    copy.insert(declared, field, before="direction: Array", after="class FrictionCurve")
    copy.insert(packed, value, before="mu=solution.mu", after="curve = FrictionCurve(")
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split() == ["True"], ran.stderr


def test_a_dma_format(copy, tmp_path):
    (reader, function), (register, entry) = Recipe("A DMA format").steps
    (tmp_path / "rubber.txt").write_text(
        "Acme rheometer 3\n"
        "0.1;1.2;0.1;20\n1;1.5;0.2;20\n10;2.0;0.4;20\n"
        "# Frequency (Hz)\n# Storage modulus (MPa)\n"
        "# Loss modulus (MPa)\n# Temperature (degC)\n",
        encoding="utf-8",
    )
    use = """
        import elastomdr as em
        dma = em.read_dma("rubber.txt")
        print(dma.storage[-1], dma.loss[-1], dma.kind)
    """
    assert "InputError" in copy.run(use, tmp_path).stderr
    copy.insert(reader, f"{function}\n\n", before="# RepTate's columns")
    copy.insert(register, entry, before='Format("table"')
    ran = copy.run(use, tmp_path)
    assert ran.stdout.split() == ["2000000.0", "400000.0", "shear"], ran.stderr
