"""Shift factors and Prony series beside other tools: pyvisco and Gaussian-process shifting, where they are installed.

    python benchmarks/fit_peers.py DATA_DIR

DATA_DIR holds the measured data, one folder per set, as `fit_library.py` describes. Compared are log10 a_T of a
polyisoprene melt with its published WLF law, and relative residuals of Prony series through the same master curves, one
of them pyvisco's own sample; then the figures asked of EPDM. A tool that is not installed is said to be missing.
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
from pathlib import Path

import numpy as np
from common import heading, one_core, save, table, timed, verdict

import elastomdr as em

PUBLISHED = em.WLF(4.965, 139.3, 298.15).at_reference(263.15)  # polyisoprene: A. Likhtman 2006, in RepTate's database


def installed(name: str) -> bool:
    return importlib.util.find_spec(name) is not None


def off_published(temperature: np.ndarray, log10_a: np.ndarray) -> float:
    """Root mean square of log10 a_T less the published law, both zero at -10 degC."""
    return float(np.sqrt(np.mean((log10_a - np.asarray(PUBLISHED.log10_a(temperature))) ** 2)))


def residuals(storage: np.ndarray, loss: np.ndarray, data: tuple[np.ndarray, np.ndarray]) -> tuple[float, float]:
    return tuple(100 * float(np.sqrt(np.mean((a / b - 1) ** 2))) for a, b in zip((storage, loss), data, strict=True))


def isotherms(dma: em.fit.Dma, master: em.fit.MasterCurve) -> list[np.ndarray]:
    number = np.abs(dma.temperature[:, None] - master.temperature).argmin(axis=1)
    parts = [np.flatnonzero(number == i) for i in range(master.temperature.size)]
    return [part[np.argsort(dma.frequency[part])] for part in parts]


def pyvisco_table(dma: em.fit.Dma, master: em.fit.MasterCurve) -> bytes:
    """The isotherms as pyvisco reads them, with temperatures rounded as it does."""
    rows = ["f,E_stor,E_loss,T,Set", "Hz,MPa,MPa,C,-"]
    for i, part in enumerate(isotherms(dma, master)):
        for k in part:
            rows.append(
                f"{dma.frequency[k] / (2 * np.pi):.12g},{dma.storage[k] / 1e6:.12g},{dma.loss[k] / 1e6:.12g},"
                f"{round(master.temperature[i] - 273.15)},{i}"
            )
    return ("\n".join(rows) + "\n").encode()


@contextlib.contextmanager
def silence():
    with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        yield


def pyvisco_shift(dma: em.fit.Dma, master: em.fit.MasterCurve):
    from pyvisco import load
    from pyvisco import master as shifting

    with silence():
        raw, _, _ = load.user_raw(pyvisco_table(dma, master), "freq", "E")
        reference = round(master.reference - 273.15)
        return timed(lambda: np.array(shifting.get_aT(raw, reference)[0]["log_aT"]))


def gaussian_process_shift(dma: em.fit.Dma, master: em.fit.MasterCurve):
    """Both moduli's isotherms by mastercurves, storage modulus, a horizontal and a vertical factor each."""
    import mastercurves
    from mastercurves.transforms import Multiply

    parts = isotherms(dma, master)

    def run() -> np.ndarray:
        curve = mastercurves.MasterCurve()
        curve.add_data(
            [np.log(dma.frequency[k]) for k in parts],
            [np.log(dma.storage[k]) for k in parts],
            [float(t - 273.15) for t in master.temperature],
        )
        curve.add_htransform(Multiply(bounds=(1e-3, 1e3)))
        curve.add_vtransform(Multiply(bounds=(0.8, 1.25)))
        curve.superpose()
        factors = np.array(curve.hparams[0])
        log10_a = np.log10(factors)
        return log10_a - np.interp(master.reference, master.temperature, log10_a)

    with silence():
        return timed(run)


def pyvisco_prony(omega: np.ndarray, storage: np.ndarray, loss: np.ndarray, fewest: bool):
    """pyvisco's series through a master curve: one term a decade, or its own choice of fewer."""
    from pyvisco import load, opt, prony
    from pyvisco import master as shifting

    order = np.argsort(omega)
    rows = ["f,E_stor,E_loss", "Hz,MPa,MPa"]
    rows += [f"{omega[k] / (2 * np.pi):.12g},{storage[k] / 1e6:.12g},{loss[k] / 1e6:.12g}" for k in order]

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
    fitted = glassy - moduli.sum() + (moduli * x**2 / (1 + x**2)).sum(1), (moduli * x / (1 + x**2)).sum(1)
    return residuals(*fitted, (storage, loss)), len(terms), found.wall


