"""The pages of the documentation that belong to what is shown, in a dialog."""

import re

from nicegui import ui

from .stage import BUTTON, DOCS

# by file, in the order in which they are offered
PAGES = {
    "app": "This page",
    "fitting": "From measured moduli to a material",
    "rough": "Rough roads",
    "measured-friction": "Measured friction",
    "accuracy": "How sure the numbers are",
    "wheel": "Rollers and wheels",
    "belt": "Belts",
    "tyre": "Tyres",
    "seal": "Seals",
    "terms": "Terms",
}


def show_docs(name: str) -> None:
    """Shows a page of the docs, with the others to choose from."""
    with ui.dialog() as dialog, ui.element("div").classes("help"):
        with ui.element("div").classes("buttons"):
            chosen = ui.select(PAGES, value=name, label="Documentation")
            chosen.classes("choice")
            ui.button("Close", on_click=dialog.close).props(f"{BUTTON} outline")
        page = ui.markdown(text(name))
        chosen.on_value_change(lambda event: page.set_content(text(event.value)))
    dialog.on("hide", dialog.delete)
    dialog.open()


def text(name: str) -> str:
    """A page as Markdown without figures and links, which the browser has not, and with
    formulas as they are written.
    """
    markdown = DOCS.joinpath(f"{name}.md").read_text(encoding="utf-8")
    if name == "app":  # what stands before is to open the page
        markdown = markdown[markdown.index("| screen |") :]
    markdown = re.sub(r"!\[.*?\]\(.*?\)\n+\*.*?\*\n", "", markdown, flags=re.DOTALL)
    markdown = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", markdown)
    markdown = re.sub(r"\$\$(.+?)\$\$", r"\n```\n\1\n```\n", markdown, flags=re.DOTALL)
    return re.sub(r"\$([^$\n]+)\$", r"`\1`", markdown)
