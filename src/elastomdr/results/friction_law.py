"""A friction law mu(v, T, p) on a grid: what a computed curve hands to a tyre model,
and `em.traction` to its elements.

Between the points mu is linear in ln v, in T and in ln p (multilinear interpolation),
which is what a lookup table of any other program does with the same grid. Outside the
grid there is no answer. Its table is long and tidy: one row per point, with the columns
velocity [m/s], temperature [K], pressure [Pa] and friction coefficient [-].

Formats of other programs: Abaqus Keywords Guide, *FRICTION; Abaqus User Subroutines
Guide, FRIC_COEF; Modelica Standard Library, Modelica.Blocks.Tables.
"""

from __future__ import annotations

import csv
import itertools
import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from textwrap import wrap
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from .. import __version__
from ..arrays import arrays, stop_gradient, xp
from ..checks import (
    Array,
    alike,
    as_float64,
    ascending,
    broadcast_shape,
    is_traced,
    numpy_unless_traced,
    positive,
    require,
    significant,
    untraced,
)
from ..errors import InputError
from ..files import as_path, read_text, write_files
from ..trees import Tree, fill, static
from .base import WithTable
from .doubts import (
    TITLE,
    Doubt,
    carried,
    found,
    from_kinds,
    in_words,
    kinds_of_points,
    where,
)

if TYPE_CHECKING:
    from jaxtyping import Bool, Float

    from .._types import ArrayLike

_SAME = 1e-9  # relative distance from the end of an axis that still counts as its end
_TITLES = {
    "velocity": ("velocity [m/s]",),
    "temperature": ("temperature [K]",),
    "pressure": ("pressure [Pa]", "nominal pressure [Pa]"),
    "mu": ("friction coefficient [-]",),
}
_UNITS = {"velocity": "m/s", "temperature": "K", "pressure": "Pa"}
# factor on velocity and pressure, names
_LENGTH_UNITS = {"m": (1.0, 1.0, "m/s", "Pa"), "mm": (1e3, 1e-6, "mm/s", "MPa")}
# ratio of neighbours where a program interpolates linearly: off by 0.6 % of what mu
# changes over e
_STEP = 1.25
_SIGNIFICANT = {
    True: "significant",
    False: "not significant",
    None: "not known whether significant",
}


class Ranked(NamedTuple):
    """A material in a ranking."""

    material: str
    mu: float
    # absolute: numerical, and what the material's fit misses of its data; NaN where not
    # known
    uncertainty: float
    ahead: float  # of the next one; NaN for the last
    # whether `ahead` exceeds both uncertainties together; None where one is not known
    significant: bool | None
    doubts: tuple[Doubt, ...] = ()  # of mu here

    def words(self) -> str:
        """Friction, uncertainty and lead."""
        uncertainty = "(uncertainty not known)"
        if not np.isnan(self.uncertainty):
            uncertainty = f"+- {significant(self.uncertainty, 2)}"
        words = f"mu {significant(self.mu)} {uncertainty}"
        if np.isfinite(self.ahead):
            ahead = significant(self.ahead, 2)
            words += f"; ahead by {ahead}, {_SIGNIFICANT[self.significant]}"
        kinds = ", ".join(dict.fromkeys(doubt.kind for doubt in self.doubts))
        return f"{words} ({kinds})" if kinds else words


