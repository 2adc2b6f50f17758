"""Small inputs in the structure of files that people have: made in a test, and of
../shared/cases beside the repository where that is.
"""

import os
from pathlib import Path

CASES = Path(
    os.environ.get("ELASTOMDR_CASES", Path(__file__).parents[3] / "shared" / "cases")
)


def twins(folder, name, text):
    """The paths of a file that is made of `text`, and of the one that it is like."""
    made = folder / name
    made.write_text(text)
    return [path for path in (made, CASES / name) if path.is_file()]
