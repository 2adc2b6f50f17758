"""Strain softening of filled rubber (Payne effect): factors on the moduli against the
amplitude of strain.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import xp
from ..checks import (
    Array,
    alike,
    as_float64,
    ascending,
    certain,
    is_traced,
    not_negative,
    numpy_unless_traced,
    positive,
    written,
)
from ..errors import InputError, ModelWarning, warn
from ..numerics.interpolation import hermite, monotone_slopes
from ..trees import Tree, fill

if TYPE_CHECKING:
    from jaxtyping import Float

    from .._types import ArrayLike, ComplexArray

_LARGEST = 5.0  # strain amplitude above which a number is taken for one in per cent
# factor on the loss modulus above which a number is taken for another quantity
_MOST = 10.0
# distance of measured factors from such as fall that is taken for noise
_NOISE, _ROUNDING = 0.05, 1e-12


class Softening(Tree):
    """Factors on storage and loss modulus by the amplitude of strain, as a strain sweep
    shows them.

    The material's own moduli are those of small strain; at the amplitude eps they are
    f(eps) G' and g(eps) G''. With a `complex` modulus M, `softening.of(M, eps)` is f Re
    M + i g Im M; a model picks eps from its contact, calls that, and flags what
    `softening.outside(eps)` tells to lie beyond the sweep.

    Args:
        strain: amplitudes of strain, ascending, shape (n,), n >= 2 [1]; 0.1 for 10 %. On
            a rough surface they are taken for those of shear: multiply those of a sweep
            in tension or compression by the root of 3.
        storage: factors f on the storage modulus, above 0 and at most 1, that fall or
            stay level from entry to entry. Of measured ones that rise, or exceed 1, by
            up to 5 % the nearest that fall are taken (least squares), with a warning.
        loss: factors g on the loss modulus, above 0 and at most 10. They may exceed 1:
            where the filler's network breaks up and forms again within a cycle more is
            lost than at small strain, up to about three times as much. Above 10 a
            number is taken for another quantity.

    Between the points the factors follow monotone cubics (Fritsch and Carlson 1980)
    against log strain. Below the first one they go to 1 as the strain itself, 1 - (1 -
    f_1) eps/eps_1; beyond the last one they are held. They do not depend on frequency
    and temperature, as is usual: the moduli follow time-temperature superposition, the
    factors stay. They hold for shear and tensile moduli alike, exactly so with a
    constant Poisson's ratio. Source: A. R. Payne, J. Appl. Polym. Sci. 6 (1962) 57; G.
    Kraus, J. Appl. Polym. Sci.: Appl. Polym. Symp. 39 (1984) 75.

    Raises:
        InputError: for lists that do not match, a strain that looks like per cent,
            factors outside what is said above.
    """

    strain: Float[Array, " n"]
    storage: Float[Array, " n"]
    loss: Float[Array, " n"]

    def __init__(self, strain: ArrayLike, storage: ArrayLike, loss: ArrayLike):
        given = {"strain": strain, "storage": storage, "loss": loss}
        lists = {key: as_float64(key, value) for key, value in given.items()}
        alike(2, lists)
        for key, values in lists.items():
            positive(key, values)
        strain, storage, loss = lists.values()
        ascending("strain", strain)
        if certain(lambda x: x[-1] > _LARGEST, strain):
            raise InputError(
                argument="strain",
                got=float(strain[-1]),
                accepted=f"an amplitude without unit, {_LARGEST:g} at most (0.1 for "
                "10 %)",
                hint="divide per cent by 100",
            )
        if not is_traced(storage):
            storage = _falling(np.asarray(storage))
        if certain(lambda g: g.max() > _MOST, loss):
            raise InputError(
                argument="loss",
                got=float(loss.max()),
                accepted=f"factors on the loss modulus of small strain, {_MOST:g} at "
                "most",
            )
        fill(self, strain=strain, storage=storage, loss=loss)

    @numpy_unless_traced
    def factors(self, strain: ArrayLike) -> tuple[Array, Array]:
        """Factors on storage and loss modulus at amplitudes of strain >= 0 [1], any
        shape.
        """
        strain = as_float64("strain", strain)
        not_negative("strain", strain)
        storage, loss = self._factors_at(strain)
        return storage, loss

    @numpy_unless_traced
    def of(self, modulus: ArrayLike | complex, strain: ArrayLike) -> ComplexArray:
        """A complex modulus at amplitudes of strain: its parts times their factors; the
        two broadcast.
        """
        storage, loss = self.factors(strain)
        modulus = xp.asarray(modulus)
        return storage * xp.real(modulus) + 1j * loss * xp.imag(modulus)

    @numpy_unless_traced
    def outside(self, strain: ArrayLike) -> Array:
        """Whether amplitudes of strain lie beyond the last one of the sweep, where the
        factors are held.
        """
        return xp.asarray(strain) > self.strain[-1]

    def _factors_at(self, strain: Array) -> Array:
        """Both factors, (2, ...)."""
        nodes = xp.log(self.strain)
        values = xp.stack([self.storage, self.loss])
        slopes = monotone_slopes(nodes, values)
        # At the first point the slope of the line to the origin, as far as it keeps the
        # cubics monotone; none at the last one, where the factor is held.
        first = values[:, 0] - 1
        most = 3 * (values[:, 1] - values[:, 0]) / (nodes[1] - nodes[0])
        least = xp.sign(most) * xp.minimum(abs(first), abs(most))
        first = xp.where(first * most > 0, least, 0.0)
        slopes = xp.concatenate(
            [first[:, None], slopes[:, 1:-1], xp.zeros((2, 1))], axis=1
        )
        log_strain = xp.log(xp.maximum(strain, 1e-300))
        inside = hermite(
            nodes, values, slopes, xp.clip(log_strain, nodes[0], nodes[-1])
        )
        missing = (1 - values[:, 0]).reshape(2, *[1] * strain.ndim)
        below = 1 - missing * strain / self.strain[0]
        return xp.where(strain < self.strain[0], below, inside)

    def __repr__(self) -> str:
        return written(self)


def _falling(storage: np.ndarray) -> np.ndarray:
    """The nearest factors that fall or stay level and are at most 1. Raises
    `InputError` where they are farther than noise.
    """
    from scipy.optimize import isotonic_regression

    falling = np.minimum(isotonic_regression(storage, increasing=False).x, 1.0)
    off = np.abs(falling / storage - 1)
    if (off > _NOISE).any():
        if storage.max() > 1 + _NOISE:
            raise InputError(
                argument="storage",
                got=float(storage.max()),
                accepted="factors on the modulus of small strain, 1 at most",
            )
        i = int(np.argmax(np.diff(storage) / storage[:-1]))
        raise InputError(
            argument="storage",
            got=float(storage[i + 1]),
            accepted=f"{storage[i]:g} or less at entry {i + 1}, since it falls or "
            f"stays level but for noise of {_NOISE:.0%}",
        )
    if off.max() > _ROUNDING:
        warn(
            "softening: storage rises from entry to entry, or exceeds 1: taken for "
            "noise, the nearest factors that fall are used, up to "
            f"{off.max():.1%} from what was given.",
            ModelWarning,
        )
        return falling
    return storage


def as_softening(softening: object) -> Softening | None:
    """An `em.Softening` as it is, or None; raises `InputError` for anything else."""
    if softening is not None and not isinstance(softening, Softening):
        raise InputError(
            argument="softening",
            got=softening,
            accepted="an em.Softening(strain, storage, loss)",
        )
    return softening
