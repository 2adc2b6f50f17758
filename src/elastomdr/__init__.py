"""Viscoelastic rubber friction and rolling resistance by the Method of Dimensionality Reduction.

The public names, loaded when they are first used: `import elastomdr` itself loads neither JAX nor matplotlib.
"""

import importlib
from typing import Any

__version__ = "0.2.0"

_HOMES = {
    "errors": ("InputError", "ConvergenceWarning", "ExtrapolationWarning", "ModelWarning"),
    "models": ("Averaged", "Line", "Multiscale", "Persson", "HalfSpace"),
    "material.prony": ("Prony", "KelvinVoigt", "Maxwell", "StandardSolid"),
    "material.tabulated": ("TabulatedModulus",),
    "material.shift": ("WLF", "Arrhenius", "VFT", "ShiftTable"),
    "material.vertical": ("EntropicVertical", "VerticalTable"),
    "material.softening": ("Softening",),
    "material.library": ("materials", "load_material", "save_material"),
    "mapping.shapes": ("Sphere", "Paraboloid", "Cone", "FlatPunch", "PowerLaw", "Cylinder"),
    "mapping.profile": ("Profile",),
    "mapping.rough_line": ("RoughLine",),
    "mapping.spectrum": ("SelfAffine", "Spectrum"),
    "foundation.law": ("Foundation", "half_space", "springs"),
    "foundation.layer": ("Layer", "layer"),
    "foundation.solver": ("ContactStep",),
    "solve.adhesive_shear": ("AdhesiveShear",),
    "solve.heat": ("Heat",),
    "solve.plan": ("Plan",),
    "scenes.friction": ("friction",),
    "scenes.line_contact": ("line_contact",),
    "scenes.press": ("press",),
    "scenes.bands": ("friction_bands",),
    "scenes.rolling": ("rolling",),
    "scenes.dissipation": ("dissipation",),
    "recipes.warming": ("warming",),
    "recipes.conveyor": ("Idlers", "conveyor"),
    "scenes.plan": ("plan",),
    "sweeps.run": ("sweep",),
    "recipes.squeezed_cord": ("squeezed_cord",),
    "scenes.indent": ("indent",),
    "scenes.impact": ("impact",),
    "scenes.shear": ("shear",),
    "scenes.traction": ("traction",),
    "scenes.slide": ("slide",),
    "scenes.drive": ("drive",),
    "recipes.stability": ("stability",),
    "solve.mount": ("Mount",),
    "io.dma": ("read_dma",),
    "io.friction": ("MeasuredFriction", "read_friction"),
    "io.shifts": ("read_shifts",),
    "io.spectrum": ("read_spectrum",),
    "io.surface": ("read_surface",),
    "results.curve": ("FrictionCurve", "RollingCurve"),
    "results.spectrum": ("Dissipation", "FrictionBands"),
    "results.applications": ("Warming", "Conveyor", "SqueezedCord", "Stability"),
    "results.history": ("Slide", "Drive", "Shear", "ForceSpectrum"),
    "results.friction_law": ("FrictionLaw", "load_friction"),
    "results.indentation": ("Indentation",),
    "results.line_contact": ("LineContact",),
    "results.rough_contact": ("RoughContact",),
    "results.impact": ("Impact",),
    "results.traction": ("Traction",),
}
_PACKAGES = ("fit", "reference")
_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = ["__version__", *sorted([*_MODULE_OF, *_PACKAGES])]


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return importlib.import_module(f".{name}", __name__)
    if name not in _MODULE_OF:
        from .errors import closest

        raise AttributeError(f"module 'elastomdr' has no attribute {name!r}.{closest(name, __all__)}", name=name)
    value = getattr(importlib.import_module(f".{_MODULE_OF[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
