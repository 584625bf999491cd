"""Attachment and schedule of a load."""

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
from kindyna_gui.look import coloured, icon
from kindyna_gui.pictures.style import SCREEN

# -- hold rows -------------------------------------------------------------------------------------------


class AttachmentRows(QWidget):
    """The holds of one row of the loads, one below the other.

    picked   (key): one is to be chosen in the drawing
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
        grid = QGridLayout(self)
        grid.setContentsMargins(0, 0, 0, 3)
        grid.setHorizontalSpacing(6)
        grid.setVerticalSpacing(3)
        grid.setColumnStretch(1, 1)
        for number, hold in enumerate(self._holds(session.typed)):
            self._add(grid, 2 * number, hold)
        session.refused.connect(self._refused)
        session.accepted.connect(self._accepted)
        session.restored.connect(self._restored)

    def _holds(self, design: Design) -> tuple[AttachedEnd, ...]:
        return holds_of(design.drive, self._name)

    def _add(self, grid: QGridLayout, row: int, hold: AttachedEnd) -> None:
        label, box, button = NameLabel(hold.label, False), WordBox(), QPushButton("Pick")
        box.setAccessibleName(hold.label)
        box.activated.connect(partial(self._choose, hold))
        box.withdrawn.connect(partial(self._take_back, hold))
        label.setBuddy(box)
        button.setFixedSize(button.fontMetrics().horizontalAdvance(button.text()) + 24, row_height(box))
        button.setToolTip(f"{hold.label}: choose it in the drawing")
        button.setStatusTip(button.toolTip())
        button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
        button.clicked.connect(partial(self._pick, hold.key))
        message = QLabel(wordWrap=True)
        coloured(message, SCREEN.limit)
        message.hide()
        grid.addWidget(label, row, 0)
        grid.addWidget(box, row, 1)
        grid.addWidget(button, row, 2)
        grid.addWidget(message, row + 1, 0, 1, COLUMNS)
        self.boxes[hold.key], self.buttons[hold.key], self._messages[hold.key] = box, button, message

    def _pick(self, key: str, *_: object) -> None:
        self.picked.emit(key)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        return [editor for key in self.boxes for editor in (self.boxes[key], self.buttons[key])]

    # -- from the session ---------------------------------------------------------------------------------

    def refresh(self, design: Design) -> None:
        """Show where the row holds on, unless what was chosen there was refused, and what does not fit of it."""
        row = get(design, self._path)
        shown = (design.drive.mechanism, [hold.read(row) for hold in self._holds(design)], self._session.incomplete)
        if shown == self._shown:
            return
        self._shown = shown
        for hold in self._holds(design):
            if not self.boxes[hold.key].refused:
                self._show(hold, design, hold.read(row))
                self._show_misfit(hold)

    def _show_misfit(self, hold: AttachedEnd) -> None:
        own = self._own(hold)
        self._say(hold.key, "\n".join(text for path, _, text in self._session.misfit.reasons if path in own))
        self.boxes[hold.key].set_waiting(self._session.waits(own[0], lambda design: hold.read(get(design, self._path))))

    def _show(self, hold: AttachedEnd, design: Design, now: Target | None) -> None:
        box = self.boxes[hold.key]
        values: list[Target | None] = [*((None,) if hold.output else ()), *targets_for(design.drive, hold)]
        if isinstance(now, Attachment) and hold.what == LINK:  # the place on the link has fields of its own
            now = Attachment(link=now.link)
        if now not in values:
            values.insert(0, now)
        with QSignalBlocker(box):
            if values != self._values.get(hold.key):
                self._values[hold.key] = values
                box.clear()
                box.addItems([attachment_text(design, value) for value in values])
            box.setCurrentIndex(values.index(now))

    def _refused(self, refusal: Refusal) -> None:
        for hold in self._holds(self._session.typed):
            own = self._own(hold)
            if refusal.path == own[0]:
                self.boxes[hold.key].set_refused(True)
                self._say(hold.key, "\n".join(f"{name}: {text}" for _, name, text in refusal.reasons))

    def _own(self, hold: AttachedEnd) -> tuple[str, ...]:
        """The path at which a hold is edited, then those of its parts."""
        parts = ("link", "point", "at", "links", "pair")
        keys = (hold.key, *(f"{hold.key}.{part}" for part in parts), *(own for _, own in hold.fields))
        own = [f"{self._path}.{key}" for key in (*keys, *(("links",) if hold.key == "pair" else ()))]
        return tuple(dict.fromkeys(own))

    def _accepted(self, path: str) -> None:
        for hold in self._holds(self._session.typed):
            if path in self._own(hold):
                self._shown = None
                self.boxes[hold.key].set_refused(False)
                self._say(hold.key, "")

    def _restored(self) -> None:
        self._shown = None
        for key, box in self.boxes.items():
            box.set_refused(False)
            self._say(key, "")

    def _say(self, key: str, text: str) -> None:
        self._messages[key].setText(text)
        self._messages[key].setVisible(bool(text))

    # -- by the user ----------------------------------------------------------------------------------------

    def _choose(self, hold: AttachedEnd, index: int) -> None:
        held = self._values[hold.key][index]
        put_attachment(self._session, self._path, hold, held)

    def _take_back(self, hold: AttachedEnd) -> None:
        self._session.take_back(self._own(hold)[0])
        self._shown = None
        self.refresh(self._session.typed)


def put_attachment(session: Session, path: str, hold: AttachedEnd, held: Target | None) -> bool:
    """Let a row of the loads hold on elsewhere, as one step; False where that is refused."""
    design, at = session.typed, f"{path}.{hold.key}"
    session.end_gesture()
    try:
        changed = with_attachment(design, path, hold.key, held)
    except KindynaError as error:
        session.refuse(at, reason(design, error))
        return False
    label = f"{row_name(design, path)}: {hold.label[:1].lower()}{hold.label[1:]} {attachment_text(design, held)}"
    done = session.lay_out(changed, label, at)
    session.end_gesture()
    return done


# -- list parts ------------------------------------------------------------------------------------------

_ARROWS = {"up": Qt.ArrowType.UpArrow, "down": Qt.ArrowType.DownArrow}
_STEPS: Mapping[int, int] = {Qt.Key.Key_Up: -1, Qt.Key.Key_Down: 1}


def list_button(text: str, picture: str, tip: str, slot: Callable[[], object] | None) -> QToolButton:
    """A flat button with its picture, where it has one, or an arrow alone (picture "up", "down"); the slot is called without the
    button's state."""
    button = QToolButton(autoRaise=True)
    button.setText(text)
    button.setToolTip(tip)
    button.setStatusTip(tip)
    button.setFocusPolicy(Qt.FocusPolicy.TabFocus)
    button.setAccessibleName(text)
    if picture in _ARROWS:
        button.setArrowType(_ARROWS[picture])
    elif picture:
        button.setIcon(icon(picture))
        button.setIconSize(QSize(16, 16))
        button.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
    if slot is not None:
        button.clicked.connect(lambda: slot())
    return button


