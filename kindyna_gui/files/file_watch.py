"""Notices when another program changes the design's file, replaces it or takes it away."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QFileSystemWatcher, QObject, QTimer, Signal
from PySide6.QtWidgets import QApplication

from core.project.on_disk import OnDisk
from kindyna_gui.documents.session import Session

PAUSE_MS = 100  # a program may write in several steps


class FileWatch(QObject):
    """Compares the file, and those that its motions follow from, with what the session read or wrote last, whenever they or their folders
    change.

    The folder is watched because editors put a new file in the place of the old one, which ends the watch of that; and
    each time the program comes to the front the file is compared once more, for disks that report no changes.

    state     the file's, as compared last
    sources   the files that its motions follow from and that have changed
    changed   one of them has become another
    """

    changed = Signal()

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self.state = OnDisk.SAME
        self.sources: tuple[str, ...] = ()
        self._session = session
        self._system = QFileSystemWatcher(self)
        self._soon = QTimer(self, singleShot=True, interval=PAUSE_MS)
        self._soon.timeout.connect(self.compare)
        self._system.fileChanged.connect(self._begin_pause)
        self._system.directoryChanged.connect(self._begin_pause)
        session.file_changed.connect(self._file_changed)
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.applicationStateChanged.connect(self._begin_pause)
        self._watch()

    def compare(self) -> None:
        """Compare now."""
        self._soon.stop()
        self._watch()
        state = self._session.on_disk()
        now = state, self._session.changed_sources() if state is OnDisk.SOURCE else ()
        if now != (self.state, self.sources):
            self.state, self.sources = now
            self.changed.emit()

    def _begin_pause(self, *_: object) -> None:
        self._soon.start()

    def _file_changed(self) -> None:
        """Opened, saved, or another design: what is known of the file is new."""
        if self.state is not OnDisk.SAME:
            self.compare()
        else:
            self._watch()

    def _watch(self) -> None:
        path = self._session.path
        targets = () if path is None else (path.resolve(), *(Path(name) for name in self._session.sources()))
        wanted = {str(each) for target in targets for each in (target, target.parent) if each.exists()}
        watched = {*self._system.files(), *self._system.directories()}
        if watched - wanted:
            self._system.removePaths(sorted(watched - wanted))
        if wanted - watched:
            self._system.addPaths(sorted(wanted - watched))


__all__ = ["FileWatch"]
