"""Where the sample files are: made-up DMA, road and measured friction, one click
away.
"""

from pathlib import Path

# where the wheel has them; a checkout has them among its examples
_OWN = Path(__file__).parent / "data"
SAMPLE = _OWN if _OWN.is_dir() else Path(__file__).parents[3] / "examples" / "data"