def taken_by_list(rows: Any, event: QKeyEvent) -> bool:
    """Whether a key is one of the list's own: Alt+Up and Alt+Down emit ``moved`` (-1 or 1), Delete emits ``removed``."""
    if event.key() in _STEPS and event.modifiers() & Qt.KeyboardModifier.AltModifier:
        rows.moved.emit(_STEPS[event.key()])
    elif event.matches(QKeySequence.StandardKey.Delete):
        rows.removed.emit()
    else:
        return False
    return True


def row_of_buttons(buttons: Iterable[QToolButton], above: int = 0) -> QHBoxLayout:
    """The buttons of a list side by side at the left; so many pixels free above and below them."""
    row = QHBoxLayout()
    row.setContentsMargins(4, above, 4, above)
    row.setSpacing(0)
    for button in buttons:
        row.addWidget(button)
    row.addStretch(1)
    return row


class TwoGroups(QWidget):
    """Two groups of buttons in a row, at the left and at the right; the second below the first where that has no room."""

    def __init__(self, first: Iterable[QToolButton], second: Iterable[QToolButton], above: int = 0) -> None:
        super().__init__()
        self._line = QBoxLayout(QBoxLayout.Direction.LeftToRight, self)
        self._line.setContentsMargins(0, above, 0, above)
        self._line.setSpacing(0)
        self._groups = [row_of_buttons(group) for group in (first, second)]
        for stretch, group in zip((1, 0), self._groups, strict=True):
            self._line.addLayout(group, stretch)

    def resizeEvent(self, event: QResizeEvent) -> None:
        beside = sum(group.sizeHint().width() for group in self._groups) <= event.size().width()
        self._line.setDirection(QBoxLayout.Direction.LeftToRight if beside else QBoxLayout.Direction.TopToBottom)
        super().resizeEvent(event)


