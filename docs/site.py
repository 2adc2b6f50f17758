"""What makes the site of the repository: a hook of mkdocs.

The README becomes the first page, every example and every notebook a page with its code
and figures, and each group of public names another, from their docstrings; the keys of
scene files come from their schema. Other pages at the root of the repository, and those
of materials and benchmarks, are taken as they are. Links to files that are no pages
lose their link. Equations become MathML, so that the site needs no script from
elsewhere.
"""

import ast
import base64
import html
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from math_core import LatexToMathML
from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]
KEYS = "<!-- keys of scene files -->"
GROUPS = {
    "Friction and rolling": (
        "friction",
        "rolling",
        "plan",
        "AdhesiveShear",
        "Heat",
        "cite",
    ),
    "Many scenes, long computations": ("sweep", "progress"),
    "Models": ("Averaged", "Line", "Marched", "Multiscale", "Persson", "HalfSpace"),
    "Motion in time": (
        "indent",
        "Adhesion",
        "impact",
        "shear",
        "traction",
        "slide",
        "drive",
        "Mount",
    ),
    "Materials": (
        "Prony",
        "KelvinVoigt",
        "Maxwell",
        "StandardSolid",
        "TabulatedModulus",
        "WLF",
        "Arrhenius",
        "VFT",
        "ShiftTable",
        "EntropicVertical",
        "VerticalTable",
        "Softening",
        "materials",
        "load_material",
        "save_material",
    ),
    "Files of others": (
        "read_dma",
        "read_friction",
        "read_shifts",
        "read_spectrum",
        "read_surface",
    ),
    "From three dimensions to one": (
        "half_space",
        "layer",
        "Layer",
        "springs",
        "Foundation",
    ),
    "Shapes and surfaces": (
        "Sphere",
        "Paraboloid",
        "Cone",
        "FlatPunch",
        "PowerLaw",
        "Profile",
        "Cylinder",
        "RoughLine",
        "SelfAffine",
        "Spectrum",
    ),
    "Applications": (
        "conveyor",
        "Idlers",
        "heat_build_up",
        "dissipation",
        "stability",
        "o_ring",
        "leak",
        "CriticalConstriction",
        "EffectiveMedium",
        "break_out",
        "lubricated",
        "reciprocating",
        "friction_spectrum",
        "press",
        "load_friction",
    ),
}
EXAMPLES = sorted((ROOT / "examples").rglob("[0-9][0-9]_*.py"))
NOTEBOOKS = sorted((ROOT / "examples" / "notebooks").glob("*.ipynb"))
RESULTS = "Results and errors"  # the group of all other names
PAGES = {  # of the repository that lie outside docs, by their place on the site
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "changelog.md": "CHANGELOG.md",
    "materials.md": "materials/README.md",
    "benchmarks.md": "benchmarks/README.md",
    "robustness.md": "benchmarks/robustness/README.md",
}
HOMES = {path: uri for uri, path in PAGES.items()} | {"examples": "examples/index.md"}
HOMES |= {
    str(Path(path).parent): uri
    for path, uri in HOMES.items()
    if path.endswith("/README.md")
}


def on_config(config: MkDocsConfig) -> MkDocsConfig:
    """Puts the pages of examples and of the API below their titles in the contents."""
    below = {
        "Examples": [*(_page(path) for path in [*NOTEBOOKS, *EXAMPLES])],
        "API": [*api()],
    }
    for entry in config.nav or []:
        for title, pages in below.items():
            if title in entry:
                entry[title] = [entry[title], *pages]
    return config


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Adds the pages that are made."""
    made: dict[str, str | bytes] = {
        uri: (ROOT / path).read_text(encoding="utf-8") for uri, path in PAGES.items()
    }
    made["benchmarks.md"] += figures()
    made |= api() | {"api/index.md": api_index(), "examples/index.md": gallery()}
    for path in EXAMPLES:
        made[_page(path)] = example(path)
    for path in NOTEBOOKS:
        made |= notebook(path)
    for uri, content in made.items():
        files.append(File.generated(config, uri, content=content))
    for path in sorted((ROOT / "benchmarks" / "results").glob("*.png")):
        files.append(
            File.generated(config, f"benchmarks/{path.name}", abs_src_path=str(path))
        )
    return files


def gallery() -> str:
    """Examples and notebooks, each with its first figure."""
    lines = ["# Examples", ""]
    for title, text, paths in (
        (
            "Notebooks",
            "From data to result, for Jupyter: `jupyter lab examples/notebooks`.",
            NOTEBOOKS,
        ),
        (
            "Scripts",
            (
                "Each runs by itself: `python examples/NAME.py [--out DIR]`, and ends "
                "in a check."
            ),
            [path for path in EXAMPLES if path.parent.name == "examples"],
        ),
        (
            "Worked problems",
            "Ten scripts that end in a closed form or a limit.",
            [path for path in EXAMPLES if path.parent.name == "problems"],
        ),
    ):
        lines += [
            f"## {title}",
            "",
            text,
            "",
            '<div class="grid cards gallery" markdown>',
            "",
        ]
        for path in paths:
            page = _page(path).removeprefix("examples/")
            figure = (
                page.replace(".md", "_1.png")
                if path.suffix == ".ipynb"
                else "../" + _figure(path)
            )
            lines += [f"-   [![]({figure}){{loading=lazy}} {_title(path)}]({page})", ""]
        lines += ["</div>", ""]
    return "\n".join(lines)


def example(path: Path) -> str:
    """The page of an example: its docstring, its figure, its code."""
    text = path.read_text(encoding="utf-8")
    _, words = _sentence_and_rest(path)
    up = "../" * _page(path).count("/")
    code = text.split('"""', 2)[2].strip()
    return (
        "# "
        f"{_title(path)}\n\n{words}\n\n![{_title(path)}]({up}{_figure(path)})\n\n```python\n{code}\n```\n"
    )


