"""`elastomdr plan SCENE.toml`: what would be computed, skipped and condensed, and why."""

import argparse
import warnings

from .cache import enable_cache
from .curve import no_other_verb, say
from .main import DONE
from .scene import in_file, read_scene


def run(arguments: argparse.Namespace) -> int:
    """Prints the plan of a scene; returns the exit status."""
    scene = read_scene(arguments.scene)
    no_other_verb(scene, "plan")
    enable_cache()
    from .. import plan

    with warnings.catch_warnings(record=True) as said, in_file(scene.path):
        print(plan(scene.material, scene.shape, **scene.arguments, quantity=arguments.quantity))
    say(said)
    return DONE
