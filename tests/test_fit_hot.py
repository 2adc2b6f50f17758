"""Temperatures above 200 degC: of melts, of hot solids, and kelvins that are called degrees Celsius."""

import warnings

import numpy as np
import pytest

import elastomdr as em
from elastomdr.fit import FitWarning

from .test_fit_duplicates import F, L, S, T, table


def melt(celsius, size=1.0):
    """A Maxwell liquid in its terminal zone."""
    x = F / 10
    return table(
        **{"T [degC]": celsius, "f [Hz]": F, "G' [Pa]": size * x * x / (1 + x * x), "G'' [Pa]": size * x / (1 + x * x)}
    )


@pytest.mark.parametrize("celsius", [np.where(T > 0, 290.0, 230.0), np.where(T > 0, 400.0, 360.0)])
def test_melts_may_be_hot(celsius, write):
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        em.fit.read_dma(write(melt(celsius, 3e5)))
        moduli = {"G' [Pa]": S, "G'' [Pa]": L}
        em.fit.read_dma(write(table(**{"T [degC]": celsius - 200, "f [Hz]": F}, **moduli)))


def test_a_solid_may_be_hot_where_its_first_isotherms_are_not(write):
    """Blocks are judged together, each with its header."""
    parts = [table(**{"T [degC]": T + at, "f [Hz]": F, "G' [Pa]": S, "G'' [Pa]": L}) for at in (150.0, 240.0)]
    with warnings.catch_warnings():
        warnings.simplefilter("error", FitWarning)
        em.fit.read_dma(write("\n\n".join(parts)))
        em.fit.read_dma([write(part, f"{i}.csv") for i, part in enumerate(parts)])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (table(**{"T [degC]": T + 273, "f [Hz]": F, "G' [Pa]": S, "G'' [Pa]": L}), "as kelvins they would be ordinary"),
        (melt(T + 273.15, 3e5), "273.15 to 293.15 all end in .15"),
        (melt(T + 450, 3e5), "implausible for a DMA; assumed"),
    ],
)
def test_kelvins_called_degrees_are_said(text, said, write):
    with pytest.warns(FitWarning, match=said):
        em.fit.read_dma(write(text))
