"""A design from the joints of another program: links with frames of their own, blocks of sliding pins, the driver, as drawn."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

from core.design import (
    FRAME_LINK,
    Design,
    Drive,
    LinkageLoads,
    LinkForce,
    LinkMass,
)
from core.design.fields import LONGEST_MM
from core.design.rules import count_fault
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.linkage_programs import inputs as driven
from core.linkage_programs.sheet import Sheet
from core.linkage_programs.sketch import (
    GROUND,
    PIN,
    PIXEL,
    LeftOut,
    Sketch,
    SketchInput,
    SketchJoint,
    SketchMass,
    distinct,
    refused,
)
from core.project import dumps, loads_drawing

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
    on_frame = [joint for joint in joints if GROUND in joint.links and driven.joins_two(joint)]
    lead = driven.leading(chosen or [SketchInput(name=joint.name) for joint in on_frame], joints)
    others = [each for each in chosen if each != lead]
    others += [each for each in sketch.inputs if each.length and inputs]
    if lead is not None and lead.length:
        joints = driven.with_rod(joints, lead)
        names |= {lead.joint: lead.joint}
    sheet = Sheet(joints, names)
    loads = _loads(sheet, sketch, merged, factor, mirror)
    linkage, motion = sheet.linkage(), None
    if lead is not None:
        joint = next(joint for joint in joints if joint.name == lead.joint)
        linkage, motion, listed = driven.drive(sheet, lead, joint, factor, mirror)
        left += listed
    else:
        left.append(LeftOut("driver", "no input is known, and no pin holds a single link on the frame"))
    wheels = [each.on(merged) for each in sketch.wheels if {each.first, each.second, each.carrier} <= merged.keys()]
    second, listed = driven.seconds(sheet, lead, others, joints, wheels)
    left += [*sheet.left_out, *listed]
    linkage = replace(linkage, drivers=second)
    design = Design(name, None, (Drive(motion, linkage, None, loads),))
    _require_readable(design, {here: there for there, here in names.items()}, lead)
    if lead is not None and lead.swing is None and motion is not None:
        design, assumed = driven.with_assumed_motion(design, lead.label)
        left.append(assumed)
    led = {linkage.driver.link, *(each.link for each in second)}
    offered = {joint.name for joint in on_frame} | {each.name for each in chosen}
    could = [joint for joint in joints if driven.joins_two(joint) and joint.name in offered]
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


__all__ = ["UNITS", "LeftOut", "Made", "made"]
