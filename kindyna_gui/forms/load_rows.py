"""Rows of a load's form: where it is attached, and when it acts; and the buttons of lists.

An attachment is chosen from a list or picked in the drawing. A process force acts over a part of the turn, at a part of
the motion, or by a table.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from PySide6.QtCore import QSignalBlocker, QSize, Qt, Signal
from PySide6.QtGui import QKeyEvent, QKeySequence, QResizeEvent
from PySide6.QtWidgets import (
    QApplication,
    QBoxLayout,
    QGridLayout,
    QHBoxLayout,
    QLabel,
    QPushButton,
    QToolButton,
    QVBoxLayout,
    QWidget,
)

from core.design import (
    LINK,
    MOTION_PART,
    TABLE,
    TURN_PART,
    AttachedEnd,
    Attachment,
    Design,
    Target,
    get,
    holds_of,
    targets_for,
    when_of,
    whens_of,
    with_attachment,
    with_load_table,
    with_table_row,
    with_when,
)
from core.errors import KindynaError
from core.output.load_text import attachment_text, row_name
from kindyna_gui.documents.edits import Refusal
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.fields import COLUMNS, NameLabel
from kindyna_gui.forms.form import POINT_FIELDS
from kindyna_gui.forms.number_box import WordBox, row_height
from kindyna_gui.labels import reason
from kindyna_gui.look import coloured, described, icon
from kindyna_gui.pictures.style import SCREEN
from kindyna_gui.rebuilt import STRETCH, fill

_ARROWS = {"up": Qt.ArrowType.UpArrow, "down": Qt.ArrowType.DownArrow}
_STEPS: Mapping[int, int] = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}
TEXTS = {TURN_PART: "over a part of the turn", MOTION_PART: "at a part of the motion", TABLE: "table over the turn"}

# -- where a load is attached ----------------------------------------------------------------------------


class AttachmentRows(QWidget):
    """The attachments of one load, one below the other.

    Signal: ``picked`` with the key of the attachment to be selected in the drawing.
    """

    picked = Signal(str)

    def __init__(self, session: Session, path: str) -> None:
        super().__init__()
        self._session, self._path = session, path
        self._name = path.partition(".")[2].partition("[")[0]
        self._shown: tuple[object, ...] | None = None
        self.boxes: dict[str, WordBox] = {}
        self.buttons: dict[str, QPushButton] = {}
        self._messages: dict[str, QLabel] = {}
        self._values: dict[str, list[Target | None]] = {}
        grid = fill(QGridLayout(self), margins=(0, 0, 0, 3), spacing=(6, 3))
        grid.setColumnStretch(1, 1)
        for number, end in enumerate(self._ends(session.typed)):
            self._add(grid, 2 * number, end)
        session.refused.connect(self._refused)
        session.accepted.connect(self._accepted)
        session.restored.connect(self._restored)

    def _ends(self, design: Design) -> tuple[AttachedEnd, ...]:
        return holds_of(design.drive, self._name)

    def _add(self, grid: QGridLayout, row: int, end: AttachedEnd) -> None:
        label, box, button = NameLabel(end.label, False), WordBox(), QPushButton("Pick")
        box.setAccessibleName(end.label)
        box.activated.connect(partial(self._choose, end))
        box.withdrawn.connect(partial(self._take_back, end))
        label.setBuddy(box)
        button.setFixedSize(button.fontMetrics().horizontalAdvance(button.text()) + 24, row_height(box))
        button.setToolTip(f"{end.label}: select it in the drawing")
        button.setStatusTip(button.toolTip())
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.clicked.connect(partial(self._pick, end.key))
        message = coloured(QLabel(wordWrap=True), SCREEN.limit)
        message.hide()
        grid.addWidget(label, row, 0)
        grid.addWidget(box, row, 1)
        grid.addWidget(button, row, 2)
        grid.addWidget(message, row + 1, 0, 1, COLUMNS)
        self.boxes[end.key], self.buttons[end.key], self._messages[end.key] = box, button, message

    def _pick(self, key: str, *_: object) -> None:
        self.picked.emit(key)

    @property
    def editors(self) -> list[QWidget]:
        """Editors in the order of Tab."""
        return [editor for key in self.boxes for editor in (self.boxes[key], self.buttons[key])]

    # -- from the session ---------------------------------------------------------------------------------

    def refresh(self, design: Design) -> None:
        """Show the attachments of the load and why they do not fit, except those with a refused choice."""
        row = get(design, self._path)
        shown = (design.drive.mechanism, [end.read(row) for end in self._ends(design)], self._session.incomplete)
        if shown == self._shown:
            return
        self._shown = shown
        for end in self._ends(design):
            if not self.boxes[end.key].is_refused:
                self._show(end, design, end.read(row))
                self._show_misfit(end)

    def _show_misfit(self, end: AttachedEnd) -> None:
        paths = self._paths(end)
        self._say(end.key, "\n".join(text for path, _, text in self._session.misfit.reasons if path in paths))
        self.boxes[end.key].set_waiting(
            self._session.is_waiting(paths[0], lambda design: end.read(get(design, self._path)))
        )

    def _show(self, end: AttachedEnd, design: Design, current: Target | None) -> None:
        box = self.boxes[end.key]
        values: list[Target | None] = [*((None,) if end.output else ()), *targets_for(design.drive, end)]
        if isinstance(current, Attachment) and end.what == LINK:  # the point on the link has its own fields
            current = Attachment(link=current.link)
        if current not in values:
            values.insert(0, current)
        with QSignalBlocker(box):
            if values != self._values.get(end.key):
                self._values[end.key] = values
                box.clear()
                box.addItems([attachment_text(design, value) for value in values])
            box.setCurrentIndex(values.index(current))

    def _refused(self, refusal: Refusal) -> None:
        for end in self._ends(self._session.typed):
            paths = self._paths(end)
            if refusal.path == paths[0]:
                self.boxes[end.key].set_refused(True)
                self._say(end.key, "\n".join(f"{name}: {text}" for _, name, text in refusal.reasons))

    def _paths(self, end: AttachedEnd) -> tuple[str, ...]:
        """Return the path at which an attachment is edited, then the paths of its parts."""
        parts = ("link", "point", "at", "links", "pair")
        keys = (end.key, *(f"{end.key}.{part}" for part in parts), *(field for _, field in end.fields))
        paths = [f"{self._path}.{key}" for key in (*keys, *(("links",) if end.key == "pair" else ()))]
        return tuple(dict.fromkeys(paths))

    def _accepted(self, path: str) -> None:
        for end in self._ends(self._session.typed):
            if path in self._paths(end):
                self._shown = None
                self.boxes[end.key].set_refused(False)
                self._say(end.key, "")

    def _restored(self) -> None:
        self._shown = None
        for key, box in self.boxes.items():
            box.set_refused(False)
            self._say(key, "")

    def _say(self, key: str, text: str) -> None:
        self._messages[key].setText(text)
        self._messages[key].setVisible(bool(text))

    # -- by the user ----------------------------------------------------------------------------------------

    def _choose(self, end: AttachedEnd, index: int) -> None:
        put_attachment(self._session, self._path, end, self._values[end.key][index])

    def _take_back(self, end: AttachedEnd) -> None:
        self._session.clear_refusal(self._paths(end)[0])
        self._shown = None
        self.refresh(self._session.typed)


def put_attachment(session: Session, path: str, end: AttachedEnd, target: Target | None) -> bool:
    """Attach a load to another target, as one undo step; False where that is refused."""
    design, at = session.typed, f"{path}.{end.key}"
    session.end_gesture()
    try:
        changed = with_attachment(design, path, end.key, target)
    except KindynaError as error:
        session.refuse(at, reason(design, error))
        return False
    label = f"{row_name(design, path)}: {end.label[:1].lower()}{end.label[1:]} {attachment_text(design, target)}"
    done = session.lay_out(changed, label, at)
    session.end_gesture()
    return done


# -- buttons and keys of lists ---------------------------------------------------------------------------


def list_button(text: str, icon_name: str, tip: str, slot: Callable[[], object] | None) -> QToolButton:
    """Return a flat button with an icon, or only an arrow ("up", "down"); the slot is called without the button's state."""
    button = described(QToolButton(autoRaise=True), name=text, tip=tip)
    button.setText(text)
    button.setStatusTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    if icon_name in _ARROWS:
        button.setArrowType(_ARROWS[icon_name])
    elif icon_name:
        button.setIcon(icon(icon_name))
        button.setIconSize(QSize(16, 16))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    if slot is not None:
        button.clicked.connect(lambda: slot())
    return button


