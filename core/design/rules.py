"""Rules that relate several fields, as tables; ``faults`` returns all faults of a design."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Any

from core.design.camshaft import RESERVED, drive_names, drive_of, events, named_event, only, path_of, slug
from core.design.design import SHARED, Design, Drive
from core.design.engine import Engine
from core.design.fields import slots
from core.design.follower_kinds import FOLLOWER_KINDS
from core.design.followers import FORM, CamDetails, Conjugate, Open, Roller
from core.design.linkage import LinkageCam
from core.design.linkage_rules import DRIVE_RULES
from core.design.load_rules import element_faults
from core.design.motions import (
    JOINED,
    MINIMISED,
    TABLE_ENDS,
    LobeSegments,
    Motion,
    NamedCurve,
    OptimalCurve,
    SccaCurve,
    Segment,
    SplineCurve,
    TableCurve,
    is_joined,
)
from core.design.parts import LINEAR, ROTARY, CamSlider, DiskCam, RollerCam, Servo
from core.design.paths import entries_of
from core.design.spatial import BarrelCam, GloboidalCam, SpatialCam, motion_faults, shape_faults
from core.errors import MISSING, Fault
from core.file_names import LONGEST
from core.laws import LAWS, find_law

MOST: Mapping[str, int] = MappingProxyType(
    {
        "motion.segments": 3600,
        "linkage.links": 100,
        "linkage.sliders": 100,
        "loads.masses": 100,
        "loads.forces": 1000,
        "loads.springs": 100,
        "loads.torsion_springs": 100,
        "loads.pair_friction": 100,
        "loads.process": 100,
        "loads.process.points": 720,
        "loads.valve_springs": 10,
        "drives": 24,
        "timing": 200,
        "tolerances": 200,
        "outlines": 100,
        "outlines.points": 1000,
        "clearances": 200,
    }
)
"""List -> greatest number of its rows."""
MOST_OF_LIST = 4000  # rows of any other list
MOST_KEYS = 500  # keys of any table


def count_fault(path: str, count: int) -> Fault | None:
    """Fault of a list with too many rows; None where the number is allowed. ``path`` is as in the file."""
    name = path.rsplit(".", 1)[-1]
    most = MOST.get(re.sub(r"\[\d+\]", "", re.sub(r"^drives\[\d+\]\.", "", path)), MOST_OF_LIST)
    return Fault(path, MISSING, f"{count} {name} are too many", f"at most {most}") if count > most else None


CLOSING = 1e-9  # tolerance of the sums of spans [deg] and rises [mm or deg]


def total_of(numbers: Iterable[float]) -> float:
    """Sum of numbers; NaN, which violates no rule, where infinities cancel."""
    try:
        return math.fsum(numbers)
    except OverflowError:
        return math.inf
    except ValueError:
        return math.nan


def _spans_make_a_turn(motion: Motion, path: str) -> Iterator[Fault]:
    if not motion.segments:
        yield Fault(f"{path}.segments", [], "no segments", "at least one, spans adding up to 360 deg")
        return
    total = total_of(s.span_deg for s in motion.segments)
    if abs(total - 360.0) > CLOSING:
        yield Fault(f"{path}.segments", f"spans add up to {total:.12g} deg", "must make one turn", "a sum of 360 deg")


def _rises_return_to_start(motion: Motion, path: str) -> Iterator[Fault]:
    total, unit = total_of(s.rise for s in motion.segments), motion.unit
    if abs(total - motion.gain) > CLOSING:
        value = f"rises add up to {total:.12g} {unit}"
        problem = f"are not advance_{unit}" if motion.gain else "the follower must return to its start"
        yield Fault(f"{path}.segments", value, problem, f"a sum of {motion.gain:.12g} {unit}")


def _follows_its_origin(motion: Motion, path: str) -> Iterator[Fault]:
    """A motion from linked files cannot be changed."""
    if motion.follows is not None and not motion.is_as_linked:
        names = ", ".join(motion.follows.origin.names)
        problem = f"this motion follows from {names}, and is changed there"
        yield Fault(f"{path}.{motion.follows.origin.key}", MISSING, problem, "first: Unlink from the files")


def _lobe(motion: Motion, path: str) -> Iterator[Fault]:
    """A lobe gives all segments of a motion in mm."""
    if motion.lobe is None:
        return
    from core.design.lobe import lobe_fault  # imported here to save start-up time

    if not isinstance(motion.segments, LobeSegments):
        yield Fault(f"{path}.segments", MISSING, f"cannot be combined with {path}.lobe", "first: Lobe to segments")
    elif motion.unit != "mm":
        yield Fault(f"{path}.lobe", "[motion.lobe]", f"a lobe is in mm, the motion in {motion.unit}", "a motion in mm")
    elif (fault := lobe_fault(motion.lobe)) is not None:
        yield replace(fault, path=f"{path}.lobe.{fault.path}".removesuffix("."))


def _cam_repeats(drive: Drive) -> Iterator[Fault]:
    """A disk cam cannot make a motion with an advance."""
    if drive.motion is not None and drive.motion.gain and drive.has_disk:
        allowed = "no advance; or a [linkage] without [cam], or [motion] alone"
        path = f"motion.advance_{drive.motion.unit}"
        yield Fault(path, drive.motion.advance, "a disk cam repeats its motion every turn", allowed)


def _law_is_known(segment: Segment, path: str) -> Iterator[Fault]:
    if isinstance(segment.curve, NamedCurve) and find_law(segment.curve.law) is None:
        yield Fault(f"{path}.law", segment.curve.law, "unknown law", " | ".join(LAWS))


def _law_fits_rise(segment: Segment, path: str, unit: str) -> Iterator[Fault]:
    if isinstance(segment.curve, OptimalCurve) and segment.rise == 0.0:
        problem = "an optimal law rises or returns"
        yield Fault(f"{path}.rise_{unit}", segment.rise, problem, "any number but 0, or another law")
    law = find_law(segment.curve.law) if isinstance(segment.curve, NamedCurve) else None
    if law is None:
        return
    if law.is_dwell and segment.rise != 0.0:
        yield Fault(f"{path}.rise_{unit}", segment.rise, "a dwell does not rise", "0, or another law")
    elif law.rises < 0 and segment.rise >= 0.0:
        yield Fault(f"{path}.rise_{unit}", segment.rise, f"{law.slug} is a return", f"< 0 {unit}, or a law that rises")


def _named_curve_options(curve: NamedCurve, segment: Segment, path: str) -> Iterator[Fault]:
    law = find_law(curve.law)
    if law is not None and curve.crossover != 0.5 and not law.is_symmetric:
        yield Fault(f"{path}.crossover", curve.crossover, f"{law.slug} is not symmetric", "0.5, or another law")
    if law is not None and curve.flat_fraction != 0.0 and law.flat is None:
        yield Fault(
            f"{path}.flat_fraction",
            curve.flat_fraction,
            f"{law.slug} cannot have a constant acceleration",
            "0, or c1 ... c4",
        )


def _ramps_fit(curve: SccaCurve, segment: Segment, path: str) -> Iterator[Fault]:
    total = curve.ramp_fraction + curve.flat_fraction
    if total > 1.0:
        value = f"ramp_fraction + flat_fraction = {total:.9g}"
        yield Fault(path, value, "more than the full span", "a sum of at most 1")


def _points_are_in_the_span(curve: SplineCurve, segment: Segment, path: str) -> Iterator[Fault]:
    seen: set[tuple[float, int]] = set()
    for i, point in enumerate(curve.points):
        at = f"{path}.points[{i}]"
        if point.at_deg > segment.span_deg:
            yield Fault(f"{at}.at_deg", point.at_deg, "beyond its segment", f"0 ... {segment.span_deg:g} deg")
        if point.value is None and point.velocity is None and point.acceleration is None:
            yield Fault(at, MISSING, "has no value", "value, velocity or acceleration")
        for order, value in enumerate((point.value, point.velocity, point.acceleration)):
            if value is not None and (point.at_deg, order) in seen:
                yield Fault(f"{at}.at_deg", point.at_deg, "given twice", "one point at an angle")
            if value is not None:
                seen.add((point.at_deg, order))


def _rows_are_complete(curve: TableCurve, segment: Segment, path: str) -> Iterator[Fault]:
    """A row has its numbers in order, each only together with those before it."""
    yield from _points_are_in_the_span(curve, segment, path)
    for i, point in enumerate(curve.points):
        at = f"{path}.points[{i}]"
        if point.value is None and (point.velocity, point.acceleration) != (None, None):
            yield Fault(f"{at}.value", MISSING, "a row of a table has a value", "any number")
        elif point.velocity is None and point.acceleration is not None:
            yield Fault(f"{at}.velocity", MISSING, "a row with an acceleration has a velocity too", "any number")


def _optimal_law_is_stated(curve: OptimalCurve, segment: Segment, path: str) -> Iterator[Fault]:
    """The bounds of an optimal law have a length, its followers oscillate."""
    yield from _points_are_in_the_span(curve, segment, path)
    for i, cycles in enumerate(curve.vibration_free):
        if not 0.0 < cycles <= MOST_CYCLES:
            yield Fault(f"{path}.vibration_free[{i}]", cycles, "cycles a span", f"above 0 ... {MOST_CYCLES:g}")
    for key in ("below", "above"):
        for i, bound in enumerate(getattr(curve, key)):
            if bound.end <= bound.start:
                yield Fault(f"{path}.{key}[{i}]", [bound.start, bound.end], "ends before it starts", "from < to")


MOST_CYCLES = 1000.0  # a span: more are vibrations that no law excites

CURVE_RULES: Mapping[type, Callable[[Any, Segment, str], Iterator[Fault]]] = MappingProxyType(
    {
        NamedCurve: _named_curve_options,
        SccaCurve: _ramps_fit,
        SplineCurve: _points_are_in_the_span,
        TableCurve: _rows_are_complete,
        OptimalCurve: _optimal_law_is_stated,
    }
)


def _joined_neighbour(motion: Motion, index: int, path: str) -> Iterator[Fault]:
    """A joined end of a table needs a neighbour whose velocity is determined."""
    segments = motion.segments
    for end, side in (("start", -1), ("end", 1)) if len(segments) > 1 else ():
        neighbour = segments[(index + side) % len(segments)].curve
        is_undetermined = is_joined(neighbour, "start") or is_joined(neighbour, "end")
        if is_undetermined and is_joined(segments[index].curve, end):
            yield Fault(f"{path}.{end}", JOINED, "the adjacent segment is joined itself", " | ".join(TABLE_ENDS[:-1]))


def _segments(motion: Motion, path: str) -> Iterator[Fault]:
    for i, segment in enumerate(motion.segments):
        at = f"{path}.segments[{i}]"
        yield from _law_is_known(segment, at)
        yield from _law_fits_rise(segment, at, motion.unit)
        yield from _joined_neighbour(motion, i, at)
        rule = CURVE_RULES.get(type(segment.curve))
        if rule is not None:
            yield from rule(segment.curve, segment, at)


def _bore_and_hub(cam: CamDetails, path: str) -> Iterator[Fault]:
    """The hub is larger than the bore, the bore wider than the keyway."""
    bore, hub, key = cam.bore_mm, cam.hub_mm, cam.keyway_width_mm
    if bore is not None and hub is not None and hub <= bore:
        yield Fault(f"{path}.hub_mm", hub, "not larger than the bore", f"> {bore:g} mm")
    if bore is not None and key is not None and key >= bore:
        yield Fault(f"{path}.keyway_width_mm", key, "not narrower than the bore", f"< {bore:g} mm")


def _groove_is_in_the_blank(cam: RollerCam | DiskCam | LinkageCam, path: str) -> Iterator[Fault]:
    """The groove is shallower than its blank is thick."""
    depth = getattr(cam.form, "groove_depth_mm", None)
    if depth is not None and cam.thickness_mm is not None and depth >= cam.thickness_mm:
        yield Fault(f"{path}.groove_depth_mm", depth, "not less than the thickness", f"< {cam.thickness_mm:g} mm")


def _layout_agrees_with_pivot(follower: CamSlider, path: str) -> Iterator[Fault]:
    x, letter = follower.pivot_x_mm, follower.layout
    if x == 0.0:
        yield Fault(f"{path}.pivot_x_mm", x, "the cam must be left or right of the pivot", "> 0 or < 0")
    elif letter in "abef" and x < 0.0:
        yield Fault(
            f"{path}.layout",
            letter,
            f"has the cam left of the pivot, but pivot_x_mm = {x:g}",
            "c | d | g | h, or pivot_x_mm > 0",
        )
    elif letter in "cdgh" and x > 0.0:
        yield Fault(
            f"{path}.layout",
            letter,
            f"has the cam right of the pivot, but pivot_x_mm = {x:g}",
            "a | b | e | f, or pivot_x_mm < 0",
        )


def _rod_is_long(engine: Engine, path: str) -> Iterator[Fault]:
    """The rod turns past every position of the crank."""
    least = 0.5 * engine.stroke_mm + abs(engine.pin_offset_mm)
    if engine.rod_mm <= least:
        yield Fault(f"{path}.rod_mm", engine.rod_mm, "not longer than crank and pin offset together", f"> {least:g} mm")


RULES: Mapping[type, tuple[Callable[[Any, str], Iterator[Fault]], ...]] = MappingProxyType(
    {
        Motion: (_segments, _spans_make_a_turn, _rises_return_to_start, _follows_its_origin, _lobe),
        CamSlider: (_layout_agrees_with_pivot,),
        RollerCam: (_bore_and_hub, _groove_is_in_the_blank),
        DiskCam: (_bore_and_hub, _groove_is_in_the_blank),
        LinkageCam: (_bore_and_hub, _groove_is_in_the_blank),
        Engine: (_rod_is_long,),
        BarrelCam: (shape_faults,),
        GloboidalCam: (shape_faults,),
    }
)


def part_faults(part: Any, path: str) -> list[Fault]:
    """Faults of one table: ranges of its entries, then rules that relate them.

    Rules are applied to values outside of their ranges too, so that they must accept any number, NaN included.
    """
    if over := _too_many(part, path):
        return over
    result = _out_of_range(part, path)
    wrong = {fault.path for fault in result}
    for rule in RULES.get(type(part), ()):
        result.extend(fault for fault in rule(part, path) if fault.path not in wrong)
    return result


def _out_of_range(part: Any, path: str) -> list[Fault]:
    """Faults of entries outside of their ranges."""
    return [
        Fault(entry.path, entry.value, entry.info.problem, entry.info.allowed(entry.unit))
        for entry in entries_of(part, path)
        if not entry.info.admits(entry.value)
    ]


def _too_many(part: Any, path: str) -> list[Fault]:
    """Faults of lists with too many rows."""
    lists = ((name, value) for name, value in vars(part).items() if isinstance(value, tuple))
    return [fault for name, rows in lists if (fault := count_fault(f"{path}.{name}", len(rows)))]


_ROWS = ("drives", "timing", "outlines", "clearances")
"""Lists at the top of a file."""


def faults(design: Design) -> list[Fault]:
    """All faults of a design, in the order of the file."""
    if over := [fault for name in _ROWS if (fault := count_fault(name, len(getattr(design, name))))]:
        return over
    result = _list_faults(design) if design.listed else _drive_faults(design)
    if design.outlines or design.clearances:
        from core.design.outline_rules import outline_faults  # imported here to save start-up time

        wrong = {fault.path for fault in result}
        result += [fault for fault in outline_faults(design) if fault.path not in wrong]
    return result


def blunders(design: Design) -> list[Fault]:
    """Faults that no change of another value can remedy: values outside of their ranges, too many rows, equal names of drives."""
    tables = design.tables.items()
    result = [fault for name in _ROWS if (fault := count_fault(name, len(getattr(design, name))))]
    result += [fault for name, part in tables for fault in (_too_many(part, name) or _out_of_range(part, name))]
    return [*result, *_names_differ(design)] if design.listed else result


def _list_faults(design: Design) -> list[Fault]:
    """Faults of the shaft, of each drive by itself, and of their relations."""
    result = (
        [Fault("shaft", MISSING, "missing", "a table [shaft]")]
        if design.shaft is None
        else part_faults(design.shaft, "shaft")
    )
    for i, drive in enumerate(design.drives):
        result += part_faults(drive, f"drives[{i}]")
        single = _drive_faults(only(design, i))
        result += [replace(fault, path=path_of(i, fault.path)) for fault in single if not fault.path.startswith(SHARED)]
    for i, row in enumerate(design.timing):
        result += part_faults(row, f"timing[{i}]")
    for name, part in design.tables.items():
        result += part_faults(part, name) if name.startswith(("outlines[", "clearances[")) else []
    result += [] if design.balancer is None else part_faults(design.balancer, "balancer")
    result += [] if design.engine is None else part_faults(design.engine, "engine")
    return [*result, *_names_differ(design), *_directions(design), *_events_exist(design)]


def _names_differ(design: Design) -> Iterator[Fault]:
    """Every drive has a name with a unique slug, which names its columns and folders."""
    seen: dict[str, str] = {}
    for i, drive in enumerate(design.drives):
        path, name = f"drives[{i}].name", drive.name
        if name is None:
            yield Fault(path, MISSING, "missing", "any text with a letter or a digit")
            continue
        short = slug(name)
        if not short.strip("_"):
            yield Fault(
                path, name, "has no letter and no digit, so its slug is empty", "any text with a letter or a digit"
            )
        elif len(short.encode()) > LONGEST:
            yield Fault(
                path,
                name,
                "is too long for the name of a folder",
                f"at most {LONGEST} bytes of letters and digits",
            )
        elif short in RESERVED:
            yield Fault(
                path,
                name,
                f"its slug, {short}, is that of another column of shaft.csv",
                f"not {' nor '.join(RESERVED)}",
            )
        elif short in seen:
            yield Fault(
                path, name, f"has the slug of {seen[short]}, {short}", "names that differ in a letter or a digit"
            )
        seen.setdefault(short, path)


def _directions(design: Design) -> Iterator[Fault]:
    """A carrying drive has a direction in space, and a motion in mm or an arm."""
    for i, drive in enumerate(design.drives):
        path, value = f"drives[{i}].carries", list(drive.carries)
        if value and (len(value) != 3 or not any(value)):
            yield Fault(path, value, "is no direction in space", "three numbers, not all 0: [0.0, 0.0, 1.0] is upwards")
        elif value and drive.carried_per_motion is None:
            yield Fault(path, value, "has no motion that could carry a part", "a motion in mm, or an arm that swings")


def _events_exist(design: Design) -> Iterator[Fault]:
    """Sequence conditions name existing events; a faulty name of a drive is reported alone."""
    if not design.timing or any(True for _ in _names_differ(design)):
        return
    known, names = events(design), drive_names(design)
    for i, row in enumerate(design.timing):
        for key in ("first", "second"):
            event = getattr(row, key)
            named = named_event(design, event)
            if drive_of(named) not in names:
                yield Fault(
                    f"timing[{i}].{key}",
                    event,
                    f"no drive has the name {drive_of(event)}",
                    f"events of {' | '.join(names)}",
                )
            elif named not in known:
                same_drive = [event for event in known if drive_of(event) == drive_of(named)]
                allowed = " | ".join(same_drive) or f"none: {drive_of(named)} neither rises nor returns"
                yield Fault(f"timing[{i}].{key}", event, "unknown event", allowed)


def _drive_faults(design: Design) -> list[Fault]:
    tables = design.tables.items()
    if over := [fault for name, part in tables for fault in _too_many(part, name)]:
        return over
    result = [fault for name, part in tables for fault in part_faults(part, name)]
    wrong = {fault.path for fault in result}
    for rule in (*(DRIVE_RULES if design.drive.is_linkage else ()), element_faults):
        for fault in rule(design.drive):
            if fault.path not in wrong:
                wrong.add(fault.path)
                result.append(fault)
    servo = () if design.drive.servo is None else _servo_faults(design.drive, design.drive.servo)
    return [
        *result,
        *_cam_repeats(design.drive),
        *_face_agrees(design),
        *_form_agrees(design),
        *_speeds_agree(design),
        *(() if any(path.startswith("cam.") for path in wrong) else spatial_faults(design.drive)),
        *servo,
        *_laws_have_effects(design.drive),
        *_valve_faults(design),
    ]


def _laws_have_effects(drive: Drive) -> Iterator[Fault]:
    """The machine of an optimal law has the torque or force that it minimises."""
    for i, segment in enumerate(() if drive.motion is None else drive.motion.segments):
        curve = segment.curve
        if isinstance(curve, OptimalCurve) and (needs := missing_for_effect(drive, curve.minimise)):
            problem = f"needs {needs}, which this design does not have"
            allowed = " | ".join(word for word in MINIMISED if not missing_for_effect(drive, word))
            yield Fault(f"motion.segments[{i}].minimise", curve.minimise, problem, allowed)


def missing_for_effect(drive: Drive, aim: str) -> str:
    """What a drive lacks for the torque or force that an optimal law minimises, in words; empty where it has all."""
    turns = (
        drive.cam is not None or drive.servo is not None or (drive.motion is not None and drive.motion.unit == "deg")
    )
    rows = {
        "torque": (turns, "a cam, a motion in degrees, or [servo]"),
        "contact_force": (drive.cam is not None, "a cam"),
        "motor_rms": (drive.servo is not None, "[servo]"),
    }
    has, needs = rows.get(aim, (True, ""))
    return "" if has else needs


def _valve_faults(design: Design) -> list[Fault]:
    if design.drive.valve is None:
        return []
    from core.design.valve_rules import valve_faults  # imported here to save start-up time

    return list(valve_faults(design))


def spatial_faults(drive: Drive) -> Iterator[Fault]:
    """A cam in space agrees with the unit and the advance of its motion."""
    if isinstance(drive.cam, SpatialCam) and drive.motion is not None:
        yield from motion_faults(drive.cam, drive.motion.unit, drive.motion.advance)


def _servo_faults(drive: Drive, servo: Servo) -> Iterator[Fault]:
    """A servo needs a motion; motor, gear and moved mass or inertia agree with its unit."""
    if drive.motion is None:
        yield Fault(
            "servo", "[servo]", "a crank turns at constant speed: the drive has no motion", "a design with [motion]"
        )
        return
    slides, linear, travel = drive.motion.unit == "mm", servo.kind == LINEAR, servo.travel_mm_per_turn
    if linear and not slides:
        yield Fault("servo.kind", servo.kind, "a linear motor makes no motion in degrees", ROTARY)
    if slides and not linear and travel is None:
        yield Fault(
            "servo.travel_mm_per_turn", MISSING, "a rotary motor needs the travel of the slide per turn", "> 0 mm"
        )
    if travel is not None and (linear or not slides):
        yield Fault("servo.travel_mm_per_turn", travel, "there is no shaft that moves a slide", "leave it out")
    shaft = ("inertia_kg_m2", "friction_nm")
    allowed = ("mass_kg", "friction_n") if linear else (*shaft, "mass_kg", "friction_n") if slides else shaft
    for name in (*shaft, "mass_kg", "friction_n"):
        if name not in allowed and getattr(servo, name) is not None:
            yield Fault(
                f"servo.{name}", getattr(servo, name), "the part that this motor moves has none", " | ".join(allowed)
            )
    for name, default in (("rotor_inertia_kg_m2", 0.0), ("gear_ratio", 1.0)):
        if linear and getattr(servo, name) != default:
            yield Fault(f"servo.{name}", getattr(servo, name), "a linear motor has none", "leave it out")


def _face_agrees(design: Design) -> Iterator[Fault]:
    """Follower, cam and loads belong to the face; a roller has no sliding friction."""
    drive = design.drive
    if drive.is_alone or any(part is None for part in (drive.mechanism, drive.cam, drive.loads)):  # unreadable tables
        return
    if not drive.is_linkage:
        kinds = FOLLOWER_KINDS[drive.kind].under(drive.follower.face.face)
        if kinds != (type(drive.follower), type(drive.cam), type(drive.loads)):
            yield Fault(
                drive.face_path,
                drive.follower.face.face,
                "needs other entries of follower, cam or loads",
                "another face",
            )
            return
    contact = drive.loads.contact
    if contact is not None and contact.contact_friction > 0.0 and not drive.face.slides:
        problem = "a roller rolls on the cam"
        yield Fault(
            "loads.contact_friction", contact.contact_friction, problem, "for a flat face, a knife edge or a shoe"
        )


def _form_agrees(design: Design) -> Iterator[Fault]:
    """A groove or a conjugate pair needs a roller; only a conjugate pair has a second one."""
    drive = design.drive
    if drive.mechanism is None or not drive.has_disk:
        return
    form = drive.cam.form
    if form.holds and drive.face.face != Roller.face:
        yield Fault(
            f"cam.{FORM}", form.form, f"needs a roller, not a {drive.face.noun}", f"{Open.form}, or another face"
        )
    if drive.is_linkage:
        return
    kind: Any = type(drive.follower)
    second = getattr(drive.follower, "second", None)
    if isinstance(form, Conjugate) and second is None:
        classes = [slot.placing.kind for slot in slots(kind) if slot.key == "second"]
        keys = ", ".join(slot.key for class_ in classes for slot in slots(class_))
        yield Fault(
            "follower.second", MISSING, "missing", f"the position of the second roller of the conjugate pair: {keys}"
        )
    elif second is not None and not isinstance(form, Conjugate):
        problem = f"a cam of the form {form.form} has no second roller"
        yield Fault("follower.second", "[follower.second]", problem, f'cam.{FORM} = "{Conjugate.form}", or remove it')


def _speeds_agree(design: Design) -> Iterator[Fault]:
    """The shaft of a linkage has the speed of its driver."""
    if not design.drive.is_linkage or design.shaft is None:
        return
    driver, shaft = design.drive.linkage.driver.speed_rpm, design.shaft.signed_rpm
    if abs(driver - shaft) > CLOSING * abs(shaft):
        yield Fault(
            "linkage.driver.speed_rpm",
            driver,
            "differs from the shaft's speed, clockwise negative",
            f"{shaft:.12g} rpm, or leave it out",
        )


def incomplete_faults(motion: Motion, path: str) -> list[Fault]:
    """Faults of an incomplete motion: the spans make no turn, the rises do not add up, or a law does not fit its rise.

    Each is remedied by another value in the motion.
    """
    result = [*_spans_make_a_turn(motion, path), *_rises_return_to_start(motion, path)] if motion.segments else []
    for i, segment in enumerate(motion.segments):
        result.extend(_law_fits_rise(segment, f"{path}.segments[{i}]", motion.unit))
    return result
