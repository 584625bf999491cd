"""A design from the joints of another program: links with frames of their own, blocks of sliding pins, the driver, as drawn."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import replace

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
)
from core.design.rules import count_fault
from core.errors import DesignError
from core.frozen import frozen
from core.linkage_programs.sketch import GROUND, PIN, SLIDE, LeftOut, Sketch, SketchJoint, SketchMass, refused

UNITS = {"mm": 1.0, "cm": 10.0, "m": 1000.0, "in": 25.4}
_SPEED = 60.0  # rpm, where none is known
_SAME = 1e-9  # mm: joints this near are at one place
_MARK = 10.0  # mm: so far along a line it is marked


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
    """The design of a sketch. Raises DesignError where there is too much of it, or an input is no joint of it."""
    left = list(sketch.left_out)
    if not (unit or sketch.unit):
        left.append(LeftOut("unit of length", "the text has none: read as mm, --units says another"))
    links = {link for joint in sketch.joints for link in joint.links}
    for key, sets in (("linkage.links", links), ("linkage.joints", sketch.joints)):
        if over := count_fault(key, len(sets)):
            raise DesignError([over])
    left += [LeftOut(f"joint {joint.name}", "it is on no link") for joint in sketch.joints if not joint.links]
    sketch = replace(sketch, joints=tuple(joint for joint in sketch.joints if joint.links))
    joints = _joints(sketch, UNITS[unit or sketch.unit or "mm"], mirror)
    names = _names(joints)
    merged = _merged(joints, sketch.welded)
    joints = [_with_links(joint, merged) for joint in joints]
    cylinder, joints = _cylinder(sketch, joints, merged, bool(inputs), left)
    sheet = _Sheet(joints, names | ({} if cylinder is None else {cylinder.slide: cylinder.slide}))
    loads = _loads(sheet, sketch, merged, UNITS[unit or sketch.unit or "mm"], mirror)
    wanted = list(inputs) or list(sketch.inputs)
    unknown = [each for each in wanted if each not in names]
    if unknown:
        raise refused("input", f"{', '.join(unknown)}: no joint of this name", " | ".join(names))
    speeds = dict(zip(sketch.inputs, sketch.speeds, strict=False))
    driver, motion, of_input = (
        _driver(sheet, joints, wanted, speeds, mirror)
        if cylinder is None
        else _by_cylinder(sheet, cylinder, UNITS[unit or sketch.unit or "mm"])
    )
    left += [*sheet.left_out, *of_input]
    linkage = sheet.linkage(driver)
    if cylinder is None and driver is not None and driver[1] is not None:
        wheels = [(merged[a], merged[b], ratio) for a, b, ratio in sketch.wheels if {a, b} <= merged.keys()]
        second, of_second = _second(sheet, joints, wanted, speeds, wheels, driver)
        linkage = replace(linkage, drivers=tuple(second))
        left += of_second
    drive = Drive(motion, linkage, None, loads)
    could = [joint.name for joint in joints if _driven(sheet, joint) is not None]
    led = {linkage.driver.link, *(each.link for each in linkage.drivers)}
    driven = [joint.name for joint in joints if cylinder is None and _driven(sheet, joint) in led]
    return Made(Design(name, None, (drive,)), len(sketch.joints), tuple(left), tuple(driven), tuple(could))


@frozen
class _Cylinder:
    """A link whose length is driven: tube and rod by name, the slide between them, stroke in the program's unit, strokes a minute."""

    tube: str
    rod: str
    slide: str
    throw: float
    cpm: float


def _cylinder(
    sketch: Sketch, joints: list[SketchJoint], merged: dict[str, str], other: bool, left: list[LeftOut]
) -> tuple[_Cylinder | None, list[SketchJoint]]:
    """The first link whose length is driven, as a tube and a rod in it, where nothing else drives; other: an input is asked for."""
    found: _Cylinder | None = None
    for name, throw, cpm in sketch.actuators:
        link = merged.get(name, name)
        ends = [joint for joint in joints if link in joint.links]
        if found is not None or other or sketch.inputs or len(ends) != 2 or not throw or not cpm:
            left.append(
                LeftOut(
                    f"actuator {name.removeprefix('link')}", "something else drives: it is a bar of its drawn length"
                )
            )
            continue
        one, two = ends
        found = _Cylinder(link, f"{link} rod", f"{link}_slide", throw, cpm)
        angle = math.degrees(cmath.phase(two.at - one.at))
        rod = tuple(found.rod if each == link else each for each in two.links)
        joints = [SketchJoint(j.name, j.at, rod, j.kind, j.angle_deg) if j is two else j for j in joints]
        joints.append(SketchJoint(found.slide, two.at, (link, found.rod), SLIDE, angle))
    return found, joints


