"""What the fields of the page are called: in words, with symbol and unit. The keys of
scene files stand in the exported scene only.
"""

from collections.abc import Iterable

from ..cli.units import SceneQuantity, shown, shown_beside
from ..errors import InputError, Options, told
from ..rough import adhesion, heat

# By key, or by table and key where a key means different things. After a bar, what
# stands below the field, where it is not what the scene's own key says.
_TABLES = {
    "adhesion": "Adhesive shear of the real contact",
    "break_out": "Load, rest and shear",
    "compare": "Conditions of the ranking",
    "contact": "Load and motion",
    "conveyor": "Belt conveyor",
    "heat": "Flash temperature",
    "heat.road": "Heat that flows into the road",
    "heat_build_up": "Heat and cooling",
    "indenter": "Rigid body",
    "layer": "Rubber layer on a rigid base",
    "leak": "Seal and fluid",
    "lubricated": "Load, motion and liquid",
    "numerics": "Accuracy",
    "o_ring": "O-ring",
    "roller": "Roller on the same rubber",
    "stroke": "Motion of the rod, and fluid",
    "structure": "Structure of the wheel",
    "surface": "Rough surface",
}
_LABELS = _TABLES | {
    # the rubber
    "data": "Files",
    "name": "Name of the rubber",
    "kind": "Kind of moduli",
    "area": "Cross-section of the specimen A [mm²]|for files that have stiffness",
    "length": "Length of the specimen L [mm]|for files that have stiffness",
    "column": 'Columns|by quantity, such as "storage=4, loss=5"',
    "frequency_unit": "Unit of frequency",
    "modulus_unit": "Unit of the moduli",
    "temperature_unit": "Unit of temperature",
    "time_unit": "Unit of time",
    "law": "Shift law",
    "shift": "Known shift law",
    "poisson": "Poisson's ratio ν [-]|0.5 where nothing is given",
    "ramp": "Duration of the ramp [s]|of a relaxation test with times counted from the "
    "start of the ramp",
    "reference": "Reference temperature T₀ [°C]",
    "storage_only": "Storage modulus only",
    "strain": "Strain amplitude ε [%]|where several were measured; the smallest "
    "where nothing is given",
    "softening": "Strain sweeps|a dropped file: moduli over strain amplitude, in shear; the "
    "rubber softens as it says",
    "vertical": "Vertical shifts b_T",
    "terms": "Terms of the Prony series",
    "balance": "Storage over loss modulus [-]|how many times more exactly it is met; by "
    "their scatter where nothing is given",
    "temperature_error": "Standard error of the temperatures [K]|by the scatter of the "
    "shift factors, about 0.3, where nothing is given",
    "citation": "Source of the data|for the material file",
    "material": "Rubber|of the library, or fitted or dropped on this page",
    "other": "Second rubber|where the other body is not rigid",
    "temperature": "Rubber temperature T [°C]|one, or several: 0, 20, 40",
    "measured": "Measured friction|a dropped table, drawn over the curves",
    "uncertainty": "Number of draws for the uncertainty band|of the rubber's misfit and of the "
    "road's errors; 2 or more",
    "title": "Title of the figure",
    "doubts": "Doubts of a calibration",
    "friction": "Friction coefficient µ [-]|a number, or the name of a table that was "
    "dropped",
    # load and motion
    "velocity": "Velocity v [m/s]|one, several, or from one to another: 1e-4 to 10 m/s, "
    "24 points",
    "pressure": "Nominal pressure p [MPa]",
    "load": "Load F [N]",
    "depth": "Indentation depth d [mm]|in place of the load",
    "slip": "Slip [-]|velocity of slip over that of the road, below 1",
    "creepage": "Creepage [-]|velocity of slip over the rolling velocity, in place of "
    "the slip",
    "strain_share": "Strain over rms slope [-]|of a rubber that softens with strain",
    "direction": "Direction of sliding [°]|to the lay of a ground or turned surface: 0 along it",
    "model": "Model of the contact",
    "corrected": "Corrected for asymmetric contacts|averaged model",
    "average": "Averaged over directions|line model",
    "equivalent_length": "Equivalent length [mm]|line model: turns a pressure into a load; "
    'or "full contact"',
    "seeds": "Random lines or maps|line and half-space models: how many, or their seeds",
    "samples": "Samples of a line|line model",
    "periods": "Length in longest waves|line and half-space models",
    "gamma": "Share of the stored energy γ [-]|Persson's model, 0 to 1",
    "stored": "Stored energy reduced in the contact area|Persson's model",
    "cells": "Cells along each side|half-space model",
    "compare.velocity": "At sliding velocity v [m/s]|else the middle of the range",
    "compare.temperature": "At temperature T [°C]|else the middle of the range",
    "compare.pressure": "At nominal pressure p [MPa]|else the middle of the range",
    # adhesion and heat
    "preset": "Typical values|in place of those below; none were measured",
    "energy": "Activation energy [kJ/mol]|without it the shear does not shift with "
    "temperature",
    "adhesion.reference": "Reference temperature T₀ [°C]|of the activation energy",
    "stress": "Largest shear stress τ [MPa]",
    "adhesion.velocity": "Velocity of the largest stress v₀ [m/s]|at the reference "
    "temperature",
    "adhesion.width": "Width of the bell over log₁₀ v [-]|0 or more",
    "conductivity": "Thermal conductivity λ [W/(m K)]",
    "heat_capacity": "Heat capacity per volume ρc [MJ/(m³ K)]",
    "branch": "Branch|which of several temperatures: of rubber that was cold, or hot",
    "ambient": "Ambient temperature [°C]",
    "capacity": "Heat capacity of the body [J/K]|for the way to the steady state",
    "conductance": "Thermal conductance to the surroundings [W/K]",
    "duration": "Duration [s]|how long the body rolls",
    "hottest": "Highest temperature considered [°C]|else that of the rubber's data",
    "points": "Number of instants",
    # bodies
    "shape": "Shape",
    "apex": "Tip|else the points decide",
    "coefficient": 'Coefficient|in length^(1 - exponent), such as "100 m^-1"',
    "curve": "Between the points",
    "exponent": "Exponent [-]",
    "file": "File",
    "surface.file": "File|that was dropped on this page",
    "indenter.length": "Length L [mm]|of the line of contact, across the direction of motion",
    "radius": "Radius R [mm]",
    "roller.length": "Length L [mm]",
    "slope": "Slope of the side [-]|rise over the distance from the axis",
    "unit": "Unit of length",
    "r": "Distances from the axis r|from 0 on",
    "z": "Heights z|at these distances",
    "bonded": "Bonded to its base|it can slip where this is off",
    "springs": "Independent springs|the textbook's, in place of the layer itself",
    "thickness": "Thickness h [mm]",
    "rtol": "Relative tolerance [-]",
    "stiffness": "Stiffness per contact area [MPa/m]",
    # the road
    "c": "Power spectrum C|at the wave numbers, in SI units",
    "c_unit": "Unit of C|of the second column, where its title has none",
    "columns": "Columns|which two of several, from 1",
    "convention": "Convention of C|how the spectrum is normalised",
    "cutoff": "Calibrated cutoff [rad/m]|in place of the shortest wavelength",
    "heights": "Factor on all heights [-]",
    "cutoff_error": "Relative error of the shortest wave [-]|for How sure, and the band",
    "level_error": "Relative error of C [-]|for How sure, and the band",
    "detrend": "Mean plane subtracted",
    "hurst": "Hurst exponent H [-]",
    "longest": "Longest wavelength λ₀ [mm]|",
    "shortest": "Shortest wavelength λ₁ [µm]|",
    "rolloff": "Roll-off wavelength [mm]|above which the spectrum is flat",
    "q_low": "Smallest wave number q₀ [1/m]|in place of the longest wavelength",
    "q_high": "Largest wave number q₁ [1/m]|in place of the shortest wavelength",
    "q_rolloff": "Roll-off wave number [1/m]|below which the spectrum is flat",
    "q": "Wave numbers q [rad/m]",
    "q_unit": "Unit of q|of the first column, where its title has none",
    "wave_number": "Definition of the wave numbers",
    "pixel_size": "Pixel size [µm]|one, or one for each direction",
    "rms_height": "Rms height h [µm]|in place of the slope",
    "rms_slope": "Rms slope ξ [-]|of the surface; that of a straight cut is smaller by "
    "the root of 2",
    "surface.unit": "Unit of the heights|where the file has none",
    # a belt
    "belt": "Mass of the belt per length [kg/m]",
    "goods": "Mass of the goods per length [kg/m]",
    "spacing": "Spacing of the carrying idlers [m]",
    "shares": "Shares of the load|by roll of a carrying set: 0.2, 0.6, 0.2 of three rolls; "
    "one roll bears all where nothing is given",
    "return_spacing": "Spacing of the return rolls [m]",
    "return_length": "Length of a return roll [mm]|else that of all rolls of a set",
    "return_thickness": "Cover indented by the return rolls [mm]|else the layer's thickness",
    # a seal
    "leak.pressure": "Contact pressure p [MPa]|of rubber and surface, with what the fluid "
    "adds",
    "pressure_drop": "Pressure drop of the fluid Δp [MPa]|less than the contact pressure",
    "leak.profile": "Pressure profile|a dropped table, in place of the contact pressure: "
    "position [mm], pressure [MPa], from the side of the fluid on",
    "kinematic_viscosity": "Kinematic viscosity ν [mm²/s]|of a liquid, in place of η, with "
    "its density",
    "molar_mass": "Molar mass M [g/mol]|of a gas, with a temperature: its slip and the "
    "mass rate",
    "outlet_pressure": "Outlet pressure [MPa]|absolute; makes the fluid a gas",
    "mean_free_path": "Mean free path at the outlet [nm]|of a gas that slips at the "
    "walls",
    "viscosity": "Viscosity η [mPa·s]",
    "density": "Density ρ [kg/m³]|gives the mass rate as well",
    "leak.direction": "Direction of the flow [°]|to the lay of a ground or turned surface: 0 "
    "along it",
    "leak.length": "Contact length along the flow [mm]|a profile and an O-ring have their "
    "own",
    "leak.width": "Contact width across the flow [m]|1 m where nothing is given",
    "time": "Time under load t [s]|without it: long after pressing",
    "diameter": "Diameter of the cord d [mm]",
    "squeeze": "Squeeze C [-]|part of the diameter, up to 0.25",
    "fluid_pressure": "Pressure of the sealed fluid [MPa]|above that behind the ring",
    "groove_width": "Width of the groove [mm]|its height is the squeezed diameter",
    "formula": "Load of the cord|Lindley's formula where nothing is chosen; held or free: "
    "a ring that its groove keeps at its length, or that may lengthen",
    "velocity_out": "Velocity of the rod out of the fluid [m/s]|one, or from one to another",
    "velocity_in": "Velocity of the rod into the fluid [m/s]|",
    "stroke.length": "Length of the stroke [mm]",
    "stroke.width": "Length of the seal along its edge [mm]|of a rod π times its diameter; "
    "1 m where nothing is given",
    "boundary_shear": "Shear stress of the real contact [MPa]|of a rough surface",
    "rubber": "Rubber rests, passes or rolls|rests as a seal on a rod, passes under a "
    "slider",
    "flow_factor": "Flow through a rough contact|as in a leak, or of Patir and Cheng",
}
# what a word to choose means, by key
_CHOICES = {
    "preset": {
        name: f"{name}, {known.says}"
        for name, known in (*adhesion.TYPICAL.items(), *heat.TYPICAL.items())
    },
    "convention": {
        "2d": "of the surface: ⟨h²⟩ = ∫ C d²q",
        "2d/4pi^2": "of the surface, over 4π²: ⟨h²⟩ = ∫ C d²q / 4π²",
        "1d": "of a straight cut, all q: ⟨h²⟩ = ∫ C dq from -∞ to ∞",
        "1d one-sided": "of a straight cut, positive q: ⟨h²⟩ = ∫ C dq from 0 to ∞",
        "1d/2pi": "of a straight cut, all q, over 2π: ⟨h²⟩ = ∫ C dq / 2π from -∞ to ∞",
        "1d one-sided/2pi": "of a straight cut, positive q, over 2π: "
        "⟨h²⟩ = ∫ C dq / 2π from 0 to ∞",
    },
    "wave_number": {
        "2 pi/lambda": "2π/λ, radians per length",
        "1/lambda": "1/λ, waves per length",
    },
}
NOTHING = {"preset": "your own, below"}  # what stands for no word, by key
# keys that belong to other commands than those of the page
ELSEWHERE = {
    f"[surface] {key}" for key in ("equivalent_length", "seed", "periods", "samples")
}
# as the page spells a unit, and as scene files do
_SIGNS = {"°C": "degC", "µm": "um", "·": "*", "²": "^2", "³": "^3"}
_SPELLED = {
    "degC  ": "°C    ",
    "degC": "°C",
    "+-": "±",
    "m^2": "m²",
    "m^3": "m³",
    **{f"{before}um": f"{before}µm" for before in " [(0123456789"},
    **{f"{a}*{b}": f"{a}·{b}" for a, b in ("as", "Ns", "mK", "³K")},
}


