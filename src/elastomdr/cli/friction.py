"""`elastomdr friction SCENE.toml`: friction against velocity."""

import argparse

from .curve import write_curve
from .scene import read_scene


def run(arguments: argparse.Namespace) -> int:
    """Writes the friction curve of a scene; returns the exit status."""
    scene = read_scene(arguments.scene)
    from .. import friction

    return write_curve(scene, "friction", friction, arguments.out)
