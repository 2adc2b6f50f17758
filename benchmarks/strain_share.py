"""How strained the rubber is that waves of a rough surface deform, over the rms slope up
to them: the `strain_share` of `em.friction` with a softening.

    python benchmarks/strain_share.py

Elastic, incompressible half-space on random maps in three dimensions. Below a
displacement u(k) of the surface the strains at depth z are

    eps_ab = k_a k_b z exp(-k z) u,    eps_zz = -k^2 z exp(-k z) u,
    eps_az = i k_a k z exp(-k z) u,

(a, b in the plane; Boussinesq's problem at nu = 1/2). With gamma^2 = 2 eps_ij eps_ij, so
that gamma is the amplitude of a sweep in shear, the share of the waves of an octave is
the mean of gamma, of all waves, weighted by the energy of those of the octave, over the
rms slope of the surface up to there. Strain in tension is gamma/sqrt(3).
One wave in full contact has s exp(-s) at depth s/k: 64/27 sqrt(2) exp(0)/4 of its rms
slope, 0.84.
"""

import itertools

import numpy as np
from common import heading, save, table, verdict

import elastomdr as em
from elastomdr.rough import half_space

CELLS, PER_WAVE = 256, 8
SURFACES = {
    "H 0.8": (0.8, None),
    "H 0.5": (0.5, None),
    "H 1.0": (1.0, None),
    "H 0.8, roll-off": (0.8, 4.0),
}
LEVELS = (0.02, 0.05, 0.15, 0.5, 1.5, 20.0)  # pressure over E* times the rms slope
DEPTHS = 16  # to an octave: 2
SEEDS = 2


def heights(spectrum: em.Spectrum, side: float, seed: int) -> np.ndarray:
    """A periodic map [m] with the spectrum, its phases random."""
    k = 2 * np.pi * np.fft.fftfreq(CELLS, side / CELLS)
    q = np.hypot(k[:, None], k[None])
    amplitude = np.sqrt(spectrum.at(q)) * 2 * np.pi / side
    phase = np.random.default_rng(seed).uniform(0, 2 * np.pi, q.shape)
    return np.real(np.fft.ifft2(amplitude * np.exp(1j * phase))) * CELLS**2 * 2**0.5


def strains(u: np.ndarray, side: float, z: float, keep: np.ndarray) -> np.ndarray:
    """gamma^2 at depth z [m] below displacements `u` (Fourier), of the waves to keep."""
    k = 2 * np.pi * np.fft.fftfreq(CELLS, side / CELLS)
    kx, ky = k[:, None], k[None]
    q = np.hypot(kx, ky)
    on = np.where(keep, z * np.exp(-q * z) * u, 0.0)
    parts = (
        (kx**2, 1.0),
        (ky**2, 1.0),
        (q**2, 1.0),
        (kx * ky, 2.0),
        (1j * kx * q, 2.0),
        (1j * ky * q, 2.0),
    )
    return sum(
        2 * times * np.real(np.fft.ifft2(factor * on)) ** 2 for factor, times in parts
    )


def shares(
    heights_: np.ndarray, side: float, level: float, slope: float
) -> tuple[float, dict[float, float]]:
    """The real contact, and rms-normalised strain by octave [rad/m]."""
    found = half_space.solve(
        lambda w: np.ones_like(w) + 0j,
        heights_,
        (side, side),
        velocity=1.0,
        pressure=level * slope,
    )
    k = 2 * np.pi * np.fft.fftfreq(CELLS, side / CELLS)
    q = np.hypot(k[:, None], k[None])
    spread = np.fft.fft2(found.pressure)
    u = np.where(q > 0, 2 * spread / np.where(q > 0, q, 1.0), 0.0)
    lowest, highest = 2 * np.pi / side * 4, 2 * np.pi * CELLS / side / PER_WAVE
    octaves = np.geomspace(lowest, highest, round(np.log2(highest / lowest)) + 1)
    out = {}
    surface = np.abs(np.fft.fft2(heights_)) ** 2
    for low, high in itertools.pairwise(octaves):
        band = (q >= low) & (q < high * (1 + 1e-9))
        upper = np.sqrt((q**2 * surface)[(q < np.sqrt(low * high))].sum()) / CELLS**2
        weight = above = 0.0
        for z in np.geomspace(0.1 / high, 6.0 / low, DEPTHS):
            own = strains(u, side, z, band)
            weight += z * own.sum()
            above += z * (own * np.sqrt(strains(u, side, z, q > 0))).sum()
        out[float(np.sqrt(low * high))] = above / weight / upper
    return found.area, out


def main() -> None:
    record = heading(
        "Strain of the rubber that a wave deforms, over the rms slope up to it",
        f"elastic maps of {CELLS} x {CELLS} cells, strain in shear",
    )
    side = 1.0
    low, high = 2 * np.pi * 4 / side, 2 * np.pi * CELLS / side / PER_WAVE
    rows = []
    for (name, (hurst, off)), level in itertools.product(SURFACES.items(), LEVELS):
        road = em.SelfAffine(
            hurst,
            rms_slope=0.1,
            q_low=low,
            q_high=high,
            **({} if off is None else {"q_rolloff": off * low}),
        )
        for seed in range(SEEDS):
            area, by_octave = shares(heights(road, side, seed), side, level, 0.1)
            rows += [(name, seed, area, q / low, s) for q, s in by_octave.items()]
    record["points"] = rows
    contact = np.array([row[2] for row in rows])
    share = np.array([row[4] for row in rows])
    ends = (0.0, 0.03, 0.1, 0.3, 0.9, 1.1)
    summary = []
    for least, most in itertools.pairwise(ends):
        some = share[(contact >= least) & (contact < most)]
        if some.size:
            summary.append(
                (least, most, some.size, *np.quantile(some, (0.025, 0.5, 0.975)))
            )
    record["bands"] = table(
        ("contact from", "to", "points", "2.5 %", "median", "97.5 %"), summary
    )
    whole = np.quantile(share, (0.025, 0.5, 0.975))
    record["all"] = [float(x) for x in whole]
    print("  all:", whole, "in tension:", whole / 3**0.5)
    record["verdicts"] = [
        verdict(
            "spread about the median, a factor",
            float(max(whole[2] / whole[1], whole[1] / whole[0])),
            2.0,
        )
    ]
    save("strain_share", record)


if __name__ == "__main__":
    main()
