"""Motions in time: what `em.slide`, `em.drive` and `em.shear` return."""

from collections.abc import Iterator
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from ..checks import (
    in_si,
    is_traced,
    numbers_only,
    one_of,
    plain,
    positive,
    significant,
)
from ..errors import InputError
from ..results.axes import Quantity
from ..results.base import Array, Result, quantity, record, setting
from ..results.doubts import carried
from ..results.words import span

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .._types import Style

_LATE = 0.8  # part of the time from which on a summary looks at the velocity
# velocities over the drive's below which a body stands, and within which of 1 it slides
_STANDS, _STEADY = 0.1, 0.5


@record
class AbstractHistory(Result):
    """A motion at the instants asked for; an instant that did not converge is NaN with
    `converged=False`.
    """

    time: Array = quantity("time", "s")
    model_error: Array = quantity(
        "bound on the error of the model", "-", "of what `error` is of; NaN: not known"
    )

    across: ClassVar[str] = "time"
    from_zero: ClassVar[bool] = False
    last: ClassVar[str] = "time"
    each: ClassVar[str] = "instants"


@record
class _OverSurface(AbstractHistory):
    """A body that moves over rubber; forces and energies per metre for a rough line."""

    error: Array = quantity(
        "estimated error of the coefficient", "-", "of mu, absolute"
    )
    per_length: bool = setting()  # whether forces and energies are per metre of line

    error_of: ClassVar[str] = "mu"
    bound_of: ClassVar[str] = "mu"

    def describe(self, q: Quantity) -> Quantity:
        """Forces and energies of a rough line are per metre of it."""
        return (
            q._replace(unit=f"{q.unit}/m")
            if self.per_length and q.unit in ("N", "J")
            else q
        )

    def spectrum(
        self,
        force: Literal["normal_force", "friction_force", "pull"] = "normal_force",
        *,
        since: float | None = None,
        period: float | None = None,
    ) -> "ForceSpectrum":
        """The spectrum of a force, such as a wheel puts into its axle when it rolls
        over a rough track.

        Args:
            force: which one; "pull" of `em.drive` only.
            since: time [s] from which on the motion counts, so that its start is left
                out; by default all of it.
            period: of the motion [s], such as the length of a periodic track over the
                velocity: the spectrum is of as many whole periods as there are after
                `since`. By default all of that time is taken as one.

        Returns:
            An `em.ForceSpectrum`. Its `error` is the difference of the amplitudes
            between the first and the second half of that time where it has two periods
            or more; NaN else.

        Raises:
            InputError: unless the instants are evenly spaced, divide the period into
                whole steps and all converged.

        Source: Bendat and Piersol, Random Data, ch. 11.
        """
        return force_spectrum(self, force, since, period)


