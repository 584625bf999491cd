"""Reading of a design from the tables of a file, with all faults of the file reported at once."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from numbers import Real
from typing import TYPE_CHECKING, Any

from core.design import (
    CURVES,
    MOTION,
    MOTION_SPEED,
    NO_LIMITS,
    Balancer,
    ClearanceRow,
    Design,
    Drive,
    Driver,
    Engine,
    LinkageLoads,
    Loads,
    Motion,
    NamedMotion,
    Origin,
    Outline,
    Output,
    Segment,
    Shaft,
    TimingRow,
    Tolerance,
    Waviness,
    blunders,
    entries,
    faults,
    only,
    part_faults,
    path_of,
    with_guesses_marked,
)
from core.design.design import SHARED
from core.design.fields import LAW, FileEntry, inside_of_table, slots
from core.design.followers import FACE, FORM, FORMS, Open, Roller, Rolling
from core.design.rules import count_fault
from core.design.spatial import SPATIAL_CAMS, SpatialCam
from core.errors import MISSING, DesignError, Fault
from core.laws import find_law
from core.project.reading_faults import (
    did_you_mean,
    hinted,
    missing,
    require_few_entries,
    spelled,
    stem,
    unknown_key,
)

if TYPE_CHECKING:
    from core.project.origins import Loader
from core.project.reading_faults import (
    CHOSEN_KEYS,
    KINDS,
    SPATIAL_KEYS,
    Tables,
    assumed_faults,
    driver_unit,
    face_word,
    follower_kind,
    format_faults,
    is_alone,
    is_in_space,
    kind_faults,
    likely_unit,
    name_faults,
    spatial_cam,
    table_classes,
    under_other_faces,
)

_ONE_MECHANISM = "exactly one of [drives.follower] | [drives.linkage], or [drives.cam] of a kind in space"
_HEADER = ("format", "name", "assumed")
_TOLERANCES = ("tolerances", "waviness")
_OUTLINES = ("outlines", "clearances")
_ALWAYS = {
    "follower": ("motion", "follower", "cam", "shaft"),
    "linkage": ("linkage",),
    MOTION: (MOTION,),
}  # required tables
_STRUCTURE = (
    r"linkage|linkage\.links\[\d+\]|linkage\.(branch|drawn)\..*|linkage\.driver\.(link|kind)|.*\.(link|on|point)"
)
"""Paths of faults that may follow from links that could not be read."""


class _NoWord(str):
    """Text that is identical to no other."""


# Values of entries that could not be read, so that the rules can check the rest: no rule applies to NaN, and faults whose value
# is one of these two objects are omitted.
NO_NUMBER = float("nan")
NO_WORD = _NoWord()


Rules = Callable[[Design], list[Fault]]


def design_from_tables(table: Tables, load: Loader, *, chain: Sequence[str] = (), unfinished: bool = False) -> Design:
    """Design in the tables of a file.

    Parameters
    ----------
    table : mapping
        Tables of the file, as from tomllib.
    load : Loader
        Reads a file to which the motion is linked.
    chain : sequence of str
        Files being read, that of the tables last.
    unfinished : bool
        Accept values that contradict each other.

    Returns
    -------
    Design

    Raises
    ------
    DesignError
        With all faults, or with the first count that is too large.
    """
    require_few_entries(table)
    rules: Rules = blunders if unfinished else faults
    new_reader = partial(Reader, load=load, chain=chain)
    try:
        return _read(table, rules, new_reader)
    except DesignError as error:
        from core.project.suggestions import confirmed  # late: needed only for a file with faults

        raise DesignError(confirmed(error.faults, table, lambda changed: _read(changed, rules, new_reader))) from None


def _read(table: Tables, rules: Rules, new_reader: Callable[[str], Reader]) -> Design:
    """Design in the tables, with the defaults of an elastic shaft. Raises DesignError."""
    all_faults = [*format_faults(table), *name_faults(table), *kind_faults(table)]
    kind = next((kind for kind in KINDS if kind in table), MOTION if is_alone(table) else "follower")
    design, design_faults = (_read_drives if kind == "drives" else _read_one_drive)(table, kind, rules, new_reader)
    design, tolerance_faults = _with_tolerances(table, design)
    if all_faults := [*all_faults, *design_faults, *([] if design_faults else tolerance_faults)]:
        raise DesignError(all_faults)
    return with_guesses_marked(design, table["shaft"]) if "shaft" in table else design


def _with_tolerances(table: Tables, design: Design) -> tuple[Design, list[Fault]]:
    """The design with its tolerances and the waviness of its profile, and the faults of these."""
    reader = Reader("")
    tolerances = reader.rows(table, "tolerances", Tolerance)
    waviness = reader.table(table, "waviness", Waviness, needed=False)
    parts = [(f"tolerances[{i}]", row) for i, row in enumerate(tolerances)]
    parts += [] if waviness is None else [("waviness", waviness)]
    too_many = count_fault("tolerances", len(tolerances))
    rule_faults = [fault for path, row in parts for fault in part_faults(row, path)]
    result = [too_many] if too_many else reader.with_rules(rule_faults, {})
    if waviness is not None and not result and waviness.lobes_from > waviness.lobes_to:
        result.append(
            Fault("waviness.lobes", [waviness.lobes_from, waviness.lobes_to], "bounds are reversed", "[low, high]")
        )
    if not result and tolerances:
        infos = {e.path: e.info for name in design.tables for e in entries(design, name)}
        for i, row in enumerate(tolerances):
            info = infos.get(row.field)
            if info is None or info.choices or info.whole or info.flag:
                suggestion = did_you_mean(
                    row.field, (p for p, e in infos.items() if not (e.choices or e.whole or e.flag))
                )
                result.append(
                    Fault(
                        f"tolerances[{i}].field",
                        row.field,
                        f"no number of this design{suggestion}",
                        "a path, as cam.base_radius_mm",
                    )
                )
            elif row.field in [earlier.field for earlier in tolerances[:i]]:
                result.append(Fault(f"tolerances[{i}].field", row.field, "given twice", "each field once"))
    return replace(design, tolerances=tolerances, waviness=waviness), result


def _read_outlines(reader: Reader, table: Tables) -> dict[str, Any]:
    """Outlines, whose drawings are relative to the folder of the file, and the clearances of pairs of bodies."""
    folder = os.path.dirname(reader.chain[-1]) if reader.chain else os.getcwd()
    outlines = reader.rows(table, "outlines", Outline)
    return {
        "outlines": tuple(replace(row, folder=folder) if row.file else row for row in outlines),
        "clearances": reader.rows(table, "clearances", ClearanceRow),
    }


def _marks(table: Tables) -> tuple[str, ...]:
    """Assumed paths, as far as they are text."""
    assumed = table.get("assumed", ())
    return tuple(path for path in assumed if isinstance(path, str)) if isinstance(assumed, list | tuple) else ()


def _read_one_drive(
    table: Tables, kind: str, rules: Rules, new_reader: Callable[[str], Reader]
) -> tuple[Design, list[Fault]]:
    """The design of one drive, and its faults in the order of the file."""
    reader = new_reader(likely_unit(table))
    key_faults, classes, parts = _read_drive(reader, table, kind, SHARED, [*_HEADER, *KINDS, *_TOLERANCES, *_OUTLINES])
    mechanism = Output(reader.unit) if kind == MOTION else parts[kind]
    drive = Drive(
        parts["motion"],
        mechanism,
        parts["cam"],
        parts["loads"],
        parts["limits"] or NO_LIMITS,
        servo=parts["servo"],
        valve=parts["valve"],
    )
    outlines = _read_outlines(reader, table)
    design = Design(table.get("name", ""), parts["shaft"], (drive,), _marks(table), engine=parts["engine"], **outlines)
    key_faults += reader.with_rules(
        rules(design), {e.path: e.in_file for name in design.tables for e in entries(design, name)}
    )
    unknown = [name for name, part_class in classes.items() if part_class is None]
    unknown += [] if kind in table and kind != MOTION else ["linkage"]
    key_faults += assumed_faults(table, design, unknown)
    tables = list(classes)  # in the order of the file, after its header
    return design, sorted(
        key_faults, key=lambda fault: next((i for i, t in enumerate(tables, 1) if fault.path.startswith(t)), 0)
    )


def _read_drive(
    reader: Reader, table: Tables, kind: str, shared: tuple[str, ...], header: Sequence[str]
) -> tuple[list[Fault], Mapping[str, type | None], Mapping[str, Any]]:
    """Tables of one drive: faults of their names, class of each table, and parts.

    shared: tables of the shaft that are read here; header: other keys allowed in the same table.
    """
    row, key_faults = follower_kind(table) if kind == "follower" else (None, [])
    in_space: tuple[type | None, ...] = ()
    if is_in_space(table) and kind == MOTION:
        cam_class, key_faults = spatial_cam(table)
        in_space = (cam_class,)
    elif is_in_space(table):
        problem = f"a cam in space moves the output of [motion] itself, without [{kind}]"
        key_faults = [
            *key_faults,
            Fault("cam.kind", table["cam"].get("kind", MISSING), problem, f"a disk cam, or no [{kind}]"),
        ]
        table = {name: value for name, value in table.items() if name != "cam"}
    face = face_word(table, row)
    if row:
        reader.unit = row.motion_unit
        reader.other_faces = under_other_faces(row, face or Rolling.face)
    linked = _linked_motion(reader, table)
    if linked is not None and kind == MOTION:
        reader.unit = linked.unit
    classes = {
        name: part_class
        for name, part_class in table_classes(kind, row, face, reader.unit, in_space).items()
        if name not in SHARED or name in shared
    }
    known = [*(key for key in header if key not in KINDS), *classes]
    key_faults = [
        *(unknown_key(spelled(key), key, table[key], known) for key in table if key not in known and key not in header),
        *key_faults,
    ]
    parts = {}
    # the shaft comes first, since its speed is that of the driver, and the driver defines the unit of the motion
    for name in dict.fromkeys(("shaft", kind, "motion", "cam", "engine", "valve", "loads", "limits", "servo")):
        if name not in classes:
            continue
        if name == "motion" and linked is not None:
            parts[name] = linked
            continue
        parts[name] = part = reader.table(table, name, classes[name], needed=name in _ALWAYS[kind])
        if name == "shaft" and part is not None:
            reader.shaft_rpm = part.signed_rpm
        if name == "cam" and part is not None:
            reader.slides = part.face.slides if kind == "linkage" else face not in (None, Rolling.face)
        if name == "linkage":
            parts[name] = part = replace(part, motions=_motions(table.get("motions", {}), reader))
            reader.unit = driver_unit(part, table.get("motion"))
    if any(fault.path == "cam.kind" for fault in key_faults):
        reader.faults = [fault for fault in reader.faults if fault.path != "cam"]
    if linked is not None and linked.unit != reader.unit:
        problem = f"gives a motion in {linked.unit}, and this design's is in {reader.unit}"
        reader.faults.append(Fault(_origin_path(table), MISSING, problem, f"a motion in {reader.unit}"))
    if kind == MOTION:
        return key_faults, classes, {"cam": None, "limits": None, **parts}
    if parts["limits"] is not None and kind == "linkage" and "cam" not in table:
        key_faults.append(
            Fault(
                "limits",
                "[limits]",
                "these are limits of a cam, but the design has no cam",
                "a table [cam], or remove [limits]",
            )
        )
    return key_faults, classes, parts


def _motions(table: Any, reader: Reader) -> tuple[NamedMotion, ...]:
    """Motions of second drivers by name."""
    if not isinstance(table, Mapping):
        reader.faults.append(Fault("motions", table, "must hold tables", "[motions.feed]"))
        return ()
    reader.unit = "deg"
    return tuple(NamedMotion(name, reader.part(Motion, row, f"motions.{name}")) for name, row in table.items())


ORIGINS = tuple(slot.key for slot in slots(Origin))


def _origin_path(table: Tables) -> str:
    return f"motion.{next(key for key in ORIGINS if key in table['motion'])}"


def _linked_motion(reader: Reader, table: Tables) -> Motion | None:
    """Motion linked to other files; None where it is typed."""
    typed = table.get("motion")
    if not isinstance(typed, Mapping) or not any(key in typed for key in ORIGINS):
        return None
    path, fault_count = _origin_path(table), len(reader.faults)
    origin = reader.part(Origin, {key: each for key, each in typed.items() if key in ORIGINS}, "motion")
    rest, requested = {key: each for key, each in typed.items() if key not in ORIGINS}, None
    for key in [key for key in ORIGINS if key in typed][1:]:
        reader.faults.append(Fault(f"motion.{key}", typed[key], f"cannot be combined with {path}", "one of them"))
    if origin.inverse is not None:
        requested_reader = Reader(likely_unit(table))
        requested = requested_reader.part(Motion, rest, "motion")
        reader.faults += requested_reader.with_rules(part_faults(requested, "motion"), {})
    else:
        reader.faults += [Fault(f"motion.{key}", rest[key], f"follows from {path}", "leave it out") for key in rest]
    if len(reader.faults) == fault_count:
        from core.project.origins import linked_motion  # late: few designs need it, and it imports core.motion

        try:
            assert reader.load is not None, "a reader of a design file loads others"
            return linked_motion(origin, requested, reader.unit, reader.chain, reader.load)
        except DesignError as error:
            reader.faults += error.faults
    return Motion(0.0, (Segment(360.0, 0.0),), reader.unit)


# -- several drives on a shaft ----------------------------------------------------------------------------

_SHAFT_KEYS = (*_HEADER, *SHARED, "drives", "timing", "balancer", *_TOLERANCES, *_OUTLINES)
_DRIVE_KEYS = tuple(slot.key for slot in slots(Drive))


def _read_drives(
    table: Tables, kind: str, rules: Rules, new_reader: Callable[[str], Reader]
) -> tuple[Design, list[Fault]]:
    """The design of a list of drives, and its faults in the order of the file."""
    list_faults = [
        unknown_key(spelled(key), key, table[key], _SHAFT_KEYS) for key in table if key not in (*_SHAFT_KEYS, *KINDS)
    ]
    reader, rows = new_reader(""), table[kind]
    shaft = reader.table(table, "shaft", Shaft, needed=True)
    engine = reader.table(table, "engine", Engine, needed=False)
    if not isinstance(rows, list | tuple) or not rows:
        list_faults.append(Fault(kind, rows, "must be a list of tables, one at least", f"[[{kind}]]"))
        return Design("", shaft, ()), [*list_faults, *reader.faults]
    drives, drive_faults, unsure = [], [], []
    for i, row in enumerate(rows):
        if not isinstance(row, Mapping):
            reader.faults.append(Fault(f"{kind}[{i}]", row, "must be a table", f"[[{kind}]]"))
            continue
        drive_reader = new_reader(likely_unit(row))
        drive, key_faults, unclear = _read_listed_drive(row, drive_reader, shaft)
        drives.append(drive)
        alone = only(Design("", shaft, (drive,), engine=engine), 0)
        rule_faults = (fault for fault in rules(alone) if not fault.path.startswith(SHARED))
        inner = drive_reader.with_rules(
            rule_faults, {e.path: e.in_file for name in alone.tables for e in entries(alone, name)}
        )
        drive_faults += [replace(fault, path=path_of(i, fault.path)) for fault in [*key_faults, *inner]]
        unsure += [f"{kind}[{i}].{name}" for name in unclear]
    timing = reader.rows(table, "timing", TimingRow)
    balancer = reader.table(table, "balancer", Balancer, needed=False)
    outlines = _read_outlines(reader, table)
    header = (table.get("name", ""), shaft, tuple(drives), _marks(table))
    design = Design(*header, timing, balancer, engine=engine, **outlines)
    if len(drives) < len(rows):
        return design, [*list_faults, *reader.faults, *drive_faults]
    broken = {fault.path for fault in drive_faults}
    unread = any(".motion" in path or path.endswith(".name") for path in broken)  # then an event may be missing
    reader.faults += drive_faults
    known = (f for f in rules(design) if not (unread and f.path.startswith(("timing", *_OUTLINES))))
    shaft_faults = reader.with_rules((f for f in known if not _OF_A_DRIVE.fullmatch(f.path)), {})
    if not any(path.endswith(".name") for path in broken):
        list_faults += assumed_faults(table, design, unsure)
    return design, [*list_faults, *shaft_faults]


_OF_A_DRIVE = re.compile(r"drives\[\d+\]\.(?!name$|phase_deg$|mirrored$|carries).*")


def _read_listed_drive(row: Tables, reader: Reader, shaft: Shaft) -> tuple[Drive, list[Fault], list[str]]:
    """One drive of the list, with the faults of its keys, and the names of tables whose class is unknown."""
    kinds = [kind for kind in KINDS[:2] if kind in row]
    kind = kinds[0] if kinds else MOTION if is_alone(row) and is_in_space(row) else "follower"
    values: dict[str, Any] = {}
    for slot in slots(Drive):
        if slot.key in row:
            (values[slot.key],) = reader.entry(slot, row[slot.key], slot.key)
        elif slot.key == "name":
            reader.faults.append(missing(slot.key, slot.placing.missing))
            values[slot.key] = NO_WORD
    if values.get("mirrored") not in (True, False):
        values["mirrored"] = False
    reader.shaft_rpm = shaft.signed_rpm * (-1.0 if values["mirrored"] else 1.0)
    key_faults, classes, parts = _read_drive(reader, row, kind, (), [*_DRIVE_KEYS, *KINDS[:2]])
    key_faults += [
        Fault(key, row[key], f"cannot be combined with {kind}: a drive has one mechanism", _ONE_MECHANISM)
        for key in kinds[1:]
    ]
    if not kinds and is_alone(row) and kind != MOTION:
        problem = "is without a mechanism, which a drive needs; a motion alone is a separate file"
        reader.faults = [fault for fault in reader.faults if fault.path != "cam"]
        key_faults.append(Fault(MOTION, MISSING, problem, f"{_ONE_MECHANISM} in addition"))
    elif not kinds and kind != MOTION:
        key_faults.append(missing("follower", _ONE_MECHANISM))
    drive = Drive(
        parts["motion"],
        Output(reader.unit) if kind == MOTION else parts[kind],
        parts["cam"],
        parts["loads"],
        parts["limits"] or NO_LIMITS,
        servo=parts["servo"],
        valve=parts["valve"],
        **values,
    )
    if drive.valve is not None and "phase_deg" in row:
        problem = "cannot be combined with valve.centre_deg, which gives the phase"
        reader.faults.append(Fault("phase_deg", row["phase_deg"], problem, "one of them"))
    unclear = [name for name, part_class in classes.items() if part_class is None]
    unclear += [] if kinds or kind == MOTION else ["linkage"]
    return drive, key_faults, unclear


# -- reader of all parts ----------------------------------------------------------------------------------------


class Reader:
    """Reads tables of a file into parts of a design, by the entries of their classes (`fields.slots`).

    `faults` collects the faults. Values that cannot be read are NO_NUMBER or NO_WORD, to which no rule applies.
    """

    def __init__(self, unit: str, load: Loader | None = None, chain: Sequence[str] = ()) -> None:
        self.unit = unit  # of the motion
        self.load, self.chain = load, chain  # for a linked motion
        self.shaft_rpm: float | None = None  # clockwise negative
        self.slides = False  # whether the face slides on the cam
        self.other_faces: Mapping[str, str] = {}  # path of an entry with another face -> the face's word
        self.faults: list[Fault] = []

    def table(self, tables: Tables, name: str, kind: type | None, *, needed: bool) -> Any:
        """One table of the file as a part.

        A part of unknown values where a required table is missing or is no table; None for an optional table, or an unknown class.
        """
        if name not in tables:
            if needed and name != "follower":
                keys = ", ".join(slot.key for slot in slots(kind, self.unit) if slot.missing) if kind else ""
                self.faults.append(missing(name, f"a table [{name}]{' with ' * bool(keys)}{keys}"))
            return self.part(kind, MISSING, name) if kind and (needed or name == "loads") else None
        value = tables[name]
        if not isinstance(value, Mapping):
            self.faults.append(Fault(name, value, "must be a table", f"[{name}]"))
            value = MISSING
        elif name == "follower" or (name == "cam" and kind is not None and issubclass(kind, SpatialCam)):
            value = {key: entry for key, entry in value.items() if key != "kind"}
        return self.part(kind, value, name) if kind else None

    def rows(self, tables: Tables, name: str, kind: type) -> tuple[Any, ...]:
        """A list of tables at the top of the file."""
        rows = tables.get(name, ())
        if not isinstance(rows, list | tuple):
            self.faults.append(Fault(name, rows, "must be a list of tables", f"[[{name}]]"))
            return ()
        return tuple(self.part(kind, row, f"{name}[{i}]") for i, row in enumerate(rows))

    def part(self, kind: Any, value: Any, path: str) -> Any:
        """A part of a class from its table; MISSING where the table is already reported as a fault."""
        if value is not MISSING and not isinstance(value, Mapping):
            self.faults.append(Fault(path, value, "must be a table"))
            value = MISSING
        table = self._with_defaults(kind, {} if value is MISSING else value)
        inside = inside_of_table(kind, table)
        entries = slots(kind, self.unit, inside)
        values: dict[str, dict[str, Any]] = {"": {}, **{name: {} for name, _ in inside}}
        unsure = {
            slot.within
            for slot in entries
            if slot.placing.word and table.get(slot.key, "") not in ("", *slot.placing.words)
        }
        for slot in entries:
            at = f"{path}.{slot.key}"
            if slot.key in table:
                read = self.entry(slot, table[slot.key], at)
            else:
                lacks = (
                    slot.missing is not None and value is not MISSING and not (slot.within and slot.within in unsure)
                )
                if lacks and all(stem(key) != stem(slot.key) for key in table):  # else a key has a wrong unit
                    self.faults.append(missing(at, slot.missing or ""))
                read = self._absent(slot)
            values[slot.within].update(zip(slot.names, read, strict=False))
        extra = table.keys() - {slot.key for slot in entries}
        if spread := next((slot for slot in entries if slot.placing.spread), None):
            rows = {key: each for key, each in table.items() if key in extra}
            values[spread.within].update(zip(spread.names, self.entry(spread, rows, path), strict=True))
        elif extra:
            known = [slot.key for slot in slots(kind, self.unit, inside_of_table(kind, table, possible=True))]
            for key in sorted(extra - (CHOSEN_KEYS.keys() if unsure else set()), key=str):
                at = f"{path}.{spelled(key)}"
                words = SPATIAL_KEYS if kind in SPATIAL_CAMS.values() else CHOSEN_KEYS
                word = words.get(key) if path in ("cam", "follower") else None
                if word := word or self.other_faces.get(at):
                    self.faults.append(Fault(at, table[key], f"only with {word}", " | ".join(known)))
                else:
                    self.faults.append(unknown_key(at, key, table[key], known))
        arguments = values.pop("") | {name: part(**values[name]) for name, part in inside}
        return kind(**arguments, unit=self.unit) if kind is Motion else kind(**arguments)

    def _with_defaults(self, kind: type, table: Tables) -> Tables:
        """A part's table with defaults that depend on other entries or tables.

        They are the rise of a dwell, and the speed of a driver that has the shaft's speed or follows a motion.
        """
        if kind is Segment:
            word = table.get(LAW)
            law = find_law(word) if isinstance(word, str) else None
            if law is not None:
                return {f"rise_{self.unit}": 0.0, **table} if law.is_dwell else table
            return {f"rise_{self.unit}": 0.0 if isinstance(word, str) and word in CURVES else NO_NUMBER, **table}
        if kind is Driver and (self.shaft_rpm is not None or table.get("kind") == MOTION):
            return {"speed_rpm": MOTION_SPEED if self.shaft_rpm is None else self.shaft_rpm, **table}
        if self.slides and issubclass(kind, Loads | LinkageLoads):
            return {"contact_friction": 0.0, **table}
        return table

    def _absent(self, slot: FileEntry) -> tuple[Any, ...]:
        """Values of the fields of an entry that is not in the file."""
        if slot.missing is None:
            return (slot.default,) * len(slot.names)
        if slot.info is not None:
            return (NO_WORD if slot.info.choices else NO_NUMBER,) * len(slot.names)
        if slot.placing.kind is None:
            return (NO_WORD,)
        return (self.part(slot.placing.kind, MISSING, ""),) if slot.placing.single else ((),)

    def entry(self, slot: FileEntry, value: Any, at: str) -> tuple[Any, ...]:
        """Values of the fields of an entry of the file."""
        info, placing = slot.info, slot.placing
        if len(slot.names) > 1:
            return self._pair(slot, value, at)
        if info is not None and info.flag:
            if not isinstance(value, bool):
                self.faults.append(Fault(at, value, "must be true or false", slot.allowed))
            return (value,)
        if info is not None and not info.choices:
            return (self._number(slot, value, at),)
        if placing.each is not None:
            return (self._plain_list(placing.each, value, at),)
        if placing.kind is None:
            if isinstance(value, str):
                is_disk = placing.word == FORM and Open.form in placing.words
                if is_disk and value in set(FORMS) - placing.words.keys():
                    self.faults.append(
                        Fault(at, value, "requires a roller", f'{slot.allowed}, or {FACE} = "{Roller.face}"')
                    )
                elif placing.word and value not in placing.words:
                    self.faults.append(hinted(Fault(at, value, "unknown word", slot.allowed)))
                return (value,)
            self.faults.append(Fault(at, value, "must be text", slot.allowed))
            return (NO_WORD,)
        if placing.key:
            return (tuple(self._named_rows(placing.kind, value, at)),)
        if slot.placing.single:
            return (self.part(placing.kind, value, at),)
        if not isinstance(value, list | tuple):
            self.faults.append(Fault(at, value, "must be a list of tables", f"[[{at}]]"))
            value = ()
        if placing.rows:
            value = [self._row(placing.kind, row, f"{at}[{i}]") for i, row in enumerate(value)]
        return (tuple(self.part(placing.kind, row, f"{at}[{i}]") for i, row in enumerate(value)),)

    def _plain_list(self, kind: type[float] | type[str], value: Any, at: str) -> tuple[Any, ...]:
        """A list of numbers, or of words."""
        noun = "numbers" if kind is float else "words"
        if not isinstance(value, list | tuple) or not value:
            self.faults.append(Fault(at, value, f"must be a list of {noun}, one at least"))
            return ()
        for i, item in enumerate(value):
            is_valid = isinstance(item, str) if kind is str else isinstance(item, Real) and not isinstance(item, bool)
            if not is_valid or (kind is float and not math.isfinite(item)):
                self.faults.append(Fault(f"{at}[{i}]", item, f"must be a {noun[:-1]}"))
                return ()
        return tuple(map(kind, value))

    def _row(self, kind: Any, value: Any, at: str) -> Any:
        """Table of a part that is given as a list of numbers."""
        keys = [slot.key for slot in slots(kind)]
        if isinstance(value, list | tuple) and 2 <= len(value) <= len(keys):
            return dict(zip(keys, value, strict=False))
        self.faults.append(
            Fault(at, value, "must be a row of numbers", f"[{', '.join(keys)}], the last ones where they are known")
        )
        return MISSING

    def _named_rows(self, kind: type, value: Any, at: str) -> Iterator[Any]:
        """Rows of one value or pair each, by name."""
        if not isinstance(value, Mapping):
            self.faults.append(Fault(at, value, "must be a table"))
            return
        _, content = slots(kind)
        yield from (
            kind(str(name), *self.entry(content, entry, f"{at}.{spelled(name)}")) for name, entry in value.items()
        )

    def _number(self, slot: FileEntry, value: Any, at: str) -> Any:
        """A number, an integer where the field requires one."""
        info = slot.info
        assert info is not None
        problem = info.problem if info.numbers else f"must be a {'whole ' * info.whole}number"
        if (
            isinstance(value, int if info.whole else Real)
            and not isinstance(value, bool)
            and (value in info.numbers or not info.numbers)
        ):
            try:
                return value if info.whole else float(value)
            except OverflowError:
                problem = "too large for a number"
        self.faults.append(Fault(at, value, problem, slot.allowed))
        return NO_NUMBER

    def _pair(self, slot: FileEntry, value: Any, at: str) -> tuple[float, ...]:
        """A pair `[x, y]`."""
        if isinstance(value, list | tuple) and len(value) == len(slot.names):
            return tuple(self._number(slot, number, at) for number in value)
        self.faults.append(Fault(at, value, "must be two numbers", "[x, y]"))
        return (NO_NUMBER,) * len(slot.names)

    def with_rules(self, rule_faults: Iterable[Fault], paths: Mapping[str, str]) -> list[Fault]:
        """All faults, one for each path: those of reading, then those of the rules.

        paths: path of an entry -> path of the entry of the file that contains it.
        """
        result = list({fault.path: fault for fault in reversed(self.faults)}.values())[::-1]
        reported = {fault.path for fault in result}
        broken = any(re.match(r"linkage($|\.(links|sliders|driver))", path) for path in reported)
        unread = tuple(f"{path}{mark}" for path in reported for mark in ".[")
        for fault in rule_faults:
            path = paths.get(fault.path, fault.path)
            is_unread = fault.value is NO_NUMBER or fault.value is NO_WORD
            follows = broken and (fault.value is MISSING or re.fullmatch(_STRUCTURE, path))
            if not (path in reported or path.startswith(unread) or is_unread or follows):
                result.append(hinted(replace(fault, path=path)))
                if path != fault.path:
                    reported.add(path)  # one fault of a pair is enough
        return result
