"""What the commands do that compute a scene: `elastomdr friction`, `rolling`, `indent`,
`impact`, `slide`, `traction`, `leak`, `lubricated`, `o_ring`, `reciprocating`, `break_out`
write a table, a figure and more; `compare` a ranking, `plan` what would be computed.
"""

import argparse
import contextlib
import os
import sys
import tempfile
import warnings
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import elastomdr as em

from ..errors import InputError
from ..files import no_formula, write_files
from . import DONE, NOT_CONVERGED
from .kinds import read_scene
from .scene import Scene
from .schema import Arguments, of_file

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..results.base import Result
    from ..results.curve import Ranking

_DPI = 200
_SWEPT = ("friction", "rolling", "impact")  # calls that `elastomdr sweep` takes
_DAMAGED = (
    "the cache of compiled code is damaged, so everything was compiled anew: remove "
    "elastomdr's cache folder."
)
_STYLES = {"-": "solid", "--": "dashed", "-.": "dash-dotted", ":": "dotted"}


def run(options: argparse.Namespace) -> int:
    """Computes, writes and prints; returns the exit status. Nothing is written before
    everything is computed.
    """
    path, folder = Path(options.scene), output_folder(options.out)
    with warned_of_at_the_end():
        with of_file(path):
            scene = read_scene(options.verb, path)
            parted = getattr(options, "uncertainty", False)
            if parted and scene.called() not in ("friction", "rolling"):
                raise InputError(
                    argument="--uncertainty",
                    accepted=f"left out of a scene with [{scene.mark}]",
                    hint="it is known of the rolling resistance alone, of a scene "
                    "without that table",
                )
            arguments = scene.arguments(path.parent)
            beside: Any = scene.beside(path.parent)
            compared = options.verb == "compare"
            measured = scene.points(path.parent)
            shown = how_drawn(scene, arguments, measured)
            shown = {"title": scene.title} if compared else shown
            stem = f"{path.stem}-{'compare' if compared else scene.called()}"
            with scene.in_keys(), em.progress(f"{scene.called()} of {path.name}"):
                results, names = [_computed(scene, arguments)], [stem]
                if beside is not None:
                    results.append(em.rolling(**beside))
                    names.append(f"{path.stem}-rolling")
                if parted:
                    results.append(scene.judged(results[0], measured))
                    names.append(f"{stem}-uncertainty")
            outcomes = [scene.outcome(results[0]), *results[1:]]
        notes = _notes(path, scene)
        files: dict[str, Callable[[Path], object]] = {}
        for name, each in zip(names, outcomes, strict=True):
            how = shown if name == stem else {}
            files[f"{name}.csv"] = partial(_write_table, each, notes)
            files[f"{name}.png"] = partial(write_figure, each, how)
        sentence = scene.said(results[0])
        try:
            further = scene.further_files(results[0])
        except InputError as error:
            further, sentence = {}, str(error)
        files |= {f"{stem}{end}": write for end, write in further.items()}
        write_all(folder, files)
        if options.verbose:
            said = [scene.title, *(each.summary() for each in outcomes)]
        else:
            lines = [*outcomes[0].headline()]
            if parted:  # all but the largest value of the curve
                lines[1:] = outcomes.pop().headline()
            said = [aligned(lines), *map(_in_two, outcomes[1:])]
        print(*filter(None, [*said, sentence]), sep="\n")
        print(f"wrote     {', '.join(str(folder / name) for name in files)}")
    return DONE if all(r.converged.all() for r in results) else NOT_CONVERGED


def aligned(pairs: Iterable[tuple[str, str]]) -> str:
    """Names and sentences, a line each."""
    return "\n".join(f"{name:<9} {sentence}" for name, sentence in pairs)


def _in_two(result: "Result") -> str:
    """What is printed of a result beside the first: its largest value and doubts."""
    largest, *_, doubts = result.headline()
    return aligned([largest, doubts])


def output_folder(out: str) -> Path:
    """The folder to write into. Refuses, before anything is computed, what can be seen
    to be none.
    """
    folder = Path(out)
    try:
        existing = next(
            (f for f in (folder, *folder.absolute().parents) if f.exists()), folder
        )
        usable = existing.is_dir() and os.access(existing, os.W_OK) and "\0" not in out
    except (OSError, ValueError):
        usable = False
    if not usable:
        raise InputError(
            argument="--out", got=out, accepted="a folder that can be written"
        )
    return folder


