"""The fields of the blend wizard: numbers that count while they are typed, settings with their feasible range."""

from __future__ import annotations

from collections.abc import Sequence

from PySide6.QtCore import QObject, Qt, Signal
from PySide6.QtGui import QPalette
from PySide6.QtWidgets import QCheckBox, QGridLayout, QLabel, QSizePolicy, QToolButton, QWidget

from core.blend import MAY_VANISH, SettingRange
from core.design import UNITS, Info, Unit
from kindyna_gui.blend.request import POINT, Setting
from kindyna_gui.blend.texts import UNASKED, begin_of, range_text
from kindyna_gui.forms.number_box import NumberBox
from kindyna_gui.forms.typed_number import parsed
from kindyna_gui.look import coloured, icon
from kindyna_gui.note import MessageLabel
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.preferences.units import size_of, symbol_of

NO_NUMBER = "A number is wanted, such as 12.5"
CHECK, WHAT, BOX, UNIT, RANGE = range(5)  # columns of a row


class LiveBox(NumberBox):
    """A number box that emits a signal with every keystroke.

    changed   the number has changed, or the text is no number any longer
    """

    changed = Signal()
    as_kept = True

    def __init__(self, info: Info, unit: Unit, name: str = "") -> None:
        super().__init__(info, unit)
        self._was: float | None = None
        self.setAccessibleName(name or info.label)
        self.entered.connect(self._take)
        self.withdrawn.connect(self._emit_changed)
        self.lineEdit().textEdited.connect(self._emit_changed)

    @property
    def number(self) -> float | None:
        """The number in the box; None where its text is no number."""
        return parsed(self.text(), self._unit, kept=True)

    def set_number(self, value: float) -> None:
        """Show a number without emitting ``changed``."""
        self.show_value(value)
        self._was = value

    def set_step(self, step: float) -> None:
        """Set the step of the arrows."""
        if step != self._info.step:
            self._info = Info(
                self._info.label, self._info.help, self._info.low, self._info.high, self._info.open_low, step=step
            )

    def fault(self) -> str:
        """Why the text is not allowed, whatever the other fields hold; empty where it is."""
        value = self.number
        if value is None:
            return NO_NUMBER
        return "" if self._info.admits(value) else f"Allowed: {self._info.allowed(self._unit)}".replace(">=", "≥")

    def _take(self, value: float) -> None:
        refused = self.refused
        self.show_value(value)
        self.set_refused(refused)
        self._emit_changed()

    def _emit_changed(self, *_: object) -> None:
        if self.number != self._was:
            self._was = self.number
            self.changed.emit()


def quiet(text: str = "") -> QLabel:
    """A text in the quiet colour, on whatever paper it stands."""
    label = QLabel(text)
    coloured(label, SCREEN.quiet)
    label.setForegroundRole(QPalette.ColorRole.WindowText)
    return label


class RangedRow(QObject):
    """A row of the wizard: number boxes, their feasible range, a message.

    changed   another number, or the row was ticked or unticked
    """

    changed = Signal()

    def __init__(self, name: str, symbol: str, unit: Unit) -> None:
        super().__init__()
        self.name, self.symbol, self.measured = name, symbol, unit
        self.ranges: Sequence[SettingRange] | None = None
        self.range = quiet()
        self.range.setTextInteractionFlags(Qt.TextInteractionFlag.TextSelectableByMouse)
        self.range.setWordWrap(True)
        self.range.setSizePolicy(QSizePolicy.Policy.Ignored, QSizePolicy.Policy.Preferred)
        self.message = MessageLabel(SCREEN.limit)

    def boxes(self) -> tuple[LiveBox, ...]:
        """The editors of the row."""
        raise NotImplementedError

    @property
    def used(self) -> bool:
        """Whether the row counts as a setting."""
        return True

    def show_ranges(self, ranges: Sequence[SettingRange] | None) -> None:
        """Show the feasible ranges of the value; None: they are not computed yet."""
        self.ranges = ranges
        known = range_text(ranges or (), self.symbol, size_of(self.measured.symbol)) if ranges or self.used else ""
        text = UNASKED if ranges is None else known
        self.range.setText(text)
        self.range.setToolTip(text if ranges else "")

    def show_fault(self, text: str) -> None:
        """Show what is wrong below the row; an empty text hides it."""
        self.message.show_message(text)
        self.boxes()[-1].set_refused(bool(text))


