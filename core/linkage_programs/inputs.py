"""What drives an imported linkage: the input that leads, its motion, and further inputs and wheels that turn with it."""

from __future__ import annotations

import cmath
import math
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace

from core.design import (
    CRANK,
    FRAME_LINK,
    MOTION,
    Design,
    Driver,
    Linkage,
    Motion,
    NamedCurve,
    SecondDriver,
    Segment,
    all_paths,
    faults,
    with_drive,
)
from core.errors import NoAnswer
from core.linkage_programs.sheet import Sheet
from core.linkage_programs.sketch import GROUND, PIN, SLIDE, LeftOut, SketchInput, SketchJoint, Swing, Wheels
from core.mechanism.drivers import first_motion

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
    except NoAnswer:
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


__all__ = ["drive", "joins_two", "leading", "seconds", "with_assumed_motion", "with_rod"]