def notebook(path: Path) -> dict[str, str | bytes]:
    """The page of a notebook with the outputs that it holds, its figures, and the
    notebook itself.
    """
    made: dict[str, str | bytes] = {}
    page = _page(path)
    lines = []
    for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
        source = "".join(cell["source"])
        lines += [
            source if cell["cell_type"] == "markdown" else f"```python\n{source}\n```",
            "",
        ]
        for output in cell.get("outputs", []):
            data = output.get("data", {"text/plain": output.get("text", "")})
            if "image/png" in data:
                figure = page.replace(
                    ".md", f"_{1 + sum(name.endswith('.png') for name in made)}.png"
                )
                made[figure] = base64.b64decode(data["image/png"])
                lines += [f"![{_title(path)}]({Path(figure).name})", ""]
            else:
                lines += ["```text", "".join(data["text/plain"]).rstrip(), "```", ""]
    made[page.replace(".md", ".ipynb")] = path.read_bytes()
    return made | {
        page: "\n".join([*lines, f"[Download this notebook]({path.name})", ""])
    }


def _page(path: Path) -> str:
    return path.relative_to(ROOT).with_suffix(".md").as_posix()


def _figure(path: Path) -> str:
    return (
        "figures/" + path.relative_to(ROOT / "examples").with_suffix(".png").as_posix()
    )


def _title(path: Path) -> str:
    """The first sentence of an example, or the first line of a notebook."""
    if path.suffix == ".ipynb":
        return json.loads(path.read_text(encoding="utf-8"))["cells"][0]["source"][
            0
        ].strip("# \n")
    title = re.sub(r"^\d+: ", "", _sentence_and_rest(path)[0])
    return title[0].upper() + title[1:].rstrip(".")


def _sentence_and_rest(path: Path) -> tuple[str, str]:
    """The first sentence of an example's docstring, on one line, and what follows."""
    text = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8")))
    first, _, rest = text.partition("\n\n")
    sentence, *more = re.split(r"(?<=[.?!])\s+", " ".join(first.split()), maxsplit=1)
    return sentence, "\n\n".join([*more, rest.strip()])


def figures() -> str:
    """The figures under benchmarks/results, each with what it was computed for."""
    lines = ["", "## Figures", ""]
    for path in sorted((ROOT / "benchmarks" / "results").glob("*.png")):
        record = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
        lines += [
            f"### {record['title']}",
            "",
            f"`python benchmarks/{path.stem}.py`",
            "",
        ]
        lines += [
            *(
                f"- {text}"
                for text in (*record.get("inputs", []), record.get("machine", ""))
            ),
            "",
        ]
        lines += [f"![{record['title']}](benchmarks/{path.name})", ""]
    return "\n".join(lines)


def api() -> dict[str, str]:
    """A page for each group of public names, from the table in the package's
    __init__.
    """
    made = {}
    for title, names in _groups().items():
        lines = [f"# {title}", ""]
        if title == RESULTS:  # what they share stands once
            lines += [
                "All results have the methods of this class:",
                "",
                "::: elastomdr.results.base.Result",
                "",
            ]
        for name, home in names.items():
            lines += [
                f"::: elastomdr.{home}.{name}",
                *["    options: {inherited_members: false}"][: title == RESULTS],
                "",
            ]
        made[f"api/{re.sub(r'[^a-z]+', '-', title.lower())}.md"] = "\n".join(lines)
    return made


def api_index() -> str:
    """All public names, group by group."""
    lines = [
        "# API",
        "",
        "`import elastomdr as em`: the names below are those of `em`.",
        "",
        "| group | names |",
        "|---|---|",
    ]
    for page, (title, names) in zip(api(), _groups().items(), strict=True):
        links = ", ".join(
            f"[`{name}`][elastomdr.{home}.{name}]" for name, home in names.items()
        )
        lines.append(f"| [{title}]({Path(page).name}) | {links} |")
    return "\n".join([*lines, ""])


