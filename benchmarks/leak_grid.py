"""How much the cells of a map hold back: `python benchmarks/leak_grid.py [--minutes 30]`.

A map of four cells per shortest wave leaks less than the same map on finer cells: cells
in contact are counted whole, and the narrowest places of channels are a cell wide. Here
the maps of every second surface of `leak_maps.py` that fits on 256 cells are solved on
four and on eight cells per shortest wave, the same waves by Fourier's series. The error
falls as the square of the cell (twelve cells agree), so that the limit lies a third of
the change beyond eight. Kept in `results/leak_grid.json`; `leak_fit.py` corrects its
truth by it.
"""

import argparse
import json
import time

import numpy as np
from common import RESULTS
from leak_maps import SURFACES, carried, grid_of, levels, spectrum_of, surface

from elastomdr.seal.gap_maps import flow, pressed
from elastomdr.surface.spectrum import rough_map

FILE = RESULTS / "leak_grid.json"


def refined(heights: np.ndarray) -> np.ndarray:
    """The same waves on cells half as wide."""
    count = len(heights)
    place = np.fft.fftfreq(count, 1 / count).astype(int) % (2 * count)
    waves = np.zeros((2 * count, 2 * count), complex)
    waves[np.ix_(place, place)] = np.fft.fft2(heights)
    return 4 * np.fft.ifft2(waves).real


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--minutes", type=float, default=30.0)
    end = time.monotonic() + 60 * parser.parse_args().minutes
    kept = json.loads(FILE.read_text()) if FILE.exists() else {}
    for number in range(0, SURFACES, 2):
        spectrum = spectrum_of(**surface(number))
        grid = grid_of(spectrum, 64)
        if grid is None or str(number) in kept:
            continue
        if time.monotonic() > end:
            return
        heights, side = rough_map(spectrum, 0, periods=grid.periods, points=grid.cells)
        level = levels()[carried(spectrum, grid)]
        flows = [
            [
                float(np.mean(flow(pressed(each, side, one).gap).conductance))
                for one in level
            ]
            for each in (heights, refined(heights))
        ]
        kept[str(number)] = {
            "level": level.tolist(),
            "four": flows[0],
            "eight": flows[1],
        }
        FILE.write_text(json.dumps(kept) + "\n")
        print(number, np.round(np.log(np.divide(flows[1], flows[0])), 3), flush=True)


if __name__ == "__main__":
    main()
