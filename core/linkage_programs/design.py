"""Design from a sketch of another program: bodies and lines in the drawn pose, driver, second drivers and loads."""

from __future__ import annotations

import cmath
import math
import re
from collections import Counter, defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from core.bounds import PROGRAM_BYTES
from core.design import (
    CRANK,
    FRAME_LINK,
    MOTION,
    NO_DRIVER,
    Design,
    Drawn,
    Drive,
    Driver,
    Link,
    Linkage,
    LinkageLoads,
    LinkForce,
    LinkMass,
    LinkPoint,
    Motion,
    NamedCurve,
    SecondDriver,
    Segment,
    Slider,
    all_paths,
    faults,
    with_drive,
)
from core.design.fields import LONGEST_MM
from core.design.rules import count_fault
from core.errors import DesignError, Fault, NoSolution
from core.frozen import frozen
from core.linkage_programs import readers
from core.linkage_programs.readers import (
    GROUND,
    PIN,
    PIXEL,
    SLIDE,
    LeftOut,
    Sketch,
    SketchInput,
    SketchJoint,
    SketchMass,
    Swing,
    WheelPair,
    distinct,
    import_error,
)
from core.mechanism.drivers import first_motion
from core.project import dumps, loads_drawing

# -- drawn links ------------------------------------------------------------------------------------------------


SAME = 1e-9  # [mm] largest distance of joints at one position
_MARK = 10.0  # [mm] distance of a marking point along a line


