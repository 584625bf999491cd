"""Texts and numbers as the window shows them: names of fields, names of steps, the shortest text of a number."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design import (
    CRANK,
    FRAME_LINK,
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
from core.design.fields import LARGEST
from core.errors import DesignError, FileError, KindynaError
from core.followers import LAYOUT_TABLE
from core.laws import named_law
from core.materials import MATERIALS
from core.output.lines import shortest
from core.output.load_text import row_name
from kindyna_gui.settings import in_units, number_text, point, size_of, symbol_of

SECTION_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "motion": "Motion",
        "follower": "Follower",
        "cam": "Cam",
        "shaft": "Shaft",
        "linkage": "Linkage",
        "loads": "Loads",
        "limits": "Limits",
        "servo": "Servo",
        "balancer": "Balance cam",
    }
)

Reasons = tuple[tuple[str, str, str], ...]
"""Path, name and sentence of every field that something is wrong with; empty where it is right."""

_CHOICES: Mapping[str, str] = MappingProxyType(
    {
        "ccw": "counter-clockwise",
        "cw": "clockwise",
        "roller": "roller",
        "flat": "flat face",
        "knife": "knife edge",
        "shoe": "curved shoe",
        "open": "open (disk)",
        "conjugate": "conjugate pair",
        "True": "seen from the other end",
        "False": "seen from this end",
        "1": "left (+1)",
        "-1": "right (\u22121)",
    }
)
"""Words of the file that read better otherwise."""

DIGITS = 17
"""No number has more that count."""


def thousands(count: int) -> str:
    """A count, its thousands apart."""
    return f"{count:,}".replace(",", "\u202f")


def grouped(value: float, figures: int = 4) -> str:
    """A number of so many figures, its thousands apart: ``113 100 000``."""
    text = shortest(float(f"{value:.{figures}g}"))
    return f"{float(text):,.0f}".replace(",", "\u202f") if abs(value) >= 1e4 else text


def rounded_to(value: float, fits: Callable[[str], bool]) -> str:
    """A number rounded to as many digits as fit, with an exponent where only that helps."""
    text = shortest(value)
    for digits in range(DIGITS, 0, -1):
        text = shortest(float(f"{value:.{digits}g}"))
        if fits(text):
            return text
    for digits in range(DIGITS, 0, -1):
        text = f"{value:.{digits - 1}e}".replace("e+0", "e+").replace("e-0", "e-")
        if fits(text):
            break
    return text


def no_number(text: str) -> str:
    """The message for a text that is no number."""
    comma = ", with a decimal point and no comma," if "," in text and point() != "," else ","
    return f"a number is wanted{comma} such as 12{point()}5"


def sentence(text: str) -> str:
    """A text that begins with a capital letter, with the printer's signs for what has them: ``90 deg`` -> ``90°``."""
    signs = re.sub(r"(?<=\d) deg\b(?!\^)", "°", text.replace(">=", "≥").replace("<=", "≤"))
    return in_units(signs[:1].upper() + re.sub(r"(?<=/deg)\^2", "²", signs[1:]))


def in_sentence(name: str) -> str:
    """A name as it stands inside of a sentence: ``rod L2``; a letter, of a point or of an angle, as it is."""
    return f"{name[:1].lower()}{name[1:]}" if name[1:2].islower() else name


def choice_text(word: str) -> str:
    """A choice, as shown."""
    material = MATERIALS.get(str(word))
    return _CHOICES.get(str(word), str(word)) if material is None else material.name


def choice_tip(word: str) -> str:
    """What a choice means; empty where its name is clear."""
    if material := MATERIALS.get(word):
        borne = (
            f"; bears {material.contact_pressure_mpa:g} MPa ({material.pressure_source})"
            if material.contact_pressure_mpa
            else ""
        )
        return f"{material.youngs_modulus_gpa:g} GPa, ν {material.poisson_ratio:g} ({material.source}){borne}"
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
    """The name of a law for the reader."""
    return named_law(slug).label


def value_text(value: Any, unit: Unit) -> str:
    """A value with its unit, as it is shown: ``850 mm``, ``35°``, ``clockwise``."""
    if not isinstance(value, float):
        return choice_text(str(value))
    symbol = symbol_of(unit.symbol)
    gap = "" if symbol in ("", "°") else " "
    return f"{number_text(value, unit)}{gap}{symbol}"


def allowed_text(info: Info, unit: Unit) -> str:
    """The allowed range of a field, as it is shown."""
    size = size_of(unit.symbol)
    if size == 1.0:
        return info.allowed(unit)
    low, high = (end if abs(end) >= LARGEST else float(f"{end / size:.6g}") for end in (info.low, info.high))
    return replace(info, low=low, high=high).allowed(Unit(symbol_of(unit.symbol), unit.factor * size))


