"""Opening and saving designs, and watching their files for changes by other programs."""

from __future__ import annotations

from pathlib import Path

from PySide6.QtCore import QFileSystemWatcher, QObject, Qt, Signal
from PySide6.QtGui import QDropEvent
from PySide6.QtWidgets import QApplication, QMenu, QToolButton, QWidget

from core.design import Design, faults
from core.errors import KindynaError
from core.file_names import file_name
from core.findings import WARNING
from core.project import load
from core.project.on_disk import OnDisk
from kindyna_gui import dialogs
from kindyna_gui.dialogs import IncompleteChoice, OnConflict, SaveAnswer
from kindyna_gui.documents.session import Session
from kindyna_gui.documents.texts import closing_text, difference_text, misfit_sentences
from kindyna_gui.look import sign
from kindyna_gui.rebuilt import single_shot
from kindyna_gui.settings import Settings

NOT_ON_DISK = {
    OnDisk.CHANGED: "has been changed on the disk by another program",
    OnDisk.GONE: "is no longer on the disk",
}
"""State of a file that has changed since it was last read or written -> words of the question."""
PAUSE_MS = 100  # a program may write a file in several steps
TEXTS = {
    OnDisk.SAME: ("", "", ""),
    OnDisk.CHANGED: ("changed on disk", "{} has been changed by another program", "&Overwrite it with this design"),
    OnDisk.GONE: ("file is gone", "{} has been moved or deleted by another program", "&Write it again"),
    OnDisk.SOURCE: ("source changed", "{}, which a motion follows from, has been changed by another program", ""),
}
"""State of the file -> text of the button, what has happened, and the menu entry that writes the file."""

# -- opening and saving ----------------------------------------------------------------------------------