class FrictionLaw(WithTable, Tree):
    """Friction coefficient against sliding velocity and, where they are given,
    temperature and nominal pressure.

    `mu` has the shape (temperature, pressure, velocity), without the axes that are not
    given. From a computed curve: `curve.law()`; from a file: `em.load_friction(path)`.
    Calling it interpolates, with derivatives (`jax.grad`) with respect to mu and to
    where it is asked. `doubts` are those of the curve it is of, at the points of `mu`.
    Raises `InputError`.
    """

    velocity: Float[Array, " velocities"]  # sliding velocity, ascending [m/s]
    mu: Float[Array, "..."]
    temperature: Float[Array, " temperatures"] | None  # ascending [K]
    pressure: Float[Array, " pressures"] | None  # nominal, ascending [Pa]
    marks: tuple[Doubt, ...] = static()  # at the points of `mu`

    def __init__(
        self,
        velocity: ArrayLike,
        mu: ArrayLike,
        temperature: ArrayLike | None = None,
        pressure: ArrayLike | None = None,
        doubts: Iterable[Doubt] = (),
    ):
        given = {"temperature": temperature, "pressure": pressure, "velocity": velocity}
        axes = {
            name: as_float64(name, value)
            for name, value in given.items()
            if value is not None
        }
        for name, values in axes.items():
            alike(1, {name: values})
            positive(name, values)
            ascending(name, values)
        fill(self, velocity=axes["velocity"], mu=as_float64("mu", mu))
        fill(self, temperature=axes.get("temperature"), pressure=axes.get("pressure"))
        shape = tuple(values.size for values in axes.values())
        if self.mu.shape != shape:
            raise InputError(
                argument="mu",
                got=self.mu,
                accepted=f"of the shape ({', '.join(axes)}) = {shape}",
            )
        require(
            "mu",
            xp.where(xp.isnan(self.mu), 0.0, self.mu),
            "zero or positive and finite, or NaN",
            lambda x: (x >= 0) & np.isfinite(x),
        )
        is_list = isinstance(doubts, (list, tuple))
        if not is_list or not all(isinstance(doubt, Doubt) for doubt in doubts):
            raise InputError(argument="doubts", got=doubts, accepted="a list of Doubt")
        for doubt in (doubts := tuple(doubts)):
            if np.shape(doubt.points) != shape:
                raise InputError(
                    argument="doubts",
                    got=np.shape(doubt.points),
                    accepted=f"of points of the shape of mu, {shape}",
                )
        fill(self, marks=doubts)

    @property
    def doubts(self) -> tuple[Doubt, ...]:
        """What there is to doubt in `mu`: kind, points, why, and what would help."""
        return found(self.marks)

    @property
    def extrapolated(self) -> Bool[Array, "..."] | None:
        """Which points of `mu` lie beyond the range of the rubber; None: not known."""
        return where(self.marks, "extrapolated")

    def doubts_at(
        self,
        velocity: ArrayLike,
        temperature: ArrayLike | None = None,
        pressure: ArrayLike | None = None,
    ) -> tuple[Doubt, ...]:
        """The doubts of mu at such velocities, temperatures and pressures: those of any
        point that it is interpolated from.
        """

        def there(points: Array) -> Array:
            share = FrictionLaw(mu=1.0 * points, **self.axes())
            return stop_gradient(share(velocity, temperature, pressure) > 0)

        return carried(self.marks, there, failed=True)

    @numpy_unless_traced
    def __call__(
        self,
        velocity: ArrayLike,
        temperature: ArrayLike | None = None,
        pressure: ArrayLike | None = None,
    ) -> Float[Array, "..."]:
        """mu at sliding velocities [m/s], temperatures [K] and pressures [Pa] that
        broadcast against each other.

        NaN beside a point of the grid that is NaN. Raises `InputError` outside of the
        grid, where values that JAX traces give NaN, and for an axis that is missing;
        one that the law does not have must be left out.
        """
        asked = {"temperature": temperature, "pressure": pressure, "velocity": velocity}
        axes = self.axes()
        for name, value in asked.items():
            if (value is None) == (name in axes):
                requirement = (
                    "given: this friction law depends on it"
                    if name in axes
                    else "left out: this friction law does not depend on it"
                )
                raise InputError(argument=name, got=value, accepted=requirement)
        values = {name: as_float64(name, asked[name]) for name in axes}
        shape = broadcast_shape(values)
        corners, inside = [], xp.ones(shape, bool)
        for name, axis in axes.items():
            low, high = axis[0] * (1 - _SAME), axis[-1] * (1 + _SAME)
            if not is_traced(axis):
                ends = f"{float(axis[0]):.6g} to {float(axis[-1]):.6g} {_UNITS[name]}"
                if axis.size == 1:
                    ends = f"{float(axis[0]):.6g} {_UNITS[name]} alone"
                accepted = f"within the friction law, {ends}"
                require(
                    name,
                    values[name],
                    accepted,
                    lambda x, a=low, b=high: (x >= a) & (x <= b),
                )
            value = xp.broadcast_to(values[name], shape)
            inside = inside & (value >= low) & (value <= high)
            corners.append(
                _between(axis, value, xp.asarray if name == "temperature" else xp.log)
            )
        grid, total = arrays(self.mu), 0.0
        for corner in itertools.product(*corners):
            weight = 1.0
            for _, factor in corner:
                weight = weight * factor
            # A corner of no weight must not spoil the rest, nor its derivative, where
            # it is NaN.
            value = grid[tuple(index for index, _ in corner)]
            total = total + xp.where(
                weight == 0, 0.0, weight * xp.where(weight == 0, 0.0, value)
            )
        return xp.where(inside, total, xp.nan)

    def axes(self) -> dict[str, Float[Array, " n"]]:
        """The axes of `mu`, in order."""
        every = {
            "temperature": self.temperature,
            "pressure": self.pressure,
            "velocity": self.velocity,
        }
        return {name: values for name, values in every.items() if values is not None}

    def header(self) -> list[str]:
        """Grid, units, interpolation and doubts."""
        order = " x ".join(f"{x.size} {name}" for name, x in self.axes().items())
        return [
            f"elastomdr {__version__}: friction law",
            (
                f"grid: {order}, the last one fastest; units: SI, in brackets in the "
                "column titles"
            ),
            (
                "between the points: linear in ln(velocity), temperature and "
                "ln(pressure); not to be used outside"
            ),
            *in_words(self.doubts),
        ]

    def columns(self) -> dict[str, np.ndarray]:
        """One row per point, the velocity fastest; NaN for one that is not known."""
        _untraced(self)
        axes = self.axes()
        points = np.meshgrid(*axes.values(), indexing="ij")
        values = zip([*axes, "mu"], [*points, np.asarray(self.mu)], strict=True)
        columns = {_TITLES[name][0]: x.ravel() for name, x in values}
        return columns | {TITLE: kinds_of_points(self.doubts, self.mu.shape).ravel()}

    def to_abaqus(
        self, path: str | os.PathLike[str], *, units: Literal["m", "mm"] = "m"
    ) -> None:
        """Writes the table of an Abaqus *FRICTION: friction coefficient, slip rate,
        contact pressure, temperature [K].

        `units` is the length in its units: "m" for m/s and Pa, "mm" for mm/s and MPa.
        Abaqus interpolates linearly, so rows are added until that is within 1 % of what
        the law changes over a factor of e. Raises `InputError` where mu is not known at
        a point.
        """
        _write(self, path, "abaqus", units)

    def to_fric_coef(
        self, path: str | os.PathLike[str], *, units: Literal["m", "mm"] = "m"
    ) -> None:
        """Writes the source of Abaqus' user subroutine FRIC_COEF, Fortran in fixed
        form: the law with its derivatives.

        Interpolated as the law itself, held at the ends of its axes. `units` as in
        `to_abaqus`, temperature in K. Raises `InputError` where mu is not known at a
        point.
        """
        _write(self, path, "fric_coef", units)

    def to_modelica(self, path: str | os.PathLike[str]) -> None:
        """Writes tables for CombiTable1Ds or CombiTable2Ds of Modelica, in ln(v/(m/s))
        and ln(p/Pa) or T/K.

        In these a linear interpolation is that of the law. With temperature and
        pressure there is a table for each temperature, "mu_1" and so on, else one,
        "mu". Raises `InputError` where mu is not known at a point.
        """
        _write(self, path, "modelica")

    def __repr__(self) -> str:
        if is_traced(self):
            return f"FrictionLaw({', '.join(self.axes())}; traced)"
        parts = [
            f"{k} {v[0]:.4g} to {v[-1]:.4g} {_UNITS[k]} ({v.size})"
            for k, v in self.axes().items()
        ]
        known = self.mu[np.isfinite(self.mu)]
        mu_range = (
            f"mu {known.min():.4g} to {known.max():.4g}"
            if known.size
            else "no value of mu known"
        )
        return f"FrictionLaw({', '.join(parts)}; {mu_range})"


