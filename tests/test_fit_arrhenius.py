"""Shift factors that follow Arrhenius' law, of a spectrum of sharp lines: stated intervals hold them."""

import numpy as np

import elastomdr as em

from .dma_files import measure

LAW = em.Arrhenius(2e5, 293.15)
RUBBER = em.Prony(4e5, np.geomspace(4e7, 3e5, 9), np.geomspace(1e-8, 1.0, 9), shift=LAW)


def test_intervals_hold_shift_factors_of_arrhenius():
    """A steep law, and one sharp line a decade: lines that lie between the times of the grid must not draw the
    isotherms apart. Of 48 shift factors from eight laboratories 40 at least are held.
    """
    held = []
    for seed in range(8):
        rows = measure(RUBBER, np.arange(-20.0, 41.0, 10.0), np.geomspace(0.1, 50.0, 11), 0.005, seed)
        dma = em.fit.dma(2 * np.pi * rows[:, 0], rows[:, 2], rows[:, 3], rows[:, 1] + 273.15, kind="shear")
        found = em.fit.master_curve(dma, 293.15)
        low, high = found.log10_a_interval.T
        truth, away = np.asarray(LAW.log10_a(found.temperature)), np.abs(found.temperature - 293.15) > 0.1
        held += ((low <= truth) & (truth <= high))[away].tolist()
    assert sum(held) >= 40
