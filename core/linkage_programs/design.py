"""The sheet on which links are drawn: their points, frames of their own, blocks of sliding pins, and lines on which links slide."""

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
    Wheels,
    distinct,
    refused,
)
from core.mechanism.drivers import first_motion
from core.project import dumps, loads_drawing

# -- the sheet on which links are drawn -------------------------------------------------------------------------


SAME = 1e-9  # mm: joints this near are at one place
_MARK = 10.0  # mm: so far along a line it is marked


class Sheet:
    """Links by their numbers, each with its points on the sheet [mm], and the lines on which links slide."""

    def __init__(self, joints: Sequence[SketchJoint], names: dict[str, str]) -> None:
        self._names = names
        self.left_out: list[LeftOut] = []
        links = dict.fromkeys(link for joint in joints for link in joint.links if link != GROUND)
        self.numbers = {GROUND: FRAME_LINK} | {link: n for n, link in enumerate(links, FRAME_LINK + 1)}
        self._points: dict[int, dict[str, complex]] = {n: {} for n in self.numbers.values()}
        self._lines: dict[
            int, tuple[int, complex, complex, complex]
        ] = {}  # sliding link -> on, the point of the line nearest to its joint, direction of the line, the joint
        self.blocks: dict[str, int] = {}
        for joint in joints:
            self._add(joint)
        taken = {name for points in self._points.values() for name in points}
        for link, (on, at, along, _) in self._lines.items():
            self._mark(link, on, at, along, taken)

    def _mark(self, link: int, on: int, at: complex, along: complex, taken: set[str]) -> None:
        """A point on a line whose link has but one, so that the two ways to turn it can be told apart as drawn."""
        points = self._points[on]
        if on == FRAME_LINK or len(points) > 1:
            return
        away = max((abs(at - z) for z in points.values()), default=0.0)
        name = next(each for n in range(1000) if (each := f"line{link}{'_' * bool(n)}{n or ''}") not in taken)
        points[name] = at if away > SAME else at + along * _MARK
        taken.add(name)

    def _add(self, joint: SketchJoint) -> None:
        name, numbers = self._names[joint.name], [self.numbers[link] for link in joint.links]
        along = cmath.exp(1j * math.radians(joint.angle_deg))
        if joint.kind == PIN or len(numbers) < 2:
            for n in numbers:
                self._points[n][name] = joint.at
            return
        on, *others = numbers
        if joint.kind == SLIDE:
            for n in others:
                self._slide(n, on, joint, along)
            self.blocks[joint.name] = others[0]
            return
        block = max(self._points) + 1
        self._points[block] = {name: joint.at}
        self._lines[block] = (on, *_line(joint, along))
        self.blocks[joint.name] = block
        for n in others:
            self._points[n][name] = joint.at

    def _slide(self, link: int, on: int, joint: SketchJoint, along: complex) -> None:
        """``link`` on ``on``, or the other way where it slides already."""
        if link in self._lines and on != FRAME_LINK and on not in self._lines:
            link, on = on, link
        if link in self._lines or link == FRAME_LINK:
            if on == FRAME_LINK or on in self._lines:
                self.left_out.append(LeftOut(f"joint {joint.name}", "a link slides on one line only"))
                return
            link, on = on, link
        self._lines[link] = (on, *_line(joint, along))

    def pair(self, joint: SketchJoint) -> tuple[int, int]:
        """The link that an input at a joint of two drives, and what it is driven against: the frame, else the first of them."""
        if joint.kind != PIN:
            return self.blocks[joint.name], self.numbers[joint.links[0]]
        on, link = sorted((self.numbers[link] for link in joint.links), key=lambda number: number != FRAME_LINK)
        return link, on

    def turned(self, link: int, on: int = FRAME_LINK) -> float:
        """Angle of a link's frame against that of another, as drawn [deg]."""
        return math.degrees(cmath.phase(self.frame_of(link)[1] / self.frame_of(on)[1]))

    def frame_of(self, link: int) -> tuple[complex, complex]:
        """Origin and x axis of a link's own frame on the sheet: at its first point towards its second; on the line that it slides on."""
        if link == FRAME_LINK:
            return 0j, 1.0 + 0j
        if link in self._lines:
            _, _, along, at = self._lines[link]
            return at, along
        first, *others = self._points[link].values() or [0j]
        axis = next((z - first for z in others if z != first), 1.0 + 0j)
        return first, axis / abs(axis)

    def number_of(self, link: str, what: str) -> int | None:
        """Number of a link that moves; None, and listed, where a load stands on no such link."""
        number = self.numbers.get(link, FRAME_LINK)
        if number == FRAME_LINK:
            self.left_out.append(LeftOut(what, "it stands on no link that moves"))
            return None
        return number

    def point_at(self, link: int, at: complex, name: str) -> str:
        """The point of a link at a place of the sheet [mm], made where there is none."""
        points = self._points[link]
        near = next((n for n, z in points.items() if abs(z - at) <= SAME), "")
        if not near:
            taken = {n for each in self._points.values() for n in each}
            plain = re.sub(r"\W", "_", name)[:20]
            base = plain if plain.isidentifier() else f"F{plain}"
            near = next(n for n in (base, *(f"{base}_{i}" for i in range(2, len(taken) + 3))) if n not in taken)
            points[near] = at
        return near

    def linkage(self, driver: Driver = NO_DRIVER, deg: float | None = None, mm: float | None = None) -> Linkage:
        """All links, sliders and the pose as it is on the sheet, with the driver at ``deg`` or ``mm``."""
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
    """The point nearest to a joint of its line, the line's direction, and the joint."""
    through = joint.at if joint.through is None else joint.through
    return through + along * ((joint.at - through) / along).real, along, joint.at