def load_friction(path: str | os.PathLike[str]) -> FrictionLaw:
    """A friction law from a CSV file, as `FrictionLaw.to_csv` or `FrictionCurve.to_csv`
    writes it.

    Columns "velocity [m/s]", "friction coefficient [-]" and, if there are any,
    "temperature [K]", "pressure [Pa]" or "nominal pressure [Pa]" and "doubts" (kinds
    with "; " between them), in any order; others are passed over, and so are lines that
    start with #. Every combination of the values must be there once. Raises
    `InputError`.
    """
    name = as_path(path).name
    try:
        text = [line for line in read_text(path).split("\n") if line.strip()]
        lines = [line for line in text if not line.lstrip().startswith("#")]
        rows = [[cell.strip() for cell in row] for row in csv.reader(lines)]
    except (OSError, ValueError, csv.Error) as error:
        raise InputError(
            argument="path",
            got=path,
            accepted="a text file that can be read",
            hint=str(getattr(error, "strerror", None) or error),
        ) from error
    places = {}
    for key, titles in _TITLES.items():
        columns = [
            i for i, title in enumerate(rows[0] if rows else []) if title in titles
        ]
        if len(columns) > 1 or (not columns and key in ("velocity", "mu")):
            got = ", ".join(rows[0]) if rows else "nothing"
            raise InputError(
                argument="path",
                got=path,
                accepted=f"a table with one column {titles[0]!r}",
                hint=f"its columns are {got}",
            )
        if columns:
            places[key] = columns[0]
    named = rows[0].index(TITLE) if TITLE in rows[0] else None
    try:
        points = {
            key: np.array([float(row[i] or "nan") for row in rows[1:]])
            for key, i in places.items()
        }
        kinds = [] if named is None else [row[named] for row in rows[1:]]
    except (ValueError, IndexError) as error:
        raise InputError(
            argument="path",
            got=path,
            accepted="a table without cells that are missing or no number",
        ) from error
    try:
        return gridded(points, from_kinds(kinds, text))
    except InputError as error:
        error.inside(repr(name), "path")
        raise


