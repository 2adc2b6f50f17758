"""Contact area under a smooth body that slides: (pi/2) a (a + b) from the edges of the
line, against cells.

    python benchmarks/contact_area.py

A ball and a cone on standard solids and on a broad spectrum, velocities over four to
five decades at one load. Adhesive shear acts on that area
(`em.friction(adhesion=...)`), whose `model_error` takes it to be off by 0.2 (1 - b/a)
at most.
"""

import numpy as np
from common import heading, save, table, verdict

import elastomdr as em

BODIES = {"ball": em.Paraboloid(0.01), "cone": em.Cone(0.1)}
SOLIDS = {
    "E1/E = 1": (em.StandardSolid(1e6, 1e6, 1e-2), np.geomspace(1e-3, 10, 7)),
    "E1/E = 9": (em.StandardSolid(1e6, 9e6, 1e-2), np.geomspace(1e-3, 10, 7)),
    "broad": (
        em.Prony(1e6, [5e7, 3e7, 1e7, 5e6, 2e6], np.geomspace(1e-5, 1e-1, 5)),
        np.geomspace(1e-2, 1e3, 7),
    ),
}
LAW = em.AdhesiveShear(1e5, 1.0, 0.0)
GRID = 0.003  # of an area on 96 by 96 cells


def main() -> None:
    record = heading(
        "Contact area of a sliding body against 96 by 96 cells", "load 1 N, 42 contacts"
    )
    rows = []
    for body, shape in BODIES.items():
        for solid, (rubber, velocity) in SOLIDS.items():
            scene = {"velocity": velocity, "load": 1.0, "adhesion": LAW}
            line = em.friction(rubber, shape, **scene)
            cells = em.friction(rubber, shape, model=em.HalfSpace(cells=96), **scene)
            assert line.contact is not None
            skew = line.contact.trailing / line.contact.leading
            ratio = line.contact_area / cells.contact_area
            rows += [
                (body, solid, *point)
                for point in zip(velocity, skew, ratio, strict=True)
            ]
    record["contacts"] = table(
        ("body", "rubber", "v [m/s]", "b/a", "area over that of cells"), rows
    )
    skew, off = (
        np.array([row[3] for row in rows]),
        np.array([row[4] for row in rows]) - 1,
    )
    record["rms"] = float(np.sqrt(np.mean(off**2)))
    print(f"  rms {record['rms']:.2%}")
    record["verdicts"] = [
        verdict("largest error of the area", float(np.abs(off).max()), 0.08),
        verdict(
            "share within 0.2 (1 - b/a)",
            float(np.mean(np.abs(off) <= 0.2 * abs(1 - skew) + GRID)),
            0.99,
            least=True,
        ),
    ]
    save("contact_area", record)


if __name__ == "__main__":
    main()