@record
class ForceSpectrum(Result):
    """Amplitude and power of a force over frequency: `Slide.spectrum`,
    `Drive.spectrum`.

    `density` is one-sided: its sum over the frequencies times their step is the mean
    square of the force about its mean.
    """

    frequency: Array = quantity("frequency", "Hz")
    amplitude: Array = quantity("amplitude", "N", "of a wave of this frequency")
    density: Array = quantity("power density", "N^2/Hz", "one-sided")
    error: Array = quantity("estimated error of the amplitude", "N")
    model_error: Array = quantity(
        "bound on the error of the model", "N", "of the amplitude; NaN: not known"
    )
    mean: float | Array = quantity("mean force", "N", dims="")
    per_length: bool = setting(default=False)

    title: ClassVar[str] = "Spectrum of a force"
    figure: ClassVar[str] = "plot_curves.draw_amplitudes"
    across: ClassVar[str] = "frequency"
    shows: ClassVar[str] = "amplitude"
    error_of: ClassVar[str] = "the amplitude"
    each: ClassVar[str] = "frequencies"
    last: ClassVar[str] = "frequency"
    from_zero: ClassVar[bool] = False
    coordinates: ClassVar[tuple[str, ...]] = ("frequency",)

    def describe(self, q: Quantity) -> Quantity:
        """Forces of a rough line are per metre of it."""
        changed = {"N": "N/m", "N^2/Hz": "(N/m)^2/Hz"}
        return q._replace(unit=changed.get(q.unit, q.unit)) if self.per_length else q

    @property
    def rms(self) -> float:
        """Root of the mean square of the force about its mean [N, or N/m]."""
        frequency = np.asarray(self.frequency)
        step = frequency[1] - frequency[0] if frequency.size > 1 else frequency[0]
        return float(np.sqrt(np.sum(self.density) * step))

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Mean, rms and the largest amplitude."""
        unit = "N/m" if self.per_length else "N"
        largest = int(np.argmax(self.amplitude))
        yield (
            "force",
            (
                f"mean {significant(float(self.mean))} {unit}, rms about it "
                f"{significant(self.rms)} {unit}"
            ),
        )
        frequency = significant(float(self.frequency[largest]))
        yield (
            "largest amplitude",
            f"{significant(float(self.amplitude[largest]))} {unit} at {frequency} Hz",
        )


def force_spectrum(
    motion: Any, force: str, since: float | None, period: float | None
) -> ForceSpectrum:
    """`Slide.spectrum` and `Drive.spectrum`; see there."""
    later, values = _late(motion, force, since)
    time = np.asarray(motion.time)[later]
    step, each, count = np.ptp(time) / (time.size - 1), time.size - 1, 1
    if period is not None:
        each, count = _whole_periods(time, step, period)
    values = values[values.size - 1 - count * each : -1]
    amplitude, density = _waves(values, step)
    error = np.full(amplitude.shape, np.nan)
    if count > 1:
        half = (count // 2) * each
        first, second = (
            _waves(segment, step)[0] for segment in (values[:half], values[-half:])
        )
        stride = values.size / half  # of the frequencies that the halves have
        near = np.arange(1, amplitude.size + 1) / stride
        error = np.interp(near, np.arange(1, half // 2 + 1), abs(second - first))

    def in_any(points: Array) -> Array:
        return np.full(amplitude.shape, np.asarray(points)[later].any())

    return ForceSpectrum(
        frequency=np.fft.rfftfreq(values.size, step)[1:],
        amplitude=amplitude,
        density=density,
        error=error,
        model_error=np.full(amplitude.shape, np.nan),
        mean=np.asarray(values.mean()),
        converged=np.ones(amplitude.size, bool),
        marks=carried(motion.examined(), in_any),
        per_length=motion.per_length,
        model=motion.model,
        plan=f"Fourier transform of {values.size} instants",
        inputs=(
            *motion.inputs,
            ("force", force.replace("_", " ")),
            ("since", f"{significant(float(time[0]))} s"),
        ),
    )


def _late(
    motion: Any, force: str, since: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Which instants count, and the force at them. Raises `InputError` for a motion of
    which there is no spectrum.
    """
    numbers_only({"motion": motion})
    if motion.origins:
        raise InputError(
            argument="motion",
            accepted="of one material",
            hint="take the spectrum of result.select(name)",
        )
    names = ("normal_force", "friction_force", "pull")
    known = [name for name in names if hasattr(motion, name)]
    one_of("force", force, *known)
    time, values = np.asarray(motion.time), np.asarray(getattr(motion, force))
    since = float(time[0]) if since is None else plain("since", since)
    later = time >= since - 1e-9 * np.ptp(time)
    time, values = time[later], values[later]
    if time.size < 8:
        raise InputError(
            argument="since",
            got=since,
            accepted="an instant [s] that leaves eight instants or more",
            hint=f"it leaves {time.size}",
        )
    step = np.ptp(time) / (time.size - 1)
    if np.abs(np.diff(time) - step).max() > 1e-6 * step:
        raise InputError(
            argument="time",
            accepted="evenly spaced in a motion of which there is a spectrum",
            hint="give em.slide or em.drive np.linspace(...)",
        )
    if not np.isfinite(values).all():
        raise InputError(
            argument="since",
            got=since,
            accepted="an instant [s] after which all have converged",
        )
    return later, values