def gridded(
    points: Mapping[str, np.ndarray], doubts: Iterable[Doubt] = ()
) -> FrictionLaw:
    """The law of points that fill a grid: "velocity", "mu" and, where known,
    "temperature" and "pressure", flat, as are their doubts.
    """
    names = [name for name in ("temperature", "pressure", "velocity") if name in points]
    if not points["mu"].size or not all(
        np.isfinite(points[name]).all() for name in names
    ):
        raise InputError(
            argument=names[-1],
            accepted=f"known at every point, as {', '.join(names)}, and of at least "
            "one",
        )
    axes, places = zip(
        *(np.unique(points[name], return_inverse=True) for name in names), strict=True
    )
    shape = tuple(axis.size for axis in axes)
    count = np.zeros(shape, int)
    np.add.at(count, tuple(places), 1)
    if (count != 1).any():
        raise InputError(
            argument=names[-1],
            got=points[names[-1]],
            accepted=f"of a full grid of {' and '.join(names)}, every combination once",
            hint=f"{' x '.join(map(str, shape))} values, {points['mu'].size} points, "
            f"{int((count == 0).sum())} missing and {int((count > 1).sum())} "
            "repeated",
        )

    def on_grid(values: np.ndarray) -> np.ndarray:
        grid = np.empty(shape, values.dtype)
        grid[tuple(places)] = values
        return grid

    return FrictionLaw(
        mu=on_grid(points["mu"]),
        **dict(zip(names, axes, strict=True)),
        doubts=carried(doubts, on_grid, failed=True),
    )


