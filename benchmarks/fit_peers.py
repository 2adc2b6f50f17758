"""Shift factors and Prony series beside other tools: pyvisco and Gaussian-process
shifting, where they are installed.

    python benchmarks/fit_peers.py DATA_DIR

DATA_DIR holds the measured data, one folder per set, as `fit_library.py` describes.
Shifting alone is compared on the same isotherms, without any Prony series: a
polyisoprene melt with a published WLF law, synthetic data of a known law (210 points,
noise 1 %, vertical shifts of entropy elasticity), and EPDM-70, whose law nobody knows.
`master_curve` shifts both moduli jointly and vertically, estimates noise and widths,
fits three laws, and repeats all of it without vertical shifts for the uncertainty of
that choice. mastercurves takes one modulus at a time, pair by pair, horizontally and
vertically: it shifts storage, then loss, and the better one counts, or their mean.
pyvisco shifts the storage modulus horizontally. Then come relative residuals of Prony
series through the same points, two sets of them pyvisco's own samples (a master curve,
and isotherms as it shifts them), and the figures asked of EPDM. A tool that is not
installed is said to be missing.
"""

import argparse
import contextlib
import importlib.util
import io
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from common import heading, one_core, save, table, timed, verdict
from threadpoolctl import threadpool_limits

import elastomdr as em

# polyisoprene: A. Likhtman 2006, in RepTate's database
PUBLISHED = em.WLF(4.965, 139.3, 298.15).at_reference(263.15)

# tool, what it shifts, log10 a_T, processor time [s]
Shifted = tuple[str, str, np.ndarray, float]


def installed(name: str) -> bool:
    return importlib.util.find_spec(name) is not None


class Isotherms:
    """One set of isotherms for all tools, and log10 a_T as it is known, zero at the
    reference temperature.
    """

    def __init__(
        self, name: str, dma: em.fit.Dma, reference: float, law: em.WLF | None
    ):
        self.name, self.dma, self.reference = name, dma, reference
        self.master = em.fit.master_curve(dma, reference)
        self.truth = (
            None if law is None else np.asarray(law.log10_a(self.master.temperature))
        )

    def error(self, log10_a: np.ndarray) -> float:
        """Root mean square of log10 a_T less the known one, both zero at the reference
        temperature.
        """
        return (
            np.nan
            if self.truth is None
            else float(np.sqrt(np.mean((log10_a - self.truth) ** 2)))
        )

    def zeroed(self, log10_a: np.ndarray) -> np.ndarray:
        return log10_a - np.interp(self.reference, self.master.temperature, log10_a)


def synthetic() -> Isotherms:
    """Ten isotherms of 21 points of a library rubber, as entropy elasticity lifts them,
    with 1 % of noise.
    """
    rubber, rng, parts = em.load_material("sbr-gum-like"), np.random.default_rng(0), []
    omega = 2 * np.pi * np.geomspace(0.1, 100.0, 21)
    for kelvin in np.arange(258.15, 349.0, 10.0):
        lift = kelvin / 298.15
        moduli = lift * np.asarray(rubber.at(kelvin).complex_modulus(omega))
        storage, loss = (
            part * (1 + 0.01 * rng.normal(size=omega.size))
            for part in (moduli.real, moduli.imag)
        )
        parts.append(em.fit.dma(omega, storage, loss, kelvin, kind="shear"))
    return Isotherms(
        "synthetic rubber",
        em.fit.join(*parts),
        298.15,
        rubber.shift.at_reference(298.15),
    )


def residuals(
    storage: np.ndarray, loss: np.ndarray, data: tuple[np.ndarray, np.ndarray]
) -> tuple[float, float]:
    return tuple(
        100 * float(np.sqrt(np.mean((a / b - 1) ** 2)))
        for a, b in zip((storage, loss), data, strict=True)
    )


def isotherms(dma: em.fit.Dma, master: em.fit.MasterCurve) -> list[np.ndarray]:
    number = np.abs(dma.temperature[:, None] - master.temperature).argmin(axis=1)
    parts = [np.flatnonzero(number == i) for i in range(master.temperature.size)]
    return [part[np.argsort(dma.omega[part])] for part in parts]


