"""The button in the status line that is there while the design's file is not as it was read or written last."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import Qt, Signal
from PySide6.QtWidgets import QMenu, QToolButton

from core.findings import WARNING
from core.project.on_disk import OnDisk
from kindyna_gui.files.file_actions import Documents
from kindyna_gui.files.file_watch import FileWatch
from kindyna_gui.look import sign

TEXTS = {
    OnDisk.SAME: ("", "", ""),
    OnDisk.CHANGED: ("changed on disk", "{} has been changed by another program", "&Overwrite it with this design"),
    OnDisk.GONE: ("file is gone", "{} has been moved or deleted by another program", "&Write it again"),
    OnDisk.SOURCE: ("source changed", "{}, which a motion follows from, has been changed by another program", ""),
}
"""Text of the button, what has happened, and what writing the file would do."""


class DiskButton(QToolButton):
    """Offers what can be done: read the file again, save as another, write over it.

    status_message (str): what has happened, for the status line
    """

    status_message = Signal(str)

    def __init__(self, watch: FileWatch, documents: Documents) -> None:
        super().__init__(autoRaise=True)
        self._watch, self._documents = watch, documents
        self.setIcon(sign(WARNING))
        self.setToolButtonStyle(Qt.ToolButtonStyle.ToolButtonTextBesideIcon)
        self.setPopupMode(QToolButton.ToolButtonPopupMode.InstantPopup)
        self.setFocusPolicy(Qt.FocusPolicy.NoFocus)
        menu = QMenu(self)
        self._reload = menu.addAction("&Reload it", documents.reload)
        menu.addAction("&Save as...", documents.save_as)
        self._write = menu.addAction("", documents.overwrite)
        self.setMenu(menu)
        self.hide()
        watch.changed.connect(self._changed)

    def _changed(self) -> None:
        state = self._watch.state
        text, happened, write = TEXTS[state]
        self.setText(text)
        self._write.setText(write)
        self._write.setVisible(bool(write))
        self._reload.setVisible(state in (OnDisk.CHANGED, OnDisk.SOURCE))
        self.setVisible(state is not OnDisk.SAME)
        if happened:
            sources = ", ".join(Path(name).name for name in self._watch.sources)
            happened = happened.format(sources if state is OnDisk.SOURCE else self._documents.name)
            self.setToolTip(f"{happened}. Click for what can be done.")
            self.status_message.emit(happened)


__all__ = ["DiskButton"]
