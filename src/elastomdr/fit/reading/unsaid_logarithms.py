"""Whether moduli under plain titles are decadic logarithms of moduli in Pa."""

from collections.abc import Iterator, Mapping

import numpy as np

from .columns import Column
from .swapped import closer

_LOWEST, _HIGHEST = 2.0, 11.0  # log10 of any modulus of a polymer in Pa
_MISFIT = 0.1  # rms relative misfit as read above which numbers are suspect, if their powers of ten are much closer


def unsaid_logarithms(
    arrays: Mapping[str, np.ndarray], numbers: Mapping[str, list[float]], chosen: Mapping[str, Column]
) -> Iterator[str]:
    """A warning where storage and loss modulus suit no passive material as read, and one if they are log10 of Pa.

    `arrays` in SI units and `numbers` as in the file, by role. Only numbers that could be such logarithms are looked
    at.
    """
    storage, loss = (np.array(numbers[role]) for role in ("storage", "loss"))
    both = np.concatenate([storage, loss])
    if both.min() < _LOWEST or both.max() > _HIGHEST or chosen["storage"].log or chosen["loss"].log:
        return
    rate = arrays["omega" if "omega" in arrays else "frequency"]
    temperature = arrays.get("temperature", np.zeros(rate.size))
    named = arrays["storage"], arrays["loss"]
    if closer(temperature, rate, named, [(10**storage, 10**loss), (named[1], named[0])], _MISFIT)[:1] == [0]:
        yield (
            f"{chosen['storage'].title!r} and {chosen['loss'].title!r} suit no passive material as they are named, and "
            "one if they are decadic logarithms of moduli in Pa. Assumed are the names; if they are wrong, write log10 "
            "and [Pa] into the titles."
        )