class DrawnLinks:
    """Links by their numbers, with their drawn points [mm], and the lines on which links slide."""

    def __init__(self, joints: Sequence[SketchJoint], names: dict[str, str]) -> None:
        self._names = names
        self.left_out: list[LeftOut] = []
        links = dict.fromkeys(link for joint in joints for link in joint.links if link != GROUND)
        self.numbers = {GROUND: FRAME_LINK} | {link: n for n, link in enumerate(links, FRAME_LINK + 1)}
        self._points: dict[int, dict[str, complex]] = {n: {} for n in self.numbers.values()}
        # sliding link -> link of the line, the line's point nearest to the joint, its direction, the joint
        self._lines: dict[int, tuple[int, complex, complex, complex]] = {}
        self.blocks: dict[str, int] = {}
        for joint in joints:
            self._add(joint)
        used = {name for points in self._points.values() for name in points}
        for link, (on, at, along, _) in self._lines.items():
            self._mark(link, on, at, along, used)

    def _mark(self, link: int, on: int, at: complex, along: complex, used: set[str]) -> None:
        """Add a point on a line whose link has only one, so that the pose determines its branch."""
        points = self._points[on]
        if on == FRAME_LINK or len(points) > 1:
            return
        away = max((abs(at - z) for z in points.values()), default=0.0)
        name = next(candidate for n in range(1000) if (candidate := f"line{link}{'_' * bool(n)}{n or ''}") not in used)
        points[name] = at if away > SAME else at + along * _MARK
        used.add(name)

    def _add(self, joint: SketchJoint) -> None:
        name, numbers = self._names[joint.name], [self.numbers[link] for link in joint.links]
        along = cmath.exp(1j * math.radians(joint.angle_deg))
        if joint.kind == PIN or len(numbers) < 2:
            for n in numbers:
                self._points[n][name] = joint.at
            return
        on, *sliding = numbers
        if joint.kind == SLIDE:
            for n in sliding:
                self._slide(n, on, joint, along)
            self.blocks[joint.name] = sliding[0]
            return
        block = max(self._points) + 1
        self._points[block] = {name: joint.at}
        self._lines[block] = (on, *_line(joint, along))
        self.blocks[joint.name] = block
        for n in sliding:
            self._points[n][name] = joint.at

    def _slide(self, link: int, on: int, joint: SketchJoint, along: complex) -> None:
        """Let ``link`` slide on ``on``, or in reverse where it slides already."""
        if link in self._lines and on != FRAME_LINK and on not in self._lines:
            link, on = on, link
        if link in self._lines or link == FRAME_LINK:
            if on == FRAME_LINK or on in self._lines:
                self.left_out.append(LeftOut(f"joint {joint.name}", "a link slides on one line only"))
                return
            link, on = on, link
        self._lines[link] = (on, *_line(joint, along))

    def pair(self, joint: SketchJoint) -> tuple[int, int]:
        """The link that an input at a joint of two links drives, and its reference: the frame, or the first of them."""
        if joint.kind != PIN:
            return self.blocks[joint.name], self.numbers[joint.links[0]]
        on, link = sorted((self.numbers[link] for link in joint.links), key=lambda number: number != FRAME_LINK)
        return link, on

    def angle_of(self, link: int, on: int = FRAME_LINK) -> float:
        """Drawn angle of a link's frame relative to that of another link [deg]."""
        return math.degrees(cmath.phase(self.frame_of(link)[1] / self.frame_of(on)[1]))

    def frame_of(self, link: int) -> tuple[complex, complex]:
        """Origin and x axis of a link's frame: at its first point towards its second, or on its sliding line."""
        if link == FRAME_LINK:
            return 0j, 1.0 + 0j
        if link in self._lines:
            _, _, along, at = self._lines[link]
            return at, along
        first, *others = self._points[link].values() or [0j]
        axis = next((z - first for z in others if z != first), 1.0 + 0j)
        return first, axis / abs(axis)

    def number_of(self, link: str, label: str) -> int | None:
        """Number of a moving link; None, and listed, for a load on no moving link."""
        number = self.numbers.get(link, FRAME_LINK)
        if number == FRAME_LINK:
            self.left_out.append(LeftOut(label, "it acts on no moving link"))
            return None
        return number

    def point_at(self, link: int, at: complex, name: str) -> str:
        """Name of a link's point at a drawn position [mm]; it is added where there is none."""
        points = self._points[link]
        result = next((n for n, z in points.items() if abs(z - at) <= SAME), "")
        if not result:
            used = {n for names in self._points.values() for n in names}
            plain = re.sub(r"\W", "_", name)[:20]
            base = plain if plain.isidentifier() else f"F{plain}"
            result = next(n for n in (base, *(f"{base}_{i}" for i in range(2, len(used) + 3))) if n not in used)
            points[result] = at
        return result

    def linkage(self, driver: Driver = NO_DRIVER, deg: float | None = None, mm: float | None = None) -> Linkage:
        """Linkage with all links and sliders in the drawn pose, with the driver at ``deg`` or ``mm``."""
        links, sliders = [], []
        for number, points in sorted(self._points.items()):
            origin, axis = self.frame_of(number)
            local = {name: (z - origin) * axis.conjugate() for name, z in points.items()}
            links.append(Link(number, tuple(LinkPoint(n, z.real + 0.0, z.imag + 0.0) for n, z in local.items())))
        for number, (on, at, along, _) in self._lines.items():
            origin, axis = self.frame_of(on)
            through, line = (at - origin) * axis.conjugate(), along * axis.conjugate()
            sliders.append(
                Slider(
                    link=number,
                    on=on,
                    through_x_mm=through.real + 0.0,
                    through_y_mm=through.imag + 0.0,
                    angle_deg=math.degrees(cmath.phase(line)),
                )
            )
        fixed = self._points[FRAME_LINK]
        drawn = {name: z for n, points in self._points.items() if n != FRAME_LINK for name, z in points.items()}
        places = tuple(LinkPoint(name, z.real, z.imag) for name, z in drawn.items() if name not in fixed)
        return Linkage(tuple(links), tuple(sliders), driver, (), Drawn(deg, mm, places))


def _line(joint: SketchJoint, along: complex) -> tuple[complex, complex, complex]:
    """Point of a joint's line nearest to the joint, the line's direction, and the joint."""
    through = joint.at if joint.through is None else joint.through
    return through + along * ((joint.at - through) / along).real, along, joint.at


# -- driver and second drivers ----------------------------------------------------------------------------------


_SPEED = 60.0  # [rpm] of an unknown speed
_AGREE = 1e-9  # tolerance of the ratios that two trains of wheels give the same link
_SHORT = 1e-8  # of a stroke: a shorter part is omitted
_REST = Motion(0.0, (Segment(360.0, 0.0),), "mm")


def is_drivable(joint: SketchJoint) -> bool:
    """Whether an input can be at a joint: a pin of two links, or a slide."""
    return len(joint.links) == 2 if joint.kind == PIN else len(joint.links) > 1