# -- what drives an imported linkage ----------------------------------------------------------------------------


_SPEED = 60.0  # rpm, where none is known
_AGREE = 1e-9  # of turns that two trains of wheels give the same link
_SHORT = 1e-8  # of a stroke: a part of it so short is none
_REST = Motion(0.0, (Segment(360.0, 0.0),), "mm")


def joins_two(joint: SketchJoint) -> bool:
    """Whether an input can be at a joint: a pin of two links, or a slide."""
    return len(joint.links) == 2 if joint.kind == PIN else len(joint.links) > 1


def leading(inputs: Iterable[SketchInput], joints: Sequence[SketchJoint]) -> SketchInput | None:
    """The first input that can drive: what turns on before what swings, joints before links whose length changes."""

    could = {joint.name for joint in joints if joins_two(joint)}
    ends = Counter(link for joint in joints for link in joint.links if link != GROUND)
    order = sorted(inputs, key=lambda each: (each.length, each.swing is not None))
    return next((each for each in order if (ends[each.name] == 2 if each.length else each.name in could)), None)


def with_rod(joints: Sequence[SketchJoint], cylinder: SketchInput) -> list[SketchJoint]:
    """The joints with a link whose length changes as a tube and a rod that slides in it."""
    tube, rod = cylinder.name, f"{cylinder.name} rod"
    one, two = (joint for joint in joints if tube in joint.links)
    end = replace(two, links=tuple(rod if link == tube else link for link in two.links))
    angle = math.degrees(cmath.phase(two.at - one.at))
    slide = SketchJoint(cylinder.joint, two.at, (tube, rod), SLIDE, angle)
    return [*(end if joint is two else joint for joint in joints), slide]


def drive(
    sheet: Sheet, lead: SketchInput, joint: SketchJoint, factor: float, mirror: bool
) -> tuple[Linkage, Motion | None, list[LeftOut]]:
    """The linkage driven at a joint from where it is drawn, the motion that it follows, and what is assumed; ``factor`` to mm."""
    link, on = sheet.pair(joint)
    turns, swing = joint.kind == PIN, lead.swing
    sign = -1.0 if mirror and turns else 1.0
    listed = [LeftOut(f"input at {lead.label}", "by hand only in the file: driven at the speed there")] * lead.manual
    drawn = {"deg": sheet.turned(link, on)} if turns else {"mm": 0.0}
    if swing is not None:
        motion = _to_and_fro(swing, drawn["deg"], sign, "deg") if turns else _to_and_fro(swing, 0.0, factor, "mm")
        why = "constant speed out and back, as in the file: its velocity jumps at both ends"
        listed.append(LeftOut(f"law of {lead.label}", why))
        return sheet.linkage(Driver(link, MOTION, swing.cycles, on), **drawn), motion, listed
    speed = (lead.rpm or _SPEED) * sign
    if lead.rpm == 0.0:
        listed.append(LeftOut(f"speed of {lead.label}", f"it is 0: {_SPEED:g} rpm"))
    if turns:
        if on != FRAME_LINK:
            listed.append(LeftOut(f"sense of {lead.label}", f"not in the text: link {link} turns against link {on}"))
        return sheet.linkage(Driver(link, CRANK, speed, on), **drawn), None, listed
    return sheet.linkage(Driver(link, MOTION, abs(speed), on), **drawn), _REST, listed


