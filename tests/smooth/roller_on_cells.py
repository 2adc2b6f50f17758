"""A cylinder of finite length that rolls steadily on a layer, in three dimensions, on
cells of constant pressure: what its ends change, to judge the bound of
`smooth.cylinder`.

Cells and influence functions are those of `em.reference.layer_sliding`. The rubber goes
on beyond the ends, which are sharp.

    python -m tests.smooth.roller_on_cells     # the map of docs/accuracy.md, 10 minutes
"""

from __future__ import annotations

import itertools
import warnings

import numpy as np

import elastomdr as em
from elastomdr.element.layer import Layer
from elastomdr.material.relaxation import scaled, to_kelvin
from elastomdr.reference.half_space import cover_of, foundation_of
from elastomdr.reference.kernel import (
    area_cell,
    convolution,
    sliding_kernel,
    work_against,
)
from elastomdr.rough.half_space import EXACT, settle
from elastomdr.trees import replaced

_WINDOW = 1.35  # half of it, over the longer of the two edges in plane strain
_FAR = 13.9  # thicknesses beyond which the surface of a layer does not move


def roller_on_cells(
    layer: Layer,
    roller: em.Cylinder,
    velocity: float,
    load: float,
    reach: float,
    cells: tuple[int, int],
) -> float:
    """Resistance over load on `cells` along and across the motion, over -`reach` to
    `reach` [m] and the length of the roller. `ValueError` where they do not settle.
    """
    law = foundation_of(layer).law()
    law, stress = scaled(law, 1 / float(law.equilibrium)), float(law.equilibrium)
    cover = cover_of(layer)
    cover = replaced(cover, thickness=cover.thickness / reach)
    length, (along, across) = float(roller.length) / reach, cells
    h, width = 2 / along, length / across
    x, y = h * (np.arange(along) + 0.5) - 1, (np.arange(across) * width)[None]

    def elastic(places: np.ndarray) -> np.ndarray:
        r = np.hypot(places[:, None], y)
        less = cover.less(r, (h, width))
        whole = area_cell(places[:, None], y, h, width)
        return np.where(r < _FAR * cover.thickness, whole - less, 0.0)

    speed = velocity / reach
    kernel = sliding_kernel(elastic, to_kelvin(law), speed, h, along, 0.0)
    waves = convolution(kernel.displacement, law, speed, (h, width), 0.0, cover)
    rise = -(x**2) * reach / (2 * float(roller.radius))
    contact = settle(
        waves,
        np.repeat(rise[:, None], across, 1),
        np.repeat(np.abs(x)[:, None] < 0.6, across, 1).astype(float),
        EXACT,
        load=load / stress / reach**2 / (h * width),
        depth=None,
    )
    pressure = contact.pressure
    if not contact.settled or pressure[[0, -1]].any():
        raise ValueError("the contact does not settle, or reaches the end of its cells")
    return work_against(kernel.slope, pressure) / pressure.sum()


def of_bound(
    layer: Layer, radius: float, velocity: float, line: float, length: float, along: int
) -> tuple[float, float, float]:
    """What the ends change of the resistance under `line` [N/m], relatively, on as many
    cells along the motion and on half of them, and the bound.
    """
    roller = em.Cylinder(radius, length)
    flat = em.rolling(layer, roller, velocity=velocity, load=line * length, rtol=1e-4)
    reach = _WINDOW * float(max(flat.contact.leading, flat.contact.trailing))
    off = []
    for n in (along, along // 2):
        across = min(max(48 * n // along, round(length / (2 * reach) * n)), 4 * n)
        solid = roller_on_cells(
            layer, roller, velocity, line * length, reach, (n, across)
        )
        off.append(solid / float(flat.coefficient) - 1)
    return *off, float(flat.model_error / flat.coefficient)


def _line(layer: Layer, radius: float, velocity: float, half: float) -> float:
    """Load per length under which half the contact is that wide, to 5 %."""
    line = 1e3
    for _ in range(8):
        pair = em.rolling(
            layer, em.Cylinder(radius, 1.0), velocity=velocity,
            load=[line, 1.05 * line], rtol=1e-2,
        )  # fmt: skip
        wide = 0.5 * (pair.contact.leading + pair.contact.trailing)
        power = np.log(1.05) / np.log(wide[1] / wide[0])
        line *= float(np.clip((half / wide[0]) ** power, 1e-2, 1e2))
        if abs(wide[0] / half - 1) < 0.05:
            break
    return line


def main() -> None:
    warnings.simplefilter("ignore", em.ModelWarning)
    radius, h, tau = 0.5, 6e-3, 1e-3
    covers = {
        f"contrast {contrast:g}, Poisson's ratio {nu:g}, {base}": em.layer(
            em.Prony(1e6, [contrast * 1e6], [tau], poisson=nu), h, bonded=base[0] == "b"
        )
        for contrast, nu, base in (
            *itertools.product((0.1, 10, 1000), (0.3, 0.45, 0.5), ("bonded", "slips")),
        )
    }
    decades = np.logspace(-7, 1, 17)
    covers["broad, bonded"] = em.layer(
        em.Prony(1e6, 2e6 * np.geomspace(6, 1 / 6, 17), decades), h
    )
    for name, layer in covers.items():
        most = 0.0
        for wide, speed in itertools.product(
            (0.04, 0.15, 0.5, 1.0, 2.0, 5.5), (0.3, 3.0)
        ):
            velocity = speed * wide * h / tau
            line = _line(layer, radius, velocity, wide * h)
            for length in (7 * (wide + 0.25) * h, 20 * (wide + 0.25) * h):
                fine, _, bound = of_bound(layer, radius, velocity, line, length, 40)
                most = max(most, abs(fine) / bound)
        print(f"{name}: at most {most:.2f} of the bound", flush=True)


if __name__ == "__main__":
    main()