def write_all(folder: Path, files: dict[str, Callable[[Path], object]]) -> None:
    """Writes files by name, each by its function; all of them appear when they are
    complete, or none.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".elastomdr-", dir=folder) as place:
            for name, write in files.items():
                write(Path(place) / name)
            contents = {
                folder / name: (Path(place) / name).read_bytes() for name in files
            }
        write_files(contents)
    except OSError as error:
        raise InputError(
            argument="--out",
            got=str(folder),
            accepted="a folder that can be written",
            hint=str(error.strerror),
        ) from error


@contextlib.contextmanager
def warned_of_at_the_end() -> Iterator[None]:
    """Prints the warnings, one line each; a damaged cache, of which JAX complains
    by the file, once.
    """
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", UserWarning)  # all of ours are such
        yield
    texts = [
        str(each.message).replace(
            "; they are NaN", "; their cells in the table are empty"
        )
        for each in caught
    ]
    for message in dict.fromkeys(
        _DAMAGED if "persistent compilation cache" in message else message
        for message in texts
    ):
        print(f"elastomdr: warning: {' '.join(message.split())}", file=sys.stderr)


def _computed(scene: Scene, arguments: Arguments) -> Any:
    try:
        return scene.doubted(getattr(em, scene.called())(**arguments))
    except KeyboardInterrupt as error:
        left = "; nothing was written"
        if scene.called() in _SWEPT:
            left += "; `elastomdr sweep` keeps what is done, and goes on from there"
        raise KeyboardInterrupt(left) from error


def how_drawn(
    scene: Scene, arguments: Arguments, measured: "em.MeasuredFriction | None"
) -> Arguments:
    """How the result is drawn: its title, measured points on top."""
    shown: Arguments = {"title": scene.title}
    if scene.called() == "slide" and len(set(arguments["position"])) > 1:
        shown["against"] = "position"  # a rest may take most of the time
    if measured is not None:
        shown["measured"] = measured.points
    return shown


def _notes(path: Path, scene: Scene) -> str:
    """What stands above the header of a table."""
    lines = [f"# scene: {path.name}"]
    lines += [f"# title: {' '.join(scene.title.split())}"] if scene.title else []
    return "".join(f"{no_formula(line)}\n" for line in lines)


def _write_table(result: "Result | Ranking", notes: str, path: Path) -> None:
    result.to_csv(path)
    path.write_text(notes + path.read_text(encoding="utf-8"), encoding="utf-8")


def write_figure(result: Any, how: Arguments, path: Path) -> None:
    figure = result.plot(**how).figure
    figure.savefig(path, dpi=_DPI, metadata={"Description": _in_words(figure)})


def _in_words(figure: "Figure") -> str:
    """What a figure shows, a line each: its words, then its curves by their ends, for
    those who cannot see it, and to check whether a file is what a command writes today.
    """
    said: list[str] = []
    for axes in figure.axes:
        legend = axes.get_legend()
        words = [axes.get_title("left"), *(note.get_text() for note in axes.texts)]
        words += [axes.get_xlabel(), axes.get_ylabel()]
        words += [label.get_text() for label in legend.get_texts()] if legend else []
        said += [" ".join(each.split()) for each in words if each.strip()]
        said += filter(None, map(_curve_in_words, axes.lines))
    return "\n".join(said)


def _curve_in_words(line: Any) -> str:
    """The ends of a curve; empty for a single marker."""
    style = _STYLES.get(line.get_linestyle())
    ends = [(x, y) for x, y in zip(*line.get_data(), strict=True) if y == y]
    if style is None or not ends:
        return ""
    (x, y), (last, value) = ends[0], ends[-1]
    return f"{style} curve: {y:.4g} at {x:.4g} to {value:.4g} at {last:.4g}"


def run_plan(options: argparse.Namespace) -> int:
    """Prints the plan of a scene; returns the exit status."""
    path = Path(options.scene)
    with warned_of_at_the_end(), of_file(path):
        scene = read_scene(options.quantity, path)
        if scene.called() != options.quantity:
            raise InputError(
                argument=f"[{scene.mark}]",
                accepted="left out for elastomdr plan",
                hint=f"it belongs to elastomdr {options.quantity}",
            )
        with scene.in_keys():
            plan = f"{em.plan(**scene.arguments(path.parent), quantity=options.quantity)}\n"
    print(plan, end="")
    return DONE