def pyvisco_table(dma: em.fit.Dma, master: em.fit.MasterCurve) -> bytes:
    """The isotherms as pyvisco reads them, with temperatures rounded as it does."""
    rows = ["f,E_stor,E_loss,T,Set", "Hz,MPa,MPa,C,-"]
    for i, part in enumerate(isotherms(dma, master)):
        for k in part:
            rows.append(
                f"{dma.omega[k] / (2 * np.pi):.12g},{dma.storage[k] / 1e6:.12g},{dma.loss[k] / 1e6:.12g},"
                f"{round(master.temperature[i] - 273.15)},{i}"
            )
    return ("\n".join(rows) + "\n").encode()


@contextlib.contextmanager
def silence():
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def pyvisco_shift(data: Isotherms) -> Iterator[Shifted]:
    from pyvisco import load
    from pyvisco import master as shifting

    with silence():
        raw, _, _ = load.user_raw(pyvisco_table(data.dma, data.master), "freq", "E")
        reference = round(data.reference - 273.15)
        found = timed(lambda: np.array(shifting.get_aT(raw, reference)[0]["log_aT"]), 2)
    yield "pyvisco", "storage", data.zeroed(found.value), found.cpu


def pyvisco_master(path: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """pyvisco's sample isotherms as it shifts them: angular frequency, storage and loss
    modulus, where positive.
    """
    from pyvisco import load
    from pyvisco import master as shifting

    with silence():
        raw, _, _ = load.user_raw(path.read_bytes(), "freq", "E")
        frame = shifting.get_curve(raw, shifting.get_aT(raw, -5)[0], -5)
    omega, storage, loss = (
        2 * np.pi * frame["f"],
        1e6 * frame["E_stor"],
        1e6 * frame["E_loss"],
    )
    keep = np.asarray((storage > 0) & (loss > 0))
    return tuple(np.asarray(part)[keep] for part in (omega, storage, loss))


def gaussian_process_shift(data: Isotherms) -> Iterator[Shifted]:
    """Each modulus by mastercurves, from cold to warm, a horizontal and a vertical
    factor per isotherm.
    """
    import mastercurves
    from mastercurves.transforms import Multiply

    parts = isotherms(data.dma, data.master)

    def run(modulus: np.ndarray) -> np.ndarray:
        curve = mastercurves.MasterCurve()
        curve.add_data(
            [np.log(data.dma.omega[k]) for k in parts],
            [np.log(modulus[k]) for k in parts],
            [float(t - 273.15) for t in data.master.temperature],
        )
        curve.add_htransform(Multiply(bounds=(1e-3, 1e3)))
        curve.add_vtransform(Multiply(bounds=(0.8, 1.25)))
        curve.superpose()
        return data.zeroed(np.log10(np.array(curve.hparams[0])))

    # threads that wait for each other on one core would count as work
    with silence(), threadpool_limits(1):
        storage, loss = (
            timed(lambda m=modulus: run(m), 2)
            for modulus in (data.dma.storage, data.dma.loss)
        )
    yield "mastercurves", "storage", storage.value, storage.cpu
    yield "mastercurves", "loss", loss.value, loss.cpu
    yield (
        "mastercurves",
        "both, mean",
        (storage.value + loss.value) / 2,
        storage.cpu + loss.cpu,
    )


def compare_shifts(
    data: Isotherms,
) -> tuple[list[tuple[Any, ...]], list[dict[str, Any]]]:
    """Rows of the table, and how `master_curve` does against Gaussian processes."""
    ours = timed(lambda: em.fit.master_curve(data.dma, data.reference), 5)
    found = [("elastomdr", "both, jointly", ours.value.log10_a, ours.cpu)]
    for name, call in (
        ("pyvisco", pyvisco_shift),
        ("mastercurves", gaussian_process_shift),
    ):
        if not installed(name):
            continue
        try:
            found += list(call(data))
        except Exception as error:  # another tool's failure is a result, not ours
            found.append(
                (
                    f"{name}: {type(error).__name__}",
                    "",
                    np.full(data.master.temperature.size, np.nan),
                    np.nan,
                )
            )
    points = data.dma.omega.size
    rows = [
        (data.name, points, name, what, data.error(log10_a), time)
        for name, what, log10_a, time in found
    ]
    peers = [row for row in rows if row[2] == "mastercurves"]
    if not peers:
        return rows, []
    names = (
        f"{data.name}: times faster than mastercurves",
        f"{data.name}: rms log10 a_T against mastercurves at best",
    )
    verdicts = [verdict(names[0], peers[-1][5] / ours.cpu, 10.0, least=True)]
    if data.truth is not None:
        verdicts.append(verdict(names[1], rows[0][4], min(row[4] for row in peers)))
    return rows, verdicts


def pyvisco_prony(
    omega: np.ndarray, storage: np.ndarray, loss: np.ndarray, fewest: bool
):
    """pyvisco's series through a master curve: one term a decade, or its own choice of
    fewer.
    """
    from pyvisco import load, opt, prony
    from pyvisco import master as shifting

    order = np.argsort(omega)
    rows = ["f,E_stor,E_loss", "Hz,MPa,MPa"]
    rows += [
        f"{omega[k] / (2 * np.pi):.12g},{storage[k] / 1e6:.12g},{loss[k] / 1e6:.12g}"
        for k in order
    ]

    def run():
        frame, _ = load.user_master(("\n".join(rows) + "\n").encode(), "freq", 20, "E")
        frame = shifting.smooth(frame, 1)
        series, _ = prony.fit(prony.discretize(frame), frame)
        if fewest:
            all_series, best, _ = opt.nprony(frame, series)
            series = all_series[best]
        return series

    with silence():
        found = timed(run)
    terms, glassy = found.value["df_terms"], 1e6 * found.value["E_0"]
    moduli, times = glassy * np.array(terms["alpha_i"]), np.array(terms["tau_i"])
    x = omega[:, None] * times
    fitted = (
        glassy - moduli.sum() + (moduli * x**2 / (1 + x**2)).sum(1),
        (moduli * x / (1 + x**2)).sum(1),
    )
    return residuals(*fitted, (storage, loss)), len(terms), found.wall


def cold(path: Path) -> tuple[float, float]:
    """Seconds of `elastomdr fit`, from the start of the process to its end, on the
    clock and of processor time.
    """
    with tempfile.TemporaryDirectory() as folder:
        begin, before = time.perf_counter(), os.times()
        code = (
            "import sys; from elastomdr.cli.main import main; "
            "sys.exit(main(sys.argv[1:]))"
        )
        command = [
            sys.executable,
            "-c",
            code,
            "fit",
            str(path),
            "--reference",
            "25degC",
            "--out",
            folder,
        ]
        subprocess.run(command, check=True, capture_output=True)
        after = os.times()
        busy = (
            after.children_user
            - before.children_user
            + after.children_system
            - before.children_system
        )
        return time.perf_counter() - begin, busy


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    data = parser.parse_args().data
    os.environ.setdefault("MPLBACKEND", "agg")
    one_core()
    record = heading(
        "Fits beside other tools",
        "measured data; residuals are relative, root mean square",
    )
    missing = [name for name in ("pyvisco", "mastercurves") if not installed(name)]
    record["missing"] = missing
    if missing:
        print(f"  not installed, and left out: {', '.join(missing)}")
    warnings.simplefilter("ignore", em.fit.FitWarning)
    melt = em.read_dma(sorted((data / "polyisoprene-34k").glob("*.osc")))
    epdm = em.read_dma(data / "epdm-70" / "tf_015p.csv")
    em.fit.material(epdm, 298.15)  # loads and warms everything

    sets = (
        Isotherms("polyisoprene", melt, 263.15, PUBLISHED),
        synthetic(),
        Isotherms("EPDM-70", epdm, 298.15, None),
    )
    compared = [compare_shifts(one) for one in sets]
    columns = (
        "isotherms",
        "points",
        "shifted by",
        "moduli",
        "rms log10 a_T off the known",
        "seconds of one core",
    )
    record["shifts"] = table(columns, [row for rows, _ in compared for row in rows])

    sample = em.read_dma(data / "pv-encapsulant" / "freq_user_master.csv").at(268.15)
    keep = (sample.storage > 0) & (sample.loss > 0)
    adhesive = em.fit.master_curve(
        em.read_dma(data / "psa-468mp" / "frequency_sweep_tts.txt"), 303.15
    )
    rubber = em.fit.master_curve(epdm, 298.15)
    cases = {
        "pyvisco's sample master curve": (
            sample.omega[keep],
            sample.storage[keep],
            sample.loss[keep],
            "tensile",
        ),
        "EPDM-70": (rubber.omega, rubber.storage, rubber.loss, "shear"),
        "468MP adhesive": (adhesive.omega, adhesive.storage, adhesive.loss, "shear"),
    }
    if installed("pyvisco"):
        shifted = pyvisco_master(data / "pv-encapsulant" / "freq_user_raw.csv")
        cases["pyvisco's sample isotherms, shifted by it"] = (*shifted, "tensile")
    series = []
    for name, (omega, storage, loss, kind) in cases.items():
        found = timed(
            lambda o=omega, s=storage, l=loss, k=kind: em.fit.prony(o, s, l, kind=k)
        )
        fit = found.value
        series.append(
            (
                name,
                "elastomdr",
                100 * fit.storage_residual,
                100 * fit.loss_residual,
                fit.terms,
                found.wall,
            )
        )
        if installed("pyvisco"):
            for label, fewest in (
                ("pyvisco, one a decade", False),
                ("pyvisco, its choice", True),
            ):
                try:
                    off, count, seconds = pyvisco_prony(omega, storage, loss, fewest)
                    series.append((name, label, *off, count, seconds))
                except Exception as error:
                    series.append(
                        (
                            name,
                            f"{label}: {type(error).__name__}",
                            np.nan,
                            np.nan,
                            0,
                            np.nan,
                        )
                    )
    columns = (
        "Prony series through",
        "by",
        "storage [%]",
        "loss [%]",
        "terms",
        "seconds",
    )
    record["series"] = table(columns, series)

    whole = timed(lambda: em.fit.material(epdm, 298.15), 3)
    widest = em.read_dma(data / "pv-encapsulant" / "freq_user_raw.csv")
    broad = timed(lambda: em.fit.material(widest, 268.15), 3)
    command = cold(data / "epdm-70" / "tf_015p.csv")
    record["clock"] = table(
        ("on the clock of this machine", "seconds"),
        (
            ("210 points, warm", whole.wall),
            ("over 22 decades", broad.wall),
            ("cold command", command[0]),
        ),
    )
    fit = whole.value
    hot = [text for text in fit.warnings if "Horizontal and vertical" in text]
    used = em.fit.material(epdm, 293.15).misfit
    print()
    verdicts = [
        verdict(
            "polyisoprene, rms log10 a_T",
            record["shifts"][0]["rms log10 a_T off the known"],
            0.03,
        ),
        verdict(
            "EPDM-70, storage, about the master curve",
            100 * fit.prony.storage_residual,
            3.0,
            " %",
        ),
        verdict(
            "EPDM-70, loss, about the master curve",
            100 * fit.prony.loss_residual,
            8.0,
            " %",
        ),
        verdict(
            "EPDM-70 about 20 degC, storage, as measured",
            100 * used["storage modulus"],
            3.0,
            " %",
        ),
        verdict(
            "EPDM-70 about 20 degC, loss, as measured",
            100 * used["loss modulus"],
            8.0,
            " %",
        ),
        verdict("EPDM-70, terms", fit.prony.terms, 12),
        verdict(
            "EPDM-70, isotherms above 32 degC not told apart",
            int(rubber.ambiguous[-3:].sum()),
            3,
            least=True,
        ),
        verdict("210 points, warm, processor time", whole.cpu, 1.0, " s"),
        verdict(
            "210 points over 22 decades, warm, processor time", broad.cpu, 1.0, " s"
        ),
        verdict("210 points, cold command, processor time", command[1], 8.0, " s"),
    ]
    for other in series:
        if other[1].startswith("pyvisco") and np.isfinite(other[2]):
            mine = next(
                row for row in series if row[0] == other[0] and row[1] == "elastomdr"
            )
            for which, at in (("storage", 2), ("loss", 3)):
                verdicts.append(
                    verdict(
                        f"{other[0]}, {which}, against {other[1]}",
                        mine[at],
                        other[at],
                        " %",
                    )
                )
    verdicts += [one for _, some in compared for one in some]
    print(f"  EPDM-70 says: {hot[0] if hot else 'nothing of vertical shifts'}")
    record["verdicts"] = verdicts
    save("fit_peers", record)


if __name__ == "__main__":
    main()
