"""The command `elastomdr`: reads what is asked for and hands it to the command's own
file, loaded only then.
"""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from typing import Any, NoReturn

from .. import __version__
from ..errors import InputError
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
        "sliding through stages of rest, speed and load; with [drive] through a "
        "spring: stick-slip"
    ),
    "traction": "traction of a wheel or ball against slip or creepage",
    "compare": "materials ranked by friction at one velocity and temperature",
}


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")

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
    try:
        options = _parser().parse_args(argv)
        status = importlib.import_module(f".{options.module}", __package__).run(options)
        if sys.stdout is not None:  # closed before we were started
            sys.stdout.flush()
        return status
    except InputError as error:
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


def _refused(message: str) -> int:
    """Prints a message as one line of readable length, what cannot be printed as a
    question mark.
    """
    text = "".join(c if c.isprintable() else "?" for c in " ".join(message.split()))
    text = (
        text
        if len(text) <= _LONGEST
        else f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 2 :]}"
    )
    print(f"elastomdr: error: {text}", file=sys.stderr)
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
            "Rubber friction and rolling resistance from a material file: one table "
            "and one figure per run."
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
        command = _added(
            commands,
            verb,
            "compare" if verb == "compare" else "compute",
            words,
            f"Writes NAME-{verb}.csv and NAME-{verb}.png: {words}.",
        )
        command.add_argument(
            "scene",
            metavar="SCENE.toml",
            help="the scene to compute; its keys are listed below",
        )
        command.add_argument(
            "--out",
            metavar="DIR",
            default=".",
            help="folder for the files (default: this one)",
        )
    words = "a scene with comments to start from"
    command = _added(commands, "init", "init", words)
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
    command.add_argument(
        "--material",
        metavar="FILE",
        help="the rubber: a name of the library, or what fit has written",
    )
    command.add_argument(
        "--profile",
        metavar="FILE",
        help="a measured profile or map of heights, as the road",
    )
    command.add_argument(
        "--spectrum", metavar="FILE", help="a power spectrum, as the road"
    )
    words = "what friction or rolling would compute, skip and condense, and why"
    command = _added(commands, "plan", "plan", words)
    command.add_argument("scene", metavar="SCENE.toml", help="the scene to plan")
    command.add_argument(
        "--out", metavar="DIR", help="folder to write NAME-plan.txt into as well"
    )
    what = {
        "choices": ("friction", "rolling"),
        "default": "friction",
        "help": "what to plan for (default: friction)",
    }
    command.add_argument("--quantity", **what)
    words = (
        "a scene at every combination of the values of its lists, in a store that can "
        "be gone on with"
    )
    command = _added(commands, "sweep", "sweep", words)
    command.add_argument(
        "scene",
        metavar="SCENE.toml",
        help="a scene of friction, rolling or impact, with [sweep]",
    )
    command.add_argument(
        "--out",
        metavar="STORE.zarr",
        required=True,
        help="store, new or of the same scene before",
    )
    command.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="of a Dask cluster; by default this machine's cores",
    )
    command.add_argument(
        "--table",
        metavar="FILE",
        help="a .csv or .xlsx file with all points, written as well",
    )
    words = (
        "a material file, with cards, tables and figures, from measured isotherms (DMA)"
    )
    importlib.import_module(".fit", __package__).add_arguments(
        _added(commands, "fit", "fit", words)
    )
    words = "the way from a DMA file to friction, in a page of this machine's browser"
    command = _added(commands, "app", ".app.command", words)
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
    words = "the library of materials, or the numbers and sources of one of them"
    command = _added(commands, "materials", "materials", words)
    command.add_argument(
        "name",
        metavar="NAME",
        nargs="?",
        help="a name in the library, or a material file",
    )
    return parser


def _added(
    commands: Any, verb: str, module: str, words: str, description: str | None = None
) -> _Parser:
    """The parser of a command that the file `module` of this folder carries out
    (`.app.command`: of that package).
    """
    command = commands.add_parser(
        verb, help=words, description=description or f"{words[0].upper()}{words[1:]}."
    )
    command.set_defaults(module=module)
    return command
