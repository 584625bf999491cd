"""Drawing a linkage with the mouse: tools, what is chosen, what is typed, keys and menus. While it is not used it costs nothing."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QObject, QPointF, QRectF, QSize, Qt, Signal
from PySide6.QtGui import (
    QAction,
    QActionGroup,
    QColor,
    QGuiApplication,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QPainter,
    QPen,
)
from PySide6.QtWidgets import QHBoxLayout, QLabel, QMenu, QToolBar, QVBoxLayout, QWidget

from core.design import UNITS, Design, edited, put, with_drive, with_rows_in_order
from core.design.linkage import CRANK, FRAME_LINK
from core.errors import DesignError, Fault, KindynaError
from core.frozen import frozen
from core.mechanism import CrankProgram, body_name
from core.mechanism.drawing.copies import part_of, with_part
from core.mechanism.drawing.edits import (
    with_driving_link,
    with_ground,
    with_joined,
    with_length,
    with_mirrored,
    with_moved,
    with_name,
    with_split,
    with_welded,
    without,
)
from core.mechanism.drawing.led import LedPart, led_part_of
from core.mechanism.drawing.settling import settled
from core.mechanism.drawing.sheet import Places, Spot, frame_of, places_of, pose_of, with_places
from core.mechanism.drawn import drawn_place
from core.mechanism.unfinished import Unfinished, unfinished
from core.project import dumps, loads
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import reason, shortest
from kindyna_gui.linkage.canvas import Canvas
from kindyna_gui.linkage.draw_tools import MANY, TOOLS, Drawing, DrawTool, Made
from kindyna_gui.linkage.sketch_picture import Marked, SketchPicture
from kindyna_gui.linkage.snapping import Snap, grid_step, point_at, snapped
from kindyna_gui.linkage.typed_boxes import Box, Typed, TypedBoxes
from kindyna_gui.look import CHOSEN, PAPER, icon
from kindyna_gui.note import SteadyText
from kindyna_gui.player import Player

CHOOSE = "choose"
MM, DEG, KG, KG_M2, N = UNITS["mm"], UNITS["deg"], UNITS["kg"], UNITS["kg_m2"], UNITS["n"]
RATE = UNITS["n_per_mm"]
DRAG = 4.0  # pixels that the mouse goes before a press is a drag
SHEET_MM = 260.0  # width of an empty sheet
SHIFT_CELLS = 4  # by which a copy stands beside what it is of
_FIRST = "0123456789.-+("
LOCK_OFF = "Lock takes the lock away"

ROW_BOXES: Mapping[str, tuple[tuple[str, str, Any], ...]] = MappingProxyType(
    {
        "masses": (
            ("mass", "mass_kg", KG),
            ("inertia", "inertia_kg_m2", KG_M2),
            ("x", "centre_x_mm", MM),
            ("y", "centre_y_mm", MM),
        ),
        "forces": (("x", "x_n", N), ("y", "y_n", N)),
        "springs": (("rate", "rate_n_per_mm", RATE), ("free length", "free_length_mm", MM)),
    }
)
"""List of the loads -> label, field and unit of what is typed once a row of it is chosen."""


class DrawBar(QWidget):
    """The strip of tools over the drawing, and below them what the drawing lacks and what is to be clicked."""

    def __init__(self, actions: Sequence[QAction]) -> None:
        super().__init__()
        self.tools = QToolBar(self)
        self.tools.setMovable(False)
        self.tools.setIconSize(QSize(20, 20))
        self.tools.setAccessibleName("Draw")
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


class DrawingMode(QObject):
    """What the mouse and the keys do on the canvas while a linkage is drawn.

    told      (text): what has been done, or why it cannot be
    switched  (on): the mode has begun, or ended
    """

    told = Signal(str)
    switched = Signal(bool)

    def __init__(self, canvas: Canvas, session: Session, player: Player, owner: QWidget) -> None:
        super().__init__(owner)
        self.canvas, self._session, self._player = canvas, session, player
        self.active = False
        self.tool: DrawTool = TOOLS[CHOOSE]
        self.group = QActionGroup(self)
        self.group.setObjectName("Draw")
        self.tools = {name: self._tool_action(tool, owner) for name, tool in TOOLS.items()}
        self.deeds = {row.name: self._deed_action(row, owner) for row in DEEDS}
        self.bar = DrawBar(list(self.tools.values()))
        self.boxes = TypedBoxes(canvas.viewport(), canvas)
        self._snaps: list[Snap] = []
        self._mouse: Snap | None = None
        self._pixel = QPointF()
        self._pressed: QPointF | None = None
        self._drags = ""  # "", "line", "move", "row", "box"
        self._grabbed = 0j
        self._moved_from: tuple[Design, Places] | None = None
        self.points: set[str] = set()
        self.links: set[int] = set()
        self.row = ""
        self.locked: set[str] = set()
        self._sheet: tuple[object, Design, Places] | None = None
        self._lack: tuple[Design, Unfinished, LedPart | None] | None = None
        self._lengths: dict[tuple[int, str, str], QRectF] = {}
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

    def _deed_action(self, row: Deed, owner: QWidget) -> QAction:
        action = QAction(row.text, owner)
        action.setObjectName(f"deed:{row.name}")
        action.setShortcut(QKeySequence(row.key))
        action.setShortcutContext(Qt.ShortcutContext.WidgetWithChildrenShortcut)
        action.setStatusTip(row.tip)
        action.setEnabled(False)
        action.triggered.connect(lambda *_: row.do(self))
        owner.addAction(action)
        return action

    # -- the mode ---------------------------------------------------------------------------------------------

    def start(self, tool: str = CHOOSE) -> None:
        """Draw from now on."""
        if not self.active:
            self.active = True
            self._player.play(False)
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
            self.boxes.close_all()
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
        self.tool, self._snaps = TOOLS[name], []
        self.tools[name].setChecked(True)
        if name != CHOOSE:
            self._choose()
        self.canvas.setCursor(Qt.CursorShape.ArrowCursor if name == CHOOSE else Qt.CursorShape.CrossCursor)
        self._tell()

    def forget(self) -> None:
        """Nothing is chosen, begun or locked."""
        self._snaps, self._drags, self._pressed, self._moved_from, self._sheet = [], "", None, None, None
        self.locked.clear()
        self._choose()

    def _prune(self) -> None:
        """What is chosen and no longer there is not chosen."""
        self._snaps = []
        self.boxes.close_all()
        self._choose(tuple(self.points), tuple(self.links), self.row)

    def _tell(self) -> None:
        """The strip says what is to be done."""
        prompts = self.tool.prompts
        self.bar.prompt.setText(f"{self.tool.text}: {prompts[min(len(self._snaps), len(prompts) - 1)]}")
        if self.active:
            self.bar.state.show_text(self.state_text())
        self.canvas.viewport().update()

    def refresh(self) -> None:
        """Another design, or another angle, is in place."""
        self._tell()

    @property
    def lack(self) -> Unfinished:
        """What the drawing lacks to be a mechanism."""
        return self._lacking()[0]

    def _lacking(self) -> tuple[Unfinished, LedPart | None]:
        """The same, and what the driver moves although it lacks something."""
        design = self._session.typed
        if design.drive.linkage.drawn is None:
            design = self.sheet[0]
        if self._lack is None or self._lack[0] is not design:
            lack = unfinished(design.drive.linkage)
            self._lack = (design, lack, None if lack.finished else led_part_of(design, lack))
        return self._lack[1:]

    @property
    def still(self) -> frozenset[int]:
        """The links that do not move with the driver, where others do; all while nothing is drawn and nothing moves."""
        lack, led = self._lacking()
        if lack.finished or (led is None and self.active):
            return frozenset()
        return frozenset(self.sheet[0].drive.linkage.by_number) - (frozenset(lack.led) if led else frozenset())

    def state_text(self) -> str:
        """What the drawing lacks to be a mechanism, and what to do."""
        design, places = self.sheet
        if not places:
            return "An empty sheet: set a fixed pivot with Ground, or draw a bar"
        if len(design.drive.links) < 2:
            return "Draw a bar from a pivot"
        return "; ".join(self.lack.sentences) or "1 degree of freedom, which the driver leads: it moves"

    # -- the sheet --------------------------------------------------------------------------------------------

    @property
    def sheet(self) -> tuple[Design, Places]:
        """The design as typed, drawn as it stands now, and where its points are."""
        typed = self._session.typed
        key = (typed, self._player.theta)
        if self._sheet is None or self._sheet[0] != key:
            self._sheet = (key, *self._as_it_stands(typed))
        return self._sheet[1], self._sheet[2]

    def _as_it_stands(self, typed: Design) -> tuple[Design, Places]:
        linkage = typed.drive.linkage
        if self._session.draft is None:
            try:
                kinematics = self._session.at(self._player.theta).linkage
                fixed = frame_of(linkage).places
                places = {
                    name: complex(kinematics.bodies[body_name(link.number)].place(name)[0]) * 1e3
                    for link in linkage.links
                    if link.number != FRAME_LINK
                    for name in link.places
                    if name not in fixed
                }
                return with_places(typed, {**places, **fixed}), {**places, **fixed}
            except (KindynaError, KeyError):
                pass
        if linkage.drawn is not None and (led := self._lacking()[1]) is not None:
            try:
                moved = led.places(self._player.theta)
                return with_places(typed, moved), moved
            except KindynaError:
                pass
        return typed, places_of(linkage)

    @property
    def picture(self) -> SketchPicture:
        design, places = self.sheet
        transform = self.canvas.viewportTransform()
        to = lambda at: transform.map(QPointF(at.real, at.imag))  # noqa: E731
        return SketchPicture(design, places, to, self.canvas.scale_now, self._lengths)

    @property
    def snap(self) -> Snap | None:
        """Where the mouse is taken to be."""
        return self._mouse

    @property
    def marked(self) -> Marked:
        wrong = self.lack if self._snaps == [] and len(self.sheet[1]) > 2 else None
        return Marked(
            self.points,
            self.links,
            self.row,
            wrong_points=wrong.points if wrong else (),
            wrong_links=wrong.doubled if wrong else (),
            locked=self.locked,
        )

    def paint(self, painter: QPainter) -> None:
        """The sheet over everything; what does not move with the driver in grey."""
        painter.fillRect(self.canvas.viewport().rect(), QColor(PAPER))
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        picture = self.picture
        if self.active:
            picture.paint_grid(painter, self.canvas.visible)
        picture.paint(painter, self.marked, dimensions=self.active, grey=self.still)
        if not self.active:
            return
        if self._drags == "box" and self._pressed is not None:
            painter.setPen(QPen(QColor(CHOSEN), 1.0, Qt.PenStyle.DashLine))
            painter.setBrush(Qt.BrushStyle.NoBrush)
            painter.drawRect(QRectF(self._pressed, self._pixel).normalized())
        for one, other in zip(self._snaps, self._snaps[1:], strict=False):
            painter.setPen(QPen(QColor(CHOSEN), 2.0))
            painter.drawLine(picture.to(one.at), picture.to(other.at))
        if self._mouse is not None and self.tool.name != CHOOSE:
            picture.paint_snap(painter, self._mouse, self._snaps[-1].at if self._snaps else None)

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

    # -- one action, one step -----------------------------------------------------------------------------------

    def make(self, make: Callable[[], Made | Design], text: str = "", path: str = "") -> bool:
        """Put what an edit makes in place as one step; where it cannot be made, say why."""
        try:
            made = make()
        except KindynaError as error:
            self.told.emit(_why(self.sheet[0], error))
            return False
        made = made if isinstance(made, Made) else Made(made, text, tuple(self.points), tuple(self.links), self.row)
        if not path:
            self._session.end_gesture()
        if not self._session.lay_out(made.design, made.text or text, path):
            return False
        if not path:
            self._session.end_gesture()
            self.told.emit(made.text or text)
        self._choose(made.points, made.links, made.row)
        if (theta := self._drawn_theta(made.design)) is not None:
            self._player.set_theta(theta)
        return True

    def _drawn_theta(self, design: Design) -> float | None:
        """The angle at which a crank stands as it is drawn; None of one that follows a motion."""
        drawn = design.drive.linkage.drawn
        if drawn is None or design.drive.linkage.driver.kind != CRANK or drawn.driver_deg is None:
            return None
        if self._session.draft is None and not self._session.unfinished:
            try:
                return CrankProgram(self._session.study.driver_ranges).theta(drawn_place(drawn))
            except KindynaError:
                return None
        led = self._lacking()[1]
        return None if led is None else led.drawn_theta

    def _choose(self, points: Sequence[str] = (), links: Sequence[int] = (), row: str = "") -> None:
        there = {link.number: link.places for link in self._session.typed.drive.links}
        self.points = {name for name in points if any(name in own for own in there.values())}
        self.links = {n for n in links if n in there}
        self.row = row if row and row in self.picture.load_places() else ""
        self._tell()

    @property
    def chosen_links(self) -> set[int]:
        """The links chosen; where points alone are, those that they make up whole."""
        design, _ = self.sheet
        whole = {
            link.number
            for link in design.drive.linkage.links
            if link.number != FRAME_LINK and link.places and set(link.places) <= self.points
        }
        return self.links | whole

    # -- events -------------------------------------------------------------------------------------------------

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        kind = event.type()
        if watched is self.canvas:
            return kind == QEvent.Type.KeyPress and isinstance(event, QKeyEvent) and self._key(event)
        if isinstance(event, QMouseEvent):
            left = Qt.MouseButton.LeftButton
            if kind == QEvent.Type.MouseMove:
                self._pixel = event.position()
                if self._pressed is not None or not event.buttons():
                    self._move(event)
                    return True
                return False
            if event.button() == left and kind == QEvent.Type.MouseButtonPress:
                self._press(event)
                return True
            if event.button() == left and kind == QEvent.Type.MouseButtonDblClick:
                if self.tool.clicks == MANY:
                    self._finish()
                else:
                    self._press(event)
                return True
            if event.button() == left and kind == QEvent.Type.MouseButtonRelease:
                self._release(event)
                return True
        elif kind == QEvent.Type.ContextMenu:
            self.open_menu(event.pos(), event.globalPos())  # type: ignore[attr-defined]
            return True
        elif kind == QEvent.Type.Leave and self._mouse is not None:
            self._mouse = None
            self.canvas.viewport().update()
        return False

    def _at(self, pixel: QPointF) -> complex:
        inverse, _ = self.canvas.viewportTransform().inverted()
        at = inverse.map(pixel)
        return complex(at.x(), at.y())

    def _snap(self, event: QMouseEvent, without: Sequence[str] = ()) -> Snap:
        design, places = self.sheet
        start = self._snaps[-1].at if self._snaps else None
        free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        return snapped(
            design.drive.linkage, places, self._at(event.position()), self.canvas.scale_now, start, without, free
        )

    def _press(self, event: QMouseEvent) -> None:
        self.canvas.setFocus()
        self.boxes.close_all()
        self._pressed = self._pixel = event.position()
        if self.tool.name == CHOOSE:
            self._press_chosen(event)
            return
        self._mouse = self._snap(event)
        if self.tool.clicks > 1 and not self._snaps:
            self._snaps = [self._mouse]
            self._drags = "line"
        self._tell()

    def _move(self, event: QMouseEvent) -> None:
        if self.tool.name == CHOOSE:
            self._drag_chosen(event)
            return
        if not self.boxes.open:
            self._mouse = self._snap(event)
            self.canvas.viewport().update()

    def _release(self, event: QMouseEvent) -> None:
        pressed, drags = self._pressed, self._drags
        self._pressed, self._drags = None, ""
        if pressed is None:
            return
        far = (event.position() - pressed).manhattanLength() > DRAG
        if self.tool.name == CHOOSE:
            self._drop_chosen(event, drags, far)
        elif drags == "line":
            if far:  # drawn in one pull
                self._set(self._snap(event))
            else:
                self._tell()
        else:
            self._set(self._snap(event))

    def _set(self, snap: Snap, length_mm: float | None = None, typed: bool = False) -> bool:
        """One place more for the tool; with the last one it makes what it makes."""
        self._snaps.append(snap)
        if len(self._snaps) < self.tool.clicks:
            self._tell()
            return True
        return self._finish(length_mm, typed)

    def _finish(self, length_mm: float | None = None, typed: bool = False) -> bool:
        """The tool makes what it makes of the places that it has."""
        snaps, make = tuple(self._snaps), self.tool.make
        if make is None or len(snaps) < min(self.tool.clicks, 2):
            return False
        design, places = self.sheet
        drawing = Drawing(design, places, snaps, length_mm, self.canvas.scale_now)
        self._snaps = []
        done = self.make(partial(make, drawing))
        if done and typed and self.tool.clicks == 1:
            self._choose()
        self._tell()
        return done

    # -- choosing and moving ------------------------------------------------------------------------------------

    def _press_chosen(self, event: QMouseEvent) -> None:
        picture, pixel = self.picture, event.position()
        at = self._at(pixel)
        self._grabbed, self._moved_from = at, None
        more = bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier)
        if not more and (length := picture.length_at(pixel)):
            self._drags = "length"
            self._choose(links=(length[0],))
            return
        name = point_at(picture.places, at, picture.scale)
        row = "" if name else picture.load_at(at)
        link = None if name or row else picture.link_at(pixel)
        if not (name or row or link):
            self._drags = "box"
            if not more:
                self._choose()
            return
        self._drags = "row" if row else "move"
        if more:
            self._choose(
                tuple(self.points ^ {name} if name else self.points),
                tuple(self.links ^ {link} if link else self.links),
                row,
            )
        elif not (name in self.points or link in self.links):
            self._choose((name,) if name else (), (link,) if link else (), row)

    def _drag_chosen(self, event: QMouseEvent) -> None:
        if self._pressed is None or self._drags in ("", "length"):
            return
        if self._drags == "box":
            self.canvas.viewport().update()
            return
        if self._moved_from is None:
            if (event.position() - self._pressed).manhattanLength() <= DRAG:
                return
            self._moved_from = self.sheet
            self._session.take_hold(self.canvas)
        design, places = self._moved_from
        if self._drags == "row":
            self._drag_row(design, places, event)
            return
        names = self._moving(design)
        loose = names - self.locked
        if not loose:
            self.told.emit(f"Locked: {LOCK_OFF}")
            return
        at, every = self._at(event.position()), tuple(places)
        free = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        first = next(iter(sorted(loose)))
        lead = places[first] if len(loose) == 1 else self._grabbed
        snap = snapped(design.drive.linkage, places, at, self.canvas.scale_now, None, every, free)
        way = (snap.at if len(loose) == 1 else _rounded(at - self._grabbed, self.canvas.scale_now, free) + lead) - lead
        to = {name: places[name] + way for name in loose}
        text = f"Move {', '.join(sorted(loose))}"
        path = f"linkage.drawn.{first}"
        self.make(partial(self._moved, design, to), text, path)

    def _moving(self, design: Design) -> set[str]:
        linkage = design.drive.linkage
        return self.points | {name for n in self.links for name in linkage.by_number[n].places}

    def _moved(self, design: Design, to: Places) -> Design:
        made = with_moved(design, to)
        for lock in (lock for lock in self.locked if ":" in lock):
            number, one, other = lock.split(":")
            before, after = (d.drive.linkage.by_number.get(int(number)) for d in (design, made))
            if before is None or after is None or not {one, other} <= set(before.places):
                continue
            old, new = (abs(each.places[one] - each.places[other]) for each in (before, after))
            if abs(old - new) > 1e-9:
                raise DesignError([Fault("linkage", lock, f"{one}-{other} is locked", LOCK_OFF)])
        return made

    def _drag_row(self, design: Design, places: Places, event: QMouseEvent) -> None:
        """A centre of mass is moved on its link."""
        if not self.row.startswith("loads.masses"):
            return
        mass = design.drive.loads.masses[int(self.row[self.row.index("[") + 1 : -1])]
        at = snapped(design.drive.linkage, places, self._at(event.position()), self.canvas.scale_now).at
        origin, axis = pose_of(design.drive.linkage, mass.link, places)
        local = (at - origin) * axis.conjugate()
        centre = (round(local.real, 3) + 0.0, round(local.imag, 3) + 0.0)
        self.make(
            lambda: put(design, f"{self.row}.centre", centre),
            f"Move centre of mass of link {mass.link}",
            f"{self.row}.centre_x_mm",
        )

    def _drop_chosen(self, event: QMouseEvent, drags: str, far: bool) -> None:
        if self._moved_from is not None:
            self._moved_from = None
            self._session.release()
        if drags == "length" and not far:
            length = self.picture.length_at(event.position())
            if length is not None:
                self.ask_length(*length)
        elif drags == "box" and far:
            self._choose_in(QRectF(self.picture.to(self._grabbed), event.position()).normalized())
        self._tell()

    def _choose_in(self, box: QRectF) -> None:
        picture = self.picture
        points = {name for name, at in picture.places.items() if box.contains(picture.to(at))}
        whole = {
            link.number
            for link in picture.design.drive.linkage.links
            if link.number != FRAME_LINK and link.places and set(link.places) <= points
        }
        self._choose(tuple(self.points | points), tuple(self.links | whole))

    # -- typing -------------------------------------------------------------------------------------------------

    def _key(self, event: QKeyEvent) -> bool:
        if event.key() == Qt.Key.Key_Escape:
            self.escape()
            return True
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            if self.tool.clicks == MANY and len(self._snaps) > 1:
                self._finish()
            return True
        text = event.text()
        plain = not event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        if text and text in _FIRST and plain:
            self.type_first(text)
            return True
        return False

    def escape(self) -> None:
        """One step back: what is begun, then the tool, then the mode."""
        if self._snaps:
            self._snaps = []
            self._tell()
        elif self.tool.name != CHOOSE:
            self.choose_tool(CHOOSE)
        else:
            self.stop()

    def type_first(self, text: str) -> None:
        """A digit opens the boxes of what can be typed now."""
        at = self._pixel.toPoint()
        if self._snaps and self.tool.clicks > 1:
            self.boxes.ask(at, (Box("length", MM), Box("angle", DEG)), self._take_line, text)
        elif wanted := self._boxes_of_chosen():
            boxes, taken = wanted
            self.boxes.ask(at, boxes, taken, text)
        elif self.tool.clicks:
            self.boxes.ask(at, (Box("x", MM), Box("y", MM)), self._take_place, text)

    def _take_line(self, values: Sequence[Typed]) -> str:
        """Length and angle of a line from the last place; where one is not typed it is the mouse's."""
        if not self._snaps:
            return ""
        start = self._snaps[-1].at
        mouse = self._mouse or Snap(start + 1.0)
        way = mouse.at - start
        length = values[0] if isinstance(values[0], float) else abs(way)
        turned = values[1] if isinstance(values[1], float) else math.degrees(cmath.phase(way))
        if not length > 0.0:
            return "a length above 0"
        exact = values[0] if isinstance(values[0], float) else None
        straight = {0.0: 1.0 + 0j, 90.0: 1j, 180.0: -1.0 + 0j, -90.0: -1j, 270.0: -1j}
        end = start + length * straight.get(turned, cmath.exp(1j * math.radians(turned)))
        self.boxes.close_all()
        snap = Snap(end)
        if mouse.point and values[1] is None:  # the pin under the mouse, at this length from here
            snap = mouse
        else:
            _, places = self.sheet
            near = next((name for name, at in places.items() if abs(at - end) < 1e-6), "")
            snap = Snap(places[near], point=near) if near else snap
        self._set(snap, exact if self.tool.name == "bar" else None, typed=True)
        return ""

    def _take_place(self, values: Sequence[Typed]) -> str:
        x, y = (value if isinstance(value, float) else 0.0 for value in values)
        _, places = self.sheet
        near = next((name for name, at in places.items() if abs(at - complex(x, y)) < 1e-6), "")
        self.boxes.close_all()
        self._set(Snap(complex(x, y), point=near), typed=True)
        return ""

    def _boxes_of_chosen(self) -> tuple[tuple[Box, ...], Callable[[Sequence[Typed]], str]] | None:
        """What can be typed of what is chosen: values of a load, coordinates of a point, length of a bar."""
        linkage = self.sheet[0].drive.linkage
        if self.row:
            kind = self.row.partition("[")[0].rpartition(".")[2]
            fields = ROW_BOXES.get(kind, ())
            return tuple(Box(label, unit) for label, _, unit in fields), partial(self._take_row, self.row, fields)
        if len(self.points) == 1 and not self.links:
            (name,) = self.points
            return (Box("x", MM), Box("y", MM)), partial(self._take_point, name)
        if len(self.links) == 1 and len(linkage.by_number[min(self.links)].points) == 2 and not self.points:
            link = linkage.by_number[min(self.links)]
            return (Box("length", MM),), partial(self._take_length, link.number, *link.places)
        return None

    def _take_row(self, row: str, fields: Sequence[tuple[str, str, Any]], values: Sequence[Typed]) -> str:
        def made() -> Design:
            design, _ = self.sheet
            for (_, name, _), value in zip(fields, values, strict=True):
                if isinstance(value, float):
                    design = put(design, f"{row}.{name}", value)
            return design

        kind = row.partition("[")[0].rpartition(".")[2]
        self.boxes.close_all()
        self.make(made, f"Set {({'masses': 'mass', 'forces': 'force', 'springs': 'spring'})[kind]}")
        return ""

    def _take_point(self, name: str, values: Sequence[Typed]) -> str:
        """Coordinates in the frame of the one link that has the point; of a pin on the sheet."""
        design, places = self.sheet
        linkage = design.drive.linkage
        having = [link for link in linkage.links if name in link.places]
        local = having[0].places[name] if len(having) == 1 else places[name]
        x, y = (
            value if isinstance(value, float) else old
            for value, old in zip(values, (local.real, local.imag), strict=True)
        )
        text = f"Put {name} at {shortest(x)}, {shortest(y)} mm"
        self.boxes.close_all()
        if len(having) == 1 and having[0].number != FRAME_LINK:
            at = linkage.links.index(having[0])

            def made() -> Design:
                moved = edited(design, f"linkage.links[{at}].points.{name}", (x, y))
                return with_places(moved, places_of(_undrawn(moved, name).drive.linkage))

            self.make(made, text)
        else:
            self.make(lambda: with_moved(design, {name: complex(x, y)}), text)
        return ""

    def ask_length(self, number: int, one: str, other: str) -> None:
        """Type another length of a link at its number in the drawing."""
        design, _ = self.sheet
        places = design.drive.linkage.by_number[number].places
        value = shortest(abs(places[other] - places[one]))
        rect = self._lengths.get((number, one, other))
        at = rect.center().toPoint() if rect is not None else self._pixel.toPoint()
        self.boxes.ask(at, (Box(f"{one}-{other}", MM, value),), partial(self._take_length, number, one, other))

    def _take_length(self, number: int, one: str, other: str, values: Sequence[Typed]) -> str:
        (value,) = values
        self.boxes.close_all()
        if isinstance(value, float):
            design, _ = self.sheet
            text = f"Make {one}-{other} {shortest(value)} mm long"
            self.make(lambda: settled(with_length(design, number, one, other, value)), text)
        return ""

    # -- deeds --------------------------------------------------------------------------------------------------

    def delete(self) -> None:
        """What is chosen is taken away."""
        design, _ = self.sheet
        if self.row:
            kind, _, rest = self.row.partition("[")
            rows = len(getattr(design.drive.loads, kind.rpartition(".")[2]))
            left = [i for i in range(rows) if i != int(rest[:-1])]
            self.make(lambda: Made(with_rows_in_order(design, kind, left), ""), f"Delete {kind.rpartition('.')[2]} row")
            return
        links = set(self.links)
        points = self.points - {n for k in links for n in design.drive.linkage.by_number[k].places}
        if not links and not points:
            self.told.emit("Nothing is chosen")
            return
        what = [*(f"link {n}" for n in sorted(links)), *sorted(points)]
        self.make(lambda: Made(without(design, points, links), f"Delete {', '.join(what)}"))

    def duplicate(self) -> None:
        """The chosen links once more, beside them."""
        self._paste_part(part_of(self.sheet[0], self.chosen_links), "Duplicate", self.chosen_links)

    def copy(self) -> None:
        """The chosen links onto the clipboard, as the text of a design."""
        if self._some_links():
            QGuiApplication.clipboard().setText(dumps(part_of(self.sheet[0], self.chosen_links)))
            self.told.emit("Copied: paste it here or in another design")

    def paste(self) -> None:
        """Links from the clipboard, beside what is there."""
        try:
            part = loads(QGuiApplication.clipboard().text(), unfinished=True)
            if not part.drive.links:
                raise KeyError
        except (KindynaError, KeyError, ValueError):
            self.told.emit("The clipboard holds no links: Ctrl+C copies those that are chosen")
            return
        self._paste_part(part, "Paste", ())

    def _paste_part(self, part: Design, what: str, chosen: Sequence[int] | set[int]) -> None:
        if what == "Duplicate" and not self._some_links():
            return
        shift = SHIFT_CELLS * grid_step(self.canvas.scale_now) * (1.0 - 1.0j)

        def made() -> Made:
            design, links = with_part(self.sheet[0], part, shift)
            return Made(design, f"{what} {_links_text(chosen or links)}", links=links)

        self.make(made)

    def mirror(self) -> None:
        """The chosen links mirrored in the upright line through their middle."""
        design, places = self.sheet
        links = self.chosen_links
        if self._some_links():
            names = {name for n in links for name in design.drive.linkage.by_number[n].places}
            x = [places[name].real for name in names]
            middle = complex(0.5 * (min(x) + max(x)), 0.0)
            self.make(lambda: with_mirrored(design, links, middle, 1j), f"Mirror {_links_text(links)}")

    def join(self) -> None:
        """The two chosen pins become one."""
        if len(self.points) != 2:
            self.told.emit("Choose two pins to be joined: click one, Shift and click the other")
            return
        one, other = sorted(self.points)
        self.make(lambda: Made(with_joined(self.sheet[0], one, other), f"Join {other} to {one}", points=(one,)))

    def split(self) -> None:
        """The chosen pin comes apart."""
        if name := self._one_point():
            self.make(lambda: with_split(self.sheet[0], name), f"Split {name}")

    def weld(self) -> None:
        """The two chosen links become one plate."""
        links = sorted(self.chosen_links)
        if len(links) != 2:
            self.told.emit("Choose two links to be welded: click one, Shift and click the other")
            return
        one, other = links
        self.make(
            lambda: Made(with_welded(self.sheet[0], one, other), f"Weld link {other} to link {one}", links=(one,))
        )

    def ground(self) -> None:
        """The chosen points are fixed to the ground; the chosen link is welded to it."""
        design, _ = self.sheet
        if self.points:
            names = sorted(self.points)

            def made() -> Design:
                changed = design
                for name in names:
                    changed = with_ground(changed, Spot(0j, name))
                return changed

            self.make(made, f"Ground {', '.join(names)}")
        elif len(self.links) == 1:
            (number,) = self.links
            self.make(lambda: Made(with_welded(design, FRAME_LINK, number), f"Fix link {number} to the ground"))
        else:
            self.told.emit("Choose a pin, or a link, to be fixed to the ground")

    def drive(self) -> None:
        """The chosen link drives."""
        if len(self.links) == 1:
            (number,) = self.links
            self.make(lambda: with_driving_link(self.sheet[0], number), f"Drive link {number}")
        else:
            self.told.emit("Choose the link that drives")

    def lock(self) -> None:
        """The chosen points and lengths cannot be dragged, or can again."""
        design, _ = self.sheet
        keys = set(self.points)
        for number in self.links:
            link = design.drive.linkage.by_number[number]
            if len(link.points) == 2:
                keys.add(":".join((str(number), *link.places)))
        if keys:
            self.locked = self.locked - keys if keys <= self.locked else self.locked | keys
            self.told.emit("Locked against dragging" if keys <= self.locked else "Free to be dragged again")
            self._tell()

    def rename(self) -> None:
        """Another name for the chosen point."""
        if name := self._one_point():
            at = self.picture.to(self.sheet[1][name]).toPoint()

            def taken(values: Sequence[Typed]) -> str:
                new = str(values[0] or "")
                try:
                    made = with_name(self.sheet[0], name, new)
                except KindynaError as error:
                    return _why(self.sheet[0], error)
                self.boxes.close_all()
                self.make(lambda: Made(made, f"Rename {name} to {new}", points=(new,)))
                return ""

            self.boxes.ask(at, (Box("name", None, name),), taken)

    def choose_all(self) -> None:
        """Everything that is drawn."""
        design, places = self.sheet
        self._choose(tuple(places), tuple(n for n in design.drive.linkage.by_number if n != FRAME_LINK))

    def type_values(self) -> None:
        """Type the values of what is chosen."""
        wanted = self._boxes_of_chosen()
        if wanted is None:
            self.told.emit("Choose a point, a bar or a load whose values are to be typed")
        else:
            self.boxes.ask(self._pixel.toPoint(), *wanted)

    def _one_point(self) -> str:
        if len(self.points) == 1:
            return next(iter(self.points))
        self.told.emit("Choose one pin")
        return ""

    def _some_links(self) -> bool:
        if not self.chosen_links:
            self.told.emit("Choose links first: a click on one, or a box around them")
        return bool(self.chosen_links)

    # -- menus --------------------------------------------------------------------------------------------------

    def open_menu(self, pixel: Any, globally: Any) -> None:
        """What can be done with what is under the mouse."""
        menu = self.menu_at(QPointF(pixel))
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        menu.popup(globally)

    def menu_at(self, pixel: QPointF) -> QMenu:
        """The context menu of a pixel: deeds for what is there, and tools that begin there."""
        self._pixel = pixel
        picture, at = self.picture, self._at(pixel)
        name = point_at(picture.places, at, picture.scale)
        row = "" if name else picture.load_at(at)
        link = None if name or row else picture.link_at(pixel)
        kind = "point" if name else "row" if row else "link" if link else "sheet"
        if name and name not in self.points:
            self._choose((name,))
        elif row:
            self._choose(row=row)
        elif link and link not in self.links:
            self._choose(links=(link,))
        menu = QMenu(self.canvas)
        design, places = self.sheet
        snap = snapped(design.drive.linkage, places, at, picture.scale)
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
        self._mouse = snap
        self._set(snap)