class Documents(QObject):
    """The actions of the File menu; they ask before discarding unsaved work, and show all faults of a file.

    Signal: ``status_message`` with what has been done, for the status line.
    """

    status_message = Signal(str)

    def __init__(self, session: Session, settings: Settings, window: QWidget) -> None:
        super().__init__(window)
        self._session, self._settings, self._window = session, settings, window
        self._saves_last_valid = False  # instead of the typed values

    @property
    def name(self) -> str:
        """Name of the file, else of the design."""
        path = self._session.path
        return path.name if path is not None else self._session.full_design.name

    # -- leaving ------------------------------------------------------------------------------------------

    def settle(self) -> None:
        """Confirm the field that is being typed into."""
        focused = QApplication.focusWidget()
        if focused is not None and self._window.isAncestorOf(focused):
            focused.clearFocus()
            if focused.isVisible():
                focused.setFocus()

    def may_leave(self) -> bool:
        """Ask what to do with unsaved changes; False where the user cancels."""
        self.settle()
        if self._session.modified:
            answer = dialogs.ask_to_save(self._window, self.name)
        elif (state := self._session.on_disk()) in NOT_ON_DISK:  # only the window has it then
            answer = dialogs.ask_to_save(self._window, self.name, NOT_ON_DISK[state])
            if answer is SaveAnswer.SAVE and state is OnDisk.GONE:  # the question has said so
                return self.overwrite()
        else:
            return True
        return self.save() if answer is SaveAnswer.SAVE else answer is SaveAnswer.DISCARD

    # -- opening ------------------------------------------------------------------------------------------

    def new(self, kind: str) -> None:
        """Begin a design with this kind of follower or cam in space: lengths and stroke of an example, and a complete motion."""
        if not self.may_leave():
            return
        from kindyna_gui.files.beginnings import FIRST_OF_KIND, beginning

        design = beginning(kind)
        self._session.start(design)
        count = {2: "two", 4: "four"}[len(design.drive.motion.segments)] if design.drive.motion else ""
        self.status_message.emit(
            f"New design with the lengths of {FIRST_OF_KIND[kind]} and a motion of {count} segments"
        )

    def new_drawing(self) -> bool:
        """Begin an empty linkage drawing; False where the user cancels."""
        if not self.may_leave():
            return False
        from kindyna_gui.files.beginnings import empty_sheet

        self._session.start(empty_sheet())
        return True

    def open_file(self) -> None:
        """Ask for a file and open it."""
        if self.may_leave():
            path = dialogs.design_to_open(self._window, self._settings.folder)
            if path is not None:
                self._open(path)

    def open_path(self, path: Path) -> bool:
        """Open a file, after asking about unsaved changes."""
        return self.may_leave() and self._open(path)

    def open_example(self, path: Path) -> None:
        """Begin with an example; saving it opens the file dialog."""
        if self.may_leave():
            try:
                self._session.start(load(path))
            except KindynaError as error:
                self._show_error(f"{path.name} cannot be opened.", error)

    def begin(self, design: Design, name: str) -> None:
        """Begin with a design that has no file yet; Undo restores the one before."""
        self._session.begin(design, f"Begin with {name}")
        self.status_message.emit(f"New design: {name}; Undo restores the design before")

    def _open(self, path: Path) -> bool:
        try:
            self._session.open(path)
        except KindynaError as error:
            self._settings.drop_recent(path)
            self._show_error(f"{path.name} cannot be opened.", error)
            return False
        self._settings.add_recent(path)
        self.status_message.emit(f"Opened {path}")
        return True

    # -- saving -------------------------------------------------------------------------------------------

    def save(self) -> bool:
        """Save to the design's own file; where it has none, open the file dialog."""
        if not self._may_save():
            return False
        path = self._session.path
        if path is None:
            return self._save_as()
        state = self._session.on_disk()
        return self._save_over_change(path, gone=state is OnDisk.GONE) if state in NOT_ON_DISK else self._save(path)

    def overwrite(self) -> bool:
        """Save to the design's own file, whatever another program has written there."""
        if not self._may_save():
            return False
        return self._save_as() if self._session.path is None else self._save(self._session.path)

    def save_as(self) -> bool:
        """Ask for a file and save to it."""
        return self._may_save() and self._save_as()

    def _may_save(self) -> bool:
        """Confirm the typed field and ask what to save where the values do not fit; False where the user cancels."""
        self.settle()
        session, answer = self._session, IncompleteChoice.AS_TYPED
        while session.misfit.reasons and not session.is_incomplete_linkage:
            as_typed = not faults(session.typed_full_design)  # a file has no faults
            answer = dialogs.ask_incomplete(self._window, misfit_sentences(session), closing_text(session), as_typed)
            if answer is not IncompleteChoice.CLOSE or not session.close_motion():
                break
        self._saves_last_valid = answer is IncompleteChoice.LAST_VALID
        return (
            not session.misfit.reasons
            or session.is_incomplete_linkage
            or answer in (IncompleteChoice.AS_TYPED, IncompleteChoice.LAST_VALID)
        )

    def _save_as(self) -> bool:
        stem = file_name(self._session.full_design.name) or "design"
        suggestion = self._session.path or self._settings.folder / f"{stem}.toml"
        path = dialogs.design_to_save(self._window, suggestion)
        if path is None:
            return False
        current = self._session.path
        if current is not None and path.resolve() == current.resolve() and self._session.on_disk() is OnDisk.CHANGED:
            return self._save_over_change(current)
        return self._save(path)

    def reload(self) -> None:
        """Reload the design's file; Undo restores the design before."""
        self.settle()
        path = self._session.path
        if path is None:
            self.status_message.emit("This design has no file to reload")
            return
        try:
            self._session.reload()
        except KindynaError as error:
            self._show_error(f"{path.name} cannot be reloaded.", error)
        else:
            self.status_message.emit(f"Reloaded {path}; Undo restores the design before")

    def _save_over_change(self, path: Path, gone: bool = False) -> bool:
        """Ask what to do with a file that another program has changed or removed; True where the design is saved."""
        answer = dialogs.ask_on_conflict(self._window, path.name, [] if gone else self._differences(path), gone)
        if answer is OnConflict.OVERWRITE:
            return self._save(path)
        if answer is OnConflict.SAVE_AS:
            return self._save_as()
        if answer is OnConflict.RELOAD:
            self.reload()
        return False

    def _differences(self, path: Path) -> list[str]:
        """Return a line for each difference between a file and the design."""
        design = self._session.valid_full_design if self._saves_last_valid else self._session.typed_full_design
        try:
            on_disk = load(path)
        except KindynaError as error:
            return ["The file is not a design any longer:", *str(error).splitlines()]
        from core.project.differences import differences  # imported here to save start-up time

        lines = (difference_text(on_disk, design, row) for row in differences(on_disk, design))
        return [f"{name}: {in_file} in the file, {in_window} here" for name, in_file, in_window in lines]

    def _save(self, path: Path) -> bool:
        try:
            self._session.save(path, last_valid=self._saves_last_valid)
        except KindynaError as error:
            self._show_error(f"{path.name} cannot be saved.", error)
            return False
        self._settings.add_recent(path)
        note = "; values that do not fit yet are not in it" if self._session.modified else ""
        self.status_message.emit(f"Saved {path}{note}")
        return True

    def _show_error(self, message: str, error: KindynaError) -> None:
        dialogs.show_faults(self._window, message, str(error).splitlines())