def _between(
    axis: Array, value: Array, scale: Callable[[Array], Array]
) -> tuple[tuple[Array, Array], ...]:
    """Index and weight of the points on either side of a value; of the one point of a
    short axis.
    """
    if axis.shape[0] == 1:
        return ((xp.zeros(xp.shape(value), int), xp.ones(xp.shape(value))),)
    axis = arrays(axis)
    high = xp.clip(xp.searchsorted(axis, value, side="right"), 1, axis.shape[0] - 1)
    start = scale(axis[high - 1])
    end = scale(axis[high])
    scaled = scale(xp.clip(value, axis[0], axis[-1]))
    fraction = (scaled - start) / (end - start)
    return (high - 1, 1 - fraction), (high, fraction)


def _untraced(law: FrictionLaw) -> None:
    untraced(
        InputError(
            argument="FrictionLaw",
            accepted="written outside jit, grad and vmap, with plain numbers",
        ),
        law,
    )


def _write(
    law: FrictionLaw, path: str | os.PathLike[str], form: str, units: str = "m"
) -> None:
    """Writes a law in one of the forms "abaqus", "fric_coef" and "modelica". Raises
    `InputError`.
    """
    _untraced(law)
    if units not in _LENGTH_UNITS:
        raise InputError(
            argument="units", got=units, accepted="'m' (m, N, Pa) or 'mm' (mm, N, MPa)"
        )
    if not np.isfinite(law.mu).all():
        missing = int((~np.isfinite(law.mu)).sum())
        raise InputError(
            argument="mu",
            got=law.mu,
            accepted="known at every point of the law",
            hint=f"{missing} of {law.mu.size} are NaN",
        )
    written, comment = {
        "abaqus": (_abaqus, "** "),
        "fric_coef": (_fric_coef, "C     "),
        "modelica": (_modelica, "# "),
    }[form]
    first, *lines = written(law, units)
    doubts = [
        comment + line for each in in_words(law.doubts) for line in wrap(each, 66)
    ]
    write_files({as_path(path): ("\n".join([first, *doubts, *lines]) + "\n").encode()})


def _abaqus(law: FrictionLaw, units: str) -> Iterator[str]:
    """*FRICTION with mu, slip rate, pressure, temperature; the slip rate changes
    fastest.
    """
    of_v, of_p, v_unit, p_unit = _LENGTH_UNITS[units]
    fine = {
        name: axis if name == "temperature" else _filled(np.asarray(axis))
        for name, axis in law.axes().items()
    }
    yield f"** elastomdr {__version__}: friction law for *SURFACE INTERACTION"
    yield f"** units: slip rate {v_unit}, contact pressure {p_unit}, temperature K"
    yield (
        "** between the rows Abaqus interpolates linearly, beyond them it holds the "
        "last value: rows are dense in"
    )
    yield (
        "** slip rate and pressure for that; below the first slip rate friction is "
        "not known"
    )
    yield "*FRICTION"
    for temperature in fine.get("temperature", [None]):
        for pressure in fine.get("pressure", [None]):
            for velocity in fine["velocity"]:
                given = [x for x in (temperature, pressure) if x is not None]
                named = dict(
                    zip(
                        [k for k in ("temperature", "pressure") if k in fine],
                        given,
                        strict=True,
                    )
                )
                mu = float(law(velocity, **named))
                cells = [f"{mu:.8g}", f"{velocity * of_v:.8g}"]
                cells += ["" if pressure is None else f"{pressure * of_p:.8g}"]
                cells += ["" if temperature is None else f"{temperature:.8g}"]
                yield ", ".join(cells).rstrip(", ")


