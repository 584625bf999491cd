"""Timing chart on screen: dragging drives, starts and ends of movements, and sequence conditions by the mouse."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from PySide6.QtCore import QEvent, QPoint, QPointF, QRect, Qt, Signal
from PySide6.QtGui import (
    QAccessible,
    QColor,
    QContextMenuEvent,
    QFocusEvent,
    QHelpEvent,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPixmap,
)
from PySide6.QtWidgets import QLineEdit, QSizePolicy, QToolTip, QWidget

from core.design import (
    Design,
    Unit,
    drive_names,
    events_at,
    path_in,
    phase_path,
)
from core.number_text import shortest, typed_text
from kindyna_gui.forms.number_box import RedFrame, parsed
from kindyna_gui.forms.refusal import NO_REMEDIES, FloatingRefusal, Remedies
from kindyna_gui.labels import no_number, sentence
from kindyna_gui.pictures.paper.timing_chart import (
    AXES,
    CRANK,
    DEGREES,
    ChartHighlights,
    ForbiddenSpan,
    Reference,
    TimingChart,
    accessible_text,
    event_text,
)
from kindyna_gui.pictures.paper.timing_page import timing_chart
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.settings import sized
from kindyna_gui.timing_drags import DraggedBand, DraggedValve, dragged

# -- field over the chart --------------------------------------------------------------------------------

WIDTH, HEIGHT = 92, 24  # pixels


class TypedAngle(RedFrame, QLineEdit):
    """Field to type the phase of a drive, or the angle of a join; Enter applies it, Escape cancels.

    - entered (drive, join or None, value in the unit of the axis)
    """

    entered = Signal(int, object, float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._parent = parent
        self.resize(WIDTH, HEIGHT)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.hide()
        self._target: tuple[int, int | None] = (0, None)
        self._unit = Unit("", 1.0)
        self._first = ""  # the text with which it was opened
        self.refusal = FloatingRefusal(self)
        self.returnPressed.connect(self._enter)
        self.textEdited.connect(self._clear)

    def ask(self, drive: int, join: int | None, name: str, value: float, unit: str, position: QPointF) -> None:
        """Open the field for a drive's phase, or for a join; ``name`` is that of the value."""
        self._target, self._unit = (drive, join), Unit(AXES[unit], 1.0)
        self._clear()
        self._first = shortest(round(value, 6))
        self.setText(self._first)
        self.setAccessibleName(name)
        room = self._parent.rect()
        x = min(max(int(position.x()) - WIDTH // 2, 0), room.width() - WIDTH)
        y = min(max(int(position.y()) - HEIGHT - 8, 0), room.height() - HEIGHT)
        self.move(x, y)
        self.show()
        self.setFocus()
        self.selectAll()

    def refuse(self, why: str, remedies: Remedies = NO_REMEDIES) -> None:
        """Frame the typed value and show why it is refused, with its remedies."""
        self.set_refused(True)
        gap = "" if self._unit.symbol == "°" else " "
        back = {f"Back to {typed_text(self._first)}{gap}{self._unit.symbol}": self._go_back}
        self.refusal.show_refusal(sentence(why), {**remedies, **back})

    def _go_back(self) -> None:
        self._clear()
        self.setText(self._first)
        self.selectAll()

    def _clear(self) -> None:
        self.set_refused(False)
        self.refusal.show_refusal("")

    def _enter(self) -> None:
        value = parsed(self.text(), self._unit, in_file_units=True)
        if value is None:
            self.refuse(no_number(self.text()))
        else:
            self.entered.emit(*self._target, value)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape:
            self.hide()
            self._parent.setFocus()
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() not in (Qt.FocusReason.PopupFocusReason, Qt.FocusReason.ActiveWindowFocusReason):
            self.hide()


# -- chart -----------------------------------------------------------------------------------------------

STEP, FINE = 0.5, 0.1  # step of a drag, degrees; factor for step and movement with Ctrl
LEAST_HEIGHT, LEAST_BAND = 90, 26  # pixels
TREMBLE = 3.0  # movement of the mouse before a drag begins, pixels


def _chart_content(design: Design | None, unit: str) -> object:
    """The parts of a design that the chart shows, to compare two designs."""
    if design is None or unit == CRANK:
        return design
    drives = tuple((drive.phase, drive.mirrored, drive.motion) for drive in design.drives)
    return design.speed_rpm, drive_names(design), drives, design.timing


class TimingCanvas(QWidget):
    """The timing chart and its reactions to the mouse.

    ``put``: puts a design as an undo step, with its name and path; returns whether it is accepted.

    - drag_started: the drag of a drive or a join has begun
    - drag_ended (bool): it has ended; True: it was cancelled
    - drive_chosen (int): a band was clicked
    - row_chosen (int): an arrow was clicked
    - condition_drawn (str, str): Shift-drag from the first event to the second
    - angle_chosen (float): a machine angle [deg] was clicked on the axis
    - menu_requested (str, QPoint): right click on the field of this path, or empty, at this point of the screen
    """

    drag_started = Signal()
    drag_ended = Signal(bool)
    drive_chosen = Signal(int)
    row_chosen = Signal(int)
    condition_drawn = Signal(str, str)
    angle_chosen = Signal(float)
    menu_requested = Signal(str, QPoint)

    def __init__(self, put: Callable[[Design, str, str], bool], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._put = put
        self.setAccessibleName("Timing chart")
        self._design: Design | None = None
        self._reference: Reference | None = None
        self._chart: TimingChart | None = None
        self.unit = DEGREES
        self.chosen, self.row = -1, -1
        self.pair: tuple[int, ...] = ()
        self.forbidden: tuple[ForbiddenSpan, ...] = ()
        self.machine: float | None = None
        self._hovered: tuple[int, int | None] | None = None
        self._drag: DraggedBand | DraggedValve | None = None
        self._link: tuple[tuple[int, int], QPointF] | None = None
        self._mouse, self._start = QPointF(), QPointF()
        self._distance, self._is_moved = 0.0, False
        self._on_axis = False
        self._stopped = -1  # the sequence condition that stops the drag
        self.label, self._is_refused = "", False
        self._picture: QPixmap | None = None
        self._picture_key: object = None
        self.typed = TypedAngle(self)
        self.typed.entered.connect(self._apply_typed)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(260, LEAST_HEIGHT)

    # -- drawing --------------------------------------------------------------------------------------------

    def show_design(self, design: Design | None, reference: Reference | None = None) -> None:
        """Show a design, None: none, and another one dashed. The chart is kept where only parts differ that it does not show."""
        if reference != self._reference:
            self._reference, self._chart = reference, None
        if design is not self._design:
            if _chart_content(design, self.unit) != _chart_content(self._design, self.unit):
                self._chart = None
            self._design = design
            if self._drag is None:
                self.typed.hide()
            bands = 0 if design is None else len(design.drives)
            if QAccessible.isActive():
                self.setAccessibleDescription("" if design is None else self._description())
            self.setMinimumHeight(round(sized(max(LEAST_HEIGHT, bands * LEAST_BAND + 26))))
        self.update()

    def update_style(self) -> None:
        """Draw the chart again in the current theme and font size."""
        self._chart = self._picture = None
        self.update()

    def set_unit(self, unit: str) -> None:
        """Set the unit of the axis."""
        self.unit, self._chart = unit, None
        self.typed.hide()
        self.update()

    @property
    def chart(self) -> TimingChart:
        """Positions of everything in the chart."""
        assert self._design is not None
        chart = self._chart
        if chart is None or (chart.width, chart.height) != (self.width(), self.height()):
            chart = self._chart = timing_chart(
                self._design, self.width(), self.height(), self.unit, SCREEN, self._reference
            )
        return chart

    def _description(self) -> str:
        """Content of the chart for screen readers."""
        assert self._design is not None
        if self.unit == CRANK:
            return "; ".join(text for text, _ in self.chart.lines(()))
        return accessible_text(self._design)

    @property
    def is_dragging(self) -> bool:
        """Whether the mouse drags a band or a join."""
        return self._drag is not None

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        if self._design is None:
            painter.fillRect(self.rect(), QColor(SCREEN.paper))
        else:
            painter.drawPixmap(0, 0, self._drawn())
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            if self.machine is not None:
                self.chart.paint_cursor(painter, self.machine)
        painter.end()

    def _drawn(self) -> QPixmap:
        """Pixmap of the chart without the cursor, which moves much more often."""
        key = self.chart, self.highlights()
        if (
            self._picture is None
            or self._picture_key != key
            or self._picture.devicePixelRatio() != self.devicePixelRatioF()
        ):
            picture = QPixmap(self.size() * self.devicePixelRatioF())
            picture.setDevicePixelRatio(self.devicePixelRatioF())
            picture.fill(QColor(SCREEN.paper))
            painter = QPainter(picture)
            key[0].paint(painter, key[1])
            painter.end()
            self._picture, self._picture_key = picture, key
        return self._picture

    def highlights(self) -> ChartHighlights:
        """Return the highlighted parts of the chart."""
        joins: tuple[tuple[int, int], ...] = ()
        if self._hovered is not None:
            drive, join = self._hovered
            joins = (
                ((drive, join),)
                if join is not None
                else tuple((drive, k) for k in range(len(self.chart.bands[drive].joins)))
            )
        label = self.label if self._drag is not None or self._link is not None else ""
        row = self._stopped if self._drag is not None and self._stopped >= 0 else self.row
        forbidden = () if self.unit == CRANK else self.forbidden
        return ChartHighlights(self.chosen, row, joins, label, self._is_refused, self.pair, forbidden, self._link)

    # -- mouse ----------------------------------------------------------------------------------------------

    def _grip(self, pixel: QPointF) -> tuple[int, int | None] | None:
        """Drive and join at a pixel, join None for the band. The band of a single drive cannot be dragged."""
        if self._design is None or pixel.y() > self.chart.height - self.chart.footer_height:
            return None
        join = self.chart.join_at(pixel)
        if join is not None:
            return None if join[1] == 0 and not self._turns else join
        band = self.chart.band_at(pixel)
        return (band, None) if band is not None and self._turns else None

    @property
    def _turns(self) -> bool:
        """Whether a drive can be turned: against the others, or a valve against the crank."""
        return self.unit == CRANK or (self._design is not None and self._design.listed)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton or self._design is None:
            return
        self._end()
        pixel = event.position()
        self._mouse = self._start = pixel
        grip, row = self._grip(pixel), self.chart.row_at(pixel)
        if (grip is None or grip[1] is None) and row is not None:
            self.row_chosen.emit(row)
        elif grip is None:
            self._on_axis = pixel.x() >= self.chart.left
            self._choose_angle(pixel)
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier and grip[1] is not None and self.unit != CRANK:
            if self._events_at(*grip):
                self._link = (grip[0], grip[1]), pixel
        else:
            self._begin_drag(*grip)
        self._hover(grip)
        self.update()

    def _dragged(self, drive: int, join: int | None) -> DraggedBand | DraggedValve:
        """A drive or a join before it is moved."""
        assert self._design is not None
        return dragged(self.chart, self._design, drive, join)

    def _has_lobe(self, drive: int) -> bool:
        """Whether drags of a drive move its valve's centre and the edges of its lobe."""
        return self.unit == CRANK or bool(self.chart.edges.get(drive))

    def _events_at(self, drive: int, join: int | None) -> tuple[str, ...]:
        """Events at a point; none at an edge of a lobe."""
        assert self._design is not None
        if join is None or self.chart.edge(drive, join) is not None:
            return ()
        return tuple(events_at(self._design, drive, join))

    def _begin_drag(self, drive: int, join: int | None) -> None:
        self._drag = self._dragged(drive, join)
        self._distance, self._is_moved, self._is_refused, self._stopped = 0.0, False, False, -1
        self.label = self._drag.text(0.0)
        self.drag_started.emit()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        pixel = event.position()
        if self._drag is not None:
            self._turn(pixel, bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier))
        elif self._link is not None:
            self._draw_link(pixel)
        elif self._on_axis and event.buttons() & Qt.MouseButton.LeftButton:
            self._choose_angle(pixel)
        elif not event.buttons():
            self._hover(self._grip(pixel))

    def _turn(self, pixel: QPointF, fine: bool) -> None:
        drag = self._drag
        assert drag is not None
        self._distance += (pixel.x() - self._mouse.x()) * (FINE if fine else 1.0)
        self._mouse = pixel
        self._is_moved = self._is_moved or abs(pixel.x() - self._start.x()) > TREMBLE
        if not self._is_moved:
            return
        step = STEP * (FINE if fine else 1.0)
        target = round(round((drag.at + self._distance / self.chart.degree) / step) * step - drag.at, 9)
        by, stop = drag.room.within(target), drag.room.stop(target)
        possible = self._apply(drag, by)
        self.label, self._is_refused = drag.text(by), not possible or stop is not None
        if not possible:
            self.label += "  not possible"
        elif stop is not None:
            row = drag.design.timing[stop]
            self.label += f"   stops: {event_text(row.second)} {short(row.least_deg)}° after {event_text(row.first)}"
        self._stopped = -1 if stop is None else stop
        self.update()

    def _apply(self, drag: DraggedBand | DraggedValve, by: float) -> bool:
        """Put the design turned by an angle; False where it is refused."""
        return self._put(drag.turned(by), drag.step(by), drag.path)

    def _draw_link(self, pixel: QPointF) -> None:
        assert self._link is not None
        self._link = self._link[0], pixel
        names = self._link_names()
        self.label = (
            f"{event_text(names[1])} after {event_text(names[0])}"
            if names is not None
            else "drag to the point that must come after this one"
        )
        self._is_refused = False
        self.update()

    def _link_names(self) -> tuple[str, str] | None:
        """Events at both ends of a Shift-drag; None where there is none."""
        assert self._link is not None
        assert self._design is not None
        target = self.chart.join_at(self._link[1])
        if target is None or target == self._link[0]:
            return None
        first, second = self._events_at(*self._link[0]), self._events_at(*target)
        return (first[0], second[-1]) if first and second else None

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._on_axis = False
        if self._link is not None:
            names, self._link = self._link_names(), None
            if names is not None:
                self.condition_drawn.emit(*names)
        drag, is_moved = self._drag, self._is_moved
        self._end()
        if drag is not None and not is_moved:
            self.drive_chosen.emit(drag.drive)
        self._hover(self._grip(event.position()))
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        event.accept()
        grip = self._grip(event.position())
        if event.button() != Qt.MouseButton.LeftButton or grip is None:
            return
        drag = self._dragged(*grip)
        position = event.position() if grip[1] is None else self.chart.join_position(grip[0], grip[1])
        unit = CRANK if isinstance(drag, DraggedValve) else self.unit
        self.typed.ask(*grip, drag.typed_name, drag.value, unit, position)

    def _apply_typed(self, drive: int, join: int | None, value: float) -> None:
        """Apply a typed value, even where it violates a sequence condition, which is then a finding."""
        drag = self._dragged(drive, join)
        by, room = drag.typed(value)
        if not room.low <= by <= room.high:
            nearest = (drag.at + min(max(by, room.low), room.high)) % 360.0
            low, high, near, now = (
                self.chart.text(end % 360.0) for end in (drag.at + room.low, drag.at + room.high, nearest, drag.at + by)
            )
            use = {f"Use {near}": partial(self._apply_typed, drive, join, self.chart.value(nearest))}
            self.typed.refuse(f"outside its range; allowed: {low} ... {high}, between its neighbours, not {now}", use)
            return
        self.drag_started.emit()
        possible = self._apply(drag, by)
        self.drag_ended.emit(False)
        if possible:
            self.typed.hide()
            self.setFocus()
        else:
            self.typed.refuse(drag.refusal(by))

    def _choose_angle(self, pixel: QPointF) -> None:
        if self._on_axis:
            self.angle_chosen.emit(self.chart.angle(pixel.x()))

    def _end(self, cancel: bool = False) -> None:
        """End a drag; ``cancel``: restore the design before it."""
        self._link = None
        if self._drag is not None:
            drag, self._drag = self._drag, None
            if cancel and self._is_moved:
                self._put(drag.design, drag.step(0.0), drag.path)
            self.drag_ended.emit(cancel)
        self._is_moved = False

    def drop(self) -> None:
        """Drop a drag, because the design was changed elsewhere."""
        if self._drag is not None:
            self._drag = None
            self.drag_ended.emit(False)
        self._link, self._hovered, self._is_moved = None, None, False
        self.typed.hide()

    def forget(self) -> None:
        """Drop drag and selection, because another design was opened."""
        self.drop()
        self.row, self.pair = -1, ()

    def _hover(self, grip: tuple[int, int | None] | None) -> None:
        if grip != self._hovered:
            self._hovered = grip
            if grip is None:
                self.setCursor(Qt.CursorShape.ArrowCursor)
            else:
                self.setCursor(Qt.CursorShape.OpenHandCursor if grip[1] is None else Qt.CursorShape.SizeHorCursor)
            self.update()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        if self._design is not None and self._drag is None and self._link is None:
            self.menu_requested.emit(self.path_at(QPointF(event.pos())), event.globalPos())

    def path_at(self, pixel: QPointF) -> str:
        """Path of the field at a pixel: the span before a point, the distance of an arrow, or the phase of a band."""
        if self._design is None:
            return ""
        grip, row = self._grip(pixel), self.chart.row_at(pixel)
        if grip is not None and self._has_lobe(grip[0]):
            return self._dragged(*grip).path
        if grip is not None and grip[1] is not None and (motion := self._design.drives[grip[0]].motion) is not None:
            inside = f"motion.segments[{(grip[1] - 1) % len(motion.segments)}].span_deg"
            return path_in(self._design, grip[0], inside)
        if row is not None:
            return f"timing[{row}].least_deg"
        return "" if grip is None else phase_path(self._design, grip[0])

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        if self._drag is None:
            self._hover(None)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and (self._drag is not None or self._link is not None):
            self._end(cancel=True)
            self.update()
        else:
            event.ignore()

    # -- tips -----------------------------------------------------------------------------------------------

    def event(self, event: QEvent) -> bool:
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip:
            text = self.tip(QPointF(event.pos()))
            QToolTip.showText(event.globalPos(), text, self, QRect(event.pos(), event.pos()))
            return True
        return super().event(event)

    def tip(self, pixel: QPointF) -> str:
        """Text of the tip at a pixel: the value, and what the mouse does."""
        if self._design is None:
            return ""
        grip, row = self._grip(pixel), self.chart.row_at(pixel)
        if grip is not None and self._has_lobe(grip[0]):
            what = self._dragged(*grip).text(0.0)
        elif grip is not None and grip[1] is not None:
            drive, join = grip
            events = events_at(self._design, drive, join or 0)
            what = "\n".join(
                f"{event_text(event)}: {self.chart.degrees_and_ms(self.chart.bands[drive].joins[join or 0])}"
                for event in events
            )
        elif row is not None:
            timing = self._design.timing[row]
            what = f"{event_text(timing.second)} after {event_text(timing.first)}: {self.chart.condition_text(row)}"
        elif grip is not None:
            phase = self._design.drives[grip[0]].phase % 360.0
            what = f"{self.chart.bands[grip[0]].name}: phase {self.chart.degrees_and_ms(phase)}"
        else:
            return self.chart.how
        return f"{what}\n\n{self.chart.how}"
