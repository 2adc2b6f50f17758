"""`elastomdr indent SCENE.toml`: indentation under a history of depth or load."""

import argparse

from .curve import write_curve
from .history import read_history


def run(arguments: argparse.Namespace) -> int:
    """Writes the indentation of a scene; returns the exit status."""
    scene = read_history(arguments.scene)
    from .. import indent

    return write_curve(scene, "indent", indent, arguments.out)
