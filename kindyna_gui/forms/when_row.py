"""When a process force works, in its form: over a part of the turn, at a part of the motion, or as a table of rows, which can come
from a spreadsheet and go into one."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QApplication, QHBoxLayout, QLabel, QToolButton, QVBoxLayout, QWidget

from core.design import (
    MOTION_PART,
    TABLE,
    TURN_PART,
    Design,
    get,
    when_of,
    whens_of,
    with_load_table,
    with_table_row,
    with_when,
)
from core.errors import KindynaError
from core.output.load_text import row_name
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.field_parts import NameLabel
from kindyna_gui.forms.form import POINT_FIELDS
from kindyna_gui.forms.list_parts import list_button, row_of_buttons
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import reason
from kindyna_gui.look import coloured
from kindyna_gui.pictures.style import SCREEN

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


__all__ = ["WhenRow"]
