"""Can a file bring the command line down? Thousands of damaged scene, material, DMA and
surface files.

    python benchmarks/robustness/fuzz.py [--files N] [--seed S] [--computed K]

The shipped scenes and materials, and measurements and surfaces written here, are
damaged at random: bytes flipped or cut, lines deleted, doubled or exchanged, numbers
made huge, tiny, negative, nan or of another type, other encodings, empty or binary
files, folders and pipes in their place. Each run must end with status 0, 2 or 3 in good
time; with 2 there must be one line on the standard error that begins with "elastomdr:
error: ", and no run may leave a traceback. All goes through `elastomdr.cli.main.main`,
and the same files through the page's own handlers, where what is wrong must be an
`em.InputError` of one clear line, which the page shows beside a field. A scene that
survives its reading and every check of its arguments is not computed, which would take
hours, but for the first `--computed` of them.
"""

import argparse
import contextlib
import io
import os
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from damage import mutate

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 30  # seconds for a file that is only read and checked
MEMORY = 6_000_000_000  # bytes of address space, most of which JAX only reserves
COMPUTED_LIMIT = 120  # seconds for one that is computed


class TooLong(BaseException):
    """The time limit, as something that no `except Exception` catches."""


class Sound(BaseException):
    """A scene that was read and checked, and would now be computed."""


def sources(folder: Path) -> list[tuple[str, bytes, list[list[str]]]]:
    """Name, content, and the command lines that read it ("FILE" stands for its name;
    other files lie beside it).
    """
    found: list[tuple[str, bytes, list[list[str]]]] = []
    for path in sorted((ROOT / "examples" / "scenes").glob("*.toml")):
        content = path.read_bytes()
        verbs = (
            ["slide"]
            if b"[[stage]]" in content
            else ["indent"]
            if b"[history]" in content
            else []
        )
        found.append(
            (
                "scene.toml",
                content,
                [[verb, "FILE"] for verb in verbs or ["friction", "rolling", "plan"]],
            )
        )
    scene = b"""material = "rubber.toml"\ntemperature = "20 degC"
[indenter]\nshape = "profile"\nunit = "mm"\nfile = "tip.csv"
[contact]\ndepth = ["0.1 mm", "1 um"]\nvelocity = ["1 mm/s", "1 m/s"]\nmodel = "line"\n[numerics]\nrtol = 1e-4\n"""
    rough = b"""material = "rubber.toml"\n[surface]\nshape = "file"\nfile = "track.csv"\nshortest = "0.2 mm"
[contact]\npressure = "0.1 MPa"\nvelocity = "1 m/s"\n"""
    x = np.linspace(0, 10, 64)
    track = "x [mm], height [um]\n" + "\n".join(
        f"{a:.6g},{50 * np.sin(2 * a) + 20 * np.cos(5.3 * a):.6g}" for a in x
    )
    rubber = (ROOT / "materials" / "epdm-70.toml").read_bytes()
    tip = b"# a tip\nr, z\n0, 0\n1, 0.1\n2; 0.4\n3\t0.9\n4 1.6\n"
    written = {
        "friction.toml": scene,
        "rough.toml": rough,
        "track.csv": track.encode(),
        "tip.csv": tip,
    }
    for name, content in written.items():
        (folder / name).write_bytes(content)
    (folder / "rubber.toml").write_bytes(rubber)
    found += [
        ("friction.toml", scene, [["friction", "FILE"], ["plan", "FILE"]]),
        ("rough.toml", rough, [["friction", "FILE"]]),
        ("tip.csv", tip, [["friction", "friction.toml"]]),
        ("track.csv", track.encode(), [["friction", "rough.toml"]]),
    ]
    for path in sorted((ROOT / "materials").glob("*.toml")):
        found.append(
            (
                "rubber.toml",
                path.read_bytes(),
                [["materials", "./rubber.toml"], ["friction", "friction.toml"]],
            )
        )
    found += [(name, content, [["fit", "FILE"]]) for name, content in _measured()]
    q = np.geomspace(1e3, 1e5, 8)
    spectrum = "q [1/m], C [m^4]\n" + "\n".join(
        f"{a:.5g},{1e-3 * a**-3.6:.5g}" for a in q
    )
    found.append(("spectrum.csv", spectrum.encode(), [["page", "FILE"]]))
    return [
        (name, content, [*commands, ["page", "FILE"]])
        for name, content, commands in found
    ]


