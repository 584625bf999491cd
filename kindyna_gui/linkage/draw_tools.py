"""Tools and actions, a row each."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from core.design import Attachment, Design, put, with_new_row
from core.design.linkage import FRAME_LINK, NO_DRIVER, Link, Linkage
from core.errors import DesignError, Fault
from core.frozen import frozen
from core.mechanism.drawing_edits import (
    with_driving_link,
    with_ground,
    with_link,
    with_pin,
    with_slider,
    with_traced_point,
)
from core.mechanism.drawn import DrawingTarget, PointPositions, frame_link, link_pose, point_positions, slider_line
from kindyna_gui.linkage.picking import foot

# -- snapping --------------------------------------------------------------------------------------------

POINT, LINE, PERPENDICULAR, ANGLE, GRID, FREE = "point", "line", "perpendicular", "angle", "grid", ""
NEAR, ALONG, TURN = 10.0, 7.0, 6.0  # pixels from a point, a line, and a ray, within which it is meant
STEP_DEG = 15.0
CELL = 14.0  # pixels of a cell of the grid, at least
FACE = 7.0  # pixels from the line of a bar within which its face is


@frozen
class Snap:
    """Where the mouse is taken to be [mm], by which mark, and what stands there."""

    at: complex
    mark: str = FREE
    text: str = ""
    point: str = ""
    link: int | None = None

    @property
    def spot(self) -> DrawingTarget:
        return DrawingTarget(self.at, self.point, self.link)


def grid_step(scale: float) -> float:
    """The width of a cell [mm] at so many pixels per mm: 1, 2 or 5 times a power of ten."""
    least = CELL / scale
    power = 10.0 ** math.floor(math.log10(least))
    return next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power >= least * (1.0 - 1e-9))


def on_grid(at: complex, scale: float) -> complex:
    """The nearest crossing of the grid."""
    step = grid_step(scale)
    digits = max(0, -math.floor(math.log10(step)))
    return complex(round(round(at.real / step) * step, digits) + 0.0, round(round(at.imag / step) * step, digits) + 0.0)


def outline(link: Link, places: PointPositions) -> list[complex]:
    """The corners of a link's face on the sheet: of a plate in order around it."""
    corners = [places[name] for name in link.places if name in places]
    if len(corners) < 3:
        return corners
    centre = sum(corners) / len(corners)
    return sorted(corners, key=lambda at: cmath.phase(at - centre) if at != centre else 0.0)


def edges(corners: Sequence[complex]) -> Iterator[tuple[complex, complex]]:
    """The lines of a face."""
    if len(corners) == 2:
        yield corners[0], corners[1]
    elif len(corners) > 2:
        yield from zip(corners, [*corners[1:], corners[0]], strict=True)


def inside(at: complex, corners: Sequence[complex]) -> bool:
    """Whether a place lies within a face."""
    odd = False
    for one, other in edges(corners) if len(corners) > 2 else ():
        if (one.imag > at.imag) != (other.imag > at.imag):
            odd ^= at.real < one.real + (at.imag - one.imag) * (other.real - one.real) / (other.imag - one.imag)
    return odd


def faces_at(linkage: Linkage, places: PointPositions, at: complex, scale: float) -> list[int]:
    """The links whose face is at a place, uppermost first."""
    found = []
    for link in reversed(linkage.links):
        corners = outline(link, places)
        near = any(abs(at - foot(at, one, other)) * scale <= FACE for one, other in edges(corners))
        if link.number != FRAME_LINK and (near or inside(at, corners)):
            found.append(link.number)
    return found


def point_at(places: PointPositions, at: complex, scale: float, without: Collection[str] = ()) -> str:
    """The point that is meant by a place; empty where none is near."""
    near = {name: abs(place - at) * scale for name, place in places.items() if name not in without}
    best = min(near, key=lambda name: near[name], default="")
    return best if best and near[best] <= NEAR else ""