def taken_by_list(rows: Any, event: QKeyEvent) -> bool:
    """Handle a key of a list, and return whether it was one: Alt+Up and Alt+Down emit ``moved``, Delete ``removed``."""
    if event.key() in _STEPS and event.modifiers() & Qt.KeyboardModifier.AltModifier:
        rows.moved.emit(_STEPS[event.key()])
    elif event.matches(QKeySequence.StandardKey.Delete):
        rows.removed.emit()
    else:
        return False
    return True


def row_of_buttons(buttons: Iterable[QToolButton], above: int = 0) -> QHBoxLayout:
    """Return a row with the buttons at the left, and some pixels above and below them."""
    return fill(QHBoxLayout(), *buttons, STRETCH, margins=(4, above, 4, above), spacing=0)


class TwoGroups(QWidget):
    """Two groups of buttons, at the left and at the right; the second below the first where there is no room."""

    def __init__(self, first: Iterable[QToolButton], second: Iterable[QToolButton], above: int = 0) -> None:
        super().__init__()
        self._groups = left, right = row_of_buttons(first), row_of_buttons(second)
        self._line = fill(
            QBoxLayout(QBoxLayout.Direction.LeftToRight, self),
            (left, 1),
            right,
            margins=(0, above, 0, above),
            spacing=0,
        )

    def resizeEvent(self, event: QResizeEvent) -> None:
        in_a_row = sum(group.sizeHint().width() for group in self._groups) <= event.size().width()
        self._line.setDirection(QBoxLayout.Direction.LeftToRight if in_a_row else QBoxLayout.Direction.TopToBottom)
        super().resizeEvent(event)


