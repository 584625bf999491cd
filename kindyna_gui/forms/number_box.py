"""Boxes for numbers, words and names: typed text is calculated, stepped by keys, wheel and arrows, and confirmed.

Window shortcuts work everywhere. Shortcuts of a view (``Qt.WidgetWithChildrenShortcut``) work inside it, except while a
text in it is edited: Ctrl+D typed into the start of the motion deletes no segment. A text field keeps the keys that edit
text.
"""

from __future__ import annotations

import ast
import math
import operator
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
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
from core.number_text import shortest
from core.units import Unit, accepted_units
from kindyna_gui.labels import allowed_text, no_number, rounded_to, value_text
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.settings import DIGITS, DISPLAY, number_text, point, size_of, symbol_of, typed

# -- keys of text fields and shortcuts -------------------------------------------------------------------

Keys = QKeySequence.StandardKey
UNDO_KEYS = (Keys.Undo, Keys.Redo)
EDITING = (Keys.SelectAll, Keys.Copy, Keys.Cut, Keys.Paste, Keys.Undo, Keys.Redo)
_CTRL = Qt.KeyboardModifier.ControlModifier
_VIEW = Qt.ShortcutContext.WidgetWithChildrenShortcut


_READ_EVENTS = (QHelpEvent, QKeyEvent)


class TextKeys:
    """Mixin of text fields, before their Qt class: decides between shortcuts and typed text."""

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


def leaves_undo(field: Any, event: QEvent) -> bool:
    """Ignore an undo key of a field that is not being typed into, so that the window gets it; return whether it is one."""
    if not isinstance(event, QKeyEvent) or event.type() != QEvent.Type.ShortcutOverride:
        return False
    if not any(event.matches(key) for key in UNDO_KEYS) or field.is_typing:
        return False
    event.ignore()
    return True


def is_window_shortcut(event: QKeyEvent) -> bool:
    """Whether a key may be a shortcut of the window: Ctrl with a letter or a digit, unless that edits text.

    A line edit would claim some of these keys too, on X11 Ctrl+E to go to its end.
    """
    is_alphanumeric = 0 <= event.key() < 0x80 and chr(event.key()).isalnum()
    return bool(event.modifiers() & _CTRL) and is_alphanumeric and not any(event.matches(key) for key in EDITING)


# -- typed numbers and calculations ----------------------------------------------------------------------

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d{1,3})?", re.ASCII)
_SIGNS = str.maketrans({"\u2212": "-", "×": "*", "÷": "/", "\u00a0": " ", "\u202f": "", "\u2009": ""})
_LONGEST = 100  # characters of a calculation

_OPERATIONS: Mapping[type, Callable[[Fraction, Fraction], Fraction]] = MappingProxyType(
    {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv}
)


def parsed(text: str, unit: Unit, *, in_file_units: bool = False) -> float | None:
    """Return the number that a text means, in the field's unit; None where the text is no number.

    ``12.5``, ``12.5 mm``, ``3*12``, ``(86 + 2)/4``, ``1 in``, ``0.5 rad``: + - * / and parentheses are calculated exactly
    and rounded once. A unit of the same kind may follow. A number without a unit is in the unit on display, or in the
    field's unit with ``in_file_units``.
    """
    rest, factor = _without_unit(typed(text).translate(_SIGNS).strip(), unit)
    if in_file_units and rest == typed(text).translate(_SIGNS).strip():
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
    """Return the text before a unit, and the factor from that unit to the field's."""
    for symbol, factor in accepted_units(unit.symbol).items():
        rest = text.removesuffix(symbol)
        if rest != text and rest.strip() and not (rest[-1].isalpha() or rest[-1] in "/·^"):
            return rest.strip(), factor
    return text, accepted_units(unit.symbol).get(symbol_of(unit.symbol), Fraction(1))


def _calculated(text: str) -> Fraction | None:
    """Return the exact value of a calculation; None where the text is none, or it divides by zero."""
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


# -- sizes, steps and keys -------------------------------------------------------------------------------

_ELSEWHERE = (
    Qt.FocusReason.PopupFocusReason,
    Qt.FocusReason.MenuBarFocusReason,
    Qt.FocusReason.ActiveWindowFocusReason,
)
_PADDING = 2  # pixels between a line's text and its sides
_BUTTONS = 28  # pixels for the arrows and the frame
NOTCH = 120  # angle of one notch of the wheel, in eighths of a degree
_ROUND_STEPS = (
    ("1", 1.5),
    ("2", 3.5),
    ("5", 7.5),
    ("10", math.inf),
)  # step, and the leading digits up to which it is used