def cold(path: Path) -> float:
    """Seconds of `elastomdr fit`, from the start of the process to its end."""
    with tempfile.TemporaryDirectory() as folder:
        begin = time.perf_counter()
        code = "import sys; from elastomdr.cli.main import main; sys.exit(main(sys.argv[1:]))"
        command = [sys.executable, "-c", code, "fit", str(path), "--reference", "25degC", "--out", folder]
        subprocess.run(command, check=True, capture_output=True)
        return time.perf_counter() - begin


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    data = parser.parse_args().data
    os.environ.setdefault("MPLBACKEND", "agg")
    one_core()
    record = heading("Fits beside other tools", "measured data; residuals are relative, root mean square")
    missing = [name for name in ("pyvisco", "mastercurves") if not installed(name)]
    record["missing"] = missing
    if missing:
        print(f"  not installed, and left out: {', '.join(missing)}")
    warnings.simplefilter("ignore", em.fit.FitWarning)
    melt = em.fit.read_dma(sorted((data / "polyisoprene-34k").glob("*.osc")))
    epdm = em.fit.read_dma(data / "epdm-70" / "tf_015p.csv")
    em.fit.material(epdm, 298.15)  # loads and warms everything

    ours = timed(lambda: em.fit.master_curve(melt, 263.15), 3)
    rows = [("elastomdr", off_published(ours.value.temperature, ours.value.log10_a), ours.wall)]
    for name, call in (("pyvisco", pyvisco_shift), ("mastercurves", gaussian_process_shift)):
        if not installed(name):
            continue
        try:
            found = call(melt, ours.value)
            rows.append((name, off_published(ours.value.temperature, found.value), found.wall))
        except Exception as error:  # another tool's failure is a result, not ours
            rows.append((f"{name}: {type(error).__name__}", np.nan, np.nan))
    record["shifts"] = table(("polyisoprene, shifted by", "rms log10 a_T off the published WLF", "seconds"), rows)

    sample = em.fit.read_dma(data / "pv-encapsulant" / "freq_user_master.csv").at(268.15)
    keep = (sample.storage > 0) & (sample.loss > 0)
    adhesive = em.fit.master_curve(em.fit.read_dma(data / "psa-468mp" / "frequency_sweep_tts.txt"), 303.15)
    rubber = em.fit.master_curve(epdm, 298.15)
    cases = {
        "pyvisco's sample master curve": (sample.frequency[keep], sample.storage[keep], sample.loss[keep], "tensile"),
        "EPDM-70": (rubber.frequency, rubber.storage, rubber.loss, "shear"),
        "468MP adhesive": (adhesive.frequency, adhesive.storage, adhesive.loss, "shear"),
    }
    series = []
    for name, (omega, storage, loss, kind) in cases.items():
        found = timed(lambda o=omega, s=storage, l=loss, k=kind: em.fit.prony(o, s, l, kind=k))
        fit = found.value
        series.append((name, "elastomdr", 100 * fit.storage_residual, 100 * fit.loss_residual, fit.terms, found.wall))
        if name.startswith("pyvisco"):  # its two moduli contradict each other: how far each is met is a choice
            found = timed(lambda o=omega, s=storage, l=loss, k=kind: em.fit.prony(o, s, l, kind=k, balance=20.0))
            fit = found.value
            row = ("elastomdr, balance=20", 100 * fit.storage_residual, 100 * fit.loss_residual, fit.terms, found.wall)
            series.append((name, *row))
        if installed("pyvisco"):
            for label, fewest in (("pyvisco, one a decade", False), ("pyvisco, its choice", True)):
                try:
                    off, count, seconds = pyvisco_prony(omega, storage, loss, fewest)
                    series.append((name, label, *off, count, seconds))
                except Exception as error:
                    series.append((name, f"{label}: {type(error).__name__}", np.nan, np.nan, 0, np.nan))
    columns = ("Prony series through", "by", "storage [%]", "loss [%]", "terms", "seconds")
    record["series"] = table(columns, series)

    whole = timed(lambda: em.fit.material(epdm, 298.15), 3)
    fit = whole.value
    hot = [text for text in fit.warnings if "Horizontal and vertical" in text]
    print()
    verdicts = [
        verdict("polyisoprene, rms log10 a_T", record["shifts"][0]["rms log10 a_T off the published WLF"], 0.03),
        verdict("EPDM-70, storage", 100 * fit.prony.storage_residual, 3.0, " %"),
        verdict("EPDM-70, loss", 100 * fit.prony.loss_residual, 8.0, " %"),
        verdict("EPDM-70, terms", fit.prony.terms, 12),
        verdict("EPDM-70, isotherms above 32 degC not told apart", int(fit.master.ambiguous[-3:].sum()), 3, least=True),
        verdict("210 points, warm", whole.wall, 1.0, " s"),
        verdict("210 points, cold command", cold(data / "epdm-70" / "tf_015p.csv"), 8.0, " s"),
    ]
    for other in series:
        if other[1].startswith("pyvisco") and np.isfinite(other[2]):
            hard = other[0].startswith("pyvisco") and other[1].endswith("its choice")
            who = "elastomdr, balance=20" if hard else "elastomdr"
            mine = next(row for row in series if row[0] == other[0] and row[1] == who)
            for which, at in (("storage", 2), ("loss", 3)):
                verdicts.append(verdict(f"{who}: {other[0]}, {which}, against {other[1]}", mine[at], other[at], " %"))
    for row in rows[1:]:
        if row[0] == "mastercurves" and np.isfinite(row[2]):
            verdicts.append(verdict(f"times faster than {row[0]}", row[2] / rows[0][2], 10.0, least=True))
            verdicts.append(verdict(f"error against that of {row[0]}", rows[0][1], row[1]))
    print(f"  EPDM-70 says: {hot[0] if hot else 'nothing of vertical shifts'}")
    record["verdicts"] = verdicts
    save("fit_peers", record)


if __name__ == "__main__":
    main()
