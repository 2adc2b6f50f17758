"""Contact of a rigid surface that slides steadily over a viscoelastic half-space, on a
grid of cells in three dimensions: the solver of random maps (`em.HalfSpace`) and of the
references, periodic maps and single bodies.

The pressures p >= 0 of the cells displace the surface by u = K p, a convolution in the
plane. Where p > 0 the rubber follows the heights h of the rigid surface, u - h = d; the
gap u - h - d is positive elsewhere. It is found by block pivoting (Portugal, Judice and
Vicente, Math. Comp. 63 (1994) 625): K p = h + d is solved on the cells in contact, then
cells that pull are let go and cells that overlap are taken in, until none does. Where
the changes go in circles (at a glassy leading edge thinner than a cell a pressure sinks
in further behind than at its own place) cells are let go only, for a while.

Each pivot is solved by elimination where few cells touch, else by GMRES; BiCGSTAB does
not converge above 30 % contact on maps of high contrast. The preconditioner is the
inverse of K on the infinite surface, restricted to the contact. Under a given load the
equation is P K p = P h, where P takes the mean over the contact off a field, and the
preconditioner is P/K, which changes no mean: the load is held exactly, and the depth d
follows as the mean of u - h over the contact.

**Periodic maps.** In the frame of the map, which moves along +x with velocity v, the
wave (kx, ky) shakes the rubber at the frequency kx v, so that

    K = 2/(|k| E*(-kx v)),
    tau = <p dh/dx> = sum |p_k|^2 2 kx E''(kx v)/(|k| |E*(kx v)|^2)

is the mean friction stress: only the loss, so that the smallest keeps its digits. The
mean displacement of a periodic half-space is not defined; the wave k = 0 is left out of
K, and d counts from the mean height. The contact to begin with is that of a grid half
as fine, or of a neighbouring velocity or load.
"""

import functools
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from scipy import fft
from scipy.sparse.linalg import LinearOperator, gmres

from ..arrays import one_thread

_FunctionOperator: Any = LinearOperator  # its type hints lack the functions
_PIVOTS = 60
# of GMRES: vectors that are kept, and how often it begins anew
_KEPT, _RESTARTS = 80, 3
# cells in contact up to which elimination takes less time than iteration
_FEW = 1000
# pivots in which fewer cells change than ever before, or those that pull are let go
# only
_PATIENCE = 2
_LARGE = 256**2  # cells from which an accelerator is asked for
_COARSEST = 32  # cells along a side below which no coarser grid is solved


class Convolution(NamedTuple):
    """K and about its inverse, as factors in Fourier space."""

    kernel: np.ndarray  # K [m/Pa]
    inverse: np.ndarray  # about 1/K
    shape: tuple[int, int]  # of the transforms: of a single body twice the grid

    def displacement(self, pressure: np.ndarray) -> Any:
        """u = K p."""
        return self._times(self.kernel, pressure)

    def pressure(self, displacement: np.ndarray) -> Any:
        """p of about that displacement."""
        return self._times(self.inverse, displacement)

    def influence(self) -> Any:
        """Displacement [m] of each cell by a pressure of 1 Pa on the cell (0, 0)."""
        return fft.irfft2(self.kernel, self.shape)

    def _times(self, factor: np.ndarray, field: np.ndarray) -> Any:
        waves: Any = fft.rfft2(field, self.shape)
        whole: Any = fft.irfft2(factor * waves, self.shape, overwrite_x=True)
        return whole[: field.shape[0], : field.shape[1]]


class CompiledConvolution(Convolution):
    """The same, with products compiled by JAX; the factors stay on its device."""

    def influence(self) -> Any:
        return fft.irfft2(np.asarray(self.kernel), self.shape)

    def _times(self, factor: np.ndarray, field: np.ndarray) -> Any:
        import jax

        with jax.enable_x64(field.dtype == np.float64):
            return np.asarray(_product(self.shape)(factor, field))


@functools.cache
def _product(shape: tuple[int, int]) -> Any:
    import jax

    def product(factor: np.ndarray, field: np.ndarray) -> Any:
        waves = jax.numpy.fft.rfft2(field, shape)
        whole = jax.numpy.fft.irfft2(factor * waves, shape)
        return whole[: field.shape[0], : field.shape[1]]

    return jax.jit(product)


