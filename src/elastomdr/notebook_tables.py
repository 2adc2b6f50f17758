"""Tables and figures of HTML, for notebooks (`_repr_html_`), and pages of them."""

from __future__ import annotations

import base64
import html
import io
from collections.abc import Iterable, Mapping
from datetime import date
from typing import Any

from . import __version__

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
    return html_image(image.getvalue(), _WIDTH)


def html_image(content: bytes, width: int, kind: str = "png") -> str:
    """An image as a part of a page, so many dots across."""
    data = base64.b64encode(content).decode()
    return f'<img alt="" width="{width}" src="data:image/{kind};base64,{data}">'


def html_page(title: str, parts: Mapping[str, str]) -> bytes:
    """A page for people, in one file: parts of HTML by their headings."""
    body = "".join(f"<h2>{heading}</h2>{part}" for heading, part in parts.items())
    title = html.escape(title)
    style = "body{font-family:sans-serif;max-width:60em}pre{overflow:auto}"
    return (
        '<!doctype html><html lang="en"><head><meta charset="utf-8">'
        f"<title>{title}</title><style>{style}</style></head><body><h1>{title}</h1>"
        f"<p>{date.today()}, elastomdr {__version__}</p>{body}</body></html>"
    ).encode()