def scale_of(modifiers: Qt.KeyboardModifier) -> float:
    """Return the factor on a step for the pressed keys: 0.1 with Ctrl, 10 with Shift."""
    tenth = 0.1 if modifiers & Qt.KeyboardModifier.ControlModifier else 1.0
    return tenth * (10.0 if modifiers & Qt.KeyboardModifier.ShiftModifier else 1.0)


def row_height(widget: QWidget) -> int:
    """Return the height of every editor in a form [pixels], so that rows are even."""
    return widget.fontMetrics().height() + 8


# -- boxes -----------------------------------------------------------------------------------------------


def request_menu(part: Any, event: QContextMenuEvent) -> None:
    """Emit ``menu_requested`` of a part of a form with an empty menu; the menu is deleted when closed or not shown."""
    menu = QMenu(part)
    menu.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    part.menu_requested.emit(event.globalPos(), menu)
    if not menu.isVisible():
        menu.deleteLater()


class RedFrame:
    """Mixin that draws a red frame around a refused value, and a dashed one around a value that does not fit the others."""

    _refused = _waits = False

    def set_waiting(self, on: bool) -> None:
        if on != self._waits:
            self._waits = on
            self.update()  # type: ignore[attr-defined]

    @property
    def is_waiting(self) -> bool:
        """Whether the value is typed but not applied, because it does not fit the other values yet."""
        return self._waits

    def set_refused(self, on: bool) -> None:
        if on != self._refused:
            self._refused = on
            self.update()  # type: ignore[attr-defined]

    @property
    def is_refused(self) -> bool:
        """Whether the text or value was refused."""
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
    """A combo box that leaves the wheel to the form until it has the focus.

    Signals: ``withdrawn`` when Escape restores the value before a refused choice; ``menu_requested`` with the point on the
    screen (QPoint) and an empty menu (QMenu) to fill.
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
        """Set height and width for the font size."""
        self.setFixedHeight(row_height(self))

    def wheelEvent(self, event: QWheelEvent) -> None:
        if self.hasFocus():
            super().wheelEvent(event)
        else:
            event.ignore()

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        request_menu(self, event)

    def withdraw(self) -> None:
        """Discard a refused choice."""
        self.withdrawn.emit()

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.is_refused:
            self.withdraw()
        else:
            super().keyPressEvent(event)


class NameBox(TextKeys, RedFrame, QLineEdit):
    """A line of text with a red frame when it is refused."""


class _Line(QLineEdit):
    """The line edit of a number box: paints the number rounded to its width, while its text has every digit."""

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
    """The number of one field.

    Arrows, arrow keys and the wheel (only with the focus) step it: with Ctrl by a tenth of the step, with Shift by ten
    times. Typed text, also a calculation or another unit, is confirmed by Enter or when the focus leaves. Escape, or undo
    while typing, restores the number. A wrong text remains until it is corrected or withdrawn. An optional field reads an
    empty text as None.

    Signals: ``entered`` (float | None) when a step is made or a typed number confirmed, ``stepping`` before that of a step;
    ``unreadable`` when the confirmed
    text is no number; ``finished`` at the end of the gesture (Enter, mouse released, focus left); ``withdrawn`` when the
    typed text is discarded; ``menu_requested`` with the point on the screen (QPoint) and the menu of the text (QMenu).
    With ``in_file_units`` it shows the field's unit, whatever the preferences say.
    """

    in_file_units = False

    stepping = Signal()
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
        self._tried = ""  # the text last confirmed or shown
        self._scale = 1.0  # factor on a step while an arrow is pressed
        self._wheel_angle = 0  # rest below a notch
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setAlignment(Qt.AlignmentFlag.AlignRight | Qt.AlignmentFlag.AlignVCenter)
        self.setAccelerated(True)
        self.setKeyboardTracking(False)
        self.update_style()
        self.show_value(0.0)
        DISPLAY.changed.connect(self._show_in_units)

    def update_style(self) -> None:
        """Set height and width for the font size."""
        self.setFixedHeight(row_height(self))
        self.setMinimumWidth(QFontMetrics(self.font()).horizontalAdvance("-1234.567") + _BUTTONS)

    # -- the number ---------------------------------------------------------------------------------------

    def _text(self, value: float | None) -> str:
        return "" if value is None else number_text(value, NO_UNIT if self.in_file_units else self._unit)

    @property
    def _size(self) -> float:
        """The unit on display, in the field's unit."""
        return 1.0 if self.in_file_units else size_of(self._unit.symbol)

    def _show_in_units(self) -> None:
        """Show the number in the units on display, unless a text is being typed or was refused."""
        if not self.is_refused and self.text() == self._tried:
            self.show_value(self._value)

    @property
    def value(self) -> float | None:
        """The number last shown or entered."""
        return self._value

    @property
    def info(self) -> Info:
        """Name and range of the number."""
        return self._info

    @property
    def number(self) -> float | None:
        """The number that the text means, confirmed or not; None where it is none."""
        if not self.pending:
            return self._as_whole(self._value)
        return self._as_whole(parsed(self.text(), self._unit, in_file_units=self.in_file_units))

    def _as_whole(self, number: float | None) -> float | None:
        is_whole = self._info.whole and number is not None and number == int(number)
        return int(number) if is_whole and number is not None else number

    def with_unit(self, value: float) -> str:
        """Return a number with its unit, as the box shows it: ``90 mm``."""
        return value_text(float(value), self._unit, in_file_units=self.in_file_units)

    def fault(self, info: Info | None = None) -> str:
        """Return why the text is not allowed, with its number and the allowed range; empty where it is allowed.

        ``info`` is the range where not that of the box.
        """
        field, number = info or self._info, self.number
        if number is None:
            return "" if field.optional and not self.text().strip() else no_number(self.text())
        if field.admits(number):
            return ""
        problem = "must be a whole number" if field.whole and number != int(number) else field.problem
        allowed = allowed_text(field, self._unit, in_file_units=self.in_file_units)
        return f"{problem}; allowed: {allowed}, not {self.with_unit(number)}"

    def use(self, value: float) -> None:
        """Enter a number, as a remedy does, as a gesture of its own."""
        self.finished.emit()
        self.lineEdit().setText(self._text(value))
        self._tried = self.text()
        self.entered.emit(value)
        self.finished.emit()

    def show_value(self, value: float | None) -> None:
        """Show a number, or an empty text for None."""
        self._value = value
        self._tried = self._text(value)
        self.set_refused(False)
        if self.text() != self._tried:
            is_selected = self.lineEdit().selectedText() == self.text() != ""
            self.lineEdit().setText(self._tried)
            if is_selected:
                self.lineEdit().selectAll()

    @property
    def shortened(self) -> str:
        """The number rounded to the width of the field, as it is painted; '' where there is room for all of its digits.

        Also '' while a text is being typed or was refused.
        """
        if self.hasFocus() or self.pending or self._value is None:
            return ""
        value = self._value
        line = self.lineEdit()
        metrics, width = line.fontMetrics(), line.contentsRect().width() - 2 * _PADDING
        if metrics.horizontalAdvance(self.text()) <= width:
            return ""
        shown = value / self._size
        return rounded_to(shown, lambda text: metrics.horizontalAdvance(text) <= width).replace(".", point())

    def _exact_text(self) -> str:
        """Number with all digits, in the unit of files; '' where the box shows them."""
        if self._value is None or self.pending:
            return ""
        shown = parsed(self.text(), self._unit, in_file_units=self.in_file_units)
        is_exact = shown is not None and math.isclose(shown, self._value, rel_tol=10.0 ** (1 - DIGITS))
        return "" if is_exact and not self.shortened else value_text(float(self._value), self._unit, in_file_units=True)

    @property
    def is_typing(self) -> bool:
        """Whether a typed text is not confirmed yet."""
        return self.text() != self._tried

    @property
    def pending(self) -> bool:
        """Whether the text is not that of the number: it is being typed, or was refused."""
        return self.text() != self._text(self._value)

    def confirm(self) -> None:
        """Confirm the typed text as the number."""
        if not self.pending:
            was_refused = self.is_refused
            self.show_value(self._value)
            if was_refused:  # the number was typed again over the refused text
                self.withdrawn.emit()
            return
        self._tried = self.text()
        number = self.number
        if number is None and not (self._info.optional and not self.text().strip()):
            self.unreadable.emit()
        else:
            self.entered.emit(number)

    def withdraw(self) -> None:
        """Discard the typed text and show the number again."""
        self.show_value(self._value)
        self.lineEdit().selectAll()
        self.withdrawn.emit()

    # -- steps --------------------------------------------------------------------------------------------

    def step_of(self, value: float) -> float:
        """Return the step of the field, else about a hundredth of the value: 1, 2 or 5 times a power of ten."""
        if self._info.step:
            return self._info.step
        if not value or (self._info.whole and abs(value) < 100.0):
            return 1.0
        power = math.floor(math.log10(abs(value))) - 2
        leading = abs(value) / 10.0 ** (power + 2)  # 1 ... 10
        return float(f"{next(step for step, most in _ROUND_STEPS if leading < most)}e{power}")

    def stepped(self, value: float, steps: int, scale: float = 1.0) -> float:
        """Return the value after some steps, added in decimals in the unit on display, within the range."""
        size = self._size
        shown = value if size == 1.0 else float(f"{value / size:.{DIGITS}g}")
        step = Decimal(shortest(self.step_of(shown))) * Decimal(shortest(scale))
        result = float(Decimal(shortest(shown)) + steps * step) * size
        result = min(max(result, self._info.low), self._info.high) + 0.0
        result = round(result) if self._info.whole else result
        return value if self._info.open_low and result <= self._info.low else result

    def stepBy(self, steps: int) -> None:
        self.step_by(steps, self._scale)

    def step_by(self, steps: int, scale: float = 1.0) -> None:
        """Enter the number after some steps, each of ``scale`` times the step."""
        number = self.number if self.pending else self._value
        start = (self._value or 0.0) if number is None else number
        result = self.stepped(start, steps, scale)
        if result == start:
            return
        self.lineEdit().setText(self._text(result))
        self.lineEdit().selectAll()
        self._tried = self.text()
        self.stepping.emit()
        self.entered.emit(result)

    def drag_by(self, steps: int) -> None:
        """Step the number while the field's name is dragged, in finer steps, for there are many."""
        self.step_by(steps, 1.0 if self._info.step else 0.1)

    def stepEnabled(self) -> QAbstractSpinBox.StepEnabledFlag:
        both = QAbstractSpinBox.StepEnabledFlag.StepUpEnabled | QAbstractSpinBox.StepEnabledFlag.StepDownEnabled
        return QAbstractSpinBox.StepEnabledFlag.StepNone if self.isReadOnly() else both

    def validate(self, text: str, position: int) -> Any:
        """Accept any text while typing; a wrong one is reported on Enter."""
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
            event.matches(QKeySequence.StandardKey.Undo) and self.is_typing
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
        if self.is_typing:
            self.confirm()
        self.finished.emit()

    def mousePressEvent(self, event: QMouseEvent) -> None:
        """Press an arrow; Qt itself would make ten steps with Ctrl."""
        self._scale = scale_of(event.modifiers())
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
        self._scale = 1.0
        self.finished.emit()

    def wheelEvent(self, event: QWheelEvent) -> None:
        if not self.hasFocus() or self.isReadOnly():
            event.ignore()
            return
        self._wheel_angle += event.angleDelta().y() or event.angleDelta().x()
        steps = int(self._wheel_angle / NOTCH)
        self._wheel_angle -= steps * NOTCH
        if steps:
            self.step_by(steps, scale_of(event.modifiers()))
        event.accept()

    def event(self, event: QEvent) -> bool:
        """Leave the undo keys to the window unless a text is being typed, and show all digits in the tip.

        The line edit would claim the undo keys always. The tip begins with all digits of a number that is shown rounded.
        """
        if not isinstance(event, _READ_EVENTS):  # a form that changes sends hundreds to each box
            return QAbstractSpinBox.event(self, event)
        if isinstance(event, QHelpEvent) and event.type() == QEvent.Type.ToolTip and (full := self._exact_text()):
            QToolTip.showText(event.globalPos(), "<br>".join(filter(None, (full, self.toolTip()))), self)
            return True
        return not leaves_undo(self, event) and super().event(event)


