"""Drawing mode."""

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
from kindyna_gui.linkage.choosing import Choosing, Stroke
from kindyna_gui.linkage.draw_tools import CHOOSE, MANY, TOOLS, DrawTool, Snap, point_at, snapped
from kindyna_gui.linkage.drawing_deeds import DEEDS, Deed, Deeds
from kindyna_gui.linkage.drawn_linkage import DrawnLinkage
from kindyna_gui.linkage.sketch_picture import Marked
from kindyna_gui.linkage.typed_values import TypedValues
from kindyna_gui.look import SteadyText, icon, tool_bar
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.player import Player

# -- the strip of the drawing tools ----------------------------------------------------------------------


class DrawBar(QWidget):
    """The strip of tools over the drawing, and below them what the drawing lacks and what is to be clicked."""

    def __init__(self, actions: Sequence[QAction]) -> None:
        super().__init__()
        self.tools = tool_bar("Draw", self)
        self.tools.setIconSize(QSize(20, 20))
        for action in actions:
            self.tools.addAction(action)
        self.prompt = QLabel()
        self.state = SteadyText()
        row = QHBoxLayout()
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self.tools)
        row.addWidget(self.prompt, 1)
        self.prompt.setMinimumWidth(1)
        column = QVBoxLayout(self)
        column.setContentsMargins(4, 1, 4, 2)
        column.setSpacing(1)
        column.addLayout(row)
        column.addWidget(self.state)
        self.hide()


# -- drawing mode ----------------------------------------------------------------------------------------

SHEET_MM = 260.0  # width of an empty sheet
_FIRST = "0123456789.-+("