def nearest_mark(marks: Sequence[complex], at: complex, scale: float) -> complex | None:
    """The place of the underlay that is meant; None where none is near."""
    if not len(marks):
        return None
    apart = np.abs(np.asarray(marks) - at)
    best = int(np.argmin(apart))
    return complex(marks[best]) if apart[best] * scale <= NEAR else None


def snapped(
    linkage: Linkage,
    places: PointPositions,
    at: complex,
    scale: float,
    start: complex | None = None,
    without: Collection[str] = (),
    free: bool = False,
    marks: Sequence[complex] = (),
) -> Snap:
    """What a place of the mouse [mm] means, at so many pixels per mm. start: where a line to it begins; without: points that are
    moved themselves; free: it is where it is; marks: places of what lies under the drawing."""
    if free:
        return Snap(at, link=_first(faces_at(linkage, places, at, scale)))
    if name := point_at(places, at, scale, without):
        return Snap(places[name], POINT, name, point=name)
    if (mark := nearest_mark(marks, at, scale)) is not None:
        return Snap(mark, POINT, "of the underlay", link=_first(faces_at(linkage, places, mark, scale)))
    moved = {link.number for link in linkage.links if set(link.places) & set(without)}
    lines = [
        (one, other, link.number)
        for link in linkage.links
        if link.number not in {*moved, FRAME_LINK}
        for one, other in edges(outline(link, places))
    ]
    for one, other, number in lines:
        on = foot(at, one, other)
        if abs(at - on) * scale <= ALONG:
            if start is not None:
                upright = foot(start, one, other)
                if abs(upright - at) * scale <= NEAR and upright not in (one, other, start):
                    return Snap(upright, PERPENDICULAR, "perpendicular", link=number)
            return Snap(on, LINE, f"on link {number}", link=number)
    face = _first([n for n in faces_at(linkage, places, at, scale) if n not in moved])
    for slider in linkage.sliders:
        if slider.on in linkage.by_number:
            through, along = slider_line(linkage, slider, places)
            on = through + along * ((at - through) * along.conjugate()).real
            if abs(at - on) * scale <= ALONG:
                return Snap(on, LINE, "on the line", link=face)
    grid = on_grid(at, scale)
    if start is None or abs(at - start) * scale < NEAR:
        return Snap(grid, GRID, link=face)
    if abs(grid - at) * scale <= 0.25 * CELL:  # a crossing of the grid is meant rather than a ray beside it
        return Snap(grid, GRID, link=face)
    turned = math.degrees(cmath.phase(at - start))
    step = round(turned / STEP_DEG) * STEP_DEG
    ray = cmath.rect(1.0, math.radians(step))
    on = start + ray * ((at - start) * ray.conjugate()).real
    if abs(on - at) * scale <= TURN:
        length = abs(on_grid(complex(abs(on - start), 0.0), scale))
        end = start + ray * length
        return Snap(complex(round(end.real, 9), round(end.imag, 9)), ANGLE, f"{step % 360.0:g}°", link=face)
    return Snap(grid, GRID, link=face)


def _first(numbers: Sequence[int]) -> int | None:
    return numbers[0] if numbers else None


__all__ = [
    "ANGLE", "FREE", "GRID", "LINE", "PERPENDICULAR", "POINT", "Snap", "edges", "faces_at", "grid_step", "inside",
    "nearest_mark", "on_grid", "outline", "point_at", "snapped",
]  # fmt: skip


# -- draw tools ------------------------------------------------------------------------------------------

CHOOSE = "choose"
"""The tool that is none: the mouse chooses and moves."""
MANY = 100
"""Clicks of a tool that a double click or Enter ends."""