def _filled(axis: np.ndarray) -> np.ndarray:
    """An axis with as many logarithmic steps between its values as make neighbours
    differ by `_STEP` at most.
    """
    parts = [axis[:1]]
    for low, high in itertools.pairwise(axis):
        parts.append(
            np.geomspace(
                low, high, int(np.ceil(np.log(high / low) / np.log(_STEP))) + 1
            )[1:]
        )
    return np.concatenate(parts)


def _modelica(law: FrictionLaw, units: str) -> Iterator[str]:
    """One table in ln v, or in ln v and ln p or T; of a law with both, a table for each
    temperature.
    """
    axes = law.axes()
    rows, mu = np.log(axes["velocity"]), np.asarray(law.mu)
    yield "#1"
    yield (
        f"# elastomdr {__version__}: friction coefficient [-], for "
        "Modelica.Blocks.Tables, smoothness LinearSegments"
    )
    if len(axes) == 1:
        yield "# CombiTable1Ds: u = ln(sliding velocity / (1 m/s))"
        yield from _table("mu", np.stack([rows, mu], 1))
        return
    across = "pressure" if "pressure" in axes else "temperature"
    columns = np.log(axes["pressure"]) if across == "pressure" else axes["temperature"]
    second = (
        "ln(nominal pressure / (1 Pa))"
        if across == "pressure"
        else "temperature / (1 K)"
    )
    yield f"# CombiTable2Ds: u1 = ln(sliding velocity / (1 m/s)), u2 = {second}"
    layers = mu if mu.ndim == 3 else mu[None]
    for i, layer in enumerate(layers):
        name = "mu" if mu.ndim == 2 else f"mu_{i + 1}"
        if mu.ndim == 3:
            yield (
                f"# {name}: at {axes['temperature'][i]:.10g} K; between temperatures "
                "friction is linear"
            )
        whole = np.zeros((rows.size + 1, columns.size + 1))
        whole[1:, 0], whole[0, 1:], whole[1:, 1:] = rows, columns, layer.T
        yield from _table(name, whole)


def _table(name: str, values: np.ndarray) -> Iterator[str]:
    yield f"double {name}({values.shape[0]},{values.shape[1]})"
    for row in values:
        yield " ".join(f"{x:.15g}" for x in row)


def _fric_coef(law: FrictionLaw, units: str) -> Iterator[str]:
    """FRIC_COEF in fixed form: the law as it is, linear in ln v, ln p and T, held at
    the ends of its axes.
    """
    of_v, of_p, v_unit, p_unit = _LENGTH_UNITS[units]
    axes = law.axes()
    lists: dict[str, Any] = {
        "v": np.log(axes["velocity"] * of_v),
        "p": np.log(axes["pressure"] * of_p) if "pressure" in axes else np.zeros(1),
        "t": axes.get("temperature", np.zeros(1)),
    }
    sizes = {name: len(values) for name, values in lists.items()}
    yield (
        f"C     elastomdr {__version__}: friction coefficient by sliding velocity, "
        "pressure, temperature"
    )
    yield f"C     units: slip rate {v_unit}, pressure {p_unit}, temperature K"
    yield "C     between the points linear in ln(v), ln(p) and T; held at the ends"
    yield "C     *FRICTION, USER=COEFFICIENT"
    yield _HEAD
    sized = ", ".join(f"n{name} = {size}" for name, size in sizes.items())
    yield f"      parameter ({sized})"
    yield "      dimension gv(nv), gp(np), gt(nt), gm(nv,np,nt)"
    for name, values in lists.items():
        yield from _data(f"g{name}(i)", values)
    cube = np.asarray(law.mu).reshape(sizes["t"], sizes["p"], sizes["v"])
    for k in range(sizes["t"]):
        for j in range(sizes["p"]):
            yield from _data(f"gm(i,{j + 1},{k + 1})", cube[k, j])
    yield "C"
    yield "      do k = 1, nBlock"
    places = (
        ("v", "i", "a", "log(max(slipRate(k), 1.d-30))"),
        ("p", "j", "b", "log(max(pressure(k), 1.d-30))"),
        ("t", "l", "c", "tempAvg(k)"),
    )
    for name, place, letter, value in places:
        value = value if sizes[name] > 1 else "0.d0"
        yield f"         call emdrax(g{name}, n{name}, {value},"
        yield f"     *      {place}1, {place}2, {letter}, d{letter})"
    yield _BODY.format(
        by_p="\n     *      /max(pressure(k), 1.d-30)" if sizes["p"] > 1 else ""
    )


