"""Drawing tools, one row each."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

from core.design import Attachment, Design, put, with_new_row
from core.design.linkage import FRAME_LINK, NO_DRIVER, Linkage
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
from core.mechanism.drawing_targets import (
    DrawingTarget,
    faces_at,
)
from core.mechanism.drawn import (
    PointPositions,
    frame_link,
    link_pose,
    point_positions,
)
from kindyna_gui.linkage.snapping import FACE, Snap

CHOOSE = "choose"
"""Name of the tool that selects and moves parts."""
POSITION, LOCAL, LENGTH, DIRECTION = "position", "local", "length", "direction"
"""Input boxes of a click: x and y, x and y on the link under the mouse, length and angle from the last click, angle."""
MANY = 100
"""Number of clicks of a tool that a double click or Enter ends."""

# -- what a tool works on and returns -------------------------------------------------------------------


@frozen
class Drawing:
    """Input of a tool: design, positions of its points, clicked positions, typed length, scale in pixels per mm."""

    design: Design
    positions: PointPositions
    snaps: Sequence[Snap]
    length_mm: float | None = None
    scale: float = 1.0

    @property
    def linkage(self) -> Linkage:
        """The linkage of the design."""
        linkage: Linkage = self.design.drive.linkage
        return linkage

    @property
    def targets(self) -> list[DrawingTarget]:
        """The clicks as targets of an edit."""
        return [snap.target for snap in self.snaps]


@frozen
class DrawingEdit:
    """Result of a tool or an action: the design, the name of the undo step, and the new selection."""

    design: Design
    text: str
    points: tuple[str, ...] = ()
    links: tuple[int, ...] = ()
    row: str = ""


@frozen
class DrawTool:
    """One tool: label, key, tip, a prompt for each click, number of clicks, function that edits the design.

    boxes      input boxes of each click: one of ``POSITION`` ..., the load that the tool adds, or empty
    adds_link  the clicks are the points of a new link
    """

    name: str
    text: str
    key: str
    tip: str
    prompts: tuple[str, ...]
    clicks: int = 0
    apply: Callable[[Drawing], DrawingEdit] | None = None
    boxes: tuple[str, ...] = ("",)
    adds_link: bool = False

    def boxes_at(self, click: int) -> str:
        """Input boxes of the click with this index."""
        return self.boxes[min(click, len(self.boxes) - 1)]


def row_index(path: str) -> int:
    """Index of a row in its list: 2 for ``loads.forces[2]``."""
    return int(path[path.index("[") + 1 : -1])


def _refused(problem: str, allowed: str) -> DesignError:
    return DesignError([Fault("linkage", "drawing", problem, allowed)])


def _new_points(before: Design, after: Design) -> tuple[str, ...]:
    old = point_positions(before.drive.linkage)
    return tuple(name for name in point_positions(after.drive.linkage) if name not in old)


# -- the tools -------------------------------------------------------------------------------------------


def _link(drawing: Drawing, what: str) -> DrawingEdit:
    design = with_link(drawing.design, drawing.targets, drawing.length_mm)
    if drawing.length_mm is not None and drawing.snaps[-1].point:
        from core.mechanism.drawn import assembled

        design = assembled(design)
    link = design.drive.linkage.links[-1]
    if design.drive.linkage.driver == NO_DRIVER and set(link.places) & set(frame_link(drawing.linkage).places):
        design = with_driving_link(design, link.number)  # the first link on a pivot, until another one is selected
    return DrawingEdit(design, f"Draw {what} {'-'.join(link.places)}", links=(link.number,))


def _plate(drawing: Drawing) -> DrawingEdit:
    return _link(drawing, "plate" if len(drawing.snaps) > 2 else "bar")


def _pin(drawing: Drawing) -> DrawingEdit:
    (snap,) = drawing.snaps
    links = faces_at(drawing.linkage, drawing.positions, snap.at, FACE / drawing.scale)
    design = with_pin(drawing.design, snap.target, links)
    names = _new_points(drawing.design, design) or (snap.point,)
    return DrawingEdit(design, f"Pin {names[0]}", points=names)


def _ground(drawing: Drawing) -> DrawingEdit:
    (snap,) = drawing.snaps
    design = with_ground(drawing.design, snap.target)
    names = _new_points(drawing.design, design) or (snap.point,)
    return DrawingEdit(design, f"Ground {names[0]}", points=names)


def _point(drawing: Drawing) -> DrawingEdit:
    design = with_traced_point(drawing.design, drawing.snaps[0].target)
    names = _new_points(drawing.design, design)
    return DrawingEdit(design, f"Point {names[0]} on link {drawing.snaps[0].link}", points=names)


def _slider(drawing: Drawing) -> DrawingEdit:
    """Block at the first click that slides along the line to the second; a frame point fixes the line."""
    first, second = drawing.snaps
    fixed = frame_link(drawing.linkage).places
    block, guide = (second, first) if first.point in fixed and second.point not in fixed else (first, second)
    direction = second.at - first.at
    if not direction:
        raise _refused("both points of the line are the same", "another point along the line")
    through = guide.at if guide.point in fixed else block.at
    angle = round(math.degrees(cmath.phase(direction)), 9) + 0.0
    design = with_slider(drawing.design, block.target, through, angle)
    link = design.drive.linkage.links[-1]
    return DrawingEdit(design, f"Draw slider {next(iter(link.places))}", links=(link.number,))


def _slider_on(drawing: Drawing) -> DrawingEdit:
    """Block at the first click that slides along the axis of the link at the second."""
    first, second = drawing.snaps
    on = second.link if second.link is not None else _owner(drawing, second.point)
    if on is None or on == FRAME_LINK:
        raise _refused("no moving link is here", "a link along which the block slides")
    _, axis = link_pose(drawing.linkage, on, drawing.positions)
    block = first.target if first.point else replace(first.target, link=None)
    design = with_slider(drawing.design, block, first.at, math.degrees(cmath.phase(axis)), on)
    link = design.drive.linkage.links[-1]
    return DrawingEdit(design, f"Draw slider {next(iter(link.places))} on link {on}", links=(link.number,))


def _driver(drawing: Drawing) -> DrawingEdit:
    number = _clicked_link(drawing)
    if number is None:
        raise _refused("no link is here", "a link that is pinned to the ground, or slides on it")
    return DrawingEdit(with_driving_link(drawing.design, number), f"Drive link {number}", links=(number,))


def _gear(drawing: Drawing) -> DrawingEdit:
    from core.mechanism.drawn import with_second_input

    number = _clicked_link(drawing)
    if number is None:
        raise _refused("no link is here", "a link that is pinned to the ground, or to the driver")
    design = with_second_input(drawing.design, number)
    row = f"linkage.drivers[{len(design.drive.linkage.drivers) - 1}]"
    return DrawingEdit(design, f"Drive link {number} by a ratio", row=row)


def _clicked_link(drawing: Drawing) -> int | None:
    """Return the clicked link, or the first moving link that has the clicked point."""
    (snap,) = drawing.snaps
    if snap.link is not None or not snap.point:
        return snap.link
    return next((n.number for n in drawing.linkage.links if n.number != FRAME_LINK and snap.point in n.places), None)


def _roller(drawing: Drawing) -> DrawingEdit:
    from core.mechanism.drivers import with_roller

    (snap,) = drawing.snaps
    number = _owner(drawing, snap.point)
    if number is None or number == FRAME_LINK:
        raise _refused("no moving point is here", "a point of a moving link")
    return DrawingEdit(
        with_roller(drawing.design, number, snap.point), f"Put the cam roller on {snap.point}", points=(snap.point,)
    )


def _owner(drawing: Drawing, point: str) -> int | None:
    """Return the first moving link that has a point, else the frame."""
    links = [link.number for link in drawing.linkage.links if point in link.places]
    return next((n for n in links if n != FRAME_LINK), links[0] if links else None)


def _attachment(drawing: Drawing, snap: Snap, fixed: bool) -> Attachment:
    """Attachment of a load at a click; with ``fixed`` an empty position is on the frame."""
    if snap.point:
        links = [link.number for link in drawing.linkage.links if snap.point in link.places]
        number = FRAME_LINK if fixed and FRAME_LINK in links else _owner(drawing, snap.point)
        assert number is not None
        return Attachment(link=number, point=snap.point)
    if snap.link is None and not fixed:
        raise _refused("no link is here", "a moving link")
    number = FRAME_LINK if snap.link is None else snap.link
    origin, axis = link_pose(drawing.linkage, number, drawing.positions)
    local = (snap.at - origin) * axis.conjugate()
    return Attachment(link=number, x_mm=round(local.real, 3) + 0.0, y_mm=round(local.imag, 3) + 0.0)


def _row(design: Design, name: str) -> str:
    return f"loads.{name}[{len(getattr(design.drive.loads, name)) - 1}]"


def _mass(drawing: Drawing) -> DrawingEdit:
    attachment = _attachment(drawing, drawing.snaps[0], fixed=False)
    if attachment.link == FRAME_LINK:
        raise _refused("the ground has no mass", "a moving link")
    if attachment.point is not None:
        local = drawing.linkage.by_number[attachment.link].places[attachment.point]
        attachment = Attachment(link=attachment.link, x_mm=local.real, y_mm=local.imag)
    if attachment.link in {row.link for row in drawing.design.drive.loads.masses}:
        raise _refused(f"link {attachment.link} has a mass already", "another link, or change the values of that mass")
    design = with_new_row(drawing.design, "loads.masses", [attachment])
    return DrawingEdit(design, f"Give link {attachment.link} a mass", row=_row(design, "masses"))


def _force(drawing: Drawing) -> DrawingEdit:
    (snap,) = drawing.snaps
    design = drawing.design
    if not snap.point:
        design = with_traced_point(design, snap.target)
        snap = replace(snap, point=_new_points(drawing.design, design)[0], link=None)
        drawing = replace(drawing, design=design)
    attachment = _attachment(drawing, snap, fixed=False)
    if attachment.link == FRAME_LINK:
        raise _refused("a force on the ground has no effect", "a point of a moving link")
    design = with_new_row(design, "loads.forces", [attachment])
    return DrawingEdit(design, f"Put a force on {snap.point}", row=_row(design, "forces"))


def _spring(drawing: Drawing) -> DrawingEdit:
    first, second = (_attachment(drawing, snap, fixed=True) for snap in drawing.snaps)
    if first.link == second.link:
        raise _refused(f"both ends are on link {first.link}", "ends on two links")
    design = with_new_row(drawing.design, "loads.springs", [first, second])
    row = _row(design, "springs")
    length = abs(drawing.snaps[0].at - drawing.snaps[1].at)
    return DrawingEdit(put(design, f"{row}.free_length_mm", round(length, 3)), "Draw spring", row=row)


_END = "the other end: click, or type its length"
TOOLS: Mapping[str, DrawTool] = MappingProxyType(
    {
        tool.name: tool
        for tool in (
            DrawTool(CHOOSE, "Choose", "V", "Select with a click or a box, Shift adds; drag to move",
                     ("click a part to select it, drag to move it; Shift adds",)),
            DrawTool("pin", "Pin", "P", "Pin: joins the links under it",
                     ("click where links cross, or an empty position",), 1, _pin, (POSITION,)),
            DrawTool("bar", "Bar", "B", "A bar between two pins; a click on a pin joins to it, a click on a bar makes the bar a plate",
                     ("start of the bar: a pin, a link, or an empty position", _END), 2,
                     lambda drawing: _link(drawing, "bar"), (POSITION, LENGTH), adds_link=True),
            DrawTool("plate", "Plate", "L", "A plate through three pins or more; double click or Enter ends it",
                     ("the first corner of the plate", "the next corner", "the next corner; Enter ends"), MANY, _plate,
                     (POSITION, LENGTH), adds_link=True),
            DrawTool("slider", "Slider on a line", "S", "A block that slides on the ground",
                     ("the pin or the position of the block", "a point along its line, or type the angle"), 2, _slider,
                     (POSITION, DIRECTION)),
            DrawTool("slider_on", "Slider on a link", "Shift+S", "A block that slides along a link",
                     ("the pin or the position of the block", "the link along which it slides"), 2, _slider_on,
                     (POSITION, "")),
            DrawTool("ground", "Ground", "G", "A fixed pivot: a pin on the ground, or a point fixed to it",
                     ("click a pin, a link, or an empty position",), 1, _ground, (POSITION,)),
            DrawTool("point", "Point on a link", "T", "A point of a link: its path is drawn, and a force can act on it",
                     ("click on a link; then type its x and y on it",), 1, _point, (LOCAL,)),
            DrawTool("driver", "Driver", "R", "The driving link: pinned to the ground, or sliding on it",
                     ("click the driving link",), 1, _driver),
            DrawTool("gear", "Second input", "W", "A link driven by a ratio to the driver: gears, a belt, an arm on an arm",
                     ("click the driven link; then type the ratio, or the wheels",), 1, _gear),
            DrawTool("roller", "Cam roller", "C", "The point that carries the cam roller",
                     ("click the point that carries the roller",), 1, _roller),
            DrawTool("mass", "Mass", "M", "The mass of a link, at its centre",
                     ("click the centre of mass on a link; then type the mass",), 1, _mass, ("masses",)),
            DrawTool("force", "Force", "F", "A force on a point of a link",
                     ("click the point it acts on; then type x and y",), 1, _force, ("forces",)),
            DrawTool("spring", "Spring", "K", "A spring between two links, or a link and the ground",
                     ("the first end of the spring", "its other end"), 2, _spring, (POSITION,)),
        )
    }
)  # fmt: skip
"""Name -> tool, in the order of the tool strip."""