def _groups() -> dict[str, dict[str, str]]:
    """Title of a group to its names, each with the module it lives in."""
    table = _table(ROOT / "src" / "elastomdr" / "__init__.py", "_HOMES")
    homes = {name: module for module, names in table.items() for name in names}
    known = [name for names in GROUPS.values() for name in names]
    if absent := set(known) - set(homes):
        raise KeyError(
            f"names in GROUPS that elastomdr does not have: {sorted(absent)}"
        )
    groups = {**GROUPS, RESULTS: tuple(sorted(set(homes) - set(known)))}
    found = {
        title: {name: homes[name] for name in names} for title, names in groups.items()
    }
    elements = ROOT / "src" / "elastomdr" / "element" / "elements.py"
    return found | {
        "em.elements": dict.fromkeys(_table(elements, "__all__"), "element.elements"),
        **{f"em.{package}": _members(package) for package in ("fit", "reference")},
    }


def _table(path: Path, name: str) -> dict[str, Any]:
    """A literal assigned to `name` in a file, without importing it."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if (
            isinstance(node, ast.Assign)
            and getattr(node.targets[0], "id", None) == name
        ):
            return ast.literal_eval(node.value)
    raise KeyError(name)


def _members(package: str) -> dict[str, str]:
    """Public names of a package and the modules they live in."""
    path = ROOT / "src" / "elastomdr" / package / "__init__.py"
    found = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        helpers = ("typing", "errors")  # used by the package, not part of it
        if isinstance(node, ast.ImportFrom) and node.module not in helpers:
            home = f"{package}.{node.module}" if node.level == 1 else node.module
            found |= {alias.asname or alias.name: home for alias in node.names}
    if not found:
        homes = _table(path, "_HOMES").items()  # ".io.data" is beside the package
        found = {
            n: m[1:] if m.startswith(".") else f"{package}.{m}"
            for m, names in homes
            for n in names
        }
    return found


def on_page_markdown(
    markdown: str, page: Any, config: MkDocsConfig, files: Files
) -> str:
    """Links of the repository become links of the site, or plain words where the file
    is no page.
    """
    folder = Path(page.file.src_uri).parent
    home = PAGES.get(page.file.src_uri)
    of_notebook = folder.name == "notebooks"
    inside = (
        (ROOT / home).parent
        if home
        else ROOT / folder
        if of_notebook
        else ROOT / "docs" / folder
    )
    as_it_is = page.file.src_uri.startswith(("examples/", "api")) and not of_notebook

    def follow(match: re.Match[str]) -> str:
        words, target = match[1], match[2]
        if as_it_is or re.match(r"[a-z]+:|#", target):
            return match[0]
        place, _, anchor = target.partition("#")
        full = (inside / place).resolve()
        uri = full.relative_to(ROOT).as_posix().removeprefix("docs/")
        uri = (
            uri.removesuffix(".py") + ".md"
            if uri.startswith("examples/") and uri.endswith(".py")
            else uri
        )
        uri = HOMES.get(uri, uri)
        if files.get_file_from_path(uri) is None:
            return words
        up = "../" * (len(folder.parts))
        return f"[{words}]({up}{uri}{'#' + anchor if anchor else ''})"

    if KEYS in markdown:
        markdown = markdown.replace(KEYS, keys_page())
    images = re.sub(r"(!\[[^\]]*\]\()docs/", r"\1", markdown)
    return re.sub(r"(?<!!)\[((?:[^\[\]]|\[[^\[\]]*\])+)\]\(([^)\s]+)\)", follow, images)


def keys_page() -> str:
    """The keys of all scenes, a table for each section; one that several kinds share
    stands at its first place.
    """
    from elastomdr.cli.keys import section_of, sections
    from elastomdr.cli.kinds import KINDS as VERBS
    from elastomdr.cli.schema import about
    from elastomdr.cli.sweep import SweepTable

    lines, seen = [], []
    for verb, kinds in VERBS.items():
        lines += [f"## elastomdr {verb}", ""]
        for kind in kinds:
            lines += [f"### {about(kind).rstrip('.')}", ""]
            for section in sections(kind):
                if section not in seen:
                    seen.append(section)
                    lines += _rows(section)
    lines += [
        "## elastomdr sweep",
        "",
        "Beside the keys of friction, rolling or impact:",
        "",
    ]
    return "\n".join([*lines, *_rows(section_of("[sweep]", SweepTable))])


def _rows(section: Any) -> Iterator[str]:
    """A section as a table of Markdown."""
    from elastomdr.cli.keys import cells

    if section.title:
        yield from (f"`{section.title}` {section.about}", "")
    if section.keys:
        yield from ("| key | accepted | default | meaning |", "|---|---|---|---|")
    for key in section.keys:
        row = " | ".join(cell.replace("|", "\\|") for cell in cells(key))
        yield f"| `{key.name}` | {row} |"
    yield ""


def on_page_content(text: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Equations as MathML."""
    convert = LatexToMathML().convert_with_local_state

    def equation(match: re.Match[str]) -> str:
        block = match[1] == "div"
        made = convert(html.unescape(match[3]), displaystyle=block)
        return f'<div class="equation">{made}</div>' if block else made

    return re.sub(
        r'<(span|div) class="arithmatex">\\([(\[])(.*?)\\[)\]]</\1>',
        equation,
        text,
        flags=re.DOTALL,
    )
