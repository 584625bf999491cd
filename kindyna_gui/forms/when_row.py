"""When a process force works, in its form: over a part of the turn, at a part of the motion, or as a table of rows."""

from __future__ import annotations

from functools import partial

from PySide6.QtCore import QSignalBlocker
from PySide6.QtWidgets import QHBoxLayout, QToolButton, QWidget

from core.design import (
    MOTION_PART,
    TABLE,
    TURN_PART,
    Design,
    get,
    when_of,
    whens_of,
    with_table_row,
    with_when,
)
from kindyna_gui.documents.session import Session
from kindyna_gui.forms.field_parts import NameLabel
from kindyna_gui.forms.list_parts import list_button
from kindyna_gui.forms.number_box import WordBox
from kindyna_gui.labels import row_name

TEXTS = {TURN_PART: "over a part of the turn", MOTION_PART: "at a part of the motion", TABLE: "table over the turn"}


class WhenRow(QWidget):
    """One of ``TEXTS``; of a table also buttons for a row more and a row less."""

    def __init__(self, session: Session, path: str) -> None:
        super().__init__()
        self._session, self._path = session, path
        self.box = WordBox()
        self.box.setAccessibleName("When")
        self.more: QToolButton = list_button("Row", "insert", "One row more in the table, in its widest gap", partial(self._row, True))
        self.less: QToolButton = list_button("Row", "delete", "The table without its last row", partial(self._row, False))
        label = NameLabel("When", False)
        label.setBuddy(self.box)
        line = QHBoxLayout(self)
        line.setContentsMargins(0, 0, 0, 3)
        for part in (label, self.box, self.more, self.less):
            line.addWidget(part, 1 if part is self.box else 0)
        self.box.activated.connect(self._choose)

    @property
    def editors(self) -> list[QWidget]:
        """In the order of Tab."""
        return [self.box, self.more, self.less]

    def refresh(self, design: Design) -> None:
        """Show when the row works."""
        row, whens = get(design, self._path), whens_of(design.drive)
        with QSignalBlocker(self.box):
            self.box.clear()
            for when in whens:
                self.box.addItem(TEXTS[when], when)
            self.box.setCurrentIndex(whens.index(when_of(row)))
        self.more.setVisible(bool(row.points))
        self.less.setVisible(bool(row.points))
        self.less.setEnabled(len(row.points) > 2)

    def _choose(self, index: int) -> None:
        when = self.box.itemData(index)
        self._put(with_when(self._session.design, self._path, when), TEXTS[when])

    def _row(self, more: bool) -> None:
        self._put(with_table_row(self._session.design, self._path, more), "one row more" if more else "one row less")

    def _put(self, design: Design, what: str) -> None:
        session = self._session
        session.end_gesture()
        if not session.put(design, f"{row_name(session.design, self._path)}: {what}", f"{self._path}.when"):
            self.refresh(session.design)
        session.end_gesture()


__all__ = ["WhenRow"]
