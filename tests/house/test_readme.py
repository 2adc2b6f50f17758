"""What README and docs say is so: their code runs, CI runs the command they give, their
links lead somewhere.
"""

import json
import re
import shlex
import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import elastomdr as em
from elastomdr.cli.main import _parser, main
from elastomdr.rough import multiscale, surface
from elastomdr.rough.multiscale import FORM

ROOT = Path(__file__).parents[2]
PAGES = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")),
    *(
        ROOT / folder / "README.md"
        for folder in ("materials", "tests", "benchmarks", "benchmarks/robustness")
    ),
    *sorted((ROOT / "docs").glob("*.md")),
]


WIDE = 120  # characters of a line that can be broken
# tables, headings, equations, figures and code, which cannot
WHOLE = re.compile(r"\s*(\||#|<|\$\$|!\[.*\]\(.*\)$)")


def prose(page: Path) -> list[str]:
    """Lines of a page that could be broken anywhere."""
    text = re.sub(r"^ *```.*?^ *```", "", page.read_text("utf-8"), flags=re.M | re.S)
    text = re.sub(r"\$\$.*?\$\$", "", text, flags=re.DOTALL)
    return [line for line in text.splitlines() if not WHOLE.match(line)]


@pytest.mark.parametrize(
    "page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix()
)
def test_lines_are_short(page):
    assert [line for line in prose(page) if len(line) > WIDE] == []


def test_what_everybody_reads_is_short():
    """Words: numbers that may only fall."""
    users = (
        "app belt choosing fitting measured-friction scenes terms tour transient tyre"
    )
    pages = [ROOT / "docs" / f"{name}.md" for name in (*users.split(), "your-data")]
    assert sum(len(page.read_text("utf-8").split()) for page in pages) <= 7_500
    assert len((ROOT / "README.md").read_text("utf-8").split()) <= 600
    others = "theory accuracy rough seal sharp-edges structure"
    pages = [ROOT / "docs" / f"{name}.md" for name in others.split()]
    pages.append(ROOT / "CONTRIBUTING.md")
    assert sum(len(page.read_text("utf-8").split()) for page in pages) <= 12_600
    unreleased = (ROOT / "CHANGELOG.md").read_text("utf-8").split("\n## [")[1]
    assert len(unreleased.split()) <= 2_000


def blocks(page: Path, language: str) -> list[str]:
    """The fenced code blocks of a page, without the indentation of a list."""
    found = re.findall(
        rf"^( *)```{language}\n(.*?)^ *```$",
        page.read_text(encoding="utf-8"),
        re.DOTALL | re.MULTILINE,
    )
    return [
        "\n".join(line.removeprefix(indent) for line in body.splitlines())
        for indent, body in found
    ]


