"""The types of arguments: for editors, type checkers and the tables of scenes."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal, Protocol, TypeAlias

if TYPE_CHECKING:
    import jax
    import numpy as np


class HasArray(Protocol):
    """What NumPy makes an array of, such as a column of pandas or xarray."""

    def __array__(self) -> np.ndarray: ...


class HasUnit(Protocol):
    """A quantity of pint, one number or an array."""

    def m_as(self, units: Any, /) -> Any: ...


Array: TypeAlias = "jax.Array | np.ndarray"  # JAX's where it traces, NumPy's otherwise
ComplexArray: TypeAlias = "jax.Array | np.ndarray[Any, np.dtype[np.complex128]]"
# JAX's where it traces, a Python float otherwise
Scalar: TypeAlias = "float | jax.Array"
# one number; arrays without a shape
Plain: TypeAlias = "float | np.number | np.ndarray | jax.Array"
Number: TypeAlias = "Plain | HasUnit"
Rows: TypeAlias = "Sequence[Number] | Sequence[Sequence[Number]] | Sequence[HasArray]"
ArrayLike: TypeAlias = "Number | HasArray | Rows"

Kind: TypeAlias = Literal["shear", "tensile"]


Convention: TypeAlias = Literal[
    "2d", "2d/4pi^2", "1d", "1d one-sided", "1d/2pi", "1d one-sided/2pi"
]
Motion: TypeAlias = Literal["friction", "rolling"]
Response: TypeAlias = Literal["relaxation", "creep", "storage"]
LawName: TypeAlias = Literal["auto", "WLF", "Arrhenius", "VFT", "table", "none"]
Style: TypeAlias = Literal["paper"]  # of a figure
# of several temperatures at which friction and conduction agree
Branch: TypeAlias = Literal["cold", "hot"]
# what typical values are known of: of heat, and of a shear law
Rubber: TypeAlias = Literal["filled rubber"]
Road: TypeAlias = Literal["asphalt", "concrete", "glass", "steel"]
Dry: TypeAlias = Literal["rubber on a road"]


class Frame(Protocol):
    """A table of pandas or polars."""

    @property
    def columns(self) -> Any: ...
    def to_numpy(self) -> np.ndarray: ...