def _data(name: str, values: Array) -> Iterator[str]:
    """DATA statements of three numbers each, which fit into 72 columns."""
    for start in range(0, len(values), 3):
        values_of_row = values[start : start + 3]
        yield f"      data ({name}, i={start + 1},{start + len(values_of_row)}) /"
        yield (
            "     *   "
            + ", ".join(f"{x:.10e}".replace("e", "d") for x in values_of_row)
            + " /"
        )


_HEAD = """      subroutine fric_coef (
     *   fCoef, fCoefDeriv,
     *   nBlock, nProps, nTemp, nFields,
     *   jFlags, rData,
     *   surfInt, surfSlv, surfMst,
     *   props, slipRate, pressure,
     *   tempAvg, fieldAvg )
      include 'aba_param.inc'
      dimension fCoef(nBlock), fCoefDeriv(nBlock,3), props(nProps),
     *   slipRate(nBlock), pressure(nBlock), tempAvg(nBlock),
     *   fieldAvg(nBlock,nFields), jFlags(2), rData(3)
      character*80 surfInt, surfSlv, surfMst"""
_BODY = """         f11 = gm(i1,j1,l1) + a*(gm(i2,j1,l1) - gm(i1,j1,l1))
         f21 = gm(i1,j2,l1) + a*(gm(i2,j2,l1) - gm(i1,j2,l1))
         f12 = gm(i1,j1,l2) + a*(gm(i2,j1,l2) - gm(i1,j1,l2))
         f22 = gm(i1,j2,l2) + a*(gm(i2,j2,l2) - gm(i1,j2,l2))
         d1 = (gm(i2,j1,l1) - gm(i1,j1,l1))*(1.d0 - b)
     *      + (gm(i2,j2,l1) - gm(i1,j2,l1))*b
         d2 = (gm(i2,j1,l2) - gm(i1,j1,l2))*(1.d0 - b)
     *      + (gm(i2,j2,l2) - gm(i1,j2,l2))*b
         g1 = f11 + b*(f21 - f11)
         g2 = f12 + b*(f22 - f12)
         fCoef(k) = g1 + c*(g2 - g1)
         fCoefDeriv(k,1) = (d1 + c*(d2 - d1))*da
     *      /max(slipRate(k), 1.d-30)
         fCoefDeriv(k,2) = ((f21 - f11)*(1.d0 - c) + (f22 - f12)*c)*db{by_p}
         fCoefDeriv(k,3) = (g2 - g1)*dc
      end do
      return
      end
C
C     Neighbours of x on an axis, the weight of the upper one, its slope
      subroutine emdrax(grid, n, x, ilow, ihigh, w, dw)
      include 'aba_param.inc'
      dimension grid(n)
      ilow = 1
      ihigh = 1
      w = 0.d0
      dw = 0.d0
      if (n .eq. 1) return
      ihigh = 2
      do while (ihigh .lt. n .and. x .gt. grid(ihigh))
         ihigh = ihigh + 1
      end do
      ilow = ihigh - 1
      w = (x - grid(ilow))/(grid(ihigh) - grid(ilow))
      if (w .ge. 0.d0 .and. w .le. 1.d0) then
         dw = 1.d0/(grid(ihigh) - grid(ilow))
      end if
      w = min(max(w, 0.d0), 1.d0)
      return
      end"""