def _by_cylinder(
    sheet: _Sheet, cylinder: _Cylinder, factor: float
) -> tuple[tuple[Driver, float | None, float | None], Motion, list[LeftOut]]:
    """The cylinder as driver: out and back over a turn, from where it is drawn."""
    throw = cylinder.throw * factor
    law = NamedCurve("simple-harmonic")
    motion = Motion(0.0, (Segment(180.0, throw, law), Segment(180.0, -throw, law)), "mm")
    driver = Driver(sheet.numbers[cylinder.rod], MOTION, abs(cylinder.cpm), sheet.numbers[cylinder.tube])
    left = LeftOut(
        f"law of actuator {cylinder.tube.removeprefix('link')}",
        "the file does not say it: simple harmonic from where it is drawn",
    )
    return (driver, None, 0.0), motion, [left]


def _joints(sketch: Sketch, factor: float, mirror: bool) -> list[SketchJoint]:
    sign = -1.0 if mirror else 1.0
    return [
        SketchJoint(j.name, complex(j.at.real, sign * j.at.imag) * factor, j.links, j.kind, sign * j.angle_deg)
        for j in sketch.joints
    ]


def _names(joints: Iterable[SketchJoint]) -> dict[str, str]:
    """Name of each joint there -> its name here: letters, digits and _, a letter first, no two the same."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for joint in joints:
        plain = re.sub(r"\W", "_", joint.name)[:30]
        name = base = plain if plain.isidentifier() else f"J{plain}"
        count = 1
        while name in taken:
            count += 1
            name = f"{base}_{count}"
        taken.add(name)
        found[joint.name] = name
    return found


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


def _with_links(joint: SketchJoint, merged: dict[str, str]) -> SketchJoint:
    links = tuple(dict.fromkeys(merged[link] for link in joint.links))
    return SketchJoint(joint.name, joint.at, links, joint.kind, joint.angle_deg)


class _Sheet:
    """Links by their numbers, each with its points on the sheet [mm], and the lines on which links slide."""

    def __init__(self, joints: Sequence[SketchJoint], names: dict[str, str]) -> None:
        self._names = names
        self.left_out: list[LeftOut] = []
        links = dict.fromkeys(link for joint in joints for link in joint.links if link != GROUND)
        self.numbers = {GROUND: FRAME_LINK} | {link: n for n, link in enumerate(links, FRAME_LINK + 1)}
        self._points: dict[int, dict[str, complex]] = {n: {} for n in self.numbers.values()}
        self._lines: dict[
            int, tuple[int, complex, complex]
        ] = {}  # sliding link -> on, a point of the line, its direction
        self.blocks: dict[str, int] = {}
        for joint in joints:
            self._add(joint)
        taken = {name for points in self._points.values() for name in points}
        for link, (on, at, along) in self._lines.items():
            self._mark(link, on, at, along, taken)

    def _mark(self, link: int, on: int, at: complex, along: complex, taken: set[str]) -> None:
        """A point on a line whose link has but one, so that the two ways to turn it can be told apart as drawn."""
        points = self._points[on]
        if on == FRAME_LINK or len(points) > 1:
            return
        away = max((abs(at - z) for z in points.values()), default=0.0)
        name = next(each for n in range(1000) if (each := f"line{link}{'_' * bool(n)}{n or ''}") not in taken)
        points[name] = at if away > _SAME else at + along * _MARK
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
        self._lines[block] = (on, joint.at, along)
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
        self._lines[link] = (on, joint.at, along)

    def held(self, link: int) -> bool:
        """Whether a link is joined to the frame, by a pin or a slide."""
        pinned = set(self._points[link]) & set(self._points[FRAME_LINK])
        return bool(pinned) or self._lines.get(link, (0,))[0] == FRAME_LINK

    def frame_of(self, link: int) -> tuple[complex, complex]:
        """Origin and x axis of a link's own frame on the sheet: at its first point towards its second; on the line that it slides on."""
        if link == FRAME_LINK:
            return 0j, 1.0 + 0j
        if link in self._lines:
            return self._lines[link][1:]
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
        near = next((n for n, z in points.items() if abs(z - at) <= _SAME), "")
        if not near:
            taken = {n for each in self._points.values() for n in each}
            plain = re.sub(r"\W", "_", name)[:20]
            base = plain if plain.isidentifier() else f"F{plain}"
            near = next(n for n in (base, *(f"{base}_{i}" for i in range(2, 1000))) if n not in taken)
            points[near] = at
        return near

    def linkage(self, driver: tuple[Driver, float | None, float | None] | None) -> Linkage:
        """All links, sliders and the pose as it is on the sheet."""
        links, sliders = [], []
        for number, points in sorted(self._points.items()):
            origin, axis = self.frame_of(number)
            local = {name: (z - origin) * axis.conjugate() for name, z in points.items()}
            links.append(Link(number, tuple(LinkPoint(n, z.real + 0.0, z.imag + 0.0) for n, z in local.items())))
        for number, (on, at, along) in self._lines.items():
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
        which, deg, mm = driver or (NO_DRIVER, None, None)
        return Linkage(tuple(links), tuple(sliders), which, (), Drawn(deg, mm, places))