@frozen
class Drawing:
    """What a tool works on: the design with the places of its points, the places clicked, the length typed if one was, and the
    pixels per mm."""

    design: Design
    places: PointPositions
    snaps: Sequence[Snap]
    length_mm: float | None = None
    scale: float = 1.0

    @property
    def linkage(self) -> Linkage:
        linkage: Linkage = self.design.drive.linkage
        return linkage

    @property
    def spots(self) -> list[DrawingTarget]:
        return [snap.spot for snap in self.snaps]


@frozen
class Made:
    """What a tool has made: the design, the name of the step, and what is chosen then."""

    design: Design
    text: str
    points: tuple[str, ...] = ()
    links: tuple[int, ...] = ()
    row: str = ""


@frozen
class DrawTool:
    """One tool: label, key, tip, what is clicked next by the number of clicks made, how many clicks there are, what it makes."""

    name: str
    text: str
    key: str
    tip: str
    prompts: tuple[str, ...]
    clicks: int = 0
    make: Callable[[Drawing], Made] | None = None


def _refused(problem: str, allowed: str) -> DesignError:
    return DesignError([Fault("linkage", "drawing", problem, allowed)])


def _new_points(before: Design, after: Design) -> tuple[str, ...]:
    old = point_positions(before.drive.linkage)
    return tuple(name for name in point_positions(after.drive.linkage) if name not in old)


def _link(drawing: Drawing, what: str) -> Made:
    made = with_link(drawing.design, drawing.spots, drawing.length_mm)
    if drawing.length_mm is not None and drawing.snaps[-1].point:
        from core.mechanism.drawn import assembled

        made = assembled(made)
    link = made.drive.linkage.links[-1]
    if made.drive.linkage.driver == NO_DRIVER and set(link.places) & set(frame_link(drawing.linkage).places):
        made = with_driving_link(made, link.number)  # the first link on a pivot, until another is chosen
    return Made(made, f"Draw {what} {'-'.join(link.places)}", links=(link.number,))


def _bar(drawing: Drawing) -> Made:
    return _link(drawing, "bar")


def _plate(drawing: Drawing) -> Made:
    return _link(drawing, "plate" if len(drawing.snaps) > 2 else "bar")


def _pin(drawing: Drawing) -> Made:
    (snap,) = drawing.snaps
    links = faces_at(drawing.linkage, drawing.places, snap.at, drawing.scale)
    made = with_pin(drawing.design, snap.spot, links)
    names = _new_points(drawing.design, made) or (snap.point,)
    return Made(made, f"Pin {names[0]}", points=names)


def _ground(drawing: Drawing) -> Made:
    (snap,) = drawing.snaps
    made = with_ground(drawing.design, snap.spot)
    names = _new_points(drawing.design, made) or (snap.point,)
    return Made(made, f"Ground {names[0]}", points=names)


def _point(drawing: Drawing) -> Made:
    made = with_traced_point(drawing.design, drawing.snaps[0].spot)
    names = _new_points(drawing.design, made)
    return Made(made, f"Point {names[0]} on link {drawing.snaps[0].link}", points=names)


def _slider(drawing: Drawing) -> Made:
    """A block at the first place, which slides along the line to the second; through that, where it is a point of the frame."""
    first, second = drawing.snaps
    fixed = frame_link(drawing.linkage).places
    block, other = (second, first) if first.point in fixed and second.point not in fixed else (first, second)
    way = other.at - block.at if block is first else block.at - other.at
    if not way:
        raise _refused("a line needs two places", "another place along the line")
    through = other.at if other.point in fixed else block.at
    angle = round(math.degrees(cmath.phase(way)), 9) + 0.0
    made = with_slider(drawing.design, block.spot, through, angle)
    link = made.drive.linkage.links[-1]
    return Made(made, f"Draw slider {next(iter(link.places))}", links=(link.number,))


