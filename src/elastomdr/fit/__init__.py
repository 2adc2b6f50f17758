"""From the laboratory to a material: master curves, Prony series, measured friction,
calibration.
"""

import importlib
from typing import Any

from ..errors import closest

_HOMES = {
    ".io.data": ("Dma", "FitWarning", "dma", "relaxation", "join"),
    "master": ("MasterCurve", "master_curve"),
    "series": ("PronyFit", "prony"),
    "pipeline": ("MaterialFit", "material", "from_hardness"),
    "report": (
        "abaqus_card",
        "ansys_card",
        "comsol_card",
        "dyna_card",
        "plain_card",
        "radioss_card",
    ),
    "grosch": ("FrictionMaster", "friction_master"),
    "calibration": ("Calibration", "calibrate"),
    "payne": ("SofteningFit", "softening"),
    "shear_law": ("AdhesionFit", "adhesion"),
}
_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = sorted(_MODULE_OF)


def __getattr__(name: str) -> Any:
    if name not in _MODULE_OF:
        raise AttributeError(
            (
                "module 'elastomdr.fit' has no attribute "
                f"{name!r}. {closest(name, __all__)}"
            ).strip(),
            name=name,
        )
    value = getattr(importlib.import_module(f".{_MODULE_OF[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
