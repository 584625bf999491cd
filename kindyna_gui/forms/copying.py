"""Copy in a table takes all of it to the clipboard, for a spreadsheet."""

from __future__ import annotations

from collections.abc import Iterator

from PySide6.QtCore import QAbstractItemModel, QEvent, QModelIndex, QObject, Qt
from PySide6.QtGui import QKeyEvent, QKeySequence
from PySide6.QtWidgets import QAbstractItemView, QApplication


def table_text(model: QAbstractItemModel) -> str:
    """Headings and rows as shown, cells apart by tabs; of a tree what stands below a row follows it."""
    heads = [model.headerData(column, Qt.Orientation.Horizontal) for column in range(model.columnCount())]
    return "\n".join("\t".join(_cell(text) for text in line) for line in (heads, *_lines(model, QModelIndex())))


def _lines(model: QAbstractItemModel, above: QModelIndex) -> Iterator[list[object]]:
    for row in range(model.rowCount(above)):
        yield [model.index(row, column, above).data() for column in range(model.columnCount(above))]
        yield from _lines(model, model.index(row, 0, above))


def _cell(text: object) -> str:
    return "" if text is None else " ".join(str(text).split())


class CopyKey(QObject):
    """Lets Copy in a table of Qt's own take all of it."""

    def __init__(self, view: QAbstractItemView) -> None:
        super().__init__(view)
        self._view = view
        view.installEventFilter(self)

    def eventFilter(self, watched: QObject, event: QEvent) -> bool:
        return isinstance(event, QKeyEvent) and event.type() == QEvent.Type.KeyPress and copied(self._view, event)


def copied(view: QAbstractItemView, event: QKeyEvent) -> bool:
    """Whether a key was Copy, and has been done."""
    if not event.matches(QKeySequence.StandardKey.Copy):
        return False
    QApplication.clipboard().setText(table_text(view.model()))
    return True


__all__ = ["CopyKey", "copied", "table_text"]
