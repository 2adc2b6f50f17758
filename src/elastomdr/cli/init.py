"""`elastomdr init [NAME.toml]`: a scene with comments to start from."""

import argparse
from pathlib import Path

from ..errors import InputError
from . import DONE

_TEMPLATES = Path(__file__).parent / "templates"


def kinds() -> list[str]:
    """The scenes that there are to start from."""
    return sorted(path.stem for path in _TEMPLATES.glob("*.toml"))


def run(options: argparse.Namespace) -> int:
    """Writes the scene, which must not be there before, and says how to compute it; returns the exit status."""
    path = Path(options.scene or f"{options.kind}.toml")
    if path.suffix != ".toml":
        raise InputError(f"NAME.toml must end in .toml, got {str(path)!r}.")
    text = (_TEMPLATES / f"{options.kind}.toml").read_text(encoding="utf-8").replace(" FILE\n", f" {path.name}\n", 1)
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError as error:
        raise InputError(f"{path} is there already: give another name, elastomdr init NAME.toml.") from error
    except (OSError, ValueError) as error:
        raise InputError(f"{path} cannot be written: {getattr(error, 'strerror', None) or error}.") from error
    verb = text.split("elastomdr ", 1)[1].split()[0]
    print(f"wrote {path}\nelastomdr {verb} {path}")
    return DONE