def leading_input(inputs: Iterable[SketchInput], joints: Sequence[SketchJoint]) -> SketchInput | None:
    """First input that can drive: rotating before reciprocating, joints before links whose length changes."""
    drivable = {joint.name for joint in joints if is_drivable(joint)}
    ends = Counter(link for joint in joints for link in joint.links if link != GROUND)
    order = sorted(inputs, key=lambda source: (source.length, source.swing is not None))
    return next(
        (source for source in order if (ends[source.name] == 2 if source.length else source.name in drivable)), None
    )


def with_rod(joints: Sequence[SketchJoint], cylinder: SketchInput) -> list[SketchJoint]:
    """The joints with a link of changing length as a tube and a rod that slides in it."""
    tube, rod = cylinder.name, f"{cylinder.name} rod"
    first, second = (joint for joint in joints if tube in joint.links)
    end = replace(second, links=tuple(rod if link == tube else link for link in second.links))
    angle = math.degrees(cmath.phase(second.at - first.at))
    slide = SketchJoint(cylinder.joint, second.at, (tube, rod), SLIDE, angle)
    return [*(end if joint is second else joint for joint in joints), slide]


def drive(
    sheet: DrawnLinks, lead: SketchInput, joint: SketchJoint, factor: float, mirror: bool
) -> tuple[Linkage, Motion | None, list[LeftOut]]:
    """Linkage driven at a joint from its drawn position, its motion, and the assumptions; ``factor`` converts to mm."""
    link, on = sheet.pair(joint)
    is_pin, swing = joint.kind == PIN, lead.swing
    sign = -1.0 if mirror and is_pin else 1.0
    assumptions = [
        LeftOut(f"input at {lead.label}", "operated by hand in the file: driven at the speed in it")
    ] * lead.manual
    drawn = {"deg": sheet.angle_of(link, on)} if is_pin else {"mm": 0.0}
    if swing is not None:
        motion = (
            _reciprocating_motion(swing, drawn["deg"], sign, "deg")
            if is_pin
            else _reciprocating_motion(swing, 0.0, factor, "mm")
        )
        why = "constant speed in both directions, as in the file: its velocity jumps at both ends"
        assumptions.append(LeftOut(f"law of {lead.label}", why))
        return sheet.linkage(Driver(link, MOTION, swing.cycles, on), **drawn), motion, assumptions
    speed = (lead.rpm or _SPEED) * sign
    if lead.rpm == 0.0:
        assumptions.append(LeftOut(f"speed of {lead.label}", f"it is 0: {_SPEED:g} rpm"))
    if is_pin:
        if on != FRAME_LINK:
            assumptions.append(
                LeftOut(f"direction of {lead.label}", f"not in the text: link {link} turns relative to link {on}")
            )
        return sheet.linkage(Driver(link, CRANK, speed, on), **drawn), None, assumptions
    return sheet.linkage(Driver(link, MOTION, abs(speed), on), **drawn), _REST, assumptions


def with_assumed_motion(design: Design, label: str) -> tuple[Design, LeftOut]:
    """The design with an assumed motion of its driving slide: dwell, rise, dwell, return within the linkage's range.

    At rest where the linkage is not a mechanism yet.
    """
    item = f"motion of {label}"
    try:
        motion = None if faults(design) else first_motion(design.drive.linkage, 0.0)
    except NoSolution:
        motion = None
    if motion is None:
        return design, LeftOut(item, "its law is not known: it rests")
    design = with_drive(design, motion=motion)
    paths = tuple(path for path in all_paths(design) if path.startswith("motion.") and "advance" not in path)
    why = "its law is not known: a dwell, a rise, a dwell and a return are assumed"
    return replace(design, assumed=paths), LeftOut(item, why)


def _reciprocating_motion(swing: Swing, begin: float, factor: float, unit: str) -> Motion:
    """Motion in both directions at constant speed, one cycle per turn, from the initial position of the swing."""
    share = math.fmod(abs(swing.start), 2.0 * swing.stroke) / swing.stroke
    if abs(share - round(share)) < _SHORT:
        share = float(round(share))
    parts = (1.0 - share, -1.0, share) if share <= 1.0 else (share - 2.0, 1.0, 1.0 - share)
    law, stroke = NamedCurve("constant-velocity"), swing.sign * factor * swing.stroke
    return Motion(begin, tuple(Segment(180.0 * abs(part), stroke * part, law) for part in parts if part), unit)


