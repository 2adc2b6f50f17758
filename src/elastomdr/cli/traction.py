"""`elastomdr traction SCENE.toml`: traction against slip or creep."""

import argparse

from .curve import write_curve
from .wheel import read_wheel


def run(arguments: argparse.Namespace) -> int:
    """Writes the traction curve of a scene; returns the exit status."""
    scene = read_wheel(arguments.scene)
    from .. import traction

    return write_curve(scene, "traction", traction, arguments.out)
