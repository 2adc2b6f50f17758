"""A friction law as other programs read it: Abaqus input and user subroutine, and
tables of Modelica.

`write` is what `FrictionLaw.to_abaqus`, `to_fric_coef` and `to_modelica` call. Formats:
Abaqus Keywords Guide, *FRICTION; Abaqus User Subroutines Guide, FRIC_COEF; Modelica
Standard Library, Modelica.Blocks.Tables.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .. import __version__
from ..checks import is_traced
from ..errors import InputError
from ..files import write_files

if TYPE_CHECKING:
    import os

    from .friction_law import FrictionLaw

# factor on velocity and pressure, names
_UNITS = {"m": (1.0, 1.0, "m/s", "Pa"), "mm": (1e3, 1e-6, "mm/s", "MPa")}
# ratio of neighbours where a program interpolates linearly: off by 0.6 % of what mu
# changes over e
_STEP = 1.25


def write(
    law: FrictionLaw, path: str | os.PathLike[str], form: str, units: str = "m"
) -> None:
    """Writes a law in one of the forms "abaqus", "fric_coef" and "modelica". Raises
    `InputError`.
    """
    if is_traced(law):
        raise InputError(
            "FrictionLaw has no numbers while JAX traces it. Write files outside "
            "jit, grad and vmap."
        )
    if units not in _UNITS:
        raise InputError(
            f"units must be 'm' (m, N, Pa) or 'mm' (mm, N, MPa), got {units!r}."
        )
    if not np.isfinite(law.mu).all():
        missing = int((~np.isfinite(law.mu)).sum())
        raise InputError(
            f"mu must be known at every point of the law, {missing} of "
            f"{law.mu.size} "
            "are NaN."
        )
    lines = {"abaqus": _abaqus, "fric_coef": _fric_coef, "modelica": _modelica}[form](
        law, units
    )
    write_files({Path(path): ("\n".join(lines) + "\n").encode()})


def _abaqus(law: FrictionLaw, units: str) -> Iterator[str]:
    """*FRICTION with mu, slip rate, pressure, temperature; the slip rate changes
    fastest.
    """
    of_v, of_p, v_unit, p_unit = _UNITS[units]
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
    for kelvin in fine.get("temperature", [None]):
        for pressure in fine.get("pressure", [None]):
            for velocity in fine["velocity"]:
                given = [x for x in (kelvin, pressure) if x is not None]
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
                cells += ["" if kelvin is None else f"{kelvin:.8g}"]
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
    of_v, of_p, v_unit, p_unit = _UNITS[units]
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


def _data(name: str, values: Any) -> Iterator[str]:
    """DATA statements of three numbers each, which fit into 72 columns."""
    for start in range(0, len(values), 3):
        some = values[start : start + 3]
        yield f"      data ({name}, i={start + 1},{start + len(some)}) /"
        yield (
            "     *   " + ", ".join(f"{x:.10e}".replace("e", "d") for x in some) + " /"
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
