"""`elastomdr init [NAME.toml]`: a scene with comments to start from."""

import argparse
import os
import re
from pathlib import Path

from ..errors import InputError
from . import DONE

_TEMPLATES = Path(__file__).parent / "templates"
_PROFILE = """[surface]
shape = "file"
file = {}
# shortest = "20 um"                    # waves that are kept; friction grows with each that is added

"""
_SPECTRUM = """[surface]
shape = "spectrum"
file = {}
convention = ""                         # "2d", "1d", ...: how C is normalised, which no file says
# shortest = "20 um"                    # waves that are kept; friction grows with each that is added

"""


def kinds() -> list[str]:
    """The scenes that there are to start from."""
    return sorted(path.stem for path in _TEMPLATES.glob("*.toml"))


def run(options: argparse.Namespace) -> int:
    """Writes the scene, which must not be there before, and says how to compute it;
    returns the exit status.
    """
    kind, name = options.kind, options.scene
    if kind is None and name in kinds():  # elastomdr init road
        kind, name = name, None
    measured = options.profile or options.spectrum
    kind = kind or ("road" if measured else "slider")
    path = Path(name or f"{kind}.toml")
    if path.suffix != ".toml":
        raise InputError(
            argument="NAME.toml",
            got=str(path),
            accepted=f"a name that ends in .toml, or one of {', '.join(kinds())}",
        )
    if measured and kind != "road":
        raise InputError(
            argument="--kind",
            got=kind,
            accepted="road, to which --profile and --spectrum belong",
        )
    content = _filled_in(kind, path, options)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(content)
    except (OSError, ValueError) as error:
        accepted = "a file that can be written"
        hint = str(getattr(error, "strerror", None) or error)
        if isinstance(error, FileExistsError):
            accepted = "another file, since this one exists"
            hint = "give another name, elastomdr init NAME.toml"
        raise InputError(
            argument="NAME.toml", got=str(path), accepted=accepted, hint=hint
        ) from error
    command = content.split("elastomdr ", 1)[1].partition("\n")[0]
    print(f"wrote {path}\nelastomdr {command.replace(path.name, str(path), 1)}")
    return DONE


def _filled_in(kind: str, path: Path, options: argparse.Namespace) -> str:
    """The template of a kind with the user's material and road."""
    template = (_TEMPLATES / f"{kind}.toml").read_text(encoding="utf-8")
    scene = template.replace(" FILE", f" {path.name}", 1)
    measured = options.profile or options.spectrum
    # the title is that of the example's rubber and road
    if options.material or measured:
        scene = re.sub(r"(?m)^title = .*\n", "", scene, count=1)
    if options.material:
        material = f"material = {_quoted(options.material, path)}"
        scene = re.sub(r"(?m)^material = .*$", material, scene, count=1)
    if measured:
        surface = _SPECTRUM if options.spectrum else _PROFILE
        surface = surface.format(_quoted(measured, path))
        scene = re.sub(r"(?s)\[surface\].*?\n\n", lambda _: surface, scene, count=1)
    return scene


def _quoted(file: str, scene: Path) -> str:
    """A file as a scene names it: relative to the scene's folder. A name of the library
    stays as it is.
    """
    if Path(file).exists():
        file = Path(os.path.relpath(file, scene.parent)).as_posix()
    return '"' + file.replace("\\", "\\\\").replace('"', '\\"') + '"'
