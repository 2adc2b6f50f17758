"""Viscoelastic rubber friction and rolling resistance by the Method of Dimensionality
Reduction.

The public names, loaded when they are first used: `import elastomdr` itself loads
neither JAX nor matplotlib.
"""

import importlib
from typing import Any

__version__ = "0.2.0"

_HOMES = {
    "errors": (
        "InputError",
        "ConvergenceWarning",
        "ExtrapolationWarning",
        "ModelWarning",
    ),
    "progress_bar": ("progress",),
    "models": ("Averaged", "Line", "Marched"),
    "rough.road_models": ("Multiscale", "Persson", "HalfSpace"),
    "material.prony": ("Prony", "KelvinVoigt", "Maxwell", "StandardSolid"),
    "material.tabulated": ("TabulatedModulus",),
    "material.shift": (
        "WLF",
        "Arrhenius",
        "VFT",
        "ShiftTable",
        "EntropicVertical",
        "VerticalTable",
    ),
    "material.softening": ("Softening",),
    "material.library": ("materials", "load_material", "save_material"),
    "surface.shapes": (
        "Sphere",
        "Paraboloid",
        "Cone",
        "FlatPunch",
        "PowerLaw",
        "Cylinder",
    ),
    "surface.profile": ("Profile",),
    "surface.rough_line": ("RoughLine",),
    "surface.spectrum": ("SelfAffine", "Spectrum"),
    "element.law": ("Foundation", "half_space", "springs"),
    "element.layer": ("Layer", "layer"),
    "rough.adhesion": ("AdhesiveShear",),
    "rough.heat": ("Heat",),
    "smooth.plan": ("Plan",),
    "verbs.friction": ("friction",),
    "rough.press": ("press",),
    "rough.friction_spectrum": ("friction_spectrum",),
    "verbs.rolling": ("rolling",),
    "smooth.dissipation": ("dissipation",),
    "belt.heat_build_up": ("HeatBuildUp", "heat_build_up"),
    "belt.conveyor": ("Conveyor", "Idlers", "conveyor"),
    "verbs.plan": ("plan",),
    "verbs.cite": ("cite",),
    "sweeps.run": ("sweep",),
    "seal.break_out": ("BreakOut", "break_out"),
    "seal.lubricated": ("FilmProfile", "Lubricated", "lubricated"),
    "seal.o_ring": ("ORing", "o_ring"),
    "seal.leak": ("Leak", "leak"),
    "seal.leak_theories": ("CriticalConstriction", "EffectiveMedium"),
    "seal.reciprocating": ("Reciprocating", "reciprocating"),
    "transient.indent": ("Indentation", "indent"),
    "transient.adhesive_contact": ("Adhesion",),
    "transient.impact": ("Impact", "impact"),
    "transient.shear": ("shear",),
    "tyre.traction": ("traction",),
    "transient.slide": ("slide",),
    "transient.drive": ("drive",),
    "belt.stability": ("Stability", "stability"),
    "element.moving_body": ("Mount",),
    "io.dma": ("read_dma",),
    "io.point_tables": ("MeasuredFriction", "read_friction", "read_shifts"),
    "io.spectrum": ("read_spectrum",),
    "io.surface": ("read_surface",),
    "results.curve": ("FrictionCurve", "RollingCurve"),
    "results.spectrum": ("Dissipation", "FrictionSpectrum"),
    "transient.history_result": ("Slide", "Drive", "Shear", "ForceSpectrum"),
    "results.doubts": ("Doubt",),
    "results.friction_law": ("FrictionLaw", "load_friction"),
    "rough.results": ("RoughContact",),
    "tyre.traction_result": ("Traction",),
}
_PACKAGES = {"fit": ".fit", "reference": ".reference", "elements": ".element.elements"}
_MODULE_OF = {name: module for module, names in _HOMES.items() for name in names}

__all__ = ["__version__", *sorted([*_MODULE_OF, *_PACKAGES])]


def __getattr__(name: str) -> Any:
    if name in _PACKAGES:
        return importlib.import_module(_PACKAGES[name], __name__)
    if name not in _MODULE_OF:
        from .errors import closest

        raise AttributeError(
            f"module 'elastomdr' has no attribute {name!r}. {closest(name, __all__)}".strip(),
            name=name,
        )
    value = getattr(importlib.import_module(f".{_MODULE_OF[name]}", __name__), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(__all__)
