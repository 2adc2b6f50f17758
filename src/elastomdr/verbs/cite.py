"""The references of a result as BibTeX."""

import re
from importlib.resources import files

from .. import __version__
from ..errors import InputError
from ..material.library import load_material, materials
from ..results.base import Result

# of a publication in references.bib: what class of result, model, or name of an argument
# says that it was used
_USED = {
    "popov-hess-2015": "MDR|springs|Indentation|Impact|Shear|Slide|Drive|Traction",
    "radok-1957": "MDR|springs|plane strain|layer|Indentation|Impact|Shear|Slide|Drive",
    "lee-radok-1960": "Indentation",
    "ting-1966": "Indentation|Impact",
    "mindlin-1949": "Shear",
    "johnson-1985": "layer|cylinder|ORing|Conveyor|HeatBuildUp",
    "persson-2001": "Persson|Multiscale",
    "scaraggi-persson-2015": "Persson's theory",
    "lorenz-2015": "^adhesion$",
    "jaeger-1942": "^heat$",
    "persson-2006": "^heat$",
    "carter-1926": "Traction",
    "pacejka-2012": "Traction",
    "yang-persson-2008": "Leak|RoughContact",
    "persson-yang-2008": "critical constriction",
    "lorenz-persson-2010": "effective medium",
    "lindley-1967": "ORing",
    "blok-1963": "Reciprocating",
    "giacopini-2010": "Lubricated",
    "patir-cheng-1978": "Patir",
}
_SOFTWARE = f"""@software{{elastomdr,
  title = {{elastomdr: friction and rolling resistance of rubber}},
  author = {{{{The elastomdr authors}}}},
  version = {{{__version__}}}
}}
"""


def cite(result: Result) -> str:
    """BibTeX of what a result used: this package, the publications of its method and the
    sources of materials of the library.

    Args:
        result: what a verb such as `em.friction` has returned.

    Returns:
        The entries, one below the other. Materials that are not in the library are left
        out: `material.citation` is the source of each.

    Raises:
        InputError: for anything but a result.
    """
    if not isinstance(result, Result):
        raise InputError(
            argument="result",
            got=result,
            accepted="what a verb such as em.friction returns",
        )
    signs = [type(result).__name__, result.model, *(name for name, _ in result.inputs)]
    publications = files("elastomdr.verbs").joinpath("references.bib")
    entries = [
        entry.strip() + "\n"
        for entry in publications.read_text(encoding="utf-8").split("\n\n")
        if any(re.search(_USED[_key(entry)], sign) for sign in signs)
    ]
    return "\n".join([_SOFTWARE, *entries, *map(_material, _library_names(result))])


def _key(entry: str) -> str:
    return entry[entry.index("{") + 1 : entry.index(",")].strip()


def _library_names(result: Result) -> list[str]:
    """Names of the library among the materials of a result, each once."""
    named = [*result.materials, dict(result.inputs).get("material", "")]
    return [name for name in dict.fromkeys(named) if name in materials()]


def _material(name: str) -> str:
    """The source of a material's numbers, as its file has it."""
    source = re.sub(r"([&%#_])", r"\\\1", load_material(name).citation)
    return (
        f"@misc{{material-{name},\n  title = {{{name}}},\n  note = {{{source}}}\n}}\n"
    )