def label(path: tuple[str, ...], quantity: type[SceneQuantity] | None = None) -> str:
    """What the field of a key is called, with symbol and unit; `quantity` is what it
    measures, such as a force or a force per length.
    """
    entry = _entry(path).partition("|")[0]
    if quantity is None or not (label_unit := _unit_of(entry)):
        return entry
    try:
        quantity.read(f"1 {label_unit}")
    except InputError:
        return f"{_without_unit(entry)} [{with_signs(quantity.unit)}]"
    return entry


def choices(key: str, listed: Iterable[str]) -> dict[str, str]:
    """The words that a key accepts, with what stands for each of them in the field."""
    meanings = _CHOICES.get(key, {})
    return {word: meanings.get(word, word) for word in listed}


def hint(path: tuple[str, ...], meaning: str) -> str:
    """What stands below the field; empty where the label says it all."""
    name, bar, below = _entry(path).partition("|")
    if bar:
        return below
    explanation, word = meaning.lower(), name.lower()
    return "" if explanation.rstrip(".") in word else spoken(meaning)


def unit(path: tuple[str, ...], quantity: type[SceneQuantity] | None = None) -> str:
    """The unit in the label, as scene files spell it, empty where there is none."""
    return _unit_of(label(path, quantity))


def _unit_of(entry: str) -> str:
    unit_text = entry[len(_without_unit(entry)) :].strip(" []-")
    return without_signs(unit_text)


