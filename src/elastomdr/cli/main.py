"""The command `elastomdr`: reads what is asked for and hands it to the verb's own file, loaded only then."""

import argparse
import importlib
import os
import sys
from collections.abc import Sequence
from typing import NoReturn

from .. import __version__
from ..errors import InputError

DONE, BAD_INPUT, NOT_CONVERGED, INTERRUPTED = 0, 2, 3, 130
_LONGEST = 1000  # characters of a message


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise InputError(f"{message} (see {self.prog} --help)")


def main(argv: Sequence[str] | None = None) -> int:
    """Runs the command line; returns 0 when done, 2 for bad input, 3 when some points did not converge."""
    try:
        arguments = _parser().parse_args(argv)
        status = importlib.import_module(f".{arguments.verb}", __package__).run(arguments)
        if sys.stdout is not None:  # closed before we were started
            sys.stdout.flush()
        return status
    except InputError as error:
        print(f"elastomdr: error: {_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt as error:
        print(f"elastomdr: interrupted{error}", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:  # the reader of our output, such as `head`, has what it wanted
        _drop_output()
        return DONE
    except OSError as error:  # files are written and read with care; what is left is our own output
        _drop_output()
        print(
            f"elastomdr: error: the output cannot be written: {_one_line(error.strerror or str(error))}.",
            file=sys.stderr,
        )
        return BAD_INPUT
    except MemoryError as error:
        print(f"elastomdr: error: the scene needs more memory than there is: {_one_line(str(error))}", file=sys.stderr)
        return BAD_INPUT


def _drop_output() -> None:
    """Lets what is still to be printed go nowhere, so that Python does not complain about it at its end."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _one_line(text: str) -> str:
    """A message with single blanks, cut to a readable length, what cannot be printed as a question mark."""
    text = "".join(c if c.isprintable() else "?" for c in " ".join(text.split()))
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST // 2]} ... {text[-_LONGEST // 2 :]}"


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="elastomdr",
        description="Rubber friction and rolling resistance from a material file: one table and one figure per run.",
        epilog="Exit status: 0 done, 2 bad input, 3 some points did not converge.",
    )
    parser.add_argument("--version", action="version", version=f"elastomdr {__version__}")
    verbs = parser.add_subparsers(dest="verb", metavar="VERB", required=True)
    for verb, what, also in (
        ("friction", "friction", ""),
        (
            "rolling",
            "rolling resistance",
            "; with [warming] its temperature, with [conveyor] the power of a whole belt",
        ),
    ):
        words = f"{what} against velocity: writes NAME-{verb}.csv and NAME-{verb}.png{also}"
        command = verbs.add_parser(verb, help=words, description=words[0].upper() + words[1:] + ".")
        command.add_argument("scene", metavar="SCENE.toml", help="the scene to compute")
        command.add_argument("--out", metavar="DIR", default=".", help="folder for the files (default: this one)")
    for verb, what, also in (
        ("indent", "indentation under a history of depth or load", ""),
        ("slide", "sliding through stages of rest, speed and load", "; with [drive] through a spring: stick-slip"),
        ("traction", "traction of a wheel or ball against slip or creep", ""),
    ):
        words = f"{what}: writes NAME-{verb}.csv and NAME-{verb}.png{also}"
        command = verbs.add_parser(verb, help=words, description=words[0].upper() + words[1:] + ".")
        command.add_argument("scene", metavar="SCENE.toml", help="the scene to compute")
        command.add_argument("--out", metavar="DIR", default=".", help="folder for the files (default: this one)")
    words = "what friction or rolling would compute, skip and condense, and why"
    command = verbs.add_parser("plan", help=words, description=f"Prints {words}.")
    command.add_argument("scene", metavar="SCENE.toml", help="the scene to plan")
    command.add_argument(
        "--quantity", choices=("friction", "rolling"), default="friction", help="what to plan for (default: friction)"
    )
    words = "measured isotherms (DMA) to a material file, with cards, tables and figures"
    command = verbs.add_parser("fit", help=words, description=f"From {words}.")
    importlib.import_module(".fit", __package__).add_arguments(command)
    words = "the library of materials, or the numbers and sources of one of them"
    command = verbs.add_parser("materials", help=words, description=f"Prints {words}.")
    command.add_argument("name", metavar="NAME", nargs="?", help="a name in the library, or a material file")
    return parser