def on_accelerator(cells: Convolution, count: int) -> Convolution:
    """The convolution on an accelerator, where JAX finds one and so many cells are worth
    the way there.
    """
    if count < _LARGE:
        return cells
    import jax

    return cells if jax.default_backend() == "cpu" else compiled(cells)


def compiled(cells: Convolution) -> CompiledConvolution:
    """The convolution with its factors on the device of JAX."""
    import jax

    with jax.enable_x64(cells.kernel.dtype == np.complex128):
        kernel, inverse = jax.device_put((cells.kernel, cells.inverse))
    return CompiledConvolution(kernel, inverse, cells.shape)


class Accuracy(NamedTuple):
    """How exactly a contact is found."""

    residual: float  # relative residual of the last pivot
    first: float  # the same of the first pivot
    # share of the cells in contact that may go on changing
    changing: float
    at_once: bool  # whether so many may at once, or only where they do not settle


# In 32 bits rounding decides of the last cells. In 64 a few may go in and out for ever
# at a glassy leading edge.
_SINGLE = Accuracy(5e-5, 1e-2, 1 / 500, True)
_DOUBLE = Accuracy(1e-9, 1e-6, 1 / 5000, False)
EXACT = Accuracy(1e-10, 1e-6, 0.0, False)


class CellContact(NamedTuple):
    """Where and how hard cells touch."""

    pressure: np.ndarray  # of each cell [Pa]
    depth: float  # d [m]
    settled: bool
    products: int  # with K, the measure of the work


@one_thread()
def settle(
    cells: Convolution,
    height: np.ndarray,
    start: np.ndarray,
    accuracy: Accuracy,
    *,
    load: float | None = None,
    depth: float | None = None,
) -> CellContact:
    """Contact of `height` [m], positive into the rubber, from the pressures `start` on.

    Either `load`, the sum of the pressures over the cells [Pa], or `depth` is given.
    The arrays may be of 32 or of 64 bits.
    """
    cells = on_accelerator(cells, height.size)
    pressure = start
    touching = pressure > 0
    fewest, waited, products, deep = height.size + 1, 0, 0, np.nan
    tolerance = accuracy.first
    for _ in range(_PIVOTS):
        if not touching.any():
            break
        pressure, residual, used = _solved(
            cells, height, touching, pressure, tolerance, load, depth
        )
        over = cells.displacement(pressure) - height
        products += used + 1
        deep = float(over[touching].mean()) if depth is None else depth
        pulling, overlapping = touching & (pressure <= 0), ~touching & (over < deep)
        changed, count = int((pulling | overlapping).sum()), int(touching.sum())
        waited = 0 if changed < fewest else waited + 1
        few = _tolerated(accuracy, count, waited)
        if changed <= few and residual <= 4 * accuracy.residual:
            return CellContact(pressure, deep, True, products)
        fewest = min(fewest, changed)
        touching = touching & ~pulling
        if not (waited >= _PATIENCE and pulling.any()):
            touching |= overlapping
        # what is left of the solve may keep cells changing
        loose = 1e-2 * min(1.0, 10 * changed / height.size) * 0.1**waited
        last = changed <= max(few, 2, count / 5000)
        tolerance = accuracy.residual if last else max(accuracy.residual, loose)
    return CellContact(pressure, deep, False, products)


def _tolerated(accuracy: Accuracy, count: int, waited: int) -> float:
    """How many of `count` cells in contact may go on changing."""
    if accuracy.at_once:
        return accuracy.changing * count
    if not accuracy.changing or waited <= _PATIENCE + 2:
        return 0
    return max(2, accuracy.changing * count)


def _solved(
    cells: Convolution,
    height: np.ndarray,
    touching: np.ndarray,
    pressure: np.ndarray,
    tolerance: float,
    load: float | None,
    depth: float | None,
) -> tuple[Any, float, int]:
    """Pressures on one set of cells, their relative residual and how many products with
    K they took; from `pressure` on.
    """
    index = np.flatnonzero(touching)
    if index.size <= _FEW:
        return _eliminated(cells, height, touching, load, depth)

    def on_grid(values: np.ndarray) -> Any:
        field = np.zeros(height.size, height.dtype)
        field[index] = values
        return field.reshape(height.shape)

    def projected(field: np.ndarray) -> Any:
        values = field.reshape(-1)[index]
        return values - values.mean() if depth is None else values

    def product(values: np.ndarray) -> Any:
        return projected(cells.displacement(on_grid(values)))

    def precondition(values: np.ndarray) -> Any:
        return projected(cells.pressure(on_grid(values)))

    def operator(function: Callable[[Any], Any]) -> Any:
        shape = (index.size, index.size)
        return _FunctionOperator(shape, matvec=function, dtype=height.dtype)

    begun = np.maximum(pressure.reshape(-1)[index], 0)
    if load is not None:
        begun = begun - (begun.sum() - load) / index.size
    wanted = projected(height) + (0 if depth is None else depth)
    size = float(np.linalg.norm(wanted)) or 1.0
    rest = wanted - product(begun)
    change, used = _change(
        operator(product), operator(precondition), rest, tolerance * size
    )
    residual = float(np.linalg.norm(rest - product(change))) / size
    return on_grid(begun + change), residual, used + 2