def named_value(design: Design, path: str) -> str:
    """A value of a design with its name: ``Rod L2: 850 mm``; of what is no single value the name."""
    value, (_, number, inside) = get(design, path), row_at(path, "timing")
    row = None if inside == path else design.timing[number]
    name = f"{row.first} to {row.second}" if row else name_of(design, path)
    text = value_text(value, split_unit(path)[1]) if isinstance(value, (float, int, str)) else ""
    return f"{name}: {text}" if text else name


def step_text(name: str, value: Any, unit: Unit) -> str:
    """The name of a step of the undo stack: ``Change rod L2 to 850 mm``."""
    what = in_sentence(name)
    return f"Clear {what}" if value is None else f"Change {what} to {value_text(value, unit)}"


def segment_of(path: str) -> int | None:
    """The number of the segment, from 0, that a path leads into."""
    name, number, _ = row_at(path, "motion.segments")
    return number if name else None


_OF_LINK = re.compile(r"linkage\.links\[(\d+)\]\.points\.(\w+)\.([xy])_mm")
_OF_LIST = re.compile(r"(linkage\.sliders|loads\.masses|loads\.forces)\[(\d+)\]\.")
_OF_ELEMENT = re.compile(
    r"loads\.(springs|torsion_springs|pair_friction|process)\[(\d+)\]\.(?:(from|to|points)(?:\[(\d+)\])?\.)?"
)
_LOAD_ROW = re.compile(r"loads\.(\w+)\[(\d+)\]")
_HOLDS = {
    "from": "First end",
    "to": "Second end",
    "pair": "Pair",
    "links": "Links",
    "point": "Point",
    "link": "Link",
    "on": "On link",
}
_NEW = {
    "springs": "spring",
    "torsion_springs": "torsion spring",
    "pair_friction": "friction",
    "process": "process force",
    "masses": "mass",
    "forces": "force",
}


_NAMES: Mapping[str, str] = MappingProxyType(
    {
        "motion.segments": "Motion",
        "name": "Name",
        "linkage.links": "Links",
        "linkage.branch": "Way of assembly",
        "linkage.drawn": "As drawn",
        "cam.point": "Cam roller",
        "loads.least_contact_force_n": "Least contact force",
        "linkage.driver.link": "Driver",
        "linkage.driver.kind": "Driver",
    }
)
"""Of what no form has a field of its own for."""


def heading_of(design: Design, path: str) -> str:
    """What the value at a path belongs to, of a design that lists its parts: ``Link 3``, ``Link 4 slides on link 1``."""
    point, row = _OF_LINK.match(path), _OF_LIST.match(path)
    if point is not None:
        number = design.drive.linkage.links[int(point[1])].number
        return "Link 1, the frame" if number == 1 else f"Link {number}"
    element = _OF_ELEMENT.match(path)
    if element is not None:
        inside = f", {element[3].removesuffix('s')}" if element[3] else ""
        return f"{row_name(design, path)}{inside}{f' {int(element[4]) + 1}' if element[4] else ''}"
    if row is not None:
        index = int(row[2])
        if row[1] == "linkage.sliders":
            slider = design.drive.linkage.sliders[index]
            return f"Link {slider.link} slides on link {slider.on}"
        return row_name(design, path)
    if path.startswith("linkage.branch."):
        return "Way of assembly"
    if path.startswith("linkage.drawn."):
        return "As drawn"
    return driver_text(design.drive.linkage.driver) if path.startswith("linkage.driver.") else ""


def driver_text(driver: Driver) -> str:
    """``Link 4 follows the motion``."""
    against = "" if driver.on == FRAME_LINK else f" against link {driver.on}"
    return f"Link {driver.link} {'turns at speed' if driver.kind == CRANK else 'follows the motion'}{against}"


def entry_label(design: Design, entry: Entry) -> str:
    """The label of a value; of a point's coordinate with the point's name."""
    point = _OF_LINK.match(entry.path)
    if point is not None:
        return f"{point[2]} {point[3]}"
    if entry.path.startswith("linkage.branch."):
        joint = entry.path.rpartition(".")[2]
        return f"Slide of link {joint}" if joint.isdecimal() else f"Joint {joint}"
    if entry.path.startswith("linkage.drawn.") and entry.in_file != entry.path:
        return f"{entry.in_file.rpartition('.')[2]} {entry.info.label}"
    return entry.info.label


def entry_name(design: Design, entry: Entry) -> str:
    """The label of a value, with what it belongs to: ``Segment 3, span``, ``Link 3: A x``."""
    label, head, number = entry_label(design, entry), heading_of(design, entry.path), segment_of(entry.path)
    if head:
        return f"{head}: {label}"
    return label if number is None else f"Segment {number + 1}, {label[:1].lower()}{label[1:]}"


