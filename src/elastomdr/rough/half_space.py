"""Steady sliding of a periodic map on a three-dimensional viscoelastic half-space, in
Fourier space.

In the frame of the map, which moves along +x with velocity v, the wave (kx, ky) shakes
the rubber at the frequency kx v, and a pressure p of that wave displaces the surface by

    u = K p,
    K = 2/(|k| E*(-kx v)),
    so that
    tau = <p dh/dx> = sum |p_k|^2 2 kx E''(kx v)/(|k| |E*(kx v)|^2)

is the mean friction stress: only the loss, so that the smallest keeps its digits.
Contact is where p > 0; there the gap is zero, elsewhere p = 0 and the gap is positive.
The mean displacement of a periodic half-space is not defined; it is left out by P,
which takes its mean over the contact off a field.

Each pivot solves P K p = P h on the cells in contact by GMRES, preconditioned by P/K,
which changes no mean, so that the load is held exactly and there is one right-hand
side. Then cells that pull are let go and cells that overlap are taken in, until none
does. Where the changes go in circles, cells are let go only, for a while. The contact
to begin with is that of a grid half as fine, or of a neighbouring velocity or load.

The code is written over an array namespace: NumPy with SciPy's transforms, or
`jax.numpy` on whatever device it runs.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

_PIVOTS = 60
_MEMORY, _RESTARTS = 50, 2  # of GMRES in one pivot
# relative residual of the last pivot in 32 and in 64 bits
_SINGLE, _DOUBLE = 5e-5, 1e-9
# pivots in which fewer cells change than ever before, or those that pull are let go
# only
_PATIENCE = 2
_COARSEST = 32  # cells along a side below which no coarser grid is solved


class Found(NamedTuple):
    """One contact."""

    stress: float  # mean friction stress [Pa]
    area: float  # real contact area over nominal area
    separation: float  # mean gap [m]
    pressure: Any  # of each cell [Pa]
    settled: bool
    products: int  # with K, the measure of the work


class Waves(NamedTuple):
    """The waves of a grid, as `rfft2` orders them, and what the material makes of
    them.
    """

    kernel: Any  # K [m/Pa], 0 for the mean
    inverse: Any  # 1/K
    # friction stress for |p_k|^2 = 1, with the waves that rfft2 leaves out [1/Pa]
    loss: Any


def waves(
    modulus: Callable[[Any], Any], velocity: float, shape: tuple[int, int], sides: Any
) -> Waves:
    """The waves of a grid of `shape` cells on `sides` [m]; `modulus(omega)` is E* [Pa]
    at omega >= 0 [rad/s].
    """
    nx, ny = shape
    kx = 2 * np.pi * np.fft.fftfreq(nx, 1 / nx) / sides[0]
    ky = 2 * np.pi * np.fft.rfftfreq(ny, 1 / ny) / sides[1]
    value = np.conj(modulus(np.abs(kx) * velocity))  # E*(-kx v)
    value = np.where(kx < 0, np.conj(value), value)
    if nx % 2 == 0:
        value[nx // 2] = value[nx // 2].real  # a wave without a direction of its own
    k = np.hypot(kx[:, None], ky[None])
    k[0, 0] = 1.0
    inverse = 0.5 * k * value[:, None]
    kernel = 1 / inverse
    kernel[0, 0] = inverse[0, 0] = 0.0  # the mean is given: only the rest counts
    twice = np.full(ky.size, 2.0)
    twice[0] = 1.0
    if ny % 2 == 0:
        twice[-1] = 1.0
    loss = twice * (2 * kx * -value.imag / np.abs(value) ** 2)[:, None] / k
    return Waves(kernel, inverse, loss)


def solve(
    modulus: Callable[[Any], Any],
    heights: Any,
    sides: Any,
    *,
    velocity: float,
    pressure: float,
    start: Any = None,
    double: bool = True,
    xp: Any = np,
) -> Found:
    """Contact of `heights` [m] (positive into the rubber) at a mean `pressure` [Pa].

    `start` is a map of pressures on the same grid, for its cells in contact: those of a
    neighbouring velocity or load; without it they come from a grid half as fine. The
    contact is found in 32 bits, to 1e-4 of the stress, and with `double` settled in 64.
    """
    on = waves(modulus, velocity, heights.shape, sides)
    full = _in_full_contact(on, heights, pressure)
    if full is not None:
        return full
    if start is None:
        if min(heights.shape) <= _COARSEST or any(n % 2 for n in heights.shape):
            start = xp.where(heights >= np.median(np.asarray(heights)), pressure, 0.0)
        else:
            half = solve(
                modulus,
                heights[::2, ::2],
                sides,
                velocity=velocity,
                pressure=pressure,
                double=False,
                xp=xp,
            )
            start = xp.repeat(xp.repeat(half.pressure, 2, axis=0), 2, axis=1)
    found = _settle(on, heights, pressure, start, np.float32, np.complex64, xp)
    if not double:
        return found
    last = _settle(on, heights, pressure, found.pressure, np.float64, np.complex128, xp)
    return last._replace(products=last.products + found.products)


def _in_full_contact(on: Waves, heights: Any, mean: float) -> Found | None:
    """The solution where it is positive everywhere, from the heights' own waves; else
    None.
    """
    spread = np.fft.rfft2(np.asarray(heights, dtype=np.float64)) * on.inverse
    pressed = mean + np.fft.irfft2(spread, s=heights.shape)
    if not pressed.min() > 0:
        return None
    stress = float((on.loss * np.abs(spread / heights.size) ** 2).sum())
    return Found(stress, 1.0, 0.0, pressed, True, 1)


def _settle(
    on: Waves, heights: Any, mean: float, start: Any, real: Any, complex_: Any, xp: Any
) -> Found:
    """Pivots from the contact and the pressures `start` on, until no cell changes and
    the residual is small.
    """
    scale = float(np.std(np.asarray(heights)))
    height = xp.asarray((heights - heights.mean()) / scale, dtype=real)
    size = height.size
    unit = mean / scale  # pressures are counted in the mean one, heights in their rms
    kernel, inverse = (
        xp.asarray(on.kernel * unit, dtype=complex_),
        xp.asarray(on.inverse / unit, dtype=complex_),
    )
    transform = _transforms(xp, height.shape)

    def apply(factor: Any, field: Any) -> Any:
        return transform.back(factor * transform.forth(field))

    single = real is np.float32
    tight = _SINGLE if single else _DOUBLE
    pressed = xp.asarray(start / mean, dtype=real)
    touching = pressed > 0
    fewest, waited, products, settled, level = size + 1, 0, 0, False, np.nan
    tolerance = 1e-2 if single else 1e-6
    for _ in range(_PIVOTS):
        cells = _cells(xp, touching)
        count = float(touching.sum())
        if count == 0:
            break

        def project(values: Any, cells: Any = cells, count: float = count) -> Any:
            return cells.centred(values, values.sum() / count)

        def precondition(
            values: Any, cells: Any = cells, project: Any = project
        ) -> Any:
            return project(cells.take(apply(inverse, cells.put(values))))

        def product(values: Any, cells: Any = cells, project: Any = project) -> Any:
            return project(cells.take(apply(kernel, cells.put(values))))

        p = xp.maximum(cells.take(pressed), 0.0)
        p = cells.centred(p, (p.sum() - size) / count)
        p, missed, used = _gmres(
            xp, product, precondition, project(cells.take(height)), p, tolerance
        )
        pressed = cells.put(p)
        miss = apply(kernel, pressed) - height
        products += used + 1
        level = float((miss * touching).sum()) / count
        pulling, overlapping = touching & (pressed <= 0), ~touching & (miss < level)
        changed = int((pulling | overlapping).sum())
        waited = 0 if changed < fewest else waited + 1
        # In 32 bits rounding decides of the last cells. In 64 a few may go in and out
        # for ever at a glassy leading edge, where a pressure sinks in further behind
        # than at its own place.
        few = (
            count / 500
            if single
            else 0
            if waited <= _PATIENCE + 2
            else max(2, count / 5000)
        )
        if changed <= few and missed <= 4 * tight:
            settled = True
            break
        fewest = min(fewest, changed)
        only_drop = waited >= _PATIENCE and bool(pulling.any())
        touching = (
            touching & ~pulling if only_drop else (touching & ~pulling) | overlapping
        )
        # what is left of the solve may keep cells changing
        loose = 1e-2 * min(1.0, 10 * changed / size) * 0.1**waited
        tolerance = tight if changed <= max(few, 2, count / 5000) else max(tight, loose)
    spread = transform.forth(pressed) / size
    most = float(on.loss.max()) or 1.0  # 32 bits hold no loss of 1e-45
    stress = (
        float((xp.asarray(on.loss / most, dtype=real) * xp.abs(spread) ** 2).sum())
        * most
        * mean
        * mean
    )
    return Found(
        stress,
        _area(xp, pressed > 0),
        -level * scale,
        pressed * mean,
        settled,
        products,
    )


def _area(xp: Any, touching: Any) -> float:
    """Share of the area in contact, from cells whose border is a staircase.

    Corrected by the length of that border (Yastrebov, Anciaux and Molinari, Tribol.
    Int. 114 (2017) 161): four cells per shortest wave then give the area of ever finer
    grids within 2 %, where the cells by themselves give 10 to 15 % more.
    """
    border = sum(int((touching ^ xp.roll(touching, 1, axis)).sum()) for axis in (0, 1))
    return (
        float(touching.sum()) - (np.pi - 1 + np.log(2)) / 24 * border
    ) / touching.size


def _gmres(
    xp: Any, product: Any, precondition: Any, right: Any, p: Any, tolerance: float
) -> tuple[Any, float, int]:
    """GMRES for P K p = P h, preconditioned on the right by P/K: p, its relative
    residual and how many products.
    """
    size = float(xp.sqrt((right * right).sum()))
    products, missed = 0, np.inf
    for _ in range(_RESTARTS):
        r = right - product(p)
        products += 1
        beta = float(xp.sqrt((r * r).sum()))
        missed = beta / size
        if missed <= tolerance:
            break
        basis, hessenberg = [r / beta], np.zeros((_MEMORY + 1, _MEMORY))
        right_side = np.zeros(_MEMORY + 1)
        right_side[0] = beta
        y = np.zeros(1)
        for j in range(_MEMORY):
            w = product(precondition(basis[j]))
            products += 1
            for i, b in enumerate(basis):
                hessenberg[i, j] = float((w * b).sum())
                w = w - hessenberg[i, j] * b
            hessenberg[j + 1, j] = float(xp.sqrt((w * w).sum()))
            part = hessenberg[: j + 2, : j + 1]
            y, *_ = np.linalg.lstsq(part, right_side[: j + 2], rcond=None)
            missed = float(np.linalg.norm(part @ y - right_side[: j + 2])) / size
            if missed <= 0.7 * tolerance or hessenberg[j + 1, j] <= 1e-12 * beta:
                break
            basis.append(w / hessenberg[j + 1, j])
        step = y[0] * basis[0]
        for factor, b in zip(y[1:], basis[1:], strict=False):
            step = step + factor * b
        p = p + precondition(step)
        if missed <= 0.7 * tolerance:
            break
    return p, missed, products


class _Cells(NamedTuple):
    """The cells in contact as a list of values, and back to the grid."""

    take: Callable[[Any], Any]
    put: Callable[[Any], Any]
    centred: Callable[[Any, Any], Any]  # values less a number, on the cells in contact


def _cells(xp: Any, touching: Any) -> _Cells:
    """NumPy keeps the cells in contact only; elsewhere sizes must not change, and the
    other cells are zero.
    """
    if xp is not np:
        return _Cells(
            lambda field: xp.where(touching, field, 0),
            lambda values: values,
            lambda values, number: xp.where(touching, values - number, 0),
        )
    index, shape = np.flatnonzero(touching), touching.shape

    def put(values: Any) -> Any:
        field = np.zeros(touching.size, values.dtype)
        field[index] = values
        return field.reshape(shape)

    return _Cells(
        lambda field: field.reshape(-1)[index],
        put,
        lambda values, number: values - number,
    )


class _Transforms(NamedTuple):
    forth: Callable[[Any], Any]
    back: Callable[[Any], Any]


def _transforms(xp: Any, shape: tuple[int, ...]) -> _Transforms:
    if xp is not np:
        return _Transforms(xp.fft.rfft2, lambda spread: xp.fft.irfft2(spread, s=shape))
    from scipy import fft

    return _Transforms(
        lambda field: fft.rfft2(field),
        lambda spread: fft.irfft2(spread, s=shape, overwrite_x=True),
    )