def with_assumed_motion(design: Design, label: str) -> tuple[Design, LeftOut]:
    """The design whose slide drives by a motion that the text does not say: dwell, rise, dwell, return as far as the linkage lets it,
    assumed; at rest where it is no mechanism yet."""
    what = f"motion of {label}"
    try:
        motion = None if faults(design) else first_motion(design.drive.linkage, 0.0)
    except NoSolution:
        motion = None
    if motion is None:
        return design, LeftOut(what, "its law is not known: it rests")
    design = with_drive(design, motion=motion)
    paths = tuple(path for path in all_paths(design) if path.startswith("motion.") and "advance" not in path)
    why = "its law is not known: a dwell, a rise, a dwell and a return are assumed"
    return replace(design, assumed=paths), LeftOut(what, why)


def _to_and_fro(swing: Swing, begin: float, factor: float, unit: str) -> Motion:
    """Out and back at constant speed, one cycle a turn, from where the swing is at first."""
    share = math.fmod(abs(swing.start), 2.0 * swing.stroke) / swing.stroke
    if abs(share - round(share)) < _SHORT:
        share = float(round(share))
    parts = (1.0 - share, -1.0, share) if share <= 1.0 else (share - 2.0, 1.0, 1.0 - share)
    law, stroke = NamedCurve("constant-velocity"), swing.sign * factor * swing.stroke
    return Motion(begin, tuple(Segment(180.0 * abs(part), stroke * part, law) for part in parts if part), unit)


def seconds(
    sheet: Sheet,
    lead: SketchInput | None,
    inputs: Iterable[SketchInput],
    joints: Iterable[SketchJoint],
    wheels: Sequence[Wheels],
) -> tuple[tuple[SecondDriver, ...], list[LeftOut]]:
    """Further inputs and wheels, as second drivers of one that turns on the frame; and what cannot go with the first input."""
    listed: list[LeftOut] = []
    of_joint = {joint.name: joint for joint in joints}
    link, on = (0, 0) if lead is None else sheet.pair(of_joint[lead.joint])
    turns = lead is not None and of_joint[lead.joint].kind == PIN and on == FRAME_LINK
    rates = {FRAME_LINK: 0.0} | ({link: 1.0} if turns else {})  # turns of a link for one of the driver's
    rows: dict[int, SecondDriver] = {}

    def add(number: int, against: int, ratio: float) -> None:
        offset = sheet.turned(number, against) - ratio * sheet.turned(link)
        offset = math.remainder(offset, 360.0) if math.isfinite(offset) else offset
        rows[number] = SecondDriver(link=number, on=against, ratio=ratio, offset_deg=offset)
        if against in rates:
            rates[number] = rates[against] + ratio

    for each in inputs:
        joint = of_joint.get(each.name)
        if each.length:
            listed.append(LeftOut(each.label, "something else drives: it is a bar of its drawn length"))
        elif joint is None or not joins_two(joint):
            listed.append(LeftOut(f"input at {each.label}", "it joins no two links, as a pin or a slide"))
        elif lead is None or not turns:
            why = "no second input goes with a slide, or one between moving links"
            listed.append(LeftOut(f"input at {each.label}", why))
        elif sheet.pair(joint)[0] == link or sheet.pair(joint)[0] in rows:
            listed.append(LeftOut(f"input at {each.label}", "its link is driven already"))
        elif joint.kind != PIN:
            listed.append(LeftOut(f"motion of {each.label}", "its law is not known: it rests"))
            rows[sheet.pair(joint)[0]] = SecondDriver(link=sheet.pair(joint)[0], on=sheet.pair(joint)[1], ratio=0.0)
        else:
            ratio, unknown = _ratio(lead, each)
            listed += unknown
            add(*sheet.pair(joint), ratio)
    trains = [
        (sheet.numbers[train.first], sheet.numbers[train.second], sheet.numbers[train.carrier], train.ratio)
        for train in wheels
    ]
    while turns and (step := next((t for t in trains if t[2] in rates and (t[0] in rates) != (t[1] in rates)), None)):
        first, second, carrier, ratio = step
        if first in rates:
            add(second, carrier, ratio * (rates[first] - rates[carrier]))
        else:
            add(first, carrier, (rates[second] - rates[carrier]) / ratio)
    for train, (first, second, carrier, ratio) in zip(wheels, trains, strict=True):
        known = {first, second, carrier} <= rates.keys()
        if not known or abs(rates[second] - rates[carrier] - ratio * (rates[first] - rates[carrier])) > _AGREE:
            why = "another train of wheels turns them otherwise" if known else "no crank on the frame turns one of them"
            listed.append(LeftOut(f"wheels of {train.first} and {train.second}", why))
    return tuple(rows.values()), listed


