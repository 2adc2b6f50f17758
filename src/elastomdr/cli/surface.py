"""The [surface] table of a scene file becomes a surface, and the arguments of `em.friction` that go with it."""

from pathlib import Path
from typing import Any

from ..errors import InputError
from .keys import Keys, choice, flag, number, numbers, one, positive_number, text
from .units import CONDUCTIVITY, HEAT_CAPACITY, LENGTH, WAVE_NUMBER

_CUTOFFS = ("q_low", "q_high", "q_rolloff", "longest", "shortest", "rolloff")
_TABLE = ("file", "wave_number", "q_unit", "c_unit", "columns", "longest", "shortest")  # of a spectrum in a file
_KEYS = {
    "self_affine": ("hurst", "rms_slope", "rms_height", *_CUTOFFS),
    "spectrum": ("q", "c", "convention", *_TABLE),
    "file": ("file", "shortest", "unit", "detrend"),
}
_LINES = ("equivalent_length", "seeds", "periods", "samples")


def read_surface(content: Any, folder: Path, one_line: bool = False) -> tuple[Any, dict[str, Any]]:
    """A surface from its table, and seeds, periods, samples, equivalent_length. Raises `InputError`.

    For `one_line` of it, as `em.slide` takes, `seed` stands in the place of seeds.
    """
    lines = tuple("seed" if name == "seeds" and one_line else name for name in _LINES)
    every = ("shape", *dict.fromkeys(key for keys in _KEYS.values() for key in keys), *lines)
    shape = Keys(content, "surface", every).get("shape", choice(*_KEYS))
    keys = Keys(content, "surface", ("shape", *_KEYS[shape], *lines))
    more: dict[str, Any] = {
        name: keys.get(name, _seeds if name == "seeds" else _whole) for name in lines[1:] if name in keys
    }
    if "equivalent_length" in keys:
        more["equivalent_length"] = keys.get("equivalent_length", _equivalent)
    from .. import SelfAffine, surface_from_file

    try:
        if shape == "self_affine":
            return SelfAffine(keys.get("hurst", number), **_size(keys), **_cutoffs(keys)), more
        if shape == "spectrum":
            return _spectrum(keys, folder), more
        options: dict[str, Any] = {"shortest": keys.get("shortest", one(LENGTH))} if "shortest" in keys else {}
        options |= {"unit": keys.get("unit", text)} if "unit" in keys else {}
        options |= {"detrend": keys.get("detrend", flag)} if "detrend" in keys else {}
        return surface_from_file(folder / keys.get("file", text), **options), more
    except InputError as error:
        said = str(error).replace("path: ", "file: ", 1) if str(error).startswith("path: ") else str(error)
        raise InputError(said if said.startswith("[surface]") else f"[surface] {said}") from error


def read_heat(content: Any) -> dict[str, Any]:
    """`heat` from its table. Raises `InputError`."""
    keys = Keys(content, "heat", ("conductivity", "heat_capacity"))
    from .. import Heat

    return {"heat": Heat(keys.get("conductivity", one(CONDUCTIVITY)), keys.get("heat_capacity", one(HEAT_CAPACITY)))}


def _spectrum(keys: Keys, folder: Path) -> Any:
    """A table in the scene, as q and c, or in a file of its own."""
    from .. import Spectrum, spectrum_from_file
    from ..mapping.spectrum import CONVENTIONS

    if "convention" not in keys:
        listed = "; ".join(f'"{name}": {meaning}' for name, meaning in CONVENTIONS.items())
        raise InputError(f"[surface] convention is missing, how C is normalised: {listed}.")
    convention = keys.get("convention", text)
    if "file" not in keys:
        for key in _TABLE:
            if key in keys:
                raise InputError(f"{keys.name(key)} goes with a file, not with q and c in the scene.")
        if "q" not in keys:
            raise InputError('[surface] must have a file, such as "road.csv", or q and c.')
        return Spectrum(keys.get("q", numbers), keys.get("c", numbers), convention=convention)
    if "q" in keys or "c" in keys:
        raise InputError("[surface] file and q, c exclude each other.")
    options: dict[str, Any] = {key: keys.get(key, text) for key in ("wave_number", "q_unit", "c_unit") if key in keys}
    options |= {key: keys.get(key, one(LENGTH)) for key in ("longest", "shortest") if key in keys}
    options |= {"columns": keys.get("columns", lambda _, value: value)} if "columns" in keys else {}
    return spectrum_from_file(folder / keys.get("file", text), convention=convention, **options)


def _size(keys: Keys) -> dict[str, float]:
    if ("rms_slope" in keys) == ("rms_height" in keys):
        got = "both" if "rms_slope" in keys else "neither"
        raise InputError(f"[surface] must have either rms_slope or rms_height, got {got}.")
    if "rms_slope" in keys:
        return {"rms_slope": keys.get("rms_slope", positive_number)}
    return {"rms_height": keys.get("rms_height", one(LENGTH))}


def _cutoffs(keys: Keys) -> dict[str, float]:
    """The cutoffs as wave numbers; each may be given as such or as a wavelength, longest or shortest."""
    found = {}
    for name, wave, needed in (
        ("q_low", "longest", True),
        ("q_high", "shortest", True),
        ("q_rolloff", "rolloff", False),
    ):
        if name in keys and wave in keys:
            raise InputError(f"[surface] {name} and {wave} say the same thing: give one of them.")
        if name in keys:
            found[name] = keys.get(name, one(WAVE_NUMBER))
        elif wave in keys:
            found[name] = 2 * 3.141592653589793 / keys.get(wave, one(LENGTH))
        elif needed:
            raise InputError(f'[surface] {wave} is missing: the {wave} wavelength, such as "5 mm" (or {name}).')
    return found


def _equivalent(name: str, value: Any) -> Any:
    return value if value == "full contact" else one(LENGTH)(name, value)


def _seeds(name: str, value: Any) -> int | list[int]:
    return value if isinstance(value, list) else _whole(name, value)


def _whole(name: str, value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise InputError(f"{name} must be a whole number, 1 or more, got {value!r}.")
    return value
