"""Recovery of unsaved work: written by a thread while the window is busy, offered again after a crash.

Qt waits in C, where Python handles no signal, so a pipe wakes it when the process is asked to end.
"""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Event, Thread
from time import monotonic
from types import FrameType

from PySide6.QtCore import QCoreApplication, QObject, QSocketNotifier, Signal
from PySide6.QtWidgets import QWidget

from core.design import Design
from core.errors import KindynaError
from core.process import user_folder
from core.project import recovery
from core.project.recovery import Recoverable, RecoveryFile, Unsaved
from kindyna_gui import dialogs
from kindyna_gui.documents.edits import IncompleteDesign
from kindyna_gui.documents.session import Session
from kindyna_gui.files.file_actions import Documents
from kindyna_gui.rebuilt import single_shot

PAUSE = 0.5  # seconds between two writes
PAUSE_AFTER_FAILURE = 5.0
CHECK_MS = 1500  # from a change to the check whether it is written
ENDING = ("SIGTERM", "SIGHUP", "SIGINT")

Work = Callable[[], Unsaved]
"""Returns the unsaved work as text; it runs in the writer's thread, so it must not use Qt objects."""

# -- the thread that writes ------------------------------------------------------------------------------


class RecoveryWriter(Thread):
    """Writes the latest unsaved work to the recovery file; work that is replaced within a pause is skipped.

    Only the queue connects it with the window: a put is complete even if a signal handler interrupts it. ``failure`` is why
    the latest work is not on the disk; empty where it is.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(name="recovery", daemon=True)
        self.failure = ""
        self._file = RecoveryFile(folder)
        self._queue: SimpleQueue[tuple[Work | None] | Event | str] = SimpleQueue()

    def submit(self, work: Work | None) -> None:
        """Replace the unsaved work; None where nothing is unsaved."""
        self._queue.put((work,))

    def flush(self, patience: float = 10.0) -> bool:
        """Write the submitted work now; False where it is not on the disk."""
        done = Event()
        self._queue.put(done)
        return done.wait(patience) and not self.failure

    def close(self, patience: float = 10.0) -> None:
        """End the thread and remove the recovery file, when nothing is unsaved."""
        self.leave("close")
        self.join(patience)

    def leave(self, how: str = "leave") -> None:
        """End the thread when the submitted work is written."""
        self._queue.put(how)

    def run(self) -> None:
        waiting: tuple[Work | None] | None = None
        due = 0.0
        while True:
            try:
                item = self._queue.get(timeout=None if waiting is None else max(due - monotonic(), 0.0))
            except Empty:
                item = None
            if isinstance(item, tuple):
                waiting = item
                if monotonic() < due:
                    continue
            if waiting is not None and item != "close":
                due = monotonic() + (PAUSE if self._write(waiting[0]) else PAUSE_AFTER_FAILURE)
                waiting = waiting if self.failure else None
            if isinstance(item, Event):
                item.set()
            elif isinstance(item, str):
                if item == "close":
                    self._file.close()
                return

    def _write(self, work: Work | None) -> bool:
        try:
            if work is None:
                self._file.clear()
            else:
                self._file.write(work())
        except Exception as error:  # the thread continues: the next work may be written
            self.failure = str(error) or type(error).__name__
        else:
            self.failure = ""
        return not self.failure


# -- unsaved work of a window ----------------------------------------------------------------------------


def recovery_folder() -> Path:
    """Return the folder for the unsaved work of all windows."""
    return user_folder("state") / "recovery"


def _unsaved(design: Design, path: Path | None, incomplete: IncompleteDesign | None, drive: int) -> Unsaved:
    from core.project import dumps  # loaded when a design is first written

    return recovery.now(dumps(design), path, None if incomplete is None else incomplete.state(), drive)


def _end(writer: RecoveryWriter, *_: object) -> None:
    writer.leave()


class Recovery(QObject):
    """Writes the unsaved work of a window to disk, and offers that of processes that ended unexpectedly.

    Signal: ``status_message`` with what has been done, for the status line.
    """

    status_message = Signal(str)

    def __init__(self, session: Session, documents: Documents, window: QWidget) -> None:
        super().__init__(window)
        self._window, self._session, self._documents = window, session, documents
        self._writer: RecoveryWriter | None = None
        self._submitted: tuple[object, ...] | None = None
        self._failure = ""
        self._check = single_shot(self, self._report_failure, CHECK_MS)

    # -- writing -------------------------------------------------------------------------------------

    def begin(self) -> None:
        """Write unsaved work from now on."""
        for changed in (
            self._session.full_design_changed,
            self._session.incomplete_changed,
            self._session.file_changed,
        ):
            changed.connect(self.note)

    def note(self) -> None:
        """Submit the unsaved work after a change of the design or its file."""
        session = self._session
        path = session.path.absolute() if session.path is not None else None
        state = (
            (
                session.valid_full_design,
                path,
                session.incomplete,
                session.chosen if session.incomplete is not None else 0,
            )
            if session.modified
            else None
        )
        if state == self._submitted:
            return
        self._submitted = state
        if self._writer is None:
            self._writer = RecoveryWriter(recovery_folder())
            self._writer.start()
            self.destroyed.connect(partial(_end, self._writer))
        self._writer.submit(None if state is None else partial(_unsaved, *state))
        self._check.start()

    def write_now(self) -> bool:
        """Write the unsaved work and wait for it; False where it cannot be written."""
        self.note()
        return self._writer is None or self._writer.flush()

    def close(self) -> None:
        """End the writer of a closed window, when nothing unsaved is needed any longer."""
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def _report_failure(self) -> None:
        failure = self._writer.failure if self._writer is not None else ""
        if failure and failure != self._failure:
            self.status_message.emit(f"Unsaved work cannot be written for recovery: {failure}")
        self._failure = failure

    # -- offering -----------------------------------------------------------------------------------------

    def offer(self, from_menu: bool = False) -> bool:
        """Ask what to do with unsaved work of processes that ended unexpectedly, and return whether there was any.

        With ``from_menu`` the status line says where there is none.
        """
        entries = [entry for entry in recovery.find(recovery_folder()) if not self._is_saved(entry)]
        if from_menu and not entries:
            self.status_message.emit("No unsaved work from an earlier run")
        offered = bool(entries)
        try:
            self._ask(entries)
        finally:
            for entry in entries:
                entry.release()
        return offered

    def _is_saved(self, entry: Recoverable) -> bool:
        """Whether the file has all of the work, which is removed then."""
        from kindyna_gui.documents.texts import compare

        is_saved = not compare(entry.unsaved).is_unsaved
        if is_saved:
            entry.discard()
        return is_saved

    def offer_again(self) -> None:
        """Offer unsaved work from the menu, after asking about changes."""
        if self._documents.may_leave():
            self.offer(from_menu=True)

    def _ask(self, entries: list[Recoverable]) -> None:
        """Ask until the user has recovered a work or postponed the rest; finished entries leave the list."""
        from kindyna_gui.documents.texts import OnRecovery

        while entries:
            choice, chosen = dialogs.ask_to_recover(self._window, entries)
            if choice is OnRecovery.DISCARD:
                entries.remove(chosen)
                chosen.discard()
                continue
            if choice is OnRecovery.OPEN and chosen.unsaved.path is not None:
                self._documents.open_path(chosen.unsaved.path)
            elif choice is OnRecovery.RECOVER and self._recover(chosen):
                entries.remove(chosen)
            return

    def _recover(self, chosen: Recoverable) -> bool:
        """Put recovered work in place; True when it is in this window's recovery file and the old file is removed."""
        unsaved = chosen.unsaved
        path = None if unsaved.path is None else str(unsaved.path)
        try:
            self._session.restore(
                {
                    "design": unsaved.design,
                    "path": path,
                    "modified": True,
                    "draft": unsaved.draft,
                    "drive": unsaved.drive,
                }
            )
        except KindynaError as error:
            dialogs.show_faults(self._window, "This work cannot be recovered.", str(error).splitlines())
            return False
        if not self.write_now():
            self._report_failure()
            return False
        chosen.discard()
        self.status_message.emit("Recovered, but not saved yet")
        return True


def write_before_the_end(app: QCoreApplication, keeper: Recovery) -> None:
    """Write unsaved work first when a signal ends the process.

    Python writes the signal to a pipe at once, which wakes the event loop.
    """

    def end(number: int, _: FrameType | None) -> None:
        try:
            keeper.write_now()
        finally:
            signal.signal(number, signal.SIG_DFL)
            os.kill(os.getpid(), number)

    if sys.platform != "win32":
        read, write = os.pipe()
        for handle in (read, write):
            os.set_blocking(handle, False)
        signal.set_wakeup_fd(write, warn_on_full_buffer=False)

        def drain(*_: object) -> None:
            with suppress(BlockingIOError):
                os.read(read, 64)

        notifier = QSocketNotifier(read, QSocketNotifier.Type.Read, app)
        notifier.activated.connect(drain)
    for name in ENDING:
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) is not signal.SIG_IGN:  # as ``nohup`` does
            signal.signal(number, end)