def _measured() -> Iterator[tuple[str, bytes]]:
    """Isotherms of a small rubber in every format that the tests write."""
    sys.path.insert(0, str(ROOT))
    import elastomdr as em
    from tests.io import dma_files

    rubber = em.Prony(
        1e6, [1e8, 1e7, 1e6], [1e-5, 1e-3, 1e-1], shift=em.WLF(8.86, 101.6, 293.15)
    )
    rows = dma_files.measure(rubber)
    writers = (
        dma_files.plain_csv,
        dma_files.two_rows,
        dma_files.tabs_in_rad,
        dma_files.decimal_comma,
        dma_files.korean,
        dma_files.trios,
        dma_files.reptate,
        dma_files.eplexor_xls,
        dma_files.eplexor_xlsx,
    )
    with tempfile.TemporaryDirectory() as folder:
        for writer in writers:
            for path in writer(Path(folder), rows)[:1]:
                yield path.name, path.read_bytes()


@contextlib.contextmanager
def only_checked(computed: int) -> Iterator[None]:
    """Stops public calls where they would begin to compute, but for the first
    `computed` scenes of each kind.
    """
    import elastomdr.rough.line
    import elastomdr.smooth.cylinder
    import elastomdr.smooth.problem
    import elastomdr.transient.drive
    import elastomdr.transient.indent
    import elastomdr.transient.slide
    from elastomdr.fit import pipeline

    smooth, rough = elastomdr.smooth, elastomdr.rough
    transient = elastomdr.transient
    stops = (
        (smooth.problem, "make_plan"),
        (rough.line, "solve_lines"),
        (transient.slide, "contact_sizes"),
        (smooth.cylinder, "_refined"),
        (transient.drive, "solve_levels"),
        (transient.indent, "indent_under"),
        (transient.indent, "indent_with_adhesion"),
        (pipeline, "master_curve"),
    )
    places: list[tuple[Any, str, Any]] = []

    def stop(module: Any, name: str) -> None:
        whole, left = getattr(module, name), [computed]

        def stopped(*args: Any, **kwargs: Any) -> Any:
            if left[0] <= 0:
                raise Sound
            left[0] -= 1
            signal.alarm(COMPUTED_LIMIT)
            return whole(*args, **kwargs)

        places.append((module, name, whole))
        setattr(module, name, stopped)

    for module, name in stops:
        stop(module, name)
    try:
        yield
    finally:
        for module, name, whole in places:
            setattr(module, name, whole)


def run(argv: list[str]) -> tuple[str, str]:
    """How a command line ended, "0", "2", "3" or "sound", and what is wrong with that,
    if anything.
    """
    from elastomdr.cli.main import main as command

    if argv[0] == "page":
        command = page
    out, err = io.StringIO(), io.StringIO()
    signal.alarm(LIMIT)
    try:
        with (
            contextlib.redirect_stdout(out),
            contextlib.redirect_stderr(err),
            warnings.catch_warnings(),
        ):
            warnings.simplefilter("error", RuntimeWarning)
            status = command(argv)
    except Sound:
        return "sound", ""
    except TooLong:
        return (
            "too long",
            f"more than {LIMIT} s (or {COMPUTED_LIMIT} s for what is computed)",
        )
    except SystemExit as stopped:
        return "exit", f"SystemExit {stopped.code}"
    except BaseException:
        return "traceback", traceback.format_exc(limit=-4)
    finally:
        signal.alarm(0)
    said = err.getvalue()
    if status == 2 and not (
        said.startswith("elastomdr: error: ")
        and said.count("\n") <= 1 + (argv[0] == "page")
        and len(said) < 2000 * (1 + (argv[0] == "page"))
    ):
        return "2", f"not one clear line: {said[:300]!r}"
    if "memory" in said:
        return "2", f"asks for too much memory: {said[:300]!r}"
    if status not in (0, 2, 3):
        return str(status), f"status {status}: {said[:300]!r}"
    if "\0" in said or "Traceback" in said:
        return str(status), f"not a clear line: {said[:300]!r}"
    return str(status), ""


def page(argv: list[str]) -> int:
    """A file dropped on the page: as the rubber it is a material or measured, as the
    road a spectrum or heights.
    """
    from elastomdr.app.road import look, recognised
    from elastomdr.app.rubber import calculate
    from elastomdr.app.scene import compute
    from elastomdr.app.session import Sessions
    from elastomdr.errors import InputError

    path = Path(argv[1])
    if not path.is_file():
        return 0  # the browser sends bytes, never a folder or a pipe
    with tempfile.TemporaryDirectory() as place:
        session, status = Sessions(Path(place)).get(None), 0
        scene = session.scenes["friction"]
        scene["contact"] = {"pressure": "0.3 MPa", "velocity": "1 m/s"}

        def road(name: str) -> None:
            scene["surface"] = recognised(session.folder, name)
            if scene["surface"]["shape"] == "spectrum":
                scene["surface"]["convention"] = "2d"
            look(scene["surface"], session)
            compute("friction", scene, session.folder)

        def rubber(name: str) -> None:
            if name.endswith(".toml"):
                compute("friction", scene | {"material": name}, session.folder)
            else:
                calculate({"data": [name]}, session)

        for handler in (rubber, road):
            try:
                handler(session.folder.keep(path.name, path.read_bytes()))
            except InputError as error:
                status = 2
                print("elastomdr: error:", error, file=sys.stderr)
                if "\n" in str(error):
                    raise ValueError("not one line") from error
                if not (error.argument and error.accepted):
                    raise ValueError("no argument, or nothing is accepted") from error
            except Sound:
                pass
        if any(
            each.is_symlink() or not each.is_relative_to(place)
            for each in Path(place).rglob("*")
        ):
            raise ValueError("a file outside the session's folder")
    return status


