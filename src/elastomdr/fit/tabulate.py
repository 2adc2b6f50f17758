"""From the points of a master curve, which overlap and scatter, to a table of
moduli.
"""

from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import InputError
from ..material.tabulated import TabulatedModulus
from ..material.validity import Range, misfit_bands
from ..trees import replaced

if TYPE_CHECKING:
    from .master import MasterCurve

_MOST = 100  # bands per decade


def tabulate(
    master: "MasterCurve",
    per_decade: int,
    shift: Any,
    vertical: Any,
    poisson: Any,
    name: str,
    citation: str,
) -> TabulatedModulus:
    """A table from the shifted data: in each band of log omega the means of log omega,
    log storage and log loss.
    """
    whole = isinstance(per_decade, int) and not isinstance(per_decade, bool)
    if not whole or not 1 <= per_decade <= _MOST:
        raise InputError(
            f"per_decade must be a whole number from 1 to {_MOST}, got {per_decade!r}."
        )
    logs = np.log([master.omega, master.storage, master.loss])
    band = np.floor(
        per_decade * (logs[0] - logs[0].min(initial=np.inf)) / np.log(10)
    ).astype(int)
    numbers = np.unique(band)
    if numbers.size < 3:
        raise InputError(
            "master must have storage and loss moduli in three bands of frequency at "
            "least, "
            f"got {master.omega.size} points in {numbers.size}."
        )
    omega, storage, loss = np.exp(
        [logs[:, band == number].mean(axis=1) for number in numbers]
    ).T
    table = TabulatedModulus(
        omega,
        storage,
        loss,
        kind=master.kind,
        poisson=poisson,
        shift=shift,
        vertical=vertical,
        name=name,
        citation=citation,
    )
    stored, lost = table.storage(master.omega), table.loss(master.omega)
    scatter = misfit_bands(
        master.omega, stored / master.storage - 1, lost / master.loss - 1
    )
    known = Range(
        (float(omega[0]), float(omega[-1])), master.measured_at, misfit=scatter
    )
    return replaced(table, range=known)
