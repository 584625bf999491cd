"""Texts of the window: numbers, values with units, names of fields and undo steps, and sentences of errors."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design import (
    CRANK,
    FRAME_LINK,
    NO_UNIT,
    Design,
    Driver,
    Entry,
    Info,
    Unit,
    drive_at,
    entries,
    entry_at,
    get,
    only,
    row_at,
    split_unit,
)
from core.design.fields import LARGEST, in_sentence
from core.errors import DesignError, FileError, KindynaError
from core.followers import LAYOUT_TABLE
from core.laws import named_law
from core.materials import MATERIALS
from core.number_text import shortest, typed_text, typeset
from core.output.load_text import row_name
from kindyna_gui.settings import in_units, number_text, point, size_of, symbol_of

SECTION_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "motion": "Motion",
        "follower": "Follower",
        "cam": "Cam",
        "shaft": "Shaft",
        "linkage": "Linkage",
        "engine": "Engine",
        "valve": "Valve",
        "loads": "Loads",
        "limits": "Limits",
        "servo": "Servo",
        "balancer": "Balance cam",
    }
)

Reasons = tuple[tuple[str, str, str], ...]
"""Path, name and sentence of each field with an error; path and name are empty where it concerns no field."""

_CHOICES: Mapping[str, str] = MappingProxyType(
    {
        "rms_acceleration": "rms of acceleration",
        "rms_jerk": "rms of jerk",
        "contact_force": "contact force",
        "motor_rms": "rms of the motor's torque",
        "ccw": "counter-clockwise",
        "cw": "clockwise",
        "roller": "roller",
        "flat": "flat face",
        "knife": "knife edge",
        "shoe": "curved shoe",
        "open": "open (disk)",
        "conjugate": "conjugate pair",
        "True": "yes",
        "False": "no",
        "1": "left (+1)",
        "-1": "right (\u22121)",
    }
)
"""Word of the file -> text in the window, where they differ."""

DIGITS = 17
"""Number of significant digits that a float can have."""

# -- numbers and values ----------------------------------------------------------------------------------


def rounded_to(value: float, is_short_enough: Callable[[str], bool]) -> str:
    """Number with as many digits as the condition allows, with an exponent only where no other text meets it."""
    text = shortest(value)
    for digits in range(DIGITS, 0, -1):
        text = shortest(float(f"{value:.{digits}g}"))
        if is_short_enough(text):
            return text
    for digits in range(DIGITS, 0, -1):
        text = f"{value:.{digits - 1}e}".replace("e+0", "e+").replace("e-0", "e-")
        if is_short_enough(text):
            break
    return text


def no_number(text: str) -> str:
    """Message for a text that is no number."""
    comma = ", with a decimal point and no comma," if "," in text and point() != "," else ","
    return f"enter a number{comma} such as 12{point()}5"


def typographic(text: str) -> str:
    """Text with typographic signs and numbers for reading: ``90 deg`` -> ``90°``, ``>=`` -> ``≥``, ``1e+09`` -> ``1 000 000 000``."""
    signs = re.sub(r"(?<=\d) deg\b(?!\^)", "°", text.replace(">=", "≥").replace("<=", "≤"))
    return typeset(re.sub(r"(?<=/deg)\^2", "²", signs))


def sentence(text: str) -> str:
    """Text with a capital first letter, typographic signs, and its quantities in the units on display."""
    return in_units(typographic(text[:1].upper() + text[1:]))


def choice_text(word: str) -> str:
    """Text of a choice in the window."""
    material = MATERIALS.get(str(word))
    return _CHOICES.get(str(word), str(word)) if material is None else material.name


_TIPS: Mapping[str, str] = MappingProxyType(
    {
        "torque": "peak of the torque over this segment, with the loads and speed of the design; a local optimum",
        "contact_force": "peak of the contact force over this segment, with the loads and speed of the design; a local optimum",
        "motor_rms": "root mean square of the servo's torque over this segment; a local optimum",
    }
)


def choice_tip(word: str) -> str:
    """Tip that explains a choice; empty where its name is clear."""
    if word in _TIPS:
        return _TIPS[word]
    if material := MATERIALS.get(word):
        allowable = (
            f"; allowable pressure {material.contact_pressure_mpa:g} MPa ({material.pressure_source})"
            if material.contact_pressure_mpa
            else ""
        )
        return f"{material.youngs_modulus_gpa:g} GPa, ν {material.poisson_ratio:g} ({material.source}){allowable}"
    row = LAYOUT_TABLE.get(word)
    if row is None:
        return ""
    cam, roller, slider = (
        "left" if row.cam_left else "right",
        "above" if row.roller_above else "below",
        "right" if row.slider_right else "left",
    )
    return f"cam {cam}, roller {roller}, slider {slider}"


def law_label(slug: str) -> str:
    """Name of a law."""
    return named_law(slug).label


def value_text(value: Any, unit: Unit, *, in_file_units: bool = False) -> str:
    """Value with its unit: ``850 mm``, ``35°``, ``clockwise``; with ``in_file_units`` whatever the preferences say."""
    if not isinstance(value, float):
        return choice_text(str(value))
    symbol = unit.symbol if in_file_units else symbol_of(unit.symbol)
    gap = "" if symbol in ("", "°") else " "
    return f"{typed_text(number_text(value, NO_UNIT if in_file_units else unit))}{gap}{symbol}"


def allowed_text(info: Info, unit: Unit, *, in_file_units: bool = False) -> str:
    """Allowed range of a field, in the preferred unit, or with ``in_file_units`` in its own."""
    size = 1.0 if in_file_units else size_of(unit.symbol)
    if size == 1.0:
        return info.allowed(unit)
    low, high = (end if abs(end) >= LARGEST else float(f"{end / size:.6g}") for end in (info.low, info.high))
    return replace(info, low=low, high=high).allowed(Unit(symbol_of(unit.symbol), unit.factor * size))


def named_value(design: Design, path: str) -> str:
    """Value of a design with its name, ``Rod L2: 850 mm``; for a table or a list only the name."""
    value, (_, number, rest) = get(design, path), row_at(path, "timing")
    row = None if rest == path else design.timing[number]
    name = f"{row.first} to {row.second}" if row else name_of(design, path)
    text = value_text(value, split_unit(path)[1]) if isinstance(value, (float, int, str)) else ""
    return f"{name}: {text}" if text else name


def step_text(name: str, value: Any, unit: Unit) -> str:
    """Name of an undo step: ``Change rod L2 to 850 mm``."""
    field = in_sentence(name)
    return f"Clear {field}" if value is None else f"Change {field} to {value_text(value, unit)}"


# -- names of fields -------------------------------------------------------------------------------------

_POINT_PATH = re.compile(r"linkage\.links\[(\d+)\]\.points\.(\w+)\.([xy])_mm")
_ROW_PATH = re.compile(r"(linkage\.sliders|loads\.masses|loads\.forces)\[(\d+)\]\.")
_ELEMENT_PATH = re.compile(
    r"loads\.(springs|torsion_springs|pair_friction|process|valve_springs)\[(\d+)\]\.(?:(from|to|points)(?:\[(\d+)\])?\.)?"
)
_LOAD_PATH = re.compile(r"loads\.(\w+)\[(\d+)\]")
_LOAD_PARTS = {
    "from": "First end",
    "to": "Second end",
    "pair": "Pair",
    "links": "Links",
    "point": "Point",
    "link": "Link",
    "on": "On link",
}
_NEW_LOADS = {
    "springs": "spring",
    "torsion_springs": "torsion spring",
    "pair_friction": "friction",
    "process": "process force",
    "valve_springs": "valve spring",
    "masses": "mass",
    "forces": "force",
}
_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "motion.segments": "Motion",
        "name": "Name",
        "linkage.links": "Links",
        "linkage.branch": "Assembly mode",
        "linkage.drawn": "As drawn",
        "cam.point": "Cam roller",
        "loads.least_contact_force_n": "Least contact force",
        "linkage.driver.link": "Driver",
        "linkage.driver.kind": "Driver",
    }
)
"""Path -> name, of values without a field in a form."""


def segment_of(path: str) -> int | None:
    """Number, from 0, of the segment that a path belongs to."""
    name, number, _ = row_at(path, "motion.segments")
    return number if name else None


def heading_of(design: Design, path: str) -> str:
    """Heading of the part that a path belongs to, ``Link 3`` or ``Link 4 slides on link 1``; empty for other paths."""
    point, row = _POINT_PATH.match(path), _ROW_PATH.match(path)
    if point is not None:
        number = design.drive.linkage.links[int(point[1])].number
        return "Link 1, the frame" if number == 1 else f"Link {number}"
    element = _ELEMENT_PATH.match(path)
    if element is not None:
        part = f", {element[3].removesuffix('s')}" if element[3] else ""
        return f"{row_name(design, path)}{part}{f' {int(element[4]) + 1}' if element[4] else ''}"
    if row is not None:
        index = int(row[2])
        if row[1] == "linkage.sliders":
            slider = design.drive.linkage.sliders[index]
            return f"Link {slider.link} slides on link {slider.on}"
        return row_name(design, path)
    if path.startswith("linkage.branch."):
        return "Assembly mode"
    if path.startswith("linkage.drawn."):
        return "As drawn"
    return driver_text(design.drive.linkage.driver) if path.startswith("linkage.driver.") else ""


def driver_text(driver: Driver) -> str:
    """Driver in words: ``Link 4 follows the motion``."""
    against = "" if driver.on == FRAME_LINK else f" against link {driver.on}"
    return f"Link {driver.link} {'turns at constant speed' if driver.kind == CRANK else 'follows the motion'}{against}"


def entry_label(design: Design, entry: Entry) -> str:
    """Label of a value; a point's coordinate has the point's name."""
    point = _POINT_PATH.match(entry.path)
    if point is not None:
        return f"{point[2]} {point[3]}"
    if entry.path.startswith("linkage.branch."):
        joint = entry.path.rpartition(".")[2]
        return f"Slide of link {joint}" if joint.isdecimal() else f"Joint {joint}"
    if entry.path.startswith("linkage.drawn.") and entry.in_file != entry.path:
        return f"{entry.in_file.rpartition('.')[2]} {entry.info.label}"
    return entry.info.label


def entry_name(design: Design, entry: Entry) -> str:
    """Label of a value with the part that it belongs to: ``Segment 3, span``, ``Link 3: A x``, ``Speed of link 2``."""
    if entry.path.startswith("linkage.driver."):
        return f"{entry_label(design, entry)} of link {design.drive.linkage.driver.link}"
    label, heading, number = entry_label(design, entry), heading_of(design, entry.path), segment_of(entry.path)
    if heading:
        return f"{heading}: {label}"
    return label if number is None else f"Segment {number + 1}, {label[:1].lower()}{label[1:]}"


_CURVE_LISTS: Mapping[str, str] = MappingProxyType(
    {"points": "point", "below": "obstacle below", "above": "obstacle above", "vibration_free": "cycles"}
)
"""List of a curve -> name of its rows."""


def name_of(design: Design, path: str) -> str:
    """Name of a field: ``Rod L2``, ``Segment 3, span``; the words of its path where the design does not have it."""
    drive = drive_at(path)
    if drive is not None and drive[0] < len(design.drives):
        return f"{design.drives[drive[0]].name}: {name_of(only(design, drive[0]), drive[1])}"
    number = segment_of(path)
    prefix = "" if number is None else f"Segment {number + 1}"
    if path in SECTION_NAMES:
        return SECTION_NAMES[path]
    curve = re.fullmatch(
        r"motion\.segments\[\d+\]\.(start|end|points|below|above|vibration_free)(?:\[(\d+)\])?(?:\.(\w+))?", path
    )
    if curve is not None:
        noun = _CURVE_LISTS.get(curve[1], curve[1])
        part = f"{noun} {int(curve[2]) + 1}" if curve[2] is not None else curve[1].replace("_", "-")
        keys = {"at_deg": "angle"} if noun == "point" else {"start": "from", "end": "to"}
        key = keys.get(curve[3], curve[3]) if curve[3] else ""
        return f"{prefix}, {part} {key}".rstrip()
    if prefix and path.endswith("]"):
        return prefix
    if path.endswith(".law"):
        return f"{prefix}, law"
    _, link, rest = row_at(path, "linkage.links")
    if rest == "points":
        return f"Points of link {design.drive.linkage.links[link].number}"
    load = _LOAD_PATH.match(path)
    if load is not None:
        rows: Any = getattr(design.drive.loads, load[1], ())
        if int(load[2]) >= len(rows):  # not added yet
            return f"New {_NEW_LOADS[load[1]]}" if load[1] in _NEW_LOADS else path
        if load.end() == len(path):
            return row_name(design, path)
    if (entry := entry_at(design, path)) is not None:
        return entry_name(design, entry)
    if load is not None:
        part = path[load.end() + 1 :].partition(".")[0]
        return f"{row_name(design, load[0])}: {_LOAD_PARTS.get(part, part)}"
    return _NAMES[path] if path in _NAMES else _in_words(path)


def _in_words(path: str) -> str:
    """Path in words, of a field that the current design does not have: ``Cam, roller radius``, ``Segment 7, span``."""
    table, _, key = path.rpartition(".")
    words = [part for part in (*table.split("."), split_unit(key)[0]) if part]
    words = [re.sub(r"s?\[(\d+)\]", lambda match: f" {int(match[1]) + 1}", word).replace("_", " ") for word in words]
    words = words[1:] if words[0] == "motion" and len(words) > 1 else words
    return sentence(", ".join(words))


# -- sentences of errors ---------------------------------------------------------------------------------


def named(design: Design, text: str) -> str:
    """Replace keys and paths of the file, such as ``rod_mm``, by the names in the forms."""
    rows = [(entry.path, entry.info.label) for table in design.tables for entry in entries(design, table)]
    for path, label in (*rows, *_NAMES.items()):
        for key in (path, path.rpartition(".")[2]):
            if ("_" in key or "." in key) and key in text:
                text = re.sub(rf"(?<![\w.]){re.escape(key)}\b", f"{label[:1].lower()}{label[1:]}", text)
    return text


def reasons(design: Design, error: KindynaError) -> Reasons:
    """Path, name and sentence of each fault that an error reports; path and name are empty where it concerns no field."""
    if isinstance(error, DesignError):
        rows: Iterable[tuple[str, str]] = (
            (f.path, f"{f.problem}; allowed: {_choices_text(f.allowed)}" if f.allowed else f.problem)
            for f in error.faults
        )
    else:
        path = getattr(error, "field", "")
        rows = ((path, str(error).removeprefix(f"{path}: ")),)
    is_file_error = isinstance(error, FileError)  # its text has the name of a file, which may look like a key
    return tuple(
        (path, name_of(design, path) if path else "", text if is_file_error else named(design, text))
        for path, text in rows
    )


def _choices_text(allowed: str) -> str:
    """Allowed values of a fault, the words of a choice as the window writes them."""
    *words, last = (choice_text(word) for word in allowed.split(" | "))
    return f"{', '.join(words)} or {last}" if words else allowed


def reason(design: Design, error: KindynaError) -> str:
    """Error in one sentence, with the names of the fields in the forms and their values.

    Example: ``Segment 2, rise 150 mm: c6 is a return; allowed: < 0 mm, or a law that rises``.
    """
    values = [fault.value for fault in error.faults] if isinstance(error, DesignError) else [None]
    rows = zip(reasons(design, error), values, strict=True)
    return "; ".join(
        sentence(f"{name}{_field_value(path, value)}: {text}" if name else text) for (path, name, text), value in rows
    )


def _field_value(path: str, value: Any) -> str:
    """Value of a field after its name: a number, or words; empty for a table of the file."""
    if isinstance(value, float):
        return f" {value_text(value, split_unit(path)[1])}"
    return f", {value}" if isinstance(value, str) and not value.startswith("[") else ""