def _slider_on(drawing: Drawing) -> Made:
    """A block at the first place, along the axis of the link at the second."""
    first, second = drawing.snaps
    on = second.link if second.link is not None else _owner(drawing, second.point)
    if on is None or on == FRAME_LINK:
        raise _refused("nothing carries the line", "a link, along which the block slides")
    _, axis = link_pose(drawing.linkage, on, drawing.places)
    spot = first.spot if first.point else replace(first.spot, link=None)
    through = first.at
    made = with_slider(drawing.design, spot, through, math.degrees(cmath.phase(axis)), on)
    link = made.drive.linkage.links[-1]
    return Made(made, f"Draw slider {next(iter(link.places))} on link {on}", links=(link.number,))


def _driver(drawing: Drawing) -> Made:
    number = _link_meant(drawing)
    if number is None:
        raise _refused("no link there", "a link that is pinned to the ground, or slides on it")
    return Made(with_driving_link(drawing.design, number), f"Drive link {number}", links=(number,))


def _gear(drawing: Drawing) -> Made:
    from core.mechanism.drawn import with_second_input

    number = _link_meant(drawing)
    if number is None:
        raise _refused("no link there", "a link that a pin holds on the ground, or on the driver")
    made = with_second_input(drawing.design, number)
    row = f"linkage.drivers[{len(made.drive.linkage.drivers) - 1}]"
    return Made(made, f"Drive link {number} by a ratio", row=row)


def _link_meant(drawing: Drawing) -> int | None:
    """The link that is clicked, or the first but for the frame that has the point."""
    (snap,) = drawing.snaps
    if snap.link is not None or not snap.point:
        return snap.link
    return next((n.number for n in drawing.linkage.links if n.number != FRAME_LINK and snap.point in n.places), None)


def _roller(drawing: Drawing) -> Made:
    from core.mechanism.drivers import with_roller

    (snap,) = drawing.snaps
    number = _owner(drawing, snap.point)
    if number is None or number == FRAME_LINK:
        raise _refused("no point that moves there", "a point of a link that moves")
    return Made(
        with_roller(drawing.design, number, snap.point), f"Put the cam roller on {snap.point}", points=(snap.point,)
    )


def _owner(drawing: Drawing, point: str) -> int | None:
    """The link that a point is taken to belong to: the first that moves, else the frame."""
    having = [link.number for link in drawing.linkage.links if point in link.places]
    return next((n for n in having if n != FRAME_LINK), having[0] if having else None)


def _held(drawing: Drawing, snap: Snap, fixed: bool) -> Attachment:
    """Where a load holds on at a place; fixed: the sheet stands for the frame."""
    if snap.point:
        having = [link.number for link in drawing.linkage.links if snap.point in link.places]
        number = FRAME_LINK if fixed and FRAME_LINK in having else _owner(drawing, snap.point)
        assert number is not None
        return Attachment(link=number, point=snap.point)
    if snap.link is None and not fixed:
        raise _refused("no link there", "a link that moves")
    number = FRAME_LINK if snap.link is None else snap.link
    origin, axis = link_pose(drawing.linkage, number, drawing.places)
    local = (snap.at - origin) * axis.conjugate()
    return Attachment(link=number, x_mm=round(local.real, 3) + 0.0, y_mm=round(local.imag, 3) + 0.0)


def _row(design: Design, name: str) -> str:
    return f"loads.{name}[{len(getattr(design.drive.loads, name)) - 1}]"


def _mass(drawing: Drawing) -> Made:
    held = _held(drawing, drawing.snaps[0], fixed=False)
    if held.link == FRAME_LINK:
        raise _refused("the ground has no mass", "a link that moves")
    if held.point is not None:
        local = drawing.linkage.by_number[held.link].places[held.point]
        held = Attachment(link=held.link, x_mm=local.real, y_mm=local.imag)
    if held.link in {row.link for row in drawing.design.drive.loads.masses}:
        raise _refused(
            f"link {held.link} has its mass already", "another link, or the values of the mass that is there"
        )
    made = with_new_row(drawing.design, "loads.masses", [held])
    return Made(made, f"Give link {held.link} a mass", row=_row(made, "masses"))


