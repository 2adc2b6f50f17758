"""What the verbs friction and rolling share: compute a curve, print its summary, write its table and its figure."""

import os
import sys
import warnings
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from ..errors import ConvergenceWarning, ExtrapolationWarning, InputError
from .cache import DAMAGED, enable_cache
from .main import DONE, NOT_CONVERGED
from .parts import Bar, Parts
from .scene import Scene, in_file


def write_curve(scene: Scene, verb: str, call: Callable[..., Any], out: str) -> int:
    """Computes, prints and writes; returns the exit status. Nothing is written before everything is computed."""
    if scene.rough and verb not in ("friction", "slide"):
        raise InputError(f"{scene.path.name}: a [surface] has friction, no {verb}: use elastomdr friction.")
    if scene.further is not None:
        no_other_verb(scene, verb)
        verb, call = scene.further.name, scene.further.call
    folder = _folder(out)
    parts, bar = Parts(folder / f".{scene.path.stem}-{verb}.parts"), Bar()
    enable_cache()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always", ConvergenceWarning)
        warnings.simplefilter("always", ExtrapolationWarning)
        with in_file(scene.path):
            if scene.rough and verb == "friction":
                try:
                    curve = call(scene.material, scene.shape, **scene.arguments, progress=bar, store=parts)
                except KeyboardInterrupt as error:
                    raise KeyboardInterrupt(parts.said()) from error
                finally:
                    bar.end()
            else:
                curve = call(scene.material, scene.shape, **scene.arguments)
    notes = [("scene", scene.path.name)] + ([("title", scene.title)] if scene.title else [])
    stem = f"{scene.path.stem}-{verb}"
    points = {} if scene.measured is None else {"measured": scene.measured.points}
    files = {
        folder / f"{stem}.csv": curve.csv(notes).encode(),
        folder / f"{stem}.png": curve.png(scene.title, **points),
    }
    if scene.rough and verb == "friction" and curve.rough is not None and curve.converged.any():
        contact = _contact(scene, curve)
        files |= {} if contact is None else {folder / f"{stem}-contact.png": contact}
    _write(folder, files)
    parts.remove()  # not before: what was computed outlives a full disk
    if scene.title:
        print(scene.title)
    print(curve.summary())
    print("wrote " + " and ".join(str(path) for path in files))
    if scene.measured is not None:
        for text in scene.measured.report:
            print(f"elastomdr: warning: {scene.measured.source}: {text}", file=sys.stderr)
    say(said)
    return DONE if curve.converged.all() else NOT_CONVERGED


def no_other_verb(scene: Scene, verb: str) -> None:
    """Raises `InputError` where a scene with a [warming] or a [conveyor] is given to another verb than theirs."""
    if scene.further is not None and verb != scene.further.verb:
        raise InputError(
            f"{scene.path.name}: [{scene.further.name}] belongs to elastomdr {scene.further.verb}, not to elastomdr "
            f"{verb}."
        )


def _contact(scene: Scene, curve: Any) -> bytes | None:
    """The figure of where the line touches, at the largest friction; none where that does not converge by itself."""
    import numpy as np

    from .. import line_contact

    top = np.unravel_index(np.nanargmax(curve.mu), curve.mu.shape)
    kept = {k: scene.arguments[k] for k in ("samples", "periods", "equivalent_length") if k in scene.arguments}
    if curve.rough.pressure is None:
        kept |= {"load": curve.normal_force[top]}
    else:
        kept |= {"pressure": curve.rough.pressure[top]}
    if curve.temperature is not None:
        warmer = 0.0 if curve.rough.rise is None else curve.rough.rise[top]
        kept |= {"temperature": curve.temperature[top] + warmer}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        found = line_contact(scene.material, scene.shape, velocity=curve.velocity[top], **kept)
    return found.png() if found.converged.all() else None


def say(warned: Iterable[warnings.WarningMessage]) -> None:
    """Prints what was warned of, one line each; a damaged cache, of which JAX complains by the file, once."""
    texts = [
        str(warning.message).replace("; they are NaN", "; their cells in the table are empty") for warning in warned
    ]
    for text in dict.fromkeys(DAMAGED if "persistent compilation cache" in text else text for text in texts):
        print(f"elastomdr: warning: {' '.join(text.split())}", file=sys.stderr)


def _folder(out: str) -> Path:
    """The folder to write into. Refuses, before anything is computed, what can be seen to be none."""
    folder = Path(out)
    try:
        there = next((f for f in (folder, *folder.absolute().parents) if f.exists()), None)
        usable = there is not None and there.is_dir() and os.access(there, os.W_OK) and "\0" not in out
    except (OSError, ValueError):
        usable = False
    if not usable:
        raise InputError(f"--out must be a folder that can be written, got {out!r}.")
    return folder


def _write(folder: Path, files: dict[Path, bytes]) -> None:
    from ..results.table import write_files

    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            f"--out must be a folder that can be written, got {str(folder)!r}: {error.strerror}."
        ) from error
    write_files(files)
