"""Diagram under the mouse."""

from __future__ import annotations

from collections.abc import Mapping
from math import radians
from types import MappingProxyType

from PySide6.QtCore import QEvent, QPointF, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFocusEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QPalette,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QToolTip, QVBoxLayout, QWidget

from core.design import Design, move_join, require_motion
from core.errors import KindynaError
from core.motion.extremes import Extremes
from core.motion.split import shift_motion
from core.output.lines import shortest
from core.study import Quantity, Study
from kindyna_gui.documents.pins import Bands
from kindyna_gui.documents.session import Session
from kindyna_gui.graph.live_plot import LivePlot
from kindyna_gui.labels import law_label
from kindyna_gui.motion.diagram import (
    ANGLE_STEP,
    LEVEL,
    LINE,
    POINT,
    Grip,
    JoinLabel,
    MotionDiagram,
    Pull,
    grip_at,
    join_help,
    label_text,
    nudged,
    segment_at,
    snapped,
    step_name,
)
from kindyna_gui.pictures.plots.quantities import rows_of
from kindyna_gui.player import Player, obey

# -- derivatives -----------------------------------------------------------------------------------------

QUANTITIES = ("velocity", "acceleration", "jerk")
LEAST = 350  # pixels of height, from which on the three stand below the displacement
DIAGRAM, PLOT, LAST = 34, 20, 26  # shares of the height; the last plot has the angles below it


class DerivativePlots(QWidget):
    """The diagram, and below it the plots of ``QUANTITIES``, which are drawn only while there is room for them.

    angle_moved     (cam angle [rad]): a click into one of the plots, or the cursor drawn there
    room_changed    there is room for the plots, or no longer
    """

    angle_moved = Signal(float)
    room_changed = Signal()

    def __init__(self, diagram: MotionDiagram) -> None:
        super().__init__()
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self.setAutoFillBackground(True)
        self._diagram = diagram
        self.plots = tuple(LivePlot(names=False, angles=name == QUANTITIES[-1]) for name in QUANTITIES)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 0)
        column.setSpacing(0)
        column.addWidget(diagram, DIAGRAM)
        for plot in self.plots:
            plot.setMinimumHeight(1)
            plot.hide()
            plot.angle_moved.connect(self.angle_moved)
            column.addWidget(plot, LAST if plot is self.plots[-1] else PLOT)

    @property
    def roomy(self) -> bool:
        """Whether the plots are there."""
        return not self.plots[0].isHidden()

    def show_study(self, study: Study, bands: Bands) -> None:
        """Draw velocity, acceleration and jerk of a study, with the bands of what is made."""
        if self.roomy:
            for plot, quantity in zip(self.plots, QUANTITIES, strict=True):
                rows = rows_of(study, (quantity,))
                plot.set_curves(study, rows, read=False, bands=bands.read(rows))

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        """The channels of the plots whose extremes are not marked yet."""
        pairs = zip(self.plots, QUANTITIES, strict=True) if self.roomy else ()
        return tuple(row for plot, quantity in pairs if plot.lacks_extremes for row in rows_of(study, (quantity,)))

    def show_extremes(self, found: Mapping[str, Extremes] | None) -> None:
        """Mark the extremes of each plot, by its quantity; None: mark none."""
        for plot in self.plots:
            if found is None or plot.lacks_extremes:  # those that were found before are not among them
                plot.show_extremes(found)

    def set_angle(self, theta: float, at_angle: Study) -> None:
        """Move the cursors to cam angle theta [rad]; at_angle: the study there."""
        if self.roomy:
            for plot in self.plots:
                plot.set_angle(theta, at_angle)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        roomy = self.height() >= LEAST
        if roomy != self.roomy:
            for plot in self.plots:
                plot.setVisible(roomy)
            self._diagram.show_angles(not roomy)
            self.room_changed.emit()


# -- editor ----------------------------------------------------------------------------------------------

SHAPES: Mapping[str, Qt.CursorShape] = MappingProxyType(
    {
        POINT: Qt.CursorShape.SizeAllCursor,
        LINE: Qt.CursorShape.SizeHorCursor,
        LEVEL: Qt.CursorShape.SizeVerCursor,
    }
)
DIRECTIONS: Mapping[int, tuple[int, int]] = MappingProxyType(
    {
        Qt.Key.Key_Left: (-1, 0),
        Qt.Key.Key_Right: (1, 0),
        Qt.Key.Key_Up: (0, 1),
        Qt.Key.Key_Down: (0, -1),
    }
)
PAGES: Mapping[int, int] = MappingProxyType({Qt.Key.Key_PageUp: -1, Qt.Key.Key_PageDown: 1})

HOW = (
    "Draw along the names above or the angles below to shift the whole motion.\n"
    "Draw at a point to move its angle and level, at a line to move its angle, at a dwell to move its level.\n"
    "Shift keeps to one direction, Ctrl is ten times finer, Esc takes it back.\n"
    "Page Up and Page Down choose a segment; Alt and the arrow keys move the join at its end, with Shift finely."
)


