"""The sheet on which links are drawn: their points, frames of their own, blocks of sliding pins, and lines on which links slide."""

from __future__ import annotations

import cmath
import math
import re
from collections.abc import Sequence

from core.design import FRAME_LINK, NO_DRIVER, Drawn, Driver, Link, Linkage, LinkPoint, Slider
from core.linkage_programs.sketch import GROUND, PIN, SLIDE, LeftOut, SketchJoint

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


__all__ = ["SAME", "Sheet"]
