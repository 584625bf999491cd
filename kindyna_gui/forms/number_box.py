"""Numbers typed."""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from decimal import Decimal
from fractions import Fraction
from types import MappingProxyType
from typing import Any

from PySide6.QtCore import QEvent, QRectF, Qt, Signal
from PySide6.QtGui import (
    QColor,
    QContextMenuEvent,
    QFocusEvent,
    QFontMetrics,
    QHelpEvent,
    QKeyEvent,
    QKeySequence,
    QMouseEvent,
    QPainter,
    QPaintEvent,
    QPalette,
    QPen,
    QValidator,
    QWheelEvent,
)
from PySide6.QtWidgets import (
    QAbstractSpinBox,
    QComboBox,
    QLineEdit,
    QMenu,
    QStyle,
    QStyleOptionFrame,
    QToolTip,
    QWidget,
)

from core.design import NO_UNIT, Info
from core.output.lines import shortest
from core.units import Unit, accepted_units
from kindyna_gui.labels import rounded_to, value_text
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.settings import DIGITS, TOLD, number_text, point, size_of, symbol_of, typed

# -- text keys -------------------------------------------------------------------------------------------

# Shortcuts of the window act everywhere. Those of a view (``Qt.WidgetWithChildrenShortcut``) act in it, but not while a
# text inside it is being edited: Ctrl+D typed into the start of the motion deletes no segment. Keys that edit text are the
# field's own.

Keys = QKeySequence.StandardKey
EDITING = (Keys.SelectAll, Keys.Copy, Keys.Cut, Keys.Paste, Keys.Undo, Keys.Redo)
_CTRL = Qt.KeyboardModifier.ControlModifier
_VIEW = Qt.ShortcutContext.WidgetWithChildrenShortcut


class TextKeys:
    """For fields: a mixin before the class of Qt."""

    def event(self, event: QEvent) -> bool:
        if event.type() == QEvent.Type.ShortcutOverride and isinstance(event, QKeyEvent):
            assert isinstance(self, QWidget)
            if is_view_shortcut(self, event):
                event.accept()
                return True
            if is_window_shortcut(event):
                event.ignore()
                return False
        return bool(super().event(event))  # type: ignore[misc]


def is_view_shortcut(field: QWidget, event: QKeyEvent) -> bool:
    """Whether a key is a shortcut of a view around the field."""
    keys, at = QKeySequence(event.keyCombination()), field.parentWidget()
    while at is not None:
        if any(action.shortcutContext() == _VIEW and action.shortcut() == keys for action in at.actions()):
            return True
        at = None if at.isWindow() else at.parentWidget()
    return False


def is_window_shortcut(event: QKeyEvent) -> bool:
    """Whether a key may be a shortcut of the window: Ctrl and a letter or a digit that edits no text. A line of text
    would claim some of these too, on X11 Ctrl+E for its end."""
    letter = 0 <= event.key() < 0x80 and chr(event.key()).isalnum()
    return bool(event.modifiers() & _CTRL) and letter and not any(event.matches(key) for key in EDITING)


# -- typed number ----------------------------------------------------------------------------------------

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)
_SIGNS = str.maketrans({"\u2212": "-", "×": "*", "÷": "/", "\u00a0": " "})
_LONGEST = 100  # characters of a calculation