# -- when a load acts ------------------------------------------------------------------------------------


class WhenRow(QWidget):
    """The schedule of a process force: one of ``TEXTS``, with buttons to add and remove rows of a table, and to copy and paste it."""

    def __init__(self, session: Session, path: str) -> None:
        super().__init__()
        self._session, self._path = session, path
        self.box = described(WordBox(), name="When")
        self.more: QToolButton = list_button(
            "Row", "insert", "Add a row to the table, in its widest gap", partial(self._row, True)
        )
        self.less: QToolButton = list_button(
            "Row", "delete", "Remove the last row of the table", partial(self._row, False)
        )
        self.copy: QToolButton = list_button(
            "Copy table", "duplicate", "Copy the table to the clipboard, for a spreadsheet", self._copy
        )
        self.paste: QToolButton = list_button(
            "Paste table",
            "insert",
            "Replace the table by two columns from the clipboard: cam angle in °, force",
            self._paste,
        )
        label = NameLabel("When", False)
        label.setBuddy(self.box)
        line = fill(QHBoxLayout(), label, (self.box, 1))
        self.rest = coloured(QLabel(wordWrap=True), SCREEN.quiet)
        fill(QVBoxLayout(self), line, row_of_buttons(self._table_buttons), self.rest, margins=(0, 0, 0, 3), spacing=2)
        self.box.activated.connect(self._choose)

    @property
    def editors(self) -> list[QWidget]:
        """Editors in the order of Tab."""
        return [self.box, *self._table_buttons]

    @property
    def _table_buttons(self) -> tuple[QToolButton, ...]:
        return self.more, self.less, self.copy, self.paste

    def refresh(self, design: Design) -> None:
        """Show when the load acts."""
        row, whens = get(design, self._path), whens_of(design.drive)
        with QSignalBlocker(self.box):
            self.box.clear()
            for when in whens:
                self.box.addItem(TEXTS[when], when)
            self.box.setCurrentIndex(whens.index(when_of(row)))
        for button in self._table_buttons:
            button.setVisible(bool(row.points))
        self.less.setEnabled(len(row.points) > 2)
        more = len(row.points) - POINT_FIELDS
        self.rest.setText(
            f"{len(row.points)} rows: the first {POINT_FIELDS} are listed below; Copy table and Paste table have all of them"
        )
        self.rest.setVisible(more > 0)

    def _choose(self, index: int) -> None:
        when = self.box.itemData(index)
        self._put(with_when(self._session.typed, self._path, when), TEXTS[when])

    def _row(self, more: bool) -> None:
        self._put(with_table_row(self._session.typed, self._path, more), "add a row" if more else "remove a row")

    def _copy(self) -> None:
        from core.measured import load_table_text

        QApplication.clipboard().setText(load_table_text(get(self._session.typed, self._path).points))

    def _paste(self) -> None:
        from core.measured import load_points

        try:
            points = load_points(QApplication.clipboard().text().encode(), "clipboard")
        except KindynaError as error:
            self._session.refuse(f"{self._path}.points", reason(self._session.design, error))
            return
        self._put(with_load_table(self._session.typed, self._path, points), f"table of {len(points)} rows")

    def _put(self, design: Design, change: str) -> None:
        session = self._session
        session.end_gesture()
        if not session.lay_out(design, f"{row_name(session.typed, self._path)}: {change}", f"{self._path}.when"):
            self.refresh(session.typed)
        session.end_gesture()