class LiveBox(NumberBox):
    """Number box that emits ``changed`` whenever its number, or why it is not allowed, changes while the user types."""

    changed = Signal()

    def __init__(self, info: Info, unit: Unit = NO_UNIT, name: str = "") -> None:
        super().__init__(info, unit)
        self._previous: tuple[float | None, str] = (None, "")
        self.setAccessibleName(name or info.label)
        self.entered.connect(self._accept)
        self.unreadable.connect(self._emit_changed)
        self.withdrawn.connect(self._emit_changed)
        self.lineEdit().textEdited.connect(self._emit_changed)

    def set_number(self, value: float | None) -> None:
        """Show a number without emitting ``changed``."""
        self.show_value(value)
        self._previous = self.number, self.fault()

    def set_step(self, step: float) -> None:
        """Set the step of the arrows."""
        if step != self._info.step:
            self._info = replace(self._info, step=step)

    def _accept(self, value: float | None) -> None:
        """Show a confirmed number; one that is not allowed stays as it is typed."""
        if not self.fault():
            refused = self.is_refused
            self.show_value(value)
            self.set_refused(refused)
        self._emit_changed()

    def _emit_changed(self, *_: object) -> None:
        if (now := (self.number, self.fault())) != self._previous:
            self._previous = now
            self.changed.emit()
