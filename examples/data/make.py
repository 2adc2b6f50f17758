"""Makes dma.csv, road.csv and friction.csv beside itself: made-up measurements in the form of a laboratory's."""

from pathlib import Path

import numpy as np

here = Path(__file__).parent
rng = np.random.default_rng(7)

# A generalised Maxwell body, WLF about 20 degC, 1 % noise.
tau = np.geomspace(1e-12, 1e2, 29)  # [s]
branches = 3e8 * (tau / tau[0]) ** -0.25  # [Pa]
rows = []
for celsius in range(-20, 61, 10):
    shift = 10 ** (-8.86 * (celsius - 20) / (101.6 + celsius - 20))
    for hertz in np.geomspace(0.2, 100, 10):
        x = 2j * np.pi * hertz * shift * tau
        modulus = 3e6 + np.sum(branches * x / (1 + x))
        noisy = 1e-6 * np.array([modulus.real, modulus.imag]) * (1 + 0.01 * rng.normal(size=2))
        rows.append(f"{celsius:.1f},{hertz:.3f},{noisy[0]:.4f},{noisy[1]:.4f}")
(here / "dma.csv").write_text("\n".join(["Temperature [degC],Frequency [Hz],E' [MPa],E'' [MPa]", *rows]) + "\n")

# C(q) of a self-affine surface, H = 0.8, from 20 mm to 2 um, 5 % noise.
q = np.geomspace(3e2, 3e6, 61)  # [rad/m]
c = 6e-16 * np.maximum(q / 2e3, 1) ** -3.6 * (1 + 0.05 * rng.normal(size=q.size))  # [m^4]
rows = [f"{a:.5e},{b:.4e}" for a, b in zip(q, c, strict=True)]
(here / "road.csv").write_text("\n".join(["# asphalt, made up", "q [rad/m],C [m^4]", *rows]) + "\n")

# Friction of that rubber on that road, read off a curve of em.friction (50 um, 0.3 MPa) with 5 % noise.
speeds, computed = (1, 10, 100, 1000), {0: (0.200, 0.219, 0.227, 0.229), 20: (0.123, 0.162, 0.196, 0.217),
                                        60: (0.0405, 0.0688, 0.103, 0.143)}  # fmt: skip
rows = [
    f"{speed},{celsius},{mu * (1 + 0.05 * rng.normal()):.4f}"
    for celsius, values in computed.items()
    for speed, mu in zip(speeds, values, strict=True)
]
(here / "friction.csv").write_text("\n".join(["# made up", "velocity [mm/s],temperature [degC],mu", *rows]) + "\n")