def _eliminated(
    cells: Convolution,
    height: np.ndarray,
    touching: np.ndarray,
    load: float | None,
    depth: float | None,
) -> tuple[Any, float, int]:
    """`_solved` of few cells by elimination: K p = h + d, where the load is given with
    d as a further unknown and sum p = load as a further equation.
    """
    x, y = np.nonzero(touching)
    matrix = cells.influence()[x[:, None] - x, y[:, None] - y]
    wanted = height[touching] + (depth or 0.0)
    if load is not None:
        ones = np.ones((x.size, 1), height.dtype)
        matrix = np.block([[matrix, -ones], [ones.T, np.zeros((1, 1), height.dtype)]])
        wanted = np.append(wanted, height.dtype.type(load))
    try:
        unknowns = np.linalg.solve(matrix, wanted)
    except np.linalg.LinAlgError:  # singular
        unknowns = np.full(wanted.shape, np.nan, height.dtype)
    rest = matrix @ unknowns - wanted
    pressure = np.zeros_like(height)
    pressure[touching] = unknowns[: x.size]
    return pressure, float(np.linalg.norm(rest) / (np.linalg.norm(wanted) or 1.0)), 1


def _change(
    product: LinearOperator,
    precondition: LinearOperator,
    rest: np.ndarray,
    tolerance: float,
) -> tuple[Any, int]:
    """The pressures whose `product` is `rest`, and how many products that took."""
    used = []

    def preconditioned(values: np.ndarray) -> Any:
        used.append(1)
        return product.matvec(precondition.matvec(values.astype(rest.dtype)))

    # preconditioned from the right: what is measured is the residual itself
    whole = _FunctionOperator(product.shape, matvec=preconditioned, dtype=rest.dtype)
    change, _ = gmres(
        whole, rest, rtol=0.0, atol=tolerance, restart=_KEPT, maxiter=_RESTARTS
    )
    return precondition.matvec(change.astype(rest.dtype)), len(used)


class MapWaves(NamedTuple):
    """The waves of a map, as `rfft2` orders them, and what the material makes of
    them.
    """

    kernel: np.ndarray  # K [m/Pa], 0 for the mean
    inverse: np.ndarray  # 1/K
    # friction stress for |p_k|^2 = 1, with the waves that rfft2 leaves out [1/Pa]
    loss: np.ndarray


