"""The sheet over the drawing on which a task is drawn: poses pressed and turned, pivots, lines, an area, a path; typed values."""

from __future__ import annotations

import cmath
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from math import degrees
from types import MappingProxyType

import numpy as np
from PySide6.QtCore import QEvent, QObject, QPointF, Qt, Signal
from PySide6.QtGui import QContextMenuEvent, QKeyEvent, QKeySequence, QMouseEvent, QPainter
from PySide6.QtWidgets import QButtonGroup, QHBoxLayout, QLabel, QMenu, QToolButton, QWidget

from core.frozen import frozen
from core.synthesis import PathPoint, Task, TracedPath
from core.synthesis.path_points import stroke_path
from core.synthesis.task import PATH, POSES
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.snapping import POINT, Snap, paint_grid, paint_snap, snap_to_points, snapped_angle
from kindyna_gui.linkage.typed_values import Typed, TypedBoxes
from kindyna_gui.look import described, text_button
from kindyna_gui.pictures.units import typed
from kindyna_gui.rebuilt import add_entry, fill
from kindyna_gui.synthesis import task_parts
from kindyna_gui.synthesis.dyad_points import HINT, DyadPoints
from kindyna_gui.synthesis.sheet_painting import ARM, Positions, SheetPainter, paint_answer, paint_stroke
from kindyna_gui.synthesis.task_parts import (
    AREA,
    LINE,
    MOVE,
    PARTS,
    PIVOT,
    POSE,
    TURN,
    Grip,
    Part,
    dragged,
    grips,
    new_part,
    parts_of,
    position,
)

REACH = 10.0  # distance within which a grip is hit, pixels
DRAG = 4.0  # distance from which on a press is a drag, pixels
LEAST_MM = 20.0  # size of a region that is shown
ROOM = 0.72  # of the canvas, for the task
FIRST_KEYS = "0123456789.-+("  # characters that open the boxes of values
STROKE, POINTS, DYADS = "stroke", "points", "dyads"

# -- tools -------------------------------------------------------------------------------------------------------


@frozen
class SheetTool:
    """A tool of the sheet: its name, which is that of the part it adds; text, tip, and what to do with it."""

    name: str
    text: str
    tip: str
    prompt: str


TOOLS: Mapping[str, tuple[SheetTool, ...]] = MappingProxyType(
    {
        POSES: (
            SheetTool(POSE, "Pose", "Press to put a frame of the body, drag to turn it",
                      "Press and drag: puts a frame of the body and turns it, two to five of them"),
            SheetTool(PIVOT, "Pivot", "Press where a pivot of the linkage is fixed; Shift and a press do this with any tool",
                      "Press: puts a fixed pivot"),
            SheetTool(LINE, "Line", "Drag a line on which a pivot lies", "Press and drag: a line on which a pivot lies"),
            SheetTool(DYADS, "Dyads", "Show the dyads of the poses; click two of them for their linkage", HINT),
            SheetTool(AREA, "Area", "Drag a rectangle in which the fixed pivots lie", "Press and drag: the area of the fixed pivots"),
        ),
        PATH: (
            SheetTool(STROKE, "By hand", "Draw a path in one stroke; near its start it closes",
                      "Draw the path in one stroke; near its start it closes"),
            SheetTool(POINTS, "Points", "Click the points of a path; a double click or Enter ends it, Backspace removes the last",
                      "Click the points of the path; Enter or a double click ends it, a click on the first point closes it"),
        ),
    }
)  # fmt: skip
"""Kind of task -> its tools; others are not drawn."""
NOT_DRAWN = "This task is typed in the dock; its linkages move here"


