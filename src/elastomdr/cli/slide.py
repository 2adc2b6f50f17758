"""`elastomdr slide SCENE.toml`: transient sliding through stages of rest, speed and load."""

import argparse

from .curve import write_curve
from .stages import read_stages


def run(arguments: argparse.Namespace) -> int:
    """Writes the sliding history of a scene; returns the exit status."""
    scene = read_stages(arguments.scene)
    from .. import slide

    return write_curve(scene, "slide", slide, arguments.out)