# -- when row --------------------------------------------------------------------------------------------

TEXTS = {TURN_PART: "over a part of the turn", MOTION_PART: "at a part of the motion", TABLE: "table over the turn"}


class WhenRow(QWidget):
    """One of ``TEXTS``; of a table also buttons for a row more and a row less, and for the whole of it by the clipboard."""

    def __init__(self, session: Session, path: str) -> None:
        super().__init__()
        self._session, self._path = session, path
        self.box = WordBox()
        self.box.setAccessibleName("When")
        self.more: QToolButton = list_button(
            "Row", "insert", "One row more in the table, in its widest gap", partial(self._row, True)
        )
        self.less: QToolButton = list_button(
            "Row", "delete", "The table without its last row", partial(self._row, False)
        )
        self.copy: QToolButton = list_button(
            "Copy table", "duplicate", "The table into the clipboard, for a spreadsheet", self._copy
        )
        self.paste: QToolButton = list_button(
            "Paste table",
            "insert",
            "Two columns from the clipboard, cam angle in ° and force, in the table's place",
            self._paste,
        )
        label = NameLabel("When", False)
        label.setBuddy(self.box)
        line = QHBoxLayout()
        line.addWidget(label)
        line.addWidget(self.box, 1)
        column = QVBoxLayout(self)
        column.setContentsMargins(0, 0, 0, 3)
        column.setSpacing(2)
        column.addLayout(line)
        column.addLayout(row_of_buttons(self._of_table))
        self.rest = QLabel(wordWrap=True)
        coloured(self.rest, SCREEN.quiet)
        column.addWidget(self.rest)
        self.box.activated.connect(self._choose)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        return [self.box, *self._of_table]

    @property
    def _of_table(self) -> tuple[QToolButton, ...]:
        return self.more, self.less, self.copy, self.paste

    def refresh(self, design: Design) -> None:
        """Show when the row works."""
        row, whens = get(design, self._path), whens_of(design.drive)
        with QSignalBlocker(self.box):
            self.box.clear()
            for when in whens:
                self.box.addItem(TEXTS[when], when)
            self.box.setCurrentIndex(whens.index(when_of(row)))
        for button in self._of_table:
            button.setVisible(bool(row.points))
        self.less.setEnabled(len(row.points) > 2)
        more = len(row.points) - POINT_FIELDS
        self.rest.setText(
            f"{len(row.points)} rows: the first {POINT_FIELDS} below, all of them by Copy table and Paste table"
        )
        self.rest.setVisible(more > 0)

    def _choose(self, index: int) -> None:
        when = self.box.itemData(index)
        self._put(with_when(self._session.typed, self._path, when), TEXTS[when])

    def _row(self, more: bool) -> None:
        self._put(with_table_row(self._session.typed, self._path, more), "one row more" if more else "one row less")

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

    def _put(self, design: Design, what: str) -> None:
        session = self._session
        session.end_gesture()
        if not session.lay_out(design, f"{row_name(session.typed, self._path)}: {what}", f"{self._path}.when"):
            self.refresh(session.typed)
        session.end_gesture()
