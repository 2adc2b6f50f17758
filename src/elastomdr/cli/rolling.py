"""`elastomdr rolling SCENE.toml`: rolling resistance against velocity."""

import argparse

from .curve import write_curve
from .scene import read_scene


def run(arguments: argparse.Namespace) -> int:
    """Writes the rolling-resistance curve of a scene; returns the exit status."""
    scene = read_scene(arguments.scene)
    from .. import rolling

    return write_curve(scene, "rolling", rolling, arguments.out)