def dropped_design(event: QDropEvent) -> Path | None:
    """Return the path of a dragged design file; None where something else is dragged."""
    files = [Path(url.toLocalFile()) for url in event.mimeData().urls() if url.isLocalFile()]
    return files[0] if len(files) == 1 and files[0].suffix.lower() == ".toml" else None


# -- watching the file -----------------------------------------------------------------------------------


class FileWatch(QObject):
    """Watches the design's file, and the files that its motions follow from, for changes by other programs.

    The folder is watched too, because editors replace a file by a new one, which ends the watch of the old file. The files
    are compared again each time the program comes to the front, for disks that report no changes.

    ``state`` is the state of the file, ``sources`` are the changed files that its motions follow from. Signal: ``changed``
    with either of them.
    """

    changed = Signal()

    def __init__(self, session: Session, parent: QObject) -> None:
        super().__init__(parent)
        self.state = OnDisk.SAME
        self.sources: tuple[str, ...] = ()
        self._session = session
        self._system = QFileSystemWatcher(self)
        self._soon = single_shot(self, self.compare, PAUSE_MS)
        self._system.fileChanged.connect(self._begin_pause)
        self._system.directoryChanged.connect(self._begin_pause)
        session.file_changed.connect(self._file_changed)
        app = QApplication.instance()
        if isinstance(app, QApplication):
            app.applicationStateChanged.connect(self._begin_pause)
        self._watch()

    def compare(self) -> None:
        """Compare the files now."""
        self._soon.stop()
        self._watch()
        state = self._session.on_disk()
        result = state, self._session.changed_sources() if state is OnDisk.SOURCE else ()
        if result != (self.state, self.sources):
            self.state, self.sources = result
            self.changed.emit()

    def _begin_pause(self, *_: object) -> None:
        self._soon.start()

    def _file_changed(self) -> None:
        """Compare again after opening or saving, where the file had changed."""
        if self.state is not OnDisk.SAME:
            self.compare()
        else:
            self._watch()

    def _watch(self) -> None:
        path = self._session.path
        targets = () if path is None else (path.resolve(), *(Path(name) for name in self._session.sources()))
        needed = {str(path) for target in targets for path in (target, target.parent) if path.exists()}
        watched = {*self._system.files(), *self._system.directories()}
        if watched - needed:
            self._system.removePaths(sorted(watched - needed))
        if needed - watched:
            self._system.addPaths(sorted(needed - watched))


# -- the button about a changed file ---------------------------------------------------------------------


class DiskButton(QToolButton):
    """A button that is shown when the file has changed: reload it, save under another name, or overwrite it.

    Signal: ``status_message`` with what has happened, for the status line.
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
            self.setToolTip(f"{happened}. Click to reload, save or overwrite.")
            self.status_message.emit(happened)