class SettingRow(RangedRow):
    """The row of one setting, which counts while it is ticked."""

    def __init__(self, setting: Setting, unit: Unit) -> None:
        super().__init__(setting.name, setting.symbol, unit)
        info = Info(setting.label, setting.help, 0.0, open_low=setting.name not in MAY_VANISH)
        self.share, self.usual, self.shown = setting.share, 1.0, False
        self.check = QCheckBox(setting.label)
        self.check.setToolTip(setting.help)
        self.what = quiet()
        self.box = LiveBox(info, unit)
        self.unit = quiet(symbol_of(unit.symbol))
        self.box.setEnabled(False)
        self.box.lineEdit().clear()
        self._valued = False
        self.check.toggled.connect(self._toggled)
        self.box.changed.connect(self.changed)

    def boxes(self) -> tuple[LiveBox, ...]:
        return (self.box,)

    @property
    def used(self) -> bool:
        return self.check.isChecked()

    @property
    def value(self) -> float | None:
        return self.box.number

    def add_to(self, grid: QGridLayout, row: int) -> None:
        """Take the rows ``row`` and ``row + 1`` of a grid."""
        for column, widget in enumerate((self.check, self.what, self.box, self.unit, self.range)):
            grid.addWidget(widget, row, column)
        grid.addWidget(self.message, row + 1, WHAT, 1, RANGE)

    def show(self, on: bool, what: str) -> None:
        """Show or hide the row; what: which curve it is of."""
        self.shown = on
        self.what.setText(what)
        for widget in (self.check, self.what, self.box, self.unit, self.range):
            widget.setVisible(on)
        if not on:
            self.message.show_message("")

    def give(self, value: float) -> None:
        """Tick it with a value, without emitting ``changed``."""
        self._valued = True
        self.box.set_number(value)
        blocked = self.check.blockSignals(True)
        self.check.setChecked(True)
        self.check.blockSignals(blocked)
        self.box.setEnabled(True)

    def drop(self) -> None:
        """Untick it, without emitting ``changed``."""
        blocked = self.check.blockSignals(True)
        self.check.setChecked(False)
        self.check.blockSignals(blocked)
        self._rest()

    def _rest(self) -> None:
        """The value is not seen, but kept for the next ticking."""
        if self.box.number is not None:
            self.box.set_number(self.box.number)
        self.box.setEnabled(False)
        self.show_fault("")
        self.box.lineEdit().clear()

    def _toggled(self, on: bool) -> None:
        if on:
            begin = begin_of(self.ranges or (), self.share)
            value = self.box.value if self._valued else None
            if value is None:
                value = begin if begin is not None else self.usual
            self.give(value)
            self.box.setFocus(Qt.FocusReason.OtherFocusReason)
            self.box.selectAll()
        else:
            self._rest()
        self.changed.emit()


class PrecisionPointRow(RangedRow):
    """A precision point: at a cam angle, a level above the lowest.

    removed   the user wants the point removed

    paper: the widget that holds all of the row
    """

    removed = Signal()

    def __init__(self, unit: Unit) -> None:
        super().__init__(POINT, "level", unit)
        self.at = LiveBox(Info("Angle", "cam angle of the point", 0.0, 360.0, step=1.0), UNITS["deg"])
        self.level = LiveBox(Info("Level", "displacement above the lowest level"), unit)
        self.words = (quiet("At"), quiet("°  at the level"), quiet(symbol_of(unit.symbol)))
        self.close = QToolButton(autoRaise=True)
        self.close.setIcon(icon("close"))
        self.close.setToolTip("Take this point away")
        self.close.setAccessibleName("Take this point away")
        self.close.clicked.connect(self.removed)
        for box in self.boxes():
            box.changed.connect(self.changed)
        self.paper = QWidget()
        self.setParent(self.paper)  # goes with it
        grid = QGridLayout(self.paper)
        grid.setContentsMargins(0, 0, 0, 0)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(2)
        for column, widget in enumerate(self.widgets()):
            grid.addWidget(widget, 0, column)
        grid.setColumnStretch(self.widgets().index(self.range), 1)
        grid.addWidget(self.message, 1, 0, 1, len(self.widgets()))

    def boxes(self) -> tuple[LiveBox, ...]:
        return self.at, self.level

    def widgets(self) -> tuple[QWidget, ...]:
        """From left to right; the message stands below."""
        first, second, third = self.words
        return first, self.at, second, self.level, third, self.range, self.close


__all__ = ["NO_NUMBER", "LiveBox", "PrecisionPointRow", "RangedRow", "SettingRow", "quiet"]
