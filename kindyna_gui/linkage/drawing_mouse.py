"""The mouse while drawing: clicks of a drawing tool; selecting by click or box, and dragging the selection."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QPointF, QRectF, Qt
from PySide6.QtGui import QMouseEvent

from core.design import Design, put
from core.design.linkage import FRAME_LINK
from core.errors import DesignError, Fault
from core.mechanism.drawing_edits import with_moved
from core.mechanism.drawing_targets import coincident_point, links_with
from core.mechanism.drawn import PointPositions, link_pose, point_positions
from kindyna_gui.linkage.draw_tools import CHOOSE, DIRECTION, TOOLS, Drawing, DrawingEdit, DrawTool, row_index
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage, links_within
from kindyna_gui.linkage.snapping import Snap, grid_step, snap_to

DRAG = 4.0  # distance from which on a press is a drag, pixels
UNLOCK = "use Lock to unlock it"

# -- a drawing tool --------------------------------------------------------------------------------------


class ToolInput:
    """The clicks of the current drawing tool.

    snaps    positions clicked so far
    mouse    position that the mouse snaps to
    pressed  pixel at which the button was pressed
    """

    def __init__(self, drawn: DrawnLinkage) -> None:
        self.drawn = drawn
        self.tool: DrawTool = TOOLS[CHOOSE]
        self.snaps: list[Snap] = []
        self.mouse: Snap | None = None
        self.pressed: QPointF | None = None
        self._is_first_press = False

    @property
    def prompt(self) -> str:
        """Text that says what to click next."""
        prompts = self.tool.prompts
        return f"{self.tool.text}: {prompts[min(len(self.snaps), len(prompts) - 1)]}"

    def drop(self) -> None:
        """Discard the clicks."""
        self.snaps, self.pressed, self._is_first_press = [], None, False

    def press(self, event: QMouseEvent) -> None:
        """Begin a click, or a line drawn by dragging."""
        self.pressed = event.position()
        self.mouse = self._snap(event)
        if self.tool.clicks > 1 and not self.snaps:
            self.snaps = [self.mouse]
            self._is_first_press = True
        self.drawn.changed.emit()

    def move(self, event: QMouseEvent) -> None:
        """Follow the mouse."""
        self.mouse = self._snap(event)
        self.drawn.canvas.viewport().update()

    def release(self, event: QMouseEvent) -> None:
        """Add the position to the clicks of the tool, unless this was the first click."""
        pressed, is_first = self.pressed, self._is_first_press
        self.pressed, self._is_first_press = None, False
        if pressed is None:
            return
        if not is_first or (event.position() - pressed).manhattanLength() > DRAG:  # a line may be drawn by one drag
            self.set(self._snap(event))
        else:
            self.drawn.changed.emit()

    def _snap(self, event: QMouseEvent) -> Snap:
        design, positions = self.drawn.layout
        return snap_to(
            design.drive.linkage,
            positions,
            self.drawn.canvas.position_at(event.position()),
            self.drawn.canvas.scale_now,
            start=self.snaps[-1].at if self.snaps else None,
            free=bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier),
            marks=self.drawn.canvas.marks,
            barred=self.barred,
        )

    @property
    def barred(self) -> set[int]:
        """Links that the next click does not join.

        A second point of the link that is being drawn would make both one body; the direction of a line joins nothing.
        """
        linkage = self.drawn.layout[0].drive.linkage
        if self.tool.boxes_at(len(self.snaps)) == DIRECTION:
            return set(linkage.by_number)
        if not self.tool.adds_link:
            return set()
        names = {snap.point for snap in self.snaps if snap.point}
        return links_with(linkage, names) | {snap.link for snap in self.snaps if snap.link is not None}

    def set(self, snap: Snap, length_mm: float | None = None, typed: bool = False) -> bool:
        """Add a position to the clicks of the tool; the last one finishes it."""
        self.snaps = [*filter(self._exists, self.snaps), snap]
        if len(self.snaps) < self.tool.clicks:
            self.drawn.changed.emit()
            return True
        return self.finish(length_mm, typed)

    def _exists(self, snap: Snap) -> bool:
        """Whether the drawing still has the point or link of a click."""
        design, positions = self.drawn.layout
        links = design.drive.linkage.by_number
        return snap.point in positions if snap.point else snap.link in (None, FRAME_LINK, *links)

    def finish(self, length_mm: float | None = None, typed: bool = False) -> bool:
        """Apply the tool to the clicks; False if there are too few, or the edit is not possible."""
        snaps, apply = tuple(self.snaps), self.tool.apply
        if apply is None or len(snaps) < min(self.tool.clicks, 2):
            return False
        design, positions = self.drawn.layout
        drawing = Drawing(design, positions, snaps, length_mm, self.drawn.canvas.scale_now)
        self.snaps = []
        done = self.drawn.apply(partial(apply, drawing))
        if done and typed and self.tool.clicks == 1:
            self.drawn.choose()
        self.drawn.changed.emit()
        return done


# -- selecting and dragging ------------------------------------------------------------------------------


class SelectionInput:
    """Selecting and dragging; ``edit_length`` is called with the link and the points of a clicked length.

    snap    pin that the dragged point joins
    """

    def __init__(self, drawn: DrawnLinkage, edit_length: Callable[[int, str, str], None]) -> None:
        self.drawn, self._edit_length = drawn, edit_length
        self.pressed: QPointF | None = None
        self._dragged = ""  # "", "move", "row", "length", "box"
        self._pixel = QPointF()
        self._grabbed = 0j
        self._moved_from: tuple[Design, PointPositions] | None = None
        self._selected: set[str] = set()  # points before the drag, as one that joins a pin may lose its name
        self.snap: Snap | None = None
        self._before: tuple[object, float] = None, 0.0  # work of the session and cam angle before the drag

    @property
    def box(self) -> QRectF | None:
        """Selection box, in pixels."""
        return (
            None if self._dragged != "box" or self.pressed is None else QRectF(self.pressed, self._pixel).normalized()
        )

    def drop(self) -> None:
        """End the drag; the parts stay where they are."""
        self.pressed, self._dragged, self._moved_from, self.snap = None, "", None, None

    def take_back(self) -> bool:
        """Cancel the drag: the parts go back to their positions; False if nothing is dragged."""
        if self.pressed is None:
            return False
        is_drag = self._moved_from is not None
        self.drop()
        if is_drag:
            work, theta = self._before
            self.drawn.session.end_field_drag("linkage", work)
            self.drawn.player.set_theta(theta)
        self.drawn.changed.emit()
        return True

    def press(self, event: QMouseEvent) -> None:
        """Select the part under the mouse, or begin a selection box."""
        pixel = event.position()
        self.pressed = self._pixel = pixel
        self._grabbed, self._moved_from = self.drawn.canvas.position_at(pixel), None
        more = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if not more and (length := self.drawn.sketch.length_at(pixel)):
            self._dragged = "length"
            self.drawn.choose(links=(length[0],))
            return
        name, row, link = self.drawn.part_at(pixel)
        if not (name or row or link):
            self._dragged = "box"
            if not more:
                self.drawn.choose()
            return
        self._dragged = "row" if row else "move"
        if more:
            self.drawn.choose(
                tuple(self.drawn.points ^ {name} if name else self.drawn.points),
                tuple(self.drawn.links ^ {link} if link else self.drawn.links),
                row,
            )
        elif not (name in self.drawn.points or link in self.drawn.links):
            self.drawn.choose((name,) if name else (), (link,) if link else (), row)

    def move(self, event: QMouseEvent) -> None:
        """Drag the selection, a centre of mass, or the corner of the selection box."""
        self._pixel = event.position()
        if self.pressed is None or self._dragged in ("", "length"):
            return
        if self._dragged == "box":
            self.drawn.canvas.viewport().update()
            return
        if self._moved_from is None:
            if (event.position() - self.pressed).manhattanLength() <= DRAG:
                return
            self._moved_from = self.drawn.layout
            self._selected = {*self.drawn.points}
            self._before = self.drawn.session.work, self.drawn.player.theta
            self.drawn.session.begin_drag(self.drawn.canvas)
        design, positions = self._moved_from
        if self._dragged == "row":
            self._drag_row(design, positions, event)
            return
        linkage = design.drive.linkage
        moved = self._selected | {name for n in self.drawn.links for name in linkage.by_number[n].places}
        names = sorted(moved - self.drawn.locked)
        if not names:
            self.drawn.message.emit(f"Locked: {UNLOCK}")
            return
        canvas = self.drawn.canvas
        at, free = canvas.position_at(event.position()), bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        if len(names) == 1:
            own = {p.name for n in links_with(linkage, names) for p in linkage.by_number[n].points} | {*names}
            snap = snap_to(
                linkage, positions, at, canvas.scale_now, None, own, free, canvas.marks, barred=linkage.by_number
            )
            self.snap, shift = snap if snap.point else None, snap.at - positions[names[0]]
        else:
            shift = _rounded(at - self._grabbed, canvas.scale_now, free)
        targets = {name: positions[name] + shift for name in names}
        text = f"Move {', '.join(names)}"
        self.drawn.apply(partial(self._with_moved, design, targets), text, f"linkage.drawn.{names[0]}")

    def release(self, event: QMouseEvent) -> None:
        """End the drag, select the parts in the box, or edit the clicked length."""
        pressed, dragged = self.pressed, self._dragged
        self.pressed, self._dragged, self.snap = None, "", None
        if pressed is None:
            return
        far = (event.position() - pressed).manhattanLength() > DRAG
        if self._moved_from is not None:
            self._moved_from = None
            self.drawn.session.end_drag()
        if dragged == "length" and not far:
            length = self.drawn.sketch.length_at(event.position())
            if length is not None:
                self._edit_length(*length)
        elif dragged == "box" and far:
            self._choose_in(QRectF(self.drawn.sketch.to(self._grabbed), event.position()).normalized())
        self.drawn.changed.emit()

    def _choose_in(self, box: QRectF) -> None:
        sketch = self.drawn.sketch
        points = {name for name, at in sketch.positions.items() if box.contains(sketch.to(at))}
        links = links_within(sketch.design, points)
        self.drawn.choose(tuple(self.drawn.points | points), tuple(self.drawn.links | links))

    def _with_moved(self, design: Design, targets: PointPositions) -> DrawingEdit:
        """Move points, and keep them selected; raises DesignError if that changes a locked length."""
        moved_design = with_moved(design, targets)
        for lock in (lock for lock in self.drawn.locked if ":" in lock):
            number, first, second = lock.split(":")
            before, after = (d.drive.linkage.by_number.get(int(number)) for d in (design, moved_design))
            if before is None or after is None or not {first, second} <= set(before.places):
                continue
            old, new = (abs(link.places[first] - link.places[second]) for link in (before, after))
            if abs(old - new) > 1e-9:
                raise DesignError([Fault("linkage", lock, f"{first}-{second} is locked", UNLOCK)])
        places = point_positions(moved_design.drive.linkage)
        points = (name if name in places else coincident_point(places, targets[name]) for name in self._selected)
        return DrawingEdit(moved_design, "", tuple(points), tuple(self.drawn.links))

    def _drag_row(self, design: Design, positions: PointPositions, event: QMouseEvent) -> None:
        """Move a centre of mass on its link."""
        if not self.drawn.row.startswith("loads.masses"):
            return
        mass = design.drive.loads.masses[row_index(self.drawn.row)]
        at = snap_to(
            design.drive.linkage,
            positions,
            self.drawn.canvas.position_at(event.position()),
            self.drawn.canvas.scale_now,
        ).at
        origin, axis = link_pose(design.drive.linkage, mass.link, positions)
        local = (at - origin) * axis.conjugate()
        centre = (round(local.real, 3) + 0.0, round(local.imag, 3) + 0.0)
        self.drawn.apply(
            lambda: put(design, f"{self.drawn.row}.centre", centre),
            f"Move centre of mass of link {mass.link}",
            f"{self.drawn.row}.centre_x_mm",
        )


def _rounded(shift: complex, scale: float, free: bool) -> complex:
    """Round the displacement of several points to whole cells of the grid."""
    step = grid_step(scale)
    return shift if free else complex(round(shift.real / step) * step, round(shift.imag / step) * step)
