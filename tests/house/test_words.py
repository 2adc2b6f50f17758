"""Words that have been replaced do not come back: in pages, on the page of the app, in
messages.
"""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
INSTEAD = {  # pattern: what to write
    "made[ -]up (?!for)": "synthetic, or illustrative",
    "stand for your": "replace them by yours",
    "an end of the range": "the highest (lowest) velocity computed",
    "excited (at|beyond)": "outside the measured frequency range",
    "(the|exact) thermometers?": "error of the measured temperatures",
    "how much does an? [a-z-]+ brake": "how much friction does it cause",
    "(loss|friction) goes with": "is proportional to, or scales with",
    "friction bands": "friction by frequency (em.friction_spectrum)",
    "temperature (rise )?in kelvins": "temperature [K]",
    "(cases|temperatures?) looked at": "examined, or considered",
    "taken off": "subtracted",
    "is told": "says, or is given",
    "does not speak of": "does not cover",
    "dented": "indented",
    "(the )?farther of (both|the two)": "whichever is farther away",
    "(is|are|was|were) held against": "compared with",
    "has it computed": "computes it",
    "brakes more": "causes more friction",
    "granted to": "allowed for",
    "knows? nothing of each other": "are independent",
    "searches with numbers": "needs concrete numbers",
    "takes the heights for": "assumes heights to be",
    "warned of": "raises a warning, or say what the warning is",
}
TEXTS = [
    *(ROOT / name for name in ("README.md", "CONTRIBUTING.md", "materials/README.md")),
    ROOT / "examples" / "data" / "README.md",
    *sorted((ROOT / "docs").glob("*.md")),
    *sorted((ROOT / "src" / "elastomdr").rglob("*.py")),
]


@pytest.mark.parametrize("pattern", INSTEAD)
def test_is_not_written(pattern):
    word = re.compile(rf"\b{pattern}\b".replace(" ", r"\s+"), re.IGNORECASE)
    where = [
        f"{path.relative_to(ROOT)}: {found[0]}"
        for path in TEXTS
        for found in word.finditer(path.read_text(encoding="utf-8"))
    ]
    assert not where, f"write: {INSTEAD[pattern]}"