def _without_unit(entry: str) -> str:
    return entry.rpartition(" [")[0] if entry.endswith("]") else entry


def with_signs(words: str) -> str:
    """A text with units as the page spells them: °C, µm, mPa·s, m³, ±; what stands in
    columns stays in line.
    """
    words = f" {words}"
    for spelled, sign in _SPELLED.items():
        words = words.replace(spelled, sign)
    return words[1:]


def without_signs(words: str) -> str:
    """A text with units as scene files spell them."""
    for sign, spelled in _SIGNS.items():
        words = words.replace(sign, spelled)
    return words


def title(path: tuple[str, ...]) -> str:
    """What a field is called within a sentence: without its unit."""
    return _without_unit(label(path))


def quoted(*path: str) -> str:
    """A field's name within a sentence."""
    return f"“{title(path)}”"


def in_words(error: InputError, name: str = "") -> str:
    """An error about a scene in the words of the page; `name` is that of its field, such
    as "[contact] load".
    """

    def called(argument: str) -> str:
        if name and argument == error.argument:
            return title(path_of(name))
        path = path_of(argument)
        return quoted(*path) if path[-1] in _LABELS else argument

    words = error.words(called, shown_beside(error.got), _options).split()
    return " ".join(spoken(" ".join(map(_in_fields, words))).split())


