"""Measurements made again at the same temperature and frequency that differ: another
sample, strain or pass.
"""

from collections.abc import Iterator

import numpy as np

from ..io.data import Dma, describe_list

_SAME_RATE = 0.01  # of ln(omega), within which two frequencies are one,
_SAME_PLACE = 0.3  # and two temperatures [K]: modulus may change by a tenth per kelvin
_FEWEST = 3  # repeated points of an isotherm that say anything
# mean ln of the ratio of last to first above which they differ, and beyond
_DIFFERENT = 0.04
_SURE = 3.0  # so many of its standard errors


def contradicting_repeats(
    dma: Dma, isotherm: np.ndarray, temperature: np.ndarray
) -> Iterator[str]:
    """A warning on isotherms whose repeated points differ on the whole, not by noise;
    `isotherm` numbers the dynamic points of `dma`, in its order, and `temperature` [K]
    is that of each isotherm.
    """
    first: dict[tuple[int, int], list[int]] = {}
    ratios: dict[int, list[np.ndarray]] = {}
    level = np.log(np.stack([dma.storage, dma.loss]))
    for i, key in enumerate(
        zip(isotherm, np.round(np.log(dma.omega) / _SAME_RATE), strict=True)
    ):
        place = int(key[0]), int(key[1])
        known = first.setdefault(place, [])
        met = next(
            (
                j
                for j in known
                if abs(dma.temperature[i] - dma.temperature[j]) <= _SAME_PLACE
            ),
            None,
        )
        if met is None:
            known.append(i)
        else:
            ratios.setdefault(place[0], []).append(level[:, i] - level[:, met])
    found: dict[float, float] = {}
    for number, each in ratios.items():
        if len(each) < _FEWEST:
            continue
        mean, error = (
            np.mean(each, axis=0),
            np.std(each, axis=0, ddof=1) / np.sqrt(len(each)),
        )
        differs = np.abs(mean) > np.maximum(_DIFFERENT, _SURE * error)
        if differs.any():
            found[float(temperature[number] - 273.15)] = float(
                np.abs(np.expm1(mean[differs])).max()
            )
    if found:
        yield (
            f"Points are repeated at {describe_list(sorted(found), 'degC')}, and "
            f"differ from those before by up to {100 * max(found.values()):.2g} % on "
            "average: another sample, strain or pass? All are taken for "
            "one material, whose shifts and moduli are a compromise; leave out what "
            "does not belong to it."
        )
