"""Plots under the mouse."""

from __future__ import annotations

from math import radians
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAction, QCursor, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QToolButton, QWidget

from core.design import entry_at, get, put, split_unit
from core.frozen import frozen
from kindyna_gui.labels import no_number, sentence, value_text
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import Frame
from kindyna_gui.pictures.plots.marks import TEXT_ROOM, Extreme
from kindyna_gui.pictures.plots.polar import PolarPlot
from kindyna_gui.pictures.plots.xy import AngleMouse
from kindyna_gui.pictures.style import SMALL, font
from kindyna_gui.pictures.units import UNSEEN, measure
from kindyna_gui.player import Player
from kindyna_gui.view import View

if TYPE_CHECKING:
    from core.find import Trade
    from kindyna_gui.touch_targets import MouseReadout


# -- peak drag -------------------------------------------------------------------------------------------

PULLED = ("pressure_angle",)  # beginnings of the quantities whose peaks are drawn
DECIMALS = 2  # of the field meanwhile


class PeakDrag:
    """What the mouse does with the peaks of a view's plots; one drag is one step.

    lines   what answers beside the mouse, each with whether a limit is passed
    """

    def __init__(self, view: View, player: Player) -> None:
        self._view, self._session, self._player = view, view.session, player
        self._trade: Trade | None = None
        self._work: object = None
        self._unit, self._typed = "", ""
        self._beside: MouseReadout | None = None
        self.lines: list[tuple[str, bool]] = []

    def can_take(self, name: str) -> bool:
        """Whether the peaks of a quantity can be drawn."""
        cam = self._session.design.drive.cam
        return name.startswith(PULLED) and hasattr(cam, "base_radius_mm") and not self._session.on_balancer

    def take(self, name: str, unit: str, highest: bool) -> bool:
        """Hold the highest or lowest value of a quantity in this unit; False where nothing is traded for it."""
        from core.find import trade

        self._trade = trade(self._session.design, name, highest) if self.can_take(name) else None
        if self._trade is None:
            return False
        self._player.play(False)
        self._session.begin_drag(self._view)
        self._work, self._unit, self._typed = self._session.work, unit, ""
        self._answer()
        return True

    def drag(self, wanted: float) -> None:
        """The peak is drawn to this value."""
        if self._trade is not None and not self._typed:
            self._put(self._trade.field_value(wanted, self._present), wanted, DECIMALS)

    @property
    def _present(self) -> float:
        """The value of the field now: a drag goes on from there, where several values give a peak."""
        return float(get(self._session.design, self._trade.path)) if self._trade is not None else 0.0

    def _put(self, value: float | None, wanted: float, decimals: int) -> bool:
        held = self._trade
        assert held is not None
        entry = entry_at(self._session.design, held.path)
        assert entry is not None
        info = entry.info
        value = None if value is None else round(value, decimals)
        if value is None or not info.admits(value):
            self._answer(f"No {info.in_sentence} gives {measure(wanted, self._unit)}")
            return False
        done = self._session.put(put(self._session.design, held.path, value), f"Change {info.in_sentence}", held.path)
        self._answer("" if done else f"{info.label} {value_text(value, split_unit(held.path)[1])} is not possible")
        return done

    def _answer(self, why_not: str = "") -> None:
        from kindyna_gui.touch_targets import readout_lines

        assert self._trade is not None
        stages = tuple(self._session.stages_on_screen())
        self.lines = readout_lines(self._session.study, self._trade.path, stages)
        self.lines += [(why_not, True)] if why_not else []

    def key(self, event: QKeyEvent) -> bool:
        """Escape takes the drag back; a number that is typed meanwhile is the peak that Return gives; False: the key is another's."""
        from kindyna_gui.touch_targets import extended_input

        held = self._trade
        if held is None:
            return False
        if event.key() == Qt.Key.Key_Escape:
            self.drop(back=True)
        elif event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            from kindyna_gui.forms.number_box import parsed

            wanted = parsed(self._typed, split_unit(held.key.partition(":")[0])[1]) if self._typed else None
            if wanted is None:
                self._answer(sentence(no_number(self._typed)))
            elif self._put(held.exact_field_value(wanted, self._present), wanted, 12):
                self.drop()
            self._typed = ""
        else:
            typed = extended_input(self._typed, event)
            if typed is None:
                return False
            self._typed = typed
        return True

    def drop(self, back: bool = False) -> None:
        """Let go; back: it goes back where it was."""
        held, self._trade = self._trade, None
        if held is not None:
            self._session.end_field_drag(held.path, self._work if back else None)

    @property
    def active(self) -> bool:
        """Whether a peak is held."""
        return self._trade is not None

    def tell(self, on_screen: QPoint) -> None:
        """What answers, beside the mouse."""
        from kindyna_gui.touch_targets import MouseReadout

        if self._beside is None:
            self._beside = MouseReadout(self._view)
        typed = [(f"{self._typed}_", False)] if self._typed else []
        self._beside.show_lines([*typed, *self.lines] if self.active else [], on_screen)


