"""Diagram that is edited by mouse and keys, with the plots of the derivatives below it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import radians
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, QPointF, QSize, Qt, Signal
from PySide6.QtGui import (
    QContextMenuEvent,
    QFocusEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPalette,
    QResizeEvent,
    QWheelEvent,
)
from PySide6.QtWidgets import QToolTip, QVBoxLayout, QWidget

from core.design import Design, OptimalCurve, move_join, put, require_motion
from core.errors import KindynaError
from core.motion.extremes import Extremes
from core.motion.split import shift_motion
from core.number_text import shortest
from core.study import Quantity, Study
from kindyna_gui.documents.session import Session
from kindyna_gui.labels import law_label
from kindyna_gui.motion.diagram import (
    ANGLE_STEP,
    LEVEL,
    LINE,
    POINT,
    DiagramScale,
    Grip,
    GripDrag,
    JoinLabel,
    MotionDiagram,
    grip_at,
    join_help,
    label_text,
    segment_at,
    snap,
    step_join,
    step_name,
)
from kindyna_gui.motion.limit_plot import LimitPlot, limit_lines
from kindyna_gui.pictures.plots.quantities import rows_of
from kindyna_gui.player import Player, obey
from kindyna_gui.rebuilt import fill

if TYPE_CHECKING:
    from kindyna_gui.motion.obstacles import ObstacleEdge

QUANTITIES = ("velocity", "acceleration", "jerk")
DIAGRAM, PLOT, LAST = 32, 21, 26  # shares of the height; the last plot has the numbers of the angle axis
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
MOUSE_HELP = (
    "Drag along the names above or the angles below to shift the whole motion.\n"
    "Drag a point to change its angle and level, a line to change its angle, a dwell to change its level.\n"
    "Shift keeps to one direction, Ctrl is ten times finer, Esc cancels the drag.\n"
    "Page Up and Page Down select a segment; Alt and the arrow keys move the join at its end, with Shift in fine steps."
)

# -- derivatives -----------------------------------------------------------------------------------------


class DerivativePlots(QWidget):
    """The diagram, and below it the plots of ``QUANTITIES``, as many of the first ones as have room.

    Signals: ``angle_moved`` (cam angle [rad]) when a plot is clicked or its cursor dragged; ``visibility_changed`` when
    plots are shown or hidden.
    """

    angle_moved = Signal(float)
    visibility_changed = Signal()

    def __init__(self, diagram: MotionEditor, session: Session) -> None:
        super().__init__(autoFillBackground=True)
        self.setBackgroundRole(QPalette.ColorRole.Base)
        self._diagram = diagram
        self.plots = tuple(LimitPlot(session, order) for order in range(1, len(QUANTITIES) + 1))
        self.shown = 0
        """Number of plots that are shown."""
        self._column = fill(QVBoxLayout(self), (diagram, DIAGRAM), margins=0, spacing=0)
        for plot in self.plots:
            plot.hide()
            plot.angle_moved.connect(self.angle_moved)
            self._column.addWidget(plot, PLOT)

    def minimumSizeHint(self) -> QSize:
        """Least size of the diagram alone, which has the numbers of the angle then."""
        return QSize(self._diagram.minimumSizeHint().width(), self._diagram.least_height(numbered=True))

    def show_study(self, study: Study, companions: Callable[[Sequence[Quantity]], dict[str, Any]]) -> None:
        """Draw velocity, acceleration and jerk of a study; companions: returns what is drawn next to a quantity."""
        for plot, quantity in zip(self.plots[: self.shown], QUANTITIES, strict=False):
            rows = rows_of(study, (quantity,))
            self._show_limits(plot, study, rows[0])
            plot.set_curves(study, rows, read=False, **companions(rows))

    def show_limits(self, study: Study) -> None:
        """Show the limits of optimal laws, after another segment was selected."""
        for plot, quantity in zip(self.plots[: self.shown], QUANTITIES, strict=False):
            self._show_limits(plot, study, rows_of(study, (quantity,))[0])

    def _show_limits(self, plot: LimitPlot, study: Study, channel: Quantity) -> None:
        plot.locked = self._diagram.locked
        plot.show_limits(limit_lines(study, channel, plot.order, self._diagram.chosen))

    def lacking(self, study: Study) -> tuple[Quantity, ...]:
        """Channels of the plots whose extremes are not marked yet."""
        pairs = zip(self.plots[: self.shown], QUANTITIES, strict=False)
        return tuple(row for plot, quantity in pairs if plot.lacks_extremes for row in rows_of(study, (quantity,)))

    def show_extremes(self, extremes: Mapping[str, Extremes] | None) -> None:
        """Mark the extremes of each plot, by its quantity; None: mark none."""
        for plot in self.plots:
            if extremes is None or plot.lacks_extremes:  # extremes marked earlier are not repeated in the mapping
                plot.show_extremes(extremes)

    def set_angle(self, theta: float, at_angle: Study) -> None:
        """Move the cursors to cam angle theta [rad]; at_angle: the study there."""
        for plot in self.plots[: self.shown]:
            plot.set_angle(theta, at_angle)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        numbers = range(len(self.plots), 0, -1)
        shown = next((number for number in numbers if self._least_height(number) <= self.height()), 0)
        if shown == self.shown:
            return
        self.shown = shown
        for number, plot in enumerate(self.plots, 1):
            plot.show_angles(number == shown)
            plot.setVisible(number <= shown)
            self._column.setStretchFactor(plot, LAST if number == shown else PLOT)
        self._diagram.show_numbers(not shown)
        self.visibility_changed.emit()

    def _least_height(self, number: int) -> int:
        """Least height with so many plots, the last one with the numbers of the angle."""
        plots = self.plots[:number]
        above = sum(plot.least_height(numbered=False) for plot in plots[:-1])
        return self._diagram.least_height(numbered=False) + above + plots[-1].least_height(numbered=True)


# -- editor ----------------------------------------------------------------------------------------------


class MotionEditor(MotionDiagram):
    """The diagram with its reactions to mouse and keys.

    Signals: ``segment_chosen`` (int) when a segment is clicked; ``menu_requested`` (QPoint on the screen, cam angle [deg])
    at a click with the right button; ``released`` when Escape is pressed and nothing is dragged: the motion before the last
    edit is hidden; ``settled`` after a join was moved.
    """

    segment_chosen = Signal(int)
    menu_requested = Signal(object, float)
    released = Signal()
    settled = Signal()

    def __init__(self, session: Session, player: Player, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._session, self._player = session, player
        self._drag: GripDrag | None = None
        self._original: Design | None = None  # the design before the drag
        self._last: Design | None = None  # the design that the drag has led to
        self._mouse = QPointF()
        self._right = False  # join 0 is dragged at 360°
        self._turning = False  # the mouse sets the cam angle
        self._shift: float | None = None  # of the whole motion by the current drag [deg]
        self._hovered_edge: ObstacleEdge | None = None  # edge of an obstacle under the mouse
        self._edge: ObstacleEdge | None = None  # the dragged one
        self.locked = False  # the diagram shows another motion than the table and cannot be edited
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setMouseTracking(True)
        self.viewport().setMouseTracking(True)
        session.restored.connect(self._forget)

    # -- dragging a join ---------------------------------------------------------------------------------

    @property
    def is_dragging(self) -> bool:
        """Whether the mouse drags a grip, or the edge of an obstacle."""
        return self._drag is not None or self._edge is not None

    def _begin(self, grip: Grip, right: bool = False) -> None:
        self._session.end_gesture()
        self.hovered, self._right = grip, right
        self._original = self._last = self._session.design
        self.fix_range(True)

    @property
    def _is_valid(self) -> bool:
        """Whether a drag has begun and nothing else has changed the design since."""
        return self._original is not None and self._session.design is self._last

    def _apply(self, design: Design, text: str = "") -> bool:
        """Make this the current design as a step of the drag; False where it is refused."""
        assert self._original is not None
        if not text:
            assert self.hovered is not None
            text = step_name(self._original, design, self.hovered.join)
        possible = self._session.put(design, text, self._path)
        if possible:
            self._last = self._session.design
        return possible

    @property
    def _path(self) -> str:
        if self._edge is not None:
            return self._edge.path
        return f"motion.joins[{self.hovered.join if self.hovered is not None else 0}]"

    def _show_label(self, angle: float | None, level: float | None, refused: bool = False) -> None:
        """Show the position of the dragged join next to it."""
        assert self.hovered is not None
        text = label_text(require_motion(self._session.design), angle, level, self.hovered.join)
        self.label = JoinLabel(f"{text}  not possible" if refused else text, refused, self._right)
        self.update_highlight()

    def _end(self, cancel: bool = False) -> None:
        """End the drag; cancel: return to the design before it."""
        if self._original is None:
            return
        if cancel and self._is_valid:
            self._apply(self._original, "" if self._shift is None and self._edge is None else "Cancel the drag")
        self._session.withdraw(self._path)  # a refused last position, if any
        self._session.end_gesture()
        self._forget()
        self.settled.emit()

    def _forget(self) -> None:
        """Reset the state of a drag."""
        self._drag = self._original = self._last = self.label = self._shift = self._edge = None
        self._session.end_drag()
        self.fix_range(False)
        self.update_highlight()

    # -- mouse -------------------------------------------------------------------------------------------

    def _grip(self, position: QPointF) -> Grip | None:
        if self.motion is None or self.locked:
            return None
        at = self.mapToScene(position.toPoint())
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
            self._original = self._last = self._session.design
            self._mouse, self._shift = event.position(), 0.0
            self._session.begin_drag(self)
            return
        if (edge := self._edge_at(event.position())) is not None and (grip is None or grip.kind != POINT):
            self._begin_edge(edge)
            return
        if grip is None:
            self._turning = True
            self._turn(event.position())
            if not self.locked:
                self.segment_chosen.emit(segment_at(self.motion, self._angle_at(event.position())))
            return
        self.segment_chosen.emit(grip.segment)
        self._mouse = event.position()
        self._begin(grip, grip.join == 0 and self._angle_at(self._mouse) > 180.0)
        self._drag = GripDrag(self.motion, grip, self.scale_now())
        self._session.begin_drag(self)
        self._show_label(None, None)

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._drag is not None:
            self._drag_to(event)
        elif self._shift is not None:
            self._shift_to(event.position())
        elif self._edge is not None:
            self._edge_to(event)
        elif self._turning and event.buttons() & Qt.MouseButton.LeftButton:
            self._turn(event.position())
        elif not event.buttons():
            self._hover(self._grip(event.position()), self._edge_at(event.position()))

    def _on_angles(self, position: QPointF) -> bool:
        """Whether a position in the widget is on the names above the diagram, or on the angles below."""
        scale, y = self.scale_now(), self.mapToScene(position.toPoint()).y()
        return not self.locked and not scale.top <= y <= scale.bottom

    def _shift_to(self, position: QPointF) -> None:
        """Shift the whole motion by the travel of the mouse, unless a law cannot be split where the turn would begin."""
        if not self._is_valid:
            self._forget()
            return
        assert self._original is not None
        shift = snap((position.x() - self._mouse.x()) / self.scale_now().degree, ANGLE_STEP)
        if shift == self._shift:
            return
        try:
            design = shift_motion(self._original, shift)
        except KindynaError:
            return
        if self._apply(design, f"Shift the motion by {shortest(shift)}°"):
            self._shift = shift

    # -- obstacles ---------------------------------------------------------------------------------------

    @property
    def _may_have_obstacles(self) -> bool:
        """Whether the motion has a law with obstacles, which only optimal laws have."""
        return self.motion is not None and any(isinstance(s.curve, OptimalCurve) for s in self.motion.segments)

    def _edge_at(self, position: QPointF) -> ObstacleEdge | None:
        if self.motion is None or self.locked or not self._may_have_obstacles:
            return None
        from kindyna_gui.motion.obstacles import edge_at  # loaded with the first optimal law

        at = self.mapToScene(position.toPoint())
        return edge_at(self.motion, self.scale_now(), at.x(), at.y())

    def _begin_edge(self, edge: ObstacleEdge) -> None:
        """Begin to drag the edge of an obstacle; the law follows."""
        self.segment_chosen.emit(edge.obstacle.segment)
        self._session.end_gesture()
        self._original = self._last = self._session.design
        self._edge = edge
        self.fix_range(True)
        self._session.begin_drag(self)

    def _edge_to(self, event: QMouseEvent) -> None:
        assert self._edge is not None
        assert self.motion is not None
        if not self._is_valid or self._original is None:
            self._forget()
            return
        from kindyna_gui.motion.obstacles import edge_text, edge_value  # as above

        at = self.mapToScene(event.position().toPoint())
        fine = bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier)
        motion = require_motion(self._original)
        value = edge_value(motion, self._edge, self.scale_now(), at.x(), at.y(), fine)
        self._apply(put(self._original, self._edge.path, value), edge_text(self._edge, value))

    def paint_below(self, painter: QPainter, scale: DiagramScale) -> None:
        if self.motion is not None and self._may_have_obstacles:
            from kindyna_gui.motion.obstacles import paint_obstacles  # as above

            paint_obstacles(painter, self.motion, scale, self._theme, self._edge or self._hovered_edge)

    # -- joins -------------------------------------------------------------------------------------------

    def _drag_to(self, event: QMouseEvent) -> None:
        assert self._drag is not None
        assert self._original is not None
        if not self._is_valid:
            self._forget()
            return
        travel, self._mouse = event.position() - self._mouse, event.position()
        keys = event.modifiers()
        fine, one_direction = keys & Qt.KeyboardModifier.ControlModifier, keys & Qt.KeyboardModifier.ShiftModifier
        angle, level = self._drag.move(travel.x(), travel.y(), bool(fine), bool(one_direction))
        possible = self._apply(move_join(self._original, self._drag.grip.join, angle, level))
        self._show_label(angle, level, not possible)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._turning = False
        if self._drag is not None or self._shift is not None or self._edge is not None:
            self._end()
            self._hover(self._grip(event.position()), self._edge_at(event.position()))

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        self.mousePressEvent(event)

    def wheelEvent(self, event: QWheelEvent) -> None:
        event.ignore()  # the axes are fixed; a surrounding area may scroll

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        if self._drag is None and self._edge is None:
            self._hover(None)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        event.accept()
        if self.motion is None or self.is_dragging or self.locked:
            return
        angle = self._angle_at(QPointF(event.pos()))
        self.segment_chosen.emit(segment_at(self.motion, angle))
        self.menu_requested.emit(event.globalPos(), angle)

    def _hover(self, grip: Grip | None, edge: ObstacleEdge | None = None) -> None:
        """Highlight the grip under the mouse, or the edge of an obstacle."""
        if grip is not None and grip.kind == POINT:
            edge = None
        if edge is not None:
            grip = None
        if (grip, edge) != (self.hovered, self._hovered_edge):
            self.hovered, self._hovered_edge = grip, edge
            kind = grip.kind if grip is not None else "" if edge is None else LEVEL if edge.is_level else LINE
            self.viewport().setCursor(SHAPES.get(kind, Qt.CursorShape.ArrowCursor))
            self.update_highlight()

    def _angle_at(self, position: QPointF) -> float:
        return self.scale_now().angle(self.mapToScene(position.toPoint()).x())

    def _turn(self, position: QPointF) -> None:
        self._player.play(False)
        self._player.set_theta(radians(self._angle_at(position)))

    # -- keys --------------------------------------------------------------------------------------------

    @property
    def join(self) -> int:
        """Join that the keys move, at the end of the selected segment."""
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
        """Move the join at the end of the selected segment by one step; successive steps are one undo step."""
        if self.is_dragging or self.motion is None or self.locked:
            return
        grip = Grip(POINT, self.join, self.chosen)
        if not self._is_valid or self.hovered != grip:
            self._end()
            self._begin(grip)
        # from the current position of the join, not from that before the first step
        target = step_join(self.motion, self.join, self.scale_now(), direction, fine)
        if target != (None, None):
            possible = self._apply(move_join(self._session.design, self.join, *target))
            self._show_label(*target, refused=not possible)

    def escape(self) -> None:
        """Cancel the drag; if there is none, hide the motion before the last edit."""
        if self._original is not None:
            self._end(cancel=True)
        else:
            self.released.emit()

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if not self.is_dragging and self._original is not None:
            self._end()

    # -- tips --------------------------------------------------------------------------------------------

    def viewportEvent(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            QToolTip.showText(event.globalPos(), self.tip(QPointF(event.pos())), self)
            return True
        return super().viewportEvent(event)

    def tip(self, position: QPointF) -> str:
        """Tip for a position in the widget [pixels]."""
        if self.motion is None:
            return ""
        grip = self._grip(position)
        if self._on_angles(position):
            text = "Drag along here to shift the whole motion in cam angle"
        elif grip is None and (edge := self._edge_at(position)) is not None:
            text = f"Drag to move the {edge.name}; the law follows"
        elif grip is None:
            index = segment_at(self.motion, self._angle_at(position))
            text = f"Segment {index + 1}: {law_label(self.motion.segments[index].curve.law)}"
        elif grip.kind == LEVEL:
            text = f"Level of the dwell, segment {grip.segment + 1}"
        else:
            joins = self._session.study.program.joins
            text = f"Segment {grip.segment + 1} ends, segment {grip.join + 1} begins\n"
            text += join_help(joins[grip.segment], self.motion)
        return f"{text}\n\n{MOUSE_HELP}"