class MotionEditor(MotionDiagram):
    """The diagram with its reactions.

    segment_chosen  (int): a segment was pointed at
    menu_requested     (QPoint on the screen, cam angle [deg]): a click with the right button
    released        Escape: nothing is being moved; what recalls the last edit is to go
    settled         a join has been moved
    """

    segment_chosen = Signal(int)
    menu_requested = Signal(object, float)
    released = Signal()
    settled = Signal()

    def __init__(self, session: Session, player: Player, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session, self._player = session, player
        self._pull: Pull | None = None
        self._from: Design | None = None  # the design before what is being moved
        self._last: Design | None = None  # what the gesture has made of it
        self._at = QPointF()
        self._right = False  # join 0 is held at 360 degrees
        self._turning = False  # the cam, by a press beside the joins
        self._shifted: float | None = None  # by so much at present, by a press on names or angles [deg]
        self.locked = False  # it shows another motion than the table, which cannot be drawn at
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        session.restored.connect(self._forget)

    # -- moving a join ------------------------------------------------------------------------------------

    @property
    def pulling(self) -> bool:
        """Whether something of the diagram is held with the mouse."""
        return self._pull is not None

    def _begin(self, grip: Grip, right: bool = False) -> None:
        self._session.end_gesture()
        self.over, self._right = grip, right
        self._from = self._last = self._session.design
        self.hold(True)

    @property
    def _runs(self) -> bool:
        """A gesture has begun, and nothing else has changed the design since."""
        return self._from is not None and self._session.design is self._last

    def _apply(self, design: Design, text: str = "") -> bool:
        """Show this design as what the gesture makes of the one before it; False where it cannot be."""
        assert self._from is not None
        if not text:
            assert self.over is not None
            text = step_name(self._from, design, self.over.join)
        possible = self._session.put(design, text, self._path)
        if possible:
            self._last = self._session.design
        return possible

    @property
    def _path(self) -> str:
        return f"motion.joins[{self.over.join if self.over is not None else 0}]"

    def _show_label(self, angle: float | None, level: float | None, refused: bool = False) -> None:
        """Write beside the join where it is drawn to."""
        assert self.over is not None
        text = label_text(require_motion(self._session.design), angle, level, self.over.join)
        self.label = JoinLabel(f"{text}  not possible" if refused else text, refused, self._right)
        self.point_out()

    def _end(self, back: bool = False) -> None:
        """The gesture is over; back: it leaves nothing behind."""
        if self._from is None:
            return
        if back and self._runs:
            self._apply(self._from, "" if self._shifted is None else "Shift the motion")
        self._session.withdraw(self._path)  # what was refused last, if anything was
        self._session.end_gesture()
        self._forget()
        self.settled.emit()

    def _forget(self) -> None:
        """What was being moved is void."""
        self._pull = self._from = self._last = self.label = self._shifted = None
        self._session.end_drag()
        self.hold(False)
        self.point_out()

    # -- mouse --------------------------------------------------------------------------------------------

    def _grip(self, place: QPointF) -> Grip | None:
        if self.motion is None or self.locked:
            return None
        at = self.mapToScene(place.toPoint())
        return grip_at(self.motion, self.scale_now(), at.x(), at.y())

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton or self.motion is None:
            return
        self._end()
        grip = self._grip(event.position())
        self._hover(grip)
        if self._on_angles(event.position()):
            self._session.end_gesture()
            self._from = self._last = self._session.design
            self._at, self._shifted = event.position(), 0.0
            self._session.begin_drag(self)
            return
        if grip is None:
            self._turning = True
            self._turn(event.position())
            if not self.locked:
                self.segment_chosen.emit(segment_at(self.motion, self._angle_at(event.position())))
            return
        self.segment_chosen.emit(grip.segment)
        self._at = event.position()
        self._begin(grip, grip.join == 0 and self._angle_at(self._at) > 180.0)
        self._pull = Pull(self.motion, grip, self.scale_now())
        self._session.begin_drag(self)
        self._show_label(None, None)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._pull is not None:
            self._draw_to(event)
        elif self._shifted is not None:
            self._shift_to(event.position())
        elif self._turning and event.buttons() & Qt.MouseButton.LeftButton:
            self._turn(event.position())
        elif not event.buttons():
            self._hover(self._grip(event.position()))

    def _on_angles(self, place: QPointF) -> bool:
        """Whether a place of the widget is among the names above the diagram, or the angles below."""
        scale, y = self.scale_now(), self.mapToScene(place.toPoint()).y()
        return not self.locked and not scale.top <= y <= scale.bottom

    def _shift_to(self, place: QPointF) -> None:
        """The motion so much later as the mouse has gone along the angles; where it cannot begin there it stays where it could."""
        if not self._runs:
            self._forget()
            return
        assert self._from is not None
        by = snapped((place.x() - self._at.x()) / self.scale_now().degree, ANGLE_STEP)
        if by == self._shifted:
            return
        try:
            moved = shift_motion(self._from, by)
        except KindynaError:  # a law cannot be cut where the turn would begin
            return
        if self._apply(moved, f"Shift the motion by {shortest(by)}°"):
            self._shifted = by

    def _draw_to(self, event: QMouseEvent) -> None:
        assert self._pull is not None
        assert self._from is not None
        if not self._runs:
            self._forget()
            return
        by, self._at = event.position() - self._at, event.position()
        keys = event.modifiers()
        fine, one_direction = keys & Qt.KeyboardModifier.ControlModifier, keys & Qt.KeyboardModifier.ShiftModifier
        angle, level = self._pull.move(by.x(), by.y(), bool(fine), bool(one_direction))
        possible = self._apply(move_join(self._from, self._pull.grip.join, angle, level))
        self._show_label(angle, level, not possible)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._turning = False
        if self._pull is not None or self._shifted is not None:
            self._end()
            self._hover(self._grip(event.position()))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self.mousePressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # the axes are fixed; what is around may want to scroll

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        if self._pull is None:
            self._hover(None)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        event.accept()
        if self.motion is None or self.pulling or self.locked:
            return
        angle = self._angle_at(QPointF(event.pos()))
        self.segment_chosen.emit(segment_at(self.motion, angle))
        self.menu_requested.emit(event.globalPos(), angle)

    def _hover(self, grip: Grip | None) -> None:
        """The mouse is over this."""
        if grip != self.over:
            self.over = grip
            self.viewport().setCursor(SHAPES[grip.kind] if grip is not None else Qt.CursorShape.ArrowCursor)
            self.point_out()

    def _angle_at(self, place: QPointF) -> float:
        return self.scale_now().angle(self.mapToScene(place.toPoint()).x())

    def _turn(self, place: QPointF) -> None:
        self._player.play(False)
        self._player.set_theta(radians(self._angle_at(place)))

    # -- keys ---------------------------------------------------------------------------------------------

    @property
    def join(self) -> int:
        """The join that keys move: the one at the end of the chosen segment."""
        assert self.motion is not None
        return (self.chosen + 1) % len(self.motion.segments)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        keys = event.modifiers() & ~(Qt.KeyboardModifier.KeypadModifier | Qt.KeyboardModifier.ShiftModifier)
        if event.key() == Qt.Key.Key_Escape:
            self.escape()
        elif self.motion is not None and not self.locked and event.key() in PAGES and not event.modifiers():
            self._end()
            last = len(self.motion.segments) - 1
            self.segment_chosen.emit(min(max(self.chosen + PAGES[event.key()], 0), last))
        elif self.motion is not None and event.key() in DIRECTIONS and keys == Qt.KeyboardModifier.AltModifier:
            self.nudge(DIRECTIONS[event.key()], bool(event.modifiers() & Qt.KeyboardModifier.ShiftModifier))
        elif not obey(self._player, event):
            event.ignore()

    def nudge(self, direction: tuple[int, int], fine: bool) -> None:
        """Move the join at the end of the chosen segment by one step; steps in a row are one step back."""
        if self.pulling or self.motion is None or self.locked:
            return
        grip = Grip(POINT, self.join, self.chosen)
        if not self._runs or self.over != grip:
            self._end()
            self._begin(grip)
        # from where the join is now, not from where the gesture began
        wanted = nudged(self.motion, self.join, self.scale_now(), direction, fine)
        if wanted != (None, None):
            possible = self._apply(move_join(self._session.design, self.join, *wanted))
            self._show_label(*wanted, refused=not possible)

    def escape(self) -> None:
        """Take back what is being moved; else let what recalls the last edit go."""
        if self._from is not None:
            self._end(back=True)
        else:
            self.released.emit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if self._pull is None and self._from is not None:
            self._end()

    # -- tips ---------------------------------------------------------------------------------------------

    def viewportEvent(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self.tip(QPointF(event.pos())), self)
            return True
        return super().viewportEvent(event)

    def tip(self, place: QPointF) -> str:
        """What is at a place of the widget [pixels], and what can be done there."""
        if self.motion is None:
            return ""
        grip = self._grip(place)
        if self._on_angles(place):
            text = "Draw along here to shift the motion in the turn"
        elif grip is None:
            index = segment_at(self.motion, self._angle_at(place))
            text = f"Segment {index + 1}: {law_label(self.motion.segments[index].curve.law)}"
        elif grip.kind == LEVEL:
            text = f"Level of the dwell, segment {grip.segment + 1}"
        else:
            joins = self._session.study.program.joins
            text = f"Segment {grip.segment + 1} ends, segment {grip.join + 1} begins\n"
            text += join_help(joins[grip.segment], self.motion)
        return f"{text}\n\n{HOW}"