def waves(
    modulus: Callable[[Any], Any],
    velocity: float,
    shape: tuple[int, int],
    sides: tuple[float, float],
    angle: float = 0.0,
) -> MapWaves:
    """The waves of a map of `shape` cells on `sides` [m] that moves at `angle` to x
    [rad]; `modulus(omega)` is E* [Pa] at omega >= 0 [rad/s].
    """
    nx, ny = shape
    kx = 2 * np.pi * np.fft.fftfreq(nx, 1 / nx)[:, None] / sides[0]
    ky = 2 * np.pi * np.fft.rfftfreq(ny, 1 / ny) / sides[1]
    along = kx * np.cos(angle) + ky * np.sin(angle) if angle else kx
    value = np.conj(modulus(np.abs(along) * velocity))  # E*(-k v)
    value = np.where(along < 0, np.conj(value), value)
    # waves without a direction of their own
    if nx % 2 == 0:
        value[nx // 2] = value[nx // 2].real
    if ny % 2 == 0 and angle:
        value[:, -1] = value[:, -1].real
    k = np.hypot(kx, ky)
    k[0, 0] = 1.0
    inverse = 0.5 * k * value
    kernel = 1 / inverse
    kernel[0, 0] = inverse[0, 0] = 0.0  # the mean is given: only the rest counts
    twice = np.full(ky.size, 2.0)
    twice[0] = 1.0
    if ny % 2 == 0:
        twice[-1] = 1.0
    loss = twice * (2 * along * -value.imag / np.abs(value) ** 2) / k
    return MapWaves(kernel, inverse, loss)


class MapContact(NamedTuple):
    """The contact of a periodic map."""

    stress: float  # mean friction stress [Pa]
    area: float  # real contact area over nominal area
    separation: float  # mean gap [m]
    pressure: np.ndarray  # of each cell [Pa]
    settled: bool
    products: int  # with K, the measure of the work


def solve(
    modulus: Callable[[Any], Any],
    heights: np.ndarray,
    sides: tuple[float, float],
    *,
    velocity: float,
    pressure: float,
    angle: float = 0.0,
    start: np.ndarray | None = None,
    double: bool = True,
) -> MapContact:
    """Contact of periodic `heights` [m] (positive into the rubber) at a mean `pressure`
    [Pa]; the map moves at `angle` to x [rad].

    `start` is a map of pressures on the same grid, for its cells in contact: those of a
    neighbouring velocity or load; without it they come from a grid half as fine. The
    contact is found in 32 bits, to 1e-4 of the stress, and with `double` settled in 64.
    """
    on = waves(modulus, velocity, heights.shape, sides, angle)
    full = _in_full_contact(on, heights, pressure)
    if full is not None:
        return full
    if start is None:
        if min(heights.shape) <= _COARSEST or any(n % 2 for n in heights.shape):
            start = np.where(heights >= np.median(heights), pressure, 0.0)
        else:
            half = solve(
                modulus,
                heights[::2, ::2],
                sides,
                velocity=velocity,
                pressure=pressure,
                angle=angle,
                double=False,
            )
            start = np.repeat(np.repeat(half.pressure, 2, axis=0), 2, axis=1)
    contact = _settled(on, heights, pressure, start, np.float32, _SINGLE)
    if not double:
        return contact
    last = _settled(on, heights, pressure, contact.pressure, np.float64, _DOUBLE)
    return last._replace(products=last.products + contact.products)


def _in_full_contact(
    on: MapWaves, heights: np.ndarray, mean: float
) -> MapContact | None:
    """The solution where it is positive everywhere, from the heights' own waves; else
    None.
    """
    spread = np.fft.rfft2(heights) * on.inverse
    pressed = mean + np.fft.irfft2(spread, s=heights.shape)
    if not pressed.min() > 0:
        return None
    stress = float((on.loss * np.abs(spread / heights.size) ** 2).sum())
    return MapContact(stress, 1.0, 0.0, pressed, True, 1)


def _settled(
    on: MapWaves,
    heights: np.ndarray,
    mean: float,
    start: np.ndarray,
    real: type[np.floating],
    accuracy: Accuracy,
) -> MapContact:
    """The contact in numbers of type `real`, and its friction and area."""
    scale = float(np.std(heights))
    height = np.asarray((heights - heights.mean()) / scale, dtype=real)
    unit = mean / scale  # pressures are counted in the mean one, heights in their rms
    complex_ = np.result_type(real, np.complex64)
    cells = Convolution(
        (on.kernel * unit).astype(complex_),
        (on.inverse / unit).astype(complex_),
        height.shape,
    )
    contact = settle(
        cells,
        height,
        np.asarray(start / mean, dtype=real),
        accuracy,
        load=height.size,
    )
    transformed: Any = fft.rfft2(contact.pressure)
    most = float(on.loss.max()) or 1.0  # 32 bits hold no loss of 1e-45
    share = (on.loss / most).astype(real) * np.abs(transformed / height.size) ** 2
    return MapContact(
        float(share.sum()) * most * mean * mean,
        area_of(contact.pressure > 0),
        -contact.depth * scale,
        contact.pressure * mean,
        contact.settled,
        contact.products,
    )


def area_of(touching: np.ndarray) -> float:
    """Share of the cells in contact, corrected for the staircase of their border.

    By the length of that border (Yastrebov, Anciaux and Molinari, Tribol. Int. 114
    (2017) 161): four cells per shortest wave then give the area of ever finer grids
    within 2 %, where the cells by themselves give 10 to 15 % more.
    """
    border = sum(int((touching ^ np.roll(touching, 1, axis)).sum()) for axis in (0, 1))
    cells = float(touching.sum()) - (np.pi - 1 + np.log(2)) / 24 * border
    return cells / touching.size
