"""The command `elastomdr`: reads what is asked for and hands it to the command's own
file, loaded only then.
"""

import argparse
import gc
import importlib
import os
import sys
from collections.abc import Callable, Sequence
from typing import Any, NoReturn

from .. import __version__
from ..errors import InputError, as_options
from . import BAD_INPUT, DONE, INTERRUPTED

_LONGEST = 1000  # characters of a message
_SCENES = {
    "friction": "friction against velocity",
    "rolling": (
        "rolling resistance against velocity; with [heat_build_up] temperature, with "
        "[conveyor] power of a belt"
    ),
    "indent": "indentation under a history of depth or load",
    "impact": "impact and rebound",
    "slide": (
        "sliding through stages of rest, speed and load; with [drive] pulled through a "
        "spring (stick-slip)"
    ),
    "traction": "traction of a wheel or ball against slip or creepage",
    "leak": "leak of a static seal against pressure and time",
    "lubricated": "film and friction of a lubricated cylinder against velocity",
    "o_ring": "sealing force of a squeezed O-ring against time",
    "reciprocating": "films, net leak and friction of an O-ring on a moving rod",
    "break_out": "friction at which a dry seal breaks out, against its dwell",
    "compare": "materials ranked by friction at one velocity and temperature",
}


class _UsageError(Exception):
    """What argparse says of the command line."""


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise _UsageError(f"{message} (see {self.prog} --help)")

    def format_help(self) -> str:
        """The help; that of a command that computes a scene ends with the keys of the
        scene.
        """
        verb = self.prog.split()[-1]
        if verb not in _SCENES:
            return super().format_help()
        from .keys import as_text

        return f"{super().format_help()}\n{as_text(verb)}"


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns 0 when done, 2 for bad input, 3 when some points
    did not converge.
    """
    # of the libraries that are loaded nothing is garbage: looking for it takes 0.1 s
    gc.set_threshold(50_000, 20, 10)
    try:
        options = _parser().parse_args(argv)
        status = _function(options.run)(options)
        if sys.stdout is not None:  # closed before we were started
            sys.stdout.flush()
        return status
    except InputError as error:
        from .units import shown_beside

        return _refused(error.words(str, shown_beside(error.got), as_options))
    except _UsageError as error:
        return _refused(str(error))
    except KeyboardInterrupt as error:
        print(f"elastomdr: interrupted{error}", file=sys.stderr)
        return INTERRUPTED
    # the reader of our output, such as `head`, has what it wanted
    except BrokenPipeError:
        _drop_output()
        return DONE
    except ConnectionError as error:  # of a cluster
        return _refused(str(error))
    # files are written and read with care; what is left is our own output
    except OSError as error:
        _drop_output()
        return _refused(f"the output cannot be written: {error.strerror or error}.")
    except MemoryError as error:
        return _refused(f"the scene needs more memory than there is: {error}")


def _function(name: str) -> Callable[[argparse.Namespace], int]:
    """A function by its file in this folder, such as "fit:run"; ".app.command:run" is of
    the package app.
    """
    module, function = name.split(":")
    return getattr(importlib.import_module(f".{module}", __package__), function)


def _refused(message: str) -> int:
    """Prints a message as one line of readable length, what cannot be printed as a
    question mark.
    """
    line = "".join(c if c.isprintable() else "?" for c in " ".join(message.split()))
    if len(line) > _LONGEST:
        line = f"{line[: _LONGEST // 2]} ... {line[-_LONGEST // 2 :]}"
    print(f"elastomdr: error: {line}", file=sys.stderr)
    return BAD_INPUT


def _drop_output() -> None:
    """Lets what is still to be printed go nowhere, so that Python does not complain
    about it at its end.
    """
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="elastomdr",
        description=(
            "Rubber friction and rolling resistance from a material file: five "
            "lines, a "
            "table and a figure per run."
        ),
        epilog="Exit status: 0 done, 2 bad input, 3 some points did not converge.",
    )
    parser.add_argument(
        "--version", action="version", version=f"elastomdr {__version__}"
    )
    commands = parser.add_subparsers(
        dest="verb", metavar="COMMAND", required=True, parser_class=_Parser
    )
    for verb, words in _SCENES.items():
        files = f"Writes NAME-{verb}.csv and NAME-{verb}.png: {words}."
        command = _added(commands, verb, "compute:run", words, files)
        _add_scene(command, "the scene to compute; its keys are listed below")
        _add_output(command)
        if verb in ("friction", "rolling"):
            command.add_argument(
                "--uncertainty",
                action="store_true",
                help=f"write NAME-{verb}-uncertainty.csv and .png as well: what the "
                "coefficient rests on, part by part, and which test would make it "
                "surer; takes up to thirty times as long",
            )
    for verb, run, words, add_options in _OTHERS:
        add_options(_added(commands, verb, run, words))
    return parser


def _added(
    commands: Any, verb: str, run: str, words: str, description: str | None = None
) -> _Parser:
    """The parser of a command, which `run` carries out."""
    command = commands.add_parser(
        verb, help=words, description=description or f"{words[0].upper()}{words[1:]}."
    )
    command.set_defaults(run=run)
    return command


def _add_scene(command: _Parser, words: str) -> None:
    command.add_argument("scene", metavar="SCENE.toml", help=words)


def _add_output(command: _Parser) -> None:
    """Where files are written to, and how much is printed."""
    command.add_argument(
        "--out",
        metavar="DIR",
        default=".",
        help="folder for the files (default: this one)",
    )
    command.add_argument(
        "--verbose",
        action="store_true",
        help="print inputs, findings and every doubt, as they stand above the table",
    )


def _add_init(command: _Parser) -> None:
    command.add_argument(
        "scene",
        metavar="NAME.toml",
        nargs="?",
        help="file to write (default: KIND.toml)",
    )
    kinds = importlib.import_module(".init", __package__).kinds()
    command.add_argument(
        "--kind",
        choices=kinds,
        help="what kind of scene (default: slider; with a surface road)",
    )
    for option, words in (
        ("--material", "the rubber: a name of the library, or a file written by fit"),
        ("--profile", "a measured profile or map of heights, as the road"),
        ("--spectrum", "a power spectrum, as the road"),
    ):
        command.add_argument(option, metavar="FILE", help=words)


def _add_plan(command: _Parser) -> None:
    _add_scene(command, "the scene to plan")
    command.add_argument(
        "--quantity",
        choices=("friction", "rolling"),
        default="friction",
        help="what to plan for (default: friction)",
    )


def _add_sweep(command: _Parser) -> None:
    _add_scene(command, "a scene of friction, rolling or impact, with [sweep]")
    command.add_argument(
        "--out",
        metavar="STORE.zarr",
        required=True,
        help="store: a new folder, or that of an earlier run of the same scene",
    )
    command.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a Dask cluster (default: the cores of this machine)",
    )
    command.add_argument(
        "--table",
        metavar="FILE",
        help="a .csv file for all points, written as well",
    )


def _add_fit(command: _Parser) -> None:
    importlib.import_module(".fit", __package__).add_arguments(command)
    _add_output(command)


def _add_calibrate(command: _Parser) -> None:
    _add_scene(command, "the scene of friction, with what is known beforehand")
    add = command.add_argument
    add(
        "--measured",
        metavar="FILE",
        help="points: velocity, mu, and temperature, pressure and error where they are "
        "known (default: the scene's own)",
    )
    add(
        "--column",
        metavar="ROLE=N",
        action="append",
        default=[],
        help="a column of the points by title or number, such as mu=Reibbeiwert",
    )
    add(
        "--parameters",
        metavar="NAMES",
        default="q_high,shear",
        help="what is to be found (default: q_high,shear); heights, modulus, time and "
        "others",
    )
    add(
        "--draws",
        metavar="N",
        type=int,
        default=0,
        help="draws of the parameters, for intervals that need not be symmetric; 200 "
        "take about a minute",
    )
    _add_output(command)


def _add_app(command: _Parser) -> None:
    command.add_argument(
        "--port",
        metavar="N",
        type=int,
        default=0,
        help="port on this machine (default: a free one)",
    )
    command.add_argument(
        "--no-browser",
        action="store_true",
        help="print the address and open no browser",
    )


def _add_materials(command: _Parser) -> None:
    command.add_argument(
        "name",
        metavar="NAME",
        nargs="?",
        help="a name in the library, or a material file",
    )


# command, "file:function" that carries it out, what it does, its options
_OTHERS: tuple[tuple[str, str, str, Callable[[_Parser], None]], ...] = (
    ("init", "init:run", "a scene with comments to start from", _add_init),
    (
        "plan",
        "compute:run_plan",
        "what friction or rolling would compute, and how",
        _add_plan,
    ),
    (
        "sweep",
        "sweep:run",
        "a scene at every combination of the values of its lists; an interrupted run "
        "can be continued",
        _add_sweep,
    ),
    (
        "fit",
        "fit:run",
        "a material file, with cards, tables and figures, from measured isotherms "
        "(DMA)",
        _add_fit,
    ),
    (
        "calibrate",
        "fit:run_calibration",
        "cutoff and shear law of a scene from measured friction, with a scene, material "
        "and surface that have them",
        _add_calibrate,
    ),
    (
        "app",
        ".app.command:run",
        "all steps from a DMA file to friction, on a page in this machine's browser",
        _add_app,
    ),
    (
        "materials",
        "materials:run",
        "the library of materials, or the numbers and sources of one of them",
        _add_materials,
    ),
)
