"""Plots over one turn with mouse and keys: set the cam angle, open a limit, and drag a peak to change the design."""

from __future__ import annotations

from typing import TYPE_CHECKING

from PySide6.QtCore import QPoint, QPointF, QRectF, Qt, Signal
from PySide6.QtGui import QAction, QCursor, QKeyEvent, QMouseEvent
from PySide6.QtWidgets import QToolButton, QWidget

from core.design import entry_at, get, put, split_unit
from core.frozen import frozen
from core.output.drawing.scales import UNSEEN
from kindyna_gui.labels import no_number, sentence, value_text
from kindyna_gui.pictures.plots.curves import CurvePlot
from kindyna_gui.pictures.plots.lines import Frame
from kindyna_gui.pictures.plots.marks import TEXT_ROOM, Extreme
from kindyna_gui.pictures.plots.mouse import AngleMouse
from kindyna_gui.pictures.style import SMALL, font
from kindyna_gui.pictures.units import measure
from kindyna_gui.player import Player
from kindyna_gui.view import View

if TYPE_CHECKING:
    from core.find import Trade
    from kindyna_gui.touch_targets import MouseReadout


DRAGGED = ("pressure_angle",)  # first letters of the quantities whose peaks can be dragged
DECIMALS = 2  # of the field during a drag
REACH = 8.0  # pixels from a marked peak within which the mouse grabs it
TIP = "Click or drag to set the cam angle; right-click to export"

# -- dragging a peak -------------------------------------------------------------------------------------


class PeakDrag:
    """Drag of a peak in the plots of a view: changes the field that determines it, as one step of undo.

    Attributes
    ----------
    lines : list of (str, bool)
        Texts next to the mouse, each with True beyond a limit.
    """

    def __init__(self, view: View, player: Player) -> None:
        self._view, self._session, self._player = view, view.session, player
        self._trade: Trade | None = None
        self._work: object = None
        self._unit, self._typed = "", ""
        self._text: MouseReadout | None = None
        self.lines: list[tuple[str, bool]] = []

    def can_grab(self, name: str) -> bool:
        """Whether the peaks of a quantity can be dragged."""
        cam = self._session.design.drive.cam
        return name.startswith(DRAGGED) and hasattr(cam, "base_radius_mm") and not self._session.is_on_balancer

    def grab(self, name: str, unit: str, highest: bool) -> bool:
        """Begin to drag the highest or lowest value of a quantity; False if no field determines it."""
        from core.find import trade

        self._trade = trade(self._session.design, name, highest) if self.can_grab(name) else None
        if self._trade is None:
            return False
        self._player.play(False)
        self._session.begin_drag(self._view)
        self._work, self._unit, self._typed = self._session.work, unit, ""
        self._show_effect()
        return True

    def drag(self, peak: float) -> None:
        """Drag the peak to a value."""
        if self._trade is not None and not self._typed:
            self._put(self._trade.field_value(peak, self._current), peak, DECIMALS)

    @property
    def _current(self) -> float:
        """Current value of the field: the next value is close to it where several give the same peak."""
        return float(get(self._session.design, self._trade.path)) if self._trade is not None else 0.0

    def _put(self, value: float | None, peak: float, decimals: int) -> bool:
        trade = self._trade
        assert trade is not None
        entry = entry_at(self._session.design, trade.path)
        assert entry is not None
        info = entry.info
        value = None if value is None else round(value, decimals)
        if value is None or not info.admits(value):
            self._show_effect(f"No {info.in_sentence} gives {measure(peak, self._unit)}")
            return False
        changed = put(self._session.design, trade.path, value)
        is_done = self._session.put(changed, f"Change {info.in_sentence}", trade.path)
        self._show_effect(
            "" if is_done else f"{info.label} {value_text(value, split_unit(trade.path)[1])} is not possible"
        )
        return is_done

    def _show_effect(self, refusal: str = "") -> None:
        """Update the texts: the effect on the design, and why a value was refused."""
        from kindyna_gui.touch_targets import readout_lines

        assert self._trade is not None
        stages = tuple(self._session.stages_on_screen())
        self.lines = readout_lines(self._session.study, self._trade.path, stages)
        self.lines += [(refusal, True)] if refusal else []

    def key(self, event: QKeyEvent) -> bool:
        """Handle a key: Escape cancels the drag, Return sets the peak to the typed number. False: not a key of the drag."""
        from kindyna_gui.touch_targets import typed_key

        if self._trade is None:
            return False
        if event.key() == Qt.Key.Key_Escape:
            self.release(cancel=True)
            return True
        typed = typed_key(self._typed, event, split_unit(self._trade.key.partition(":")[0])[1], self._enter)
        self._typed = self._typed if typed is None else typed
        return typed is not None

    def _enter(self, peak: float | None) -> bool:
        assert self._trade is not None
        if peak is None:
            self._show_effect(sentence(no_number(self._typed)))
        elif self._put(self._trade.exact_field_value(peak, self._current), peak, 12):
            self.release()
        return True

    def release(self, cancel: bool = False) -> None:
        """End the drag; cancel: restore the design from before it."""
        trade, self._trade = self._trade, None
        if trade is not None:
            self._session.end_field_drag(trade.path, self._work if cancel else None)

    @property
    def active(self) -> bool:
        """Whether a peak is being dragged."""
        return self._trade is not None

    def show_lines(self, on_screen: QPoint) -> None:
        """Show the texts next to the mouse."""
        from kindyna_gui.touch_targets import MouseReadout

        if self._text is None:
            self._text = MouseReadout(self._view)
        typed = [(f"{self._typed}_", False)] if self._typed else []
        self._text.show_lines([*typed, *self.lines] if self.active else [], on_screen)


