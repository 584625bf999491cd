"""Drawing mode: the tool strip, and what mouse and keys do on the canvas while a linkage is drawn."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPointF, QSize, Qt, Signal
from PySide6.QtGui import QAction, QActionGroup, QColor, QKeyEvent, QKeySequence, QMouseEvent, QPainter, QPen
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QVBoxLayout, QWidget

from kindyna_gui.documents.session import Session
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.draw_tools import CHOOSE, MANY, TOOLS, DrawTool
from kindyna_gui.linkage.drawing_actions import ACTIONS, DrawingAction, SelectionActions
from kindyna_gui.linkage.drawing_mouse import SelectionInput, ToolInput
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage
from kindyna_gui.linkage.linkage_sketch import Highlights
from kindyna_gui.linkage.point_paths import PointPaths
from kindyna_gui.linkage.snapping import Snap, paint_grid, paint_snap, snap_to
from kindyna_gui.linkage.typed_values import TypedValues
from kindyna_gui.look import SteadyText, icon, tool_bar
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player
from kindyna_gui.rebuilt import connect_all, fill

EMPTY_WIDTH_MM = 260.0  # visible width of an empty drawing
_FIRST = "0123456789.-+("  # characters that open the input boxes
_HERE = {
    "bar": "Attach a bar",
    "plate": "Attach a plate",
    "ground": "Ground",
    "point": "Trace a point",
    "driver": "Drive",
    "gear": "Drive by a ratio",
}
MENU_TOOLS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "point": ("bar", "plate", "slider", "slider_on", "ground", "driver", "gear", "force", "spring", "roller"),
        "link": ("bar", "point", "ground", "driver", "gear", "mass", "force", "spring"),
        "row": (),
        "canvas": ("bar", "plate", "ground", "slider", "pin"),
    }
)
"""Kind of part under the mouse -> tools that its menu offers."""

# -- tool strip ------------------------------------------------------------------------------------------


class DrawBar(QWidget):
    """The tool strip over the drawing, with what to click next, and below it what the drawing lacks."""

    def __init__(self, actions: Sequence[QAction]) -> None:
        super().__init__()
        self.tools = tool_bar("Draw", self)
        self.tools.setIconSize(QSize(20, 20))
        for action in actions:
            self.tools.addAction(action)
        self.prompt = QLabel()
        self.state = SteadyText()
        row = fill(QHBoxLayout(), self.tools, (self.prompt, 1), margins=0)
        self.prompt.setMinimumWidth(1)
        fill(QVBoxLayout(self), row, self.state, margins=(4, 1, 4, 2), spacing=1)
        self.hide()


# -- drawing mode ----------------------------------------------------------------------------------------


class DrawingMode(DrawnLinkage):
    """Drawing with mouse and keys on the canvas.

    switched  (on): the mode has started or ended
    """

    switched = Signal(bool)

    def __init__(self, canvas: Canvas, session: Session, player: Player, paths: PointPaths, owner: QWidget) -> None:
        super().__init__(canvas, session, player, owner)
        self.paths = paths
        self.tool_input = ToolInput(self)
        self.typed = TypedValues(self, self.tool_input)
        self.selection_input = SelectionInput(self, self.typed.ask_length)
        self.group = QActionGroup(self)
        self.group.setObjectName("Draw")
        self.tools = {name: self._tool_action(tool, owner) for name, tool in TOOLS.items()}
        edits = SelectionActions(self, self.typed, paths)
        self.actions = {row.name: self._menu_action(row, edits, owner) for row in ACTIONS}
        self.bar = DrawBar(list(self.tools.values()))
        connect_all(
            (self.changed, self.refresh),
            (session.started, self.forget),
            (session.drive_chosen, self.forget),
            (session.restored, self._prune),
            (paths.changed, self.refresh),
        )

    def _tool_action(self, tool: DrawTool, owner: QWidget) -> QAction:
        action = QAction(icon(f"draw_{tool.name}"), tool.text, owner, checkable=True, checked=tool.name == CHOOSE)
        action.setToolTip(f"{tool.text} ({tool.key}): {tool.tip}")
        action.triggered.connect(partial(self.choose_tool, tool.name))
        self.group.addAction(action)
        return _added(action, f"draw:{tool.name}", tool, owner)

    def _menu_action(self, row: DrawingAction, edits: SelectionActions, owner: QWidget) -> QAction:
        action = QAction(row.text, owner)
        action.triggered.connect(lambda *_: row.run(edits))
        action.setCheckable(row.name == "path")
        return _added(action, f"deed:{row.name}", row, owner)

    @property
    def tool(self) -> DrawTool:
        """The current tool."""
        return self.tool_input.tool

    @property
    def snap(self) -> Snap | None:
        """Position that the mouse snaps to; None if its point has moved since."""
        mouse = self.tool_input.mouse
        has_moved = mouse is not None and mouse.point and self.layout[1].get(mouse.point) != mouse.at
        return None if has_moved else mouse

    # -- start, stop, refresh ---------------------------------------------------------------------------------

    def start(self, tool: str = CHOOSE) -> None:
        """Start drawing."""
        if not self.active:
            self.active = True
            self.player.play(False)
            self.canvas.viewport().installEventFilter(self)
            self.canvas.installEventFilter(self)
            self._enable_actions(True)
            self.bar.show()
            self.switched.emit(True)
        self.choose_tool(tool)
        self.canvas.setFocus()

    def stop(self) -> None:
        """End drawing; the running machine is shown again."""
        if self.active:
            self.active = False
            self.typed.boxes.close_all()
            self.forget()
            self.canvas.viewport().removeEventFilter(self)
            self.canvas.removeEventFilter(self)
            self._enable_actions(False)
            self.bar.hide()
            self.canvas.setCursor(Qt.CursorShape.ArrowCursor)
            self.switched.emit(False)

    def _enable_actions(self, on: bool) -> None:
        for action in (*self.tools.values(), *self.actions.values()):
            action.setEnabled(on)

    def choose_tool(self, name: str, *_: object) -> None:
        """Change to one of ``TOOLS``."""
        self.tool_input.tool, self.tool_input.snaps = TOOLS[name], []
        self.tools[name].setChecked(True)
        if name != CHOOSE:
            self.choose()
        self.canvas.setCursor(Qt.CursorShape.ArrowCursor if name == CHOOSE else Qt.CursorShape.CrossCursor)
        self.refresh()

    def forget(self) -> None:
        """Clear the selection, the clicks and the locks."""
        self.tool_input.drop()
        self.selection_input.drop()
        self.locked.clear()
        self.clear_layout()
        self.choose()

    def _prune(self) -> None:
        """Remove parts that no longer exist from the selection."""
        self.tool_input.snaps = []
        self.typed.boxes.close_all()
        self.choose(tuple(self.points), tuple(self.links), self.row)

    def refresh(self) -> None:
        """Update strip and canvas after a change; end drawing in a design without links."""
        if self.active and not self.session.typed.drive.links:
            self.stop()
        self.bar.prompt.setText(self.tool_input.prompt)
        if self.active:
            self.bar.state.show_text(self.state_text())
        self.canvas.viewport().update()

    # -- painting -----------------------------------------------------------------------------------------------

    @property
    def highlights(self) -> Highlights:
        """Parts to highlight: the selection, what is wrong, and what is locked."""
        wrong = self.mobility if self.tool_input.snaps == [] and len(self.layout[1]) > 2 else None
        return Highlights(
            self.points,
            self.links,
            self.row,
            wrong_points=wrong.points if wrong else (),
            wrong_links=wrong.overconstrained if wrong else (),
            locked=self.locked,
        )

    def paint(self, painter: QPainter) -> None:
        """Paint the drawing over the scene; links that do not follow the driver are grey."""
        painter.fillRect(self.canvas.viewport().rect(), QColor(SCREEN.paper))
        self.canvas.paint_under(painter)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        sketch = self.sketch
        if self.active:
            paint_grid(painter, sketch.to, sketch.scale, self.canvas.visible)
        sketch.paint(painter, self.highlights, dimensions=self.active, grey=self.static_links)
        for path in self.paths.drawn().values():
            sketch.paint_path(painter, path.positions, path.is_driven)
        if not self.active:
            return
        if (box := self.selection_input.box) is not None:
            painter.setPen(QPen(QColor(SCREEN.chosen), 1.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(box)
        for first, second in zip(self.tool_input.snaps, self.tool_input.snaps[1:], strict=False):
            painter.setPen(QPen(QColor(SCREEN.chosen), 2.0))
            painter.drawLine(sketch.to(first.at), sketch.to(second.at))
        snap = self.selection_input.snap if self.tool.name == CHOOSE else self.snap
        if snap is not None:
            paint_snap(painter, sketch.to, snap, self.tool_input.snaps[-1].at if self.tool_input.snaps else None)

    def fit(self) -> None:
        """Show the whole drawing; an empty one with the width of a small machine."""
        _, positions = self.layout
        wide, high = max(1, self.canvas.viewport().width()), max(1, self.canvas.viewport().height())
        if len(positions) < 2:
            middle = next(iter(positions.values()), 0j)
            self.canvas.show_region(QPointF(middle.real, middle.imag), wide / EMPTY_WIDTH_MM)
        else:
            x, y = [at.real for at in positions.values()], [at.imag for at in positions.values()]
            scale = 0.7 * min(wide / max(max(x) - min(x), 1e-6), high / max(max(y) - min(y), 1e-6))
            self.canvas.show_region(QPointF(0.5 * (min(x) + max(x)), 0.5 * (min(y) + max(y))), scale)
        self.canvas.fitted = False

    # -- mouse and keys -----------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        kind = event.type()
        if watched is self.canvas:
            return kind == QEvent.Type.KeyPress and isinstance(event, QKeyEvent) and self._key(event)
        if isinstance(event, QMouseEvent):
            return self._mouse_event(event)
        if kind == QEvent.Type.ContextMenu:
            self.open_menu(event.pos(), event.globalPos())  # type: ignore[attr-defined]
            return True
        if kind == QEvent.Type.Leave and self.tool_input.mouse is not None:
            self.tool_input.mouse = None
            self.canvas.viewport().update()
        return False

    def _mouse_event(self, event: QMouseEvent) -> bool:
        kind, left = event.type(), event.button() == Qt.MouseButton.LeftButton
        mouse_input = self.selection_input if self.tool.name == CHOOSE else self.tool_input
        if kind == QEvent.Type.MouseMove:
            self.typed.at = event.position().toPoint()
            if mouse_input.pressed is None and event.buttons():
                return False
            if mouse_input is self.selection_input or not self.typed.boxes.open:
                mouse_input.move(event)
            return True
        if left and kind == QEvent.Type.MouseButtonDblClick and self.tool.clicks == MANY:
            self.tool_input.finish()
            return True
        if left and kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick):
            self.canvas.setFocus()
            self.typed.boxes.close_all()
            self.typed.at = event.position().toPoint()
            mouse_input.press(event)
            return True
        if left and kind == QEvent.Type.MouseButtonRelease:
            mouse_input.release(event)
            return True
        return False

    def _key(self, event: QKeyEvent) -> bool:
        if event.key() == Qt.Key.Key_Escape:
            self.escape()
            return True
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            if self.tool.clicks == MANY and len(self.tool_input.snaps) > 1:
                self.tool_input.finish()
            return True
        text = event.text()
        plain = not event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        if text and text in _FIRST and plain:
            self.typed.type_first(text)
            return True
        return False

    def escape(self) -> None:
        """Cancel the drag or the clicks, else put the tool away, else end drawing."""
        if self.selection_input.take_back():
            return
        if self.tool_input.snaps:
            self.tool_input.snaps = []
            self.refresh()
        elif self.tool.name != CHOOSE:
            self.choose_tool(CHOOSE)
        else:
            self.stop()

    # -- context menu -------------------------------------------------------------------------------------------

    def open_menu(self, pixel: Any, globally: Any) -> None:
        """Open the context menu at a pixel of the canvas."""
        menu = self.menu_at(QPointF(pixel))
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(globally)

    def menu_at(self, pixel: QPointF) -> QMenu:
        """Build the context menu of a pixel: tools that start there, and actions on the part under it."""
        self.typed.at = pixel.toPoint()
        name, row, link = self.part_at(pixel)
        kind = "point" if name else "row" if row else "link" if link else "canvas"
        if name and name not in self.points:
            self.choose((name,))
        elif row:
            self.choose(row=row)
        elif link and link not in self.links:
            self.choose(links=(link,))
        menu = QMenu(self.canvas)
        design, positions = self.layout
        at, scale = self.canvas.position_at(pixel), self.canvas.scale_now
        snap = snap_to(design.drive.linkage, positions, at, scale, marks=self.canvas.marks)
        for tool in MENU_TOOLS[kind]:
            action = menu.addAction(icon(f"draw_{tool}"), _HERE.get(tool, f"{TOOLS[tool].text} here"))
            action.triggered.connect(partial(self._start_here, tool, snap))
        menu.addSeparator()
        for drawing_action in ACTIONS:
            if kind in drawing_action.kinds:
                action = self.actions[drawing_action.name]
                menu.addAction(action)
                if action.isCheckable():
                    action.setChecked(bool(name) and self.paths.is_shown(name))
        return menu

    def _start_here(self, tool: str, snap: Snap, *_: object) -> None:
        """Start a tool with its first click."""
        self.choose_tool(tool)
        self.tool_input.mouse = snap
        self.tool_input.set(snap)


def _added(action: QAction, name: str, row: DrawTool | DrawingAction, owner: QWidget) -> QAction:
    """Add the action of a tool or a menu row to its widget, disabled until drawing starts."""
    action.setObjectName(name)
    action.setShortcut(QKeySequence(row.key))
    action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
    action.setStatusTip(row.tip)
    action.setEnabled(False)
    owner.addAction(action)
    return action
