"""What the delegates of tables share whose editors commit on their own, at every step of a number."""

from __future__ import annotations

from PySide6.QtCore import QAbstractItemModel
from PySide6.QtWidgets import QStyledItemDelegate, QTableView, QWidget

from kindyna_gui.documents.session import Session


class CellDelegate(QStyledItemDelegate):
    """Commits what stands in the editor as long as the table has it open: the focus leaves an editor once more while it is
    being closed."""

    def __init__(self, session: Session, model: QAbstractItemModel, table: QTableView) -> None:
        super().__init__(table)
        self._session = session
        self._open: QWidget | None = None
        self.closeEditor.connect(self._closed)
        model.modelAboutToBeReset.connect(self._closed)

    def opened(self, editor: QWidget) -> None:
        """This is the editor now."""
        self._open = editor

    def commit(self, editor: QWidget) -> None:
        """Give what stands in an editor to the model, if it is the one that is open."""
        if editor is self._open:
            self.commitData.emit(editor)

    def _closed(self) -> None:  # without the editor, which may have gone by now
        self._open = None
        self._session.end_gesture()


__all__ = ["CellDelegate"]