def marked(mark: str) -> str:
    """The command in the README's block below an HTML comment."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.findall(rf"<!-- {mark} -->\n```bash\n(.*)\n```", text)
    assert len(found) == 1
    return found[0]


def test_ci_runs_the_test_command():
    environment, command = marked("tests").split(" && . .venv/bin/activate && ")
    assert environment == "python3 -m venv .venv"
    script = (ROOT / ".ci" / "run").read_text().splitlines()
    at = script.index("readme() {")
    assert script[at + 1 : at + 3] == [f"    {command}", "}"]
    assert script[at + 3].startswith("readme #")
    assert 'python3 -m venv "$venv"' in script
    assert (ROOT / ".ci" / "run").stat().st_mode & 0o111


def test_main_job_runs(tmp_path, monkeypatch, capsys):
    install, command = marked("main job").rsplit(" && ", 1)
    assert install == "python3 -m venv .venv && .venv/bin/pip install ."
    program, *arguments, out = shlex.split(command)
    assert program == ".venv/bin/elastomdr"
    assert arguments[-1] == "--out"
    monkeypatch.chdir(ROOT)
    assert main([*arguments, str(tmp_path / out)]) == 0
    assert {file.suffix for file in (tmp_path / out).iterdir()} == {".csv", ".png"}
    said = capsys.readouterr().out
    assert "not converged" not in said
    assert len(said.splitlines()) <= 7
    name = "tread-friction.png"
    today, shown = words(tmp_path / out / name), words(ROOT / "docs" / "figures" / name)
    assert [NUMBER.sub("#", line) for line in shown] == [
        NUMBER.sub("#", line) for line in today
    ]
    numbers = [
        [float(number) for line in lines for number in NUMBER.findall(line)]
        for lines in (shown, today)
    ]
    np.testing.assert_allclose(*numbers, rtol=2e-3)  # they have three to four digits
    assert any("extrapolated" in line for line in shown)


NUMBER = re.compile(r"\d+(?:\.\d+)?(?:e[+-]?\d+)?")


def words(figure: Path) -> list[str]:
    """What a figure that was written by a command says of itself."""
    with Image.open(figure) as image:
        return image.info["Description"].splitlines()


@pytest.mark.filterwarnings("ignore:the surface is not isotropic")
@pytest.mark.parametrize(
    "page",
    [
        page
        for page in PAGES
        if blocks(page, "python")
        and page.name not in ("your-data.md", "CONTRIBUTING.md")
    ],
    ids=lambda page: page.name,
)
def test_python_runs(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names: dict[str, object] = {}
    if page.name != "README.md":
        for file in (ROOT / "examples").glob("*/*.csv"):
            shutil.copy(file, tmp_path)
    for block in blocks(page, "python"):
        exec(compile(block, page.name, "exec"), names)
    if page.name == "README.md":
        assert {file.name for file in tmp_path.iterdir()} == {"friction.png"}


def inline(page: Path) -> list[str]:
    """The pieces of code within the sentences of a page."""
    text = re.sub(
        r"^ *```.*?^ *```",
        "",
        page.read_text(encoding="utf-8"),
        flags=re.DOTALL | re.MULTILINE,
    )
    return re.findall(r"`([^`\n]+)`", text)


SHOWN = {  # what a name in the sentences of a page stands for
    "em": em,
    "fit": em.fit.MaterialFit,
    "fit.prony": em.fit.PronyFit,
    "curve": em.FrictionCurve,
    "law": em.FrictionLaw,
    "found": em.Traction,
}
PAGES_OF_USERS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]


@pytest.mark.parametrize("page", PAGES_OF_USERS, ids=lambda page: page.name)
def test_names_in_sentences_exist(page):
    """`fit.band(omega)` and its like, of which no block of code is made."""
    for code in inline(page):
        for name in re.findall(
            r"(?<![\w./\"])((?:em|fit|curve|law|found)(?:\.[A-Za-z_]\w*)+)(?!\.?\w)",
            code,
        ):
            if name.endswith((".py", ".toml", ".csv", ".md")):
                continue
            first, *rest = name.split(".")
            if first == "fit" and len(rest) > 1:
                first, rest = f"fit.{rest[0]}", rest[1:]
            place = SHOWN[first]
            for part in rest:
                # what it holds is not known of a class
                if part in getattr(place, "__dataclass_fields__", ()):
                    break
                assert hasattr(place, part), f"`{name}`: {part}"
                place = getattr(place, part)


COMMANDS = [
    (page, line.removeprefix("$ ").partition(" #")[0])
    for page in PAGES_OF_USERS
    for line in [
        *(
            line
            for kind in ("bash", "console", "")
            for block in blocks(page, kind)
            for line in block.splitlines()
        ),
        *inline(page),
    ]
    if re.match(r"(\$ )?elastomdr (?!--)\w+ .*[A-Z.]", line)
]
MADE = (
    "mine",
    "fitted",
    "dma",
    "profile",
    "road",
    "DMA",
    "map",
    "friction",
    "NAME",
    "roads",
    "name",
)


@pytest.mark.parametrize(
    ("page", "line"), COMMANDS, ids=[f"{page.stem}: {line}" for page, line in COMMANDS]
)
def test_commands_of_the_pages_are_understood(page, line):
    """Their options are there, and so is a scene that they name, unless the page or the
    command before makes it.
    """
    given = _parser().parse_args(shlex.split(line)[1:])
    scene = getattr(given, "scene", None)
    if scene and given.verb != "init" and Path(scene).stem not in MADE:
        assert any(
            (ROOT / folder / scene).is_file() for folder in ("", "examples/scenes")
        ), scene


def test_first_block_is_five_lines():
    block = blocks(ROOT / "README.md", "python")[0]
    assert len(block.splitlines()) == 5


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    for link in re.findall(
        r"\]\((?!https?:)([^)]+)\)", page.read_text(encoding="utf-8")
    ):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        if anchor:
            headings = re.findall(
                r"^#+ (.*)$", target.read_text(encoding="utf-8"), re.MULTILINE
            )
            assert anchor in [
                re.sub(r"[^\w\- ]", "", heading).lower().replace(" ", "-")
                for heading in headings
            ]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_figures_say_how_they_are_made_and_what_is_seen(page):
    """A caption in italics below each figure: the command, whose script is there, and a
    sentence.
    """
    text = page.read_text(encoding="utf-8")
    for name, below in re.findall(
        r"!\[[^\]]+\]\(([^)]+\.png)\)\n\n(.*?)(?=\n\n|\Z)", text, re.DOTALL
    ):
        assert (page.parent / name).is_file()
        assert re.match(r"\*(?!\*).*\*$", below, re.DOTALL), name
        command = re.search(
            r"`(?:python (\S+\.py)(?: --out (\S+))?|elastomdr \w+(?: [^`]+)?)`", below
        )
        assert command, name
        if command[1]:
            assert (ROOT / command[1]).is_file(), name
        if command[2]:  # an example writes its figure under its own name
            assert Path(command[2]) / f"{Path(command[1]).stem}.png" == (
                page.parent / name
            ).relative_to(ROOT), name
        assert len(below) - len(command[0]) > 60, name
    assert text.count(".png)") == len(re.findall(r"\.png\)\n\n\*", text))


def test_the_page_says_what_is_recorded_and_computed_of_half_spaces():
    page = " ".join((ROOT / "docs" / "accuracy.md").read_text("utf-8").split())
    record = (ROOT / "benchmarks" / "results" / "half_space.json").read_text()
    rows = [row for row in json.loads(record)["table"] if row["E_1/E_inf"] > 0.1]
    assert len(rows) >= 7
    worst = []
    for row in rows:
        ratio, velocity, exact = row["E_1/E_inf"], row["v [m/s]"], row["mu in 3D"]
        rubber = em.Foundation(4e6, [ratio * 4e6], [1e-3])
        found = [
            em.friction(
                rubber, em.Paraboloid(0.01), velocity=velocity, load=10.0, model=model
            ).mu
            for model in (em.Averaged(corrected=False), em.Line())
        ]
        recorded = [row["direction average"], row["bare line"]]
        assert found == pytest.approx(recorded, abs=0.6e-5)
        worst.append([100 * (mu / exact - 1) for mu in found])
        if (ratio, velocity) == (3, 1):
            said = "mu = {:.5f} at 1 m/s, by the average {:.5f}, by the line {:.5f}"
            assert said.format(exact, *found) in page
    average, line = np.abs(worst).max(axis=0)
    assert (
        f"the average is at most {average:.1f} % off, the line up to {line:.0f} %"
        in page
    )


@pytest.mark.parametrize(
    "page",
    [ROOT / "CONTRIBUTING.md", ROOT / "benchmarks" / "README.md"],
    ids=lambda page: page.name,
)
def test_files_that_are_named_exist(page):
    for path in re.findall(
        r"`((?:src|tests|benchmarks|docs|materials)/[\w/.]+)`",
        page.read_text(encoding="utf-8"),
    ):
        # NAME and the toy of a recipe stand for what a reader adds
        assert re.search("NAME|/toy", path) or (ROOT / path).exists(), path


def test_citation_has_the_version_of_the_package():
    assert f"\nversion: {em.__version__}\n" in (ROOT / "CITATION.cff").read_text(
        encoding="utf-8"
    )


def test_theory_has_the_constants_of_multiscale():
    text = " ".join((ROOT / "docs" / "theory.md").read_text("utf-8").split())

    def row(numbers, digits=""):
        return " | ".join(format(value, digits) for value in numbers) + " |"

    assert "| " + row(FORM, ".3f") in text
    assert "$\\mu$ by Multiscale | " + row(multiscale._BOUND["multiscale"], "g") in text
    assert "stored | " + row(multiscale._BOUND["persson"], "g") in text
    assert "relative | " + row(multiscale._AREA_BOUND, "g") in text
    low, high = multiscale._RATIOS
    for number in (
        rf"{multiscale._DRIFT:g}\,\log_{{10}}^+\frac{{q_\mathrm{{high}}/q_\mathrm{{low}}}}{{{high:g}}}",
        f"a ratio of cutoffs below {low:g}",
        rf"{{{multiscale._CONTRAST:g}\,|E^*(",
        f"$10^{np.log10(multiscale._MOST_CONTRAST):g}$ times",
        f"the power {multiscale._MOST_SLOPE:g} of $q$",
        rf"e^{{{surface._PER_TOP[True]:g}\,|\ln\chi|+{surface._PER_TOPS:g}\,",
        rf"{surface._PER_SAMPLE:g}\,\delta s}}",
        rf"e^{{{surface._PER_LAY:g}\,\overline",
    ):
        assert number in text, number