def _whole_periods(time: np.ndarray, step: float, period: float) -> tuple[int, int]:
    """Steps of a period, and how many periods there are. Raises `InputError`."""
    length = plain("period", period)
    positive("period", length)
    each = round(length / step)
    count = int((time.size - 1) // each) if each else 0
    if each < 4 or count < 1 or abs(each * step / length - 1) > 1e-6:
        raise InputError(
            argument="period",
            got=length,
            accepted=f"four steps of the time ({step:g} s) or more, a whole number of "
            f"them, at most what is left after since ({np.ptp(time):g} s)",
        )
    return each, count


def _waves(values: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Amplitudes, and the one-sided density, of all frequencies but zero."""
    n = values.size
    magnitude = np.abs(np.fft.rfft(values - values.mean()))[1:]
    twice = np.where((np.arange(1, magnitude.size + 1) * 2 == n), 1.0, 2.0)
    return twice * magnitude / n, twice * magnitude**2 * step / n


@record
class Slide(_OverSurface):
    """A body that moves over a viscoelastic foundation; forces and energies per metre
    for a rough line.

    `friction_force` is the force on the body against +x, positive where it resists a
    motion towards +x, and `mu` its ratio to the normal force (NaN without contact).
    `dissipated` is `work` less `stored`, all since the start.
    """

    position: Array = quantity("position", "m", "X(t)")
    velocity: Array = quantity(
        "velocity", "m/s", "dX/dt over the interval that ends here"
    )
    mu: Array = quantity("friction coefficient", "-", "F_x/F_N")
    normal_force: Array = quantity("normal force", "N", "F_N")
    friction_force: Array = quantity("friction force", "N", "F_x")
    depth: Array = quantity("depth", "m", "indentation depth d")
    work: Array = quantity("work", "J", "of normal and friction force on the rubber")
    stored: Array = quantity("stored energy", "J", "elastic, in the rubber")
    dissipated: Array = quantity("dissipated energy", "J")

    title: ClassVar[str] = "Transient sliding"
    shows: ClassVar[str] = "mu"

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Largest and last friction coefficient, and the energies."""
        yield "computed", str(self.plan)
        known = np.flatnonzero(np.isfinite(self.mu))
        if known.size:
            top, last = known[np.abs(self.mu[known]).argmax()], known[-1]
            values = (self.mu[top], self.time[top], self.mu[last], self.time[last])
            most, when, end, then = (significant(float(value)) for value in values)
            yield "result", f"largest mu = {most} at {when} s, last {end} at {then} s"
            unit = "J/m" if self.per_length else "J"
            names = ("work", "dissipated", "stored")
            yield (
                "energy",
                ", ".join(
                    f"{k} {significant(float(getattr(self, k)[last]))} {unit}"
                    for k in names
                ),
            )

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        against: Literal["time", "position"] = "time",
    ) -> "Axes":
        """Draws mu `against` "time" or "position"; the rest as of every result,
        `Result.plot`.
        """
        one_of("against", against, "time", "position")
        from ..results.plotting import DrawAsk, draw

        return self._draw(partial(draw, x=against), DrawAsk(ax, style, title, label))


@record
class Drive(_OverSurface):
    """A body driven over rubber through springs and dampers; forces and energies per
    metre for a rough line.

    `given` is the work of drive and load since the body was put down. It is in motion,
    springs and rubber (`kinetic`, `stored`) or `dissipated`, but for `imbalance`, the
    error of the time integration, held against rtol as well.
    """

    drive: Array = quantity("place of the drive", "m", "D(t)")
    position: Array = quantity("place of the body", "m", "X(t)")
    velocity: Array = quantity("velocity", "m/s", "of the body, dX/dt")
    depth: Array = quantity("depth", "m", "indentation depth d")
    mu: Array = quantity("friction coefficient", "-", "F_x/F_N")
    normal_force: Array = quantity("normal force", "N", "F_N")
    friction_force: Array = quantity("friction force", "N", "F_x")
    pull: Array = quantity(
        "pull of the drive",
        "N",
        "of the tangential spring; F_x where the drive is rigid",
    )
    given: Array = quantity("work of drive and load", "J")
    kinetic: Array = quantity("kinetic energy", "J")
    stored: Array = quantity("stored energy", "J", "in rubber and springs")
    dissipated: Array = quantity("dissipated energy", "J", "in rubber and dampers")
    imbalance: Array = quantity("missing in the energy balance", "J")

    title: ClassVar[str] = "Driven motion"
    shows: ClassVar[str] = "pull"

    def swing(self, period: float) -> Array:
        """(max X' - min X')/|mean D'| in each whole `period` [s] since the start: 0
        when the body follows the drive.

        It dies out where the drive damps; a body that sticks and slips swings on, by
        more than 1 as a rule. Take the period of the mass on its spring, 2 pi
        sqrt(m/k), and instants enough to see it. NaN in a period with an instant that
        did not converge, or in which the drive stands. Works under `jax.vmap` over what
        is driven. Raises `InputError`.
        """
        length, time = plain("period", period), np.asarray(self.time)
        positive("period", length)
        # 1 for the first, its end included
        number = np.ceil((time - time[0]) / length * (1 - 1e-12)).astype(int)
        count = int((time[-1] - time[0]) / length * (1 + 1e-12))
        if (
            not 1 <= count < time.size
            or np.bincount(number, minlength=count + 1)[1 : count + 1].min() < 2
        ):
            raise InputError(
                argument="period",
                got=length,
                accepted="no longer than the motion [s], and so long that two instants "
                "or more are in each",
            )
        xp: Any = np
        if is_traced(self):
            import jax.numpy as xp
        ends = [np.flatnonzero(number <= j)[-1] for j in range(count + 1)]
        swings = []
        for first, last in pairwise(ends):
            speed = (self.drive[last] - self.drive[first]) / (time[last] - time[first])
            velocity = self.velocity[first + 1 : last + 1]
            swings.append(
                (velocity.max() - velocity.min())
                / xp.where(speed == 0, xp.nan, abs(speed))
            )
        return xp.stack(swings)

    def _late(self) -> tuple[np.ndarray, float]:
        """The instants of the last fifth of the time, and the mean velocity of the drive
        in it; 0 where there are too few.
        """
        start, end = self.time[0], self.time[-1]
        late = np.flatnonzero(
            self.converged & (self.time >= start + _LATE * (end - start))
        )
        if late.size < 2:
            return late, 0.0
        ends = late[[0, -1]]
        return late, np.ptp(self.drive[ends]) / np.ptp(self.time[ends])

    @in_si
    def stick_slip(self, normal_force: float | None = None) -> str:
        """Whether the body sticks and slips in the last fifth of the time, in a
        sentence that begins with yes or no.

        Yes: it stands (below a tenth of the drive's velocity) and jumps; no: its
        velocity stays within half of the drive's. What lies between is not decided.
        Friction is in newtons, of a rough line per metre or, given the `normal_force`
        [N] of the whole body, of that body. Raises `InputError`.
        """
        late, mean = self._late()
        if not mean:
            return (
                "not decided: the drive stands in the last fifth of the time, or "
                "nothing converged there"
            )
        share, unit = 1.0, "N/m" if self.per_length else "N"
        if normal_force is not None:
            whole = plain("normal_force", normal_force)
            positive("normal_force", whole)
            share, unit = whole / float(np.mean(self.normal_force[late])), "N"
        low, high = (float(x(self.velocity[late])) / mean for x in (np.min, np.max))
        velocity_range = (
            f"{significant(low, 3)} to {significant(high, 3)} times the drive's"
        )
        force = f"friction {span(share * self.friction_force[late], unit)}"
        if low < _STANDS and high > 1 + _STEADY:
            return (
                "yes: the body stands and jumps, its velocity is "
                f"{velocity_range}; {force}"
            )
        if low > 1 - _STEADY and high < 1 + _STEADY:
            return (
                "no: the body follows the drive, its velocity is "
                f"{velocity_range}; {force}"
            )
        return (
            f"not decided: its velocity is {velocity_range}, so compute a longer motion; "
            f"{force}"
        )

    def outcome(self) -> Iterator[tuple[str, str]]:
        """Ranges of friction and normal force, the energy balance, the velocity late in
        the motion, stick-slip.
        """
        yield "computed", str(self.plan)
        good = np.flatnonzero(self.converged)
        if good.size:
            unit, joule = ("N/m", "J/m") if self.per_length else ("N", "J")
            yield "friction", span(self.friction_force[good], unit)
            yield "normal force", span(self.normal_force[good], unit)
            names = ("given", "kinetic", "stored", "dissipated", "imbalance")
            yield (
                "energy",
                ", ".join(
                    f"{k} {significant(getattr(self, k)[good[-1]])} {joule}"
                    for k in names
                ),
            )
        late, speed = self._late()
        if speed:
            low, high = (
                significant(float(x(self.velocity[late])) / speed, 3)
                for x in (np.min, np.max)
            )
            yield (
                "velocity",
                f"{low} to {high} times the drive's in the last fifth of the time",
            )
            yield "stick-slip", self.stick_slip()

    def plot(
        self,
        ax: "Axes | None" = None,
        style: "Style | None" = None,
        *,
        title: str | None = None,
        label: str | None = None,
        show: str = "pull",
    ) -> "Axes":
        """Draws one field against time, by default the pull of the drive; the rest as
        of every result.
        """
        fields = [q.path for q in self.quantities() if q.unit and q.path != "time"]
        self._check_shown(show, *fields)
        from ..results.plotting import DrawAsk, draw

        return self._draw(partial(draw, y=show), DrawAsk(ax, style, title, label))


@record
class Shear(AbstractHistory):
    """Tangential loading with stick and slip."""

    displacement: Array = quantity(
        "tangential displacement", "m", "of the body", shown="µm"
    )
    force: Array = quantity("tangential force", "N", "on the body's side that moves it")
    normal_force: Array = quantity("normal force", "N")
    depth: Array = quantity("depth", "m")
    contact_radius: Array = quantity("contact radius", "m")
    stick_radius: Array = quantity(
        "stick radius", "m", "inside, nothing slipped in the last step"
    )
    work: Array = quantity(
        "tangential work", "J", "done by the tangential force since the start"
    )
    slip_loss: Array = quantity(
        "lost by slip", "J", "of the work, turned into heat by slip"
    )
    stored: Array = quantity(
        "stored tangentially",
        "J",
        "of the work, elastic energy; the rest heats the rubber",
    )
    error: Array = quantity("estimated error of the tangential force", "N")
    model_error: Array = quantity(
        "bound on the error of the model", "N", "of the force; NaN: not known"
    )

    title: ClassVar[str] = "Tangential loading with friction"
    across: ClassVar[str] = "displacement"
    shows: ClassVar[str] = "force"
    error_of: ClassVar[str] = "the force"

    def outcome(self) -> Iterator[tuple[str, str]]:
        """The largest force, and what became of the work."""
        good = np.asarray(self.converged)
        if good.any():
            force = np.abs(np.asarray(self.force)[good])
            largest = int(force.argmax())
            when = np.asarray(self.time)[good][largest]
            yield (
                "largest force",
                (
                    f"{significant(float(force[largest]))} N at "
                    f"{significant(float(when))} s"
                ),
            )
            work, slip, stored = (
                float(np.asarray(x)[good][-1])
                for x in (self.work, self.slip_loss, self.stored)
            )
            yield (
                "work",
                (
                    f"{significant(work)} J: slip {significant(slip)} J, stored "
                    f"{significant(stored)} J"
                ),
            )