def name_of(design: Design, path: str) -> str:
    """A field's name for the reader: ``Rod L2``, ``Segment 3, span``; the path itself where it has none."""
    own = drive_at(path)
    if own is not None and own[0] < len(design.drives):
        return f"{design.drives[own[0]].name}: {name_of(only(design, own[0]), own[1])}"
    number = segment_of(path)
    prefix = "" if number is None else f"Segment {number + 1}"
    if path in SECTION_NAMES:
        return SECTION_NAMES[path]
    inside = re.fullmatch(r"motion\.segments\[\d+\]\.(start|end|points)(?:\[(\d+)\])?(?:\.(\w+))?", path)
    if inside is not None:
        part = f"point {int(inside[2]) + 1}" if inside[2] is not None else inside[1]
        key = {"at_deg": "angle"}.get(inside[3], inside[3]) if inside[3] else ""
        return f"{prefix}, {part} {key}".rstrip()
    if prefix and path.endswith("]"):
        return prefix
    if path.endswith(".law"):
        return f"{prefix}, law"
    _, link, inside_link = row_at(path, "linkage.links")
    if inside_link == "points":
        return f"Points of link {design.drive.linkage.links[link].number}"
    load = _LOAD_ROW.match(path)
    if load is not None:
        rows: Any = getattr(design.drive.loads, load[1], ())
        if int(load[2]) >= len(rows):  # it is not there yet
            return f"New {_NEW[load[1]]}" if load[1] in _NEW else path
        if load.end() == len(path):
            return row_name(design, path)
    if (entry := entry_at(design, path)) is not None:
        return entry_name(design, entry)
    if load is not None:
        part = path[load.end() + 1 :].partition(".")[0]
        return f"{row_name(design, load[0])}: {_HOLDS.get(part, part)}"
    return _NAMES[path] if path in _NAMES else _spelled(path)


def _spelled(path: str) -> str:
    """A path in words, of a field that the design at hand does not have: ``Cam, roller radius``, ``Segment 7, span``."""
    head, _, key = path.rpartition(".")
    words = [part for part in (*head.split("."), split_unit(key)[0]) if part]
    words = [re.sub(r"s?\[(\d+)\]", lambda match: f" {int(match[1]) + 1}", word).replace("_", " ") for word in words]
    words = words[1:] if words[0] == "motion" and len(words) > 1 else words
    return sentence(", ".join(words))


def named(design: Design, text: str) -> str:
    """A text with the keys of the file in it, ``rod_mm``, or its paths, as the forms name them."""
    rows = [(entry.path, entry.info.label) for top in design.tables for entry in entries(design, top)]
    for path, label in (*rows, *_NAMES.items()):
        for spelled in (path, path.rpartition(".")[2]):
            if ("_" in spelled or "." in spelled) and spelled in text:
                text = re.sub(rf"(?<![\w.]){re.escape(spelled)}\b", f"{label[:1].lower()}{label[1:]}", text)
    return text


def reasons(design: Design, error: KindynaError) -> Reasons:
    """What an error says: of each fault of a design, or of what has no answer, the path, the name of the field as the forms have
    it, and the sentence; path and name are empty where it concerns no field."""
    if isinstance(error, DesignError):
        rows: Iterable[tuple[str, str]] = (
            (f.path, f"{f.problem}; allowed: {f.allowed}" if f.allowed else f.problem) for f in error.faults
        )
    else:
        path = getattr(error, "field", "")
        rows = ((path, str(error).removeprefix(f"{path}: ")),)
    of_file = isinstance(error, FileError)  # whose name may be anything
    return tuple(
        (path, name_of(design, path) if path else "", text if of_file else named(design, text)) for path, text in rows
    )


def reason(design: Design, error: KindynaError) -> str:
    """An error in a sentence for the reader, who knows fields by their names in the forms and has not typed what is wrong there:
    ``Segment 2, rise 150 mm: c6 is a return; allowed: < 0 mm, or a law that rises``."""
    values = [fault.value for fault in error.faults] if isinstance(error, DesignError) else [None]
    rows = zip(reasons(design, error), values, strict=True)
    return "; ".join(
        sentence(f"{name}{_typed(path, value)}: {text}" if name else text) for (path, name, text), value in rows
    )


def _typed(path: str, value: Any) -> str:
    """What stands in a field, behind its name: a number, or words that are no table of the file."""
    if isinstance(value, float):
        return f" {value_text(value, split_unit(path)[1])}"
    return f", {value}" if isinstance(value, str) and not value.startswith("[") else ""
