"""An extension of griffe: the fields of a result, which `quantity` declares, as a table
of its page.
"""

import ast
from typing import Any

import griffe

TITLE = "\n\nAttributes:\n"


class Fields(griffe.Extension):
    """Adds the label, unit and meaning of each field to the docstring of its class."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        # rooms have the classes of their verbs beside those of `results`
        rooms = [room for room in pkg.modules.values() if not room.is_alias]
        for module in [module for room in rooms for module in room.modules.values()]:
            for cls in module.classes.values():
                found = {}
                for owner in [*reversed(cls.mro()), cls]:
                    found |= {
                        name: str(a.value)
                        for name, a in owner.attributes.items()
                        if a.value is not None
                    }
                rows = [
                    f"    {name}: {_words(call)}"
                    for name, call in found.items()
                    if call.startswith("quantity(")
                ]
                # this is called more than once
                if rows and cls.docstring and TITLE not in cls.docstring.value:
                    cls.docstring.value += TITLE + "\n".join(rows)


def _words(call: str) -> str:
    label, unit, *meaning = (
        part.value for part in ast.parse(call, mode="eval").body.args
    )
    return label + f" [{unit}]" * bool(unit) + "".join(f"; {text}" for text in meaning)