def second_drivers(
    sheet: DrawnLinks,
    lead: SketchInput | None,
    inputs: Iterable[SketchInput],
    joints: Iterable[SketchJoint],
    wheels: Sequence[WheelPair],
) -> tuple[tuple[SecondDriver, ...], list[LeftOut]]:
    """Further inputs and wheels as second drivers of one that rotates on the frame, and the omitted inputs."""
    omitted: list[LeftOut] = []
    joint_by_name = {joint.name: joint for joint in joints}
    link, on = (0, 0) if lead is None else sheet.pair(joint_by_name[lead.joint])
    is_crank = lead is not None and joint_by_name[lead.joint].kind == PIN and on == FRAME_LINK
    rates = {FRAME_LINK: 0.0} | ({link: 1.0} if is_crank else {})  # turns of a link for one of the driver's
    rows: dict[int, SecondDriver] = {}

    def add(number: int, against: int, ratio: float) -> None:
        offset = sheet.angle_of(number, against) - ratio * sheet.angle_of(link)
        offset = math.remainder(offset, 360.0) if math.isfinite(offset) else offset
        rows[number] = SecondDriver(link=number, on=against, ratio=ratio, offset_deg=offset)
        if against in rates:
            rates[number] = rates[against] + ratio

    for source in inputs:
        joint = joint_by_name.get(source.name)
        if source.length:
            omitted.append(LeftOut(source.label, "another input drives: it is a bar of its drawn length"))
        elif joint is None or not is_drivable(joint):
            omitted.append(LeftOut(f"input at {source.label}", "it is no pin or slide of two links"))
        elif lead is None or not is_crank:
            why = "a second input requires a first one that rotates on the frame"
            omitted.append(LeftOut(f"input at {source.label}", why))
        elif sheet.pair(joint)[0] == link or sheet.pair(joint)[0] in rows:
            omitted.append(LeftOut(f"input at {source.label}", "its link is driven already"))
        elif joint.kind != PIN:
            omitted.append(LeftOut(f"motion of {source.label}", "its law is not known: it rests"))
            rows[sheet.pair(joint)[0]] = SecondDriver(link=sheet.pair(joint)[0], on=sheet.pair(joint)[1], ratio=0.0)
        else:
            ratio, unknown = _ratio(lead, source)
            omitted += unknown
            add(*sheet.pair(joint), ratio)
    trains = [
        (sheet.numbers[train.first], sheet.numbers[train.second], sheet.numbers[train.carrier], train.ratio)
        for train in wheels
    ]
    while is_crank and (
        step := next((t for t in trains if t[2] in rates and (t[0] in rates) != (t[1] in rates)), None)
    ):
        first, second, carrier, ratio = step
        if first in rates:
            add(second, carrier, ratio * (rates[first] - rates[carrier]))
        else:
            add(first, carrier, (rates[second] - rates[carrier]) / ratio)
    for train, (first, second, carrier, ratio) in zip(wheels, trains, strict=True):
        known = {first, second, carrier} <= rates.keys()
        if not known or abs(rates[second] - rates[carrier] - ratio * (rates[first] - rates[carrier])) > _AGREE:
            why = (
                "another train of wheels gives a different ratio"
                if known
                else "no crank on the frame turns one of them"
            )
            omitted.append(LeftOut(f"wheels of {train.first} and {train.second}", why))
    return tuple(rows.values()), omitted


def _ratio(lead: SketchInput, second: SketchInput) -> tuple[float, list[LeftOut]]:
    """Ratio of a second input to the first, and the assumptions."""
    first_swing, second_swing = lead.swing, second.swing
    if first_swing is None and second_swing is None:
        if lead.rpm and second.rpm:
            return second.rpm / lead.rpm, []
        return 1.0, [LeftOut(f"speed of {second.label}", "it is not known: it turns as the first input")]
    if (
        first_swing
        and second_swing
        and first_swing.cycles == second_swing.cycles
        and first_swing.start * second_swing.stroke == second_swing.start * first_swing.stroke
    ):
        return second_swing.sign * second_swing.stroke / (first_swing.sign * first_swing.stroke), []
    return 0.0, [LeftOut(f"motion of {second.label}", f"its cycle differs from that of {lead.label}: it is at rest")]


# -- design from a sketch ---------------------------------------------------------------------------------------


UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
_SIZES = UNITS | {PIXEL: 25.4 / 96.0}


