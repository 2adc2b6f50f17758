"""Objects as small tables and figures of HTML, for notebooks (`_repr_html_`)."""

from __future__ import annotations

import base64
import dataclasses
import html
import io
from collections.abc import Iterable, Iterator
from typing import Any

from .units.arguments import UNITS

_DPI, _WIDTH = 150, 420  # of a figure: dots per inch, and dots across
_SHORT = 6  # entries up to which an array is shown whole


def html_table(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """A heading and rows of a name and a text, all of it escaped."""
    lines = (
        f'<tr><th style="text-align: left">{html.escape(name)}</th>'
        f'<td style="text-align: left">{html.escape(value)}</td></tr>'
        for name, value in rows
    )
    return f"<table><caption>{html.escape(title)}</caption><tbody>{''.join(lines)}</tbody></table>"


def html_figure(axes: Any) -> str:
    """The figure that matplotlib's axes belong to, small, as a part of the page."""
    image = io.BytesIO()
    axes.figure.savefig(image, format="png", dpi=_DPI)
    content = base64.b64encode(image.getvalue()).decode()
    return f'<img alt="" width="{_WIDTH}" src="data:image/png;base64,{content}">'


def fields_in_words(tree: Any) -> Iterator[tuple[str, str]]:
    """The fields of a dataclass that have a value, with the SI units of the arguments
    of these names.
    """
    for field in dataclasses.fields(tree):
        value = getattr(tree, field.name)
        if (
            value is None
            or (isinstance(value, str) and not value)
            or field.name.startswith("_")
        ):
            continue
        unit = UNITS.get(field.name.removesuffix("_table"), "")
        words = _in_words(value)
        yield field.name, f"{words} {unit}" if unit and isinstance(unit, str) else words


def _in_words(value: Any) -> str:
    import numpy as np

    if isinstance(value, float):
        return f"{value:.6g}"
    if not isinstance(value, np.ndarray):
        return value if isinstance(value, str) else repr(value)
    if value.ndim == 0:
        return f"{value.item():.6g}"
    if value.size <= _SHORT:
        return np.array2string(value, precision=6, separator=", ")
    if value.dtype.kind not in "fiu":
        return f"{value.size} values"
    return f"{value.min():.6g} to {value.max():.6g} ({value.size} values)"
