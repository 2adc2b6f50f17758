"""Reads a surface in the format of an instrument and prints it as an .npz file: a
program of its own.

Run by `surface.py`. The reader, SurfaceTopography, takes seconds to load and knows some
forty formats, most of them binary; what a damaged file makes of one costs a child and
not the session.
"""

import contextlib
import io
import sys

MOST_MEMORY = 8_000_000_000  # bytes of address space


def main(path: str) -> int:
    """Prints x, y (empty for a profile), heights with NaN in holes, the unit, and
    whether the file says the size.

    Where it does not, x and y count points. Returns 0, or prints why not and 1.
    """
    # Windows has no such limits
    with contextlib.suppress(ImportError, OSError, ValueError):
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (MOST_MEMORY, MOST_MEMORY))
    import numpy as np
    from SurfaceTopography import open_topography  # pyright: ignore[reportMissingImports]

    try:
        with contextlib.redirect_stdout(sys.stderr):
            reader = open_topography(path)
            channel = reader.default_channel
            sized = channel.physical_sizes is not None
            topography = (
                reader.topography()
                if sized
                else reader.topography(physical_sizes=channel.nb_grid_pts)
            )
            height = np.ma.filled(
                np.ma.asarray(topography.heights(), dtype=float), np.nan
            )
            if topography.dim == 1:
                x, y = np.asarray(topography.positions(), dtype=float), np.empty(0)
            else:
                x, y = (
                    np.arange(n) * size / n
                    for n, size in zip(
                        topography.nb_grid_pts, topography.physical_sizes, strict=True
                    )
                )
    except Exception as error:  # whatever one of forty parsers may raise
        print(f"{type(error).__name__}: {error}")
        return 1
    buffer = io.BytesIO()
    np.savez(
        buffer,
        x=x,
        y=y,
        height=height,
        unit=np.array(topography.unit or ""),
        sized=np.array(sized),
    )
    sys.stdout.buffer.write(buffer.getvalue())
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