def _ratio(lead: SketchInput, second: SketchInput) -> tuple[float, list[LeftOut]]:
    """Turn of a second input for one of the first, and what is assumed."""
    one, two = lead.swing, second.swing
    if one is None and two is None:
        if lead.rpm and second.rpm:
            return second.rpm / lead.rpm, []
        return 1.0, [LeftOut(f"speed of {second.label}", "it is not known: it turns as the first input")]
    if one and two and one.cycles == two.cycles and one.start * two.stroke == two.start * one.stroke:
        return two.sign * two.stroke / (one.sign * one.stroke), []
    return 0.0, [LeftOut(f"motion of {second.label}", f"it does not keep step with {lead.label}: it stands still")]


# -- A design from the joints of another program ----------------------------------------------------------------


UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
_SIZES = UNITS | {PIXEL: 25.4 / 96.0}


@frozen
class Made:
    """The design; joints: how many there were; what was left out; inputs: names of the joints that are driven; could_drive: of all
    that could be."""

    design: Design
    joints: int
    left_out: tuple[LeftOut, ...]
    inputs: tuple[str, ...] = ()
    could_drive: tuple[str, ...] = ()

    @property
    def links(self) -> int:
        """How many there are, the frame and the blocks of sliding pins among them."""
        return len(self.design.drive.linkage.links)


def made(sketch: Sketch, name: str, unit: str = "", mirror: bool = False, inputs: Sequence[str] = ()) -> Made:
    """The design of a sketch. Raises DesignError where it has no link that moves, too much of it, a value outside its range, or an input
    is no joint of it."""
    left = list(sketch.left_out)
    if not (unit or sketch.unit):
        left.append(LeftOut("unit of length", "the text has none: read as mm, --units says another"))
    links = {link for joint in sketch.joints for link in joint.links}
    counted = {"linkage.links": links, "linkage.joints": sketch.joints, "loads.forces": sketch.forces}
    for key, rows in counted.items():
        if over := count_fault(key, len(rows)):
            raise DesignError([over])
    factor = _SIZES[unit or sketch.unit or "mm"]
    joints, alias = _one_at_a_place(_joints(sketch, factor, mirror))
    names = _names(joints)
    merged = _merged(joints, sketch.welded)
    if set(merged.values()) <= {GROUND}:
        raise refused("text", "no mechanism: no link in it moves", "joints, and links between them")
    joints = [replace(joint, links=tuple(dict.fromkeys(merged[link] for link in joint.links))) for joint in joints]
    if unknown := [each for each in inputs if each not in alias]:
        raise refused("input", f"{', '.join(unknown)}: no joint of this name", " | ".join(names))
    of_text = {each.name: each for each in sketch.inputs if not each.length}
    chosen = [of_text.get(each, SketchInput(name=each)) for each in inputs] or list(sketch.inputs)
    chosen = [replace(each, name=(merged if each.length else alias).get(each.name, each.name)) for each in chosen]
    on_frame = [joint for joint in joints if GROUND in joint.links and joins_two(joint)]
    lead = leading(chosen or [SketchInput(name=joint.name) for joint in on_frame], joints)
    others = [each for each in chosen if each != lead]
    others += [each for each in sketch.inputs if each.length and inputs]
    if lead is not None and lead.length:
        joints = with_rod(joints, lead)
        names |= {lead.joint: lead.joint}
    sheet = Sheet(joints, names)
    loads = _loads(sheet, sketch, merged, factor, mirror)
    linkage, motion = sheet.linkage(), None
    if lead is not None:
        joint = next(joint for joint in joints if joint.name == lead.joint)
        linkage, motion, listed = drive(sheet, lead, joint, factor, mirror)
        left += listed
    else:
        left.append(LeftOut("driver", "no input is known, and no pin holds a single link on the frame"))
    wheels = [each.on(merged) for each in sketch.wheels if {each.first, each.second, each.carrier} <= merged.keys()]
    second, listed = seconds(sheet, lead, others, joints, wheels)
    left += [*sheet.left_out, *listed]
    linkage = replace(linkage, drivers=second)
    design = Design(name, None, (Drive(motion, linkage, None, loads),))
    _require_readable(design, {here: there for there, here in names.items()}, lead)
    if lead is not None and lead.swing is None and motion is not None:
        design, assumed = with_assumed_motion(design, lead.label)
        left.append(assumed)
    led = {linkage.driver.link, *(each.link for each in second)}
    offered = {joint.name for joint in on_frame} | {each.name for each in chosen}
    could = [joint for joint in joints if joins_two(joint) and joint.name in offered]
    at = tuple(joint.name for joint in could if sheet.pair(joint)[0] in led and not (lead and lead.length))
    return Made(design, len(sketch.joints), tuple(left), at, tuple(joint.name for joint in could))


