"""What makes the site of the repository: a hook of mkdocs.

The README becomes the first page, every example a page with its code and figure, and the public names of the package
another, from their docstrings; the keys of scene files come from their schema. Other pages at the root of the
repository, and those of materials and benchmarks, are taken as they are. Links to files that are no pages lose their
link. Equations become MathML, so that the site needs no script from elsewhere.
"""

import ast
import json
import re
from pathlib import Path
from typing import Any

import latex2mathml.converter
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
KEYS = "<!-- keys of scene files -->"
GROUPS = {
    "Friction and rolling": ("friction", "rolling", "plan", "AdhesiveShear", "Heat"),
    "Many scenes": ("sweep",),
    "Models": ("Averaged", "Line", "Multiscale", "Persson", "HalfSpace"),
    "Motion in time": ("indent", "impact", "shear", "traction", "slide", "drive", "Mount"),
    "Materials": (
        "Prony", "KelvinVoigt", "Maxwell", "StandardSolid", "TabulatedModulus", "WLF", "Arrhenius", "VFT", "ShiftTable",
        "EntropicVertical", "VerticalTable", "Softening",
        "materials", "load_material", "save_material",
    ),
    "Files of others": ("read_dma", "read_friction", "read_shifts", "read_spectrum", "read_surface"),
    "From three dimensions to one": ("half_space", "layer", "Layer", "springs", "Foundation", "ContactStep"),
    "Shapes and surfaces": (
        "Sphere", "Paraboloid", "Cone", "FlatPunch", "PowerLaw", "Profile", "Cylinder", "RoughLine", "SelfAffine",
        "Spectrum",
    ),
    "Applications": (
        "conveyor", "Idlers", "warming", "dissipation", "stability", "squeezed_cord", "friction_bands", "line_contact",
        "load_friction",
    ),
}  # fmt: skip
PAGES = {  # of the repository that lie outside docs, by their place on the site
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "materials.md": "materials/README.md",
    "benchmarks.md": "benchmarks/README.md",
    "robustness.md": "benchmarks/robustness/README.md",
}
HOMES = {path: uri for uri, path in PAGES.items()} | {"examples": "examples/index.md"}
HOMES |= {str(Path(path).parent): uri for path, uri in HOMES.items() if path.endswith("/README.md")}


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are made."""
    made = {uri: (ROOT / path).read_text(encoding="utf-8") for uri, path in PAGES.items()}
    made["benchmarks.md"] += figures()
    made["api.md"] = api()
    listed = [
        "# Examples",
        "",
        "Each file runs by itself: `python examples/NAME.py [--out DIR]`; CI runs them all.",
        "",
    ]
    for path in sorted((ROOT / "examples").rglob("[0-9][0-9]_*.py")):
        page = path.relative_to(ROOT).with_suffix(".md").as_posix()
        made[page] = example(path)
        title = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))).splitlines()[0]
        listed.append(f"- [{title}]({page.removeprefix('examples/')})")
    made["examples/index.md"] = "\n".join(listed) + "\n"
    for uri, content in made.items():
        files.append(File.generated(config, uri, content=content))
    for path in sorted((ROOT / "benchmarks" / "results").glob("*.png")):
        files.append(File.generated(config, f"benchmarks/{path.name}", abs_src_path=str(path)))
    return files


def example(path: Path) -> str:
    """The page of an example: its docstring, its figure where the repository has one, its code."""
    text = path.read_text(encoding="utf-8")
    head, *rest = ast.get_docstring(ast.parse(text)).splitlines()
    figure = path.relative_to(ROOT / "examples").with_suffix(".png")
    up = "../" * (len(figure.parts))
    shown = f"![{head}]({up}figures/{figure.as_posix()})\n\n" if (ROOT / "docs" / "figures" / figure).exists() else ""
    code = text.split('"""', 2)[2].strip()
    return f"# {head}\n\n" + "\n".join(rest).strip() + f"\n\n{shown}```python\n{code}\n```\n"