def _in_fields(word: str) -> str:
    """A word of an error, or the field that it names: a table, or a key of two words."""
    bare = word.strip(".,;:()")
    path = bare.strip("[]").split(".")
    known = _TABLES if bare.startswith("[") else _LABELS if "_" in bare else {}
    if path[-1] in known or ".".join(path) in known:
        return word.replace(bare, quoted(*path))
    return word


def _options(options: Options) -> str:
    """Options of the command line as fields, with what to type into them."""
    said = []
    for name, values in options.items():
        no, _, of = name.partition("no_")
        if of and not no:
            said.append(f"{quoted(of)}: no")
            continue
        values = [values] if isinstance(values, str) else values
        said.append(f"{quoted(name)} {', '.join(values)}".strip())
    return ", ".join(said)


def spoken(message: str) -> str:
    """A message without what is said to users of Python and of the command line."""
    message = told(message, shown, _options)
    message = message.replace(" beside the scene", " that was dropped here")
    said: list[str] = []
    depth = 0  # of the parentheses that are left out
    for word in message.split(" "):
        aside = word.startswith(("(em.", "(--", "(`elastomdr"))
        called = word.startswith("em.")
        if called and not depth:
            name = word.removeprefix("em.").partition("(")[0]
            ends = name.rstrip(".,;:")
            said.append(name.replace(ends, ends.lower()))
            if said[-2:-1] == ["an"]:
                said[-2] = "a"
        if depth or aside or (called and "(" in word):
            depth += word.count("(") - word.count(")")
            if not depth and said:
                said[-1] += word.rpartition(")")[2]
        elif not called:
            said.append(word)
    return with_signs(" ".join(said))


def path_of(name: str) -> tuple[str, ...]:
    """The tables and the key of a field's name."""
    table, _, key = name.removeprefix("[").rpartition("] ")
    return (*filter(None, table.split(".")), key)


def _entry(path: tuple[str, ...]) -> str:
    for name in (".".join(path[-2:]), path[-1]):
        if name in _LABELS:
            return _LABELS[name]
    return path[-1].replace("_", " ").capitalize()
