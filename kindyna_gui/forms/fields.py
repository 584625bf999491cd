"""One field of a design as a row of a form: name, editor, unit, mark of an assumed value.

``FieldSpec`` says what the row shows, ``Field`` binds it to the session: an entered value becomes an edit, a refusal
floats at the editor.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from html import escape
from itertools import pairwise
from typing import TYPE_CHECKING, Any

from PySide6.QtCore import QEvent, QObject, QPoint, Qt, Signal
from PySide6.QtGui import QAction, QColor, QContextMenuEvent, QKeyEvent, QMouseEvent, QPainter, QPaintEvent
from PySide6.QtWidgets import (
    QAbstractButton,
    QComboBox,
    QGridLayout,
    QLabel,
    QMenu,
    QSizePolicy,
    QWidget,
)

from core.design import Design, Entry, Info, get, is_assumed, names_a_link
from core.errors import DesignError
from core.frozen import frozen
from core.project.reading_faults import reason
from core.units import Unit
from kindyna_gui.dialogs import FIELD
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.number_box import NameBox, NumberBox, WordBox, leaves_undo, parsed, request_menu
from kindyna_gui.labels import allowed_text, choice_text, choice_tip, no_number, sentence, step_text, value_text
from kindyna_gui.look import coloured, described
from kindyna_gui.pictures.style import SCREEN, SMALL, font
from kindyna_gui.rebuilt import connect_all
from kindyna_gui.settings import DISPLAY, symbol_of

if TYPE_CHECKING:
    from kindyna_gui.forms.refusal import FloatingRefusal, Remedies

COLUMNS = 4  # of a form: name, editor, unit, mark
VARY_TIP = "Vary this value in Study"
NAME_TIP = "Name of the design, as reports show it"
NOT_KNOWN = "–"  # the choice of an optional word that is not given
_PIXELS_A_STEP = 6

# -- choices of dialogs ----------------------------------------------------------------------


def fill_choices(box: QComboBox, rows: Mapping[str, str]) -> None:
    """Fill a list, and keep the current choice where it is still in the list."""
    before = box.currentData()
    box.clear()
    for name, text in rows.items():
        box.addItem(text, name)
    box.setCurrentIndex(max(0, box.findData(before)))


# -- parts of a row --------------------------------------------------------------------------------------


def in_tab_order(*widgets: QWidget) -> None:
    """Set the Tab order of these widgets; without it widgets created late come last."""
    for before, after in pairwise(widgets):
        QWidget.setTabOrder(before, after)


class NameLabel(QLabel):
    """The name of a field; dragging it sideways steps the number.

    Signals: ``dragged`` with the number of further steps; ``released`` after a drag or a click; ``menu_requested`` with the
    point on the screen (QPoint) and an empty menu (QMenu) to fill.
    """

    dragged = Signal(int)
    released = Signal()
    menu_requested = Signal(object, object)

    def __init__(self, html: str, draggable: bool) -> None:
        super().__init__(html)
        self._from: QPoint | None = None
        self._steps = 0
        self._draggable = draggable
        self.setSizePolicy(QSizePolicy.Policy.Preferred, QSizePolicy.Policy.Fixed)
        if draggable:
            self.setCursor(Qt.CursorShape.SizeHorCursor)

    def contextMenuEvent(self, event: QContextMenuEvent) -> None:
        request_menu(self, event)

    def mousePressEvent(self, event: QMouseEvent) -> None:
        if event.button() == Qt.MouseButton.LeftButton:
            self._from, self._steps = event.globalPosition().toPoint(), 0

    def mouseMoveEvent(self, event: QMouseEvent) -> None:
        if self._from is None or not self._draggable:
            return
        steps = round((event.globalPosition().toPoint() - self._from).x() / _PIXELS_A_STEP)
        if steps != self._steps:
            self.dragged.emit(steps - self._steps)
            self._steps = steps

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        if self._from is not None:
            self._from = None
            self.released.emit()


class UnitLabel(QLabel):
    """The unit on display of a number."""

    def __init__(self, unit: Unit) -> None:
        super().__init__()
        self._symbol = unit.symbol
        coloured(self, SCREEN.quiet)
        self._show()
        DISPLAY.changed.connect(self._show)

    def _show(self) -> None:
        self.setText(symbol_of(self._symbol))


class AssumedMark(QAbstractButton):
    """An asterisk that is faint until checked."""

    def __init__(self) -> None:
        super().__init__(checkable=True)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)
        self.setFixedSize(18, 20)  # a layout reads it without a call of Python

    def paintEvent(self, event: QPaintEvent) -> None:
        painter = QPainter(self)
        if self.underMouse():
            painter.fillRect(self.rect(), self.palette().midlight())
        painter.setPen(QColor(SCREEN.assumed if self.isChecked() else SCREEN.line))
        painter.drawText(self.rect(), Qt.AlignmentFlag.AlignCenter, "∗")
        painter.end()


# -- what a row shows ------------------------------------------------------------------------------------


@frozen
class FieldSpec:
    """What a row shows: path, label and range (``info``), unit, and how its value is read from a design."""

    path: str
    info: Info
    unit: Unit
    read: Callable[[Design], Any]
    can_be_assumed: bool = True

    @classmethod
    def of(cls, entry: Entry) -> FieldSpec:
        """Return the specification of an entry of a design."""
        return cls(entry.path, entry.info, entry.unit, lambda design: get(design, entry.path))


def label_html(label: str) -> str:
    """Return a label as HTML with its subscripts, such as ``C_s``."""
    return re.sub(r"_(\w)", r"<sub>\1</sub>", escape(label, quote=False))


def tip_html(spec: FieldSpec) -> str:
    """Return the tip of a field as HTML: name, help, allowed range and path."""
    rows = [f"<b>{label_html(spec.info.label)}</b>"]
    if spec.info.help:
        rows.append(escape(spec.info.help))
    rows.append(escape(sentence(f"allowed: {allowed_text(spec.info, spec.unit)}")))
    rows.append(f"<span style='color:{SCREEN.quiet}'>{escape(spec.path)}</span>")
    return "<br>".join(rows)


def add_vary(menu: QMenu, session: Session, path: str) -> QAction:
    """Insert *Vary this* as the first entry of a menu."""
    first = menu.actions()[0] if menu.actions() else None
    vary = QAction("&Vary this", menu)
    vary.setToolTip(VARY_TIP)
    vary.triggered.connect(lambda: session.vary(path))
    if first is None:
        menu.addAction(vary)
    else:
        menu.insertAction(first, vary)
        menu.insertSeparator(first)
    return vary


# -- the row of a field ----------------------------------------------------------------------------------


class Field(QObject):
    """A row of a form bound to the session.

    An entered value is an edit. A value that does not fit the others yet is marked, and a refusal floats at its editor.
    """

    trouble_changed = Signal()

    def __init__(self, session: Session, spec: FieldSpec) -> None:
        super().__init__()
        self.session, self.spec = session, spec
        self._refusals: dict[str, str] = {}  # path of the refused value -> reason
        self._misfit = ""  # why the value does not fit the others, as the line below the form says
        self._last_trouble = ""
        self.reason: QLabel | None = None  # of the value that applies while the field is empty
        self.label = described(NameLabel(label_html(spec.info.label), not spec.info.choices), tip=tip_html(spec))
        self.unit: QLabel | None = None if spec.info.choices else UnitLabel(spec.unit)
        self.mark: AssumedMark | None = AssumedMark() if spec.can_be_assumed else None
        if self.mark is not None:
            self.mark.clicked.connect(self._assume)
        self.editor: NumberBox | WordBox = self._word_box() if spec.info.choices else self._number_box()
        self.editor.setToolTip(self.label.toolTip())
        self.editor.setAccessibleName(spec.info.label)
        if self.mark is not None:
            self.mark.setAccessibleName(f"{spec.info.label}: assumed")
        self.editor.setProperty(FIELD, spec.path)
        self.label.setBuddy(self.editor)
        session.refused.connect(self.show_refusal)
        session.accepted.connect(self._accepted)
        session.restored.connect(self._restored)

    def _number_box(self) -> NumberBox:
        box = NumberBox(self.spec.info, self.spec.unit)
        connect_all(
            (box.stepping, self.session.begin_step),
            (box.entered, self._enter),
            (box.unreadable, lambda: self.session.refuse(self.spec.path, no_number(box.text()))),
            (box.withdrawn, lambda: self.session.clear_refusal(self.spec.path)),
            (box.finished, self.session.end_gesture),
        )
        if not names_a_link(self.spec.path, self.spec.info):
            for part in (self.label, box):
                part.menu_requested.connect(self._open_menu)
        self.label.dragged.connect(box.drag_by)
        self.label.released.connect(self._label_released)
        return box

    def _open_menu(self, at: QPoint, menu: QMenu) -> None:
        """Offer to vary a value and to mark it as assumed; the menu of a number has the entries of its text too."""
        vary = add_vary(menu, self.session, self.spec.path)
        vary.setEnabled(self.spec.read(self.session.holder(self.spec.path)) is not None)
        if self.mark is not None:
            assumed = QAction("&Assumed", menu, checkable=True, checked=self.mark.isChecked())
            assumed.setToolTip(self.mark.toolTip())
            assumed.triggered.connect(self._assume)
            others = menu.actions()[1:]
            menu.insertAction(others[0], assumed) if others else menu.addAction(assumed)
        menu.popup(at)

    def _words(self) -> WordBox:
        """Return a list with all choices."""
        box = WordBox()
        if self.spec.info.optional:
            box.addItem(NOT_KNOWN, None)
        for word in self.spec.info.choices:
            box.addItem(choice_text(word), word)
            if choice_tip(word):
                box.setItemData(box.count() - 1, choice_tip(word), Qt.ItemDataRole.ToolTipRole)
        return box

    def _word_box(self) -> WordBox:
        box = self._words()
        box.activated.connect(self._choose)
        box.withdrawn.connect(lambda: self.session.clear_refusal(self.spec.path))
        for part in (self.label, box):
            part.menu_requested.connect(self._open_menu)
        self.label.released.connect(box.setFocus)
        return box

    def add_to(self, grid: QGridLayout, row: int) -> None:
        """Fill a row of a grid."""
        self._cell = grid, row
        grid.addWidget(self.label, row, 0)
        grid.addWidget(self.editor, row, 1, 1, 2 if self.spec.info.choices else 1)
        if self.unit is not None:
            grid.addWidget(self.unit, row, 2)
        if self.mark is not None:
            grid.addWidget(self.mark, row, COLUMNS - 1)

    def show_default(self, text: str, reason: str) -> None:
        """Show in grey the value that applies while the field is empty, with its reason below; empty texts: none."""
        assert isinstance(self.editor, NumberBox)
        line = self.editor.lineEdit()
        if line.placeholderText() == text and (self.reason is None or self.reason.text() == reason):
            return
        line.setPlaceholderText(text)
        if self.reason is None and reason:
            self.reason = coloured(QLabel(wordWrap=True), SCREEN.quiet)
            self.reason.setFont(font(SMALL))
            grid, row = self._cell
            grid.addWidget(self.reason, row + 1, 0, 1, COLUMNS)
        if self.reason is not None:
            self.reason.setText(reason)
            self.reason.setVisible(bool(reason))

    # -- from the session ---------------------------------------------------------------------------------

    @cached_property
    def message(self) -> FloatingRefusal:
        """The refusal at the editor, created with the first one."""
        from kindyna_gui.forms.refusal import FloatingRefusal  # imported here to save start-up time

        return FloatingRefusal(self.editor)

    @property
    def is_waiting(self) -> bool:
        """Whether the typed value is not applied yet."""
        return self.session.is_waiting(self.spec.path, self.spec.read)

    def refresh(self, design: Design) -> None:
        """Show the value of a design, unless the editor holds a refused text or one that is being typed."""
        if self.mark is not None:
            assumed = is_assumed(design, self.spec.path)
            meaning = "assumed, not taken from a source" if assumed else "taken from a source"
            self.mark.setChecked(assumed)
            why = reason(design, self.spec.path)
            self.mark.setToolTip(
                f"{self.spec.info.label} is {meaning}; click to change" + (f"\n\n{why}" if why else "")
            )
        self.editor.set_waiting(self.is_waiting)
        self._misfit = self.session.misfit.at(self.spec.path)
        self._show_refusals()
        if not (self.editor.is_refused or (isinstance(self.editor, NumberBox) and self.editor.is_typing)):
            self._show(design)

    def _show(self, design: Design) -> None:
        value = self.spec.read(design)
        if isinstance(self.editor, NumberBox):
            self.editor.show_value(value)
        else:
            words = [self.editor.itemData(i) for i in range(self.editor.count())]
            self.editor.setCurrentIndex(words.index(value) if value in words else -1)
            self.editor.set_refused(False)
            tip = choice_tip(value)
            self.editor.setToolTip(f"{value}: {tip}<br>{self.label.toolTip()}" if tip else self.label.toolTip())

    def show_refusal(self, refusal: Refusal) -> None:
        """Show why an edit was refused, where it concerns this field."""
        text = refusal.at(self.spec.path)
        if refusal.path == self.spec.path:
            self.editor.set_refused(True)
            from kindyna_gui.forms.refusal import with_value  # imported here to save start-up time

            text = with_value(text, self._typed_text())
        if text:
            self._refusals[refusal.path] = text
        else:
            self._refusals.pop(refusal.path, None)
        self._show_refusals()

    def _accepted(self, path: str) -> None:
        self._refusals.pop(path, None)
        if path == self.spec.path and not self.is_obsolete:
            self._show(self.session.holder(path))
        self._show_refusals()

    def _restored(self) -> None:
        """Discard what was typed; the design may be of another kind, so ``refresh`` shows its value."""
        self._refusals.clear()
        self.editor.set_refused(False)
        if isinstance(self.editor, NumberBox):
            self.editor.show_value(self.editor.value)
        self._show_refusals()

    def _show_refusals(self) -> None:
        if self._refusals or "message" in vars(self):
            self.message.show_refusal("\n".join(self._refusals.values()), self._remedies())
        if self.trouble != self._last_trouble:
            self._last_trouble = self.trouble
            self.trouble_changed.emit()

    def _typed_number(self) -> float | None:
        """The number that the editor holds in place of the value; None for a text, or where it was typed elsewhere."""
        if not isinstance(self.editor, NumberBox) or not self.editor.pending:
            return None
        return parsed(self.editor.text(), self.spec.unit)

    def _typed_text(self) -> str:
        if isinstance(self.editor, WordBox):
            return self.editor.currentText()
        number = self._typed_number()
        return "" if number is None else value_text(number, self.spec.unit)

    def _remedies(self) -> Remedies:
        """Remedies of a refused number or choice."""
        from kindyna_gui.forms.refusal import NO_REMEDIES, nearest_value, value_remedies

        is_typed = isinstance(self.editor, WordBox) or self.editor.pending
        if not self.editor.is_refused or not is_typed or self.is_obsolete:
            return NO_REMEDIES
        spec, valid = self.spec, self.spec.read(self.session.holder(self.spec.path))
        nearest = nearest_value(self.session, spec.path, spec.info, self._typed_number())
        return value_remedies(
            lambda value: value_text(value, spec.unit), nearest, valid, self._use, self.editor.withdraw
        )

    def _use(self, value: float) -> None:
        """Enter the allowed value that a remedy offers, as one undo step."""
        self.session.end_gesture()
        self._enter(value)
        self.session.end_gesture()

    @property
    def trouble(self) -> str:
        """Why the value was refused or does not fit the others; empty where it is right."""
        return "\n".join(filter(None, (*self._refusals.values(), self._misfit)))

    # -- to the session -----------------------------------------------------------------------------------

    @property
    def is_obsolete(self) -> bool:
        """Whether the current design has no such value: its kind has changed, and this row is hidden or about to be removed.

        A drag of the row's name may last longer than the row.
        """
        try:
            self.spec.read(self.session.holder(self.spec.path))
        except (KeyError, DesignError):
            return True
        return False

    def edit(self, value: Any, text: str) -> None:
        """Change the value in the current design, where it has this field; text names the undo step."""
        if not self.is_obsolete:
            self.session.edit(self.spec.path, value, text)

    def _step(self, value: Any) -> str:
        """Return the name of the undo step that enters a value."""
        return step_text(self.spec.info.label, value, self.spec.unit)

    def _enter(self, value: Any) -> None:
        spec = self.spec
        if self.is_obsolete:
            return
        if not spec.info.admits(value):
            self.session.refuse(spec.path, f"outside its range; allowed: {allowed_text(spec.info, spec.unit)}")
        else:
            self.edit(value, self._step(value))

    def _choose(self, index: int) -> None:
        assert isinstance(self.editor, WordBox)
        self._enter(self.editor.itemData(index))
        self.session.end_gesture()

    def _assume(self, on: bool) -> None:
        if self.is_obsolete:
            return
        name = self.spec.info.label
        text = f"Mark {name[:1].lower()}{name[1:]} as {'assumed' if on else 'known'}"
        self.session.mark_assumed(self.spec.path, on, text)

    def _label_released(self) -> None:
        self.session.end_gesture()
        self.editor.setFocus(Qt.FocusReason.MouseFocusReason)
        self.select()

    # -- for the form -------------------------------------------------------------------------------------

    def shows(self, spec: FieldSpec) -> bool:
        """Whether the row is that of a specification, so that it can remain when others are added or removed."""
        return replace(self.spec, read=spec.read) == spec

    def focus(self) -> None:
        """Move the focus to the editor and select its text."""
        self.editor.setFocus(Qt.FocusReason.OtherFocusReason)
        self.select()

    def select(self) -> None:
        """Select the text of a number."""
        if isinstance(self.editor, NumberBox):
            self.editor.selectAll()

    def widgets(self) -> tuple[QWidget, ...]:
        """Return all widgets of the row."""
        widgets = (self.label, self.editor, self.unit, self.mark)
        return tuple(widget for widget in widgets if widget is not None)


class NameField(NameBox):
    """The field for the name of the design."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self._session = session
        self.setPlaceholderText("Name of the design")
        self.setAccessibleName("Name")
        self.setToolTip(NAME_TIP)
        self.editingFinished.connect(self._enter)
        session.restored.connect(self._restored)

    @property
    def is_typing(self) -> bool:
        """Whether the text differs from the name of the design."""
        return self.text() != self._session.typed.name

    def refresh(self, design: Design) -> None:
        if not self.is_refused and self.text() != design.name:
            self.setText(design.name)
            self.setCursorPosition(0)
            self.setToolTip(f"{design.name}\n{NAME_TIP}")

    def _enter(self) -> None:
        name = self.text()
        self.set_refused(not name.strip())
        if self.is_refused:
            self._session.refuse("name", "a design needs one")
        elif self.is_typing:
            self._session.edit("name", name, f"Change name to {name}")
        self._session.end_gesture()

    def _restored(self) -> None:
        self.set_refused(False)
        self.refresh(self._session.typed)

    def event(self, event: QEvent) -> bool:
        return not leaves_undo(self, event) and super().event(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Escape and self.is_typing:
            self._restored()
        else:
            super().keyPressEvent(event)