_HERE = {
    "bar": "Attach a bar",
    "plate": "Attach a plate",
    "ground": "Ground",
    "point": "Trace a point",
    "driver": "Drive",
}
MENU_TOOLS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "point": ("bar", "plate", "slider", "slider_on", "ground", "force", "spring", "roller"),
        "link": ("bar", "point", "ground", "driver", "mass", "force", "spring"),
        "row": (),
        "sheet": ("bar", "plate", "ground", "slider", "pin"),
    }
)
"""What is under the mouse -> the tools that its menu offers to begin there."""


@frozen
class Deed:
    """What is done with what is chosen: a row of the menus, with its key; kinds: in whose menus it stands."""

    name: str
    text: str
    key: str
    tip: str
    do: Callable[[DrawingMode], None]
    kinds: tuple[str, ...]


DEEDS: tuple[Deed, ...] = (
    Deed("values", "&Type values...", "Shift+Return", "Length of a bar, coordinates of a point, values of a load",
         DrawingMode.type_values, ("point", "link", "row")),
    Deed("delete", "&Delete", "Delete", "Take away what is chosen, and what holds on to it", DrawingMode.delete,
         ("point", "link", "row")),
    Deed("duplicate", "D&uplicate", "Ctrl+D", "The chosen links once more, beside them", DrawingMode.duplicate, ("link",)),
    Deed("copy", "&Copy", "Ctrl+C", "The chosen links, for here or for another design", DrawingMode.copy, ("link",)),
    Deed("paste", "&Paste", "Ctrl+V", "The links that were copied", DrawingMode.paste, ("link", "sheet")),
    Deed("mirror", "&Mirror", "Ctrl+Shift+M", "The chosen links, in the upright line through their middle",
         DrawingMode.mirror, ("link",)),
    Deed("join", "&Join pins", "Ctrl+J", "Two chosen pins become one", DrawingMode.join, ("point",)),
    Deed("split", "&Split pin", "Ctrl+Shift+J", "Every link on the chosen pin gets a point of its own", DrawingMode.split,
         ("point",)),
    Deed("weld", "&Weld links", "Ctrl+W", "Two chosen links become one plate", DrawingMode.weld, ("link",)),
    Deed("fix", "&Fix to ground", "Ctrl+Shift+G", "The chosen pin becomes a pivot; a link becomes part of the ground",
         DrawingMode.ground, ("point", "link")),
    Deed("drive", "D&rive", "Ctrl+R", "The chosen link drives", DrawingMode.drive, ("link",)),
    Deed("lock", "&Lock", "Ctrl+Shift+L", "The chosen point, or the length of the chosen bar, cannot be dragged",
         DrawingMode.lock, ("point", "link")),
    Deed("rename", "R&ename...", "F2", "Another name for the chosen point", DrawingMode.rename, ("point",)),
    Deed("all", "Choose &all", "Ctrl+A", "Everything that is drawn", DrawingMode.choose_all, ("sheet",)),
)  # fmt: skip


def _rounded(way: complex, scale: float, free: bool) -> complex:
    """A move of several points by whole cells of the grid."""
    step = grid_step(scale)
    return way if free else complex(round(way.real / step) * step, round(way.imag / step) * step)


def _links_text(links: Sequence[int] | set[int]) -> str:
    numbers = ", ".join(map(str, sorted(links)))
    return f"link {numbers}" if len(links) == 1 else f"links {numbers}"


def _undrawn(design: Design, name: str) -> Design:
    """The design without the place of one point, which then follows from its link."""
    linkage = design.drive.linkage
    assert linkage.drawn is not None
    points = tuple(p for p in linkage.drawn.points if p.name != name)
    return with_drive(design, mechanism=replace(linkage, drawn=replace(linkage.drawn, points=points)))


def _why(design: Design, error: KindynaError) -> str:
    """Why something cannot be drawn, in a sentence."""
    if isinstance(error, DesignError):
        fault = error.faults[0]
        return f"{fault.problem}: {fault.allowed}"
    return reason(design, error)


__all__ = ["DEEDS", "DrawBar", "DrawingMode"]