@frozen
class LinkageImport:
    """Result of an import.

    Attributes
    ----------
    design : the linkage
    joints : number of joints in the text
    left_out : items that were not imported or are assumed
    inputs : names of the driven joints
    could_drive : names of the joints that can be driven
    """

    design: Design
    joints: int
    left_out: tuple[LeftOut, ...]
    inputs: tuple[str, ...] = ()
    could_drive: tuple[str, ...] = ()

    @property
    def links(self) -> int:
        """Number of links, with the frame and the blocks of sliding pins."""
        return len(self.design.drive.linkage.links)


def import_sketch(
    sketch: Sketch, name: str, unit: str = "", mirror: bool = False, inputs: Sequence[str] = ()
) -> LinkageImport:
    """Design of a sketch.

    Raises DesignError where it has no moving link, too many items, a value out of range, or where an input is no joint.
    """
    omitted = list(sketch.left_out)
    if not (unit or sketch.unit):
        omitted.append(LeftOut("unit of length", "the text has none: mm is assumed, --units gives another"))
    links = {link for joint in sketch.joints for link in joint.links}
    counted = {"linkage.links": links, "linkage.joints": sketch.joints, "loads.forces": sketch.forces}
    for key, rows in counted.items():
        if over := count_fault(key, len(rows)):
            raise DesignError([over])
    factor = _SIZES[unit or sketch.unit or "mm"]
    joints, alias = _merge_coincident_pins(_joints(sketch, factor, mirror))
    names = _names(joints)
    merged = _rigid_links(joints, sketch.welded)
    if set(merged.values()) <= {GROUND}:
        raise import_error("text", "no mechanism: no link in it moves", "joints, and links between them")
    joints = [replace(joint, links=tuple(dict.fromkeys(merged[link] for link in joint.links))) for joint in joints]
    if unknown := [item for item in inputs if item not in alias]:
        raise import_error("input", f"{', '.join(unknown)}: no joint of this name", " | ".join(names))
    of_text = {item.name: item for item in sketch.inputs if not item.length}
    chosen = [of_text.get(item, SketchInput(name=item)) for item in inputs] or list(sketch.inputs)
    chosen = [replace(item, name=(merged if item.length else alias).get(item.name, item.name)) for item in chosen]
    on_frame = [joint for joint in joints if GROUND in joint.links and is_drivable(joint)]
    lead = leading_input(chosen or [SketchInput(name=joint.name) for joint in on_frame], joints)
    further_inputs = [item for item in chosen if item != lead]
    further_inputs += [item for item in sketch.inputs if item.length and inputs]
    if lead is not None and lead.length:
        joints = with_rod(joints, lead)
        names |= {lead.joint: lead.joint}
    drawn = DrawnLinks(joints, names)
    loads = _loads(drawn, sketch, merged, factor, mirror)
    linkage, motion = drawn.linkage(), None
    if lead is not None:
        joint = next(joint for joint in joints if joint.name == lead.joint)
        linkage, motion, more = drive(drawn, lead, joint, factor, mirror)
        omitted += more
        if not chosen:
            speed = f", at {linkage.driver.speed_rpm:g} rpm" if linkage.driver.kind == CRANK else ""
            omitted.append(
                LeftOut("input", f"not in the text: {names[lead.joint]}, on the frame, is driven instead{speed}")
            )
    else:
        omitted.append(LeftOut("driver", "no input is known, and no pin holds a single link on the frame"))
    wheels = [item.on(merged) for item in sketch.wheels if {item.first, item.second, item.carrier} <= merged.keys()]
    second, more = second_drivers(drawn, lead, further_inputs, joints, wheels)
    omitted += [*drawn.left_out, *more]
    linkage = replace(linkage, drivers=second)
    design = Design(name, None, (Drive(motion, linkage, None, loads),))
    _require_readable(design, {point: joint for joint, point in names.items()}, lead)
    if lead is not None and lead.swing is None and motion is not None:
        design, assumed = with_assumed_motion(design, lead.label)
        omitted.append(assumed)
    driven = {linkage.driver.link, *(item.link for item in second)}
    offered = {joint.name for joint in on_frame} | {item.name for item in chosen}
    drivable_joints = [joint for joint in joints if is_drivable(joint) and joint.name in offered]
    driven_joints = tuple(
        joint.name for joint in drivable_joints if drawn.pair(joint)[0] in driven and not (lead and lead.length)
    )
    return LinkageImport(
        design, len(sketch.joints), tuple(omitted), driven_joints, tuple(joint.name for joint in drivable_joints)
    )