def _place(path: Path, content: bytes, random: np.random.Generator) -> None:
    """Puts the damaged file where the command looks for it; now and then a folder,
    nothing, or a loop of links.
    """
    strange = random.random()
    if path.is_symlink() or path.exists():
        path.rmdir() if path.is_dir() and not path.is_symlink() else path.unlink()
    if strange < 0.005:
        path.mkdir()
    elif strange < 0.01:
        path.symlink_to(path.name)
    elif strange < 0.015:
        os.mkfifo(path)
    elif strange > 0.005:
        path.write_bytes(content)


def main() -> int:
    options = argparse.ArgumentParser(
        description="Damaged files through the command line."
    )
    options.add_argument("--files", type=int, default=5000)
    options.add_argument("--seed", type=int, default=1)
    options.add_argument(
        "--computed",
        type=int,
        default=0,
        help="of each kind of scene, how many are computed",
    )
    options.add_argument(
        "--only", default="", help="only files whose name has this in it"
    )
    chosen = options.parse_args()
    sys.path.append(str(ROOT / "benchmarks"))
    from common import IN_PARTS, heading, save, table, verdict

    def alarm(*_: Any) -> None:
        raise TooLong

    signal.signal(signal.SIGALRM, alarm)
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    record = heading(
        "Fuzz: damaged files through the command line",
        f"{chosen.files} files, seed {chosen.seed}",
        f"at most {LIMIT} s each",
    )
    counts: dict[str, Counter] = {}
    bad: dict[str, tuple[list[str], str, bytes]] = {}
    failures, slowest, begin = 0, 0.0, time.perf_counter()
    with (
        tempfile.TemporaryDirectory() as folder,
        contextlib.chdir(folder),
        only_checked(chosen.computed),
    ):
        files = [entry for entry in sources(Path()) if chosen.only in entry[0]]
        if not files:
            options.error(f"--only: no file has {chosen.only!r} in its name")
        kept = {name: Path(name).read_bytes() for name in os.listdir()}
        for i in range(chosen.files):
            random = np.random.default_rng([chosen.seed, i])
            name, content, commands = files[i % len(files)]
            damaged = mutate(content, random)
            _place(Path(name), damaged, random)
            command = commands[random.integers(len(commands))]
            argv = [name if word == "FILE" else word for word in command]
            start = time.perf_counter()
            how, wrong = run(argv)
            slowest = max(slowest, time.perf_counter() - start)
            counts.setdefault(f"{command[0]}, {Path(name).suffix}", Counter())[how] += 1
            if wrong:
                failures += 1
                bad.setdefault(
                    wrong.strip().splitlines()[-1][:120], (argv, wrong, damaged)
                )
            _place(Path(name), kept.get(name, b""), _NOTHING_STRANGE)
    kinds = sorted({kind for counter in counts.values() for kind in counter})
    record["runs"] = table(
        ("verb, file", *(f"status {k}" if k.isdigit() else k for k in kinds)),
        [
            (name, *(counter[k] for k in kinds))
            for name, counter in sorted(counts.items())
        ],
    )
    for argv, wrong, damaged in bad.values():
        print(f"\n  {' '.join(argv)}: {wrong}\n    file: {damaged[:600]!r}")
    print()
    record["verdicts"] = [
        verdict(
            "runs that ended in a traceback, too late or without one clear line",
            failures,
            0,
        ),
        verdict("slowest run", slowest, LIMIT, " s"),
    ]
    print(f"  {time.perf_counter() - begin:.0f} s")
    if IN_PARTS or (chosen.files >= 5000 and not chosen.only):
        save("robustness/fuzz", record)
    return 1 if failures else 0


class _Calm:
    """A generator of random numbers for a file that is put back as it was."""

    def random(self) -> float:
        return 1.0


_NOTHING_STRANGE: Any = _Calm()


if __name__ == "__main__":
    sys.exit(main())