def _require_readable(design: Design, there: Mapping[str, str], lead: SketchInput | None) -> None:
    """Raises DesignError where ``check`` refuses what is written, with the joint of each wrong value; there: name of a point -> of its
    joint."""
    try:
        loads_drawing(dumps(design))
    except DesignError as error:
        raise DesignError(replace(each, path=_with_joint(design, each, there, lead)) for each in error.faults) from None


def _with_joint(design: Design, fault: Fault, there: Mapping[str, str], lead: SketchInput | None) -> str:
    """The path of a fault with the joint, or the joints of the link, to which it belongs."""
    linkage = design.drive.linkage
    words = re.split(r"[.\[\]]+", fault.path)
    joint = next((f"joint {there[word]}" for word in words if word in there), "")
    table = words[1] if len(words) > 1 else ""
    rows = getattr(linkage, table, None) or getattr(design.drive.loads, table, None)
    if lead is not None and (words[0] == "motion" or table == "driver"):
        joint = lead.label if lead.length else f"joint {lead.label}"
    elif not joint and isinstance(rows, tuple) and len(words) > 2 and words[2].isdecimal():
        link = getattr(rows[int(words[2])], "link", getattr(rows[int(words[2])], "number", FRAME_LINK))
        joint = f"joints {', '.join(there.get(name, name) for name in linkage.by_number[link].places)}"
    return f"{joint}: {fault.path}" if joint else fault.path


def _joints(sketch: Sketch, factor: float, mirror: bool) -> list[SketchJoint]:
    """The joints in mm. Raises DesignError where one is too far away."""

    def place(z: complex) -> complex:
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
            j, at=place(j.at), angle_deg=sign * j.angle_deg, through=None if j.through is None else place(j.through)
        )
        for j in sketch.joints
    ]


def _one_at_a_place(joints: Iterable[SketchJoint]) -> tuple[list[SketchJoint], dict[str, str]]:
    """Pins of a link at the same place are one; name of each joint -> of the one that it is now."""
    at: defaultdict[complex, list[SketchJoint]] = defaultdict(list)
    alias: dict[str, str] = {}
    result: dict[str, SketchJoint] = {}
    for joint in joints:
        same = (
            [each for each in at[joint.at] if not set(each.links).isdisjoint(joint.links)] if joint.kind == PIN else []
        )
        first = next(iter(same), joint)
        links = (link for each in (*same, joint) for link in each.links)
        one = replace(first, links=tuple(dict.fromkeys(links)))
        for each in same[1:]:
            del result[each.name]
        result[one.name] = one
        alias |= dict.fromkeys([joint.name, *(each.name for each in same[1:])], one.name)
        if joint.kind == PIN:
            at[joint.at] = [*(each for each in at[joint.at] if each not in same), one]
    return list(result.values()), {name: _last(alias, name) for name in alias}


def _last(alias: Mapping[str, str], name: str) -> str:
    while alias[name] != name:
        name = alias[name]
    return name