class SheetBar(QWidget):
    """The tools of the sheet, and what to do with the current one. Signal: ``chosen`` with the name of a tool."""

    chosen = Signal(str)

    def __init__(self) -> None:
        super().__init__()
        self.buttons: dict[str, QToolButton] = {}
        self._group = QButtonGroup(self)
        row = fill(QHBoxLayout(self), margins=(4, 1, 4, 1), spacing=2)
        for tools in TOOLS.values():
            for tool in tools:
                button = described(text_button(tool.text, checks=True, flat=True), name=tool.text, tip=tool.tip)
                button.clicked.connect(partial(lambda name, *_: self.chosen.emit(name), tool.name))
                self._group.addButton(button)
                self.buttons[tool.name] = button
                row.addWidget(button)
        self.prompt = QLabel()
        self.prompt.setMinimumWidth(1)
        row.addSpacing(8)
        row.addWidget(self.prompt, 1)
        self.setMinimumHeight(self.sizeHint().height())

    def show_kind(self, kind: str) -> None:
        """Show the tools of a kind of task."""
        names = {tool.name for tool in TOOLS.get(kind, ())}
        for name, button in self.buttons.items():
            button.setVisible(name in names)

    def show_tool(self, tool: SheetTool | None) -> None:
        """Show which tool is chosen; None: there is none."""
        if tool is not None:
            self.buttons[tool.name].setChecked(True)
        self.prompt.setText(tool.prompt if tool is not None else NOT_DRAWN)
        self.prompt.setToolTip(self.prompt.text())


# -- the sheet ---------------------------------------------------------------------------------------------------