_OPERATIONS: Mapping[type, Callable[[Fraction, Fraction], Fraction]] = MappingProxyType(
    {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
)


def parsed(text: str, unit: Unit, *, kept: bool = False) -> float | None:
    """The number that a text means in the field's own unit; None where it is none.

    ``12.5``, ``12.5 mm``, ``3*12``, ``(86 + 2)/4``, ``1 in``, ``0.5 rad``: + - * / and parentheses are calculated exactly, as
    a reader would, and rounded once; a unit of the same kind may stand behind all. Without one the number counts in the unit that
    the field is shown in; kept: in its own.
    """
    rest, factor = _without_unit(typed(text).translate(_SIGNS).strip(), unit)
    if kept and rest == typed(text).translate(_SIGNS).strip():
        factor = Fraction(1)
    if _NUMBER.fullmatch(rest) and factor == 1:
        value = float(rest)
    else:
        exact = _calculated(rest)
        if exact is None:
            return None
        try:
            value = float(exact * factor)
        except OverflowError:
            return None
    return value + 0.0 if math.isfinite(value) else None


def _without_unit(text: str, unit: Unit) -> tuple[str, Fraction | float]:
    """The text before a unit, and how many of the field's own it is."""
    for symbol, factor in accepted_units(unit.symbol).items():
        rest = text.removesuffix(symbol)
        if rest != text and rest.strip() and not (rest[-1].isalpha() or rest[-1] in "/·^"):
            return rest.strip(), factor
    return text, accepted_units(unit.symbol).get(symbol_of(unit.symbol), Fraction(1))


def _calculated(text: str) -> Fraction | None:
    """The exact value of a calculation; None where it is none, or has none."""
    if len(text) > _LONGEST or re.search(r"[^-+*/().0-9eE\s]|\*\*|//", text):
        return None
    try:
        return _value(ast.parse(text.strip(), mode="eval").body, text.strip())
    except (SyntaxError, ValueError, ZeroDivisionError, RecursionError, MemoryError):
        return None


def _value(node: ast.AST, text: str) -> Fraction:
    match node:
        case ast.Constant(value=int() | float()):
            digits = ast.get_source_segment(text, node) or ""
            if not _NUMBER.fullmatch(digits):
                raise ValueError(digits)
            return Fraction(digits)
        case ast.UnaryOp(op=ast.USub(), operand=operand):
            return -_value(operand, text)
        case ast.UnaryOp(op=ast.UAdd(), operand=operand):
            return _value(operand, text)
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _OPERATIONS:
            return _OPERATIONS[type(op)](_value(left, text), _value(right, text))
    raise ValueError(text)


# -- number box ------------------------------------------------------------------------------------------

UNDO_KEYS = (QKeySequence.StandardKey.Undo, QKeySequence.StandardKey.Redo)
_ELSEWHERE = (
    Qt.FocusReason.PopupFocusReason,
    Qt.FocusReason.MenuBarFocusReason,
    Qt.FocusReason.ActiveWindowFocusReason,
)
_PADDING = 2  # of a line's text from its sides, pixels
_BUTTONS = 28  # pixels for the arrows and the frame


NOTCH = 120  # of a wheel's angle, in eighths of a degree
_ROUND_STEPS = (("1", 1.5), ("2", 3.5), ("5", 7.5), ("10", math.inf))  # the step, and below which share of its power


def scale_of(modifiers: Qt.KeyboardModifier) -> float:
    """What the keys held make of a step: Ctrl a tenth, Shift ten times."""
    tenth = 0.1 if modifiers & Qt.KeyboardModifier.ControlModifier else 1.0
    return tenth * (10.0 if modifiers & Qt.KeyboardModifier.ShiftModifier else 1.0)


def row_height(widget: QWidget) -> int:
    """Of every editor, so that the rows of a form are even."""
    return widget.fontMetrics().height() + 8


class RedFrame:
    """For widgets whose text was refused: a red frame, drawn over the style's own; a dashed one where the value waits for others to
    fit to it."""

    _refused = _waits = False

    def set_waiting(self, on: bool) -> None:
        if on != self._waits:
            self._waits = on
            self.update()  # type: ignore[attr-defined]

    @property
    def waits(self) -> bool:
        """Whether what stands here is typed but not in place, since it does not fit to the rest yet."""
        return self._waits

    def set_refused(self, on: bool) -> None:
        if on != self._refused:
            self._refused = on
            self.update()  # type: ignore[attr-defined]

    @property
    def refused(self) -> bool:
        """Whether what stands here cannot be."""
        return self._refused

    def paintEvent(self, event: QPaintEvent) -> None:
        super().paintEvent(event)  # type: ignore[misc]
        if self._refused or self._waits:
            assert isinstance(self, QWidget)
            painter = QPainter(self)
            painter.setRenderHint(QPainter.RenderHint.Antialiasing)
            style = Qt.PenStyle.SolidLine if self._refused else Qt.PenStyle.DashLine
            painter.setPen(QPen(QColor(SCREEN.limit), 1.6, style))
            painter.drawRoundedRect(QRectF(self.rect()).adjusted(0.8, 0.8, -0.8, -0.8), 2.0, 2.0)
            painter.end()


class WordBox(RedFrame, QComboBox):
    """A combo box that lets the wheel scroll the form until it has been chosen.

    withdrawn   Escape: what was chosen, and refused, is taken back
    menu_requested  (QPoint, QMenu): what can be done with it, at this place of the screen, by a menu that is empty yet
    """

    withdrawn = Signal()
    menu_requested = Signal(object, object)

    def __init__(self) -> None:
        super().__init__()
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizeAdjustPolicy(QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.setMinimumContentsLength(6)
        self.update_style()

    def update_style(self) -> None:
        """As high and wide as its letters want it."""
        self.setFixedHeight(row_height(self))

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = QMenu(self)
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.menu_requested.emit(event.globalPos(), menu)
        if not menu.isVisible():
            menu.deleteLater()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.refused:
            self.withdrawn.emit()
        else:
            super().keyPressEvent(event)


class NameBox(TextKeys, RedFrame, QLineEdit):
    """A line of text."""


class _Line(QLineEdit):
    """The line inside of a number box. What it has no room for is painted rounded, its first digits first, until it is
    typed into; its text keeps every digit."""

    def paintEvent(self, event: QPaintEvent) -> None:
        box = self.parentWidget()
        short = box.shortened if isinstance(box, NumberBox) else ""
        if not short:
            super().paintEvent(event)
            return
        option = QStyleOptionFrame()
        self.initStyleOption(option)
        painter = QPainter(self)
        self.style().drawPrimitive(QStyle.PrimitiveElement.PE_PanelLineEdit, option, painter, self)
        painter.setPen(self.palette().color(QPalette.ColorRole.Text))
        painter.drawText(self.contentsRect().adjusted(_PADDING, 0, -_PADDING, 0), self.alignment(), short)
        painter.end()


class NumberBox(TextKeys, RedFrame, QAbstractSpinBox):
    """A number of one field.

    Arrows, wheel (only when chosen) and arrow keys step it, with Ctrl by a tenth, with Shift by ten times as much; typed text,
    a calculation or another unit too, counts on Enter or when the focus leaves.
    Escape, or undo while typing, takes back what was typed. A wrong text stays until it is right or taken back.

    A field that may be empty takes an empty text for None.

    entered      (float | None): a step was made, or a typed number confirmed
    unreadable   a text that is no number was confirmed
    finished     the gesture is over: Enter, mouse released, focus left
    withdrawn    what was typed is taken back
    menu_requested  (QPoint, QMenu): what can be done with it, at this place of the screen; the menu has what edits the text

    in_file_units      it shows its own unit, whatever the user prefers: what stands around it does so
    """

    in_file_units = False

    entered = Signal(object)
    unreadable = Signal()
    finished = Signal()
    withdrawn = Signal()
    menu_requested = Signal(object, object)

    def __init__(self, info: Info, unit: Unit = NO_UNIT, parent: QWidget | None = None) -> None:
        super().__init__(parent)
        self.setLineEdit(_Line(self))
        self._info, self._unit = info, unit
        self.setAccessibleName(info.label)
        self._value: float | None = 0.0
        self._tried = ""  # the text that was last confirmed or shown
        self._finer = 1.0  # what the keys held while an arrow is pressed make of a step
        self._wheeled = 0  # parts of a notch
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.setAccelerated(True)
        self.setKeyboardTracking(False)
        self.update_style()
        self.show_value(0.0)
        TOLD.changed.connect(self._show_otherwise)

    def update_style(self) -> None:
        """As high and wide as its letters want it."""
        self.setFixedHeight(row_height(self))
        self.setMinimumWidth(QFontMetrics(self.font()).horizontalAdvance("-1234.567") + _BUTTONS)

    # -- the number ---------------------------------------------------------------------------------------

    def _text(self, value: float | None) -> str:
        return "" if value is None else number_text(value, NO_UNIT if self.in_file_units else self._unit)

    @property
    def _size(self) -> float:
        """How many of its own unit one is of that which is shown."""
        return 1.0 if self.in_file_units else size_of(self._unit.symbol)

    def _show_otherwise(self) -> None:
        """In other units; what is typed stays."""
        if not self.refused and self.text() == self._tried:
            self.show_value(self._value)

    @property
    def value(self) -> float | None:
        """The number last shown or entered."""
        return self._value

    def show_value(self, value: float | None) -> None:
        """Show a number, or nothing, in place of whatever stands there."""
        self._value = value
        self._tried = self._text(value)
        self.set_refused(False)
        if self.text() != self._tried:
            chosen = self.lineEdit().selectedText() == self.text() != ""
            self.lineEdit().setText(self._tried)
            if chosen:
                self.lineEdit().selectAll()

    @property
    def shortened(self) -> str:
        """The number as it is painted where its field is too narrow for it: rounded to what the field holds; '' where
        all of it is seen, or something is being typed or was refused."""
        if self.hasFocus() or self.pending or self._value is None:
            return ""
        value = self._value
        line = self.lineEdit()
        metrics, room = line.fontMetrics(), line.contentsRect().width() - 2 * _PADDING
        if metrics.horizontalAdvance(self.text()) <= room:
            return ""
        shown = value / self._size
        return rounded_to(shown, lambda text: metrics.horizontalAdvance(text) <= room).replace(".", point())

    @property
    def typing(self) -> bool:
        """Something was typed that is not confirmed yet."""
        return self.text() != self._tried

    @property
    def pending(self) -> bool:
        """What stands there is not the number in place: it is being typed, or was refused."""
        return self.text() != self._text(self._value)

    def confirm(self) -> None:
        """Confirm the typed text as the number."""
        if not self.pending:
            mended = self.refused
            self.show_value(self._value)
            if mended:  # the number in place was typed over what was refused
                self.withdrawn.emit()
            return
        self._tried = self.text()
        number = parsed(self.text(), self._unit, kept=self.in_file_units)
        if number is None and not (self._info.optional and not self.text().strip()):
            self.unreadable.emit()
        else:
            self.entered.emit(number)

    def withdraw(self) -> None:
        """Forget the text; the number in place shows again."""
        self.show_value(self._value)
        self.lineEdit().selectAll()
        self.withdrawn.emit()

    # -- steps --------------------------------------------------------------------------------------------

    def step_of(self, value: float) -> float:
        """The field's own step, else about a hundredth of the value: the nearest of 1, 2, 5 times a power of ten."""
        if self._info.step:
            return self._info.step
        if not value:
            return 1.0
        power = math.floor(math.log10(abs(value))) - 2
        share = abs(value) / 10.0 ** (power + 2)  # 1 ... 10
        return float(f"{next(step for step, most in _ROUND_STEPS if share < most)}e{power}")

    def stepped(self, value: float, steps: int, scale: float = 1.0) -> float:
        """The value so many steps on, in decimals as a reader would add them in the unit that is shown, within the range."""
        size = self._size
        shown = value if size == 1.0 else float(f"{value / size:.{DIGITS}g}")
        step = Decimal(shortest(self.step_of(shown))) * Decimal(shortest(scale))
        moved = float(Decimal(shortest(shown)) + steps * step) * size
        moved = min(max(moved, self._info.low), self._info.high) + 0.0
        return value if self._info.open_low and moved <= self._info.low else moved

    def stepBy(self, steps: int) -> None:
        self.step_by(steps, self._finer)

    def step_by(self, steps: int, scale: float = 1.0) -> None:
        """So many steps of ``scale`` times the usual size."""
        number = parsed(self.text(), self._unit, kept=self.in_file_units) if self.pending else self._value
        start = (self._value or 0.0) if number is None else number
        moved = self.stepped(start, steps, scale)
        if moved == start:
            return
        self.lineEdit().setText(self._text(moved))
        self.lineEdit().selectAll()
        self._tried = self.text()
        self.entered.emit(moved)

    def drag_by(self, steps: int) -> None:
        """What a pull at the field's name makes of it: finer steps, for there are many."""
        self.step_by(steps, 1.0 if self._info.step else 0.1)

    def stepEnabled(self) -> QAbstractSpinBox.StepEnabledFlag:
        both = QAbstractSpinBox.StepEnabledFlag.StepUpEnabled | QAbstractSpinBox.StepEnabledFlag.StepDownEnabled
        return QAbstractSpinBox.StepEnabledFlag.StepNone if self.isReadOnly() else both

    def validate(self, text: str, position: int) -> Any:
        """Any text may be typed; a wrong one is reported on Enter."""
        return QValidator.State.Acceptable, text, position

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        menu = self.lineEdit().createStandardContextMenu()
        menu.setParent(self, menu.windowFlags())
        menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
        self.menu_requested.emit(event.globalPos(), menu)
        if not menu.isVisible():
            menu.popup(event.globalPos())

    # -- gestures -----------------------------------------------------------------------------------------

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.confirm()
            self.finished.emit()
            self.lineEdit().selectAll()
        elif (event.key() == Qt.Key.Key_Escape and self.pending) or (
            event.matches(QKeySequence.StandardKey.Undo) and self.typing
        ):
            self.withdraw()
        elif event.key() in (Qt.Key.Key_Up, Qt.Key.Key_Down) and not self.isReadOnly():
            self.step_by(1 if event.key() == Qt.Key.Key_Up else -1, scale_of(event.modifiers()))
        else:
            super().keyPressEvent(event)

    def focusOutEvent(self, event: QFocusEvent) -> None:
        super().focusOutEvent(event)
        if event.reason() in _ELSEWHERE:
            return
        if self.typing:
            self.confirm()
        self.finished.emit()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """On an arrow; Qt itself would make ten steps of one with Ctrl."""
        self._finer = scale_of(event.modifiers())
        plain = QMouseEvent(
            event.type(),
            event.position(),
            event.globalPosition(),
            event.button(),
            event.buttons(),
            Qt.KeyboardModifier.NoModifier,
        )
        super().mousePressEvent(plain)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        super().mouseReleaseEvent(event)
        self._finer = 1.0
        self.finished.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if not self.hasFocus() or self.isReadOnly():
            event.ignore()
            return
        self._wheeled += event.angleDelta().y() or event.angleDelta().x()
        steps = int(self._wheeled / NOTCH)
        self._wheeled -= steps * NOTCH
        if steps:
            self.step_by(steps, scale_of(event.modifiers()))
        event.accept()

    def event(self, event: QEvent) -> bool:
        """The line inside claims the keys of undo; that is right only while something is being typed. The tip of a
        number that is shown rounded begins with all its digits."""
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip and self.shortened:
            full = value_text(self._value or 0.0, self._unit)
            QToolTip.showText(event.globalPos(), "<br>".join(filter(None, (full, self.toolTip()))), self)
            return True
        if isinstance(event, QKeyEvent) and event.type() == QEvent.Type.ShortcutOverride:
            is_undo = any(event.matches(key) for key in UNDO_KEYS)
            if is_undo and not self.typing:
                event.ignore()
                return False
        return super().event(event)
