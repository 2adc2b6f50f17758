"""What every result can do: be a table, a CSV file, a dict, a DataFrame, a Dataset, and a few readable lines."""

import abc
import errno
import operator
import os
import tempfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

import equinox as eqx
import jax
import numpy as np

from .. import __version__
from .._runtime import is_traced, significant
from ..errors import InputError
from .axes import Axis, Curve, curves, dimensions


class Column(NamedTuple):
    """One column of a table: the result's field it shows, its name in words, its unit."""

    field: str  # a dotted path, such as "contact.leading"
    name: str
    unit: str  # "-" for a plain number, "" for yes or no
    optional: bool = False  # whether the field may be None

    @property
    def title(self) -> str:
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    @property
    def key(self) -> str:
        return self.field.rpartition(".")[2]


class AbstractResult(eqx.Module):
    """A result with one value per point in each of its fields, all of one shape; a field that is None has no column."""

    model: eqx.AbstractVar[str]  # the model's name, in words
    plan: eqx.AbstractVar[Any]  # what was computed, skipped and condensed
    inputs: eqx.AbstractVar[tuple[tuple[str, str], ...]]  # name and value of what was asked for, in words
    error: eqx.AbstractVar[Any]  # estimated error of the result's main number
    converged: eqx.AbstractVar[Any]

    quantity: ClassVar[str]  # what the result is called in a title
    coordinates: ClassVar[tuple[str, ...]] = (
        "time",
        "velocity",
        "temperature",
        "pressure",
        "normal_force",
        "force",
        "depth",
    )
    # the fields after which an axis may be called: of several that change along it the first

    @property
    @abc.abstractmethod
    def table(self) -> tuple[Column, ...]:
        """The columns, in order."""

    @abc.abstractmethod
    def findings(self) -> Iterator[tuple[str, str]]:
        """What went in and what came out, as pairs of a name and a text."""

    def heading(self) -> str:
        """A title: the quantity, and the material where it is known."""
        material = dict(self.inputs).get("material")
        return f"{self.quantity}, {material}" if material else self.quantity

    def reached(self, of: str, unit: str = "", also: str = "") -> str:
        """How many points converged, what `also` was counted, and the largest estimated `of`, such as "error of mu"."""
        good, error = np.asarray(self.converged), np.asarray(self.error)
        failed = int(np.sum(~good))
        text = f"{good.size}, {f'{failed} did not converge' if failed else 'all converged'}{also}"
        if np.isfinite(error).any():
            text += f"; largest estimated {of}: {significant(float(np.fmax.reduce(error, axis=None)), 2)}{unit}"
        return text

    @abc.abstractmethod
    def plot(self, ax: Any = None) -> Any:
        """Draws the result and returns the matplotlib Axes; with `ax=None` on a new figure, its `.figure`."""

    def png(self, title: str | None = None) -> bytes:
        """The figure as a PNG image, 200 dots per inch."""
        from .figure import saved

        plot: Any = self.plot  # every result's own has a title
        return saved(plot(title=title))

    def summary(self) -> str:
        """What went in and what came out, in a few lines of text."""
        if is_traced(self):
            return repr(self)
        findings = list(self.findings())
        width = max(len(name) for name, _ in findings) + 2
        return "\n".join(f"{name:<{width}}{text}" for name, text in findings)

    def fields(self) -> dict[Column, np.ndarray]:
        """The columns that have values, each as an array of the result's shape. Raises `InputError` while traced."""
        if is_traced(self):
            raise InputError(
                f"{type(self).__name__} has no numbers while JAX traces it. Make tables outside jit, grad and vmap."
            )
        values = {column: operator.attrgetter(column.field)(self) for column in self.table}
        return {column: np.asarray(value) for column, value in values.items() if value is not None}

    def axes(self) -> list[Axis]:
        """The axes of the fields by name, such as velocity and temperature, with their values."""
        return dimensions(self.fields(), self.coordinates)

    def curves(self, along: str = "velocity") -> tuple[Axis, list[Curve]]:
        """One axis, the one named `along` or else the last, and where the curves along it are, with their labels."""
        return curves(self.axes(), along)

    def columns(self) -> dict[str, np.ndarray]:
        """Column title with its unit, such as "velocity [m/s]", to the values, flattened in C order."""
        return {column.title: value.ravel() for column, value in self.fields().items()}

    def header(self, notes: Iterable[tuple[str, str]] = ()) -> list[str]:
        """What a table has to carry besides its numbers: version, notes, inputs, model, findings, one line each."""
        lines = [f"elastomdr {__version__}: {type(self).__name__}", "units: SI, in brackets in the column titles"]
        return [
            " ".join(line.split())
            for line in [*lines, *(f"{name}: {text}" for name, text in (*notes, *self.findings()))]
        ]

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a comma-separated table, its first lines a header that starts with "# ".

        Opens with `pandas.read_csv(path, comment="#")` and in a spreadsheet. Numbers have as many digits, up to 17, as
        it takes to read back the same float64; one that is not known, since its point failed, is an empty cell. The
        file appears when it is complete, or not at all. Raises `InputError` where it cannot be written.
        """
        write_files({Path(path): self.csv().encode()})

    def csv(self, notes: Iterable[tuple[str, str]] = ()) -> str:
        """The text that `to_csv` writes; `notes` are more pairs of name and text for its header."""
        columns = self.columns()
        rows = zip(*(map(_cell, column.tolist()) for column in columns.values()), strict=True)
        lines = [f"# {line}" for line in self.header(notes)]
        lines += [",".join(columns), *(",".join(row) for row in rows)]
        return "\n".join(lines) + "\n"

    def to_dict(self) -> dict[str, Any]:
        """Field name to an array of the result's shape, in SI units; with "model", "plan" and "inputs" in words."""
        values: dict[str, Any] = {column.key: value for column, value in self.fields().items()}
        return values | {"model": self.model, "plan": str(self.plan), "inputs": dict(self.inputs)}

    def to_pandas(self) -> Any:
        """A pandas DataFrame of `columns()`, with model and inputs as `attrs`. Raises `InputError` without pandas."""
        try:
            import pandas
        except ImportError as error:
            raise _missing("pandas") from error
        frame = pandas.DataFrame(self.columns())
        frame.attrs.update(self._attributes())
        return frame

    def to_xarray(self) -> Any:
        """An xarray Dataset, its axes what was given (velocity, temperature, load). Raises `InputError` without it."""
        try:
            import xarray
        except ImportError as error:
            raise _missing("xarray") from error
        fields = {column.key: (column, value) for column, value in self.fields().items()}
        axes = self.axes()
        coordinates = {axis.name: (axis.name, axis.values, {"units": axis.unit}) for axis in axes if axis.unit}
        data = {
            key: (tuple(axis.name for axis in axes), value, {"long_name": column.name, "units": column.unit})
            for key, (column, value) in fields.items()
            if key not in coordinates
        }
        return xarray.Dataset(data, coords=coordinates, attrs=self._attributes())

    def _attributes(self) -> dict[str, str]:
        return {**dict(self.inputs), "model": self.model, "elastomdr": __version__}

    def __repr__(self) -> str:
        values = [(column, operator.attrgetter(column.field)(self)) for column in self.table]
        arrays = (np.ndarray, np.generic, jax.Array)
        known = all(isinstance(x, arrays) or (x is None and column.optional) for column, x in values)
        if known and not is_traced(self):
            return f"{type(self).__name__}\n{self.summary()}"
        shapes = sorted({str(np.shape(x)) for _, x in values if isinstance(x, arrays)})
        return f"{type(self).__name__}({self.model}; without numbers, shape {' or '.join(shapes) or 'unknown'})"


def write_files(files: Mapping[Path, bytes]) -> None:
    """Writes files that are complete whenever they are there: to neighbours first, then all of them moved into place.

    Raises `InputError` in one line, and leaves nothing behind, where a folder is missing or cannot be written.
    """
    mask = os.umask(0)
    os.umask(mask)
    prepared: dict[Path, Path] = {}
    target = Path()
    try:
        for target, content in files.items():
            if target.is_dir():
                raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
            handle, name = tempfile.mkstemp(dir=target.parent, prefix=".elastomdr-")
            prepared[target] = Path(name)
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            prepared[target].chmod(0o666 & ~mask)  # mkstemp makes private files; a table is as readable as any other
        for target, temporary in prepared.items():
            temporary.replace(target)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) and error.strerror else error
        raise InputError(f"path must be a file that can be written, got {str(target)!r}: {reason}.") from error
    finally:
        for temporary in prepared.values():
            temporary.unlink(missing_ok=True)


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return "" if np.isnan(value) else repr(value)
    return str(value)


def _missing(package: str) -> InputError:
    return InputError(f"{package} is not installed, and this needs it: pip install elastomdr[tables]")