class TaskSheet(QObject):
    """A task drawn with the mouse over the drawing of the mechanism, and the points of an answer.

    A press on a part drags it, at the end of its arm turns it; a press elsewhere uses the tool. Ctrl leaves grid, points and
    angles. A digit opens the boxes of the selected part, or of a new one. Delete removes the selected part, Esc takes a drag back.

    Attributes
    ----------
    task : Task
    selected : Part or None
    marks : callable
        Names and positions [mm] of other points to which the mouse snaps.

    Signals: ``changed`` (Task) when the user has edited it, ``released`` after a drag, ``undone`` for Ctrl+Z, ``left`` when Esc has
    nothing else to end.
    """

    changed = Signal(object)
    released = Signal()
    undone = Signal()
    left = Signal()

    def __init__(self, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self.task = Task(kind=POSES)
        self.selected: Part | None = None
        self.bar = SheetBar()
        self.bar.chosen.connect(self.choose_tool)
        self.marks: Callable[[], Mapping[str, complex]] = dict
        self.tool: SheetTool | None = TOOLS[POSES][0]
        self.dyads = DyadPoints(self)
        self.dyads.changed.connect(self._update)
        self.canvas: Canvas | None = None
        self._boxes: TypedBoxes | None = None
        self._grip: Grip | None = None
        self._before: Task | None = None  # at the press
        self._pressed = QPointF()
        self._offset = 0j  # from the mouse to the grip [mm]
        self._is_far = False  # whether the mouse has been dragged
        self._stroke: list[complex] = []
        self._adds_points = False
        self._snap: Snap | None = None
        self._mouse = QPointF()
        self._answer: Positions = {}
        self._step = 0
        self._show_tool()

    # -- on the canvas ------------------------------------------------------------------------------------

    def start(self, canvas: Canvas) -> None:
        """Take the mouse and the keys of a canvas."""
        if self.canvas is not canvas:
            self.canvas = canvas
            self._boxes = TypedBoxes(canvas.viewport(), canvas)
        canvas.viewport().installEventFilter(self)
        canvas.installEventFilter(self)
        canvas.setCursor(Qt.CursorShape.CrossCursor)
        canvas.setFocus()

    def stop(self) -> None:
        """Give mouse and keys back."""
        if self.canvas is None or self._boxes is None:
            return
        self._boxes.close_all()
        self._end_drag()
        self.canvas.viewport().removeEventFilter(self)
        self.canvas.removeEventFilter(self)
        self.canvas.setCursor(Qt.CursorShape.ArrowCursor)

    def leave(self) -> None:
        """Ask to be removed: the drawing is needed for something else."""
        self.left.emit()

    def _update(self) -> None:
        if self.canvas is not None:
            self.canvas.viewport().update()

    @property
    def is_dragging(self) -> bool:
        """Whether the mouse is dragging a part."""
        return self._grip is not None or bool(self._stroke)

    @property
    def adds_points(self) -> bool:
        """Whether the points of a path are being clicked."""
        return self._adds_points

    # -- contents -----------------------------------------------------------------------------------------

    def show_task(self, task: Task) -> None:
        """Show a task."""
        is_other_kind = task.kind != self.task.kind
        self.task = task
        parts = tuple(parts_of(task))
        if self.selected not in parts:
            self.selected = None
        if self._grip is not None and self._grip.part not in parts:
            self._grip = None  # what the mouse dragged is gone
        if is_other_kind:
            self._adds_points = False
            self.tool = next(iter(TOOLS.get(task.kind, ())), None)
            self._show_tool()
        self._update()

    def choose_tool(self, name: str) -> None:
        """Change to a tool of the present kind of task."""
        self.tool = next((tool for tool in TOOLS.get(self.task.kind, ()) if tool.name == name), None)
        self._adds_points, self.selected = False, None
        self._show_tool()
        self._update()

    def _show_tool(self) -> None:
        self.bar.show_kind(self.task.kind)
        self.bar.show_tool(self.tool)

    def show_answer(self, positions: Positions) -> None:
        """Show the points (n,) [mm] of an answer, as of ``joint_positions``; none where the mapping is empty."""
        self._answer = positions
        self._update()

    def show_step(self, step: int) -> None:
        """Show the answer at another of its positions."""
        self._step = step
        if self._answer:
            self._update()

    def fit(self) -> None:
        """Show the full task, and the answer."""
        if self.canvas is None:
            return
        z = [position(self.task, part) for part in parts_of(self.task)]
        if self.task.kind == POSES and self.task.area is not None:
            z += task_parts.corners(self.task.area).values()
        z += [dyad.fixed for dyad in self.dyads.dyads] if self._shows_dyads else []
        z += [complex(p) for positions in self._answer.values() for p in positions[:: max(1, positions.size // 24)]]
        z = z or [*self.marks().values()] or [0j]
        x, y = [p.real for p in z], [p.imag for p in z]
        wide, high = max(max(x) - min(x), LEAST_MM), max(max(y) - min(y), LEAST_MM)
        viewport = self.canvas.viewport()
        scale = ROOM * min(viewport.width() / wide, viewport.height() / high)
        self.canvas.show_region(QPointF(0.5 * (max(x) + min(x)), 0.5 * (max(y) + min(y))), max(scale, 1e-3))
        self.canvas.fitted = False

    # -- places -------------------------------------------------------------------------------------------

    def pixel(self, z: complex) -> QPointF:
        """Pixel of a position [mm]."""
        assert self.canvas is not None
        return self.canvas.pixel_at(z)

    def grip_at(self, point: QPointF) -> Grip | None:
        """What is under the mouse and can be dragged; an area also at its border."""
        canvas = self.canvas
        assert canvas is not None
        scale, at = canvas.scale_now, canvas.position_at(point)
        near = [(abs(grip.at - at) * scale, i, grip) for i, grip in enumerate(grips(self.task, ARM / scale))]
        distance, _, grip = min(near, default=(REACH + 1.0, 0, None))
        if distance <= REACH:
            return grip
        area = self.task.area if self.task.kind == POSES else None
        if area is not None:
            x = at.real - area.low_x_mm, area.high_x_mm - at.real
            y = at.imag - area.low_y_mm, area.high_y_mm - at.imag
            if min(*x, *y) * scale >= -0.5 * REACH and min(map(abs, (*x, *y))) * scale <= 0.5 * REACH:
                return Grip(Part(AREA), MOVE, complex(area.low_x_mm, area.low_y_mm))
        return None

    @property
    def _shows_dyads(self) -> bool:
        return self.tool is not None and self.tool.name == DYADS

    def _dyad_at(self, point: QPointF) -> bool:
        """Whether a press would choose a dyad."""
        return (
            self._shows_dyads
            and self.canvas is not None
            and self.dyads.dyad_at(point, self.canvas.pixel_at) is not None
        )

    def _snap_at(self, point: QPointF, free: bool, start: complex | None = None) -> Snap:
        """Snap of the mouse to other parts, to the joints of the mechanism, to the underlay, and to the grid."""
        canvas = self.canvas
        assert canvas is not None
        dragged = None if self._grip is None else self._grip.part
        points = {
            f"{part.kind} {part.index + 1}": position(self.task, part)
            for part in parts_of(self.task)
            if part != dragged and part.kind != AREA
        }
        at = canvas.position_at(point) + self._offset
        return snap_to_points({**self.marks(), **points}, at, canvas.scale_now, start, free, canvas.marks)

    # -- mouse --------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        if watched is self.canvas and isinstance(event, QKeyEvent):
            if event.type() == QEvent.Type.ShortcutOverride and event.matches(QKeySequence.StandardKey.Undo):
                event.accept()  # else the window would undo an edit of the design, which is hidden below the sheet
                return True
            return event.type() == QEvent.Type.KeyPress and self._key(event)
        if isinstance(event, QContextMenuEvent):
            self._open_menu(event)
            return True
        if not isinstance(event, QMouseEvent):
            if event.type() == QEvent.Type.Leave:
                self._snap = None
                self._update()
            return False
        kind, is_left = event.type(), event.button() == Qt.MouseButton.LeftButton
        if kind == QEvent.Type.MouseMove:
            if event.buttons() & ~Qt.MouseButton.LeftButton:
                return False
            self._move(event)
        elif is_left and kind == QEvent.Type.MouseButtonDblClick and self._adds_points:
            self._end_points()
        elif is_left and kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick):
            self._press(event)
        elif is_left and kind == QEvent.Type.MouseButtonRelease:
            self._release()
        else:
            return False
        return True

    def _press(self, event: QMouseEvent) -> None:
        assert self.canvas is not None
        assert self._boxes is not None
        self.canvas.setFocus()
        self._boxes.close_all()
        self._mouse = self._pressed = event.position()
        self._before, self._is_far, self._offset = self.task, False, 0j
        is_shift = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        grip = None if is_shift or self._dyad_at(event.position()) else self.grip_at(event.position())
        if grip is not None and self._adds_points and grip.part.index == 0 and len(self._points) > 2:
            self._end_points(closed=True)
        elif grip is not None:
            self._grip, self.selected = grip, grip.part
            self._offset = grip.at - self.canvas.position_at(event.position())
        elif self._shows_dyads:
            self.selected = None
            self.dyads.click(event.position(), self.canvas.pixel_at)
        elif self.tool is not None and self.tool.name == STROKE:
            self._stroke = [self.canvas.position_at(event.position())]
        else:
            name = PIVOT if is_shift and self.task.kind == POSES else self.tool.name if self.tool is not None else ""
            self._add(name, self._snap_at(event.position(), _is_free(event)).at)
        self._update()

    def _add(self, name: str, at: complex) -> None:
        """Add the part of a tool, which the mouse drags on."""
        task = self.task
        if name == POINTS:
            if not self._adds_points:
                task = _with_path(task, TracedPath())
            self._adds_points, name = True, task_parts.POINT
        part = new_part(task, name) if name in PARTS else None
        self.selected = part
        if part is None:
            return
        values = [at.real, at.imag]
        if name == POSE:
            values.append(task.poses[-1].angle_deg if task.poses else 0.0)
        elif name == LINE:
            values.append(0.0)
        elif name == AREA:
            values *= 2
        self._set(PARTS[name].put(task, part.index, values))
        self._grip = Grip(part, {POSE: TURN, LINE: TURN, AREA: "high right"}.get(name, MOVE), at)

    def _move(self, event: QMouseEvent) -> None:
        self._mouse = event.position()
        free = _is_free(event)
        if self._stroke and self.canvas is not None:
            self._stroke.append(self.canvas.position_at(event.position()))
        elif self._grip is not None:
            self._is_far = self._is_far or (event.position() - self._pressed).manhattanLength() > DRAG
            if self._is_far:
                self._drag(self._grip, event, free)
        else:
            self._hover(event, free)
        self._update()

    def _drag(self, grip: Grip, event: QMouseEvent, free: bool) -> None:
        """Move or turn the part under the mouse."""
        assert self.canvas is not None
        if grip.action != TURN:
            self._snap = self._snap_at(event.position(), free)
            self._set(dragged(self.task, grip, self._snap.at))
            return
        centre = position(self.task, grip.part)
        snap = self._snap_at(event.position(), free)
        at = self.canvas.position_at(event.position()) + self._offset
        if snap.mark == POINT and snap.at != centre:  # the arm points exactly to another point
            self._snap, angle = snap, degrees(cmath.phase(snap.at - centre))
        elif at != centre:
            angle = snapped_angle(centre, at, self.canvas.scale_now, free)
            self._snap = Snap(at, "", f"{typed(angle)}°")
        else:
            return
        self._set(dragged(self.task, grip, snap.at, angle))

    def _hover(self, event: QMouseEvent, free: bool) -> None:
        """Show what a press would drag, or where it would put something."""
        assert self.canvas is not None
        if self._shows_dyads:
            self.dyads.hover(event.position(), self.canvas.pixel_at)
        over = self._dyad_at(event.position()) or self.grip_at(event.position())
        draws = self.tool is not None and self.tool.name not in (STROKE, DYADS)
        self._snap = self._snap_at(event.position(), free) if over is None and draws else None
        shape = Qt.CursorShape.SizeAllCursor if over is not None else Qt.CursorShape.CrossCursor
        if self.canvas.cursor().shape() != shape:
            self.canvas.setCursor(shape)

    def _release(self) -> None:
        if self._stroke:
            path, self._stroke = stroke_path(np.array(self._stroke)), []
            if path is not None:
                self._set(_with_path(self.task, path))
        self._end_drag()

    def _end_drag(self) -> None:
        """End a drag; an area that was only clicked is none, and a line without a drag is horizontal."""
        was_dragging, self._grip, self._stroke, self._snap = self.is_dragging, None, [], None
        self._offset = 0j
        if self.task.kind == POSES and self.task.area is not None:
            task = task_parts.upright(self.task)
            area = task.area
            if area is not None and (area.low_x_mm == area.high_x_mm or area.low_y_mm == area.high_y_mm):
                self.selected, task = None, replace(task, area=self._before.area if self._before is not None else None)
            if task != self.task:
                self._set(task)
        if was_dragging:
            self.released.emit()
        self._update()

    def _set(self, task: Task) -> None:
        """Show another task, which the user has edited."""
        if task != self.task:
            self.task = task
            self.changed.emit(task)
        self._update()

    # -- points of a path ---------------------------------------------------------------------------------

    @property
    def _points(self) -> Sequence[PathPoint]:
        return self.task.path.points if self.task.path is not None else ()

    def _end_points(self, closed: bool = False) -> None:
        """End the path that is being clicked."""
        self._adds_points, self._grip = False, None
        if closed and self.task.path is not None:
            self._set(_with_path(self.task, TracedPath(points=self.task.path.points, closed=True)))
        self.released.emit()
        self._update()

    # -- keys ---------------------------------------------------------------------------------------------

    def _key(self, event: QKeyEvent) -> bool:
        key, text = event.key(), event.text()
        plain = not event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        if event.matches(QKeySequence.StandardKey.Undo):
            self.undone.emit()
        elif key == Qt.Key.Key_Escape:
            self._escape()
        elif key in (Qt.Key.Key_Return, Qt.Key.Key_Enter) and self._adds_points:
            self._end_points()
        elif key == Qt.Key.Key_Backspace and self._adds_points and self._points:
            self._set(PARTS[task_parts.POINT].remove(self.task, len(self._points) - 1))
        elif key in (Qt.Key.Key_Delete, Qt.Key.Key_Backspace) and self.selected is not None:
            self.remove(self.selected)
        elif text and text in FIRST_KEYS and plain:
            self._type(text)
        else:
            return False
        return True

    def _escape(self) -> None:
        """Take a drag back, else end the points of a path, else clear the selection, else leave the sheet."""
        if self.is_dragging and self._before is not None:
            before, self._grip = self._before, None
            self._stroke, self._snap = [], None
            self._set(before)
            self.released.emit()
        elif self._adds_points:
            self._end_points()
        elif self._shows_dyads and self.dyads.release():
            pass
        elif self.selected is not None:
            self.selected = None
            self._update()
        else:
            self.leave()

    def remove(self, part: Part) -> None:
        """Remove a part."""
        self._grip, self.selected = None, None
        self._set(PARTS[part.kind].remove(self.task, part.index))
        self.released.emit()

    # -- typed values -------------------------------------------------------------------------------------

    def _type(self, text: str = "") -> None:
        """Open the boxes of the selected part, else of a part that the tool would add."""
        tool = {POINTS: task_parts.POINT}.get(self.tool.name, self.tool.name) if self.tool is not None else ""
        part = self.selected or (new_part(self.task, tool) if tool in PARTS else None)
        if part is None or self._boxes is None:
            return
        is_new = part not in tuple(parts_of(self.task))
        self._end_drag()
        boxes = PARTS[part.kind].boxes
        self._boxes.ask(self._mouse.toPoint(), boxes, partial(self._accept, part, is_new), text)

    def _accept(self, part: Part, is_new: bool, values: Sequence[Typed]) -> str:
        """Set the typed values of a part; an empty box leaves its value."""
        kind = PARTS[part.kind]
        numbers: Sequence[float] = [0.0] * len(kind.boxes) if is_new else kind.values(self.task, part.index)
        numbers = [value if isinstance(value, float) else number for value, number in zip(values, numbers, strict=True)]
        task = kind.put(self.task, part.index, numbers)
        area = task.area if part.kind == AREA else None
        if area is not None and not (area.low_x_mm < area.high_x_mm and area.low_y_mm < area.high_y_mm):
            return "the bounds are reversed; allowed: lowest x < highest x, lowest y < highest y"
        self.selected = part
        self._set(task)
        self.released.emit()
        return ""

    # -- context menu -------------------------------------------------------------------------------------

    def _open_menu(self, event: QContextMenuEvent) -> None:
        self._mouse = QPointF(event.pos())
        grip = self.grip_at(self._mouse)
        menu = QMenu(self.canvas)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        if grip is not None:
            self.selected = grip.part
            add_entry(menu, "Type its values...", self._type, "Type its coordinates")
            if grip.part.kind in (PIVOT, LINE):
                self._add_pivot_entries(menu, grip.part)
            add_entry(menu, "Remove", partial(self.remove, grip.part), "Remove this part of the task")
        add_entry(menu, "Fit", self.fit, "Show the full task")
        self._update()
        menu.popup(event.globalPos())

    def _add_pivot_entries(self, menu: QMenu, part: Part) -> None:
        """Add the entries that say to which dyad a pivot belongs, and whether it is fixed."""
        for text, change in task_parts.PIVOT_CHANGES.items():
            task = change(self.task, part.index)
            if task != self.task:
                add_entry(menu, text, partial(self._change, task), "Change what this pivot belongs to")

    def _change(self, task: Task) -> None:
        self._set(task)
        self.released.emit()

    # -- painting -----------------------------------------------------------------------------------------

    def paint(self, painter: QPainter) -> None:
        """Paint the grid, the task, an answer, and the mark of the mouse; in pixels."""
        canvas = self.canvas
        assert canvas is not None
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        paint_grid(painter, canvas.pixel_at, canvas.scale_now, canvas.visible)
        if self._answer:
            paint_answer(painter, canvas.viewportTransform(), self._answer, self._step)
        SheetPainter(canvas.pixel_at, canvas.visible, self.selected).paint(painter, self.task)
        if self._shows_dyads:
            self.dyads.paint(painter, canvas.pixel_at, canvas.visible)
        if self._stroke:
            paint_stroke(painter, canvas.pixel_at, self._stroke)
        if self._adds_points and self._snap is not None and self._points and self._grip is None:
            last = self._points[-1]
            paint_snap(painter, canvas.pixel_at, self._snap, complex(last.x_mm, last.y_mm))
        elif self._snap is not None:
            paint_snap(painter, canvas.pixel_at, self._snap)


def _is_free(event: QMouseEvent) -> bool:
    return bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)


def _with_path(task: Task, path: TracedPath) -> Task:
    return replace(task, path=path)
