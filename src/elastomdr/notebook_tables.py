"""Objects as small tables and figures of HTML, for notebooks (`_repr_html_`)."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable
from typing import Any

_DPI, _WIDTH = 150, 420  # of a figure: dots per inch, and dots across


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