class DrawingMode(DrawnLinkage):
    """What the mouse and the keys do on the canvas while a linkage is drawn.

    switched  (on): the mode has begun, or ended
    """

    switched = Signal(bool)

    def __init__(self, canvas: Canvas, session: Session, player: Player, owner: QWidget) -> None:
        super().__init__(canvas, session, player, owner)
        self.stroke = Stroke(self)
        self.typed = TypedValues(self, self.stroke)
        self.choosing = Choosing(self, self.typed.ask_length)
        self.group = QActionGroup(self)
        self.group.setObjectName("Draw")
        self.tools = {name: self._tool_action(tool, owner) for name, tool in TOOLS.items()}
        done = Deeds(self, self.typed)
        self.deeds = {row.name: self._deed_action(row, done, owner) for row in DEEDS}
        self.bar = DrawBar(list(self.tools.values()))
        self.changed.connect(self.refresh)
        session.started.connect(self.forget)
        session.drive_chosen.connect(self.forget)
        session.restored.connect(self._prune)

    def _tool_action(self, tool: DrawTool, owner: QWidget) -> QAction:
        action = QAction(icon(f"draw_{tool.name}"), tool.text, owner, checkable=True, checked=tool.name == CHOOSE)
        action.setObjectName(f"draw:{tool.name}")
        action.setShortcut(QKeySequence(tool.key))
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        action.setToolTip(f"{tool.text} ({tool.key}): {tool.tip}")
        action.setStatusTip(tool.tip)
        action.setEnabled(False)
        action.triggered.connect(partial(self.choose_tool, tool.name))
        self.group.addAction(action)
        owner.addAction(action)
        return action

    def _deed_action(self, row: Deed, done: Deeds, owner: QWidget) -> QAction:
        action = QAction(row.text, owner)
        action.setObjectName(f"deed:{row.name}")
        action.setShortcut(QKeySequence(row.key))
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        action.setStatusTip(row.tip)
        action.setEnabled(False)
        action.triggered.connect(lambda *_: row.do(done))
        owner.addAction(action)
        return action

    @property
    def tool(self) -> DrawTool:
        """The tool in hand."""
        return self.stroke.tool

    @property
    def snap(self) -> Snap | None:
        """Where the mouse is taken to be."""
        mouse = self.stroke.mouse
        moved = mouse is not None and mouse.point and self.sheet[1].get(mouse.point) != mouse.at
        return None if moved else mouse

    # -- the mode ---------------------------------------------------------------------------------------------

    def start(self, tool: str = CHOOSE) -> None:
        """Draw from now on."""
        if not self.active:
            self.active = True
            self.player.play(False)
            self.canvas.viewport().installEventFilter(self)
            self.canvas.installEventFilter(self)
            for action in (*self.tools.values(), *self.deeds.values()):
                action.setEnabled(True)
            self.bar.show()
            self.switched.emit(True)
        self.choose_tool(tool)
        self.canvas.setFocus()

    def stop(self) -> None:
        """The machine is shown as it runs again."""
        if self.active:
            self.active = False
            self.typed.boxes.close_all()
            self.forget()
            self.canvas.viewport().removeEventFilter(self)
            self.canvas.removeEventFilter(self)
            for action in (*self.tools.values(), *self.deeds.values()):
                action.setEnabled(False)
            self.bar.hide()
            self.canvas.setCursor(Qt.CursorShape.ArrowCursor)
            self.switched.emit(False)

    def choose_tool(self, name: str, *_: object) -> None:
        """Another of ``TOOLS``."""
        self.stroke.tool, self.stroke.snaps = TOOLS[name], []
        self.tools[name].setChecked(True)
        if name != CHOOSE:
            self.choose()
        self.canvas.setCursor(Qt.CursorShape.ArrowCursor if name == CHOOSE else Qt.CursorShape.CrossCursor)
        self.refresh()

    def forget(self) -> None:
        """Nothing is chosen, begun or locked."""
        self.stroke.drop()
        self.choosing.drop()
        self.locked.clear()
        self.forget_sheet()
        self.choose()

    def _prune(self) -> None:
        """What is chosen and no longer there is not chosen."""
        self.stroke.snaps = []
        self.typed.boxes.close_all()
        self.choose(tuple(self.points), tuple(self.links), self.row)

    def refresh(self) -> None:
        """Another design, or another angle, is in place: the strip says what is to be done; of a design without links nothing is."""
        if self.active and not self.session.typed.drive.links:
            self.stop()
        self.bar.prompt.setText(self.stroke.prompt)
        if self.active:
            self.bar.state.show_text(self.state_text())
        self.canvas.viewport().update()

    # -- the picture --------------------------------------------------------------------------------------------

    @property
    def marked(self) -> Marked:
        wrong = self.lack if self.stroke.snaps == [] and len(self.sheet[1]) > 2 else None
        return Marked(
            self.points,
            self.links,
            self.row,
            wrong_points=wrong.points if wrong else (),
            wrong_links=wrong.overconstrained if wrong else (),
            locked=self.locked,
        )

    def paint(self, painter: QPainter) -> None:
        """The sheet over everything; what does not move with the driver in grey."""
        painter.fillRect(self.canvas.viewport().rect(), QColor(SCREEN.paper))
        self.canvas.paint_under(painter)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        picture = self.picture
        if self.active:
            picture.paint_grid(painter, self.canvas.visible)
        picture.paint(painter, self.marked, dimensions=self.active, grey=self.still)
        if not self.active:
            return
        if (box := self.choosing.box) is not None:
            painter.setPen(QPen(QColor(SCREEN.chosen), 1.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(box)
        for one, other in zip(self.stroke.snaps, self.stroke.snaps[1:], strict=False):
            painter.setPen(QPen(QColor(SCREEN.chosen), 2.0))
            painter.drawLine(picture.to(one.at), picture.to(other.at))
        if self.snap is not None and self.tool.name != CHOOSE:
            picture.paint_snap(painter, self.snap, self.stroke.snaps[-1].at if self.stroke.snaps else None)

    def fit(self) -> None:
        """Bring all that is drawn into sight; an empty sheet as wide as a small machine."""
        _, places = self.sheet
        wide, high = max(1, self.canvas.viewport().width()), max(1, self.canvas.viewport().height())
        if len(places) < 2:
            middle = next(iter(places.values()), 0j)
            self.canvas.show_region(QPointF(middle.real, middle.imag), wide / SHEET_MM)
        else:
            x, y = [at.real for at in places.values()], [at.imag for at in places.values()]
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
        if kind == QEvent.Type.Leave and self.stroke.mouse is not None:
            self.stroke.mouse = None
            self.canvas.viewport().update()
        return False

    def _mouse_event(self, event: QMouseEvent) -> bool:
        kind, left = event.type(), event.button() == Qt.MouseButton.LeftButton
        hand = self.choosing if self.tool.name == CHOOSE else self.stroke
        if kind == QEvent.Type.MouseMove:
            self.typed.at = event.position().toPoint()
            if hand.pressed is None and event.buttons():
                return False
            if hand is self.choosing or not self.typed.boxes.open:
                hand.move(event)
            return True
        if left and kind == QEvent.Type.MouseButtonDblClick and self.tool.clicks == MANY:
            self.stroke.finish()
            return True
        if left and kind in (QEvent.Type.MouseButtonPress, QEvent.Type.MouseButtonDblClick):
            self.canvas.setFocus()
            self.typed.boxes.close_all()
            self.typed.at = event.position().toPoint()
            hand.press(event)
            return True
        if left and kind == QEvent.Type.MouseButtonRelease:
            hand.release(event)
            return True
        return False

    def _key(self, event: QKeyEvent) -> bool:
        if event.key() == Qt.Key.Key_Escape:
            self.escape()
            return True
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            if self.tool.clicks == MANY and len(self.stroke.snaps) > 1:
                self.stroke.finish()
            return True
        text = event.text()
        plain = not event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        if text and text in _FIRST and plain:
            self.typed.type_first(text)
            return True
        return False

    def escape(self) -> None:
        """One step back: what is dragged or begun, then the tool, then the mode."""
        if self.choosing.take_back():
            return
        if self.stroke.snaps:
            self.stroke.snaps = []
            self.refresh()
        elif self.tool.name != CHOOSE:
            self.choose_tool(CHOOSE)
        else:
            self.stop()

    # -- menus --------------------------------------------------------------------------------------------------

    def open_menu(self, pixel: Any, globally: Any) -> None:
        """What can be done with what is under the mouse."""
        menu = self.menu_at(QPointF(pixel))
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(globally)

    def menu_at(self, pixel: QPointF) -> QMenu:
        """The context menu of a pixel: deeds for what is there, and tools that begin there."""
        self.typed.at = pixel.toPoint()
        picture, at = self.picture, self.place_of(pixel)
        name = point_at(picture.places, at, picture.scale)
        row = "" if name else picture.load_at(at)
        link = None if name or row else picture.link_at(pixel)
        kind = "point" if name else "row" if row else "link" if link else "sheet"
        if name and name not in self.points:
            self.choose((name,))
        elif row:
            self.choose(row=row)
        elif link and link not in self.links:
            self.choose(links=(link,))
        menu = QMenu(self.canvas)
        design, places = self.sheet
        snap = snapped(design.drive.linkage, places, at, picture.scale, marks=self.canvas.marks)
        for tool in MENU_TOOLS[kind]:
            action = menu.addAction(icon(f"draw_{tool}"), _HERE.get(tool, f"{TOOLS[tool].text} here"))
            action.triggered.connect(partial(self._begin_here, tool, snap))
        menu.addSeparator()
        for row_ in DEEDS:
            if kind in row_.kinds:
                menu.addAction(self.deeds[row_.name])
        return menu

    def _begin_here(self, tool: str, snap: Snap, *_: object) -> None:
        """A tool with its first place set."""
        self.choose_tool(tool)
        self.stroke.mouse = snap
        self.stroke.set(snap)


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
        "sheet": ("bar", "plate", "ground", "slider", "pin"),
    }
)
"""What is under the mouse -> the tools that its menu offers to begin there."""
