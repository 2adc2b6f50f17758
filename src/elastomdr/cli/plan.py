"""`elastomdr plan SCENE.toml`: what would be computed, skipped and condensed, and
why.
"""

import argparse
from pathlib import Path

import elastomdr as em

from . import DONE
from .compute import output_folder, warned_of_at_the_end, write_all
from .kinds import read_scene
from .scene import models_by_name
from .schema import named


def run(options: argparse.Namespace) -> int:
    """Prints the plan of a scene; returns the exit status."""
    path = Path(options.scene)
    with warned_of_at_the_end(), named(f"{path.name or path}:"):
        scene = read_scene(options.quantity, path)
        if scene.called() != options.quantity:
            raise em.InputError(
                f"[{scene.mark}] belongs to elastomdr {options.quantity}, not to "
                "elastomdr plan."
            )
        folder = None if options.out is None else output_folder(options.out)
        with models_by_name():
            text = f"{em.plan(**scene.arguments(path.parent), quantity=options.quantity)}\n"
    print(text, end="")
    if folder is not None:
        write_all(folder, {f"{path.stem}-plan.txt": lambda to: _write(to, text)})
        print(f"wrote {folder / path.stem}-plan.txt")
    return DONE


def _write(path: Path, text: str) -> None:
    path.write_text(text, encoding="utf-8")