def _require_readable(design: Design, joint_of: Mapping[str, str], lead: SketchInput | None) -> None:
    """Raise DesignError where ``check`` refuses the design; joint_of: name of a point -> joint, for the message."""
    try:
        loads_drawing(dumps(design))
    except DesignError as error:
        raise DesignError(
            replace(fault, path=_with_joint(design, fault, joint_of, lead)) for fault in error.faults
        ) from None


def _with_joint(design: Design, fault: Fault, joint_of: Mapping[str, str], lead: SketchInput | None) -> str:
    """Path of a fault with the joint, or the joints of the link, to which it belongs."""
    linkage = design.drive.linkage
    words = re.split(r"[.\[\]]+", fault.path)
    joint = next((f"joint {joint_of[word]}" for word in words if word in joint_of), "")
    table = words[1] if len(words) > 1 else ""
    rows = getattr(linkage, table, None) or getattr(design.drive.loads, table, None)
    if lead is not None and (words[0] == "motion" or table == "driver"):
        joint = lead.label if lead.length else f"joint {lead.label}"
    elif not joint and isinstance(rows, tuple) and len(words) > 2 and words[2].isdecimal():
        link = getattr(rows[int(words[2])], "link", getattr(rows[int(words[2])], "number", FRAME_LINK))
        joint = f"joints {', '.join(joint_of.get(name, name) for name in linkage.by_number[link].places)}"
    return f"{joint}: {fault.path}" if joint else fault.path


def _joints(sketch: Sketch, factor: float, mirror: bool) -> list[SketchJoint]:
    """Joints in mm. Raises DesignError where one is too far away."""

    def to_mm(z: complex) -> complex:
        return (z.conjugate() if mirror else z) * factor

    faults = [
        Fault(f"joint {joint.name}: {axis}", value, "too far away", f"-{LONGEST_MM:g} ... {LONGEST_MM:g} mm")
        for joint in sketch.joints
        for axis, value in (("x", joint.at.real * factor), ("y", joint.at.imag * factor))
        if not abs(value) <= LONGEST_MM
    ]
    if faults:
        raise DesignError(faults)
    sign = -1.0 if mirror else 1.0
    return [
        replace(
            j, at=to_mm(j.at), angle_deg=sign * j.angle_deg, through=None if j.through is None else to_mm(j.through)
        )
        for j in sketch.joints
    ]


def _merge_coincident_pins(joints: Iterable[SketchJoint]) -> tuple[list[SketchJoint], dict[str, str]]:
    """Joints with coincident pins of a link merged, and name of each joint -> name of its merged joint."""
    at: defaultdict[complex, list[SketchJoint]] = defaultdict(list)
    alias: dict[str, str] = {}
    result: dict[str, SketchJoint] = {}
    for joint in joints:
        same = [pin for pin in at[joint.at] if not set(pin.links).isdisjoint(joint.links)] if joint.kind == PIN else []
        first = next(iter(same), joint)
        links = (link for pin in (*same, joint) for link in pin.links)
        merged = replace(first, links=tuple(dict.fromkeys(links)))
        for pin in same[1:]:
            del result[pin.name]
        result[merged.name] = merged
        alias |= dict.fromkeys([joint.name, *(pin.name for pin in same[1:])], merged.name)
        if joint.kind == PIN:
            at[joint.at] = [*(pin for pin in at[joint.at] if pin not in same), merged]
    return list(result.values()), {name: _last(alias, name) for name in alias}


def _last(alias: Mapping[str, str], name: str) -> str:
    while alias[name] != name:
        name = alias[name]
    return name


def _names(joints: Iterable[SketchJoint]) -> dict[str, str]:
    """Name of each joint -> valid name: letters, digits and _, a letter first, no duplicates."""
    names = [joint.name for joint in joints]
    plain = (re.sub(r"\W", "_", name)[:30] for name in names)
    return dict(zip(names, distinct(text if text.isidentifier() else f"J{text}" for text in plain), strict=True))