def _loads(sheet: _Sheet, sketch: Sketch, merged: dict[str, str], factor: float, mirror: bool) -> LinkageLoads:
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
    return LinkageLoads(masses=tuple(masses), forces=tuple(forces))


def _driver(
    sheet: _Sheet, joints: Sequence[SketchJoint], wanted: Sequence[str], speeds: dict[str, float], mirror: bool
) -> tuple[tuple[Driver, float | None, float | None] | None, Motion | None, list[LeftOut]]:
    """The driver at the first input that one can be, else at the first pin of the frame with one link, where it is drawn."""
    left: list[LeftOut] = []
    could = [joint for joint in joints if joint.links[0] == GROUND or GROUND in joint.links]
    chosen = [joint for name in wanted for joint in joints if joint.name == name]
    for joint in [*chosen, *(could if not chosen else ())]:
        link = _driven(sheet, joint)
        if link is None:
            if joint in chosen:
                left.append(LeftOut(f"input at {joint.name}", "it drives no single link on the frame"))
            continue
        speed = (speeds.get(joint.name) or _SPEED) * (-1.0 if mirror else 1.0)
        if joint.kind == PIN:
            angle = math.degrees(cmath.phase(sheet.frame_of(link)[1]))
            return (Driver(link, CRANK, speed), angle, None), None, left
        left.append(LeftOut(f"motion of {joint.name}", "its law is not known: it rests"))
        return (Driver(link, MOTION, abs(speed)), None, 0.0), Motion(0.0, (Segment(360.0, 0.0),), "mm"), left
    return None, None, [*left, LeftOut("driver", "no input is known, and no pin holds a single link on the frame")]


def _second(
    sheet: _Sheet,
    joints: Sequence[SketchJoint],
    wanted: Sequence[str],
    speeds: dict[str, float],
    wheels: Iterable[tuple[str, str, float]],
    driver: tuple[Driver, float | None, float | None],
) -> tuple[list[SecondDriver], list[LeftOut]]:
    """What turns with the driver: further inputs in the ratio of their speeds, as the first where these are unknown, and wheels."""
    first, angle = driver[0].link, driver[1] or 0.0
    ratios: dict[int, float] = {}
    left: list[LeftOut] = []
    of_joint = {joint.name: joint for joint in joints}
    pinned = {_driven(sheet, of_joint[name]): name for name in wanted if of_joint[name].kind == PIN}
    own = speeds.get(pinned.get(first, ""))
    for name in wanted:
        link = _driven(sheet, of_joint[name])
        if link == first or link is None:
            continue
        if of_joint[name].kind != PIN:
            left.append(LeftOut(f"input at {name}", "a slide beside a crank"))
            continue
        if not own or not speeds.get(name):
            left.append(LeftOut(f"speed of {name}", "it is not known: it turns as the first input"))
        ratios[link] = speeds[name] / own if own and speeds.get(name) else 1.0
    for a, b, ratio in wheels:
        one, other = sheet.numbers[a], sheet.numbers[b]
        if other == first:
            one, other, ratio = other, one, 1.0 / ratio
        if one == first and other not in ratios and sheet.held(other):
            ratios[other] = ratio
        else:
            left.append(LeftOut(f"wheels of {a} and {b}", "neither is the driver's, or the other is not on the frame"))
    rows = []
    for link, ratio in ratios.items():
        here = math.degrees(cmath.phase(sheet.frame_of(link)[1]))
        rows.append(SecondDriver(link=link, ratio=ratio, offset_deg=here - ratio * angle))
    return rows, left


def _driven(sheet: _Sheet, joint: SketchJoint) -> int | None:
    """The link that an input at a joint drives."""
    if GROUND not in joint.links or len(joint.links) != 2:
        return None
    if joint.kind != PIN:
        return sheet.blocks.get(joint.name)
    return next(sheet.numbers[link] for link in joint.links if link != GROUND)


__all__ = ["UNITS", "LeftOut", "Made", "made"]
