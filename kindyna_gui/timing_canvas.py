"""Timing chart under the mouse."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

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
    AngleRoom,
    Design,
    Unit,
    drive_names,
    events_at,
    join_room,
    path_in,
    phase_room,
    turn_drive,
    turn_join,
)
from core.frozen import frozen
from core.output.lines import shortest
from kindyna_gui.forms.number_box import RedFrame, parsed
from kindyna_gui.labels import no_number, sentence
from kindyna_gui.pictures.paper.timing_chart import (
    AXES,
    DEGREES,
    ChartHighlights,
    TimingChart,
    accessible_text,
    event_text,
)
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.pictures.units import short
from kindyna_gui.settings import sized

# -- a line over the timing chart in which an angle, or a time, is typed ---------------------------------

WIDTH, HEIGHT = 92, 24


class TypedAngle(RedFrame, QLineEdit):
    """Shown where something stands, with its value; Enter takes what was typed, Escape and another focus leave it.

    entered   (drive, join or None, value as the axis counts)
    """

    entered = Signal(int, object, float)

    def __init__(self, parent: QWidget) -> None:
        super().__init__(parent)
        self._parent = parent
        self.resize(WIDTH, HEIGHT)
        self.setAlignment(Qt.AlignmentFlag.AlignRight)
        self.hide()
        self._of: tuple[int, int | None] = (0, None)
        self._unit = Unit("", 1.0)
        self.returnPressed.connect(self._take)
        self.textEdited.connect(lambda: self.set_refused(False))

    def ask(self, drive: int, join: int | None, value: float, unit: str, place: QPointF) -> None:
        """Ask for the value of a drive's phase, or of a join."""
        self._of, self._unit = (drive, join), Unit(AXES[unit], 1.0)
        self.set_refused(False)
        self.setText(shortest(round(value, 6)))
        self.setAccessibleName("Phase" if join is None else "Machine angle")
        room = self._parent.rect()
        x = min(max(int(place.x()) - WIDTH // 2, 0), room.width() - WIDTH)
        y = min(max(int(place.y()) - HEIGHT - 8, 0), room.height() - HEIGHT)
        self.move(x, y)
        self.show()
        self.setFocus()
        self.selectAll()

    def refuse(self, why: str) -> None:
        """What was typed cannot be: it stays, framed in red, with the reason."""
        self.set_refused(True)
        self.setToolTip(sentence(why))
        QToolTip.showText(self.mapToGlobal(self.rect().bottomLeft()), sentence(why), self)

    def _take(self) -> None:
        value = parsed(self.text(), self._unit, in_file_units=True)
        if value is None:
            self.refuse(no_number(self.text()))
        else:
            self.entered.emit(*self._of, value)

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


# -- canvas ----------------------------------------------------------------------------------------------

STEP, FINE = 0.5, 0.1  # degrees; of the travel and of the step with Ctrl
LEAST_HEIGHT, LEAST_BAND = 90, 26  # pixels
TREMBLE = 3.0  # pixels that a hand may tremble before it means to turn something

HOW = (
    "Draw a point to turn one start or end, a band to turn its drive against the others; both stop at what must be kept.\n"
    "Ctrl is ten times finer, Esc takes it back. Double click on a point or a band to type the angle.\n"
    "Draw from point to point with Shift: the second must come after the first."
)


@frozen
class DraggedDrive:
    """What is held with the mouse: a drive, or a join of its motion; where its reference stood [deg], and how far it may be turned."""

    drive: int
    join: int | None
    design: Design
    at: float
    room: AngleRoom

    @property
    def path(self) -> str:
        return (
            f"drives[{self.drive}].phase_deg"
            if self.join is None
            else f"drives[{self.drive}].motion.joins[{self.join}]"
        )

    def turned(self, by: float) -> Design:
        """The design with what is held turned by so many degrees."""
        if self.join is None:
            return turn_drive(self.design, self.drive, self.at + by)
        return turn_join(self.design, self.drive, self.join, by)


def _drawn_of(design: Design | None) -> object:
    """What of a design the chart shows."""
    if design is None:
        return None
    drives = tuple((drive.phase_deg, drive.mirrored, drive.motion) for drive in design.drives)
    return design.speed_rpm, drive_names(design), drives, design.timing


class TimingCanvas(QWidget):
    """The chart with its reactions.

    put           puts a design in place as a step: (design, its name, path) -> whether that is possible
    taken         something is held with the mouse; let_go (bool): no longer, True: it leaves nothing behind
    drive_chosen  (int): a band was clicked at
    row_chosen    (int): an arrow was clicked at
    row_wanted    (str, str): drawn from the first event to the second
    angle_wanted  (float): the machine angle [deg] that was clicked at on the axis
    asked         (str, QPoint): a right click on what has this path, empty for none, at this place of the screen
    """

    taken = Signal()
    let_go = Signal(bool)
    drive_chosen = Signal(int)
    row_chosen = Signal(int)
    row_wanted = Signal(str, str)
    angle_wanted = Signal(float)
    asked = Signal(str, QPoint)

    def __init__(self, put: Callable[[Design, str, str], bool], parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self._put = put
        self.setAccessibleName("Timing chart")
        self._design: Design | None = None
        self._chart: TimingChart | None = None
        self.unit = DEGREES
        self.chosen, self.row = -1, -1
        self.pair: tuple[int, ...] = ()
        self.machine: float | None = None
        self._over: tuple[int, int | None] | None = None
        self._held: DraggedDrive | None = None
        self._link: tuple[tuple[int, int], QPointF] | None = None
        self._at, self._begun = QPointF(), QPointF()
        self._moved, self._means = 0.0, False
        self._on_axis = False
        self._stopped = -1  # the row of the timing that stops what is held
        self.label, self._wrong = "", False
        self._picture: QPixmap | None = None
        self._of: object = None
        self.typed = TypedAngle(self)
        self.typed.entered.connect(self._enter)
        self.setMouseTracking(True)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.setMinimumSize(260, LEAST_HEIGHT)

    # -- what is shown --------------------------------------------------------------------------------------

    def show_design(self, design: Design | None) -> None:
        """Show this design; None: none. What of it is not drawn here leaves the chart as it is."""
        if design is not self._design:
            if _drawn_of(design) != _drawn_of(self._design):
                self._chart = None
            self._design = design
            if self._held is None:
                self.typed.hide()
            bands = 0 if design is None else len(design.drives)
            if QAccessible.isActive():
                self.setAccessibleDescription("" if design is None else accessible_text(design))
            self.setMinimumHeight(round(sized(max(LEAST_HEIGHT, bands * LEAST_BAND + 26))))
        self.update()

    def update_style(self) -> None:
        """Theme or letters have changed."""
        self._chart = self._picture = None
        self.update()

    def set_unit(self, unit: str) -> None:
        """Let the axis count in this."""
        self.unit, self._chart = unit, None
        self.typed.hide()
        self.update()

    @property
    def chart(self) -> TimingChart:
        """Where everything stands."""
        assert self._design is not None
        chart = self._chart
        if chart is None or (chart.width, chart.height) != (self.width(), self.height()):
            chart = self._chart = TimingChart(self._design, self.width(), self.height(), self.unit, SCREEN)
        return chart

    @property
    def holding(self) -> bool:
        """Whether a band or a join is held with the mouse."""
        return self._held is not None

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
        """The chart without the cursor, which moves much more often than all else changes."""
        of = self.chart, self.shown()
        if self._picture is None or self._of != of or self._picture.devicePixelRatio() != self.devicePixelRatioF():
            picture = QPixmap(self.size() * self.devicePixelRatioF())
            picture.setDevicePixelRatio(self.devicePixelRatioF())
            picture.fill(QColor(SCREEN.paper))
            painter = QPainter(picture)
            of[0].paint(painter, of[1])
            painter.end()
            self._picture, self._of = picture, of
        return self._picture

    def shown(self) -> ChartHighlights:
        """What is pointed out."""
        joins: tuple[tuple[int, int], ...] = ()
        if self._over is not None:
            drive, join = self._over
            joins = (
                ((drive, join),)
                if join is not None
                else tuple((drive, k) for k in range(len(self.chart.bands[drive].joins)))
            )
        label = self.label if self._held is not None or self._link is not None else ""
        row = self._stopped if self._held is not None and self._stopped >= 0 else self.row
        return ChartHighlights(self.chosen, row, joins, label, self._wrong, self.pair, self._link)

    # -- mouse ----------------------------------------------------------------------------------------------

    def _grip(self, place: QPointF) -> tuple[int, int | None] | None:
        """Drive and join at a place; the join is None where the band is meant. A drive alone has no others to be turned against."""
        if self._design is None or place.y() > self.chart.height - self.chart.footer_height:
            return None
        join = self.chart.join_at(place)
        if join is not None:
            return None if join[1] == 0 and not self._design.listed else join
        band = self.chart.band_at(place)
        return (band, None) if band is not None and self._design.listed else None

    def mousePressEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton or self._design is None:
            return
        self._end()
        place = event.position()
        self._at = self._begun = place
        grip, row = self._grip(place), self.chart.row_at(place)
        if (grip is None or grip[1] is None) and row is not None:
            self.row_chosen.emit(row)
        elif grip is None:
            self._on_axis = place.x() >= self.chart.left
            self._go(place)
        elif event.modifiers() & Qt.KeyboardModifier.ShiftModifier and grip[1] is not None:
            if events_at(self._design, grip[0], grip[1]):
                self._link = (grip[0], grip[1]), place
        else:
            self._hold(*grip)
        self._hover(grip)
        self.update()

    def _hold(self, drive: int, join: int | None) -> None:
        design = self._design
        assert design is not None
        if join is None:
            self._held = DraggedDrive(drive, None, design, design.drives[drive].phase_deg, phase_room(design, drive))
        else:
            self._held = DraggedDrive(
                drive, join, design, self.chart.bands[drive].joins[join], join_room(design, drive, join)
            )
        self._moved, self._means, self._wrong, self._stopped = 0.0, False, False, -1
        self.label = self._text(self._held, 0.0)
        self.taken.emit()

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        place = event.position()
        if self._held is not None:
            self._turn(place, bool(event.modifiers() & Qt.KeyboardModifier.ControlModifier))
        elif self._link is not None:
            self._draw_link(place)
        elif self._on_axis and event.buttons() & Qt.MouseButton.LeftButton:
            self._go(place)
        elif not event.buttons():
            self._hover(self._grip(place))

    def _turn(self, place: QPointF, fine: bool) -> None:
        held = self._held
        assert held is not None
        self._moved += (place.x() - self._at.x()) * (FINE if fine else 1.0)
        self._at = place
        self._means = self._means or abs(place.x() - self._begun.x()) > TREMBLE
        if not self._means:
            return
        step = STEP * (FINE if fine else 1.0)
        wanted = round(round((held.at + self._moved / self.chart.degree) / step) * step - held.at, 9)
        by, stop = held.room.within(wanted), held.room.stop(wanted)
        possible = self._apply(held, by)
        self.label, self._wrong = self._text(held, by), not possible or stop is not None
        if not possible:
            self.label += "  not possible"
        elif stop is not None:
            row = held.design.timing[stop]
            self.label += f"   stops: {event_text(row.second)} {short(row.least_deg)}° after {event_text(row.first)}"
        self._stopped = -1 if stop is None else stop
        self.update()

    def _apply(self, held: DraggedDrive, by: float) -> bool:
        """One step that turns what is held so far."""
        return self._put(held.turned(by), self._step(held, by), held.path)

    def _step(self, held: DraggedDrive, by: float) -> str:
        """``Turn Feed to 330°``, ``Move Feed rise 1 end to 33.5°``."""
        at = f"{short((held.at + by) % 360.0)}°"
        if held.join is None:
            return f"Turn {self.chart.bands[held.drive].name} to {at}"
        return f"Move {self._name(held)} to {at}"

    def _name(self, held: DraggedDrive) -> str:
        assert held.join is not None
        events = events_at(held.design, held.drive, held.join)
        return event_text(events[0]) if events else f"join {held.join + 1} of {self.chart.bands[held.drive].name}"

    def _text(self, held: DraggedDrive, by: float) -> str:
        what = f"{self.chart.bands[held.drive].name} phase" if held.join is None else self._name(held)
        return f"{what}  {self.chart.degrees_and_ms(round(held.at + by, 9) % 360.0)}"

    def _draw_link(self, place: QPointF) -> None:
        assert self._link is not None
        self._link = self._link[0], place
        names = self._link_names()
        self.label = (
            f"{event_text(names[1])} after {event_text(names[0])}"
            if names is not None
            else "to another point: what must come after this"
        )
        self._wrong = False
        self.update()

    def _link_names(self) -> tuple[str, str] | None:
        """The events that are drawn from and to."""
        assert self._link is not None
        assert self._design is not None
        target = self.chart.join_at(self._link[1])
        if target is None or target == self._link[0]:
            return None
        first, second = events_at(self._design, *self._link[0]), events_at(self._design, *target)
        return (first[0], second[-1]) if first and second else None

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        event.accept()
        if event.button() != Qt.MouseButton.LeftButton:
            return
        self._on_axis = False
        if self._link is not None:
            names, self._link = self._link_names(), None
            if names is not None:
                self.row_wanted.emit(*names)
        held, means = self._held, self._means
        self._end()
        if held is not None and not means:
            self.drive_chosen.emit(held.drive)
        self._hover(self._grip(event.position()))
        self.update()

    def mouseDoubleClickEvent(self, event: QMouseEvent) -> None:
        event.accept()
        grip = self._grip(event.position())
        if event.button() != Qt.MouseButton.LeftButton or grip is None:
            return
        drive, join = grip
        assert self._design is not None
        band = self.chart.bands[drive]
        at = self._design.drives[drive].phase_deg % 360.0 if join is None else band.joins[join]
        place = event.position() if join is None else self.chart.join_position(drive, join)
        self.typed.ask(drive, join, self.chart.value(at), self.unit, place)

    def _enter(self, drive: int, join: int | None, value: float) -> None:
        """What was typed is taken as it is, also where it breaks a distance: that is then a finding."""
        design = self._design
        assert design is not None
        angle = value / self.chart.value(360.0) * 360.0
        if join is None:
            held = DraggedDrive(drive, None, design, design.drives[drive].phase_deg, phase_room(design, drive))
            by, room = angle - held.at, AngleRoom(-3600.0, 3600.0)
        else:
            held = DraggedDrive(
                drive, join, design, self.chart.bands[drive].joins[join], join_room(design, drive, join)
            )
            by, room = (angle - held.at + 180.0) % 360.0 - 180.0, self._neighbours(design, drive, join)
        by = round(by, 9)
        if not room.low <= by <= room.high:
            low, high = (self.chart.text((held.at + end) % 360.0) for end in (room.low, room.high))
            self.typed.refuse(f"allowed: {low} ... {high}, between its neighbours")
            return
        self.taken.emit()
        possible = self._apply(held, by)
        self.let_go.emit(False)
        if possible:
            self.typed.hide()
            self.setFocus()
        else:
            self.typed.refuse("not possible: the findings and the status line tell why")

    @staticmethod
    def _neighbours(design: Design, drive: int, join: int) -> AngleRoom:
        """What a join's neighbours leave, whatever must be kept."""
        return join_room(replace(design, timing=()), drive, join)

    def _go(self, place: QPointF) -> None:
        if self._on_axis:
            self.angle_wanted.emit(self.chart.angle(place.x()))

    def _end(self, back: bool = False) -> None:
        """What was held is let go; back: it leaves nothing behind."""
        self._link = None
        if self._held is not None:
            held, self._held = self._held, None
            if back and self._means:
                self._put(held.design, self._step(held, 0.0), held.path)
            self.let_go.emit(back)
        self._means = False

    def void(self) -> None:
        """The design has been changed from elsewhere: what is held is void."""
        if self._held is not None:
            self._held = None
            self.let_go.emit(False)
        self._link, self._over, self._means = None, None, False
        self.typed.hide()

    def forget(self) -> None:
        """Another design has begun: what was chosen is void too."""
        self.void()
        self.row, self.pair = -1, ()

    def _hover(self, grip: tuple[int, int | None] | None) -> None:
        if grip != self._over:
            self._over = grip
            shapes = Qt.CursorShape
            shape = (
                shapes.ArrowCursor
                if grip is None
                else shapes.OpenHandCursor
                if grip[1] is None
                else shapes.SizeHorCursor
            )
            self.setCursor(shape)
            self.update()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        if self._design is not None and self._held is None and self._link is None:
            self.asked.emit(self.path_at(QPointF(event.pos())), event.globalPos())

    def path_at(self, place: QPointF) -> str:
        """The field of what stands at a place: the span that a point ends, else the distance of an arrow, else the phase of a band."""
        if self._design is None:
            return ""
        grip, row = self._grip(place), self.chart.row_at(place)
        if grip is not None and grip[1] is not None and (motion := self._design.drives[grip[0]].motion) is not None:
            inside = f"motion.segments[{(grip[1] - 1) % len(motion.segments)}].span_deg"
            return path_in(self._design, grip[0], inside)
        if row is not None:
            return f"timing[{row}].least_deg"
        return "" if grip is None else path_in(self._design, grip[0], "phase_deg")

    def leaveEvent(self, event: QEvent) -> None:
        super().leaveEvent(event)
        if self._held is None:
            self._hover(None)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and (self._held is not None or self._link is not None):
            self._end(back=True)
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

    def tip(self, place: QPointF) -> str:
        """What is at a place, and what can be done there."""
        if self._design is None:
            return ""
        grip, row = self._grip(place), self.chart.row_at(place)
        if grip is not None and grip[1] is not None:
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
            what = f"{self.chart.bands[grip[0]].name}: phase {self.chart.degrees_and_ms(self._design.drives[grip[0]].phase_deg % 360.0)}"
        else:
            return HOW
        return f"{what}\n\n{HOW}"