def figures() -> str:
    """The figures under benchmarks/results, each with what it was computed for."""
    lines = ["", "## Figures", ""]
    for path in sorted((ROOT / "benchmarks" / "results").glob("*.png")):
        record = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        lines += [f"### {record['title']}", "", f"`python benchmarks/{path.stem}.py`", ""]
        lines += [*(f"- {text}" for text in (*record.get("inputs", []), record.get("machine", ""))), ""]
        lines += [f"![{record['title']}](benchmarks/{path.name})", ""]
    return "\n".join(lines)


def api() -> str:
    """The public names of the package, from the table in its __init__."""
    homes = {
        name: module
        for module, names in _table(ROOT / "src" / "elastomdr" / "__init__.py", "_HOMES").items()
        for name in names
    }
    known = [name for names in GROUPS.values() for name in names]
    if absent := set(known) - set(homes):
        raise KeyError(f"names in GROUPS that elastomdr does not have: {sorted(absent)}")
    groups = {**GROUPS, "Results and errors": tuple(sorted(set(homes) - set(known)))}
    lines = ["# API", "", "`import elastomdr as em`: the names below are those of `em`.", ""]
    for title, names in groups.items():
        lines += [f"## {title}", "", *(line for name in names for line in (f"::: elastomdr.{homes[name]}.{name}", ""))]
    for package in ("fit", "reference"):
        lines += [f"## em.{package}", ""]
        for name, module in _members(package).items():
            lines += [f"::: elastomdr.{module}.{name}", ""]
    return "\n".join(lines)


def _table(path: Path, name: str) -> dict[str, Any]:
    """A literal assigned to `name` in a file, without importing it."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", None) == name:
            return ast.literal_eval(node.value)
    raise KeyError(name)


def _members(package: str) -> dict[str, str]:
    """Public names of a package and the modules they live in."""
    path = ROOT / "src" / "elastomdr" / package / "__init__.py"
    found = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom) and node.module != "typing":
            home = f"{package}.{node.module}" if node.level == 1 else node.module
            found |= {alias.asname or alias.name: home for alias in node.names}
    if not found:
        homes = _table(path, "_HOMES").items()  # ".io.data" is beside the package
        found = {n: m[1:] if m.startswith(".") else f"{package}.{m}" for m, names in homes for n in names}
    return found


def on_page_markdown(markdown: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Links of the repository become links of the site, or plain words where the file is no page."""
    folder = Path(page.file.src_uri).parent
    home = PAGES.get(page.file.src_uri)
    inside = (ROOT / home).parent if home else ROOT / "docs" / folder

    def follow(match: re.Match[str]) -> str:
        words, target = match[1], match[2]
        if re.match(r"[a-z]+:|#", target) or page.file.src_uri.startswith(("examples/", "api")):
            return match[0]
        place, _, anchor = target.partition("#")
        full = (inside / place).resolve()
        uri = full.relative_to(ROOT).as_posix().removeprefix("docs/")
        uri = uri.removesuffix(".py") + ".md" if uri.startswith("examples/") and uri.endswith(".py") else uri
        uri = HOMES.get(uri, uri)
        if files.get_file_from_path(uri) is None:
            return words
        up = "../" * (len(folder.parts))
        return f"[{words}]({up}{uri}{'#' + anchor if anchor else ''})"

    if KEYS in markdown:
        from elastomdr.cli.keys import as_markdown

        markdown = markdown.replace(KEYS, as_markdown())
    images = re.sub(r"(!\[[^\]]*\]\()docs/", r"\1", markdown)
    return re.sub(r"(?<!!)\[((?:[^\[\]]|\[[^\[\]]*\])+)\]\(([^)\s]+)\)", follow, images)


def on_page_content(html: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Equations as MathML."""

    def convert(match: re.Match[str]) -> str:
        tex = match[3].replace("&amp;", "&").replace("&lt;", "<").replace("&gt;", ">")
        display = "block" if match[1] == "div" else "inline"
        return latex2mathml.converter.convert(tex, display=display)

    return re.sub(r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>', convert, html, flags=re.DOTALL)
