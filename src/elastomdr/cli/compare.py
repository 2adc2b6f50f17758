"""`elastomdr compare`: the materials of a scene of friction ranked, as a table and a
figure.
"""

import argparse
from collections.abc import Callable
from pathlib import Path

from ..errors import InputError
from . import DONE, NOT_CONVERGED
from .compute import (
    Parts,
    _computed,
    _write_figure,
    _write_table,
    output_folder,
    warned_of_at_the_end,
    write_all,
)
from .kinds import read_scene
from .scene import models_by_name
from .schema import named
from .steady import BodyComparison, SurfaceComparison


def run(options: argparse.Namespace) -> int:
    """Computes, writes and prints; returns the exit status."""
    path, folder = Path(options.scene), output_folder(options.out)
    parts = folder / f".{path.stem}-compare.parts"
    with warned_of_at_the_end():
        with named(f"{path.name or path}:"):
            scene = read_scene("compare", path)
            assert isinstance(scene, SurfaceComparison | BodyComparison)
            if len(scene.material) < 2:
                raise InputError(
                    "material must be a list of two or more to be compared."
                )
            arguments = scene.arguments(path.parent)
            with models_by_name():
                curve = _computed(scene, arguments, parts)
            with named("[compare]"):
                ranking = curve.ranking(**scene.compare.place())
        notes = f"# scene: {path.name}\n" + (
            f"# title: {' '.join(scene.title.split())}\n" if scene.title else ""
        )
        files: dict[str, Callable[[Path], None]] = {
            f"{path.stem}-compare.csv": lambda to: _write_table(ranking, to, notes),
            f"{path.stem}-compare.png": lambda to: _write_figure(
                ranking.plot(title=scene.title), to
            ),
        }
        write_all(folder, files)
        Parts(parts).remove()
        if scene.title:
            print(scene.title)
        print(ranking.summary())
        print("wrote " + " and ".join(str(folder / name) for name in files))
    return DONE if curve.converged.all() else NOT_CONVERGED
