"""Materials drawn from what is not known of one: a list of them is computed as one
material with a band.

Of a material whose file records how far it is from its data, band by band, the draws
are the same series with its moduli off by as much: relative deviations of storage and
loss modulus, normal, of that size, which resemble each other over a decade of
frequency. What else is not known, such as the shift factors, a file does not record.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeVar

import numpy as np

from ..checks import is_traced
from ..errors import InputError
from ..trees import replaced

_DECADES = 0.5  # distance at which deviations have a correlation of exp(-1/2)
# of a modulus's logarithm: changes that no frequency of the data sees are left out
_RIDGE = 1e-2

T = TypeVar("T")


class Draws(list[T]):
    """Draws of one material or of one surface, with its name and, in words, what they
    were drawn from.
    """

    def __init__(self, each: Iterable[T], name: str, words: str):
        super().__init__(each)
        self.name, self.words = name, words

    def __reduce__(self) -> Any:
        return type(self), (list(self), self.name, self.words)


def check_draws(n: Any, seed: Any) -> None:
    """Raises `InputError` unless they are whole numbers, of draws at least two."""
    for name, value, least in (("n", n, 2), ("seed", seed, 0)):
        if (
            isinstance(value, bool)
            or not isinstance(value, (int, np.integer))
            or value < least
        ):
            raise InputError(
                f"{name} must be a whole number, {least} or more, got {value!r}."
            )


def drawn_from_misfit(material: Any, n: int, seed: int) -> Draws:
    """Draws of a series from its recorded misfit. Raises `InputError` where it has
    none.
    """
    check_draws(n, seed)
    rows = () if material.range is None else material.range.misfit
    if not rows or is_traced(material):
        raise InputError(
            "material must have a record of how far it is from its data ([misfit] in "
            f"its file), got {material!r}: "
            "nothing says how uncertain it is. em.fit.material(...).draws(n) draws "
            "from the data."
        )
    omega, *sizes = np.array(rows).T
    apart = np.subtract.outer(np.log10(omega), np.log10(omega)) / _DECADES
    root = root_of(np.exp(-0.5 * apart**2))
    rng = np.random.default_rng(seed)
    off = np.concatenate(
        [size * (rng.standard_normal((n, omega.size)) @ root.T) for size in sizes],
        axis=1,
    )
    changes = off @ by_moduli(material, omega).T
    each = [changed(material, change, i) for i, change in enumerate(changes, 1)]
    return Draws(
        each, material.name, "recorded misfit to its data; shift factors as they are"
    )


def root_of(covariance: np.ndarray) -> np.ndarray:
    """R with R R^T the covariance."""
    values, vectors = np.linalg.eigh(covariance)
    return vectors * np.sqrt(np.maximum(values, 0.0))


def by_moduli(material: Any, omega: np.ndarray) -> np.ndarray:
    """Takes changes of ln storage and ln loss modulus at `omega` to changes of ln
    equilibrium and ln moduli.
    """
    x = omega[:, None] * np.asarray(material.times)
    parts = np.asarray(material.moduli) / (1 + x**2)
    slow = np.full((omega.size, 1), float(material.equilibrium))
    seen = np.concatenate(
        [
            np.hstack([slow, parts * x**2])
            / np.asarray(material.storage(omega))[:, None],
            np.hstack([0 * slow, parts * x])
            / np.asarray(material.loss(omega))[:, None],
        ]
    )
    return np.linalg.solve(seen.T @ seen + _RIDGE * np.eye(seen.shape[1]), seen.T)


def changed(material: Any, change: np.ndarray, number: int, **laws: Any) -> Any:
    """A draw: equilibrium and moduli times exp(change), with laws of shifts of its own.

    It has no misfit, which would otherwise be counted twice: among the draws, and in
    the error of each.
    """
    factors = np.exp(change)
    known = None if material.range is None else material.range._replace(misfit=())
    name = f"draw {number} of {material.name}" if material.name else f"draw {number}"
    return replaced(
        material,
        equilibrium=np.asarray(material.equilibrium * factors[0]),
        moduli=material.moduli * factors[1:],
        name=name,
        range=known,
        **laws,
    )
