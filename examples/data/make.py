"""Makes the files beside itself: synthetic measurements in the form of a laboratory's."""

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
        noisy = (
            1e-6
            * np.array([modulus.real, modulus.imag])
            * (1 + 0.01 * rng.normal(size=2))
        )
        rows.append(f"{celsius:.1f},{hertz:.3f},{noisy[0]:.4f},{noisy[1]:.4f}")
(here / "dma.csv").write_text(
    "\n".join(["Temperature [degC],Frequency [Hz],E' [MPa],E'' [MPa]", *rows]) + "\n"
)

# C(q) of a self-affine surface, H = 0.8, from 20 mm to 2 um, 5 % noise.
q = np.geomspace(3e2, 3e6, 61)  # [rad/m]
# [m^4]
c = 6e-16 * np.maximum(q / 2e3, 1) ** -3.6 * (1 + 0.05 * rng.normal(size=q.size))
rows = [f"{a:.5e},{b:.4e}" for a, b in zip(q, c, strict=True)]
(here / "road.csv").write_text(
    "\n".join(["# asphalt, synthetic", "q [rad/m],C [m^4]", *rows]) + "\n"
)

# Friction of that rubber on that road, read off a curve of em.friction (50 um, 0.3 MPa)
# with 5 % noise.
speeds, computed = (
    (1, 10, 100, 1000),
    {
        0: (0.200, 0.219, 0.227, 0.229),
        20: (0.123, 0.162, 0.196, 0.217),
        60: (0.0405, 0.0688, 0.103, 0.143),
    },
)
rows = [
    f"{speed},{celsius},{mu * (1 + 0.05 * rng.normal()):.4f}"
    for celsius, values in computed.items()
    for speed, mu in zip(speeds, values, strict=True)
]
(here / "friction.csv").write_text(
    "\n".join(["# synthetic", "velocity [mm/s],temperature [degC],mu", *rows]) + "\n"
)

# The same rubber as an instrument's export (the layout of a TA Q800, latin-1),
# temperatures that scatter by 0.1 K.
head = [
    "Version\t2.0",
    "Instrument\tDMA Q800 V21.1 Build 51",
    "Module\tDMA Multi-Frequency - Strain",
    "Nsig\t6",
    "Sig1\tTime (min)",
    "Sig2\tTemperature (°C)",
    "Sig3\tFrequency (Hz)",
    "Sig4\tStorage Modulus (MPa)",
    "Sig5\tLoss Modulus (MPa)",
    "Sig6\tTan Delta",
    "Size\t10 x 5 x 2 mm",
    "StartOfData",
]
rows = []
for celsius in range(-40, 61, 10):
    shift = 10 ** (-8.86 * (celsius - 20) / (101.6 + celsius - 20))
    for hertz in np.geomspace(0.1, 50, 9):
        x = 2j * np.pi * hertz * shift * tau
        modulus = 1e-6 * (3e6 + np.sum(branches * x / (1 + x)))
        storage, loss = np.array([modulus.real, modulus.imag]) * (
            1 + 0.01 * rng.normal(size=2)
        )
        when, warm = 0.5 * (len(rows) + 1), celsius + 0.1 * rng.normal()
        rows.append(
            f"{when:.3f}\t{warm:.2f}\t{hertz:.4g}\t{storage:.5g}\t{loss:.5g}\t{loss / storage:.5f}"
        )
(here / "dma-q800.txt").write_bytes("\n".join([*head, *rows, ""]).encode("latin-1"))

# Heights along 10 mm of a ground surface, as a stylus exports them: semicolons and
# decimal commas.
count, step = 2048, 5e-6  # -, [m]
q = 2 * np.pi * np.fft.rfftfreq(count, step)
waves = np.maximum(q, 1.5e3) ** -1.3 * np.exp(2j * np.pi * rng.random(q.size)) * (q > 0)
height = np.fft.irfft(waves)
height *= 30e-6 / height.std()
rows = [
    f"{1e3 * step * i:.4f};{1e6 * h:.3f}".replace(".", ",")
    for i, h in enumerate(height)
]
(here / "profile.csv").write_text("\n".join(["x [mm];z [um]", *rows, ""]))