def _rigid_links(joints: Sequence[SketchJoint], welded: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Link -> representative of its rigid group: welded links, and links that two pins join."""
    root: dict[str, str] = {}

    def find(link: str) -> str:
        while root.get(link, link) != link:
            link = root[link]
        return link

    def join(first: str, second: str) -> bool:
        a, b = sorted((find(first), find(second)), key=lambda root: root != GROUND)
        root[b] = a
        return a != b

    for first, second in welded:
        join(first, second)
    changed = True
    while changed:
        changed = False
        shared: dict[tuple[str, str], complex] = {}
        for joint in joints:
            roots = sorted({find(link) for link in joint.links}) if joint.kind == PIN else []
            for i, first in enumerate(roots):
                for second in roots[i + 1 :]:
                    before = shared.setdefault((first, second), joint.at)
                    if before != joint.at:
                        changed |= join(first, second)
    return {link: find(link) for joint in joints for link in joint.links}


def _loads(drawn: DrawnLinks, sketch: Sketch, merged: dict[str, str], factor: float, mirror: bool) -> LinkageLoads:
    """Masses in the frames of their links, combined for rigid groups, and forces at points of their links."""

    def to_mm(z: complex) -> complex:
        return (z.conjugate() if mirror else z) * factor

    forces = []
    for force in sketch.forces:
        if (number := drawn.number_of(merged.get(force.link, ""), f"force {force.name}")) is not None:
            newton = force.newton.conjugate() if mirror else force.newton
            point = drawn.point_at(number, to_mm(force.at), force.name)
            forces.append(LinkForce(link=number, point=point, x_n=newton.real + 0.0, y_n=newton.imag + 0.0))
    masses_by_link: dict[int, list[SketchMass]] = {}
    for mass in sketch.masses:
        if (number := drawn.number_of(merged.get(mass.link, ""), f"mass of {mass.link}")) is not None:
            masses_by_link.setdefault(number, []).append(mass)
    masses = []
    for number, parts in sorted(masses_by_link.items()):
        total = sum(part.mass_kg for part in parts)
        centre = sum(part.mass_kg * to_mm(part.at) for part in parts) / total if total else to_mm(parts[0].at)
        inertia = sum(p.inertia_kg_m2 + p.mass_kg * abs(to_mm(p.at) - centre) ** 2 * 1e-6 for p in parts)
        origin, axis = drawn.frame_of(number)
        local = (centre - origin) * axis.conjugate()
        masses.append(
            LinkMass(
                link=number,
                mass_kg=total,
                inertia_kg_m2=inertia,
                centre_x_mm=local.real + 0.0,
                centre_y_mm=local.imag + 0.0,
            )
        )
    loads = LinkageLoads(masses=tuple(masses), forces=tuple(forces))
    return loads if sketch.gravity else replace(loads, gravity_m_s2=0.0)


# -- formats, recognised by the beginning of the text -----------------------------------------------------------


@frozen
class TextFormat:
    """A program's text format: title, test of the beginning, and reader."""

    title: str
    begins: Callable[[str], bool]
    read: Callable[[str], Sketch]


FORMATS: Mapping[str, TextFormat] = MappingProxyType(
    {
        "pyslvs": TextFormat("Pyslvs expression", lambda text: text.startswith(("M[", "#")), readers.read_pyslvs),
        "linkage2": TextFormat("Linkage file", lambda text: text.startswith("<"), readers.read_linkage2),
        "pmks": TextFormat("PMKS+ address", lambda text: bool(text), readers.read_pmks),
    }
)


def decoded(data: bytes) -> str:
    """Text of a file in UTF-8, or in the Windows encoding in which Linkage writes names."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def read_linkage(
    text: str, format: str = "", *, name: str = "", units: str = "", mirror: bool = False, inputs: Sequence[str] = ()
) -> LinkageImport:
    """Design of a text.

    units: of its lengths, where the text states none; inputs: names of the driven joints. Raises DesignError.
    """
    if len(text.encode(errors="replace")) > PROGRAM_BYTES:
        raise import_error("text", "too long", f"at most {PROGRAM_BYTES / 1e6:g} MB")
    text = text.strip().removeprefix("\ufeff")
    row = FORMATS[format] if format else next((r for r in FORMATS.values() if r.begins(text)), None)
    if row is None:
        raise import_error("text", "nothing to read", " | ".join(FORMATS))
    return import_sketch(row.read(text), name or row.title, units, mirror, inputs)
