"""How should storage and loss modulus count against each other where no material meets
both?

    python benchmarks/fit_balance.py DATA_DIR

DATA_DIR as for `fit_library.py`. Every fourth point of a master curve is held out in
turn, at four balances (by how much more a relative deviation of the storage modulus
counts), and what the series foretells of the points it was not given is compared with
them. "Elastomer" is the published master curve of the encapsulant from 1e-6 to 1e13 Hz,
whose two moduli contradict each other. The default of `em.fit.prony` is to be within a
tenth of the best balance.
"""

import argparse
import warnings
from pathlib import Path

import numpy as np
from common import heading, one_thread, save, table, verdict

import elastomdr as em

FOLDS, BALANCES = 4, (None, 0.2, 1.0, 5.0, 20.0)


def masters(data: Path):
    """Angular frequency, storage and loss modulus of each set, at its reference
    temperature.
    """
    whole = em.read_dma(
        data / "pv-encapsulant/freq_user_master.csv", temperature=268.15, kind="tensile"
    )
    at = (whole.omega >= 2e-6 * np.pi) & (whole.omega <= 2e13 * np.pi)
    yield "elastomer", whole.omega[at], whole.storage[at], whole.loss[at]
    for name, path, reference in (
        ("polyisoprene", sorted((data / "polyisoprene-34k").glob("*.osc")), 263.15),
        ("EPDM-70", data / "epdm-70" / "tf_015p.csv", 298.15),
        ("468MP adhesive", data / "psa-468mp" / "frequency_sweep_tts.txt", 303.15),
        ("encapsulant", data / "pv-encapsulant" / "freq_user_raw.csv", 268.15),
    ):
        master = em.fit.master_curve(em.read_dma(path), reference)
        yield name, master.omega, master.storage, master.loss


def held_out(omega, storage, loss, balance) -> np.ndarray:
    """Root mean square of the relative deviations of both moduli [%] at points that the
    series was not given.
    """
    rank, off = np.argsort(np.argsort(omega)), []
    for fold in range(FOLDS):
        test = rank % FOLDS == fold
        fit = em.fit.prony(
            omega[~test], storage[~test], loss[~test], balance=balance, poisson=0.5
        )
        found = fit.moduli_at(omega[test])
        off.append(
            [m / seen[test] - 1 for m, seen in zip(found, (storage, loss), strict=True)]
        )
    return 100 * np.sqrt((np.concatenate(off, axis=1) ** 2).mean(axis=1))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path, metavar="DATA_DIR")
    data = parser.parse_args().data
    one_thread()
    warnings.simplefilter("ignore")
    record = heading(
        "The balance of storage and loss modulus",
        "points held out of measured master curves",
    )
    rows, verdicts = [], []
    for name, *moduli in masters(data):
        found = {balance: held_out(*moduli, balance) for balance in BALANCES}
        rows += [
            (name, "default" if b is None else f"{b:g}", *size, np.hypot(*size))
            for b, size in found.items()
        ]
        best = min(np.hypot(*size) for size in found.values())
        verdicts.append(
            verdict(
                f"{name}: default over the best balance",
                np.hypot(*found[None]) / best,
                1.1,
            )
        )
        if name == "elastomer":
            ratio = found[None][1] / found[20.0][1]
            verdicts.append(
                verdict(
                    "elastomer: loss modulus held out, default over balance 20",
                    ratio,
                    0.6,
                )
            )
    columns = (
        "data",
        "balance",
        "storage, held out [%]",
        "loss, held out [%]",
        "both [%]",
    )
    record["held out"] = table(columns, rows)
    record["verdicts"] = verdicts
    save("fit_balance", record)


if __name__ == "__main__":
    main()