def _force(drawing: Drawing) -> Made:
    (snap,) = drawing.snaps
    design = drawing.design
    if not snap.point:
        design = with_traced_point(design, snap.spot)
        snap = replace(snap, point=_new_points(drawing.design, design)[0], link=None)
        drawing = replace(drawing, design=design)
    held = _held(drawing, snap, fixed=False)
    if held.link == FRAME_LINK:
        raise _refused("the ground bears any force", "a point of a link that moves")
    made = with_new_row(design, "loads.forces", [held])
    return Made(made, f"Put a force on {snap.point}", row=_row(made, "forces"))


def _spring(drawing: Drawing) -> Made:
    one, other = (_held(drawing, snap, fixed=True) for snap in drawing.snaps)
    if one.link == other.link:
        raise _refused(f"both ends are on link {one.link}", "ends on two links")
    made = with_new_row(drawing.design, "loads.springs", [one, other])
    row = _row(made, "springs")
    length = abs(drawing.snaps[0].at - drawing.snaps[1].at)
    return Made(put(made, f"{row}.free_length_mm", round(length, 3)), "Draw spring", row=row)


_END = "the other end: click, or type its length"
TOOLS: Mapping[str, DrawTool] = MappingProxyType(
    {
        tool.name: tool
        for tool in (
            DrawTool(CHOOSE, "Choose", "V", "Choose with a click, Shift for more, or a box; drag to move",
                     ("click what you want, drag to move it; Shift adds",)),
            DrawTool("pin", "Pin", "P", "A pin that joins the links under it, or waits for links",
                     ("click where links cross, or on the sheet",), 1, _pin),
            DrawTool("bar", "Bar", "B", "A bar between two pins; on a pin it joins, on a bar that becomes a plate",
                     ("where the bar begins: a pin, a link, or the sheet", _END), 2, _bar),
            DrawTool("plate", "Plate", "L", "A plate through three pins or more; double click or Enter ends it",
                     ("the first corner of the plate", "the next corner", "the next corner; Enter ends"), MANY, _plate),
            DrawTool("slider", "Slider on a line", "S", "A block that slides on the ground",
                     ("the pin or the place of the block", "a place along its line, or type the angle"), 2, _slider),
            DrawTool("slider_on", "Slider on a link", "Shift+S", "A block that slides along a link",
                     ("the pin or the place of the block", "the link along which it slides"), 2, _slider_on),
            DrawTool("ground", "Ground", "G", "A fixed pivot: a pin of the ground, or a point that is fixed to it",
                     ("click a pin, a link, or the sheet",), 1, _ground),
            DrawTool("point", "Point on a link", "T", "A point of a link that is traced, and can carry a force",
                     ("click on a link; then type its x and y on it",), 1, _point),
            DrawTool("driver", "Driver", "R", "The link that drives: pinned to the ground, or sliding on it",
                     ("click the link that drives",), 1, _driver),
            DrawTool("gear", "Second input", "W", "A link that follows the driver by a ratio: gears, a belt, an arm on an arm",
                     ("click the link that follows the driver; then type the ratio, or its wheels",), 1, _gear),
            DrawTool("roller", "Cam roller", "C", "The point on which the cam's roller is",
                     ("click the point that carries the roller",), 1, _roller),
            DrawTool("mass", "Mass", "M", "The mass of a link, at its centre",
                     ("click the centre of mass on a link; then type the mass",), 1, _mass),
            DrawTool("force", "Force", "F", "A force on a point of a link",
                     ("click the point it acts on; then type x and y",), 1, _force),
            DrawTool("spring", "Spring", "K", "A spring between two links, or a link and the ground",
                     ("the first end of the spring", "its other end"), 2, _spring),
        )
    }
)  # fmt: skip
"""Name -> tool, in the order in which they stand beside each other."""