# -- plots -----------------------------------------------------------------------------------------------


@frozen
class Peak:
    """A marked extreme of a quantity."""

    name: str
    extreme: Extreme


@frozen(eq=False)
class PeakGrip:
    """A peak at the start of its drag.

    Attributes
    ----------
    start : QPointF
        Position of the mouse [pixels].
    value : float
        Value of the peak, in the display unit.
    per_pixel : float
        Change of the value for one pixel.
    size : float
        Size of the display unit.
    core : (float, float)
        Range of the axis.
    """

    start: QPointF
    value: float
    per_pixel: float
    size: float
    core: tuple[float, float]


class LivePlot(AngleMouse, CurvePlot):
    """Curves over one turn, with mouse and keys.

    Signals: ``angle_moved`` (float), the user has set the cam angle [rad]; ``limit_chosen`` (str), the user has
    clicked the text of a limit, path of its field.

    Attributes
    ----------
    peaks : PeakDrag or None
        Handles the drag of a peak; None: peaks cannot be dragged.
    """

    angle_moved = Signal(float)
    limit_chosen = Signal(str)
    unseen = UNSEEN
    text_room = TEXT_ROOM
    full_range_action: QAction | None = None
    full_range_button: QToolButton | None = None
    peaks: PeakDrag | None = None
    _grip: PeakGrip | None = None

    def __init__(self, parent: QWidget | None = None, *, names: bool = True, angles: bool = True) -> None:
        super().__init__(parent, names=names, angles=angles)
        self.setFocusPolicy(Qt.FocusPolicy.ClickFocus)
        self.setToolTip(TIP)
        self.viewport().setMouseTracking(True)
        self.cache_axes()
        self.full_range_action = QAction("Show all", self, checkable=True, enabled=False)
        self.full_range_action.setToolTip("Extend the axis to isolated high peaks, or cut them off")
        self.full_range_action.toggled.connect(self.show_spikes)
        self.full_range_button = QToolButton(self, autoRaise=True)
        self.full_range_button.setDefaultAction(self.full_range_action)
        self.full_range_button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        self.full_range_button.setFont(font(SMALL))
        self.full_range_button.hide()

    def _covered(self, frame: Frame) -> list[QRectF]:
        """Area of the button in the upper right corner, shown if the axis cuts peaks off."""
        if (
            self.full_range_button is None or self.full_range_action is None
        ):  # during the construction of the base class
            return []
        self.full_range_action.setEnabled(self.has_spikes)
        self.full_range_button.setVisible(self.has_spikes)
        if not self.has_spikes:
            return []
        size, corner = (
            self.full_range_button.sizeHint(),
            self.mapFromScene(self.getViewBox().sceneBoundingRect().topRight()),
        )
        self.full_range_button.setGeometry(corner.x() - size.width() - 1, corner.y() + 1, size.width(), size.height())
        return [
            QRectF(frame.width - size.width() - 1.0, frame.height - size.height() - 1.0, size.width(), size.height())
        ]

    def press(self, event: QMouseEvent) -> bool:
        is_left, pixel = event.button() == Qt.MouseButton.LeftButton, event.position()
        if is_left and self.is_spike_at(pixel) and self.full_range_action is not None:
            self.full_range_action.trigger()
            return False
        if is_left and (field := self.limit_at(pixel)):
            self.limit_chosen.emit(field)
            return False
        return (is_left and self._grab_peak(pixel)) or super().press(event)

    # -- peaks ----------------------------------------------------------------------------------------------

    def peak_at(self, pixel: QPointF) -> Peak | None:
        """Return the marked extreme at a position in the widget [pixels], None if none there can be dragged."""
        if self.peaks is None:
            return None
        for mark in self._extreme_marks:
            extreme = mark.extreme
            name = next(
                (c.channel.name for c in self._curves if c.colour == extreme.colour and not c.channel.approximates), ""
            )
            at = self.to_pixel(QPointF(extreme.angle, extreme.value))
            is_hit = abs(complex(at.x() - pixel.x(), at.y() - pixel.y())) <= REACH
            if is_hit and extreme.refined and not mark.outside and self.peaks.can_grab(name):
                return Peak(name, extreme)
        return None

    def _grab_peak(self, pixel: QPointF) -> bool:
        peak = self.peak_at(pixel)
        if peak is None or self.peaks is None or self._core is None:
            return False
        if not self.peaks.grab(peak.name, self._curves[0].channel.unit.symbol, peak.extreme.highest):
            return False
        low, high = self.getViewBox().viewRange()[1]
        per_pixel = (high - low) / self.getViewBox().height()
        self._grip = PeakGrip(pixel, peak.extreme.value, per_pixel, self.display_unit.size, self._core)
        return True

    def _reach(self, core: tuple[float, float]) -> tuple[float, float]:
        """Range of the axis; during a drag it only grows."""
        before = core if self._grip is None else self._grip.core
        return super()._reach((min(core[0], before[0]), max(core[1], before[1])))

    def drag(self, event: QMouseEvent) -> None:
        grip, peaks = self._grip, self.peaks
        if grip is not None and peaks is not None and peaks.active:
            peaks.drag(grip.size * (grip.value + (grip.start.y() - event.position().y()) * grip.per_pixel))
            peaks.show_lines(event.globalPosition().toPoint())

    def hover(self, event: QMouseEvent | None) -> None:
        if event is not None and not event.buttons():
            pixel, shape = event.position(), Qt.CursorShape.ArrowCursor
            if self.limit_at(pixel):
                shape = Qt.CursorShape.PointingHandCursor
            elif self.peak_at(pixel) is not None:
                shape = Qt.CursorShape.SizeVerCursor
            self.viewport().setCursor(shape)
        super().hover(event)

    def drop(self, event: QMouseEvent) -> None:
        if self.peaks is not None:
            self.peaks.release()
            self._end_peak_drag()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if self._grip is None or self.peaks is None or not self.peaks.key(event):
            super().keyPressEvent(event)
        elif self.peaks.active:
            self.peaks.show_lines(QCursor.pos())
        else:
            self._end_peak_drag()

    def _end_peak_drag(self) -> None:
        """Fit the axis to its curves again."""
        self.let_go()
        self._grip = None
        if self.peaks is not None:
            self.peaks.show_lines(QPoint())
        self.draw_again()