def _names(joints: Iterable[SketchJoint]) -> dict[str, str]:
    """Name of each joint there -> its name here: letters, digits and _, a letter first, no two the same."""
    names = [joint.name for joint in joints]
    plain = (re.sub(r"\W", "_", name)[:30] for name in names)
    return dict(zip(names, distinct(each if each.isidentifier() else f"J{each}" for each in plain), strict=True))


def _merged(joints: Sequence[SketchJoint], welded: Iterable[tuple[str, str]]) -> dict[str, str]:
    """Link -> the link that it is one with: welded ones, and those that two pins join."""
    root: dict[str, str] = {}

    def find(link: str) -> str:
        while root.get(link, link) != link:
            link = root[link]
        return link

    def join(one: str, other: str) -> bool:
        a, b = sorted((find(one), find(other)), key=lambda each: each != GROUND)
        root[b] = a
        return a != b

    for one, other in welded:
        join(one, other)
    changed = True
    while changed:
        changed = False
        shared: dict[tuple[str, str], complex] = {}
        for joint in joints:
            own = sorted({find(link) for link in joint.links}) if joint.kind == PIN else []
            for i, one in enumerate(own):
                for other in own[i + 1 :]:
                    before = shared.setdefault((one, other), joint.at)
                    if before != joint.at:
                        changed |= join(one, other)
    return {link: find(link) for joint in joints for link in joint.links}


def _loads(sheet: Sheet, sketch: Sketch, merged: dict[str, str], factor: float, mirror: bool) -> LinkageLoads:
    """Masses in the frames of their links, those of links that are one put together; forces at points, made where there is none."""

    def place(z: complex) -> complex:
        return (z.conjugate() if mirror else z) * factor

    forces = []
    for force in sketch.forces:
        if (number := sheet.number_of(merged.get(force.link, ""), f"force {force.name}")) is not None:
            newton = force.newton.conjugate() if mirror else force.newton
            point = sheet.point_at(number, place(force.at), force.name)
            forces.append(LinkForce(link=number, point=point, x_n=newton.real + 0.0, y_n=newton.imag + 0.0))
    together: dict[int, list[SketchMass]] = {}
    for mass in sketch.masses:
        if (number := sheet.number_of(merged.get(mass.link, ""), f"mass of {mass.link}")) is not None:
            together.setdefault(number, []).append(mass)
    masses = []
    for number, parts in sorted(together.items()):
        total = sum(part.mass_kg for part in parts)
        centre = sum(part.mass_kg * place(part.at) for part in parts) / total if total else place(parts[0].at)
        inertia = sum(p.inertia_kg_m2 + p.mass_kg * abs(place(p.at) - centre) ** 2 * 1e-6 for p in parts)
        origin, axis = sheet.frame_of(number)
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


# -- A text of another program, told by its beginning or by a word, as a design ---------------------------------


@frozen
class Program:
    """How a program's text begins, and what reads it."""

    title: str
    begins: Callable[[str], bool]
    read: Callable[[str], Sketch]


FORMATS: Mapping[str, Program] = MappingProxyType(
    {
        "pyslvs": Program("Pyslvs expression", lambda text: text.startswith(("M[", "#")), readers.read_pyslvs),
        "linkage2": Program("Linkage file", lambda text: text.startswith("<"), readers.read_linkage2),
        "pmks": Program("PMKS+ address", lambda text: bool(text), readers.read_pmks),
    }
)


def decoded(data: bytes) -> str:
    """The text of a file: UTF-8, or as Linkage writes names, in the letters of Windows."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("cp1252", "replace")


def read_linkage(
    text: str, format: str = "", *, name: str = "", units: str = "", mirror: bool = False, inputs: Sequence[str] = ()
) -> Made:
    """The design of a text; units: of its lengths, where it does not say; inputs: names of driven joints. Raises DesignError."""
    if len(text.encode(errors="replace")) > PROGRAM_BYTES:
        raise refused("text", "too long", f"at most {PROGRAM_BYTES / 1e6:g} MB")
    text = text.strip().removeprefix("\ufeff")
    row = FORMATS[format] if format else next((r for r in FORMATS.values() if r.begins(text)), None)
    if row is None:
        raise refused("text", "nothing to read", " | ".join(FORMATS))
    return made(row.read(text), name or row.title, units, mirror, inputs)