# -- live plot -------------------------------------------------------------------------------------------

REACH = 8.0  # pixels from a marked peak within which it is taken
TIP = "Click or drag to set the cam angle; right click to export"


class _Turned(AngleMouse):
    """The angle where the mouse is, of curves that are there."""

    readings: Any
    angle_at: Any
    angle_moved: Any

    def _set_angle_at(self, event: QMouseEvent) -> None:
        if self.readings():
            self.angle_moved.emit(radians(self.angle_at(event.position())))


@frozen
class Peak:
    """A marked extreme of a quantity."""

    name: str
    extreme: Extreme


@frozen(eq=False)
class Pull:
    """A peak under the hand: where it was taken [pixels], its value, how much of it a pixel is and the unit of these; what the axis
    had to show then."""

    start: QPointF
    value: float
    per_pixel: float
    size: float
    core: tuple[float, float]


class LivePlot(_Turned, CurvePlot):
    """Curves over one turn under the mouse.

    angle_moved   the user has clicked at, or drawn the cursor to, this cam angle [rad]
    limit_chosen  (path): the text of a limit was clicked, which is stated, or can be, in this field

    peaks         what is done with a peak that is drawn up and down; None: nothing
    """

    angle_moved = Signal(float)
    limit_chosen = Signal(str)
    unseen = UNSEEN
    text_room = TEXT_ROOM
    whole_action: QAction | None = None
    whole_button: QToolButton | None = None
    peaks: PeakDrag | None = None
    _pull: Pull | None = None

    def __init__(self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True) -> None:
        super().__init__(parent, names=names, angles=angles)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
        self.viewport().setMouseTracking(True)
        self.cache_axes()
        self.whole_action = QAction("Show all", self, checkable=True, enabled=False)
        self.whole_action.setToolTip("Let the axis reach to the peaks that are far off all the rest, or cut them off")
        self.whole_action.toggled.connect(self.show_spikes)
        self.whole_button = QToolButton(self, autoRaise=True)
        self.whole_button.setDefaultAction(self.whole_action)
        self.whole_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.whole_button.setFont(font(SMALL))
        self.whole_button.hide()

    def _covered(self, frame: Frame) -> list[QRectF]:
        """The button in the upper right corner, where there are peaks far off all the rest."""
        if self.whole_button is None or self.whole_action is None:  # the plot is still being made
            return []
        self.whole_action.setEnabled(self.has_spikes)
        self.whole_button.setVisible(self.has_spikes)
        if not self.has_spikes:
            return []
        size, corner = self.whole_button.sizeHint(), self.mapFromScene(self.getViewBox().sceneBoundingRect().topRight())
        self.whole_button.setGeometry(corner.x() - size.width() - 1, corner.y() + 1, size.width(), size.height())
        return [
            QRectF(frame.width - size.width() - 1.0, frame.height - size.height() - 1.0, size.width(), size.height())
        ]

    def angle_at(self, pixel: QPointF) -> float:
        """The cam angle [deg] at a place of the widget [pixels], 0 ... 360 also beside the axes."""
        place = self.getViewBox().mapSceneToView(self.mapToScene(pixel.toPoint()))
        return min(max(float(place.x()), 0.0), 360.0)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if (
            event.button() == Qt.MouseButton.LeftButton
            and self.is_spike_at(event.position())
            and self.whole_action is not None
        ):
            self.whole_action.trigger()
            event.accept()
        elif event.button() == Qt.MouseButton.LeftButton and (field := self.limit_at(event.position())):
            self.limit_chosen.emit(field)
            event.accept()
        elif event.button() != Qt.MouseButton.LeftButton or not self._take_peak(event.position()):
            super().mousePressEvent(event)

    # -- peaks ----------------------------------------------------------------------------------------------

    def peak_at(self, place: QPointF) -> Peak | None:
        """The marked extreme under a place of the widget [pixels], of those that can be drawn."""
        if self.peaks is None:
            return None
        for mark in self._extreme_marks:
            extreme = mark.extreme
            name = next(
                (c.channel.name for c in self._curves if c.colour == extreme.colour and not c.channel.approximates), ""
            )
            at = self.mapFromScene(self.getViewBox().mapViewToScene(QPointF(extreme.angle, extreme.value)))
            near = abs(complex(at.x() - place.x(), at.y() - place.y())) <= REACH
            if near and extreme.refined and not mark.outside and self.peaks.can_take(name):
                return Peak(name, extreme)
        return None

    def _take_peak(self, place: QPointF) -> bool:
        peak = self.peak_at(place)
        if peak is None or self.peaks is None or self._core is None:
            return False
        if not self.peaks.take(peak.name, self._curves[0].channel.unit.symbol, peak.extreme.highest):
            return False
        low, high = self.getViewBox().viewRange()[1]
        per_pixel = (high - low) / self.getViewBox().height()
        self._pull = Pull(place, peak.extreme.value, per_pixel, self.rung.size, self._core)
        return True

    def _reach(self, core: tuple[float, float]) -> tuple[float, float]:
        """Under the hand the axis only grows."""
        kept = core if self._pull is None else self._pull.core
        return super()._reach((min(core[0], kept[0]), max(core[1], kept[1])))

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        pull, peaks = self._pull, self.peaks
        if pull is None or peaks is None:
            if not event.buttons():
                self.viewport().setCursor(self._cursor_at(event.position()))
            super().mouseMoveEvent(event)
        elif peaks.active:
            peaks.drag(pull.size * (pull.value + (pull.start.y() - event.position().y()) * pull.per_pixel))
            peaks.tell(event.globalPosition().toPoint())

    def _cursor_at(self, place: QPointF) -> Qt.CursorShape:
        """What the mouse shows that it can do there."""
        if self.limit_at(place):
            return Qt.CursorShape.PointingHandCursor
        return Qt.CursorShape.SizeVerCursor if self.peak_at(place) is not None else Qt.CursorShape.ArrowCursor

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._pull is not None and self.peaks is not None:
            self.peaks.drop()
            self._leave_peak()
        super().mouseReleaseEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._pull is None or self.peaks is None or not self.peaks.key(event):
            super().keyPressEvent(event)
        elif self.peaks.active:
            self.peaks.tell(QCursor.pos())
        else:
            self._leave_peak()

    def _leave_peak(self) -> None:
        """The axis fits its curves again."""
        self._pull = None
        if self.peaks is not None:
            self.peaks.tell(QPoint())
        self.draw_again()


class LivePolar(_Turned, PolarPlot):
    """Curves in polar form under the mouse."""

    unseen = UNSEEN

    def __init__(self, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
